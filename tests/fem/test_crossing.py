"""Joints of Clumod's beam model from local solids: rigid motion is free, beams of beams need no joint."""

from collections.abc import Sequence

import numpy as np
import pytest
from numpy.testing import assert_allclose, assert_array_equal

from fem.beam import articles
from fem.beam.articles import ClumodPiece, Joint
from fem.beam.elements import tube
from fem.structure import rigid_motion
from geometry.article import material
from geometry.articles.parts import FOUR_BLADES, ONE_BLADE, Dimensions, load
from geometry.frames import rigid_transformation_6

SIZE = 0.045
"""[m] of the local solid's cells: coarse, the claims here hold at any."""


@pytest.fixture(scope="module")
def dimensions() -> Dimensions:
    return load("clumod")


def lower_1(blades: Sequence[str], d: Dimensions) -> ClumodPiece:
    return next(piece for piece in articles.pieces(blades, d) if piece.blades == ("lower-1",))


@pytest.fixture(scope="module")
def piece(dimensions: Dimensions) -> ClumodPiece:
    """The crossing of lower-1, cut out of Clumod with four blades."""
    return lower_1(FOUR_BLADES, dimensions)


@pytest.fixture(scope="module")
def flexibility(piece: ClumodPiece) -> np.ndarray:
    return articles.solid_flexibility(piece, SIZE)


@pytest.fixture(scope="module")
def joint(piece: ClumodPiece, flexibility: np.ndarray, dimensions: Dimensions) -> Joint:
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(articles, "_kept_flexibility", lambda *_: flexibility)
        return articles.joint(piece, dimensions, SIZE)


def test_the_pieces_are_the_foot_and_every_hub_with_a_blade_or_mast_above(dimensions: Dimensions) -> None:
    found = list(articles.pieces(FOUR_BLADES, dimensions))
    assert [each.blades for each in found] == [(), ("lower-1",), ("lower-2",), ("upper-long", "upper-short")]
    assert [each.foot for each in found] == [True, False, False, False]
    assert [each.blades for each in articles.pieces(ONE_BLADE, dimensions)] == [(), ("lower-1",), ()]


def test_flexibilities_are_symmetric_and_positive(piece: ClumodPiece, flexibility: np.ndarray) -> None:
    for found in (flexibility, articles.beam_flexibility(piece)):
        assert found.shape == (18, 18)
        assert_allclose(found, found.T, rtol=0, atol=1e-9 * np.abs(found).max())
        scale = np.sqrt(np.diag(found))
        assert np.linalg.eigvalsh(found / np.outer(scale, scale)).min() > 1e-9


def test_both_halves_of_a_blade_give_alike(piece: ClumodPiece, flexibility: np.ndarray) -> None:
    """Half a turn about the mast carries one port into the other: forces and moments across it change their sign.
    The mesh itself is not symmetric, and coarse."""
    turn = np.diag([-1.0, -1.0, 1.0, -1.0, -1.0, 1.0])
    for found in (flexibility, articles.beam_flexibility(piece)):
        scale = np.sqrt(np.outer(np.diag(found)[:6], np.diag(found)[:6]))
        assert_allclose((turn @ found[:6, :6] @ turn - found[6:12, 6:12]) / scale, 0, atol=2e-2)


def test_the_solid_gives_about_what_the_beams_give(piece: ClumodPiece, flexibility: np.ndarray) -> None:
    """A joint is a correction: no direction of any port gives less than half or more than twice of what the beams do."""
    ratio = np.diag(flexibility) / np.diag(articles.beam_flexibility(piece))
    assert np.all((ratio > 0.5) & (ratio < 2))


def test_a_joint_lets_its_ports_move_together(joint: Joint, dimensions: Dimensions) -> None:
    motion = rigid_motion(np.array([articles.place(port, dimensions) for port in joint.ports]))
    assert_allclose(joint.stiffness, joint.stiffness.T, rtol=0, atol=1e-12 * np.abs(joint.stiffness).max())
    assert np.abs(joint.stiffness @ motion).max() < 1e-9 * np.abs(joint.stiffness).max()


