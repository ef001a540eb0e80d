"""The pendulums against bodies posed and integrated numerically, term by term."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.integrate import solve_ivp
from scipy.optimize import minimize
from scipy.spatial.transform import Rotation
from scipy.special import ellipk
from uncertainties import UFloat, ufloat

from geometry.errors import BadInput
from geometry.inertia import tensor_from_six
from geometry.toml_file import exact, tagged
from validation.classical.pendulum import (
    SIX,
    CompoundSwing,
    RopeSwing,
    Terms,
    TorsionSwing,
    compound_pendulum,
    from_cycles,
    from_signal,
    from_times,
    plane_amplitude_factor,
    rod_inertia,
    rope_amplitude_factor,
    rope_pendulum,
    tensor_from_axes,
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
def test_a_body_posed_numerically_on_its_ropes_rises_as_eq_5_says(feet, product):
    angle = 0.05
    stiffness_over_weight = 2 * rise(np.array(feet, dtype=np.float64), angle) / angle**2
    # the next term of the series is at most φ²/12 = 2e-4; the height of the feet over the CoG must not matter
    assert_allclose(stiffness_over_weight, product / LENGTH, rtol=5e-4)


def test_eq_5_gives_back_the_inertia_of_its_own_period_damped_or_wide():
    assert_allclose(rope_pendulum(mass=MASS, gravity=G, s1=S, s2=S, length=LENGTH, period=SMALL_PERIOD), INERTIA, rtol=1e-14)
    zeta = 0.05
    damped = SMALL_PERIOD / np.sqrt(1 - zeta**2)
    assert_allclose(100 * (damped / SMALL_PERIOD - 1), 0.1252, atol=5e-5)
    assert_allclose(swing(damped).inertia(Terms(damping=exact(zeta))).nominal_value, INERTIA, rtol=1e-13)
    found = swing(integrated_period(0.7)).inertia(Terms(amplitude=exact(0.7)))
    assert_allclose(found.nominal_value, INERTIA, rtol=1e-8)


def test_lengths_times_a_scale_at_one_density_give_inertia_times_its_fifth_power():
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
def test_the_amplitude_term_is_that_of_the_exact_equation_of_motion(amplitude):
    # the integration is asked for 1e-12 a step; 1e-9 is what remains over a quarter swing
    assert_allclose(rope_amplitude_factor(amplitude, EPSILON, KAPPA), integrated_period(amplitude) / SMALL_PERIOD, rtol=1e-9)


def test_the_series_in_the_docstring_is_the_leading_term():
    series = 1 / 16 - 3 * EPSILON / 16 + KAPPA * EPSILON / 4
    for amplitude in (0.02, 0.1):
        # the next term is of order A² relative to the first
        assert_allclose(
            (rope_amplitude_factor(amplitude, EPSILON, KAPPA) - 1) / amplitude**2, series, rtol=0.2 * amplitude**2 + 1e-9
        )


@pytest.mark.parametrize("amplitude", [0.1, 1.0, 2.0])
def test_the_compound_amplitude_term_is_the_complete_elliptic_integral(amplitude):
    assert_allclose(plane_amplitude_factor(amplitude), 2 / np.pi * ellipk(np.sin(amplitude / 2) ** 2), rtol=1e-13)


@pytest.mark.parametrize(("amplitude", "epsilon"), [(3.2, EPSILON), (-4.0, EPSILON), (2.0, 0.5)])
def test_amplitudes_that_no_rope_allows_are_refused(amplitude, epsilon):
    with pytest.raises(BadInput, match="cross or lie flat"):
        rope_amplitude_factor(amplitude, epsilon, KAPPA)


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
def test_the_rope_mass_term_is_that_of_a_hanging_chain(rope_mass):
    found = swing(rope_period(rope_mass, 60)).inertia(Terms(rope_mass=exact(rope_mass)))
    # neglected: (M/m)², and the chain's own lumping, M s²/I / 60² of it
    assert_allclose(found.nominal_value, INERTIA, rtol=(rope_mass / MASS) ** 2 + 1e-5)


def test_the_tolerance_of_the_amplitude_reaches_the_result_and_terms_are_switched_one_by_one():
    period, step = integrated_period(0.5), 1e-4
    ends = [swing(period).inertia(Terms(amplitude=exact(0.5 + d))).nominal_value for d in (-step, step)]
    found = swing(period).inertia(Terms(amplitude=tagged(0.5, 0.05, "amplitude")))
    assert_allclose(found.std_dev, 0.05 * abs(ends[1] - ends[0]) / (2 * step), rtol=1e-4)  # two numerical derivatives
    terms = Terms(amplitude=exact(0.2), damping=exact(0.05), rope_mass=exact(0.3))
    assert terms.names == ("amplitude", "damping", "rope-mass")
    assert terms.without("rope-mass").names == ("amplitude", "damping")
    bare = swing(SMALL_PERIOD).inertia(terms.without("amplitude").without("damping").without("rope-mass"))
    assert_allclose(bare.nominal_value, INERTIA, rtol=1e-13)


@pytest.mark.parametrize("amplitude", [0.0, 0.8])
def test_a_rod_swung_from_its_end_is_twelve_of_a_third(amplitude):
    # thin rod: m L²/3 about the end is m L²/12 about the CoG; T = 2π sqrt(2L/3g), lengthened by the amplitude
    length, mass = 1.2, 3.0
    period = 2 * np.pi * np.sqrt(2 * length / (3 * G)) * 2 / np.pi * ellipk(np.sin(amplitude / 2) ** 2)
    pendulum = CompoundSwing(mass=exact(mass), gravity=exact(G), arm=exact(length / 2), period=exact(period))
    assert_allclose(pendulum.inertia(Terms(amplitude=exact(amplitude))).nominal_value, mass * length**2 / 12, rtol=1e-12)


def test_a_compound_period_of_a_point_mass_leaves_nothing_and_the_known_rod_is_a_solid_cylinder():
    assert_allclose(compound_pendulum(mass=2.0, gravity=G, arm=0.5, period=2 * np.pi * np.sqrt(0.5 / G)), 0, atol=1e-15)
    # limits: a thin rod m L²/12, and a disc about its diameter m d²/16
    assert_allclose(rod_inertia(mass=2.0, length=3.0, diameter=0.0), 1.5, rtol=1e-14)
    assert_allclose(rod_inertia(mass=2.0, length=0.0, diameter=4.0), 2.0, rtol=1e-14)


def test_the_torsion_rod_weighs_one_inertia_against_another_and_the_corrected_swing_keeps_correlations():
    stiffness = torsion_stiffness(known_inertia=0.5, period=1.9)
    assert_allclose(torsion_pendulum(stiffness=stiffness, period=1.9), 0.5, rtol=1e-14)
    assert_allclose(torsion_pendulum(stiffness=stiffness, period=3.8), 2.0, rtol=1e-14)
    damped = TorsionSwing(stiffness=exact(2.0), period=exact(1.0 / np.sqrt(1 - 0.1**2)))
    assert_allclose(
        damped.inertia(Terms(damping=exact(0.1))).nominal_value, torsion_pendulum(stiffness=2.0, period=1.0), rtol=1e-14
    )
    # s1 + s2 fixed by the rope places, the CoG between them uncertain: d(s1 s2)/dc = s2 - s1, nothing when they are equal
    cog = tagged(0.6, 0.01, "position of the CoG")
    equal = rope_pendulum(mass=exact(MASS), gravity=exact(G), s1=cog - 0.3, s2=0.9 - cog, length=exact(2.0), period=exact(1.0))
    assert isinstance(equal, UFloat)
    assert_allclose(equal.std_dev, 0.0, atol=1e-12 * equal.nominal_value)


T, ZETA = 3.1, 0.01
TIME = np.arange(0, 40, 0.02)


def decay(time: np.ndarray, period: float = T, zeta: float = ZETA, amplitude: float = 0.1) -> np.ndarray:
    rate = zeta / np.sqrt(1 - zeta**2) * 2 * np.pi / period
    return amplitude * np.exp(-rate * time) * np.cos(2 * np.pi * time / period + 0.3)


def test_more_cycles_make_the_stop_watch_better_and_a_clean_record_gives_period_damping_and_amplitude_to_rounding():
    few, many = (from_cycles(n, tagged(n * T, 0.2, "time"), "file") for n in (5, 50))
    assert_allclose([few.nominal_value, many.nominal_value], T, rtol=1e-14)
    assert_allclose(few.std_dev / many.std_dev, 10, rtol=1e-12)
    found = from_signal(TIME, decay(TIME) + 0.002 * TIME + 2, "file")
    assert_allclose([found.period.nominal_value, found.damping_ratio.nominal_value], [T, ZETA], rtol=1e-9)
    rate = ZETA / np.sqrt(1 - ZETA**2) * 2 * np.pi / T
    peaks = 0.1 * np.exp(-rate * TIME)
    assert_allclose(found.amplitude, np.sqrt(np.mean(peaks**2)), rtol=0.02)  # the record holds no whole number of cycles
    uneven = np.sort(np.random.default_rng(2).uniform(0, 40, 900))
    assert_allclose(from_signal(uneven, decay(uneven), "file").period.nominal_value, T, rtol=1e-9)


def test_the_stated_tolerance_of_a_noisy_record_covers_as_a_standard_deviation_should():
    rng = np.random.default_rng(7)
    fits = [from_signal(TIME, decay(TIME) + 0.005 * rng.normal(size=len(TIME)), "file") for _ in range(60)]
    off = np.array([(fit.period.nominal_value - T) / fit.period.std_dev for fit in fits])
    # 60 draws know a standard deviation to 9 %, a mean to 0.13: three of each
    assert 0.7 < off.std() < 1.3
    assert abs(off.mean()) < 0.4


def test_noise_drift_and_a_second_oscillation_are_said():
    rng = np.random.default_rng(3)
    noisy = from_signal(TIME, decay(TIME) + 0.02 * rng.normal(size=len(TIME)), "file")
    drifting = from_signal(TIME, decay(TIME) + 0.05 * TIME, "file")
    beating = from_signal(TIME, decay(TIME) + 0.01 * np.sin(2 * np.pi * 0.9 * TIME), "file")
    assert "of the signal" in noisy.notes[0]
    assert "drifts" in drifting.notes[0]
    assert any("correlated" in note for note in beating.notes)


@pytest.mark.parametrize(
    ("time", "signal", "words"),
    [
        (TIME[:400], decay(TIME[:400]), "at least 3 cycles"),
        (TIME[::200], decay(TIME[::200], period=10.0), "hold 15 samples"),
        (np.arange(0, 90, 0.8), decay(np.arange(0, 90, 0.8), period=2.5), "samples a cycle"),
        (TIME, np.where(TIME > 20, np.nan, 1.0), "not finite"),
        (TIME[::-1], decay(TIME), "time must increase"),
        (TIME, np.ones_like(TIME), "constant"),
        (TIME, decay(TIME)[::-1], "grows"),
        (TIME, np.random.default_rng(1).normal(size=len(TIME)), "no decaying sinusoid|samples a cycle"),
        (TIME, decay(TIME)[:-1], "equally long"),
    ],
)
def test_records_that_cannot_be_trusted_are_refused(time, signal, words):
    with pytest.raises(BadInput, match=words):
        from_signal(time, signal, "file")


def test_the_slope_of_the_passage_times_is_the_period_and_their_scatter_enters_the_tolerance():
    times = [tagged(2 + T * i, 0.05, "passage times") for i in range(11)]
    found = from_times(times, "file")
    assert_allclose(found.nominal_value, T, rtol=1e-13)
    # slope of a line through n evenly spaced points: σ / sqrt(n (n² - 1)/12)
    assert_allclose(found.std_dev, 0.05 / np.sqrt(11 * 120 / 12), rtol=1e-9)
    scattered = T * np.arange(11) + np.random.default_rng(4).normal(0, 0.05, 11)
    assert from_times([exact(t) for t in scattered], "file").std_dev > 0


@pytest.mark.parametrize("times", [[0.0, 3.0], [0.0, 3.0, 2.0], [0.0, 3.1, 6.2, 12.4, 15.5]])
def test_lists_that_hide_something_are_refused(times):
    with pytest.raises(BadInput, match="times"):
        from_times([exact(t) for t in times], "file")


@pytest.mark.parametrize(("count", "time"), [(0, 3.0), (10, 0.0), (10, -3.0)])
def test_counts_and_times_must_be_positive(count, time):
    with pytest.raises(BadInput):
        from_cycles(count, exact(time), "file")


@pytest.mark.parametrize("cycles", [3.3, 5.5, 8.0])
def test_the_amplitude_is_the_root_mean_square_of_the_envelope_whatever_part_of_a_cycle_is_left_over(cycles):
    t = np.linspace(0, cycles, 400)
    envelope = 0.2 * np.exp(-0.1 * t)
    found = from_signal(t, envelope * np.cos(2 * np.pi * t) + 0.05 * t, "record")
    assert_allclose(found.amplitude, np.sqrt(np.mean(envelope**2)), rtol=1e-6)
    assert_allclose(found.fitted, envelope * np.cos(2 * np.pi * t) + 0.05 * t, atol=1e-7)


DIAGONALS = np.array([[1, 0, 0], [0, 1, 0], [0, 0, 1], [1, 1, 0], [1, 0, 1], [0, 1, 1.0]])
BODY = tensor_from_six([20.353, 20.528, 2.278, 0.11, -0.23, 0.05])


def moments(axes: np.ndarray, tensor: np.ndarray = BODY) -> np.ndarray:
    units = axes / np.linalg.norm(axes, axis=1)[:, None]
    return np.einsum("ni,ij,nj->n", units, tensor, units)


@settings(deadline=None, max_examples=25)
@given(st.integers(0, 2**32 - 1), st.integers(6, 12))
def test_moments_about_general_axes_give_back_the_tensor(seed, count):
    axes = np.vstack([DIAGONALS, np.random.default_rng(seed).normal(size=(count - 6, 3))])
    found = tensor_from_axes(axes, list(moments(axes)))
    # the six diagonals alone have condition number 6, so rounding stays near 1e-14 of the largest entry
    assert_allclose(tensor_from_six([found[name] for name in SIX]), BODY, atol=1e-12)


def test_a_coordinate_pendulum_reads_the_diagonal_and_axes_in_one_plane_or_five_leave_entries_unseen():
    found = tensor_from_axes(np.eye(3), [1.0, 2.0, 3.0], ("xx", "yy", "zz"))
    assert_allclose([found["xx"], found["yy"], found["zz"]], [1, 2, 3], rtol=1e-14)
    angles = np.linspace(0, 2.5, 7)
    axes = np.column_stack([np.cos(angles), np.sin(angles), 0 * angles])
    with pytest.raises(BadInput, match="Izz, Ixz, Iyz"):
        tensor_from_axes(axes, list(moments(axes)))
    with pytest.raises(BadInput, match="5 axes do not determine Iyz of the 6 entries"):
        tensor_from_axes(DIAGONALS[:5], list(moments(DIAGONALS[:5])))


PLANAR = ("xx", "zz", "xz")


def test_least_squares_tolerance_follows_moments_and_angles_as_finite_differences_say():
    angles = np.radians([3.0, 47.0, 95.0, 150.0])
    readings = np.array([1.3, 0.9, 0.8, 1.2])  # no tensor fits these exactly: the residual's part of the derivative is tested

    def solved(a, j):
        found = tensor_from_axes(np.column_stack([np.cos(a), 0 * a, -np.sin(a)]), list(j), PLANAR)
        return np.array([found[name] for name in PLANAR])

    da, dj, step = 0.004, 0.01, 1e-6
    by_angle = [(solved(angles + step * e, readings) - solved(angles - step * e, readings)) / (2 * step) for e in np.eye(4)]
    by_moment = [solved(angles, readings + e) - solved(angles, readings) for e in np.eye(4)]
    expected = np.sqrt(np.sum((da * np.array(by_angle)) ** 2, axis=0) + np.sum((dj * np.array(by_moment)) ** 2, axis=0))

    from uncertainties import umath

    tagged = [ufloat(a, da) for a in angles]
    axes = [(umath.cos(a), 0.0, -umath.sin(a)) for a in tagged]
    found = tensor_from_axes(axes, [ufloat(j, dj) for j in readings], PLANAR)
    # central differences with a step of 1e-6 are good to about 1e-9
    assert_allclose([found[name].std_dev for name in PLANAR], expected, rtol=1e-7)
