"""What moves the period of a pendulum away from paper Eq. 5, each as a factor on the period that it gets.

Those of amplitude, damping and rope mass are `validation.pendulum_corrections` the other way round. One period is one number: all
six are exact aliases there, and only two amplitudes, two lengths or the decay tell them apart.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geometry.errors import BadInput
from validation.effects.family import Values
from validation.effects.stages import Swing
from validation.pendulum_corrections import plane_amplitude_factor, rope_amplitude_factor


def wide(swing: Swing, targets: tuple[str, ...], values: Values) -> Swing:
    """The swing is so wide; of ropes the exact period, of a body on a pivot that of the plane pendulum."""
    if not swing.ropes:
        return _times(swing, plane_amplitude_factor(values[""]))
    square = _square(swing)
    epsilon, kappa = square / _stated(swing, "length") ** 2, _stated(swing, "mass") * square / _stated(swing, "inertia")
    return _times(swing, rope_amplitude_factor(values[""], epsilon, kappa))


def damped(swing: Swing, targets: tuple[str, ...], values: Values) -> Swing:
    """``1 / sqrt(1 - zeta²)``"""
    return _times(swing, 1 / np.sqrt(1 - values[""] ** 2))


def heavy_ropes(swing: Swing, targets: tuple[str, ...], values: Values) -> Swing:
    """``M q / 3`` more inertia, ``M q / 2`` more of m s1 s2, M the mass of all ropes."""
    mean = values[""] * float(np.mean(_radii(swing) ** 2))
    turning, pulling = mean / (3 * _stated(swing, "inertia")), mean / (2 * _stated(swing, "mass") * _square(swing))
    return _times(swing, np.sqrt((1 + turning) / (1 + pulling)))


def stretched(swing: Swing, targets: tuple[str, ...], values: Values) -> Swing:
    """Each rope is longer by ``c m g / n``, c [m/N] of one rope; where they share the weight alike."""
    longer = values[""] * _stated(swing, "mass") * swing.gravity / len(_radii(swing))
    return _times(swing, np.sqrt(1 + longer / _stated(swing, "length")))


def carried(swing: Swing, targets: tuple[str, ...], values: Values) -> Swing:
    """Air that turns along with the body."""
    return _times(swing, np.sqrt(1 + values[""] / _stated(swing, "inertia")))


def beside(swing: Swing, targets: tuple[str, ...], values: Values) -> Swing:
    """``1 / sqrt(1 - e² / s²)``: with the CoG off the middle of the ropes by e, sum F_i r_i² = m g (s² - e²)."""
    share = values[""] ** 2 / _square(swing)
    if share >= 1:
        problem = (
            f"a CoG {values['']:g} m beside the middle of the ropes, {np.sqrt(_square(swing)):g} m from them, would fall over"
        )
        raise BadInput(source="pendulum", field="off-centre-suspension", problem=problem, remedy="Give a smaller distance")
    return _times(swing, 1 / np.sqrt(1 - share))


def _times(swing: Swing, factor: float) -> Swing:
    return replace(swing, period=swing.period * float(factor))


def _square(swing: Swing) -> float:
    """s1 s2 of two ropes, the mean square of the radii of more: what stands for s² in Eq. 5."""
    radii = _radii(swing)
    return float(radii[0] * radii[1] if len(radii) == 2 else np.mean(radii**2))


def _radii(swing: Swing) -> np.ndarray:
    if not len(swing.radii):
        raise _not_stated("radii")
    return swing.radii


def _stated(swing: Swing, name: str) -> float:
    value: float = getattr(swing, name)
    if value <= 0:
        raise _not_stated(name)
    return value


def _not_stated(name: str) -> BadInput:
    problem = f"the effect needs the pendulum's {name}, which is not stated"
    return BadInput(source="pendulum", field=name, problem=problem, remedy="State it in the measurement file")
