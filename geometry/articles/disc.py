"""The disc between FMD and Cuboid, with the bolt holes that carry both."""

from __future__ import annotations

from geometry.article import Article, Part, seat_at
from geometry.articles.dimensions import Dimensions, load
from geometry.materials import material
from geometry.shapes import Cylinder, Shape, bolt_circle, drilled, rectangle, upright


def build(dimensions: Dimensions | None = None) -> Article:
    """The disc from `dimensions` (`disc.toml` by default); origin in the middle of the underside, z up [m]."""
    d = dimensions or load("disc")
    height, above, below = d["height"], d["cuboid_bolts"], d["fmd_bolts"]
    circle = bolt_circle(below["count"], below["circle"], below["first_angle"])
    shape = Shape(
        solids=(upright(Cylinder(diameter=d["diameter"], height=height), bottom=0.0),),
        voids=drilled(rectangle(*above["pitch"]), diameter=above["diameter"], bottom=0.0, depth=height)
        + drilled(circle, diameter=below["diameter"], bottom=0.0, depth=height),
    )
    plate = Part(name="plate", material=material(d["material"]), shape=shape)
    return Article(name="disc", parts=(plate,), seat=seat_at(height), note=d["note"])
