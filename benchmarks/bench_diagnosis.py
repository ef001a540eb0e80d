"""What a diagnosis costs: against the number of candidates and of lines, and beside refitting every candidate one by one.

The series is Cuboid on its disc, Clumod with one blade and with four, one load cell of which reads too much. The candidates are
those of the catalogue that could act there. Screening tells all of them from one Jacobian; a tool that refits each in turn pays a
fit for each, which is measured on some of them, spread over the menu, and counted for all.
"""

from __future__ import annotations

import sys
import time
from collections.abc import Callable
from functools import cache, partial

import click
import numpy as np

from benchmarks.ratios import Timing, measure, show
from geometry.frames import Array
from identification.campaign import Campaign
from validation.diagnose.candidate_fits import fit_with
from validation.diagnose.candidates import candidates, screen
from validation.diagnose.diagnose import diagnosed
from validation.diagnose.diagnosis import Candidate
from validation.effects.catalogue import parse
from validation.model.model import Model
from validation.prediction.series import predictions
from validation.study import Study
from validation.virtual_test.plan import Plan
from validation.virtual_test.planted import planted
from validation.virtual_test.simulate import simulate

ARTICLES = ("fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4")
MODEL = Model(source="benchmark", title="as drawn", article=ARTICLES[-1])
PLANTED = "force-gain:fmd-z2=0.05"
SEED, PACE = 11, 8.0
"""Of the virtual laboratory, and how fast it sweeps [octaves/min]."""

BAR = 15.0
"""[s] of one core for a diagnosis of three configurations. It is absolute: seconds are printed beside it, and kept nowhere."""

SAMPLE = 6
"""Candidates that are refitted; the others are counted as these."""

MENUS = {
    "force gains alone": ("force-gain",),
    "all of the force side": (
        *("force-gain", "force-delay", "force-highpass", "force-crosstalk", "force-plane-offset", "load-path-shunt"),
        *("cell-stiffness", "board-delay"),
    ),
    "the whole catalogue": (),
}
"""Candidates, by what is looked for."""

Call = Callable[[], object]


@cache
def campaigns() -> tuple[Campaign, ...]:
    """The series."""
    effects = planted([parse(PLANTED)])
    plans = [Plan(article=one, seed=SEED, octaves_per_minute=PACE, effects=effects) for one in ARTICLES]
    return tuple(simulate(plan).campaign for plan in plans)


@cache
def bench(step: int = 1) -> Study:
    """All data at every so many lines."""
    whole = predictions(MODEL, campaigns())
    lines: Array | None = None if step == 1 else np.asarray(whole[0].measured.frequency[::step])
    made = whole if lines is None else predictions(MODEL, campaigns(), lines=lines)
    return Study(model=MODEL, campaigns=campaigns(), made=made)


@cache
def start() -> Candidate:
    """The baseline from which all are refitted."""
    return Candidate(effects=(), fit=bench().all_free(), problem=bench().problem())


def one_by_one() -> None:
    """A fit for some of the candidates, spread over the menu."""
    menu = candidates(bench())
    for k in np.linspace(0, len(menu) - 1, SAMPLE).astype(int):
        fit_with(bench(), start(), menu[k])


def against_refits() -> None:
    """One screening and one whole diagnosis, beside a fit for every candidate."""
    menu = candidates(bench())
    at = start()
    calls: dict[str, Call] = {
        "the baseline": lambda: bench().all_free(),
        "screening of all candidates": lambda: screen(bench(), at, menu),
        "a whole diagnosis": lambda: diagnosed(bench()),
        f"refitting {SAMPLE} of them": one_by_one,
    }
    timings = measure(calls, rounds=1, clock=time.process_time)
    some = timings[f"refitting {SAMPLE} of them"]
    share = len(menu) / SAMPLE
    timings["refitting every one"] = Timing(fastest=share * some.fastest, median=share * some.median)
    count = sum(len(one.measured.frequency) * len(one.measured.runs) for one in bench().made)
    notes = {"refitting every one": f"{len(menu)} candidates, counted from {SAMPLE}"}
    show(f"Three configurations, {count} lines of runs, {len(menu)} candidates", timings, base="a whole diagnosis", notes=notes)
    if "--json" not in sys.argv:
        click.echo(f"a whole diagnosis {timings['a whole diagnosis'].fastest:.1f} s of one core; the bar is {BAR:g} s")


def growing_candidates() -> None:
    """A family, a side, the whole catalogue."""
    calls: dict[str, Call] = {name: partial(diagnosed, bench(), only=only) for name, only in MENUS.items()}
    notes = {name: f"{len(candidates(bench(), only=only))} candidates" for name, only in MENUS.items()}
    show("A diagnosis, as candidates grow", measure(calls, rounds=1), base=next(iter(calls)), notes=notes)


def growing_lines() -> None:
    """A quarter, half and all of the lines."""
    steps = {f"{len(bench(step).made[0].measured.frequency)} lines": step for step in (4, 2, 1)}
    calls: dict[str, Call] = {name: partial(diagnosed, bench(step)) for name, step in steps.items()}
    show("A diagnosis, as lines grow", measure(calls, rounds=1), base=next(iter(calls)))


def main() -> None:
    """All tables; progress on standard error, since simulating comes first."""
    sys.stderr.write("simulating three campaigns ...\n")
    bench()
    against_refits()
    growing_candidates()
    growing_lines()


if __name__ == "__main__":
    main()
