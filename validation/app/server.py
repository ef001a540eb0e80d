"""The front door: the only address that a browser sees. It lets in, starts windows, and passes on; it shows nothing itself."""

from __future__ import annotations

import asyncio
import contextlib
import json
import os
import re
import signal
import socket
import sys
import tempfile
from contextlib import suppress
from dataclasses import asdict, dataclass, field
from hmac import compare_digest
from html import escape
from ipaddress import ip_address
from pathlib import Path
from secrets import token_hex, token_urlsafe
from typing import TYPE_CHECKING, Any

from geometry.errors import BadInput, CheckFailed
from validation.app import options, state
from validation.app.options import DOOR_SECRET, NEVER_KEPT, SECURITY, WorkbenchOptions, is_loopback
from validation.report.charts.interactive import without_addresses

if TYPE_CHECKING:
    from collections.abc import Awaitable, Callable, Coroutine, Mapping

    from aiohttp import ClientSession, web
    from yarl import URL

    from validation.app.options import StartOptions


# Who may come in: a token that is good once, and the cookie that it is exchanged for.
#
# The token stands in the address, so it may end up in a history or over somebody's shoulder; it is spent at its first use. The
# cookie that takes its place cannot be read by a script (``HttpOnly``) and is never sent by another site (``SameSite=Strict``).
# Cookies know no ports, so its name carries that of the door: two doors do not put each other's windows out.


class AccessToken:
    """The one token of a door, and the session that follows from it."""

    def __init__(self) -> None:
        self.token = token_urlsafe(24)
        self._session = token_urlsafe(32)
        self._spent = False

    def exchanged(self, token: str) -> str | None:
        """The session's secret for the token, the first time; None for a wrong one or one that is spent."""
        if self._spent or not same(token, self.token):
            return None
        self._spent = True
        return self._session

    def admits(self, session: str | None) -> bool:
        """Whether `session`, as a cookie brought it, is the one that was given out."""
        return self._spent and session is not None and same(session, self._session)


def cookie_name(port: int) -> str:
    """The name of the cookie of the door at `port`."""
    return f"massline-{port}"


def same(found: str, expected: str) -> bool:
    """Whether two secrets are equal, in a time that does not tell where they differ."""
    return compare_digest(found.encode("utf-8", "replace"), expected.encode())


# What a request must be before anything answers it: to this host, from this page, by somebody who was let in.
#
# - **Host.** A foreign name that was made to resolve to 127.0.0.1 (DNS rebinding) still says its own name here, and is refused.
# - **Origin.** A page of another site may send requests and open websockets to this machine, and a browser says from where.
#   Whatever changes something, and every websocket, must say that it comes from here.
# - **Site.** A page of another server on this machine is of the same site, since cookies and sites know no ports. Browsers that
#   say
#   where a request comes from (``Sec-Fetch-Site``) must say: this page, or the user. Only the token may come from anywhere.
# - **Session.** The cookie of `entry`. The browser sends it to every server at this host, whatever its port: a program that
#   serves
#   pages on this machine and is not to be trusted could take it over. Nothing but a name for every door would help against that.


READING = ("GET", "HEAD")

HTTP = 80
"""The port that an address need not name."""


@dataclass(frozen=True, kw_only=True)
class Refusal:
    """Why a request is not answered, as a status of HTTP and a sentence."""

    status: int
    text: str


@dataclass(frozen=True, kw_only=True)
class ListeningAddress:
    """Where the door stands: the address it listens on, and its port."""

    host: str
    port: int

    def answers_to(self, name: str) -> bool:
        """Whether `name`, a Host header, means this door and cannot have come from a foreign name."""
        host, _, port = name.rpartition(":")
        if not host and self.port == HTTP:  # a browser leaves it out
            host, port = name, str(HTTP)
        if port != str(self.port) or not host:
            return False
        host = host.strip("[]")
        if host.lower() in ("127.0.0.1", "::1", "localhost", self.host.lower()):
            return True
        with suppress(ValueError):  # a numeric address: those no name server can bend
            return not is_loopback(self.host) and bool(ip_address(host))
        return False


