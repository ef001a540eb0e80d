"""Plumbing: our reduced matrices put into exudyn as they are.

Six rigid motions of the base come first, fixed-base modes after them, as Craig and Bampton order them. Exudyn adds nothing but
its own reading of them, so that agreement says that they arrived - not that they are right. It is how a reduced article gets into
a larger multibody system.
"""

from __future__ import annotations

from typing import Any

import numpy as np
import numpy.typing as npt

from fem.flexible_body.linearised import BASE, Linearised, linearise_body
from fem.flexible_body.running import running


def placed(stiffness: npt.ArrayLike, mass: npt.ArrayLike, damping: npt.ArrayLike | None = None) -> tuple[Any, Any]:
    """Exudyn's container and assembled system with one `ObjectGenericODE2` of these (6 + n, 6 + n) matrices, the base free.

    Raises
    ------
    CheckFailed : exudyn refused them.
    """
    K, M = np.asarray(stiffness, dtype=np.float64), np.asarray(mass, dtype=np.float64)
    C = np.zeros_like(K) if damping is None else np.asarray(damping, dtype=np.float64)
    with running("take reduced matrices") as exudyn:
        from exudyn import itemInterface

        items: Any = itemInterface

        container = exudyn.SystemContainer()
        system = container.AddSystem()
        rest = {name: [0.0] * len(M) for name in ("referenceCoordinates", "initialCoordinates", "initialCoordinates_t")}
        node = system.AddNode(items.NodeGenericODE2(numberOfODE2Coordinates=len(M), **rest))
        item = items.ObjectGenericODE2(nodeNumbers=[node], massMatrix=M, stiffnessMatrix=K, dampingMatrix=C)
        system.AddObject(item)
        system.Assemble()
    return container, system


def linearised(stiffness: npt.ArrayLike, mass: npt.ArrayLike) -> Linearised:
    """What exudyn makes of reduced matrices (6 + n, 6 + n): its linearised system, and all modes with the base held.

    Raises
    ------
    CheckFailed : exudyn refused them, or they hold a mode without stiffness.
    """
    _container, system = placed(stiffness, mass)
    return linearise_body(system, len(np.asarray(mass)) - BASE, "linearise reduced matrices")
