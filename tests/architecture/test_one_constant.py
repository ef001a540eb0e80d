"""A number that the whole product computes with is written down once."""

from __future__ import annotations

import ast
from functools import cache

import pytest
from scipy.stats import norm

from tools import house


@cache
def numbers() -> list[tuple[str, float]]:
    """Every number with a point that stands in the product, with its module."""
    nodes = ((name, node) for name, one in house.modules().items() for node in ast.walk(one.tree))
    return [(name, node.value) for name, node in nodes if isinstance(node, ast.Constant) and isinstance(node.value, float)]


def written(low: float, high: float) -> list[str]:
    """Modules of the product in which a number between `low` and `high` stands."""
    return [f"{name}: {value}" for name, value in numbers() if low < value < high]


@pytest.mark.parametrize("share", [0.90, 0.95])
def test_half_of_a_normal_interval_is_written_once_with_all_its_digits(share: float) -> None:
    exact = float(norm.ppf(0.5 + share / 2))
    found = written(exact - 1e-3, exact + 1e-3)
    assert len(found) == 1, found
    assert float(found[0].rpartition(" ")[2]) == pytest.approx(exact, rel=1e-15)


def test_standard_gravity_is_written_once() -> None:
    assert written(9.8066, 9.8067) == ["geometry.toml_file: 9.80665"]
