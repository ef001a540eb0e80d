"""The figures beside the picture, as lines of text: what each row says, before anybody decides how it looks."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.inertia import Inertia
from validation.pictures.bodies import DrawnBody
from validation.pictures.ellipsoid import Ellipsoid
from validation.pictures.palette import AXES

MM = 1e3
NOTHING = 1e-9
"""Products smaller than this, relative to the largest moment, are rounding and print as 0."""


@dataclass(frozen=True, kw_only=True)
class Row:
    """One line: name, value, unit and, for a principal axis, its colour."""

    name: str
    value: str
    unit: str = ""
    colour: str = ""


@dataclass(frozen=True, kw_only=True)
class Block:
    """A heading, an explanation in small type, and rows."""

    heading: str
    rows: tuple[Row, ...]
    small: str = ""


def blocks(bodies: Sequence[DrawnBody], inertia: Inertia, ellipsoid: Ellipsoid) -> tuple[Block, ...]:
    """All figures of a picture, from top to bottom."""
    return (
        Block(heading="Mass", rows=(Row(name="$m$", value=f"{significant(inertia.mass, 5)}", unit="kg"),)),
        _cog(inertia),
        _tensor(inertia),
        _principal(ellipsoid),
        _ellipsoid(ellipsoid),
        _size(bodies),
    )


def significant(value: float, digits: int) -> str:
    """`value` with so many significant digits, trailing zeros kept, without an exponent while that is readable."""
    if value == 0:
        return "0"
    exponent = int(np.floor(np.log10(abs(value))))
    if not -4 <= exponent < 7:
        return f"{value:.{digits - 1}e}".replace("-", "−")
    return f"{value:.{max(digits - 1 - exponent, 0)}f}".replace("-", "−")


def millimetres(length: float, digits: int = 2) -> str:
    """`length` [m] in millimetres, without a negative zero."""
    text = f"{round(length * MM, digits) + 0.0:.{digits}f}"
    return text.replace("-", "−")


def _cog(inertia: Inertia) -> Block:
    rows = tuple(
        Row(name=f"${axis}$", value=millimetres(value), unit="mm") for axis, value in zip("xyz", inertia.cog, strict=True)
    )
    return Block(heading="Centre of gravity", small="from the origin of the frame", rows=rows)


def _tensor(inertia: Inertia) -> Block:
    zero = NOTHING * float(inertia.moments_cog.max())
    named = zip(("xx", "yy", "zz", "xy", "xz", "yz"), (*inertia.moments_cog, *inertia.products_cog), strict=True)
    rows = tuple(
        Row(name=rf"$\Theta_{{{axes}}}$", value=significant(0.0 if abs(value) < zero else value, 5), unit="kg m²")
        for axes, value in named
    )
    return Block(heading="Inertia about the CoG", small="frame axes; products as matrix entries", rows=rows)


def _principal(ellipsoid: Ellipsoid) -> Block:
    rows = tuple(
        Row(
            name=rf"$I_{i + 1}$ {direction(ellipsoid.axes[:, i])}",
            value=significant(moment, 5),
            unit="kg m²",
            colour=AXES[i],
        )
        for i, moment in enumerate(ellipsoid.moments)
    )
    return Block(heading="Principal moments", small=_freedom(ellipsoid), rows=rows)


def _freedom(ellipsoid: Ellipsoid) -> str:
    if len(ellipsoid.equal) == 2:
        return "all equal: every axis is a principal axis"
    if ellipsoid.equal:
        i, j = ellipsoid.equal[0]
        return f"{i + 1} and {j + 1} equal: any axes in their plane"
    return ""


def direction(axis: Array) -> str:
    """A unit vector (3,) in words: ``along z`` when it is a frame axis, else its components."""
    k = int(np.argmax(np.abs(axis)))
    if abs(axis[k]) > 1 - 1e-9:
        return f"along {'−' if axis[k] < 0 else ''}${'xyz'[k]}$"
    return "(" + ", ".join(f"{round(c, 3) + 0.0:.3f}" for c in axis).replace("-", "−") + ")"


def _ellipsoid(ellipsoid: Ellipsoid) -> Block:
    value = " × ".join(millimetres(semi_axis, 1) for semi_axis in ellipsoid.semi_axes)
    return Block(
        heading="Equivalent ellipsoid",
        small="homogeneous, same mass and principal moments",
        rows=(Row(name="semi-axes", value=value, unit="mm"),),
    )


def _size(bodies: Sequence[DrawnBody]) -> Block:
    points = np.concatenate([body.vertices for body in bodies if body.counted])
    value = " × ".join(millimetres(extent, 1) for extent in np.ptp(points, axis=0))
    return Block(heading="Bounding box", small="of the counted bodies", rows=(Row(name="$x, y, z$", value=value, unit="mm"),))
