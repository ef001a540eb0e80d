"""The effects of ``opened.toml``: they open a parameter that chain or structure have, and need no equation of their own."""

from collections.abc import Mapping
from typing import Any

from fem import structure
from geometry.sensors import Tolerances
from geometry.toml_file import shipped
from validation.effects import effect
from validation.effects.plants import at


def _family(name: str, stated: Mapping[str, Any]) -> effect.Family:
    """The family that is `stated` under its `name`."""
    found: dict[str, Any] = {key: tuple(value) if isinstance(value, list) else value for key, value in stated.items()}
    sizes = found.get("sizes", ())
    found["sizes"] = getattr(effect, sizes) if isinstance(sizes, str) else tuple(effect.SizeSpec(**one) for one in sizes)
    if isinstance(found.get("tolerance"), str):
        found["tolerance"] = getattr(Tolerances(), found["tolerance"])
    if "limits" in found:
        found["limits"] = getattr(structure, found["limits"])
    if "plant" in found:
        found["plant"] = at(*found["plant"])
    return effect.Family(name=name, **found)


FAMILIES = {name: _family(name, stated) for name, stated in shipped("validation.effects.families", "opened.toml").items()}
"""By name."""
