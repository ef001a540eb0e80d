"""A small satellite on a shaker: deck and study as a user has them, the test made by a program that knows nothing of massline.

Legs, a deck, a mast and two booms, 9.8 kg. The tested one has three times as many beams, moduli 2 % and densities 0.5 % beside
the drawing, a damping ratio of 0.6 % that scatters by a quarter from mode to mode, gains 0.5 %, pick-ups 0.5 mm beside their
places, and cells that hear 0.2 % of the other axes. Its base moves along each of six axes in turn, and a little along the
others. Spectra from 5 to 60 Hz without an excitation, 0.1 % of noise, and tilts that the cells feel; the first two modes lie at
the first lines.
"""

import json
from collections.abc import Callable, Mapping, Sequence
from contextlib import nullcontext
from dataclasses import replace
from itertools import pairwise
from pathlib import Path
from typing import Any, cast

import h5py
import numpy as np
import pytest
from scipy.linalg import eigh

from geometry.errors import BadInput
from geometry.frames import Array
from validation.app.whatif import Remembering
from validation.diagnose import search
from validation.diagnose.diagnosis import Candidate
from validation.diagnose.everywhere import MeshSearch
from validation.effects.catalogue import Named
from validation.estimation.problem import EFFECT, FITTED, Fit
from validation.model.model import Added
from validation.prediction.dynamic_mass import SupportedDynamicMass
from validation.study import Study

E, G, RHO, GRAVITY = 70e9, 70e9 / 2.66, 2700.0, 9.81

POINTS = {
    **{f"foot-{k}": (x, y, 0.0) for k, (x, y) in enumerate(((0.15, 0.15), (-0.15, 0.15), (-0.15, -0.15), (0.15, -0.15)))},
    **{f"corner-{k}": (x, y, 0.3) for k, (x, y) in enumerate(((0.15, 0.15), (-0.15, 0.15), (-0.15, -0.15), (0.15, -0.15)))},
    "middle": (0.0, 0.0, 0.3),
    "right": (0.15, 0.0, 0.3),
    "left": (-0.15, 0.0, 0.3),
    "mast-top": (0.0, 0.0, 0.9),
    "right-tip": (0.75, 0.0, 0.3),
    "left-tip": (-0.75, 0.0, 0.3),
}
MEMBERS = {
    "legs": [(f"foot-{k}", f"corner-{k}") for k in range(4)],
    "deck": [
        *(("corner-0", "corner-1"), ("corner-1", "left"), ("left", "corner-2"), ("corner-2", "corner-3"), ("corner-3", "right")),
        *(("right", "corner-0"), ("right", "middle"), ("middle", "left"), *(("middle", f"corner-{k}") for k in range(4))),
    ],
    "mast": [("middle", "mast-top")],
    "booms": [("right", "right-tip"), ("left", "left-tip")],
}
SECTIONS = {  # area, second moments about the two axes across, torsion
    "legs": (8.717920e-5, 3.754154e-9, 3.754154e-9, 7.508308e-9),
    "deck": (4.0e-4, 1.333333e-8, 1.333333e-8, 2.253333e-8),
    "mast": (5.969026e-5, 2.700984e-9, 2.700984e-9, 5.401969e-9),
    "booms": (9.6e-5, 5.12e-10, 1.152e-9, 1.201999e-9),
}
BODIES = {
    "middle": (5.0, (0.02, 0.02, 0.03)),
    "mast-top": (0.8, (0.001, 0.001, 0.001)),
    "right-tip": (0.35, (0.0005, 0.002, 0.002)),
    "left-tip": (0.45, (0.0005, 0.002, 0.002)),
}
UPRIGHT = {part: (1.0, 0.0, 0.0) if part in ("legs", "mast") else (0.0, 0.0, 1.0) for part in MEMBERS}

