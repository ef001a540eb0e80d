"""Seven deviations by each way to read and to mount, with what moves them."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from geometry.frames import Array
from geometry.inertia import Inertia
from identification.request import Known
from table_2_parts import forward
from table_2_parts.candidates import QUARTER, Candidate, candidates
from table_2_parts.forward import CLUMOD, START, TARE, Test
from table_2_parts.published import seven
from table_2_parts.reading import ALL, ROWS
from validation.effects.catalogue import Named
from validation.model.setups import known

STOPS = (0.0, 4.5, 5.0, 6.0)
"""[Hz] at which the band of the reading may have ended, none of them printed; 0: elasticity taken off exactly."""

NOTHING = 1e-6
"""Deviation [%, mm] by a plausible fault below which an effect does not act."""


@dataclass(frozen=True, kw_only=True)
class Way:
    """How the tests were read, and how Clumod stood.

    Attributes
    ----------
    stop : [Hz] of `STOPS`
    turned : whether Clumod stood a quarter turn from the axes of the reference
    rows : of `reading.ROWS`
    """

    stop: float
    turned: bool = False
    rows: str = ALL

    @property
    def tests(self) -> tuple[Test, Test]:
        """Tare and Clumod."""
        angle = QUARTER if self.turned else 0.0
        return Test(article=TARE, stop=self.stop, rows=self.rows), Test(
            article=CLUMOD, stop=self.stop, rows=self.rows, angle=angle
        )

    @property
    def name(self) -> str:
        """In words."""
        band = f"taken for rigid in {START:g}-{self.stop:g} Hz" if self.stop else "elasticity taken off"
        return f"{band}, CoG from {'all rows' if self.rows == ALL else 'forces of rotation sweeps'}"


def ways(turned: bool) -> tuple[Way, ...]:
    """All of them."""
    return tuple(Way(stop=stop, turned=turned, rows=rows) for stop in STOPS for rows in ROWS)


@dataclass(frozen=True, eq=False, kw_only=True)
class Answer:
    """The seven deviations of one way, and what moves them.

    Attributes
    ----------
    way : it
    nominal : (7,) where nothing is wrong
    names : (p,) of the tolerances
    tolerances : (7, p) by one standard deviation of each; the last ten by what is not known of disc and Cuboid
    candidates : effects that act
    effects : (7, c) by a unit of each one's size
    """

    way: Way
    nominal: Array
    names: tuple[str, ...]
    tolerances: Array
    candidates: tuple[Candidate, ...]
    effects: Array


@lru_cache(maxsize=32)
def answer(way: Way) -> Answer:
    """The deviations of `way` with all derivatives."""
    tare, clumod = (forward.read(test) for test in way.tests)
    J = of_ten(clumod.told - tare.told)
    tolerances = difference(clumod.tolerances, tare.tolerances)
    effects = difference(clumod.effects, tare.effects)
    every = [variant for one in candidates() for variant in one.variants]
    columns = [(one, J @ effects[one.name]) for one in every if one.name in effects]
    acting = [(one, column) for one, column in columns if np.abs(column * one.plausible).max() > NOTHING]
    return Answer(
        way=way,
        nominal=seven(article(clumod.told - tare.told)),
        names=(*tolerances, *(f"disc and Cuboid:{k}" for k in range(10))),
        tolerances=np.column_stack([*(J @ one for one in tolerances.values()), J * calibration_deviation()]),
        candidates=tuple(one for one, _ in acting),
        effects=np.column_stack([column for _, column in acting]),
    )


def exact(way: Way, effects: Sequence[Named] = (), offsets: Mapping[str, float] | None = None) -> Array:
    """(7,) of a laboratory with these `effects`, its tolerances at `offsets`; nothing linearised."""
    tare, clumod = (forward.ten(test, effects, offsets) for test in way.tests)
    return seven(article(clumod - tare))


def difference(one: Mapping[str, Array], other: Mapping[str, Array]) -> dict[str, Array]:
    """`one` less `other`, by name; what only one of them has counts as 0 in the other."""
    nothing = np.zeros(10)
    return {name: one.get(name, nothing) - other.get(name, nothing) for name in {**one, **other}}


def article(above: Array) -> Inertia:
    """Clumod in its own frame; `above` (10,) is its set-up less that of the tare, about F."""
    return Inertia(parameters=above + calibration().parameters).moved(-forward.seat().position)


@lru_cache(maxsize=1)
def calibration() -> Inertia:
    """Disc and Cuboid as they stand on the FMD, about F."""
    inertia, _ = known(TARE, forward.campaign(TARE, np.array([START, forward.RIGID_STOP])))
    return inertia or Inertia(parameters=np.zeros(10))


def calibration_deviation() -> Array:
    """(10,) standard deviations of theirs about F: "very high accuracy" by the paper, 0.03 % here."""
    return np.asarray(np.sqrt(np.diag(Known.within(calibration()).covariance)))


def of_ten(above: Array) -> Array:
    """(7, 10) d seven / d ten about F, by central differences: curvature is gentle, rounding far."""
    steps = 1e-5 * np.eye(10)
    return np.column_stack([(seven(article(above + one)) - seven(article(above - one))) / 2e-5 for one in steps])
