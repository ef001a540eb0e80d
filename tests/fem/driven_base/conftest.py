"""Base motions in closed form, a rigid block, a cover plate and its cells."""

from __future__ import annotations

from collections.abc import Callable, Sequence

import numpy as np
import pytest

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import FlexibleBody, LoadCell, rigid
from fem.modes import Reduced
from geometry.frames import rigid_transformation
from geometry.inertia import Inertia

Shake = Callable[..., BaseMotion]


@pytest.fixture(scope="session")
def shake(smooth: Callable[..., BaseMotion]) -> Shake:
    """`smooth` by the amplitudes (6,) of its acceleration."""

    def made(axes: Sequence[float], *, frequency: float = 12.0, seconds: float = 0.5, rate: float = 4096.0) -> BaseMotion:
        omega = 2 * np.pi * frequency
        return smooth(-np.asarray(axes) / omega**2, np.full(6, omega), seconds, rate, rise=seconds / 3)

    return made


@pytest.fixture(scope="session")
def inertia() -> Inertia:
    """A block with its CoG off all axes and with products of inertia."""
    tensor = [[0.5, 0.05, -0.03], [0.05, 0.7, 0.02], [-0.03, 0.02, 0.9]]
    return Inertia.from_cog(20.0, [0.02, -0.03, 0.1], tensor)


@pytest.fixture(scope="session")
def block(inertia: Inertia) -> FlexibleBody:
    """The block as an article without a mode."""
    return rigid("block", inertia, {"corner": [0.1, 0.2, 0.3]})


@pytest.fixture(scope="session")
def cover() -> Inertia:
    """The moving part of an FMD about F."""
    return Inertia.from_cog(10.0, [0.005, -0.01, 0.03], [[0.2, 0.01, -0.01], [0.01, 0.25, 0.01], [-0.01, 0.01, 0.4]])


@pytest.fixture(scope="session")
def cells() -> tuple[LoadCell, ...]:
    """Four cells, so stiff that the block swings on them above 400 Hz."""
    corners = ((0.12, 0.12), (-0.12, 0.12), (-0.12, -0.12), (0.12, -0.12))
    return tuple(LoadCell(position=[x, y, 0.0], stiffness=[2e8, 2e8, 4e8], damping=[2e3] * 3) for x, y in corners)


@pytest.fixture(scope="session")
def reed(inertia: Inertia) -> Callable[..., FlexibleBody]:
    """The block with one mode: an oscillator at its tip that moves along x."""

    def made(frequency: float, ratio: float) -> FlexibleBody:
        L, omega = np.array([2.0, 0.1, 0.1, 0.1, -1.0, 0.2]), 2 * np.pi * frequency
        M, K, C = np.eye(7), np.zeros((7, 7)), np.zeros((7, 7))
        M[:6, :6], M[6, :6], M[:6, 6] = inertia.mass_matrix, L, L
        K[6, 6], C[6, 6] = omega**2, 2 * ratio * omega
        reduced = Reduced(stiffness=K, mass=M, viscous=C, structural=np.zeros((7, 7)), basis=np.eye(7))
        tip = np.hstack([rigid_transformation([0.1, 0.2, 0.3]), [[0.3], [0.1], [0.0]]])
        return FlexibleBody(name="reed", reduced=reduced, kept=np.array([frequency]), places={"tip": tip})

    return made
