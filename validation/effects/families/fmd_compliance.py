"""`fmd-compliance`."""

from __future__ import annotations

from validation.effects.family import FORCES, Family, Size

FAMILY = Family(
    name="fmd-compliance",
    side=FORCES,
    what="factor on the compliance of all load cells",
    targets=("direction of the FMD",),
    sizes=(Size(unit="1", low=1e-3, high=1e3),),
    example="fmd-compliance:lateral=3",
)
