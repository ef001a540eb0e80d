"""A loose part on the flange: a mass that follows the article's base along two axes and is held along the third by friction only.

Exudyn's bristle model: while it sticks, the part hangs on a spring and a damper so stiff that it swings at `STICKING` [Hz], far
above anything that is driven, and from the slip force on it slides under just that force. Sticking it adds its mass at the
article's origin, but for a share (f / STICKING)².
"""

from __future__ import annotations

import numpy as np

from fem.base_excitation.rig import LATERAL, Friction
from fem.flexible_body.driven_base.bodies import Reduced
from fem.flexible_body.driven_base.scene import Number, Scene, coordinate
from geometry.arrays import Array

STICKING = 1000.0
"""[Hz] at which the part would swing on its bristles."""

STICKING_RATIO = 0.3
"""Damping ratio of that swing, so that it is gone when the part slips next."""


def lay(scene: Scene, friction: Friction, article: Reduced, seat: Array) -> None:
    """Put the loose part of `friction` on the base of `article`, which stands at `seat` (3,) [m]."""
    items, system = scene.items, scene.system
    part = system.AddNode(items.NodePoint(referenceCoordinates=seat.tolist()))
    system.AddObject(items.ObjectMassPoint(mass=friction.mass, nodeNumber=part))
    loose = LATERAL.index(friction.axis)
    for axis in {0, 1, 2} - {loose}:
        system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=_ends(scene, article, part, axis)))
    omega = 2 * np.pi * STICKING
    state = system.AddNode(items.NodeGenericData(numberOfDataCoordinates=3, initialCoordinates=[0.0] * 3))  # it sticks
    bristles = items.ObjectConnectorCoordinateSpringDamperExt(
        markerNumbers=_ends(scene, article, part, loose),
        nodeNumber=state,
        dynamicFrictionForce=friction.slip_force,
        stickingStiffness=friction.mass * omega**2,
        stickingDamping=2 * STICKING_RATIO * friction.mass * omega,
    )
    system.AddObject(bristles)


def _ends(scene: Scene, article: Reduced, part: Number, axis: int) -> list[Number]:
    return [coordinate(scene, article.node, axis), coordinate(scene, part, axis)]
