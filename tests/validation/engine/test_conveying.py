"""Normal equations by the common way, held against those of every column by itself."""

from __future__ import annotations

from collections.abc import Callable

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.estimation import likelihood
from validation.estimation.likelihood import FEW, ObservedLines, ways
from validation.estimation.problem import Change, Conveyed, Predicted

LINES, CHANNELS, INPUTS, QUANTITIES, RUNS = 7, 9, 2, 3, 2
LOADED = (3, 4, 5, 6, 8)

Predict = Callable[..., Predicted]


@pytest.fixture
def drawn() -> Callable[..., np.ndarray]:
    rng = np.random.default_rng(1)
    return lambda *shape: rng.standard_normal(shape) + 1j * rng.standard_normal(shape)


@pytest.fixture
def predicted(drawn) -> Predict:
    through = drawn(LINES, len(LOADED), QUANTITIES)

    def made(common: int = 4, others: int = 2) -> Predicted:
        changes: dict[str, Change | Conveyed] = {}
        for k in range(common):
            changes[f"carried {k}"] = Conveyed(channels=LOADED, through=through, quantities=drawn(LINES, QUANTITIES, INPUTS))
        for k, channel in enumerate((0, 0, 3, 8)):
            changes[f"gain {k}"] = Change(channels=(channel,), rows=drawn(LINES, 1, INPUTS))
        for k in range(others):
            channels = (0, 2, 3) if k else LOADED
            changes[f"pose {k}"] = Change(channels=channels, rows=drawn(LINES, len(channels), INPUTS))
        return Predicted(rows=drawn(LINES, CHANNELS, INPUTS), changes=changes)

    return made


@pytest.fixture
def seen(drawn) -> Callable[[bool], ObservedLines]:
    def made(known: bool) -> ObservedLines:
        spread = np.abs(drawn(RUNS, LINES, CHANNELS))
        inputs = drawn(RUNS, LINES, INPUTS) if known else None
        values = drawn(RUNS, LINES, CHANNELS)
        return ObservedLines(runs=("x", "y"), values=values, noise=spread, floor=0 * spread, inputs=inputs)

    return made


def plainly(predicted: Predicted) -> Predicted:
    """The same, every parameter by rows of its own."""
    changes = {name: Change(channels=one.channels, rows=one.rows) for name, one in predicted.changes.items()}
    return Predicted(rows=predicted.rows, changes=changes)


@pytest.mark.parametrize("known", [False, True])
@pytest.mark.parametrize("others", [0, 2])
def test_what_goes_a_common_way_makes_the_same_normal_equations(predicted: Predict, seen, known: bool, others: int) -> None:
    of, read = predicted(others=others), seen(known)
    names = ["nowhere", *sorted(of.changes)]  # one that does not act here, and kinds mixed
    assert ways(of.changes, names[1:], CHANNELS) is not None
    assert ways(plainly(of).changes, names[1:], CHANNELS) is None
    ours, plain = (likelihood.normals(read, one, names, 0.0) for one in (of, plainly(of)))
    for run in read.runs:
        assert_allclose(ours[run].matrix, plain[run].matrix, rtol=1e-9, atol=1e-9 * np.abs(plain[run].matrix).max())
        assert_allclose(ours[run].gradient, plain[run].gradient, rtol=1e-9, atol=1e-9 * np.abs(plain[run].gradient).max())
        assert ours[run].cost == pytest.approx(plain[run].cost, rel=1e-12)
        assert not ours[run].matrix[0].any()


def test_normal_equations_are_those_of_the_whitened_columns(predicted: Predict, seen) -> None:
    of, read = predicted(), seen(False)
    names = sorted(of.changes)
    for k, run in enumerate(read.runs):
        r, V = likelihood.whitened(read, of, names, 0.0, k)
        flat = V.reshape(-1, len(names))
        found = likelihood.normals(read, of, names, 0.0)[run]
        assert_allclose(found.matrix, (flat.conj().T @ flat).real, rtol=1e-9, atol=1e-9 * np.abs(found.matrix).max())
        assert_allclose(found.gradient, -(flat.conj().T @ r.ravel()).real, rtol=1e-9, atol=1e-9 * np.abs(found.gradient).max())


def test_many_that_go_ways_of_their_own_are_not_worth_it(predicted: Predict) -> None:
    of = predicted(others=FEW + 1)
    assert ways(of.changes, sorted(of.changes), CHANNELS) is None


def test_rows_that_runs_do_not_share_go_no_common_way(predicted: Predict, drawn) -> None:
    of = predicted()
    changes = {**of.changes, "bent": Change(channels=(1,), rows=drawn(RUNS, LINES, 1, INPUTS))}
    assert ways(changes, sorted(changes), CHANNELS) is None
    assert ways(changes, sorted(of.changes), CHANNELS) is not None
