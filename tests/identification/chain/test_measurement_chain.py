"""The measurement chain: what its channels read, with every parameter, and what none of them shows."""

import re
from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import exp
from pathlib import Path
from types import MappingProxyType

import numpy as np
import numpy.typing as npt
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, rotation_about
from geometry.inertia import Inertia
from geometry.sensors import Channel, ChannelTable, Place, Tolerances, motion_rows, resultants
from identification import load_cells
from identification.base_motion import tilt
from identification.chain import Chain, chain
from identification.load_cells import ASSUMED, STATED

FREQUENCY = np.array([4.0, 11.3, 32.0])
STIFFNESS = (1e8, 1e8, 4e8)
CLOSED = {
    "board-delay": 1e-5,
    "cell-loss": 0.02,
    "force-highpass": 0.1,
    "accelerometer-highpass": 0.1,
    "cell-crosstalk": 0.02,
    "load-path-shunt": 0.01,
    "force-plane-offset": 1e-3,
    "cover-plate-flexibility": 1e-10,
    "gravity": 0.1,
    "accelerometer-tilt": 0.1,
}


def dynamic_mass(rng: np.random.Generator) -> np.ndarray:
    """(n, 6, 6) complex, of the size of an article of 50 kg; symmetric but otherwise anything."""
    M = rng.normal(size=(3, 6, 6)) + 0.1j * rng.normal(size=(3, 6, 6))
    return 5 * (M + M.transpose(0, 2, 1)) + np.diag([50.0, 50, 50, 8, 8, 3])


@pytest.fixture(params=["paper", "slanted", "loads_only"])
def table(request: pytest.FixtureRequest) -> ChannelTable:
    made: ChannelTable = request.getfixturevalue(request.param)
    return made


def everything(table: ChannelTable) -> Chain:
    possible = {name.partition(":")[0] for name in chain(table, stiffness=STIFFNESS).possible}
    return chain(table, stiffness=STIFFNESS, overrides={name: size for name, size in CLOSED.items() if name in possible})


def drawn(made: Chain, rng: np.random.Generator, size: float = 1.0) -> np.ndarray:
    return size * made.tolerances * rng.normal(size=len(made.parameters))


def test_nominal_rows_are_those_of_the_sensors(paper: ChannelTable) -> None:
    """Zero offsets: accelerometers read [G] u, and the resultants of what the cells read are H u."""
    made = chain(paper, stiffness=np.inf)
    assert not any(one.family == "fmd-compliance" for one in made.parameters)
    A0, A1 = made.rows(np.zeros(len(made.parameters)), FREQUENCY)
    channels = [paper.channels[k] for k in made.columns]
    expected = motion_rows(channels[:14], paper.origin)
    assert_allclose(A0[:, :14], np.broadcast_to(expected, (3, 14, 6)), rtol=0, atol=1e-15)
    assert_allclose(A1[:, :14], 0, atol=0)
    identity = resultants(channels[14:], paper.origin) @ A1[:, 14:]
    assert_allclose(identity, np.broadcast_to(np.eye(6), (3, 6, 6)), rtol=0, atol=1e-14)


def test_the_resultants_of_any_table_are_the_load(table: ChannelTable) -> None:
    """However unequal the cells are: they share the load, they do not change it."""
    made = chain(table, Tolerances(crosstalk=0.0, gain=0.0, delay=0.0))
    _, A1 = made.rows(drawn(made, np.random.default_rng(1)), FREQUENCY)
    forces = list(made.forces.columns)
    channels = [table.channels[made.columns[k]] for k in forces]
    unsummed = [channel for channel in channels if channel.quantity == "force"] if len(channels) > 8 else channels
    identity = resultants(unsummed, table.origin) @ A1[:, forces[: len(unsummed)]]
    assert_allclose(identity, np.broadcast_to(np.eye(6), (3, 6, 6)), rtol=0, atol=1e-12)


@pytest.mark.parametrize("size", [1.0, *(pytest.param(size, marks=pytest.mark.proof) for size in (0.0, 10.0))])
def test_derivatives_are_the_limit_of_differences(table: ChannelTable, size: float) -> None:
    """Central differences of all parameters, at nominal, at a drawn theta and far out."""
    rng = np.random.default_rng(7)
    made = everything(table)
    theta, H = drawn(made, rng, size), dynamic_mass(rng)
    for k, (parameter, derivative) in enumerate(zip(made.parameters, made.derivatives(theta, FREQUENCY, H), strict=True)):
        step = 1e-4 * made.tolerances * (np.arange(len(theta)) == k)
        (p0, p1), (m0, m1) = made.rows(theta + step, FREQUENCY), made.rows(theta - step, FREQUENCY)
        difference = (p0 + p1 @ H - m0 - m1 @ H) / (2 * step[k])
        analytic = np.zeros_like(difference)
        analytic[:, list(derivative.channels)] = derivative.rows
        assert set(derivative.channels) == set(parameter.channels), parameter.name
        # rounding of A ~ 100 over the step, and the step's square
        scale = np.abs(difference).max()
        assert scale > 0 or parameter.name in {"gravity", "accelerometer-tilt"}, parameter.name
        assert_allclose(analytic, difference, rtol=0, atol=2e-6 * scale + 1e-13 * 1e3 / step[k], err_msg=parameter.name)


