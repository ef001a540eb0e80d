"""Which motion every row of K and M is, which of them the base carries, and what they do when it moves."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.structure import rigid_motion
from fem.users_model.contents import Contents
from fem.users_model.description import Description
from fem.users_model.units import SI, UnitSystem
from geometry.arrays import Array, Integers
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import rigid_transformation_6, skew

INDEPENDENT = 1e-9
"""Singular value of the held rigid motions, scaled to the size of the interface, below which one of the six is not held."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DofMap:
    """The degrees of freedom of a model.

    Attributes
    ----------
    labels : (n, 2) node identifier and component 1 to 6, 0 for a generalised coordinate; (0, 2) when the file has none
    scale : (n,) SI value of the user's unit of each
    rigid : (n, 6) [SI] what each does in the motions of the reference point
    held : (b,) those of the interface
    points, translations : (p, 3) as in `Structure`
    """

    labels: Integers
    scale: Array
    rigid: Array
    held: Integers
    points: Array
    translations: Integers

    def name(self, index: int) -> str:
        """``node 12, beta`` or ``degree of freedom 7`` of the degree of freedom `index`, counted from 0."""
        if not len(self.labels):
            return f"degree of freedom {index + 1}"
        node, component = self.labels[index]
        return f"node {node}, {MOTIONS[component - 1]}" if component else f"generalised coordinate {node}"


def dof_map(contents: Contents, description: Description, n: int) -> DofMap:
    """The map of the `n` degrees of freedom in `contents`.

    Raises
    ------
    BadInput : wrong sizes, unknown or doubled degrees of freedom, nodes without coordinates, an interface that is not there
        or does not hold six motions.
    """
    found = _by_nodes(contents, description, n) if "dof" in contents else _by_matrix(contents, description, n)
    _require_hold(found, contents, description)
    return found


def _by_matrix(contents: Contents, description: Description, n: int) -> DofMap:
    """From `rigid` and `held` themselves, in SI: how `write` leaves a structure that knows no nodes."""
    for name in ("rigid", "held"):
        if name not in contents:
            problem = "there is neither a map of the degrees of freedom (`dof`, `nodes`, `coordinates`) nor `rigid` and `held`"
            raise contents.refused(
                "dof", problem, "Add dof (n x 2: node, component 1 to 6, or 0), nodes (p) and coordinates (p x 3)"
            )
    units = description.units
    if (units.length, units.mass, units.time) != (SI.length, SI.mass, SI.time):
        problem = f"`rigid` without `dof` says not what is a length, and the units are {units.name}"
        raise contents.refused("rigid", problem, 'Add dof, nodes and coordinates, or write all in SI with units = "m-kg-N-s"')
    points = contents.numbers("points", (-1, 3)) if "points" in contents else np.zeros((0, 3))
    translations = contents.whole("translations", (len(points), 3)) if len(points) else np.zeros((0, 3), dtype=np.intp)
    held = contents.whole("held", (-1,))
    _require_within(contents, "held", held, n)
    _require_within(contents, "translations", translations, n)
    if len(np.unique(held)) < len(held):
        raise contents.refused("held", "names a degree of freedom twice", "Name every held degree of freedom once")
    return DofMap(
        labels=np.zeros((0, 2), dtype=np.intp),
        scale=np.ones(n),
        rigid=contents.numbers("rigid", (n, 6)),
        held=held,
        points=points,
        translations=translations,
    )


def _by_nodes(contents: Contents, description: Description, n: int) -> DofMap:
    labels = _labels(contents, n)
    nodes, coordinates = _nodes(contents)
    row = _row_of_nodes(contents, labels, nodes)
    if "rigid" in contents:  # Nastran, whose displacements may have directions of their own
        rigid, basic = contents.numbers("rigid", (n, 6)), contents.whole("basic", (len(nodes),)).astype(bool)
    else:
        rigid, basic = _rigid(labels, row, coordinates), np.ones(len(nodes), dtype=bool)
    units = description.units
    scale = units.coordinates(labels[:, 1])
    moved = rigid_transformation_6(-description.reference_point / units.length)
    points, translations = _points(labels, nodes[basic], coordinates[basic])
    return DofMap(
        labels=labels,
        scale=scale,
        rigid=scale[:, None] * (rigid @ moved) / _motions(units),
        held=_held(contents, description, labels),
        points=points * units.length,
        translations=translations,
    )


def _motions(units: UnitSystem) -> Array:
    """SI value (6,) of the user's unit of the six rigid motions."""
    return np.array([*3 * [units.length], *3 * [1.0]])


def _labels(contents: Contents, n: int) -> Integers:
    labels = contents.whole("dof", (-1, 2))
    if len(labels) != n:
        problem = f"names {len(labels)} degrees of freedom where the matrices have {n}"
        raise contents.refused("dof", problem, "Write one row, node and component, for every row of K and M, in their order")
    wrong = np.flatnonzero((labels[:, 1] < 0) | (labels[:, 1] > 6))
    if wrong.size:
        problem = f"row {wrong[0] + 1} has the component {labels[wrong[0], 1]}"
        remedy = "Components are 1 to 6 (x, y, z and the rotations about them), 0 for a generalised coordinate"
        raise contents.refused("dof", problem, remedy)
    _, first, count = np.unique(labels, axis=0, return_index=True, return_counts=True)
    if np.any(count > 1):
        node, component = labels[first[np.argmax(count > 1)]]
        problem = f"names node {node}, component {component} {count.max()} times"
        raise contents.refused("dof", problem, "Name every degree of freedom once; number generalised coordinates")
    return labels


