"""Errors in per cent: of the judged channels, with inputs from the others, and what a gain of 8 % reads."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import CheckFailed
from validation.estimation.evaluate import evaluate, share, squares
from validation.estimation.problem import Problem


def error(toy, offsets=()):
    return share(squares(toy, dict(offsets)))


@pytest.mark.parametrize("known", [False, True], ids=["latent", "known"])
def test_a_perfect_prediction_has_no_error(lab, known):
    truth = {"mass": 0.1, "gain:f2": 0.02}
    assert error(lab.toy(truth, seed=None, known=known), truth).percent < 1e-9


@pytest.mark.parametrize("known", [False, True], ids=["latent", "known"])
def test_eight_per_cent_on_one_of_four_forces_that_share_a_load_read_four(lab, known):
    """Closed form: 0.08 F/4 of a force whose four shares have the norm F/2, as they were read, 0.16 sqrt(...) longer."""
    toy = lab.toy({"gain:f3": 0.08}, seed=None, known=known, motion=(1.0, 0.0))
    only = replace(toy.measured, judged=np.array([name in ("f1", "f2", "f3", "f4") for name in lab.CHANNELS]))
    kept = [k for k, name in enumerate(lab.CHANNELS) if name not in ("f5", "f6", "f7", "f8")]
    only = replace(
        only,
        channels=tuple(lab.CHANNELS[k] for k in kept),
        judged=only.judged[kept],
        values=only.values[..., kept],
        noise=only.noise[..., kept],
    )

    class Kept:
        measured, parameters = only, toy.parameters

        def at(self, offsets, lines=None, *, derivatives=True):
            found = toy.at(offsets, lines, derivatives=False)
            return replace(found, rows=found.rows[:, kept])

    found = error(Kept())
    assert_allclose(found.by_channel["f3"], 100 * 0.08 / np.sqrt(3 + 1.08**2), rtol=1e-3)  # noise is small, and taken off
    others = found.percent / found.by_channel["f3"]
    assert others < 1 + 1e-3 if known else 1 < others < 1.2  # where inputs are latent, others hear a little of it


def test_squares_of_channels_add_and_runs_average(lab):
    found = error(lab.toy(lab.drawn(1), name="one", runs=4))
    assert_allclose(np.sum(np.square(list(found.by_channel.values()))), found.percent**2, rtol=1e-12)
    assert_allclose(np.mean(np.square(list(found.by_run.values()))), found.percent**2, rtol=1e-12)
    assert set(found.by_channel) == set(lab.FORCES)
    assert set(found.by_run) == {f"one/r{k}" for k in (1, 2, 3, 4)}


def test_several_data_sets_weigh_by_their_lines(lab):
    one, two = lab.toy(lab.drawn(1), name="one", runs=1, lines=30), lab.toy(lab.drawn(2), name="two", runs=2, lines=60)
    found = share([*squares(one, {}), *squares(two, {})])
    parts = found.by_data_set["one"] ** 2 * 30 + found.by_data_set["two"] ** 2 * 120
    assert_allclose(found.percent**2, parts / 150, rtol=1e-12)


def test_a_model_that_breaks_down_is_said_so_with_the_data_set(lab):
    class Broken:
        measured, parameters = lab.toy({}).measured, ()

        def at(self, offsets, lines=None, *, derivatives=True):
            raise np.linalg.LinAlgError("a stiffness turned negative")

    with pytest.raises(CheckFailed, match="the model of one breaks down: a stiffness turned negative"):
        squares(Broken(), {})


def test_the_scale_of_the_data_does_not_matter(lab):
    toy = lab.toy(lab.drawn(1))
    larger = replace(toy, measured=replace(toy.measured, values=7 * toy.measured.values, noise=7 * toy.measured.noise))
    assert_allclose(error(larger).percent, error(toy).percent, rtol=1e-9)


def test_an_error_of_an_acceleration_shows_in_the_forces_that_it_predicts(lab):
    """Four of five pick-ups outvote it, but not quite."""
    found = error(lab.toy({"gain:a1": 0.1}, seed=None))
    assert 0.1 < found.percent < 10.0


def test_too_few_channels_for_latent_inputs_are_refused(lab):
    """Two latent inputs and two channels: nothing is left to hold either against."""

    class Two:
        def __init__(self, known):
            toy = lab.toy({}, known=known)
            m = toy.measured
            few = replace(m, channels=m.channels[:2], judged=m.judged[:2], values=m.values[..., :2], noise=m.noise[..., :2])
            self.toy, self.measured, self.parameters = toy, few, toy.parameters

        def at(self, offsets, lines=None, *, derivatives=True):
            found = self.toy.at(offsets, lines, derivatives=False)
            return replace(found, rows=found.rows[:, :2])

    with pytest.raises(CheckFailed, match="the 2 inputs cannot be told without channel 1"):
        squares(Two(known=False), {})
    assert squares(Two(known=True), {})


def test_a_gain_of_eight_per_cent_shows_in_the_plain_error_and_goes_when_it_is_added(lab):
    """As the catalogue tells it: about 4 % before and the null level after, on held-out data too, and chi² hardly sees it."""
    drawn = {**lab.drawn(0), "mass": 0.02, "frequency:one": 0.01}
    null = evaluate(Problem((lab.toy(drawn, motion=(1.0, 0.1)),)))
    faulty = {**drawn, "gain:f3": 0.08}
    parent = evaluate(Problem((lab.toy(faulty, motion=(1.0, 0.1)),)))
    opened = tuple(lab.effect("gain:f3", 0.05) if p.name == "gain:f3" else p for p in lab.LABORATORY)
    child = evaluate(Problem((lab.toy(faulty, parameters=opened, motion=(1.0, 0.1)),)), parent=parent)
    # half of 8 % where one of four shares is wrong, less the mean of 2 % that the mass, which is identified, takes over
    # makes 3.5 % where the article only translates, and less where it turns
    assert 2.5 < parent.plain.percent < np.sqrt(6**2 + 3 * 2**2) / 2
    assert_allclose(parent.held_out.percent, parent.plain.percent, rtol=0.02)
    assert child.plain.percent < 1.1 * null.plain.percent
    assert child.held_out.percent < 1.1 * null.held_out.percent
    assert_allclose(child.fitted.by_name["gain:f3"], 0.08, atol=0.003)
    assert child.fitted.cost <= parent.fitted.cost
    assert child.plain_fit.cost <= parent.plain_fit.cost
    assert child.fitted.log_evidence - parent.fitted.log_evidence > 50
    # tolerances swallow the fault: chi² hardly sees it, their price does
    assert parent.fitted.chi2 < 1.2 * null.fitted.chi2
    assert parent.fitted.tolerance_z2 > 5 * null.fitted.tolerance_z2


def test_the_nominal_error_is_of_the_model_as_it_stands(lab):
    """An effect of the model that stands at its size counts in it, though nothing is fitted."""
    truth = {"offset": 0.4}
    effect = lab.effect("offset", 1.0, start=0.4)
    toy = lab.toy(truth, parameters=(*lab.LABORATORY, effect), seed=None)
    assert evaluate(Problem((toy,))).nominal.percent < 1e-6
    assert evaluate(Problem((lab.toy(truth, acting=(effect,), seed=None),))).nominal.percent > 1.0
