"""`force-highpass`."""

from __future__ import annotations

from validation.effects.family import FORCES, Family, Size
from validation.effects.targets import FORCE

FAMILY = Family(
    name="force-highpass",
    side=FORCES,
    what="first-order corner of a charge amplifier",
    targets=(FORCE,),
    sizes=(Size(unit="Hz", low=0.0, high=100.0),),
    example="force-highpass:fmd-x12=0.3",
)
