"""A frame of beams in a few lines of a description: nodes, members between them, masses on them, and what their ends give.

    [fe_model]
    kind = "frame"
    nodes = { foot = "0 m", floor-1 = "0.2 m", floor-2 = "0.4 m" }      # heights, or ["x", "y", "z"] each
    fixed = ["foot"]
    support = "base"                                                    # what holds these; left out, the ground does
    moves = ["x"]                                                       # of all other nodes; everything where it is left out
    members = { walls-1 = ["foot", "floor-1"], walls-2 = ["floor-1", "floor-2"] }
    section = { width = "80 mm", thickness = "1 mm", across = "x", count = 2 }
    material = "steel"                 # or { density, youngs_modulus, poisson_ratio }; without a density it has no mass
    masses = { floor-1 = "1.83 kg", floor-2 = "1.83 kg" }

Every member is a part, its ends are joints ``member@node`` that give next to nothing, every node is a place, and a mass on a node
is a part that has mass alone. Where several members meet, one more joint, ``all@node``, is between the node and all of them:
where it gives, they stay joined to each other, as a column does that runs through a floor. What the weight above a member takes
of its stiffness (`Structure.geometric`) is that of a beam under its axial force, cubic shapes (J. S. Przemieniecki, Theory of
Matrix Structural Analysis, 1968, section 15.2).
"""

from collections.abc import Mapping
from dataclasses import replace
from typing import Any

import numpy as np

from fem.beam import elements, frame
from fem.mesh.description import PartTable, Profile
from fem.mesh.places import LINE, Block, Elements
from fem.structure import Sparse, Structure
from fem.user_model import parts
from geometry import article, toml_file
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.inertia import Inertia
from geometry.toml_file import STANDARD_GRAVITY

KEYS = (
    *("name", "kind", "nodes", "fixed", "support", "moves", "members", "section", "material", "masses", "elements"),
    *("loss_factor", "down"),
)
SECTION = ("width", "thickness", "across", "count")
MOTIONS = ("x", "y", "z", "rx", "ry", "rz")
SUPPORTS = ("ground", "base", "free")

HUB = "all@"
"""With which the name of a joint begins that is between a node and all members that meet there."""

WEIGHTLESS = 1e-9
"""[kg/m³] Of members without a density, by which none bows between its ends."""

STIFF = 1e4
"""[1] Of the member's own: an end this stiff is clamped to four digits of a frequency, and what it gives more shows at once."""


