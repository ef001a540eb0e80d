"""Blind cases of random structures: what is planted is what the full matrices of the finer mesh become."""

from dataclasses import replace
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from benchmarks.blind.score.structures import structure_outcome
from benchmarks.blind.structures import sealing, shapes
from benchmarks.blind.structures.drawing import ON_BASE, STRUCK, STRUCTURES, Fault, draw, planted
from fem.structure import place_rows
from validation.diagnose.candidates import baseline, candidates, screen
from validation.prediction.structure import by_itself, joint_springs
from validation.study import Study
from validation.virtual_test.layout import stream

KINDS = ("nulls", "singles", "pairs", "left-out")


def test_a_draw_is_the_same_each_time_and_has_every_kind_of_structure() -> None:
    cases = draw(3, KINDS, 10)
    assert cases == draw(3, KINDS, 10)
    assert {one.shape for one in cases} == set(shapes.KINDS)
    assert [sum(one.kind == kind for one in cases) for kind in KINDS] == [10, 40, 5, 5]


def test_a_single_fault_is_one_and_none_is_drawn_twice_on_a_structure() -> None:
    """Of a table of a frame nothing was planted, since it told no modulus either; of a plate the same modulus twice."""
    cases = [one for one in draw(3, ("singles",), 10) if one.name.startswith("structure-005")]
    limits = {"modulus:left": 0.2, "mass:left": 0.3, "mass:right": 2.0, "point-mass:@0,0,1": 0.1, "accelerometer-gain:s2-x": 0.02}
    ids = [[fault.id for fault in planted(one, limits)] for one in cases]
    found = sorted(id for some in ids for id in some)
    assert found == ["accelerometer-gain:s2-x", "mass:left", "modulus:left", "point-mass:@0,0,1"]
    assert [len(some) for some in ids] == [1, 1, 1, 1]
    assert [sealing.truth(cases[0], some, {})["kind"] for some in (planted(cases[0], limits), ())] == ["singles", "nulls"]


def test_an_accelerometer_reads_what_its_fault_makes_of_it(tmp_path: Path) -> None:
    """Turned about x by 0.1, what reads along y reads a tenth of z as well; moved to the next node, what that does."""
    plan = shapes.drawn("frame", stream(7, "frame"))
    nodes = plan.mesh(fine=False).nodes
    place, other = next((p, q) for p in nodes for q in nodes if p[:2] == q[:2] and p[2] < q[2])
    whole = sealing.written(plan, {"a": place, "b": other}, tmp_path, fine=False)
    _, y, z = whole.places["a"].toarray()[:3]
    turned = sealing.read_by(whole, "a:y", place, [Fault(id="accelerometer-misalignment:a-y:x", size=0.1, multiple=5.0)])
    np.testing.assert_allclose(turned, y + 0.1 * z)
    beside = [Fault(id="accelerometer-position:a-x:z", size=(other[2] - place[2]) / 1e3, multiple=5.0)]
    np.testing.assert_allclose(sealing.read_by(whole, "a:x", place, beside), whole.places["b"].toarray()[0], atol=1e-6)
    np.testing.assert_array_equal(sealing.read_by(whole, "a:z", place, beside), z)


def test_structures_behind_the_first_thirty_stand_on_a_base_and_change_none_of_these() -> None:
    cases, before = draw(3, KINDS, STRUCTURES), draw(3, KINDS, STRUCK)
    assert [one for one in cases if one.test not in ON_BASE] == list(before)
    behind = [one for one in cases if one.test in ON_BASE and one.kind == "nulls"]
    assert {(one.shape, one.test) for one in behind} == set(product(set(shapes.KINDS) - {"plate"}, ON_BASE))


@pytest.mark.parametrize("test", [pytest.param(one, marks=[pytest.mark.proof] * (one == ON_BASE[1])) for one in ON_BASE])
def test_a_sound_structure_on_a_base_is_read_with_the_noise_that_it_has(test: str, tmp_path: Path) -> None:
    """Of spectra without forces noise counted as 0, though accelerometers of a base are more than six: chi² was 594 of a sound
    frame and is 0.93."""
    case = next(one for one in draw(1279881654, ("nulls",), STRUCTURES) if (one.shape, one.test) == ("frame", test))
    truth = sealing.sealed(case, tmp_path / "case")
    assert (truth["test"], truth["planted"]) == (test, [])
    study = Study.open(tmp_path / "case" / "model.toml", [tmp_path / "case" / "campaign"], band=(60.0, 80.0))
    (of,) = study.made
    base = [k for k, name in enumerate(of.measured.channels) if name.startswith("base")]
    noise = of.measured.noise[:, :, base]
    assert 0.003 * 2.0 < noise.min() <= noise.max() < 0.02
    fit = baseline(study).fit
    assert fit.converged
    assert fit.chi2 < 1.1 * fit.degrees_of_freedom
    assert fit.tolerance_z2 < fit.tolerances


