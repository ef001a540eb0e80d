"""`Measured`: complex lines of one data set, as the engine sees them: runs, lines, channels, and nothing of what they are."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import ComplexArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Measured:
    """What one data set read, and how far it can be trusted.

    Attributes
    ----------
    name : of the data set, unique in a problem
    configuration : what was tested; effects on parts of it act wherever it has them
    hardware : id of the measuring equipment; data sets with the same id share its errors
    runs : (r,) names
    axes : (r,) what each run drove, as it is called in words; may be empty
    channels : (c,) names
    judged : (c,) bool, the channels in which the plain error is told: forces, or the responses of an accelerance test
    frequency : (n,) [Hz], ascending
    values : (r, n, c) complex, SI or SI per Hz
    noise : (r, n, c) standard deviation of the complex noise, E|noise|² = sd²
    noise_scatter, noise_spread : relative standard deviation of the noise's power, at one line and of all channels and lines
    inputs : (r, n, k) complex, known inputs such as a drive force of 1 N; None for inputs that nobody knows (base motions),
        which are eliminated line by line
    """

    name: str
    configuration: str
    hardware: str = ""
    runs: tuple[str, ...]
    axes: tuple[str, ...] = ()
    channels: tuple[str, ...]
    judged: npt.NDArray[np.bool_]
    frequency: Array
    values: ComplexArray
    noise: Array
    noise_scatter: float = 0.0
    noise_spread: float = 0.0
    inputs: ComplexArray | None = None

    def __post_init__(self) -> None:
        r, n, c = shape = (len(self.runs), len(self.frequency), len(self.channels))
        object.__setattr__(self, "axes", self.axes or ("",) * r)
        object.__setattr__(self, "frequency", frozen(self.frequency, (n,), "frequency"))
        object.__setattr__(self, "noise", frozen(self.noise, shape, "noise"))
        object.__setattr__(self, "judged", np.array(self.judged, dtype=bool).reshape(c))

    def on(self, runs: Sequence[str]) -> Measured:
        """The runs named alone, in the order in which they stand here."""
        kept = [k for k, run in enumerate(self.runs) if run in runs]
        return replace(
            self,
            runs=tuple(self.runs[k] for k in kept),
            axes=tuple(self.axes[k] for k in kept),
            values=self.values[kept],
            noise=self.noise[kept],
            inputs=None if self.inputs is None else self.inputs[kept],
        )
