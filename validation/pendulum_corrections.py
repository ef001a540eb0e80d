"""What Eq. 5 and its sisters leave out, as named terms that can be switched one by one.

amplitude  The rope pendulum at any twist φ, ropes of length l on the radius s (exact, no small angles): the feet stand
           ``h(φ) = sqrt(l² - 4 s² sin²(φ/2))`` below the ceiling, so the body rises and moves vertically as it turns,

               potential  V = m g (l - h),      kinetic  ½ (I + m h'²) φ'²,   h' = -s² sin φ / h.

           Energy gives the period as an integral over a quarter swing. With sin(φ/2) = sin(A/2) sin ψ both ends are regular,
           and with ε = s²/l², κ = m s²/I, η = h/l, k = sin(A/2)

               T/T0 = (4/π) ∫_0^{π/2} sqrt((1 + κ ε sin²φ/η²) (η + η_A)/8) / sqrt(1 - k² sin²ψ) dψ
                    = 1 + A² (1/16 - 3 ε/16 + κ ε/4) + O(A⁴).

           For long ropes (ε -> 0) it is the plane pendulum's 2 K(k)/π, which the compound pendulum obeys exactly. Two ropes at
           s1 != s2 also tilt the body at second order; the term then uses s² = s1 s2 and is an approximation. A torsion rod is
           linear in the twist and has no such term. A is the peak amplitude; while it decays, the root mean square of the peaks.
damping    A viscous damping ratio ζ lengthens the period by 1/sqrt(1 - ζ²).
rope-mass  Uniform ropes, M in all, moving as straight lines: they add ``M q / 3`` to the inertia and, since the tension grows
           upwards by their weight, ``M q / 2`` to m s1 s2 (q is the mean square of the radii: s², or (s1² + s2²)/2). The
           two nearly cancel. Terms of order (M/m)² are neglected.

One period is one number: it cannot tell these terms apart, nor show that one is missing. Their sizes are inputs.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np
from uncertainties import UFloat, umath, wrap

from geometry.errors import BadInput
from validation.pendulum import compound_pendulum, rope_pendulum, torsion_pendulum

TERMS = ("amplitude", "damping", "rope-mass")
"""Names of the corrections."""

QUADRATURE_POINTS = 64
"""Midpoints of the quarter swing; the integrand is smooth and periodic, so the error falls exponentially (1e-15 below 2 rad)."""


def require_terms(names: tuple[str, ...]) -> tuple[str, ...]:
    """`names` unchanged; BadInput when one of them is not in `TERMS`."""
    for name in names:
        if name not in TERMS:
            problem = f"no correction is called {name!r}"
            raise BadInput(source="--without", problem=problem, remedy=f"Known are {', '.join(TERMS)}")
    return names


@dataclass(frozen=True, eq=False, kw_only=True)
class Terms:
    """Sizes of the corrections; None leaves a term out.

    Attributes
    ----------
    amplitude : peak twist or swing [rad]
    damping : viscous damping ratio [1]
    rope_mass : mass of all ropes together [kg]
    """

    amplitude: UFloat | None = None
    damping: UFloat | None = None
    rope_mass: UFloat | None = None

    def without(self, name: str) -> Terms:
        """The same with the term `name` of `TERMS` left out."""
        return replace(self, **{name.replace("-", "_"): None})

    @property
    def names(self) -> tuple[str, ...]:
        """The terms that are in."""
        return tuple(name for name in TERMS if getattr(self, name.replace("-", "_")) is not None)


@dataclass(frozen=True, eq=False, kw_only=True)
class RopeSwing:
    """A rope pendulum: mass [kg], gravity [m/s²], radii s1, s2 and rope length [m], measured period [s]."""

    mass: UFloat
    gravity: UFloat
    s1: UFloat
    s2: UFloat
    length: UFloat
    period: UFloat

    def inertia(self, terms: Terms) -> UFloat:
        """Moment of inertia [kg m²] about the vertical through the CoG, with `terms` taken off the period."""
        radius_square = (self.s1**2 + self.s2**2) / 2
        ropes = terms.rope_mass if terms.rope_mass is not None else 0.0
        hanging = self.mass + ropes * radius_square / (2 * self.s1 * self.s2)
        period = _undamped(self.period, terms)
        lengths = {"gravity": self.gravity, "s1": self.s1, "s2": self.s2, "length": self.length}
        total = rope_pendulum(mass=hanging, period=period, **lengths)
        if terms.amplitude is not None:
            total = self._small_amplitude(total, terms.amplitude)
        return total - ropes * radius_square / 3

    def _small_amplitude(self, inertia: UFloat, amplitude: UFloat) -> UFloat:
        # The factor needs the inertia that it corrects: a fixed point, each step a thousand times closer than the last.
        epsilon = self.s1 * self.s2 / self.length**2
        corrected = inertia
        for _ in range(5):
            kappa = self.mass * self.s1 * self.s2 / corrected
            corrected = inertia / wrap(rope_amplitude_factor)(amplitude, epsilon, kappa) ** 2
        return corrected


@dataclass(frozen=True, eq=False, kw_only=True)
class CompoundSwing:
    """A compound pendulum: mass [kg], gravity [m/s²], arm from pivot to CoG [m], measured period [s]."""

    mass: UFloat
    gravity: UFloat
    arm: UFloat
    period: UFloat

    def inertia(self, terms: Terms) -> UFloat:
        """Moment of inertia [kg m²] about the CoG, axis parallel to the pivot, with `terms` taken off the period."""
        period = _undamped(self.period, terms)
        if terms.amplitude is not None:
            period = period / wrap(plane_amplitude_factor)(terms.amplitude)
        return compound_pendulum(mass=self.mass, gravity=self.gravity, arm=self.arm, period=period)


@dataclass(frozen=True, eq=False, kw_only=True)
class TorsionSwing:
    """A torsion-rod pendulum: stiffness of the rod [N m/rad], measured period [s]."""

    stiffness: UFloat
    period: UFloat

    def inertia(self, terms: Terms) -> UFloat:
        """Moment of inertia [kg m²] about the rod's axis, with the damping term taken off the period."""
        return torsion_pendulum(stiffness=self.stiffness, period=_undamped(self.period, terms))


