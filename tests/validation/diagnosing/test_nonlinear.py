"""Two levels of one axis: linear ones answer alike whatever the model says, and what does not is named with its kind and size."""

from dataclasses import replace

import numpy as np
import pytest

from geometry.errors import BadInput
from geometry.frames import Array
from identification.campaign import Recording
from validation.diagnose.nonlinear import differing_levels, distorted_runs, nonlinear, require_levels
from validation.effects.catalogue import parse_all
from validation.model.model import Added, Model
from validation.prediction.series import SeriesPrediction, predictions
from validation.study import Study
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import VirtualTest, simulate

MODEL = Model(source="model.toml", title="a laboratory", article="fmd+clumod-1", cell_stiffness=np.array((4e8, 4e8, 2e9)))
LINES = np.linspace(5.0, 30.0, 126)


@pytest.fixture(scope="module")
def tested():
    """An ordinary laboratory, everything drawn, in fast sweeps at two levels."""
    fast = {"octaves_per_minute": 60.0, "quiet": 0.3, "ringing": 1e-3, "levels": (1.0, 0.5)}
    return simulate(Plan(article="fmd+disc+cuboid", model="rigid", seed=3, **fast))


@pytest.fixture(scope="module")
def linear(tested) -> Study:
    """What it measured, and a model that knows none of what was drawn."""
    return Study(model=MODEL, campaigns=(tested.campaign,), made=predictions(MODEL, [tested.campaign], lines=LINES))


def effects(*texts: str, fixed: bool = False) -> tuple[Added, ...]:
    return tuple(Added(named=one, fixed=fixed) for one in parse_all(texts))


def bent(of: Study, text: str) -> Study:
    """`of` with readings that the catalogue's equation has changed, every run as it was driven."""
    return replace(
        of, campaigns=tuple(replace(one, recordings={}) for one in of.campaigns), made=tuple(_bent(one, text) for one in of.made)
    )


def _bent(one: SeriesPrediction, text: str) -> SeriesPrediction:
    there = one.with_effects(effects(text, fixed=True))
    values, linear = np.array(one.measured.values), one.at({}, derivatives=False).rows
    rows = there.at({}, derivatives=False).rows
    for run, y in enumerate(values):
        u = np.linalg.pinv(linear / np.abs(y).max(axis=0)[:, None]) @ (y / np.abs(y).max(axis=0))[..., None]
        values[run] += ((rows[run] - linear) @ u)[..., 0]
    return replace(one, tested=replace(one.tested, measured=replace(one.measured, values=values)))


def saturated(test: VirtualTest, channel: str, share: float) -> Study:
    """Records in which one channel rounds off its peaks, sample by sample."""
    campaign = test.campaign
    peaks = {one.axis: np.abs(campaign.recordings[one.name].channel(channel)).max() for one in reversed(campaign.runs)}
    recordings = {one.name: _saturated(campaign.recordings[one.name], channel, share, peaks[one.axis]) for one in campaign.runs}
    made = replace(campaign, recordings=recordings)
    return Study(model=MODEL, campaigns=(made,), made=predictions(MODEL, [made], lines=LINES))


def _saturated(of: Recording, channel: str, share: float, peak: float) -> Recording:
    values: Array = np.array(of.values)
    y = values[:, of.names.index(channel)]
    values[:, of.names.index(channel)] = y * (1 - share * (y / peak) ** 2)
    return replace(of, values=values)


def test_linear_runs_answer_alike_without_a_model_where_all_six_axes_were_driven_and_one_axis_is_enough(linear, tested):
    assert differing_levels(linear) == ()
    wrong = replace(linear, model=replace(MODEL, effects=effects("rigid-inertia:m=20", "force-gain:fmd-z2=0.3")))
    assert differing_levels(wrong) == ()
    told, as_told = (differing_levels(bent(one, "friction:flange:x=2")) for one in (linear, wrong))
    assert [one.sigma for one in as_told] == pytest.approx([one.sigma for one in told], rel=1e-9)

    def alone(of):
        return replace(of, made=tuple(one.on(("z", "z-at-0.5")) for one in of.made))

    assert differing_levels(alone(linear)) == ()
    assert [one.axis for one in differing_levels(alone(saturated(tested, "fmd-z1", 0.2)))] == ["z"]


@pytest.mark.parametrize("axis", [pytest.param("x", marks=pytest.mark.proof), "y"])
def test_friction_is_named_with_its_axis_and_slip_force(linear, axis):
    slipping = bent(linear, f"friction:flange:{axis}=3")
    found = differing_levels(slipping)
    assert [one.axis for one in found] == [axis]
    assert found[0].runs == (f"{axis}-at-0.5", axis)
    best = nonlinear(slipping, found)[0]
    assert best.id == f"friction:flange:{axis}"
    assert best.null
    np.testing.assert_allclose(best.sizes[0].value, 3.0, rtol=0.03)  # noise, and inputs that a nominal model tells


@pytest.mark.proof  # friction above holds the way
def test_a_gap_is_named_with_its_cell_and_preload(linear):
    lifting = bent(linear, "gap:3=15")
    found = differing_levels(lifting)
    assert set(found[0].channels[:4]) == {"fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4"}  # the others take over what it drops
    best = nonlinear(lifting, found)[0]
    assert best.id == "gap:3"
    np.testing.assert_allclose(best.sizes[0].value, 15.0, rtol=0.05)  # the equation is of what the nominal model says it carries


def test_peaks_are_those_of_the_records(tested):
    bent_records = saturated(tested, "fmd-z1", 0.1)
    (of,) = distorted_runs(bent_records, differing_levels(bent_records))
    k = of.of.channels.index("fmd-z1")
    for peak, partner in zip(of.peak[:, k], of.of.partner, strict=True):
        record = bent_records.campaigns[0].recordings[of.of.runs[partner]].channel("fmd-z1")
        assert peak == pytest.approx(np.abs(record - record.mean()).max(), rel=1e-12)


@pytest.mark.proof  # friction above is named the same way, from peaks as they are held above
def test_saturation_in_the_record_is_named_with_its_channel_and_share(tested):
    bent_records = saturated(tested, "fmd-z1", 0.1)
    found = differing_levels(bent_records)
    assert found[0].channels[0] == "fmd-z1"
    best = nonlinear(bent_records, found)[0]
    assert best.id == "saturation:fmd-z1"
    np.testing.assert_allclose(
        best.sizes[0].value, 0.1, rtol=0.1
    )  # of the fundamental; the peak in time is bent as well, and noisy


def test_what_the_model_knows_of_an_amplitude_is_no_difference(linear):
    slipping = bent(linear, "friction:flange:x=3")
    assert differing_levels(replace(slipping, model=replace(MODEL, effects=effects("friction:flange:x=3", fixed=True)))) == ()


def test_one_level_is_refused_where_two_are_needed(linear):
    single = replace(linear, made=tuple(one.on(("x", "y", "z", "alpha", "beta", "gamma")) for one in linear.made))
    assert differing_levels(single) == ()
    require_levels(linear, "friction")
    require_levels(single, "force-gain")
    with pytest.raises(BadInput, match="one level cannot see friction"):
        require_levels(single, "friction")
