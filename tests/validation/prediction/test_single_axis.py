"""A single-axis shaker: accelerometers on base and article, five other motions of the base that nobody measured."""

from collections.abc import Callable
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from identification import campaign_file
from identification.campaign import Campaign
from validation.cli import main
from validation.compare.maps import Rig
from validation.diagnose.candidate_fits import goodness_of_fit
from validation.diagnose.candidates import candidates
from validation.diagnose.diagnose import require_runs
from validation.diagnose.diagnosis import Candidate
from validation.diagnose.mistakes import LowFrequencyReadings, _likelihood, mistakes
from validation.diagnose.unexplained_fit import OF_SHARES, swallowing
from validation.diagnose.unexplained_places import channels, crosstalk
from validation.estimation.fit import fit
from validation.estimation.likelihood import floor_of, level_of
from validation.estimation.problem import DECLARED, FITTED, IDENTIFIED, Problem
from validation.estimation.verdicts import misfit
from validation.history.verdict import body_of
from validation.model.model import Model, difference
from validation.model.setups import mounted
from validation.prediction.series import SHARE, UNMEASURED, predictions, with_unmeasured
from validation.study import Data, Options, Study

MODEL = 'format = 1\nmodel = { title = "Mast on a shaker", article = "fmd+clumod-1" }\n'
POINTS = ("mast-top:x", "mast-top:y", "mast-top:z", "flange:x", "flange:y", "flange:z")
PLAIN = [part for point in POINTS for part in ("--response", point)]
FAST = ["--octaves-per-minute", "60", "--band", "8", "20", "--rate", "256", "--seed", "5"]

Simulated = Callable[..., Campaign]


@pytest.fixture(scope="module")
def simulated(tmp_path_factory: pytest.TempPathFactory) -> Simulated:
    made: dict[tuple[str, ...], Campaign] = {}

    def of(*effects: str, axis: str = "x") -> Campaign:
        if (axis, *effects) not in made:
            folder = tmp_path_factory.mktemp("single") / axis
            hidden = [part for effect in effects for part in ("--effect", effect)]
            assert main.run(["simulate", "fmd+clumod-1", "--axis", axis, *FAST, *PLAIN, *hidden, "--out", str(folder)]) == 0
            made[axis, *effects] = campaign_file.read(folder)
        return made[axis, *effects]

    return of


