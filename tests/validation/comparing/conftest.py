"""A laboratory made by hand: the 22 channels of the virtual shaker over a body with one bending mode, nothing simulated."""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.inertia import Inertia
from identification.measurement_chain import Chain, chain
from validation.comparing.doubt import nothing_fitted
from validation.comparing.maps import Map, Rig, mapped
from validation.comparing.modes import NamedMode
from validation.engine.measured import Measured
from validation.engine.parameter import Parameter
from validation.engine.prediction import Change, Predicted
from validation.engine.problem import Problem
from validation.engine.residuals import residuals
from validation.virtual_test.layout import mavis

FREQUENCY = np.linspace(4.0, 32.0, 113)
MODE = NamedMode(name="first mast mode", frequency=12.0, damping_ratio=0.01)
BODY = Inertia(parameters=np.array([60.0, 0.3, -0.2, 18.0, 9.0, 9.5, 2.2, 0.05, -0.1, 0.08]))
PARTICIPATION = np.array([3.0, 0.2, 0.0, -0.3, 4.0, 0.05])
"""Bending along x, and so a moment about y."""

TABLE = mavis(np.array([[0.12, 0.12, 0.0], [-0.12, 0.12, 0.0], [-0.12, -0.12, 0.0], [0.12, -0.12, 0.0]]), {}).table


def dynamic_mass(frequency: np.ndarray, own: float = MODE.frequency) -> np.ndarray:
    """H (n, 6, 6) of the body whose mode lies at `own` [Hz]."""
    bent = frequency**2 / (own**2 - frequency**2 + 2j * MODE.damping_ratio * own * frequency)
    return BODY.mass_matrix + bent[:, None, None] * np.outer(PARTICIPATION, PARTICIPATION)


@dataclass(frozen=True, eq=False, kw_only=True)
class ByHand:
    """A prediction with the tolerances of the measurement chain; the body is known exactly."""

    measured: Measured
    of: Chain

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        return tuple(Parameter(name=one.name, unit=one.unit, tolerance=one.tolerance) for one in self.of.parameters)

    def on(self, runs: Sequence[str]) -> ByHand:
        return replace(self, measured=self.measured.on(runs))

    def at(self, offsets: Mapping[str, float], lines=None, *, derivatives: bool = True) -> Predicted:
        f = self.measured.frequency if lines is None else self.measured.frequency[lines]
        theta, H = np.array([offsets.get(one.name, 0.0) for one in self.of.parameters]), dynamic_mass(f)
        A0, A1 = self.of.rows(theta, f)
        found = zip(self.of.parameters, self.of.derivatives(theta, f, H), strict=True)
        changes = {one.name: Change(channels=change.channels, rows=change.rows) for one, change in found}
        return Predicted(rows=A0 + A1 @ H, changes=changes if derivatives else {})


class ByHandLaboratory:
    """Makes data sets and their maps."""

    MODE, RIG, FREQUENCY = MODE, Rig(table=TABLE, gravity=9.81), FREQUENCY
    dynamic_mass = staticmethod(dynamic_mass)

    @staticmethod
    def test(
        truth: Mapping[str, float] | None = None, *, own: float = MODE.frequency, seed: int | None = 0, name: str = "fmd+mast"
    ) -> ByHand:
        """Six sweeps at the offsets `truth` of the chain, of a body whose mode lies at `own`; without a seed, without noise."""
        of, rng = chain(TABLE), np.random.default_rng(seed)
        level = np.array([LEVELS[axis] for axis in MOTIONS])
        cross = 0.03 * (rng.standard_normal((6, 6)) + 1j * rng.standard_normal((6, 6)))
        u = np.broadcast_to(((np.eye(6) + cross) * level)[:, None, :], (6, len(FREQUENCY), 6))
        theta = np.array([(truth or {}).get(one.name, 0.0) for one in of.parameters])
        A0, A1 = of.rows(theta, FREQUENCY)
        values = ((A0 + A1 @ dynamic_mass(FREQUENCY, own)) @ u[..., None])[..., 0]
        judged = np.isin(np.arange(len(of)), of.forces.columns)
        noise = np.where(judged, 0.02, 5e-4) * np.ones(values.shape)
        if seed is not None:
            values = values + noise * (rng.standard_normal(values.shape) + 1j * rng.standard_normal(values.shape)) / np.sqrt(2)
        measured = Measured(
            name=name,
            configuration=name,
            runs=MOTIONS,
            axes=MOTIONS,
            channels=of.names,
            judged=judged,
            frequency=FREQUENCY,
            values=values,
            noise=noise,
        )
        return ByHand(measured=measured, of=of)

    @staticmethod
    def drawn(seed: int) -> dict[str, float]:
        """Tolerances as a laboratory might have them."""
        rng = np.random.default_rng(seed)
        return {one.name: one.tolerance * float(rng.standard_normal()) for one in chain(TABLE).parameters}

    @staticmethod
    def mapped(test: ByHand) -> Map:
        """Its map, nothing fitted."""
        (left,) = residuals(Problem((test,)), {})
        return mapped(test, {}, nothing_fitted(Problem((test,))), left.inputs, ByHandLaboratory.RIG)


@pytest.fixture(scope="session")
def by_hand() -> type[ByHandLaboratory]:
    return ByHandLaboratory
