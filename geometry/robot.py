"""Robot descriptions, URDF, the MJCF of MuJoCo and the SDF of Gazebo: the inertia that each link states, and its shapes.

All are read as they are written, without the simulators. Lengths are metres. A link's frame is that of its joint (URDF), of its
body (MJCF) or its own (SDF); everything is seen from it. The stated tensor is about the stated centre of mass, in the axes of
the *inertial* frame (`origin` of URDF, `pos` and `quat` of MJCF, `pose` of SDF), products as matrix entries.
"""

import math
import re
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from xml.etree import ElementTree

import numpy as np

from geometry.errors import BadInput
from geometry.frames import Array, Pose, rotation_about
from geometry.inertia import Inertia, tensor_from_six

ENDINGS = (".urdf", ".xml", ".sdf")
"""URDF, MJCF and SDF."""

MOST_BYTES = 64 << 20
"""Of one description; the largest that are published have a few hundred kilobytes."""

MOST_LEVELS = 60
"""Of bodies within bodies, classes within classes and files that include files."""

SIZES = {"box": 3, "cylinder": 2, "sphere": 1, "capsule": 2, "ellipsoid": 3}
"""Shapes in closed form, and how many numbers say their size."""

Element = ElementTree.Element


@dataclass(frozen=True, eq=False, kw_only=True)
class LinkShape:
    """One shape that a link is drawn with.

    Attributes
    ----------
    use : "visual" or "collision"
    kind : "mesh", or one of `SIZES`
    pose : of the shape in the link
    size : [m]; box: edges; cylinder and capsule: radius and length of the straight part; sphere: radius; ellipsoid: half-axes
    file : of a mesh, else None; empty where the description names one that cannot be found, which `lost` then says
    scale : (3,) [1], what the numbers of the mesh file are multiplied by to be metres; a mirrored mesh has a negative one
    """

    use: str
    kind: str
    pose: Pose = field(default_factory=Pose)
    size: tuple[float, ...] = ()
    file: Path | None = None
    scale: tuple[float, float, float] = (1.0, 1.0, 1.0)
    lost: str = ""

    @property
    def mirrored(self) -> bool:
        """Whether `scale` turns the mesh into its mirror image."""
        return bool(np.prod(np.sign(self.scale)) < 0)

    @property
    def half_extent(self) -> Array:
        """Half the edges (3,) [m] of the box around a shape in closed form."""
        if self.kind == "box":
            return 0.5 * np.array(self.size)
        if self.kind in ("cylinder", "capsule"):
            cap = self.size[0] if self.kind == "capsule" else 0.0
            return np.array([self.size[0], self.size[0], 0.5 * self.size[1] + cap])
        return np.broadcast_to(np.array(self.size, dtype=np.float64), (3,)).copy()


@dataclass(frozen=True, eq=False, kw_only=True)
class Link:
    """One rigid body of a robot.

    Attributes
    ----------
    name : unique in its robot
    mass : as stated [kg]
    inertia : as stated, about the link's origin, None where nothing is stated or no tensor can be made of it
    inertial : pose of the frame in which the tensor is written; its origin is the stated centre of mass
    half_unit : (10,) half a unit of the last written digit of mass [kg], centre of mass [m] and tensor [kg m²], inertial axes
    tensor : (3, 3) [kg m²] as written, about the centre of mass in inertial axes
    shapes : what it is drawn with
    note : what is odd about its inertia, in words
    """

    name: str
    mass: float = 0.0
    inertia: Inertia | None = None
    inertial: Pose = field(default_factory=Pose)
    half_unit: Array = field(default_factory=lambda: np.zeros(10))
    tensor: Array = field(default_factory=lambda: np.zeros((3, 3)))
    shapes: tuple[LinkShape, ...] = ()
    note: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Robot:
    """A description as read: its `name`, `form` ("URDF", "MJCF" or "SDF") and `links`, in the order of the file."""

    name: str
    form: str
    links: tuple[Link, ...]


