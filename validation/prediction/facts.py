"""Weighing, CoG and pendulum files as facts: single numbers that a model must meet beside its spectra.

A fact is a mass, a coordinate of the centre of gravity from the article's origin, or a moment of inertia about an axis through
it. A pendulum says the last by its period. Effects of the pendulum change the period that is predicted, by a factor: the
inertia that the measured period stands for is then that of the period without them. Tolerances are half-widths of 95 % intervals,
as everywhere in massline; results of one file count as independent.
"""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from geometry.arrays import Array
from geometry.articles import NAMES, changes_of
from geometry.articles.locations import locations
from geometry.errors import BadInput
from identification import classical
from identification.quality import NORMAL_95
from validation import crane_cog, pendulum_file, results_file, weighing
from validation.engine.parameter import Parameter
from validation.engine.prediction import Offsets
from validation.identifying.known import FMD, above_fmd
from validation.measurement_file import Fields, read
from validation.models.model import Added, Model
from validation.pendulum_file import Swing
from validation.prediction import applied, matrices, swung
from validation.prediction.inertia import OfArticle
from validation.prediction.inputs import Spread, spread
from validation.prediction.set_up import drawn_inertia
from validation.reduction import QUANTITIES, Reduction

if TYPE_CHECKING:
    from uncertainties import UFloat

REDUCED: Mapping[str, Callable[[Fields], Reduction]] = {
    "weighing": weighing.reduce,
    "crane-cog": crane_cog.reduce,
    "results": results_file.reduce,
}
"""What reduces a file of each kind, but for pendulums, of which every swing is a fact."""

