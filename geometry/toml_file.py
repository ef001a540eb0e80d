"""The one door for what a user writes down in TOML (or the same in JSON): from a name to a table, or a refusal in words."""

import difflib
import json
import math
import os
import re
import tomllib
from collections.abc import Callable, Collection, Iterator, Mapping
from contextlib import suppress
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from pathlib import Path
from typing import TYPE_CHECKING, Any, TypeGuard

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput

if TYPE_CHECKING:
    from pint import UnitRegistry
    from uncertainties import UFloat


FORMAT = 1
"""The format that every file of ours states, ``format = 1``."""

DEEPEST = 20
"""Levels of tables and lists in each other: no file of ours needs five, and beyond hundreds Python's own stack ends."""

LARGEST_INTEGER = 1e300
"""A whole number beyond is no number that can be calculated with."""


DECKS = (".inp", ".bdf", ".nas", ".dat")
"""Endings of decks of finite-element programs."""

KINDS = {
    "campaign": "a campaign.toml",
    "model": "a model file",
    "fe_model": "an FE model",
    "kind": "a measurement file",
    "article": "the description of an article",
    "inertia": "a result file",
}
"""What a file is that has the key, the first of them that it has."""

STRUCTURES = ("frame", "mesh", "assembly", "matrices", "modal")
"""Kinds that [fe_model] may have, and no file."""

FOLDERS = {"campaign.toml": "a campaign", "test.toml": "a test"}
"""Whose folder it is that holds the file."""


def described_in(path: str) -> str:
    """The test.toml of the folder `path`, as `massline simulate --test` writes one; `path` of all else, and of a campaign."""
    campaign, test = (Path(path, name) for name in FOLDERS)
    return str(test) if test.is_file() and not campaign.exists() else path


def require_no_other(path: Path) -> None:
    """Refuse a deck or a mesh, with how it becomes a description, and a universal file, of which another argument is made."""
    if not path.is_file():
        return
    if path.suffix.lower() in DECKS:
        remedy = f"Describe its structure first: massline model {path} --out {path.with_suffix('.toml')}"
        raise BadInput(str(path), "", "it is a deck of a finite-element program", remedy)
    if path.suffix.lower() in (".msh", ".med"):
        remedy = f'Describe its structure first: [fe_model] with kind = "mesh", file = "{path.name}" and materials of its groups'
        raise BadInput(str(path), "", "it is a mesh, which does not say what it is made of", remedy)
    if path.suffix.lower() in (".unv", ".uff"):
        problem = "it is a universal file, a measurement, where a file in TOML is needed"
        raise BadInput(str(path), "", problem, "MODEL comes first and DATA behind it")


def kind_of(table: Mapping[str, Any]) -> str:
    """What the file of `table` is, in words; nothing where no key tells."""
    return next((what for key, what in KINDS.items() if key in table), "")


def read(name: str | Path, *, remedy: str = "Check the path") -> dict[str, Any]:
    """The table in the file `name`, JSON where its name ends so, else TOML; `remedy` is said when there is no such file.

    Raises
    ------
    BadInput : no name, no such file, a folder, a device, not UTF-8, not TOML or JSON (with the line), too deeply nested.
    OSError : the file cannot be read.
    """
    path, name = Path(name), str(name)
    if not name.strip():
        raise BadInput("file", "", f"the name is empty, found {name!r}", remedy)
    if path.is_dir():
        if (whose := next((what for file, what in FOLDERS.items() if (path / file).is_file()), None)) is not None:
            said = f"it is the folder of {whose}, where a file is needed"
            raise BadInput(name, "", said, f"MODEL comes first and DATA behind it. {remedy}")
        raise BadInput(name, "", "it is a folder, where a file is needed", remedy)
    if path.is_char_device() or path.is_block_device():
        raise BadInput(name, "", "it is a device, where a file is needed", remedy)
    if not path.exists():
        raise BadInput(name, "", "there is no such file", remedy)
    require_no_other(path)
    try:
        text = path.read_text(encoding="utf-8")
    except UnicodeDecodeError as error:
        problem = f"it is not text in UTF-8, found the byte {error.object[error.start]:#04x} at place {error.start}"
        raise BadInput(name, "", problem, "Save it as UTF-8") from None
    return parse(text, name)


