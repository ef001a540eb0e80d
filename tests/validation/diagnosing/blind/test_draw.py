"""The draw: a seed gives its cases, every family that acts in a linear test is in it, and sizes are multiples of limits."""

from itertools import islice

import pytest

from benchmarks.blind.drawing import foreign, limits
from benchmarks.blind.drawing.case import FOREIGN, KINDS, LEFT_OUT, NULL, PAIR, SERIES, SINGLE, WHOLE_SERIES, Case
from benchmarks.blind.drawing.choices import CHOICES, without
from benchmarks.blind.drawing.draw import COUNTS, draw
from benchmarks.blind.limits import of_nulls
from benchmarks.cross_check_proof import words
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import AMPLITUDE, PENDULUM, PROCESSING, STRUCTURE

SEED = 7


@pytest.fixture(scope="module")
def cases() -> tuple[Case, ...]:
    return draw(SEED)


def test_a_seed_gives_the_same_cases_and_another_seed_gives_others(cases: tuple[Case, ...]) -> None:
    assert draw(SEED) == cases
    assert not {one.laboratory for one in draw(SEED + 1)} & {one.laboratory for one in cases}


def test_the_first_of_a_kind_are_the_same_however_many_are_asked_for(cases: tuple[Case, ...]) -> None:
    few = draw(SEED, (SINGLE, FOREIGN), 3)
    expected = [one for kind in (SINGLE, FOREIGN) for one in islice((c for c in cases if c.kind == kind), 3)]
    assert list(few) == expected


def test_there_are_as_many_of_each_kind_as_the_bars_ask_for(cases: tuple[Case, ...]) -> None:
    counts = {kind: sum(one.kind == kind for one in cases) for kind in KINDS}
    assert counts[NULL] >= 200
    assert counts[PAIR] >= 20
    assert counts[LEFT_OUT] >= 20
    assert counts[FOREIGN] >= 2 * len(foreign.FOREIGN)


def test_every_family_that_acts_in_a_linear_test_is_planted_alone(cases: tuple[Case, ...]) -> None:
    linear = {name for name, one in FAMILIES.items() if one.side not in (AMPLITUDE, PROCESSING, PENDULUM)}
    hidden = {one.family for one in CHOICES if not one.words and all(2 * limits.limit(id) > one.largest for id in one.ids)}
    assert hidden <= {"layer-damping"}  # whose own loss factor, known to 35 %, hides all that the family allows
    linear -= hidden
    assert {one.planted[0].text.partition(":")[0].partition("=")[0] for one in cases if one.kind == SINGLE} == linear


def test_eight_effects_of_the_structure_are_among_them_and_those_that_are_hard() -> None:
    structural = [one for one in CHOICES if one.structural]
    assert len(structural) >= 8
    assert len(CHOICES) >= 20
    assert all(FAMILIES[one.family].side == STRUCTURE for one in structural)
    hard = {"modulus:mast", "joint-compliance:rotation", "structural-damping:mast", "point-mass:mast-top", "point-mass:lower-1+"}
    assert hard <= {id for one in structural for id in one.ids}


@pytest.mark.parametrize("seed", range(5))
def test_everything_that_is_drawn_can_be_planted_and_is_of_a_size_that_its_family_knows(seed: int) -> None:
    for one in draw(seed):
        for planted in one.planted:
            if not planted.text.startswith(foreign.PREFIX):
                parse(planted.text, words())  # refuses what is no physics
            else:
                foreign.of_text(planted.text)


def test_singles_are_twice_five_and_fifteen_times_their_limit(cases: tuple[Case, ...]) -> None:
    sized = [one.planted[0] for one in cases if one.kind == SINGLE and one.planted[0].multiple]
    assert {one.multiple for one in sized} == {2.0, 5.0, 15.0}
    for one in sized:
        named = parse(one.text, words())
        first = next(iter(named.values.values()))
        size = abs(first - next(s.null for s in FAMILIES[named.family].sizes_at(named.targets)))
        assert size == pytest.approx(one.multiple * limits.limit(named.id), rel=1e-4)  # five digits are written


def test_limits_are_no_larger_than_those_of_the_study() -> None:
    assert limits.limit("force-gain:fmd-z2") <= 0.015
    assert limits.limit("point-mass:mast-top") <= 0.1
    assert limits.limit("modulus:mast") <= 0.035
    assert limits.limit("accelerometer-position:cover-z3:x") <= 2.5e-3
    assert limits.limit("appendage:z") <= 0.010
    assert limits.limit("force-delay:fmd-z2") <= 100e-6
    assert limits.limit("accelerometer-delay:cover-z3") <= 100e-6


def test_what_lies_within_five_tolerances_says_so() -> None:
    assert limits.told("modulus:mast") == pytest.approx(5 * 0.025)
    assert limits.told("joint-compliance:rotation") == limits.limit("joint-compliance:rotation")


@pytest.mark.parametrize("seed", range(8))
def test_both_of_a_pair_are_five_times_their_limit_and_more_and_not_of_one_kind(seed: int) -> None:
    for one in draw(seed, (PAIR,)):
        first, second = (parse(planted.text, words()).family for planted in one.planted)
        assert second not in without(first)
        assert all(planted.multiple >= 5 for planted in one.planted)


def test_what_is_left_out_is_left_out_by_every_name_that_it_has(cases: tuple[Case, ...]) -> None:
    for one in (one for one in cases if one.kind == LEFT_OUT):
        assert one.leave_out[0] == parse(one.planted[0].text, words()).family
        assert set(one.leave_out) <= set(FAMILIES)


def test_no_foreign_physics_is_a_family() -> None:
    assert not any(name.startswith(foreign.PREFIX) for name in FAMILIES)


def test_every_faulty_series_has_a_null_of_its_own_laboratory(cases: tuple[Case, ...]) -> None:
    nulls = {one.name: one for one in cases if one.kind == NULL}
    faulty = [one for one in cases if one.kind != NULL]
    assert len({one.null for one in faulty}) == len(faulty)
    for one in faulty:
        null = nulls[one.null]
        assert (one.laboratory, one.articles, one.hold_out) == (null.laboratory, null.articles, null.hold_out)
    assert COUNTS[NULL] == len(nulls)
    assert all(one.null == one.name for one in nulls.values())


def test_one_sweep_of_each_campaign_is_held_out_each_of_another_axis(cases: tuple[Case, ...]) -> None:
    for one in cases:
        articles, axes = zip(*(name.split("/") for name in one.hold_out), strict=True)
        assert articles == one.articles
        assert len(set(axes)) == len(axes)


def test_limits_are_medians_over_the_nulls_in_which_an_effect_can_act() -> None:
    def null(*articles: str, **detectable: float) -> tuple[dict[str, object], dict[str, object]]:
        return {"articles": list(articles)}, {"detectable": [{"id": id, "size": size} for id, size in detectable.items()]}

    three = [null(*SERIES, **{"force-gain:fmd-z1": size, "appendage:z": 0.1}) for size in (1.0, 2.0, 4.0)]
    whole = null(*WHOLE_SERIES, **{"force-gain:fmd-z1": 9.0, "modulus:upper-long": 0.3})
    refused = ({"articles": list(SERIES)}, {"refused": "no"})
    found = of_nulls([*three, whole, refused])
    assert found == {"force-gain:fmd-z1": 2.0, "appendage:z": 0.1, "modulus:upper-long": 0.3}
