"""Channel tables for chains: the paper's 22 signals, and one that nobody would build but that has everything slanted."""

import numpy as np
import pytest

from geometry.sensors import Channel, ChannelTable, Place
from identification.campaign import Campaign

X, Y, Z = np.eye(3)


def pick_up(name: str, at: tuple[float, float, float], along: np.ndarray, group: str = "cover", **more: bool) -> Channel:
    place = Place(position=np.array(at), direction=along)
    return Channel(name=name, quantity="acceleration", group=group, places=(place,), **more)


def cell(name: str, *places: tuple[np.ndarray, np.ndarray], quantity: str = "force") -> Channel:
    at = tuple(Place(position=np.array(position), direction=along) for position, along in places)
    return Channel(name=name, quantity=quantity, group="fmd", places=at)


@pytest.fixture(scope="session")
def paper(campaign: Campaign) -> ChannelTable:
    """The paper's 22 signals."""
    return campaign.table


def pick_ups(table: ChannelTable) -> list[Channel]:
    return [channel for channel in table.channels if channel.quantity == "acceleration"]


@pytest.fixture(scope="session")
def slanted(paper: ChannelTable) -> ChannelTable:
    """Oblique directions, averaged pick-ups, some that sense no gravity, five cells at different heights, F off the origin."""
    d = np.array([0.6, -0.48, 0.64])
    places = tuple(Place(position=np.array(p), direction=d) for p in ((0.1, 0.2, 0.1), (0.12, 0.2, 0.1)))
    averaged = Channel(name="cover-mean", quantity="acceleration", group="cover", places=places)
    kinematic = pick_up("optical", (0.1, -0.2, 0.3), np.array([0.8, 0.0, 0.6]), senses_gravity=False)
    below = pick_up("encoder", (0.2, -0.1, -0.1), d, "table", senses_gravity=False)
    corners = [np.array([0.1, 0.2, 0.01]), np.array([-0.2, 0.1, 0.0]), np.array([-0.1, -0.15, 0.03]), np.array([0.15, -0.1, 0.0])]
    cells = [cell(f"{name}{k}", (at, e)) for k, at in enumerate(corners) for name, e in zip("xyz", np.eye(3), strict=True)]
    cells += [cell("slant", (np.array([0.0, 0.05, 0.02]), d)), cell("mz", (corners[0], Z), quantity="moment")]
    return ChannelTable(channels=(*pick_ups(paper), averaged, kinematic, below, *cells), origin=np.array([0.02, -0.01, 0.005]))


@pytest.fixture(scope="session")
def loads_only(paper: ChannelTable) -> ChannelTable:
    """Six loads that somebody has already worked out, and the pick-ups."""
    F = np.zeros(3)
    names = [
        (f"{kind[0] if kind == 'force' else 't'}{axis}", kind, e)
        for kind in ("force", "moment")
        for axis, e in zip("xyz", np.eye(3), strict=True)
    ]
    return ChannelTable(channels=(*pick_ups(paper), *(cell(n, (F, along), quantity=q) for n, q, along in names)))
