"""A test that is not done yet, as a prediction: what stands there, base motions, noise and lines as the present data have them.

No time is simulated. The table would move as it did, so the base motions of a campaign that is there, as its own fit tells them,
drive the test; a line says as much as one of these data says, its noise and the model's own error included. Lines that nothing
drove yet are driven like the nearest that was: constant acceleration, so that the spectrum of a sweep falls with 1 / sqrt(f).
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.frames import Array
from identification.campaign import Campaign
from identification.self_calibration.solve import eliminated
from validation.diagnose.diagnosis import Candidate
from validation.estimation import likelihood
from validation.estimation.cost import root
from validation.estimation.fit import FLOOR
from validation.estimation.problem import AT_MOST, EFFECT, Lines, Measured, Parameter, chosen
from validation.model.model import Added
from validation.prediction.series import SeriesPrediction, TestedCampaign, laboratory, supported_dynamic_mass
from validation.prediction.structure import mounted_article

# What the present data say of the parameters by one explanation, carried over to a test that is not done yet.
#
# A test shares tolerances with the data that are there: sensors, the FMD, parts. What the fit has learnt of them holds; what is
# new, such as the modes of an article that never stood there, is known as beforehand. A test may also move a parameter - two
# pick-ups exchanged take their gains along - or draw it anew.


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where a parameter of a test comes from.

    Attributes
    ----------
    name : of the parameter of the present data whose offset it takes; empty for one that is drawn anew
    factor : by which the offset is multiplied
    """

    name: str = ""
    factor: float = 1.0


SURE = 100.0
"""[nats] beyond which one of two is right. Exercised by tests/validation/diagnosing/test_next_test.py."""

