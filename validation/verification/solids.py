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

from fem.beam.elements import cowper_rectangle, cowper_tube
from fem.modes import Modes, fixed_base, floating_shift, lowest
from fem.solid.assembly import SolidMesh, lame
from fem.solid.model import of_mesh, structure
from fem.structure import Structure, rigid_motion
from geometry.article import Article, Cylinder, Material, Part, Shape, upright
from geometry.frames import Array
from geometry.inertia import Inertia
from validation.verification import closed_forms
from validation.verification.check import Check, Error, Found, Mesh, once, order
from validation.verification.closed_forms import HEX, PART, TET, block, floating, solid

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
    return fixed_base(of_mesh(block(BAR, BAR_CELLS[mesh], nodes), {PART: steel(nu)}, cached=False), 10)


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


def beam(nu: float) -> closed_forms.Beam:
    """The bar as Timoshenko's beam."""
    height, width, length = BAR
    material, area, second = steel(nu), width * height, width * height**3 / 12
    E, G = YOUNG, YOUNG / (2 * (1 + nu))
    return closed_forms.Beam(
        length=length,
        bending=E * second,
        shear=cowper_rectangle(nu) * G * area,
        mass=material.density * area,
        rotary=material.density * second,
    )


def _cantilever(nodes: int, nu: float, number: int, mesh: Mesh) -> Found:
    reference = closed_forms.timoshenko_cantilever(beam(nu), number)[number - 1]
    return Found(float(reference), float(_moving(_bar(nodes, nu, mesh), X)[number - 1]))


def _free(nodes: int, number: int, mesh: Mesh) -> Found:
    reference = closed_forms.timoshenko_free(beam(0.3), number)[number - 1]
    return Found(float(reference), float(_free_bar(nodes, 0.3, mesh)[number - 1]))


def _rod(nodes: int, mesh: Mesh) -> Found:
    reference = closed_forms.rod_fixed_free(np.sqrt(YOUNG / steel(0.0).density), BAR[Z], 1)[0]
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


# Rows about what any solid element must do: strain evenly when its edges do, resist no rigid motion, weigh what it weighs, and
# care for no unit.


ESSENTIALS_FAMILY = "Patch, rigid body, units"

SIDES = (1.0, 0.8, 0.6)
"""[m]"""

SHIFTED = 0.1
"""How far the points inside a patch lie from their regular places, as a share of a cell."""

STRAIN = np.array([[3.0, 1.0, -2.0], [1.0, -1.0, 0.5], [-2.0, 0.5, 2.0]]) * 1e-4


def distorted(nodes: int) -> SolidMesh:
    """Two cells along each side, the inner vertex and all edges and faces inside away from their regular places."""
    counts = (2, 2, 2)
    inner = np.random.default_rng(3)

    def bent(points: Array) -> Array:
        inside = np.all((points > 1e-9) & (points < np.array(SIDES) - 1e-9), axis=1)
        moves = inner.uniform(-SHIFTED, SHIFTED, points.shape) * np.array(SIDES) / counts
        return np.asarray(points + moves * inside[:, None])

    return block(SIDES, counts, nodes, bent)


def _patch(nodes: int) -> tuple[SolidMesh, Array, Array]:
    """The distorted mesh, its displacements under an even strain, and those that the elements find from the surface's alone."""
    from scipy.sparse.linalg import spsolve

    mesh = distorted(nodes)
    K = solid(mesh, steel(0.3)).stiffness.tocsc()
    exact = (mesh.points @ STRAIN).ravel()
    surface = np.any(np.isclose(mesh.points, 0) | np.isclose(mesh.points, SIDES), axis=1)
    inside = np.flatnonzero(np.repeat(~surface, 3))
    outside = np.flatnonzero(np.repeat(surface, 3))
    found = exact.copy()
    found[inside] = spsolve(K[inside][:, inside], -K[inside][:, outside] @ exact[outside])
    return mesh, exact, found


def _patch_displacement(nodes: int, mesh: Mesh) -> Found:
    _, exact, found = _patch(nodes)
    return Found(0.0, float(np.max(np.abs(found - exact)) / np.max(np.abs(exact))))


def _patch_energy(nodes: int, mesh: Mesh) -> Found:
    """Strain energy [J]: half of stress times strain times volume, and half of u^T K u."""
    patch, exact, _ = _patch(nodes)
    lam, mu = lame(steel(0.3))
    stress = lam * np.trace(STRAIN) * np.eye(3) + 2 * mu * STRAIN
    K = solid(patch, steel(0.3)).stiffness
    return Found(float(0.5 * np.sum(stress * STRAIN) * np.prod(SIDES)), float(0.5 * exact @ (K @ exact)))


