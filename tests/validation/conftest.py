"""What several tests ask for: the command line in this process, and a browser."""

from collections.abc import Callable, Iterator
from pathlib import Path
from typing import Any

import pytest

from validation import cli
from validation.report import browser

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture
def run(capsys: pytest.CaptureFixture[str], tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> Run:
    """``run(*arguments)`` in an empty folder: exit code, standard output, standard error."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: str) -> tuple[int, str, str]:
        code = cli.run(list(arguments))
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return call


@pytest.fixture(scope="session")
def chromium(browser_path: str) -> Iterator[Any]:
    """A browser without a window, one for all tests of a process: playwright stands but one."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=browser_path, args=list(browser.flags()))
        yield opened
        opened.close()


@pytest.fixture(scope="session")
def script() -> Callable[[str], str]:
    """A script of the folder js, to be evaluated in a page."""
    return lambda name: (Path(__file__).with_name("js") / f"{name}.js").read_text(encoding="utf-8")
