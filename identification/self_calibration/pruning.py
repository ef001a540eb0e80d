"""Poles and couplings that only errors of the chain called for go again, once the chain is free to explain them itself.

The elastic terms begin from a plain dynamic mass, which gains, angles and positions falsify by per cents: some of its poles make
up for a slope or a bump that sensors made. In the joint fit they are worth nothing. What chi² would rise by if a pole's
participation were zero, all else refitted to second order, is l^T C_ll^-1 l (Wald; the exponent of Savage and Dickey's ratio with
Gaussian priors). Poles go the weakest first, each time with what the others then are.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array, Integers
from identification.elastic import model
from identification.self_calibration import elastic_block
from identification.self_calibration.assembly import Assembly
from identification.self_calibration.further_poles import ELASTIC, replaced
from identification.self_calibration.layout import Layout
from identification.self_calibration.solve import Solution, inverse

COUPLED = 1.0
"""Standard deviations from zero from which the coupled damping of a pair is kept: below, the prior at zero says as much."""


def pruned(problem: Assembly, solution: Solution, size: int, *, below: float = np.inf) -> tuple[Assembly, Array] | None:
    """The problem without what does not pay in the article's campaign, and where to begin; None where all of it pays.

    Parameters
    ----------
    size : real numbers in the data: a parameter must take ln(size) out of chi² (Schwarz 1978)
    below : [Hz] poles that may go; beyond the band several act as one as long as the rest is coarse
    """
    elastic = problem.campaigns[0].structure.elastic
    if elastic is None or not elastic.modes:
        return None
    x, C, gone = _without_weak(problem, solution, price(size), below)
    pairs = _felt(x, C, elastic, _first(problem))
    rest = [r for r in range(elastic.modes) if r not in gone]
    kept = tuple((r, s) for r, s in pairs if r in rest and s in rest)
    if not gone and kept == elastic.pairs:
        return None
    return _shorter(problem, x, rest, kept)


def modes(problem: Assembly) -> int:
    """Poles of the article."""
    elastic = problem.campaigns[0].structure.elastic
    return 0 if elastic is None else elastic.modes


def beyond(problem: Assembly, x: Array) -> int:
    """Poles of the article above the band at `x` (k,)."""
    return int(np.sum(problem.campaigns[0].structure.terms(problem.layout, x).frequency > problem.band[1]))


def price(size: int) -> float:
    """What a pole - frequency, damping, participation - must take out of chi²."""
    return 8 * float(np.log(size))


def worths(problem: Assembly, x: Array, C: Array) -> Array:
    """(m,) what chi² would rise by without each pole; `C` (k, k) is the posterior covariance at `x` (k,)."""
    return np.array([_worth(x, C, _participation(problem, r)) for r in range(modes(problem))])


def _without_weak(problem: Assembly, solution: Solution, price: float, below: float) -> tuple[Array, Array, set[int]]:
    """Vector and covariance with the participation of weak poles held at zero, and which those are."""
    x, C = solution.x, inverse(solution.normal.matrix)
    stays = problem.campaigns[0].structure.terms(problem.layout, x).frequency > below
    gone: set[int] = set()
    left = np.where(stays, np.inf, worths(problem, x, C))
    while left.min() < price:
        at = _participation(problem, int(np.argmin(left)))
        gain = np.linalg.solve(C[np.ix_(at, at)], C[at]).T
        x, C = x - gain @ x[at], C - gain @ C[at]
        gone.add(int(np.argmin(left)))
        left = np.array([np.inf if r in gone or stays[r] else _worth(x, C, _participation(problem, r)) for r in range(len(left))])
    return x, C, gone


def _worth(x: Array, C: Array, at: Integers) -> float:
    return float(x[at] @ np.linalg.solve(C[np.ix_(at, at)], x[at]))


def _first(problem: Assembly) -> int:
    """Where the elastic layout would begin: its own first ten are the block of the article."""
    return int(problem.layout.at(ELASTIC).start) - 10


def _participation(problem: Assembly, r: int) -> Integers:
    elastic = problem.campaigns[0].structure.elastic
    begin = 0 if elastic is None else elastic.blocks["participation"].start
    return np.asarray(_first(problem) + begin + 6 * r + np.arange(6))


def _felt(x: Array, C: Array, elastic: model.Layout, first: int) -> tuple[tuple[int, int], ...]:
    at = first + np.arange(elastic.size)[elastic.blocks["pairs"]]
    known = np.abs(x[at]) > COUPLED * np.sqrt(np.maximum(np.diag(C)[at], 0.0))
    return tuple(pair for pair, keep in zip(elastic.pairs, known, strict=True) if keep)


def _shorter(problem: Assembly, x: Array, rest: list[int], pairs: tuple[tuple[int, int], ...]) -> tuple[Assembly, Array]:
    structure, layout = problem.campaigns[0].structure, problem.layout
    place = {r: k for k, r in enumerate(rest)}
    terms = model.chosen(structure.terms(layout, x), rest)
    elastic, made = elastic_block.of_article(
        ELASTIC, structure.ten(layout, x), terms, pairs=tuple((place[r], place[s]) for r, s in pairs)
    )
    return replaced(problem, x, elastic, Layout(blocks=tuple(made if b.name == ELASTIC else b for b in layout.blocks)))