def _nodes(contents: Contents) -> tuple[Integers, Array]:
    nodes = contents.whole("nodes", (-1,))
    coordinates = contents.numbers("coordinates", (-1, 3))
    if len(nodes) != len(coordinates):
        problem = f"holds {len(coordinates)} points for {len(nodes)} nodes"
        raise contents.refused("coordinates", problem, "Write one row x, y, z for every entry of nodes")
    unique, count = np.unique(nodes, return_counts=True)
    if np.any(count > 1):
        problem = f"names node {unique[np.argmax(count > 1)]} {count.max()} times"
        raise contents.refused("nodes", problem, "Name every node once")
    return nodes, coordinates


def _row_of_nodes(contents: Contents, labels: Integers, nodes: Integers) -> Integers:
    """Row in `nodes` of every degree of freedom (n,); meaningless where it is a generalised coordinate."""
    order = np.argsort(nodes)
    place = np.searchsorted(nodes, labels[:, 0], sorter=order)
    row = order[np.minimum(place, len(nodes) - 1)] if len(nodes) else np.full(len(labels), -1)
    lost = np.flatnonzero((labels[:, 1] > 0) & ((row < 0) | (nodes[row] != labels[:, 0] if len(nodes) else True)))
    if lost.size:
        problem = f"node {labels[lost[0], 0]} has no coordinates, as {len(np.unique(labels[lost, 0]))} node(s) in all"
        raise contents.refused("dof", problem, "Add the missing nodes to nodes and coordinates")
    return np.asarray(row)


def _rigid(labels: Integers, row: Integers, coordinates: Array) -> Array:
    """What every degree of freedom does in the six motions of the origin (n, 6), in the user's unit of length."""
    rigid, physical = np.zeros((len(labels), 6)), labels[:, 1] > 0
    every = rigid_motion(coordinates).reshape(-1, 6, 6) if len(coordinates) else np.zeros((0, 6, 6))
    rigid[physical] = every[row[physical], labels[physical, 1] - 1]
    return rigid


def _points(labels: Integers, nodes: Integers, coordinates: Array) -> tuple[Array, Integers]:
    """The nodes that can move along x, y and z, and the degrees of freedom that do it."""
    index = {(int(node), int(component)): k for k, (node, component) in enumerate(labels)}
    full = [k for k, node in enumerate(nodes) if all((int(node), c) in index for c in (1, 2, 3))]
    dofs = [[index[int(nodes[k]), c] for c in (1, 2, 3)] for k in full]
    return coordinates[full].reshape(-1, 3), np.array(dofs, dtype=np.intp).reshape(-1, 3)


def _held(contents: Contents, description: Description, labels: Integers) -> Integers:
    interface = description.interface or tuple(contents.whole("interface", (-1,)).tolist() if "interface" in contents else ())
    if not interface:
        problem, remedy = "is missing: no node is named that the base carries", "Add interface = [node, ...]"
        raise BadInput(source=description.source, field="fe_model.interface", problem=problem, remedy=remedy)
    physical = labels[:, 1] > 0
    for node in interface:
        if not np.any(physical & (labels[:, 0] == node)):
            problem = f"names node {node}, which has no degree of freedom in the matrices"
            remedy = f"The nodes there are {_some(np.unique(labels[physical, 0]))}"
            raise BadInput(source=description.source, field="fe_model.interface", problem=problem, remedy=remedy)
    return np.flatnonzero(physical & np.isin(labels[:, 0], interface))


def _some(values: Integers) -> str:
    return ", ".join(map(str, values[:6])) + (f", ... ({len(values)} in all)" if len(values) > 6 else "")


def _require_within(contents: Contents, name: str, values: Integers, n: int) -> None:
    if values.size and (values.min() < 0 or values.max() >= n):
        outside = values.min() if values.min() < 0 else values.max()
        problem = f"names the degree of freedom {outside} of {n}"
        raise contents.refused(name, problem, "Count from 0")


def _require_hold(found: DofMap, contents: Contents, description: Description) -> None:
    """The interface must follow all six motions: two nodes on a line that carry no rotations let the structure turn about it."""
    held = found.rigid[found.held]
    source = description.source if description.interface else contents.source
    field = "fe_model.interface" if description.interface else "held"
    remedy = "Name at least three nodes that are not on one line, or one that has its three rotations too"
    if not 0 < len(held) < len(found.rigid):
        problem = f"holds {len(held)} of all {len(found.rigid)} degrees of freedom"
        raise BadInput(source=source, field=field, problem=problem, remedy=remedy)
    centred = _about_interface(held)
    size = np.sqrt((centred[:, 3:] ** 2).sum(axis=0).max())
    scaled = centred / np.array([*3 * [1.0], *3 * [size or 1.0]])
    _, values, motions = np.linalg.svd(scaled, full_matrices=True)
    values = np.append(values, np.zeros(6 - len(values)))
    if values[-1] < INDEPENDENT * values[0]:
        axis = MOTIONS[int(np.argmax(np.abs(motions[-1])))]
        problem = f"does not hold the structure: it is free to move along or about {axis}"
        raise BadInput(source=source, field=field, problem=problem, remedy=remedy)


def _about_interface(held: Array) -> Array:
    """The rigid motions of the held degrees of freedom (b, 6), about a point in their middle rather than the reference point."""
    translations, rotations = held[:, :3], held[:, 3:]
    # A shift of the reference point by d adds translations @ skew(d) to the rotations; the best d in the least-squares sense.
    generators = np.stack([translations @ skew(axis) for axis in np.eye(3)], axis=-1).reshape(-1, 3)
    shift, *_ = np.linalg.lstsq(generators, -rotations.reshape(-1), rcond=None)
    return np.hstack([translations, rotations + (generators @ shift).reshape(rotations.shape)])