def test_priors_are_those_of_the_laboratory(paper: ChannelTable) -> None:
    known = Tolerances(gain=0.01, table_gain=0.02, delay=1e-6, position=2e-3, angle=0.04, cell_stiffness=0.06, crosstalk=0.007)
    by_name = {one.name: one.tolerance for one in chain(paper, known, overrides={"accelerometer-gain:cover-z1": 0.5}).parameters}
    expected = {
        "force-gain:fmd-x12": 0.01,
        "accelerometer-gain:cover-z1": 0.5,
        "accelerometer-gain:table-z1": 0.02,
        "accelerometer-gain:cover-z2": 0.01,
        "force-delay:fmd-z4": 1e-6,
        "accelerometer-position:cover-z3:x": 2e-3,
        "accelerometer-misalignment:cover-z3:y": 0.04,
        "cell-stiffness:3y": 0.06,
        "force-crosstalk:zx": 0.007,
        "fmd-compliance:lateral": ASSUMED,
        "fmd-compliance:vertical": ASSUMED,
    }
    assert {name: by_name[name] for name in expected} == expected
    stated = {one.name: one.tolerance for one in chain(paper, stiffness=STIFFNESS).parameters}
    assert stated["fmd-compliance:lateral"] == STATED


def test_a_family_can_be_closed_and_a_name_in_it_stay_open(paper: ChannelTable) -> None:
    made = chain(paper, overrides={"force-gain": 0.0, "force-gain:fmd-z2": 0.1})
    assert [one.name for one in made.parameters if one.family == "force-gain"] == ["force-gain:fmd-z2"]


@pytest.mark.parametrize(
    ("name", "size"), [("force-gian", 0.1), ("force-gain:nobody", 0.1), ("force-gain", -1.0), ("gravity", np.nan)]
)
def test_an_override_that_fits_nothing_is_refused_by_name(paper: ChannelTable, name: str, size: float) -> None:
    with pytest.raises(BadInput, match=name):
        chain(paper, overrides={name: size})


def test_without_a_table_its_rows_and_the_compliance_vanish(paper: ChannelTable) -> None:
    kept = tuple(channel for channel in paper.channels if channel.group != "table")
    made = chain(ChannelTable(channels=kept))
    assert not any(one.family == "fmd-compliance" or ":table-" in one.name for one in made.parameters)
    assert made.rows(np.zeros(len(made.parameters)), FREQUENCY)[0].shape == (3, 16, 6)


def test_a_pick_up_on_the_structure_is_left_out_by_name(paper: ChannelTable) -> None:
    place = Place(position=np.array([0.0, 0.0, 0.4]), direction=np.array([1.0, 0.0, 0.0]))
    tip = Channel(name="mast-top-x", quantity="acceleration", group="article", places=(place,))
    made = chain(ChannelTable(channels=(tip, *paper.channels)), stiffness=STIFFNESS)
    assert made.left_out == ("mast-top-x",)
    assert "mast-top-x" not in made.names
    assert not chain(paper, stiffness=STIFFNESS).left_out


def test_a_line_at_zero_is_refused(paper: ChannelTable) -> None:
    made = chain(paper)
    with pytest.raises(ValueError, match="frequency"):
        made.rows(np.zeros(len(made.parameters)), [0.0, 1.0])


def test_values_and_theta_are_each_others_inverse(paper: ChannelTable) -> None:
    made = everything(paper)
    theta = drawn(made, np.random.default_rng(3))
    assert_allclose(made.theta(made.values(theta)), theta, rtol=1e-9, atol=1e-15)
    values = made.values(np.zeros(len(theta)))
    assert (values["fmd-compliance:vertical"], values["gravity"], values["cell-stiffness:1x"]) == (1.0, 1.0, 0.0)


def test_a_stiffness_cannot_turn_negative(paper: ChannelTable) -> None:
    with pytest.raises(BadInput, match="cell-stiffness:1x"):
        chain(paper).theta({"cell-stiffness:1x": -1.5})


