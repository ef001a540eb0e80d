"""Weighing and the crane test: closed forms, statics posed numerically, and the effect of each tolerance."""

import tomllib
from typing import Any

import numpy as np
import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.toml_file import exact, tagged
from validation.classical import weigh
from validation.classical.files import Fields, itemised
from validation.classical.weigh import cog_height

WEIGHING = """
[balance]
resolution = "20 g"
relative_error = "0.05 %"
digit_error = 1
[[reading]]
gross = "48.62 kg"
tare = "1.22 kg"
"""
CRANE = """
[article]
mass = "47.40 +/- 0.05 kg"
[balance]
resolution = "20 g"
relative_error = "0.05 %"
digit_error = 1
[[reading]]
shown = "30.12 kg"
[distances]
rope = "1600 +/- 0.5 mm"
support = "31 +/- 0.5 mm"
"""


def fields(text: str, more: str = "") -> Fields:
    table: dict[str, Any] = tomllib.loads(text + more)
    return Fields(source="file.toml", place="", table=table)


def test_a_weighing_adds_resolution_digit_and_relative_error_in_quadrature_and_repeated_averages_all_but_the_last():
    mass = weigh.reduce(fields(WEIGHING)).results["mass"]
    assert_allclose(mass.nominal_value, 47.40, rtol=1e-14)
    # gross and tare each: half of 20 g, and one digit of 20 g; once 0.05 % of the net mass
    assert_allclose(mass.std_dev, np.sqrt(2 * 0.01**2 + 2 * 0.02**2 + (0.0005 * 47.4) ** 2), rtol=1e-12)
    again = '[[reading]]\ngross = "48.62 kg"\ntare = "1.22 kg"\n' * 99
    mass = weigh.reduce(fields(WEIGHING, again)).results["mass"]
    assert_allclose(mass.std_dev, np.sqrt((2 * 0.01**2 + 2 * 0.02**2) / 100 + (0.0005 * 47.4) ** 2), rtol=1e-9)


def test_scatter_of_the_readings_is_an_item_and_the_rope_carries_what_the_balance_does_not():
    mass = weigh.reduce(fields(WEIGHING, '[[reading]]\ngross = "48.82 kg"\ntare = "1.22 kg"\n')).results["mass"]
    scatter = {item.name: item.contribution for item in itemised(mass)}["scatter of the readings"]
    assert_allclose(scatter, 0.1, rtol=1e-3)  # two readings 0.2 kg apart: 0.2/sqrt(2)/sqrt(2), times the gain 1
    reduced = weigh.reduce_cog(fields('gravity = "10 m/s^2"\n' + CRANE))
    assert_allclose(reduced.results["rope_force"].nominal_value, 172.8, rtol=1e-13)


AIR = 'air_density = "1.2 kg/m^3"\nweights_density = "8000 kg/m^3"\narticle_density = "2700 kg/m^3"\n'


def test_buoyancy_is_off_until_it_is_asked_for_and_balances_the_forces_then():
    off = weigh.reduce(fields(WEIGHING, "[buoyancy]\n" + AIR))
    on = weigh.reduce(fields(WEIGHING, "[buoyancy]\napply = true\n" + AIR))
    shown, mass = off.results["mass"].nominal_value, on.results["mass"].nominal_value
    # in air, weights of the shown mass and the article pull alike
    assert_allclose(mass - 1.2 * mass / 2700, shown - 1.2 * shown / 8000, rtol=1e-14)
    assert "not corrected; it would change" in off.notes[0]
    assert_allclose(on.terms["mass"]["buoyancy"], mass / shown - 1, rtol=1e-12)


@given(st.floats(-0.3, 0.3), st.floats(-0.1, 0.1), st.floats(-0.1, 0.1), st.floats(0.1, 1.4), st.floats(1.5, 2.0))
def test_the_lever_recovers_the_cog_of_a_body_whose_statics_are_solved_numerically(lean, rope_offset, support_offset, cog, rope):
    mass, support = 47.4, 0.031
    turn = np.array([[np.cos(lean), -np.sin(lean)], [np.sin(lean), np.cos(lean)]])
    places = [turn @ p for p in ((support, support_offset), (rope, rope_offset), (cog, 0.0))]
    # unknown vertical forces at support and rope: forces add up, moments about the world's origin vanish
    arms = [place[0] for place in places]
    reading, _ = np.linalg.solve([[1, 1], arms[:2]], [mass, mass * arms[2]])
    quantities = {"mass": mass, "reading": reading, "rope": rope, "support": support, "inclination": lean}
    found = cog_height(
        **{name: exact(value) for name, value in quantities.items()}, rope_offset=rope_offset, support_offset=support_offset
    )
    assert_allclose(found.nominal_value, cog, rtol=1e-9)


