"""Rows about beam elements: a bar that lies askew in space, bent, stretched and twisted, against closed forms.

The bar lies along no axis of the frame, so every row passes through the rotation of the elements as well.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from fem.beam.elements import Section, rectangle, sandwich, tube
from fem.beam.frame import Member, Plan, assemble
from fem.exudyn.linear import modes_of_plan
from fem.modes import Modes
from fem.structure import Structure
from geometry.article import Material
from geometry.frames import Array, rigid_transformation_6
from validation.verification import closed_forms
from validation.verification.check import Check, Error, Found, Mesh, once, order
from validation.verification.closed_forms import frequencies

FAMILY = "Beam elements"

STEEL = Material(name="steel", density=7850.0, youngs_modulus=207e9, poisson_ratio=0.3)
RECTANGLE = rectangle(0.02, 0.01, STEEL)
EULER = replace(RECTANGLE, shear_y=np.inf, shear_z=np.inf, rotary_y=0.0, rotary_z=0.0)
ROD = tube(0.02, 0.0, STEEL)
SLENDER, STOCKY = 1.0, 0.06
"""Lengths [m]: a hundred times the rectangle's height, and six times."""

ALONG = np.array([2.0, 3.0, 6.0]) / 7
SIDE = np.array([6.0, 2.0, -3.0]) / 7
"""Unit vectors along the bar and along the section's z axis, in which it bends."""

PART = "bar"
BENDING, TENSION, TORSION = "bending", "tension", "torsion"

ELEMENTS, FINER = 40, 80
LEVELS = (4, 8, 16)
"""Elements of a study of convergence."""


def plan(section: Section, length: float, elements: int) -> Plan:
    """A bar that begins at the origin."""
    numbers = tuple(range(elements + 1))
    member = Member(nodes=numbers, section=section, z_axis=SIDE, part=PART)
    return Plan(nodes=np.linspace(0, length, elements + 1)[:, None] * ALONG, carriers=numbers, members=(member,))


def structure(section: Section, length: float, elements: int, *, loss_factor: float) -> Structure:
    """The bar on a base that holds its first node, about that node."""
    from scipy.sparse import csr_array

    frame = assemble(plan(section, length, elements))
    K = csr_array(frame.stiffness[PART])
    return Structure(
        stiffness=K,
        mass=csr_array(frame.mass),
        rigid=frame.rigid,
        held=np.arange(6),
        part_stiffness={PART: K},
        loss_factors={PART: loss_factor},
    )


def found(section: Section, length: float, elements: int, motion: str, clamped: bool, count: int) -> Array:
    """The lowest `count` elastic frequencies [Hz] of the bar in one kind of `motion`, clamped at its start or free."""
    frame = assemble(plan(section, length, elements))
    B = np.kron(np.eye(elements + 1), unit_motions(motion))[:, (2 if motion == BENDING else 1) if clamped else 0 :]
    return frequencies(B.T @ frame.stiffness[PART] @ B, B.T @ frame.mass @ B, count, rigid=0 if clamped else 2)


def unit_motions(motion: str) -> Array:
    """What one node may do (6, k): bend in the plane of `SIDE`, move along the bar, or turn about it."""
    zero = np.zeros(3)
    kinds = {
        BENDING: [np.append(SIDE, zero), np.append(zero, np.cross(ALONG, SIDE))],
        TENSION: [np.append(ALONG, zero)],
        TORSION: [np.append(zero, ALONG)],
    }
    return np.transpose(kinds[motion])


def rod_constants(section: Section, motion: str) -> tuple[float, float]:
    """Stiffness [N or N m²] and inertia [kg/m or kg m] of the section in tension or torsion."""
    if motion == TENSION:
        return section.axial, section.mass
    return section.torsion, section.rotary_y + section.rotary_z


def closed_form(section: Section, length: float, motion: str, clamped: bool, count: int) -> Array:
    """The same frequencies without elements."""
    if motion == BENDING:
        beam = closed_forms.Beam(
            length=length, bending=section.bending_y, shear=section.shear_z, mass=section.mass, rotary=section.rotary_y
        )
        if not np.isfinite(section.shear_z):
            return (closed_forms.euler_bernoulli_cantilever if clamped else closed_forms.euler_bernoulli_free)(beam, count)
        return (closed_forms.timoshenko_cantilever if clamped else closed_forms.timoshenko_free)(beam, count)
    stiffness, inertia = rod_constants(section, motion)
    return closed_forms.rod_fixed_free(np.sqrt(stiffness / inertia), length, count)


MODES = 3

