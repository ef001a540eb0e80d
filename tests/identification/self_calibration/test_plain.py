"""The plain way of one set-up, and how it answers to errors of its channels."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.sensors import Tolerances
from identification.plain import sensitivity, setup
from identification.spectra.noise import of_redundancy


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


@pytest.mark.parametrize(
    "name",
    [
        "force-gain:fmd-z1",
        "accelerometer-gain:cover-x1",
        "accelerometer-position:cover-z3:x",
        "accelerometer-misalignment:cover-y2:z",
        "cell-stiffness:1x",
        "force-crosstalk:xy",
    ],
)
def test_a_small_error_of_a_channel_moves_the_plain_estimate_as_predicted(lab, name):
    def made(theta: np.ndarray | None):
        same = lab.Laboratory(rng=np.random.default_rng(9), tolerances=Tolerances(), noise=0.0, theta=theta)
        return same, same.spectra(lab.CUBOID)

    nominal, spectra = made(None)
    names = [one.name for one in nominal.chain.parameters]
    error = 1e-5 * np.eye(len(names))[names.index(name)]
    settings = nominal.settings(modes=0)
    found = setup(spectra, settings)
    moved = setup(made(error)[1], settings).ten - found.ten
    predicted = sensitivity(spectra, found, nominal.chain)[0] @ error
    assert_allclose(moved, predicted, atol=1e-3 * np.abs(predicted).max() + 1e-9)


@pytest.mark.proof  # many drawn campaigns
def test_the_noise_of_the_plain_estimate_is_that_of_repeated_campaigns(lab):
    settings = lab.Laboratory(rng=np.random.default_rng(0), tolerances=Tolerances()).settings(modes=0)
    loud = [lab.Laboratory(rng=np.random.default_rng(7), tolerances=Tolerances(), noise=0.0)]
    clean = loud[0].spectra(lab.CUBOID)
    rng = np.random.default_rng(3)
    sd = 1e-3 * np.abs(clean.values).max(axis=(0, 1)) * np.ones(clean.values.shape)
    ten = []
    for _ in range(40):
        noise = sd * (rng.standard_normal(sd.shape) + 1j * rng.standard_normal(sd.shape)) / np.sqrt(2)
        ten.append(setup(replace(clean, values=clean.values + noise, noise=sd), settings).ten)
    noisy = replace(clean, noise=sd)
    stated = sensitivity(noisy, setup(noisy, settings), loud[0].chain)[1]
    assert_allclose(np.std(ten, axis=0), np.sqrt(np.diag(stated)), rtol=0.5)  # forty draws tell a deviation to 11 %


FINE = np.arange(4.0, 32.01, 0.05)


def test_the_noise_is_found_below_sensors_that_are_off(ordinary, lab):
    read = replace(ordinary, frequency=FINE).spectra(lab.ARTICLE, lab.MODES)
    found = of_redundancy(replace(read, noise=np.zeros_like(read.noise)), 9.81)
    # the median of 561 lines of two independent combinations: 4 %; six runs, the worst
    assert_allclose(found / read.noise, 1.0, atol=0.15)


def test_without_noise_hardly_any_is_found(ordinary, lab):
    read = replace(ordinary, frequency=FINE, noise=0.0).spectra(lab.ARTICLE, lab.MODES)
    found = of_redundancy(read, 9.81)
    assert np.all(found < 1e-3 * np.sqrt(np.mean(np.abs(read.values) ** 2, axis=(0, 1))).max())


def test_few_lines_and_lone_channels_tell_none(ordinary, lab):
    assert not of_redundancy(replace(ordinary, frequency=FINE[:10]).spectra(lab.CUBOID), 9.81).any()
    read = replace(ordinary, frequency=FINE).spectra(lab.CUBOID)
    lone = [k for k, name in enumerate(read.table.names) if name not in {"cover-z4", "cover-x2"}]
    few = replace(read, table=read.table.subset(lone), values=read.values[:, :, lone], noise=read.noise[:, :, lone])
    found = of_redundancy(few, 9.81)
    assert not found[:, :, list(few.table.select(quantity="acceleration"))].any()
    assert found[:, :, list(few.table.select(quantity="force"))].all()
    some = [k for k, name in enumerate(read.table.names) if not name.startswith("fmd-x")]  # cells that tell no six resultants
    few = replace(read, table=read.table.subset(some), values=read.values[:, :, some], noise=read.noise[:, :, some])
    found = of_redundancy(few, 9.81)
    assert found[:, :, list(few.table.select(quantity="acceleration"))].all()
    assert not found[:, :, list(few.table.select(quantity="force"))].any()
