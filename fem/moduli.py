"""Elastic moduli of a material, checked: a library entry or a user's material may lack them or hold nonsense."""

from __future__ import annotations

from geometry.errors import BadInput
from geometry.materials import Material

_REMEDY = (
    "Name one that has both, such as steel (207e9 Pa and 0.3) or aluminium (70e9 Pa and 0.33), or state your own in an "
    'article.toml ([material."..."] with density, youngs_modulus and poisson_ratio)'
)


def moduli(material: Material, part: str = "") -> tuple[float, float]:
    """Young's modulus and shear modulus E / (2 (1 + nu)) of `material` [Pa], of which `part` is made.

    Raises
    ------
    BadInput : one of them is missing, not positive and finite, or Poisson's ratio lies outside -1 ... 0.5.
    """
    E, nu = material.youngs_modulus, material.poisson_ratio
    if E is None:
        raise _refused(material, part, "youngs_modulus", "is missing, found none, and without it the part has no stiffness")
    if nu is None:
        raise _refused(material, part, "poisson_ratio", "is missing, found none, and without it there is no shear modulus")
    if not 0 < E < float("inf"):
        raise _refused(material, part, "youngs_modulus", f"must be positive and finite, found {E:g} Pa")
    if not -1 < nu < 0.5:
        raise _refused(material, part, "poisson_ratio", f"must lie between -1 and 0.5, found {nu:g}")
    return E, E / (2 * (1 + nu))


def _refused(material: Material, part: str, field: str, problem: str) -> BadInput:
    return BadInput(
        source=f"material {material.name}" + (f" of {part}" if part else ""), field=field, problem=problem, remedy=_REMEDY
    )
