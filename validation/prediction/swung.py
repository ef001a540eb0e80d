"""A measured swing as an effect on its period sees it: what acts on it, how much of it, and what comes of the period.

An effect has one size in all swings of an article: that of the widest, of the longest ropes, of the strongest decay. A swing has
a share of it where the file says so: amplitudes as they are stated, ropes of one kind by their length (twice as long, twice the
mass and twice the stretch for a newton). What the file has corrected for is no effect any more; an input that is wrong is another
matter.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from functools import lru_cache

import numpy as np

from geometry.errors import BadInput
from validation.effects.catalogue import FAMILIES
from validation.effects.family import PERIOD_STAGE
from validation.effects.identifiers import Named
from validation.effects.stages import Swing as Stage
from validation.pendulum_corrections import CompoundSwing, RopeSwing, TorsionSwing
from validation.pendulum_file import Swing

AMPLITUDE, DAMPING, ROPE_MASS, STRETCH = "pendulum-amplitude", "pendulum-damping", "rope-mass", "rope-elasticity"

TERMS = {AMPLITUDE: "amplitude", DAMPING: "damping", ROPE_MASS: "rope_mass"}
"""By family what a correction of it is called in `validation.pendulum_corrections.Terms`."""


PASSES = 3
"""Each leaves of the error of the body's inertia the share that an effect is of it, a per cent or so."""


def acts(named: Named, swing: Swing) -> bool:
    """Whether an effect changes the period of `swing`.

    One that asks for ropes does nothing to a body on a pivot, a wide swing nothing to a torsion rod, which is linear in the
    twist, and what was corrected for nothing at all.
    """
    family = FAMILIES[named.family]
    if family.stage != PERIOD_STAGE or corrected(named.family, swing):
        return False
    if named.family == AMPLITUDE and isinstance(swing.pendulum, TorsionSwing):
        return False
    try:
        changed(named, stage(swing))
    except BadInput:
        return False
    return True


def corrected(family: str, swing: Swing) -> bool:
    """Whether the result of `swing` is free of an effect of `family` because its size is stated and taken off."""
    return family in TERMS and getattr(swing.terms, TERMS[family]) is not None


def changed(named: Named, of: Stage, shares: Mapping[str, float] | None = None) -> Stage:
    """A swing with the effect `named`, of which it has its share."""
    change = FAMILIES[named.family].change
    share = (shares or {}).get(named.family, 1.0)
    values = {key: value if key else share * value for key, value in named.values.items()}
    found: Stage = of if change is None else change(of, named.targets, values)
    return found


def moment(swing: Swing, effects: Sequence[Named], shares: Mapping[str, float]) -> float:
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


def shares(swings: Sequence[Swing]) -> tuple[Mapping[str, float], ...]:
    """By swing and family the share that it has of an effect's size, the largest 1; 1 where the file does not say."""
    measures: Mapping[str, Callable[[Swing], float]] = {
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
def stage(swing: Swing) -> Stage:
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


def _stated(swing: Swing, key: str) -> float:
    size = getattr(swing.stated, key)
    return 0.0 if size is None else float(size.nominal_value)


def _length(swing: Swing) -> float:
    pendulum = swing.pendulum
    return float(pendulum.length.nominal_value) if isinstance(pendulum, RopeSwing) else 0.0
