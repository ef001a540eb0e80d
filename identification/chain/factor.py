"""What happens to a signal on its way from the sensor to the record: gain, delay of channel and board, high-pass.

    factor = (1 + g) e^{-i omega (tau + tau_board)} / (1 - i f_c / f)

with a late channel's delay positive, and f_c the corner of the charge amplifier's high-pass of first order.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.tolerances import Tolerances
from identification.chain.parameter import Offsets, Parameter


def parameters(names: tuple[str, ...], first: int, kind: str, board: str, gain: float, known: Tolerances) -> Iterator[Parameter]:
    """Gain and delay of the channels `names`, columns `first` and on, of `kind` ("force", "accelerometer") on `board`."""
    columns = range(first, first + len(names))
    for k, name in zip(columns, names, strict=True):
        yield Parameter(name=f"{kind}-gain:{name}", unit="1", tolerance=gain, channels=(k,))
    for k, name in zip(columns, names, strict=True):
        yield Parameter(name=f"{kind}-delay:{name}", unit="s", tolerance=known.delay, channels=(k,))
    if kind == "force":
        for k, name in zip(columns, names, strict=True):
            yield Parameter(name=f"force-highpass:{name}", unit="Hz", tolerance=0.0, channels=(k,))
    yield Parameter(name=f"board-delay:{board}", unit="s", tolerance=0.0, channels=tuple(columns))


def factors(names: tuple[str, ...], kind: str, board: str, x: Offsets, frequency: Array) -> ComplexArray:
    """(n, c) at `frequency` (n,) [Hz]."""
    gain, late, corner = (
        np.array([x.get(f"{family}:{name}", 0.0) for name in names])
        for family in (f"{kind}-gain", f"{kind}-delay", "force-highpass")
    )
    turns = np.outer(frequency, late + x.get(f"board-delay:{board}", 0.0))
    passed = 1 - 1j * corner / frequency[:, None] if np.any(corner) else 1.0
    return np.asarray((1 + gain) * np.exp(-2j * np.pi * turns) / passed, dtype=np.complex128)


def changes(
    names: tuple[str, ...], kind: str, board: str, x: Offsets, frequency: Array, wanted: Collection[str]
) -> Iterator[tuple[str, list[int], ComplexArray]]:
    """By parameter of those `wanted`: which of `names` it touches, and d ln(factor) / d parameter of these, (n, k)."""
    late = np.asarray(-2j * np.pi * frequency[:, None], dtype=np.complex128)
    for k, name in enumerate(names):
        if (key := f"{kind}-gain:{name}") in wanted:
            yield key, [k], np.full((len(frequency), 1), 1 / (1 + x[key]), dtype=np.complex128)
        if (key := f"{kind}-delay:{name}") in wanted:
            yield key, [k], late
        if (key := f"force-highpass:{name}") in wanted:
            yield key, [k], np.asarray(1j / (frequency - 1j * x[key]))[:, None]
    if (key := f"board-delay:{board}") in wanted:
        yield key, list(range(len(names))), np.repeat(late, len(names), axis=1)
