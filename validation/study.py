"""`Study`: a model and its data, opened once. `Options`: what a user asks of them. `Data`: what was read.

What contradicts itself is refused before the first signal is read: the same folder twice, one article on two FMDs, files
without any campaign. Spectra are made when a study is opened; the fit of all parameters and the four errors when somebody first
asks for them, and then they are kept, whoever asks next.
"""

from collections.abc import Callable, Iterator, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, fields, replace
from functools import cached_property, partial
from itertools import chain
from math import isfinite
from pathlib import Path
from typing import Self

from geometry import toml_file
from geometry.errors import BadInput, CheckFailed
from geometry.toml_file import nearest
from identification import campaign_file, test_file
from identification.campaign import METHODS, Campaign
from identification.files import uff
from validation.classical import files
from validation.effects.catalogue import There, words_of
from validation.effects.effect import AT, AXES, INDISTINGUISHABLE_NATS, Vocabulary
from validation.estimation.evaluate import evaluate, named, without
from validation.estimation.fit import fit, nearby
from validation.estimation.problem import FITTED, Evaluation, Fact, Fit, Problem
from validation.history.history import HistoryPosition, history_position, reminded
from validation.model import model_file
from validation.model.model import Added, Model, require_pair, vocabulary
from validation.model.setups import above_fmd
from validation.prediction import structure_tests
from validation.prediction.classical_facts import ArticleFact, facts, require_bodies
from validation.prediction.series import SeriesPrediction, predictions
from validation.prediction.structure import ReducedStructure, lacking
from validation.prediction.structure_tests import StructurePrediction, Test

TRUTH = ".truth.json"
"""Ending of what `massline simulate` writes beside its campaigns."""

Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""


@dataclass(frozen=True, kw_only=True)
class Options:
    """What is asked of a model and its data, as typed.

    Attributes
    ----------
    model : path of the model file
    data : campaign folders, tests and measurement files, beside the tests that the model file names; of `massline add` none for
        those that the ladder knows
    hold_out : names of runs, campaigns and files that are predicted and never fitted; none for each run in turn
    band : (low, high) [Hz]; None for what all runs drive
    method : of `METHODS`, how spectra are made; None for the first of them, of `massline add` for the ladder's own
    candidates : ids and families of effects that a diagnosis looks for; all where none is named
    leave_out : those that it does not look for
    effects_from : folders of the user's own effects
    """

    model: str
    data: tuple[str, ...] = ()
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    method: str | None = METHODS[0]
    candidates: tuple[str, ...] = ()
    leave_out: tuple[str, ...] = ()
    effects_from: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "data", tuple(map(toml_file.described_in, self.data)))

    @property
    def spectra(self) -> str:
        """The method that is used."""
        return self.method or METHODS[0]

    @property
    def path(self) -> Path:
        """Of the model file."""
        return Path(self.model)


@dataclass(frozen=True, eq=False, kw_only=True)
class Data:
    """What a model is compared with.

    Attributes
    ----------
    campaigns : with their recordings, in the order in which they were named
    classical : names of measurement files
    tests : response functions and modal tables
    """

    campaigns: tuple[Campaign, ...]
    classical: tuple[str, ...] = ()
    tests: tuple[Test, ...] = ()


