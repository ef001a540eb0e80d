"""A loose part on the flange: a mass that follows the article's base along two axes and is held along the third by friction only.

It hangs on bristles, a spring and a damper between part and flange that cannot pull harder than the slip force F:

    f = min(max(k (q - s) + d q', -F), F),

q being how far the part has moved on the flange. What the bristles cannot follow is slip: after every step s becomes the
q - (f - d q') / k of its end, which is the backward Euler method of an elastic, perfectly plastic spring (Simo & Hughes,
Computational Inelasticity, 1998, section 1.4). Sticking, the part would swing at `STICKING` [Hz], far above anything that is
driven, and adds its mass at the article's origin but for a share (f / STICKING)².
"""

from __future__ import annotations

from collections.abc import Callable
from typing import Any

import numpy as np

from fem.base_excitation.rig import LATERAL, Friction
from fem.flexible_body.driven_base.bodies import Reduced
from fem.flexible_body.driven_base.scene import Number, Scene, coordinate, node
from geometry.arrays import Array

STICKING = 1000.0
"""[Hz] at which the part would swing on its bristles."""

STIFFNESS = (2 * np.pi * STICKING) ** 2
"""[N/m per kg] of the bristles."""

STICKING_RATIO = 0.3
"""Damping ratio of that swing."""


AT_LIMIT = 1 - 1e-9
"""Share of the slip force from which a part counts as slipping."""


def lay(scene: Scene, friction: Friction, article: Reduced, seat: Array) -> Bristles:
    """Put the loose part of `friction` on the base of `article`, which stands at `seat` (3,) [m]."""
    items, system = scene.items, scene.system
    part = node(scene, "loose part", items.NodePoint(referenceCoordinates=seat.tolist()))
    system.AddObject(items.ObjectMassPoint(mass=friction.mass, nodeNumber=part))
    loose = LATERAL.index(friction.axis)
    for axis in {0, 1, 2} - {loose}:
        system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=_ends(scene, article, part, axis)))
    k, d = friction.mass * STIFFNESS, 2 * STICKING_RATIO * friction.mass * np.sqrt(STIFFNESS)
    spring = items.ObjectConnectorCoordinateSpringDamper
    connector = system.AddObject(spring(markerNumbers=_ends(scene, article, part, loose), stiffness=k, damping=d))
    _slipping(scene, connector, friction.slip_force)
    laid = Bristles(scene, connector, k, d, friction.slip_force)
    scene.before_step.append(laid)
    return laid


class Bristles:
    """Where the bristles of a loose part stand, before every step; they know how often they slipped."""

    def __init__(self, scene: Scene, connector: Any, stiffness: float, damping: float, slip_force: float) -> None:
        kinds = scene.exudyn.OutputVariableType
        self.connector, self.stiffness, self.damping = connector, stiffness, damping
        self.slip_force, self.slipped, self.steps = slip_force, 0, 0
        self.outputs = (kinds.Displacement, kinds.Velocity, kinds.Force)

    def __call__(self, system: Any) -> None:
        """Let them stand where the force at the end of the last step leaves them."""
        moved, speed, force = (system.GetObjectOutput(self.connector, kind) for kind in self.outputs)
        system.SetObjectParameter(self.connector, "offset", moved - (force - self.damping * speed) / self.stiffness)
        self.steps += 1
        self.slipped += abs(force) >= AT_LIMIT * self.slip_force

    @property
    def share_slipping(self) -> float:
        """[1] of the steps so far."""
        return self.slipped / max(self.steps, 1)


def _slipping(scene: Scene, connector: Any, slip_force: float) -> None:
    """Let the spring-damper `connector` pull no harder than `slip_force` [N]."""
    from exudyn import advancedUtilities

    formula: Any = advancedUtilities.CreateSymbolicUserFunction
    force = formula(scene.system, _law(scene.exudyn.symbolic, slip_force), "springForceUserFunction", connector)
    scene.system.SetObjectParameter(connector, "springForceUserFunction", force)
    scene.alive.append(force)


def _law(symbolic: Any, slip_force: float) -> Callable[..., Any]:
    def force(_system: Any, _time: Any, _number: Any, q: Any, speed: Any, k: Any, d: Any, stood: Any) -> Any:
        return symbolic.min(symbolic.max(k * (q - stood) + d * speed, -slip_force), slip_force)

    return force


def _ends(scene: Scene, article: Reduced, part: Number, axis: int) -> list[Number]:
    return [coordinate(scene, article.node, axis), coordinate(scene, part, axis)]
