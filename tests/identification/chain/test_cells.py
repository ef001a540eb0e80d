"""Load cells: how they share a load, against statics solved without any matrix of ours, and how far the plate moves on them."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.sensors import Channel, ChannelTable, Place, Tolerances
from identification import chain as identification_chain
from identification.chain import Chain, chain

EXACT = Tolerances().scaled(0.0)
CELLS = {"cell-stiffness": 0.05}
K = np.array([1e8, 1.3e8, 4e8])
CORNERS = np.array([[0.13, 0.13, 0.0], [-0.13, 0.13, 0.0], [-0.13, -0.13, 0.0], [0.13, -0.13, 0.0]])
FREQUENCY = np.array([5.0, 20.0])


def forces_of(made: Chain, values: dict[str, float]) -> np.ndarray:
    """(c, 6) what the force channels read for a unit load."""
    return np.asarray(made.rows(made.theta(values), FREQUENCY)[1][0, list(made.forces.columns)].real)


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


def test_equal_cells_share_alike(paper: ChannelTable) -> None:
    reading = forces_of(chain(paper, EXACT), {})
    assert_allclose(reading[:2, 0], 0.5, rtol=1e-12)
    assert_allclose(reading[4:, 2], 0.25, rtol=1e-12)
    assert_allclose(reading[4:, 3], np.array([1, 1, -1, -1]) / (4 * 0.13), rtol=1e-12)


def test_a_stiffer_cell_shows_in_the_redundant_channels_only(paper: ChannelTable) -> None:
    """The parity of the four vertical channels, z1 - z2 + z3 - z4, is no resultant: there it shows."""
    made = chain(paper, EXACT, overrides=CELLS)
    change = forces_of(made, {"cell-stiffness:1z": 0.1}) - forces_of(made, {})
    z = change[4:]
    assert_allclose(np.ones(4) @ z, 0, atol=1e-12)
    assert_allclose(CORNERS[:, :2].T @ z, 0, atol=1e-12)
    assert np.abs(np.array([1, -1, 1, -1]) @ z).max() > 0.01


def closed_form(m: float, I: float, axis: int) -> np.ndarray:
    """Table over cover plate for a rigid block of mass m and moment I on four cells, moved along or turned about `axis` alone."""
    a = 0.13
    stiffness = [4 * K[0], 4 * K[1], 4 * K[2], 4 * K[2] * a**2, 4 * K[2] * a**2, 4 * (K[0] + K[1]) * a**2][axis]
    inertia = m if axis < 3 else I
    return np.asarray(1 - (2 * np.pi * FREQUENCY) ** 2 * inertia / stiffness)


@pytest.mark.parametrize("axis", range(6))
def test_a_block_on_its_cells_moves_as_two_masses_and_a_spring(paper: ChannelTable, axis: int) -> None:
    """With its centre in the plane of the cells no motion drags another: u_table = (1 - omega² m / k) u_cover.

    Without gravity: the table tilts more than the plate, and its accelerometers would feel it.
    """
    m, I = 60.0, 2.0
    made = chain(paper, EXACT, stiffness=K, gravity=0.0)
    A0, A1 = made.rows(np.zeros(len(made.parameters)), FREQUENCY)
    A = A0 + A1 @ np.diag([m, m, m, I, I, I])
    on_table = list(made.table.columns)
    expected = closed_form(m, I, axis)[:, None] * A0[:, on_table, axis]
    assert_allclose(A[:, on_table, axis], expected, rtol=1e-12, atol=1e-15)


def test_softer_cells_by_the_common_factor_are_softer_cells_one_by_one(paper: ChannelTable) -> None:
    made = chain(paper, EXACT, stiffness=K, overrides=CELLS)
    at_once = made.rows(made.theta({"fmd-compliance:lateral": 1.25}), FREQUENCY)
    single = {f"cell-stiffness:{k}{axis}": 1 / 1.25 - 1 for k in range(1, 5) for axis in "xy"}
    one_by_one = made.rows(made.theta(single), FREQUENCY)
    assert_allclose(at_once[1], one_by_one[1], rtol=1e-12, atol=1e-12)


def test_a_stiffness_assumed_wrongly_is_made_good_by_the_compliance(paper: ChannelTable) -> None:
    """Whatever is assumed: at the right factor the chain is that of the true cells."""
    assumed, stated = chain(paper, EXACT), chain(paper, EXACT, stiffness=K * [1, 1 / 1.3, 1])
    lateral, _, vertical = identification_chain.assumed_stiffness() / K
    right = assumed.theta({"fmd-compliance:lateral": lateral, "fmd-compliance:vertical": vertical})
    expected = stated.rows(np.zeros(len(stated.parameters)), FREQUENCY)
    for found, true in zip(assumed.rows(right, FREQUENCY), expected, strict=True):
        assert_allclose(found, true, rtol=1e-12, atol=1e-15)


def test_a_rigid_fmd_has_its_table_move_with_it(paper: ChannelTable) -> None:
    made = chain(paper, stiffness=np.inf)
    assert not any(one.family == "fmd-compliance" for one in made.parameters)
    assert_allclose(made.rows(np.zeros(len(made.parameters)), FREQUENCY)[1][:, list(made.table.columns)], 0, atol=0)


def test_cells_are_numbered_counter_clockwise_whatever_their_order() -> None:
    shuffled = [2, 0, 3, 1]
    elements = [Place(position=CORNERS[k], direction=e) for k in shuffled for e in np.eye(3)]
    assert identification_chain.names(elements, np.zeros(3)) == tuple(f"{k + 1}{axis}" for k in shuffled for axis in "xyz")


def test_struts_along_slanted_lines_share_by_equilibrium_alone() -> None:
    """Six struts: the forces follow from the load whatever their stiffness is."""
    rng = np.random.default_rng(5)
    directions = rng.normal(size=(6, 3))
    directions /= np.linalg.norm(directions, axis=1)[:, None]
    places = [Place(position=p, direction=d) for p, d in zip(rng.uniform(-0.2, 0.2, size=(6, 3)), directions, strict=True)]
    channels = tuple(Channel(name=f"s{k}", quantity="force", group="fmd", places=(place,)) for k, place in enumerate(places))
    made = chain(ChannelTable(channels=channels), EXACT, overrides=CELLS)
    assert len(made.parameters) == 6
    softer = forces_of(made, {made.parameters[2].name: 0.5})
    B = np.array([[*p.direction, *np.cross(p.position, p.direction)] for p in places])
    assert_allclose(B.T @ softer, np.eye(6), rtol=0, atol=1e-10 * np.abs(softer).max())
    assert_allclose(softer, forces_of(made, {}), rtol=0, atol=1e-9 * np.abs(softer).max())


def test_loads_already_worked_out_are_read_as_they_are(loads_only: ChannelTable) -> None:
    made = chain(loads_only, EXACT)
    assert_allclose(forces_of(made, {}), np.eye(6), atol=1e-15)
    targets = {one.name.partition(":")[2] for one in made.parameters if one.family == "fmd-compliance"}
    assert targets == {"lateral", "vertical", "rotation", "torsion"}
    assert not any(one.family == "cell-stiffness" for one in made.parameters)


@pytest.mark.parametrize("stiffness", [(1e8, 1e8), (1e8, 0.0, 1e8), (np.inf, 1e8, 1e8), 5.0])
def test_a_stiffness_that_is_none_is_refused(paper: ChannelTable, stiffness: object) -> None:
    with pytest.raises(BadInput, match="stiffness"):
        chain(paper, stiffness=stiffness)  # type: ignore[arg-type]
