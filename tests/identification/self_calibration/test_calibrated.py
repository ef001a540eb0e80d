"""The joint estimator as a whole: exact on exact data, honest on noisy data, better than the plain way on a drawn chain."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.inertia import Inertia
from geometry.sensors import Tolerances
from identification.identify import fmd
from identification.plain import plain
from identification.request import Evidence, Fact, Known, TareSpectra, quantities
from identification.self_calibration.fit import calibrated


def off(found: Inertia, truth: Inertia) -> np.ndarray:
    """Relative error of the mass, error of the CoG [mm], relative error of the moments about it."""
    moments = found.moments_cog / truth.moments_cog - 1
    return np.concatenate([[found.mass / truth.mass - 1], 1e3 * (found.cog - truth.cog), moments])


BARS = np.array([1e-6, 1e-3, 1e-3, 1e-3, 1e-6, 1e-6, 1e-6])
"""On exact spectra of a rigid set-up."""


@pytest.mark.parametrize("way", [plain, calibrated])
@pytest.mark.parametrize("modes", [0, None])
def test_exact_spectra_of_a_rigid_set_up_give_the_exact_inertia(exact, lab, way, modes):
    found = way(exact.evidence(), exact.settings(modes=modes))
    assert np.all(np.abs(off(found.inertia, lab.ARTICLE)) < BARS)
    assert found.converged


def test_exact_spectra_of_an_elastic_set_up_give_the_exact_inertia(exact, lab):
    fine = replace(exact, frequency=np.arange(4.0, 32.01, 0.1))
    found = calibrated(fine.evidence(terms=lab.MODES), fine.settings())
    assert np.all(np.abs(off(found.inertia, lab.ARTICLE)) < 1e3 * BARS)  # 1e-3 is the bar for elastic set-ups
    near = np.abs(found.elastic.frequency[:, None] - lab.MODES.frequency).min(axis=0)
    assert_allclose(near, 0.0, atol=1e-3)


@pytest.fixture(scope="module")
def some(lab):
    """Both ways on two laboratories that differ in everything that is drawn."""
    return both_ways(lab, range(2))


@pytest.fixture(scope="module")
def many(lab, some):
    """The same on four."""
    return [*some, *both_ways(lab, range(2, 4))]


def both_ways(lab, seeds):
    found = []
    for seed in seeds:
        made = lab.Laboratory(rng=np.random.default_rng(100 + seed), tolerances=Tolerances()).drawn()
        evidence, settings = made.evidence(), made.settings(modes=0)
        found.append((plain(evidence, settings), calibrated(evidence, settings)))
    return found


@pytest.mark.proof
def test_self_calibration_is_nearer_to_the_truth_than_the_plain_way(many, lab):
    errors = np.array([[off(one.inertia, lab.ARTICLE) for one in pair] for pair in many])
    by_paper, joint = np.sqrt(np.mean(errors**2, axis=0))
    assert np.all(joint[1:4] < 0.5 * by_paper[1:4])  # the CoG, which the paper lost


@pytest.mark.proof
@pytest.mark.parametrize("which", [0, 1])
def test_the_stated_covariance_is_that_of_the_errors(many, lab, which):
    results = [pair[which] for pair in many]
    z = [np.linalg.solve(np.linalg.cholesky(one.covariance), one.inertia.parameters - lab.ARTICLE.parameters) for one in results]
    from scipy.stats import chi2

    total, count = float(np.sum(np.square(z))), np.size(z)
    # the floor of the likelihood stands for model error, of which these data have none: errors may be smaller than stated
    assert total < chi2.ppf(0.999, count)
    assert total > 0.3 * count


def test_shares_and_parts_add_up(some):
    for pair in some:
        for one in pair:
            assert_allclose(np.sum(list(one.shares.values()), axis=0), 1.0, rtol=1e-9)
            assert_allclose(np.sum(list(one.parts.values()), axis=0), one.covariance, atol=1e-9 * np.abs(one.covariance).max())


@pytest.fixture(scope="module")
def evidence(ordinary):
    """One measurement of the ordinary laboratory, with noise as drawn once."""
    return ordinary.evidence()


@pytest.fixture(scope="module")
def joint(ordinary, evidence):
    """What it says by itself."""
    return calibrated(evidence, ordinary.settings(modes=0))


@pytest.fixture(scope="module")
def untared(ordinary, evidence):
    """And without its tare."""
    return calibrated(replace(evidence, tares=()), ordinary.settings(modes=0))


def test_weighing_adds_its_information_to_that_of_the_sweeps(ordinary, evidence, joint):
    settings, alone = ordinary.settings(modes=0), joint
    weighed = calibrated(replace(evidence, facts=(Fact(quantity="mass_kg", value=33.0, sd=0.01, source="scale"),)), settings)
    before, after = alone.covariance[0, 0], weighed.covariance[0, 0]
    assert_allclose(1 / after, 1 / before + 1 / 0.01**2, rtol=2e-2)  # Gaussian update; the fit is linearised at another place
    assert_allclose(weighed.gained["mass_kg of scale"][0], np.sqrt(before / after), rtol=2e-2)
    # it moves the mass by the gain of that update
    moved = after / 0.01**2 * (33.0 - alone.inertia.mass)
    assert_allclose(weighed.inertia.mass - alone.inertia.mass, moved, atol=0.05 * np.sqrt(after))


def test_a_fact_about_the_article_needs_something_that_tells_the_fmd_from_it(ordinary):
    evidence = Evidence(article=ordinary.evidence().article, facts=(Fact(quantity="mass_kg", value=33.0, sd=0.1),))
    with pytest.raises(BadInput, match="tells the FMD from the article"):
        calibrated(evidence, ordinary.settings(modes=0))


def test_without_a_tare_the_result_includes_the_fmd_and_says_so(ordinary, evidence, untared, lab):
    for found in (plain(Evidence(article=evidence.article), ordinary.settings(modes=0)), untared):
        assert any("includes the moving part of the FMD" in text for text in found.warnings)
        away = found.inertia.parameters - (lab.ARTICLE + lab.FMD).parameters
        assert np.all(np.abs(away) < 5 * np.sqrt(np.diag(found.covariance)))


def test_a_bare_fmd_and_several_tares_serve_as_well(ordinary, evidence, joint, lab):
    bare = TareSpectra(spectra=ordinary.spectra(lab.NOTHING), known=Known.nothing(), hardware="a", name="bare")
    settings = ordinary.settings(modes=0)
    widths = {}
    more = {
        name: calibrated(replace(evidence, tares=tares), settings)
        for name, tares in (("bare", (bare,)), ("both", (*evidence.tares, bare)))
    }
    for name, found in {"cuboid": joint, **more}.items():
        sd = np.sqrt(np.diag(found.covariance))
        assert np.all(np.abs(found.inertia.parameters - lab.ARTICLE.parameters) < 5 * sd)
        widths[name] = sd[0]
    assert widths["both"] < 0.9 * min(widths["cuboid"], widths["bare"])  # two masses calibrate the gains


def test_other_hardware_is_refused_unless_asked_for_and_tells_nothing_then(ordinary, evidence, untared):
    evidence = replace(evidence, hardware="b")
    settings = ordinary.settings(modes=0)
    for way in (plain, calibrated):
        with pytest.raises(BadInput, match="hardware"):
            way(evidence, settings)
    allowed = calibrated(evidence, replace(settings, any_hardware=True))
    alone = untared
    assert any("neither sensor errors" in text for text in allowed.warnings)
    assert_allclose(allowed.inertia.parameters, alone.inertia.parameters, atol=0.05 * np.sqrt(alone.covariance[0, 0]))


@pytest.mark.parametrize("self_calibrated", [True, False])
def test_the_fmd_from_a_tare_is_that_of_the_tare(ordinary, lab, self_calibrated):
    found = fmd(ordinary.evidence().tares, ordinary.settings(modes=0), self_calibrated=self_calibrated)
    away = found.inertia.parameters - lab.FMD.parameters
    assert np.all(np.abs(away) < 5 * np.sqrt(np.diag(found.covariance)))


def test_the_fmd_needs_a_tare_of_one_hardware(ordinary):
    with pytest.raises(BadInput, match="known article"):
        fmd((), ordinary.settings())
    one = ordinary.evidence().tares[0]
    with pytest.raises(BadInput, match="one FMD"):
        fmd((one, replace(one, hardware="b")), ordinary.settings())


def test_a_plain_tare_carried_over_gives_the_plain_result(ordinary):
    evidence, settings = ordinary.evidence(), ordinary.settings(modes=0)
    carried = replace(evidence, tares=(), fmd=fmd(evidence.tares, settings, self_calibrated=False))
    at_once, later = plain(evidence, settings), plain(carried, settings)
    assert_allclose(later.inertia.parameters, at_once.inertia.parameters, rtol=1e-12)
    # carried with its covariance alone, errors of the chain no longer cancel between tare and article
    assert later.covariance[0, 0] > at_once.covariance[0, 0]


def test_the_paper_s_quantities_follow_from_the_ten(lab):
    body = lab.ARTICLE
    expected = [body.mass, *body.cog, *body.moments_cog, *body.products_cog]
    assert_allclose(quantities(body.parameters), expected, rtol=1e-12)
