"""Rows about the dynamic mass: sign and rigid limit, a cantilever on a moving clamp in closed form, and what truncation costs.

The beam rows compare whole complex matrices: the error is the largest entry of the difference over all lines, every entry divided
by the largest size that the entries on its row's and its column's diagonals reach, so that kilograms and kilogram metres squared
weigh the same.
"""

from collections.abc import Iterable, Mapping
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
from fem.exudyn.rope_pendulum import swing
from fem.exudyn.rope_statics import Suspension, on_three_ropes, on_two_ropes
from fem.modes import Modes, fixed_base
from fem.solid.model import of_mesh
from fem.structure import Structure
from geometry.articles import built_in
from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.frames import Array
from geometry.inertia import Inertia
from geometry.routes import inertia
from geometry.toml_file import STANDARD_GRAVITY
from identification.dynamic_mass import Estimate, from_runs
from identification.spectra.line_spectra import full_record
from validation.classical.pendulum import from_signal, rope_amplitude_factor, rope_pendulum
from validation.verification import beams, solids
from validation.verification.check import Found, Mesh, Rows, once, order

DYNAMIC_MASS = Rows("Dynamic mass")

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


def largest(difference: ComplexArray, whole: npt.NDArray[Any]) -> float:
    """Largest entry of `difference` (n, k, k) in units of what `whole` reaches on the diagonals of its row and column."""
    reach = np.sqrt(np.max(np.abs(np.diagonal(whole, axis1=1, axis2=2)), axis=0))
    return float(np.max(np.abs(difference) / np.outer(reach, reach)))


@once
def _cube() -> tuple[ComplexArray, Array]:
    """H of the steel cube at `LOW` (6, 6), about a corner of its foot, and its rigid mass in closed form."""
    grid = solids.block((CUBE, CUBE, CUBE), (2, 2, 2))
    modes = fixed_base(of_mesh(grid, {solids.PART: solids.steel(0.3)}, cached=False), 20)
    mass = solids.steel(0.3).density * CUBE**3
    tensor = mass * CUBE**2 / 6 * np.eye(3)
    return modal(modes, [LOW]).matrix[0], Inertia.from_cog(mass, np.full(3, CUBE / 2), tensor).mass_matrix


@DYNAMIC_MASS.relative(f"Steel cube at {LOW:g} Hz: force over acceleration along z", "f = +M a: rho a³", "kg", 1e-6)
def _cube_sign(mesh: Mesh) -> Found:
    H, M = _cube()
    return Found(float(M[2, 2]), float(H[2, 2].real))


@DYNAMIC_MASS.absolute(f"Steel cube at {LOW:g} Hz: all 36 entries", "H = +M: cube about its corner, closed form", 1e-6)
def _cube_whole(mesh: Mesh) -> Found:
    H, M = _cube()
    return Found(0.0, largest(H[None] - M, M[None]))


@DYNAMIC_MASS.absolute("Bar at 0 Hz", "H = +M: rod, closed form", 1e-9)
def _static_bar(mesh: Mesh) -> Found:
    bar = beams.structure(beams.ROD, LENGTH, ELEMENTS[mesh], loss_factor=LOSS_FACTOR)
    M = beams.rod_inertia(beams.ROD, LENGTH)
    return Found(0.0, largest(modal(fixed_base(bar, FEW), [0.0]).matrix - M, M[None]))


def _driven(section: Section, motion: str, lines: Array, mesh: Mesh) -> ComplexArray:
    """Blocked dynamic mass (n, k, k) of the bar on a moving clamp in one kind of motion, by direct solution."""
    bar = beams.structure(section, LENGTH, ELEMENTS[mesh], loss_factor=LOSS_FACTOR)
    B = beams.UNIT_MOTIONS[motion]
    return np.asarray(B.T @ direct(bar, lines).matrix @ B)


@DYNAMIC_MASS.absolute(
    "Cantilever driven across and about, loss factor 2 %, to 160 Hz", "closed form of the driven Euler-Bernoulli beam", 1e-3
)
def _driven_bending(mesh: Mesh) -> Found:
    section = beams.EULER
    beam = beams.Beam(length=LENGTH, bending=section.bending_y * (1 + 1j * LOSS_FACTOR), mass=section.mass)
    expected = beam.base_driven(BENDING_LINES)
    return Found(0.0, largest(_driven(section, beams.BENDING, BENDING_LINES, mesh) - expected, expected))


