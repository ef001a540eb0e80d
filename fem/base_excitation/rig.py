"""`Rig`: what stands on the table, from the table up - load cells, cover plate, flange joint, article - and what is attached.

    table --[cells]-- cover plate (FMD's moving part, about F) --[flange joint]-- article (reduced, about its own origin)

Without an FMD the article stands on the table and F is its origin. A rig is data; `linear` and exudyn each make their own
equations of it. Everything linear is understood by both; gaps and friction by exudyn alone.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType
from typing import Literal

import numpy as np

from fem.reduction import Reduced
from geometry.arrays import Array, frozen
from geometry.inertia import Inertia

LATERAL = ("x", "y")


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
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
        object.__setattr__(self, "kept", frozen(self.kept, np.shape(self.kept), "kept"))
        object.__setattr__(
            self, "places", MappingProxyType({name: frozen(a, (3, size), f"places.{name}") for name, a in self.places.items()})
        )


@dataclass(frozen=True, eq=False, kw_only=True)
class Cell:
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
        for name in ("position", "stiffness", "damping"):
            object.__setattr__(self, name, frozen(getattr(self, name), (3,), name))


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
        object.__setattr__(self, "compliance", frozen(self.compliance, (6,), "compliance"))


@dataclass(frozen=True, eq=False, kw_only=True)
class Strut:
    """A spring and a damper from a place of the article to the ground (a cable) or to the table (local damping).

    Attributes
    ----------
    place : as the article's `Body.places` names it
    to : "ground" or "table"
    stiffness : (3,) [N/m] along x, y, z
    damping : (3,) [N s/m]
    """

    place: str
    to: Literal["ground", "table"] = "ground"
    stiffness: Array = field(default_factory=lambda: np.zeros(3))
    damping: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        for name in ("stiffness", "damping"):
            object.__setattr__(self, name, frozen(getattr(self, name), (3,), name))


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

    article: Body
    cover: Inertia | None = None
    seat: Array = field(default_factory=lambda: np.zeros(3))
    cells: tuple[Cell, ...] = ()
    flange: Flange | None = None
    struts: tuple[Strut, ...] = ()
    frictions: tuple[Friction, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "seat", frozen(self.seat, (3,), "seat"))

    @property
    def linear(self) -> bool:
        """Whether its answer grows in proportion to what drives it."""
        return not self.frictions and all(cell.preload is None for cell in self.cells)
