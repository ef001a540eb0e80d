"""What may be planted: one `Choice` for every kind of effect that acts in a linear test, with the places where it may act.

A draw takes one place of every choice. Places that these series cannot show at all are not among them: a pick-up that is
moved along its own axis reads what it did. Sizes that are no physics of a test any more are cut off at `largest`.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from typing import Any

from benchmarks.blind.drawing.case import SERIES, WHOLE_SERIES
from validation.effects.effect import AXES, COVER, FMD, TABLE


@dataclass(frozen=True, kw_only=True)
class Choice:
    """One kind of effect.

    Attributes
    ----------
    family : of the catalogue
    targets : what stands behind the family in the identifier, by place; an empty one for a family without
    articles : of the series in which it is planted
    signed : whether it is negative as often as positive
    largest : size beyond which nobody would call it a fault of a test; in the unit of its first number
    least : size below which it is drawn without a sign turned: a body may not lose more than it has
    words : values of which one is drawn, of what has no size that grows
    structural : whether it counts as an effect of the structure
    """

    family: str
    targets: tuple[str, ...] = ("",)
    articles: tuple[str, ...] = SERIES
    signed: bool = False
    largest: float = float("inf")
    least: float = float("inf")
    words: tuple[str, ...] = ()
    structural: bool = False

    @property
    def ids(self) -> tuple[str, ...]:
        """Identifiers without a value, by place."""
        return tuple(":".join(filter(None, (self.family, target))) for target in self.targets)


def _structural(family: str, *targets: str, **more: Any) -> Choice:
    return Choice(family=family, targets=targets or ("",), structural=True, **more)


def across(channels: tuple[str, ...]) -> tuple[str, ...]:
    """Every channel with each of the two axes across the one along which it measures."""
    return tuple(f"{name}:{axis}" for name in channels for axis in AXES if axis != name.split("-")[1][0])


def crossed(channels: tuple[str, ...]) -> tuple[str, ...]:
    """Every pair of `channels`."""
    return tuple(f"{one}:{other}" for k, one in enumerate(channels) for other in channels[k + 1 :])


PAIRS_OF_AXES = tuple(i + j for i in AXES for j in AXES if i != j)

CHOICES = (
    _structural("point-mass", "mast-top", signed=True, least=0.3),
    _structural("point-mass", "lower-1+", "lower-1-", signed=True, least=0.3),
    _structural("rigid-inertia", "m", signed=True, largest=3.0, least=1.5),
    _structural("rigid-inertia", "mx", "my", signed=True, largest=0.8),
    _structural("rigid-inertia", "mz", signed=True, largest=2.5, least=0.3),  # a Cuboid that has lost more is no body
    _structural("rigid-inertia", "Ixx", "Iyy", "Izz", largest=1.0, least=0.3),
    _structural("rigid-inertia", "Ixz", "Iyz", signed=True, largest=0.11),  # no Cuboid on its disc has more
    _structural("modulus", "mast", signed=True, largest=0.6),
    _structural("modulus", "lower-1", signed=True, largest=0.6),
    _structural("modulus", "upper-long", signed=True, largest=0.6, articles=WHOLE_SERIES),
    _structural("joint-compliance", "rotation"),
    _structural("joint-compliance", "lateral", "vertical", "torsion"),
    _structural("structural-damping", "mast", largest=0.1),
    _structural("structural-damping", "lower-1", largest=0.1),
    _structural("layer-damping", "upper-short", largest=0.7, articles=WHOLE_SERIES),
    _structural("appendage", "x", "y", "z"),
    _structural("absorber", "mast-top", "lower-1+", "hub-1"),
    _structural("slosh", "mast-top"),
    _structural("cable", "mast-top:lateral", "mast-top:vertical", "lower-1+:vertical", "lower-1-:vertical"),
    _structural("orientation", "z", signed=True, largest=0.3),
    _structural("mounting-offset", "x", "y", signed=True, largest=0.03),
    _structural("gravity", words=("0",)),
    Choice(family="force-gain", targets=("fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4"), signed=True, largest=0.4),
    Choice(family="force-gain", targets=("fmd-x12", "fmd-x34", "fmd-y14", "fmd-y23"), signed=True, largest=0.4),
    Choice(family="load-path-shunt", targets=AXES, largest=0.4),
    Choice(family="force-delay", targets=FMD, signed=True, largest=5e-3),
    Choice(family="board-delay", targets=("force", "cover", "table"), signed=True, largest=5e-3),
    Choice(family="force-highpass", targets=FMD, largest=3.0),
    Choice(family="force-crosstalk", targets=PAIRS_OF_AXES, signed=True, largest=0.2),
    Choice(family="force-plane-offset", targets=("x", "y"), signed=True, largest=0.05),
    Choice(family="fmd-compliance", targets=("lateral", "vertical"), largest=30.0),
    Choice(family="cell-stiffness", targets=tuple(f"{k}{axis}" for k in range(1, 5) for axis in AXES), largest=5.0),
    Choice(family="accelerometer-gain", targets=COVER, signed=True, largest=0.4),
    Choice(family="accelerometer-gain", targets=TABLE, signed=True, largest=0.6),
    Choice(family="accelerometer-delay", targets=(*COVER, *TABLE), signed=True, largest=5e-3),
    Choice(family="accelerometer-position", targets=across(COVER), signed=True, largest=0.05),
    Choice(family="accelerometer-misalignment", targets=across((*COVER, *TABLE)), signed=True, largest=0.15),
    Choice(family="accelerometer-tilt", words=("0",)),
    Choice(family="cover-plate-flexibility"),
    Choice(family="polarity", targets=(*COVER, *TABLE, *FMD), words=("",)),
    Choice(family="channel-swap", targets=(*crossed(COVER), *crossed(TABLE), *crossed(FMD)), words=("",)),
    Choice(family="unit", targets=(*COVER, *TABLE), words=("g", "mm/s^2")),
)

FREQUENCIES: Mapping[str, tuple[float, float]] = {
    "appendage": (8.0, 28.0),
    "absorber": (8.0, 28.0),
    "slosh": (5.0, 9.0),
}
"""[Hz] between which a resonator's own is drawn."""

DAMPING = (0.01, 0.05)
"""Between which its damping ratio is drawn."""

ALSO: Mapping[str, tuple[str, ...]] = {
    "point-mass": ("rigid-inertia", "absorber", "slosh"),
    "rigid-inertia": ("point-mass", "mounting-offset"),
    "mounting-offset": ("rigid-inertia",),
    "structural-damping": ("layer-damping",),
    "layer-damping": ("structural-damping",),
    "appendage": ("absorber", "slosh"),
    "absorber": ("appendage", "slosh"),
    "slosh": ("appendage", "absorber"),
    "gravity": ("accelerometer-tilt",),
    "accelerometer-tilt": ("gravity",),
    "force-gain": ("unit", "polarity"),
    "accelerometer-gain": ("unit", "polarity"),
    "unit": ("force-gain", "accelerometer-gain"),
}
"""By family, others that can be the same physics: a stiff absorber is a point mass, a liquid in a rigid tank is an absorber, a
shifted body has other first moments. What a diagnosis is to find unknown it must have by none of these names."""


def without(family: str) -> tuple[str, ...]:
    """The families that a diagnosis must not have for `family` to be unknown to it, that one first."""
    return (family, *ALSO.get(family, ()))