def _driven_rod(motion: str, mesh: Mesh) -> Found:
    stiffness, inertia = beams.rod_constants(beams.ROD, motion)
    speed = np.sqrt(stiffness * (1 + 1j * LOSS_FACTOR) / inertia)
    expected = beams.rod_dynamic_mass(inertia * LENGTH, speed, LENGTH, ROD_LINES)[:, None, None]
    return Found(0.0, largest(_driven(beams.ROD, motion, ROD_LINES, mesh) - expected, expected))


for _words, _how in (("Rod driven along", beams.TENSION), ("Round rod driven about its axis", beams.TORSION)):
    _what = f"{_words}, loss factor 2 %, to 1600 Hz"
    DYNAMIC_MASS.absolute(_what, "m tan(k L) / (k L), k complex", 1e-2, _how)(_driven_rod)


@once
def _article() -> tuple[Structure, Modes]:
    article = structure(ARTICLE)
    return article, fixed_base(article, MODES, damping=RATIO)


@once
def _article_direct() -> ComplexArray:
    article, modes = _article()
    return direct(article, ARTICLE_LINES, RATIO, modes=modes).matrix


@DYNAMIC_MASS.absolute(f"{ARTICLE}, beam model, at 0 Hz", "H = +M: the drawing by Pinocchio", 1e-3)
def _static(mesh: Mesh) -> Found:
    M = inertia(built_in(ARTICLE)).mass_matrix
    return Found(0.0, largest(modal(_article()[1], [0.0]).matrix - M, M[None]))


@DYNAMIC_MASS.absolute(f"{ARTICLE}, 4 to 32 Hz: H against its transpose", "reciprocity: H is symmetric", 1e-9)
def _asymmetry(mesh: Mesh) -> Found:
    H = _article_direct()
    return Found(0.0, largest(H - np.swapaxes(H, 1, 2), H))


@DYNAMIC_MASS.absolute(
    f"{ARTICLE}, {MODES} modes with residual, 4 to 32 Hz", "direct solution of K + i omega C - omega² M; of the rigid mass", 1e-4
)
def _modal_against_direct(mesh: Mesh) -> Found:
    """Zero, and the largest difference over all lines in units of the rigid mass, which resonances do not make small."""
    _, modes = _article()
    return Found(0.0, largest(modal(modes, ARTICLE_LINES).matrix - _article_direct(), modes.rigid_mass[None]))


def _growth(residual: bool, mesh: Mesh) -> Found:
    """Exponent of frequency with which the error of `FEW` modes grows."""
    bar = beams.structure(beams.EULER, LENGTH, ELEMENTS[mesh], loss_factor=0.0)
    modes = fixed_base(bar, FEW, damping=Damping(loss_factors={beams.PART: 0.0}))
    difference = modal(modes, GROWTH, residual=residual).matrix - direct(bar, GROWTH).matrix
    return Found(4.0 if residual else 2.0, order(GROWTH, np.linalg.norm(difference, axis=(1, 2))))


for _with, _power, _term, _residual in (("without", 2, "first", False), ("with", 4, "next", True)):
    DYNAMIC_MASS.absolute(
        f"{FEW} modes of a bar {_with} residual: exponent of the error over frequency",
        f"omega^{_power}: the {_term} term of the series in omega² / omega_h²",
        0.1,
        _residual,
    )(_growth)


# Rows about base excitation in time: sign, one mode in closed form, the way back to the dynamic mass, and exudyn beside it.
#
# The recursion and exudyn's integration share matrices of an article and nothing else; both are held against what is known
# without them, and against each other.


DRIVEN_BASE = Rows("Base excitation in time")

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


def _motion(axis: str, mesh: Mesh, *, ring_down: float = 0.0, level: float = 1.0) -> BaseMotion:
    """A quick sweep along one axis."""
    return Sweep(axis=axis, rate=QUICK, level=level).motion(RATE[mesh], ring_down=ring_down)


def _apart(found: Array, expected: Array) -> float:
    """Largest difference as a share of the largest load, forces and moments apart."""
    halves = (slice(0, 3), slice(3, 6))
    return max(float(np.abs(found[:, k] - expected[:, k]).max() / np.abs(expected[:, k]).max()) for k in halves)


def _block(route: str, axis: str, mesh: Mesh) -> Found:
    """Zero, and how far the load is from M a."""
    motion = _motion(axis, mesh)
    run = ROUTES[route].respond(Rig(article=base_excitation_rig.rigid("block", BLOCK)), motion)
    return Found(0.0, _apart(run.load, motion.acceleration @ BLOCK.mass_matrix))


