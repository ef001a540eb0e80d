"""``article.toml``: which body of which file is made of what, and where it sits; checked whole before any file is read."""

from collections.abc import Iterable, Iterator, Mapping
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any, NoReturn

import numpy as np

from geometry import mesh as meshes
from geometry import toml_file
from geometry.article import Material, material, require_unique_names
from geometry.errors import BadInput
from geometry.frames import Array, Pose, frozen, rotation_about
from geometry.inertia import Inertia
from geometry.repair import EstimatedBody, estimated, mended
from geometry.routes import Agreement, held_together, missing_mass, rounding
from geometry.toml_file import MILLIMETRE, length_unit, quantity

# Materials as users write them: a name of the library, or a density with its unit.


def made_of(text: str, source: str, own: Mapping[str, Material] | None = None) -> Material:
    """The material that `text` names, first among the user's `own`, then in the library; or a density, ``"7800 kg/m^3"``.

    Raises
    ------
    BadInput : no such material, or a density that is none.
    """
    if own and text in own:
        return own[text]
    if text[:1].isdigit() or text[:1] in ("-", "+", "."):
        return Material(name=text, density=density(text, source))
    return material(text, source)


def density(text: Any, source: str, field: str = "density") -> float:
    """`text`, such as ``"7.85 g/cm^3"``, as a density in kg/m³.

    Raises
    ------
    BadInput : no unit, an unknown one, another dimension, a tolerance, or a number that is not positive and finite.
    """
    try:
        read = quantity(text, "density", source=source, field=field)
    except BadInput as error:
        raise _refused(source, field, error.problem) from None
    if read.std_dev:
        raise _refused(source, field, f"no tolerance of a density is carried on, found {text!r}")
    if read.nominal_value <= 0:
        raise _refused(source, field, f"a density must be positive and finite, found {text!r}")
    return float(read.nominal_value)


def _refused(source: str, field: str, problem: str) -> BadInput:
    return BadInput(source, field, problem, 'Write it like "7800 kg/m^3" or "7.8 g/cm^3"')


DESCRIPTION = "article.toml"
_TOP = ("format", "article", "part", "material")
_ELASTIC = {
    "youngs_modulus": ("pressure", 0.0, np.inf, '"207 GPa"'),
    "poisson_ratio": ("ratio", -1.0, 0.5, "0.3"),
    "loss_factor": ("ratio", -1e-12, 1.0, "0.002 to 0.01"),
}
"""What a solid model needs to know of a material beside its density: dimension, open range in SI, and an example."""

_PART = ("name", "file", "unit", "material", "density", "body", "materials", "position_mm", "rotation_deg")


@dataclass(frozen=True, eq=False, kw_only=True)
class PartEntry:
    """One file, or one body of it, as the user describes it.

    Attributes
    ----------
    name : of the part; of a file with several bodies, the first half of their names
    file : where it is
    unit : of a mesh's numbers, None when the file states it
    material : of every body that `materials` does not name; None when each is named
    materials : of bodies of a STEP file, by name
    body : the one body that is meant: a name in a STEP file, a number from 1 in a mesh; None for all
    pose : where the file's frame sits in the article's frame
    named : whether the user gave the name
    """

    name: str
    file: Path
    unit: str | None = None
    material: Material | None = None
    materials: Mapping[str, Material] = field(default_factory=dict)
    body: str | None = None
    pose: Pose = field(default_factory=Pose)
    named: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Description:
    """The content of an ``article.toml``: the article's `name` and its `parts`."""

    name: str
    parts: tuple[PartEntry, ...]


def read(path: Path) -> Description:
    """The description in `path`, files relative to it.

    Raises
    ------
    BadInput : not TOML, an unknown key (the nearest known one is named), a wrong type, a missing file or material ...
    """
    source = str(path)
    table = toml_file.read(path)
    toml_file.require_known(table, _TOP, source=source)
    toml_file.require_format(table, source)
    article = toml_file.require_table(table.get("article", {}), source=source, where="article")
    toml_file.require_known(article, ("name",), source=source, where="article")
    materials = toml_file.require_table(table.get("material", {}), source=source, where="material")
    own = {name: own_material(name, entry, source, f"material.{name}") for name, entry in materials.items()}
    entries = table.get("part", [])
    if not isinstance(entries, list) or not entries:
        raise BadInput(source, "part", "there is no part", "Add a [[part]] with name and file")
    parts = tuple(_part(entry, number, path, own) for number, entry in enumerate(entries, start=1))
    names = [part.name for part in parts]
    for name in names:
        if names.count(name) > 1:
            raise BadInput(source, "part.name", f"{name!r} names more than one part", "Give each its own name")
    return Description(name=_text(article, "name", source, "article") or path.resolve().parent.name, parts=parts)


