from dataclasses import replace
from math import inf

import numpy as np

from geometry.frames import Array
from validation.effects.effect import AMPLITUDE, CHANNEL_STAGE, Family, SizeSpec, Values
from validation.effects.plants import at
from validation.effects.stages import ChannelResponse

WARP = {"1": (1, -1, 1, -1), "2": (-1, 1, -1, 1), "3": (1, -1, 1, -1), "4": (-1, 1, -1, 1)}
"""What four cells on a square, numbered around, can carry against each other without any resultant."""

CELLS = ("fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4")


def change(reading: ChannelResponse, targets: tuple[str, ...], values: Values) -> ChannelResponse:
    """A cell pulls no more than its preload. What it lacks goes to the other three, in the one pattern that has no resultant."""
    cell = reading.column(CELLS[int(targets[0]) - 1])
    lost = 1 - clipped(values[""], reading.amplitude_of(cell))
    rows, missing = np.array(reading.rows), lost[:, None] * reading.rows[:, cell]
    for name, share in zip(CELLS, WARP[targets[0]], strict=True):
        rows[:, reading.column(name)] -= share * missing
    return replace(reading, rows=rows)


def clipped(preload: float, amplitude: Array) -> Array:
    """(n,) share of the fundamental that is left of a sine of `amplitude` (n,) cut off at -`preload` on one side."""
    p = np.divide(np.minimum(preload, amplitude), amplitude, out=np.ones_like(amplitude), where=amplitude > 0)
    return np.asarray(0.5 + (np.arcsin(p) + p * np.sqrt(1 - p**2)) / np.pi)


FAMILY = Family(
    name="gap",
    side=AMPLITUDE,
    what="preload at which a load cell lifts off",
    targets=("cell",),
    sizes=(SizeSpec(unit="N", low=1e-3, high=1e6, null=inf, plausible=2.0, logarithmic=True),),
    example="gap:1=500",
    stage=CHANNEL_STAGE,
    change=change,
    equation="f' = max(f, -P); of a sine of amplitude a > P: f (1/2 + (asin p + p √(1 - p²)) / π), p = P / a; "
    "the other cells take over",
    mistaken_for=("cell-stiffness", "saturation", "force-gain"),
    confirmed_by="a second level; that cell's own channel in time, flat at one side; torque of its bolt",
    reference="describing function of a one-sided clipped sine (Gelb and Vander Velde, Multiple-Input Describing Functions)",
    sentence="Cell {target} has lost its pre-stress: where the load pulls harder than what is left, the plate lifts off it and "
    "teeters on the other three. The sums hardly change, the single channels do.",
    plant=at("rig", "gap"),
)
