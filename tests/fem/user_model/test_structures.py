"""Structures on the ground, free and on a base, with parts, places, supports and joints: what comes in is what was described."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.linalg import eigvalsh
from scipy.sparse import csr_array

from fem.dynamic_mass import direct
from fem.modes import fixed_base
from fem.structure import Structure, place_rows
from fem.user_model import reading
from geometry.errors import BadInput
from geometry.frames import rigid_transformation
from geometry.toml_file import STANDARD_GRAVITY

Arrays = dict[str, np.ndarray]
Saved = Callable[..., Path]
Own = dict[str, Any]

HEAD = 'format = 1\n[fe_model]\nkind = "matrices"\nunits = "mm-t-N-s"\n'
BASE = HEAD + 'reference_point = ["0 mm", "0 mm", "0 mm"]\ninterface = [101]\n'
GROUND = HEAD + 'support = "ground"\n'
FREE = HEAD + 'support = "free"\n'

BRIDGE = """
format = 1

[fe_model]
name = "footbridge"
kind = "matrices"
units = "consistent"
support = "ground"
supports = ["y1", "y2", "z1", "z2"]
file = "$MASSLINE_DATA/footbridge/model.npz"

[fe_model.parts.Frame]
tolerance = { modulus = 0.05 }
"""

CLAMPED = slice(6, None)
"""Rows of the bracket that are left when its foot, node 101, is clamped."""


@pytest.fixture
def bridge(data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> reading.UsersModel:
    """The footbridge of 17 parts whose data others have measured."""
    monkeypatch.setenv("MASSLINE_DATA", str(data))
    (tmp_path / "bridge.toml").write_text(BRIDGE, encoding="utf-8")
    return reading.load(tmp_path / "bridge.toml")


@pytest.fixture
def shares(own_model: Own) -> tuple[dict[str, np.ndarray], dict[str, np.ndarray]]:
    """Stiffness and mass of the bracket's column and arm."""
    parts = own_model["parts"]()
    stiffness, mass = ({name: parts[f"{kind}/{name}"] for name in ("column", "arm")} for kind in ("stiffness", "mass"))
    return stiffness, mass


@pytest.fixture
def parted(arrays: Arrays, own_model: Own) -> Arrays:
    """The bracket by its parts alone."""
    return {name: arrays[name] for name in ("dof", "nodes", "coordinates")} | own_model["parts"]()


def lowest(K: np.ndarray, M: np.ndarray, count: int) -> np.ndarray:
    """Frequencies [Hz] of matrices in mm, t and s, by LAPACK."""
    return np.sqrt(np.maximum(eigvalsh(K, M)[:count], 0)) / (2 * np.pi)


def clamped(arrays: Arrays) -> Arrays:
    """The bracket with its foot taken away, as a grounded model is exported."""
    kept = {name: arrays[name][CLAMPED, CLAMPED] for name in arrays if name.split("/")[0] in ("stiffness", "mass")}
    return arrays | kept | {"dof": arrays["dof"][CLAMPED]}


# --- on the ground ----------------------------------------------------------------------------------------------------------


def test_the_footbridge_stands_on_its_springs(bridge: reading.UsersModel) -> None:
    """Its nominal frequencies are those of the README of the data, which other code computed."""
    structure = bridge.model
    published = sorted([4.875, 4.660, 6.654, 9.901, 11.381])
    assert_allclose(fixed_base(structure, 5).frequency, published, atol=6e-4)
    assert len(structure.part_stiffness) == 17
    assert structure.supports == ("y1", "y2", "z1", "z2")
    assert structure.part_tolerances == {"Frame": {"modulus": 0.05}}
    assert len(structure.places) == 58
    assert structure.places["dof-301"].indices.tolist() == [301]
    assert "not known" in bridge.notes[0]


def test_clamped_to_the_ground_a_structure_has_the_modes_that_it_has_on_its_base(arrays: Arrays, saved: Saved) -> None:
    held = fixed_base(reading.read(saved(arrays, BASE)), 12)
    grounded = reading.read(saved(clamped(arrays), GROUND))
    assert grounded.grounded
    assert not len(grounded.held)
    assert_allclose(fixed_base(grounded, 12).frequency, held.frequency, rtol=1e-9)


