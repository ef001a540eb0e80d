"""Effects on any structure: reduced matrices of a frame against the whole of it, grounded, floating and on a base."""

from collections.abc import Callable, Mapping
from dataclasses import replace
from functools import cache
from itertools import pairwise
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from scipy.sparse import csr_array

from benchmarks import bench_scale
from fem import gravity
from fem.damping import Damping
from fem.factorisers import factorise
from fem.modes import fixed_base
from fem.structure import Structure, gradients, place_rows
from fem.user_model import reading
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, rigid_transformation_6
from geometry.toml_file import STANDARD_GRAVITY
from validation.effects import catalogue
from validation.effects.catalogue import FAMILIES, Named, acts, there
from validation.effects.effect import Vocabulary
from validation.effects.stages import Matrices, Shares, with_resonators
from validation.model.model import Added, StructureTolerances
from validation.prediction import dynamic_mass, effects
from validation.prediction import structure as prediction_structure
from validation.prediction.tangents import FIELDS, LOSS_COUPLING, Tangent, full

# The frame, assembled directly: four posts and rings of beams by Euler and Bernoulli, a rail with a bolted end, springs below.

E, G, RHO = 70e9, 26e9, 2700.0
WIDTH, THICKNESS = 0.04, 0.008
JOINT = np.array([4e6, 2e6, 6e6, 900.0, 1500.0, 700.0])
SUPPORT = np.array([3e5, 1e5, 4e5, 0.0, 0.0, 0.0])
ELEMENTS = 6

NODES = np.array(
    [[0, 0, 0], [0.5, 0, 0], [0.5, 0.35, 0], [0, 0.35, 0], [0, 0, 0.4], [0.5, 0, 0.4], [0.5, 0.35, 0.4], [0, 0.35, 0.4]],
    dtype=float,
)
MEMBERS = {
    "post-1": ((0, 4),),
    "post-2": ((1, 5),),
    "post-3": ((2, 6),),
    "post-4": ((3, 7),),
    "ring": ((4, 5), (6, 7), (7, 4)),
    "rail": ((5, 6),),
    "foot-rails": ((0, 1), (2, 3)),
}
"""The rail is bolted to node 5 by the joint, and welded to node 6."""


def element(length: float, thickness: float) -> tuple[Array, Array, Array]:
    """Shares of the stiffness (12, 12) that grow with the thickness and with its cube, and mass; the beam lies along x."""
    area, thin, wide = WIDTH * thickness, WIDTH * thickness**3 / 12, thickness * WIDTH**3 / 12
    one, cubed, mass = (np.zeros((12, 12)) for _ in range(3))
    bar = np.array([[1.0, -1.0], [-1.0, 1.0]])
    heavy = np.array([[2.0, 1.0], [1.0, 2.0]]) / 6
    one[np.ix_([0, 6], [0, 6])] = E * area / length * bar
    cubed[np.ix_([3, 9], [3, 9])] = G * 4 * thin / length * bar
    mass[np.ix_([0, 6], [0, 6])] = RHO * area * length * heavy
    mass[np.ix_([3, 9], [3, 9])] = RHO * wide * length * heavy
    for along, sign, second, share in (([1, 5, 7, 11], 1.0, wide, one), ([2, 4, 8, 10], -1.0, thin, cubed)):
        L = np.diag([1.0, sign * length, 1.0, sign * length])
        k = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) / length**3
        m = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
        share[np.ix_(along, along)] += E * second * L @ k @ L
        mass[np.ix_(along, along)] += RHO * area * length * L @ m @ L
    return one, cubed, mass


