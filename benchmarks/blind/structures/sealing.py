"""A case of a structure becomes a folder, as a laboratory would hand it over, and its truth, which goes elsewhere.

The model is the plan on its coarse mesh. The test is one of another mesh: finer, of other elements, its parts off by what a
laboratory admits, with the fault in its stiffness, mass or losses; `validation.virtual_test` answers it, as no prediction does.
"""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import replace
from functools import lru_cache
from pathlib import Path
from tempfile import TemporaryDirectory

import numpy as np

from benchmarks.blind.drawing.case import NULL
from benchmarks.blind.names import MODEL, SETTINGS, Json
from benchmarks.blind.structures import shapes
from benchmarks.blind.structures.drawing import (
    BASE_FORCES,
    FUNCTIONS,
    OF_SENSORS,
    ON_BASE,
    TABLE,
    Fault,
    StructureCase,
    at_node,
    planted,
)
from fem.structure import Structure, place_rows, rows_beside
from fem.user_model import reading
from geometry.atomic import write_text
from geometry.dynamic_mass import MOTIONS
from geometry.frames import Array, Pose, rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia
from geometry.sensors import Channel, ChannelTable, Place
from identification.campaign import Campaign, Recording, Run
from identification.files.files import Signals
from validation.diagnose.candidates import baseline, candidates, detectable, screen
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import position
from validation.prediction import structure as reduction
from validation.study import Study
from validation.virtual_test.layout import stream
from validation.virtual_test.structure_tests import StructureTest, TestedStructure

MESH, TEST, CAMPAIGN = "mesh.inp", "test.toml", "campaign"

Band = tuple[float, float]

ARTICLE = "structure"

SENSORS, DRIVES, MODES, LINES = 8, 2, 6, 600
"""[count] of sensors of a test, those of them that are driven, modes in its band, and lines: several within the width of every
peak."""

NODES = 4
"""[count] of nodes without a name at which a draw looks for one that the data tell."""

NOISE, GAIN, FREQUENCY, SHAPE = 0.004, 0.003, 1e-3, 0.02
"""Relative, one standard deviation: of a response function, of a sensor, of a measured frequency, of an entry of a shape."""

RECORDED = 0.001
"""[1] Share of each reading of a test by base motion that is noise, beside `NOISE` of the loudest of its kind in all of them."""

CROSS = 0.03
"""[1] Of what a base does along its other axes, one standard deviation."""

SEAT = np.array([0.0, 0.0, 0.05])
"""[m] From F, where a structure stands on the plate."""

CELL = np.array([8e8, 8e8, 2e9])
"""[N/m] Stiffness of a load cell along x, y, z."""

PLATE = Inertia.from_cog(15.0, (0.0, 0.0, 0.02), np.diag([0.25, 0.25, 0.5])).mass_matrix
"""What the cells carry beside the structure, about F, as the model states it."""

PLATE_KNOWN = 0.005
"""Share within which that is known, half of what the model states."""

LABORATORY = """
[laboratory]
cell_stiffness_N_m = [8e8, 8e8, 2e9]
fmd = { mass_kg = 15.0, cog_mm = [0.0, 0.0, 20.0], moi_cog_kgm2 = [0.25, 0.25, 0.5], tolerance = 0.01 }

"""

OF_PARTS = ("modulus", "mass", "thickness", "support-stiffness", "connection-compliance", "structural-damping")
KNOWN = (*OF_PARTS, *OF_SENSORS)
"""Families whose faults have names."""


def sealed(case: StructureCase, folder: Path) -> Json:
    """The truth of `case`, whose model and test are written into `folder`."""
    plan, places, fine, band = _drawn(case.shape, case.structure, case.test in ON_BASE)
    null = replace(case, name="", kind="", wanted=(), before=(), leave_out=(), null="")
    faults = planted(case, limits_of(null)) if case.wanted else ()
    _handed_over(case, plan, places, fine, band, faults, folder)
    return truth(case, faults, places)


