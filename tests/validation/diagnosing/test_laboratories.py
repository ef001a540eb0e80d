"""A second simulator, which shares no sensor model and no equation of motion with the virtual test, beside the prediction."""

from dataclasses import fields, replace

import numpy as np
import pytest

from benchmarks.laboratories import shaking
from benchmarks.laboratories.drawing import SHEETS, DataSheet
from validation.diagnose.diagnose import diagnosed
from validation.diagnose.diagnosis import NOTHING
from validation.effects.catalogue import parse
from validation.estimation.problem import Problem
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


@pytest.mark.proof
@pytest.mark.parametrize("sheet", list(SHEETS))
def test_a_sound_laboratory_is_sound_by_its_own_class(sheet):
    from benchmarks.laboratories.__main__ import ARTICLES, analyst

    model = model_file.of_text(analyst(sheet), "drawn.toml")
    found = diagnosed(Study.of(model, Data(campaigns=shaking.series(1, ARTICLES, sheet))))
    assert found.verdict == NOTHING, found.text


@pytest.mark.proof
def test_the_example_series_is_sound(data, root):
    paths = [data / "example_series" / name for name in (CUBOID, "fmd+clumod-1")]
    found = diagnosed(Study.open(root / "examples" / "example_series.toml", paths))
    assert found.verdict == NOTHING, found.text
