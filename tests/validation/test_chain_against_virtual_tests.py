"""The measurement chain against virtual tests: two ways to one reading that share nothing but the nouns.

A virtual test is sampled in time from table, cover plate and cells of a rig that is driven; the chain knows A0, A1 and the
dynamic mass line by line. At the truth both must agree in every channel once the six motions of the cover plate are free.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np
import pytest

from fem.damping import Damping
from identification.measurement_chain import Chain, chain
from identification.spectra.of_campaign import spectra
from validation.virtual_test.chain_truth import ChainTruth
from validation.virtual_test.hooks import Effect
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import simulate

LINES = [8.0, 12.0, 16.0, 24.0]
"""[Hz] of those at which the truth states the dynamic mass."""

FAULTS = {
    "force-plane-offset:x": 2e-3,
    "force-plane-offset:y": -3e-3,
    "fmd-compliance:lateral": 1.3,
    "fmd-compliance:vertical": 0.8,
    "gravity": 0.0,
}
"""What no seed draws; the value by which the chain knows it."""

AGREED = {"cover": 2e-5, "table": 2e-5, "fmd": 3e-4}
"""By group, of a channel's rms over runs and lines. Left are products of two tolerances: cross-talk is shared evenly there and by
the stiffness of the cells here, and a pick-up that is turned reads a shift along its nominal direction."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Compared:
    """One virtual test, and the chain that should read the same."""

    chain: Chain
    truth: dict[str, float]
    H: np.ndarray
    values: np.ndarray

    def left(self, values: Mapping[str, float]) -> dict[str, float]:
        """By group of channels the largest rms over runs and lines of what no motion of the cover plate explains."""
        A0, A1 = self.chain.rows(self.chain.theta(values), LINES)
        y = self.values[:, :, list(self.chain.columns)]
        level = np.sqrt(np.mean(np.abs(y) ** 2, axis=(0, 1)))
        A, y = (A0 + A1 @ self.H) / level[:, None], y / level
        Q, _ = np.linalg.qr(A)
        residual = y - np.einsum("nck,nak,rna->rnc", Q, Q.conj(), y)
        rms = np.sqrt(np.mean(np.abs(residual) ** 2, axis=(0, 1)))
        parts = {"cover": self.chain.cover, "table": self.chain.table, "fmd": self.chain.forces}
        return {group: float(rms[list(part.columns)].max()) for group, part in parts.items()}


def faulty(truth: ChainTruth) -> ChainTruth:
    """The drawn chain with `FAULTS` in it."""
    return replace(truth, plane_offset=np.array([2e-3, -3e-3]), compliance=np.array([1.3, 0.8]), gravity=0.0)


@pytest.fixture(scope="module")
def compared() -> Compared:
    plan = Plan(
        article="fmd+clumod-1",
        seed=11,
        damping=Damping(ratio=0.1),  # rings out fast; the chain sees but H
        octaves_per_minute=60.0,
        quiet=0.3,
        noise_rms={},
        mains={},
        effects=(Effect(id="faults", chain=faulty),),
    )
    test = simulate(plan)
    of_truth = test.truth["dynamic_mass"]
    at = [of_truth["frequency_hz"].index(line) for line in LINES]
    H = (np.array(of_truth["re"]) + 1j * np.array(of_truth["im"]))[at]
    made = chain(
        test.campaign.table,
        stiffness=(4e8, 4e8, 2e9),
        gravity=test.campaign.gravity,
        overrides={"force-plane-offset": 1.0, "gravity": 1.0},
    )
    known = {one.name for one in made.parameters}
    drawn = {name: value for name, value in test.truth["tolerances"].items() if name in known}
    values = spectra(test.campaign, frequency=LINES).values
    return Compared(chain=made, truth={**drawn, **FAULTS}, H=H, values=values)


def test_at_the_truth_the_chain_reads_what_was_recorded(compared: Compared) -> None:
    left = compared.left(compared.truth)
    assert all(left[group] < AGREED[group] for group in AGREED), left


def test_nominal_it_does_not(compared: Compared) -> None:
    left = compared.left({})
    assert all(left[group] > 50 * AGREED[group] for group in AGREED), left


FAMILIES = (
    *("force-gain", "force-delay", "force-crosstalk", "force-plane-offset", "cell-stiffness", "fmd-compliance", "gravity"),
    *("accelerometer-gain", "accelerometer-delay", "accelerometer-position", "accelerometer-misalignment"),
)


@pytest.mark.parametrize("family", FAMILIES)
def test_every_family_counts_and_has_the_right_sign(compared: Compared, family: str) -> None:
    """Left at nominal the agreement is lost; with the sign turned round it is lost twice over."""
    of_it = {name: value for name, value in compared.truth.items() if name.partition(":")[0] == family}
    nominal = {one.name: one.nominal for one in compared.chain.parameters}
    without = {name: value for name, value in compared.truth.items() if name not in of_it}
    turned = {**compared.truth, **{name: 2 * nominal[name] - value for name, value in of_it.items()}}
    agreed, lost, opposite = (compared.left(values) for values in (compared.truth, without, turned))
    group = max(AGREED, key=lambda one: lost[one] / agreed[one])
    assert lost[group] > 10 * agreed[group]
    assert opposite[group] > 1.5 * lost[group]
