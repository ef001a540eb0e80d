"""Every picture that README and docs show, by one command:

    python examples/gallery.py [NAME ...]

Without a name all of them are drawn anew, into ``docs/pictures``; `DRAWN` and `TOLD` say which picture comes of what. A story is
what a reader would type, in an empty folder, and what of its files becomes a picture.
"""

from __future__ import annotations

import os
import runpy
import shlex
import sys
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass, field
from pathlib import Path
from tempfile import TemporaryDirectory

import in_browser
import pictures

from tools.drawing import draw as draw_rooms
from tools.pages import commands

HERE = Path(__file__).resolve().parent
PICTURES = HERE.parent / "docs" / "pictures"
TUTORIAL, REPORT, FRAME = (HERE.parent / "docs" / name for name in ("tutorial.md", "report.md", "three-storey-frame.md"))
DATA = Path(os.environ.get("MASSLINE_DATA", HERE.parent.parent / "shared" / "data")).resolve()


@dataclass(frozen=True, kw_only=True)
class Story:
    """Commands, one a line, and what of the files that they write becomes which picture.

    Attributes
    ----------
    commands : ``massline ...`` or ``python examples/...``, run in order in a folder of their own
    pictures : by name in ``docs/pictures`` the file; of a page also the sections that are photographed
    needs : folder of data without which it is passed over; None when it needs none
    files : what lies in the folder beforehand, by path
    """

    commands: str
    pictures: Mapping[str, str]
    needs: Path | None = None
    files: Mapping[str, Path] = field(default_factory=dict)


def articles(folder: Path) -> None:
    """The built-in articles on one sheet."""
    pictures.main(Path("out/pictures"), folder / "articles.png")


DRAWN: Mapping[str, tuple[Callable[[Path], None], tuple[str, ...]]] = {
    "articles": (articles, ("articles",)),
    "flexible-bodies": (pictures.flexible_bodies, ("modes-clumod-4", "dynamic-mass")),
    "base-excitation": (pictures.base_excitation, ("excite-clumod-1",)),
    "pendulum": (pictures.pendulum, ("swing",)),
    "architecture": (lambda folder: draw_rooms(folder / "architecture.png"), ("architecture",)),
    "workbench": (in_browser.workbench, ("workbench-compared", "workbench-cause")),
}
"""Drawn by functions of `pictures`, `in_browser` and `tools.drawing`."""

HIDDEN = "out/hidden"
PLANTED = "--effect modulus:mast=0.06 --effect point-mass:mast-top=0.2"
UNSEEN = "--hold-out fmd+clumod-1/x --hold-out fmd+clumod-1/beta"
STUDY = f"out/model.toml out/test/fmd+cuboid out/test/fmd+clumod-1 {UNSEEN}"