def parse(text: str, name: str) -> dict[str, Any]:
    """The table in `text`, JSON where `name` ends so, else TOML; `name` says where the text came from.

    Raises
    ------
    BadInput : not TOML or JSON (with the line), too deeply nested; a structure without its table.
    """
    form = "JSON" if name.lower().endswith(".json") else "TOML"
    try:
        table: Any = json.loads(text, parse_constant=_refused_constant) if form == "JSON" else tomllib.loads(text)
    except ValueError as error:  # also what Python says of a whole number of thousands of digits
        raise BadInput(name, "", f"it is not {form}: {error}", "Correct the place that it names; .json is read as JSON") from None
    except RecursionError:
        raise _too_deep(name) from None
    if not isinstance(table, dict):
        raise BadInput(name, "", "must hold one JSON object", "Put the values into {...}")
    _require_plain(table, name, DEEPEST)
    if table.get("kind") in STRUCTURES:
        problem = f"{table['kind']!r} is a structure, whose keys belong below [fe_model]"
        raise BadInput(name, "kind", problem, "Write the line [fe_model] above it")
    return table


DATA, NO_DATA = "MASSLINE_DATA", "../shared/data"
"""Environment variable that names a folder of real data which nobody copies, and where that lies if it does not."""


def named_file(name: str, folder: Path, source: str, where: str) -> Path:
    """The file that `source` calls `name` at `where`: in `folder` or below, or, ``$MASSLINE_DATA/...``, in that of `DATA`.

    Raises
    ------
    BadInput : it is not there, or its name or a link leads elsewhere.
    """
    whose, within = "the folder of the description", name.removeprefix(f"${DATA}/")
    if within != name:
        whose, folder = DATA, Path(os.environ.get(DATA, NO_DATA))
    there = folder / within
    if not there.resolve().is_relative_to(folder.resolve()):
        problem = f"{name!r} leads out of {whose}, to {there.resolve()}"
        raise BadInput(source, where, problem, "Copy the file beside the description")
    if not there.is_file():
        remedy = f"Looked for {there}" + (f"; {DATA} names the folder of data" if within != name else "")
        raise BadInput(source, where, f"there is no file {name!r}", remedy)
    return there


def texts(value: object) -> Iterator[str]:
    """Every text in a table or a list, however deep."""
    if isinstance(value, str):
        yield value
    elif isinstance(value, Mapping | list):
        for one in value.values() if isinstance(value, Mapping) else value:
            yield from texts(one)


def files_named(path: Path) -> tuple[Path, ...]:
    """The files that the one at `path` names where it is TOML, seen from its folder or by `DATA`, and those that these name."""
    found = [path]
    for one in found:
        with suppress(BadInput, OSError, ValueError):  # whoever reads it says what is wrong; a text that no file can be called
            for text in texts(read(one)) if one.suffix == ".toml" else ():
                there = one.parent / os.path.expandvars(text)
                found += [there] if there.suffix and there not in found and there.is_file() else []
    return tuple(found[1:])


def wrong(found: object, wanted: str, source: str, where: str, remedy: str = "Correct it") -> BadInput:
    """The refusal of what `source` has at `where`: `found` in place of what is `wanted`."""
    return BadInput(source, where, f"must be {wanted}, found {found!r}", remedy)


def shipped(package: str, *path: str) -> dict[str, Any]:
    """The table in a file that comes with massline, at `path` in the folder of `package`."""
    return parse(files(package).joinpath(*path).read_text(encoding="utf-8"), path[-1])


def holds(path: Path, key: str) -> bool:
    """Whether the file at `path` is TOML and has `key`, or is damaged and has a table of that name: whoever reads it says so."""
    try:
        text = path.read_text(encoding="utf-8")
    except (OSError, ValueError):
        return False
    try:
        return key in tomllib.loads(text)
    except (ValueError, RecursionError):
        return any(line.strip().startswith((f"[{key}]", f"[[{key}]]", f"[{key}.")) for line in text.splitlines())


def is_number(value: object) -> TypeGuard[float]:
    """Whether `value` is a number; true and false are none, though Python counts with them."""
    return isinstance(value, int | float) and not isinstance(value, bool)


def is_whole(value: object) -> TypeGuard[int]:
    """Whether `value` is a whole number, neither true nor false."""
    return isinstance(value, int) and not isinstance(value, bool)


