"""What every job of a test day costs, in units u = reading a campaign's files with h5py and one zero-padded FFT of every record.

All jobs are commands as a user types them, each in a process of its own on one core, and what counts is the processor time of
that process, so that others on the machine disturb little. From it goes what any program would pay before it begins: a process
that imports numpy, scipy.linalg and h5py. What massline imports itself stays in. What commands keep on disk, `geometry.cache`, is
in a folder that begins empty, and one run of each command that is not counted fills it, as the first of a test day does.

    python -m benchmarks.bench_costs                 the table, the bar of every row, and whether it is met
    python -m benchmarks.bench_costs --profile       what the time of each command goes to
    python -m benchmarks.bench_costs check compare   some rows alone
"""

from __future__ import annotations

import os
import pstats
import resource
import shutil
import subprocess
import sys
import time
from collections.abc import Callable
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from tempfile import TemporaryDirectory

import h5py
import numpy as np
from rich.console import Console
from rich.table import Table

COMMAND = "from validation.cli.main import run; import sys; sys.exit(run(sys.argv[1:]))"
PROFILED = """
import cProfile, sys, time
from validation.cli.main import run
profile = cProfile.Profile(time.process_time)
try:
    profile.runcall(run, sys.argv[2:])
except SystemExit:
    pass
profile.dump_stats(sys.argv[1])
"""
START = "import h5py, numpy, scipy.linalg"

CUBOID, ONE, FOUR = "fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4"
SEED = ("--seed", "11")
FAULT = ("--effect", "force-gain:fmd-z2=0.05")

SHORTEST = 1000
"""[samples] of a record; shorter arrays of a file say something else."""

ROUNDS = 1
"""[count] of runs of each command, of which the cheaper one counts."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """One row.

    Attributes
    ----------
    words : of the command line, in the folder of the series
    campaigns : over how many the cost is told
    bar : at most [u a campaign], or times `beside`
    beside : name of another row that is the unit; empty for u
    """

    words: tuple[str, ...]
    bar: float
    campaigns: int = 1
    beside: str = ""


JOBS: dict[str, Job] = {
    "check": Job(words=("check", f"sound/{ONE}"), bar=1.5),
    "identify": Job(words=("identify", f"sound/{ONE}", "--tare", f"sound/{CUBOID}"), bar=5.0, campaigns=2),
    "identify four blades": Job(words=("identify", f"sound/{FOUR}", "--tare", f"sound/{CUBOID}"), bar=15.0, campaigns=2),
    "diagnose null": Job(
        words=("diagnose", "model.toml", *(f"sound/{one}" for one in (CUBOID, ONE, FOUR))), bar=5.0, campaigns=3
    ),
    "diagnose fault": Job(words=("diagnose", "model.toml", *(f"gain/{one}" for one in (CUBOID, ONE))), bar=10.0, campaigns=2),
    "compare": Job(words=("compare", "model.toml", f"sound/{CUBOID}", f"sound/{ONE}"), bar=2.0, campaigns=2),
    "add": Job(words=("add", "added.toml", "force-gain:fmd-z2", f"gain/{CUBOID}", f"gain/{ONE}"), bar=4.0, campaigns=2),
    "simulate": Job(words=("simulate", ONE, "--out", "once", *SEED, "--octaves-per-minute", "2"), bar=5.0),
    "report --no-diagnosis": Job(
        words=("report", "model.toml", f"sound/{CUBOID}", f"sound/{ONE}", "--no-diagnosis", "--out", "a.html"),
        bar=1.3,
        beside="compare",
    ),
    "diagnose beside report": Job(words=("diagnose", "model.toml", f"sound/{CUBOID}", f"sound/{ONE}"), bar=np.inf, campaigns=2),
    "report": Job(
        words=("report", "model.toml", f"sound/{CUBOID}", f"sound/{ONE}", "--out", "b.html"),
        bar=1.15,
        beside="diagnose beside report",
    ),
    "help": Job(words=("--help",), bar=4.0, beside="a bare interpreter"),
    "reference cuboid": Job(words=("reference", "cuboid"), bar=1.2, beside="import cadquery"),
}
BARE = {"a bare interpreter": "pass", "import cadquery": "import cadquery"}

ROOMS = {
    "importing": ("importlib", "<module>"),
    "reading files": ("identification/files", "identification/campaign", "h5py"),
    "spectra": ("identification/spectra", "identification/base_motion", "identification/consistency", "identification/quality"),
    "predicting": (
        "validation/prediction",
        "validation/effects",
        "validation/model",
        "identification/chain",
        "fem/",
        "geometry/",
    ),
    "identifying": ("identification/",),
    "fitting": ("validation/estimation",),
    "searching": ("validation/diagnose",),
    "maps": ("validation/compare",),
    "simulating": ("validation/virtual_test",),
    "drawing and writing": ("validation/report", "validation/output"),
}
"""What the time goes to, by what the file of a function begins with; of several the first."""


def unit(folder: Path) -> float:
    """[s] u, of the campaign in `folder`: its files read, and each of its records transformed at the next power of two."""
    began = time.process_time()
    for path in sorted(folder.glob("*.h5")):
        names: list[str] = []
        with h5py.File(path) as file:
            file.visit(names.append)
            records = [file[name][()] for name in names if isinstance(file[name], h5py.Dataset)]
        for record in (one for one in records if one.ndim == 1 and one.dtype.kind == "f" and len(one) > SHORTEST):
            np.fft.rfft(record, 2 ** int(np.ceil(np.log2(len(record)))))
    return time.process_time() - began


def cost(statement: str, *words: str, folder: Path) -> float:
    """[s] of processor time of a process in `folder` that runs `statement` with `words`."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    environment |= {
        "MASSLINE_CACHE": str(folder / "cache"),
        "PYTHONPYCACHEPREFIX": str(folder / "pyc"),
        "OPENBLAS_NUM_THREADS": "1",
    }
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    done = subprocess.run([sys.executable, "-c", statement, *words], cwd=folder, env=environment, capture_output=True)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(words)} ended with {done.returncode}: {done.stderr.decode()[-500:]}")
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def prepare(folder: Path) -> None:
    """Series and models in `folder`."""
    for name, more in (("sound", ()), ("gain", FAULT)):
        cost(COMMAND, "simulate", CUBOID, ONE, FOUR, "--out", name, *SEED, *more, folder=folder)
    cost(COMMAND, "model", ONE, "--out", "model.toml", folder=folder)


