"""Places of the built-in articles by name, where something is measured, mounted or tied: `flange`, `hub-3`, `lower-1+`, `top` ...

The names on Clumod are those of the campaign folder: the middle of the flange's upper side, the middle of every hub, the mast's
upper end, and the tips of the blades that are there, with the sign of the axis that the tip points along; all on the axis of the
mast or in the mid-plane of the blade. On the others: `cover` is the middle of the FMD's cover plate, on top, and `cover-1` to
`cover-4` are its corners; `disc` the middle of the disc's upper side; `top` and `top-1` to `top-4` middle and corners of the
Cuboid's. Corners are numbered counter-clockwise from +x +y, like the load cells.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from types import MappingProxyType
from typing import Literal

import numpy as np

from geometry.article import prefixes, rectangle
from geometry.articles import built_in, changes_of, dimension_files
from geometry.articles.dimensions import Dimensions, load
from geometry.articles.parts import FOUR_BLADES, ONE_BLADE
from geometry.errors import BadInput
from geometry.frames import Array, Pose
from geometry.toml_file import nearest

Places = dict[str, Array]
"""By name (3,) [m]."""


def locations(
    name: str, changes: Mapping[str, float] = MappingProxyType({}), *, origin: Literal["lowest", "top"] = "lowest"
) -> Places:
    """Every named place of the built-in article or stack `name`, (3,) [m] in the frame of its lowest or of its top article.

    The places of a second article of one kind carry it as a prefix, as its parts do: ``disc-2/disc``.

    Raises
    ------
    BadInput : what `geometry.articles.built_in` refuses.
    """
    poses = seats(name, changes)
    own = poses[-1].inverse if origin == "top" else Pose()
    parts = name.split("+")
    return {
        place if prefix == part else f"{prefix}/{place}": (own @ pose).apply(position)
        for part, prefix, pose in zip(parts, prefixes(parts), poses, strict=True)
        for place, position in _own(part, changes).items()
    }


def location(
    name: str,
    place: str,
    changes: Mapping[str, float] = MappingProxyType({}),
    *,
    origin: Literal["lowest", "top"] = "lowest",
) -> Array:
    """One of `locations`, (3,) [m].

    Raises
    ------
    BadInput : there is no such place on the article; with the nearest one.
    """
    known = locations(name, changes, origin=origin)
    if place not in known:
        raise BadInput(
            source=f"article {name}",
            problem=f"no place on it is called {place!r}",
            remedy=f"{nearest(place, known)}Known are {', '.join(known)}",
        )
    return known[place]


def seats(name: str, changes: Mapping[str, float] = MappingProxyType({})) -> list[Pose]:
    """Where the frame of every article of the stack `name` sits in that of the lowest one, bottom to top.

    Raises
    ------
    BadInput : what `geometry.articles.built_in` refuses.
    """
    built_in(name, changes)
    parts = name.split("+")
    poses = [Pose()]
    for part in parts[:-1]:
        poses.append(poses[-1] @ (built_in(part, changes_of(part, changes)).seat or Pose()))
    return poses


def _own(part: str, changes: Mapping[str, float]) -> Places:
    """The places of one article in its own frame."""
    (file,) = dimension_files(part)
    return _PLACES[part](load(file, changes))


def _cuboid(d: Dimensions) -> Places:
    return _upper_side("top", d["size"], d["size"][2])


def _disc(d: Dimensions) -> Places:
    return {"disc": _above(d["height"])}


def _fmd(d: Dimensions) -> Places:
    size = d["cover_plate"]["size"]
    return _upper_side("cover", size, d["load_cell"]["height"] / 2 + size[2])


def _one_blade(d: Dimensions) -> Places:
    return _clumod(d, ONE_BLADE)


def _four_blades(d: Dimensions) -> Places:
    return _clumod(d, FOUR_BLADES)


def _clumod(d: Dimensions, blades: tuple[str, ...]) -> Places:
    """Hubs stay on the mast when their blade is taken off; tips do not."""
    hubs = {f"hub-{number}": _above(blade["z"]) for number, blade in enumerate(d["blade"], start=1)}
    tips = {name: tip for blade in d["blade"] if blade["name"] in blades for name, tip in _tips(blade).items()}
    return {"flange": _above(d["flange"]["height"]), **hubs, "mast-top": _above(d["mast"]["top"]), **tips}


def _tips(blade: Dimensions) -> Places:
    along = np.array({"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0]}[blade["axis"]]) * blade["length"] / 2
    return {f"{blade['name']}{sign}": _above(blade["z"]) + float(f"{sign}1") * along for sign in "+-"}


def _upper_side(name: str, size: list[float], height: float) -> Places:
    corners = {f"{name}-{number}": np.array([x, y, height]) for number, (x, y) in enumerate(rectangle(*size[:2]), start=1)}
    return {name: _above(height), **corners}


def _above(height: float) -> Array:
    return np.array([0.0, 0.0, height])


_PLACES: dict[str, Callable[[Dimensions], Places]] = {
    "cuboid": _cuboid,
    "disc": _disc,
    "fmd": _fmd,
    "clumod-1": _one_blade,
    "clumod-4": _four_blades,
}
