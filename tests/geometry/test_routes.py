"""The three routes agree, each can be caught when it does not, and the mesh converges at the rate of its chord error."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry import cad, routes
from geometry.article import Article, Box, Cylinder, Part, Placed, Shape, drilled, material, upright
from geometry.articles import NAMES, SETUPS, built_in
from geometry.frames import Pose, rotation_about
from geometry.routes import ROUTES, agreement, by_mesh, by_routes, tessellation_error

COARSE = 2e-5
"""Chord error [m] that keeps the tests quick."""


def _block(**changes: object) -> Article:
    box = Placed(primitive=Box(size=[0.16, 0.07, 0.4]), pose=Pose(position=[0.01, -0.02, 0.3], rotation=rotation_about("x", 0.4)))
    part = Part(name="block", material=material("aluminium"), shape=Shape(solids=(box,)), pose=Pose(position=[0.5, 0.2, -0.1]))
    return Article(name="block", parts=(replace(part, **changes),))


@pytest.mark.parametrize("name", [*NAMES, *(pytest.param(name, marks=pytest.mark.proof) for name in SETUPS)])
def test_three_routes_agree_on_every_built_in_and_the_exact_ones_to_rounding(name: str) -> None:
    article = built_in(name)
    inertias = by_routes(article, COARSE)
    assert tuple(inertias) == ROUTES
    assert agreement(article, inertias, COARSE).agree
    occ, pinocchio = inertias["occ"].parameters, inertias["pinocchio"].parameters
    # relative to the largest parameter: products and lateral moments of symmetrical articles are zero
    assert_allclose(occ, pinocchio, rtol=1e-9, atol=1e-12 * np.abs(occ).max())


def test_planar_part_agrees_to_1e_9_on_all_routes_at_any_chord() -> None:
    inertias = by_routes(_block(), chord=1e-2)
    for inertia in inertias.values():
        assert_allclose(inertia.parameters, inertias["occ"].parameters, rtol=1e-9, atol=1e-9)
    assert_allclose(tessellation_error(_block(), 1e-2), 0, atol=0)
    assert agreement(_block(), inertias, chord=1e-2).agree


def test_block_has_the_closed_form_of_a_cuboid() -> None:
    box = Part(name="b", material=material("steel"), shape=Shape(solids=(upright(Box(size=[0.3, 0.2, 0.1]), bottom=-0.05),)))
    inertia = cad.inertia(Article(name="b", parts=(box,)))
    m = 7850 * 0.3 * 0.2 * 0.1
    assert inertia.mass == pytest.approx(m, rel=1e-12)
    expected = m / 12 * np.array([0.2**2 + 0.1**2, 0.3**2 + 0.1**2, 0.3**2 + 0.2**2])
    assert_allclose(inertia.moments_cog, expected, rtol=1e-12)


@pytest.mark.parametrize("route", ROUTES)
def test_inertia_grows_with_the_fifth_power_of_length(route: str) -> None:
    """Constant density, every length times s: mass s³, first moment s⁴, tensor s⁵; the mesh's chord error scales along."""
    s = 2.5
    small = by_routes(_tube(1.0), COARSE)[route]
    large = by_routes(_tube(s), COARSE * s)[route]
    powers = np.array([3, 4, 4, 4, 5, 5, 5, 5, 5, 5])
    # OCC places mesh vertices to about 1e-7 of the body
    assert_allclose(large.parameters, small.parameters * s**powers, rtol=1e-6, atol=1e-7)


@pytest.mark.parametrize("route", ROUTES)
def test_turning_the_part_turns_the_tensor(route: str) -> None:
    R = rotation_about("z", 0.7) @ rotation_about("y", -0.4)
    straight, turned = _tube(1.0), _tube(1.0, Pose(rotation=R))
    expected = by_routes(straight, COARSE)[route].rotated(R)
    tolerance = 1e-9 if route != "trimesh" else 2e-4  # the mesher starts its polygons elsewhere after a turn
    assert_allclose(by_routes(turned, COARSE)[route].parameters, expected.parameters, rtol=tolerance, atol=tolerance * 0.1)


def test_mesh_route_converges_linearly_in_the_chord_error() -> None:
    """An inscribed polygon misses an area proportional to its sagitta: order one in the chord error, two in the edge length."""
    article = built_in("disc")
    exact = routes.inertia(article).parameters
    chords = 4e-5 / 4.0 ** np.arange(3)
    errors = [np.abs(by_mesh(article, chord).parameters - exact)[[0, 4, 6]] for chord in chords]
    rates = np.polyfit(np.log(chords), np.log(errors), 1)[0]
    assert_allclose(rates, 1, atol=0.15)


@pytest.mark.parametrize(
    ("name", "chord"),
    [
        *((name, chord) for name in ("cuboid", "disc") for chord in (1e-4, 1e-5)),
        *(pytest.param("fmd+clumod-4", chord, marks=pytest.mark.proof) for chord in (1e-4, 1e-5)),
    ],
)
def test_mesh_error_stays_within_the_bound_that_is_stated(name: str, chord: float) -> None:
    article = built_in(name)
    error = np.abs(by_mesh(article, chord).parameters - routes.inertia(article).parameters)
    bound = tessellation_error(article, chord)
    assert np.all(error <= bound + 1e-9)
    assert error[0] > bound[0] / 100  # a bound that is a hundred times too wide would prove nothing


@pytest.mark.parametrize("route", ROUTES)
def test_a_route_that_is_off_is_named(route: str) -> None:
    inertias = dict(by_routes(built_in("cuboid"), COARSE))
    inertias[route] = inertias[route].moved([0.0, 0.0, 1e-4])
    verdict = agreement(built_in("cuboid"), inertias, COARSE)
    assert not verdict.agree
    assert verdict.excess > 1
    assert route in verdict.text
    assert "disagree" in verdict.text


@pytest.mark.parametrize(
    ("description", "voids"),
    [
        ("leaves the material", drilled([[0.0, 0.0]], diameter=0.02, bottom=-0.01, depth=0.05)),
        ("meets another", drilled([[0.0, 0.0], [0.01, 0.0]], diameter=0.02, bottom=0.0, depth=0.05)),
    ],
)
def test_a_void_that_is_drawn_wrongly_shows_as_a_disagreement(description: str, voids: tuple[Placed, ...]) -> None:
    del description
    shape = Shape(solids=(upright(Box(size=[0.1, 0.1, 0.1]), bottom=0.0),), voids=voids)
    article = Article(name="a", parts=(Part(name="p", material=material("steel"), shape=shape),))
    assert not agreement(article, by_routes(article, COARSE), COARSE).agree


def _tube(scale: float, pose: Pose | None = None) -> Article:
    outer, inner = (Cylinder(diameter=d * scale, height=0.3 * scale) for d in (0.1, 0.06))
    shape = Shape(
        solids=(upright(outer, bottom=0.05 * scale, x=0.02 * scale),),
        voids=(upright(inner, bottom=0.05 * scale, x=0.02 * scale),),
    )
    part = Part(name="tube", material=material("steel"), shape=shape, pose=pose or Pose())
    return Article(name="tube", parts=(part,))
