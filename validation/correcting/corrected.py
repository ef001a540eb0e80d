"""A campaign with one fault of its measurement taken out: of its signals, or of what its channel table says.

The value is the fault, with the sign of the catalogue: `force-gain:fmd-z2=0.08` says that the channel reads 8 % too much, and the
corrected copy holds 1/1.08 of it. What is corrected is exactly what `validation.virtual_test` plants, and nothing is corrected
that a record alone does not tell how to.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.frames import skew
from geometry.sensors import Channel, Place
from identification.campaign import Campaign, Processing
from identification.recording import Recording
from validation.correcting import equation
from validation.correcting.refused import refused
from validation.correcting.signals import Response, advanced, filtered, without_highpass
from validation.effects.identifiers import Named
from validation.effects.targets import AXES

BOARDS = {"force": ("fmd",), "cover": ("cover",), "table": ("table",)}
"""Groups of the channels that a board holds."""

PARALLEL = 1e-9
"""What is less of a direction is rounding."""

HELD = 0.01
"""Of the lowest line, below which the inverse of a high-pass is held back: at that line it is short by 1e-4 of itself."""

LOWEST = 0.1
"""[Hz] of the lowest line, where a campaign says 0."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Corrected:
    """A corrected campaign.

    Attributes
    ----------
    campaign : whole, its notes saying what was corrected
    channels : names of those that changed, in signal or table
    did : what was done to them, in words
    """

    campaign: Campaign
    channels: tuple[str, ...]
    did: str


def corrected(campaign: Campaign, named: Named) -> Corrected:
    """`campaign`, recordings and all, without the fault `named`.

    Raises
    ------
    BadInput : a fault that cannot be taken out of a record, and why; one that nothing of this campaign could have.
    """
    correction = CORRECTIONS.get(named.family, _by_equation if equation.has_inverse(named) else None)
    if correction is None:
        raise refused(named)
    if named.values and all(named.values[size.key] == size.null for size in named.sizes):
        raise _idle(named, "this is the size of no effect")
    found = correction(campaign, named)
    notes = "; ".join(part for part in (campaign.notes, f"corrected: {named} taken out ({found.did})") if part)
    return replace(found, campaign=replace(found.campaign, notes=notes))


def _gain(campaign: Campaign, named: Named) -> Corrected:
    return _scaled(campaign, {named.target: 1 / (1 + named.value)}, noise=True)


def _unit(campaign: Campaign, named: Named) -> Corrected:
    return _scaled(campaign, {named.target: 1 / named.value})


def _polarity(campaign: Campaign, named: Named) -> Corrected:
    return replace(_scaled(campaign, {named.target: -1.0}), did="its sign is turned")


def _shunt(campaign: Campaign, named: Named) -> Corrected:
    axis = np.eye(3)[AXES.index(named.target)]
    shares = {
        campaign.table.names[k]: _along(campaign.table.channels[k], axis, named) for k in campaign.table.select(group="fmd")
    }
    factors = {name: 1 / (1 - named.value * share) for name, share in shares.items() if share > PARALLEL}
    if not factors:
        raise _idle(named, f"no load cell measures along {named.target}")
    return _scaled(campaign, factors, noise=True)


def _along(channel: Channel, axis: Array, named: Named) -> float:
    """How much of what `channel` reads is force along `axis`: the same for all of its cells, or nobody can take it apart."""
    shares = [float(place.direction @ axis) ** 2 for place in channel.places]
    if channel.quantity == "moment":
        problem = f"{channel.name} is a moment, and how much of it passed the cells by is not known"
        raise BadInput(source=named.id, problem=problem, remedy="Give the cells' own channels, or add the effect to the model")
    if np.ptp(shares) > PARALLEL:
        problem = f"{channel.name} adds up cells of several directions, which lost different shares"
        raise BadInput(source=named.id, problem=problem, remedy="Give the cells' own channels, or add the effect to the model")
    return shares[0]


def _scaled(campaign: Campaign, factors: Mapping[str, float], *, noise: bool = False) -> Corrected:
    """Channels times `factors`; `noise` takes the stated noise floor, which was that of the record, along."""
    by = np.array([factors.get(name, 1.0) for name in campaign.table.names])
    made = _recorded(campaign, lambda recording: replace(recording, values=recording.values * by))
    if noise:
        made = _tabled(
            made, factors, lambda c: replace(c, noise_rms=None if c.noise_rms is None else c.noise_rms * factors[c.name])
        )
    one = {f"{factor:.6g}" for factor in factors.values()}
    return Corrected(campaign=made, channels=tuple(factors), did=f"multiplied by {', '.join(sorted(one))}")


def _swap(campaign: Campaign, named: Named) -> Corrected:
    order = list(range(len(campaign.table)))
    one, other = (campaign.table.names.index(name) for name in named.targets)
    order[one], order[other] = other, one
    made = _recorded(campaign, lambda recording: replace(recording, values=recording.values[:, order]))
    return Corrected(campaign=made, channels=named.targets, did="what each of them measured stands under its own name")


