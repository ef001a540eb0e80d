"""`Rung` and `Ladder`: every version of a model that was held against data, and how each came from the one before it.

A rung is a model on data: the whole text of the model file, the data that it was fitted to, and what came out. What a rung says
is never changed and no rung is taken away; undoing goes back to an older one, and adding there branches.
"""

import os
import os.path
from collections.abc import Iterator, Mapping, Sequence
from contextlib import contextmanager, suppress
from dataclasses import dataclass, field, replace
from datetime import UTC, datetime
from hashlib import file_digest, sha256
from importlib.metadata import version
from importlib.resources import files
from math import nan
from pathlib import Path
from platform import python_version
from types import MappingProxyType
from typing import Any

import numpy as np

from geometry import toml_file
from geometry.atomic import write_text, write_with
from geometry.errors import BadInput
from geometry.frames import Array, freeze
from identification import campaign_file
from identification.campaign import METHODS
from identification.quality import NORMAL_95, sizes
from validation.classical import files as classical_files
from validation.effects.effect import evidence_threshold
from validation.output import entry, from_json, json_text, to_json
from validation.reference.statement import COG, inertia_of

START, ADDED, EDITED, OTHER_DATA = CAUSES = ("start", "added", "edited by hand", "other data")
"""Why there is a rung: the model as it was first, an effect that was added, the user's own change of the file, the same model on
other data or with other runs held out."""

SHOWN = ("%", *3 * ("mm",), *6 * ("%",))
"""Units in which distances to the reference are told."""


@dataclass(frozen=True, kw_only=True)
class Source:
    """A campaign folder or a file of classical measurements.

    Attributes
    ----------
    path : from the folder of the ladder, with forward slashes
    digest : SHA-256 of what it holds
    """

    path: str
    digest: str = entry("sha256")


@dataclass(frozen=True, kw_only=True)
class Conditions:
    """What a rung was held against, and how: errors and evidence of two rungs compare only where these are the same.

    Attributes
    ----------
    data : campaigns and measurements
    hold_out : runs, campaigns and files that were never fitted, as the user named them; empty for the default
    band : (low, high) [Hz]; None for that of the campaigns
    method : of `identification.campaign.METHODS`
    """

    data: tuple[Source, ...] = ()
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = entry("band_hz", unit="Hz", default=None)
    method: str = METHODS[0]

    def same(self, other: "Conditions") -> bool:
        """Whether both are, in whatever order the data were named."""
        mine, its = (replace(one, data=tuple(sorted(one.data, key=lambda source: source.path))) for one in (self, other))
        return mine == its


BOTH_FITS = ("plain", "fitted")
"""Of identified and declared numbers alone, and of every tolerance."""


