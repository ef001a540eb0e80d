"""Sizes as a laboratory says them."""

from __future__ import annotations

import pytest

from validation.effects import practical_units


@pytest.mark.parametrize(
    ("family", "key", "unit", "values", "expected"),
    [
        ("force-gain", "", "1", (0.0793, 0.0769, 0.0817), (("+7.93", "+7.69", "+8.17"), "%")),
        ("force-gain", "", "1", (-0.0793,), (("-7.93",), "%")),
        ("point-mass", "", "kg", (0.198, 0.190, 0.205), (("+198", "+190", "+205"), "g")),
        ("point-mass", "", "kg", (2.0,), (("+2.00",), "kg")),
        ("accelerometer-position", "", "m", (0.0195, 0.0188, 0.0202), (("+19.5", "+18.8", "+20.2"), "mm")),
        ("board-delay", "", "s", (1e-3, 0.98e-3, 1.02e-3), (("+1.000", "+0.980", "+1.020"), "ms")),
        ("force-delay", "", "s", (1e-4,), (("+100",), "µs")),
        ("cable", "", "N/m", (5012.0, 4900.0, 5100.0), (("5012", "4900", "5100"), "N/m")),
        ("joint-compliance", "", "rad/(N m)", (3.96e-6,), (("3.96",), "µrad/(N m)")),
        ("orientation", "", "rad", (0.05,), (("+2.86",), "°")),
        ("structural-damping", "", "1", (0.0103,), (("1.03",), "%")),
        ("load-path-shunt", "", "1", (0.04,), (("4.00",), "%")),
        ("fmd-compliance", "", "1", (10.0,), (("10.0",), "")),
        ("gravity", "", "1", (0.0,), (("0",), "")),
        ("appendage", "zeta", "1", (0.02,), (("0.0200",), "")),
        ("unit", "", "1", (0.0101972,), (("0.0102",), "")),
    ],
)
def test_sizes_stand_in_the_unit_and_with_the_digits_that_read_best(family, key, unit, values, expected) -> None:
    assert practical_units.written(family, key, unit, values) == expected


def test_an_interval_has_two_digits_of_its_width_whatever_its_size() -> None:
    texts, _ = practical_units.written("cable", "", "N/m", (5000.0, 4999.4, 5000.6))
    assert texts == ("5000.0", "4999.4", "5000.6")


def test_a_degree_follows_its_figure_at_once() -> None:
    assert practical_units.one("orientation", "", "rad", 0.05) == "+2.86°"
    assert practical_units.one("appendage", "f", "Hz", 21.0) == "21.0 Hz"
    assert practical_units.one("fmd-compliance", "", "1", 10.0) == "10.0"
