"""What is gathered of an identification: the rigid body behind a dynamic mass, residuals, intervals, the band study."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry import routes
from geometry.articles import built_in
from geometry.dynamic_mass import DynamicMass
from geometry.errors import CheckFailed
from geometry.frames import Pose, rotation_about
from geometry.inertia import PARAMETERS, Inertia
from identification.elastic.fit import fit
from identification.elastic.model import dynamic_mass
from identification.elastic.study import BandStudy, study
from identification.request import Identified
from validation.identify import identify
from validation.identify.identify import reported, residuals, rigid
from validation.reference.statement import about_cog


def test_the_rigid_body_behind_a_dynamic_mass_is_found_whatever_was_left_out(found):
    spoilt = found.dynamic_mass.matrix + 1e3 * (1 - found.lines.kept)[:, None, None]
    of = SimpleNamespace(
        estimate=SimpleNamespace(dynamic_mass=SimpleNamespace(frequency=found.lines.frequency, matrix=spoilt)),
        exclusions=SimpleNamespace(kept=found.lines.kept > 0),
    )
    assert_allclose(rigid(of, found.result.identified), found.rigid, atol=1e-9 * found.rigid.max())


def test_a_rigid_result_takes_no_elastic_terms_off(clumod):
    body = clumod.moved([0.1, -0.2, 0.3])
    of = SimpleNamespace(
        estimate=SimpleNamespace(
            dynamic_mass=SimpleNamespace(frequency=np.arange(3.0), matrix=np.tile(body.mass_matrix, (3, 1, 1)))
        ),
        exclusions=SimpleNamespace(kept=np.ones(3, dtype=bool)),
    )
    one = Identified(way="plain", inertia=body, covariance=np.zeros((10, 10)), band=(4, 32))
    assert_allclose(rigid(of, one), body.mass_matrix, atol=1e-12)


def test_residuals_are_shares_of_what_channels_of_a_kind_read(found):
    table = found.spectra.table
    names = tuple(table.names[k] for k in table.select(quantity="acceleration"))
    cells = tuple(table.names[k] for k in table.select(quantity="force"))
    values = np.ones((6, 141, len(table)))
    of = SimpleNamespace(
        motion=SimpleNamespace(channels=names, residual=np.full((6, 141, len(names)), 0.02j)),
        load=SimpleNamespace(channels=cells, parity=np.full((6, 141, 1), 0.1), combinations=np.ones((1, len(cells)))),
        article=SimpleNamespace(table=table, values=5 * values, frequency=found.spectra.frequency, runs=found.spectra.runs),
    )
    drawn = residuals(of)
    assert drawn.channels == (*names, *cells)
    assert_allclose(drawn.share[..., : len(names)], 0.004)
    assert_allclose(drawn.share[..., len(names) :], 0.02)


def test_an_article_on_its_mount_comes_back_in_its_own_frame(found, clumod):
    # What is lost is the rounding of moments about F, 30 times those about the CoG.
    assert_allclose(found.result.values, about_cog(clumod), rtol=1e-12, atol=1e-12)
    assert_allclose(about_cog(found.result.inertia), about_cog(clumod), rtol=1e-12, atol=1e-12)


def test_a_turned_mount_turns_the_tensor_back(clumod, terms):
    pose = Pose(position=np.array([0.1, -0.2, 0.05]), rotation=rotation_about("z", 0.7))
    there = Identified(way="plain", inertia=clumod.placed(pose), covariance=np.zeros((10, 10)), band=(4, 32))
    assert_allclose(reported(there, pose).values, about_cog(clumod), rtol=1e-10, atol=1e-10)


@pytest.mark.proof
def test_the_intervals_hold_95_per_cent_of_draws(found):
    one = found.result
    rng = np.random.default_rng(3)
    mean, C = one.identified.inertia.parameters, one.identified.covariance
    draws = rng.multivariate_normal(mean, C, size=4000)
    frame = Pose(position=np.array([0.0, 0.0, -0.045]))
    values = np.array([about_cog(Inertia(parameters=each).placed(frame)) for each in draws])
    low, high = one.quality.intervals.T
    inside = np.mean((values >= low) & (values <= high), axis=0)
    assert_allclose(inside, 0.95, atol=0.017)  # five standard deviations of 4000 draws


def test_the_largest_share_comes_first_and_a_result_without_positive_mass_has_no_cog(found):
    ordered = found.result.dominating(3)
    assert [share for _, share in ordered] == sorted((share for _, share in ordered), reverse=True)
    assert {name for name, _ in ordered} <= set(found.result.identified.shares)
    heavy = found.result.identified
    lost = replace(heavy, inertia=heavy.inertia.scaled(-1.0))
    with pytest.raises(CheckFailed, match="polarity"):
        reported(lost, Pose())


MOUNTED = Pose(position=np.array([0.0, 0.0, 0.045]))


@pytest.fixture(scope="module")
def of(clumod, terms) -> BandStudy:
    lines = np.linspace(4.0, 32.0, 281)
    M = (clumod.placed(MOUNTED) + routes.inertia(built_in("fmd"))).mass_matrix
    residual = np.diag([8e-6, 8e-6, 1e-5, 2e-6, 2e-6, 1e-7])
    slow = replace(terms, residual=residual, damping=np.diag(4 * np.pi * terms.frequency * 0.004))
    H = DynamicMass(frequency=lines, matrix=dynamic_mass(M, slow, lines))
    return study(H, fitted=fit(H, modes=3), starts=[4.0, 6.0], stops=[20.0, 32.0], counts=[3])


def _identification(article: Inertia, modes: int | None) -> SimpleNamespace:
    return SimpleNamespace(request=SimpleNamespace(modes=modes), plain=SimpleNamespace(inertia=article))


def test_on_exact_data_every_band_gives_the_article_in_its_own_frame(of, clumod):
    drawn = identify.maps(_identification(clumod.placed(MOUNTED), None), of, MOUNTED)
    assert list(drawn.maps) == ["3 elastic terms", "no elastic terms"]
    size = np.array([clumod.mass, 1, 1, 1, *6 * [clumod.moments_cog.max()]])
    # Every cell's fit ends when a step is 1e-4 of a standard deviation, which is a model error of 0.2 %.
    assert_allclose(drawn.maps["3 elastic terms"] / size, np.broadcast_to(about_cog(clumod) / size, (2, 2, 10)), atol=1e-6)
    assert_allclose(drawn.reference / size, about_cog(clumod) / size, atol=1e-6)


def test_without_elastic_terms_the_band_makes_the_result_and_a_verdict_says_when_narrower_ones_lead_elsewhere(of, clumod):
    rigid = identify.maps(_identification(clumod.placed(MOUNTED), 0), of, MOUNTED)
    assert list(rigid.maps) == ["no elastic terms"]
    moments = rigid.maps["no elastic terms"][..., 4]
    assert np.ptp(moments) > 0.1 * clumod.moments_cog[0]
    told = dict.fromkeys(PARAMETERS, "trustworthy")
    assert identify.verdicts(told, of, rigid=False) == told
    said = identify.verdicts(told, of, rigid=True)
    assert "narrower bands" in said["Ixx"]
    assert said["Ixx"].startswith("trustworthy")
    assert identify.verdicts(told, replace(of, cells=of.cells[:1]), rigid=False) == told


def test_the_rigid_way_is_tried_below_all_other_bands_and_the_elastic_one_is_not(of, clumod):
    lines = np.linspace(4.0, 32.0, 281)
    H = DynamicMass(frequency=lines, matrix=np.tile(clumod.mass_matrix + 0j, (281, 1, 1)))
    wide = study(H, fitted=of.fitted)
    rigid, elastic = np.moveaxis(np.isfinite(wide.map()[..., 0]), 2, 0)[:2]
    assert wide.stops[0] == pytest.approx(5.0)
    assert rigid[0].all()
    assert not elastic[:, :4].any()
    assert elastic[0, 4:].all()


def test_a_cell_knows_how_well_it_knows(of, clumod):
    """A narrow band knows less, and its interval is drawn in the frame of the result."""
    drawn = identify.maps(_identification(clumod.placed(MOUNTED), None), of, MOUNTED)
    half = drawn.half_widths["3 elastic terms"]
    assert half.shape == (2, 2, 10)
    assert np.all(half[1, 0] > half[0, 1])
    about_f = identify.maps(_identification(clumod.placed(MOUNTED), None), of, Pose()).half_widths["3 elastic terms"]
    assert_allclose(half[..., 4:], about_f[..., 4:], rtol=1e-6)  # moments about the CoG do not know the origin
    assert_allclose(half[..., 0], 1.96 * of.map("deviation")[:, :, 1, 0], rtol=1e-4)
