"""`friction`: a loose part on the flange that slips once it is shaken hard enough."""

from cmath import exp as cexp
from dataclasses import replace
from math import acos, asin, cos, inf, pi, sin, sqrt

import numpy as np

from geometry.frames import rigid_transformation
from validation.effects.effect import AMPLITUDE, AXES, BODY_STAGE, Family, SizeSpec, Values
from validation.effects.plants import at
from validation.effects.stages import MountedDynamicMass

ALWAYS_SLIPPING = 1 / sqrt(1 + pi**2 / 4)
"""Slip force over inertia force, 0.537, below which the part never rests."""


def change(stage: MountedDynamicMass, targets: tuple[str, ...], values: Values) -> MountedDynamicMass:
    """The part's mass along the two axes that carry it, and along the loose one the share of it that the run moves along."""
    force, mass = values[""], values["mass"]
    if not force:
        return stage  # nothing to hold a part: there is none
    loose = AXES.index(targets[1])
    driven = abs(float(rigid_transformation(stage.seat)[loose] @ stage.amplitude))
    along = np.repeat([1.0 + 0.0j, 0.0], 3)
    along[loose] = describing_function(force / (mass * driven) if driven else inf)
    return replace(stage, matrix=stage.matrix + mass * np.diag(along))


def describing_function(share: float) -> complex:
    """First harmonic of the friction force on a part over the inertia force that would move it along, harmonic balance.

    Parameters
    ----------
    share : slip force over mass times amplitude of acceleration. From 1 on the part sticks; below `ALWAYS_SLIPPING` its speed is
        a triangle, in between it rests twice a period.
    """
    if share >= 1:
        return 1.0 + 0.0j
    if share <= ALWAYS_SLIPPING:
        late = asin(pi * share / 2)
        return 4 * share / pi * (sin(late) - 1j * cos(late))
    begin = -acos(share)
    # Angle at which a part that began to slip at `begin` has the speed of its base again, by bisection
    low, high = -begin, pi + begin
    for _ in range(60):
        middle = (low + high) / 2
        ahead = sin(middle) - sin(begin) - share * (middle - begin) > 0
        low, high = (middle, high) if ahead else (low, middle)
    end = (low + high) / 2
    slipping = share * 1j * (cexp(-1j * end) - cexp(-1j * begin))
    return 2 / pi * (slipping + _stuck(pi + begin) - _stuck(end))


def _stuck(angle: float) -> complex:
    """Integral of cos e^{-i} up to `angle`."""
    return angle / 2 + 0.25j * cexp(-2j * angle)


FAMILY = Family(
    name="friction",
    side=AMPLITUDE,
    what="slip force of a loose part on the flange",
    targets=("joint", "lateral axis"),
    sizes=(
        SizeSpec(unit="N", low=1e-3, high=1e6, plausible=1.0, logarithmic=True),
        SizeSpec(key="mass", unit="kg", low=1e-3, high=1e3, default=2.0),
    ),
    example="friction:flange:x=3",
    stage=BODY_STAGE,
    change=change,
    equation="H_xx += m N(F / m a): 1 while it sticks; (4/π)s (sin α - i cos α), sin α = πs/2, while it always slips",
    mistaken_for=("structural-damping", "point-mass:flange", "force-gain"),
    confirmed_by="a second drive level: the apparent mass falls as the level grows; odd harmonics in the time record",
    reference="J. P. Den Hartog, Trans. ASME 53 (1931), 107; B. Westermo and F. Udwadia, Earthquake Engineering and "
    "Structural Dynamics 11 (1983), 135",
    sentence="Something lies loose on the {target} and slips when it is shaken hard: below the slip force it is a mass, above it "
    "takes energy and weighs less.",
    plant=at("rig", "friction"),
)