F = np.array([0.0, 0.0, -0.045])  # the force plane, seen from the feet
AROUND = ((0.2, 0.2), (-0.2, 0.2), (-0.2, -0.2), (0.2, -0.2))
PLATE_MASS, PLATE_HEIGHT, PLATE_MOMENTS = 22.0, 0.022, (0.35, 0.35, 0.69)
RUNS = ("x", "y", "z", "alpha", "beta", "gamma")
ON_ARTICLE = {"tip-x": ("mast-top", 0), "tip-y": ("mast-top", 1), "boom-z": ("right-tip", 2), "boom-2-z": ("left-tip", 2)}


def element(start: Array, end: Array, part: str) -> tuple[Array, Array]:
    """(12, 12) stiffness and mass of one of Euler's beams."""
    area, in_plane, across, torsion = SECTIONS[part]
    length = float(np.linalg.norm(end - start))
    x = (end - start) / length
    y = np.array(UPRIGHT[part]) - x * (x @ np.array(UPRIGHT[part]))
    y /= np.linalg.norm(y)
    T = np.kron(np.eye(4), np.array([x, y, np.cross(x, y)]))
    K, M, bar, heavy = np.zeros((12, 12)), np.zeros((12, 12)), np.array([[1, -1], [-1, 1]]), np.array([[2, 1], [1, 2]]) / 6
    K[np.ix_([0, 6], [0, 6])], M[np.ix_([0, 6], [0, 6])] = E * area / length * bar, RHO * area * length * heavy
    K[np.ix_([3, 9], [3, 9])] = G * torsion / length * bar
    M[np.ix_([3, 9], [3, 9])] = RHO * (in_plane + across) * length * heavy
    k = np.array([[12, 6, -12, 6], [6, 4, -6, 2], [-12, -6, 12, -6], [6, 2, -6, 4]]) / length**3
    m = np.array([[156, 22, 54, -13], [22, 4, 13, -3], [54, 13, 156, -22], [-13, -3, -22, 4]]) / 420
    for along, sign, moment in (([1, 5, 7, 11], 1.0, in_plane), ([2, 4, 8, 10], -1.0, across)):
        L = np.diag([1.0, sign * length, 1.0, sign * length])
        K[np.ix_(along, along)] += E * moment * L @ k @ L
        M[np.ix_(along, along)] += RHO * area * length * L @ m @ L
    return T.T @ K @ T, T.T @ M @ T


def meshed(count: int) -> tuple[Array, dict[str, int], list[tuple[str, int, int]]]:
    """Points (p, 3) [m], those with a name among them, and beams, `count` a member."""
    number, points, beams = {name: k for k, name in enumerate(POINTS)}, [np.array(one) for one in POINTS.values()], []
    for part, members in MEMBERS.items():
        for a, b in members:
            inner = list(range(len(points), len(points) + count - 1))
            points += [points[number[a]] + (points[number[b]] - points[number[a]]) * k / count for k in range(1, count)]
            chain = [number[a], *inner, number[b]]
            beams += [(part, i, j) for i, j in pairwise(chain)]
    return np.array(points), number, beams


def deck() -> str:
    """What the analyst has: two beams a member, in bulk data."""
    points, number, beams = meshed(2)
    parts = list(MEMBERS)
    lines = [f"GRID,{k + 1},,{x:.5f},{y:.5f},{z:.5f}" for k, (x, y, z) in enumerate(points)]
    lines.append(f"MAT1,1,{E:.4e},,0.33,{RHO}")
    for k, part in enumerate(parts, start=1):
        lines += [f"$ Femap Property {k} : {part}", f"PBAR,{k},1,{','.join(f'{one:.6E}' for one in SECTIONS[part])}"]
    for k, (part, i, j) in enumerate(beams, start=1):
        lines.append(f"CBAR,{k},{parts.index(part) + 1},{i + 1},{j + 1},{','.join(map(str, UPRIGHT[part]))}")
    for k, (name, (mass, moments)) in enumerate(BODIES.items(), start=901):
        lines += [f"CONM2,{k},{number[name] + 1},,{mass}", f",{moments[0]},,{moments[1]},,,{moments[2]}"]
    return "\n".join([*lines, "SPC1,1,123456,1,2,3,4", "ENDDATA"]) + "\n"


