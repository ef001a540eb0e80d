"""Sizes that several families have in common."""

from __future__ import annotations

from validation.effects.family import Size


def relative(low: float, high: float, plausible: float = 0.0) -> tuple[Size, ...]:
    """One ratio between `low` and `high`."""
    return (Size(unit="1", low=low, high=high, plausible=plausible),)


def resonator(mass: float) -> tuple[Size, ...]:
    """Mass, frequency and damping ratio of a resonator of at most `mass` [kg]."""
    return (
        Size(key="m", unit="kg", low=1e-6, high=mass, plausible=2.0, logarithmic=True),
        Size(key="f", unit="Hz", low=0.01, high=1000.0, plausible=1.0, logarithmic=True),
        Size(key="zeta", unit="1", low=1e-5, high=0.99, plausible=1.0, logarithmic=True),
    )


GAIN = relative(-0.9, 9.0, 0.1)
DELAY = (Size(unit="s", low=-0.1, high=0.1, plausible=500e-6),)
LENGTH = (Size(unit="m", low=-0.5, high=0.5, plausible=0.01),)
ANGLE = (Size(unit="rad", low=-0.5, high=0.5, plausible=0.05),)
SWITCH = (Size(unit="1", low=0.0, high=1.0, default=1.0, whole=True, null=1.0, plausible=1.0),)
TURNING = (Size(unit="rad/(N m)", low=1e-12, high=1e-2, plausible=2e-6),)
SHIFTING = (Size(unit="m/N", low=1e-13, high=1e-3, plausible=1e-8),)
MASS = (Size(unit="kg", low=-1e3, high=1e3, plausible=2.0),)
FIRST = (Size(unit="kg m", low=-1e3, high=1e3, plausible=1.0),)
SECOND = (Size(unit="kg m^2", low=-1e3, high=1e3, plausible=0.5),)
RATIO = relative(-1.0, 1.0, 0.05)
