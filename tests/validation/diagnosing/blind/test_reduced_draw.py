"""The proof in small: one case of each family, two nulls, something unknown and a pair, drawn, sealed, diagnosed and scored.

Sweeps are seven times as fast as in the proof and noise is smaller, so that a line is as clean; every eighth line is looked at.
Each effect stands far above its limit. The whole proof is `make blind`.
"""

from pathlib import Path
from statistics import median
from typing import Any

import pytest

from benchmarks.blind.answering import answered
from benchmarks.blind.drawing.case import FOREIGN, NULL, PAIR, SERIES, SINGLE, Case
from benchmarks.blind.drawing.choices import CHOICES
from benchmarks.blind.drawing.draw import draw
from benchmarks.blind.score.outcome import Outcome, outcome
from benchmarks.blind.sealing import sealed
from identification.campaign import Processing
from validation.virtual_test.plan import MAINS, NOISE

SEED = 3
"""Of a draw of its own, which no bar is tuned on."""

FASTER = 60.0 / 8.0

FAST: dict[str, Any] = {
    "octaves_per_minute": 60.0,
    "quiet": 0.3,
    "ringing": 1e-3,
    "simulation_rate": 4096.0,
    "noise_rms": {quantity: size / FASTER**0.5 for quantity, size in NOISE.items()},
    "mains": {quantity: size / FASTER**0.5 for quantity, size in MAINS.items()},
}

FAMILIES = sorted({one.family for one in CHOICES} - {"layer-damping"})

EVERY_EIGHTH = Processing(step=0.4)


def family(case: Case) -> str:
    return case.planted[0].text.partition("=")[0].partition(":")[0]


def chosen() -> list[Case]:
    """Of each family the largest that needs no more than two campaigns, and a few of the other kinds."""
    cases = [one for one in draw(SEED) if one.articles == SERIES]
    singles = sorted((one for one in cases if one.kind == SINGLE), key=lambda one: one.planted[0].multiple)
    largest = {family(one): one for one in singles}
    others = [one for kind, count in ((NULL, 2), (FOREIGN, 1), (PAIR, 1)) for one in _first(cases, kind, count)]
    return [*others, *largest.values()]


def _first(cases: list[Case], kind: str, count: int) -> list[Case]:
    return [one for one in cases if one.kind == kind][:count]


def diagnosed(case: Case, folder: Path) -> Outcome:
    truth = sealed(case, folder, driven=FAST, processing=EVERY_EIGHTH)
    return outcome(truth, answered(folder))


@pytest.fixture(scope="module")
def outcomes(tmp_path_factory: pytest.TempPathFactory) -> dict[str, Outcome]:
    """By family of a single effect, else by the name of the case."""
    scratch = tmp_path_factory.mktemp("reduced")
    return {family(one) if one.kind == SINGLE else one.name: diagnosed(one, scratch / one.name) for one in chosen()}


def test_every_family_is_drawn_but_that_of_layers_which_four_blades_alone_have() -> None:
    assert sorted(family(one) for one in chosen() if one.kind == SINGLE) == FAMILIES


def test_where_nothing_is_missing_nothing_is_named(outcomes: dict[str, Outcome]) -> None:
    assert [one.verdict for one in outcomes.values() if one.kind == NULL] == ["nothing", "nothing"]


@pytest.mark.parametrize("name", FAMILIES)
def test_what_is_missing_is_in_the_class_that_is_reported(name: str, outcomes: dict[str, Outcome]) -> None:
    found = outcomes[name]
    assert found.inside, (found.verdict, found.claimed, found.alike)


def test_hardly_anything_is_claimed_besides(outcomes: dict[str, Outcome]) -> None:
    singles = [one for one in outcomes.values() if one.kind == SINGLE]
    assert sum(one.extra for one in singles) <= 0.05 * len(singles), [one.claimed for one in singles if one.extra]


def test_nearly_all_are_named_first(outcomes: dict[str, Outcome]) -> None:
    singles = [one for one in outcomes.values() if one.kind == SINGLE]
    assert sum(one.first for one in singles) >= 0.9 * len(singles), [one.planted for one in singles if not one.first]


def test_both_of_a_pair_are_named(outcomes: dict[str, Outcome]) -> None:
    (pair,) = [one for one in outcomes.values() if one.kind == PAIR]
    assert set(pair.claimed) == set(pair.planted)


def test_physics_that_no_family_describes_gets_no_name(outcomes: dict[str, Outcome]) -> None:
    (unknown,) = [one for one in outcomes.values() if one.kind == FOREIGN]
    assert (unknown.verdict, unknown.claimed) == ("unknown", ())


def test_sizes_are_right_within_a_few_per_cent(outcomes: dict[str, Outcome]) -> None:
    errors = [size.error for one in outcomes.values() for size in one.sizes]
    assert len(errors) >= 20
    assert median(errors) <= 0.05  # the bar of the whole proof
