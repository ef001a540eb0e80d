"""The links of a robot description: what each states of its inertia, held against the shape that it is drawn with.

The shape is a body of uniform density with the *stated* mass; where it differs is therefore where the mass sits and how it is
spread, and its density says whether mass and mesh can belong together. A real link is not uniform, so a difference alone is no
mistake. What is one: a tensor that no body has, and values that fit the shape well once one known slip is undone (`SLIPS`). Mass
that would have to lie outside the shape, and a density that nothing has, are doubts: a shape may only stand for its link.
"""

from collections.abc import Callable, Mapping
from dataclasses import dataclass, field
from functools import cached_property, reduce
from itertools import product
from pathlib import Path

import numpy as np

from geometry import mesh as meshes
from geometry import robot, routes
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import Consistency, Inertia, judge, parallel_axis, six_from_tensor, tensor_from_six
from geometry.robot import Link, LinkShape, Robot
from geometry.toml_file import nearest
from validation.output import derived, unwritten
from validation.reference.reference import STATED, ReferenceTable, route_statement
from validation.reference.statement import TENSOR, Stated, Statement, through

CLOSE = 0.15
"""Misfit [1] up to which two bodies count as the same: CoG within this share of the radius of gyration, the tensor of the largest
moment. `tests/validation/test_robot_reference.py` sets it: every slip is found in a link whose own values are 8 % off."""

LEFT = 0.25
"""Share [1] of the misfit that a slip may leave once it is undone: links that are not uniform come nearer to a shape by chance.
In 69 published descriptions such chances left 0.30 to 0.86; the slips of `tests/validation/test_robot_reference.py` less."""

LIGHTEST, HEAVIEST = 1.0, 22_600.0
"""Densities [kg/m³] between which every solid lies: aerogels begin at the first, osmium ends at the second."""


# Known slips of hands and exporters, each undone on the stated values (or on the shape): which one makes them fit?


def _misfit(one: Inertia, other: Inertia) -> float:
    """How far two bodies of one mass differ [1]: CoG in radii of gyration, tensor about the CoG in its largest moment."""
    moment = float(np.abs(other.tensor_cog).max())
    apart = float(np.linalg.norm(one.cog - other.cog)) / np.sqrt(moment / other.mass)
    return max(float(apart), float(np.abs(one.tensor_cog - other.tensor_cog).max()) / moment)


_Slip = Callable[[Link, Inertia, Inertia], tuple[Inertia, Inertia]]


def _mapped(body: Inertia, change: Array) -> Inertia:
    """`body` with every place taken through the matrix `change` (3, 3), which may stretch or mirror it; the mass stays."""
    tensor = body.tensor_cog
    second = change @ (0.5 * np.trace(tensor) * np.eye(3) - tensor) @ change.T
    return Inertia.from_cog(body.mass, change @ body.cog, np.trace(second) * np.eye(3) - second)


def _redrawn(change: Array) -> _Slip:
    return lambda link, own, drawn: (own, _mapped(drawn, change))


def _restated(tensor: Callable[[Link, Inertia], Array]) -> _Slip:
    return lambda link, own, drawn: (Inertia.from_cog(own.mass, own.cog, tensor(link, own)), drawn)


def _other_signs(link: Link, own: Inertia) -> Array:
    return np.asarray(link.inertial.rotation @ (2 * np.diag(np.diag(link.tensor)) - link.tensor) @ link.inertial.rotation.T)


