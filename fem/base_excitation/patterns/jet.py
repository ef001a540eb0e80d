"""`Jet`: a function of time with its first two derivatives, and the product rule.

A pattern writes its displacement as products of such functions (a window, an amplitude, a carrier), and velocity and acceleration
follow to rounding, without a difference quotient.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array

SMOOTH = 5
"""Derivatives of the smooth step that vanish at both of its ends: what is built of it has five continuous derivatives."""


@dataclass(frozen=True, eq=False)
class Jet:
    """A function of time, sampled.

    Attributes
    ----------
    value, first, second : (n,) the function, and its first [1/s] and second [1/s²] derivative with respect to time
    """

    value: Array
    first: Array
    second: Array

    def __add__(self, other: Jet) -> Jet:
        return Jet(self.value + other.value, self.first + other.first, self.second + other.second)

    def __mul__(self, other: Jet) -> Jet:
        """The product of two functions: (a b)'' = a'' b + 2 a' b' + a b''."""
        return Jet(
            self.value * other.value,
            self.first * other.value + self.value * other.first,
            self.second * other.value + 2 * self.first * other.first + self.value * other.second,
        )

    def __rmul__(self, factor: float) -> Jet:
        return Jet(factor * self.value, factor * self.first, factor * self.second)


def sine(phase: Jet) -> Jet:
    """Sine of an angle [rad] that is itself a function of time."""
    s, c = np.sin(phase.value), np.cos(phase.value)
    return Jet(s, phase.first * c, phase.second * c - phase.first**2 * s)


def exponential(time: Array, factor: float, rate: float) -> Jet:
    """`factor` times exp(`rate` t) of `time` (n,) [s]."""
    value = factor * np.exp(rate * time)
    return Jet(value, rate * value, rate**2 * value)


def smooth_step(time: Array, begin: float, end: float) -> Jet:
    """From 0 at `begin` to 1 at `end` [s], with `SMOOTH` continuous derivatives; constant outside.

    With x from 0 to 1 between the two its derivative is x^p (1 - x)^p over the integral of that, p = `SMOOTH`: the step is the
    regularised incomplete beta function I_x(p + 1, p + 1).
    """
    from scipy.special import beta, betainc

    p, length = SMOOTH, end - begin
    x = np.clip((time - begin) / length, 0.0, 1.0)
    rising = (x > 0) & (x < 1)
    r = x[rising]
    value, first, second = (x >= 1).astype(np.float64), np.zeros_like(x), np.zeros_like(x)
    value[rising] = betainc(p + 1, p + 1, r)
    bell = (r * (1 - r)) ** (p - 1) / beta(p + 1, p + 1)
    first[rising] = bell * r * (1 - r) / length
    second[rising] = p * bell * (1 - 2 * r) / length**2
    return Jet(value, first, second)


def window(time: Array, begin: float, full: float, fading: float, end: float) -> Jet:
    """1 between `full` and `fading`, 0 before `begin` and after `end` [s], smooth in between."""
    fall = smooth_step(time, fading, end)
    return smooth_step(time, begin, full) * Jet(1 - fall.value, -fall.first, -fall.second)
