"""From a description and its mesh or STEP file to a `Structure` with parts, places, supports, joints and sections."""

from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.mesh import description as described
from fem.mesh import files, shells, solids
from fem.mesh.constraints import NamedSum, eliminated, fitted, matrix
from fem.mesh.description import SEAM
from fem.mesh.places import LINE, ROD, SIX, Block, Elements, assembled, symmetric
from fem.solid import assembly, tetrahedra
from fem.structure import Sparse, Structure
from fem.user_model import description as text
from fem.user_model import frame
from geometry import toml_file
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Integers, rigid_transformation_6

SMALLEST, LARGEST = 1e-3, 5e3
"""Largest dimension [m] that a structure may have; beyond, the unit is not believed."""

LARGEST_SIDE = tetrahedra.LARGEST_MESH
"""Degrees of freedom."""

FLAT = 1e-6
"""Area or volume of an element, relative to the square or cube of its longest edge, below which it is degenerate."""

COINCIDENT = 1e-6
"""Distance of two nodes, as a share of the structure's size, below which they are at one place."""

RIGID = 1e-5
"""[1] Share of a rigid motion by which equations may break it: coefficients of a deck have six digits. By definition."""

MOST_DOUBLINGS = 30
"""Of how many nodes follow each other one by one: twice as many are followed each time."""

LEVEL = 1e-9
"""[share of a structure's size] Height of nodes over the plane of a link below which they are in it: rounding. By definition."""


def load(path: Path) -> tuple[str, Structure]:
    """The name and the structure that `path` describes.

    Raises
    ------
    BadInput : whatever is wrong with description, mesh or geometry: what, where, how many, what to do.
    CheckFailed : no valid mesh of an assembly.
    """
    found = described.read(path)
    return found.name, structure(found, _meshed(found) if found.kind == "assembly" else found.mesh())


def _meshed(found: described.MeshDescription) -> files.MeshFile:
    """Bodies of a STEP file as curved tetrahedra in metres, nodes common where faces touch."""
    from geometry import cad

    bodies = cad.read(found.file)
    names = [body.name for body in bodies]
    for name in found.parts:
        if name not in names:
            problem, remedy = (
                f"{found.file.name} holds no body {name!r}",
                f"{toml_file.nearest(name, names)}It holds {', '.join(names)}",
            )
            raise found.refused(f"parts.{name}", problem, remedy)
    bare = [name for name in names if name not in found.parts]
    if bare:
        raise _without_material(found, f"{len(bare)} of {len(names)} bodies", files.joined(bare))
    solid = [tetrahedra.imported(one.name, found.parts[one.name].material, one.solid) for one in bodies]
    mesh = tetrahedra.tetrahedra(solid, tetrahedra.Sizing(size=found.size))
    cells = files.Cells(kind="tet10", tags=np.arange(1, len(mesh.cells) + 1), nodes=mesh.cells)
    groups = {name: {"tet10": np.flatnonzero(mesh.part == k)} for k, name in enumerate(mesh.parts)}
    lowest = {described.LOWEST: assembly.base(mesh)} if described.LOWEST in found.interface else {}
    return files.MeshFile(
        source=str(found.file),
        node_tags=np.arange(1, len(mesh.points) + 1),
        points=mesh.points / found.length,
        cells={"tet10": cells},
        groups=groups,
        node_groups=lowest,
    )


def _without_material(found: described.MeshDescription, what: str, which: str) -> BadInput:
    return found.refused(
        "parts", f"{what} have no material: {which}", 'Write [fe_model.parts.NAME] with material = "steel" for each'
    )