def test_beams_with_the_joint_have_the_flexibility_of_the_solid(
    piece: ClumodPiece, flexibility: np.ndarray, joint: Joint, monkeypatch: pytest.MonkeyPatch
) -> None:
    plain = articles.clumod_plan

    def jointed(blades: Sequence[str], d: Dimensions, *, elements: int) -> object:
        return plain(blades, d, elements=elements, joints=(joint,))

    monkeypatch.setattr(articles, "clumod_plan", jointed)
    scale = np.sqrt(np.outer(np.diag(flexibility), np.diag(flexibility)))
    assert_allclose((articles.beam_flexibility(piece) - flexibility) / scale, 0, atol=1e-6)


def test_no_joint_is_needed_where_the_solid_is_as_flexible_as_the_beams(
    piece: ClumodPiece, dimensions: Dimensions, monkeypatch: pytest.MonkeyPatch
) -> None:
    stiffness = np.linalg.inv(articles.beam_flexibility(piece))
    monkeypatch.setattr(articles, "_kept_flexibility", lambda piece, _: articles.beam_flexibility(piece))
    assert np.abs(articles.joint(piece, dimensions, SIZE).stiffness).max() < 1e-12 * np.abs(stiffness).max()


def test_the_foot_of_beams_is_a_cantilever_tube(dimensions: Dimensions) -> None:
    """Tip of a Timoshenko cantilever: L³ / 3 E I + L / k G A, L² / 2 E I, L / E I; L / E A and L / G J along and about it."""
    foot = next(articles.pieces(ONE_BLADE, dimensions))
    mast = dimensions["mast"]
    L = foot.ports[0].at - dimensions["flange"]["height"]
    s = tube(mast["outer_diameter"], mast["inner_diameter"], material(mast["material"]))
    across, tilt, turn = L**3 / (3 * s.bending_y) + L / s.shear_z, L**2 / (2 * s.bending_y), L / s.bending_y
    expected = np.diag([across, across, L / s.axial, turn, turn, L / s.torsion])
    expected[0, 4] = expected[4, 0] = tilt
    expected[1, 3] = expected[3, 1] = -tilt
    assert_allclose(articles.beam_flexibility(foot), expected, rtol=1e-8, atol=1e-8 * turn)


def test_a_joint_of_four_blades_serves_one(joint: Joint, piece: ClumodPiece, dimensions: Dimensions) -> None:
    """The same crossing is cut out of both, and Clumod with one blade takes the joint: its frequencies fall, by little."""
    own = lower_1(ONE_BLADE, dimensions)
    assert [(port.member, port.at) for port in own.ports] == [(port.member, port.at) for port in piece.ports]
    assert_array_equal(articles.beam_flexibility(own), articles.beam_flexibility(piece))
    plain, jointed = (
        articles.frequencies(articles.clumod_frame(ONE_BLADE, dimensions, joints=joints), 5) for joints in ((), (joint,))
    )
    change = jointed / plain - 1
    assert np.abs(change).max() < 0.05
    assert np.abs(change).max() > 1e-5


def test_ports_are_where_the_solid_ends(piece: ClumodPiece, dimensions: Dimensions) -> None:
    """A rigid motion about the base is reported by every port as its own."""
    solid = articles._solid(piece, SIZE)
    shares = np.asarray((solid.mass @ np.tile(np.eye(3), (len(solid.points), 1))).sum(axis=1))
    motion = np.zeros((len(solid.rigid), 6))
    motion[solid.translations.ravel()] = rigid_motion(solid.points).reshape(-1, 6, 6)[:, :3].reshape(-1, 6)
    for port in piece.ports:
        seen = articles._mean(solid, shares, piece, port).T @ motion
        assert_allclose(seen, rigid_transformation_6(articles.place(port, dimensions)), rtol=0, atol=1e-9)
