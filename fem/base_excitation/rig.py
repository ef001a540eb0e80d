"""`Rig`: what stands on the table, from the table up - load cells, cover plate, flange joint, article - and what is attached.

    table --[cells]-- cover plate (FMD's moving part, about F) --[flange joint]-- article (reduced, about its own origin)

Without an FMD the article stands on the table and F is its origin. A rig is data; `linear` and exudyn each make their own
equations of it. Everything linear is understood by both; gaps and friction by exudyn alone.
"""

import sys
from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from math import pi
from types import MappingProxyType
from typing import Literal

import numpy as np
import numpy.typing as npt

from fem.damping import symmetric
from fem.modes import Modes, Reduced, craig_bampton, static_shapes
from fem.structure import Structure, hold
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array, freeze, frozen, rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia, require_physical
from geometry.toml_file import nearest

LATERAL = ("x", "y")


@dataclass(frozen=True, eq=False, kw_only=True)
class FlexibleBody:
    """A flexible article, reduced to the six motions of its base and some coordinates of its own.

    Attributes
    ----------
    name : of the article
    reduced : interface of six about the article's origin; viscous damping only (a time response knows no i in K + i S)
    kept : (m,) [Hz] frequencies of the fixed-base modes that it keeps; further coordinates, if any, carry what the others
        answer statically
    places : (3, 6 + n) what each coordinate does to a named place, along x, y, z
    """

    name: str
    reduced: Reduced
    kept: Array
    places: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        size = self.reduced.mass.shape[0]
        freeze(self, "kept")
        object.__setattr__(
            self, "places", MappingProxyType({name: frozen(a, (3, size), f"places.{name}") for name, a in self.places.items()})
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class LoadCell:
    """A three-component load cell between table and cover plate.

    Attributes
    ----------
    position : (3,) [m] from F
    stiffness : (3,) [N/m] along x, y, z
    damping : (3,) [N s/m]
    preload : [N] by which it is pressed together, at which it lifts off; None for a cell that never does
    """

    position: Array
    stiffness: Array
    damping: Array = field(default_factory=lambda: np.zeros(3))
    preload: float | None = None

    def __post_init__(self) -> None:
        freeze(self, position=(3,), stiffness=(3,), damping=(3,))


@dataclass(frozen=True, eq=False, kw_only=True)
class Flange:
    """Compliance of the joint between what carries the article and the article, at the article's origin.

    Attributes
    ----------
    compliance : (6,) x, y, z [m/N], alpha, beta, gamma [rad/(N m)]; 0 is rigid
    damping_time : [s] damping of the joint over its stiffness
    """

    compliance: Array
    damping_time: float = 0.0

    def __post_init__(self) -> None:
        freeze(self, compliance=(6,))


@dataclass(frozen=True, eq=False, kw_only=True)
class Strut:
    """A spring and a damper from a place of the article to the ground (a cable) or to the table (local damping).

    Attributes
    ----------
    place : as the article's `FlexibleBody.places` names it
    to : "ground" or "table"
    stiffness : (3,) [N/m] along x, y, z
    damping : (3,) [N s/m]
    """

    place: str
    to: Literal["ground", "table"] = "ground"
    stiffness: Array = field(default_factory=lambda: np.zeros(3))
    damping: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        freeze(self, stiffness=(3,), damping=(3,))


@dataclass(frozen=True, kw_only=True)
class Friction:
    """A loose part on the flange, held along one lateral axis by nothing but Coulomb friction.

    Attributes
    ----------
    axis : "x" or "y"
    slip_force : [N] at which it slips
    mass : [kg]
    """

    axis: Literal["x", "y"]
    slip_force: float
    mass: float = 2.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Rig:
    """A set-up on the table.

    Attributes
    ----------
    article : what is tested
    cover : inertia of the FMD's moving part about F; None without an FMD
    seat : (3,) [m] the article's origin from F
    cells : load cells between table and cover plate; none when the cover plate is rigid on the table
    flange : None for a rigid joint
    struts, frictions : what is attached
    """

    article: FlexibleBody
    cover: Inertia | None = None
    seat: Array = field(default_factory=lambda: np.zeros(3))
    cells: tuple[LoadCell, ...] = ()
    flange: Flange | None = None
    struts: tuple[Strut, ...] = ()
    frictions: tuple[Friction, ...] = ()

    def __post_init__(self) -> None:
        freeze(self, seat=(3,))

    @property
    def linear(self) -> bool:
        """Whether its answer grows in proportion to what drives it."""
        return not self.frictions and all(cell.preload is None for cell in self.cells)


# `FlexibleBody` from a structure and its modes, from modal data alone, or rigid: what stands on a base that moves in time.
#
# A structure's kept modes are joined by up to six static answers to accelerations of the base (`fem.modes`), so the
# truncated modes need no term of their own: the body answers as the full structure does up to the fourth power of the frequency.
# Modes without shapes bring their residual mass R instead; up to six further modes then carry just that R.
#
# A response in time knows no i in K + i S. Structural damping becomes viscous, C_rs += S_rs / sqrt(omega_r omega_s): right at
# resonance and within a cluster, and of the order of the loss factor wrong in phase between resonances. Where a lossy part makes
# the truncated modes give way, the real part of the condensed stiffness is kept (`fem.modes`). Against the direct solution
# with K + i S, the greatest difference of Clumod's dynamic mass at any line from 4 to 32 Hz is 0.5 % (one blade) and 0.9 %
# (four, one with a silicone layer; 1.9 % without the condensation) of the largest entry there. The static coordinates lose as
# much as the kept modes do on average: they follow the base quietly, and must only not ring on.

Places = Mapping[str, npt.ArrayLike]
"""(3,) [m] by name, in the article's frame."""

NOWHERE: Places = MappingProxyType({})

NEAR = 0.05
"""How far a place may lie from a point whose motion is known, as a share of the size of the structure."""

LEAVES = 0.8
"""Greatest share of the mass beside the kept modes that the carriers of R may take, in any direction: what stays with the base
keeps the mass matrix positive definite."""

FAR = 4.0
"""Times the highest kept frequency at which the carriers of R lie, where their mass allows it."""

NOTHING = 1e-12
"""Share of the mass that R may make up at the highest kept frequency and still be rounding."""

EXCESS = 1e-6
"""Share of the mass by which modes of printed digits may take more than there is."""


def flexible(name: str, structure: Structure, modes: Modes, *, places: Places = NOWHERE) -> FlexibleBody:
    """`structure` on its base, reduced to its `modes`, shapes included, and to what the others answer statically.

    A place moves with the base as a rigid body's point does, and beyond that as the nearest of the structure's points.

    Raises
    ------
    BadInput : modes without shapes or of another structure, a place with no point near it, factors that do not fit in memory.
    """
    if len(modes.shapes) != structure.mass.shape[0]:
        problem = (
            f"shapes on all {structure.mass.shape[0]} degrees of freedom of the structure are needed, found {len(modes.shapes)}"
        )
        raise BadInput(f"body {name}", "modes", problem, "Bring the modes of this structure, or use modal data alone")
    held = hold(structure)
    X = static_shapes(held.stiffness, held.mass, held.load, modes.shapes[held.free])
    squares, V = np.linalg.eigh(X.T @ (held.stiffness @ X))
    X = X @ V
    reduced = _reduced(modes, np.sqrt(squares), held.load.T @ X, structure.rigid, held.expand(X))
    rows = {}
    for place, at in places.items():
        # (3, 6 + n) what each coordinate does to `place`, (3,) [m] in the article's frame
        point = np.asarray(at, dtype=np.float64)
        distance = np.linalg.norm(structure.points - point, axis=1)
        size = float(np.linalg.norm(np.ptp(structure.points, axis=0))) if len(distance) else 0.0
        if distance.min(initial=np.inf) > NEAR * size:
            found = f"the nearest is {1e3 * distance.min():.1f} mm away" if len(distance) else "it has none"
            problem = f"a point whose motion is known must lie within {1e3 * NEAR * size:.1f} mm, and {found}"
            remedy = "Give a place on the structure, in the article's frame in metres"
            raise BadInput(f"body {name}", f"places.{place}", problem, remedy)
        shapes = reduced.basis[structure.translations[int(np.argmin(distance))], 6:]
        rows[place] = np.hstack([rigid_transformation(point), shapes])
    return FlexibleBody(name=name, reduced=reduced, kept=modes.frequency, places=rows)


def of_modal_data(name: str, modes: Modes) -> FlexibleBody:
    """A body of which only frequencies, damping, participation and the rigid 6x6 are known; R is carried by further modes.

    With R V = M V diag(mu), V^T M V = 1, M the mass beside the kept modes, the further mode s is L_s = omega_s sqrt(mu_s) M v_s,
    so that the sum of L L^T / omega² is R; it takes the share omega_s² mu_s of the mass in its direction. Their frequencies are
    `FAR` above the kept ones, or as high as that mass allows. Where mu is negative, as extrapolation from mesh to mesh can leave
    it, R is less than it is known to, and left out.

    Raises
    ------
    BadInput : modes that take more mass than there is, in some direction.
    """
    from scipy.linalg import eigh

    M = modes.rigid_mass - modes.participation @ modes.participation.T
    share = float(eigh(M, modes.rigid_mass, eigvals_only=True)[0])
    if share < -EXCESS:
        problem = f"its modes must not move more mass than the body has, found {-share:.3g} of it too much in some direction"
        remedy = "Check the units of the participation, and that it and the rigid mass have one reference point"
        raise BadInput(f"body {name}", "participation", problem, remedy)
    M = M + EXCESS * modes.rigid_mass
    mu, V = eigh(modes.residual, M)
    highest = 2 * np.pi * modes.frequency.max(initial=0.0)
    kept = mu * highest**2 > NOTHING if highest else mu > 0
    mu, V = mu[kept], V[:, kept]
    omega = np.sqrt(LEAVES / mu)
    if highest:
        omega = np.minimum(omega, FAR * highest)
    L = (M @ V) * (omega * np.sqrt(mu))
    bare = replace(modes, shapes=np.zeros((0, modes.frequency.size)))
    return FlexibleBody(
        name=name, reduced=_reduced(bare, omega, L, np.zeros((0, 6)), np.zeros((0, omega.size))), kept=modes.frequency
    )


def rigid(name: str, inertia: Inertia, places: Places = NOWHERE) -> FlexibleBody:
    """A rigid body with its base at the article's origin.

    Raises
    ------
    BadInput : an inertia that no body has.
    """
    M = require_physical(inertia, f"body {name}").about(np.zeros(3)).mass_matrix
    nothing = np.zeros((6, 6))
    reduced = Reduced(stiffness=nothing, mass=M, viscous=nothing, structural=nothing, basis=np.eye(6))
    rows = {place: rigid_transformation(at) for place, at in places.items()}
    return FlexibleBody(name=name, reduced=reduced, kept=np.zeros(0), places=rows)


def viscous(modes: Modes) -> tuple[Array, Array]:
    """Stiffness [rad²/s²] and viscous damping [rad/s] (n, n) of `modes` for a response in time."""
    omega = 2 * np.pi * modes.frequency
    A = np.diag(omega**2) + 1j * modes.structural if modes.condensed is None else modes.condensed.stiffness
    return np.asarray(A.real), np.asarray(modes.viscous + A.imag / np.sqrt(np.outer(omega, omega)))


def _reduced(modes: Modes, omega: Array, L: Array, rigid_motion: Array, shapes: Array) -> Reduced:
    """`modes` and m carriers of the rest beside them; omega (m,) [rad/s], L (6, m), shapes (N, m); about the article's origin."""
    from scipy.linalg import block_diag

    K, C = viscous(modes)
    ratio = modes.damping_ratio.mean() if modes.damping_ratio.size else 0.0
    n = len(K) + len(omega)
    extended = Modes(
        frequency=np.append(modes.frequency, omega / (2 * np.pi)),
        damping_ratio=np.append(modes.damping_ratio, np.full(len(omega), ratio)),
        participation=np.hstack([modes.participation, L]),
        rigid_mass=modes.rigid_mass,
        residual=np.zeros((6, 6)),
        reference_point=modes.reference_point,
        shapes=np.hstack([modes.shapes, shapes]),
        viscous=np.asarray(block_diag(C, np.diag(2 * ratio * omega))).reshape(n, n),
    )
    made = craig_bampton(extended, rigid_motion)
    stiffness = np.array(made.stiffness)
    stiffness[6 : 6 + len(K), 6 : 6 + len(K)] = K
    # The base's motions counted at the article's origin instead of at `modes.reference_point`
    reduced = replace(made, stiffness=stiffness)
    T = np.eye(len(reduced.mass))
    T[:6, :6] = rigid_transformation_6(modes.reference_point)
    return replace(reduced, mass=T.T @ reduced.mass @ T, basis=reduced.basis @ T)


# What a `Rig` must be before anybody makes equations of it.

AXES = MOTIONS[:3]

HELD = 1e-12
"""Least stiffness of the cells together against any motion of the cover plate, as a share of the greatest."""

SLOWEST, FASTEST = 0.01, 1e5
"""[Hz] between which the article must swing on one joint, strut or cell alone. A softer joint holds nothing, a stiffer one is
rigid to all that is sampled; further apart, rounding in the stiffest would hide what the softest does."""

SOFTEST, STIFFEST = (2 * pi * SLOWEST) ** 2, (2 * pi * FASTEST) ** 2
"""Stiffness over mass [1/s²] of these."""

MOST_VISCOUS = 1e7
"""Damping over mass [1/s]: beyond it, what is damped is as good as held, and rounding may feed energy in."""

HEAVIEST = 10.0
"""Times the mass of the article that a loose part may have."""


def require_usable(rig: Rig) -> Rig:
    """`rig` itself, when it can be built.

    Raises
    ------
    BadInput : a stiffness, damping, compliance, preload, slip force or mass out of its bounds, one with which what it holds would
        swing outside `SLOWEST` to `FASTEST`, cells that do not hold the cover plate, a strut at a place that the article has not;
        the message names it.
    """
    _require(
        not np.any(rig.article.reduced.structural),
        "article.reduced",
        "its damping must be viscous, found structural damping, which a response in time does not know",
        "Make the body by fem.base_excitation.rig",
    )
    carried = _mass(rig) + (0.0 if rig.cover is None else rig.cover.mass)
    for number, cell in enumerate(rig.cells, start=1):
        name = f"cells.{number}"
        for axis, k, c in zip(AXES, cell.stiffness, cell.damping, strict=True):
            _require_positive(f"{name}.stiffness", k, f"N/m along {axis}")
            _require_not_negative(f"{name}.damping", c, f"N s/m along {axis}")
            _require_within(f"{name}.stiffness", k, (SOFTEST * carried, STIFFEST * carried), f"N/m along {axis}")
            _require_within(f"{name}.damping", c, (0.0, MOST_VISCOUS * carried), f"N s/m along {axis}")
        if cell.preload is not None:
            _require_positive(f"{name}.preload", cell.preload, "N")
    if rig.cells:
        size = max(float(np.linalg.norm(cell.position)) for cell in rig.cells)
        arms = [rigid_transformation(cell.position / (size or 1.0)) for cell in rig.cells]
        K = sum((G.T @ np.diag(cell.stiffness) @ G for G, cell in zip(arms, rig.cells, strict=True)), np.zeros((6, 6)))
        _require(
            size > 0 and np.linalg.eigvalsh(K)[0] > HELD * np.linalg.eigvalsh(K)[-1],
            "cells",
            f"they must hold the cover plate against every motion, found {len(rig.cells)} that leave it one",
            "Put at least three cells where they are not in one line",
        )
    if rig.flange is not None:
        lag = rig.flange.damping_time
        _require_not_negative("flange.damping_time", lag, "s")
        carried_along = np.diag(rig.article.reduced.mass)[:6].tolist()  # mass along, moments of inertia about, the joint's axes
        for axis, value, m in zip(MOTIONS, rig.flange.compliance.tolist(), carried_along, strict=True):
            _require_not_negative("flange.compliance", value, "m/N or rad/(N m)")
            if value > 0:
                least = max(m, sys.float_info.min)
                unit = f"{'m/N' if axis in AXES else 'rad/(N m)'} for {axis}"
                _require_within("flange.compliance", value, (1 / (STIFFEST * least), 1 / (SOFTEST * least)), unit)
                _require_within("flange.damping_time", lag, (0.0, MOST_VISCOUS * least * value), f"s for {axis}")
    known = rig.article.places
    for strut in rig.struts:
        _require(
            strut.place in known,
            "struts.place",
            f"{rig.article.name} has no place {strut.place!r}",
            f"{nearest(strut.place, known)}Its places are {', '.join(sorted(known)) or 'none'}",
        )
        _require(
            strut.to in ("ground", "table"), "struts.to", f"it must be ground or table, found {strut.to!r}", "Name one of both"
        )
        for axis, k, c in zip(AXES, strut.stiffness, strut.damping, strict=True):
            _require_not_negative("struts.stiffness", k, f"N/m along {axis}")
            _require_not_negative("struts.damping", c, f"N s/m along {axis}")
            _require_within("struts.stiffness", k, (0.0, STIFFEST * _mass(rig)), f"N/m along {axis}")
            _require_within("struts.damping", c, (0.0, MOST_VISCOUS * _mass(rig)), f"N s/m along {axis}")
    for friction in rig.frictions:
        _require(friction.axis in AXES[:2], "frictions.axis", f"it must be x or y, found {friction.axis!r}", "Name one of both")
        _require_positive("frictions.slip_force", friction.slip_force, "N")
        _require_positive("frictions.mass", friction.mass, "kg")
        _require(
            friction.mass <= HEAVIEST * _mass(rig),
            "frictions.mass",
            f"it may be up to {HEAVIEST * _mass(rig):.4g} kg, {HEAVIEST:g} times the article, found {friction.mass:g} kg",
            "Check its unit, or count it to the article",
        )
    return rig


def _mass(rig: Rig) -> float:
    return float(rig.article.reduced.mass[0, 0])


def _require_positive(field: str, value: float, unit: str) -> None:
    _require(value > 0, field, f"it must be above zero, found {value:g} {unit}", "Check its sign and unit")


def _require_not_negative(field: str, value: float, unit: str) -> None:
    _require(value >= 0, field, f"it must not be negative, found {value:g} {unit}", "Check its sign and unit")


def _require_within(field: str, value: float, bounds: tuple[float, float], unit: str) -> None:
    low, high = bounds
    _require(
        low <= value <= high,
        field,
        f"for what it holds it must lie between {low:.3g} and {high:.3g} {unit}, found {value:g}",
        "Check its unit; leave out what is as good as rigid, and what holds nothing",
    )


def _require(good: bool, field: str, problem: str, remedy: str) -> None:
    if not good:
        raise BadInput("rig", field, problem, remedy)


# A linear `Rig` as second-order matrices on the table and on what moves relative to it.
#
#     table 6 | cover plate relative to the table, 6 if there are cells | flange joint, one a direction that gives | article's own
#
# Relative coordinates keep what is stiff out of the way: a cell of 1e9 N/m sees its own micrometres and not the table's stroke,
# and only what is tied to the ground resists a motion of the table. Cells that are not there and a joint that does not give are
# rigid by elimination. With u the table and y the rest, everything follows from
#
#     M_yy y'' + C_yy y' + K_yy y = -(M_yt u'' + C_yt u' + K_yt u),   load = M_t x'' + C_t x' + K_t x,   x = (u, y).

TABLE = 6


@dataclass(frozen=True, eq=False, kw_only=True)
class RigStructure:
    """Matrices of a linear rig, SI, about F.

    Attributes
    ----------
    mass, viscous, stiffness : (6 + n, 6 + n) symmetric; the six motions of the table first
    cover : (6, 6 + n) motion of the cover plate about F; that of the table without cells
    article : (6 + m, 6 + n) coordinates of the article's `FlexibleBody.reduced`, in the laboratory
    cells : (c, 3, 6 + n) how the cover plate moves relative to the table at every cell
    cell_stiffness, cell_damping : (c, 3) [N/m], [N s/m]
    places : (3, 6 + n) motion of places in the laboratory
    """

    mass: Array
    viscous: Array
    stiffness: Array
    cover: Array
    article: Array
    cells: Array
    cell_stiffness: Array
    cell_damping: Array
    places: Mapping[str, Array]

    def __post_init__(self) -> None:
        freeze(self, "mass", "viscous", "stiffness", "cover", "article", "cells", "cell_stiffness", "cell_damping")

    @property
    def grounded(self) -> bool:
        """Whether anything resists a displacement or velocity of the table."""
        return bool(np.any(self.stiffness[:TABLE]) or np.any(self.viscous[:TABLE]))


def matrices(rig: Rig) -> RigStructure:
    """The equations of `rig`.

    Raises
    ------
    BadInput : something of it cannot be built, or it has friction or a cell that can lift off.
    """
    require_usable(rig)
    problem = "friction is not linear" if rig.frictions else "a cell with a preload can lift off, which is not linear"
    _require(
        rig.linear,
        "frictions" if rig.frictions else "cells.preload",
        f"the exact recursion answers linear rigs only, and {problem}",
        "Use exudyn (fem.flexible_body.driven_base), or leave it out",
    )
    # Directions in which the flange gives, number of coordinates, and motion of cover plate (6, size) and of the article's
    # coordinates (6 + m, size)
    joint = [] if rig.flange is None else [int(axis) for axis in np.flatnonzero(rig.flange.compliance)]
    own = len(rig.article.reduced.mass) - TABLE
    first = TABLE + (TABLE if rig.cells else 0)
    size = first + len(joint) + own
    cover = np.zeros((TABLE, size))
    cover[:, :TABLE] = np.eye(TABLE)
    if rig.cells:
        cover[:, TABLE : 2 * TABLE] = np.eye(TABLE)
    article = np.zeros((TABLE + own, size))
    article[:TABLE] = rigid_transformation_6(rig.seat) @ cover
    article[joint, first + np.arange(len(joint))] += 1.0
    article[TABLE:, first + len(joint) :] = np.eye(own)
    gap = cover - np.eye(TABLE, size)  # motion of the cover plate relative to the table
    cells = np.array([rigid_transformation(cell.position) @ gap for cell in rig.cells]).reshape(-1, 3, size)
    reduced = rig.article.reduced
    M = article.T @ reduced.mass @ article
    if rig.cover is not None:
        M = M + cover.T @ rig.cover.about(np.zeros(3)).mass_matrix @ cover
    C, K = (article.T @ matrix @ article for matrix in (reduced.viscous, reduced.stiffness))
    for cell, rows in zip(rig.cells, cells, strict=True):
        C, K = _with(C, K, rows, cell.damping, cell.stiffness)
    for strut in rig.struts:
        rows = np.asarray(rig.article.places[strut.place] @ article)  # by how much the strut is stretched
        if strut.to == "table":  # its point of the table rides below the place: moving as one stretches nothing
            rows[:, :TABLE] = 0.0
        C, K = _with(C, K, rows, strut.damping, strut.stiffness)
    stiffness = np.zeros(0) if rig.flange is None else np.asarray(1 / rig.flange.compliance[joint])
    at = first + np.arange(len(joint))
    K[at, at] += stiffness
    C[at, at] += stiffness * (rig.flange.damping_time if rig.flange else 0.0)
    return RigStructure(
        mass=symmetric(M),
        viscous=symmetric(C),
        stiffness=symmetric(K),
        cover=cover,
        article=article,
        cells=cells,
        cell_stiffness=np.array([cell.stiffness for cell in rig.cells]).reshape(-1, 3),
        cell_damping=np.array([cell.damping for cell in rig.cells]).reshape(-1, 3),
        places=MappingProxyType({name: rows @ article for name, rows in rig.article.places.items()}),
    )


def dynamic_mass(rig: Rig, frequency: npt.ArrayLike) -> DynamicMass:
    """Blocked dynamic mass of all that stands on the table, about F, at `frequency` (n,) [Hz]; above zero where it is tied down.

    Raises
    ------
    BadInput : as `matrices`.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    s, t, y = matrices(rig), slice(None, TABLE), slice(TABLE, None)
    H = np.empty((len(lines), TABLE, TABLE), dtype=np.complex128)
    for line, omega in enumerate(2 * np.pi * lines):
        # Load for a unit acceleration of the table, u = -1 / omega²; the elastic part apart, so that no line loses digits
        ground = s.stiffness + 1j * omega * s.viscous
        Z = ground - omega**2 * s.mass
        drive = s.mass - (ground / omega**2 if s.grounded else 0.0)
        H[line] = drive[t, t] + Z[t, y] @ np.linalg.solve(Z[y, y], -drive[y, t])
    return DynamicMass(frequency=lines, matrix=H)


def _with(C: Array, K: Array, rows: Array, damping: Array, stiffness: Array) -> tuple[Array, Array]:
    return C + rows.T @ (damping[:, None] * rows), K + rows.T @ (stiffness[:, None] * rows)
