"""The pendulums against bodies posed and integrated numerically, term by term."""

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from scipy.special import ellipk
from uncertainties import UFloat

from geometry.errors import BadInput
from geometry.toml_file import exact, tagged
from validation.classical.pendulum import (
    CompoundSwing,
    RopeSwing,
    Terms,
    TorsionSwing,
    compound_pendulum,
    plane_amplitude_factor,
    rod_inertia,
    rope_amplitude_factor,
    rope_pendulum,
    torsion_pendulum,
    torsion_stiffness,
)

G = 9.81
# the article of physics.md: three ropes of 2 m at s = 0.3 m
MASS, INERTIA, S, LENGTH = 47.23, 2.289, 0.3, 2.0
SMALL_PERIOD = 2 * np.pi * np.sqrt(INERTIA * LENGTH / (MASS * G * S**2))
EPSILON, KAPPA = S**2 / LENGTH**2, MASS * S**2 / INERTIA


def rise(feet: np.ndarray, angle: float) -> float:
    """How far the CoG rises when a body on vertical ropes of LENGTH, attached at `feet` (n, 3) from the CoG, is held at a twist
    and left to find its lowest pose: nothing but rope lengths and gravity."""
    ceiling = feet + np.array([0, 0, LENGTH])

    def slack(q: np.ndarray) -> np.ndarray:
        placed = Rotation.from_euler("xyz", [q[0], q[1], angle]).apply(feet) + q[2:]
        return LENGTH**2 - np.sum((placed - ceiling) ** 2, axis=1)

    found = minimize(
        lambda q: q[4], np.zeros(5), constraints={"type": "ineq", "fun": slack}, method="SLSQP", options={"ftol": 1e-16}
    )
    return float(found.x[4])


@pytest.mark.parametrize(
    ("feet", "product"),
    [
        ([[-0.55, 0, 0.1], [0.9, 0, 0.1]], 0.55 * 0.9),
        ([[-0.3, 0, 0.2], [0.3, 0, 0.2]], 0.09),
        (S * np.array([[1, 0, 0.5], [-0.5, 0.75**0.5, 0.5], [-0.5, -(0.75**0.5), 0.5]]), S**2),
    ],
)
def test_a_body_posed_numerically_on_its_ropes_rises_as_eq_5_says(feet: list[list[float]], product: float) -> None:
    angle = 0.05
    stiffness_over_weight = 2 * rise(np.array(feet, dtype=np.float64), angle) / angle**2
    # the next term of the series is at most φ²/12 = 2e-4; the height of the feet over the CoG must not matter
    assert_allclose(stiffness_over_weight, product / LENGTH, rtol=5e-4)


def test_eq_5_gives_back_the_inertia_of_its_own_period() -> None:
    assert_allclose(rope_pendulum(mass=MASS, gravity=G, s1=S, s2=S, length=LENGTH, period=SMALL_PERIOD), INERTIA, rtol=1e-14)


def test_lengths_times_a_scale_at_one_density_give_inertia_times_its_fifth_power() -> None:
    scale = 1.7
    there = {"mass": 10.0, "gravity": G, "s1": 0.2, "s2": 0.3, "length": 2.0}
    scaled = {**there, "mass": 10.0 * scale**3} | {name: there[name] * scale for name in ("s1", "s2", "length")}
    # a period of weight-driven motion goes with the square root of the length
    ratio = rope_pendulum(**scaled, period=3.0 * np.sqrt(scale)) / rope_pendulum(**there, period=3.0)
    assert_allclose(ratio, scale**5, rtol=1e-13)


def integrated_period(amplitude: float) -> float:
    """Period of the exact equation of motion of the twisting, rising body, by DOP853 from rest to the first zero."""

    def motion(_: float, state: np.ndarray) -> list[float]:
        phi, rate = state
        h = np.sqrt(LENGTH**2 - 4 * S**2 * np.sin(phi / 2) ** 2)
        slope = -(S**2) * np.sin(phi) / h
        bend = -(S**2) * np.cos(phi) / h - slope**2 / h
        return [rate, (MASS * G * slope - MASS * slope * bend * rate**2) / (INERTIA + MASS * slope**2)]

    def upright(_: float, state: np.ndarray) -> float:
        return float(state[0])

    upright.terminal = True  # type: ignore[attr-defined]
    run = solve_ivp(motion, (0, 10 * SMALL_PERIOD), [amplitude, 0.0], method="DOP853", rtol=1e-12, atol=1e-14, events=upright)
    return 4 * float(run.t_events[0][0])


