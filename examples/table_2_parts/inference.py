"""Which explanation, and how surely: Gaussian evidence of seven numbers for every way to read, every effect and a few at once.

Of a way d = d0 + T t + E x + r: tolerances t of standard deviation 1, the sizes x of the faults that an explanation has, r the
error of the reference. With V = T Tᵀ + cov r, and of every size x ~ N(mean, plausible²), the evidence of the seven numbers is a
normal density in closed form; a size that cannot be negative has twice the share of its posterior that is positive (of several,
taken for independent). What it costs to have more freedom is in it (MacKay, Neural Computation 4, 1992, 415).
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass
from functools import cached_property
from math import factorial, log

import numpy as np
import numpy.typing as npt

from geometry.frames import Array
from table_2_parts.candidates import AXES, Candidate
from table_2_parts.published import DEVIATIONS, deviation_of_reading
from table_2_parts.reading import ROWS
from table_2_parts.ways import STOPS, Answer, Way, answer, ways

Chosen = npt.NDArray[np.int64]

FAULTS = (0.5, 0.25, 0.125, 0.0625)
"""Probability, beforehand, of so many faults in the tests of 2002; more than three are not looked at."""

TAKEN_OFF = 0.5
"""Probability, beforehand, that elasticity was taken off; the other bands share the rest. The paper says that it can be done, and
neither whether nor how it was."""

KEPT = 60
"""Pairs of each way that are tried with a third."""

SURE = 1e-9
"""Share of the plausible size that stands for none, of a switch that is off or not."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Explanation:
    """What may have been wrong, by one way to read.

    Attributes
    ----------
    way : it
    faults : of the catalogue; the quarter turn is in `way`
    log_evidence : [nats]
    log_prior : of way and faults
    sizes : (k,) of the faults, posterior mean
    deviations : (k,) their standard deviations
    """

    way: Way
    faults: tuple[Candidate, ...]
    log_evidence: float
    log_prior: float
    sizes: Array
    deviations: Array

    @property
    def names(self) -> tuple[str, ...]:
        """Of all that is wrong, the quarter turn first."""
        return (*((AXES,) if self.way.turned else ()), *(one.name for one in self.faults))

    @property
    def families(self) -> frozenset[str]:
        """Of all that is wrong."""
        return frozenset((*((AXES,) if self.way.turned else ()), *(one.named.family for one in self.faults)))

    @property
    def log_posterior(self) -> float:
        """Up to what is common to all."""
        return self.log_evidence + self.log_prior


