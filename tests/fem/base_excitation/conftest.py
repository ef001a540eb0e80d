"""What tests of base excitation share: short smooth drives, Clumod's bodies, and an FMD with cells and a flange."""

from collections.abc import Callable
from functools import cache

import numpy as np
import pytest

from fem.base_excitation import rig
from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import Flange, FlexibleBody, LoadCell, Rig
from fem.beam import articles
from fem.damping import Damping
from fem.modes import fixed_base
from geometry.inertia import Inertia

CORNERS = ((0.12, 0.12), (-0.12, 0.12), (-0.12, -0.12), (0.12, -0.12))


@pytest.fixture(scope="session")
def burst() -> Callable[..., BaseMotion]:
    """``burst(rate, weights, ring_down)``: a Gaussian burst about 16 Hz, the six axes weighted, derivatives exact."""
    return _burst


def _burst(
    rate: float, weights: np.ndarray, ring_down: float = 5.0, *, frequency: float = 16.0, width: float = 0.03
) -> BaseMotion:
    driven = 20 * width
    t = np.arange(round((driven + ring_down) * rate) + 1) / rate
    u = np.exp(-(((t - driven / 2) / width) ** 2) / 2) * np.sin(2 * np.pi * frequency * (t - driven / 2))
    iw = 2j * np.pi * np.fft.rfftfreq(len(t), 1 / rate)
    v, a = (np.fft.irfft(iw**k * np.fft.rfft(u), len(t)) for k in (1, 2))
    u, v, a = (np.outer(x, weights) / np.abs(a).max() for x in (u, v, a))
    return BaseMotion(sampling_rate=rate, displacement=u, velocity=v, acceleration=a, driven=driven)


@pytest.fixture(scope="session")
def clumod() -> Callable[[str], FlexibleBody]:
    """``clumod(name)``: 30 modes at 3 % damping, which is over in seconds, and a place at the top of the mast."""
    return cache(_clumod)


def _clumod(name: str) -> FlexibleBody:
    structure = articles.structure(name)
    modes = fixed_base(structure, 30, damping=Damping(ratio=0.03))
    return rig.flexible(name, structure, modes, places={"top": [0.0, 0.0, 1.6]})


@pytest.fixture(scope="session")
def rigid_block() -> FlexibleBody:
    """A rigid block with its CoG off all axes."""
    inertia = Inertia.from_cog(7.0, [0.02, -0.03, 0.2], np.array([[0.3, 0.01, 0.02], [0.01, 0.25, -0.03], [0.02, -0.03, 0.1]]))
    return rig.rigid("block", inertia, {"top": [0.1, 0.05, 0.4]})


@pytest.fixture(scope="session")
def mounted() -> Callable[..., Rig]:
    """``mounted(article)``: on an FMD with four cells and a flange that gives in two directions."""
    return _mounted


def _mounted(article: FlexibleBody, *, softer: float = 1.0, preload: float | None = None) -> Rig:
    stiffness = np.array([4e8, 4e8, 2e9]) / softer
    cells = tuple(
        LoadCell(position=np.array([x, y, 0.01]), stiffness=stiffness, damping=2e-5 * stiffness, preload=preload)
        for x, y in CORNERS
    )
    return Rig(
        article=article,
        cover=Inertia.from_cog(20.0, [0.01, 0.0, 0.02], np.diag([0.3, 0.3, 0.5])),
        seat=np.array([0.01, -0.02, 0.0445]),
        cells=cells,
        flange=Flange(compliance=np.array([0, 0, 0, 1e-6, 2e-6, 0]), damping_time=2e-5),
    )
