"""A second simulator, which shares no sensor model and no equation of motion with the virtual test, beside the prediction."""

from dataclasses import fields, replace

import numpy as np
import pytest

from benchmarks.laboratories import shaking
from benchmarks.laboratories.drawing import SHEETS, DataSheet
from validation.diagnose.diagnose import diagnosed
from validation.diagnose.diagnosis import NOTHING
from validation.effects.catalogue import parse
from validation.effects.effect import evidence_threshold
from validation.estimation.fit import unfitted
from validation.estimation.problem import FITTED, Problem
from validation.estimation.screening import MadeUp, screened
from validation.model import model_file
from validation.model.model import Added
from validation.prediction.series import predictions
from validation.study import Data, Study

EXACT = DataSheet(**{one.name: 0.0 for one in fields(DataSheet)} | {"cross": 0.03})
CUBOID = "fmd+disc+cuboid"
OPEN = {"cell-crosstalk": 0.02, "force-plane-offset": 1e-3, "accelerometer-highpass": 0.05, "force-highpass": 0.05}

LEFT = {"exact": 5e-4, "drawn": 2e-3}
"""Of the largest that a channel reads: what is left of loss factors, which damp otherwise there, and of records that end."""


QUICK = shaking.Bench(pace=16.0, acceleration=1e-9, force=1e-9)


def left(
    sheet: DataSheet,
    offsets: dict[str, float],
    *,
    article: str = CUBOID,
    planted: dict[str, tuple[float, ...]] | None = None,
    known: tuple[str, ...] = (),
) -> float:
    """Largest rms over rms of what a channel reads that the prediction at `offsets` leaves, base motions eliminated."""
    with pytest.MonkeyPatch.context() as patched:
        patched.setattr(shaking, "SHEETS", {**SHEETS, "asked": sheet})
        campaigns = shaking.series(3, [article], "asked", shaking.Faults(sizes=planted or {}), QUICK)
    model = replace(model_file.of_text(f'format = 1\n[model]\narticle = "{article}"\n', "m.toml"), opened=OPEN)
    effects = tuple(Added(named=parse(one), fixed=True) for one in known)
    model = replace(model, cell_stiffness=np.array(QUICK.stiffness), effects=effects)
    (of,) = Problem(predictions(model, campaigns, lines=[5.0, 9.5, 14.0, 21.0, 29.0])).predictions
    A, worst = of.at(offsets, derivatives=False).rows, 0.0
    for y in of.measured.values:
        scale = np.abs(y).max(axis=0)
        u = np.linalg.pinv(A / scale[:, None]) @ (y / scale)[..., None]
        worst = max(worst, float(np.max(np.abs(y - (A @ u)[..., 0]) / scale)))
    return worst


def test_an_exact_laboratory_reads_what_is_predicted():
    assert left(EXACT, {}) < LEFT["exact"]


def test_cross_talk_inside_cells_plane_and_high_pass_are_those_of_the_chain():
    """Drawn there and told to the prediction by the names of its parameters; without them ten times as much is left."""
    sheet = replace(EXACT, other=0.02, own=0.01, plane=1e-3, corner=0.05)
    directions = {c.name: np.array(c.places[0].direction) for c in shaking.mavis(np.zeros((4, 3)), {}).table.channels}
    made = shaking.hardware(sheet, directions, np.random.default_rng([3, 0]))
    known = {
        f"cell-crosstalk:{cell + 1}{'xyz'[to]}{'xyz'[of]}": float(made.cells[cell, to, of] - (to == of))
        for cell in range(4)
        for to in range(3)
        for of in range(3)
    }
    known |= {f"{'force' if 'fmd' in name else 'accelerometer'}-highpass:{name}": hz for name, hz in made.corner.items()}
    # A plane that lies higher than stated takes h F_x from M_y and gives h F_y to M_x
    known |= {f"force-plane-offset:{axis}": float(h) for axis, h in zip("xy", made.plane, strict=True)}
    assert left(sheet, known) < LEFT["drawn"]
    assert left(sheet, {}) > 5 * LEFT["drawn"]


AS_PLANTED = (
    ("point-mass:top=0.3", (0.3,)),
    ("slosh:disc=m:0.3,f:9.5,zeta:0.03", (0.3, 9.5, 0.03)),
    ("appendage:x=m:0.3,f:12,zeta:0.03", (0.3, 12.0, 0.03)),
    ("rigid-inertia:mx=0.3", (0.3,)),
    ("joint-compliance:rotation=1e-6", (1e-6,)),
    ("mounting-offset:x=0.004", (0.004,)),
    ("load-path-shunt:z=0.05", (0.05,)),
    ("force-crosstalk:zx=0.02", (0.02,)),
    ("cell-stiffness:1x=0.3", (0.3,)),
    ("accelerometer-misalignment:cover-z3:x=0.02", (0.02,)),
    ("force-highpass:fmd-z2=0.3", (0.3,)),
)


@pytest.mark.parametrize(("effect", "size"), AS_PLANTED[::6])
def test_what_is_planted_is_what_the_catalogue_calls_so(effect, size):
    """Two simulators with equations of their own agree about it to a thousandth, and without it they do not."""
    planted = {effect.partition("=")[0]: size}
    assert left(EXACT, {}, planted=planted, known=(effect,)) < left(EXACT, {}, planted=planted) / 1000


@pytest.mark.proof
@pytest.mark.parametrize(("effect", "size"), AS_PLANTED)
def test_all_that_is_planted_is_what_the_catalogue_calls_so(effect, size):
    test_what_is_planted_is_what_the_catalogue_calls_so(effect, size)


