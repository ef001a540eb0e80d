"""Which motion every row of a user's matrices is, where its nodes and places are, and the springs between them."""

from dataclasses import dataclass, replace
from types import MappingProxyType

import numpy as np

from fem import gravity
from fem.structure import Sparse, Structure, nearest_node, place_rows, rigid_motion
from fem.user_model.description import TABLE, Contents, Description
from fem.user_model.parts import GROUND, StatedJoint, StatedPlace, require_name
from fem.user_model.units import SI, UNKNOWN
from geometry import toml_file
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Integers, rigid_transformation_6, skew

# Which motion every row of K and M is, which of them the base carries, and what they do when it moves.

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
    points, translations, rotations : (p, 3) as in `Structure`
    """

    labels: Integers
    scale: Array
    rigid: Array
    held: Integers
    points: Array
    translations: Integers
    rotations: Integers

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
    found = (_by_nodes if "dof" in contents else _unnamed)(contents, description, n)
    if description.named.support == "base":
        _require_hold(found, contents, description)
    elif description.named.support == "free" and not np.any(found.rigid):
        problem = "is floating, and without coordinates nobody knows which motions are rigid"
        raise contents.refused("dof", problem, 'Add dof, nodes and coordinates, or write support = "ground"')
    return found


def _unnamed(contents: Contents, description: Description, n: int) -> DofMap:
    """Rows without nodes: `rigid` and `held` say what they do, as `write` leaves it; on the ground nothing need."""
    grounded = description.named.support == "ground"
    for name in ("rigid", "held"):
        if name not in contents and not grounded and (name, description.named.support) != ("held", "free"):
            problem = "there is neither a map of the degrees of freedom (`dof`, `nodes`, `coordinates`) nor `rigid` and `held`"
            remedy = "Add dof (n x 2: node, component 1 to 6, or 0), nodes (p) and coordinates (p x 3)"
            raise contents.refused("dof", problem, remedy)
    units = description.units
    if (units.length, units.mass, units.time) != (SI.length, SI.mass, SI.time):
        what = "rigid" if "rigid" in contents else "dof"
        problem = f"rows without `dof` say not what is a length, and the units are {units.name}"
        remedy = f'Add dof, nodes and coordinates, write all in SI with units = "m-kg-N-s", or units = "{UNKNOWN}" on the ground'
        raise contents.refused(what, problem, remedy)
    points = contents.numbers("points", (-1, 3)) if "points" in contents else np.zeros((0, 3))
    none = np.zeros((0, 3), dtype=np.intp)
    translations = contents.whole("translations", (len(points), 3)) if len(points) else none
    rotations = contents.whole("rotations", (len(points), 3)) if "rotations" in contents and len(points) else none
    held = contents.whole("held", (-1,)) if "held" in contents else none[:, 0]
    for name, rows in (("held", held), ("translations", translations), ("rotations", rotations[rotations != -1])):
        _require_within(contents, name, rows, n)
    if len(np.unique(held)) < len(held):
        raise contents.refused("held", "names a degree of freedom twice", "Name every held degree of freedom once")
    if len(held) and description.named.support != "base":
        problem = f'names {len(held)} degrees of freedom that a base carries, and support is "{description.named.support}"'
        raise contents.refused("held", problem, "Leave one of the two out")
    return DofMap(
        labels=np.zeros((0, 2), dtype=np.intp),
        scale=np.ones(n),
        rigid=contents.numbers("rigid", (n, 6)) if "rigid" in contents else np.zeros((n, 6)),
        held=held,
        points=points,
        translations=translations,
        rotations=rotations,
    )


def _by_nodes(contents: Contents, description: Description, n: int) -> DofMap:
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
    units = description.units
    if description.named.support == "ground" and "nodes" not in contents and "coordinates" not in contents:
        none = np.zeros((0, 3), dtype=np.intp)
        scale, rigid, held = units.coordinates(labels[:, 1]), np.zeros((n, 6)), none[:, 0]
        return DofMap(
            labels=labels, scale=scale, rigid=rigid, held=held, points=np.zeros((0, 3)), translations=none, rotations=none
        )
    nodes, coordinates = contents.whole("nodes", (-1,)), contents.numbers("coordinates", (-1, 3))
    if len(nodes) != len(coordinates):
        problem = f"holds {len(coordinates)} points for {len(nodes)} nodes"
        raise contents.refused("coordinates", problem, "Write one row x, y, z for every entry of nodes")
    unique, count = np.unique(nodes, return_counts=True)
    if np.any(count > 1):
        problem = f"names node {unique[np.argmax(count > 1)]} {count.max()} times"
        raise contents.refused("nodes", problem, "Name every node once")
    # Row in `nodes` of every degree of freedom (n,); meaningless where it is a generalised coordinate
    order = np.argsort(nodes)
    nearby = np.searchsorted(nodes, labels[:, 0], sorter=order)
    row = order[np.minimum(nearby, len(nodes) - 1)] if len(nodes) else np.full(len(labels), -1)
    lost = np.flatnonzero((labels[:, 1] > 0) & ((row < 0) | (nodes[row] != labels[:, 0] if len(nodes) else True)))
    if lost.size:
        problem = f"node {labels[lost[0], 0]} has no coordinates, as {len(np.unique(labels[lost, 0]))} node(s) in all"
        raise contents.refused("dof", problem, "Add the missing nodes to nodes and coordinates")
    if "rigid" in contents:  # Nastran, whose displacements may have directions of their own
        rigid, basic = contents.numbers("rigid", (n, 6)), contents.whole("basic", (len(nodes),)).astype(bool)
    else:
        # What every degree of freedom does in the six motions of the origin (n, 6), in the user's unit of length
        rigid, physical = np.zeros((len(labels), 6)), labels[:, 1] > 0
        every = rigid_motion(coordinates).reshape(-1, 6, 6) if len(coordinates) else np.zeros((0, 6, 6))
        rigid[physical] = every[row[physical], labels[physical, 1] - 1]
        basic = np.ones(len(nodes), dtype=bool)
    scale = units.coordinates(labels[:, 1])
    moved = rigid_transformation_6(-description.reference_point / units.length)
    # The nodes that can move along x, y and z, and the degrees of freedom that do it
    index = {(int(node), int(component)): k for k, (node, component) in enumerate(labels)}
    full = [k for k in np.flatnonzero(basic) if all((int(nodes[k]), c) in index for c in (1, 2, 3))]
    translations = np.array([[index[int(nodes[k]), c] for c in (1, 2, 3)] for k in full], dtype=np.intp).reshape(-1, 3)
    rotations = np.array([[index.get((int(nodes[k]), c), -1) for c in (4, 5, 6)] for k in full], dtype=np.intp).reshape(-1, 3)
    held = np.zeros(0, dtype=np.intp)
    if description.named.support == "base":
        interface = description.interface or tuple(contents.whole("interface", (-1,)).tolist() if "interface" in contents else ())
        if not interface:
            problem, remedy = "is missing: no node is named that the base carries", "Add interface = [node, ...]"
            raise BadInput(description.source, "fe_model.interface", problem, remedy)
        physical = labels[:, 1] > 0
        for node in interface:
            if not np.any(physical & (labels[:, 0] == node)):
                problem = f"names node {node}, which has no degree of freedom in the matrices"
                raise BadInput(description.source, "fe_model.interface", problem, _nodes_there(np.unique(labels[physical, 0])))
        held = np.flatnonzero(physical & np.isin(labels[:, 0], interface))
    return DofMap(
        labels=labels,
        scale=scale,
        rigid=scale[:, None] * (rigid @ moved) / np.array([*3 * [units.length], *3 * [1.0]]),
        held=held,
        points=coordinates[full].reshape(-1, 3) * units.length,
        translations=translations,
        rotations=rotations,
    )


def _nodes_there(numbers: Integers) -> str:
    """The first six of `numbers`, and how many there are."""
    more = f", ... ({len(numbers)} in all)" if len(numbers) > 6 else ""
    return f"The nodes there are {', '.join(map(str, numbers[:6]))}{more}"


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
        raise BadInput(source, field, f"holds {len(held)} of all {len(found.rigid)} degrees of freedom", remedy)
    # Motions about a point in the middle of the held degrees of freedom rather than the reference point: a shift of that by d
    # adds translations @ skew(d) to the rotations; the best d in the least-squares sense.
    translations, rotations = held[:, :3], held[:, 3:]
    generators = np.stack([translations @ skew(axis) for axis in np.eye(3)], axis=-1).reshape(-1, 3)
    shift, *_ = np.linalg.lstsq(generators, -rotations.reshape(-1), rcond=None)
    centred = np.hstack([translations, rotations + (generators @ shift).reshape(rotations.shape)])
    size = np.sqrt((centred[:, 3:] ** 2).sum(axis=0).max())
    scaled = centred / np.array([*3 * [1.0], *3 * [size or 1.0]])
    _, values, motions = np.linalg.svd(scaled, full_matrices=True)
    values = np.append(values, np.zeros(6 - len(values)))
    if values[-1] < INDEPENDENT * values[0]:
        axis = MOTIONS[int(np.argmax(np.abs(motions[-1])))]
        raise BadInput(source, field, f"does not hold the structure: it is free to move along or about {axis}", remedy)


# Places and joints that the description names, in the rows of a structure.

RIGID_JOINT = 1e-6
"""Share of what a joint's sides do in a rigid motion that may be left between them: digits of coordinates."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Motion:
    """How a place moves.

    Attributes
    ----------
    rows : (6, n) sparse, along x, y, z and about them; a row is empty where nothing moves
    point : (3,) [m], None where its coordinates are not known
    """

    rows: Sparse
    point: Array | None


