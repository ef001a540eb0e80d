"""The judge of ten parameters: bodies, ideal bodies, and numbers that no body has."""

import numpy as np
import pytest
from hypothesis import assume, given
from hypothesis import strategies as st
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.frames import Array, Pose, rotation_about
from geometry.inertia import Inertia, Kind, judge, require_physical

ROD = np.array([0.0, 0.3, 0.3])
LAMINA = np.array([0.1, 0.2, 0.3])
POINT = np.zeros(3)
IMPOSSIBLE = np.array([0.1, 0.2, 0.31])

seeds = st.integers(0, 2**32 - 1)
ideals = st.sampled_from([ROD, LAMINA, POINT])


Place = tuple[float, float, float]


def turned(moments: Array, seed: int = 0, *, cog: Place = (0.0, 0.0, 0.0), mass: float = 2.0) -> Inertia:
    """A body of principal `moments` in a random attitude with its CoG at `cog`."""
    where = Pose(position=np.array(cog), rotation=rotation(seed))
    return Inertia.from_cog(mass, (0.0, 0.0, 0.0), np.diag(moments)).placed(where)


def rotation(seed: int) -> Array:
    Q, _ = np.linalg.qr(np.random.default_rng(seed).normal(size=(3, 3)))
    return np.array(Q * np.linalg.det(Q))


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


def test_a_diagonal_that_obeys_the_triangle_inequality_proves_nothing() -> None:
    """Principal moments 0.1, 1, 1.9 turned by 45° about the first: the diagonal reads 0.1, 1.45, 1.45."""
    inertia = Inertia.from_cog(1.0, (0, 0, 0), np.diag([0.1, 1.0, 1.9])).rotated(rotation_about("x", np.pi / 4))
    xx, yy, zz = inertia.moments_cog
    assert xx + yy >= zz
    assert xx + zz >= yy
    assert yy + zz >= xx
    verdict = judge(inertia)
    assert verdict.kind is Kind.UNPHYSICAL
    assert not verdict.physical
    assert_allclose(verdict.margin[0], -0.8, rtol=1e-12)
    assert np.linalg.eigvalsh(inertia.pseudo_inertia)[0] < 0


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
    """A 30 g lamina, rod or point of a few centimetres: the parallel-axis terms outweigh its moments by ten decades."""
    far = turned(moments * 1e-4, seed, cog=(600.0, -700.0, 400.0), mass=0.03)
    assert judge(far).physical


@given(seeds, ideals)
def test_nor_is_it_when_it_is_looked_at_from_its_own_cog(seed: int, moments: Array) -> None:
    """The digits are lost on the way through the frame's origin and do not come back with another reference point."""
    far = turned(moments * 1e-4, seed, cog=(600.0, -700.0, 400.0), mass=0.03)
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


def test_what_is_physical_passes_the_door_unchanged() -> None:
    inertia = turned(LAMINA, 1)
    assert require_physical(inertia, "file.toml") is inertia


def test_what_is_not_is_turned_away_with_the_source_the_figures_and_what_to_do() -> None:
    with pytest.raises(BadInput) as caught:
        require_physical(turned(IMPOSSIBLE, 1), "file.toml")
    assert caught.value.source == "file.toml"
    assert caught.value.field == "inertia"
    assert "0.1, 0.2, 0.31 kg m² break the triangle inequality by 0.01 kg m²" in caught.value.problem
    assert "Check signs, units and the reference point" in caught.value.remedy
