"""The page of `massline compare`: four errors, the worst spots in words, runs and configurations, pairs of axes,
tolerances, facts."""

from __future__ import annotations

from collections.abc import Iterator

from validation.comparing.comparison import Comparison, worst_pairs
from validation.comparing.maps import Map
from validation.comparing.verdicts import ABSURD, STANDS_OUT, absurd, figure
from validation.comparing.words import text
from validation.rows import NONE, rounded
from validation.tables.grid import Grid, aligned

PAIRS = 5

CHANCE = 3
"""Spots that are shown where none stands out."""

SIGNS = ("x", "y", "z", "α", "β", "γ")
"""Of loads and base motions in the name of an entry of H."""


def title(found: Comparison) -> str:
    """Model and data."""
    return f"{found.title} beside {', '.join(found.data_sets)}"


def grids(found: Comparison) -> list[Grid]:
    """All tables, in the order in which they are read."""
    pairs = worst_pairs(found.maps, PAIRS)
    return [
        errors(found),
        spots(found),
        runs(found.maps),
        *([entries(found)] if pairs else []),
        *([moved(found)] if absurd(found.evaluation.fitted) else []),
        *([facts(found)] if found.facts else []),
    ]


def errors(found: Comparison) -> Grid:
    """The four errors: figure, meaning, verdict."""
    lines = tuple((one.name, one.figure, _judged(one.verdict, one.text, one.meaning)) for one in found.errors)
    return Grid(header=("", "error", "what it means, and what is to be thought of it"), lines=lines, words=True)


def _judged(verdict: str, text: str, meaning: str) -> str:
    said = f"{verdict.upper()}: {text}" if verdict else text
    return f"{meaning}. {said}" if said else meaning


def spots(found: Comparison) -> Grid:
    """The worst spots in words; where none stands out the worst three, as chance leaves them."""
    count = len(found.maps)
    shown = [one for one in found.worst if one.sigma >= STANDS_OUT] or found.worst[:CHANCE]
    lines = tuple((f"{k:>2}", figure(one.sigma), text(one, count)) for k, one in enumerate(shown, start=1))
    return Grid(header=("", "sigma", "where it fails"), lines=lines, words=True)


def runs(maps: tuple[Map, ...]) -> Grid:
    """Chi² per degree of freedom of every run of every data set, tolerances counted."""
    names = list(dict.fromkeys(name for one in maps for name in one.runs))
    by_name = [dict(zip(one.runs, one.misfit.mean(axis=1), strict=True)) for one in maps]
    columns = [aligned(tuple(figure(of[name]) if name in of else NONE for of in by_name)) for name in names]
    lines = tuple(zip((one.data_set for one in maps), *columns, strict=True))
    return Grid(header=("chi² by run", *names), lines=lines)


def entries(found: Comparison) -> Grid:
    """The pairs of axes in which predicted and measured dynamic mass differ most."""
    lines = [
        (
            f"H {SIGNS[one.load]}{SIGNS[one.motion]} of {one.data_set}",
            figure(one.sigma),
            f"{figure(one.percent)} %",
            f"{one.frequency:.2f}",
        )
        for one in worst_pairs(found.maps, PAIRS)
    ]
    first, *rest = zip(*lines, strict=True)
    return Grid(header=("dynamic mass", "sigma", "of it", "at [Hz]"), lines=tuple(zip(first, *map(aligned, rest), strict=True)))


def moved(found: Comparison) -> Grid:
    """The most absurd tolerances."""
    lines = [
        (one.parameter.name, f"{one.z:+.1f}", f"{one.offset:+.3g} {_unit(one.parameter.unit)}".rstrip())
        for one in found.absurd
        if abs(one.z) >= min(ABSURD, abs(found.absurd[0].z))
    ]
    first, *rest = zip(*lines, strict=True)
    return Grid(header=("absurd tolerances", "z", "moved by"), lines=tuple(zip(first, *map(aligned, rest), strict=True)))


def _unit(unit: str) -> str:
    return "" if unit == "1" else unit


def facts(found: Comparison) -> Grid:
    """Classical measurements, predicted minus measured."""
    lines = [
        (
            f"{one.name} [{one.unit}]",
            rounded(one.measured, one.tolerance),
            rounded(one.tolerance, one.tolerance),
            rounded(one.predicted, one.tolerance),
            f"{one.sigma:+.1f}",
            f"{one.nominal_sigma:+.1f}",
        )
        for one in found.facts
    ]
    first, *rest = zip(*lines, strict=True)
    header = ("classical measurements", "measured", "sd", "predicted", "sigma", "nominal")
    return Grid(header=header, lines=tuple(zip(first, *map(aligned, rest), strict=True)))


def notes(found: Comparison) -> Iterator[str]:
    """What must be known to read the tables, then what was assumed."""
    first = found.worst[0].sigma if found.worst else 0.0
    if first < STANDS_OUT:
        yield f"Nothing stands out: the worst spot is {figure(first)} sigma, and chance reaches about {STANDS_OUT - 1:g}."
    elif below := sum(one.sigma < STANDS_OUT for one in found.worst):
        yield f"{below} more of the ten worst spots are below {STANDS_OUT:g} sigma, as chance leaves them."
    yield (
        "Sigma: deviation at the plain fit over what noise, a model error of 0.15 % and all tolerances that were not fitted let "
        "expect. A channel's is from what all other channels and the model say of it."
    )
    yield from _resonances(found)
    if found.evaluation.held_out_names:
        yield f"Held out: {_some(found.evaluation.held_out_names)}."
    if found.effects:
        yield f"Effects in the model: {', '.join(found.effects)}."
    yield from (f"warning: {text}." for text in found.remarks)


def _resonances(found: Comparison) -> Iterator[str]:
    """Modes within the band by name."""
    for of, modes in zip(found.maps, found.modes, strict=True):
        inside = [one for one in modes if of.frequency[0] <= one.frequency <= of.frequency[-1]]
        if inside:
            yield f"Modes of {of.data_set}: {_some([f'{one.name} {one.frequency:.2f} Hz' for one in inside], 8)}."


def _some(names: tuple[str, ...] | list[str], most: int = 4) -> str:
    more = len(names) - most
    return ", ".join(names) if more <= 0 else f"{', '.join(names[:most])} and {more} more"
