"""What every test may ask for: the repository, the folder of real measured data, the command line as users run it, a renderer."""

import gc
import json
import os
import runpy
import signal
import subprocess
import sys
import time
from collections.abc import Callable, Iterator
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import pytest
from hypothesis import settings

# The same examples in every run: a submission fails for what it changed, not for luck. No deadline: a busy machine is no mistake.
settings.register_profile("massline", derandomize=True, deadline=None, database=None, max_examples=30)
settings.load_profile("massline")

ROOT = Path(__file__).parents[1]

RUBBISH = (50_000, 20, 100)
"""Objects, collections and collections of those after which rubbish is looked for: with the libraries, thousands of tests and
what they share on the heap, Python's own 700, 10 and 10 spend up to a third of a test's processor time on looking."""


@pytest.fixture(scope="session")
def root() -> Path:
    """The repository."""
    return ROOT


@pytest.fixture(scope="session", autouse=True)
def _own_cache(tmp_path_factory: pytest.TempPathFactory) -> Iterator[None]:
    """Solid models are kept in a folder of this run, here and in processes of their own, not in the user's.

    Worker processes (`pytest -n`) have one between them: a mesh is made once.
    """
    own = tmp_path_factory.getbasetemp()
    whole = own.parent if "PYTEST_XDIST_WORKER" in os.environ else own
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MASSLINE_CACHE", str(whole / "cache"))
        yield


@pytest.fixture(scope="session", autouse=True)
def _nobodys_window() -> None:
    """Pages are as wide as in a pipe, here and in processes of their own, in whatever window the tests were started.

    The readline that pytest imports tells processes that are started afterwards, its workers among them, of 80 columns;
    it does so behind the back of `os.environ`.
    """
    for name in ("COLUMNS", "LINES"):
        os.environ.pop(name, None)
        os.unsetenv(name)


@pytest.fixture
def keyboard() -> Iterator[None]:
    """Ctrl-C as a terminal has it: a shell that runs the tests in the background makes its children deaf to it."""
    before = signal.signal(signal.SIGINT, signal.default_int_handler)
    yield
    signal.signal(signal.SIGINT, before)


@pytest.fixture(scope="session")
def code(root: Path) -> Path:
    """Where the packages under test come from: the unpacked wheel that `make test` names, else the repository."""
    return Path(os.environ.get("MASSLINE_UNDER_TEST", root)).resolve()


COMMAND = "from validation.cli.main import main; main()"


@pytest.fixture(scope="session")
def massline() -> Callable[..., subprocess.CompletedProcess[str]]:
    """``massline(*arguments, cwd=folder)``: the command line in a process of its own; keywords go to `subprocess.run`."""
    entry = (sys.executable, "-P", "-c", COMMAND)

    def run(*arguments: str, **options: object) -> subprocess.CompletedProcess[str]:
        return subprocess.run([*entry, *arguments], capture_output=True, encoding="utf-8", check=False, **options)

    return run


@pytest.fixture(scope="session")
def apart(code: Path) -> Iterator[Callable[..., subprocess.CompletedProcess[str]]]:
    """``apart(*arguments, cwd=folder)``: the command line, or another `program`, in a process of its own that has the libraries
    already (`apart.py`): to import them takes longer than most of what is asked. Further keywords: `env` and `input`."""
    command = [sys.executable, "-P", str(Path(__file__).with_name("apart.py"))]
    environment = {**os.environ, "PYTHONPATH": str(code)}
    with subprocess.Popen(command, env=environment, stdin=subprocess.PIPE, stdout=subprocess.PIPE, encoding="utf-8") as server:
        assert server.stdin is not None
        assert server.stdout is not None

        def run(
            *arguments: str, program: str = COMMAND, cwd: Path | None = None, env: dict[str, str] | None = None, input: str = ""
        ) -> subprocess.CompletedProcess[str]:
            where, around = str(cwd or Path.cwd()), {**(env or os.environ), "PYTHONPATH": str(code)}
            asked = {"program": program, "arguments": arguments, "cwd": where, "env": around, "input": input}
            server.stdin.write(json.dumps(asked) + "\n")
            server.stdin.flush()
            done = json.loads(server.stdout.readline())
            return subprocess.CompletedProcess(arguments, done["code"], done["out"], done["err"])

        yield run
        server.stdin.close()


@pytest.fixture(scope="session")
def quick_workers() -> Iterator[None]:
    """To the end of the session workers of a desk are forks of a process that has the libraries; elsewhere each imports them."""
    from multiprocessing import forkserver, get_context

    from validation.app import workers

    context = get_context("forkserver")
    context.set_forkserver_preload(["validation.app.workers", "massline"])
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(workers, "multiprocessing", SimpleNamespace(get_context=lambda method: context))
        yield
    forkserver._forkserver._stop()  # and is waited for


