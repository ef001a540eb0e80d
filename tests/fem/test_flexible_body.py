"""The conversion to exudyn, and a free rigid body that exudyn accelerates as the mass matrix of Eq. 1 says."""

from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.exudyn.run import quiet, to_exudyn
from geometry.errors import BadInput
from geometry.frames import Array, rotation_about
from geometry.inertia import Inertia

COG = np.array([0.11, -0.23, 0.37])
TURN = rotation_about("x", 0.4) @ rotation_about("y", -0.8) @ rotation_about("z", 1.1)
BODY = Inertia.from_cog(3.0, COG, TURN @ np.diag([0.5, 0.7, 0.9]) @ TURN.T)
"""All ten parameters different and none zero: an exchanged index or sign cannot hide."""


def test_exudyn_and_we_agree_on_every_entry_of_the_tensor_and_the_order_of_six() -> None:
    body = to_exudyn(BODY)
    assert_allclose(body.Inertia(), BODY.tensor, rtol=1e-15)
    assert_allclose(body.InertiaCOM(), BODY.tensor_cog, rtol=0, atol=1e-15)
    assert_allclose(body.COM(), COG, rtol=1e-15)
    xx, yy, zz, xy, xz, yz = BODY.parameters[4:]
    assert_allclose(body.GetInertia6D(), [xx, yy, zz, yz, xz, xy], rtol=1e-15)


def test_exudyn_moves_and_turns_a_body_as_we_do() -> None:
    """Exudyn's own homogeneous transformation against ours."""
    HT = np.eye(4)
    HT[:3, :3], HT[:3, 3] = TURN, [0.2, 0.5, -0.4]
    expected = BODY.rotated(TURN).moved(HT[:3, 3])
    found = to_exudyn(BODY).Transformed(HT)
    assert_allclose([found.Mass(), *found.COM()], [expected.mass, *expected.first_moment / expected.mass], rtol=0, atol=1e-14)
    assert_allclose(found.Inertia(), expected.tensor, rtol=0, atol=1e-14)


@pytest.mark.parametrize("point", [(0.0, 0.0, 0.0), (0.3, -0.1, 0.6)])
def test_the_mass_matrix_that_exudyn_assembles_is_eq_1(point: tuple[float, float, float]) -> None:
    system, _, _ = free_body(BODY.about(point))
    assert_allclose(assembled_mass_matrix(system), BODY.about(point).mass_matrix, rtol=0, atol=1e-14)


@pytest.mark.parametrize("axis", range(6))
def test_a_free_body_accelerates_under_force_and_torque_as_the_mass_matrix_says(axis: int) -> None:
    """From rest for 0.1 ms: it turns by 1e-8 rad, so that f = M a holds to that order."""
    wrench, duration = np.eye(6)[axis], 1e-4
    velocity = velocity_after(duration, BODY, wrench)
    assert_allclose(BODY.mass_matrix @ velocity / duration, wrench, rtol=0, atol=1e-6)


@pytest.mark.parametrize("moments", [[0.0, 0.3, 0.3], [0.1, 0.2, 0.3]])
def test_ideal_bodies_pass_without_a_word(moments: list[float], capfd: pytest.CaptureFixture[str]) -> None:
    """Rounding may put a lamina a hair outside of the triangle inequality, of which exudyn would warn on standard output."""
    for angle in np.linspace(0, 3, 20):
        to_exudyn(Inertia.from_cog(1.0, COG, np.diag(moments)).rotated(rotation_about("x", angle)))
    assert capfd.readouterr() == ("", "")


def test_what_no_body_has_is_refused_in_words_before_exudyn_sees_it(capfd: pytest.CaptureFixture[str]) -> None:
    impossible = Inertia.from_cog(1.0, COG, np.diag([0.1, 0.2, 0.5]))
    with pytest.raises(BadInput, match=r"model\.toml: `inertia`: no body has these parameters"):
        to_exudyn(impossible, "model.toml")
    assert capfd.readouterr() == ("", "")


def test_quiet_holds_back_and_gives_back(capfd: pytest.CaptureFixture[str]) -> None:
    with quiet() as exudyn:
        exudyn.Print("held back")
    exudyn.Print("heard again")
    assert capfd.readouterr().out.strip() == "heard again"


def free_body(inertia: Inertia, wrench: Array | None = None) -> tuple[Any, int, Any]:
    """A rigid body that nothing holds, its reference point at the origin, `wrench` (6,) on it; also its node and container."""
    with quiet() as exudyn:
        from exudyn import itemInterface

        container = exudyn.SystemContainer()
        system = container.AddSystem()
        body = to_exudyn(inertia)
        node = system.AddNode(itemInterface.NodeRigidBodyRxyz(referenceCoordinates=[0.0] * 6))
        item = itemInterface.ObjectRigidBody(
            mass=body.Mass(), inertia=body.GetInertia6D(), centerOfMass=body.COM().tolist(), nodeNumber=node
        )
        marker = system.AddMarker(itemInterface.MarkerBodyRigid(bodyNumber=system.AddObject(item)))
        if wrench is not None:
            system.AddLoad(itemInterface.LoadForceVector(markerNumber=marker, loadVector=wrench[:3].tolist()))
            system.AddLoad(itemInterface.LoadTorqueVector(markerNumber=marker, loadVector=wrench[3:].tolist()))
        system.Assemble()
        return system, node, container


def assembled_mass_matrix(system: Any) -> Array:
    """The 6x6 that exudyn integrates with; at zero angles the rates of its coordinates are the angular velocity."""
    with quiet() as exudyn:
        solver, settings = exudyn.MainSolverImplicitSecondOrder(), exudyn.SimulationSettings()
        settings.solution.file.write = False
        solver.InitializeSolver(system, settings)
        solver.ComputeMassMatrix(system)
        M = np.array(solver.GetSystemMassMatrix())
        solver.FinalizeSolver(system, settings)
    return M


def velocity_after(duration: float, inertia: Inertia, wrench: Array) -> Array:
    """Velocity and angular velocity (6,) of the reference point after `duration` [s] from rest."""
    system, node, _container = free_body(inertia, wrench)
    with quiet() as exudyn:
        settings = exudyn.SimulationSettings()
        settings.solution.file.write = False
        settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = 10, duration
        system.SolveDynamic(settings)
        kinds = exudyn.OutputVariableType.Velocity, exudyn.OutputVariableType.AngularVelocity
        return np.concatenate([system.GetNodeOutput(node, kind) for kind in kinds])