def structure(table: Mapping[str, Any], source: str, where: str = "fe_model") -> Structure:
    """The frame that `table` describes, on the ground or a base where a node is fixed, else free.

    On a base what does not move rides along with it.

    Raises
    ------
    BadInput : an unknown or missing key, a unit, a node that nobody names, a member of no length or across its own direction.
    """
    from scipy.sparse import csr_array

    toml_file.require_known(table, KEYS, source=source, where=where)
    toml_file.require_present(table, ("nodes", "members", "section", "material"), source=source, where=where)
    nodes = {}
    for name, value in _table(table, "nodes", source, where).items():
        three = value if isinstance(value, list) else ["0 m", "0 m", value]  # a height alone
        if len(three) != 3:
            remedy = 'Write "0.2 m" or ["0 m", "0 m", "0.2 m"]'
            raise toml_file.wrong(value, "a height, or three lengths", source, f"{where}.nodes.{name}", remedy)
        nodes[name] = np.array([_size(one, "length", source, f"{where}.nodes.{name}") for one in three])
    names = list(nodes)
    fixed = [_node(name, names, source, f"{where}.fixed") for name in table.get("fixed", [])]
    masses = {
        _node(name, names, source, f"{where}.masses"): _size(value, "mass", source, f"{where}.masses.{name}")
        for name, value in _table(table, "masses", source, where).items()
    }
    material, weighs = _material(table["material"], source, f"{where}.material")
    place = f"{where}.section"
    sizes = toml_file.require_table(table["section"], source=source, where=place)
    toml_file.require_known(sizes, SECTION, source=source, where=place)
    toml_file.require_present(sizes, SECTION[:3], source=source, where=place)
    width, thickness = (_size(sizes[key], "length", source, f"{place}.{key}") for key in SECTION[:2])
    section, across = elements.rectangle(width, thickness, material), parts.direction(sizes["across"], source, f"{place}.across")
    count = sizes.get("count", 1)  # how many stand side by side
    if not toml_file.is_whole(count) or not 1 <= count <= 1000:
        raise toml_file.wrong(count, "a whole number from 1 to 1000", source, f"{place}.count", "How many stand side by side")
    pieces = table.get("elements", 1)
    if not toml_file.is_whole(pieces) or not 1 <= pieces <= 100:
        remedy = "How many beams a member is made of"
        raise toml_file.wrong(pieces, "a whole number from 1 to 100", source, f"{where}.elements", remedy)
    points, members, ports = list(nodes.values()), list[frame.Member](), list[frame.Ports]()
    own = max(section.bending_y, section.bending_z, section.torsion)

    def join(one: int, other: int, length: float, joint: str) -> None:
        stiff = STIFF * np.array([*3 * [12 * own / length**3 + section.axial / length], *3 * [4 * own / length]])
        S = np.diag(stiff)
        ports.append(frame.Ports(nodes=(one, other), stiffness=np.block([[S, -S], [-S, S]]), mass=np.zeros((12, 12)), part=joint))

    meeting: dict[int, list[tuple[str, int, float]]] = {}  # by node the members that end there, where, and how long they are
    for name, ends in _table(table, "members", source, where).items():
        at = f"{where}.members.{name}"
        if not isinstance(ends, list) or len(ends) != 2:
            raise toml_file.wrong(ends, "two names of nodes", source, at, 'Write it like ["foot", "floor-1"]')
        a, b = (names.index(_node(end, names, source, at)) for end in ends)
        length = float(np.linalg.norm(points[b] - points[a]))
        if not length:
            raise toml_file.wrong(ends, "two nodes apart from each other", source, at, "Correct the nodes")
        if abs(across @ (points[b] - points[a])) > 1e-6 * length:
            problem = f"is thin along its own direction: `across` of the section is {across.tolist()}"
            raise BadInput(source, at, problem, "Name an axis that is square to every member")
        first = len(points)
        points += [points[a] + share * (points[b] - points[a]) for share in np.linspace(0.0, 1.0, pieces + 1)]
        members.append(frame.Member(nodes=tuple(range(first, len(points))), section=section, z_axis=across, part=name))
        for node, end in ((a, first), (b, len(points) - 1)):
            meeting.setdefault(node, []).append((name, end, length))
    for node, joined in meeting.items():
        hub = node
        if len(joined) > 1:
            hub = len(points)
            points.append(points[node])
            join(node, hub, min(length for _, _, length in joined), f"{HUB}{names[node]}")
        for name, end, length in joined:
            join(hub, end, length, f"{name}@{names[node]}")
    plan = frame.Plan(nodes=np.array(points), carriers=tuple(range(len(points))), members=tuple(members), ports=tuple(ports))
    made, size = frame.assemble(plan), 6 * len(points)
    # By part its mass: that of a member, and those on nodes
    part_mass = {}
    for one in members if weighs else ():  # alone, beside an empty port that keeps the size
        empty = frame.Ports(nodes=(len(points) - 1,), stiffness=np.zeros((6, 6)), mass=np.zeros((6, 6)), part=one.part)
        part_mass[one.part] = frame.assemble(replace(plan, members=(one,), ports=(empty,))).mass
    for name, mass in masses.items():
        whole, k = np.zeros((size, size)), 6 * names.index(name)
        whole[k : k + 6, k : k + 6] = Inertia.from_cog(mass, np.zeros(3), np.zeros((3, 3))).mass_matrix
        part_mass[name] = whole
    moves = table.get("moves", list(MOTIONS))
    for axis in moves if isinstance(moves, list) else [moves]:
        toml_file.one_of(axis, MOTIONS, source=source, where=f"{where}.moves")
    support = toml_file.one_of(
        table.get("support", "ground" if fixed else "free"), SUPPORTS, source=source, where=f"{where}.support"
    )
    if (support == "free") == bool(fixed):
        problem = f"is {support!r}, and fixed nodes are {', '.join(fixed) or 'none'}"
        raise BadInput(source, f"{where}.support", problem, "Correct one of them")
    held = [6 * k + m for k, name in enumerate(names) for m in range(6) if name in fixed or MOTIONS[m] not in moves]
    if not part_mass:
        raise BadInput(source, f"{where}.masses", "nothing has mass", "State masses, or a density")
    down = np.tile(np.concatenate([parts.direction(table.get("down", "-z"), source, f"{where}.down"), np.zeros(3)]), len(points))
    weights = [(count if name in _names(members) else 1.0) * M @ down for name, M in part_mass.items()]
    loads = STANDARD_GRAVITY * np.sum(weights, axis=0)
    bent = [6 * k + m for k, name in enumerate(names) for m in range(6) if name in fixed]
    geometric = _geometric(plan, members, np.sum(list(made.stiffness.values()), axis=0), loads, bent, size, count) if bent else {}
    free = np.setdiff1d(np.arange(size), [] if support == "base" else held)
    loss = parts.loss_factor(table, source, where)
    moments = (thickness**3 * width / 12, width**3 * thickness / 12, elements.rectangle_torsion(width, thickness))
    profile = Profile(
        sizes=tuple(count * size for size in (width * thickness, *moments)),
        material=material,
        shear=2 * (elements.cowper_rectangle(material.poisson_ratio or 0.0),),
    )
    reach = max(width, thickness) / 2
    beam = PartTable(material=material, section=profile, z_axis=across, reach=reach, loss_factor=loss, tolerance={})
    carriers = _carriers(plan, beam, free, source)

    def kept(matrix: Array, times: float = 1.0) -> Sparse:
        return csr_array(times * matrix[np.ix_(free, free)])

    parts_of, stiffness = _names(members), {name: kept(K, count) for name, K in made.stiffness.items()}
    weighing = {name: kept(M, count if name in parts_of else 1.0) for name, M in part_mass.items()}
    shown = [*range(len(names)), *(node for one in members for node in one.nodes[1:-1])]
    freedoms = carriers.own.reshape(-1, 6)[shown]
    return Structure(
        stiffness=sum(stiffness.values()),
        mass=sum(weighing.values()),
        elements=carriers,
        rigid=made.rigid[free],
        held=np.array(held if support == "base" else [], dtype=np.intp),
        points=plan.nodes[shown],
        translations=freedoms[:, :3],
        rotations=freedoms[:, 3:],
        part_stiffness=stiffness,
        part_mass=weighing,
        loss_factors=dict.fromkeys(parts_of, loss) if loss else {},
        grounded=bool(held) and support != "base",
        joints=tuple(name for name in made.stiffness if name not in parts_of),
        places={name: carriers.node(k)[:3] for k, name in enumerate(names) if (freedoms[k, :3] >= 0).any()},
        geometric={name: kept(K) for name, K in geometric.items()},
    )


