"""Every tolerance that is drawn shows in its channels, with its size and its sign."""

from dataclasses import fields, replace

import numpy as np
from numpy.testing import assert_allclose

from geometry.sensors import Tolerances
from validation.virtual_test.plan import Plan, Scatter
from validation.virtual_test.shaker import nominal_fmd
from validation.virtual_test.simulate import laboratory


def test_what_is_drawn_has_the_size_of_its_tolerance_and_grows_with_it():
    """Of 400 laboratories; a standard deviation from 400 draws lies within 10 % of its own (nearly three of its errors)."""
    plan, of = Plan(article="fmd"), Tolerances()
    layout = laboratory(plan).layout
    chains = [replace(plan, seed=seed).drawn_chain(layout) for seed in range(400)]
    for name, values, size in (
        ("gain", [chain.gain["cover-z1"] for chain in chains], of.gain),
        ("table gain", [chain.gain["table-z1"] for chain in chains], of.table_gain),
        ("delay", [chain.delay["fmd-x12"] for chain in chains], of.delay),
        ("position", [chain.position["cover-z2"][1] for chain in chains], of.position),
        ("angle", [chain.angle["cover-z2"][1] for chain in chains], of.angle),
        ("cell", [chain.cell_stiffness[2, 2] for chain in chains], of.cell_stiffness),
        ("cross-talk", [chain.crosstalk[1, 0] for chain in chains], of.crosstalk),
    ):
        assert_allclose(np.std(values), size, rtol=0.1, err_msg=name)
        assert abs(np.mean(values)) < 0.2 * size
    doubled = replace(plan, tolerances=of.scaled(2.0)).drawn_chain(layout)
    for one in ("gain", "delay"):
        assert_allclose(list(getattr(doubled, one).values()), 2 * np.array(list(getattr(chains[0], one).values())), rtol=1e-12)
    assert np.all([chain.angle["cover-z2"][2] == 0 for chain in chains])  # a turn about its own direction is none


def test_the_fmd_of_any_seed_is_a_body_within_its_tolerance():
    plan = Plan(article="fmd")
    nominal = nominal_fmd(plan)
    found = [replace(plan, seed=seed).drawn_moving_part(nominal) for seed in range(400)]
    assert_allclose(np.std([one.mass for one in found]) / nominal.mass, 0.05, rtol=0.1)
    assert_allclose(np.std([one.cog[0] for one in found]), Scatter().fmd_cog, rtol=0.1)
    spread = np.std([one.moments_cog for one in found], axis=0) / nominal.moments_cog
    assert np.all((spread > 0.03) & (spread < 0.06))
    for one in found:
        moments, _ = one.principal()
        assert moments[2] < moments[0] + moments[1]


def test_no_tolerance_at_all_draws_nothing(exact_test):
    drawn_figures = exact_test.truth["tolerances"]
    relative = drawn_figures["fmd-inertia"]
    figures = [value for name, value in drawn_figures.items() if name != "fmd-inertia"]
    assert {one.name for one in fields(Tolerances)} == set(exact_test.truth["plan"]["tolerances"])
    assert not np.any(figures)
    assert_allclose([relative["mass"], *relative["cog_m"], *relative["moi_cog"]], 0, atol=1e-14)
