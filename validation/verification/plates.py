"""Rows about the NAFEMS plates FV12 and FV52, of hexahedra; the published values themselves are checked against a second source.

FV12 is a free square plate, 10 x 10 x 0.05 m, that bends. Its published values for modes 4 to 6 agree with Ritz's method to the
last digit; those for modes 7 to 9 (4.233, 4.233 and 7.416 Hz) do not. Ritz's method approaches a thin plate from above and has
4.190 and 7.356 Hz, so a thin plate cannot have the published ones. Those rows are held against Ritz. A solid plate is softer at
its free edges than a thin one, by a share of the order of thickness over side: up to 0.1 % here.

FV52 is a thick plate, 10 x 10 x 1 m, whose lower edges are held along z. Its bending depends on the mesh: a line is too thin to
hold a solid by, and the finer the elements, the softer the support. Its motion in the plane hardly does. Modes 8 to 10 are
published, Ritz's method in plane stress confirms them, and of Lamé's motion, which moves nothing along z, the frequency is a
closed form.

Published: The Standard NAFEMS Benchmarks, TNSB Rev. 3, 1990, tests FV12 and FV52; the values as the verification manuals of
OptiStruct (OS-V 0420 and 0455) and Ansys (VMC5) repeat them.
"""

from __future__ import annotations

from collections.abc import Callable
from functools import partial

import numpy as np

from fem.eigen import floating_shift, lowest
from fem.solid.mesh import SolidMesh
from geometry.arrays import Array
from geometry.materials import Material
from validation.verification import ritz
from validation.verification.check import Check, Found, Mesh, once
from validation.verification.grids import block
from validation.verification.solids import lame_frequency
from validation.verification.solutions import floating, solid

FAMILY = "NAFEMS plates"

STEEL = Material(name="steel", density=8000.0, youngs_modulus=200e9, poisson_ratio=0.3)
SIDE, THIN, THICK = 10.0, 0.05, 1.0
"""[m]"""

FV12 = {4: 1.622, 5: 2.360, 6: 2.922, 7: 4.233, 8: 4.233, 9: 7.416}
FV52 = {8: 193.59, 9: 206.19, 10: 206.19}
"""Published frequencies [Hz] by the number of the mode, three rigid ones counted."""

FV12_CONFIRMED = (4, 5, 6)

THIN_CELLS = {Mesh.FAST: (8, 16), Mesh.FINE: (12, 24)}
"""Cells along a side of two meshes: hexahedra so flat have an error that falls with the square of their size, not with its fourth
power, and their frequencies are extrapolated with that."""

THICK_CELLS = {Mesh.FAST: (6, 6, 1), Mesh.FINE: (10, 10, 2)}

DEGREE = 14
FREE_MODES = 3
"""Rigid motions of a plate that bends, and of one that moves in its plane."""

IN_PLANE = 0.5
"""Share of the kinetic energy across the thickness below which a motion is in the plane."""


@once
def thin_ritz() -> Array:
    """FV12 without elements (8,) [Hz]."""
    return ritz.thin_plate(SIDE, THIN, 200e9, 0.3, 8000.0, degree=DEGREE, count=8)


@once
def in_plane_ritz() -> Array:
    """FV52's plate in its plane without elements (8,) [Hz]: two stretching modes, a pair, Lamé's, ..."""
    return ritz.in_plane(SIDE, 200e9, 0.3, 8000.0, degree=DEGREE, count=8)


@once
def _thin(mesh: Mesh) -> Array:
    """Elastic frequencies (6,) [Hz] of the free plate of hexahedra, extrapolated to cells without size."""
    coarse, fine = THIN_CELLS[mesh]
    value = _flat(fine)
    return np.asarray(value + (value - _flat(coarse)) / ((fine / coarse) ** 2 - 1))


