"""Every way to leave the command line has its exit code and its words, and no user's mistake shows a traceback."""

import os
import shlex
import subprocess
import sys
from collections.abc import Callable
from pathlib import Path
from types import ModuleType

import click
import pytest

from geometry.errors import BadInput, CheckFailed
from tools import demo
from validation.cli import main
from validation.cli.main import COMMANDS, DONE, FAILED_CHECK

Install = Callable[[Callable[[], object]], None]


@pytest.fixture
def probe(monkeypatch) -> Install:
    """``probe(action)`` makes `action` the body of a command called probe."""

    def install(action: Callable[[], object]) -> None:
        module = ModuleType("validation.cli.probe")
        module.probe_command = click.Command("probe", callback=action)  # type: ignore[attr-defined]
        monkeypatch.setitem(sys.modules, module.__name__, module)
        monkeypatch.setitem(main.COMMANDS, "probe", "A command of the tests.")
        monkeypatch.setitem(main.MODULES, "probe", ("probe",))

    return install


def raising(error: BaseException) -> Callable[[], None]:
    def action() -> None:
        raise error

    return action


def test_a_command_that_returns_is_done_or_ends_early_with_its_own_exit_code(probe):
    probe(lambda: None)
    assert main.run(["probe"]) == main.DONE == 0
    probe(lambda: click.get_current_context().exit(1))
    assert main.run(["probe"]) == main.FAILED_CHECK == 1


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (
            BadInput("a.toml", "mass", "must be positive, found -1", "Check it"),
            2,
            "a.toml: `mass`: must be",
        ),
        (CheckFailed("the routes differ by 2 kg"), 1, "the routes differ by 2 kg"),
        (FileNotFoundError(2, "No such file or directory", "lost.step"), 2, "lost.step: No such file or directory"),
        (PermissionError(13, "Permission denied", "out"), 2, "out: Permission denied"),
        (OSError("the disk is full"), 2, "the disk is full"),
        (click.BadParameter("no such unit"), 2, "no such unit"),
        (KeyboardInterrupt(), 130, "interrupted"),
    ],
    ids=lambda value: type(value).__name__ if isinstance(value, BaseException) else "",
)
def test_a_failure_ends_with_its_exit_code_and_says_why(error, code, words, probe, capsys):
    probe(raising(error))
    assert main.run(["probe"]) == code
    captured = capsys.readouterr()
    assert words in captured.err
    assert "Traceback" not in captured.err
    assert captured.out == ""


def test_a_bug_is_not_dressed_up_as_a_mistake_of_the_user(probe):
    probe(raising(ZeroDivisionError()))
    with pytest.raises(ZeroDivisionError):
        main.run(["probe"])


def test_a_misspelt_command_and_an_unknown_option_are_bad_input_and_help_lists_every_command(capsys):
    assert main.run(["pendulm"]) == main.BAD_INPUT == 2
    assert "Did you mean 'pendulum'?" in capsys.readouterr().err
    assert main.run(["--jsn"]) == main.BAD_INPUT
    assert "--jsn" in capsys.readouterr().err
    assert main.run(["--help"]) == main.DONE
    help_text = capsys.readouterr().out
    assert all(f"  {command} " in help_text for command in main.COMMANDS)


def test_a_terminal_without_the_sign_does_not_stop_the_run(massline):
    run = massline("Θ", env={**os.environ, "PYTHONIOENCODING": "latin-1"})
    assert run.returncode == main.BAD_INPUT
    assert "No such command '?'" in run.stderr


@pytest.mark.parametrize("say", ["click.echo", "__import__('rich.console').console.Console().print"])
def test_a_reader_that_leaves_early_meets_silence_and_is_no_failed_check(say):
    talker = (
        "import sys, types, click; from validation.cli import main as cli; m = types.ModuleType('validation.cli.talk');"
        f"say = {say}; m.talk_command = click.Command('talk', callback=lambda: [say('x' * 99) for _ in range(9999)]);"
        "sys.modules[m.__name__] = m; cli.COMMANDS['talk'] = ''; cli.MODULES['talk'] = ('talk',); cli.main(['talk'])"
    )
    process = subprocess.Popen([sys.executable, "-P", "-c", talker], stdout=subprocess.PIPE, stderr=subprocess.PIPE, text=True)
    process.stdout.readline()
    process.stdout.close()
    with process.stderr:
        assert process.stderr.read() == ""
    assert process.wait(timeout=60) == main.READER_LEFT == 141


@pytest.mark.parametrize("step", demo.STEPS, ids=lambda step: step.command)
def test_every_step_is_a_command_or_an_example_that_exists(step, root):
    program, what, *_ = shlex.split(step.command)
    assert what in COMMANDS if program == "massline" else (program == "python" and (root / what).is_file())


PLANNED = demo.STEPS


def _steps(monkeypatch: pytest.MonkeyPatch, code: int, *steps: demo.DemoStep) -> list[list[str]]:
    heard: list[list[str]] = []
    monkeypatch.setattr(demo, "STEPS", steps)
    monkeypatch.setattr(demo, "run", lambda arguments: heard.append(arguments) or code)
    return heard


def test_it_runs_every_step_in_order_and_stops_at_the_first_that_fails(monkeypatch, capsys):
    steps = demo.DemoStep(title="One", command="massline a 'b c'"), demo.DemoStep(title="Two", command="massline d")
    heard = _steps(monkeypatch, DONE, *steps)
    assert demo.main() == DONE
    assert heard == [["a", "b c"], ["d"]]
    assert "1/2  One\n$ massline a 'b c'" in capsys.readouterr().out
    steps = demo.DemoStep(title="One", command="massline a"), demo.DemoStep(title="Two", command="massline b")
    heard = _steps(monkeypatch, FAILED_CHECK, *steps)
    assert demo.main() == FAILED_CHECK
    assert heard == [["a"]]
    assert "`massline a` ended with exit code 1" in capsys.readouterr().err


def test_a_step_whose_point_is_a_failed_check_must_fail_and_one_without_data_is_passed_over(monkeypatch, capsys, tmp_path):
    step = demo.DemoStep(title="One", command="massline a", ends=FAILED_CHECK)
    _steps(monkeypatch, FAILED_CHECK, step)
    assert demo.main() == DONE
    _steps(monkeypatch, DONE, step)
    assert demo.main() == FAILED_CHECK
    heard = _steps(monkeypatch, DONE, demo.DemoStep(title="One", command="massline a", needs=tmp_path / "nowhere"))
    assert demo.main() == DONE
    assert heard == []
    assert "nowhere is absent" in capsys.readouterr().out


def test_a_script_runs_in_a_process_of_its_own(monkeypatch, tmp_path):
    script = tmp_path / "script.py"
    script.write_text("import sys; sys.exit(3)")
    _steps(monkeypatch, DONE, demo.DemoStep(title="One", command=f"python {script}"))
    assert demo.main() == 3


def test_its_last_words_say_where_the_report_of_a_step_lies_and_how_to_open_the_workbench(monkeypatch, capsys):
    _steps(monkeypatch, DONE)
    assert demo.main() == DONE
    said = capsys.readouterr().out
    assert Path(demo.REPORT).absolute().as_uri() in said
    (line,) = [line for line in said.splitlines() if line.startswith("Workbench:")]
    program, what, model, *data = line.removeprefix("Workbench:").split()
    assert (Path(program).name, what, model) == ("massline", "app", demo.MODEL)
    assert all(any(folder in step.command for step in PLANNED) for folder in data)
    assert any(step.command.startswith("massline report") and demo.REPORT in step.command for step in PLANNED)
