"""The joint under the article: rigid where its compliance is zero, a spring and a damper where it is not."""

from __future__ import annotations

import numpy as np

from fem.base_excitation.rig import Flange
from fem.flexible_body.driven_base.bodies import BASE, Reduced, Rigid
from fem.flexible_body.driven_base.scene import Number, Scene
from geometry.arrays import Array


def hold(scene: Scene, carrier: Rigid, upper: Rigid) -> None:
    """Let `upper` follow `carrier`, with which it shares its origin."""
    joint = scene.items.ObjectJointGeneric
    scene.system.AddObject(joint(markerNumbers=list(_frames(scene, carrier, np.zeros(3), upper.node))))


def join(scene: Scene, carrier: Rigid, seat: Array, article: Reduced, flange: Flange | None) -> None:
    """Put `article` on `carrier` at `seat` (3,) [m] of it."""
    ends = _frames(scene, carrier, seat, article.node)
    compliance = np.zeros(BASE) if flange is None else flange.compliance
    soft = compliance > 0
    if not np.all(soft):
        joint = scene.items.ObjectJointGeneric
        scene.system.AddObject(joint(markerNumbers=list(ends), constrainedAxes=[int(rigid) for rigid in ~soft]))
    if flange is not None and np.any(soft):
        stiffness = np.diag(np.divide(1.0, compliance, out=np.zeros(BASE), where=soft))
        spring = scene.items.ObjectConnectorRigidBodySpringDamper
        scene.system.AddObject(spring(markerNumbers=list(ends), stiffness=stiffness, damping=flange.damping_time * stiffness))


def _frames(scene: Scene, lower: Rigid, at: Array, node: Number) -> tuple[Number, Number]:
    """Markers with axes of their own: at the place `at` (3,) [m] of `lower`, and on `node`."""
    items = scene.items
    below = scene.system.AddMarker(items.MarkerBodyRigid(bodyNumber=lower.body, localPosition=at.tolist()))
    return int(below), int(scene.system.AddMarker(items.MarkerNodeRigid(nodeNumber=node)))
