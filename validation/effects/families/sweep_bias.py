"""`sweep-bias`."""

from __future__ import annotations

from validation.effects.effect import BODY_STAGE, PROCESSING, Family
from validation.effects.stages import held

FAMILY = Family(
    name="sweep-bias",
    side=PROCESSING,
    what="peak-hold near a lightly damped mode",
    example="sweep-bias",
    stage=BODY_STAGE,
    change=held,
    equation="H'(f) = ∫ H(ν) k(ν) dν / ∫ k(ν) dν, k = W(f - ν) exp(-i π (ν - f)² / s), s the sweep rate in Hz/s, "
    "W of the block's Hann window",
    mistaken_for=("structural-damping", "layer-damping", "accelerometer-gain"),
    confirmed_by="the full-record spectrum of the same run; longer blocks. A slower sweep does not help",
    reference="short-time spectrum of a linear chirp by stationary phase; Harris, Proc. IEEE 66 (1978) 51-83, for the window",
    sentence="Peak-hold spectra cut the record into blocks, and a lightly damped mode rings on from one into the next: its peak "
    "looks lower and wider than it is, up to 44 % at 0.35 % damping. Nothing is wrong with the structure.",
)
