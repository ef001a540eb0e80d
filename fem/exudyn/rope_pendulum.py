"""`swing`: the pendulum let go, integrated by exudyn; `Swing`: what it did.

Exudyn's generalised-alpha method, constraints on position level (index 3), spectral radius 0.9. The period comes out too long by
``(omega h)² / 12`` of it, so `STEPS` steps a period leave 3e-6 (`tests/fem/rope_pendulum` show figure and rate).

Exudyn's Newton method leaves the geometric stiffness of distance constraints out of its tangent. It then converges only while
the step resolves the fastest sway of ropes that do not stretch, ``omega h < 1/sqrt(beta)``, about 1.9. Springs are in the
tangent: with ropes that stretch even their fastest mode, far beyond the step, leaves the period right to the same 3e-6.

It starts in the pose that the statics of the same ropes finds: at rest with the twist held and let go, or in equilibrium with the
velocities of the small twist, so large that it swings as far. In both the velocities agree with the constraints.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field
from itertools import pairwise
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.exudyn import rope_statics
from fem.exudyn.rope_statics import VERTICAL, Pose, Ropework, Suspension, at_rest, refused, require_positive, ropework
from fem.exudyn.run import TOLD, Progress, exudyn_version, failed, finite, integrated, running, to_exudyn
from geometry.errors import CheckFailed
from geometry.frames import Array, freeze
from geometry.inertia import Inertia
from geometry.toml_file import STANDARD_GRAVITY

# The rope pendulum made of exudyn's items.
#
# The body is a rigid body on Euler parameters, so that it may turn as far as it likes; joints of ropes are mass points; a link
# that does not stretch is a distance constraint, one that does a spring. Viscous damping about the vertical is a torsional damper
# between ceiling and body. Exudyn makes the equations of motion of these; `statics` only says where everything is when it starts.

Number = Any
"""Exudyn's number of a node, marker, object or sensor."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Model:
    """A rope pendulum in exudyn.

    Attributes
    ----------
    container : owns `system`, which dies with it
    system : exudyn's `MainSystem`, assembled
    place, rotation : sensors of the body's CoG and rotation matrix
    joints : sensors of the places of the ropes' joints, rope by rope
    lowest : sensors of the force in the lowest link of every rope
    """

    container: Any
    system: Any
    place: Number
    rotation: Number
    joints: tuple[Number, ...]
    lowest: tuple[Number, ...]