def read(path: Path) -> Robot:
    """The robot that `path` describes; no mesh is opened.

    Raises
    ------
    BadInput : no XML, none of `robot`, `mujoco` and `sdf`, xacro that was not expanded, a number that is none, doubled names of
        links, a file that is included and not there, frames that are not there.
    """
    root = _parsed(path)
    if root.tag == "robot":
        form, links = "URDF", _Urdf(path).links(root)
    elif root.tag == "mujoco":
        form, links = "MJCF", _Mjcf(path, root).links()
    elif root.tag == "sdf":
        form, links = "SDF", tuple(_Sdf(path).links(_with_texts(root)))
    else:
        problem = f"it is neither a URDF (<robot>), an MJCF (<mujoco>) nor an SDF (<sdf>), found <{root.tag[:40]}>"
        raise BadInput(str(path), "", problem, "Give a robot description, or a STEP or mesh file")
    names = [link.name for link in links]
    if doubled := [name for name in dict.fromkeys(names) if names.count(name) > 1]:
        raise BadInput(str(path), "name", f"two links are called {doubled[0]!r}", "Give each its own name")
    if not links:
        raise BadInput(str(path), "", "it has no link", "Check that the file is whole")
    return Robot(name=root.get("name") or root.get("model") or path.stem, form=form, links=links)


def _parsed(path: Path) -> Element:
    source = str(path)
    if not path.is_file():
        raise BadInput(source, "", "there is no such file", "Check the path")
    if path.stat().st_size > MOST_BYTES:
        raise BadInput(source, "", f"it is larger than {MOST_BYTES >> 20} MiB", "Check what it is")
    content = path.read_bytes()
    if b"<!DOCTYPE" in content or b"<!ENTITY" in content:
        raise BadInput(source, "", "it declares a document type, which none of them needs", "Remove <!DOCTYPE>")
    try:
        root = ElementTree.fromstring(content.lstrip())
    except (ElementTree.ParseError, ValueError, LookupError) as error:
        raise BadInput(source, "", f"it is no XML ({error})", "Check that the file is whole") from None
    if any("xacro" in one.tag or any("${" in text for text in one.attrib.values()) for one in root.iter()):
        raise BadInput(source, "", "it has xacro macros that are not expanded", "Run xacro on it first")
    return root


