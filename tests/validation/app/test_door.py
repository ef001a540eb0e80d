"""Nobody comes in who was not let in, whatever way they ask."""

import asyncio
import contextlib
import http.client
import subprocess
import sys
from pathlib import Path
from typing import Any

import pytest

COOKIE = "Set-Cookie"


def answer(bench: Any, path: str = "/", method: str = "GET", **headers: str) -> http.client.HTTPResponse:
    """The answer to one request with exactly these headers."""
    connection = http.client.HTTPConnection("127.0.0.1", bench.port, timeout=20)
    connection.putrequest(method, path, skip_host=True)
    for key, value in {"Host": bench.host, **headers}.items():
        connection.putheader(key.replace("_", "-"), value)
    connection.endheaders()
    response = connection.getresponse()
    response.body = response.read()  # type: ignore[attr-defined]
    connection.close()
    return response


@pytest.fixture(scope="module")
def bench(start_app) -> Any:
    return start_app("--stay")


@pytest.fixture(scope="module")
def cookie(bench) -> str:
    """The cookie that the token is good for, once."""
    response = answer(bench, f"/?token={bench.token}")
    assert response.status == 303
    given = str(response.getheader(COOKIE))
    assert "HttpOnly" in given  # read by no script
    assert "SameSite=Strict" in given  # sent by no other site
    assert given.startswith(f"massline-{bench.port}=")  # shared with no other door: cookies know no ports
    return given.split(";")[0]


def upgrade(bench: Any, path: str, **headers: str) -> int:
    """The status of an attempt at a websocket."""
    asked = {"Connection": "Upgrade", "Upgrade": "websocket", "Sec_WebSocket_Version": "13", "Sec_WebSocket_Key": "A" * 22 + "=="}
    return answer(bench, path, **asked, **headers).status


def test_without_the_token_nothing_is_shown_or_started_and_it_is_good_once_and_leaves_no_trace(bench, cookie):
    for path in ("/", "/w/abcdefgh/", "/w/abcdefgh/index.html", "/?token=", "/?token=wrong", "/anything"):
        assert answer(bench, path).status == 401, path
    assert len(bench.windows()) <= 1  # the one that stands ready
    assert answer(bench, f"/?token={bench.token}").status == 401
    again = answer(bench, f"/?token={bench.token}", Cookie=cookie)  # a reload of the first page, by the browser that was let in
    assert (again.status, again.getheader("Location")) == (303, "/")


@pytest.mark.parametrize(
    "host", ["evil.example", "evil.example:{port}", "127.0.0.1", "127.0.0.1:1", "localhost.evil.example:{port}", ""]
)
def test_another_host_is_not_served(bench, cookie, host):
    named = host.format(port=bench.port)
    assert answer(bench, "/", Host=named, Cookie=cookie).status == 403
    assert upgrade(bench, "/w/abcdefgh/ws", Host=named, Cookie=cookie, Origin=f"http://{named}") == 403


@pytest.mark.parametrize(
    "origin", ["http://evil.example", "https://{host}", "http://127.0.0.1:1", "null", "http://{host}.evil.example"]
)
def test_another_origin_is_refused_by_http_and_by_websocket(bench, cookie, origin):
    named = origin.format(host=bench.host)
    assert answer(bench, "/", Origin=named, Cookie=cookie).status == 403
    assert answer(bench, "/w/abcdefgh/files", method="POST", Origin=named, Cookie=cookie).status == 403
    assert upgrade(bench, "/w/abcdefgh/ws", Origin=named, Cookie=cookie) == 403


def test_what_changes_something_must_say_where_it_comes_from_a_websocket_needs_the_cookie_and_a_window_is_no_path(bench, cookie):
    assert answer(bench, "/w/abcdefgh/files", method="POST", Cookie=cookie).status == 403
    assert upgrade(bench, "/w/abcdefgh/ws", Cookie=cookie) == 403
    assert upgrade(bench, "/w/abcdefgh/ws", Origin=f"http://{bench.host}") == 401
    for name in ("..", "%2e%2e", "..%2f..%2fetc", "short", "x" * 65):
        assert answer(bench, f"/w/{name}/", Cookie=cookie).status in (400, 404), name
    assert len(bench.windows()) <= 1


def test_a_page_of_another_server_at_this_host_starts_nothing(bench, cookie):
    before = bench.windows()
    for site in ("same-site", "cross-site"):
        for path in ("/", "/w/aaaaaaaa1/", "/w/aaaaaaaa2/plotly.js"):
            assert answer(bench, path, Cookie=cookie, Sec_Fetch_Site=site).status == 403
    assert answer(bench, "/w/aaaaaaaa1/", Cookie=cookie, Sec_Fetch_Site="none").status == 404  # a name that nobody gave out
    assert set(bench.windows()) <= set(before) | set(bench.windows()[:1])


def test_at_port_80_and_on_the_new_protocol_a_host_is_known():
    from validation.app.server import ListeningAddress

    assert ListeningAddress(host="127.0.0.1", port=80).answers_to("127.0.0.1")
    assert not ListeningAddress(host="127.0.0.1", port=80).answers_to("evil.example")
    assert not ListeningAddress(host="127.0.0.1", port=8080).answers_to("127.0.0.1")
    assert ListeningAddress(host="::1", port=8080).answers_to("[::1]:8080")
    assert not ListeningAddress(host="127.0.0.1", port=8080).answers_to("127.0.0.1:80")


