"""Cables, dampers and a flange that gives, against closed forms on a rigid block."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import Flange, FlexibleBody, Rig, Strut
from fem.exudyn.driven_run import Solver, respond
from geometry.frames import Array, rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia

SEAT = (0.01, -0.02, 0.0445)

FREQUENCY = 8.0

DEFAULT = Solver()

AXES = range(6)


@pytest.fixture(scope="module")
def moves(shake: Callable[..., BaseMotion]) -> Callable[[int], BaseMotion]:
    """A small motion along one axis, so that a place moves straight."""
    return lambda axis: shake(0.2 * np.eye(6)[axis], frequency=FREQUENCY, seconds=0.5)


@pytest.fixture(scope="module")
def corner(block: FlexibleBody) -> Array:
    """(3, 6) what the table does to the block's corner."""
    return np.asarray(block.places["corner"] @ rigid_transformation_6(SEAT))


def pulled(block: FlexibleBody, motion: BaseMotion, strut: Strut, solver: Solver = DEFAULT) -> Array:
    """(n, 6) the load that `strut` adds."""
    rigs = (Rig(article=block, seat=SEAT, struts=struts) for struts in ((strut,), ()))
    with_it, without = (respond(rig, motion, solver=solver).load for rig in rigs)
    return np.asarray(with_it - without)


@pytest.mark.parametrize("axis", AXES)
def test_a_cable_to_the_ground_adds_its_stiffness_over_omega_squared(
    axis: int, moves: Callable[[int], BaseMotion], block: FlexibleBody, corner: Array
) -> None:
    motion, K = moves(axis), np.diag([2000.0, 3000.0, 5000.0])
    found = pulled(block, motion, Strut(place="corner", stiffness=np.diag(K)))
    expected = motion.displacement @ corner.T @ K @ corner
    assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())
    steady = slice(-round(motion.sampling_rate / FREQUENCY), None)
    over_omega = -motion.acceleration / (2 * np.pi * FREQUENCY) ** 2 @ corner.T @ K @ corner
    assert_allclose(found[steady], over_omega[steady], atol=1e-3 * np.abs(expected).max())


def test_a_cable_hangs_on_the_same_place_when_displacements_are_prescribed(
    moves: Callable[[int], BaseMotion], block: FlexibleBody, corner: Array
) -> None:
    motion, K = moves(4), np.diag([2000.0, 3000.0, 5000.0])
    found = pulled(block, motion, Strut(place="corner", stiffness=np.diag(K)), Solver(method="generalised-alpha"))
    expected = motion.displacement @ corner.T @ K @ corner
    assert_allclose(found, expected, atol=1e-3 * np.abs(expected).max())


@pytest.mark.parametrize("axis", AXES)
def test_a_damper_to_the_ground_takes_the_work_of_its_force(
    axis: int, moves: Callable[[int], BaseMotion], block: FlexibleBody, corner: Array
) -> None:
    motion, C = moves(axis), np.diag([20.0, 30.0, 50.0])
    found = pulled(block, motion, Strut(place="corner", damping=np.diag(C)))
    speeds = motion.velocity @ corner.T
    work = np.sum(found * motion.velocity) / motion.sampling_rate
    assert_allclose(work, np.sum(speeds @ C * speeds) / motion.sampling_rate, rtol=1e-3)


def test_a_strut_to_the_table_does_nothing_to_a_block_that_stands_on_it(
    moves: Callable[[int], BaseMotion], block: FlexibleBody
) -> None:
    motion = moves(4)
    load = np.abs(respond(Rig(article=block, seat=SEAT), motion).load).max()
    found = pulled(block, motion, Strut(place="corner", to="table", stiffness=[1e4] * 3, damping=[1e2] * 3))
    assert_allclose(found, 0.0, atol=2e-4 * load)


def test_struts_at_one_place_add_up(moves: Callable[[int], BaseMotion], block: FlexibleBody) -> None:
    motion, strut = moves(0), Strut(place="corner", stiffness=[2e3, 3e3, 5e3], damping=[5.0, 6.0, 7.0])
    twice = respond(Rig(article=block, seat=SEAT, struts=(strut, strut)), motion).load
    doubled = Strut(place="corner", stiffness=2 * strut.stiffness, damping=2 * strut.damping)
    once = respond(Rig(article=block, seat=SEAT, struts=(doubled,)), motion).load
    assert_allclose(twice, once, atol=1e-9 * np.abs(once).max())


def steady_amplitude(values: Array, motion: BaseMotion) -> Array:
    """(k,) complex amplitude of the last two cycles of `values` (n, k), against the table's sine."""
    samples = round(2 * motion.sampling_rate / FREQUENCY)
    phase = np.exp(-2j * np.pi * FREQUENCY * motion.time[-samples:])
    return np.asarray(2j * np.mean(values[-samples:] * phase[:, None], axis=0))


@pytest.mark.parametrize("axis", AXES)
@pytest.mark.parametrize("rigid", [False, True], ids=["gives everywhere", "gives about x and y only"])
def test_a_flange_turns_the_dynamic_mass_into_that_behind_its_compliance(
    rigid: bool, axis: int, shake: Callable[..., BaseMotion], block: FlexibleBody, inertia: Inertia
) -> None:
    """H' = (1 - omega² H C)^-1 H with C = compliance / (1 + i omega tau), in axes of the article's origin."""
    compliance = np.array([2e-6, 3e-6, 1e-6, 4e-5, 3e-5, 2e-5]) * ([0, 0, 0, 1, 1, 0] if rigid else 1)
    tau, omega = 4e-3, 2 * np.pi * FREQUENCY
    motion = shake(0.2 * np.eye(6)[axis], frequency=FREQUENCY, seconds=1.0)
    response = respond(Rig(article=block, flange=Flange(compliance=compliance, damping_time=tau)), motion)
    H = inertia.mass_matrix
    C = np.diag(compliance) / (1 + 1j * omega * tau)
    expected = np.linalg.solve(np.eye(6) - omega**2 * H @ C, H)[:, axis]
    found = steady_amplitude(response.load, motion) / 0.2
    scale = np.sqrt(np.diag(H) * H[axis, axis])
    assert np.abs(expected - H[:, axis]).max() > 5e-3 * np.abs(H[:, axis]).max()
    assert_allclose(found / scale, expected / scale, atol=1e-3 * np.abs(expected / scale).max())


def test_the_flange_sits_at_the_seat(block: FlexibleBody, inertia: Inertia, shake: Callable[..., BaseMotion]) -> None:
    """Under a block beside F the same joint stands in another place, and moments about F know it."""
    motion = shake([0.2, 0, 0, 0, 0, 0], frequency=FREQUENCY, seconds=1.0)
    flange = Flange(compliance=[0, 0, 0, 4e-5, 4e-5, 4e-5], damping_time=4e-3)
    beside, above = (respond(Rig(article=block, seat=seat, flange=flange), motion).load for seat in (SEAT, (0.0, 0.0, 0.0)))
    moved = above @ rigid_transformation_6(SEAT)
    assert_allclose(beside, moved, atol=1e-3 * np.abs(moved).max())
    assert np.abs(rigid_transformation(SEAT)[:, 3:]).max() > 0
