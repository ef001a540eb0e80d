"""Maps of a laboratory made by hand: what is hidden in it is named by the worst spot, and nothing hidden leaves nothing."""

from dataclasses import replace
from types import SimpleNamespace

import numpy as np
import pytest
from numpy.testing import assert_allclose

from identification.base_motion import base_motion, resultants
from identification.dynamic_mass import from_runs
from identification.spectra.line_spectra import Spectra
from validation.compare.compare import GAP, FrequencyTrend, text, worst
from validation.compare.correlation import NamedMode
from validation.compare.maps import chunks, combined, doubt, judged_error, left_over, mapped, with_noise
from validation.estimation.evaluate import squares
from validation.estimation.fit import FLOOR, fit
from validation.estimation.likelihood import left_of_run, observed
from validation.estimation.problem import PLAIN, Problem
from validation.estimation.verdicts import STANDS_OUT
from validation.report.compare import ComparisonPage


def spots(by_hand, test):
    return worst([by_hand.mapped(test)], [[by_hand.MODE]])


@pytest.mark.parametrize("seed", range(4))
def test_where_nothing_is_hidden_nothing_stands_out(by_hand, seed):
    found = spots(by_hand, by_hand.test(by_hand.drawn(seed), seed=seed))
    assert found[0].sigma < STANDS_OUT


HIDDEN = {
    "force-gain:fmd-z2": (0.08, "fmd-z2", "the same share at all frequencies"),
    "force-delay:fmd-y14": (4e-4, "fmd-y14", "a share that grows with frequency, as of a delay"),
    "accelerometer-gain:cover-x1": (0.05, "cover-x1", "the same share at all frequencies"),
    "accelerometer-position:cover-z3:x": (0.012, "cover-z3", "the same share at all frequencies"),
}


@pytest.mark.parametrize("name", HIDDEN)
def test_the_worst_spot_names_the_channel_in_which_an_effect_is_hidden(by_hand, name):
    size, channel, course = HIDDEN[name]
    found = spots(by_hand, by_hand.test({**by_hand.drawn(1), name: size}, seed=1))
    assert found[0].row == channel
    assert found[0].sigma > 2 * STANDS_OUT
    assert course in text(found[0])
    assert [one.row for one in found].count(channel) == 1  # one spot, however many lines and runs it covers


def test_a_resonance_elsewhere_is_a_moment_that_follows_its_mode_and_without_tolerances_deviations_are_residuals(by_hand):
    found = spots(by_hand, by_hand.test(by_hand.drawn(1), own=12.2, seed=1))
    assert found[0].row == "t_y"
    assert found[0].run == "beta"
    assert found[0].course == "follows the first mast mode"
    assert 11.5 < found[0].band[0] <= found[0].frequency <= found[0].band[1] < 12.7
    bare = by_hand.without_tolerances(by_hand.test({"force-gain:fmd-z2": 0.02}, seed=2))
    of = mapped(bare, {}, by_hand.nothing_fitted(Problem((bare,))), by_hand.RIG)
    seen, rows = observed(bare.measured, np.arange(len(of.frequency))), bare.at({}).rows
    weight = seen.weight(FLOOR)
    for run, own in enumerate(weight):
        left = left_of_run(seen, rows if rows.ndim == 3 else rows[run], own, run)
        sigma = np.sqrt((np.abs(left.gain) ** 2 @ (seen.parts / np.square(own))[..., None])[..., 0])
        deviation, expected = (each[run, :, : of.channels] for each in (of.deviation, of.expected))
        assert_allclose(deviation, left.values, rtol=1e-7, atol=1e-9 * np.abs(left.values).max())
        assert_allclose(expected, sigma, rtol=1e-7)


def test_the_error_of_a_force_is_in_the_load_that_its_cell_carries(by_hand):
    """Two per cent too much on one of the vertical cells: the vertical force has all of it."""
    of = by_hand.mapped(by_hand.test({"force-gain:fmd-z2": 0.02}, seed=None))
    z, cell = of.runs.index("z"), of.rows.index("fmd-z2")
    assert_allclose(of.deviation[z, :, of.rows.index("f_z")], 0.02 * of.reading[z, :, cell], rtol=1e-6)


