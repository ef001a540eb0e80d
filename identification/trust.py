"""Whether the data bear the figures that came out of them: what contradicts itself is said before any interval.

An interval holds where the model does. Channels that disagree, a misfit far above what noise and model error leave, tolerances
that had to be bent far beyond what a laboratory is off by, a fit that did not settle: each says that the model does not hold,
and then no interval is worth its digits. Simulated laboratories with ordinary tolerances leave a misfit of 0.8 to 1.2 and a mean
z² of 0.7 to 1.2; a channel in a wrong unit leaves hundreds.
"""

from __future__ import annotations

from collections.abc import Iterable, Mapping
from math import sqrt

from identification.closed_checks import Finding
from identification.identified import Identified

MISFIT = 3.0
"""chi² per degree of freedom up to which noise and model error are what they were taken for."""

BENT = 3.0
"""Mean z² of the tolerances up to which they were bent no farther than those of an ordinary laboratory."""

BROKEN = 10.0
"""Tolerances beyond which a closed check without a suspect speaks against the data.

279 sound campaigns reached 3.6; spectra in files, whose noise is not known and counts as 0, a few more.
"""

TRUSTWORTHY, ELASTIC = "trustworthy", "dominated by elasticity"
"""How the verdicts begin that a failed model takes back, and those that have named the reason themselves."""

CORRECT = "correct the channel (`unit`, `direction`, or its name in the files) in campaign.toml and identify again"


def contradictions(checks: Iterable[Finding]) -> tuple[str, ...]:
    """Closed checks that fail, in words: a channel that is suspected by name, else everything that does not hold."""
    failed = [one for one in checks if not one.holds]
    named = [one.text for one in failed if one.suspects]
    return tuple(named or (one.text for one in failed if one.value > BROKEN or one.name == "diagonal"))


def failures(one: Identified) -> tuple[str, ...]:
    """What the fit itself says against its model, in words."""
    said = []
    if one.misfit > MISFIT:  # false where noise is not known
        said.append(f"the fit leaves {sqrt(one.misfit):.3g} times what noise and model error explain, a failed model")
    if one.tolerances and one.surprise > BENT * one.tolerances:
        rms = sqrt(one.surprise / one.tolerances)
        said.append(f"the {one.tolerances} tolerances had to be bent by {rms:.3g} standard deviations rms, a failed model")
    if not one.converged:
        said.append("the fit did not converge")
    return tuple(said)


def judged(told: Mapping[str, str], against: tuple[str, ...], failed: tuple[str, ...]) -> dict[str, str]:
    """The verdicts `told`, behind what speaks against all of them.

    Parameters
    ----------
    against : contradictions of the data, which come first in every verdict
    failed : failures of the fit; elasticity is a reason for these, so a verdict that names it stays
    """
    return {name: _judged(said, against or (() if said.startswith(ELASTIC) else failed)) for name, said in told.items()}


def _judged(said: str, against: tuple[str, ...]) -> str:
    if not against:
        return said
    advice = CORRECT if against[0].startswith("it looks as if") else "see what `massline check` says of the channels"
    kept = "" if said.startswith(TRUSTWORTHY) else f"; {said}"
    return f"not trustworthy: {against[0]}; {advice}{kept}"
