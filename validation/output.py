"""What goes to standard output: one JSON object whose keys end in their unit, or pages for a reader, as wide as he can see."""

import json
import os
import sys
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from contextlib import contextmanager
from dataclasses import MISSING, Field, dataclass, field, fields, is_dataclass
from functools import cache
from math import exp, floor, isfinite, log, log10
from pathlib import Path
from types import NoneType, UnionType
from typing import TYPE_CHECKING, Any, TypeVar, Union, get_args, get_origin, get_type_hints

import click
import numpy as np

from geometry.atomic import probe, probe_folder, write_text
from geometry.errors import BadInput
from geometry.inertia import Inertia

if TYPE_CHECKING:
    from rich.console import RenderableType


PIPED_WIDTH = 132
"""Columns of what goes to a file or a pipe, where nobody's window is narrower."""

UNBOUNDED = 10_000
"""Columns in which every table finds room, to see how few it needs."""


def page_width() -> int:
    """Columns of a page: what COLUMNS says, else the terminal's, else `PIPED_WIDTH`."""
    from rich.console import Console

    asked = os.environ.get("COLUMNS", "")
    if asked.isdecimal() and int(asked) > 0:
        return int(asked)
    terminal = Console()
    return terminal.width if terminal.is_terminal else PIPED_WIDTH


def print_pages(pages: "Iterable[RenderableType]") -> None:
    """Print `pages` in `page_width` columns, a table that needs more in as many as it needs: its figures are never cut.

    Nothing that a user wrote is markup: [kg] and :name: are printed as they are. No line of a file or a pipe ends in spaces.
    """
    from rich.console import Console

    console = Console(markup=False, emoji=False, highlight=False)
    width = page_width()
    for page in pages:
        console.width = UNBOUNDED
        console.width = max(width, console.measure(page).minimum)
        with console.capture() as capture:
            console.print(page)
        lines = capture.get().splitlines()
        shown = lines if console.is_terminal else [line.rstrip() for line in lines]
        click.echo("\n".join(shown), color=console.is_terminal or None)


def print_json(value: dict[str, Any]) -> None:
    """Print `value` as the one JSON object of a command."""
    click.echo(json_text(value))


def json_text(value: dict[str, Any]) -> str:
    """`value` as one JSON object; NaN and infinity are refused, they are not JSON."""
    return json.dumps(value, indent=2, ensure_ascii=False, allow_nan=False)


def print_answer(
    whole: Callable[[], dict[str, Any]], page: Callable[[], str], *, as_json: bool, file: Path | None = None
) -> None:
    """Print `whole` `as_json` or the `page` for a reader, and write `whole` into the `file` where there is one."""
    text = json_text(whole()) if as_json or file is not None else ""
    click.echo(text if as_json else page(), nl=as_json)
    if file is not None:
        write_text(file, text + "\n")
        wrote(file)


def wrote(*paths: Path) -> None:
    """Tell of every file that was written, beside standard output."""
    for path in paths:
        click.echo(f"massline: wrote {path}.", err=True)


# One codec for results: a frozen dataclass says of each field under which key JSON has it, and is written and read by that.
#
#     sigma: float                                        under its own name
#     frequency: float = entry("frequency_hz", unit="Hz")   under another
#     low: float = entry("interval90/0")                  in a place of a list or an object
#     evidence: float = entry("evidence_nats", null=inf)  null is infinity, and infinity null
#     maps: tuple[Map, ...] = unwritten()                 not at all
#
# What is computed from other fields is a property that is `derived`; it is written and never read. Keys stand in the order of the
# fields, derived ones behind them or before the key that they name. Without metadata any value is written as JSON has it:
# arrays and tuples as lists, mappings as objects, what is not finite as null.

_CODEC = "json"
_Of = TypeVar("_Of")
_Function = TypeVar("_Function", bound=Callable[..., Any])


@dataclass(frozen=True, eq=False, kw_only=True)
class Entry:
    """How JSON has one field of a result.

    Attributes
    ----------
    path : keys from the outermost object inwards, and places in lists; none for what is not written
    unit : of its numbers; empty where they have none
    null : what null stands for, where it is no None
    write, read : to JSON and back; None for what the field's type says
    later : whether files that were written before the field was there lack it
    rare : whether it is written only where there is something: most results have nothing to say of it
    """

    path: tuple[str | int, ...]
    unit: str = ""
    null: Any = None
    write: Callable[[Any], Any] | None = None
    read: Callable[[Any], Any] | None = None
    later: bool = False
    rare: bool = False


