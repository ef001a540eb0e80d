"""The sandwich: closed forms of Mead and Markus and of Kerwin, both limits, torsion by minimum energy, loss by part."""

from dataclasses import replace

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eig, eigh, expm
from scipy.optimize import brentq

from fem.beam.elements import Sandwich, Section, layer_torsion, moduli, rectangle, sandwich
from fem.beam.frame import Frame, Member, Plan, assemble
from geometry.article import material
from geometry.errors import BadInput

STEEL, SILICONE = material("steel"), material("silicone")
WIDTH, THICKNESS, LAYER, LENGTH = 0.16, 0.005, 0.0005, 0.47
FACE = (THICKNESS - LAYER) / 2
PARTS = ("bottom", "silicone", "top")
Z = np.array([0.0, 0.0, 1.0])


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


def test_stiffness_belongs_to_the_wavelength() -> None:
    """The layer holds long waves together and lets short ones slip."""
    section = _section()
    bonded = section.faces.bending_y + section.stretching / 2 * section.distance**2
    share = [
        (_effective_bending(section, k).real - section.faces.bending_y) / (bonded - section.faces.bending_y)
        for k in (1e-2, 7, 1e3)
    ]
    assert_allclose(share, [1, 0.116, 0], atol=1e-3)


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


def _exact_cantilever(section: Sandwich, near: float) -> float:
    """Frequency [Hz] of a clamped sandwich nearest to `near`: the sixth-order theory's transfer matrix.

    With N = C (delta' - d w''), P = 2 E I_f w'' - d N and C = E A_f / 2 the state w, w', delta, N, P, P' obeys
    w'' = (P + d N) / (2 E I_f), delta' = N / C + d w'', N' = S delta, P'' = m omega² w.
    """
    D, C, d, S = section.faces.bending_y, section.stretching / 2, section.distance, section.slip

    def determinant(frequency: float) -> float:
        A = np.zeros((6, 6))
        A[0, 1] = 1
        A[1, 4], A[1, 3] = 1 / D, d / D
        A[2] = d * A[1]
        A[2, 3] += 1 / C
        A[3, 2], A[4, 5], A[5, 0] = S, 1, section.mass * (2 * np.pi * frequency) ** 2
        scale = np.diag([1, 1, d, D / d, D, D])
        return float(np.linalg.det(expm(np.linalg.inv(scale) @ A @ scale * LENGTH)[3:, 3:]))

    return float(brentq(determinant, 0.98 * near, 1.02 * near, xtol=1e-9 * near))


@pytest.mark.parametrize("stiffer", [1e-3, 1.0, 1e2])
def test_clamped_sandwich_meets_the_sixth_order_theory(stiffer: float) -> None:
    section = _without_rotary_inertia(_section(stiffer))
    frame = _beam(section, 32, bonded=True)
    found = _frequencies(frame, [2, 4], 3)
    assert_allclose(found, [_exact_cantilever(section, f) for f in found], rtol=5e-5)


def test_frequency_converges_with_the_fourth_power_of_the_element_length() -> None:
    section = _without_rotary_inertia(_section())
    exact = _exact_cantilever(section, _frequencies(_beam(section, 16, bonded=True), [2, 4], 2)[1])
    counts = np.array([3, 6, 12])
    errors = [_frequencies(_beam(section, n, bonded=True), [2, 4], 2)[1] / exact - 1 for n in counts]
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


@pytest.mark.parametrize("layer", [0.005, 0.02])
def test_layer_that_leaves_no_faces_is_refused(layer: float) -> None:
    with pytest.raises(BadInput, match="must be less than the thickness of the blade 5 mm, found"):
        sandwich(WIDTH, THICKNESS, layer, STEEL, SILICONE, PARTS)


@pytest.mark.parametrize("layer", [0.0, -0.001])
def test_layer_without_thickness_is_refused(layer: float) -> None:
    with pytest.raises(BadInput, match=r"layer_thickness.*must be positive"):
        sandwich(WIDTH, THICKNESS, layer, STEEL, SILICONE, PARTS)
