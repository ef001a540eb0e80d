"""Inertia of elastic articles from dynamic masses of the finite-element model: an oracle that the identification has never seen.

The oracle has sixty modes and the static share of all others. Its damping is scattered about 0.35 % and coupled within half a
hertz, or - "layered" - that of the article's silicone layer in its viscous form, which couples modes far apart.
"""

from dataclasses import dataclass, replace
from functools import cache

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem import dynamic_mass
from fem.beam import articles
from fem.damping import Damping
from fem.modes import Modes, fixed_base
from geometry.dynamic_mass import DynamicMass
from geometry.inertia import Inertia
from identification.elastic import model
from identification.elastic.fit import Fitted, fit, levels
from identification.elastic.model import ElasticTerms

LINES = np.linspace(4.0, 32.0, 561)


def damping(frequency: np.ndarray, seed: int = 0) -> Damping:
    rng, count = np.random.default_rng(seed), len(frequency)
    d = np.sqrt(4 * np.pi * frequency * 0.0035 * np.exp(0.35 * rng.standard_normal(count)))
    near = np.abs(frequency[:, None] - frequency) < 0.5
    rho = np.triu(rng.uniform(-0.12, 0.12, (count, count)) * near, 1)
    return Damping(modal=np.outer(d, d) * (np.eye(count) + rho + rho.T))


@cache
def modes(article: str, layered: bool = False) -> Modes:
    structure = articles.structure(article)
    own = fixed_base(structure, 60)
    if layered:
        omega = 2 * np.pi * own.frequency
        return fixed_base(structure, 60, damping=Damping(modal=own.structural / np.sqrt(np.outer(omega, omega))))
    return fixed_base(structure, 60, damping=damping(own.frequency))


@cache
def exact(article: str, layered: bool = False) -> DynamicMass:
    return dynamic_mass.modal(modes(article, layered), LINES)


def spoiled(H: DynamicMass, relative: float, noise: float, seed: int = 1) -> DynamicMass:
    """Every entry off by a relative error of its own, so that H is no longer symmetric, and noise in shares of its level."""
    rng = np.random.default_rng(seed)
    gain = 1 + relative * rng.standard_normal((6, 6))
    white = (rng.standard_normal(H.matrix.shape) + 1j * rng.standard_normal(H.matrix.shape)) / np.sqrt(2)
    return replace(H, matrix=H.matrix * gain + noise * levels(H.matrix) * white)


@dataclass(frozen=True)
class Errors:
    mass: float
    cog: float
    moments: float


def errors(found: Fitted, article: str) -> Errors:
    """Mass and moments relative, CoG in m: the largest."""
    true = Inertia.from_mass_matrix(modes(article).rigid_mass)
    got = found.inertia
    return Errors(
        mass=abs(got.mass / true.mass - 1),
        cog=float(np.abs(got.cog - true.cog).max()),
        moments=float(np.abs(got.moments_cog / true.moments_cog - 1).max()),
    )


@cache
def fitted(article: str) -> Fitted:
    """Entries off by 0.1 %, 0.2 % of noise at every line."""
    return fit(spoiled(exact(article), 0.001, 0.002))


@pytest.mark.parametrize("article", ["clumod-1", "clumod-4"])
def test_the_model_is_eq_8b_of_the_finite_elements(article):
    m = modes(article)
    terms = ElasticTerms(frequency=m.frequency, damping=m.viscous, participation=m.participation.T, residual=m.residual)
    H = model.dynamic_mass(m.rigid_mass, terms, LINES)
    assert_allclose(H, exact(article).matrix, rtol=0, atol=1e-10 * np.abs(exact(article).matrix).max())


@pytest.mark.parametrize(("article", "margin"), [("clumod-1", 2.0), pytest.param("clumod-4", 10.0, marks=pytest.mark.proof)])
def test_the_extrapolation_to_zero_is_right_where_the_papers_was_not(article, margin):
    """The bars of elastic set-ups without noise and tolerances: 1e-3, 0.2 mm, 1e-3."""
    off = errors(fit(exact(article, True)), article)
    assert off.mass < 1e-3 / margin
    assert off.cog < 0.2e-3 / margin
    assert off.moments < 1e-3 / margin


@pytest.mark.parametrize("article", ["clumod-1", pytest.param("clumod-4", marks=pytest.mark.proof)])
def test_errors_of_a_careful_laboratory_cost_no_more_than_themselves(article):
    off = errors(fitted(article), article)
    assert off.mass < 3e-3
    assert off.cog < 1e-3
    assert off.moments < 5e-3


@pytest.mark.parametrize("article", ["clumod-1", pytest.param("clumod-4", marks=pytest.mark.proof)])
def test_all_modes_of_the_band_are_found_and_no_other_and_without_elastic_terms_the_misfit_says_so(article):
    """Four of them, of the set-up with four blades, within 0.18 Hz: less than five half-power widths."""
    true, found = modes(article).frequency, fitted(article).terms
    inside = found.frequency < 32
    assert_allclose(found.frequency[inside], true[true < 32], rtol=3e-5)
    assert_allclose(found.damping_ratio[inside], modes(article).damping_ratio[true < 32], rtol=0.02)
    rigid = fit(exact(article), modes=0)
    assert rigid.modes == 0
    assert errors(rigid, article).mass > 0.2
    assert rigid.misfit > 1e3 * fitted(article).misfit


def test_below_all_resonances_the_rigid_way_errs_as_the_paper_did():
    """4 to 8 Hz, one blade: too heavy, mz and moments more so, the higher the lever (Table 2); elastic terms put it right."""
    low = (4.0, 8.0)
    true = Inertia.from_mass_matrix(modes("clumod-1").rigid_mass).parameters
    rigid, elastic = (fit(exact("clumod-1"), band=low, modes=count).parameters for count in (0, 2))
    ratio, left = (found[[0, 3, 4]] / true[[0, 3, 4]] - 1 for found in (rigid, elastic))
    assert np.all(np.diff(ratio) > 0)
    assert ratio[0] > 0.02
    assert np.all(np.abs(left) < ratio / 5)


def test_a_rigid_body_is_found_to_be_rigid():
    body = Inertia.from_mass_matrix(articles.structure("disc+cuboid").rigid_mass)
    flat = DynamicMass(frequency=LINES, matrix=np.broadcast_to(body.mass_matrix, (561, 6, 6)).astype(complex))
    found = fit(spoiled(flat, 0.0, 0.002))
    assert found.modes == 0
    assert "rigid" in found.reason
    within = np.sqrt(np.diag(found.covariance))
    assert np.all(np.abs(found.parameters - body.parameters) < 4 * within)
    assert_allclose(fit(flat).parameters, body.parameters, rtol=1e-9, atol=1e-9)
