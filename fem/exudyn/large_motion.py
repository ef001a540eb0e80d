"""From an article and a base motion, however large, to the response."""

from collections.abc import Mapping
from dataclasses import dataclass, field, fields, replace
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.response import Response
from fem.beam import articles
from fem.beam.elements import Sandwich
from fem.beam.frame import Body, Member, Plan, inertia, placed
from fem.exudyn import driven_run, frame
from fem.exudyn.driven_run import Drive, Number, Scene, Solver, recorded, targets, watch_node, watch_object
from fem.exudyn.frame import viscous
from fem.exudyn.run import Progress, failed, finite, kept, running
from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.frames import Array, frozen
from geometry.inertia import Inertia, judge
from geometry.routes import inertia as drawn_inertia

# What stands on the table: a built-in article of rigid bodies and beams, or as one rigid body.


def plan_of(article_name: str, changes: Mapping[str, float] = articles.NO_CHANGES, elements: int | None = None) -> Plan:
    """The built-in article or stack as a frame about its origin; as one rigid body, as it is drawn, when `elements` is None.

    Parameters
    ----------
    article_name, changes, elements : as `fem.beam.articles.article_plan` takes them

    Raises
    ------
    BadInput : an article, a dimension or a number of elements that cannot be used.
    """
    if elements is None:
        return rigid(drawn_inertia(built_in(article_name, changes)))
    return able_to_turn(articles.article_plan(article_name, changes, elements=elements))


def rigid(body: Inertia) -> Plan:
    """One rigid body on the table, its inertia in the frame of the article."""
    return Plan(nodes=np.zeros((1, 3)), carriers=(0,), bodies=(Body(node=0, inertia=body),))


def able_to_turn(plan: Plan) -> Plan:
    """`plan` without what exudyn would only know as a matrix in the laboratory's axes, which does not turn with the table.

    Where more material is taken away from a node than its rigid bodies have (the holes of a column), the elements that meet
    there give their mass to both of their nodes, half of the rod to each: the same inertia about the same point.

    Raises
    ------
    BadInput : springs between ports, which are a matrix; material taken away that even then is no body.
    """
    if plan.ports:
        problem = f"springs between ports are matrices that do not turn with the table, found {len(plan.ports)}"
        raise BadInput("large motion", "ports", problem, "Leave load cells and joints rigid")
    hollow = {node for node, body in _carried(plan).items() if not judge(body).physical}
    if not hollow:
        return plan
    # `plan` with the mass of every element that meets a `hollow` node given to its two nodes as rigid halves
    members: list[Member] = []
    bodies = list(plan.bodies)
    for member in plan.members:
        near = [bool({plan.carriers[n] for n in pair} & hollow) for pair in _elements(member)]
        if not any(near) or isinstance(member.section, Sandwich):
            members.append(member)
            continue
        weightless = replace(member.section, mass=0.0, rotary_y=0.0, rotary_z=0.0)
        for (a, b), given in zip(_elements(member), near, strict=True):
            members.append(replace(member, nodes=(a, b), section=weightless if given else member.section))
            if given:
                middle, rod = (plan.nodes[a] + plan.nodes[b]) / 2, replace(member, nodes=(0, 1))
                ends = [(node, np.array([plan.nodes[node], middle])) for node in (a, b)]
                bodies += [Body(node=node, inertia=inertia(rod, half)) for node, half in ends]
    filled = replace(plan, members=tuple(members), bodies=tuple(bodies))
    for node, body in _carried(filled).items():
        if not judge(body).physical:
            problem = f"more material is taken away at node {node} than there is, {judge(body).text}"
            raise BadInput("large motion", "bodies", problem, "Take it as one rigid body, without elements")
    return filled


