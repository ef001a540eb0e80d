"""A spatial frame: beams between nodes, rigid bodies on nodes, rigid links between nodes, and matrices on ports.

A node either moves on its own or rides on another one. Riding is kinematics, not stiffness: u_rider = T u_carrier with T of
Eq. 3, put into every matrix before it is added, so a rigid link is exactly rigid and carries its mass exactly. `Plan` says what
there is; `assemble` makes the matrices; plans can be joined, which is how articles are stacked.
"""

from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from fem.beam.elements import Element, Sandwich, Section, sandwich_element, timoshenko
from geometry.frames import Array, freeze, rigid_transformation_6
from geometry.inertia import Inertia


@dataclass(frozen=True, eq=False, kw_only=True)
class Member:
    """A chain of elements along nodes, all with one section.

    Attributes
    ----------
    nodes : indices of the nodes in order
    section : what every element of it is made of
    z_axis : (3,) unit vector, the section's z axis in the frame; perpendicular to the member
    part : whose stiffness it is (a sandwich names its own three)
    bonded : nodes at which the layer of a sandwich cannot slip
    """

    nodes: tuple[int, ...]
    section: Section | Sandwich
    z_axis: Array
    part: str = "beam"
    bonded: frozenset[int] = frozenset()

    def __post_init__(self) -> None:
        freeze(self, z_axis=(3,))


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """A rigid body on a node; its inertia in the frame's axes about any point, negative where it takes material away."""

    node: int
    inertia: Inertia


@dataclass(frozen=True, eq=False, kw_only=True)
class Ports:
    """Stiffness and mass between nodes, in the frame's axes.

    Attributes
    ----------
    nodes : k of them
    stiffness, mass : (6 k, 6 k) symmetric, x, y, z, alpha, beta, gamma of the first node, then of the second ...
    part : whose stiffness it is
    """

    nodes: tuple[int, ...]
    stiffness: Array
    mass: Array
    part: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Plan:
    """What a frame is made of; node 0 is its foot, on which it stands.

    Attributes
    ----------
    nodes : (n, 3) [m]
    carriers : (n,) the node on which each one rides, itself when it moves on its own; a carrier rides on nobody
    top : node on which the next plan may stand
    loss_factors : of the parts that have one [1]
    """

    nodes: Array
    carriers: tuple[int, ...]
    members: tuple[Member, ...] = ()
    bodies: tuple[Body, ...] = ()
    ports: tuple[Ports, ...] = ()
    top: int = 0
    loss_factors: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))


@dataclass(frozen=True, eq=False, kw_only=True)
class Frame:
    """The assembled frame, free.

    Attributes
    ----------
    plan : what it was made of
    stiffness : by part, (n, n) each; six degrees of freedom x, y, z, alpha, beta, gamma a moving node, then slips
    mass : (n, n)
    rigid : (n, 6) what every degree of freedom does in the six unit motions of the frame's origin; zero for a slip
    moving : (p,) nodes that move on their own; node ``moving[i]`` has the degrees of freedom 6 i to 6 i + 5
    """

    plan: Plan
    stiffness: Mapping[str, Array]
    mass: Array
    rigid: Array
    moving: tuple[int, ...]


def on_top(lower: Plan, upper: Plan) -> Plan:
    """`upper` standing on the top of `lower`; both in the same axes and already in place."""
    shift = len(lower.nodes)
    foot = lower.carriers[lower.top]
    carriers = tuple(foot if carrier == 0 else carrier + shift for carrier in upper.carriers)
    members = [replace(m, nodes=_shifted(m.nodes, shift), bonded=frozenset(_shifted(m.bonded, shift))) for m in upper.members]
    return Plan(
        nodes=np.vstack([lower.nodes, upper.nodes]),
        carriers=lower.carriers + carriers,
        members=(*lower.members, *members),
        bodies=lower.bodies + tuple(replace(body, node=body.node + shift) for body in upper.bodies),
        ports=lower.ports + tuple(replace(p, nodes=_shifted(p.nodes, shift)) for p in upper.ports),
        top=upper.top + shift,
        loss_factors={**lower.loss_factors, **upper.loss_factors},
    )


def placed(plan: Plan, displacement: Array, prefix: str = "") -> Plan:
    """`plan` carried by `displacement` (3,) [m], the names of its parts with `prefix` before them."""
    members = []
    for m in plan.members:
        section = m.section
        if isinstance(section, Sandwich):
            bottom, layer, top = section.parts
            section = replace(section, parts=(prefix + bottom, prefix + layer, prefix + top))
        members.append(replace(m, part=prefix + m.part, section=section))
    return replace(
        plan,
        nodes=plan.nodes + displacement,
        members=tuple(members),
        bodies=tuple(replace(body, inertia=body.inertia.moved(displacement)) for body in plan.bodies),
        ports=tuple(replace(ports, part=prefix + ports.part) for ports in plan.ports),
        loss_factors={prefix + part: factor for part, factor in plan.loss_factors.items()},
    )


