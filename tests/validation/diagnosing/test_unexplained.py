"""What is left over is told by where it is and what it looks like, and with the size that it has."""

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import ComplexArray
from geometry.frames import rigid_transformation_6
from validation.diagnose.candidates import with_candidates
from validation.diagnose.diagnosis import Candidate
from validation.diagnose.unexplained import described, unexplained
from validation.diagnose.unexplained_fit import swallowing
from validation.effects.catalogue import parse
from validation.estimation.fit import FLOOR, ended, fitted
from validation.estimation.likelihood import cost_of
from validation.estimation.problem import FITTED, Problem
from validation.model.model import Added, Model
from validation.prediction import dynamic_mass
from validation.prediction.series import SeriesPrediction, predictions
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import simulate

# A campaign of a rigid body; whatever a test wants to be left over is added to what the model says that its channels read.


ARTICLE = "fmd+disc+cuboid"
STIFFNESS = (4e8, 4e8, 2e9)
"""[N/m] of the cells of the built-in FMD, on which virtual tests stand."""

NOISE = 5e-4
"""Of the level of a channel in a run."""


@dataclass(frozen=True, eq=False, kw_only=True)
class State:
    """A model as it stands, at the lines of its data.

    Attributes
    ----------
    of : the prediction
    u : (r, m, 6) motions
    H : (m, 6, 6) dynamic mass
    by_load : (m, c, 6) what the channels read for a unit of every load
    read : (r, m, c) what they read
    """

    of: SeriesPrediction
    u: ComplexArray
    H: ComplexArray
    by_load: ComplexArray
    read: ComplexArray

    @property
    def channels(self) -> tuple[str, ...]:
        return self.of.measured.channels

    @property
    def frequency(self) -> np.ndarray:
        return self.of.measured.frequency

    @property
    def omega(self) -> np.ndarray:
        return 2 * np.pi * self.frequency

    def added(self, dH: ComplexArray) -> ComplexArray:
        """(r, m, c) what a change of the dynamic mass (m, 6, 6) adds."""
        return (self.by_load @ dH @ self.u[..., None])[..., 0]

    def of_channel(self, channel: str, reading: ComplexArray) -> ComplexArray:
        """(r, m, c) `reading` (r, m) in one channel."""
        found = np.zeros_like(self.read)
        found[..., self.channels.index(channel)] = reading
        return found

    def reading(self, channel: str) -> ComplexArray:
        """(r, m)"""
        return self.read[..., self.channels.index(channel)]

    def of_parameter(self, name: str, share: ComplexArray) -> ComplexArray:
        """(r, m, c) what the parameter `name` adds whose offset goes with frequency as `share` (m,)."""
        change = self.of.at({}, derivatives=frozenset({name})).changes[name]
        found = np.zeros_like(self.read)
        found[..., change.channels] = share[:, None] * (change.rows @ self.u[..., None])[..., 0]
        return found


Left = Callable[[Callable[[State], ComplexArray]], Candidate]


@pytest.fixture(scope="session")
def state() -> State:
    """Of a Cuboid that does not give, in very fast sweeps."""
    plan = Plan(article=ARTICLE, model="rigid", seed=5, octaves_per_minute=120.0, quiet=0.1, simulation_rate=2048.0)
    model = Model(source="model.toml", title="a virtual laboratory", article=ARTICLE, cell_stiffness=np.array(STIFFNESS))
    (one,) = predictions(model, [simulate(plan).campaign], lines=np.linspace(4.2, 31.8, 40))
    A = one.at({}, derivatives=False).rows
    u = (np.linalg.pinv(A) @ one.measured.values[..., None])[..., 0]
    return State(of=one, u=u, H=one.dynamic_mass({}), by_load=one.by_load({}), read=(A @ u[..., None])[..., 0])


@pytest.fixture(scope="session")
def left(state) -> Left:
    """``left(change)``: the model as it stands beside what it reads itself, noise, and what `change` of the `State` adds.

    Nothing is fitted: what a fit would take is known to first order.
    """

    def made(change: Callable[[State], ComplexArray]) -> Candidate:
        rng = np.random.default_rng(2)
        noise = NOISE * np.sqrt(np.mean(np.abs(state.read) ** 2, axis=1, keepdims=True)) * np.ones(state.read.shape)
        random = rng.standard_normal(state.read.shape) + 1j * rng.standard_normal(state.read.shape)
        values = state.read + change(state) + noise * random / np.sqrt(2)
        measured = replace(state.of.measured, values=values, noise=noise)
        problem = Problem((replace(state.of, tested=replace(state.of.tested, measured=measured)),))
        cost = cost_of(problem, problem.free(FITTED), FLOOR)
        return Candidate(effects=(), fit=fitted(ended(cost, {}, converged=False)), problem=problem)

    return made