for _route, _bar in (("recursion", 1e-12), ("exudyn", 1e-3)):
    for _axis in ("x", "z", "beta", "gamma"):
        _what = f"Rigid block, {_route}, driven along {_axis}: load against M a"
        DRIVEN_BASE.absolute(_what, "Eq. 1, force of the table on the body", _bar, _route, _axis)(_block)


@DRIVEN_BASE.relative("One mode driven at resonance from rest, peak load", "closed form of the oscillator", "N", 1e-7)
def _at_resonance(mesh: Mesh) -> Found:
    """Peak of the load of one mode driven at its own frequency from rest for ten periods, and what the recursion finds.

    q'' + 2 zeta omega q' + omega² q = -L sin(omega t) has q = L / (2 zeta omega²) (cos(omega t) - exp(-zeta omega t)
    (cos(omega_d t) + zeta omega / omega_d sin(omega_d t))), and the load is (M - L²) a - L (omega² q + 2 zeta omega q').
    """
    zeta, omega = DRIVEN_BASE_DAMPING, 2 * np.pi * MODE
    # A mass on a spring along x, as modal data
    L = np.zeros((6, 1))
    L[0] = np.sqrt(PART)
    modes = Modes(
        frequency=np.array([MODE]),
        damping_ratio=np.array([zeta]),
        participation=L,
        rigid_mass=np.diag([PART + 1.0, 1.0, 1.0, 1.0, 1.0, 1.0]),
        residual=np.zeros((6, 6)),
        reference_point=np.zeros(3),
        shapes=np.zeros((0, 1)),
        viscous=np.array([[2 * zeta * omega]]),
    )
    time = np.arange(round(10 / MODE * RATE[mesh])) / RATE[mesh]
    acceleration = np.zeros((len(time), 6))
    acceleration[:, 0] = np.sin(omega * time)
    still = np.zeros_like(acceleration)
    motion = BaseMotion(
        sampling_rate=RATE[mesh], displacement=still, velocity=still, acceleration=acceleration, driven=float(time[-1])
    )
    found = response.respond(Rig(article=base_excitation_rig.of_modal_data("one mode", modes)), motion).load[:, 0]
    # Load [N] on the table in closed form
    damped, decay = omega * np.sqrt(1 - zeta**2), np.exp(-zeta * omega * time)
    c, s = np.cos(damped * time), np.sin(damped * time)
    q = np.cos(omega * time) - decay * (c + zeta * omega / damped * s)
    rate = -omega * np.sin(omega * time) + decay * omega**2 / damped * s
    spring = PART / (2 * zeta * omega**2) * (omega**2 * q + 2 * zeta * omega * rate)
    return Found(float(np.abs(np.asarray(np.sin(omega * time) - spring)).max()), float(np.abs(found).max()))


# Closure: a model is shaken, and what is identified from the time histories must be the model again.
#
# Runs of a simulated test go the way of a measured one - spectra of whole records, Eqs. 10 and 11 - and end in a dynamic mass,
# which is held against the one that the model has by itself, in the frequency domain. Nothing of the model is known on the way.


BANDWIDTHS = 5.0
"""A line is at a resonance when it lies within so many half-power half-widths zeta f of it."""


def identified(runs: Iterable[response.Response], lines: Array) -> Estimate:
    """The dynamic mass of what stands on the table from `runs`, one after the other, at `lines` (n,) [Hz].

    Raises
    ------
    BadInput : lines beyond Nyquist, fewer than six runs, a base motion that none of them drives.
    """
    loads: list[ComplexArray] = []
    motions: list[ComplexArray] = []
    point = np.zeros(3)
    for run in runs:
        point = run.reference_point
        loads.append(full_record(run.load, run.sampling_rate, lines))
        motions.append(full_record(run.table, run.sampling_rate, lines))
    return from_runs(np.array(loads), np.array(motions), lines, point)


def deviation(found: DynamicMass, model: DynamicMass, frequency: Array, damping_ratio: Array) -> Array:
    """(2, 6) largest difference on the diagonal of `found` from `model`, off its resonances and at them, as a share.

    A share is of the entry itself, or of the one at the first line where that is larger, since an antiresonance is no reason to
    divide by nothing; it is 0 where there is no such line.

    Parameters
    ----------
    frequency, damping_ratio : (m,) [Hz], [1] of the modes of the blocked structure
    """
    H, lines = np.einsum("nkk->nk", model.matrix), model.frequency
    scale = np.maximum(np.abs(H), np.abs(H[0]))
    share = np.abs(np.einsum("nkk->nk", found.matrix) - H) / scale
    near = np.abs(lines[:, None] - frequency) <= BANDWIDTHS * damping_ratio * frequency
    resonant = near.any(axis=1)
    return np.array([share[~resonant].max(axis=0, initial=0.0), share[resonant].max(axis=0, initial=0.0)])


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
    return deviation(identified(runs, LINES).dynamic_mass, dynamic_mass(rig, LINES), modes.frequency, modes.damping_ratio)


