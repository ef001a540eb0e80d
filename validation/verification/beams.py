"""Rows about beam elements: a bar that lies askew in space, bent, stretched and twisted, against closed forms.

The bar lies along no axis of the frame, so every row passes through the rotation of the elements as well.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace
from functools import partial

import numpy as np

from fem.frame import Member, Plan, assemble
from fem.section import Section, rectangle, tube
from fem.structure import Structure
from geometry.arrays import Array
from geometry.frames import rigid_transformation_6
from geometry.materials import Material
from validation.verification import closed_form_beams as closed
from validation.verification.check import Check, Error, Found, Mesh, once, order
from validation.verification.solutions import frequencies

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
        beam = closed.Beam(
            length=length, bending=section.bending_y, shear=section.shear_z, mass=section.mass, rotary=section.rotary_y
        )
        if not np.isfinite(section.shear_z):
            return (closed.euler_bernoulli_cantilever if clamped else closed.euler_bernoulli_free)(beam, count)
        return (closed.timoshenko_cantilever if clamped else closed.timoshenko_free)(beam, count)
    stiffness, inertia = rod_constants(section, motion)
    return closed.rod_fixed_free(np.sqrt(stiffness / inertia), length, count)


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
    return Found(0.0, _largest_share(frame.rigid.T @ frame.mass @ frame.rigid - expected, expected))


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


def _largest_share(difference: Array, whole: Array) -> float:
    scale = np.sqrt(np.diag(whole))
    return float(np.max(np.abs(difference) / np.outer(scale, scale)))


def _row(what: str, source: str, bar: float, find: Callable[[Mesh], Found], unit: str = "Hz") -> Check:
    return Check(family=FAMILY, what=what, source=source, unit=unit, bar=bar, find=find)


def _modes(words: str, source: str, bar: float, case: Case) -> list[Check]:
    return [_row(f"{words}, mode {k}", source, bar, partial(_mode, case, k)) for k in range(1, MODES + 1)]


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
