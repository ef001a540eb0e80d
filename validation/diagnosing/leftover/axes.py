"""Leftovers in axes: an entry of the dynamic mass, two that mirror each other, an axis whose load or motion is told wrongly."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cached_property

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.observability import LOADS
from validation.diagnosing.leftover.courses import OF_SHARES, Course
from validation.diagnosing.leftover.places import AXIS, PAIR, Family, Place
from validation.diagnosing.leftover.tangents import Swallowing, products


@dataclass(frozen=True, eq=False, kw_only=True)
class Loaded:
    """A base-excitation test, as far as changes of its dynamic mass go.

    Attributes
    ----------
    of : the data set
    by_load : (m, c, 6) what the channels read for a unit of every load
    H : (m, 6, 6) dynamic mass about F
    """

    of: Swallowing
    by_load: ComplexArray
    H: ComplexArray

    @property
    def u(self) -> ComplexArray:
        """(r, m, 6) motions."""
        return self.of.of.inputs

    @cached_property
    def channels(self) -> npt.NDArray[np.int64]:
        """(c',) those that read any load."""
        return np.asarray(np.flatnonzero(np.any(self.by_load != 0, axis=(0, 2))), dtype=np.int64)

    def readings(self, left: ComplexArray, right: ComplexArray) -> ComplexArray:
        """(r, m, c', q) of the changes ``left_q right_q^T`` of the dynamic mass, (m, 6, q) both."""
        answered = np.asarray(np.swapaxes(right, 1, 2) @ self.u[..., None])[..., 0]
        return np.asarray((self.by_load[:, self.channels] @ left) * answered[:, :, None, :])

    def family(self, places: tuple[Place, ...], courses: tuple[Course, ...], readings: ComplexArray) -> Family:
        """Of `readings` (r, m, c', q)."""
        return Family(
            places=places,
            courses=courses,
            products=products(self.of, readings, self.channels),
            root=self.of.root,
            slope=self.of.slope,
        )


def pairs(of: Loaded, courses: tuple[Course, ...]) -> Family:
    """Entries of the dynamic mass one by one, and two of them alike or opposite."""
    places, mixed = _mixed()
    return of.family(places, courses, entries(of) @ mixed)


def entries(of: Loaded) -> ComplexArray:
    """(r, m, c', 36) what the channels read for a unit of every entry of the dynamic mass."""
    u, A1 = of.u, of.by_load[:, of.channels]
    return np.asarray(np.einsum("mci,rmj->rmcij", A1, u, optimize=True)).reshape(*u.shape[:2], A1.shape[1], 36)


def entry(i: int, j: int) -> Array:
    """(36,) a unit of the entry (i, j)."""
    found = np.zeros(36)
    found[6 * i + j] = 1.0
    return found


def _mixed() -> tuple[tuple[Place, ...], Array]:
    """Places, and (36, q) of which entries each is the sum."""
    places, columns = [], []
    for i, load in enumerate(LOADS):
        for j, motion in enumerate(MOTIONS):
            places.append(Place(kind=PAIR, load=load, motion=motion))
            columns.append(entry(i, j))
            if j > i:
                for sign in (1, -1):
                    places.append(Place(kind=PAIR, load=load, motion=motion, sign=sign))
                    columns.append(entry(i, j) + sign * entry(j, i))
    return tuple(places), np.stack(columns, axis=1)


def axes(of: Loaded) -> Family:
    """Axes whose load, or whose motion, is told wrongly."""
    load = (of.H @ of.u[..., None])[..., 0]
    by_load = of.by_load[:, of.channels] * load[:, :, None, :]
    by_motion = -(of.by_load[:, of.channels] @ of.H) * of.u[:, :, None, :]
    places = (*(Place(kind=AXIS, load=one) for one in LOADS), *(Place(kind=AXIS, motion=one) for one in MOTIONS))
    return of.family(places, OF_SHARES, np.concatenate([by_load, by_motion], axis=-1))
