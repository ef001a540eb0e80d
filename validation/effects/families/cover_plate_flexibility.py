"""`cover-plate-flexibility`."""

from __future__ import annotations

from validation.effects.family import ACCELERATIONS, Family, Size

FAMILY = Family(
    name="cover-plate-flexibility",
    side=ACCELERATIONS,
    what="the cover plate gives under the vertical force",
    sizes=(Size(unit="m/N", low=0.0, high=1e-4),),
    example="cover-plate-flexibility=1e-9",
)
