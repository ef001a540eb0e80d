"""Whatever may be drawn of an inertia leaves a body that can be simulated."""

from functools import cache

import numpy as np
import pytest

from benchmarks.blind.drawing import limits
from benchmarks.blind.drawing.case import SERIES
from benchmarks.blind.drawing.choices import CHOICES, Choice
from benchmarks.cross_check_proof import SWEEPS
from fem.base_excitation.rig import Rig
from validation.effects.catalogue import parse
from validation.virtual_test import simulate
from validation.virtual_test.plan import Plan, changed_rig
from validation.virtual_test.planted import planted

MULTIPLES = (2.0, 5.0, 15.0)

INERTIA = [one for one in CHOICES if one.family == "rigid-inertia"]


def largest(choice: Choice) -> float:
    """The multiple of a limit that is drawn of what is left out of the catalogue, where 15 times is too much."""
    return float(np.floor(choice.largest / min(limits.limit(id) for id in choice.ids)))


@cache
def rig(article: str) -> Rig:
    """As it is drawn for a laboratory, nothing missing."""
    return simulate.laboratory(Plan(article=article, seed=1, **SWEEPS)).rig


@pytest.mark.parametrize("choice", INERTIA, ids=lambda one: "+".join(one.targets))
@pytest.mark.parametrize("article", SERIES)
def test_a_body_is_left_of_every_inertia_that_may_be_drawn(choice: Choice, article: str) -> None:
    made = 0
    for id in choice.ids:
        for size in (multiple * limits.limit(id) for multiple in (*MULTIPLES, largest(choice))):
            if size > choice.largest:
                continue
            for sign in (1.0, -1.0) if choice.signed and size <= choice.least else (1.0,):
                changed_rig(rig(article), planted([parse(f"{id}={sign * size:.5g}")]))
                made += 1
    assert made