def _closure(where: int, mesh: Mesh) -> Found:
    return Found(0.0, float(_shares(mesh)[where].max()))


def _against_recursion(axis: str, mesh: Mesh) -> Found:
    """Zero, and how far exudyn's load is from that of the recursion."""
    motion = _motion(axis, mesh, ring_down=1.0)
    return Found(0.0, _apart(driven_run.respond(_on_cells(), motion).load, response.respond(_on_cells(), motion).load))


for _k, (_where, _bar) in enumerate((("off", 1e-4), ("at", 5e-4))):
    _source = "the model's own dynamic mass in the frequency domain"
    DRIVEN_BASE.absolute(f"Six sweeps, Eqs. 10 and 11, {_where} resonance", _source, _bar, _k)(_closure)
for _axis in ("x", "beta"):
    _what = f"Exudyn's load against the recursion's, {_axis}"
    DRIVEN_BASE.absolute(_what, "two integrations", 1e-3, _axis)(_against_recursion)


@DRIVEN_BASE.absolute("Flange that gives", "H' = (I - omega² H C)^-1 H", 1e-9)
def _flange(mesh: Mesh) -> Found:
    """Zero, and how far H of an article on a flange that gives lies from that which follows from H of the rigid one."""
    article, C = _driven_article()[0], np.diag([1e-7, 1e-7, 0.0, 2e-6, 2e-6, 1e-6])
    rigid = dynamic_mass(Rig(article=article), LINES).matrix
    soft = dynamic_mass(Rig(article=article, flange=Flange(compliance=np.diag(C))), LINES).matrix
    omega2 = (2 * np.pi * LINES[:, None, None]) ** 2
    expected = np.linalg.solve(np.eye(6) - omega2 * rigid @ C, rigid)
    scale = np.sqrt(np.abs(np.einsum("njj,nkk->njk", expected, expected)))
    return Found(0.0, float(np.abs((soft - expected) / scale).max()))


def _cable(route: str, mesh: Mesh) -> Found:
    """Force of a cable to the ground that a block's slow stroke along x meets, and what the load has beside M a."""
    block = base_excitation_rig.rigid("block", BLOCK, places={"top": [0.0, 0.0, 0.3]})
    stiffness = 1e5
    cable = Strut(place="top", to="ground", stiffness=np.array([stiffness, 0.0, 0.0]))
    motion = _motion("x", mesh)
    run = ROUTES[route].respond(Rig(article=block, struts=(cable,)), motion)
    beside = run.load[:, 0] - (motion.acceleration @ BLOCK.mass_matrix)[:, 0]
    return Found(stiffness * float(np.abs(motion.displacement[:, 0]).max()), float(np.abs(beside).max()))


for _route, _bar in (("recursion", 1e-9), ("exudyn", 1e-3)):
    DRIVEN_BASE.relative(f"Cable to the ground, {_route}", "k u", "N", _bar, _route)(_cable)


@DRIVEN_BASE.relative("Loose part that slips on the flange, exudyn", "Coulomb", "N", 1e-2)
def _slipping(mesh: Mesh) -> Found:
    """Slip force, and the largest force by which the load exceeds that of the block alone while a loose part slips on it."""
    block = base_excitation_rig.rigid("block", BLOCK)
    rig = Rig(article=block, frictions=(Friction(axis="x", slip_force=SLIP, mass=LOOSE),))
    run = driven_run.respond(rig, _motion("x", mesh))
    alone = run.table @ BLOCK.mass_matrix
    return Found(SLIP, float(np.abs(run.load[:, 0] - alone[:, 0]).max()))


@DRIVEN_BASE.relative("Load cell that lifts off, exudyn", "no tension beyond the preload", "N", 1e-2)
def _lifted(mesh: Mesh) -> Found:
    """Minus the preload, and the lowest force that a cell measures under a block that rocks off it."""
    rig = _on_cells()
    cells = tuple(LoadCell(position=c.position, stiffness=c.stiffness, damping=c.damping, preload=PRELOAD) for c in rig.cells)
    block = Rig(article=base_excitation_rig.rigid("block", BLOCK), cover=BLOCK, cells=cells)
    return Found(-PRELOAD, float(driven_run.respond(block, _motion("x", mesh, level=4.0)).cells[:, :, 2].min()))


