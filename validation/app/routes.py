"""What a window serves beside its page: pictures, downloads, and the way in for dropped files."""

from __future__ import annotations

import asyncio
import tempfile
from functools import cache
from pathlib import Path
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from geometry.errors import BadInput, CheckFailed
from validation.app import opening, saving, structure
from validation.app.bench import Bench
from validation.app.headers import NEVER_KEPT
from validation.desk.handed import LARGEST, MOST, Handed

if TYPE_CHECKING:
    from aiohttp import BodyPartReader, web

CHUNK = 2**20


def add(app: Any, bench: Bench) -> None:
    """Put the routes into the window's server."""

    async def view(request: web.Request) -> web.Response:
        return await _view(request, bench)

    async def saved(request: web.Request) -> web.Response:
        return _saved(request, bench)

    async def files(request: web.Request) -> web.Response:
        return await _files(request, bench)

    app.router.add_get("/plotly.js", _plotly)
    app.router.add_get("/view.jpg", view)
    app.router.add_get("/save/{name}", saved)
    app.router.add_post("/files", files)


async def _plotly(_: web.Request) -> web.Response:
    from aiohttp import web

    body = await asyncio.to_thread(_library)
    return web.Response(body=body, content_type="text/javascript", charset="utf-8", headers={"Cache-Control": "max-age=86400"})


@cache
def _library() -> bytes:
    """plotly.js, of the version to which the figures belong."""
    from validation.plots.embedded import library

    return library().encode()


async def _view(request: web.Request, bench: Bench) -> web.Response:
    from aiohttp import web

    try:
        body = await bench.drawn(structure.picture, bench, dict(request.query))
    except (ValueError, LookupError, CheckFailed) as error:
        return web.Response(status=404, text=f"massline: {error}", headers=NEVER_KEPT)
    return web.Response(body=body, content_type="image/jpeg", headers=NEVER_KEPT)


def _saved(request: web.Request, bench: Bench) -> web.Response:
    from aiohttp import web

    name = request.match_info["name"]
    try:
        body, kind = saving.content(bench, name)
    except (LookupError, BadInput):
        return web.Response(status=404, text="massline: there is nothing to be saved under this name yet.", headers=NEVER_KEPT)
    # Always a download: a report has scripts of its own, which are not this page's.
    headers = {**NEVER_KEPT, "Content-Disposition": f'attachment; filename="{saving.BESIDE.get(name, name)}"'}
    return web.Response(body=body, content_type=kind, headers=headers)


async def _files(request: web.Request, bench: Bench) -> web.Response:
    """Files as the page sends them, each part named like its file, folders included; the desk says what becomes of names."""
    from aiohttp import web

    with tempfile.TemporaryDirectory(dir=bench.folder, prefix="arriving-") as folder:
        try:
            files = await _parts(request, Path(folder))
        except ValueError as error:
            return web.Response(status=413, text=f"massline: {error}")
        await bench.told(opening.arrived(bench, files))
    return web.Response(text="")


async def _parts(request: web.Request, folder: Path) -> list[Handed]:
    from aiohttp import BodyPartReader

    found: list[Handed] = []
    room = LARGEST
    async for part in await request.multipart():
        if len(found) == MOST:
            raise ValueError(f"more than {MOST} files were dropped; drop the folder of one series.")
        kept = folder / str(len(found))
        if not isinstance(part, BodyPartReader):
            raise ValueError("a file is expected in every part.")
        room -= await _written(part, kept, room)
        found.append(Handed(name=unquote(part.name or ""), content=kept))
    return found


async def _written(part: BodyPartReader, kept: Path, room: int) -> int:
    size = 0
    with kept.open("wb") as file:
        while chunk := await part.read_chunk(CHUNK):
            size += len(chunk)
            if size > room:
                raise ValueError(f"the files are larger than {LARGEST // 2**30} GB together; open them by their path instead.")
            await asyncio.to_thread(file.write, chunk)
    return size
