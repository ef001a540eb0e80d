"""From the rate of a simulation to that of a record: one anti-alias filter for all channels, then every q-th sample.

Sampled motion is not piecewise linear, which every recursion takes it for: at the rates of a test (0.5 to 2 kHz) that alone
biases the elastic part of the response. A run is therefore simulated at `LEAST` or more and brought down here.

The filter is a symmetric FIR (Kaiser window), its delay taken off again, so that it changes no phase: up to `PASS` of the
Nyquist frequency of the record amplitudes change by less than `RIPPLE`, and from that Nyquist frequency on everything is pressed
below `RIPPLE`. What it does to one channel it does to all, so ratios of channels stay what they were. At both ends of the record
it takes for granted that all is at rest beyond.
"""

from __future__ import annotations

from collections.abc import Iterable
from dataclasses import dataclass, replace
from functools import cache
from math import ceil, floor, isfinite
from typing import Any, overload

import numpy as np
import numpy.typing as npt

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.response import Response
from geometry.errors import BadInput
from geometry.frames import Array

LEAST = 8000.0
"""[Hz] at which a run is simulated at least."""

PASS = 0.8
"""Of the Nyquist frequency of the record: up to here the filter lets everything through."""

RIPPLE = 1e-6
"""Largest relative change of an amplitude in the pass-band, and what is left of one in the stop-band (-120 dB)."""

HALF = 44
"""Samples of the record on each side of a sample that the filter looks at; enough for `PASS` and `RIPPLE`."""

POINTS = 12
"""Samples through which a delay by a part of a sample is interpolated."""

BLOCK = 1024
"""Samples of the record that are filtered at a time, to spare memory."""


def simulation_rate(output_rate: float, least: float = LEAST) -> float:
    """The smallest whole multiple of `output_rate` that is `least` [Hz] or more.

    Raises
    ------
    BadInput : a rate that is not positive.
    """
    _require_rate(output_rate, "output_rate")
    return output_rate * max(1, ceil(least / output_rate - 1e-9))


def pass_band(rate: float) -> float:
    """[Hz] up to which a record of `rate` [Hz] holds amplitudes as they were."""
    return PASS * rate / 2


def require_recorded(highest: float, rate: float, source: str) -> None:
    """Refuse a record whose rate is too low for what is driven.

    Raises
    ------
    BadInput : `highest` [Hz] lies beyond the Nyquist frequency of `rate` [Hz], or beyond the pass-band of the filter.
    """
    _require_rate(rate, "rate")
    if highest > pass_band(rate):
        nyquist = f"Nyquist frequency of {rate / 2:g} Hz"
        limit = nyquist if highest >= rate / 2 else f"pass-band of the anti-alias filter, {pass_band(rate):g} Hz"
        raise BadInput(
            source=source,
            field="rate",
            problem=f"it drives up to {highest:.4g} Hz, beyond the {limit}, that a record of {rate:g} Hz has",
            remedy=f"Record at {2 * highest / PASS:.4g} Hz or more, or stop the excitation lower",
        )


@overload
def decimated(record: BaseMotion, rate: float) -> BaseMotion: ...


@overload
def decimated(record: Response, rate: float) -> Response: ...


def decimated(record: BaseMotion | Response, rate: float) -> BaseMotion | Response:
    """`record` at `rate` [Hz], all channels through the one filter; itself when it has that rate already.

    Raises
    ------
    BadInput : `rate` is not positive, or the record's rate is not a whole multiple of it.
    """
    factor = _factor(record.sampling_rate, rate)
    if factor == 1:
        return record
    if isinstance(record, BaseMotion):
        motion_rate = record.sampling_rate / factor
        return replace(
            record,
            sampling_rate=motion_rate,
            displacement=_filtered(record.displacement, factor),
            velocity=_filtered(record.velocity, factor),
            acceleration=_filtered(record.acceleration, factor),
            driven=min(record.driven + HALF / motion_rate, record.duration),
        )
    response_rate = record.sampling_rate / factor
    channels: dict[str, Any] = {
        name: _filtered(getattr(record, name), factor) for name in ("table", "cover", "load", "cells", "coordinates")
    }
    return replace(
        record,
        **channels,
        sampling_rate=response_rate,
        places={name: _filtered(channel, factor) for name, channel in record.places.items()},
        settings={**record.settings, "anti_alias": _described(record.sampling_rate, response_rate)},
    )


def decimated_channels(channels: Array, simulated: float, rate: float, delay: npt.ArrayLike = 0.0) -> Array:
    """Samples (n, c) at the rate `simulated` [Hz] brought down to `rate` [Hz], each channel `delay` (c,) [s] later.

    Raises
    ------
    BadInput : `rate` is not positive, or `simulated` is not a whole multiple of it.
    """
    late = np.broadcast_to(np.asarray(delay, dtype=np.float64) * simulated, (channels.shape[1],))
    factor = _factor(simulated, rate)
    return channels if factor == 1 and not late.any() else _apart(channels, factor, late)


@cache
def taps(factor: int) -> Array:
    """The anti-alias filter for every `factor`-th sample: (2 `HALF` `factor` + 1,), symmetric, of sum 1."""
    from scipy.signal import firwin, kaiser_beta

    middle = (1 + PASS) / 2 / factor
    found = np.asarray(firwin(2 * HALF * factor + 1, middle, window=("kaiser", kaiser_beta(-20 * np.log10(RIPPLE)))))
    found.setflags(write=False)
    return found


