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
import os.path
import re
import shutil
import zlib
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from hashlib import sha256
from math import inf
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
from validation.compare.compare import Comparison, of_evaluation
from validation.compare.correlation import FunctionCorrelation, ModalCorrelation, ModePair
from validation.compare.maps import Functions, Map, NamedMode, Pairs
from validation.diagnose.diagnosis import Diagnosis
from validation.effects import catalogue
from validation.estimation import evaluate
from validation.estimation.fit import unfitted
from validation.estimation.problem import FITTED, PLAIN, Evaluation, Fit, Measured, Parameter, Share
from validation.history import add, history
from validation.history.history import HistoryPosition, Ladder, Source, Version, history_position, read_text
from validation.model import model_file
from validation.model.model import Model
from validation.output import from_json, json_text, require_ending, require_file, require_folder, to_json
from validation.prediction import series
from validation.prediction.dynamic_mass import BaseDrive
from validation.prediction.series import SeriesPrediction, TestedCampaign
from validation.prediction.structure import mounted_article
from validation.report import compare, diagnose, page
from validation.report.history import of_step
from validation.report.parts import Provenance
from validation.study import Data, Options, Study, is_test, read_data, read_tests, require_band

Progress = Callable[[str, float], None]

FORMAT, SPECTRA_FORMAT = 1, 2
STATE, VIEW = "desk.json", "view.json"
GIVEN = "given"
"""The folder of a session in which files lie that a browser handed over."""

LARGEST_VIEW = 1_000_000
"""Characters of what a face may keep."""

ADDED = "effects added in the workbench"

DAMAGE = (OSError, EOFError, ValueError, KeyError, TypeError, BadZipFile, zlib.error)
"""What a file of arrays raises that is not there, not whole, or of another version."""

DRIVE = ("amplitude", "nominal", "sweep_rate", "block")

SUMMARY, MAPS = "compare.json", "maps.npz"
NODES = "nodes.npz"
"""The file with what a diagnosis says of every node of a mesh."""

DIAGNOSIS, TOLERANCES = "diagnose.json", "diagnose.tolerances.json"
"""The object of `massline diagnose --json`, and what its fits lack: by parameter what was known of it beforehand."""