def refused(
    place: ListeningAddress, headers: Mapping[str, str], *, method: str, websocket: bool, entering: bool = False
) -> Refusal | None:
    """Why a request with `headers` is not answered whoever sends it; None if it may go on to be asked for its session.

    `entering` is one that brings the token.
    """
    host = headers.get("Host", "")
    if not place.answers_to(host):
        return Refusal(status=403, text="this address serves no other host; open the one that the terminal shows.")
    origin = headers.get("Origin")
    if origin is None:
        if websocket or method not in READING:
            return Refusal(status=403, text="a request that changes something must say which page sends it.")
    elif origin.lower() != f"http://{host.lower()}":
        return Refusal(status=403, text="a page of another origin may not ask this one.")
    if not entering and headers.get("Sec-Fetch-Site", "none") not in ("none", "same-origin"):
        return Refusal(status=403, text="a page of another server may not ask this one.")
    return None


NO_SESSION = Refusal(
    status=401,
    text="this page opens with the address that the terminal shows, once, and in one browser. "
    "If that address has been used, start `massline app` again.",
)


# Passing requests and websockets on to a window's own server, and its answers back.


LARGEST_MESSAGE = 64 * 2**20
"""Bytes of one message of a websocket: a page's whole state with room to spare."""

HEARTBEAT = 20.0
"""Seconds between two questions whether the page is still there: a laptop that is shut says no word of farewell."""

HOP_BY_HOP = {"connection", "keep-alive", "te", "trailer", "transfer-encoding", "upgrade", "host", "cookie", "content-length"}
"""Headers that speak of one connection only, and the cookie, which is the door's."""

SCRIPTS = ("text/javascript", "application/javascript")
"""Types of what a browser runs, ours and that of the libraries."""


def is_websocket(request: web.BaseRequest) -> bool:
    """Whether the request asks to become a websocket."""
    return request.headers.get("Upgrade", "").lower() == "websocket"


async def passed(request: web.Request, client: ClientSession, *, port: int, path: str, secret: str) -> web.StreamResponse:
    """The answer of the server at `port` to `request`, for `path`, handed through as it comes; a script without its addresses.

    Raises
    ------
    aiohttp.ClientError, ConnectionError : that server is gone; nothing of an answer has been sent.
    """
    from aiohttp import ClientError, web

    headers = {key: value for key, value in request.headers.items() if key.lower() not in HOP_BY_HOP}
    headers |= {DOOR_SECRET: secret, "Accept-Encoding": "identity"}  # scripts are read on their way
    async with client.request(
        request.method,
        _address(port, path, request),
        headers=headers,
        data=request.content if request.body_exists else None,
        allow_redirects=False,
    ) as answer:
        kept = {key: value for key, value in answer.headers.items() if key.lower() not in HOP_BY_HOP}
        if answer.content_type in SCRIPTS and request.method == "GET" and answer.status == 200:
            return web.Response(body=without_addresses(await answer.text("utf-8")).encode(), headers=kept)
        response = web.StreamResponse(status=answer.status, headers=kept)
        if answer.content_length is not None:
            response.content_length = answer.content_length
        await response.prepare(request)
        try:
            async for chunk in answer.content.iter_chunked(2**16):
                await response.write(chunk)
            await response.write_eof()
        except (ClientError, ConnectionError):  # one end is gone in the middle, and no other answer can be given any more
            if request.transport is not None:
                request.transport.abort()
        return response


async def joined(request: web.Request, client: ClientSession, *, port: int, path: str, secret: str) -> web.WebSocketResponse:
    """A websocket of the page joined with one to the server at `port`, until either end closes."""
    from aiohttp import web

    page = web.WebSocketResponse(max_msg_size=LARGEST_MESSAGE, compress=False, heartbeat=HEARTBEAT)
    async with client.ws_connect(
        _address(port, path, request), headers={DOOR_SECRET: secret}, max_msg_size=LARGEST_MESSAGE
    ) as server:
        await page.prepare(request)
        ways = [asyncio.ensure_future(_carried(page, server)), asyncio.ensure_future(_carried(server, page))]
        try:
            await asyncio.wait(ways, return_when=asyncio.FIRST_COMPLETED)
        finally:
            for way in ways:
                way.cancel()
            await page.close()
    return page


