"""What is reported of ten parameters about F: the same body from wherever it is seen, and intervals that a draw confirms."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import CheckFailed
from geometry.frames import Pose, rotation_about
from geometry.inertia import Inertia
from identification.elastic.model import ElasticTerms
from identification.request import Identified
from validation.identify.identify import IdentificationFindings, reported
from validation.reference.statement import about_cog


def test_an_article_on_its_mount_comes_back_in_its_own_frame(found: IdentificationFindings, clumod: Inertia) -> None:
    # What is lost is the rounding of moments about F, 30 times those about the CoG.
    assert_allclose(found.result.values, about_cog(clumod), rtol=1e-12, atol=1e-12)
    assert_allclose(about_cog(found.result.inertia), about_cog(clumod), rtol=1e-12, atol=1e-12)


def test_a_turned_mount_turns_the_tensor_back(clumod: Inertia, terms: ElasticTerms) -> None:
    pose = Pose(position=np.array([0.1, -0.2, 0.05]), rotation=rotation_about("z", 0.7))
    there = Identified(way="plain", inertia=clumod.placed(pose), covariance=np.zeros((10, 10)), band=(4, 32))
    assert_allclose(reported(there, pose).values, about_cog(clumod), rtol=1e-10, atol=1e-10)


def test_the_intervals_hold_95_per_cent_of_draws(found: IdentificationFindings) -> None:
    one = found.result
    rng = np.random.default_rng(3)
    mean, C = one.identified.inertia.parameters, one.identified.covariance
    draws = rng.multivariate_normal(mean, C, size=4000)
    frame = Pose(position=np.array([0.0, 0.0, -0.045]))
    values = np.array([about_cog(Inertia(parameters=each).placed(frame)) for each in draws])
    low, high = one.quality.intervals.T
    inside = np.mean((values >= low) & (values <= high), axis=0)
    assert_allclose(inside, 0.95, atol=0.017)  # five standard deviations of 4000 draws


def test_a_result_without_positive_mass_has_no_cog(found: IdentificationFindings) -> None:
    heavy = found.result.identified
    lost = replace(heavy, inertia=heavy.inertia.scaled(-1.0))
    with pytest.raises(CheckFailed, match="polarity"):
        reported(lost, Pose())


def test_the_largest_share_comes_first(found: IdentificationFindings) -> None:
    ordered = found.result.dominating(3)
    assert [share for _, share in ordered] == sorted((share for _, share in ordered), reverse=True)
    assert {name for name, _ in ordered} <= set(found.result.identified.shares)