def template(name: str, parts: Iterable[Path]) -> str:
    """An ``article.toml`` for the files `parts`, to be corrected by the user."""
    parts = tuple(parts)
    lines = [f"format = {toml_file.FORMAT}", "", "[article]", f'name = "{name}"']
    names, taken = [part.stem for part in parts], list[str]()
    for name_of_part in names:  # x, x and x become x, x-2 and x-3, or the next number where such a name is there already
        tries = (name_of_part, *(f"{name_of_part}-{number}" for number in range(2, len(names) + 2)))
        free = (each for each in tries if each not in taken and (each == name_of_part or each not in names))
        taken.append(next(free))
    for part, name_of_part in zip(parts, taken, strict=True):
        step = part.suffix.lower() in (".step", ".stp")
        lines += ["", "[[part]]", f'name = "{name_of_part}"', f'file = "{part.name}"', *([] if step else ['unit = "mm"'])]
        lines.append('material = "steel"')
    return "\n".join(lines) + "\n"


def _part(entry: Any, number: int, path: Path, own: Mapping[str, Material]) -> PartEntry:
    source, where = str(path), f"part {number}"
    if not isinstance(entry, dict):
        raise BadInput(source, "part", f"must be a table, found {entry!r}", "Write it as [[part]]")
    toml_file.require_known(entry, _PART, source=source, where=where)
    for key in ("name", "file"):
        if not _text(entry, key, source, where):
            raise BadInput(source, f"{where}.{key}", "is missing", f'Add {key} = "..."')
    name, file = entry["name"], entry["file"]
    whose = toml_file.named_file(file, path.parent, source, f"{where}.file") if file.startswith(f"${toml_file.DATA}/") else None
    there = whose or path.parent / file
    if not there.is_file():
        raise BadInput(source, f"{where}.file", f"there is no file {file!r}", f"Looked for {there}")
    unit = _text(entry, "unit", source, where)
    if unit is not None:
        unit = length_unit(unit, source, f"{where}.unit").name
    whole: Material | None = None
    if "density" in entry:
        if "material" in entry:
            raise BadInput(source, f"{where}.density", "is given beside a material", "Leave one of the two out")
        whole = Material(name=str(entry["density"]), density=density(entry["density"], source, f"{where}.density"))
    elif "material" in entry:
        whole = _named(entry["material"], source, f"{where}.material", own)
    several = entry.get("materials", {})
    if not isinstance(several, dict):
        raise toml_file.wrong(several, "a table of body = material", source, f"{where}.materials")
    materials = {body: _named(value, source, f"{where}.materials.{body}", own) for body, value in several.items()}
    body = entry.get("body")
    if body is not None and (isinstance(body, bool) or not isinstance(body, str | int)):
        raise toml_file.wrong(body, "a body's name (STEP) or its number from 1 (mesh)", source, f"{where}.body")
    # Turned about the article's x, then y, then z, then carried to its position
    threes = []
    for key in ("position_mm", "rotation_deg"):
        found = entry.get(key, [0, 0, 0])
        numbers = isinstance(found, list) and all(toml_file.is_number(v) for v in found)
        if not numbers or len(found) != 3 or not np.isfinite(np.array(found, dtype=np.float64)).all():
            raise toml_file.wrong(found, "three finite numbers", source, f"{where}.{key}")
        threes.append(np.array(found, dtype=np.float64))
    x, y, z = np.deg2rad(threes[1])
    turn = rotation_about("z", z) @ rotation_about("y", y) @ rotation_about("x", x)
    return PartEntry(
        name=name,
        file=there,
        unit=unit,
        material=whole,
        materials=materials,
        body=None if body is None else str(body),
        pose=Pose(position=1e-3 * threes[0], rotation=turn),
        named=True,
    )


def _named(value: Any, source: str, where: str, own: Mapping[str, Material]) -> Material:
    if not isinstance(value, str):
        raise toml_file.wrong(value, "a name of a material or a density as text", source, where)
    return made_of(value, f"{source}, {where}", own)