def with_places(structure: Structure, dofs: DofMap, contents: Contents, description: Description) -> tuple[Structure, list[str]]:
    """`structure` with the places and joints that the description states, and what must be known of them, in sentences.

    Raises
    ------
    BadInput : a node or row that is not there, a point outside of the structure, a joint of places that are not there, that do
        not turn, or that lie apart, a storey of what is not there.
    """
    from scipy.sparse import csr_array, vstack

    motions, said = {}, []
    for name, place in description.named.places.items():
        motions[name], remark = _motion(structure, dofs, contents, description, name, place)
        said += [remark] if remark else []
    for name in contents.shares("places"):
        if name in motions:
            raise BadInput(description.source, f"{TABLE}.places.{name}", "is an array of the file, too", "Leave one out")
        require_name(name, contents.source, "places")
        moved = vstack([contents.matrix(f"places/{name}", (3, len(dofs.scale))), csr_array((3, len(dofs.scale)))])
        motions[name] = Motion(rows=csr_array(moved), point=None)
    for row in contents.whole("measured_dof", (-1,)) if "measured_dof" in contents else ():
        _require_within(contents, "measured_dof", np.array([row]), len(dofs.scale))
        motions.setdefault(f"dof-{row}", _of_rows((int(row), -1, -1), len(dofs.scale)))
    parts, stiffness = dict(structure.part_stiffness), structure.stiffness
    tolerances, supports = dict(structure.part_tolerances), list(description.named.supports)
    joints: list[str] = []
    for name, joint in description.named.joints.items():
        where = f"{TABLE}.joints.{name}"
        if joint.stiffness is not None:
            if name in parts:
                problem = "states six stiffnesses, and the matrices have a part of this name"
                raise BadInput(description.source, where, problem, "Leave one of the two out")
            share = _springs(joint, joint.stiffness, motions, structure, description, where)
            parts = parts or {"structure": stiffness}
            parts[name], stiffness = share, stiffness + share
        elif name not in parts:
            remedy = f"{toml_file.nearest(name, parts)}Add stiffness = [six], or stiffness/{name} to the matrices"
            raise BadInput(description.source, where, "has neither `stiffness` nor a part of its name in the matrices", remedy)
        (supports if GROUND in joint.between else joints).append(name)
        if joint.tolerance is not None:
            tolerances[name] = MappingProxyType({**tolerances.get(name, {}), "modulus": joint.tolerance})
    for name in description.named.supports:
        if name not in parts or name in description.named.joints:
            what = "a joint has that name" if name in parts else "the matrices have no such part"
            remedy = f"{toml_file.nearest(name, parts)}Parts are {', '.join(parts) or 'none: write stiffness/' + name}"
            raise BadInput(description.source, f"{TABLE}.supports", f"names {name!r}, and {what}", remedy)
    found = replace(
        structure,
        stiffness=stiffness,
        part_stiffness=MappingProxyType(parts),
        part_tolerances=MappingProxyType(tolerances),
        supports=tuple(supports),
        joints=tuple(joints),
        places=MappingProxyType({name: motion.rows[:3] for name, motion in motions.items()}),
    )
    leaning = gravity.geometric(found, description.named.storeys, description.named.vertical, description.source)
    if twice := sorted(leaning.keys() & structure.geometric.keys()):
        problem = f"the matrices have geometric/{twice[0]}, too"
        raise BadInput(description.source, f"{TABLE}.storeys.{twice[0]}", problem, "Leave one of the two out")
    return replace(found, geometric=MappingProxyType({**structure.geometric, **leaning})), said


