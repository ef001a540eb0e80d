"""The score on a screen."""

from __future__ import annotations

from collections import Counter
from collections.abc import Sequence

from rich.table import Table

from benchmarks.blind.ledger import Ledger
from benchmarks.blind.score.families import OfFamily
from benchmarks.blind.score.outcome import Outcome
from benchmarks.blind.score.rates import Rate
from benchmarks.blind.score.rows import Row


def heading(seed: int, code: str, outcomes: Sequence[Outcome], book: Ledger) -> str:
    """What was scored, and whether it is blind."""
    counts = Counter(one.kind for one in outcomes)
    of = ", ".join(f"{count} {kind}" for kind, count in counts.items())
    return f"{_blindness(seed, code, book)} draw {seed}, code {code}: {of}."


def _blindness(seed: int, code: str, book: Ledger) -> str:
    if seed in book.development:
        return "Development, not blind:"
    others = [one for one in book.looked_at(seed) if one.code != code]
    if others:
        last = others[-1]
        return f"NOT BLIND: this draw was looked at on {last.day} with code {last.code}, and the code has changed since;"
    return "Blind:"


def verdict(row: Row) -> str:
    """Of one measure against its bar."""
    return "" if row.met is None else "met" if row.met else "missed"


def bars(found: Sequence[Row], title: str) -> Table:
    """The table of bars."""
    table = Table(title=title)
    for head in ("measure", "figure", "bar", ""):
        table.add_column(head)
    for row in found:
        table.add_row(row.what, row.figure, row.bar, verdict(row))
    return table


def families(found: Sequence[OfFamily]) -> Table:
    """One row a family."""
    table = Table(title="Effects planted alone, by family")
    for head in HEADS:
        table.add_column(head)
    for one in found:
        table.add_row(*cells(one))
    return table


def groups(found: Sequence[tuple[str, Rate, Rate]]) -> Table:
    """One row a group of single faults."""
    table = Table(title="Single faults on random structures")
    for head in GROUP_HEADS:
        table.add_column(head)
    for name, right, wrong in found:
        table.add_row(name, str(right), _of(wrong))
    return table


GROUP_HEADS = ("of", "right", "named wrongly")

HEADS = ("family", "named first", "in the class", "extra claims", "median error", "interval holds", "instead")


def cells(one: OfFamily) -> tuple[str, ...]:
    """Of one family, by `HEADS`."""
    error = "–" if one.error is None else f"{100 * one.error:.1f} %"
    return (one.family, _of(one.first), _of(one.inside), _of(one.extra), error, _of(one.covered), one.instead)


def _of(rate: Rate) -> str:
    return f"{rate.hits} of {rate.count}" if rate.count else "–"
