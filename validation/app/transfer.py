"""Files on their way to the page and from it: examples, dropped files and paths; model, ladder, figures and report."""

import asyncio
import zipfile
from collections.abc import Iterable, Sequence
from dataclasses import asdict
from pathlib import Path
from typing import Any

from geometry.errors import BadInput
from validation.app import opening, panels, workers
from validation.app import state as app_state
from validation.app.opening import Fault, Handed, faults, of_error
from validation.app.session import Session, begun, is_session, opened
from validation.app.state import WindowState
from validation.report.charts import interactive
from validation.report.scenes import turntable

# Opening: an example, files that were dropped, or paths; and what is wrong with them, beside the field that has it.


WARMS_AFTER = 3.0
"""Seconds in which a page is there and nobody has asked for a figure yet."""

CURRENT = "current"
"""The file that names the session in use."""


async def first(window: WindowState) -> None:
    """What a window begins with: the session that it had, or what the command line named."""

    async def warmed() -> None:
        """Have the libraries of figures and pictures there before the first one is waited for; the page itself comes first."""
        await asyncio.sleep(WARMS_AFTER)
        await asyncio.to_thread(interactive.template, False)
        await window.drawn(turntable.ready)

    window.begin(warmed())
    current = window.folder / CURRENT
    if current.is_file():
        window.session = await window.away(opened, window.folder / current.read_text(encoding="utf-8"))
        await panels.shown(window)
    elif window.opened.example is not None:
        await example(window, window.opened.example)
    elif (one := window.opened.asked) is not None and one.model:
        _begin(window, one.model, one.data, one.hold_out, one.band, one.spectra, one.effects_from)
        await panels.shown(window)


async def example(window: WindowState, name: str) -> None:
    """Open the example `name`, simulated first where it was never used here."""
    if _busy(window):
        return
    window.state.opening = True
    tell = app_state.teller(window, f"The example {name} is made ready")
    try:
        series = await window.aside(opening.made, name, tell)
    finally:
        window.state.opening, window.state.job = False, None
    _begin(window, series.model, series.data, series.hold_out, series.band, title=series.title)
    await panels.shown(window)


async def paths(window: WindowState) -> None:
    """Open what the fields name; faults stay beside them, and nothing is opened where one is grave."""
    if not _busy(window):
        await _opened(window, ())


async def _opened(window: WindowState, refused: Sequence[Fault]) -> None:
    """The same, with what was refused on the way, and leaves the rest usable."""
    state = window.state
    model, data = str(state.model_path or "").strip(), _lines(state.data_paths)
    try:
        if model and Path(model).is_dir():
            # A folder in the field of the model stands for the model and the data in it
            inside = await window.away(opening.sorted_out, model)
            model, data = (inside.models[0] if inside.models else model), data or inside.data
        text = str(state.band or "")
        words = text.replace(",", " ").replace("to", " ").replace("-", " ").split()
        if not words:
            band: tuple[float, float] | None = None
        else:
            try:
                low, high = (float(word) for word in words)
            except ValueError:
                problem = f"two frequencies [Hz] are expected, found {text!r}"
                raise BadInput("--band", "", problem, "Write for example 4 32") from None
            band = low, high
        hold_out = tuple(name.strip() for name in str(state.hold_out or "").split(",") if name.strip())
    except BadInput as error:
        _tell(window, [*refused, of_error(error)], model)
        return
    state.model_path, state.data_paths = model, "\n".join(data)
    state.opening = True
    state.flush()
    try:
        found = await window.away(faults, model, data, effects_from=window.opened.effects_from)
    finally:
        state.opening = False
    _tell(window, [*refused, *found], model)
    if any(one.grave for one in found):
        return
    _begin(window, model, data, hold_out, band, effects_from=window.opened.effects_from)
    await panels.shown(window)


async def arrived(window: WindowState, files: Sequence[Handed]) -> None:
    """Take over what a browser handed in, name it in the fields, and open it if nothing is wrong with it."""
    if _busy(window):
        window.state.failure = "Something is being read or computed. Hand the files over when that is done."
        return
    # What was dropped since a session was begun, each time into a folder of its own: a file that was mended has the same name
    before = sorted(window.folder.glob(f"drop-{_number(window)}-*"))
    folder = window.folder / f"drop-{_number(window)}-{len(before)}"
    room = opening.LARGEST - sum(path.stat().st_size for one in before for path in one.rglob("*") if path.is_file())
    received = await window.away(opening.received, folder, files, limit=max(room, 0))
    state = window.state
    # `received.data` with what was dropped before and is not replaced by it: campaigns may come one after the other
    named = {Path(one).name for one in received.data}
    ours = f"{window.folder / f'drop-{_number(window)}-'}"
    earlier = [one for one in _lines(window.state.data_paths) if one.startswith(ours) and Path(one).name not in named]
    models, data = list(received.models), [*earlier, *received.data]
    if models:
        state.models, state.model_path = models, models[0]
    if data:
        state.data_paths = "\n".join(data)
    grave = any(one.grave for one in received.faults)
    if grave or not (state.model_path and state.data_paths):
        lacking = []  # what was not among the files
        if not grave and state.model_path:
            lacking = [Fault(file="", problem="no campaign folder is among the files", remedy="Drop the campaign's folder, too")]
        elif not grave:
            remedy = "`massline model ARTICLE` writes one to start from; drop it, too"
            lacking = [Fault(file="", problem="no model file is among the files", remedy=remedy)]
        _tell(window, [*received.faults, *lacking], str(state.model_path or ""))
        return
    await _opened(window, received.faults)