def _carried(plan: Plan) -> dict[int, Inertia]:
    """Inertia of all rigid bodies on every node that carries some, about that node."""
    found: dict[int, Inertia] = {}
    for body in plan.bodies:
        node = plan.carriers[body.node]
        found[node] = body.inertia.about(plan.nodes[node]) + found.get(node, Inertia(parameters=np.zeros(10)))
    return {node: body for node, body in found.items() if body.parameters.any()}


def _elements(member: Member) -> list[tuple[int, int]]:
    return list(zip(member.nodes[:-1], member.nodes[1:], strict=True))


# `Conditions`: under what an article is driven, and what motions and methods can be used for it.

AXES = ("table", "laboratory")

LOSS_FREQUENCY = 12.0
"""[Hz] where most modes of Clumod lie."""

STEEP = 1.4
"""[rad] up to which beta may go: at a quarter turn exudyn's angles about x and z become one."""

SOLVER = Solver(method="generalised-alpha", subdivision=1)
"""Stable for the axial swinging of short beams, far above any step, and it damps that. A mode of damping ratio zeta is off by
(omega h)² / (12 zeta) at its resonance, 0.2 % for 12 Hz and 0.003 at 8 kHz."""

AT_REST = 1e-6
"""Share of its largest value with which a motion may begin: exudyn starts a table that stands still in its origin."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Conditions:
    """Under what an article is driven.

    Attributes
    ----------
    gravity : [m/s²] along -z of the laboratory
    loss_frequency : [Hz] at which viscous damping equals the parts' loss factors; None for no damping
    axes : in which loads and accelerations are told, the "table"'s own or those of the "laboratory"
    places : (3,) [m] in the article's frame, by name, whose acceleration is told

    Raises
    ------
    BadInput : a value out of its bounds.
    """

    gravity: float = 0.0
    loss_frequency: float | None = LOSS_FREQUENCY
    axes: str = "table"
    places: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        if not np.isfinite(self.gravity):
            raise _bad("gravity", f"it must be finite, found {self.gravity:g} m/s²", "Give 9.81, or 0 for none")
        if self.loss_frequency is not None and not 0 < self.loss_frequency < np.inf:
            problem = f"it must be positive, found {self.loss_frequency:g} Hz"
            raise _bad("loss_frequency", problem, "Give the frequency at which losses are known, or None for no damping")
        if self.axes not in AXES:
            raise _bad("axes", f"it must be table or laboratory, found {self.axes!r}", "Name one of them")
        places = {name: frozen(place, (3,), f"places.{name}") for name, place in self.places.items()}
        object.__setattr__(self, "places", MappingProxyType(places))


def _bad(name: str, problem: str, remedy: str) -> BadInput:
    return BadInput("large motion", name, problem, remedy)


def _refused(motion: BaseMotion, name: str, problem: str, remedy: str) -> BadInput:
    return BadInput(motion.label, name, problem, remedy)


# Gravity on every body and beam of an exudyn model, and the state in which it comes to rest.
#
# It acts along -z of the laboratory, so a table that tilts meets it along another of its own axes. A structure that stands in it
# at rest is already bent and pressed, which changes its frequencies a little: exudyn's beams know that, linear models do not.

HEAVY = ("RigidBody", "BeamGeometricallyExact3D")
"""Exudyn's types of object on which gravity acts."""

LOAD_STEPS = 4


def settle(scene: Scene) -> None:
    """Bring the assembled `scene` to rest under its loads; time integration starts from there.

    Raises
    ------
    CheckFailed : it finds no rest, as a column that buckles.
    """
    settings = scene.exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.active = False
    static = settings.staticSolver
    static.numberOfLoadSteps = LOAD_STEPS
    static.newton.residualMode = 1
    static.newton.absoluteTolerance = static.newton.relativeTolerance = ROUNDING
    with kept():
        done = scene.system.SolveStatic(settings, updateInitialValues=True)
    if not done:
        raise failed("bring the article to rest under gravity", "the solver gave up")


