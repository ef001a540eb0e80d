"""What is left over is told by where it is and what it looks like, and with the size that it has."""

from __future__ import annotations

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.frames import rigid_transformation_6
from validation.diagnose.candidates import with_candidates
from validation.diagnose.diagnosis import Candidate
from validation.diagnose.unexplained import described, unexplained
from validation.diagnose.unexplained_fit import swallowing
from validation.effects.catalogue import parse
from validation.estimation.cost import cost_of
from validation.estimation.fit import FLOOR, ended, fitted
from validation.estimation.problem import FITTED
from validation.model.model import Added
from validation.prediction import dynamic_mass


def entry(of, i: int, j: int, course) -> np.ndarray:
    dH = np.zeros_like(of.H)
    dH[:, i, j] = course
    return dH


def test_a_spring_to_ground_is_a_stiffness_of_its_pair(left) -> None:
    found = described(left(lambda s: s.added(entry(s, 2, 2, -3e3 / s.omega**2))))
    assert (found.looks_like, found.load, found.motion) == ("stiffness", "f_z", "z")
    assert found.size == pytest.approx(3e3, rel=0.1)
    assert found.unit == "N/m"
    assert found.share > 0.8
    assert "spring" in found.text


def test_a_damper_that_turns_is_told_in_its_unit(left) -> None:
    found = described(left(lambda s: s.added(entry(s, 5, 5, -2j / s.omega))))
    assert (found.looks_like, found.load, found.motion, found.unit) == ("damping", "t_z", "gamma", "N s m")
    assert found.size == pytest.approx(2, rel=0.1)


def test_a_mass_that_couples_two_axes_is_told_with_both(left) -> None:
    found = described(left(lambda s: s.added(entry(s, 0, 1, 1.0) + entry(s, 1, 0, 1.0))))
    assert (found.looks_like, found.load, found.motion) == ("mass", "f_x", "y")
    assert found.size == pytest.approx(1.0, rel=0.1)
    assert "both ways" in found.text


def test_a_spinning_wheel_has_opposite_signs(left) -> None:
    found = described(left(lambda s: s.added(entry(s, 3, 4, -2j / s.omega) + entry(s, 4, 3, 2j / s.omega))))
    assert (found.looks_like, found.load, found.motion) == ("damping", "t_x", "beta")
    assert "opposite signs" in found.text


def test_a_resonance_is_told_with_its_frequency(left) -> None:
    def ringing(s):
        own = 2 * np.pi * 21.3
        return s.added(entry(s, 3, 3, 0.02 * s.omega**2 / (own**2 - s.omega**2 + 0.04j * own * s.omega)))

    found = described(left(ringing))
    assert (found.looks_like, found.load, found.motion) == ("resonance", "t_x", "alpha")
    assert found.frequency == pytest.approx(21.3, rel=0.02)


def test_a_channel_whose_gain_rises_is_named_alone(left) -> None:
    found = described(left(lambda s: s.of_channel("cover-x2", 0.01 * (s.frequency / 10) ** 2 * s.reading("cover-x2"))))
    assert (found.looks_like, found.channels, found.load, found.motion) == ("gain", ("cover-x2",), "", "")
    assert found.size == pytest.approx(0.01, rel=0.1)
    assert "square of frequency" in found.text


def test_a_delay_far_beyond_tolerance_is_told_although_a_tolerance_swallowed_all_of_it(left) -> None:
    found = described(left(lambda s: s.of_channel("fmd-z2", -1j * s.omega * 4e-4 * s.reading("fmd-z2"))))
    assert (found.looks_like, found.channels) == ("delay", ("fmd-z2",))
    assert found.size == pytest.approx(4e-4, rel=0.1)
    assert "0.4 ms" in found.text.replace("0.399", "0.4").replace("0.401", "0.4")


def test_a_channel_that_hears_another_is_told_with_what_it_hears(left) -> None:
    found = described(left(lambda s: s.of_channel("fmd-x12", 1.0 * s.reading("cover-y1"))))
    assert found.channels[0] == "fmd-x12"
    assert found.channels[1] in ("cover-y1", "table-y1")  # plate and table move nearly alike
    assert found.size == pytest.approx(1.0, rel=0.15)
    assert found.unit == "kg"


def test_a_sensor_that_feels_its_tilt_twice_looks_like_tilt(left) -> None:
    found = described(left(lambda s: s.of_channel("cover-x2", 9.81 / s.omega**2 * s.u[..., 4])))
    assert (found.looks_like, found.channels) == ("tilt", ("cover-x2",))
    assert found.size == pytest.approx(9.81, rel=0.1)
    assert found.unit == "m/s^2"


def test_accelerometers_that_feel_no_tilt_are_told_together(left) -> None:
    def none(s):
        table = {one.name: one for one in s.of.tested.campaign.table.channels}
        along = np.array([table[name].places[0].direction for name in s.channels])
        accelerometers = np.array([table[name].quantity == "acceleration" for name in s.channels])
        felt = s.u[..., 4, None] * along[:, 0] - s.u[..., 3, None] * along[:, 1]
        return np.where(accelerometers, -9.81 / s.omega[:, None] ** 2 * felt, 0.0)

    found = described(left(none))
    assert found.looks_like == "tilt"
    assert "all accelerometers" in found.text
    assert found.size == pytest.approx(-9.81, rel=0.1)


