"""What is screened in closed form is what a fit finds, by data and by facts alike."""

from dataclasses import dataclass, field, replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.estimation.fit import FLOOR, fit
from validation.estimation.problem import FITTED, Parameter, Problem
from validation.estimation.screening import screened


@dataclass(frozen=True, eq=False, kw_only=True)
class Weight:
    """``value = sum(slope * offset) +- sd``."""

    value: float
    sd: float
    slopes: dict[str, float]
    parameters: tuple[Parameter, ...] = field(default=())
    name: str = "a weight"

    def residual(self, offsets: dict[str, float]) -> tuple[float, dict[str, float]]:
        said = sum(slope * offsets.get(name, 0.0) for name, slope in self.slopes.items())
        return (said - self.value) / self.sd, {name: slope / self.sd for name, slope in self.slopes.items()}


@pytest.mark.parametrize("sd", [1e9, 2e-4, 2e-5])
def test_a_fact_tells_what_it_tells_the_fit(lab: Any, sd: float) -> None:
    truth, effect = {**lab.drawn(4), "offset": 1e-3}, lab.effect("offset", 1.0)
    right = lab.toy(truth, parameters=(*lab.LABORATORY, effect))
    without = lab.toy(truth, acting=(effect,))
    weight = Weight(value=1.05e-3, sd=sd, slopes={"offset": 1.0, "mass": 0.3}, parameters=(effect,))
    parent = fit(Problem((without,), (replace(weight, slopes={"mass": 0.3}, parameters=()),)), FITTED)
    problem = Problem((right,), (weight,))
    told = screened(problem, parent, ["offset"]).told()["offset"]
    child = fit(problem, FITTED, start=parent)
    variance = float(np.diag(child.covariance)[[one.name for one in child.parameters].index("offset")])
    # linear to a few per cent of a standard deviation; what is known beforehand of the effect is in the fit and not in the told
    assert_allclose(1 / told.information, variance, rtol=2e-2)
    assert_allclose(told.estimate, child.by_name["offset"], atol=0.1 * np.sqrt(variance))
    gain = child.log_evidence - parent.log_evidence
    assert_allclose(told.evidence(1.0), gain, atol=0.05 + 0.02 * abs(gain))


def test_a_fact_alone_tells_of_what_no_channel_sees(lab: Any) -> None:
    truth, unseen = lab.drawn(4), lab.effect("unseen", 2.0)
    toy = lab.toy(truth)
    weight = Weight(value=3.0, sd=0.5, slopes={"unseen": 1.0}, parameters=(unseen,))
    parent = fit(Problem((toy,)), FITTED, floor=FLOOR)
    told = screened(Problem((toy,), (weight,)), parent, ["unseen"]).told()["unseen"]
    assert_allclose([told.estimate, told.deviation], [3.0, 0.5], rtol=1e-12)
    # two normal densities of a weight: with the effect it may be 2.06 wide, without it 0.5
    expected = 0.5 * (3 / 0.5) ** 2 - 0.5 * 9 / (4 + 0.25) - 0.5 * np.log(1 + 4 / 0.25)
    assert_allclose(told.evidence(2.0), expected, rtol=1e-12)
