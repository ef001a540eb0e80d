"""STEP files: named bodies at their places, in millimetres whatever unit the file is written in."""

import faulthandler
import hashlib
import io
import os
import pickle
import re
import signal
import tempfile
from collections import Counter
from collections.abc import Iterator, Sequence
from contextlib import contextmanager
from itertools import combinations, product
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from geometry import atomic
from geometry.article import Article, Box, Part, Placed
from geometry.errors import BadInput, require_fetched
from geometry.frames import Array, Pose
from geometry.inertia import Inertia
from geometry.mesh import Integers, TriangleMesh

# Drawings turned into OCC solids by CadQuery: material united, voids cut. In millimetres.

MM = 1e-3
"""One OCC length unit in metres."""

OccShape = Any
"""A `cadquery.Shape`; the library has no types of its own."""


def solid(part: Part) -> OccShape:
    """The part as a CadQuery compound [mm], in the article's frame, its voids cut out."""
    from cadquery import Compound

    material = Compound.makeCompound([_placed(placed) for placed in part.shape.solids])
    tools = [_placed(void) for void in part.shape.voids]
    cut = material.cut(*tools) if tools else material
    return cut.moved(location(part.pose))


def _placed(placed: Placed) -> OccShape:
    """The primitive, drawn centred on its own origin, at its place."""
    from cadquery import Solid, Vector

    primitive = placed.primitive
    if isinstance(primitive, Box):
        x, y, z = primitive.size / MM
        drawn = Solid.makeBox(x, y, z, Vector(-x / 2, -y / 2, -z / 2))
    else:
        height = primitive.height / MM
        drawn = Solid.makeCylinder(primitive.diameter / 2 / MM, height, Vector(0, 0, -height / 2))
    return drawn.moved(location(placed.pose))


def location(pose: Pose) -> Any:
    """`pose` as a CadQuery location, its translation in millimetres."""
    from cadquery import Location
    from OCP.gp import gp_Trsf

    transformation = gp_Trsf()
    transformation.SetValues(*np.column_stack([pose.rotation, pose.position / MM]).ravel().tolist())
    return Location(transformation)


RELATIVE_CHORD = 1e-4
"""Chord error of the mesh of a solid where none is asked for, relative to the diagonal of the box around it."""

TIME_LIMIT = 600
"""[s] after which a file of a megabyte or more that OCC never finishes counts as corrupt."""

SMALL = 60
"""[s] after which one of next to nothing does."""


class Body(NamedTuple):
    """One solid of a STEP file.

    Attributes
    ----------
    name : unique in its file; bodies that share a name are numbered, ``bolt-1``, ``bolt-2``
    label : the name as the file has it
    solid : a CadQuery solid [mm], in the frame of the file, with a mesh of its faces
    chord : chord error of that mesh [m]
    valid, volume : whether OCC finds the solid so, and what it finds inside [mm³]
    """

    name: str
    label: str
    solid: OccShape
    chord: float
    valid: bool
    volume: float


