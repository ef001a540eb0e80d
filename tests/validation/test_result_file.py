"""Anyone's ten parameters: the same body, however it is stated, deviates by nothing; everything else is refused in words."""

import json
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.inertia import Inertia
from identification.quality import NORMAL_95
from validation.output import inertia_json
from validation.reference import statement
from validation.reference.reference import cross_check, read_result, route_statement
from validation.reference.statement import Statement, pose_of

BODY = Inertia.from_cog(33.0, [0.01, -0.02, 0.27], [[6.4, 0.11, -0.07], [0.11, 6.0, 0.05], [-0.07, 0.05, 0.8]])
IDENTITY = Pose()
metre, radian = st.floats(-2, 2), st.floats(-3, 3)


def statement_of(inertia: Inertia, about: np.ndarray, form: str, sign: str) -> dict[str, Any]:
    """`inertia` written down about a point, with all digits, as a user might."""
    moved = inertia.about(about)
    factor = 1.0 if sign == "matrix-entry" else -1.0
    table: dict[str, Any] = {
        "about": " ".join(repr(float(x)) for x in about) + " m",
        "mass": f"{moved.mass!r} kg",
        "moments": [f"{float(v)!r} kg m²" for v in moved.parameters[4:7]],
        "products": [f"{float(factor * v)!r} kg m²" for v in moved.parameters[7:]],
        "products_sign": sign,
    }
    if form == "cog":
        table["cog"] = [f"{float(1e3 * v)!r} mm" for v in moved.cog]
    else:
        table["first_moment"] = [f"{float(v)!r} kg m" for v in moved.first_moment]
    return table


@settings(max_examples=60, deadline=None)
@given(
    st.tuples(metre, metre, metre),
    st.tuples(metre, metre, metre),
    st.tuples(radian, radian, radian),
    st.sampled_from(["cog", "first_moment"]),
    st.sampled_from([statement.MATRIX_ENTRY, statement.POSITIVE_INTEGRAL]),
)
def test_the_same_body_about_any_point_in_any_frame_with_any_sign_does_not_deviate(about, origin, turns, form, sign):
    rotation = rotation_about("z", turns[0]) @ rotation_about("x", turns[1]) @ rotation_about("y", turns[2])
    frame = Pose(position=np.array(origin), rotation=rotation)
    table = {"inertia": statement_of(BODY.placed(frame.inverse), np.array(about), form, sign)}
    result = statement.read(table, "test", frame)
    # Rounding of moments of up to 33 kg (4 m)^2 = 500 kg m² in ten digits and more: 1e-10 kg m² is left.
    assert_allclose(result.inertia.parameters, BODY.parameters, rtol=0, atol=1e-10)
    check = cross_check(result, route_statement("occ", BODY))
    assert check.passed, check.text


@pytest.mark.parametrize("coordinate", ["2.1e-149 m", "-3.1e-17 m", "0e400 m"])
def test_a_coordinate_that_is_the_rounding_of_a_zero_is_a_zero_of_few_digits(coordinate):
    table = {"inertia": {"mass": "2 kg", "cog": [coordinate, "0 m", "0 m"]}}
    stated = statement.read(table, "test", IDENTITY).values[1]
    assert stated.value == 0
    assert (stated.decimals or 0) <= 15


def test_products_read_with_the_wrong_sign_deviate():
    table = {"inertia": statement_of(BODY, np.zeros(3), "cog", "matrix-entry")}
    table["inertia"]["products_sign"] = "positive-integral"
    check = cross_check(statement.read(table, "test", IDENTITY), route_statement("occ", BODY))
    assert {row.quantity for row in check.outside} >= {"PoI Θxy", "PoI Θxz", "PoI Θyz"}


