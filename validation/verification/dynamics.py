"""Rows about the dynamic mass: sign and rigid limit, a cantilever on a moving clamp in closed form, and what truncation costs.

The beam rows compare whole complex matrices: the error is the largest entry of the difference over all lines, every entry divided
by the largest size that the entries on its row's and its column's diagonals reach, so that kilograms and kilogram metres squared
weigh the same.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from functools import partial
from types import ModuleType
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.base_excitation import response
from fem.base_excitation import rig as base_excitation_rig
from fem.base_excitation.patterns import BaseMotion, Sweep, drawn, sweeps
from fem.base_excitation.rig import Flange, FlexibleBody, Friction, LoadCell, Rig, Strut, dynamic_mass
from fem.beam import articles
from fem.beam.articles import structure
from fem.beam.elements import Section
from fem.damping import Damping
from fem.dynamic_mass import direct, modal
from fem.exudyn import driven_run
from fem.exudyn.rope_pendulum import STANDARD_GRAVITY, swing
from fem.exudyn.rope_statics import Suspension, on_three_ropes, on_two_ropes
from fem.modes import Modes, fixed_base
from fem.solid.model import of_mesh
from fem.structure import Structure
from geometry.articles import built_in
from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from geometry.inertia import Inertia
from geometry.routes import inertia
from validation.classical.pendulum import from_signal, rope_amplitude_factor, rope_pendulum
from validation.reference.reconstruction import deviation, identified
from validation.verification import beams, closed_forms
from validation.verification.check import Check, Error, Found, Mesh, once, order
from validation.verification.closed_forms import PART as GRIDS_PART
from validation.verification.closed_forms import block
from validation.verification.solids import steel

FAMILY = "Dynamic mass"

CUBE = 0.1
LOW = 4.0
"""Side [m] of a steel cube and frequency [Hz] at which it is as good as rigid."""

LENGTH, LOSS_FACTOR = 1.0, 0.02
"""Of the bar, in metres and 1."""

ELEMENTS = {Mesh.FAST: 40, Mesh.FINE: 80}
BENDING_LINES = np.linspace(2.0, 160.0, 80)
ROD_LINES = np.linspace(20.0, 1600.0, 80)
"""[Hz], over three resonances in bending, and over one in tension and in torsion."""

ARTICLE, MODES = "clumod-4", 30
RATIO = Damping(ratio=0.003)
ARTICLE_LINES = np.linspace(4.0, 32.0, 57)
"""[Hz]"""

FEW = 4
GROWTH = np.array([6.0, 12.0, 24.0])
"""Modes kept of the bar and frequencies [Hz] well below all others, to see how the error of truncation grows."""

# --- rigid ----------------------------------------------------------------------------------------------------------------


@once
def _cube() -> tuple[ComplexArray, Array]:
    """H of the steel cube at `LOW` (6, 6), about a corner of its foot, and its rigid mass in closed form."""
    grid = block((CUBE, CUBE, CUBE), (2, 2, 2))
    modes = fixed_base(of_mesh(grid, {GRIDS_PART: steel(0.3)}, cached=False), 20)
    mass = steel(0.3).density * CUBE**3
    tensor = mass * CUBE**2 / 6 * np.eye(3)
    return modal(modes, [LOW]).matrix[0], Inertia.from_cog(mass, np.full(3, CUBE / 2), tensor).mass_matrix


def _cube_sign(mesh: Mesh) -> Found:
    H, M = _cube()
    return Found(float(M[2, 2]), float(H[2, 2].real))


def _cube_whole(mesh: Mesh) -> Found:
    H, M = _cube()
    return Found(0.0, largest(H[None] - M, M[None]))


# --- cantilever on a moving clamp -----------------------------------------------------------------------------------------


def _driven(section: Section, motion: str, lines: Array, mesh: Mesh) -> ComplexArray:
    """Blocked dynamic mass (n, k, k) of the bar in one kind of motion, by direct solution."""
    bar = beams.structure(section, LENGTH, ELEMENTS[mesh], loss_factor=LOSS_FACTOR)
    B = beams.unit_motions(motion)
    return np.asarray(B.T @ direct(bar, lines).matrix @ B)


def _driven_bending(mesh: Mesh) -> Found:
    section = beams.EULER
    beam = closed_forms.Beam(length=LENGTH, bending=section.bending_y * (1 + 1j * LOSS_FACTOR), mass=section.mass)
    expected = closed_forms.base_driven(beam, BENDING_LINES)
    return Found(0.0, largest(_driven(section, beams.BENDING, BENDING_LINES, mesh) - expected, expected))


def _driven_rod(motion: str, mesh: Mesh) -> Found:
    stiffness, inertia = beams.rod_constants(beams.ROD, motion)
    speed = np.sqrt(stiffness * (1 + 1j * LOSS_FACTOR) / inertia)
    expected = closed_forms.rod_dynamic_mass(inertia * LENGTH, speed, LENGTH, ROD_LINES)[:, None, None]
    return Found(0.0, largest(_driven(beams.ROD, motion, ROD_LINES, mesh) - expected, expected))


# --- from modes -----------------------------------------------------------------------------------------------------------


@once
def _article() -> tuple[Structure, Modes]:
    article = structure(ARTICLE)
    return article, fixed_base(article, MODES, damping=RATIO)


@once
def _article_direct() -> ComplexArray:
    article, modes = _article()
    return direct(article, ARTICLE_LINES, RATIO, modes=modes).matrix


def _static(mesh: Mesh) -> Found:
    """Zero, and how far H(0) lies from the article's rigid mass matrix as drawn."""
    M = inertia(built_in(ARTICLE)).mass_matrix
    return Found(0.0, largest(modal(_article()[1], [0.0]).matrix - M, M[None]))