def test_a_loud_channel_looks_like_noise(left) -> None:
    rng = np.random.default_rng(3)

    def loud(s):
        level = 0.01 * np.abs(s.reading("table-y1")).max()
        shape = s.u.shape[:2]
        return s.of_channel("table-y1", level * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape)))

    found = described(left(loud))
    assert (found.looks_like, found.channels) == ("noise", ("table-y1",))


def test_a_load_cell_that_loses_energy_looks_like_damping(left) -> None:
    found = described(left(lambda s: s.of_parameter("cell-stiffness:2z", 0.3j * np.ones_like(s.omega))))
    assert found.looks_like == "damping"
    assert "load cell 2z" in found.text


def test_a_spring_off_the_reference_point_is_told_by_its_leading_pair_and_those_beside_it(left) -> None:
    def spring(s):
        d = np.array([0.0, 1.0, 0.0, -0.25, 0.0, 0.1])
        return s.added(-5e2 / s.omega[:, None, None] ** 2 * np.outer(d, d))

    found = described(left(spring))
    assert (found.looks_like, found.load, found.motion, found.unit) == ("stiffness", "f_y", "y", "N/m")
    assert found.size == pytest.approx(5e2, rel=0.1)
    assert "y and alpha" in found.text


def test_a_board_whose_delay_grows_along_the_sweep_is_told_as_a_group(left) -> None:
    def slow(s):
        late = -1j * s.omega * 2e-4 * np.log(s.frequency / s.frequency[0])
        return np.where([name.startswith("fmd") for name in s.channels], late[:, None] * s.read, 0.0)

    found = described(left(slow))
    assert found.looks_like == "delay"
    assert len(found.channels) == 8
    assert "load cells" in found.text


def test_a_joint_that_gives_is_told_with_its_compliance(left, state) -> None:
    carried = state.of.tested.carried
    T = rigid_transformation_6(carried.standing.pose.position)
    H = np.linalg.inv(T).T @ (state.H - dynamic_mass.at(carried.moving, {}).mass_matrix) @ np.linalg.inv(T)
    C = np.diag([0, 0, 0, 2e-6, 0, 0])
    found = described(left(lambda s: s.added(T.T @ (s.omega[:, None, None] ** 2 * H @ C @ H) @ T)))
    assert (found.looks_like, found.load, found.motion) == ("stiffness", "t_x", "alpha")
    assert found.size == pytest.approx(2e-6, rel=0.1)
    assert "between cover plate and article" in found.text


def test_a_mass_at_a_place_is_told_by_the_place(left) -> None:
    def heavier(s):
        rows = s.of.moved({})["top"][0]
        return s.added(0.3 * np.swapaxes(rows, 1, 2) @ rows)

    found = described(left(heavier))
    assert found.looks_like == "mass"
    assert "top" in found.text
    assert found.size == pytest.approx(0.3, rel=0.1)


def test_what_follows_nothing_is_irregular(left) -> None:
    rng = np.random.default_rng(4)

    def mixed(s):
        shape = s.read.shape
        level = 0.005 * np.abs(s.read).max(axis=(0, 1))
        return level * (rng.standard_normal(shape) + 1j * rng.standard_normal(shape))

    found = described(left(mixed))
    assert found.looks_like == "irregular"
    assert found.share < 0.5
    assert "comes closest" in found.text


def test_where_nothing_is_missing_no_description_gains_much_and_a_small_fault_gains_more(left) -> None:
    nothing = unexplained(left(lambda s: np.zeros_like(s.read)))
    small = unexplained(left(lambda s: s.added(entry(s, 3, 4, -0.3j / s.omega) + entry(s, 4, 3, 0.3j / s.omega))))
    assert nothing.gain < 20
    assert small.gain > 50
    assert small.place.sign == -1


def test_a_stiffness_among_the_parameters_does_not_drown_what_is_known_of_the_others(left) -> None:
    """Its variance is some (N/m)² beside (µm)²: covariances are taken by their correlations."""
    nothing = left(lambda s: np.zeros_like(s.read))
    spring = Added(named=parse("cable:top:vertical=800"))
    problem = with_candidates(nothing.problem, [spring])
    cost = cost_of(problem, problem.free(FITTED), FLOOR)
    sprung = Candidate(effects=(spring,), fit=fitted(ended(cost, {}, converged=False)), problem=problem)
    (one,) = swallowing(sprung)
    at = [k for k, each in enumerate(sprung.fit.parameters) if each.name in one.names]
    C, sd = sprung.fit.covariance[np.ix_(at, at)], np.sqrt(np.diag(sprung.fit.covariance)[at])
    assert sd.max() > 1e6 * sd.min() > 0
    assert_allclose(one.root @ one.root.T / np.outer(sd, sd), C / np.outer(sd, sd), atol=1e-9)
    assert unexplained(sprung).gain == pytest.approx(unexplained(nothing).gain, abs=5)
