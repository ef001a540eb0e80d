"""A load cell that lifts off its preload P: its faces press on each other and cannot pull.

    f_z = max(k_z u_z + d_z v_z, -P)

so that what the cell reads stays at -P while it is open. P is all that presses its faces together, what the article weighs on it
included. The damper belongs to what presses: faces that come back fast push, k_z u_z + d_z v_z > -P, a little before the gap
k_z u_z = -P is closed. Sideways it is assumed to hold as before, by the bolt that presses it together: were its shear to vanish
with the pressure, its springs would have to know where it lands.
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

from fem.flexible_body.driven_base.scene import Scene


def let_lift(scene: Scene, connector: Any, preload: float) -> None:
    """Let the Cartesian spring-damper `connector` lift off along z at `preload` [N]."""
    from exudyn import advancedUtilities

    formula: Any = advancedUtilities.CreateSymbolicUserFunction
    force = formula(scene.system, _law(scene.exudyn.symbolic, preload), "springForceUserFunction", connector)
    scene.system.SetObjectParameter(connector, "springForceUserFunction", force)
    scene.alive.append(force)


def _law(symbolic: Any, preload: float) -> Callable[..., Any]:
    """Exudyn reads a formula out of it and evaluates that without Python."""

    def force(_system: Any, _time: Any, _number: Any, u: Any, v: Any, k: Any, d: Any, _offset: Any) -> Any:
        x, y, z = (k[i] * u[i] + d[i] * v[i] for i in range(3))
        return [x, y, symbolic.max(z, -preload)]

    return force