def structure(found: described.MeshDescription, mesh: files.MeshFile) -> Structure:
    """The structure that `found` makes of `mesh`.

    Raises
    ------
    BadInput : see `load`.
    """
    blocks = tuple(_blocks(found, mesh))
    blocks, points, tags, sets, cuts = _nodes(found, mesh, blocks)
    size = float(np.ptp(points, axis=0).max())
    if not SMALLEST <= size <= LARGEST:
        fitting = [unit.name for unit in toml_file.UNITS.values() if SMALLEST <= size / found.length * unit.metres <= LARGEST]
        problem = f"with it the structure is {size:.4g} m long, which none is (1 mm to 5 km)"
        remedy = f"In {' or '.join(fitting)} it would be of ordinary size" if fitting else "Check the mesh"
        raise found.refused("units", problem, remedy)
    _require_sound(found, points, blocks)
    elements, linked = _numbered(found, mesh, points, tags, blocks, sets)
    stiffness, mass, sections = assembled(elements)
    made = _Made(found=found, elements=elements, sets=sets)
    supports, joints = list[str](), list[str]()
    for name, spring in found.springs.items():
        ends = [made.end(name, spring, at) for at in spring.at]
        K = _spring(ends[0] - ends[1] if len(ends) == 2 else ends[0], spring.stiffness)
        stiffness[_new(found, name, stiffness, "springs")] = K
        (joints if len(ends) == 2 else supports).append(name)
    for name, joint in found.joints.items():
        stiffness[_new(found, name, stiffness, "joints")] = _spring(made.across(name, joint, cuts.get(name)), joint.stiffness)
        joints.append(name)
    where = _own(elements)
    stiff = frame.STIFF * np.where(where >= 0, _sum(stiffness).diagonal()[where], 0.0)
    for name, (one, other) in linked.items():
        largest = np.maximum(stiff[one], stiff[other]).reshape(2, 3).max(axis=1)  # one node of solids turns nothing
        R = elements.node(one) - elements.node(other)
        stiffness[_new(found, name, stiffness, "links")] = _spring(R, np.repeat(largest, 3))
        joints.append(name)
    for name, body in found.masses.items():
        R = made.motion(body.at, f"masses.{name}")
        mass[_new(found, name, mass, "masses")] = symmetric(R.T @ body.inertia.mass_matrix @ R)
    K, M = _sum(stiffness), _sum(mass)
    parts = {name: share for name, share in stiffness.items() if name not in found.parts}
    made.require_joined(parts, tuple(supports), list(linked.values()))
    rides = np.diff(elements.carried.indptr)[elements.first[:, None] + SIX[:3]] > 0
    free = (where[:, :3] >= 0).any(axis=1) & (rides <= (where[:, :3] >= 0)).all(axis=1)
    finished = Structure(
        stiffness=K,
        mass=M,
        rigid=elements.rigid(found.reference_point),
        held=made.held if found.support == "base" else np.zeros(0, dtype=np.intp),
        reference_point=found.reference_point,
        points=elements.points[free],
        translations=where[free, :3],
        rotations=where[free, 3:],
        part_stiffness=stiffness,
        part_mass=mass,
        loss_factors={
            name: one.loss_factor
            for each in (found.parts, found.springs, found.joints)
            for name, one in each.items()
            if one.loss_factor is not None
        },
        grounded=found.support == "ground",
        supports=tuple(supports),
        joints=tuple(joints),
        places=made.places(),
        sections=sections,
        part_tolerances={name: part.tolerance for name, part in found.parts.items() if part.tolerance},
        elements=elements,
    )
    made.require_stated(finished)
    return finished


def _new(found: described.MeshDescription, name: str, table: Mapping[str, Sparse], key: str) -> str:
    if name in table:
        problem = "has the name of a part, joint or spring that is there already"
        raise found.refused(f"{key}.{name}", problem, "Give it its own name")
    return name


# Parts: which elements belong to which group, each to one.


def _blocks(found: described.MeshDescription, mesh: files.MeshFile) -> Iterator[Block]:
    claimed = {kind: np.full(len(cells.tags), -1, dtype=np.intp) for kind, cells in mesh.cells.items()}
    names = list(found.parts)
    for number, (name, part) in enumerate(found.parts.items()):
        if name not in mesh.groups:
            known = list(mesh.groups)
            remedy = f"{toml_file.nearest(name, known)}Groups of elements are {files.joined(known, 20) or 'none'}"
            raise found.refused(f"parts.{name}", f"the mesh has no group {name!r}", remedy)
        kinds = {kind: index for kind, index in mesh.groups[name].items() if kind != files.POINT}
        for kinds_of, key, given in ((files.SHELLS, "thickness", part.thickness), (files.BEAMS, "section", part.section)):
            count = sum(len(index) for kind, index in kinds.items() if kind in kinds_of)
            if count and given is None:
                what = "shell" if key == "thickness" else "beam"
                remedy = (
                    'Write thickness = "3 mm"' if key == "thickness" else 'Write section = { width = "20 mm", height = "40 mm" }'
                )
                raise found.refused(f"parts.{name}.{key}", f"is missing, and the group has {count} {what} elements", remedy)
            if given is not None and not count:
                problem = "belongs to shells or beams, of which the group has none"
                raise found.refused(f"parts.{name}.{key}", problem, "Leave it out")
        if not kinds:
            problem = "the group holds no lines, faces or volumes"
            raise found.refused(f"parts.{name}", problem, "Name the group that the part is made of")
        for kind, index in kinds.items():
            other = claimed[kind][index]
            if np.any(other >= 0):
                doubled = index[other >= 0]
                problem = (
                    f"{len(doubled)} {kind} elements belong to {names[other[other >= 0][0]]} as well, "
                    f"such as element {files.joined(mesh.cells[kind].tags[doubled], 3)}"
                )
                raise found.refused(f"parts.{name}", problem, "Let the groups not overlap: an element has one material")
            claimed[kind][index] = number
            cells = mesh.cells[kind]
            halves = [[0, 2], [2, 1]] if kind == "line3" else [list(range(cells.nodes.shape[1]))]
            rod = kind in files.BEAMS and part.section is not None and part.section.rod
            if rod and kind == "line3":
                problem = "is that of rods, and what stands in the middle of a line of three nodes would hold by nothing"
                raise found.refused(f"parts.{name}.section", problem, "Mesh its lines with two nodes each")
            yield Block(
                part=name,
                kind=ROD if rod else LINE if kind == "line3" else kind,
                tags=np.tile(cells.tags[index], len(halves)),
                nodes=np.vstack([cells.nodes[index][:, half] for half in halves]),
                axes=None if cells.axes is None else np.tile(cells.axes[index], (len(halves), 1)),
                offsets=None if cells.offsets is None else cells.offsets[index] * found.length,
                loose=None if cells.loose is None else cells.loose[index],
            )
    _require_covered(found, mesh, claimed)


