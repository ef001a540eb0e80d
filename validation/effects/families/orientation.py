"""`orientation`."""

from __future__ import annotations

from math import pi

from validation.effects.family import STRUCTURE, Family, Size

FAMILY = Family(
    name="orientation",
    side=STRUCTURE,
    what="the article turned on the cover plate",
    targets=("turning axis",),
    sizes=(Size(unit="rad", low=-pi, high=pi),),
    example="orientation:z=0.01",
)