class _Numbers:
    """Reads numbers of the elements of `path`."""

    def __init__(self, path: Path) -> None:
        self.path = path

    def of(self, element: Element | None, name: str, default: Sequence[float], least: int | None = None) -> Array:
        """The numbers of the attribute `name`, as many as `default` has (or from `least` on); `default` where it is missing."""
        text = None if element is None else element.get(name)
        if element is None or text is None:
            return np.array(default, dtype=np.float64)
        try:
            numbers = np.array([float(part) for part in text.split()])
        except ValueError:
            numbers = np.empty(0)
        fewest = len(default) if least is None else least
        if not fewest <= len(numbers) <= len(default) or not np.isfinite(numbers).all():
            problem = f"must be {len(default)} finite number{'s' * (len(default) > 1)}, found {text[:60]!r}"
            raise BadInput(str(self.path), f"{element.tag} {name}", problem, "Correct it")
        return numbers

    def half_units(self, element: Element | None, names: Sequence[str]) -> list[float]:
        """Half a unit of the last written digit of every number of the attributes `names`."""
        texts = (part for name in names for part in ("" if element is None else element.get(name, "")).split())
        found = (re.fullmatch(r"[-+]?\d*(?:\.(\d*))?(?:[eE]([-+]?\d+))?", text) for text in texts)
        return [0.5 * 10.0 ** (int(one[2] or 0) - len(one[1] or "")) if one else 0.0 for one in found]

    def link(self, name: str, mass: float, six: Array, pose: Pose, written: list[float], shapes: tuple[LinkShape, ...]) -> Link:
        """A link that states `mass` [kg] and the tensor `six` [kg m²] in the inertial frame at `pose`."""
        tensor = tensor_from_six(six)
        body = Inertia.from_cog(mass, pose.position, pose.rotation @ tensor @ pose.rotation.T) if mass else None
        return Link(
            name=name,
            mass=mass,
            inertia=body,
            inertial=pose,
            half_unit=np.array(written),
            tensor=tensor,
            shapes=shapes,
            note="" if body is not None else "its mass is zero",
        )

    def rolled(self, angles: Array) -> Array:
        """The turn (3, 3) by `angles` (3,) [rad] about fixed axes: roll about x, then pitch about y, then yaw about z."""
        roll, pitch, yaw = angles.tolist()
        return rotation_about("z", yaw) @ rotation_about("y", pitch) @ rotation_about("x", roll)

    def unit(self, element: Element, vector: Array) -> Array:
        length = float(np.linalg.norm(vector))
        if not length > 1e-12:
            raise BadInput(str(self.path), element.tag, "a direction has no length", "Correct it")
        return np.asarray(vector / length)

    def turned(self, element: Element, quaternion: Array) -> Array:
        w, x, y, z = self.unit(element, quaternion)
        return np.array(
            [
                [1 - 2 * (y * y + z * z), 2 * (x * y - w * z), 2 * (x * z + w * y)],
                [2 * (x * y + w * z), 1 - 2 * (x * x + z * z), 2 * (y * z - w * x)],
                [2 * (x * z - w * y), 2 * (y * z + w * x), 1 - 2 * (x * x + y * y)],
            ]
        )

    def found(self, named: str) -> Path | None:
        """The file behind a plain path, ``file://`` or ``package://NAME/...``, looked for upwards from the description."""
        plain = re.sub(r"^(file|package|model)://", "", named)
        here = self.path.resolve().parent
        tails = [plain, plain.partition("/")[2]] if "://" in named else [plain]
        places = (folder / tail for tail in tails if tail for folder in (here, *here.parents[:6]))
        return next((place for place in places if place.is_file()), None)

    def shape_of(self, element: Element, use: str, pose: Pose) -> LinkShape | None:
        """What `geometry` of an element of URDF or SDF says; nothing of what bounds no volume."""
        geometry = element.find("geometry")
        one = None if geometry is None else next(iter(geometry), None)
        if one is None or one.tag in ("plane", "heightmap", "empty", "image"):
            return None
        if one.tag == "mesh":
            named = one.get("filename", one.get("uri", "")).strip()
            file = self.found(named)
            x, y, z = self.of(one, "scale", [1.0] * 3).tolist()
            lost = "" if file else f"its mesh {named} is not there"
            lost = "its mesh is a part of a file (submesh), which is not read" if one.find("submesh") is not None else lost
            return LinkShape(use=use, kind="mesh", pose=pose, file=None if lost else file, scale=(x, y, z), lost=lost)
        if one.tag not in SIZES:
            return LinkShape(use=use, kind=one.tag, pose=pose, lost=f"a shape <{one.tag}> is not known")
        if whole := {"box": "size", "ellipsoid": "radii"}.get(one.tag):
            size = self.of(one, whole, [0.0] * 3)
        else:
            size = np.array([self.of(one, key, [0.0])[0] for key in ("radius", "length")[: SIZES[one.tag]]])
        return LinkShape(use=use, kind=one.tag, pose=pose, size=tuple(size.tolist()))


class _Urdf(_Numbers):
    def links(self, root: Element) -> tuple[Link, ...]:
        return tuple(self.read(one) for one in root.findall("link"))

    def read(self, element: Element) -> Link:
        name = element.get("name", "")
        shapes = tuple(
            shape
            for use in ("visual", "collision")
            for one in element.findall(use)
            if (shape := self.shape_of(one, use, self.pose(one))) is not None
        )
        stated = element.find("inertial")
        if stated is None:
            return Link(name=name, shapes=shapes, note="it states no inertia")
        pose, keys = self.pose(stated), ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        mass, tensor = stated.find("mass"), stated.find("inertia")
        six = np.array([self.of(tensor, key, [0.0])[0] for key in keys])
        written = [
            (self.half_units(mass, ["value"]) or [0.0])[0],
            *(self.half_units(stated.find("origin"), ["xyz"]) or [0.0] * 3),
            *((self.half_units(tensor, [key]) or [0.0])[0] for key in keys),
        ]
        return self.link(name, float(self.of(mass, "value", [0.0])[0]), six, pose, written, shapes)

    def pose(self, element: Element) -> Pose:
        origin = element.find("origin")
        return Pose(position=self.of(origin, "xyz", [0.0] * 3), rotation=self.rolled(self.of(origin, "rpy", [0.0] * 3)))


