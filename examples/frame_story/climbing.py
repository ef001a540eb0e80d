"""Models of the frame, each fitted and judged: what is added, the errors, and where they lie."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from itertools import pairwise
from pathlib import Path

import numpy as np

from frame_story.structure import FLOORS
from validation.effects import catalogue
from validation.effects.catalogue import parse
from validation.effects.effect import Vocabulary
from validation.estimation import evaluate as estimation_evaluate
from validation.estimation.evaluate import evaluate
from validation.estimation.problem import Evaluation, Offsets, Problem
from validation.model.model import Added
from validation.output import counted
from validation.prediction.response_functions import ResponseFunctionTest

NOMINAL = "nominal"

BETWEEN = (3.0, 5.0, 9.0, 15.0, 22.0, 30.0, 60.0, 90.0)
IN_WORDS = ("noise", "first mode", "between", "second mode", "third mode", "above", "mass line")
"""[Hz] Bands in which errors are told, and what lies there."""

PROMINENT, ABOVE = 10.0, 27.0
"""How far [dB] a resonance that no model has must stand out, and above which frequency [Hz] such are sought."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Rung:
    """One model.

    Attributes
    ----------
    model : of the test, its effects in it
    parent : name of the model it grows from, its own for the nominal one
    evaluation : its errors and fits
    """

    model: ResponseFunctionTest
    parent: str
    evaluation: Evaluation

    @property
    def offsets(self) -> Offsets:
        """Where the plain fit ended."""
        return {**Problem((self.model,)).start, **self.evaluation.plain_fit.by_name}

    @property
    def sizes(self) -> dict[str, float]:
        """Sizes of the effects after the plain fit, by name, in the units of the catalogue."""
        fit = self.evaluation.plain_fit
        return {one.name: one.value(x) for one, x in zip(fit.parameters, fit.offsets, strict=True) if one.kind == "effect"}

    @property
    def held_out(self) -> float:
        """[%] Error on drive points that were not fitted."""
        found = self.evaluation.held_out
        return found.percent if found else np.nan

    @property
    def misfit(self) -> float:
        """chi² a degree of freedom with all tolerances free; 1 where the model and its tolerances explain the readings."""
        return self.evaluation.fitted.chi2 / self.evaluation.fitted.degrees_of_freedom


def effects(texts: Sequence[str]) -> tuple[Added, ...]:
    """Effects as they are typed, those of `examples/frame_effects` among them."""
    catalogue.load(Path(__file__).parents[1] / "frame_effects")
    words = Vocabulary(accelerometers=FLOORS, forces=("force",), places=FLOORS, parts=("legs",))
    return tuple(Added(named=parse(text, words)) for text in texts)


def climbed(
    test: ResponseFunctionTest, models: Mapping[str, Sequence[str]], grown: Mapping[str, str], *, quiet: bool = False
) -> dict[str, Rung]:
    """Every one of `models`, by the effects in it, evaluated with each drive point held out in turn.

    `grown` names the model that has all effects of the one before it; all others grow from the nominal one, which comes first.
    """
    found: dict[str, Rung] = {}
    for name in counted(models, "Fitting", quiet=quiet):
        model, parent = test.with_effects(effects(models[name])), grown.get(name, NOMINAL)
        before = found[parent].evaluation if parent in found else None
        found[name] = Rung(model=model, parent=parent, evaluation=evaluate(Problem((model,)), parent=before))
    return found


def gain(rungs: Mapping[str, Rung], name: str, over: str = NOMINAL) -> float:
    """Evidence [nats] for `name` over another model."""
    return rungs[name].evaluation.fitted.log_evidence - rungs[over].evaluation.fitted.log_evidence


def where(model: ResponseFunctionTest, offsets: Offsets) -> list[float]:
    """Errors [%] of a model at `offsets` in the bands `BETWEEN`; without any it is as drawn."""
    f = model.measured.frequency
    bands = [np.flatnonzero((f >= low) & (f < high)) for low, high in pairwise(BETWEEN)]
    return [estimation_evaluate.share(estimation_evaluate.squares(model, offsets, lines)).percent for lines in bands]


def others(rung: Rung) -> list[float]:
    """Frequencies [Hz] of resonances that are in no model: where what is left over stands out of its surroundings."""
    from scipy.signal import find_peaks

    data, f = rung.model.measured.values, rung.model.measured.frequency
    left = data - rung.model.at(rung.offsets, derivatives=False).rows[..., 0]
    share = np.sum(np.abs(left) ** 2, axis=2) / np.sum(np.abs(data) ** 2, axis=2)
    level = 10 * np.log10(np.mean(share, axis=0))
    peaks, _ = find_peaks(level, prominence=PROMINENT, distance=round(2 / (f[1] - f[0])))
    return [float(f[k]) for k in peaks if f[k] > ABOVE]