def truth(case: StructureCase, faults: Sequence[Fault], places: Mapping[str, shapes.Point]) -> Json:
    """What `case` is; spacing [m] is the mean distance of a sensor from the one nearest to it, of `places` in millimetres.

    Where the data tell nothing of what was to be planted, as a table of shapes of where its pick-ups are, it is one more null.
    """
    at = {name: [x / 1e3 for x in place] for name, place in places.items()}
    apart = np.array(list(at.values())).reshape(-1, 3)
    near = [float(np.sort(np.linalg.norm(apart - one, axis=1))[1]) for one in apart]
    return {
        "name": case.name,
        "kind": case.kind if faults else NULL,
        "laboratory": case.laboratory,
        "shape": case.shape,
        "test": case.test,
        "null": case.null,
        "leave_out": list(case.leave_out),
        "articles": [ARTICLE],
        "hold_out": [],
        "spacing": float(np.mean(near)) if near else 0.0,
        "places": at,
        "planted": [{"id": one.id, "sizes": {"": one.size}, "multiple": one.multiple, "told": one.multiple} for one in faults],
    }


@lru_cache(maxsize=1)
def _drawn(kind: str, structure: int, base: bool) -> tuple[shapes.Plan, dict[str, shapes.Point], Structure, Band]:
    """The plan of a structure, its sensors, its finer mesh and the band of its tests: all cases of it have the same."""
    plan = shapes.drawn(kind, stream(structure, "plan"), base=base)
    places = _sensors(plan, structure)
    with TemporaryDirectory() as scratch:
        fine = written(plan, places, Path(scratch), fine=True)
    return plan, places, fine, _band(fine)


def _sensors(plan: shapes.Plan, structure: int) -> dict[str, shapes.Point]:
    """Places of the sensors on the coarse mesh, as far apart as they come; none where the ground holds."""
    mesh, generator = plan.mesh(fine=False), stream(structure, "sensors")
    held = set(mesh.held)
    free = np.array([point for point, number in mesh.nodes.items() if number not in held])
    chosen = [int(generator.integers(len(free)))]
    while len(chosen) < SENSORS:
        away = np.min([np.linalg.norm(free - free[k], axis=1) for k in chosen], axis=0)
        chosen.append(int(np.argmax(away * generator.uniform(0.7, 1.0, len(free)))))
    return {f"s{k + 1}": (float(x), float(y), float(z)) for k, (x, y, z) in enumerate(free[chosen])}


def written(plan: shapes.Plan, places: Mapping[str, shapes.Point], folder: Path, *, fine: bool) -> Structure:
    folder.mkdir(parents=True, exist_ok=True)
    write_text(folder / MESH, plan.mesh(fine=fine).text())
    write_text(folder / "fe.toml", f"format = 1\n{plan.description(MESH, places)}")
    found = reading.read(folder / "fe.toml")
    assert isinstance(found, Structure)
    return found


@lru_cache(maxsize=2)
def limits_of(null: StructureCase) -> Mapping[str, float]:
    """By id the smallest size that `null` would name, of faults with names and at some nodes that have none."""
    plan, places, fine, band = _drawn(null.shape, null.structure, null.test in ON_BASE)
    with TemporaryDirectory() as scratch:
        folder = Path(scratch) / "null"
        _handed_over(null, plan, places, fine, band, (), folder)
        return _limits(folder, null)


def _limits(folder: Path, null: StructureCase) -> dict[str, float]:
    study = Study.open(folder / MODEL, [folder / _data(null)])
    base = baseline(study)
    menu = [one for one in candidates(study) if one.named.family in KNOWN and "every" not in one.named.targets]
    found = {one.id: one.size for one in detectable(screen(study, base, menu)) if not one.at}  # to either side
    generator = stream(null.laboratory, "nodes")
    reduced = (*study.tests, *study.made)[0].structure.reduced  # type: ignore[union-attr]
    assert reduced is not None
    points, moved = reduced.nodes()
    first = reduced.matrices.base  # modes come behind the motions of a base
    size = np.linalg.norm(reduced.basis[moved][:, :, first : first + MODES], axis=(1, 2))
    lively = np.flatnonzero(size > 0.2 * size.max())
    nodes = points[generator.choice(lively, NODES, replace=False)]
    ready = study.ready_at([at_node("point-mass", node, "").partition(":")[2] for node in nodes])
    base = baseline(ready)
    there = [one for one in candidates(ready, only=("point-mass", "cable")) if position(one.named.target) is not None]
    found |= {one.id: one.size for one in detectable(screen(ready, base, there))}
    return found


