"""The page of a diagnosis without a campaign: the verdict, the measurements, what each effect would need, what to do next."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from validation.diagnosing.classical.advised import SURE
from validation.diagnosing.classical.nouns import Needed, Reading, SwingAnswer
from validation.diagnosing.detectable_table import grid as smallest
from validation.diagnosing.diagnosis import AMBIGUOUS, MISSING, NOTHING, SEVERAL, UNKNOWN
from validation.diagnosing.practical import said, significant
from validation.rows import NONE, rounded
from validation.tables.grid import Grid, aligned

FAR = 10.0
"""Tolerances by which an input is not wrong any more, but something else."""

MOST = 8
"""Tests that are shown."""

PLACES = "point-mass"

HEADLINES = {
    NOTHING: "NOTHING IS MISSING at the resolution of these measurements",
    MISSING: "MISSING",
    AMBIGUOUS: "MISSING IS one of several that these measurements cannot tell apart",
    SEVERAL: "SEVERAL ARE MISSING",
    UNKNOWN: "UNKNOWN: something is missing, and no effect that massline knows explains it",
}
"""By verdict."""


def title(model: str, files: Sequence[str]) -> str:
    """Model and data."""
    return f"What {model} is missing beside {', '.join(files)}"


def opening(found: SwingAnswer) -> Iterator[str]:
    """The verdict, and what there is to say of it."""
    yield f"{HEADLINES[found.verdict]}."
    yield found.text


def grids(found: SwingAnswer) -> list[Grid]:
    """All tables, in the order in which they are read."""
    return [
        facts(found),
        *([needed(found.needed)] if found.needed else []),
        *([readings(found)] if _near(found) else []),
        *([advice(found)] if found.advice else []),
        *([smallest(found.detectable)] if found.detectable else []),
    ]


def facts(found: SwingAnswer) -> Grid:
    """Every measurement beside the model."""
    several = len({one.name.removesuffix(one.quantity) for one in found.facts}) > 1
    lines = [
        (
            f"{one.name if several else one.quantity} [{_unit(one.unit)}]",
            rounded(one.measured, one.deviation),
            rounded(one.deviation, one.deviation),
            rounded(one.predicted, one.deviation),
            f"{100 * one.period_shift:+.3f} %" if one.period else NONE,
            f"{-one.sigma:+.1f}",
        )
        for one in found.facts
    ]
    first, *rest = zip(*lines, strict=True)
    header = ("measurement", "measured", "sd", "model", "period", "sigma")
    return Grid(header=header, lines=tuple(zip(first, *map(aligned, rest), strict=True)))


def needed(of: Sequence[Needed]) -> Grid:
    """What every effect would have to be, places of one kind in one line."""
    lines = [(name, f"{max(one.evidence for one in each):+.1f}", _thought(each)) for name, each in _together(of).items()]
    first, evidence, words = zip(*lines, strict=True)
    header = ("effect", "evidence [nats]", "size that would explain it by itself")
    return Grid(header=header, lines=tuple(zip(first, aligned(evidence), words, strict=True)), words=True)


def readings(found: SwingAnswer) -> Grid:
    """Inputs that would explain it, were they wrong."""
    lines = [(one.name, f"{one.value:.6g}", f"{one.change:+.2g}", f"{one.tolerances:+.1f}") for one in _near(found)]
    first, *rest = zip(*lines, strict=True)
    header = ("or a wrong input [SI]", "as stated", "it would be off by", "in its tolerances")
    return Grid(header=header, lines=tuple(zip(first, *map(aligned, rest), strict=True)))


def advice(found: SwingAnswer) -> Grid:
    """What to measure next, the best first."""
    lines = tuple((f"{k}", _nats(one.gain), _sentence(one.test)) for k, one in enumerate(found.advice[:MOST], start=1))
    return Grid(header=("next", "nats", "measure this, and expect that much evidence of it"), lines=lines, words=True)


def notes(found: SwingAnswer) -> Iterator[str]:
    """What must be known to read the tables, then warnings."""
    yield "Sigma: measured less the model's, over the standard deviation; what is stated as a tolerance is a 95 % limit."
    yield "Evidence: how much more probable the measurements are with it than without it, in nats: 3 is 20 to 1, 7 is 1000 to 1."
    if len(found.advice) > MOST:
        yield f"--json has {len(found.advice) - MOST} more tests."
    yield from (f"warning: {text}." for text in found.remarks)


def _near(found: SwingAnswer) -> list[Reading]:
    return [one for one in found.readings if abs(one.tolerances) <= FAR and abs(one.change) < abs(one.value)]


def _together(of: Sequence[Needed]) -> dict[str, list[Needed]]:
    found: dict[str, list[Needed]] = {}
    for one in of:
        family, _, _ = one.id.partition(":")
        found.setdefault(family if family == PLACES else one.id, []).append(one)
    return found


def _thought(of: Sequence[Needed]) -> str:
    if len(of) == 1:
        return of[0].text
    low, high = (end(of, key=lambda one: one.value) for end in (min, max))
    least = min(of, key=lambda one: abs(one.value))
    places = f"at any of {len(of)} places {said(low.value, low.unit)} to {said(high.value, high.unit)}"
    return f"{places}; at {least.id.partition(':')[2]} {least.text}"


def _nats(gain: float) -> str:
    """Of a test; where it decides anyway, no more than that."""
    if gain == 0:
        return NONE
    return f"> {SURE:.0f}" if gain > SURE else significant(gain, 2)


def _sentence(text: str) -> str:
    return f"{text[:1].upper()}{text[1:]}"


def _unit(unit: str) -> str:
    return unit.replace("^2", "²")
