"""A rig as an exudyn system, from the table up, with sensors on everything that a response tells."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

from fem.base_excitation.rig import Rig
from fem.flexible_body.driven_base import bodies, drive
from fem.flexible_body.driven_base.cells import cell
from fem.flexible_body.driven_base.flange import hold, join
from fem.flexible_body.driven_base.friction import Bristles, lay
from fem.flexible_body.driven_base.scene import Number, Scene, empty, watch_node
from fem.flexible_body.driven_base.struts import attach


@dataclass(frozen=True, eq=False, kw_only=True)
class Assembled:
    """A rig in exudyn.

    Attributes
    ----------
    scene : with the system, assembled
    axes : the constraints that drive the table
    table, cover, loads, cells : sensors of accelerations, constraint forces, cell forces
    article : sensors of its accelerations, when it has places
    coordinates : sensors of the article's coordinates, when they are to be kept
    bristles : of every loose part
    """

    scene: Scene
    axes: tuple[Number, ...]
    table: tuple[Number, ...]
    cover: tuple[Number, ...]
    loads: tuple[Number, ...]
    cells: tuple[Number, ...]
    article: tuple[Number, ...]
    coordinates: tuple[Number, ...]
    bristles: tuple[Bristles, ...]


def assembled(exudyn: Any, rig: Rig, *, velocity: bool, keep_coordinates: bool) -> Assembled:
    """`rig` on a table whose displacements, or velocities, are prescribed.

    Raises
    ------
    BadInput : a cover plate that no body can be.
    """
    scene = empty(exudyn)
    table = bodies.massless(scene)
    axes = drive.driven(scene, table, velocity=velocity)
    cover = table if rig.cover is None else bodies.rigid(scene, rig.cover, "cover plate")
    cells = tuple(cell(scene, table, cover, one) for one in rig.cells)
    if cover is not table and not cells:
        hold(scene, table, cover)
    article = bodies.reduced(scene, rig.article, rig.seat)
    join(scene, cover, rig.seat, article, rig.flange)
    for strut in rig.struts:
        attach(scene, strut, rig.article, article, rig.seat, table)
    bristles = tuple(lay(scene, friction, article, rig.seat) for friction in rig.frictions)
    result = Assembled(
        scene=scene,
        axes=axes,
        table=(watch_node(scene, table.node, "Coordinates_tt"),),
        cover=(watch_node(scene, cover.node, "Coordinates_tt"),),
        loads=drive.loads(scene, axes),
        cells=cells,
        article=tuple(watch_node(scene, node, "Coordinates_tt") for node in article.nodes if rig.article.places),
        coordinates=tuple(watch_node(scene, node, "Coordinates") for node in article.nodes if keep_coordinates),
        bristles=bristles,
    )
    scene.system.Assemble()
    return result
