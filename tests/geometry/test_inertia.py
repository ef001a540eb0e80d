"""The ten parameters, what may be done to them, and whether a body can have them."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.frames import Array, Pose, rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia, Kind, judge, require_physical

ROUNDING = {"rtol": 0.0, "atol": 1e-10}
"""Points lie within 10 m, masses add up to less than 100 kg: terms of 1e4 kg m², of which double keeps 1e-12."""

seeds = st.integers(0, 2**32 - 1)
points = st.tuples(*[st.floats(-5, 5)] * 3).map(np.array)


class Cloud:
    """Point masses [kg] at points (n, 3) [m]."""

    def __init__(self, masses: Array, places: Array) -> None:
        self.masses, self.places = masses, places

    @staticmethod
    def random(seed: int) -> "Cloud":
        rng = np.random.default_rng(seed)
        return Cloud(rng.uniform(0.1, 10, 8), rng.uniform(-2, 2, (8, 3)))

    def inertia(self, about: Array | tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Inertia:
        m, (x, y, z) = self.masses, (self.places - about).T
        moments = (m @ (y**2 + z**2), m @ (x**2 + z**2), m @ (x**2 + y**2))
        products = (-m @ (x * y), -m @ (x * z), -m @ (y * z))
        return Inertia(
            parameters=np.array([m.sum(), m @ x, m @ y, m @ z, *moments, *products]), reference_point=np.asarray(about)
        )


def pose(seed: int) -> Pose:
    """A random place and a random proper rotation."""
    rng = np.random.default_rng(seed)
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return Pose(position=rng.uniform(-3, 3, 3), rotation=Q * np.linalg.det(Q))


clouds = seeds.map(Cloud.random)
poses = seeds.map(pose)


def assert_same(found: Inertia, expected: Inertia) -> None:
    assert_allclose(found.reference_point, expected.reference_point, **ROUNDING)
    assert_allclose(found.parameters, expected.parameters, **ROUNDING)


@given(clouds, points)
def test_the_mass_matrix_of_eq_1_is_the_sum_of_g_transposed_m_g_of_eq_3(cloud: Cloud, about: Array) -> None:
    G = [rigid_transformation(place - about) for place in cloud.places]
    expected = sum(m * g.T @ g for m, g in zip(cloud.masses, G, strict=True))
    assert_allclose(cloud.inertia(about).mass_matrix, expected, **ROUNDING)


@given(clouds, points, points)
def test_the_mass_matrix_moves_to_another_point_by_congruence_with_the_rigid_transformation(
    cloud: Cloud, here: Array, there: Array
) -> None:
    G = rigid_transformation_6(here - there)
    assert_allclose(cloud.inertia(there).mass_matrix, G.T @ cloud.inertia(here).mass_matrix @ G, **ROUNDING)


@given(clouds, points)
def test_ten_parameters_and_mass_matrix_say_the_same(cloud: Cloud, about: Array) -> None:
    inertia = cloud.inertia(about)
    assert_same(Inertia.from_mass_matrix(inertia.mass_matrix, about), inertia)


def test_products_are_matrix_entries_with_their_minus_sign() -> None:
    inertia = Cloud(np.array([2.0]), np.array([[1.0, 3.0, 5.0]])).inertia()
    assert inertia.tensor[0, 1] == -6.0
    assert inertia.tensor[0, 2] == -10.0
    assert inertia.tensor[1, 2] == -30.0
    assert_allclose(inertia.parameters[4:], [68.0, 52.0, 20.0, -6.0, -10.0, -30.0], rtol=0)


@given(clouds, points)
def test_the_cog_is_where_it_is_whatever_the_reference_point(cloud: Cloud, about: Array) -> None:
    assert_allclose(cloud.inertia(about).cog, np.average(cloud.places, axis=0, weights=cloud.masses), **ROUNDING)


@given(clouds, points)
def test_the_tensor_about_the_cog_is_that_of_the_cloud_about_its_cog(cloud: Cloud, about: Array) -> None:
    inertia = cloud.inertia(about)
    expected = cloud.inertia(inertia.cog)
    assert_allclose(inertia.tensor_cog, expected.tensor, **ROUNDING)
    assert_allclose(inertia.moments_cog, expected.parameters[4:7], **ROUNDING)
    assert_allclose(inertia.products_cog, expected.parameters[7:], **ROUNDING)


@given(clouds, points)
def test_from_cog_undoes_cog_and_tensor_about_it(cloud: Cloud, about: Array) -> None:
    inertia = cloud.inertia(about)
    assert_same(Inertia.from_cog(inertia.mass, inertia.cog, inertia.tensor_cog, about), inertia)


@given(clouds)
def test_principal_axes_diagonalise_the_tensor_and_are_right_handed(cloud: Cloud) -> None:
    inertia = cloud.inertia()
    moments, axes = inertia.principal()
    assert np.all(np.diff(moments) >= 0)
    assert_allclose(axes.T @ inertia.tensor_cog @ axes, np.diag(moments), **ROUNDING)
    assert_allclose(axes.T @ axes, np.eye(3), **ROUNDING)
    assert_allclose(np.cross(axes[:, 0], axes[:, 1]), axes[:, 2], **ROUNDING)


@given(clouds, points, points)
def test_about_another_point_is_the_cloud_about_that_point_and_back(cloud: Cloud, here: Array, there: Array) -> None:
    inertia = cloud.inertia(here)
    assert_same(inertia.about(there), cloud.inertia(there))
    assert_same(inertia.about(there).about(here), inertia)


@given(clouds, points, points)
def test_moved_is_the_cloud_moved_about_the_same_point(cloud: Cloud, about: Array, displacement: Array) -> None:
    there = Cloud(cloud.masses, cloud.places + displacement)
    assert_same(cloud.inertia(about).moved(displacement), there.inertia(about))


@given(clouds, points, poses)
def test_rotated_is_the_cloud_rotated_about_the_origin(cloud: Cloud, about: Array, where: Pose) -> None:
    turned = Cloud(cloud.masses, cloud.places @ where.rotation.T)
    assert_same(cloud.inertia(about).rotated(where.rotation), turned.inertia(about))


@given(clouds, points, poses)
def test_placed_is_the_cloud_placed_and_is_rotate_then_move(cloud: Cloud, about: Array, where: Pose) -> None:
    inertia = cloud.inertia(about)
    there = Cloud(cloud.masses, where.apply(cloud.places)).inertia()
    assert_same(inertia.placed(where), there)
    assert_same(inertia.about(np.zeros(3)).rotated(where.rotation).moved(where.position), there)


@given(clouds, poses, poses)
def test_placing_twice_is_placing_by_the_product_and_the_inverse_brings_it_back(cloud: Cloud, inner: Pose, outer: Pose) -> None:
    inertia = cloud.inertia()
    assert_same(inertia.placed(inner).placed(outer), inertia.placed(outer @ inner))
    assert_same(inertia.placed(outer).placed(outer.inverse), inertia)


@given(clouds, clouds, points, points)
def test_a_sum_is_the_joint_cloud_about_the_point_of_the_first(a: Cloud, b: Cloud, here: Array, there: Array) -> None:
    joint = Cloud(np.concatenate([a.masses, b.masses]), np.concatenate([a.places, b.places]))
    assert_same(a.inertia(here) + b.inertia(there), joint.inertia(here))


@given(clouds, clouds, poses, poses)
def test_the_tare_of_a_stack_leaves_the_article_that_was_put_on_it(base: Cloud, top: Cloud, seat: Pose, table: Pose) -> None:
    stack = (base.inertia() + top.inertia().placed(seat)).placed(table)
    left = (stack - base.inertia().placed(table)).placed((table @ seat).inverse)
    assert_same(left, top.inertia())


@given(clouds, points)
def test_a_massless_difference_moves_to_another_point_too(cloud: Cloud, there: Array) -> None:
    """Two clouds of one mass at different places: their difference has no CoG, yet a first moment and a tensor."""
    other = Cloud(cloud.masses, cloud.places[::-1])
    assert_same((cloud.inertia() - other.inertia()).about(there), cloud.inertia(there) - other.inertia(there))


@given(clouds, st.floats(0.1, 10))
def test_lengths_times_s_at_one_density_give_inertia_times_s_to_the_fifth(cloud: Cloud, s: float) -> None:
    big = Cloud(cloud.masses * s**3, cloud.places * s).inertia()
    powers = np.repeat([s**3, s**4, s**5], [1, 3, 6])
    assert_allclose(big.parameters, cloud.inertia().parameters * powers, rtol=1e-9, atol=1e-10 * s**5)


@given(clouds, points, st.floats(0.1, 10))
def test_another_density_scales_all_ten_and_leaves_the_cog(cloud: Cloud, about: Array, ratio: float) -> None:
    scaled = cloud.inertia(about).scaled(ratio)
    assert_same(scaled, Cloud(cloud.masses * ratio, cloud.places).inertia(about))


@pytest.mark.parametrize("wrong", [np.ones(9), np.ones((10, 1)), np.full(10, np.nan), np.full(10, np.inf)])
def test_wrong_shape_and_not_finite_are_refused_by_name(wrong: Array) -> None:
    with pytest.raises(ValueError, match="`parameters` must"):
        Inertia(parameters=wrong)


def test_without_mass_there_is_no_cog() -> None:
    with pytest.raises(ValueError, match=r"`mass` must not be zero .* found 0 kg"):
        _ = Inertia(parameters=np.zeros(10)).cog


@pytest.mark.parametrize(("row", "column"), [(0, 0), (1, 1), (0, 1), (0, 3), (4, 0), (3, 5)])
def test_a_matrix_that_no_rigid_body_has_is_refused(row: int, column: int) -> None:
    M = np.array(Cloud.random(1).inertia().mass_matrix)
    M[row, column] += 0.5
    with pytest.raises(ValueError, match="mass matrix of a rigid body"):
        Inertia.from_mass_matrix(M)


ROD = np.array([0.0, 0.3, 0.3])
LAMINA = np.array([0.1, 0.2, 0.3])
POINT = np.zeros(3)
IMPOSSIBLE = np.array([0.1, 0.2, 0.31])

ideals = st.sampled_from([ROD, LAMINA, POINT])


Place = tuple[float, float, float]


def turned(moments: Array, seed: int = 0, *, cog: Place = (0.0, 0.0, 0.0), mass: float = 2.0) -> Inertia:
    """A body of principal `moments` in a random attitude with its CoG at `cog`."""
    where = Pose(position=np.array(cog), rotation=pose(seed).rotation)
    return Inertia.from_cog(mass, (0.0, 0.0, 0.0), np.diag(moments)).placed(where)


@given(seeds, st.tuples(*[st.floats(0.01, 1)] * 3), st.tuples(*[st.floats(-2, 2)] * 3))
def test_the_pseudo_inertia_is_positive_definite_exactly_when_the_principal_moments_obey_the_triangle_inequality(
    seed: int, moments: tuple[float, float, float], cog: Place
) -> None:
    inertia = turned(np.array(moments), seed, cog=cog)
    smallest = np.linalg.eigvalsh(inertia.pseudo_inertia)[0]
    margin = sum(moments) - 2 * max(moments)
    assume(abs(margin) > 1e-9)
    assert (smallest > 0) == (margin > 0)
    assert judge(inertia).kind is (Kind.BODY if margin > 0 else Kind.UNPHYSICAL)
    assert_allclose(judge(inertia).margin[0], margin, rtol=0, atol=1e-12)


@given(seeds, ideals, st.tuples(*[st.floats(-10, 10)] * 3))
def test_point_mass_rod_and_lamina_are_ideal_in_every_attitude_and_place(seed: int, moments: Array, cog: Place) -> None:
    verdict = judge(turned(moments, seed, cog=cog))
    assert verdict.kind is Kind.IDEAL
    assert verdict.physical
    assert "point mass, rod or lamina" in verdict.text


@pytest.mark.parametrize(
    "moments",
    [
        pytest.param([2 / 3, 2 / 3, 2 / 3], id="thin spherical shell"),
        pytest.param([0.5 + 4 / 12, 0.5 + 4 / 12, 1.0], id="thin open tube, length twice the radius"),
        pytest.param([0.25 + 1e-8 / 12, 0.25 + 1e-8 / 12, 0.5], id="disc a ten-thousandth of its radius thick"),
        pytest.param([5e-9, 1 / 12, 1 / 12], id="rod of radius 1e-4"),
    ],
)
def test_hollow_and_thin_bodies_are_bodies(moments: list[float]) -> None:
    assert judge(turned(np.array(moments), 5, mass=1.0)).kind is Kind.BODY


@given(seeds)
def test_noise_far_above_rounding_makes_a_lamina_a_body_or_no_body_as_its_sign_says(seed: int) -> None:
    noise = np.array([0.0, 0.0, np.random.default_rng(seed).uniform(1e-6, 1e-3)])
    assert judge(turned(LAMINA - noise, seed)).kind is Kind.BODY
    assert judge(turned(LAMINA + noise, seed)).kind is Kind.UNPHYSICAL


@given(seeds, ideals)
def test_a_small_body_a_kilometre_away_is_not_accused_of_the_rounding(seed: int, moments: Array) -> None:
    """A 30 g lamina, rod or point of a few centimetres: the parallel-axis terms outweigh its moments by ten decades.

    The digits are lost on the way through the frame's origin and do not come back with another reference point.
    """
    far = turned(moments * 1e-4, seed, cog=(600.0, -700.0, 400.0), mass=0.03)
    assert judge(far).physical
    assert judge(far.about(far.cog)).physical


@given(seeds, st.sampled_from([1e-6, 1e-3, 1.0, 1e3]), st.sampled_from([1e-3, 1.0, 1e6]))
def test_the_verdict_does_not_depend_on_the_size_of_the_body(seed: int, length: float, mass: float) -> None:
    """A watch's balance wheel and a ship are judged alike, near the origin."""
    for moments, kind in ((IMPOSSIBLE, Kind.UNPHYSICAL), (LAMINA, Kind.IDEAL), (LAMINA - [0, 0, 0.01], Kind.BODY)):
        small = turned(moments * mass * length**2, seed, cog=(length, 2 * length, -length), mass=mass)
        assert judge(small).kind is kind


@pytest.mark.parametrize("mass", [0.0, -1.0])
def test_without_positive_mass_it_is_no_body(mass: float) -> None:
    verdict = judge(Inertia(parameters=np.array([mass, 0, 0, 0, 1, 1, 1, 0, 0, 0])))
    assert verdict.kind is Kind.UNPHYSICAL
    assert f"the mass must be positive, found {mass:g} kg" in verdict.text
    assert np.all(np.isnan(verdict.margin))


def test_a_negative_moment_is_no_body() -> None:
    assert judge(turned(np.array([-0.1, 0.2, 0.2]), 3)).kind is Kind.UNPHYSICAL


def test_the_door_lets_a_body_pass_and_turns_others_away_with_the_source_the_figures_and_what_to_do() -> None:
    inertia = turned(LAMINA, 1)
    assert require_physical(inertia, "file.toml") is inertia
    with pytest.raises(BadInput) as caught:
        require_physical(turned(IMPOSSIBLE, 1), "file.toml")
    assert caught.value.source == "file.toml"
    assert caught.value.field == "inertia"
    assert "0.1, 0.2, 0.31 kg m² break the triangle inequality by 0.01 kg m²" in caught.value.problem
    assert "Check signs, units and the reference point" in caught.value.remedy
