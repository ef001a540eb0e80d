"""From a rig and a base motion to the response, by exudyn: the rig as a system with sensors on all that is told, and its run."""

import sys
from collections.abc import Callable
from dataclasses import asdict, dataclass, field, replace
from functools import partial
from math import ceil, pi
from typing import Any, Literal, get_args

import numpy as np

from fem.base_excitation import response
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.response import Response, require_fine
from fem.base_excitation.rig import LATERAL, TABLE, Flange, FlexibleBody, Friction, LoadCell, Rig, Strut, matrices, require_usable
from fem.exudyn.run import TOLD, Progress, exudyn_version, failed, finite, integrated, running, to_exudyn
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array

# `Scene`: an exudyn system while it is put together, and the few things that every part of a rig does to it.

Number = int
"""Exudyn's number of a node, marker, object or sensor."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """An exudyn system that grows.

    Attributes
    ----------
    exudyn : the module
    items : its `itemInterface`, where every part of a model is described
    container : owns `system`, which dies with it
    system : exudyn's `MainSystem`
    ground : number of the ground object
    origin : number of a ground node, against which coordinates are measured
    names : what the nodes are, by number; exudyn's own names must differ, and there may be two of a kind
    alive : what exudyn refers to and would not keep alive by itself
    before_step : what brings the state of a part up to date before every step
    """

    exudyn: Any
    items: Any
    container: Any
    system: Any
    ground: Number
    origin: Number
    names: dict[Number, str] = field(default_factory=dict)
    alive: list[Any] = field(default_factory=list)
    before_step: list[Callable[[Any], None]] = field(default_factory=list)


def node(scene: Scene, name: str, item: Any) -> Number:
    """Add the node `item`, which is called `name` when something goes wrong with it."""
    number = int(scene.system.AddNode(item))
    scene.names[number] = name
    return number


def coordinate(scene: Scene, of: Number, number: int) -> Number:
    """A marker on one coordinate of the node `of`."""
    return int(scene.system.AddMarker(scene.items.MarkerNodeCoordinate(nodeNumber=of, coordinate=number)))


def place(scene: Scene, body: Number, position: Array) -> Number:
    """A marker at `position` (3,) [m] of a rigid body or of the ground."""
    return int(scene.system.AddMarker(scene.items.MarkerBodyPosition(bodyNumber=body, localPosition=position.tolist())))


def watch_object(scene: Scene, number: Number, output: str) -> Number:
    """A sensor that records what exudyn calls `output` of an object."""
    return _watch(scene, scene.items.SensorObject, output, objectNumber=number)


def watch_node(scene: Scene, number: Number, output: str) -> Number:
    """A sensor that records what exudyn calls `output` of a node."""
    return _watch(scene, scene.items.SensorNode, output, nodeNumber=number)


def recorded(scene: Scene, sensors: tuple[Number, ...]) -> Array:
    """(n, k) what `sensors` recorded, side by side, without the time."""
    return np.hstack([np.asarray(scene.system.GetSensorStoredData(sensor))[:, 1:] for sensor in sensors])


def _watch(scene: Scene, kind: Any, output: str, **what: Number) -> Number:
    variable = getattr(scene.exudyn.OutputVariableType, output)
    return int(scene.system.AddSensor(kind(outputVariableType=variable, storeInternal=True, **what)))


def _obey(scene: Scene, number: Any, force: Callable[..., Any]) -> None:
    """Let the spring-damper `number` follow the law `force`, out of which exudyn reads a formula; it evaluates that by itself."""
    from exudyn import advancedUtilities

    formula: Any = advancedUtilities.CreateSymbolicUserFunction
    law = formula(scene.system, force, "springForceUserFunction", number)
    scene.system.SetObjectParameter(number, "springForceUserFunction", law)
    scene.alive.append(law)


# Table, cover plate and article as exudyn has them.
#
# Each has a node of six coordinates: displacement, and angles about x, y, z as `NodeRigidBodyRxyz` counts them.

BASE = 6
"""Coordinates of a rigid node."""


@dataclass(frozen=True, kw_only=True)
class Rigid:
    """A rigid body: exudyn's number of its object, and of its node."""

    body: Number
    node: Number


