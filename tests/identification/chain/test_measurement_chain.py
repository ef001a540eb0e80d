"""The measurement chain against what it must be at nominal, against differences, and against what a change of one part does."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.sensors import Channel, ChannelTable, Place, Tolerances, motion_rows, resultants
from identification.chain import ASSUMED, STATED, Chain, chain

FREQUENCY = np.array([4.0, 11.3, 32.0])
STIFFNESS = (1e8, 1e8, 4e8)
CLOSED = {
    "board-delay": 1e-5,
    "force-highpass": 0.1,
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
    return chain(table, stiffness=STIFFNESS, overrides=CLOSED)


def drawn(made: Chain, rng: np.random.Generator, size: float = 1.0) -> np.ndarray:
    return size * made.tolerances * rng.normal(size=len(made.parameters))


def test_nominal_rows_are_those_of_the_sensors(paper: ChannelTable) -> None:
    """Zero offsets: accelerometers read [G] u, and the resultants of what the cells read are H u."""
    made = chain(paper, stiffness=np.inf)
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


def test_every_family_of_the_likelihood_is_there(paper: ChannelTable) -> None:
    families = {one.family for one in chain(paper).parameters}
    assert families == {
        *("force-gain", "force-delay", "accelerometer-gain", "accelerometer-delay", "accelerometer-position"),
        *("accelerometer-misalignment", "cell-stiffness", "fmd-compliance", "force-crosstalk"),
    }
    assert {one.family for one in everything(paper).parameters} == families | set(CLOSED)


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


def test_a_pick_up_on_the_structure_is_left_out_with_a_word(paper: ChannelTable) -> None:
    place = Place(position=np.array([0.0, 0.0, 0.4]), direction=np.array([1.0, 0.0, 0.0]))
    tip = Channel(name="mast-top-x", quantity="acceleration", group="article", places=(place,))
    made = chain(ChannelTable(channels=(tip, *paper.channels)), stiffness=STIFFNESS)
    assert made.left_out == ("mast-top-x",)
    assert "mast-top-x" not in made.names
    assert len(made.remarks) == 1
    assert "mast-top-x" in made.remarks[0]
    assert not chain(paper, stiffness=STIFFNESS).remarks


def test_what_is_assumed_of_the_cells_is_said(paper: ChannelTable, loads_only: ChannelTable) -> None:
    assert [remark.split(":")[0] for remark in chain(paper).remarks] == ["the stiffness of the load cells is not stated"]
    assert "resultants" in chain(loads_only, stiffness=STIFFNESS).remarks[0]


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
    with pytest.raises(BadInput, match="stiffness"):
        chain(paper, stiffness=(1e8, -1e8, 1e8))