async def _carried(source: Any, target: Any) -> None:
    from aiohttp import WSMsgType

    with contextlib.suppress(ConnectionError):  # the other end is gone, which ends both ways
        async for message in source:
            if message.type == WSMsgType.BINARY:
                await target.send_bytes(message.data)
            elif message.type == WSMsgType.TEXT:
                await target.send_str(message.data)


def _address(port: int, path: str, request: web.Request) -> URL:
    from yarl import URL

    return URL.build(scheme="http", host="127.0.0.1", port=port, path=f"/{path}", query_string=request.query_string)


# One process a window of the browser: started when its page is asked for, ended when its last page has been closed for a while.
#
# trame keeps one state a server; two windows in one server would pull each other's sliders. Here each window has a server of its
# own, in a process of its own, on a port of its own that answers nobody who does not know the door's secret.


STARTS_WITHIN = 60.0
"""Seconds that a window's process may take until it answers: patience for a laptop that is busy."""

LINGERS = 3.0
"""Seconds that a process stays after its last page was closed; a reload asks for its page again in less than one."""

NEVER_OPENED = 120.0
"""Seconds after which a process ends that was asked for something and then got no page: a browser may be slow to load it all."""

MOST = 32
"""Processes at once."""


@dataclass(kw_only=True)
class Window:
    """A window's process, as the door sees it.

    Attributes
    ----------
    process : leader of a group of its own, its workers in it
    port : loopback port of its server
    pages : how many pages hold a websocket to it
    ends : what will end it, while no page is open
    """

    process: asyncio.subprocess.Process
    port: int
    pages: int = 0
    ends: asyncio.TimerHandle | None = None


@dataclass(kw_only=True)
class Windows:
    """All windows of a door, by their names.

    Attributes
    ----------
    home : folder that holds a folder for each window
    opened : what a new window begins with
    emptied : called when the last process has ended
    secret : what the door says to the servers of windows
    """

    home: Path
    opened: StartOptions
    emptied: Callable[[], None] = lambda: None
    secret: str = field(default_factory=lambda: token_urlsafe(32))
    _by_name: dict[str, asyncio.Task[Window]] = field(default_factory=dict)
    _spare: str = ""
    _given: set[str] = field(default_factory=set)
    _beside: set[asyncio.Task[None]] = field(default_factory=set)

    def ready(self) -> None:
        """Let a process start before its page is asked for: it then stands there at once."""
        self._spare = token_hex(9)
        self._by_name[self._spare] = asyncio.ensure_future(self._started(self._spare))

    def new(self) -> str:
        """The name of a window that no page has yet."""
        name, self._spare = self._spare or token_hex(9), ""
        self._given.add(name)
        return name

    def gave(self, name: str) -> bool:
        """Whether `name` is one of `new`: no process begins under a name that somebody thought of."""
        return name in self._given

    async def window(self, name: str) -> Window:
        """The window called `name`, its process started if there is none.

        Raises
        ------
        CheckFailed : it does not start, and its log says why; or there are too many.
        """
        task = self._by_name.get(name)
        if task is None or (task.done() and not _alive(task)):
            if sum(_alive(one) or not one.done() for one in self._by_name.values()) >= MOST:
                raise CheckFailed(f"{MOST} windows are open already; close one of them")
            task = asyncio.ensure_future(self._started(name))
            self._by_name[name] = task
        window = await asyncio.shield(task)
        if window.pages == 0:  # a reload that takes its time keeps the process with whatever it computes
            self._end_in(NEVER_OPENED, window)
        return window

    def is_open(self, name: str) -> bool:
        """Whether a page holds the window called `name`."""
        task = self._by_name.get(name)
        return task is not None and task.done() and _alive(task) and task.result().pages > 0

    def any_alive(self) -> bool:
        """Whether any window's process runs, or is about to."""
        return any(_alive(task) or not task.done() for task in self._by_name.values())

    def page_opened(self, window: Window) -> None:
        """A page has taken up its websocket."""
        window.pages += 1
        _cancel(window)

    def page_closed(self, window: Window) -> None:
        """A page has let go of it; the last one starts the clock."""
        window.pages -= 1
        if window.pages == 0:
            self._end_in(LINGERS, window)

    async def end(self) -> None:
        """End every window, and see all of them gone."""
        for task in self._by_name.values():
            if not task.done():
                task.cancel()
        await asyncio.gather(*(self._ended(task.result()) for task in self._by_name.values() if _alive(task)))

    def _end_in(self, seconds: float, window: Window) -> None:
        _cancel(window)
        window.ends = asyncio.get_running_loop().call_later(seconds, lambda: self._run(self._ended(window)))

    async def _started(self, name: str) -> Window:
        folder = self.home / name
        folder.mkdir(mode=0o700, exist_ok=True)
        process, port = await _spawned(folder, self.secret, self.opened)
        window = Window(process=process, port=port)
        self._run(self._watched(window))
        return window

    def _run(self, work: Coroutine[None, None, None]) -> None:
        """Run `work` beside everything else; the loop itself keeps no hold of it."""
        task = asyncio.ensure_future(work)
        self._beside.add(task)
        task.add_done_callback(self._beside.discard)

    async def _watched(self, window: Window) -> None:
        await window.process.wait()
        _cancel(window)
        _end_group(window.process)  # workers that a crash left behind
        await asyncio.to_thread(options.collect, window.process.pid)
        if not self.any_alive():
            self.emptied()

    async def _ended(self, window: Window) -> None:
        _end_group(window.process)
        await window.process.wait()
        await asyncio.to_thread(options.collect, window.process.pid)


