"""The process of one window: ``python -m validation.app.window FOLDER FD``, started by the door and by nobody else.

The first line of standard input says the door's secret and what to begin with; the port that this process listens on goes out
on FD. Whatever comes later to standard input is nothing: it is held open so that its end is the end of this process.
"""

from __future__ import annotations

import asyncio
import json
import os
import re
import sys
import tempfile
from collections.abc import Awaitable, Callable, Mapping
from functools import cache
from html import escape
from pathlib import Path
from secrets import token_hex
from typing import TYPE_CHECKING, Any
from urllib.parse import unquote

from geometry.dynamic_mass import SIGNS
from geometry.errors import BadInput, CheckFailed
from validation.app import curves, options, panels, state, transfer, workers
from validation.app.opening import EXAMPLES, LARGEST, MOST, Handed
from validation.app.options import DOOR_SECRET, NEVER_KEPT, StartOptions
from validation.app.server import same
from validation.app.state import WindowState, keep
from validation.output import from_json
from validation.report.charts.maps import LOADS, MOTIONS, entry
from validation.report.charts.style import unit
from validation.study import Options

if TYPE_CHECKING:
    from aiohttp import BodyPartReader, web


# The HTML that a window begins with: trame's own client under our title, without a script inside the page.
#
# trame's `index.html` forbids zooming and holds an inline script, which the policy of `headers` rightly stops.


SERVED = "__massline"
"""Under which the files of `www` are served."""

WWW = Path(__file__).with_name("www")

SHELL = """<!doctype html>
<html lang="en" data-app-name="massline" data-launcher-retry="[]">
  <head>
    <meta charset="utf-8">
    <meta name="viewport" content="width=device-width, initial-scale=1">
    <meta name="color-scheme" content="light dark">
    <title>massline</title>
    <link rel="icon" href="{served}/icon.svg" type="image/svg+xml">
    <link rel="stylesheet" href="{style}">
    <link rel="stylesheet" href="{served}/start.css">
    <script src="vue.global.js"></script>
    <script src="{served}/start.js" data-module="{module}"></script>
  </head>
  <body>
    <noscript>The workbench needs JavaScript, which is switched off in this browser.</noscript>
    <div id="app"><p class="begins" role="status">The workbench begins ...</p></div>
  </body>
</html>
"""


def html(client: Path) -> str:
    """The first page, around the client in the folder `client` that trame brings.

    Raises
    ------
    LookupError : that client is laid out otherwise than the locked version.
    """
    text = (client / "index.html").read_text(encoding="utf-8")
    return SHELL.format(
        served=SERVED,
        module=_found(r'<script type="module"[^>]* src="([^"]+)"', text),
        style=_found(r'rel="stylesheet"[^>]* href="([^"]+)"', text),
    )


def _found(pattern: str, text: str) -> str:
    match = re.search(pattern, text)
    if match is None:
        raise LookupError(f"trame's index.html holds nothing like {pattern}")
    return escape(match[1])


def main(folder: Path, told: int) -> None:
    """Serve the window whose state lives in `folder`; the port goes out on the file descriptor `told`."""
    line = b""
    while not line.endswith(b"\n"):
        some = os.read(0, 65536)
        if not some:
            raise SystemExit("the door is gone")
        line += some
    said = json.loads(line)
    options.tied()
    example, asked = said["opened"]["example"], said["opened"]["asked"]
    opened = StartOptions(example=example, asked=None if asked is None else from_json(Options, asked))
    from trame.app import get_server

    secret = said["secret"]
    key = token_hex(32)  # nothing that begins with a dash: it becomes an argument
    sys.argv = [sys.argv[0], "--authKey", key]  # trame reads its options there; this process has no others
    server = get_server(client_type="vue3")
    window = build(server, folder, opened)
    # What trame's client asks for before it opens its websocket; it writes all of the address in lower case
    server.controller.on_server_bind.add(
        lambda bound: _guard(
            bound.app, secret, {"id": folder.name, "sessionURL": f"ws://use_host/w/{folder.name}/ws", "secret": key}
        )
    )
    server.controller.on_server_bind.add(lambda bound: add(bound.app, window))
    server.controller.on_server_ready.add(lambda **_: _tell(told, server.port))
    server.start(
        port=0,
        host="127.0.0.1",
        thread=True,  # leaves signals to the lifeline
        open_browser=False,
        show_connection_info=False,
        disable_logging=True,
        timeout=0,
    )