def entry(of, i: int, j: int, course) -> np.ndarray:
    dH = np.zeros_like(of.H)
    dH[:, i, j] = course
    return dH


@pytest.mark.parametrize(
    ("change", "pair", "size", "text"),
    [
        (lambda s: entry(s, 2, 2, -3e3 / s.omega**2), ("stiffness", "f_z", "z", "N/m"), 3e3, "spring"),
        (lambda s: entry(s, 5, 5, -2j / s.omega), ("damping", "t_z", "gamma", "N s m"), 2.0, "damper"),
        (lambda s: entry(s, 0, 1, 1.0) + entry(s, 1, 0, 1.0), ("mass", "f_x", "y", "kg"), 1.0, "both ways"),
        (
            lambda s: entry(s, 3, 4, -2j / s.omega) + entry(s, 4, 3, 2j / s.omega),
            ("damping", "t_x", "beta", "N s m"),
            2.0,
            "opposite signs",
        ),
    ],
    ids=["spring to ground", "damper that turns", "mass that couples two axes", "spinning wheel"],
)
def test_what_acts_between_axes_is_told_by_its_pair_in_its_unit(left, change, pair, size, text):
    found = described(left(lambda s: s.added(change(s))))
    assert (found.looks_like, found.load, found.motion, found.unit) == pair
    assert found.size == pytest.approx(size, rel=0.1)
    assert found.share > 0.4
    assert text in found.text


@pytest.mark.parametrize(
    ("channel", "change", "looks_like", "size", "unit"),
    [
        ("cover-x2", lambda s: 0.01 * (s.frequency / 10) ** 2 * s.reading("cover-x2"), "gain", 0.01, "1"),
        ("fmd-z2", lambda s: -1j * s.omega * 4e-4 * s.reading("fmd-z2"), "delay", 4e-4, "s"),  # a tolerance swallowed all of it
        ("cover-x2", lambda s: 9.81 / s.omega**2 * s.u[..., 4], "tilt", 9.81, "m/s^2"),  # gravity once too often
    ],
)
def test_what_one_channel_does_is_told_of_it_alone(left, channel, change, looks_like, size, unit):
    found = described(left(lambda s: s.of_channel(channel, change(s))))
    assert (found.looks_like, found.channels, found.unit) == (looks_like, (channel,), unit)
    assert found.size == pytest.approx(size, rel=0.1)
    assert {"gain": "square of frequency", "delay": "ms", "tilt": "gravity"}[looks_like] in found.text


def test_a_load_cell_that_loses_energy_looks_like_damping_and_a_resonance_has_its_frequency(left):
    found = described(left(lambda s: s.of_parameter("cell-stiffness:2z", 0.3j * np.ones_like(s.omega))))
    assert found.looks_like == "damping"
    assert "load cell 2z" in found.text

    def ringing(s):
        own = 2 * np.pi * 21.3
        return s.added(entry(s, 3, 3, 0.02 * s.omega**2 / (own**2 - s.omega**2 + 0.04j * own * s.omega)))

    found = described(left(ringing))
    assert (found.looks_like, found.load, found.motion) == ("resonance", "t_x", "alpha")
    assert found.frequency == pytest.approx(21.3, rel=0.02)


def test_a_channel_that_hears_another_is_told_with_what_it_hears(left):
    found = described(left(lambda s: s.of_channel("fmd-x12", 1.0 * s.reading("cover-y1"))))
    assert found.channels[0] == "fmd-x12"
    assert found.channels[1] in ("cover-y1", "table-y1")  # plate and table move nearly alike
    assert found.size == pytest.approx(1.0, rel=0.15)
    assert found.unit == "kg"


def test_accelerometers_that_feel_no_tilt_are_told_together(left):
    def none(s):
        table = {one.name: one for one in s.of.tested.campaign.table.channels}
        along = np.array([table[name].places[0].direction for name in s.channels])
        accelerometers = np.array([table[name].quantity == "acceleration" for name in s.channels])
        felt = s.u[..., 4, None] * along[:, 0] - s.u[..., 3, None] * along[:, 1]
        return np.where(accelerometers, -9.81 / s.omega[:, None] ** 2 * felt, 0.0)

    found = described(left(none))
    assert found.looks_like == "tilt"
    assert "all accelerometers" in found.text
    assert found.size == pytest.approx(-9.81, rel=0.1)


