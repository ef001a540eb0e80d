"""Exact aliases are found by the direction of the Fisher matrix, named with their sizes, and nothing else is taken for one."""

from collections.abc import Callable

import pytest
from numpy.testing import assert_allclose

from validation.estimation.problem import EFFECT, IDENTIFIED, SENSOR, Parameter, Problem
from validation.history.add import NOTICED, alias, noticed

MakeProblem = Callable[..., Problem]


def effect(name: str, unit: str = "1", kind: str = EFFECT) -> Parameter:
    return Parameter(name=name, unit=unit, tolerance=0.1, kind=kind)


def test_an_exact_alias_is_named_with_the_size_that_does_the_same(affine: MakeProblem) -> None:
    problem = affine((effect("gain"), effect("mass", "kg"), effect("other")), {}, alike=[("gain", "mass")])
    found = alias(problem, "gain", ["gain"])
    assert found.effects == ("mass",)
    assert_allclose(found.mixture["mass"] / found.size, 2.0, rtol=1e-6)
    assert found.text == "gain +0.01 does to these data what mass +0.02 kg does"
    assert found.share < 1e-12


def test_a_mixture_of_several_is_an_alias_though_none_of_them_alone_is(affine: MakeProblem) -> None:
    problem = affine(tuple(map(effect, "abc")), {})
    (one,) = problem.predictions
    one.slopes["a"] = one.slopes["b"] - 3 * one.slopes["c"]  # type: ignore[attr-defined]
    found = alias(problem, "a", ["a"])
    assert_allclose([found.mixture[name] / found.size for name in "bc"], [1.0, -3.0], rtol=1e-6)


def test_what_merely_resembles_another_is_none(affine: MakeProblem) -> None:
    problem = affine(tuple(map(effect, "ab")), {})
    (one,) = problem.predictions
    one.slopes["a"] = one.slopes["b"] + 0.05 * one.slopes["a"]  # type: ignore[attr-defined]
    assert alias(problem, "a", ["a"]) is None


@pytest.mark.parametrize(("kind", "effects"), [(IDENTIFIED, ()), (EFFECT, ("b",))])
def test_what_must_be_identified_takes_part_but_is_no_effect(kind: str, effects: tuple[str, ...], affine: MakeProblem) -> None:
    found = alias(affine((effect("a"), effect("b", kind=kind)), {}, alike=[("a", "b")]), "a", ["a"])
    assert found.effects == effects


def test_tolerances_of_the_measurement_take_no_part(affine: MakeProblem) -> None:
    assert alias(affine((effect("a"), effect("b", kind=SENSOR)), {}, alike=[("a", "b")]), "a", ["a"]) is None


def test_of_several_sizes_one_that_is_told_apart_is_enough(affine: MakeProblem) -> None:
    problem = affine((effect("a[m]"), effect("a[f]"), effect("b")), {}, alike=[("a[m]", "b")])
    assert alias(problem, "a", ["a[m]", "a[f]"]) is None
    assert alias(problem, "a", ["a[m]"]) is not None


def test_an_effect_that_moves_no_channel_is_not_noticed(affine: MakeProblem) -> None:
    problem = affine(tuple(map(effect, "ab")), {})
    (one,) = problem.predictions
    one.slopes["b"] *= 0.0  # type: ignore[attr-defined]
    assert noticed(problem, ["a"]) > 1.0
    assert noticed(problem, ["b"]) < NOTICED
    assert noticed(problem, []) == 0.0
