"""`Effect`: what is different from an ordinary laboratory, as changes at five places of a virtual test.

    chain     the drawn measurement chain, before anything is computed
    parts     what was drawn for the parts of the structure
    rig       what stands on the table, before it is driven
    signals   what the sensors read, at the rate of the simulation: before delays, anti-alias filter and noise
    record    what the recorder got, at its own rate: noise and mains are in, and units are what the file will say

An effect leaves alone what it does not name. Several act in their order, each on what the one before left.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, TypeVar

import numpy as np

from fem.base_excitation.response import Response
from fem.base_excitation.rig import Rig
from geometry.arrays import Array
from geometry.sensors import ChannelTable
from validation.virtual_test.chain_truth import ChainTruth

if TYPE_CHECKING:
    from validation.virtual_test.drawn import Part

T = TypeVar("T")


def same(value: T) -> T:
    """What an effect does where it does nothing."""
    return value


@dataclass(frozen=True, eq=False, kw_only=True)
class Sensed:
    """All channels of one run.

    Attributes
    ----------
    values : (n, c) in the order of `table`, SI; an effect returns another array and never writes into this one
    table : the nominal channels, as in the file
    sampling_rate : [Hz]
    run : name of the run
    level : at which it was driven, as a factor on the nominal one
    response : what table, cover plate and cells really did, at the rate of the simulation; None for what was recorded
    generator : of whatever the effect draws, the run's own
    """

    values: Array
    table: ChannelTable
    sampling_rate: float
    run: str
    level: float
    response: Response | None
    generator: np.random.Generator

    def column(self, channel: str) -> int:
        """Where `channel` stands in `values`."""
        return self.table.names.index(channel)


@dataclass(frozen=True, eq=False, kw_only=True)
class Effect:
    """One effect; see the head of this file.

    Attributes
    ----------
    id : as in the catalogue
    value : its size in SI by key; `""` is the key of an effect that takes one number
    chain, parts, rig, signals, record : the changes
    """

    id: str
    value: Mapping[str, float] = field(default_factory=dict)
    chain: Callable[[ChainTruth], ChainTruth] = same
    parts: Callable[[Mapping[str, Part]], Mapping[str, Part]] = same
    rig: Callable[[Rig], Rig] = same
    signals: Callable[[Sensed], Sensed] = same
    record: Callable[[Sensed], Sensed] = same


def changed_chain(chain: ChainTruth, effects: Sequence[Effect]) -> ChainTruth:
    """`chain` after all `effects`."""
    for effect in effects:
        chain = effect.chain(chain)
    return chain


def changed_parts(parts: Mapping[str, Part], effects: Sequence[Effect]) -> dict[str, Part]:
    """`parts` of the structure after all `effects`."""
    for effect in effects:
        parts = effect.parts(parts)
    return dict(parts)


def changed_rig(rig: Rig, effects: Sequence[Effect]) -> Rig:
    """`rig` after all `effects`."""
    for effect in effects:
        rig = effect.rig(rig)
    return rig


def changed_signals(sensed: Sensed, effects: Sequence[Effect]) -> Sensed:
    """What the sensors read after all `effects`."""
    for effect in effects:
        sensed = effect.signals(sensed)
    return sensed


def changed_record(sensed: Sensed, effects: Sequence[Effect]) -> Sensed:
    """What was recorded after all `effects`."""
    for effect in effects:
        sensed = effect.record(sensed)
    return sensed
