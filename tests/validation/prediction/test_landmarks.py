"""Landmarks: none is off where the model made the data, shifts of resonances go one way, derivatives are those of steps."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.effects.catalogue import Named
from validation.model.model import Added
from validation.prediction import landmarks as under_test
from validation.prediction.landmarks import Landmark
from validation.study import Study

F = np.arange(2.0, 80.0, 0.1)
CLAMPS = Named(family="connection-compliance", targets=("every", "beta"), values={"": 3e-4})


def write(folder, values):
    rows = np.ascontiguousarray(values).view(float)
    np.savetxt(
        folder / "data.csv", np.column_stack([F, rows]), delimiter=",", header="f,r1,i1,r2,i2,r3,i3", comments="", fmt="%.9g"
    )


@pytest.fixture(scope="module")
def study(tmp_path_factory, three_floors):
    """Of functions that the model itself made, with noise of half a per cent of the level of each."""
    folder = tmp_path_factory.mktemp("frame")
    (folder / "model.toml").write_text(three_floors(struck=True))
    write(folder, np.ones((len(F), 3), dtype=complex))
    (made,) = Study.open(folder / "model.toml", ()).tests
    exact = made.at({}, derivatives=False).rows[0, :, :, 0]
    rng = np.random.default_rng(5)
    write(folder, exact * (1 + 0.005 * (rng.standard_normal(exact.shape) + 1j * rng.standard_normal(exact.shape))))
    return Study.open(folder / "model.toml", ())


def test_of_the_model_that_made_the_data_no_landmark_is_off(study):
    marks = Landmark.of_tests(study.tests)
    assert {one.kind for one in marks} == {"level", "frequency", "shape"}
    for one in marks:
        left, _ = one.at({}, ())
        assert np.sum(left**2) < 0.5 * one.number  # the part of the axis beyond the band is not there


def test_clamps_that_yield_move_all_frequencies_one_way_and_twice_as_much_moves_them_farther(study):
    marks = Landmark.of_tests(study.tests)
    sums = []
    for size in (0.0, 1e-4, 3e-4, 1e-3, 3e-3):
        effect = Added(named=replace(CLAMPS, values={"": size}), fixed=True)
        sums.append(sum(float(np.sum(one.at({}, (effect,))[0] ** 2)) for one in marks))
    assert np.all(np.diff(sums) > 0)  # the sum of squares has one minimum, though resonances are passed on the way


def test_derivatives_by_tolerances_are_those_of_small_steps(study):
    step = 1e-5
    for mark in Landmark.of_tests(study.tests):
        for name in ("modulus:legs-1", "accelerometer-gain:floor-2-x"):
            left, moved = mark.at({}, (), derivatives=(name,))
            there, _ = mark.at({name: step}, ())
            assert (name in moved) == (mark.kind != "frequency" or name.startswith("modulus"))
            if name in moved:
                # of a shape the part along it is left out, Kaufman
                assert_allclose(moved[name], (there - left) / step, atol=0.03 * np.abs(moved[name]).max() + 1e-3)


def test_what_is_off_by_what_a_sound_model_may_be_counts_one(study):
    frequency = next(one for one in Landmark.of_tests(study.tests) if one.kind == "frequency")
    softer = 2 * under_test.SOUND_FREQUENCY  # of the stiffness: half of that of a frequency
    left, _ = frequency.at({f"modulus:legs-{k}": -softer for k in (1, 2, 3)}, ())
    assert_allclose(left, -1.0, atol=0.2)
