"""The page on which one works: brought to what the desk holds, after opening, after a reload, and after every step."""

from __future__ import annotations

from typing import Any

from validation.app import comparing, diagnosing, jobs, rungs, structure, trying
from validation.app.bench import Bench
from validation.app.keeping import kept
from validation.desk import comparing as desk_comparing
from validation.desk import jobs as desk_jobs


async def shown(bench: Bench) -> None:
    """Show the desk as it is; a comparison that was never made begins."""
    state, desk = bench.state, bench.desk
    if desk is None:
        return
    desk_jobs.recovered(desk)
    bench.wanted = kept(bench)
    state.title, state.screen, state.failure, state.ready = _title(bench), "work", "", None
    state.faults = {"model": [], "data": [], "options": []}
    state.flush()
    await stands(bench)
    if bench.compared is None:
        jobs.start(bench, desk_jobs.COMPARE, stands)


async def stands(bench: Bench) -> None:
    """Everything that follows from the model as it stands now."""
    if bench.desk is None:
        return
    bench.compared = await bench.away(desk_comparing.comparison, bench.desk)
    bench.table, bench.effects, bench.tried = None, {}, None  # all of the model that stood there before
    bench.state.compared = bench.compared is not None
    await comparing.shown(bench)
    await rungs.shown(bench)
    await diagnosing.shown(bench)
    bench.state.flush()
    bench.begin(structure.shown(bench))
    if bench.compared is not None:
        bench.begin(trying.made_ready(bench))


def _title(bench: Bench) -> str:
    desk: Any = bench.desk
    asked = desk.asked
    data = ", ".join(path.rsplit("/", 1)[-1] for path in asked.data)
    return f"{asked.title or asked.model.rsplit('/', 1)[-1]}: {data}"
