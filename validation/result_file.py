"""Somebody's identified ten parameters, from a file: our own format, what `massline identify --json` prints, or a bare INERTIA.

`validation.stated_inertia` documents the tables that hold the values. Around them stand

- ``format = 1``;
- `article`, optional: what was identified; a result about another article than the one at hand is refused;
- `frame`, optional: where the file's own frame sits in the article's (see `validation.frame_text`); left out, the file is taken
  to be in the frame in which it is to be shown, by default the article's.

The same may be written in JSON. Missing values are allowed and come out as not stated.
"""

from __future__ import annotations

import difflib
from dataclasses import dataclass
from pathlib import Path
from typing import Any

from geometry import keys, toml_file
from geometry.articles import NAMES
from geometry.errors import BadInput
from geometry.frames import Pose
from validation import published, stated_inertia
from validation.frame_text import pose_of
from validation.statement import Stated, Statement, seen_from

_PRINTED = {"mass_kg": (1.0, 1), "cog_mm": (1e-3, 3), "moi_cog_kgm2": (1.0, 3), "poi_cog_kgm2": (1.0, 3)}
"""Keys of INERTIA: factor to SI and length."""

_IDENTIFY = ("inertia", "origin", "interval95")


@dataclass(frozen=True, eq=False, kw_only=True)
class Result:
    """A result as read.

    Attributes
    ----------
    statement : in the frame in which it is to be shown
    warnings : what is odd about the file, in words
    """

    statement: Statement
    warnings: tuple[str, ...] = ()


def read(name: str, *, article: str, frame: Pose | None = None, way: str = "") -> Result:
    """The result in the file `name`, or in print under that name, about `article`, seen from `frame` (its pose in the article's).

    `way` picks one of the results of an identification, "plain" or "self-calibrated"; by default it is the one that counts.

    Raises
    ------
    BadInput : not TOML or JSON, about another article, none of the forms, unknown keys, missing units, a frame that is not known.
    OSError : the file cannot be read.
    """
    table = _table(name)
    warnings = _about_another(table.get("article", article), name, article)
    return Result(statement=_statement(_of_way(table, way, name), name, article, frame), warnings=warnings)


def _of_way(table: dict[str, Any], way: str, name: str) -> dict[str, Any]:
    """An identification's `table` with the result of `way` in the place of the one that counts."""
    if not way:
        return table
    key = way.replace("-", "_")
    if not isinstance(table.get(key), dict):
        raise BadInput(source=name, field=key, problem=f"there is no {way} result", remedy="Give the JSON of `massline identify`")
    return {**table, **{part: table[key].get(part) for part in ("inertia", "interval95")}}


def _about_another(about: object, name: str, article: str) -> tuple[str, ...]:
    """Refuse a result about another article; between a user's own names, which may mean the same, it is only said."""
    path = Path(article)
    if isinstance(about, str) and _plain(about) in map(_plain, (article, path.name, path.stem)):
        return ()
    problem = f"it says that it is about {about if isinstance(about, str) else repr(about)}, held against {article}"
    if isinstance(about, str) and not _is_built_in(about) and not _is_built_in(article):
        return (f"{name}: {problem}",)
    raise BadInput(source=name, field="article", problem=problem, remedy="Name the same article, or correct the file")


def _plain(article: str) -> str:
    return "".join(article.split()).lower()


def _is_built_in(article: str) -> bool:
    return set(article.split("+")) <= set(NAMES)


def _table(name: str) -> dict[str, Any]:
    if name in published.RESULTS and not Path(name).exists():
        return published.result_table(name)
    remedy = f"{keys.nearest(name, published.RESULTS)}Give a result file, or one that ships: {', '.join(published.RESULTS)}"
    return toml_file.read(name, remedy=remedy)


def _statement(table: dict[str, Any], name: str, article: str, frame: Pose | None) -> Statement:
    if "format" in table:
        return _own_format(table, name, frame or Pose())
    if "mass_kg" in table:
        return _from_inertia(table, name)
    if any(key in table for key in _IDENTIFY[1:]) and "inertia" in table:
        return _identified(table, name, article, frame)
    raise BadInput(
        source=name,
        field="format",
        problem=f"is none of the forms that can be read, found the keys {', '.join(table) or '(none)'}",
        remedy=("Did you mean format? " if difflib.get_close_matches("format", list(table)) else "")
        + "Write format = 1 and an [inertia] table, or give the JSON of `massline identify`",
    )


def _own_format(table: dict[str, Any], name: str, shown: Pose) -> Statement:
    toml_file.require_format(table, name)
    keys.require_known(table, ("format", "article", "frame", *stated_inertia.TABLES), source=name)
    own = shown.inverse @ pose_of(table["frame"], name) if "frame" in table else Pose()
    return stated_inertia.read(table, name, own)


def _identified(table: dict[str, Any], name: str, article: str, frame: Pose | None) -> Statement:
    if table.get("origin") == "F" and frame is None and not article.startswith("fmd"):
        raise BadInput(
            source=name,
            field="origin",
            problem=f"the CoG is stated from F, and {article} does not say where F is",
            remedy='Say where F is in the article\'s frame, for example --frame "0 0 -45 mm"',
        )
    inertia = keys.require_table(table["inertia"], source=name, where="inertia")
    intervals = keys.require_table(table.get("interval95") or {}, source=name, where="interval95")
    said = _from_inertia(inertia, name, intervals)
    if not table.get("frame"):
        return said
    return seen_from(said, pose_of(table["frame"], name).inverse @ (frame or Pose()))


def _from_inertia(inertia: dict[str, Any], name: str, intervals: dict[str, Any] | None = None) -> Statement:
    keys.require_present(inertia, _PRINTED, source=name)
    if inertia.get("about", "cog") != "cog":
        problem = f'INERTIA is about "cog", found {inertia["about"]!r}'
        raise BadInput(source=name, field="about", problem=problem, remedy="State another point in a file of format = 1")
    values: list[Stated | None] = []
    for key, (factor, length) in _PRINTED.items():
        ends = _list((intervals or {}).get(key), length, name, f"interval95.{key}")
        for value, pair in zip(_list(inertia[key], length, name, key), ends, strict=True):
            values.append(_one(value, pair, factor, name, key))
    note = "95 % intervals" if intervals else "none stated"
    return Statement(name="identified", values=tuple(values), source=name, tolerance_note=note)


def _list(value: Any, length: int, name: str, field: str) -> list[Any]:
    if value is None:
        return [None] * length
    listed = [value] if length == 1 else value
    if not isinstance(listed, list) or len(listed) != length:
        raise BadInput(source=name, field=field, problem=f"must be a list of {length}, found {value!r}", remedy="See INERTIA")
    return listed


def _one(value: Any, pair: Any, factor: float, name: str, field: str) -> Stated | None:
    if value is None:
        return None
    stated = Stated(value=_finite(value, name, field) * factor)
    if pair is None:
        return stated
    low, high = (_finite(end, name, f"interval95.{field}") * factor for end in _list(pair, 2, name, f"interval95.{field}"))
    return stated_inertia.with_interval(stated, low, high, name, f"interval95.{field}")


def _finite(value: Any, name: str, field: str) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float) or not abs(value) < float("inf"):
        raise BadInput(source=name, field=field, problem=f"must be a finite number, found {value!r}", remedy="Correct it")
    return float(value)
