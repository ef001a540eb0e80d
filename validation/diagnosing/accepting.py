"""When an effect is accepted, and when every name is refused: limits that were set from tests in which nothing is wrong.

The figures behind them are those of `python -m benchmarks.blind --draw development`; docs/diagnosis-proven-blind.md tells them.
"""

from __future__ import annotations

from dataclasses import dataclass

from validation.comparing.verdicts import expected_z2, largest_z, misfit
from validation.engine.evaluation import Fit

WORTH = 10.0
"""[nats] of evidence that an effect must bring to be named."""

ALIKE = 5.0
"""[nats] within which two explanations are as good as each other."""

MISFIT = 0.95
"""Chi² per degree of freedom up to which a model may miss nothing: the model-error floor is a bound, and a null stays below 1."""

UNLIKELY = 1e-4
"""Probability of a sum of z² below which tolerances pay for something."""

ABSURD = 4.8
"""z of one tolerance of some four hundred that is no chance."""


@dataclass(frozen=True, kw_only=True)
class Standing:
    """How a fit stands against those of nulls.

    Attributes
    ----------
    misfit : chi² per degree of freedom
    price : sum of z² over what is due
    largest : |z| of the tolerance that moved farthest
    likely : probability of such a sum of z², where nothing is wrong
    """

    misfit: float
    price: float
    largest: float
    likely: float

    @property
    def null(self) -> bool:
        """Whether nothing more need be missing."""
        return self.misfit <= MISFIT and self.likely >= UNLIKELY and self.largest < ABSURD

    @property
    def text(self) -> str:
        """Why not, in words; empty where nothing more need be missing."""
        said = []
        if self.misfit > MISFIT:
            said.append(f"chi² per degree of freedom is {self.misfit:.3g}, where nulls stay below {MISFIT:g}")
        if self.likely < UNLIKELY:
            said.append(f"the tolerances pay {self.price:.3g} times what is due")
        if self.largest >= ABSURD:
            said.append(f"one of them stands at {self.largest:.1f} z")
        return "; ".join(said)


def standing(fit: Fit) -> Standing:
    """Of a fit of all tolerances."""
    from scipy.stats import chi2

    due = max(expected_z2(fit), 1.0)
    return Standing(
        misfit=misfit(fit),
        price=fit.tolerance_z2 / due,
        largest=largest_z(fit),
        likely=float(chi2.sf(fit.tolerance_z2, due)),
    )