def entry(
    key: str = "",
    *,
    unit: str = "",
    null: Any = None,
    write: Callable[[Any], Any] | None = None,
    read: Callable[[Any], Any] | None = None,
    later: bool = False,
    rare: bool = False,
    default: Any = MISSING,
    default_factory: Any = MISSING,
) -> Any:
    """A field of a result; for the parameters see `Entry`, of whose path `key` is the text, empty for the field's name."""
    path = tuple(int(part) if part.isdecimal() else part for part in key.split("/")) if key else ()
    said = Entry(path=path, unit=unit, null=null, write=write, read=read, later=later or rare, rare=rare)
    return field(metadata={_CODEC: said}, **_default(default, default_factory))


def unwritten(*, default: Any = MISSING, default_factory: Any = MISSING) -> Any:
    """A field of a result that JSON does not have."""
    return field(metadata={_CODEC: None}, **_default(default, default_factory))


def _default(default: Any, default_factory: Any) -> dict[str, Any]:
    return ({} if default is MISSING else {"default": default}) | (
        {} if default_factory is MISSING else {"default_factory": default_factory}
    )


def derived(key: str, *, before: str = "") -> Callable[[_Function], _Function]:
    """Mark the function of a property whose value JSON has under `key`; all keys of its mapping where that is empty."""

    def marked(function: _Function) -> _Function:
        setattr(function, _CODEC, (key, before))
        return function

    return marked


def _entry(one: Field[Any]) -> Entry | None:
    """None of what is not written."""
    said = one.metadata.get(_CODEC, Entry(path=(one.name,)))
    return said if said is None or said.path else Entry(**{**vars(said), "path": (one.name,)})


def to_json(value: Any) -> Any:
    """`value` as JSON has it: a result as an object by its fields, what no type of JSON is by its words."""
    if is_dataclass(value) and not isinstance(value, type):
        return _object(value)
    if value is None or isinstance(value, bool | str):
        return value
    if isinstance(value, np.ndarray):
        return to_json(value.tolist())
    if isinstance(value, Mapping):
        return {str(name): to_json(one) for name, one in value.items()}
    if isinstance(value, list | tuple | set | frozenset):
        return [to_json(one) for one in value]
    if hasattr(value, "__index__"):
        return int(value)
    if hasattr(value, "__float__"):
        return float(value) if isfinite(value) else None
    return str(value)


def _object(of: Any) -> dict[str, Any]:
    found: dict[str, Any] = {}
    for one in fields(of):
        said = _entry(one)
        if said is None:
            continue
        value, at = getattr(of, one.name), found
        if said.rare and not value:
            continue
        for part in said.path[:-1]:
            at = at.setdefault(str(part), {})
        null = said.null is not None and value == said.null
        at[str(said.path[-1])] = None if null else to_json(value if said.write is None else said.write(value))
    every_path = [said.path for one in fields(of) if (said := _entry(one))]
    for key in {str(path[0]) for path in every_path if len(path) == 2 and isinstance(path[1], int)}:
        places = [found[key][place] for place in sorted(found[key], key=int)]  # of a list, in their order; null where all are
        found[key] = None if all(one is None for one in places) else places
    # What is computed: name, key, and the key before which it stands
    every = {name: one for base in reversed(type(of).__mro__) for name, one in vars(base).items() if isinstance(one, property)}
    for name, computed in every.items():
        if not hasattr(computed.fget, _CODEC):
            continue
        (key, before), value = getattr(computed.fget, _CODEC), to_json(getattr(of, name))
        items = list(found.items())
        at_key = next((k for k, (other, _) in enumerate(items) if other == before), len(items))
        items[at_key:at_key] = [(key, value)] if key else list(value.items())
        found = dict(items)
    return found


def from_json(kind: type[_Of], table: Mapping[str, Any], **known: Any) -> _Of:
    """The result of that `kind` which `table` holds; fields that are `known` are not looked for in it.

    Raises
    ------
    KeyError : a key is missing.
    TypeError, ValueError : a value is none of its field; says what was expected and what was found.
    """
    hints, found = _hints(kind), dict(known)
    for one in fields(kind):  # type: ignore[arg-type]
        said = _entry(one)
        if one.name in found or said is None:
            continue
        if said.later and said.path[0] not in table:
            continue
        value: Any = table
        for part in said.path:
            value = value[part]
        if value is None and said.null is not None:
            found[one.name] = said.null
        else:
            found[one.name] = said.read(value) if said.read is not None else _read(hints[one.name], value)
    return kind(**found)


_hints: Callable[[Any], dict[str, Any]] = cache(get_type_hints)


