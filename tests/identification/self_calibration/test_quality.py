"""Intervals, shares and verdicts: the same in every frame, and in plain words where elasticity spoils a rigid fit."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.inertia import PARAMETERS
from identification import request
from identification.plain import plain
from identification.quality import impossible, quality
from identification.request import Fact, Identified
from identification.self_calibration.fit import calibrated


def some(lab, spread: float) -> Identified:
    rng = np.random.default_rng(0)
    root = spread * rng.standard_normal((10, 10)) * np.array([1, *3 * [0.3], *6 * [0.1]])[:, None]
    covariance = root @ root.T
    noise = 0.25 * covariance
    return Identified(
        way="plain",
        inertia=lab.ARTICLE,
        covariance=covariance,
        band=(4.0, 32.0),
        shares={"noise": np.full(10, 0.25), "force-gain": np.full(10, 0.75)},
        parts={"noise": noise, "force-gain": covariance - noise},
    )


@pytest.mark.proof  # many draws
def test_the_covariance_of_mass_cog_and_moments_is_that_of_draws(lab):
    found = some(lab, 1e-3)
    rng = np.random.default_rng(1)
    draws = rng.multivariate_normal(found.inertia.parameters, found.covariance, size=20_000)
    sampled = np.cov(np.array([request.quantities(row) for row in draws]).T)
    deviation = np.sqrt(np.diag(quality(found).covariance))
    assert_allclose(np.sqrt(np.diag(sampled)), deviation, rtol=0.03)  # 0.5 % is one standard error


def test_moments_about_the_cog_and_their_intervals_do_not_depend_on_the_origin(lab):
    found = some(lab, 1e-3)
    here, there = quality(found), quality(found, Pose(position=[0.1, -0.2, 0.3]))
    assert_allclose(there.values[4:], here.values[4:], atol=1e-12)
    assert_allclose(there.intervals[4:], here.intervals[4:], atol=1e-9)
    assert_allclose(there.values[1:4], here.values[1:4] - [0.1, -0.2, 0.3], atol=1e-12)


def test_a_quarter_turn_swaps_the_intervals_of_x_and_y(lab):
    found = some(lab, 1e-3)
    here, turned = quality(found), quality(found, Pose(rotation=rotation_about("z", np.pi / 2)))
    width = np.diff(here.intervals, axis=1)[:, 0]
    assert_allclose(np.diff(turned.intervals, axis=1)[[0, 2, 1, 3, 5, 4, 6], 0], width[[0, 1, 2, 3, 4, 5, 6]], rtol=1e-9)


def test_a_verdict_names_what_dominates_and_what_to_add(lab):
    narrow, wide = quality(some(lab, 1e-4)), quality(some(lab, 3.0))
    assert set(narrow.verdict) == {*PARAMETERS, *request.QUANTITIES}
    assert all(text.startswith("trustworthy") and "force-gain (75 %" in text for text in narrow.verdict.values())
    assert wide.verdict["mass_kg"].startswith("not identifiable")
    assert "weigh the article" in wide.verdict["mass_kg"]


def test_where_the_block_bootstrap_spreads_wider_the_verdict_follows_it(lab):
    found = some(lab, 1e-4)
    agreed = quality(replace(found, resampled=1.2**2 * found.covariance))
    assert_allclose(list(agreed.bootstrap.values()), 1.2, rtol=1e-12)
    assert agreed.verdict == quality(found).verdict
    wider = quality(replace(found, resampled=3.0**2 * found.covariance)).verdict["mass_kg"]
    assert "the block bootstrap, 3 times" in wider
    far = quality(replace(found, resampled=3e4**2 * found.covariance)).verdict["mass_kg"]
    assert far.startswith("not identifiable")


def test_a_model_that_does_not_hold_is_never_trustworthy(lab):
    found = some(lab, 1e-4)
    assert quality(replace(found, misfit=2.0)).verdict == quality(found).verdict
    assert all(said.startswith("not identifiable") for said in quality(replace(found, misfit=93.0)).verdict.values())


def test_moments_that_no_body_has_are_impossible_only_beyond_their_intervals(lab):
    flat = lab.ARTICLE.parameters.copy()
    flat[6] = flat[4] + flat[5] + 1.0
    sure = replace(some(lab, 1e-4), inertia=type(lab.ARTICLE)(parameters=flat))
    assert impossible(quality(sure))
    assert not impossible(quality(replace(sure, covariance=100 * np.eye(10))))
    assert not impossible(quality(some(lab, 1e-4)))


@pytest.mark.parametrize("way", [plain, pytest.param(calibrated, marks=pytest.mark.proof)])
def test_a_rigid_fit_of_an_elastic_structure_is_flagged_and_of_a_rigid_one_is_not(ordinary, lab, way):
    low = replace(ordinary, frequency=np.arange(4.0, 8.01, 0.1))
    flagged = quality(way(low.evidence(terms=lab.MODES), low.settings(modes=0)))
    assert flagged.verdict["Iyy"].startswith("dominated by elasticity")
    assert "fit elastic terms" in flagged.verdict["Iyy"]
    rigid = quality(way(low.evidence(), low.settings(modes=0)))
    assert not any("elasticity" in text for text in rigid.verdict.values())


def test_facts_are_checked_by_name(ordinary):
    for fact in (Fact(quantity="weight", value=1.0, sd=1.0), Fact(quantity="mass_kg", value=1.0, sd=0.0)):
        with pytest.raises(BadInput):
            request.require_known((fact,))


def test_the_derivative_of_mass_cog_and_moments_is_exact(lab):
    at, step = lab.ARTICLE.parameters, 1e-6
    numeric = [(request.quantities(at + step * e) - request.quantities(at - step * e)) / (2 * step) for e in np.eye(10)]
    assert_allclose(request.jacobian(at), np.transpose(numeric), atol=1e-7)