def _guard(app: Any, secret: str, session: dict[str, str]) -> None:
    """Nobody but the door is answered. First page and session are ours: they cannot be routes, because trame has routes there."""
    from aiohttp import web
    from trame_client.module import vue3

    first = html(Path(vue3.www))

    @web.middleware
    async def guarded(request: web.Request, handler: Any) -> web.StreamResponse:
        if not same(request.headers.get(DOOR_SECRET, ""), secret):
            return web.Response(status=403, text="massline: this port belongs to a window of the workbench.")
        if request.path == "/":
            return web.Response(text=first, content_type="text/html", headers=NEVER_KEPT)
        if request.path == "/paraview/":
            return web.json_response(session, headers=NEVER_KEPT)
        answer: web.StreamResponse = await handler(request)
        return answer

    app.middlewares.append(guarded)


def _tell(told: int, port: int) -> None:
    os.write(told, f"{port}\n".encode())
    os.close(told)


# The page of a window: its template, what it shows at first, and what each of its buttons does.


PARTS = ("open", "work", "scene", "standing", "missing", "effect", "ladder")
"""Of the template, each replacing its name in capitals."""

WIDE = "($vuetify.display.width >= 1700)"
"""When the structure has room of its own, as in massline.css."""

SCHEMES = {"system": "light", "light": "dark", "dark": "system"}
"""What follows what, when the button for the colours is pressed."""

COLOURS = {
    "light": {"primary": "#20507f", "surface": "#ffffff", "background": "#eef1f5"},
    "dark": {"primary": "#8fc1f3", "surface": "#171b22", "background": "#0f1217", "on-primary": "#0f1217"},
}

Handler = Callable[..., Awaitable[None]]


def build(server: Any, folder: Path, opened: StartOptions) -> WindowState:
    """Lay out the page of `server`, and let it begin when the server runs."""
    from trame.ui.vuetify3 import VAppLayout

    files, name = {SERVED: str(WWW)}, SERVED
    scripts = [f"{name}/{one}.js" for one in ("keys", "massline")]
    own = {"serve": files, "scripts": scripts, "styles": [f"{name}/massline.css"], "vue_use": ["massline"]}
    server.enable_module(own)
    window = WindowState(state=server.state, folder=folder, opened=opened)
    server.state.update(first_state())
    themes = {name: {"dark": name == "dark", "colors": colours} for name, colours in COLOURS.items()}
    with VAppLayout(server, vuetify_config={"theme": {"themes": themes}}) as layout:
        layout.root.clear()
    # The whole page, of its parts
    template_folder = WWW / "page"
    text = (template_folder / "frame.html").read_text(encoding="utf-8")
    for part in PARTS:
        text = text.replace(part.upper(), (template_folder / f"{part}.html").read_text(encoding="utf-8"))
    server.state.trame__template_main = text.replace("WIDE", WIDE)
    server.state.trame__template_error = ENDED
    for name, handler in HANDLERS.items():
        server.controller.trigger(name)(_heard(window, handler))
    server.controller.on_server_ready.add(lambda **_: window.begin(transfer.first(window)))
    return window


ENDED = """<main class="begins" role="alert"><h1>The workbench has ended</h1><p>Its process was stopped, or the machine slept.
Load the page again; if nothing answers, start <code>massline app</code> again.</p></main>"""
"""In place of the page when its server is gone."""


BLANK = "title failure model_path data_paths hold_out band campaign pair_words curve view view_label view_note view_far big step"
NOT_YET = "dark opening unsaved compared correlated view_moves undoable"
NOTHING = "trame__favicon job ready marked pair live node verdict effect fig_ladder fig_inertia"
NO_LIST = "models errors worst remarks campaigns drives responses ranking effects rungs"
NO_TABLE = "before fig_overlay fig_mac fig_shape fig_map"
"""What an empty page has none of: words, switches that are on, things, lists and tables."""


def first_state() -> dict[str, Any]:
    """What an empty page shows; every name that the template asks for is here."""
    return {
        **dict.fromkeys(BLANK.split(), ""),
        **dict.fromkeys(NOT_YET.split(), False),
        **dict.fromkeys(NOTHING.split(), None),
        **{name: [] for name in NO_LIST.split()},
        **{name: {} for name in NO_TABLE.split()},
        "trame__title": "massline",
        "screen": "open",
        "scheme": "system",
        "examples": [{"name": one.name, "title": one.title, "words": one.words} for one in EXAMPLES],
        "faults": {"model": [], "data": [], "options": []},
        "signs": list(SIGNS),
        "entries": [[f"{entry(i, j)}: {LOADS[i]} by {MOTIONS[j]}, in {unit(i, j)}" for j in range(6)] for i in range(6)],
        "peaks": [["" for _ in range(6)] for _ in range(6)],
        "tints": [[0 for _ in range(6)] for _ in range(6)],
        "load": 2,
        "motion": 2,
        "kind": curves.MASS,
        "showing": curves.CURVES,
        "drive": 0,
        "response": 0,
        "choices": {name: [str(one) for one in every] for name, every in curves.CHOICES.items()},
        **{name: every[0] for name, every in curves.CHOICES.items()},
        **{name: one for name, one in state.kept_switches().items() if one in curves.CHOICES.get(name, ())},
        "map_kind": "channels",
        "runs": [{"title": "the worst of all runs", "value": curves.WORST_OF_ALL}],
        "run": -1,
        "modes": [{"title": "Structure and sensors", "value": panels.AT_REST}],
        "mode": panels.AT_REST,
        "tab": "structure",
        "part": "fails",
    }


