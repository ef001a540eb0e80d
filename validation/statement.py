"""`Statement`: what somebody says about a body's inertia - a route, a table in print, a balance, an identification.

A statement holds up to ten values in the form in which tables print them: the mass, the CoG from the frame's origin, and moments
and products *about the CoG*, products as matrix entries. Unlike `Inertia` it may be partial (the paper prints no products), and
each value carries its tolerance and the decimals that were printed. Seeing it from another frame keeps what can be kept: a value
that would need an unstated one becomes unstated itself.

Tolerances go through linearised, independent ones in quadrature; they are small beside the values, and every map here is a
polynomial of low degree.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.frames import Pose
from geometry.inertia import Inertia, six_from_tensor, tensor_from_six


@dataclass(frozen=True, eq=False, kw_only=True)
class Quantity:
    """One of the ten values of a statement.

    Attributes
    ----------
    key : as in CSV and messages
    label : as printed
    unit : as printed
    per_si : printed value of one SI unit
    """

    key: str
    label: str
    unit: str
    per_si: float = 1.0


QUANTITIES = (
    Quantity(key="mass", label="Mass m", unit="kg"),
    *(Quantity(key=f"cog_{axis}", label=f"CoG {axis}", unit="mm", per_si=1e3) for axis in "xyz"),
    *(Quantity(key=f"moi_{axes}", label=f"MoI Θ{axes}", unit="kg m²") for axes in ("xx", "yy", "zz")),
    *(Quantity(key=f"poi_{axes}", label=f"PoI Θ{axes}", unit="kg m²") for axes in ("xy", "xz", "yz")),
)
"""The ten values in the order of a statement, which is that of Eq. 4."""

MASS, COG, TENSOR = 0, slice(1, 4), slice(4, 10)


@dataclass(frozen=True, eq=False, kw_only=True)
class Stated:
    """One stated value.

    Attributes
    ----------
    value : [SI]
    tolerance : [SI], None where none is stated
    decimals : decimals printed in the unit of its `Quantity`; None where nothing was printed
    """

    value: float
    tolerance: float | None = None
    decimals: int | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class Statement:
    """Up to ten values about the CoG, in the axes and from the origin of one frame.

    Attributes
    ----------
    name : heading of its column
    values : ten, in the order of `QUANTITIES`; None where not stated
    source : where it comes from: a table's number, a file, a route
    tolerance_note : what its tolerances are and how they came about, in words; says *assumed* where they are
    """

    name: str
    values: tuple[Stated | None, ...]
    source: str = ""
    tolerance_note: str = ""

    @property
    def complete(self) -> bool:
        """Whether all ten values are stated."""
        return None not in self.values

    @property
    def inertia(self) -> Inertia:
        """The stated body, products that are not stated taken as zero; about the frame's origin.

        Raises
        ------
        ValueError : the mass, the CoG or a moment is not stated.
        """
        missing = [q.label for q, stated in zip(QUANTITIES[:7], self.values, strict=False) if stated is None]
        if missing:
            raise ValueError(f"`values` must state mass, CoG and moments to be a body, {', '.join(missing)} not stated")
        return inertia_of(np.array([0.0 if stated is None else stated.value for stated in self.values]))


def about_cog(inertia: Inertia) -> Array:
    """Ten values of a statement from `inertia`: mass, CoG in the body's frame, moments and products about the CoG; SI."""
    return np.concatenate([[inertia.mass], inertia.cog, inertia.moments_cog, inertia.products_cog])


def inertia_of(values: npt.ArrayLike) -> Inertia:
    """The body with the ten `values` of a statement [SI], about the frame's origin."""
    v = np.asarray(values, dtype=np.float64)
    return Inertia.from_cog(v[MASS], v[COG], tensor_from_six(v[TENSOR]))


def seen_from(said: Statement, frame: Pose) -> Statement:
    """`said` from the origin and along the axes of `frame`, whose pose is given in the frame of `said`."""
    R, p = frame.rotation, frame.position

    def change(values: Array) -> Array:
        tensor = R.T @ tensor_from_six(values[TENSOR]) @ R
        return np.concatenate([values[:1], R.T @ (values[COG] - p), six_from_tensor(tensor)])

    values = through(change, said.values)
    lengths, moments = _largest(said.values[COG], *p), _largest(said.values[TENSOR])
    size = (0.0, *[lengths] * 3, *[moments] * 6)
    # The cosine of 90 degrees is not quite zero; what it leaves behind is.
    kept = (v if v is None or abs(v.value) > _LEFT * s else replace(v, value=0.0) for v, s in zip(values, size, strict=True))
    return replace(said, values=tuple(kept))


def _largest(values: Sequence[Stated | None], *more: float) -> float:
    return max((abs(v) for v in (*(s.value for s in values if s is not None), *more)), default=0.0)


def through(
    change: Callable[[Array], Array], values: Sequence[Stated | None], spread: Array | None = None
) -> tuple[Stated | None, ...]:
    """Ten `values` taken through `change`, a map of (10,) [SI] to (10,) [SI], with tolerance and printed decimals.

    `spread` (10, 10) is the square of the tolerances with what they share; by default they are independent.
    """
    stated = np.array([v is not None for v in values])
    point = np.array([0.0 if v is None else v.value for v in values])
    tolerance = np.array([0.0 if v is None or v.tolerance is None else v.tolerance for v in values])
    with_tolerance = np.array([v is not None and v.tolerance is not None for v in values])
    J = jacobian(change, point)
    # An unstated value stands in with a value that is nobody's zero, so that no dependence on it hides.
    depends = np.abs(jacobian(change, np.where(stated, point, _NOBODYS_ZERO))) > _SEEN
    result = change(point)
    squares = np.diag(tolerance**2) if spread is None else spread
    tolerances = np.sqrt(np.maximum(np.diag(J @ squares @ J.T), 0.0))

    def one(k: int) -> Stated | None:
        if np.any(depends[k] & ~stated):
            return None
        decimals = [v.decimals for v, used in zip(values, depends[k], strict=True) if used and v is not None]
        return Stated(
            value=float(result[k]),
            tolerance=float(tolerances[k]) if np.any(depends[k] & with_tolerance) else None,
            decimals=max((d for d in decimals if d is not None), default=None),
        )

    return tuple(one(k) for k in range(10))


def jacobian(change: Callable[[Array], Array], point: Array) -> Array:
    """Derivatives (10, 10) of `change` at `point` by central differences."""
    # All but the mass enter as polynomials of second degree, for which central differences are exact at any step.
    step = 1e-4 * np.maximum(np.abs(point), 1.0)
    step[MASS] = 1e-4 * (abs(point[MASS]) or 1.0)
    columns = [(change(point + h) - change(point - h)) / (2 * h[k]) for k, h in enumerate(np.diag(step))]
    J = np.column_stack(columns)
    whole = np.round(J)
    return np.where(np.abs(J - whole) < _SEEN, whole, J)


_NOBODYS_ZERO = np.array([0.917, 0.331, 0.457, 0.593, 0.709, 0.811, 0.929, 0.137, 0.173, 0.219])
_SEEN = 1e-9
_LEFT = 1e-13
