"""A solid's full matrices in exudyn: its eigen-solution and Craig-Bampton modes, the floating frame, and what a flight keeps."""

from __future__ import annotations

import re
import runpy
from dataclasses import dataclass, replace
from io import StringIO
from itertools import product
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rich.console import Console

from fem.beam import articles
from fem.dynamic_mass import direct, modal
from fem.exudyn.run import failed, finite, integrated, running
from fem.modes import fixed_base
from fem.solid.assembly import LOCAL_HEX27, SolidMesh, assemble
from fem.structure import Structure
from geometry.article import material
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, rigid_transformation
from geometry.inertia import Inertia

IN_EXUDYN = runpy.run_path(str(Path(__file__).parents[2] / "examples" / "in_exudyn.py"))
Flight, by_points, floating_frame, modes_of_solid = (
    IN_EXUDYN[name] for name in ("Flight", "by_points", "floating_frame", "modes_of_solid")
)
FloatingFrame = Any

SIZE = np.array([0.05, 0.03, 0.6])
STEEL = material("steel")
MASS = STEEL.density * np.prod(SIZE)
BOX = Inertia.from_cog(MASS, [0.02, -0.01, 0.3], MASS / 12 * np.diag(np.sum(SIZE**2) - SIZE**2))
"""The bar below, standing off the reference point, about it."""

COUNT = 12
LINES = np.array([4.0, 12.0, 32.0])


@pytest.fixture(scope="module")
def bar() -> Structure:
    return solid_bar()


@pytest.fixture(scope="module")
def body(bar: Structure) -> FloatingFrame:
    return floating_frame(bar, COUNT)


def test_its_linearised_flexible_body_has_them_and_their_effective_masses_too(bar: Structure) -> None:
    ours, exudyns = fixed_base(bar, COUNT), modes_of_solid(bar, COUNT)
    assert_allclose(exudyns.frequency, ours.frequency, rtol=1e-9)
    assert_allclose(exudyns.effective_mass, ours.effective_mass, rtol=0, atol=1e-9 * MASS)
    assert_allclose(exudyns.damping_ratio, ours.damping_ratio, rtol=1e-9)


def test_its_dynamic_mass_is_the_direct_solution_of_the_full_matrices(bar: Structure) -> None:
    """The lowest mode lies at 70 Hz; the modes left out have no loss, which is the 1e-7 of it."""
    solved, exudyns = direct(bar, LINES), modal(modes_of_solid(bar, COUNT), LINES)
    assert_allclose(exudyns.matrix, solved.matrix, rtol=0, atol=1e-7 * np.abs(solved.matrix).max())


def test_static_answers_stand_for_the_modes_that_are_left_out(bar: Structure) -> None:
    """With a single mode and residual the static answer of all is still there."""
    ours = fixed_base(bar, 40)
    whole = ours.residual + (ours.participation / (2 * np.pi * ours.frequency) ** 2) @ ours.participation.T
    one = modes_of_solid(bar, 1)
    found = one.residual + (one.participation / (2 * np.pi * one.frequency) ** 2) @ one.participation.T
    assert_allclose(found, whole, rtol=0, atol=1e-9 * np.abs(whole).max())


def test_mass_blocks_of_the_floating_frame_are_the_inertia_of_the_body(body: FloatingFrame) -> None:
    """Mass, first moment and tensor in exudyn's mass matrix about the frame, against the box in closed form."""
    M = IN_EXUDYN["linearise_body"](body.system, COUNT).mass[:6, :6]
    read = Inertia.from_mass_matrix(M)
    assert read.mass == pytest.approx(BOX.mass, rel=1e-12)
    assert_allclose(read.first_moment, BOX.first_moment, rtol=1e-12)
    assert_allclose(read.tensor, BOX.tensor, rtol=0, atol=1e-12)


def test_exudyns_own_rigid_inertia_of_the_matrices_is_the_body(bar: Structure) -> None:
    from exudyn import FEM

    solid = FEM.FEMinterface()
    solid.nodes = {"Position": bar.points}
    solid.massMatrix = bar.mass.tocsr()
    assert_allclose(IN_EXUDYN["from_exudyn"](solid.GetRigidBodyInertia()).parameters, BOX.parameters, rtol=0, atol=1e-12)


