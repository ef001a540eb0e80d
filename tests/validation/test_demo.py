"""The demo is a list of commands that exist, and it ends as the first of them that fails."""

import shlex

import pytest

from validation import demo
from validation.cli import COMMANDS, DONE, FAILED_CHECK


@pytest.mark.parametrize("step", demo.STEPS, ids=lambda step: step.command)
def test_every_step_is_a_command_that_exists(step: demo.Step) -> None:
    assert shlex.split(step.command)[0] in COMMANDS


def test_it_runs_every_step_in_order(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    heard: list[list[str]] = []
    monkeypatch.setattr(demo, "STEPS", (demo.Step(title="One", command="a 'b c'"), demo.Step(title="Two", command="d")))
    monkeypatch.setattr(demo, "run", lambda arguments: heard.append(arguments) or DONE)
    assert demo.main() == DONE
    assert heard == [["a", "b c"], ["d"]]
    assert "1/2  One\n$ massline a 'b c'" in capsys.readouterr().out


def test_it_stops_at_the_first_step_that_fails(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    heard: list[list[str]] = []
    monkeypatch.setattr(demo, "STEPS", (demo.Step(title="One", command="a"), demo.Step(title="Two", command="b")))
    monkeypatch.setattr(demo, "run", lambda arguments: heard.append(arguments) or FAILED_CHECK)
    assert demo.main() == FAILED_CHECK
    assert heard == [["a"]]
    assert "`massline a` ended with exit code 1" in capsys.readouterr().err
