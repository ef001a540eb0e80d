"""The score counts what it says it counts, and the page holds what it prints."""

import re

import pytest
from click.testing import CliRunner

from benchmarks.blind import __main__ as drawing
from benchmarks.blind.drawing.case import FOREIGN, LEFT_OUT, NULL, PAIR, SINGLE
from benchmarks.blind.drawing.draw import COUNTS, draw
from benchmarks.blind.drawing.foreign import FOREIGN as PHYSICS
from benchmarks.blind.drawing.limits import STUDY
from benchmarks.blind.names import Json
from benchmarks.blind.score import __main__ as scoring
from benchmarks.blind.score import page
from benchmarks.blind.score.families import by_family
from benchmarks.blind.score.line import line
from benchmarks.blind.score.outcome import Outcome, outcome
from benchmarks.blind.score.rates import Rate
from benchmarks.blind.score.rows import Row, rows

GAIN = "force-gain:fmd-z2"


def truth(kind: str = "singles", *planted: str, number: int = 0, multiple: float = 5.0, told: float = 5.0) -> Json:
    ids = [{"id": id, "sizes": {"": 0.1}, "multiple": multiple, "told": told} for id in planted]
    return {"name": f"{kind}-{number:03d}", "kind": kind, "null": f"nulls-{number:03d}", "planted": ids}


def answer(
    verdict: str, *claims: str, alike: tuple[str, ...] = (), value: float = 0.1, misfit: float = 1.0, left: float = 1.0
) -> Json:
    accepted = [_claim(id, value) for id in claims]
    return {
        "verdict": verdict,
        "accepted": accepted,
        "ranking": accepted,
        "equivalence_class": list(alike or claims[:1]),
        "before": {"fitted": {"chi2_per_dof": misfit, "tolerance_z2": 100.0, "tolerances": 150}},
        "after": {"fitted": {"chi2_per_dof": misfit, "tolerance_z2": 100.0, "tolerances": 150}},
        "errors": {"heldout_before_percent": 2.0, "heldout_after_percent": left},
        "seconds": {"reading": 2.0, "diagnosis": 6.0},
    }


def _claim(id: str, value: float) -> Json:
    return {"id": id, "evidence_nats": 50.0, "values": [{"key": "", "value": value, "interval90": [value - 0.01, value + 0.01]}]}


def row(outcomes: list[Outcome], what: str) -> Row:
    (found,) = [one for one in rows(outcomes) if what in one.what]
    return found


def scored(*pairs: tuple[Json, Json]) -> list[Outcome]:
    return [outcome(one, other) for one, other in pairs]


BOTH, SHUNT = (GAIN, "modulus:mast"), "load-path-shunt:z"


@pytest.mark.parametrize(
    ("given", "claimed", "first", "inside"),
    [
        (answer("missing", GAIN), (GAIN,), True, True),
        (answer("ambiguous", SHUNT, alike=(SHUNT, GAIN)), (SHUNT,), False, True),
        (answer("ambiguous", alike=(GAIN, "unit:fmd-z2")), (GAIN,), True, True),  # the first of a class of which none is accepted
        (answer("nothing"), (), False, False),
        (answer("unknown"), (), False, False),
    ],
)
def test_a_right_claim_is_the_first_or_in_the_class_of_the_first(given, claimed, first, inside):
    one = outcome(truth("singles", GAIN), given)
    assert (one.claimed, one.first, one.inside, one.extra) == (claimed, first, inside, False)


def test_a_swap_is_the_same_either_way_and_more_claims_than_effects_are_extra():
    one = outcome(truth("singles", "channel-swap:fmd-z1:fmd-z2"), answer("mistake", "channel-swap:fmd-z2:fmd-z1"))
    assert one.first
    assert outcome(truth("singles", GAIN), answer("several", GAIN, "modulus:mast")).extra
    pair = outcome(truth("pairs", *BOTH), answer("several", *reversed(BOTH)))
    assert not pair.extra
    assert row([pair], "both of a pair").figure.startswith("1 of 1")


