"""Runs as signal files: every channel of a `Response` by name, as the campaign format has them, whole or not at all.

Universal files, HDF5, CSV and MATLAB are written by `identification.files`, which a campaign is read by; ``.npz`` holds one array
a channel and ``sampling_rate``. Values are SI; but for the thirteen digits of an ASCII universal file they are bit for bit
those that were computed.
"""

from __future__ import annotations

from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.base_excitation.response import Response
from geometry.arrays import Array
from geometry.atomic import write_with
from geometry.dynamic_mass import MOTIONS
from identification import files
from identification.files.contents import Signals
from validation import output

LOADS = ("fx", "fy", "fz", "mx", "my", "mz")
"""Forces and moments of the table on what stands on it, about the reference point."""

NPZ = ".npz"
ENDINGS = (*files.FORMATS, NPZ)

MOTION_UNITS = ("m/s^2",) * 3 + ("rad/s^2",) * 3
LOAD_UNITS = ("N",) * 3 + ("N m",) * 3


@dataclass(frozen=True, eq=False, kw_only=True)
class Channel:
    """One signal (n,) in its SI `unit`."""

    name: str
    unit: str
    values: Array


def channels(response: Response) -> tuple[Channel, ...]:
    """All signals of `response`: table, cover plate, loads, cells, places."""
    found = [
        *_six("table", MOTIONS, MOTION_UNITS, response.table),
        *_six("cover", MOTIONS, MOTION_UNITS, response.cover),
        *_six("load", LOADS, LOAD_UNITS, response.load),
    ]
    for number in range(response.cells.shape[1]):
        found += _along(f"cell-{number + 1}", "", "N", response.cells[:, number])
    for place, acceleration in response.places.items():
        found += _along(place, "-", "m/s^2", acceleration)
    return tuple(found)


def require_ending(path: Path) -> None:
    """Refuse a `path` that names no format, as `validation.output.require_ending`."""
    output.require_ending(path, ENDINGS, "a run", "out/x.h5")


def write(path: Path, response: Response, label: str) -> None:
    """Write all channels of `response`, a run called `label`, in the format that the ending of `path` names.

    Raises
    ------
    BadInput : see `require_ending`.
    """
    require_ending(path)
    if path.suffix.lower() == NPZ:
        write_with(path, lambda temporary: _npz(temporary, response, label))
    else:
        files.write(path, _signals(path, response))


def _signals(path: Path, response: Response) -> Signals:
    found = channels(response)
    return Signals(
        source=str(path),
        samples={channel.name: channel.values for channel in found},
        sampling_rate=response.sampling_rate,
        labels={channel.name: channel.unit for channel in found},
    )


def _six(group: str, names: tuple[str, ...], units: tuple[str, ...], values: Array) -> list[Channel]:
    listed = zip(names, units, values.T, strict=True)
    return [Channel(name=f"{group}-{name}", unit=unit, values=signal) for name, unit, signal in listed]


def _along(name: str, dash: str, unit: str, values: Array) -> list[Channel]:
    return [Channel(name=f"{name}{dash}{axis}", unit=unit, values=values[:, k]) for k, axis in enumerate("xyz")]


def _npz(path: Path, response: Response, label: str) -> None:
    arrays: dict[str, Any] = {channel.name: channel.values for channel in channels(response)}
    np.savez_compressed(path, sampling_rate=np.array(response.sampling_rate), label=np.array(label), **arrays)
