"""Effects of a pendulum: equations against the rope pendulum's own statics, and that one period tells none of them apart."""

from dataclasses import replace
from itertools import permutations

import numpy as np
import pytest
from uncertainties import ufloat

from fem.exudyn.rope_pendulum import small_period
from fem.exudyn.rope_statics import on_three_ropes, on_two_ropes
from geometry.errors import BadInput
from geometry.inertia import Inertia
from validation.classical.pendulum import CompoundSwing, RopeSwing, Terms, rope_pendulum
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import PENDULUM
from validation.effects.stages import PendulumSwing

MASS, YAW, RADIUS, LENGTH, GRAVITY = 47.23, 2.289, 0.3, 2.0, 9.81
"""The shared page's example."""

FROM_A_PERIOD = [name for name, family in FAMILIES.items() if family.side == PENDULUM]


@pytest.fixture(scope="module")
def body() -> Inertia:
    return Inertia.from_cog(mass=MASS, cog=np.zeros(3), tensor=np.diag([1.9, 2.1, YAW]))


def ideal(radii: tuple[float, ...] = (RADIUS,) * 3, length: float = LENGTH) -> PendulumSwing:
    square = radii[0] * radii[1] if len(radii) == 2 else radii[0] ** 2
    period = 2 * np.pi * np.sqrt(YAW * length / (MASS * GRAVITY * square))
    known = {"mass": MASS, "inertia": YAW, "length": length, "gravity": GRAVITY}
    return PendulumSwing(period=period, ropes=len(radii), radii=np.array(radii), **known)


def shifted(name: str, size: float, swing: PendulumSwing | None = None) -> float:
    """Relative change of the period."""
    swing = ideal() if swing is None else swing
    changed: PendulumSwing = FAMILIES[name].change(swing, (), {"": size})
    return changed.period / swing.period - 1


@pytest.mark.parametrize("radii", [(0.3, 0.3, 0.3), (0.3, 0.3)])
def test_stretching_ropes_hang_lower_and_swing_slower(body, radii):
    EA = 2e5
    hang = on_three_ropes if len(radii) == 3 else on_two_ropes
    feet = radii[:1] if len(radii) == 3 else radii
    periods = [small_period(body, hang(*feet, length=LENGTH, amplitude=0.1, stiffness=k), GRAVITY) for k in (None, EA)]
    assert periods[1] / periods[0] - 1 == pytest.approx(
        shifted("rope-elasticity", LENGTH / EA, ideal(radii)), rel=1e-3
    )  # of second order in the strain


@pytest.mark.parametrize("distance", [0.02, 0.1])
def test_a_body_beside_the_middle_of_three_ropes_swings_slower(body, distance):
    periods = [
        small_period(body, on_three_ropes(RADIUS, length=LENGTH, amplitude=0.1, off_centre=(e, 0.0)), GRAVITY)
        for e in (0.0, distance)
    ]
    assert periods[1] / periods[0] - 1 == pytest.approx(shifted("off-centre-suspension", distance), rel=1e-6)


def test_heavy_ropes_of_many_links_swing_as_the_equation_says(body):
    M, known = 0.3, {"length": LENGTH, "amplitude": 0.1}
    light = small_period(body, on_three_ropes(RADIUS, **known), GRAVITY)
    heavy = small_period(body, on_three_ropes(RADIUS, **known, rope_mass=M, links=20), GRAVITY)
    assert heavy / light - 1 == pytest.approx(shifted("rope-mass", M), rel=0.02)  # 1 % by the links, 0.6 % by M / m


@pytest.mark.parametrize(
    ("name", "size", "percent"),
    [
        ("pendulum-amplitude", 0.1, 0.069),
        ("pendulum-amplitude", 0.2, 0.275),
        ("pendulum-damping", 0.05, 0.125),
        ("rope-mass", 0.3, 0.038),
    ],
)
def test_the_errors_are_those_of_the_page_on_pendulums(name, size, percent):
    assert 100 * shifted(name, size) == pytest.approx(percent, abs=5e-4)


