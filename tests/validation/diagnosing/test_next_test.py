"""Which test tells explanations apart: physics says which must, and fits of what the test reads say how surely."""

from collections.abc import Sequence
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.articles import locations
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.frames import Pose, rotation_about
from identification.campaign import Campaign, Recording, Run
from identification.self_calibration.solve import Normal
from validation.diagnose import next_test_offers
from validation.diagnose.candidates import aliases
from validation.diagnose.diagnosis import Candidate
from validation.diagnose.next_test import _whitening, advised, either, following, imagined, nats, told
from validation.diagnose.next_test_offers import SURE, Knowledge, OfferedTest, Origin, Template, knowledge, menu
from validation.effects.catalogue import FAMILIES, parse
from validation.effects.effect import INDISTINGUISHABLE_NATS
from validation.estimation.fit import FLOOR, direct, fitted
from validation.estimation.likelihood import cost_of, root
from validation.estimation.problem import EFFECT, FITTED, Parameter, Problem
from validation.model.model import RIGID, Added, Model
from validation.prediction.series import SeriesPrediction, predictions
from validation.study import Study
from validation.virtual_test.layout import mavis
from validation.virtual_test.plan import NOISE, Plan
from validation.virtual_test.shaker import middles_of_cells

# A rigid Cuboid on the FMD, measured at few lines: readings by the model itself, an effect in it, and noise that is known.


LINES = np.linspace(4.0, 32.0, 15)
SEAT = Pose(position=np.array([0.0, 0.0, 0.0445]))
NOISY = {"acceleration": 1e-3, "force": 0.05}


def model() -> Model:
    return Model(source="tests", title="tests", article="fmd+cuboid", kind=RIGID, cell_stiffness=np.array([4e8, 4e8, 2e9]))


def campaign(article: str, turned: np.ndarray | None = None) -> Campaign:
    """Six sweeps of one axis each, which nobody has read yet."""
    table = mavis(middles_of_cells(Plan(article="fmd")), NOISE).table
    names = tuple(one.name for one in table.channels)
    unread = np.ones((len(LINES), len(names)), dtype=np.complex128)
    pose = SEAT if turned is None else replace(SEAT, rotation=turned)
    return Campaign(
        title=article,
        article=article,
        hardware="one",
        table=table,
        runs=tuple(Run(name=axis, file=f"{axis}.h5", axis=axis) for axis in MOTIONS),
        recordings={axis: Recording(names=names, values=unread, frequency=LINES) for axis in MOTIONS},
        mounting=pose if article != "fmd" else None,
    )


def inputs() -> np.ndarray:
    """(r, n, 6): every run drives its own axis, and the others by a hundredth."""
    levels = np.array([LEVELS[axis] for axis in MOTIONS])
    cross = 0.01 * np.ones((6, 6)) + np.eye(6)
    return np.asarray(np.broadcast_to((cross * levels)[:, None, :], (6, len(LINES), 6)), dtype=np.complex128)


def measure(
    article: str, effects: Sequence[Added] = (), seed: int | None = None, turned: np.ndarray | None = None
) -> SeriesPrediction:
    """The campaign with what its channels read; without a seed free of noise."""
    of = model()
    (made,) = predictions(of, [campaign(article, turned)], lines=LINES)
    rows = made.with_effects(effects).at({one.name: one.start for one in made.with_effects(effects).parameters}).rows
    values = np.einsum("nck,rnk->rnc", rows, inputs())
    quantity = {one.name: one.quantity for one in made.tested.campaign.table.channels}
    noise = np.broadcast_to([NOISY[quantity[name]] for name in made.measured.channels], values.shape)
    if seed is not None:
        rng = np.random.default_rng(seed)
        spread = noise / np.sqrt(2)
        values = values + spread * (rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape))
    read = replace(made.measured, values=values, noise=np.array(noise))
    return replace(made, tested=replace(made.tested, measured=read))


def added(text: str) -> Added:
    return Added(named=parse(text))


def bench(planted: str, *articles: str, seed: int = 3) -> Study:
    """The data of these articles with an effect planted in them."""
    made = [measure(one, (added(planted),) if planted else (), seed) for one in articles]
    read = [replace(one.measured, name=name) for one, name in zip(made, articles, strict=True)]
    called = [replace(one, tested=replace(one.tested, measured=of)) for one, of in zip(made, read, strict=True)]
    return Study(model=model(), campaigns=tuple(one.tested.campaign for one in called), made=tuple(called))


def explained(of: Study, text: str) -> Candidate:
    """The fit of all tolerances and of the effect that `text` names."""
    effects = (added(text),) if text else ()
    problem = of.problem(effects)
    cost = cost_of(problem, problem.free(FITTED), FLOOR)
    found = fitted(direct(cost, problem.start, lambda share: None))  # the planted size is near enough
    return Candidate(effects=effects, fit=found, problem=problem)


@pytest.fixture
def rng() -> np.random.Generator:
    return np.random.default_rng(5)


