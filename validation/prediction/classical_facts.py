"""Weighing, CoG and pendulum files as facts: single numbers that a model must meet beside its spectra.

A fact is a mass, a coordinate of the centre of gravity from the article's origin, or a moment of inertia about an axis through
it. A pendulum says the last by its period. Effects of the pendulum change the period that is predicted, by a factor: the
inertia that the measured period stands for is then that of the period without them. Tolerances are half-widths of 95 % intervals,
as everywhere in massline; results of one file count as independent.
"""

from collections.abc import Callable, Hashable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from geometry.articles import NAMES, changes_of, locations
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Inertia, judge
from identification import request
from identification.campaign import Campaign
from identification.quality import NORMAL_95
from validation.classical import files, pendulum, weigh
from validation.classical.files import KEYS, QUANTITIES, Fields, Reduction, read
from validation.classical.pendulum import CompoundSwing, RecordedSwing, RopeSwing, TorsionSwing
from validation.effects.catalogue import FAMILIES, Named, There
from validation.effects.catalogue import acts as reach_acts
from validation.effects.effect import PERIOD_STAGE
from validation.effects.stages import Matrices
from validation.effects.stages import PendulumSwing as Stage
from validation.estimation.problem import Offsets, Parameter
from validation.model.model import Added, Model
from validation.model.setups import FMD, above_fmd
from validation.prediction import effects as prediction_effects
from validation.prediction import mounting
from validation.prediction.mounting import drawn_inertia, mounted_article
from validation.prediction.tangents import full

if TYPE_CHECKING:
    from uncertainties import UFloat


# The inertia of an article on its own, with the effects that a balance, a crane or a pendulum would notice.
#
# Those are the effects on reduced matrices that weigh: the block of the base is then still the mass matrix of a body. What
# swings on a spring of its own, or hangs beside the article on the shaker, is not there when the article is weighed.

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
        return prediction_effects.parameters(self.effects)

    def with_effects(self, effects: Sequence[Added]) -> "OfArticle":
        """The same article with those of `effects` that weigh here."""
        there = There(article=self.article, places=tuple(self.drawn.places))
        weighed = tuple(one for one in effects if one.named.family in WEIGHED and reach_acts(one.named, there))
        return OfArticle(article=self.article, drawn=self.drawn, effects=weighed)

    def ten(self, offsets: Offsets) -> Array:
        """(10,) at `offsets`."""
        return _ten(
            prediction_effects.structure(self.drawn, {}, prediction_effects.at(self.effects, offsets), derivatives=False)[0].mass
        )

    def at(self, offsets: Offsets) -> tuple[Array, Mapping[str, Array]]:
        """(10,) at `offsets`, and by parameter its derivative (10,)."""
        matrices, tangents = prediction_effects.structure(self.drawn, {}, prediction_effects.at(self.effects, offsets))
        changes = {name: _ten(full(tangent, "mass", len(matrices.mass))) for name, tangent in tangents.items()}
        return _ten(matrices.mass), changes


def _ten(mass: Array) -> Array:
    return np.asarray(Inertia.from_mass_matrix(mass[:6, :6]).parameters)


# What the tolerances of several facts have in common: one rope measured once is wrong by the same in every swing on it.
#
# A tolerance that swings share does not blur what tells them apart. Inputs of one file are one where they were read once (the
# mass, gravity, the torsion rod). A length that is written with the same figure and the same tolerance in several swings, or a
# mass in several files, counts as one measurement too; times and readings of a balance are each a new one.

MEASURED_ONCE = (
    *("mass", "gravity", "rope length", "s1", "s2", "radius", "arm", "position of rope 1", "position of rope 2"),
    *(f"position of the CoG ({axis})" for axis in "xyz"),
    *("known inertia", "rod mass", "rod length", "rod diameter", "period with the known rod"),
)
"""Names of inputs that are one measurement wherever they are written alike."""


@dataclass(frozen=True, kw_only=True)
class Input:
    """One input of a measurement.

    Attributes
    ----------
    name : as in budgets
    value, deviation : SI, and its standard deviation
    reading : what tells it from another one that is written alike; None for what is one measurement then
    """

    name: str
    value: float
    deviation: float
    reading: Hashable = None


Spread = Mapping[Input, float]
"""By input what one standard deviation of it makes of a result, signed, in the unit of the result."""


