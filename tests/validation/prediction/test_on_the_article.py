"""Accelerometers on the article: against a direct solution of the whole structure, against differences, and as a fault of one."""

import runpy
from collections.abc import Callable, Mapping, Sequence
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import Array, rigid_transformation_6
from geometry.sensors import Channel, ChannelTable, Place
from identification import campaign_file
from identification.campaign import Campaign
from validation.effects.catalogue import Named
from validation.estimation.fit import fit
from validation.estimation.problem import FITTED, Problem
from validation.model.model import Added, Model
from validation.model.setups import mounted
from validation.prediction.effects import ASSUMED
from validation.prediction.series import SeriesPrediction, predictions
from validation.virtual_test.simulate import simulate

POINTS = {"tip-z": (9, 2), "tip-x": (9, 0), "mid-y": (4, 1)}
"""Node, counted from the foot, and axis along which each measures."""


@pytest.fixture(scope="module")
def bracket(root: Path) -> Mapping[str, Any]:
    """What the example of a model of one's own defines."""
    return runpy.run_path(str(root / "examples" / "own_model.py"))


@pytest.fixture(scope="module")
def campaign(bracket: Mapping[str, Any], meaningless: Callable[..., Campaign]) -> Campaign:
    """Spectra that mean nothing of the bracket on the FMD, three accelerometers on it."""
    bare = meaningless(article="fmd+bracket")
    pose, _ = mounted(bare)
    where = bare.table.origin + pose.apply(1e-3 * bracket["bracket"]()[1])
    sensors = [
        Channel(
            name=name, quantity="acceleration", group="article", places=(Place(position=where[node], direction=np.eye(3)[axis]),)
        )
        for name, (node, axis) in POINTS.items()
    ]
    table = ChannelTable(channels=(*bare.table.channels, *sensors), origin=bare.table.origin)
    rng = np.random.default_rng(1)
    longer = {
        name: replace(one, names=table.names, values=np.hstack([one.values, rng.standard_normal((len(one.values), 3))]))
        for name, one in bare.recordings.items()
    }
    return replace(bare, table=table, recordings=longer)


@pytest.fixture(scope="module")
def of(bracket: Mapping[str, Any], campaign: Campaign, model: Callable[..., Model], tmp_path_factory: Any) -> SeriesPrediction:
    folder = tmp_path_factory.mktemp("own")
    bracket["write"](folder)
    own = {"bracket": str(folder / "bracket.npz")}
    return predictions(model(own=own, article="fmd+bracket", damping_ratio=1e-6), [campaign])[0]


def test_modes_up_to_the_last_line_of_spectra_are_uncertain_and_a_loss_that_nobody_stated_within_a_factor_of_three(
    of: SeriesPrediction, campaign: Campaign, model: Callable[..., Model]
) -> None:
    """A sound satellite was "unknown": runs without excitation counted as driven to 40 Hz, and an assumed loss as known."""
    wide = {name: replace(one, frequency=16 * one.frequency) for name, one in campaign.recordings.items()}
    runs = tuple(replace(one, excitation=None) for one in campaign.runs)
    folder = Path(of.tested.model.own["bracket"]).parent
    base = 'units = "mm-t-N-s"\nreference_point = ["0 mm", "0 mm", "0 mm"]\ninterface = [101]\nfile = "bracket-parts.npz"\n'
    (folder / "lossless.toml").write_text('format = 1\n[fe_model]\nname = "bracket"\nkind = "matrices"\n' + base)
    own = {"bracket": str(folder / "lossless.toml")}
    spectra = replace(campaign, recordings=wide, runs=runs)
    far = predictions(model(own=own, article="fmd+bracket", damping_ratio=None), [spectra])[0]
    known = {one.name: one.tolerance for one in far.parameters}
    assert 240 < far.measured.frequency[-1] < 600
    assert {f"frequency:fmd+bracket:{r}" for r in (1, 2)} <= set(known)  # 118 and 227 Hz
    assert not any(one.name.startswith("frequency:") for one in of.parameters)  # of lines up to 32 Hz
    assert_allclose([known[f"damping:fmd+bracket:{r}"] for r in (1, 2)], np.log(3.0))
    assert ASSUMED in far.remarks
    assert ASSUMED not in of.remarks
    stated = predictions(
        model(own=own, article="fmd+bracket", damping_ratio=0.01), [replace(campaign, recordings=wide, runs=runs)]
    )
    assert {one.tolerance for one in stated[0].parameters if one.name.startswith("damping:")} == {0.35}


def solved(
    bracket: Mapping[str, Any], campaign: Campaign, node: int, axis: int, hertz: float, beside: Sequence[float] = (0, 0, 0)
) -> Array:
    """(6,) acceleration `beside` [m] a node, along the axes of F, for a unit of every motion of F, of the whole matrices:
    millimetres, tonnes, seconds."""
    _, _, K, M = bracket["bracket"]()
    pose, _ = mounted(campaign)
    D = M - K / (2 * np.pi * hertz) ** 2
    answer = -np.linalg.solve(D[6:, 6:], D[6:, :6] @ np.diag([1e3, 1e3, 1e3, 1, 1, 1]))
    own = answer[6 * (node - 1) : 6 * node]
    moved = 1e-3 * own[:3] + np.cross(own[3:], pose.rotation.T @ np.array(beside), axisa=0, axisc=0)
    R = np.kron(np.eye(2), pose.rotation)
    return np.asarray((pose.rotation @ moved @ R.T @ rigid_transformation_6(pose.position))[axis])


