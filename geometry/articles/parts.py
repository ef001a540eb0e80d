"""The built-in articles, from the dimension files beside them to their drawings: Clumod, Cuboid, disc and FMD."""

from collections.abc import Mapping
from types import MappingProxyType
from typing import Any

import numpy as np

from geometry import article, toml_file
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.toml_file import nearest

# Dimension files: lengths leave here in metres, names without their unit, a user's own dimensions on top of the built-in ones.
#
# A key of these is the dimension file, the tables in it and the entry, joined by dots, in the file's own unit:
# ``fmd.load_cell.moving_fraction`` or ``clumod.blade.lower-1.length_mm``. An entry of a list of tables is named by its ``name``.

Dimensions = dict[str, Any]
"""One dimension file or a table of it: numbers in SI, strings, and nested tables."""


def load(name: str, changes: Mapping[str, float] = MappingProxyType({})) -> Dimensions:
    """The dimensions of the built-in part `name`, from ``geometry/articles/<name>.toml``; lengths [m], angles [rad].

    `changes` that begin with `name` replace entries, in the file's own units.

    Raises
    ------
    BadInput : a key that is not in the file, or that is no number there.
    """
    table = toml_file.shipped("geometry.articles", f"{name}.toml")
    for key, value in changes.items():
        head, *steps = key.split(".")
        if head != name:
            continue
        found: Any = table
        inner: Any = table
        for step in steps:
            entries = _entries(found)
            if step not in entries:
                remedy = f"{nearest(step, entries)}Known are {', '.join(entries) or 'no further entries'}"
                raise _refused(key, f"there is no {step!r} here", remedy)
            inner, found = found, entries[step]
        if isinstance(found, dict) or (isinstance(found, list) and found and isinstance(found[0], dict)):
            names = ", ".join(f"{key}.{each}" for each, entry in _entries(found).items() if not isinstance(entry, str))
            raise _refused(key, "this is a table of dimensions", f"Name one of {names}")
        if not toml_file.is_number(found):
            raise _refused(key, f"only a number can be changed, found {found!r}", "Name a number")
        if isinstance(found, int) and not float(value).is_integer():
            raise _refused(key, f"this is a count, found {value:g}", "Give a whole number")
        inner[steps[-1]] = type(found)(value)
    return to_si(table)


def to_si(table: dict[str, Any]) -> Dimensions:
    """`table` with every ``…_mm`` turned into metres and every ``…_deg`` into radians, the suffix dropped."""
    found: Dimensions = {}
    for key, value in table.items():
        name, factor = key, 1.0
        for suffix, unit in (("_mm", 1e-3), ("_deg", 0.017453292519943295)):
            if key.endswith(suffix):
                name, factor = key.removesuffix(suffix), unit
        if isinstance(value, dict):
            found[key] = to_si(value)
        elif isinstance(value, list) and value and isinstance(value[0], dict):
            found[key] = [to_si(entry) for entry in value]
        elif name == key:
            found[key] = value
        else:
            found[name] = [each * factor for each in value] if isinstance(value, list) else value * factor
    return found


def changed_files(changes: Mapping[str, float]) -> set[str]:
    """The dimension files that `changes` speak of."""
    return {key.split(".")[0] for key in changes}


def _entries(table: Any) -> dict[str, Any]:
    """By name what a table holds, or a list of tables that have names; nothing of anything else."""
    if isinstance(table, list):
        return {entry["name"]: entry for entry in table if isinstance(entry, dict)}
    return table if isinstance(table, dict) else {}


def _refused(key: str, problem: str, remedy: str) -> BadInput:
    return BadInput(f"--set, dimension file {key.split('.')[0]}.toml", key, problem, remedy)


# Clumod: bottom flange, hollow mast, four hubs and one or four blades that cross the mast at their middle.
#
# No two bodies share volume: each blade has a hole through which the mast passes and is clamped between the two collars of its
# hub, which stay on the mast when the blade is taken off. The shorter upper blade is a sandwich, two steel faces and a silicone
# layer in the neutral axis, three bodies. Bolts are not modelled; their holes are.

ONE_BLADE = ("lower-1",)
"""As the paper's section 5 identifies it: the two upper blades and one lower blade removed."""

FOUR_BLADES = ("lower-1", "lower-2", "upper-long", "upper-short")


