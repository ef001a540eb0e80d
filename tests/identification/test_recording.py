"""Recordings cannot contradict themselves, and units are what they are by definition."""

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from geometry.errors import BadInput
from identification.campaign import Recording, factor, is_same, is_unit, named


@pytest.mark.parametrize(
    ("axis", "values", "words"),
    [
        ({}, np.zeros((3, 2)), "either"),
        ({"sampling_rate": 1.0, "frequency": np.arange(3.0)}, np.zeros((3, 2)), "either"),
        ({"sampling_rate": 0.0}, np.zeros((3, 2)), "positive"),
        ({"sampling_rate": np.nan}, np.zeros((3, 2)), "positive"),
        ({"sampling_rate": 1.0}, np.zeros((3, 3)), "shape"),
        ({"frequency": np.array([1.0, 1.0, 2.0])}, np.zeros((3, 2)), "ascending"),
        ({"frequency": np.array([-1.0, 1.0, 2.0])}, np.zeros((3, 2)), "ascending"),
        ({"frequency": np.arange(4.0)}, np.zeros((3, 2)), "3 ascending"),
    ],
)
def test_a_recording_that_contradicts_itself_is_refused(axis: dict[str, object], values: np.ndarray, words: str) -> None:
    with pytest.raises(ValueError, match=words):
        Recording(names=("a", "b"), values=values, **axis)  # type: ignore[arg-type]


def test_a_recording_is_a_copy_that_nobody_changes() -> None:
    samples = np.ones((4, 2))
    recorded = Recording(names=("a", "b"), values=samples, sampling_rate=2.0)
    samples[:] = 5
    assert_array_equal(recorded.channel("b"), np.ones(4))
    with pytest.raises(ValueError, match="read-only"):
        recorded.values[0, 0] = 3
    assert recorded.duration == 2.0
    assert_array_equal(recorded.time, [0, 0.5, 1, 1.5])
    with pytest.raises(BadInput, match="no such channel"):
        recorded.channel("c")


def test_spectra_have_no_time() -> None:
    spectra = Recording(names=("a",), values=np.ones((2, 1)), frequency=np.array([1.0, 2.0]))
    assert spectra.duration == 0
    with pytest.raises(ValueError, match="no time"):
        _ = spectra.time


@pytest.mark.parametrize(
    ("unit", "quantity", "size"),
    [
        ("g", "acceleration", 9.80665),  # standard gravity, CGPM 1901
        ("in/s^2", "acceleration", 0.0254),
        ("m/s²", "acceleration", 1.0),
        ("lbf", "force", 0.45359237 * 9.80665),  # the pound by its definition, times standard gravity
        ("kN", "force", 1000.0),
        ("lbf ft", "moment", 0.45359237 * 9.80665 * 0.3048),
        ("Nm", "moment", 1.0),
    ],
)
def test_units_are_what_they_are_by_definition(unit: str, quantity: str, size: float) -> None:
    assert_allclose(factor(unit, quantity, source="s", field="f"), size, rtol=1e-14)
    assert is_unit(unit)
    assert is_same(unit, named(size, quantity), quantity)


@pytest.mark.parametrize("unit", ["kg", "", None, 3, "G"])
def test_what_is_no_unit_is_refused(unit: object) -> None:
    with pytest.raises(BadInput, match=r"Known are m/s\^2, g"):
        factor(unit, "acceleration", source="s", field="f")


def test_a_factor_without_a_name_is_said_in_si() -> None:
    assert named(0.5, "force") == "0.5 N"
    assert not is_same("g", "N", "force")
