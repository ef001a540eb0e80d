"""An article in exudyn: a frame made of exudyn's own items.

What there is comes from a `fem.beam.frame.Plan` - places, sections, rigid bodies, who rides on whom - and none of our matrices.
The beams are exudyn's `ObjectBeamGeometricallyExact`, two nodes and interpolated on SE(3): constant strain, which does not lock
in shear but bends too stiffly by the square of the element length, so two meshes say where they go (`fem.exudyn.linear`). Every
node is given without rotation and every section turned into the frame's axes; exudyn takes the strain of the reference state
off, so that a straight beam may run along x, y or z and the coordinates of its nodes stay small motions in the frame. Askew it
may not: exudyn takes no stiffness between different strains.

A sandwich is what it is in the workshop: two beams as faces and, between them, springs for the layer that only shears. Its
torsion comes out of that by itself: in a twist the faces shear in their planes and drag the layer, and a clamp holds their
warping.

Damping, where it is asked for, is viscous and written as a second plan whose stiffnesses are dampings (`viscous`).
Exudyn's beam takes a damping matrix and makes no force of it (1.13.6), so a damper stands beside every beam, between arms that
reach from both nodes to its middle: there the relative motion of the arms is the constant strain of the beam times its length,
and nothing moves when the whole turns.
"""

from collections import defaultdict
from dataclasses import dataclass, replace
from itertools import pairwise
from typing import Any

import numpy as np

from fem.beam.elements import Sandwich, Section
from fem.beam.frame import Member, Plan, Ports
from fem.exudyn.run import ORDER_OF_SIX
from geometry.frames import Array, freeze
from geometry.inertia import Inertia, judge

THICKNESS_OVER_SHEAR = 50.0
"""Stiffness of a nearly incompressible layer across its thickness over that in shear, 2 (1 - nu) / (1 - 2 nu) at nu = 0.49."""

NOTHING = np.zeros((6, 6))

