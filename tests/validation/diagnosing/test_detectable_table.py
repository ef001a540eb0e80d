"""Smallest sizes for people: grouped as the catalogue is, in units of a laboratory."""

import pytest

from validation.diagnose.diagnosis import Detectable
from validation.effects.practical_units import said
from validation.report.diagnose import grid, rows

FOUND = (
    Detectable(id="force-gain:fmd-z2", size=0.0149, unit="1"),
    Detectable(id="point-mass:hub-1", size=0.44, unit="kg"),
    Detectable(id="force-gain:fmd-x12", size=0.011, unit="1"),
    Detectable(id="accelerometer-delay:cover-z1", size=95e-6, unit="s"),
    Detectable(id="accelerometer-delay:cover-z2", size=96e-6, unit="s"),
    Detectable(id="appendage:z", size=0.0101, unit="kg", at="21 Hz"),
    Detectable(id="rigid-inertia:m", size=0.44, unit="kg"),
    Detectable(id="rigid-inertia:mx", size=0.012, unit="kg m"),
    Detectable(id="accelerometer-position:cover-z3:x", size=0.0025, unit="m"),
    Detectable(id="accelerometer-misalignment:cover-z3:x", size=0.0087, unit="rad"),
)


def test_families_stand_in_the_order_of_the_catalogue_and_units_apart() -> None:
    assert [(one.family, one.unit) for one in rows(FOUND)] == [
        ("point-mass", "kg"),
        ("rigid-inertia", "kg"),
        ("rigid-inertia", "kg m"),
        ("appendage", "kg"),
        ("force-gain", "1"),
        ("accelerometer-delay", "s"),
        ("accelerometer-position", "m"),
        ("accelerometer-misalignment", "rad"),
    ]


def test_sizes_are_said_as_a_laboratory_says_them() -> None:
    text = {one.family: one.text for one in rows(FOUND)}
    assert text["force-gain"] == "1.1 % to 1.5 %"
    assert text["accelerometer-delay"] == "95 µs"
    assert text["accelerometer-position"] == "2.5 mm"
    assert text["accelerometer-misalignment"] == "0.50°"
    assert text["appendage"] == "10 g"


def test_the_most_and_the_least_telling_target_are_named() -> None:
    by_family = {one.family: one for one in rows(FOUND)}
    assert (by_family["force-gain"].best, by_family["force-gain"].worst) == ("fmd-x12", "fmd-z2")
    assert by_family["accelerometer-delay"].worst == ""
    assert by_family["appendage"].best == "z, at 21 Hz"


def test_every_size_finds_its_row() -> None:
    assert sum(one.count for one in rows(FOUND)) == len(FOUND)
    headings = {one.side for one in rows(FOUND)}
    assert len(grid(FOUND).lines) == len(rows(FOUND)) + len(headings)
    assert [line[0] for line in grid(FOUND).lines if line[0] in headings] == ["structure", "force side", "acceleration side"]


@pytest.mark.parametrize(
    ("value", "unit", "text"),
    [
        (0.9999, "kg", "1.0 kg"),
        (0.0996, "kg", "100 g"),
        (-0.0121, "m", "-12 mm"),
        (2e-6, "m/N", "2.0 µm/N"),
        (0.0, "s", "0 µs"),
        (3.0, "furlong", "3.0 furlong"),
    ],
)
def test_figures_keep_two_digits_and_no_zeros_in_front(value: float, unit: str, text: str) -> None:
    assert said(value, unit) == text
