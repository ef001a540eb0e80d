"""What the data say of parameters that are not in a fit yet, each by itself and in closed form.

At a fit with the whitened derivatives J of its free parameters, and knowledge beforehand on top, N = J^T J + diag(tolerance^-2),
one more parameter with the column e is told by

    q = e^T e - e^T J N^-1 J^T e ,        c = e^T (r - J s) / q

(r is the residual, s the step that the others would take by themselves: at a minimum none, unless a bound held one of them),
its information when all others make up for it, and its size. Its evidence, were its plausible size a normal deviate of standard
deviation s, is

    ln(Z_s / Z_0) = 1/2 c^2 / (1/q) - 1/2 c^2 / (s^2 + 1/q) - 1/2 ln(1 + q s^2)

and that of a parameter which is in the fit with a tolerance t, and leaves it, the difference of two of these (the Savage-Dickey
ratio of its posterior; J. M. Dickey, Ann. Math. Stat. 42 (1971), 204). The likelihood is taken for normal: a fault that bends it
is found, its size is not.

A column that is a function of frequency times another, such as a resonator of any frequency, needs no derivative of its own:
products of the other with the residual and with J are kept by line.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from math import log, sqrt
from typing import Protocol

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from identification.self_calibration.solve import inverse, total
from validation.estimation.fit import FLOOR
from validation.estimation.likelihood import ObservedLines, cost_of, in_the_tail, normals, whitened
from validation.estimation.problem import EFFECT, Fit, Offsets, Parameter, Predicted, Problem

POWER = 0.84
"""[sd] of a size that noise takes away in one test of five: four name what the smallest size promises. By definition."""

AGAIN = 20
"""[count] of times that a size and what makes up for it are worked out by each other. Exercised by test_screening.py."""

KNOWN = 1e-12
"""[share] of its square that must be left of a column beside others for data to tell it. Exercised by test_screening.py."""


class Smallest(Protocol):
    """What tells the smallest size that data would name."""

    def detectable(self, plausible: float, evidence: float) -> float:
        """See `ScoreTest.detectable`."""


@dataclass(frozen=True, kw_only=True)
class ScoreTest:
    """What the data say of one parameter, all others making up for it.

    Attributes
    ----------
    name : of the parameter
    estimate : its offset
    information : one over the square of its standard deviation; 0 where the data say nothing
    tolerance : that it has in the fit; 0 for one that is not in it
    share : of the square of its column that the others cannot imitate
    """

    name: str
    estimate: float
    information: float
    tolerance: float = 0.0
    share: float = 1.0

    @property
    def deviation(self) -> float:
        """Standard deviation of the estimate; infinite where the data say nothing."""
        return 1 / sqrt(self.information) if self.information > 0 else np.inf

    def evidence(self, plausible: float) -> float:
        """[nats] for a fault whose size is plausibly +- `plausible`, against what the tolerance alone allows."""
        return self._against_nothing(plausible) - self._against_nothing(self.tolerance)

    def detectable(self, plausible: float, evidence: float) -> float:
        """The offset that four tests of five find, whose evidence must come to `evidence` [nats]; infinite where no size does."""
        if self.information <= 0 or plausible <= self.tolerance or np.isinf(plausible):
            return np.inf
        narrow, wide = self.tolerance**2 + 1 / self.information, plausible**2 + 1 / self.information
        apart = (plausible - self.tolerance) * (plausible + self.tolerance)  # wide - narrow, however much larger both are
        return (sqrt(2 * (evidence + 0.5 * log(wide / narrow)) * wide / apart) + POWER) * sqrt(narrow)

    def _against_nothing(self, spread: float) -> float:
        q, c = self.information, self.estimate
        return 0.5 * c**2 * q * (q * spread**2) / (1 + q * spread**2) - 0.5 * log(1 + q * spread**2) if q > 0 else 0.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Products:
    """Of one data set, summed over runs and channels, by line.

    Attributes
    ----------
    frequency : (m,) [Hz]; (1,) where lines are summed, and then no frequency
    names : (e,) of the columns
    residual : (m, e) complex, column times residual
    others : (m, e, p) complex, column times the derivatives of the fit
    square : (m, e)
    """

    frequency: Array
    names: tuple[str, ...]
    residual: ComplexArray
    others: ComplexArray
    square: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Screen:
    """The products of a fit with columns that are not in it.

    Attributes
    ----------
    free : (p,) parameters of the fit that may move
    covariance : (p, p)
    step : (p,) that they would take by themselves: none but where a bound kept one
    products : by data set
    facts : of weights, periods and the like; they know no frequency
    """

    free: tuple[Parameter, ...]
    covariance: Array
    step: Array
    products: tuple[Products, ...]
    facts: Products

    def told(self) -> dict[str, ScoreTest]:
        """What the data say of every column as it is."""
        names = dict.fromkeys(name for one in (*self.products, self.facts) for name in one.names)
        return {name: self.shaped(name) for name in names}

    def taken(self, name: str) -> Array:
        """(p,) What the parameters of the fit take over of a unit of the column `name`."""
        both = [(one, one.names.index(name)) for one in (*self.products, self.facts) if name in one.names]
        return np.asarray(self.covariance @ np.sum([one.others[:, k].real.sum(axis=0) for one, k in both], axis=0))

    def shaped(self, name: str, shape: Mapping[int, ComplexArray] | None = None) -> ScoreTest:
        """What they say of the column `name` times a function of frequency, by data set its values (m,); 1 by default."""
        (told,) = self.shapes(name, None if shape is None else {k: one[None] for k, one in shape.items()})
        return told

    def shapes(self, name: str, shape: Mapping[int, ComplexArray] | None) -> list[ScoreTest]:
        """The same of several functions of frequency (n, m)."""
        count = 1 if shape is None else len(next(iter(shape.values())))
        gradient, cross, square = np.zeros(count), np.zeros((count, len(self.free))), np.zeros(count)
        for k, one in enumerate((*self.products, self.facts)):
            if name not in one.names:
                continue
            at = one.names.index(name)
            as_it_is = np.ones((count, len(one.frequency)), dtype=np.complex128)
            s = as_it_is if shape is None or one is self.facts else shape[k]
            gradient += (s.conj() @ one.residual[:, at]).real
            others = one.others[:, at]  # the real part of a product, as one real product
            cross += np.concatenate([s.real, s.imag], axis=1) @ np.concatenate([others.real, others.imag])
            square += np.abs(s) ** 2 @ one.square[:, at]
        gradient -= cross @ self.step
        left = square - np.einsum("np,pq,nq->n", cross, self.covariance, cross, optimize=True)
        information = np.where(left > KNOWN * square, left, 0.0)
        with np.errstate(divide="ignore", invalid="ignore"):
            estimate = np.where(information > 0, gradient / information, 0.0)
        share = left / np.maximum(square, np.finfo(np.float64).tiny)
        each = zip(estimate, information, share, strict=True)
        return [ScoreTest(name=name, estimate=float(c), information=float(q), share=float(s)) for c, q, s in each]


@dataclass(frozen=True, eq=False, kw_only=True)
class MadeUp:
    """What the data say of a loss of any size, where others that make up for it multiply and a straight line adds.

    In logarithms of what modes lose a size s asks ln(1 + W s), and parts that lose 1 + l times as much give ln(1 + V l):

        cost(s) = min over l of 1/2 l^T l / t^2 + 1/2 v^T Q v ,      v = ln(1 + W s) - ln(1 + V l) ,

    half of s^2 times its information. With the parts held still modes take over W of a unit of s and V of one of l, C is their
    covariance, and Q = 1/sigma^2 - C / sigma^4, sigma what is known of them.

    Attributes
    ----------
    told : of a small one
    size, parts, matrix, known : (m,) W; (m, k) V; (m, m) Q; (k,) 1 / t^2
    """

    told: ScoreTest
    size: Array
    parts: Array
    matrix: Array
    known: Array

    @classmethod
    def of(cls, screen: Screen, told: ScoreTest) -> "MadeUp":
        """Of the column that was `told`."""
        p, d = ([k for k, one in enumerate(screen.free) if one.family == name] for name in ("loss", "damping"))
        taken, C = screen.taken(told.name), screen.covariance
        through = np.asarray(np.linalg.solve(C[np.ix_(p, p)], C[np.ix_(p, d)]).T, dtype=np.float64)  # (m, k)
        sigma = np.diag([screen.free[k].tolerance ** -2.0 for k in d])
        return cls(
            told=told,
            size=taken[d] - through @ taken[p],
            parts=-through,
            matrix=sigma - sigma @ (C[np.ix_(d, d)] - through @ C[np.ix_(p, d)]) @ sigma,
            known=np.array([screen.free[k].tolerance ** -2.0 for k in p]),
        )

    def at(self, offset: float) -> ScoreTest:
        """What the data say of a size of `offset`."""
        asked, lost, Q = np.log1p(np.maximum(self.size * offset, 0.0)), np.zeros(len(self.known)), self.matrix
        for _ in range(AGAIN):
            grown = 1 + self.parts @ lost
            left, slope = asked - np.log(grown), self.parts / grown[:, None]
            step = np.linalg.solve(np.diag(self.known) + slope.T @ Q @ slope, slope.T @ Q @ left - self.known * lost)
            gone = float(np.max(-slope @ step, initial=0.0))
            lost = lost + step / max(1.0, 2 * gone)  # no mode loses less than half of that before
        left = asked - np.log1p(self.parts @ lost)
        return replace(self.told, information=float(self.known @ lost**2 + left @ Q @ left) / offset**2)

    def detectable(self, plausible: float, evidence: float) -> float:
        """As `ScoreTest.detectable`, of the size that it tells."""
        found = self.told.detectable(plausible, evidence)
        for _ in range(AGAIN):
            if found > 1 / KNOWN:
                return np.inf
            found = self.at(found).detectable(plausible, evidence)
        return found


def in_the_fit(fit: Fit) -> dict[str, ScoreTest]:
    """What the data say of every parameter of `fit` that has a tolerance."""
    found = {}
    for one, x, variance in zip(fit.parameters, fit.offsets, np.diag(fit.covariance), strict=True):
        if 0 < one.tolerance < np.inf and variance > 0:
            price = 0.0 if in_the_tail(one, float(x)) else one.tolerance**-2  # there next to nothing pulls it back
            information = max(1 / variance - price, 0.0)
            known = information * variance > KNOWN
            estimate = float(x) / (variance * information) if known else 0.0
            told = ScoreTest(name=one.name, estimate=estimate, information=information if known else 0.0, tolerance=one.tolerance)
            found[one.name] = told
    return found


def screened(problem: Problem, fit: Fit, names: Sequence[str], *, by_line: bool = True, floor: float = FLOOR) -> Screen:
    """The columns `names`, parameters of `problem`, beside a `fit` of others of its parameters.

    Parameters
    ----------
    problem : in which what is screened stands where it has no effect, or next to none
    fit : of the same data without them
    by_line : whether the columns will be taken times functions of frequency; their sums over lines are had sooner
    """
    new = tuple(problem.by_name[name] for name in names)
    stand = {**{one.name: 0.0 for one in new if not one.logarithmic}, **fit.by_name}
    free, covariance, step = _beside(problem, fit, stand, floor)
    cost = cost_of(problem, (*free, *new), floor, fit.by_name)
    offsets = cost.offsets(cost.at(stand))
    wanted = frozenset(cost.names)
    olds, products = [one.name for one in free], []
    for prediction, lines, seen in cost.observed:
        predicted = prediction.at(offsets, lines, derivatives=wanted)
        here = tuple(one.name for one in new if one.name in predicted.changes)
        if by_line:
            frequency = prediction.measured.frequency[lines]
            products.append(_products(seen, predicted, frequency, olds, here, floor))
        else:
            count = len(olds)
            of = total(normals(seen, predicted, [*olds, *here], floor).values(), count + len(here))
            products.append(
                Products(
                    frequency=np.zeros(1),
                    names=here,
                    residual=-of.gradient[None, count:].astype(np.complex128),
                    others=of.matrix[None, count:, :count].astype(np.complex128),
                    square=np.diag(of.matrix)[None, count:].copy(),
                )
            )
    # Facts: each is a line of its own, and what it leaves is the measured less the predicted, as of a channel
    said = [fact.residual(offsets) for fact in problem.facts]
    here = tuple(one.name for one in new if any(one.name in slopes for _, slopes in said))
    left = np.array([-away for away, _ in said]).reshape(len(said), 1)
    e, J = (
        np.array([[slopes.get(name, 0.0) for name in columns] for _, slopes in said]).reshape(len(said), len(columns))
        for columns in (here, olds)
    )
    facts = Products(
        frequency=np.zeros(len(said)),
        names=here,
        residual=(e * left).astype(np.complex128),
        others=(e[:, :, None] * J[:, None, :]).astype(np.complex128),
        square=e**2,
    )
    return Screen(free=free, covariance=covariance, step=step, products=tuple(products), facts=facts)


def _beside(problem: Problem, fit: Fit, stand: Offsets, floor: float) -> tuple[tuple[Parameter, ...], Array, Array]:
    """The parameters of `fit` that may move (p,), their covariance (p, p), and the step that they would take (p,).

    An effect at a bound stays, since beyond is no physics. What a laboratory identifies does not: beside it, a fault that drove
    it there would look as if only its rest were left to be explained. What is promised then counts from where the step would end,
    and is short of what a fit gains by what the step would gain.
    """
    bound = {one.name for one, v in zip(fit.parameters, np.diag(fit.covariance), strict=True) if v <= 0}
    still = {one.name for one in fit.parameters if one.name in bound and one.kind == EFFECT}
    keep = [k for k, one in enumerate(fit.parameters) if one.name not in still]
    free = tuple(fit.parameters[k] for k in keep)
    if bound == still:
        return free, fit.covariance[np.ix_(keep, keep)], np.zeros(len(free))
    cost = cost_of(problem, free, floor, stand)
    whole, _ = cost.total(cost.at(stand))
    covariance = inverse(whole.matrix)
    return free, covariance, -covariance @ whole.gradient


def _products(
    seen: ObservedLines, predicted: Predicted, frequency: Array, free: Sequence[str], new: tuple[str, ...], floor: float
) -> Products:
    own = [k for k, name in enumerate(free) if name in predicted.changes]
    columns = [*(free[k] for k in own), *new]
    lines = seen.values.shape[1]
    residual = np.zeros((lines, len(new)), dtype=np.complex128)
    others = np.zeros((lines, len(new), len(free)), dtype=np.complex128)
    square = np.zeros((lines, len(new)))
    for run in range(len(seen.runs)):
        r, V = whitened(seen, predicted, columns, floor, run)
        E = V[..., len(own) :].conj().transpose(0, 2, 1)
        residual += (E @ r[..., None])[..., 0]
        others[..., own] += E @ V[..., : len(own)]
        square += np.sum(np.abs(E) ** 2, axis=2)
    return Products(frequency=frequency, names=new, residual=residual, others=others, square=square)