def _read(kind: Any, value: Any) -> Any:
    """`value` of JSON as the type `kind`."""
    origin, inside = get_origin(kind), get_args(kind)
    if origin in (Union, UnionType):
        return None if value is None and NoneType in inside else _read(next(one for one in inside if one is not NoneType), value)
    if origin is tuple:
        _require(isinstance(value, list), "a list of texts" if inside[0] is str else "a list", value)
        if inside[-1] is Ellipsis:
            return tuple(_read(inside[0], one) for one in value)
        _require(len(value) == len(inside), f"a list of {len(inside)}", value)
        return tuple(map(_read, inside, value))
    if origin is not None and issubclass(origin, Mapping):
        _require(isinstance(value, Mapping), "an object", value)
        return {str(name): _read(inside[1], one) for name, one in value.items()}
    if is_dataclass(kind):
        _require(isinstance(value, Mapping), "an object", value)
        return from_json(kind, value)  # type: ignore[arg-type]
    if kind is bool:
        return bool(value)
    if kind in (int, float):
        right = isinstance(value, int if kind is int else int | float) and not isinstance(value, bool)
        _require(right, "a whole number" if kind is int else "a number", value)
        return kind(value)
    if kind is str:
        _require(isinstance(value, str), "a text", value)
    return value


def _require(right: bool, what: str, found: Any) -> None:
    if not right:
        raise TypeError(f"{what} is expected, found {found!r:.60}")


def plain_unit(unit: str) -> str:
    """`unit` in ASCII (kg m^2), as a model file writes it: for programs, and for spreadsheets that are not told of UTF-8."""
    return unit.replace("²", "^2").replace("³", "^3")


def inertia_json(inertia: Inertia) -> dict[str, Any]:
    """INERTIA of the output contract: CoG [mm] in the body's frame, moments and products [kg m²] about the CoG."""
    return {
        "mass_kg": inertia.mass,
        "cog_mm": (1e3 * inertia.cog).tolist(),
        "moi_cog_kgm2": inertia.moments_cog.tolist(),
        "poi_cog_kgm2": inertia.products_cog.tolist(),
        "about": "cog",
    }


def require_ending(path: Path, endings: Sequence[str], what: str, example: str) -> None:
    """Refuse, before anything is computed, a file of ``--out`` whose ending chooses none of the formats of `what`.

    Raises
    ------
    BadInput : no file is named, or its ending is not one of `endings`; `example` is one that is.
    """
    if not path.name:
        raise BadInput("--out", "", "no file is named", f"Give one, such as {example}, or leave it out")
    if path.suffix.lower() not in endings:
        problem = f"{what} is written as {', '.join(endings)}, found {path.suffix or 'no ending'}"
        raise BadInput(str(path), "--out", problem, "Name the file so, the ending chooses the format")


OF_FILES = (".html", ".htm", ".pdf", ".json", ".toml", ".csv", ".txt", ".png", ".svg")
"""Endings of pages, tables and pictures, which no folder has."""


def require_file(path: Path, option: str) -> None:
    """Refuse, before anything is computed, a file named by `option` that could not be written.

    Raises
    ------
    BadInput : a device, a folder instead of a file, a folder that is not there or where nothing can be written.
    """
    _tried(probe, path, option)


def require_folder(folder: Path, option: str) -> None:
    """The same of a folder into which `option` writes; it may be missing when the one that it lies in is there.

    Raises
    ------
    BadInput : see `require_file`; one that is named like a page, a table or a picture.
    """
    if folder.is_file() or (folder.suffix.lower() in OF_FILES and not folder.is_dir()):
        problem = f"{folder} is {'' if folder.is_file() else 'named like '}a file, and several are written into a folder"
        raise BadInput(option, "", problem, "Name a new folder; `massline report` writes one page")
    _tried(probe_folder, folder, option)


def _tried(attempt: Callable[[Path], None], path: Path, option: str) -> None:
    try:
        attempt(path)
    except OSError as error:
        problem = f"{path} cannot be written: {error.strerror}"
        raise BadInput(option, "", problem, "Name a folder that is there and may be written to") from None


# Numbers as pages have them: which digits mean something, and the unit behind them.

NONE = "–"
"""Where there is no number."""

SMALL, LARGE = 1e-6, 1e7
"""Outside of these a figure has an exponent: its zeros would have to be counted."""

SIGNIFICANT = 6
"""Digits of a number that nobody rounded."""

MANY = 6
"""Decimals beyond which zeros would be counted."""