TEXTS = ("data_set", "configuration", "runs", "axes", "rows", "channels", "remarks")
ARRAYS = tuple(one.name for one in fields(Map) if one.name not in (*TEXTS, "pairs", "functions"))
OF_PAIRS = tuple(one.name for one in fields(Pairs) if one.name != "campaign")
OF_FUNCTIONS = ("measured", "predicted", "expected", "coherence")
OF_MODES = ("mac", "cross_orthogonality", "measured_shapes", "model_shapes")

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
            with self.spectra.open("rb") as opened, np.load(opened, allow_pickle=False) as held:
                head = json.loads(held["head"].tobytes())
                if head["format"] != SPECTRA_FORMAT or head["asked"] != self._stamp():
                    raise ValueError("made from other data")
                tested = [_tested(model, said, f"{k}.", held) for k, said in enumerate(head["campaigns"])]
            return tuple(SeriesPrediction(tested=one, effects=model.effects) for one in tested)
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
        kept: dict[str, Any] = {}
        campaigns = []
        for k, of in enumerate(one.tested for one in found):
            # Of the spectra every field that there is, whatever is added to them: what JSON can hold, and arrays
            every = {one.name: getattr(of.measured, one.name) for one in fields(of.measured)}
            arrays = {name: value for name, value in every.items() if isinstance(value, np.ndarray)}
            drives = {name: np.array([getattr(one, name) for one in of.drives]) for name in DRIVE}
            kept |= {f"{k}.{name}": value for name, value in {**arrays, **drives, "per_rms": of.per_rms}.items()}
            said = {
                "source": of.campaign.source,
                "warnings": list(of.campaign.warnings),
                "method": of.method,
                "remarks": list(of.remarks),
                "words": {name: value for name, value in every.items() if name not in arrays},
                "arrays": list(arrays),
            }
            campaigns.append(said)
        head = {"format": SPECTRA_FORMAT, "asked": self._stamp(), "campaigns": campaigns}
        kept["head"] = np.frombuffer(json.dumps(head).encode(), dtype=np.uint8)
        write_with(self.spectra, lambda temporary: np.savez(temporary, allow_pickle=False, **kept))

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
        return [list(self.asked.data), None if self.asked.band is None else list(self.asked.band), self.asked.method, files]

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
        """The rung on which the model stands, fitted and kept where it was not yet.

        Raises
        ------
        BadInput : the working copy was changed meanwhile.
        CheckFailed : a fit does not converge.
        """
        at = history_position(self.model)
        if at.rung is not None and at.rung.stands_on(add.conditions_of(study)):
            return at.rung
        found = add.grounded(at, study, lambda what, share: progress(what.removeprefix("the model before: "), share))[0].rung
        if found is None:
            raise RuntimeError("a rung that was kept must be the one on which the model stands")
        return found

    def compare(self, progress: Progress | None = None) -> "Compared":
        """The model held against its data, and kept; on a rung of the ladder without fitting anything anew.

        Takes from seconds to minutes: `validation.app.workers.start(session, "compare")` does it in a worker.

        Raises
        ------
        BadInput : model or data that cannot be used.
        CheckFailed : a fit that does not converge.
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
            loads.append({one.name: np.flatnonzero(share[:, k] > ARM).tolist() for k, one in enumerate(told)})
        arrays = {f"{k}.{name}": getattr(one, name) for k, one in enumerate(found.maps) for name in ARRAYS}
        for k, one in enumerate(found.maps):
            arrays |= {} if one.pairs is None else {f"{k}.pairs.{name}": getattr(one.pairs, name) for name in OF_PAIRS}
            if one.functions is not None:
                known = {name: getattr(one.functions, name) for name in OF_FUNCTIONS}
                arrays |= {f"{k}.functions.{name}": value for name, value in known.items() if value is not None}
        tables = [one for one in found.correlation if isinstance(one, ModalCorrelation)]
        arrays |= {f"table.{k}.{name}": getattr(one, name) for k, one in enumerate(tables) for name in OF_MODES}
        words = {
            "maps": [{name: getattr(one, name) for name in TEXTS} for one in found.maps],
            "modes": [[vars(mode) for mode in each] for each in found.modes],
            "offsets": found.evaluation.plain_fit.by_name,
            "loads": loads,
            "errors": compare.errors(found).panel(),
            "functions": {k: one.functions.unit for k, one in enumerate(found.maps) if one.functions is not None},
            "tables": [
                {
                    "data_set": one.data_set,
                    "rule": one.rule,
                    "pairs": [vars(pair) for pair in one.pairs],
                    "missing": one.missing,
                    "modes": one.modes,
                    "comac": dict(one.comac),
                    "remarks": one.remarks,
                }
                for one in tables
            ],
            "frac": {one.data_set: dict(one.frac) for one in found.correlation if isinstance(one, FunctionCorrelation)},
        }
        arrays["words"] = np.frombuffer(json.dumps(words).encode(), dtype=np.uint8)
        # Arrays first: where the summary is, all is
        write_with(folder / MAPS, lambda temporary: np.savez(temporary, allow_pickle=False, **arrays))
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
                kept = other.folder / "found" / now
                if folder == self.folder or other.asked != self.asked or ladder.exists() or not (kept / SUMMARY).is_file():
                    continue
                beside = history.path_beside(other.model)
                own = {one.relative_to(other.model.parent) for one in other.model.parent.rglob("*") if one.is_file()}
                named = own - {Path(other.model.name), Path(beside.name)}
                _, *differing = filecmp.cmpfiles(other.model.parent, self.model.parent, map(str, named), shallow=False)
                with other.spectra.open("rb") as held, np.load(held, allow_pickle=False) as arrays:
                    same = json.loads(arrays["head"].tobytes())["asked"] == self._stamp()
                first = next(iter(history.read(beside).rungs))
                if any(differing) or not same or digest(first.model) != now or first.errors is None:
                    continue
                shutil.copyfile(other.spectra, self.spectra)
                shutil.copytree(kept, self.found)
                history.write(ladder, Ladder(rungs=(first,), current=first.number), self.model.name)
                return True
        return False

    def comparison(self) -> "Compared | None":
        """That of the model as it stands, if it was made; quick."""
        try:
            return _read_comparison(self.found)
        except DAMAGE:
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
        CheckFailed : the model with all its tolerances does not converge.
        OSError : a file cannot be read or written.
        """
        folder, tell = self.found, progress or (lambda what, share: None)
        tell("reading", 0.0)
        asked = replace(self.asked, model=str(self.model), candidates=tuple(candidates))
        study = diagnose.prepared(asked)
        found = diagnose.diagnosis(asked, study, tell)
        whole = {**diagnose.of_asked(asked, study), **to_json(found)}
        known = {
            when: {one.name: None if one.tolerance == inf else one.tolerance for one in of.fitted.parameters}
            for when, of in (("before", found.before), ("after", found.after))
        }
        scores = {f"{k}.{name}": getattr(one, name) for k, one in enumerate(found.nodes) for name in ("article", "points")}
        scores |= {f"{k}.evidence.{kind}": e for k, one in enumerate(found.nodes) for kind, e in one.evidence.items()}
        write_with(folder / NODES, lambda temporary: np.savez(temporary, allow_pickle=False, **scores))
        write_text(folder / TOLERANCES, json_text(known))
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
        """That of the model as it stands, if it was made, as figures and reports take it; quick.

        All that pages and pictures show comes back as it was; of the fits' covariance only its diagonal is there.
        """
        try:
            said, known = (json.loads((self.found / name).read_text(encoding="utf-8")) for name in (DIAGNOSIS, TOLERANCES))
            before = _read_evaluation(said, "before", known["before"])
            return from_json(
                Diagnosis,
                said,
                text="" if said["text"] == said["headline"] else said["text"],
                before=before,
                after=_read_evaluation(said, "after", known["after"]) if said["accepted"] else before,
                only=tuple(said["candidates"]),
            )
        except (OSError, ValueError, KeyError, TypeError):
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
            raise BadInput(source="ladder", problem=problem, remedy="Compare the model with its data")
        to = Path(self.asked.model)
        return history.text(moved_ladder(history.read(beside), self.model, to), to.name)

    def draw(self, folder: str | Path, progress: Progress | None = None) -> tuple[Path, ...]:
        """Write the pictures of comparison, diagnosis and ladder into `folder`, as the commands draw them; some ten seconds.

        Raises
        ------
        BadInput : nothing can be written there; model or data that cannot be used.
        CheckFailed : nothing can be rendered on this machine; a fit that does not converge.
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
        CheckFailed : a fit that does not converge.
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


def _tested(model: Model, said: dict[str, Any], prefix: str, held: Any) -> TestedCampaign:
    """A campaign from its kept spectra: `said` of the head, and the arrays of that `prefix`."""
    campaign = campaign_file.read_description(said["source"])
    words: dict[str, Any] = _tuples(said["words"])
    measured = Measured(**words, **{name: held[prefix + name] for name in said["arrays"]})
    drives = zip(*(held[prefix + name] for name in DRIVE), strict=True)
    return TestedCampaign(
        model=model,
        campaign=replace(campaign, warnings=tuple(said["warnings"])),
        measured=measured,
        carried=series.supported_dynamic_mass(
            model, campaign, mounted_article(model, campaign, measured.frequency[-1]), measured.name
        ),
        drives=tuple(BaseDrive(amplitude=a, nominal=n, sweep_rate=float(r), block=float(b)) for a, n, r, b in drives),
        per_rms=held[prefix + "per_rms"],
        method=said["method"],
        remarks=tuple(said["remarks"]),
    )


def _tuples(said: dict[str, Any]) -> dict[str, Any]:
    return {name: tuple(value) if isinstance(value, list) else value for name, value in said.items()}


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
    plain, fitted = (
        replace(unfitted(known, kinds, offsets), converged=figures.converged)
        for kinds, offsets in ((PLAIN, at.plain_offsets), (FITTED, at.fitted_offsets))
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
    tables : tables of modes, and resonances of response functions, beside the model
    frac : by data set of response functions, ``run/channel``, how alike they are
    """

    summary: Mapping[str, Any]
    maps: tuple[Map, ...]
    modes: tuple[tuple[NamedMode, ...], ...]
    offsets: Mapping[str, float]
    loads: tuple[Mapping[str, tuple[int, ...]], ...]
    errors: tuple[Mapping[str, Any], ...] = ()
    tables: tuple[ModalCorrelation, ...] = ()
    frac: Mapping[str, Mapping[str, float]] = field(default_factory=dict)

    @property
    def campaigns(self) -> tuple[str, ...]:
        """Names of the data sets, in order."""
        return tuple(one.data_set for one in self.maps)

    def table(self, data_set: str) -> ModalCorrelation | None:
        """The modes beside `data_set`: a table of modes has a data set of frequencies and one of shapes."""
        titles = [data_set, data_set.removesuffix(" frequencies"), data_set.removesuffix(" shapes")]
        return next((one for one in self.tables if one.data_set in titles), None)

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


