"""What a fit should cost where nothing is wrong, and where a fault shows when it is swallowed and when it is not."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest

from validation.diagnose.diagnosis import Candidate
from validation.diagnose.unexplained_fit import Misfit, misfit, of_data
from validation.estimation.fit import fit
from validation.estimation.problem import DECLARED, FITTED, Change, Measured, Parameter, Predicted, Problem

RUNS, LINES, CHANNELS, INPUTS = 3, 100, 7, 2
NOISE = 1e-2
"""Of readings of about 2; beside it the model-error floor is small."""
GAINS = tuple(Parameter(name=f"gain:c{k}", unit="1", tolerance=0.003) for k in range(CHANNELS))
SHADOW = Parameter(name="shadow:c0", unit="1", tolerance=1e-6)
"""Moves the same channel, but so little that the data say nothing of it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Flat:
    """Channels that follow two latent inputs, each with a gain."""

    measured: Measured
    parameters: tuple[Parameter, ...] = (*GAINS, SHADOW)

    def on(self, runs: Sequence[str]) -> Flat:
        return replace(self, measured=self.measured.on(runs))

    def at(self, offsets, lines=None, *, derivatives=True) -> Predicted:
        count = len(self.measured.frequency) if lines is None else len(lines)
        A = shape()
        changes = {
            one.name: Change(channels=(k,), rows=np.broadcast_to(A[k].astype(complex), (count, 1, INPUTS)))
            for one, k in zip(self.parameters, (*range(CHANNELS), 0), strict=True)
        }
        gains = np.array([1 + offsets.get(one.name, 0.0) for one in GAINS])
        gains[0] += offsets.get(SHADOW.name, 0.0)
        return Predicted(rows=np.broadcast_to((gains[:, None] * A).astype(complex), (count, CHANNELS, INPUTS)), changes=changes)


@cache
def shape() -> np.ndarray:
    return np.random.default_rng(1).standard_normal((CHANNELS, INPUTS))


def laboratory(seed: int, *, gains: bool = True, faults: dict[int, float] | None = None, late: float = 0.0) -> Problem:
    """Data of gains within their tolerances; `faults` by channel on top, and channel 0 of run 1 late by `late` [s]."""
    rng = np.random.default_rng(seed)
    f = np.linspace(4.0, 30.0, LINES)
    scale = 1 + (0.003 * rng.standard_normal(CHANNELS) if gains else np.zeros(CHANNELS))
    for channel, fault in (faults or {}).items():
        scale[channel] += fault
    u = rng.standard_normal((RUNS, 1, INPUTS)) + 1j * rng.standard_normal((RUNS, 1, INPUTS)) + np.zeros((1, LINES, 1))
    values = scale * (shape() @ u[..., None])[..., 0]
    values[1, :, 0] *= np.exp(-2j * np.pi * f * late)
    noise = np.full(values.shape, NOISE)
    values = values + noise * (rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape)) / np.sqrt(2)
    measured = Measured(
        name="flat",
        configuration="flat",
        runs=tuple(f"r{k}" for k in range(RUNS)),
        channels=tuple(f"c{k}" for k in range(CHANNELS)),
        judged=np.ones(CHANNELS, dtype=bool),
        frequency=f,
        values=values,
        noise=noise,
    )
    return Problem((Flat(measured=measured),))


def missed(problem: Problem) -> Misfit:
    return misfit(Candidate(effects=(), fit=fit(problem, FITTED), problem=problem))


@cache
def nulls() -> tuple[Misfit, ...]:
    return tuple(missed(laboratory(seed)) for seed in range(24))


def test_where_nothing_is_wrong_tolerances_cost_what_is_due_and_scatter_as_they_should() -> None:
    excess = np.array([one.price.excess for one in nulls()])
    assert abs(excess.mean()) < 4 / np.sqrt(len(excess))  # four standard deviations of the mean
    assert 0.6 < excess.std() < 1.5  # a chi² of few degrees, of 24 draws


def test_what_is_due_is_less_than_one_a_tolerance_and_falls_with_what_data_tell() -> None:
    due = nulls()[0].price.due
    assert CHANNELS - INPUTS < due < CHANNELS  # the shadow is told nothing; common gains of a subspace are inputs


def test_a_swallowed_fault_shows_in_the_price_and_in_its_family_and_hardly_in_chi2() -> None:
    clean, faulty = missed(laboratory(3)), missed(laboratory(3, faults={2: 0.05}))
    assert faulty.price.excess > 20
    assert faulty.by_family["gain"].excess > 20
    assert faulty.largest[0] == "gain:c2"
    assert faulty.largest[1] > 8
    assert faulty.per_degree < 1.3 * clean.per_degree


def test_what_no_tolerance_follows_shows_in_its_run_and_channel() -> None:
    found = missed(laboratory(4, late=1e-3))
    assert found.worst.run == "r1"
    assert found.worst.channel == "c0"
    assert max(found.by_run, key=lambda run: found.by_run[run]) == "flat/r1"
    assert max(found.by_channel, key=lambda channel: found.by_channel[channel]) == "c0"
    assert found.worst_stretch.band[1] == pytest.approx(30.0)  # a delay is worst at the end
    assert found.scores["stretch"] > found.scores["cell"] > found.scores["misfit"]


def test_a_tolerance_that_moved_although_data_say_nothing_of_it_is_not_compared_with_what_is_due() -> None:
    problem = laboratory(5)
    found = fit(problem, FITTED)
    k = [one.name for one in found.parameters].index(SHADOW.name)
    moved = np.array(found.offsets)
    moved[k] = 30 * SHADOW.tolerance
    told = misfit(Candidate(effects=(), fit=replace(found, offsets=moved), problem=problem))
    assert told.least_due[0] != SHADOW.name
    assert told.largest[0] == SHADOW.name


def test_a_laboratory_without_tolerances_costs_less_than_is_due() -> None:
    excess = [missed(laboratory(seed, gains=False)).price.excess for seed in range(5)]
    assert max(excess) < 0


def test_free_numbers_are_what_inputs_leave() -> None:
    found = [one.per_degree for one in nulls()]
    assert np.mean(found) == pytest.approx(1.0, abs=0.1)  # the model-error floor takes some 5 % off


@pytest.mark.parametrize(("name", "z"), [("loss:mast", np.log(2.7) / 0.35), ("modulus:mast", 1.7 / 0.35)])
def test_a_loss_factor_that_is_some_times_as_large_costs_what_its_logarithm_does(name: str, z: float) -> None:
    moved = Parameter(name=name, unit="1", tolerance=0.35, kind=DECLARED)
    of = fit(laboratory(5), FITTED)
    told = of_data(replace(of, parameters=(moved,), offsets=np.array([1.7]), covariance=np.zeros((1, 1))), [])
    assert told.largest == (name, pytest.approx(z))
