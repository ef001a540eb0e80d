"""A laboratory made by hand: the 22 channels of the virtual shaker over a body with one bending mode, nothing simulated."""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np
import pytest

from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.inertia import Inertia
from identification.chain import Chain, chain
from validation.compare.compare import Comparison, FactComparison, worst
from validation.compare.correlation import NamedMode
from validation.compare.maps import Doubt, Map, Rig, mapped
from validation.estimation.problem import (
    DECLARED,
    IDENTIFIED,
    Change,
    Evaluation,
    Fit,
    Measured,
    Parameter,
    Predicted,
    Problem,
    Share,
)
from validation.estimation.verdicts import ExplainedError, told, tolerances
from validation.virtual_test.layout import mavis

FREQUENCY = np.sort(np.concatenate([np.linspace(4.0, 32.0, 71), np.arange(11.7, 12.6, 0.1) + 0.03]))
MODE = NamedMode(name="first mast mode", frequency=12.0, damping_ratio=0.01)
BODY = Inertia(parameters=np.array([60.0, 0.3, -0.2, 18.0, 9.0, 9.5, 2.2, 0.05, -0.1, 0.08]))
PARTICIPATION = np.array([3.0, 0.2, 0.0, -0.3, 4.0, 0.05])
"""Bending along x, and so a moment about y."""

HEAVIER = Inertia(parameters=np.eye(10)[0]).mass_matrix
"""d M / d mass, of a point at F."""

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
    known: bool = False
    mass: bool = False

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        own = (Parameter(name="mass", unit="kg", tolerance=3.0, kind=IDENTIFIED),) if self.mass else ()
        chained = () if self.known else self.of.parameters
        return (*own, *(Parameter(name=one.name, unit=one.unit, tolerance=one.tolerance) for one in chained))

    def on(self, runs: Sequence[str]) -> "ByHand":
        return replace(self, measured=self.measured.on(runs))

    def at(self, offsets: Mapping[str, float], lines=None, *, derivatives: bool = True) -> Predicted:
        f = self.measured.frequency if lines is None else self.measured.frequency[lines]
        theta, H = (
            np.array([offsets.get(one.name, 0.0) for one in self.of.parameters]),
            dynamic_mass(f) + offsets.get("mass", 0.0) * HEAVIER,
        )
        A0, A1 = self.of.rows(theta, f)
        found = zip(self.of.parameters, self.of.derivatives(theta, f, H), strict=True)
        changes = {one.name: Change(channels=change.channels, rows=change.rows) for one, change in found}
        if self.mass:
            loaded = tuple(int(k) for k in self.of.forces.columns)
            changes["mass"] = Change(channels=loaded, rows=(A1 @ HEAVIER)[:, list(loaded)])
        return Predicted(rows=A0 + A1 @ H, changes=changes if derivatives else {})


class ByHandLaboratory:
    """Makes data sets and their maps."""

    MODE, RIG, FREQUENCY = MODE, Rig(table=TABLE, gravity=9.81), FREQUENCY
    dynamic_mass = staticmethod(dynamic_mass)

    @staticmethod
    def test(
        truth: Mapping[str, float] | None = None,
        *,
        own: float = MODE.frequency,
        seed: int | None = 0,
        name: str = "fmd+mast",
        louder: float = 1.0,
    ) -> ByHand:
        """Six sweeps at the offsets `truth` of the chain, of a body whose mode lies at `own`; without a seed, without noise."""
        of, rng = chain(TABLE), np.random.default_rng(seed or 0)
        level = np.array([LEVELS[axis] for axis in MOTIONS])
        cross = 0.03 * (rng.standard_normal((6, 6)) + 1j * rng.standard_normal((6, 6)))
        u = np.broadcast_to(((np.eye(6) + cross) * level)[:, None, :], (6, len(FREQUENCY), 6))
        theta = np.array([(truth or {}).get(one.name, 0.0) for one in of.parameters])
        A0, A1 = of.rows(theta, FREQUENCY)
        values = ((A0 + A1 @ dynamic_mass(FREQUENCY, own)) @ u[..., None])[..., 0]
        judged = np.isin(np.arange(len(of)), of.forces.columns)
        noise = louder * np.where(judged, 0.02, 5e-4) * np.ones(values.shape)
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
    def without_tolerances(test: ByHand) -> ByHand:
        """The same model, of a laboratory that knows its chain exactly."""
        return replace(test, known=True)

    @staticmethod
    def fitting_mass(test: ByHand) -> ByHand:
        """The same model, which has to identify the mass of the body."""
        return replace(test, mass=True)

    @staticmethod
    def nothing_fitted(problem: Problem) -> Doubt:
        loose = {one.name: one.tolerance for one in problem.parameters if 0 < one.tolerance < np.inf}
        return Doubt(tolerances=loose, answer=np.zeros((0, len(loose))), own=np.zeros((0, 0)))

    @staticmethod
    def mapped(test: ByHand) -> Map:
        """Its map, nothing fitted."""
        return mapped(test, {}, ByHandLaboratory.nothing_fitted(Problem((test,))), ByHandLaboratory.RIG)


