"""Small, fast virtual tests: six axes at once, a block on the FMD, the laboratory of one seed, nothing random in the records."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import pytest

from identification.campaign import Campaign
from validation.effects.catalogue import parse_all
from validation.virtual_test.plan import MULTI, NONE, RIGID, Plan, exact
from validation.virtual_test.planted import planted
from validation.virtual_test.simulate import simulate

RATE = 256.0


PLAN = Plan(
    article="fmd+disc+cuboid",
    model=RIGID,
    pattern=MULTI,
    band=(8.0, 32.0),
    octaves_per_minute=240.0,
    quiet=1.0,
    rate=RATE,
    simulation_rate=8 * RATE,
    seed=5,
    noise_rms=NONE,
    mains=NONE,
)


@pytest.fixture(scope="session")
def tested():
    """``tested("force-gain:fmd-z2=0.08")``: the test with these faults; the same laboratory every time."""
    return cache(lambda *effects: _made(PLAN, effects))


@pytest.fixture(scope="session")
def exactly() -> Callable[..., Campaign]:
    """The same in a laboratory without any error."""
    return cache(lambda *effects: _made(exact(PLAN), effects))


def _made(plan: Plan, effects: tuple[str, ...]) -> Campaign:
    return simulate(replace(plan, effects=planted(parse_all(effects)))).campaign