def own_material(name: str, entry: Any, source: str, where: str) -> Material:
    """The material that the table `entry` states; `source` has it at `where`.

    Raises
    ------
    BadInput : an unknown key, no density, a value without its unit or out of its range.
    """
    table = toml_file.require_table(entry, source=source, where=where)
    toml_file.require_known(table, ("density", *_ELASTIC), source=source, where=where)
    if "density" not in table:
        raise BadInput(source, f"{where}.density", "is missing", 'Add density = "7800 kg/m^3"')
    elastic = {}
    for key in _ELASTIC:
        if key in table:
            # A modulus [Pa], Poisson's ratio or loss factor, within its range
            value = table[key]
            place = f"{where}.{key}"
            dimension, lowest, highest, example = _ELASTIC[key]
            text = str(value) if dimension == "ratio" and toml_file.is_number(value) else value
            found = quantity(text, dimension, source=source, field=place).nominal_value
            if not lowest < found < highest:
                problem = f"must lie between {lowest:g} and {highest:g}, both excluded, found {value!r}"
                raise BadInput(source, place, problem, f"Steel has {example}")
            elastic[key] = float(found)
    return Material(name=name, density=density(table["density"], source, f"{where}.density"), **elastic)


def _text(table: dict[str, Any], key: str, source: str, where: str) -> str | None:
    found = table.get(key)
    if found is not None and not isinstance(found, str):
        raise toml_file.wrong(found, "text", source, f"{where}.{key}")
    return found


# `UserPart` and `UserArticle`: bodies as files have them, where `geometry.article` has drawings of primitives.


@dataclass(frozen=True, eq=False, kw_only=True)
class UserPart:
    """One body of one material, in the article's frame.

    Attributes
    ----------
    name : unique within its article
    material : what it is made of
    source : the file it came from
    mesh : its skin, closed and checked
    chord : [m], how far `mesh` may lie from the true surface: 0 when the mesh is what the file holds
    solid : its CadQuery solid [mm], when it came from a STEP file; else None
    refused : why `mesh` is no skin of a body though `solid` is sound; empty where it is one
    at_unit_density : of `solid` by OCC, in the article's frame
    curved_area, curved_reach : area [m²] of the faces of `solid` that are not planes, corners (n, 3) [m] of boxes around them
    estimate : at unit density in the article's frame, where `mesh` is no skin and nothing else is known
    """

    name: str
    material: Material
    source: str
    mesh: meshes.TriangleMesh
    chord: float = 0.0
    solid: Any = None
    refused: str = ""
    at_unit_density: Inertia | None = None
    curved_area: float = 0.0
    curved_reach: Array = field(default_factory=lambda: np.zeros((0, 3)))
    estimate: EstimatedBody | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class UserArticle:
    """A user's article.

    Attributes
    ----------
    name : of the article, or of its file
    parts : all bodies, in the article's frame
    note : one sentence on where the geometry comes from
    warnings : what a user should know before trusting the figures, each a sentence
    """

    name: str
    parts: tuple[UserPart, ...]
    note: str = ""
    warnings: tuple[str, ...] = ()

    def __post_init__(self) -> None:
        require_unique_names(part.name for part in self.parts)

    @property
    def exact(self) -> bool:
        """Whether every part is a solid, so that its B-rep can be integrated exactly."""
        return all(part.solid is not None for part in self.parts)


# The routes from a user's files to inertia, and whether they agree.
#
# Solids from STEP go two ways: OCC integrates the B-rep, trimesh a closed mesh of it with a stated chord
# error. Meshes are already what trimesh integrates, exactly, and there is no second opinion on them.

ESTIMATE = "estimate"
"""The route of what encloses no volume by definition."""

LEAST, MOST = 5e-3, 5.0
"""Largest dimension [m] of a STEP file outside of which its own unit is doubted: nobody chose it on the command line."""

NOTHING = 1e-3
"""Share of the smaller of two parts that their meshes may have in common before it is worth a warning."""


def inertias(article: UserArticle) -> Mapping[str, Inertia]:
    """Inertia of `article` about its origin by route: "trimesh", and before it "occ" when every part is a solid.

    "occ" alone where the mesh of a solid is no skin; `ESTIMATE` alone where that is so of a part that is a mesh.
    """
    nothing = Inertia(parameters=np.zeros(10))
    if any(part.estimate for part in article.parts):
        one_by_one = (
            meshes.inertia_unchecked(part.mesh, part.material.density)
            if part.estimate is None
            else part.estimate.inertia.scaled(part.material.density)
            for part in article.parts
        )
        return {ESTIMATE: sum(one_by_one, nothing)}
    found = {}
    solids = [part.at_unit_density.scaled(part.material.density) for part in article.parts if part.at_unit_density]
    if article.exact:
        found["occ"] = sum(solids, nothing)
    if not any(part.refused for part in article.parts):
        found["trimesh"] = sum((meshes.inertia_unchecked(part.mesh, part.material.density) for part in article.parts), nothing)
    return found


