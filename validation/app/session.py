"""`Desk`: the folder in which one window works, and what it was asked. It survives a reload and a crash.

    desk.json            what was asked, and the face's own view of it
    work/model.toml      working copy of the model, with its ladder beside it
    given/               files that a browser handed over
    found/<model>/       comparison and diagnosis of a model, by the digest of its text
    spectra.npz          spectra of the data, made once
    job.json             what a worker does or did last

The user's own files are read and never changed; `validation.app.session` writes where the user says.
"""

from __future__ import annotations

import json
import os
import os.path
import re
import zlib
from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, fields, replace
from functools import partial
from hashlib import sha256
from math import inf
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from geometry import toml_file
from geometry.atomic import write_text, write_with
from geometry.errors import BadInput
from geometry.sensors import resultants
from identification import campaign_file
from identification.campaign import METHODS, Campaign
from identification.campaign_file import NAME
from validation.classical import files
from validation.classical.files import Reduction
from validation.compare.compare import Comparison, of_evaluation
from validation.compare.maps import Map, NamedMode, Pairs
from validation.diagnose.diagnosis import (
    Diagnosis,
)
from validation.effects import catalogue
from validation.estimation import evaluate
from validation.estimation.evaluate import Squares
from validation.estimation.fit import unfitted
from validation.estimation.problem import FITTED, PLAIN, Measured, Offsets, Parameter, Problem
from validation.estimation.result import Evaluation, Fit, Share
from validation.history import add, history
from validation.history.add import AddedEffectOptions, conditions_of, grounded
from validation.history.history import Errors, HistoryPosition, Ladder, Source, Version, history_position, read_text
from validation.identify.check import summary
from validation.identify.identify import REDUCED
from validation.model import model_file
from validation.model.model import Model
from validation.output import from_json, json_text, require_ending, require_file, require_folder, to_json
from validation.prediction.dynamic_mass import BaseDrive
from validation.prediction.series import SeriesPrediction, TestedCampaign, names, predictions, supported_dynamic_mass
from validation.prediction.structure import mounted_article
from validation.report import compare, diagnose
from validation.report.history import of_step
from validation.report.page import ReportOptions, command_line, provenance
from validation.report.parts import CampaignPart, Provenance, Report
from validation.study import TRUTH, Data, Options, Study, only_files, read_data, require_band

# A model file and its ladder in another folder: what they say of other files by its path is said anew from there.
#
# Paths in a model file (``[structure.own]``) and in a ladder (its data) are seen from their own folder. A copy that is read in
# another one must say them otherwise; every other byte stays, comments and ends of lines too.


TABLE = re.compile(r"^\s*\[(?!\[)\s*structure\s*\.\s*own\s*\]")
OTHER = re.compile(r"^\s*\[")
ENTRY = re.compile(
    r"^(?P<key>\s*(?:\"[^\"]*\"|'[^']*'|[\w-]+)\s*=\s*)(?P<quote>[\"'])(?P<path>[^\"'\\]*)(?P=quote)(?P<rest>.*)$", re.S
)


def copied(model: Path, to: Path) -> None:
    """Copy the file `model`, and the ladder beside it where there is one, to the file `to` and beside it.

    Raises
    ------
    BadInput : no model file, a ladder that cannot be read, a layout of paths that cannot be said anew.
    OSError : a file cannot be read or written.
    """
    text = moved(read_text(model), model, to)
    model_file.of_text(text, str(to))
    beside = history.path_beside(model)
    ladder = moved_ladder(history.read(beside), model, to) if beside.exists() else None
    to.parent.mkdir(parents=True, exist_ok=True)
    if ladder is not None:
        history.write(history.path_beside(to), ladder, to.name)
    write_with(to, lambda temporary: temporary.write_bytes(text.encode("utf-8")))


def moved(text: str, model: Path, to: Path) -> str:
    """`text` of the file `model` as the file `to` must say it: paths of a user's own models seen from there.

    Raises
    ------
    BadInput : such paths stand where they cannot be found, as in an inline table.
    """
    if "own" not in text or model.resolve().parent == to.resolve().parent:
        return text
    lines, inside = text.splitlines(keepends=True), False
    for k, line in enumerate(lines):
        if OTHER.match(line):
            inside = bool(TABLE.match(line))
        elif inside and (entry := ENTRY.match(line)):
            path = _seen(entry["path"], model, to)
            lines[k] = f"{entry['key']}{entry['quote']}{path}{entry['quote']}{entry['rest']}"
    found = "".join(lines)
    _require_same(text, found, model, to)
    return found


def _seen(path: str, model: Path, to: Path) -> str:
    """A path from the folder of `model`, from that of `to`; an absolute one stays as it is."""
    if not path or Path(path).is_absolute():
        return path
    return Path(os.path.relpath(model.resolve().parent / path, to.resolve().parent)).as_posix()


def _require_same(before: str, after: str, model: Path, to: Path) -> None:
    """Refuse a text whose own models are not those of the first."""

    def own(text: str, at: Path) -> dict[str, Path]:
        return {name: Path(path).resolve() for name, path in model_file.of_text(text, str(at)).own.items()}

    known = own(before, model)
    try:
        same = own(after, to) == known
    except BadInput:  # a path that leads nowhere from there
        same = False
    if not same:
        problem = (
            "the paths of your own models do not stand one a line in [structure.own], and cannot be said from another folder"
        )
        raise BadInput(
            source=str(model), field="structure.own", problem=problem, remedy='Write "article" = "path" on lines there'
        )


def moved_ladder(ladder: Ladder, model: Path, to: Path) -> Ladder:
    """`ladder` of the file `model` as that of the file `to` must say it: its texts as `moved`, its data seen from there.

    Raises
    ------
    BadInput : see `moved`.
    """
    return replace(ladder, rungs=tuple(_rung(one, model, to) for one in ladder.rungs))


def _rung(one: Version, model: Path, to: Path) -> Version:
    data = tuple(Source(path=_data(source.path, model, to), digest=source.digest) for source in one.conditions.data)
    return replace(one, model=moved(one.model, model, to), conditions=replace(one.conditions, data=data))


def _data(path: str, model: Path, to: Path) -> str:
    """A path of a ladder; the name of a shipped measurement stays a name."""
    return _seen(path, model, to) if (model.parent / path).exists() else path


FORMAT = 1
STATE, VIEW = "desk.json", "view.json"
LARGEST_VIEW = 1_000_000
"""Characters of what a face may keep."""


