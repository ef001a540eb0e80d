"""Sections of beams: stiffness and inertia per unit length, from a rectangle or a tube of a material.

Shear coefficients are Cowper's (The Shear Coefficient in Timoshenko's Beam Theory, J. Appl. Mech. 33, 1966), those of a section
whose end load is distributed as in Saint-Venant's solution. Hutchinson's (J. Appl. Mech. 68, 2001), which fit the dispersion of
long waves, differ from them by a few per cent and depend on the rectangle's aspect; on slender members the two cannot be told
apart.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.moduli import moduli
from geometry.errors import BadInput
from geometry.materials import Material


@dataclass(frozen=True, eq=False, kw_only=True)
class Section:
    """Stiffness and inertia of a beam per unit length, in the section's own axes y, z.

    Attributes
    ----------
    axial : E A [N]
    torsion : G J [N m²]
    bending_y, bending_z : E I about the section's y and z axes [N m²]
    shear_y, shear_z : k G A along the section's y and z axes [N]; infinite for a beam without shear deformation
    mass : [kg/m]
    rotary_y, rotary_z : rho I about the section's y and z axes [kg m]; their sum is the polar inertia
    """

    axial: float
    torsion: float
    bending_y: float
    bending_z: float
    mass: float
    rotary_y: float
    rotary_z: float
    shear_y: float = float("inf")
    shear_z: float = float("inf")


def rectangle(width: float, thickness: float, material: Material) -> Section:
    """Solid rectangle, `width` [m] along y and `thickness` [m] along z.

    Raises
    ------
    BadInput : a size that is not positive, or a material without moduli.
    """
    require_positive(width=width, thickness=thickness)
    E, G = moduli(material)
    area, Iy, Iz = width * thickness, width * thickness**3 / 12, thickness * width**3 / 12
    shear = cowper_rectangle(E / (2 * G) - 1) * G * area
    return Section(
        axial=E * area,
        torsion=G * rectangle_torsion(width, thickness),
        bending_y=E * Iy,
        bending_z=E * Iz,
        shear_y=shear,
        shear_z=shear,
        mass=material.density * area,
        rotary_y=material.density * Iy,
        rotary_z=material.density * Iz,
    )


def tube(outer_diameter: float, inner_diameter: float, material: Material) -> Section:
    """Circular tube [m]; a solid rod with `inner_diameter` 0.

    Raises
    ------
    BadInput : the tube has no wall, or its material no moduli.
    """
    require_positive(outer_diameter=outer_diameter)
    if not 0 <= inner_diameter < outer_diameter:
        raise BadInput(
            source="section of a tube",
            field="inner_diameter",
            problem=f"must lie between 0 and the outer diameter {outer_diameter:g} m, found {inner_diameter:g} m",
            remedy="Check both diameters",
        )
    E, G = moduli(material)
    area = np.pi / 4 * (outer_diameter**2 - inner_diameter**2)
    second = np.pi / 64 * (outer_diameter**4 - inner_diameter**4)
    shear = cowper_tube(E / (2 * G) - 1, inner_diameter / outer_diameter) * G * area
    return Section(
        axial=E * area,
        torsion=2 * G * second,
        bending_y=E * second,
        bending_z=E * second,
        shear_y=shear,
        shear_z=shear,
        mass=material.density * area,
        rotary_y=material.density * second,
        rotary_z=material.density * second,
    )


def cowper_rectangle(nu: float) -> float:
    """Shear coefficient of a rectangle of any aspect: 10 (1 + nu) / (12 + 11 nu)."""
    return 10 * (1 + nu) / (12 + 11 * nu)


def cowper_tube(nu: float, ratio: float) -> float:
    """Shear coefficient of a circular tube with inner over outer diameter `ratio`; 0 is the solid rod, near 1 the thin tube."""
    square = (1 + ratio**2) ** 2
    return 6 * (1 + nu) * square / ((7 + 6 * nu) * square + (20 + 12 * nu) * ratio**2)


def rectangle_torsion(a: float, b: float) -> float:
    """Saint-Venant's torsion constant J [m⁴] of a rectangle `a` x `b`: his series, of which 1e-8 is left out.

    Source: Timoshenko and Goodier, Theory of Elasticity, article 109.
    """
    long, short = max(a, b), min(a, b)
    n = np.arange(1, 60, 2)
    series = np.sum(np.tanh(n * np.pi * long / (2 * short)) / n**5)
    return float(long * short**3 / 3 * (1 - 192 / np.pi**5 * short / long * series))


def require_positive(**sizes: float) -> None:
    """Refuse a section with a size [m] that is not positive and finite."""
    for name, size in sizes.items():
        if not 0 < size < float("inf"):
            raise BadInput(
                source="section of a beam",
                field=name,
                problem=f"must be positive and finite, found {size:g} m",
                remedy="Check the dimensions and their unit",
            )
