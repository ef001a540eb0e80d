"""Places of the built-in articles by name, where something is measured, mounted or tied: `flange`, `hub-3`, `lower-1+`, `top` ...

The names on Clumod are those of the campaign folder: the middle of the flange's upper side, the middle of every hub, the mast's
upper end, and the tips of the blades that are there, with the sign of the axis that the tip points along; all on the axis of the
mast or in the mid-plane of the blade. On the others: `cover` is the middle of the FMD's cover plate, on top, and `cover-1` to
`cover-4` are its corners; `disc` the middle of the disc's upper side; `top` and `top-1` to `top-4` middle and corners of the
Cuboid's. Corners are numbered counter-clockwise from +x +y, like the load cells.
"""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Literal

import numpy as np

from geometry.article import prefixes, rectangle
from geometry.articles import built_in, changes_of, dimension_files
from geometry.articles.parts import FOUR_BLADES, ONE_BLADE, load
from geometry.frames import Array, Pose

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
    d = load(file, changes)
    if part == "cuboid":
        return _upper_side("top", d["size"], d["size"][2])
    if part == "disc":
        return {"disc": _above(d["height"])}
    if part == "fmd":
        size = d["cover_plate"]["size"]
        return _upper_side("cover", size, d["load_cell"]["height"] / 2 + size[2])
    # Hubs of Clumod stay on the mast when their blade is taken off; tips do not
    found = {"flange": _above(d["flange"]["height"])}
    found |= {f"hub-{number}": _above(blade["z"]) for number, blade in enumerate(d["blade"], start=1)}
    found["mast-top"] = _above(d["mast"]["top"])
    for blade in d["blade"]:
        if blade["name"] in (ONE_BLADE if part == "clumod-1" else FOUR_BLADES):
            along = np.array({"x": [1.0, 0.0, 0.0], "y": [0.0, 1.0, 0.0]}[blade["axis"]]) * blade["length"] / 2
            for sign in "+-":
                found[f"{blade['name']}{sign}"] = _above(blade["z"]) + float(f"{sign}1") * along
    return found


def _upper_side(name: str, size: list[float], height: float) -> Places:
    corners = {f"{name}-{number}": np.array([x, y, height]) for number, (x, y) in enumerate(rectangle(*size[:2]), start=1)}
    return {name: _above(height), **corners}


def _above(height: float) -> Array:
    return np.array([0.0, 0.0, height])
