"""The plain way of one set-up: noise of many runs, entries that do not fit, and the same from raw spectra."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.sensors import Tolerances
from identification.plain import setup


@pytest.fixture(scope="module")
def quiet(lab):
    return lab.Laboratory(rng=np.random.default_rng(5), tolerances=Tolerances().scaled(0.0), noise=0.0)


def many(lab, times: int, noise: float):
    """Six runs over and over, every time with other cross motion and other noise."""
    loud = lab.Laboratory(rng=np.random.default_rng(6), tolerances=Tolerances().scaled(0.0), noise=noise)
    parts = [loud.spectra(lab.CUBOID) for _ in range(times)]
    return replace(
        parts[0],
        values=np.concatenate([one.values for one in parts]),
        noise=np.concatenate([one.noise for one in parts]),
        quality=np.concatenate([one.quality for one in parts]),
        runs=tuple(f"{run}{k}" for k, one in enumerate(parts) for run in one.runs),
        axes=parts[0].axes * times,
    )


def test_noise_of_the_accelerometers_in_many_runs_is_corrected_and_said(lab, quiet):
    loud, settings = many(lab, 20, 60.0), quiet.settings(modes=0)
    true = (lab.FMD + lab.CUBOID).mass
    found, left = setup(loud, settings), setup(replace(loud, noise=np.zeros_like(loud.noise)), settings)
    assert any("corrected as errors in variables" in text for text in found.notes)
    assert left.notes == ()  # nobody knows what to correct
    assert abs(found.ten[0] / true - 1) < 0.3 * abs(left.ten[0] / true - 1)


def test_six_runs_leave_nothing_to_be_corrected(lab, quiet):
    assert setup(many(lab, 1, 20.0), quiet.settings(modes=0)).notes == ()


def test_raw_spectra_tell_the_same_ten(lab, quiet):
    found = setup(quiet.spectra(lab.CUBOID), quiet.settings(modes=0))
    # exact but for the softness of the cells, which both ways leave out
    assert_allclose(found.raw, found.ten, atol=1e-4 * found.ten.max())


def test_a_robust_fit_does_not_follow_lines_that_are_spoilt(lab, quiet):
    clean = quiet.spectra(lab.CUBOID)
    values = clean.values.copy()
    values[:, ::7, clean.table.names.index("fmd-z1")] *= 3.0
    spoilt, settings = replace(clean, values=values), quiet.settings(modes=0)
    true = setup(clean, settings).ten
    off = {robust: np.abs(setup(spoilt, replace(settings, robust=robust)).ten - true).max() for robust in (False, True)}
    assert off[True] < 0.3 * off[False]