def _rigid_force(nodes: int, mesh: Mesh) -> Found:
    patch = distorted(nodes)
    K, T = solid(patch, steel(0.3)).stiffness, _rigid(patch)
    return Found(0.0, float(np.max(np.abs(K @ T) / np.max(abs(K) @ np.abs(T), axis=0))))


def _rigid_modes(nodes: int, mesh: Mesh) -> Found:
    """Zero, and the sixth eigenvalue of the free body as a share of the seventh."""
    matrices = solid(distorted(nodes), steel(0.3))
    values = floating(matrices.stiffness, matrices.mass, 8).values
    return Found(0.0, float(np.max(np.abs(values[:6])) / values[6]))


def _rigid_count(nodes: int, mesh: Mesh) -> Found:
    matrices = solid(distorted(nodes), steel(0.3))
    values = floating(matrices.stiffness, matrices.mass, 12).values
    return Found(6.0, float(np.sum(values < 1e-6 * values[-1])))


def _rigid_mass(nodes: int, mesh: Mesh) -> Found:
    """Zero, and the largest deviation from the block's 6x6 mass matrix about its corner, as a share of its own entries' scale."""
    straight = block(SIDES, (2, 2, 2), nodes)  # the quadrature is exact for straight cells only
    T = _rigid(straight)
    mass = steel(0.3).density * float(np.prod(SIDES))
    a, b, c = SIDES
    tensor = np.diag([b * b + c * c, a * a + c * c, a * a + b * b]) * mass / 12
    expected = Inertia.from_cog(mass, np.array(SIDES) / 2, tensor).mass_matrix
    scale = np.sqrt(np.diag(expected))
    return Found(0.0, float(np.max(np.abs(T.T @ (solid(straight, steel(0.3)).mass @ T) - expected) / np.outer(scale, scale))))


def _rigid(mesh: SolidMesh) -> Array:
    return rigid_motion(mesh.points).reshape(-1, 6, 6)[:, :3].reshape(-1, 6)


def _lowest(scale: float, material: Material, nodes: int) -> float:
    """Lowest elastic frequency of the free block whose sides are `scale` times `SIDES`."""
    matrices = solid(block([scale * side for side in SIDES], (2, 2, 2), nodes), material)
    return float(np.sqrt(floating(matrices.stiffness, matrices.mass, 8).values[6]) / (2 * np.pi))


def _scaled(nodes: int, mesh: Mesh) -> Found:
    """Lowest elastic frequency [Hz] of the block, and three times that of the block three times as long, wide and high."""
    return Found(_lowest(1.0, steel(0.3), nodes), 3 * _lowest(3.0, steel(0.3), nodes))


def _millimetres(nodes: int, mesh: Mesh) -> Found:
    """Lowest elastic frequency [Hz] in metres, kilograms and pascals, and in millimetres, tonnes and megapascals."""
    other = Material(name="steel", density=7850e-12, youngs_modulus=YOUNG / 1e6, poisson_ratio=0.3)
    return Found(_lowest(1.0, steel(0.3), nodes), _lowest(1e3, other, nodes))


def _essentials_row(what: str, source: str, unit: str, bar: float, find: Callable[[Mesh], Found], error: Error) -> Check:
    return Check(family=ESSENTIALS_FAMILY, what=what, source=source, unit=unit, bar=bar, find=find, error=error)


def _essentials_of(nodes: int) -> tuple[Check, ...]:
    cells = f"distorted {CELLS[nodes]}"

    def zero(what: str, source: str, bar: float, find: Callable[[int, Mesh], Found]) -> Check:
        return _essentials_row(what, source, "", bar, partial(find, nodes), Error.ABSOLUTE)

    def same(what: str, source: str, unit: str, bar: float, find: Callable[[int, Mesh], Found]) -> Check:
        return _essentials_row(what, source, unit, bar, partial(find, nodes), Error.RELATIVE)

    return (
        zero(f"Patch test of {cells}: displacement", "even strain prescribed on the surface", 1e-10, _patch_displacement),
        same(f"Patch test of {cells}: strain energy", "stress times strain times volume, halved", "J", 1e-10, _patch_energy),
        zero(f"Rigid motions of {cells}: force per stiffness and motion", "a rigid body is not strained", 1e-12, _rigid_force),
        zero(f"Rigid motions of {cells}: sixth eigenvalue over the seventh", "a free body has six", 1e-7, _rigid_modes),
        same(f"Rigid motions of {cells}: how many", "a free body has six", "", 0.0, _rigid_count),
        zero(f"Rigid mass matrix of {CELLS[nodes]}", "block about its corner, closed form", 1e-12, _rigid_mass),
        same(f"Block of {CELLS[nodes]}, three times as large", "frequency falls with the size", "Hz", 1e-8, _scaled),
        same(f"Block of {CELLS[nodes]} in mm, t and MPa", "the same in m, kg and Pa", "Hz", 1e-8, _millimetres),
    )


