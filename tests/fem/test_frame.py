"""The frame of Rayleigh beams: rigid motions, closed forms, convergence."""

from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from fem.frame import Member, Section, add_lumped, assemble
from geometry.frames import rigid_transformation_6

E, G, RHO = 207e9, 80e9, 7850.0


def _bar(width: float, height: float) -> Section:
    area, Iy, Iz = width * height, width * height**3 / 12, height * width**3 / 12
    return Section(
        axial=E * area,
        torsion=G * (Iy + Iz),
        bending_y=E * Iy,
        bending_z=E * Iz,
        mass=RHO * area,
        rotary_y=RHO * Iy,
        rotary_z=RHO * Iz,
    )


def _skew_frame() -> tuple[np.ndarray, list[Member]]:
    nodes = np.array([[0, 0, 0], [0.3, 0.1, 0.4], [0.5, 0.4, 0.3]])
    axes = [np.cross(b - a, [0.2, -0.7, 0.1]) for a, b in pairwise(nodes)]
    section = _bar(0.03, 0.01)
    return nodes, [Member(nodes=(k, k + 1), section=section, z_axis=z / np.linalg.norm(z)) for k, z in enumerate(axes)]


def test_rigid_motions_cost_no_energy() -> None:
    nodes, members = _skew_frame()
    K, _ = assemble(nodes, members)
    rigid = np.vstack([rigid_transformation_6(node) for node in nodes])
    assert_allclose(K @ rigid, 0, atol=1e-9 * np.abs(K).max())


def test_mass_matrix_holds_the_rigid_body_of_the_members() -> None:
    """Slender members: mass, first moment and the moments of rods with the section's rotary inertia, exactly."""
    nodes, members = _skew_frame()
    _, M = assemble(nodes, members)
    rigid = np.vstack([rigid_transformation_6(node) for node in nodes])
    total, expected = rigid.T @ M @ rigid, np.zeros((6, 6))
    for member in members:
        a, b = nodes[list(member.nodes)]
        length, s = np.linalg.norm(b - a), member.section
        x, z = (b - a) / length, member.z_axis
        y = np.cross(z, x)
        along = s.mass * length**3 / 12
        tensor = (
            np.outer(x, x) * (s.rotary_y + s.rotary_z) * length
            + np.outer(y, y) * (along + s.rotary_y * length)
            + np.outer(z, z) * (along + s.rotary_z * length)
        )
        centre = rigid_transformation_6((a + b) / 2)
        expected += centre.T @ np.block([[s.mass * length * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), tensor]]) @ centre
    assert_allclose(total, expected, rtol=1e-12, atol=1e-12)


def _cantilever(elements: int, rotary: bool = False) -> np.ndarray:
    """Frequencies [Hz] in the plane in which a 20 x 10 mm bar, a metre long, bends about its weak axis."""
    nodes = np.linspace([0, 0, 0], [1, 0, 0], elements + 1)
    section = replace(_bar(0.02, 0.01), **({} if rotary else {"rotary_y": 0.0}))
    K, M = assemble(nodes, [Member(nodes=tuple(range(elements + 1)), section=section, z_axis=np.array([0.0, 0.0, 1.0]))])
    plane = np.array([[6 * n + 2, 6 * n + 4] for n in range(1, elements + 1)]).ravel()  # z and beta of the free nodes
    held = np.ix_(plane, plane)
    return np.sqrt(eigh(K[held], M[held], eigvals_only=True)) / (2 * np.pi)


BETA = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613])
EULER_BERNOULLI = BETA**2 / (2 * np.pi) * np.sqrt(E * 0.01**2 / 12 / RHO)


def test_cantilever_bends_at_its_closed_form_frequencies() -> None:
    assert_allclose(_cantilever(20)[:3], EULER_BERNOULLI, rtol=5e-5)  # (beta / 20)^4 / 1440 at the third mode is 2e-5


def test_frequency_converges_with_the_fourth_power_of_the_element_length() -> None:
    counts = np.array([3, 6, 12])
    errors = [_cantilever(n)[1] / EULER_BERNOULLI[1] - 1 for n in counts]
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(4, abs=0.2)


def test_rotary_inertia_lowers_frequencies_by_rayleighs_correction() -> None:
    """About (beta r / L)² / 2 in higher modes, r being the section's radius of gyration; more near the clamp's end modes."""
    drop = 1 - _cantilever(20, rotary=True)[:3] / _cantilever(20)[:3]
    assert np.all(drop > 0)
    assert np.all(np.diff(drop) > 0)
    assert drop[2] == pytest.approx(0.01**2 / 12 * BETA[2] ** 2 / 2, rel=0.3)


def test_lumped_body_on_a_tip_lowers_the_frequency_as_rayleigh_says() -> None:
    """A heavy tip mass on a light beam: f = sqrt(3 E I / ((m_tip + 33/140 m) L³)) / 2 pi."""
    section, tip = _bar(0.02, 0.01), 50.0
    K, M = assemble([[0, 0, 0], [1, 0, 0]], [Member(nodes=(0, 1), section=section, z_axis=np.array([0.0, 0.0, 1.0]))])
    add_lumped(M, 1, np.diag([tip, tip, tip, 1e-9, 1e-9, 1e-9]))
    lowest = np.sqrt(eigh(K[6:, 6:], M[6:, 6:], eigvals_only=True)[0])
    assert lowest == pytest.approx(np.sqrt(3 * section.bending_y / (tip + 33 / 140 * section.mass)), rel=1e-4)