def require_format(table: Mapping[str, Any], source: str) -> None:
    """Refuse a `table` that does not state `FORMAT`.

    Raises
    ------
    BadInput : it is missing or another.
    """
    found = table.get("format")
    if found != FORMAT or isinstance(found, bool):
        problem = f"must be {FORMAT}, found {found!r}" if "format" in table else "is missing"
        raise BadInput(source, "format", problem, f"Write format = {FORMAT}")


def _refused_constant(word: str) -> None:
    raise ValueError(f"a value must be finite, found {word}")


def _require_plain(value: Any, source: str, levels: int) -> None:
    """Refuse what no reader behind this door could as much as print."""
    if isinstance(value, int) and abs(value) > LARGEST_INTEGER:
        raise BadInput(source, "", "it holds a whole number of hundreds of digits", "Correct it")
    inner = value.values() if isinstance(value, dict) else value if isinstance(value, list) else ()
    if inner and not levels:
        raise _too_deep(source)
    for each in inner:
        _require_plain(each, source, levels - 1)


def _too_deep(source: str) -> BadInput:
    problem = f"it is nested too deeply: more than {DEEPEST} tables or lists in each other"
    return BadInput(source, "", problem, "Check its brackets and dots")


def string(value: str) -> str:
    """`value` as a basic string of TOML: JSON's escapes are TOML's, but for one character that JSON leaves as it is."""
    return json.dumps(value, ensure_ascii=False).replace("\x7f", "\\u007f")


def inline(value: Any, of_float: Callable[[float], str] = "{:.9g}".format) -> str:
    """A value of TOML on one line, numbers as `of_float` writes them, by default to nine digits."""
    if isinstance(value, Mapping):
        return "{ " + ", ".join(f"{string(key)} = {inline(one, of_float)}" for key, one in value.items()) + " }"
    if isinstance(value, list | tuple):
        return "[" + ", ".join(inline(one, of_float) for one in value) + "]"
    if isinstance(value, str):
        return string(value)
    return of_float(value) if isinstance(value, float) else str(value).lower()


# Tables of a user's file, checked at the door: no key that nobody reads, none missing, and the nearest name suggested.


def require_known(table: Mapping[str, Any], known: Collection[str], *, source: str, where: str = "") -> None:
    """Refuse a key of `table` that is not in `known`.

    Raises
    ------
    BadInput : the first unknown key, with the nearest known one.
    """
    for key in table:
        if key not in known:
            is_other = not where and key in KINDS and kind_of(table) == KINDS[key]
            problem = f"this is {KINDS[key]}, not what is read here" if is_other else f"found the unknown key {key!r}"
            remedy, structure = nearest(key, known) + f"Known are {', '.join(known)}", table.get("structure")
            if is_other and isinstance(structure, Mapping) and isinstance(own := structure.get("own"), Mapping):
                remedy = f"Name the structure that it names: {', '.join(map(str, own.values()))}"
            raise BadInput(source, f"{where}.{key}" if where else key, problem, remedy)


def require_present(table: Mapping[str, Any], needed: Collection[str], *, source: str, where: str = "") -> None:
    """Refuse a `table` that lacks a key of `needed`.

    Raises
    ------
    BadInput : the first missing key, with the nearest one that is there instead.
    """
    for key in needed:
        if key not in table:
            like = difflib.get_close_matches(key, list(table), n=1)
            instead = f", found {like[0]!r} instead" if like else ""
            raise BadInput(source, f"{where}.{key}" if where else key, f"is missing{instead}", "Add it")


def require_table(value: object, *, source: str, where: str) -> dict[str, Any]:
    """`value`, which must be a table.

    Raises
    ------
    BadInput : it is something else.
    """
    if not isinstance(value, dict):
        raise BadInput(source, where, f"must be a table, found {value!r}", f"Write it as [{where}]")
    return value


def one_of(value: object, choices: Collection[str], *, source: str, where: str) -> str:
    """`value`, which must be one of the words `choices`.

    Raises
    ------
    BadInput : it is not; with the nearest.
    """
    if isinstance(value, str) and value in choices:
        return value
    problem = f"must be one of {', '.join(choices)}, found {value!r}"
    raise BadInput(source, where, problem, nearest(str(value), choices) or "Choose one of them")


