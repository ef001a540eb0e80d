"""`Session`: a study in a folder, with what was found; it survives a reload and a crash.

    desk.json            what was asked, and the face's own view of it
    work/                working copy of the model under its own name, with its ladder and files of its structure beside it
    given/               files that a browser handed over
    found/<model>/       comparison and diagnosis of a model, by the digest of its text
    spectra.npz          spectra of the data, made once
    job.json             what a worker does or did last

The user's own files are read and never changed; `Session.report` and `Session.draw` write where the user says.
"""

import filecmp
import json
import shutil
import zlib
from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from hashlib import sha256
from pathlib import Path
from typing import Any
from zipfile import BadZipFile

import numpy as np

from geometry import toml_file
from geometry.atomic import write_text, write_with
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import resultants
from identification import campaign_file
from identification.campaign import METHODS
from validation.app import kept
from validation.app.kept import Compared, KeptFits, KeptSeries, KeptSpectra, copied, moved, moved_ladder
from validation.compare.compare import Comparison, of_evaluation
from validation.compare.correlation import FunctionCorrelation, ModalCorrelation
from validation.diagnose.diagnosis import Diagnosis
from validation.effects import catalogue
from validation.estimation import evaluate
from validation.estimation.fit import unfitted
from validation.estimation.problem import FITTED, PLAIN, Evaluation, Share
from validation.history import add, history
from validation.history.history import BOTH_FITS, HistoryPosition, Ladder, Version, history_position, read_text
from validation.model import model_file
from validation.model.model import Model
from validation.output import from_json, json_text, require_ending, require_file, require_folder, to_json
from validation.prediction import series
from validation.prediction.mounting import mounted_article
from validation.prediction.series import SeriesPrediction, TestedCampaign
from validation.report import compare, diagnose, page
from validation.report.history import of_step
from validation.report.parts import Provenance
from validation.study import Data, Options, Progress, Study, is_test, read_data, read_tests, require_band

FORMAT, SPECTRA_FORMAT = 1, 3
STATE, VIEW = "desk.json", "view.json"
GIVEN = "given"
"""The folder of a session in which files lie that a browser handed over."""

LARGEST_VIEW = 1_000_000
"""Characters of what a face may keep."""

ADDED = "effects added in the workbench"

DAMAGE = (OSError, EOFError, ValueError, KeyError, TypeError, BadZipFile, zlib.error)
"""What a file of arrays raises that is not there, not whole, or of another version."""

SUMMARY, MAPS = "compare.json", "maps.npz"
NODES = "nodes.npz"
"""The file with what a diagnosis says of every node of a mesh."""

DIAGNOSIS, FITS = "diagnose.json", "diagnose.npz"
"""The object of `massline diagnose --json`, and the fits behind its errors."""

