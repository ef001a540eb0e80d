"""Every effect of the catalogue that may act in these tests, each with how large a fault may be.

A fault has the catalogue's plausible size for its standard deviation. A resonator has three numbers; here its mass alone is open,
on the frequencies of `SWINGING`, with a standard deviation that is assumed.
"""

from __future__ import annotations

from collections.abc import Iterator
from dataclasses import dataclass, replace
from functools import cache
from itertools import product
from math import exp, pi

from geometry.articles import locations
from validation.effects.catalogue import FAMILIES, Named
from validation.effects.effect import ACCELERATIONS, FORCES, STRUCTURE, Family, Vocabulary

PARTS = ("mast", "lower-1")

SWINGING = (6.0,)
"""[Hz] of resonators that are tried, above the band of the reading: below its own frequency a resonator is a mass, and seven
numbers see no more of it."""

SWINGING_MASS = 0.5
"""[kg] standard deviation of their mass, assumed."""

LITTLE, LOSS = 1e-4, 0.02
"""Mass [kg] at which a resonator is as good as none, and its damping ratio."""

QUARTER = pi / 2
AXES = "x and y exchanged"
"""The one mistake beside the sizes of the catalogue, where it is `orientation:z` by a quarter turn: Clumod stood so from the axes
of the reference. Exchanged names of axes, in the processing or in a report, do the same to the seven numbers."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Candidate:
    """One effect that may be there.

    Attributes
    ----------
    named : at its null size
    key : of the size that is open
    unit : of it
    plausible : standard deviation of the size of a fault, in its unit; of the logarithm where `logarithmic`
    one_sided : whether it cannot be negative
    logarithmic : whether it is counted by its logarithm
    switch : whether it is there or not: switched off, its size is 1 less
    """

    named: Named
    key: str
    unit: str
    plausible: float
    one_sided: bool = False
    logarithmic: bool = False
    switch: bool = False

    @property
    def name(self) -> str:
        """The id, and the frequency of a resonator."""
        return f"{self.named.id} at {self.named.values['f']:g} Hz" if self.swings else self.named.id

    @property
    def swings(self) -> bool:
        """Whether it is a resonator."""
        return "f" in self.named.values

    @property
    def variants(self) -> tuple[Candidate, ...]:
        """A resonator at every frequency of `SWINGING`; itself where it is none."""
        return tuple(self.swinging_at(f) for f in SWINGING) if self.swings else (self,)

    def swinging_at(self, frequency: float) -> Candidate:
        """The same resonator at `frequency` [Hz]."""
        return replace(self, named=replace(self.named, values={**self.named.values, "f": frequency}))

    def sized(self, size: float) -> Named:
        """The effect at `size`, counted from where it is not there."""
        value = self.named.values[self.key]
        found = size if self.swings else value * exp(size) if self.logarithmic else value + size
        return replace(self.named, values={**self.named.values, self.key: found})

    @property
    def parameter(self) -> str:
        """What the prediction calls its size."""
        return f"{self.named.id}[{self.key}]" if self.key else self.named.id


@cache
def candidates() -> tuple[Candidate, ...]:
    """All of them, family by family; of a resonator at the first of `SWINGING`."""
    linear = [family for family in FAMILIES.values() if family.side in (STRUCTURE, FORCES, ACCELERATIONS)]
    return tuple(one for family in linear for one in _of(family))


def _of(family: Family) -> Iterator[Candidate]:
    words = Vocabulary(places=tuple(locations("clumod-1")), parts=PARTS)
    for targets in product(*(words.legal(kind) or () for kind in family.targets)):
        sizes = family.sizes_at(targets)
        if family.name == "layer-damping":
            continue  # one blade has no layer
        if len(sizes) > 1:
            values = {"m": LITTLE, "f": SWINGING[0], "zeta": LOSS}
            yield Candidate(
                named=Named(family=family.name, targets=targets, values={one.key: values[one.key] for one in sizes}),
                key="m",
                unit="kg",
                plausible=SWINGING_MASS,
                one_sided=True,
            )
            continue
        (size,) = sizes
        yield Candidate(
            named=Named(family=family.name, targets=targets, values={size.key: size.null}),
            key=size.key,
            unit=size.unit,
            plausible=size.plausible,
            one_sided=not size.whole and not size.logarithmic and size.low >= size.null,
            logarithmic=size.logarithmic,
            switch=size.whole,
        )
