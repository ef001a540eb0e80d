"""Exudyn's integration against the exact recursion: 0.1 % in force on every axis, and how that depends on the step."""

from __future__ import annotations

from collections.abc import Callable, Mapping

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation import response as base_excitation_response
from fem.base_excitation.patterns import BaseMotion, Sweep
from fem.base_excitation.response import Response
from fem.base_excitation.rig import Flange, FlexibleBody, LoadCell, Rig, Strut, flexible
from fem.beam import articles as beam_articles
from fem.exudyn.driven_run import respond
from fem.modes import fixed_base
from geometry.dynamic_mass import MOTIONS
from geometry.inertia import Inertia

ISSUE = 1e-3
"""What the issue allows, of the largest load."""

REACHED = 2e-4
"""What is reached at 8192 Hz, with half of it to spare."""


def off(response: Response, truth: Response, rig: Rig) -> float:
    """Largest error of a load, of the largest load, each of the six in units of the root of its mass."""
    weight = 1 / np.sqrt(np.diag(rig.article.reduced.mass)[:6])
    return float(np.abs((response.load - truth.load) * weight).max() / np.abs(truth.load * weight).max())


@pytest.fixture(scope="module")
def articles() -> Mapping[str, FlexibleBody]:
    def made(name: str) -> FlexibleBody:
        structure = beam_articles.structure(name)
        return flexible(name, structure, fixed_base(structure, 12), places={"foot": [0.03, 0.02, 0.0]})

    return {name: made(name) for name in ("clumod-1", "clumod-4")}


@pytest.fixture(scope="module")
def sweeps() -> Mapping[str, BaseMotion]:
    """4 to 32 Hz in a second, at the paper's levels."""
    return {axis: swept(axis, 1.0) for axis in MOTIONS}


@pytest.fixture(scope="module")
def soft_sweeps() -> Mapping[str, BaseMotion]:
    """The same at a twentieth of the level, where a rotating cover plate is still a linear one."""
    return {axis: swept(axis, 0.05) for axis in MOTIONS}


def swept(axis: str, level: float) -> BaseMotion:
    return Sweep(axis=axis, rate=135.0, level=level).motion(8192, ring_down=0.1)


@pytest.fixture(scope="module")
def flange() -> Flange:
    return Flange(compliance=[1e-8, 0.0, 2e-9, 2e-7, 2e-7, 1e-7], damping_time=1e-5)


@pytest.mark.parametrize("axis", MOTIONS)
@pytest.mark.parametrize("name", ["clumod-1", "clumod-4"])
def test_a_reduced_article_on_a_rigid_base(
    name: str, axis: str, articles: Mapping[str, FlexibleBody], sweeps: Mapping[str, BaseMotion]
) -> None:
    rig = Rig(article=articles[name])
    assert off(respond(rig, sweeps[axis]), base_excitation_response.respond(rig, sweeps[axis]), rig) < REACHED


@pytest.mark.parametrize("axis", MOTIONS)
@pytest.mark.parametrize("name", ["clumod-1", "clumod-4"])
def test_a_reduced_article_on_cells_and_a_flange_that_gives_in_some_directions(
    name: str,
    axis: str,
    articles: Mapping[str, FlexibleBody],
    soft_sweeps: Mapping[str, BaseMotion],
    cover: Inertia,
    cells: tuple[LoadCell, ...],
    flange: Flange,
) -> None:
    rig = Rig(article=articles[name], cover=cover, cells=cells, flange=flange, seat=(0.0, 0.0, 0.0445))
    response, truth = respond(rig, soft_sweeps[axis]), base_excitation_response.respond(rig, soft_sweeps[axis])
    assert off(response, truth, rig) < REACHED < ISSUE
    assert_allclose(response.cells, truth.cells, atol=ISSUE * np.abs(truth.cells).max())
    assert_allclose(response.places["foot"], truth.places["foot"], atol=ISSUE * np.abs(truth.places["foot"]).max())


def test_exudyn_turns_the_forces_of_the_cells_with_the_cover_plate_which_a_linear_rig_does_not(
    block: FlexibleBody, cover: Inertia, cells: tuple[LoadCell, ...]
) -> None:
    """What separates them is of second order in the level: ten times the level, a hundred times the difference."""
    rig, difference = Rig(article=block, cover=cover, cells=cells), []
    for level in (0.1, 1.0):
        motion = swept("gamma", level)
        difference.append(
            np.abs(respond(rig, motion).cells - base_excitation_response.respond(rig, motion).cells)[:, :, :2].max()
        )
    assert_allclose(difference[1] / difference[0], 100.0, rtol=0.1)


@pytest.mark.parametrize("to", ["ground", "table"])
def test_a_strut_on_a_place_that_swings(to: str, reed: Callable[..., FlexibleBody], shake: Callable[..., BaseMotion]) -> None:
    strut = Strut(place="tip", to=to, stiffness=[2e3, 1e3, 3e3], damping=[5.0, 10.0, 20.0])
    rig = Rig(article=reed(11.0, 0.01), struts=(strut,), seat=(0.01, -0.02, 0.05))
    motion = shake([1.0, -0.5, 0.7, 2.0, 1.0, -1.0], rate=8192.0)
    response, truth = respond(rig, motion), base_excitation_response.respond(rig, motion)
    assert off(response, truth, rig) < ISSUE
    assert_allclose(response.places["tip"], truth.places["tip"], atol=ISSUE * np.abs(truth.places["tip"]).max())