def normal(d: np.ndarray, J: np.ndarray) -> Normal:
    return Normal(cost=0.5 * float(d @ d), gradient=J.T @ d, matrix=J.T @ J)


def test_the_forecast_is_the_quadratic_form_written_out_and_what_is_not_known_takes_up_its_own(rng):
    J, L, d = rng.standard_normal((40, 6)), rng.standard_normal((6, 4)), rng.standard_normal(40)
    S = np.eye(40) + J @ L @ L.T @ J.T
    assert_allclose(nats(normal(d, J), L), 0.5 * d @ np.linalg.solve(S, d), rtol=1e-10)
    assert_allclose(nats(normal(2 * d, J), L), 4 * nats(normal(d, J), L), rtol=1e-10)
    J = rng.standard_normal((40, 6))
    d = J @ rng.standard_normal(6)
    assert_allclose(nats(normal(d, J), np.zeros((6, 0))), 0.5 * d @ d, rtol=1e-12)
    assert nats(normal(d, J), 1e4 * np.eye(6)) < 1e-6  # half of |z|², and |z| is of the size of 1e-4


def test_a_root_of_a_covariance_gives_it_back_whatever_the_units(rng):
    A = rng.standard_normal((5, 5)) * np.array([1e-6, 1.0, 1e5, 1e-3, 0.0])[:, None]
    C = A @ A.T
    assert_allclose(root(C) @ root(C).T, C, rtol=1e-9, atol=1e-12 * np.sqrt(np.outer(np.diag(C), np.diag(C))).max())
    W = _whitening(root(C)[:4])
    assert_allclose(W @ C[:4, :4] @ W.T, np.eye(4), atol=1e-6)


def test_what_is_plain_in_one_case_alone_is_not_expected_and_odds_follow_from_evidence():
    assert_allclose(either(1.0, 7.0, 1e6), 7.0)
    assert_allclose(either(0.5, 4.0, 9.0), 6.0)
    assert either(0.99, 1.0, 1e4) < 1.1  # where the mean would say a hundred
    one, other = known(), replace(known(), log_evidence=np.log(3.0))
    assert_allclose(other.odds(one), 0.75)
    assert_allclose(one.odds(replace(one, log_evidence=-1e6)), 1.0)


def parameter(name: str, tolerance: float, kind: str = "sensor") -> Parameter:
    return Parameter(name=name, unit="1", tolerance=tolerance, kind=kind)


def known() -> Knowledge:
    C = np.array([[4.0, 1.0], [1.0, 9.0]])
    return Knowledge(effects=(), offsets={"a": 1.0, "b": 2.0}, names=("a", "b"), root=root(C), log_evidence=0.0)


def test_exchanged_sensors_take_along_what_is_known_and_half_of_an_effect_is_half_as_uncertain():
    moved = {"a": Origin(name="b"), "b": Origin(name="a")}
    L = known().spread([parameter("a", 0.3), parameter("b", 0.3)], moved)
    assert_allclose(L @ L.T, [[9.0, 1.0], [1.0, 4.0]], atol=1e-12)
    assert known().at(moved) == {"a": 2.0, "b": 1.0}
    L = known().spread([parameter("a", 0.3)], {"a": Origin(name="a", factor=0.5)})
    assert_allclose(L @ L.T, [[1.0]], atol=1e-12)
    assert_allclose(known().at({"a": Origin(name="a", factor=0.5)})["a"], 0.5)


def test_what_is_drawn_anew_is_known_as_beforehand_and_an_effect_that_is_not_there_is_known_not_to_be():
    every = [parameter("a", 0.3), parameter("new", 0.5), parameter("effect", 7.0, EFFECT)]
    L = known().spread(every, {"a": Origin()})
    assert_allclose(L @ L.T, np.diag([0.09, 0.25, 0.0]), atol=1e-12)


Pair = tuple[Study, Candidate, Candidate]

OFFSET, SHIFT = "mounting-offset:x=0.01", "rigid-inertia:mx=0.1"
GAIN, CELL = "force-gain:fmd-z2=0.03", "cell-stiffness:2z=0.1"


@pytest.fixture(scope="module")
def aside() -> Pair:
    """A Cuboid that stands 10 mm beside its place, or whose centre of gravity does."""
    data = bench(OFFSET, "fmd+cuboid")
    return data, explained(data, OFFSET), explained(data, SHIFT)


@pytest.fixture(scope="module")
def loud() -> Pair:
    """A load-cell channel that reads 3 % too much, or whose cell is stiffer than the others."""
    data = bench(GAIN, "fmd+cuboid")
    return data, explained(data, GAIN), explained(data, CELL)


def both_known(of: Pair) -> tuple[Knowledge, Knowledge]:
    return knowledge(of[1]), knowledge(of[2])


def menu_of(of: Pair) -> dict[str, OfferedTest]:
    first, _ = both_known(of)
    effects = tuple(one for hypothesis in of[1:] for one in hypothesis.effects)
    return {one.words: one for one in menu([Template.of(one, first) for one in of[0].made], effects, of[0].facts(()))}