def read(path: Path, chord: float | None = None) -> tuple[Body, ...]:
    """Every solid of the STEP file `path`, at its place in the assembly, in the order of the file.

    `chord` [m] is that of the meshes which they come with, by default `RELATIVE_CHORD` of each.

    Raises
    ------
    BadInput : not a STEP file, corrupt, without solids (the message says what it holds instead), or with a solid that OCC
        finds invalid or without positive volume.
    """
    source = str(path)
    content = path.read_bytes()
    require_fetched(content, source)
    if not content[:256].lstrip().startswith(b"ISO-10303-21"):
        raise BadInput(source, "", "it is not a STEP file (it does not begin with ISO-10303-21)", _AGAIN)
    if b"END-ISO-10303-21" not in content[-256:]:
        raise BadInput(source, "", "it is cut short (it does not end with END-ISO-10303-21)", _AGAIN)
    numbers = re.findall(rb"^\s*#(\d+)\s*=", content, re.MULTILINE)
    if len(set(numbers)) < len(numbers):  # OCC may never end on it
        twice = Counter(numbers).most_common(1)[0][0].decode()
        raise BadInput(source, "", f"two of its entities are #{twice}: the file is corrupt", _AGAIN)
    try:
        found = _read_apart(path, chord)
    except BadInput:
        raise
    except Exception as error:  # OCC raises Standard_Failure and Python errors alike on corrupt files
        raise BadInput(source, "", f"OCC cannot read it ({type(error).__name__})", _AGAIN) from error
    total, seen, bodies = Counter(one.label for one in found), Counter[str](), list[Body]()
    for one in found:
        seen[one.label] += 1
        bodies.append(one if total[one.label] == 1 else one._replace(name=f"{one.label}-{seen[one.label]}"))
    if not bodies:
        shapes = [shape for _, shape in _leaves(path)]
        kinds = {"shell": "Shells", "face": "Faces", "wire": "Wires", "edge": "Edges", "vertex": "Vertices"}
        counts = {kind: sum(len(getattr(shape, method)()) for shape in shapes) for kind, method in kinds.items()}
        contents = ", ".join(f"{count} {kind}(s)" for kind, count in counts.items() if count) or "nothing"
        remedy = "Export solids; surfaces must be closed and made solid in the CAD first"
        raise BadInput(source, "", f"it holds no solid body, only {contents}", remedy)
    for body in bodies:
        if not body.valid or not body.volume > 0:
            problem = f"the solid is not sound: OCC finds it {'' if body.valid else 'in'}valid, volume {body.volume:.6g} mm³"
            remedy = "Heal the solid in the CAD (closed shell, faces outwards) and export it again"
            raise BadInput(source, body.name, problem, remedy)
    return tuple(bodies)


def stated_unit(path: Path) -> str:
    """The unit of length in which the STEP file `path` is written, in words; OCC has turned it into millimetres."""
    with path.open("rb") as file:
        content = file.read()
    if inch := re.search(rb"CONVERSION_BASED_UNIT\s*\(\s*'(INCH|FOOT)'", content, re.IGNORECASE):
        return {b"INCH": "inches", b"FOOT": "feet"}[inch[1].upper()]
    metric = re.search(rb"LENGTH_UNIT[^;]*?SI_UNIT\s*\(\s*(\$|\.\w+\.)\s*,\s*\.METRE\.", content)
    prefix = {b"$": "", b".MILLI.": "milli", b".CENTI.": "centi", b".MICRO.": "micro", b".KILO.": "kilo"}
    return f"{prefix[metric[1]]}metres" if metric and metric[1] in prefix else "an unknown unit"


def moved(solid: OccShape, pose: Pose) -> OccShape:
    """`solid` [mm], given in its own frame, at `pose` of an outer frame."""
    return solid.moved(location(pose))


def diagonal(solid: OccShape) -> float:
    """Diagonal [m] of the box around `solid`."""
    return float(solid.BoundingBox().DiagonalLength) * MM


def curved(solid: OccShape) -> tuple[float, Array]:
    """Area [m²] of the faces of `solid` that are not planes, and the corners (n, 3) [m] of boxes around them."""
    faces = [face for face in solid.Faces() if face.geomType() != "PLANE"]
    boxes = [face.BoundingBox() for face in faces]
    corners = [place for b in boxes for place in product((b.xmin, b.xmax), (b.ymin, b.ymax), (b.zmin, b.zmax))]
    return sum(face.Area() for face in faces) * MM**2, np.array(corners).reshape(-1, 3) * MM


_ENTRY = re.compile(r"=>\s*\[[\d:]+\]|Open CASCADE STEP translator [\d. ]+")
"""What OCC calls an instance or product that nobody named: where it refers to, or itself."""

_AGAIN = "Check that the file is whole and what its ending says, and export it again as STEP (AP203, AP214 or AP242)"