def test_the_measured_dynamic_mass_is_that_of_identification(by_hand):
    test = by_hand.test(by_hand.drawn(3), seed=3)
    of, measured = by_hand.mapped(test), test.measured
    order = [measured.channels.index(name) for name in by_hand.RIG.table.names]
    spectra = Spectra(
        table=by_hand.RIG.table,
        frequency=measured.frequency,
        values=measured.values[:, :, order],
        noise=measured.noise[:, :, order],
        quality=np.ones(measured.values.shape[:2]),
        runs=measured.runs,
        axes=measured.axes,
    )
    H = from_runs(resultants(spectra).values, base_motion(spectra).values, measured.frequency).dynamic_mass.matrix
    assert_allclose(of.pairs.measured, H, rtol=1e-9, atol=1e-9 * np.abs(H).max())
    assert_allclose(of.pairs.predicted, by_hand.dynamic_mass(measured.frequency), rtol=1e-6, atol=1e-6)


def test_pairs_scatter_over_laboratories_as_they_are_expected_to(by_hand):
    """Eight laboratories with some fifty tolerances that matter tell the mean square to about a seventh."""
    ratios = [by_hand.mapped(by_hand.test(by_hand.drawn(k), seed=k)).pairs.sigma for k in range(20, 28)]
    assert_allclose(np.mean(np.square(ratios)), 1.0, atol=0.3)


@pytest.mark.parametrize("name", ["force-gain:fmd-z2", "accelerometer-gain:cover-x1", "force-crosstalk:zx"])
def test_a_single_tolerance_makes_the_plain_error_that_it_explains(by_hand, name):
    """No noise, one tolerance off by a tenth of itself: on every line expected and found are one figure, to its second order."""
    (tolerance,) = (one.tolerance for one in by_hand.test(seed=None).parameters if one.name == name)
    test = by_hand.test({name: 0.1 * tolerance}, seed=None)
    test = replace(test, measured=replace(test.measured, noise=1e-6 * test.measured.noise))
    problem = Problem((test,))
    alone = replace(by_hand.nothing_fitted(problem), tolerances={name: 0.1 * tolerance}, answer=np.zeros((0, 1)))
    of = mapped(test, {}, alone, by_hand.RIG)
    found = np.sqrt(np.stack([one.values.sum(axis=1) for one in squares(test, {})]))
    assert_allclose(of.explained, found, rtol=5e-3, atol=1e-6 * found.max())
    assert_allclose(of.explained_with_modes, of.explained, rtol=1e-12)
    of_a_mode = mapped(test, {}, replace(alone, of_modes=frozenset({name})), by_hand.RIG)
    assert not of_a_mode.explained.any()
    assert_allclose(of_a_mode.explained_with_modes, of.explained, rtol=1e-12)


@pytest.mark.proof  # many laboratories
def test_over_laboratories_the_plain_error_is_what_tolerances_explain_however_loud_the_noise(by_hand):
    """Twelve of them tell the mean square to about a fifth.

    Of one blade in simulated null series (with the Cuboid, eight octaves a minute, seeds 1, 2, 3) the plain error is 0.88, 0.87
    and 0.63 times what tolerances of the measurement explain. Those of the modes, which no virtual test draws, are not in it.
    """
    ratios = []
    for seed in range(20, 32):
        test = by_hand.test(by_hand.drawn(seed), seed=seed, louder=30.0)
        problem = Problem((test,))
        of = mapped(test, {}, by_hand.nothing_fitted(problem))
        plain = np.mean([one.values.sum(axis=1).mean() for one in squares(test, {})])
        ratios.append(plain / np.mean(of.explained**2))
    assert_allclose(np.mean(ratios), 1.0, atol=0.5)


def test_what_a_plain_fit_makes_of_a_tolerance_is_in_what_is_expected_of_its_residuals(by_hand):
    """A gain off by a third of its tolerance, no noise: the fitted mass answers, and to first order what is left is known."""
    name, size = "force-gain:fmd-z2", 0.001
    test = by_hand.fitting_mass(by_hand.test({name: size}, seed=None))
    problem = Problem((test,))
    plain = fit(problem, PLAIN)
    assert abs(plain.by_name["mass"]) > 1e-3
    answered = doubt(problem, plain)
    apart = replace(answered, of_modes=frozenset({name}))  # a column of its own, with what the fit made of it
    for part in chunks(test, plain.by_name, apart):
        S = with_noise(sum(part.spread.covariances), part.noise)
        judged = test.measured.judged
        error, _ = judged_error(test.measured.values[:, part.lines], part.rows, S, None, judged)
        predicted = part.spread.by_modes[..., 0, :] * size / answered.tolerances[name]
        expected, _ = judged_error(predicted, part.rows, S, None, judged)
        assert_allclose(error, expected, atol=0.01 * np.abs(error).max())  # second order: the gain's own size