TOLD: Mapping[str, Story] = {
    "sensors": Story(
        commands="""
            massline simulate fmd+clumod-1 --out out/one-blade --octaves-per-minute 60
            massline check out/one-blade --view
        """,
        pictures={"sensors-virtual": "out/sensors-one-blade.png"},
    ),
    "peak-hold-bias": Story(
        commands="python examples/peak_hold_bias.py out/peak-hold-bias.png", pictures={"peak-hold-bias": "out/peak-hold-bias.png"}
    ),
    "tutorial": Story(
        commands="\n".join(
            line for line in commands(HERE.parent / "docs" / "tutorial.md") if not line.startswith("massline app")
        ),
        pictures={
            "tutorial-channels": f"{HIDDEN}/compared/compare-fmd+clumod-1-channels.png",
            "tutorial-dynamic-mass": f"{HIDDEN}/compared/compare-dynamic-mass.png",
            "diagnose-errors": f"{HIDDEN}/diagnosed/diagnose-errors.png",
            "tutorial-ladder": f"{HIDDEN}/ladder/model-ladder.png",
            "tutorial-inertia": f"{HIDDEN}/ladder/model-ladder-clumod-1.png",
            "tutorial-report": f"{HIDDEN}/report.html#summary,ladder",
        },
    ),
    "report": Story(commands="\n".join(commands(REPORT)), pictures={"report": "out/cuboid.html#summary,missing"}),
    "cross-check": Story(
        commands=f"""
            massline simulate fmd+cuboid fmd+clumod-1 --seed 4 --octaves-per-minute 6 {PLANTED} --out out/test
            massline model fmd+clumod-1 --out out/model.toml
            massline compare {STUDY} --out out
            massline add {STUDY.replace(" ", " force-gain:fmd-z2 ", 1)}
            massline undo out/model.toml
            massline add {STUDY.replace(" ", " point-mass:mast-top ", 1)}
            massline ladder out/model.toml --out out
        """,
        pictures={
            "compare-channels": "out/compare-fmd+clumod-1-channels.png",
            "ladder-fall": "out/model-ladder.png",
            "ladder-inertia": "out/model-ladder-clumod-1.png",
        },
    ),
    "table-2": Story(
        commands="python examples/table_2.py --out out",
        pictures={"table-2": "out/table-2.png", "table-2-decide": "out/table-2-decide.png"},
    ),
    "three-storey-frame": Story(
        commands="\n".join(commands(FRAME)),
        pictures={"three-storey-frame-ladder": "out/three-storey/frame-ladder.png"},
        files={"out/three-storey/frame.toml": HERE / "league" / "three-storey-frame.toml"},
        needs=DATA / "three_storey_frame",
    ),
}
"""What commands leave behind."""


def draw(name: str, folder: Path = PICTURES) -> None:
    """Draw what goes by `name` into `folder`; nothing where it needs data that are absent."""
    if name in DRAWN:
        DRAWN[name][0](folder)
        return
    story = TOLD[name]
    if story.needs is not None and not story.needs.is_dir():
        sys.stderr.write(f"{name} is passed over: {story.needs} is absent\n")
        return
    os.environ.setdefault("MASSLINE_DATA", str(DATA))
    with TemporaryDirectory() as place, inside(place):
        for path, file in story.files.items():
            Path(path).parent.mkdir(parents=True, exist_ok=True)
            Path(path).write_bytes(file.read_bytes())
        for line in filter(None, map(str.strip, story.commands.splitlines())):
            done(line)
        for shown, file in story.pictures.items():
            leave(file, folder / f"{shown}.png")


def leave(what: str, picture: Path) -> None:
    """The picture of what a story has left: a picture already, or a page and the sections of it that are shown."""
    file, _, sections = what.partition("#")
    if file.endswith(".html"):
        in_browser.report(Path(file), picture, sections.split(","))
    else:
        picture.write_bytes(Path(file).read_bytes())


def done(line: str) -> None:
    """Run a line as a reader would type it; a line that fails ends everything."""
    from validation.cli.main import run

    program, *arguments = shlex.split(line)
    if program == "massline":
        if run(arguments):
            raise SystemExit(f"`{line}` failed")
        return
    before, sys.argv = sys.argv, arguments
    try:
        runpy.run_path(str(HERE.parent / arguments[0]), run_name="__main__")
    except SystemExit as left:
        if left.code:
            raise
    finally:
        sys.argv = before


@contextmanager
def inside(folder: str) -> Iterator[None]:
    """In `folder` meanwhile."""
    before = Path.cwd()
    os.chdir(folder)
    try:
        yield
    finally:
        os.chdir(before)


def drawn() -> Mapping[str, tuple[str, ...]]:
    """By name what it draws."""
    return {name: shown for name, (_, shown) in DRAWN.items()} | {name: tuple(story.pictures) for name, story in TOLD.items()}


def main(names: list[str]) -> None:
    """Draw what goes by `names`, everything without one."""
    unknown = set(names) - set(drawn())
    if unknown:
        raise SystemExit(f"there is no {', '.join(sorted(unknown))}; there are {', '.join(drawn())}")
    for name in names or drawn():
        draw(name)


if __name__ == "__main__":
    main(sys.argv[1:])