def _read_apart(path: Path, chord: float | None) -> list[Body]:
    """All solids of the file, examined by a child process: on corrupt ones OCC may end the one that reads or meshes them."""
    from cadquery import Compound, Shape

    with tempfile.TemporaryFile() as passed:
        child = os.fork()
        if not child:
            try:
                faulthandler.disable()
                for number in (1, 2):
                    os.dup2(os.open(os.devnull, os.O_WRONLY), number)
                signal.alarm(SMALL + round((TIME_LIMIT - SMALL) * min(path.stat().st_size / 2**20, 1.0)))
                found, shapes = _examined(path, chord), io.BytesIO()
                Compound.makeCompound([one.solid for one in found]).exportBin(shapes)
                pickle.dump((shapes.getvalue(), [one._replace(solid=None) for one in found]), passed)
                passed.flush()
            finally:
                os._exit(0)
        if os.WIFSIGNALED(os.waitpid(child, 0)[1]):
            raise BadInput(str(path), "", "OCC breaks down on it: the file is corrupt", _AGAIN)
        if not passed.seek(0, os.SEEK_END):
            return _examined(path, chord)  # what the child found wrong without dying is found again, and said
        passed.seek(0)
        content, found = pickle.load(passed)
    return [one._replace(solid=solid) for one, solid in zip(found, Shape.importBin(io.BytesIO(content)), strict=True)]


def _examined(path: Path, chord: float | None) -> list[Body]:
    solids = [(label, solid) for label, shape in _leaves(path) for solid in shape.Solids()]
    found: list[Body] = []
    for (label, solid), same in zip(solids, alike([solid for _, solid in solids]), strict=True):
        if same < len(found):
            found.append(found[same]._replace(name=label, label=label, solid=solid))
            continue
        valid, volume, fine = solid.isValid(), solid.Volume(), chord or RELATIVE_CHORD * diagonal(solid)
        _mesh_faces(solid, fine)
        found.append(Body(name=label, label=label, solid=solid, chord=fine, valid=valid, volume=volume))
    return found


def alike(solids: Sequence[OccShape]) -> list[int]:
    """For each of `solids` the number of the first that is the same body, there or at another place: itself where none is."""
    first: list[int] = []
    for number, solid in enumerate(solids):
        turn, shape = solid.wrapped.Orientation(), solid.wrapped
        earlier = ((k, solids[k].wrapped) for k in dict.fromkeys(first))
        first.append(next((k for k, one in earlier if one.IsPartner(shape) and one.Orientation() == turn), number))
    return first


def placement(solid: OccShape) -> Pose:
    """Where `solid` stands that is drawn once and used in several places."""
    found = solid.wrapped.Location().Transformation()
    matrix = np.array([[found.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)])
    return Pose(position=matrix[:, 3] * MM, rotation=matrix[:, :3])


def _leaves(path: Path) -> list[tuple[str, OccShape]]:
    """Names and placed CadQuery shapes of everything in the file that is not itself an assembly."""
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    with silence():
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        Interface_Static.SetCVal_s("xstep.cascade.unit", "MM")
        if reader.ReadFile(str(path)) != IFSelect_RetDone:
            raise BadInput(str(path), "", "OCC cannot read it: the file is corrupt or cut short", _AGAIN)
        document = TDocStd_Document(TCollection_ExtendedString("massline"))
        if not reader.Transfer(document):
            raise BadInput(str(path), "", "it holds no body, surface or curve", _AGAIN)
        tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
        return [leaf for label in _sequence(tool.GetFreeShapes) for leaf in _walk(tool, label, None, "")]


def _walk(tool: Any, label: Any, location: Any, inherited: str) -> Iterator[tuple[str, OccShape]]:
    """The leaves below `label`, at `location` (a TopLoc_Location or None); a nameless one has the name of what holds it."""
    from cadquery import Shape
    from OCP.TDataStd import TDataStd_Name
    from OCP.TDF import TDF_Label

    attribute = TDataStd_Name()
    own = str(attribute.Get().ToExtString()).strip() if label.FindAttribute(TDataStd_Name.GetID_s(), attribute) else ""
    own = "" if _ENTRY.fullmatch(own) else own
    name = own or inherited
    if tool.IsReference_s(label):
        target = TDF_Label()
        tool.GetReferredShape_s(label, target)
        here = tool.GetLocation_s(label)
        yield from _walk(tool, target, here if location is None else location.Multiplied(here), name)
    elif tool.IsAssembly_s(label):
        for component in _sequence(lambda found: tool.GetComponents_s(label, found)):
            yield from _walk(tool, component, location, name)
    else:
        shape = tool.GetShape_s(label)
        yield inherited or name or "body", Shape.cast(shape if location is None else shape.Moved(location))


