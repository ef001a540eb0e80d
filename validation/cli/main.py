"""The command line: parses, calls, prints. The module of a command is imported only when it is asked for."""

import _thread
import io
import signal
import sys
import threading
import time
import warnings
from collections.abc import Iterator
from contextlib import contextmanager
from importlib import import_module
from types import FrameType

import click

from geometry.errors import BadInput, CheckFailed, lacking

# Ctrl-C while libraries are being imported: heard at once, acted upon when the import is done.
#
# An exception out of nowhere is more than the initialisation of a compiled library survives: it fails half-way, or takes the
# process with it. Between imports an interruption is what it always is, a KeyboardInterrupt.


PATIENCE = 0.05
"""Seconds between two looks at whether the import is done."""

_IMPORTING = "<frozen importlib"

_listening = threading.Event()


@contextmanager
def held_while_importing() -> Iterator[None]:
    """Inside the block, SIGINT raises KeyboardInterrupt as always, but never inside an import.

    Does nothing outside the main thread, which alone hears signals, and where somebody else listens to SIGINT already.
    """
    listening = threading.current_thread() is threading.main_thread()
    if not listening or signal.getsignal(signal.SIGINT) is not signal.default_int_handler:
        yield
        return
    signal.signal(signal.SIGINT, _heard)
    _listening.set()
    try:
        yield
    finally:
        _listening.clear()
        signal.signal(signal.SIGINT, signal.default_int_handler)


def _heard(number: int, frame: FrameType | None) -> None:
    inner = frame
    while inner is not None and not inner.f_code.co_filename.startswith(_IMPORTING):
        inner = inner.f_back
    if inner is None:
        signal.default_int_handler(number, frame)
    _thread.start_new_thread(_again, ())  # takes no lock, unlike threading.Timer, so it may start anywhere


def _again() -> None:
    time.sleep(PATIENCE)
    if not _listening.is_set():  # and not whether the handler is this one: what runs inside may have put its own around it
        return  # the command has ended meanwhile, and there is nothing to interrupt
    if sys.platform == "win32":
        _thread.interrupt_main()
    else:
        signal.pthread_kill(threading.main_thread().ident or 0, signal.SIGINT)  # ends a wait in the main thread as well


DONE, FAILED_CHECK, BAD_INPUT, INTERRUPTED, READER_LEFT = 0, 1, 2, 130, 141
"""The exit codes; the last two are a shell's for a program that SIGINT or SIGPIPE ended."""

COMMANDS = {
    "reference": "Mass, CoG and inertia of articles by three routes.",
    "validate": "Identified parameters held against the reference.",
    "weigh": "Reduce a weighing to a mass.",
    "cog": "Reduce a crane-and-balance test to a CoG height.",
    "verify": "Elements, modes and dynamic mass against closed forms and benchmarks.",
    "pendulum": "Reduce pendulum periods to moments of inertia.",
    "swing": "A rope pendulum simulated by exudyn, recorded and reduced as a measured one.",
    "modes": "Eigenfrequencies, mode shapes and effective masses.",
    "dynamic-mass": "The base-excited 6 x 6 dynamic mass over frequency.",
    "excite": "Base excitation in time: sweeps, random, bursts; loads, load cells, resonances.",
    "simulate": "A virtual test on the shaker: a campaign with tolerances, noise and planted effects, and its truth.",
    "effects": "The physical effects that can be simulated, compared, added and looked for.",
    "pretest": "Before a test: what it would tell, where pick-ups belong, which tolerance matters most.",
    "check": "What a recorded campaign holds, and what is wrong with it.",
    "identify": "Mass, CoG and inertia from a recorded campaign, with intervals and verdicts.",
    "laboratory": "What a laboratory learns of its own hardware and mountings from campaigns of known bodies.",
    "model": "A commented model file to start from: laboratory, structure, tolerances, effects.",
    "compare": "Where a model fails: errors, maps and worst spots beside a series of campaigns.",
    "diagnose": "Which effect a model is missing: ranked causes, that nothing is, or what the unknown looks like.",
    "correct": "A corrected copy of a campaign: a gain, delay, polarity or place of the measurement taken out.",
    "add": "Add an effect to a model: fitted, with the errors before and after, as the next rung of its ladder.",
    "ladder": "Every version of a model, and how its errors fell from rung to rung.",
    "report": "All that is known of a model and its measurements on one page, to be read, printed and signed.",
    "league": "Real tests that others made: what was expected, what is said of each, and the errors.",
    "undo": "Go back to the rung below; what was there is kept.",
    "app": "The workbench in the browser: compare, diagnose, add, undo, what if.",
    "doctor": "What is installed here: Python, libraries by extra, browser, factorisers, data.",
}
"""Every command and its line in the help; `validation.cli.<name>` holds it."""

