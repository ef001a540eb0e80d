"""Every way to leave the command line has its exit code and its words, and no user's mistake shows a traceback."""

import os
import subprocess
import sys
from collections.abc import Callable
from types import ModuleType

import click
import pytest

from geometry.errors import BadInput, CheckFailed
from validation.cli import main

Install = Callable[[Callable[[], object]], None]


@pytest.fixture
def probe(monkeypatch: pytest.MonkeyPatch) -> Install:
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


def test_a_command_that_returns_is_done(probe: Install) -> None:
    probe(lambda: None)
    assert main.run(["probe"]) == main.DONE == 0


def test_a_command_may_end_early_with_its_own_exit_code(probe: Install) -> None:
    probe(lambda: click.get_current_context().exit(1))
    assert main.run(["probe"]) == main.FAILED_CHECK == 1


@pytest.mark.parametrize(
    ("error", "code", "words"),
    [
        (
            BadInput(source="a.toml", field="mass", problem="must be positive, found -1", remedy="Check it"),
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
def test_a_failure_ends_with_its_exit_code_and_says_why(
    error: BaseException, code: int, words: str, probe: Install, capsys: pytest.CaptureFixture[str]
) -> None:
    probe(raising(error))
    assert main.run(["probe"]) == code
    captured = capsys.readouterr()
    assert words in captured.err
    assert "Traceback" not in captured.err
    assert captured.out == ""


def test_a_bug_is_not_dressed_up_as_a_mistake_of_the_user(probe: Install) -> None:
    probe(raising(ZeroDivisionError()))
    with pytest.raises(ZeroDivisionError):
        main.run(["probe"])


def test_a_misspelt_command_is_bad_input_and_the_right_one_is_suggested(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run(["pendulm"]) == main.BAD_INPUT == 2
    assert "Did you mean 'pendulum'?" in capsys.readouterr().err


def test_an_unknown_option_is_bad_input(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run(["--jsn"]) == main.BAD_INPUT
    assert "--jsn" in capsys.readouterr().err


def test_help_lists_every_command(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run(["--help"]) == main.DONE
    help_text = capsys.readouterr().out
    assert all(f"  {command} " in help_text for command in main.COMMANDS)


def test_a_terminal_without_the_sign_does_not_stop_the_run(massline: Callable[..., subprocess.CompletedProcess[str]]) -> None:
    run = massline("Θ", env={**os.environ, "PYTHONIOENCODING": "latin-1"})
    assert run.returncode == main.BAD_INPUT
    assert "No such command '?'" in run.stderr


@pytest.mark.parametrize("say", ["click.echo", "__import__('rich.console').console.Console().print"])
def test_a_reader_that_leaves_early_meets_silence_and_is_no_failed_check(say: str) -> None:
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