ESSENTIALS_CHECKS: tuple[Check, ...] = (*_essentials_of(HEX), *_essentials_of(TET))


# Rows about the NAFEMS plates FV12 and FV52, of hexahedra; the published values themselves are checked against a second source.
#
# FV12 is a free square plate, 10 x 10 x 0.05 m, that bends. Its published values for modes 4 to 6 agree with Ritz's method to
# the last digit; those for modes 7 to 9 (4.233, 4.233 and 7.416 Hz) do not. Ritz's method approaches a thin plate from above and
# has 4.190 and 7.356 Hz, so a thin plate cannot have the published ones. Those rows are held against Ritz. A solid plate is
# softer at its free edges than a thin one, by a share of the order of thickness over side: up to 0.1 % here.
#
# FV52 is a thick plate, 10 x 10 x 1 m, whose lower edges are held along z. Its bending depends on the mesh: a line is too thin
# to hold a solid by, and the finer the elements, the softer the support. Its motion in the plane hardly does. Modes 8 to 10 are
# published, Ritz's method in plane stress confirms them, and of Lamé's motion, which moves nothing along z, the frequency is a
# closed form.
#
# Published: The Standard NAFEMS Benchmarks, TNSB Rev. 3, 1990, tests FV12 and FV52; the values as the verification manuals of
# OptiStruct (OS-V 0420 and 0455) and Ansys (VMC5) repeat them.


PLATES_FAMILY = "NAFEMS plates"

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
    return closed_forms.thin_plate(SIDE, THIN, 200e9, 0.3, 8000.0, degree=DEGREE, count=8)


@once
def in_plane_ritz() -> Array:
    """FV52's plate in its plane without elements (8,) [Hz]: two stretching modes, a pair, Lamé's, ..."""
    return closed_forms.in_plane(SIDE, 200e9, 0.3, 8000.0, degree=DEGREE, count=8)


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
    # Degrees of freedom along z on the four lower edges
    x, y, z = grid.points.T
    edge = np.isin(x, (0, SIDE)) | np.isin(y, (0, SIDE))
    free = np.setdiff1d(np.arange(matrices.mass.shape[0]), np.asarray(3 * np.flatnonzero(edge & (z == 0)) + 2))
    K, M = (matrix[free][:, free] for matrix in (matrices.stiffness, matrices.mass))
    pairs = lowest(K, M, 18, shift=floating_shift(K, M))
    across = np.flatnonzero(free % 3 == 2)
    share = np.sum((pairs.vectors * (M @ pairs.vectors))[across], axis=0)
    return np.asarray(np.sqrt(pairs.values[FREE_MODES:][share[FREE_MODES:] < IN_PLANE]) / (2 * np.pi))


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


def _plates_row(what: str, source: str, bar: float, find: Callable[[Mesh], Found]) -> Check:
    return Check(family=PLATES_FAMILY, what=what, source=source, unit="Hz", bar=bar, find=find)


def _thin_source(number: int) -> str:
    if number in FV12_CONFIRMED:
        return "NAFEMS FV12, confirmed by Ritz's method"
    return f"Ritz's method; NAFEMS prints {FV12[number]:g} Hz, which nothing confirms"


