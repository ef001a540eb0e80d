"""Can the six base motions and the six resultants be told from the channels, how well, and what is missing by name?"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from geometry.sensors import Channel, ChannelTable, motion_rows, resultants, summation

LOADS = ("f_x", "f_y", "f_z", "t_x", "t_y", "t_z")
"""The six resultants, in the order of `MOTIONS`."""

LOST = 1e-6
"""Relative singular value below which nothing is observed: a lever arm of a micrometre, whatever was typed."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Observability:
    """The verdict on one set of channels.

    Attributes
    ----------
    channels : names of those that take part
    rank : how many of the six are told apart
    condition : largest over smallest singular value of the transformation [1], rotations or moments scaled by `lever`; infinite
        where the rank is below six
    lever : [m] root mean square distance of the places from the reference point, 1 where they all lie on it
    missing : names of what cannot be told, none when all six can
    text : the verdict in words
    """

    channels: tuple[str, ...]
    rank: int
    condition: float
    lever: float
    missing: tuple[str, ...]
    text: str

    @property
    def complete(self) -> bool:
        """Whether all six are observed."""
        return self.rank == 6


def of_motions(table: ChannelTable, groups: Sequence[str]) -> Observability:
    """The six motions of the reference point from the accelerometers of `groups`, taken for one rigid body (Eq. 7)."""
    channels = _chosen(table, groups, ("acceleration",))
    return _judged(channels, motion_rows(channels, table.origin), MOTIONS, _lever(table, channels), lost=())


def of_resultants(table: ChannelTable, groups: Sequence[str] = ("fmd",)) -> Observability:
    """The six resultants about the reference point from the force and moment channels of `groups`.

    What a summation box adds up off one line of action is lost, too, and is named.
    """
    channels = _chosen(table, groups, ("force", "moment"))
    lever = _lever(table, channels)
    return _judged(channels, resultants(channels, table.origin).T, LOADS, lever, _lost_in_sums(table, channels, lever))


def _chosen(table: ChannelTable, groups: Sequence[str], quantities: Sequence[str]) -> list[Channel]:
    return [table.channels[k] for k in table.select(group=tuple(groups), quantity=tuple(quantities))]


def _lever(table: ChannelTable, channels: Sequence[Channel]) -> float:
    places = [place.position - table.origin for channel in channels for place in channel.places]
    length = float(np.sqrt(np.mean(np.sum(np.square(places), axis=1)))) if places else 0.0
    return length or 1.0


def _lost_in_sums(table: ChannelTable, channels: Sequence[Channel], lever: float) -> tuple[str, ...]:
    """Resultants that depend on how the cells of one channel share its reading."""
    if not channels:
        return ()
    of = summation(channels, table.origin)
    scale = np.array([1, 1, 1, lever, lever, lever])
    left = np.abs(of.gives - resultants(channels, table.origin) @ of.adds).max(axis=1) / scale
    return tuple(name for name, size in zip(LOADS, left, strict=True) if size > LOST)


def _judged(channels: Sequence[Channel], rows: Array, names: Sequence[str], lever: float, lost: tuple[str, ...]) -> Observability:
    scale = np.array([1, 1, 1, lever, lever, lever])
    _, singular, Vt = np.linalg.svd(np.vstack([rows / scale, np.zeros((6, 6))]), full_matrices=False)
    rank = int(np.sum(singular > LOST * max(float(singular[0]), np.finfo(np.float64).tiny)))
    null = Vt[rank:]
    share = np.linalg.norm(null, axis=0)
    missing = dict.fromkeys([*lost, *(name for name, part in zip(names, share, strict=True) if part > 1e-3)])
    rank -= len([name for name in lost if share[list(names).index(name)] <= 1e-3])
    condition = float(singular[0] / singular[-1]) if rank == 6 else float("inf")
    in_order = tuple(name for name in names if name in missing)
    return Observability(
        channels=tuple(channel.name for channel in channels),
        rank=rank,
        condition=condition,
        lever=lever,
        missing=in_order,
        text=_words(rank, condition, in_order, null / scale, names, lost),
    )


def _words(
    rank: int, condition: float, missing: tuple[str, ...], null: Array, names: Sequence[str], lost: tuple[str, ...]
) -> str:
    if rank == 6:
        return f"all six are told apart, condition {condition:.3g}"
    summed = f"; a sum of cells that do not lie on one line of action hides {', '.join(lost)}" if lost else ""
    mixed = len(null) < len([name for name in missing if name not in lost])
    combined = f" ({combination(null[0], names)} is seen by no channel)" if mixed and len(null) == 1 else ""
    return f"only {rank} of six are told apart: {', '.join(missing)} cannot be told{combined}{summed}"


def combination(vector: Array, names: Sequence[str]) -> str:
    """The sum that `vector` makes of `names` in words, the largest share 1 in size and the first one positive."""
    largest = float(np.abs(vector).max())
    parts = [(value / largest, name) for value, name in zip(vector, names, strict=True) if abs(value) > 1e-3 * largest]
    sign = -1 if parts[0][0] < 0 else 1
    return " + ".join(f"{sign * value:.2g} {name}" for value, name in parts).replace("+ -", "- ")