def _handed_over(
    case: StructureCase,
    plan: shapes.Plan,
    places: Mapping[str, shapes.Point],
    fine: Structure,
    band: Band,
    faults: Sequence[Fault],
    to: Path,
) -> None:
    """The model, the test and the settings, written into `to`."""
    to.mkdir(parents=True, exist_ok=True)
    write_text(to / MESH, plan.mesh(fine=False).text())
    head = f'format = 1\nmodel = {{ title = "a structure", article = "{ARTICLE}" }}\n'
    head += LABORATORY if case.test == BASE_FORCES else ""
    write_text(to / MODEL, head + plan.description(MESH, places))
    write_text(to / SETTINGS, json.dumps({"data": [_data(case)], "hold_out": [], "leave_out": list(case.leave_out)}))
    tested, losses = with_faults(fine, case.laboratory, faults)
    lab = TestedStructure(highest=band[1], structure=tested, losses=losses, ratio=0.0)
    generator = stream(case.laboratory, "test")
    sensors = [f"{name}:{'xyz'[int(generator.integers(3))]}" for name in places]
    rows = [read_by(tested, one, places[one[:-2]], faults) for one in sensors]
    gains = 1 + GAIN * generator.standard_normal(len(sensors))
    sizes = {one.id: one.size for one in faults}
    gains *= [1 + sizes.get(f"accelerometer-gain:{one.replace(':', '-')}", 0.0) for one in sensors]
    if case.test in ON_BASE:
        at = [np.array(places[one[:-2]]) / 1e3 for one in sensors]
        made = _on_base(lab, rows, sensors, at, gains, band, generator, forces=case.test == BASE_FORCES)
    elif case.test == FUNCTIONS:
        late = np.array([sizes.get(f"accelerometer-delay:{one.replace(':', '-')}", 0.0) for one in sensors])
        made = _functions(lab, rows, sensors, gains, late, band, generator)
    else:
        made = _table(lab, rows, sensors, gains, band, generator)
    made.fill(to / CAMPAIGN if case.test in ON_BASE else to)


def _data(case: StructureCase) -> str:
    return CAMPAIGN if case.test in ON_BASE else TEST


def read_by(tested: Structure, sensor: str, at: shapes.Point, faults: Sequence[Fault]) -> Array:
    """(n,) what moves an accelerometer `at` [mm] along its direction, turned and shifted as `faults` have it."""
    place, _, axis = sensor.partition(":")
    direction, shift = np.eye(3)["xyz".index(axis)], np.zeros(3)
    for one in faults:
        family, *targets = one.id.split(":")
        if targets[0] != f"{place}-{axis}" or len(targets) < 2:
            continue
        along = one.size * np.eye(3)["xyz".index(targets[1])]
        if family == "accelerometer-misalignment":
            direction = direction + np.cross(along, direction)
        elif family == "accelerometer-position":
            shift = along
    rows = rows_beside(tested, np.array(at) / 1e3 + shift) if np.any(shift) else tested.places[place]
    return np.asarray(direction @ rows.toarray())


def _band(fine: Structure) -> tuple[float, float]:
    from fem.modes import floating_shift, lowest
    from fem.structure import hold

    free = hold(fine)
    rigid = 6 if fine.floating else 0
    shift = floating_shift(free.stiffness, free.mass) if rigid else 0.0
    squares = lowest(free.stiffness, free.mass, MODES + 1 + rigid, shift=shift).values[rigid:]
    f = np.sqrt(np.abs(squares)) / (2 * np.pi)
    return 0.6 * float(f[0]), float(np.sqrt(f[MODES - 1] * max(f[MODES], 1.01 * f[MODES - 1])))


