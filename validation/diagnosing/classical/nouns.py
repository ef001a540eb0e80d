"""`SwingAnswer`: what a diagnosis of classical measurements alone says, with everything that it rests on."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

from validation.diagnosing.diagnosis import Advice, Cause, Detectable, Leftover

UNITS = ("kg", "m", "m", "m", *("kg m^2",) * 6)
"""SI, of the quantities of `identification.classical`."""


@dataclass(frozen=True, kw_only=True)
class Beside:
    """One measurement beside the model.

    Attributes
    ----------
    name : file and quantity
    quantity : what was measured, in words: "period of swing 2"
    predicted, measured, deviation : SI, the last one standard deviation of the measured
    unit : of them
    sigma : (predicted - measured) / deviation
    period : [s] measured, of a swing; 0 of anything else
    period_shift : how much longer than the model's it is, as a share; 0 of anything else
    """

    name: str
    quantity: str
    predicted: float
    measured: float
    deviation: float
    unit: str
    sigma: float
    period: float = 0.0
    period_shift: float = 0.0


@dataclass(frozen=True, kw_only=True)
class Needed:
    """How large an effect would have to be to explain the measurements by itself.

    Attributes
    ----------
    id : of the effect
    value, unit : SI
    plausible : what a fault of it may be, one standard deviation
    possible : whether any size that a test may have explains them; False for one that can only move them the other way
    fits : whether what is then left is what tolerances leave
    evidence : [nats] against the model without it
    text : all of it in words
    """

    id: str
    value: float
    unit: str
    plausible: float
    possible: bool
    fits: bool
    evidence: float
    text: str


@dataclass(frozen=True, kw_only=True)
class Reading:
    """An input of a measurement that would explain the deviation, were it wrong.

    Attributes
    ----------
    name : "rope length"
    value, change : as it stands, and by how much it would have to be wrong, SI
    tolerances : the same in its tolerances (95 %)
    of : measurements that it enters
    """

    name: str
    value: float
    change: float
    tolerances: float
    of: tuple[str, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class SwingAnswer:
    """The answer.

    Attributes
    ----------
    title : of the model
    source : the model's file
    verdict : of `validation.diagnosing.diagnosis.VERDICTS`
    text : the answer in words
    accepted : what is missing; of several that these data cannot tell apart none
    ranking : all that was tried, the best first
    equivalence_class : ids that these data cannot tell apart, the best first; one where there is no doubt
    advice : measurements that would tell them apart, the best first
    leftover : of an unknown effect
    detectable : the smallest size at which each effect would have been named
    facts : every measurement beside the model
    needed : by effect the size that would explain the measurements by itself
    readings : inputs that would explain them, were they wrong, the least wrong first
    chi2, measurements : of the model without any effect, and how many numbers were measured
    remarks : what should be known
    settings : thresholds
    """

    title: str
    source: str
    verdict: str
    text: str
    accepted: tuple[Cause, ...] = ()
    ranking: tuple[Cause, ...] = ()
    equivalence_class: tuple[str, ...] = ()
    advice: tuple[Advice, ...] = ()
    leftover: Leftover | None = None
    detectable: tuple[Detectable, ...] = ()
    facts: tuple[Beside, ...]
    needed: tuple[Needed, ...] = ()
    readings: tuple[Reading, ...] = ()
    chi2: float
    measurements: int
    remarks: tuple[str, ...] = ()
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))

    @property
    def next_measurement(self) -> str:
        """The best advice in words; empty where there is none."""
        return self.advice[0].test if self.advice else ""
