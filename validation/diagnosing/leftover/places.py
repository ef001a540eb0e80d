"""`Place` and `Family`: where a leftover may sit, and what places of one kind do to the readings of a data set."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from validation.diagnosing.leftover.courses import Course
from validation.diagnosing.leftover.tangents import Answers, following
from validation.engine.screening import Products

CHANNEL, GROUP, PAIR, LOCATION, JOINT, PART, HEARD, SPAN, AXIS = KINDS = (
    *("channel", "group", "pair", "location", "joint", "part", "heard", "span", "axis"),
)
"""A channel; a group of channels; a pair of axes; a place of the article; the joint under it; a part or a mode; a channel and
what it hears; several pairs of axes at once; the load or the motion of one axis as channels tell it. The plainest first."""


@dataclass(frozen=True, kw_only=True)
class Place:
    """Where.

    Attributes
    ----------
    kind : of `KINDS`
    load, motion : of a pair, of the leading one of several, of what is heard; one of them of an axis
    sign : +1 of a pair that is symmetric, -1 of one that is antisymmetric, 0 of one entry alone
    others : further pairs that take part, by load and motion
    channels : that show it; the first one hears the second
    part : name of a parameter, of a group, or of a place of the article
    along : direction at a place of the article
    to : what a place of the article is tied to
    unit : of a reading per unit of what is heard; empty where it is not stated
    """

    kind: str
    load: str = ""
    motion: str = ""
    sign: int = 0
    others: tuple[tuple[str, str], ...] = ()
    channels: tuple[str, ...] = ()
    part: str = ""
    along: str = ""
    to: str = ""
    unit: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Family:
    """Places of one kind in one data set, and the courses that they may take.

    Attributes
    ----------
    places : (q,)
    courses : (k,)
    products : of the places, line by line
    root, slope : as `Swallowing` has them
    """

    places: tuple[Place, ...]
    courses: tuple[Course, ...]
    products: Products
    root: Array
    slope: Array

    def answers(self) -> Answers:
        """(k, q) of all courses."""
        omega = 2 * np.pi * self.products.frequency
        return following(self.products, np.stack([course.of(omega) for course in self.courses]), self.root)