def _of_rows(rows: tuple[int, ...], n: int) -> Motion:
    from scipy.sparse import csr_array

    along = [k for k, row in enumerate(rows) if row >= 0]
    moved = csr_array((np.ones(len(along)), (along, [rows[k] for k in along])), shape=(6, n))
    return Motion(rows=moved, point=None)


def _motion(
    structure: Structure, dofs: DofMap, contents: Contents, description: Description, name: str, place: StatedPlace
) -> tuple[Motion, str]:
    """How the place `name` moves, and a sentence where it lies off the node that carries it."""
    from scipy.sparse import csr_array, vstack

    n, source, where = len(dofs.scale), description.source, f"{TABLE}.places.{name}"
    if place.rows:
        if max(place.rows) >= n:
            raise BadInput(source, f"{where}.dof", f"names the degree of freedom {max(place.rows)} of {n}", "Count from 0")
        return _of_rows(place.rows, n), ""
    if place.node is not None:
        own = np.flatnonzero((dofs.labels[:, 0] == place.node) & (dofs.labels[:, 1] > 0))
        if not own.size:
            known = np.unique(dofs.labels[dofs.labels[:, 1] > 0, 0])
            remedy = _nodes_there(known) if len(known) else "The rows have no nodes: write { dof = [0, 1, 2] }"
            raise BadInput(source, where, f"is node {place.node}, which has no degree of freedom in the matrices", remedy)
        # The axes along which its rows move, which Nastran may turn; those of the model where it has no coordinates
        component = dofs.labels[own, 1] - 1
        axes, turns = dofs.rigid[own], component >= 3
        known_axes = np.any(axes)
        directions = np.where(turns[:, None], axes[:, 3:], axes[:, :3]) if known_axes else np.eye(3)[component % 3]
        blocks = np.where(turns[:, None], np.hstack([0 * directions, directions]), np.hstack([directions, 0 * directions]))
        rows = csr_array((blocks.T.ravel(), (np.repeat(np.arange(6), len(own)), np.tile(own, 6))), shape=(6, n))
        rows.eliminate_zeros()
        point = None
        if known_axes and "coordinates" in contents:
            at = contents.numbers("coordinates", (-1, 3))[contents.whole("nodes", (-1,)) == place.node][0]
            point = at * description.units.length
        return Motion(rows=rows, point=point), ""
    assert place.point is not None  # one of the three is there
    if not len(structure.points):
        problem = "is a coordinate, and the model has no coordinates of its own"
        raise BadInput(source, where, problem, "Write its rows: { dof = [0, 1, 2] }")
    node, distance, gap = nearest_node(structure, place.point)
    nearest = ", ".join(f"{x:.6g}" for x in structure.points[node])
    rows = place_rows(structure, place.point, source, where)[0]
    turning = structure.rotations[node] if len(structure.rotations) else ()
    there = [(axis, row) for axis, row in enumerate(turning) if row >= 0]
    about = csr_array((np.ones(len(there)), ([a for a, _ in there], [r for _, r in there])), shape=(3, n))
    said = f"The place {name} rides on the node at ({nearest}) m, {1e3 * distance:.3g} mm away." if distance > 1e-3 * gap else ""
    return Motion(rows=csr_array(vstack([rows, about])), point=place.point), said