Moved = Mapping[str, Origin]
"""By name of a parameter in the test; one that is not in it stays what it was."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Knowledge:
    """A candidate as a distribution of its parameters.

    Attributes
    ----------
    effects : all of its model, as its problem has them
    offsets : where its fit ended, of all parameters
    names : (p,) of the free parameters
    root : (p, p), covariance of their offsets = root @ root.T
    log_evidence : [nats] of the present data
    """

    effects: tuple[Added, ...]
    offsets: Mapping[str, float]
    names: tuple[str, ...]
    root: Array
    log_evidence: float

    def odds(self, other: Knowledge) -> float:
        """Probability of this one, if it or `other` is right."""
        return float(1 / (1 + np.exp(np.clip(other.log_evidence - self.log_evidence, -SURE, SURE))))

    def at(self, moved: Moved) -> dict[str, float]:
        """Offsets of the test."""
        taken = {new: origin.factor * self.offsets.get(origin.name, 0.0) for new, origin in moved.items()}
        return {**self.offsets, **taken}

    def spread(self, parameters: Sequence[Parameter], moved: Moved) -> Array:
        """(q, s): covariance of the offsets of `parameters` in the test = spread @ spread.T.

        Effects that this candidate has not are known not to be there.
        """
        row = {name: k for k, name in enumerate(self.names)}
        known = np.zeros((len(parameters), len(self.names)))
        new = np.zeros(len(parameters))
        for k, one in enumerate(parameters):
            origin = moved.get(one.name, Origin(name=one.name))
            if origin.name in row:
                known[k] = origin.factor * self.root[row[origin.name]]
            elif origin.name not in self.offsets and one.kind != EFFECT and np.isfinite(one.tolerance):
                new[k] = one.tolerance
        return np.hstack([known, np.diag(new)[:, new > 0]])


def knowledge(of: Candidate) -> Knowledge:
    """What the fit of a candidate knows."""
    return Knowledge(
        effects=effects_of(of),
        offsets={**of.problem.start, **of.fit.by_name},
        names=tuple(one.name for one in of.fit.parameters),
        root=root(of.fit.covariance),
        log_evidence=of.fit.log_evidence,
    )


def effects_of(of: Candidate) -> tuple[Added, ...]:
    """The effects from which the offsets of its fit count: those of its model and its own."""
    own = [getattr(one, "effects", ()) for one in of.problem.predictions]
    return max(own, key=len, default=()) or of.effects


SPACING = 0.2
"""[Hz] between the lines at which a test is predicted: the width over which levels are smoothed. Exercised by
tests/validation/diagnosing/test_next_test.py."""

LINES = 20
"""[count] of lines at which it is compared; they stand for those that a fit would use. Exercised by
tests/validation/diagnosing/test_next_test.py."""

RUNS = 6
"""[count] of runs that a test is taken to have at most. Exercised by tests/validation/diagnosing/test_next_test.py."""


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

    @classmethod
    def of(cls, campaign: SeriesPrediction, by: Knowledge) -> Template:
        """Of a `campaign` that was measured, its base motions as the candidate `by` tells them."""
        some = campaign.on(campaign.measured.runs[:RUNS]).with_effects(by.effects)
        frequency = some.measured.frequency
        spacing = float(np.median(np.diff(frequency))) if len(frequency) > 1 else SPACING
        lines = np.arange(0, len(frequency), max(1, round(SPACING / spacing)), dtype=np.int64)
        predicted, seen = some.at(by.offsets, lines, derivatives=False), likelihood.observed(some.measured, lines)
        weight = seen.weight(FLOOR, predicted.noise)
        rows = np.broadcast_to(predicted.rows, (len(seen.runs), *predicted.rows.shape[-3:]))
        inputs = [eliminated(A, y, w)[2] for A, y, w in zip(rows, seen.values, weight, strict=True)]
        noise = {name: seen.noise[..., k] for k, name in enumerate(some.measured.channels)}
        return cls(prediction=some, frequency=frequency[lines], inputs=np.stack(inputs), noise=noise, spacing=spacing)

    @property
    def tested(self) -> TestedCampaign:
        """The campaign."""
        return self.prediction.tested


@dataclass(frozen=True, eq=False, kw_only=True)
class PlannedTest:
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


def planned(of: Template, campaign: Campaign, *, frequency: Array | None = None, level: float = 1.0) -> PlannedTest:
    """The test `campaign`, which is driven as `of` was.

    Parameters
    ----------
    frequency : (n,) [Hz] of its lines; those of `of` by default
    level : factor on all drives

    Raises
    ------
    BadInput : as `validation.prediction.structure.mounted_article`.
    """
    was, lines = of.tested, of.frequency if frequency is None else frequency
    near = np.argmin(np.abs(lines[:, None] - of.frequency), axis=1)
    drives = tuple(replace(one, amplitude=level * one.amplitude) for one in was.drives)
    chain = laboratory(was.model, campaign, ())
    # (r, n) Noise of a new channel is the median of its kind
    kinds = {one.name: (one.group, one.quantity) for one in campaign.table.channels}
    by_channel = []
    for name in chain.names:
        alike = [of.noise[name]] if name in of.noise else [of.noise[two] for two in of.noise if kinds[two] == kinds[name]]
        by_channel.append(np.median(alike, axis=0)[:, near])
    noise = np.stack(by_channel, axis=-1)
    unread = Measured(
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
    tested = replace(
        was,
        campaign=replace(campaign, recordings={}),
        measured=unread,
        carried=supported_dynamic_mass(was.model, campaign, mounted_article(was.model, campaign)),
        drives=drives,
    )
    inputs = level * of.inputs[:, near] * np.sqrt(of.frequency[near] / lines)[:, None]
    measured = 1 + round(float(lines[-1] - lines[0]) / of.spacing)
    return PlannedTest(prediction=SeriesPrediction(tested=tested), inputs=inputs, lines=min(AT_MOST, measured))


def reading(test: PlannedTest, by: Knowledge, offsets: Mapping[str, float]) -> Measured:
    """What the test would read by a candidate, with `offsets` of its parameters."""
    rows = test.prediction.with_effects(by.effects).at(offsets, derivatives=False).rows
    if rows.ndim == 3:
        return replace(test.measured, values=np.einsum("...nck,rnk->rnc", rows, test.inputs))
    return replace(test.measured, values=(rows @ test.inputs[..., None])[..., 0])


def lines_of(test: PlannedTest, measured: Measured) -> tuple[Lines, float]:
    """Indices of the lines at which `test` is compared by what was `measured` in it, and for how many of a fit each stands."""
    lines = chosen(measured, at_most=LINES)
    return lines, test.lines / len(lines)
