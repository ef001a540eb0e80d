"""What is missing: ranked causes with evidence and sizes, what each means and how to confirm it, the next measurement."""

from __future__ import annotations

from collections.abc import Callable

from validation.comparing.verdicts import expected_z2, misfit
from validation.diagnosing import table as said
from validation.diagnosing import words
from validation.diagnosing.detectable_table import grid as smallest
from validation.diagnosing.diagnosis import NOTHING, Cause, Diagnosis
from validation.diagnosing.drawn import tried
from validation.effects.worth import worth
from validation.engine.evaluation import Evaluation
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag
from validation.report.nouns import Report
from validation.report.sections.parts import notes, paragraphs, section
from validation.report.tables import NOTHING as EMPTY
from validation.report.tables import Cell, Column, Number, number, of_grid, table
from validation.rows import NONE


def html(report: Report, figures: Figures) -> Safe:
    """The section."""
    found = report.diagnosis
    if found is None:
        told = paragraphs([f"It was not looked for: {report.not_diagnosed or 'nobody asked'}."])
        return section("missing", "What is missing", told)
    from validation.plots.errors import before_and_after
    from validation.plots.evidence import evidence

    after = None if found.after is found.before else found.after
    first, *others = said.opening(found)
    return section(
        "missing",
        "What is missing",
        tag("p", first, class_="headline"),
        paragraphs(others),
        figures.placed(evidence(found)) if tried(found) else None,
        _ranking(found),
        *(_explained(one) for one in found.accepted),
        of_grid("What these data cannot tell apart", said.alike(found)) if len(found.equivalence_class) > 1 else None,
        _advice(found),
        of_grid("What no effect explains", said.leftover(found)) if found.leftover is not None else None,
        of_grid("Two levels that do not give the same", said.levels(found)) if found.levels else None,
        figures.placed(before_and_after(found.before, after)),
        _errors(found),
        of_grid("How it was found", said.steps(found)) if found.steps else None,
        _detectable(found),
        notes(said.notes(found)),
    )


def _ranking(found: Diagnosis) -> Safe:
    """Every cause that was tried, a line for each of its numbers."""
    columns = [
        Column(head="cause", words=True),
        Column(head="evidence", unit="nats"),
        Column(head="asked for", unit="nats"),
        Column(head="number", words=True),
        Column(head="size"),
        Column(head="from"),
        Column(head="to"),
        Column(head="unit", words=True),
        Column(head="χ² per dof"),
        Column(head="price"),
        Column(head="so", words=True),
    ]
    every = {one.id: one for one in (*found.ranking, *found.accepted)}.values()  # as it was accepted
    ordered = sorted(every, key=lambda one: -one.evidence)
    rows = [line for one in ordered for line in _lines(found, one)]
    note = "From and to: 90 % interval. Price: sum of z² of the tolerances with it, over what is due where nothing is wrong."
    return table("Causes that were tried, the best first", columns, rows, note=note)


def _lines(found: Diagnosis, one: Cause) -> list[list[Cell]]:
    """A line a number; one of a mistake, which has none."""
    from validation.plots.evidence import standing_of

    tail: list[Cell] = [number(one.misfit, ".3g"), number(one.price, ".3g"), standing_of(found, one)]
    head: list[Cell] = [one.id, number(one.evidence, "+.1f"), number(worth(one.named.family), "g")]
    if not one.sizes:
        return [[*head, NONE, EMPTY, EMPTY, EMPTY, "", *tail]]
    return [[*head, size.key or one.named.what, *_sizes(one, k), *tail] for k, size in enumerate(one.sizes)]


def _sizes(one: Cause, k: int) -> list[Cell]:
    """Value and both ends of its interval in the unit of a laboratory."""
    size = one.sizes[k]
    value, low, high, unit = words.interval(one, size)
    fitted = size.low != size.high
    ends: list[Cell] = [_shown(low), _shown(high)] if fitted else [EMPTY, EMPTY]
    return [_shown(value), *ends, unit]


def _shown(text: str) -> Cell:
    return Number(value=float(text), text=text.replace("-", "−"))


def _explained(one: Cause) -> Safe:
    return of_grid(f"{one.id}: {one.named.what}", said.explained(one))


def _advice(found: Diagnosis) -> Safe:
    columns = [
        Column(head="next", words=True),
        Column(head="expected evidence", unit="nats"),
        Column(head="work", unit="h"),
        Column(head="measure this", words=True),
        Column(head="tells apart", words=True),
    ]
    rows: list[list[Cell]] = [
        [
            f"{k}",
            number(one.gain, ".3g") if one.gain > 0 else EMPTY,
            number(one.hours, "g") if one.hours else EMPTY,
            one.test,
            words.listed(one.separates),
        ]
        for k, one in enumerate(found.advice, start=1)
    ]
    return table("The next measurement, the best first", columns, rows)


def _errors(found: Diagnosis) -> Safe:
    columns = [Column(head="error", words=True), Column(head="unit", words=True), Column(head="before"), Column(head="after")]
    both = (found.before, None if found.after is found.before else found.after)
    rows: list[list[Cell]] = [
        [name, unit, *(number(None if of is None else tell(of), ".4g") for of in both)] for name, unit, tell in FIGURES
    ]
    return table("The errors before and after what was found is added", columns, [row for row in rows if row[2] is not EMPTY])


def _of(share: str) -> Callable[[Evaluation], float | None]:
    """The error of that name in per cent."""

    def tell(of: Evaluation) -> float | None:
        found = getattr(of, share)
        return None if found is None else float(found.percent)

    return tell


FIGURES: tuple[tuple[str, str, Callable[[Evaluation], float | None]], ...] = (
    ("nominal error", "%", _of("nominal")),
    ("plain error, fitted data", "%", _of("plain")),
    ("plain error, held out", "%", _of("held_out")),
    ("nominal error, held out", "%", _of("held_out_nominal")),
    ("plain error, a configuration never seen", "%", _of("held_out_configurations")),
    ("fitted: χ² per degree of freedom", "1", lambda of: misfit(of.fitted)),
    ("fitted: sum of z² of the tolerances", "1", lambda of: of.fitted.tolerance_z2),
    ("... of which is due where nothing is wrong", "1", lambda of: expected_z2(of.fitted)),
)


def _detectable(found: Diagnosis) -> Safe:
    if not found.detectable or found.verdict != NOTHING:
        return Safe("")
    return joined(of_grid("The smallest sizes that would have been named", smallest(found.detectable)))
