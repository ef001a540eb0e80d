"""The front door: the only address that a browser sees. It lets in, starts windows, and passes on; it shows nothing itself."""

from __future__ import annotations

import asyncio
import re
import signal
import socket
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geometry.errors import BadInput, CheckFailed
from validation.app import guard
from validation.app.asked import Asked, is_loopback
from validation.app.entry import Entry, cookie_name
from validation.app.guard import Place, Refusal
from validation.app.headers import NEVER_KEPT, SECURITY
from validation.app.passing import is_websocket, joined, passed
from validation.app.windows import Windows

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable

    from aiohttp import ClientSession, web

NAME = re.compile(r"[a-z0-9]{8,64}")
"""What a window may be called: nothing that could be a path, and no capitals, because trame's client drops them."""

LARGEST_UPLOAD = 2 * 2**30
"""Bytes of one request: a series of campaigns dropped on the page. The desk has a limit of its own."""


@dataclass(frozen=True, kw_only=True)
class Door:
    """What the handlers share."""

    place: Place
    entry: Entry
    windows: Windows
    client: ClientSession
    say: Callable[[str], None]


def run(asked: Asked, say: Callable[[str], None]) -> None:
    """Serve until Ctrl-C, or until the last page has been closed; `say` gets the address and what else a user should read.

    Raises
    ------
    BadInput : the port is taken, or the host is none of this machine.
    """
    with _bound(asked) as bound, tempfile.TemporaryDirectory(prefix="massline-app-") as home:
        asyncio.run(_served(asked, bound, Path(home), say))


def _bound(asked: Asked) -> socket.socket:
    try:
        return socket.create_server((asked.host, asked.port))
    except (OSError, OverflowError) as error:
        problem = f"{asked.host}:{asked.port} cannot be listened on: {getattr(error, 'strerror', None) or error}"
        raise BadInput(source="--port", problem=problem, remedy="Choose another port, or 0 for any that is free") from None


async def _served(asked: Asked, bound: socket.socket, home: Path, say: Callable[[str], None]) -> None:
    from aiohttp import ClientSession, ClientTimeout, TCPConnector, web

    ended = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        asyncio.get_running_loop().add_signal_handler(number, ended.set)
    connector, patience = TCPConnector(limit=0), ClientTimeout(total=None)
    async with ClientSession(auto_decompress=False, timeout=patience, connector=connector) as client:
        windows = Windows(home=home, opened=asked.opened)
        place = Place(host=asked.host, port=bound.getsockname()[1])
        door = Door(place=place, entry=Entry(), windows=windows, client=client, say=say)
        runner = web.AppRunner(application(door), access_log=None, shutdown_timeout=1.0)
        await runner.setup()
        await web.SockSite(runner, bound).start()
        windows.ready()
        _announce(asked, door, say)
        if asked.linger is not None:
            windows.emptied = partial(_end_in, asked.linger, windows, ended)
        try:
            await ended.wait()
        finally:
            await windows.end()
            await runner.cleanup()


def _end_in(seconds: float, windows: Windows, ended: asyncio.Event) -> None:
    asyncio.get_running_loop().call_later(seconds, lambda: None if windows.any_alive() else ended.set())


def _announce(asked: Asked, door: Door, say: Callable[[str], None]) -> None:
    shown = "127.0.0.1" if asked.host in ("0.0.0.0", "::", "localhost") else asked.host
    address = f"http://{shown}:{door.place.port}/?token={door.entry.token}"
    if not is_loopback(asked.host):
        say(
            f"Warning: --host {asked.host} lets other machines reach this page, unencrypted: whoever reads along can do what "
            "you can with your files. Without --host only this machine can."
        )
    end = "Ctrl-C ends it." if asked.linger is None else "Ctrl-C ends it, and so does closing its last page."
    say(f"The workbench is at\n  {address}\nThe address is good once. {end}")
    if asked.browser:
        import webbrowser

        with suppress(webbrowser.Error):
            webbrowser.open(address)


def application(door: Door) -> web.Application:
    """The door's handlers behind its guard."""
    from aiohttp import web

    async def came(request: web.Request) -> web.StreamResponse:
        return await _came(request, door)

    async def entered(request: web.Request) -> web.StreamResponse:
        raise web.HTTPSeeOther(f"/w/{door.windows.new()}/")

    async def is_open(request: web.Request) -> web.StreamResponse:
        return web.json_response({"open": door.windows.is_open(_name(request))})

    async def shown(request: web.Request) -> web.StreamResponse:
        return await _shown(request, door)

    @web.middleware
    async def guarded(
        request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
    ) -> web.StreamResponse:
        refusal = guard.refused(door.place, request.headers, method=request.method, websocket=is_websocket(request))
        if refusal is not None:
            return _said(refusal)
        if request.path == "/" and "token" in request.query:
            return await came(request)
        if not door.entry.admits(request.cookies.get(cookie_name(door.place.port))):
            return _said(guard.NO_SESSION)
        return await handler(request)

    async def secured(_: web.Request, response: web.StreamResponse) -> None:
        response.headers.update(SECURITY)
        response.headers.setdefault("Cache-Control", "no-cache")
        response.headers.popall("Server", None)

    app = web.Application(middlewares=[guarded], client_max_size=LARGEST_UPLOAD)
    app.on_response_prepare.append(secured)
    app.router.add_get("/", entered)
    app.router.add_get("/w/{name}/open", is_open)
    app.router.add_route("*", "/w/{name}/{path:.*}", shown)
    return app


async def _came(request: web.Request, door: Door) -> web.StreamResponse:
    """The token for a cookie, once; the address that the browser keeps does not have it any more."""
    from aiohttp import web

    session = door.entry.exchanged(request.query["token"])
    cookie = cookie_name(door.place.port)
    if session is None and not door.entry.admits(request.cookies.get(cookie)):
        return _said(guard.NO_SESSION)
    onward = web.HTTPSeeOther("/", headers=NEVER_KEPT)
    if session is not None:
        onward.set_cookie(cookie, session, httponly=True, samesite="Strict", path="/")
    raise onward


async def _shown(request: web.Request, door: Door) -> web.StreamResponse:
    """What a window's own server answers."""
    name = _name(request)
    try:
        window = await door.windows.window(name)
    except CheckFailed as error:
        door.say(f"massline: {error}.")
        return _said(Refusal(status=503, text=str(error)))
    onward: dict[str, Any] = {"port": window.port, "path": request.match_info["path"], "secret": door.windows.secret}
    if not is_websocket(request):
        return await passed(request, door.client, **onward)
    door.windows.page_opened(window)
    try:
        return await joined(request, door.client, **onward)
    finally:
        door.windows.page_closed(window)


def _name(request: web.Request) -> str:
    from aiohttp import web

    name = request.match_info["name"]
    if not NAME.fullmatch(name):
        raise web.HTTPNotFound(text="massline: there is no such window.")
    return name


def _said(refusal: Refusal) -> web.Response:
    from aiohttp import web

    return web.Response(status=refusal.status, text=f"massline: {refusal.text}", headers=NEVER_KEPT)