def test_springs_to_the_ground_are_those_that_were_stated(arrays: Arrays, saved: Saved) -> None:
    """Against the same springs added by hand: 1e4 N/mm along y is 1e7 N/m, and so on."""
    joint = '[fe_model.places]\nfoot = 101\n[fe_model.joints.soil]\nbetween = ["foot", "ground"]\ntolerance = 0.2\n'
    stiffness = 'stiffness = ["2e7 N/m", "1e7 N/m", "3e7 N/m", "1e5 N m/rad", "2e5 N m", "3e8 N mm"]\n'
    found = reading.read(saved(arrays, GROUND + joint + stiffness))
    K = arrays["stiffness"].copy()
    K[np.arange(6), np.arange(6)] += [2e4, 1e4, 3e4, 1e8, 2e8, 3e8]
    assert_allclose(fixed_base(found, 8).frequency, lowest(K, arrays["mass"], 8), rtol=1e-8)
    assert found.supports == ("soil",)
    assert list(found.part_stiffness) == ["structure", "soil"]
    assert found.part_tolerances["soil"] == {"modulus": 0.2}


def test_rows_without_coordinates_are_enough_on_the_ground(arrays: Arrays, saved: Saved) -> None:
    named = clamped(arrays)
    bare = {name: named[name] for name in ("stiffness", "mass", "dof")}
    nameless = {name: named[name] for name in ("stiffness", "mass")}
    expected = lowest(named["stiffness"], named["mass"], 6)
    assert_allclose(fixed_base(reading.read(saved(bare, GROUND)), 6).frequency, expected, rtol=1e-8)
    unknown = GROUND.replace("mm-t-N-s", "consistent")
    assert_allclose(fixed_base(reading.read(saved(nameless, unknown)), 6).frequency, expected, rtol=1e-8)