@dataclass(frozen=True, kw_only=True)
class ReducedArticle:
    """The article: exudyn's number of its object, of the node of its base, and of the node of its other coordinates, if any."""

    body: Number
    node: Number
    modes: Number | None

    @property
    def nodes(self) -> tuple[Number, ...]:
        """All its nodes, in the order of the reduced coordinates."""
        return (self.node,) if self.modes is None else (self.node, self.modes)


def massless(scene: Scene) -> Rigid:
    """A table: no mass, so that what moves it is the load of what stands on it and nothing else."""
    return _rigid(scene, "table", mass=0.0, centerOfMass=[0.0] * 3, inertia=[0.0] * 6)


def reduced(scene: Scene, article: FlexibleBody, seat: Array) -> ReducedArticle:
    """The article's matrices as they are, its origin at `seat` (3,) [m]."""
    matrices, size = article.reduced, article.reduced.mass.shape[0]
    base = _base(scene, seat, "base of the article")
    if size > BASE:
        flexible = size - BASE
        rest = {name: [0.0] * flexible for name in ("referenceCoordinates", "initialCoordinates", "initialCoordinates_t")}
        modes = node(scene, "article", scene.items.NodeGenericODE2(numberOfODE2Coordinates=flexible, **rest))
    else:
        modes = None
    item = scene.items.ObjectGenericODE2(
        nodeNumbers=[base] if modes is None else [base, modes],
        massMatrix=np.array(matrices.mass),
        stiffnessMatrix=np.array(matrices.stiffness),
        dampingMatrix=np.array(matrices.viscous),
    )
    return ReducedArticle(body=int(scene.system.AddObject(item)), node=base, modes=modes)


def _rigid(scene: Scene, name: str, **inertia: Any) -> Rigid:
    base = _base(scene, np.zeros(3), name)
    body = scene.system.AddObject(scene.items.ObjectRigidBody(nodeNumber=base, **inertia))
    return Rigid(body=int(body), node=base)


def _base(scene: Scene, position: Array, name: str) -> Number:
    places = [*position.tolist(), 0.0, 0.0, 0.0]
    return node(scene, name, scene.items.NodeRigidBodyRxyz(referenceCoordinates=places))


# A load cell that lifts off its preload P: its faces press on each other and cannot pull.
#
#     f_z = max(k_z u_z + d_z v_z, -P)
#
# so that what the cell reads stays at -P while it is open. P is all that presses its faces together, what the article weighs on
# it included. The damper belongs to what presses: faces that come back fast push, k_z u_z + d_z v_z > -P, a little before the
# gap k_z u_z = -P is closed. Sideways it is assumed to hold as before, by the bolt that presses it together: were its shear to
# vanish with the pressure, its springs would have to know where it lands.


# Load cells: a spring and a damper along x, y and z between table and cover plate.


def cell(scene: Scene, table: Rigid, cover: Rigid, one: LoadCell) -> Number:
    """Put `one` between `table` and `cover`; the sensor of its force on the cover plate, along x, y, z."""
    ends = [place(scene, cover.body, one.position), place(scene, table.body, one.position)]
    connector = scene.items.ObjectConnectorCartesianSpringDamper
    spring = connector(markerNumbers=ends, stiffness=one.stiffness.tolist(), damping=one.damping.tolist())
    number = scene.system.AddObject(spring)  # an index of exudyn's own type, which a law of force needs
    if one.preload is not None:
        preload = one.preload

        def force(_system: Any, _time: Any, _number: Any, u: Any, v: Any, k: Any, d: Any, _offset: Any) -> Any:
            x, y, z = (k[i] * u[i] + d[i] * v[i] for i in range(3))
            return [x, y, scene.exudyn.symbolic.max(z, -preload)]

        _obey(scene, number, force)
    return watch_object(scene, number, "Force")


# What moves the table, step by step, and what may stop the run.
#
# Before every step exudyn calls back once. The six values that the table must reach in it are set, the share done is told, and
# whatever is raised there is kept and raised again once exudyn has stopped: exudyn itself would make an error of its own of it.
#
# Between two samples the motion is the polynomial of fifth degree that has displacement, velocity and acceleration of both.


