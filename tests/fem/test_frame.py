"""Sections, frames and sandwiches of beams: closed forms, rigid motions, convergence."""

from collections.abc import Callable
from dataclasses import replace
from itertools import pairwise

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eig, eigh, expm
from scipy.optimize import brentq

from fem.beam.elements import (
    Sandwich,
    Section,
    cowper_rectangle,
    cowper_tube,
    layer_torsion,
    moduli,
    rectangle,
    rectangle_torsion,
    sandwich,
    tube,
)
from fem.beam.frame import Body, Frame, Member, Plan, Ports, assemble, inertia, on_top, placed
from geometry.article import material
from geometry.errors import BadInput
from geometry.inertia import Inertia

STEEL = material("steel")


def test_cowpers_coefficients_are_those_he_prints() -> None:
    """Rectangle 5/6 and rod 6/7 without Poisson's effect; the thin tube 2 (1 + nu) / (4 + 3 nu)."""
    assert cowper_rectangle(0.0) == pytest.approx(5 / 6)
    assert cowper_tube(0.0, 0.0) == pytest.approx(6 / 7)
    assert cowper_tube(0.3, 1.0) == pytest.approx(2 * 1.3 / 4.9)
    assert cowper_tube(0.3, 0.0) == pytest.approx(0.886, abs=5e-4)
    assert cowper_rectangle(0.3) == pytest.approx(0.850, abs=5e-4)


def test_torsion_of_a_rectangle_meets_the_printed_table_and_the_thin_strip() -> None:
    """Timoshenko and Goodier's table for a/b = 1, 2, 10: J / (a b³) = 0.1406, 0.229, 0.312; thin: (1 - 0.63 b/a) / 3."""
    for ratio, printed in ((1, 0.1406), (2, 0.229), (10, 0.312)):
        assert rectangle_torsion(ratio, 1) / ratio == pytest.approx(printed, abs=5e-4)
    assert rectangle_torsion(30, 1) == pytest.approx(30 / 3 * (1 - 0.63 / 30), rel=1e-4)
    assert rectangle_torsion(2, 3) == rectangle_torsion(3, 2)


@pytest.mark.parametrize(
    ("field", "value", "said"),
    [
        ("youngs_modulus", -1.0, "must be positive and finite, found -1 Pa"),
        ("youngs_modulus", 0.0, "must be positive and finite, found 0 Pa"),
        ("youngs_modulus", float("nan"), "must be positive and finite"),
        ("youngs_modulus", None, "is missing"),
        ("poisson_ratio", None, "is missing"),
        ("poisson_ratio", 0.5, "between -1 and 0.5, found 0.5"),
    ],
)
def test_material_that_makes_no_beam_is_refused(field: str, value: float | None, said: str) -> None:
    with pytest.raises(BadInput, match=said) as refused:
        rectangle(0.1, 0.01, replace(STEEL, **{field: value}))
    assert refused.value.field == field


def test_section_without_material_is_refused() -> None:
    for make in (lambda: rectangle(0.1, -0.01, STEEL), lambda: rectangle(np.nan, 0.1, STEEL)):
        with pytest.raises(BadInput, match="must be positive and finite"):
            make()
    with pytest.raises(BadInput, match=r"must lie between 0 and the outer diameter 0\.05 m, found 0\.06 m"):
        tube(0.05, 0.06, STEEL)


X, Y, Z = np.eye(3)


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
    section = rectangle(0.03, 0.01, STEEL)
    members = tuple(Member(nodes=(k, k + 1), section=section, z_axis=axis / np.linalg.norm(axis)) for k, axis in enumerate(axes))
    return Plan(nodes=nodes, carriers=(0, 1, 2), members=members)


def _linked_plan() -> Plan:
    """The skew frame with a gap that a rigid link of three nodes bridges, and a body on a rider."""
    skew = _skew_plan()
    nodes = np.vstack([skew.nodes, [[0.55, 0.45, 0.35], [0.6, 0.4, 0.7]]])
    members = (*skew.members, Member(nodes=(3, 4), section=rectangle(0.02, 0.02, STEEL), z_axis=_across(nodes[4] - nodes[3])))
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