def test_an_offset_and_a_shifted_centre_of_gravity_are_one_to_the_data_and_turning_tells_them_apart(aside):
    _, offset, shift = aside
    first, other = both_known(aside)
    assert "rigid-inertia:mx" in aliases(offset, offset.effects[0], [*shift.effects, added(GAIN)], limit=1e-3)
    told_by = {words: told(one, first, [other])[0] for words, one in menu_of(aside).items()}
    assert told_by["Run the Cuboid turned by 180 degrees about z"] > 10 * INDISTINGUISHABLE_NATS
    assert told_by["Find the centre of gravity of the Cuboid on the crane"] > 5 * INDISTINGUISHABLE_NATS
    assert told_by["Weigh the Cuboid"] < 1e-6
    assert told_by["Run the Cuboid with 4 more accelerometers on the cover plate"] < 1.0  # more of the same
    assert "Run the Cuboid" not in told_by  # it was run


def test_what_was_weighed_is_not_offered_again(aside):
    offered = menu_of(aside)
    templates = [Template.of(one, both_known(aside)[0]) for one in aside[0].made]
    again = {one.words for one in menu(templates, (), offered["Weigh the Cuboid"].numbers)}
    assert "Weigh the Cuboid" not in again
    assert "Find the centre of gravity of the Cuboid on the crane" in again


def test_a_place_that_the_drawing_has_not_is_offered_no_mass(aside, monkeypatch):
    """Of a user's own article that is called as a built-in one."""
    there = next_test_offers.locations("cuboid")
    known = sorted(aside[0].made[0].tested.carried.standing.there.places)
    monkeypatch.setattr(
        next_test_offers,
        "locations",
        lambda name, *changes: {place: there[place] for place in known[1:]} if name == "cuboid" else locations(name),
    )
    offered = menu_of(aside)
    assert any("kg more at " in words for words in offered)
    assert not any(words.endswith(f"more at {known[0]}") for words in offered)


@pytest.mark.proof  # a test and its fit; the FMD alone below gives what was expected, too
def test_a_turned_test_gives_what_was_expected_of_it_and_tells_a_hypothesis_by_nothing_from_itself(aside):
    first, _ = both_known(aside)
    for words, one in menu_of(aside).items():
        assert_allclose(told(one, first, [first])[0], 0.0, atol=1e-9, err_msg=words)
    turned = measure("fmd+cuboid", aside[1].effects, turned=rotation_about("z", np.pi))
    expected = followed(aside, "Run the Cuboid turned by 180 degrees about z")
    assert_allclose(expected, obtained(aside, turned), rtol=0.1)  # by the effect as found, not as planted: within its interval


def test_the_fmd_alone_gives_what_was_expected_of_it(loud):
    gained = obtained(loud, measure("fmd", loud[1].effects))
    assert_allclose(followed(loud, "Run the FMD alone"), gained, rtol=0.3)  # Occam's share of a nat or two is not forecast


def followed(of: Pair, words: str) -> float:
    offer = menu_of(of)[words]
    assert offer.test is not None
    return following(offer.test, offer, *both_known(of))


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


def test_a_straight_line_is_what_a_fit_finds_where_the_model_is_straight(loud):
    first, other = both_known(loud)
    sure = replace(other, log_evidence=first.log_evidence - SURE)
    line = told(menu_of(loud)["Run the FMD alone"], first, [sure])[0]
    assert_allclose(followed(loud, "Run the FMD alone"), line, rtol=0.1)  # a gain multiplies, an inertia adds


def test_the_best_of_the_menu_is_advised_and_the_work_is_told(aside):
    shares: list[float] = []
    found = advised(aside[0], aside[1:], shares.append)
    assert found[0].separates == ("mounting-offset:x", "rigid-inertia:mx")
    assert all(one.gain >= INDISTINGUISHABLE_NATS for one in found)
    assert shares == sorted(shares)
    assert 0 < shares[0] < shares[-1] <= 1
    assert "between mounting-offset:x and rigid-inertia:mx" in found[0].text


def test_a_single_explanation_is_confirmed_against_nothing_and_what_it_looks_like(loud):
    nothing, lookalike = imagined(loud[0], loud[1])
    assert nothing.id == "nothing"
    assert lookalike.id.partition(":")[0] in FAMILIES["force-gain"].mistaken_for
    refused = explained(loud[0], "").fit
    assert_allclose(nothing.known.log_evidence, refused.log_evidence, atol=4.0)  # but for the determinant, which nobody asks
    assert_allclose(nothing.known.offsets["force-gain:fmd-z2"], refused.by_name["force-gain:fmd-z2"], rtol=0.05)
    assert advised(loud[0], loud[1:2])[0].separates[:2] == ("force-gain:fmd-z2", "nothing")


def test_where_nothing_helps_that_is_said_with_what_would():
    data = bench("", "fmd")
    pair = [explained(data, text) for text in ("force-gain:fmd-z1=0", "force-gain:fmd-z2=0")]
    (only,) = advised(data, pair)
    assert only.gain == 0
    assert only.separates == ()
    assert "no test of the menu" in only.test
    assert "a known mass" in only.test
