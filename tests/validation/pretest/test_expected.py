"""What a pretest expects: intervals, what dominates them, what a lost channel costs, and the places that are rigid."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry import routes
from geometry.articles import built_in, locations
from geometry.dynamic_mass import MOTIONS
from geometry.frames import rigid_transformation_6
from geometry.inertia import PARAMETERS
from identification.quality import NORMAL_95
from validation.flexible.model import FlexibleOptions, flexible
from validation.flexible.modes import node_displacement
from validation.identify import pretest

RATIOS = ("gain", "table_gain", "cell_stiffness", "crosstalk", "fmd_inertia")
EXACT = (*(f"{name}=0" for name in RATIOS), "delay=0 s", "position=0 mm", "angle=0 deg")


def only(**sizes: str) -> tuple[str, ...]:
    """A laboratory that is exact but for these tolerances."""
    return (*EXACT, *(f"{name}={value}" for name, value in sizes.items()))


def test_gains_of_eight_load_cells_leave_the_mass_an_eighth_of_their_variance_and_pickups_as_much_unless_exact(ask):
    """Eight channels weigh the whole set-up each in its own unit; the table's exact accelerometers calibrate all others."""
    found = pretest.findings(ask(tolerances=only(gain="1%"), noise="off", lost=True))
    whole = sum(routes.inertia(built_in(name)).mass for name in ("fmd", "disc+cuboid"))
    # the floor of 0.15 % at every line and the small terms of the other parameters
    assert_allclose(found.best.half_width[0], NORMAL_95 * 0.01 / np.sqrt(8) * whole, rtol=0.03)
    # seven are left, and the cells' known stiffness says what the eighth would have read
    assert_allclose(found.without["fmd-z1"][0], NORMAL_95 * 0.01 / np.sqrt(7) * whole, rtol=0.03)
    found = pretest.findings(ask(tolerances=only(gain="1%", table_gain="100%"), noise="off"))
    whole = sum(routes.inertia(built_in(name)).mass for name in ("fmd", "disc+cuboid"))
    assert_allclose(found.best.half_width[0], NORMAL_95 * 0.01 * np.sqrt(2 / 8) * whole, rtol=0.03)


def test_the_values_are_those_of_the_article_and_the_fit_of_exact_data_has_no_misfit(tared):
    own = routes.inertia(built_in("disc+cuboid"))
    assert_allclose(tared.best.values[0], own.mass, rtol=1e-4)
    assert_allclose(tared.best.values[1:4], own.cog, atol=1e-4)
    assert_allclose(tared.best.values[4:7], own.moments_cog, rtol=2e-3)  # the elastic Cuboid taken for nearly rigid
    assert tared.best.identified.converged
    assert tared.best.identified.misfit < 1e-2


def test_less_knowledge_never_narrows_an_interval_and_a_tare_on_a_known_fmd_changes_nothing(tared, ask):
    assert np.all(tared.untared >= tared.best.half_width * (1 - 1e-6))
    assert tared.untared[0] > 5 * tared.best.half_width[0]  # an FMD that is known to 5 %
    assert set(tared.without) == set(tared.spectra.table.names)
    for half in tared.without.values():
        assert np.all(half >= tared.best.half_width * (1 - 1e-6))
        assert np.any(half > tared.best.half_width * 1.003)
    assert np.all(tared.plain.half_width[:4] > tared.best.half_width[:4])
    assert tared.lost["cover-z1"] == ""
    assert "what its cells carry" in tared.lost["fmd-z1"]
    # The same information by another way: the FMD's prior as a block of its own, or added to the joint matrix.
    assert tared.untared is not None
    assert_allclose(pretest.findings(ask()).best.half_width, tared.untared, rtol=1e-3)  # ended within a hundredth of its interval


def test_shares_add_up_and_name_what_was_left_open(tared, ask):
    for one in (tared.best, tared.plain):
        assert_allclose(np.sum(list(one.identified.shares.values()), axis=0), 1.0, rtol=1e-9)
    alone = pretest.findings(ask(tolerances=only(position="2 mm"))).best.identified.shares
    assert {name for name, share in alone.items() if share.max() > 0.02} <= {
        "accelerometer-position",
        "noise",
        "elasticity",
        "tare",
    }
    assert alone["accelerometer-position"][PARAMETERS.index("Ixx")] > 0.5


def test_single_axis_sweeps_without_cross_motion_have_condition_number_one_and_more_runs_narrow_what_noise_leaves(ask):
    from validation.identify.pretest import planned

    clean = planned(ask(cross=0.0).plan)
    assert_allclose(clean.condition, 1.0, rtol=1e-9)
    crossed = planned(ask(cross=0.2).plan).condition
    assert crossed.min() > 1.03
    noisy = {"tolerances": EXACT, "noise": "50"}
    base, loud = (pretest.findings(ask(level=level, **noisy)).best.half_width for level in (0.2, 1.0))
    # noise far above the floor: five times the level, a fifth of the interval - less what is known of the residual before
    assert 3.0 < base[0] / loud[0] < 5.0