@pytest.mark.parametrize(
    ("name", "term"), [("pendulum-amplitude", "amplitude"), ("pendulum-damping", "damping"), ("rope-mass", "rope_mass")]
)
@pytest.mark.parametrize("radii", [(0.3, 0.3), (0.2, 0.4)])
def test_the_corrections_take_off_what_the_effects_put_on(name, term, radii):
    size = 0.3
    changed = FAMILIES[name].change(ideal(radii), (), {"": size})
    of = {key: ufloat(value, 1e-12) for key, value in {"mass": MASS, "gravity": GRAVITY, "s1": radii[0], "s2": radii[1]}.items()}
    swing = RopeSwing(**of, length=ufloat(LENGTH, 1e-12), period=ufloat(changed.period, 1e-12))
    terms = Terms(**{"amplitude": None, "damping": None, "rope_mass": None, term: ufloat(size, 1e-12)})
    assert swing.inertia(terms).nominal_value == pytest.approx(YAW, rel=1e-9)
    assert abs(swing.inertia(Terms()).nominal_value / YAW - 1) > 1e-4


def test_a_body_on_a_pivot_has_the_amplitude_of_the_plane_pendulum():
    arm = 0.4
    period = 2 * np.pi * np.sqrt((YAW + MASS * arm**2) / (MASS * GRAVITY * arm))
    wide = FAMILIES["pendulum-amplitude"].change(PendulumSwing(period=period, ropes=0), (), {"": 0.5})
    found = CompoundSwing(
        mass=ufloat(MASS, 1e-12), gravity=ufloat(GRAVITY, 1e-12), arm=ufloat(arm, 1e-12), period=ufloat(wide.period, 1e-12)
    )
    assert found.inertia(Terms(amplitude=ufloat(0.5, 1e-12))).nominal_value == pytest.approx(YAW, rel=1e-9)


def test_air_is_measured_with_the_article_and_along_two_ropes_it_is_eq_5_with_its_own_radii():
    changed = FAMILIES["air-inertia"].change(ideal(), (), {"": 0.01})
    found = rope_pendulum(mass=MASS, gravity=GRAVITY, s1=RADIUS, s2=RADIUS, length=LENGTH, period=changed.period)
    assert found == pytest.approx(YAW + 0.01, rel=1e-12)
    e, swing = 0.05, ideal((RADIUS, RADIUS))
    moved = ideal((RADIUS + e, RADIUS - e)).period / swing.period - 1
    assert shifted("off-centre-suspension", e, swing) == pytest.approx(moved, rel=1e-12)


def same_shift(name: str, shift: float, swing: PendulumSwing) -> float:
    """The size at which `name` moves the period by `shift`."""
    from scipy.optimize import brentq

    top = FAMILIES[name].sizes[0].high
    top = min(top, {"off-centre-suspension": 0.2, "rope-mass": 20.0}.get(name, top))
    return float(brentq(lambda size: shifted(name, size, swing) - shift, 0.0, top, xtol=1e-16))


@pytest.mark.parametrize(("one", "other"), list(permutations(FROM_A_PERIOD, 2)))
def test_one_period_is_one_number_and_every_effect_is_an_exact_alias_of_every_other(one, other):
    swing = ideal()
    shift = shifted(one, {"rope-mass": 0.3, "rope-elasticity": 5e-6, "pendulum-amplitude": 0.1}.get(one, 0.01), swing)
    assert shift > 0
    size = same_shift(other, shift, swing)
    assert shifted(other, size, swing) == pytest.approx(shift, rel=1e-6)
    assert FAMILIES[other].name in FAMILIES[one].mistaken_for


def test_a_second_length_of_the_ropes_tells_what_stretches_from_what_the_air_adds():
    shift = shifted("air-inertia", 0.005)
    c = same_shift("rope-elasticity", shift, ideal())
    short = ideal(length=1.0)
    assert shifted("rope-elasticity", c, short) == pytest.approx(2 * shift, rel=0.01)
    assert shifted("air-inertia", 0.005, short) == pytest.approx(shift, rel=1e-12)


@pytest.mark.parametrize("missing", ["mass", "inertia", "length"])
def test_what_a_pendulum_does_not_state_is_asked_for(missing):
    swing = replace(ideal(), **{missing: 0.0})
    asked = {"mass": "rope-elasticity", "inertia": "air-inertia", "length": "rope-elasticity"}[missing]
    with pytest.raises(BadInput, match=f"pendulum: `{missing}`: the effect needs the pendulum's {missing}"):
        FAMILIES[asked].change(swing, (), {"": 1e-6})


def test_a_body_outside_its_ropes_would_fall_over():
    with pytest.raises(BadInput, match="would fall over"):
        FAMILIES["off-centre-suspension"].change(ideal(), (), {"": 0.31})
    with pytest.raises(BadInput, match="needs the pendulum's radii"):
        FAMILIES["off-centre-suspension"].change(PendulumSwing(period=2.0), (), {"": 0.01})