def _delay(campaign: Campaign, named: Named) -> Corrected:
    return _filtered(campaign, [named.target], advanced(named.value), f"shifted by {-1e6 * named.value:.6g} us")


def _board(campaign: Campaign, named: Named) -> Corrected:
    names = [campaign.table.names[k] for k in campaign.table.select(group=BOARDS[named.target])]
    if not names:
        raise _idle(named, f"it has no channel of the group {BOARDS[named.target][0]}")
    return _filtered(campaign, names, advanced(named.value), f"shifted by {-1e6 * named.value:.6g} us")


def _highpass(campaign: Campaign, named: Named) -> Corrected:
    held, column = _held(campaign), campaign.table.names.index(named.target)

    def raised(recording: Recording) -> Recording:
        return filtered(recording, [column], without_highpass(named.value, 0.0 if recording.is_spectrum else held))

    did = f"the corner of {named.value:g} Hz taken out, of time histories from {10 * held:.3g} Hz up"
    return Corrected(campaign=_recorded(campaign, raised), channels=(named.target,), did=did)


def _by_equation(campaign: Campaign, named: Named) -> Corrected:
    """A family of the user's own."""
    names, held = campaign.table.names, _held(campaign)
    changed, chosen = equation.touched(named, names, np.array([100 * held, 1000 * held]))
    if not changed:
        raise _idle(named, "its equation changes no channel")
    made = _recorded(campaign, lambda one: filtered(one, chosen, equation.inverse(named, names, chosen, held)))
    return Corrected(campaign=made, channels=tuple(names[k] for k in changed), did="the inverse of its equation")


def _held(campaign: Campaign) -> float:
    """[Hz], below which an inverse that grows is held back."""
    return HELD * max((campaign.processing or Processing()).start, LOWEST)


def _filtered(campaign: Campaign, names: Sequence[str], response: Response, did: str) -> Corrected:
    columns = [campaign.table.names.index(name) for name in names]
    made = _recorded(campaign, lambda recording: filtered(recording, columns, response))
    return Corrected(campaign=made, channels=tuple(names), did=did)


def _position(campaign: Campaign, named: Named) -> Corrected:
    shift = named.value * np.eye(3)[AXES.index(named.targets[1])]
    return _placed(campaign, named, lambda place: replace(place, position=place.position + shift), "its place")


def _misalignment(campaign: Campaign, named: Named) -> Corrected:
    turn = _rotation(named.value, np.eye(3)[AXES.index(named.targets[1])])
    made = _placed(campaign, named, lambda place: replace(place, direction=turn @ place.direction), "its direction")
    pairs = zip(_channel(campaign, named).places, _channel(made.campaign, named).places, strict=True)
    if named.value and all(np.abs(a.direction - b.direction).max() < PARALLEL * abs(named.value) for a, b in pairs):
        raise _idle(named, f"a turn about {named.targets[1]}, along which it measures, changes nothing of what it reads")
    return made


def _placed(campaign: Campaign, named: Named, change: Callable[[Place], Place], what: str) -> Corrected:
    made = _tabled(campaign, [named.target], lambda c: replace(c, places=tuple(map(change, c.places))))
    return Corrected(campaign=made, channels=(named.target,), did=f"{what} in the channel table is the true one")


def _rotation(angle: float, axis: Array) -> Array:
    """(3, 3) by `angle` [rad] about the unit vector `axis` (Rodrigues)."""
    S = skew(axis)
    return np.asarray(np.eye(3) + np.sin(angle) * S + (1 - np.cos(angle)) * S @ S)


def _channel(campaign: Campaign, named: Named) -> Channel:
    return campaign.table.channels[campaign.table.names.index(named.target)]


def _recorded(campaign: Campaign, change: Callable[[Recording], Recording]) -> Campaign:
    return replace(campaign, recordings={name: change(one) for name, one in campaign.recordings.items()})


def _tabled(campaign: Campaign, names: Sequence[str] | Mapping[str, float], change: Callable[[Channel], Channel]) -> Campaign:
    channels = tuple(change(channel) if channel.name in names else channel for channel in campaign.table.channels)
    return replace(campaign, table=replace(campaign.table, channels=channels))


def _idle(named: Named, why: str) -> BadInput:
    return BadInput(source=named.id, problem=f"there is nothing to correct: {why}", remedy="Check the target")


CORRECTIONS: Mapping[str, Callable[[Campaign, Named], Corrected]] = {
    "force-gain": _gain,
    "accelerometer-gain": _gain,
    "load-path-shunt": _shunt,
    "unit": _unit,
    "polarity": _polarity,
    "channel-swap": _swap,
    "force-delay": _delay,
    "accelerometer-delay": _delay,
    "board-delay": _board,
    "force-highpass": _highpass,
    "accelerometer-position": _position,
    "accelerometer-misalignment": _misalignment,
}
"""What can be taken out of a record, by family."""