def read_data(paths: Sequence[str], model: Model, progress: Progress | None = None) -> Data:
    """The data at `paths`, which belong to `model` and to each other.

    Raises
    ------
    BadInput : a path that is no campaign, test or measurement, data that contradict each other or the model, neither campaign
        nor test, effects that leave no body of an article.
    OSError : a file cannot be read.
    """
    folders = [path for path in paths if Path(path).is_dir()]
    classical = tuple(path for path in paths if path not in folders and not is_test(path))
    for path in classical:
        _require_measurement(path)
    _require_once(paths)
    tests = read_tests(paths, model)
    if not folders and not tests:
        none = "there is no data: the model names no [[test]]"
        some = "there is no campaign and no test among them, and weights and periods alone tell nothing of frequencies"
        remedy = "Name a campaign folder or the file of a test; `massline weigh`, `cog` and `pendulum` reduce files alone"
        raise BadInput("DATA", "", some if paths else none, remedy)
    described = [campaign_file.read_description(folder) for folder in folders]
    for k, one in enumerate(described):
        for other in described[:k]:  # one article on two FMDs is two series, whatever the model says
            if one.article == other.article and one.hardware != other.hardware and one.hardware and other.hardware:
                problem = f"is {one.hardware}, and that of {other.source}, also of {one.article}, is {other.hardware}"
                remedy = "Another FMD has other sensors: compare each series with a model of its own"
                where = f"{one.source}/{campaign_file.NAME}"
                raise BadInput(where, "campaign.hardware", problem, remedy)
    if described:
        require_pair(model, described)
        require_bodies(model, described)
    tell = progress or (lambda folder, share: None)
    campaigns = tuple(campaign_file.read(folder, progress=partial(tell, folder)) for folder in folders)
    return Data(campaigns=campaigns, classical=classical, tests=tests)


def read_tests(paths: Sequence[str], model: Model) -> tuple[Test, ...]:
    """The tests that the `model` names, then those among `paths`.

    Raises
    ------
    BadInput : a test that cannot be used.
    OSError : a file cannot be read.
    """
    own = [test_file.read(model.source, {"article": model.article, **one}, gain=model.sensor_gain) for one in model.tests]
    untitled = [k for k, one in enumerate(model.tests) if "title" not in one]
    for k in untitled if len(untitled) > 1 else ():
        own[k] = replace(own[k], title=f"{own[k].title}-{k + 1}")
    named = (test_file.all_in(path, model.article, gain=model.sensor_gain) for path in paths if is_test(path))
    return (*own, *chain.from_iterable(named))


def tests_in(path: Path) -> tuple[Test, ...] | None:
    """The tests in the file `path`: a description, a model's [[test]] or a universal file; None where it describes a campaign.

    Raises
    ------
    BadInput : none of them, and what it is is said; a test that cannot be used.
    OSError : a file cannot be read.
    """
    if path.suffix.lower() != ".toml":
        return test_file.all_in(path, path.stem)
    table = toml_file.read(path)
    if "campaign" in table or "channel" in table:
        return None
    if "kind" in table:
        return (test_file.read(path, table),)
    if "model" in table and "test" in table:
        return read_tests((), model_file.of_table(table, str(path)))
    what = "a model file without a [[test]]" if "model" in table else f"a file with {', '.join(table) or 'nothing'}"
    raise BadInput(str(path), "", f"it is {what}, no measurement", "Name the folder of a campaign, or a test")


def is_test(path: str) -> bool:
    """Whether the file at `path` describes response functions or a modal table, or is a universal file of them."""
    if uff.is_universal(Path(path)):
        return Path(path).is_file()
    if not path.endswith(".toml") or not Path(path).is_file():
        return False
    with suppress(BadInput):
        return toml_file.read(path).get("kind") in test_file.KINDS
    return False


def only_files(paths: Sequence[str]) -> tuple[str, ...]:
    """`paths` where all of them are files that are there: measurements that stand by themselves, without any campaign.

    Raises
    ------
    BadInput : one of them is no measurement, or is named twice.
    """
    if any(map(is_test, paths)) or not all(
        Path(path).is_file() or path.removesuffix(".toml") in files.shipped() for path in paths
    ):
        return ()
    for path in paths:
        _require_measurement(path)
    _require_once(paths)
    return tuple(paths)


def _require_measurement(path: str) -> None:
    """Refuse what is no measurement file, and what is not there."""
    if Path(path).name == campaign_file.NAME:
        raise BadInput(path, "", "this is the description of a campaign", f"Name its folder, {Path(path).parent}")
    if path.endswith(TRUTH):
        problem = "this is the truth beside a simulated campaign, which no comparison may know"
        raise BadInput(path, "", problem, "Leave it out: name the folders alone")
    known = files.shipped()
    if not Path(path).exists() and path.removesuffix(".toml") not in known:
        beside = [str(one) for one in Path(path).parent.iterdir()] if Path(path).parent.is_dir() else []
        remedy = f"{nearest(path, beside)}Name campaign folders, and weigh, cog and pendulum files"
        raise BadInput(path, "", "there is no such file or folder", remedy)
    files.read(path, files.KINDS)


