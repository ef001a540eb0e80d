"""Colours of the inputs of an uncertainty: the same input has the same colour in every picture, expected and found."""

from __future__ import annotations

from collections.abc import Iterable

OF_INPUTS = {
    "noise": "#2456c4",
    "elasticity": "#c8283c",
    "tare": "#33373d",
    "force-gain": "#1f8a4c",
    "force-delay": "#7fc29b",
    "force-crosstalk": "#5f9ea0",
    "accelerometer-gain": "#d9541e",
    "accelerometer-delay": "#f0b27a",
    "accelerometer-position": "#c9a227",
    "accelerometer-misalignment": "#8e6fc0",
    "cell-stiffness": "#b5838d",
    "fmd-compliance": "#6b7a3a",
}

FURTHER = ("#4aa3df", "#a0522d", "#d987b9", "#7a869a")
"""Of inputs that are not among these, in turn."""


def colours(names: Iterable[str]) -> dict[str, str]:
    """By input its colour, in the order of `names`."""
    wanted = list(names)
    others = [name for name in wanted if name not in OF_INPUTS]
    further = {name: FURTHER[k % len(FURTHER)] for k, name in enumerate(others)}
    return {name: OF_INPUTS.get(name) or further[name] for name in wanted}