def _require_covered(found: described.MeshDescription, mesh: files.MeshFile, claimed: Mapping[str, Integers]) -> None:
    """Elements of the highest dimension, and lower ones that hang on no part, must have a material; none is there twice."""
    top, used = max(files.DIMENSION[kind] for kind in mesh.cells), np.zeros(len(mesh.points), dtype=bool)
    for kind, owner in claimed.items():
        used[mesh.cells[kind].nodes[owner >= 0]] = True
    bare = {}
    for kind, owner in claimed.items():
        if kind == files.POINT:
            continue
        cells = mesh.cells[kind]
        told: list[npt.NDArray[Any]] = [np.sort(cells.nodes, axis=1)]
        if mesh.coordinates is not None:  # a deck may have a bar and a rod there, or two bars on either side
            told += [owner[:, None], *([] if cells.offsets is None else [cells.offsets.reshape(len(owner), -1)])]
        same = np.unique(np.hstack(told), axis=0, return_inverse=True)[1].ravel()
        count = np.bincount(same, weights=owner >= 0)[same]
        doubled = np.flatnonzero((count > 1) & (owner >= 0))
        if len(doubled):
            names, tags = list(found.parts), cells.tags[doubled]
            problem = f"{len(doubled)} {kind} elements have the same nodes as another: {files.joined(tags)}"
            raise found.refused(f"parts.{names[owner[doubled[0]]]}", problem, "An element has one material: write each once")
        # What has the nodes of an element with a material is that element once more, as MSH 2 writes it for another group
        alone = (owner < 0) & (count == 0) & ((files.DIMENSION[kind] == top) | ~used[cells.nodes].all(axis=1))
        if np.any(alone):
            bare[kind] = np.flatnonzero(alone)
    if not bare:
        return
    groups = [
        name
        for name, kinds in mesh.groups.items()
        if any(len(np.intersect1d(kinds.get(kind, []), index)) for kind, index in bare.items())
    ]
    words = ", ".join(f"{len(index)} {kind} elements" for kind, index in bare.items())
    raise _without_material(found, words, f"group {files.joined(groups)}" if groups else "they belong to no group")


# Nodes: those that are used, in metres; those of two parts that a joint parts are there twice.

Sets = dict[str, Integers]


def _nodes(
    found: described.MeshDescription, mesh: files.MeshFile, blocks: tuple[Block, ...]
) -> tuple[tuple[Block, ...], Array, Integers, Sets, Mapping[str, tuple[Integers, Integers]]]:
    """Blocks with nodes numbered anew, points [m], their numbers in the file, groups of nodes, and both sides of every joint."""
    riders = [one for link in found.riding.values() for one in link.nodes if isinstance(one, int)]  # also at no element
    riders += [node for _, terms in found.sums() for _, node, _ in terms if isinstance(node, int)]
    riders += [at for spring in found.springs.values() for at in spring.at if isinstance(at, int)]
    ridden = np.flatnonzero(np.isin(mesh.node_tags, riders) & (mesh.node_tags > 0))
    used = np.unique(np.concatenate([ridden, *(block.nodes.ravel() for block in blocks)]))
    number = np.full(len(mesh.points), -1, dtype=np.intp)
    number[used] = np.arange(len(used))
    blocks = tuple(replace(block, nodes=number[block.nodes]) for block in blocks)
    points, tags = mesh.points[used] * found.length, mesh.node_tags[used]
    sets = {name: own[own >= 0] for name in mesh.names if len(own := number[mesh.nodes_of(name)])}
    margin = COINCIDENT * float(np.ptp(points, axis=0).max())
    for name, box in found.boxes.items():
        inside = np.flatnonzero(((points >= box[0] - margin) & (points <= box[1] + margin)).all(axis=1))
        if not len(inside):
            away = np.linalg.norm(np.maximum(0, np.maximum(box[0] - points, points - box[1])), axis=1)
            nearest = ", ".join(f"{1e3 * value:.5g}" for value in points[np.argmin(away)])
            problem = f"the box holds no node; the nearest is at ({nearest}) mm, {1e3 * away.min():.4g} mm away"
            raise found.refused(f"groups.{name}", problem, "Correct its corners, or their unit")
        sets[name] = inside
    cuts: dict[str, tuple[Integers, Integers]] = {}
    for name, joint in found.joints.items():
        for part in joint.between:
            if part not in found.parts:
                known = list(found.parts)
                problem, remedy = (
                    f"there is no part {part!r}",
                    f"{toml_file.nearest(part, known)}Parts are {files.joined(known, 20)}",
                )
                raise found.refused(f"joints.{name}", problem, remedy)
        one, other = (np.unique(np.concatenate([b.nodes.ravel() for b in blocks if b.part == part])) for part in joint.between)
        common = np.intersect1d(one, other)
        if len(common):
            twin, turned = np.arange(len(points), len(points) + len(common)), np.arange(len(points) + len(common))
            turned[common] = twin
            blocks = tuple(replace(b, nodes=turned[b.nodes]) if b.part == joint.between[1] else b for b in blocks)
            points, tags = np.vstack([points, points[common]]), np.append(tags, tags[common])
            cuts[name] = common, twin
    return blocks, points, tags, sets, cuts


