"""Clumod as a frame of Rayleigh beams on a clamped, rigid flange: eigenfrequencies in milliseconds.

The model that the dimensions of Clumod were solved with. Mast and half-blades are beams between axes; all that the beams do not
have of the real parts - hub collars, the blade's holes for mast and bolts - is a rigid body on its station, so that the frame
carries the mass of the drawing exactly.
"""

from __future__ import annotations

from dataclasses import dataclass, replace
from itertools import pairwise

import numpy as np

from fem.frame import Member, Section, add_lumped, assemble
from geometry.arrays import Array
from geometry.article import Article, Part
from geometry.articles import clumod
from geometry.articles.dimensions import Dimensions
from geometry.inertia import Inertia
from geometry.materials import Material, material
from geometry.multibody import inertia as drawn_inertia
from geometry.shapes import Shape

HALF_BLADE_ELEMENTS = 5
MAST_ELEMENTS = 12


@dataclass(frozen=True, eq=False, kw_only=True)
class BeamModel:
    """The assembled frame.

    Attributes
    ----------
    nodes : (n, 3) [m], in Clumod's frame
    stiffness, mass : (6 n, 6 n), free; node by node x, y, z, alpha, beta, gamma
    clamped : index of the node on the flange's upper side, which the flange holds
    """

    nodes: Array
    stiffness: Array
    mass: Array
    clamped: int


def build(blades: tuple[str, ...], dimensions: Dimensions) -> BeamModel:
    """Frame of Clumod with the `blades` named, from `dimensions` as `clumod.toml` has them."""
    heights = _mast_heights(dimensions)
    nodes = [np.array([0.0, 0.0, z]) for z in heights]
    members = [Member(nodes=tuple(range(len(heights))), section=_tube(dimensions["mast"]), z_axis=np.array([1.0, 0.0, 0.0]))]
    stations = {blade["name"]: int(np.argmin(np.abs(heights - blade["z"]))) for blade in dimensions["blade"]}
    for blade in dimensions["blade"]:
        if blade["name"] in blades:
            members += _half_blades(blade, dimensions, stations[blade["name"]], nodes)
    K, M = assemble(nodes, members)
    article = clumod.build(blades, dimensions)
    for number, blade in enumerate(dimensions["blade"], start=1):
        add_lumped(M, stations[blade["name"]], _lumped(article, number, blade, dimensions).mass_matrix)
    return BeamModel(nodes=np.array(nodes), stiffness=K, mass=M, clamped=0)


def frequencies(model: BeamModel, count: int) -> Array:
    """The lowest `count` eigenfrequencies (count,) [Hz] with the flange clamped, ascending."""
    from scipy.linalg import eigh

    free = np.delete(np.arange(len(model.mass)), slice(6 * model.clamped, 6 * model.clamped + 6))
    held = np.ix_(free, free)
    squares = eigh(model.stiffness[held], model.mass[held], eigvals_only=True, subset_by_index=[0, count - 1])
    return np.asarray(np.sqrt(squares) / (2 * np.pi))


def _mast_heights(d: Dimensions) -> Array:
    """Node heights from flange to top, blade stations among them, no element much longer than the others."""
    fixed = [d["flange"]["height"], *sorted(blade["z"] for blade in d["blade"]), d["mast"]["top"]]
    step = (fixed[-1] - fixed[0]) / MAST_ELEMENTS
    pieces = [np.linspace(a, b, max(1, round((b - a) / step)), endpoint=False) for a, b in pairwise(fixed)]
    return np.append(np.concatenate(pieces), fixed[-1])


def _half_blades(blade: Dimensions, d: Dimensions, station: int, nodes: list[Array]) -> list[Member]:
    """Two members from the mast's axis to the tips, their new nodes appended to `nodes`."""
    outwards = {"x": np.array([1.0, 0.0, 0.0]), "y": np.array([0.0, 1.0, 0.0])}[blade["axis"]]
    section, members = _blade_section(blade, d), []
    for side in (1, -1):
        first = len(nodes)
        distances = np.linspace(0, blade["length"] / 2, HALF_BLADE_ELEMENTS + 1)[1:]
        nodes += [nodes[station] + side * distance * outwards for distance in distances]
        chain = (station, *range(first, len(nodes)))
        members.append(Member(nodes=chain, section=section, z_axis=np.array([0.0, 0.0, 1.0])))
    return members


def _tube(d: Dimensions) -> Section:
    steel, outer, inner = material(d["material"]), d["outer_diameter"], d["inner_diameter"]
    area, second = np.pi / 4 * (outer**2 - inner**2), np.pi / 64 * (outer**4 - inner**4)
    E, G = _moduli(steel)
    bending, rotary = E * second, steel.density * second
    return Section(
        axial=E * area,
        torsion=2 * G * second,
        bending_y=bending,
        bending_z=bending,
        mass=steel.density * area,
        rotary_y=rotary,
        rotary_z=rotary,
    )


def _blade_section(blade: Dimensions, d: Dimensions) -> Section:
    """A rectangle, thin along z. A sandwich keeps the share `bending_factor` of the solid's bending and torsional stiffness."""
    w, t, layer = blade["width"], blade["thickness"], blade.get("layer")
    steel = material(d["blades"]["material"])
    E, G = _moduli(steel)
    share = 1.0 if layer is None else layer["bending_factor"]
    mass, rotary_y = _layered_inertia(w, t, layer, steel)
    return Section(
        axial=E * w * t,
        torsion=share * G * w * t**3 / 3 * (1 - 0.63 * t / w),
        bending_y=share * E * w * t**3 / 12,
        bending_z=E * t * w**3 / 12,
        mass=mass,
        rotary_y=rotary_y,
        rotary_z=mass * w**2 / 12,
    )


def _layered_inertia(w: float, t: float, layer: Dimensions | None, steel: Material) -> tuple[float, float]:
    """Mass [kg/m] and rotary inertia about the width [kg m] of the rectangle with its layer."""
    if layer is None:
        return steel.density * w * t, steel.density * w * t**3 / 12
    excess = material(layer["material"]).density - steel.density
    s = layer["thickness"]
    return w * (steel.density * t + excess * s), w * (steel.density * t**3 + excess * s**3) / 12


def _moduli(m: Material) -> tuple[float, float]:
    """Young's and shear modulus [Pa]."""
    if m.youngs_modulus is None or m.poisson_ratio is None:
        raise ValueError(f"`{m.name}` needs Young's modulus and Poisson's ratio to be a beam")
    return m.youngs_modulus, m.youngs_modulus / (2 * (1 + m.poisson_ratio))


def _lumped(article: Article, number: int, blade: Dimensions, d: Dimensions) -> Inertia:
    """What the beams lack at a station: the hub, and the blade as drawn less the blade without holes; about the station."""
    drawn = [part for part in article.parts if part.name == f"hub-{number}" or part.name.startswith(blade["name"])]
    total = drawn_inertia(Article(name="station", parts=tuple(drawn)))
    if len(drawn) > 1:
        whole = tuple(_without_holes(part) for part in drawn if not part.name.startswith("hub"))
        total = total - drawn_inertia(Article(name="beam", parts=whole))
    return total.about([0.0, 0.0, blade["z"]])


def _without_holes(part: Part) -> Part:
    return replace(part, shape=Shape(solids=part.shape.solids))