TURNS = {
    **dict.fromkeys(("rx", "rotx", "thetax", "roll"), "alpha"),
    **dict.fromkeys(("ry", "roty", "thetay", "pitch"), "beta"),
    **dict.fromkeys(("rz", "rotz", "thetaz", "yaw"), "gamma"),
}
"""What others call the turns about x, y and z."""


def nearest(word: str, known: Collection[str]) -> str:
    """'Did you mean ...? ', or nothing when no known word is near; a turn about an axis is meant by its other names, too."""
    turn = TURNS.get(word.lower().replace("_", ""), "")
    if turn in known:
        return f"Did you mean {turn}? "
    near = difflib.get_close_matches(word, list(known), n=1)
    return f"Did you mean {near[0]}? " if near else ""


# Units of length that a file of bare numbers may mean.


@dataclass(frozen=True, kw_only=True)
class LengthUnit:
    """A unit of length.

    Attributes
    ----------
    name : as on the command line
    metres : its length [m]
    """

    name: str
    metres: float

    def shown(self, point: npt.ArrayLike) -> str:
        """A point (3,) [m] in this unit, ``(1.2, 3.4, 5.6) mm``."""
        x, y, z = (f"{value + 0.0:.6g}" for value in np.asarray(point, dtype=np.float64) / self.metres)
        return f"({x}, {y}, {z}) {self.name}"


PLAUSIBLE = (2e-3, 20.0)
"""Largest dimension [m] of a structure that is mounted on a shaking table; outside, the unit is doubted aloud."""

METRE = LengthUnit(name="m", metres=1.0)
MILLIMETRE = LengthUnit(name="mm", metres=1e-3)

UNITS = {
    unit.name: unit
    for unit in (
        MILLIMETRE,
        LengthUnit(name="cm", metres=1e-2),
        METRE,
        LengthUnit(name="in", metres=0.0254),
        LengthUnit(name="ft", metres=0.3048),
    )
}
"""The units on offer, by name."""

_WORDS = {
    "mm": ("millimetre", "millimetres", "millimeter", "millimeters"),
    "cm": ("centimetre", "centimetres", "centimeter", "centimeters"),
    "m": ("metre", "metres", "meter", "meters"),
    "in": ("inch", "inches"),
    "ft": ("foot", "feet"),
}
_BY_WORD = {word: UNITS[name] for name, words in _WORDS.items() for word in (name, *words)}


def doubts(size: float, source: str, unit: LengthUnit | None = None) -> tuple[str, ...]:
    """A word about a largest dimension `size` [m] that no article has.

    `unit` is the one that the user gave or the file states in words, and units that would make the size an ordinary one are
    proposed; None is for files whose own unit nobody chooses.
    """
    smallest, largest = PLAUSIBLE
    if smallest <= size <= largest:
        return ()
    if unit is None:
        return (f"{source}: its own unit makes it {size:.4g} m long, which is suspicious; check the unit of the export",)
    better = [other.name for other in UNITS.values() if 5 * smallest <= size / unit.metres * other.metres <= largest / 2]
    instead = f"; in {' or '.join(better)} it would be of ordinary size" if better else ""
    return (f"{source}: with unit {unit.name} it is {size:.4g} m long, which is suspicious{instead}",)


def length_unit(text: str, source: str, field: str = "unit") -> LengthUnit:
    """The unit that `text` names, short (``mm``) or in full (``millimetres``), upper or lower case.

    Raises
    ------
    BadInput : no such unit; the message lists those on offer.
    """
    unit = _BY_WORD.get(text.strip().lower())
    if unit is not None:
        return unit
    problem = f"no unit of length is called {text!r}"
    raise BadInput(source, field, problem, f"{nearest(text.strip().lower(), _BY_WORD)}Give one of {', '.join(UNITS)}")


# Quantities as people write them, ``"47.40 +/- 0.05 kg"``, turned into SI values that remember their tolerance and their name.
#
# What a tolerance means: a half-width at one level of confidence that is the same for every input of a file (all of them one
# standard deviation, or all 95 % limits: the reader need not know which) and comes back at that level. Inputs are independent,
# and tolerances combine in quadrature to first order (ISO/IEC Guide 98-3, the GUM, section 5.1.2). A value without a tolerance
# is exact. `uncertainties` carries the derivatives; every input is tagged with its name, so that each result can be itemised.