class _Mjcf(_Numbers):
    def __init__(self, path: Path, root: Element) -> None:
        self.path, self.unnamed = path, 0
        self._include(root, path.parent, 0)
        self.root = root
        compiler: dict[str, str] = {}
        for one in root.findall("compiler"):
            compiler |= one.attrib
        if compiler.get("coordinate") == "global":
            problem = "places are in the axes of the world (coordinate), which MuJoCo has given up as well"
            raise BadInput(str(path), "compiler", problem, "Save it by MuJoCo 2.3.3, which turns them")
        scaled = self.of(Element("compiler", compiler), "settotalmass", [-1.0])[0] > 0, compiler.get("balanceinertia") == "true"
        self.rescaled = [key for key, on in zip(("settotalmass", "balanceinertia"), scaled, strict=True) if on]
        self.degrees = compiler.get("angle", "degree") != "radian"
        self.of_geoms = compiler.get("inertiafromgeom", "auto") == "true"
        self.order = compiler.get("eulerseq", "xyz")
        if not re.fullmatch("[xyzXYZ]{3}", self.order):
            raise BadInput(str(path), "eulerseq", f"must be three axes, found {self.order!r}", "Correct it")
        self.folder = path.parent / compiler.get("meshdir", compiler.get("assetdir", "."))
        self.classes: dict[str, dict[str, dict[str, str]]] = {"main": {}}
        for one in root.findall("default"):  # those of included files and of the file itself are one, whatever it is called
            self._collect(one, self.classes["main"], 0)
        self.meshes: dict[str, tuple[Path, Element, str]] = {}
        for asset in root.findall("asset"):
            for one in asset.findall("mesh"):
                file = one.get("file", "")
                self.meshes[one.get("name") or Path(file).stem] = (self.folder / file, self._full(one, ""), file)

    def _include(self, element: Element, folder: Path, level: int) -> None:
        for place, child in enumerate(list(element)):
            if child.tag != "include":
                self._include(child, folder, level)
                continue
            if level > MOST_LEVELS:
                raise BadInput(str(self.path), "include", "files include each other without end", "Correct it")
            inner = _parsed(folder / child.get("file", ""))
            self._include(inner, folder, level + 1)
            element.remove(child)
            for number, one in enumerate(list(inner)):
                element.insert(place + number, one)

    def _collect(self, element: Element, above: Mapping[str, dict[str, str]], level: int) -> None:
        own = {tag: dict(attributes) for tag, attributes in above.items()}
        for one in element:
            if one.tag != "default":
                own[one.tag] = own.get(one.tag, {}) | one.attrib
        self.classes |= dict.fromkeys((element.get("class", "main"), *(["main"] if level == 0 else [])), own)
        for one in element.findall("default"):
            if level < MOST_LEVELS:
                self._collect(one, own, level + 1)

    def _full(self, element: Element, child_class: str) -> Element:
        """`element` with what its class says of it."""
        defaults = self.classes.get(element.get("class") or child_class or "main", {}).get(element.tag, {})
        return Element(element.tag, {**defaults, **element.attrib})

    def links(self) -> tuple[Link, ...]:
        worlds = (self._inside(world, "", Pose(), 0) for world in self.root.findall("worldbody"))
        return tuple(link for world in worlds for one, own, _ in world if one.tag == "body" for link in self._below(one, own, 0))

    def _inside(self, element: Element, child_class: str, place: Pose, level: int) -> Iterator[tuple[Element, str, Pose]]:
        """What stands in `element`, with its class and the place of the frames around it, which are no bodies themselves."""
        if level > MOST_LEVELS:
            raise BadInput(str(self.path), "", f"more than {MOST_LEVELS} bodies within bodies", "Check the file")
        for one in element:
            if one.tag == "frame":
                yield from self._inside(one, one.get("childclass", child_class), place @ self.pose(one), level + 1)
            else:
                yield one, child_class, place

    def _below(self, body: Element, child_class: str, level: int) -> Iterator[Link]:
        inside = list(self._inside(body, body.get("childclass", child_class), Pose(), level))
        self.unnamed += "name" not in body.attrib
        name = body.get("name") or f"unnamed {self.unnamed}"
        drawn = ((place, self.shape(self._full(one, own))) for one, own, place in inside if one.tag == "geom")
        shapes = tuple(replace(shape, pose=place @ shape.pose) for place, shape in drawn if shape is not None)
        stated = body.find("inertial")
        if stated is None or self.of_geoms:
            why = "it states no inertia" if stated is None else "what it states is not used (inertiafromgeom)"
            yield Link(name=name, shapes=shapes, note=f"{why}; MuJoCo makes one of its geoms")
        else:
            yield self.stated(name, stated, shapes)
        for one, own, _ in inside:
            if one.tag == "body":
                yield from self._below(one, own, level + 1)

    def stated(self, name: str, stated: Element, shapes: tuple[LinkShape, ...]) -> Link:
        pose = self.pose(stated)
        full = stated.get("fullinertia") is not None
        six = (
            self.of(stated, "fullinertia", [0.0] * 6) if full else np.append(self.of(stated, "diaginertia", [0.0] * 3), [0.0] * 3)
        )
        tensor = self.half_units(stated, ["fullinertia" if full else "diaginertia"])
        written = [
            *(self.half_units(stated, ["mass"]) or [0.0]),
            *(self.half_units(stated, ["pos"]) or [0.0] * 3),
            *(tensor + [0.0] * (6 - len(tensor))),
        ]
        link = self.link(name, float(self.of(stated, "mass", [0.0])[0]), six, pose, written, shapes)
        return replace(link, note=f"MuJoCo rescales it ({', '.join(self.rescaled)})") if self.rescaled and link.mass else link

    def pose(self, element: Element) -> Pose:
        """`pos` and one of quat, euler, axisangle, xyaxes and zaxis."""
        position = self.of(element, "pos", [0.0] * 3)
        turn = math.pi / 180 if self.degrees else 1.0
        if element.get("euler") is not None:
            rotation = np.eye(3)
            for axis, angle in zip(self.order, self.of(element, "euler", [0.0] * 3), strict=True):
                one = rotation_about(axis.lower(), float(angle) * turn)
                rotation = rotation @ one if axis.islower() else one @ rotation
        elif element.get("axisangle") is not None:
            *about, angle = self.of(element, "axisangle", [0.0, 0.0, 1.0, 0.0])
            half = 0.5 * angle * turn
            rotation = self.turned(element, np.array([math.cos(half), *(math.sin(half) * self.unit(element, np.array(about)))]))
        elif element.get("xyaxes") is not None:
            both = self.of(element, "xyaxes", [0.0] * 6)
            x = self.unit(element, both[:3])
            y = self.unit(element, both[3:] - x * (x @ both[3:]))
            rotation = np.column_stack([x, y, np.cross(x, y)])
        elif element.get("zaxis") is not None:
            rotation = self.along(element, self.of(element, "zaxis", [0.0] * 3))
        else:
            rotation = self.turned(element, self.of(element, "quat", [1.0, 0.0, 0.0, 0.0]))
        return Pose(position=position, rotation=rotation)

    def along(self, element: Element, z: Array) -> Array:
        """The smallest turn (3, 3) that brings the axis z into the direction `z`."""
        z = self.unit(element, z)
        return self.turned(element, np.array([1 + z[2], -z[1], z[0], 0.0]) if z[2] > -1 else np.array([0.0, 1, 0, 0]))

    def shape(self, geom: Element) -> LinkShape | None:
        kind = geom.get("type", "mesh" if geom.get("mesh") else "sphere")
        use = "visual" if geom.get("contype", "1") == geom.get("conaffinity", "1") == "0" else "collision"
        if kind in ("plane", "hfield", "sdf"):
            return None
        pose = self.pose(geom)
        if kind == "mesh":
            path, asset, named = self.meshes.get(geom.get("mesh", ""), (Path(), geom, geom.get("mesh", "")))
            x, y, z = self.of(asset, "scale", [1.0] * 3).tolist()
            moved = any(asset.get(key) for key in ("refpos", "refquat"))
            lost = f"its mesh {named} has a reference pose of its own, which is not read" if moved else ""
            lost = lost or ("" if named and path.is_file() else f"its mesh {named or '(without a file)'} is not there")
            return LinkShape(use=use, kind=kind, pose=pose, file=None if lost else path, scale=(x, y, z), lost=lost)
        if kind not in SIZES:
            return LinkShape(use=use, kind=kind, pose=pose, lost=f"a {kind} is not known")
        size = self.of(geom, "size", [0.0] * 3, least=1)[: SIZES[kind]]
        if geom.get("fromto") is not None and SIZES[kind] > 1:  # said by its ends: the first size is that across
            one, other = self.of(geom, "fromto", [0.0] * 6).reshape(2, 3)
            size = np.append(size[:1].repeat(SIZES[kind] - 1), 0.5 * np.linalg.norm(one - other))
            pose = Pose(position=0.5 * (one + other), rotation=self.along(geom, one - other))
        doubled = 2 * size if kind == "box" else np.append(size[:1], 2 * size[1:]) if kind in ("cylinder", "capsule") else size
        return LinkShape(use=use, kind=kind, pose=pose, size=tuple(doubled.tolist()))


