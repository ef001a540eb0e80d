"""Force and moment channels: from the load on the structure to what they read.

    y = factor · S · diag(1 - lost) · R · X · H u

X lets a resultant show in others (cross-talk of the measuring plane, moments that the cells miss), R shares the load between the
sensing elements, part of what each carries may pass it by (shunt), and S, the summation box, adds elements up. A moment channel
beside elements that carry everything reads the resultant moment.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.sensors import Summation
from geometry.tolerances import Tolerances
from identification.chain import factor
from identification.chain.cells import Springs
from identification.chain.parameter import Offsets, Parameter
from identification.chain.placed import Placed

AXES = "xyz"
CROSSTALK = tuple(f"{i}{j}" for i in AXES for j in AXES if i != j)
"""``zx``: the x resultant shows in the z channels."""

SHUNTS = {f"load-path-shunt:{axis}": k for k, axis in enumerate(AXES)}
"""By name of the parameter: the axis along which a load goes past the cells."""

OFFSETS = {"x": (4, 0, -1.0), "y": (3, 1, 1.0)}
"""By axis of the force at height h: row and column of X and sign: M_y -= h F_x, M_x += h F_y."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Loads(Placed):
    """The force side of a chain.

    Attributes
    ----------
    sums : their elements and sums about the reference point
    springs : the load cells
    """

    sums: Summation
    springs: Springs


def parameters(part: Loads, known: Tolerances) -> Iterator[Parameter]:
    """All that `part` could do wrong, with the tolerance of an ordinary laboratory; 0 for what none expects."""
    all_of_them = part.columns
    yield from factor.parameters(part.names, part.first, "force", "force", known.gain, known)
    for pair in CROSSTALK if part.channels else ():
        yield Parameter(name=f"force-crosstalk:{pair}", unit="1", tolerance=known.crosstalk, channels=all_of_them)
    for axis in AXES if part.channels else ():
        yield Parameter(name=f"load-path-shunt:{axis}", unit="1", tolerance=0.0, channels=all_of_them)
    for axis in OFFSETS if part.channels else ():
        yield Parameter(name=f"force-plane-offset:{axis}", unit="m", tolerance=0.0, channels=all_of_them)


def rows(part: Loads, x: Offsets, frequency: Array) -> ComplexArray:
    """A1 of the force channels, (n, c, 6): what they read for a unit load at `frequency` (n,) [Hz]."""
    f = factor.factors(part.names, "force", "force", x, frequency)
    return np.asarray(f[:, :, None] * _mixed(part, x))


def changes(part: Loads, x: Offsets, frequency: Array, wanted: Collection[str]) -> Iterator[tuple[str, list[int], ComplexArray]]:
    """By open parameter of those `wanted`: the channels of `part` it touches and d A1 / d offset of these, (n, k, 6)."""
    f = factor.factors(part.names, "force", "force", x, frequency)
    reading, X, even = _reading(part, x), _moved(x), _even(part)
    A1 = f[:, :, None] * _mixed(part, x)
    for key, touched, slope in factor.changes(part.names, "force", "force", x, frequency, wanted):
        yield key, touched, slope[:, :, None] * A1[:, touched]
    every = list(range(len(part.channels)))
    for key, change in _reading_changes(part, x):
        if key in wanted:
            yield key, every, f[:, :, None] * (change @ X + even @ _heard(x) @ _lost(key))
    for key, change in _crosstalk(x):
        if key in wanted:
            yield key, every, f[:, :, None] * (even @ change @ _carried(x))
    for key, change in _offsets(x):
        if key in wanted:
            yield key, every, f[:, :, None] * (reading @ change)


def _mixed(part: Loads, x: Offsets) -> Array:
    """(c, 6) reading for a unit resultant load: cells share it as they are stiff, and cross-talk shows in all of them alike."""
    return np.asarray(_reading(part, x) @ _moved(x) + _even(part) @ _heard(x) @ _carried(x))


def _heard(x: Offsets) -> Array:
    """(6, 6) what shows in channels of other axes of what the cells carry."""
    return np.zeros((6, 6)) + sum(x[key] * change for key, change in _crosstalk(x))


def _carried(x: Offsets) -> Array:
    """(6, 6) what shunts leave to the cells of a resultant load."""
    return np.eye(6) + sum(x.get(key, 0.0) * _lost(key) for key in SHUNTS)


def _lost(key: str) -> Array:
    """(6, 6) d `_carried` / d offset of the parameter `key`; zero of one that is no shunt."""
    axis = SHUNTS.get(key)
    return np.zeros((6, 6)) if axis is None else -_unit(axis, axis)


def _even(part: Loads) -> Array:
    """(c, 6) reading for a unit resultant load of cells that are all alike."""
    return np.asarray(part.sums.adds @ _sharing(part, {}))


def _reading(part: Loads, x: Offsets) -> Array:
    """(c, 6) reading for a unit resultant load, before the signal's way to the record."""
    return np.asarray(part.sums.adds @ (_passing(part, x)[:, None] * _sharing(part, x)))


def _sharing(part: Loads, x: Offsets) -> Array:
    """(e, 6) reading of every element for a unit resultant load."""
    if not part.springs.of_cells:
        return np.asarray(np.linalg.pinv(part.sums.gives))
    R = part.sums.gives.T.copy()  # of a moment: its row, that of the resultant moment itself
    R[_of_force(part)] = part.springs.sharing(x)
    return np.asarray(R)


def _passing(part: Loads, x: Offsets) -> Array:
    """(e,) share of each element's load that a shunt leaves to it."""
    lost = np.array([x.get(f"load-path-shunt:{axis}", 0.0) for axis in AXES])
    return np.asarray(1 - lost @ _along(part))


def _along(part: Loads) -> Array:
    """(3, e) how far a force element measures along each axis, adding up to 1; 0 for moments."""
    return np.asarray(part.sums.gives[:3] ** 2)


def _of_force(part: Loads) -> list[int]:
    return [e for e, (quantity, _) in enumerate(part.sums.elements) if quantity == "force"]


def _moved(x: Offsets) -> Array:
    """(6, 6) the resultant load about the true plane of the cells from that about the stated one."""
    return np.eye(6) + sum(x[key] * change for key, change in _offsets(x))


def _crosstalk(x: Offsets) -> Iterator[tuple[str, Array]]:
    for pair in CROSSTALK:
        if (key := f"force-crosstalk:{pair}") in x:
            yield key, _unit(AXES.index(pair[0]), AXES.index(pair[1]))


def _offsets(x: Offsets) -> Iterator[tuple[str, Array]]:
    for axis, (row, column, sign) in OFFSETS.items():
        if (key := f"force-plane-offset:{axis}") in x:
            yield key, sign * _unit(row, column)


def _reading_changes(part: Loads, x: Offsets) -> Iterator[tuple[str, Array]]:
    """d `_reading` / d offset, (c, 6), of stiffnesses and shunts."""
    passing, adds = _passing(part, x), part.sums.adds
    if part.springs.of_cells:
        force = _of_force(part)
        for key, change in part.springs.sharing_changes(x):
            yield key, adds[:, force] @ (passing[force, None] * change)
    for axis, along in zip(AXES, _along(part), strict=True):
        if (key := f"load-path-shunt:{axis}") in x:
            yield key, -adds @ (along[:, None] * _sharing(part, x))


def _unit(row: int, column: int) -> Array:
    E = np.zeros((6, 6))
    E[row, column] = 1.0
    return E
