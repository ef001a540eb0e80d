"""A user's own effect takes part in everything: planted, predicted with its derivative, and fitted, like any of the catalogue."""

from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.effects import catalogue
from validation.estimation.fit import fit
from validation.estimation.problem import EFFECT, Problem

BLADE = "fmd+clumod-1"
DAMPED, LOWPASS = "dashpot:mast-top", "force-lowpass:fmd-z2"


@pytest.fixture(scope="module", autouse=True)
def _own_effects(root: Path) -> Iterator[None]:
    """Those of the example, for these tests alone."""
    kept = [dict(one) for one in (catalogue._found, catalogue._sources, catalogue._files)]
    catalogue.load(root / "examples" / "effects")
    yield
    for one, before in zip((catalogue._found, catalogue._sources, catalogue._files), kept, strict=True):
        one.clear()
        one.update(before)


def test_what_was_planted_is_fitted(faulty: Any, predicted: Any, added: Any) -> None:
    """Of the structure; `examples/own_effect.py` does the same of a channel."""
    test = faulty(BLADE, f"{DAMPED}=60")
    without, of = (predicted(test, effects=effects) for effects in ((), added(f"{DAMPED}=3")))
    before, after = (fit(Problem(one).thinned(), (EFFECT,)) for one in (without, of))
    assert [one.name for one in after.parameters] == [DAMPED]
    assert after.converged
    assert after.parameters[0].value(float(after.offsets[0])) == pytest.approx(60.0, rel=0.01)
    assert after.chi2 < before.chi2 / 10
    assert after.log_evidence > before.log_evidence + 10


@pytest.mark.parametrize("effect", [f"{DAMPED}=40", f"{LOWPASS}=5e-4"])
def test_its_derivative_is_that_of_finite_differences(faulty: Any, predicted: Any, added: Any, effect: str) -> None:
    (of,) = predicted(faulty(BLADE), effects=added(effect))
    name, lines = effect.partition("=")[0], np.array([0, 152, 240, 560])
    start = next(one.start for one in of.parameters if one.name == name)
    h = 1e-4 * start
    change = of.at({name: start}, lines).changes[name]
    up, down = (of.at({name: start + side * h}, lines, derivatives=False).rows for side in (1, -1))
    slope = ((up - down) / (2 * h))[..., list(change.channels), :]
    assert_allclose(np.broadcast_to(change.rows, slope.shape), slope, rtol=0, atol=1e-6 * np.max(np.abs(slope)))


def test_it_acts_wherever_its_place_exists_and_nowhere_else(faulty: Any, predicted: Any, added: Any) -> None:
    (of,) = predicted(faulty("fmd+disc+cuboid"), kind="rigid", effects=added(f"{DAMPED}=40"))
    assert DAMPED not in of.at({DAMPED: 40.0}, np.array([0])).changes
