"""The limit of small motion: the paper's sweeps keep it, and what it speaks of is what exact kinematics leave over."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion, Burst, phased_sweeps, sweeps
from fem.base_excitation.response import LIMIT, judge
from geometry.frames import Array, skew

PARTICLES = np.array([[0.3, 0.1, 0.2], [-0.1, 0.4, 0.9], [0.0, -0.2, 1.4], [-0.3, 0.05, 0.6]])
"""[m] of equal mass: a body without any symmetry, its CoG off the reference point."""


def rotations(angles: Array) -> Array:
    """(n, 3, 3) Rx(alpha) Ry(beta) Rz(gamma) of (n, 3) Tait-Bryan angles."""
    (ca, cb, cg), (sa, sb, sg) = np.cos(angles).T, np.sin(angles).T
    rows = [
        [cb * cg, -cb * sg, sb],
        [ca * sg + sa * sb * cg, ca * cg - sa * sb * sg, -sa * cb],
        [sa * sg - ca * sb * cg, sa * cg + ca * sb * sg, ca * cb],
    ]
    return np.moveaxis(np.array(rows), -1, 0)


def loads(accelerations: Array) -> Array:
    """(n, 6) force and moment about the reference point on unit masses that accelerate so, (n, p, 3), in the table's axes."""
    return np.hstack([accelerations.sum(axis=1), np.cross(PARTICLES, accelerations).sum(axis=1)])


def exact(motion: BaseMotion) -> Array:
    """(n - 4, 6) what the load cells sense: positions differentiated twice (fourth order), turned into the table's axes."""
    R = rotations(motion.displacement[:, 3:])
    positions = motion.displacement[:, None, :3] + np.einsum("nij,pj->npi", R, PARTICLES)
    p, h = positions, 1 / motion.sampling_rate
    second = (16 * (p[3:-1] + p[1:-3]) - (p[4:] + p[:-4]) - 30 * p[2:-2]) / (12 * h**2)
    return loads(np.einsum("nji,npj->npi", R[2:-2], second))


def linear(motion: BaseMotion) -> Array:
    """(n - 4, 6) by Eq. 1."""
    a = motion.acceleration[2:-2]
    return loads(a[:, None, :3] + np.stack([a[:, 3:] @ skew(r) for r in PARTICLES], axis=1))


def left_over(motion: BaseMotion) -> float:
    """Largest difference of both, as a share of the largest linear load, over forces and over moments."""
    kept, difference = linear(motion), exact(motion) - linear(motion)
    halves = [(np.linalg.norm(part[:, k], axis=1).max()) for k in (slice(3), slice(3, 6)) for part in (difference, kept)]
    return max(halves[0] / halves[1], halves[2] / halves[3])


def scaled(motion: BaseMotion, factor: float) -> BaseMotion:
    kinds = ("displacement", "velocity", "acceleration")
    return replace(motion, **{kind: factor * getattr(motion, kind) for kind in kinds})


@pytest.fixture(scope="module")
def tumbling() -> BaseMotion:
    """All six axes at once, about three times what the paper drives."""
    return phased_sweeps(3.0, rate=60.0)[1].motion(2048, ring_down=0.1)


@pytest.mark.parametrize("axis", ["alpha", "beta", "gamma"])
def test_the_papers_rotation_sweeps_keep_the_limit_and_reach_less_than_half_of_it(axis: str) -> None:
    """At full level the soft start is over at 4 Hz: there the angle is A / omega²."""
    sweep = sweeps()[axis]
    verdict = judge(sweep.motion(256, ring_down=0.0))
    omega = 2 * np.pi * 4.0
    assert verdict.angle == pytest.approx(sweep.amplitude / omega**2, rel=0.05)
    assert verdict.rate == pytest.approx(sweep.amplitude / omega, rel=0.05)
    assert verdict.left_out < 0.5 * LIMIT
    assert verdict.within
    assert "within the limit of 2.00%" in verdict.text


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_a_translation_without_rotation_leaves_nothing_out(axis: str) -> None:
    verdict = judge(sweeps(rate=60.0)[axis].motion(256, ring_down=0.0))
    assert verdict.left_out == 0
    assert verdict.within