def test_sensors_of_a_campaign_of_ones_own_take_the_place_of_the_usual_ones(
    ask,
    root,
    tmp_path,  # type: ignore[no-untyped-def]
):
    import runpy

    from identification import campaign_file

    made = runpy.run_path(str(root / "examples" / "own_campaign.py"))["campaign"]()
    campaign_file.write(tmp_path / "own", made)
    found = ask(sensors=tmp_path / "own")
    assert found.table.names == made.table.names
    assert found.table.channels[0].noise_rms == made.table.channels[0].noise_rms
    assert pretest.findings(found).spectra.table is found.table


@pytest.mark.parametrize("article", ["clumod-1", "fmd+clumod-1"])
def test_an_article_stands_on_the_fmd_whether_that_is_said_or_not(ask, article):
    assert ask(article).plan.article == "fmd+clumod-1"
    assert ask(article).above == "clumod-1"


SEAT = np.array([0.0, 0.0, 0.045])
LINES = np.array([4.0, 6.0, 9.0])


def test_the_elastic_share_of_nodes_is_that_of_the_equations_of_motion_themselves():
    """(K - omega² M) x = omega² M R u without modes: relative displacements, from the matrices of the model."""
    model = flexible("clumod-1", "beam", FlexibleOptions(count=40))
    structure = model.structure
    share = pretest.elastic_share(
        node_displacement(structure, model.modes.shapes), structure.points + SEAT, model.modes, SEAT, LINES
    )
    K, M, free = structure.stiffness.toarray(), structure.mass.toarray(), structure.free
    R = structure.rigid @ rigid_transformation_6(SEAT)
    arm = np.maximum(np.linalg.norm(structure.points + SEAT, axis=1), 0.05)
    for n, f in enumerate(LINES):
        omega2 = (2 * np.pi * f) ** 2
        x = np.zeros_like(R)
        x[free] = np.linalg.solve((K - omega2 * M)[np.ix_(free, free)], omega2 * (M @ R)[free])
        expected = omega2 * np.linalg.norm(x[structure.translations], axis=1) / omega2
        expected[:, 3:] /= arm[:, None]
        # 40 modes, whose truncation leaves 1e-3 of the largest; damping at these lines 1e-4
        assert_allclose(share[:, n], expected, rtol=0, atol=3e-3 * expected.max())


def test_the_largest_share_of_a_surface_is_the_largest_over_its_lines():
    model = flexible("clumod-1", "beam", FlexibleOptions(count=8))
    of = (node_displacement(model.structure, model.modes.shapes), model.structure.points + SEAT, model.modes, SEAT, LINES)
    first, most = pretest.largest_share(*of)
    share = pretest.elastic_share(*of).max(axis=2)
    assert_allclose(first, share[:, 0])
    assert_allclose(most, share.max(axis=1))
    assert most.max() > 2 * first.max()


def test_a_place_on_the_held_flange_is_rigid_and_a_tip_is_not():
    model = flexible("clumod-1", "beam", FlexibleOptions(count=20))
    found = {one.name: one for one in pretest.judged(model, locations("clumod-1"), SEAT, np.linspace(4, 32, 113), 0.01)}
    assert found["flange"].largest == 0
    assert found["flange"].within == 1
    assert found["lower-1+"].up_to is None
    assert found["lower-1+"].largest > found["lower-1+"].at_start > 0.05
    assert found["mast-top"].axis in MOTIONS
    assert next(iter(found)) == "flange"  # the most rigid first


def test_elastic_motion_falls_with_the_square_of_the_frequency_and_up_to_and_within_are_those_of_the_lines():
    model = flexible("disc+cuboid", "beam", FlexibleOptions(count=20))
    top = {"top": locations("disc+cuboid")["top"]}
    (low,), (high,) = (pretest.judged(model, top, SEAT, np.array([f, f + 0.01]), 0.01) for f in (2.0, 4.0))
    assert_allclose(high.at_start / low.at_start, 4.0, rtol=0.02)  # the first mode lies at some 100 Hz or more
    lines, top = np.linspace(4, 60, 225), {"top": locations("disc+cuboid")["top"]}
    (found,) = pretest.judged(model, top, SEAT, lines, 0.01)
    assert found.up_to is not None
    (below,) = pretest.judged(model, top, SEAT, lines[lines <= found.up_to], 0.01)
    assert below.within == 1
    assert below.largest <= 0.01 < found.largest
    assert_allclose(found.within, np.mean(lines <= found.up_to))


def test_the_rigid_height_of_an_axis_grows_with_what_is_allowed_and_coarse_lines_hold_every_eigenfrequency():
    model = flexible("clumod-1", "beam", FlexibleOptions(count=20))
    lines = np.linspace(4, 9, 21)
    heights = [pretest.rigid_height(model, 1.6, SEAT, lines, limit) for limit in (0.01, 0.05, 0.5)]
    assert heights[0] is not None
    assert heights[1] is not None
    assert SEAT[2] < heights[0] < heights[1]
    assert pretest.rigid_height(model, 1.6, SEAT, lines, 1e6) is None
    lines = pretest.coarse_lines(np.linspace(4, 32, 561), model.modes)
    own = model.modes.frequency[model.modes.frequency < 32]
    assert set(own) <= set(lines)
    assert (lines[0], lines[-1]) == (4.0, 32.0)