def evaluated(z: float = 1.0, fmd: float = 0.1) -> Evaluation:
    """Errors and fits as an engine might return them; fmd-z2 stands `z` tolerances off, the FMD's mass `fmd` [kg]."""
    parameters = (
        Parameter(name="fmd:m", unit="kg", tolerance=0.9, kind=IDENTIFIED, nominal=18.0),
        Parameter(name="modulus:mast", unit="1", tolerance=0.025, kind=DECLARED),
        Parameter(name="force-gain:fmd-z2", unit="1", tolerance=0.003),
        Parameter(name="force-gain:fmd-z1", unit="1", tolerance=0.003),
    )
    fitted = Fit(
        parameters=parameters,
        offsets=np.array([fmd, 0.01, 0.003 * z, 0.001]),
        covariance=np.diag([1e-4, 1e-5, 1e-6, 1e-6]),
        cost=900.0,
        chi2=1760.0,
        degrees_of_freedom=2000,
        tolerance_z2=0.16 + z**2 + 0.11,
        tolerances=3,
        log_evidence=-900.0,
        converged=True,
    )
    plain = replace(
        fitted,
        parameters=parameters[:2],
        offsets=np.array([0.2, 0.02]),
        covariance=np.eye(2) * 1e-5,
        tolerance_z2=0.64,
        tolerances=1,
    )
    folds = {"run z of fmd+mast": 1.6, "run x of fmd+mast": 1.4}
    return Evaluation(
        nominal=Share(percent=12.3),
        plain=Share(percent=1.23, by_run={"fmd+mast/z": 1.2}),
        held_out=Share(percent=1.5, by_fold=folds),
        held_out_nominal=Share(percent=12.5, by_fold=dict.fromkeys(folds, 12.0)),
        plain_fit=plain,
        fitted=fitted,
        held_out_names=tuple(folds),
    )


@pytest.fixture(scope="session")
def evaluation() -> Callable[..., Evaluation]:
    return evaluated


@pytest.fixture(scope="session")
def found() -> Comparison:
    """A comparison of the laboratory made by hand, fmd-z2 eight per cent too much."""
    test = ByHandLaboratory.test({**ByHandLaboratory.drawn(1), "force-gain:fmd-z2": 0.08}, seed=1)
    of, evaluation = ByHandLaboratory.mapped(test), evaluated(z=24.0)
    spots = worst([of], [[MODE]])
    return Comparison(
        title="mast on the FMD",
        source="mast.toml",
        evaluation=evaluation,
        explained=ExplainedError(measurement=0.9, with_modes=0.9),
        errors=told(evaluation, ExplainedError(measurement=0.9, with_modes=0.9), spots[0].sigma),
        absurd=tolerances(evaluation.fitted),
        maps=(of,),
        modes=((MODE,),),
        worst=spots,
        facts=(
            FactComparison(
                name="scale.toml: mass",
                unit="kg",
                predicted=33.012,
                measured=32.955,
                tolerance=0.01,
                sigma=5.7,
                nominal_sigma=-0.4,
            ),
        ),
        remarks=("the mounting is assumed",),
    )


@pytest.fixture(scope="session")
def by_hand() -> type[ByHandLaboratory]:
    return ByHandLaboratory
