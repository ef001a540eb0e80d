"""Channel tables for chains: the paper's 22 signals, and one that nobody would build but that has everything slanted."""

import numpy as np
import pytest

from geometry.sensors import Channel, ChannelTable, Place

X, Y, Z = np.eye(3)
CORNERS = tuple(np.array([x, y, 0.0]) for x, y in ((0.13, 0.13), (-0.13, 0.13), (-0.13, -0.13), (0.13, -0.13)))


def pick_up(name: str, at: tuple[float, float, float], along: np.ndarray, group: str = "cover", **more: bool) -> Channel:
    place = Place(position=np.array(at), direction=along)
    return Channel(name=name, quantity="acceleration", group=group, places=(place,), **more)


def cell(name: str, *places: tuple[np.ndarray, np.ndarray], quantity: str = "force") -> Channel:
    at = tuple(Place(position=np.array(position), direction=along) for position, along in places)
    return Channel(name=name, quantity=quantity, group="fmd", places=at)


def paper_pick_ups(senses: bool = True) -> list[Channel]:
    table = [
        pick_up("table-z1", (0.25, 0.0, -0.06), Z, "table", senses_gravity=senses),
        pick_up("table-z2", (-0.15, 0.22, -0.06), Z, "table", senses_gravity=senses),
        pick_up("table-z3", (-0.15, -0.22, -0.06), Z, "table", senses_gravity=senses),
        pick_up("table-x1", (0.0, -0.25, -0.06), X, "table", senses_gravity=senses),
        pick_up("table-y1", (0.25, 0.0, -0.06), Y, "table", senses_gravity=senses),
        pick_up("table-y2", (-0.25, 0.0, -0.06), Y, "table", senses_gravity=senses),
    ]
    signs = ((1, 1), (-1, 1), (-1, -1), (1, -1))
    cover = [
        pick_up(f"cover-z{k}", (0.185 * a, 0.185 * b, 0.045), Z, senses_gravity=senses) for k, (a, b) in enumerate(signs, start=1)
    ]
    cover += [pick_up(f"cover-x{k}", (0.2, y, 0.03), X, senses_gravity=senses) for k, y in ((1, 0.15), (2, -0.15))]
    cover += [pick_up(f"cover-y{k}", (x, 0.2, 0.03), Y, senses_gravity=senses) for k, x in ((1, 0.15), (2, -0.15))]
    return [*table, *cover]


def paper_cells() -> list[Channel]:
    sums = [cell("fmd-x12", (CORNERS[0], X), (CORNERS[1], X)), cell("fmd-x34", (CORNERS[2], X), (CORNERS[3], X))]
    sums += [cell("fmd-y14", (CORNERS[0], Y), (CORNERS[3], Y)), cell("fmd-y23", (CORNERS[1], Y), (CORNERS[2], Y))]
    return sums + [cell(f"fmd-z{k}", (at, Z)) for k, at in enumerate(CORNERS, start=1)]


@pytest.fixture(scope="session")
def paper() -> ChannelTable:
    """The paper's 22 signals."""
    return ChannelTable(channels=(*paper_pick_ups(), *paper_cells()))


@pytest.fixture(scope="session")
def slanted() -> ChannelTable:
    """Oblique directions, averaged pick-ups, some that sense no gravity, five cells at different heights, F off the origin."""
    d = np.array([0.6, -0.48, 0.64])
    places = tuple(Place(position=np.array(p), direction=d) for p in ((0.1, 0.2, 0.1), (0.12, 0.2, 0.1)))
    averaged = Channel(name="cover-mean", quantity="acceleration", group="cover", places=places)
    kinematic = pick_up("optical", (0.1, -0.2, 0.3), np.array([0.8, 0.0, 0.6]), senses_gravity=False)
    below = pick_up("encoder", (0.2, -0.1, -0.1), d, "table", senses_gravity=False)
    corners = [np.array([0.1, 0.2, 0.01]), np.array([-0.2, 0.1, 0.0]), np.array([-0.1, -0.15, 0.03]), np.array([0.15, -0.1, 0.0])]
    cells = [cell(f"{name}{k}", (at, e)) for k, at in enumerate(corners) for name, e in zip("xyz", np.eye(3), strict=True)]
    cells += [cell("slant", (np.array([0.0, 0.05, 0.02]), d)), cell("mz", (corners[0], Z), quantity="moment")]
    return ChannelTable(channels=(*paper_pick_ups(), averaged, kinematic, below, *cells), origin=np.array([0.02, -0.01, 0.005]))


@pytest.fixture(scope="session")
def loads_only() -> ChannelTable:
    """Six loads that somebody has already worked out, and the pick-ups."""
    F = np.zeros(3)
    names = [
        ("fx", "force", X),
        ("fy", "force", Y),
        ("fz", "force", Z),
        ("tx", "moment", X),
        ("ty", "moment", Y),
        ("tz", "moment", Z),
    ]
    return ChannelTable(channels=(*paper_pick_ups(), *(cell(n, (F, along), quantity=q) for n, q, along in names)))