class Drive:
    """The callback of one run: it moves the table and can be stopped; it knows how far the run has come."""

    def __init__(self, scene: Scene, axes: tuple[Number, ...], targets: Array, rate: float, progress: Progress | None) -> None:
        self.others = scene.before_step
        moving = np.flatnonzero(targets.any(axis=0))  # the others stay where they are: a callback costs more than a step
        self.axes, self.targets = tuple(axes[axis] for axis in moving), targets[:, moving]
        self.rate = rate
        self.progress = progress
        self.step, self.steps = 0, len(targets) - 1
        self.stopped: BaseException | None = None

    def __call__(self, system: Any, time: float) -> bool:
        """Prepare the step that ends at `time` [s]; False ends the run."""
        try:
            self._prepare(system, time)
        except BaseException as reason:
            self.stopped = reason
        return self.stopped is None

    def _prepare(self, system: Any, time: float) -> None:
        self.step = round(time * self.rate)
        for axis, value in zip(self.axes, self.targets[self.step].tolist(), strict=True):
            system.SetObjectParameter(axis, "offset", value)
        for other in self.others:
            other(system)
        due = self.step % max(1, self.steps // TOLD) == 0 or self.step == self.steps
        if self.progress is not None and due:
            self.progress(self.step / self.steps)


def driven(scene: Scene, table: Rigid, *, velocity: bool) -> tuple[Number, ...]:
    """Constraints on the six coordinates of the table: their displacements are prescribed, or their velocities."""
    constraint = scene.items.ObjectConnectorCoordinate
    axes = []
    for axis in range(BASE):
        ends = [coordinate(scene, scene.origin, 0), coordinate(scene, table.node, axis)]
        axes.append(scene.system.AddObject(constraint(markerNumbers=ends, velocityLevel=velocity)))
    return tuple(int(axis) for axis in axes)


def targets(motion: BaseMotion, subdivision: int, *, velocity: bool) -> Array:
    """(n, 6) what the table must reach at every step, from time 0 on: displacements, or velocities.

    Parameters
    ----------
    subdivision : steps a sample
    """
    if subdivision == 1:
        return motion.velocity if velocity else motion.displacement
    u, v, a, h = motion.displacement, motion.velocity, motion.acceleration, 1 / motion.sampling_rate
    n = len(u) - 1
    ends = np.stack([u[:-1], h * v[:-1], h**2 * a[:-1], u[1:], h * v[1:], h**2 * a[1:]])
    # Weights of value, slope and curvature at 0 and at 1 in the polynomial of fifth degree, or in its slope
    at_ends = np.array([_powers(x, order) for x in (0.0, 1.0) for order in range(3)])
    inner = [_powers(j / subdivision, int(velocity)) for j in range(subdivision)]
    weights = np.array([np.linalg.solve(at_ends.T, row) for row in inner])
    between = np.einsum("je,eni->nji", weights, ends).reshape(n * subdivision, BASE)
    return np.vstack([between / h, v[-1:]]) if velocity else np.vstack([between, u[-1:]])


def _powers(s: float, order: int) -> Array:
    """(6,) derivatives of 1, s, s², ... of `order` at `s`."""
    from numpy.polynomial.polynomial import polyder, polyval

    return np.array([float(polyval(s, polyder(unit, order))) for unit in np.eye(BASE)])


# The joint under the article: rigid where its compliance is zero, a spring and a damper where it is not.


def join(scene: Scene, carrier: Rigid, seat: Array, article: ReducedArticle, flange: Flange | None) -> None:
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


# A loose part on the flange: a mass that follows the article's base along two axes and is held along the third by friction only.
#
# It hangs on bristles, a spring and a damper between part and flange that cannot pull harder than the slip force F:
#
#     f = min(max(k (q - s) + d q', -F), F),
#
# q being how far the part has moved on the flange. What the bristles cannot follow is slip: after every step s becomes the
# q - (f - d q') / k of its end, which is the backward Euler method of an elastic, perfectly plastic spring (Simo & Hughes,
# Computational Inelasticity, 1998, section 1.4). Sticking, the part would swing at `STICKING` [Hz], far above anything that is
# driven, and adds its mass at the article's origin but for a share (f / STICKING)².

STICKING = 1000.0
"""[Hz] at which the part would swing on its bristles."""

STIFFNESS = (2 * np.pi * STICKING) ** 2
"""[N/m per kg] of the bristles."""

STICKING_RATIO = 0.3
"""Damping ratio of that swing."""


AT_LIMIT = 1 - 1e-9
"""Share of the slip force from which a part counts as slipping."""


def lay(scene: Scene, friction: Friction, article: ReducedArticle, seat: Array) -> "Bristles":
    """Put the loose part of `friction` on the base of `article`, which stands at `seat` (3,) [m]."""
    items, system = scene.items, scene.system
    part = node(scene, "loose part", items.NodePoint(referenceCoordinates=seat.tolist()))
    system.AddObject(items.ObjectMassPoint(mass=friction.mass, nodeNumber=part))
    loose = LATERAL.index(friction.axis)
    for axis in {0, 1, 2} - {loose}:
        system.AddObject(items.ObjectConnectorCoordinate(markerNumbers=_ends(scene, article, part, axis)))
    k, d = friction.mass * STIFFNESS, 2 * STICKING_RATIO * friction.mass * np.sqrt(STIFFNESS)
    spring = items.ObjectConnectorCoordinateSpringDamper
    connector = system.AddObject(spring(markerNumbers=_ends(scene, article, part, loose), stiffness=k, damping=d))
    symbolic, slip_force = scene.exudyn.symbolic, friction.slip_force

    def force(_system: Any, _time: Any, _number: Any, q: Any, speed: Any, k: Any, d: Any, stood: Any) -> Any:
        return symbolic.min(symbolic.max(k * (q - stood) + d * speed, -slip_force), slip_force)

    _obey(scene, connector, force)
    laid = Bristles(scene, connector, k, d, slip_force)
    scene.before_step.append(laid)
    return laid


class Bristles:
    """Where the bristles of a loose part stand, before every step; they know how often they slipped."""

    def __init__(self, scene: Scene, connector: Any, stiffness: float, damping: float, slip_force: float) -> None:
        kinds = scene.exudyn.OutputVariableType
        self.connector, self.stiffness, self.damping = connector, stiffness, damping
        self.slip_force, self.slipped, self.steps = slip_force, 0, 0
        self.outputs = (kinds.Displacement, kinds.Velocity, kinds.Force)

    def __call__(self, system: Any) -> None:
        """Let them stand where the force at the end of the last step leaves them."""
        moved, speed, force = (system.GetObjectOutput(self.connector, kind) for kind in self.outputs)
        system.SetObjectParameter(self.connector, "offset", moved - (force - self.damping * speed) / self.stiffness)
        self.steps += 1
        self.slipped += abs(force) >= AT_LIMIT * self.slip_force

    @property
    def share_slipping(self) -> float:
        """[1] of the steps so far."""
        return self.slipped / max(self.steps, 1)


def _ends(scene: Scene, article: ReducedArticle, part: Number, axis: int) -> list[Number]:
    return [coordinate(scene, article.node, axis), coordinate(scene, part, axis)]


# Cables to the ground and local dampers: a spring and a damper from a place of the article to the ground or to the table.


def attach(scene: Scene, strut: Strut, article: FlexibleBody, stands: ReducedArticle, seat: Array, table: Rigid) -> None:
    """Put `strut` between its place of `article`, which `stands` at `seat` (3,) [m], and the ground or the table beneath."""
    shape = article.places[strut.place]
    position = seat + position_of(shape)
    other = place(scene, scene.ground if strut.to == "ground" else table.body, position)
    connector = scene.items.ObjectConnectorCartesianSpringDamper
    # A marker on a point without mass that one linear constraint ties to all coordinates of the article
    items, system = scene.items, scene.system
    point = node(scene, f"place {strut.place}", items.NodePoint(referenceCoordinates=position.tolist()))
    system.AddObject(items.ObjectMassPoint(mass=0.0, nodeNumber=point))
    markers = [
        system.AddMarker(items.MarkerNodeCoordinates(nodeNumber=point)),
        system.AddMarker(items.MarkerObjectODE2Coordinates(objectNumber=stands.body)),
    ]
    apart = shape[:, :3] @ seat - position  # these markers count the places at rest in
    tie = items.ObjectConnectorCoordinateVector
    system.AddObject(tie(markerNumbers=markers, scalingMarker0=np.eye(3), scalingMarker1=np.array(shape), offset=apart))
    follower = int(system.AddMarker(items.MarkerNodePosition(nodeNumber=point)))
    ends = [follower, other]
    scene.system.AddObject(connector(markerNumbers=ends, stiffness=strut.stiffness.tolist(), damping=strut.damping.tolist()))


def position_of(shape: Array) -> Array:
    """(3,) [m] of a place from the article's origin: what its coordinates say of a turn of the base, -skew(p), read backwards."""
    turn = shape[:, 3:BASE]
    return np.array([turn[1, 2] - turn[2, 1], turn[2, 0] - turn[0, 2], turn[0, 1] - turn[1, 0]]) / 2


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
    from exudyn import itemInterface

    items: Any = itemInterface
    container = exudyn.SystemContainer()
    system = container.AddSystem()
    ground, origin = int(system.AddObject(items.ObjectGround())), int(system.AddNode(items.NodePointGround()))
    scene = Scene(exudyn=exudyn, items=items, container=container, system=system, ground=ground, origin=origin)
    table = massless(scene)
    axes = driven(scene, table, velocity=velocity)
    if rig.cover is None:
        cover = table
    else:
        plate = to_exudyn(rig.cover.about(np.zeros(3)), "cover plate")
        six = list(plate.GetInertia6D())
        cover = _rigid(scene, "cover plate", mass=plate.Mass(), centerOfMass=list(plate.COM()), inertia=six)
    cells = tuple(cell(scene, table, cover, one) for one in rig.cells)
    if cover is not table and not cells:  # it follows the table, with which it shares its origin
        system.AddObject(items.ObjectJointGeneric(markerNumbers=list(_frames(scene, table, np.zeros(3), cover.node))))
    article = reduced(scene, rig.article, rig.seat)
    join(scene, cover, rig.seat, article, rig.flange)
    for strut in rig.struts:
        attach(scene, strut, rig.article, article, rig.seat, table)
    bristles = tuple(lay(scene, friction, article, rig.seat) for friction in rig.frictions)
    result = Assembled(
        scene=scene,
        axes=axes,
        table=(watch_node(scene, table.node, "Coordinates_tt"),),
        cover=(watch_node(scene, cover.node, "Coordinates_tt"),),
        # Forces of the constraints: what stands on the table pulls at the ground, which is minus the load on it
        loads=tuple(watch_object(scene, axis, "Force") for axis in axes),
        cells=cells,
        article=tuple(watch_node(scene, node, "Coordinates_tt") for node in article.nodes if rig.article.places),
        coordinates=tuple(watch_node(scene, node, "Coordinates") for node in article.nodes if keep_coordinates),
        bristles=bristles,
    )
    scene.system.Assemble()
    return result


# The run itself: it ends well, is stopped, or fails with the time, the step and the last state.


def integrate(scene: Scene, settings: Any, drive: Drive) -> BaseException | None:
    """Run `scene` to the end of `settings`, its table moved by `drive`; what stopped it from within `drive`, if anything did.

    Raises
    ------
    CheckFailed : exudyn gave up.
    KeyboardInterrupt : Ctrl-C, once exudyn has stopped.
    """
    said = "the solver gave up"
    try:
        done = integrated(scene.system, settings, drive)
    except Exception as error:
        done, said = False, str(error)
    if not done and drive.stopped is None:
        data = scene.system.systemData
        q, rates = (np.asarray(values, dtype=np.float64) for values in (data.GetODE2Coordinates(), data.GetODE2Coordinates_t()))
        worst = int(np.argmax(np.where(np.isfinite(q), np.abs(q), np.inf)))
        # Name of one of exudyn's coordinates of second order
        starts = {scene.system.GetNodeODE2Index(node): node for node in range(scene.system.systemData.NumberOfNodes())}
        first = max(start for start in starts if 0 <= start <= worst)
        node = starts[first]
        coordinate = f"coordinate {worst - first + 1} of the {scene.names.get(node) or scene.system.GetNode(node)['name']}"
        time, name = drive.step / drive.rate, coordinate
        said = (
            f"exudyn {exudyn_version()} lost the rig at {time:.6g} s, in step {drive.step} of {drive.steps}: {said}. "
            f"The largest of its last state is {name}, at {q[worst]:.4g} and changing by {rates[worst]:.4g} a second. "
            "Take more steps a sample, and look for a damping or stiffness that feeds energy in."
        )
        raise CheckFailed(said, time=time, step=drive.step, coordinate=name, value=float(q[worst]), rate=float(rates[worst]))
    return drive.stopped


# `Solver`: how exudyn integrates, and what it says about it afterwards.
#
# - "fox-goodwin": Newmark's method with beta = 1/12, gamma = 1/2 (Hughes, The Finite Element Method, 1987, section 9.1), the
#   table's velocity prescribed. Frequencies are right to the fourth order of the step and the table's acceleration to the
#   second, so that a lightly damped resonance comes out like everything else. It is stable only while omega h < sqrt(6) for all
#   that can swing, which decides on the number of steps a sample.
# - "newmark": the trapezoidal rule, beta = 1/4, always stable. Frequencies come out too low by (omega h)² / 12, which a mode of
#   damping ratio zeta shows as an error of (omega h)² / (12 zeta) in its answer.
# - "generalised-alpha": the table's displacement is prescribed (constraints of index 3; Arnold & Brüls, Multibody System
#   Dynamics 18, 2007, doi:10.1007/s11044-007-9084-0). Frequencies as "newmark"; what is far too fast for the step dies out. With
#   a spectral radius of 1 nothing dies out and the load is lost in an oscillation from step to step.
#
# Measured against the exact recursion at 8192 Hz, one blade swept from 4 to 32 Hz along x and about z, greatest error of load in
# units of the greatest load: 1.4e-5 and 7e-5, 1.1e-3 and 6.5e-3, 1.2e-3 and 6.5e-3. All fall with the square of the step; with a
# radius of 1 the last one is 7e-2, and more than 1 at half the step.

Method = Literal["fox-goodwin", "newmark", "generalised-alpha"]

BETA = {"fox-goodwin": 1 / 12, "newmark": 1 / 4}
"""Newmark's beta of the methods that prescribe velocities."""

STABLE = {"fox-goodwin": float(np.sqrt(6.0))}
"""The largest omega h that a method bears, of those that do not bear any."""

EARLY = 1e-9
"""Share of a sample by which exudyn's instants of recording run ahead, so that no rounding of its clock skips one."""


@dataclass(frozen=True, kw_only=True)
class Solver:
    """Settings of exudyn's time integration.

    Attributes
    ----------
    method : see above
    spectral_radius : of generalised-alpha at infinite frequency, above 0 and up to 1: how much of what is far too fast for the
        step survives one step
    subdivision : steps a sample of the base motion, at least 1; None for as many as the method needs to be stable
    tolerance : by which the acceleration of a joint may be off when Newton's iteration ends, relative to the table's largest

    Raises
    ------
    BadInput : a value out of its bounds.
    """

    method: Method = "fox-goodwin"
    spectral_radius: float = 0.9
    subdivision: int | None = None
    tolerance: float = 1e-6

    def __post_init__(self) -> None:
        methods = get_args(Method)
        if self.method not in methods:
            raise _bad("method", f"it must be one of {', '.join(methods)}, found {self.method!r}", "Name one of them")
        if not 0 < self.spectral_radius <= 1:
            raise _bad("spectral_radius", f"it must lie above 0 and up to 1, found {self.spectral_radius:g}", "Take 0.9")
        if self.subdivision is not None and not (self.subdivision >= 1 and self.subdivision == int(self.subdivision)):
            problem = f"it must be a whole number from 1, found {self.subdivision:g}"
            raise _bad("subdivision", problem, "Take 1, or 2 for half the step")
        if not 0 < self.tolerance < 1:
            raise _bad("tolerance", f"it must lie between 0 and 1, found {self.tolerance:g}", "Take 1e-6")

    @property
    def prescribes_velocity(self) -> bool:
        """Whether the table's velocity is prescribed (constraints of index 2) and not its displacement (index 3)."""
        return self.method in BETA


def simulation(exudyn: Any, solver: Solver, *, rate: float, samples: int, subdivision: int, residual: float) -> Any:
    """Exudyn's settings for `samples` samples at `rate` [Hz], the first at time 0, and `subdivision` steps from one to the next.

    `residual` is what Newton's iteration may leave.
    """
    settings = exudyn.SimulationSettings()
    time, alpha = settings.timeIntegration, settings.timeIntegration.generalizedAlpha
    time.numberOfSteps, time.endTime = (samples - 1) * subdivision, (samples - 1) / rate
    time.adaptiveStep = False  # a step cut short would not meet the samples of the motion
    time.newton.relativeTolerance, time.newton.absoluteTolerance = np.finfo(float).eps, residual
    time.newton.useModifiedNewton = True
    alpha.spectralRadius = solver.spectral_radius
    alpha.useIndex2Constraints = alpha.useNewmark = solver.prescribes_velocity
    alpha.newmarkBeta, alpha.newmarkGamma = BETA.get(solver.method, 1 / 4), 1 / 2
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = (1 - EARLY) / rate
    return settings


def described(solver: Solver, rate: float, subdivision: int) -> dict[str, object]:
    """What a result says about how it was found; JSON values."""
    step = 1 / (rate * subdivision)
    return {
        "route": "exudyn",
        "exudyn": exudyn_version(),
        **asdict(solver),
        "subdivision": subdivision,
        "step_s": step,
        "sampling_rate_hz": rate,
    }


def _bad(field: str, problem: str, remedy: str) -> BadInput:
    return BadInput("solver", field, problem, remedy)


# How long a step may be, and how well the equations of one can be solved.
#
# A step must be short enough for the modes of the article that are kept as such: `fem.base_excitation.response.require_fine` says
# how many a period of the highest of them. Coordinates that carry static answers, load cells and joints may swing far faster;
# they need not be followed, but a method that is not always stable must bear them.

MARGIN = 0.9
"""Share of the stability limit that is used."""

MOST = 32
"""Steps a sample beyond which another method is the better advice."""

EPS = sys.float_info.epsilon

ROUNDINGS = 8
"""Roundings of a place that add up in a spring's force."""

RESONANT = 1e4
"""Times the load of a rigid article that the forces within one may be when it resonates, and their roundings with them."""


def subdivision(rig: Rig, rate: float, solver: Solver) -> int:
    """Steps a sample, of a base motion at `rate` [Hz].

    Raises
    ------
    BadInput : too coarse for a kept mode, or for the solver's method to be stable; the message names what is needed.
    """
    frequency = highest(rig)
    limit = STABLE.get(solver.method)
    least = 1 if limit is None else max(1, ceil(2 * pi * frequency / (MARGIN * limit * rate)))
    steps = least if solver.subdivision is None else solver.subdivision
    if steps < least or least > MOST:
        found = f"found {steps}" if steps < least else f"more than {MOST} of them"
        problem = f"{highest(rig):.4g} Hz, the rig's highest frequency, needs {least} steps a sample, {found}"
        raise BadInput("solver", "subdivision", problem, "Leave it out, soften the stiffest joint, or use generalised-alpha")
    require_fine(rig.article, rate * steps)
    return steps


def highest(rig: Rig) -> float:
    """[Hz] the highest frequency of all that stands on the held table, gaps closed and loose parts sticking; 0 when rigid."""
    from scipy.linalg import eigvalsh

    cells = tuple(replace(cell, preload=None) for cell in rig.cells)
    structure = matrices(replace(rig, frictions=(), cells=cells))
    M, K = structure.mass, structure.stiffness
    for friction in rig.frictions:
        # One coordinate more: how far the part moves along its axis on the article's base
        size, base = len(M), structure.article[:3]
        rows = np.zeros((3, size + 1))
        rows[:, : base.shape[1]] = base
        rows[LATERAL.index(friction.axis), size] = 1.0
        M, K = (np.pad(matrix, (0, 1)) for matrix in (M, K))
        K[size, size] = friction.mass * STIFFNESS
        M = M + friction.mass * rows.T @ rows
    free = slice(TABLE, None)
    return float(np.sqrt(eigvalsh(K[free, free], M[free, free]).max(initial=0.0)) / (2 * pi))


def residual(rig: Rig, motion: BaseMotion, step: float, solver: Solver) -> float:
    """What Newton's iteration may leave: a length [m] or a velocity [m/s] in joints and a force [N] elsewhere.

    In a joint, what is left over becomes an acceleration when it is divided by the step or its square, and is held to the
    tolerance. Springs between places set a floor: their force knows a place no better than a number of this size is rounded.
    """
    peak, travel = (float(np.abs(values).max(initial=0.0)) for values in (motion.acceleration, motion.displacement))
    mass = float(np.abs(rig.article.reduced.mass[:TABLE, :TABLE]).max()) + (0.0 if rig.cover is None else rig.cover.mass)
    # [N] the largest stiffness between two places, times how far they lie from F, or how far they travel [m] together
    springs = [cell.stiffness.max() * np.linalg.norm(cell.position) for cell in rig.cells]
    for strut in rig.struts:
        at = rig.seat + position_of(rig.article.places[strut.place])
        springs.append(strut.stiffness.max() * np.linalg.norm(at))
    if rig.flange is not None and rig.flange.compliance.any():
        springs.append(np.linalg.norm(rig.seat) / rig.flange.compliance[rig.flange.compliance > 0].min())
    springs += [friction.mass * STIFFNESS * travel for friction in rig.frictions]
    rounding = EPS * (ROUNDINGS * float(max(springs, default=0.0)) + RESONANT * mass * peak)
    return max(solver.tolerance * peak * step ** (1 if solver.prescribes_velocity else 2), rounding, sys.float_info.min)


TASK = "integrate the rig on its driven base"


def respond(
    rig: Rig, motion: BaseMotion, *, solver: Solver = Solver(), progress: Progress | None = None, keep_coordinates: bool = False
) -> Response:
    """What `rig` does while the table follows `motion`, integrated by exudyn.

    Everything is told in the laboratory's axes. Table, cover plate and cells move as far as they move, so the forces of the cells
    turn with the cover plate; the article itself is linear, and knows small rotations only.

    Parameters
    ----------
    solver : method, step and tolerance; see `Solver`
    progress : called with the share done; what it raises, KeyboardInterrupt for one, ends the run and leaves as it is
    keep_coordinates : with those of the article: its base's six, then its own, in the laboratory

    Raises
    ------
    BadInput : a rig, motion or solver that cannot be used.
    CheckFailed : the integration failed or went astray; with the time, the step and the last state.
    """
    require_usable(rig)
    rate = motion.sampling_rate
    steps = subdivision(rig, rate, solver)
    velocity = solver.prescribes_velocity
    allowed = residual(rig, motion, 1 / (rate * steps), solver)
    with running(TASK) as exudyn:
        built = assembled(exudyn, rig, velocity=velocity, keep_coordinates=keep_coordinates)
        steering = Drive(built.scene, built.axes, targets(motion, steps, velocity=velocity), rate * steps, progress)
        samples = len(motion.acceleration)
        settings = simulation(exudyn, solver, rate=rate, samples=samples, subdivision=steps, residual=allowed)
        stopped = integrate(built.scene, settings, steering)
        if stopped is None:
            words = described(solver, rate, steps)
            n, warning = len(motion.acceleration), response.warning(rig, motion)
            read = partial(_read, built.scene, n)
            acceleration = read(built.article)
            return Response(
                sampling_rate=motion.sampling_rate,
                table=read(built.table),
                cover=read(built.cover),
                load=-read(built.loads),
                cells=read(built.cells).reshape(n, -1, 3),
                places={name: acceleration @ shape.T for name, shape in rig.article.places.items()},
                coordinates=read(built.coordinates),
                slipping=tuple(bristles.share_slipping for bristles in built.bristles),
                reference_point=motion.reference_point,
                settings=words,
                warnings=(warning,) if warning else (),
            )
    raise stopped


def _read(scene: Scene, samples: int, sensors: tuple[Number, ...]) -> Array:
    """(samples, k) what `sensors` recorded, side by side.

    Raises
    ------
    CheckFailed : something is not finite, or another number of samples.
    """
    found = finite(recorded(scene, sensors), TASK) if sensors else np.zeros((samples, 0))
    if len(found) != samples:
        raise failed(TASK, f"it recorded {len(found)} samples of {samples}")
    return found