def test_a_loss_of_a_layer_is_named_from_where_the_layer_is_known():
    """Four blades tell how much each mode loses to a thousandth of this; what hides 0.1 is what else it may be."""
    from benchmarks.laboratories.__main__ import analyst

    campaigns = shaking.series(3, ["fmd+clumod-4"], "calibrated", bench=replace(QUICK, pace=8.0))
    named = parse("layer-damping:upper-short=0.1")

    def named_from(known: str) -> float:
        """The smallest that is named, by the Fisher matrix of the drawing and by how losses multiply."""
        kind = f'structure = {{ kind = "beam", tolerances = {{ {known} }} }}'
        text = analyst("calibrated", "fmd+clumod-4", QUICK).replace('structure = { kind = "beam" }', kind)
        study = Study.of(model_file.of_text(text, "m.toml"), Data(campaigns=campaigns))
        with_it = study.problem((Added(named=replace(named, values={"": 0.0})),))
        columns = screened(with_it, unfitted(study.problem(), FITTED, {}), [named.id], by_line=False)
        told = MadeUp.of(columns, columns.shaped(named.id))
        return told.detectable(named.sizes[0].plausible, evidence_threshold(named.family))

    assert named_from("") == pytest.approx(0.87, rel=0.1)
    assert named_from("damping = 0.05, mode_damping = 0.1") == pytest.approx(0.126, rel=0.1)
    assert named_from("damping = 0.05") > 0.3


def test_a_draw_is_the_same_every_time_and_plants_what_its_null_could_have_named():
    from itertools import islice

    from benchmarks.laboratories.cases import FAULTS, FOREIGN, draw

    cases, again = (list(islice(draw(5), 60)) for _ in range(2))
    assert [(one.laboratory, dict(one.multiples), one.bench.pace) for one in cases] == [
        (one.laboratory, dict(one.multiples), one.bench.pace) for one in again
    ]
    families = {id.partition(":")[0] for one in cases for id in one.multiples}
    assert families == set(FAULTS) | (families & set(FOREIGN))
    single = next(one for one in cases if one.kind == "single" and "slosh" in str(one.multiples))
    ((id, times),) = single.multiples.items()
    faults = single.faults({id: 0.01})
    assert faults is not None
    assert faults.sizes == {id: (pytest.approx(0.01 * times), *single.resonance)}
    assert single.faults({}) is None


def test_scores_count_first_class_and_wrong_with_exact_intervals():
    from benchmarks.laboratories.__main__ import hit, scored

    line = {
        "kind": "single",
        "sheet": "calibrated",
        "articles": [CUBOID],
        "verdict": "ambiguous",
        "multiples": {"point-mass:top": 2.0},
    }
    line |= {"planted": {"point-mass:top": [0.2]}, "class": ["point-mass:disc", "point-mass:top"]}
    near = line | {"named": {"point-mass:disc": {"": [0.21, 0.15, 0.25]}}}
    told = dict.fromkeys(hit(near), False) | {"class": True}
    assert hit(near) == told
    behind = near | {"ranking": [["point-mass:disc", 30.0], ["point-mass:top", 29.1], ["cable:top:vertical", 28.0]]}
    assert hit(behind) == told | {"first or not more than 1 nat behind": True}
    tied = near | {"same": {"point-mass:disc": ["point-mass:top"]}}
    assert hit(tied) == told | {"first or one name with it": True, "first or not more than 1 nat behind": True}
    right = line | {"named": {"point-mass:top": {"": [0.21, 0.15, 0.25]}}, "class": []}
    wrong = right | {"named": {"modulus:mast": {"": [0.1, 0.05, 0.15]}}}
    assert hit(right) == dict.fromkeys(told, True) | {"wrong": False}
    assert hit(wrong) == dict.fromkeys(told, False) | {"wrong": True}
    rows = dict(scored([near, right, wrong, line | {"kind": "null", "verdict": "nothing", "planted": {}, "named": {}}]))
    assert rows["singles at 2 times: class"].startswith("2 of 3, 66.7 % (9.4 to 99.2)")
    assert rows["nulls of calibrated quiet"].startswith("1 of 1")
    assert rows["- of disc+cuboid"].startswith("1 of 1")
    assert rows["- of others"].startswith("1 of 1")
    assert rows["sizes, median error"] == "5.0 %"


@pytest.mark.proof
@pytest.mark.parametrize("sheet", list(SHEETS))
def test_a_sound_laboratory_is_sound_by_its_own_class(sheet):
    from benchmarks.laboratories.__main__ import ARTICLES, analyst

    model = model_file.of_text(analyst(sheet), "drawn.toml")
    found = diagnosed(Study.of(model, Data(campaigns=shaking.series(1, ARTICLES, sheet))))
    assert found.verdict == NOTHING, found.text


@pytest.mark.proof
def test_an_absorber_beside_the_own_mode_of_the_tip_that_carries_it_is_named():
    """4.5 g tuned to 12.0 Hz on a mode at 11.6 Hz drive the plain fit twenty tolerances off; case 1 of draw 964142667."""
    from itertools import islice

    from benchmarks.laboratories.__main__ import asked
    from benchmarks.laboratories.cases import draw

    (case,) = islice(draw(964142667), 1, 2)
    ((id, _),) = case.multiples.items()
    line, _ = asked(case, shaking.Faults(sizes={id: (0.0045, *case.resonance)}))
    assert (line["verdict"], list(line["named"])) == ("missing", [id])
    for planted, (_, low, high) in zip((0.0045, *case.resonance), line["named"][id].values(), strict=True):
        assert low < planted < high


@pytest.mark.proof
def test_the_example_series_is_sound(data, root):
    paths = [data / "example_series" / name for name in (CUBOID, "fmd+clumod-1")]
    found = diagnosed(Study.open(root / "examples" / "example_series.toml", paths))
    assert found.verdict == NOTHING, found.text
