"""Rows about the sandwich element: a simply supported beam of two faces and a soft layer, after Mead and Markus.

With w = W sin(k x) the slip follows as a cosine, and the layer acts as a spring in series with the faces' stretching: per width,
the bending stiffness at the wave number k is

    B(k) = E t³ / 6 + E t d² / 2 * g / (1 + g),    g = 2 G_c / (E t s k²),    d = t + s,

from two loose faces at short waves to the bonded section at long ones (Ross, Ungar and Kerwin 1959; Mead and Markus, J. Sound
Vib. 10, 1969, 163-175). A loss factor of the layer makes G_c complex; to first order a mode has of it the share of its energy
that the layer stores, d ln B / d ln G_c.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from fem.frame import Frame, Member, Plan, assemble
from fem.sandwich import sandwich
from geometry.arrays import Array
from geometry.materials import Material
from validation.verification.check import Check, Found, Mesh, once

FAMILY = "Sandwich beam"

STEEL = Material(name="steel", density=7850.0, youngs_modulus=207e9, poisson_ratio=0.3)
LAYER = Material(name="silicone", density=1100.0, youngs_modulus=3e6, poisson_ratio=0.49)
LENGTH, WIDTH, THICKNESS, LAYER_THICKNESS = 1.0, 0.06, 4.5e-3, 0.5e-3
"""[m]"""

ELEMENTS = {Mesh.FAST: 16, Mesh.FINE: 32}
MODES = 3
Z, BETA = 2, 4


def stiffness(k: float, shear_modulus: complex) -> complex:
    """B(k) times the width [N m²]."""
    t, s = (THICKNESS - LAYER_THICKNESS) / 2, LAYER_THICKNESS
    g = 2 * shear_modulus / (207e9 * t * s * k**2)
    return WIDTH * (207e9 * t**3 / 6 + 207e9 * t * (t + s) ** 2 / 2 * g / (1 + g))


def shear_modulus() -> float:
    """Of the layer [Pa]."""
    return 3e6 / (2 * (1 + 0.49))


def closed_form(number: int) -> float:
    """Frequency [Hz] of mode `number`."""
    k = number * np.pi / LENGTH
    mass = WIDTH * (STEEL.density * (THICKNESS - LAYER_THICKNESS) + LAYER.density * LAYER_THICKNESS)
    return float(k**2 / (2 * np.pi) * np.sqrt(abs(stiffness(k, shear_modulus())) / mass))


def layer_share(number: int) -> float:
    """Share of the strain energy of mode `number` that the layer stores [1]."""
    k, step = number * np.pi / LENGTH, 1e-30
    B = stiffness(k, shear_modulus() * (1 + 1j * step))  # a complex step: the derivative without a difference
    return float(B.imag / B.real / step)


@once
def _modes(mesh: Mesh) -> tuple[Array, Array]:
    """Frequencies [Hz] and the layer's share of the energy of each mode."""
    from scipy.linalg import eigh

    frame = _beam(ELEMENTS[mesh])
    free = _free(frame)
    K, M = sum(frame.stiffness.values(), np.zeros_like(frame.mass))[free], frame.mass[free]
    squares, shapes = eigh(K, M, subset_by_index=[0, MODES - 1])
    stored = np.einsum("ir,ij,jr->r", shapes, frame.stiffness["layer"][free], shapes)
    return np.sqrt(squares) / (2 * np.pi), stored / squares


def _beam(elements: int) -> Frame:
    section = sandwich(WIDTH, THICKNESS, LAYER_THICKNESS, STEEL, LAYER, ("bottom", "layer", "top"))
    nodes, numbers = np.linspace([0, 0, 0], [LENGTH, 0, 0], elements + 1), tuple(range(elements + 1))
    member = Member(nodes=numbers, section=section, z_axis=np.array([0.0, 0.0, 1.0]))
    return assemble(Plan(nodes=nodes, carriers=numbers, members=(member,)))


def _free(frame: Frame) -> tuple[Array, ...]:
    """Deflection but for the ends, rotation in the plane, and every slip."""
    nodes = len(frame.moving)
    bending = [6 * node + dof for node in range(nodes) for dof in (Z, BETA) if dof == BETA or 0 < node < nodes - 1]
    kept = np.array([*bending, *range(6 * nodes, len(frame.mass))])
    return np.ix_(kept, kept)


def _frequency(number: int, mesh: Mesh) -> Found:
    return Found(closed_form(number), float(_modes(mesh)[0][number - 1]))


def _share(number: int, mesh: Mesh) -> Found:
    return Found(layer_share(number), float(_modes(mesh)[1][number - 1]))


SOURCE = "Mead and Markus (1969), simply supported"

CHECKS: tuple[Check, ...] = tuple(
    check
    for k in range(1, MODES + 1)
    for check in (
        Check(
            family=FAMILY,
            what=f"Simply supported sandwich, mode {k}",
            source=f"{SOURCE}; without rotary inertia",
            unit="Hz",
            bar=5e-4,
            find=partial(_frequency, k),
        ),
        Check(
            family=FAMILY,
            what=f"Simply supported sandwich, mode {k}: energy in the layer",
            source=SOURCE,
            unit="",
            bar=2e-3,
            find=partial(_share, k),
        ),
    )
)
