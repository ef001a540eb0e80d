"""What a report costs beside the diagnosis and the comparison that are in it: each a command of its own, as a user gives it.

The series is Cuboid on its disc and Clumod with one blade, one load cell of which reads too much; times are processor times of
the commands. What they keep on disk (`geometry.cache`) is in a folder that begins empty; the first report fills it and is counted
apart. A diagnosis is kept as well, so that every command that diagnoses is given a model of another title and makes its own: the
bar is one of a report that no diagnosis went before. One that reads a diagnosis back is a row beside it.
"""

from __future__ import annotations

import os
import re
import resource
import subprocess
import sys
from collections.abc import Callable
from itertools import count
from pathlib import Path
from tempfile import TemporaryDirectory

from benchmarks.ratios import Timing, measure, show

COMMAND = "from validation.cli.main import run; import sys; run(sys.argv[1:])"
ARTICLES = ("fmd+disc+cuboid", "fmd+clumod-1")
SWEEPS = ("--seed", "11", "--octaves-per-minute", "8", "--effect", "force-gain:fmd-z2=0.05")
ROUNDS = 2
BAR = 1.15
"""[1] of a report that diagnoses to a diagnosis of the same data, once what depends on the data alone is kept."""


def massline(folder: Path, *arguments: str) -> Callable[[], object]:
    """A callable that gives the command line in `folder` and waits for its end."""
    environment = os.environ | {"MASSLINE_CACHE": str(folder / "cache"), "OPENBLAS_NUM_THREADS": "1"}
    words = [sys.executable, "-c", COMMAND, *arguments]
    return lambda: subprocess.run(words, cwd=folder, env=environment, check=True, capture_output=True)


def clock() -> float:
    """[s] of processor time of all commands that have ended."""
    used = resource.getrusage(resource.RUSAGE_CHILDREN)
    return used.ru_utime + used.ru_stime


def main() -> None:
    """Print the ratios, and whether the bar is met."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        massline(folder, "simulate", *ARTICLES, "--out", "series", *SWEEPS)()
        massline(folder, "model", ARTICLES[-1], "--out", "model.toml")()
        data = [f"series/{article}" for article in ARTICLES]
        page = ("report", "model.toml", *data, "--out", "report.html")
        first: dict[str, Timing] = measure({"report, nothing kept": massline(folder, *page)}, 1, clock)
        model, titles = (folder / "model.toml").read_text(encoding="utf-8"), count(1)

        def anew(*arguments: str) -> Callable[[], object]:
            """The command of a model of another title."""
            run = massline(folder, *arguments)

            def titled() -> None:
                text = re.sub(r"^title = .*$", f'title = "model {next(titles)}"', model, count=1, flags=re.MULTILINE)
                (folder / "model.toml").write_text(text, encoding="utf-8")
                run()

            return titled

        commands = {
            "report": anew(*page),
            "diagnose": anew("diagnose", "model.toml", *data),
            "report of what was diagnosed": massline(folder, *page),
            "compare": massline(folder, "compare", "model.toml", *data),
        }
        timings = first | measure(commands, ROUNDS, clock)
    ratio = timings["report"].fastest / timings["diagnose"].fastest
    verdict = f"bar {BAR:g}: {'met' if ratio <= BAR else 'missed'}"
    show("A report", timings, base="diagnose", notes={"report": verdict})


if __name__ == "__main__":
    main()