SI_UNITS = {"mass": "kg", "length": "m", "time": "s", "acceleration": "m/s^2", "force": "N", "density": "kg/m^3"}
SI_UNITS |= {"pressure": "Pa", "moment of inertia": "kg m^2", "first moment": "kg m", "angle": "rad", "frequency": "Hz"}
SI_UNITS |= {"ratio": "1", "area": "m^2", "second moment of area": "m^4", "stiffness": "N/m", "rotational stiffness": "N m/rad"}
"""The dimensions that users' files use, and the unit in which their values leave here."""

STANDARD_GRAVITY = 9.80665
"""[m/s²] By definition (3rd CGPM, 1901)."""

FIRST_ORDER_LIMIT = 0.1
"""Relative tolerance above which first order is doubtful: the neglected terms are of the order of its square, 1 %."""

LARGEST_QUANTITY = 1e15
"""In SI: no quantity of a test article lies beyond, and arithmetic stays far from overflow. What is smaller than its inverse is
the rounding that another program leaves of a zero, and is read as zero."""

SAID_OFTEN = {
    "ratio": {"1": 1.0, "%": 0.01},
    "length": {"m": 1.0, "mm": 0.001, "um": 1e-06},
    "mass": {"kg": 1.0, "g": 0.001},
    "time": {"s": 1.0, "ms": 0.001, "us": 1e-06},
    "frequency": {"Hz": 1.0},
    "angle": {"rad": 1.0, "mrad": 0.001},
    "force": {"N": 1.0},
}
"""Units by dimension and what they are in SI, as pint says; reading its tables takes longer than a campaign's files."""

_NAMED = {**SI_UNITS, "volume": "m^3", "velocity": "m/s", "torque": "N m"}
_NUMBER = r"[+-]?(?:\d+\.?\d*|\.\d+)(?:[eE][+-]?\d+)?"
_QUANTITY = re.compile(
    rf"\(?\s*(?P<value>{_NUMBER})\s*(?P<unit>[^\d\s+()±,-][^+()±]*?)?\s*"
    rf"(?:(?:\+/-|\+-|±)\s*(?P<tolerance>{_NUMBER})\s*\)?\s*(?P<last>[^\d\s+±-][^+()±]*?)?)?\s*\)?"
)


def quantity(text: Any, dimension: str, *, source: str, field: str, name: str = "") -> "UFloat":
    """Read `text` as a value of `dimension` (a key of `SI_UNITS`), in SI, tagged with `name` (`field` by default).

    ``"1.92 s"``, ``"1.9245 ± 0.0002 s"``, ``"(47.40 +/- 0.05) kg"`` and ``"47.40 kg +/- 50 g"`` are understood, and
    ``"47.40 kg +/- 0.1 %"``, a tolerance relative to the value. A ratio may stand without a unit.

    Raises
    ------
    BadInput : not such a text, no unit, an unknown unit, another dimension (both are named), a negative tolerance, NaN.
    """
    match = _QUANTITY.fullmatch(text.strip()) if isinstance(text, str) else None
    if match is None:
        if is_number(text):
            raise _refused(f"{_a(dimension)} needs its unit, found the bare number {text!r}", dimension, source, field)
        raise _refused(f"{_a(dimension)} cannot be read from {text!r}", dimension, source, field)
    first, last = match["unit"], match["last"]
    unit = first or last
    if unit is None and dimension != "ratio":
        raise _refused(f"{_a(dimension)} needs its unit, found {text!r}", dimension, source, field)
    factor = _factor(unit or "1", dimension, source, field)
    value = float(match["value"]) * factor
    width = float(match["tolerance"] or 0.0)
    if first and last:
        width *= abs(value) if _is_percent(last) else _factor(last, dimension, source, field)
        width *= 0.01 if _is_percent(last) else 1.0
    else:
        width *= factor
    if first and match["tolerance"] and not last:
        raise _refused(f"the tolerance needs its unit too, found {text!r}", dimension, source, field)
    if width < 0 or not math.isfinite(value + width):
        raise _refused(f"a tolerance must not be negative and all must be finite, found {text!r}", dimension, source, field)
    if max(abs(value), width) >= LARGEST_QUANTITY:
        raise _refused(f"no measured {dimension} has this size, found {text!r}", dimension, source, field)
    return tagged(_nothing_less(value), _nothing_less(width), name or field)


