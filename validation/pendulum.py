"""Three pendulums, small amplitude, no damping, massless ropes: the period and a few lengths give a moment of inertia.

Every function takes and returns quantities with tolerance (`geometry.quantities`; plain numbers do as well), SI inside.
What the ideal leaves out (amplitude, damping, rope mass) is in `validation.pendulum_corrections`, term by term.

Rope pendulum, paper Eq. 5, with ropes of equal length l hung vertically. Turned by a small angle φ about the vertical through the
CoG, the foot of rope i moves r_i φ sideways and its tension F_i pulls it back with F_i r_i φ / l, so the restoring moment is
``φ Σ F_i r_i² / l``. Statics of the hanging body gives Σ F_i = m g and Σ F_i r_i = 0 (vectors from the CoG), which also keeps
rotation and sway apart.

* two ropes, s1 and s2 to either side of the CoG: F_1 = m g s2/(s1 + s2), and Σ F_i r_i² = m g s1 s2, which is Eq. 5;
* any number of ropes at one radius s about the CoG, however they share the weight: Σ F_i r_i² = m g s², Eq. 5 with s1 = s2 = s.

Both hold for rope feet in one horizontal plane; its height does not matter. They fail when ropes are slanted or unequal.
"""

from __future__ import annotations

from typing import TypeVar

from numpy import pi
from uncertainties import UFloat

Value = TypeVar("Value", float, UFloat)
"""A plain number or one with a tolerance, all of one kind."""


def rope_pendulum(*, mass: Value, gravity: Value, s1: Value, s2: Value, length: Value, period: Value) -> Value:
    """Moment of inertia [kg m²] about the vertical through the CoG: ``m g s1 s2 T² / (4 π² l)``, paper Eq. 5."""
    return mass * gravity * s1 * s2 * period**2 / (4 * pi**2 * length)


def compound_pendulum(*, mass: Value, gravity: Value, arm: Value, period: Value) -> Value:
    """Moment of inertia [kg m²] about the axis through the CoG parallel to the pivot, which is `arm` [m] away.

    ``I + m l² = m g l T² / (4 π²)``, moment of momentum about the pivot. A result that is not positive contradicts itself: the
    period is shorter than that of a point mass on the same arm. The caller judges.
    """
    return mass * gravity * arm * period**2 / (4 * pi**2) - mass * arm**2


def torsion_stiffness(*, known_inertia: Value, period: Value) -> Value:
    """Stiffness [N m/rad] of a torsion rod on which a body of `known_inertia` [kg m²] swings: ``k = I (2 π / T)²``."""
    return known_inertia * (2 * pi / period) ** 2


def torsion_pendulum(*, stiffness: Value, period: Value) -> Value:
    """Moment of inertia [kg m²] about the axis of a torsion rod of `stiffness` [N m/rad]: ``I = k T² / (4 π²)``.

    The rod carries the body through its CoG; else the result is about the rod's axis, not the CoG.
    """
    return stiffness * (period / (2 * pi)) ** 2


def rod_inertia(*, mass: Value, length: Value, diameter: Value) -> Value:
    """Moment of inertia [kg m²] of a solid cylinder about its CoG, across its axis: ``m (l²/12 + d²/16)``."""
    return mass * (length**2 / 12 + diameter**2 / 16)
