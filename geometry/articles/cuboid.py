"""The Cuboid: a homogeneous aluminium block with four threaded holes in its underside."""

from __future__ import annotations

from geometry.article import Article, Part
from geometry.articles.dimensions import Dimensions, load
from geometry.materials import material
from geometry.shapes import Box, Shape, drilled, rectangle, upright


def build(dimensions: Dimensions | None = None) -> Article:
    """The Cuboid from `dimensions` (`cuboid.toml` by default); origin in the middle of the underside, z up [m]."""
    d = dimensions or load("cuboid")
    t = d["threads"]
    if t["depth"] > d["size"][2]:
        raise ValueError(f"`depth` of the threads must lie within the height, {d['size'][2]:g} m, found {t['depth']:g} m")
    shape = Shape(
        solids=(upright(Box(size=d["size"]), bottom=0.0),),
        voids=drilled(rectangle(*t["pitch"]), diameter=t["diameter"], bottom=0.0, depth=t["depth"]),
    )
    return Article(name="cuboid", parts=(Part(name="block", material=material(d["material"]), shape=shape),), note=d["note"])
