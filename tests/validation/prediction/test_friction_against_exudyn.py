"""Friction by harmonic balance against a virtual test that exudyn integrates: what a sweep sees of a part that slips."""

from dataclasses import replace
from functools import cache

import numpy as np
import pytest

from geometry.frames import Array
from validation.effects.catalogue import parse_all
from validation.effects.families.friction import describing_function
from validation.virtual_test.layout import ACCELEROMETERS, FORCES
from validation.virtual_test.plan import RIGID, Plan, exact
from validation.virtual_test.planted import planted
from validation.virtual_test.simulate import laboratory, recording, runs

MASS, LEVEL = 2.0, 2.5
"""[kg] of the loose part, [m/s²] of the sweep."""

PLAN = replace(
    exact(Plan(article="fmd+disc+cuboid", model=RIGID, band=(8.0, 16.0), octaves_per_minute=40.0, cross=0.0)),
    quiet=0.1,
    rate=256.0,
    simulation_rate=2048.0,
    ringing=1e-3,
)


@cache
def recorded(*effects: str) -> tuple[Array, Array]:
    """Shear force and acceleration of the cover plate along x, of one sweep along x."""
    own = replace(PLAN, effects=planted(parse_all(effects)))
    made = next(one for one in runs(own) if one.name == "x")
    found = dict(zip((*ACCELEROMETERS, *FORCES), recording(own, laboratory(own), made).values.T, strict=True))
    return found["fmd-x12"] + found["fmd-x34"], found["cover-x1"]


def spectrum(signal: Array, count: int) -> tuple[Array, Array]:
    return np.fft.rfftfreq(count, 1 / PLAN.rate), np.fft.rfft(signal, count)


@pytest.mark.parametrize("share", [1.5, 0.8, 0.25])
def test_the_mass_that_a_sweep_sees_is_that_of_the_harmonic_balance(share: float) -> None:
    (plain, motion), (slipping, moved) = recorded(), recorded(f"friction:flange:x={share * MASS * LEVEL}")
    n = 2 ** int(np.ceil(np.log2(max(len(plain), len(slipping)))))
    f, A = spectrum(motion, n)
    seen = spectrum(slipping, n)[1] / spectrum(moved, n)[1] - spectrum(plain, n)[1] / A
    middle = np.mean(seen[(f > 10.0) & (f < 13.0)])
    np.testing.assert_allclose(
        middle / MASS, describing_function(share), rtol=0, atol=0.02
    )  # the sweep is short; a longer one comes nearer