def turned(arm: Array) -> Array:
    return np.array([[0, -arm[2], arm[1]], [arm[2], 0, -arm[0]], [-arm[1], arm[0], 0]])


def answered(
    rng: np.random.Generator,
    omega: Array,
    softer: Mapping[str, float],
    heavier: Mapping[str, float],
    beside: Mapping[tuple[float, float, float], float],
) -> tuple[Array, dict[str, tuple[Array, Array]]]:
    """(n, 6, 6) dynamic mass about F, and of each pick-up on the article how it rides (6,) and what bends adds (n, 6)."""
    points, number, beams = meshed(6)
    stiff = {part: (1 + rng.normal(0, 0.02)) * (1 + softer.get(part, 0.0)) for part in MEMBERS}
    dense = {part: 1 + rng.normal(0, 0.005) for part in MEMBERS}
    K, M = np.zeros((6 * len(points), 6 * len(points))), np.zeros((6 * len(points), 6 * len(points)))
    for part, i, j in beams:
        own = np.r_[6 * i : 6 * i + 6, 6 * j : 6 * j + 6]
        k, m = element(points[i], points[j], part)
        K[np.ix_(own, own)] += stiff[part] * k
        M[np.ix_(own, own)] += dense[part] * m
    for name, (mass, moments) in BODIES.items():
        own = 6 * number[name] + np.arange(6)
        M[own, own] += [*3 * [mass + heavier.get(name, 0.0)], *moments]
    for at, mass in beside.items():  # at the node that is nearest
        own = 6 * int(np.argmin(np.linalg.norm(points - at, axis=1))) + np.arange(3)
        M[own, own] += mass
    R = np.vstack([np.block([[np.eye(3), -turned(one - F)], [np.zeros((3, 3)), np.eye(3)]]) for one in points])
    free = np.arange(24, len(K))  # the feet are the first four points
    squares, shapes = eigh(K[np.ix_(free, free)], M[np.ix_(free, free)], subset_by_index=(0, 39))
    participation, own = shapes.T @ (M[free] @ R), np.sqrt(squares)
    damping = 0.006 * np.exp(rng.normal(0, 0.25, len(own)))
    answer = omega[:, None] ** 2 / (squares - omega[:, None] ** 2 + 2j * damping * own * omega[:, None])
    H = R.T @ M @ R + np.einsum("fm,mi,mj->fij", answer, participation, participation)
    read = {}
    for name, (at, axis) in ON_ARTICLE.items():
        row = 6 * number[at] + axis
        read[name] = R[row], np.einsum("fm,m,mj->fj", answer, shapes[row - 24], participation)
    return H, read


