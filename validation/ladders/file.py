"""The ladder beside a model file: ``model.toml`` has its rungs in ``model.ladder.json``.

One JSON object, written whole or not at all, meant to be read by people too: units stand in the keys, the model of each rung is a
list of lines. Every rung keeps the whole model, so that going back gives the very bytes. What cannot be read is refused, and
nothing is ever written over it.

``format = 1``. Other programs may rely on

    {"format": 1, "kind": "massline ladder", "model": NAME, "current": NUMBER,
     "rungs": [{"number", "parent": NUMBER|null, "cause", "effect": ID|null,
                "effects": {ID: [{"key", "value", "sd": number|null, "unit"}]},
                "errors": {"nominal_percent", "plain_percent", "heldout_nominal_percent", "heldout_percent", "fitted_chi2",
                           "fitted_degrees_of_freedom", "tolerance_z2", "tolerances", "log_evidence_nats", "converged",
                           "tolerance_z2_expected": number|null, "largest_z": number|null,
                           "held_out": [NAME], "plain_percent_by_channel": {CHANNEL: number},
                           "heldout_percent_by_fold": {NAME: number}} or null; what was not held out is null,
                "evidence_gain_nats": number|null, "verdict": [TEXT],
                "inertia": [{"article", "identified": TEN, "sd": TEN, "reference": TEN, "converged"}],
                "conditions": {"data": [{"path", "sha256"}], "hold_out": [NAME], "band_hz": [lo, hi]|null, "method"},
                "when", "versions": {}, "settings": {},
                "plain_offsets": {PARAMETER: number}, "fitted_offsets": {PARAMETER: number}, "model": [LINE]}]}
    TEN    {"mass_kg", "cog_mm": [x, y, z], "moi_cog_kgm2": [xx, yy, zz], "poi_cog_kgm2": [xy, xz, yz]}

The CoG is given from the article's own origin, moments and products about the CoG.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import fields
from math import isfinite
from pathlib import Path
from typing import Any

import numpy as np

from geometry import toml_file
from geometry.arrays import Array
from geometry.atomic import write_text
from geometry.errors import BadInput
from validation.ladders.nouns import CAUSES, Body, Conditions, Errors, Ladder, Rung, Size, Source
from validation.output import json_text

FORMAT = 1
KIND = "massline ladder"
ENDING = ".ladder.json"

_ERRORS = {
    "nominal": "nominal_percent",
    "plain": "plain_percent",
    "held_out_nominal": "heldout_nominal_percent",
    "held_out": "heldout_percent",
    "chi2": "fitted_chi2",
    "degrees_of_freedom": "fitted_degrees_of_freedom",
    "tolerance_z2": "tolerance_z2",
    "tolerances": "tolerances",
    "log_evidence": "log_evidence_nats",
    "expected_z2": "tolerance_z2_expected",
    "largest_z": "largest_z",
    "converged": "converged",
    "held_out_names": "held_out",
    "by_channel": "plain_percent_by_channel",
    "by_fold": "heldout_percent_by_fold",
}
"""Keys of `Errors` in the file."""

_LATER: Mapping[str, Any] = {"by_fold": {}, "expected_z2": None, "largest_z": None}
"""What the first ladders did not have, and stands for it."""

_TEN = {
    "mass_kg": (slice(0, 1), 1.0),
    "cog_mm": (slice(1, 4), 1e3),
    "moi_cog_kgm2": (slice(4, 7), 1.0),
    "poi_cog_kgm2": (slice(7, 10), 1.0),
}
"""Where ten values stand in a `Body`, and what they are multiplied by."""


def beside(model: Path) -> Path:
    """The ladder of the file `model`."""
    return model.with_suffix(ENDING)


def read(path: Path) -> Ladder:
    """The ladder in the file `path`.

    Raises
    ------
    BadInput : no such file; no JSON, no ladder, one of a newer program, or one that contradicts itself.
    OSError : the file cannot be read.
    """
    source = str(path)
    table = toml_file.read(path, remedy="`massline add` makes one beside a model")
    _require_ours(table, source)
    try:
        rungs = tuple(_rung(one) for one in table["rungs"])
        current = None if table["current"] is None else _whole(table["current"])
        return _sound(Ladder(rungs=rungs, current=current), source)
    except (KeyError, TypeError, ValueError, AttributeError) as error:
        if isinstance(error, BadInput):
            raise
        what = f"{error} is missing" if isinstance(error, KeyError) else str(error)
        raise _refused(source, f"it is damaged: {what}") from None


def write(path: Path, ladder: Ladder, model: str) -> None:
    """Write `ladder` to `path`, beside the file called `model`.

    Raises
    ------
    OSError : it cannot be written.
    """
    write_text(path, text(ladder, model))


def text(ladder: Ladder, model: str) -> str:
    """`ladder` as the file holds it."""
    rungs = [_rung_json(one) for one in ladder.rungs]
    return json_text({"format": FORMAT, "kind": KIND, "model": model, "current": ladder.current, "rungs": rungs}) + "\n"


def ten_json(values: Array) -> dict[str, Any]:
    """TEN of (10,) values in the order of a `Body`."""
    listed = {key: (scale * values[place]).tolist() for key, (place, scale) in _TEN.items()}
    return listed | {"mass_kg": listed["mass_kg"][0]}


def errors_json(errors: Errors) -> dict[str, Any]:
    """The errors of a rung; what was not held out, or cannot be told, is null."""
    found = {key: getattr(errors, name) for name, key in _ERRORS.items()}
    plain = {key: list(value) if isinstance(value, tuple) else value for key, value in found.items()}
    return {key: finite(value) for key, value in plain.items()} | {
        _ERRORS["by_channel"]: dict(errors.by_channel),
        _ERRORS["by_fold"]: dict(errors.by_fold),
    }


def _rung_json(one: Rung) -> dict[str, Any]:
    return {
        "number": one.number,
        "parent": one.parent,
        "cause": one.cause,
        "effect": one.effect or None,
        "effects": {name: [_size_json(size) for size in sizes] for name, sizes in one.effects.items()},
        "errors": None if one.errors is None else errors_json(one.errors),
        "evidence_gain_nats": finite(one.gain),
        "verdict": list(one.verdict),
        "inertia": [_body_json(body) for body in one.bodies],
        "conditions": _conditions_json(one.conditions),
        "when": one.when,
        "versions": dict(one.versions),
        "settings": dict(one.settings),
        "plain_offsets": dict(one.plain_offsets),
        "fitted_offsets": dict(one.fitted_offsets),
        "model": one.model.split("\n"),
    }


def _conditions_json(of: Conditions) -> dict[str, Any]:
    return {
        "data": [{"path": source.path, "sha256": source.digest} for source in of.data],
        "hold_out": list(of.hold_out),
        "band_hz": None if of.band is None else list(of.band),
        "method": of.method,
    }


def _size_json(size: Size) -> dict[str, Any]:
    return {"key": size.key, "value": size.value, "sd": finite(size.deviation), "unit": size.unit}


def _body_json(body: Body) -> dict[str, Any]:
    return {
        "article": body.article,
        "identified": ten_json(body.values),
        "sd": ten_json(body.deviation),
        "reference": ten_json(body.reference),
        "converged": body.converged,
    }


def finite(value: Any) -> Any:
    """JSON knows no infinity."""
    return None if isinstance(value, float) and not isfinite(value) else value


def _require_ours(table: Mapping[str, Any], source: str) -> None:
    if table.get("kind") != KIND or not isinstance(table.get("rungs"), list):
        raise _refused(source, "it is no ladder of massline")
    found = table.get("format")
    if isinstance(found, int) and not isinstance(found, bool) and found > FORMAT:
        problem = f"its format is {found}, written by a newer massline; this one reads {FORMAT}"
        raise BadInput(source=source, field="format", problem=problem, remedy="Use that massline. Nothing was changed")
    if found != FORMAT or isinstance(found, bool):
        raise _refused(source, f"its format must be {FORMAT}, found {found!r}")


def _refused(source: str, problem: str) -> BadInput:
    remedy = "Put back a copy that is whole, or move the file away to begin a new ladder; nothing was changed"
    return BadInput(source=source, problem=problem, remedy=remedy)


def _sound(ladder: Ladder, source: str) -> Ladder:
    """Refuse numbers that are no places, parents that did not come before, causes that nobody knows."""
    for place, one in enumerate(ladder.rungs):
        if one.number != place:
            raise _refused(source, f"it is damaged: rung {place} says that it is {one.number}")
        if one.parent is not None and not 0 <= one.parent < place:
            raise _refused(source, f"it is damaged: rung {place} comes from {one.parent}, which was not there before it")
        if one.cause not in CAUSES:
            raise _refused(source, f"it is damaged: rung {place} has the unknown cause {one.cause!r}")
    if ladder.current is not None and not 0 <= ladder.current < len(ladder.rungs):
        raise _refused(source, f"it is damaged: its current rung is {ladder.current} of {len(ladder.rungs)}")
    return ladder


def _rung(table: Mapping[str, Any]) -> Rung:
    return Rung(
        number=_whole(table["number"]),
        parent=None if table["parent"] is None else _whole(table["parent"]),
        cause=str(table["cause"]),
        effect=str(table["effect"] or ""),
        effects={str(name): tuple(map(_size, sizes)) for name, sizes in table["effects"].items()},
        errors=None if table["errors"] is None else _errors(table["errors"]),
        gain=_number_or_none(table["evidence_gain_nats"]),
        verdict=_strings(table["verdict"]),
        bodies=tuple(map(_body, table["inertia"])),
        conditions=_conditions(table["conditions"]),
        when=str(table["when"]),
        versions={str(name): str(value) for name, value in table["versions"].items()},
        settings=dict(table["settings"]),
        plain_offsets=_numbers(table["plain_offsets"]),
        fitted_offsets=_numbers(table["fitted_offsets"]),
        model="\n".join(_strings(table["model"])),
    )


def _conditions(table: Mapping[str, Any]) -> Conditions:
    band = None if table["band_hz"] is None else tuple(map(_number, table["band_hz"]))
    if band is not None and len(band) != 2:
        raise ValueError(f"a band has two ends, found {len(band)}")
    return Conditions(
        data=tuple(Source(path=str(one["path"]), digest=str(one["sha256"])) for one in table["data"]),
        hold_out=_strings(table["hold_out"]),
        band=None if band is None else (band[0], band[1]),
        method=str(table["method"]),
    )


def _size(table: Mapping[str, Any]) -> Size:
    return Size(
        key=str(table["key"]), value=_number(table["value"]), unit=str(table["unit"]), deviation=_number_or_none(table["sd"])
    )


def _errors(table: Mapping[str, Any]) -> Errors:
    found = {name: table.get(key, _LATER[name]) if name in _LATER else table[key] for name, key in _ERRORS.items()}
    for one in fields(Errors):
        value = found[one.name]
        if one.name == "held_out_names":
            found[one.name] = _strings(value)
        elif one.name in ("by_channel", "by_fold"):
            found[one.name] = _numbers(value)
        elif one.name == "converged":
            found[one.name] = bool(value)
        elif one.type == "int":
            found[one.name] = _whole(value)
        elif one.type == "float":
            found[one.name] = float("nan") if value is None else _number(value)
        else:
            found[one.name] = _number_or_none(value)
    return _positive(Errors(**found))


def _positive(errors: Errors) -> Errors:
    """Refuse what is negative of the errors, which are roots of squares and sums of them."""
    for name in ("nominal", "plain", "held_out_nominal", "held_out", "chi2", "tolerance_z2"):
        if (getattr(errors, name) or 0.0) < 0:
            raise ValueError(f"{_ERRORS[name]} is negative, {getattr(errors, name):g}")
    return errors


def _body(table: Mapping[str, Any]) -> Body:
    return Body(
        article=str(table["article"]),
        values=_ten(table["identified"]),
        deviation=_ten(table["sd"]),
        reference=_ten(table["reference"]),
        converged=bool(table["converged"]),
    )


def _ten(table: Mapping[str, Any]) -> Array:
    return np.concatenate([np.ravel(np.asarray(table[key], dtype=np.float64)) / scale for key, (_, scale) in _TEN.items()])


def _strings(value: Any) -> tuple[str, ...]:
    if not isinstance(value, list) or not all(isinstance(one, str) for one in value):
        raise TypeError(f"a list of texts is expected, found {value!r:.60}")
    return tuple(value)


def _numbers(table: Mapping[str, Any]) -> dict[str, float]:
    return {str(name): _number(value) for name, value in table.items()}


def _number_or_none(value: Any) -> float | None:
    return None if value is None else _number(value)


def _number(value: Any) -> float:
    if isinstance(value, bool) or not isinstance(value, int | float):
        raise TypeError(f"a number is expected, found {value!r:.60}")
    return float(value)


def _whole(value: Any) -> int:
    if isinstance(value, bool) or not isinstance(value, int):
        raise TypeError(f"a whole number is expected, found {value!r:.60}")
    return value
