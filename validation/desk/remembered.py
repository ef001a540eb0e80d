"""What the load cells carry, remembered: an effect on a channel need not have the structure solved again."""

from __future__ import annotations

from collections import OrderedDict
from collections.abc import Hashable, Sequence
from dataclasses import replace
from threading import Lock
from typing import cast

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from validation.effects.catalogue import FAMILIES
from validation.effects.family import BODY_STAGE, STRUCTURE_STAGE
from validation.engine.prediction import Offsets
from validation.models.model import Added
from validation.prediction import fmd
from validation.prediction.amplitude import Drive
from validation.prediction.carried import Carried, Tangents
from validation.prediction.series import SeriesPrediction

MOST = 24
"""Dynamic masses that are kept, of some 0.3 MB each."""


class Remembering:
    """A `Carried` that answers the same question once; the answer is the very same. Several threads may ask."""

    def __init__(self, of: Carried) -> None:
        self.standing, self.moving, self.exact, self.nuisances = of.standing, of.moving, of.exact, of.nuisances
        self._of = of
        own = () if of.nuisances is None else of.nuisances.parameters
        self._names = (*(one.name for one in own), *fmd.names())
        self._known: OrderedDict[Hashable, ComplexArray] = OrderedDict()
        self._changing = Lock()

    def at(
        self, offsets: Offsets, effects: Sequence[Added], frequency: Array, drive: Drive, *, derivatives: bool
    ) -> tuple[ComplexArray, Tangents]:
        """As `Carried.at`; derivatives are not remembered."""
        if derivatives:
            return self._of.at(offsets, effects, frequency, drive, derivatives=True)
        key = self._key(offsets, effects, frequency, drive)
        with self._changing:
            found = self._known.pop(key, None)
        if found is None:
            found = self._of.at(offsets, effects, frequency, drive, derivatives=False)[0]
        with self._changing:
            self._known[key] = found
            while len(self._known) > MOST:
                self._known.popitem(last=False)
        return found, {}

    def moved(self, offsets: Offsets, effects: Sequence[Added], frequency: Array) -> dict[str, tuple[ComplexArray, ComplexArray]]:
        """As `Carried.moved`."""
        return self._of.moved(offsets, effects, frequency)

    def _key(self, offsets: Offsets, effects: Sequence[Added], frequency: Array, drive: Drive) -> Hashable:
        """All that the answer depends on."""
        acting = [one.named for one in effects if FAMILIES[one.named.family].stage in (STRUCTURE_STAGE, BODY_STAGE)]
        driven: Hashable = None
        if any(FAMILIES[one.family].stage == BODY_STAGE for one in acting):
            driven = (drive.amplitude.tobytes(), drive.sweep_rate, drive.block)
        sizes = tuple((one.id, tuple(one.values.items())) for one in acting)
        return (sizes, driven, tuple(offsets.get(name, 0.0) for name in self._names), frequency.tobytes())


def remembering(of: SeriesPrediction) -> SeriesPrediction:
    """`of` with what its cells carry remembered, for it and for whatever is made of it."""
    return replace(of, tested=replace(of.tested, carried=cast(Carried, Remembering(of.tested.carried))))
