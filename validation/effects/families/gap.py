"""`gap`."""

from __future__ import annotations

from math import inf

from validation.effects.effect import AMPLITUDE, CHANNEL_STAGE, Family, SizeSpec
from validation.effects.plants import at
from validation.effects.stages import lifted

FAMILY = Family(
    name="gap",
    side=AMPLITUDE,
    what="preload at which a load cell lifts off",
    targets=("cell",),
    sizes=(SizeSpec(unit="N", low=1e-3, high=1e6, null=inf, plausible=2.0, logarithmic=True),),
    example="gap:1=500",
    stage=CHANNEL_STAGE,
    change=lifted,
    equation="f' = max(f, -P); of a sine of amplitude a > P: f (1/2 + (asin p + p √(1 - p²)) / π), p = P / a; "
    "the other cells take over",
    mistaken_for=("cell-stiffness", "saturation", "force-gain"),
    confirmed_by="a second level; that cell's own channel in time, flat at one side; torque of its bolt",
    reference="describing function of a one-sided clipped sine (Gelb and Vander Velde, Multiple-Input Describing Functions)",
    sentence="Cell {target} has lost its pre-stress: where the load pulls harder than what is left, the plate lifts off it and "
    "teeters on the other three. The sums hardly change, the single channels do.",
    plant=at("rig", "gap"),
)
