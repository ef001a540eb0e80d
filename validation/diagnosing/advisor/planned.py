"""A test that is not done yet, as a prediction: what stands there, base motions, noise and lines as the present data have them.

No time is simulated. The table would move as it did, so the base motions of a campaign that is there, as its own fit tells them,
drive the test; a line says as much as one of these data says, its noise and the model's own error included. Lines that nothing
drove yet are driven like the nearest that was: constant acceleration, so that the spectrum of a sweep falls with 1 / sqrt(f).
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.sensors import ChannelTable
from identification.campaign import Campaign
from identification.self_calibration.elimination import eliminated
from validation.diagnosing.advisor.knowledge import Knowledge
from validation.engine import likelihood
from validation.engine.fit import FLOOR
from validation.engine.measured import Measured
from validation.engine.prediction import Lines
from validation.engine.thinning import AT_MOST, chosen
from validation.prediction.laboratory import laboratory
from validation.prediction.series import SeriesPrediction, Tested, carried
from validation.prediction.set_up import standing

SPACING = 0.2
"""[Hz] between the lines at which a test is predicted at all: the width over which levels are smoothed."""

LINES = 20
"""At which it is compared; they stand for the lines that a fit would use."""

RUNS = 6
"""At most that a test is taken to have."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Template:
    """A campaign that is there, as far as a test is like it.

    Attributes
    ----------
    prediction : of some of its runs
    frequency : (n,) [Hz], `SPACING` apart
    inputs : (r, n, 6) base motions
    noise : by channel (r, n)
    spacing : [Hz] between the lines that were measured
    """

    prediction: SeriesPrediction
    frequency: Array
    inputs: ComplexArray
    noise: Mapping[str, Array]
    spacing: float

    @property
    def tested(self) -> Tested:
        """The campaign."""
        return self.prediction.tested


@dataclass(frozen=True, eq=False, kw_only=True)
class Planned:
    """A test.

    Attributes
    ----------
    prediction : of its campaign, which has no readings yet
    inputs : (r, n, 6) base motions
    lines : that a fit of it would use
    """

    prediction: SeriesPrediction
    inputs: ComplexArray
    lines: int

    @property
    def measured(self) -> Measured:
        """Its lines, runs and channels."""
        return self.prediction.measured


def template(of: SeriesPrediction, by: Knowledge) -> Template:
    """The campaign of `of`, its base motions as the hypothesis `by` tells them."""
    some = of.on(of.measured.runs[:RUNS]).with_effects(by.effects)
    spacing = _spacing(some.measured.frequency)
    lines = np.arange(0, len(some.measured.frequency), max(1, round(SPACING / spacing)), dtype=np.int64)
    predicted, seen = some.at(by.offsets, lines, derivatives=False), likelihood.observed(some.measured, lines)
    weight = seen.weight(FLOOR, predicted.noise)
    rows = np.broadcast_to(predicted.rows, (len(seen.runs), *predicted.rows.shape[-3:]))
    inputs = [eliminated(A, y, w)[2] for A, y, w in zip(rows, seen.values, weight, strict=True)]
    return Template(
        prediction=some,
        frequency=some.measured.frequency[lines],
        inputs=np.stack(inputs),
        noise={name: seen.noise[..., k] for k, name in enumerate(some.measured.channels)},
        spacing=spacing,
    )


def _spacing(frequency: Array) -> float:
    return float(np.median(np.diff(frequency))) if len(frequency) > 1 else SPACING


def planned(of: Template, campaign: Campaign, *, frequency: Array | None = None, level: float = 1.0) -> Planned:
    """The test `campaign`, which is driven as `of` was.

    Parameters
    ----------
    frequency : (n,) [Hz] of its lines; those of `of` by default
    level : factor on all drives

    Raises
    ------
    BadInput : as `validation.prediction.set_up.standing`.
    """
    was, lines = of.tested, of.frequency if frequency is None else frequency
    near = np.argmin(np.abs(lines[:, None] - of.frequency), axis=1)
    drives = tuple(replace(one, amplitude=level * one.amplitude) for one in was.drives)
    tested = replace(
        was,
        campaign=replace(campaign, recordings={}),
        measured=_unread(of, campaign, was, lines, near),
        carried=carried(was.model, campaign, standing(was.model, campaign)),
        drives=drives,
    )
    inputs = level * of.inputs[:, near] * np.sqrt(of.frequency[near] / lines)[:, None]
    measured = 1 + round(float(lines[-1] - lines[0]) / of.spacing)
    return Planned(prediction=SeriesPrediction(tested=tested), inputs=inputs, lines=min(AT_MOST, measured))


def _unread(of: Template, campaign: Campaign, was: Tested, lines: Array, near: Lines) -> Measured:
    """The campaign without readings."""
    chain = laboratory(was.model, campaign, ())
    noise = np.stack([_noise(of, campaign.table, name)[:, near] for name in chain.names], axis=-1)
    return Measured(
        name="test",
        configuration=campaign.article,
        hardware=campaign.hardware,
        runs=was.measured.runs,
        axes=was.measured.axes,
        channels=chain.names,
        judged=np.isin(np.arange(len(chain.names)), chain.forces.columns),
        frequency=lines,
        values=np.zeros(noise.shape, dtype=np.complex128),
        noise=noise,
    )


def _noise(of: Template, table: ChannelTable, name: str) -> Array:
    """(r, n) of a channel; of a new one the median of its kind."""
    if name in of.noise:
        return of.noise[name]
    kind = _kind(table, name)
    alike = [noise for other, noise in of.noise.items() if _kind(table, other) == kind]
    return np.asarray(np.median(alike, axis=0))


def _kind(table: ChannelTable, name: str) -> tuple[str, str]:
    one = table.channels[table.names.index(name)]
    return one.group, one.quantity


def reading(test: Planned, by: Knowledge, offsets: Mapping[str, float]) -> Measured:
    """What the test would read by a hypothesis, with `offsets` of its parameters."""
    rows = test.prediction.with_effects(by.effects).at(offsets, derivatives=False).rows
    return replace(test.measured, values=np.einsum("...nck,rnk->rnc", rows, test.inputs) if rows.ndim == 3 else _each(rows, test))


def _each(rows: ComplexArray, test: Planned) -> ComplexArray:
    return np.asarray((rows @ test.inputs[..., None])[..., 0])


def lines_of(test: Planned, measured: Measured) -> tuple[Lines, float]:
    """Indices of the lines at which `test` is compared by what was `measured` in it, and for how many of a fit each stands."""
    lines = chosen(measured, at_most=LINES)
    return lines, test.lines / len(lines)