def _read_comparison(folder: Path) -> Compared:
    summary = json.loads((folder / SUMMARY).read_text(encoding="utf-8"))
    maps = []
    with (folder / MAPS).open("rb") as opened, np.load(opened, allow_pickle=False) as held:
        words = json.loads(held["words"].tobytes())
        for k, said in enumerate(words["maps"]):
            pairs = None
            if f"{k}.pairs.{OF_PAIRS[0]}" in held:
                pairs = Pairs(campaign=said["data_set"], **{name: held[f"{k}.pairs.{name}"] for name in OF_PAIRS})
            functions = None
            if (unit := words["functions"].get(str(k))) is not None:
                known = {name: held[f"{k}.functions.{name}"] for name in OF_FUNCTIONS if f"{k}.functions.{name}" in held}
                functions = Functions(unit=unit, **known)
            arrays = {name: held[f"{k}.{name}"] for name in ARRAYS}
            maps.append(Map(**_tuples(said), **arrays, pairs=pairs, functions=functions))
        tables = []
        for k, said in enumerate(words["tables"]):
            arrays = {name: held[f"table.{k}.{name}"] for name in OF_MODES}
            pairs_of = tuple(ModePair(**pair) for pair in said.pop("pairs"))
            tables.append(ModalCorrelation(**_tuples(said), **arrays, pairs=pairs_of))
    return Compared(
        summary=summary,
        maps=tuple(maps),
        modes=tuple(tuple(NamedMode(**_tuples(mode)) for mode in each) for each in words["modes"]),
        offsets=words["offsets"],
        loads=tuple(_tuples(one) for one in words["loads"]),
        errors=tuple(words["errors"]),
        tables=tuple(tables),
        frac=words["frac"],
    )