def _static_bar(mesh: Mesh) -> Found:
    """Zero, and how far H(0) of the bar lies from that of a rod in closed form."""
    bar = beams.structure(beams.ROD, LENGTH, ELEMENTS[mesh], loss_factor=LOSS_FACTOR)
    M = beams.rod_inertia(beams.ROD, LENGTH)
    return Found(0.0, largest(modal(fixed_base(bar, FEW), [0.0]).matrix - M, M[None]))


def _modal_against_direct(mesh: Mesh) -> Found:
    """Zero, and the largest difference over all lines in units of the rigid mass, which resonances do not make small."""
    _, modes = _article()
    return Found(0.0, largest(modal(modes, ARTICLE_LINES).matrix - _article_direct(), modes.rigid_mass[None]))


def _asymmetry(mesh: Mesh) -> Found:
    H = _article_direct()
    return Found(0.0, largest(H - np.swapaxes(H, 1, 2), H))


def _growth(residual: bool, mesh: Mesh) -> Found:
    """Exponent of frequency with which the error of `FEW` modes grows."""
    bar = beams.structure(beams.EULER, LENGTH, ELEMENTS[mesh], loss_factor=0.0)
    modes = fixed_base(bar, FEW, damping=Damping(loss_factors={beams.PART: 0.0}))
    difference = modal(modes, GROWTH, residual=residual).matrix - direct(bar, GROWTH).matrix
    return Found(4.0 if residual else 2.0, order(GROWTH, np.linalg.norm(difference, axis=(1, 2))))


def largest(difference: ComplexArray, whole: npt.NDArray[Any]) -> float:
    """Largest entry of `difference` (n, k, k) in units of what `whole` reaches on the diagonals of its row and column."""
    reach = np.sqrt(np.max(np.abs(np.diagonal(whole, axis1=1, axis2=2)), axis=0))
    return float(np.max(np.abs(difference) / np.outer(reach, reach)))


def _zero(what: str, source: str, bar: float, find: Callable[[Mesh], Found]) -> Check:
    return Check(family=FAMILY, what=what, source=source, unit="", bar=bar, find=find, error=Error.ABSOLUTE)


