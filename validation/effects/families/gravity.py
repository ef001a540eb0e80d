"""`gravity`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import SWITCH

FAMILY = Family(
    name="gravity", side=STRUCTURE, what="the structure's half of gravity, 1 on or 0 off", sizes=SWITCH, example="gravity=0"
)
