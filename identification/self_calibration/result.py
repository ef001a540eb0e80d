"""From the joint minimum to an `Identified`: covariance, where it comes from, misfit and the price of the tolerances.

The posterior covariance of the whole vector is C = (J^T J + A^T A)^-1 = C J^T J C + sum C A_b^T A_b C: what noise gives, and what
every family b of tolerances leaves. Noise counts for elasticity as far as it would be less were the elastic terms known.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.inertia import Inertia
from identification import classical
from identification.evidence import Settings
from identification.identified import Identified
from identification.self_calibration import bootstrap
from identification.self_calibration.assembly import Assembly
from identification.self_calibration.elastic_block import FAMILY
from identification.self_calibration.layout import Layout
from identification.self_calibration.solve import Solution, inverse

NOISE = "noise"

CHAIN = "chain:"
"""How the names of the blocks begin that hold tolerances of the measurement chain."""

SEED = 5
"""Of the block bootstrap: the same data give the same result."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Posterior:
    """The joint minimum to second order.

    Attributes
    ----------
    data : (k, k) J^T J, divided by the misfit where that is above 1: noise is then larger than was thought
    rows : (p, k) whitened knowledge
    families : (p,)
    covariance : (k, k)
    misfit : chi² of the data for each degree of freedom
    """

    data: Array
    rows: Array
    families: tuple[str, ...]
    covariance: Array
    misfit: float


def posterior(problem: Assembly, solution: Solution, settings: Settings) -> Posterior:
    """The covariance of everything that was estimated."""
    rows = problem.knowledge(solution.x)[1]
    size = sum(part.observed.size for part in problem.parts(settings.floor))
    effective = float(np.sum(inverse(solution.data.matrix + rows.T @ rows) * solution.data.matrix))
    misfit = 2 * solution.data.cost / max(size - effective, 1.0)
    data = solution.data.matrix / max(misfit, 1.0)
    return Posterior(data=data, rows=rows, families=problem.families, covariance=inverse(data + rows.T @ rows), misfit=misfit)


def identified(problem: Assembly, solution: Solution, settings: Settings) -> Identified:
    """The article's ten parameters at the joint minimum."""
    layout, article = problem.layout, problem.layout.at("article")
    found = posterior(problem, solution, settings)
    split = parts(layout, found)
    if np.any(problem.drift):
        split[FAMILY] = split.get(FAMILY, np.zeros((10, 10))) + np.outer(problem.drift, problem.drift)
    covariance = np.sum(list(split.values()), axis=0)
    structure = problem.campaigns[0].structure
    return Identified(
        way="self-calibrated",
        inertia=Inertia(parameters=solution.x[article]),
        covariance=covariance,
        band=problem.band,
        elastic=None if structure.elastic is None else structure.terms(layout, solution.x),
        shares={name: np.diag(part) / np.diag(covariance) for name, part in split.items()},
        misfit=found.misfit,
        surprise=surprise(layout, solution.x),
        tolerances=sum(len(one.families) for one in layout.blocks if one.name.startswith(CHAIN)),
        converged=solution.converged,
        parts=split,
        gained=gained(problem, found),
        resampled=resampled(problem, solution, found, settings),
        warnings=problem.warnings if solution.converged else (*problem.warnings, _unconverged(solution)),
    )


def parts(layout: Layout, found: Posterior) -> dict[str, Array]:
    """By input its part (10, 10) of the covariance of the article's parameters; they add up to it."""
    C = found.covariance[layout.at("article")]
    through = C @ found.rows.T
    families = np.array(found.families)
    split = {name: through[:, families == name] @ through[:, families == name].T for name in dict.fromkeys(found.families)}
    noise = C @ found.data @ C.T
    kept = np.sqrt(np.minimum(_with_elastic_held(layout, found) / np.maximum(np.diag(noise), np.finfo(np.float64).tiny), 1.0))
    rigid = kept[:, None] * noise * kept
    split = {NOISE: rigid, **split, FAMILY: split.get(FAMILY, np.zeros((10, 10))) + noise - rigid}
    return {name: part for name, part in split.items() if np.any(np.diag(part) > 0)}


def gained(problem: Assembly, found: Posterior) -> dict[str, Array]:
    """By classical fact, how many times wider every interval of the ten would be without it, (10,)."""
    article = problem.layout.at("article")
    with_all = np.diag(found.covariance)[article]
    families = np.array(found.families)
    widened = {}
    for fact in problem.facts:
        rows = found.rows[families != classical.name(fact)]
        widened[classical.name(fact)] = np.sqrt(np.diag(inverse(found.data + rows.T @ rows))[article] / with_all)
    return widened


def resampled(problem: Assembly, solution: Solution, found: Posterior, settings: Settings) -> Array:
    """(10, 10) covariance of the article's parameters by the block bootstrap."""
    scores = bootstrap.scores(problem.parts(settings.floor), problem.layout, solution.x)
    rng = np.random.default_rng(SEED)
    draws = bootstrap.blocks(found.covariance, [one / max(found.misfit, 1.0) for one in scores], found.rows, rng)
    return np.asarray(np.cov(draws[:, problem.layout.at("article")].T))


def surprise(layout: Layout, x: Array) -> float:
    """Sum z² of the tolerances of the measurement chain."""
    return float(sum(np.sum(np.square(one.rows @ x[layout.at(one.name)])) for one in layout.blocks if one.name.startswith(CHAIN)))


def _with_elastic_held(layout: Layout, found: Posterior) -> Array:
    """(10,) variance that noise gives the article's parameters where the elastic ones are known."""
    article = layout.at("article")
    rigid = np.flatnonzero([not name.startswith("elastic:") for name in layout.owners])
    chosen = np.ix_(rigid, rigid)
    own = np.searchsorted(rigid, np.arange(article.start, article.stop))
    C = inverse(found.data[chosen] + found.rows[:, rigid].T @ found.rows[:, rigid])[own]
    return np.asarray(np.sum((C @ found.data[chosen]) * C, axis=1))


def _unconverged(solution: Solution) -> str:
    return (
        f"the joint fit did not converge: after {solution.evaluations} evaluations the next step is still "
        f"{solution.decrement:.3g} standard deviations; do not trust its figures"
    )
