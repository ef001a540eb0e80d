"""Signals of MATLAB: variables named as the channels, ``-`` as ``_``, and ``fs`` [Hz] or ``frequency`` [Hz].

Version 5 (-v7) is read through scipy, version 7.3 is HDF5. Files are written in version 5, packed, so that its checksums tell
damage; `write_v73` writes the other.
"""

from __future__ import annotations

from pathlib import Path
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.atomic import write_with
from geometry.errors import BadInput
from identification.files import mat_v5
from identification.files.axis import require_lines
from identification.files.contents import DAMAGED, Samples, Signals, require_file, require_one_length
from identification.files.hdf5_guard import SIGNATURE, datasets, opened, values
from identification.files.mat_names import variable

ENDINGS = (".mat",)

V73 = 512
"""Bytes before the HDF5 part of a file of version 7.3."""

LONGEST_NAME = 63
"""Characters of a variable of MATLAB."""


def read(path: Path) -> Signals:
    """The signals in `path`, under the names of their variables.

    Raises
    ------
    BadInput : no MAT file, damaged, variables that are no vectors of numbers, no axis or two.
    """
    require_file(path)
    source = str(path)
    with path.open("rb") as file:
        head = file.read(V73 + 8)
    found = _v73(path, source) if head[V73:] == SIGNATURE else mat_v5.read(path)
    axes = {name: found.pop(name) for name in ("fs", "frequency") if name in found}
    samples = {name: _vector(numbers, name, source) for name, numbers in found.items()}
    if len(axes) != 1:
        problem = f"one variable fs or frequency is needed, found {'both' if axes else 'neither'}"
        raise BadInput(source=source, field="fs", problem=problem, remedy="Save the one that fits the data")
    if "fs" in axes:
        require_one_length(samples, None, source)
        return Signals(source=source, samples=samples, sampling_rate=_rate(axes["fs"], source))
    lines = _vector(axes["frequency"], "frequency", source).real.astype(np.float64)
    require_lines(lines, source, "frequency")
    require_one_length(samples, len(lines), source)
    return Signals(source=source, samples=samples, frequency=lines)


def write(path: Path, signals: Signals) -> None:
    """Write `signals` to `path` in version 5, whole or not at all.

    Raises
    ------
    BadInput : a channel whose name is no variable of MATLAB, or two that become the same one.
    """
    from scipy.io import savemat

    variables = _variables(signals, str(path))
    write_with(path, lambda temporary: savemat(temporary, variables, do_compression=True, oned_as="column", appendmat=False))


def write_v73(path: Path, signals: Signals) -> None:
    """Write `signals` to `path` in version 7.3, with checksums, whole or not at all.

    Raises
    ------
    BadInput : as in `write`.
    """
    variables = _variables(signals, str(path))
    write_with(path, lambda temporary: _fill_v73(temporary, variables))


def _fill_v73(path: Path, variables: dict[str, Any]) -> None:
    import h5py

    with h5py.File(path, "w", userblock_size=V73, libver=("v110", "v110")) as file:
        for name, numbers in variables.items():
            rows = np.atleast_2d(np.asarray(numbers))  # MATLAB's n x 1 stands as 1 x n: the last index runs first here
            if np.iscomplexobj(rows):
                pairs = np.empty(rows.shape, dtype=[("real", "<f8"), ("imag", "<f8")])
                pairs["real"], pairs["imag"] = rows.real, rows.imag
                rows = pairs
            entry = file.create_dataset(name, data=rows, compression="gzip", fletcher32=True)
            entry.attrs["MATLAB_class"] = np.bytes_("double")
    text = b"MATLAB 7.3 MAT-file, written by massline".ljust(116) + b"\0" * 8 + b"\x00\x02IM"
    with path.open("r+b") as raw:
        raw.write(text)


def _v73(path: Path, source: str) -> dict[str, Samples]:
    with opened(path) as file:
        for name in file:
            _require_numeric(file, name, source)
        return {name: values(one, name, source) for name, one in datasets(file, source).items()}


def _require_numeric(file: Any, name: str, source: str) -> None:
    """Refuse by MATLAB's own word what is no array of numbers; `datasets` refuses what has no such word."""
    import h5py

    if not isinstance(file.get(name, getlink=True), h5py.HardLink):
        return
    kind = file[name].attrs.get("MATLAB_class")
    if kind is not None and bytes(kind) not in (b"double", b"single"):
        problem = f"is of class {bytes(kind).decode('utf-8', errors='replace')!r}, where a vector of numbers is needed"
        raise BadInput(source=source, field=name, problem=problem, remedy="Save signals and fs or frequency only")


def _vector(numbers: Samples, name: str, source: str) -> Samples:
    if numbers.ndim > 2 or (numbers.ndim == 2 and 1 not in numbers.shape):
        shape = " x ".join(map(str, numbers.shape))
        raise BadInput(source=source, field=name, problem=f"must be a vector, found {shape}", remedy="Save one vector a channel")
    return numbers.ravel().astype(np.complex128 if np.iscomplexobj(numbers) else np.float64)


def _rate(numbers: Samples, source: str) -> float:
    rate = np.asarray(numbers).ravel()
    if rate.size != 1 or np.iscomplexobj(rate) or not 0 < rate[0] < np.inf:
        raise BadInput(source=source, field="fs", problem="must be one positive number", remedy=DAMAGED)
    return float(rate[0])


def _variables(signals: Signals, source: str) -> dict[str, float | Array | Samples]:
    found: dict[str, float | Array | Samples] = {}
    if signals.sampling_rate is not None:
        found["fs"] = float(signals.sampling_rate)
    if signals.frequency is not None:
        found["frequency"] = np.asarray(signals.frequency)[:, None]
    for name, samples in signals.samples.items():
        called = variable(name)
        good = called.isidentifier() and called.isascii() and called[0] != "_" and len(called) <= LONGEST_NAME
        if not good or called in found or called in ("fs", "frequency"):
            problem = f"cannot be a variable of MATLAB: {called!r}" + (" is another one already" if called in found else "")
            raise BadInput(source=source, field=name, problem=problem, remedy="Rename the channel, or write .h5")
        found[called] = samples[:, None]
    return found