def test_the_covariance_is_that_of_all_columns_written_out_modes_among_them_or_not(by_hand):
    """Of every tolerance by itself, and of what the fit does not know, whichever go through one channel."""
    test = by_hand.fitting_mass(by_hand.test(by_hand.drawn(3), seed=3))
    problem = Problem((test,))
    plain = fit(problem, PLAIN)
    answered = doubt(problem, plain)
    (of, *_) = chunks(test, plain.by_name, replace(answered, of_modes=frozenset(answered.tolerances)))
    V = of.spread.by_modes
    of_fit = np.einsum("rnpc,pq->rnqc", of.spread.by_fit, answered.own)
    whole = np.einsum("rnkc,rnkd->rncd", V, V.conj()) + np.einsum("rnkc,rnkd->rncd", of_fit, of_fit.conj())
    for modes in ((), tuple(answered.tolerances)[::3]):
        (part, *_) = chunks(test, plain.by_name, replace(answered, of_modes=frozenset(modes)))
        assert_allclose(sum(part.spread.covariances), whole, rtol=1e-9, atol=1e-12 * np.abs(whole).max())
        W = np.random.default_rng(4).standard_normal((len(part.lines), 2, whole.shape[-1])) + 0j
        inverse = np.random.default_rng(5).standard_normal((len(part.lines), len(V), 3)) + 0j
        every = np.concatenate([V, of_fit], axis=2)
        expected = np.square(np.abs(np.einsum("nic,rnkc,nrj->nijk", W, every, inverse))).sum(axis=-1)
        assert_allclose(part.spread.through(W, inverse), expected, rtol=1e-9)


LINES, CHANNELS, INPUTS, TOLERANCES = 3, 7, 2, 4


def _made(seed: int) -> tuple[np.ndarray, ...]:
    rng = np.random.default_rng(seed)

    def some(*shape: int) -> np.ndarray:
        return rng.standard_normal(shape) + 1j * rng.standard_normal(shape)

    A, V = some(LINES, CHANNELS, INPUTS), 0.3 * some(LINES, CHANNELS, TOLERANCES)
    return some(LINES, CHANNELS), A, with_noise(V @ V.conj().swapaxes(1, 2), rng.uniform(0.1, 0.4, (LINES, CHANNELS)))


def test_a_channel_is_predicted_from_all_others_as_a_fit_without_it_predicts_it():
    y, A, S = _made(1)
    found, _ = left_over(y, A, S, None)
    for n, c in np.ndindex(LINES, CHANNELS):
        o = np.delete(np.arange(CHANNELS), c)
        inverse = np.linalg.inv(S[n][np.ix_(o, o)])
        u = np.linalg.solve(A[n, o].conj().T @ inverse @ A[n, o], A[n, o].conj().T @ inverse @ y[n, o])
        # the best unbiased prediction of a correlated reading (Goldberger, JASA 57, 1962)
        said = A[n, c] @ u + S[n, c, o] @ inverse @ (y[n, o] - A[n, o] @ u)
        assert_allclose(found.value[n, c], y[n, c] - said, rtol=1e-9)


def test_known_inputs_leave_a_channel_to_its_correlation_with_the_others():
    y, A, S = _made(2)
    u = np.ones((LINES, INPUTS), dtype=complex)
    found, chi2 = left_over(y, A, S, u)
    e = y - (A @ u[..., None])[..., 0]
    P = np.linalg.inv(S)
    assert_allclose(found.value, np.einsum("nij,nj->ni", P, e) / np.diagonal(P, axis1=1, axis2=2), rtol=1e-9)
    assert_allclose(chi2, np.einsum("ni,nij,nj->n", e.conj(), P, e).real, rtol=1e-9)


def test_errors_scatter_as_they_are_expected_to():
    """Draws of noise and tolerances; 4000 of them tell a standard deviation to about 1 %."""
    rng, count = np.random.default_rng(3), 4000
    _, A, S = _made(4)
    L = np.linalg.cholesky(S[0])
    drawn = (rng.standard_normal((count, CHANNELS)) + 1j * rng.standard_normal((count, CHANNELS))) / np.sqrt(2) @ L.T
    found, chi2 = left_over(drawn, np.broadcast_to(A[0], (count, CHANNELS, INPUTS)), np.broadcast_to(S[0], (count, 7, 7)), None)
    ratio = np.sqrt(np.mean(np.abs(found.value) ** 2, axis=0)) / found.expected[0]
    assert_allclose(ratio, 1.0, atol=0.05)
    assert_allclose(chi2.mean(), CHANNELS - INPUTS, rtol=0.05)


