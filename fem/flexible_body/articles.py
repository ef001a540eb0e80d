"""Eigenfrequencies and dynamic mass by exudyn: from native beams for the built-in articles, from full matrices for any solid.

The native beams are the default of ``--model exudyn``. They take from `fem.beam` where things are and what their sections are,
and nothing of its elements or eigen-solution. `modes_of_solid` gives exudyn a solid's full sparse matrices; there exudyn solves,
but the elements are ours.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence

import numpy as np
import numpy.typing as npt

from fem import beam
from fem import dynamic_mass as modal_sum
from fem.beam_clumod import Joint
from fem.damping import DEFAULT_RATIO
from fem.flexible_body import floating_frame, modal
from fem.flexible_body.linearised import Linearised, linearise, linearise_body, stiffness_of
from fem.flexible_body.losses import lossy
from fem.flexible_body.refinement import refined
from fem.frame import Plan
from fem.modes import Modes
from fem.structure import Structure
from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput

ELEMENTS = 8
"""In a half-blade of the coarser of both meshes: the first 11 modes of Clumod are then known to 3e-5."""

EXTRA = 10
"""Modes that are solved for beyond those asked for, so that each finds its like on the other mesh."""


def modes(
    article_name: str,
    count: int = 30,
    changes: Mapping[str, float] = beam.NO_CHANGES,
    *,
    elements: int = ELEMENTS,
    cells: npt.ArrayLike | None = None,
    joints: Sequence[Joint] = (),
) -> Modes:
    """The lowest `count` fixed-base modes of a built-in article or stack about its origin, by exudyn's native beams.

    Parameters
    ----------
    article_name, changes : as `geometry.articles.built_in` takes them
    count : modes; all there are when the mesh has fewer
    elements : in a half-blade of Clumod, its mast has twice as many; a mesh twice as fine is solved too and both extrapolated
    cells, joints : as `fem.beam.structure` takes them

    Raises
    ------
    BadInput : an article or a dimension that cannot be used, no mode asked for.
    CheckFailed : exudyn failed.
    """
    return modes_of_plan(beam.plan(article_name, changes, elements=elements, cells=cells, joints=joints), count)


def dynamic_mass(
    article_name: str,
    frequency: npt.ArrayLike = modal_sum.LINES,
    changes: Mapping[str, float] = beam.NO_CHANGES,
    *,
    count: int = 30,
    elements: int = ELEMENTS,
    cells: npt.ArrayLike | None = None,
    joints: Sequence[Joint] = (),
) -> DynamicMass:
    """Blocked dynamic mass at `frequency` (n,) [Hz] about the article's origin, from exudyn's linearised, base-driven system.

    Its modes are those of `modes`, with the static share of all others.

    Raises
    ------
    BadInput, CheckFailed : as `modes`.
    """
    found = modes(article_name, count, changes, elements=elements, cells=cells, joints=joints)
    return modal_sum.modal(found, frequency)


def modes_of_plan(plan: Plan, count: int = 30) -> Modes:
    """The lowest `count` fixed-base modes of the frame `plan` about its origin, extrapolated from its mesh and one twice as fine.

    Raises
    ------
    BadInput : no mode asked for.
    CheckFailed : exudyn failed.
    """
    _require_some(count)
    finer = refined(plan, 2)
    coarse, fine = (linearise(mesh, count + EXTRA) for mesh in (plan, finer))
    found = min(count, coarse.frequency.size)
    return modal.extrapolated(coarse, fine, _lossy(finer, fine), np.zeros(3), found)


def modes_of_solid(structure: Structure, count: int = 30) -> Modes:
    """The lowest `count` fixed-base modes of a solid: exudyn solves its full K and M and linearises its flexible body.

    Raises
    ------
    BadInput : a structure that is no solid, no mode asked for.
    CheckFailed : exudyn failed.
    """
    _require_some(count)
    body = floating_frame.floating_frame(structure, count)
    system = linearise_body(body.system, count, "linearise the flexible body")
    return modal.single(system, _lossy_solid(structure, body, system), structure.reference_point, count)


def _lossy(plan: Plan, system: Linearised) -> Array:
    """Sum of eta_p K_p by exudyn; a structure without loss factors has one ratio for every mode."""
    return stiffness_of(lossy(plan)) if plan.loss_factors else 2 * DEFAULT_RATIO * system.stiffness


def _lossy_solid(structure: Structure, body: floating_frame.FloatingFrame, system: Linearised) -> Array:
    if not (structure.loss_factors and structure.part_stiffness):
        return np.asarray(2 * DEFAULT_RATIO * system.stiffness)
    order, S = structure.translations.ravel(), np.zeros_like(system.stiffness)
    for part, eta in structure.loss_factors.items():
        S[6:, 6:] += eta * (body.modes.T @ (structure.part_stiffness[part].tocsr()[order][:, order] @ body.modes))
    return S


def _require_some(count: int) -> None:
    if count < 1:
        raise BadInput(source="modes", field="count", problem=f"at least one mode is needed, found {count}", remedy="Ask for 30")
