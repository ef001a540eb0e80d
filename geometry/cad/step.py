"""STEP files: named bodies at their places, in millimetres whatever unit the file is written in."""

from __future__ import annotations

from collections import Counter
from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path
from typing import Any, NamedTuple

import numpy as np

from geometry.arrays import Array
from geometry.cad.solids import MM, OccShape
from geometry.cad.solids import location as occ_location
from geometry.errors import BadInput
from geometry.frames import Pose

ENDINGS = (".step", ".stp")
"""What can be read, upper or lower case."""


class Body(NamedTuple):
    """One solid of a STEP file.

    Attributes
    ----------
    name : unique in its file; bodies that share a name are numbered, ``bolt-1``, ``bolt-2``
    label : the name as the file has it
    solid : a CadQuery solid [mm], in the frame of the file
    """

    name: str
    label: str
    solid: OccShape


def read(path: Path) -> tuple[Body, ...]:
    """Every solid of the STEP file `path`, at its place in the assembly, in the order of the file.

    Raises
    ------
    BadInput : not a STEP file, corrupt, without solids (the message says what it holds instead), or with a solid that OCC
        finds invalid or without positive volume.
    """
    source = str(path)
    content = path.read_bytes()
    if not content[:256].lstrip().startswith(b"ISO-10303-21"):
        raise BadInput(source=source, problem="it is not a STEP file (it does not begin with ISO-10303-21)", remedy=_AGAIN)
    if b"END-ISO-10303-21" not in content[-256:]:
        raise BadInput(source=source, problem="it is cut short (it does not end with END-ISO-10303-21)", remedy=_AGAIN)
    try:
        found = _leaves(path)
    except BadInput:
        raise
    except Exception as error:  # OCC raises Standard_Failure and Python errors alike on corrupt files
        raise BadInput(source=source, problem=f"OCC cannot read it ({type(error).__name__})", remedy=_AGAIN) from error
    bodies = _numbered([(label, solid) for label, shape in found for solid in shape.Solids()])
    if not bodies:
        raise BadInput(
            source=source,
            problem=f"it holds no solid body, only {_contents([shape for _, shape in found])}",
            remedy="Export solids; surfaces must be closed and made solid in the CAD first",
        )
    for body in bodies:
        _require_sound(body, source)
    return bodies


def moved(solid: OccShape, pose: Pose) -> OccShape:
    """`solid` [mm], given in its own frame, at `pose` of an outer frame."""
    return solid.moved(occ_location(pose))


def diagonal(solid: OccShape) -> float:
    """Diagonal [m] of the box around `solid`."""
    return float(solid.BoundingBox().DiagonalLength) * MM


def curved_reach(solid: OccShape) -> tuple[float, Array]:
    """Area [m²] of the faces of `solid` that are not planes, and how far they reach from the origin along x, y, z (3,) [m]."""
    curved = [face for face in solid.Faces() if face.geomType() != "PLANE"]
    if not curved:
        return 0.0, np.zeros(3)
    boxes = [face.BoundingBox() for face in curved]
    corners = np.array([[[b.xmin, b.ymin, b.zmin], [b.xmax, b.ymax, b.zmax]] for b in boxes])
    return sum(face.Area() for face in curved) * MM**2, np.abs(corners).max(axis=(0, 1)) * MM


_AGAIN = "Check that the file is whole and what its ending says, and export it again as STEP (AP203, AP214 or AP242)"


def _leaves(path: Path) -> list[tuple[str, OccShape]]:
    """Names and placed CadQuery shapes of everything in the file that is not itself an assembly."""
    from OCP.IFSelect import IFSelect_RetDone
    from OCP.Interface import Interface_Static
    from OCP.STEPCAFControl import STEPCAFControl_Reader
    from OCP.TCollection import TCollection_ExtendedString
    from OCP.TDocStd import TDocStd_Document
    from OCP.XCAFDoc import XCAFDoc_DocumentTool

    with _silence():
        reader = STEPCAFControl_Reader()
        reader.SetNameMode(True)
        Interface_Static.SetCVal_s("xstep.cascade.unit", "MM")
        if reader.ReadFile(str(path)) != IFSelect_RetDone:
            raise BadInput(source=str(path), problem="OCC cannot read it: the file is corrupt or cut short", remedy=_AGAIN)
        document = TDocStd_Document(TCollection_ExtendedString("massline"))
        if not reader.Transfer(document):
            raise BadInput(source=str(path), problem="it holds no body, surface or curve", remedy=_AGAIN)
        tool = XCAFDoc_DocumentTool.ShapeTool_s(document.Main())
        return [leaf for label in _sequence(tool.GetFreeShapes) for leaf in _walk(tool, label, None, "")]


def _walk(tool: Any, label: Any, location: Any, inherited: str) -> Iterator[tuple[str, OccShape]]:
    """The leaves below `label`, at `location` (a TopLoc_Location or None); a nameless one has the name of what holds it."""
    from cadquery import Shape
    from OCP.TDF import TDF_Label

    name = _name(label) or inherited
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


def _name(label: Any) -> str:
    from OCP.TDataStd import TDataStd_Name

    attribute = TDataStd_Name()
    return str(attribute.Get().ToExtString()).strip() if label.FindAttribute(TDataStd_Name.GetID_s(), attribute) else ""


def _numbered(found: list[tuple[str, OccShape]]) -> tuple[Body, ...]:
    total, seen, bodies = Counter(label for label, _ in found), Counter[str](), []
    for label, solid in found:
        seen[label] += 1
        name = label if total[label] == 1 else f"{label}-{seen[label]}"
        bodies.append(Body(name=name, label=label, solid=solid))
    return tuple(bodies)


def _contents(shapes: list[OccShape]) -> str:
    kinds = {"shell": "Shells", "face": "Faces", "wire": "Wires", "edge": "Edges", "vertex": "Vertices"}
    counts = {kind: sum(len(getattr(shape, method)()) for shape in shapes) for kind, method in kinds.items()}
    return ", ".join(f"{count} {kind}(s)" for kind, count in counts.items() if count) or "nothing"


def _require_sound(body: Body, source: str) -> None:
    volume = body.solid.Volume()
    valid = body.solid.isValid()
    if not valid or not volume > 0:
        raise BadInput(
            source=source,
            field=body.name,
            problem=f"the solid is not sound: OCC finds it {'valid' if valid else 'invalid'}, volume {volume:.6g} mm³",
            remedy="Heal the solid in the CAD (closed shell, faces outwards) and export it again",
        )


@contextmanager
def _silence() -> Iterator[None]:
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