def campaign(folder: Path, seed: int, *, stands: bool = True, wrong: Mapping[str, float] | None = None, **fault: Any) -> None:
    """Six runs of the empty plate or of the satellite on it; `wrong` channels are multiplied."""
    rng, hardware, f = np.random.default_rng(seed), np.random.default_rng(4711), np.arange(5, 60.001, 0.1)
    omega, c = 2 * np.pi * f, turned(np.array([0.0, 0.0, PLATE_HEIGHT]))
    plate = np.block([[PLATE_MASS * np.eye(3), -PLATE_MASS * c], [PLATE_MASS * c, np.diag(PLATE_MOMENTS) - PLATE_MASS * c @ c]])
    H, upon = np.broadcast_to(plate, (len(f), 6, 6)).astype(complex), dict[str, tuple[Array, Array]]()
    if stands:
        bends, upon = answered(rng, omega, *(fault.get(one, {}) for one in ("softer", "heavier", "beside")))
        H = H + bends
    channels: list[tuple[str, str, str, Sequence[float], int]] = [
        *((f"plate-z{k + 1}", "acceleration", "cover", (x, y, 0.04), 2) for k, (x, y) in enumerate(AROUND)),
        *((f"plate-x{k + 1}", "acceleration", "cover", (*AROUND[one], 0.04), 0) for k, one in enumerate((0, 3))),
        *((f"plate-y{k + 1}", "acceleration", "cover", (*AROUND[one], 0.04), 1) for k, one in enumerate((0, 1))),
        *((f"cell-{'xyz'[d]}{k + 1}", "force", "fmd", (x, y, 0.0), d) for k, (x, y) in enumerate(AROUND) for d in range(3)),
        *((name, "acceleration", "article", np.subtract(POINTS[at], F), axis) for name, (at, axis) in ON_ARTICLE.items()),
    ]
    gain = {one[0]: (1 + hardware.normal(0, 0.0045)) * (wrong or {}).get(one[0], 1.0) for one in channels}
    beside = {one[0]: hardware.normal(0, 0.0005, 3) for one in channels}
    across = hardware.normal(0, 0.002, (4, 3, 3)) * (1 - np.eye(3))
    channels = [one for one in channels if stands or one[2] != "article"]
    ways = np.vstack([np.hstack([np.eye(3), -turned(np.array([x, y, 0.0]))]) for x, y in AROUND])
    springs = np.diag(np.tile([8e8, 8e8, 2e9], 4))
    shared = springs @ ways @ np.linalg.inv(ways.T @ springs @ ways)
    folder.mkdir(parents=True)
    said = [
        f'format = 1\n[campaign]\ntitle = "a satellite"\narticle = "{"fmd+satellite" if stands else "fmd"}"\nhardware = "plate-7"'
    ]
    said += ["[mounting]\norigin = [0.0, 0.0, 0.045]"] if stands else []
    said += ["[environment]\ngravity = 9.81"]
    for name, quantity, group, at, axis in channels:
        unit = "N" if quantity == "force" else "m/s^2"
        head = f'name = "{name}"\nquantity = "{quantity}"\nunit = "{unit}"\ngroup = "{group}"\n'
        kinematic = "" if quantity == "force" else "\nsenses_gravity = false"
        where = f"position = {np.round(at, 6).tolist()}\ndirection = {np.eye(3)[axis].tolist()}"
        said.append(f"[[channel]]\n{head}{where}{kinematic}")
    for k, run in enumerate(RUNS):
        moved = np.zeros((len(f), 6), dtype=complex)
        moved[:, k] = 2.0 if k < 3 else 6.0
        cross = (rng.normal(0, 0.06, 6) + 1j * rng.normal(0, 0.06, 6)) * [1, 1, 1, 2.5, 2.5, 2.5]
        moved += cross * (1 + 0.3 * np.sin(2 * np.pi * f / rng.uniform(8, 25)))[:, None]
        tilt = -moved[:, 3:] / omega[:, None] ** 2
        felt = moved + GRAVITY * np.column_stack(
            [-tilt[:, 1], tilt[:, 0], *4 * [0 * f]]
        )  # cells feel the weight that a tilt turns
        force = np.einsum("fij,fj->fi", H, felt) @ shared.T
        read = {name: moved @ ride + np.einsum("fj,fj->f", bent, felt) for name, (ride, bent) in upon.items()}
        with h5py.File(folder / f"{run}.h5", "w") as file:
            file["frequency"] = f
            for name, quantity, _, at, axis in channels:
                if quantity == "force":
                    cell = int(name[-1]) - 1
                    own = force[:, 3 * cell : 3 * cell + 3]
                    signal, floor = own[:, axis] + own @ across[cell, axis], 0.02
                else:
                    place = np.asarray(at) + beside[name]
                    signal, floor = read.get(name, (moved[:, :3] + np.cross(moved[:, 3:], place))[:, axis]), 0.002
                noise = rng.standard_normal((2, 2, len(f)))
                made = gain[name] * signal * (1 + 1e-3 * (noise[0, 0] + 1j * noise[0, 1])) + floor * (
                    noise[1, 0] + 1j * noise[1, 1]
                )
                file[f"channels/{name}"] = made
        said.append(f'[[run]]\nname = "{run}"\nfile = "{run}.h5"\naxis = "{run}"')
    (folder / "campaign.toml").write_text("\n\n".join(said) + "\n")


