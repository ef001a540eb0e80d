"""Cuboid and disc as stiff columns of their section, the FMD as a rigid cover plate, on springs when asked."""

from __future__ import annotations

import numpy as np
import numpy.typing as npt

from fem import frame
from fem.frame import Body, Member, Plan, Ports
from fem.section import Section, rectangle, tube
from geometry.arrays import Array
from geometry.article import Article
from geometry.articles.dimensions import Dimensions
from geometry.errors import BadInput
from geometry.frames import rigid_transformation
from geometry.materials import material
from geometry.multibody import inertia as drawn_inertia
from geometry.shapes import rectangle as corners

AXES = ("x", "y", "z")
REFINED = 3
"""Elements in a column for one in a half-blade: it is stubby, and there shear converges slowly."""


def cuboid(article: Article, d: Dimensions, elements: int) -> Plan:
    """The Cuboid, standing on its underside."""
    x, y, z = d["size"]
    return _column(article, rectangle(y, x, material(d["material"])), z, elements)


def disc(article: Article, d: Dimensions, elements: int) -> Plan:
    """The disc: a column far wider than high, whose give is nearly all shear and stretch of its height."""
    return _column(article, tube(d["diameter"], 0.0, material(d["material"])), d["height"], elements)


def fmd(article: Article, d: Dimensions, cells: Array | None) -> Plan:
    """The FMD's moving part about F: on its base, or on `cells` (4, 3) [N/m], springs in the middle of the load cells."""
    body = drawn_inertia(article)
    if cells is None:
        return Plan(nodes=np.zeros((1, 3)), carriers=(0,), bodies=(Body(node=0, inertia=body),))
    names = [f"cell-{number}" for number in range(1, 5)]
    springs = zip(names, corners(d["load_cell"]["square"], d["load_cell"]["square"]), cells, strict=True)
    loss = material(d["load_cell"]["material"]).loss_factor
    return Plan(
        nodes=np.zeros((2, 3)),
        carriers=(0, 1),
        bodies=(Body(node=1, inertia=body),),
        ports=tuple(_spring(name, [x, y, 0.0], stiffness) for name, (x, y), stiffness in springs),
        top=1,
        loss_factors={} if loss is None else dict.fromkeys(names, loss),
    )


def cell_stiffness(d: Dimensions) -> Array:
    """Stiffness (4, 3) along x, y, z [N/m] of the load cells in `fmd.toml`; an assumption, and labelled so there."""
    cell = d["load_cell"]
    return np.tile([cell["lateral_stiffness_N_m"], cell["lateral_stiffness_N_m"], cell["axial_stiffness_N_m"]], (4, 1))


def require_cells(cells: npt.ArrayLike) -> Array:
    """`cells` as stiffness (4, 3) along x, y, z [N/m].

    Raises
    ------
    BadInput : another shape, or a stiffness that is not positive and finite.
    """
    stiffness = np.asarray(cells, dtype=np.float64)
    if stiffness.shape != (4, 3):
        raise _refused(f"four cells with three stiffnesses each are needed, found shape {stiffness.shape}")
    for (cell, axis), value in np.ndenumerate(stiffness):
        if not 0 < value < np.inf:
            raise _refused(f"cell {cell + 1} must have a positive, finite stiffness along {AXES[axis]}, found {value:g} N/m")
    return stiffness


def _refused(problem: str) -> BadInput:
    return BadInput(source="load cells of the FMD", field="cells", problem=problem, remedy="Give (4, 3) values in N/m")


def _column(article: Article, section: Section, height: float, elements: int) -> Plan:
    """One part standing up from the origin; its holes are taken off as a rigid body at its foot."""
    (part,), elements = article.parts, REFINED * elements
    nodes = np.linspace([0.0, 0.0, 0.0], [0.0, 0.0, height], elements + 1)
    member = Member(nodes=tuple(range(elements + 1)), section=section, z_axis=np.array([1.0, 0.0, 0.0]), part=part.name)
    holes = drawn_inertia(article) - frame.inertia(member, nodes)
    loss = part.material.loss_factor
    return Plan(
        nodes=nodes,
        carriers=tuple(range(elements + 1)),
        members=(member,),
        bodies=(Body(node=0, inertia=holes),),
        top=elements,
        loss_factors={} if loss is None else {part.name: loss},
    )


def _spring(name: str, place: list[float], stiffness: Array) -> Ports:
    """Three springs at `place` [m] between two nodes at the origin."""
    G = rigid_transformation(place)
    k = G.T @ np.diag(stiffness) @ G
    return Ports(nodes=(0, 1), stiffness=np.block([[k, -k], [-k, k]]), mass=np.zeros((12, 12)), part=name)
