"""Real data: four bicycles measured by others come out as they published them."""

import runpy
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from validation.classical.pendulum import tensor_from_axes

BICYCLES = ["Browser", "Fisher", "Pista", "Yellow"]


@pytest.fixture(scope="module")
def example(root) -> SimpleNamespace:
    return SimpleNamespace(**runpy.run_path(str(root / "examples" / "bicycles.py")))


@pytest.mark.parametrize("bicycle", BICYCLES)
def test_every_published_quantity_and_its_uncertainty_come_out(bicycle, example, data):
    rows = example.comparison(data / "bicycle_pendulum", bicycle)
    assert {"IBxx", "IBxz", "IByy", "IBzz", "IHxx", "IHxz", "IHyy", "IHzz", "IFxx", "IFyy", "IRxx", "IRyy", "xB", "zH"} <= {
        r[0] for r in rows
    }
    for name, ours, theirs in rows:
        # both sides are printed with twelve digits; 1e-10 leaves room for a few of the last
        assert_allclose([ours.n, ours.s], [theirs.n, theirs.s], rtol=1e-10, err_msg=name)


def test_the_published_cog_is_the_mean_of_intersections_and_three_axes_see_the_planar_tensor_where_two_do_not(example, data):
    m = example.read(data / "bicycle_pendulum" / "BrowserMeasured.txt")
    betas = np.radians([90 - m["gamma"].n - m[f"alphaB{i}"].n for i in "123"])
    normals = np.column_stack([np.sin(betas), np.cos(betas)])
    offsets = -np.array([m[f"aB{i}"].n for i in "123"])
    corners = np.array(example.meeting_point(normals, list(offsets)))
    fitted = np.linalg.lstsq(normals, offsets, rcond=None)[0]
    assert 1e-3 < np.linalg.norm(corners - fitted) < 5e-3
    angles = np.radians([0, 40, 100])
    axes = np.column_stack([np.cos(angles), 0 * angles, -np.sin(angles)])
    assert set(tensor_from_axes(axes, [1.0, 1.1, 1.2], example.PLANAR)) == set(example.PLANAR)
    with pytest.raises(BadInput, match="2 axes do not determine"):
        tensor_from_axes(axes[:2], [1.0, 1.1], example.PLANAR)


def test_the_example_prints_a_table_a_bicycle(example, data):
    from click.testing import CliRunner

    result = CliRunner().invoke(example.main, ["--data", str(data)])
    assert result.exit_code == 0
    assert all(f"{bicycle}: computed beside published" in result.output for bicycle in BICYCLES)


def test_plumb_lines_through_one_point_meet_there(example):
    angles = np.array([0.1, 1.2, 2.0])
    normals = np.column_stack([np.cos(angles), np.sin(angles)])
    point = np.array([0.27, -0.54])
    assert_allclose(example.meeting_point(normals, list(normals @ point)), point, atol=1e-14)


@pytest.mark.parametrize("normals", [[(1.0, 0.0)], [(1.0, 0.0), (1.0, 1e-4)]])
def test_lines_that_do_not_cross_are_refused(normals, example):
    with pytest.raises(BadInput, match="plumb lines"):
        example.meeting_point(normals, [0.1] * len(normals))