def test_what_they_read_is_that_of_the_whole_structure_solved_directly(
    of: SeriesPrediction, bracket: Mapping[str, Any], campaign: Campaign
) -> None:
    rows = of.at({}, derivatives=False).rows
    for name, (node, axis) in POINTS.items():
        k = of.measured.channels.index(name)
        for line in (0, 12, 24):
            expected = solved(bracket, campaign, node, axis, float(of.measured.frequency[line]))
            assert_allclose(rows[line, k], expected, atol=1e-4 * np.abs(expected).max())
    still = solved(bracket, campaign, 9, 0, 0.1)
    assert np.abs(rows[-1, of.measured.channels.index("tip-x")] - still).max() > 0.003 * np.abs(still).max()  # it bends
    assert of.dynamic_mass({}).shape[1:] == (6, 6)
    assert of.by_load({}).shape[1:] == (len(of.measured.channels), 6)
    assert len([place for place in of.there.places if place.startswith("@")]) == 2  # where a sensor sits something else may be


@pytest.mark.parametrize("axis", "xy")
def test_one_beside_its_place_reads_what_the_article_bends_there(
    of: SeriesPrediction, bracket: Mapping[str, Any], campaign: Campaign, axis: str
) -> None:
    """It had read the turn of the base there, and what bends at the place where it was said to sit."""
    line, k, beside = 24, of.measured.channels.index("tip-z"), 0.02 * np.eye(3)["xyz".index(axis)]
    there = {f"accelerometer-position:tip-z:{axis}": 0.02}
    moved = of.at(there, derivatives=False).rows[line, k] - of.at({}, derivatives=False).rows[line, k]
    hertz = float(of.measured.frequency[line])
    expected, rigid = (
        np.subtract(*(solved(bracket, campaign, *POINTS["tip-z"], at, by) for by in (beside, (0, 0, 0)))) for at in (hertz, 0.1)
    )
    assert_allclose(moved, expected, atol=1e-5 * np.abs(expected - rigid).max())


def test_every_derivative_of_theirs_is_that_of_differences(of: SeriesPrediction) -> None:
    changes = of.at({}).changes
    mine = [of.measured.channels.index(name) for name in POINTS]
    names = {one.name for one in of.parameters if one.name.partition(":")[2].partition(":")[0] in POINTS}
    families = {"accelerometer-gain", "accelerometer-delay", "accelerometer-position", "accelerometer-misalignment"}
    assert {name.partition(":")[0] for name in names} == families
    for one in of.parameters:
        if one.name not in names and one.family not in ("modulus", "frequency", "mounting", "density"):
            continue
        step = 1e-2 * one.tolerance
        above, below = (of.at({one.name: side * step}, derivatives=False).rows for side in (1, -1))
        difference = ((above - below) / (2 * step))[:, mine]
        stated = np.zeros_like(above)
        change = changes[one.name]
        stated[:, list(change.channels)] = change.rows
        assert_allclose(stated[:, mine], difference, atol=1e-3 * np.abs(difference).max() + 1e-9 / one.tolerance), one.name


def test_of_a_virtual_test_at_the_truth_nothing_is_left_where_they_sit(
    plan: Callable[..., Any], predicted: Callable[..., Any], at_truth: Callable[..., Any], unexplained: Callable[..., Any]
) -> None:
    """Other code: the rig's own places, the tolerances of each pick-up, the record."""
    test = simulate(plan(on_article=("mast-top:x", "lower-1+:z")))
    (of,) = predicted(test)
    sensors = ("mast-top-x", "lower-1+-z")
    left, bare = (unexplained(of, offsets, sensors) for offsets in (at_truth(of, test), {}))
    assert max(left.values()) < 1e-3  # places are known, and how surfaces tilt that bend is not
    assert all(bare[name] > 20 * left[name] for name in sensors)


def test_a_wrong_gain_of_one_is_worth_its_name_and_a_place_that_is_none_is_refused(
    refused: Callable[..., str], answer: Callable[..., Any], model: Callable[..., Model]
) -> None:
    given = ("simulate", "fmd+clumod-1", "--octaves-per-minute", "60", "--damping", "0.05", "--response")
    assert "must be a place" in refused(*given, "lower-1:z", "--out", "none")
    answer(*given, "mast-top:x", "--effect", "accelerometer-gain:mast-top-x=0.2", "--out", "test")
    (of,) = predictions(model(), [campaign_file.read("test")], band=(8.0, 16.0))
    gain = Added(named=Named(family="accelerometer-gain", targets=("mast-top-x",), values={"": 0.1}))
    one = of.with_effects((gain,))
    before, after = (fit(Problem((each,)).thinned(), FITTED) for each in (of, one))
    assert after.log_evidence > before.log_evidence + 20
    assert after.by_name["accelerometer-gain:mast-top-x"] == pytest.approx(0.2, abs=0.02)
