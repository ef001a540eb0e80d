"""How strongly a run was driven, for what depends on it: friction, gaps, saturation, and how fast a sweep passed."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field

import numpy as np

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import MOTIONS
from identification.campaign import Campaign, Excitation, Processing, Run


@dataclass(frozen=True, eq=False, kw_only=True)
class Drive:
    """What one run did to the base.

    Attributes
    ----------
    amplitude : (6,) [m/s², rad/s²] of its motion, zeros where it is not stated
    nominal : (6,) the same of the strongest run along the same axes, the one driven at nominal level
    sweep_rate : [octaves/s], 0 where it is not stated
    block : [s] of the blocks of peak-reference-hold, 0 for other spectra
    """

    amplitude: Array = field(default_factory=lambda: np.zeros(6))
    nominal: Array = field(default_factory=lambda: np.zeros(6))
    sweep_rate: float = 0.0
    block: float = 0.0

    def __post_init__(self) -> None:
        for name in ("amplitude", "nominal"):
            object.__setattr__(self, name, frozen(getattr(self, name), (6,), name))


def drives(campaign: Campaign, method: str) -> dict[str, Drive]:
    """By name of the run; `method` by which its spectra were made."""
    amplitudes = {
        run.name: np.zeros(6) if run.excitation is None else _amplitude(run.excitation, run.axis) for run in campaign.runs
    }
    return {
        run.name: Drive(
            amplitude=amplitudes[run.name],
            nominal=_strongest(amplitudes[run.name], list(amplitudes.values())),
            sweep_rate=_rate(run),
            block=_block(campaign, run, method),
        )
        for run in campaign.runs
    }


def _strongest(one: Array, every: Sequence[Array]) -> Array:
    """The largest of `every` that lies along `one`."""
    alike = [other for other in every if np.array_equal(other > 0, one > 0)]
    return max(alike, key=lambda other: float(np.linalg.norm(other)))


def _rate(run: Run) -> float:
    return (run.excitation.figure("octaves_per_minute") or 0.0) / 60 if run.excitation else 0.0


def _amplitude(excitation: Excitation, axis: str) -> Array:
    """Of a sine; the level of a noise is no amplitude."""
    levels, level = excitation.figures.get("levels"), excitation.figure("level")
    if isinstance(levels, tuple):
        return np.array(levels, dtype=np.float64)
    if excitation.kind != "sine-sweep" or level is None or axis not in MOTIONS:
        return np.zeros(6)
    return np.asarray(level * np.eye(6)[MOTIONS.index(axis)])


def _block(campaign: Campaign, run: Run, method: str) -> float:
    """[s], where records became spectra block by block."""
    recorded = campaign.recordings.get(run.name)
    rate = recorded.sampling_rate if recorded is not None else None
    held = method == "peak-reference-hold" and rate
    return (campaign.processing or Processing()).block_size / rate if held and rate else 0.0
