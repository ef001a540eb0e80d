"""From the joint minimum to an `Identified`: covariance, where it comes from, misfit and the price of the tolerances.

The posterior covariance of the whole vector is C = (J^T J + sum A_b^T A_b)^-1 = C J^T J C + sum C A_b^T A_b C: what noise gives,
and what every family of tolerances leaves. Noise counts for elasticity as far as it would be less were the elastic terms known.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.inertia import Inertia
from identification.elastic.terms import ElasticTerms
from identification.evidence import Settings
from identification.identified import Identified
from identification.self_calibration.assembly import Assembly
from identification.self_calibration.elastic_block import FAMILY
from identification.self_calibration.layout import Layout
from identification.self_calibration.solve import Solution, inverse

NOISE = "noise"


def identified(problem: Assembly, solution: Solution, settings: Settings) -> Identified:
    """The article's ten parameters at the joint minimum."""
    layout, article = problem.layout, problem.layout.at("article")
    C = inverse(solution.normal.matrix)
    structure = problem.campaigns[0].structure
    return Identified(
        way="self-calibrated",
        inertia=Inertia(parameters=solution.x[article]),
        covariance=C[article, article],
        band=problem.band,
        elastic=None if structure.elastic is None else structure.terms(layout, solution.x),
        shares=shares(layout, solution),
        misfit=misfit(problem, solution, C, settings),
        surprise=surprise(layout, solution.x),
        converged=solution.converged,
        warnings=problem.warnings if solution.converged else (*problem.warnings, _unconverged(solution)),
    )


def shares(layout: Layout, solution: Solution) -> dict[str, Array]:
    """By input, its share (10,) of the variance of the article's parameters."""
    article = layout.at("article")
    C = inverse(solution.normal.matrix)[article]
    rows, _, families = layout.knowledge
    spread = np.square(C @ rows.T)
    parts = {family: spread[:, [one == family for one in families]].sum(axis=1) for family in dict.fromkeys(families)}
    noise = _spread(C, solution.data.matrix)
    rigid = np.minimum(noise, _with_elastic_held(layout, solution))
    parts = {NOISE: rigid, **parts, FAMILY: parts.get(FAMILY, 0.0) + noise - rigid}
    whole = np.sum(list(parts.values()), axis=0)
    return {name: part / whole for name, part in parts.items() if np.any(part > 0)}


def _with_elastic_held(layout: Layout, solution: Solution) -> Array:
    """(10,) variance that noise gives the article's parameters where the elastic ones are known."""
    article = layout.at("article")
    rigid = np.flatnonzero([not name.startswith("elastic:") for name in layout.owners])
    chosen = np.ix_(rigid, rigid)
    own = np.searchsorted(rigid, np.arange(article.start, article.stop))
    return _spread(inverse(solution.normal.matrix[chosen])[own], solution.data.matrix[chosen])


def _spread(gain: Array, matrix: Array) -> Array:
    """Diagonal of ``gain @ matrix @ gain.T``."""
    return np.asarray(np.sum((gain @ matrix) * gain, axis=1))


def misfit(problem: Assembly, solution: Solution, C: Array, settings: Settings) -> float:
    """Chi² of the data for each degree of freedom; the parameters count as far as the data, not the priors, determine them."""
    size = sum(part.observed.size for part in problem.parts(settings.floor))
    effective = float(np.sum(C * solution.data.matrix))
    return 2 * solution.data.cost / (size - effective)


def surprise(layout: Layout, x: Array) -> float:
    """Sum z² of the tolerances of the measurement chain."""
    return float(
        sum(np.sum(np.square(one.rows @ x[layout.at(one.name)])) for one in layout.blocks if one.name.startswith("chain:"))
    )


def terms_of(problem: Assembly, x: Array) -> ElasticTerms:
    """The article's elastic terms at `x`."""
    return problem.campaigns[0].structure.terms(problem.layout, x)


def _unconverged(solution: Solution) -> str:
    return (
        f"the joint fit did not converge: after {solution.evaluations} evaluations the next step is still "
        f"{solution.decrement:.3g} standard deviations; do not trust its figures"
    )
