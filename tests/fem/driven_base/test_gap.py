"""A cell that lifts off, against statics: when, how far its force goes, and what the other three carry meanwhile."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.response import Response
from fem.base_excitation.rig import FlexibleBody, LoadCell, Rig
from fem.exudyn.driven_run import respond
from geometry.frames import rigid_transformation
from geometry.inertia import Inertia

SEAT = (0.01, -0.02, 0.0445)


@pytest.fixture(scope="module")
def motion(shake: Callable[..., BaseMotion]) -> BaseMotion:
    """Slow, so that statics say what the cells carry."""
    return shake([2.5, 0, 0, 0, 0, 0], frequency=6.0, seconds=0.5)


@pytest.fixture(scope="module")
def on(block: FlexibleBody, cover: Inertia, cells: tuple[LoadCell, ...], motion: BaseMotion) -> Callable[..., Response]:
    """The response with a preload of the first cell."""

    def made(preload: float | None) -> Response:
        first = replace(cells[0], preload=preload)
        return respond(Rig(article=block, cover=cover, cells=(first, *cells[1:]), seat=SEAT), motion)

    return made


@pytest.fixture(scope="module")
def held(on: Callable[..., Response]) -> Response:
    return on(None)


@pytest.fixture(scope="module")
def pull(held: Response, cells: tuple[LoadCell, ...]) -> float:
    """[N] with which statics let the load pull at the first cell at most, its stiffness shared with the others."""
    G = np.array([rigid_transformation(cell.position) for cell in cells])
    K = sum(g.T @ np.diag(cell.stiffness) @ g for g, cell in zip(G, cells, strict=True))
    at_first = held.load @ np.linalg.solve(K, G[0].T * cells[0].stiffness)
    return float(-at_first[:, 2].min())


@pytest.fixture(scope="module")
def lifted(on: Callable[..., Response], pull: float) -> Response:
    return on(0.6 * pull)


def test_it_stays_down_as_long_as_statics_pull_less_than_the_preload(
    on: Callable[..., Response], held: Response, pull: float
) -> None:
    assert_allclose(on(1.01 * pull).cells, held.cells, atol=1e-6 * np.abs(held.cells).max())


def test_it_lifts_where_statics_pull_more(on: Callable[..., Response], held: Response, pull: float) -> None:
    response = on(0.99 * pull)
    assert np.abs(response.cells - held.cells).max() > 1e-3 * np.abs(held.cells).max()


def test_its_force_stops_at_the_preload_and_stays_there(lifted: Response, held: Response, pull: float) -> None:
    z = lifted.cells[:, 0, 2]
    assert_allclose(z.min(), -0.6 * pull, rtol=1e-9)
    open_share, pulled_share = np.mean(z < -0.6 * pull * (1 - 1e-9)), np.mean(held.cells[:, 0, 2] < -0.6 * pull)
    assert_allclose(open_share, pulled_share, atol=0.02)


def test_the_others_carry_what_statics_leave_them(lifted: Response, cells: tuple[LoadCell, ...], pull: float) -> None:
    """Three cells that stand are determinate: force along z and the moments about x and y."""
    opened = lifted.cells[:, 0, 2] < -0.6 * pull * (1 - 1e-9)
    rows = np.array([rigid_transformation(cell.position)[2, [2, 3, 4]] for cell in cells]).T
    shear = sum(lifted.cells[:, i, :2] @ rigid_transformation(cell.position)[:2, [2, 3, 4]] for i, cell in enumerate(cells))
    left = (lifted.load[:, [2, 3, 4]] - shear)[opened] + 0.6 * pull * rows[:, 0]
    expected = np.linalg.solve(rows[:, 1:], left.T).T
    assert_allclose(lifted.cells[opened, 1:, 2], expected, atol=1e-3 * np.abs(expected).max())


def test_the_load_of_a_rigid_block_hardly_feels_the_gap(lifted: Response, held: Response) -> None:
    assert_allclose(lifted.load, held.load, atol=0.02 * np.abs(held.load).max())
