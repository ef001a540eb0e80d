"""The whole chain: exudyn swings, a recorder samples, and the reduction of measured pendulums reads what it wrote."""

from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.inertia import Inertia
from validation.classical import pendulum as classical_pendulum
from validation.classical.files import read
from validation.classical.pendulum import from_signal
from validation.classical.swing import (
    DIED_AWAY,
    MOST_DAMPING,
    SMALL,
    Record,
    Setup,
    recorded,
    require_recordable,
    simulated,
    suspended,
    write,
)

# the article of physics.md: three ropes of 2 m at s = 0.3 m
BODY = Inertia.from_cog(47.23, np.zeros(3), np.diag([5.0, 6.0, 2.289]))
METHOD = 8e-6
"""Of the period: what the method leaves at a thousand steps, with the rounding of nine digits in the record."""


def pendulum(radii: tuple[float, ...] = (0.3,), off: tuple[float, float] = (0.0, 0.0), **more: Any) -> Setup:
    recorder = {name: more.pop(name) for name in ("cycles", "rate", "noise", "seed") if name in more}
    suspension = suspended(radii, 0.1, off, **({"length": 2.0, "amplitude": SMALL} | more))
    given = {"article": "physics.md", "axis": "z", "along": "x", "inertia": BODY, "gravity": 9.81, "height": 0.1}
    return Setup(**given, radii=radii, off_centre=off, suspension=suspension, **({"cycles": 8.0} | recorder))


def errors(record: Record) -> tuple[float, float]:
    """Of the inertia by Eq. 5 alone and with corrections, relative."""
    return record.plain / record.setup.reference - 1, record.corrected / record.setup.reference - 1


@pytest.mark.parametrize(("amplitude", "percent"), [(0.1, 0.069), (0.2, 0.275)])
def test_a_finite_amplitude_lengthens_the_period_as_the_physics_notes_say(amplitude: float, percent: float) -> None:
    found = recorded(pendulum(amplitude=amplitude))
    assert_allclose(100 * found.shift, percent, atol=1.5e-3)  # printed to 0.001, and the method
    plain, corrected = errors(found)
    assert_allclose(plain, 2 * found.shift, rtol=0.01)  # (1 + x)² - 1
    assert abs(corrected) < 2 * METHOD


def test_damping_of_5_per_cent_lengthens_the_period_by_0_125_per_cent() -> None:
    found = recorded(pendulum(damping_ratio=0.05))
    # the physics notes say 0.126; exudyn and 1/sqrt(1 - ζ²) say 0.1252
    assert_allclose(100 * found.shift, 100 * (1 / np.sqrt(1 - 0.05**2) - 1), atol=100 * METHOD)
    assert_allclose(found.decay.damping_ratio.nominal_value, 0.05, rtol=1e-4)
    assert abs(errors(found)[1]) < 2 * METHOD


def test_ropes_of_300_g_lengthen_the_period_by_0_06_in_two_links_and_by_0_04_per_cent_in_many() -> None:
    shift = {links: 100 * recorded(pendulum(rope_mass=0.3, links=links)).shift for links in (2, 4, 8)}
    assert_allclose(shift[2], 0.062, atol=1e-3)
    uniform = (64 * shift[8] - 16 * shift[4]) / 48  # the error of lumps falls with the square of their number
    assert_allclose(uniform, 0.038, atol=1e-3)
    assert_allclose((shift[2] - shift[4]) / (shift[4] - shift[8]), 4, rtol=0.05)


def test_the_rope_mass_term_takes_off_what_eight_links_do_but_for_their_lumps() -> None:
    plain, corrected = errors(recorded(pendulum(rope_mass=0.3, links=8)))
    assert plain > 7e-4
    assert 0 < corrected < 0.06 * plain  # 0.0035 % of 0.079 %


def test_eq_5_is_exact_for_two_ropes_at_s1_and_s2() -> None:
    for radii in ((0.3, 0.3), (0.3, 0.9)):
        assert_allclose(recorded(pendulum(radii)).shift, 0, atol=METHOD)


def test_on_two_unequal_sides_the_amplitude_term_leaves_a_part_that_grows_with_the_square() -> None:
    once, twice = (errors(recorded(pendulum((0.3, 0.9), amplitude=a))) for a in (0.1, 0.2))
    assert 0.1 < once[1] / once[0] < 0.2  # an approximation, as its equation says: more is left the heavier the body pitches
    assert_allclose(twice[1] / once[1], 4, rtol=0.06)


@pytest.mark.parametrize("stiffness", [1e5, 1e6])
def test_ropes_that_stretch_cost_the_inertia_their_strain(stiffness: float) -> None:
    strain = 47.23 * 9.81 / 3 / stiffness
    plain, corrected = errors(recorded(pendulum(stiffness=stiffness)))
    assert_allclose(plain, strain, atol=2 * METHOD)
    assert_allclose(corrected, plain, atol=1e-6)  # Eq. 5 does not know