def build_clumod(blades: tuple[str, ...], dimensions: Dimensions | None = None) -> article.Article:
    """Clumod with the `blades` named; origin on the mast axis at the flange's underside, z up [m]."""
    d = dimensions or load("clumod")
    flange, mast = d["flange"], d["mast"]
    height, pockets = flange["height"], flange["pockets"]
    bores = (
        article.upright(article.Cylinder(diameter=flange["bore"]["diameter"], height=height), bottom=0.0),
        *_holes(flange["bolts"], bottom=0.0, depth=height),
        *_holes(pockets, bottom=height - pockets["depth"], depth=pockets["depth"]),
    )
    disc = article.upright(article.Cylinder(diameter=flange["diameter"], height=height), bottom=0.0)
    outer, inner = (article.Cylinder(diameter=mast[k], height=mast["top"] - height) for k in ("outer_diameter", "inner_diameter"))
    tube = article.Shape(solids=(article.upright(outer, bottom=height),), voids=(article.upright(inner, bottom=height),))
    parts = [
        article.Part(
            name="flange", material=article.material(flange["material"]), shape=article.Shape(solids=(disc,), voids=bores)
        ),
        article.Part(name="mast", material=article.material(mast["material"]), shape=tube),
    ]
    parts += [_hub(d, number, blade) for number, blade in enumerate(d["blade"], start=1)]
    for blade in d["blade"]:
        if blade["name"] in blades:
            parts += _blade(d, blade)
    return article.Article(name=f"clumod-{len(blades)}", parts=tuple(parts), note=d["note"])


def _hub(d: Dimensions, number: int, blade: Dimensions) -> article.Part:
    """Two collars on the mast, one on each side of the blade's place."""
    hubs, half = d["hubs"], blade["hub_height"] / 2
    collar = article.Cylinder(diameter=hubs["outer_diameter"], height=half)
    bore = article.Cylinder(diameter=d["mast"]["outer_diameter"], height=half)
    bottoms = (blade["z"] - blade["thickness"] / 2 - half, blade["z"] + blade["thickness"] / 2)
    solids = tuple(article.upright(collar, bottom=bottom) for bottom in bottoms)
    voids = tuple(
        void
        for bottom in bottoms
        for void in (article.upright(bore, bottom=bottom), *_holes(hubs["bolts"], bottom=bottom, depth=half))
    )
    return article.Part(
        name=f"hub-{number}", material=article.material(hubs["material"]), shape=article.Shape(solids=solids, voids=voids)
    )


def _blade(d: Dimensions, blade: Dimensions) -> list[article.Part]:
    """The bodies of one blade, bottom to top: one, or face, layer and face."""
    plate, name = article.material(d["blades"]["material"]), blade["name"]
    if "layer" not in blade:
        return [article.Part(name=name, material=plate, shape=_slab(d, blade, 0.0, blade["thickness"]), pose=_blade_pose(blade))]
    layer = blade["layer"]["thickness"]
    face = (blade["thickness"] - layer) / 2
    bodies = (
        ("bottom", plate, -(face + layer) / 2, face),
        ("silicone", article.material(blade["layer"]["material"]), 0.0, layer),
        ("top", plate, (face + layer) / 2, face),
    )
    return [
        article.Part(name=f"{name}-{body}", material=made_of, shape=_slab(d, blade, middle, height), pose=_blade_pose(blade))
        for body, made_of, middle, height in bodies
    ]


def _slab(d: Dimensions, blade: Dimensions, middle: float, height: float) -> article.Shape:
    """A rectangle along the blade's own x with the hole for the mast and those for the hub's bolts; z from its mid-plane."""
    bottom = middle - height / 2
    through = article.upright(article.Cylinder(diameter=d["mast"]["outer_diameter"], height=height), bottom=bottom)
    slab = article.upright(article.Box(size=np.array([blade["length"], blade["width"], height])), bottom=bottom)
    return article.Shape(solids=(slab,), voids=(through, *_holes(d["hubs"]["bolts"], bottom=bottom, depth=height)))


def _blade_pose(blade: Dimensions) -> Pose:
    turn = {"x": 0.0, "y": np.pi / 2}[blade["axis"]]
    return Pose(position=np.array([0.0, 0.0, blade["z"]]), rotation=rotation_about("z", turn))


def _holes(d: Dimensions, *, bottom: float, depth: float) -> tuple[article.Placed, ...]:
    circle = article.bolt_circle(d["count"], d["circle"], d["first_angle"])
    return article.drilled(circle, diameter=d["diameter"], bottom=bottom, depth=depth)


