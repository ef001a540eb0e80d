"""When a window's process ends, and when the door does, without any process or browser."""

import asyncio
from collections.abc import Awaitable, Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest

from geometry import errors
from validation.app import server
from validation.app.options import StartOptions
from validation.app.server import Window, Windows


class Quick(Windows):
    """Windows whose processes are none."""

    async def _started(self, name: str) -> Window:
        await asyncio.sleep(0.05)
        return Window(process=SimpleNamespace(returncode=None), port=1)  # type: ignore[arg-type]

    async def _ended(self, window: Window) -> None:
        window.process.returncode = 0  # type: ignore[misc]
        self.emptied()


def story(tmp_path: Path, told: Callable[[Quick], Awaitable[None]]) -> Any:
    async def run() -> None:
        await told(Quick(home=tmp_path, opened=StartOptions()))

    return asyncio.run(run())


@pytest.fixture(autouse=True)
def _soon(monkeypatch) -> None:
    monkeypatch.setattr(server, "LINGERS", 0.1)


def test_a_reload_that_takes_its_time_keeps_the_process(tmp_path):
    async def told(all_of_them):
        window = await all_of_them.window(name := all_of_them.new())
        all_of_them.page_opened(window)
        all_of_them.page_closed(window)
        assert await all_of_them.window(name) is window  # the page is asked for, its websocket comes later
        await asyncio.sleep(0.25)
        assert await all_of_them.window(name) is window
        all_of_them.page_opened(window)
        all_of_them.page_closed(window)
        await asyncio.sleep(0.25)
        assert not all_of_them.any_alive()

    story(tmp_path, told)


def test_a_window_that_is_about_to_start_keeps_the_door(tmp_path):
    async def told(all_of_them):
        starting = asyncio.ensure_future(all_of_them.window(all_of_them.new()))
        await asyncio.sleep(0)
        assert all_of_them.any_alive()
        await starting

    story(tmp_path, told)


def test_the_door_waits_its_whole_time_from_the_last_page_on(tmp_path):
    async def told(all_of_them):
        ended = asyncio.Event()
        lingers = server._Linger(0.3, all_of_them, ended)
        lingers.begin()
        await asyncio.sleep(0.2)
        lingers.begin()
        await asyncio.sleep(0.2)
        assert not ended.is_set()
        await asyncio.wait_for(ended.wait(), 2)

    story(tmp_path, told)


def test_only_so_many_windows_are_open(tmp_path, monkeypatch):
    monkeypatch.setattr(server, "MOST", 2)

    async def told(all_of_them):
        for _ in range(2):
            await all_of_them.window(all_of_them.new())
        with pytest.raises(errors.CheckFailed, match="close one"):
            await all_of_them.window(all_of_them.new())

    story(tmp_path, told)