def significant(value: float, digits: int) -> str:
    """`value` rounded to `digits` significant digits, without an exponent where that reads well."""
    if value == 0 or not isfinite(value):
        return f"{value:g}"
    decimals = digits - 1 - floor(log10(abs(float(f"{value:.{digits - 1}e}"))))
    return f"{value:.{digits - 1}e}" if decimals > MANY else f"{round(value, decimals):.{max(decimals, 0)}f}"


def two_digits(value: float) -> str:
    """`value` with two digits that mean something, all of those before the point, and no exponent of what is large."""
    return f"{value:.0f}" if value >= 10 else f"{value:.2g}"


def nats(value: float) -> str:
    """Evidence with its sign: tenths below ten, where they decide, and whole nats beyond."""
    return f"{value:+.1f}" if abs(value) < 9.95 else f"{value:+.0f}"


CERTAIN = log(1e6)
"""[nats] from which odds are only said to be over a million to 1. Held by test_rows.py."""


def odds(evidence: float) -> str:
    """Evidence in nats as odds, "3000 to 1", with two digits; against it "1 to 3000"."""
    size = abs(evidence)
    if not size < CERTAIN:  # infinite, too
        many = "over a million"
    else:
        rounded = float(f"{exp(size):.1e}")
        many = f"{rounded:,.0f}" if rounded >= 1e4 else f"{rounded:g}"
    return f"{many} to 1" if evidence >= 0 else f"1 to {many}"


def percent(value: float) -> str:
    """`value` with three digits, and no exponent of what is large."""
    return f"{value:.0f} %" if value >= 100 else f"{value:.3g} %"


def fixed(value: float, decimals: int) -> str:
    """`value` with `decimals`, or six significant digits and an exponent beyond `LARGE`; zero has no sign."""
    if abs(value) >= LARGE or decimals >= 2 * SIGNIFICANT:  # the largest of its kind is too small to do without an exponent
        return f"{value:.{SIGNIFICANT - 1}e}" if abs(value) >= 0.5 * 10.0**-decimals else "0"
    text = f"{value:.{decimals}f}"
    return text.lstrip("-") if float(text) == 0 else text


def rounded(value: float | None, tolerance: float | None) -> str:
    """`value` with the digits that `tolerance` leaves it: two of the tolerance's, or six significant ones without any."""
    if value is None:
        return NONE
    if not tolerance:
        return f"{value:.{SIGNIFICANT}g}"
    decimals = 1 - floor(log10(tolerance))
    if SMALL <= max(abs(value), tolerance) < LARGE:
        return f"{round(value, decimals) + 0.0:.{max(decimals, 0)}f}"
    return f"{value:.{max(floor(log10(abs(value))) + decimals, 0)}e}" if value else "0"


def with_unit(text: str, unit: str) -> str:
    """A figure and its unit, which a ratio has not; a degree follows at once."""
    return text + (unit if unit == "°" else "" if unit in ("", "1") else f" {unit}")


# Progress on standard error for work over a second: what is being done now, silent where nobody watches.


@contextmanager
def shown(words: str, *, quiet: bool = False) -> Iterator[None]:
    """Show `words` with a spinner while the block runs, if standard error is a terminal and not `quiet`."""
    if quiet or not sys.stderr.isatty():
        yield
        return
    from rich.console import Console

    with Console(stderr=True).status(words):
        yield


def counted(items: Iterable[str], words: str, *, quiet: bool = False) -> Iterator[str]:
    """`items` one after the other, each announced as ``words: item (2 of 5)`` while the caller works on it."""
    listed = list(items)
    for number, item in enumerate(listed, start=1):
        with shown(f"{words}: {item} ({number} of {len(listed)})", quiet=quiet):
            yield item


@contextmanager
def share_done(words: str, *, quiet: bool = False) -> Iterator[Callable[[float], None]]:
    """Show `words` with the share done while the block runs, as `shown` does; it is told by calling what the block is given."""
    if quiet or not sys.stderr.isatty():
        yield lambda share: None
        return
    from rich.console import Console

    with Console(stderr=True).status(words) as status:
        yield lambda share: status.update(f"{words}: {100 * min(max(share, 0.0), 1.0):.0f} %")


@contextmanager
def stages(words: str, *, quiet: bool = False) -> Iterator[Callable[[str, float], None]]:
    """The same for work of several stages: what the block is given hears the name of the stage and the share of it."""
    if quiet or not sys.stderr.isatty():
        yield lambda stage, share: None
        return
    from rich.console import Console

    with Console(stderr=True).status(words) as status:
        yield lambda stage, share: status.update(f"{words}: {stage} {100 * min(max(share, 0.0), 1.0):.0f} %")