@pytest.mark.parametrize("axis", [0, 1])
def test_a_free_turn_keeps_energy_momentum_and_angular_momentum(axis: int) -> None:
    """Two turns end over end of a soft bar about its CoG, at 20 rad/s. Errors of exudyn's integration fall with the step."""
    soft, spin = solid_bar(youngs_modulus=2e8, cells=(1, 1, 3)), 20.0 * np.eye(3)[axis]
    start, coarse, fine = (turned(soft, spin, steps) for steps in (0, 400, 800))
    assert start.energy == pytest.approx(spin @ BOX.tensor_cog @ spin / 2, rel=1e-12)
    assert fine.deflection > 1e-5  # the bar stretches as it spins: it is no rigid body
    assert_allclose(fine.rotation, np.eye(3), rtol=0, atol=0.01)
    scale = np.linalg.norm(start.angular_momentum)
    errors = [
        (abs(there.energy / start.energy - 1), np.linalg.norm(there.angular_momentum - start.angular_momentum) / scale)
        for there in (coarse, fine)
    ]
    assert_allclose(errors[1], [0.0, 0.0], rtol=0, atol=1e-3)
    assert_allclose(fine.momentum, np.zeros(3), rtol=0, atol=1e-3 * BOX.mass * 20.0 * SIZE[2])
    assert np.all(np.array(errors[1]) < errors[0])


def test_beams_a_base_that_holds_half_a_point_and_too_many_modes_are_refused(bar: Structure) -> None:
    with pytest.raises(BadInput, match="every degree of freedom must move a point"):
        floating_frame(articles.structure("clumod-1"), COUNT)
    with pytest.raises(BadInput, match="a point that is held in some directions only"):
        floating_frame(replace(bar, held=bar.held[:-1]), COUNT)
    with pytest.raises(CheckFailed, match=r"exudyn .* failed when it should make a flexible body of the solid: "):
        floating_frame(bar, bar.mass.shape[0])


def test_a_solid_too_large_for_exudyns_factorisation_is_refused_before_it_starts(
    bar: Structure, monkeypatch: pytest.MonkeyPatch
) -> None:
    monkeypatch.setitem(floating_frame.__globals__, "LARGEST", 200)
    with pytest.raises(BadInput, match=r"up to 200 degrees of freedom here, found 243.*native beams"):
        floating_frame(bar, COUNT)


def test_no_mode_of_a_solid_is_refused(bar: Structure) -> None:
    with pytest.raises(BadInput, match="`count`: at least one mode is needed, found 0"):
        modes_of_solid(bar, 0)


def test_without_loss_factors_every_mode_has_the_ratio_of_all(bar: Structure) -> None:
    bare = replace(bar, loss_factors={})
    assert_allclose(modes_of_solid(bare, 3).damping_ratio, fixed_base(bare, 3).damping_ratio, rtol=1e-9)


DURATION = 4 * np.pi / 20.0


def turned(structure: Structure, spin: Array, steps: int) -> Instant:
    """The free bar, spinning about its CoG at rest, after two turns in `steps` steps; at the start without any."""
    flight = Flight(velocity=-np.cross(spin, BOX.cog), angular_velocity=spin)
    body = floating_frame(structure, 6, flight=flight)
    return fly(structure, body, DURATION, steps) if steps else now(structure, body)


def solid_bar(youngs_modulus: float = 207e9, cells: tuple[int, int, int] = (1, 1, 4)) -> Structure:
    """A steel bar of hexahedra on its lower end, its corner so placed that every first moment and product differs from zero."""
    grid = [np.linspace(0, size, 2 * n + 1) for size, n in zip(SIZE, cells, strict=True)]
    corner = np.array([0.02 - SIZE[0] / 2, -0.01 - SIZE[1] / 2, 0.0])
    points = corner + np.stack(np.meshgrid(*grid, indexing="ij"), -1).reshape(-1, 3)
    numbers = np.arange(len(points)).reshape([len(axis) for axis in grid])
    local = np.rint(2 * LOCAL_HEX27).astype(int)
    mesh = SolidMesh(
        points=points,
        cells=np.array([numbers[tuple((local + 2 * np.array(cell)).T)] for cell in product(*map(range, cells))]),
        part=np.zeros(int(np.prod(cells)), dtype=np.intp),
        parts=("bar",),
    )
    made = assemble(mesh, {"bar": replace(STEEL, youngs_modulus=youngs_modulus)})
    translations = np.arange(3 * len(points)).reshape(-1, 3)
    return Structure(
        stiffness=made.stiffness,
        mass=made.mass,
        rigid=np.vstack([rigid_transformation(point) for point in points]),
        held=translations[points[:, 2] == 0].ravel(),
        points=points,
        translations=translations,
        part_stiffness=made.part_stiffness,
        loss_factors={"bar": 0.006},
    )


