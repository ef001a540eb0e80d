"""`swing`: the pendulum let go, integrated by exudyn; `Swing`: what it did.

Exudyn's generalised-alpha method, constraints on position level (index 3), spectral radius 0.9. The period comes out too long by
``(omega h)² / 12`` of it, so `STEPS` steps a period leave 3e-6 (`tests/fem/rope_pendulum` show figure and rate).

Exudyn's Newton method leaves the geometric stiffness of distance constraints out of its tangent. It then converges only while
the step resolves the fastest sway of ropes that do not stretch, ``omega h < 1/sqrt(beta)``, about 1.9. Springs are in the
tangent: with ropes that stretch even their fastest mode, far beyond the step, leaves the period right to the same 3e-6.

It starts in the pose that the statics of the same ropes finds: at rest with the twist held and let go, or in equilibrium with the
velocities of the small twist, so large that it swings as far. In both the velocities agree with the constraints.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.flexible_body.rope_pendulum.model import Model, build
from fem.flexible_body.rope_pendulum.small_swings import Swings, swings
from fem.flexible_body.rope_pendulum.statics import Pose, Ropework, at_rest, energy, ropework
from fem.flexible_body.rope_pendulum.suspension import Suspension, refused, require_positive
from fem.flexible_body.rope_pendulum.watch import Progress, Watch
from fem.flexible_body.running import exudyn_version, finite, running
from geometry.arrays import Array, frozen
from geometry.errors import CheckFailed
from geometry.inertia import Inertia

STANDARD_GRAVITY = 9.80665
"""[m/s²]"""

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
        shapes = {
            "time": (n,),
            "yaw": (n,),
            "place": (n, 3),
            "rotation": (n, 3, 3),
            "chains": (n, ropes, ends, 3),
            "tension": (n, ropes),
        }
        for name, shape in shapes.items():
            object.__setattr__(self, name, frozen(getattr(self, name), shape, name))
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
    h, every = _steps(small, step, rate, stretching=bool(work.compliance.any()))
    bearable = coarsest_step(small, stretching=bool(work.compliance.any()))
    _require_little(
        work, duration, h, bearable, "step" if step is not None else "rate" if every == 1 and rate is not None else ""
    )
    steps = every * int(np.ceil(duration / (h * every) - 1e-9))
    start, velocity = _start(work, rest, small, suspension)
    with running(TASK) as exudyn:
        model = build(exudyn, work, start, velocity, _torsional(small, suspension), _stretching(work, suspension))
        Watch(steps=steps, step=h, progress=progress).run(model.system, _solver(exudyn, work, h, steps, every), TASK)
        return _told(model, work, small, _settings(suspension, small, h, every, gravity))


def small_period(inertia: Inertia, suspension: Suspension, gravity: float = STANDARD_GRAVITY) -> float:
    """Period [s] of the small undamped twist, by statics alone.

    Raises
    ------
    BadInput, CheckFailed : as `swing`.
    """
    work = ropework(inertia, suspension, gravity)
    return swings(work, at_rest(work)).period


def coarsest_step(small: Swings, *, stretching: bool) -> float:
    """The longest step [s] with which `swing` gives a period of the body and not of the method."""
    slow = small.period / LEAST_STEPS
    return slow if stretching else min(slow, RESOLVED / float(small.omega[-1]))


def _steps(small: Swings, step: float | None, rate: float | None, *, stretching: bool) -> tuple[float, int]:
    """The step [s] and how many of them there are from sample to sample."""
    needed = coarsest_step(small, stretching=stretching)
    wanted = min(small.period / STEPS, needed) if step is None else step
    require_positive("step", wanted, "s")
    if wanted > needed * (1 + 1e-9):
        fastest = 2 * np.pi / float(small.omega[-1])
        problem = (
            f"{wanted:.4g} s is too coarse for a twist of {small.period:.4g} s on ropes whose fastest sway takes {fastest:.3g} s"
        )
        raise refused("step", problem, f"Use {needed:.3g} s or less")
    if rate is None:
        return wanted, 1
    require_positive("rate", rate, "Hz")
    every = int(np.ceil(1 / (rate * wanted) - 1e-9))
    return 1 / (rate * every), every


def _require_little(work: Ropework, duration: float, h: float, bearable: float, asked: str) -> None:
    """Refuse a run of more than `MOST` steps times coordinates, blaming what `asked` for steps so short, or links, or time."""
    much = duration / h * work.size / MOST
    if much <= 1:
        return
    longer = 1.1 * h * much  # of two digits, and still enough
    name = asked if asked and longer < bearable else "links" if work.links > 1 else "duration"
    remedy = {"step": f"Use {longer:.2g} s or more", "rate": f"Record at {1 / longer:.2g} Hz or less"}
    problem = f"{duration / h:.3g} steps of {work.size} coordinates each are {much:.3g} times as many as are simulated"
    shorter = f"Swing {1.1 * much:.2g} times shorter"
    if work.links > 1:
        shorter = "Use fewer, 1 for a straight rope, or swing for less time"
    raise refused(name, problem, remedy.get(name, shorter))


def _start(work: Ropework, rest: Pose, small: Swings, suspension: Suspension) -> tuple[Pose, Array]:
    held = at_rest(work, suspension.amplitude)
    if suspension.start == "twist":
        return held, np.zeros(work.size)
    rise = energy(work, held) - energy(work, rest)
    return rest, small.shape * np.sqrt(2 * rise / small.inertia)


def _torsional(small: Swings, suspension: Suspension) -> float:
    return 2 * suspension.damping_ratio * small.inertia * float(small.omega[small.twist])


def _stretching(work: Ropework, suspension: Suspension) -> float:
    """Damping [N s/m] of one link that gives the heave of the body on all ropes its ratio."""
    if not work.compliance.any():
        return 0.0
    rope = 1 / (work.compliance.mean() * work.links)
    whole = 2 * suspension.stretch_damping * np.sqrt(work.ropes * rope * work.body.mass)
    return float(whole / work.ropes * work.links)


def _solver(exudyn: Any, work: Ropework, h: float, steps: int, every: int) -> Any:
    """Exudyn's settings of the run."""
    settings = exudyn.SimulationSettings()
    settings.solution.file.write = False
    settings.solution.sensors.writePeriod = h * every
    run = settings.timeIntegration
    run.numberOfSteps, run.endTime = steps, h * steps
    run.generalizedAlpha.spectralRadius = RADIUS
    run.newton.useModifiedNewton = True
    run.newton.relativeTolerance = 1e-11  # at 1e-8, exudyn's own, small swings came out too fast by 1e-6
    run.adaptiveStep = False  # a step that fails is said, not made a hundred times smaller in silence
    # What the rounding of places makes of the force of a stiff link cannot be iterated away.
    stiffest = max((1 / c for c in work.compliance if c), default=0.0) * float(work.link_lengths.max())
    run.newton.absoluteTolerance = 1e-14 * work.body.mass * work.gravity + 20 * np.finfo(float).eps * stiffest * work.links
    return settings


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
    tension = np.column_stack(
        [_along(read(sensor)[:, 1:], chain) for sensor, chain in zip(model.lowest, chains.swapaxes(0, 1), strict=True)]
    )
    _require_taut(time, tension)
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