def test_a_cog_off_centre_costs_the_inertia_e_squared_over_s_squared() -> None:
    plain, _ = errors(recorded(pendulum(off=(0.006, 0.008))))
    assert_allclose(plain, 1 / (1 - 0.01**2 / 0.3**2) - 1, atol=2 * METHOD)
    # between two ropes it is s1 s2 that is mistaken
    plain, _ = errors(recorded(pendulum((0.3, 0.9), off=(0.01, 0.0))))
    assert_allclose(plain, 0.3 * 0.9 / (0.31 * 0.89) - 1, atol=2 * METHOD)


def test_a_dying_twist_is_corrected_by_the_root_mean_square_of_its_peaks() -> None:
    found = recorded(pendulum(amplitude=0.2, damping_ratio=0.005))
    plain, corrected = errors(found)
    assert plain > 4e-3
    assert abs(corrected) < 0.01 * plain  # the fit weighs the early, large swings a little more than their mean square


def test_every_effect_alone_adds_up_to_all_of_them_as_far_as_they_are_small() -> None:
    setup = pendulum(amplitude=0.05, rope_mass=0.3, links=4, stiffness=1e6, off=(0.005, 0.0))
    found = simulated(setup)
    assert [s.name for s in found.shifts] == ["amplitude", "rope-mass", "rope-stretch", "off-centre"]
    assert_allclose(sum(s.period for s in found.shifts), found.record.shift, rtol=0.05, atol=4 * METHOD)


def test_what_is_written_is_read_and_reduced_to_what_was_told(tmp_path: Path) -> None:
    found = recorded(pendulum((0.3, 0.5), amplitude=0.1, rope_mass=0.2, links=2, noise=1e-3, seed=3))
    path = write(tmp_path, found.setup, found.swing, found.signal, found.decay)
    again = classical_pendulum.reduce(read(str(path), ("pendulum",)))
    assert again.results["Izz"].nominal_value == found.corrected
    assert set(again.terms["Izz"]) == {"amplitude", "damping", "rope-mass"}
    # the tolerance of the fit holds the truth: 1 mrad of noise
    assert abs(found.period - recorded(pendulum((0.3, 0.5), amplitude=0.1, rope_mass=0.2, links=2)).period) < (
        4 * found.decay.period.std_dev
    )


def test_noise_comes_from_its_seed() -> None:
    one, same, other = (recorded(pendulum(amplitude=0.1, noise=1e-3, seed=seed, cycles=3)).signal for seed in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


def test_three_cycles_asked_for_are_three_cycles_recorded_however_the_body_pitches() -> None:
    steep = Inertia.from_cog(47.23, np.zeros(3), np.diag([20.1, 20.4, 2.289]))
    test = replace(pendulum((0.3, 0.9), amplitude=0.5, cycles=3.0), inertia=steep)
    found = recorded(test)
    assert found.decay.cycles > 3
    assert found.shift > 0.05  # no formula foresees the period: it would have been 2.9 cycles


@pytest.mark.parametrize("cycles", [3.0, 8.0, 20.0, 100.0])
def test_the_heaviest_damping_that_is_let_in_is_found_again_in_a_clean_record(cycles: float) -> None:
    zeta = min(MOST_DAMPING, np.sqrt(DIED_AWAY / cycles))
    require_recordable(pendulum(cycles=cycles, damping_ratio=0.999 * zeta))
    with pytest.raises(BadInput, match=r"damping_ratio.*Use"):
        require_recordable(pendulum(cycles=cycles, damping_ratio=1.01 * zeta))
    t = np.linspace(0, cycles + 0.15, int(50 * cycles)) * 2 * np.pi / np.sqrt(1 - zeta**2)
    y = np.exp(-zeta * t) * np.cos(np.sqrt(1 - zeta**2) * t)
    assert_allclose(from_signal(t, y, "clean").damping_ratio.nominal_value, zeta, rtol=1e-6)


@pytest.mark.parametrize(
    ("setup", "words"),
    [
        (pendulum(seed=-1), "seed.*negative"),
        (pendulum(cycles=1001.0), "cycles.*at most 1000"),
        (pendulum(rate=1e6), "rate.*samples, more than"),
        (pendulum(stiffness=1000.0), "stiffness.*stretch by 15.4 %.*Use an EA of 1.56e"),
        (pendulum(rope_mass=50.0), "rope_mass.*heavier"),
        (pendulum(cycles=2.0), "cycles.*at least 3"),
        (pendulum(rate=2.0), "samples a cycle, 5 are needed.*Record at 3 Hz"),
        (pendulum(noise=-1.0), "noise.*negative"),
        (pendulum(amplitude=3.2), "cross or lie flat"),
        (pendulum((0.3, 1.2), amplitude=2.0), "cross or lie flat"),
        (pendulum(off=(-0.2, 0.0)), "would have to push"),
    ],
)
def test_what_cannot_be_recorded_is_refused(setup: Setup, words: str) -> None:
    with pytest.raises(BadInput, match=words):
        recorded(setup)