def _springs(
    joint: StatedJoint, stiffness: Array, motions: dict[str, Motion], structure: Structure, description: Description, where: str
) -> Sparse:
    """K (n, n) of the six springs of `joint` between two places, or one and the ground, about its own place."""
    from scipy.sparse import csr_array, diags_array

    source = description.source
    for name in filter(None, (*joint.between, joint.at)):
        if name != GROUND and name not in motions:
            problem = f"names the place {name!r}, which is none of fe_model.places"
            raise BadInput(source, where, problem, f"{toml_file.nearest(name, motions)}Places are {', '.join(motions) or 'none'}")
    at, between = motions[joint.at or joint.between[0]].point, csr_array((6, structure.mass.shape[0]))
    for sign, name in zip((-1, 1), joint.between, strict=True):
        if name == GROUND:
            continue
        side = motions[name]
        arm = np.zeros(3) if at is None or side.point is None else at - side.point
        lever = rigid_transformation_6(arm)
        moved, moving = csr_array(csr_array(lever) @ side.rows), np.diff(side.rows.indptr) > 0
        for k in np.flatnonzero(stiffness):
            needed = np.flatnonzero(lever[k])
            if not np.all(moving[needed]):
                lost = int(needed[~moving[needed]][0])
                axis, other = MOTIONS[k], MOTIONS[lost]
                problem = f"is stiff along or about {axis}, and nothing of the place {name!r} moves along or about {other}"
                raise BadInput(source, where, problem, "Write 0 there, or name a place whose node has that motion")
        between = between + sign * moved
    if GROUND not in joint.between and np.any(structure.rigid):
        rides = [abs(motions[name].rows) @ np.abs(structure.rigid) for name in joint.between]
        stretched = np.abs(between @ structure.rigid)[stiffness > 0]
        allowed = RIGID_JOINT * np.max([side.max(axis=0) for side in rides], axis=0)
        if np.any(stretched > allowed):
            worst = int(np.argmax((stretched - allowed).max(axis=0)))
            problem = f"resists the rigid motion of the whole along or about {MOTIONS[worst]}: its two places lie apart"
            raise BadInput(source, where, problem, "Let the places coincide, or give both nodes with rotations")
    return csr_array(between.T @ diags_array(stiffness) @ between)
