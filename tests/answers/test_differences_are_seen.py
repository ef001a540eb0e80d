"""The comparison of answers can fail: what was changed by hand in a stored answer is told, and what is rounding is not."""

from __future__ import annotations

import copy
from collections.abc import Callable
from dataclasses import replace
from typing import Any

import pytest

Stored = Callable[[str], list[Any]]


@pytest.fixture
def comparison(stored: Stored) -> Any:
    """What `massline compare --json` answered."""
    return next(one for one in stored("sound") if one.line.startswith("compare") and one.data)


@pytest.fixture
def page(stored: Stored) -> Any:
    """What `massline compare` answered on the terminal."""
    return next(one for one in stored("sound") if one.line.startswith("compare") and one.data is None)


def changed(answer: Any, change: Callable[[Any], None]) -> Any:
    data = copy.deepcopy(answer.data)
    change(data)
    return replace(answer, data=data)


def test_an_answer_is_the_same_as_itself(kind: str, stored: Stored, differing: Any) -> None:
    answers = stored(kind)
    assert answers
    assert not [told for one in answers for told in differing.between(one, one)]


def test_a_number_that_moved_by_a_hundred_thousandth_is_told_with_its_place(comparison: Any, differing: Any) -> None:
    was = comparison.data["plain_error_percent"]
    moved = changed(comparison, lambda data: data.update(plain_error_percent=was * (1 + 1e-5)))
    (told,) = differing.between(comparison, moved)
    assert f"plain_error_percent: stored {was!r}, found" in told


def test_rounding_is_no_difference(comparison: Any, differing: Any) -> None:
    was = comparison.data["plain_error_percent"]
    assert not differing.between(comparison, changed(comparison, lambda data: data.update(plain_error_percent=was * (1 + 1e-8))))


def test_a_lost_key_a_changed_word_and_a_shorter_list_are_told_at_once(comparison: Any, differing: Any) -> None:
    def damage(data: Any) -> None:
        del data["plain_error_percent"]
        data["worst"][0]["text"] += " or so"
        data["errors"].pop()

    told = "\n".join(differing.between(comparison, changed(comparison, damage)))
    assert "keys lost ['plain_error_percent']" in told
    assert "worst[0].text" in told
    assert "errors: stored" in told


def test_keys_in_another_order_are_told(comparison: Any, differing: Any) -> None:
    turned = replace(comparison, data=dict(reversed(comparison.data.items())))
    assert "another order" in differing.between(comparison, turned)[0]


@pytest.mark.parametrize(
    ("before", "after", "same"),
    [
        ("plain error   1.56 %", "plain error  1.57 %", True),
        ("plain error   1.56 %", "plain error  1.58 %", False),
        ("plain error   1.56 %", "nominal error  1.56 %", False),
        ("6 runs", "7 runs", False),
        ("a ──────── b", "a ───── b", True),
        ("about 2.1e-05 m", "about 2.3e-05 m", False),
        ("−3.2 mm", "3.2 mm", False),
    ],
)
def test_pages_are_held_to_the_last_digit(before: str, after: str, same: bool, page: Any, differing: Any) -> None:
    found = differing.between(replace(page, text=before), replace(page, text=after))
    assert bool(found) is not same
    assert same or (before in found[0] and after in found[0])


def test_a_line_that_is_gone_is_told(page: Any, differing: Any) -> None:
    shorter = "\n".join(page.text.splitlines()[:-1])
    assert any("lines, found" in told for told in differing.between(page, replace(page, text=shorter)))
