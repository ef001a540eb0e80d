"""`Comparison`: all that `massline compare` shows, whichever way it is shown - on paper, as JSON, in pictures."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from validation.comparing.maps import Map
from validation.comparing.modes import NamedMode
from validation.comparing.spots import Spot
from validation.comparing.verdicts import Explained, Told, Tolerance
from validation.engine.evaluation import Evaluation


@dataclass(frozen=True, kw_only=True)
class Beside:
    """One number of a classical measurement beside what the model says.

    Attributes
    ----------
    name : where it comes from and what it is
    unit : SI
    predicted, measured, tolerance : at the plain fit, in `unit`; the last is one standard deviation
    sigma : (predicted - measured) / standard deviation, after the plain fit
    nominal_sigma : the same of the model as it stands
    """

    name: str
    unit: str
    predicted: float
    measured: float
    tolerance: float
    sigma: float
    nominal_sigma: float


@dataclass(frozen=True, kw_only=True)
class WorstPair:
    """A pair of axes of one campaign, where it is worst.

    Attributes
    ----------
    data_set : the campaign
    load, motion : indices in the order of `MOTIONS`
    frequency : [Hz] of the peak
    sigma, percent : there
    """

    data_set: str
    load: int
    motion: int
    frequency: float
    sigma: float
    percent: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """A model and data, compared.

    Attributes
    ----------
    title : of the model
    source : its file
    evaluation : the four errors and the fits behind them
    explained : what tolerances let expect of the plain error
    errors : the four errors in words
    absurd : the tolerances that the fit moved farthest, most absurd first
    maps : one a data set
    modes : of each data set's configuration
    worst : the worst spots, worst first
    facts : classical measurements
    effects : ids of the effects that are in the model
    remarks : sentences: what was assumed, what is missing
    """

    title: str
    source: str
    evaluation: Evaluation
    explained: Explained
    errors: tuple[Told, ...]
    absurd: tuple[Tolerance, ...]
    maps: tuple[Map, ...]
    modes: tuple[tuple[NamedMode, ...], ...]
    worst: tuple[Spot, ...]
    facts: tuple[Beside, ...] = ()
    effects: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def data_sets(self) -> tuple[str, ...]:
        """Names, in order."""
        return tuple(one.data_set for one in self.maps)


def worst_pairs(maps: Sequence[Map], count: int) -> tuple[WorstPair, ...]:
    """The `count` pairs of axes with the greatest peak in sigmas, of all campaigns together, worst first."""
    found = []
    for of in (one.pairs for one in maps if one.pairs is not None):
        sigma, percent = of.sigma, of.percent
        for i, j in np.ndindex(6, 6):
            line = int(np.argmax(sigma[:, i, j]))
            found.append(
                WorstPair(
                    data_set=of.campaign,
                    load=i,
                    motion=j,
                    frequency=float(of.frequency[line]),
                    sigma=float(sigma[line, i, j]),
                    percent=float(percent[line, i, j]),
                )
            )
    return tuple(sorted(found, key=lambda pair: -pair.sigma)[:count])