def cheapest(run: Callable[[], float]) -> float:
    """[s] of the runs of a command but the first, which fills what it keeps."""
    run()
    return min(run() for _ in range(ROUNDS))


def measured(folder: Path, names: list[str]) -> None:
    """Print the rows `names`."""
    console = Console()
    u = min(unit(folder / "sound" / ONE) for _ in range(5))
    start = cheapest(partial(cost, START, folder=folder))
    table = Table(title="What every job costs, on one core", title_justify="left", title_style="bold")
    for heading in ("job", "cost", "unit", "bar", ""):
        table.add_column(heading, justify="right" if heading in ("cost", "bar") else "left")
    seconds: dict[str, float] = {}
    for name in names:
        job = JOBS[name]
        for needed in (job.beside, name):
            if needed in BARE and needed not in seconds:
                seconds[needed] = cheapest(partial(cost, BARE[needed], folder=folder))
            elif needed and needed not in seconds:
                seconds[needed] = cheapest(partial(_once, folder, JOBS[needed].words))
        if job.beside:
            found, told = seconds[name] / seconds[job.beside], f"x {job.beside}"
        else:
            found, told = (seconds[name] - start) / u / job.campaigns, "u a campaign"
        bar = f"{job.bar:g}" if np.isfinite(job.bar) else ""
        row = (name, f"{found:.3g}", told, bar, ("met" if found <= job.bar else "missed") if bar else "")
        sys.stderr.write("  ".join(row) + "\n")  # what is known is seen before all is
        table.add_row(*row)
    console.print(table)
    console.print(f"start of any program that reads and computes: {start / u:.2f} u, taken off the rows in u")


def _once(folder: Path, words: tuple[str, ...], *how: str) -> float:
    """[s] of a command, with nothing there of what it wrote before."""
    shutil.rmtree(folder / "once", ignore_errors=True)
    (folder / "added.ladder.json").unlink(missing_ok=True)
    shutil.copy(folder / "model.toml", folder / "added.toml")
    return cost(*(how or (COMMAND,)), *words, folder=folder)


def profiled(folder: Path, names: list[str]) -> None:
    """Print what the processor time of the commands `names` goes to [%]."""
    table = Table(title="What the time goes to [%]", title_justify="left", title_style="bold")
    for heading in ("job", *ROOMS, "other"):
        table.add_column(heading, justify="left" if heading == "job" else "right")
    for name in names:
        words, path = JOBS[name].words, folder / "profile"
        _once(folder, words)
        _once(folder, words, PROFILED, str(path))
        rooms = by_room(pstats.Stats(str(path)))
        whole = sum(rooms.values())
        table.add_row(name, *(f"{100 * rooms[room] / whole:.0f}" for room in (*ROOMS, "other")))
    Console().print(table)


def by_room(stats: pstats.Stats) -> dict[str, float]:
    """[s] in the functions of each of `ROOMS`; that of a library's counts where it was called from."""
    every: dict[tuple[str, int, str], tuple[int, int, float, float, dict[tuple[str, int, str], tuple[int, int, float, float]]]]
    every = stats.stats  # type: ignore[attr-defined]
    house = f"{Path(__file__).resolve().parents[1]}/"

    def room(key: tuple[str, int, str]) -> str:
        file, _, name = key
        where = file.removeprefix(house)
        of = next((one for one, begins in ROOMS.items() if name in begins or any(begin in where for begin in begins)), "")
        return of if of in ("importing", "reading files") or (where != file and ".venv" not in where) else ""

    found = dict.fromkeys((*ROOMS, "other"), 0.0)
    for key, told in every.items():
        shares = {key: told[2]}
        for _ in range(12):  # calls inside of libraries
            passed: dict[tuple[str, int, str], float] = {}
            for one, size in shares.items():
                above = {caller: max(calls[3], 1e-9) for caller, calls in every[one][4].items()}
                above = {one: 1.0} if room(one) or not above else above
                for caller, weight in above.items():
                    passed[caller] = passed.get(caller, 0.0) + size * weight / sum(above.values())
            shares = passed
        for one, size in shares.items():
            found[room(one) or "other"] += size
    return found


def main() -> None:
    """Print what is asked."""
    asked = [word for word in sys.argv[1:] if not word.startswith("-")]
    names = [name for name in JOBS if not asked or any(name.startswith(word) for word in asked)]
    with TemporaryDirectory() as name:
        folder = Path(name)
        prepare(folder)
        if "--profile" in sys.argv[1:]:
            profiled(folder, [one for one in names if JOBS[one].beside == ""])
        else:
            measured(folder, names)


if __name__ == "__main__":
    main()
