"""`Cost`: what a fit makes small: half the squares of misfit, of facts, and of what is known beforehand."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.errors import CheckFailed
from geometry.frames import Array
from identification.self_calibration.solve import Normal, total
from validation.estimation import likelihood
from validation.estimation.likelihood import ObservedLines
from validation.estimation.problem import Lines, Offsets, Parameter, Predicted, Prediction, Problem

NOTHING: Offsets = MappingProxyType({})


@dataclass(frozen=True, eq=False, kw_only=True)
class Cost:
    """Of a problem in some of its parameters.

    Attributes
    ----------
    problem : what is compared
    free : (p,) the parameters that move
    floor : model-error floor, relative
    base : offsets at which the others stand, those of the model where nothing is said
    held : parameters of the fit that stand at a bound; what is known of them counts
    plain : whether declared parameters stay within what a plain fit allows them
    """

    problem: Problem
    free: tuple[Parameter, ...]
    floor: float
    base: Offsets = field(default_factory=lambda: NOTHING)
    held: tuple[Parameter, ...] = ()
    plain: bool = False
    observed: tuple[tuple[Prediction, Lines, ObservedLines], ...] = field(default=(), repr=False)

    def __post_init__(self) -> None:
        if not self.observed:
            chosen = ((one, self.problem.lines_of(one)) for one in self.problem.predictions)
            object.__setattr__(
                self, "observed", tuple((one, lines, likelihood.observed(one.measured, lines)) for one, lines in chosen)
            )

    @cached_property
    def names(self) -> tuple[str, ...]:
        """(p,) of the free parameters."""
        return tuple(one.name for one in self.free)

    @cached_property
    def bounds(self) -> tuple[Array, Array]:
        """(p,) least and (p,) greatest offsets of the free parameters."""
        pairs = np.array([one.bounds(plain=self.plain) for one in self.free]).reshape(-1, 2)
        return pairs[:, 0], pairs[:, 1]

    def offsets(self, x: Array) -> dict[str, float]:
        """Of all parameters, the free ones at `x` (p,)."""
        return {**self.problem.start, **self.base, **dict(zip(self.names, map(float, x), strict=True))}

    def at(self, offsets: Offsets) -> Array:
        """(p,) of the free parameters from `offsets`, those of the model where nothing is said."""
        return np.array([offsets.get(one.name, one.start) for one in self.free])

    def holding(self, held: Mapping[str, float]) -> Cost:
        """The same with the parameters `held` at these offsets, and all others of the fit free."""
        everything = (*self.free, *self.held)
        return replace(
            self,
            free=tuple(one for one in everything if one.name not in held),
            held=tuple(one for one in everything if one.name in held),
            base={**self.base, **held},
        )

    def by_run(self, x: Array) -> dict[tuple[str, str], Normal]:
        """Normal equations of the data at `x` (p,) by data set and run."""
        found: dict[tuple[str, str], Normal] = {}
        offsets = self.offsets(x)
        for prediction, lines, seen in self.observed:
            predicted = prediction.at(offsets, lines, derivatives=frozenset(self.names))
            for run, one in likelihood.normals(seen, predicted, self.names, self.floor).items():
                found[prediction.measured.name, run] = one
        return found

    def data(self, x: Array) -> Normal:
        """Normal equations of all data at `x` (p,)."""
        return total(self.by_run(x).values(), len(self.free))

    def knowledge(self, x: Array) -> tuple[Array, Array]:
        """Whitened residuals (q,) at `x` (p,) of what is known beforehand and of facts, and their derivatives (q, p)."""
        sd = np.array([one.tolerance for one in self.free])
        known = np.isfinite(sd)
        away, rows = x[known] / sd[known], np.eye(len(sd))[known] / sd[known, None]
        still = np.array([self.base[one.name] / one.tolerance for one in self.held])
        left, change = self._facts(x)
        return np.concatenate([away, still, left]), np.vstack([rows, np.zeros((len(still), len(sd))), change])

    def _facts(self, x: Array) -> tuple[Array, Array]:
        said = [fact.residual(self.offsets(x)) for fact in self.problem.facts]
        rows = np.array([[slopes.get(name, 0.0) for name in self.names] for _, slopes in said])
        return np.array([left for left, _ in said]), rows.reshape(len(said), len(self.names))

    def total(self, x: Array, data: Normal | None = None) -> tuple[Normal, Normal, float]:
        """At `x` (p,): all as one, the `data` alone, which may be known already, and chi² of data and facts."""
        data = self.data(x) if data is None else data
        away, rows = self.knowledge(x)
        whole = Normal(
            cost=data.cost + 0.5 * float(away @ away),
            gradient=data.gradient + rows.T @ away,
            matrix=data.matrix + rows.T @ rows,
        )
        left, _ = self._facts(x)
        return whole, data, 2 * data.cost + float(left @ left)

    def predicted(self, x: Array) -> list[tuple[ObservedLines, Predicted]]:
        """At `x` (p,) without derivatives, by data set."""
        offsets = self.offsets(x)
        return [(seen, one.at(offsets, lines, derivatives=False)) for one, lines, seen in self.observed]

    def size(self, x: Array) -> int:
        """Real numbers that the data leave when latent inputs are taken out, and the facts; counted at `x` (p,)."""
        offsets, found = self.offsets(x), len(self.problem.facts)
        for one, lines, _ in self.observed:
            found += likelihood.size(one.measured, one.at(offsets, lines[:1], derivatives=False), len(lines))
        return found


def cost_of(problem: Problem, free: Sequence[Parameter], floor: float, base: Offsets = NOTHING, *, plain: bool = False) -> Cost:
    """The cost of `problem` in the parameters `free`; of a plain fit declared ones have narrower bounds."""
    return Cost(problem=problem, free=tuple(free), floor=floor, base=base, plain=plain)


# Evidence: how probable the data are under a model whatever its parameters, by Laplace's approximation.
#
#     log Z = -cost - 1/2 log det(S N S) ,   S = diag(tolerance)
#
# N is the matrix of second derivatives of the cost, knowledge beforehand included; S N S is 1 in every direction of which the
# data say nothing, so that a useless parameter costs nothing and one that is told pays for the width that it had before
# (MacKay, Information Theory, Inference, and Learning Algorithms, ch. 28). What is left out is the same for all models of the
# same data, lines and floor. Where an effect changes the noise, so does the normalisation of the likelihood: its ratio to that
# of the data's own noise, latent inputs marginalised, is in.


def log_evidence(cost: Cost, x: Array, whole: Normal) -> float:
    """At the minimum `x` (p,) where `whole` was found [nats], up to a constant of the data."""
    scale = np.array([one.tolerance if np.isfinite(one.tolerance) else 1.0 for one in cost.free])
    _, logdet = np.linalg.slogdet(scale[:, None] * whole.matrix * scale)
    # Of the noise at `x` against that of the data
    found = 0.0
    for seen, predicted in cost.predicted(x):
        if predicted.noise is None:
            continue
        new, old = seen.weight(cost.floor, predicted.noise), seen.weight(cost.floor)
        found += 2 * float(np.sum(np.log(new / old)))
        if seen.inputs is None:
            rows = np.broadcast_to(predicted.rows, (len(seen.runs), *predicted.rows.shape[-3:]))
            found -= _determinant(new[..., None] * rows) - _determinant(old[..., None] * rows)
    return float(-whole.cost - 0.5 * logdet + found)


def _determinant(A: ComplexArray) -> float:
    """log det(A^H A) over all lines, of A (r, m, c, k)."""
    R = np.linalg.qr(A, mode="r")
    return 2 * float(np.sum(np.log(np.abs(np.diagonal(R, axis1=-2, axis2=-1)))))


# Inputs at every line: as they are known, or estimated, and what is left of every channel by what all the others say.
#
# A latent base motion is told by accelerations and forces together: at a resonance an acceleration's own error, multiplied by
# the dynamic mass, would be a wrong force, and there the forces know better. So that no channel speaks for itself, each is
# predicted from all the others. With the whitened W A = Q R that needs no further solution (Cook & Weisberg, Residuals and
# Influence in Regression, 1982):
#
#     e_c = (y - A u)_c / (1 - h_c),   h_c = |row c of Q|²


ALONE = 1e-9
"""[share] 1 - h of a channel below which no other tells what it does. Exercised by tests/validation/engine/test_likelihood.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Left:
    """What a prediction does not explain of one run.

    Attributes
    ----------
    values : (m, c) every channel less what the others and the prediction say of it
    inputs : (m, k) u, by all channels
    gain : (m, c, c) values = gain y; None for known inputs, where it is the identity
    """

    values: ComplexArray
    inputs: ComplexArray
    gain: ComplexArray | None