def agreement(article: UserArticle, found: Mapping[str, Inertia]) -> Agreement:
    """Hold "occ" against "trimesh", to rounding and to what the chord error of the curved faces can make."""
    nothing = frozen(np.zeros(10), (10,), "nothing")
    if refused := [f"{part.name} ({part.refused})" for part in article.parts if part.refused]:
        words = "estimated from generalised winding numbers, with 95 % intervals" if ESTIMATE in found else "occ alone"
        text = f"{words}: no mesh route, since the mesh is no skin of a body: {'; '.join(refused)}"
        return Agreement(agree=False, text=text, difference=nothing, tolerance=nothing, excess=0.0)
    if "occ" not in found:
        text = "one route only: a mesh is integrated exactly as it is, and nothing else is known of it"
        return Agreement(agree=True, text=text, difference=nothing, tolerance=nothing, excess=0.0)
    # A mesh within the chord error of the true surface misses or adds at most a shell over the curved faces
    exact, missed = rounding(found["occ"]), np.zeros(10)
    for part in article.parts:
        shell, reach = part.material.density * part.curved_area * part.chord, np.abs(part.curved_reach)
        missed = missed + missing_mass(shell, reach.max(axis=0, initial=0.0))
    return held_together(found, {"occ": exact, "trimesh": exact + missed})


def overlap_warnings(article: str, parts: tuple[UserPart, ...]) -> Iterator[str]:
    """A sentence for every two parts that share a sliver of volume, as meshes of curved surfaces in contact do.

    Raises
    ------
    BadInput : two parts share more than that; it would count in both materials.
    """
    skins = [part for part in parts if not part.refused]
    for (i, j), volume in meshes.shared_volumes([part.mesh for part in skins]).items():
        share = volume / min(skins[i].mesh.volume, skins[j].mesh.volume)
        said = f"parts {skins[i].name} and {skins[j].name} overlap: {share:.2%} of the smaller one counts twice"
        if share > meshes.SLIVER:
            raise BadInput(article, "", said, "Cut one by the other in the CAD, or correct its position")
        if share > NOTHING:
            yield said


# From a path to a `UserArticle`: one file with one material, or an ``article.toml`` that says which body is made of what.

STEP_ENDINGS = (".step", ".stp")
ENDINGS = (*STEP_ENDINGS, *meshes.MESH_ENDINGS, ".toml")
"""Files that can be an article, upper or lower case; a folder stands for the ``article.toml`` in it."""


def load(
    path: str | Path, *, unit: str | None = None, material: str | None = None, chord: float | None = None, repair: bool = False
) -> UserArticle:
    """The article in the file or folder `path`, every mesh closed and checked, every body with its material.

    `unit` is that of a mesh file's numbers (mm, cm, m, in, ft); it may be left out where the file itself states one, and STEP
    always does. `material` is a name of the library or a density such as ``"7800 kg/m^3"``, for all bodies; of an
    ``article.toml`` both go to the parts that state none themselves. `chord` [m] is that of the meshes made of STEP solids, by
    default `geometry.cad.RELATIVE_CHORD` of each. `repair` mends what is safe in a mesh and estimates what is left, see
    `geometry.repair`.

    Raises
    ------
    BadInput : whatever is wrong with path, file, unit, material or mesh.
    """
    path = require_file(path)
    given = None if material is None else made_of(material, "--material")
    if path.suffix.lower() == ".toml":
        # The article that `path` describes; `unit` and `given` go to the parts that state none
        found = read(path)
        bodies_read: list[UserPart] = []
        noticed: list[str] = []
        for entry in found.parts:
            default = None if entry.file.suffix.lower() in STEP_ENDINGS else unit
            there, said = _parts(replace(entry, unit=entry.unit or default, material=entry.material or given), chord, repair)
            bodies_read += there
            noticed += said
        return _finished(found.name, tuple(bodies_read), f"{found.name}: read from {path.name}.", tuple(noticed))
    parts, warnings = _parts(PartEntry(name=path.stem, file=path, unit=unit, material=given), chord, repair)
    return _finished(path.stem, parts, f"{path.stem}: read from {path.name}.", warnings)