def test_bodies_and_members_that_ride_weigh_what_they_weigh_where_they_are() -> None:
    plan = _linked_plan()
    frame = assemble(plan)
    expected = (
        sum(inertia(m, plan.nodes).mass_matrix for m in plan.members) + plan.bodies[0].inertia.about(np.zeros(3)).mass_matrix
    )
    assert_allclose(frame.rigid.T @ frame.mass @ frame.rigid, expected, rtol=1e-12, atol=1e-12)


def test_one_element_is_exact_in_statics() -> None:
    """Tip force and tip moment on a cantilever: P L³ / 3 E I + P L / k G A and so on, in both planes, stretch and twist."""
    section, L = rectangle(0.12, 0.08, STEEL), 0.3
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
    section, L, e = rectangle(0.02, 0.01, STEEL), 1.0, 0.2
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


SLENDER, STUBBY = rectangle(0.02, 0.01, STEEL), rectangle(0.1, 0.2, STEEL)
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


def test_without_shear_and_rotary_inertia_the_bar_is_eulers() -> None:
    found = _cantilever(_without(SLENDER, "shear", "rotary"), 20)[:3]
    assert_allclose(found, BETA**2 / (2 * np.pi) * np.sqrt(SLENDER.bending_y / SLENDER.mass), rtol=5e-5)  # (beta / 20)^4 / 1440


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


def test_two_plans_on_top_of_one_another_are_one_beam() -> None:
    whole = assemble(_chain(STUBBY, 4, 2.0))
    half = _chain(STUBBY, 2)
    stacked = on_top(placed(half, np.zeros(3), "a/"), placed(half, X, "b/"))
    frame = assemble(stacked)
    assert set(frame.stiffness) == {"a/beam", "b/beam"}
    for found, expected in ((_stiffness(frame), _stiffness(whole)), (frame.mass, whole.mass)):
        assert_allclose(found, expected, rtol=1e-12, atol=1e-12 * np.abs(expected).max())


SILICONE = material("silicone")
WIDTH, THICKNESS, LAYER, LENGTH = 0.16, 0.005, 0.0005, 0.47
FACE = (THICKNESS - LAYER) / 2
PARTS = ("bottom", "silicone", "top")


def _section(stiffer: float = 1.0) -> Sandwich:
    soft = replace(SILICONE, youngs_modulus=SILICONE.youngs_modulus * stiffer)
    return sandwich(WIDTH, THICKNESS, LAYER, STEEL, soft, PARTS)


def _without_rotary_inertia(section: Sandwich) -> Sandwich:
    """As the closed forms have it."""
    faces = replace(section.faces, rotary_y=0.0)
    return replace(section, faces=faces, face_rotary=0.0, face_mass=0.0, layer_rotary=0.0)


def _beam(section: Sandwich | Section, elements: int, *, bonded: bool = False) -> Frame:
    nodes = np.linspace([0, 0, 0], [LENGTH, 0, 0], elements + 1)
    member = Member(nodes=tuple(range(elements + 1)), section=section, z_axis=Z, bonded=frozenset({0}) if bonded else frozenset())
    return assemble(Plan(nodes=nodes, carriers=tuple(range(elements + 1)), members=(member,)))


def _bending(frame: Frame, held: list[int]) -> np.ndarray:
    """Degrees of freedom that take part in bending: w, beta and slips, less those `held`."""
    nodal = 6 * len(frame.moving)
    part = [6 * n + k for n in range(len(frame.moving)) for k in (2, 4)] + list(range(nodal, len(frame.mass)))
    return np.array([dof for dof in part if dof not in held])


def _frequencies(frame: Frame, held: list[int], count: int) -> np.ndarray:
    at = np.ix_(*2 * [_bending(frame, held)])
    K = sum(frame.stiffness.values())
    # the other way round, since slip without mass has no frequency
    return 1 / np.sqrt(eigh(frame.mass[at], K[at], eigvals_only=True)[: -count - 1 : -1]) / (2 * np.pi)


def _effective_bending(section: Sandwich, k: float, layer: complex = 1.0) -> complex:
    """Kerwin's: 2 E I_f + E A_f d²/2 g / (1 + g), g = (G_c b / s) / (E A_f / 2 k²), exact for a sine of wave number k."""
    half, d = section.stretching / 2, section.distance
    g = layer * section.slip / (half * k**2)
    return section.faces.bending_y + half * d**2 * g / (1 + g)


ENDS = [2, 6 * 32 + 2]
"""Deflection at both ends of a beam of 32 elements."""