STUDY = """format = 1
model = { title = "a satellite on its plate", article = "fmd+satellite" }
tolerances = { class = "calibrated" }
structure = { own = { "fmd+satellite" = "satellite.toml" } }

[laboratory]
cell_stiffness_N_m = [8e8, 8e8, 2e9]
fmd = { mass_kg = 22.0, cog_mm = [0.0, 0.0, 22.0], moi_cog_kgm2 = [0.35, 0.35, 0.69], tolerance = 0.01 }
"""


@pytest.fixture
def study(tmp_path: Path, run: Callable[..., Any]) -> Path:
    """A deck that `massline model` described, on a base; a study by hand; the empty plate. Nobody states what it loses."""
    folder = tmp_path / "satellite"
    folder.mkdir()
    (folder / "satellite.bdf").write_text(deck())
    told = run("model", str(folder / "satellite.bdf"), "--out", str(folder / "satellite.toml"))
    assert told[0] == 0, told
    described = (folder / "satellite.toml").read_text()
    assert 'support = "ground"' in described
    (folder / "satellite.toml").write_text(described.replace('support = "ground"', 'support = "base"'))
    (folder / "study.toml").write_text(STUDY)
    campaign(folder / "tare", 1, stands=False)
    return folder


def found(study: Path, run: Callable[..., Any], name: str, **of: Any) -> dict[str, Any]:
    campaign(study / name, **of)
    assert "exchanged" not in run("check", str(study / name))[1]
    tare = [] if of.get("wrong") else [str(study / "tare")]
    code, out, err = run("diagnose", str(study / "study.toml"), *tare, str(study / name), "--json")
    assert code == 0, err
    return dict(json.loads(out))


@pytest.mark.proof  # a minute and more
def test_a_sound_satellite_comes_out_as_sound(study: Path, run: Callable[..., Any]) -> None:
    """It was "unknown": an assumed loss counted as known, and modes of 50 Hz as certain."""
    answer = found(study, run, "sound", seed=2)
    assert answer["verdict"] == "nothing"


MIDDLE = "@0.45,0,0.3"
"""Of the right boom: a node, but neither a place with a name nor a sensor's."""

OTHERS = {"joint-compliance:rotation": 2e-6, "cable:@0.75,0,0.3:x": 300.0, "force-gain:cell-z2": 0.05}


def added(name: str, size: float, *, fixed: bool = True) -> Added:
    family, *targets = name.split(":")
    return Added(named=Named(family=family, targets=tuple(targets), values={"": size}), fixed=fixed)


def standing(of: Study) -> Candidate:
    """The model as it is, no tolerance fitted."""
    free = of.problem().free(FITTED)
    some = dict.fromkeys(("chi2", "tolerance_z2", "log_evidence", "cost"), 0.0)
    nothing = Fit(
        parameters=free,
        offsets=np.zeros(len(free)),
        covariance=np.diag([one.tolerance**2 for one in free]),
        degrees_of_freedom=1,
        tolerances=0,
        converged=True,
        **some,
    )
    return Candidate(effects=(), fit=nothing, problem=of.problem())


