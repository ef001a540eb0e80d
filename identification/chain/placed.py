"""`Placed`: neighbouring channels of a chain, and where they stand in it."""

from __future__ import annotations

from dataclasses import dataclass

from geometry.sensors import Channel


@dataclass(frozen=True, eq=False, kw_only=True)
class Placed:
    """Channels of one kind.

    Attributes
    ----------
    channels : in their order
    first : column of the first of them in the chain
    """

    channels: tuple[Channel, ...]
    first: int

    @property
    def names(self) -> tuple[str, ...]:
        """Of the channels."""
        return tuple(channel.name for channel in self.channels)

    @property
    def columns(self) -> tuple[int, ...]:
        """Of the channels in the chain."""
        return tuple(range(self.first, self.first + len(self.channels)))