def test_cells_below_a_drawn_structure_feel_its_weight_where_the_base_tilts(tmp_path: Path) -> None:
    """Pick-ups that feel no tilt stood in a laboratory without weight: all of the weight of a sound frame was told missing."""
    case = next(one for one in draw(2144645175, ("nulls",), STRUCTURES) if (one.shape, one.test) == ("frame", ON_BASE[1]))
    sealing.sealed(case, tmp_path / "case")
    study = Study.open(tmp_path / "case" / "model.toml", [tmp_path / "case" / "campaign"], band=(10.0, 20.0))
    (told,) = screen(study, baseline(study), [one for one in candidates(study) if one.named.id == "gravity"])
    assert abs(told.told.estimate) < 0.5  # of all of it, known to 0.25


@pytest.mark.proof  # a large case for its rounding; frames on a base are read above
def test_coordinates_of_boxes_on_a_base_stay_apart_from_one_another(tmp_path: Path) -> None:
    """What little of the large answer to a joint lay outside the others was rounding: "leading minor of order 83 of B"."""
    case = next(one for one in draw(1279881654, ("nulls",), STRUCTURES) if (one.shape, one.test) == ("boxes", ON_BASE[0]))
    sealing.sealed(case, tmp_path)
    (of,) = Study.open(tmp_path / "model.toml", [tmp_path / "campaign"]).made
    assert of.structure is not None


@pytest.mark.parametrize("kind", [pytest.param(one, marks=[pytest.mark.proof] * (one == "barrel")) for one in shapes.KINDS])
def test_the_finer_mesh_weighs_what_the_coarse_one_does_and_a_fault_changes_what_it_says(kind: str, tmp_path: Path) -> None:
    plan = shapes.drawn(kind, stream(7, kind))
    point = next(iter(plan.mesh(fine=False).nodes))
    coarse, fine = (sealing.written(plan, {"a": point}, tmp_path / f"{k}", fine=bool(k)) for k in range(2))
    assert abs(fine.rigid_mass[0, 0] / coarse.rigid_mass[0, 0] - 1) < 0.05  # the foot that the ground holds counts elsewise
    part = next(iter(plan.parts))
    place = "@" + ",".join(f"{value / 1e3:.9g}" for value in list(plan.mesh(fine=False).nodes)[-1])
    sound, _ = sealing.with_faults(fine, 5, ())
    faults = (Fault(id=f"modulus:{part}", size=0.3, multiple=5.0), Fault(id=f"point-mass:{place}", size=0.2, multiple=5.0))
    faulty, losses = sealing.with_faults(fine, 5, faults)
    rows = place_rows(fine, np.array([float(x) for x in place[1:].split(",")]))[0]
    assert abs((faulty.mass - sound.mass) - 0.2 * rows.T @ rows).max() < 1e-9
    softer = faulty.stiffness - sound.stiffness
    share = fine.part_stiffness[part]
    k = np.argmax(abs(share.diagonal()))
    assert np.any(abs(softer.diagonal()) > 0.2 * share.diagonal()[k] * 0.9)
    assert set(losses) == set(fine.loss_factors)


@pytest.mark.parametrize("laboratory", [1, 2, 3])
def test_a_joint_that_gives_is_in_series_with_the_one_that_this_laboratory_has(laboratory: int, tmp_path: Path) -> None:
    """It had been taken off the joint as drawn: of one 67 times softer 2.5 % of its own stiffness, a tolerance, was all that
    was left or more than all, and 0.33 um/N were found as 0.50."""
    plan = shapes.drawn("boxes", stream(7, "boxes"))
    fine = sealing.written(plan, {}, tmp_path, fine=True)
    joint = fine.joints[0]
    _, springs = joint_springs(fine, joint) or (None, np.zeros(6))
    size = 66 / springs[0]
    left = []
    for faults in ((), (Fault(id=f"connection-compliance:{joint}:x", size=size, multiple=15.0),)):
        made, _ = sealing.with_faults(fine, laboratory, faults)
        here = replace(fine, part_stiffness={**fine.part_stiffness, joint: made.part_stiffness[joint]})
        left.append((joint_springs(here, joint) or (None, np.zeros(6)))[1][0])
    assert left[0] != pytest.approx(springs[0], rel=1e-3)
    assert 1 / left[1] - 1 / left[0] == pytest.approx(size, rel=1e-3)


