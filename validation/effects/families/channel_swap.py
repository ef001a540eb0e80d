"""`channel-swap`."""

from __future__ import annotations

from validation.effects.family import MISTAKE, Family
from validation.effects.targets import CHANNEL

FAMILY = Family(
    name="channel-swap",
    side=MISTAKE,
    what="the plugs of two channels are swapped",
    targets=(CHANNEL, CHANNEL),
    example="channel-swap:cover-z1:cover-z2",
)
