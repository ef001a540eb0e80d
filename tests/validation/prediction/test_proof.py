"""The proof on Clumod in short: in a laboratory without tolerances the right effect explains a fault, its neighbour does not."""

from dataclasses import replace
from typing import Any

import numpy as np
import pytest

from benchmarks import cross_check_proof as proof
from benchmarks.cross_check_proof import BLADE, Case, Laboratory
from fem.damping import Damping
from geometry.sensors import Tolerances
from validation.model.model import Model, StructureTolerances
from validation.virtual_test.plan import NOISE, Plan, exact

RATIO = 0.05

CASES = (
    Case(planted="force-gain:fmd-z2=0.15", neighbour="load-path-shunt:z", articles=(BLADE,)),
    Case(planted="accelerometer-position:cover-z3:x=0.03", neighbour="accelerometer-gain:cover-z3", articles=(BLADE,)),
    Case(planted="point-mass:mast-top=0.1", neighbour="rigid-inertia:m", articles=(BLADE,)),
    Case(planted="modulus:mast=0.04", neighbour="point-mass:mast-top", articles=(BLADE,)),
    Case(planted="mounting-offset:x=0.01", neighbour="rigid-inertia:mz", articles=(BLADE,)),
)
"""One for each stage of a prediction but that of whole channels, and one that opens a tolerance of the structure."""


@pytest.fixture(scope="module")
def laboratory() -> Laboratory:
    """Nothing is drawn, records are noisy, sweeps are so fast that few lines are enough."""
    fast: dict[str, Any] = {"octaves_per_minute": 60.0, "quiet": 0.3, "noise_rms": NOISE}
    plan = replace(exact(Plan(article=BLADE, seed=6)), damping=Damping(ratio=RATIO), **fast)
    known = Model(
        source="model.toml",
        title="exact",
        article=BLADE,
        cell_stiffness=np.array(proof.STIFFNESS),
        fmd_tolerance=0.0,
        damping_ratio=RATIO,
        tolerances=Tolerances().scaled(0.0),
        structure=StructureTolerances(modulus=0.003, frequency=0.0, damping=0.1, participation=0.0, mode_coupling=0.0),
    )
    return Laboratory(plan=plan, model=known, lines=np.arange(4.0, 32.0, 0.7))


@pytest.fixture(scope="module")
def null(laboratory) -> dict[str, Any]:
    return proof.nothing_planted((BLADE,), laboratory)


IN_SHORT = ("point-mass",)
"""One of the structure, the stages of the chain being those of every diagnosis; `make proof` has the others."""


@pytest.mark.parametrize(
    "case",
    [pytest.param(one, marks=[pytest.mark.proof] * (one.named.family not in IN_SHORT), id=one.named.family) for one in CASES],
)
def test_the_right_effect_explains_a_fault_and_a_wrong_one_does_not(case, laboratory, null):
    found = proof.proved(case, laboratory, null)
    verdict = proof.verdict(found)
    assert verdict.visible
    assert verdict.met, (verdict.words, found["sizes"])
    assert all(proof.times(one, null) > proof.WITHIN for one in found["wrong"].values() if one is not None)
