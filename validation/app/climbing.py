"""Up and down the ladder, from the page."""

from __future__ import annotations

from validation.app import jobs, working
from validation.app.bench import Bench
from validation.app.keeping import keep
from validation.desk import climbing
from validation.desk import jobs as desk_jobs


async def add(bench: Bench) -> None:
    """Add the chosen effect; its fit begins at the size of the sliders."""
    effect = None if bench.state.effect is None else bench.effects.get(bench.state.effect["id"])
    if effect is None:
        return
    jobs.start(bench, desk_jobs.ADD, _added, working.stands, effect=effect.written(bench.sizes))


async def undo(bench: Bench) -> None:
    """One rung down."""
    if bench.desk is not None and bench.worker is None:
        await bench.away(climbing.undone, bench.desk)
        await working.stands(bench)


async def go(bench: Bench, number: int) -> None:
    """To any rung."""
    if bench.desk is not None and bench.worker is None:
        await bench.away(climbing.gone_to, bench.desk, int(number))
        await working.stands(bench)
        if bench.compared is None:
            jobs.start(bench, desk_jobs.COMPARE, working.stands)


async def _added(bench: Bench) -> None:
    bench.wanted, bench.tried, bench.state.effect = None, None, None
    bench.state.tab, bench.state.part = "ladder", "fails"
    await working.stands(bench)
    keep(bench)
