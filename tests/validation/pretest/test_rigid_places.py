"""Elastic motion of places against a direct solution, and its limits."""

import numpy as np
from numpy.testing import assert_allclose

from geometry.articles.locations import locations
from geometry.dynamic_mass import MOTIONS
from geometry.frames import rigid_transformation, rigid_transformation_6
from validation.flexible.model import FlexibleOptions, flexible
from validation.flexible.modes import node_displacement
from validation.identify.pretest import coarse_lines, elastic_share, judged, largest_share, rigid_height

SEAT = np.array([0.0, 0.0, 0.045])
LINES = np.array([4.0, 6.0, 9.0])


def test_the_elastic_share_of_nodes_is_that_of_the_equations_of_motion_themselves() -> None:
    """(K - omega² M) x = omega² M R u without modes: relative displacements, from the matrices of the model."""
    model = flexible("clumod-1", "beam", FlexibleOptions(count=40))
    structure = model.structure
    share = elastic_share(node_displacement(structure, model.modes.shapes), structure.points + SEAT, model.modes, SEAT, LINES)
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


def test_the_largest_share_of_a_surface_is_the_largest_over_its_lines() -> None:
    model = flexible("clumod-1", "beam", FlexibleOptions(count=8))
    of = (node_displacement(model.structure, model.modes.shapes), model.structure.points + SEAT, model.modes, SEAT, LINES)
    first, most = largest_share(*of)
    share = elastic_share(*of).max(axis=2)
    assert_allclose(first, share[:, 0])
    assert_allclose(most, share.max(axis=1))
    assert most.max() > 2 * first.max()


def test_a_place_on_the_held_flange_is_rigid_and_a_tip_is_not() -> None:
    model = flexible("clumod-1", "beam", FlexibleOptions(count=20))
    found = {one.name: one for one in judged(model, locations("clumod-1"), SEAT, np.linspace(4, 32, 113), 0.01)}
    assert found["flange"].largest == 0
    assert found["flange"].within == 1
    assert found["lower-1+"].up_to is None
    assert found["lower-1+"].largest > found["lower-1+"].at_start > 0.05
    assert found["mast-top"].axis in MOTIONS
    assert next(iter(found)) == "flange"  # the most rigid first


def test_elastic_motion_falls_with_the_square_of_the_frequency() -> None:
    model = flexible("disc+cuboid", "beam", FlexibleOptions(count=20))
    top = {"top": locations("disc+cuboid")["top"]}
    (low,), (high,) = (judged(model, top, SEAT, np.array([f, f + 0.01]), 0.01) for f in (2.0, 4.0))
    assert_allclose(high.at_start / low.at_start, 4.0, rtol=0.02)  # the first mode lies at some 100 Hz or more


def test_up_to_and_within_are_those_of_the_lines() -> None:
    model = flexible("disc+cuboid", "beam", FlexibleOptions(count=20))
    lines, top = np.linspace(4, 60, 225), {"top": locations("disc+cuboid")["top"]}
    (found,) = judged(model, top, SEAT, lines, 0.01)
    assert found.up_to is not None
    (below,) = judged(model, top, SEAT, lines[lines <= found.up_to], 0.01)
    assert below.within == 1
    assert below.largest <= 0.01 < found.largest
    assert_allclose(found.within, np.mean(lines <= found.up_to))


def test_the_rigid_height_of_an_axis_grows_with_what_is_allowed() -> None:
    model = flexible("clumod-1", "beam", FlexibleOptions(count=20))
    lines = np.linspace(4, 9, 21)
    heights = [rigid_height(model, 1.6, SEAT, lines, limit) for limit in (0.01, 0.05, 0.5)]
    assert heights[0] is not None
    assert heights[1] is not None
    assert SEAT[2] < heights[0] < heights[1]
    assert rigid_height(model, 1.6, SEAT, lines, 1e6) is None


def test_coarse_lines_hold_every_eigenfrequency_of_the_band() -> None:
    model = flexible("clumod-1", "beam", FlexibleOptions(count=20))
    lines = coarse_lines(np.linspace(4, 32, 561), model.modes)
    own = model.modes.frequency[model.modes.frequency < 32]
    assert set(own) <= set(lines)
    assert (lines[0], lines[-1]) == (4.0, 32.0)


def test_a_rotation_moves_a_rigid_article_by_its_distance() -> None:
    """The scale of the share of a rotation: what Eq. 3 gives at most at that distance."""
    point = np.array([0.1, -0.2, 0.7])
    most = np.linalg.norm(rigid_transformation(point)[:, 3:], axis=0).max()
    assert most <= np.linalg.norm(point)