def _require_once(paths: Sequence[str]) -> None:
    seen: dict[Path, str] = {}
    for path in paths:
        where = Path(path).resolve()
        if where in seen:
            same = "is named twice" if seen[where] == path else f"is the same as {seen[where]}"
            raise BadInput("DATA", path, same, "Data that count twice are trusted twice: name it once")
        seen[where] = path


def require_band(band: tuple[float, float] | None) -> None:
    """Refuse a band that ends before it begins."""
    if band is not None and not (0 < band[0] < band[1] and isfinite(band[1])):
        problem = f"two frequencies, the lower one first and above 0 Hz, are expected, found {band[0]:g} {band[1]:g}"
        raise BadInput("--band", "", problem, "Write for example --band 4 32")


def resolved_names(problem: Problem, data: Data, names: Sequence[str]) -> tuple[str, ...]:
    """`names` as the engine knows them: a campaign may be named by its folder, a fact by its file."""
    folders = {
        Path(one.source).resolve(): made.measured.name for one, made in zip(data.campaigns, problem.predictions, strict=False)
    }
    found: list[str] = []
    for name in names:
        of_file = [fact.name for fact in problem.facts if name in data.classical and fact.name.startswith(name)]
        found += of_file or [folders.get(Path(name).resolve(), name)]
    return tuple(found)


def read(asked: Options, progress: Progress | None = None) -> tuple[Model, Data]:
    """The model and the data that are `asked`.

    Raises
    ------
    BadInput : a band that is none, a model or data that cannot be used, or that do not belong together.
    OSError : a file cannot be read.
    """
    require_band(asked.band)
    with reminded(asked.path):
        model = model_file.read(asked.model)
    return model, read_data(asked.data, model, progress)


