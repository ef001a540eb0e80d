"""What one evaluation of a prediction costs: with all derivatives, by finite differences, by solving the finite elements again.

The series is Cuboid on its disc, Clumod with one blade and with four, on the usual grid of lines; all channels of all campaigns
are predicted with the derivative of every parameter. Finite differences take two predictions for each parameter. The finite
elements solved again make new modes for a changed modulus and reduce the structure anew, as a tool without a nominal basis must
for every trial. The other tables let lines and effects grow.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from functools import cache, partial

import numpy as np

from benchmarks.ratios import Timing, measure, show
from identification.campaign import Campaign
from validation.effects.catalogue import parse
from validation.estimation.problem import Lines, Problem
from validation.model.model import Added, Model
from validation.prediction import mounting
from validation.prediction.series import SeriesPrediction, predictions
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import simulate

ARTICLES = ("fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4")
MODEL = Model(source="benchmark", title="as drawn", article=ARTICLES[-1])
EFFECTS = (
    *("force-gain:fmd-z2=0.08", "point-mass:mast-top=0.5", "modulus:mast=0.05", "joint-compliance:rotation=1e-6"),
    *(
        "cable:mast-top:lateral=1000",
        "structural-damping:mast=0.01",
        "orientation:z=0.01",
        "absorber:mast-top=m:0.05,f:21,zeta:0.01",
    ),
)
STEP = 1e-4
"""Of finite differences, as a share of each parameter's tolerance."""

Call = Callable[[], object]


@cache
def campaigns() -> tuple[Campaign, ...]:
    """Quick sweeps: a prediction asks for lines, channels and runs alone."""
    return tuple(simulate(Plan(article=article, octaves_per_minute=30.0)).campaign for article in ARTICLES)


@cache
def series(effects: int = 0) -> tuple[SeriesPrediction, ...]:
    """Predictions of the three campaigns, with the first `effects` of `EFFECTS`."""
    added = tuple(Added(named=parse(text)) for text in EFFECTS[:effects])
    return tuple(one.with_effects(added) for one in predictions(MODEL, campaigns()))


def every(of: Sequence[SeriesPrediction], *, derivatives: bool, lines: Lines | None = None) -> None:
    """All channels of all campaigns."""
    start = Problem(predictions=tuple(of)).start
    for one in of:
        one.at(start, lines, derivatives=derivatives)


def differences(of: Sequence[SeriesPrediction]) -> float:
    """Every derivative by central differences; the greatest that is off, as a share of what the channels read."""
    worst = 0.0
    for one in of:
        known = one.at({}, derivatives=True)
        size = np.abs(known.rows).max()
        for parameter in one.parameters:
            step = STEP * parameter.tolerance
            above, below = (one.at({parameter.name: side * step}, derivatives=False).rows for side in (1, -1))
            change, slope = known.changes[parameter.name], (above - below) / (2 * step)
            apart = slope[..., list(change.channels), :] - change.rows
            worst = max(worst, float(np.abs(apart).max() * parameter.tolerance / size))
    return worst


def solved_again() -> None:
    """Modes, reduction and prediction of the three set-ups from the structure on."""
    mounting._made.cache_clear()
    for campaign in campaigns():
        mounting.mounted_article(MODEL, campaign)
    every(series(), derivatives=False)


def against() -> None:
    """One evaluation, in three ways to know how the prediction answers to its parameters."""
    of = series()
    count = len(Problem(predictions=of).parameters)
    apart: list[float] = []
    calls: dict[str, Call] = {
        "all channels": partial(every, of, derivatives=False),
        "all channels and all derivatives": partial(every, of, derivatives=True),
        "finite elements solved again, once": solved_again,
    }
    timings = measure(calls, rounds=3) | measure({"finite differences": lambda: apart.append(differences(of))}, rounds=1)
    once = timings["finite elements solved again, once"]
    again = Timing(fastest=2 * count * once.fastest, median=2 * count * once.median)
    timings["finite elements solved again, for each"] = again
    notes = {
        "finite differences": f"at most {apart[0]:.1e} from ours",
        "finite elements solved again, for each": f"{2 * count} times once",
    }
    lines = sum(len(one.measured.runs) * len(one.measured.frequency) for one in of)
    title = f"Three configurations, {lines} lines of runs, {count} parameters"
    show(title, timings, base="all channels and all derivatives", notes=notes)


def growing_lines() -> None:
    """A quarter, half and all of the lines."""
    of = series()
    n = len(of[0].measured.frequency)
    chosen = {f"{n // step} lines": np.arange(0, n, step, dtype=np.int64) for step in (4, 2, 1)}
    calls: dict[str, Call] = {name: partial(every, of, derivatives=True, lines=lines) for name, lines in chosen.items()}
    show("All derivatives, as lines grow", measure(calls, rounds=3), base=next(iter(calls)))


def growing_effects() -> None:
    """None, two, four and eight effects beside all tolerances."""
    calls: dict[str, Call] = {f"{k} effects": partial(every, series(k), derivatives=True) for k in (0, 2, 4, 8)}
    show("All derivatives, as effects grow", measure(calls, rounds=3), base="0 effects")


def main() -> None:
    """All tables."""
    against()
    growing_lines()
    growing_effects()


if __name__ == "__main__":
    main()
