"""Labels of a picture are moved apart as little as it takes."""

import numpy as np
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from validation.report.charts.history import spread

HEIGHTS = st.lists(st.floats(-200.0, 200.0), min_size=1, max_size=8)


@given(heights=HEIGHTS, gap=st.floats(0.0, 20.0))
def test_labels_end_at_least_a_gap_apart_about_the_same_middle(heights: list[float], gap: float) -> None:
    placed = spread(heights, gap)
    assert np.all(np.diff(placed) >= gap - 1e-9)
    assert_allclose(np.mean(placed), np.mean(heights), atol=1e-9)


@given(heights=HEIGHTS)
def test_labels_that_are_apart_stay_where_they_are(heights: list[float]) -> None:
    apart = np.sort(heights) + 10.0 * np.arange(len(heights))
    assert_allclose(spread(list(apart), 10.0), apart, atol=1e-9)


def test_two_labels_that_meet_move_by_half_of_what_is_missing() -> None:
    assert_allclose(spread([0.0, 4.0, 50.0], 10.0), [-3.0, 7.0, 50.0])
