"""The dynamic mass of all that the load cells carry, about F: the article with its effects, mounted, and the FMD beside it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.frames import Pose, rigid_transformation_6
from geometry.inertia import Inertia
from identification.self_calibration.structure import ten_matrices
from validation.effects.stages import Matrices, Mounted
from validation.engine.prediction import Offsets
from validation.models.model import Added
from validation.prediction import applied, condensation, damping_law, fmd
from validation.prediction.amplitude import Drive
from validation.prediction.nuisances import Nuisances
from validation.prediction.set_up import Standing
from validation.prediction.tangent import Tangent

Tangents = dict[str, ComplexArray]
"""By parameter, d dynamic mass / d offset (n, 6, 6)."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Carried:
    """What the cells carry, before anything is measured.

    Attributes
    ----------
    standing : on the cover plate
    moving : the FMD's moving part beforehand, about F
    exact : whether it is known exactly
    nuisances : what is not known of the structure; None where nothing stands there
    """

    standing: Standing
    moving: Inertia
    exact: bool
    nuisances: Nuisances | None

    def at(
        self, offsets: Offsets, effects: Sequence[Added], frequency: Array, drive: Drive, *, derivatives: bool
    ) -> tuple[ComplexArray, Tangents]:
        """Dynamic mass (n, 6, 6) about F, and how it answers to every parameter.

        Raises
        ------
        numpy.linalg.LinAlgError, ValueError : no such body, or a line on an undamped mode.
        """
        base = fmd.at(self.moving, offsets).mass_matrix
        H = np.broadcast_to(base.astype(np.complex128), (len(frequency), 6, 6))
        found: Tangents = {}
        if derivatives and not self.exact:
            found = {name: _constant(E, len(frequency)) for name, E in zip(fmd.names(), ten_matrices(), strict=True)}
        if self.nuisances is None:
            return H, found
        mounted, changes = self._mounted(self.nuisances, offsets, effects, frequency, drive, derivatives=derivatives)
        T = rigid_transformation_6(mounted.seat)
        return H + T.T @ mounted.matrix @ T, {**found, **{name: T.T @ change @ T for name, change in changes.items()}}

    def moved(self, offsets: Offsets, effects: Sequence[Added], frequency: Array) -> dict[str, tuple[ComplexArray, ComplexArray]]:
        """By place of the article (n, 3, 6) its accelerations along the axes of F for a unit of every motion of F; and the same
        beyond those of a rigid article.

        Raises
        ------
        numpy.linalg.LinAlgError, ValueError : no such body, or a line on an undamped mode.
        """
        if self.nuisances is None:
            return {}
        matrices, _ = structure(self.nuisances, offsets, effects, derivatives=False)
        answer = condensation.dynamic_mass(matrices, frequency).right.transpose(1, 0, 2)
        turn, b = self.standing.pose.rotation, matrices.base
        back = _turned(self.standing.pose).T @ rigid_transformation_6(self.standing.pose.position)
        return {
            name: (turn @ rows @ answer @ back, turn @ rows[:, b:] @ answer[:, b:] @ back)
            for name, rows in matrices.places.items()
        }

    def _mounted(
        self, of: Nuisances, offsets: Offsets, effects: Sequence[Added], frequency: Array, drive: Drive, *, derivatives: bool
    ) -> tuple[Mounted, Tangents]:
        matrices, tangents = structure(of, offsets, effects, derivatives=derivatives)
        answered = condensation.dynamic_mass(matrices, frequency)
        changes = condensation.tangents(answered, tangents) if derivatives else {}
        R = _turned(self.standing.pose)
        mounted = Mounted(
            frequency=frequency,
            matrix=R @ answered.matrix @ R.T,
            seat=self.standing.pose.position,
            cog=self.standing.pose.rotation @ matrices.cog,
            amplitude=drive.amplitude,
            sweep_rate=drive.sweep_rate,
            block=drive.block,
        )
        turned = {name: R @ change @ R.T for name, change in changes.items()}
        return applied.body(mounted, turned, effects, derivatives=derivatives)


def structure(
    of: Nuisances, offsets: Offsets, effects: Sequence[Added], *, derivatives: bool
) -> tuple[Matrices, dict[str, Tangent]]:
    """The matrices of the structure at `offsets`, effects on it applied, and how they change."""
    matrices, tangents = of.at(offsets, derivatives=derivatives)
    matrices, tangents = applied.structure(matrices, tangents, effects, derivatives=derivatives)
    if of.has_law:
        return damping_law.applied(matrices, tangents, of.nominal, offsets, derivatives=derivatives)
    return matrices, tangents


def _turned(pose: Pose) -> Array:
    """(6, 6) motions and loads in the axes of F from those in the article's own."""
    return np.asarray(np.kron(np.eye(2), pose.rotation), dtype=np.float64)


def _constant(matrix: Array, count: int) -> ComplexArray:
    return np.broadcast_to(matrix.astype(np.complex128), (count, 6, 6))