def _sequence(fill: Any) -> list[Any]:
    from OCP.TDF import TDF_LabelSequence

    found = TDF_LabelSequence()
    fill(found)
    return [found.Value(number) for number in range(1, found.Length() + 1)]


@contextmanager
def silence() -> Iterator[None]:
    """Keep OCC's own messages off the terminal; its printers are put back afterwards."""
    from OCP.Message import Message

    messenger = Message.DefaultMessenger_s()
    printers = list(messenger.Printers())
    for printer in printers:
        messenger.RemovePrinter(printer)
    try:
        yield
    finally:
        for printer in printers:
            messenger.AddPrinter(printer)


# Exact mass properties of OCC solids: the faces' own surfaces are integrated, nothing is meshed.

INTEGRATION_ERROR = 1e-12
"""Relative error asked of OCC's adaptive integration over curved faces."""


def inertia(article: Article) -> Inertia:
    """Inertia of the article's counted parts from their B-rep, about the article's origin, in its frame."""
    total = Inertia(parameters=np.zeros(10))
    for part in article.counted_parts:
        total = total + from_occ(solid(part), part.material.density)
    return total


def from_occ(shape: OccShape, density: float) -> Inertia:
    """Inertia of a CadQuery shape [mm] of uniform `density` [kg/m³], about the origin of the shape's frame.

    OCC integrates at unit density: volume in mm³, tensor about the centre of mass in mm⁵, products as matrix entries.
    """
    from OCP.BRepGProp import BRepGProp
    from OCP.GProp import GProp_GProps

    properties = GProp_GProps()
    BRepGProp.VolumeProperties_s(shape.wrapped, properties, INTEGRATION_ERROR, False, False)
    return _of_properties(properties, density)


def _of_properties(properties: Any, density: float) -> Inertia:
    centre, matrix = properties.CentreOfMass(), properties.MatrixOfInertia()
    tensor = np.array([[matrix.Value(i, j) for j in (1, 2, 3)] for i in (1, 2, 3)])
    return Inertia.from_cog(
        density * properties.Mass() * MM**3, np.array([centre.X(), centre.Y(), centre.Z()]) * MM, density * tensor * MM**5
    )


def of_triangles(mesh: TriangleMesh, density: float) -> Inertia:
    """Inertia about the mesh's origin of the body of `density` [kg/m³] within a closed `mesh`, as OCC integrates triangles."""
    from OCP.BRep import BRep_Builder
    from OCP.BRepGProp import BRepGProp
    from OCP.gp import gp_Pnt
    from OCP.GProp import GProp_GProps
    from OCP.Poly import Poly_Triangle, Poly_Triangulation
    from OCP.TopoDS import TopoDS_Face

    surface = Poly_Triangulation(len(mesh.vertices), len(mesh.faces), False)
    middle = mesh.bounds.mean(axis=0)  # integrated about its middle, so that a body far from the origin loses no digits
    for number, place in enumerate(((mesh.vertices - middle) / MM).tolist(), start=1):
        surface.SetNode(number, gp_Pnt(*place))
    for number, corners in enumerate((mesh.faces + 1).tolist(), start=1):
        surface.SetTriangle(number, Poly_Triangle(*corners))
    face, properties = TopoDS_Face(), GProp_GProps()
    BRep_Builder().MakeFace(face, surface)
    BRepGProp.VolumeProperties_s(face, properties, False, False, True)
    return _of_properties(properties, density).moved(middle)


def overlaps(article: Article) -> dict[tuple[str, str], float]:
    """Pairs of parts that share volume, and how much [m³], by intersecting their B-reps.

    Every part is looked at, counted or not. Contact without common volume is no overlap; what counts as none is relative, a
    part in 1e9 of the smaller body, since OCC's intersection of touching cylinders may leave slivers.
    """
    solids = {part.name: solid(part) for part in article.parts}
    volumes = {name: shape.Volume() for name, shape in solids.items()}
    boxes = {name: shape.BoundingBox() for name, shape in solids.items()}
    shared = {}
    for a, b in combinations(solids, 2):
        p, q = boxes[a], boxes[b]
        lower = np.maximum([p.xmin, p.ymin, p.zmin], [q.xmin, q.ymin, q.zmin])
        upper = np.minimum([p.xmax, p.ymax, p.zmax], [q.xmax, q.ymax, q.zmax])
        if np.all(upper > lower):
            shared[a, b] = solids[a].intersect(solids[b]).Volume()
    return {pair: v * MM**3 for pair, v in shared.items() if v > 1e-9 * min(volumes[pair[0]], volumes[pair[1]])}