@pytest.mark.parametrize(
    "beside", [pytest.param({}, id="alone", marks=pytest.mark.proof), pytest.param(OTHERS, id="with others")]
)
@pytest.mark.parametrize(
    ("name", "size"), [(f"point-mass:{MIDDLE}", 0.05), pytest.param(f"cable:{MIDDLE}:z", 2e3, marks=pytest.mark.proof)]
)
def test_one_solution_says_of_a_node_what_is_read_with_an_effect_there_on_a_base_that_moves(
    study: Path, beside: Mapping[str, float], name: str, size: float
) -> None:
    campaign(study / "sound", 2)
    of = Study.open(study / "study.toml", [study / "sound"])
    others = [added(*one) for one in beside.items()]
    (known,), (ready,) = of.made, of.ready_at([MIDDLE]).made
    assert known.structure is not None
    assert known.structure.reduced is not None
    lines, whole = np.arange(0, len(known.measured.frequency), 11), known.structure.reduced
    points, moved = whole.nodes()
    row = whole.basis[moved[np.argmin(np.linalg.norm(points - [0.45, 0.0, 0.3], axis=1))]]
    driven = np.random.default_rng(0).standard_normal((6, len(lines), 6, 2)) @ [1, 1j]

    def read(*more: Added) -> Array:
        return np.asarray(ready.with_effects((*others, *more)).at({}, lines, derivatives=False).rows)

    step, spring = 1e-4 * size, name.startswith("cable")
    slope = np.einsum("ncj,rnj->rnc", (read(added(name, step)) - read()) / step, driven)
    one = known.with_effects(others)
    made = one.attached({}, lines, row[None], driven)
    found = made.readings[..., 0, 2] * made.spring[..., None] if spring else made.readings[..., 0, :].sum(axis=-1)
    assert np.abs(found - slope).max() < 3e-3 * np.abs(slope).max()  # the node has no static answer of its own in `known`
    along = np.array([0.0, 0.0, 1.0])
    far = one.finite({}, lines)(row)(*((0 * along, size * along) if spring else (np.full(3, size), 0 * along)))
    whole_answer = read(added(name, size))
    assert np.abs(far - whole_answer).max() < 1e-3 * np.abs(whole_answer - read()).max()


def test_an_effect_is_as_plausible_in_all_data_sets_of_a_structure_whatever_their_bands(study: Path) -> None:
    """Of two bands one told it by more modes than the other, and a diagnosis of both ended in a ValueError."""
    for name in ("wide", "low"):
        campaign(study / name, 2)
    file, driven = study / "low" / "campaign.toml", 'excitation = { kind = "sine-sweep", start_hz = 5.0, stop_hz = 30.0 }'
    file.write_text(file.read_text().replace("[[run]]", f"[[run]]\n{driven}"))
    places = (MIDDLE, "@0.15,0.15,0")  # the second rides with the base
    of = Study.open(study / "study.toml", [study / "wide", study / "low"]).ready_at(places)
    (search,) = MeshSearch.of(standing(of))
    for place in places:
        point = [float(one) for one in place[1:].split(",")]
        node = int(np.argmin(np.linalg.norm(search.points - point, axis=1)))
        at_node = search.plausible(search.at(np.array([node])))
        for kind, found in at_node.items():
            family, *along = kind.split(":")
            problem = of.problem((added(":".join((family, place, *along)), 0.0, fixed=False),))
            (named,) = [one.tolerance for one in problem.parameters if one.kind == EFFECT]
            assert named == pytest.approx(found[0], rel=1e-4)


def test_a_place_that_one_of_two_articles_has_is_no_mistake_of_the_other(study: Path) -> None:
    """The other was refused, so that neither a diagnosis of both nor a model with the effect in it could go on."""
    for end in ("bdf", "toml"):  # on shorter booms
        text = (study / f"satellite.{end}").read_text()
        (study / f"small.{end}").write_text(
            text.replace("0.75000", "0.50000").replace("0.37500", "0.25000").replace("satellite", "small")
        )
    campaign(study / "one", 2)
    campaign(study / "other", 3)
    file, model, tip, nowhere = study / "other" / "campaign.toml", study / "study.toml", "@0.75,0,0.3", "@2,0,0"
    file.write_text(file.read_text().replace("fmd+satellite", "fmd+small").replace("0.75,", "0.5,"))
    own = '"fmd+satellite" = "satellite.toml"'
    model.write_text(model.read_text().replace(own, f'{own}, "fmd+small" = "small.toml"'))
    of = Study.open(model, [study / "one", study / "other"])
    for anew in (True, False):
        places = [one.there.places for one in of.ready_at([tip, MIDDLE], anew=anew).made]
        assert [MIDDLE in one for one in places] == [True, True]
        assert [tip in one.structure.nominal.places for one in of.ready_at([tip], anew=anew).made if one.structure] == [
            True,
            False,
        ]
        with pytest.raises(BadInput, match="outside the mesh"):
            of.ready_at([nowhere], anew=anew)
    for place in (tip, nowhere):
        effect = f'[[effect]]\nid = "point-mass:{place}"\nvalue = 0.1\n'
        (study / "with.toml").write_text(f"{model.read_text()}\n{effect}")
        with pytest.raises(BadInput, match="outside the mesh") if place == nowhere else nullcontext():
            Study.open(study / "with.toml", [study / "one", study / "other"])


