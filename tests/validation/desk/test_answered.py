"""A prediction that was asked already says the same again, and nothing that it was not asked."""

import numpy as np
import pytest
from numpy.testing import assert_array_equal

from validation.app.whatif import SampledPrediction
from validation.estimation import evaluate
from validation.estimation.problem import Change, Lines, Measured, Offsets, Predicted, Wanted

RUNS, LINES, CHANNELS, INPUTS = 3, 8, 6, 2


class Asked:
    """A prediction that says the same at whatever offsets."""

    parameters = ()

    def __init__(self, measured: Measured, rows: np.ndarray, noise: np.ndarray) -> None:
        self.measured, self._rows, self._noise = measured, rows, noise

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        at = np.arange(LINES) if lines is None else lines
        rows = self._rows[at] if self._rows.ndim == 3 else self._rows[:, at]
        return Predicted(rows=rows, changes={"x": Change(channels=(0,), rows=rows)}, noise=self._noise[:, at])


@pytest.fixture(params=[False, True], ids=["shared rows", "rows by run"])
def asked(request: pytest.FixtureRequest) -> Asked:
    rng = np.random.default_rng(2)

    def drawn(*shape: int) -> np.ndarray:
        return np.asarray(rng.standard_normal(shape) + 1j * rng.standard_normal(shape))

    measured = Measured(
        name="a",
        configuration="a",
        runs=("x", "y", "z"),
        channels=tuple(f"c{k}" for k in range(CHANNELS)),
        judged=np.array([False, False, False, True, True, True]),
        frequency=np.linspace(4.0, 30.0, LINES),
        values=drawn(RUNS, LINES, CHANNELS),
        noise=np.full((RUNS, LINES, CHANNELS), 1e-3),
        inputs=None,
    )
    shape = (RUNS, LINES, CHANNELS, INPUTS) if request.param else (LINES, CHANNELS, INPUTS)
    return Asked(measured, drawn(*shape), np.abs(drawn(RUNS, LINES, CHANNELS)))


def answered(of: Asked, lines: Lines) -> SampledPrediction:
    return SampledPrediction(measured=of.measured, parameters=(), lines=lines, said=of.at({}, lines, derivatives=False))


def test_some_of_the_lines_are_those_of_the_prediction(asked: Asked) -> None:
    there = answered(asked, np.array([0, 2, 3, 7])).at({}, np.array([2, 7]), derivatives=False)
    wanted = asked.at({}, np.array([2, 7]))
    assert_array_equal(there.rows, wanted.rows)
    assert_array_equal(there.noise, wanted.noise)
    assert not there.changes


def test_errors_of_some_runs_are_those_of_the_prediction(asked: Asked) -> None:
    every = np.arange(LINES)
    (of_y,) = evaluate.squares(answered(asked, every).on(("y",)), {}, np.array([1, 4]))
    whole = evaluate.squares(asked, {}, np.array([1, 4]))  # type: ignore[arg-type]
    assert of_y.run == "y"
    # how far silent channels are trusted is told by all runs together, so that a run alone errs a trifle otherwise
    np.testing.assert_allclose(of_y.values, whole[1].values, rtol=0.02)


def test_nothing_is_said_that_was_not_asked(asked: Asked) -> None:
    some = answered(asked, np.array([0, 2]))
    with pytest.raises(ValueError, match="asked"):
        some.at({}, np.array([1]), derivatives=False)
    with pytest.raises(ValueError, match="asked"):
        some.at({}, np.array([0]))
    with pytest.raises(ValueError, match="asked"):
        some.at({}, derivatives=False)
