"""What a drag of the workbench's slider costs, for every family of effects that reaches a series, beside one full prediction.

The series is the built-in example of a mast, compared first; an effect is chosen, which makes it ready, and then dragged. Of a
few drags the slowest counts, by the clock on the wall: that is what a hand feels, on a machine that has nothing else to do. Of a
family with many targets some are tried, spread over all of them. Ratios are for documents; the bar of 200 ms
that the page has for all of it is absolute, so that milliseconds are printed beside it, and kept nowhere.
"""

from __future__ import annotations

import sys
import tempfile
from collections.abc import Iterator
from pathlib import Path
from statistics import median
from time import perf_counter

import click
import numpy as np

from benchmarks.ratios import Timing, measure, show
from geometry.errors import BadInput, CheckFailed
from validation.app import opening, whatif
from validation.app.session import Session, begun
from validation.app.whatif import ReadyPredictions, Slider, TrialEffect, reaching, what_if

EXAMPLE = "mast"

BAR = 200.0
"""[ms] from a slider to every curve."""

PLACES = (0.5, 0.52, 0.54)
"""Along the slider; the first one makes ready."""

MOST = 4
"""Targets of a family that are tried."""

BASE = "one full prediction"


def ready(folder: Path) -> Session:
    """The example, compared."""
    series = opening.made(EXAMPLE)
    desk = begun(folder, series.model, series.data, hold_out=series.hold_out, band=series.band)
    desk.compare()
    return desk


def drags(of: ReadyPredictions, effect: TrialEffect) -> list[float]:
    """[s] of every drag but the first, which makes ready; none where the model refuses the middle of the slider."""
    taken = []
    for place in PLACES:
        began = perf_counter()
        try:
            what_if(of, effect.written({one.key: at(one, place) for one in effect.sliders}), exact=False)
        except (BadInput, CheckFailed):
            return []
        taken.append(perf_counter() - began)
    return taken[1:]


def at(one: Slider, place: float) -> float:
    """A size along a slider; a switch is turned, and only the first size is moved."""
    if one.whole:
        return one.low if one.start == one.high else one.high
    if one.key and one.key != "m":
        return one.start
    if one.logarithmic:
        return float(np.exp(np.log(one.low) + place * np.log(one.high / one.low)))
    return one.low + place * (one.high - one.low)


def by_family(of: ReadyPredictions) -> Iterator[tuple[str, list[float]]]:
    """By family, the slowest drag of each of the effects that are tried [s]."""
    families: dict[str, list[TrialEffect]] = {}
    for effect in reaching(of):
        families.setdefault(effect.family, []).append(effect)
    for name, effects in families.items():
        some = effects[:: -(-len(effects) // MOST)]
        if slowest := [max(taken) for one in some if (taken := drags(of, one))]:
            yield name, slowest


def main() -> None:
    """Measure, and print ratios; on a terminal the milliseconds, too."""
    with tempfile.TemporaryDirectory() as folder:
        desk = ready(Path(folder) / "desk")
        of, anew = whatif.table(desk), desk.predictions(desk.read_model())
        base = measure({BASE: lambda: [one.at(of.offsets, derivatives=False) for one in anew]}, clock=perf_counter)
        families = dict(by_family(of))
    every = [one for taken in families.values() for one in taken]
    timings = {**base, "median of all effects": Timing(fastest=median(every), median=median(every))}
    timings |= {name: Timing(fastest=max(taken), median=median(taken)) for name, taken in families.items()}
    show(f"A drag, worst effect of each family of {len(every)} effects", timings, base=BASE)
    if "--json" not in sys.argv:
        click.echo(f"median {1e3 * median(every):.0f} ms, worst {1e3 * max(every):.0f} ms; the bar is {BAR:g} ms")


if __name__ == "__main__":
    main()
