"""The three routes agree, each can be caught when it does not; OCC's solids, and Pinocchio's order and signs."""

import sys
from dataclasses import replace

import numpy as np
import pinocchio
import pytest
from hypothesis import given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry import cad, routes
from geometry.article import Article, Box, Cylinder, Part, Placed, Shape, drilled, material, placed, upright
from geometry.articles import NAMES, SETUPS, built_in
from geometry.cad import MM, solid
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.inertia import Inertia
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


@pytest.mark.parametrize("name", [*NAMES, *SETUPS])
def test_closed_forms_are_those_of_pinocchio_without_importing_it(name: str, monkeypatch: pytest.MonkeyPatch) -> None:
    theirs = routes.by_pinocchio(built_in(name)).parameters
    monkeypatch.setitem(sys.modules, "pinocchio", None)
    assert_allclose(routes.inertia(built_in(name)).parameters, theirs, rtol=1e-12, atol=1e-12 * np.abs(theirs).max())


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
    "voids",
    [
        drilled([[0.0, 0.0]], diameter=0.02, bottom=-0.01, depth=0.05),
        drilled([[0.0, 0.0], [0.01, 0.0]], diameter=0.02, bottom=0.0, depth=0.05),
    ],
    ids=["leaves the material", "meets another"],
)
def test_a_void_that_is_drawn_wrongly_shows_as_a_disagreement(voids: tuple[Placed, ...]) -> None:
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


@pytest.mark.parametrize("name", SETUPS)
def test_no_two_bodies_of_a_set_up_overlap(name: str) -> None:
    assert cad.overlaps(built_in(name)) == {}


def test_an_overlap_is_found_and_measured() -> None:
    """A disc sunk by a millimetre into the cover plate shares what it displaces, counted by its solid area."""
    fmd, disc = built_in("fmd"), built_in("disc")
    sunk = placed(disc, Pose(position=[0, 0, 0.0445 - 0.0005]))
    both = Article(name="both", parts=fmd.parts + sunk.parts)
    (pair, shared), *rest = cad.overlaps(both).items()
    assert rest == []
    assert set(pair) == {"cover-plate", "plate"}
    plate = solid(disc.parts[0])
    assert shared == pytest.approx(plate.Volume() * MM**3 / 0.0145 * 0.001, rel=1e-6)


def test_uncounted_parts_are_looked_at_too() -> None:
    cuboid = built_in("cuboid")
    ghost = replace(cuboid.parts[0], name="ghost", counted=False)
    assert cad.overlaps(Article(name="two", parts=(*cuboid.parts, ghost)))


def test_uncounted_parts_have_no_inertia() -> None:
    fmd = built_in("fmd")
    counted = Article(name="fmd", parts=fmd.counted_parts)
    assert len(counted.parts) < len(fmd.parts)
    assert_allclose(cad.inertia(fmd).parameters, cad.inertia(counted).parameters, rtol=0)


def in_pinocchio(inertia: Inertia) -> pinocchio.Inertia:
    """About the frame's origin."""
    return pinocchio.Inertia(inertia.mass, inertia.cog.copy(), inertia.tensor_cog)


coordinates = st.lists(st.floats(-1, 1), min_size=10, max_size=10)


@settings(max_examples=50, deadline=None)
@given(coordinates)
def test_any_body_goes_to_pinocchio_and_back(values: list[float]) -> None:
    inertia = routes.from_log_cholesky(np.array(values))
    back = routes.from_pinocchio(in_pinocchio(inertia))
    assert_allclose(back.parameters, inertia.parameters, rtol=1e-9, atol=1e-9 * np.abs(inertia.parameters).max())


@settings(max_examples=50, deadline=None)
@given(coordinates)
def test_log_cholesky_coordinates_go_there_and_back(values: list[float]) -> None:
    assert_allclose(routes.log_cholesky(routes.from_log_cholesky(np.array(values))), values, atol=1e-9)


def test_regressor_times_parameters_is_the_wrench() -> None:
    """The ten parameters in Pinocchio's order give the wrench of its recursive Newton-Euler equations: order and signs hold."""
    rng = np.random.default_rng(1)
    inertia = routes.from_log_cholesky(rng.normal(size=10) / 2)
    body = in_pinocchio(inertia)
    velocity, acceleration = pinocchio.Motion(rng.normal(size=6)), pinocchio.Motion(rng.normal(size=6))
    regressor = pinocchio.bodyRegressor(velocity, acceleration)
    in_their_order = np.empty(10)
    in_their_order[routes.FROM_PINOCCHIO] = inertia.parameters
    wrench = body * acceleration + body.vxiv(velocity)
    assert_allclose(regressor @ in_their_order, wrench.vector, rtol=1e-12, atol=1e-12)


def test_mass_matrix_of_eq_1_is_pinocchios() -> None:
    inertia = routes.inertia(built_in("fmd+clumod-1"))
    assert_allclose(inertia.mass_matrix, in_pinocchio(inertia).matrix(), rtol=1e-12, atol=1e-12)


def test_ideal_bodies_have_no_log_cholesky_coordinates() -> None:
    rod = Inertia.from_cog(1.0, [0, 0, 0], np.diag([1.0, 1.0, 0.0]))
    with pytest.raises(BadInput, match="body with volume"):
        routes.log_cholesky(rod)