def test_of_a_harmonic_rotation_the_angle_and_the_squared_rate_say_the_same() -> None:
    """|omega|² / |omega'| = theta for theta sin(Omega t)."""
    verdict = judge(Burst(level={"beta": 8.0}, start=5.0, stop=5.0, duration=20.0).motion(512, ring_down=0.0))
    assert verdict.angle == pytest.approx(8.0 / (2 * np.pi * 5.0) ** 2, rel=2e-3)
    assert verdict.centripetal == pytest.approx(verdict.turned, rel=5e-3)


def test_twice_the_level_leaves_out_twice_the_share(tumbling: BaseMotion) -> None:
    once, twice = judge(tumbling), judge(scaled(tumbling, 2.0))
    assert twice.left_out == pytest.approx(2 * once.left_out, rel=1e-12)


def test_too_much_rotation_is_said_to_be_beyond_the_limit() -> None:
    verdict = judge(sweeps(4.0, rate=60.0)["gamma"].motion(256, ring_down=0.0))
    assert not verdict.within
    assert "beyond the limit of 2.00%" in verdict.text


def test_the_stated_share_bounds_what_exact_kinematics_leave_over(tumbling: BaseMotion) -> None:
    """All six axes at once, force and moment of a body without symmetry; and the bound is not a loose one."""
    assert 0.2 * judge(tumbling).left_out < left_over(tumbling) < judge(tumbling).left_out


@pytest.mark.parametrize("axis", ["alpha", "beta", "gamma"])
def test_the_stated_share_bounds_a_single_rotation_too(axis: str) -> None:
    motion = sweeps(4.0, rate=60.0)[axis].motion(2048, ring_down=0.1)
    assert 0.2 * judge(motion).left_out < left_over(motion) < 1.5 * judge(motion).left_out


def test_what_is_left_over_is_of_second_order(tumbling: BaseMotion) -> None:
    """Half the level leaves a quarter of the load over, half as a share; differences are exact to 1e-5 here."""
    assert_allclose(left_over(scaled(tumbling, 0.5)) / left_over(tumbling), 0.5, rtol=0.05)


def test_at_the_driven_frequency_only_third_order_is_left() -> None:
    """A steady sine about all axes: half the level leaves an eighth over in the driven line, a quarter as a share."""
    motion = Burst(level={"alpha": 20.0, "beta": 14.0, "gamma": 26.0, "x": 5.0}, start=6.0, stop=6.0, duration=8.0).motion(
        1024, ring_down=0.0
    )
    bias = []
    for level in (1.0, 0.5):
        run = scaled(motion, level)
        line = np.exp(-2j * np.pi * 6.0 * run.time[2:-2])
        kept, found = (np.linalg.norm(line @ load) for load in (linear(run), exact(run) - linear(run)))
        bias.append(found / kept)
    share = judge(motion).left_out
    assert bias[0] < share**2
    assert_allclose(bias[1] / bias[0], 0.25, rtol=0.05)


@pytest.mark.parametrize("rate", [6.0, 12.0])
def test_the_spectrum_of_a_whole_sweep_holds_half_the_angle_at_half_the_frequency(rate: float) -> None:
    """Whatever the sweep's rate: it is the share of the centripetal force, sin² = (1 - cos 2 phi) / 2, an octave later."""
    sweep = sweeps(rate=rate)["gamma"]
    run = sweep.motion(512, ring_down=0.2)
    kept, left = (np.fft.rfft(load[:, :3], axis=0) for load in (linear(run), exact(run) - linear(run)))
    frequency = np.fft.rfftfreq(len(kept) * 2 - 2, 1 / 512)
    for middle in (12.0, 16.0, 24.0):
        near = np.abs(frequency - middle) < 2.0
        angle = sweep.amplitude / (np.pi * middle) ** 2
        assert np.linalg.norm(left[near]) / np.linalg.norm(kept[near]) == pytest.approx(angle / 2, rel=0.1)
    below = (frequency > 4.5) & (frequency < 6.5)
    assert np.linalg.norm(left[below]) < 1e-3 * np.linalg.norm(kept[below])
