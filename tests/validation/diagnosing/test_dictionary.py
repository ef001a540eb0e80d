"""One column stands for resonators of every frequency."""

from types import SimpleNamespace
from typing import cast

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.diagnose.candidates import OCCAM, TINY, TINY_AT, _shape, reaches, smallest_mass
from validation.effects.catalogue import parse
from validation.estimation.screening import ScoreTest
from validation.study import Study

FREQUENCY = np.linspace(4.0, 32.0, 57)


def driven(f: float, zeta: float, mass: float = 1.0) -> np.ndarray:
    """[kg] Dynamic mass of a mass on a spring and a damper whose foot is driven: the force there over the acceleration."""
    own, omega = 2 * np.pi * f, 2 * np.pi * FREQUENCY
    k, c = mass * own**2, 2 * zeta * mass * own
    foot = k + 1j * omega * c
    moved = foot / (k + 1j * omega * c - mass * omega**2)  # of the mass, for a foot that moves by 1
    return np.asarray(foot * (1 - moved) / (-(omega**2)))


@pytest.mark.parametrize(("f", "zeta"), [(3.5, 0.005), (12.0, 0.02), (31.0, 0.08)])
def test_a_shape_turns_the_resonator_of_the_menu_into_any_other(f: float, zeta: float) -> None:
    menu = driven(TINY_AT["f"], TINY_AT["zeta"])
    assert_allclose(menu * _shape(FREQUENCY, f, zeta), driven(f, zeta), rtol=1e-9)  # rounding of 1 - moved at 1000 Hz


def test_the_shape_of_the_menu_s_own_resonator_is_one() -> None:
    assert_allclose(_shape(FREQUENCY, TINY_AT["f"], TINY_AT["zeta"]), 1.0, rtol=1e-14)


def told(deviation: float) -> ScoreTest:
    return ScoreTest(name="", estimate=0.0, information=deviation**-2)


def test_the_smallest_mass_grows_with_the_root_of_the_evidence_and_with_the_deviation() -> None:
    once = smallest_mass(told(3.0), 8.0)
    assert_allclose(smallest_mass(told(3.0), 4 * (8.0 + OCCAM) - OCCAM), 2 * once, rtol=1e-12)
    assert_allclose(smallest_mass(told(15.0), 8.0), 5 * once, rtol=1e-12)


def test_the_smallest_mass_brings_the_evidence_that_is_asked_for() -> None:
    one = told(3.0)
    offsets = smallest_mass(one, 8.0) / TINY  # a straight line from the mass TINY, whose offset is that of ln m
    assert_allclose(0.5 * offsets**2 * one.information - OCCAM, 8.0, rtol=1e-12)


def test_what_the_data_do_not_tell_has_no_smallest_mass() -> None:
    assert smallest_mass(ScoreTest(name="", estimate=0.0, information=0.0), 8.0) == np.inf


@pytest.mark.parametrize(("f", "there"), [(3.4, False), (3.6, True), (12.0, True), (36.0, True), (38.0, False)])
def test_a_resonator_reaches_the_data_a_seventh_beyond_the_band(f: float, there: bool) -> None:
    made = SimpleNamespace(measured=SimpleNamespace(frequency=FREQUENCY))
    named = parse(f"slosh:mast-top=m:0.1,f:{f},zeta:0.01")
    assert reaches(cast(Study, SimpleNamespace(made=(made,))), named) is there