def left_of_run(seen: ObservedLines, rows: ComplexArray, weight: Array, run: int) -> Left:
    """Of the run with index `run`, with rows (m, c, k) of it and weights (m, c).

    Raises
    ------
    CheckFailed : without some channel the others do not tell the inputs.
    """
    y = seen.values[run]
    if seen.inputs is not None:
        u = np.asarray(seen.inputs[run])
        return Left(values=y - (rows @ u[..., None])[..., 0], inputs=u, gain=None)
    Q, R = np.linalg.qr(weight[..., None] * rows)
    # (m, c) 1 / (1 - h)
    left = 1 - np.sum(np.abs(Q) ** 2, axis=-1)
    if np.any(left < ALONE):
        line, channel = np.argwhere(left < ALONE)[0]
        raise CheckFailed(
            f"the {Q.shape[2]} inputs cannot be told without channel {channel + 1} at line {line + 1}, so nothing is "
            "known of it; measure with more channels, or leave that line out"
        )
    to_others = np.asarray(1 / left)
    whitened = to_others[..., None] * (np.eye(y.shape[1]) - Q @ Q.conj().transpose(0, 2, 1))
    gain = np.asarray(whitened * weight[:, None, :] / weight[:, :, None], dtype=np.complex128)
    return Left(values=(gain @ y[..., None])[..., 0], inputs=_inputs(Q, R, weight * y), gain=gain)


def _inputs(Q: ComplexArray, R: ComplexArray, white: ComplexArray) -> ComplexArray:
    try:
        return np.asarray(np.linalg.solve(R, Q.conj().transpose(0, 2, 1) @ white[..., None]))[..., 0]
    except np.linalg.LinAlgError as error:
        raise CheckFailed("the channels do not tell the inputs at some line; leave that line out") from error


# The root of a covariance whose parameters are of any unit.


def root(covariance: Array) -> Array:
    """(p, p) R with R R^T = `covariance`, whose parameters may stand still.

    It is taken of the correlations: beside a variance in (N/m)², what is known of a position to the micrometre is rounding.
    """
    sd = np.sqrt(np.maximum(np.diag(covariance), 0.0))
    scale = np.where(sd > 0, sd, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(scale, scale))
    return np.asarray(scale[:, None] * vectors * np.sqrt(np.maximum(values, 0.0)))
