"""What a window opens: a built-in example, or files that a browser handed over; and everything that is wrong with them."""

import os
import re
import shutil
import tempfile
from collections.abc import Callable, Iterator, Sequence
from dataclasses import asdict, dataclass
from functools import partial
from hashlib import sha256
from importlib.metadata import version
from pathlib import Path

from geometry import cache, toml_file
from geometry.atomic import write_text, write_with
from geometry.errors import BadInput
from identification import campaign_file, test_file
from validation.app.session import GIVEN
from validation.classical import files as classical_files
from validation.effects import catalogue
from validation.identify.check import summary
from validation.identify.request import REDUCED
from validation.model import model_file
from validation.model.model import Model
from validation.output import json_text
from validation.study import TRUTH, Progress, is_test, only_files, read_data
from validation.virtual_test import simulate

# The built-in examples: virtual tests with an effect that their model does not know, simulated at first use by the very functions
# behind `massline simulate` and `massline model`, and kept in the user's cache. Nothing is shipped, and the folder may be deleted
# at any time. Whatever one of them is made of is in the name of its folder, so that another version of massline makes its own.


MODEL = "model.toml"


@dataclass(frozen=True, kw_only=True)
class Example:
    """A story to begin with.

    Attributes
    ----------
    name : by which it is picked
    title : in a few words
    words : what there is to see, a sentence or two; the effect that is hidden is not said
    articles : stacks that stand on the shaker, one a campaign; the last one is what the model is of
    effects : that are hidden, as on a command line
    octaves_per_minute, seed, driven : of the sweeps; the last one [Hz]
    tolerances, noise : factors on those of an ordinary laboratory
    rate : of the records [Hz]
    band : [Hz] that is compared; None for all that is driven
    hold_out : runs that no fit sees
    """

    name: str
    title: str
    words: str
    articles: tuple[str, ...]
    effects: tuple[str, ...]
    octaves_per_minute: float
    seed: int = 3
    driven: tuple[float, float] = (4.0, 32.0)
    tolerances: str = "1"
    noise: str = "1"
    rate: float = 564.0
    band: tuple[float, float] | None = None
    hold_out: tuple[str, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Series:
    """A model and data that belong together: what `validation.app.session.begun` takes.

    Attributes
    ----------
    model : path of the model file
    data : campaign folders and measurement files
    hold_out : runs that are predicted, never fitted
    band : [Hz] that is compared; None for all that is driven
    title : in a few words
    """

    model: str
    data: tuple[str, ...]
    hold_out: tuple[str, ...] = ()
    band: tuple[float, float] | None = None
    title: str = ""


EXAMPLES = (
    Example(
        name="block",
        title="A block with a hidden effect",
        words="Disc and Cuboid on the force measurement device, quick sweeps, compared from 8 to 16 Hz. Something is wrong with "
        "the measurement, and no model of the block will ever explain it. The z-sweep is used only for checking.",
        articles=("fmd+disc+cuboid",),
        effects=("force-gain:fmd-z2=0.08",),
        octaves_per_minute=60.0,
        seed=0,
        band=(8.0, 16.0),
        hold_out=("z",),
    ),
    Example(
        name="mast",
        title="A mast with one blade and a hidden effect",
        words="Clumod with one blade, and disc and Cuboid for a tare: two campaigns that share their sensors. Resonances and the "
        "mass line both look wrong; tolerances alone nearly explain it, if they move absurdly far.",
        articles=("fmd+disc+cuboid", "fmd+clumod-1"),
        effects=("force-gain:fmd-z2=0.15",),
        octaves_per_minute=16.0,
    ),
)


def made(name: str, progress: Progress | None = None) -> Series:
    """The files of the example `name`, made now where they are not there yet; that takes from seconds to a minute.

    Raises
    ------
    BadInput : no example is called so, with the nearest; there is no folder for a cache.
    OSError : the cache cannot be written.
    """
    of = next((one for one in EXAMPLES if one.name == name), None)
    if of is None:
        known = [one.name for one in EXAMPLES]
        remedy = f"{toml_file.nearest(name, known)}Known are {', '.join(known)}"
        raise BadInput("example", name, "no example is called so", remedy)
    there = cache.folder()
    if there is None:
        problem = "there is no folder in which it could be kept"
        raise BadInput("example", of.name, problem, "Name a folder in the environment variable MASSLINE_CACHE")
    made_of = json_text({"version": version("massline"), **asdict(of)})
    folder = there / "examples" / f"{of.name}-{sha256(made_of.encode()).hexdigest()[:12]}"
    if not folder.exists():
        # All of it in a folder of its own, then in place; of two that make it at once the first one stays
        folder.parent.mkdir(parents=True, exist_ok=True)
        temporary = Path(tempfile.mkdtemp(prefix=f".{of.name}-", dir=folder.parent))
        try:
            _simulate(of, temporary, progress or (lambda what, share: None))
            temporary.chmod(0o755)
            temporary.rename(folder)
        except OSError:
            if not folder.exists():
                raise
        finally:
            shutil.rmtree(temporary, ignore_errors=True)
    campaigns = tuple(str(folder / one) for one in of.articles)
    return Series(model=str(folder / MODEL), data=campaigns, hold_out=of.hold_out, band=of.band, title=of.title)


def _simulate(of: Example, folder: Path, progress: Progress) -> None:
    """Fill `folder` as `massline simulate` and `massline model` would."""
    asked = simulate.question(
        articles=of.articles,
        out=folder,
        effects=of.effects,
        seed=of.seed,
        levels="1",
        sealed=None,
        pattern="sweep",
        runs=None,
        band=of.driven,
        octaves_per_minute=of.octaves_per_minute,
        cross=0.03,
        tolerances=of.tolerances,
        noise=of.noise,
        mains="1",
        model="beam",
        damping_ratio=None,
        rate=of.rate,
        form="h5",
        units=(),
        settings=(),
    )
    for k, plan in enumerate(asked.plans):

        def tell(share: float, k: int = k) -> None:
            progress("simulating the example", (k + share) / len(asked.plans))

        test = simulate.simulate(plan, tell)
        truth = folder / "truth" / f"{plan.article}.json"
        simulate.write(folder / plan.article, truth, test.truth, partial(campaign_file.write, campaign=test.campaign))
    write_text(folder / MODEL, model_file.text(model_file.draft(of.articles[-1], folder / MODEL)))


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
    field: str = ""
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
    known = _tried(found, lambda: model_file.read(model)) if model else None
    for path in data:
        if Path(path).is_dir():  # by what `massline check` finds
            try:
                seen = summary(path, progress=partial(tell, f"reading {Path(path).name}"))
            except OSError as error:
                found.append(_of_system(error, path))
                continue
            found += [*map(of_error, seen.problems), *(Fault(file=path, problem=text, grave=False) for text in seen.warnings)]
        else:
            _tried(found, partial(test_file.all_in, path, "") if is_test(path) else partial(_reduce, path))
    if not any(one.grave for one in found) and isinstance(known, Model) and (data or known.tests):
        # What contradicts what, of files that are sound by themselves
        _tried(found, lambda: read_data(data, known))
    unique = tuple(dict.fromkeys(found))
    return (*(one for one in unique if one.grave), *(one for one in unique if not one.grave))


def _reduce(path: str) -> None:
    """Look at a measurement file as `massline weigh`, `cog` and `pendulum` do: the reduction alone sees every field.

    Raises
    ------
    BadInput : there is none, or it is none.
    """
    if not only_files((path,)):
        raise BadInput(path, "", "there is no such file or folder", "Name campaign folders, and weigh, cog and pendulum files")
    file = classical_files.read(path, tuple(REDUCED))
    REDUCED[file.text("kind")](file)


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
    return Fault(file=str(error.filename or path), problem=problem, remedy="Check its name and permissions")


# Files that a browser handed over, put into the session's folder: whatever they are called, they go nowhere else.
#
# Names come from a stranger. They are taken apart at ``/`` and ``\``; what climbs, is absolute, reserved, too long or too deep,
# or holds characters that no file name needs, is refused in words. Files that a system hides beside those of the user
# (``.DS_Store``, ``.git``, ``.~lock``, ``Thumbs.db``) are passed over, in words too. Nothing is renamed in silence: a campaign
# finds its signals by their names. What is left keeps its folders, so that a dropped series is one. A file that is handed over
# again takes the place of the one that was.


SOURCE = "the files that were handed over"
"""What a fault of theirs is about."""

LARGEST = 2 * 2**30
"""Bytes of all files of a session together."""

MOST = 2000
"""Files."""

LONGEST, DEEPEST = 120, 6
"""Characters of a name, folders above a file."""

FORBIDDEN = re.compile(r'[\x00-\x1f\x7f<>:"|?*]')
RESERVED = re.compile(r"(con|prn|aux|nul|com\d|lpt\d)(\..*)?", re.IGNORECASE)
"""What no Windows folder can hold, so that a session can be copied anywhere."""

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

    @property
    def size(self) -> int:
        """Bytes."""
        return len(self.content) if isinstance(self.content, bytes) else self.content.stat().st_size

    def write(self, path: Path) -> None:
        """Into the file `path`, whole or not at all."""
        content = self.content
        if isinstance(content, bytes):
            write_with(path, lambda temporary: temporary.write_bytes(content))
        else:
            write_with(path, lambda temporary: shutil.copyfile(content, temporary))


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
    """`files` written below `folder` (that of the session to be), in ``given/``; those that are refused are told and left out.

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
    held = [Path(where) / name for where, _, names in os.walk(given) for name in names]
    before = {_folded(path.relative_to(given).parts): path for path in held}
    room, faults = limit - sum(path.stat().st_size for path in held), []
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
            folded = _folded(parts)
            # A second file of a name, capitals or not, and one where a folder is
            others = taken | (before.keys() - {folded})
            clash = folded in others or any(folded[:k] in others for k in range(1, len(folded)))
            if clash or any(other[: len(folded)] == folded for other in others):
                raise _refused(one.name, "is there already, perhaps in other capitals")
            old = before.get(folded)
            left = room + (old.stat().st_size if old else 0) - one.size
            if left < 0:
                raise _refused(one.name, f"does not fit: all files together may hold {limit / 2**20:g} MB")
            room = left
        except BadInput as error:
            faults.append(of_error(error))
            continue
        if old is not None:
            old.unlink()  # perhaps in other capitals
        one.write(given.joinpath(*parts))
        taken.add(folded)
    found = sorted_out(given)
    if hidden:  # of files that are no data, one word for all
        more = f" and {len(hidden) - 1} more" if len(hidden) > 1 else ""
        problem = "hidden files and those of an operating system are passed over"
        remedy = "There is nothing to do; a file that is meant must not begin with a full stop"
        faults.append(Fault(file=SOURCE, field=f"{_shown(hidden[0])}{more}", problem=problem, remedy=remedy, grave=False))
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
        raise BadInput(str(folder), "", "there is no such folder", "Name the folder of a campaign or of a series")
    models: list[str] = []
    data: list[str] = []
    for path in _looked_through(where, DEEP):
        if path.is_dir():
            data.append(str(path))
            continue
        written = path.suffix.lower() == ".toml"
        try:
            table = toml_file.read(path)
        except (BadInput, OSError):
            table = {"model": None}  # the reader of models says what is wrong with it
        if written and "model" in table:
            models.append(str(path))
        elif table.get("kind") in (*classical_files.KINDS, *test_file.KINDS):  # what is neither is no fault here
            data.append(str(path))
    return Received(folder=where, models=tuple(models), data=tuple(data), faults=())


def _looked_through(folder: Path, deep: int) -> Iterator[Path]:
    """Campaign folders, whose own folders are not looked into, and files that could be models or measurements."""
    if campaign := (folder / campaign_file.NAME).is_file():
        yield folder
    for path in sorted(folder.iterdir()):
        if path.is_symlink() or path.name.startswith(".") or path.name == campaign_file.NAME:
            continue
        if path.is_dir() and deep and not campaign:
            yield from _looked_through(path, deep - 1)
        elif path.is_file() and path.suffix.lower() in (".toml", ".json") and not path.name.endswith(TRUTH):
            yield path


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


def _folded(parts: Sequence[str]) -> tuple[str, ...]:
    return tuple(part.casefold() for part in parts)


def _refused(name: str, problem: str) -> BadInput:
    return BadInput(SOURCE, _shown(name), problem, "Rename it, and hand it over again")


def _shown(name: str) -> str:
    """`name` as a page can say it."""
    shown = name.encode("unicode_escape", "backslashreplace").decode("ascii") if not name.isprintable() else name
    return shown if len(shown) <= LONGEST else f"{shown[:LONGEST]}…"