G, LOW = 9.81, 4.0
EXACT = Tolerances().scaled(0.0)
MOVED = 1e-6 * np.array([0.3, -0.2, 0.1, 0.8, -0.5, 0.3])  # m and rad
KINEMATIC = -((2 * np.pi * LOW) ** 2) * MOVED
APPARENT = tilt([LOW], G)[0] @ KINEMATIC
"""What a pick-up that feels its tilt reads of it: `test_base_motion.py` shows it by turning one."""
BLOCK = Inertia.from_cog(40.0, [0.0, 0.05, 0.4], np.diag([4.0, 3.0, 2.0])).mass_matrix


def predicted(table: ChannelTable, u: np.ndarray, values: dict[str, float] | None = None) -> np.ndarray:
    """(c,) of cover plate, then cells, under the block."""
    made = chain(table, EXACT, stiffness=np.inf, gravity=G, overrides={"gravity": 1.0, "accelerometer-tilt": 1.0})
    A0, A1 = made.rows(made.theta(values or {}), LOW)
    return np.asarray(((A0 + A1 @ BLOCK) @ u)[0])


@pytest.fixture
def small(paper: ChannelTable) -> ChannelTable:
    """The paper's signals without those of the table."""
    return ChannelTable(channels=tuple(channel for channel in paper.channels if channel.group != "table"))


def rows_of(table: ChannelTable, group: str = "cover") -> np.ndarray:
    return motion_rows([table.channels[k] for k in table.select(group=group)], table.origin)


def test_accelerometers_that_tilt_read_the_apparent_acceleration_and_others_what_moves(small: ChannelTable) -> None:
    """One motion explains accelerations and loads, H u: for a rigid body gravity cancels."""
    steady = ChannelTable(channels=tuple(replace(channel, senses_gravity=False) for channel in small.channels))
    cells = [channel for channel in small.channels if channel.quantity == "force"]
    for table, felt in ((small, APPARENT), (steady, KINEMATIC)):
        y = predicted(table, APPARENT)
        assert_allclose(y[:8], rows_of(small) @ felt, rtol=0, atol=1e-12 * np.abs(y).max())
        assert_allclose(resultants(cells, small.origin) @ y[8:], BLOCK @ APPARENT, rtol=0, atol=1e-12 * np.abs(y).max())


def test_a_table_below_soft_cells_tilts_by_what_they_give(paper: ChannelTable) -> None:
    """Its displacement is the cover plate's and K^-1 f on top; its accelerometers feel all of its tilt. Cells of 1e5 N/m."""
    made = chain(paper, EXACT, stiffness=(1e5, 1e5, 4e5), gravity=G)
    q = MOVED + made.springs.compliance({}) @ (BLOCK @ APPARENT)
    A0, A1 = made.rows(np.zeros(len(made.parameters)), LOW)
    y = ((A0 + A1 @ BLOCK) @ APPARENT)[0, list(made.table.columns)]
    felt = -((2 * np.pi * LOW) ** 2) * tilt([LOW], G)[0] @ q
    assert_allclose(y, rows_of(paper, "table") @ felt, rtol=0, atol=1e-12 * np.abs(y).max())


def test_with_the_structures_half_off_the_block_feels_the_kinematic_acceleration(small: ChannelTable) -> None:
    """The latent motion is then the kinematic one; accelerometers still tilt."""
    y = predicted(small, KINEMATIC, {"gravity": 0.0})
    assert_allclose(y[:8], rows_of(small) @ APPARENT, rtol=0, atol=1e-12 * np.abs(y).max())


def test_the_two_halves_are_mirror_images_where_all_sensors_tilt(small: ChannelTable) -> None:
    """Either half alone is seen; both changed alike are not."""
    both, nominal = predicted(small, APPARENT, {"gravity": 0.3, "accelerometer-tilt": 0.3}), predicted(small, APPARENT)
    assert_allclose(both, nominal, rtol=1e-12)
    one, other = (predicted(small, APPARENT, {name: 0.0}) - nominal for name in ("gravity", "accelerometer-tilt"))
    assert_allclose(one, -other, rtol=0, atol=1e-12 * np.abs(nominal).max())
    assert np.abs(one).max() > 1e-3 * np.abs(nominal[:8]).max()


SEVERAL = np.array([4.0, 25.0])
SEVERAL_OMEGA = 2 * np.pi * SEVERAL
OPEN = ("board-delay", "force-highpass", "load-path-shunt", "force-plane-offset", "cover-plate-flexibility")
H = np.array(
    [
        [50, 0, 1, 0, 9, 2],
        [0, 51, 0, -9, 0, 3],
        [1, 0, 52, 1, -2, 0],
        [0, -9, 1, 7, 0, 0],
        [9, 0, -2, 0, 6, 0],
        [2, 3, 0, 0, 0, 2.0],
    ]
)
U = np.array([1.0, -0.7, 0.4, 2.0, -1.5, 0.8])