def _exponent(residual: bool) -> Check:
    return _zero(
        f"{FEW} modes of a bar {'with' if residual else 'without'} residual: exponent of the error over frequency",
        f"omega^{4 if residual else 2}: the {'next' if residual else 'first'} term of the series in omega² / omega_h²",
        0.1,
        partial(_growth, residual),
    )


EULER_DRIVEN = "closed form of the driven Euler-Bernoulli beam"
ROD_DRIVEN = "m tan(k L) / (k L), k complex"

CHECKS: tuple[Check, ...] = (
    Check(
        family=FAMILY,
        what=f"Steel cube at {LOW:g} Hz: force over acceleration along z",
        source="f = +M a: rho a³",
        unit="kg",
        bar=1e-6,
        find=_cube_sign,
    ),
    _zero(f"Steel cube at {LOW:g} Hz: all 36 entries", "H = +M: cube about its corner, closed form", 1e-6, _cube_whole),
    _zero("Bar at 0 Hz", "H = +M: rod, closed form", 1e-9, _static_bar),
    _zero("Cantilever driven across and about, loss factor 2 %, to 160 Hz", EULER_DRIVEN, 1e-3, _driven_bending),
    _zero("Rod driven along, loss factor 2 %, to 1600 Hz", ROD_DRIVEN, 1e-2, partial(_driven_rod, beams.TENSION)),
    _zero("Round rod driven about its axis, loss factor 2 %, to 1600 Hz", ROD_DRIVEN, 1e-2, partial(_driven_rod, beams.TORSION)),
    _zero(f"{ARTICLE}, beam model, at 0 Hz", "H = +M: the drawing by Pinocchio", 1e-3, _static),
    _zero(f"{ARTICLE}, 4 to 32 Hz: H against its transpose", "reciprocity: H is symmetric", 1e-9, _asymmetry),
    _zero(
        f"{ARTICLE}, {MODES} modes with residual, 4 to 32 Hz",
        "direct solution of K + i omega C - omega² M; of the rigid mass",
        1e-4,
        _modal_against_direct,
    ),
    _exponent(residual=False),
    _exponent(residual=True),
)


# Rows about base excitation in time: sign, one mode in closed form, the way back to the dynamic mass, and exudyn beside it.
#
# The recursion and exudyn's integration share matrices of an article and nothing else; both are held against what is known
# without them, and against each other.


DRIVEN_BASE = "Base excitation in time"

RATE = {Mesh.FAST: 8192.0, Mesh.FINE: 16384.0}
"""Steps a second."""

ROUTES: Mapping[str, ModuleType] = {"recursion": response, "exudyn": driven_run}

BLOCK = Inertia.from_cog(
    8.0, np.array([0.03, -0.02, 0.15]), np.array([[0.08, 0.01, -0.02], [0.01, 0.1, 0.015], [-0.02, 0.015, 0.05]])
)
"""A rigid block, its CoG off every axis."""

MODE, DRIVEN_BASE_DAMPING, PART = 12.3, 0.0035, 3.0
"""Frequency [Hz], damping ratio and effective mass [kg] of one mode."""

DRIVEN_BASE_ARTICLE, QUICK = "clumod-1", 120.0
"""And octaves a minute."""

LINES = np.linspace(4.0, 32.0, 281)
"""[Hz]"""

SLIP, LOOSE, PRELOAD = 2.0, 2.0, 30.0
"""Slip force [N] of a loose part, its mass [kg], preload of every cell [N]."""


# --- rigid ----------------------------------------------------------------------------------------------------------------


