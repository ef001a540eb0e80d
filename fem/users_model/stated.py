"""The rigid body that a model is, held against what is known of the structure: the check that finds a slip of units."""

from __future__ import annotations

import numpy as np

from fem.users_model.description import Description
from geometry.arrays import Array
from geometry.consistency import judge
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.inertia import Inertia, parallel_axis, six_from_tensor

MASS = 0.02
"""Share by which the mass of a finite-element model may differ from the stated one, beyond three times its tolerance."""

COG = 0.05
"""Distance between the model's CoG and the stated one, in radii of gyration."""

RIGID = 1e-5
"""How far a mass matrix, scaled to masses and moments of one, may be from that of a rigid body: digits of a printed table."""

SLIPS = {
    1e3: "tonnes read as kilograms, or the other way round",
    1e6: "tonnes and grams confused",
    1e9: "a density per mm³ taken per m³",
    5.7101475: "tonnes and lbf s²/in confused",
    175.126835: "pounds-force and inches (lbf s²/in) for kilograms",
    14.593903: "slugs for kilograms",
    2.2046226: "pounds for kilograms",
    386.08858: "weight for mass in inches and pounds (no WTMASS)",
    9.80665: "weight for mass (no division by g)",
}
"""Ratios that a mass is off by when units are confused, or their inverse."""


def require_rigid_body(matrix: Array, source: str, field: str, remedy: str) -> Inertia:
    """The (6, 6) mass `matrix` [SI] as ten parameters.

    Raises
    ------
    BadInput : it is not of the form of Eq. 1, or no body has such parameters.
    """
    scale = np.sqrt(np.abs(np.diag(matrix)))
    if np.any(scale == 0):
        axis = MOTIONS[int(np.argmin(scale))]
        raise BadInput(source=source, field=field, problem=f"has no inertia along {axis}", remedy=remedy)
    inertia = _nearest(matrix)
    misfit = np.abs(matrix - inertia.mass_matrix) / np.outer(scale, scale)
    if misfit.max() > RIGID:
        row, column = (int(i) for i in np.unravel_index(np.argmax(misfit), misfit.shape))
        problem = (
            f"is not the mass matrix of a rigid body (m 1, -S; S, Theta): row {row + 1}, column {column + 1} is "
            f"{matrix[row, column]:.6g} where {inertia.mass_matrix[row, column]:.6g} belongs, diagonal {_listed(np.diag(matrix))}"
        )
        raise BadInput(source=source, field=field, problem=problem, remedy=remedy)
    verdict = judge(inertia, RIGID)
    if not verdict.physical:
        raise BadInput(source=source, field=field, problem=f"no body has it: {verdict.text}", remedy=remedy)
    return inertia


def require_as_stated(inertia: Inertia, description: Description) -> None:
    """Refuse a model whose mass or CoG is not the stated one; a ratio that a slip of units explains is named.

    `inertia` is about the reference point, its offset from there, in the model's axes.
    """
    stated = description.stated
    if stated.mass is not None and abs(inertia.mass - stated.mass) > max(MASS * stated.mass, 3 * stated.mass_tolerance):
        ratio = inertia.mass / stated.mass
        problem = f"the matrices weigh {inertia.mass:.6g} kg where {stated.mass:.6g} kg are stated, {ratio:.6g} times as much"
        raise BadInput(source=description.source, field="stated.mass", problem=problem, remedy=_slip(ratio, description))
    if stated.cog is None:
        return
    cog = description.reference_point + inertia.first_moment / inertia.mass
    centred = inertia.tensor - parallel_axis(inertia.mass, inertia.first_moment / inertia.mass)
    radius = float(np.sqrt(np.trace(centred) / (2 * inertia.mass)))
    if np.linalg.norm(cog - stated.cog) > COG * radius:
        problem = f"the matrices have their CoG at ({_listed(cog)}) m where ({_listed(stated.cog)}) m is stated"
        remedy = f"Check the coordinates, their unit ({description.units.name}), and the frame that the CoG is stated in"
        raise BadInput(source=description.source, field="stated.cog", problem=problem, remedy=remedy)


def _nearest(matrix: Array) -> Inertia:
    """Ten parameters of a symmetric matrix that is nearly a rigid body's."""
    S = (matrix[3:, :3] - matrix[3:, :3].T) / 2
    mass = float(np.trace(matrix[:3, :3]) / 3)
    return Inertia(parameters=np.array([mass, S[2, 1], S[0, 2], S[1, 0], *six_from_tensor(matrix[3:, 3:])]))


def _slip(ratio: float, description: Description) -> str:
    for factor, words in SLIPS.items():
        for slip in (factor, 1 / factor):
            if abs(ratio / slip - 1) < MASS:
                return f"A factor of {slip:.4g} is {words}: check `fe_model.units`, found {description.units.name}"
    return f"Check `fe_model.units`, found {description.units.name}, and whether all parts and lumped masses are in the model"


def _listed(values: Array) -> str:
    return ", ".join(f"{value:.6g}" for value in values)