def test_a_wrong_claim_is_one_beside_a_right_one_and_in_place_of_it_but_not_in_a_class_that_holds_the_truth():
    outcomes = scored(
        (truth("singles", GAIN), answer("missing", SHUNT)),
        (truth("pairs", *BOTH, number=1), answer("several", GAIN, SHUNT)),
        (truth("singles", GAIN, number=2), answer("ambiguous", SHUNT, alike=(SHUNT, GAIN))),
        (truth("pairs", *BOTH, number=3), answer("missing", GAIN)),
    )
    assert [one.stray for one in outcomes] == [True, True, False, False]
    assert not any(one.extra for one in outcomes)
    assert outcomes[0].sizes == ()  # those of wrong claims are nobody's
    assert row(outcomes, "both of a pair").figure.startswith("0 of 2")
    assert row(outcomes, "a claim that is wrong").figure.startswith("2 of 4")


def test_a_refusal_and_a_breakdown_name_nothing_and_are_counted():
    outcomes = scored(
        (truth("singles", GAIN), {"refused": "CheckFailed: no"}), (truth("singles", GAIN, number=1), {"broken": "no"})
    )
    assert [one.first for one in outcomes] == [False, False]
    assert row(outcomes, "named first, at").figure.startswith("0 of 2")
    assert row(outcomes, "refuses").figure.startswith("2 of 2")
    assert row(outcomes, "refuses").met is False


def test_sizes_are_held_against_the_truth():
    outcomes = scored(
        (truth("singles", GAIN), answer("missing", GAIN, value=0.105)),
        (truth("singles", GAIN, number=1), answer("missing", GAIN, value=0.13)),
    )
    assert [size.error for one in outcomes for size in one.sizes] == pytest.approx([0.05, 0.3])
    assert [size.inside for one in outcomes for size in one.sizes] == [True, False]
    assert row(outcomes, "median error").figure == "17.5 %"
    assert row(outcomes, "median error").met is False


@pytest.mark.parametrize(("loud", "met"), [(2, True), (3, False)])
def test_two_false_alarms_of_two_hundred_are_met_and_three_are_not(loud, met):
    """One is anything but nothing on a null; what was refused was not answered."""
    given = (
        [answer("missing", GAIN)] * (loud - 1) + [answer("unknown")] + [answer("nothing")] * (200 - loud) + [{"refused": "no"}]
    )
    found = row([outcome(truth("nulls", number=k), one) for k, one in enumerate(given)], "false alarms")
    assert found.figure.startswith(f"{loud} of 200")
    assert found.figure.endswith("1 of them without a name")
    assert found.met is met


def test_what_tolerances_hide_is_told_apart():
    outcomes = scored(
        (truth("singles", GAIN, multiple=2.0, told=0.6), answer("nothing")),
        (truth("singles", GAIN, number=1), answer("missing", GAIN)),
        (truth("singles", GAIN, number=2, multiple=1.0), answer("nothing")),  # below twice its limit it is not asked for
    )
    assert row(outcomes, "named first, at").figure.startswith("1 of 2")
    assert row(outcomes, "tolerances hide").figure.startswith("1 of 1")
    assert row(outcomes, "· at 2 times").figure.startswith("0 of 1")


def test_unknown_physics_counts_where_it_leaves_a_fifth_more_than_its_null():
    nulls = [(truth("nulls", number=k), answer("nothing", misfit=1.0)) for k in range(4)]
    outcomes = scored(
        *nulls,
        (truth("left-out", GAIN, number=0), answer("unknown", misfit=1.3)),
        (truth("left-out", GAIN, number=1), answer("missing", "modulus:mast", misfit=1.5)),
        (truth("left-out", GAIN, number=2), answer("missing", "modulus:mast", misfit=1.1)),
        (truth("foreign", "unknown-strain:cover-z1", number=3), answer("unknown", misfit=5.0)),
    )
    assert row(outcomes, "unknown physics").figure.startswith("2 of 3")
    assert row(outcomes, "left out of the catalogue").figure.startswith("1 of 2")
    assert row(outcomes, "in no catalogue").figure.startswith("1 of 1")
    assert row(outcomes, "wrong name there").figure.startswith("1 of 3")
    assert row(outcomes, "where less is left").figure.startswith("1 of 1")