def require_file(path: str | Path) -> Path:
    """The file that `path` is or, of a folder, its ``article.toml``; parts that it names are not looked at.

    Raises
    ------
    BadInput : there is none, it is a device, one of its ending cannot be an article, or a TOML that describes none.
    """
    path = Path(path)
    if not path.exists():
        raise BadInput(str(path), "", "there is no such file or folder", "Check the path")
    if path.is_dir():
        there = path / DESCRIPTION
        if there.is_file():
            return there
        parts = sorted(file for file in path.iterdir() if file.suffix.lower() in (*STEP_ENDINGS, *meshes.MESH_ENDINGS))
        if not parts:
            problem = f"the folder holds neither {DESCRIPTION} nor a part ({', '.join(ENDINGS[:-1])})"
            raise BadInput(str(path), "", problem, "Check the path")
        problem = f"the folder holds {len(parts)} part(s) but no {DESCRIPTION} to say what they are of"
        remedy = f"Put this into {there}, corrected:\n\n{template(path.name, parts)}\nThen try again"
        raise BadInput(str(path), "", problem, remedy)
    if not path.is_file():
        raise BadInput(str(path), "", "it is a device or a pipe, where a file is needed", "Check the path")
    if path.suffix.lower() not in ENDINGS:
        raise _unreadable(path)
    if path.suffix.lower() == ".toml":
        read(path)
    return path


def _unreadable(path: Path) -> BadInput:
    toml_file.require_no_other(path)
    problem = f"a file that ends in {path.suffix.lower() or 'nothing'} cannot be read"
    remedy = f"Give one of {', '.join(ENDINGS)}, or a robot's .urdf, .xml or .sdf"
    return BadInput(str(path), "", problem, remedy)


def _finished(name: str, parts: tuple[UserPart, ...], note: str, warnings: tuple[str, ...]) -> UserArticle:
    if all(part.solid is not None for part in parts):
        from geometry.cad import stated_unit

        size = np.ptp(np.vstack([part.mesh.bounds for part in parts]), axis=0)
        units = dict.fromkeys(map(stated_unit, dict.fromkeys(Path(part.source) for part in parts)))
        note = f"{note[:-1]}, in {' and '.join(units)}: {' x '.join(f'{1e3 * one:.4g}' for one in size)} mm."
    return UserArticle(name=name, parts=parts, note=note, warnings=(*dict.fromkeys(warnings), *overlap_warnings(name, parts)))


def _parts(entry: PartEntry, chord: float | None, repair: bool) -> tuple[tuple[UserPart, ...], tuple[str, ...]]:
    """The bodies that one entry stands for, and what was noticed."""
    ending = entry.file.suffix.lower()
    if ending in STEP_ENDINGS:
        from geometry import cad

        if entry.unit is not None:
            problem = f"a STEP file states its own unit, and {entry.unit!r} was given beside it"
            raise BadInput(str(entry.file), "unit", problem, "Leave the unit out")
        found = cad.read(entry.file, chord)
        if entry.body is not None:
            chosen = tuple(body for body in found if entry.body in (body.name, body.label))
            found = chosen or _no_body(entry, [body.name for body in found])
        materials = {body.name: entry.materials.get(body.name, entry.materials.get(body.label, entry.material)) for body in found}
        names = {name for body in found for name in (body.name, body.label)}
        for name in entry.materials:
            if name not in names:
                _no_body(entry, sorted(names), name)
        missing = [name for name, found in materials.items() if found is None]
        if missing:
            rows = ", ".join(f'"{name}" = "..."' for name in missing)
            problem = f"no material is given for {', '.join(missing)}"
            remedy = (
                f"Give one for all (--material steel), or one for each in an {DESCRIPTION}: "
                f'[[part]] name = "{entry.name}", file = "{entry.file.name}", materials = {{ {rows} }}'
            )
            raise BadInput(str(entry.file), "material", problem, remedy)
        parts: list[UserPart] = []
        for body, same in zip(found, cad.alike([body.solid for body in found]), strict=True):
            if (made := materials[body.name]) is None:
                continue
            name = body.name if not entry.named else entry.name if len(found) == 1 else f"{entry.name}/{body.name}"
            solid = cad.moved(body.solid, entry.pose)
            if same < len(parts):  # drawn once, used several times: all that follows is known from its first place
                like, pose = parts[same], cad.placement(solid) @ cad.placement(parts[same].solid).inverse
                mesh, reach = meshes.placed(like.mesh, pose), pose.apply(like.curved_reach)
                inertia = like.at_unit_density and like.at_unit_density.placed(pose)
                here = replace(
                    like, name=name, material=made, solid=solid, mesh=mesh, curved_reach=reach, at_unit_density=inertia
                )
                parts.append(here)
                continue
            mesh, refused = cad.mesh_of_faces(solid), ""
            try:
                meshes.require_closed_volume(mesh, f"{entry.file}, mesh of {body.name}", MILLIMETRE)
            except BadInput as error:  # the solid is sound, and its exact route needs no mesh
                refused = error.problem
            area, reach = cad.curved(solid)
            parts.append(
                UserPart(
                    name=name,
                    material=made,
                    source=str(entry.file),
                    mesh=mesh,
                    chord=body.chord,
                    solid=solid,
                    refused=refused,
                    at_unit_density=cad.from_occ(solid, 1.0),
                    curved_area=area,
                    curved_reach=reach,
                )
            )
        corners = np.vstack([part.mesh.bounds for part in parts])
        longest, own = float(np.ptp(corners, axis=0).max()), cad.stated_unit(entry.file)
        doubt = (
            f"{entry.file}: in {own}, its own unit, it is {longest:.4g} m long, which is suspicious; check the unit of the export"
        )
        return tuple(parts), () if LEAST <= longest <= MOST else (doubt,)
    if ending in meshes.MESH_ENDINGS:
        return _from_mesh(entry, repair)
    raise _unreadable(entry.file)


