"""`board-delay`."""

from __future__ import annotations

from validation.effects.family import FORCES, Family
from validation.effects.sizes import DELAY

FAMILY = Family(
    name="board-delay",
    side=FORCES,
    what="all channels of a board are late",
    targets=("board",),
    sizes=DELAY,
    example="board-delay:force=200e-6",
)
