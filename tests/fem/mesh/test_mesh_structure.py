"""What a description adds to a mesh (parts, sections, places, supports, joints, links, masses), each by its closed form."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse.linalg import spsolve

from benchmarks.read_meshes import STEEL, abaqus, bricks, plate
from fem.mesh import description, model
from fem.modes import fixed_base, floating_shift, lowest
from fem.structure import Structure, gradients, hold, place_rows, rows_beside
from fem.user_model.examine import lossless
from geometry.errors import BadInput
from geometry.frames import skew
from validation.effects.catalogue import FAMILIES, Named
from validation.model.model import Added
from validation.prediction import structure as reduced
from validation.prediction.effects import structure
from validation.prediction.modal_table import real_modes
from validation.prediction.structure import by_itself
from validation.prediction.tangents import full

Meshed = Callable[..., Structure]

E, NU, RHO = 210e9, 0.3, 7850.0
G = E / 2 / (1 + NU)
BEAM = 'section = { area = "4e-4 m^2", Iy = "2e-8 m^4", Iz = "1e-8 m^4", J = "2e-8 m^4" }'
AREA, IY, IZ = 4e-4, 2e-8, 1e-8


def chain(n: int = 4, length: float = 1.0) -> str:
    """Beams along x in two halves, `left` and `right`."""
    points = np.column_stack([np.linspace(0, length, n + 1), np.zeros((n + 1, 2))])
    elements = [[k, k + 1] for k in range(1, n + 1)]
    half = n // 2
    return abaqus(points, {"left": ("B31", elements[:half]), "right": ("B31", elements[half:])}, {"root": [1], "tip": [n + 1]})


HALVES = f"[fe_model.parts.left]\n{STEEL}\n{BEAM}\n[fe_model.parts.right]\n{STEEL}\n{BEAM}\n"


PAD = """
[fe_model.springs.pad]
at = "tip"
stiffness = ["1e6 N/m", "1e6 N/m", "1e6 N/m", "1e2 N m/rad", "1e2 N m/rad", "1e2 N m/rad"]
loss_factor = 0.1
"""


def flexibility(structure: Structure, place: str) -> np.ndarray:
    """What unit forces along x, y, z at a place move there, base or ground held."""
    held = hold(structure)
    rows = structure.places[place].toarray()[:, held.free]
    return np.asarray(rows @ spsolve(held.stiffness.tocsc(), rows.T))


def test_parts_add_up_to_the_whole_with_masses_springs_and_joints(meshed: Meshed) -> None:
    more = f"""{PAD}
        [fe_model.joints.bolt]
        between = ["left", "right"]
        at = ["0.5 m", "0 m", "0 m"]
        loss_factor = 0.03
        stiffness = ["1e7 N/m", "1e7 N/m", "1e7 N/m", "1e4 N m/rad", "1e4 N m/rad", "1e4 N m/rad"]
        [fe_model.masses.sensor]
        at = "tip"
        mass = "20 g"
    """
    structure = meshed(chain(), HALVES, support='support = "ground"\ninterface = ["root"]', more=more)
    assert structure.grounded
    assert (structure.supports, structure.joints, len(structure.held)) == (("pad",), ("bolt",), 0)
    assert structure.loss_factors == {"pad": 0.1, "bolt": 0.03}
    silent, held = more.replace("loss_factor = 0.1", "").replace("loss_factor = 0.03", ""), 'interface = ["root"]'
    whole = meshed(chain(), HALVES, support=f'support = "ground"\nloss_factor = 0.02\n{held}', more=silent)
    assert whole.loss_factors == dict.fromkeys(("left", "right", "pad", "bolt"), 0.02)  # springs had lost nothing
    assert set(structure.part_stiffness) == {"left", "right", "pad", "bolt"}
    assert set(structure.part_mass) == {"left", "right", "sensor"}
    for whole, shares in ((structure.stiffness, structure.part_stiffness), (structure.mass, structure.part_mass)):
        assert_allclose(sum(share.toarray() for share in shares.values()), whole.toarray(), rtol=1e-12)
        for share in shares.values():
            assert_allclose(share.toarray(), share.toarray().T, rtol=0, atol=0)
    tip = structure.places["tip"]
    assert_allclose((tip @ structure.part_mass["sensor"] @ tip.T).toarray(), 0.02 * np.eye(3), rtol=1e-12, atol=1e-15)


def test_a_joint_adds_its_compliance_in_all_six_directions(meshed: Meshed) -> None:
    k = np.array([2e7, 3e6, 4e6, 5e3, 6e3, 7e3])
    units = (*3 * ("N/m",), *3 * ("N m/rad",))
    text = ", ".join(f'"{value} {unit}"' for value, unit in zip(k, units, strict=True))
    joint = f'[fe_model.joints.bolt]\nbetween = ["left", "right"]\nat = ["0.5 m", "0 m", "0 m"]\nstiffness = [{text}]'
    rigid, jointed = (meshed(chain(), HALVES, support='interface = ["root"]', more=more) for more in ("", joint))
    arm = 0.5
    added = [1 / k[0], 1 / k[1] + arm**2 / k[5], 1 / k[2] + arm**2 / k[4]]
    assert_allclose(np.diag(flexibility(jointed, "tip") - flexibility(rigid, "tip")), added, rtol=1e-7)
    assert jointed.mass.shape[0] == rigid.mass.shape[0] + 6
    assert_allclose(jointed.rigid_mass, rigid.rigid_mass, rtol=1e-12, atol=1e-12)


def test_slopes_of_a_point_are_those_of_the_element_that_holds_it(meshed: Meshed) -> None:
    """Differences across a surface were half the slope, and across a joint what it opens over a tenth of a millimetre."""
    points, elements = bricks((4, 1, 1), (0.4, 0.1, 0.1), "C3D20")
    mesh = abaqus(points, {"left": ("C3D20", elements[:2]), "right": ("C3D20", elements[2:])})
    parts = f"[fe_model.parts.left]\n{STEEL}\n[fe_model.parts.right]\n{STEEL}\n"
    soft = ", ".join([*3 * ['"1e5 N/m"'], *3 * ['"1e3 N m/rad"']])
    joint = f'[fe_model.joints.seam]\nbetween = ["left", "right"]\nat = ["0.2 m", "50 mm", "50 mm"]\nstiffness = [{soft}]\n'
    structure = meshed(mesh, parts, more=joint)
    assert structure.elements is not None
    for at in ([0.4, 0.1, 0.1], [0.13, 0.05, 0.1], [0.2, 0.0, 0.04]):
        placed = replace(structure, places={"here": place_rows(structure, np.array(at))[0]})
        beside = gradients(placed, ["here"], np.eye(len(structure.rigid)))["here"]
        slopes = np.array([beside.shifted(axis, 0.0)[1] for axis in range(3)])
        turning = [np.cross(np.eye(3)[axis], np.eye(3)) for axis in range(3)]  # (along, moved) about each axis
        for axis, wanted in enumerate(turning):
            assert_allclose(slopes @ structure.rigid[:, 3 + axis], wanted, atol=1e-8)
        used = np.flatnonzero(np.abs(slopes).max(axis=(0, 1)))
        own = {part for part in ("left", "right") if np.all(structure.part_mass[part].diagonal()[used] > 0)}
        assert len(own) == 1
        for up in (0.001, 0.02):  # off the mesh, but for the last
            point = np.array([*at[:2], at[2] + up])
            assert_allclose(rows_beside(structure, point) @ structure.rigid, np.hstack([np.eye(3), -skew(point)]), atol=1e-8)


def test_a_joint_between_solids_parts_the_common_face_and_carries_what_goes_through_it(meshed: Meshed) -> None:
    points, elements = bricks((4, 1, 1), (0.4, 0.1, 0.1), "C3D20")
    mesh = abaqus(points, {"left": ("C3D20", elements[:2]), "right": ("C3D20", elements[2:])})
    parts = f"[fe_model.parts.left]\n{STEEL}\n[fe_model.parts.right]\n{STEEL}\n"
    root = '[fe_model.groups.root]\nbox = [["0 m", "0 m", "0 m"], ["0 m", "1 m", "1 m"]]\n'
    places = '[fe_model.places]\ntip = ["0.4 m", "50 mm", "50 mm"]\n'
    joint = '[fe_model.joints.seam]\nbetween = ["left", "right"]\nat = ["0.2 m", "50 mm", "50 mm"]\nstiffness = ["1e5 N/m", '
    joint += '"1e5 N/m", "1e5 N/m", "1e4 N m/rad", "1e4 N m/rad", "1e4 N m/rad"]'
    bonded, jointed = (meshed(mesh, parts, support='interface = ["root"]', more=root + places + more) for more in ("", joint))
    assert jointed.mass.shape[0] == bonded.mass.shape[0] + 3 * 8
    added = np.diag(flexibility(jointed, "tip") - flexibility(bonded, "tip"))
    assert_allclose(added, [1e-5, 1e-5 + 0.04 / 1e4, 1e-5 + 0.04 / 1e4], rtol=1e-3)


def test_springs_to_the_ground_carry_a_free_body_and_a_spring_between_two_places_holds_them_together(meshed: Meshed) -> None:
    points, elements = bricks((2, 1, 1), (0.2, 0.1, 0.1), "C3D8")
    stiffness = ", ".join([*3 * ['"100 N/m"'], *3 * ['"1 N m/rad"']])
    ground = f'[fe_model.springs.s]\nat = ["0.1 m", "50 mm", "50 mm"]\nstiffness = [{stiffness}]'
    structure = meshed(
        abaqus(points, {"p": ("C3D8", elements)}), f"[fe_model.parts.p]\n{STEEL}", support='support = "ground"', more=ground
    )
    pairs = lowest(structure.stiffness, structure.mass, 6)
    m = RHO * 0.2 * 0.1 * 0.1
    inertia = m / 12 * np.array([0.02, 0.05, 0.05])
    wanted = np.sort(np.sqrt(np.append(np.full(3, 100 / m), 1 / inertia)))
    assert_allclose(np.sqrt(pairs.values), wanted, rtol=1e-6)
    apart = abaqus(
        np.array([[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 0]]),
        {"left": ("B31", [[1, 2]]), "right": ("B31", [[3, 4]])},
        {"root": [1], "tip": [4]},
    )
    between = f"[fe_model.springs.s]\nbetween = [2, 3]\nstiffness = [{stiffness}]"
    joined = meshed(apart, HALVES, support='interface = ["root"]', more=between)
    assert joined.joints == ("s",)
    assert_allclose(flexibility(joined, "tip")[0, 0], 2 / (E * AREA) + 1 / 100, rtol=1e-9)


def test_a_link_is_rigid_and_carries_mass_exactly(meshed: Meshed) -> None:
    points, elements = bricks((2, 1, 1), (0.2, 0.1, 0.1), "C3D20")
    mesh, part = abaqus(points, {"p": ("C3D20", elements)}), f"[fe_model.parts.p]\n{STEEL}"
    link = '[fe_model.groups.end]\nbox = [["0.2 m", "0 m", "0 m"], ["0.2 m", "1 m", "1 m"]]\n'
    link += '[fe_model.links.hub]\nat = ["0.3 m", "50 mm", "50 mm"]\nnodes = "end"'
    plain, linked = meshed(mesh, part), meshed(mesh, part, more=link)
    assert linked.mass.shape[0] == plain.mass.shape[0] - 3 * 8 + 6
    assert_allclose(linked.rigid_mass, plain.rigid_mass, rtol=1e-12, atol=1e-12)
    assert_allclose(linked.stiffness @ linked.rigid, 0, atol=1e-12 * abs(linked.stiffness).max())
    # Points of the face move as the hub does, whatever the structure does
    u = np.random.default_rng(4).standard_normal(linked.mass.shape[0])
    elements_of = linked.elements
    assert elements_of is not None
    hub, face = (
        linked.places["hub"] @ u,
        [row @ u for row in elements_of.rows([[0.2, 0.0, 0.0], [0.2, 0.1, 0.1], [0.2, 0.03, 0.07]])],
    )
    turn = u[linked.rotations[np.flatnonzero(linked.rotations[:, 0] >= 0)[0]]]
    for place, moved in zip([[0.2, 0.0, 0.0], [0.2, 0.1, 0.1], [0.2, 0.03, 0.07]], face, strict=True):
        assert_allclose(moved, hub + np.cross(turn, np.array(place) - [0.3, 0.05, 0.05]), rtol=1e-9)


LINKED = '[fe_model.links.bolt]\nat = ["0.5 m", "0 m", "0 m"]\nnodes = [3, 4]\n'


def apart(length: float = 1.0) -> str:
    """As `chain`, the halves with a node each in the middle."""
    points = np.column_stack([length * np.array([0, 0.25, 0.5, 0.5, 0.75, 1]), np.zeros((6, 2))])
    halves = {"left": ("B31", [[1, 2], [2, 3]]), "right": ("B31", [[4, 5], [5, 6]])}
    return abaqus(points, halves, {"root": [1], "tip": [6]})


@pytest.mark.parametrize("support", ['support = "ground"\ninterface = ["root"]', 'support = "free"'])
def test_parts_that_a_link_ties_are_joined_as_if_welded_by_a_joint_that_may_give(meshed: Meshed, support: str) -> None:
    welded, linked = meshed(chain(), HALVES, support=support), meshed(apart(), HALVES, support=support, more=LINKED)
    assert (welded.joints, linked.joints) == ((), ("bolt@right",))
    of_welded, of_linked = by_itself(welded, 1000.0), by_itself(linked, 1000.0)
    assert len(of_welded.frequency) == len(of_linked.frequency) > 3
    assert_allclose(of_linked.frequency, of_welded.frequency, rtol=1e-4)
    assert_allclose(linked.rigid_mass, welded.rigid_mass, rtol=1e-12, atol=1e-12)
    # What gives there is a spring in the place of the link
    units = [*3 * ['"1e12 N/m"'], '"1e9 N m/rad"', '"1e9 N m/rad"', '"2e3 N m/rad"']
    spring = f"[fe_model.springs.bolt]\nbetween = [3, 4]\nstiffness = [{', '.join(units)}]"
    soft = by_itself(meshed(apart(), HALVES, support=support, more=spring), 1000.0)
    few = FAMILIES["connection-compliance"].change(of_linked.matrices, ("bolt@right", "gamma"), {"": 1 / 2e3})
    found, wanted = (np.sqrt(real_modes(each).squares.clip(0)) / (2 * np.pi) for each in (few, soft.matrices))
    low = wanted < 1000.0
    assert_allclose(found[: len(wanted)][low], wanted[low], rtol=1e-3, atol=1e-2)
    assert not np.allclose(of_linked.frequency[:3], soft.frequency[:3], rtol=0.01)


@pytest.mark.parametrize("ends", ['at = "bolt"', 'between = ["bolt", "tip"]'])
def test_a_spring_at_a_link_in_some_directions_hides_no_joint_of_it(meshed: Meshed, ends: str) -> None:
    units = ['"0 N/m"', '"0 N/m"', '"1e5 N/m"', *3 * ['"0 N m/rad"']]
    pad = f"[fe_model.springs.pad]\n{ends}\nstiffness = [{', '.join(units)}]\n"
    held = 'support = "ground"\ninterface = ["root"]'
    bare, sprung = (by_itself(meshed(apart(), HALVES, support=held, more=LINKED + more), 1000.0).matrices for more in ("", pad))
    assert_allclose(sprung.joints["bolt@right"].stiffness, bare.joints["bolt@right"].stiffness, rtol=1e-9)


def test_what_a_joint_gives_shows_from_the_first_radian_however_stiff_it_is(meshed: Meshed) -> None:
    """Its own compliance is a ten-thousandth of a plausible one: a step between the two is no derivative."""
    m = by_itself(meshed(apart(), HALVES, support='support = "free"', more=LINKED), 1000.0).matrices
    for size in (0.0, 1e-4):
        added = Added(named=Named(family="connection-compliance", targets=("bolt@right", "gamma"), values={"": size}))
        after, found = structure(m, {}, [added])
        modes = real_modes(after)
        phi = modes.shapes[:, 6:10]
        (tangent,) = found.values()
        derivative = np.sum(phi * (full(tangent, "stiffness", len(phi)) @ phi), axis=0)
        step = 5e-7  # well above the rounding of eigenvalues; what it curves by is 0.2 %
        more = FAMILIES["connection-compliance"].change(m, ("bolt@right", "gamma"), {"": size + step})
        slope = (real_modes(more).squares[6:10] - modes.squares[6:10]) / step
        assert_allclose(derivative, slope, rtol=0.02, atol=2e-3 * abs(slope).max())
        assert derivative.min() < -1e7


def test_a_link_that_the_ground_holds_is_a_clamp_that_may_give_and_one_of_welded_parts_is_none(meshed: Meshed) -> None:
    clamp = '[fe_model.links.clamp]\nat = ["0 m", "0 m", "0 m"]\nnodes = [1]\n'
    held = 'support = "ground"\ninterface = ["clamp"]'
    clamped = meshed(chain(), HALVES, support=held, more=clamp)
    assert (clamped.joints, clamped.supports) == (("clamp@left",), ())
    plain = meshed(chain(), HALVES, support='support = "ground"\ninterface = ["root"]')
    assert_allclose(np.diag(flexibility(clamped, "tip")), np.diag(flexibility(plain, "tip")), rtol=1e-4)
    middle = '[fe_model.links.middle]\nat = ["0.5 m", "0 m", "10 mm"]\nnodes = [2, 3]\n'
    assert meshed(chain(), HALVES, support=held, more=clamp + middle).joints == ("clamp@left",)


@pytest.mark.parametrize("count", [model.SEAM, model.SEAM + 1])
def test_few_bolts_may_give_one_by_one_and_a_seam_of_them_holds(meshed: Meshed, count: int) -> None:
    points, elements = plate(8, 1, (1.0, 0.1))
    own = len(points)
    upper = [[node + own for node in quad] for quad in elements]
    both = abaqus(np.vstack([points, points + np.array([0, 0, 0.01])]), {"left": ("S4", elements), "right": ("S4", upper)})
    sheets = "".join(f'[fe_model.parts.{part}]\n{STEEL}\nthickness = "5 mm"\n' for part in ("left", "right"))
    bolts = [
        f'[fe_model.links.bolt-{k}]\nat = ["{points[k][0]} m", "{points[k][1]} m", "0 m"]\nnodes = [{k + 1}, {k + 1 + own}]\n'
        for k in range(count)
    ]
    joints = meshed(both, sheets, support='support = "free"', more="".join(bolts)).joints
    assert len(joints) == (count if count == model.SEAM else 0)


@pytest.mark.parametrize("support", ['support = "ground"\ninterface = ["root"]', 'support = "free"'])
def test_a_place_that_is_tried_answers_as_one_that_was_reduced_anew(
    meshed: Meshed, support: str, monkeypatch: pytest.MonkeyPatch
) -> None:
    known, place = by_itself(meshed(chain(8), HALVES, support=support), 100.0), "@0.375,0,0"
    anew = known.at([place])
    small = by_itself(meshed(chain(2), HALVES, support=support), 5000.0)
    assert small.at(["@0.5,0,0"], anew=False).basis.shape == small.basis.shape  # of which rounding alone is new
    monkeypatch.setattr("validation.prediction.structure.by_itself", lambda *_, **__: pytest.fail("it was reduced anew"))
    whole, condensed = reduced._on_its_own, list[int]()
    monkeypatch.setattr(reduced, "_on_its_own", lambda share, basis: condensed.append(1) or whole(share, basis))
    tried = known.at([place], anew=False)
    assert len(condensed) == 2 * len(known.structure.sections)  # of all else what is new stands beside what is known
    assert known.at([], anew=False) is known
    for name, share in {"": known.structure.stiffness, **known.structure.part_stiffness}.items():
        found = tried.matrices.parts[name] if name else tried.matrices.stiffness
        due = tried.basis.T @ (share @ tried.basis)
        assert_allclose(found, due, atol=1e-9 * np.abs(np.diag(due)).max())
    for kg in (0.1, 10.0):
        ends = [FAMILIES["point-mass"].change(one.matrices, (place,), {"": kg}) for one in (anew, tried)]
        wanted, found = (np.sort(real_modes(one).squares)[6 * anew.structure.floating :][:2] for one in ends)
        assert_allclose(found, wanted, rtol=1e-6)


def test_what_a_link_joins_is_told_by_the_parts_on_it(meshed: Meshed) -> None:
    """Pick-ups on links count for no seam; two welded parts ride as one beside a third; one node of solids rides rigidly."""
    ends = '[fe_model.links.one]\nat = ["0 m", "0 m", "0 m"]\nnodes = [1]\n'
    ends += '[fe_model.links.other]\nat = ["1 m", "0 m", "0 m"]\nnodes = [9]\n'
    ends += "".join(
        f'[fe_model.links.pick-up-{k}]\nat = ["{(k - 1) / 8} m", "0 m", "5 mm"]\nnodes = [{k}]\n' for k in range(2, 9)
    )
    held = 'support = "ground"\ninterface = ["one", "other"]'
    assert meshed(chain(8), HALVES, support=held, more=ends).joints == ("one@left", "other@right")
    points = np.array([[0, 0, 0], [0.5, 0, 0], [1, 0, 0], [0.5, 0, 0.1], [0.5, 0, 0.6]])
    three = abaqus(points, {"left": ("B31", [[1, 2]]), "right": ("B31", [[2, 3]]), "mast": ("B31", [[4, 5]])})
    middle = f"[fe_model.parts.mast]\n{STEEL}\n{BEAM.replace(' }', ', z_axis = [1, 0, 0] }')}\n"
    middle += '[fe_model.links.foot]\nat = ["0.5 m", "0 m", "0 m"]\nnodes = [2, 4]\n'
    assert meshed(three, HALVES, support='support = "free"', more=middle).joints == ("foot@mast",)
    points, elements = bricks((1, 1, 1), (0.2, 0.1, 0.1), "C3D8")
    feet = [k for k, at in enumerate(points.tolist(), 1) if at[2] == 0]
    bolts = "".join(f"[fe_model.links.f{k}]\nat = {[f'{x} m' for x in points[k - 1]]}\nnodes = [{k}]\n" for k in feet)
    stands = f'support = "ground"\ninterface = {[f"f{k}" for k in feet]}'
    block = meshed(abaqus(points, {"p": ("C3D8", elements)}), f"[fe_model.parts.p]\n{STEEL}\n", support=stands, more=bolts)
    assert block.joints == ()
    assert np.sqrt(lowest(block.stiffness, block.mass, 1).values[0]) > 2 * np.pi * 1000


def test_a_body_at_a_place_turns_with_a_solid(meshed: Meshed) -> None:
    points, elements = bricks((2, 2, 1), (0.2, 0.2, 0.1), "C3D8")
    body = '[fe_model.masses.box]\nat = ["0.1 m", "0.1 m", "0.1 m"]\nmass = "3 kg"\n'
    body += 'moments = ["0.02 kg m^2", "0.03 kg m^2", "0.04 kg m^2", "0 kg m^2", "0 kg m^2", "0.005 kg m^2"]'
    structure = meshed(abaqus(points, {"p": ("C3D8", elements)}), f"[fe_model.parts.p]\n{STEEL}", more=body)
    share = structure.rigid.T @ structure.part_mass["box"] @ structure.rigid
    at = np.array([0.1, 0.1, 0.1])
    central = np.array([[0.02, 0, 0], [0, 0.03, 0.005], [0, 0.005, 0.04]])
    assert_allclose(share[3:, 3:], central + 3 * (at @ at * np.eye(3) - np.outer(at, at)), rtol=1e-9, atol=1e-12)
    assert_allclose(np.diag(share)[:3], 3, rtol=1e-9)


@pytest.mark.parametrize("kind", ["C3D4", "C3D10", "C3D6", "C3D15", "C3D8", "C3D20"])
def test_a_place_in_a_solid_is_carried_by_its_element(meshed: Meshed, kind: str) -> None:
    points, elements = bricks((2, 2, 2), (1.0, 0.8, 0.6), kind)
    structure = meshed(abaqus(points, {"p": (kind, elements)}), f"[fe_model.parts.p]\n{STEEL}")
    rng = np.random.default_rng(5)
    gradient, inside = rng.standard_normal((3, 3)), rng.uniform(0, 1, (20, 3)) * [1.0, 0.8, 0.6]
    u = np.zeros(structure.mass.shape[0])
    quadratic = kind in ("C3D10", "C3D20", "C3D15")

    def field(x: np.ndarray) -> np.ndarray:
        return np.asarray(x @ gradient.T + (x**2 if quadratic else 0))

    u[structure.translations] = field(structure.points)
    assert structure.elements is not None
    found = np.array([rows @ u for rows in structure.elements.rows(inside)])
    assert_allclose(found, field(inside), rtol=1e-9, atol=1e-9)


def test_a_place_on_a_shell_or_beam_moves_with_its_curvature_and_beside_it_with_its_turn(meshed: Meshed) -> None:
    points, elements = plate(2, 2, (1.0, 1.0), skew=0.2)
    shell = meshed(abaqus(points, {"p": ("S4", elements)}), f'[fe_model.parts.p]\n{STEEL}\nthickness = "20 mm"')
    u = np.zeros(shell.mass.shape[0])
    x, y, _ = shell.points.T
    u[shell.translations[:, 2]] = 0.5 * x**2 - 0.3 * y**2 + 0.4 * x * y
    u[shell.rotations[:, 0]], u[shell.rotations[:, 1]] = -0.6 * y + 0.4 * x, -(x + 0.4 * y)
    assert shell.elements is not None
    at = np.array([0.31, 0.77, 0.01])
    moved = shell.elements.rows([at])[0] @ u
    a, b, _ = at
    assert_allclose(moved[2], 0.5 * a**2 - 0.3 * b**2 + 0.4 * a * b, rtol=1e-9)
    assert_allclose(moved[:2], -0.01 * np.array([a + 0.4 * b, -0.6 * b + 0.4 * a]), rtol=0.2, atol=1e-3)
    beam = meshed(chain(), HALVES)
    u = np.zeros(beam.mass.shape[0])
    x = beam.points[:, 0]
    u[beam.translations[:, 1]], u[beam.rotations[:, 2]] = x**3, 3 * x**2
    u[beam.translations[:, 2]], u[beam.rotations[:, 1]] = x**2, -2 * x
    assert beam.elements is not None
    assert_allclose(beam.elements.rows([[0.41, 0.0, 0.0]])[0] @ u, [0, 0.41**3, 0.41**2], atol=1e-12)


@pytest.mark.parametrize("kind", ["S3", "S4", "S8R"])
def test_stiffness_of_shells_is_of_first_and_third_power_of_the_thickness(meshed: Meshed, kind: str) -> None:
    points, elements = plate(2, 2, (1.0, 0.8), "S3" if kind == "S3" else "S4", skew=0.1)
    if kind == "S8R":  # middles of edges, each there once
        middle: dict[tuple[int, int], int] = {}
        grown = [list(quad) for quad in elements]
        extra = []
        for quad in grown:
            for a, b in zip(quad[:4], [*quad[1:4], quad[0]], strict=True):
                key = (min(a, b), max(a, b))
                if key not in middle:
                    middle[key] = len(points) + len(extra) + 1
                    extra.append((points[a - 1] + points[b - 1]) / 2)
                quad.append(middle[key])
        points, elements = np.vstack([points, extra]), grown

    def made(mm: float) -> Structure:
        return meshed(abaqus(points, {"p": (kind, elements)}), f'[fe_model.parts.p]\n{STEEL}\nthickness = "{mm} mm"')

    one, thicker = made(10), made(13)
    linear, cubic = one.sections["p"]
    assert_allclose((linear + cubic).toarray(), one.part_stiffness["p"].toarray(), atol=1e-9 * abs(one.stiffness).max())
    assert_allclose((1.3 * linear + 1.3**3 * cubic).toarray(), thicker.stiffness.toarray(), atol=1e-9 * abs(one.stiffness).max())


def test_the_thickness_of_a_beam_is_its_height_to_first_order(meshed: Meshed) -> None:
    def made(mm: float) -> Structure:
        section = f'section = {{ width = "20 mm", height = "{mm} mm" }}\n'
        return meshed(chain(), "".join(f"[fe_model.parts.{part}]\n{STEEL}\n{section}" for part in ("left", "right")))

    plain, thicker = made(30), made(30 * 1.0001)
    slope = (thicker.stiffness - plain.stiffness).toarray() / 1e-4
    wanted = sum((linear + 3 * cubic).toarray() for linear, cubic in plain.sections.values())
    assert_allclose(slope, wanted, atol=1e-3 * np.abs(wanted).max())
    assert_allclose(sum((a + b).toarray() for a, b in plain.sections.values()), plain.stiffness.toarray(), rtol=1e-9, atol=1e-3)


def test_held_by_the_ground_and_by_a_base_are_one_structure_when_neither_moves(meshed: Meshed) -> None:
    base = meshed(chain(), HALVES, support='interface = ["root"]')
    ground = meshed(chain(), HALVES, support='support = "ground"\ninterface = ["root"]')
    assert ground.mass.shape[0] == base.mass.shape[0] - 6
    found = np.sqrt(lowest(ground.stiffness, ground.mass, 4).values) / (2 * np.pi)
    assert_allclose(found, fixed_base(base, 4).frequency, rtol=1e-9)


def test_a_part_keeps_its_loss_factor_and_tolerances_and_the_unit_of_length_scales_all(meshed: Meshed) -> None:
    points, elements = bricks((2, 1, 1), (200.0, 100.0, 50.0), "C3D8")
    part = f"[fe_model.parts.p]\n{STEEL}\nloss_factor = 0.02\ntolerance = {{ modulus = 0.05, density = 0.01 }}"
    mm = meshed(abaqus(points, {"p": ("C3D8", elements)}), part, units="mm")
    m = meshed(abaqus(points / 1000, {"p": ("C3D8", elements)}), part, units="m-kg-N-s")
    assert mm.loss_factors == {"p": 0.02}
    assert mm.part_tolerances == {"p": {"modulus": 0.05, "density": 0.01}}
    assert_allclose(mm.stiffness.toarray(), m.stiffness.toarray(), rtol=1e-9, atol=1e-9 * abs(m.stiffness).max())


def test_a_place_at_the_corner_of_two_sheets_is_as_near_as_the_thicker_one_reaches(meshed: Meshed) -> None:
    floor = [[0, 0, 0], [0.1, 0, 0], [0.1, 0.1, 0], [0, 0.1, 0]]
    wall = [[0, 0, -0.1], [0, 0.1, -0.1]]
    mesh = abaqus(np.array(floor + wall), {"wall": ("S4", [[1, 4, 6, 5]]), "floor": ("S4", [[1, 2, 3, 4]])})
    parts = "".join(f'[fe_model.parts.{name}]\n{STEEL}\nthickness = "{t} mm"\n' for name, t in (("wall", 2), ("floor", 3)))
    structure = meshed(mesh, parts, more='[fe_model.places]\ntip = ["-1 mm", "-1 mm", "1.9 mm"]')
    assert_allclose(structure.places["tip"].toarray() @ structure.rigid[:, 3], [0, -1.9e-3, -1e-3], atol=1e-12)


def test_a_place_on_a_round_body_of_twelve_flat_sides_is_on_it(meshed: Meshed) -> None:
    turn = np.arange(13) * np.pi / 6
    ring = np.column_stack([np.cos(turn), np.sin(turn), 0 * turn])[:12]
    points = np.vstack([r * ring + [0, 0, z] for z in (0, 0.52) for r in (0.5, 1.0)])
    cells = [[1 + k, 13 + k, 13 + (k + 1) % 12, 1 + (k + 1) % 12] for k in range(12)]
    mesh = abaqus(points, {"tube": ("C3D8", [[*cell, *(n + 24 for n in cell)] for cell in cells])})
    at = ", ".join(f'"{value} m"' for value in (np.cos(np.pi / 12), np.sin(np.pi / 12), 0.26))
    structure = meshed(mesh, f"[fe_model.parts.tube]\n{STEEL}\n", more=f"[fe_model.places]\ntip = [{at}]")
    assert "tip" in structure.places


@pytest.mark.parametrize("at", ['"534 mm", "0.1 m", "0.1 m"', '"0.2 m", "0.2 m", "534 mm"'])
def test_a_place_beside_a_flat_face_is_outside(meshed: Meshed, at: str) -> None:
    points, elements = bricks((1, 1, 1), (0.5, 0.5, 0.5), "C3D8")
    mesh = abaqus(points, {"p": ("C3D8", elements)})
    with pytest.raises(BadInput, match=r"places.tip.*lies 34 mm outside the mesh"):
        meshed(mesh, f"[fe_model.parts.p]\n{STEEL}", more=f"[fe_model.places]\ntip = [{at}]")


def test_a_place_outside_says_how_far_and_where_the_mesh_is_nearest(meshed: Meshed) -> None:
    points, elements = bricks((2, 2, 2), (1.0, 1.0, 1.0), "C3D8")
    with pytest.raises(
        BadInput, match=r"places.tip.*lies 200 mm outside the mesh; the nearest point is \(1000, 500, 500\) mm in element"
    ):
        meshed(
            abaqus(points, {"p": ("C3D8", elements)}),
            f"[fe_model.parts.p]\n{STEEL}",
            more='[fe_model.places]\ntip = ["1.2 m", "0.5 m", "0.5 m"]',
        )


def test_free_beams_have_six_motions_at_zero(meshed: Meshed) -> None:
    structure = meshed(chain(), HALVES)
    pairs = lowest(structure.stiffness, structure.mass, 7, shift=floating_shift(structure.stiffness, structure.mass))
    assert_allclose(pairs.values[:6], 0, atol=1e-6 * pairs.values[6])
    first = 4.730040745**2 * np.sqrt(E * IZ / (RHO * AREA))
    assert_allclose(np.sqrt(pairs.values[6]), first, rtol=0.01)


def test_a_beam_that_ends_on_a_solid_is_welded_to_it(meshed: Meshed) -> None:
    """A block 1000 times as stiff holds the beam as a clamp does; a hinge would leave it to swing."""
    points, elements = bricks((2, 2, 1), (0.2, 0.2, 0.1), "C3D20")
    top = int(np.argmin(np.linalg.norm(points - [0.1, 0.1, 0.1], axis=1))) + 1
    mast = np.column_stack([np.full((8, 2), 0.1), 0.1 + np.linspace(0, 1, 9)[1:]])
    lines = [[top, len(points) + 1], *([len(points) + k, len(points) + k + 1] for k in range(1, 8))]
    mesh = abaqus(np.vstack([points, mast]), {"block": ("C3D20", elements), "mast": ("B31", lines)}, {"tip": [len(points) + 8]})
    parts = f"[fe_model.parts.block]\n{STEEL}\n[fe_model.parts.mast]\n{STEEL}\n{BEAM}\n"
    ground = '[fe_model.groups.under]\nbox = [["0 m", "0 m", "0 m"], ["1 m", "1 m", "0 m"]]'
    welded = meshed(mesh, parts, support='interface = ["under"]', more=ground)
    found = np.diag(flexibility(welded, "tip"))[:2]
    assert_allclose(found, [1 / (3 * E * IY), 1 / (3 * E * IZ)], rtol=0.02)
    free = meshed(mesh, parts)
    assert_allclose(free.stiffness @ free.rigid, 0, atol=1e-12 * abs(free.stiffness).max())


@pytest.mark.parametrize(
    ("lines", "words"),
    [
        ('interface = ["foot", "side", "foot"]', "fe_model.interface.*names 'foot' twice"),
        (
            "\n".join(
                f'springs.{name} = {{ at = ["1 m", "0 m", "0 m"], stiffness = ["1 N/m", "1 N/m", "{k} N/m", "1 N m/rad", '
                '"1 N m/rad", "1 N m/rad"] }'
                for name, k in (("one", 1), ("other", 2), ("again", 2))
            ),
            "fe_model.springs.again.*is other once more: the same stiffness at the same place",
        ),
    ],
)
def test_a_support_that_is_named_twice_is_refused(tmp_path: Path, lines: str, words: str) -> None:
    text = f'format = 1\n[fe_model]\nkind = "mesh"\nunits = "mm"\nfile = "mesh.inp"\nsupport = "ground"\n{lines}\n'
    (tmp_path / "mesh.inp").touch()
    (tmp_path / "model.toml").write_text(f"{text}[fe_model.parts.p]\n{STEEL}\n")
    with pytest.raises(BadInput, match=words):
        description.read(tmp_path / "model.toml")


def test_a_part_without_a_loss_beside_others_that_state_one_is_named(meshed: Meshed) -> None:
    """A spring's loss alone leaves every mode of the beam with a hundredth of a per cent and less."""
    first, second = HALVES.split("[fe_model.parts.right]")
    for parts, silent in ((HALVES, ["left", "right"]), (f"{first}loss_factor = 0\n[fe_model.parts.right]{second}", ["right"])):
        structure = meshed(chain(), parts, support='support = "ground"\ninterface = ["root"]', more=PAD)
        assert [one.where for one in lossless(structure)] == silent
    assert lossless(meshed(chain(), HALVES, support='support = "ground"\ninterface = ["root"]')) == []
