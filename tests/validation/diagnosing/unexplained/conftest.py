"""A campaign of a rigid body; whatever a test wants to be left over is added to what the model says that its channels read."""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass, replace

import numpy as np
import pytest

from geometry.dynamic_mass import ComplexArray
from validation.diagnose.diagnosis import Candidate
from validation.estimation.fit import FLOOR, ended, fitted
from validation.estimation.likelihood import cost_of
from validation.estimation.problem import FITTED, Problem
from validation.model.model import Model
from validation.prediction.series import SeriesPrediction, predictions
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import simulate

ARTICLE = "fmd+disc+cuboid"
STIFFNESS = (4e8, 4e8, 2e9)
"""[N/m] of the cells of the built-in FMD, on which virtual tests stand."""

NOISE = 5e-4
"""Of the level of a channel in a run."""


@dataclass(frozen=True, eq=False, kw_only=True)
class State:
    """A model as it stands, at the lines of its data.

    Attributes
    ----------
    of : the prediction
    u : (r, m, 6) motions
    H : (m, 6, 6) dynamic mass
    by_load : (m, c, 6) what the channels read for a unit of every load
    read : (r, m, c) what they read
    """

    of: SeriesPrediction
    u: ComplexArray
    H: ComplexArray
    by_load: ComplexArray
    read: ComplexArray

    @property
    def channels(self) -> tuple[str, ...]:
        return self.of.measured.channels

    @property
    def frequency(self) -> np.ndarray:
        return self.of.measured.frequency

    @property
    def omega(self) -> np.ndarray:
        return 2 * np.pi * self.frequency

    def added(self, dH: ComplexArray) -> ComplexArray:
        """(r, m, c) what a change of the dynamic mass (m, 6, 6) adds."""
        return (self.by_load @ dH @ self.u[..., None])[..., 0]

    def of_channel(self, channel: str, reading: ComplexArray) -> ComplexArray:
        """(r, m, c) `reading` (r, m) in one channel."""
        found = np.zeros_like(self.read)
        found[..., self.channels.index(channel)] = reading
        return found

    def reading(self, channel: str) -> ComplexArray:
        """(r, m)"""
        return self.read[..., self.channels.index(channel)]

    def of_parameter(self, name: str, share: ComplexArray) -> ComplexArray:
        """(r, m, c) what the parameter `name` adds whose offset goes with frequency as `share` (m,)."""
        change = self.of.at({}, derivatives=frozenset({name})).changes[name]
        found = np.zeros_like(self.read)
        found[..., change.channels] = share[:, None] * (change.rows @ self.u[..., None])[..., 0]
        return found


Left = Callable[[Callable[[State], ComplexArray]], Candidate]


@pytest.fixture(scope="session")
def state() -> State:
    """Of a Cuboid that does not give, in very fast sweeps."""
    plan = Plan(article=ARTICLE, model="rigid", seed=5, octaves_per_minute=120.0, quiet=0.1, simulation_rate=2048.0)
    model = Model(source="model.toml", title="a virtual laboratory", article=ARTICLE, cell_stiffness=np.array(STIFFNESS))
    (one,) = predictions(model, [simulate(plan).campaign], lines=np.linspace(4.2, 31.8, 40))
    A = one.at({}, derivatives=False).rows
    u = (np.linalg.pinv(A) @ one.measured.values[..., None])[..., 0]
    return State(of=one, u=u, H=one.dynamic_mass({}), by_load=one.by_load({}), read=(A @ u[..., None])[..., 0])


@pytest.fixture(scope="session")
def left(state: State) -> Left:
    """``left(change)``: the model as it stands beside what it reads itself, noise, and what `change` of the `State` adds.

    Nothing is fitted: what a fit would take is known to first order.
    """

    def made(change: Callable[[State], ComplexArray]) -> Candidate:
        rng = np.random.default_rng(2)
        noise = NOISE * np.sqrt(np.mean(np.abs(state.read) ** 2, axis=1, keepdims=True)) * np.ones(state.read.shape)
        random = rng.standard_normal(state.read.shape) + 1j * rng.standard_normal(state.read.shape)
        values = state.read + change(state) + noise * random / np.sqrt(2)
        measured = replace(state.of.measured, values=values, noise=noise)
        problem = Problem((replace(state.of, tested=replace(state.of.tested, measured=measured)),))
        cost = cost_of(problem, problem.free(FITTED), FLOOR)
        return Candidate(effects=(), fit=fitted(ended(cost, {}, converged=False)), problem=problem)

    return made
