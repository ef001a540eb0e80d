"""A frame in a few lines: closed forms of shear frames and cantilevers, gravity, joints, and what is refused."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from fem.modes import fixed_base, lowest
from fem.structure import gradients, hold, place_rows, position_of
from fem.user_model import frame, reading
from geometry.errors import BadInput
from geometry.toml_file import STANDARD_GRAVITY

E, MASS, L, WIDTH, THICKNESS = 210e9, 1.83, 0.2, 80e-3, 1e-3
I = WIDTH * THICKNESS**3 / 12
LIGHT = {"youngs_modulus": "210 GPa", "poisson_ratio": 0.3}
BUILDING = {
    "kind": "frame",
    "nodes": {"foot": "0 mm", "floor-1": "200 mm", "floor-2": "400 mm", "floor-3": "600 mm"},
    "fixed": ["foot"],
    "moves": ["x"],
    "members": {"walls-1": ["foot", "floor-1"], "walls-2": ["floor-1", "floor-2"], "walls-3": ["floor-2", "floor-3"]},
    "section": {"width": "80 mm", "thickness": "1 mm", "across": "x", "count": 2},
    "material": LIGHT,
    "masses": {f"floor-{k}": "1.83 kg" for k in (1, 2, 3)},
}
STOREY = 2 * 12 * E * I / L**3
DRIFT = np.eye(3) - np.eye(3, k=-1)


def frequencies(structure, more=0.0):
    """[Hz] of the three floors; what has no mass follows without inertia."""
    shares = eigh(structure.mass.toarray(), structure.stiffness.toarray() + more, eigvals_only=True)[::-1][:3]
    return 1 / (2 * np.pi * np.sqrt(shares))


def chain(stiffness):
    """[Hz] of three masses on springs, one above the other."""
    return np.sqrt(eigh(DRIFT.T @ np.diag(stiffness) @ DRIFT, MASS * np.eye(3), eigvals_only=True)) / (2 * np.pi)


def test_a_building_of_thin_walls_is_a_chain_of_masses_on_twelve_ei_over_l_cubed():
    found = frame.structure(BUILDING, "building")
    assert found.grounded
    assert_allclose(frequencies(found), chain([STOREY] * 3), rtol=1e-3)  # ends that give a ten-thousandth, and shear
    assert list(found.places) == ["floor-1", "floor-2", "floor-3"]
    assert set(found.part_mass) == {"floor-1", "floor-2", "floor-3"}
    assert found.joints[:3] == ("walls-1@foot", "all@floor-1", "walls-1@floor-1")


def test_the_weight_above_takes_six_fifths_of_itself_over_the_height_from_a_storey():
    found = frame.structure(BUILDING, "building")
    weights = STANDARD_GRAVITY * MASS * np.array([3, 2, 1])
    share = 1.2 * weights / L / STOREY
    assert_allclose(100 * share, [7.7, 5.1, 2.6], atol=0.05)  # as the data of the building say
    gravity = sum(one.toarray() for one in found.geometric.values())
    assert_allclose(frequencies(found, gravity), chain(STOREY * (1 - share)), rtol=1e-3)
    hanging = frame.structure(BUILDING | {"down": "z"}, "building")
    assert_allclose(sum(one.toarray() for one in hanging.geometric.values()), -gravity, atol=1e-9 * np.abs(gravity).max())


def test_parts_add_up_and_sections_side_by_side_add():
    one, four = (
        frame.structure(BUILDING | {"section": BUILDING["section"] | {"count": count}, "material": "steel"}, "b")
        for count in (1, 4)
    )
    for whole in (one, four):
        assert_allclose(sum(K.toarray() for K in whole.part_stiffness.values()), whole.stiffness.toarray())
        assert_allclose(sum(M.toarray() for M in whole.part_mass.values()), whole.mass.toarray())
    assert_allclose(four.stiffness.toarray(), 4 * one.stiffness.toarray())
    walls = 7850 * 3 * 0.2 * WIDTH * THICKNESS
    x = one.rigid[:, 0]
    heavier = float(x @ (four.mass - one.mass).toarray() @ x)
    assert_allclose(heavier, 3 * walls, rtol=0.03)  # the library's steel has its own density


def test_a_cantilever_of_more_elements_goes_to_its_closed_form_with_the_fourth_power():
    rod = {
        "nodes": {"foot": "0 m", "tip": "1 m"},
        "fixed": ["foot"],
        "members": {"rod": ["foot", "tip"]},
        "section": {"width": "20 mm", "thickness": "5 mm", "across": "x"},
        "material": {"density": "7800 kg/m^3", "youngs_modulus": "210 GPa", "poisson_ratio": 0.3},
    }
    exact = 4.694091133**2 / (2 * np.pi) * np.sqrt(E * 5e-3**2 / 12 / 7800)  # second bending mode, Euler's beam
    off = []
    for count in (2, 4):
        found = frame.structure(rod | {"elements": count}, "rod")
        shares = eigh(found.mass.toarray(), found.stiffness.toarray(), eigvals_only=True)[::-1]
        all_of_them = 1 / (2 * np.pi * np.sqrt(np.maximum(shares, 1e-12)))
        off.append(np.abs(all_of_them - exact).min() / exact)
    assert off[1] < 2e-3
    assert off[0] > 6 * off[1] or off[1] < 4e-4  # beyond, shear and the ends that give are all that is left


def test_a_member_that_weighs_says_how_far_its_mass_bows_it_between_its_ends() -> None:
    def portal(elements: int, material: object):
        nodes = {"a": ["0 m"] * 3, "b": ["2 m", "0 m", "0 m"], "c": ["0 m", "0 m", "1.5 m"], "d": ["2 m", "0 m", "1.5 m"]}
        members = {"left": ["a", "c"], "right": ["b", "d"], "beam": ["c", "d"]}
        section = {"width": "40 mm", "thickness": "40 mm", "across": "y", "count": 2}
        table = {"kind": "frame", "nodes": nodes, "fixed": ["a", "b"], "members": members, "section": section}
        return frame.structure(table | {"material": material, "masses": {"c": "1 kg"}, "elements": elements}, "portal")

    coarse = portal(2, "steel")
    modes, true = fixed_base(coarse, 9), fixed_base(portal(12, "steel"), 9)
    squares = (2 * np.pi * modes.frequency) ** 2
    told = np.diag(np.sum(list(coarse.elements.unresolved(modes.shapes, squares).values()), axis=0)) / squares
    off = 1 - (true.frequency / modes.frequency) ** 2
    assert off.max() > 0.02
    shown = off > 1e-3
    assert np.all((off[shown] / told[shown] > 0.8) & (off[shown] / told[shown] < 2))
    light = portal(2, LIGHT).elements.unresolved(modes.shapes, squares)
    assert np.max(np.abs(list(light.values()))) < 1e-9 * squares.max()  # what has no mass is exact between its ends


def test_it_stands_in_a_file_of_its_own_or_in_a_model_file(tmp_path: Path):
    text = """format = 1