def _block(route: str, axis: str, mesh: Mesh) -> Found:
    """Zero, and the largest difference between load and M a as a share of the largest load, forces and moments apart."""
    motion = Sweep(axis=axis, rate=QUICK).motion(RATE[mesh], ring_down=0.0)
    run = ROUTES[route].respond(Rig(article=base_excitation_rig.rigid("block", BLOCK)), motion)
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
        damping_ratio=np.array([DRIVEN_BASE_DAMPING]),
        participation=L,
        rigid_mass=np.diag([PART + 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
        residual=nothing,
        reference_point=np.zeros(3),
        shapes=np.zeros((0, 1)),
        viscous=np.array([[2 * DRIVEN_BASE_DAMPING * omega]]),
    )
    return Rig(article=base_excitation_rig.of_modal_data("one mode", modes))


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
    found = response.respond(_one_mode(), motion).load[:, 0]
    # Load [N] of `_one_mode` on the table
    damped, decay = omega * np.sqrt(1 - DRIVEN_BASE_DAMPING**2), np.exp(-DRIVEN_BASE_DAMPING * omega * time)
    c, s = np.cos(damped * time), np.sin(damped * time)
    q = np.cos(omega * time) - decay * (c + DRIVEN_BASE_DAMPING * omega / damped * s)
    rate = -omega * np.sin(omega * time) + decay * omega**2 / damped * s
    spring = PART / (2 * DRIVEN_BASE_DAMPING * omega**2) * (omega**2 * q + 2 * DRIVEN_BASE_DAMPING * omega * rate)
    return Found(float(np.abs(np.asarray(np.sin(omega * time) - spring)).max()), float(np.abs(found).max()))


# --- an article -----------------------------------------------------------------------------------------------------------


@once
def _driven_article() -> tuple[FlexibleBody, Modes]:
    structure = articles.structure(DRIVEN_BASE_ARTICLE)
    modes = fixed_base(structure, 8, damping=Damping(ratio=0.05))
    return base_excitation_rig.flexible(DRIVEN_BASE_ARTICLE, structure, modes, places={"top": [0.0, 0.0, 1.6]}), modes


@once
def _on_cells() -> Rig:
    """The article on four load cells and a flange that gives."""
    corners = ((0.13, 0.13), (-0.13, 0.13), (-0.13, -0.13), (0.13, -0.13))
    cells = (LoadCell(position=np.array([x, y, 0.0]), stiffness=np.full(3, 2e8), damping=np.full(3, 2e3)) for x, y in corners)
    return Rig(
        article=_driven_article()[0],
        cover=BLOCK,
        seat=np.array([0.0, 0.0, 0.045]),
        cells=tuple(cells),
        flange=Flange(compliance=np.array([0.0, 0.0, 0.0, 2e-6, 2e-6, 0.0]), damping_time=1e-4),
    )


@once
def _shares(mesh: Mesh) -> Array:
    """(2, 6) off and at resonance: shares by which six crossed sweeps and Eqs. 10 and 11 miss the model's own dynamic mass."""
    rig, modes, cross = _on_cells(), _driven_article()[1], drawn(np.random.default_rng(1))
    drives = sweeps(rate=QUICK).values()
    runs = (response.respond(rig, drive.motion(RATE[mesh], ring_down=8.0, cross=cross)) for drive in drives)
    found = deviation(identified(runs, LINES).dynamic_mass, dynamic_mass(rig, LINES), modes.frequency, modes.damping_ratio)
    return np.array([found.off, found.at])


def _closure(where: int, mesh: Mesh) -> Found:
    return Found(0.0, float(_shares(mesh)[where].max()))


def _against_recursion(axis: str, mesh: Mesh) -> Found:
    """Zero, and the largest difference of exudyn's load from that of the recursion, over the largest load."""
    motion = Sweep(axis=axis, rate=QUICK).motion(RATE[mesh], ring_down=1.0)
    ours, theirs = response.respond(_on_cells(), motion).load, driven_run.respond(_on_cells(), motion).load
    return Found(0.0, max(float(np.abs(ours[:, k] - theirs[:, k]).max() / np.abs(ours[:, k]).max()) for k in _HALVES))


def _flange(mesh: Mesh) -> Found:
    """Zero, and how far H of an article on a flange that gives lies from H' = (I - omega² H C)^-1 H of the rigid one."""
    article, C = _driven_article()[0], np.diag([1e-7, 1e-7, 0.0, 2e-6, 2e-6, 1e-6])
    rigid = dynamic_mass(Rig(article=article), LINES).matrix
    soft = dynamic_mass(Rig(article=article, flange=Flange(compliance=np.diag(C))), LINES).matrix
    omega2 = (2 * np.pi * LINES[:, None, None]) ** 2
    expected = np.linalg.solve(np.eye(6) - omega2 * rigid @ C, rigid)
    scale = np.sqrt(np.abs(np.einsum("njj,nkk->njk", expected, expected)))
    return Found(0.0, float(np.abs((soft - expected) / scale).max()))


# --- joints ---------------------------------------------------------------------------------------------------------------


def _slipping(mesh: Mesh) -> Found:
    """Slip force, and the largest force by which the load exceeds that of the block alone while a loose part slips on it."""
    block = base_excitation_rig.rigid("block", BLOCK)
    motion = Sweep(axis="x", rate=QUICK).motion(RATE[mesh], ring_down=0.0)
    rig = Rig(article=block, frictions=(Friction(axis="x", slip_force=SLIP, mass=LOOSE),))
    run = driven_run.respond(rig, motion)
    alone = run.table @ BLOCK.mass_matrix
    return Found(SLIP, float(np.abs(run.load[:, 0] - alone[:, 0]).max()))


def _lifted(mesh: Mesh) -> Found:
    """Minus the preload, and the lowest force that a cell measures under a block that rocks off it."""
    rig = _on_cells()
    cells = tuple(LoadCell(position=c.position, stiffness=c.stiffness, damping=c.damping, preload=PRELOAD) for c in rig.cells)
    block = Rig(article=base_excitation_rig.rigid("block", BLOCK), cover=BLOCK, cells=cells)
    run = driven_run.respond(block, Sweep(axis="x", rate=QUICK, level=4.0).motion(RATE[mesh], ring_down=0.0))
    return Found(-PRELOAD, float(run.cells[:, :, 2].min()))


def _cable(route: str, mesh: Mesh) -> Found:
    """Force of a cable to the ground that a block's slow stroke along x meets, and what the load has beside M a."""
    block = base_excitation_rig.rigid("block", BLOCK, places={"top": [0.0, 0.0, 0.3]})
    stiffness = 1e5
    cable = Strut(place="top", to="ground", stiffness=np.array([stiffness, 0.0, 0.0]))
    motion = Sweep(axis="x", rate=QUICK).motion(RATE[mesh], ring_down=0.0)
    run = ROUTES[route].respond(Rig(article=block, struts=(cable,)), motion)
    beside = run.load[:, 0] - (motion.acceleration @ BLOCK.mass_matrix)[:, 0]
    return Found(stiffness * float(np.abs(motion.displacement[:, 0]).max()), float(np.abs(beside).max()))


def _row(
    what: str, source: str, find: Callable[[Mesh], Found], bar: float, unit: str = "", error: Error = Error.ABSOLUTE
) -> Check:
    return Check(family=DRIVEN_BASE, what=what, source=source, unit=unit, bar=bar, error=error, find=find)


_EQ1 = "Eq. 1, force of the table on the body"
_MODEL = "the model's own dynamic mass in the frequency domain"

DRIVEN_BASE_CHECKS: tuple[Check, ...] = (
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


# Rows about the rope pendulum: exudyn's body on ropes, its record reduced as a measured one, held against closed forms.


ROPE_PENDULUM_FAMILY = "Rope pendulum"

BODY = Inertia.from_cog(47.23, np.zeros(3), np.diag([20.144, 20.410, 2.289]))
MASS, ABOUT_Z = 47.23, 2.289
"""[kg] and [kg m²] of `BODY`: Clumod with four blades, as printed in the paper's Table 1."""

ROPE_PENDULUM_LENGTH, RADIUS, S1, S2 = 2.0, 0.3, 0.2, 0.45
"""Of ropes, of the circle of three, and to either side of the CoG of two [m]."""

SMALL = 1e-3
"""Amplitude [rad] that is none: it lengthens the period by 7e-8."""

CYCLES = 8
LINKS = {Mesh.FAST: 8, Mesh.FINE: 16}
ROPES = 0.3
"""Mass of all ropes [kg]."""


def period(s1: float, s2: float) -> float:
    """T [s] of small swings by Eq. 5."""
    unit = rope_pendulum(mass=MASS, gravity=STANDARD_GRAVITY, s1=s1, s2=s2, length=ROPE_PENDULUM_LENGTH, period=1.0)
    return float(np.sqrt(ABOUT_Z / unit))


@once
def recorded(hangs: Suspension, s1: float = RADIUS, s2: float = RADIUS) -> float:
    """T [s] from the record of a few cycles."""
    run = swing(BODY, hangs, duration=CYCLES * period(s1, s2), rate=100 / period(s1, s2))
    return float(from_signal(run.time, run.yaw, "verification").period.nominal_value)


def _small(ropes: int, mesh: Mesh) -> Found:
    if ropes == 2:
        return Found(period(S1, S2), recorded(on_two_ropes(S1, S2, length=ROPE_PENDULUM_LENGTH, amplitude=SMALL), S1, S2))
    return Found(period(RADIUS, RADIUS), recorded(on_three_ropes(RADIUS, length=ROPE_PENDULUM_LENGTH, amplitude=SMALL)))


def _shift(expected: float, hangs: Suspension) -> Found:
    """Both as a share of the period of Eq. 5, in per cent."""
    return Found(100 * expected, 100 * (recorded(hangs) / period(RADIUS, RADIUS) - 1))


def _amplitude(angle: float, mesh: Mesh) -> Found:
    factor = rope_amplitude_factor(angle, (RADIUS / ROPE_PENDULUM_LENGTH) ** 2, MASS * RADIUS**2 / ABOUT_Z)
    return _shift(factor - 1, on_three_ropes(RADIUS, length=ROPE_PENDULUM_LENGTH, amplitude=angle))


def _damping(ratio: float, mesh: Mesh) -> Found:
    return _shift(
        1 / np.sqrt(1 - ratio**2) - 1, on_three_ropes(RADIUS, length=ROPE_PENDULUM_LENGTH, amplitude=SMALL, damping_ratio=ratio)
    )


def _rope_mass(mesh: Mesh) -> Found:
    """Uniform ropes: a third of their mass swings with the feet, half of it presses them down."""
    expected = np.sqrt((1 + ROPES * RADIUS**2 / (3 * ABOUT_Z)) / (1 + ROPES / (2 * MASS))) - 1
    hangs = on_three_ropes(RADIUS, length=ROPE_PENDULUM_LENGTH, amplitude=SMALL, rope_mass=ROPES, links=LINKS[mesh])
    return _shift(float(expected), hangs)


_EQ5 = "Eq. 5, T = 2 pi sqrt(I l / (m g s1 s2))"

ROPE_PENDULUM_CHECKS: tuple[Check, ...] = (
    *(
        Check(
            family=ROPE_PENDULUM_FAMILY, what=f"Period on {words}", source=_EQ5, unit="s", bar=1e-5, find=partial(_small, ropes)
        )
        for ropes, words in ((2, "two ropes, s1 and s2 unequal"), (3, "three ropes"))
    ),
    *(
        Check(
            family=ROPE_PENDULUM_FAMILY,
            what=f"Amplitude {angle:g} rad: period longer by",
            source="energy integral over a quarter swing",
            unit="%",
            bar=2e-3,
            error=Error.ABSOLUTE,
            find=partial(_amplitude, angle),
        )
        for angle in (0.1, 0.2)
    ),
    Check(
        family=ROPE_PENDULUM_FAMILY,
        what="Damping 5 %: period longer by",
        source="1 / sqrt(1 - zeta²)",
        unit="%",
        bar=2e-3,
        error=Error.ABSOLUTE,
        find=partial(_damping, 0.05),
    ),
    Check(
        family=ROPE_PENDULUM_FAMILY,
        what="Ropes of 0.3 kg in all: period longer by",
        source="uniform straight ropes: M s²/3 more inertia, M/2 more weight",
        unit="%",
        bar=3e-3,
        error=Error.ABSOLUTE,
        find=_rope_mass,
    ),
)