def _carriers(plan: frame.Plan, beam: PartTable, free: Integers, source: str) -> Elements:
    """What carries a point of the members of `plan`, each a `beam`, on the degrees of freedom that are `free`."""
    from scipy.sparse import csr_array

    size, blocks, begin = 6 * len(plan.nodes), list[Block](), 1
    own = np.full(size, -1)
    own[free] = np.arange(len(free))
    for one in plan.members:
        ends = np.column_stack([one.nodes[:-1], one.nodes[1:]])
        blocks.append(Block(part=one.part, kind=LINE, tags=begin + np.arange(len(ends)), nodes=ends))
        begin += len(ends)
    return Elements(
        source=source,
        node_tags=np.zeros(len(plan.nodes), dtype=np.intp),
        points=plan.nodes,
        blocks=tuple(blocks),
        parts={one.part: beam for one in blocks},
        first=6 * np.arange(len(plan.nodes)),
        turning=np.ones(len(plan.nodes), dtype=np.bool_),
        own=own,
        carried=csr_array((np.ones(len(free)), (free, own[free])), shape=(size, len(free))),
    )


def _names(members: list[frame.Member]) -> list[str]:
    return [one.part for one in members]


def _geometric(
    plan: frame.Plan, members: list[frame.Member], K: Array, loads: Array, bent: list[int], size: int, count: int
) -> dict[str, Array]:
    """By member (size, size) what its axial force under `loads` adds to its stiffness; the nodes `bent` stand still."""
    free, u = np.setdiff1d(np.arange(size), bent), np.zeros(size)
    u[free] = np.linalg.solve(count * K[np.ix_(free, free)], loads[free])
    found = {}
    for one in members:
        own = np.zeros((size, size))
        assert isinstance(one.section, elements.Section)
        stretch = one.section.axial
        for a, b in zip(one.nodes[:-1], one.nodes[1:], strict=True):
            along = plan.nodes[b] - plan.nodes[a]
            L = float(np.linalg.norm(along))
            R = np.kron(np.eye(4), [along / L, np.cross(one.z_axis, along / L), one.z_axis])
            at = [*range(6 * a, 6 * a + 6), *range(6 * b, 6 * b + 6)]
            pulled = R @ u[at]
            N = count * stretch / L * (pulled[6] - pulled[0])
            # Under a unit pull, cubic shapes
            p, q, r = L / 10, 2 * L**2 / 15, -(L**2) / 30
            k = np.array([[6 / 5, p, -6 / 5, p], [p, q, -p, r], [-6 / 5, -p, 6 / 5, -p], [p, r, -p, q]]) / L
            whole, sign = np.zeros((12, 12)), elements.SIGN_XZ
            whole[np.ix_(elements.IN_XY, elements.IN_XY)] = k
            whole[np.ix_(elements.IN_XZ, elements.IN_XZ)] = np.outer(sign, sign) * k
            own[np.ix_(at, at)] += R.T @ (N * whole) @ R
        found[one.part] = own
    return found


