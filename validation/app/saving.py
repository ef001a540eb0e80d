"""What leaves the page: model, ladder, figures and report, as downloads."""

from __future__ import annotations

import io
import zipfile
from pathlib import Path

from geometry.errors import BadInput
from validation.app import jobs, leaving
from validation.app.bench import Bench
from validation.desk import jobs as desk_jobs
from validation.desk import saving
from validation.desk.desk import Desk

REPORT, FIGURES = "report.html", "figures.zip"

BESIDE = {"ladder.json": "model.ladder.json"}
"""What is saved under another name than it is asked for: a ladder is found by that of its model."""

TYPES = {".toml": "application/toml", ".json": "application/json", ".html": "text/html", ".zip": "application/zip"}


async def report(bench: Bench) -> None:
    """Let a worker write the report."""
    if bench.desk is not None:
        jobs.start(bench, desk_jobs.REPORT, _reported, to=str(_kept(bench.desk) / REPORT))


async def figures(bench: Bench) -> None:
    """Draw the pictures of comparison and ladder."""
    desk = bench.desk
    if desk is None:
        return
    tell = jobs.teller(bench, "Drawing the figures")
    try:
        folder = _kept(desk) / "figures"
        folder.mkdir(parents=True, exist_ok=True)
        paths = await bench.aside(saving.figures, desk, folder, tell)
        (_kept(desk) / FIGURES).write_bytes(await bench.aside(_zipped, paths))
    finally:
        bench.state.job = None
    _ready(bench, "The figures are ready:", FIGURES)


def content(bench: Bench, name: str) -> tuple[bytes, str]:
    """What is downloaded under `name`, and its type.

    Raises
    ------
    LookupError : there is nothing of that name.
    BadInput : there is no ladder yet.
    """
    desk = bench.desk
    if desk is None:
        raise LookupError(name)
    kept = {REPORT: _kept(desk) / REPORT, FIGURES: _kept(desk) / FIGURES}
    if name == "model.toml":
        body = saving.model_text(desk).encode()
        leaving.saved(desk)
        bench.state.unsaved = False
        bench.state.flush()
    elif name == "ladder.json":
        body = saving.ladder_text(desk).encode()
    elif name in kept and kept[name].is_file():
        body = kept[name].read_bytes()
    else:
        raise LookupError(name)
    return body, TYPES[Path(name).suffix]


async def _reported(bench: Bench) -> None:
    _ready(bench, "The report is ready:", REPORT)


def _ready(bench: Bench, text: str, name: str) -> None:
    bench.state.ready = {"text": text, "links": [{"href": f"save/{name}", "name": name}]}


def _kept(desk: Desk) -> Path:
    folder = desk.folder / "saved"
    folder.mkdir(exist_ok=True)
    return folder


def _zipped(paths: tuple[Path, ...]) -> bytes:
    if not paths:
        raise BadInput(source="figures", problem="there is nothing to draw yet", remedy="Compare first")
    kept = io.BytesIO()
    with zipfile.ZipFile(kept, "w") as archive:
        for path in paths:
            archive.write(path, path.name)
    return kept.getvalue()