def test_simply_supported_sandwich_bends_at_its_closed_form_frequencies() -> None:
    section = _without_rotary_inertia(_section())
    k = np.arange(1, 5) * np.pi / LENGTH
    expected = k**2 * np.sqrt(np.array([_effective_bending(section, wave) for wave in k]) / section.mass) / (2 * np.pi)
    assert_allclose(_frequencies(_beam(section, 32), ENDS, 4), expected, rtol=3e-5)  # (k h)^4 / 1440 at the fourth is 1.7e-5


def test_loss_of_a_mode_is_kerwins() -> None:
    """Complex eigenvalues of faces + (1 + i eta) layer against the complex modulus in the closed form."""
    section, eta = _without_rotary_inertia(_section()), 0.2
    frame = _beam(section, 32)
    at = np.ix_(*2 * [_bending(frame, ENDS)])
    K = sum((1 + 1j * eta * (part == "silicone")) * k[at] for part, k in frame.stiffness.items())
    inverse = eig(frame.mass[at], K, right=False)
    squares = 1 / inverse[np.argsort(-inverse.real)][:3]
    bending = np.array([_effective_bending(section, n * np.pi / LENGTH, 1 + 1j * eta) for n in (1, 2, 3)])
    assert_allclose(squares.imag / squares.real, bending.imag / bending.real, rtol=2e-4)


def test_frequency_converges_with_the_fourth_power_of_the_element_length() -> None:
    section, k = _without_rotary_inertia(_section()), 2 * np.pi / LENGTH
    exact = k**2 * np.sqrt(_effective_bending(section, k) / section.mass) / (2 * np.pi)
    counts = np.array([4, 8, 16])
    errors = [_frequencies(_beam(section, n), [2, 6 * n + 2], 2)[1] / exact - 1 for n in counts]
    assert -np.polyfit(np.log(counts), np.log(errors), 1)[0] == pytest.approx(4, abs=0.3)


def test_soft_layer_leaves_two_faces_and_a_stiff_one_bonds_them() -> None:
    for stiffer, bending in ((1e-9, 0.0), (1e7, 1.0)):
        section = _without_rotary_inertia(_section(stiffer))
        whole = section.faces.bending_y + bending * section.stretching / 2 * section.distance**2
        plain = replace(section.faces, bending_y=whole, shear_z=np.inf)
        found = _frequencies(_beam(section, 16, bonded=True), [2, 4], 3)
        assert_allclose(found, _frequencies(_beam(plain, 16), [2, 4], 3), rtol=1e-4)


def test_bonded_faces_without_a_layer_are_the_solid_blade() -> None:
    """A layer of a nanometre, and of a modulus that bonds it: the closed forms sum to the solid's, bending, torsion and mass."""
    thin = sandwich(WIDTH, THICKNESS, 1e-9, STEEL, replace(STEEL, name="glue"), PARTS)
    solid = rectangle(WIDTH, THICKNESS, STEEL)
    assert thin.faces.bending_y + thin.stretching / 2 * thin.distance**2 == pytest.approx(solid.bending_y, rel=1e-6)
    assert thin.faces.torsion + thin.layer_torsion == pytest.approx(solid.torsion, rel=0.02)  # the layer's edges: 1.5 % here
    for name in ("mass", "rotary_y", "rotary_z"):
        assert getattr(thin, name) == pytest.approx(getattr(solid, name), rel=1e-6)
    assert thin.faces.bending_z == pytest.approx(solid.bending_z, rel=1e-6)


def test_rigid_motion_costs_nothing_and_weighs_all() -> None:
    section = _section()
    frame = _beam(section, 4)
    assert_allclose(sum(frame.stiffness.values()) @ frame.rigid, 0, atol=1e-9 * section.faces.axial)
    M = frame.rigid.T @ frame.mass @ frame.rigid
    assert M[0, 0] == pytest.approx(section.mass * LENGTH, rel=1e-12)
    assert M[4, 4] == pytest.approx(section.mass * LENGTH**3 / 3 + section.rotary_y * LENGTH, rel=1e-12)
    layers = 2 * STEEL.density * FACE * (FACE**2 / 12 + (FACE + LAYER) ** 2 / 4) + SILICONE.density * LAYER**3 / 12
    assert section.rotary_y == pytest.approx(WIDTH * layers, rel=1e-12)