@dataclass(frozen=True, kw_only=True)
class Errors:
    """The four errors of a rung.

    Attributes
    ----------
    nominal, plain : per cent of the judged channels, on the data that were fitted
    held_out_nominal, held_out : the same on data that were not fitted; None where nothing was held out
    chi2, degrees_of_freedom : of the fit in which every tolerance is free
    tolerance_z2, tolerances : sum of squares of its tolerances in standard deviations, and how many there are
    expected_z2, largest_z : that sum where nothing is wrong, and |z| of the tolerance that moved farthest; None in ladders that
        were written before these were kept
    log_evidence : [nats], up to a constant of the data
    converged : whether both fits ended by themselves
    unfinished : those of `BOTH_FITS` that did not
    held_out_names : what was held out
    by_channel : plain error of every judged channel on the data that were fitted, their squares adding to its own
    by_fold : plain error on everything that was held out together
    """

    nominal: float = entry("nominal_percent", unit="%", null=nan)
    plain: float = entry("plain_percent", unit="%", null=nan)
    held_out_nominal: float | None = entry("heldout_nominal_percent", unit="%", default=None)
    held_out: float | None = entry("heldout_percent", unit="%", default=None)
    chi2: float = entry("fitted_chi2", null=nan)
    degrees_of_freedom: int = entry("fitted_degrees_of_freedom")
    tolerance_z2: float = entry(null=nan)
    tolerances: int
    log_evidence: float = entry("log_evidence_nats", unit="nats", null=nan)
    expected_z2: float | None = entry("tolerance_z2_expected", later=True, default=None)
    largest_z: float | None = entry(later=True, default=None)
    converged: bool = True
    unfinished: tuple[str, ...] = entry(rare=True, default=())
    held_out_names: tuple[str, ...] = entry("held_out", default=())
    by_channel: Mapping[str, float] = entry("plain_percent_by_channel", default_factory=lambda: MappingProxyType({}))
    by_fold: Mapping[str, float] = entry("heldout_percent_by_fold", later=True, default_factory=lambda: MappingProxyType({}))

    @property
    def chi2_per_dof(self) -> float:
        """The fitted error."""
        return self.chi2 / max(self.degrees_of_freedom, 1)

    @property
    def due_z2(self) -> float:
        """What its tolerances cost where nothing is wrong; at most one each."""
        return float(self.tolerances) if self.expected_z2 is None else self.expected_z2

    @property
    def z2_over_due(self) -> float:
        """What its tolerances cost, as a multiple of what they cost where nothing is wrong."""
        return self.tolerance_z2 / max(self.due_z2, 1.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """What the data say of one article when its ten parameters are free, beside what the model says.

    Attributes
    ----------
    article : what stands on the FMD
    values : (10,) identified: mass [kg], CoG [m] from the article's own origin, moments and products [kg m²] about the CoG
    deviation : (10,) standard deviations of these
    reference : (10,) of the model with its effects
    converged : whether the fit ended by itself
    """

    article: str
    values: Array = entry("identified", write=lambda of: ten_json(of), read=lambda table: _ten(table))
    deviation: Array = entry("sd", write=lambda of: ten_json(of), read=lambda table: _ten(table))
    reference: Array = entry(write=lambda of: ten_json(of), read=lambda table: _ten(table))
    converged: bool = True

    def __post_init__(self) -> None:
        freeze(self, values=(10,), deviation=(10,), reference=(10,))

    @property
    def half_width(self) -> Array:
        """(10,) half of each 95 % interval."""
        return NORMAL_95 * self.deviation

    @property
    def distance(self) -> Array:
        """(10,) from the reference to what was identified."""
        return self.values - self.reference

    @property
    def shown(self) -> Array:
        """(10,) distance as `SHOWN` tells it: CoG in mm, mass and moments in per cent, products in per cent of √(Θii Θjj)."""
        size = sizes(inertia_of(self.reference))
        size[COG] = 0.1  # [m] of which a millimetre is one per cent
        return 100 * self.distance / size

    @property
    def sigmas(self) -> Array:
        """(10,) distance in standard deviations; 0 where nothing is uncertain and nothing differs."""
        return self.distance / np.where(self.deviation > 0, self.deviation, np.inf)


@dataclass(frozen=True, kw_only=True)
class VersionSize:
    """One size of an effect in the model of a rung.

    Attributes
    ----------
    key : by which it is written; empty for the one that stands alone
    value, unit : SI
    deviation : standard deviation; None where it was not fitted
    """

    key: str
    value: float
    deviation: float | None = entry("sd", default=None)
    unit: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Version:
    """One rung.

    Attributes
    ----------
    number : its place in the ladder, from 0
    parent : the rung it came from; None for the first
    cause : of `CAUSES`
    effect : id of the effect that was added; empty where none was
    effects : by id the sizes of every effect of the model; none of one that is there or not
    model : text of the model file
    conditions : what it was held against, and how
    errors : the four errors; None of a model that was put aside before anybody held it against data
    gain : evidence [nats] over the parent; None where both do not stand on the same data
    bodies : identified inertia of every article
    plain_offsets, fitted_offsets : where both fits ended, by parameter: the next rung begins there
    verdict : in sentences
    when : ISO 8601, UTC
    versions : of the programs
    settings : with which it was made
    """

    number: int
    parent: int | None
    cause: str
    effect: str = entry(null="", default="")
    effects: Mapping[str, tuple[VersionSize, ...]] = field(default_factory=lambda: MappingProxyType({}))
    errors: Errors | None = entry(read=lambda table: _errors(table), default=None)
    gain: float | None = entry("evidence_gain_nats", unit="nats", default=None)
    verdict: tuple[str, ...] = ()
    bodies: tuple[Body, ...] = entry("inertia", default=())
    conditions: Conditions = field(default_factory=Conditions)
    when: str = ""
    versions: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    plain_offsets: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    fitted_offsets: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    model: str = entry(write=lambda text: text.split("\n"), read=lambda lines: _lines(lines))

    @property
    def title(self) -> str:
        """What distinguishes it from its parent, in a few words."""
        return self.effect or {START: "the model at first"}.get(self.cause, self.cause)

    @property
    def asked_gain(self) -> float:
        """[nats] that its effect must bring."""
        return evidence_threshold(self.effect.partition(":")[0])

    def stands_on(self, conditions: Conditions) -> bool:
        """Whether it was held against these."""
        return self.errors is not None and self.conditions.same(conditions)

    def is_same(self, rung: "Version") -> bool:
        """Whether another process made it as `rung`: the same step to the same model, on the same data, by the same programs."""
        step = ("parent", "cause", "effect", "model", "versions", "verdict")
        alike = all(getattr(self, name) == getattr(rung, name) for name in step)
        return alike and self.errors is not None and rung.stands_on(self.conditions)

    def waits_for(self, rung: "Version") -> bool:
        """Whether it is `rung` without its figures."""
        return self.errors is None and self.model == rung.model and self.parent == rung.parent


@dataclass(frozen=True, eq=False, kw_only=True)
class Ladder:
    """All rungs of one model file.

    Attributes
    ----------
    rungs : in the order in which they were made; each has its number
    current : number of the rung that was written into the model file last; None before there is one
    """

    rungs: tuple[Version, ...] = ()
    current: int | None = None

    def rung(self, number: int) -> Version:
        """That with `number`."""
        return self.rungs[number]

    def children(self, number: int | None) -> tuple[Version, ...]:
        """Those that came from it, in the order in which they were made; None asks for those that came from none."""
        return tuple(one for one in self.rungs if one.parent == number)

    def path(self, number: int) -> tuple[Version, ...]:
        """From the first rung to that with `number`."""
        found = [self.rung(number)]
        while (parent := found[-1].parent) is not None:
            found.append(self.rung(parent))
        return tuple(reversed(found))

    def of_text(self, model: str) -> Version | None:
        """The rung whose model has this very text: the current one where several do, else the latest; None without any."""
        alike = [one for one in self.rungs if one.model == model]
        return next((one for one in alike if one.number == self.current), alike[-1] if alike else None)

    def tree(self) -> tuple[tuple[str, Version], ...]:
        """Every rung behind the branches that lead to it, drawn with lines: parents before their children."""
        return tuple(self._below(None, ""))

    def _below(self, number: int | None, trunk: str) -> list[tuple[str, Version]]:
        """A child alone continues the line of its parent; only branches are set in."""
        found: list[tuple[str, Version]] = []
        below = self.children(number)
        for place, one in enumerate(below, start=1):
            last = place == len(below)
            branch, on = ("", "") if len(below) == 1 else ("└─ ", "   ") if last else ("├─ ", "│  ")
            found += [(trunk + branch, one), *self._below(one.number, trunk + on)]
        return found


# The ladder beside a model file: ``model.toml`` has its rungs in ``model.ladder.json``.
#
# One JSON object, written whole or not at all, meant to be read by people too: units stand in the keys, the model of each rung
# is a list of lines. Every rung keeps the whole model, so that going back gives the very bytes. What cannot be read is refused,
# and nothing is ever written over it.
#
# ``format = 1``. Other programs may rely on
#
#     {"format": 1, "kind": "massline ladder", "model": NAME, "current": NUMBER,
#      "rungs": [{"number", "parent": NUMBER|null, "cause", "effect": ID|null,
#                 "effects": {ID: [{"key", "value", "sd": number|null, "unit"}]},
#                 "errors": {"nominal_percent", "plain_percent", "heldout_nominal_percent", "heldout_percent", "fitted_chi2",
#                            "fitted_degrees_of_freedom", "tolerance_z2", "tolerances", "log_evidence_nats", "converged",
#                            "unfinished": ["plain", "fitted"], "tolerance_z2_expected": number|null, "largest_z": number|null,
#                            "held_out": [NAME], "plain_percent_by_channel": {CHANNEL: number},
#                            "heldout_percent_by_fold": {NAME: number}} or null; what was not held out is null,
#                 "evidence_gain_nats": number|null, "verdict": [TEXT],
#                 "inertia": [{"article", "identified": TEN, "sd": TEN, "reference": TEN, "converged"}],
#                 "conditions": {"data": [{"path", "sha256"}], "hold_out": [NAME], "band_hz": [lo, hi]|null, "method"},
#                 "when", "versions": {}, "settings": {},
#                 "plain_offsets": {PARAMETER: number}, "fitted_offsets": {PARAMETER: number}, "model": [LINE]}]}
#     TEN    {"mass_kg", "cog_mm": [x, y, z], "moi_cog_kgm2": [xx, yy, zz], "poi_cog_kgm2": [xy, xz, yz]}
#
# The CoG is given from the article's own origin, moments and products about the CoG.


FORMAT = 1
KIND = "massline ladder"
ENDING = ".ladder.json"

_TEN = {
    "mass_kg": (slice(0, 1), 1.0),
    "cog_mm": (slice(1, 4), 1e3),
    "moi_cog_kgm2": (slice(4, 7), 1.0),
    "poi_cog_kgm2": (slice(7, 10), 1.0),
}
"""Where ten values stand in a `Body`, and what they are multiplied by."""


def path_beside(model: Path) -> Path:
    """The ladder of the file `model`."""
    return model.parent / f"{model.stem}{ENDING}"


def read(path: Path) -> Ladder:
    """The ladder in the file `path`.

    Raises
    ------
    BadInput : no such file; no JSON, no ladder, one of a newer program, or one that contradicts itself.
    OSError : the file cannot be read.
    """
    source = str(path)
    table = toml_file.read(path, remedy="`massline add` makes one beside a model")
    if table.get("kind") != KIND or not isinstance(table.get("rungs"), list):
        raise _refused(source, "it is no ladder of massline")
    found = table.get("format")
    if toml_file.is_whole(found) and found > FORMAT:
        problem = f"its format is {found}, written by a newer massline; this one reads {FORMAT}"
        raise BadInput(source, "format", problem, "Use that massline. Nothing was changed")
    if found != FORMAT or isinstance(found, bool):
        raise _refused(source, f"its format must be {FORMAT}, found {found!r}")
    try:
        rungs = tuple(from_json(Version, one) for one in table["rungs"])
        current = table["current"]
        if current is not None and (not toml_file.is_whole(current)):
            raise TypeError(f"a whole number is expected, found {current!r:.60}")
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        if isinstance(error, BadInput):
            raise
        what = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise _refused(source, f"it is damaged: {what}") from None
    # Numbers that are no places, parents that did not come before, causes that nobody knows
    for place, one in enumerate(rungs):
        if one.number != place:
            raise _refused(source, f"it is damaged: rung {place} says that it is {one.number}")
        if one.parent is not None and not 0 <= one.parent < place:
            raise _refused(source, f"it is damaged: rung {place} comes from {one.parent}, which was not there before it")
        if one.cause not in CAUSES:
            raise _refused(source, f"it is damaged: rung {place} has the unknown cause {one.cause!r}")
    if current is not None and not 0 <= current < len(rungs):
        raise _refused(source, f"it is damaged: its current rung is {current} of {len(rungs)}")
    return Ladder(rungs=rungs, current=current)


def write(path: Path, ladder: Ladder, model: str) -> None:
    """Write `ladder` to `path`, beside the file called `model`.

    Raises
    ------
    OSError : it cannot be written.
    """
    write_text(path, text(ladder, model))


def text(ladder: Ladder, model: str) -> str:
    """`ladder` as the file holds it."""
    whole = {"format": FORMAT, "kind": KIND, "model": model, "current": ladder.current, "rungs": to_json(ladder.rungs)}
    return json_text(whole) + "\n"


def ten_json(values: Array) -> dict[str, Any]:
    """TEN of (10,) values in the order of a `Body`."""
    listed = {key: (scale * values[place]).tolist() for key, (place, scale) in _TEN.items()}
    return listed | {"mass_kg": listed["mass_kg"][0]}


def _refused(source: str, problem: str) -> BadInput:
    remedy = "Put back a copy that is whole, or move the file away to begin a new ladder; nothing was changed"
    return BadInput(source, "", problem, remedy)


def _errors(table: Mapping[str, Any] | None) -> Errors | None:
    if table is None:
        return None
    errors = from_json(Errors, table)
    # What is negative of roots of squares and of sums of them is refused
    for key in ("nominal_percent", "plain_percent", "heldout_nominal_percent", "heldout_percent", "fitted_chi2", "tolerance_z2"):
        if (value := to_json(errors)[key] or 0.0) < 0:
            raise ValueError(f"{key} is negative, {value:g}")
    return errors


def _ten(table: Mapping[str, Any]) -> Array:
    return np.concatenate([np.ravel(np.asarray(table[key], dtype=np.float64)) / scale for key, (_, scale) in _TEN.items()])


def _lines(value: Any) -> str:
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise TypeError(f"a list of texts is expected, found {value!r:.60}")
    return "\n".join(value)


# One process at a time changes a ladder: what it reads is what it writes on.
#
# The lock is the operating system's, on the folder of the model, so that no file is left behind and a process that dies holds
# nothing. Where folders cannot be locked (Windows, some network drives), the ladder is still read again right before it is
# written.


@contextmanager
def locked(path: Path) -> Iterator[None]:
    """Alone with the file `path` and what lies beside it, for a few milliseconds; others wait. Not to be asked for twice."""
    try:
        folder = os.open(path.resolve().parent, os.O_RDONLY)
    except OSError:  # a folder that cannot be opened is reported by whoever reads or writes in it
        yield
        return
    try:
        with suppress(ImportError, OSError):
            from fcntl import LOCK_EX, flock

            flock(folder, LOCK_EX)
        yield
    finally:
        os.close(folder)


# Up, down and aside on a ladder: which rung a model file stands on, keeping one, and going to another.
#
# A model file and its ladder are two files, and no system writes two at once. So the ladder does not say where the model stands:
# the text of the model does. It stands on the rung with that very text, and only among rungs of the same text the ladder's own
# word counts. Wherever an interruption falls, both agree: a rung is in the ladder before the model file shows it.


PROGRAMS = ("massline", "numpy", "scipy")
"""Whose versions stand in a rung."""


@dataclass(frozen=True, eq=False, kw_only=True)
class HistoryPosition:
    """A model file and its ladder.

    Attributes
    ----------
    path : the model file
    text : what it holds
    ladder : beside it; without rungs where there is none yet
    rung : on which it stands; None before there is one, and where the file was edited by hand since
    """

    path: Path
    text: str
    ladder: Ladder
    rung: Version | None

    @property
    def edited(self) -> bool:
        """Whether somebody changed the file since its last rung."""
        return self.rung is None and bool(self.ladder.rungs)

    @property
    def below(self) -> Version | None:
        """The rung on which it stands, or from which it was edited."""
        if self.rung is not None or self.ladder.current is None:
            return self.rung
        return self.ladder.rung(self.ladder.current)


def conditions(at: HistoryPosition) -> Iterator[str]:
    """What is odd about where the model stands."""
    if at.edited and at.below is not None:
        yield f"{at.path.name} was edited by hand since rung {at.below.number}; the next `massline add` makes a rung of it."
    for one in at.ladder.rungs:
        if one.errors is None:
            yield f"Rung {one.number} has no figures: it was put aside before it was held against data, or no fit converged."


def history_position(path: Path) -> HistoryPosition:
    """Where the model file `path` stands.

    Raises
    ------
    BadInput : there is no such file, it is no text, or its ladder cannot be read (see `validation.history.history.read`).
    OSError : one of them cannot be read.
    """
    text, beside = read_text(path), path_beside(path)
    ladder = read(beside) if beside.exists() else Ladder()
    return HistoryPosition(path=path, text=text, ladder=ladder, rung=ladder.of_text(text))


def read_text(path: Path) -> str:
    """What the file `path` holds, ends of lines as they are.

    Raises
    ------
    BadInput : no such file, a folder, or not UTF-8.
    """
    remedy = "Name a model file; `massline model ARTICLE` writes one to start from"
    if not path.is_file():
        raise BadInput(str(path), "", "this is a folder" if path.is_dir() else "there is no such file", remedy)
    try:
        return path.read_bytes().decode("utf-8")
    except UnicodeDecodeError:
        raise BadInput(str(path), "", "it is not text in UTF-8", remedy) from None


def next_rung(at: HistoryPosition) -> Version:
    """The rung, still without figures, that the model of `at` is as it stands: the first, or one that was edited by hand."""
    below = at.below
    if at.rung is not None and at.rung.errors is None:
        return at.rung
    parent = None if below is None else below.number
    return Version(number=len(at.ladder.rungs), parent=parent, cause=EDITED if at.edited else START, model=at.text)


def kept(at: HistoryPosition, rung: Version) -> HistoryPosition:
    """`at` with `rung` on its ladder, written at once, and standing on it where it is the model as it is; no other file changes.

    A rung that waits for its figures gets them, and one that is there already is not made twice. Whatever other rungs were made
    meanwhile stay, and `rung` is numbered after them.

    Raises
    ------
    BadInput, OSError : see `standing`; the ladder cannot be written.
    """
    with locked(at.path):
        return _kept(at, rung)[0]


def _kept(at: HistoryPosition, rung: Version) -> tuple[HistoryPosition, int]:
    """As `kept`, the ladder being ours alone, and the number of the rung."""
    now = history_position(at.path).ladder
    if not rung.when:
        versions = {"python": python_version(), **{name: version(name) for name in PROGRAMS}}
        rung = replace(rung, when=datetime.now(UTC).isoformat(timespec="seconds"), versions=versions)
    # In the place that waits for it, or as it is there already, or behind all others
    waiting = rung.number < len(now.rungs) and now.rung(rung.number).waits_for(rung)
    there = next((one for one in now.rungs if one.is_same(rung)), None)
    one = rung if waiting else there or replace(rung, number=len(now.rungs))
    rungs = [*now.rungs]
    rungs[one.number : one.number + 1] = [one]
    here = one.model == at.text
    ladder = Ladder(rungs=tuple(rungs), current=one.number if here or now.current is None else now.current)
    write(path_beside(at.path), ladder, at.path.name)
    return replace(at, ladder=ladder, rung=one if here else at.rung), one.number


def climbed(at: HistoryPosition, rung: Version) -> HistoryPosition:
    """`at` on the new `rung`: on its ladder first, then in its model file.

    A model file that somebody edited since `at` was read is left alone; the rung is kept all the same, to go to.

    Raises
    ------
    BadInput, OSError : see `kept`.
    """
    with locked(at.path):
        there, number = _kept(at, rung)
        untouched = read_text(at.path) == at.text
        return _gone_to(there, number) if untouched else history_position(at.path)


def gone_to(at: HistoryPosition, number: int) -> HistoryPosition:
    """`at` on the rung with `number`, its model file byte by byte; a text that was on no rung becomes one first.

    Raises
    ------
    BadInput : there is no such rung, or no ladder.
    OSError : a file cannot be written.
    """
    with locked(at.path):
        return _gone_to(at, number)


def _gone_to(at: HistoryPosition, number: int) -> HistoryPosition:
    """As `gone_to`, the ladder being ours alone; rungs that others made since `at` was read stay."""
    _require_rungs(at)
    at = replace(at, ladder=history_position(at.path).ladder)
    if not 0 <= number < len(at.ladder.rungs):
        numbers = f"0 to {len(at.ladder.rungs) - 1}" if len(at.ladder.rungs) > 1 else "0"
        raise BadInput(str(path_beside(at.path)), "", f"there is no rung {number}", f"It has {numbers}")
    if at.edited:
        at, _ = _kept(at, next_rung(at))
    ladder = replace(at.ladder, current=number)
    write(path_beside(at.path), ladder, at.path.name)
    rung = ladder.rung(number)
    if rung.model != at.text:
        write_with(at.path, lambda temporary: temporary.write_bytes(rung.model.encode("utf-8")))
    return replace(at, ladder=ladder, text=rung.model, rung=rung)


def undone(at: HistoryPosition) -> HistoryPosition:
    """`at` on the parent of its rung; one that was edited by hand, on the rung that it was edited from.

    Raises
    ------
    BadInput : there is no ladder, or nothing below.
    OSError : a file cannot be written.
    """
    _require_rungs(at)
    if at.rung is None:
        return gone_to(at, at.below.number if at.below is not None else 0)
    if at.rung.parent is None:
        problem = f"it stands on rung {at.rung.number}, the first; there is nothing to undo"
        raise BadInput(str(at.path), "", problem, "`massline ladder MODEL --go RUNG` goes to any other")
    return gone_to(at, at.rung.parent)


def _require_rungs(at: HistoryPosition) -> None:
    if not at.ladder.rungs:
        problem = f"it has no ladder: there is no {path_beside(at.path).name} beside it"
        raise BadInput(str(at.path), "", problem, "`massline add MODEL EFFECT DATA ...` makes one")


# A model file has an effect of the user's own, and nobody said where it is: its ladder remembers the folder.


OPTION = "--effects-from"


@contextmanager
def reminded(path: Path) -> Iterator[None]:
    """Refusals of unknown effects in the model file `path` name the folders from which its ladder had effects.

    Raises
    ------
    BadInput : as within, its remedy changed where the ladder knows one.
    """
    try:
        yield
    except BadInput as error:
        rungs: tuple[Version, ...] = ()
        with suppress(BadInput, OSError):  # a ladder that cannot be read reminds of nothing
            rungs = read(path_beside(path)).rungs
        stated = [one.settings.get("effects_from") for one in rungs]
        folders = dict.fromkeys(str(folder) for some in stated if isinstance(some, list) for folder in some)
        if OPTION not in error.remedy or not folders:
            raise
        remedy = f"Say {' '.join(f'{OPTION} {folder}' for folder in folders)}, as when it was added"
        raise BadInput(error.source, error.field, error.problem, remedy) from None


# Where a ladder's data lie and whether they are what they were: paths from its folder, and digests of what they hold.


def sources(paths: Sequence[str], folder: Path) -> tuple[Source, ...]:
    """The data at `paths`, seen from the `folder` of a ladder.

    Raises
    ------
    BadInput : a folder that is no campaign.
    OSError : a file cannot be read.
    """
    found = []
    for path in paths:
        # Seen from the folder, with forward slashes; the name of shipped data stays one
        beside = Path(os.path.relpath(Path(path).resolve(), folder.resolve())).as_posix() if Path(path).exists() else path
        found.append(Source(path=beside, digest=digest(path)))
    return tuple(found)


def paths(known: Conditions, folder: Path, ladder: str) -> tuple[str, ...]:
    """Where the data of a rung are now, `folder` being that of the `ladder`.

    Raises
    ------
    BadInput : one of them is not there any more.
    """
    found = []
    for one in known.data:
        if (folder / one.path).exists():
            found.append(os.path.normpath(folder / one.path))
        elif one.path.removesuffix(".toml") in classical_files.shipped():
            found.append(one.path)
        else:
            problem = f"its rung stands on {one.path}, which is not there any more"
            raise BadInput(ladder, "data", problem, "Put it back, or name the data again: MODEL EFFECT DATA ...")
    return tuple(found)


def changed(known: Conditions, now: Conditions) -> tuple[str, ...]:
    """Sentences about data of `known` that hold something else `now`."""
    digests = {one.path: one.digest for one in known.data}
    return tuple(
        f"{one.path} is not what it was when the ladder met it: its digest changed. The model is held against it anew"
        for one in now.data
        if digests.get(one.path, one.digest) != one.digest
    )


def digest(path: str) -> str:
    """SHA-256 of a file, or of the description and the signals of a campaign.

    Raises
    ------
    BadInput : a folder that is no campaign.
    OSError : a file cannot be read.
    """
    if not Path(path).is_dir():
        if Path(path).exists():
            return _of_file(Path(path))
        held = files("validation.reference").joinpath("in_print", f"{path.removesuffix('.toml')}.toml")
        return sha256(held.read_bytes()).hexdigest()
    described = campaign_file.read_description(path)
    names = sorted({campaign_file.NAME, *(run.file for run in described.runs)})
    whole = sha256()
    for name in names:
        if (Path(path) / name).is_file():
            whole.update(f"{name}\0{_of_file(Path(path) / name)}\n".encode())
    return whole.hexdigest()


def _of_file(path: Path) -> str:
    with path.open("rb") as stream:
        return file_digest(stream, "sha256").hexdigest()