def test_a_place_is_right_within_half_the_distance_of_sensors() -> None:
    truth = {
        "name": "x", "kind": "singles", "null": "n", "shape": "plate", "spacing": 0.2,
        "places": {"s1": [0.12, 0.0, 0.0], "s2": [0.4, 0.0, 0.0]},
        "planted": [{"id": "point-mass:@0.1,0,0", "sizes": {"": 0.05}, "multiple": 5.0, "told": 5.0}],
    }  # fmt: skip

    def said(place: object) -> dict[str, object]:
        size = {"key": "", "value": 0.052, "interval90": [0.045, 0.06], "unit": "kg"}
        return {"verdict": "missing", "accepted": [{"id": f"point-mass:{place}", "values": [size], "evidence_nats": 50.0}]}

    near, far, sensor, other = (structure_outcome(truth, said(place)) for place in ("@0.15,0,0", "@0.25,0,0", "s1", "s2"))
    assert near.right
    assert not near.wrong
    assert near.away == pytest.approx(0.25)
    assert [one.inside for one in near.of.sizes] == [True]
    assert far.wrong
    assert not far.right
    assert far.away == pytest.approx(0.75)
    assert sensor.right
    assert sensor.away == pytest.approx(0.1)
    assert other.wrong


def test_a_loss_of_a_part_is_right_where_hardly_any_mode_moves_what_is_driven(tmp_path: Path) -> None:
    """A column of a frame struck along itself: what it gives is the answer of statics, to which the part answers again."""
    (case,) = draw(101, ("nulls",), 1)
    plan = shapes.drawn(case.shape, stream(case.structure, "plan"))
    whole = sealing.written(plan, sealing._sensors(plan, case.structure), tmp_path, fine=False)
    found = by_itself(whole, 80.0)
    few, free, square = found.matrices, whole.free, (2 * np.pi * 22.0) ** 2
    loss = 0.3j * whole.part_stiffness["floor-1"]
    dynamic = (whole.stiffness + loss - square * whole.mass).tocsc()[free][:, free]
    along, seen = whole.places["s1"].toarray()[2], np.vstack([whole.places[f"s{k}"].toarray() for k in range(1, 9)])
    due = seen[:, free] @ splu(dynamic).solve(along[free].astype(complex))
    reduced = few.stiffness + 0.3j * few.parts["floor-1"] - square * few.mass
    rows = np.vstack([few.places[f"s{k}"] for k in range(1, 9)])
    answer = rows @ np.linalg.solve(reduced, few.places["s1"][2])
    away = np.abs(answer - due)[np.abs(due) > 1e-2 * np.abs(due).max()]
    assert away.max() < 1e-3 * np.abs(due).max()


@pytest.mark.proof  # a barrel's whole matrices; what a part's thickness does is held in prediction/test_any_structure.py
def test_a_thinner_part_gives_at_places_as_the_whole_structure_does(tmp_path: Path) -> None:
    """A ring of a barrel, a third thinner, bends more than it stretches: what its points gave was off by as much as it was."""
    plan = shapes.drawn("barrel", stream(7, "barrel"))
    mesh = plan.mesh(fine=False)
    points = [p for p, number in mesh.nodes.items() if number not in set(mesh.held)]
    whole = sealing.written(plan, {f"s{k}": point for k, point in enumerate(points[:: len(points) // 2])}, tmp_path, fine=False)
    few, free = by_itself(whole, 80.0).matrices, whole.free
    part, size = "ring-1", -0.33
    linear, cubed = whole.sections[part]
    K = whole.stiffness + size * linear + ((1 + size) ** 3 - 1) * cubed
    loads = np.vstack([one.toarray() for one in whole.places.values()])[:, free].T
    due = loads.T @ splu(K.tocsc()[free][:, free]).solve(loads)
    one, three = few.sections[part]
    rows = np.vstack([*few.places.values()])
    told = rows @ np.linalg.solve(few.stiffness + size * one + ((1 + size) ** 3 - 1) * three, rows.T)
    scale = np.sqrt(np.outer(np.diag(due), np.diag(due)))
    assert np.abs((told - due) / scale).max() < 5e-3