def _flat(cells: int) -> Array:
    """The same on one mesh; all motion in the plane lies above."""
    matrices = solid(block((SIDE, SIDE, THIN), (cells, cells, 1)), STEEL)
    return np.asarray(np.sqrt(floating(matrices.stiffness, matrices.mass, 12).values[6:]) / (2 * np.pi))


@once
def _thick(mesh: Mesh) -> Array:
    """In-plane elastic frequencies [Hz] of the plate of hexahedra whose lower edges are held along z."""
    grid = block((SIDE, SIDE, THICK), THICK_CELLS[mesh])
    matrices = solid(grid, STEEL)
    free = np.setdiff1d(np.arange(matrices.mass.shape[0]), _held(grid))
    K, M = (matrix[free][:, free] for matrix in (matrices.stiffness, matrices.mass))
    pairs = lowest(K, M, 18, shift=floating_shift(K, M))
    across = np.flatnonzero(free % 3 == 2)
    share = np.sum((pairs.vectors * (M @ pairs.vectors))[across], axis=0)
    return np.asarray(np.sqrt(pairs.values[FREE_MODES:][share[FREE_MODES:] < IN_PLANE]) / (2 * np.pi))


def _held(grid: SolidMesh) -> Array:
    """Degrees of freedom along z on the four lower edges."""
    x, y, z = grid.points.T
    edge = np.isin(x, (0, SIDE)) | np.isin(y, (0, SIDE))
    return np.asarray(3 * np.flatnonzero(edge & (z == 0)) + 2)


def _published_thin(number: int, mesh: Mesh) -> Found:
    return Found(FV12[number], float(thin_ritz()[number - FREE_MODES - 1]))


def _thin_mode(number: int, mesh: Mesh) -> Found:
    ritz_value = float(thin_ritz()[number - FREE_MODES - 1])
    reference = FV12[number] if number in FV12_CONFIRMED else ritz_value
    return Found(reference, float(_thin(mesh)[number - FREE_MODES - 1]))


def _published_thick(number: int, mesh: Mesh) -> Found:
    return Found(FV52[number], float(in_plane_ritz()[number - 8]))


def _thick_mode(number: int, mesh: Mesh) -> Found:
    return Found(FV52[number], float(_thick(mesh)[number - 8]))


def _thick_lame(mesh: Mesh) -> Found:
    reference = lame_frequency(SIDE, STEEL)
    found = _thick(mesh)
    return Found(reference, float(found[np.argmin(np.abs(found - reference))]))


def _row(what: str, source: str, bar: float, find: Callable[[Mesh], Found]) -> Check:
    return Check(family=FAMILY, what=what, source=source, unit="Hz", bar=bar, find=find)


def _thin_source(number: int) -> str:
    if number in FV12_CONFIRMED:
        return "NAFEMS FV12, confirmed by Ritz's method"
    return f"Ritz's method; NAFEMS prints {FV12[number]:g} Hz, which nothing confirms"


CHECKS: tuple[Check, ...] = (
    *(
        _row(
            f"FV12 mode {k}: Ritz's method, degree {DEGREE}",
            "NAFEMS FV12, rounded to 0.0005 Hz",
            5e-4,
            partial(_published_thin, k),
        )
        for k in FV12_CONFIRMED
    ),
    *(_row(f"FV12 mode {k}: hexahedra, two meshes extrapolated", _thin_source(k), 1e-3, partial(_thin_mode, k)) for k in FV12),
    *(
        _row(f"FV52 mode {k} in the plane: Ritz's method, degree {DEGREE}", "NAFEMS FV52", 1e-4, partial(_published_thick, k))
        for k in FV52
    ),
    *(
        _row(f"FV52 mode {k} in the plane: hexahedra", "NAFEMS FV52, confirmed by Ritz's method", 1e-3, partial(_thick_mode, k))
        for k in FV52
    ),
    _row("FV52 in the plane, Lamé's motion: hexahedra", "sqrt(G / rho) / (sqrt(2) a), exact in space (Lamé)", 1e-3, _thick_lame),
)