# The table under an exudyn model: a body without mass whose six coordinates are prescribed, joined to the model's foot.
#
# The joint's own sensors are the load cells: exudyn gives force and torque in the axes of the joint's first marker, which are
# the table's, about the joint, which is the reference point.

SIGNS = np.array([-1.0, -1.0, -1.0, -1.0, 1.0, 1.0])
"""From what exudyn's joint reports to the load of the table on the foot.

Forces are those on the first marker, the table. Torques are the multipliers of the constraints z0 . y1 = 0, z0 . x1 = 0 and
x0 . y1 = 0 between the axes of both markers (exudyn's documentation of ObjectJointGeneric): a small turn of the second about x
raises the first, turns about y and z lower the other two, so that these alone change sign.
"""

LEVEL = ("Acceleration", "AngularAcceleration")


def _massless(scene: Scene, node: Number) -> Number:
    """A body that marks places around `node`."""
    return int(scene.system.AddObject(scene.items.ObjectRigidBody(mass=0.0, inertia=[0.0] * 6, nodeNumber=node)))


def _marker(scene: Scene, body: Number, place: Array) -> Number:
    return int(scene.system.AddMarker(scene.items.MarkerBodyRigid(bodyNumber=body, localPosition=place.tolist())))


# How a table turns, without any assumption of smallness.
#
# With the angles alpha, beta, gamma of `BaseMotion` a vector of the table's axes is, in the laboratory's,
#
#     v_lab = R v,    R = R_x(alpha) R_y(beta) R_z(gamma),
#
# so that alpha turns about the x axis of the laboratory, beta about the y axis that alpha has turned, gamma about the table's
# own z axis. Only for small angles are alpha'', beta'', gamma'' the angular acceleration.


def turning(motion: BaseMotion) -> Array:
    """(n, 3, 3) R at every sample of `motion`: its columns are the table's axes in the laboratory."""
    (a, b, c), (sa, sb, sc) = np.cos(motion.displacement[:, 3:].T), np.sin(motion.displacement[:, 3:].T)
    x = np.column_stack([b * c, a * sc + sa * sb * c, sa * sc - a * sb * c])
    z = np.column_stack([sb, -sa * b, a * b])
    return np.stack([x, np.cross(z, x), z], axis=-1)


def seen_by(axes: Array, vectors: Array) -> Array:
    """What `vectors` (n, 3 k) are along other `axes` (n, 3, 3), their columns; three by three, as forces and moments are."""
    threes = vectors.reshape(len(vectors), -1, 3)
    return np.asarray(np.einsum("nji,nkj->nki", axes, threes).reshape(vectors.shape))


ROUTE = "exudyn, large motion: its own bodies and beams"
TASK = "integrate the article on its moving base"

ELEMENTS = 3
"""In a half-blade of Clumod, its mast has twice as many."""

ROUNDING = 1e-13
"""[m, rad] ten times what Newton's increments keep of the rounding in the internal forces of beams, 1.3e-14 in Clumod."""

NO_PLACES: Mapping[str, Array] = {}


def respond(
    article_name: str,
    motion: BaseMotion,
    *,
    changes: Mapping[str, float] = articles.NO_CHANGES,
    elements: int | None = ELEMENTS,
    gravity: float = 0.0,
    loss_frequency: float | None = LOSS_FREQUENCY,
    axes: str = "table",
    places: Mapping[str, Array] = NO_PLACES,
    solver: Solver = SOLVER,
    progress: Progress | None = None,
) -> Response:
    """What the built-in article or stack called `article_name` does while the table follows `motion`.

    Parameters
    ----------
    changes : as `geometry.articles.built_in` takes them
    elements : in a half-blade of Clumod, as `fem.beam.articles.article_plan` takes them; None for one rigid body, as it is drawn
    gravity, loss_frequency, axes, places : as `Conditions` has them

    Raises
    ------
    BadInput : an article, motion, condition or solver that cannot be used.
    CheckFailed : the integration failed or went astray; with the time, the step and the last state.
    """
    plan = plan_of(article_name, changes, elements)
    conditions = Conditions(gravity=gravity, loss_frequency=loss_frequency, axes=axes, places=places)
    said = {"article": article_name, "changes": dict(changes), "elements": elements}
    return respond_of_plan(plan, motion, conditions, solver=solver, progress=progress, settings=said)


