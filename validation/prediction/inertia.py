"""The inertia of an article on its own, with the effects that a balance, a crane or a pendulum would notice.

Those are the effects on reduced matrices that weigh: the block of the base is then still the mass matrix of a body. What swings
on a spring of its own, or hangs beside the article on the shaker, is not there when the article is weighed.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.inertia import Inertia
from validation.effects.reach import There, acts
from validation.effects.stages import Matrices
from validation.engine.parameter import Parameter
from validation.engine.prediction import Offsets
from validation.models.model import Added
from validation.prediction import applied
from validation.prediction.tangent import full

WEIGHED = ("point-mass", "rigid-inertia")
"""Families that a balance notices."""


@dataclass(frozen=True, eq=False, kw_only=True)
class OfArticle:
    """The ten parameters of an article about its own origin.

    Attributes
    ----------
    article : its name
    drawn : as a rigid body, with its places
    effects : that weigh, in their order
    """

    article: str
    drawn: Matrices
    effects: tuple[Added, ...] = ()

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """What may move it."""
        return applied.parameters(self.effects)

    def with_effects(self, effects: Sequence[Added]) -> OfArticle:
        """The same article with those of `effects` that weigh here."""
        there = There(article=self.article, places=tuple(self.drawn.places))
        weighed = tuple(one for one in effects if one.named.family in WEIGHED and acts(one.named, there))
        return OfArticle(article=self.article, drawn=self.drawn, effects=weighed)

    def ten(self, offsets: Offsets) -> Array:
        """(10,) at `offsets`."""
        return _ten(applied.structure(self.drawn, {}, applied.at(self.effects, offsets), derivatives=False)[0].mass)

    def at(self, offsets: Offsets) -> tuple[Array, Mapping[str, Array]]:
        """(10,) at `offsets`, and by parameter its derivative (10,)."""
        matrices, tangents = applied.structure(self.drawn, {}, applied.at(self.effects, offsets))
        changes = {name: _ten(full(tangent, "mass", len(matrices.mass))) for name, tangent in tangents.items()}
        return _ten(matrices.mass), changes


def _ten(mass: Array) -> Array:
    return np.asarray(Inertia.from_mass_matrix(mass[:6, :6]).parameters)
