"""The page of `massline diagnose`: the verdict, the causes, what would decide, the errors before and after, how it was found."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence

from validation.comparing.verdicts import expected_z2, figure, misfit, percent
from validation.diagnosing import figures, words
from validation.diagnosing.detectable_table import grid as smallest
from validation.diagnosing.diagnosis import AMBIGUOUS, MISSING, MISTAKE, NONLINEAR, NOTHING, SEVERAL, Cause, Diagnosis, Size, Step
from validation.engine.evaluation import Evaluation, Share
from validation.rows import NONE
from validation.tables.grid import Grid, aligned

RANKED = 8
"""Causes that the page shows; JSON has all."""

CLOSE = 3.0
"""[nats] from which what was not worth a name is worth a word: 20 to 1."""

SAID_ALL = (NOTHING, MISSING, AMBIGUOUS, SEVERAL)
"""Verdicts of which the one sentence says all that a text would."""

NOT_FITTED = (MISTAKE, NONLINEAR)
"""Verdicts of which the model as it was is held against the data without a fit, so that there is no evidence to compare."""

ERRORS: tuple[tuple[str, Callable[[Evaluation], str]], ...] = (
    ("nominal error", lambda e: percent(e.nominal.percent)),
    ("plain error, fitted data", lambda e: percent(e.plain.percent)),
    ("plain error, held out", lambda e: _share(e.held_out)),
    ("nominal error, held out", lambda e: _share(e.held_out_nominal)),
    ("plain error, a configuration never seen", lambda e: _share(e.held_out_configurations)),
    ("fitted: chi² per degree of freedom", lambda e: f"{misfit(e.fitted):.3g}"),
    (
        "fitted: sum z² of the tolerances, and what is due",
        lambda e: _price(e),
    ),
)


def title(model: str, data_sets: Sequence[str]) -> str:
    """Model and data."""
    return f"What {model} is missing beside {', '.join(data_sets)}"


def opening(found: Diagnosis) -> Iterator[str]:
    """The verdict in one sentence, and what there is to say of it."""
    first = words.headline(found)
    yield first
    if found.text and found.verdict not in SAID_ALL:
        yield found.text
    if found.verdict == NOTHING and found.ranking and found.ranking[0].evidence >= CLOSE:
        one = found.ranking[0]
        yield f"The closest is {words.cause(one)}: {one.evidence:.1f} nats, less than is asked for. Other data decide."


def grids(found: Diagnosis) -> list[Grid]:
    """All tables, in the order in which they are read."""
    return [
        *([causes(found.accepted)] if found.accepted else []),
        *(explained(one) for one in found.accepted),
        *([alike(found)] if len(found.equivalence_class) > 1 else []),
        *([advice(found)] if found.advice else []),
        *([leftover(found)] if found.leftover is not None else []),
        *([levels(found)] if found.levels else []),
        errors(found),
        *([ranking(found)] if found.ranking else []),
        *([steps(found)] if found.steps else []),
        *([smallest(found.detectable)] if found.detectable and found.verdict == NOTHING else []),
    ]


def causes(of: Sequence[Cause]) -> Grid:
    """What is missing, size by size."""
    lines = [line for one in of for line in _sizes(one)]
    first, *rest = zip(*lines, strict=True)
    header = ("missing", "size", "90 % interval", "unit", "evidence [nats]")
    return Grid(header=header, lines=tuple(zip(first, *_columns(rest), strict=True)))


def explained(one: Cause) -> Grid:
    """One cause for somebody who never heard of it."""
    lines = (
        ("means", one.text),
        *((("these data say", one.note),) if one.note else ()),
        ("mistaken for", words.mistaken(one)),
        ("confirm it by", one.confirmed_by or NONE),
    )
    return Grid(header=(one.id, one.named.what), lines=lines, words=True)


def alike(found: Diagnosis) -> Grid:
    """What these data cannot tell apart."""
    before = [one for step in found.steps for one in step.ranking]
    known = {one.id: one for one in (*before, *found.ranking, *found.accepted)}
    lines = tuple((id, _alike(id, known.get(id))) for id in found.equivalence_class)
    return Grid(header=("one of these", "size (90 %), evidence, and what it is"), lines=lines, words=True)


def advice(found: Diagnosis) -> Grid:
    """What to measure next, the best first."""
    lines = tuple(
        (f"{k}", figure(one.gain) if one.gain > 0 else NONE, _advised(one.test, one.separates))
        for k, one in enumerate(found.advice, start=1)
    )
    return Grid(header=("next", "nats", "measure this, and expect that much evidence of it"), lines=lines, words=True)


def leftover(found: Diagnosis) -> Grid:
    """What no effect explains."""
    of = found.leftover
    if of is None:
        return Grid(header=("", ""), lines=())
    where = f"{of.load} by {of.motion}" if of.load else ", ".join(of.channels[:4])
    size = NONE if of.size is None else f"{of.size:.3g} {'' if of.unit == '1' else of.unit}".rstrip()
    at = NONE if of.frequency is None else f"{of.frequency:.2f} Hz"
    lines = (
        ("what is left", of.text),
        ("looks like", of.looks_like),
        ("where", where or NONE),
        ("size", size),
        ("resonance at", at),
        ("share of it that this covers", f"{100 * of.share:.0f} %"),
    )
    return Grid(header=("leftover", "in words"), lines=tuple(line for line in lines if line[1] != NONE), words=True)


def levels(found: Diagnosis) -> Grid:
    """Axes that answer otherwise at another level."""
    lines = tuple(
        (
            f"{one.data_set}: {one.runs[0]} against {one.runs[1]}",
            figure(one.sigma),
            f"{one.axis}, most at {one.frequency:.1f} Hz, in {words.listed(one.channels)}",
        )
        for one in found.levels
    )
    return Grid(header=("two levels", "sigma", "axis, and where"), lines=lines, words=True)


def errors(found: Diagnosis) -> Grid:
    """The four errors without and with what was accepted."""
    both = (found.before,) if found.before is found.after else (found.before, found.after)
    kept = [(name, cells) for name, tell in ERRORS if set(cells := [tell(one) for one in both]) != {NONE}]
    gain = found.after.fitted.log_evidence - found.before.fitted.log_evidence
    if len(both) > 1 and found.verdict not in NOT_FITTED:
        kept.append(("evidence gained [nats]", [NONE, f"{gain:+.1f}"]))
    columns = [aligned(tuple(column)) for column in zip(*(cells for _, cells in kept), strict=True)]
    header = ("the four errors", "before", "after") if len(both) > 1 else ("the four errors", "now")
    return Grid(header=header, lines=tuple(zip((name for name, _ in kept), *columns, strict=True)))


def ranking(found: Diagnosis) -> Grid:
    """What was tried, the best first."""
    shown = found.ranking[:RANKED]
    lines = [(one.id, figure_of(one), f"{one.evidence:+.1f}", f"{one.misfit:.3g}", f"{one.price:.3g}") for one in shown]
    first, *rest = zip(*lines, strict=True)
    judged = tuple(_judged(found, one) for one in shown)
    header = ("tried", "size", "evidence [nats]", "chi²", "price", "so")
    return Grid(header=header, lines=tuple(zip(first, *_columns(rest), judged, strict=True)), words=True)


def steps(found: Diagnosis) -> Grid:
    """How it was found."""
    lines = tuple((f"{k}", f"{one.misfit:.3g}", f"{one.price:.3g}", _sentence(one)) for k, one in enumerate(found.steps, start=1))
    return Grid(header=("round", "chi²", "price", "how it was found"), lines=lines, words=True)


def notes(found: Diagnosis) -> Iterator[str]:
    """What must be known to read the tables, then what was assumed."""
    yield "Evidence: how much more probable the data are with it than without it, in nats: 3 is 20 to 1, 7 is 1000 to 1."
    yield (
        "Price: sum of z² of all tolerances over what is due where nothing is wrong. Chi² alone says little: tolerances swallow "
        "faults at an absurd price."
    )
    if len(found.ranking) > RANKED:
        yield f"{len(found.ranking) - RANKED} more effects were tried and explain less; --json has all of them."
    if found.detectable and found.verdict != NOTHING:
        yield f"--json has the smallest size at which each of {len(found.detectable)} effects would have been named."
    if found.verdict == NONLINEAR:
        yield "A linear fit of such data names nonsense: the errors are those of the model as it is."
    if found.hold_out:
        yield f"Held out: {words.listed(found.hold_out)}."
    yield from (f"warning: {text.rstrip('.')}." for text in found.remarks)


def figure_of(one: Cause) -> str:
    """The first size of a cause with its unit."""
    if not one.sizes:
        return NONE
    value, _, _, unit = words.interval(one, one.sizes[0])
    return figures.with_unit(value, unit)


def _sentence(of: Step) -> str:
    return of.text if of.text.startswith(of.added) else f"{of.added}: {of.text}"


def _sizes(one: Cause) -> list[tuple[str, ...]]:
    """A line a size; one of a mistake that has none."""
    told = [(*_told(one, size), f"{one.evidence:+.1f}" if k == 0 else "") for k, size in enumerate(one.sizes)]
    names = [f"{one.id} {size.key}".rstrip() for size in one.sizes]
    return [(name, *line) for name, line in zip(names, told, strict=True)] or [(one.id, NONE, NONE, NONE, f"{one.evidence:+.1f}")]


def _told(one: Cause, size: Size) -> tuple[str, str, str]:
    value, low, high, unit = words.interval(one, size)
    return value, NONE if size.low == size.high else f"{low} to {high}", unit or NONE


def _columns(columns: Sequence[tuple[str, ...]]) -> list[tuple[str, ...]]:
    return [aligned(column) for column in columns]


def _alike(id: str, known: Cause | None) -> str:
    if known is None:
        return f"does the same to these data, and was not fitted: {words.what(id)}"
    return f"{'; '.join(words.sized(known, size) for size in known.sizes)}, {known.evidence:+.1f} nats: {known.named.what}"


def _advised(test: str, separates: Sequence[str]) -> str:
    names = ["no effect at all" if one == NOTHING else one for one in separates]
    apart = f" It tells {words.listed(names)} apart." if len(names) > 1 else ""
    return f"{test[:1].upper()}{test[1:].rstrip('.')}.{apart}"


def _judged(found: Diagnosis, one: Cause) -> str:
    """Why a cause that was tried stands where it stands."""
    if one.id in {cause.id for cause in found.accepted}:
        return "accepted"
    if one.id in found.equivalence_class:
        return "cannot be told from it"
    return ("explains less" if found.accepted else "too little") if one.null else "misfit or price stay too high"


def _price(of: Evaluation) -> str:
    return f"{of.fitted.tolerance_z2:.3g} of {expected_z2(of.fitted):.0f}"


def _share(of: Share | None) -> str:
    return NONE if of is None else percent(of.percent)
