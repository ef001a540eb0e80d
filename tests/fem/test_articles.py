"""Beam models of the built-in articles: the drawing's mass, published modes, joints from local solids, load cells."""

import copy
import json
from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal
from scipy.linalg import eigh

from fem.beam import articles
from fem.beam.articles import ClumodPiece, Joint, Port, reach
from fem.beam.elements import Section, tube
from fem.beam.frame import Member, Plan, assemble
from fem.structure import Structure, rigid_motion
from geometry.article import material
from geometry.articles import NAMES, SETUPS, built_in
from geometry.articles.parts import FOUR_BLADES, ONE_BLADE, Dimensions, load
from geometry.errors import BadInput
from geometry.frames import rigid_transformation_6
from geometry.routes import inertia as drawn_inertia
from tools.reconstruction import frequencies

CONFIGURATIONS = {"clumod-4": (FOUR_BLADES, "four_blades"), "clumod-1": (ONE_BLADE, "one_blade")}
STACKS = (*NAMES, *SETUPS, "disc+cuboid", "disc+disc")


def _held(structure: Structure, count: int) -> np.ndarray:
    """Lowest frequencies [Hz] on a held base."""
    at = np.ix_(structure.free, structure.free)
    inverse = eigh(structure.mass.toarray()[at], structure.stiffness.toarray()[at], eigvals_only=True)
    return 1 / np.sqrt(inverse[::-1][:count]) / (2 * np.pi)


@pytest.mark.parametrize("name", CONFIGURATIONS)
def test_frequencies_of_the_reconstruction_survived_the_cad_detail(name: str, shared: Path) -> None:
    """To what the re-solve leaves to modes that the paper does not print; for those see below."""
    blades, key = CONFIGURATIONS[name]
    modes = json.loads((shared / "clumod" / "reconstruction.json").read_text())["achieved"][key]["f_Hz"]
    assert_allclose(frequencies(assemble(articles.clumod_plan(blades, load("clumod"))), len(modes)), modes, rtol=0.03)


def test_published_mode_structure_holds() -> None:
    four = frequencies(assemble(articles.clumod_plan(FOUR_BLADES, load("clumod"))), 12)
    assert four[0] == pytest.approx(5.70, abs=0.05)
    assert four[10] == pytest.approx(15.50, abs=0.05)
    assert np.sum(np.abs(four - 12.3) <= 0.15) == 4
    assert four[11] >= 37.7
    one = frequencies(assemble(articles.clumod_plan(ONE_BLADE, load("clumod"))), 6)
    assert one[0] == pytest.approx(11.6, abs=0.05)
    assert np.sum(one < 50) == 5