def frame(support: str, thickness: Mapping[str, float] | None = None, joint: Array = JOINT) -> Structure:
    """On springs to the "ground", "free", or its feet held by a "base"; `thickness` of parts as a factor."""
    points = [*NODES]
    chains: list[tuple[str, list[int]]] = []
    bolted = len(points)
    points.append(NODES[5])  # the rail's own end
    for part, lines in MEMBERS.items():
        for a, b in lines:
            start = bolted if part == "rail" else a
            inner = list(range(len(points), len(points) + ELEMENTS - 1))
            points += [NODES[a] + (NODES[b] - NODES[a]) * k / ELEMENTS for k in range(1, ELEMENTS)]
            chains.append((part, [start, *inner, b]))
    n = 6 * len(points)
    sections = {part: [np.zeros((n, n)), np.zeros((n, n))] for part in MEMBERS}
    masses = {part: np.zeros((n, n)) for part in MEMBERS}
    for part, nodes in chains:
        for a, b in pairwise(nodes):
            arm = points[b] - points[a]
            length = float(np.linalg.norm(arm))
            x = arm / length
            side = np.array([0.0, 1.0, 0.0]) if abs(x[1]) < 0.5 else np.array([0.0, 0.0, 1.0])
            R = np.vstack([x, side, np.cross(x, side)])
            T = np.kron(np.eye(4), R)
            dofs = np.concatenate([6 * a + np.arange(6), 6 * b + np.arange(6)])
            one, cubed, mass = (T.T @ m @ T for m in element(length, THICKNESS * (thickness or {}).get(part, 1.0)))
            sections[part][0][np.ix_(dofs, dofs)] += one
            sections[part][1][np.ix_(dofs, dofs)] += cubed
            masses[part][np.ix_(dofs, dofs)] += mass
    across = np.zeros((6, n))
    across[:, 6 * bolted : 6 * bolted + 6], across[:, 30:36] = np.eye(6), -np.eye(6)
    stiffness = {part: one + cubed for part, (one, cubed) in sections.items()}
    stiffness["bolt"] = across.T @ np.diag(joint) @ across
    feet = {f"foot-{k + 1}": k for k in range(4)}
    if support == "ground":
        for name, node in feet.items():
            stiffness[name] = np.zeros((n, n))
            stiffness[name][range(6 * node, 6 * node + 6), range(6 * node, 6 * node + 6)] = SUPPORT * (1 + 0.3 * node)
    rigid = np.vstack([rigid_transformation_6(point) for point in points])
    places = {"corner": 6, "tip": 4, "mid-rail": bolted + 1 + (ELEMENTS - 1) * 7 + ELEMENTS // 2 - 1}
    held = np.concatenate([6 * node + np.arange(6) for node in range(4)]) if support == "base" else np.zeros(0, dtype=np.intp)
    return Structure(
        stiffness=csr_array(sum(stiffness.values())),
        mass=csr_array(sum(masses.values())),
        rigid=rigid,
        held=held,
        points=np.array(points),
        translations=6 * np.arange(len(points))[:, None] + np.arange(3),
        part_stiffness={name: csr_array(K) for name, K in stiffness.items()},
        loss_factors=dict.fromkeys(MEMBERS, 0.004),
        part_mass={name: csr_array(M) for name, M in masses.items()},
        grounded=support == "ground",
        supports=tuple(feet) if support == "ground" else (),
        joints=("bolt",),
        places={name: csr_array(np.eye(n)[6 * node : 6 * node + 3]) for name, node in places.items()},
        sections={part: (csr_array(one), csr_array(cubed)) for part, (one, cubed) in sections.items()},
        geometric={part: csr_array(-2e-2 * stiffness[part]) for part in ("post-1", "post-2")},
    )


SUPPORTS = ("ground", "free", "base")
COUNT = 8

BAR = 1e-3
"""Largest error of a frequency that an effect has moved, as a share of how far it moved it."""

SLIGHT = 0.03
"""Share of the largest change below which that of a mode is not asked for by itself."""


def more(*sizes: float) -> list[Any]:
    """Sizes between others, which `make proof` tries as well."""
    return [pytest.param(size, marks=pytest.mark.proof) for size in sizes]


@pytest.fixture(scope="module", params=SUPPORTS)
def made(request: pytest.FixtureRequest) -> tuple[Structure, Matrices]:
    return standing(request.param)


def reduced(whole: Structure) -> Matrices:
    band = 1.01 * frequencies(*of(whole))[-1]
    return prediction_structure.by_itself(whole, band).matrices


@cache
def standing(support: str) -> tuple[Structure, Matrices]:
    """The frame as it is and its reduced matrices."""
    whole = frame(support)
    return whole, reduced(whole)


def of(structure: Structure) -> tuple[Array, Array]:
    """Stiffness and mass of its free degrees of freedom."""
    at = np.ix_(structure.free, structure.free)
    return structure.stiffness.toarray()[at], structure.mass.toarray()[at]


def frequencies(stiffness: Array, mass: Array) -> Array:
    """(COUNT,) [Hz] of the lowest elastic modes, above those of a rigid body."""
    found = np.sqrt(np.abs(eigh(stiffness, mass, eigvals_only=True, subset_by_index=(0, COUNT + 5)))) / (2 * np.pi)
    return found[found > 1.0][:COUNT]


@cache
def unmoved(whole: Structure) -> Array:
    """(COUNT,) [Hz] of the structure as it is."""
    return frequencies(*of(whole))


def error(made: tuple[Structure, Matrices], whole: tuple[Array, Array], few: Matrices) -> float:
    """How wrong the change of the frequencies is that makes `few` of the reduced matrices, `whole` the full ones."""
    before, after = unmoved(made[0]), frequencies(*whole)
    change = (after - before) / before
    found = (frequencies(few.stiffness, few.mass) - frequencies(made[1].stiffness, made[1].mass)) / before
    assert np.abs(change).max() > 1e-4
    return float((np.abs(found - change) / np.maximum(np.abs(change), SLIGHT * np.abs(change).max())).max())


def with_shares(made: tuple[Structure, Matrices], K: object = None, M: object = None) -> tuple[Array, Array]:
    at = np.ix_(made[0].free, made[0].free)
    stiffness, mass = of(made[0])
    return stiffness + (0 if K is None else K.toarray()[at]), mass + (0 if M is None else M.toarray()[at])


def moved(made: tuple[Structure, Matrices], offsets: Mapping[str, float]) -> Matrices:
    known = effects.nuisances("frame", made[1], np.array([10.0]), {})
    return known.at(offsets)[0]


def acted(m: Matrices, text: str) -> Matrices:
    named = catalogue.parse(text, Vocabulary(places=None, parts=None))
    return FAMILIES[named.family].change(m, named.targets, named.values)


def test_the_reduced_frame_has_the_frequencies_of_the_whole(made: tuple[Structure, Matrices]) -> None:
    np.testing.assert_allclose(frequencies(made[1].stiffness, made[1].mass), frequencies(*of(made[0])), rtol=1e-8)
    assert len(made[1].mass) < 0.5 * made[0].mass.shape[0]


@pytest.mark.parametrize("change", [-0.5, 1.0, *more(0.25)])
@pytest.mark.parametrize("part", MEMBERS)
def test_a_modulus_moves_the_frequencies_as_in_the_whole(made: tuple[Structure, Matrices], part: str, change: float) -> None:
    few = moved(made, {f"modulus:{part}": np.log1p(change)})
    assert error(made, with_shares(made, change * made[0].part_stiffness[part]), few) < BAR


@pytest.mark.parametrize("change", [-0.3, 1.0, *more(0.3)])
@pytest.mark.parametrize("part", MEMBERS)
def test_a_density_moves_the_frequencies_as_in_the_whole(made: tuple[Structure, Matrices], part: str, change: float) -> None:
    few = moved(made, {f"mass:{part}": change})
    assert error(made, with_shares(made, None, change * made[0].part_mass[part]), few) < BAR


@pytest.mark.parametrize("support", SUPPORTS)
def test_a_body_that_does_not_give_may_be_heavier_by_its_name_and_a_point_mass_has_that_of_its_place(support: str) -> None:
    """Masses of a deck had no name that could be wrong: 80 g more of 800 at a satellite's mast, on a base, were "unknown"."""
    frame_alone = frame(support)
    n = frame_alone.mass.shape[0]
    box, lamp = np.zeros((n, n)), np.zeros((n, n))
    at = 6 * 5 + np.arange(6)  # a node of the frame without a name
    box[at, at] = [0.8, 0.8, 0.8, 0.002, 0.003, 0.001]
    row = frame_alone.places["tip"]
    lamp += 0.3 * (row.T @ row).toarray()
    shares = {**frame_alone.part_mass, "box": csr_array(box), "lamp": csr_array(lamp)}
    whole = replace(frame_alone, mass=csr_array(frame_alone.mass + box + lamp), part_mass=shares)
    made = whole, reduced(whole)
    assert catalogue.there("frame", made[1]).bodies == ("box",)
    known = {one.name for one in effects.nuisances("frame", made[1], np.array([10.0]), {}).parameters}
    assert "mass:box" in known
    as_fault = effects.opened(
        effects.nuisances("frame", made[1], np.array([10.0]), {}).parameters,
        [Added(named=catalogue.parse(f"mass:{part}=0.1", Vocabulary(parts=None))) for part in ("box", "rail")],
    )[0]
    plausible = {one.name: one.tolerance for one in as_fault}
    assert (plausible["mass:box"], plausible["mass:rail"]) == (1.0, 0.15)  # twice as heavy came out as 0.68
    assert "mass:lamp" not in known
    assert catalogue.acts(catalogue.parse("mass:box=0.1", Vocabulary(parts=None)), catalogue.there("frame", made[1]))
    assert not catalogue.acts(catalogue.parse("modulus:box=0.1", Vocabulary(parts=None)), catalogue.there("frame", made[1]))
    assert error(made, with_shares(made, None, 0.5 * shares["box"]), moved(made, {"mass:box": 0.5})) < BAR


@pytest.mark.parametrize("change", [-0.2, 0.5, *more(0.1)])
@pytest.mark.parametrize("part", MEMBERS)
def test_a_thickness_is_the_frame_assembled_with_it(made: tuple[Structure, Matrices], part: str, change: float) -> None:
    few = moved(made, {f"thickness:{part}": np.log1p(change)})
    support = "ground" if made[0].grounded else "base" if made[0].held.size else "free"
    assert error(made, of(frame(support, thickness={part: 1 + change})), few) < BAR


@pytest.mark.parametrize("factor", [0.1, 30.0, *more(0.28, 3.0)])
@pytest.mark.parametrize("support", ["foot-1", "foot-4"])
def test_a_support_moves_the_frequencies_as_in_the_whole(support: str, factor: float) -> None:
    both = standing("ground")
    few = moved(both, {f"support-stiffness:{support}": np.log(factor)})
    assert error(both, with_shares(both, (factor - 1) * both[0].part_stiffness[support]), few) < BAR


@pytest.mark.parametrize("direction", MOTIONS)
def test_a_joint_that_gives_is_the_frame_assembled_with_softer_springs(made: tuple[Structure, Matrices], direction: str) -> None:
    softer = np.array(JOINT)
    k = MOTIONS.index(direction)
    size = 4 / JOINT[k]
    softer[k] = 1 / (1 / JOINT[k] + size)
    few = acted(made[1], f"connection-compliance:bolt:{direction}={size}")
    support = "ground" if made[0].grounded else "base" if made[0].held.size else "free"
    whole = of(frame(support, joint=softer))
    change = np.abs(frequencies(*whole) / unmoved(made[0]) - 1).max()
    if change > 1e-4:
        assert error(made, whole, few) < BAR
    np.testing.assert_allclose(made[1].joints["bolt"].stiffness, JOINT, rtol=1e-6)


def test_a_joint_that_a_modulus_has_softened_gives_on_top_of_it(made: tuple[Structure, Matrices]) -> None:
    """Of half its springs, with as much compliance again."""
    half = moved(made, {"modulus:bolt": np.log(0.5)})
    few = acted(half, f"connection-compliance:bolt:beta={2 / JOINT[4]}")
    springs = 0.5 * JOINT
    springs[4] /= 2
    support = "ground" if made[0].grounded else "base" if made[0].held.size else "free"
    assert error(made, of(frame(support, joint=springs)), few) < BAR


@pytest.mark.parametrize("size", [0.02, 1.0, *more(0.2)])
@pytest.mark.parametrize("place", ["corner", "tip", "mid-rail"])
def test_a_mass_at_a_place_moves_the_frequencies_as_in_the_whole(
    made: tuple[Structure, Matrices], place: str, size: float
) -> None:
    row = made[0].places[place]
    few = acted(made[1], f"point-mass:{place}={size}")
    assert error(made, with_shares(made, None, size * row.T @ row), few) < BAR


@pytest.mark.parametrize("axis", "xyz")
@pytest.mark.parametrize("size", [1e4, 5e4])
def test_a_cable_along_an_axis_moves_the_frequencies_as_in_the_whole(
    made: tuple[Structure, Matrices], axis: str, size: float
) -> None:
    row = made[0].places["mid-rail"][["xyz".index(axis)]]
    few = acted(made[1], f"cable:mid-rail:{axis}={size}")
    assert error(made, with_shares(made, size * row.T @ row), few) < BAR


def test_an_absorber_moves_the_frequencies_as_in_the_whole(made: tuple[Structure, Matrices]) -> None:
    m, f = 0.1, 60.0
    k = m * (2 * np.pi * f) ** 2
    few = acted(made[1], f"absorber:tip=m:{m},f:{f},zeta:0.01")
    rows = made[0].places["tip"].toarray()[:, made[0].free]
    K, M = of(made[0])
    pull = np.hstack([rows, -np.eye(3)])
    whole = np.pad(K, (0, 3)) + k * pull.T @ pull, np.pad(M, (0, 3)) + m * np.diag([0.0] * len(M) + [1.0] * 3)
    np.testing.assert_allclose(frequencies(few.stiffness, few.mass), frequencies(*whole), rtol=1e-6)


def test_weight_in_the_stiffness_moves_the_frequencies_as_in_the_whole(made: tuple[Structure, Matrices]) -> None:
    few = acted(made[1], "gravity-stiffness=5")
    assert error(made, with_shares(made, 5 * sum(made[0].geometric.values())), few) < BAR


@pytest.mark.parametrize("part", ["rail", "ring"])
def test_a_loss_factor_is_an_imaginary_stiffness_of_the_part(made: tuple[Structure, Matrices], part: str) -> None:
    after = acted(made[1], f"structural-damping:{part}=0.02")
    np.testing.assert_array_equal(after.structural, made[1].structural + 0.02 * made[1].parts[part])


def test_a_place_twice_adds_nothing_where_tests_end_far_below_the_first_mode(portal: Callable[..., Path], tmp_path: Path) -> None:
    """No mode told what a place moves: its answer was scaled by 1e307, and rounding of the second took for one of its own; of a
    panel on a shaker nothing was answered but "not positive definite"."""
    structure = reading.load(portal(tmp_path, 8)).model
    assert isinstance(structure, Structure)
    once = prediction_structure.by_itself(structure, 5.0)
    twice = prediction_structure.by_itself(prediction_structure.with_positions(structure, ["@0,0,0.24", "@0.3,0,0.24"]), 5.0)
    assert once.frequency[0] > 80
    np.testing.assert_allclose(np.diag(twice.matrices.stiffness), np.diag(once.matrices.stiffness), rtol=1e-6)
    np.testing.assert_allclose(twice.matrices.places["@0,0,0.24"], twice.matrices.places["a"], rtol=1e-6, atol=1e-9)


def test_coordinates_of_a_place_that_has_a_name_are_that_place() -> None:
    """Of coordinates of a Craig-Bampton model, whose nodes are those of its interface, a pick-up rode on the nearest of these."""
    whole, shift = frame("base"), np.array([0.0, 0.0, 0.4])
    bent = csr_array(whole.places["tip"] * 1.7 - (0.7 * whole.places["tip"] @ whole.rigid) @ np.linalg.pinv(whole.rigid))
    reduced = replace(whole, elements=None, places={"tip": bent}, points=whole.points[:1], translations=whole.translations[:1])
    made = prediction_structure.with_positions(replace(reduced, rotations=whole.rotations[:1]), ["@0,0,0.4", "@0,0,0.3"])
    np.testing.assert_allclose(prediction_structure.position_of(made, "tip"), shift, atol=1e-9)
    np.testing.assert_array_equal(made.places["@0,0,0.4"].toarray(), bent.toarray())
    assert abs(made.places["@0,0,0.3"] - bent).max() > 0.1


def test_of_a_place_far_from_all_nodes_that_are_known_it_is_not_told_what_lies_beside_it() -> None:
    """A model with its interface's nodes alone was refused by any place of rows that lies 0.33 m from these."""
    whole = frame("base")
    three = np.argsort(np.linalg.norm(whole.points, axis=1))[:3]  # a post's foot and those next to it
    few = replace(whole, points=whole.points[three], translations=whole.translations[three])
    assert [*gradients(whole, ["tip"], np.eye(whole.mass.shape[0], 4))] == ["tip"]
    assert gradients(few, ["tip"], np.eye(whole.mass.shape[0], 4)) == {}


def test_a_point_beside_nodes_that_lie_close_is_refused_from_a_tenth_of_the_size_of_the_structure() -> None:
    """From a hundredth it was, where twice the gap between nodes is less."""
    whole = frame("base")
    line = np.linspace([0.0, 0.0, 0.0], [1.0, 0.0, 0.0], len(whole.points))
    dense = replace(whole, points=line)
    place_rows(dense, [0.5, 0.0, 0.09])
    with pytest.raises(BadInput, match=r"lies 0\.11 m outside"):
        place_rows(dense, [0.5, 0.0, 0.11])


def test_a_frame_on_a_base_that_moves_has_the_shares_of_its_parts() -> None:
    whole = frame("base")
    made = prediction_structure.on_base(whole, fixed_base(whole, 16), 250.0, np.zeros(3)).matrices
    held = prediction_structure.by_itself(whole, 250.0).matrices
    for name in ("mass", "stiffness"):
        shares = sum((made.part_mass if name == "mass" else made.parts).values())
        np.testing.assert_allclose(shares, getattr(made, name), atol=1e-9 * np.abs(getattr(made, name)).max())
    np.testing.assert_allclose(made.mass[:6, :6], whole.rigid_mass, atol=1e-9)
    np.testing.assert_allclose(made.places["tip"][:, :6] @ [0, 0, 0, 0, 1.0, 0], [0.4, 0, 0], atol=1e-12)  # at (0, 0, 0.4) m
    assert made.joints["bolt"].loads[:, :6].any() == False  # noqa: E712 no rigid motion strains it
    assert set(made.joints) == set(held.joints)


def test_a_frame_that_floats_has_its_inertia_in_its_rigid_coordinates() -> None:
    whole = frame("free")
    m = reduced(whole)
    at = np.flatnonzero(np.any(m.rigid != 0, axis=0))
    assert len(at) == 6
    back = np.linalg.inv(m.rigid[:, at])
    np.testing.assert_allclose(back.T @ m.mass[np.ix_(at, at)] @ back, whole.rigid_mass, atol=1e-8)
    assert np.abs(m.stiffness[at]).max() < 1e-6 * np.abs(m.stiffness).max()
    heavier = acted(m, "rigid-inertia:m=0.5")
    found = back.T @ heavier.mass[np.ix_(at, at)] @ back
    np.testing.assert_allclose(found[0, 0], whole.rigid_mass[0, 0] + 0.5, rtol=1e-9)


def test_what_can_only_drift_is_refused() -> None:
    from geometry.errors import CheckFailed

    whole = frame("free")
    loose = {**whole.part_stiffness, "bolt": 0 * whole.part_stiffness["bolt"], "rail": 0 * whole.part_stiffness["rail"]}
    with pytest.raises(CheckFailed, match=r"swings freely|floats"):
        prediction_structure.by_itself(replace(whole, stiffness=csr_array(sum(loose.values())), part_stiffness=loose), 100.0)


# What is declared of parts, and its derivatives


def test_every_part_has_the_tolerances_that_it_states_and_supports_have_no_modulus() -> None:
    whole = replace(frame("ground"), part_tolerances={"rail": {"modulus": 0.07, "thickness": 0.02}, "foot-2": {"modulus": 0.4}})
    m = reduced(whole)
    known = effects.nuisances("frame", m, np.array([20.0]), whole.loss_factors, part_tolerances=whole.part_tolerances)
    found = {one.name: one.tolerance for one in known.parameters}
    assert (found["modulus:rail"], found["thickness:rail"], found["support-stiffness:foot-2"]) == (0.07, 0.02, 0.4)
    assert (found["modulus:ring"], found["mass:ring"], found["support-stiffness:foot-1"]) == (0.025, 0.01, 0.1)
    assert not {"modulus:foot-1", "mass:foot-1", "thickness:bolt"} & set(found)
    by_name = {one.name: one for one in known.parameters}
    assert by_name["support-stiffness:foot-1"].value(np.log(0.28)) == pytest.approx(0.28)
    assert by_name["modulus:rail"].value(np.log(0.9)) == pytest.approx(-0.1)


@pytest.mark.parametrize("name", ["support-stiffness:foot-1", "thickness:rail", "mass:rail", "modulus:rail", "loss:rail"])
def test_derivatives_of_what_is_declared_are_differences(name: str) -> None:
    whole, few = standing("ground")
    known = effects.nuisances("frame", few, np.array([20.0, 30.0]), whole.loss_factors)
    at = {"support-stiffness:foot-1": 0.3, "thickness:rail": 0.1, "mass:rail": -0.2, "modulus:rail": 0.2, "loss:rail": 0.1}
    _, tangents = known.at(at)
    step = 1e-4
    above, below = (known.at({**at, name: at[name] + side * step})[0] for side in (1, -1))
    for field in FIELDS:
        difference = (getattr(above, field) - getattr(below, field)) / (2 * step)
        found = full(tangents[name], field, len(above.mass))
        scale = max(np.abs(difference).max(), 1e-6 * np.abs(getattr(above, field)).max())
        np.testing.assert_allclose(found, difference, rtol=0, atol=1e-6 * scale)


@pytest.mark.parametrize("name", ["loss:bolt", "modulus:bolt", "damping:frame:1"])
def test_a_joint_that_gives_loses_less_whatever_its_losses_and_modulus_are(name: str) -> None:
    """It had lost as before: a joint 67 times softer, and its partner of a pair found, had a law of losses pay for it."""
    whole, few = standing("ground")
    known = effects.nuisances("frame", few, np.array([20.0, 30.0]), {**whole.loss_factors, "bolt": 0.05})
    named = catalogue.parse(f"connection-compliance:bolt:beta={2 / JOINT[4]}", Vocabulary(places=None, parts=None))
    at = {"loss:bolt": 0.2, "modulus:bolt": -0.3, "damping:frame:1": 0.1}

    def given(offsets: Mapping[str, float]) -> tuple[Matrices, Mapping[str, Tangent]]:
        return effects.structure(*known.at(offsets), [Added(named=named)], derivatives=True)

    few, after = known.at(at)[0], given(at)[0]
    gone, lost = few.stiffness - after.stiffness, few.structural - after.structural
    D = np.append(np.exp(0.1 / 2), np.ones(len(gone) - 1))
    np.testing.assert_allclose(lost, 0.05 * 1.2 * D[:, None] * gone * D, rtol=0, atol=1e-9 * np.abs(gone).max())
    assert np.abs(lost).max() > 0.01 * np.abs(gone).max()
    step = 1e-4
    above, below = (given({**at, name: at[name] + side * step})[0] for side in (1, -1))
    for field in FIELDS:
        difference = (getattr(above, field) - getattr(below, field)) / (2 * step)
        found = full(given(at)[1][name], field, len(gone))
        scale = max(np.abs(difference).max(), 1e-6 * np.abs(getattr(above, field)).max())
        np.testing.assert_allclose(found, difference, rtol=0, atol=1e-5 * scale)


def test_an_effect_that_opens_a_tolerance_is_that_parameter() -> None:
    known = effects.nuisances("frame", standing("ground")[1], np.array([20.0]), {})
    named = [Named(family=family, targets=(target,), values={"": value}) for family, target, value in OPENING]
    left, _ = effects.opened(known.parameters, [Added(named=one) for one in named])
    opened = {one.name: one for one in left if one.kind == "effect"}
    for one in named:
        assert opened[one.id].value(opened[one.id].start) == pytest.approx(one.value)


OPENING = (("support-stiffness", "foot-1", 0.28), ("mass", "rail", 0.1), ("thickness", "ring", -0.1), ("modulus", "bolt", -0.5))


# What an effect may act on follows from the structure


def test_targets_are_those_of_the_structure() -> None:
    stands = [there("frame", standing(support)[1]) for support in SUPPORTS]
    words = catalogue.words_of(stands, Vocabulary(places=None, parts=None))
    assert words.legal("support") == ("foot-1", "foot-2", "foot-3", "foot-4")
    assert words.legal("joint between parts") == ("bolt",)
    assert set(words.legal("part") or ()) == {*MEMBERS, "bolt", *words.legal("support")}
    assert words.legal("place") == ("corner", "tip", "mid-rail")
    with_no_support = catalogue.words_of(stands[1:], Vocabulary(places=None, parts=None))
    assert with_no_support.legal("support") == ()


@pytest.mark.parametrize(
    ("text", "on"),
    [
        ("support-stiffness:foot-1=0.5", {"ground"}),
        ("connection-compliance:bolt:z=1e-7", set(SUPPORTS)),
        ("rigid-inertia:m=1", {"free"}),
        ("gravity-stiffness=1", set(SUPPORTS)),
        ("point-mass:tip=1", set(SUPPORTS)),
        ("point-mass:nowhere=1", set()),
        ("mounting-offset:x=0.001", set()),
        ("thickness:ring=0.1", set(SUPPORTS)),
    ],
)
def test_effects_act_where_their_target_is(text: str, on: set[str]) -> None:
    named = catalogue.parse(text, Vocabulary(places=None, parts=None))
    assert {support for support in SUPPORTS if acts(named, there("frame", standing(support)[1]))} == on


# Weight in the stiffness of storeys


def storeys(masses: Array, springs: Array) -> Structure:
    """Floors that shift along x, one above the other."""
    n = len(masses)
    parts = {}
    for k, spring in enumerate(springs):
        pull = np.eye(n)[k] - (np.eye(n)[k - 1] if k else 0)
        parts[f"storey-{k + 1}"] = csr_array(spring * np.outer(pull, pull))
    return Structure(
        stiffness=csr_array(sum(parts.values())),
        mass=csr_array(np.diag(masses)),
        rigid=np.eye(n, 6, k=n) + np.outer(np.ones(n), np.eye(6)[0]),
        held=np.zeros(0, dtype=np.intp),
        part_stiffness=parts,
        grounded=True,
        places={f"floor-{k + 1}": csr_array(np.vstack([np.eye(n)[k], np.zeros((2, n))])) for k in range(n)},
    )


def test_the_weight_above_a_wall_takes_its_share_of_the_stiffness() -> None:
    """Three floors of 1.83 kg on walls of 4200 N/m and 200 mm: 7.7, 5.1 and 2.6 %, as the drawing of the rig has them."""
    tower = storeys(np.full(3, 1.83), np.full(3, 4200.0))
    names = ["ground", "floor-1", "floor-2", "floor-3"]
    walls = {f"storey-{k + 1}": gravity.Storey(below=names[k], above=names[k + 1], height=0.2) for k in range(3)}
    found = gravity.geometric(tower, walls)
    shares = [-found[part].max() / tower.part_stiffness[part].max() if part == "storey-1" else None for part in walls]
    assert shares[0] is not None
    taken = [float(-found[part].diagonal().min() / tower.part_stiffness[part].diagonal().max()) for part in walls]
    np.testing.assert_allclose(taken, [0.0769, 0.0513, 0.0256], atol=5e-4)


def test_a_pendulum_swings_as_long_as_it_is_whatever_it_weighs() -> None:
    """Hung from a spring of nothing: a height below zero on a hinge gives g / l."""
    one = storeys(np.array([3.0]), np.array([1e-9]))
    rod = {"storey-1": gravity.Storey(below="ground", above="floor-1", height=-0.7, hinged=True)}
    K = gravity.geometric(one, rod)["storey-1"].toarray()
    np.testing.assert_allclose(np.sqrt(K[0, 0] / 3.0), np.sqrt(STANDARD_GRAVITY / 0.7), rtol=1e-12)


def test_a_storey_between_others_leaves_rigid_motion_free() -> None:
    tower = storeys(np.full(3, 2.0), np.full(3, 4e3))
    K = gravity.geometric(tower, {"storey-2": gravity.Storey(below="floor-1", above="floor-2", height=0.2, weight=10.0)})
    np.testing.assert_allclose(K["storey-2"] @ np.ones(3), 0, atol=1e-12)


@pytest.mark.parametrize(
    ("part", "storey", "says"),
    [
        ("storey-9", gravity.Storey(below="ground", above="floor-1", height=0.2), "no part of this name"),
        ("storey-1", gravity.Storey(below="cellar", above="floor-1", height=0.2), "no place is called 'cellar'"),
        ("storey-1", gravity.Storey(below="ground", above="floor-1", height=0.0), "a height that is not 0"),
    ],
)
def test_a_storey_that_is_none_is_refused(part: str, storey: gravity.Storey, says: str) -> None:
    from geometry.errors import BadInput

    with pytest.raises(BadInput, match=says):
        gravity.geometric(storeys(np.full(3, 2.0), np.full(3, 4e3)), {part: storey})


def test_a_weight_that_two_columns_share_must_be_stated() -> None:
    from geometry.errors import BadInput

    tower = storeys(np.full(2, 2.0), np.full(2, 4e3))
    brace = csr_array(np.diag([0.0, 1e3]))
    both = replace(tower, stiffness=tower.stiffness + brace, part_stiffness={**tower.part_stiffness, "brace": brace})
    storey = gravity.Storey(below="floor-1", above="floor-2", height=0.2)
    with pytest.raises(BadInput, match="carried by other parts"):
        gravity.geometric(both, {"storey-2": storey})


@pytest.mark.proof  # counts what a long structure asks for
def test_a_part_more_costs_what_one_costs(monkeypatch: pytest.MonkeyPatch) -> None:
    """Of a plate cut into more parts no eigenproblem of the reduction is larger, and as many answers are asked a part."""
    monkeypatch.setattr(bench_scale, "AROUND", 32)

    def spent(count: int) -> tuple[int, float]:
        """Largest of the eigenproblems that parts are changed in, and columns solved for each part."""
        sizes, columns = [0], [0]

        def noted(a: Array, b: Array) -> Any:
            sizes.append(len(a))
            return eigh(a, b)

        class Noting:
            def __init__(self, matrix: Any, *, definite: bool) -> None:
                self.factor = factorise(matrix, definite=definite)

            def solve(self, loads: Array) -> Any:
                columns.append(loads.shape[1])
                return self.factor.solve(loads)

        monkeypatch.setattr(prediction_structure, "eigh", noted)
        monkeypatch.setattr(prediction_structure, "factorise", Noting)
        prediction_structure.by_itself(bench_scale.structure(bench_scale.strips(count)), bench_scale.BAND)
        return max(sizes), sum(columns) / count

    few, many = spent(4), spent(16)
    assert 0 < many[0] <= 1.1 * few[0]
    assert many[1] <= 1.1 * few[1]


def test_shares_that_would_fill_the_memory_are_made_when_they_are_asked_for(monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setattr(bench_scale, "AROUND", 32)
    whole = bench_scale.structure(bench_scale.strips(8))
    held = prediction_structure.by_itself(whole, bench_scale.BAND).matrices
    monkeypatch.setattr(prediction_structure, "WHOLE", 0.0)
    asked = prediction_structure.by_itself(whole, bench_scale.BAND).matrices
    grown = [with_resonators(of, "corner", (2,), {"m": 0.1, "f": 50.0, "zeta": 0.01}) for of in (held, asked)]
    for name in ("parts", "part_mass", "sections", "unresolved"):
        for both in ((held, asked), grown):
            kept, made = (getattr(one, name) for one in both)
            assert isinstance(made, Shares)
            assert list(made) == list(kept)
            for part in kept:
                np.testing.assert_allclose(made[part], kept[part], rtol=1e-9, atol=1e-9 * np.abs(kept[part]).max())
    with pytest.raises(KeyError):
        asked.parts["nothing"]


def test_what_stands_on_the_ground_is_answered_with_the_factors_that_gave_its_modes(monkeypatch: pytest.MonkeyPatch) -> None:
    def never(matrix: Any, *, definite: bool) -> Any:
        raise AssertionError("factorised once more")

    monkeypatch.setattr(prediction_structure, "factorise", never)
    whole = frame("ground")
    assert reduced(whole).mass.shape == standing("ground")[1].mass.shape


@pytest.mark.parametrize("told", ["by mode", "by a matrix"])
def test_modes_of_what_floats_turn_with_its_rigid_motions_and_lose_so(told):
    """Held still in them, the modes were others, and what was taken away raised what was left; a matrix ended in NaN."""
    whole = frame("free")
    damping = Damping(ratio=0.01) if told == "by mode" else Damping(viscous=2.0 * whole.mass)
    floats = prediction_structure.by_itself(whole, 60.0, damping=damping)
    known = StructureTolerances(loss_coupling=0.5)
    of = effects.nuisances("frame", floats.matrices, floats.frequency, {}, known, reduced=floats)
    loaded = (Added(named=Named(family="point-mass", targets=("tip",), values={"": 200.0}), fixed=False),)
    tip, at = of.nominal.places["tip"], {LOSS_COUPLING: 0.6, "modulus:rail": 0.1, "frequency:frame:1": 0.01}

    def answer(offsets: dict[str, float]) -> tuple[Matrices, dynamic_mass.CondensedTransfer, dict[str, Tangent]]:
        found, tangents = dynamic_mass.structure(of, offsets, loaded, derivatives=True)
        return found, dynamic_mass.accelerance(found, np.array([5.0, 11.5, 28.0]), tip, tip), tangents

    (before, *_), (after, *_) = (answer({LOSS_COUPLING: share}) for share in (0.0, 1.0))
    squares, shapes = eigh(before.stiffness, before.mass)
    own = slice(6, np.searchsorted(squares, (2 * np.pi * 60.0) ** 2))
    f, C, left = np.sqrt(squares[own]), *((shapes.T @ one.viscous @ shapes)[own, own] for one in (before, after))
    beyond = np.abs(f - f[:, None]) > 0.3 * np.maximum(f, f[:, None])
    assert np.abs(left[beyond]).max() < 0.2 * np.abs(C[beyond]).max()
    assert_allclose(np.diag(left), np.diag(C), rtol=0.02)
    _, here, tangents = answer(at)
    slopes, step = dynamic_mass.transfer_tangents(here, tangents), 1e-5
    for key in at:
        above, below = (answer({**at, key: at[key] + side * step})[1].matrix for side in (1, -1))
        assert_allclose(slopes[key], (above - below) / (2 * step), atol=1e-4 * np.abs(slopes[key]).max(), err_msg=key)
