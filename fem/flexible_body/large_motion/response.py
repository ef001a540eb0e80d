"""From an article and a base motion, however large, to the response."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import fields
from typing import Any

import numpy as np

from fem import beam
from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.response import Response
from fem.flexible_body import native
from fem.flexible_body.driven_base.drive import Drive, Progress, targets
from fem.flexible_body.driven_base.integration import integrate
from fem.flexible_body.driven_base.scene import Scene, recorded
from fem.flexible_body.driven_base.solver import Solver, described, simulation
from fem.flexible_body.large_motion import gravity as weight
from fem.flexible_body.large_motion import table as tables
from fem.flexible_body.large_motion.article import plan_of
from fem.flexible_body.large_motion.conditions import (
    LOSS_FREQUENCY,
    SOLVER,
    Conditions,
    require_followable,
    require_unconditional,
)
from fem.flexible_body.large_motion.table import Table
from fem.flexible_body.large_motion.turning import turning
from fem.flexible_body.losses import viscous
from fem.flexible_body.running import finite, running
from fem.frame import Plan, placed
from geometry.arrays import Array

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
    changes: Mapping[str, float] = beam.NO_CHANGES,
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
    elements : in a half-blade of Clumod, as `fem.beam.plan` takes them; None for one rigid body, as it is drawn
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
    conditions: Conditions = Conditions(),  # noqa: B008 - frozen
    *,
    solver: Solver = SOLVER,
    progress: Progress | None = None,
    settings: Mapping[str, object] = beam.NO_CHANGES,
) -> Response:
    """The same for the frame `plan`, about its origin; `settings` are told with the others.

    The load is that of the table on the foot about the reference point, which moves with the table: in the table's axes what load
    cells between the two measure, R^T f_lab and R^T t_lab. The table's acceleration is R^T p'' and R^T omega' (`turning`), read
    from exudyn; kinematic, without gravity. The load under gravity alone, at rest, is taken off, as cells that know changes only
    do it; `settings` tells it.

    Raises
    ------
    BadInput, CheckFailed : as `respond`.
    """
    require_followable(motion)
    require_unconditional(solver)
    steps = solver.subdivision or 1
    with running(TASK) as exudyn:
        scene, table = _assembled(exudyn, placed(plan, -motion.reference_point), motion, conditions)
        if conditions.gravity:
            weight.settle(scene)
        path = targets(motion, steps, velocity=False)
        steering = Drive(scene, table.axes, path, motion.sampling_rate * steps, progress)
        stopped = integrate(scene, _simulation(exudyn, motion, solver, steps), steering)
        if stopped is None:
            told = {**described(solver, motion.sampling_rate, steps), **settings, **_said(conditions), "route": ROUTE}
            return _response(scene, table, motion, conditions, told)
    raise stopped


def _assembled(exudyn: Any, plan: Plan, motion: BaseMotion, conditions: Conditions) -> tuple[Scene, Table]:
    """`plan`, whose origin is the reference point, on its table, with sensors."""
    damping = None if conditions.loss_frequency is None else viscous(plan, conditions.loss_frequency)
    article = native.build(exudyn, plan, held=False, damping=damping)
    scene = tables.scene_of(exudyn, article)
    if conditions.gravity:
        weight.pull(scene, conditions.gravity)
    places = {name: place - motion.reference_point for name, place in conditions.places.items()}
    table = tables.under(scene, article, places, velocity=False)
    scene.system.Assemble()
    return scene, table


def _simulation(exudyn: Any, motion: BaseMotion, solver: Solver, steps: int) -> Any:
    """Newton's iteration ends by its increments, for the residual of a stiff beam is the rounding of its large internal forces.

    Increments tell nothing of the joints' forces, so every step has a Jacobian of its own: with that of a table turned otherwise
    the moments are 18 % off after a radian while the coordinates are right to the last digit.
    """
    rate = motion.sampling_rate
    travel = max(1.0, float(np.abs(motion.displacement).max()))
    allowed = max(solver.tolerance * float(np.abs(motion.acceleration).max()) / (rate * steps) ** 2, ROUNDING * travel)
    samples = len(motion.acceleration)
    settings = simulation(exudyn, solver, rate=rate, samples=samples, subdivision=steps, residual=allowed)
    settings.linearSolverType = exudyn.LinearSolverType.EigenSparse
    newton = settings.timeIntegration.newton
    newton.residualMode, newton.modifiedNewtonJacUpdatePerStep = 1, True
    newton.relativeTolerance = allowed  # exudyn wants both tolerances alike in this mode
    return settings


def _response(scene: Scene, table: Table, motion: BaseMotion, conditions: Conditions, settings: Mapping[str, object]) -> Response:
    turned = turning(motion)
    load = finite(tables.loads(scene, table), TASK)
    at_rest = load[0] if conditions.gravity else np.zeros(6)
    acceleration = finite(tables.accelerations(scene, table), TASK)
    places = {name: finite(recorded(scene, (sensor,)), TASK) for name, sensor in table.places.items()}
    in_table = conditions.axes == "table"
    acceleration = _each(turned.seen_from_table, acceleration) if in_table else acceleration
    return Response(
        sampling_rate=motion.sampling_rate,
        table=acceleration,
        cover=acceleration,
        load=load - at_rest if in_table else _each(turned.seen_from_laboratory, load) - at_rest,
        cells=np.zeros((len(load), 0, 3)),
        places={name: turned.seen_from_table(a) if in_table else a for name, a in places.items()},
        reference_point=motion.reference_point,
        settings={**settings, "load_at_rest": at_rest.tolist()},
    )


def _each(turned: Callable[[Array], Array], six: Array) -> Array:
    """Forces and moments, or both kinds of acceleration (n, 6), each in other axes."""
    return np.hstack([turned(six[:, :3]), turned(six[:, 3:])])


def _said(conditions: Conditions) -> dict[str, object]:
    values = {f.name: getattr(conditions, f.name) for f in fields(conditions)}
    return {**values, "places": {name: place.tolist() for name, place in conditions.places.items()}}