def tagged(value: float, tolerance: float, name: str) -> "UFloat":
    """`value` with `tolerance` (same unit, not negative), under `name` in every budget that it enters; zero makes it exact."""
    from uncertainties import ufloat

    return ufloat(value, tolerance, tag=name) if tolerance else exact(value)


def exact(value: float) -> "UFloat":
    """`value` without tolerance; it enters no budget."""
    from uncertainties.core import AffineScalarFunc, LinearCombination

    return AffineScalarFunc(value, LinearCombination({}))


def doubtful_at_first_order(value: float, tolerance: float) -> bool:
    """Whether the `tolerance` of an input is so large beside its `value` that first-order propagation is doubtful."""
    return value != 0 and tolerance > FIRST_ORDER_LIMIT * abs(value)


def _nothing_less(size: float) -> float:
    return size if abs(size) > 1 / LARGEST_QUANTITY else 0.0


@cache
def _registry() -> "UnitRegistry[float]":
    from pint import UnitRegistry

    return UnitRegistry()


def _is_percent(unit: str) -> bool:
    return unit.strip() in {"%", "percent"}


def _factor(unit: str, dimension: str, source: str, field: str) -> float:
    """What a number in `unit` is multiplied with to be in the SI unit of `dimension`."""
    if (known := SAID_OFTEN.get(dimension, {}).get(unit.strip())) is not None:
        return known
    registry = _registry()
    try:
        found = registry.Quantity(1.0, registry.parse_units("dimensionless" if unit.strip() == "1" else unit))
        wanted = registry.Unit(SI_UNITS[dimension] if dimension != "ratio" else "dimensionless")
    except Exception as error:  # pint raises its own, tokenize's and Python's errors on nonsense
        raise _refused(f"the unit {unit!r} is not known", dimension, source, field) from error
    angular = "radian" in str(found.to_root_units().units)
    turns = dimension == "rotational stiffness"  # per radian, said or not
    if found.dimensionality != wanted.dimensionality or ((dimension == "angle") != angular and not turns):
        like = (known for known, si in _NAMED.items() if registry.Unit(si).dimensionality == found.dimensionality)
        named = next((known for known in like if known not in {"angle", "ratio", "rotational stiffness"}), None)
        unnamed = f"of dimension {found.dimensionality}" if found.dimensionality else "a pure number"
        what = "an angle" if angular else _a(named) if named else unnamed
        raise _refused(f"{unit!r} is {what}, where {_a(dimension)} should be", dimension, source, field)
    return float(found.to(wanted).magnitude)


def unit_among(text: str, units: Mapping[str, str], *, source: str, field: str) -> tuple[str, float]:
    """Of which of `units`, SI by name, `text` is a unit, and what one of it is in that; ``g`` stands for standard gravity.

    Raises
    ------
    BadInput : an unknown unit, or one of something else.
    """
    registry = _registry()
    try:
        found = registry.Quantity(1.0, registry.parse_units(re.sub(r"\bg\b", "g_0", text)))
    except Exception:  # pint raises its own, tokenize's and Python's errors on nonsense
        raise BadInput(source, field, f"the unit {text!r} is not known", f"Write it like {next(iter(units.values()))}") from None
    for name, si in units.items():
        if registry.Unit(si).dimensionality == found.dimensionality:
            return name, float(found.to(si).magnitude)
    raise BadInput(source, field, f"{text!r} is of none of {', '.join(units)}", f"Write it like {next(iter(units.values()))}")


def is_unit(text: str) -> bool:
    """Whether `text` is a unit of anything at all."""
    try:
        return bool(text) and not _registry().parse_units(text).dimensionless
    except Exception:  # as above
        return False


def _a(name: str) -> str:
    return f"an {name}" if name[0] in "aeiou" else f"a {name}"


def _refused(problem: str, dimension: str, source: str, field: str) -> BadInput:
    unit = SI_UNITS[dimension]
    example = "0.3 %" if dimension == "ratio" else f"1.00 +/- 0.01 {unit}"
    return BadInput(source, field, problem, f'Write it like "{example}"')