def _require_sound(found: described.MeshDescription, points: Array, blocks: Sequence[Block]) -> None:
    """Refuse elements that are inside out or have no extent, with how many and which."""
    said = []
    for block in blocks:
        corners = block.corners(points)
        edge = np.ptp(corners, axis=1).max(axis=1)
        if block.kind in solids.KINDS:
            least = np.concatenate(
                [solids.determinants(block.kind, corners[k : k + 5000]).min(axis=1) for k in range(0, len(corners), 5000)]
            )
            flat, inverted = np.abs(least) <= FLAT * edge**3, least < -FLAT * edge**3
        elif block.kind in (LINE, ROD):
            flat = np.linalg.norm(corners[:, 1] - corners[:, 0], axis=1) <= COINCIDENT * np.ptp(points, axis=0).max()
            inverted = np.zeros_like(flat)
        else:
            each = [corners[:, triangle] for triangle, _ in shells.TRIANGLES[block.kind]]
            flat = np.any([shells.areas(own) <= FLAT * edge**2 for own in each], axis=0)
            normals = [np.cross(own[:, 1] - own[:, 0], own[:, 2] - own[:, 0]) for own in each]
            inverted = ~flat & np.any([np.sum(normals[0] * normal, axis=1) < 0 for normal in normals], axis=0)
        for bad, words in ((inverted, "inside out"), (flat, "degenerate (no extent)")):
            if np.any(bad):
                said.append(f"{np.sum(bad)} {block.kind} elements of {block.part} are {words}: {files.joined(block.tags[bad])}")
    if said:
        remedy = "Mesh it again with smaller elements, or correct the order of their nodes"
        raise BadInput(str(found.file), "elements", "; ".join(said), remedy)


# Degrees of freedom: three at a node of solids and rods, six of shells and beams; links let some ride on others.
#
# A shell or beam that ends on a solid is welded to it: its rotations there are those of the solid's elements around the node.


