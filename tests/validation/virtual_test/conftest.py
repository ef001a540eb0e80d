"""What tests of virtual tests share: fast plans, and the nominal evaluation of a campaign (Eqs. 6, 7 and 9 to 11)."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from fem.damping import Damping
from geometry.dynamic_mass import DynamicMass
from geometry.sensors import motion_rows, resultants
from identification.campaign import Campaign
from identification.dynamic_mass import from_runs
from identification.spectra.line_spectra import full_record
from validation.virtual_test.plan import Plan, exact
from validation.virtual_test.simulate import VirtualTest, simulate

FAST = {"octaves_per_minute": 60.0, "quiet": 1.0, "ringing": 1e-4}
RIGID = {"model": "rigid", **FAST}
ELASTIC = {"damping": Damping(ratio=0.05), **FAST}


@pytest.fixture(scope="session")
def rigid_plan() -> Callable[..., Plan]:
    """``rigid_plan(**changes)``: a rigid Cuboid on its disc, in fast sweeps."""
    return lambda **changes: Plan(**{"article": "fmd+disc+cuboid", **RIGID, **changes})


@pytest.fixture(scope="session")
def elastic_plan() -> Callable[..., Plan]:
    """``elastic_plan(**changes)``: Clumod with one blade, well damped, in fast sweeps."""
    return lambda **changes: Plan(**{"article": "fmd+clumod-1", **ELASTIC, **changes})


@pytest.fixture(scope="session")
def exact_test(rigid_plan) -> VirtualTest:
    """The rigid Cuboid in a laboratory without errors."""
    return simulate(exact(rigid_plan()))


@pytest.fixture(scope="session")
def ordinary(elastic_plan) -> Callable[[str], VirtualTest]:
    """``ordinary(article)``: a fast virtual test with ordinary tolerances, each article once; all of one seed."""
    return cache(lambda article: simulate(elastic_plan(article=article, seed=987654321)))


@pytest.fixture(scope="session")
def spectra() -> Callable[[Campaign, np.ndarray], dict[str, np.ndarray]]:
    """``spectra(campaign, lines)``: complex lines (n, c) of every run."""

    def made(campaign: Campaign, lines: np.ndarray) -> dict[str, np.ndarray]:
        return {name: full_record(r.values, r.sampling_rate, lines) for name, r in campaign.recordings.items()}

    return made


@pytest.fixture(scope="session")
def measured(spectra) -> Callable[[Campaign, np.ndarray], DynamicMass]:
    """``measured(campaign, lines)``: the dynamic mass by nominal places, as the paper evaluates a test."""

    def made(campaign: Campaign, lines: np.ndarray) -> DynamicMass:
        table = campaign.table
        cover, cells = table.select(group="cover"), table.select(group="fmd")
        G = motion_rows([table.channels[k] for k in cover], table.origin)
        R = resultants([table.channels[k] for k in cells], table.origin)
        lined = spectra(campaign, lines).values()
        motion = np.array([values[:, cover] @ np.linalg.pinv(G).T for values in lined])
        load = np.array([values[:, cells] @ R.T for values in lined])
        return from_runs(load, motion, lines).dynamic_mass

    return made