Node = int
"""A node of exudyn. Its coordinates are x, y, z, alpha, beta, gamma and begin at six times its number."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Native:
    """A plan in exudyn.

    Attributes
    ----------
    container : owns `system`, which dies with it
    system : exudyn's `MainSystem`, assembled
    points : (n, 3) [m] places of its nodes
    nodes : for every node of the plan those of exudyn that stand for it: one, the two faces of a sandwich, or none
    """

    container: Any
    system: Any
    points: Array
    nodes: tuple[tuple[Node, ...], ...]

    def __post_init__(self) -> None:
        freeze(self, "points")


def build(exudyn: Any, plan: Plan, *, held: bool, damping: Plan | None = None) -> Native:
    """`plan` in exudyn, its foot joined to the ground when `held`, free otherwise.

    Parameters
    ----------
    damping : the same plan with viscous dampings [N s, N m² s ...] where `plan` has stiffnesses; undamped when None
    """
    return _FrameBuilder(exudyn, plan, damping).build(held)


class _FrameBuilder:
    def __init__(self, exudyn: Any, plan: Plan, damping: Plan | None) -> None:
        from exudyn import itemInterface

        self.exudyn, self.plan = exudyn, plan
        undamped = [replace(p, stiffness=np.zeros_like(p.stiffness)) for p in plan.ports]
        self.damping: Any = (damping.members, damping.ports) if damping else ([None] * len(plan.members), undamped)
        self.items: Any = itemInterface
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()
        self.points: list[Array] = []
        self.nodes: dict[int, tuple[Node, ...]] = {}
        self.bodies: dict[int, Any] = {}

    def build(self, held: bool) -> Native:
        self._rigid_bodies()
        for member, damper in zip(self.plan.members, self.damping[0], strict=True):
            losses = damper.section if damper else None
            if isinstance(member.section, Sandwich):
                self._sandwich(member, member.section, losses)
            else:
                self._chain(member, member.section, [self._node(k) for k in member.nodes], losses)
        for ports, damper in zip(self.plan.ports, self.damping[1], strict=True):
            self._ports(ports, damper.stiffness)
        if held:
            self._hold()
        self.system.Assemble()
        nodes = tuple(self.nodes.get(k, ()) for k in range(len(self.plan.nodes)))
        return Native(container=self.container, system=self.system, points=np.array(self.points), nodes=nodes)

    def _new_node(self, place: Array) -> Node:
        self.points.append(np.asarray(place))
        return int(self.system.AddNode(self.items.NodeRigidBodyRxyz(referenceCoordinates=[*map(float, place), 0.0, 0.0, 0.0])))

    def _node(self, number: int) -> Node:
        """Exudyn's node for that of the plan, made when it is asked for; joined to the body on which it rides."""
        if number not in self.nodes:
            self.nodes[number] = (self._new_node(self.plan.nodes[number]),)
            self._join(number, self.nodes[number][0])
        return self.nodes[number][0]

    def _rigid_bodies(self) -> None:
        """One body for every node that carries, its foot first so that the base has the first six coordinates."""
        inertias: dict[int, Inertia] = defaultdict(lambda: Inertia(parameters=np.zeros(10)))
        for body in self.plan.bodies:
            inertias[self.plan.carriers[body.node]] += body.inertia
        carriers = {carrier for node, carrier in enumerate(self.plan.carriers) if node != carrier}
        for carrier in sorted({0, *carriers, *inertias}):
            self.bodies[carrier] = self._rigid(self._node(carrier), inertias[carrier].about(self.plan.nodes[carrier]))

    def _rigid(self, node: Node, inertia: Inertia) -> Any:
        """A rigid body on `node`. Material taken away is no body: its matrix is subtracted and a massless one marks the place."""
        if inertia.parameters.any() and not judge(inertia).physical:
            taken = self.items.ObjectGenericODE2(nodeNumbers=[node], massMatrix=inertia.mass_matrix)
            self.system.AddObject(taken)
            inertia = Inertia(parameters=np.zeros(10))
        return self._body(node, inertia)

    def _body(self, node: Node, inertia: Inertia) -> Any:
        centre = inertia.first_moment / inertia.mass if inertia.mass else np.zeros(3)
        item = self.items.ObjectRigidBody(
            mass=inertia.mass, inertia=inertia.parameters[4:][ORDER_OF_SIX], centerOfMass=centre.tolist(), nodeNumber=node
        )
        return self.system.AddObject(item)

    def _join(self, number: int, node: Node) -> None:
        carrier = self.plan.carriers[number]
        if carrier == number:
            return
        lever = np.asarray(self.points[node]) - self.plan.nodes[carrier]
        there = self._marker(self.bodies[carrier], lever)
        here = self.system.AddMarker(self.items.MarkerNodeRigid(nodeNumber=node))
        self.system.AddObject(self.items.ObjectJointGeneric(markerNumbers=[there, here]))

    def _hold(self) -> None:
        ground = self.system.AddObject(self.items.ObjectGround(referencePosition=self.plan.nodes[0].tolist()))
        markers = [self._marker(body, np.zeros(3)) for body in (ground, self.bodies[0])]
        self.system.AddObject(self.items.ObjectJointGeneric(markerNumbers=markers))

    def _marker(self, body: Any, place: Array) -> Any:
        return self.system.AddMarker(self.items.MarkerBodyRigid(bodyNumber=body, localPosition=place.tolist()))

    def _chain(self, member: Member, section: Section, nodes: list[Node], losses: Section | None) -> None:
        for a, b in pairwise(nodes):
            axis = self.points[b] - self.points[a]
            length = float(np.linalg.norm(axis))
            axes = _axes(axis / length, member.z_axis)
            data = self._section(section, axes)
            self.system.AddObject(self.items.ObjectBeamGeometricallyExact(nodeNumbers=[a, b], length=length, sectionData=data))
            if losses is not None:
                middle = (self.points[a] + self.points[b]) / 2
                self._between(middle, a, b, damping=_turned(_strains(losses), axes) / length)

    def _section(self, s: Section, axes: Array) -> Any:
        """`s` with its stiffness and inertia in the frame's axes; the columns of `axes` are the section's."""
        if not np.isfinite([s.shear_y, s.shear_z]).all():
            raise ValueError("exudyn's beam needs the shear stiffness of its section, found one without shear deformation")
        data = self.exudyn.BeamSection()
        data.massPerLength = s.mass
        data.inertia = axes @ np.diag([s.rotary_y + s.rotary_z, s.rotary_y, s.rotary_z]) @ axes.T
        turned = _turned(_strains(s), axes)
        if np.any(turned - np.diag(np.diag(turned))):
            raise ValueError("exudyn's beam takes a diagonal stiffness, so members must run along x, y or z, found another one")
        data.stiffnessMatrix = turned
        return data

    def _sandwich(self, member: Member, sandwich: Sandwich, losses: Sandwich | None) -> None:
        """Two faces apart, and at every node the springs of as much layer as belongs to it."""
        offset = sandwich.distance / 2 * member.z_axis
        faces = [[self._new_node(self.plan.nodes[k] + side * offset) for k in member.nodes] for side in (-1, 1)]
        for nodes in faces:
            self._chain(member, _face(sandwich), nodes, _face(losses) if losses else None)
        lengths = [float(np.linalg.norm(self.plan.nodes[b] - self.plan.nodes[a])) for a, b in pairwise(member.nodes)]
        shares = (np.array([0.0, *lengths]) + np.array([*lengths, 0.0])) / 2
        for number, share, bottom, top in zip(member.nodes, shares, *faces, strict=True):
            self.nodes[number] = (bottom, top)
            if self.plan.carriers[number] != number:
                self._join(number, bottom)
                self._join(number, top)
            else:
                neighbours = [n for pair in pairwise(member.nodes) if number in pair for n in pair]
                axis = self.plan.nodes[neighbours[-1]] - self.plan.nodes[neighbours[0]]
                axes = _axes(axis / np.linalg.norm(axis), member.z_axis)
                springs, dampers = (_turned(_layer(each, sandwich, share), axes) for each in (sandwich, losses))
                self._between(self.plan.nodes[number], bottom, top, springs, dampers)

    def _ports(self, ports: Ports, damping: Array) -> None:
        """Matrices on nodes, as they are: exudyn has no item that would know them. A sandwich moves as the mean of its faces."""
        for number in ports.nodes:
            self._node(number)
        owners = [self.nodes[number] for number in ports.nodes]
        rows = np.repeat(np.arange(len(owners)), [len(own) for own in owners])
        mean = np.kron(np.array([(rows == k) / len(own) for k, own in enumerate(owners)]), np.eye(6))
        K, M, C = (mean.T @ matrix @ mean for matrix in (ports.stiffness, ports.mass, damping))
        nodes = [node for own in owners for node in own]
        item = self.items.ObjectGenericODE2(nodeNumbers=nodes, massMatrix=M, stiffnessMatrix=K, dampingMatrix=C)
        self.system.AddObject(item)

    def _between(self, middle: Array, a: Node, b: Node, stiffness: Array = NOTHING, damping: Array = NOTHING) -> None:
        """Springs and dampers at `middle` between massless arms that reach there from two nodes; nothing is stressed at rest."""
        massless = Inertia(parameters=np.zeros(10))
        markers = [self._marker(self._body(node, massless), middle - self.points[node]) for node in (a, b)]
        item = self.items.ObjectConnectorRigidBodySpringDamper(markerNumbers=markers, stiffness=stiffness, damping=damping)
        self.system.AddObject(item)


