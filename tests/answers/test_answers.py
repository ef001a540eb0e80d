"""Every command answers what it answered when its answers were stored: JSON to rounding, pages to the last printed digit."""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

Ask = Callable[[str], list[Any]]


def test_what_was_answered_is_answered_still(
    kind: str, ask: Ask, stored: Ask, differing: Any, renewed: Callable[[str, list[Any]], bool]
) -> None:
    found = ask(kind)
    if renewed(kind, found):
        return
    before = stored(kind)
    assert [one.line for one in found] == [one.line for one in before]
    told = [text for pair in zip(before, found, strict=True) for text in differing.between(*pair)]
    assert not told, "\n".join([f"{len(told)} differences from what is stored of {kind}:", *told])