def _numbered(
    found: described.MeshDescription,
    mesh: files.MeshFile,
    points: Array,
    tags: Integers,
    blocks: tuple[Block, ...],
    sets: dict[str, Integers],
) -> tuple[Elements, dict[str, tuple[int, int]]]:
    """The elements, and by name the joints of links: two nodes at one place each, the link's own and what its part rides on."""
    from scipy.sparse import coo_array, eye_array

    own, carriers = len(points), list(_carriers(found, tags, blocks, sets))
    points = np.vstack([points, *(np.array([found.links[one.link].at]) for one in carriers)])
    near, lone = COINCIDENT * float(np.ptp(points, axis=0).max()), np.flatnonzero(~np.isin(mesh.node_tags, tags))
    there = [lone[np.linalg.norm(mesh.points[lone] * found.length - at, axis=1) <= near] for at in points[own:]]
    # A link has the number of the one node that the file has for it, at which no element is
    of_links = [mesh.node_tags[of[0]] if len(of) == 1 and not one.part else 0 for of, one in zip(there, carriers, strict=True)]
    tags, turning = np.append(tags, of_links).astype(np.intp), np.ones(len(points), dtype=bool)
    turning[np.concatenate([block.nodes.ravel() for block in blocks])] = False
    for block in blocks:
        if block.turning:
            turning[block.nodes] = True
    count = np.where(turning, 6, 3)
    first, size = np.append(0, np.cumsum(count))[:-1].astype(np.intp), int(count.sum())
    if size > LARGEST_SIDE:
        problem = f"it makes {size:,} degrees of freedom, {LARGEST_SIDE:,} are allowed"
        raise found.refused("file", problem, "Write a coarser mesh")
    keep = np.ones(size, dtype=np.bool_)
    rows, columns, values = [], [], []
    joints: dict[str, tuple[int, int]] = {}
    for carrier, one in enumerate(carriers, start=own):
        directions, moved = found.links[one.link].directions, np.zeros(6)
        for rider in one.riders.tolist():
            ways = np.array([way for way in directions if way < count[rider]], dtype=np.intp)
            ridden = first[rider] + ways
            if not keep[ridden].all():
                problem = f"node {tags[rider]} rides on another link already"
                raise found.refused(f"links.{one.link}", problem, "Let a node ride on one link only")
            keep[ridden] = False
            T = rigid_transformation_6(points[rider] - points[carrier])[ways]
            moved = np.maximum(moved, np.abs(T).max(axis=0, initial=0.0))
            rows.append(np.repeat(ridden, 6))
            columns.append(np.tile(first[carrier] + SIX, len(ways)))
            values.append(T.ravel())
        if len(one.riders) and not moved.any():
            problem = "none of its nodes moves in these directions: solids and rods do not turn"
            raise found.refused(f"links.{one.link}.directions", problem, "Name x, y or z as well")
        if len(directions) < len(SIX):  # what moves nothing that rides is held
            keep[first[carrier] + SIX[moved <= LEVEL * np.ptp(points, axis=0).max()]] = False
        if one.part:
            joints[f"{one.link}@{one.part}"] = int(sets[one.link][0]), carrier
        else:
            sets[one.link] = np.array([carrier], dtype=np.intp)

    none = np.zeros(0, dtype=np.intp)
    ridden, on = (np.concatenate([none, *each]).astype(np.intp) for each in (rows, columns))
    riding = coo_array((np.concatenate([np.zeros(0), *values]), (ridden, on)), shape=(size, size)).tocsr()
    rides = np.zeros(size, dtype=bool)
    rides[ridden] = True
    base = np.zeros(size, dtype=bool)
    for node in _chosen(found, sets, tags, found.interface, "interface").tolist():
        ground = first[node] + np.arange(count[node])
        if found.support != "ground":
            base[ground] = True
            continue
        if rides[ground].any():
            raise found.refused("interface", f"node {tags[node]} rides on a link", "Hold the link instead")
        keep[ground] = False
    for name, hold in found.holds.items():
        for node in _chosen(found, sets, tags, hold.nodes, f"holds.{name}.nodes").tolist():
            held = first[node] + np.array([way for way in hold.directions if way < count[node]], dtype=np.intp)
            if rides[held].any():
                raise found.refused(f"holds.{name}", f"node {tags[node]} rides on a link", "Hold the link instead")
            keep[held] = False
    # Of nodes at no element, which ride, are tied or hang on springs, what nothing moves is no motion of the structure
    sums, idle = list(_sums(found, sets, tags, first, count)), np.zeros(size, dtype=bool)
    for node in np.setdiff1d(np.arange(own), np.concatenate([block.nodes.ravel() for block in blocks])).tolist():
        idle[first[node] + SIX] = True
    idle[[dof for one in sums for _, dof in one]] = False
    for spring in found.springs.values():
        for at in spring.at:
            if isinstance(at, int):
                node = _node(found, tags, at, "springs")[0]
                acts = np.flatnonzero(np.abs(_reaching(spring, points[node])[spring.stiffness != 0]).max(axis=0, initial=0.0))
                idle[first[node] + acts[acts < count[node]]] = False
    keep[idle & ~rides] = False
    following = eliminated(sums, riding, ~keep & ~rides, base)
    keep[list(following)] = False
    rotations = np.where(turning, first, 0)[:, None] + SIX[3:]
    turned = _welded(points, blocks, first, turning & keep[rotations].any(axis=1)).where(keep)
    keep[turned.rows] = False
    own_dofs, carried = np.where(keep, np.cumsum(keep) - 1, -1), eye_array(size, format="csr")
    if not keep.all():
        plain, leads = np.flatnonzero(keep), riding + matrix(following, size) + turned.matrix(size)
        carried = coo_array((np.ones(len(plain)), (plain, own_dofs[plain])), shape=(size, len(plain))).tocsr()
        for _ in range(MOST_DOUBLINGS):
            if not leads.nnz:
                break
            carried, leads = carried + leads @ carried, leads @ leads
        else:
            raise found.refused("equations", "nodes follow each other in a circle", "Let one of them follow none")
    made = Elements(
        source=mesh.source,
        node_tags=tags,
        points=points,
        blocks=blocks,
        parts=found.parts,
        first=first,
        turning=turning,
        own=own_dofs,
        carried=carried,
    )
    if found.support != "ground":
        _require_rigid(found, made, sums)
    return made, joints


def _sums(
    found: described.MeshDescription, sets: Sets, tags: Integers, first: Integers, count: Integers
) -> Iterator[list[tuple[float, int]]]:
    """Equations as terms of coefficient and degree of freedom."""
    for name, terms in found.sums():
        nodes = _lone(found, sets, tags, name, terms)
        for node, (_, of, way) in zip(nodes, terms, strict=True):
            if way >= count[node]:
                problem = f"node {of} is one of solids or rods, which do not turn ({MOTIONS[way]})"
                raise found.refused(f"equations.{name}.sums", problem, "Leave its rotations out")
        yield [(factor, int(first[node]) + way) for node, (factor, _, way) in zip(nodes, terms, strict=True)]


def _lone(found: described.MeshDescription, sets: Sets, tags: Integers, name: str, terms: NamedSum) -> list[int]:
    """The node of each term."""
    nodes = [_chosen(found, sets, tags, (of,), f"equations.{name}.sums") for _, of, _ in terms]
    if many := [(of, len(each)) for each, (_, of, _) in zip(nodes, terms, strict=True) if len(each) != 1]:
        raise found.refused(f"equations.{name}.sums", f"{many[0][0]!r} are {many[0][1]} nodes", "Name one node in each term")
    return [int(each[0]) for each in nodes]