SLIPS: Mapping[str, _Slip] = {
    "its mesh is in millimetres: give it scale 0.001": _redrawn(1e-3 * np.eye(3)),
    "its mesh is in inches: give it scale 0.0254": _redrawn(0.0254 * np.eye(3)),
    "its mesh is 1000 times too small": _redrawn(1e3 * np.eye(3)),
    **{
        f"inertia and mesh are mirror images of each other along {axis}": _redrawn(np.diag(np.where(np.eye(3)[k] > 0, -1.0, 1.0)))
        for k, axis in enumerate("xyz")
    },
    "its products have the other sign: they are matrix entries, -∫xy dm, and it states +∫xy dm": _restated(_other_signs),
    "its tensor is about the link's origin, not about the centre of mass": _restated(
        lambda link, own: own.tensor_cog - parallel_axis(own.mass, own.cog)
    ),
    "its tensor is in the axes of the link, not in those of the inertial frame": _restated(lambda link, own: link.tensor),
    "its tensor is in kg mm²": _restated(lambda link, own: 1e-6 * own.tensor_cog),
    "its tensor is in g mm²": _restated(lambda link, own: 1e-9 * own.tensor_cog),
    "its tensor is in kg cm²": _restated(lambda link, own: 1e-4 * own.tensor_cog),
    "its centre of mass is in millimetres": lambda link, own, drawn: (
        Inertia.from_cog(own.mass, 1e-3 * own.cog, own.tensor_cog),
        drawn,
    ),
}
"""What may have gone wrong, in words, and how to undo it: the stated body and the shape as they were then meant."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnShape:
    """A shape of uniform density.

    Attributes
    ----------
    routes : inertia by route, about the link's origin
    corners : (n, 3) [m] points that a box around it holds
    meshed : whether a mesh is part of it, rather than boxes and spheres that may only stand for something
    """

    routes: Mapping[str, Inertia] = field(default_factory=dict)
    corners: Array = field(default_factory=lambda: np.zeros((1, 3)))
    meshed: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class LinkFindings:
    """One link beside its shape.

    Attributes
    ----------
    name : of the link
    link : as read
    shape : "visual" or "collision", what it is held against; empty where neither is the skin of a body
    drawn : that shape at the stated mass
    volume : of that shape [m³]
    notes : what else must be known, each a sentence
    """

    name: str
    link: Link = unwritten()
    shape: str = ""
    drawn: DrawnShape = unwritten(default_factory=DrawnShape)
    volume: float = 0.0
    notes: tuple[str, ...] = ()

    @property
    @derived("density_kg_m3", before="notes")
    def density(self) -> float | None:
        """Of the shape with the stated mass [kg/m³]; None without a shape or a mass."""
        return self.link.mass / self.volume if self.volume > 0 and self.drawn.routes else None

    @property
    def both(self) -> tuple[Inertia, Inertia] | None:
        """What is stated, and the shape by its first route; None where either is missing."""
        drawn = next(iter(self.drawn.routes.values()), None)
        return None if drawn is None or self.link.inertia is None else (self.link.inertia, drawn)

    @property
    @derived("cog_apart_mm", before="notes")
    def cog_apart(self) -> float | None:
        """How far the stated CoG lies from that of the shape [mm]."""
        return None if self.both is None else 1e3 * float(np.linalg.norm(self.both[0].cog - self.both[1].cog))

    @property
    @derived("principal_moments_over_shape", before="notes")
    def moments_ratio(self) -> tuple[float, ...] | None:
        """Stated principal moments over those of the shape, ascending."""
        if self.both is None:
            return None
        own, drawn = (np.linalg.eigvalsh(one.tensor_cog) for one in self.both)
        return tuple((own / drawn).tolist())

    @cached_property
    def physics(self) -> Consistency | None:
        """Whether a body can have the stated values, to the digits that are written; None where none are stated."""
        if self.link.inertia is None:
            return None
        six, half = six_from_tensor(self.link.tensor), self.link.half_unit[TENSOR]
        finest = float(np.min(half[six != 0.0], initial=np.abs(six).max()))  # a zero is written shortly, whatever is known
        return judge(self.link.inertia, rounding=max(1e-9, 2 * finest / max(float(np.abs(six).max()), 1e-300)))

    @property
    @derived("physical", before="notes")
    def physical(self) -> bool | None:
        return None if self.physics is None else self.physics.physical

    @property
    @derived("wrong", before="notes")
    def wrong(self) -> tuple[str, ...]:
        """What is a mistake: no body has it, or one known slip undone makes it fit the shape."""
        found = [] if self.physics is None or self.physics.physical else [f"no body has its inertia: {self.physics.text}"]
        if self.both is not None and (misfit := _misfit(*self.both)) > CLOSE:
            fits = {words: _misfit(*undo(self.link, *self.both)) for words, undo in SLIPS.items()}
            best = min(fits, key=fits.__getitem__)
            found += [best] if fits[best] <= min(CLOSE, LEFT * misfit) else []
        return tuple(found)

    @property
    @derived("doubts", before="notes")
    def doubts(self) -> tuple[str, ...]:
        """What the shape does not allow: a density that nothing has, and mass that would have to lie outside of it.

        Mass between a and b has its centre c between them, and about it no more second moment along this axis than
        m (b - c)(c - a) (Bhatia and Davis, American Mathematical Monthly 107, 2000).
        """
        if self.link.mass and not self.link.tensor.any():
            return ("its tensor is zero, as if all of it were one point",)
        if self.both is None or self.density is None or self.wrong:
            return ()
        body, corners, found = self.both[0], self.drawn.corners, []
        if self.drawn.meshed and not LIGHTEST <= self.density <= HEAVIEST:
            found.append(f"with the stated mass its mesh has {self.density:.3g} kg/m³, which nothing has: wrong unit or mass")
        low, high = corners.min(axis=0), corners.max(axis=0)
        second = 0.5 * np.trace(body.tensor_cog) - np.diag(body.tensor_cog)
        room = body.mass * (high - body.cog) * (body.cog - low)
        if np.any((body.cog < low) | (body.cog > high)):
            apart = float(np.max([low - body.cog, body.cog - high]))
            found.append(f"its centre of mass lies {1e3 * apart:.3g} mm outside its {self.shape} shape")
        elif np.any(second > room):
            with np.errstate(divide="ignore", invalid="ignore"):  # no room: the centre of mass lies on the face of the box
                many = np.sqrt(np.nan_to_num(np.maximum(second, 0) / room))
            k = int(np.argmax(many))
            far = f"{many[k]:.3g} times as far as its {self.shape} shape allows"
            at_the_edge = f"though its centre of mass lies at the very edge of its {self.shape} shape"
            found.append(f"along {'xyz'[k]} its mass is spread {far if room[k] > 0 else at_the_edge}")
        return tuple(found)

    @property
    def table(self) -> ReferenceTable:
        """The shape by its routes beside what is stated, which keeps the digits that are written."""
        link, columns = self.link, {route: route_statement(route, body) for route, body in self.drawn.routes.items()}
        R, values = link.inertial.rotation, np.array([link.mass, *link.inertial.position, *six_from_tensor(link.tensor)])
        written = tuple(Stated(value=float(v), tolerance=float(t) or None) for v, t in zip(values, link.half_unit, strict=True))
        turned = through(lambda ten: np.concatenate([ten[:4], six_from_tensor(R @ tensor_from_six(ten[TENSOR]) @ R.T)]), written)
        columns[STATED] = Statement(name=STATED, values=turned, source="the description", tolerance_note="last written digit")
        agree, text = True, "one route: the shape is known in closed form" if self.drawn.routes else ""
        if len(self.drawn.routes) > 1:
            allowed = {route: routes.rounding(body) for route, body in self.drawn.routes.items()}
            held = routes.held_together(self.drawn.routes, allowed)
            agree, text = held.agree, held.text
        notes = ["Frame: the link's own; what is stated is turned into it, and known to half a unit of its last written digit."]
        notes += [f"Shape: {self.shape}, uniform, at the stated mass: {self.density:.4g} kg/m³."] if self.density else []
        said = (*([self.physics.text] if self.physics else []), *self.wrong, *self.doubts, *self.notes)
        notes += [f"{words[0].upper()}{words[1:]}." for words in said]
        return ReferenceTable(article=self.name, columns=columns, agree=agree, agreement=text, footnotes=tuple(notes))


@dataclass(frozen=True, eq=False, kw_only=True)
class RobotFindings:
    """Every link of a description.

    Attributes
    ----------
    source : its file
    robot : as read
    links : in the order of the file
    """

    source: str
    robot: Robot = unwritten()
    links: tuple[LinkFindings, ...] = ()

    @property
    @derived("mass_kg")
    def mass(self) -> float:
        """Stated mass of all links [kg]."""
        return sum(one.link.mass for one in self.links)

    @cached_property
    def tables(self) -> tuple[ReferenceTable, ...]:
        """A reference table for every link that states an inertia."""
        return tuple(one.table for one in self.links if one.link.inertia is not None)

    def bodies(self, column: str) -> dict[str, Inertia]:
        """By link what `column` says: "stated", or a route of `geometry.routes`; links of which it says nothing are left out."""
        stated = {one.name: one.link.inertia for one in self.links if one.link.inertia is not None}
        routed = {one.name: one.drawn.routes[column] for one in self.links if column in one.drawn.routes}
        return stated if column == STATED else routed


def findings(path: Path, name: str | None = None) -> RobotFindings:
    """The description in `path`, each of its links, or the one called `name`, beside its shape.

    Raises
    ------
    BadInput : it cannot be read, or has no such link. A mesh that is missing or no body is a note of its link.
    """
    read = robot.read(path)
    chosen = [link for link in read.links if name in (None, link.name)]
    if not chosen:
        names = [link.name for link in read.links]
        remedy = f"{nearest(name or '', names)}Its links are {', '.join(names)}"
        raise BadInput(str(path), "--link", f"it has no link {name!r}", remedy)
    known: _Known = {}
    links = []
    for link in chosen:
        notes, use, drawn = [link.note] if link.note else [], "", DrawnShape()
        for tried in ("visual", "collision"):
            try:
                every = [_drawn(shape, known) for shape in link.shapes if shape.use == tried]
            except BadInput as error:
                notes.append(f"{error.source.rpartition('/')[2]}: {error.problem}")
                continue
            if every and link.inertia is not None:
                use = tried
                both = [route for route in every[0].routes if all(route in one.routes for one in every)]
                drawn = DrawnShape(
                    routes={route: reduce(Inertia.__add__, (one.routes[route] for one in every)) for route in both},
                    corners=np.vstack([one.corners for one in every]),
                    meshed=any(one.meshed for one in every),
                )
                break
        volume = next((one.mass for one in drawn.routes.values()), 0.0)
        at_mass = {route: one.scaled(link.mass / one.mass) for route, one in drawn.routes.items()}
        links.append(
            LinkFindings(
                name=link.name,
                link=link,
                shape=use,
                drawn=DrawnShape(routes=at_mass, corners=drawn.corners, meshed=drawn.meshed),
                volume=volume,
                notes=tuple(dict.fromkeys(notes)),
            )
        )
    return RobotFindings(source=str(path), robot=read, links=tuple(links))


_Known = dict[tuple[Path, tuple[float, ...]], DrawnShape | BadInput]


def _drawn(shape: LinkShape, known: _Known) -> DrawnShape:
    """`shape` in the link, at unit density; what meshes hold is kept in `known`."""
    if shape.lost:
        raise BadInput(shape.kind, "", shape.lost, "")
    if shape.file is None:
        if not all(size > 0 for size in shape.size):
            raise BadInput(shape.kind, "", f"its size is {shape.size}", "")
        corners = shape.half_extent * np.array(list(product((-1, 1), repeat=3)))
        one = DrawnShape(routes={"pinocchio": routes.closed_form(shape.kind, shape.size)}, corners=corners)
    else:
        key, path = (shape.file, shape.scale), shape.file
        if key not in known:
            try:
                if path.suffix.lower() not in meshes.MESH_ENDINGS:
                    raise BadInput(str(path), "", f"only {', '.join(meshes.MESH_ENDINGS)} can be read", "")
                read = meshes.read_mesh(path, "m").mesh
                faces = read.faces[:, ::-1] if shape.mirrored else read.faces
                mesh = meshes.TriangleMesh(vertices=read.vertices * np.array(shape.scale), faces=faces)
                meshes.require_closed_volume(mesh, str(path))
                known[key] = DrawnShape(routes=routes.of_mesh(mesh, 1.0), corners=mesh.vertices, meshed=True)
            except BadInput as error:
                known[key] = error
        found = known[key]
        if isinstance(found, BadInput):
            raise found
        one = found
    placed = {route: body.placed(shape.pose) for route, body in one.routes.items()}
    return DrawnShape(routes=placed, corners=shape.pose.apply(one.corners), meshed=one.meshed)
