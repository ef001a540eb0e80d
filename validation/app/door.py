"""The front door: the only address that a browser sees. It lets in, starts windows, and passes on; it shows nothing itself."""

from __future__ import annotations

import asyncio
import os
import re
import signal
import socket
import tempfile
from contextlib import suppress
from dataclasses import dataclass
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING, Any

from geometry.errors import BadInput, CheckFailed
from validation.app import guard, leaving
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


REFRESH = """<!doctype html><html lang="en"><meta charset="utf-8"><meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={address}"><title>massline</title>
<p><a href="{address}">The workbench</a></p></html>
"""
"""A page that leads to another."""


GONE = Refusal(status=503, text="this window's process has ended. Load the page again.")


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
        leaving.kept(Path(home), say)


def _bound(asked: Asked) -> socket.socket:
    try:
        family = socket.AF_INET6 if ":" in asked.host else socket.AF_INET
        return socket.create_server((asked.host, asked.port), family=family)
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
            windows.emptied = _Linger(asked.linger, windows, ended).begin
        try:
            await ended.wait()
        finally:
            await windows.end()
            await runner.cleanup()


class _Linger:
    """One clock for the door: begun anew with every last page that is closed, and heeded only if none is there then."""

    def __init__(self, seconds: float, windows: Windows, ended: asyncio.Event) -> None:
        self._seconds, self._windows, self._ended = seconds, windows, ended
        self._clock: asyncio.TimerHandle | None = None

    def begin(self) -> None:
        if self._clock is not None:
            self._clock.cancel()
        self._clock = asyncio.get_running_loop().call_later(self._seconds, self._over)

    def _over(self) -> None:
        if not self._windows.any_alive():
            self._ended.set()


def _announce(asked: Asked, door: Door, say: Callable[[str], None]) -> None:
    shown = {"0.0.0.0": "127.0.0.1", "::": "[::1]"}.get(asked.host, f"[{asked.host}]" if ":" in asked.host else asked.host)
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
            webbrowser.open(leading(address, door.windows.home).as_uri())


def leading(address: str, home: Path) -> Path:
    """A page in the file system, for this user's eyes only, that leads to `address`.

    The system's browser is told this file's name: whatever stands in a command line can be read by every user of the machine.
    """
    page = home / "enter.html"
    descriptor = os.open(page, os.O_WRONLY | os.O_CREAT | os.O_TRUNC, 0o600)
    with os.fdopen(descriptor, "w", encoding="utf-8") as file:
        file.write(REFRESH.format(address=escape(address)))
    return page


def application(door: Door) -> web.Application:
    """The door's handlers behind its guard."""
    from aiohttp import web

    async def came(request: web.Request) -> web.StreamResponse:
        return await _came(request, door)

    async def entered(request: web.Request) -> web.StreamResponse:
        raise web.HTTPSeeOther(f"/w/{door.windows.new()}/")

    async def is_open(request: web.Request) -> web.StreamResponse:
        return web.json_response({"open": door.windows.is_open(_name(request, door.windows))})

    async def shown(request: web.Request) -> web.StreamResponse:
        return await _shown(request, door)

    @web.middleware
    async def guarded(
        request: web.Request, handler: Callable[[web.Request], Awaitable[web.StreamResponse]]
    ) -> web.StreamResponse:
        entering = request.path == "/" and request.method == "GET" and "token" in request.query
        joining = is_websocket(request)
        refusal = guard.refused(door.place, request.headers, method=request.method, websocket=joining, entering=entering)
        if refusal is not None:
            return _said(refusal)
        if entering:
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
    onward: web.Response = web.Response(status=303, headers={**NEVER_KEPT, "Location": "/"})
    if request.headers.get("Sec-Fetch-Site") == "cross-site":
        # From the file of `leading`. A cookie that is strict does not go along when that is sent on; it does from a page of ours.
        onward = web.Response(text=REFRESH.format(address="/"), content_type="text/html", headers=NEVER_KEPT)
    if session is not None:
        onward.set_cookie(cookie, session, httponly=True, samesite="Strict", path="/")
    return onward


async def _shown(request: web.Request, door: Door) -> web.StreamResponse:
    """What a window's own server answers."""
    name = _name(request, door.windows)
    try:
        window = await door.windows.window(name)
    except CheckFailed as error:
        door.say(f"massline: {error}.")
        return _said(Refusal(status=503, text=str(error)))
    onward: dict[str, Any] = {"port": window.port, "path": request.match_info["path"], "secret": door.windows.secret}
    from aiohttp import ClientConnectorError

    try:
        if not is_websocket(request):
            return await passed(request, door.client, **onward)
        door.windows.page_opened(window)
        try:
            return await joined(request, door.client, **onward)
        finally:
            door.windows.page_closed(window)
    except ClientConnectorError:  # its process died since it was asked for; nothing of an answer has been sent
        return _said(GONE)


def _name(request: web.Request, windows: Windows) -> str:
    from aiohttp import web

    name = request.match_info["name"]
    if not NAME.fullmatch(name) or not windows.gave(name):
        raise web.HTTPNotFound(text="massline: there is no such window. The address without a name opens a new one.")
    return name


def _said(refusal: Refusal) -> web.Response:
    from aiohttp import web

    return web.Response(status=refusal.status, text=f"massline: {refusal.text}", headers=NEVER_KEPT)
