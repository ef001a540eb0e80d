"""The frame of Timoshenko beams: statics, rigid motions, rigid links, closed forms, convergence."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh, expm
from scipy.optimize import brentq

from fem.beam.elements import Section, cowper_rectangle
from fem.beam.frame import Body, Frame, Member, Plan, Ports, assemble, inertia, on_top, placed
from geometry.frames import rigid_transformation_6
from geometry.inertia import Inertia

E, G, RHO = 207e9, 80e9, 7850.0
X, Y, Z = np.eye(3)


def _bar(width: float, height: float) -> Section:
    area, Iy, Iz = width * height, width * height**3 / 12, height * width**3 / 12
    shear = cowper_rectangle(E / (2 * G) - 1) * G * area
    return Section(
        axial=E * area,
        torsion=G * (Iy + Iz),
        bending_y=E * Iy,
        bending_z=E * Iz,
        shear_y=shear,
        shear_z=shear,
        mass=RHO * area,
        rotary_y=RHO * Iy,
        rotary_z=RHO * Iz,
    )


def _chain(section: Section, elements: int, length: float = 1.0) -> Plan:
    """A beam along x whose section's z axis is the frame's."""
    nodes = np.linspace([0, 0, 0], [length, 0, 0], elements + 1)
    member = Member(nodes=tuple(range(elements + 1)), section=section, z_axis=Z)
    return Plan(nodes=nodes, carriers=tuple(range(elements + 1)), members=(member,), top=elements)


def _stiffness(frame: Frame) -> np.ndarray:
    return sum(frame.stiffness.values())


def _skew_plan() -> Plan:
    nodes = np.array([[0, 0, 0], [0.3, 0.1, 0.4], [0.5, 0.4, 0.3]])
    axes = [np.cross(b - a, [0.2, -0.7, 0.1]) for a, b in pairwise(nodes)]
    section = _bar(0.03, 0.01)
    members = tuple(Member(nodes=(k, k + 1), section=section, z_axis=axis / np.linalg.norm(axis)) for k, axis in enumerate(axes))
    return Plan(nodes=nodes, carriers=(0, 1, 2), members=members)


def _linked_plan() -> Plan:
    """The skew frame with a gap that a rigid link of three nodes bridges, and a body on a rider."""
    skew = _skew_plan()
    nodes = np.vstack([skew.nodes, [[0.55, 0.45, 0.35], [0.6, 0.4, 0.7]]])
    members = (*skew.members, Member(nodes=(3, 4), section=_bar(0.02, 0.02), z_axis=_across(nodes[4] - nodes[3])))
    body = Body(node=3, inertia=Inertia.from_cog(2.0, [0.5, 0.5, 0.4], np.diag([0.02, 0.03, 0.04])))
    return Plan(nodes=nodes, carriers=(0, 1, 2, 2, 4), members=members, bodies=(body,))


def _across(direction: np.ndarray) -> np.ndarray:
    across = np.cross(direction, [0.3, 0.9, 0.1])
    return across / np.linalg.norm(across)


PLANS = {"skew": _skew_plan, "with a rigid link": _linked_plan}


@pytest.mark.parametrize("plan", PLANS.values(), ids=PLANS)
def test_rigid_motions_cost_no_energy(plan: Callable[[], Plan]) -> None:
    frame = assemble(plan())
    K = _stiffness(frame)
    assert_allclose(K @ frame.rigid, 0, atol=1e-12 * np.abs(K).max())


def test_mass_matrix_holds_the_rigid_body_of_the_members() -> None:
    """Mass, first moment and the moments of rods with the section's rotary inertia, exactly, shear deformation or not."""
    plan = _skew_plan()
    frame = assemble(plan)
    expected = np.zeros((6, 6))
    for member in plan.members:
        a, b = plan.nodes[list(member.nodes)]
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
    assert_allclose(frame.rigid.T @ frame.mass @ frame.rigid, expected, rtol=1e-12, atol=1e-12)
    assert_allclose(sum(inertia(m, plan.nodes).mass_matrix for m in plan.members), expected, rtol=1e-12, atol=1e-12)


def test_bodies_and_members_that_ride_weigh_what_they_weigh_where_they_are() -> None:
    plan = _linked_plan()
    frame = assemble(plan)
    expected = (
        sum(inertia(m, plan.nodes).mass_matrix for m in plan.members) + plan.bodies[0].inertia.about(np.zeros(3)).mass_matrix
    )
    assert_allclose(frame.rigid.T @ frame.mass @ frame.rigid, expected, rtol=1e-12, atol=1e-12)


def test_free_frame_has_six_rigid_modes_and_no_seventh() -> None:
    frame = assemble(_linked_plan())
    squares = eigh(_stiffness(frame), frame.mass, eigvals_only=True)
    assert np.abs(squares[:6]).max() < 1e-9 * squares[6]


