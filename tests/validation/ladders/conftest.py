"""Rungs and problems made by hand."""

from collections.abc import Callable, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest

from validation.estimation.problem import Change, Lines, Measured, Offsets, Parameter, Predicted, Problem
from validation.history.history import Body, Conditions, Errors, Source, Version, VersionSize

MakeRung = Callable[..., Version]


def errors(plain: float, held_out: float | None = None) -> Errors:
    return Errors(
        nominal=2 * plain,
        plain=plain,
        held_out_nominal=None if held_out is None else 2 * held_out,
        held_out=held_out,
        chi2=812.5,
        degrees_of_freedom=1000,
        tolerance_z2=30.25,
        tolerances=270,
        log_evidence=-1234.5678901234567,
        held_out_names=("a/x",),
        by_channel={"fmd-z1": 0.7 * plain, "fmd-z2": 0.3 * plain},
        by_fold={} if held_out is None else {"run x of a": held_out},
    )


def body(shift: float = 0.0) -> Body:
    reference = np.array([47.4, 1e-3, 0.0, 0.31, 2.3, 2.2, 0.4, 0.01, 0.02, -0.03])
    deviation = np.array([0.05, 1e-4, 1e-4, 3e-4, 0.02, 0.02, 0.01, 0.001, 0.001, 0.001])
    return Body(article="clumod-1", values=reference + shift * deviation, deviation=deviation, reference=reference)


@pytest.fixture
def rung() -> MakeRung:
    """``rung(number, parent, model, ...)`` with figures that mean nothing."""

    def make(number: int = 0, parent: int | None = None, model: str = "a = 1\n", **more: object) -> Version:
        given: dict[str, object] = {
            "cause": "start" if parent is None else "added",
            "effect": "" if parent is None else "force-gain:fmd-z2",
            "effects": {"force-gain:fmd-z2": (VersionSize(key="", value=0.0801, unit="1", deviation=0.0013),)},
            "conditions": Conditions(data=(Source(path="../one", digest="ab" * 32),), hold_out=("one/x",), band=(4.0, 32.0)),
            "errors": errors(4.1, 4.3),
            "gain": None if parent is None else 27.3,
            "bodies": (body(0.5),),
            "plain_offsets": {"fmd:m": 0.125},
            "fitted_offsets": {"fmd:m": 0.1, "force-gain:fmd-z1": 0.1 + 0.2},
            "verdict": ("It is worth a parameter.",),
            "settings": {"effects_from": ["mine"]},
            "when": "2026-11-21T17:00:00+00:00",
        }
        return Version(number=number, parent=parent, model=model, **{**given, **more})  # type: ignore[arg-type]

    return make


@pytest.fixture
def model(tmp_path) -> Path:
    """A model file."""
    path = tmp_path / "model.toml"
    path.write_bytes(b"# mine\r\na = 1\n")
    return path


@dataclass(frozen=True, eq=False, kw_only=True)
class Affine:
    """A hand-made prediction of channels that answer to known unit inputs, affine in every parameter."""

    measured: Measured
    parameters: tuple[Parameter, ...]
    base: np.ndarray
    slopes: dict[str, np.ndarray]

    def on(self, runs: Sequence[str]) -> "Affine":
        return replace(self, measured=self.measured.on(runs))

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: bool = True) -> Predicted:
        chosen = slice(None) if lines is None else lines
        rows = self.base + sum(offsets.get(name, 0.0) * slope for name, slope in self.slopes.items())
        every = tuple(range(self.base.shape[1]))
        changes = {name: Change(channels=every, rows=slope[chosen]) for name, slope in self.slopes.items()}
        return Predicted(rows=rows[chosen], changes=changes if derivatives else {})


MakeProblem = Callable[..., Problem]


@pytest.fixture(scope="session")
def affine() -> MakeProblem:
    """``affine(parameters, truth, seed)``: a problem whose slopes are random and the same for all seeds; its noise is not."""

    def make(parameters: Sequence[Parameter], truth: Offsets, seed: int = 0, alike: Sequence[tuple[str, str]] = ()) -> Problem:
        fixed, rng = np.random.default_rng(7), np.random.default_rng(seed)
        n, c = 12, 5
        slopes = {one.name: fixed.standard_normal((n, c, 1)) + 0j for one in parameters}
        slopes |= {one: 2 * slopes[other] for one, other in alike}
        base = np.ones((n, c, 1), dtype=np.complex128)
        y = (base + sum(truth.get(name, 0.0) * slope for name, slope in slopes.items()))[None, ..., 0]
        noise = np.full((1, n, c), 0.02)
        values = y + noise * (rng.standard_normal(y.shape) + 1j * rng.standard_normal(y.shape)) / np.sqrt(2)
        measured = Measured(
            name="one",
            configuration="one",
            runs=("r",),
            channels=tuple(f"c{k}" for k in range(c)),
            judged=np.ones(c, dtype=bool),
            frequency=np.linspace(4.0, 30.0, n),
            values=values,
            noise=noise,
            inputs=np.ones((1, n, 1), dtype=np.complex128),
        )
        return Problem((Affine(measured=measured, parameters=tuple(parameters), base=base, slopes=slopes),))

    return make
