"""A row's arithmetic, its verdict, and its two renderings."""

import json

import pytest
from hypothesis import given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from validation.rows import Row, rounded, rows_json, rows_table

CONTRACT = ["quantity", "value", "tolerance", "unit", "reference", "deviation_percent", "within", "dominated_by"]


def row(value: float = 47.4, tolerance: float | None = 0.05, reference: float | None = 47.23, **more: float) -> Row:
    return Row(quantity="mass", value=value, tolerance=tolerance, unit="kg", reference=reference, dominated_by="balance", **more)


def test_the_deviation_is_relative_to_the_reference_as_in_table_1() -> None:
    # Table 1 prints two decimals: half a unit of the last is the tolerance
    assert_allclose(row().deviation_percent, 0.36, atol=0.005)


@pytest.mark.parametrize(
    ("own", "others", "within"), [(0.16, None, False), (0.18, None, True), (0.12, 0.13, True), (None, None, False)]
)
def test_the_verdict_takes_both_tolerances_in_quadrature(own: float | None, others: float | None, within: bool) -> None:
    judged = Row(quantity="mass", value=47.4, tolerance=own, unit="kg", reference=47.23, reference_tolerance=others)
    assert judged.within is within


@given(st.floats(-1e6, 1e6), st.floats(1e-3, 1e3))
def test_value_and_reference_may_change_places_without_changing_the_verdict(value: float, tolerance: float) -> None:
    there, back = row(value, tolerance, 1.0), row(1.0, tolerance, value)
    assert there.within == back.within


def test_without_a_reference_nothing_contradicts_and_nothing_is_invented() -> None:
    alone = row(reference=None)
    assert alone.within
    assert alone.deviation_percent is None
    assert alone.deviation_in_tolerances is None


def test_a_zero_reference_has_no_deviation_in_per_cent_but_still_a_verdict() -> None:
    offset = row(value=-5.45, tolerance=1.0, reference=0.0)
    assert offset.deviation_percent is None
    assert not offset.within


def test_json_carries_the_contract_first_and_is_strict_json() -> None:
    (entry,) = rows_json([row()])
    assert list(entry)[:8] == CONTRACT
    assert json.loads(json.dumps(entry, allow_nan=False)) == entry


@pytest.mark.parametrize(
    ("value", "tolerance", "text"),
    [
        (47.4, 0.05, "47.400"),
        (20.353, 0.0417, "20.353"),
        (1234.5, 30.0, "1234"),
        (2.0, None, "2"),
        (None, 0.1, "–"),
        (-1e-9, 1.0, "0.0"),
    ],
)
def test_a_value_is_printed_with_the_digits_its_tolerance_leaves_it(value: float, tolerance: float, text: str) -> None:
    assert rounded(value, tolerance) == text


def test_the_table_has_one_line_a_row() -> None:
    assert rows_table([row(), row(reference=None)]).row_count == 2
