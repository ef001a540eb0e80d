"""How a leftover may go with frequency: the few ways in which physics does.

Of a pair of axes the course is that of its entry of the dynamic mass, dH = a c(omega); of a channel that of the share of its
reading, dy = a c(omega) y. Coefficients a are real: a spring is no damper.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray

STIFFNESS, MASS, DAMPING, RESONANCE, DELAY, GAIN, TILT, NOISE, IRREGULAR = LIKENESSES = (
    *("stiffness", "mass", "damping", "resonance", "delay", "gain", "tilt", "noise", "irregular"),
)
"""What a leftover can look like."""

REFERENCE = 10.0
"""[Hz] at which shares are stated that change with frequency."""

FREQUENCIES, RATIOS = 36, (0.004, 0.015, 0.05)
"""Resonances that are tried: so many frequencies over the band, and damping ratios."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Course:
    """One way to go.

    Attributes
    ----------
    looks_like : of `LIKENESSES`
    text : in words, to follow "it" or "a share that"
    of : values (m,) complex at omega (m,) [rad/s]
    unit : of the coefficient of a translation with a translation, or of a channel
    frequency, ratio : of a resonance
    stated : whether the coefficient means something by itself
    """

    looks_like: str
    text: str
    of: Callable[[Array], ComplexArray]
    unit: str = "1"
    frequency: float | None = None
    ratio: float | None = None
    stated: bool = True


def _power(factor: complex, power: float, per: float = 1.0) -> Callable[[Array], ComplexArray]:
    return lambda omega: factor * np.asarray(omega / per, dtype=np.complex128) ** power


AT = 2 * np.pi * REFERENCE

OF_PAIRS = (
    Course(looks_like=MASS, text="is constant over frequency", of=_power(1, 0), unit="kg"),
    Course(looks_like=STIFFNESS, text="falls with the square of frequency, as that of a spring", of=_power(-1, -2), unit="N/m"),
    Course(looks_like=DAMPING, text="falls with frequency and is out of phase, as of a damper", of=_power(-1j, -1), unit="N s/m"),
    Course(
        looks_like=STIFFNESS,
        text="grows with the square of frequency, as of something that gives",
        of=_power(1, 2, AT),
        unit="kg",
        stated=False,
    ),
    Course(
        looks_like=DAMPING,
        text="is constant over frequency and out of phase, as of a loss",
        of=_power(-1j, 0),
        unit="kg",
        stated=False,
    ),
    Course(
        looks_like=DELAY,
        text="grows with frequency and is out of phase, as of a delay",
        of=_power(-1j, 1, AT),
        unit="kg",
        stated=False,
    ),
)
"""Of an entry of the dynamic mass."""

OF_SHARES = (
    Course(looks_like=GAIN, text="a gain", of=_power(1, 0)),
    Course(looks_like=DELAY, text="a delay", of=_power(-1j, 1), unit="s"),
    Course(looks_like=GAIN, text="a gain that grows with the square of frequency", of=_power(1, 2, AT)),
    Course(looks_like=GAIN, text="a gain that falls with the square of frequency", of=_power(1, -2, AT)),
    Course(looks_like=GAIN, text="a share that falls with frequency, as of a high-pass", of=_power(1j, -1, AT)),
    Course(looks_like=GAIN, text="a turned phase, the same at all frequencies", of=_power(1j, 0)),
    Course(looks_like=GAIN, text="a gain that drifts along the sweep", of=lambda w: np.log(w / AT).astype(np.complex128)),
    Course(looks_like=DELAY, text="a delay that grows along the sweep", of=lambda w: -1j * w * np.log(w / w[0]), unit="s"),
)
"""Of the share of a reading."""

OF_PARTS = (
    Course(looks_like="", text="as much as it may differ at all frequencies", of=_power(1, 0)),
    Course(looks_like="", text="the more the higher the frequency", of=_power(1, 1, AT)),
    Course(looks_like="", text="the more the lower the frequency", of=_power(1, -1, AT)),
    Course(looks_like=DAMPING, text="out of phase, as of a loss", of=_power(1j, 0)),
    Course(looks_like=DAMPING, text="out of phase and growing with frequency, as of a damper", of=_power(1j, 1, AT)),
)
"""Of a part whose stiffness or loss is not what the model says; what it looks like is said by the part."""

OF_PLACES = (
    Course(looks_like=MASS, text="a mass", of=_power(1, 0), unit="kg"),
    Course(looks_like=STIFFNESS, text="a spring", of=_power(-1, -2), unit="N/m"),
    Course(looks_like=DAMPING, text="a damper", of=_power(-1j, -1), unit="N s/m"),
)
"""Of what a place of the article is loaded with."""

OF_JOINTS = (
    Course(looks_like=STIFFNESS, text="a compliance", of=_power(1, 2), unit="m/N"),
    Course(looks_like=DAMPING, text="a compliance that is out of phase, as of a loss", of=_power(-1j, 2), unit="m/N"),
)
"""Of what lies between cover plate and article."""

TILTING = Course(looks_like=TILT, text="gravity that a tilt adds", of=_power(1, -2), unit="m/s^2")
"""Of accelerometers that tilt with what they sit on: they read it once too often, or not at all."""

HEARD_PLAINLY = Course(looks_like=GAIN, text="the same share at all frequencies", of=_power(1, 0))
HEARD_FALLING = Course(
    looks_like=TILT, text="falls with the square of frequency, as gravity on a tilting sensor", of=_power(1, -2)
)


def resonances(omega: Array) -> tuple[Course, ...]:
    """Resonances within the band of `omega` (m,), ``omega² / (omega_0² - omega² + 2 i zeta omega_0 omega)``."""
    low, high = omega[0] / (2 * np.pi), omega[-1] / (2 * np.pi)
    return tuple(resonance(float(f), zeta) for f in np.geomspace(low, high, FREQUENCIES) for zeta in RATIOS)


def resonance(frequency: float, ratio: float) -> Course:
    """The one at `frequency` [Hz] with damping `ratio`."""
    own = 2 * np.pi * frequency
    return Course(
        looks_like=RESONANCE,
        text=f"a resonance at {frequency:.3g} Hz",
        of=lambda w: np.asarray(w**2 / (own**2 - w**2 + 2j * ratio * own * w), dtype=np.complex128),
        unit="kg",
        frequency=frequency,
        ratio=ratio,
    )