@pytest.fixture(scope="session")
def gain(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A folder with ``model.toml`` and ``gain``: the smallest sweeps of which a diagnosis is sure, those of the stored answers,
    in which one force channel reads 8 % too much, and a model that does not know. Not to be changed: take a copy."""
    from validation.cli import main

    folder = tmp_path_factory.mktemp("gain")
    quick = ("--seed", "3", "--octaves-per-minute", "120", "--band", "8", "16", "--rate", "256", "--noise", "0.1")
    planted = ("--tolerances", "0.3", "--effect", "force-gain:fmd-z2=0.08")
    assert main.run(["model", "fmd+cuboid", "--out", str(folder / "model.toml")]) == main.DONE
    assert main.run(["simulate", "fmd+cuboid", "--out", str(folder / "gain"), *quick, *planted]) == main.DONE
    return folder


@pytest.fixture(scope="session")
def shared(root: Path) -> Path:
    """The project's shared folder, beside the repository."""
    return _present(root.parent / "shared", "the shared folder beside the repository")


@pytest.fixture(scope="session")
def data(root: Path) -> Path:
    """Real measured data: `MASSLINE_DATA`, or ``../shared/data``."""
    return _present(Path(os.environ.get("MASSLINE_DATA", root.parent / "shared" / "data")), "MASSLINE_DATA or ../shared/data")


@pytest.fixture(scope="session")
def peak_hold_bias(root: Path) -> dict[str, Any]:
    """The names in ``examples/peak_hold_bias.py``, which measures a bias in time."""
    return runpy.run_path(str(root / "examples" / "peak_hold_bias.py"))


@pytest.fixture(scope="session")
def browser_path() -> str:
    """The path of a browser of the Chromium family; a machine without one says what to install and skips."""
    from geometry.errors import BadInput
    from validation.report import page

    try:
        return page.browser_path()
    except BadInput as error:
        pytest.skip(str(error))


@pytest.fixture(scope="session")
def renderer() -> None:
    """Off-screen rendering; a machine without OpenGL says so and skips."""
    from geometry.errors import CheckFailed
    from validation.report.scenes.scene import off_screen

    try:
        with off_screen():
            pass
    except CheckFailed as error:
        pytest.skip(str(error))


def _present(folder: Path, what: str) -> Path:
    if not folder.is_dir():
        pytest.skip(f"{what} is absent; data/README.md of the shared folder says where its sets come from")
    return folder


@pytest.hookimpl(wrapper=True)
def pytest_runtest_makereport(item: pytest.Item) -> Iterator[None]:
    """On the machine that judges submissions (`CI` is set) nothing is skipped: what a test lacks there fails it by name."""
    report = yield
    if os.environ.get("CI") and report.skipped and not hasattr(report, "wasxfail"):
        report.outcome = "failed"
        report.longrepr = f"{item.nodeid}: nothing is skipped where CI is set, but {report.longrepr[2]}"
    return report


ENDS = pytest.StashKey[float]()
LEFT_OUT = pytest.StashKey[list[str]]()


def pytest_addoption(parser: pytest.Parser) -> None:
    within = "tests begin within so many seconds; those that are left out are named"
    parser.addoption("--within", type=float, default=float("inf"), metavar="SECONDS", help=within)
    parser.addoption("--begin-at", type=int, default=0, metavar="N", help="begin with this test; those before it come last")


def pytest_configure(config: pytest.Config) -> None:
    gc.set_threshold(*RUBBISH)
    config.stash[ENDS] = time.monotonic() + config.getoption("--within")
    config.stash[LEFT_OUT] = []


@pytest.hookimpl(tryfirst=True)
def pytest_runtest_protocol(item: pytest.Item) -> bool | None:
    if time.monotonic() < item.config.stash[ENDS]:
        return None
    item.config.stash[LEFT_OUT].append(item.nodeid)
    return True


def pytest_sessionfinish(session: pytest.Session) -> None:
    if hasattr(session.config, "workeroutput"):
        session.config.workeroutput["left_out"] = session.config.stash[LEFT_OUT]


@pytest.hookimpl(optionalhook=True)
def pytest_testnodedown(node: Any) -> None:
    node.config.stash[LEFT_OUT] += getattr(node, "workeroutput", {}).get("left_out", [])


def pytest_terminal_summary(terminalreporter: pytest.TerminalReporter, config: pytest.Config) -> None:
    if left := config.stash[LEFT_OUT]:
        terminalreporter.section(f"{len(left)} left out: {config.getoption('--within'):g} s were over")
        terminalreporter.write("".join(f"{name}\n" for name in sorted(left)))


def pytest_collection_finish() -> None:
    """What was collected stays to the end: no use in looking through it for rubbish."""
    gc.freeze()


@pytest.hookimpl(trylast=True)
def pytest_collection_modifyitems(config: pytest.Config, items: list[pytest.Item]) -> None:
    """Two processes share the suite: what one of them does at the end, the other waits for."""
    begin = config.getoption("--begin-at") % max(len(items), 1)
    items[:] = items[begin:] + items[:begin]
    items.sort(key=lambda item: item.get_closest_marker("first") is None)