def spread(value: "UFloat") -> Spread:
    """By input what it makes of `value`, of which tolerances are half-widths of 95 % intervals."""
    found: dict[Input, float] = {}
    for variable, slope in value.derivatives.items():
        name, input_value = str(getattr(variable, "tag", "")), float(variable.nominal_value)
        sd = float(variable.std_dev) / NORMAL_95
        one = Input(name=name, value=input_value, deviation=sd, reading=None if name in MEASURED_ONCE else variable)
        found[one] = found.get(one, 0.0) + float(slope) * one.deviation
    return {one: part for one, part in found.items() if part}


def covariance(spreads: Sequence[Spread]) -> Array:
    """(n, n) of results with these `spreads`."""
    every = list(dict.fromkeys(one for each in spreads for one in each))
    parts = np.array([[each.get(one, 0.0) for one in every] for each in spreads]).reshape(len(spreads), len(every))
    return np.asarray(parts @ parts.T)


# A measured swing as an effect on its period sees it: what acts on it, how much of it, and what comes of the period.
#
# An effect has one size in all swings of an article: that of the widest, of the longest ropes, of the strongest decay. A swing
# has a share of it where the file says so: amplitudes as they are stated, ropes of one kind by their length (twice as long,
# twice the mass and twice the stretch for a newton). What the file has corrected for is no effect any more; an input that is
# wrong is another matter.

AMPLITUDE, DAMPING, ROPE_MASS, STRETCH = "pendulum-amplitude", "pendulum-damping", "rope-mass", "rope-elasticity"

TERMS = {AMPLITUDE: "amplitude", DAMPING: "damping", ROPE_MASS: "rope_mass"}
"""By family what a correction of it is called in `validation.classical.pendulum.Terms`."""

PASSES = 3
"""Each leaves of the error of the body's inertia the share that an effect is of it, a per cent or so."""


def acts(named: Named, swing: RecordedSwing) -> bool:
    """Whether an effect changes the period of `swing`.

    One that asks for ropes does nothing to a body on a pivot, a wide swing nothing to a torsion rod, which is linear in the
    twist, and what was corrected for nothing at all.
    """
    family = FAMILIES[named.family]
    if family.stage != PERIOD_STAGE:
        return False
    if named.family in TERMS and getattr(swing.terms, TERMS[named.family]) is not None:  # its size is stated and taken off
        return False
    if named.family == AMPLITUDE and isinstance(swing.pendulum, TorsionSwing):
        return False
    try:
        changed(named, stage(swing))
    except BadInput:
        return False
    return True


def changed(named: Named, of: Stage, shares: Mapping[str, float] | None = None) -> Stage:
    """A swing with the effect `named`, of which it has its share."""
    change = FAMILIES[named.family].change
    share = (shares or {}).get(named.family, 1.0)
    values = {key: value if key else share * value for key, value in named.values.items()}
    found: Stage = of if change is None else change(of, named.targets, values)
    return found


def moment(swing: RecordedSwing, effects: Sequence[Named], shares: Mapping[str, float]) -> float:
    """Moment of inertia [kg m²] for which the measured period stands, once `effects` on it are taken off.

    Ropes and air swing along with the body as it is, and not as it would be with them: each pass knows it better.
    """
    found = float(swing.moment.nominal_value)
    for _ in range(PASSES):
        before = after = replace(stage(swing), inertia=found)
        for one in effects:
            after = changed(one, after, shares)
        found = swing.moment_at(before.period**2 / after.period)
    return found


def suspension_shares(swings: Sequence[RecordedSwing]) -> tuple[Mapping[str, float], ...]:
    """By swing and family the share that it has of an effect's size, the largest 1; 1 where the file does not say."""
    measures: Mapping[str, Callable[[RecordedSwing], float]] = {
        AMPLITUDE: lambda swing: _stated(swing, "amplitude"),
        DAMPING: lambda swing: _stated(swing, "damping"),
        ROPE_MASS: lambda swing: swing.ropes * _length(swing),
        STRETCH: _length,
    }
    found: list[dict[str, float]] = [{} for _ in swings]
    for family, measure in measures.items():
        sizes = np.array([measure(swing) for swing in swings])
        largest = sizes.max(initial=0.0)
        for own, size in zip(found, sizes, strict=True):
            own[family] = float(size / largest) if size > 0 else 1.0
    return tuple(found)


