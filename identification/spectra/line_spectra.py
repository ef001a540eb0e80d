"""`Spectra`: complex lines of every channel in every run, and how far each can be trusted."""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import ComplexArray
from geometry.sensors import ChannelTable


@dataclass(frozen=True, eq=False, kw_only=True)
class Spectra:
    """Spectra of a campaign on one grid of lines.

    Attributes
    ----------
    table : channels, in the order of the last axis, and the reference point
    frequency : (n,) [Hz], ascending
    values : (r, n, c) complex, in the channel's SI unit per Hz of a full record, in the SI unit itself of peak-reference-hold
    noise : (r, n, c) standard deviation of the complex noise, E|noise|² = sd², in the unit of `values`; 0 where nothing is known
    quality : (r, n) share [0 to 1] of what the channels read that one rigid base motion and one resultant load explain
    runs : (r,) names
    axes : (r,) of `MOTIONS`, empty for a pattern of several axes
    method : "full-record", "peak-reference-hold", or "spectra" where the files held spectra
    noise_scatter : relative standard deviation of the noise's power at one line; 0 where it is not known
    noise_spread : relative standard deviation of the noise's power, all channels and lines together; 0 where it is not known
    warnings : sentences
    """

    table: ChannelTable
    frequency: Array
    values: ComplexArray
    noise: Array
    quality: Array
    runs: tuple[str, ...]
    axes: tuple[str, ...]
    method: str = "full-record"
    noise_scatter: float = 0.0
    noise_spread: float = 0.0
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        shape = (len(self.runs), len(self.frequency), len(self.table))
        object.__setattr__(self, "frequency", frozen(self.frequency, shape[1:2], "frequency"))
        object.__setattr__(self, "noise", frozen(self.noise, shape, "noise"))
        object.__setattr__(self, "quality", frozen(self.quality, shape[:2], "quality"))
        values = np.array(self.values, dtype=np.complex128)
        if values.shape != shape or not np.all(np.isfinite(values)):
            raise ValueError(f"`values` must be finite and have shape {shape}, found {values.shape}")
        values.setflags(write=False)
        object.__setattr__(self, "values", values)

    def at(self, lines: npt.ArrayLike) -> Spectra:
        """The same on some of the lines alone, (n,) bool or their indices."""
        chosen = np.asarray(lines)
        return replace(
            self,
            frequency=self.frequency[chosen],
            values=self.values[:, chosen],
            noise=self.noise[:, chosen],
            quality=self.quality[:, chosen],
        )