def test_a_slider_of_the_workbench_reads_accelerometers_on_the_article_too(study: Path) -> None:
    campaign(study / "sound", 2)
    (one,) = Study.open(study / "study.toml", [study / "sound"]).made
    carried = cast(SupportedDynamicMass, Remembering(one.tested.carried))
    remembers, lines = replace(one, tested=replace(one.tested, carried=carried)), np.arange(9)
    rows = one.at({}, lines, derivatives=False).rows
    for _ in range(2):
        np.testing.assert_array_equal(remembers.at({}, lines, derivatives=False).rows, rows)


@pytest.mark.proof  # a fit; test_part_nearly_gone.py and test_clamps.py are such large changes of a whole structure
def test_a_mast_three_times_as_stiff_is_held_against_the_whole_structure_on_a_base_too(
    study: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    """Coordinates that were made for parts of half their stiffness were believed at any size, where a base drives."""
    campaign(study / "sound", 2)
    of = Study.open(study / "study.toml", [study / "sound"])
    at = replace(standing(of), effects=(added("modulus:mast", 2.0),))
    monkeypatch.setattr(search, "over", lambda ready, data, at: at)
    anew, _ = search.reduced_anew(of, at)
    assert search.reduction_error(of, at)[1] > 100 * search.TOLD
    assert search.reduction_error(anew, at)[1] < search.TOLD
    assert any("is not the last word" in one or "are not the last word" in one for one in search.left_of_reduction(of, at))


@pytest.mark.proof  # some minutes
def test_a_mass_where_nobody_has_named_anything_is_found_on_the_mesh(study: Path, run: Callable[..., Any]) -> None:
    """It was "unknown", with 33 g at the other boom's tip, and then came with a resonator of a gram, since modes had turned."""
    answer = found(study, run, "boom", seed=21, beside={(0.45, 0.0, 0.3): 0.06})
    (one,) = answer["accepted"]
    assert (one["id"], one["value"]) == (f"point-mass:{MIDDLE}", pytest.approx(0.06, abs=0.004))


@pytest.mark.proof  # two minutes
def test_a_heavier_body_is_that_body_or_a_mass_where_its_accelerometer_sits(study: Path, run: Callable[..., Any]) -> None:
    """Data do not tell 80 g more of a body from 80 g at its middle; it had been "unknown", since neither had a name."""
    answer = found(study, run, "heavy", seed=4, heavier={"mast-top": 0.08})
    assert answer["verdict"] in ("missing", "ambiguous")
    sizes = {one["id"]: one["value"] for one in answer["ranking"][:2]}
    assert sizes == {"point-mass:@0,0,0.9": pytest.approx(0.08, abs=0.004), "mass:CONM2 902": pytest.approx(0.1, abs=0.005)}


@pytest.mark.proof  # each a minute or two
@pytest.mark.parametrize(
    ("name", "of", "expected", "size"),
    [
        ("soft", {"seed": 6, "softer": {"mast": -0.15}}, "modulus:mast", -0.1934),
        ("gain", {"seed": 8, "wrong": {"cell-z2": 1.06}}, "force-gain:cell-z2", 0.06),
        ("sign", {"seed": 9, "wrong": {"tip-y": -1.0}}, "polarity:tip-y", 0.0),
    ],
)
def test_what_was_hidden_in_it_is_named_alone_with_its_size(
    study: Path, run: Callable[..., Any], name: str, of: dict[str, Any], expected: str, size: float
) -> None:
    """Sizes are the truth, but for the gain that the cell has anyway."""
    (one,) = found(study, run, name, **of)["accepted"]
    assert one["id"] == expected
    if size:
        assert one["value"] == pytest.approx(size, abs=0.012)