# A diagnosis again from its JSON: of an evaluation that has the figures, and of a fit its parameters one by one.


def _read_evaluation(said: Mapping[str, Any], when: str, known: Mapping[str, float | None]) -> Evaluation:
    """The errors "before" or "after"; `known` is what was known of the parameters beforehand."""
    one, errors = said[when], said["errors"]
    return Evaluation(
        nominal=Share(percent=errors[f"nominal_{when}_percent"]),
        plain=Share(
            percent=errors[f"plain_{when}_percent"],
            by_channel=one["plain_percent_by_channel"],
            by_run=one["plain_percent_by_run"],
        ),
        held_out=_share(errors[f"heldout_{when}_percent"], one["heldout_percent_by_fold"]),
        held_out_nominal=_share(errors[f"heldout_nominal_{when}_percent"], {}),
        plain_fit=_read_fit(one["plain"], known),
        fitted=_read_fit(one["fitted"], known),
        held_out_names=tuple(one["held_out"]),
        held_out_configurations=_share(errors[f"heldout_configurations_{when}_percent"], {}),
    )


def _read_fit(one: Mapping[str, Any], known: Mapping[str, float | None]) -> Fit:
    said = one["parameters"]
    # JSON knows no infinity, and has nothing in its place
    chi2, tolerance_z2, evidence = (
        inf if one[key] is None else float(one[key]) for key in ("chi2", "tolerance_z2", "log_evidence_nats")
    )
    return Fit(
        parameters=tuple(
            Parameter(name=name, unit="", tolerance=inf if known[name] is None else float(known[name] or 0.0), kind=each["kind"])
            for name, each in said.items()
        ),
        offsets=np.array([each["offset"] for each in said.values()], dtype=np.float64),
        covariance=np.diag(np.array([each["sd"] for each in said.values()], dtype=np.float64) ** 2),
        cost=inf,
        chi2=chi2,
        degrees_of_freedom=one["degrees_of_freedom"],
        tolerance_z2=tolerance_z2,
        tolerances=one["tolerances"],
        log_evidence=evidence,
        converged=one["converged"],
    )