# Solids out of the house, in millimetres.


def write_brep(path: Path, solid: OccShape) -> None:
    """Write `solid` [mm] as OCC's own BREP text: every digit, no names."""
    atomic.write_with(path, lambda temporary: solid.exportBrep(str(temporary)))


def brep_digest(solid: OccShape) -> str:
    """SHA-256 of the BREP text of `solid`, hexadecimal: the same for the same geometry, whatever file it came from."""
    text = io.BytesIO()
    solid.exportBrep(text)
    return hashlib.sha256(text.getvalue()).hexdigest()


# Solids turned into closed triangle meshes with a stated chord error.

ANGLE = 0.5
"""Largest angle between neighbouring facets [rad]: small holes keep at least twelve sides whatever the chord error."""

WELD = 1e-6
"""Vertices of neighbouring faces closer than this [mm] are one; OCC discretises a shared edge once, so they coincide."""


def tessellate(part: Part, chord: float) -> TriangleMesh:
    """Closed mesh of `part` in the article's frame; no chord lies further than `chord` [m] from the true surface."""
    return tessellate_solid(solid(part), chord)


def tessellate_solid(shape: OccShape, chord: float) -> TriangleMesh:
    """Closed mesh [m] of a CadQuery shape [mm] with chord error `chord` [m], vertices of neighbouring faces welded."""
    from OCP.BRepTools import BRepTools

    BRepTools.Clean_s(shape.wrapped)  # OCC keeps a finer mesh made before; the chord error asked for is the one given
    _mesh_faces(shape, chord)
    return mesh_of_faces(shape)


def _mesh_faces(shape: OccShape, chord: float) -> None:
    """Give every face of a CadQuery shape [mm] that has none yet a mesh with chord error `chord` [m]."""
    from OCP.BRepMesh import BRepMesh_IncrementalMesh

    # CadQuery by itself would take the chord error relative to each edge's length; here it is a length.
    BRepMesh_IncrementalMesh(shape.wrapped, chord / MM, False, ANGLE)


def mesh_of_faces(shape: OccShape) -> TriangleMesh:
    """The meshes [m] that the faces of a CadQuery shape [mm] have as one, vertices of neighbouring faces welded."""
    from OCP.BRep import BRep_Tool
    from OCP.TopAbs import TopAbs_REVERSED
    from OCP.TopLoc import TopLoc_Location

    points, triangles, count = list[Array](), list[Integers](), 0
    for face in shape.Faces():
        location = TopLoc_Location()
        if (found := BRep_Tool.Triangulation_s(face.wrapped, location)) is None:
            continue
        turn = location.Transformation()
        matrix = np.array([[turn.Value(i, j) for j in (1, 2, 3, 4)] for i in (1, 2, 3)])
        nodes = np.array([(node.X(), node.Y(), node.Z()) for node in map(found.Node, range(1, found.NbNodes() + 1))])
        corners = np.array([one.Get() for one in found.Triangles()], dtype=np.int64) - 1 + count
        count += len(nodes)
        points.append(nodes @ matrix[:, :3].T + matrix[:, 3])
        triangles.append(corners[:, ::-1] if face.wrapped.Orientation() == TopAbs_REVERSED else corners)
    vertices = np.vstack(points)
    _, first, welded = np.unique(np.round(vertices / WELD).astype(np.int64), axis=0, return_index=True, return_inverse=True)
    faces = welded.ravel()[np.vstack(triangles)]
    # At the pole of a patch OCC puts two corners of a triangle into one point; without it its neighbours meet all the same
    whole = np.all(faces != np.roll(faces, 1, axis=1), axis=1)
    return TriangleMesh(vertices=vertices[first] * MM, faces=faces[whole])