@lru_cache(maxsize=64)
def stage(swing: RecordedSwing) -> Stage:
    """The pendulum as an effect sees it."""
    pendulum, terms = swing.pendulum, swing.terms
    mass, gravity, length, radii = 0.0, Stage.gravity, 0.0, np.zeros(0)
    if isinstance(pendulum, RopeSwing | CompoundSwing):
        mass, gravity = (float(one.nominal_value) for one in (pendulum.mass, pendulum.gravity))
    if isinstance(pendulum, RopeSwing):
        s1, s2 = (abs(float(one.nominal_value)) for one in (pendulum.s1, pendulum.s2))
        length, radii = float(pendulum.length.nominal_value), np.array([s1, s2] if swing.ropes == 2 else [s1] * swing.ropes)
    return Stage(
        period=float(pendulum.period.nominal_value),
        amplitude=0.0 if terms.amplitude is None else float(terms.amplitude.nominal_value),
        damping_ratio=0.0 if terms.damping is None else float(terms.damping.nominal_value),
        mass=mass,
        inertia=float(swing.moment.nominal_value),
        ropes=swing.ropes,
        length=length,
        radii=radii,
        gravity=gravity,
    )


def _stated(swing: RecordedSwing, key: str) -> float:
    size = getattr(swing.stated, key)
    return 0.0 if size is None else float(size.nominal_value)


def _length(swing: RecordedSwing) -> float:
    pendulum = swing.pendulum
    return float(pendulum.length.nominal_value) if isinstance(pendulum, RopeSwing) else 0.0


REDUCED: Mapping[str, Callable[[Fields], Reduction]] = {
    "weighing": weigh.reduce,
    "crane-cog": weigh.reduce_cog,
    "results": files.reduce,
}
"""What reduces a file of each kind, but for pendulums, of which every swing is a fact."""

STEP = 1e-4
"""Step of a derivative by the size of an effect on the period, as a share of a plausible one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ArticleFact:
    """One number about one article: a `validation.estimation.problem.Fact`.

    Attributes
    ----------
    name : file and quantity
    of : the article
    weights : (10,) of `identification.request.quantities`: what the number is a sum of
    value, deviation : measured, SI, and its standard deviation
    spread : by input what one standard deviation of it makes of the value
    swing : where it was a pendulum
    shares : by family of effects on a period what this swing has of their size, see `validation.prediction.classical_facts`
    effects : on its period
    """

    name: str
    of: OfArticle
    weights: Array
    value: float
    deviation: float
    spread: Spread = field(default_factory=lambda: MappingProxyType({}))
    swing: RecordedSwing | None = None
    shares: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    effects: tuple[Added, ...] = field(default=())

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move it."""
        return (*self.of.parameters, *prediction_effects.parameters(self.effects))

    def with_effects(self, effects: Sequence[Added]) -> "ArticleFact":
        """The same fact by a model with these `effects` instead of its own."""
        acting = () if self.swing is None else tuple(one for one in effects if acts(one.named, self.swing))
        return replace(self, of=self.of.with_effects(effects), effects=acting)

    def residual(self, offsets: Offsets) -> tuple[float, Mapping[str, float]]:
        """(predicted - measured) / standard deviation, and its derivatives by offset of the parameters that act.

        Raises
        ------
        BadInput : an effect of a size that the pendulum cannot have.
        """
        ten, changes = self.of.at(offsets)
        slope = self.weights @ request.jacobian(ten)
        left = self._predicted(ten) - self._measured(offsets)
        found = {name: float(slope @ change) / self.deviation for name, change in changes.items()}
        for one in prediction_effects.parameters(self.effects):
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
        return float(self.weights @ request.quantities(ten))

    def _measured(self, offsets: Offsets) -> float:
        """What the measurement stands for once the effects on the period are taken off."""
        if self.swing is None or not self.effects:
            return self.value
        return moment(self.swing, [one.named for one in prediction_effects.at(self.effects, offsets)], self.shares)

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
    found: list[ArticleFact] = []
    for name in files:
        file = read(name, (*REDUCED, "pendulum"))
        if file.text("kind") == "pendulum":
            of = article_of(model, name, file.inner("article").text("name"))
            for number, swing in enumerate(pendulum.swings(file), start=1):
                x, y, z = swing.axis
                weights = np.array([0, 0, 0, 0, x * x, y * y, z * z, 2 * x * y, 2 * x * z, 2 * y * z], dtype=np.float64)
                found.append(replace(_fact(name, of, f"period of swing {number}", weights, swing.moment), swing=swing))
        else:
            reduction = REDUCED[file.text("kind")](file)
            of = article_of(model, name, reduction.article)
            results = [(key, value) for key, value in reduction.results.items() if key in KEYS]
            found += [_fact(name, of, QUANTITIES[key][0], weights_of(key), value) for key, value in results]
    # Every swing has its share of the effects on the swings of its article
    shares: dict[str, Iterator[Mapping[str, float]]] = {}
    for article in {fact.of.article for fact in found}:
        swings = [fact.swing for fact in found if fact.swing is not None and fact.of.article == article]
        shares[article] = iter(suspension_shares(swings))
    shared = (fact if fact.swing is None else replace(fact, shares=next(shares[fact.of.article])) for fact in found)
    return tuple(fact.with_effects(model.effects) for fact in shared)