Case = tuple[Section, float, str, bool]
"""Section, length [m], motion, clamped at the start."""

EULER_CANTILEVER: Case = (EULER, SLENDER, BENDING, True)
EULER_FREE: Case = (EULER, SLENDER, BENDING, False)
TIMOSHENKO_CANTILEVER: Case = (RECTANGLE, STOCKY, BENDING, True)
TIMOSHENKO_FREE: Case = (RECTANGLE, STOCKY, BENDING, False)
STRETCHED: Case = (ROD, SLENDER, TENSION, True)
TWISTED: Case = (ROD, SLENDER, TORSION, True)


@once
def _references(case: Case) -> Array:
    return closed_form(*case, MODES)


@once
def _values(case: Case, elements: int) -> Array:
    section, length, motion, clamped = case
    return found(section, length, elements, motion, clamped, MODES)


def _mode(case: Case, number: int, mesh: Mesh) -> Found:
    elements = FINER if mesh is Mesh.FINE else ELEMENTS
    return Found(float(_references(case)[number - 1]), float(_values(case, elements)[number - 1]))


def _order(case: Case, expected: float, number: int, mesh: Mesh) -> Found:
    """Order with which the frequency of mode `number` approaches the closed form as elements get shorter."""
    reference = _references(case)[number - 1]
    errors = [_values(case, n)[number - 1] / reference - 1 for n in LEVELS]
    return Found(expected, order([1 / n for n in LEVELS], errors))


def _rigid_inertia(mesh: Mesh) -> Found:
    """Zero, and the largest deviation of the bar's rigid mass matrix from that of a rod with thick ends [share of its scale]."""
    frame, expected = assemble(plan(RECTANGLE, STOCKY, 2)), rod_inertia(RECTANGLE, STOCKY)
    difference = frame.rigid.T @ frame.mass @ frame.rigid - expected
    scale = np.sqrt(np.diag(expected))
    return Found(0.0, float(np.max(np.abs(difference) / np.outer(scale, scale))))


def _rigid_motion(mesh: Mesh) -> Found:
    """Zero, and the largest force of the six rigid motions as a share of the largest stiffness times that motion."""
    frame = assemble(plan(RECTANGLE, STOCKY, 3))
    K, T = frame.stiffness[PART], frame.rigid
    return Found(0.0, float(np.max(np.abs(K @ T) / np.max(np.abs(K) @ np.abs(T), axis=0))))


def rod_inertia(section: Section, length: float) -> Array:
    """6x6 mass matrix about its start of a straight rod along `ALONG` with rotary inertia of its section."""
    axes = np.array([ALONG, np.cross(SIDE, ALONG), SIDE])
    mass, polar = section.mass * length, section.rotary_y + section.rotary_z
    own = length * np.array([polar, section.rotary_y, section.rotary_z]) + mass * length**2 / 12 * np.array([0, 1, 1])
    centre = rigid_transformation_6(ALONG * length / 2)
    matrix = np.block([[mass * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), axes.T @ np.diag(own) @ axes]])
    return np.asarray(centre.T @ matrix @ centre)


def _modes(words: str, source: str, bar: float, case: Case) -> list[Check]:
    return [
        Check(family=FAMILY, what=f"{words}, mode {k}", source=source, unit="Hz", bar=bar, find=partial(_mode, case, k))
        for k in range(1, MODES + 1)
    ]


def _rate(words: str, source: str, case: Case, expected: float, number: int) -> Check:
    find = partial(_order, case, expected, number)
    return Check(family=FAMILY, what=words, source=source, unit="", bar=0.2, find=find, error=Error.ABSOLUTE)


def _zero(words: str, source: str, bar: float, find: Callable[[Mesh], Found]) -> Check:
    return Check(family=FAMILY, what=words, source=source, unit="", bar=bar, find=find, error=Error.ABSOLUTE)


HERMITE = "cubic deflection: eigenvalues of order 4 (Strang and Fix, chapter 6)"
EVEN_SHEAR = "shear strain even over an element: order 2 for what shear contributes"
LINEAR = "linear displacement: eigenvalues of order 2 (Strang and Fix, chapter 6)"
BLEVINS_CLAMPED, BLEVINS_FREE = "1 + cos x cosh x = 0 (Blevins, Table 8-1)", "1 - cos x cosh x = 0 (Blevins, Table 8-1)"
TRANSCENDENTAL = "Timoshenko's frequency equation, solved by bisection"

