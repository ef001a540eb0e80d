"""Runs as signal files: every channel of a `Response` by name, as the campaign format has them, whole or not at all.

``.h5`` one dataset a channel in ``/channels``, ``sampling_rate`` on the root; ``.csv`` a column ``time`` and one a channel;
``.npz`` one array a channel and ``sampling_rate``; ``.mat`` one variable a channel and ``fs``, with ``-`` as ``_`` and the sign
of a tip ``+`` as ``p``, because MATLAB's names have neither. Values are SI and bit for bit those that were computed.
"""

from __future__ import annotations

import csv
from collections.abc import Callable, Mapping
from dataclasses import dataclass
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from fem.base_excitation.response import Response
from geometry.arrays import Array
from geometry.atomic import write_with
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput

LOADS = ("fx", "fy", "fz", "mx", "my", "mz")
"""Forces and moments of the table on what stands on it, about the reference point."""

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
    """Look at the ending of `path` before anything is computed.

    Raises
    ------
    BadInput : no file is named, or no format has its ending.
    """
    if not path.name:
        raise BadInput(source="--out", problem="no file is named", remedy="Give one, such as out/x.h5, or leave it out")
    if path.suffix.lower() not in _WRITERS:
        raise BadInput(
            source=str(path),
            field="--out",
            problem=f"a run is written as {', '.join(_WRITERS)}, found {path.suffix or 'no ending'}",
            remedy="Name the file so, the ending chooses the format",
        )


def write(path: Path, response: Response, label: str) -> None:
    """Write all channels of `response`, a run called `label`, in the format that the ending of `path` names.

    Raises
    ------
    BadInput : see `require_ending`.
    """
    require_ending(path)
    write_with(path, lambda temporary: _WRITERS[path.suffix.lower()](temporary, response, label))


def matlab_name(channel: str) -> str:
    """The name of a channel as a variable of MATLAB."""
    return channel.replace("-", "_").replace("+", "p")


def _six(group: str, names: tuple[str, ...], units: tuple[str, ...], values: Array) -> list[Channel]:
    listed = zip(names, units, values.T, strict=True)
    return [Channel(name=f"{group}-{name}", unit=unit, values=signal) for name, unit, signal in listed]


def _along(name: str, dash: str, unit: str, values: Array) -> list[Channel]:
    return [Channel(name=f"{name}{dash}{axis}", unit=unit, values=values[:, k]) for k, axis in enumerate("xyz")]


def _hdf5(path: Path, response: Response, label: str) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        file.attrs["sampling_rate"] = response.sampling_rate
        file.attrs["label"] = label
        group = file.create_group("channels")
        for channel in channels(response):
            group.create_dataset(channel.name, data=channel.values).attrs["unit"] = channel.unit


def _comma_separated(path: Path, response: Response, label: str) -> None:
    signals = channels(response)
    with path.open("w", encoding="utf-8", newline="") as file:
        table = csv.writer(file, lineterminator="\n")
        table.writerow(["time", *(channel.name for channel in signals)])
        rows = zip(response.time.tolist(), *(channel.values.tolist() for channel in signals), strict=True)
        table.writerows(rows)  # floats are written by repr, which reads back to the very same number


def _npz(path: Path, response: Response, label: str) -> None:
    arrays: dict[str, Any] = {channel.name: channel.values for channel in channels(response)}
    np.savez_compressed(path, sampling_rate=np.array(response.sampling_rate), label=np.array(label), **arrays)


def _matlab(path: Path, response: Response, label: str) -> None:
    from scipy.io import savemat

    variables: dict[str, object] = {matlab_name(channel.name): channel.values for channel in channels(response)}
    savemat(path, variables | {"fs": response.sampling_rate}, oned_as="column")


_WRITERS: Mapping[str, Callable[[Path, Response, str], None]] = MappingProxyType(
    {".h5": _hdf5, ".csv": _comma_separated, ".npz": _npz, ".mat": _matlab}
)