def _fact(source: str, of: OfArticle, words: str, weights: Array, value: "UFloat") -> ArticleFact:
    size, sd = float(value.nominal_value), float(value.std_dev) / NORMAL_95
    if not 0 < sd < np.inf:
        problem = "is stated without a tolerance, so that nobody knows what it is worth"
        raise BadInput(source, words, problem, "State the tolerances of the readings behind it")
    return ArticleFact(name=f"{source}: {words}", of=of, weights=weights, value=size, deviation=sd, spread=spread(value))


def weights_of(key: str) -> Array:
    """(10,) of the number that is one of `KEYS` by itself."""
    return np.array([float(one == key) for one in KEYS])


def article_of(model: Model, source: str, stated: str) -> OfArticle:
    """The article that a file is about; what the model was written for where it names none."""
    name = stated or above_fmd(model.article)
    if not name or name.split("+")[0] == FMD:
        problem = f"it is about {name or FMD}, and a model knows the FMD's inertia only by its tare"
        raise BadInput(source, "article.name", problem, "Measure what stands on it alone")
    inertia = drawn_inertia(model, name)
    built_in = set(name.split("+")) <= set(NAMES)
    places = locations(name, changes_of(name, model.changes)) if built_in else {}
    return OfArticle(article=name, drawn=mounting.of_inertia(inertia, places))


# Is what stands on the cover plate still a body once the effects of a model act? Asked before anything is fitted.
#
# Masses that are added or taken away change the ten parameters of the whole article, which no body may have if its mass is not
# positive or a principal moment exceeds the sum of the others. That is said of the sizes as the model states them: a fit may not
# begin there, and an effect that is fixed stays there. What is taken away at one place alone is not held against what moves
# there: a reduced model lumps mass at no place, and a forgotten clamp is as well taken off a beam as put on it.

ROUNDING = 1e-9
"""Of the largest entry of a tensor: what a reduced model of a rod or a point mass loses."""

BASE = 6


def require_bodies(model: Model, campaigns: Sequence[Campaign]) -> None:
    """Refuse masses and inertias by which what stands on the FMD in one of `campaigns` is no body.

    Raises
    ------
    BadInput : such effects, with the inertia that results; whatever `validation.prediction.mounting.mounted_article` refuses.
    """
    if not any(one.named.family in WEIGHED for one in model.effects):
        return
    for article, campaign in {one.article: one for one in campaigns}.items():
        of = mounted_article(model, campaign)
        # At their sizes as they stand, which nothing moves
        weighing = (one for one in model.effects if one.named.family in WEIGHED and reach_acts(one.named, of.there))
        effects = tuple(replace(one, fixed=True) for one in weighing)
        if of.matrices is None or not effects:
            continue
        problem = _problem(of.matrices, effects)
        if problem and not _problem(of.matrices, ()):  # what was no body before is not the fault of effects
            raise BadInput(
                model.source,
                f"effect {', '.join(one.named.id for one in effects)}",
                f"with {', '.join(str(one.named) for one in effects)} no body is left of {article}: {problem}",
                "Check sign and unit of the size; a mass is added to the drawing, and a negative one taken away from it",
            )


def _problem(drawn: Matrices, effects: Sequence[Added]) -> str:
    """Why there is no such body; empty where there is one."""
    mass = prediction_effects.structure(drawn, {}, effects, derivatives=False)[0].mass
    verdict = judge(Inertia.from_mass_matrix(mass[:BASE, :BASE]), ROUNDING)
    return "" if verdict.physical else verdict.text
