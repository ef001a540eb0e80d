"""The process of one window: ``python -m validation.app.window FOLDER FD``, started by the door and by nobody else.

The first line of standard input says the door's secret and what to begin with; the port that this process listens on goes out
on FD. Whatever comes later to standard input is nothing: it is held open so that its end is the end of this process.
"""

from __future__ import annotations

import json
import os
import sys
from pathlib import Path
from secrets import token_hex
from typing import Any

from validation.app import lifeline, shell
from validation.app.asked import Opened
from validation.app.entry import same
from validation.app.headers import DOOR_SECRET, NEVER_KEPT


def main(folder: Path, told: int) -> None:
    """Serve the window whose state lives in `folder`; the port goes out on the file descriptor `told`."""
    said = json.loads(_first_line())
    lifeline.tied()
    begun = said["opened"]
    band = begun["band"]
    opened = Opened(
        **begun
        | {
            "data": tuple(begun["data"]),
            "hold_out": tuple(begun["hold_out"]),
            "effects_from": tuple(begun["effects_from"]),
            "band": None if band is None else (band[0], band[1]),
        }
    )
    _serve(folder, opened, said["secret"], told)


def _serve(folder: Path, opened: Opened, secret: str, told: int) -> None:
    from trame.app import get_server

    from validation.app import page, routes

    key = token_hex(32)  # nothing that begins with a dash: it becomes an argument
    sys.argv = [sys.argv[0], "--authKey", key]  # trame reads its options there; this process has no others
    server = get_server(client_type="vue3")
    bench = page.build(server, folder, opened)
    server.controller.on_server_bind.add(lambda bound: _guard(bound.app, secret, _session(folder.name, key)))
    server.controller.on_server_bind.add(lambda bound: routes.add(bound.app, bench))
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


def _session(name: str, key: str) -> dict[str, str]:
    """What trame's client asks for before it opens its websocket; it writes all of the address in lower case."""
    return {"id": name, "sessionURL": f"ws://use_host/w/{name}/ws", "secret": key}


def _guard(app: Any, secret: str, session: dict[str, str]) -> None:
    """Nobody but the door is answered. First page and session are ours: they cannot be routes, because trame has routes there."""
    from aiohttp import web
    from trame_client.module import vue3

    first = shell.html(Path(vue3.www))

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


def _first_line() -> bytes:
    line = b""
    while not line.endswith(b"\n"):
        some = os.read(0, 65536)
        if not some:
            raise SystemExit("the door is gone")
        line += some
    return line


if __name__ == "__main__":
    main(Path(sys.argv[1]), int(sys.argv[2]))
