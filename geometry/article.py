"""`Part` and `Article`: what is mounted, bottom to top, each part with its shape, its material and its place."""

from collections import Counter
from collections.abc import Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cache
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry import toml_file
from geometry.errors import BadInput
from geometry.frames import Array, Pose, freeze

# Materials: what a part is made of. The library lives in `materials.toml`; a user's article brings its own.


@dataclass(frozen=True, eq=False, kw_only=True)
class Material:
    """An isotropic material.

    Attributes
    ----------
    name : as the library or the user's file calls it
    density : [kg/m³]
    youngs_modulus : [Pa], None where only the mass matters
    poisson_ratio : [1], None where only the mass matters
    loss_factor : [1], structural (hysteretic) damping, None where unknown
    """

    name: str
    density: float
    youngs_modulus: float | None = None
    poisson_ratio: float | None = None
    loss_factor: float | None = None

    def __post_init__(self) -> None:
        if not 0 < self.density < float("inf"):
            problem = f"a density must be positive and finite, found {self.density:g} kg/m³"
            remedy = "Give it in kg/m³ (steel about 7850, aluminium about 2700)"
            raise BadInput(f"material {self.name}", "density", problem, remedy)


@cache
def library() -> Mapping[str, Material]:
    """The materials that ship with massline, by name."""
    table = toml_file.shipped("geometry", "materials.toml")
    keys = {
        "density": "density_kg_m3",
        "youngs_modulus": "youngs_modulus_Pa",
        "poisson_ratio": "poisson_ratio",
        "loss_factor": "loss_factor",
    }
    found = {}
    for name, entry in table.items():
        values = {field: float(str(entry[key])) for field, key in keys.items() if key in entry}
        found[name] = Material(name=name, **values)
    return MappingProxyType(found)


def material(name: str, source: str = "material") -> Material:
    """The library's material called `name`.

    Raises
    ------
    BadInput : no such material; the message lists those that exist.
    """
    try:
        return library()[name]
    except KeyError:
        remedy = f"Known are {', '.join(sorted(library()))}; or state a density"
        raise BadInput(source, "material", f"no material is called {name!r}", remedy) from None


# Shapes as data: boxes and cylinders that add material, boxes and cylinders that take it away.
#
# A `Shape` is what a drawing says and nothing more. Two readers that share no arithmetic turn it into inertia: `geometry.cad`
# lets OCC cut the solids and integrates the B-rep; `geometry.routes` lets Pinocchio add closed-form primitives, voids with
# negative mass. They can only agree when every void lies wholly inside the material and no two voids overlap, so a wrong drawing
# shows itself as a disagreement of the routes.