def test_without_offsets_the_inclination_does_not_matter_and_with_them_its_tolerance_counts():
    level, leaning = (
        weigh.reduce_cog(fields(CRANE, f'inclination = "{angle}"')).results["cog_z"] for angle in ("0 deg", "20 +/- 5 deg")
    )
    assert_allclose([leaning.nominal_value, leaning.std_dev], [level.nominal_value, level.std_dev], rtol=1e-13)
    reduced = weigh.reduce_cog(fields(CRANE, 'inclination = "0 +/- 1 deg"\nsupport_offset = "-100 mm"'))
    part = {item.name: item.contribution for item in itemised(reduced.results["cog_z"])}["inclination"]
    assert_allclose(part, 30.12 / 47.4 * 0.1 * np.radians(1), rtol=1e-12)


def test_tolerances_of_the_lever_are_those_of_monte_carlo():
    given_ = {"mass": (47.4, 0.05), "reading": (30.12, 0.03), "rope": (1.6, 5e-4), "support": (0.031, 5e-4)}
    found = cog_height(**{name: tagged(*pair, name) for name, pair in given_.items()})
    rng = np.random.default_rng(3)
    mass, reading, rope, support = (rng.normal(*pair, size=200_000) for pair in given_.values())
    drawn = rope + reading / mass * (support - rope)
    assert_allclose(found.std_dev, drawn.std(), rtol=0.007)  # 200 000 draws: 0.16 %


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('gross = "48.62 kg"', 'gross = "48.62"', "reading[1].gross`: a mass needs its unit"),
        ('gross = "48.62 kg"', 'gross = "-48.62 kg"', "must be positive"),
        ('gross = "48.62 kg"', 'gross = "1.02 kg"', "net mass must be positive"),
        ('gross = "48.62 kg"', "", "a mass is missing here"),
        ('resolution = "20 g"', 'resolution = "20 mm"', "balance.resolution`: 'mm' is a length, where a mass"),
        ('resolution = "20 g"', 'resolution = "0 g"', "must be positive"),
        ('relative_error = "0.05 %"', 'relative_error = "-0.05 %"', "not negative"),
        ("digit_error = 1", "digit_error = 0.5", "whole number"),
        ("digit_error = 1", "digit_eror = 1", "Did you mean digit_error?"),
        ('[[reading]]\ngross = "48.62 kg"\ntare = "1.22 kg"\n', "", "one table or more"),
        ("[balance]", "[ballance]", "Did you mean balance?"),
        ("digit_error = 1", "digit_error = 1\n[buoyancy]\napply = 1", "true or false"),
        ("digit_error = 1", "digit_error = 1\n[buoyancy]\napply = true", "a density is missing"),
        ('shown = "30.12 kg"', 'shown = "48 kg"', "the rope would have to push"),
        ('shown = "30.12 kg"', 'shown = "0 kg"', "must be positive"),
        ('support = "31 +/- 0.5 mm"', 'support = "1600 mm"', "no lever"),
        ('rope = "1600 +/- 0.5 mm"', 'rope = "1600 +/- 0.5 kg"', "'kg' is a mass, where a length"),
        ('support = "31 +/- 0.5 mm"', 'support = "31 mm"\ninclination = "60 deg"', "above 45 deg"),
        ('mass = "47.40 +/- 0.05 kg"', "", "article.mass"),
    ],
)
def test_bad_weighings_and_crane_tests_are_refused_in_words(old, new, words):
    text, reduce = (WEIGHING, weigh.reduce) if old in WEIGHING else (CRANE, weigh.reduce_cog)
    assert old in text
    with pytest.raises(BadInput) as refusal:
        reduce(fields(text.replace(old, new)))
    assert words in str(refusal.value)