@pytest.mark.parametrize("amplitude", [0.01, 0.1, 0.2, 0.7, 1.5, 2.5])
def test_the_amplitude_term_is_that_of_the_exact_equation_of_motion(amplitude: float) -> None:
    # the integration is asked for 1e-12 a step; 1e-9 is what remains over a quarter swing
    assert_allclose(rope_amplitude_factor(amplitude, EPSILON, KAPPA), integrated_period(amplitude) / SMALL_PERIOD, rtol=1e-9)


def test_the_series_in_the_docstring_is_the_leading_term() -> None:
    series = 1 / 16 - 3 * EPSILON / 16 + KAPPA * EPSILON / 4
    for amplitude in (0.02, 0.1):
        # the next term is of order A² relative to the first
        assert_allclose(
            (rope_amplitude_factor(amplitude, EPSILON, KAPPA) - 1) / amplitude**2, series, rtol=0.2 * amplitude**2 + 1e-9
        )


@pytest.mark.parametrize(("amplitude", "percent"), [(0.1, 0.069), (0.2, 0.275)])
def test_the_amplitude_figures_of_the_physics_notes_come_out(amplitude: float, percent: float) -> None:
    assert_allclose(100 * (rope_amplitude_factor(amplitude, EPSILON, KAPPA) - 1), percent, atol=5e-4)  # printed to 0.001


@pytest.mark.parametrize("amplitude", [0.1, 1.0, 2.0])
def test_the_compound_amplitude_term_is_the_complete_elliptic_integral(amplitude: float) -> None:
    assert_allclose(plane_amplitude_factor(amplitude), 2 / np.pi * ellipk(np.sin(amplitude / 2) ** 2), rtol=1e-13)


@pytest.mark.parametrize("amplitude", [3.2, -4.0])
def test_amplitudes_that_no_rope_allows_are_refused(amplitude: float) -> None:
    with pytest.raises(BadInput, match="cross or lie flat"):
        rope_amplitude_factor(amplitude, EPSILON, KAPPA)


def test_ropes_that_would_lie_flat_are_refused() -> None:
    with pytest.raises(BadInput, match="cross or lie flat"):
        rope_amplitude_factor(2.0, 0.5, KAPPA)


def rope_period(rope_mass: float, segments: int) -> float:
    """Small-amplitude period with each rope a chain of `segments` massless links between point masses, weight and all."""
    step, point = LENGTH / segments, rope_mass / segments
    # all ropes together; coordinates are the sideways places of the nodes, the lowest is s φ
    tension = G * (MASS + rope_mass - point * (np.arange(segments) + 0.5))
    K = np.zeros((segments, segments))
    for i, force in enumerate(tension):
        K[i, i] += force / step
        if i:
            K[i - 1, i - 1] += force / step
            K[i, i - 1] = K[i - 1, i] = -force / step
    M = np.full(segments, point)
    M[-1] = point / 2 + INERTIA / S**2
    root = np.sqrt(M)
    return float(2 * np.pi / np.sqrt(np.linalg.eigvalsh(K / np.outer(root, root))[0]))


def swing(period: float) -> RopeSwing:
    given = {"mass": MASS, "gravity": G, "s1": S, "s2": S, "length": LENGTH, "period": period}
    return RopeSwing(**{name: exact(value) for name, value in given.items()})


@pytest.mark.parametrize("rope_mass", [0.1, 0.3, 1.0])
def test_the_rope_mass_term_is_that_of_a_hanging_chain(rope_mass: float) -> None:
    found = swing(rope_period(rope_mass, 60)).inertia(Terms(rope_mass=exact(rope_mass)))
    # neglected: (M/m)², and the chain's own lumping, M s²/I / 60² of it
    assert_allclose(found.nominal_value, INERTIA, rtol=(rope_mass / MASS) ** 2 + 1e-5)


def test_light_ropes_lengthen_the_period_by_four_hundredths_of_a_per_cent_and_two_lumps_a_rope_by_six() -> None:
    # The physics notes quote +0.06 % for ropes of 0.3 kg. A uniform rope gives 0.038 %; 0.062 % is that of a rope in two links.
    assert_allclose(100 * (rope_period(0.3, 60) / SMALL_PERIOD - 1), 0.038, atol=5e-4)
    assert_allclose(100 * (rope_period(0.3, 2) / SMALL_PERIOD - 1), 0.062, atol=5e-4)


