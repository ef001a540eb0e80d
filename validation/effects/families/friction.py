"""`friction`."""

from __future__ import annotations

from validation.effects.family import AMPLITUDE, Family, Size

FAMILY = Family(
    name="friction",
    side=AMPLITUDE,
    what="slip force of a loose part on the flange",
    targets=("joint", "lateral axis"),
    sizes=(
        Size(unit="N", low=1e-3, high=1e6),
        Size(key="mass", unit="kg", low=1e-3, high=1e3, default=2.0),
    ),
    example="friction:flange:x=3",
)
