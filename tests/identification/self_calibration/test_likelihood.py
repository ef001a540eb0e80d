"""The likelihood of one campaign: base motions eliminated, gradient exact, whatever the parameter."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.self_calibration import fit
from identification.self_calibration.likelihood import observed, residual
from identification.self_calibration.problem import assembled, normals
from identification.self_calibration.solve import SILENT, level_of_groups, total


@pytest.fixture(scope="module")
def problem(ordinary, lab):
    """Tare and elastic article, away from the minimum, few lines."""
    few = replace(ordinary, frequency=np.arange(4.0, 32.01, 0.5))
    made = assembled(few.evidence(terms=lab.MODES), few.settings())
    return replace(made, campaigns=tuple(replace(one, lines=one.lines[::4]) for one in made.campaigns))


@pytest.fixture(scope="module")
def away(problem):
    rng = np.random.default_rng(4)
    x = problem.layout.start.copy()
    chain = problem.layout.at("chain:0")
    x[chain] = 0.3 * rng.standard_normal(chain.stop - chain.start) * problem.campaigns[0].chain.tolerances
    return x


def test_no_base_motion_changes_the_residual(problem, away):
    part = problem.parts(0.0015)[0]
    rows = part.rows(problem.layout, away, changes=False)
    A = rows.a0 + rows.a1 @ rows.dynamic_mass
    rng = np.random.default_rng(0)
    more = rng.standard_normal((*part.observed.values.shape[:2], 6)) + 1j
    moved = replace(part.observed, values=part.observed.values + (A @ more[..., None])[..., 0])
    assert_allclose(residual(moved, rows), residual(part.observed, rows), atol=1e-9 * np.abs(part.observed.weight).max())


def cost(parts, layout, x):
    return sum(0.5 * np.sum(np.abs(residual(one.observed, one.rows(layout, x, changes=False))) ** 2) for one in parts)


def test_the_gradient_is_that_of_the_cost_for_every_kind_of_parameter(problem, away):
    parts = problem.parts(0.0015)
    found = total(normals(parts, problem.layout, away), len(away))
    scale = 1 / np.sqrt(np.diag(found.matrix))
    kinds = {}
    for k, owner in enumerate(problem.layout.owners):
        name = problem.layout.block(owner).names[k - problem.layout.at(owner).start]
        kinds.setdefault((owner, name.partition(":")[0].partition("[")[0]), k)
    assert len(kinds) > 25
    for what, k in kinds.items():
        step = 0.01 * scale[k] * np.eye(len(away))[k]
        up, down = (cost(parts, problem.layout, away + sign * step) for sign in (1, -1))
        slope = (up - down) / (2 * step[k])
        assert_allclose(
            found.gradient[k] * scale[k], slope * scale[k], atol=2e-3 * (1 + abs(slope * scale[k])), err_msg=str(what)
        )


def test_gradients_by_line_add_up_to_the_gradient(problem, away):
    parts = problem.parts(0.0015)
    whole = total(normals(parts, problem.layout, away), len(away)).gradient
    blocks = fit.bootstrap_scores(parts, problem.layout, away)
    added = np.sum([one.sum(axis=0) for one in blocks], axis=0)
    assert_allclose(added, whole, atol=1e-9 * np.abs(whole).max())


def test_a_channel_that_reads_nothing_is_not_trusted_without_bound(exact, lab):
    """Spectra of noise zero: the weight of a silent channel is that of a floor on a share of what its kind reads."""
    read, floor = exact.spectra(lab.NOTHING), 0.0015
    values = read.values.copy()
    silent = [read.table.names.index(name) for name in ("cover-x1", "fmd-z1")]
    values[0, :, silent] = 0.0
    some = replace(read, values=values)
    weight = observed(some, range(len(read.table)), np.arange(len(read.frequency)), floor).weight
    kind = level_of_groups(some.values, np.array([one.quantity for one in some.table.channels]))
    assert_allclose(weight[0][:, silent] * floor * SILENT * kind[silent], np.sqrt(2), rtol=1e-12)
    assert np.all(weight[0][:, silent] < 1e3 * np.median(weight, axis=(0, 1))[silent])


@pytest.mark.parametrize(("repeated", "wider"), [(1, 1.0), (4, 2.0)])
def test_the_block_bootstrap_sees_residuals_that_repeat(repeated, wider):
    """A residual that stands at `repeated` lines in a row tells so much less: sqrt of that wider intervals."""
    rng = np.random.default_rng(5)
    lines = 800
    residuals = np.repeat(rng.standard_normal(lines // repeated), repeated)
    scores = -residuals.reshape(-1, 4).sum(axis=1)[:, None]  # a mean of lines, in blocks of four
    C = np.array([[1 / lines]])
    sd = fit.blocks(C, [scores], np.zeros((0, 1)), np.random.default_rng(8)).std()
    assert_allclose(sd / np.sqrt(C[0, 0]), wider, rtol=0.2)  # 200 blocks tell a deviation to 5 %


def test_the_block_bootstrap_agrees_with_the_covariance_where_lines_are_independent(ordinary):
    from identification.self_calibration.fit import calibrated

    found = calibrated(ordinary.evidence(), replace(ordinary.settings(modes=0), floor=1e-5))
    ratio = np.sqrt(np.diag(found.resampled) / np.diag(found.covariance))
    assert np.all((ratio > 0.75) & (ratio < 1.25))
