"""How a session keeps what it has: results as arrays and JSON, never a pickle, and its model file in a folder of its own."""

import json
import os.path
import re
import shutil
from collections.abc import Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass, field, fields, is_dataclass, replace
from pathlib import Path
from types import NoneType, UnionType
from typing import Any, TypeVar, get_args, get_origin, get_type_hints

import numpy as np

from geometry import toml_file
from geometry.atomic import write_with
from geometry.errors import BadInput
from geometry.frames import Array
from validation.compare.correlation import ModalCorrelation, NamedMode
from validation.compare.maps import Map
from validation.estimation.problem import Evaluation, Measured
from validation.history import history
from validation.history.history import Ladder, Source, read_text
from validation.model import model_file
from validation.prediction.dynamic_mass import BaseDrive

# A frozen dataclass as one file: its arrays by their place in it, such as ``.maps.0.frequency``, and all else as one JSON text.

_Of = TypeVar("_Of")

WORDS = "words"


def write(path: Path, of: Any) -> None:
    """Write `of` to the file `path` (.npz), whole or not at all.

    Raises
    ------
    OSError : it cannot be written.
    AttributeError : something in it is neither an array nor known to JSON.
    """
    arrays: dict[str, Any] = {}

    def parted(one: Any, place: str) -> Any:
        """`one` as JSON has it, without the arrays, which go where they belong."""
        if isinstance(one, np.ndarray):
            arrays[place] = one
            return None
        if is_dataclass(one):
            return {each.name: parted(getattr(one, each.name), f"{place}.{each.name}") for each in fields(one) if each.init}
        if isinstance(one, Mapping):
            return {name: parted(each, f"{place}.{name}") for name, each in one.items()}
        if isinstance(one, tuple | list):
            return [parted(each, f"{place}.{k}") for k, each in enumerate(one)]
        return one

    text = json.dumps(parted(of, ""), default=lambda one: one.item())  # a number of NumPy
    arrays[WORDS] = np.frombuffer(text.encode(), dtype=np.uint8)
    write_with(path, lambda temporary: np.savez(temporary, allow_pickle=False, **arrays))


def words(path: Path) -> Any:
    """What the file has besides arrays, as JSON has it; quick.

    Raises
    ------
    OSError, EOFError, ValueError, KeyError, BadZipFile, zlib.error : it is not there, or not whole.
    """
    with path.open("rb") as opened, np.load(opened, allow_pickle=False) as held:
        return json.loads(held[WORDS].tobytes())


def read(kind: type[_Of], path: Path) -> _Of:
    """What `write` wrote, of that `kind`.

    Raises
    ------
    OSError, EOFError, ValueError, KeyError, TypeError, BadZipFile, zlib.error : as `words`, or it is of another kind or version.
    """
    with path.open("rb") as opened, np.load(opened, allow_pickle=False) as held:

        def joined(kind: Any, said: Any, place: str) -> Any:
            inside = get_args(kind)
            if place in held:
                return held[place]
            if get_origin(kind) is UnionType:
                return None if said is None else joined(next(one for one in inside if one is not NoneType), said, place)
            if is_dataclass(kind):
                hints = get_type_hints(kind)
                return kind(**{name: joined(hints[name], one, f"{place}.{name}") for name, one in said.items()})  # type: ignore[operator]
            if get_origin(kind) is tuple:
                kinds = inside[:1] * len(said) if inside[-1] is Ellipsis else inside
                return tuple(joined(*both, f"{place}.{k}") for k, both in enumerate(zip(kinds, said, strict=True)))
            if get_origin(kind) is Mapping:
                return {name: joined(inside[1], one, f"{place}.{name}") for name, one in said.items()}
            return said

        found: _Of = joined(kind, json.loads(held[WORDS].tobytes()), "")
        return found


@dataclass(frozen=True, eq=False, kw_only=True)
class KeptSpectra:
    """Of one campaign what its recordings are needed for: all of a `TestedCampaign` that no model changes.

    `source` : its folder
    """

    source: str
    warnings: tuple[str, ...]
    measured: Measured
    drives: tuple[BaseDrive, ...]
    per_rms: Array
    method: str
    remarks: tuple[str, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class KeptSeries:
    """Spectra of all campaigns of a session, and by `stamp` what they were made from."""

    stamp: Any
    campaigns: tuple[KeptSpectra, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class KeptFits:
    """Of a diagnosis what its JSON has in part: the errors before and after with the fits behind them."""

    before: Evaluation
    after: Evaluation


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

    maps: tuple[Map, ...]
    modes: tuple[tuple[NamedMode, ...], ...]
    offsets: Mapping[str, float]
    loads: tuple[Mapping[str, tuple[int, ...]], ...]
    errors: tuple[Mapping[str, Any], ...] = ()
    tables: tuple[ModalCorrelation, ...] = ()
    frac: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    summary: Mapping[str, Any] = field(default_factory=dict)

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
        return dict(zip(self.campaigns, self.maps, strict=True))[campaign]

    def modes_of(self, campaign: str) -> tuple[NamedMode, ...]:
        """Those of the article of `campaign`; none of an FMD alone or of a rigid one.

        Raises
        ------
        KeyError : there is no campaign of that name.
        """
        return dict(zip(self.campaigns, self.modes, strict=True))[campaign]


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
        raise BadInput(str(model), "structure.own", problem, 'Write "article" = "path" on lines there')
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