def with_faults(fine: Structure, laboratory: int, faults: Sequence[Fault]) -> tuple[Structure, dict[str, float]]:
    """`fine` off by what a laboratory admits, with `faults`, and the loss factors of its parts."""
    generator = stream(laboratory, "tolerances")
    K, M, losses = {}, {}, {}
    sizes = {one.id: one.size for one in faults}
    for name in sorted({*fine.part_stiffness, *fine.part_mass}):
        support = name in fine.supports
        stiffer = float(np.exp((0.1 if support else 0.025) * generator.standard_normal()))
        denser = float(1 + FAMILIES["mass"].tolerance * generator.standard_normal())
        thicker = float(np.exp(FAMILIES["thickness"].tolerance * generator.standard_normal()))
        lossier = float(np.exp(0.2 * generator.standard_normal()))
        stiffer = sizes.get(f"support-stiffness:{name}", stiffer) if support else stiffer
        stiffer = 1 + sizes[f"modulus:{name}"] if f"modulus:{name}" in sizes else stiffer
        denser = 1 + sizes[f"mass:{name}"] if f"mass:{name}" in sizes else denser
        thicker = 1 + sizes[f"thickness:{name}"] if f"thickness:{name}" in sizes else thicker
        thicker = thicker if name in fine.sections else 1.0
        if name in fine.part_stiffness:
            share = fine.part_stiffness[name]
            if name in fine.sections:
                one, cubed = fine.sections[name]
                share = share + (thicker - 1) * one + (thicker**3 - 1) * cubed
            K[name] = stiffer * share
            lost = lossier * fine.loss_factors.get(name, 0.0) + sizes.get(f"structural-damping:{name}", 0.0)
            if lost > 0:
                losses[name] = lost
        if name in fine.part_mass:
            M[name] = denser * thicker * fine.part_mass[name]
    for one in faults:
        family, *targets = one.id.split(":")
        if family == "connection-compliance":
            here = replace(fine, part_stiffness={**fine.part_stiffness, targets[0]: K[targets[0]]})  # of this laboratory
            springs = reduction.joint_springs(here, targets[0])
            assert springs is not None
            p, k = springs[0][MOTIONS.index(targets[1])], springs[1][MOTIONS.index(targets[1])]
            at = np.flatnonzero(p)
            from scipy.sparse import csr_array

            column = csr_array((p[at], (at, np.zeros_like(at))), shape=(len(p), 1))
            K[targets[0]] = K[targets[0]] - one.size / (1 + one.size * k) * (column @ column.T)
        elif family in ("point-mass", "cable"):
            rows = place_rows(fine, np.array(position(targets[0])))[0]
            if family == "point-mass":
                M["attached"] = one.size * (rows.T @ rows)
            else:
                row = rows[["xyz".index(targets[1])]]
                K["attached"] = one.size * (row.T @ row)
    whole, mass = (sum(list(each.values())[1:], next(iter(each.values()))) for each in (K, M))
    lossy = {name: share for name, share in K.items() if name in losses}
    lossy["others"] = whole - sum(list(lossy.values())[1:], next(iter(lossy.values())))
    bare = replace(fine, stiffness=whole.tocsr(), mass=mass.tocsr(), part_stiffness=lossy, part_mass={}, sections={})
    grounded = fine.grounded or any(one.id.startswith("cable") for one in faults)
    return replace(bare, supports=(), joints=(), loss_factors=losses, grounded=grounded), losses


def _functions(
    lab: TestedStructure,
    rows: Sequence[Array],
    sensors: Sequence[str],
    gains: Array,
    late: Array,
    band: Band,
    generator: np.random.Generator,
) -> StructureTest:
    """Accelerances of the sensors, `late` by so many seconds, for a force at each of `DRIVES`."""
    f, drives = np.linspace(*band, LINES), sensors[:DRIVES]
    A = lab.accelerance(f, rows, [lab.structure.places[p].toarray()["xyz".index(a)] for p, a in (d.split(":") for d in drives)])
    A = A * gains[:, None] * np.exp(-2j * np.pi * f[:, None] * late)[:, :, None]
    noise = generator.standard_normal((*A.shape, 2)) @ np.array([1, 1j]) / np.sqrt(2)
    floor = 0.2 * np.sqrt(np.mean(np.abs(A) ** 2, axis=(0, 1), keepdims=True))  # a sensor is as noisy where next to nothing moves
    A = A + NOISE * noise * np.hypot(np.abs(A), floor)
    names = [one.replace(":", "-") for one in sensors]
    signals = {
        f"functions-{k + 1}.h5": Signals(source="a draw", frequency=f, samples=dict(zip(names, A[:, :, k].T, strict=True)))
        for k in range(A.shape[2])
    }
    files = [{"path": name, "drive": drive} for name, drive in zip(signals, drives, strict=True)]
    table = {"format": 1, "kind": FUNCTIONS, "article": ARTICLE, "responses": list(sensors), "files": files, "share": NOISE}
    return StructureTest(table=table, signals=signals)


