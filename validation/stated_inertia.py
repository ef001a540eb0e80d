"""Ten parameters as a person writes them: the ``[inertia]`` table of a result file and of the published data.

=========== =====================================================================================================================
key         meaning
=========== =====================================================================================================================
about       the point of the moments and products: "cog" (default), "origin", or three numbers and a unit, in the file's own frame
mass        with its unit, as every value; a value without "+/-" is taken as known to half a unit of its last digit
cog         three, from the origin of the file's own frame; or instead
first_moment three, mass times CoG *from the point `about`* (Eq. 4: m x, m y, m z)
moments     Θxx, Θyy, Θzz about `about`
products    Θxy, Θxz, Θyz about `about`, with the sign that ``products_sign`` states: "matrix-entry", -∫xy dm, as in Eq. 4, or
            "positive-integral", +∫xy dm, as SolidWorks and others print; there is no default
=========== =====================================================================================================================

Beside it, at most one of ``[tolerance]`` (a half-width for each group, absolute or per cent), ``[interval95]`` (low and high for
each value) and `covariance` (10x10, SI, in the order mass, cog or first_moment, moments, products; half-widths are 1.96 standard
deviations). Values left out, or "not stated", stay unstated, and so does what would follow from them.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geometry import keys
from geometry.arrays import Array, frozen
from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.inertia import parallel_axis, six_from_tensor, tensor_from_six
from identification.quality import NORMAL_95
from validation import printed
from validation.frame_text import position
from validation.statement import COG, MASS, TENSOR, Stated, Statement, through

TABLES = ("name", "source", "inertia", "tolerance", "interval95", "covariance")
MATRIX_ENTRY, POSITIVE_INTEGRAL = "matrix-entry", "positive-integral"

_GROUPS = {
    "mass": (slice(0, 1), "mass"),
    "cog": (COG, "length"),
    "first_moment": (COG, "first moment"),
    "moments": (slice(4, 7), "moment of inertia"),
    "products": (slice(7, 10), "moment of inertia"),
}
_INERTIA = ("about", *_GROUPS, "products_sign")


@dataclass(frozen=True, eq=False, kw_only=True)
class _Form:
    """In which form the ten values stand: `about` is None for the CoG, else the point (3,) [m]."""

    about: Array | None
    first_moment: bool
    sign: float


def read(table: Mapping[str, Any], source: str, frame: Pose) -> Statement:
    """The statement that `table` makes, carried into the outer frame in which `frame` is the pose of the file's own.

    Raises
    ------
    BadInput : unknown or missing keys, a missing unit or another dimension, contradictory or unusable tolerances.
    """
    keys.require_present(table, ["inertia"], source=source)
    inertia = keys.require_table(table["inertia"], source=source, where="inertia")
    keys.require_known(inertia, _INERTIA, source=source, where="inertia")
    form = _form(inertia, source)
    values = tuple(stated for key in _used(form) for stated in _group(inertia, key, source))
    values, spread, note = _with_tolerances(values, table, form, source)
    mass = values[MASS]
    if form.first_moment and (mass is None or mass.value == 0):
        raise BadInput(
            source=source, field="inertia.mass", problem="a first moment says nothing without a mass", remedy="State the mass"
        )
    return Statement(
        name=str(table.get("name", "result")),
        values=through(_into(frame, form), values, spread),
        source=str(table.get("source", source)),
        tolerance_note=note,
    )


def _form(inertia: Mapping[str, Any], source: str) -> _Form:
    if ("cog" in inertia) and ("first_moment" in inertia):
        raise BadInput(source=source, field="inertia", problem="states both cog and first_moment", remedy="Keep one of them")
    about, first_moment = inertia.get("about", "cog"), "first_moment" in inertia
    if about == "cog" and first_moment:
        raise BadInput(
            source=source,
            field="inertia.first_moment",
            problem="a first moment about the CoG is zero",
            remedy='State the point it is about, about = "origin" or "0 0 45 mm"',
        )
    point = None if about == "cog" else np.zeros(3) if about == "origin" else position(about, source, "inertia.about")
    return _Form(about=point, first_moment=first_moment, sign=_sign(inertia, source))


def _sign(inertia: Mapping[str, Any], source: str) -> float:
    if "products" not in inertia and "products_sign" not in inertia:
        return 1.0
    choices = (MATRIX_ENTRY, POSITIVE_INTEGRAL)
    if "products_sign" not in inertia:
        raise BadInput(
            source=source,
            field="inertia.products_sign",
            problem="is missing; products of inertia go by two signs",
            remedy=f'Write "{MATRIX_ENTRY}" for -∫xy dm (Eq. 4) or "{POSITIVE_INTEGRAL}" for +∫xy dm',
        )
    word = keys.one_of(inertia["products_sign"], choices, source=source, where="inertia.products_sign")
    return 1.0 if word == MATRIX_ENTRY else -1.0


def _used(form: _Form) -> tuple[str, ...]:
    return ("mass", "first_moment" if form.first_moment else "cog", "moments", "products")


def _group(table: Mapping[str, Any], key: str, source: str) -> list[Stated | None]:
    span, dimension = _GROUPS[key]
    length = span.stop - span.start
    entries = _entries(table.get(key, [None] * length if length > 1 else None), length, source, f"inertia.{key}")
    return [printed.stated(entry, dimension, source, f"inertia.{key}") for entry in entries]


def _entries(value: Any, length: int, source: str, field: str) -> list[Any]:
    entries = [value] if length == 1 else value
    if not isinstance(entries, list) or len(entries) != length:
        raise BadInput(
            source=source,
            field=field,
            problem=f"must be a list of {length} values, found {value!r}",
            remedy='Write each with its unit; "not stated" holds a place',
        )
    return entries


def _with_tolerances(
    values: tuple[Stated | None, ...], table: Mapping[str, Any], form: _Form, source: str
) -> tuple[tuple[Stated | None, ...], Array | None, str]:
    """The values with the tolerance of whichever table is there, their squares when they are correlated, and a note."""
    given = [key for key in ("tolerance", "interval95", "covariance") if key in table]
    if len(given) > 1:
        raise BadInput(source=source, problem=f"states {' and '.join(given)}", remedy="Keep one of them")
    if not given:
        return values, None, "as stated with each value; without one, half a unit of the last digit given"
    read = {"tolerance": _half_widths, "interval95": _intervals, "covariance": _covariance}[given[0]]
    return read(values, table, form, source)


_Toleranced = tuple[tuple[Stated | None, ...], Array | None, str]


def _half_widths(values: tuple[Stated | None, ...], table: Mapping[str, Any], form: _Form, source: str) -> _Toleranced:
    widths = keys.require_table(table["tolerance"], source=source, where="tolerance")
    keys.require_known(widths, (*_used(form), "note"), source=source, where="tolerance")
    result = list(values)
    for key in filter(widths.__contains__, _used(form)):
        span, dimension = _GROUPS[key]
        length = span.stop - span.start
        several = isinstance(widths[key], list) and length > 1
        entries = _entries(widths[key], length, source, f"tolerance.{key}") if several else [widths[key]] * length
        for k, each in zip(range(span.start, span.stop), entries, strict=True):
            stated = result[k]
            if stated is not None:
                width = printed.tolerance(each, dimension, stated.value, source, f"tolerance.{key}")
                result[k] = replace(stated, tolerance=width)
    return tuple(result), None, str(widths.get("note", "as stated"))


def _intervals(values: tuple[Stated | None, ...], table: Mapping[str, Any], form: _Form, source: str) -> _Toleranced:
    intervals = keys.require_table(table["interval95"], source=source, where="interval95")
    keys.require_known(intervals, _used(form), source=source, where="interval95")
    result = list(values)
    for key in filter(intervals.__contains__, _used(form)):
        span, dimension = _GROUPS[key]
        field = f"interval95.{key}"
        ends = [intervals[key]] if key == "mass" else _entries(intervals[key], 3, source, field)
        for k, pair in zip(range(span.start, span.stop), ends, strict=True):
            low, high = (printed.stated(end, dimension, source, field) for end in _entries(pair, 2, source, field))
            if result[k] is not None and low is not None and high is not None:
                result[k] = with_interval(result[k], low.value, high.value, source, field)
    return tuple(result), None, "95 % intervals"


def with_interval(stated: Stated | None, low: float, high: float, source: str, field: str) -> Stated | None:
    """`stated` with the distance to the farther end of its interval [SI] as tolerance.

    Raises
    ------
    BadInput : the value lies outside its interval.
    """
    if stated is None:
        return None
    if not low <= stated.value <= high:
        raise BadInput(
            source=source,
            field=field,
            problem=f"the value {stated.value:.6g} lies outside its interval {low:.6g} to {high:.6g} (SI)",
            remedy="Give low and high in this order, around the value",
        )
    return replace(stated, tolerance=max(high - stated.value, stated.value - low))


def _covariance(values: tuple[Stated | None, ...], table: Mapping[str, Any], form: _Form, source: str) -> _Toleranced:
    if None in values:
        raise BadInput(source=source, field="covariance", problem="needs all ten values", remedy="State them, or use [tolerance]")
    try:
        C = frozen(table["covariance"], (10, 10), "covariance")
    except (ValueError, TypeError) as error:
        raise BadInput(
            source=source, field="covariance", problem=str(error), remedy="Write ten lists of ten numbers, SI"
        ) from None
    scale = np.sqrt(np.abs(np.diag(C)))
    correlation = C / np.outer(scale, scale) if np.all(scale > 0) else np.full((10, 10), np.nan)
    if not np.allclose(correlation, correlation.T, rtol=0, atol=1e-9) or np.linalg.eigvalsh(correlation)[0] < -1e-9:
        problem = "must be symmetric and positive, found a matrix that is no covariance"
        raise BadInput(source=source, field="covariance", problem=problem, remedy="Check its order and units (SI)")
    toleranced = tuple(v and replace(v, tolerance=float(NORMAL_95 * s)) for v, s in zip(values, scale, strict=True))
    return toleranced, NORMAL_95**2 * C, "1.96 standard deviations of the stated covariance"


def _into(frame: Pose, form: _Form) -> Callable[[Array], Array]:
    """From the ten values as they stand to those about the CoG in the outer frame."""

    def change(values: Array) -> Array:
        mass, vector, six = values[MASS], values[COG], values[TENSOR] * _signs(form.sign)
        about = form.about if form.about is not None else vector
        lever = vector / mass if form.first_moment else vector - about
        tensor = tensor_from_six(six) - parallel_axis(mass, lever)
        R = frame.rotation
        return np.concatenate([values[:1], frame.apply(about + lever), six_from_tensor(R @ tensor @ R.T)])

    return change


def _signs(sign: float) -> Array:
    return np.array([1.0, 1.0, 1.0, sign, sign, sign])
