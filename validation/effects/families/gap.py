"""`gap`."""

from __future__ import annotations

from validation.effects.family import AMPLITUDE, Family, Size

FAMILY = Family(
    name="gap",
    side=AMPLITUDE,
    what="preload at which a load cell lifts off",
    targets=("cell",),
    sizes=(Size(unit="N", low=1e-3, high=1e6),),
    example="gap:1=500",
)
