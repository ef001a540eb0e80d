"""What every job of a test day costs, in units u = reading a campaign's files with h5py and one zero-padded FFT of every record.

All jobs are commands as a user types them, each in a process of its own on one core, and what counts is the processor time of
that process, so that others on the machine disturb little. From it goes what any program would pay before it begins: a process
that imports numpy, scipy.linalg and h5py. What massline imports itself stays in. What commands keep on disk, `geometry.cache`, is
in a folder that begins empty, and one run of each command that is not counted fills it, with another series of the same articles:
what is measured is the answer about new records, and a whole answer that was kept would be none.

    python -m benchmarks.bench_costs                 the table, the bar of every row, and whether it is met
    python -m benchmarks.bench_costs --profile       what the time of each command goes to
    python -m benchmarks.bench_costs check compare   some rows alone

u is measured beside every row. Series and rows that are done are kept under ``out/costs`` and not done again by the same code:
interrupting loses none of it, and the table is printed from all rows that there are. ``--anew`` measures again what is asked.
"""

from __future__ import annotations

import json
import os
import pstats
import re
import resource
import shutil
import subprocess
import sys
import time
from collections.abc import Sequence
from dataclasses import dataclass
from pathlib import Path

import h5py
import numpy as np
from rich.console import Console
from rich.table import Table

from geometry import cache
from geometry.atomic import write_text

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
WORKBENCH = """
import asyncio, json, sys, time
from pathlib import Path
from types import SimpleNamespace
from validation.app import curves, panels, session, whatif
from validation.app.options import StartOptions
from validation.app.state import WindowState
from validation.app.window import first_state

class State(SimpleNamespace):
    def flush(self): pass
    def __getitem__(self, name): return getattr(self, name)

began = time.process_time() if sys.argv[2] != "first figures" else 0.0
desk = session.begun(Path(sys.argv[1]), "model.toml", sys.argv[3:])
window = WindowState(state=State(**first_state()), folder=Path("."), opened=StartOptions(), session=desk)
window.begin = lambda work: work.close()
desk.compare()
asyncio.run(panels.stands(window))
taken = [time.process_time()]
if sys.argv[2] == "click on a cell":
    taken = []
    for load in range(6):
        began = time.process_time()
        asyncio.run(panels.entry(window, load, 2))
        taken.append(time.process_time() - began)
if sys.argv[2] == "slider":
    table, taken = whatif.table(desk), []
    for size in (0.01, 0.02, 0.03, 0.04, 0.05, 0.06):
        began = time.process_time()
        window.tried = whatif.what_if(table, f"force-gain:fmd-z2={size}", exact=False)
        asyncio.run(curves.drawn(window))
        taken.append(time.process_time() - began)
print(json.dumps(sorted(taken)[len(taken) // 2]))
"""
"""The server's side of the workbench, without its browser: argv is a new folder, what is done, and the data."""

CUBOID, ONE, FOUR = "fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4"
SEED = ("--seed", "11")
FAULT = ("--effect", "force-gain:fmd-z2=0.05")

MILLISECONDS = "ms"
"""The unit of what a hand waits for, on this machine: no ratio."""

OUT = Path("out/costs")

SHORTEST = 1000
"""[samples] of a record; shorter arrays of a file say something else."""


@dataclass(frozen=True, kw_only=True)
class Job:
    """One row.

    Attributes
    ----------
    words : of the command line, in the folder of the series
    campaigns : over how many the cost is told
    bar : at most [u a campaign], or times `beside`
    beside : name of another row that is the unit; empty for u
    bench : what is done in the workbench instead of a command
    """

    words: tuple[str, ...]
    bar: float
    campaigns: int = 1
    beside: str = ""
    bench: str = ""


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
    "first figures": Job(words=(f"sound/{CUBOID}", f"sound/{ONE}"), bar=5.0, campaigns=2, bench="first figures"),
    "click on a cell": Job(words=(f"sound/{CUBOID}", f"sound/{ONE}"), bar=100.0, bench="click on a cell", beside=MILLISECONDS),
    "slider": Job(words=(f"sound/{CUBOID}", f"sound/{ONE}"), bar=50.0, bench="slider", beside=MILLISECONDS),
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
    before = resource.getrusage(resource.RUSAGE_CHILDREN)
    ran(statement, *words, folder=folder)
    after = resource.getrusage(resource.RUSAGE_CHILDREN)
    return after.ru_utime - before.ru_utime + after.ru_stime - before.ru_stime


def ran(statement: str, *words: str, folder: Path) -> str:
    """What a process in `folder` prints that runs `statement` with `words`."""
    environment = {key: value for key, value in os.environ.items() if key != "PYTHONDONTWRITEBYTECODE"}
    environment |= {
        "MASSLINE_CACHE": str(folder.resolve() / "cache"),
        "PYTHONPYCACHEPREFIX": str(folder.resolve() / "pyc"),
        "PYTHONPATH": str(Path(__file__).resolve().parents[1]),
        "OPENBLAS_NUM_THREADS": "1",
    }
    done = subprocess.run([sys.executable, "-c", statement, *words], cwd=folder, env=environment, capture_output=True)
    if done.returncode not in (0, 1):
        raise RuntimeError(f"{' '.join(words)} ended with {done.returncode}: {done.stderr.decode()[-500:]}")
    return done.stdout.decode()