def _require_rigid(found: described.MeshDescription, made: Elements, sums: Sequence[list[tuple[float, int]]]) -> None:
    """Refuse equations that hold what no ground holds: a rigid motion must not break them."""
    wide = float(np.ptp(made.points, axis=0).max())
    whole = made.rigid_everywhere(found.reference_point) / np.array([1.0, 1.0, 1.0, wide, wide, wide])
    for (name, terms), one in zip(found.sums(), sums, strict=True):
        factors, dofs = (np.array(each) for each in zip(*one, strict=True))
        largest = np.abs(factors * np.array([1.0 if way < 3 else 1 / wide for *_, way in terms])).max()
        broken = np.abs(factors @ whole[dofs]) / largest
        if broken.max() > RIGID:
            motion, node = MOTIONS[int(np.argmax(broken))], terms[0][1]
            problem = f"they resist a rigid motion ({motion}) by what they say of node {node}, and no ground is there"
            raise found.refused(f"equations.{name}", problem, 'Correct them, or write support = "ground"')


@dataclass(frozen=True, eq=False, kw_only=True)
class _Carrier:
    """What `riders` (r,), nodes of a `link`, ride on: the link itself, or of a further `part` what a joint holds to it."""

    link: str
    riders: Integers
    part: str = ""


def _carriers(found: described.MeshDescription, tags: Integers, blocks: Sequence[Block], sets: Sets) -> Iterator[_Carrier]:
    """Of every link itself, and of each part beyond the first that rides on it; of all where the ground holds it.

    Parts that are welded to each other there ride as one.
    """
    nodes = {name: np.unique(np.concatenate([b.nodes.ravel() for b in blocks if b.part == name])) for name in found.parts}
    turning = np.unique(np.concatenate([np.zeros(0, np.intp), *(b.nodes.ravel() for b in blocks if b.turning)]))
    riding, between = dict[str, tuple[Integers, dict[str, Integers]]](), dict[str, tuple[str, ...]]()
    for link, stated in found.riding.items():
        riders = _chosen(found, sets, tags, stated.nodes, f"links.{link}.nodes")
        own: dict[str, Integers] = {}
        for name, each in nodes.items():
            some = np.intersect1d(riders, each)
            for other in [one for one in own if len(np.intersect1d(own[one], some))]:
                name, some = other, np.union1d(own.pop(other), some)
            if len(some):
                own[name] = some
        held = found.support == "ground" and link in found.interface
        # One node of solids has no rotations by which it could hold what rides on it
        apart = [name for name in list(own)[0 if held else 1 :] if len(own[name]) > 1 or np.isin(own[name], turning).all()]
        whole = len(stated.directions) == len(SIX)  # what rides in some directions alone is no joint
        riding[link] = riders, {name: own[name] for name in apart if whole}
        between[link] = ("ground",) * held + tuple(own)
    alike = Counter(between[link] for link, (_, apart) in riding.items() if apart)
    for link, (riders, parted) in riding.items():
        joined = {} if alike[between[link]] > SEAM else parted
        yield _Carrier(link=link, riders=np.setdiff1d(riders, np.concatenate([riders[:0], *joined.values()])))
        for part, each in joined.items():
            yield _Carrier(link=link, riders=each, part=part)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Welded:
    """Rotations `rows` (w,) that ride, and the entries by which they do: (row, column, value) each."""

    rows: Integers
    entries: tuple[Integers, Integers, Array]

    def where(self, free: npt.NDArray[np.bool_]) -> "_Welded":
        """Those of rotations that are `free` (m,); the others are held, or ride on a link."""
        r, c, v = self.entries
        kept = free[r]
        return _Welded(rows=self.rows[free[self.rows]], entries=(r[kept], c[kept], v[kept]))

    def matrix(self, size: int) -> Sparse:
        from scipy.sparse import coo_array

        r, c, v = self.entries
        return coo_array((v, (r, c)), shape=(size, size)).tocsr()


def _welded(points: Array, blocks: Sequence[Block], first: Integers, turning: npt.NDArray[np.bool_]) -> _Welded:
    """How nodes that are `turning` (p,) and belong to solids turn: with the translations of the solids' nodes around them."""
    around: dict[int, list[Integers]] = {}
    for block in blocks:
        if block.kind in solids.KINDS and np.any(touched := turning[block.nodes]):
            for cell in np.flatnonzero(touched.any(axis=1)).tolist():
                for node in block.nodes[cell][touched[cell]].tolist():
                    around.setdefault(node, []).append(block.nodes[cell])
    rows, columns, values = [np.zeros(0, dtype=np.intp)], [np.zeros(0, dtype=np.intp)], [np.zeros(0)]
    for node, cells in around.items():
        others = np.unique(np.concatenate(cells))
        turns, dofs = fitted(points[others], points[node])[3:], (first[others][:, None] + SIX[:3]).ravel()
        rows.append(np.repeat(first[node] + SIX[3:], len(dofs)))
        columns.append(np.tile(dofs, 3))
        values.append(turns.ravel())
    r = np.concatenate(rows)
    return _Welded(rows=np.unique(r), entries=(r, np.concatenate(columns), np.concatenate(values)))


def _chosen(found: described.MeshDescription, sets: Sets, tags: Integers, named: Sequence[int | str], field: str) -> Integers:
    nodes = [_node(found, tags, name, field) if isinstance(name, int) else _set(found, sets, name, field) for name in named]
    return np.unique(np.concatenate([np.zeros(0, dtype=np.intp), *nodes])).astype(np.intp)


