"""What is known from elsewhere, in the frame of the campaign: the article of the tare, and weighing, CoG and pendulum results."""

from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry import routes
from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from identification.quality import NORMAL_95
from validation.identify import request
from validation.model.setups import above_fmd, known, stated


def test_the_known_article_and_the_fmd_make_the_built_in_stack_and_a_bare_fmd_has_nothing_on_it(make_campaign):
    seat = built_in("fmd").seat
    body, said = known("disc+cuboid", make_campaign("fmd+disc+cuboid", mounting=seat))
    assert body is not None
    assert not said
    stack = routes.inertia(built_in("fmd+disc+cuboid"))
    assert_allclose((body + routes.inertia(built_in("fmd"))).parameters, stack.parameters, rtol=1e-12, atol=1e-12)
    assert known("fmd", make_campaign("fmd")) == (None, ())
    assert [above_fmd(name) for name in ("fmd+disc+cuboid", "fmd", "clumod-1")] == ["disc+cuboid", "", "clumod-1"]


def test_without_a_mounting_the_seat_of_the_fmd_is_taken_and_said(make_campaign):
    body, said = known("disc+cuboid", make_campaign("fmd+disc+cuboid", mounting=None))
    same, _ = known("disc+cuboid", make_campaign("fmd+disc+cuboid", mounting=built_in("fmd").seat))
    assert_allclose(body.parameters, same.parameters)
    assert "[mounting] is missing" in said[0]


def test_inertia_is_about_f_wherever_the_frame_of_positions_begins(make_campaign):
    shift = np.array([0.3, -0.1, 0.2])
    made = make_campaign("fmd+disc+cuboid")
    moved = make_campaign(
        "fmd+disc+cuboid",
        table=type(made.table)(channels=made.table.channels, origin=shift),
        mounting=Pose(position=made.mounting.position + shift),
    )
    here, there = (known("disc+cuboid", one)[0] for one in (made, moved))
    assert_allclose(there.parameters, here.parameters, rtol=1e-12)
    assert_allclose(there.reference_point, 0)


WEIGHING = """format = 1
kind = "weighing"
article = { name = "ARTICLE" }
[balance]
resolution = "20 g"
relative_error = "0.05 %"
digit_error = 1
[[reading]]
gross = "32.95 kg"
"""

COG = """format = 1
kind = "results"
article = { name = "clumod-1" }
cog_x = { value = "2.0 +/- 0.5 mm" }
cog_z = { value = "270.6 +/- 1.0 mm" }
Ixx = { value = "6.42 +/- 0.05 kg m^2" }
Ixz = { value = "0.10 +/- 0.02 kg m^2" }
"""


def _file(folder: Path, text: str) -> str:
    path = folder / "measured.toml"
    path.write_text(text)
    return str(path)


def test_a_weighing_is_a_fact_whose_tolerance_is_its_95_per_cent_half_width(tmp_path, make_campaign):
    name = _file(tmp_path, WEIGHING.replace("ARTICLE", "clumod-1"))
    (fact,), words = request.facts([name], make_campaign("fmd+clumod-1"), tared=True)
    assert (fact.quantity, fact.value, fact.source) == ("mass_kg", pytest.approx(32.95), name)
    assert not words
    from validation.classical import weigh
    from validation.classical.files import read

    assert fact.sd == pytest.approx(weigh.reduce(read(name, ("weighing",))).results["mass"].std_dev / NORMAL_95)


def test_a_cog_and_a_product_follow_the_mount(tmp_path, make_campaign):
    pose = Pose(position=np.array([0.01, 0.0, 0.045]), rotation=rotation_about("z", np.pi / 2))
    name = _file(tmp_path, COG)
    facts, _ = request.facts([name], make_campaign("fmd+clumod-1", mounting=pose), tared=True)
    by_name = {fact.quantity: fact.value for fact in facts}
    # The article's x lies along the campaign's y.
    assert by_name == {
        "cog_y_mm": pytest.approx(0.002),
        "cog_z_mm": pytest.approx(0.2706 + 0.045),
        "moi_yy_cog_kgm2": pytest.approx(6.42),
        "poi_yz_cog_kgm2": pytest.approx(0.10),
    }


def test_every_fact_is_what_the_body_itself_would_say(tmp_path, make_campaign):
    """The rule of signs against the body turned as a whole, by a quarter turn the other way."""
    pose = Pose(position=np.zeros(3), rotation=rotation_about("z", -np.pi / 2))
    name = _file(tmp_path, COG)
    body = routes.inertia(built_in("clumod-1"))
    from geometry.inertia import Inertia

    tensor = body.tensor_cog.copy()
    tensor[0, 0], tensor[0, 2], tensor[2, 0] = 6.42, 0.10, 0.10
    seen = Inertia.from_cog(body.mass, [0.002, 0.0, 0.2706], tensor).placed(pose)
    facts, _ = request.facts([name], make_campaign("fmd+clumod-1", mounting=pose), tared=True)
    for fact in facts:
        kind, axes = fact.quantity.split("_")[:2]
        rows = ["xyz".index(letter) for letter in axes]
        truth = seen.cog[rows[0]] if kind == "cog" else seen.tensor_cog[rows[0], rows[1]]
        assert_allclose(fact.value, truth, rtol=1e-12)


def test_an_askew_mount_is_refused_where_it_would_mix_components(tmp_path, make_campaign):
    askew = Pose(position=np.array([0.0, 0.0, 0.045]), rotation=rotation_about("z", 0.3))
    with pytest.raises(BadInput, match="lies askew"):
        request.facts([_file(tmp_path, COG)], make_campaign("fmd+clumod-1", mounting=askew), tared=True)


@pytest.mark.parametrize(("article", "tared"), [("clumod-4", True), ("clumod-1", False), ("fmd+clumod-1", True)])
def test_a_result_about_another_body_is_refused(article, tared, tmp_path, make_campaign):
    name = _file(tmp_path, WEIGHING.replace("ARTICLE", article))
    with pytest.raises(BadInput, match=f"it is about {article.replace('+', '.')}") as refused:
        request.facts([name], make_campaign("fmd+clumod-1"), tared=tared)
    assert refused.value.field == "article.name"


def test_assumed_tolerances_are_said(make_campaign):
    facts, words = request.facts(["clumod-4-published"], make_campaign("fmd+clumod-4"), tared=True)
    assert {fact.quantity for fact in facts} >= {"mass_kg", "cog_z_mm", "moi_zz_cog_kgm2"}
    assert "assumed" in words[0]


def test_a_cog_needs_to_know_where_its_origin_stands(tmp_path, make_campaign):
    assert stated(make_campaign("fmd+clumod-1", mounting=None)) is None
    with pytest.raises(BadInput, match="is missing") as refused:
        request.facts([_file(tmp_path, COG)], make_campaign("fmd+clumod-1", mounting=None), tared=True)
    assert refused.value.field == "mounting"
