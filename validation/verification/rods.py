"""Rows about the way from an article to its modes: a round rod, drawn, meshed by gmsh and clamped at its foot.

Torsion of a round rod warps no section, so that the wave equation is exact in space and at the clamp.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from fem.modes import Modes, fixed_base
from fem.section import cowper_tube
from fem.solid.model import structure
from fem.solid.sizing import Sizing
from fem.structure import Structure
from geometry.article import Article, Part
from geometry.materials import Material
from geometry.shapes import Cylinder, Shape, upright
from validation.verification import closed_form_beams as closed
from validation.verification.check import Check, Found, Mesh, once

FAMILY = "Article, mesh and modes"

DIAMETER, LENGTH = 0.05, 0.4
"""[m]"""

STEEL = Material(name="steel", density=7850.0, youngs_modulus=207e9, poisson_ratio=0.3)
FINENESS = {Mesh.FAST: 2.0, Mesh.FINE: 3.0}
MOVES = 0.01
"""Share of the rod's polar or rigid mass from which a mode counts as twisting or bending."""

X, GAMMA = 0, 5


def article() -> Article:
    """The rod, upright."""
    shape = Shape(solids=(upright(Cylinder(diameter=DIAMETER, height=LENGTH), bottom=0.0),))
    return Article(name="rod", parts=(Part(name="rod", material=STEEL, shape=shape),))


@once
def _rod(mesh: Mesh) -> Structure:
    return structure(article(), Sizing(fineness=FINENESS[mesh]))


@once
def _modes(mesh: Mesh) -> Modes:
    return fixed_base(_rod(mesh), 12)


def _shear_modulus() -> float:
    return 207e9 / (2 * (1 + 0.3))


def _mass(mesh: Mesh) -> Found:
    return Found(STEEL.density * np.pi / 4 * DIAMETER**2 * LENGTH, float(_rod(mesh).rigid_mass[0, 0]))


def _polar(mesh: Mesh) -> Found:
    mass = STEEL.density * np.pi / 4 * DIAMETER**2 * LENGTH
    return Found(mass * DIAMETER**2 / 8, float(_rod(mesh).rigid_mass[GAMMA, GAMMA]))


def _torsion(number: int, mesh: Mesh) -> Found:
    modes, speed = _modes(mesh), np.sqrt(_shear_modulus() / STEEL.density)
    twists = modes.effective_mass[:, GAMMA] > MOVES * modes.rigid_mass[GAMMA, GAMMA]
    return Found(float(closed.rod_fixed_free(speed, LENGTH, number)[-1]), float(modes.frequency[twists][number - 1]))


def _bending(mesh: Mesh) -> Found:
    area, second = np.pi / 4 * DIAMETER**2, np.pi / 64 * DIAMETER**4
    beam = closed.Beam(
        length=LENGTH,
        bending=207e9 * second,
        shear=cowper_tube(0.3, 0.0) * _shear_modulus() * area,
        mass=STEEL.density * area,
        rotary=STEEL.density * second,
    )
    return Found(float(closed.timoshenko_cantilever(beam, 1)[0]), float(_modes(mesh).frequency[0]))


CHECKS: tuple[Check, ...] = (
    Check(family=FAMILY, what="Round rod by gmsh: mass", source="rho pi d² L / 4", unit="kg", bar=5e-4, find=_mass),
    Check(
        family=FAMILY, what="Round rod by gmsh: inertia about its axis", source="m d² / 8", unit="kg m²", bar=1e-3, find=_polar
    ),
    *(
        Check(
            family=FAMILY,
            what=f"Round rod by gmsh, one end clamped: torsion, mode {k}",
            source="(2 k - 1) c / (4 L), c² = G / rho, exact in space",
            unit="Hz",
            bar=2e-3,
            find=partial(_torsion, k),
        )
        for k in (1, 2)
    ),
    Check(
        family=FAMILY,
        what="Round rod by gmsh, one end clamped: bending, mode 1",
        source="Timoshenko's frequency equation, which knows of no clamped face",
        unit="Hz",
        bar=1e-2,
        find=_bending,
    ),
)