def _along(force: Array, chain: Array) -> Array:
    """Tension (n,) [N] in the lowest link of a rope: exudyn gives that of a constraint as a number, of a spring as a vector."""
    if force.shape[1] == 1:
        return force[:, 0]
    link = chain[:, -1] - chain[:, -2]
    return np.asarray(np.sum(force * link, axis=1) / np.linalg.norm(link, axis=1))


def _require_taut(time: Array, tension: Array) -> None:
    """Ropes cannot push, exudyn's links can."""
    slack = np.argwhere(tension <= 0)
    if len(slack):
        (k, i) = slack[0]
        said = f"rope {i + 1} slacks at {time[k]:.4g} s of the swing: it would have to push with {-tension[k, i]:.4g} N"
        raise CheckFailed(f"{said}. Start with less, or hang the body more evenly", time=float(time[k]), rope=int(i + 1))


def _settings(s: Suspension, small: Swings, h: float, every: int, gravity: float) -> dict[str, object]:
    return {
        "solver": "exudyn",
        "version": exudyn_version(),
        "method": "generalised alpha, index 3",
        "spectral_radius": RADIUS,
        "step_s": h,
        "steps_per_sample": every,
        "steps_per_period": small.period / h,
        "gravity_m_per_s2": gravity,
        "start": s.start,
    }
