"""Frequencies of solid models against closed forms, the user's own STEP, and the convergence study on known answers."""

import runpy
from collections.abc import Callable
from pathlib import Path
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.modes import fixed_base
from fem.solid import model
from fem.structure import Structure
from geometry import user_article
from geometry.article import Article, Box, Material, Part, Shape, upright
from geometry.errors import BadInput

LENGTH, WIDTH, THICKNESS = 0.4, 0.02, 0.005
SOFT = Material(name="no Poisson effect", density=7850.0, youngs_modulus=207e9, poisson_ratio=0.0, loss_factor=0.01)


def shear_and_rotary(depth: float) -> float:
    """Share that shear (k = 5/6, E / G = 2 here) and rotary inertia take off the first frequency, to first order in (depth / L)²:
    half of (r / L)² (1 + E / (k G)) times L² of integral(phi'²) / integral(phi²) = 4.648, which phi'' of a cantilever shares."""
    return 0.5 * 4.648 * (1 + 2 / (5 / 6)) * depth**2 / 12 / LENGTH**2


@pytest.fixture(autouse=True)
def _own_cache(tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
    monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path / "cache"))


def plate(thickness: float = THICKNESS) -> Article:
    """A slender cantilever, upright; without Poisson's effect its clamped end is that of a beam."""
    shape = Shape(solids=(upright(Box(size=np.array([WIDTH, thickness, LENGTH])), bottom=0.0),))
    return Article(name="plate", parts=(Part(name="plate", material=SOFT, shape=shape),))


def euler_bernoulli(thickness: float, count: int) -> np.ndarray:
    """f = (beta L)² / (2 pi L²) sqrt(E I / (rho A)) with cos(bL) cosh(bL) = -1 (Blevins, table 8-1)."""
    roots = np.array([1.87510407, 4.69409113, 7.85475744])[:count]
    return roots**2 / (2 * np.pi * LENGTH**2) * np.sqrt(SOFT.youngs_modulus * thickness**2 / (12 * SOFT.density))


@pytest.fixture(scope="module")
def convergence(root: Path) -> SimpleNamespace:
    """The example that studies it."""
    return SimpleNamespace(**runpy.run_path(str(root / "examples" / "convergence.py")))


@pytest.fixture(scope="module")
def cantilever() -> Callable[[float], Structure]:
    return lambda size: model.structure(plate(), size=size, cached=False)


def test_frequencies_fall_onto_the_beam_as_the_mesh_is_refined(
    cantilever: Callable[[float], Structure], convergence: SimpleNamespace
) -> None:
    """The limits are those of a Timoshenko beam, in the thickness and across the width; meshes that are not nested scatter."""
    study = convergence.convergence_study(cantilever, (0.02, 0.013, 0.0085), 2, bars={"plate": 2e-3})
    assert np.all(np.diff(study.frequency, axis=0) < 0)
    depths = (THICKNESS, WIDTH)
    beam = [euler_bernoulli(depth, 1)[0] * (1 - shear_and_rotary(depth)) for depth in depths]
    assert_allclose(study.extrapolated, beam, rtol=5e-4)
    assert study.part == ("plate", "plate")
    assert study.converged
    assert "converged: all 2 modes" in study.verdict


def test_a_users_own_material_can_be_elastic(tmp_path: Path) -> None:
    from geometry.cad import solid

    solid(plate().parts[0]).exportStep(str(tmp_path / "plate.step"))
    (tmp_path / "article.toml").write_text(
        'format = 1\n[[part]]\nname = "plate"\nfile = "plate.step"\nmaterial = "mine"\n[material.mine]\ndensity = "7850 kg/m^3"\n'
        'youngs_modulus = "207 GPa"\npoisson_ratio = 0.0\nloss_factor = 0.01\n',
        encoding="utf-8",
    )
    structure = model.structure(user_article.load(tmp_path), size=0.015, cached=False)
    assert_allclose(fixed_base(structure, 1).frequency, euler_bernoulli(THICKNESS, 1), rtol=0.005)
    assert structure.loss_factors == {"plate": 0.01}


def test_a_users_surface_mesh_is_refused_with_the_way_out(tmp_path: Path) -> None:
    from geometry.cad import solid

    solid(plate().parts[0]).exportStl(str(tmp_path / "plate.stl"), 0.01, 0.1)
    own = user_article.load(tmp_path / "plate.stl", unit="mm", material="steel")
    with pytest.raises(BadInput, match="Export it from the CAD as STEP"):
        model.structure(own)


@pytest.mark.parametrize("rate", [1.0, 2.0, 4.0])
def test_rate_and_limit_of_a_known_sequence_are_found(rate: float, convergence: SimpleNamespace) -> None:
    size = np.array([3.0, 2.0, 1.2])
    found, limit, distance = convergence.extrapolation(size, 100.0 + 0.3 * size**rate)
    assert_allclose([found, limit, distance], [rate, 100.0, 0.3 * 1.2**rate], rtol=1e-6)


@pytest.mark.parametrize("values", [(101.0, 100.5, 100.7), (100.1, 100.4, 100.9), (100.0, 100.5, 100.5)])
def test_no_rate_is_claimed_where_there_is_none(values: tuple[float, float, float], convergence: SimpleNamespace) -> None:
    size = np.array([4.0, 2.0, 1.0])
    rate, limit, distance = convergence.extrapolation(size, np.array(values))
    assert np.isnan(rate) or rate < 0.5
    assert distance >= abs(values[1] - values[2])
    assert_allclose(abs(limit - values[2]), distance, atol=1e-12)


def test_the_verdict_names_the_worst_mode_by_its_own_bar(convergence: SimpleNamespace) -> None:
    size = np.array([4.0, 2.0, 1.0])
    frequency = np.column_stack([10.0 + 0.012 * size, 50.0 + 0.08 * size])
    study = convergence.assessed(size, (1, 2, 3), frequency, ("blade", "mast"), {"blade": convergence.BLADE_BAR})
    assert_allclose(study.distance, [1.2e-3, 1.6e-3], rtol=1e-9)
    assert not study.converged
    assert "1 of 2 modes" in study.verdict
    assert "mode 2" in study.verdict
    assert "mast" in study.verdict


@pytest.mark.parametrize("sizes", [(2.0, 1.0), (1.0, 2.0, 3.0), (2.0, 1.0, 0.0)])
def test_a_study_needs_three_falling_sizes(sizes: tuple[float, ...], convergence: SimpleNamespace) -> None:
    with pytest.raises(BadInput, match="three or more"):
        convergence.convergence_study(lambda size: pytest.fail("called"), sizes)
