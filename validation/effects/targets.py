"""Where an effect may act: channels, cells, axes, places and parts, by the words of its identifier."""

from __future__ import annotations

from dataclasses import dataclass
from functools import cache

from geometry.inertia import PARAMETERS

AXES = ("x", "y", "z")
LATERAL = ("x", "y")
CELLS = ("1", "2", "3", "4")
JOINT = ("rotation", "lateral", "vertical", "torsion")
PARTS = ("mast", "lower-1", "lower-2", "upper-long", "upper-short")

TABLE = ("table-z1", "table-z2", "table-z3", "table-x1", "table-y1", "table-y2")
COVER = ("cover-z1", "cover-z2", "cover-z3", "cover-z4", "cover-x1", "cover-x2", "cover-y1", "cover-y2")
FMD = ("fmd-x12", "fmd-x34", "fmd-y14", "fmd-y23", "fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4")
"""The paper's 22 signals."""

FIXED = {
    "axis": AXES,
    "lateral axis": LATERAL,
    "turning axis": ("z",),
    "cell": CELLS,
    "cell and axis": tuple(cell + axis for cell in CELLS for axis in AXES),
    "pair of axes": tuple(i + j for i in AXES for j in AXES if i != j),
    "direction of the joint": JOINT,
    "direction of the FMD": ("lateral", "vertical"),
    "direction of a cable": ("lateral", "vertical"),
    "joint": ("flange",),
    "board": ("force", "cover", "table"),
    "parameter": PARAMETERS,
    "part with a layer": ("upper-short",),
}
"""Targets that are the same whatever was tested, by kind."""

CHANNEL, FORCE, ACCELEROMETER, PLACE, PART = "channel", "force channel", "accelerometer", "place", "part"
"""Kinds of target that depend on what was tested, and with what."""


@dataclass(frozen=True, kw_only=True)
class Vocabulary:
    """The targets of one test that no other need have.

    Attributes
    ----------
    accelerometers, forces : names of the channels; None where they are not known and any name will do
    places : named places of what was tested; None likewise
    parts : of what was tested; None likewise
    """

    accelerometers: tuple[str, ...] | None = (*TABLE, *COVER)
    forces: tuple[str, ...] | None = FMD
    places: tuple[str, ...] | None = None
    parts: tuple[str, ...] | None = PARTS

    def legal(self, kind: str) -> tuple[str, ...] | None:
        """All targets of a `kind`; None where any name will do."""
        own = {
            CHANNEL: None if self.accelerometers is None or self.forces is None else (*self.accelerometers, *self.forces),
            FORCE: self.forces,
            ACCELEROMETER: self.accelerometers,
            PLACE: self.places,
            PART: self.parts,
        }
        return own[kind] if kind in own else FIXED[kind]


@cache
def built_in_places() -> tuple[str, ...]:
    """Every named place of any built-in article that can stand on the FMD."""
    from geometry.articles.locations import locations

    return tuple(dict.fromkeys(place for article in ("clumod-4", "cuboid", "disc") for place in locations(article)))
