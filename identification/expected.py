"""What a campaign that has not been run would tell: the covariance of the joint fit at its own solution, before any data.

The likelihood of the joint fit needs no measured numbers to say how sharp it is, only what is planned: channels, base motions,
noise, tolerances and about what the article will be. The covariance (J^T J + priors)^-1 is linearised at the planned truth; the
spectra handed in are those that exact channels would read. A sensor is left out by its weight, zero in every campaign.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array
from identification.evidence import Evidence, Known, Settings
from identification.identified import Identified
from identification.plain import plain
from identification.self_calibration.assembly import Assembly, assembled
from identification.self_calibration.calibrated import fitted
from identification.self_calibration.layout import Layout
from identification.self_calibration.likelihood import Rows, normal
from identification.self_calibration.problem import Part
from identification.self_calibration.result import identified
from identification.self_calibration.solve import inverse


@dataclass(frozen=True, eq=False, kw_only=True)
class Expected:
    """What a planned campaign would tell about the article's ten parameters about F.

    Attributes
    ----------
    best : self-calibrated, with everything that is planned
    plain : by Eqs. 6 to 11 from the same
    untared : (10, 10) covariance when there is no tare and the FMD is known as before; None where none is planned anyway
    without : by channel, (10, 10) covariance when it is lost in all campaigns
    """

    best: Identified
    plain: Identified
    untared: Array | None
    without: Mapping[str, Array]

    def __post_init__(self) -> None:
        object.__setattr__(self, "without", MappingProxyType(dict(self.without)))


def expected(
    evidence: Evidence,
    settings: Settings,
    fmd: Known,
    *,
    lost: bool = True,
    progress: Callable[[float], None] | None = None,
) -> Expected:
    """What `evidence`, planned and exact, would tell.

    Parameters
    ----------
    fmd : what is known of the FMD without any tare
    lost : whether every channel is left out in turn
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    BadInput : channels that do not tell six motions and six loads.
    """
    tell = progress or (lambda share: None)
    plainly = plain(evidence, settings, progress=lambda share: tell(0.3 * share))
    problem = assembled(evidence, settings)
    tell(0.4)
    solution = fitted(problem, settings, progress=lambda share: tell(0.4 + 0.2 * share))
    planned = [_at(part, problem.layout, solution.x) for part in problem.parts(settings.floor)]
    names = problem.campaigns[0].chain.names if lost else ()
    without = {}
    for k, name in enumerate(names):
        tell(0.6 + 0.4 * k / len(names))
        without[name] = covariance(problem, [_information(one, blind=name) for one in planned])
    untared = covariance(problem, [_information(planned[0]), _known(problem, fmd)]) if evidence.tares else None
    tell(1.0)
    return Expected(best=identified(problem, solution, settings), plain=plainly, untared=untared, without=without)


def covariance(problem: Assembly, information: Sequence[Array]) -> Array:
    """(10, 10) of the article's parameters from `information` (k, k) about the joint vector, and the priors."""
    rows, article = problem.layout.knowledge[0], problem.layout.at("article")
    return inverse(np.sum(information, axis=0) + rows.T @ rows)[article, article]


@dataclass(frozen=True, eq=False, kw_only=True)
class _At:
    """A campaign at the planned truth: how its channels answer to everything, which no weight changes."""

    part: Part
    rows: Rows
    selection: Array


def _at(part: Part, layout: Layout, x: Array) -> _At:
    return _At(part=part, rows=part.rows(layout, x), selection=part.selection(layout))


def _information(one: _At, blind: str | None = None) -> Array:
    """J^T J (k, k) of a campaign, to which the channel `blind` says nothing."""
    observed = one.part.observed
    if blind is not None:
        weight = observed.weight.copy()
        weight[:, :, one.part.chain.names.index(blind)] = 0.0
        observed = replace(observed, weight=weight)
    return np.asarray(one.selection.T @ normal(observed, one.rows).matrix @ one.selection)


def _known(problem: Assembly, fmd: Known) -> Array:
    """Information (k, k) about the FMD that was there before."""
    size = len(problem.layout)
    at = problem.layout.at(problem.campaigns[0].structure.bodies[0].block)
    information = np.zeros((size, size))
    information[at, at] = inverse(fmd.covariance)
    return information