PLATES_CHECKS: tuple[Check, ...] = (
    *(
        _plates_row(
            f"FV12 mode {k}: Ritz's method, degree {DEGREE}",
            "NAFEMS FV12, rounded to 0.0005 Hz",
            5e-4,
            partial(_published_thin, k),
        )
        for k in FV12_CONFIRMED
    ),
    *(
        _plates_row(f"FV12 mode {k}: hexahedra, two meshes extrapolated", _thin_source(k), 1e-3, partial(_thin_mode, k))
        for k in FV12
    ),
    *(
        _plates_row(
            f"FV52 mode {k} in the plane: Ritz's method, degree {DEGREE}", "NAFEMS FV52", 1e-4, partial(_published_thick, k)
        )
        for k in FV52
    ),
    *(
        _plates_row(
            f"FV52 mode {k} in the plane: hexahedra", "NAFEMS FV52, confirmed by Ritz's method", 1e-3, partial(_thick_mode, k)
        )
        for k in FV52
    ),
    _plates_row(
        "FV52 in the plane, Lamé's motion: hexahedra", "sqrt(G / rho) / (sqrt(2) a), exact in space (Lamé)", 1e-3, _thick_lame
    ),
)


# Rows about the way from an article to its modes: a round rod, drawn, meshed by gmsh and clamped at its foot.
#
# Torsion of a round rod warps no section, so that the wave equation is exact in space and at the clamp.


RODS_FAMILY = "Article, mesh and modes"

DIAMETER, LENGTH = 0.05, 0.4
"""[m]"""

RODS_STEEL = Material(name="steel", density=7850.0, youngs_modulus=207e9, poisson_ratio=0.3)
FINENESS = {Mesh.FAST: 2.0, Mesh.FINE: 3.0}

RODS_X, GAMMA = 0, 5


def article() -> Article:
    """The rod, upright."""
    shape = Shape(solids=(upright(Cylinder(diameter=DIAMETER, height=LENGTH), bottom=0.0),))
    return Article(name="rod", parts=(Part(name="rod", material=RODS_STEEL, shape=shape),))


@once
def _rods_rod(mesh: Mesh) -> Structure:
    return structure(article(), fineness=FINENESS[mesh], cached=False)


@once
def _modes(mesh: Mesh) -> Modes:
    return fixed_base(_rods_rod(mesh), 12)


def _shear_modulus() -> float:
    return 207e9 / (2 * (1 + 0.3))


def _mass(mesh: Mesh) -> Found:
    return Found(RODS_STEEL.density * np.pi / 4 * DIAMETER**2 * LENGTH, float(_rods_rod(mesh).rigid_mass[0, 0]))


def _polar(mesh: Mesh) -> Found:
    mass = RODS_STEEL.density * np.pi / 4 * DIAMETER**2 * LENGTH
    return Found(mass * DIAMETER**2 / 8, float(_rods_rod(mesh).rigid_mass[GAMMA, GAMMA]))


def _torsion(number: int, mesh: Mesh) -> Found:
    modes, speed = _modes(mesh), np.sqrt(_shear_modulus() / RODS_STEEL.density)
    twists = modes.effective_mass[:, GAMMA] > MOVES * modes.rigid_mass[GAMMA, GAMMA]
    return Found(float(closed_forms.rod_fixed_free(speed, LENGTH, number)[-1]), float(modes.frequency[twists][number - 1]))


def _bending(mesh: Mesh) -> Found:
    area, second = np.pi / 4 * DIAMETER**2, np.pi / 64 * DIAMETER**4
    beam = closed_forms.Beam(
        length=LENGTH,
        bending=207e9 * second,
        shear=cowper_tube(0.3, 0.0) * _shear_modulus() * area,
        mass=RODS_STEEL.density * area,
        rotary=RODS_STEEL.density * second,
    )
    return Found(float(closed_forms.timoshenko_cantilever(beam, 1)[0]), float(_modes(mesh).frequency[0]))


RODS_CHECKS: tuple[Check, ...] = (
    Check(family=RODS_FAMILY, what="Round rod by gmsh: mass", source="rho pi d² L / 4", unit="kg", bar=5e-4, find=_mass),
    Check(
        family=RODS_FAMILY,
        what="Round rod by gmsh: inertia about its axis",
        source="m d² / 8",
        unit="kg m²",
        bar=1e-3,
        find=_polar,
    ),
    *(
        Check(
            family=RODS_FAMILY,
            what=f"Round rod by gmsh, one end clamped: torsion, mode {k}",
            source="(2 k - 1) c / (4 L), c² = G / rho, exact in space",
            unit="Hz",
            bar=2e-3,
            find=partial(_torsion, k),
        )
        for k in (1, 2)
    ),
    Check(
        family=RODS_FAMILY,
        what="Round rod by gmsh, one end clamped: bending, mode 1",
        source="Timoshenko's frequency equation, which knows of no clamped face",
        unit="Hz",
        bar=1e-2,
        find=_bending,
    ),
)