def test_a_moment_about_a_distant_point_inherits_the_tolerance_of_the_cog():
    table = {
        "inertia": {
            "about": "0 0 -1 m",
            "mass": "2 +/- 0.0000001 kg",
            "cog": ["0 +/- 1e-9 m", "0 +/- 1e-9 m", "0 +/- 0.01 m"],
            "moments": ["3 +/- 1e-9 kg m²", "3 +/- 1e-9 kg m²", "1 +/- 1e-9 kg m²"],
        }
    }
    values = statement.read(table, "test", IDENTITY).values
    # I_cog = I - m z²: dI = 2 m z dz = 2 * 2 * 1 * 0.01.
    assert_allclose([values[4].value, values[4].tolerance], [1.0, 0.04], rtol=1e-6)
    assert values[7] is None, "no products are stated"


def test_what_would_need_an_unstated_value_is_unstated_and_the_papers_own_result_ships():
    table = {"inertia": {"about": "0 0 1 m", "moments": ["3 kg m²", "3 kg m²", "1 kg m²"], "mass": "2 kg"}}
    assert [v is None for v in statement.read(table, "test", IDENTITY).values] == [False] + [True] * 9
    result = read_result("clumod-1-table2", article="clumod-1").statement
    assert [v is None for v in result.values] == [False] * 7 + [True] * 3


def test_a_covariance_counts_what_its_values_share():
    table = {"inertia": statement_of(BODY, np.zeros(3), "first_moment", "matrix-entry")}
    m, mz = BODY.mass, BODY.first_moment[2]
    # Mass and first moment wrong by one common factor: the CoG does not move.
    direction = np.array([m, *BODY.first_moment, *np.zeros(6)])
    C = 1e-4 * np.outer(direction, direction) + 1e-18 * np.eye(10)
    values = statement.read({**table, "covariance": C.tolist()}, "test", IDENTITY).values
    assert_allclose(values[0].tolerance or 0, NORMAL_95 * 0.01 * m, rtol=1e-6)
    assert (values[3].tolerance or 1) < 1e-6 * mz, "1.96 standard deviations of nothing"


def test_an_interval_counts_with_its_farther_end(tmp_path):
    path = tmp_path / "r.toml"
    path.write_text('format = 1\n[inertia]\nmass = "10 kg"\n[interval95]\nmass = ["9.5 kg", "10.2 kg"]\n', encoding="utf-8")
    mass = read_result(str(path), article="cuboid").statement.values[0]
    assert_allclose(mass.tolerance or 0, 0.5, rtol=1e-12)  # rounding


def identified(**changes: Any) -> dict[str, Any]:
    return {"article": "clumod-1", "origin": "article", "inertia": inertia_json(BODY), "warnings": [], **changes}


def written(folder: Path, value: object) -> str:
    path = folder / "result.json"
    path.write_text(json.dumps(value), encoding="utf-8")
    return str(path)


@pytest.mark.parametrize("value", [inertia_json(BODY), identified(), identified(interval95={"mass_kg": [32.0, 34.0]})])
def test_what_massline_prints_can_be_handed_back(tmp_path, value):
    result = read_result(written(tmp_path, value), article="clumod-1").statement
    assert_allclose(result.inertia.parameters, BODY.parameters, rtol=0, atol=1e-12)  # rounding


def test_a_cog_from_f_needs_to_know_where_f_is(tmp_path):
    value = identified(origin="F")
    name = written(tmp_path, value)
    with pytest.raises(BadInput, match="clumod-1 does not say where F is"):
        read_result(name, article="clumod-1")
    frame = Pose(position=np.array([0, 0, -0.045]))
    assert read_result(name, article="clumod-1", frame=frame).statement.complete
    whole = written(tmp_path, {**value, "article": "fmd+clumod-1"})
    assert read_result(whole, article="fmd+clumod-1").statement.complete


@pytest.mark.parametrize(
    ("about", "against"), [("disc", "clumod-1"), ("nonsense", "cuboid"), ("cuboid", "my.step"), ("", "disc"), (5, "my.step")]
)
def test_a_result_about_another_article_is_refused(tmp_path, about, against):
    name = written(tmp_path, identified(article=about))
    with pytest.raises(BadInput, match=f"about {about}, held against {against}") as caught:
        read_result(name, article=against)
    assert (caught.value.source, caught.value.field) == (name, "article")