@pytest.fixture(scope="module")
def made(paper: ChannelTable) -> Chain:
    return chain(paper, Tolerances(), stiffness=STIFFNESS, overrides=dict.fromkeys(OPEN, 1.0))


def reading(made: Chain, **values: float) -> dict[str, np.ndarray]:
    """By channel (n,) what it reads of the motion `U` with these parameters."""
    A0, A1 = made.rows(made.theta(dict(values)), SEVERAL)
    return dict(zip(made.names, ((A0 + A1 @ H) @ U).T, strict=True))


def with_one(made: Chain, name: str, value: float) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Readings at nominal and with one parameter at a value; that all channels it does not claim stay is checked here."""
    before, after = reading(made), reading(made, **{name: value})
    touched = next(one.channels for one in made.parameters if one.name == name)
    for k, channel in enumerate(made.names):
        if k not in touched:
            assert_allclose(after[channel], before[channel], rtol=0, atol=0)
    return before, after


@pytest.mark.parametrize("channel", ["fmd-x12", "cover-z3", "table-y1"])
def test_a_gain_multiplies_its_channel(made: Chain, channel: str) -> None:
    kind = "force" if channel.startswith("fmd") else "accelerometer"
    before, after = with_one(made, f"{kind}-gain:{channel}", 0.08)
    assert_allclose(after[channel], 1.08 * before[channel], rtol=1e-12)


@pytest.mark.parametrize(
    "name", ["force-delay:fmd-x12", "accelerometer-delay:table-z1", "board-delay:cover", "board-delay:force"]
)
def test_a_late_channel_lags(made: Chain, name: str) -> None:
    before, after = with_one(made, name, 1e-3)
    for k in next(one.channels for one in made.parameters if one.name == name):
        channel = made.names[k]
        assert_allclose(after[channel], before[channel] * np.exp(-1j * SEVERAL_OMEGA * 1e-3), rtol=1e-12)


def test_a_high_pass_lets_half_the_power_through_at_its_corner_and_leads(made: Chain) -> None:
    before, after = with_one(made, "force-highpass:fmd-z2", 4.0)
    ratio = after["fmd-z2"] / before["fmd-z2"]
    assert_allclose(abs(ratio[0]), np.sqrt(0.5), rtol=1e-12)
    assert_allclose(np.angle(ratio[0]), np.pi / 4, rtol=1e-12)
    assert abs(ratio[1]) > 0.98


@pytest.mark.parametrize(("channel", "axis"), [("cover-z3", "x"), ("cover-x1", "z"), ("table-y2", "x")])
def test_a_misalignment_turns_the_direction_right_handed_about_the_axis(made: Chain, channel: str, axis: str) -> None:
    exact = chain(paper_of(made), Tolerances(), stiffness=np.inf)
    after = reading(exact, **{f"accelerometer-misalignment:{channel}:{axis}": 0.1})
    group = exact.cover if channel.startswith("cover") else exact.table
    place = next(one for one in group.channels if one.name == channel).places[0]
    a = U[:3] + np.cross(U[3:], place.position)
    assert_allclose(after[channel], (rotation_about(axis, 0.1) @ place.direction) @ a, rtol=1e-12)


def paper_of(made: Chain) -> ChannelTable:
    return ChannelTable(channels=(*made.cover.channels, *made.table.channels, *made.forces.channels), origin=made.cover.point)


@pytest.mark.parametrize("axis", ["x", "y"])
def test_a_pick_up_reads_where_it_sits(made: Chain, axis: str) -> None:
    before, after = with_one(made, f"accelerometer-position:cover-z3:{axis}", 2e-3)
    moved = 2e-3 * np.eye(3)["xyz".index(axis)]
    assert_allclose(after["cover-z3"] - before["cover-z3"], np.cross(U[3:], moved)[2], rtol=1e-9)


def test_a_shift_along_the_direction_is_no_parameter(made: Chain) -> None:
    names = {one.name for one in made.parameters}
    assert "accelerometer-position:cover-z3:z" not in names
    assert "accelerometer-misalignment:cover-z3:z" not in names


def test_cross_talk_zx_shows_the_x_resultant_in_the_z_channels(made: Chain) -> None:
    before, after = with_one(made, "force-crosstalk:zx", 0.02)
    change = sum(after[f"fmd-z{k}"] - before[f"fmd-z{k}"] for k in range(1, 5))
    assert_allclose(change, 0.02 * (H @ U)[0], rtol=1e-12)
    assert_allclose(after["fmd-x12"], before["fmd-x12"], rtol=1e-12)


def test_a_shunt_takes_its_fraction_of_what_the_cells_carry_along_its_axis(made: Chain) -> None:
    before, after = with_one(made, "load-path-shunt:z", 0.03)
    for k in range(1, 5):
        assert_allclose(after[f"fmd-z{k}"], 0.97 * before[f"fmd-z{k}"], rtol=1e-12)
    assert_allclose(after["fmd-x34"], before["fmd-x34"], rtol=1e-12)


@pytest.mark.parametrize(("axis", "moment", "sign"), [("x", 4, -1), ("y", 3, 1)])
def test_moments_that_the_cells_miss_are_those_of_a_plane_at_another_height(
    made: Chain, axis: str, moment: int, sign: int
) -> None:
    """M_y -= h F_x and M_x += h F_y, read from the four vertical cells: M_x = sum y f_z, M_y = -sum x f_z."""
    before, after = with_one(made, f"force-plane-offset:{axis}", 4e-3)
    change = np.array([after[f"fmd-z{k}"] - before[f"fmd-z{k}"] for k in range(1, 5)])
    arm = {3: np.array([1, 1, -1, -1]), 4: -np.array([1, -1, -1, 1])}[moment] * 0.13
    assert_allclose(arm @ change, sign * 4e-3 * (H @ U)["xy".index(axis)], rtol=1e-10)


def test_a_cover_plate_that_bends_adds_to_its_vertical_pick_ups(made: Chain) -> None:
    before, after = with_one(made, "cover-plate-flexibility", 1e-9)
    assert_allclose(after["cover-z1"] - before["cover-z1"], -(SEVERAL_OMEGA**2) * 1e-9 * (H @ U)[2], rtol=1e-9)
    assert_allclose(after["cover-x1"], before["cover-x1"], rtol=0, atol=0)


CELLS = {"cell-stiffness": 0.05}
K = np.array([1e8, 1.3e8, 4e8])
CORNERS = np.array([[0.13, 0.13, 0.0], [-0.13, 0.13, 0.0], [-0.13, -0.13, 0.0], [0.13, -0.13, 0.0]])
BAND = np.array([5.0, 20.0])


def forces_of(made: Chain, values: dict[str, float]) -> np.ndarray:
    """(c, 6) what the force channels read for a unit load."""
    return np.asarray(made.rows(made.theta(values), BAND)[1][0, list(made.forces.columns)].real)


def statics(stiffness: np.ndarray, places: np.ndarray, load: np.ndarray) -> np.ndarray:
    """(c, 3) forces of three-component springs under a rigid plate, by least energy.

    Moved by (t, r) the springs store sum k |t + r x p|² / 2; where this less the work of the load is least, differences tell.
    """

    def drawn_out(q: np.ndarray) -> np.ndarray:
        return np.asarray(q[:3] + np.cross(q[3:], places))

    def energy(q: np.ndarray) -> float:
        return float(0.5 * np.sum(stiffness * drawn_out(q) ** 2) - load @ q)

    unit = np.eye(6)
    # quadratic: second differences with unit steps are its exact second derivatives
    second = [
        [energy(unit[i] + unit[j]) - energy(unit[i]) - energy(unit[j]) + energy(np.zeros(6)) for j in range(6)] for i in range(6)
    ]
    return np.asarray(stiffness * drawn_out(np.linalg.solve(np.array(second), load)))


def test_unequal_cells_share_a_load_as_statics_says(paper: ChannelTable) -> None:
    rng = np.random.default_rng(11)
    change = 0.2 * rng.uniform(-1, 1, size=(4, 3))
    names = {f"cell-stiffness:{k + 1}{axis}": change[k, i] for k in range(4) for i, axis in enumerate("xyz")}
    reading = forces_of(chain(paper, EXACT, stiffness=K, overrides=CELLS), names)
    for load in np.eye(6):
        f = statics(K * (1 + change), CORNERS, load)
        expected = [f[0, 0] + f[1, 0], f[2, 0] + f[3, 0], f[0, 1] + f[3, 1], f[1, 1] + f[2, 1], *f[:, 2]]
        assert_allclose(reading @ load, expected, rtol=0, atol=1e-7)  # differences of energies of 1e8


def closed_form(m: float, I: float, axis: int) -> np.ndarray:
    """Table over cover plate for a rigid block of mass m and moment I on four cells, moved along or turned about `axis` alone."""
    a = 0.13
    stiffness = [4 * K[0], 4 * K[1], 4 * K[2], 4 * K[2] * a**2, 4 * K[2] * a**2, 4 * (K[0] + K[1]) * a**2][axis]
    inertia = m if axis < 3 else I
    return np.asarray(1 - (2 * np.pi * BAND) ** 2 * inertia / stiffness)


@pytest.mark.parametrize("axis", range(6))
def test_a_block_on_its_cells_moves_as_two_masses_and_a_spring(paper: ChannelTable, axis: int) -> None:
    """With its centre in the plane of the cells no motion drags another: u_table = (1 - omega² m / k) u_cover.

    Without gravity: the table tilts more than the plate, and its accelerometers would feel it.
    """
    m, I = 60.0, 2.0
    made = chain(paper, EXACT, stiffness=K, gravity=0.0)
    A0, A1 = made.rows(np.zeros(len(made.parameters)), BAND)
    A = A0 + A1 @ np.diag([m, m, m, I, I, I])
    on_table = list(made.table.columns)
    expected = closed_form(m, I, axis)[:, None] * A0[:, on_table, axis]
    assert_allclose(A[:, on_table, axis], expected, rtol=1e-12, atol=1e-15)


def test_a_stiffness_assumed_wrongly_is_made_good_by_the_compliance(paper: ChannelTable) -> None:
    """Whatever is assumed: at the right factor the chain is that of the true cells."""
    assumed, stated = chain(paper, EXACT), chain(paper, EXACT, stiffness=K * [1, 1 / 1.3, 1])
    lateral, _, vertical = load_cells.assumed_stiffness() / K
    right = assumed.theta({"fmd-compliance:lateral": lateral, "fmd-compliance:vertical": vertical})
    expected = stated.rows(np.zeros(len(stated.parameters)), BAND)
    for found, true in zip(assumed.rows(right, BAND), expected, strict=True):
        assert_allclose(found, true, rtol=1e-12, atol=1e-15)


def test_cells_are_numbered_counter_clockwise_whatever_their_order() -> None:
    shuffled = [2, 0, 3, 1]
    elements = [Place(position=CORNERS[k], direction=e) for k in shuffled for e in np.eye(3)]
    assert load_cells.names(elements, np.zeros(3)) == tuple(f"{k + 1}{axis}" for k in shuffled for axis in "xyz")


def test_loads_already_worked_out_are_read_as_they_are(loads_only: ChannelTable) -> None:
    made = chain(loads_only, EXACT)
    assert_allclose(forces_of(made, {}), np.eye(6), atol=1e-15)
    targets = {one.name.partition(":")[2] for one in made.parameters if one.family == "fmd-compliance"}
    assert targets == {"lateral", "vertical", "rotation", "torsion"}
    assert not any(one.family == "cell-stiffness" for one in made.parameters)


@pytest.mark.parametrize("stiffness", [(1e8, 1e8), (1e8, 0.0, 1e8), (1e8, -1e8, 1e8), (np.inf, 1e8, 1e8), 5.0])
def test_a_stiffness_that_is_none_is_refused(paper: ChannelTable, stiffness: object) -> None:
    with pytest.raises(BadInput, match="stiffness"):
        chain(paper, stiffness=stiffness)  # type: ignore[arg-type]


PAGE = Path(__file__).parents[3] / "docs" / "measurement-chain.md"


def families_of_the_page() -> dict[str, str]:
    """By family what the page says of its tolerance."""
    found = {}
    for line in PAGE.read_text(encoding="utf-8").splitlines():
        cells = [cell.strip() for cell in line.strip("|").split("|")]
        if line.startswith("| `") and len(cells) == 5:
            found |= dict.fromkeys(re.findall(r"`([\w-]+)`", cells[0]), cells[3])
    return found


def test_the_table_holds_every_family_with_its_tolerance(paper: ChannelTable) -> None:
    said = families_of_the_page()
    ordinary = chain(paper).parameters
    everything = chain(paper, overrides={family: 1.0 for family, tolerance in said.items() if tolerance == "-"}).parameters
    assert set(said) == {one.family for one in everything}
    assert {family for family, tolerance in said.items() if tolerance != "-"} == {one.family for one in ordinary}
    for one in ordinary:
        figures = [float(figure) for figure in re.findall(r"(?<![\^\w])\d[\d.e-]*", said[one.family])]
        if one.family != "fmd-compliance":
            assert any(abs(figure - one.tolerance) < 1e-3 * one.tolerance for figure in figures), one.name
    exponents = [float(figure) for figure in re.findall(r"e\^([\d.]+)", said["fmd-compliance"])]
    assert exponents == [pytest.approx(ASSUMED, abs=5e-3), STATED]
    assert exp(ASSUMED) == pytest.approx(5.0)


WIDE = np.linspace(4.0, 32.0, 6)
# Combinations of parameters that no channel ever shows.
#
# The motion u is latent: what changes all channels as another motion would is not seen. With A = A0 + A1 H, dA_k the change by
# parameter k and P the projector off the columns of A, a combination w is invisible where
#
#     sum_k w_k P dA_k = 0          at every line and for all six motions,
#
# and those are the null space of the Jacobian of the likelihood, whatever the runs were. All accelerometers and load cells of
# one common gain, or coming late alike, are the plainest. Priors alone decide along such a combination; data cannot.


INVISIBLE = 1e-9
"""What a combination of one tolerance in all may change, relative to the levels of the channels, and still be rounding."""

NEGLIGIBLE = 1e-6
"""Weight beside the largest one below which a parameter does not take part."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Combination:
    """Parameters that move together without a trace.

    Attributes
    ----------
    weights : by name, offset in the parameter's own unit for an offset 1 of the first one
    text : the same in words, whole families together
    """

    weights: Mapping[str, float]
    text: str


