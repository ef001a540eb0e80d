"""`load-path-shunt`."""

from __future__ import annotations

from validation.effects.family import FORCES, Family
from validation.effects.sizes import relative

FAMILY = Family(
    name="load-path-shunt",
    side=FORCES,
    what="share of the force along an axis that passes the cells by",
    targets=("axis",),
    sizes=relative(0.0, 0.95),
    example="load-path-shunt:x=0.03",
)