@pytest.mark.parametrize(("about", "against"), [("Disc", "disc"), ("fmd + disc", "fmd+disc"), ("rig", "some/Rig.step")])
def test_a_result_about_the_same_article_in_other_letters_is_read(tmp_path, about, against):
    assert read_result(written(tmp_path, identified(article=about)), article=against).warnings == ()


def test_a_result_about_another_name_of_the_users_own_is_said(tmp_path):
    (warning,) = read_result(written(tmp_path, identified(article="rig")), article="my.step").warnings
    assert "about rig, held against my.step" in warning


@pytest.mark.parametrize(
    ("text", "words"),
    [
        ("", "is none of the forms"),
        ("fromat = 1", "Did you mean format"),
        ("format = 2", "must be 1, found 2"),
        ("format = 1", "`inertia`: is missing"),
        ('format = 1\n[inertia]\nmas = "1 kg"', "Did you mean mass"),
        ('format = 1\ncoment = "x"\n[inertia]', "unknown key 'coment'"),
        ("format = 1\n[inertia]\nmass = 33.9", "needs its unit"),
        ('format = 1\n[inertia]\nmass = "33.9"', "needs its unit"),
        ('format = 1\n[inertia]\nmass = "33.9 mm"', "is a length"),
        ('format = 1\n[inertia]\nmass = "nan kg"', "cannot be read"),
        ('format = 1\n[inertia]\ncog = ["1 mm"]', "a list of 3"),
        ('format = 1\n[inertia]\ncog = ["1 mm", "1 mm", "1 mm"]\nfirst_moment = ["1 kg m", "1 kg m", "1 kg m"]', "both cog and"),
        ('format = 1\n[inertia]\nfirst_moment = ["1 kg m", "1 kg m", "1 kg m"]', "about the CoG is zero"),
        ('format = 1\n[inertia]\nabout = "origin"\nfirst_moment = ["1 kg m", "1 kg m", "1 kg m"]', "nothing without a mass"),
        ('format = 1\n[inertia]\nabout = "up there"', "three numbers and a unit"),
        ('format = 1\n[inertia]\nproducts = ["1 kg m²", "1 kg m²", "1 kg m²"]', "go by two signs"),
        (
            'format = 1\n[inertia]\nproducts_sign = "positive"\nproducts = ["1 kg m²", "1 kg m²", "1 kg m²"]',
            "must be one of matrix-entry",
        ),
        ('format = 1\n[inertia]\nmass = "1 kg"\n[tolerance]\nmass = "-3 %"', "must be positive"),
        ('format = 1\n[inertia]\nmass = "1 kg"\n[tolerance]\nmas = "3 %"', "Did you mean mass"),
        ('format = 1\n[inertia]\ncog = ["1 mm", "1 mm", "1 mm"]\n[tolerance]\ncog = ["1 mm"]', "a list of 3"),
        ('format = 1\n[inertia]\nmass = "1 kg"\n[tolerance]\nmass = ["1 kg"]', "cannot be read"),
        ('format = 1\n[inertia]\nmass = "1 kg"\n[interval95]\nmass = ["2 kg", "3 kg"]', "outside its interval"),
        ('format = 1\ncovariance = [[1.0]]\n[inertia]\nmass = "1 kg"', "needs all ten values"),
        ("format = 1\n[frame]\nrotation = [[1, 0, 0], [0, 1, 0], [0, 0, -1]]\n[inertia]", "reflection"),
        ("format = 1\n[frame]\nrotation = [[1, 0, 0], [0, 0.7071, 0.7071], [0, -0.7071, 0.7071]]\n[inertia]", "orthonormal"),
        ("format = 1\n[frame]\nrotation = [[1, 0], [0, 1]]\n[inertia]", "is no rotation"),
        (
            "format = 1\n[frame]\nrotation = [1, 0, 0, 0, 1, 0, 0, 0]\n[inertia]",
            "is no rotation: found [1, 0, 0, 0, 1, 0, 0, 0]. Give",
        ),
        ("format = 1\n[frame]\nrotation = 5\n[inertia]", "is no rotation: found 5. Give"),
        ("format = 1\n[frame]\nrotation = [1, 2, true]\n[inertia]", "is no rotation: found [1, 2, True]. Give"),
        ("format = 1\n[frame]\nrotation = [inf, 0, 0, 0, 1, 0, 0, 0, 1]\n[inertia]", "is no rotation"),
        ('format = 1\n[frame]\norigin = "0 0 1"\n[inertia]', "a unit of length"),
        ('format = 1\nframe = "0 0 1 mm; q 3 deg"\n[inertia]', "a turn must be"),
        ("format = 1\n[inertia", "is not TOML"),
        ("[1]", "one JSON object"),
        ('{"mass_kg": NaN}', "must be finite, found NaN"),
        ('{"mass_kg": 1}', "`cog_mm`: is missing"),
        ('{"mass_kg": 1, "cog_mm": [0, 0], "moi_cog_kgm2": [1, 1, 1], "poi_cog_kgm2": [0, 0, 0]}', "a list of 3"),
        (
            '{"mass_kg": 1, "cog_mm": [0, 0, "0"], "moi_cog_kgm2": [1, 1, 1], "poi_cog_kgm2": [0, 0, 0]}',
            "finite number, found '0'",
        ),
        ('{"mass_kg": 1, "cog_mm": [0,0,0], "moi_cog_kgm2": [1,1,1], "poi_cog_kgm2": [0,0,0], "about": "F"}', "found 'F'"),
    ],
)
def test_a_file_that_cannot_be_meant_is_refused_in_words(tmp_path, text, words):
    path = tmp_path / ("r.json" if text.startswith(("[1]", "{")) else "r.toml")
    path.write_text(text, encoding="utf-8")
    with pytest.raises(BadInput) as caught:
        read_result(str(path), article="cuboid")
    assert words in str(caught.value)
    assert str(path) in str(caught.value)