@pytest.mark.parametrize("name", STACKS)
def test_structure_weighs_what_the_drawing_weighs(name: str) -> None:
    expected = drawn_inertia(built_in(name)).mass_matrix
    for options in ({}, {"cells": articles.load_cells()}) if "fmd" in name else ({},):
        found = articles.structure(name, **options).rigid_mass
        assert_allclose(found, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


@pytest.mark.parametrize("name", STACKS)
def test_rigid_motions_cost_no_energy_and_parts_make_the_whole(name: str) -> None:
    structure = articles.structure(name)
    K, M = structure.stiffness.toarray(), structure.mass.toarray()
    assert_allclose(K @ structure.rigid, 0, atol=1e-12 * np.abs(K).max())
    assert_allclose(sum((k.toarray() for k in structure.part_stiffness.values()), 0 * K), K, atol=1e-12 * np.abs(K).max())
    free = np.ix_(structure.free, structure.free)
    assert np.all(np.linalg.eigvalsh(M[free]) > 0)
    assert not structure.free.size or np.linalg.eigvalsh(K[free]).min() > 0
    assert structure.loss_factors.keys() == structure.part_stiffness.keys()
    assert structure.part_stiffness.keys() <= {part.name for part in built_in(name).parts}


@pytest.mark.parametrize("name", STACKS)
def test_points_are_moved_by_the_degrees_of_freedom_they_name(name: str) -> None:
    structure = articles.structure(name)
    for point, dofs in zip(structure.points, structure.translations, strict=True):
        assert_allclose(structure.rigid[dofs], rigid_transformation_6(point)[:3], atol=1e-15)


@pytest.mark.parametrize("name", [name for name in STACKS if name != "fmd"])
def test_twenty_modes_can_be_asked_for(name: str) -> None:
    assert len(articles.structure(name).free) >= 20


def test_fmd_alone_is_rigid() -> None:
    structure = articles.structure("fmd")
    assert structure.free.size == 0
    assert structure.stiffness.nnz == 0


def test_what_stands_on_the_rigid_fmd_keeps_its_frequencies() -> None:
    assert_allclose(_held(articles.structure("fmd+clumod-4"), 16), _held(articles.structure("clumod-4"), 16), rtol=1e-9)
    assert_allclose(_held(articles.structure("fmd+disc+cuboid"), 6), _held(articles.structure("disc+cuboid"), 6), rtol=1e-9)


def test_hub_that_stands_out_beyond_the_mast_keeps_its_mass() -> None:
    higher = {"clumod.blade.upper-short.hub_height_mm": 60.0}
    for name in CONFIGURATIONS:
        expected = drawn_inertia(built_in(name, higher)).mass_matrix
        assert_allclose(articles.structure(name, higher).rigid_mass, expected, rtol=1e-9, atol=1e-9 * np.abs(expected).max())


def test_article_of_twice_the_size_has_half_the_frequencies() -> None:
    sizes = {"disc.diameter_mm": 702.0, "disc.height_mm": 29.0}
    assert_allclose(
        2 * _held(articles.structure("disc", sizes), 6), _held(articles.structure("disc"), 6), rtol=1e-3
    )  # its bolt holes stay


def test_frequencies_hardly_move_when_elements_are_halved() -> None:
    """Blades twist piecewise linearly: with n elements of a half-blade too fast by (pi / 2n)² / 24. Bending is far closer."""
    n = articles.ELEMENTS
    default, finer = (_held(articles.structure("clumod-4", elements=elements), 16) for elements in (n, 2 * n))
    assert_allclose(default[:12], finer[:12], rtol=5e-4)
    assert_allclose(default, finer, rtol=(np.pi / 2 / n) ** 2 / 24)


def test_reach_is_the_collars_radius_less_the_thickness_of_the_blade() -> None:
    """A blade without thickness is held at the collar's edge, a thicker one yields inside it; both half-blades begin there."""
    assert reach(0.05, 0.0) == pytest.approx(0.05)
    assert reach(0.05, 6e-3) == pytest.approx(0.05 - 6e-3)
    d = load("clumod")
    plan = articles.clumod_plan(FOUR_BLADES, d)
    for blade in d["blade"]:
        expected = reach(d["hubs"]["outer_diameter"] / 2, blade["thickness"])
        roots = [plan.nodes[member.nodes[0]] for member in plan.members if member.part == blade["name"]]
        assert_allclose([np.hypot(*root[:2]) for root in roots], [expected, expected], rtol=1e-12)


def _between(a: float, b: float, section: Section) -> np.ndarray:
    """Stiffness (12, 12) of a piece of mast between two heights, in Clumod's axes."""
    member = Member(nodes=(0, 1), section=section, z_axis=np.array([1.0, 0.0, 0.0]), part="mast")
    return assemble(Plan(nodes=np.array([[0, 0, a], [0, 0, b]]), carriers=(0, 1), members=(member,))).stiffness["mast"]


def _massless(section: Section) -> Section:
    return replace(section, mass=0.0, rotary_y=0.0, rotary_z=0.0)


LOWER, UPPER = 0.30, 0.42


def test_joint_between_ports_of_the_mast_acts_as_a_member_between_its_nodes() -> None:
    d = load("clumod")
    ports = (Port(member="mast", at=LOWER), Port(member="mast", at=UPPER))
    plan = articles.clumod_plan(ONE_BLADE, d, joints=[Joint(ports=ports, stiffness=np.zeros((12, 12)))])
    section = _massless(plan.members[0].section)
    ends = tuple(int(np.argmin(np.abs(plan.nodes - [0, 0, z]).sum(axis=1))) for z in (LOWER, UPPER))
    doubled = replace(plan, members=(*plan.members, Member(nodes=ends, section=section, z_axis=np.eye(3)[0], part="mast")))
    expected = frequencies(assemble(doubled), 6)
    stiffness = _between(LOWER, UPPER, section)
    turned = np.roll(np.arange(12), 6)
    for joint in (Joint(ports=ports, stiffness=stiffness), Joint(ports=ports[::-1], stiffness=stiffness[np.ix_(turned, turned)])):
        assert_allclose(frequencies(assemble(articles.clumod_plan(ONE_BLADE, d, joints=[joint])), 6), expected, rtol=1e-9)
    assert np.all(expected >= frequencies(assemble(plan), 6))


def test_joint_at_a_crossing_keeps_mass_and_rigid_motions_and_belongs_to_its_part() -> None:
    """Blade against mast, with a mass that vibrates but does not weigh."""
    z = load("clumod")["blade"][0]["z"]
    ports = (Port(member="mast", at=z - 0.05), Port(member="lower-1", at=-0.1))
    relative = np.hstack(
        [np.linalg.inv(rigid_transformation_6([0, 0, z - 0.05])), -np.linalg.inv(rigid_transformation_6([0, -0.1, z]))]
    )
    stiffness = relative.T @ np.diag([1e6, 1e6, 1e6, 1e4, 1e4, 1e4]) @ relative
    joint = Joint(ports=ports, stiffness=stiffness, mass=1e-9 * stiffness, part="lower-1")
    plain, joined = articles.structure("fmd+clumod-1"), articles.structure("fmd+clumod-1", joints=[joint])
    assert_allclose(joined.rigid_mass, plain.rigid_mass, rtol=1e-9, atol=1e-9)
    assert_allclose(joined.stiffness @ joined.rigid, 0, atol=1e-12 * np.abs(joined.stiffness).max())
    assert joined.part_stiffness.keys() == plain.part_stiffness.keys()
    assert _held(joined, 5)[0] > _held(plain, 5)[0]


SPRING = np.kron([[1.0, -1.0], [-1.0, 1.0]], np.diag([1.0, 1.0, 1.0, 0.0, 0.0, 0.0]))


@pytest.mark.parametrize(
    ("ports", "stiffness", "said"),
    [
        (("upper-log", 0.1), SPRING, "there is no 'upper-log'. Did you mean upper-long"),
        (("lower-1", 0.02), SPRING, "lower-1 is no beam at 20 mm. Its beam goes from 46"),
        (("lower-1", 2.0), SPRING, "no beam at 2000 mm"),
        (("mast", -0.1), SPRING, "mast is no beam at -100 mm"),
        (("mast", 0.5), SPRING + np.eye(12, k=1), "must be symmetric"),
        (("lower-1", 0.2), SPRING, "must let its ports move together rigidly, found a force or moment of"),
    ],
)
def test_joint_that_cannot_be_is_refused(ports: tuple[str, float], stiffness: np.ndarray, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        articles.structure(
            "clumod-4",
            joints=[Joint(ports=(Port(member="mast", at=0.4), Port(member=ports[0], at=ports[1])), stiffness=stiffness)],
        )


def test_cover_plate_bounces_and_turns_on_its_cells_at_closed_form_frequencies() -> None:
    """Straight up sqrt(4 k_z / m), about the axis sqrt(4 k r² / Izz); the others couple."""
    structure = articles.structure("fmd", cells=articles.load_cells())
    lateral, _, axial = articles.load_cells()[0]
    body, side = drawn_inertia(built_in("fmd")), load("fmd")["load_cell"]["square"]
    expected = np.sqrt([4 * axial / body.mass, 4 * lateral * side**2 / 2 / body.tensor[2, 2]]) / (2 * np.pi)
    found = _held(structure, 6)
    assert len(structure.free) == 6
    assert_allclose(np.abs(found[:, None] / expected - 1).min(axis=0), 0, atol=1e-9)


def test_stiff_cells_are_rigid_ones() -> None:
    rigid = _held(articles.structure("fmd+clumod-1"), 8)
    differences = [
        _held(articles.structure("fmd+clumod-1", cells=factor * articles.load_cells()), 8) / rigid - 1 for factor in (1, 100)
    ]
    assert np.all(differences[0] < 0)
    assert_allclose(differences[1], differences[0] / 100, rtol=0.05, atol=1e-10)


def test_cell_stiffness_is_a_dimension_of_the_fmd() -> None:
    cells = articles.load_cells({"fmd.load_cell.axial_stiffness_N_m": 1e9})
    assert_allclose(cells[:, 2], 1e9)
    assert_allclose(cells[:, :2], articles.load_cells()[:, :2])


@pytest.mark.parametrize(
    ("name", "options", "said"),
    [
        ("clumod-5", {}, "no built-in article is called 'clumod-5'"),
        ("clumod-4", {"changes": {"clumod.blade.upper-short.layer.thickness_mm": 6.0}}, "no body has the dimensions"),
        ("clumod-4", {"changes": {"clumod.blade.upper-short.z_mm": 1540.0}}, "hubs must lie on the mast and apart"),
        ("clumod-4", {"elements": 0}, "at least one element is needed, found 0"),
        ("cuboid", {"cells": np.ones((4, 3))}, "there is no FMD"),
        ("fmd", {"cells": np.ones((3, 3))}, r"four cells .* found shape \(3, 3\)"),
        (
            "fmd",
            {"cells": [[1, 1, 1], [1, -2, 1], [1, 1, 1], [1, 1, 1]]},
            "cell 2 must have a positive, finite stiffness along y",
        ),
        ("cuboid", {"joints": [Joint(ports=(), stiffness=np.zeros((0, 0)))]}, "there is no Clumod"),
    ],
)
def test_structure_that_cannot_be_is_refused(name: str, options: dict, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        articles.structure(name, **options)


def test_part_of_a_material_without_moduli_is_refused() -> None:
    d = copy.deepcopy(load("clumod"))
    d["mast"]["material"] = "oak"
    with pytest.raises(BadInput, match="material oak: `youngs_modulus`: is missing"):
        assemble(articles.clumod_plan(ONE_BLADE, d))


SIZE = 0.06
"""[m] of the local solid's cells: coarse, the claims here hold at any."""


@pytest.fixture(scope="module")
def dimensions() -> Dimensions:
    return load("clumod")


def lower_1(blades: Sequence[str], d: Dimensions) -> ClumodPiece:
    return next(piece for piece in articles.pieces(blades, d) if piece.blades == ("lower-1",))


@pytest.fixture(scope="module")
def piece(dimensions: Dimensions) -> ClumodPiece:
    """The crossing of lower-1, cut out of Clumod with four blades."""
    return lower_1(FOUR_BLADES, dimensions)


@pytest.fixture(scope="module")
def flexibility(piece: ClumodPiece) -> np.ndarray:
    return articles.solid_flexibility(piece, SIZE)


@pytest.fixture(scope="module")
def joint(piece: ClumodPiece, flexibility: np.ndarray, dimensions: Dimensions) -> Joint:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(articles, "_kept_flexibility", lambda *_: flexibility)
        return articles.joint(piece, dimensions, SIZE)


def test_the_pieces_are_the_foot_and_every_hub_with_a_blade_or_mast_above(dimensions: Dimensions) -> None:
    found = list(articles.pieces(FOUR_BLADES, dimensions))
    assert [each.blades for each in found] == [(), ("lower-1",), ("lower-2",), ("upper-long", "upper-short")]
    assert [each.foot for each in found] == [True, False, False, False]
    assert [each.blades for each in articles.pieces(ONE_BLADE, dimensions)] == [(), ("lower-1",), ()]


def test_the_solid_gives_about_what_the_beams_give(piece: ClumodPiece, flexibility: np.ndarray) -> None:
    """A joint is a correction: no direction of any port gives less than half or more than twice of what the beams do."""
    ratio = np.diag(flexibility) / np.diag(articles.beam_flexibility(piece))
    assert np.all((ratio > 0.5) & (ratio < 2))


def test_beams_with_the_joint_have_the_flexibility_of_the_solid(
    piece: ClumodPiece, flexibility: np.ndarray, joint: Joint, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = articles.clumod_plan

    def jointed(blades: Sequence[str], d: Dimensions, *, elements: int) -> object:
        return plain(blades, d, elements=elements, joints=(joint,))

    monkeypatch.setattr(articles, "clumod_plan", jointed)
    scale = np.sqrt(np.outer(np.diag(flexibility), np.diag(flexibility)))
    assert_allclose((articles.beam_flexibility(piece) - flexibility) / scale, 0, atol=1e-6)


def test_the_foot_of_beams_is_a_cantilever_tube(dimensions: Dimensions) -> None:
    """Tip of a Timoshenko cantilever: L³ / 3 E I + L / k G A, L² / 2 E I, L / E I; L / E A and L / G J along and about it."""
    foot = next(articles.pieces(ONE_BLADE, dimensions))
    mast = dimensions["mast"]
    L = foot.ports[0].at - dimensions["flange"]["height"]
    s = tube(mast["outer_diameter"], mast["inner_diameter"], material(mast["material"]))
    across, tilt, turn = L**3 / (3 * s.bending_y) + L / s.shear_z, L**2 / (2 * s.bending_y), L / s.bending_y
    expected = np.diag([across, across, L / s.axial, turn, turn, L / s.torsion])
    expected[0, 4] = expected[4, 0] = tilt
    expected[1, 3] = expected[3, 1] = -tilt
    assert_allclose(articles.beam_flexibility(foot), expected, rtol=1e-8, atol=1e-8 * turn)


def test_a_joint_of_four_blades_serves_one(joint: Joint, piece: ClumodPiece, dimensions: Dimensions) -> None:
    """The same crossing is cut out of both, and Clumod with one blade takes the joint: its frequencies fall, by little."""
    own = lower_1(ONE_BLADE, dimensions)
    assert [(port.member, port.at) for port in own.ports] == [(port.member, port.at) for port in piece.ports]
    assert_array_equal(articles.beam_flexibility(own), articles.beam_flexibility(piece))
    plain, jointed = (
        frequencies(assemble(articles.clumod_plan(ONE_BLADE, dimensions, joints=joints)), 5) for joints in ((), (joint,))
    )
    change = jointed / plain - 1
    assert np.abs(change).max() < 0.05
    assert np.abs(change).max() > 1e-5


def test_ports_are_where_the_solid_ends(piece: ClumodPiece, dimensions: Dimensions) -> None:
    """A rigid motion about the base is reported by every port as its own."""
    solid = articles._solid(piece, SIZE)
    shares = np.asarray((solid.mass @ np.tile(np.eye(3), (len(solid.points), 1))).sum(axis=1))
    motion = np.zeros((len(solid.rigid), 6))
    motion[solid.translations.ravel()] = rigid_motion(solid.points).reshape(-1, 6, 6)[:, :3].reshape(-1, 6)
    for port in piece.ports:
        seen = articles._mean(solid, shares, piece, port).T @ motion
        assert_allclose(seen, rigid_transformation_6(articles.place(port, dimensions)), rtol=0, atol=1e-9)
