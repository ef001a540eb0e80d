"""`mains`."""

from __future__ import annotations

from validation.effects.family import PROCESSING, Family, Size

FAMILY = Family(
    name="mains",
    side=PROCESSING,
    what="mains hum in every channel, as a factor on the ordinary one",
    sizes=(Size(unit="1", low=0.0, high=1e4),),
    example="mains=5",
)