def rope_amplitude_factor(amplitude: float, epsilon: float, kappa: float) -> float:
    """T/T0 of the rope pendulum at peak `amplitude` A [rad]; `epsilon` = s²/l², `kappa` = m s²/I. Equation in the module's head.

    Raises
    ------
    BadInput : an amplitude not below π, or one at which the ropes would cross or lie flat.
    """
    k = np.sin(amplitude / 2)
    if not abs(amplitude) < np.pi or 4 * epsilon * k**2 >= 1:
        problem = f"ropes cannot swing to {amplitude:.4g} rad: they would cross or lie flat"
        raise BadInput(source="rope pendulum", field="amplitude", problem=problem, remedy="Give the peak twist in rad or deg")
    psi = (np.arange(QUADRATURE_POINTS) + 0.5) * np.pi / 2 / QUADRATURE_POINTS
    half_sine = k * np.sin(psi)
    sine = 2 * half_sine * np.sqrt(1 - half_sine**2)
    eta, eta_end = np.sqrt(1 - 4 * epsilon * half_sine**2), np.sqrt(1 - 4 * epsilon * k**2)
    inertia = 1 + kappa * epsilon * sine**2 / eta**2
    return float(2 * np.mean(np.sqrt(inertia * (eta + eta_end) / 8) / np.sqrt(1 - half_sine**2)))


def plane_amplitude_factor(amplitude: float) -> float:
    """T/T0 = 2 K(sin(A/2))/π of a plane (compound) pendulum at peak `amplitude` A [rad], complete elliptic integral."""
    return rope_amplitude_factor(amplitude, 0.0, 0.0)


def _undamped(period: UFloat, terms: Terms) -> UFloat:
    return period if terms.damping is None else period * umath.sqrt(1 - terms.damping**2)
