"""What a signal file holds, whatever its format: samples by name, one common axis, and the units that the file itself states."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.errors import BadInput

LARGEST_BYTES = 2 * 2**30
"""A run of more is refused, on disk and unpacked: 22 channels at 8192 Hz take 0.13 GiB in ninety seconds."""

TOO_LARGE = "Split the run, or record it at a lower rate"

DAMAGED = "Copy or export it again; it may be cut short or damaged"

Samples = npt.NDArray[Any]
"""(n,) float64 or complex128, in the unit of the file."""


@dataclass(frozen=True, kw_only=True)
class StatedUnits:
    """Dataset 164 of a universal file, as it stands before a channel.

    Attributes
    ----------
    length, force : what one unit of the file is in SI [m], [N]
    words : how the file calls the system
    """

    length: float
    force: float
    words: str

    def size(self, quantity: str) -> float:
        """What one unit of `quantity` is in SI."""
        return {"acceleration": self.length, "force": self.force, "moment": self.force * self.length}[quantity]


@dataclass(frozen=True, eq=False, kw_only=True)
class Signals:
    """The contents of one file.

    Attributes
    ----------
    source : the file
    samples : by name of the channel, all of one length
    sampling_rate : [Hz], of time histories
    frequency : (n,) [Hz], of spectra
    units : by name of the channel, the system of units that the file states for it
    labels : by name of the channel, what the file calls its unit; empty where it does not
    warnings : what is odd, in words
    """

    source: str
    samples: Mapping[str, Samples]
    sampling_rate: float | None = None
    frequency: Array | None = None
    units: Mapping[str, StatedUnits] = field(default_factory=dict)
    labels: Mapping[str, str] = field(default_factory=dict)
    warnings: tuple[str, ...] = ()


def require_file(path: Path) -> None:
    """Refuse what is no regular file of a size that can be read: folders, links, devices, pipes.

    Raises
    ------
    BadInput : which of them it is.
    """

    def refused(problem: str, remedy: str = "Put the signals into a file of the folder") -> BadInput:
        return BadInput(source=str(path), problem=problem, remedy=remedy)

    if path.is_symlink():
        raise refused("it is a link, which is not followed")
    if not path.exists():
        raise refused("there is no such file", "Check the name")
    if not path.is_file():
        raise refused("it is no regular file but a folder, a device or a pipe")
    size = path.stat().st_size
    if size > LARGEST_BYTES:
        raise too_large(str(path), size)


def too_large(source: str, size: int) -> BadInput:
    """The refusal of `size` bytes."""
    problem = f"it takes {size / 2**30:.3g} GiB, more than {LARGEST_BYTES / 2**30:.3g}"
    return BadInput(source=source, problem=problem, remedy=TOO_LARGE)


def require_one_length(samples: Mapping[str, Samples], count: int | None, source: str) -> None:
    """Refuse channels of different lengths, or without samples; `count` is what the axis has.

    Raises
    ------
    BadInput : the first channel whose length is another.
    """
    if not samples:
        raise BadInput(source=source, problem="it holds no channel", remedy=DAMAGED)
    first = next(iter(samples))
    wanted = len(samples[first]) if count is None else count
    if wanted < 2:
        problem = f"holds {wanted} samples, and at least two are needed"
        raise BadInput(source=source, field=first, problem=problem, remedy=DAMAGED)
    for name, values in samples.items():
        if len(values) != wanted:
            against = f"{first} has {wanted}" if count is None else f"the axis has {wanted}"
            problem = f"has {len(values)} samples where {against}"
            raise BadInput(source=source, field=name, problem=problem, remedy="Record all channels at one rate and length")


def as_complex(real: npt.ArrayLike, imaginary: npt.ArrayLike) -> Samples:
    """Complex numbers (n,) of two parts; infinite ones stay what they are, which a sum with 1j would make NaN."""
    parts = np.asarray(real, dtype=np.float64), np.asarray(imaginary, dtype=np.float64)
    found = np.empty(parts[0].shape, dtype=np.complex128)
    found.real, found.imag = parts
    return found