def respond_of_plan(
    plan: Plan,
    motion: BaseMotion,
    conditions: Conditions = Conditions(),
    *,
    solver: Solver = SOLVER,
    progress: Progress | None = None,
    settings: Mapping[str, object] = articles.NO_CHANGES,
) -> Response:
    """The same for the frame `plan`, about its origin; `settings` are told with the others.

    The load is that of the table on the foot about the reference point, which moves with the table: in the table's axes what load
    cells between the two measure, R^T f_lab and R^T t_lab. The table's acceleration is R^T p'' and R^T omega' (`turning`), read
    from exudyn; kinematic, without gravity. The load under gravity alone, at rest, is taken off, as cells that know changes only
    do it; `settings` tells it.

    Raises
    ------
    BadInput : a motion of one sample, one that does not begin at rest in the origin, or a beta near a quarter turn; a method that
        is not stable for stiff beams, or lets their joints drift; an article or condition that cannot be used.
    CheckFailed : as `respond`.
    """
    if len(motion.displacement) < 2:
        raise _refused(motion, "displacement", "at least two samples are needed, found one", "Give a longer motion")
    for name in ("displacement", "velocity"):
        values = np.abs(getattr(motion, name))
        if np.any(values[0] > AT_REST * values.max(axis=0)):
            problem = f"it must begin at rest in the origin, found {values[0].tolist()} in the first sample"
            raise _refused(motion, name, problem, "Start it softly")
    steepest = float(np.abs(motion.displacement[:, 4]).max())
    if steepest > STEEP:
        problem = f"beta must stay within {STEEP} rad, where the angles are unique, found {steepest:.3g} rad"
        raise _refused(motion, "displacement", problem, "Lower the level, or turn about x or z")
    if solver.method != SOLVER.method:
        problem = f"beams that swing at a megahertz and joints that turn far need {SOLVER.method}, found {solver.method}"
        raise BadInput("solver", "method", problem, f"Take {SOLVER.method} and halve the step")
    steps = solver.subdivision or 1
    with running(TASK) as exudyn:
        scene, driving, accelerations, loads, sensors = _assembled(
            exudyn, placed(plan, -motion.reference_point), motion, conditions
        )
        if conditions.gravity:
            settle(scene)
        path = targets(motion, steps, velocity=False)
        steering = Drive(scene, driving, path, motion.sampling_rate * steps, progress)
        # Newton's iteration ends by its increments, for the residual of a stiff beam is the rounding of large internal forces.
        # Increments tell nothing of the joints' forces, so every step has a Jacobian of its own: with that of a table turned
        # otherwise the moments are 18 % off after a radian while the coordinates are right to the last digit.
        rate = motion.sampling_rate
        travel = max(1.0, float(np.abs(motion.displacement).max()))
        allowed = max(solver.tolerance * float(np.abs(motion.acceleration).max()) / (rate * steps) ** 2, ROUNDING * travel)
        samples = len(motion.acceleration)
        run = driven_run.simulation(exudyn, solver, rate=rate, samples=samples, subdivision=steps, residual=allowed)
        run.linearSolverType = exudyn.LinearSolverType.EigenSparse
        newton = run.timeIntegration.newton
        newton.residualMode, newton.modifiedNewtonJacUpdatePerStep = 1, True
        newton.relativeTolerance = allowed  # exudyn wants both tolerances alike in this mode
        stopped = driven_run.integrate(scene, run, steering)
        if stopped is None:
            said = {f.name: getattr(conditions, f.name) for f in fields(conditions)}
            said |= {"places": {name: place.tolist() for name, place in conditions.places.items()}, "route": ROUTE}
            told = {**driven_run.described(solver, motion.sampling_rate, steps), **settings, **said}
            R = turning(motion)
            load = finite(recorded(scene, loads) * SIGNS, TASK)
            at_rest = load[0] if conditions.gravity else np.zeros(6)
            acceleration = finite(recorded(scene, accelerations), TASK)
            places = {name: finite(recorded(scene, (sensor,)), TASK) for name, sensor in sensors.items()}
            in_table = conditions.axes == "table"
            acceleration = seen_by(R, acceleration) if in_table else acceleration
            return Response(
                sampling_rate=motion.sampling_rate,
                table=acceleration,
                cover=acceleration,
                load=load - at_rest if in_table else seen_by(R.swapaxes(1, 2), load) - at_rest,
                cells=np.zeros((len(load), 0, 3)),
                places={name: seen_by(R, a) if in_table else a for name, a in places.items()},
                reference_point=motion.reference_point,
                settings={**told, "load_at_rest": at_rest.tolist()},
            )
    raise stopped