@dataclass(frozen=True, kw_only=True)
class Session:
    """A study in a folder: a copy of its model that is worked on, and what was found.

    Attributes
    ----------
    folder : absolute
    asked : what it was begun with, all paths absolute but names of shipped measurements
    title : what the window shows above everything; not to be trusted as HTML
    """

    folder: Path
    asked: Options
    title: str = ""

    @property
    def model(self) -> Path:
        """The working copy of the model file."""
        return self.folder / "work" / "model.toml"

    @property
    def found(self) -> Path:
        """Folder of what was computed for the model as it stands now.

        Raises
        ------
        BadInput : the working copy is gone.
        """
        return self.folder / "found" / digest(read_text(self.model))

    @property
    def spectra(self) -> Path:
        """The file of the spectra."""
        return self.folder / "spectra.npz"

    @property
    def job(self) -> Path:
        """The file of the worker."""
        return self.folder / "job.json"


def digest(text: str) -> str:
    """By which what was computed for a model text is found again."""
    return sha256(text.encode()).hexdigest()[:16]


def begun(
    folder: str | Path,
    model: str | Path,
    data: Sequence[str | Path],
    *,
    hold_out: Sequence[str] = (),
    band: tuple[float, float] | None = None,
    method: str = METHODS[0],
    effects_from: Sequence[str | Path] = (),
    title: str = "",
) -> Session:
    """A desk in the new or empty `folder`, with a working copy of `model` and of the ladder beside it.

    Data are not read here; `validation.app.session.faults` says what is wrong with them.

    Raises
    ------
    BadInput : `folder` holds something already, a model or ladder that cannot be read, a band that is none.
    OSError : the folder cannot be written.
    """
    where = Path(folder).resolve()
    if where.exists() and (not where.is_dir() or any(one.name != "given" for one in where.iterdir())):
        raise BadInput(source=str(folder), problem="it is there already and not empty", remedy="Name a new folder for the desk")
    require_band(band)
    if method not in METHODS:
        raise BadInput(source="method", problem=f"no method is called {method!r}", remedy=f"Known are {', '.join(METHODS)}")
    # Whether `name` is a path of the `data`, not that of a run beside which some file of that name happens to lie
    asked = Options(
        model=str(Path(model).resolve()),
        data=tuple(_absolute(path) for path in data),
        hold_out=tuple(
            _absolute(name) if Path(name).exists() and Path(name).resolve() in {Path(one).resolve() for one in data} else name
            for name in hold_out
        ),
        band=None if band is None else (float(band[0]), float(band[1])),
        method=method,
        effects_from=tuple(str(Path(one).resolve()) for one in effects_from),
    )
    made = Session(folder=where, asked=asked, title=title)
    _load_effects(asked)
    copied(Path(asked.model), made.model)
    write_text(where / STATE, json_text({"format": FORMAT, "kind": "massline desk", **_as_json(made)}))
    return made


def opened(folder: str | Path) -> Session:
    """The desk in `folder`, as it was left.

    Raises
    ------
    BadInput : there is none, or another program's, or it is damaged.
    OSError : it cannot be read.
    """
    where = Path(folder).resolve()
    state = _read(where / STATE)
    if state.get("kind") != "massline desk" or state.get("format") != FORMAT:
        raise _damaged(where, "its desk.json is none of this program's")
    try:
        band = state["band_hz"]
        asked = Options(
            model=str(state["model"]),
            data=tuple(map(str, state["data"])),
            hold_out=tuple(map(str, state["hold_out"])),
            band=None if band is None else (float(band[0]), float(band[1])),
            method=str(state["method"]),
            effects_from=tuple(map(str, state["effects_from"])),
        )
        title = str(state["title"])
    except (KeyError, TypeError, ValueError) as error:
        raise _damaged(where, f"its desk.json lacks or misstates {error}") from None
    _load_effects(asked)
    read_text(where / "work" / "model.toml")
    return Session(folder=where, asked=asked, title=title)


def is_desk(folder: str | Path) -> bool:
    """Whether a desk was begun there."""
    return (Path(folder) / STATE).is_file()


def view(of: Session) -> dict[str, Any]:
    """What the face kept: the entry shown, the effect chosen and the like; empty where nothing was, or where it is damaged."""
    try:
        return _read(of.folder / VIEW)
    except BadInput:
        return {}


def keep_view(of: Session, kept: dict[str, Any]) -> None:
    """Keep `kept` (JSON values) for the next reload.

    Raises
    ------
    ValueError : it is no JSON, or more than a view can be.
    OSError : it cannot be written.
    """
    text = json_text(kept)
    if len(text) > LARGEST_VIEW:
        raise ValueError(f"`kept` must be a view, at most {LARGEST_VIEW} characters, found {len(text)}")
    write_text(of.folder / VIEW, text)


def _absolute(path: str | Path) -> str:
    """Of what is there; names of shipped measurements stay names."""
    return str(Path(path).resolve()) if Path(path).exists() else str(path)


def _load_effects(asked: Options) -> None:
    for folder in asked.effects_from:
        catalogue.load(folder)


def _as_json(of: Session) -> dict[str, Any]:
    asked = of.asked
    return {
        "model": asked.model,
        "data": list(asked.data),
        "hold_out": list(asked.hold_out),
        "band_hz": None if asked.band is None else list(asked.band),
        "method": asked.method,
        "effects_from": list(asked.effects_from),
        "title": of.title,
    }