async def _spawned(folder: Path, secret: str, opened: StartOptions) -> tuple[asyncio.subprocess.Process, int]:
    read_end, write_end = os.pipe()
    log = folder / "window.log"
    try:
        with log.open("ab") as heard:
            # This environment without what would configure the server behind the door's back, and with one thread a window
            kept = {key: value for key, value in os.environ.items() if not key.startswith(("TRAME_", "WSLINK_"))}
            environment = {**kept, "WSLINK_WS_COMPRESS": "0", "PYTHONUNBUFFERED": "1"}
            process = await asyncio.create_subprocess_exec(
                *(sys.executable, "-P", "-m", "validation.app.window", str(folder), str(write_end)),
                stdin=asyncio.subprocess.PIPE,
                stdout=heard,
                stderr=heard,
                pass_fds=(write_end,),
                start_new_session=True,  # Ctrl-C is the door's to hear; and a group of its own is ended as one
                env=environment,
            )
    finally:
        os.close(write_end)
    assert process.stdin is not None
    process.stdin.write(json.dumps({"secret": secret, "opened": asdict(opened)}).encode() + b"\n")
    try:
        return process, await _port(process, read_end, log)
    except BaseException:  # cancelled, too: nobody else knows this process yet
        _end_group(process)
        raise


async def _port(process: asyncio.subprocess.Process, read_end: int, log: Path) -> int:
    """The port that the new process says it listens on, once it does."""
    reader = asyncio.StreamReader()
    transport, _ = await asyncio.get_running_loop().connect_read_pipe(
        lambda: asyncio.StreamReaderProtocol(reader), os.fdopen(read_end, "rb")
    )
    try:
        said = await asyncio.wait_for(reader.readline(), STARTS_WITHIN)
    except TimeoutError:
        said = b""
    finally:
        transport.close()
    if not said:
        lines = log.read_text(errors="replace").strip().splitlines()
        last_line = lines[-1] if lines else "it said nothing"
        raise CheckFailed(f"the window's process did not start: {last_line}", log=log.read_text(errors="replace"))
    return int(said)