# A model file and its ladder in another folder. Paths in ``[structure.own]`` and in a ladder (its data) are seen from their own
# folder: a copy that is read in another one must say them otherwise; every other byte stays, comments and ends of lines too.


TABLE = re.compile(r"^\s*\[(?!\[)\s*structure\s*\.\s*own\s*\]")
OTHER = re.compile(r"^\s*\[")
ENTRY = re.compile(
    r"^(?P<key>\s*(?:\"[^\"]*\"|'[^']*'|[\w-]+)\s*=\s*)(?P<quote>[\"'])(?P<path>[^\"'\\]*)(?P=quote)(?P<rest>.*)$", re.S
)


def copied(model: Path, to: Path) -> None:
    """Copy the file `model`, and the ladder beside it where there is one, to the file `to` and beside it.

    Files that structure and tests of the model are in go with it: they are looked for beside the model alone.

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
    for path in _named(text, model):
        copy = to.parent / path.relative_to(model.parent)
        copy.parent.mkdir(parents=True, exist_ok=True)
        write_with(copy, lambda temporary, path=path: shutil.copyfile(path, temporary))  # type: ignore[misc]
    if ladder is not None:
        history.write(history.path_beside(to), ladder, to.name)
    write_with(to, lambda temporary: temporary.write_bytes(text.encode("utf-8")))


def _named(text: str, model: Path) -> Iterator[Path]:
    """The files of structure and tests, which lie with `model` or below, and what lies beside them under the same name."""
    table, seen = toml_file.parse(text, str(model)), {model}
    for name in toml_file.texts([table.get("fe_model"), table.get("test")]):
        path = model.parent / name
        with suppress(OSError, ValueError):  # a text that no file can be called
            if path.is_file() and path.resolve().is_relative_to(model.parent.resolve()):
                alike = {one for one in path.parent.iterdir() if one.stem == path.stem and one.is_file()} - seen
                seen |= alike
                yield from sorted(alike)


def moved(text: str, model: Path, to: Path) -> str:
    """`text` of the file `model` as the file `to` must say it: paths of a user's own models seen from there.

    Raises
    ------
    BadInput : such paths stand where they cannot be found, as in an inline table.
    """
    if "own" not in text or model.resolve().parent == to.resolve().parent:
        return text

    def files(said: str, where: Path) -> dict[str, Path]:
        """Of the articles; a structure in the text itself is no other file."""
        own = model_file.of_text(said, str(where)).own.items()
        return {name: Path(path).resolve() for name, path in own if path != str(where)}

    lines, inside = text.splitlines(keepends=True), False
    for k, line in enumerate(lines):
        if OTHER.match(line):
            inside = bool(TABLE.match(line))
        elif inside and (entry := ENTRY.match(line)):
            path = _seen(entry["path"], model, to)
            lines[k] = f"{entry['key']}{entry['quote']}{path}{entry['quote']}{entry['rest']}"
    found = "".join(lines)
    # The models of both texts must be the same files
    known = files(text, model)
    try:
        same = files(found, to) == known
    except BadInput:  # a path that leads nowhere from there
        same = False
    if not same:
        problem = (
            "the paths of your own models do not stand one a line in [structure.own], and cannot be said from another folder"
        )
        raise BadInput(
            source=str(model), field="structure.own", problem=problem, remedy='Write "article" = "path" on lines there'
        )
    return found


def _seen(path: str, model: Path, to: Path) -> str:
    """A path from the folder of `model`, from that of `to`; an absolute one stays as it is."""
    if not path or Path(path).is_absolute():
        return path
    return Path(os.path.relpath(model.resolve().parent / path, to.resolve().parent)).as_posix()


def moved_ladder(ladder: Ladder, model: Path, to: Path) -> Ladder:
    """`ladder` of the file `model` as that of the file `to` must say it: its texts as `moved`, its data seen from there.

    Raises
    ------
    BadInput : see `moved`.
    """
    rungs = []
    for one in ladder.rungs:
        data = tuple(
            # The name of a shipped measurement stays a name
            Source(path=_seen(each.path, model, to) if (model.parent / each.path).exists() else each.path, digest=each.digest)
            for each in one.conditions.data
        )
        rungs.append(replace(one, model=moved(one.model, model, to), conditions=replace(one.conditions, data=data)))
    return replace(ladder, rungs=tuple(rungs))