def _assembled(
    exudyn: Any, plan: Plan, motion: BaseMotion, conditions: Conditions
) -> tuple[Scene, tuple[Number, ...], tuple[Number, ...], tuple[Number, ...], dict[str, Number]]:
    """`plan`, whose origin is the reference point, on its table: the constraints that drive that; sensors of its accelerations
    (laboratory's axes), of loads (table's) and, by name, of the accelerations of places (laboratory's)."""
    damping = None if conditions.loss_frequency is None else viscous(plan, conditions.loss_frequency)
    article = frame.build(exudyn, plan, held=False, damping=damping)
    from exudyn import itemInterface

    # The system of `article`, open for more items
    items: Any = itemInterface
    ground = article.system.AddObject(items.ObjectGround())
    origin = article.system.AddNode(items.NodePointGround())
    scene = Scene(exudyn=exudyn, items=items, container=article.container, system=article.system, ground=ground, origin=origin)
    if conditions.gravity:
        # Let `gravity` [m/s²] act on everything in `scene` that has mass
        gravity = conditions.gravity
        for number in range(scene.system.systemData.NumberOfObjects()):
            kind = scene.system.GetObject(number)["objectType"]
            if kind in HEAVY:
                marker = scene.system.AddMarker(scene.items.MarkerBodyMass(bodyNumber=number))
                scene.system.AddLoad(scene.items.LoadMassProportional(markerNumber=marker, loadVector=[0.0, 0.0, -gravity]))
    # A table in the origin, joined to the foot of `article` there; places (3,) [m] ride on the node that is nearest to them
    moving = driven_run.massless(scene)
    axes = driven_run.driven(scene, moving, velocity=False)
    foot = article.nodes[0][0]
    ends = [_marker(scene, moving.body, np.zeros(3)), _marker(scene, _massless(scene, foot), -article.points[foot])]
    joint = int(scene.system.AddObject(scene.items.ObjectJointGeneric(markerNumbers=ends)))
    places = {}
    for name, place in conditions.places.items():
        at = place - motion.reference_point
        node = int(np.argmin(np.linalg.norm(article.points - at, axis=1)))
        sensor = items.SensorBody(
            bodyNumber=_massless(scene, node),
            localPosition=(at - article.points[node]).tolist(),
            outputVariableType=exudyn.OutputVariableType.Acceleration,
            storeInternal=True,
        )
        places[name] = int(scene.system.AddSensor(sensor))
    accelerations = tuple(watch_node(scene, moving.node, output) for output in LEVEL)
    loads = tuple(watch_object(scene, joint, output) for output in ("ForceLocal", "TorqueLocal"))
    scene.system.Assemble()
    return scene, axes, accelerations, loads, places
