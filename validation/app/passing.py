"""Passing requests and websockets on to a window's own server, and its answers back."""

from __future__ import annotations

import asyncio
from typing import TYPE_CHECKING, Any

from validation.addresses import without_addresses
from validation.app.headers import DOOR_SECRET

if TYPE_CHECKING:
    from aiohttp import ClientSession, web
    from yarl import URL

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
    """The answer of the server at `port` to `request`, for `path`, handed through as it comes; a script without its addresses."""
    from aiohttp import web

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
        async for chunk in answer.content.iter_chunked(2**16):
            await response.write(chunk)
        await response.write_eof()
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

    async for message in source:
        if message.type == WSMsgType.BINARY:
            await target.send_bytes(message.data)
        elif message.type == WSMsgType.TEXT:
            await target.send_str(message.data)


def _address(port: int, path: str, request: web.Request) -> URL:
    from yarl import URL

    return URL.build(scheme="http", host="127.0.0.1", port=port, path=f"/{path}", query_string=request.query_string)