@settings(max_examples=10, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(length=st.floats(1e-4, 1e4), mass=st.floats(1e-4, 1e4))
def test_frequencies_are_right_in_units_that_nobody_knows(length: float, mass: float, arrays: Arrays, saved: Saved) -> None:
    """Another unit of length and mass scales rows of translations, and all; the second stays."""
    named = clamped(arrays)
    scale = np.where(named["dof"][:, 1] <= 3, 1.0, length) * np.sqrt(mass)
    other = {name: named[name] * np.outer(scale, scale) for name in ("stiffness", "mass")}
    found = reading.read(saved(other, GROUND.replace("mm-t-N-s", "consistent")))
    assert_allclose(fixed_base(found, 4).frequency, lowest(named["stiffness"], named["mass"], 4), rtol=1e-7)


# --- free -------------------------------------------------------------------------------------------------------------------


def test_a_free_structure_has_its_rigid_motions_and_the_modes_of_its_matrices(arrays: Arrays, saved: Saved) -> None:
    found = reading.read(saved(arrays, FREE + "loss_factor = 0.01\n"))
    assert found.floating
    modes = fixed_base(found, 12)
    assert_allclose(modes.frequency[:6], 0, atol=0)
    assert_allclose(modes.frequency[6:], lowest(arrays["stiffness"], arrays["mass"], 12)[6:], rtol=1e-7)
    assert_allclose(modes.damping_ratio[6:], 0.005, rtol=1e-6)
    assert_allclose(modes.damping_ratio[:6], 0, atol=0)


# --- parts ------------------------------------------------------------------------------------------------------------------


def test_parts_are_the_whole(arrays: Arrays, parted: Arrays, saved: Saved) -> None:
    whole = reading.read(saved(arrays, BASE))
    for given_too in ({}, {"stiffness": arrays["stiffness"], "mass": arrays["mass"]}):
        found = reading.read(saved(parted | given_too, BASE))
        assert list(found.part_stiffness) == ["column", "arm"]
        for one, other in ((found.stiffness, whole.stiffness), (found.mass, whole.mass)):
            assert_allclose(one.toarray(), other.toarray(), rtol=0, atol=1e-12 * abs(other).max())
        assert_allclose(sum(found.part_mass.values()).toarray(), found.mass.toarray(), rtol=0, atol=0)


@pytest.mark.parametrize("ending", [".h5", ".npz"])
def test_parts_are_sparse_or_dense(ending: str, parted: Arrays, saved: Saved) -> None:
    dense = reading.read(saved(parted, BASE))
    pieces = ("data", "indices", "indptr", "shape")
    arrays = {name: array for name, array in parted.items() if "/" not in name}
    for name in parted.keys() - arrays.keys():
        arrays |= {f"{name}/{piece}": getattr(csr_array(parted[name]), piece) for piece in pieces}
    found = reading.read(saved(arrays, BASE, ending))
    assert found.part_stiffness.keys() == dense.part_stiffness.keys()
    for name, share in found.part_stiffness.items():
        assert_allclose(share.toarray(), dense.part_stiffness[name].toarray(), rtol=0, atol=0)


def test_a_loss_factor_of_a_part_is_that_parts_alone(parted: Arrays, saved: Saved) -> None:
    text = BASE + "[fe_model.parts.arm]\nloss_factor = 0.1\ntolerance = { loss_factor = 0.3, density = 0.01 }\n"
    found = reading.load(saved(parted, text))
    assert found.damping.loss_factors == {"arm": 0.1}
    S = 0.1 * found.model.part_stiffness["arm"].toarray()[6:, 6:]
    K, M = (A.toarray()[6:, 6:] for A in (found.model.stiffness, found.model.mass))
    P = (found.model.mass @ found.model.rigid)[6:]
    omega = 2 * np.pi * 150.0
    expected = found.model.rigid_mass + omega**2 * P.T @ np.linalg.solve(K + 1j * S - omega**2 * M, P)
    assert_allclose(direct(found.model, [150.0], found.damping).matrix[0], expected, rtol=1e-8, atol=1e-9)
    assert found.model.part_tolerances == {"arm": {"loss_factor": 0.3, "density": 0.01}}


def test_a_thickness_is_what_its_shares_say(parted: Arrays, saved: Saved) -> None:
    """Membrane and bending of a shell, from a file that brings both; here the arm, a quarter of it membrane."""
    share = parted["stiffness/arm"]
    given = parted | {"membrane/arm": 0.25 * share, "bending/arm": 0.75 * share}
    found = reading.read(saved(given, BASE + "[fe_model.parts.arm]\ntolerance = { thickness = 0.02 }\n"))
    membrane, bending = found.sections["arm"]
    thicker = 1.1 * membrane + 1.1**3 * bending - found.part_stiffness["arm"]
    assert_allclose(thicker.toarray(), (0.025 + 0.75 * 0.331) * found.part_stiffness["arm"].toarray(), rtol=1e-9, atol=1e-3)


STOREYS = """format = 1
[fe_model]
name = "tower"
kind = "matrices"
units = "m-kg-N-s"
support = "ground"
down = "-z"
[fe_model.places]
floor-1 = { dof = [0, -1, -1] }
floor-2 = { dof = [1, -1, -1] }
"""


@pytest.fixture
def tower() -> Arrays:
    """Two floors of 2 and 3 kg on walls of 4 and 5 kN/m."""
    walls = {"stiffness/lower": np.diag([4e3, 0.0]), "stiffness/upper": 5e3 * np.array([[1.0, -1.0], [-1.0, 1.0]])}
    return walls | {"mass": np.diag([2.0, 3.0])}


def test_storeys_of_matrices_lean_under_what_stands_on_them(tower: Arrays, saved: Saved, tmp_path: Path) -> None:
    """Stated or weighed, or the array of another code: clamped columns of height h under W push with 6/5 W / h."""
    heights = 'lower = { above = "floor-1", height = "0.2 m", weight = "49.03325 N" }\n'
    heights += 'upper = { below = "floor-1", above = "floor-2", height = "300 mm", weight = "29.41995 N", hinged = true }\n'
    found = reading.read(saved(tower, f"{STOREYS}[fe_model.storeys]\n{heights}"))
    g, one = STANDARD_GRAVITY, np.array([[1.0, -1.0], [-1.0, 1.0]])
    assert_allclose(found.geometric["lower"].toarray(), np.diag([-1.2 * 5 * g / 0.2, 0.0]), rtol=1e-9)
    assert_allclose(found.geometric["upper"].toarray(), -3 * g / 0.3 * one, rtol=1e-9)
    reading.write(found, tmp_path / "written.npz")
    again = reading.read(tmp_path / "written.npz")
    for name, share in found.geometric.items():
        assert_allclose(again.geometric[name].toarray(), share.toarray(), rtol=1e-12)


# --- places -----------------------------------------------------------------------------------------------------------------


def test_a_place_is_its_node_its_coordinates_or_its_rows(arrays: Arrays, saved: Saved) -> None:
    text = BASE + '[fe_model.places]\nnode = 110\npoint = ["100 mm", "0 mm", "300 mm"]\nrows = { dof = [54, 55, 56] }\n'
    found = reading.read(saved(arrays, text + "height = { dof = [-1, -1, 56] }\n"))
    for name in ("node", "point", "rows"):
        assert_allclose(found.places[name].toarray()[:, 54:57], np.eye(3), atol=1e-12)
        assert_allclose(np.abs(found.places[name].toarray()).sum(), 3, atol=1e-12)
    assert_allclose(found.places["height"].toarray().sum(axis=1), [0, 0, 1], atol=0)


def test_a_place_off_its_node_says_so_and_turns_with_it(arrays: Arrays, saved: Saved) -> None:
    text = BASE + '[fe_model.places]\ntip = ["110 mm", "0 mm", "300 mm"]\n'
    found = reading.load(saved(arrays, text))
    assert found.notes == ("The place tip rides on the node at (0.1, 0, 0.3) m, 10 mm away.",)
    moved = found.model.places["tip"] @ found.model.rigid
    assert_allclose(moved, rigid_transformation([0.11, 0.0, 0.3]), atol=1e-12)


POINT = st.tuples(*3 * [st.floats(-0.1, 0.3)])


@settings(max_examples=30, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(point=POINT)
def test_any_place_follows_the_rigid_motions(point: tuple[float, float, float], block: Callable[..., Structure]) -> None:
    """Of nodes that turn and of those that do not, whatever nodes are near."""
    solid = block(3, 3, 4)
    moved = place_rows(solid, point)[0] @ solid.rigid
    assert_allclose(moved, rigid_transformation(point), atol=1e-8)


def test_a_place_moves_on_from_node_to_node_without_a_step(block: Callable[..., Structure]) -> None:
    """Along the way between two nodes, in a field that is no rigid motion, it begins and ends as the nodes move."""
    solid = block(3, 3, 4)
    u = np.sin(7 * solid.points @ [1.0, 2.0, 3.0])[:, None] * [1.0, -1.0, 0.5]
    field = np.zeros(solid.mass.shape[0])
    field[solid.translations] = u
    way = solid.points[13] + np.linspace(0, 1, 41)[:, None] * (solid.points[17] - solid.points[13])
    moved = np.array([row @ field for row in place_rows(solid, way)])
    assert_allclose(moved[[0, -1]], u[[13, 17]], atol=1e-12)
    assert_allclose(moved[[1, -2]], u[[13, 17]], atol=0.05 * np.abs(u).max())


def test_no_place_lies_far_from_all_nodes(arrays: Arrays, saved: Saved) -> None:
    """What was looked for 0.9 m beside a structure rode on its nearest node, and was fitted as next to nothing."""
    found = reading.read(saved(arrays))
    tip = found.points[-1]
    place_rows(found, tip + 0.01)
    with pytest.raises(BadInput, match=r"lies 5 m outside of the structure. The nearest node is at \(.*\) m"):
        place_rows(found, tip + np.array([3.0, 0.0, 4.0]))


def test_a_place_off_the_nodes_of_a_reduced_structure_rides_on_none_of_them(arrays: Arrays, saved: Saved) -> None:
    """Pick-ups 0.6 m above the two feet of a Craig-Bampton frame rode on these: a sound test had a chi² of 4.4e4."""
    found = reading.read(saved(arrays))
    kept = found.points[[0, -1]]
    own = np.concatenate([found.translations[[0, -1]], found.rotations[[0, -1]]])
    modal = np.where(np.isin(np.arange(len(found.rigid)), own)[:, None], found.rigid, 0.0)
    reduced = replace(found, rigid=modal, points=kept, translations=own[:2], rotations=own[2:])
    between = kept.mean(axis=0)
    place_rows(reduced, kept[1] + 0.001)
    place_rows(found, between)
    with pytest.raises(BadInput, match=r"from all nodes, and rows that are of none of these move it.* places/NAME"):
        place_rows(reduced, between)
    foot = replace(reduced, points=kept[:1], translations=own[:1], rotations=own[2:3])
    place_rows(foot, kept[0] + 1e-15)  # what rounding leaves of a pick-up on the only node had been refused
    with pytest.raises(BadInput, match="from all nodes"):
        place_rows(foot, kept[1])


def test_a_structure_without_coordinates_has_no_place_by_coordinates(bridge: reading.UsersModel) -> None:
    with pytest.raises(
        BadInput, match=f"the structure has no coordinates. A place is named there: {next(iter(bridge.model.places))}"
    ):
        place_rows(bridge.model, [0.0, 0.0, 0.0])


# --- joints -----------------------------------------------------------------------------------------------------------------


def cut(arrays: Arrays, shares: tuple[Arrays, Arrays]) -> Arrays:
    """Column and arm with a node of its own each where they met: 107 and 207."""
    index = np.concatenate([np.arange(60), np.arange(36, 42)])
    arm = np.zeros(66, dtype=bool)
    arm[42:] = True
    column = np.zeros(66, dtype=bool)
    column[:42] = True
    nodes, coordinates = np.append(arrays["nodes"], 207), np.vstack([arrays["coordinates"], arrays["coordinates"][6]])
    dof = np.vstack([arrays["dof"], [(207, c) for c in range(1, 7)]])
    whole = {"nodes": nodes, "coordinates": coordinates, "dof": dof}
    for kind, both in zip(("stiffness", "mass"), shares, strict=True):
        for name, own in (("column", column), ("arm", arm)):
            spread = both[name][np.ix_(index, index)]
            whole[f"{kind}/{name}"] = np.where(np.outer(own, own), spread, 0.0)
    return whole


JOINT = '[fe_model.places]\na = 107\nb = 207\n[fe_model.joints.weld]\nbetween = ["a", "b"]\nstiffness = [{}]\n'


def joint(along: float, about: float) -> str:
    listed = [*3 * [f'"{along:g} N/m"'], *3 * [f'"{about:g} N m/rad"']]
    return BASE + JOINT.format(", ".join(listed))


def test_a_joint_becomes_a_weld_as_it_stiffens(arrays: Arrays, shares: tuple[Arrays, Arrays], saved: Saved) -> None:
    """The frequencies come up to those of the bracket in one piece, by a tenth of the way for a joint ten times as stiff."""
    welded = fixed_base(reading.read(saved(arrays, BASE)), 3).frequency
    below = []
    for stiffness in (1e9, 1e10, 1e11):
        found = reading.read(saved(cut(arrays, shares), joint(stiffness, stiffness / 1e3)))
        assert found.joints == ("weld",)
        below.append(welded - fixed_base(found, 3).frequency)
    assert np.all(np.array(below) > 0)
    assert_allclose(below[1] / below[2], 10, rtol=0.1)


def test_a_joint_lets_the_rigid_motions_pass(arrays: Arrays, shares: tuple[Arrays, Arrays], saved: Saved) -> None:
    found = reading.read(saved(cut(arrays, shares), joint(1e7, 1e4)))
    weld = found.part_stiffness["weld"]
    assert_allclose(weld @ found.rigid, 0, atol=1e-9 * abs(weld).max())
    turned = found.rigid[:, 3].copy()
    turned[60:] = 0  # the arm's end stays behind while all else turns about x
    assert turned @ (weld @ turned) == pytest.approx(1e7 * 0.3**2 + 1e4)


def test_a_joint_of_places_apart_works_at_its_own_point(arrays: Arrays, shares: tuple[Arrays, Arrays], saved: Saved) -> None:
    """Between nodes 106 and 207, 50 mm apart, about the upper one: levers of nodes that turn, no work in a rigid motion."""
    text = joint(1e7, 1e4).replace("a = 107", "a = 106\nc = 107").replace("between", 'at = "c"\nbetween')
    found = reading.read(saved(cut(arrays, shares), text))
    weld = found.part_stiffness["weld"]
    assert_allclose(weld @ found.rigid, 0, atol=1e-9 * abs(weld).max())
    moved = np.zeros(66)
    moved[33] = 1.0  # node 106 alone turns about x: its upper end goes along -y
    assert moved @ (weld @ moved) == pytest.approx(1e7 * 0.05**2 + 1e4)


def test_parts_of_the_matrices_may_be_joints(arrays: Arrays, shares: tuple[Arrays, Arrays], saved: Saved) -> None:
    given = cut(arrays, shares)
    spring = np.zeros((66, 66))
    a, b = np.arange(36, 42), np.arange(60, 66)
    k = np.array([1e6, 1e6, 1e6, 1e9, 1e9, 1e9])
    for rows, columns, sign in ((a, a, 1), (b, b, 1), (a, b, -1), (b, a, -1)):
        spring[rows, columns] = sign * k
    found = reading.read(saved(given | {"stiffness/bolt": spring}, BASE + "joints.bolt = {}\n"))
    assert found.joints == ("bolt",)
    same = reading.read(saved(given, joint(1e9, 1e6)))
    assert_allclose(fixed_base(found, 6).frequency, fixed_base(same, 6).frequency, rtol=1e-9)


# --- there and back ---------------------------------------------------------------------------------------------------------


def assert_same_structure(found: Structure, before: Structure) -> None:
    for name in ("rigid", "held", "points", "translations", "rotations", "reference_point"):
        assert_allclose(getattr(found, name), getattr(before, name), rtol=0, atol=0, err_msg=name)
    for name in ("grounded", "supports", "joints", "part_tolerances", "loss_factors"):
        assert getattr(found, name) == getattr(before, name), name
    for name in ("part_stiffness", "part_mass", "places"):
        one, other = getattr(found, name), getattr(before, name)
        assert one.keys() == other.keys()
        for key, matrix in one.items():
            assert_allclose(matrix.toarray(), other[key].toarray(), rtol=0, atol=0, err_msg=f"{name} {key}")
    for name in ("stiffness", "mass"):
        matrix = getattr(before, name)
        assert_allclose(getattr(found, name).toarray(), matrix.toarray(), rtol=0, atol=1e-12 * abs(matrix).max())
    assert found.sections.keys() == before.sections.keys()
    for key, both in found.sections.items():
        for one, other in zip(both, before.sections[key], strict=True):
            assert_allclose(one.toarray(), other.toarray(), rtol=0, atol=0)


@pytest.mark.parametrize("ending", [".h5", ".npz"])
@pytest.mark.parametrize("head", [BASE, GROUND, FREE], ids=["base", "ground", "free"])
def test_a_structure_with_all_its_names_is_written_and_read_back(
    head: str, ending: str, parted: Arrays, saved: Saved, tmp_path: Path
) -> None:
    given = parted | {f"{kind}/arm": 0.5 * parted["stiffness/arm"] for kind in ("membrane", "bending")}
    if head == GROUND:
        given = clamped(given) | {f"{kind}/arm": given[f"{kind}/arm"][CLAMPED, CLAMPED] for kind in ("membrane", "bending")}
    text = head + ('supports = ["column"]\n' if head == GROUND else "") + "joints.arm = {}\nplaces = { tip = 110 }\n"
    text += "[fe_model.parts.arm]\nloss_factor = 0.02\ntolerance = { modulus = 0.05, thickness = 0.01, density = 0.02 }\n"
    before = reading.read(saved(given, text))
    reading.write(before, tmp_path / f"again{ending}", "all of it")
    after = reading.load(tmp_path / f"again{ending}")
    assert after.name == "all of it"
    assert_same_structure(after.model, before)


def test_a_structure_of_unknown_units_is_written_and_read_back(bridge: reading.UsersModel, tmp_path: Path) -> None:
    reading.write(bridge.model, tmp_path / "bridge.npz", units=bridge.units)
    again = reading.load(tmp_path / "bridge.npz")
    assert not again.units.known
    assert_same_structure(again.model, bridge.model)