def test_faces_that_slip_freely_turn_without_stretching() -> None:
    """Slope theta and slip d theta everywhere: each face turns about its own middle, the layer by (d / s - 1) theta."""
    section = _section()
    frame = _beam(section, 4)
    motion = frame.rigid[:, 4].copy()
    motion[6 * len(frame.moving) :] = -section.distance  # a positive slope is a negative rotation
    turning = section.face_rotary + section.layer_rotary * (section.distance / section.layer_thickness - 1) ** 2
    assert motion @ frame.mass @ motion == pytest.approx(section.mass * LENGTH**3 / 3 + turning * LENGTH, rel=1e-12)
    without = frame.rigid[:, 4] @ frame.mass @ frame.rigid[:, 4]
    assert abs(motion @ frame.mass @ motion / without - 1) > 1e-9  # the slip is heavy enough to be seen at that tolerance


def _torsion_by_minimum_energy(G: float, G_layer: float) -> float:
    """What the layer adds to G J: faces that warp by psi(y), the width in 400 linear pieces, solved for the least energy."""
    d, n = FACE + LAYER, 400
    y = np.linspace(-WIDTH / 2, WIDTH / 2, n + 1)
    h = WIDTH / n
    A, b, c = np.zeros((n + 1, n + 1)), np.zeros(n + 1), 0.0
    for i in range(n):  # energy G t_f (psi' - d/2)² + G_c / 2 s (2 psi + d y)², at unit rate, two Gauss points
        for point in (-1, 1):
            x = (1 + point / np.sqrt(3)) / 2
            N, B, place = np.array([1 - x, x]), np.array([-1, 1]) / h, y[i] + x * h
            at = slice(i, i + 2)
            A[at, at] += h / 2 * (2 * G * FACE * np.outer(B, B) + 4 * G_layer / LAYER * np.outer(N, N))
            b[at] += h / 2 * (-G * FACE * d * B + 2 * G_layer / LAYER * d * place * N)
            c += h / 2 * (G * FACE * d**2 / 4 + G_layer / (2 * LAYER) * (d * place) ** 2)
    psi = np.linalg.solve(A, -b)
    return float(2 * (psi @ A @ psi / 2 + b @ psi + c))


@pytest.mark.parametrize("stiffer", [1e-3, 1.0, 1e2, 1e4])
def test_torsion_of_the_coupled_faces_is_that_of_least_energy(stiffer: float) -> None:
    G, G_layer = moduli(STEEL)[1], stiffer * moduli(SILICONE)[1]
    found, _ = layer_torsion(WIDTH, FACE, LAYER, G, G_layer)
    assert found == pytest.approx(_torsion_by_minimum_energy(G, G_layer), rel=1e-3)


@pytest.mark.parametrize("stiffer", [1e-9, 1e-4, 1.0, 1e3])
def test_share_of_torsion_in_the_layer_is_what_its_modulus_changes(stiffer: float) -> None:
    G, G_layer, step = moduli(STEEL)[1], stiffer * moduli(SILICONE)[1], 1e-4
    more, less = (layer_torsion(WIDTH, FACE, LAYER, G, G_layer * factor)[0] for factor in (1 + step, 1 - step))
    coupled, share = layer_torsion(WIDTH, FACE, LAYER, G, G_layer)
    assert share == pytest.approx((more - less) / (2 * step) / coupled, rel=1e-5)
    assert 0 < share <= 1


def test_parts_add_up_and_the_faces_share_equally() -> None:
    frame = _beam(_section(), 3)
    assert set(frame.stiffness) == set(PARTS)
    assert_allclose(frame.stiffness["bottom"], frame.stiffness["top"])
    for k in frame.stiffness.values():
        assert np.linalg.eigvalsh(k).min() > -1e-9 * np.abs(k).max()


TOO_THICK, NONE = "must be less than the thickness of the blade 5 mm, found", r"layer_thickness.*must be positive"


@pytest.mark.parametrize(("layer", "said"), [(0.005, TOO_THICK), (0.02, TOO_THICK), (0.0, NONE), (-0.001, NONE)])
def test_layer_that_leaves_no_faces_or_has_no_thickness_is_refused(layer: float, said: str) -> None:
    with pytest.raises(BadInput, match=said):
        sandwich(WIDTH, THICKNESS, layer, STEEL, SILICONE, PARTS)
