"""What a laboratory might measure next with a balance, ropes and a watch: the tests among which an advice is chosen.

A swing that was not made yet is one that was, under other conditions, its tolerances as they are stated there; what stays as it
was (the mass, the same ropes) stays one input, so that the tolerance of it does not blur a difference. Other instruments are
those that a workshop has; how good they are stands in the words of the test.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field, replace
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from geometry.arrays import Array
from geometry.inertia import Inertia
from geometry.quantities import exact, tagged
from identification import classical
from validation.diagnosing.classical.observed import Observed
from validation.diagnosing.practical import said
from validation.effects.reduced import heavier
from validation.effects.stages import Matrices
from validation.pendulum_corrections import CompoundSwing, RopeSwing, TorsionSwing
from validation.pendulum_file import Swing
from validation.prediction import swung
from validation.prediction.facts import ArticleFact
from validation.prediction.inputs import Input, spread

if TYPE_CHECKING:
    from uncertainties import UFloat

Pendulum = RopeSwing | CompoundSwing | TorsionSwing

HALF = 0.5

BALANCE, SMALL_BALANCE, RULER, SHARE, DECAY, CRANE = 5e-4, 1e-3, 2.5e-4, 5e-3, 2.5e-4, 5e-4
"""Standard deviations of instruments: of a mass, relative; of the ropes' mass [kg]; of a stretch [m]; of a rope's share of the
weight; of a damping ratio; of a CoG [m]. Half of each figure in words."""

OFF_CENTRE = "off-centre-suspension"


@dataclass(frozen=True, eq=False, kw_only=True)
class Trial:
    """A measurement that was not made.

    Attributes
    ----------
    text : what to do
    facts : what it would say, by the model
    told : by family the standard deviation with which it says the size of an effect directly
    """

    text: str
    facts: tuple[ArticleFact, ...] = ()
    told: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


def menu(of: Observed) -> tuple[Trial, ...]:
    """What could be measured beside what was."""
    swings = [n for n, fact in enumerate(of.facts) if fact.swing is not None]
    if not swings:
        return tuple(_of_body(of))
    base = of.facts[max(swings, key=lambda n: abs(of.left[n]) / of.deviation[n])]
    return (*_of_swing(base), *_of_axes(of, base), *_of_body(of))


def _of_swing(fact: ArticleFact) -> Iterator[Trial]:
    """The same pendulum under other conditions, and its parts by themselves."""
    swing = _swing(fact)
    if _acts(swung.AMPLITUDE, swing):
        shares = {**fact.shares, swung.AMPLITUDE: HALF * fact.shares.get(swung.AMPLITUDE, 1.0)}
        yield Trial(text="swing it once more, half as wide", facts=(another(fact, swing.pendulum, shares=shares),))
    if _acts(swung.DAMPING, swing):
        text = "record the decay of the swing, and from it the damping (to 0.05 %)"
        yield Trial(text=text, told={swung.DAMPING: DECAY})
    if isinstance(swing.pendulum, RopeSwing):
        yield from _of_ropes(fact, swing, swing.pendulum)


def _of_ropes(fact: ArticleFact, swing: Swing, ropes: RopeSwing) -> Iterator[Trial]:
    shorter = replace(ropes, length=_scaled(ropes.length, HALF, "rope length"))
    shares = {**fact.shares, **{name: HALF * fact.shares.get(name, 1.0) for name in (swung.ROPE_MASS, swung.STRETCH)}}
    length = said(shorter.length.nominal_value, "m", 3)
    yield Trial(text=f"hang it on ropes half as long, {length}", facts=(another(fact, shorter, shares=shares),))
    s1, s2 = (_scaled(one, HALF, name) for one, name in ((ropes.s1, "s1"), (ropes.s2, "s2")))
    yield Trial(
        text="hang the ropes half as far from the centre of gravity", facts=(another(fact, replace(ropes, s1=s1, s2=s2)),)
    )
    yield _loaded(fact, ropes)
    if _acts(swung.ROPE_MASS, swing):
        yield Trial(text="weigh the ropes (to 2 g)", told={swung.ROPE_MASS: SMALL_BALANCE})
    load = ropes.mass.nominal_value * ropes.gravity.nominal_value / max(swing.ropes, 1)
    text = "measure the ropes with and without the load (to 0.5 mm)"
    yield Trial(text=text, told={swung.STRETCH: RULER / load})
    radius = float(np.sqrt(abs(ropes.s1.nominal_value * ropes.s2.nominal_value)))
    yield Trial(text="measure what each rope carries (to 1 % of the weight)", told={OFF_CENTRE: SHARE * radius})


def _loaded(fact: ArticleFact, ropes: RopeSwing) -> Trial:
    """With half its mass more, in two known weights on either side at the ropes."""
    mass, square = HALF * ropes.mass.nominal_value, abs(ropes.s1.nominal_value * ropes.s2.nominal_value)
    radius = float(np.sqrt(square))
    more = replace(fact, of=replace(fact.of, drawn=_with_weights(fact, mass, radius)))
    text = f"add two known masses of {said(mass / 2, 'kg', 2)} on either side, {said(radius, 'm', 2)} from the axis"
    return Trial(text=text, facts=(another(more, replace(ropes, mass=ropes.mass + exact(mass))),))


def _with_weights(fact: ArticleFact, mass: float, radius: float) -> Matrices:
    """The article of `fact` with half of `mass` [kg] on either side of its CoG, `radius` [m] from the axis of the swing."""
    axis = np.asarray(_swing(fact).axis)
    aside = np.cross(axis, np.eye(3)[int(np.argmin(np.abs(axis)))])
    aside *= radius / np.linalg.norm(aside)
    tensor = mass * (aside @ aside * np.eye(3) - np.outer(aside, aside))
    weights = Inertia.from_cog(mass=mass, cog=_ten(fact)[1:4], tensor=tensor).about(np.zeros(3))
    drawn = fact.of.drawn
    added = np.zeros_like(drawn.mass)
    added[:6, :6] = weights.mass_matrix
    return heavier(drawn, added)


def _of_axes(of: Observed, base: ArticleFact) -> Iterator[Trial]:
    """About an axis that nobody swung it about, on the same ropes."""
    swung_about = {tuple(np.round(np.abs(fact.swing.axis), 9)) for fact in of.facts if fact.swing is not None}
    for name, axis in zip("xyz", np.eye(3), strict=True):
        if tuple(axis) not in swung_about:
            weights = np.concatenate([np.zeros(4), axis, np.zeros(3)])
            fact = another(replace(base, weights=weights), _swing(base).pendulum)
            yield Trial(text=f"swing it about {name} too", facts=(fact,))


def _of_body(of: Observed) -> Iterator[Trial]:
    """A balance, and a crane beside it."""
    known = [fact.weights for fact in of.facts]
    if not of.facts:
        return
    fact = of.facts[0]
    if not any(weights[0] for weights in known):
        yield Trial(text="weigh it (to 0.1 %)", facts=(_fact(fact, 0, BALANCE * _ten(fact)[0]),))
    for axis in range(3):
        if not any(weights[1 + axis] for weights in known):
            text = f"find its centre of gravity along {'xyz'[axis]} by crane and balance (to 1 mm)"
            yield Trial(text=text, facts=(_fact(fact, 1 + axis, CRANE),))


def another(fact: ArticleFact, pendulum: Pendulum, *, shares: Mapping[str, float] | None = None) -> ArticleFact:
    """`fact` had it been measured on another `pendulum`, at the period that the model then says."""
    swing = replace(_swing(fact), pendulum=pendulum)
    period = _period(swing, float(fact.weights @ _ten(fact)))
    was = swing.pendulum.period
    read = tagged(period, period * was.std_dev / was.nominal_value, "period")
    swing = replace(swing, pendulum=replace(swing.pendulum, period=read))
    moment = swing.moment
    own = spread(moment)
    deviation = float(np.sqrt(sum(part**2 for part in own.values())))
    return replace(
        fact,
        name="what was not measured",
        swing=swing,
        value=float(moment.nominal_value),
        deviation=deviation,
        spread=own,
        shares=fact.shares if shares is None else shares,
    )


def period_per_inertia(fact: ArticleFact) -> float:
    """Relative change of the period of a swing per kg m²."""
    swing = _swing(fact)
    T = float(swing.pendulum.period.nominal_value)
    step = 1e-4
    return 2 * step / (swing.moment_at(T * (1 + step)) - swing.moment_at(T * (1 - step)))


def _period(swing: Swing, moment: float) -> float:
    """[s] with which `swing` says this `moment`: its square is linear in the period's, but for the correction of an amplitude."""
    T = float(swing.pendulum.period.nominal_value)
    for _ in range(8):
        slope = (swing.moment_at(1.001 * T) - swing.moment_at(T)) / (1.001**2 - 1)
        T *= float(np.sqrt(max(1 + (moment - swing.moment_at(T)) / slope, 0.1)))
    return T


def _fact(fact: ArticleFact, k: int, deviation: float) -> ArticleFact:
    """Quantity `k` of its article measured to `deviation` by an instrument of its own."""
    weights = np.eye(10)[k]
    one = Input(name="instrument", value=0.0, deviation=deviation, reading=object())
    return replace(
        fact,
        name="what was not measured",
        weights=weights,
        value=float(weights @ _ten(fact)),
        deviation=deviation,
        spread={one: deviation},
        swing=None,
        effects=(),
    )


def _ten(fact: ArticleFact) -> Array:
    """(10,) quantities of its article by the model with its own effects."""
    return classical.quantities(fact.of.ten({one.name: one.start for one in fact.of.parameters}))


def _acts(family: str, swing: Swing) -> bool:
    from validation.diagnosing.classical.candidates import plausible

    return swung.acts(plausible(family), swing)


def _scaled(value: UFloat, factor: float, name: str) -> UFloat:
    """Another length, measured as well as this one."""
    return tagged(factor * value.nominal_value, value.std_dev, name)


def _swing(fact: ArticleFact) -> Swing:
    if fact.swing is None:
        raise ValueError("`fact` must be of a swing")
    return fact.swing
