"""A number that the whole product computes with is written down once."""

from __future__ import annotations

import ast
from pathlib import Path

import pytest
from scipy.stats import norm

ROOT = Path(__file__).parents[2]
PRODUCT = ("geometry", "fem", "identification", "validation")


def written(low: float, high: float) -> list[str]:
    """Files of the product in which a number between `low` and `high` stands."""
    found = []
    for path in (one for room in PRODUCT for one in sorted((ROOT / room).rglob("*.py"))):
        for node in ast.walk(ast.parse(path.read_text(encoding="utf-8"))):
            if isinstance(node, ast.Constant) and isinstance(node.value, float) and low < node.value < high:
                found.append(f"{path.relative_to(ROOT)}: {node.value}")
    return found


@pytest.mark.parametrize("share", [0.90, 0.95])
def test_half_of_a_normal_interval_is_written_once_with_all_its_digits(share: float) -> None:
    exact = float(norm.ppf(0.5 + share / 2))
    found = written(exact - 1e-3, exact + 1e-3)
    assert len(found) == 1, found
    assert float(found[0].rpartition(" ")[2]) == pytest.approx(exact, rel=1e-15)
