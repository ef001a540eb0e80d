"""Opening: an example, files that were dropped, or paths; and what is wrong with them, beside the field that has it."""

from __future__ import annotations

import asyncio
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from geometry.errors import BadInput
from validation.app import jobs, leaving, working
from validation.app.bench import Bench
from validation.desk import desk as desks
from validation.desk import examples, handed
from validation.desk.faults import Fault, faults, of_error
from validation.desk.handed import Handed
from validation.pictures import turntable
from validation.plots import theme

WARMS_AFTER = 3.0
"""Seconds in which a page is there and nobody has asked for a figure yet."""

CURRENT = "current"
"""The file that names the desk in use."""


def listed() -> list[dict[str, str]]:
    """The examples, as the page shows them."""
    return [{"name": one.name, "title": one.title, "words": one.words} for one in examples.examples()]


async def first(bench: Bench) -> None:
    """What a window begins with: the desk that it had, or what the command line named."""
    bench.begin(_warmed(bench))
    current = bench.folder / CURRENT
    if current.is_file():
        bench.desk = await bench.away(desks.opened, bench.folder / current.read_text(encoding="utf-8"))
        await working.shown(bench)
    elif bench.opened.example is not None:
        await example(bench, bench.opened.example)
    elif bench.opened.model is not None:
        one = bench.opened
        _begin(bench, one.model or "", one.data, one.hold_out, one.band, one.method, one.effects_from)
        await working.shown(bench)


async def _warmed(bench: Bench) -> None:
    """Have the libraries of figures and pictures there before the first one is waited for; the page itself comes first."""
    await asyncio.sleep(WARMS_AFTER)
    await asyncio.to_thread(theme.template, False)
    await bench.drawn(turntable.ready)


async def example(bench: Bench, name: str) -> None:
    """Open the example `name`, simulated first where it was never used here."""
    if _busy(bench):
        return
    bench.state.opening = True
    tell = jobs.teller(bench, f"The example {name} is made ready")
    try:
        series = await bench.aside(examples.series, name, tell)
    finally:
        bench.state.opening, bench.state.job = False, None
    _begin(bench, series.model, series.data, series.hold_out, series.band, title=series.title)
    await working.shown(bench)


async def paths(bench: Bench) -> None:
    """Open what the fields name; faults stay beside them, and nothing is opened where one is grave."""
    if not _busy(bench):
        await _opened(bench, ())


async def _opened(bench: Bench, refused: Sequence[Fault]) -> None:
    """The same, with what was refused on the way, and leaves the rest usable."""
    state = bench.state
    model, data = str(state.model_path or "").strip(), _lines(state.data_paths)
    try:
        model, data = await bench.away(_looked_into, model, data)
        band = _band(str(state.band or ""))
        hold_out = tuple(name.strip() for name in str(state.hold_out or "").split(",") if name.strip())
    except BadInput as error:
        _tell(bench, [*refused, of_error(error)], model)
        return
    state.model_path, state.data_paths = model, "\n".join(data)
    state.opening = True
    state.flush()
    try:
        found = await bench.away(faults, model, data, effects_from=bench.opened.effects_from)
    finally:
        state.opening = False
    _tell(bench, [*refused, *found], model)
    if any(one.grave for one in found):
        return
    _begin(bench, model, data, hold_out, band, effects_from=bench.opened.effects_from)
    await working.shown(bench)


async def arrived(bench: Bench, files: Sequence[Handed]) -> None:
    """Take over what a browser handed in, name it in the fields, and open it if nothing is wrong with it."""
    if _busy(bench):
        bench.state.failure = "Something is being read or computed. Hand the files over when that is done."
        return
    before = _drops(bench)
    folder = bench.folder / f"drop-{_number(bench)}-{len(before)}"
    room = handed.LARGEST - sum(path.stat().st_size for one in before for path in one.rglob("*") if path.is_file())
    received = await bench.away(handed.received, folder, files, limit=max(room, 0))
    state = bench.state
    models, data = list(received.models), _beside(bench, received.data)
    if models:
        state.models, state.model_path = models, models[0]
    if data:
        state.data_paths = "\n".join(data)
    grave = any(one.grave for one in received.faults)
    if grave or not (state.model_path and state.data_paths):
        lacking = [] if grave else [_lacking(bool(state.model_path))]
        _tell(bench, [*received.faults, *lacking], str(state.model_path or ""))
        return
    await _opened(bench, received.faults)