# The Cuboid: a homogeneous aluminium block with four threaded holes in its underside.


def build_cuboid(dimensions: Dimensions | None = None) -> article.Article:
    """The Cuboid from `dimensions` (`cuboid.toml` by default); origin in the middle of the underside, z up [m]."""
    d = dimensions or load("cuboid")
    t = d["threads"]
    if t["depth"] > d["size"][2]:
        raise ValueError(f"`depth` of the threads must lie within the height, {d['size'][2]:g} m, found {t['depth']:g} m")
    shape = article.Shape(
        solids=(article.upright(article.Box(size=d["size"]), bottom=0.0),),
        voids=article.drilled(article.rectangle(*t["pitch"]), diameter=t["diameter"], bottom=0.0, depth=t["depth"]),
    )
    return article.Article(
        name="cuboid", parts=(article.Part(name="block", material=article.material(d["material"]), shape=shape),), note=d["note"]
    )


# The disc between FMD and Cuboid, with the bolt holes that carry both.


def build_disc(dimensions: Dimensions | None = None) -> article.Article:
    """The disc from `dimensions` (`disc.toml` by default); origin in the middle of the underside, z up [m]."""
    d = dimensions or load("disc")
    height, above, below = d["height"], d["cuboid_bolts"], d["fmd_bolts"]
    circle = article.bolt_circle(below["count"], below["circle"], below["first_angle"])
    shape = article.Shape(
        solids=(article.upright(article.Cylinder(diameter=d["diameter"], height=height), bottom=0.0),),
        voids=article.drilled(article.rectangle(*above["pitch"]), diameter=above["diameter"], bottom=0.0, depth=height)
        + article.drilled(circle, diameter=below["diameter"], bottom=0.0, depth=height),
    )
    plate = article.Part(name="plate", material=article.material(d["material"]), shape=shape)
    return article.Article(name="disc", parts=(plate,), seat=article.seat_at(height), note=d["note"])


# The Force Measurement Device: cover plate on four load cells, of which only the moving part counts.
#
# The force-measuring plane halves the cells. What lies above the moving part's lower edge follows the cover plate and is weighed
# by the cells; what lies below, and the mounting plate, belongs to the table and is drawn but not counted (paper, section 3.1).


def build_fmd(dimensions: Dimensions | None = None) -> article.Article:
    """The FMD from `dimensions` (`fmd.toml` by default); origin F, the centre of the force-measuring plane, z up [m]."""
    d = dimensions or load("fmd")
    cover, cell, mounting = d["cover_plate"], d["load_cell"], d["mounting_plate"]
    underside, threads = cell["height"] / 2, cover["threads"]
    top = underside + cover["size"][2]
    circle = article.bolt_circle(threads["count"], threads["circle"], threads["first_angle"])
    drawn = article.Shape(
        solids=(article.upright(article.Box(size=cover["size"]), bottom=underside),),
        voids=article.drilled(circle, diameter=threads["diameter"], bottom=top - threads["depth"], depth=threads["depth"]),
    )
    parts = [article.Part(name="cover-plate", material=article.material(cover["material"]), shape=drawn)]
    if not 0 <= cell["moving_fraction"] <= 1:
        raise ValueError(f"`moving_fraction` must lie between 0 and 1, found {cell['moving_fraction']:g}")
    split = cell["height"] * (0.5 - cell["moving_fraction"])
    for number, (x, y) in enumerate(article.rectangle(cell["square"], cell["square"]), start=1):
        for half, low, high, counted in (("moving", split, underside, True), ("fixed", -underside, split, False)):
            if high > low:
                solid = article.upright(article.Cylinder(diameter=cell["diameter"], height=high - low), bottom=low, x=x, y=y)
                name, made_of = f"cell-{number}-{half}", article.material(cell["material"])
                parts.append(article.Part(name=name, material=made_of, shape=article.Shape(solids=(solid,)), counted=counted))
    size = mounting["size"]
    plate = article.Shape(solids=(article.upright(article.Box(size=size), bottom=-underside - size[2]),))
    parts.append(article.Part(name="mounting-plate", material=article.material(mounting["material"]), shape=plate, counted=False))
    return article.Article(name="fmd", parts=tuple(parts), seat=article.seat_at(top), note=d["note"])
