"""Eqs. 1 and 4 turned round: what went into the loads comes out, and what no data can tell is named."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.dynamic_mass import LEVELS, MOTIONS, DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.inertia import Inertia, Kind, judge
from geometry.routes import from_log_cholesky
from identification.base_motion import RunNoise, against_apparent, tilt
from identification.elastic import model
from identification.elastic.model import ElasticTerms
from identification.rigid_body import Unidentifiable, fit, from_spectra, nearest_body

LINES = np.linspace(4.0, 32.0, 15)
LEVEL = np.array(list(LEVELS.values()))
AT = np.array([0.01, -0.02, 0.005])
BODY = Inertia.from_cog(mass=41.0, cog=[0.012, -0.008, 0.1], tensor=np.diag([0.9, 0.95, 0.75]), reference_point=AT)
MASS = DynamicMass(frequency=LINES, matrix=np.tile(BODY.mass_matrix, (len(LINES), 1, 1)), reference_point=AT)
TERMS = ElasticTerms(frequency=np.array([12.0]), damping=np.array([[0.5]]), participation=np.array([[2.0, 0, 0, 0, 1.0, 0]]))


def _complex(rng: np.random.Generator, *shape: int) -> np.ndarray:
    return (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)) / np.sqrt(2)


def _motion(count: int, cross: float = 0.03, seed: int = 3) -> np.ndarray:
    driven = np.eye(6)[np.arange(count) % 6][:, None, :]
    return (driven + cross * _complex(np.random.default_rng(seed), count, len(LINES), 6)) * LEVEL


def _loads(U: np.ndarray, H: np.ndarray = MASS.matrix) -> np.ndarray:
    return np.einsum("njk,rnk->rnj", H, U)


@pytest.mark.parametrize("robust", ["", "huber", "tukey"])
def test_exact_data_give_back_the_ten_parameters_to_rounding(robust: str) -> None:
    U = _motion(6)
    for found in (fit(MASS, robust=robust), from_spectra(U, _loads(U), LINES, AT, robust=robust)):
        assert_allclose(found.inertia.parameters, BODY.parameters, rtol=0, atol=1e-12 * BODY.mass)
        assert_allclose(found.inertia.cog, BODY.cog, rtol=0, atol=1e-12)  # its reference point is carried along


def test_elastic_terms_are_taken_off_before_both_fits() -> None:
    H = model.dynamic_mass(BODY.mass_matrix, TERMS, LINES)
    U = _motion(6)
    mass = DynamicMass(frequency=LINES, matrix=H, reference_point=AT)
    for found in (fit(mass, elastic=TERMS), from_spectra(U, _loads(U, H), LINES, AT, elastic=TERMS)):
        assert_allclose(found.inertia.parameters, BODY.parameters, rtol=0, atol=1e-11 * BODY.mass)
    assert abs(fit(mass).inertia.parameters[5] / BODY.parameters[5] - 1) > 0.1


def _independent(load: np.ndarray, motion: np.ndarray) -> RunNoise:
    """Noise of these standard deviations (r, n, 6), all components independent."""
    return RunNoise(load=load[..., None] ** 2 * np.eye(6), motion=motion[..., None] ** 2 * np.eye(6))


def _noisy(count: int, share: float, seed: int) -> tuple[np.ndarray, np.ndarray, RunNoise]:
    """Motions and loads with noise of `share` of their levels on both sides, and what that noise is."""
    rng, U = np.random.default_rng(seed), _motion(count)
    F = _loads(U)
    size = np.sqrt(np.mean(np.abs(F) ** 2, axis=(0, 1)))
    u, f = np.broadcast_to(share * LEVEL, U.shape), np.broadcast_to(share * size, F.shape)
    return U + u * _complex(rng, *U.shape), F + f * _complex(rng, *F.shape), _independent(f, u)


def test_noise_of_motions_makes_least_squares_too_low_and_errors_in_variables_not() -> None:
    """A motion at its level in one run of six, noise of 20 % in all: 0.04 is 19 % of the power 1/6 + 0.04 (no cross motion)."""
    U, F, noise = _noisy(60, 0.2, seed=5)
    plain, corrected = from_spectra(U, F, LINES, AT), from_spectra(U, F, LINES, AT, noise=noise)
    assert_allclose(plain.inertia.mass / BODY.mass, 1 - 0.19, atol=0.03)
    sigma = np.sqrt(np.diag(corrected.covariance))
    assert np.all(np.abs(corrected.inertia.parameters - BODY.parameters) < 4 * sigma)  # ten normal numbers: 1 in 1,600 by chance
    assert sigma[0] < 0.01 * BODY.mass
    assert_allclose(corrected.misfit, 1, atol=0.05)  # 5,400 complex numbers: standard deviation 0.014


def test_the_covariance_is_the_scatter_over_many_tests() -> None:
    found = [from_spectra(*_noisy(6, 0.02, seed)[:2], LINES, AT, noise=_noisy(6, 0.02, seed)[2]) for seed in range(60)]
    sigma = np.sqrt(np.diag(found[0].covariance))
    z = (np.array([one.inertia.parameters for one in found]) - BODY.parameters) / sigma
    assert_allclose(np.sqrt(np.mean(z**2)), 1, atol=0.12)  # 600 numbers, standard deviation 0.03, and the bias of second order


def test_entries_of_the_dynamic_mass_weigh_by_their_noise() -> None:
    """Half of the lines are a hundred times noisier: with weights the answer is that of the quiet half, and chi² is 1."""
    rng = np.random.default_rng(8)
    sd = 0.01 * np.ones(MASS.matrix.shape)
    sd[::2] *= 100
    noisy = DynamicMass(frequency=LINES, matrix=MASS.matrix + sd * _complex(rng, *sd.shape), reference_point=AT)
    weighed = fit(noisy, weights=1 / sd)
    assert_allclose(weighed.misfit, 1, atol=0.15)  # 540 complex numbers: standard deviation 0.043
    full = np.eye(36) * np.square(sd).reshape(-1, 36, 1)
    same = fit(noisy, covariance=full)
    assert_allclose(same.inertia.parameters, weighed.inertia.parameters, rtol=1e-9)  # the same equations, whitened another way
    assert_allclose(same.covariance, weighed.covariance, rtol=1e-9, atol=1e-18)
    z = (weighed.inertia.parameters - BODY.parameters) / np.sqrt(np.diag(weighed.covariance))
    assert np.abs(z).max() < 4


@pytest.mark.parametrize(("robust", "left"), [("huber", 0.1), ("tukey", 0.01)])
def test_lines_that_went_wrong_lose_their_say(robust: str, left: float) -> None:
    """A tenth of the runs and lines off by as much as the load itself; Huber keeps a little of it, Tukey nothing."""
    rng, U = np.random.default_rng(2), _motion(12)
    F = _loads(U) * (1 + 1e-4 * _complex(rng, *U.shape))
    wrong = rng.random(F.shape[:2]) < 0.1
    F[wrong] *= 2
    off = [np.abs(from_spectra(U, F, LINES, AT, robust=way).inertia.mass - BODY.mass) for way in ("", robust)]
    assert off[1] < left * off[0]
    weight = from_spectra(U, F, LINES, AT, robust=robust).weight
    assert weight.shape == F.shape[:2]
    assert weight[wrong].max() < 0.1 < np.median(weight[~wrong])


def test_parameters_that_no_body_has_go_to_the_nearest_body_that_has_them() -> None:
    """A flat plate measured a little too flat. Its nearest body lies on the boundary, where nothing nearer is inside."""
    true = np.array([2.0, 0, 0, 0, 0.1, 0.1, 0.2, 0, 0, 0])
    measured = Inertia(parameters=true + np.array([0, 0, 0, 0, -0.004, 0.002, 0.004, 0.001, 0, 0]))
    C = np.diag([1e-4, 1e-6, 1e-6, 1e-6, *6 * [1e-5]])
    found = nearest_body(measured, C)
    assert judge(measured).kind is Kind.UNPHYSICAL
    assert judge(found).physical
    whiten = np.linalg.inv(np.linalg.cholesky(C))
    away = np.linalg.norm(whiten @ (found.parameters - measured.parameters))
    # The violation is Izz - Ixx - Iyy = 0.006 over three equal variances: the distance to that plane is 0.006 / sqrt(3e-5).
    assert_allclose(away, 0.006 / np.sqrt(3e-5), rtol=0.05)  # the cone bends away from its plane a little, by Ixy
    rng = np.random.default_rng(0)
    for _ in range(200):
        other = from_log_cholesky(np.array([0.35, -1.8, -1.8, -6, 0, 0, 0, 0, 0, 0]) + 0.3 * rng.standard_normal(10))
        assert np.linalg.norm(whiten @ (other.parameters - measured.parameters)) > away


def test_a_consistent_fit_leaves_a_body_alone_and_says_how_far_another_was_moved() -> None:
    assert_allclose(fit(MASS, consistent=True).inertia.parameters, BODY.parameters, rtol=0, atol=1e-11)
    flat = Inertia(parameters=np.array([2.0, 0, 0, 0, 0.096, 0.102, 0.204, 0.001, 0, 0]))
    rng = np.random.default_rng(4)
    H = flat.mass_matrix + 0.01 * _complex(rng, len(LINES), 6, 6)
    found = fit(DynamicMass(frequency=LINES, matrix=H), consistent=True)
    assert judge(found.inertia).physical
    assert "standard deviations of noise away" in found.text


def test_no_body_is_near_a_negative_mass() -> None:
    with pytest.raises(CheckFailed, match="negative mass, found -1 kg"):
        nearest_body(-Inertia.from_cog(1.0, np.zeros(3), np.eye(3)), np.eye(10))


@pytest.mark.parametrize(
    ("axes", "open_"),
    [
        ("x", ("mx", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")),
        ("xyz", ("Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")),
        (("alpha",), ("m", "mx", "Iyy", "Izz", "Iyz")),
        (("x", "y", "z", "alpha"), ("Iyy", "Izz", "Iyz")),
        (("alpha", "beta", "gamma"), ("m",)),
    ],
)
def test_runs_that_do_not_move_a_parameter_name_it(axes: tuple[str, ...], open_: tuple[str, ...]) -> None:
    U = np.zeros((len(axes), len(LINES), 6), dtype=complex)
    for run, axis in enumerate(axes):
        U[run, :, MOTIONS.index(axis)] = LEVEL[MOTIONS.index(axis)]
    with pytest.raises(Unidentifiable, match=f"leave {', '.join(open_)} open") as caught:
        from_spectra(U, _loads(U), LINES, AT)
    assert caught.value.undetermined == open_
    assert len(caught.value.singular_values) == 10
    assert_allclose(np.linalg.norm(caught.value.null_direction), 1, rtol=1e-12)


def test_motions_that_always_go_together_leave_a_combination_open_and_say_which() -> None:
    """A base that only turns about a point 0.5 m above: a point mass there does nothing, and is what the data say nothing of."""
    U = np.zeros((3, len(LINES), 6), dtype=complex)
    for run, turn in enumerate(np.eye(3)):
        U[run] = np.concatenate([-np.cross(turn, [0, 0, 0.5]), turn])
    with pytest.raises(
        Unidentifiable, match=r"m, mz, Ixx, Iyy open: 9 of ten .* say nothing of .* m .* mz .* Ixx .* Iyy"
    ) as caught:
        from_spectra(U, _loads(U), LINES, AT)
    assert caught.value.singular_values[-1] < 1e-12 < 1e-3 < caught.value.singular_values[-2]


@pytest.mark.parametrize(
    ("change", "said"),
    [
        ({"robust": "median"}, "`robust`: must be one of '', 'huber', 'tukey', found 'median'"),
        ({"weights": np.ones((2, 6, 6))}, "of shape .15, 6, 6., found shape .2, 6, 6."),
        ({"weights": np.ones((15, 6, 6)), "covariance": np.ones((15, 36, 36))}, "give either `weights` or a covariance"),
    ],
)
def test_a_fit_refuses_what_does_not_fit(change: dict[str, object], said: str) -> None:
    with pytest.raises(BadInput, match=said):
        fit(MASS, **change)


def test_spectra_of_other_shapes_and_noise_of_nothing_are_refused() -> None:
    U = _motion(6)
    with pytest.raises(BadInput, match=r"\(runs, 15 lines, 6\) are needed"):
        from_spectra(U, _loads(U)[:, :3], LINES)
    with pytest.raises(BadInput, match="without any noise"):
        from_spectra(U, _loads(U), LINES, noise=_independent(np.zeros(U.shape), np.zeros(U.shape)))
    noise = _independent(np.full(U.shape, 1.0), np.full(U.shape, 1e3))
    with pytest.raises(CheckFailed, match="does not settle"):
        from_spectra(U + 1e3 * _complex(np.random.default_rng(0), *U.shape), _loads(U), LINES, noise=noise)


def test_gravity_missing_in_the_motions_shifts_the_cog_by_g_over_omega_squared_and_is_put_back() -> None:
    U = _motion(6)
    F = np.einsum("jk,nkl,rnl->rnj", BODY.mass_matrix, tilt(LINES, 9.81), U)
    felt = from_spectra(U, F, LINES, AT, gravity=9.81)
    assert_allclose(felt.inertia.parameters, BODY.parameters, rtol=0, atol=1e-11 * BODY.mass)
    H = DynamicMass(frequency=LINES, matrix=BODY.mass_matrix @ tilt(LINES, 9.81), reference_point=AT)
    assert_allclose(fit(H, gravity=9.81).inertia.parameters, BODY.parameters, rtol=0, atol=1e-11 * BODY.mass)
    low = DynamicMass(frequency=LINES[:1], matrix=H.matrix[:1], reference_point=AT)
    shift = low.matrix[0, 0, 4].real / BODY.mass - (BODY.cog - AT)[2]
    assert_allclose(shift, 15.5e-3, atol=0.05e-3)  # g/omega² at 4 Hz
    assert_allclose(against_apparent(low, 9.81).matrix[0], BODY.mass_matrix, rtol=0, atol=1e-12)
    with pytest.raises(BadInput, match="above 0 Hz only"):
        tilt([0.0, 4.0], 9.81)
