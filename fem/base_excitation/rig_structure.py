"""A linear `Rig` as second-order matrices on the table and on what moves relative to it.

    table 6 | cover plate relative to the table, 6 if there are cells | flange joint, one a direction that gives | article's own

Relative coordinates keep what is stiff out of the way: a cell of 1e9 N/m sees its own micrometres and not the table's stroke,
and only what is tied to the ground resists a motion of the table. Cells that are not there and a joint that does not give are
rigid by elimination. With u the table and y the rest, everything follows from

    M_yy y'' + C_yy y' + K_yy y = -(M_yt u'' + C_yt u' + K_yt u),   load = M_t x'' + C_t x' + K_t x,   x = (u, y).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from fem.base_excitation.rig import Cell, Rig, Strut
from fem.base_excitation.rig_check import require_usable
from geometry.arrays import Array, frozen
from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import BadInput
from geometry.frames import rigid_transformation, rigid_transformation_6

TABLE = 6


@dataclass(frozen=True, eq=False, kw_only=True)
class RigStructure:
    """Matrices of a linear rig, SI, about F.

    Attributes
    ----------
    mass, viscous, stiffness : (6 + n, 6 + n) symmetric; the six motions of the table first
    cover : (6, 6 + n) motion of the cover plate about F; that of the table without cells
    article : (6 + m, 6 + n) coordinates of the article's `Body.reduced`, in the laboratory
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
        for name in ("mass", "viscous", "stiffness", "cover", "article", "cells", "cell_stiffness", "cell_damping"):
            object.__setattr__(self, name, frozen(getattr(self, name), np.shape(getattr(self, name)), name))

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
    _require_linear(require_usable(rig))
    size, cover, article = _kinematics(rig)
    cells = np.array([_at(cell, cover, size) for cell in rig.cells]).reshape(-1, 3, size)
    reduced = rig.article.reduced
    M = article.T @ reduced.mass @ article
    if rig.cover is not None:
        M = M + cover.T @ rig.cover.about(np.zeros(3)).mass_matrix @ cover
    C, K = (article.T @ matrix @ article for matrix in (reduced.viscous, reduced.stiffness))
    for cell, rows in zip(rig.cells, cells, strict=True):
        C, K = _with(C, K, rows, cell.damping, cell.stiffness)
    for strut in rig.struts:
        C, K = _with(C, K, _strut(strut, rig, article), strut.damping, strut.stiffness)
    joint, stiffness = _joint(rig), _joint_stiffness(rig)
    at = (TABLE if rig.cells else 0) + TABLE + np.arange(len(joint))
    K[at, at] += stiffness
    C[at, at] += stiffness * (rig.flange.damping_time if rig.flange else 0.0)
    return RigStructure(
        mass=_symmetric(M),
        viscous=_symmetric(C),
        stiffness=_symmetric(K),
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
    structure = matrices(rig)
    H = np.array([_condensed(structure, omega) for omega in 2 * np.pi * lines]).reshape(-1, TABLE, TABLE)
    return DynamicMass(frequency=lines, matrix=H)


def _condensed(s: RigStructure, omega: float) -> ComplexArray:
    """Load for a unit acceleration of the table, u = -1 / omega²; the elastic part apart, so that no line loses digits."""
    t, y = slice(None, TABLE), slice(TABLE, None)
    Z = s.stiffness + 1j * omega * s.viscous - omega**2 * s.mass
    ground = s.stiffness + 1j * omega * s.viscous
    drive = s.mass - (ground / omega**2 if s.grounded else 0.0)
    answer = np.linalg.solve(Z[y, y], -drive[y, t])
    return np.asarray(drive[t, t] + Z[t, y] @ answer)


def _kinematics(rig: Rig) -> tuple[int, Array, Array]:
    """Number of coordinates, and motion of cover plate (6, size) and of the article's coordinates (6 + m, size)."""
    joint, own = _joint(rig), len(rig.article.reduced.mass) - TABLE
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
    return size, cover, article


def _joint(rig: Rig) -> list[int]:
    """Directions in which the flange gives."""
    return [] if rig.flange is None else [int(axis) for axis in np.flatnonzero(rig.flange.compliance)]


def _joint_stiffness(rig: Rig) -> Array:
    return np.zeros(0) if rig.flange is None else np.asarray(1 / rig.flange.compliance[_joint(rig)])


def _at(cell: Cell, cover: Array, size: int) -> Array:
    """(3, size) motion of the cover plate relative to the table at `cell`."""
    table = np.eye(TABLE, size)
    return np.asarray(rigid_transformation(cell.position) @ (cover - table))


def _strut(strut: Strut, rig: Rig, article: Array) -> Array:
    """(3, size) by how much `strut` is stretched; the table's point of a strut to it rides below the place."""
    rows = rig.article.places[strut.place]
    moved = np.asarray(rows @ article)
    if strut.to == "table":
        moved[:, :TABLE] = 0.0  # a rigid motion of table and article together stretches nothing
    return moved


def _with(C: Array, K: Array, rows: Array, damping: Array, stiffness: Array) -> tuple[Array, Array]:
    return C + rows.T @ (damping[:, None] * rows), K + rows.T @ (stiffness[:, None] * rows)


def _symmetric(matrix: Array) -> Array:
    return np.asarray((matrix + matrix.T) / 2)


def _require_linear(rig: Rig) -> None:
    if rig.linear:
        return
    problem = "friction is not linear" if rig.frictions else "a cell with a preload can lift off, which is not linear"
    raise BadInput(
        source="rig",
        field="frictions" if rig.frictions else "cells.preload",
        problem=f"the exact recursion answers linear rigs only, and {problem}",
        remedy="Use exudyn (fem.flexible_body.driven_base), or leave it out",
    )