def _layer(layer: Sandwich | None, sandwich: Sandwich, length: float) -> Array:
    """Diagonal of the springs, or dampers, of `length` [m] of a layer between its faces, in the section's axes."""
    if layer is None:
        return np.zeros(6)
    shear, normal = layer.slip * length, THICKNESS_OVER_SHEAR * layer.slip * length
    across = sandwich.faces.rotary_z / sandwich.faces.mass
    return np.array([shear, shear, normal, normal * across, 0.0, shear * across])


def _strains(s: Section) -> Array:
    """Stiffness (6,) of a section against its strains: stretch, shear along y and z, twist, bending about y and z."""
    return np.array([s.axial, s.shear_y, s.shear_z, s.torsion, s.bending_y, s.bending_z])


def _turned(diagonal: Array, axes: Array) -> Array:
    """A diagonal (6,) of the section's axes as (6, 6) in the frame's."""
    twice = np.kron(np.eye(2), axes)
    return np.asarray(twice @ np.diag(diagonal) @ twice.T)


def _face(s: Sandwich) -> Section:
    """One face, with half of the layer's mass."""
    whole, shift = s.faces, s.distance / 2
    return Section(
        axial=s.stretching,
        torsion=whole.torsion / 2,
        bending_y=whole.bending_y / 2,
        bending_z=whole.bending_z / 2,
        shear_y=whole.shear_y / 2,
        shear_z=whole.shear_y / 2,
        mass=whole.mass / 2,
        rotary_y=whole.rotary_y / 2 - whole.mass / 2 * shift**2,
        rotary_z=whole.rotary_z / 2,
    )