@pytest.fixture
def lab(
    tmp_path: Path, simulated: Simulated, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> Callable[..., None]:
    monkeypatch.chdir(tmp_path)
    (tmp_path / "lab.toml").write_text(MODEL, encoding="utf-8")

    def written(*effects: str, stated: float = 0.1) -> None:
        for axis in "xz":
            campaign_file.write(tmp_path / axis, replace(simulated(*effects, axis=axis), cross_motion=stated))
        capsys.readouterr()  # of the virtual test

    return written


@pytest.fixture
def model() -> Model:
    return Model(source="lab.toml", title="Mast on a shaker", article="fmd+clumod-1")


def test_without_load_cells_and_without_a_mounting_an_article_has_the_origin_of_its_channels(simulated, model) -> None:
    """It stood 45 mm above it, on an FMD that was not there, and every pick-up on it, then beside it, was left out."""
    made = simulated()
    table = replace(made.table, origin=np.array([0.2, 0.0, 0.1]))
    pose, (said,) = mounted(replace(made, table=table, mounting=None))
    assert_allclose(pose.position, [-0.2, 0.0, -0.1])
    assert "FMD" not in said


def test_a_virtual_test_has_one_pilot_the_article_and_the_largest_that_its_table_does_besides(simulated, refused, capsys):
    made = simulated()
    assert made.table.names == ("table-x1", *(point.replace(":", "-") for point in POINTS))
    assert [run.axis for run in made.runs] == ["x"]
    assert made.cross_motion == pytest.approx(0.09)
    capsys.readouterr()
    given = ("simulate", "fmd+clumod-1", *FAST, "--out", "none", "--axis")
    assert "accelerometers on the article" in refused(*given, "x")
    assert "must be one of x, y, z" in refused(*given, "alpha", *PLAIN)
    assert "does not read that channel" in refused(*given, "x", *PLAIN, "--effect", "force-gain:fmd-z2=0.1")


def test_one_axis_measures_no_dynamic_mass(simulated, model):
    (of,) = predictions(model, [simulated()])
    operators, why = Rig(table=with_unmeasured(simulated()).table, gravity=9.81).operators(of.measured)
    assert operators is None
    assert "no dynamic mass is measured" in why[0]


def test_without_their_size_unmeasured_motions_are_refused(lab, refused):
    lab(stated=0.0)
    assert "base motions x, y, z, alpha, beta, gamma cannot be told" in refused("compare", "lab.toml", "x")


def test_what_a_base_does_besides_is_told_of_itself_alone_and_as_one_share_along_the_lines(simulated, model):
    """The rows of its pick-ups are constants but for the shares, and derivatives are those of differences."""
    (of,) = predictions(model, [simulated()])
    assert UNMEASURED not in " ".join(of.remarks)
    quiet = [k for k, name in enumerate(of.measured.channels) if name.startswith(UNMEASURED)]
    changes = of.at({}).changes
    reached = {one.name for one in of.parameters if set(changes[one.name].channels) & set(quiet)}
    assert {name.partition(":")[0] for name in reached} == {SHARE}
    mine = [one for one in of.parameters if one.family == SHARE]
    assert len(mine) == 5 * 2 * 3  # 8 to 20 Hz: three knots
    for one in mine[::4]:
        there = of.at({one.name: 0.01}, derivatives=False).rows - of.at({}, derivatives=False).rows
        assert_allclose(there[:, changes[one.name].channels], 0.01 * changes[one.name].rows, atol=1e-12)


def test_motions_that_go_with_the_driven_one_pull_at_no_tolerance_even_at_their_true_size(simulated, model):
    """They counted at each line anew: of a base that did 5 % besides, 0.05 moved a delay by 3.4 of its deviations."""
    sound = simulated()
    for stated in (0.09, 0.04):
        found = fit(Problem(predictions(model, [replace(sound, cross_motion=stated)])).thinned(), FITTED)
        z = [abs(x) / one.tolerance for one, x in zip(found.parameters, found.offsets, strict=True)]
        assert max(z) < 3
        assert 0.5 < misfit(found) < 1


@pytest.mark.proof  # two fits; that nobody measured it is told of its channels below
def test_chi2_of_a_sound_test_is_that_of_noise_and_what_no_tolerance_explains_shows_in_it(simulated, model):
    """What nobody measured counted as data: of sound tests chi² read 0.05 to 0.13, and with an absorber 0.4."""
    for hidden, wrong in ((), False), (("absorber:mast-top=m:0.2,f:12,zeta:0.01",), True):
        problem = Problem(predictions(model, [simulated(*hidden)])).thinned()
        stands = goodness_of_fit(fit(problem, FITTED), problem)
        assert stands.misfit > 0.5
        assert (stands.misfit > 1.5 * stands.limit) == wrong


def test_without_load_cells_no_fmd_is_identified_and_what_stands_on_none_is_shaken_by_its_table(
    simulated, model, meaningless
) -> None:
    """A sound panel on a shaker stood on cells that were not there: up to 600 Hz they were made seven times as stiff."""
    sound = simulated()
    (of,) = predictions(model, [sound])
    fmd = [one for one in of.parameters if one.name.startswith("fmd")]
    assert {one.family for one in fmd} == {"fmd", "fmd-compliance"}
    assert {one.kind for one in fmd} == {DECLARED}
    (loaded,) = predictions(model, [meaningless(article="fmd+clumod-1")])  # with load cells, on the same FMD
    for both in ((of, loaded), (loaded, of)):
        assert {one.kind for one in Problem(both).parameters if one.family == "fmd"} == {IDENTIFIED}
    (alone,) = predictions(replace(model, article="clumod-1"), [replace(sound, article="clumod-1")])
    assert not [one.name for one in alone.parameters if one.name.startswith("fmd")]
    soft, rigid = (each.at({}, derivatives=False).rows[:, each.measured.channels.index("table-x1"), 0] for each in (of, alone))
    assert_allclose(rigid, 1.0, rtol=1e-12)
    assert np.abs(soft - 1).max() > 1e-3


def test_a_channel_of_no_noise_that_is_held_against_one_that_reads_nothing_has_a_likelihood() -> None:
    """The pick-up of a rigid base beside one across it: a diagnosis had ended in "invalid numeric entries"."""
    nothing = np.zeros((4, 2))
    one = LowFrequencyReadings(
        name="z",
        channels=("a", "b"),
        quantities=("acceleration",) * 2,
        lines=4,
        reading=nothing + 1,
        expected=nothing,
        noise=nothing,
        unsure=nothing,
    )
    assert np.isfinite(_likelihood([one], 0, 1, 0.0))


def test_a_pick_up_on_the_flange_moves_with_the_flange(simulated, model):
    """Its height is written to a micrometre, and 0.4 of one too high was the mast, whose resonances it then had to have."""
    (of,) = predictions(model, [simulated()])
    rows = of.at({}, derivatives=False).rows[:, of.measured.channels.index("flange-x")]
    height = 0.0349236 + 0.045
    assert_allclose(rows, np.broadcast_to([1, 0, 0, 0, height, 0], rows.shape), atol=1e-4)


def test_no_slant_or_place_of_a_pick_up_lets_it_read_what_the_base_does_that_nobody_recorded(simulated, model) -> None:
    """What is left of a line is any such motion: of a sound panel a slant went 4.7 deviations, 1.4 degrees, and it "FAILED"."""
    (of,) = predictions(model, [simulated()])
    channel, slant = of.measured.channels.index("flange-z"), "accelerometer-misalignment:flange-z:y"
    for name, size in ((slant, 0.05), ("accelerometer-position:flange-z:y", 0.01)):
        away = of.at({name: size}, derivatives=False).rows - of.at({}, derivatives=False).rows
        assert np.abs(away[:, channel, 1:]).max() < 2e-3 * size  # what bends alone, of a flange next to nothing
        assert (np.abs(away[:, channel, 0]).min() > 0.9 * size) == (name == slant)
    at = {slant: 0.05, "accelerometer-gain:flange-z": 0.1, "accelerometer-position:mast-top-x:z": 0.01}
    changes = of.at(at).changes
    for name in (*at, "accelerometer-delay:flange-z"):
        step = 1e-6 if "delay" in name else 1e-4
        above, below = (of.at({**at, name: at.get(name, 0.0) + side * step}, derivatives=False).rows for side in (1, -1))
        slope = ((above - below) / (2 * step))[:, changes[name].channels]
        assert_allclose(changes[name].rows, slope, atol=1e-6 * max(np.abs(slope).max(), 1e-3))


def test_no_mode_takes_part_in_what_nobody_recorded_beyond_what_is_computed(simulated, model):
    """The unknown turn of each line fitted the noise by it: `participation:3:gamma` of sound tests went 4 to 5 deviations."""
    (of,) = predictions(model, [simulated()])
    assert {one.name[-1] for one in of.parameters if one.family == "participation"} == {"x"}


def test_a_pick_up_across_the_drive_hears_it_by_its_slant(simulated, model):
    """The plain fit trusted it to a hundredth of its own small reading, and moved moduli and modes to their bounds for it."""
    (of,) = predictions(model, [simulated()])
    channel = of.measured.channels.index
    floor, driven = floor_of(of.measured)[0, :, channel("mast-top-z")], of.measured.values[0, :, channel("table-x1")]
    assert np.all(floor > np.abs(driven) / 2)
    assert np.median(level_of(of.measured)[0, :, channel("mast-top-z")]) < 0.2 * np.median(floor)


@pytest.mark.proof  # a whole fit; what a base does besides is told above
def test_motions_that_are_said_to_be_far_smaller_than_they_are_show(simulated, model):
    found = fit(Problem(predictions(model, [replace(simulated(), cross_motion=0.002)])).thinned(), FITTED)
    assert found.tolerance_z2 > 5 * found.tolerances  # they pay for what they are not


@pytest.mark.proof  # two whole evaluations; the floor itself is held by the pick-up across the drive
def test_what_nobody_recorded_is_no_noise_that_errors_are_relieved_of(simulated, model):
    sound, soft = (Study.of(model, Data(campaigns=(simulated(*one),))).evaluation() for one in ((), ("modulus:mast=-0.4",)))
    assert 1 < sound.plain.percent < sound.nominal.percent < 0.5 * soft.nominal.percent


def test_a_force_that_one_of_two_axes_lacks_is_told_and_another_pilot_is_not(simulated):
    along_x, along_z = simulated(axis="x"), simulated(axis="z")
    assert not difference(along_x, along_z)
    below = replace(along_x.table.channels[0], name="fmd-z1", quantity="force", group="fmd")
    with_force = replace(along_x, table=replace(along_x.table, channels=(*along_x.table.channels, below)))
    assert "fmd-z1 is a channel of" in difference(with_force, along_z)


@pytest.mark.parametrize("mistake", ["polarity:mast-top-x", "unit:mast-top-z", "polarity:table-z1"])
def test_plain_mistakes_are_found_before_any_fit(simulated, model, mistake):
    """In two campaigns of one laboratory, each with a pilot of its own; where a channel hardly moves, nothing is said of it."""
    for planted in ((), (mistake if "unit" not in mistake else f"{mistake}=9.81",)):
        both = [simulated(*planted if axis in mistake[-2:] else (), axis=axis) for axis in "xz"]
        study = Study.of(model, Data(campaigns=tuple(both)), Options(model=""))
        assert [one.id for one in mistakes(study)] == [mistake] * len(planted)


def test_runs_along_two_axes_and_a_base_that_nobody_reads_are_refused(simulated):
    whole, other = simulated(), simulated(axis="z")
    with pytest.raises(BadInput, match="its runs are driven along"):
        with_unmeasured(replace(whole, runs=(*whole.runs, *other.runs)))
    blind = replace(whole.table, channels=whole.table.channels[1:])
    with pytest.raises(BadInput, match="no accelerometer on the base reads along x"):
        with_unmeasured(replace(whole, table=blind, recordings={}))


def test_no_inertia_is_told_of_it(simulated, model):
    study = Study.of(model, Data(campaigns=(simulated(),)), Options(model=""))
    assert study.article
    assert body_of(study, fit(study.problem().thinned(), ()), print) is None


def test_what_nobody_measured_is_no_channel_that_could_be_wrong_and_a_slanted_pilot_no_cause(simulated, model):
    study = Study.of(model, Data(campaigns=(simulated(),)), Options(model=""))
    ids = [one.named.id for one in candidates(study)]
    assert "accelerometer-misalignment:mast-top-x:y" in ids
    assert not [one for one in ids if one.startswith(("accelerometer-misalignment:table", "accelerometer-position:table"))]
    assert [one for one in ids if one.startswith("board-delay:")] == ["board-delay:table"]
    assert "cover-plate-flexibility" not in ids
    problem = study.problem().thinned()
    (at,) = swallowing(Candidate(effects=(), fit=fit(problem, FITTED), problem=problem))
    named = [place for one in channels(at, OF_SHARES) for place in one.places]
    named += [place for places, *_ in crosstalk(at, problem.start) for place in places]
    assert named
    assert not [one for one in named if any(name.startswith(UNMEASURED) for name in one.channels)]


def test_one_run_is_enough_where_accelerometers_stand_on_the_article(simulated) -> None:
    """A single-axis shaker that has run once was refused by `diagnose`, which takes a single response function."""
    one = simulated()
    assert len(one.runs) == 1
    require_runs([one])
    off = [k for k, channel in enumerate(one.table.channels) if channel.group != "article"]
    bare = replace(one.table, channels=tuple(one.table.channels[k] for k in off))
    recorded = {name: replace(each, names=bare.names, values=each.values[:, off]) for name, each in one.recordings.items()}
    with pytest.raises(BadInput, match="too few"):
        require_runs([replace(one, table=bare, recordings=recorded)])


@pytest.mark.proof
@pytest.mark.parametrize("hidden", [(), ("modulus:mast=-0.4",), ("accelerometer-gain:mast-top-z=0.12",)])
def test_diagnose_names_what_is_hidden_and_nothing_where_nothing_is(lab, answer, hidden):
    lab(*hidden)
    found = answer("diagnose", "lab.toml", "x", "z")
    assert [one["id"] for one in found["accepted"]] == [one.partition("=")[0] for one in hidden]
    assert found["verdict"] == ("missing" if hidden else "nothing")