def _described(simulated: float, rate: float) -> dict[str, object]:
    return {
        "simulated_at_hz": simulated,
        "recorded_at_hz": rate,
        "pass_band_hz": pass_band(rate),
        "stop_band_hz": rate / 2,
        "ripple": RIPPLE,
        "filter": "symmetric FIR, Kaiser window, delay compensated",
    }


def _filtered(channels: Array, factor: int) -> Array:
    """Every `factor`-th of the filtered samples (n, ...), the first one kept in its place."""
    width = int(np.prod(channels.shape[1:]))
    found = _apart(channels.reshape(len(channels), width), factor, np.zeros(width))
    return found.reshape(len(found), *channels.shape[1:])


def _apart(columns: Array, factor: int, late: Array) -> Array:
    """Every `factor`-th of the filtered samples (n, c), each column `late` (c,) samples later; (ceil(n / factor), c)."""
    step = BLOCK * factor
    return joined((columns[start : start + step].T for start in range(0, len(columns), step)), factor, late)


def joined(blocks: Iterable[Array], factor: int, late: npt.ArrayLike) -> Array:
    """Every `factor`-th of the filtered samples of channels in `blocks` (c, k), each `late` (c,) samples later: (m, c)."""
    pieces = [_cut(factor, float(samples)) for samples in np.atleast_1d(np.asarray(late, dtype=np.float64))]
    longest, earliest = max((len(one.table) for one in pieces), default=1), min((one.before for one in pieces), default=0)
    found: list[Array] = []
    held, base, done, count = np.zeros((len(pieces), 0)), 0, 0, 0
    for block in blocks:
        held = np.hstack([held, block])
        count = base + held.shape[1]
        ready = max((count + earliest) // factor - longest + 1, done)
        found.append(_several(held, base, pieces, done, ready, factor))
        first = max(ready * factor - max((one.before for one in pieces), default=0), base)
        held, base, done = held[:, first - base :], first, ready
    found.append(_several(held, base, pieces, done, ceil(count / factor), factor))
    return np.asarray(np.hstack(found).T)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Cut:
    """A filter cut into pieces of as many coefficients as samples are left out, `table` (pieces, factor), latest sample last.

    The first coefficient belongs to the sample that comes `before` so many samples before the one that is wanted.
    """

    table: Array
    before: int


def _cut(factor: int, late: float) -> _Cut:
    first, coefficients = delayed_taps(factor, late)
    size = ceil(len(coefficients) / factor) * factor
    table = np.zeros(size)
    table[size - len(coefficients) :] = coefficients[::-1]
    return _Cut(table=table.reshape(-1, factor), before=first + size - 1)


def _several(held: Array, base: int, pieces: list[_Cut], start: int, stop: int, factor: int) -> Array:
    """Samples `start` to `stop` of the record, (c, stop - start); `held` (c, k) begins at the sample `base`."""
    found = np.zeros((len(pieces), stop - start))
    for row, signal, cut in zip(found, held, pieces, strict=True):
        # `count` samples of `signal` from `begin` on, at rest beyond both its ends
        begin = start * factor - cut.before - base
        count = (stop - start + len(cut.table) - 1) * factor
        low, high = max(begin, 0), min(begin + count, len(signal))
        if low == begin and high == begin + count:
            samples = signal[low:high]
        else:
            samples = np.zeros(count)
            if high > low:
                samples[low - begin : high - begin] = signal[low:high]
        for k, products in enumerate(cut.table @ samples.reshape(-1, factor).T):
            row += products[k : k + stop - start]
    return found


def delayed_taps(factor: int, samples: float) -> tuple[int, Array]:
    """`taps` that delay by so many `samples` as well, and how many samples before the middle they begin.

    A delay is a polynomial through `POINTS` samples around it (Lagrange), which for motion far below the rate of the simulation
    is exact to rounding; a whole number of samples is exact for any.
    """
    if samples == 0.0:
        return -HALF * factor, taps(factor)
    first = floor(samples) - POINTS // 2 + 1
    nodes = first + np.arange(POINTS)
    weights = [np.prod([(samples - other) / (node - other) for other in nodes if other != node]) for node in nodes]
    return first - HALF * factor, np.convolve(taps(factor), weights)


def _factor(simulated: float, rate: float) -> int:
    _require_rate(rate, "rate")
    factor = max(1, round(simulated / rate))
    if abs(simulated / rate - factor) > 1e-9 * factor:
        less, more = simulated / (int(simulated / rate) + 1), simulated / max(1, int(simulated / rate))
        below = f"Record at {less:g} or {more:g} Hz" if rate < simulated else f"Record at {simulated:g} Hz or less"
        raise BadInput(
            source="decimation",
            field="rate",
            problem=f"the simulation's {simulated:g} Hz must be a whole multiple of it, found {rate:g} Hz",
            remedy=f"{below}, or simulate at {simulation_rate(rate, simulated):g} Hz",
        )
    return factor


def _require_rate(rate: float, field: str) -> None:
    if not (isfinite(rate) and rate > 0):
        problem = f"must be positive and finite, found {rate:g} Hz"
        raise BadInput(source="decimation", field=field, problem=problem, remedy="Give a positive rate")
