"""A fit may give an effect what its family allows, and no more; that it is not there is always allowed."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.effects.catalogue import parse
from validation.effects.effect import Vocabulary
from validation.estimation.problem import DECLARED, PLAIN, Parameter
from validation.model.model import Added
from validation.prediction import effects

WORDS = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)


@pytest.mark.parametrize(
    "text",
    [
        "structural-damping:mast=0.02",
        "joint-compliance:rotation=1e-6",
        "appendage:z=m:0.05,f:21,zeta:0.01",
        "point-mass:flange=0.4",
        "friction:flange:x=3",
    ],
)
def test_bounds_are_those_of_the_family_and_hold_no_effect(text: str) -> None:
    named = parse(text, WORDS)
    sizes = {effects.name(named, size.key): size for size in named.sizes}
    found = effects.parameters((Added(named=named),))
    assert found
    for one in found:
        size = sizes[one.name]
        low, high = (size.low, size.high) if size.logarithmic else (min(size.low, size.null), max(size.high, size.null))
        assert_allclose([one.value(one.low), one.value(one.high)], [low, high], rtol=1e-12)
        assert one.low < one.start < one.high
        assert size.logarithmic or one.low <= 0.0 <= one.high


def test_a_tolerance_that_becomes_an_effect_gets_the_bounds_of_its_family() -> None:
    declared = Parameter(
        name="modulus:mast", unit="1", tolerance=0.025, kind=DECLARED, nominal=1.0, logarithmic=True, above=-1.0, within=0.0625
    )
    (one,), _ = effects.opened((declared,), (Added(named=parse("modulus:mast=-0.12", WORDS)),))
    low, high = one.bounds(plain=True)
    assert_allclose([one.value(low), one.value(high)], [-0.9, 9.0], rtol=1e-12)
    assert declared.bounds(plain=True) == (-0.0625, 0.0625)
    assert declared.bounds(plain=False) == (-np.inf, np.inf)
    assert one.kind in PLAIN
