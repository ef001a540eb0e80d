"""The benchmarks' ruler is straight: ratios come from the fastest of interleaved rounds."""

import json

import pytest
from numpy.testing import assert_allclose

from benchmarks.ratios import Timing, measure, ratios, show


class Clock:
    """A clock that advances only when a callable says so."""

    def __init__(self) -> None:
        self.now = 0.0

    def __call__(self) -> float:
        return self.now

    def spend(self, seconds: float) -> None:
        self.now += seconds


def test_the_ratio_is_that_of_the_fastest_rounds() -> None:
    clock, slow = Clock(), iter([9.0, 6.0, 7.0])
    timings = measure({"base": lambda: clock.spend(2.0), "slow": lambda: clock.spend(next(slow))}, rounds=3, clock=clock)
    assert_allclose(list(ratios(timings, "base").values()), [1.0, 3.0], rtol=1e-12)  # sums of small integers: rounding only
    assert timings["slow"].median == 7.0


def test_callables_take_turns_so_that_a_slow_spell_hits_all() -> None:
    order: list[str] = []
    measure({"a": lambda: order.append("a"), "b": lambda: order.append("b")}, rounds=2)
    assert order == ["a", "b", "a", "b"]


def test_an_unmeasured_base_and_no_round_are_refused_in_words() -> None:
    with pytest.raises(ValueError, match="`base` must be one of a, found 'b'"):
        ratios({"a": Timing(fastest=1.0, median=1.0)}, "b")
    with pytest.raises(ValueError, match="`rounds` must be at least 1, found 0"):
        measure({}, rounds=0)


def test_json_is_one_object_without_seconds(monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]) -> None:
    monkeypatch.setattr("sys.argv", ["bench", "--json"])
    show("t", {"a": Timing(fastest=2.0, median=3.0), "b": Timing(fastest=1.0, median=1.0)}, base="a", notes={"b": "exact"})
    assert json.loads(capsys.readouterr().out) == {
        "title": "t",
        "base": "a",
        "ratios": {"a": 1.0, "b": 0.5},
        "notes": {"b": "exact"},
    }