# The body set free, and what must not change while it flies: momentum, angular momentum and energy.
#
# Exudyn integrates its floating-frame equations. It is not asked for energies: place, rotation and modes at the end give the
# velocity of every point of the solid, which the solid's own full matrices weigh.


@dataclass(frozen=True, eq=False, kw_only=True)
class Instant:
    """A free flexible body at one instant, in the fixed frame.

    Attributes
    ----------
    energy : kinetic and elastic [J]
    momentum : (3,) [kg m/s]
    angular_momentum : (3,) [kg m²/s] about the fixed frame's origin
    rotation : (3, 3) of the body's frame
    deflection : [m] largest distance of a point from its place in the body's frame
    """

    energy: float
    momentum: Array
    angular_momentum: Array
    rotation: Array
    deflection: float


def now(structure: Structure, body: FloatingFrame) -> Instant:
    """Where `body`, made of `structure`, is in exudyn's present state."""
    with running("tell the state of the flexible body") as exudyn:
        kinds, data = exudyn.OutputVariableType, body.system.systemData
        output = [kinds.Position, kinds.Velocity, kinds.RotationMatrix, kinds.AngularVelocity]
        place, velocity, rotation, spin = (np.array(body.system.GetNodeOutput(body.node, kind)) for kind in output)
        found = [finite(values, "integrate") for values in (data.GetODE2Coordinates(), data.GetODE2Coordinates_t())]
    shape, rate = ((body.modes @ q[body.frame_coordinates :]).reshape(-1, 3) for q in found)
    A = rotation.reshape(3, 3)
    arms = (structure.points - structure.reference_point + shape) @ A.T
    speeds = velocity + np.cross(spin, arms) + rate @ A.T
    # The mass of a solid is the same in every direction, so it weighs velocities in any axes.
    weighted = (by_points(structure, structure.mass) @ speeds.ravel()).reshape(-1, 3)
    stored = shape.ravel() @ (by_points(structure, structure.stiffness) @ shape.ravel())
    return Instant(
        energy=float(np.sum(speeds * weighted) + stored) / 2,
        momentum=weighted.sum(axis=0),
        angular_momentum=np.cross(place + arms, weighted).sum(axis=0),
        rotation=A,
        deflection=float(np.linalg.norm(shape, axis=1).max()),
    )


def fly(structure: Structure, body: FloatingFrame, duration: float, steps: int) -> Instant:
    """`body` after `duration` [s] of free flight in `steps` steps of exudyn.

    Raises
    ------
    CheckFailed : the integration failed or its result is not finite.
    """
    task = "integrate the free flexible body"
    with running(task) as exudyn:
        settings = exudyn.SimulationSettings()
        settings.solution.file.write = False
        settings.timeIntegration.numberOfSteps, settings.timeIntegration.endTime = steps, duration
        settings.timeIntegration.generalizedAlpha.spectralRadius = 1.0  # takes no energy out
        if not integrated(body.system, settings):
            raise failed(task, "the solver gave up")
    return now(structure, body)


def test_the_example_prints_both_frequencies_of_every_mode() -> None:
    printed = StringIO()
    IN_EXUDYN["main"](Console(file=printed, width=100))
    rows = [[float(f) for f in re.findall(r"\d+\.\d+", line)] for line in printed.getvalue().splitlines() if "." in line]
    assert len(rows) == 5
    assert all(ours == pytest.approx(theirs, rel=1e-5) for ours, theirs in rows)