MODULES = {
    "crosscheck": ("model", "compare", "diagnose", "correct", "add", "ladder", "report", "undo", "app", "effects", "league"),
    "reference": ("reference", "validate", "weigh", "cog", "pendulum"),
    "predict": ("verify", "swing", "modes", "dynamic-mass", "excite", "simulate"),
    "identify": ("pretest", "check", "identify", "laboratory"),
    "doctor": ("doctor",),
}
"""The modules of `validation.cli` by the commands that they hold, each as the function ``NAME_command``."""


KEPT = 32 * 2**20
"""[bytes] Arrays up to this size are taken from memory that the process has kept, which glibc takes for no more than that."""


M_TRIM_THRESHOLD, M_MMAP_THRESHOLD = -1, -3


class _LazyGroup(click.Group):
    """A group that knows its commands by name and imports one only to run it, so that help answers in a blink."""

    def list_commands(self, ctx: click.Context) -> list[str]:
        return list(COMMANDS)

    def get_command(self, ctx: click.Context, cmd_name: str) -> click.Command:
        if cmd_name not in COMMANDS:
            raise click.exceptions.NoSuchCommand(cmd_name, possibilities=COMMANDS, ctx=ctx)
        self._keep_freed_memory()
        module = next(module for module, names in MODULES.items() if cmd_name in names)
        command: click.Command = getattr(import_module(f"validation.cli.{module}"), f"{cmd_name.replace('-', '_')}_command")
        return command

    @staticmethod
    def _keep_freed_memory() -> None:
        """Let glibc, where that is the C library, keep what is freed: the fits make arrays of the same sizes all the time, and to
        give each back to the system and ask for it again takes as long as the sums with it."""
        if sys.platform == "linux":
            import ctypes

            if hasattr(library := ctypes.CDLL(None), "mallopt"):
                library.mallopt(M_MMAP_THRESHOLD, KEPT)
                library.mallopt(M_TRIM_THRESHOLD, 2**31 - 1)

    def format_commands(self, ctx: click.Context, formatter: click.HelpFormatter) -> None:
        with formatter.section("Commands"):
            formatter.write_dl(list(COMMANDS.items()))


@click.group(cls=_LazyGroup, context_settings={"help_option_names": ["-h", "--help"], "max_content_width": 120})
@click.version_option(package_name="massline", prog_name="massline")  # asks for the version where it is asked for
def cli() -> None:
    """Know, and prove, the mass, centre of gravity and inertia of a structure.

    `massline COMMAND --help` says more about each command.

    \b
    Exit codes: 0  done
                1  the data or the model fails a check, said in words
                2  bad input: what, where, and what to do
              130  interrupted by Ctrl-C
              141  the reader of a pipe left early, as in `massline ... | head -1`
    """


def main(arguments: list[str] | None = None) -> None:
    """Run the command line and leave with its exit code; a user's mistake never shows a traceback."""
    for stream in (sys.stdout, sys.stderr):
        if isinstance(stream, io.TextIOWrapper):
            stream.reconfigure(errors="replace")  # a terminal without a sign for ² or Θ shows ? instead of stopping the run
    if not sys.warnoptions:
        warnings.simplefilter("ignore", RuntimeWarning)  # what overflows on the way of a fit is no word to a user; results are
    sys.exit(run(arguments))


def run(arguments: list[str] | None = None) -> int:
    """Run the command line on `arguments` (`sys.argv` by default) and return the exit code.

    A command returns None when it is done, ends early with `ctx.exit(code)`, or raises.
    """
    try:
        with held_while_importing():
            code = cli.main(args=arguments, prog_name="massline", standalone_mode=False)
    except click.ClickException as error:
        error.show()
        return BAD_INPUT
    except BadInput as error:
        return _say(str(error), BAD_INPUT)
    except OSError as error:
        return _say(f"{error.filename or 'file'}: {error.strerror or error}. Check the path and its permissions.", BAD_INPUT)
    except CheckFailed as error:
        return _say(str(error), FAILED_CHECK)
    except ModuleNotFoundError as error:
        if (said := lacking(error)) is None:
            raise
        return _say(f"{said}; massline doctor says what is there.", BAD_INPUT)
    except SystemExit:  # how click and rich answer a closed pipe, both with the code of a failed check; commands leave otherwise
        return READER_LEFT
    except (KeyboardInterrupt, click.Abort):
        return _say("interrupted; files already finished are kept, none is half-written.", INTERRUPTED)
    return code if isinstance(code, int) else DONE


def _say(message: str, code: int) -> int:
    click.echo(f"massline: {message}", err=True)
    return code