@pytest.mark.parametrize(
    ("null", "given"),
    [
        (answer("nothing"), {"refused": "CheckFailed: no"}),
        (answer("nothing"), {"broken": "no"}),
        ({"refused": "no"}, answer("missing", SHUNT)),
    ],
)
def test_unknown_physics_that_is_refused_or_whose_null_is_counts_as_a_miss(null, given):
    outcomes = scored((truth("nulls"), null), (truth("foreign", "unknown-strain:cover-z1"), given))
    assert row(outcomes, "unknown physics").figure.startswith("0 of 1")
    assert row(outcomes, "in no catalogue").figure.startswith("0 of 1")
    assert row(outcomes, "where less is left").figure == "none yet"


def test_held_out_errors_are_held_against_the_null_of_the_same_laboratory():
    outcomes = scored(
        (truth("nulls", number=1), answer("nothing", left=0.5)),
        (truth("nulls", number=2), answer("nothing", left=1.0)),
        (truth("singles", GAIN, number=1), answer("missing", GAIN, left=0.6)),
        (truth("singles", GAIN, number=2), answer("missing", GAIN, left=3.0)),
        (truth("singles", GAIN, number=3), answer("missing", GAIN, left=3.0)),
    )
    found = row(outcomes, "plain error after")
    assert found.figure.startswith("2.10; within 1.3 in 1 of 2")
    assert found.met is False


def test_classes_are_measured_by_their_median_and_their_largest():
    alike = tuple(f"modulus:{k}" for k in range(9))
    outcomes = scored(
        *((truth("singles", GAIN, number=k), answer("missing", GAIN)) for k in range(9)),
        (truth("singles", GAIN, number=9), answer("ambiguous", GAIN, alike=(GAIN, *alike))),
    )
    assert row(outcomes, "size of that class").figure == "median 1, 90th percentile 1.9"


def test_a_time_belongs_to_the_screen_its_ratio_to_the_page_and_nothing_is_met_while_nothing_is_counted():
    outcomes = scored((truth("nulls"), answer("nothing")))
    assert row(outcomes, "over that of reading").figure == "3.0"
    (private,) = [one for one in rows(outcomes) if one.private]
    assert private.figure == "6.0 s"
    assert "6.0 s" not in page.text(rows(outcomes), by_family(outcomes), "")
    assert [one.met for one in rows([]) if one.bar] == [None] * sum(bool(one.bar) for one in rows([]))


def test_a_family_says_what_was_claimed_instead():
    (found,) = by_family(
        scored(
            (truth("singles", GAIN), answer("missing", GAIN)),
            (truth("singles", GAIN, number=1), answer("missing", "modulus:mast")),
            (truth("singles", GAIN, number=2), answer("nothing")),
            (truth("singles", GAIN, number=3), {"refused": "no"}),
        )
    )
    assert (found.family, found.first, found.instead) == ("force-gain", Rate(hits=1, count=4), "modulus:mast, nothing, refused")


def test_an_interval_of_clopper_and_pearson_leaves_its_tail_at_both_ends_and_of_none_and_all_at_one():
    from scipy.stats import binom

    low, high = Rate(hits=7, count=50).interval
    assert binom.sf(6, 50, low) == pytest.approx(0.025)
    assert binom.cdf(7, 50, high) == pytest.approx(0.025)
    assert Rate(hits=0, count=10).interval == (0.0, pytest.approx(1 - 0.025 ** (1 / 10)))
    assert Rate(hits=10, count=10).interval == (pytest.approx(0.025 ** (1 / 10)), 1.0)
    assert Rate(hits=0, count=0).interval == (0.0, 1.0)


def test_a_line_tells_truth_and_answer():
    told = line(truth("singles", GAIN), answer("missing", GAIN))
    assert "force-gain:fmd-z2=0.1" in told
    assert "MISSING" in told
    assert "no such thing" in line(truth("singles", GAIN), {"broken": "no such thing"})


def test_the_score_goes_between_the_markers_of_the_page_and_nowhere_else(tmp_path):
    file = tmp_path / "page.md"
    begin, end = "<!-- score: begin -->", "<!-- score: end -->"
    file.write_text(f"before\n{begin}\nold\n{end}\nafter\n", encoding="utf-8")
    page.write("new", file)
    assert file.read_text(encoding="utf-8") == f"before\n{begin}\nnew\n{end}\nafter\n"
    file.write_text("without", encoding="utf-8")
    with pytest.raises(ValueError, match="must hold"):
        page.write("new", file)


