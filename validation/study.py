"""The data of a comparison: campaign folders and classical measurement files together, told apart and read.

What contradicts itself is refused before the first signal is read: the same folder twice, one article on two FMDs, files
without any campaign. What a model has to do with them is `validation.model.model`.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from math import isfinite
from pathlib import Path

from geometry.errors import BadInput
from geometry.toml_file import nearest
from identification import campaign_file
from identification.campaign import METHODS, Campaign
from validation.classical import files
from validation.estimation.problem import Problem
from validation.history.history import reminded
from validation.model import model_file
from validation.model.model import Model, require_pair
from validation.prediction.classical_facts import require_bodies

TRUTH = ".truth.json"
"""Ending of what `massline simulate` writes beside its campaigns."""

Progress = Callable[[str, float], None]
"""Hears which folder is read, and the share of it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Data:
    """What a model is compared with.

    Attributes
    ----------
    campaigns : with their recordings, in the order in which they were named
    classical : names of measurement files
    """

    campaigns: tuple[Campaign, ...]
    classical: tuple[str, ...] = ()


def read_data(paths: Sequence[str], model: Model, progress: Progress | None = None) -> Data:
    """The data at `paths`, which belong to `model` and to each other.

    Raises
    ------
    BadInput : a path that is neither a campaign nor a measurement, data that contradict each other or the model, no campaign,
        effects that leave no body of an article.
    OSError : a file cannot be read.
    """
    folders = [path for path in paths if Path(path).is_dir()]
    files = [path for path in paths if path not in folders]
    for path in files:
        _require_measurement(path)
    _require_once(paths)
    if not folders:
        raise BadInput(
            source="DATA",
            problem="there is no campaign among them, and weights and periods alone tell nothing of frequencies",
            remedy="Name a campaign folder, too; `massline weigh`, `cog` and `pendulum` reduce the files alone",
        )
    described = [campaign_file.read_description(folder) for folder in folders]
    _require_one_hardware(described)
    require_pair(model, described)
    require_bodies(model, described)
    return Data(campaigns=tuple(_read(folder, progress) for folder in folders), classical=tuple(files))


def only_files(paths: Sequence[str]) -> tuple[str, ...]:
    """`paths` where all of them are files that are there: measurements that stand by themselves, without any campaign.

    Raises
    ------
    BadInput : one of them is no measurement, or is named twice.
    """
    if not all(Path(path).is_file() or path.removesuffix(".toml") in files.shipped() for path in paths):
        return ()
    for path in paths:
        _require_measurement(path)
    _require_once(paths)
    return tuple(paths)


def _read(folder: str, progress: Progress | None) -> Campaign:
    return campaign_file.read(folder, progress=None if progress is None else lambda share: progress(folder, share))


def _require_measurement(path: str) -> None:
    """Refuse what is no measurement file, and what is not there."""
    if Path(path).name == campaign_file.NAME:
        problem = "this is the description of a campaign"
        raise BadInput(source=path, problem=problem, remedy=f"Name its folder, {Path(path).parent}")
    if path.endswith(TRUTH):
        problem = "this is the truth beside a simulated campaign, which no comparison may know"
        raise BadInput(source=path, problem=problem, remedy="Leave it out: name the folders alone")
    known = files.shipped()
    if not Path(path).exists() and path.removesuffix(".toml") not in known:
        beside = [str(one) for one in Path(path).parent.iterdir()] if Path(path).parent.is_dir() else []
        remedy = f"{nearest(path, beside)}Name campaign folders, and weigh, cog and pendulum files"
        raise BadInput(source=path, problem="there is no such file or folder", remedy=remedy)
    files.read(path, files.KINDS)


def _require_once(paths: Sequence[str]) -> None:
    seen: dict[Path, str] = {}
    for path in paths:
        where = Path(path).resolve()
        if where in seen:
            same = "is named twice" if seen[where] == path else f"is the same as {seen[where]}"
            raise BadInput(
                source="DATA", field=path, problem=same, remedy="Data that count twice are trusted twice: name it once"
            )
        seen[where] = path


def _require_one_hardware(campaigns: Sequence[Campaign]) -> None:
    """One article on two FMDs is two series, whatever the model says."""
    for k, one in enumerate(campaigns):
        for other in campaigns[:k]:
            if one.article == other.article and one.hardware != other.hardware and one.hardware and other.hardware:
                raise BadInput(
                    source=f"{one.source}/{campaign_file.NAME}",
                    field="campaign.hardware",
                    problem=f"is {one.hardware}, and that of {other.source}, also of {one.article}, is {other.hardware}",
                    remedy="Another FMD has other sensors: compare each series with a model of its own",
                )


# What `massline compare` was asked, checked at the door.


@dataclass(frozen=True, kw_only=True)
class CompareOptions:
    """The options as typed.

    Attributes
    ----------
    model : path of the model file
    data : campaign folders and measurement files
    hold_out : names of runs, campaigns and files
    band : [Hz]; None for that of the campaigns
    method : of `METHODS`
    """

    model: str
    data: tuple[str, ...]
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    method: str = METHODS[0]


def ready(asked: CompareOptions, progress: Callable[[str, float], None] | None = None) -> tuple[Model, Data]:
    """The model and the data, read.

    Raises
    ------
    BadInput : a band that is none, a model or data that cannot be used, or that do not belong together.
    OSError : a file cannot be read.
    """
    require_band(asked.band)
    with reminded(Path(asked.model)):
        model = model_file.read(asked.model)
    return model, read_data(asked.data, model, progress)


def require_band(band: tuple[float, float] | None) -> None:
    """Refuse a band that ends before it begins."""
    if band is not None and not (0 < band[0] < band[1] and isfinite(band[1])):
        problem = f"two frequencies, the lower one first and above 0 Hz, are expected, found {band[0]:g} {band[1]:g}"
        raise BadInput(source="--band", problem=problem, remedy="Write for example --band 4 32")


def resolved_names(problem: Problem, data: Data, names: Sequence[str]) -> tuple[str, ...]:
    """`names` as the engine knows them: a campaign may be named by its folder, a fact by its file."""
    folders = {
        Path(one.source).resolve(): made.measured.name for one, made in zip(data.campaigns, problem.predictions, strict=True)
    }
    found: list[str] = []
    for name in names:
        of_file = [fact.name for fact in problem.facts if name in data.classical and fact.name.startswith(name)]
        found += of_file or [folders.get(Path(name).resolve(), name)]
    return tuple(found)
