"""Modes of an article by exudyn from native beams: the route that shares neither elements nor eigen-solution with `fem.beam`."""

from __future__ import annotations

import numpy as np

from fem.damping import DEFAULT_RATIO
from fem.flexible_body.extrapolation import EXTRA, extrapolated
from fem.flexible_body.linearised import linearise, stiffness_of
from fem.flexible_body.losses import lossy
from fem.flexible_body.refinement import refined
from fem.frame import Plan
from fem.modes import Modes
from geometry.arrays import Array
from geometry.errors import BadInput


def modes(plan: Plan, count: int) -> Modes:
    """The lowest `count` fixed-base modes of `plan` about the article's origin, extrapolated from its mesh and one twice as fine.

    Raises
    ------
    BadInput : fewer than one mode asked for, or more than the mesh of `plan` has.
    CheckFailed : exudyn failed, or a mode cannot be told on both meshes.
    """
    meshes = plan, refined(plan, 2)
    coarse, fine = (linearise(mesh, count + EXTRA) for mesh in meshes)
    if not 1 <= count <= coarse.frequency.size:
        raise BadInput(
            source="modes",
            field="count",
            problem=f"between 1 and {coarse.frequency.size} modes can be had from this mesh, found {count}",
            remedy="Ask for fewer",
        )
    return extrapolated(coarse, fine, _common(coarse.nodes, fine.nodes), _lossy(meshes[1], fine.stiffness), count)


def _common(coarse: tuple[tuple[int, ...], ...], fine: tuple[tuple[int, ...], ...]) -> Array:
    """(n, 2) coordinates on both meshes of every place that both have."""
    pairs = np.array([pair for a, b in zip(coarse, fine, strict=False) for pair in zip(a, b, strict=True)])
    return (6 * pairs[:, None, :] + np.arange(6)[None, :, None]).reshape(-1, 2)


def _lossy(plan: Plan, stiffness: Array) -> Array:
    """Sum of eta_p K_p by exudyn; a structure without loss factors has one ratio for every mode."""
    return stiffness_of(lossy(plan)) if plan.loss_factors else 2 * DEFAULT_RATIO * stiffness