def assemble(plan: Plan) -> Frame:
    """Stiffness and mass of the frame that `plan` describes."""
    moving = tuple(n for n, carrier in enumerate(plan.carriers) if n == carrier)
    first = {node: 6 * index for index, node in enumerate(moving)}
    pieces = list(_pieces(plan, first))
    size = 1 + max(dof for _, dofs, _ in pieces for dof in dofs)
    M = np.zeros((size, size))
    stiffness: dict[str, Array] = {}
    for element, dofs, T in pieces:
        at = np.ix_(dofs, dofs)
        M[at] += _seen(element.mass, T)
        for part, k in element.stiffness.items():
            stiffness.setdefault(part, np.zeros((size, size)))[at] += _seen(k, T)
    rigid = np.zeros((size, 6))
    rigid[: 6 * len(moving)] = np.vstack([rigid_transformation_6(plan.nodes[node]) for node in moving])
    return Frame(plan=plan, stiffness=stiffness, mass=M, rigid=rigid, moving=moving)


def inertia(member: Member, nodes: Array) -> Inertia:
    """Inertia of `member` about the frame's origin: rods of its mass with its section's rotary inertia, in closed form."""
    section, total = member.section, np.zeros(10)
    for a, b in pairwise(member.nodes):
        length = float(np.linalg.norm(nodes[b] - nodes[a]))
        R, along = _axes(nodes[a], nodes[b], member.z_axis), section.mass * length**2 / 12
        moments = length * np.array([section.rotary_y + section.rotary_z, section.rotary_y + along, section.rotary_z + along])
        rod = Inertia.from_cog(section.mass * length, (nodes[a] + nodes[b]) / 2, R.T @ np.diag(moments) @ R)
        total = total + rod.about(np.zeros(3)).parameters
    return Inertia(parameters=total)


def _pieces(plan: Plan, first: Mapping[int, int]) -> Iterator[tuple[Element, list[int], Array]]:
    """Every element, body and port matrix, with degrees of freedom (m,) of the frame and what it makes of them, (n, m)."""
    following = 6 * len(first)
    for member in plan.members:
        made = {}
        for length in {_length(plan, a, b) for a, b in pairwise(member.nodes)}:
            if isinstance(member.section, Sandwich):
                made[length] = sandwich_element(member.section, length)
            else:
                made[length] = timoshenko(member.section, length, member.part)
        slips: dict[int, int] = {}
        for a, b in pairwise(member.nodes):
            element = made[_length(plan, a, b)]
            if plan.carriers[a] == plan.carriers[b]:
                element = replace(element, stiffness={})  # rigid: what it would store is rounding
            turned = np.kron(np.eye(4), _axes(plan.nodes[a], plan.nodes[b], member.z_axis))
            dofs, T = _riding(plan, first, (a, b), np.asarray(turned, dtype=np.float64))
            # Degrees of freedom that no node has, None where there is none because it is held
            extra: list[int | None] = []
            for node in (a, b) * element.nodal:
                if node not in slips and node not in member.bonded:
                    slips[node], following = following, following + 1
                extra.append(slips.get(node))
            extra += range(following, following + element.inner)
            following += element.inner
            if extra:
                there = [k for k, dof in enumerate(extra) if dof is not None]
                selected = np.eye(len(extra))[:, there]
                T = np.block([[T, np.zeros((len(T), len(there)))], [np.zeros((len(extra), T.shape[1])), selected]])
            yield element, dofs + [dof for dof in extra if dof is not None], T
    for ports in plan.ports:
        element = Element(stiffness={ports.part: ports.stiffness}, mass=ports.mass)
        yield element, *_riding(plan, first, ports.nodes, np.eye(6 * len(ports.nodes)))
    for body in plan.bodies:
        element = Element(stiffness={}, mass=body.inertia.about(plan.nodes[body.node]).mass_matrix)
        yield element, *_riding(plan, first, (body.node,), np.eye(6))


def _riding(plan: Plan, first: Mapping[int, int], nodes: Sequence[int], turned: Array) -> tuple[list[int], Array]:
    """Degrees of freedom of the carriers of `nodes` and ``turned @ T``, which makes the nodes' own from them."""
    carriers = [plan.carriers[node] for node in nodes]
    distinct = list(dict.fromkeys(carriers))
    T = np.zeros((len(turned), 6 * len(distinct)))
    for k, (node, carrier) in enumerate(zip(nodes, carriers, strict=True)):
        column, own = 6 * distinct.index(carrier), turned[:, 6 * k : 6 * k + 6]
        lever = plan.nodes[node] - plan.nodes[carrier]
        T[:, column : column + 6] += own @ rigid_transformation_6(lever) if lever.any() else own
    return [dof for carrier in distinct for dof in range(first[carrier], first[carrier] + 6)], T


def _axes(start: Array, end: Array, z_axis: Array) -> Array:
    """Rows: the element's axes x (start to end), y and z in the frame."""
    x_axis = (end - start) / np.linalg.norm(end - start)
    y_axis = np.array(
        [
            z_axis[1] * x_axis[2] - z_axis[2] * x_axis[1],
            z_axis[2] * x_axis[0] - z_axis[0] * x_axis[2],
            z_axis[0] * x_axis[1] - z_axis[1] * x_axis[0],
        ]
    )
    return np.array([x_axis, y_axis, z_axis])


def _seen(matrix: Array, T: Array) -> Array:
    seen = T.T @ matrix @ T
    return np.asarray((seen + seen.T) / 2)


def _length(plan: Plan, a: int, b: int) -> float:
    """Length [m] of an element, rounded so that equal elements are recognised."""
    return round(float(np.linalg.norm(plan.nodes[b] - plan.nodes[a])), 14)


def _shifted(nodes: Iterable[int], shift: int) -> tuple[int, ...]:
    return tuple(node + shift for node in nodes)
