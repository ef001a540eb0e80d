"""Rows about the rope pendulum: exudyn's body on ropes, its record reduced as a measured one, held against closed forms."""

from __future__ import annotations

from functools import partial

import numpy as np

from fem.flexible_body.rope_pendulum import STANDARD_GRAVITY, Suspension, on_three_ropes, on_two_ropes, swing
from geometry.inertia import Inertia
from validation.pendulum import rope_pendulum
from validation.pendulum_corrections import rope_amplitude_factor
from validation.period import from_signal
from validation.verification.check import Check, Error, Found, Mesh, once

FAMILY = "Rope pendulum"

BODY = Inertia.from_cog(47.23, np.zeros(3), np.diag([20.144, 20.410, 2.289]))
MASS, ABOUT_Z = 47.23, 2.289
"""[kg] and [kg m²] of `BODY`: Clumod with four blades, as printed in the paper's Table 1."""

LENGTH, RADIUS, S1, S2 = 2.0, 0.3, 0.2, 0.45
"""Of ropes, of the circle of three, and to either side of the CoG of two [m]."""

SMALL = 1e-3
"""Amplitude [rad] that is none: it lengthens the period by 7e-8."""

CYCLES = 8
LINKS = {Mesh.FAST: 8, Mesh.FINE: 16}
ROPES = 0.3
"""Mass of all ropes [kg]."""


def period(s1: float, s2: float) -> float:
    """T [s] of small swings by Eq. 5."""
    unit = rope_pendulum(mass=MASS, gravity=STANDARD_GRAVITY, s1=s1, s2=s2, length=LENGTH, period=1.0)
    return float(np.sqrt(ABOUT_Z / unit))


@once
def recorded(hangs: Suspension, s1: float = RADIUS, s2: float = RADIUS) -> float:
    """T [s] from the record of a few cycles."""
    run = swing(BODY, hangs, duration=CYCLES * period(s1, s2), rate=100 / period(s1, s2))
    return float(from_signal(run.time, run.yaw, "verification").period.nominal_value)


def _small(ropes: int, mesh: Mesh) -> Found:
    if ropes == 2:
        return Found(period(S1, S2), recorded(on_two_ropes(S1, S2, length=LENGTH, amplitude=SMALL), S1, S2))
    return Found(period(RADIUS, RADIUS), recorded(on_three_ropes(RADIUS, length=LENGTH, amplitude=SMALL)))


def _shift(expected: float, hangs: Suspension) -> Found:
    """Both as a share of the period of Eq. 5, in per cent."""
    return Found(100 * expected, 100 * (recorded(hangs) / period(RADIUS, RADIUS) - 1))


def _amplitude(angle: float, mesh: Mesh) -> Found:
    factor = rope_amplitude_factor(angle, (RADIUS / LENGTH) ** 2, MASS * RADIUS**2 / ABOUT_Z)
    return _shift(factor - 1, on_three_ropes(RADIUS, length=LENGTH, amplitude=angle))


def _damping(ratio: float, mesh: Mesh) -> Found:
    return _shift(1 / np.sqrt(1 - ratio**2) - 1, on_three_ropes(RADIUS, length=LENGTH, amplitude=SMALL, damping_ratio=ratio))


def _rope_mass(mesh: Mesh) -> Found:
    """Uniform ropes: a third of their mass swings with the feet, half of it presses them down."""
    expected = np.sqrt((1 + ROPES * RADIUS**2 / (3 * ABOUT_Z)) / (1 + ROPES / (2 * MASS))) - 1
    hangs = on_three_ropes(RADIUS, length=LENGTH, amplitude=SMALL, rope_mass=ROPES, links=LINKS[mesh])
    return _shift(float(expected), hangs)


_EQ5 = "Eq. 5, T = 2 pi sqrt(I l / (m g s1 s2))"

CHECKS: tuple[Check, ...] = (
    *(
        Check(family=FAMILY, what=f"Period on {words}", source=_EQ5, unit="s", bar=1e-5, find=partial(_small, ropes))
        for ropes, words in ((2, "two ropes, s1 and s2 unequal"), (3, "three ropes"))
    ),
    *(
        Check(
            family=FAMILY,
            what=f"Amplitude {angle:g} rad: period longer by",
            source="energy integral over a quarter swing",
            unit="%",
            bar=2e-3,
            error=Error.ABSOLUTE,
            find=partial(_amplitude, angle),
        )
        for angle in (0.1, 0.2)
    ),
    Check(
        family=FAMILY,
        what="Damping 5 %: period longer by",
        source="1 / sqrt(1 - zeta²)",
        unit="%",
        bar=2e-3,
        error=Error.ABSOLUTE,
        find=partial(_damping, 0.05),
    ),
    Check(
        family=FAMILY,
        what="Ropes of 0.3 kg in all: period longer by",
        source="uniform straight ropes: M s²/3 more inertia, M/2 more weight",
        unit="%",
        bar=3e-3,
        error=Error.ABSOLUTE,
        find=_rope_mass,
    ),
)
