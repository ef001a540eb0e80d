"""Gravity on every body and beam of an exudyn model, and the state in which it comes to rest.

It acts along -z of the laboratory, so a table that tilts meets it along another of its own axes. A structure that stands in it at
rest is already bent and pressed, which changes its frequencies a little: exudyn's beams know that, linear models do not.
"""

from __future__ import annotations

from fem.flexible_body.driven_base.scene import Scene
from fem.flexible_body.interruption import kept
from fem.flexible_body.running import failed

HEAVY = ("RigidBody", "BeamGeometricallyExact3D")
"""Exudyn's types of object on which gravity acts."""

LOAD_STEPS = 4
ROUNDING = 1e-13
"""By how much [m] Newton's iteration may still move the structure when it has come to rest."""


def pull(scene: Scene, gravity: float) -> None:
    """Let `gravity` [m/s²] act on everything in `scene` that has mass."""
    for number in range(scene.system.systemData.NumberOfObjects()):
        kind = scene.system.GetObject(number)["objectType"]
        if kind in HEAVY:
            marker = scene.system.AddMarker(scene.items.MarkerBodyMass(bodyNumber=number))
            scene.system.AddLoad(scene.items.LoadMassProportional(markerNumber=marker, loadVector=[0.0, 0.0, -gravity]))


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
