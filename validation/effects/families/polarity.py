"""`polarity`."""

from __future__ import annotations

from validation.effects.family import MISTAKE, Family
from validation.effects.targets import CHANNEL

FAMILY = Family(name="polarity", side=MISTAKE, what="a channel is inverted", targets=(CHANNEL,), example="polarity:fmd-z2")