def test_another_door_takes_no_cookie_of_this_one_and_leads_its_browser_by_a_file_that_nobody_else_reads(
    cookie, chromium, start_app, tmp_path
):
    from validation.app.server import leading

    bench = start_app("--stay")
    assert answer(bench, "/", Cookie=cookie).status == 401
    file = leading(bench.address, tmp_path)
    assert file.stat().st_mode & 0o777 == 0o600
    assert bench.token not in str(file)
    page = chromium.new_context().new_page()
    page.goto(file.as_uri())
    page.locator("#open-files").wait_for()
    assert "token" not in page.url
    page.context.close()
    bench.interrupted()


def test_every_answer_forbids_what_a_foreign_file_could_try_and_a_windows_own_port_answers_the_door_only(bench, cookie, until):
    for response in (answer(bench), answer(bench, Cookie=cookie), answer(bench, "/nothing", Cookie=cookie)):
        policy = str(response.getheader("Content-Security-Policy"))
        assert "default-src 'none'" in policy
        assert "http" not in policy  # no other host, not even a named one
        assert response.getheader("X-Content-Type-Options") == "nosniff"
        assert response.getheader("X-Frame-Options") == "DENY"
        assert response.getheader("Server") is None
    assert until(lambda: len(bench.windows()) == 1)  # the one that stands ready
    place = str(answer(bench, "/", Cookie=cookie).getheader("Location"))
    assert answer(bench, f"{place}index.html", Cookie=cookie).status == 200
    window = bench.windows()[-1]  # whichever: the one that stood ready, or one of its own
    assert until(lambda: listening(window) is not None)  # it may only just be starting
    own = http.client.HTTPConnection("127.0.0.1", listening(window), timeout=20)
    own.request("GET", "/index.html", headers={"Cookie": cookie})
    assert own.getresponse().status == 403
    own.close()


def test_a_port_that_is_taken_is_said_in_words(bench, massline):
    done: subprocess.CompletedProcess[str] = massline("app", "--no-browser", "--port", str(bench.port), timeout=60)
    assert done.returncode == 2
    assert "Choose another port" in done.stderr


def listening(pid: int) -> int | None:
    """The port that a process listens on, or none yet."""
    inodes = set()
    for entry in Path(f"/proc/{pid}/fd").iterdir():
        with contextlib.suppress(FileNotFoundError):  # closed between being listed and being read
            inodes.add(str(entry.readlink()))
    for line in Path("/proc/net/tcp").read_text().splitlines()[1:]:
        words = line.split()
        if words[3] == "0A" and f"socket:[{words[9]}]" in inodes:
            return int(words[1].rpartition(":")[2], 16)
    return None


def test_a_window_that_dies_in_the_middle_of_an_answer_is_no_mistake_of_the_door(caplog):
    from aiohttp import ClientError, ClientSession, web

    from validation.app.server import passed

    async def dies(reader: asyncio.StreamReader, writer: asyncio.StreamWriter) -> None:
        asked = await reader.readuntil(b"\r\n\r\n")
        if b"half" in asked:
            writer.write(b"HTTP/1.1 200 OK\r\nContent-Type: image/jpeg\r\nContent-Length: 1000\r\n\r\nabc")
            await writer.drain()
        writer.close()

    async def story() -> list[str]:
        window = await asyncio.start_server(dies, "127.0.0.1", 0)
        port, said = window.sockets[0].getsockname()[1], []
        async with window, ClientSession() as client:

            async def shown(request: web.Request) -> web.StreamResponse:
                try:
                    return await passed(request, client, port=port, path=request.match_info["path"], secret="x")
                except ClientError:
                    return web.Response(status=503)

            door = web.Application()
            door.router.add_get("/{path}", shown)
            runner = web.AppRunner(door, access_log=None)
            await runner.setup()
            site = web.TCPSite(runner, "127.0.0.1", 0)
            await site.start()
            at = f"http://127.0.0.1:{runner.addresses[0][1]}"
            for path in ("nothing", "half"):
                try:
                    async with client.get(f"{at}/{path}") as answer:
                        await answer.read()
                        said.append(str(answer.status))
                except ClientError:
                    said.append("cut")
            await runner.cleanup()
        return said

    assert asyncio.run(story()) == ["503", "cut"]
    assert [one.getMessage() for one in caplog.records if one.levelname == "ERROR"] == []


FAMILY = """
import os, signal, subprocess, sys
from validation.app import options

options.adopting()
sleeps = "import time; time.sleep(60)"
parent = f"import subprocess, sys; subprocess.Popen([sys.executable, '-c', {sleeps!r}]); print(1, flush=True); {sleeps}"
one = subprocess.Popen([sys.executable, "-c", parent], stdout=subprocess.PIPE, start_new_session=True)
one.stdout.readline()
os.killpg(one.pid, signal.SIGKILL)
one.wait()
options.collect(one.pid)
print(open(f"/proc/{os.getpid()}/task/{os.getpid()}/children").read().strip())
"""


def test_processes_of_a_group_that_was_killed_leave_nothing_in_the_table():
    done = subprocess.run([sys.executable, "-P", "-c", FAMILY], capture_output=True, text=True, timeout=60, check=True)
    assert done.stdout.strip() == ""
