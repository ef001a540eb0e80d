"""Gravity's two halves, from nothing but Newton's law for a rigid block of point masses on a base that shakes and tilts.

The block turns by a finite angle about a fixed axis while it is shaken. In the axes of the base, which the cells and the
accelerometers follow, a point mass feels m R^T (a - g) and an accelerometer beside it reads d^T R^T (a - g).
"""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import skew
from geometry.sensors import ChannelTable, Tolerances
from identification.chain import chain, turned

G = 9.81
FREQUENCY = 4.0
OMEGA = 2 * np.pi * FREQUENCY
TILT = 1e-6  # rad; what is left out is of its square
STEPS = 64
EXACT = Tolerances().scaled(0.0)

POINTS = np.array([[0.1, 0.2, 0.5], [-0.3, 0.1, 0.4], [0.2, -0.2, 0.1], [0.0, 0.1, 0.9]])
MASSES = np.array([10.0, 7.0, 20.0, 3.0])


def first_harmonic(signal: np.ndarray) -> np.ndarray:
    """Complex amplitude of the component e^{i omega t} over one period, along the first axis."""
    t = np.arange(STEPS) / STEPS
    return np.asarray(2 * np.tensordot(np.exp(-2j * np.pi * t), signal, axes=1) / STEPS)


class Base:
    """Moves by `amplitude` (3,) [m] and turns by `turn` (3,) [rad] in phase, about F."""

    def __init__(self, amplitude: np.ndarray, turn: np.ndarray) -> None:
        self.angle = float(np.linalg.norm(turn))
        self.axis = turn / self.angle
        self.amplitude = amplitude

    def lack_of_fall(self, point: np.ndarray) -> np.ndarray:
        """(t, 3) R^T (a - g) at `point`, over one period."""
        n, S = self.axis, skew(self.axis)
        out = []
        for t in 2 * np.pi * np.arange(STEPS) / STEPS:
            phi, rate, second = self.angle * np.cos(t), -self.angle * OMEGA * np.sin(t), -self.angle * OMEGA**2 * np.cos(t)
            R = np.eye(3) + np.sin(phi) * S + (1 - np.cos(phi)) * S @ S
            arm = R @ point
            a = -self.amplitude * OMEGA**2 * np.cos(t) + second * np.cross(n, arm) + rate**2 * np.cross(n, np.cross(n, arm))
            out.append(R.T @ (a + np.array([0, 0, G])))
        return np.array(out)

    @property
    def motion(self) -> np.ndarray:
        """(6,) complex amplitude of the kinematic acceleration of F."""
        return -(OMEGA**2) * np.concatenate([self.amplitude, self.angle * self.axis]).astype(complex)

    def load(self) -> np.ndarray:
        """(6,) complex amplitude of the load on the block about F, in the axes of the base."""
        felt = [m * self.lack_of_fall(p) for m, p in zip(MASSES, POINTS, strict=True)]
        moment = [np.cross(p, f) for p, f in zip(POINTS, felt, strict=True)]
        return first_harmonic(np.concatenate([np.sum(felt, axis=0), np.sum(moment, axis=0)], axis=1))

    def reading(self, table: ChannelTable, kinematic: bool, group: str = "cover") -> np.ndarray:
        """(k,) amplitudes of the accelerometers of `group`."""
        of = []
        for channel in (table.channels[k] for k in table.select(group=group)):
            place = channel.places[0]
            lab = self.motion[:3] + np.cross(self.motion[3:], place.position)
            of.append(lab @ place.direction if kinematic else first_harmonic(self.lack_of_fall(place.position)) @ place.direction)
        return np.array(of)


@pytest.fixture(scope="module")
def base() -> Base:
    return Base(TILT * np.array([0.3, -0.2, 0.1]), TILT * np.array([0.8, -0.5, 0.3]))


def block() -> np.ndarray:
    """(1, 6, 6) mass matrix of the point masses about F."""
    rows = [np.hstack([np.eye(3), -skew(p)]) for p in POINTS]
    return np.sum([m * row.T @ row for m, row in zip(MASSES, rows, strict=True)], axis=0)[None].astype(complex)


def apparent(base: Base) -> np.ndarray:
    return np.asarray(base.motion + G / OMEGA**2 * turned(np.eye(6)) @ base.motion)


