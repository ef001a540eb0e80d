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
INPUTS = {
    "noise": "#d9541e",
    "elasticity": "#c8283c",
    "tare": "#1f8a4c",
    "force-gain": "#2456c4",
    "force-delay": "#6f93dc",
    "force-crosstalk": "#7d1220",
    "cell-stiffness": "#c9a227",
    "fmd-compliance": "#8a6d1a",
    "fmd-inertia": "#7fa36b",
    "accelerometer-gain": "#33373d",
    "accelerometer-delay": "#5f9ea0",
    "accelerometer-position": "#8e6fc0",
    "accelerometer-misalignment": "#b5838d",
}
"""Inputs of an uncertainty: what was expected and what came out are laid side by side."""

INK = "#1d2330"
FAINT = "#6b7280"
PAPER = "#ffffff"


def input_colours(names: Iterable[str]) -> dict[str, str]:
    """A colour for each input of `names`, in their order: its own in every picture."""
    listed = list(names)
    strangers = sorted(name for name in listed if name not in INPUTS)
    return {name: INPUTS.get(name) or OTHERS[strangers.index(name) % len(OTHERS)] for name in listed}


def colours(materials: Iterable[str]) -> dict[str, str]:
    """A colour for each of `materials`, alphabetical."""
    names = sorted(set(materials))
    strangers = [name for name in names if name not in MATERIALS]
    return {name: MATERIALS.get(name) or OTHERS[strangers.index(name) % len(OTHERS)] for name in names}
