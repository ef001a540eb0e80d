"""What a channel that is not linear reads of a sine: describing functions against sines in time, and against virtual tests."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.sensors import resultants
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import CHANNEL_STAGE
from validation.effects.families.gap import clipped
from validation.effects.stages import ChannelResponse
from validation.virtual_test.plan import Plan, exact
from validation.virtual_test.simulate import laboratory

POINTS = 4096
"""Of one period: the corner of a clipped sine leaves (1 / POINTS)² in its fundamental."""

CELLS = ("fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4")


def fundamental(signal: np.ndarray) -> complex:
    """Of one period, over that of a unit sine."""
    return complex(np.fft.rfft(signal)[1] / (-0.5j * len(signal)))


def sine() -> np.ndarray:
    return np.sin(2 * np.pi * np.arange(POINTS) / POINTS)


def reading(amplitude: list[float], channels: tuple[str, ...] = CELLS, peak: float | None = None) -> ChannelResponse:
    n, c = len(amplitude), len(channels)
    return ChannelResponse(
        frequency=np.linspace(5.0, 6.0, n),
        channels=channels,
        rows=np.ones((n, c, 6), dtype=np.complex128),
        amplitude=np.tile(np.array(amplitude)[:, None], (1, c)),
        peak=np.zeros(0) if peak is None else np.full(c, peak),
    )


def read(effect: str, stage: ChannelResponse) -> np.ndarray:
    named = parse(effect)
    changed: ChannelResponse = FAMILIES[named.family].change(stage, named.targets, named.values)
    return changed.rows[:, :, 0]


@pytest.mark.parametrize("share", [0.05, -0.2, 0.3])
def test_the_cubic_term_takes_three_quarters_of_itself_from_the_fundamental(share):
    amplitudes = [1.0, 2.5, 4.0]
    found = read(f"saturation:fmd-z2={share}", reading(amplitudes, peak=4.0))
    in_time = [fundamental(a * sine() * (1 - share * (a * sine() / 4.0) ** 2)) / a for a in amplitudes]
    assert_allclose(found[:, 1], in_time, rtol=1e-12)
    assert_allclose(np.delete(found, 1, axis=1), 1.0)


def test_at_half_the_level_a_quarter_of_the_loss_is_left_and_the_loudest_line_is_the_peak_where_none_is_stated():
    whole, half = (read("saturation:fmd-z1=0.1", reading([level], peak=1.0))[0, 0] for level in (1.0, 0.5))
    assert (1 - half) / (1 - whole) == pytest.approx(0.25, rel=1e-12)
    stated, found = (read("saturation:fmd-z1=0.1", reading([1.0, 3.0], peak=peak)) for peak in (3.0, None))
    assert_allclose(found, stated)


@pytest.mark.parametrize("preload", [0.1, 0.5, 0.99, 1.0, 3.0])
def test_a_sine_cut_off_on_one_side_keeps_the_share_of_its_describing_function(preload):
    in_time = fundamental(np.maximum(sine(), -preload))
    assert_allclose(clipped(preload, np.array([1.0])), in_time, rtol=0, atol=4 / POINTS**2)


def test_a_cell_that_pulls_never_keeps_half_and_one_under_load_keeps_all():
    assert_allclose(clipped(0.0, np.array([1.0, 7.0])), 0.5, rtol=1e-15)
    assert_allclose(clipped(8.0, np.array([1.0, 7.0, 0.0])), 1.0, rtol=1e-15)


@pytest.mark.parametrize("cell", ["1", "2", "3", "4"])
def test_what_a_lifted_cell_lacks_goes_to_the_others_without_a_trace_in_the_resultants(cell, layout):
    channels = [layout.table.channels[layout.table.names.index(name)] for name in CELLS]
    shift = read(f"gap:{cell}=2", reading([5.0]))[0] - 1.0
    assert shift[int(cell) - 1] == pytest.approx(clipped(2.0, np.array([5.0]))[0] - 1, rel=1e-12)
    assert_allclose(resultants(channels, layout.table.origin) @ shift, 0.0, atol=1e-14)


@pytest.fixture(scope="module")
def layout():
    return laboratory(exact(Plan(article="fmd+cuboid"))).layout


@pytest.mark.parametrize("effect", ["saturation:fmd-z1=0.05", "gap:2=500"])
def test_a_run_that_states_no_amplitude_is_taken_for_linear(effect):
    quiet = ChannelResponse(frequency=np.array([5.0]), channels=CELLS, rows=np.ones((1, 4, 6), complex))
    assert_allclose(read(effect, quiet), 1.0)
    assert FAMILIES[effect.partition(":")[0]].stage == CHANNEL_STAGE
