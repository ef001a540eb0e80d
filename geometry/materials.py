"""Materials: what a part is made of. The library lives in `materials.toml`; a user's article brings its own."""

from __future__ import annotations

import tomllib
from collections.abc import Mapping
from dataclasses import dataclass
from functools import cache
from importlib.resources import files
from types import MappingProxyType

from geometry.errors import BadInput


@dataclass(frozen=True, eq=False, kw_only=True)
class Material:
    """An isotropic material.

    Attributes
    ----------
    name : as the library or the user's file calls it
    density : [kg/m³]
    youngs_modulus : [Pa], None where only the mass matters
    poisson_ratio : [1], None where only the mass matters
    loss_factor : [1], structural (hysteretic) damping, None where unknown
    """

    name: str
    density: float
    youngs_modulus: float | None = None
    poisson_ratio: float | None = None
    loss_factor: float | None = None

    def __post_init__(self) -> None:
        if not 0 < self.density < float("inf"):
            raise BadInput(
                source=f"material {self.name}",
                field="density",
                problem=f"a density must be positive and finite, found {self.density:g} kg/m³",
                remedy="Give it in kg/m³ (steel about 7850, aluminium about 2700)",
            )


@cache
def library() -> Mapping[str, Material]:
    """The materials that ship with massline, by name."""
    table = tomllib.loads(files("geometry").joinpath("materials.toml").read_text(encoding="utf-8"))
    return MappingProxyType({name: Material(name=name, **_fields(entry)) for name, entry in table.items()})


def material(name: str, source: str = "material") -> Material:
    """The library's material called `name`.

    Raises
    ------
    BadInput : no such material; the message lists those that exist.
    """
    try:
        return library()[name]
    except KeyError:
        raise BadInput(
            source=source,
            field="material",
            problem=f"no material is called {name!r}",
            remedy=f"Known are {', '.join(sorted(library()))}; or state a density",
        ) from None


def _fields(entry: Mapping[str, object]) -> dict[str, float]:
    units = {"density": "density_kg_m3", "youngs_modulus": "youngs_modulus_Pa"}
    names = ("density", "youngs_modulus", "poisson_ratio", "loss_factor")
    return {name: float(str(entry[key])) for name in names if (key := units.get(name, name)) in entry}