def _alive(task: asyncio.Task[Window]) -> bool:
    if not task.done() or task.cancelled() or task.exception() is not None:
        return False
    return task.result().process.returncode is None


def _cancel(window: Window) -> None:
    if window.ends is not None:
        window.ends.cancel()
        window.ends = None


def _end_group(process: asyncio.subprocess.Process) -> None:
    with contextlib.suppress(ProcessLookupError, PermissionError):
        os.killpg(process.pid, signal.SIGKILL)


NAME = re.compile(r"[a-z0-9]{8,64}")
"""What a window may be called: nothing that could be a path, and no capitals, because trame's client drops them."""

LARGEST_UPLOAD = 2 * 2**30
"""Bytes of one request: a series of campaigns dropped on the page. The session has a limit of its own."""


REFRESH = """<!doctype html><html lang="en"><meta charset="utf-8"><meta name="referrer" content="no-referrer">
<meta http-equiv="refresh" content="0; url={address}"><title>massline</title>
<p><a href="{address}">The workbench</a></p></html>
"""
"""A page that leads to another."""


GONE = Refusal(status=503, text="this window's process has ended. Load the page again.")


@dataclass(frozen=True, kw_only=True)
class Door:
    """What the handlers share."""

    place: ListeningAddress
    entry: AccessToken
    windows: Windows
    client: ClientSession
    say: Callable[[str], None]


def run(asked: WorkbenchOptions, say: Callable[[str], None]) -> None:
    """Serve until Ctrl-C, or until the last page has been closed; `say` gets the address and what else a user should read.

    Raises
    ------
    BadInput : the port is taken, or the host is none of this machine.
    """
    try:
        family = socket.AF_INET6 if ":" in asked.host else socket.AF_INET
        listening = socket.create_server((asked.host, asked.port), family=family)
    except (OSError, OverflowError) as error:
        problem = f"{asked.host}:{asked.port} cannot be listened on: {getattr(error, 'strerror', None) or error}"
        raise BadInput("--port", "", problem, "Choose another port, or 0 for any that is free") from None
    options.adopting()
    with listening as bound, tempfile.TemporaryDirectory(prefix="massline-app-") as home:
        asyncio.run(_served(asked, bound, Path(home), say))
        state.leaving_kept(Path(home), say)


async def _served(asked: WorkbenchOptions, bound: socket.socket, home: Path, say: Callable[[str], None]) -> None:
    from aiohttp import ClientSession, ClientTimeout, TCPConnector, web

    ended = asyncio.Event()
    for number in (signal.SIGINT, signal.SIGTERM, signal.SIGHUP):
        asyncio.get_running_loop().add_signal_handler(number, ended.set)
    connector, patience = TCPConnector(limit=0), ClientTimeout(total=None)
    async with ClientSession(auto_decompress=False, timeout=patience, connector=connector) as client:
        windows = Windows(home=home, opened=asked.opened)
        place = ListeningAddress(host=asked.host, port=bound.getsockname()[1])
        door = Door(place=place, entry=AccessToken(), windows=windows, client=client, say=say)
        runner = web.AppRunner(application(door), access_log=None, shutdown_timeout=1.0)
        await runner.setup()
        await web.SockSite(runner, bound).start()
        windows.ready()
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
        refusal = refused(door.place, request.headers, method=request.method, websocket=joining, entering=entering)
        if refusal is not None:
            return _said(refusal)
        if entering:
            return await came(request)
        if not door.entry.admits(request.cookies.get(cookie_name(door.place.port))):
            return _said(NO_SESSION)
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
        return _said(NO_SESSION)
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
    from aiohttp import ClientError

    try:
        if not is_websocket(request):
            return await passed(request, door.client, **onward)
        door.windows.page_opened(window)
        try:
            return await joined(request, door.client, **onward)
        finally:
            door.windows.page_closed(window)
    except (ClientError, ConnectionError):  # its process died since it was asked for; nothing of an answer has been sent
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
