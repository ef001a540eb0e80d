"""Desks on quick virtual tests: a block with a hidden gain, compared once a session, and a series with a mast."""

import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace

import pytest

from validation.app import opening, workers
from validation.app.kept import Compared
from validation.app.opening import Example, Series
from validation.app.session import Session, begun, opened
from validation.app.workers import Job

QUICK = Example(
    name="quick",
    title="A quick block",
    words="A cell reads 8 % too much.",
    articles=("fmd+cuboid",),
    effects=("force-gain:fmd-z2=0.08",),
    octaves_per_minute=120.0,
    driven=(8.0, 16.0),
    rate=256.0,
    tolerances="0.3",
    noise="0.1",
)


def made(example: Example) -> Series:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(opening, "EXAMPLES", (example,))
        return opening.made(example.name)


@pytest.fixture(scope="session", autouse=True)
def _quick_workers(quick_workers) -> None: ...


@pytest.fixture(scope="session")
def block() -> Series:
    """The files of a quick example."""
    return made(QUICK)


@pytest.fixture(scope="session")
def mast() -> Series:
    """Of a series that bends."""
    return made(replace(QUICK, name="mast", articles=("fmd+cuboid", "fmd+clumod-1")))


@dataclass(frozen=True, eq=False, kw_only=True)
class Worked:
    """A desk that was compared, and diagnosed by a worker."""

    desk: Session
    compared: Compared
    heard: list[str]
    job: Job


@pytest.fixture(scope="session")
def worked(block, tmp_path_factory) -> Worked:
    """Not to be changed: `fresh` gives copies of it."""
    desk = begun(tmp_path_factory.mktemp("desks") / "one", block.model, block.data, title="one")
    heard: list[str] = []
    found = desk.compare(lambda what, share: heard.append(what))
    return Worked(desk=desk, compared=found, heard=heard, job=workers.start(desk, workers.DIAGNOSE).wait())


@pytest.fixture
def fresh(worked) -> Callable[[str], Session]:
    """``fresh(name)``: a copy of that desk beside it."""

    def copy(name: str) -> Session:
        folder = worked.desk.folder.parent / name
        shutil.copytree(worked.desk.folder, folder)
        return opened(folder)

    return copy


@pytest.fixture
def bare(block, tmp_path) -> Session:
    """A desk on which nothing was done yet."""
    return begun(tmp_path / "desk", block.model, block.data)
