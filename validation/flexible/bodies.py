"""Are two models of the same body? A comparison of different ones says so before anything else."""

from __future__ import annotations

from validation.flexible.model import Flexible

SAME = 0.01
"""Share by which the masses of two models of one article may differ."""


def another_body(first: Flexible, second: Flexible) -> str:
    """A sentence with the masses of both where they differ by more than `SAME`; empty where they do not."""
    masses = [float(model.modes.rigid_mass[0, 0]) for model in (first, second)]
    if abs(masses[1] - masses[0]) <= SAME * max(masses):
        return ""
    said = " and ".join(
        f"{mass:.4g} kg ({one.model} model of {one.article})" for mass, one in zip(masses, (first, second), strict=True)
    )
    return f"These are different bodies: {said}; what follows compares them all the same."
