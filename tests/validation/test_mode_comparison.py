"""Two models of one article: their modes are told by shape, whatever their order, their signs and their mixture in a cluster."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.modes import fixed_base
from fem.solid.model import structure
from geometry.articles import built_in
from geometry.frames import Array
from validation.flexible.model import Flexible, FlexibleOptions, flexible
from validation.flexible.modes import clusters, compared
from validation.report.flexible import ModesBeside


@pytest.fixture(scope="module")
def model() -> Flexible:
    return flexible("clumod-4", "beam", FlexibleOptions(count=12))


def altered(model: Flexible, shapes: Array, frequency: Array | None = None) -> Flexible:
    """`model` with other shapes, called solid."""
    f = model.modes.frequency if frequency is None else frequency
    return replace(model, model="solid", modes=replace(model.modes, shapes=shapes, frequency=f))


def test_a_model_beside_itself_is_the_same(model: Flexible) -> None:
    found = compared(model, model)
    assert_allclose(found.mac, np.eye(12), atol=1e-9)  # orthogonality of the eigen-solution
    assert found.partner.tolist() == list(range(12))
    assert not len(found.parted)
    assert "agree in all 12 modes" in ModesBeside(found=found).where_they_part()


def test_signs_and_lengths_of_shapes_do_not_matter(model: Flexible) -> None:
    found = compared(model, altered(model, model.modes.shapes * np.linspace(-3, -1, 12)))
    assert_allclose(found.mac, np.eye(12), atol=1e-9)


def test_modes_are_matched_by_shape_when_two_have_changed_places(model: Flexible) -> None:
    order = [1, 0, *range(2, 12)]
    found = compared(model, altered(model, model.modes.shapes[:, order]))
    assert found.partner.tolist() == order
    assert_allclose(found.mac[range(12), order], 1.0, atol=1e-9)


def test_shapes_that_mix_in_a_cluster_span_the_same_space(model: Flexible) -> None:
    found = compared(model, model)
    members = np.flatnonzero(found.cluster == np.argmax(np.bincount(found.cluster)))
    assert len(members) >= 3
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(len(members), len(members))))[0]
    shapes = np.array(model.modes.shapes)
    shapes[:, members] = shapes[:, members] @ turn
    mixed = compared(model, altered(model, shapes))
    assert mixed.mac[members, mixed.partner[members]].min() < 0.9
    assert_allclose(mixed.space[members], 1.0, atol=1e-9)
    assert not len(mixed.parted)


def test_where_a_frequency_or_a_shape_differs_the_words_name_the_mode(model: Flexible) -> None:
    frequency = np.array(model.modes.frequency)
    frequency[11] *= 1.03
    shapes = np.array(model.modes.shapes)
    alone = 3  # no other mode is near enough to make a cluster with it
    shapes[:, alone] = np.roll(shapes[:, alone], 6 * 5)
    found = compared(model, altered(model, shapes, frequency))
    assert found.parted.tolist() == [alone, 11]
    text = ModesBeside(found=found).where_they_part()
    assert "part in 2 of 12 modes" in text
    assert "mode 4 in shape, MAC 0." in text
    assert "mode 12 by +3 %" in text


def test_missing_modes_have_no_partner(model: Flexible) -> None:
    few = flexible("clumod-4", "beam", FlexibleOptions(count=10))
    found = compared(model, few)
    assert sorted(found.partner.tolist()) == [-1, -1, *range(10)]
    assert "has no partner" in ModesBeside(found=found).where_they_part()
    assert ModesBeside(found=found).json()["partner"].count(None) == 2
    assert ModesBeside(found=found).document().text(132).count("–") >= 10


def test_clusters_are_close_neighbours() -> None:
    assert clusters(np.array([5.0, 6.0, 6.05, 6.1, 8.0])).tolist() == [0, 1, 1, 1, 2]
    assert clusters(np.zeros(0)).tolist() == []


def test_beam_and_solid_of_the_cuboid_move_alike() -> None:
    """Two models that share neither elements nor points: only a right interpolation of both gives a MAC of one."""
    article = built_in("cuboid")
    coarse = structure(article, fineness=0.4, cached=False)
    solid = Flexible(article="cuboid", model="solid", modes=fixed_base(coarse, 3), structure=coarse, drawn=article)
    beam = flexible("cuboid", "beam", FlexibleOptions(count=3))
    found = compared(solid, beam)
    assert np.diag(found.mac).min() > 0.99
    assert np.abs(found.difference[:2]).max() < 0.03  # the block is as thick as a fifth of its length, and its foot cannot warp
    assert compared(beam, solid).partner.tolist() == [0, 1, 2]