def unobservable(
    chain: Chain,
    theta: npt.ArrayLike,
    frequency: npt.ArrayLike,
    H: npt.ArrayLike,
    *,
    structure: Mapping[str, npt.ArrayLike] = MappingProxyType({}),
) -> tuple[Combination, ...]:
    """Independent combinations of the chain's parameters, and of what is unknown of the structure, that no channel shows.

    Parameters
    ----------
    theta : (p,) where the chain stands
    frequency : (n,) lines [Hz]
    H : (n, 6, 6) dynamic mass of what stands above the force plane
    structure : by name, (6, 6) or (n, 6, 6) change of H by one unit of something that is not known of it either; of a size like
        that of a tolerance. None where H is known, as in a tare
    """
    from scipy.linalg import qr

    J = seen_changes(chain, theta, frequency, H, tuple(structure.values()))
    _, singular, Vt = np.linalg.svd(J, full_matrices=False)
    null = Vt[singular < INVISIBLE]
    if len(null):  # a basis of the same space that is read more easily: each vector has one parameter to itself, of weight 1
        _, _, order = qr(null, mode="economic", pivoting=True)
        null = np.linalg.solve(null[:, order[: len(null)]], null)
    names = (*(one.name for one in chain.parameters), *structure)
    units = np.concatenate([chain.tolerances, np.ones(len(structure))])
    return tuple(_combination(weights, units, names) for weights in null)


