"""Rows about base excitation in time: sign, one mode in closed form, the way back to the dynamic mass, and exudyn beside it.

The recursion and exudyn's integration share matrices of an article and nothing else; both are held against what is known without
them, and against each other.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import ModuleType

import numpy as np

from fem import beam
from fem.base_excitation import body, linear
from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.patterns import Sweep, drawn, sweeps
from fem.base_excitation.rig import Body, Cell, Flange, Friction, Rig, Strut
from fem.base_excitation.rig_structure import dynamic_mass
from fem.damping import Damping
from fem.flexible_body import driven_base
from fem.modes import Modes, fixed_base
from geometry.arrays import Array
from geometry.inertia import Inertia
from validation.closure import deviation, identified
from validation.verification.check import Check, Error, Found, Mesh, once

FAMILY = "Base excitation in time"

RATE = {Mesh.FAST: 8192.0, Mesh.FINE: 16384.0}
"""Steps a second."""

ROUTES: Mapping[str, ModuleType] = {"recursion": linear, "exudyn": driven_base}

BLOCK = Inertia.from_cog(
    8.0, np.array([0.03, -0.02, 0.15]), np.array([[0.08, 0.01, -0.02], [0.01, 0.1, 0.015], [-0.02, 0.015, 0.05]])
)
"""A rigid block, its CoG off every axis."""

MODE, RATIO, PART = 12.3, 0.0035, 3.0
"""Frequency [Hz], damping ratio and effective mass [kg] of one mode."""

ARTICLE, QUICK = "clumod-1", 120.0
"""And octaves a minute."""

LINES = np.linspace(4.0, 32.0, 281)
"""[Hz]"""

SLIP, LOOSE, PRELOAD = 2.0, 2.0, 30.0
"""Slip force [N] of a loose part, its mass [kg], preload of every cell [N]."""


# --- rigid ----------------------------------------------------------------------------------------------------------------


def _block(route: str, axis: str, mesh: Mesh) -> Found:
    """Zero, and the largest difference between load and M a as a share of the largest load, forces and moments apart."""
    motion = Sweep(axis=axis, rate=QUICK).motion(RATE[mesh], ring_down=0.0)
    run = ROUTES[route].respond(Rig(article=body.rigid("block", BLOCK)), motion)
    expected = motion.acceleration @ BLOCK.mass_matrix
    return Found(0.0, max(float(np.abs(run.load[:, k] - expected[:, k]).max() / np.abs(expected[:, k]).max()) for k in _HALVES))


_HALVES = (slice(0, 3), slice(3, 6))


# --- one mode -------------------------------------------------------------------------------------------------------------


def _one_mode() -> Rig:
    """A mass on a spring along x, as modal data."""
    L = np.zeros((6, 1))
    L[0] = np.sqrt(PART)
    nothing = np.zeros((6, 6))
    omega = 2 * np.pi * MODE
    modes = Modes(
        frequency=np.array([MODE]),
        damping_ratio=np.array([RATIO]),
        participation=L,
        rigid_mass=np.diag([PART + 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
        residual=nothing,
        reference_point=np.zeros(3),
        shapes=np.zeros((0, 1)),
        viscous=np.array([[2 * RATIO * omega]]),
    )
    return Rig(article=body.of_modal_data("one mode", modes))


def _at_resonance(mesh: Mesh) -> Found:
    """Peak of the load of one mode driven at its own frequency from rest for ten periods, and what the recursion finds.

    q'' + 2 zeta omega q' + omega² q = -L sin(omega t) has q = L / (2 zeta omega²) (cos(omega t) - exp(-zeta omega t)
    (cos(omega_d t) + zeta omega / omega_d sin(omega_d t))), and the load is (M - L²) a - L (omega² q + 2 zeta omega q').
    """
    omega = 2 * np.pi * MODE
    time = np.arange(round(10 / MODE * RATE[mesh])) / RATE[mesh]
    acceleration = np.zeros((len(time), 6))
    acceleration[:, 0] = np.sin(omega * time)
    still = np.zeros_like(acceleration)
    motion = BaseMotion(
        sampling_rate=RATE[mesh], displacement=still, velocity=still, acceleration=acceleration, driven=float(time[-1])
    )
    found = linear.respond(_one_mode(), motion).load[:, 0]
    return Found(float(np.abs(_closed_form(time, omega)).max()), float(np.abs(found).max()))


def _closed_form(time: Array, omega: float) -> Array:
    """Load [N] of `_one_mode` on the table."""
    damped, decay = omega * np.sqrt(1 - RATIO**2), np.exp(-RATIO * omega * time)
    c, s = np.cos(damped * time), np.sin(damped * time)
    q = np.cos(omega * time) - decay * (c + RATIO * omega / damped * s)
    rate = -omega * np.sin(omega * time) + decay * omega**2 / damped * s
    spring = PART / (2 * RATIO * omega**2) * (omega**2 * q + 2 * RATIO * omega * rate)
    return np.asarray(np.sin(omega * time) - spring)


# --- an article -----------------------------------------------------------------------------------------------------------


@once
def _article() -> tuple[Body, Modes]:
    structure = beam.structure(ARTICLE)
    modes = fixed_base(structure, 8, damping=Damping(ratio=0.05))
    return body.flexible(ARTICLE, structure, modes, places={"top": [0.0, 0.0, 1.6]}), modes


@once
def _on_cells() -> Rig:
    """The article on four load cells and a flange that gives."""
    corners = ((0.13, 0.13), (-0.13, 0.13), (-0.13, -0.13), (0.13, -0.13))
    cells = (Cell(position=np.array([x, y, 0.0]), stiffness=np.full(3, 2e8), damping=np.full(3, 2e3)) for x, y in corners)
    return Rig(
        article=_article()[0],
        cover=BLOCK,
        seat=np.array([0.0, 0.0, 0.045]),
        cells=tuple(cells),
        flange=Flange(compliance=np.array([0.0, 0.0, 0.0, 2e-6, 2e-6, 0.0]), damping_time=1e-4),
    )


@once
def _shares(mesh: Mesh) -> Array:
    """(2, 6) off and at resonance: shares by which six crossed sweeps and Eqs. 10 and 11 miss the model's own dynamic mass."""
    rig, modes, cross = _on_cells(), _article()[1], drawn(np.random.default_rng(1))
    drives = sweeps(rate=QUICK).values()
    runs = (linear.respond(rig, drive.motion(RATE[mesh], ring_down=8.0, cross=cross)) for drive in drives)
    found = deviation(identified(runs, LINES).dynamic_mass, dynamic_mass(rig, LINES), modes.frequency, modes.damping_ratio)
    return np.array([found.off, found.at])


def _closure(where: int, mesh: Mesh) -> Found:
    return Found(0.0, float(_shares(mesh)[where].max()))


def _against_recursion(axis: str, mesh: Mesh) -> Found:
    """Zero, and the largest difference of exudyn's load from that of the recursion, over the largest load."""
    motion = Sweep(axis=axis, rate=QUICK).motion(RATE[mesh], ring_down=1.0)
    ours, theirs = linear.respond(_on_cells(), motion).load, driven_base.respond(_on_cells(), motion).load
    return Found(0.0, max(float(np.abs(ours[:, k] - theirs[:, k]).max() / np.abs(ours[:, k]).max()) for k in _HALVES))


def _flange(mesh: Mesh) -> Found:
    """Zero, and how far H of an article on a flange that gives lies from H' = (I - omega² H C)^-1 H of the rigid one."""
    article, C = _article()[0], np.diag([1e-7, 1e-7, 0.0, 2e-6, 2e-6, 1e-6])
    rigid = dynamic_mass(Rig(article=article), LINES).matrix
    soft = dynamic_mass(Rig(article=article, flange=Flange(compliance=np.diag(C))), LINES).matrix
    omega2 = (2 * np.pi * LINES[:, None, None]) ** 2
    expected = np.linalg.solve(np.eye(6) - omega2 * rigid @ C, rigid)
    scale = np.sqrt(np.abs(np.einsum("njj,nkk->njk", expected, expected)))
    return Found(0.0, float(np.abs((soft - expected) / scale).max()))


# --- joints ---------------------------------------------------------------------------------------------------------------


def _slipping(mesh: Mesh) -> Found:
    """Slip force, and the largest force by which the load exceeds that of the block alone while a loose part slips on it."""
    block = body.rigid("block", BLOCK)
    motion = Sweep(axis="x", rate=QUICK).motion(RATE[mesh], ring_down=0.0)
    rig = Rig(article=block, frictions=(Friction(axis="x", slip_force=SLIP, mass=LOOSE),))
    run = driven_base.respond(rig, motion)
    alone = run.table @ BLOCK.mass_matrix
    return Found(SLIP, float(np.abs(run.load[:, 0] - alone[:, 0]).max()))


def _lifted(mesh: Mesh) -> Found:
    """Minus the preload, and the lowest force that a cell measures under a block that rocks off it."""
    rig = _on_cells()
    cells = tuple(Cell(position=c.position, stiffness=c.stiffness, damping=c.damping, preload=PRELOAD) for c in rig.cells)
    block = Rig(article=body.rigid("block", BLOCK), cover=BLOCK, cells=cells)
    run = driven_base.respond(block, Sweep(axis="x", rate=QUICK, level=4.0).motion(RATE[mesh], ring_down=0.0))
    return Found(-PRELOAD, float(run.cells[:, :, 2].min()))


def _cable(route: str, mesh: Mesh) -> Found:
    """Force of a cable to the ground that a block's slow stroke along x meets, and what the load has beside M a."""
    block = body.rigid("block", BLOCK, places={"top": [0.0, 0.0, 0.3]})
    stiffness = 1e5
    cable = Strut(place="top", to="ground", stiffness=np.array([stiffness, 0.0, 0.0]))
    motion = Sweep(axis="x", rate=QUICK).motion(RATE[mesh], ring_down=0.0)
    run = ROUTES[route].respond(Rig(article=block, struts=(cable,)), motion)
    beside = run.load[:, 0] - (motion.acceleration @ BLOCK.mass_matrix)[:, 0]
    return Found(stiffness * float(np.abs(motion.displacement[:, 0]).max()), float(np.abs(beside).max()))


def _row(
    what: str, source: str, find: Callable[[Mesh], Found], bar: float, unit: str = "", error: Error = Error.ABSOLUTE
) -> Check:
    return Check(family=FAMILY, what=what, source=source, unit=unit, bar=bar, error=error, find=find)


_EQ1 = "Eq. 1, force of the table on the body"
_MODEL = "the model's own dynamic mass in the frequency domain"

CHECKS: tuple[Check, ...] = (
    *(
        _row(f"Rigid block, {route}, driven along {axis}: load against M a", _EQ1, partial(_block, route, axis), bar)
        for route, bar in (("recursion", 1e-12), ("exudyn", 1e-3))
        for axis in ("x", "z", "beta", "gamma")
    ),
    _row(
        "One mode driven at resonance from rest, peak load",
        "closed form of the oscillator",
        _at_resonance,
        1e-7,
        "N",
        Error.RELATIVE,
    ),
    _row("Six sweeps, Eqs. 10 and 11, off resonance", _MODEL, partial(_closure, 0), 1e-4),
    _row("Six sweeps, Eqs. 10 and 11, at resonance", _MODEL, partial(_closure, 1), 5e-4),
    *(
        _row(f"Exudyn's load against the recursion's, {axis}", "two integrations", partial(_against_recursion, axis), 1e-3)
        for axis in ("x", "beta")
    ),
    _row("Flange that gives", "H' = (I - omega² H C)^-1 H", _flange, 1e-9),
    *(
        _row(f"Cable to the ground, {route}", "k u", partial(_cable, route), bar, "N", Error.RELATIVE)
        for route, bar in (("recursion", 1e-9), ("exudyn", 1e-3))
    ),
    _row("Loose part that slips on the flange, exudyn", "Coulomb", _slipping, 1e-2, "N", Error.RELATIVE),
    _row("Load cell that lifts off, exudyn", "no tension beyond the preload", _lifted, 1e-2, "N", Error.RELATIVE),
)
