"""When an effect is accepted, and when every name is refused: limits that were set from tests in which nothing is wrong.

The figures behind them are those of `python -m benchmarks.blind --draw development`; docs/diagnosis-proven-blind.md tells them.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from math import sqrt

import numpy as np

from geometry.frames import Array
from validation.diagnose.diagnosis import Candidate
from validation.estimation.evaluate import evaluate
from validation.estimation.fit import FLOOR, unfitted
from validation.estimation.likelihood import observed
from validation.estimation.problem import FITTED, Evaluation, Fit, Offsets, Problem
from validation.estimation.verdicts import expected_z2, largest_z, misfit
from validation.study import Study

SCATTER = 3.0
"""[sd] that chi² per degree of freedom of a null may lie above what noise alone predicts: scatter of chi² and of the noise
estimate. The model-error floor is a bound that nulls do not use: they read 0.97 to 1.01 of the noise. Set by the development
draws of `make blind`, exercised by tests/validation/diagnosing/test_goodness_of_fit.py."""

UNLIKELY = 1e-4
"""[probability] of a sum of z² below which the tolerances pay for something that is missing. Set by the development draws of
`make blind`, exercised by tests/validation/diagnosing/test_goodness_of_fit.py."""

ABSURD = 4.8
"""[sd] of one tolerance, of some four hundred, that is no chance. Held by tests/validation/diagnosing/test_goodness_of_fit.py."""


@dataclass(frozen=True, kw_only=True)
class GoodnessOfFit:
    """How a fit stands against those of nulls.

    Attributes
    ----------
    misfit : chi² per degree of freedom
    limit : up to which it is that of a null
    prior_penalty : sum of z² of the tolerances over what is due
    largest : |z| of the tolerance that moved farthest
    likely : probability of such a sum of z², where nothing is wrong
    """

    misfit: float
    limit: float
    prior_penalty: float
    largest: float
    likely: float

    @property
    def null(self) -> bool:
        """Whether nothing more need be missing."""
        return self.misfit <= self.limit and self.likely >= UNLIKELY and self.largest < ABSURD

    @property
    def text(self) -> str:
        """Why not, in words; empty where nothing more need be missing."""
        said = []
        if self.misfit > self.limit:
            said.append(f"chi² per degree of freedom is {self.misfit:.3g}, where nulls stay below {self.limit:.2g}")
        if self.likely < UNLIKELY:
            said.append(f"the tolerances pay {self.prior_penalty:.3g} times what is due")
        if self.largest >= ABSURD:
            said.append(f"a tolerance stands at {self.largest:.1f} z")
        return "; ".join(said)


def goodness_of_fit(fit: Fit, problem: Problem) -> GoodnessOfFit:
    """Of a `fit` of all tolerances of `problem`."""
    from scipy.stats import chi2

    due = max(expected_z2(fit), 1.0)
    return GoodnessOfFit(
        misfit=misfit(fit),
        limit=misfit_of_noise(problem) * (1 + SCATTER * sqrt(2 / max(fit.degrees_of_freedom, 1) + misfit_sd(problem) ** 2)),
        prior_penalty=fit.tolerance_z2 / due,
        largest=largest_z(fit),
        likely=float(chi2.sf(fit.tolerance_z2, due)),
    )


def excess(fit: Fit, at: GoodnessOfFit) -> float:
    """How much the cost of a fit lies above that of a null [nats]."""
    chi2, z2 = fit.chi2 - at.limit * fit.degrees_of_freedom, fit.tolerance_z2 - expected_z2(fit)
    return 0.5 * (max(chi2, 0.0) + max(z2, 0.0))


def misfit_of_noise(problem: Problem) -> float:
    """Chi² per degree of freedom that noise alone would come to: its share s of the variance that the likelihood allows for.

    Noise is an estimate of relative variance v at a line, and its inverse is on average larger than that of what is estimated:
    by s v, to second order.
    """
    scatter = [one.measured.noise_scatter for one in problem.predictions]
    return float(np.mean(np.concatenate([s * (1 + s * sd**2) for s, sd in zip(_noise_shares(problem), scatter, strict=True)])))


def misfit_sd(problem: Problem) -> float:
    """Relative standard deviation of that, because the noise of each data set is an estimate."""
    sums = np.array([shares.sum() for shares in _noise_shares(problem)])
    spreads = np.array([one.measured.noise_spread for one in problem.predictions])
    return float(np.linalg.norm(spreads * sums) / max(sums.sum(), np.finfo(np.float64).tiny))


def _noise_shares(problem: Problem) -> Iterator[Array]:
    """Of every data set the share of noise in the variance of each line and channel, flat."""
    for one in problem.predictions:
        seen = observed(one.measured, problem.lines_of(one))
        noise = np.square(seen.noise)
        yield (noise / np.maximum(noise + np.square(FLOOR * seen.floor), np.finfo(np.float64).tiny)).ravel()


# The four errors of a candidate, quickly: at every third line, every run held out in turn.


Progress = Callable[[float], None]


def errors(data: Study, of: Candidate, progress: Progress | None = None) -> Evaluation:
    """Of the candidate `of`, whose fit is known; no configuration is held out."""
    return evaluate(data.whole(of.effects), hold_out=data.hold_out, fitted=of.fit, quick=True, progress=progress)


def errors_without_fit(data: Study, offsets: Offsets) -> Evaluation:
    """Of the model of `data` where no fit of all tolerances makes sense: they stand at `offsets`."""
    found = unfitted(data.problem(), FITTED, offsets)
    return evaluate(data.whole(), hold_out=data.hold_out, fitted=found, quick=True)