def seen_changes(
    chain: Chain, theta: npt.ArrayLike, frequency: npt.ArrayLike, H: npt.ArrayLike, structure: Sequence[npt.ArrayLike] = ()
) -> Array:
    """Change of the channels by one tolerance of each parameter, relative to their levels, beyond all motions.

    Shape (2 n c 6, p + s), real above imaginary parts, for the six motions at their nominal levels each; padded with zero rows
    to at least p + s.
    """
    matrix = np.asarray(H, dtype=np.complex128)
    A0, A1 = chain.rows(theta, frequency)
    levels = np.array([LEVELS[axis] for axis in MOTIONS])
    A = (A0 + A1 @ matrix) * levels
    size = np.sqrt(np.mean(np.sum(np.abs(A) ** 2, axis=2), axis=0))[:, None]
    Q, _ = np.linalg.qr(A / size)
    off = np.eye(len(chain)) - Q @ Q.conj().transpose(0, 2, 1)
    found: list[ComplexArray] = []
    for one, tolerance in zip(chain.derivatives(theta, frequency, matrix), chain.tolerances, strict=True):
        chosen = list(one.channels)
        found.append(off[:, :, chosen] @ (tolerance * one.rows * levels / size[chosen]))
    found += [np.asarray(off @ ((A1 @ np.asarray(change)) * levels / size)) for change in structure]
    flat = np.array([change.ravel() for change in found]).reshape(len(found), -1).T
    J = np.vstack([flat.real, flat.imag]) / np.sqrt(max(len(A), 1))
    return np.vstack([J, np.zeros((max(0, J.shape[1] - J.shape[0]), J.shape[1]))])


