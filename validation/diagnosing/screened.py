"""`Screened`: what a straight line says of one candidate."""

from __future__ import annotations

from dataclasses import dataclass

from validation.engine.parameter import Parameter
from validation.engine.screening import Told
from validation.models.model import Added


@dataclass(frozen=True, eq=False, kw_only=True)
class Screened:
    """What a straight line says of a candidate.

    Attributes
    ----------
    added : at the size that it says
    evidence : [nats]
    told : its parameter; of a resonator the mass at the best frequency
    plausible : standard deviation of a plausible fault, in the offset of the parameter
    parameter : that the straight line is along, which says what its offset means; None of resonators and of periods
    usual : of a resonator what the data say of its mass at a frequency and damping at which they say neither much nor little
    """

    added: Added
    evidence: float
    told: Told
    plausible: float
    parameter: Parameter | None = None
    usual: Told | None = None

    @property
    def id(self) -> str:
        """Of the effect."""
        return self.added.named.id
