"""Complex linear equations for ten real unknowns: weighted, robust, and refused where they leave a combination open."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.inertia import PARAMETERS
from geometry.observability import combination
from identification.robust import WEIGHTS, scale
from identification.unidentifiable import Unidentifiable

OPEN = 1e-8
"""Singular value, relative to the largest, below which equations of scaled unknowns say nothing: what is left is rounding."""

ROUNDING = 1e-9
"""Residuals, relative to the values, below which none of them is an outlier: exact data have nothing but rounding."""

SHARE = 0.05
"""Share of the largest from which a parameter counts as part of the combination that is open."""

STEADY, ROUNDS = 1e-10, 100
"""Relative change of the parameters at which reweighting ends, and after how many rounds at the latest."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Equations:
    """Whitened equations ``rows @ p = values`` in groups of numbers that belong together.

    Attributes
    ----------
    rows : (g, s, 10) complex
    values : (g, s) complex
    left : (g, s, 10) complex, what the residual is orthogonal to: `rows` in least squares, rows without their noise in errors in
        variables
    """

    rows: ComplexArray
    values: ComplexArray
    left: ComplexArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Solution:
    """What the equations say.

    Attributes
    ----------
    parameters : (10,)
    inverse : (10, 10) covariance of the parameters where every whitened number has E|noise|² = 1
    size : (g,) rms of the residuals of each group
    weight : (g,) robust weight of each group
    singular_values : (10,) of the equations, every unknown scaled to a column of length 1; descending
    """

    parameters: Array
    inverse: Array
    size: Array
    weight: Array
    singular_values: Array


def solve(equations: Equations, robust: str = "") -> Solution:
    """The ten parameters, robust in the way `robust` of `WEIGHTS`.

    Raises
    ------
    BadInput : `robust` is no such way.
    Unidentifiable : the equations leave a combination of the ten parameters open.
    """
    require_known(robust)
    weight = np.ones(len(equations.values))
    found = _weighted(equations, weight)
    least = ROUNDING * float(np.sqrt(np.mean(np.abs(equations.values) ** 2))) or 1.0
    for _ in range(ROUNDS if robust else 0):
        before, size = found.parameters, found.size
        found = _weighted(equations, WEIGHTS[robust](size / max(scale(size, equations.values.shape[1]), least)))
        if np.linalg.norm(found.parameters - before) <= STEADY * np.linalg.norm(before):
            break
    return found


def require_known(robust: str) -> None:
    """`robust` is a way of `WEIGHTS`.

    Raises
    ------
    BadInput : it is not.
    """
    if robust not in WEIGHTS:
        known = ", ".join(repr(name) for name in WEIGHTS)
        problem = f"must be one of {known}, found {robust!r}"
        raise BadInput(source="ten parameters", field="robust", problem=problem, remedy="Take one of these")


def _weighted(equations: Equations, weight: Array) -> Solution:
    root = np.sqrt(weight)[:, None]
    A, Z = _real(equations.rows * root[:, :, None]), _real(equations.left * root[:, :, None])
    b = _real(equations.values * root)
    length = np.maximum(np.linalg.norm(Z, axis=0), np.finfo(np.float64).tiny)
    left, singular, right = np.linalg.svd(Z / length, full_matrices=False)
    _require_determined(singular, right)
    # Z = left s right: the normal equations Z^T A p = Z^T b without squaring the condition number.
    inner = left.T @ A
    p = np.linalg.solve(inner, left.T @ b)
    residual = equations.values - equations.rows @ p
    half = (right / singular[:, None]) / length
    return Solution(
        parameters=np.asarray(p, dtype=np.float64),
        inverse=half.T @ half / 2,
        size=np.sqrt(np.mean(np.abs(residual) ** 2, axis=1)),
        weight=weight,
        singular_values=singular,
    )


def _real(values: ComplexArray) -> Array:
    """Real parts above imaginary parts; the groups side by side."""
    flat = values.reshape(values.shape[0] * values.shape[1], *values.shape[2:])
    return np.concatenate([flat.real, flat.imag])


def _require_determined(singular: Array, right: Array) -> None:
    if singular[-1] > OPEN * singular[0]:
        return
    null = right[singular <= OPEN * singular[0]]
    share = np.linalg.norm(null, axis=0)
    open_ = tuple(name for name, part in zip(PARAMETERS, share, strict=True) if part >= SHARE * share.max())
    told = f"{len(singular) - len(null)} of ten combinations are told"
    mixed = (
        "" if len(null) == len(open_) else f"; the data say nothing of {_said(null)}" if len(null) == 1 else "; they are mixed"
    )
    raise Unidentifiable(
        f"The data leave {', '.join(open_)} open: {told}{mixed}. Drive the base motions that these act on, in runs of their own",
        singular_values=singular,
        null_direction=right[-1],
        undetermined=open_,
    )


def _said(null: Array) -> str:
    kept = np.where(np.abs(null[0]) >= SHARE * np.abs(null[0]).max(), null[0], 0)
    return f"{combination(kept, PARAMETERS)} (each as a share of what it does in the data)"
