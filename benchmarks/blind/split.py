"""Significance on split samples, another way to accept an effect: ``python -m benchmarks.blind.split [CASES]``.

An effect is sought and sized in every second line, and then asked for what it gains in the lines between, which had no say in
the choice: no threshold set from nulls is needed there. It is tried on development draws beside the evidence that the diagnosis
goes by, on nulls and on effects of twice their detection limit; docs/diagnosis-proven-blind.md tells what came of it.
"""

from __future__ import annotations

import sys
from collections.abc import Iterator, Sequence
from dataclasses import dataclass, fields, replace
from pathlib import Path
from statistics import median
from tempfile import TemporaryDirectory

from rich.console import Console

from benchmarks.blind import ledger
from benchmarks.blind.drawing.case import NULL, SERIES, SINGLE, Case
from benchmarks.blind.drawing.draw import draw
from benchmarks.blind.names import MODEL
from benchmarks.blind.sealing import sealed
from validation.diagnose.candidate_fits import fit_with
from validation.diagnose.candidates import baseline, candidates, screen
from validation.effects.effect import evidence_threshold
from validation.estimation.fit import nearby
from validation.estimation.problem import FITTED, Problem
from validation.model.model import Added
from validation.study import Study

WEAK = 2.0
"""Multiple of the detection limit at which effects are asked for."""

SURE = 3.0
"""[nats] in lines that had no say, at which a wrong effect is one of twenty: exp(-3)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Half(Study):
    """A bench that sees every second line, the `odd` ones or the others."""

    odd: bool = False

    def problem(self, effects: Sequence[Added] = ()) -> Problem:
        """As a bench, with half of the lines."""
        every = Study.problem(self, effects)
        lines = {one.measured.name: every.lines_of(one)[int(self.odd) :: 2] for one in every.predictions}
        return replace(every, lines=lines)


@dataclass(frozen=True, kw_only=True)
class Tried:
    """What one case came to.

    Attributes
    ----------
    case : which
    planted : id of the effect, empty of a null
    found : id of the best candidate in the first half, and the evidence [nats] that it has there over what is asked for
    over, unseen : gain of the same effect at the same size in the other half [nats]
    """

    case: str
    planted: str
    found: str
    over: float
    unseen: float


def tried(case: Case, folder: Path) -> Tried:
    """Both ways on one `case`, simulated into `folder`."""
    sealed(case, folder)
    whole = Study.open(folder / MODEL, [folder / name for name in case.articles], hold_out=case.hold_out)
    given = {one.name: getattr(whole, one.name) for one in fields(whole) if one.init}
    first, other = (Half(**given, odd=odd) for odd in (False, True))
    base, menu = baseline(first), candidates(first)
    best = max((fit_with(first, base, one.added) for one in screen(first, base, menu)[:3]), key=lambda at: at.fit.log_evidence)
    (effect,) = best.effects
    without, held = (
        nearby(other.problem(effects), FITTED, at.fit.by_name)
        for effects, at in (((), base), ((replace(effect, fixed=True),), best))
    )
    planted = case.planted[0].text.partition("=")[0] if case.planted else ""
    over = best.fit.log_evidence - base.fit.log_evidence - evidence_threshold(effect.named.family)
    return Tried(case=case.name, planted=planted, found=effect.named.id, over=over, unseen=without.cost - held.cost)


def chosen(most: int) -> list[Case]:
    """Nulls of the first development draw, and effects at twice their limits."""
    every = [one for one in draw(ledger.read().development[0]) if one.articles == SERIES]
    weak = [one for one in every if one.kind == SINGLE and one.planted[0].multiple == WEAK]
    return [*[one for one in every if one.kind == NULL][:most], *weak[:most]]


def told(found: Sequence[Tried]) -> Iterator[str]:
    """Both ways beside one another."""
    for what, of in (("nulls", [one for one in found if not one.planted]), ("effects", [one for one in found if one.planted])):
        named = sum(one.over > 0 for one in of)
        confirmed = sum(one.unseen > SURE for one in of)
        yield (
            f"{what}: of {len(of)} evidence in half of the lines names {named}, the other half confirms {confirmed} "
            f"(median {median(one.unseen for one in of):+.1f} nats)"
        )


def main(most: int = 12) -> int:
    """Try `most` nulls and as many weak effects."""
    console, found = Console(stderr=True), []
    for case in chosen(most):
        with TemporaryDirectory(prefix="massline-split-") as scratch:
            found.append(tried(case, Path(scratch) / "series"))
        one = found[-1]
        console.print(
            f"{one.case} {one.planted or 'nothing'}: {one.found} {one.over:+.1f} over, {one.unseen:+.1f} unseen", style="dim"
        )
    for line in told(found):
        Console().print(line)
    return 0


if __name__ == "__main__":
    sys.exit(main(*map(int, sys.argv[1:])))