def _busy(bench: Bench) -> bool:
    """Whether a desk could not be changed for another now."""
    return bool(bench.state.opening) or bench.worker is not None or bench.state.job is not None


def _drops(bench: Bench) -> list[Path]:
    """What was dropped since a desk was begun, each time into a folder of its own: a file that was mended has the same name."""
    return sorted(bench.folder.glob(f"drop-{_number(bench)}-*"))


def _beside(bench: Bench, data: Sequence[str]) -> list[str]:
    """`data` with what was dropped before and is not replaced by it: campaigns may come one after the other."""
    named = {Path(one).name for one in data}
    ours = f"{bench.folder / f'drop-{_number(bench)}-'}"
    earlier = [one for one in _lines(bench.state.data_paths) if one.startswith(ours) and Path(one).name not in named]
    return [*earlier, *data]


def another(bench: Bench) -> None:
    """Back to the page on which things are opened; the desk in use stays as it is."""
    bench.state.screen = "open" if bench.state.screen == "work" else "work"


def _begin(
    bench: Bench,
    model: str,
    data: Sequence[str],
    hold_out: Sequence[str] = (),
    band: tuple[float, float] | None = None,
    method: str = "full-record",
    effects_from: Sequence[str] = (),
    title: str = "",
) -> None:
    folder = _new(bench)
    bench.desk = desks.begun(
        folder, model, data, hold_out=hold_out, band=band, method=method, effects_from=effects_from, title=title
    )
    leaving.saved(bench.desk)
    (bench.folder / CURRENT).write_text(folder.name, encoding="utf-8")


def _new(bench: Bench) -> Path:
    """A folder for the next desk."""
    folder = bench.folder / f"desk-{_number(bench)}"
    folder.mkdir(exist_ok=True)
    return folder


def _number(bench: Bench) -> int:
    """Of the next desk."""
    return sum(1 for one in bench.folder.glob("desk-*") if desks.is_desk(one))


def _looked_into(model: str, data: tuple[str, ...]) -> tuple[str, tuple[str, ...]]:
    """A folder in the field of the model stands for the model and the data in it."""
    if model and Path(model).is_dir():
        found = handed.sorted_out(model)
        return (found.models[0] if found.models else model), data or found.data
    return model, data


def _tell(bench: Bench, found: Iterable[Fault], model: str) -> None:
    """Faults beside the fields that have them."""
    beside: dict[str, list[dict[str, Any]]] = {"model": [], "data": [], "options": []}
    for one in found:
        place = "options" if one.file.startswith("--") else "model" if one.file in (model, "model", "MODEL", "") else "data"
        beside[place].append(asdict(one))
    bench.state.faults = beside


def _lacking(model: bool) -> Fault:
    """What was not among the files."""
    if model:
        return Fault(file="", field="", problem="no campaign folder is among the files", remedy="Drop the campaign's folder, too")
    problem = "no model file is among the files"
    return Fault(file="", field="", problem=problem, remedy="`massline model ARTICLE` writes one to start from; drop it, too")


def _lines(text: str | None) -> tuple[str, ...]:
    return tuple(line.strip() for line in (text or "").splitlines() if line.strip())


def _band(text: str) -> tuple[float, float] | None:
    words = text.replace(",", " ").replace("to", " ").replace("-", " ").split()
    if not words:
        return None
    try:
        low, high = (float(word) for word in words)
    except ValueError:
        problem = f"two frequencies [Hz] are expected, found {text!r}"
        raise BadInput(source="--band", problem=problem, remedy="Write for example 4 32") from None
    return low, high