def _from_mesh(entry: PartEntry, repair: bool) -> tuple[tuple[UserPart, ...], tuple[str, ...]]:
    source = str(entry.file)
    mesh, unit, doubts = meshes.read_mesh(entry.file, entry.unit)
    refused, found, touching = "", tuple[meshes.TriangleMesh, ...](), tuple[str, ...]()
    try:
        touching = meshes.require_closed_volume(mesh, source, unit)
        found = meshes.bodies(mesh)
    except BadInput as error:
        if not repair:
            mend = "or add --repair: what is safe is mended, and the rest estimated"
            raise BadInput(source, error.field, error.problem, f"{error.remedy}; {mend}") from None
        after = mended(mesh, unit)
        mesh, doubts = after.mesh, (*doubts, f"{source}: {error.problem}", *(f"{source}: {step}" for step in after.steps))
        try:
            touching = meshes.require_closed_volume(mesh, source, unit)
            found = meshes.bodies(mesh)
        except BadInput as left:
            refused = left.problem
    if entry.materials:
        problem = "bodies of a mesh have no names"
        raise BadInput(source, "materials", problem, "Give each a [[part]] of its own with body = 1, 2 ...")
    if entry.material is None:
        raise BadInput(source, "material", "no material is given", 'Give a name (steel) or a density ("7800 kg/m^3")')
    if entry.body is not None and refused:
        problem = f"its bodies cannot be told apart, since {refused}"
        raise BadInput(source, "body", problem, "Mend the mesh, or leave the body out")
    if entry.body is not None:
        numbers = [str(number) for number in range(1, len(found) + 1)]
        if entry.body not in numbers:
            _no_body(entry, numbers)
        mesh = found[int(entry.body) - 1]
    elif len(found) > 1:
        # How a user learns that one density may not do
        listed = "; ".join(
            f"body {number}: {body.volume / unit.metres**3:.6g} {unit.name}³ around {unit.shown(body.bounds.mean(axis=0))}"
            for number, body in enumerate(found[:6], start=1)
        )
        more = f"; and {len(found) - 6} more" if len(found) > 6 else ""
        several = (
            f"{entry.file}: {len(found)} separate bodies are taken as one material ({listed}{more}); if they differ, give each a "
            f"[[part]] with its own body = 1, 2 ... and material in an {DESCRIPTION}"
        )
        doubts = (*doubts, *touching, several)
    placed, estimate = meshes.placed(mesh, entry.pose), None
    if refused:
        try:
            estimate = estimated(placed)
        except ValueError:
            raise BadInput(source, "", f"it encloses nothing: {refused}", "Export the body again") from None
    made = entry.material
    return (UserPart(name=entry.name, material=made, source=source, mesh=placed, refused=refused, estimate=estimate),), doubts


def _no_body(entry: PartEntry, names: list[str], wanted: str | None = None) -> NoReturn:
    problem = f"it holds no body {wanted or entry.body!r}"
    raise BadInput(str(entry.file), "materials" if wanted else "body", problem, f"It holds {', '.join(names)}")