async def _dark(window: WindowState, dark: bool) -> None:
    if window.state.dark != bool(dark):
        window.state.dark = bool(dark)
        window.state.flush()
        if window.compared is not None:
            await panels.redrawn(window)


async def _scheme(window: WindowState) -> None:
    window.state.scheme = SCHEMES[window.state.scheme]


async def _tab(window: WindowState, name: str) -> None:
    window.state.tab = str(name)


async def _part(window: WindowState, name: str) -> None:
    window.state.part = str(name)


async def _enlarge(window: WindowState, name: str) -> None:
    window.state.big = "" if window.state.big == name else str(name)


async def _seen(window: WindowState) -> None:
    window.state.failure, window.state.ready = "", None


async def _another(window: WindowState) -> None:
    """Back to the page on which things are opened; the session in use stays as it is."""
    window.state.screen = "open" if window.state.screen == "work" else "work"


async def _compare(window: WindowState) -> None:
    state.start(window, workers.COMPARE, panels.stands)


async def _diagnose(window: WindowState) -> None:
    state.start(window, workers.DIAGNOSE, panels.diagnosing_shown)


_SAME: tuple[Handler, ...] = (
    *(transfer.example, state.cancel, panels.entry, panels.function, panels.switch, panels.showing),
    *(panels.matched, panels.marked, panels.cell, panels.spot, panels.campaign, panels.mode, panels.node),
    *(curves.drag, curves.size, panels.add, panels.undo, transfer.report, transfer.figures),
)

HANDLERS: Mapping[str, Handler] = {
    "dark": _dark,
    "scheme": _scheme,
    "tab": _tab,
    "part": _part,
    "enlarge": _enlarge,
    "seen": _seen,
    "another": _another,
    **{one.__name__: one for one in _SAME},
    "open": transfer.paths,
    "compare": _compare,
    "map": panels.show_map,
    "run": panels.show_run,
    "try": panels.try_here,
    "diagnose": _diagnose,
    "effect": curves.chosen,
    "rung": panels.go,
}
"""By the name under which the template triggers it."""


def _heard(window: WindowState, handler: Handler) -> Callable[..., Awaitable[None]]:
    async def heard(*arguments: Any) -> None:
        await window.told(handler(window, *arguments))
        if handler is not curves.drag:  # which keeps what it comes to at rest
            keep(window)

    return heard


# What a window serves beside its page: pictures, downloads, and the way in for dropped files.


CHUNK = 2**20


def add(app: Any, window: WindowState) -> None:
    """Put the routes into the window's server."""

    async def view(request: web.Request) -> web.Response:
        return await _view(request, window)

    async def saved(request: web.Request) -> web.Response:
        from aiohttp import web

        name = request.match_info["name"]
        try:
            body, kind = transfer.content(window, name)
        except (LookupError, BadInput):
            return web.Response(
                status=404, text="massline: there is nothing to be saved under this name yet.", headers=NEVER_KEPT
            )
        # Always a download: a report has scripts of its own, which are not this page's.
        headers = {**NEVER_KEPT, "Content-Disposition": f'attachment; filename="{transfer.SAVING_BESIDE.get(name, name)}"'}
        return web.Response(body=body, content_type=kind, headers=headers)

    async def files(request: web.Request) -> web.Response:
        return await _files(request, window)

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
    from validation.report.charts.interactive import library

    return library().encode()


async def _view(request: web.Request, window: WindowState) -> web.Response:
    from aiohttp import web

    try:
        body = await window.drawn(panels.picture, window, dict(request.query))
    except (ValueError, LookupError, CheckFailed) as error:
        return web.Response(status=404, text=f"massline: {error}", headers=NEVER_KEPT)
    return web.Response(body=body, content_type="image/jpeg", headers=NEVER_KEPT)


async def _files(request: web.Request, window: WindowState) -> web.Response:
    """Files as the page sends them, each part named like its file, folders included; the session says what becomes of names."""
    from aiohttp import web

    with tempfile.TemporaryDirectory(dir=window.folder, prefix="arriving-") as folder:
        try:
            files = await _parts(request, Path(folder))
        except ValueError as error:
            return web.Response(status=413, text=f"massline: {error}")
        await window.told(transfer.arrived(window, files))
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


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
