"""The campaign folder: ``campaign.toml`` and the signal files that it names. Read without changing it, written whole.

    campaign = read("one-blade")            # everything, or a refusal in words
    found = examine("one-blade")            # all that is wrong with it at once
    write("copy", campaign, ending=".uff")

The contract is the page "campaign format" of the project's shared documents; `docs/campaigns.md` tells it to a user.
"""

from __future__ import annotations

import os
import stat
from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from pathlib import Path, PurePosixPath, PureWindowsPath

from geometry import toml_file
from geometry.atomic import write_text
from geometry.errors import BadInput
from identification import files
from identification.campaign import Campaign, Run
from identification.campaign_checks import problems_of_table, warnings_of_recordings
from identification.campaign_text import parse
from identification.campaign_values import Problems
from identification.campaign_words import text
from identification.files.contents import Signals, StatedUnits, require_file
from identification.matching import recording
from identification.recording import Recording
from identification.units import factor

NAME = "campaign.toml"

LARGEST_TEXT = 10_000_000
"""Bytes: a campaign of a thousand channels needs a hundredth of it."""

Progress = Callable[[float], None]
"""Called with the share done, 0 to 1; it may raise to end the work."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Examined:
    """What a folder holds and what is wrong with it.

    Attributes
    ----------
    campaign : with the recordings that can be used; None where its description cannot be
    problems : each of them makes the folder unusable as it is
    """

    campaign: Campaign | None
    problems: tuple[BadInput, ...]


def read(folder: str | Path, *, progress: Progress | None = None) -> Campaign:
    """The campaign in `folder`, with all its recordings in SI.

    Raises
    ------
    BadInput : whatever is wrong with it; of several problems the first, and how many more there are.
    OSError : a file cannot be read.
    """
    found = examine(folder, progress=progress)
    if found.campaign is not None and not found.problems:
        return found.campaign
    first, more = found.problems[0], len(found.problems) - 1
    if not more:
        raise first
    remedy = f"{first.remedy.rstrip('. ')}. `massline check` lists this and {more} more"
    raise BadInput(source=first.source, field=first.field, problem=first.problem, remedy=remedy)


def read_description(folder: str | Path) -> Campaign:
    """The campaign in `folder` as ``campaign.toml`` describes it, without recordings: quick.

    Raises
    ------
    BadInput : the first thing that is wrong with ``campaign.toml``.
    """
    problems = Problems()
    campaign = _described(Path(folder), problems)
    if campaign is None or problems.found:
        raise problems.found[0]
    return campaign


def examine(folder: str | Path, *, progress: Progress | None = None) -> Examined:
    """The campaign in `folder` and all that is wrong with it; a run that cannot be used does not hide the next.

    Raises
    ------
    OSError : a file cannot be read.
    """
    problems = Problems()
    campaign = _described(Path(folder), problems)
    if campaign is None:
        return Examined(campaign=None, problems=tuple(problems.found))
    problems.found += problems_of_table(campaign.table, f"{folder}/{NAME}")
    recordings: dict[str, Recording] = {}
    for k, run in enumerate(campaign.runs):
        one = problems.attempt(_recorded, Path(folder), run, campaign, problems)
        recordings |= {} if one is None else {run.name: one}
        if progress is not None:
            progress((k + 1) / len(campaign.runs))
    warnings = (*campaign.warnings, *warnings_of_recordings(campaign, recordings))
    return Examined(campaign=replace(campaign, recordings=recordings, warnings=warnings), problems=tuple(problems.found))


def write(folder: str | Path, campaign: Campaign, *, ending: str | None = ".h5", progress: Progress | None = None) -> None:
    """Write `campaign` to the new `folder`, its runs as ``<name><ending>``, or with None as the files that they name.

    ``campaign.toml`` comes last: a folder whose writing was interrupted is none.

    Raises
    ------
    BadInput : the folder holds something already, a run without recording or with a name that is no file name, or what the format
        cannot hold.
    OSError : the folder cannot be written.
    """
    folder = Path(folder)
    if folder.exists() and (not folder.is_dir() or any(folder.iterdir())):
        problem = "it is there already and not empty"
        raise BadInput(source=str(folder), problem=problem, remedy="Name a new folder; a campaign is never overwritten")
    if ending is not None:
        files.require_known(f"x{ending}", "write", "ending")
    runs = [run if ending is None else replace(run, file=_file_name(run, ending, folder)) for run in campaign.runs]
    for k, run in enumerate(runs):
        if run.name not in campaign.recordings:
            raise BadInput(
                source=str(folder), field=f"run.{run.name}", problem="has no recording", remedy="Record or read it first"
            )
        path = inside(folder, run.file, str(folder), f"run.{run.name}.file")
        files.write(path, _signals(campaign.recordings[run.name], campaign))
        if progress is not None:
            progress((k + 1) / len(runs))
    write_text(folder / NAME, text(replace(campaign, runs=tuple(runs))))


def _described(folder: Path, problems: Problems) -> Campaign | None:
    path = folder / NAME
    table = problems.attempt(_table, folder, path)
    if table is None:
        return None
    campaign = parse(table, str(path), problems)
    return None if campaign is None else replace(campaign, source=str(folder))


def _table(folder: Path, path: Path) -> Mapping[str, object]:
    if not folder.is_dir():
        problem = "it is no folder" if folder.exists() else "there is no such folder"
        raise BadInput(source=str(folder), problem=problem, remedy=f"Name the folder that holds {NAME}")
    if not path.exists() and not path.is_symlink():
        raise BadInput(source=str(folder), problem=f"it holds no {NAME}", remedy="Name the folder of the campaign itself")
    require_file(path)
    if path.stat().st_size > LARGEST_TEXT:
        raise BadInput(source=str(path), problem="it is larger than any campaign.toml", remedy="Check what it holds")
    return toml_file.read(path)


def _recorded(folder: Path, run: Run, campaign: Campaign, problems: Problems) -> Recording | None:
    path = inside(folder, run.file, f"{folder}/{NAME}", f"run.{run.name}.file")
    try:
        signals = files.read(path)
    except OSError as error:
        problem = f"it cannot be read: {error.strerror or error}"
        raise BadInput(source=str(path), problem=problem, remedy="Check its name and permissions") from None
    made, found = recording(signals, campaign.table, f"{folder.name}/{NAME}")
    problems.found += found
    return made


def inside(folder: Path, name: str, source: str, field: str) -> Path:
    """The path of the file `name` in `folder`, reached without leaving it and without links.

    Raises
    ------
    BadInput : it is absolute, climbs out of the folder, or passes a link.
    """

    def refused(problem: str) -> BadInput:
        return BadInput(source=source, field=field, problem=problem, remedy="Put the file into the folder and name it from there")

    parts = PurePosixPath(name).parts
    absolute = PurePosixPath(name).is_absolute() or bool(PureWindowsPath(name).drive) or "\\" in name or "\0" in name
    if absolute or ".." in parts or not parts:
        raise refused(f"must be a file inside the folder, found {name!r}")
    path = folder
    for part in parts:
        path = path / part
        if _is_link(path):
            raise refused(f"is reached over the link {part!r}, which is not followed")
    return path


def _is_link(path: Path) -> bool:
    try:
        return stat.S_ISLNK(os.lstat(path).st_mode)
    except (OSError, ValueError):
        return False


def _file_name(run: Run, ending: str, folder: Path) -> str:
    name = f"{run.name}{ending}"
    if PurePosixPath(name).name != name or "\\" in name or not name.isprintable() or name.startswith("."):
        problem = f"cannot be the name of a file, found {run.name!r}"
        raise BadInput(source=str(folder), field="run.name", problem=problem, remedy="Rename the run")
    return name


def _signals(recorded: Recording, campaign: Campaign) -> Signals:
    """The samples in the units of the channel table."""
    if recorded.names != campaign.table.names:
        problem = f"has other channels than the table: {', '.join(recorded.names)}"
        raise BadInput(source=recorded.source, problem=problem, remedy="Put them in the order of the table")
    sizes = [factor(c.unit, c.quantity, source="channel", field=c.name) for c in campaign.table.channels]
    samples = {name: recorded.values[:, k] / sizes[k] for k, name in enumerate(recorded.names)}
    return Signals(
        source=recorded.source,
        samples=samples,
        sampling_rate=recorded.sampling_rate,
        frequency=recorded.frequency,
        units={c.name: _stated(c.quantity, sizes[k]) for k, c in enumerate(campaign.table.channels)},
        labels={c.name: c.unit for c in campaign.table.channels},
    )


def _stated(quantity: str, size: float) -> StatedUnits:
    """A system of units in which `quantity` has the unit of `size` in SI."""
    length, force = (size, 1.0) if quantity == "acceleration" else (1.0, size)
    return StatedUnits(length=length, force=force, words="massline")