# Rows about the rope pendulum: exudyn's body on ropes, its record reduced as a measured one, held against closed forms.


ROPE_PENDULUM = Rows("Rope pendulum")

BODY = Inertia.from_cog(47.23, np.zeros(3), np.diag([20.144, 20.410, 2.289]))
MASS, ABOUT_Z = 47.23, 2.289
"""[kg] and [kg m²] of `BODY`: Clumod with four blades, as printed in the paper's Table 1."""

ROPE_LENGTH, RADIUS, S1, S2 = 2.0, 0.3, 0.2, 0.45
"""Of ropes, of the circle of three, and to either side of the CoG of two [m]."""

SMALL = 1e-3
"""Amplitude [rad] that is none: it lengthens the period by 7e-8."""

CYCLES = 8
LINKS = {Mesh.FAST: 8, Mesh.FINE: 16}
ROPES = 0.3
"""Mass of all ropes [kg]."""


def period(s1: float, s2: float) -> float:
    """T [s] of small swings by Eq. 5."""
    unit = rope_pendulum(mass=MASS, gravity=STANDARD_GRAVITY, s1=s1, s2=s2, length=ROPE_LENGTH, period=1.0)
    return float(np.sqrt(ABOUT_Z / unit))


@once
def recorded(hangs: Suspension, s1: float = RADIUS, s2: float = RADIUS) -> float:
    """T [s] from the record of a few cycles."""
    run = swing(BODY, hangs, duration=CYCLES * period(s1, s2), rate=100 / period(s1, s2))
    return float(from_signal(run.time, run.yaw, "verification").period.nominal_value)


def _hung(**more: Any) -> Suspension:
    """On three ropes; a small twist where nothing else is said."""
    return on_three_ropes(RADIUS, length=ROPE_LENGTH, **{"amplitude": SMALL, **more})


def _shift(expected: float, hangs: Suspension) -> Found:
    """Both as a share of the period of Eq. 5, in per cent."""
    return Found(100 * expected, 100 * (recorded(hangs) / period(RADIUS, RADIUS) - 1))


_EQ5 = "Eq. 5, T = 2 pi sqrt(I l / (m g s1 s2))"


@ROPE_PENDULUM.relative("Period on two ropes, s1 and s2 unequal", _EQ5, "s", 1e-5)
def _two_ropes(mesh: Mesh) -> Found:
    return Found(period(S1, S2), recorded(on_two_ropes(S1, S2, length=ROPE_LENGTH, amplitude=SMALL), S1, S2))


@ROPE_PENDULUM.relative("Period on three ropes", _EQ5, "s", 1e-5)
def _three_ropes(mesh: Mesh) -> Found:
    return Found(period(RADIUS, RADIUS), recorded(_hung()))


def _amplitude(angle: float, mesh: Mesh) -> Found:
    factor = rope_amplitude_factor(angle, (RADIUS / ROPE_LENGTH) ** 2, MASS * RADIUS**2 / ABOUT_Z)
    return _shift(factor - 1, _hung(amplitude=angle))


for _angle in (0.1, 0.2):
    _what = f"Amplitude {_angle:g} rad: period longer by"
    ROPE_PENDULUM.absolute(_what, "energy integral over a quarter swing", 2e-3, _angle, unit="%")(_amplitude)


@ROPE_PENDULUM.absolute("Damping 5 %: period longer by", "1 / sqrt(1 - zeta²)", 2e-3, unit="%")
def _damping(mesh: Mesh) -> Found:
    return _shift(1 / np.sqrt(1 - 0.05**2) - 1, _hung(damping_ratio=0.05))


@ROPE_PENDULUM.absolute(
    "Ropes of 0.3 kg in all: period longer by", "uniform straight ropes: M s²/3 more inertia, M/2 more weight", 3e-3, unit="%"
)
def _rope_mass(mesh: Mesh) -> Found:
    """Uniform ropes: a third of their mass swings with the feet, half of it presses them down."""
    expected = np.sqrt((1 + ROPES * RADIUS**2 / (3 * ABOUT_Z)) / (1 + ROPES / (2 * MASS))) - 1
    return _shift(float(expected), _hung(rope_mass=ROPES, links=LINKS[mesh]))