ARM = 0.01
"""Share of the largest by which a channel must take part in a load to tell it."""


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
        """The working copy of the model file.

        Raises
        ------
        BadInput : `asked` names none, and there is no session in the folder.
        """
        return self.folder / "work" / Path(self.asked.model or str(_read(self.folder / STATE)["model"])).name

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

    def view(self) -> dict[str, Any]:
        """What the face kept: the entry shown, the effect chosen and the like; empty where nothing was, or it is damaged."""
        try:
            return _read(self.folder / VIEW)
        except BadInput:
            return {}

    def keep_view(self, kept: dict[str, Any]) -> None:
        """Keep `kept` (JSON values) for the next reload.

        Raises
        ------
        ValueError : it is no JSON, or more than a view can be.
        OSError : it cannot be written.
        """
        text = json_text(kept)
        if len(text) > LARGEST_VIEW:
            raise ValueError(f"`kept` must be a view, at most {LARGEST_VIEW} characters, found {len(text)}")
        write_text(self.folder / VIEW, text)

    # The data, ready for any model. Spectra are made once and kept as arrays and one JSON text, never a pickle, with sizes and
    # times of the files that they were made from; where one of these has changed, or the file is damaged, they are made again.

    def read_model(self) -> Model:
        """The working copy, read.

        Raises
        ------
        BadInput, OSError : see `validation.model.model_file.read`.
        """
        return model_file.read(self.model)

    def read_data(self, model: Model, progress: Progress | None = None) -> Data:
        """The data with their recordings.

        Raises
        ------
        BadInput, OSError : see `validation.study.read_data`.
        """
        return read_data(self.asked.data, model, progress)

    def campaigns(self) -> dict[str, str]:
        """Folders of the campaigns by the names that the data sets have, in their order.

        Raises
        ------
        BadInput : one of them is no campaign any more.
        """
        folders = [path for path in self.asked.data if Path(path).is_dir()]
        return dict(zip(series.names([campaign_file.read_description(path) for path in folders]), folders, strict=True))

    def predictions(self, model: Model, progress: Progress | None = None) -> tuple[SeriesPrediction, ...]:
        """A prediction of every campaign by `model`, from spectra that were kept where they still hold.

        Raises
        ------
        BadInput, OSError : see `read_data`.
        """
        tell = progress or (lambda what, share: None)
        with suppress(*DAMAGE):
            if kept.words(self.spectra)["stamp"] == self._stamp():
                spectra = kept.read(KeptSeries, self.spectra).campaigns
                return tuple(SeriesPrediction(tested=_tested(model, one), effects=model.effects) for one in spectra)
        found = series.predictions(
            model,
            self.read_data(model, tell).campaigns,
            band=self.asked.band,
            method=self.asked.spectra,
            progress=lambda share: tell("spectra", share),
        )
        self.keep_spectra(found)
        return found

    def keep_spectra(self, found: Sequence[SeriesPrediction]) -> None:
        """Keep the spectra of `found` for the next time."""
        campaigns = tuple(
            KeptSpectra(
                source=of.campaign.source,
                warnings=tuple(of.campaign.warnings),
                measured=of.measured,
                drives=of.drives,
                per_rms=of.per_rms,
                method=of.method,
                remarks=of.remarks,
            )
            for of in (one.tested for one in found)
        )
        kept.write(self.spectra, KeptSeries(stamp=self._stamp(), campaigns=campaigns))

    def _stamp(self) -> list[Any]:
        """What spectra depend on: the data by size and time of change, how they are made."""
        files = []
        for path in map(Path, self.asked.data):
            every = sorted(path.rglob("*")) if path.is_dir() else [path]
            seen = [(one.name, one.stat()) for one in every if one.is_file()]
            files.append([[name, found.st_size, found.st_mtime_ns] for name, found in seen])
        # The file of a test names its records, which lie beside it
        tests = {Path(one).parent for one in self.asked.data if is_test(one)}
        if self.asked.model and toml_file.holds(Path(self.asked.model), "test"):
            tests.add(Path(self.asked.model).parent)
        for folder in sorted(tests):
            seen = [(one.name, one.stat()) for one in sorted(folder.iterdir()) if one.is_file()]
            files.append([[name, found.st_size, found.st_mtime_ns] for name, found in seen])
        return [
            SPECTRA_FORMAT,
            list(self.asked.data),
            None if self.asked.band is None else list(self.asked.band),
            self.asked.method,
            files,
        ]

    # The model held against its data. Comparing, diagnosing and adding all begin with the same fits. They are made once, as a
    # rung of the ladder, and stay there with the offsets at which they ended; maps and words of a comparison follow in seconds.

    def study(self, progress: Progress | None = None) -> Study:
        """The working copy and the data, without their recordings.

        Raises
        ------
        BadInput : they cannot be used, or what is held out is none of them.
        OSError : a file cannot be read.
        """
        model = self.read_model()
        made = self.predictions(model, progress)
        classical = tuple(path for path in self.asked.data if not Path(path).is_dir() and not is_test(path))
        tests = read_tests(self.asked.data, model)
        data = Data(campaigns=tuple(one.tested.campaign for one in made), classical=classical, tests=tests)
        return Study.of_spectra(model, data, made, replace(self.asked, model=str(self.model)))

    def rung(self, study: Study, progress: Progress) -> Version:
        """The rung on which the model stands, fitted and kept where it was not yet; of a fit that does not converge that is said.

        Raises
        ------
        BadInput : the working copy was changed meanwhile.
        """
        at = history_position(self.model)
        if at.rung is not None and at.rung.stands_on(add.conditions_of(study)):
            return at.rung
        at, _ = add.grounded(at, study, lambda what, share: progress(what.removeprefix("the model before: "), share), ended=False)
        if at.rung is None:
            raise RuntimeError("a rung that was kept must be the one on which the model stands")
        return at.rung

    def compare(self, progress: Progress | None = None) -> Compared:
        """The model held against its data, and kept; on a rung of the ladder without fitting anything anew.

        Takes from seconds to minutes: `validation.app.workers.start(session, "compare")` does it in a worker.

        Raises
        ------
        BadInput : model or data that cannot be used.
        CheckFailed : a model that breaks down.
        OSError : a file cannot be read or written.
        """
        tell = progress or (lambda what, share: None)
        folder = self.found
        study = self.study(tell)
        found = comparison_on(study, self.rung(study, tell), tell)
        loads = []
        for campaign in (one.tested.campaign for one in study.made):
            # By force channel the loads about F that it tells, but for arms of less than a per cent of the longest
            told = [campaign.table.channels[k] for k in campaign.table.select(quantity=("force", "moment"))]
            share = np.abs(resultants(told, campaign.table.origin))
            share /= np.maximum(share.max(axis=1, keepdims=True, initial=0.0), np.finfo(np.float64).tiny)
            loads.append({one.name: tuple(np.flatnonzero(share[:, k] > ARM).tolist()) for k, one in enumerate(told)})
        made = Compared(
            maps=found.maps,
            modes=found.modes,
            offsets=found.evaluation.plain_fit.by_name,
            loads=tuple(loads),
            errors=tuple(compare.errors(found).panel()),
            tables=tuple(one for one in found.correlation if isinstance(one, ModalCorrelation)),
            frac={one.data_set: one.frac for one in found.correlation if isinstance(one, FunctionCorrelation)},
        )
        # Arrays first: where the summary is, all is
        kept.write(folder / MAPS, made)
        write_text(folder / SUMMARY, json_text(to_json(found)))
        return _read_comparison(folder)

    def take_over(self, folders: Iterable[Path]) -> bool:
        """Take over spectra, first rung and comparison from a session in one of `folders` that held the same against the same.

        Nothing is taken of its further rungs, nor where this session has a ladder of its own already.
        """
        ladder, now = history.path_beside(self.model), digest(read_text(self.model))
        for folder in folders:
            with suppress(*DAMAGE, BadInput):
                other = opened(folder)
                found = other.folder / "found" / now
                if folder == self.folder or other.asked != self.asked or ladder.exists() or not (found / SUMMARY).is_file():
                    continue
                beside = history.path_beside(other.model)
                own = {one.relative_to(other.model.parent) for one in other.model.parent.rglob("*") if one.is_file()}
                named = own - {Path(other.model.name), Path(beside.name)}
                _, *differing = filecmp.cmpfiles(other.model.parent, self.model.parent, map(str, named), shallow=False)
                same = kept.words(other.spectra)["stamp"] == self._stamp()
                first = next(iter(history.read(beside).rungs))
                if any(differing) or not same or digest(first.model) != now or first.errors is None:
                    continue
                shutil.copyfile(other.spectra, self.spectra)
                shutil.copytree(found, self.found)
                history.write(ladder, Ladder(rungs=(first,), current=first.number), self.model.name)
                return True
        return False

    def comparison(self) -> Compared | None:
        """That of the model as it stands, if it was made; quick."""
        with suppress(*DAMAGE):
            return _read_comparison(self.found)
        return None

    def diagnose(self, candidates: Sequence[str] = (), progress: Progress | None = None) -> Mapping[str, Any]:
        """The diagnosis of the model, kept: the object of `massline diagnose --json`.

        Takes from seconds to minutes: `validation.app.workers.start(session, "diagnose")` does it in a worker.

        Parameters
        ----------
        candidates : families and ids that alone are looked for; all where nothing is said

        Raises
        ------
        BadInput : model or data that cannot be used, a candidate that could not act on them.
        CheckFailed : a model that breaks down.
        OSError : a file cannot be read or written.
        """
        folder, tell = self.found, progress or (lambda what, share: None)
        tell("reading", 0.0)
        asked = replace(self.asked, model=str(self.model), candidates=tuple(candidates))
        study = diagnose.prepared(asked)
        found = diagnose.diagnosis(asked, study, tell)
        whole = {**diagnose.of_asked(asked, study), **to_json(found)}
        scores = {f"{k}.{name}": getattr(one, name) for k, one in enumerate(found.nodes) for name in ("article", "points")}
        scores |= {f"{k}.evidence.{kind}": e for k, one in enumerate(found.nodes) for kind, e in one.evidence.items()}
        write_with(folder / NODES, lambda temporary: np.savez(temporary, allow_pickle=False, **scores))
        kept.write(folder / FITS, KeptFits(before=found.before, after=found.after))
        write_text(folder / DIAGNOSIS, json_text(whole))
        return whole

    def evidence(self, article: str) -> dict[str, tuple[Array, Array]]:
        """What the diagnosis of the model says of the nodes of an `article`: by kind places (p, 3) [m] and evidence (p,) [nats].

        Nothing where it was not diagnosed, or has no mesh.
        """
        with suppress(*DAMAGE), (self.found / NODES).open("rb") as kept, np.load(kept, allow_pickle=False) as held:
            own = [one.removesuffix(".article") for one in held if one.endswith(".article") and str(held[one]) == article]
            kinds = [
                (k, one, one.removeprefix(f"{k}.evidence.")) for k in own for one in held if one.startswith(f"{k}.evidence.")
            ]
            return {kind: (held[f"{k}.points"], held[one]) for k, one, kind in kinds}
        return {}

    def diagnosis(self) -> Diagnosis | None:
        """That of the model as it stands, if it was made, as figures and reports take it; quick."""
        with suppress(*DAMAGE):
            said = json.loads((self.found / DIAGNOSIS).read_text(encoding="utf-8"))
            fits = kept.read(KeptFits, self.found / FITS)
            text = "" if said["text"] == said["headline"] else said["text"]
            return from_json(Diagnosis, said, text=text, before=fits.before, after=fits.after, only=tuple(said["candidates"]))
        return None

    # Up and down the ladder.

    def add(self, effect: str, progress: Progress | None = None) -> Mapping[str, Any]:
        """`effect` (``ID[=VALUE]``) added to the working copy as its next rung, and the comparison of the new model kept.

        Takes from seconds to minutes: `validation.app.workers.start(session, "add", effect=...)` does it in a worker.

        Returns
        -------
        The object of `massline add --json`: "errors" before and after, "verdict", "before" and "after" with "inertia".

        Raises
        ------
        BadInput, CheckFailed : see `validation.history.add.added`.
        """
        asked = add.AddedEffectOptions(effect=effect)
        study, known = add.opened(replace(self.asked, model=str(self.model)), asked, progress)
        step = add.added(study, asked, progress)
        self.compare(progress)
        return of_step(step.at, step.before, step.after, (*known, *step.said))

    def ladder(self) -> HistoryPosition:
        """The working copy and all its rungs, with errors, identified inertia, verdicts; `.rung` is the one it stands on. Quick.

        Raises
        ------
        BadInput : the working copy or its ladder cannot be read.
        """
        return history_position(self.model)

    def undo(self) -> HistoryPosition:
        """The working copy one rung down; what was computed for that rung is there at once.

        Raises
        ------
        BadInput : there is nothing below.
        """
        return history.undone(self.ladder())

    def put_back(self, before: str) -> str:
        """The working copy on the rung whose text has the digest `before` again, and a sentence on that.

        For a rung that was written by work that did not come to its end. It stays on the ladder, beside the way. Nothing is done,
        and nothing said, where the working copy is as it was.

        Raises
        ------
        BadInput, OSError : see `go_to`.
        """
        at = self.ladder()
        below = next((one for one in at.ladder.rungs if digest(one.model) == before), None)
        if digest(at.text) == before or below is None:
            return ""
        history.gone_to(at, below.number)
        new = "" if at.rung is None else f"rung {at.rung.number} was written already and stays on the ladder; "
        return f"{new}the model is back on rung {below.number}"

    def go_to(self, number: int) -> HistoryPosition:
        """The working copy on the rung `number`.

        Raises
        ------
        BadInput : there is no such rung.
        """
        return history.gone_to(self.ladder(), number)

    # What leaves a session: model, ladder, report and figures, whole or not at all, to where the user says. A session is deleted
    # when its window closes, and a report is signed and kept. So it names the files that the user named, files that a browser
    # handed over by the names under which it gave them, and the effects that the user's own model has not.

    def model_text(self) -> str:
        """The model file as it stands, as it would be saved beside the user's own, for a download.

        Raises
        ------
        BadInput : the working copy is gone.
        """
        return moved(read_text(self.model), self.model, Path(self.asked.model))

    def ladder_text(self) -> str:
        """Its ladder as it would be saved beside the user's own model, one JSON object, for a download.

        Raises
        ------
        BadInput : there is none yet.
        """
        beside = history.path_beside(self.model)
        if not beside.exists():
            problem = "there is none yet: a comparison makes its first rung"
            raise BadInput("ladder", "", problem, "Compare the model with its data")
        to = Path(self.asked.model)
        return history.text(moved_ladder(history.read(beside), self.model, to), to.name)

    def draw(self, folder: str | Path, progress: Progress | None = None) -> tuple[Path, ...]:
        """Write the pictures of comparison, diagnosis and ladder into `folder`, as the commands draw them; some ten seconds.

        Raises
        ------
        BadInput : nothing can be written there; model or data that cannot be used.
        CheckFailed : nothing can be rendered on this machine; a model that breaks down.
        OSError : a file cannot be written.
        """
        from validation.report.charts import history as ladder_chart

        tell, where = progress or (lambda what, share: None), Path(folder)
        require_folder(where, "figures")
        study = self.study(tell)
        compared = comparison_on(study, self.rung(study, tell), tell)
        tell("drawing the comparison", 0.0)
        made = [*compare.draw(compared, where)]
        found = self.diagnosis()
        if found is not None:
            tell("drawing the diagnosis", 0.5)
            made += diagnose.draw(found, where)
        tell("drawing the ladder", 0.7)
        return (*made, *ladder_chart.draw(history_position(self.model), where))

    def report(self, to: str | Path, progress: Progress | None = None) -> Path:
        """Write the report of the model as it stands to the file `to` (.html); what was found already is not found again.

        Takes a minute: `validation.app.workers.start(session, "report", to=...)` does it in a worker.

        Raises
        ------
        BadInput : nothing can be written there; model or data that cannot be used.
        CheckFailed : a model that breaks down.
        OSError : a file cannot be written.
        """
        tell, path = progress or (lambda what, share: None), Path(to)
        require_ending(path, (".html", ".htm"), "a report", "report.html")
        require_file(path, "report")
        study = self.study(tell)
        compared = comparison_on(study, self.rung(study, tell), tell)
        found, at = self.diagnosis(), history_position(self.model)
        report = page.assembled(
            study.model,
            self.read_data(study.model, tell),
            compared,
            provenance=self.provenance(study.model, diagnosed=found is not None),
            how=page.How(band=self.asked.band, method=self.asked.spectra),
            identified=() if at.rung is None else at.rung.bodies,
            diagnosis=found,
            not_diagnosed="" if found else "nobody asked for it",
            standing=at,
            progress=tell,
        )
        # With the user's own paths for model and campaigns
        campaigns = []
        for one in report.campaigns:
            source = one.campaign.source
            campaign = replace(one.campaign, source=self.given(source))
            campaigns.append(replace(one, campaign=campaign, command=one.command.replace(source, campaign.source)))
        model = replace(report.comparison, source=self.given(self.asked.model))
        page.write(replace(report, comparison=model, campaigns=tuple(campaigns)), path, tell)
        return path

    def provenance(self, model: Model, *, diagnosed: bool) -> Provenance:
        """That of a report on the `model`.

        Raises
        ------
        BadInput : the working copy is gone.
        OSError : a file cannot be read.
        """
        asked = self.asked
        question = replace(asked, model=asked.model if Path(asked.model).is_file() else str(self.model))
        made = page.provenance(page.ReportOptions(compared=question, diagnosis=diagnosed))
        typed = replace(
            question,
            model=self.given(asked.model),
            data=tuple(self.given(path) for path in asked.data),
            hold_out=tuple(self.given(name) for name in asked.hold_out),
        )
        try:
            own = {one.named.id for one in model_file.read(asked.model).effects}
        except (BadInput, OSError):
            own = set()
        added = tuple(one.named.id for one in model.effects if one.named.id not in own)
        return replace(
            made,
            command=page.command_line(typed, effects_from=asked.effects_from, diagnosis=diagnosed),
            inputs=tuple(replace(one, path=self.given(one.path)) for one in made.inputs),
            settings={**made.settings, "held out": typed.hold_out or made.settings["held out"], ADDED: added},
            model_text=self.model_text(),
        )

    def given(self, path: str) -> str:
        """`path` as the user knows it: of a file that a browser handed over, the name that it had there."""
        try:
            _, folder, *names = Path(path).relative_to(self.folder.parent).parts
        except ValueError:
            return path
        return path if folder != GIVEN else "/".join(names) or "."


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
    """A session in the new or empty `folder`, with a working copy of `model` and of the ladder beside it.

    Data are not read here; `validation.app.opening.faults` says what is wrong with them.

    Raises
    ------
    BadInput : `folder` holds something already, a model or ladder that cannot be read, a band that is none.
    OSError : the folder cannot be written.
    """
    where = Path(folder).resolve()
    if where.exists() and (not where.is_dir() or any(one.name != "given" for one in where.iterdir())):
        raise BadInput(str(folder), "", "it is there already and not empty", "Name a new folder for the desk")
    require_band(band)
    if method not in METHODS:
        raise BadInput("method", "", f"no method is called {method!r}", f"Known are {', '.join(METHODS)}")
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
    for path in asked.effects_from:
        catalogue.load(path)
    copied(Path(asked.model), made.model)
    said = {
        "format": FORMAT,
        "kind": "massline desk",
        "model": asked.model,
        "data": list(asked.data),
        "hold_out": list(asked.hold_out),
        "band_hz": None if asked.band is None else list(asked.band),
        "method": asked.method,
        "effects_from": list(asked.effects_from),
        "title": title,
    }
    write_text(where / STATE, json_text(said))
    return made


