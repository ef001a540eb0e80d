"""Statements: partial, in any frame, with tolerances that go through as the algebra says."""

import numpy as np
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.frames import Pose, rotation_about
from geometry.inertia import Inertia
from validation.reference.statement import Stated, Statement, about_cog, inertia_of, seen_from

angle = st.floats(-3, 3)
metre = st.floats(-2, 2)
poses = st.builds(
    lambda p, a, b, c: Pose(
        position=np.array(p), rotation=rotation_about("z", a) @ rotation_about("x", b) @ rotation_about("y", c)
    ),
    st.tuples(metre, metre, metre),
    angle,
    angle,
    angle,
)
BODY = Inertia.from_cog(7.0, [0.1, -0.2, 0.4], [[0.5, 0.02, -0.03], [0.02, 0.4, 0.05], [-0.03, 0.05, 0.3]])


def said(inertia: Inertia, missing: tuple[int, ...] = (), tolerance: float | None = None) -> Statement:
    values = [None if k in missing else Stated(value=v, tolerance=tolerance) for k, v in enumerate(about_cog(inertia))]
    return Statement(name="test", values=tuple(values))


@settings(max_examples=40, deadline=None)
@given(poses)
def test_a_statement_seen_from_a_frame_is_the_body_placed_in_it(frame):
    seen = seen_from(said(BODY), frame)
    # Rounding only: lengths of a few metres, moments of tens of kg m².
    assert_allclose(seen.inertia.parameters, BODY.placed(frame.inverse).parameters, rtol=0, atol=1e-11)


def test_ten_values_and_the_body_are_the_same_and_without_moments_there_is_none():
    assert_allclose(inertia_of(about_cog(BODY)).parameters, BODY.parameters, rtol=0, atol=1e-14)
    with pytest.raises(ValueError, match="MoI Θxx not stated"):
        _ = said(BODY, missing=(4,)).inertia


def test_a_shift_keeps_what_is_stated_and_a_turn_loses_what_needs_the_products():
    partial = said(BODY, missing=(7, 8, 9))
    shifted = seen_from(partial, Pose(position=np.array([1.0, 2.0, 3.0])))
    assert [v is None for v in shifted.values] == [False] * 7 + [True] * 3
    turned = seen_from(partial, Pose(rotation=rotation_about("z", 0.3)))
    # About z, xx and yy mix through xy; zz does not.
    assert [v is None for v in turned.values] == [False] * 4 + [True, True, False] + [True] * 3


def test_a_quarter_turn_swaps_the_moments_of_a_partial_statement():
    turned = seen_from(said(BODY, missing=(7, 8, 9)), Pose(rotation=rotation_about("z", np.pi / 2)))
    stated = [v.value for v in turned.values if v is not None]
    # The cosine of 90 degrees leaves 1e-17 of the other moment.
    assert_allclose(stated[4:], np.array(BODY.moments_cog)[[1, 0, 2]], rtol=1e-14)


def test_a_turn_by_45_degrees_combines_two_equal_independent_tolerances():
    turned = seen_from(said(BODY, tolerance=0.01), Pose(rotation=rotation_about("z", np.pi / 4)))
    # Closed form: x' = (x + y) / sqrt(2), so 0.01 again; xx' = (xx + yy) / 2 + xy, so 0.01 sqrt(1/4 + 1/4 + 1).
    found = [v.tolerance for v in turned.values if v is not None]
    assert_allclose(found[1:5], [0.01, 0.01, 0.01, 0.01 * np.sqrt(1.5)], rtol=1e-8)  # accuracy of central differences