def prepare(folder: Path) -> None:
    """Series and models in `folder`, where they are not there yet."""
    if (folder / "model.toml").exists():
        return
    folder.mkdir(parents=True, exist_ok=True)
    for name, more in (("sound", ()), ("gain", FAULT)):
        shutil.rmtree(folder / name, ignore_errors=True)
        cost(COMMAND, "simulate", CUBOID, ONE, FOUR, "--out", name, *SEED, *more, folder=folder)
    cost(COMMAND, "model", ONE, "--out", "model.toml", folder=folder)


def found(folder: Path, job: Job) -> float:
    """The cost of `job` in its unit."""
    if job.beside == MILLISECONDS:
        return 1e3 * workbench(folder, job)
    if job.beside:
        bare = job.beside in BARE
        return once(folder, job.words) / (cheapest(BARE[job.beside], folder) if bare else once(folder, JOBS[job.beside].words))
    u = min(unit(folder / "sound" / ONE) for _ in range(3))
    whole = workbench(folder, job) if job.bench else once(folder, job.words)
    return (whole - cheapest(START, folder)) / u / job.campaigns


def cheapest(statement: str, folder: Path) -> float:
    """[s] of a process that runs `statement`, the best of three after one that is not counted."""
    cost(statement, folder=folder)
    return min(cost(statement, folder=folder) for _ in range(3))


def once(folder: Path, words: Sequence[str], *how: str) -> float:
    """[s] of a command about new records, with nothing there of what it wrote before; see the head of this file."""
    taken = 0.0
    for series in (_other(words), words):
        shutil.rmtree(folder / "once", ignore_errors=True)
        (folder / "added.ladder.json").unlink(missing_ok=True)
        # Another title is another model, so that no answer of an earlier run of this benchmark is read back
        text = (folder / "model.toml").read_text(encoding="utf-8")
        renamed = re.sub(r"^title = .*$", f'title = "at {time.time_ns()}"', text, count=1, flags=re.MULTILINE)
        (folder / "added.toml").write_text(renamed, encoding="utf-8")
        asked = [word.replace("model.toml", "added.toml") for word in series]
        taken = cost(*(how if how and series is words else (COMMAND,)), *asked, folder=folder)
    return taken


def _other(words: Sequence[str]) -> list[str]:
    """The same of the other series."""
    return [re.sub(r"^(sound|gain)/", lambda at: "gain/" if at[1] == "sound" else "sound/", word) for word in words]


def workbench(folder: Path, job: Job) -> float:
    """[s] of what `job` does in a workbench on new records."""
    printed = ""
    for series in (_other(job.words), job.words):
        shutil.rmtree(folder / "desk", ignore_errors=True)
        printed = ran(WORKBENCH, "desk", job.bench, *series, folder=folder)
    return float(json.loads(printed.splitlines()[-1]))


def measured(folder: Path, names: list[str], *, anew: bool) -> None:
    """Measure the rows `names` that this code has not measured yet, and print all that are known of it."""
    path = folder / "rows.json"
    rows: dict[str, float] = {}
    if path.exists() and (kept := json.loads(path.read_text(encoding="utf-8")))["code"] == cache.code():
        rows = kept["rows"]
    for name in names:
        if anew or name not in rows:
            rows[name] = found(folder, JOBS[name])
            write_text(path, json.dumps({"code": cache.code(), "rows": rows}, indent=2))
            sys.stderr.write(f"{'  '.join(row(name, rows[name]))}\n")  # what is known is seen before all is
    table = Table(title="What every job costs, on one core", title_justify="left", title_style="bold")
    for heading in ("job", "cost", "unit", "bar", ""):
        table.add_column(heading, justify="right" if heading in ("cost", "bar") else "left")
    for name in (one for one in JOBS if one in rows):
        table.add_row(*row(name, rows[name]))
    Console().print(table)


def row(name: str, figure: float) -> tuple[str, ...]:
    """The cells of a row that cost `figure`."""
    job = JOBS[name]
    told = "ms" if job.beside == MILLISECONDS else f"x {job.beside}" if job.beside else "u a campaign"
    bar = f"{job.bar:g}" if np.isfinite(job.bar) else ""
    return name, f"{figure:.3g}", told, bar, ("met" if figure <= job.bar else "missed") if bar else ""


def profiled(folder: Path, names: list[str]) -> None:
    """Print what the processor time of the commands `names` goes to [%]."""
    table = Table(title="What the time goes to [%]", title_justify="left", title_style="bold")
    for heading in ("job", *ROOMS, "other"):
        table.add_column(heading, justify="left" if heading == "job" else "right")
    for name in names:
        words, path = JOBS[name].words, folder / "profile"
        once(folder, words, PROFILED, str(path.resolve()))
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
    folder = OUT
    prepare(folder)
    if "--profile" in sys.argv[1:]:
        profiled(folder, [one for one in names if not JOBS[one].beside and not JOBS[one].bench])
    else:
        measured(folder, names, anew="--anew" in sys.argv[1:])


if __name__ == "__main__":
    main()
