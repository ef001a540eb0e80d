"""Effects on the way of a signal: an amplifier's corner, a plate that gives, a sensor at its limit, crossed plugs."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from geometry.arrays import Array
from validation.effects.identifiers import Named
from validation.virtual_test.hooks import Sensed

Change = Callable[[Sensed], Sensed]

VERTICAL = 2


def highpass(named: Named) -> Change:
    """``1 / (1 - i f_c / f)``: a first-order corner at f_c, by the bilinear rule at the rate of the simulation."""

    def change(sensed: Sensed) -> Sensed:
        from scipy.signal import lfilter

        half = np.pi * named.value / sensed.sampling_rate
        filtered = lfilter([1.0, -1.0], [1.0 + half, half - 1.0], sensed.values[:, sensed.column(named.target)])
        return with_column(sensed, named.target, np.asarray(filtered))

    return change


def flexible_cover(named: Named) -> Change:
    """``-omega^2 c f_z``: the cover plate gives c under the whole vertical load, and its pick-ups ride on that along z."""

    def change(sensed: Sensed) -> Sensed:
        if sensed.response is None:
            raise ValueError("`response` must be there: a plate bends under the load that is simulated")
        bending = named.value * second_derivative(sensed.response.load[:, VERTICAL], sensed.sampling_rate)
        seen = [c.places[0].direction[VERTICAL] if c.group == "cover" else 0.0 for c in sensed.table.channels]
        return replace(sensed, values=sensed.values + np.outer(bending, seen))

    return change


def saturation(named: Named) -> Change:
    """``y (1 - s (y / y_p)^2)``, y_p the peak of the run at nominal level: at half the level a quarter of it is lost."""

    def change(sensed: Sensed) -> Sensed:
        y = sensed.values[:, sensed.column(named.target)]
        peak = np.max(np.abs(y), initial=np.finfo(np.float64).tiny) / sensed.level
        return with_column(sensed, named.target, y * (1 - named.value * (y / peak) ** 2))

    return change


def unit(named: Named) -> Change:
    """The numbers of a channel are not in the unit that the file states."""

    def change(sensed: Sensed) -> Sensed:
        return with_column(sensed, named.target, named.value * sensed.values[:, sensed.column(named.target)])

    return change


def swap(named: Named) -> Change:
    """Each of two channels holds what the other measured."""

    def change(sensed: Sensed) -> Sensed:
        one, other = (sensed.column(name) for name in named.targets)
        values = np.array(sensed.values)
        values[:, [one, other]] = values[:, [other, one]]
        return replace(sensed, values=values)

    return change


def with_column(sensed: Sensed, channel: str, values: Array) -> Sensed:
    """`sensed` with other `values` (n,) of one channel."""
    changed = np.array(sensed.values)
    changed[:, sensed.column(channel)] = values
    return replace(sensed, values=changed)


def second_derivative(signal: Array, rate: float) -> Array:
    """Of `signal` (n,) at `rate` [Hz], by central differences: short by (omega / rate)^2 / 12. Nothing moves at its ends."""
    return np.asarray(np.diff(signal, n=2, prepend=signal[:1], append=signal[-1:]) * rate**2)
