"""`sweep-bias`."""

from __future__ import annotations

from validation.effects.family import PROCESSING, Family

FAMILY = Family(name="sweep-bias", side=PROCESSING, what="peak-hold near a lightly damped mode", example="sweep-bias")
