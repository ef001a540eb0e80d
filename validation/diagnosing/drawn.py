"""The pictures of `massline diagnose`: what each of them shows, from the diagnosis."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping
from pathlib import Path

from validation.comparing.verdicts import expected_z2, misfit
from validation.diagnosing import words
from validation.diagnosing.diagnosis import AMBIGUOUS, NOTHING, UNKNOWN, Cause, Diagnosis
from validation.engine.evaluation import Evaluation, Share
from validation.pictures import diagnosis as pages

BARS = 10
"""Causes that are drawn."""

EVIDENCE, ERRORS = "diagnose-evidence.png", "diagnose-errors.png"

THRESHOLD = "worth_nats"
"""Key of the settings by which a diagnosis says what it asked for, of each family that has its own and of all others, by ""."""


def draw(found: Diagnosis, folder: Path) -> tuple[Path, ...]:
    """Write every picture that `found` has the evidence for into `folder`, and say where they are."""
    made = []
    if tried(found):
        _evidence(found, folder / EVIDENCE)
        made.append(folder / EVIDENCE)
    _errors(found, folder / ERRORS)
    return (*made, folder / ERRORS)


def tried(found: Diagnosis) -> tuple[Cause, ...]:
    """What is drawn: what was accepted, then what was tried, each once."""
    every = {one.id: one for one in (*found.ranking, *found.accepted)}
    return tuple(sorted(every.values(), key=lambda one: -one.evidence))[:BARS]


def _evidence(found: Diagnosis, path: Path) -> None:
    bars = [
        pages.DrawnCause(
            name=one.id,
            size="; ".join(words.sized(one, size) for size in one.sizes[:1]),
            evidence=one.evidence,
            standing=_standing(found, one),
        )
        for one in tried(found)
    ]
    note = "How much more probable the data are with the effect than without it, each beside the model before the last was found."
    pages.draw_evidence(_title(found), bars, path, note, asked(found))


def asked(found: Diagnosis) -> float | None:
    """[nats] that a diagnosis asks of most families; None where it does not say."""
    said = found.settings.get(THRESHOLD)
    return float(said[""]) if isinstance(said, Mapping) and "" in said else None


def _standing(found: Diagnosis, one: Cause) -> str:
    if one.id in {cause.id for cause in found.accepted}:
        return pages.ACCEPTED
    if one.id in found.equivalence_class:
        return pages.ALIKE
    return pages.LESS if one.null else pages.TOO_MUCH_LEFT


def _errors(found: Diagnosis, path: Path) -> None:
    before, after = found.before, None if found.after is found.before else found.after
    percents = [pages.DrawnPair(name=name, before=a, after=b, unit=" %") for name, a, b in _percents(before, after)]
    ratios: tuple[tuple[str, Callable[[Evaluation], float]], ...] = (
        ("chi² per degree of freedom", lambda of: misfit(of.fitted)),
        ("sum z² of the tolerances", _price),
    )
    prices = [
        pages.DrawnPair(name=name, before=tell(before), after=None if after is None else tell(after)) for name, tell in ratios
    ]
    pages.draw_before_after(_title(found), percents, prices, path, _held(found))


def _percents(before: Evaluation, after: Evaluation | None) -> Iterator[tuple[str, float, float | None]]:
    shares: tuple[tuple[str, Callable[[Evaluation], Share | None]], ...] = (
        ("nominal", lambda of: of.nominal),
        ("plain", lambda of: of.plain),
        ("plain, held out", lambda of: of.held_out),
        ("a configuration never seen", lambda of: of.held_out_configurations),
    )
    for name, tell in shares:
        one, other = tell(before), None if after is None else tell(after)
        if one is not None:
            yield name, one.percent, None if other is None else other.percent


def _price(of: Evaluation) -> float:
    return of.fitted.tolerance_z2 / max(expected_z2(of.fitted), 1.0)


def _title(found: Diagnosis) -> str:
    names = words.listed([one.id for one in found.accepted])
    told = {NOTHING: "nothing is missing", UNKNOWN: "unknown", AMBIGUOUS: f"one of {words.listed(found.equivalence_class, 'or')}"}
    return f"Diagnosis: {told.get(found.verdict) or names or found.verdict}"


def _held(found: Diagnosis) -> str:
    return f"Held out: {words.listed(found.hold_out)}." if found.hold_out else ""