MOST_HOLES = 200
"""On one circle; every hole is cut by OCC, one after the other."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Box:
    """Cuboid of edge lengths `size` (3,) [m], centred on its own origin, edges along its own axes."""

    size: Array

    def __post_init__(self) -> None:
        freeze(self, size=(3,))
        _require_positive(self.size, "size")

    @property
    def volume(self) -> float:
        """Volume [m³]."""
        return float(np.prod(self.size))


@dataclass(frozen=True, eq=False, kw_only=True)
class Cylinder:
    """Solid cylinder of `diameter` [m] and `height` [m], centred on its own origin, axis along its own z."""

    diameter: float
    height: float

    def __post_init__(self) -> None:
        _require_positive(np.array([self.diameter]), "diameter")
        _require_positive(np.array([self.height]), "height")

    @property
    def volume(self) -> float:
        """Volume [m³]."""
        return float(np.pi / 4 * self.diameter**2 * self.height)


Primitive = Box | Cylinder


@dataclass(frozen=True, eq=False, kw_only=True)
class Placed:
    """A primitive and where it sits in the frame of its part."""

    primitive: Primitive
    pose: Pose = field(default_factory=Pose)


@dataclass(frozen=True, eq=False, kw_only=True)
class Shape:
    """Material and voids of one part, in the part's frame.

    Attributes
    ----------
    solids : primitives of material; they may touch but not overlap
    voids : primitives cut out of it; each wholly inside the material, none overlapping another
    """

    solids: tuple[Placed, ...]
    voids: tuple[Placed, ...] = ()

    def __post_init__(self) -> None:
        there, taken = (sum(placed.primitive.volume for placed in kind) for kind in (self.solids, self.voids))
        if taken >= there:
            raise ValueError(f"`voids` must take away less than there is, found {taken:.6g} m³ of {there:.6g} m³")


def upright(primitive: Primitive, *, bottom: float, x: float = 0.0, y: float = 0.0) -> Placed:
    """`primitive` standing on height `bottom` [m], its vertical axis through (`x`, `y`) [m]."""
    height = primitive.height if isinstance(primitive, Cylinder) else primitive.size[2]
    return Placed(primitive=primitive, pose=Pose(position=np.array([x, y, bottom + height / 2])))


def drilled(positions: npt.ArrayLike, *, diameter: float, bottom: float, depth: float) -> tuple[Placed, ...]:
    """Vertical holes of `diameter` [m] and `depth` [m] upwards from height `bottom` [m], at `positions` (n, 2) [m]."""
    hole = Cylinder(diameter=diameter, height=depth)
    return tuple(upright(hole, bottom=bottom, x=x, y=y) for x, y in np.asarray(positions, dtype=np.float64))


def bolt_circle(count: int, diameter: float, first_angle: float = 0.0) -> Array:
    """Centres (count, 2) [m] of equally spaced holes on a circle of `diameter` [m], the first at `first_angle` [rad].

    Raises
    ------
    ValueError : fewer than none, or more than `MOST_HOLES`.
    """
    if not 0 <= count <= MOST_HOLES:
        raise ValueError(f"`count` of holes must lie between 0 and {MOST_HOLES}, found {count}")
    angle = first_angle + 2 * np.pi * np.arange(count) / count
    return diameter / 2 * np.column_stack([np.cos(angle), np.sin(angle)])


def rectangle(length_x: float, length_y: float) -> Array:
    """Corners (4, 2) [m] of a rectangle centred on the axis, counter-clockwise from +x +y."""
    return np.array([[1, 1], [-1, 1], [-1, -1], [1, -1]]) * [length_x / 2, length_y / 2]


def _require_positive(values: Array, name: str) -> None:
    if not np.all(np.isfinite(values)) or np.any(values <= 0):
        raise ValueError(f"`{name}` must be positive and finite, found {values.tolist()}")


@dataclass(frozen=True, eq=False, kw_only=True)
class Part:
    """One body of one material.

    Attributes
    ----------
    name : unique within its article
    material : what it is made of
    shape : its drawing, in the part's own frame
    pose : where that frame sits in the article's frame
    counted : False for what belongs in the picture but does not move with the article (the fixed half of a load cell)
    """

    name: str
    material: Material
    shape: Shape
    pose: Pose = field(default_factory=Pose)
    counted: bool = True


def require_unique_names(names: Iterable[str]) -> None:
    """Refuse parts of which two have one name."""
    if doubled := [name for name, count in sorted(Counter(names).items()) if count > 1]:
        raise ValueError(f"`parts` must have unique names, found {', '.join(doubled)} more than once")


@dataclass(frozen=True, eq=False, kw_only=True)
class Article:
    """A test article or a stack of them.

    Attributes
    ----------
    name : as on the command line, bottom to top, joined by "+"
    parts : all bodies, in the article's frame (the own frame of the lowest one)
    seat : where the next article's frame sits when it is stacked on this one; None when nothing can stand on it
    note : one sentence on what the geometry rests on (drawing, assumption, reconstruction)
    """

    name: str
    parts: tuple[Part, ...]
    seat: Pose | None = None
    note: str = ""

    def __post_init__(self) -> None:
        require_unique_names(part.name for part in self.parts)

    @property
    def counted_parts(self) -> tuple[Part, ...]:
        """The parts whose mass belongs to the article."""
        return tuple(part for part in self.parts if part.counted)


def placed(article: Article, pose: Pose) -> Article:
    """`article` with its frame put at `pose` of an outer frame; the result is expressed in the outer frame."""
    parts = tuple(replace(part, pose=pose @ part.pose) for part in article.parts)
    return replace(article, parts=parts, seat=None if article.seat is None else pose @ article.seat)


def stacked(*articles: Article) -> Article:
    """`articles` on top of one another, lowest first, in the frame of the lowest.

    Part names gain their article as a prefix, ``disc/plate``, when more than one article is stacked; a second disc is ``disc-2``.

    Raises
    ------
    ValueError : an article that nothing can stand on is not the top one.
    """
    if len(articles) == 1:
        return articles[0]
    pose: Pose | None = Pose()
    parts: list[Part] = []
    for article, prefix in zip(articles, prefixes([article.name for article in articles]), strict=True):
        if pose is None:
            raise ValueError(f"`articles`: nothing can be mounted on {parts[-1].name.split('/')[0]}, found {article.name}")
        there = placed(article, pose)
        parts += [replace(part, name=f"{prefix}/{part.name}") for part in there.parts]
        pose = there.seat
    return Article(
        name="+".join(article.name for article in articles),
        parts=tuple(parts),
        seat=pose,
        note=" ".join(dict.fromkeys(article.note for article in articles if article.note)),
    )


def prefixes(names: Sequence[str]) -> list[str]:
    """What the parts of a stack of `names` are prefixed with, bottom to top: the names, numbered from the second of a kind on."""
    before = [names[:index].count(name) for index, name in enumerate(names)]
    return [f"{name}-{count + 1}" if count else name for name, count in zip(names, before, strict=True)]


def seat_at(height: float) -> Pose:
    """A seat on the axis at `height` [m] above the article's origin, axes parallel."""
    return Pose(position=np.array([0.0, 0.0, height]))
