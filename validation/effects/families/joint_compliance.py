"""`joint-compliance`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import SHIFTING, TURNING

FAMILY = Family(
    name="joint-compliance",
    side=STRUCTURE,
    what="compliance of the joint between flange and cover plate",
    targets=("direction of the joint",),
    sizes=SHIFTING,
    varying={"rotation": TURNING, "torsion": TURNING},
    example="joint-compliance:rotation=1e-6",
)
