"""Signals in HDF5: one dataset a channel in ``/channels/<name>``, and the axis at the root.

Time histories have the attribute ``sampling_rate`` [Hz] on the root, spectra the dataset ``/frequency`` [Hz]. Files written here
carry checksums of samples and structure: a byte that changes on the way is noticed.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

from geometry.atomic import write_with
from geometry.errors import BadInput
from identification.files.axis import require_lines
from identification.files.contents import Samples, Signals, require_file, require_one_length
from identification.files.hdf5_guard import dataset, datasets, number, opened, values

ENDINGS = (".h5", ".hdf5")


def read(path: Path) -> Signals:
    """The signals in `path`.

    Raises
    ------
    BadInput : no HDF5, damaged, links, no channels, no axis or two, channels of different lengths or of more dimensions than one.
    """
    require_file(path)
    source = str(path)
    with opened(path) as file:
        group = _channels(file, source)
        samples = {
            name: _one_dimensional(values(one, name, source), name, source) for name, one in datasets(group, source).items()
        }
        rate = number(file, "sampling_rate", source) if "sampling_rate" in file.attrs else None
        lines = values(dataset(file, "frequency", source), "frequency", source) if "frequency" in file else None
    if (rate is None) == (lines is None):
        found = "neither" if rate is None else "both"
        raise BadInput(
            source=source,
            field="sampling_rate",
            problem=f"an attribute `sampling_rate` of the root or a dataset /frequency is needed, found {found}",
            remedy="Write the one that fits the data",
        )
    if rate is not None and rate <= 0:
        raise BadInput(source=source, field="sampling_rate", problem=f"must be positive, found {rate:g}", remedy="Correct it")
    if lines is not None:
        lines = _one_dimensional(lines, "frequency", source).real
        require_lines(lines, source, "frequency")
    require_one_length(samples, None if lines is None else len(lines), source)
    return Signals(source=source, samples=samples, sampling_rate=rate, frequency=lines)


def write(path: Path, signals: Signals) -> None:
    """Write `signals` to `path`, whole or not at all."""
    write_with(path, lambda temporary: _fill(temporary, signals))


def _fill(path: Path, signals: Signals) -> None:
    import h5py

    with h5py.File(path, "w", libver=("v110", "v110")) as file:
        packed = {"compression": "gzip", "compression_opts": 4, "shuffle": True, "fletcher32": True}
        if signals.frequency is None:
            file.attrs["sampling_rate"] = signals.sampling_rate
        else:
            file.create_dataset("frequency", data=signals.frequency, **packed)
        group = file.create_group("channels", track_order=True)
        for name, samples in signals.samples.items():
            entry = group.create_dataset(name, data=samples, **packed)
            if name in signals.labels:
                entry.attrs["unit"] = signals.labels[name]


def _channels(file: Any, source: str) -> Any:
    import h5py

    link = file.get("channels", getlink=True) if "channels" in file else None
    if not isinstance(link, h5py.HardLink) or not isinstance(file["channels"], h5py.Group):
        problem = "must be a group with one dataset a channel, found " + ("none" if link is None else "something else")
        raise BadInput(source=source, field="channels", problem=problem, remedy="Write /channels/<name>")
    return file["channels"]


def _one_dimensional(found: Samples, name: str, source: str) -> Samples:
    if found.ndim != 1:
        shape = " x ".join(map(str, found.shape)) or "a single number"
        raise BadInput(
            source=source, field=name, problem=f"must have one dimension, found {shape}", remedy="Write it as a vector"
        )
    return found
