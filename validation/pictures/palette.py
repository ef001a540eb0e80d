"""Colours: one a material, the same in every picture; red, green and blue belong to the principal axes 1, 2 and 3."""

from __future__ import annotations

from collections.abc import Iterable

MATERIALS = {
    "steel": "#54708a",
    "aluminium": "#9fc3d6",
    "silicone": "#f28a1c",
    "cast-carbon-steel": "#4b5563",
    "brass": "#c9a227",
    "oak": "#a0703c",
    "titanium": "#8d80a8",
    "cfrp": "#33373d",
}
OTHERS = ("#7fa36b", "#b5838d", "#5f9ea0", "#b8a04a", "#8f8fc4", "#a86f4f")
"""Materials without a colour of their own take these in turn, in alphabetical order."""

AXES = ("#c8283c", "#1f8a4c", "#2456c4")
ELLIPSOID = "#8e6fc0"
UNCOUNTED = "#9aa0a6"
INK = "#1d2330"
FAINT = "#6b7280"
PAPER = "#ffffff"


def colours(materials: Iterable[str]) -> dict[str, str]:
    """A colour for each of `materials`, alphabetical."""
    names = sorted(set(materials))
    strangers = [name for name in names if name not in MATERIALS]
    return {name: MATERIALS.get(name) or OTHERS[strangers.index(name) % len(OTHERS)] for name in names}