def _set(found: described.MeshDescription, sets: Sets, name: str, field: str) -> Integers:
    if name not in sets:
        remedy = f"{toml_file.nearest(name, sets)}Groups are {files.joined(sets, 20) or 'none'}"
        raise found.refused(field, f"the mesh has no group {name!r}", remedy)
    return sets[name]


def _node(found: described.MeshDescription, tags: Integers, number: int, field: str) -> Integers:
    index = np.flatnonzero((tags == number) & (tags > 0))[:1]
    if not len(index):
        problem = f"no element of the parts has a node {number}"
        raise found.refused(field, problem, f"Nodes are numbered {tags[tags > 0].min()} to {tags.max()}; or give coordinates")
    return index


def _own(elements: Elements) -> Integers:
    """Degrees of freedom (p, 6) of the structure that are those of each node, -1 where it rides, is held or does not turn."""
    found = np.full((len(elements.points), 6), -1, dtype=np.intp)
    found[:, :3] = elements.own[elements.first[:, None] + SIX[:3]]
    found[elements.turning, 3:] = elements.own[elements.first[elements.turning][:, None] + SIX[3:]]
    return found


def _sum(shares: Mapping[str, Sparse]) -> Sparse:
    first, *others = shares.values()
    return sum(others, first)


def _reaching(spring: described.Spring, point: Array) -> Array:
    """What the end of a spring does along its axes of what moves and turns `point` (3,); (6, 6)."""
    turn = np.eye(6) if spring.about is None else rigid_transformation_6(spring.about - point)
    return turn if spring.axes is None else np.asarray(np.kron(np.eye(2), spring.axes) @ turn)


