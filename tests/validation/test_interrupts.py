"""An interruption never breaks an import, and is never lost."""

import signal
import sys
import time
from importlib import import_module
from typing import Any

import pytest

from fem.exudyn.run import kept
from validation.cli import main

INTERRUPTED_INSIDE = """
import signal
signal.raise_signal(signal.SIGINT)
finished = sum(range(1000))
"""


pytestmark = pytest.mark.usefixtures("keyboard")


@pytest.fixture
def module(tmp_path, monkeypatch) -> str:
    """Name of a module during whose import Ctrl-C is pressed."""
    name = "interrupted_inside"
    (tmp_path / f"{name}.py").write_text(INTERRUPTED_INSIDE, encoding="utf-8")
    monkeypatch.syspath_prepend(tmp_path)
    monkeypatch.delitem(sys.modules, name, raising=False)
    return name


def imported_and_interrupted(name: str, imported: list[Any]) -> None:
    with main.held_while_importing():
        imported.append(import_module(name))
        time.sleep(600 * main.PATIENCE)


def interrupted_at_once(reached: list[str]) -> None:
    with main.held_while_importing():
        signal.raise_signal(signal.SIGINT)
        reached.append("the next line")


def test_an_import_is_finished_before_it_is_interrupted_and_outside_an_interruption_is_immediate(module):
    imported: list[Any] = []
    with pytest.raises(KeyboardInterrupt):
        imported_and_interrupted(module, imported)
    assert [one.finished for one in imported] == [499500]
    reached: list[str] = []
    with pytest.raises(KeyboardInterrupt):
        interrupted_at_once(reached)
    assert not reached


def test_a_command_that_ends_first_is_not_interrupted_afterwards(module):
    with main.held_while_importing():
        import_module(module)
    time.sleep(3 * main.PATIENCE)


def test_an_interruption_of_an_import_is_not_lost_when_somebody_keeps_interruptions_next(module):
    """As exudyn does, which is imported just before it runs."""

    def imported_and_run():
        with main.held_while_importing():
            import_module(module)
            with kept() as found:
                time.sleep(10 * main.PATIENCE)
                assert isinstance(found.reason, KeyboardInterrupt)

    with pytest.raises(KeyboardInterrupt):
        imported_and_run()