[fe_model]
kind = "frame"
nodes = { foot = "0 m", top = "0.2 m" }
fixed = ["foot"]
moves = ["x"]
members = { wall = ["foot", "top"] }
section = { width = "80 mm", thickness = "1 mm", across = "x" }
material = { youngs_modulus = "210 GPa", poisson_ratio = 0.3 }
masses = { top = "1.83 kg" }
loss_factor = 0.01
"""
    (tmp_path / "wall.toml").write_text(text)
    (tmp_path / "study.toml").write_text(text.replace("[fe_model]", '[model]\narticle = "wall"\n[fe_model]'))
    for name in ("wall.toml", "study.toml"):
        found = reading.load(tmp_path / name)
        assert found.model.loss_factors == {"wall": 0.01}
        assert found.damping.loss_factors == {"wall": 0.01}


@pytest.mark.parametrize(
    ("change", "field", "words"),
    [
        ({"nodes": {"foot": "0 m", "floor-1": 0.2}}, "nodes.floor-1", "needs its unit"),
        ({"fixed": ["cellar"]}, "fixed", "no node is called 'cellar'"),
        ({"moves": ["sideways"]}, "moves", "sideways"),
        ({"members": {"walls": ["foot", "foot"]}}, "members.walls", "two nodes apart"),
        ({"members": {"walls": ["foot"]}}, "members.walls", "two names of nodes"),
        ({"section": {"width": "80 mm", "thickness": "1 mm", "across": "z"}}, "members.walls-1", "thin along its own direction"),
        ({"section": {"width": "80 mm", "thickness": "1 mm", "across": "x", "count": 0}}, "section.count", "from 1 to 1000"),
        ({"masses": {}}, "masses", "nothing has mass"),
        ({"masses": {"roof": "1 kg"}}, "masses", "no node is called 'roof'"),
        ({"elements": 0}, "elements", "from 1 to 100"),
        ({"loss_factor": 3}, "loss_factor", "below 2"),
        ({"colour": "red"}, "colour", "unknown key"),
        ({"support": "bse"}, "support", "Did you mean base"),
        ({"support": "free"}, "support", "is 'free', and fixed nodes are foot"),
        ({"support": "base", "fixed": []}, "support", "is 'base', and fixed nodes are none"),
        ({"material": "adamant"}, "material", "no material is called 'adamant'"),
    ],
)
def test_what_makes_no_frame_is_refused_with_its_place(change, field, words):
    with pytest.raises(BadInput, match=words) as refused:
        frame.structure(BUILDING | change, "building.toml")
    assert field in refused.value.field


CANTILEVER = {
    "nodes": {"foot": "0 m", "tip": "1 m"},
    "fixed": ["foot"],
    "members": {"rod": ["foot", "tip"]},
    "section": {"width": "12 mm", "thickness": "5 mm", "across": "x"},
    "material": "steel",
}


@pytest.mark.parametrize("count", [1, 2])
def test_a_point_between_nodes_moves_as_the_beam_bends_there(count: int) -> None:
    """Of a cantilever under a force at its tip, x² (3 L - x) / 2 L³ of what the tip does, whatever its beams end."""
    found = frame.structure(CANTILEVER | {"elements": count}, "rod")
    assert_allclose(found.points, [[0, 0, 0], [0, 0, 1], [0, 0, 0.5]][: 1 + count])
    force = found.places["tip"].toarray()[0]
    u = np.linalg.solve(found.stiffness.toarray(), force)
    for x in (0.25, 0.6, 1.0):
        moved = place_rows(found, [0.0, 0.0, x])[0] @ u
        assert_allclose(moved, [x**2 * (3 - x) / 2 * (force @ u), 0, 0], rtol=1e-3, atol=1e-3 * (force @ u))  # shear, joints
    with pytest.raises(BadInput, match="lies 200 mm outside the mesh"):
        place_rows(found, [0.0, 0.0, 1.2])


@pytest.mark.parametrize("moves", [["x", "z", "ry"], ["x", "ry"], ["x", "y", "z", "rx", "ry", "rz"]])
def test_a_place_of_a_frame_is_where_its_node_is_and_moves_beside_it_as_the_beam_does(moves: list[str]) -> None:
    """In a plane nothing said where: no blow and no pick-up beside its point was looked for, and 30 mm were not found."""
    found = frame.structure(CANTILEVER | {"elements": 4, "moves": moves}, "rod")
    at = position_of(found, "tip")
    assert at is not None
    assert_allclose(at, [0, 0, 1], atol=1e-12)
    u = np.linalg.solve(found.stiffness.toarray(), found.places["tip"].toarray()[0])
    beside = gradients(found, ["tip"], u[:, None])["tip"]
    for by in (0.005, 0.03, 0.1):
        moved = (place_rows(found, [0.0, 0.0, 1.0 - by])[0] @ u - place_rows(found, at)[0] @ u)[0]
        assert_allclose(beside.shifted(2, -by)[0][0, 0], moved, rtol=1e-3)
        assert abs(moved) > by * abs(found.places["tip"].toarray()[0] @ u)


def test_beside_a_node_where_members_meet_a_place_moves_as_that_member_on_whose_side_it_is() -> None:
    """Beyond the middle of a lintel, forced there, the one member went on as if the other were not: 6 % of a shift of 10 mm, 18 %
    of 30 mm. A blow that far beside its point was unknown, a pick-up told with a joint that is not there."""
    members = {"left": ["foot", "corner"], "near": ["corner", "middle"], "far": ["middle", "tip"]}
    nodes = {"foot": [0, 0, 0], "corner": [0, 0, 0.6], "middle": [0.3, 0, 0.6], "tip": [0.6, 0, 0.6]}
    section = {"width": "12 mm", "thickness": "5 mm", "across": "y"}
    given = CANTILEVER | {
        "section": section,
        "nodes": {k: [f"{x} m" for x in at] for k, at in nodes.items()},
        "fixed": ["foot", "tip"],
    }
    found = frame.structure(given | {"members": members, "elements": 4, "moves": ["x", "z", "ry"]}, "lintel")
    middle = found.places["middle"].toarray()[2]
    u = np.linalg.solve(found.stiffness.toarray(), middle)
    beside = gradients(found, ["middle"], u[:, None])["middle"]
    (far,) = (block for block in found.elements.blocks if block.part == "far")  # which a joint that comes to give lets go
    lifted = u + (middle @ u) * np.isin(np.arange(len(u)), found.elements.own[found.elements.first[far.nodes] + 2])
    opened = gradients(found, ["middle"], lifted[:, None])["middle"]
    for by in (-0.06, -0.03, -0.01, 0.01, 0.03, 0.06):
        moved = place_rows(found, [0.3 + by, 0.0, 0.6])[0] @ u - found.places["middle"] @ u
        assert_allclose(beside.shifted(0, by)[0][2, 0], moved[2], atol=2e-4 * abs(middle @ u))
        assert_allclose(opened.shifted(0, by)[0], beside.shifted(0, by)[0], atol=1e-9 * abs(middle @ u))
        slope = (beside.shifted(0, by + 1e-6)[0] - beside.shifted(0, by - 1e-6)[0]) / 2e-6
        assert_allclose(beside.shifted(0, by)[1], slope, rtol=1e-4, atol=1e-6 * np.abs(slope).max())


@pytest.mark.parametrize("moves", [["x"], ["x", "y", "z", "rx", "ry", "rz"]])
def test_a_frame_on_a_base_has_the_modes_of_one_on_the_ground_and_its_mass_rides_along(moves: list[str]) -> None:
    stated = CANTILEVER | {"elements": 4, "moves": moves, "masses": {"tip": "2 kg"}}
    ground, base = (frame.structure(stated | {"support": support}, "rod") for support in ("ground", "base"))
    assert (ground.grounded, base.grounded, len(ground.held)) == (True, False, 0)
    of = [lowest(hold(one).stiffness, hold(one).mass, 4).values for one in (ground, base)]
    assert_allclose(of[1], of[0], rtol=1e-9)
    assert_allclose(base.rigid_mass[:3, :3], np.eye(3) * (2 + 12e-3 * 5e-3 * 7850), rtol=1e-9)
    assert_allclose(base.stiffness @ base.rigid, 0, atol=1e-9 * np.abs(base.stiffness.data).max())


@pytest.mark.parametrize("count", [1, 3, 6])
def test_rigid_motions_alone_of_a_free_frame_that_loses_energy_feed_none_in(count: int) -> None:
    """Rounding was held against rounding, and a loss factor of -1e-11 was refused."""
    nodes = {"a": ["0 mm", "0 mm", "0 mm"], "b": ["400 mm", "0 mm", "0 mm"], "c": ["400 mm", "300 mm", "0 mm"]}
    members = {"long": ["a", "b"], "short": ["b", "c"]}
    section = {"width": "20 mm", "thickness": "10 mm", "across": "z"}
    stated = {"kind": "frame", "nodes": nodes, "members": members, "section": section, "material": "steel", "elements": 4}
    modes = fixed_base(frame.structure(stated | {"loss_factor": 0.01}, "bent"), count)
    assert_allclose(modes.frequency, 0.0)
    assert_allclose(modes.damping_ratio, 0.0)