def _axes(along: Array, z_axis: Array) -> Array:
    """Columns: the section's axes x, y and z in the frame."""
    return np.column_stack([along, np.cross(z_axis, along), z_axis])


# The share of a frame's stiffness that loses energy: the plan with every part's stiffness times its loss factor.

_STIFFNESSES = ("axial", "torsion", "bending_y", "bending_z", "shear_y", "shear_z")


def lossy(plan: Plan) -> Plan:
    """`plan` with its stiffness scaled by the loss factor of each part, so that exudyn's stiffness of it is sum of eta_p K_p."""
    eta = plan.loss_factors
    ports = tuple(replace(p, stiffness=eta.get(p.part, 0.0) * p.stiffness) for p in plan.ports)
    members = []
    for member in plan.members:
        section = member.section
        if isinstance(section, Sandwich):
            bottom, layer, top = (eta.get(part, 0.0) for part in section.parts)
            face = float(np.mean([bottom, top]))
            faces = _times(section.faces, face)
            scaled: Section | Sandwich = replace(
                section, faces=faces, stretching=face * section.stretching, slip=layer * section.slip
            )
        else:
            scaled = _times(section, eta.get(member.part, 0.0))
        members.append(replace(member, section=scaled))
    return replace(plan, members=tuple(members), ports=ports)


def viscous(plan: Plan, frequency: float) -> Plan:
    """`plan` with viscous dampings instead of stiffnesses: C = sum of eta_p K_p / omega, equal to its loss at `frequency` [Hz].

    Below it loses less, above it more: in time there is no damping that follows the displacement.
    """
    omega = 2 * np.pi * frequency
    return lossy(replace(plan, loss_factors={part: eta / omega for part, eta in plan.loss_factors.items()}))


def _times(section: Section, factor: float) -> Section:
    return replace(section, **{name: factor * getattr(section, name) for name in _STIFFNESSES})


# The same frame on a finer mesh: every element of a plan cut into equal pieces, the old nodes keeping their numbers.


def refined(plan: Plan, pieces: int) -> Plan:
    """`plan` with every element cut into `pieces`; new nodes come after the old ones.

    A new node between two that ride on the same body rides on it as well.
    """
    nodes, carriers = list(plan.nodes), list(plan.carriers)
    members = []
    for member in plan.members:
        chain = [member.nodes[0]]
        for a, b in pairwise(member.nodes):
            rigid = carriers[a] == carriers[b]
            for share in np.arange(1, pieces) / pieces:
                carriers.append(carriers[a] if rigid else len(nodes))
                chain.append(len(nodes))
                nodes.append(nodes[a] + share * (nodes[b] - nodes[a]))
            chain.append(b)
        members.append(replace(member, nodes=tuple(chain)))
    return replace(plan, nodes=np.array(nodes), carriers=tuple(carriers), members=tuple(members))
