"""Noise of spectra without a quiet part: sensors that are off do not count as noise, and noise comes out as it went in."""

from dataclasses import replace

import numpy as np
from numpy.testing import assert_allclose

from identification.spectra.noise import of_redundancy

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
