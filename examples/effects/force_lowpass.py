"""`force-lowpass`: the filter of a charge amplifier droops and lags, y / (1 + i omega tau). One file, whole."""

from dataclasses import replace

import numpy as np

from validation.effects.effect import CHANNEL_STAGE, FORCES, Family, SizeSpec
from validation.effects.plants import at


def change(reading, targets, values):
    rows = np.array(reading.rows)  # a copy: what an equation gets cannot be written to
    rows[:, reading.column(targets[0])] /= 1 + 2j * np.pi * reading.frequency[:, None] * values[""]
    return replace(reading, rows=rows)


def filtered(named):
    def signals(sensed):
        from scipy.signal import lfilter

        k, values = sensed.column(named.target), np.array(sensed.values)
        step = 2 * sensed.sampling_rate * named.value  # bilinear rule
        values[:, k] = lfilter([1, 1], [1 + step, 1 - step], values[:, k])
        return replace(sensed, values=values)

    return signals


FAMILY = Family(
    name="force-lowpass",
    side=FORCES,
    what="first-order low-pass of a charge amplifier",
    targets=("force channel",),
    sizes=(SizeSpec(unit="s", low=0.0, high=0.1, plausible=1e-3),),
    example="force-lowpass:fmd-z2=1e-3",
    stage=CHANNEL_STAGE,
    change=change,
    equation="y' = y / (1 + i ω τ)",
    mistaken_for=("force-delay", "force-gain"),
    confirmed_by="the filter switch of the amplifier; a level that falls with frequency as the phase turns",
    reference="first-order low-pass; unlike a delay it also droops, by (omega tau)² / 2",
    sentence="The amplifier of {target} is too slow: it reads fast forces late and a little too small.",
    plant=at("signals", filtered),
)