def test_an_error_of_loads_is_free_of_the_inputs_and_scatters_as_expected():
    rng, count = np.random.default_rng(5), 4000
    _, A, S = _made(6)
    judged, R = np.array([False] * 4 + [True] * 3), np.array([[1.0, 1.0, 0.0], [0.0, 1.0, -1.0]])
    L = np.linalg.cholesky(S[0])
    drawn = (rng.standard_normal((count, CHANNELS)) + 1j * rng.standard_normal((count, CHANNELS))) / np.sqrt(2) @ L.T
    drawn = drawn + A[0] @ np.array([3.0, -2.0j])
    error, spread = judged_error(drawn, np.broadcast_to(A[0], (count, 7, 2)), np.broadcast_to(S[0], (count, 7, 7)), None, judged)
    found = combined(error, spread, R)
    assert_allclose(np.sqrt(np.mean(np.abs(found.value) ** 2, axis=0)) / found.expected[0], 1.0, atol=0.05)


def test_a_channel_that_nothing_checks_deviates_by_nothing_and_is_never_surprising():
    y = np.array([[1.0, 2.0, 5.0 + 0j]])
    A = np.array([[[1, 0], [1, 0], [0, 1.0 + 0j]]])
    found, _ = left_over(y, A, np.eye(3, dtype=complex)[None], None)
    assert found.expected[0, 2] == np.inf
    assert found.value[0, 2] == 0
    assert_allclose(np.abs(found.value[0, :2]), 1.0, rtol=1e-12)


def test_a_mode_between_lines_that_lie_far_apart_is_followed_by_nothing():
    lines = np.linspace(12.0, 2400.0, 100)
    trend = FrequencyTrend(
        frequency=lines,
        deviation=np.exp(1j * lines),
        expected=np.ones(100),
        reading=np.ones(100, dtype=complex),
        motion=np.ones(100, dtype=complex),
        of_load=False,
    )
    rigid = NamedMode(name="bounce", frequency=22.0, damping_ratio=0.1)
    assert not np.any(np.abs(lines - 22.0) < 2.2)
    assert trend.follows([rigid], (20.0, 40.0), 36.0) == ""


def test_neighbouring_lines_are_one_spot_however_far_apart(by_hand):
    """Ten neighbouring lines of one channel are off, each by a phase of its own, so that no course over frequency joins them."""
    of = by_hand.mapped(by_hand.test(by_hand.drawn(1), seed=1))
    deviation = np.zeros_like(of.deviation)
    row, lines = of.rows.index("fmd-y14"), slice(30, 40)
    phases = np.exp(2j * np.pi * np.random.default_rng(0).random(10))
    deviation[1, lines, row] = 20 * phases * of.expected[1, lines, row]
    sparse = replace(of, frequency=20 * of.frequency, deviation=deviation)
    assert np.diff(sparse.frequency).min() > GAP
    (found,) = worst([sparse], [[]])
    assert found.row == "fmd-y14"
    assert found.band == (sparse.frequency[30], sparse.frequency[39])


@pytest.mark.parametrize(
    ("worst", "words"), [(2.9, "chance reaches about 3."), (3.5, "chance reaches about 3.3 among 29238 cells.")]
)
def test_chance_reaches_farther_among_many_cells_and_the_page_says_so(worst, words):
    """A sound test of 29,000 cells told 3.5 sigma beside "about 3"."""
    noise = np.random.default_rng(3).standard_normal((100, 29238, 2)) / np.sqrt(2)
    assert np.linalg.norm(noise, axis=-1).max(axis=1).mean() == pytest.approx(3.3, abs=0.05)
    maps = (SimpleNamespace(deviation=np.zeros((2, 4873, 3))),)
    held = SimpleNamespace(held_out_names=())
    found = SimpleNamespace(
        worst=(SimpleNamespace(sigma=worst),), maps=maps, modes=((),), evaluation=held, effects=(), remarks=()
    )
    maps[0].frequency = np.array([1.0, 2.0])
    assert next(ComparisonPage(found=found).notes()).endswith(words)