def test_a_loud_channel_looks_like_noise(left):
    rng = np.random.default_rng(3)

    def loud(s):
        level = 0.01 * np.abs(s.reading("table-y1")).max()
        shape = s.u.shape[:2]
        return s.of_channel("table-y1", level * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)))

    found = described(left(loud))
    assert (found.looks_like, found.channels) == ("noise", ("table-y1",))


def test_a_spring_off_the_reference_point_is_told_by_its_leading_pair_and_those_beside_it(left):
    def spring(s):
        d = np.array([0.0, 1.0, 0.0, -0.25, 0.0, 0.1])
        return s.added(-5e2 / s.omega[:, None, None] ** 2 * np.outer(d, d))

    found = described(left(spring))
    assert (found.looks_like, found.load, found.motion, found.unit) == ("stiffness", "f_y", "y", "N/m")
    assert found.size == pytest.approx(5e2, rel=0.1)
    assert "y and alpha" in found.text


def test_a_board_whose_delay_grows_along_the_sweep_is_told_as_a_group(left):
    def slow(s):
        late = -1j * s.omega * 2e-4 * np.log(s.frequency / s.frequency[0])
        return np.where([name.startswith("fmd") for name in s.channels], late[:, None] * s.read, 0.0)

    found = described(left(slow))
    assert found.looks_like == "delay"
    assert len(found.channels) == 8
    assert "load cells" in found.text


def test_a_joint_that_gives_is_told_with_its_compliance(left, state):
    carried = state.of.tested.carried
    T = rigid_transformation_6(carried.standing.pose.position)
    H = np.linalg.inv(T).T @ (state.H - dynamic_mass.at(carried.moving, {}).mass_matrix) @ np.linalg.inv(T)
    C = np.diag([0, 0, 0, 2e-6, 0, 0])
    found = described(left(lambda s: s.added(T.T @ (s.omega[:, None, None] ** 2 * H @ C @ H) @ T)))
    assert (found.looks_like, found.load, found.motion) == ("stiffness", "t_x", "alpha")
    assert found.size == pytest.approx(2e-6, rel=0.1)
    assert "between cover plate and article" in found.text


def test_a_mass_at_a_place_is_told_by_the_place(left):
    def heavier(s):
        rows = s.of.moved({})["top"][0]
        return s.added(0.3 * np.swapaxes(rows, 1, 2) @ rows)

    found = described(left(heavier))
    assert found.looks_like == "mass"
    assert "top" in found.text
    assert found.size == pytest.approx(0.3, rel=0.1)


def test_what_follows_nothing_is_irregular(left):
    rng = np.random.default_rng(4)

    def mixed(s):
        shape = s.read.shape
        level = 0.005 * np.abs(s.read).max(axis=(0, 1))
        return level * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))

    found = described(left(mixed))
    assert found.looks_like == "irregular"
    assert found.share < 0.5
    assert "comes closest" in found.text


def test_where_nothing_is_missing_no_description_gains_much_and_a_small_fault_gains_more(left):
    nothing = unexplained(left(lambda s: np.zeros_like(s.read)))
    small = unexplained(left(lambda s: s.added(entry(s, 3, 4, -0.3j / s.omega) + entry(s, 4, 3, 0.3j / s.omega))))
    assert nothing.gain < 20
    assert small.gain > 50
    assert small.place.sign == -1


def test_a_stiffness_among_the_parameters_does_not_drown_what_is_known_of_the_others(left):
    """Its variance is some (N/m)² beside (µm)²: covariances are taken by their correlations."""
    nothing = left(lambda s: np.zeros_like(s.read))
    spring = Added(named=parse("cable:top:vertical=800"))
    problem = with_candidates(nothing.problem, [spring])
    cost = cost_of(problem, problem.free(FITTED), FLOOR)
    sprung = Candidate(effects=(spring,), fit=fitted(ended(cost, {}, converged=False)), problem=problem)
    (one,) = swallowing(sprung)
    at = [k for k, each in enumerate(sprung.fit.parameters) if each.name in one.names]
    C, sd = sprung.fit.covariance[np.ix_(at, at)], np.sqrt(np.diag(sprung.fit.covariance)[at])
    assert sd.max() > 1e6 * sd.min() > 0
    assert_allclose(one.root @ one.root.T / np.outer(sd, sd), C / np.outer(sd, sd), atol=1e-9)
    assert unexplained(sprung).gain == pytest.approx(unexplained(nothing).gain, abs=5)
