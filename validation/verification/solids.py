"""Rows about solid elements, hexahedra of 27 nodes and tetrahedra of 10: bars and blocks whose frequencies have a closed form.

Without Poisson's ratio a clamped bar in tension is a rod to the last digit, and clamping its face disturbs no bending, so the bar
meets Timoshenko's beam closely; with it the clamped face is stiffer than any beam knows. Lamé's motion of a block with a square
face, u = cos(pi x / a) sin(pi y / a), v = -sin(pi x / a) cos(pi y / a), changes no volume and leaves all faces free of stress:
its frequency is exact for any Poisson's ratio and thickness (Lamé, Leçons sur la théorie mathématique de l'élasticité, 1852).
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from fem.modes import Modes, fixed_base
from fem.section import cowper_rectangle
from fem.solid.elasticity import lame
from fem.solid.model import of_mesh
from geometry.arrays import Array
from geometry.materials import Material
from validation.verification import closed_form_beams as closed
from validation.verification.check import Check, Error, Found, Mesh, once, order
from validation.verification.grids import HEX, PART, TET, block
from validation.verification.solutions import floating, solid

FAMILY = "Solid elements"

CELLS = {HEX: "hexahedra", TET: "tetrahedra"}
YOUNG = 207e9
BAR = (0.1, 0.12, 1.0)
"""Height, width and length [m] of the bar, which stands upright and bends along its height, x."""

CUBE = (1.0, 1.0, 0.3)
"""Sides [m] of the block in Lamé's motion."""

BAR_CELLS = {Mesh.FAST: (4, 2, 24), Mesh.FINE: (6, 3, 40)}
CUBE_CELLS = {HEX: (3, 4, 6), TET: (6, 8, 12)}
"""Cells along a side of the square face, in a study of convergence."""

BENDS = 0.8
"""Share of the kinetic energy along the height from which a motion of the free bar is bending, not torsion."""

MOVES = 0.01
"""Effective mass as a share of the bar's from which a mode counts as moving its base."""

X, Z = 0, 2
RIGID = 6


def steel(nu: float) -> Material:
    """Steel with another Poisson's ratio."""
    return Material(name="steel", density=7850.0, youngs_modulus=YOUNG, poisson_ratio=nu)


@once
def _bar(nodes: int, nu: float, mesh: Mesh) -> Modes:
    """Modes of the bar clamped at its foot."""
    return fixed_base(of_mesh(block(BAR, BAR_CELLS[mesh], nodes), {PART: steel(nu)}), 10)


@once
def _free_bar(nodes: int, nu: float, mesh: Mesh) -> Array:
    """Frequencies [Hz] with which the free bar bends along its height."""
    matrices = solid(block(BAR, BAR_CELLS[mesh], nodes), steel(nu))
    pairs = floating(matrices.stiffness, matrices.mass, 12)
    energy = (pairs.vectors * (matrices.mass @ pairs.vectors)).reshape(-1, 3, pairs.values.size).sum(axis=0)
    bends = (energy[X] > BENDS) & (np.arange(pairs.values.size) >= RIGID)
    return np.asarray(np.sqrt(pairs.values[bends]) / (2 * np.pi))


def _moving(modes: Modes, axis: int) -> Array:
    """Frequencies [Hz] of the modes that move their base along one axis."""
    return np.asarray(modes.frequency[modes.effective_mass[:, axis] > MOVES * modes.rigid_mass[axis, axis]])


def beam(nu: float) -> closed.Beam:
    """The bar as Timoshenko's beam."""
    height, width, length = BAR
    material, area, second = steel(nu), width * height, width * height**3 / 12
    E, G = YOUNG, YOUNG / (2 * (1 + nu))
    return closed.Beam(
        length=length,
        bending=E * second,
        shear=cowper_rectangle(nu) * G * area,
        mass=material.density * area,
        rotary=material.density * second,
    )