def checked(moments: list[str], products: list[str] | None) -> tuple[bool | None, bool]:
    table: dict[str, Any] = {"mass": "33 kg", "cog": ["0 mm"] * 3, "moments": moments}
    if products is not None:
        table |= {"products": products, "products_sign": "matrix-entry"}
    result: Statement = statement.read({"inertia": table}, "test", IDENTITY)
    check = cross_check(result, result)
    return check.physical, check.passed


def test_parameters_that_no_body_has_are_a_failed_check_not_bad_input():
    assert checked(["1 kg m²", "1 kg m²", "3 kg m²"], ["0 kg m²"] * 3) == (False, False)
    # No product can mend a diagonal that breaks the triangle inequality.
    assert checked(["1 kg m²", "1 kg m²", "3 kg m²"], None) == (False, False)
    # The diagonal is fine; the products are not.
    assert checked(["1 kg m²"] * 3, ["2 kg m²", "0 kg m²", "0 kg m²"]) == (False, False)
    assert checked(["1 kg m²"] * 3, ["0 kg m²"] * 3) == (True, True)
    assert checked(["1 kg m²"] * 3, None) == (None, True)


@pytest.mark.parametrize("rotation", [[0, -1, 0, 1, 0, 0, 0, 0, 1], [[0, -1, 0], [1, 0, 0], [0, 0, 1]], "z 90 deg"])
def test_a_rotation_is_the_same_as_a_list_as_rows_and_as_a_turn(rotation):
    assert_allclose(pose_of({"rotation": rotation}, "test").rotation, rotation_about("z", np.pi / 2), rtol=0, atol=1e-15)