class _RopeBuilder:
    """`work` put into exudyn piece by piece."""

    def __init__(self, exudyn: Any, work: Ropework) -> None:
        from exudyn import itemInterface

        self.exudyn, self.work = exudyn, work
        self.items: Any = itemInterface
        self.container = exudyn.SystemContainer()
        self.system = self.container.AddSystem()

    def build(self, pose: Pose, velocity: Array, torsional: float, stretching: float) -> Model:
        """The model, starting at `pose` with `velocity` (k,) of the coordinates of `rope_statics`.

        `torsional` [N m s/rad] damps the twist, `stretching` [N s/m] every link that stretches.
        """
        ceiling = self.system.AddObject(self.items.ObjectGround())
        body = self._body(pose, velocity[:6])
        joints = [
            [self._point(place, speed) for place, speed in zip(places, speeds, strict=True)]
            for places, speeds in zip(pose.joints, velocity[6:].reshape(pose.joints.shape), strict=True)
        ]
        lowest = [self._rope(i, ceiling, joints[i], body, stretching) for i in range(self.work.ropes)]
        if torsional:
            ends = [self._marker("MarkerBodyRigid", bodyNumber=one) for one in (ceiling, body)]
            self.system.AddObject(self.items.ObjectConnectorTorsionalSpringDamper(markerNumbers=ends, damping=torsional))
        kinds = self.exudyn.OutputVariableType
        model = Model(
            container=self.container,
            system=self.system,
            place=self._sensor("SensorBody", kinds.Position, bodyNumber=body),
            rotation=self._sensor("SensorBody", kinds.RotationMatrix, bodyNumber=body),
            joints=tuple(self._sensor("SensorNode", kinds.Position, nodeNumber=n) for rope in joints for n in rope),
            lowest=tuple(self._sensor("SensorObject", kinds.Force, objectNumber=link) for link in lowest),
        )
        self.system.Assemble()
        return model

    def _body(self, pose: Pose, velocity: Array) -> Number:
        from exudyn import rigidBodyUtilities

        rotations: Any = rigidBodyUtilities
        parameters = np.array(rotations.RotationMatrix2EulerParameters(pose.rotation))
        rates = rotations.AngularVelocity2EulerParameters_t(pose.rotation.T @ velocity[3:], parameters)
        node = self.system.AddNode(
            self.items.NodeRigidBodyEP(
                referenceCoordinates=[*pose.place, *parameters], initialVelocities=[*velocity[:3], *np.ravel(rates)]
            )
        )
        made = to_exudyn(self.work.body)
        item = self.items.ObjectRigidBody(mass=made.Mass(), inertia=made.GetInertia6D(), nodeNumber=node)
        body = self.system.AddObject(item)
        self._weighs(self._marker("MarkerBodyMass", bodyNumber=body))
        return body

    def _point(self, place: Array, speed: Array) -> Number:
        node = self.system.AddNode(self.items.NodePoint(referenceCoordinates=place.tolist(), initialVelocities=speed.tolist()))
        point = self.system.AddObject(self.items.ObjectMassPoint(mass=self.work.point_mass, nodeNumber=node))
        self._weighs(self._marker("MarkerBodyMass", bodyNumber=point))
        return node

    def _weighs(self, marker: Number) -> None:
        down = [0.0, 0.0, -self.work.gravity]
        self.system.AddLoad(self.items.LoadMassProportional(markerNumber=marker, loadVector=down))

    def _rope(self, i: int, ceiling: Number, joints: list[Number], body: Number, stretching: float) -> Number:
        """The links of rope `i`; the lowest is returned."""
        top = self._marker("MarkerBodyPosition", bodyNumber=ceiling, localPosition=self.work.anchors[i].tolist())
        foot = self._marker("MarkerBodyPosition", bodyNumber=body, localPosition=self.work.feet[i].tolist())
        ends = [top, *(self._marker("MarkerNodePosition", nodeNumber=node) for node in joints), foot]
        return [self._link(i, [a, b], stretching) for a, b in pairwise(ends)][-1]

    def _link(self, i: int, ends: list[Number], stretching: float) -> Number:
        length, compliance = float(self.work.link_lengths[i]), float(self.work.compliance[i])
        if not compliance:
            return self.system.AddObject(self.items.ObjectConnectorDistance(markerNumbers=ends, distance=length))
        spring = {"referenceLength": length, "stiffness": 1 / compliance, "damping": stretching}
        return self.system.AddObject(self.items.ObjectConnectorSpringDamper(markerNumbers=ends, **spring))

    def _marker(self, kind: str, **what: Any) -> Number:
        return self.system.AddMarker(getattr(self.items, kind)(**what))

    def _sensor(self, kind: str, output: Any, **what: Any) -> Number:
        keep = {"storeInternal": True, "writeToFile": False}
        return self.system.AddSensor(getattr(self.items, kind)(outputVariableType=output, **keep, **what))


# Small swings about the equilibrium: the period that an amplitude of nothing would have, and the fastest motion of the ropes.
#
# Mass and stiffness are those of `statics` at rest: links that stretch add G^T G / c, links that do not take their direction
# away from the motions. No exudyn in it: it says beforehand what step a simulation needs, and afterwards whether it was right.