def _with_texts(root: Element) -> Element:
    """An SDF of which what stands in elements are attributes as well, as other forms have them."""
    for one in root.iter():
        for child in one:
            if not len(child) and child.text and child.text.strip():
                one.attrib.setdefault(child.tag, child.text.strip())
    return root


class _Sdf(_Numbers):
    """A pose may be told from any frame of its model."""

    def links(self, root: Element) -> Iterator[Link]:
        """Of all models of a file, which are called by their model where there are several."""
        worlds = [root, *root.findall("world")]
        models = [one for world in worlds for one in world if one.tag in ("model", "include")]
        for one in models:
            yield from self.below(one, f"{self.name(one)}::" if len(models) > 1 else "", 0)

    def name(self, element: Element) -> str:
        return element.get("name") or element.get("uri", "").rstrip("/").rpartition("/")[2]

    def below(self, model: Element, prefix: str, level: int) -> Iterator[Link]:
        """Links of a model and of those within it, or of the file that it includes."""
        if level > MOST_LEVELS:
            raise BadInput(str(self.path), "include", f"more than {MOST_LEVELS} models within models", "Check the file")
        if model.tag == "include":
            inner, root = self.included(model)
            for one in root.findall("model"):
                yield from inner.below(one, prefix, level + 1)
            return
        frames = {one.get("name", ""): one for one in model if one.tag in ("link", "frame", "joint", "model")}
        for one in model:
            if one.tag == "link":
                yield replace(self.read(one, frames), name=f"{prefix}{one.get('name', '')}")
            elif one.tag in ("model", "include"):
                merged = one.get("merge") in ("true", "1")
                yield from self.below(one, prefix if merged else f"{prefix}{self.name(one)}::", level + 1)

    def included(self, element: Element) -> tuple["_Sdf", Element]:
        """The reader of an included file, and what it holds.

        Raises
        ------
        BadInput : it is not there; whatever is wrong with it.
        """
        named = element.get("uri", "")
        inside = ("/model.sdf", "/model.config", "")
        file = next((file for ending in inside if (file := self.found(f"{named}{ending}"))), None)
        if file is not None and file.name == "model.config":  # says which file the model stands in
            listed = [(one.text or "").strip() for one in _parsed(file).findall("sdf")]
            file = next((place for one in reversed(listed) if (place := file.parent / one).is_file()), None)
        if file is None:
            remedy = "Copy that model's folder beside the file, or take the <include> out"
            raise BadInput(str(self.path), "include", f"it includes {named or 'nothing'}, which is not there", remedy)
        root = _parsed(file)
        if root.tag != "sdf" or root.find("model") is None:
            problem = f"it includes {named}, which is <{root.tag[:40]}> and no model of an SDF"
            raise BadInput(str(self.path), "include", problem, "Give that file by itself")
        return _Sdf(file), _with_texts(root)

    def pose(self, element: Element) -> Pose:
        """Its `pose`: place and roll, pitch and yaw, or place and quaternion x, y, z, w."""
        one = element.find("pose")
        if one is not None and one.get("rotation_format") == "quat_xyzw":
            seven = self.of(element, "pose", [0.0] * 6 + [1.0])
            return Pose(position=seven[:3], rotation=self.turned(element, seven[[6, 3, 4, 5]]))
        six = self.of(element, "pose", [0.0] * 6)
        degrees = one is not None and one.get("degrees") in ("true", "1")
        return Pose(position=six[:3], rotation=self.rolled(six[3:] * (math.pi / 180 if degrees else 1.0)))

    def placed(self, element: Element, frames: Mapping[str, Element], base: str, level: int = 0) -> Pose:
        """Where something is in its model: its pose from the frame that it names, else from `base`.

        Raises
        ------
        BadInput : a frame that the model does not have, or that stands on itself.
        """
        stated = element.find("pose")
        seen = (stated.get("relative_to") if stated is not None else "") or base
        if seen in ("", "__model__"):
            return self.pose(element)
        if seen not in frames or level > MOST_LEVELS:
            problem = f"the frame {seen!r} {'stands on itself' if seen in frames else 'is none of its model'}"
            raise BadInput(str(self.path), "pose", problem, "Correct relative_to")
        one = frames[seen]
        below = one.get({"frame": "attached_to", "joint": "child"}.get(one.tag, ""), "")
        return self.placed(one, frames, below, level + 1) @ self.pose(element)

    def within(self, element: Element, frames: Mapping[str, Element], link: Element) -> Pose:
        """Where something is in its link."""
        stated, own = element.find("pose"), link.get("name", "")
        if stated is None or stated.get("relative_to", "") in ("", own):
            return self.pose(element)
        return self.placed(link, frames, "").inverse @ self.placed(element, frames, own)

    def read(self, element: Element, frames: Mapping[str, Element]) -> Link:
        name, stated = element.get("name", ""), element.find("inertial")
        drawn = ((use, one) for use in ("visual", "collision") for one in element.findall(use))
        every = (self.shape_of(one, use, self.within(one, frames, element)) for use, one in drawn)
        shapes = tuple(shape for shape in every if shape is not None)
        if stated is None:
            return Link(name=name, shapes=shapes, note="it states no inertia; Gazebo takes 1 kg and 1 kg m²")
        if stated.get("auto") in ("true", "1"):
            return Link(name=name, shapes=shapes, note="Gazebo makes its inertia of its shapes")
        tensor, keys = stated.find("inertia"), ("ixx", "iyy", "izz", "ixy", "ixz", "iyz")
        six = np.array([self.of(tensor, key, [float(key[1] == key[2])])[0] for key in keys])
        place = self.half_units(stated, ["pose"])[:3] or [0.0] * 3
        written = [(self.half_units(one, [key]) or [0.0])[0] for one, key in ((stated, "mass"), *((tensor, key) for key in keys))]
        mass, pose = float(self.of(stated, "mass", [1.0])[0]), self.within(stated, frames, element)
        link = self.link(name, mass, six, pose, [written[0], *place, *written[1:]], shapes)
        missing = [*(["mass"] if "mass" not in stated.attrib else []), *(["tensor"] if tensor is None else [])]
        return replace(link, note=f"it states no {' and no '.join(missing)}, of which Gazebo takes 1") if missing else link
