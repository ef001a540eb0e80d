"""`rigid-inertia`."""

from __future__ import annotations

from validation.effects.family import STRUCTURE, Family
from validation.effects.sizes import FIRST, MASS, SECOND

FAMILY = Family(
    name="rigid-inertia",
    side=STRUCTURE,
    what="a parameter of the article, about its centre of gravity",
    targets=("parameter",),
    sizes=SECOND,
    varying={"m": MASS, "mx": FIRST, "my": FIRST, "mz": FIRST},
    example="rigid-inertia:Ixx=0.2",
)
