"""How the plain estimate answers to errors of its channels, against the estimate from channels that have them."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.sensors import Tolerances
from identification.plain import sensitivity, setup


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
    predicted = sensitivity(spectra, found, nominal.chain).chain @ error
    assert_allclose(moved, predicted, atol=1e-3 * np.abs(predicted).max() + 1e-9)


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
    stated = sensitivity(noisy, setup(noisy, settings), loud[0].chain).noise
    assert_allclose(np.std(ten, axis=0), np.sqrt(np.diag(stated)), rtol=0.5)  # forty draws tell a deviation to 11 %