NEUTRAL = 1e-9
"""Eigenvalue over the largest of the slow ones below which the body does not come back."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Swings:
    """Small undamped swings.

    Attributes
    ----------
    omega : (m,) [rad/s], ascending
    shapes : (k, m) of the coordinates of `statics`
    twist : which of them is the twist
    inertia : [kg m²] modal mass of the twist for one radian about the vertical
    """

    omega: Array
    shapes: Array
    twist: int
    inertia: float

    @property
    def period(self) -> float:
        """[s] of the small twist."""
        return float(2 * np.pi / self.omega[self.twist])

    @property
    def shape(self) -> Array:
        """(k,) the twist, one radian about the vertical."""
        column = self.shapes[:, self.twist]
        return np.asarray(column / column[VERTICAL])


def swings(work: Ropework, pose: Pose) -> Swings:
    """All small swings of `work` about its equilibrium `pose`.

    Raises
    ------
    BadInput : the body does not come back from some motion: it would tip over.
    """
    from scipy.linalg import eigh, null_space

    H, G = rope_statics.stiffness(work, pose)
    M = work.point_mass * np.eye(work.size)
    M[:3, :3] = work.body.mass * np.eye(3)
    M[3:6, 3:6] = pose.rotation @ work.body.tensor @ pose.rotation.T
    c = np.repeat(work.compliance, work.links)
    if c.any():
        Z, K = np.eye(work.size), H + G.T @ (G / c[:, None])
    else:
        Z, K = null_space(G), H
    values, vectors = eigh(Z.T @ K @ Z, Z.T @ M @ Z)
    if values[0] <= NEUTRAL * work.gravity / float(work.link_lengths.max() * work.links):
        remedy = "Tie the ropes higher above the CoG"
        raise refused("height", "the body would tip over: it does not come back from a tilt", remedy)
    shapes = Z @ vectors
    shares = shapes[VERTICAL] ** 2 * M[VERTICAL, VERTICAL]  # of the twist in the energy of each mode, which is one half
    twist = int(np.argmax(shares))
    return Swings(omega=np.sqrt(values), shapes=shapes, twist=twist, inertia=float(1 / shapes[VERTICAL, twist] ** 2))


# The run watched step by step: told on, stopped from outside, or failed with the time, the step and the last state.
#
# Before every step exudyn calls back. What is raised there is kept and raised again once exudyn has stopped: exudyn itself would
# make an error of its own of it.


class Watch:
    """One run of `steps` steps of `step` [s]; knows how far it has come."""

    def __init__(self, *, steps: int, step: float, progress: Progress | None) -> None:
        self.steps = steps
        self.step = step
        self.progress = progress
        self.now = 0
        self.stopped: BaseException | None = None

    def run(self, system: Any, settings: Any, task: str) -> None:
        """Integrate `system`.

        Raises
        ------
        CheckFailed : exudyn gave up; with the time [s], the step and the last coordinates.
        BaseException : what stopped the run from within `progress`, or KeyboardInterrupt by Ctrl-C.
        """
        said = "the solver gave up"
        try:
            done = integrated(system, settings, self)
        except Exception as error:  # exudyn raises errors of several kinds
            done, said = False, " ".join(str(error).split())
        if self.stopped is not None:
            raise self.stopped
        if not done:
            raise self._astray(system, task, said)

    def __call__(self, system: Any, time: float) -> bool:
        """Before the step that ends at `time` [s]; False ends the run."""
        try:
            self.now = round(time / self.step)
            if self.progress is not None and self.now % max(1, self.steps // TOLD) == 0:
                self.progress(self.now / self.steps)
        except BaseException as reason:
            self.stopped = reason
        return self.stopped is None

    def _astray(self, system: Any, task: str, said: str) -> CheckFailed:
        state = np.array(system.systemData.GetODE2Coordinates()).tolist()
        where = f"{said} at {self.now * self.step:.6g} s, step {self.now} of {self.steps} of {self.step:.3g} s"
        error = failed(task, where)
        error.evidence |= {"time": self.now * self.step, "step": self.now, "state": state}
        return error


STEPS = 1000
"""Steps a period where nothing else is said."""

LEAST_STEPS = 200
"""Steps a period below which the method's own error, 8e-5 of the period, would pass for an effect of the ropes."""

RESOLVED = 1.5
"""Largest ``omega h`` of the fastest sway of ropes that do not stretch."""

MOST = 20_000_000
"""Steps times coordinates of a run: a quarter of an hour at most, on few links far less."""

RADIUS = 0.9
"""Spectral radius of the generalised-alpha method at infinite frequency."""

TASK = "swing the body on its ropes"