def _on_base(
    lab: TestedStructure,
    rows: Sequence[Array],
    sensors: Sequence[str],
    at: Sequence[Array],
    gains: Array,
    band: Band,
    generator: np.random.Generator,
    *,
    forces: bool,
) -> StructureTest:
    """Six runs of a base that moves along one axis and a little along the others: spectra of accelerometers on it, of `sensors`,
    which sit `at` (3,) [m], and of the cells below the plate that carries it, which share a load by their stiffness. Pick-ups
    tilt with the base: its accelerations are those that they read and that the structure feels, its weight's share included."""
    f = np.linspace(*band, LINES)
    bent, carried = lab.on_base(f, rows)
    X = rigid_transformation_6(SEAT)
    corners = [np.array([x, y, 0.0]) for x, y in ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))]
    base = [*((f"z{k + 1}", k, 2) for k in range(4)), ("x1", 0, 0), ("x2", 3, 0), ("y1", 0, 1), ("y2", 1, 1)]
    channels, read = [], []
    for name, corner, axis in base:
        channels.append(_channel(f"base-{name}", "acceleration", "cover", corners[corner] + SEAT, axis))
        read.append(np.broadcast_to(rigid_transformation(corners[corner] + SEAT)[axis], (LINES, 6)))
    for name, place, row in zip(sensors, at, (bent @ X).transpose(1, 0, 2), strict=True):
        channels.append(_channel(name.replace(":", "-"), "acceleration", "article", place + SEAT, "xyz".index(name[-1])))
        read.append(row)
    if forces:
        plate = PLATE * (1 + PLATE_KNOWN * generator.standard_normal())
        G, stiff = np.vstack([rigid_transformation(one) for one in corners]), np.tile(CELL, len(corners))[:, None]
        shared = stiff * G @ np.linalg.solve(G.T @ (stiff * G), X.T @ carried @ X + plate)
        for one in range(shared.shape[1]):
            channels.append(_channel(f"cell-{one // 3 + 1}{'xyz'[one % 3]}", "force", "fmd", corners[one // 3], one % 3))
            read.append(shared[:, one])
    every = 1 + GAIN * generator.standard_normal(len(channels))
    every[len(base) : len(base) + len(gains)] = gains
    names, runs, recordings = tuple(one.name for one in channels), [], {}
    for k, motion in enumerate(MOTIONS):
        moved = np.array([2.0, 2.0, 2.0, 6.0, 6.0, 6.0]) * np.where(np.arange(6) == k, 1.0, CROSS * generator.standard_normal(6))
        Y = every[:, None] * (np.array(read) @ moved)
        noise = generator.standard_normal((*Y.shape, 2)) @ np.array([1, 1j]) / np.sqrt(2)
        alike = [[one.quantity == of.quantity for one in channels] for of in channels]
        usual = np.array([[np.median(np.abs(Y[which]).max(axis=0))] for which in alike])
        Y = Y + noise * np.hypot(RECORDED * np.abs(Y), NOISE * usual)
        recordings[motion] = Recording(names=names, values=Y.T, frequency=f, source=motion)
        runs.append(Run(name=motion, file=f"{motion}.h5", axis=motion))
    article = f"fmd+{ARTICLE}" if forces else ARTICLE
    table = ChannelTable(channels=tuple(channels))
    mounting = Pose(position=SEAT)
    made = Campaign(title="a draw", article=article, table=table, runs=tuple(runs), recordings=recordings, mounting=mounting)
    return StructureTest(campaign=made)


def _channel(name: str, quantity: str, group: str, at: Array, axis: int) -> Channel:
    places = (Place(position=at, direction=np.eye(3)[axis]),)
    return Channel(name=name, quantity=quantity, group=group, places=places)


def _table(
    lab: TestedStructure, rows: Sequence[Array], sensors: Sequence[str], gains: Array, band: Band, generator: np.random.Generator
) -> StructureTest:
    """Frequencies and shapes of the modes in the band."""
    hertz, _, shapes = lab.table(rows, 0.1 * band[0], band[1])
    f = hertz * (1 + FREQUENCY * generator.standard_normal(len(hertz)))
    seen = gains * shapes
    seen = seen + SHAPE * np.abs(seen).max(axis=1, keepdims=True) * generator.standard_normal(seen.shape)
    table = {
        "format": 1,
        "kind": TABLE,
        "article": ARTICLE,
        "sensors": list(sensors),
        "frequencies": [f"{one:.6g} +/- {FREQUENCY * one:.3g} Hz" for one in f],
        "shapes": [[float(f"{x:.5g}") for x in row] for row in seen],
        "shapes_deviation": SHAPE,
    }
    return StructureTest(table=table)
