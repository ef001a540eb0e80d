"""Discrete mistakes: every sign, every exchange of two of a kind and every unit by name; ordinary faults are none."""

from collections.abc import Sequence
from dataclasses import replace
from itertools import combinations

import numpy as np
import pytest

from geometry.errors import CheckFailed
from identification.campaign import UNITS
from validation.diagnose.diagnosis import Cause
from validation.diagnose.mistakes import ChannelSource, LowFrequencyReadings, mistakes
from validation.effects.catalogue import Named, parse_all
from validation.effects.effect import COVER, FMD, TABLE
from validation.model.model import Added, Model
from validation.prediction.series import SeriesPrediction, predictions
from validation.study import Study
from validation.virtual_test.plan import Plan
from validation.virtual_test.planted import planted
from validation.virtual_test.simulate import simulate

MODEL = Model(source="model.toml", title="a laboratory", article="fmd+clumod-1", cell_stiffness=np.array((4e8, 4e8, 2e9)))
LINES = np.linspace(5.0, 10.0, 26)
CUBOID = "fmd+disc+cuboid"
CHANNELS = (*TABLE, *COVER, *FMD)


def made(*texts: str, name: str = "cuboid") -> SeriesPrediction:
    """A virtual test of an ordinary laboratory with these effects."""
    plan = Plan(article=CUBOID, model="rigid", seed=5, octaves_per_minute=60.0, quiet=0.3, ringing=1e-3)
    test = simulate(replace(plan, effects=planted(parse_all(texts))))
    (one,) = predictions(MODEL, [test.campaign], lines=LINES)
    return replace(one, tested=replace(one.tested, measured=replace(one.measured, name=name)))


@pytest.fixture(scope="module")
def right() -> SeriesPrediction:
    return made()


def bench(*made: SeriesPrediction, effects: Sequence[Named] = ()) -> Study:
    model = replace(MODEL, effects=tuple(Added(named=one, fixed=True) for one in effects))
    return Study(model=model, campaigns=tuple(one.tested.campaign for one in made), made=made)


def wrong(one: SeriesPrediction, *texts: str) -> SeriesPrediction:
    """Readings with these mistakes, one after the other."""
    values = np.array(one.measured.values)
    for named in parse_all(texts):
        at = [one.measured.channels.index(name) for name in named.targets]
        factor = -1.0 if named.family == "polarity" else named.value
        values[..., at] = values[..., at[::-1]] if named.family == "channel-swap" else factor * values[..., at]
    return replace(one, tested=replace(one.tested, measured=replace(one.measured, values=values)))


def ids(found: Sequence[Cause]) -> list[str]:
    return [one.id for one in found]


@pytest.mark.parametrize("channel", CHANNELS)
def test_every_sign_is_named(right, channel):
    assert ids(mistakes(bench(wrong(right, f"polarity:{channel}")))) == [f"polarity:{channel}"]


def _of_one_kind() -> list[str]:
    kinds: dict[str, list[str]] = {}
    for channel in CHANNELS:
        kinds.setdefault(channel[: channel.index("-") + 2], []).append(channel)
    return [f"channel-swap:{one}:{other}" for names in kinds.values() for one, other in combinations(names, 2)]


@pytest.mark.parametrize("swap", _of_one_kind())
def test_every_exchange_of_two_of_a_kind_is_named(right, swap):
    assert ids(mistakes(bench(wrong(right, swap)))) == [swap]


UNITS_OF = [
    *(("cover-z3", unit) for unit in UNITS["acceleration"] if unit != "m/s^2"),
    *(("fmd-x12", unit) for unit in UNITS["force"] if unit != "N"),
    ("table-y2", "g"),
    ("fmd-z4", "lbf"),
]


@pytest.mark.parametrize(("channel", "unit"), UNITS_OF)
def test_a_unit_is_named_as_one(right, channel, unit):
    (found,) = mistakes(bench(wrong(right, f"unit:{channel}={unit}")))
    quantity = UNITS["force" if channel.startswith("fmd") else "acceleration"]
    assert found.id == f"unit:{channel}"
    np.testing.assert_allclose(found.named.value, 1 / quantity[unit], rtol=1e-12)  # a unit has no tolerance
    assert f"in {unit}," in found.note


def test_a_factor_that_is_no_unit_has_an_interval(right):
    (found,) = mistakes(bench(wrong(right, "unit:cover-x1=5")))
    assert not found.note
    assert found.sizes[0].low < 5 < found.sizes[0].high


@pytest.mark.parametrize(
    "several",
    [
        ("polarity:cover-z1", "polarity:fmd-z2", "channel-swap:table-y1:table-y2", "unit:fmd-x12=lbf"),
        ("channel-swap:fmd-z1:fmd-z2", "channel-swap:fmd-z2:fmd-z3"),
        tuple(f"unit:{name}=kN" for name in FMD),
        tuple(f"unit:{name}=g" for name in (*TABLE, *COVER)),
        tuple(f"polarity:{name}" for name in FMD),
    ],
)
def test_several_at_once_are_undone_by_what_is_named(right, several):
    faulty = wrong(right, *several)
    found = mistakes(bench(faulty))
    assert len(found) == len(several)
    assert {one.named.family for one in found} == {one.partition(":")[0] for one in several}
    assert mistakes(bench(faulty, effects=[one.named for one in found])) == ()


ORDINARY = (
    "force-gain:fmd-z2=0.2",
    "accelerometer-gain:cover-z3=-0.2",
    "force-delay:fmd-x12=2e-3",
    "accelerometer-delay:table-z1=2e-3",
    "accelerometer-position:cover-x1:z=0.05",
    "accelerometer-misalignment:cover-y2:x=0.1",
    "cell-stiffness:1z=1",
)


def test_ordinary_laboratories_and_faults_are_no_mistakes_and_campaigns_that_contradict_are_refused(right):
    assert mistakes(bench(made(*ORDINARY))) == ()
    assert mistakes(bench(right)) == ()
    other = replace(right, tested=replace(right.tested, measured=replace(right.measured, name="again")))
    with pytest.raises(CheckFailed, match=r"in again fmd-z2 reads as expected times -1, in cuboid it is as the file says"):
        mistakes(bench(right, wrong(other, "polarity:fmd-z2")))


def test_a_reading_of_nothing_is_no_signal_times_nothing() -> None:
    """Of a test on two axes the pilot of one is not read along the other; warnings of 0/0 had reached the screen."""
    values, noise = np.array([[0.0, 8.7]] * 4, dtype=np.complex128), np.array([[1e6, 1e-2]] * 4)
    channels, quantities = ("pilot-x", "above"), ("acceleration",) * 2
    one = LowFrequencyReadings(
        name="z", channels=channels, quantities=quantities, lines=4, reading=values, expected=values, noise=noise, unsure=noise
    )
    with np.errstate(divide="raise", invalid="raise"):
        assert ChannelSource(channel=0, plug=1, factor=0.0, units=("", ""), gain=0.0).distance([one]) == 1.0