@dataclass(frozen=True, eq=False, kw_only=True)
class Swing:
    """One swing, equally sampled; the fixed frame has z upwards and its origin where the CoG is on ropes that do not stretch.

    Attributes
    ----------
    time : (n,) [s]
    yaw : (n,) [rad] rotation about the vertical, without jumps; of a body that also tilts, what is left when the tilt about a
        level axis is taken off
    place : (n, 3) [m] CoG of the article
    rotation : (n, 3, 3) from the axes as it hangs to the fixed frame
    chains : (n, ropes, links + 1, 3) [m] every rope, from the ceiling to its foot
    tension : (n, ropes) [N] in the lowest link
    small_period : [s] of the small undamped twist, from the statics of the same ropes and not from exudyn
    settings : how it was found; JSON values
    warnings : sentences
    """

    time: Array
    yaw: Array
    place: Array
    rotation: Array
    chains: Array
    tension: Array
    small_period: float
    settings: Mapping[str, object] = field(default_factory=lambda: MappingProxyType({}))
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        n, ropes, ends = np.shape(self.chains)[:3]
        freeze(self, time=(n,), yaw=(n,), place=(n, 3), rotation=(n, 3, 3), chains=(n, ropes, ends, 3), tension=(n, ropes))
        object.__setattr__(self, "settings", MappingProxyType(dict(self.settings)))


def swing(
    inertia: Inertia,
    suspension: Suspension,
    *,
    duration: float,
    step: float | None = None,
    rate: float | None = None,
    gravity: float = STANDARD_GRAVITY,
    progress: Progress | None = None,
) -> Swing:
    """The body `inertia` (axes as it hangs, see `hung`; only mass and tensor about the CoG count) swinging for `duration` [s].

    `rate` [Hz] is that of the samples, every step by default; a `step` [s] is shortened until samples fall on steps.

    Raises
    ------
    BadInput : a size that cannot be, a rope that would have to push, a step too coarse, or more than `MOST` to do.
    CheckFailed : no equilibrium, a rope that slacks on the way, or exudyn failed; with the time, the step and the last state.
    """
    require_positive("duration", duration, "s")
    work = ropework(inertia, suspension, gravity)
    rest = at_rest(work)
    small = swings(work, rest)
    # The step [s] and how many of them there are from sample to sample
    # The longest that gives a period of the body and not of the method
    slow = small.period / LEAST_STEPS
    needed = slow if work.compliance.any() else min(slow, RESOLVED / float(small.omega[-1]))
    wanted = min(small.period / STEPS, needed) if step is None else step
    require_positive("step", wanted, "s")
    if wanted > needed * (1 + 1e-9):
        fastest = 2 * np.pi / float(small.omega[-1])
        problem = (
            f"{wanted:.4g} s is too coarse for a twist of {small.period:.4g} s on ropes whose fastest sway takes {fastest:.3g} s"
        )
        raise refused("step", problem, f"Use {needed:.3g} s or less")
    if rate is None:
        h, every = wanted, 1
    else:
        require_positive("rate", rate, "Hz")
        every = int(np.ceil(1 / (rate * wanted) - 1e-9))
        h = 1 / (rate * every)
    much = duration / h * work.size / MOST
    if much > 1:  # blame what was asked for steps so short, or links, or time
        asked = "step" if step is not None else "rate" if every == 1 and rate is not None else ""
        longer = 1.1 * h * much  # of two digits, and still enough
        name = asked if asked and longer < needed else "links" if work.links > 1 else "duration"
        remedy = {"step": f"Use {longer:.2g} s or more", "rate": f"Record at {1 / longer:.2g} Hz or less"}
        problem = f"{duration / h:.3g} steps of {work.size} coordinates each are {much:.3g} times as many as are simulated"
        shorter = f"Swing {1.1 * much:.2g} times shorter"
        if work.links > 1:
            shorter = "Use fewer, 1 for a straight rope, or swing for less time"
        raise refused(name, problem, remedy.get(name, shorter))
    steps = every * int(np.ceil(duration / (h * every) - 1e-9))
    held = at_rest(work, suspension.amplitude)
    if suspension.start == "twist":
        start, velocity = held, np.zeros(work.size)
    else:
        rise = rope_statics.energy(work, held) - rope_statics.energy(work, rest)
        start, velocity = rest, small.shape * np.sqrt(2 * rise / small.inertia)
    torsional, stretching = 2 * suspension.damping_ratio * small.inertia * float(small.omega[small.twist]), 0.0
    if work.compliance.any():  # damping [N s/m] of one link that gives the heave of the body on all ropes its ratio
        rope = 1 / (work.compliance.mean() * work.links)
        whole = 2 * suspension.stretch_damping * np.sqrt(work.ropes * rope * work.body.mass)
        stretching = float(whole / work.ropes * work.links)
    settings: dict[str, object] = {
        "solver": "exudyn",
        "version": exudyn_version(),
        "method": "generalised alpha, index 3",
        "spectral_radius": RADIUS,
        "step_s": h,
        "steps_per_sample": every,
        "steps_per_period": small.period / h,
        "gravity_m_per_s2": gravity,
        "start": suspension.start,
    }
    with running(TASK) as exudyn:
        model = _RopeBuilder(exudyn, work).build(start, velocity, torsional, stretching)
        controls = exudyn.SimulationSettings()
        controls.solution.file.write = False
        controls.solution.sensors.writePeriod = h * every
        run = controls.timeIntegration
        run.numberOfSteps, run.endTime = steps, h * steps
        run.generalizedAlpha.spectralRadius = RADIUS
        run.newton.useModifiedNewton = True
        run.newton.relativeTolerance = 1e-11  # at 1e-8, exudyn's own, small swings came out too fast by 1e-6
        run.adaptiveStep = False  # a step that fails is said, not made a hundred times smaller in silence
        # What the rounding of places makes of the force of a stiff link cannot be iterated away.
        stiffest = max((1 / c for c in work.compliance if c), default=0.0) * float(work.link_lengths.max())
        run.newton.absoluteTolerance = 1e-14 * work.body.mass * work.gravity + 20 * np.finfo(float).eps * stiffest * work.links
        Watch(steps=steps, step=h, progress=progress).run(model.system, controls, TASK)
        return _told(model, work, small, settings)


