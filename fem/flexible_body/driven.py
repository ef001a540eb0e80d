"""The driven base, line by line: dynamic mass straight from the matrices that exudyn linearises, no modes in between.

The base's six coordinates u are prescribed, the others x and the joints' forces lambda follow from

    Z = K + i S - omega² M,    Z_xx x + J_x lambda = -Z_xu u,    J_x^T x = -J_u^T u,

and the load of the table on the article is F = Z_uu u + Z_ux x + J_u lambda. With u = -a / omega², H = F / a. For a rigid body
Z = -omega² M and H = +M: exudyn, too, has its loads on the right-hand side. It is the oracle of the modal sum and slow.
"""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem.flexible_body.linearised import BASE, Linearised
from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray, DynamicMass


def direct(
    system: Linearised, lossy: Array, frequency: npt.ArrayLike, reference_point: npt.ArrayLike = (0.0, 0.0, 0.0)
) -> DynamicMass:
    """Blocked dynamic mass of `system` at `frequency` (n,) [Hz], above zero, with structural damping S = `lossy` (n, n)."""
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    matrices = [_line(system, lossy, omega) for omega in 2 * np.pi * lines]
    point = np.asarray(reference_point, dtype=np.float64)
    return DynamicMass(frequency=lines, matrix=np.array(matrices).reshape(-1, BASE, BASE), reference_point=point)


def _line(system: Linearised, lossy: Array, omega: float) -> ComplexArray:
    J, c = system.constraints, system.constraints.shape[1]
    Z = np.block(
        [[system.stiffness + 1j * lossy - omega**2 * system.mass, J], [J.T, np.zeros((c, c))]]  # base, others, joints
    )
    others = np.linalg.solve(Z[BASE:, BASE:], -Z[BASE:, :BASE])
    return np.asarray((Z[:BASE, :BASE] + Z[:BASE, BASE:] @ others) / -(omega**2))