@dataclass(frozen=True, eq=False, kw_only=True)
class Tried:
    """Sets of equally many faults by one way.

    Attributes
    ----------
    of : the way's answer
    chosen : (n, k) indices of its candidates
    log_evidence, log_prior : (n,)
    sizes, deviations : (n, k)
    """

    of: Answer
    chosen: Chosen
    log_evidence: Array
    log_prior: Array
    sizes: Array
    deviations: Array

    @property
    def log_posterior(self) -> Array:
        """(n,) up to what is common to all."""
        return np.asarray(self.log_evidence + self.log_prior)

    def explanation(self, k: int) -> Explanation:
        """The set with index `k`."""
        return Explanation(
            way=self.of.way,
            faults=tuple(self.of.candidates[j] for j in self.chosen[k]),
            log_evidence=float(self.log_evidence[k]),
            log_prior=float(self.log_prior[k]),
            sizes=self.sizes[k],
            deviations=self.deviations[k],
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Found:
    """Everything that was tried.

    Attributes
    ----------
    tried : by way and number of faults
    """

    tried: tuple[Tried, ...]

    @cached_property
    def total(self) -> float:
        """ln of what all of them sum up to."""
        return float(np.logaddexp.reduce(np.concatenate([one.log_posterior for one in self.tried])))

    @cached_property
    def probability(self) -> tuple[Array, ...]:
        """Posterior of each set, by `tried`."""
        return tuple(np.exp(one.log_posterior - self.total) for one in self.tried)

    def best(self, count: int, wanted: Callable[[Tried], bool] = lambda tried: True) -> tuple[Explanation, ...]:
        """The most probable of those `wanted`, each set of effects once, by the way in which it does best."""
        order = [
            (p, one, k) for one, share in zip(self.tried, self.probability, strict=True) if wanted(one) for p, k in _top(share)
        ]
        found: dict[tuple[str, ...], Explanation] = {}
        for _, one, k in sorted(order, key=lambda item: -item[0]):
            explanation = one.explanation(k)
            found.setdefault(explanation.names, explanation)
        return tuple(found.values())[:count]

    def of_ways(self, key: Callable[[Way], object]) -> dict[object, float]:
        """Posterior by something about the way."""
        shares: dict[object, float] = {}
        for one, share in zip(self.tried, self.probability, strict=True):
            shares[key(one.of.way)] = shares.get(key(one.of.way), 0.0) + float(share.sum())
        return shares

    def of_counts(self) -> dict[int, float]:
        """Posterior by number of faults, the quarter turn counted."""
        shares: dict[int, float] = {}
        for one, share in zip(self.tried, self.probability, strict=True):
            count = one.chosen.shape[1] + one.of.way.turned
            shares[count] = shares.get(count, 0.0) + float(share.sum())
        return shares

    def of_families(self) -> dict[str, float]:
        """Posterior that a fault of a family is there, the largest first."""
        shares: dict[str, float] = {AXES: float(self.of_ways(lambda way: way.turned).get(True, 0.0))}
        for one, share in zip(self.tried, self.probability, strict=True):
            families = np.array([candidate.named.family for candidate in one.of.candidates])[one.chosen]
            for family in np.unique(families):
                there = np.any(families == family, axis=1)
                shares[str(family)] = shares.get(str(family), 0.0) + float(share[there].sum())
        return dict(sorted(shares.items(), key=lambda pair: -pair[1]))


MOST_OF_ONE = 200
"""Sets of one way and number of faults among which the best of all are looked for."""


def _top(share: Array) -> list[tuple[float, int]]:
    return [(float(share[k]), int(k)) for k in np.argsort(-share)[:MOST_OF_ONE]]


def everything(scale: float = 1.0, reference: float = 1.0, most: int = 3) -> Found:
    """All ways, all effects, all pairs and the best triples.

    Parameters
    ----------
    scale : factor on all tolerances
    reference : standard deviation of the reference [%], [mm]
    most : faults at most
    """
    found = (_of_way(answer(way), scale, reference, most) for turned in (False, True) for way in ways(turned))
    return Found(tried=tuple(one for tried in found for one in tried))


def covariance(of: Answer, scale: float = 1.0, reference: float = 1.0) -> Array:
    """V (7, 7): tolerances and reference."""
    return np.asarray(scale**2 * of.tolerances @ of.tolerances.T + np.diag(deviation_of_reading(reference) ** 2))


def misfit(of: Answer, scale: float = 1.0, reference: float = 1.0) -> float:
    """chi² of Table 2, 7 degrees of freedom, where nothing is wrong but tolerances."""
    d = DEVIATIONS - of.nominal
    return float(d @ np.linalg.solve(covariance(of, scale, reference), d))


def _of_way(of: Answer, scale: float, reference: float, most: int) -> Iterator[Tried]:
    """Nothing, singles, all pairs, the best pairs with a third."""
    gaussian, shares = _whitened(of, scale, reference), _log_shares(of.candidates)
    chosen, count = np.zeros((1, 0), dtype=np.int64), len(of.candidates)
    for k in range(most - of.way.turned + 1):
        faults = k + of.way.turned
        evidence, sizes, deviations = _evidence(gaussian, chosen)
        drawn = log(FAULTS[faults] * factorial(faults)) - of.way.turned * log(_families(of.candidates) + 1)
        tried = Tried(
            of=of,
            chosen=chosen,
            log_evidence=evidence,
            log_prior=drawn + _beforehand(of.way) + shares[chosen].sum(axis=1),
            sizes=sizes,
            deviations=deviations,
        )
        yield tried
        chosen = _larger(chosen if k < 2 else chosen[np.argsort(-tried.log_posterior)[:KEPT]], count)


def _larger(chosen: Chosen, count: int) -> Chosen:
    """Each set with each further candidate, every set once."""
    repeated = np.repeat(chosen, count, axis=0)
    added = np.tile(np.arange(count), len(chosen))[:, None]
    whole = np.sort(np.concatenate([repeated, added], axis=1), axis=1)
    return np.unique(whole[np.all(np.diff(whole, axis=1) > 0, axis=1)], axis=0)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Gaussian:
    """Whitened: y (7,), E (7, c), prior mean and deviation (c,), one-sided or not (c,), and ln of the density's factor."""

    y: Array
    E: Array
    mean: Array
    deviation: Array
    one_sided: npt.NDArray[np.bool_]
    factor: float


def _whitened(of: Answer, scale: float, reference: float) -> _Gaussian:
    L = np.linalg.cholesky(covariance(of, scale, reference))
    E = np.linalg.solve(L, of.effects)
    return _Gaussian(
        y=np.linalg.solve(L, DEVIATIONS - of.nominal),
        E=E,
        mean=np.array([-1.0 if one.switch else 0.0 for one in of.candidates]),
        deviation=np.array([one.plausible * (SURE if one.switch else 1.0) for one in of.candidates]),
        one_sided=np.array([one.one_sided for one in of.candidates]),
        factor=float(-np.log(np.diag(L)).sum() - 0.5 * len(L) * np.log(2 * np.pi)),
    )


def _evidence(of: _Gaussian, chosen: Chosen) -> tuple[Array, Array, Array]:
    """ln evidence (n,), posterior mean and standard deviation (n, k) of the sizes of `chosen` (n, k)."""
    from scipy.special import log_ndtr

    s = of.deviation[chosen]
    G = of.E.T[chosen] * s[..., None]  # (n, k, 7), a column for one standard deviation of each size
    left = of.y - np.einsum("nk,nkj->nj", of.mean[chosen], of.E.T[chosen])
    A = G @ G.transpose(0, 2, 1) + np.eye(chosen.shape[1])
    b = (G @ left[..., None])[..., 0]
    C = np.linalg.inv(A)
    x = (C @ b[..., None])[..., 0]
    found = of.factor - 0.5 * (np.einsum("nj,nj->n", left, left) - np.einsum("nk,nk->n", b, x)) - 0.5 * np.linalg.slogdet(A)[1]
    sd = np.sqrt(np.diagonal(C, axis1=1, axis2=2))
    found += np.sum(np.where(of.one_sided[chosen], log(2) + log_ndtr(x / sd), 0.0), axis=1)
    return found, of.mean[chosen] + x * s, sd * s


def _log_shares(candidates: Sequence[Candidate]) -> Array:
    """(c,) ln of the share of each: families alike, the quarter turn one of them, and alike within a family."""
    families = [one.named.family for one in candidates]
    count = {family: families.count(family) for family in families}
    return np.asarray(-np.log([count[family] * (len(count) + 1) for family in families]))


def _families(candidates: Sequence[Candidate]) -> int:
    return len({one.named.family for one in candidates})


def _beforehand(way: Way) -> float:
    """ln of the prior of a way."""
    share = TAKEN_OFF if way.stop == 0 else (1 - TAKEN_OFF) / (len(STOPS) - 1)
    return log(share / len(ROWS))
