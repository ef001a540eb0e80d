"""Rows about the dynamic mass: sign and rigid limit, a cantilever on a moving clamp in closed form, and what truncation costs.

The beam rows compare whole complex matrices: the error is the largest entry of the difference over all lines, every entry divided
by the largest size that the entries on its row's and its column's diagonals reach, so that kilograms and kilogram metres squared
weigh the same.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.beam import structure
from fem.damping import Damping
from fem.dynamic_mass import direct, modal
from fem.modes import Modes, fixed_base
from fem.section import Section
from fem.solid.model import of_mesh
from fem.structure import Structure
from geometry.arrays import Array
from geometry.articles import built_in
from geometry.dynamic_mass import ComplexArray
from geometry.inertia import Inertia
from geometry.multibody import inertia
from validation.verification import beams
from validation.verification import closed_form_beams as closed
from validation.verification.check import Check, Error, Found, Mesh, once, order
from validation.verification.grids import PART, block
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
    modes = fixed_base(of_mesh(grid, {PART: steel(0.3)}, cached=False), 20)
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
    beam = closed.Beam(length=LENGTH, bending=section.bending_y * (1 + 1j * LOSS_FACTOR), mass=section.mass)
    expected = closed.base_driven(beam, BENDING_LINES)
    return Found(0.0, largest(_driven(section, beams.BENDING, BENDING_LINES, mesh) - expected, expected))


def _driven_rod(motion: str, mesh: Mesh) -> Found:
    stiffness, inertia = beams.rod_constants(beams.ROD, motion)
    speed = np.sqrt(stiffness * (1 + 1j * LOSS_FACTOR) / inertia)
    expected = closed.rod_dynamic_mass(inertia * LENGTH, speed, LENGTH, ROD_LINES)[:, None, None]
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