def test_one_element_is_exact_in_statics() -> None:
    """Tip force and tip moment on a cantilever: P L³ / 3 E I + P L / k G A and so on, in both planes, stretch and twist."""
    section, L = _bar(0.12, 0.08), 0.3
    frame = assemble(_chain(section, 1, L))
    flexibility = np.linalg.inv(_stiffness(frame)[6:, 6:])
    y, z = section.bending_z, section.bending_y  # deflection along y bends about z
    expected = np.diag(
        [
            L / section.axial,
            L**3 / (3 * y) + L / section.shear_y,
            L**3 / (3 * z) + L / section.shear_z,
            L / section.torsion,
            L / z,
            L / y,
        ]
    )
    expected[1, 5] = expected[5, 1] = L**2 / (2 * y)
    expected[2, 4] = expected[4, 2] = -(L**2) / (2 * z)
    assert_allclose(flexibility, expected, rtol=1e-10, atol=1e-10 * L / z)


def test_rigid_link_carries_a_load_as_a_lever_does() -> None:
    """A force at the end of a lever e beyond the tip sees the cantilever's tip under force and moment."""
    section, L, e = _bar(0.02, 0.01), 1.0, 0.2
    plan = _chain(section, 2, L)
    lever = replace(plan, nodes=np.vstack([plan.nodes, [L + e, 0, 0]]), carriers=(*plan.carriers, 2))
    spring = Ports(nodes=(3,), stiffness=np.diag([0, 0, 1e-9, 0, 0, 0]), mass=np.zeros((6, 6)), part="load")
    load = assemble(replace(lever, ports=(spring,))).stiffness["load"][:, 14] / 1e-9  # a unit force at the lever's end
    deflected = np.linalg.solve(_stiffness(assemble(lever))[6:, 6:], load[6:])
    tip, turn = deflected[8], deflected[10]
    EI = section.bending_y
    assert_allclose(tip - e * turn, (L**3 / 3 + L**2 * e + L * e**2) / EI + L / section.shear_z, rtol=1e-9)


def _plane(plan: Plan, held: int) -> tuple[np.ndarray, np.ndarray]:
    """K and M of z and beta, the first `held` of them taken away."""
    frame = assemble(plan)
    dofs = np.array([[6 * n + 2, 6 * n + 4] for n in range(len(plan.nodes))]).ravel()[held:]
    at = np.ix_(dofs, dofs)
    return _stiffness(frame)[at], frame.mass[at]


def _cantilever(section: Section, elements: int) -> np.ndarray:
    """Frequencies [Hz] of a metre of `section` in the plane in which it bends about its y axis."""
    return np.sqrt(eigh(*_plane(_chain(section, elements), 2), eigvals_only=True)) / (2 * np.pi)


def _exact(section: Section, near: float, length: float = 1.0) -> float:
    """Timoshenko's cantilever frequency [Hz] nearest to `near`: the root of the determinant of its transfer matrix.

    The state v, theta, M, Q obeys v' = theta + Q / kGA, theta' = M / EI, M' = -Q - rho I omega² theta, Q' = -rho A omega² v;
    clamped v = theta = 0, at the free end M = Q = 0.
    """

    def determinant(frequency: float) -> float:
        square = (2 * np.pi * frequency) ** 2
        A = np.zeros((4, 4))
        A[0, 1], A[0, 3], A[1, 2] = 1, 1 / section.shear_z, 1 / section.bending_y
        A[2, 1], A[2, 3], A[3, 0] = -section.rotary_y * square, -1, -section.mass * square
        scale = np.diag([1, 1, section.bending_y, section.bending_y])
        return float(np.linalg.det(expm(np.linalg.inv(scale) @ A @ scale * length)[2:, 2:]))

    return float(brentq(determinant, 0.97 * near, 1.03 * near, xtol=1e-9 * near, rtol=1e-14))


SLENDER, STUBBY = _bar(0.02, 0.01), _bar(0.1, 0.2)
BETA = np.array([1.875104068711961, 4.694091132974175, 7.854757438237613])


def _without(section: Section, *names: str) -> Section:
    values = {"shear": {"shear_y": np.inf, "shear_z": np.inf}, "rotary": {"rotary_y": 0.0, "rotary_z": 0.0}}
    return replace(section, **{key: value for name in names for key, value in values[name].items()})


@pytest.mark.parametrize("section", [SLENDER, STUBBY], ids=["slender", "stubby"])
def test_cantilever_bends_at_the_roots_of_timoshenkos_equation(section: Section) -> None:
    """Extrapolated with the square of the element length, the slowest share of the error; next is (beta / 40)^4."""
    coarse, fine = (_cantilever(section, n)[:4] for n in (20, 40))
    found = fine + (fine - coarse) / 3
    assert_allclose(found, [_exact(section, f) for f in found], rtol=3e-5)