def ranked(first: float, second: float) -> Json:
    """A gain was planted and ranks second; each with its evidence [nats]."""
    found = answer("ambiguous", "load-path-shunt:z", alike=("load-path-shunt:z", GAIN))
    ranking = [{**_claim("load-path-shunt:z", 0.1), "evidence_nats": first}, {**_claim(GAIN, 0.1), "evidence_nats": second}]
    return {**found, "ranking": ranking}


@pytest.mark.parametrize(("behind", "tied"), [(0.2, "1 of 1"), (1.5, "0 of 1")])
def test_what_is_less_than_a_nat_behind_the_first_is_tied_with_it(behind, tied):
    outcomes = scored((truth("singles", GAIN), ranked(50.0, 50.0 - behind)))
    assert row(outcomes, "named first, at 2 times").figure.startswith("0 of 1")
    assert row(outcomes, "not more than 1 nat").figure.startswith(tied)


def test_nothing_is_tied_with_a_claim_of_another_round_and_a_factor_counts_from_one():
    found = {**ranked(50.0, 49.5), "accepted": [_claim("force-delay:fmd-z1", 0.1)]}
    assert row(scored((truth("singles", GAIN), found)), "not more than 1 nat").figure.startswith("0 of 1")
    planted = truth("singles", "fmd-compliance:lateral")
    planted["planted"][0]["sizes"] = {"": 1.05}
    assert outcome(planted, answer("nothing")).size == pytest.approx(0.05)


@pytest.mark.parametrize(("said", "count"), [(0.04, "0 of 1"), (0.06, "none yet"), (None, "none yet")])
def test_what_the_null_said_that_it_would_name_is_asked_for(said, count):
    """0.1 was planted, and missed: twice 0.04 is less than that, twice 0.06 more."""
    null = {**answer("nothing"), "detectable": [] if said is None else [{"id": GAIN, "size": said}]}
    outcomes = scored((truth("singles", GAIN), answer("nothing")), (truth("nulls"), null))
    assert row(outcomes, "of its null said").figure.startswith(count)


@pytest.fixture(scope="module")
def text(root) -> str:
    return (root / page.PAGE).read_text(encoding="utf-8")


def test_the_score_has_its_place_and_every_physics_that_no_family_describes_is_told(text):
    for which in (page.SCORE, page.STRUCTURES):
        begin, end = (f"<!-- {which}: {side} -->" for side in ("begin", "end"))
        assert text.count(begin) == text.count(end) == 1
        assert text.index(begin) < text.index(end)
    (told,) = re.findall(r"^The physics that no family describes: (.*?)\n\n", text, re.MULTILINE | re.DOTALL)
    assert len(told.split(",")) == len(PHYSICS)


def test_the_kinds_their_numbers_and_the_limits_of_the_study_are_told_as_they_are(text):
    stated = dict(re.findall(r"^\| ([a-z-]+) \| .* \| (?:about )?(\d+) \|$", text, re.MULTILINE))
    assert {kind: int(stated[kind]) for kind in (NULL, PAIR, LEFT_OUT, FOREIGN)} == {
        kind: COUNTS[kind] for kind in (NULL, PAIR, LEFT_OUT, FOREIGN)
    }
    assert abs(len(draw(1, (SINGLE,))) - int(stated[SINGLE])) <= 5
    for figure, size in {
        "1.5 %": 0.015,
        "0.1 kg": 0.1,
        "100 µs": 100e-6,
        "3.5 %": 0.035,
        "2.5 mm": 2.5e-3,
        "10 g": 0.010,
    }.items():
        assert figure in text
        assert size in STUDY.values()


@pytest.mark.parametrize(("module", "command"), [("benchmarks.blind", drawing.main), ("benchmarks.blind.score", scoring.main)])
def test_the_commands_of_the_page_know_the_options_that_stand_there(module, command, text):
    (typed,) = re.findall(rf"^python -m {module} (--.*)$", text, re.MULTILINE)
    helped = CliRunner().invoke(command, ["--help"]).output
    assert all(option in helped for option in re.findall(r"--[a-z]+", typed))


def test_make_blind_runs_both(root):
    (recipe,) = re.findall(r"^blind:.*?\n((?:\t.*\n)+)", (root / "Makefile").read_text(encoding="utf-8"), re.MULTILINE)
    assert "benchmarks.blind $(ARGS)" in recipe
    assert "benchmarks.blind.score" in recipe
