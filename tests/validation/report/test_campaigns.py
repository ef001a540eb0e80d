"""What was identified is held against its drawing in one frame, or not at all."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry import routes
from geometry.articles import built_in
from geometry.frames import Pose, rotation_about
from validation.report import identify
from validation.report.parts import CampaignPart, Report

TURNED = Pose(position=np.array([0.01, -0.02, 0.1]), rotation=rotation_about("z", np.pi / 6))


def part(report: Report, mounting: Pose | None, cache: Path) -> CampaignPart:
    """Of the campaign with that `mounting`, the FMD taken off and the result seen from F."""
    known = report.campaigns[0]
    campaign = replace(known.campaign, mounting=mounting)
    found = replace(known.findings, article="cuboid", origin="F", request=replace(known.findings.request, campaign=campaign))
    with pytest.MonkeyPatch.context() as patch:
        patch.setenv("MASSLINE_CACHE", str(cache))
        patch.setattr(identify.identify, "identified", lambda asked, **how: found)
        patch.setattr(identify, "sensor_map", lambda one, missing: None)
        return identify.campaign_part(campaign, [campaign], report.model, None, "full-record")


def test_a_result_from_f_is_held_against_the_drawing_where_it_stands_and_not_where_it_stands_nowhere(report, tmp_path):
    origin = report.campaigns[0].campaign.table.origin
    found = part(report, Pose(position=TURNED.position + origin, rotation=TURNED.rotation), tmp_path)
    stands = routes.inertia(built_in("cuboid")).placed(TURNED)
    values = [one.value for one in found.reference.values if one is not None]
    assert_allclose(values[1:4], stands.cog, atol=1e-9)
    assert_allclose(values[4:7], np.diag(stands.tensor_cog), rtol=1e-6)
    assert found.missing == ()
    found = part(report, None, tmp_path / "other")  # an answer is kept by the files, which do not change here
    assert found.reference is None
    assert any("[mounting]" in text for text in found.missing)
