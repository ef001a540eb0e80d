"""Effects that are another measurement chain than the drawn one: gains, delays, places, angles, load cells, gravity, noise.

Each adds to what the seed has drawn, so that a fault of 5 % makes of a channel that reads 1.002 one that reads 1.002 x 1.05.
"""

from __future__ import annotations

from collections.abc import Callable
from dataclasses import replace

import numpy as np

from validation.effects.identifiers import Named
from validation.effects.targets import AXES, COVER, FMD, TABLE
from validation.virtual_test.chain_truth import ChainTruth
from validation.virtual_test.plan import MAINS

Change = Callable[[ChainTruth], ChainTruth]

BOARDS = {"force": FMD, "cover": COVER, "table": TABLE}
"""Channels that are sampled together, by the name of their board."""

COMPLIANT = ("lateral", "vertical")


def gain(named: Named) -> Change:
    """``y (1 + g)``"""
    return lambda chain: chain.more_gain(named.target, named.value)


def polarity(named: Named) -> Change:
    """``-y``"""
    return lambda chain: chain.more_gain(named.target, -2.0)


def shunt(named: Named) -> Change:
    """Every channel along an axis reads ``y (1 - s)``: the share s passes all of its cells by."""
    return lambda chain: _each(chain, along(named.target), lambda one, name: one.more_gain(name, -named.value))


def delay(named: Named) -> Change:
    """``y(t - tau)``"""
    return lambda chain: chain.later(named.target, named.value)


def board_delay(named: Named) -> Change:
    """The same for all channels of a board."""
    return lambda chain: _each(chain, BOARDS[named.target], lambda one, name: one.later(name, named.value))


def crosstalk(named: Named) -> Change:
    """``X = I + kappa E_ij``: of ``zx``, kappa F_x shows in the channels along z."""
    shown, source = (AXES.index(axis) for axis in named.target)

    def change(chain: ChainTruth) -> ChainTruth:
        changed = np.array(chain.crosstalk)
        changed[shown, source] += named.value
        return replace(chain, crosstalk=changed)

    return change


def plane_offset(named: Named) -> Change:
    """``M_y -= h F_x``, or ``M_x += h F_y``: moments of the cells that they do not measure."""
    return lambda chain: replace(chain, plane_offset=chain.plane_offset + named.value * _unit(named.target, ("x", "y")))


def compliance(named: Named) -> Change:
    """All cells give so many times as much."""
    return lambda chain: replace(chain, compliance=chain.compliance * (1 + (named.value - 1) * _unit(named.target, COMPLIANT)))


def cell_stiffness(named: Named) -> Change:
    """``k (1 + v)`` of one cell along one axis: it takes load from the other three, and none is lost."""
    cell, axis = int(named.target[0]) - 1, AXES.index(named.target[1])
    return lambda chain: chain.stiffer(cell, axis, named.value)


def position(named: Named) -> Change:
    """``d^T [G](p + dp)``"""
    return lambda chain: chain.moved(named.target, named.value * _unit(named.targets[1], AXES))


def misalignment(named: Named) -> Change:
    """``(d + dd)^T [G]``, dd = v e x d: the pick-up is turned by v about the axis e."""
    return lambda chain: chain.turned(named.target, named.value * _unit(named.targets[1], AXES))


def gravity(named: Named) -> Change:
    """The structure's half of gravity: loads are those of the apparent acceleration, or of the kinematic one."""
    return lambda chain: replace(chain, gravity=named.value)


def tilt(named: Named) -> Change:
    """The sensors' half: accelerometers read a tilt, or nothing but motion."""
    return lambda chain: replace(chain, accelerometer_tilt=named.value)


def noise(named: Named) -> Change:
    """More noise, independent of what there is: variances add."""

    def change(chain: ChainTruth) -> ChainTruth:
        before = chain.noise_rms.get(named.target, 0.0)
        return replace(chain, noise_rms={**chain.noise_rms, named.target: float(np.hypot(before, named.value))})

    return change


def mains(named: Named) -> Change:
    """So many times the ordinary hum in every channel, instead of what there is."""
    ordinary = dict.fromkeys((*TABLE, *COVER), MAINS["acceleration"]) | dict.fromkeys(FMD, MAINS["force"])
    return lambda chain: replace(chain, mains={name: named.value * size for name, size in ordinary.items()})


def along(axis: str) -> tuple[str, ...]:
    """The force channels along `axis`."""
    return tuple(name for name in FMD if name.startswith(f"fmd-{axis}"))


def _each(chain: ChainTruth, names: tuple[str, ...], change: Callable[[ChainTruth, str], ChainTruth]) -> ChainTruth:
    for name in names:
        chain = change(chain, name)
    return chain


def _unit(word: str, words: tuple[str, ...]) -> np.ndarray:
    return np.array([float(one == word) for one in words])