def test_shear_matters_on_the_stubby_bar_and_leaves_the_slender_one_alone() -> None:
    drops = [1 - _cantilever(s, 20)[1] / _cantilever(_without(s, "shear"), 20)[1] for s in (STUBBY, SLENDER)]
    assert drops[0] > 0.1
    assert 0 < drops[1] < 1e-3


def test_without_shear_and_rotary_inertia_the_bar_is_eulers() -> None:
    found = _cantilever(_without(SLENDER, "shear", "rotary"), 20)[:3]
    assert_allclose(found, BETA**2 / (2 * np.pi) * np.sqrt(SLENDER.bending_y / SLENDER.mass), rtol=5e-5)  # (beta / 20)^4 / 1440


def test_element_becomes_rayleighs_as_its_shear_stiffness_grows() -> None:
    """The difference is Phi and falls with it; at infinity there is none."""
    rayleigh = _cantilever(_without(STUBBY, "shear"), 4)[:3]
    differences = [
        np.abs(_cantilever(replace(STUBBY, shear_z=factor * STUBBY.shear_z), 4)[:3] / rayleigh - 1) for factor in (1e3, 1e4)
    ]
    assert_allclose(differences[1], differences[0] / 10, rtol=0.02)


@pytest.mark.parametrize(
    ("section", "rate"), [(_without(SLENDER, "shear", "rotary"), 4), (_without(STUBBY, "shear"), 4), (STUBBY, 2)]
)
def test_frequency_converges_with_the_fourth_power_in_bending_and_the_second_in_shear(section: Section, rate: int) -> None:
    """Shear is constant in an element, so what it adds converges with the square."""
    counts = np.array([4, 8, 16])
    exact = _exact(section, _cantilever(section, 40)[1])
    errors = [_cantilever(section, n)[1] / exact - 1 for n in counts]
    assert min(errors) > 0  # from above, as Rayleigh's quotient must
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(rate, abs=0.2)


def test_free_bar_has_two_zero_modes_and_the_closed_form_ones() -> None:
    squares = eigh(*_plane(_chain(_without(SLENDER, "shear", "rotary"), 20), 0), eigvals_only=True)
    assert np.abs(squares[:2]).max() < 1e-6 * squares[2]
    free = np.array([4.730040744862704, 7.853204624095838])
    assert_allclose(np.sqrt(squares[2:4]), free**2 * np.sqrt(SLENDER.bending_y / SLENDER.mass), rtol=5e-5)


def test_rod_twists_and_stretches_at_its_wave_speeds() -> None:
    """Odd quarter waves; a linear element of length h is too high by (k h)² / 24."""
    section, n = SLENDER, 40
    frame = assemble(_chain(section, n))
    for direction, stiffness, mass in (
        (0, section.axial, section.mass),
        (3, section.torsion, section.rotary_y + section.rotary_z),
    ):
        dofs = np.ix_(*2 * [np.arange(6 + direction, 6 * n + 6, 6)])
        lowest = np.sqrt(eigh(_stiffness(frame)[dofs], frame.mass[dofs], eigvals_only=True)[0])
        k = np.pi / 2
        assert_allclose(lowest / (k * np.sqrt(stiffness / mass)) - 1, (k / n) ** 2 / 24, rtol=0.01)


def test_body_on_a_tip_lowers_the_frequency_as_rayleigh_says() -> None:
    """A heavy tip mass on a light beam: f = sqrt(3 E I / ((m_tip + 33/140 m) L³)) / 2 pi."""
    section, tip = SLENDER, 50.0
    body = Body(node=1, inertia=Inertia.from_cog(tip, X, 1e-9 * np.eye(3)))
    frame = assemble(replace(_chain(section, 1), bodies=(body,)))
    lowest = np.sqrt(eigh(_stiffness(frame)[6:, 6:], frame.mass[6:, 6:], eigvals_only=True)[0])
    assert lowest == pytest.approx(np.sqrt(3 * section.bending_y / (tip + 33 / 140 * section.mass)), rel=1e-3)


def test_two_plans_on_top_of_one_another_are_one_beam() -> None:
    whole = assemble(_chain(STUBBY, 4, 2.0))
    half = _chain(STUBBY, 2)
    stacked = on_top(placed(half, np.zeros(3), "a/"), placed(half, X, "b/"))
    frame = assemble(stacked)
    assert set(frame.stiffness) == {"a/beam", "b/beam"}
    for found, expected in ((_stiffness(frame), _stiffness(whole)), (frame.mass, whole.mass)):
        assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())