def _cantilever(nodes: int, nu: float, number: int, mesh: Mesh) -> Found:
    reference = closed.timoshenko_cantilever(beam(nu), number)[number - 1]
    return Found(float(reference), float(_moving(_bar(nodes, nu, mesh), X)[number - 1]))


def _free(nodes: int, number: int, mesh: Mesh) -> Found:
    reference = closed.timoshenko_free(beam(0.3), number)[number - 1]
    return Found(float(reference), float(_free_bar(nodes, 0.3, mesh)[number - 1]))


def _rod(nodes: int, mesh: Mesh) -> Found:
    reference = closed.rod_fixed_free(np.sqrt(YOUNG / steel(0.0).density), BAR[Z], 1)[0]
    return Found(float(reference), float(_moving(_bar(nodes, 0.0, mesh), Z)[0]))


def lame_frequency(side: float, material: Material) -> float:
    """Lamé's frequency [Hz] of a free block with a square face: shear wave speed over sqrt(2) times the side."""
    return float(np.sqrt(lame(material)[1] / material.density) / (np.sqrt(2) * side))


@once
def _lame(nodes: int, count: int) -> float:
    """Frequency [Hz] nearest to Lamé's of the free block in `count` cells along its square face."""
    matrices = solid(block(CUBE, (count, count, 1), nodes), steel(0.3))
    found = np.sqrt(np.maximum(floating(matrices.stiffness, matrices.mass, 16).values, 0)) / (2 * np.pi)
    return float(found[np.argmin(np.abs(found - lame_frequency(CUBE[0], steel(0.3))))])


def _lame_mode(nodes: int, mesh: Mesh) -> Found:
    cells = CUBE_CELLS[nodes][-1] * (2 if mesh is Mesh.FINE else 1)
    return Found(lame_frequency(CUBE[0], steel(0.3)), _lame(nodes, cells))


def _lame_order(nodes: int, mesh: Mesh) -> Found:
    reference = lame_frequency(CUBE[0], steel(0.3))
    errors = [_lame(nodes, n) / reference - 1 for n in CUBE_CELLS[nodes]]
    return Found(4.0, order([1 / n for n in CUBE_CELLS[nodes]], errors))


def _row(what: str, source: str, bar: float, find: Callable[[Mesh], Found]) -> Check:
    return Check(family=FAMILY, what=what, source=source, unit="Hz", bar=bar, find=find)


def _of(nodes: int) -> tuple[Check, ...]:
    cells = CELLS[nodes]
    return (
        *(
            _row(f"Cantilever of {cells}, no Poisson's ratio, mode {k}", TIMOSHENKO, 1e-3, partial(_cantilever, nodes, 0.0, k))
            for k in (1, 2, 3)
        ),
        _row(
            f"Cantilever of {cells}, Poisson's ratio 0.3, mode 1",
            f"{TIMOSHENKO}; it knows of no clamped face",
            1e-2,
            partial(_cantilever, nodes, 0.3, 1),
        ),
        *(
            _row(f"Free bar of {cells}, Poisson's ratio 0.3, mode {k}", TIMOSHENKO, 2e-3, partial(_free, nodes, k))
            for k in (1, 2)
        ),
        _row(
            f"Bar of {cells} in tension, no Poisson's ratio",
            "c / (4 L), c² = E / rho, exact in space",
            1e-5,
            partial(_rod, nodes),
        ),
        _row(f"Free block of {cells}, Lamé's motion", LAME, 2e-4, partial(_lame_mode, nodes)),
        Check(
            family=FAMILY,
            what=f"Free block of {cells}, Lamé's motion: order of convergence",
            source="quadratic displacement: eigenvalues of order 4 (Strang and Fix, chapter 6)",
            unit="",
            bar=0.25,
            find=partial(_lame_order, nodes),
            error=Error.ABSOLUTE,
        ),
    )


TIMOSHENKO = "Timoshenko's frequency equation, shear coefficient of Cowper (1966)"
LAME = "sqrt(G / rho) / (sqrt(2) a), exact in space (Lamé)"

CHECKS: tuple[Check, ...] = (*_of(HEX), *_of(TET))
