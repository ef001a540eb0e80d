"""What response functions and modal tables of a user's own structure should be, by one model: a prediction of each data set."""

from collections.abc import Sequence
from typing import Protocol, Self

import numpy as np

from geometry.errors import BadInput
from geometry.toml_file import nearest
from identification.test_file import Test
from validation.effects.catalogue import There
from validation.estimation.problem import Prediction
from validation.model.model import Added, Model
from validation.prediction import effects, modal_table, response_functions
from validation.prediction.structure import own_article

BEYOND = 1.5
"""[1] of the highest frequency of the data: modes up to there bend with what parts become. By the definition of a band: a mode
as far above it answers nearly statically."""


class StructurePrediction(Prediction, Protocol):
    """A prediction of one data set by a model of a structure, whose effects may be exchanged."""

    @property
    def structure(self) -> effects.Nuisances | None:
        """What was tested, before any effect."""

    @property
    def effects(self) -> tuple[Added, ...]:
        """In the order in which they act."""

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was assumed, sentences."""

    @property
    def there(self) -> There:
        """What effects can act on."""

    def with_effects(self, effects: Sequence[Added]) -> Self:
        """The same by a model with these `effects` instead of its own; those that reach nothing here do nothing here."""


def predictions(model: Model, tests: Sequence[Test]) -> tuple[StructurePrediction, ...]:
    """Predictions of `tests` by `model`, whose own structures they are about; a test may make several data sets.

    Raises
    ------
    BadInput : a structure that `model` does not name or that cannot be used, a place that it has not, two tests of one name.
    CheckFailed : as `fem.modes.fixed_base`.
    """
    found: list[StructurePrediction] = []
    for article in dict.fromkeys(one.article for one in tests):
        own = [one for one in tests if one.article == article]
        if article not in model.own:
            near = nearest(article, model.own)
            raise BadInput(
                source=own[0].source,
                field="article",
                problem=f"is {article}, and {model.source} has no model of it",
                remedy=f"{near}Name its file in [structure.own] of {model.source}, or correct the article",
            )
        highest = BEYOND * max(float(np.max(one.frequency)) for one in own)
        stands = own_article(model, article, highest)
        known = effects.nuisances(article, stands.matrices, stands.frequency, stands.losses, model.structure, highest=highest)
        for one in own:
            of = response_functions if hasattr(one, "responses") else modal_table
            found += of.of(known, one)
    names = [one.measured.name for one in found]
    for name in names:
        if names.count(name) > 1:
            raise BadInput(source=name, field="test", problem="two tests have this name", remedy="Give each a `title` of its own")
    return tuple(found)
