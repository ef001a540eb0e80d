"""Clumod: bottom flange, hollow mast, four hubs and one or four blades that cross the mast at their middle.

No two bodies share volume: each blade has a hole through which the mast passes and is clamped between the two collars of its hub,
which stay on the mast when the blade is taken off. The shorter upper blade is a sandwich, two steel faces and a silicone layer in
the neutral axis, three bodies. Bolts are not modelled; their holes are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geometry.article import (
    Article,
    Box,
    Cylinder,
    Part,
    Placed,
    Shape,
    bolt_circle,
    drilled,
    material,
    rectangle,
    seat_at,
    upright,
)
from geometry.articles.dimensions import Dimensions, load
from geometry.frames import Pose, rotation_about

ONE_BLADE = ("lower-1",)
FOUR_BLADES = ("lower-1", "lower-2", "upper-long", "upper-short")


def build_clumod(blades: tuple[str, ...], dimensions: Dimensions | None = None) -> Article:
    """Clumod with the `blades` named; origin on the mast axis at the flange's underside, z up [m]."""
    d = dimensions or load("clumod")
    parts = [_flange(d["flange"]), _mast(d)]
    parts += [_hub(d, number, blade) for number, blade in enumerate(d["blade"], start=1)]
    for blade in d["blade"]:
        if blade["name"] in blades:
            parts += _blade(d, blade)
    return Article(name=f"clumod-{len(blades)}", parts=tuple(parts), note=d["note"])


def _flange(d: Dimensions) -> Part:
    height, pockets = d["height"], d["pockets"]
    voids = (
        upright(Cylinder(diameter=d["bore"]["diameter"], height=height), bottom=0.0),
        *_holes(d["bolts"], bottom=0.0, depth=height),
        *_holes(pockets, bottom=height - pockets["depth"], depth=pockets["depth"]),
    )
    disc = upright(Cylinder(diameter=d["diameter"], height=height), bottom=0.0)
    return Part(name="flange", material=material(d["material"]), shape=Shape(solids=(disc,), voids=voids))


def _mast(d: Dimensions) -> Part:
    mast, bottom = d["mast"], d["flange"]["height"]
    outer, inner = (Cylinder(diameter=mast[k], height=mast["top"] - bottom) for k in ("outer_diameter", "inner_diameter"))
    shape = Shape(solids=(upright(outer, bottom=bottom),), voids=(upright(inner, bottom=bottom),))
    return Part(name="mast", material=material(mast["material"]), shape=shape)


def _hub(d: Dimensions, number: int, blade: Dimensions) -> Part:
    """Two collars on the mast, one on each side of the blade's place."""
    hubs, half = d["hubs"], blade["hub_height"] / 2
    collar = Cylinder(diameter=hubs["outer_diameter"], height=half)
    bore = Cylinder(diameter=d["mast"]["outer_diameter"], height=half)
    bottoms = (blade["z"] - blade["thickness"] / 2 - half, blade["z"] + blade["thickness"] / 2)
    solids = tuple(upright(collar, bottom=bottom) for bottom in bottoms)
    voids = tuple(
        void for bottom in bottoms for void in (upright(bore, bottom=bottom), *_holes(hubs["bolts"], bottom=bottom, depth=half))
    )
    return Part(name=f"hub-{number}", material=material(hubs["material"]), shape=Shape(solids=solids, voids=voids))


def _blade(d: Dimensions, blade: Dimensions) -> list[Part]:
    """The bodies of one blade, bottom to top: one, or face, layer and face."""
    plate, name = material(d["blades"]["material"]), blade["name"]
    if "layer" not in blade:
        return [Part(name=name, material=plate, shape=_slab(d, blade, 0.0, blade["thickness"]), pose=_blade_pose(blade))]
    layer = blade["layer"]["thickness"]
    face = (blade["thickness"] - layer) / 2
    bodies = (
        ("bottom", plate, -(face + layer) / 2, face),
        ("silicone", material(blade["layer"]["material"]), 0.0, layer),
        ("top", plate, (face + layer) / 2, face),
    )
    return [
        Part(name=f"{name}-{body}", material=made_of, shape=_slab(d, blade, middle, height), pose=_blade_pose(blade))
        for body, made_of, middle, height in bodies
    ]


def _slab(d: Dimensions, blade: Dimensions, middle: float, height: float) -> Shape:
    """A rectangle along the blade's own x with the hole for the mast and those for the hub's bolts; z from its mid-plane."""
    bottom = middle - height / 2
    through = upright(Cylinder(diameter=d["mast"]["outer_diameter"], height=height), bottom=bottom)
    slab = upright(Box(size=np.array([blade["length"], blade["width"], height])), bottom=bottom)
    return Shape(solids=(slab,), voids=(through, *_holes(d["hubs"]["bolts"], bottom=bottom, depth=height)))


def _blade_pose(blade: Dimensions) -> Pose:
    turn = {"x": 0.0, "y": np.pi / 2}[blade["axis"]]
    return Pose(position=np.array([0.0, 0.0, blade["z"]]), rotation=rotation_about("z", turn))


def _holes(d: Dimensions, *, bottom: float, depth: float) -> tuple[Placed, ...]:
    circle = bolt_circle(d["count"], d["circle"], d["first_angle"])
    return drilled(circle, diameter=d["diameter"], bottom=bottom, depth=depth)


def one_blade(dimensions: Dimensions | None = None) -> Article:
    """Clumod as the paper's section 5 identifies it: the two upper blades and one lower blade removed."""
    return replace(build_clumod(ONE_BLADE, dimensions), name="clumod-1")


def four_blades(dimensions: Dimensions | None = None) -> Article:
    """Clumod with all four blades."""
    return replace(build_clumod(FOUR_BLADES, dimensions), name="clumod-4")


# The Cuboid: a homogeneous aluminium block with four threaded holes in its underside.


def build_cuboid(dimensions: Dimensions | None = None) -> Article:
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


# The disc between FMD and Cuboid, with the bolt holes that carry both.


def build_disc(dimensions: Dimensions | None = None) -> Article:
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


# The Force Measurement Device: cover plate on four load cells, of which only the moving part counts.
#
# The force-measuring plane halves the cells. What lies above the moving part's lower edge follows the cover plate and is weighed
# by the cells; what lies below, and the mounting plate, belongs to the table and is drawn but not counted (paper, section 3.1).


def build_fmd(dimensions: Dimensions | None = None) -> Article:
    """The FMD from `dimensions` (`fmd.toml` by default); origin F, the centre of the force-measuring plane, z up [m]."""
    d = dimensions or load("fmd")
    underside = d["load_cell"]["height"] / 2
    size = d["mounting_plate"]["size"]
    shape = Shape(solids=(upright(Box(size=size), bottom=-underside - size[2]),))
    mounting_plate = Part(name="mounting-plate", material=material(d["mounting_plate"]["material"]), shape=shape, counted=False)
    return Article(
        name="fmd",
        parts=(_cover_plate(d["cover_plate"], underside), *_load_cells(d["load_cell"]), mounting_plate),
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