def small_period(inertia: Inertia, suspension: Suspension, gravity: float = STANDARD_GRAVITY) -> float:
    """Period [s] of the small undamped twist, by statics alone.

    Raises
    ------
    BadInput, CheckFailed : as `swing`.
    """
    work = ropework(inertia, suspension, gravity)
    return swings(work, at_rest(work)).period


def _told(model: Model, work: Ropework, small: Swings, settings: dict[str, object]) -> Swing:
    def read(sensor: Any) -> Array:
        return finite(model.system.GetSensorStoredData(sensor), TASK)

    R = read(model.rotation)
    time, rotation = R[:, 0], R[:, 1:].reshape(-1, 3, 3)
    centre, n = read(model.place)[:, 1:], len(R)
    joints = np.array([read(sensor)[:, 1:] for sensor in model.joints]).reshape(work.ropes, work.joints, n, 3)
    feet = centre[:, None, :] + np.einsum("tij,rj->tri", rotation, work.feet)
    top = np.broadcast_to(work.anchors[None, :, None, :], (n, work.ropes, 1, 3))
    chains = np.concatenate([top, joints.transpose(2, 0, 1, 3), feet[:, :, None, :]], axis=2)
    tension = np.empty((n, work.ropes))
    for i, sensor in enumerate(model.lowest):
        # Exudyn gives the force of a constraint as a number, that of a spring as a vector
        force, link = read(sensor)[:, 1:], chains[:, i, -1] - chains[:, i, -2]
        tension[:, i] = force[:, 0] if force.shape[1] == 1 else np.sum(force * link, axis=1) / np.linalg.norm(link, axis=1)
    # Ropes cannot push, exudyn's links can
    slack = np.argwhere(tension <= 0)
    if len(slack):
        (k, i) = slack[0]
        said = f"rope {i + 1} slacks at {time[k]:.4g} s of the swing: it would have to push with {-tension[k, i]:.4g} N"
        raise CheckFailed(f"{said}. Start with less, or hang the body more evenly", time=float(time[k]), rope=int(i + 1))
    return Swing(
        time=time,
        yaw=np.unwrap(np.arctan2(rotation[:, 1, 0] - rotation[:, 0, 1], rotation[:, 0, 0] + rotation[:, 1, 1])),
        place=centre + rotation @ work.article,
        rotation=rotation,
        chains=chains,
        tension=tension,
        small_period=small.period,
        settings=settings,
    )