def test_a_damped_period_gives_the_undamped_inertia() -> None:
    zeta = 0.05
    damped = SMALL_PERIOD / np.sqrt(1 - zeta**2)
    assert_allclose(100 * (damped / SMALL_PERIOD - 1), 0.1252, atol=5e-5)
    assert_allclose(swing(damped).inertia(Terms(damping=exact(zeta))).nominal_value, INERTIA, rtol=1e-13)


def test_the_amplitude_term_gives_back_the_inertia_that_it_needs_to_know() -> None:
    found = swing(integrated_period(0.7)).inertia(Terms(amplitude=exact(0.7)))
    assert_allclose(found.nominal_value, INERTIA, rtol=1e-8)


def test_the_tolerance_of_the_amplitude_reaches_the_result() -> None:
    period, step = integrated_period(0.5), 1e-4
    ends = [swing(period).inertia(Terms(amplitude=exact(0.5 + d))).nominal_value for d in (-step, step)]
    found = swing(period).inertia(Terms(amplitude=tagged(0.5, 0.05, "amplitude")))
    assert_allclose(found.std_dev, 0.05 * abs(ends[1] - ends[0]) / (2 * step), rtol=1e-4)  # two numerical derivatives


def test_terms_are_switched_one_by_one() -> None:
    terms = Terms(amplitude=exact(0.2), damping=exact(0.05), rope_mass=exact(0.3))
    assert terms.names == ("amplitude", "damping", "rope-mass")
    assert terms.without("rope-mass").names == ("amplitude", "damping")
    bare = swing(SMALL_PERIOD).inertia(terms.without("amplitude").without("damping").without("rope-mass"))
    assert_allclose(bare.nominal_value, INERTIA, rtol=1e-13)


@pytest.mark.parametrize("amplitude", [0.0, 0.8])
def test_a_rod_swung_from_its_end_is_twelve_of_a_third(amplitude: float) -> None:
    # thin rod: m L²/3 about the end is m L²/12 about the CoG; T = 2π sqrt(2L/3g), lengthened by the amplitude
    length, mass = 1.2, 3.0
    period = 2 * np.pi * np.sqrt(2 * length / (3 * G)) * 2 / np.pi * ellipk(np.sin(amplitude / 2) ** 2)
    pendulum = CompoundSwing(mass=exact(mass), gravity=exact(G), arm=exact(length / 2), period=exact(period))
    assert_allclose(pendulum.inertia(Terms(amplitude=exact(amplitude))).nominal_value, mass * length**2 / 12, rtol=1e-12)


def test_a_compound_period_of_a_point_mass_leaves_nothing() -> None:
    assert_allclose(compound_pendulum(mass=2.0, gravity=G, arm=0.5, period=2 * np.pi * np.sqrt(0.5 / G)), 0, atol=1e-15)


def test_the_torsion_rod_weighs_one_inertia_against_another() -> None:
    stiffness = torsion_stiffness(known_inertia=0.5, period=1.9)
    assert_allclose(torsion_pendulum(stiffness=stiffness, period=1.9), 0.5, rtol=1e-14)
    assert_allclose(torsion_pendulum(stiffness=stiffness, period=3.8), 2.0, rtol=1e-14)


def test_damping_of_a_torsion_swing_is_taken_off_its_period() -> None:
    damped = TorsionSwing(stiffness=exact(2.0), period=exact(1.0 / np.sqrt(1 - 0.1**2)))
    assert_allclose(
        damped.inertia(Terms(damping=exact(0.1))).nominal_value, torsion_pendulum(stiffness=2.0, period=1.0), rtol=1e-14
    )


def test_the_known_rod_is_a_solid_cylinder() -> None:
    # limits: a thin rod m L²/12, and a disc about its diameter m d²/16
    assert_allclose(rod_inertia(mass=2.0, length=3.0, diameter=0.0), 1.5, rtol=1e-14)
    assert_allclose(rod_inertia(mass=2.0, length=0.0, diameter=4.0), 2.0, rtol=1e-14)


def test_the_corrected_swing_keeps_the_correlation_of_s1_and_s2() -> None:
    # s1 + s2 fixed by the rope places, the CoG between them uncertain: d(s1 s2)/dc = s2 - s1, nothing when they are equal
    cog = tagged(0.6, 0.01, "position of the CoG")
    equal = rope_pendulum(mass=exact(MASS), gravity=exact(G), s1=cog - 0.3, s2=0.9 - cog, length=exact(2.0), period=exact(1.0))
    assert isinstance(equal, UFloat)
    assert_allclose(equal.std_dev, 0.0, atol=1e-12 * equal.nominal_value)