CHECKS: tuple[Check, ...] = (
    *_modes("Euler-Bernoulli cantilever", BLEVINS_CLAMPED, 1e-5, EULER_CANTILEVER),
    _rate("Euler-Bernoulli cantilever, mode 2: order of convergence", HERMITE, EULER_CANTILEVER, 4, 2),
    *_modes("Euler-Bernoulli bar, both ends free", BLEVINS_FREE, 1e-5, EULER_FREE),
    *_modes("Timoshenko cantilever, 6 heights long", TRANSCENDENTAL, 2e-3, TIMOSHENKO_CANTILEVER),
    _rate("Timoshenko cantilever, mode 2: order of convergence", EVEN_SHEAR, TIMOSHENKO_CANTILEVER, 2, 2),
    *_modes("Timoshenko bar, 6 heights long, both ends free", TRANSCENDENTAL, 2e-3, TIMOSHENKO_FREE),
    *_modes("Rod in tension, one end clamped", "(2 k - 1) c / (4 L), c² = E / rho", 2e-3, STRETCHED),
    _rate("Rod in tension, mode 1: order of convergence", LINEAR, STRETCHED, 2, 1),
    *_modes("Round rod in torsion, one end clamped", "(2 k - 1) c / (4 L), c² = G / rho", 2e-3, TWISTED),
    _rate("Round rod in torsion, mode 1: order of convergence", LINEAR, TWISTED, 2, 1),
    _zero("Rigid motions: force per stiffness and motion", "a rigid body is not strained", 1e-12, _rigid_motion),
    _zero("Rigid mass matrix of two elements", "rod with the section's rotary inertia, closed form", 1e-12, _rigid_inertia),
)


# Rows about exudyn as the independent route: its own beams and its own eigen-solution, no element of ours.
#
# Exudyn's beam is geometrically exact with linear shapes; `fem.exudyn` solves a mesh and one twice as fine and
# extrapolates.


EXUDYN_BEAMS_FAMILY = "Exudyn"

EXUDYN_BEAMS_ELEMENTS = {Mesh.FAST: 10, Mesh.FINE: 20}
EXUDYN_BEAMS_MODES = 8
MOVES = 0.01
"""Effective mass or inertia along an axis, as a share of the whole, from which a mode counts as moving along it."""

AXIS = {BENDING: 2, TENSION: 0, TORSION: 3}
"""Of the base: along z, along the bar, about the bar."""


@once
def _exudyn_beams_modes(section: Section, mesh: Mesh) -> Modes:
    """Modes of a bar along x, `STOCKY` long, clamped at its start."""
    numbers = tuple(range(EXUDYN_BEAMS_ELEMENTS[mesh] + 1))
    member = Member(nodes=numbers, section=section, z_axis=np.array([0.0, 0.0, 1.0]))
    nodes = np.linspace([0, 0, 0], [STOCKY, 0, 0], len(numbers))
    return modes_of_plan(Plan(nodes=nodes, carriers=numbers, members=(member,)), EXUDYN_BEAMS_MODES)


def _exudyn_beams_mode(section: Section, motion: str, number: int, mesh: Mesh) -> Found:
    modes, axis = _exudyn_beams_modes(section, mesh), AXIS[motion]
    moving = modes.effective_mass[:, axis] > MOVES * modes.rigid_mass[axis, axis]
    reference = closed_form(section, STOCKY, motion, True, number)[number - 1]
    return Found(float(reference), float(modes.frequency[moving][number - 1]))


def _exudyn_beams_row(what: str, source: str, section: Section, motion: str, number: int) -> Check:
    find = partial(_exudyn_beams_mode, section, motion, number)
    return Check(family=EXUDYN_BEAMS_FAMILY, what=f"Exudyn's beams: {what}", source=source, unit="Hz", bar=1e-3, find=find)


EXUDYN_BEAMS_CHECKS: tuple[Check, ...] = (
    *(_exudyn_beams_row(f"cantilever, 6 heights long, mode {k}", TRANSCENDENTAL, RECTANGLE, BENDING, k) for k in (1, 2, 3)),
    _exudyn_beams_row("rod in tension, mode 1", "c / (4 L), c² = E / rho", ROD, TENSION, 1),
    _exudyn_beams_row("round rod in torsion, mode 1", "c / (4 L), c² = G / rho", ROD, TORSION, 1),
)


# Rows about the sandwich element: a simply supported beam of two faces and a soft layer, after Mead and Markus.
#
# With w = W sin(k x) the slip follows as a cosine, and the layer acts as a spring in series with the faces' stretching: per
# width, the bending stiffness at the wave number k is
#
#     B(k) = E t³ / 6 + E t d² / 2 * g / (1 + g),    g = 2 G_c / (E t s k²),    d = t + s,
#
# from two loose faces at short waves to the bonded section at long ones (Ross, Ungar and Kerwin 1959; Mead and Markus, J. Sound
# Vib. 10, 1969, 163-175). A loss factor of the layer makes G_c complex; to first order a mode has of it the share of its energy
# that the layer stores, d ln B / d ln G_c.


