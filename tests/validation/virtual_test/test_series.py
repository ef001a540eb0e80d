"""One seed is one laboratory: hardware and parts are shared by a series, noise and cross motion belong to a run."""

import os
import subprocess
import sys
from dataclasses import replace

import numpy as np
from numpy.testing import assert_array_equal

from validation.virtual_test.layout import stream, token
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import cross_motion, laboratory, record, recording, runs

ARTICLES = ("fmd", "fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4")


def test_the_same_seed_is_the_same_fmd_sensors_and_cells_whatever_is_mounted():
    labs = [laboratory(Plan(article=article, seed=5)) for article in ARTICLES]
    for lab in labs[1:]:
        assert dict(lab.chain.deviations()) == dict(labs[0].chain.deviations())
        for one, other in zip(lab.rig.cells, labs[0].rig.cells, strict=True):
            assert_array_equal(one.stiffness, other.stiffness)
    covers = [
        lab.rig.cover.scaled(2.0) if article == "fmd" else lab.rig.cover for article, lab in zip(ARTICLES, labs, strict=True)
    ]
    for cover in covers[1:]:
        assert_array_equal(cover.parameters, covers[0].parameters)


def test_the_same_seed_is_the_same_clumod_with_one_blade_and_with_four():
    one, four = (laboratory(Plan(article=f"fmd+clumod-{blades}", seed=5)).made.parts for blades in (1, 4))
    assert {"mast", "lower-1"} == set(one) < set(four)
    assert all(one[part] == four[part] for part in one)


def test_another_seed_is_another_laboratory(ordinary):
    mine, other = (laboratory(Plan(article="fmd+clumod-1", seed=seed)) for seed in (5, 6))
    figures = [np.array(list(dict(lab.chain.deviations()).values())) for lab in (mine, other)]
    drawn = figures[0] != 0
    assert np.all(figures[0][drawn] != figures[1][drawn])
    assert mine.made.parts["mast"] != other.made.parts["mast"]
    assert token(5, "fmd") != token(6, "fmd")


def test_noise_and_cross_motion_belong_to_article_and_run():
    plans = [Plan(article=article, seed=5) for article in ARTICLES[1:3]]
    shares = [cross_motion(plan, run).share for plan in plans for run in ("x", "y")]
    noises = [stream(5, "noise", plan.article, run, "fmd-z1").standard_normal(4) for plan in plans for run in ("x", "y")]
    for found in (shares, noises):
        assert all(np.any(found[i] != found[j]) for i in range(4) for j in range(i))


def test_the_same_plan_is_the_same_run_to_the_last_bit(elastic_plan, ordinary):
    plan = elastic_plan(seed=987654321)
    lab, run = laboratory(plan), runs(plan)[3]
    again = recording(plan, lab.layout, lab.chain, run, record(plan, lab, run))
    assert_array_equal(again.values, ordinary("fmd+clumod-1").campaign.recordings["alpha"].values)


def test_streams_do_not_depend_on_the_process_and_their_names_are_not_run_together():
    """Python salts the hashes of strings in every process; the names of streams must not go through them."""
    program = (
        "from validation.virtual_test.layout import stream, token; print(stream(3, 'a', 'b').integers(10**15), token(3, 'a'))"
    )
    answers = {
        subprocess.run(
            [sys.executable, "-c", program], capture_output=True, encoding="utf-8", check=True, env=environment(salt)
        ).stdout.split()[0]
        for salt in ("1", "2")
    }
    assert answers == {str(stream(3, "a", "b").integers(10**15))}
    assert stream(3, "ab", "c").integers(10**15) != stream(3, "a", "bc").integers(10**15)


def environment(salt: str) -> dict[str, str]:
    return {**os.environ, "PYTHONHASHSEED": salt}


def test_a_run_stays_what_it_is_when_others_are_added():
    plan = Plan(article="fmd+clumod-1", seed=5)
    more = replace(plan, pattern="twice", levels=(1.0, 0.5))
    names = [run.name for run in runs(more)]
    assert len(names) == len(set(names)) == 24
    assert_array_equal(cross_motion(plan, "beta").share, cross_motion(more, "beta").share)
    levels = {run.name: run.excitation.figure("level") for run in runs(more)}
    assert levels["x-at-0.5"] == 0.5 * levels["x"] == 1.25
