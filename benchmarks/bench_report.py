"""What a report costs beside the diagnosis and the comparison that are in it: each a command of its own, as a user gives it.

The series is Cuboid on its disc and Clumod with one blade, one load cell of which reads too much. What the commands keep on disk
(`geometry.cache`) is in a folder that begins empty; the first report fills it and is counted apart. A diagnosis is kept as well:
a model of another title has none, so that it is made anew by ``diagnose``, and by a report that no diagnosis went before.
"""

from __future__ import annotations

import os
import re
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
BAR = 1.15
"""[1] of a report to a diagnosis of the same data just before it, once what depends on the data alone is kept."""


def massline(folder: Path, *arguments: str) -> Callable[[], object]:
    """A callable that gives the command line in `folder` and waits for its end."""
    environment = os.environ | {"MASSLINE_CACHE": str(folder / "cache"), "OPENBLAS_NUM_THREADS": "1"}
    words = [sys.executable, "-c", COMMAND, *arguments]
    return lambda: subprocess.run(words, cwd=folder, env=environment, check=True, capture_output=True)


def main() -> None:
    """Print the ratios, and whether the bar is met."""
    with TemporaryDirectory() as name:
        folder = Path(name)
        massline(folder, "simulate", *ARTICLES, "--out", "series", *SWEEPS)()
        massline(folder, "model", ARTICLES[-1], "--out", "model.toml")()
        data = [f"series/{article}" for article in ARTICLES]
        first: dict[str, Timing] = measure(
            {"report, nothing kept": massline(folder, "report", "model.toml", *data, "--out", "report.html")}, 1
        )
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
            "report that diagnoses": anew("report", "model.toml", *data, "--out", "report.html"),
            "diagnose": anew("diagnose", "model.toml", *data),
            "report": massline(folder, "report", "model.toml", *data, "--out", "report.html"),
            "compare": massline(folder, "compare", "model.toml", *data),
            "report --no-diagnosis": massline(folder, "report", "model.toml", *data, "--no-diagnosis", "--out", "report.html"),
        }
        timings = first | measure(commands, 3)
    ratio = timings["report"].fastest / timings["diagnose"].fastest
    verdict = f"bar {BAR:g}: {'met' if ratio <= BAR else 'missed'}"
    show("A report", timings, base="diagnose", notes={"report": verdict})


if __name__ == "__main__":
    main()
