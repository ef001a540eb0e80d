"""The demo is a list of commands that exist, and it ends at the first that ends otherwise than it should."""

import shlex
from pathlib import Path

import pytest

from validation.cli import demo
from validation.cli.main import COMMANDS, DONE, FAILED_CHECK


@pytest.mark.parametrize("step", demo.STEPS, ids=lambda step: step.command)
def test_every_step_is_a_command_or_an_example_that_exists(step: demo.DemoStep, root: Path) -> None:
    program, what, *_ = shlex.split(step.command)
    assert what in COMMANDS if program == "massline" else (program == "python" and (root / what).is_file())


PLANNED = demo.STEPS


def _steps(monkeypatch: pytest.MonkeyPatch, code: int, *steps: demo.DemoStep) -> list[list[str]]:
    heard: list[list[str]] = []
    monkeypatch.setattr(demo, "STEPS", steps)
    monkeypatch.setattr(demo, "run", lambda arguments: heard.append(arguments) or code)
    return heard


def test_it_runs_every_step_in_order(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    steps = demo.DemoStep(title="One", command="massline a 'b c'"), demo.DemoStep(title="Two", command="massline d")
    heard = _steps(monkeypatch, DONE, *steps)
    assert demo.main() == DONE
    assert heard == [["a", "b c"], ["d"]]
    assert "1/2  One\n$ massline a 'b c'" in capsys.readouterr().out


def test_it_stops_at_the_first_step_that_fails(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    steps = demo.DemoStep(title="One", command="massline a"), demo.DemoStep(title="Two", command="massline b")
    heard = _steps(monkeypatch, FAILED_CHECK, *steps)
    assert demo.main() == FAILED_CHECK
    assert heard == [["a"]]
    assert "`massline a` ended with exit code 1" in capsys.readouterr().err


def test_a_step_whose_point_is_a_failed_check_must_fail(monkeypatch: pytest.MonkeyPatch) -> None:
    step = demo.DemoStep(title="One", command="massline a", ends=FAILED_CHECK)
    _steps(monkeypatch, FAILED_CHECK, step)
    assert demo.main() == DONE
    _steps(monkeypatch, DONE, step)
    assert demo.main() == FAILED_CHECK


def test_a_step_whose_data_are_absent_is_passed_over_in_words(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str], tmp_path: Path
) -> None:
    heard = _steps(monkeypatch, DONE, demo.DemoStep(title="One", command="massline a", needs=tmp_path / "nowhere"))
    assert demo.main() == DONE
    assert heard == []
    assert "nowhere is absent" in capsys.readouterr().out


def test_a_script_runs_in_a_process_of_its_own(monkeypatch: pytest.MonkeyPatch, tmp_path: Path) -> None:
    script = tmp_path / "script.py"
    script.write_text("import sys; sys.exit(3)")
    _steps(monkeypatch, DONE, demo.DemoStep(title="One", command=f"python {script}"))
    assert demo.main() == 3


def test_its_last_words_say_where_the_report_lies_and_how_to_open_the_workbench(
    monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    _steps(monkeypatch, DONE)
    assert demo.main() == DONE
    said = capsys.readouterr().out
    assert Path(demo.REPORT).absolute().as_uri() in said
    (line,) = [line for line in said.splitlines() if line.startswith("Workbench:")]
    program, what, model, *data = line.removeprefix("Workbench:").split()
    assert (Path(program).name, what, model) == ("massline", "app", demo.MODEL)
    assert all(any(folder in step.command for step in PLANNED) for folder in data)


def test_the_report_of_which_the_last_words_speak_is_written_by_a_step() -> None:
    assert any(step.command.startswith("massline report") and demo.REPORT in step.command for step in PLANNED)