def _busy(window: WindowState) -> bool:
    """Whether a session could not be changed for another now."""
    return bool(window.state.opening) or window.worker is not None or window.state.job is not None


def _begin(
    window: WindowState,
    model: str,
    data: Sequence[str],
    hold_out: Sequence[str] = (),
    band: tuple[float, float] | None = None,
    method: str = "full-record",
    effects_from: Sequence[str] = (),
    title: str = "",
) -> None:
    # A folder for the next session
    folder = window.folder / f"desk-{_number(window)}"
    folder.mkdir(exist_ok=True)
    window.session = begun(
        folder, model, data, hold_out=hold_out, band=band, method=method, effects_from=effects_from, title=title
    )
    window.session.take_over(sorted(window.folder.parent.glob("*/desk-*")))
    app_state.saved(window.session)
    (window.folder / CURRENT).write_text(folder.name, encoding="utf-8")


def _number(window: WindowState) -> int:
    """Of the next session."""
    return sum(1 for one in window.folder.glob("desk-*") if is_session(one))


def _tell(window: WindowState, found: Iterable[Fault], model: str) -> None:
    """Faults beside the fields that have them."""
    beside: dict[str, list[dict[str, Any]]] = {"model": [], "data": [], "options": []}
    for one in found:
        place = "options" if one.file.startswith("--") else "model" if one.file in (model, "model", "MODEL", "") else "data"
        beside[place].append(asdict(one))
    window.state.faults = beside


def _lines(text: str | None) -> tuple[str, ...]:
    return tuple(line.strip() for line in (text or "").splitlines() if line.strip())


# What leaves the page: model, ladder, figures and report, as downloads.


REPORT, FIGURES = "report.html", "figures.zip"

SAVING_BESIDE = {"ladder.json": "model.ladder.json"}
"""What is saved under another name than it is asked for: a ladder is found by that of its model."""

TYPES = {".toml": "application/toml", ".json": "application/json", ".html": "text/html", ".zip": "application/zip"}


async def report(window: WindowState) -> None:
    """Let a worker write the report."""
    if window.session is not None:
        app_state.start(window, workers.REPORT, _reported, to=str(_kept(window.session) / REPORT))


async def _reported(window: WindowState) -> None:
    _ready(window, "The report is ready:", REPORT)


async def figures(window: WindowState) -> None:
    """Draw the pictures of comparison and ladder."""
    session = window.session
    if session is None:
        return
    tell = app_state.teller(window, "Drawing the figures")
    try:
        folder = _kept(session) / "figures"
        folder.mkdir(parents=True, exist_ok=True)
        paths = await window.aside(session.draw, folder, tell)
        if not paths:
            raise BadInput("figures", "", "there is nothing to draw yet", "Compare first")
        with zipfile.ZipFile(_kept(session) / FIGURES, "w") as archive:
            for path in paths:
                archive.write(path, path.name)
    finally:
        window.state.job = None
    _ready(window, "The figures are ready:", FIGURES)


def content(window: WindowState, name: str) -> tuple[bytes, str]:
    """What is downloaded under `name`, and its type.

    Raises
    ------
    LookupError : there is nothing of that name.
    BadInput : there is no ladder yet.
    """
    session = window.session
    if session is None:
        raise LookupError(name)
    kept = {REPORT: _kept(session) / REPORT, FIGURES: _kept(session) / FIGURES}
    if name == "model.toml":
        body = session.model_text().encode()
        app_state.saved(session)
        window.state.unsaved = False
        window.state.flush()
    elif name == "ladder.json":
        body = session.ladder_text().encode()
    elif name in kept and kept[name].is_file():
        body = kept[name].read_bytes()
    else:
        raise LookupError(name)
    return body, TYPES[Path(name).suffix]


def _ready(window: WindowState, text: str, name: str) -> None:
    window.state.ready = {"text": text, "links": [{"href": f"save/{name}", "name": name}]}


def _kept(session: Session) -> Path:
    folder = session.folder / "saved"
    folder.mkdir(exist_ok=True)
    return folder
