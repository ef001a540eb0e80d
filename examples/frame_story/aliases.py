"""What else would soften all storeys by one factor, and the two effects that were left out."""

from __future__ import annotations

import numpy as np

from fem.beam.elements import Section


def aliases(factor: float, *, modulus: float, thickness: float, length: float) -> dict[str, float]:
    """What else would change all stiffnesses by `factor`, of legs as drawn [m].

    The modulus in standard deviations `modulus` of its logarithm, as it is declared; thickness and free length of the legs [mm],
    since k ~ h³ / L³.
    """
    return {
        "modulus_sigmas": float(np.log(factor)) / modulus,
        "thickness_mm": 1e3 * thickness * (factor ** (1 / 3) - 1),
        "length_mm": 1e3 * length * (factor ** (-1 / 3) - 1),
    }


def left_out(leg: Section, length: float, stiffness: float, weight: float) -> dict[str, float]:
    """What effects that were left out would change of the `stiffness` [N/m] of the lowest storey [%].

    `weight` [N] on legs that stand takes 6/5 W / L of it (Timoshenko and Gere, Theory of Elastic Stability, 1961); shear takes
    the share Phi = 12 E I / (k G A L²) of the element.
    """
    return {
        "weight_percent": -100 * 6 / 5 * weight / length / stiffness,
        "shear_percent": -100 * 12 * leg.bending_y / (leg.shear_z * length**2),
    }
