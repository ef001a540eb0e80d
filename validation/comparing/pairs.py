"""Predicted beside measured 6 x 6 dynamic mass, pair of axes by pair of axes.

The measured one is `identification.dynamic_mass` on base motions and resultants as everywhere. The predicted one goes the
same way: the channels that the model predicts for the very runs are put through the same operators, so that an effect on a
channel which the model knows is in both, and what they differ by is not the way in which they were made. With T and R the
rows of motions and resultants, an error of the channels by dy changes H by

    dH = (R dy - H T dy) S_u^-1                                                   (from Eq. 10)

which gives the standard deviation of every entry from noise and tolerances.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.sensors import ChannelTable
from identification.base_motion import base_motion
from identification.dynamic_mass import Estimate, from_runs
from identification.elastic.lines import levels
from identification.resultants import resultants
from identification.spectra.line_spectra import Spectra
from validation.comparing.chunks import Chunk


@dataclass(frozen=True, eq=False, kw_only=True)
class Pairs:
    """The dynamic mass of one campaign, about F, of all that stands on the load cells.

    Attributes
    ----------
    campaign : name of the data set
    frequency : (n,) [Hz]
    measured, predicted : (n, 6, 6)
    expected : (n, 6, 6) standard deviation of their difference by noise and by tolerances that were not fitted
    level : (n, 6, 6) of row and column of the dynamic mass, of which an error is told in per cent: the greater of both
    """

    campaign: str
    frequency: Array
    measured: ComplexArray
    predicted: ComplexArray
    expected: Array
    level: Array

    @property
    def sigma(self) -> Array:
        """(n, 6, 6) difference in standard deviations."""
        return np.asarray(np.abs(self.measured - self.predicted) / self.expected)

    @property
    def percent(self) -> Array:
        """(n, 6, 6) difference in per cent of the dynamic mass."""
        return np.asarray(100 * np.abs(self.measured - self.predicted) / self.level)


@dataclass(frozen=True, eq=False, kw_only=True)
class Operators:
    """From channels to what H is made of.

    Attributes
    ----------
    motion : (n, 6, c) rows of Eq. 6
    load : (n, 6, c) rows of the resultants about F
    """

    motion: ComplexArray
    load: ComplexArray


def operators(table: ChannelTable, frequency: Array, noise: Array, gravity: float) -> Operators:
    """The operators of a campaign, told from what they make of a unit reading of each channel.

    Parameters
    ----------
    noise : (n, c) standard deviation, by which accelerometers are weighed

    Raises
    ------
    BadInput : the channels do not tell six motions or six loads.
    """
    n, c = len(frequency), len(table)
    unit = Spectra(
        table=table,
        frequency=frequency,
        values=np.broadcast_to(np.eye(c)[:, None, :], (c, n, c)),
        noise=np.broadcast_to(noise, (c, n, c)),
        quality=np.ones((c, n)),
        runs=tuple(map(str, range(c))),
        axes=("",) * c,
    )
    moved, loaded = base_motion(unit, gravity=gravity).values, resultants(unit).values
    return Operators(motion=np.moveaxis(moved, 0, -1), load=np.moveaxis(loaded, 0, -1))


def through(of: Operators, y: ComplexArray, frequency: Array) -> Estimate:
    """The dynamic mass that the readings y (r, n, c) lead to.

    Raises
    ------
    BadInput : runs that do not tell six motions apart.
    """
    load, motion = ((rows @ y[..., None])[..., 0] for rows in (of.load, of.motion))
    return from_runs(load, motion, frequency)


@dataclass(frozen=True, eq=False, kw_only=True)
class Lines:
    """Some lines of both dynamic masses.

    Attributes
    ----------
    measured, predicted : (n, 6, 6)
    variance : (n, 6, 6) of their difference
    """

    measured: ComplexArray
    predicted: ComplexArray
    variance: Array


def lines(of: Operators, frequency: Array, y: ComplexArray, inputs: ComplexArray, part: Chunk) -> Lines:
    """Predicted beside measured on the lines of `part`.

    Parameters
    ----------
    frequency : (m,) of all lines, as the lines of `of`
    y : (r, m, c) what the channels read
    inputs : (r, m, k) of the runs

    Raises
    ------
    BadInput : runs that do not tell six motions apart.
    """
    at = part.lines
    own = Operators(motion=of.motion[at], load=of.load[at])
    said = (part.rows @ inputs[:, at, :, None])[..., 0]
    estimate = through(own, said, frequency[at])
    return Lines(
        measured=through(own, y[:, at], frequency[at]).dynamic_mass.matrix,
        predicted=estimate.dynamic_mass.matrix,
        variance=_variance(own, estimate, part.spread, part.noise),
    )


def joined(name: str, frequency: Array, parts: Sequence[Lines]) -> Pairs:
    """All lines of a campaign."""
    measured, predicted = (np.concatenate([getattr(one, name) for one in parts]) for name in ("measured", "predicted"))
    return Pairs(
        campaign=name,
        frequency=frequency,
        measured=measured,
        predicted=predicted,
        expected=np.sqrt(np.concatenate([one.variance for one in parts])),
        level=np.maximum(levels(predicted), levels(measured)),
    )


def _variance(of: Operators, estimate: Estimate, spread: ComplexArray, noise: Array) -> Array:
    """(n, 6, 6) of the entries of H: tolerances act on all runs alike, noise on each alone."""
    W = of.load - estimate.dynamic_mass.matrix @ of.motion
    by_tolerance = np.einsum("rnip,nrj->nijp", W @ spread, estimate.inverse, optimize=True)
    by_noise = np.einsum("nic,rnc,nrj->nij", np.abs(W) ** 2, noise**2, np.abs(estimate.inverse) ** 2, optimize=True)
    return np.asarray(np.sum(np.abs(by_tolerance) ** 2, axis=-1) + by_noise)