def _combination(weights: Array, units: Array, names: Sequence[str]) -> Combination:
    least = NEGLIGIBLE * float(np.abs(weights).max())
    kept = {name: float(w * unit) for name, w, unit in zip(names, weights, units, strict=True) if abs(w) > least}
    first = next(iter(kept.values()))
    offsets = {name: w / first for name, w in kept.items()}
    # Families of which all take part alike as one, everything else by its name
    said: dict[str, str] = {}
    for name, weight in offsets.items():
        family = name.partition(":")[0]
        members = [one for one in names if one.partition(":")[0] == family]
        alike = all(abs(offsets.get(one, 0.0) - weight) < NEGLIGIBLE * abs(weight) for one in members)
        whole = alike and len(members) > 1
        said[family if whole else name] = f"{weight:+.3g} {f'{family} (all {len(members)})' if whole else name}"
    return Combination(weights=MappingProxyType(offsets), text=" ".join(said.values()))


CARRIED = np.diag([50.0, 50, 50, 7, 6, 2])
CARRIED[0, 4] = CARRIED[4, 0] = 9.0
CARRIED[1, 3] = CARRIED[3, 1] = -9.0


@pytest.fixture(scope="module")
def of_all(paper: ChannelTable) -> Chain:
    return chain(paper, stiffness=(1e8, 1e8, 4e8))


