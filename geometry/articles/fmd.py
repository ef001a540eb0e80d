"""The Force Measurement Device: cover plate on four load cells, of which only the moving part counts.

The force-measuring plane halves the cells. What lies above the moving part's lower edge follows the cover plate and is weighed by
the cells; what lies below, and the mounting plate, belongs to the table and is drawn but not counted (paper, section 3.1).
"""

from __future__ import annotations

from geometry.article import Article, Part, seat_at
from geometry.articles.dimensions import Dimensions, load
from geometry.materials import material
from geometry.shapes import Box, Cylinder, Shape, bolt_circle, drilled, rectangle, upright


def build(dimensions: Dimensions | None = None) -> Article:
    """The FMD from `dimensions` (`fmd.toml` by default); origin F, the centre of the force-measuring plane, z up [m]."""
    d = dimensions or load("fmd")
    underside = d["load_cell"]["height"] / 2
    return Article(
        name="fmd",
        parts=(_cover_plate(d["cover_plate"], underside), *_load_cells(d["load_cell"]), _mounting_plate(d, underside)),
        seat=seat_at(underside + d["cover_plate"]["size"][2]),
        note=d["note"],
    )


def _cover_plate(d: Dimensions, underside: float) -> Part:
    t = d["threads"]
    top = underside + d["size"][2]
    circle = bolt_circle(t["count"], t["circle"], t["first_angle"])
    shape = Shape(
        solids=(upright(Box(size=d["size"]), bottom=underside),),
        voids=drilled(circle, diameter=t["diameter"], bottom=top - t["depth"], depth=t["depth"]),
    )
    return Part(name="cover-plate", material=material(d["material"]), shape=shape)


def _load_cells(d: Dimensions) -> tuple[Part, ...]:
    if not 0 <= d["moving_fraction"] <= 1:
        raise ValueError(f"`moving_fraction` must lie between 0 and 1, found {d['moving_fraction']:g}")
    split = d["height"] * (0.5 - d["moving_fraction"])
    halves = (("moving", split, d["height"] / 2, True), ("fixed", -d["height"] / 2, split, False))
    return tuple(
        Part(
            name=f"cell-{number}-{half}",
            material=material(d["material"]),
            shape=Shape(solids=(upright(Cylinder(diameter=d["diameter"], height=top - bottom), bottom=bottom, x=x, y=y),)),
            counted=counted,
        )
        for number, (x, y) in enumerate(rectangle(d["square"], d["square"]), start=1)
        for half, bottom, top, counted in halves
        if top > bottom
    )


def _mounting_plate(d: Dimensions, underside: float) -> Part:
    size = d["mounting_plate"]["size"]
    shape = Shape(solids=(upright(Box(size=size), bottom=-underside - size[2]),))
    return Part(name="mounting-plate", material=material(d["mounting_plate"]["material"]), shape=shape, counted=False)