KEYS = ("mass", "cog_x", "cog_y", "cog_z", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
"""Results in the order of `identification.classical.quantities`."""

STEP = 1e-4
"""Step of a derivative by the size of an effect on the period, as a share of a plausible one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ArticleFact:
    """One number about one article: a `validation.engine.prediction.Fact`.

    Attributes
    ----------
    name : file and quantity
    of : the article
    weights : (10,) of `identification.classical.quantities`: what the number is a sum of
    value, deviation : measured, SI, and its standard deviation
    spread : by input what one standard deviation of it makes of the value
    swing : where it was a pendulum
    shares : by family of effects on a period what this swing has of their size, see `validation.prediction.swung`
    effects : on its period
    """

    name: str
    of: OfArticle
    weights: Array
    value: float
    deviation: float
    spread: Spread = field(default_factory=lambda: MappingProxyType({}))
    swing: Swing | None = None
    shares: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    effects: tuple[Added, ...] = field(default=())

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move it."""
        return (*self.of.parameters, *applied.parameters(self.effects))

    def with_effects(self, effects: Sequence[Added]) -> ArticleFact:
        """The same fact by a model with these `effects` instead of its own."""
        acting = () if self.swing is None else tuple(one for one in effects if swung.acts(one.named, self.swing))
        return replace(self, of=self.of.with_effects(effects), effects=acting)

    def residual(self, offsets: Offsets) -> tuple[float, Mapping[str, float]]:
        """(predicted - measured) / standard deviation, and its derivatives by offset of the parameters that act.

        Raises
        ------
        BadInput : an effect of a size that the pendulum cannot have.
        """
        ten, changes = self.of.at(offsets)
        slope = self.weights @ classical.jacobian(ten)
        left = self._predicted(ten) - self._measured(offsets)
        found = {name: float(slope @ change) / self.deviation for name, change in changes.items()}
        for one in applied.parameters(self.effects):
            found[one.name] = -self._slope(one, offsets) / self.deviation
        return left / self.deviation, found

    def left(self, offsets: Offsets) -> float:
        """Predicted - measured, SI.

        Raises
        ------
        BadInput : an effect of a size that the pendulum cannot have.
        """
        return self._predicted(self.of.ten(offsets)) - self._measured(offsets)

    def _predicted(self, ten: Array) -> float:
        return float(self.weights @ classical.quantities(ten))

    def _measured(self, offsets: Offsets) -> float:
        """What the measurement stands for once the effects on the period are taken off."""
        if self.swing is None or not self.effects:
            return self.value
        return swung.moment(self.swing, [one.named for one in applied.at(self.effects, offsets)], self.shares)

    def _slope(self, one: Parameter, offsets: Offsets) -> float:
        at, step = offsets.get(one.name, 0.0), STEP * one.tolerance
        below, above = (self._measured({**offsets, one.name: at + side * step}) for side in (-1, 1))
        return (above - below) / (2 * step)


def facts(model: Model, files: Sequence[str]) -> tuple[ArticleFact, ...]:
    """What the measurement `files` say, each number beside what `model` says.

    Raises
    ------
    BadInput : a file that cannot be used, or that is about something of which the model knows no inertia; a result without
        tolerance.
    """
    found = _shared([fact for name in files for fact in _of_file(model, name)])
    return tuple(fact.with_effects(model.effects) for fact in found)


def _shared(found: Sequence[ArticleFact]) -> list[ArticleFact]:
    """`found`, every swing with its share of the effects on the swings of its article."""
    shares: dict[str, Iterator[Mapping[str, float]]] = {}
    for article in {fact.of.article for fact in found}:
        swings = [fact.swing for fact in found if fact.swing is not None and fact.of.article == article]
        shares[article] = iter(swung.shares(swings))
    return [fact if fact.swing is None else replace(fact, shares=next(shares[fact.of.article])) for fact in found]


def _of_file(model: Model, name: str) -> list[ArticleFact]:
    file = read(name, (*REDUCED, "pendulum"))
    if file.text("kind") == "pendulum":
        of = partial(_fact, name, article_of(model, name, file.inner("article").text("name")))
        return [_of_swing(of, number, one) for number, one in enumerate(pendulum_file.swings(file), start=1)]
    reduction = REDUCED[file.text("kind")](file)
    of = partial(_fact, name, article_of(model, name, reduction.article))
    return [of(QUANTITIES[key][0], weights_of(key), value) for key, value in reduction.results.items() if key in KEYS]


def _of_swing(of: Callable[..., ArticleFact], number: int, swing: Swing) -> ArticleFact:
    x, y, z = swing.axis
    weights = np.array([0, 0, 0, 0, x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z], dtype=np.float64)
    return replace(of(f"period of swing {number}", weights, swing.moment), swing=swing)


def _fact(source: str, of: OfArticle, words: str, weights: Array, value: UFloat) -> ArticleFact:
    size, sd = float(value.nominal_value), float(value.std_dev) / NORMAL_95
    if not 0 < sd < np.inf:
        problem = "is stated without a tolerance, so that nobody knows what it is worth"
        raise BadInput(source=source, field=words, problem=problem, remedy="State the tolerances of the readings behind it")
    return ArticleFact(name=f"{source}: {words}", of=of, weights=weights, value=size, deviation=sd, spread=spread(value))


def weights_of(key: str) -> Array:
    """(10,) of the number that is one of `KEYS` by itself."""
    return np.array([float(one == key) for one in KEYS])


def article_of(model: Model, source: str, stated: str) -> OfArticle:
    """The article that a file is about; what the model was written for where it names none."""
    name = stated or above_fmd(model.article)
    if not name or name.split("+")[0] == FMD:
        problem = f"it is about {name or FMD}, and a model knows the FMD's inertia only by its tare"
        raise BadInput(source=source, field="article.name", problem=problem, remedy="Measure what stands on it alone")
    inertia = drawn_inertia(model, name)
    built_in = set(name.split("+")) <= set(NAMES)
    places = locations(name, changes_of(name, model.changes)) if built_in else {}
    return OfArticle(article=name, drawn=matrices.of_inertia(inertia, places))