def _read(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise BadInput(
            source=str(path.parent), problem="there is no desk here", remedy="Begin one with a model and data"
        ) from None
    except (ValueError, RecursionError):
        raise _damaged(path.parent, f"its {path.name} cannot be read") from None
    if not isinstance(found, dict):
        raise _damaged(path.parent, f"its {path.name} holds no object")
    return found


def _damaged(folder: Path, problem: str) -> BadInput:
    return BadInput(source=str(folder), problem=problem, remedy="Begin a new desk; the user's own files were never changed")


# The data of a desk ready for any model: spectra are made once and kept, so that a window is quickly there again.
#
# ``spectra.npz`` holds arrays and one JSON text, never a pickle, and the sizes and times of the files that it was made from;
# where one of these has changed, or the file is damaged, spectra are made again.


Progress = Callable[[str, float], None]

RECORDED_FORMAT = 2
DAMAGE = (OSError, EOFError, ValueError, KeyError, TypeError, BadZipFile, zlib.error)
"""What a file of arrays raises that is not there, not whole, or of another version."""

DRIVE = ("amplitude", "nominal", "sweep_rate", "block")


def model_of(of: Session) -> Model:
    """The working copy, read.

    Raises
    ------
    BadInput, OSError : see `validation.model.model_file.read`.
    """
    return model_file.read(of.model)


def data_of(of: Session, model: Model, progress: Progress | None = None) -> Data:
    """The data with their recordings.

    Raises
    ------
    BadInput, OSError : see `validation.study.read_data`.
    """
    return read_data(of.asked.data, model, progress)


def campaigns(of: Session) -> dict[str, str]:
    """Folders of the campaigns by the names that the data sets have, in their order.

    Raises
    ------
    BadInput : one of them is no campaign any more.
    """
    folders = [path for path in of.asked.data if Path(path).is_dir()]
    return dict(zip(names([campaign_file.read_description(path) for path in folders]), folders, strict=True))


def made(of: Session, model: Model, progress: Progress | None = None) -> tuple[SeriesPrediction, ...]:
    """A prediction of every campaign of the desk by `model`, from spectra that were kept where they still hold.

    Raises
    ------
    BadInput, OSError : see `data_of`.
    """
    tell = progress or (lambda what, share: None)
    with suppress(*DAMAGE):
        # From the file; ValueError and the like where there is none that holds
        with of.spectra.open("rb") as opened, np.load(opened, allow_pickle=False) as held:
            head = json.loads(held["head"].tobytes())
            if head["format"] != RECORDED_FORMAT or head["asked"] != _stamp(of):
                raise ValueError("made from other data")
            parts = [
                {name: held[f"{k}.{name}"] for name in (*said["arrays"], *DRIVE, "per_rms")}
                for k, said in enumerate(head["campaigns"])
            ]
        tested = [_tested(model, said, arrays) for said, arrays in zip(head["campaigns"], parts, strict=True)]
        return tuple(SeriesPrediction(tested=one, effects=model.effects) for one in tested)
    data = data_of(of, model, tell)
    found = predictions(
        model,
        data.campaigns,
        band=of.asked.band,
        method=of.asked.spectra,
        progress=lambda share: tell("spectra", share),
    )
    keep(of, found)
    return found


def keep(of: Session, found: Sequence[SeriesPrediction]) -> None:
    """Keep the spectra of `found` for the next time."""
    head = {"format": RECORDED_FORMAT, "asked": _stamp(of), "campaigns": [_head(one.tested) for one in found]}
    arrays = {f"{k}.{name}": value for k, one in enumerate(found) for name, value in _arrays(one.tested).items()}
    arrays["head"] = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
    write_with(of.spectra, lambda temporary: np.savez(temporary, allow_pickle=False, **arrays))


def _tested(model: Model, said: dict[str, Any], arrays: dict[str, Any]) -> TestedCampaign:
    campaign = campaign_file.read_description(said["source"])
    stands = mounted_article(model, campaign)
    words: dict[str, Any] = {name: tuple(value) if isinstance(value, list) else value for name, value in said["words"].items()}
    drives = zip(*(arrays[name] for name in DRIVE), strict=True)
    return TestedCampaign(
        model=model,
        campaign=replace(campaign, warnings=tuple(said["warnings"])),
        measured=Measured(**words, **{name: arrays[name] for name in said["arrays"]}),
        carried=supported_dynamic_mass(model, campaign, stands),
        drives=tuple(BaseDrive(amplitude=a, nominal=n, sweep_rate=float(r), block=float(b)) for a, n, r, b in drives),
        per_rms=arrays["per_rms"],
        method=said["method"],
        remarks=tuple(said["remarks"]),
    )


def _head(of: TestedCampaign) -> dict[str, Any]:
    """What is no array; of the spectra every field that there is, whatever is added to them."""
    words, arrays = _told(of.measured)
    return {
        "source": of.campaign.source,
        "warnings": list(of.campaign.warnings),
        "method": of.method,
        "remarks": list(of.remarks),
        "words": words,
        "arrays": list(arrays),
    }


def _arrays(of: TestedCampaign) -> dict[str, Any]:
    drives = {name: np.array([getattr(one, name) for one in of.drives]) for name in DRIVE}
    return {**_told(of.measured)[1], **drives, "per_rms": of.per_rms}


def _told(measured: Measured) -> tuple[dict[str, Any], dict[str, Any]]:
    """Fields that JSON can hold, and arrays."""
    every = {one.name: getattr(measured, one.name) for one in fields(measured)}
    arrays = {name: value for name, value in every.items() if isinstance(value, np.ndarray)}
    return {name: value for name, value in every.items() if name not in arrays}, arrays


def _stamp(of: Session) -> list[Any]:
    """What spectra depend on: the data by size and time of change, how they are made."""
    asked = of.asked
    files = [_files(Path(path)) for path in asked.data]
    return [list(asked.data), None if asked.band is None else list(asked.band), asked.method, files]


def _files(path: Path) -> list[list[Any]]:
    every = sorted(path.rglob("*")) if path.is_dir() else [path]
    seen = [(one, one.stat()) for one in every if one.is_file()]
    return [[one.name, found.st_size, found.st_mtime_ns] for one, found in seen]


# The model of a desk held against its data as a rung of its ladder, and the comparison that such a rung tells.
#
# Comparing, diagnosing and adding all begin with the same fits. They are made once, by `validation.history.add.grounded`, and
# stay on the ladder with the offsets at which they ended; maps and words of the comparison follow from these in seconds.


def study_of(of: Session, progress: Progress | None = None) -> Study:
    """The working copy and the data, without their recordings.

    Raises
    ------
    BadInput : they cannot be used, or what is held out is none of them.
    OSError : a file cannot be read.
    """
    model = model_of(of)
    series = made(of, model, progress)
    classical = tuple(path for path in of.asked.data if not Path(path).is_dir())
    data = Data(campaigns=tuple(one.tested.campaign for one in series), classical=classical)
    return Study.of_spectra(model, data, series, replace(of.asked, model=str(of.model)))


def rung(of: Session, ready: Study, progress: Progress) -> Version:
    """The rung on which the model stands, fitted and kept where it was not yet.

    Raises
    ------
    BadInput : the working copy was changed meanwhile.
    CheckFailed : a fit does not converge.
    """
    at = history_position(of.model)
    found = at.rung if at.rung is not None and at.rung.stands_on(conditions_of(ready)) else None
    if found is None:
        found = _grounded(at, ready, progress).rung
    if found is None:
        raise RuntimeError("a rung that was kept must be the one on which the model stands")
    return found


def _grounded(at: HistoryPosition, ready: Study, progress: Progress) -> HistoryPosition:
    def tell(what: str, share: float) -> None:
        progress(what.removeprefix("the model before: "), share)

    return grounded(at, ready, tell)[0]


def comparison(ready: Study, at: Version, progress: Progress) -> Comparison:
    """What `validation.compare.compare` finds, from the fits of the rung `at` instead of fits of its own.

    Raises
    ------
    CheckFailed : without some channel the others do not tell the inputs.
    ValueError : the rung has no figures.
    """
    if at.errors is None:
        raise ValueError("`at` must have figures")
    # The errors of a rung with the fits behind them, taken where they ended; shares of fitted data are told anew
    figures = at.errors
    known, start = ready.problem(), ready.whole().start
    plain, fitted = _fit(known, PLAIN, at.plain_offsets, figures), _fit(known, FITTED, at.fitted_offsets, figures)
    offsets = {**start, **plain.by_name}
    evaluation = Evaluation(
        nominal=evaluate.share(_squares(known, start)),
        plain=evaluate.share(_squares(known, offsets)),
        held_out=_share(figures.held_out, figures),
        held_out_nominal=_share(figures.held_out_nominal, None),
        plain_fit=plain,
        fitted=replace(
            fitted, chi2=figures.chi2, degrees_of_freedom=figures.degrees_of_freedom, log_evidence=figures.log_evidence
        ),
        held_out_names=figures.held_out_names,
    )
    return of_evaluation(ready, ready.problem(), evaluation, lambda share: progress("maps", share))


def _fit(known: Problem, kinds: tuple[str, ...], offsets: Offsets, figures: Errors) -> Fit:
    return replace(unfitted(known, kinds, offsets), converged=figures.converged)


def _squares(known: Problem, offsets: Offsets) -> list[Squares]:
    return [one for prediction in known.predictions for one in evaluate.squares(prediction, offsets)]


def _share(percent: float | None, figures: Errors | None) -> Share | None:
    return None if percent is None else Share(percent=percent, by_fold={} if figures is None else dict(figures.by_fold))


# The comparison of the model as it stands: worked out once, kept in the desk, and read again after a reload.


ARM = 0.01
"""Share of the largest by which a channel must take part in a load to tell it."""

SUMMARY, MAPS = "compare.json", "maps.npz"

TEXTS = ("data_set", "configuration", "runs", "axes", "rows", "channels", "remarks")
ARRAYS = tuple(one.name for one in fields(Map) if one.name not in (*TEXTS, "pairs"))
OF_PAIRS = tuple(one.name for one in fields(Pairs) if one.name != "campaign")


@dataclass(frozen=True, eq=False, kw_only=True)
class Compared:
    """What `massline compare` finds, as a window keeps it.

    Attributes
    ----------
    summary : the object of `massline compare --json`: "errors" [{"name", "figure", "meaning", "verdict", "text"}], "worst",
        "absurd_tolerances", "classical", "warnings", "plain_error_percent" ...
    maps : one a campaign, with its `pairs` (measured and predicted 6 x 6 dynamic mass)
    modes : by campaign, as the plain fit has them
    offsets : where the plain fit ended, by name of the parameter
    loads : by campaign, by force channel the loads (0 to 5) that it tells
    errors : the rows of `validation.report.compare.errors` for the panel
    """

    summary: Mapping[str, Any]
    maps: tuple[Map, ...]
    modes: tuple[tuple[NamedMode, ...], ...]
    offsets: Mapping[str, float]
    loads: tuple[Mapping[str, tuple[int, ...]], ...]
    errors: tuple[Mapping[str, Any], ...] = ()

    @property
    def campaigns(self) -> tuple[str, ...]:
        """Names of the data sets, in order."""
        return tuple(one.data_set for one in self.maps)

    def map(self, campaign: str) -> Map:
        """That of `campaign`.

        Raises
        ------
        KeyError : there is none of that name.
        """
        return self.maps[self._place(campaign)]

    def modes_of(self, campaign: str) -> tuple[NamedMode, ...]:
        """Those of the article of `campaign`; none of an FMD alone or of a rigid one.

        Raises
        ------
        KeyError : there is no campaign of that name.
        """
        return self.modes[self._place(campaign)]

    def loads_of(self, campaign: str, channel: str) -> tuple[int, ...]:
        """Those that a `channel` tells: of a force channel its own, of an acceleration all six.

        Raises
        ------
        KeyError : there is no campaign of that name.
        """
        return self.loads[self._place(campaign)].get(channel) or tuple(range(6))

    def _place(self, campaign: str) -> int:
        if campaign not in self.campaigns:
            raise KeyError(campaign)
        return self.campaigns.index(campaign)


def compared(of: Session, progress: Progress | None = None) -> Compared:
    """The model of the desk held against its data, and kept; on a rung of the ladder without fitting anything anew.

    Takes from seconds to minutes: `validation.app.workers.start(desk, "compare")` does it in a worker.

    Raises
    ------
    BadInput : model or data that cannot be used.
    CheckFailed : a fit that does not converge.
    OSError : a file cannot be read or written.
    """
    tell = progress or (lambda what, share: None)
    text = read_text(of.model)
    ready = study_of(of, tell)
    found = comparison(ready, rung(of, ready, tell), tell)
    folder = of.folder / "found" / digest(text)
    # Arrays first: where the summary is, all is
    loads = [_loads(one.tested.campaign) for one in ready.made]
    arrays = {f"{k}.{name}": getattr(one, name) for k, one in enumerate(found.maps) for name in ARRAYS}
    for k, one in enumerate(found.maps):
        arrays |= {} if one.pairs is None else {f"{k}.pairs.{name}": getattr(one.pairs, name) for name in OF_PAIRS}
    words = {
        "maps": [{name: getattr(one, name) for name in TEXTS} for one in found.maps],
        "modes": [[vars(mode) for mode in of] for of in found.modes],
        "offsets": found.evaluation.plain_fit.by_name,
        "loads": loads,
        "errors": compare.errors(found).panel(),
    }
    arrays["words"] = np.frombuffer(json.dumps(words).encode(), dtype=np.uint8)
    write_with(folder / MAPS, lambda temporary: np.savez(temporary, allow_pickle=False, **arrays))
    write_text(folder / SUMMARY, json_text(to_json(found)))
    return _comparing_read(folder)


def comparing_comparison(of: Session) -> Compared | None:
    """That of the model as it stands, if it was made; quick."""
    try:
        return _comparing_read(of.found)
    except DAMAGE:
        return None


def _loads(campaign: Campaign) -> dict[str, list[int]]:
    """By force channel the loads about F that it tells, but for arms of less than a per cent of the longest."""
    told = [campaign.table.channels[k] for k in campaign.table.select(quantity=("force", "moment"))]
    share = np.abs(resultants(told, campaign.table.origin))
    share /= np.maximum(share.max(axis=1, keepdims=True, initial=0.0), np.finfo(np.float64).tiny)
    return {one.name: np.flatnonzero(share[:, k] > ARM).tolist() for k, one in enumerate(told)}


def _comparing_read(folder: Path) -> Compared:
    summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    with (folder / MAPS).open("rb") as opened, np.load(opened, allow_pickle=False) as held:
        words = json.loads(held["words"].tobytes())
        maps = tuple(_map(said, held, k) for k, said in enumerate(words["maps"]))
    modes = tuple(tuple(NamedMode(**_tuples(mode)) for mode in each) for each in words["modes"])
    loads = tuple(_tuples(one) for one in words["loads"])
    return Compared(summary=summary, maps=maps, modes=modes, offsets=words["offsets"], loads=loads, errors=tuple(words["errors"]))


def _map(said: dict[str, Any], held: Any, k: int) -> Map:
    pairs = None
    if f"{k}.pairs.{OF_PAIRS[0]}" in held:
        pairs = Pairs(campaign=said["data_set"], **{name: held[f"{k}.pairs.{name}"] for name in OF_PAIRS})
    return Map(**_tuples(said), **{name: held[f"{k}.{name}"] for name in ARRAYS}, pairs=pairs)


def _tuples(said: dict[str, Any]) -> dict[str, Any]:
    return {name: tuple(value) if isinstance(value, list) else value for name, value in said.items()}


# Adding an effect to the working copy, and going down again: the ladder of a desk.


def added(of: Session, effect: str, progress: Progress | None = None) -> Mapping[str, Any]:
    """`effect` (``ID[=VALUE]``) added to the working copy as its next rung, and the comparison of the new model kept.

    Takes from seconds to minutes: `validation.app.workers.start(desk, "add", effect=...)` does it in a worker.

    Returns
    -------
    The object of `massline add --json`: "errors" before and after, "verdict", "before" and "after" with "inertia".

    Raises
    ------
    BadInput, CheckFailed : see `validation.history.add.added`.
    """
    asked = AddedEffectOptions(effect=effect)
    study, known = add.opened(replace(of.asked, model=str(of.model)), asked, progress)
    step = add.added(study, asked, progress)
    compared(of, progress)
    return of_step(step.at, step.before, step.after, (*known, *step.said))


def ladder(of: Session) -> HistoryPosition:
    """The working copy and all its rungs, with errors, identified inertia, verdicts; `.rung` is the one it stands on. Quick.

    Raises
    ------
    BadInput : the working copy or its ladder cannot be read.
    """
    return history_position(of.model)


def undone(of: Session) -> HistoryPosition:
    """The working copy one rung down; what was computed for that rung is there at once.

    Raises
    ------
    BadInput : there is nothing below.
    """
    return history.undone(ladder(of))


def put_back(of: Session, before: str) -> str:
    """The working copy on the rung whose text has the digest `before` again, and a sentence on that.

    For a rung that was written by work that did not come to its end. It stays on the ladder, beside the way. Nothing is done, and
    nothing said, where the working copy is as it was.

    Raises
    ------
    BadInput, OSError : see `gone_to`.
    """
    at = ladder(of)
    below = next((one for one in at.ladder.rungs if digest(one.model) == before), None)
    if digest(at.text) == before or below is None:
        return ""
    history.gone_to(at, below.number)
    new = "" if at.rung is None else f"rung {at.rung.number} was written already and stays on the ladder; "
    return f"{new}the model is back on rung {below.number}"


def gone_to(of: Session, number: int) -> HistoryPosition:
    """The working copy on the rung `number`.

    Raises
    ------
    BadInput : there is no such rung.
    """
    return history.gone_to(ladder(of), number)


# A diagnosis again from its JSON, as the noun that figures and reports are made of.
#
# A window keeps what it found as text (`validation.app.session`): no object of a program outlives that program. All that
# pages and pictures show comes back as it was; of the fits' covariance only its diagonal is there.


Object = Mapping[str, Any]

Known = Mapping[str, float | None]


def tolerances(found: Diagnosis) -> dict[str, dict[str, float | None]]:
    """Before and after, by parameter what was known of it beforehand, None for nothing: what the JSON of fits lacks."""
    both = {"before": found.before, "after": found.after}
    return {
        when: {one.name: None if one.tolerance == inf else one.tolerance for one in of.fitted.parameters}
        for when, of in both.items()
    }


def diagnosis(said: Object, known: Mapping[str, Known]) -> Diagnosis:
    """The diagnosis whose JSON is `said`; `known` are its `tolerances`.

    Raises
    ------
    KeyError, TypeError, ValueError : it is not whole.
    """
    errors = said["errors"]
    before = _retold_evaluation(said["before"], errors, "before", known["before"])
    return from_json(
        Diagnosis,
        said,
        text="" if said["text"] == said["headline"] else said["text"],
        before=before,
        after=_retold_evaluation(said["after"], errors, "after", known["after"]) if said["accepted"] else before,
        only=tuple(said["candidates"]),
    )


def _retold_evaluation(one: Object, errors: Object, when: str, known: Known) -> Evaluation:
    plain = Share(
        percent=errors[f"plain_{when}_percent"],
        by_channel=one["plain_percent_by_channel"],
        by_run=one["plain_percent_by_run"],
    )
    return Evaluation(
        nominal=Share(percent=errors[f"nominal_{when}_percent"]),
        plain=plain,
        held_out=_retold_share(errors[f"heldout_{when}_percent"], one["heldout_percent_by_fold"]),
        held_out_nominal=_retold_share(errors[f"heldout_nominal_{when}_percent"], {}),
        plain_fit=_retold_fit(one["plain"], known),
        fitted=_retold_fit(one["fitted"], known),
        held_out_names=tuple(one["held_out"]),
        held_out_configurations=_retold_share(errors[f"heldout_configurations_{when}_percent"], {}),
    )


def _retold_share(percent: float | None, by_fold: Mapping[str, float]) -> Share | None:
    return None if percent is None else Share(percent=percent, by_fold=by_fold)


def _retold_fit(one: Object, known: Known) -> Fit:
    said = one["parameters"]
    parameters = tuple(
        Parameter(name=name, unit="", tolerance=inf if known[name] is None else float(known[name] or 0.0), kind=each["kind"])
        for name, each in said.items()
    )
    return Fit(
        parameters=parameters,
        offsets=np.array([each["offset"] for each in said.values()], dtype=np.float64),
        covariance=np.diag(np.array([each["sd"] for each in said.values()], dtype=np.float64) ** 2),
        cost=inf,
        chi2=_number(one["chi2"]),
        degrees_of_freedom=one["degrees_of_freedom"],
        tolerance_z2=_number(one["tolerance_z2"]),
        tolerances=one["tolerances"],
        log_evidence=_number(one["log_evidence_nats"]),
        converged=one["converged"],
    )


def _number(value: float | None) -> float:
    """JSON knows no infinity, and has nothing in its place."""
    return inf if value is None else float(value)


# What the model as it stands is missing: diagnosed once, kept in the desk, read again after a reload.


FILE, BESIDE = "diagnose.json", "diagnose.tolerances.json"


def diagnosed(of: Session, candidates: Sequence[str] = (), progress: Progress | None = None) -> Mapping[str, Any]:
    """The diagnosis of the model of the desk, kept: the object of `massline diagnose --json`.

    Takes from seconds to minutes: `validation.app.workers.start(desk, "diagnose")` does it in a worker.

    Parameters
    ----------
    candidates : families and ids that alone are looked for; all where nothing is said

    Raises
    ------
    BadInput : model or data that cannot be used, a candidate that could not act on them.
    CheckFailed : the model with all its tolerances does not converge.
    OSError : a file cannot be read or written.
    """
    folder, tell = of.found, progress or (lambda what, share: None)
    tell("reading", 0.0)
    asked = replace(of.asked, model=str(of.model), candidates=tuple(candidates))
    bench = diagnose.prepared(asked)
    found = diagnose.diagnosis(asked, bench, tell)
    whole = {**diagnose.of_asked(asked, bench), **to_json(found)}
    write_text(folder / BESIDE, json_text(tolerances(found)))
    write_text(folder / FILE, json_text(whole))
    return whole


def diagnosing_diagnosis(of: Session) -> Mapping[str, Any] | None:
    """That of the model as it stands, if it was made; quick."""
    try:
        found = json.loads((of.found / FILE).read_text(encoding="utf-8"))
    except (OSError, ValueError):
        return None
    return found if isinstance(found, dict) else None


def noun(of: Session) -> Diagnosis | None:
    """The same as the noun that `validation.report.charts.style` and reports take; quick."""
    said = diagnosing_diagnosis(of)
    if said is None:
        return None
    try:
        return diagnosis(said, json.loads((of.found / BESIDE).read_text(encoding="utf-8")))
    except (OSError, ValueError, KeyError, TypeError):
        return None


# What is wrong with a model and data, all of it at once: each fault beside the file and the field that has it.
#
# The readers say it, and `massline check` and `massline compare` ask the same ones; here none hides the next.


@dataclass(frozen=True, kw_only=True)
class Fault:
    """One thing that is wrong.

    Attributes
    ----------
    file : that has it, or what else was named
    field : key or channel within it; empty where the whole file is meant
    problem : the condition that is broken and what was found
    remedy : what to do
    grave : whether the data cannot be used as they are; else a warning
    """

    file: str
    field: str
    problem: str
    remedy: str = ""
    grave: bool = True

    @property
    def text(self) -> str:
        """All of it in one sentence or two."""
        place = f"{self.file}: `{self.field}`: " if self.field else f"{self.file}: " if self.file else ""
        return place + self.problem + (f". {self.remedy}" if self.remedy else "")


def of_error(error: BadInput) -> Fault:
    """A refusal as a fault."""
    return Fault(file=error.source, field=error.field, problem=error.problem, remedy=error.remedy)


def faults(
    model: str, data: Sequence[str], *, effects_from: Sequence[str] = (), progress: Progress | None = None
) -> tuple[Fault, ...]:
    """Everything that is wrong with the model file `model`, the `data`, and with both together; grave faults first.

    No file is changed. A model that is empty text means that none was named yet.
    """
    tell = progress or (lambda what, share: None)
    found: list[Fault] = []
    for folder in effects_from:
        _tried(found, partial(catalogue.load, folder))
    read = _tried(found, lambda: model_file.read(model)) if model else None
    known = read if isinstance(read, Model) else None
    for path in data:
        found += _of_campaign(path, tell) if Path(path).is_dir() else _of_file(path)
    if not any(one.grave for one in found) and known is not None:
        # What contradicts what, of files that are sound by themselves; descriptions are enough to see it
        together_found: list[Fault] = []
        if any(Path(path).is_dir() for path in data):
            _tried(together_found, lambda: read_data(data, known))
        elif data:
            problem = "there is no campaign among them, and weights and periods alone tell nothing of frequencies"
            together_found.append(Fault(file="DATA", field="", problem=problem, remedy="Name a campaign folder, too"))
        found += together_found
    unique = tuple(dict.fromkeys(found))
    return (*(one for one in unique if one.grave), *(one for one in unique if not one.grave))


def _of_campaign(path: str, progress: Progress) -> list[Fault]:
    """By what `massline check` finds."""
    try:
        seen = summary(path, progress=lambda share: progress(f"reading {Path(path).name}", share))
    except OSError as error:
        return [_of_system(error, path)]
    said = [Fault(file=path, field="", problem=text, grave=False) for text in seen.warnings]
    return [*map(of_error, seen.problems), *said]


def _of_file(path: str) -> list[Fault]:
    """By its reader, and by its reduction, which alone looks at every field."""
    found: list[Fault] = []
    _tried(found, lambda: _reduced(path))
    return found


def _reduced(path: str) -> Reduction:
    """A measurement file as `massline weigh`, `cog` and `pendulum` take it.

    Raises
    ------
    BadInput : there is none, or it is none.
    """
    if not only_files((path,)):
        remedy = "Name campaign folders, and weigh, cog and pendulum files"
        raise BadInput(source=path, problem="there is no such file or folder", remedy=remedy)
    file = files.read(path, tuple(REDUCED))
    return REDUCED[file.text("kind")](file)


def _tried(found: list[Fault], attempt: Callable[[], object]) -> object:
    """What `attempt` gives; or None, and its refusal among those that were `found`."""
    try:
        return attempt()
    except BadInput as error:
        found.append(of_error(error))
    except OSError as error:
        found.append(_of_system(error, ""))
    return None


def _of_system(error: OSError, path: str) -> Fault:
    problem = f"it cannot be read: {error.strerror or error}"
    return Fault(file=str(error.filename or path), field="", problem=problem, remedy="Check its name and permissions")


# Files that a browser handed over, put into the desk's folder: whatever they are called, they go nowhere else.
#
# Names come from a stranger. They are taken apart at ``/`` and ``\``; what climbs, is absolute, reserved, too long or too deep,
# or holds characters that no file name needs, is refused in words. Files that a system hides beside those of the user
# (``.DS_Store``, ``.git``, ``.~lock``, ``Thumbs.db``) are passed over, in words too. Nothing is renamed in silence: a campaign
# finds its signals by their names. What is left keeps its folders, so that a dropped series is one. A file that is handed over
# again takes the place of the one that was.


SOURCE = "the files that were handed over"
"""What a fault of theirs is about."""

GIVEN = "given"
"""The folder of a desk in which they lie."""

LARGEST = 2 * 2**30
"""Bytes of all files of a desk together."""

MOST = 2000
"""Files."""

LONGEST, DEEPEST = 120, 6
"""Characters of a name, folders above a file."""

FORBIDDEN = re.compile(r'[\x00-\x1f\x7f<>:"|?*]')
RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
"""What no Windows folder can hold, so that a desk can be copied anywhere."""

OF_SYSTEMS = ("thumbs.db", "desktop.ini", "__macosx")
"""What systems put into folders without a full stop before it, in small letters."""

DEEP = 3
"""Folders below the one that is looked through."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Handed:
    """One file as a browser gives it.

    Attributes
    ----------
    name : with the folders of what was dropped, ``series/block/x.h5``
    content : its bytes, or a file that already holds them and is copied
    """

    name: str
    content: bytes | Path


@dataclass(frozen=True, kw_only=True)
class Received:
    """What was taken over or found, told apart by what it holds.

    Attributes
    ----------
    folder : in which everything lies
    models : paths of model files, those that were handed over just now first
    data : paths of campaign folders and measurement files
    faults : what was refused, in words; not `grave` what was passed over and is missed by nobody
    """

    folder: Path
    models: tuple[str, ...]
    data: tuple[str, ...]
    faults: tuple[Fault, ...]


def received(folder: str | Path, files: Sequence[Handed], *, limit: int = LARGEST) -> Received:
    """`files` written below `folder` (that of the desk to be), in ``given/``; those that are refused are told and left out.

    One of the name of a file that was handed over before, as after a fault was mended, replaces it.

    Parameters
    ----------
    limit : bytes of all files together, those that are there already included

    Raises
    ------
    OSError : the folder cannot be written.
    """
    given = Path(folder).resolve() / GIVEN
    given.mkdir(parents=True, exist_ok=True)
    before = {_folded(path.relative_to(given).parts): path for path in _handed_files(given)}
    room, faults = limit - sum(path.stat().st_size for path in before.values()), []
    taken: set[tuple[str, ...]] = set()
    hidden: list[str] = []
    for number, one in enumerate(files):
        try:
            if number >= MOST:
                raise _refused(one.name, f"comes behind {MOST} other files")
            parts = _parts(one.name)
            if any(part.startswith(".") or part.casefold() in OF_SYSTEMS for part in parts):
                hidden.append(one.name)
                continue
            old = before.get(_folded(parts))
            _require_new(parts, taken | (before.keys() - {_folded(parts)}), one)
            room = _require_room(room + (old.stat().st_size if old else 0), one, limit)
        except BadInput as error:
            faults.append(of_error(error))
            continue
        if old is not None:
            old.unlink()  # perhaps in other capitals
        _handed_write(given.joinpath(*parts), one)
        taken.add(_folded(parts))
    found = sorted_out(given)
    faults += [] if not hidden else [_passed_over(hidden)]
    models = sorted(found.models, key=lambda path: _folded(Path(path).relative_to(given).parts) not in taken)
    return Received(folder=given, models=tuple(models), data=found.data, faults=tuple(faults))


def sorted_out(folder: str | Path) -> Received:
    """What a `folder` on this machine holds: models, campaigns and measurements, some levels deep; nothing is copied or followed.

    Raises
    ------
    BadInput : there is no such folder.
    OSError : it cannot be read.
    """
    where = Path(folder)
    if not where.is_dir():
        raise BadInput(
            source=str(folder), problem="there is no such folder", remedy="Name the folder of a campaign or of a series"
        )
    models: list[str] = []
    data: list[str] = []
    for path in _looked_through(where, DEEP):
        if path.is_dir():
            data.append(str(path))
        elif (kind := _kind(path)) is not None:
            (models if kind == "model" else data).append(str(path))
    return Received(folder=where, models=tuple(models), data=tuple(data), faults=())


def _looked_through(folder: Path, deep: int) -> Iterator[Path]:
    """Campaign folders, whose own folders are not looked into, and files that could be models or measurements."""
    if campaign := (folder / NAME).is_file():
        yield folder
    for path in sorted(folder.iterdir()):
        if path.is_symlink() or path.name.startswith(".") or path.name == NAME:
            continue
        if path.is_dir() and deep and not campaign:
            yield from _looked_through(path, deep - 1)
        elif path.is_file() and path.suffix.lower() in (".toml", ".json") and not path.name.endswith(TRUTH):
            yield path


def _kind(path: Path) -> str | None:
    """ "model", the kind of a measurement, or None for something else; what is neither is no fault here."""
    try:
        table = toml_file.read(path)
    except (BadInput, OSError):
        return "model" if path.suffix.lower() == ".toml" else None  # the reader of models says what is wrong with it
    if "model" in table and path.suffix.lower() == ".toml":
        return "model"
    kind = table.get("kind")
    return str(kind) if kind in files.KINDS else None


def _parts(name: str) -> tuple[str, ...]:
    """The folders and the name of a file, each of them harmless.

    Raises
    ------
    BadInput : the name would lead elsewhere, or no file can have it.
    """
    if not name or name[0] in "/\\" or (len(name) > 1 and name[1] == ":"):
        raise _refused(name, "is no name of a file in a folder")
    parts = tuple(part for part in re.split(r"[/\\]", name) if part not in ("", "."))
    if ".." in parts:
        raise _refused(name, "leads out of its folder")
    if not parts or len(parts) > DEEPEST or len(name) > DEEPEST * LONGEST:
        raise _refused(name, f"lies in more than {DEEPEST - 1} folders, or in none")
    for part in parts:
        if len(part.encode("utf-8", "surrogatepass")) > LONGEST:
            raise _refused(name, f"is longer than {LONGEST} characters")
        if FORBIDDEN.search(part) or any("\ud800" <= letter <= "\udfff" for letter in part):
            raise _refused(name, "holds a character that no file name can have everywhere")
        if part.endswith((".", " ")) or RESERVED.fullmatch(part):
            raise _refused(name, "ends in a full stop, or is the name of a device")
    return parts


def _passed_over(names: Sequence[str]) -> Fault:
    """Of files that are no data, one word for all."""
    more = f" and {len(names) - 1} more" if len(names) > 1 else ""
    problem = "hidden files and those of an operating system are passed over"
    remedy = "There is nothing to do; a file that is meant must not begin with a full stop"
    return Fault(file=SOURCE, field=f"{_shown(names[0])}{more}", problem=problem, remedy=remedy, grave=False)


def _require_new(parts: tuple[str, ...], taken: set[tuple[str, ...]], one: Handed) -> None:
    """Refuse a second file of a name, capitals or not, and one where a folder is."""
    folded = _folded(parts)
    clash = folded in taken or any(folded[:k] in taken for k in range(1, len(folded)))
    if clash or any(other[: len(folded)] == folded for other in taken):
        raise _refused(one.name, "is there already, perhaps in other capitals")


def _require_room(room: int, one: Handed, limit: int) -> int:
    size = len(one.content) if isinstance(one.content, bytes) else one.content.stat().st_size
    if size > room:
        raise _refused(one.name, f"does not fit: all files together may hold {limit / 2**20:g} MB")
    return room - size


def _handed_write(path: Path, one: Handed) -> None:
    content = one.content
    if isinstance(content, bytes):
        write_with(path, lambda temporary: temporary.write_bytes(content))
        return
    import shutil

    write_with(path, lambda temporary: shutil.copyfile(content, temporary))


def _folded(parts: Sequence[str]) -> tuple[str, ...]:
    return tuple(part.casefold() for part in parts)


def _handed_files(folder: Path) -> Iterator[Path]:
    for where, _, held in os.walk(folder):
        yield from (Path(where) / name for name in held)


def _refused(name: str, problem: str) -> BadInput:
    return BadInput(source=SOURCE, field=_shown(name), problem=problem, remedy="Rename it, and hand it over again")


def _shown(name: str) -> str:
    """`name` as a page can say it."""
    shown = name.encode("unicode_escape", "backslashreplace").decode("ascii") if not name.isprintable() else name
    return shown if len(shown) <= LONGEST else f"{shown[:LONGEST]}…"


# What leaves a desk: model, ladder, report and figures, whole or not at all, to where the user says.


def model_text(of: Session) -> str:
    """The model file as it stands, as it would be saved beside the user's own, for a download.

    Raises
    ------
    BadInput : the working copy is gone.
    """
    return moved(read_text(of.model), of.model, Path(of.asked.model))


def ladder_text(of: Session) -> str:
    """Its ladder as it would be saved beside the user's own model, one JSON object, for a download.

    Raises
    ------
    BadInput : there is none yet.
    """
    beside = history.path_beside(of.model)
    if not beside.exists():
        problem = "there is none yet: a comparison makes its first rung"
        raise BadInput(source="ladder", problem=problem, remedy="Compare the model with its data")
    to = Path(of.asked.model)
    return history.text(moved_ladder(history.read(beside), of.model, to), to.name)


def figures(of: Session, folder: str | Path, progress: Progress | None = None) -> tuple[Path, ...]:
    """Write the pictures of comparison, diagnosis and ladder into `folder`, as the commands draw them; some ten seconds.

    Raises
    ------
    BadInput : nothing can be written there; model or data that cannot be used.
    CheckFailed : nothing can be rendered on this machine; a fit that does not converge.
    OSError : a file cannot be written.
    """
    from validation.report.charts.history import draw as of_ladder
    from validation.report.compare import draw as of_comparison
    from validation.report.diagnose import draw as of_diagnosis

    tell, where = progress or (lambda what, share: None), Path(folder)
    require_folder(where, "figures")
    _, compared = _compared(of, tell)
    tell("drawing the comparison", 0.0)
    made = [*of_comparison(compared, where)]
    found = noun(of)
    if found is not None:
        tell("drawing the diagnosis", 0.5)
        made += of_diagnosis(found, where)
    tell("drawing the ladder", 0.7)
    return (*made, *of_ladder(history_position(of.model), where))


def reported(of: Session, to: str | Path, progress: Progress | None = None) -> Path:
    """Write the report of the model as it stands to the file `to` (.html); what was found already is not found again.

    Takes a minute: `validation.app.workers.start(desk, "report", to=...)` does it in a worker.

    Raises
    ------
    BadInput : nothing can be written there; model or data that cannot be used.
    CheckFailed : a fit that does not converge.
    OSError : a file cannot be written.
    """
    from validation.report.page import How, assembled, write

    tell, path, asked = progress or (lambda what, share: None), Path(to), of.asked
    require_ending(path, (".html", ".htm"), "a report", "report.html")
    require_file(path, "report")
    ready, compared = _compared(of, tell)
    found, at = noun(of), history_position(of.model)
    report = assembled(
        ready.model,
        data_of(of, ready.model, tell),
        compared,
        provenance=signed(of, ready.model, diagnosed=found is not None),
        how=How(band=asked.band, method=asked.spectra),
        identified=() if at.rung is None else at.rung.bodies,
        diagnosis=found,
        not_diagnosed="" if found else "nobody asked for it",
        standing=at,
        progress=tell,
    )
    write(as_given(of, report), path, tell)
    return path


def _compared(of: Session, tell: Progress) -> tuple[Study, Comparison]:
    """The comparison as a noun, from the fits of its rung."""
    ready = study_of(of, tell)
    return ready, comparison(ready, rung(of, ready, tell), tell)


# Where a report of the workbench comes from: the user's own files and the command line, never the folders of a desk.
#
# A desk is deleted when its window closes, and a report is signed and kept. So it names the files that the user named, files
# that a browser handed over by the names under which it gave them, and the effects that the user's own model has not.


ADDED = "effects added in the workbench"


def signed(of: Session, model: Model, *, diagnosed: bool) -> Provenance:
    """The provenance of a report on the `model` of the desk.

    Raises
    ------
    BadInput : the working copy is gone.
    OSError : a file cannot be read.
    """
    asked = of.asked
    there = asked.model if Path(asked.model).is_file() else str(of.model)
    question = replace(asked, model=there)
    made = provenance(ReportOptions(compared=question, diagnosis=diagnosed))
    typed = replace(
        question,
        model=given(of, asked.model),
        data=tuple(given(of, path) for path in asked.data),
        hold_out=tuple(given(of, name) for name in asked.hold_out),
    )
    return replace(
        made,
        command=command_line(typed, effects_from=asked.effects_from, diagnosis=diagnosed),
        inputs=tuple(replace(one, path=given(of, one.path)) for one in made.inputs),
        settings={**made.settings, "held out": typed.hold_out or made.settings["held out"], ADDED: _added(of, model)},
        model_text=model_text(of),
    )


def as_given(of: Session, report: Report) -> Report:
    """`report` with the user's own paths for model and campaigns."""
    comparison = replace(report.comparison, source=given(of, of.asked.model))
    return replace(report, comparison=comparison, campaigns=tuple(_campaign(of, one) for one in report.campaigns))


def given(of: Session, path: str) -> str:
    """`path` as the user knows it: of a file that a browser handed over, the name that it had there."""
    try:
        _, folder, *names = Path(path).relative_to(of.folder.parent).parts
    except ValueError:
        return path
    return path if folder != GIVEN else "/".join(names) or "."


def _campaign(of: Session, one: CampaignPart) -> CampaignPart:
    source = one.campaign.source
    shown = given(of, source)
    return replace(one, campaign=replace(one.campaign, source=shown), command=one.command.replace(source, shown))


def _added(of: Session, model: Model) -> tuple[str, ...]:
    """Identifiers of the effects that the user's own model file has not."""
    try:
        own = {one.named.id for one in model_file.read(of.asked.model).effects}
    except (BadInput, OSError):
        own = set()
    return tuple(one.named.id for one in model.effects if one.named.id not in own)
