"""Measured beside predicted dynamic mass: the six diagonals of every campaign, and any other entry by choice."""

from __future__ import annotations

from collections.abc import Sequence
from typing import TYPE_CHECKING

from validation.comparing.comparison import WorstPair, worst_pairs
from validation.comparing.modes import NamedMode
from validation.comparing.pairs import Pairs
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag
from validation.report.nouns import Report
from validation.report.sections.parts import notes, section
from validation.report.tables import Cell, Column, number, table

if TYPE_CHECKING:
    from validation.plots.theme import Figure

PAIRS = 10
"""Worst pairs that are listed."""

NOTE = (
    "Blocked dynamic mass of all that stands on the load cells, about F. Dots: measured, Eqs. 9 to 11. Line: the model at the "
    "plain fit, its channels put through the same equations. Band: two standard deviations, the σ of the maps, of the complex "
    "difference that noise and unfitted tolerances let expect. Phase of an entry that is next to nothing means nothing"
)


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where no dynamic mass was measured."""
    found = report.comparison
    both = [(of.pairs, modes) for of, modes in zip(found.maps, found.modes, strict=True) if of.pairs is not None]
    if not both:
        return Safe("")
    worst = worst_pairs(found.maps, 36 * len(both))
    parts = [_campaign(pairs, modes, worst, k, figures) for k, (pairs, modes) in enumerate(both)]
    return section("dynamic-mass", "Dynamic mass, measured and predicted", notes([NOTE]), _worst(worst[:PAIRS]), *parts)


def _campaign(pairs: Pairs, modes: Sequence[NamedMode], worst: Sequence[WorstPair], k: int, figures: Figures) -> Safe:
    from validation.plots.overlay import diagonal

    group = f"entry-{k}"
    first = next(one for one in worst if one.data_set == pairs.campaign)
    every = _entries(pairs, modes)
    figures.choices(group, every)
    key = f"{first.load}-{first.motion}"
    choice = tag(
        "div", _select("load", group, first.load), _select("base motion", group, first.motion), class_="choice screen-only"
    )
    return tag(
        "div",
        tag("h3", pairs.campaign),
        figures.placed(diagonal(pairs, modes=modes)),
        tag("h4", "Any entry", class_="screen-only"),
        choice,
        figures.placed(every[key], screen_only=True, group=group, shown=key),
        class_="part",
    )


def _entries(pairs: Pairs, modes: Sequence[NamedMode]) -> dict[str, Figure]:
    from validation.plots.overlay import overlay

    return {f"{i}-{j}": overlay(pairs, i, j, modes=modes) for i in range(6) for j in range(6)}


def _select(what: str, group: str, chosen: int) -> Safe:
    from validation.plots.overlay import LOADS, MOTIONS, SIGNS

    names = LOADS if what == "load" else MOTIONS
    options = [
        tag("option", f"{sign}: {name}", value=str(k), selected=k == chosen)
        for k, (sign, name) in enumerate(zip(SIGNS, names, strict=True))
    ]
    part = "load" if what == "load" else "motion"
    return tag("label", f"{what} ", tag("select", *options, data_choice=group, data_part=part))


def _worst(worst: Sequence[WorstPair]) -> Safe:
    from validation.plots.overlay import LOADS, MOTIONS, entry

    columns = [
        Column(head="entry", words=True),
        Column(head="campaign", words=True),
        Column(head="load", words=True),
        Column(head="base motion", words=True),
        Column(head="at", unit="Hz"),
        Column(head="deviation", unit="σ"),
        Column(head="of the dynamic mass", unit="%"),
    ]
    rows: list[list[Cell]] = [
        [
            entry(one.load, one.motion),
            one.data_set,
            LOADS[one.load],
            MOTIONS[one.motion],
            number(one.frequency, ".2f"),
            number(one.sigma, ".3g"),
            number(one.percent, ".3g"),
        ]
        for one in worst
    ]
    return joined(table("The entries that differ most", columns, rows))
