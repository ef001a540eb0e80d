"""Explanations that belong together: by evidence, and by what they do to the channels."""

from collections.abc import Callable
from dataclasses import dataclass
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.diagnose.candidates import alike, share
from validation.diagnose.diagnosis import Candidate
from validation.effects.catalogue import parse
from validation.model.model import Added


@dataclass(frozen=True)
class Evidence:
    log_evidence: float


@pytest.fixture
def explained() -> Callable[..., Candidate]:
    def make(evidence: float, *texts: str) -> Candidate:
        fit: Any = Evidence(evidence)
        problem: Any = None
        return Candidate(effects=tuple(Added(named=parse(text)) for text in texts), fit=fit, problem=problem)

    return make


def test_what_is_within_five_nats_belongs_to_the_class_the_best_first(explained: Callable[..., Candidate]) -> None:
    gain, cell, mass = "force-gain:fmd-z2=0.1", "cell-stiffness:2z=0.1", "rigid-inertia:m=1"
    best, others = explained(100.0, gain), [explained(94.9, mass), explained(96.0, cell)]
    assert alike(best, others) == ("force-gain:fmd-z2", "cell-stiffness:2z")
    assert alike(best, []) == ("force-gain:fmd-z2",)


def test_effects_that_all_have_are_in_no_doubt(explained: Callable[..., Candidate]) -> None:
    gain, cell, mass = "force-gain:fmd-z2=0.1", "cell-stiffness:2z=0.1", "rigid-inertia:m=1"
    assert alike(explained(10.0, mass, gain), [explained(9.0, mass, cell)]) == ("force-gain:fmd-z2", "cell-stiffness:2z")


def fisher(*columns: np.ndarray) -> np.ndarray:
    J = np.stack(columns, axis=1)
    return np.asarray(J.T @ J)


def test_a_share_is_the_squared_sine_of_the_angle_between_two_columns() -> None:
    for angle in (0.0, 0.02, 0.7, np.pi / 2):
        b, c = np.array([1.0, 0.0, 0.0]), 3e4 * np.array([np.cos(angle), np.sin(angle), 0.0])
        assert_allclose(share(fisher(b, c), np.zeros(2), 0, [1], []), np.sin(angle) ** 2, atol=1e-12)


def test_two_effects_that_differ_only_in_what_a_tolerance_does_are_one() -> None:
    rng = np.random.default_rng(2)
    b, loose = rng.standard_normal((2, 50))
    N = fisher(b, b + loose, loose)
    assert share(N, np.array([0.0, 0.0, 1e-9]), 0, [1], [2]) < 1e-6  # nothing is known of the tolerance
    assert share(N, np.array([0.0, 0.0, 1e9]), 0, [1], [2]) > 0.2  # it is known exactly


def test_several_sizes_together_may_do_what_none_of_them_does() -> None:
    rng = np.random.default_rng(2)
    c1, c2 = rng.standard_normal((2, 50))
    N = fisher(c1 - 2 * c2, c1, c2)
    assert share(N, np.zeros(3), 0, [1, 2], []) < 1e-9
    assert share(N, np.zeros(3), 0, [1], []) > 0.1
