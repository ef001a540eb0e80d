"""Friction and a gap: what exudyn makes of them in the channels, and that one level does not tell what two do."""

from collections.abc import Callable
from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import Array
from validation.effects.catalogue import parse_all
from validation.effects.families.friction import describing_function
from validation.effects.families.gap import WARP, clipped
from validation.virtual_test.layout import ACCELEROMETERS, FORCES
from validation.virtual_test.plan import RIGID, Plan, exact
from validation.virtual_test.planted import planted
from validation.virtual_test.simulate import laboratory, record, recording, runs

NAMES = (*ACCELEROMETERS, *FORCES)
STEP = 0.01
"""Share by which exudyn and the recursion may differ at this coarse step: (pi f / rate)², times a few."""

Sweep = Callable[..., dict[str, Array]]


@pytest.fixture(scope="module")
def sweep() -> Sweep:
    """``sweep(axis, *effects, level, rate)``: channels by name of a short sweep of a rigid block, nothing else drawn."""
    plan = replace(
        exact(Plan(article="fmd+disc+cuboid", model=RIGID, band=(8.0, 16.0), octaves_per_minute=240.0, cross=0.0)),
        quiet=0.1,
        rate=256.0,
        simulation_rate=2048.0,
        ringing=1e-3,
    )

    def run(axis: str, *effects: str, level: float = 1.0, rate: float = 240.0) -> dict[str, Array]:
        own = replace(plan, effects=planted(parse_all(effects)), levels=(level,), octaves_per_minute=rate)
        made = next(one for one in runs(own) if one.name == axis)
        lab = laboratory(own)
        found = recording(own, lab.layout, lab.chain, made, record(own, lab, made))
        return dict(zip(NAMES, found.values.T, strict=True))

    return run


def shear(found: dict[str, Array]) -> Array:
    return found["fmd-x12"] + found["fmd-x34"]


def test_what_never_slips_or_lifts_is_linear(sweep):
    """Both routes, on the same rig: a loose part of 2 kg that sticks is 2 kg; a cell under a load of tons never opens."""
    plain, stuck, closed = sweep("x"), sweep("x", "friction:flange:x=1e5"), sweep("x", "gap:1=1e5")
    n = min(len(one["fmd-z1"]) for one in (plain, stuck, closed))
    size = np.max(np.abs(shear(plain)))
    assert_allclose(shear(closed)[:n], shear(plain)[:n], rtol=0, atol=STEP * size)
    assert_allclose((shear(stuck) - 2.0 * stuck["cover-x1"])[:n], shear(plain)[:n], rtol=0, atol=STEP * size)


def test_a_loose_part_is_dragged_by_its_slip_force_and_a_cell_that_lifts_pulls_no_more_than_its_preload(sweep):
    dragged = []
    for level in (1.0, 2.0):
        plain, slipping = sweep("x", level=level), sweep("x", "friction:flange:x=1", level=level)
        n = min(len(plain["fmd-z1"]), len(slipping["fmd-z1"]))
        dragged.append(np.sqrt(2) * np.std((shear(slipping) - shear(plain))[: n // 2]))
    assert dragged[0] == pytest.approx(dragged[1], rel=0.1)  # of a linear part it would be twice as much
    assert dragged[0] == pytest.approx(1.0, rel=0.35)  # between a sine and a square of 1 N, at the ends of the sweep less
    plain, lifting = sweep("z"), sweep("z", "gap:1=5")
    assert np.min(plain["fmd-z1"]) < -20.0
    assert -5.8 < np.min(lifting["fmd-z1"]) < -4.5  # the anti-alias filter swings at the corner, by a tenth
    total, whole = (sum(one[f"fmd-z{k}"] for k in range(1, 5)) for one in (lifting, plain))
    n = min(len(total), len(whole))
    assert_allclose(total[:n], whole[:n], rtol=0, atol=0.05 * np.max(np.abs(whole)))  # hardly visible in the dynamic mass


@pytest.mark.parametrize("share", [1.5, 0.25, pytest.param(0.8, marks=pytest.mark.proof)])
def test_the_mass_that_a_sweep_sees_is_that_of_the_harmonic_balance(sweep, share):
    """Of a part of 2 kg that slips, swept at 2.5 m/s²: by exudyn in time, against the equation of the catalogue."""
    found = sweep("x", rate=40.0), sweep("x", f"friction:flange:x={share * 2.0 * 2.5}", rate=40.0)
    n = 2 ** int(np.ceil(np.log2(max(len(one["cover-x1"]) for one in found))))
    plain, slipping = (np.fft.rfft(shear(one), n) / np.fft.rfft(one["cover-x1"], n) for one in found)
    f = np.fft.rfftfreq(n, 1 / 256.0)
    middle = np.mean((slipping - plain)[(f > 10.0) & (f < 13.0)])
    assert_allclose(middle / 2.0, describing_function(share), rtol=0, atol=0.02)  # a longer sweep comes nearer


@pytest.mark.parametrize("preload", [5.0, pytest.param(15.0, marks=pytest.mark.proof)])
def test_in_a_slow_sweep_a_lifting_cell_reads_its_describing_function_and_the_others_the_rest(sweep, preload):
    """By exudyn in time, against the catalogue's equation: the median over the lines, which the ends of the sweep make ripple."""
    plain, lifting = sweep("z", rate=30.0), sweep("z", f"gap:1={preload:g}", rate=30.0)
    n = min(len(one["fmd-z1"]) for one in (plain, lifting))
    inside = slice(*np.searchsorted(np.fft.rfftfreq(n, 1 / 256.0), (9.0, 15.0)))
    was, now = ({k: np.fft.rfft(one[f"fmd-z{k}"][:n])[inside] for k in range(1, 5)} for one in (plain, lifting))
    expected = clipped(preload, np.array([np.max(np.abs(plain["fmd-z1"]))]))[0]
    assert np.median((now[1] / was[1]).real) == pytest.approx(expected, rel=0.01)
    carried = [np.median(((now[k] - was[k]) / (now[1] - was[1])).real) for k in range(1, 5)]
    assert_allclose(carried, WARP["1"], atol=0.02)