SANDWICH_FAMILY = "Sandwich beam"
LAYER = Material(name="silicone", density=1100.0, youngs_modulus=3e6, poisson_ratio=0.49)
LENGTH, WIDTH, THICKNESS, LAYER_THICKNESS = 1.0, 0.06, 4.5e-3, 0.5e-3
"""[m]"""

SANDWICH_ELEMENTS = {Mesh.FAST: 16, Mesh.FINE: 32}
Z, BETA = 2, 4


def stiffness(k: float, shear_modulus: complex) -> complex:
    """B(k) times the width [N m²]."""
    t, s = (THICKNESS - LAYER_THICKNESS) / 2, LAYER_THICKNESS
    g = 2 * shear_modulus / (207e9 * t * s * k**2)
    return WIDTH * (207e9 * t**3 / 6 + 207e9 * t * (t + s) ** 2 / 2 * g / (1 + g))


def shear_modulus() -> float:
    """Of the layer [Pa]."""
    return 3e6 / (2 * (1 + 0.49))


def sandwich_closed_form(number: int) -> float:
    """Frequency [Hz] of mode `number`."""
    k = number * np.pi / LENGTH
    mass = WIDTH * (STEEL.density * (THICKNESS - LAYER_THICKNESS) + LAYER.density * LAYER_THICKNESS)
    return float(k**2 / (2 * np.pi) * np.sqrt(abs(stiffness(k, shear_modulus())) / mass))


@once
def _sandwich_modes(mesh: Mesh) -> tuple[Array, Array]:
    """Frequencies [Hz] and the layer's share of the energy of each mode."""
    from scipy.linalg import eigh

    elements = SANDWICH_ELEMENTS[mesh]
    section = sandwich(WIDTH, THICKNESS, LAYER_THICKNESS, STEEL, LAYER, ("bottom", "layer", "top"))
    nodes, numbers = np.linspace([0, 0, 0], [LENGTH, 0, 0], elements + 1), tuple(range(elements + 1))
    member = Member(nodes=numbers, section=section, z_axis=np.array([0.0, 0.0, 1.0]))
    frame = assemble(Plan(nodes=nodes, carriers=numbers, members=(member,)))
    # Deflection but for the ends, rotation in the plane, and every slip
    free_nodes = len(frame.moving)
    bending = [6 * node + dof for node in range(free_nodes) for dof in (Z, BETA) if dof == BETA or 0 < node < free_nodes - 1]
    kept = np.array([*bending, *range(6 * free_nodes, len(frame.mass))])
    free = np.ix_(kept, kept)
    K, M = sum(frame.stiffness.values(), np.zeros_like(frame.mass))[free], frame.mass[free]
    squares, shapes = eigh(K, M, subset_by_index=[0, MODES - 1])
    stored = np.einsum("ir,ij,jr->r", shapes, frame.stiffness["layer"][free], shapes)
    return np.sqrt(squares) / (2 * np.pi), stored / squares


def _frequency(number: int, mesh: Mesh) -> Found:
    return Found(sandwich_closed_form(number), float(_sandwich_modes(mesh)[0][number - 1]))


def _share(number: int, mesh: Mesh) -> Found:
    # Share of the strain energy of mode `number` that the layer stores [1]
    k, step = number * np.pi / LENGTH, 1e-30
    B = stiffness(k, shear_modulus() * (1 + 1j * step))  # a complex step: the derivative without a difference
    return Found(float(B.imag / B.real / step), float(_sandwich_modes(mesh)[1][number - 1]))


SOURCE = "Mead and Markus (1969), simply supported"

SANDWICH_CHECKS: tuple[Check, ...] = tuple(
    check
    for k in range(1, MODES + 1)
    for check in (
        Check(
            family=SANDWICH_FAMILY,
            what=f"Simply supported sandwich, mode {k}",
            source=f"{SOURCE}; without rotary inertia",
            unit="Hz",
            bar=5e-4,
            find=partial(_frequency, k),
        ),
        Check(
            family=SANDWICH_FAMILY,
            what=f"Simply supported sandwich, mode {k}: energy in the layer",
            source=SOURCE,
            unit="",
            bar=2e-3,
            find=partial(_share, k),
        ),
    )
)