def opened(folder: str | Path) -> Session:
    """The session in `folder`, as it was left.

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
    for path in asked.effects_from:
        catalogue.load(path)
    found = Session(folder=where, asked=asked, title=title)
    read_text(found.model)
    return found


def is_session(folder: str | Path) -> bool:
    """Whether one was begun there."""
    return (Path(folder) / STATE).is_file()


def _absolute(path: str | Path) -> str:
    """Of what is there; names of shipped measurements stay names."""
    return str(Path(path).resolve()) if Path(path).exists() else str(path)


def _read(path: Path) -> dict[str, Any]:
    try:
        found = json.loads(path.read_text(encoding="utf-8"))
    except FileNotFoundError:
        raise BadInput(str(path.parent), "", "there is no desk here", "Begin one with a model and data") from None
    except (ValueError, RecursionError):
        raise _damaged(path.parent, f"its {path.name} cannot be read") from None
    if not isinstance(found, dict):
        raise _damaged(path.parent, f"its {path.name} holds no object")
    return found


def _damaged(folder: Path, problem: str) -> BadInput:
    return BadInput(str(folder), "", problem, "Begin a new desk; the user's own files were never changed")


def _tested(model: Model, of: KeptSpectra) -> TestedCampaign:
    """A campaign from its kept spectra."""
    campaign = campaign_file.read_description(of.source)
    mounted = mounted_article(model, campaign, of.measured.frequency[-1])
    return TestedCampaign(
        model=model,
        campaign=replace(campaign, warnings=of.warnings),
        measured=of.measured,
        carried=series.supported_dynamic_mass(model, campaign, mounted, of.measured.name),
        drives=of.drives,
        per_rms=of.per_rms,
        method=of.method,
        remarks=of.remarks,
    )


def comparison_on(study: Study, at: Version, progress: Progress) -> Comparison:
    """What `validation.compare.compare` finds, from the fits of the rung `at` instead of fits of its own.

    Raises
    ------
    CheckFailed : without some channel the others do not tell the inputs.
    ValueError : the rung has no figures.
    """
    figures = at.errors
    if figures is None:
        raise ValueError("`at` must have figures")
    # The errors of a rung with the fits behind them, taken where they ended; shares of fitted data are told anew
    known, start = study.problem(), study.whole().start
    unfinished = figures.unfinished or BOTH_FITS[: 2 * (not figures.converged)]  # older ladders do not say which
    plain, fitted = (
        replace(unfitted(known, kinds, offsets), converged=name not in unfinished)
        for name, kinds, offsets in zip(BOTH_FITS, (PLAIN, FITTED), (at.plain_offsets, at.fitted_offsets), strict=True)
    )
    nominal, fitted_data = (
        evaluate.share([one for prediction in known.predictions for one in evaluate.squares(prediction, offsets)])
        for offsets in (start, {**start, **plain.by_name})
    )
    evaluation = Evaluation(
        nominal=nominal,
        plain=fitted_data,
        held_out=_share(figures.held_out, figures.by_fold),
        held_out_nominal=_share(figures.held_out_nominal, {}),
        plain_fit=plain,
        fitted=replace(
            fitted, chi2=figures.chi2, degrees_of_freedom=figures.degrees_of_freedom, log_evidence=figures.log_evidence
        ),
        held_out_names=figures.held_out_names,
    )
    return of_evaluation(study, study.problem(), evaluation, lambda share: progress("maps", share))


def _share(percent: float | None, by_fold: Mapping[str, float]) -> Share | None:
    return None if percent is None else Share(percent=percent, by_fold=dict(by_fold))


def _read_comparison(folder: Path) -> Compared:
    return replace(kept.read(Compared, folder / MAPS), summary=json.loads((folder / SUMMARY).read_text(encoding="utf-8")))