def _spring(R: Sparse, stiffness: Array) -> Sparse:
    """R^T k R for six stiffnesses along and about the axes of the frame."""
    from scipy.sparse import diags_array

    return symmetric(R.T @ diags_array(stiffness) @ R)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Made:
    """Elements with the names that a description gives to places of them."""

    found: described.MeshDescription
    elements: Elements
    sets: Sets

    @property
    def interface(self) -> Integers:
        """Nodes that the base carries or the ground holds."""
        return _chosen(self.found, self.sets, self.elements.node_tags, self.found.interface, "interface")

    @property
    def held(self) -> Integers:
        """Degrees of freedom that the base carries."""
        own = _own(self.elements)[self.interface]
        lost = self.interface[(own[:, :3] < 0).any(axis=1)]
        if len(lost):
            problem = f"node {self.elements.node_tags[lost[0]]} rides on a link"
            raise self.found.refused("interface", problem, "Let the base carry the link instead")
        return np.setdiff1d(own, [-1])

    def motion(self, at: described.At, field: str) -> Sparse:
        """What moves and turns the place `at`; (6, n)."""
        if isinstance(at, tuple):
            return self.elements.motion(np.array(at), field)
        if isinstance(at, int):
            return self.elements.node(int(_node(self.found, self.elements.node_tags, at, field)[0]))
        if at in self.found.places and self.found.places[at] != at:
            return self.motion(self.found.places[at], field)
        if (link := self.found.links.get(at)) and link.follows:
            several = [_chosen(self.found, self.sets, self.elements.node_tags, (n,), f"links.{at}.mean_of") for n in link.nodes]
            weights = np.repeat(link.weights or np.ones(len(several)), [len(one) for one in several])
            return self.elements.mean(np.concatenate(several), np.array(link.at), link.rotations, weights)
        nodes = _set(self.found, self.sets, at, field)
        if len(nodes) == 1:
            return self.elements.node(int(nodes[0]))
        return self.elements.mean(nodes, self.elements.points[nodes].mean(axis=0))

    def end(self, name: str, spring: described.Spring, at: described.At) -> Sparse:
        """What moves and turns the end of a spring that is `at` a place, along its axes; (6, n)."""
        from scipy.sparse import csr_array

        R = self.motion(at, f"springs.{name}")
        if spring.axes is None and spring.about is None:
            return R
        return csr_array(_reaching(spring, np.zeros(3) if spring.about is None else self._point(at, f"springs.{name}"))) @ R

    def places(self) -> dict[str, Sparse]:
        """The user's places, and every group that is one node."""
        single = {name: self.motion(name, name)[:3] for name, nodes in self.sets.items() if len(nodes) == 1}
        return single | {name: self.motion(at, f"places.{name}")[:3] for name, at in self.found.places.items()}

    def across(self, name: str, joint: described.Joint, cut: tuple[Integers, Integers] | None) -> Sparse:
        """What the first part of a joint moves and turns beside the second, about its place; (6, n)."""
        point = self._point(joint.at, f"joints.{name}.at")
        if cut is not None:
            return self.elements.mean(cut[0], point) - self.elements.mean(cut[1], point)
        one, other = (self.elements.motion(point, f"joints.{name}", part) for part in joint.between)
        return one - other

    def _point(self, at: described.At, field: str) -> Array:
        """Coordinates (3,) [m] of a place."""
        if isinstance(at, tuple):
            return np.array(at)
        if isinstance(at, int):
            return np.asarray(self.elements.points[_node(self.found, self.elements.node_tags, at, field)[0]])
        if at in self.found.places and self.found.places[at] != at:
            return self._point(self.found.places[at], field)
        return np.asarray(self.elements.points[_set(self.found, self.sets, at, field)].mean(axis=0))

    def require_joined(self, springs: Mapping[str, Sparse], supports: Sequence[str], linked: Sequence[tuple[int, int]]) -> None:
        """Refuse groups that hang on nothing: where they are, and whether nodes there merely were not merged.

        Elements, links and springs connect the nodes that they have, whatever their stiffness is.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components
        from scipy.spatial import cKDTree

        found, elements, size = self.found, self.elements, len(self.elements.points)
        where, node = _own(elements), np.zeros(elements.carried.shape[1], dtype=np.intp)
        node[where[where >= 0]] = np.nonzero(where >= 0)[0]
        ends = {name: np.unique(node[np.unique(spring.indices[spring.data != 0])]) for name, spring in springs.items()}
        together = [block.nodes for block in elements.blocks] + [one[None] for one in ends.values() if len(one)]
        together += [np.array([pair]) for pair in linked]
        for name, one in found.springs.items():  # an end that is held moves nothing, and holds the other
            both = [at for at in one.at if isinstance(at, int) or at in self.sets]
            together += [_chosen(found, self.sets, elements.node_tags, both, name)[None]] if both else []
        for name, link in found.riding.items():
            together.append(np.append(self.sets[name], _chosen(found, self.sets, elements.node_tags, link.nodes, name))[None])
        together += [np.array([_lone(found, self.sets, elements.node_tags, *one)]) for one in found.sums()]
        pairs = np.vstack([np.column_stack([np.repeat(own[:, 0], own.shape[1]), own.ravel()]) for own in together])
        body = connected_components(coo_array((np.ones(len(pairs)), pairs.T), shape=(size, size)), directed=False)[1]
        holding = [_chosen(found, self.sets, elements.node_tags, one.nodes, "holds") for one in found.holds.values()]
        tied = np.unique(body[np.concatenate([self.interface, *holding, *(ends[name] for name in supports)]).astype(np.intp)])
        if found.support == "free":
            tied = np.array([np.argmax(np.bincount(body))])
        loose, said = np.setdiff1d(body, tied), []
        for k in loose[:3]:
            nodes = np.flatnonzero(body == k)
            parts = list(dict.fromkeys(b.part for b in elements.blocks if np.isin(b.nodes, nodes).any()))
            others = np.flatnonzero(body != k)
            distance = (
                cKDTree(elements.points[others]).query(elements.points[nodes])[0] if len(others) and len(nodes) else np.zeros(0)
            )
            same = int(np.sum(distance <= COINCIDENT * np.ptp(elements.points, axis=0).max()))
            near = "" if not len(distance) else f", {1e3 * distance.min():.3g} mm from the nearest other"
            near = f", {same} of its nodes coincide with others that they are not merged with" if same else near
            said.append(f"{len(nodes)} nodes of {files.joined(parts) or 'a link'}{near}")
        if said:
            to = {"base": "the base", "ground": "the ground", "free": "the rest"}[found.support]
            more = f"; and {len(loose) - 3} more" if len(loose) > 3 else ""
            problem = (
                f"{len(loose)} {'body is' if len(loose) == 1 else 'bodies are'} not connected to {to}: {'; '.join(said)}{more}"
            )
            remedy = "Merge the nodes where parts touch, add a joint or link between them, or hold them"
            raise found.refused("parts", problem, remedy)

    def require_stated(self, made: Structure) -> None:
        """Refuse a mass or a centre of gravity that is not the stated one."""
        found, stated, M = self.found, self.found.stated, made.rigid_mass
        if found.support == "ground" and (found.interface or found.holds):
            return  # what the ground holds is not in the matrices any more
        if stated.mass is not None and abs(M[0, 0] - stated.mass) > max(text.MASS * stated.mass, 3 * stated.mass_tolerance):
            ratio = M[0, 0] / stated.mass
            problem = f"the mesh weighs {M[0, 0]:.6g} kg where {stated.mass:.6g} kg are stated, {ratio:.6g} times as much"
            remedy = (
                "Check the unit (lengths twice as large weigh eight times as much), densities, thicknesses, and what is left out"
            )
            raise BadInput(found.source, "stated.mass", problem, remedy)
        cog = found.reference_point + np.array([M[1, 5], M[2, 3], M[0, 4]]) / M[0, 0]
        size = float(np.ptp(made.points, axis=0).max())
        if stated.cog is not None and np.linalg.norm(cog - stated.cog) > text.COG * size:
            there, wanted = (", ".join(f"{1e3 * value:.5g}" for value in point) for point in (cog, stated.cog))
            problem = f"the mesh has its CoG at ({there}) mm where ({wanted}) mm is stated"
            raise BadInput(found.source, "stated.cog", problem, "Check the frame, the units and the densities")
