"""`Identified`: ten inertia parameters with their covariance, and where their uncertainty comes from."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from geometry.arrays import Array, frozen
from geometry.inertia import Inertia
from identification.elastic.terms import ElasticTerms

PARAMETERS = ("m", "mx", "my", "mz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
"""Order of Eq. 4."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Identified:
    """One result of one way of identification.

    Attributes
    ----------
    way : "plain" (Eqs. 6 to 11, then Eqs. 1 and 4) or "self-calibrated"
    inertia : about the reference point of the campaign, F
    covariance : (10, 10) of the parameters of Eq. 4 about the same point, every tolerance in it
    band : (low, high) [Hz]
    elastic : auxiliary terms; None when the structure was taken for rigid
    shares : by the name of an input (noise, "force-gain", "accelerometer-position", "tare", "elasticity", ...) its share of the
        variance of each of the ten, (10,); they add up to 1
    misfit : chi² for each degree of freedom; nan where noise is not known
    surprise : sum z² of the tolerances that were estimated; 0 for the plain way
    tolerances : how many these are
    converged : whether the iteration ended by itself
    resonance : [Hz] the lowest one in sight of a structure that was taken for rigid all the same; None otherwise
    parts : by input its part (10, 10) of the covariance; they add up to it
    gained : by the name of a classical result, how many times wider each interval would be without it, (10,)
    resampled : (10, 10) covariance by the block bootstrap, which does not take lines for independent; None where not made
    raw : (10,) about F from the raw spectra instead of H, of the plain way; None otherwise
    warnings : sentences
    """

    way: str
    inertia: Inertia
    covariance: Array
    band: tuple[float, float]
    elastic: ElasticTerms | None = None
    shares: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    misfit: float = float("nan")
    surprise: float = 0.0
    tolerances: int = 0
    converged: bool = True
    resonance: float | None = None
    parts: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    gained: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))
    resampled: Array | None = None
    raw: Array | None = None
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "covariance", frozen(self.covariance, (10, 10), "covariance"))
        for field_name, shape in {"shares": (10,), "parts": (10, 10), "gained": (10,)}.items():
            given = getattr(self, field_name).items()
            kept = {name: frozen(np.asarray(one), shape, f"{field_name}.{name}") for name, one in given}
            object.__setattr__(self, field_name, MappingProxyType(kept))


def counts(ways: Sequence[Identified]) -> int:
    """Which of the results of one article, the paper's own way first, is the one that counts.

    The last one, unless it did not converge, or blamed the sensors for the elasticity of a structure that was taken for rigid.
    """
    sound = [k for k, one in enumerate(ways) if one.converged and one.resonance is None]
    return max(sound, default=0)
