"""How an article stands and what it is beside its drawing: against the same moved by hand, effects, and differences."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import Pose, rotation_by
from validation.effects.catalogue import parse
from validation.model.model import Added, Model
from validation.model.tolerance_classes import MountingTolerances
from validation.prediction.dynamic_mass import ARTICLE, MOUNTING, BaseDrive, SupportedDynamicMass, mounting_parameters
from validation.prediction.series import SeriesPrediction, supported_dynamic_mass

KNOWN = MountingTolerances(place=1e-3, height=3e-4, turn=5e-3, tilt=1e-3, inertia=0.01)
FREQUENCY = np.array([5.0, 11.3, 30.0])


@pytest.fixture(scope="module")
def carried(ordinary, predicted, model) -> SupportedDynamicMass:
    (of,) = predicted(ordinary("fmd+clumod-1", "beam"))
    one: SeriesPrediction = of
    known: Model = model(mounting=KNOWN)
    return supported_dynamic_mass(known, one.tested.campaign, one.tested.carried.standing, "spring")


def dynamic_mass(of: SupportedDynamicMass, offsets: dict[str, float], effects: tuple[Added, ...] = ()) -> np.ndarray:
    return of.at(offsets, effects, FREQUENCY, BaseDrive(), derivatives=False)[0]


def test_the_article_stands_beside_its_place_and_turned(carried):
    """The same as an article whose drawing stands there; and a shift along x is the effect `mounting-offset`."""
    d, phi = np.array([0.8e-3, -1.1e-3, 0.2e-3]), np.array([1e-3, -2e-3, 6e-3])
    names = [f"{MOUNTING}:spring:{axis}" for axis in ("x", "y", "z", "alpha", "beta", "gamma")]
    assert [one.name for one in carried.mounted if one.family == MOUNTING] == names
    found = dynamic_mass(carried, dict(zip(names, [*d, *phi], strict=True)))
    pose = carried.standing.pose
    there = Pose(position=pose.position + d, rotation=rotation_by(phi) @ pose.rotation)
    moved = replace(carried, standing=replace(carried.standing, pose=there), mounted=())
    assert_allclose(found, dynamic_mass(moved, {}), rtol=0, atol=1e-12 * np.abs(found).max())
    shifted = dynamic_mass(carried, {}, (Added(named=parse("mounting-offset:x=0.0008")),))
    assert_allclose(dynamic_mass(carried, {names[0]: 8e-4}), shifted, rtol=0, atol=1e-12 * np.abs(found).max())


def test_the_ten_parameters_of_an_article_are_those_of_the_effect(carried):
    one = next(one for one in carried.mounted if one.name == f"{ARTICLE}:clumod-1:mz")
    by_effect = dynamic_mass(carried, {}, (Added(named=parse(f"rigid-inertia:mz={one.tolerance!r}")),))
    assert_allclose(dynamic_mass(carried, {one.name: one.tolerance}), by_effect, rtol=0, atol=1e-12 * np.abs(by_effect).max())


def test_every_derivative_is_the_limit_of_differences(carried):
    rng = np.random.default_rng(2)
    at = {one.name: one.tolerance * rng.standard_normal() for one in carried.mounted}
    _, slopes = carried.at(at, (), FREQUENCY, BaseDrive(), derivatives=True)
    for one in carried.mounted:
        h = 1e-3 * one.tolerance
        below, above = (dynamic_mass(carried, {**at, one.name: at[one.name] + side * h}) for side in (-1, 1))
        difference = (above - below) / (2 * h)
        assert_allclose(slopes[one.name], difference, rtol=0, atol=1e-6 * np.abs(difference).max(), err_msg=one.name)


def test_an_fmd_alone_is_mounted_nowhere(carried):
    assert mounting_parameters("spring", replace(carried.standing, matrices=None), KNOWN) == ()
    assert mounting_parameters("spring", carried.standing, MountingTolerances()) == ()
