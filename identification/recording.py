"""`Recording`: the samples of one run, every channel on one common axis, in SI."""

from __future__ import annotations

from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.errors import BadInput


@dataclass(frozen=True, eq=False, kw_only=True)
class Recording:
    """Time histories, equally sampled, or complex spectra: exactly one of `sampling_rate` and `frequency` is given.

    Attributes
    ----------
    names : of the channels, in the order of the columns
    values : (n, c) float64 time histories or complex128 spectra, in the SI unit of each channel (spectra may be per Hz)
    sampling_rate : [Hz], of time histories
    frequency : (n,) [Hz], of spectra, ascending
    source : the file, for messages
    warnings : what is odd about it, in words
    """

    names: tuple[str, ...]
    values: npt.NDArray[Any]
    sampling_rate: float | None = None
    frequency: Array | None = None
    source: str = "recording"
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        object.__setattr__(self, "names", tuple(self.names))
        values = np.array(self.values, dtype=np.float64 if self.frequency is None else np.complex128)
        if values.ndim != 2 or values.shape[1] != len(self.names):
            raise ValueError(f"`values` must have shape (n, {len(self.names)}), found {values.shape}")
        values.setflags(write=False)
        object.__setattr__(self, "values", values)
        if (self.sampling_rate is None) == (self.frequency is None):
            raise ValueError("give either `sampling_rate` or `frequency`")
        if self.sampling_rate is not None and not 0 < self.sampling_rate < np.inf:
            raise ValueError(f"`sampling_rate` must be positive, found {self.sampling_rate}")
        if self.frequency is not None:
            object.__setattr__(self, "frequency", _lines(self.frequency, len(values)))

    def __len__(self) -> int:
        return len(self.values)

    @property
    def is_spectrum(self) -> bool:
        """Whether these are complex spectra."""
        return self.frequency is not None

    @property
    def duration(self) -> float:
        """[s] from the first sample to one after the last; 0 of spectra."""
        return 0.0 if self.sampling_rate is None else len(self) / self.sampling_rate

    @property
    def time(self) -> Array:
        """(n,) [s], from 0; of time histories."""
        if self.sampling_rate is None:
            raise ValueError("spectra have no time")
        return np.arange(len(self)) / self.sampling_rate

    def channel(self, name: str) -> npt.NDArray[Any]:
        """The samples (n,) of the channel `name`.

        Raises
        ------
        BadInput : there is none of this name.
        """
        if name not in self.names:
            raise BadInput(source=self.source, field=name, problem="there is no such channel", remedy="Check the name")
        column: npt.NDArray[Any] = self.values[:, self.names.index(name)]
        return column


def _lines(frequency: npt.ArrayLike, count: int) -> Array:
    lines = np.array(frequency, dtype=np.float64)
    if lines.shape != (count,) or not np.all(np.isfinite(lines)) or np.any(np.diff(lines) <= 0) or np.any(lines < 0):
        raise ValueError(f"`frequency` must be {count} ascending frequencies, not negative")
    lines.setflags(write=False)
    return lines
