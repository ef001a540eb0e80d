"""Clumod: bottom flange, hollow mast, four hubs and one or four blades that cross the mast at their middle.

No two bodies share volume: each blade has a hole through which the mast passes and is clamped between the two collars of its hub,
which stay on the mast when the blade is taken off. The shorter upper blade is a sandwich, two steel faces and a silicone layer in
the neutral axis, three bodies. Bolts are not modelled; their holes are.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from geometry.article import Article, Part
from geometry.articles.dimensions import Dimensions, load
from geometry.frames import Pose, rotation_about
from geometry.materials import material
from geometry.shapes import Box, Cylinder, Placed, Shape, bolt_circle, drilled, upright

ONE_BLADE = ("lower-1",)
FOUR_BLADES = ("lower-1", "lower-2", "upper-long", "upper-short")


def build(blades: tuple[str, ...], dimensions: Dimensions | None = None) -> Article:
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
    return replace(build(ONE_BLADE, dimensions), name="clumod-1")


def four_blades(dimensions: Dimensions | None = None) -> Article:
    """Clumod with all four blades."""
    return replace(build(FOUR_BLADES, dimensions), name="clumod-4")
