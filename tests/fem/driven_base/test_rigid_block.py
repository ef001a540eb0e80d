"""f = +M a: what exudyn's constraints and cells report under a rigid block, on every axis, in sign and in all six components."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.response import Response
from fem.base_excitation.rig import FlexibleBody, LoadCell, Rig
from fem.exudyn.driven_run import respond
from geometry.frames import Array, rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia

SEAT = (0.01, -0.02, 0.0445)

AXES = range(6)

SECOND_ORDER = 3e-4
"""What is of second order: the step, (omega h)² / 6, and rotations of 1e-3 rad that exudyn does not take for small."""


def largest(load: Array) -> Array:
    """(6,) scale of a load: its largest force, three times, and its largest moment, three times."""
    return np.repeat([np.abs(load[:, :3]).max(), np.abs(load[:, 3:]).max()], 3)


def about_f(inertia: Inertia) -> Array:
    """Mass matrix about F of a block that stands at the seat."""
    G = rigid_transformation_6(SEAT)
    return np.asarray(G.T @ inertia.mass_matrix @ G)


@pytest.fixture(scope="module", params=AXES)
def motion(request: pytest.FixtureRequest, shake: Callable[..., BaseMotion]) -> BaseMotion:
    return shake(2.5 * np.eye(6)[request.param])


@pytest.fixture(scope="module")
def on_cells(motion: BaseMotion, block: FlexibleBody, cover: Inertia, cells: tuple[LoadCell, ...]) -> Response:
    return respond(Rig(article=block, cover=cover, cells=cells, seat=SEAT), motion)


def test_the_load_under_a_block_is_plus_its_mass_matrix_times_the_acceleration(
    motion: BaseMotion, block: FlexibleBody, inertia: Inertia
) -> None:
    response = respond(Rig(article=block), motion)
    load = motion.acceleration @ inertia.mass_matrix
    assert_allclose(response.load / largest(load), load / largest(load), atol=SECOND_ORDER)
    assert_allclose(response.load, response.table @ inertia.mass_matrix, atol=1e-9 * np.abs(load).max())


def test_a_block_beside_f_has_the_mass_matrix_of_its_place(motion: BaseMotion, block: FlexibleBody, inertia: Inertia) -> None:
    load = motion.acceleration @ about_f(inertia)
    response = respond(Rig(article=block, seat=SEAT), motion)
    assert_allclose(response.load / largest(load), load / largest(load), atol=SECOND_ORDER)


def test_a_cover_plate_adds_its_mass_matrix(motion: BaseMotion, block: FlexibleBody, inertia: Inertia, cover: Inertia) -> None:
    load = motion.acceleration @ (about_f(inertia) + cover.mass_matrix)
    response = respond(Rig(article=block, cover=cover, seat=SEAT), motion)
    assert_allclose(response.load / largest(load), load / largest(load), atol=SECOND_ORDER)


def test_cells_carry_the_mass_matrix_times_the_acceleration_of_the_cover(
    on_cells: Response, inertia: Inertia, cover: Inertia
) -> None:
    load = on_cells.cover @ (about_f(inertia) + cover.mass_matrix)
    assert_allclose(on_cells.load / largest(load), load / largest(load), atol=SECOND_ORDER)


def test_the_forces_of_the_cells_one_by_one_add_up_to_the_load(on_cells: Response, cells: tuple[LoadCell, ...]) -> None:
    total = sum(on_cells.cells[:, i] @ rigid_transformation(cell.position) for i, cell in enumerate(cells))
    assert_allclose(total / largest(on_cells.load), on_cells.load / largest(on_cells.load), atol=SECOND_ORDER)


def test_a_place_moves_with_the_block(motion: BaseMotion, block: FlexibleBody) -> None:
    corner = respond(Rig(article=block), motion).places["corner"]
    expected = motion.acceleration @ block.places["corner"].T
    assert_allclose(corner, expected, atol=SECOND_ORDER * np.abs(expected).max())