def predicted(table: ChannelTable, u: np.ndarray, values: dict[str, float] | None = None) -> np.ndarray:
    """(c,) of cover plate, then cells."""
    made = chain(table, EXACT, stiffness=np.inf, gravity=G, overrides={"gravity": 1.0, "accelerometer-tilt": 1.0})
    A0, A1 = made.rows(made.theta(values or {}), FREQUENCY)
    return np.asarray(((A0 + A1 @ block()) @ u)[0])


def small(table: ChannelTable) -> ChannelTable:
    return ChannelTable(channels=tuple(channel for channel in table.channels if channel.group != "table"))


def kinematic(table: ChannelTable) -> ChannelTable:
    return ChannelTable(channels=tuple(replace(channel, senses_gravity=False) for channel in small(table).channels))


def test_the_load_of_a_tilting_block_is_its_mass_matrix_times_the_apparent_acceleration(base: Base) -> None:
    assert_allclose(base.load(), block()[0] @ apparent(base), rtol=1e-6)


def test_accelerometers_that_tilt_read_the_apparent_acceleration(base: Base, paper: ChannelTable) -> None:
    """One motion explains accelerations and loads: for a rigid body gravity cancels."""
    y = predicted(small(paper), apparent(base))
    read = base.reading(small(paper), kinematic=False)
    assert_allclose(y[:8], read, rtol=0, atol=1e-6 * np.abs(read).max())


def test_kinematic_accelerometers_read_what_moves(base: Base, paper: ChannelTable) -> None:
    y = predicted(kinematic(paper), apparent(base))
    read = base.reading(small(paper), kinematic=True)
    assert_allclose(y[:8], read, rtol=0, atol=1e-6 * np.abs(read).max())


def test_a_table_below_soft_cells_tilts_by_what_they_give(base: Base, paper: ChannelTable) -> None:
    """Its displacement is the cover plate's and K^-1 f on top; its accelerometers feel all of its tilt. Cells of 1e5 N/m."""
    made = chain(paper, EXACT, stiffness=(1e5, 1e5, 4e5), gravity=G)
    f = (block()[0] @ apparent(base)).real
    q = np.concatenate([base.amplitude, base.angle * base.axis]) + made.springs.compliance({}) @ f
    table = Base(q[:3], q[3:])
    A0, A1 = made.rows(np.zeros(len(made.parameters)), FREQUENCY)
    y = ((A0 + A1 @ block()) @ apparent(base))[0, list(made.table.columns)]
    read = table.reading(paper, kinematic=False, group="table")
    assert_allclose(y, read, rtol=0, atol=1e-6 * np.abs(read).max())


def test_taken_for_tilting_ones_kinematic_pick_ups_put_the_centre_of_gravity_15_mm_off(paper: ChannelTable) -> None:
    """g / omega² = 15.5 mm at 4 Hz, the sign in the test: H[f_x, beta] = m (z + g/omega²)."""
    pure = Base(np.zeros(3), TILT * np.array([0.0, 1.0, 0.0]))
    measured = pure.load()[0] / pure.motion[4]
    z = MASSES @ POINTS[:, 2] / MASSES.sum()
    assert_allclose(measured.real / MASSES.sum() - z, G / OMEGA**2, rtol=1e-6)
    assert_allclose(1e3 * G / OMEGA**2, 15.5, rtol=5e-3)


def test_with_the_structures_half_off_the_block_feels_the_kinematic_acceleration(base: Base, paper: ChannelTable) -> None:
    """The latent motion is then the kinematic one; accelerometers still tilt."""
    y = predicted(small(paper), base.motion, {"gravity": 0.0})
    read = base.reading(small(paper), kinematic=False)
    assert_allclose(y[:8], read, rtol=0, atol=1e-6 * np.abs(read).max())


def test_the_two_halves_are_mirror_images_where_all_sensors_tilt(base: Base, paper: ChannelTable) -> None:
    """Either half alone is seen; both changed alike are not."""
    u = apparent(base)
    both, nominal = predicted(small(paper), u, {"gravity": 0.3, "accelerometer-tilt": 0.3}), predicted(small(paper), u)
    assert_allclose(both, nominal, rtol=1e-12)
    one, other = (predicted(small(paper), u, {name: 0.0}) - nominal for name in ("gravity", "accelerometer-tilt"))
    assert_allclose(one, -other, rtol=0, atol=1e-12 * np.abs(nominal).max())
    assert np.abs(one).max() > 1e-3 * np.abs(nominal[:8]).max()
