"""Load cells: a spring and a damper along x, y and z between table and cover plate."""

from __future__ import annotations

from fem.base_excitation.rig import Cell
from fem.flexible_body.driven_base.bodies import Rigid
from fem.flexible_body.driven_base.gap import let_lift
from fem.flexible_body.driven_base.scene import Number, Scene, place, watch_object


def cell(scene: Scene, table: Rigid, cover: Rigid, one: Cell) -> Number:
    """Put `one` between `table` and `cover`; the sensor of its force on the cover plate, along x, y, z."""
    ends = [place(scene, cover.body, one.position), place(scene, table.body, one.position)]
    connector = scene.items.ObjectConnectorCartesianSpringDamper
    spring = connector(markerNumbers=ends, stiffness=one.stiffness.tolist(), damping=one.damping.tolist())
    number = scene.system.AddObject(spring)  # an index of exudyn's own type, which a law of force needs
    if one.preload is not None:
        let_lift(scene, number, one.preload)
    return watch_object(scene, number, "Force")