@dataclass(frozen=True, eq=False, kw_only=True)
class Study:
    """A model and its data, opened once, ready for any effects.

    Attributes
    ----------
    model : whose laboratory and structure are held against the data, with the effects that it has
    campaigns : as they were read
    made : predictions of the campaigns by the model without effects, with the spectra
    tests : predictions of response functions and modal tables by the model without effects
    said : what weights and periods say, beside the model without effects
    hold_out : names of runs, data sets and facts that no fit sees, as the engine knows them
    asked : from which it was opened
    """

    model: Model
    campaigns: tuple[Campaign, ...] = ()
    made: tuple[SeriesPrediction, ...] = ()
    tests: tuple[StructurePrediction, ...] = ()
    said: tuple[ArticleFact, ...] = ()
    hold_out: tuple[str, ...] = ()
    asked: Options = field(default_factory=lambda: Options(model=""))
    _fits: list[Fit] = field(default_factory=list, init=False, repr=False)
    _evaluations: list[Evaluation] = field(default_factory=list, init=False, repr=False)

    @property
    def plain(self) -> "Study":
        """The same as it was opened, with nothing remembered: what two of the same have alike."""
        return Study(**{one.name: getattr(self, one.name) for one in fields(Study) if one.init})

    @classmethod
    def open(
        cls,
        model: str | Path | Model,
        paths: Sequence[str | Path],
        *,
        hold_out: Sequence[str] = (),
        band: tuple[float, float] | None = None,
        method: str = METHODS[0],
        progress: Progress | None = None,
    ) -> Self:
        """The model file `model`, or a model in memory, beside the campaign folders and measurement files `paths`.

        Parameters
        ----------
        hold_out : names of runs, campaigns and files that are predicted and never fitted; each run in turn by default
        band : (low, high) [Hz]; what all runs drive by default
        method : of `METHODS`, how spectra are made
        progress : hears what is done, and the share of it

        Raises
        ------
        BadInput : a model or data that cannot be used, or that do not belong together; a name of `hold_out` that is none.
        OSError : a file cannot be read.
        """
        data, source = tuple(map(str, paths)), model.source if isinstance(model, Model) else str(model)
        asked = Options(model=source, data=data, hold_out=tuple(hold_out), band=band, method=method)
        if isinstance(model, Model):
            require_band(band)
            return cls.of(model, read_data(data, model, progress), asked, progress)
        return cls.of(*read(asked, progress), asked, progress)

    @classmethod
    def of(cls, model: Model, data: Data, asked: Options | None = None, progress: Progress | None = None) -> Self:
        """A `model` and `data` that were read, as they were `asked`.

        Raises
        ------
        BadInput : an unknown name among what is held out; whatever makes no spectra.
        """
        tell, asked = progress or (lambda what, share: None), asked or Options(model=model.source)
        bare = replace(model, effects=(), looked_at=model.positions)
        made = predictions(
            bare, data.campaigns, band=asked.band, method=asked.spectra, progress=lambda share: tell("spectra", share)
        )
        return cls.of_spectra(model, data, made, asked)

    @classmethod
    def of_spectra(cls, model: Model, data: Data, made: Sequence[SeriesPrediction], asked: Options) -> Self:
        """The same from predictions by the `model` with any effects, whose spectra were made before.

        Raises
        ------
        BadInput : an unknown name among what is held out.
        """
        bare = replace(model, effects=(), looked_at=model.positions)
        plain = tuple(one.with_effects(()) for one in made)
        tests = structure_tests.predictions(bare, [structure_tests.within(one, asked.band) for one in data.tests])
        said = facts(bare, data.classical)
        opened = cls(model=model, campaigns=data.campaigns, made=plain, tests=tests, said=said, asked=asked)
        whole = opened.whole()
        names = resolved_names(whole, data, asked.hold_out)
        if names:
            without(whole, named(whole, names))  # refused before minutes are spent
        return replace(opened, hold_out=names)

    def ready_at(self, positions: Sequence[str], *, anew: bool = True) -> Self:
        """The same with tests made ready for effects at `positions`, places that are written as coordinates; where not `anew`
        for such as are tried, and may be tried no better (`ReducedStructure.at`).

        Raises
        ------
        BadInput : outside the meshes of all structures.
        """
        outside: dict[str, list[BadInput | None]] = {place: [] for place in positions}

        def made_ready(of: ReducedStructure) -> ReducedStructure:
            for place, said in outside.items():
                said.append(lacking(of.structure, place))
            there = [place for place, said in outside.items() if said[-1] is None]
            return of.at(there, anew=anew) if there else of

        ready = self.over(made_ready)
        for place, said in outside.items():
            if said and None not in said and (error := said[0]) is not None:
                raise BadInput(self.model.source, place, error.problem, error.remedy)
        if not anew:
            return ready
        model = replace(self.model, looked_at=tuple(dict.fromkeys((*self.model.positions, *positions))))
        return replace(ready, model=model)

    def over(self, reduced_anew: Callable[[ReducedStructure], ReducedStructure]) -> Self:
        """The same with structures over other coordinates, as `reduced_anew` makes those of each."""
        return replace(
            self, made=structure_tests.over(self.made, reduced_anew), tests=structure_tests.over(self.tests, reduced_anew)
        )

    def by(self, model: Model) -> Self:
        """The same data by a `model` of the same structure with other effects; spectra are not made again."""
        return replace(self, model=model)

    @cached_property
    def predictions(self) -> tuple[StructurePrediction, ...]:
        """Of campaigns and tests, by the model with its effects."""
        return self.by_effects(self.model.effects)

    def by_effects(self, effects: Sequence[Added]) -> tuple[StructurePrediction, ...]:
        """Of campaigns and tests, by the model with these `effects` instead of its own."""
        return tuple(one.with_effects(effects) for one in (*self.made, *self.tests))

    def facts(self, effects: Sequence[Added]) -> tuple[Fact, ...]:
        """What weights and periods say of a model with these `effects` alone."""
        return tuple(one.with_effects(effects) for one in self.said)

    def whole(self, effects: Sequence[Added] = ()) -> Problem:
        """All data by the model with these `effects` on top of its own."""
        every = (*self.model.effects, *effects)
        made = self.by_effects(every) if effects else self.predictions
        return Problem(made, self.facts(every))

    def problem(self, effects: Sequence[Added] = ()) -> Problem:
        """What fits see of it: fewer lines, and nothing that is held out."""
        thinned = self.whole(effects).thinned()
        return without(thinned, named(thinned, self.hold_out)) if self.hold_out else thinned

    def known(self) -> Problem:
        """All lines of what is not held out."""
        whole = self.whole()
        return without(whole, named(whole, self.hold_out)) if self.hold_out else whole

    def all_free(self, progress: Callable[[float], None] | None = None, *, begin: Fit | None = None) -> Fit:
        """The fit of all parameters of the model as it is, once; unconverged it makes any effect look decisive.

        Parameters
        ----------
        begin : that of the same model over other coordinates: the way leads straight down from there, if it ends as low
        """
        if not self._fits and begin is not None:
            with suppress(CheckFailed):
                there = nearby(self.problem(), FITTED, begin.by_name)
                self._fits.extend([there] if there.cost < begin.cost + INDISTINGUISHABLE_NATS else [])
        if not self._fits:
            self._fits.append(fit(self.problem(), FITTED, progress=progress))
        return self._fits[0]

    def evaluation(self, progress: Callable[[float], None] | None = None, *, configurations: bool = True) -> Evaluation:
        """The four errors of the model as it is and the fits behind them, of which `all_free` is one; made once, whoever asks.

        Those of `configurations` held out in turn are made when somebody asks for them.
        """
        tell, whole, kept = progress or (lambda share: None), self.whole(), self._evaluations
        several = configurations and not self.hold_out and len({one.measured.configuration for one in whole.predictions}) > 1
        if not kept or (several and kept[0].held_out_configurations is None):
            known = kept[0] if kept else self.all_free(lambda share: tell(0.5 * share))
            kept[:] = [evaluate(whole, hold_out=self.hold_out, baseline=known, configurations=several, progress=progress)]
        return kept[0] if configurations else kept[0].of_runs

    @property
    def there(self) -> tuple[There, ...]:
        """What effects can act on, one a data set."""
        return tuple(one.there for one in (*self.made, *self.tests))

    @property
    def words(self) -> Vocabulary:
        """What effects can be about: channels, and parts and places of what was tested."""
        of = vocabulary(self.model, self.campaigns)
        if self.tests:
            of = replace(of, places=None, parts=None, supports=None, joints=None, drives=None)
            of = replace(of, ways=AXES if not self.campaigns else of.ways)
        of = words_of(self.there, of)
        responses = tuple(dict.fromkeys(name for one in self.tests for name in one.measured.channels))
        recorded = dict.fromkeys(name for one in self.tests for name in one.there.channels or ())
        forces = tuple(name for name in recorded if name not in responses)
        return replace(of, accelerometers=(*(of.accelerometers or ()), *responses), forces=(*(of.forces or ()), *forces))

    @property
    def article(self) -> str:
        """Whose inertia is identified: the model's own article where it was tested, else the first that stood on the FMD."""
        tested = [one.tested.carried.standing.article for one in self.made]
        own = above_fmd(self.model.article)
        return own if own in tested else next((one for one in tested if one), "")

    @property
    def left_out(self) -> tuple[str, ...]:
        """Which lines of the data were left out, and why."""
        return tuple(text for one in self.made for text in one.tested.remarks)

    def on_several(self, effects: Sequence[Added]) -> Iterator[str]:
        """Which of `effects` act at coordinates that several of the articles have, and how to mean one: its places have names."""
        known = {one.measured.configuration: one.structure for one in (*self.made, *self.tests) if one.structure is not None}
        for effect in effects:
            for place in (one for one in effect.named.targets if one.startswith(AT)):
                have = [article for article, of in known.items() if place in of.nominal.places]
                if len(have) > 1:
                    named = "give the point a name under [fe_model.places] in the file of that one, and write the name"
                    which = f"several articles have the point of {effect.named.id}, which acts on {' and '.join(have)}"
                    yield f"{which}: to mean one, {named}"

    @property
    def history(self) -> HistoryPosition:
        """The model file and the ladder beside it, as they stand now.

        Raises
        ------
        BadInput : there is no such file.
        """
        return history_position(self.asked.path)