def _table(table: Mapping[str, Any], key: str, source: str, where: str) -> dict[str, Any]:
    return toml_file.require_table(table.get(key, {}), source=source, where=f"{where}.{key}")


def _size(value: Any, dimension: str, source: str, where: str) -> float:
    return float(toml_file.quantity(value, dimension, source=source, field=where).nominal_value)


def _node(name: Any, names: list[str], source: str, where: str) -> str:
    if name not in names:
        remedy = f"{toml_file.nearest(str(name), names)}Nodes are {', '.join(names)}"
        raise BadInput(source, where, f"no node is called {name!r}", remedy)
    return str(name)


def _material(value: Any, source: str, where: str) -> tuple[article.Material, bool]:
    """The material, and whether it weighs anything."""
    if isinstance(value, str):
        return article.material(value, source), True
    table = toml_file.require_table(value, source=source, where=where)
    keys = {"density": "density", "youngs_modulus": "pressure", "poisson_ratio": "ratio"}
    toml_file.require_known(table, tuple(keys), source=source, where=where)
    toml_file.require_present(table, tuple(keys)[1:], source=source, where=where)
    sizes = {}
    for key, dimension in ((key, dimension) for key, dimension in keys.items() if key in table):
        value = table[key]
        bare = dimension == "ratio" and toml_file.is_number(value)
        sizes[key] = float(value) if bare else _size(value, dimension, source, f"{where}.{key}")
    return article.Material(name=source, **({"density": WEIGHTLESS} | sizes)), "density" in table