def test_a_common_gain_and_a_common_delay_are_never_seen(of_all: Chain) -> None:
    texts = [one.text for one in unobservable(of_all, np.zeros(len(of_all.parameters)), WIDE, CARRIED)]
    assert "+1 force-gain (all 8) +1 accelerometer-gain (all 14)" in texts
    assert "+1 force-delay (all 8) +1 accelerometer-delay (all 14)" in texts


def test_the_common_softness_of_all_cells_is_that_of_each_of_them(of_all: Chain) -> None:
    """All stiffer and their common compliance higher: nothing has changed. Of cells that one channel sums, the sum counts."""
    found = unobservable(of_all, np.zeros(len(of_all.parameters)), WIDE, CARRIED)
    expected = [
        {"fmd-compliance:vertical": 1.0, **{f"cell-stiffness:{k}z": 1.0 for k in range(1, 5)}},
        {"fmd-compliance:lateral": 1.0, **{f"cell-stiffness:{k}{a}": 1.0 for k in range(1, 5) for a in "xy"}},
        {"cell-stiffness:1x": 1.0, "cell-stiffness:2x": -1.0},
        {"cell-stiffness:1y": 1.0, "cell-stiffness:4y": -1.0},
        {"force-gain:fmd-x12": 1.0},
    ]
    seen = [outside(of_all, found, weights) for weights in expected]
    assert_allclose(seen[:4], 0, atol=1e-9)
    assert seen[4] > 0.1
    assert len(found) == 8


def outside(of_all: Chain, found: tuple, weights: dict[str, float]) -> float:
    """How much of a direction lies outside the combinations `found`, relative to its length in tolerances."""
    names = [one.name for one in of_all.parameters]

    def vector(offsets: dict[str, float]) -> np.ndarray:
        v = np.array([offsets.get(name, 0.0) for name in names]) / of_all.tolerances
        return v / np.linalg.norm(v)

    basis = np.linalg.qr(np.array([vector(dict(one.weights)) for one in found]).T)[0]
    v = vector(weights)
    return float(np.linalg.norm(v - basis @ (basis.T @ v)))


def test_nothing_shows_of_a_combination_however_far_it_is_driven(of_all: Chain) -> None:
    """Not in the Jacobian only: a delay of a quarter of a millisecond of all channels leaves every reading to another motion."""
    theta = of_all.theta({name: 2.5e-4 for one in of_all.parameters if (name := one.name).split("-")[1].startswith("delay")})
    A0, A1 = of_all.rows(theta, WIDE)
    B0, B1 = of_all.rows(np.zeros(len(theta)), WIDE)
    A, B = A0 + A1 @ CARRIED, B0 + B1 @ CARRIED
    for a, b in zip(A, B, strict=True):
        a, b = (m / np.linalg.norm(b, axis=1)[:, None] for m in (a, b))
        left = a - b @ np.linalg.lstsq(b, a, rcond=None)[0]
        assert_allclose(left, 0, atol=1e-12)


def test_an_unknown_mass_hides_the_ratio_of_the_gains(of_all: Chain) -> None:
    """With CARRIED known the ratio is seen; with all of CARRIED unknown in proportion it is not: that is what the tare is for."""
    theta = np.zeros(len(of_all.parameters))
    known = unobservable(of_all, theta, WIDE, CARRIED)
    unknown = unobservable(of_all, theta, WIDE, CARRIED, structure={"all of H": 0.01 * CARRIED})
    assert len(unknown) == len(known) + 1
    assert "+1 accelerometer-gain (all 14) -1 fmd-compliance (all 2) +100 all of H" in [one.text for one in unknown]


def test_without_channels_to_spare_nothing_is_seen(paper: ChannelTable) -> None:
    """Six accelerations and no force: any reading is a motion."""
    ups = ChannelTable(channels=tuple(channel for channel in paper.channels if channel.group == "table"))
    of_all = chain(ups, stiffness=np.inf)
    J = seen_changes(of_all, np.zeros(len(of_all.parameters)), WIDE, CARRIED)
    assert_allclose(J, 0, atol=1e-14)
    assert len(unobservable(of_all, np.zeros(len(of_all.parameters)), WIDE, CARRIED)) == len(of_all.parameters)
