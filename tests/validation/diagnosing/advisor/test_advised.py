"""Which test tells explanations apart: physics says which must, and fits of what the test reads say how surely."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import rotation_about
from validation.diagnose.candidates import aliases
from validation.diagnose.diagnosis import Candidate
from validation.diagnose.next_test import advised, following, imagined, told
from validation.diagnose.next_test_offers import OfferedTest, menu
from validation.diagnose.planned_test import SURE, Knowledge, Template, knowledge
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import INDISTINGUISHABLE_NATS
from validation.estimation.cost import cost_of
from validation.estimation.fit import FLOOR, direct, fitted
from validation.estimation.problem import FITTED, Problem
from validation.model.model import Added
from validation.prediction.series import SeriesPrediction
from validation.study import Study

Pair = tuple[Study, Candidate, Candidate]

OFFSET, SHIFT = "mounting-offset:x=0.01", "rigid-inertia:mx=0.1"
GAIN, CELL = "force-gain:fmd-z2=0.03", "cell-stiffness:2z=0.1"


@pytest.fixture(scope="module")
def aside(bench: Callable[..., Study], explained: Callable[..., Candidate]) -> Pair:
    """A Cuboid that stands 10 mm beside its place, or whose centre of gravity does."""
    data = bench(OFFSET, "fmd+cuboid")
    return data, explained(data, OFFSET), explained(data, SHIFT)


@pytest.fixture(scope="module")
def loud(bench: Callable[..., Study], explained: Callable[..., Candidate]) -> Pair:
    """A load-cell channel that reads 3 % too much, or whose cell is stiffer than the others."""
    data = bench(GAIN, "fmd+cuboid")
    return data, explained(data, GAIN), explained(data, CELL)


def known(of: Pair) -> tuple[Knowledge, Knowledge]:
    return knowledge(of[1]), knowledge(of[2])


def menu_of(of: Pair) -> dict[str, OfferedTest]:
    first, _ = known(of)
    effects = tuple(one for hypothesis in of[1:] for one in hypothesis.effects)
    return {one.words: one for one in menu([Template.of(one, first) for one in of[0].made], effects, of[0].facts(()))}


def test_an_offset_and_a_shifted_centre_of_gravity_are_one_to_the_data_and_turning_tells_them_apart(aside: Pair) -> None:
    _, offset, shift = aside
    assert "rigid-inertia:mx" in aliases(offset, offset.effects[0], [*shift.effects, loud_one()])
    told_by = {words: told(one, *split(aside))[0] for words, one in menu_of(aside).items()}
    assert told_by["Run the Cuboid turned by 180 degrees about z"] > 10 * INDISTINGUISHABLE_NATS
    assert told_by["Find the centre of gravity of the Cuboid on the crane"] > 5 * INDISTINGUISHABLE_NATS
    assert told_by["Weigh the Cuboid"] < 1e-6
    assert told_by["Run the Cuboid with 4 more accelerometers on the cover plate"] < 1.0  # more of the same
    assert "Run the Cuboid" not in told_by  # it was run


def loud_one() -> Added:
    return Added(named=parse(GAIN))


def split(of: Pair) -> tuple[Knowledge, list[Knowledge]]:
    first, other = known(of)
    return first, [other]


def test_a_hypothesis_is_told_by_nothing_from_itself(aside: Pair) -> None:
    first, _ = known(aside)
    for words, one in menu_of(aside).items():
        assert_allclose(told(one, first, [first])[0], 0.0, atol=1e-9, err_msg=words)


def test_a_turned_test_gives_what_was_expected_of_it(aside: Pair, measure: Callable[..., SeriesPrediction]) -> None:
    turned = measure("fmd+cuboid", aside[1].effects, turned=rotation_about("z", np.pi))
    expected = followed(aside, "Run the Cuboid turned by 180 degrees about z")
    assert_allclose(expected, obtained(aside, turned), rtol=0.1)  # by the effect as found, not as planted: within its interval


def test_the_fmd_alone_gives_what_was_expected_of_it(loud: Pair, measure: Callable[..., SeriesPrediction]) -> None:
    gained = obtained(loud, measure("fmd", loud[1].effects))
    assert_allclose(followed(loud, "Run the FMD alone"), gained, rtol=0.3)  # Occam's share of a nat or two is not forecast


def followed(of: Pair, words: str) -> float:
    offer = menu_of(of)[words]
    assert offer.test is not None
    return following(offer.test, offer, *known(of))


def obtained(of: Pair, new: SeriesPrediction) -> float:
    """Nats by which the evidence for the first grows when the test is done, by fits of all data together."""
    both = of[1:]
    fits = []
    for one in both:
        made = replace(new, effects=one.effects, tested=replace(new.tested, measured=replace(new.measured, name="new")))
        cost = cost_of(problem := Problem((*one.problem.predictions, made)), problem.free(FITTED), FLOOR)
        fits.append(fitted(direct(cost, {**problem.start, **one.fit.by_name}, lambda share: None)))
    before = both[0].fit.log_evidence - both[1].fit.log_evidence
    return fits[0].log_evidence - fits[1].log_evidence - before


def test_a_straight_line_is_what_a_fit_finds_where_the_model_is_straight(loud: Pair) -> None:
    first, other = known(loud)
    sure = replace(other, log_evidence=first.log_evidence - SURE)
    line = told(menu_of(loud)["Run the FMD alone"], first, [sure])[0]
    assert_allclose(followed(loud, "Run the FMD alone"), line, rtol=0.1)  # a gain multiplies, an inertia adds


def test_the_best_of_the_menu_is_advised_and_the_work_is_told(aside: Pair) -> None:
    shares: list[float] = []
    found = advised(aside[0], aside[1:], shares.append)
    assert found[0].separates == ("mounting-offset:x", "rigid-inertia:mx")
    assert all(one.gain >= INDISTINGUISHABLE_NATS for one in found)
    assert shares == sorted(shares)
    assert 0 < shares[0] < shares[-1] <= 1
    assert "between mounting-offset:x and rigid-inertia:mx" in found[0].text


def test_a_single_explanation_is_confirmed_against_nothing_and_what_it_looks_like(
    loud: Pair, explained: Callable[..., Candidate]
) -> None:
    nothing, lookalike = imagined(loud[0], loud[1])
    assert nothing.id == "nothing"
    assert lookalike.id.partition(":")[0] in FAMILIES["force-gain"].mistaken_for
    refused = explained(loud[0], "").fit
    assert_allclose(nothing.known.log_evidence, refused.log_evidence, atol=4.0)  # but for the determinant, which nobody asks
    assert_allclose(nothing.known.offsets["force-gain:fmd-z2"], refused.by_name["force-gain:fmd-z2"], rtol=0.05)
    assert advised(loud[0], loud[1:2])[0].separates[:2] == ("force-gain:fmd-z2", "nothing")


def test_where_nothing_helps_that_is_said_with_what_would(
    bench: Callable[..., Study], explained: Callable[..., Candidate]
) -> None:
    data = bench("", "fmd")
    pair = [explained(data, text) for text in ("force-gain:fmd-z1=0", "force-gain:fmd-z2=0")]
    (only,) = advised(data, pair)
    assert only.gain == 0
    assert only.separates == ()
    assert "no test of the menu" in only.test
    assert "calibration mass" in only.test
