"""Published results as such: what somebody printed, when the readings behind it are not known.

kind = "results"
[article]
name = "clumod-4"
[tolerance]
assumed = true               # the tolerances below are ours, not theirs; every output says so
[mass]                       # any of `validation.reduction.QUANTITIES`: mass, cog_z, Ixx ...
value = "47.400 +/- 0.024 kg"
"""

from __future__ import annotations

from collections.abc import Callable
from typing import TYPE_CHECKING

from geometry.errors import BadInput
from geometry.keys import nearest
from geometry.quantities import tagged
from validation.measurement_file import HEAD, Fields, read, shipped
from validation.reduction import QUANTITIES, Reduction

if TYPE_CHECKING:
    from uncertainties import UFloat

_DIMENSIONS = {"kg": "mass", "mm": "length", "kg m²": "moment of inertia"}
_PUBLISHABLE = tuple(key for key, (_, unit, _) in QUANTITIES.items() if unit in _DIMENSIONS)


def reduce(file: Fields, keys: tuple[str, ...] = _PUBLISHABLE) -> Reduction:
    """The published results of `file` that are among `keys`.

    Raises
    ------
    BadInput : something in the file cannot be used, or it holds none of `keys`.
    """
    file.only((*HEAD, "tolerance", *_PUBLISHABLE))
    assumed = file.inner("tolerance").only(("assumed",)).switch("assumed", False)
    results = {key: _value(file.inner(key), key, assumed) for key in _PUBLISHABLE if key in file.table and key in keys}
    if not results:
        raise BadInput(
            source=file.source, problem=f"it holds none of {', '.join(keys)}", remedy="Use weigh, cog or pendulum as fits"
        )
    return Reduction(
        title=file.text("title", "Published results"),
        origin=file.text("origin", "origin not stated"),
        article=file.inner("article").only(("name",)).text("name"),
        results=results,
        notes=("No tolerance is printed in the source; those shown are ASSUMED.",) if assumed else (),
        assumed=assumed,
    )


def readings_or_results(name: str, kind: str, readings: Callable[[Fields], Reduction], keys: tuple[str, ...]) -> Reduction:
    """The measurement file `name`: of `kind`, reduced by `readings`, or what somebody printed of `keys`.

    Raises
    ------
    BadInput : see `validation.measurement_file.read`, `readings` and `reduce`.
    """
    file = read(name, (kind, "results"))
    return readings(file) if file.text("kind") == kind else reduce(file, keys)


def reference(name: str) -> dict[str, UFloat]:
    """What is published about the article (or stored in the results file) `name`: key of `QUANTITIES` -> value, SI.

    Of an article called ``clumod-4`` it is the shipped file ``clumod-4-reference``.

    Raises
    ------
    BadInput : nothing is published about it.
    """
    articles = tuple(entry.removesuffix("-reference") for entry in shipped(("results",)) if entry.endswith("-reference"))
    if name in articles:
        return dict(reduce(read(f"{name}-reference", ("results",))).results)
    if name.endswith(".toml") or name in shipped(("results",)):
        return dict(reduce(read(name, ("results",))).results)
    remedy = f"{nearest(name, articles)}Known are {', '.join(articles)}, or a file of kind results"
    raise BadInput(source="--against", problem=f"nothing is published here about {name!r}", remedy=remedy)


def _value(fields: Fields, key: str, assumed: bool) -> UFloat:
    dimension = _DIMENSIONS[QUANTITIES[key][1]]
    value = fields.only(("value",)).quantity("value", dimension)
    return tagged(value.nominal_value, value.std_dev, "assumed tolerance" if assumed else "stated tolerance")
