"""Noise of functions that come without coherence: told by the lines beside each, and whether it goes with what is read."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from identification.spectra import noise

KINDS = ("goes with the reading", "is the same at all lines", "has both in equal parts")


def tower(seed: int, kind: str, step: float, size: float) -> tuple[Array, ComplexArray, Array]:
    """Frequencies [Hz], accelerances (1, n, 3) of three storeys and the deviation (1, n, 3) of their noise; the sharpest peak is
    0.07 Hz wide, the highest 25 times the ordinary line."""
    rng, f = np.random.default_rng(seed), np.arange(1.5, 18, step)
    K = 4200.0 * np.array([[2, -1, 0], [-1, 2, -1], [0, -1, 1]]) * (1 + 0.01 * rng.standard_normal())
    exact = np.array([-(w**2) * np.linalg.inv(K * (1 + 0.02j) - w**2 * 1.83 * np.eye(3))[:, 2] for w in 2 * np.pi * f])
    share, level = size * np.abs(exact), size * np.median(np.abs(exact), axis=0) + 0 * np.abs(exact)
    sd = dict(zip(KINDS, (share, level, np.hypot(share, level)), strict=True))[kind]
    unit = (rng.standard_normal(exact.shape) + 1j * rng.standard_normal(exact.shape)) / np.sqrt(2)
    return f, (exact + sd * unit)[None], sd[None]


def resonance(seed: int, sd: float) -> tuple[Array, ComplexArray, ComplexArray]:
    """Frequencies (n,) [Hz], one narrow peak of 250 and two runs of it in noise of one level; most lines read little else."""
    rng, f = np.random.default_rng(seed), 0.02 * np.arange(1, 3000)
    smooth = -(f**2) / (30.0**2 - f**2 + 2j * 0.002 * 30.0 * f)
    return f, smooth, smooth + sd * (rng.standard_normal((2, len(f))) + 1j * rng.standard_normal((2, len(f)))) / np.sqrt(2)


@pytest.mark.parametrize("step", [0.01, 0.025])
@pytest.mark.parametrize(("kind", "low", "high"), [(KINDS[0], 0.6, 1.0), (KINDS[1], 0.0, 0.0), (KINDS[2], 0.4, 1.0)])
def test_noise_that_goes_with_the_reading_is_told_from_noise_that_does_not(kind, low, high, step, monkeypatch):
    """A median over neighbours made it a tenth of what it is at the peaks: one in ten sound towers was called unknown."""
    told, ask = list[float](), noise.share_with_reading
    monkeypatch.setattr(noise, "share_with_reading", lambda *given: told.append(ask(*given)) or told[-1])
    off, worst = list[float](), list[float]()
    for seed in range(6):
        f, values, sd = tower(seed, kind, step, 0.004)
        ratio = np.square(sd / noise.between_neighbours(f, values))
        off.append(float(ratio.mean()))
        worst.append(float(ratio.max()))
    assert low <= min(told) <= max(told) <= high
    assert 0.65 < np.mean(off) < 1.05  # what a sum of squares comes out as; 2.0 to 2.6 of the first kind by a median alone
    assert np.mean(worst) < 3  # of no line is it taken for much less than it is; 90 and more at the peaks by a median alone


def test_noise_is_found_from_the_scatter_of_lines_beside_a_resonance():
    f, _, values = resonance(1, sd := 0.03)
    found = noise.between_neighbours(f, values[:, :, None])
    assert_allclose(np.median(found), sd, rtol=0.03)
    away = np.abs(f - 30.0) > 2.0
    assert_allclose(np.quantile(found[:, away], [0.05, 0.95]), sd, rtol=0.4)  # a median of 101 lines scatters by a sixth
    assert 0.5 * sd < found[:, ~away].min() < found[:, ~away].max() < 3 * sd  # skirts of a peak of 250 bend
    assert_allclose(noise.between_neighbours(f, 7 * values[:, :, None]), 7 * found, rtol=1e-12)


def test_lines_that_read_little_but_noise_and_those_that_two_modes_share_tell_no_share_of_the_reading():
    """What is loud there is loud by its noise; and a fit of one mode leaves more than noise where there are two."""
    for seed in range(4):
        f, smooth, values = resonance(seed, 0.03)
        assert np.abs(noise.between_neighbours(f, values[:, :, None])).max() < 0.09
        two = values + 0.7 * np.interp(f + 0.1, f, smooth.real) + 0.7j * np.interp(f + 0.1, f, smooth.imag)
        assert np.abs(noise.between_neighbours(f, two[:, :, None])).max() < 0.3


def test_of_many_functions_evenly_spread_lines_tell_as_much_as_all(monkeypatch):
    f, values, _ = tower(1, KINDS[0], 0.01, 0.004)
    all_of_them = noise.between_neighbours(f, values)
    monkeypatch.setattr(noise, "AT_MOST", values.size // 4)
    assert_allclose(noise.between_neighbours(f, values), all_of_them, rtol=0.25)


def test_few_lines_and_functions_of_nothing_tell_no_share():
    f, values, _ = tower(1, KINDS[0], 0.1, 0.004)
    assert np.all(np.isfinite(noise.between_neighbours(f[:21], values[:, :21])))
    assert not noise.between_neighbours(f, 0 * values).any()
    assert np.all(np.isfinite(noise.between_neighbours(f, np.round(values, -1))))  # most lines read the same, and have no noise


def test_the_noise_of_lines_at_the_ends_is_told_by_as_many_lines_as_that_of_any_other():
    rng, f, sd = np.random.default_rng(3), 0.2 * np.arange(1, 40), 0.03
    values = sd * (rng.standard_normal((400, len(f))) + 1j * rng.standard_normal((400, len(f)))) / np.sqrt(2)
    found = noise.between_neighbours(f, values[:, :, None])[..., 0]
    scatter = np.log(found).std(axis=0)
    assert_allclose(scatter[[0, 1, -2, -1]], scatter[len(f) // 2], rtol=0.25)  # 1.7 times as much where an end was repeated


def test_lines_that_lie_too_far_apart_to_tell_noise_are_refused():
    with pytest.raises(ValueError, match="7 lines within"):
        noise.between_neighbours(np.arange(5.0), np.ones((1, 5, 1)))
