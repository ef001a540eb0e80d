"""What the linear equations leave out: bounds, powers of the level, and the example that prints them."""

import io
import re
import runpy
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from rich.console import Console

from fem.exudyn.large_motion import plan_of, rigid
from geometry.dynamic_mass import LEVELS
from geometry.inertia import Inertia

STUDY = runpy.run_path(str(Path(__file__).parents[3] / "examples" / "large_motion.py"))
"""The example's own functions."""

exponents, of_a_sine, of_a_sweep = STUDY["exponents"], STUDY["of_a_sine"], STUDY["of_a_sweep"]

FACTORS = (1.0, 10.0, 30.0)
Costs = dict[tuple[str, ...], tuple[Any, ...]]


@pytest.fixture(scope="module")
def costs(block: Inertia) -> Costs:
    driven = [("alpha",), ("beta",), ("gamma",), ("x", "gamma"), ("alpha", "beta", "gamma")]
    return {axes: of_a_sine(rigid(block), axes, FACTORS) for axes in driven}


@pytest.mark.parametrize("axis", ["alpha", "beta", "gamma"])
def test_one_axis_turning_leaves_out_at_most_its_angle(axis: str, costs: Costs) -> None:
    """The bound at the head of `cost`: omega² / omega', in a sine the angle. The nominal ones are 4.75 and 9.5 mrad at 4 Hz."""
    for each in costs[(axis,)]:
        assert each.angle == pytest.approx(each.factor * LEVELS[axis] / (8 * np.pi) ** 2, rel=1e-2)
        assert each.rate == pytest.approx(each.factor * LEVELS[axis] / (8 * np.pi), rel=1e-2)
        assert 0.4 * each.angle < each.peak <= each.angle
        assert each.rms < each.peak


def test_what_is_left_out_of_a_rigid_body_is_its_centripetal_and_gyroscopic_load(block: Inertia) -> None:
    """Of a sine about z in closed form: f = m omega x (omega x c), t = omega x (Theta omega), sizes by M^-1."""
    (found,) = of_a_sine(rigid(block), ["gamma"], [10.0])
    z, h = np.eye(3)[2], block.first_moment
    left = np.concatenate([np.cross(z, np.cross(z, h)), np.cross(z, block.tensor @ z)])
    kept = block.mass_matrix[:, 5]
    sizes = [np.sqrt(f @ np.linalg.solve(block.mass_matrix, f)) for f in (left, kept)]
    # both at their largest: omega² = (level / 8 pi)², omega' = level; while the sine rises it is up to 1 % above
    level = 10 * LEVELS["gamma"]
    assert found.peak == pytest.approx(sizes[0] / sizes[1] * level / (8 * np.pi) ** 2, rel=1e-2)


def test_second_order_in_the_record_and_third_at_the_driven_line(costs: Costs) -> None:
    """Shares grow with the level and with its square. About one axis the driven line has nothing at all."""
    for axes, found in costs.items():
        grown = exponents(found)
        assert grown["peak"] == pytest.approx(1.0, abs=0.02)
        assert grown["rms"] == pytest.approx(1.0, abs=0.02)
        if len(axes) == 1:
            assert max(each.at_line for each in found) < 1e-6
        else:
            assert grown["at_line"] == pytest.approx(2.0, abs=0.02)
            assert all(each.at_line < 0.5 * each.angle**2 for each in found)


@pytest.mark.proof  # five runs; the same orders of a stiff one are held above
def test_an_elastic_article_answers_to_second_order_and_feeds_third_into_the_line() -> None:
    """Clumod about the x axis: twice 4 Hz is nearer to its first mode at 11.5 Hz, so more is left out than of a stiff one."""
    stiff, elastic = (of_a_sine(plan_of("clumod-1", elements=n), ["alpha"], (10.0, 30.0)) for n in (None, 1))
    assert elastic[0].peak > 1.1 * stiff[0].peak
    assert all(each.peak < each.angle for each in elastic)
    assert exponents(elastic)["at_line"] == pytest.approx(2.0, abs=0.05)
    assert stiff[0].at_line < 1e-9 < 1e-5 < elastic[0].at_line < 0.1 * elastic[0].angle ** 2


@pytest.mark.proof  # two whole sweeps; sines are held above
def test_the_spectrum_of_a_whole_sweep_holds_twice_the_frequency(block: Inertia) -> None:
    """Nothing before the sweep has passed twice its start, and from there on half of the angle at half the line, or less.

    The shares are those of a sweep three times as slow: both pass a line and its half alike.
    """
    fast, slow = (of_a_sweep(rigid(block), "alpha", rate=rate) for rate in (30.0, 10.0))
    assert slow[slow[:, 0] < 5.5, 1].max() < 1e-4 < 1e-3 < slow[:, 1].max()
    lines = np.array([10.0, 12.0, 16.0, 24.0])
    shares = [[found[np.abs(found[:, 0] - f) < 0.5, 1].mean() for f in lines] for found in (fast, slow)]
    assert_allclose(shares[0], shares[1], rtol=0.05)
    angles = LEVELS["alpha"] / (np.pi * lines) ** 2
    assert np.all(shares[1] < angles / 2)
    assert_allclose(np.polyfit(np.log(lines), np.log(shares[1]), 1)[0], -2.0, atol=0.4)


@pytest.mark.proof  # the script; what it prints is held above
def test_the_example_prints_shares_that_grow_and_the_limit() -> None:
    printed = io.StringIO()
    STUDY["main"](Console(file=printed, width=160), ["clumod-1:rigid"], [("alpha",), ("x", "gamma")])
    text = printed.getvalue()
    rows = re.findall(r"│ clumod-1:rigid │ ([a-z +]+?) +│ +(\d+) │ +([\d.]+) │ +([\d.]+) │ +(\S+) │ +(\S+) │ +(\S+) │", text)
    assert [row[1] for row in rows] == 2 * ["1", "3", "10", "30"]
    peaks = [float(row[4]) for row in rows]
    assert_allclose(peaks[3] / peaks[0], 30.0, rtol=0.02)
    assert rows[0][6] == "none"  # about one axis
    assert re.search(r"\^1\.0 │ +\^1\.0 │ +\^2\.0 │", text)
    assert re.search(r"In the spectrum of a whole sweep .*: alpha 0\.\d\d% at [\d.]+ Hz, beta .*, gamma ", text)
