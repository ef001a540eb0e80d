"""Every place in which a leftover of one data set may sit, with the courses that it may take there."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from validation.diagnosing.leftover import article
from validation.diagnosing.leftover.axes import Loaded, axes, pairs
from validation.diagnosing.leftover.channels import channels, tilting
from validation.diagnosing.leftover.courses import OF_PAIRS, OF_SHARES, resonances
from validation.diagnosing.leftover.places import Family
from validation.diagnosing.leftover.tangents import Swallowing
from validation.engine.prediction import Offsets
from validation.prediction.series import SeriesPrediction


def loaded(of: Swallowing, offsets: Offsets) -> Loaded | None:
    """The dynamic mass of a data set; None of one that is no base-excitation test."""
    prediction = of.of.prediction
    if not isinstance(prediction, SeriesPrediction):
        return None
    lines = of.of.lines
    return Loaded(of=of, by_load=prediction.by_load(offsets, lines), H=prediction.dynamic_mass(offsets, lines))


def families(of: Swallowing, offsets: Offsets, loads: Loaded | None) -> Iterator[Family]:
    """All of one data set whose course is sought."""
    shakes, prediction = resonances(2 * np.pi * of.of.frequency), of.of.prediction
    if loads is not None and isinstance(prediction, SeriesPrediction):
        yield pairs(loads, (*OF_PAIRS, *shakes))
        yield axes(loads)
        yield from tilting(of)
        yield from article.locations(loads, prediction, offsets, of.of.lines, shakes)
        yield from article.joint(loads, prediction, offsets)
    yield channels(of, (*OF_SHARES, *shakes))
    yield from article.parts(of)
