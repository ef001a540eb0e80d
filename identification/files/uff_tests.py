"""What a modal test leaves in a universal file.

Nodes (15, 781, 2411), the systems along whose axes they move (18, 2420), units (164), functions (58) and modes (55, 2414).
"""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path
from typing import Any

import numpy as np

from geometry import sensors, toml_file
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import Point
from identification.files import files, text_table, uff
from identification.files.files import DAMAGED, Samples
from identification.files.uff import Dataset, column

RESPONSE_FUNCTION, COHERENCE, MULTIPLE_COHERENCE = 4, 6, 26
"""Function types of dataset 58."""

QUANTITIES = {8: "displacement", 11: "velocity", 12: "acceleration"}
FORCES = (9, 13)
UNSAID = (0, 1)
"""Specific data types of an ordinate."""

PER_NEWTON = {"acceleration": "m/s^2/N", "velocity": "m/s/N", "displacement": "m/N"}
"""SI units by quantity."""

CARTESIAN, CYLINDRICAL = 0, 1
"""Types of a system of coordinates."""

NORMAL_MODE = 2
MODES = (NORMAL_MODE, 3, 7)
"""Analysis types of datasets 55 and 2414: normal, and complex of displacement and of velocity."""

AXES = "xyz"


@dataclass(frozen=True, kw_only=True)
class NodeAxis:
    """A node and the axis along which it was read or driven: ``x``, ``-z``; empty for a scalar."""

    node: int
    axis: str


NOWHERE = NodeAxis(node=0, axis="")
"""Of a file that names no nodes."""


@dataclass(frozen=True, kw_only=True)
class Unit:
    """What a file says of the numbers of a function.

    Attributes
    ----------
    quantity : of `QUANTITIES`; empty where the file does not say
    inverted : whether the file says that it is force over response; None where it does not say
    factor : what one unit of response per force is in SI; None where the file does not say
    doubt : what contradicts itself or is not known, in words
    """

    quantity: str
    inverted: bool | None
    factor: float | None
    doubt: str

    def size(self, source: str, what: str, unit: float | None) -> float:
        """`factor`; 1 where a study states the `unit` [SI], or nobody does.

        Raises
        ------
        BadInput : a doubt that no `unit` settles, or a `unit` that contradicts the file.
        """
        if unit is None and self.doubt:
            raise BadInput(source, "unit", f"{what} {self.doubt}", 'Write which it is, such as unit = "g/N"')
        if unit is not None and not self.doubt and self.factor and abs(unit / self.factor - 1) > SAME_UNIT:
            problem = f"is {unit:g} in SI, and the file says {self.factor:g} for {what}"
            raise BadInput(source, "unit", problem, "Take `unit` out, or correct the file")
        return self.factor if unit is None and self.factor is not None else 1.0


@dataclass(frozen=True, eq=False, kw_only=True)
class Function:
    """One dataset 58.

    Attributes
    ----------
    kind : `RESPONSE_FUNCTION`, `COHERENCE` or `MULTIPLE_COHERENCE`
    response, reference : where it was read, and where the force acts
    frequency : (n,) [Hz]
    values : (n,) complex, in the units of the file
    unit : what the file says of these
    """

    kind: int
    response: NodeAxis
    reference: NodeAxis
    frequency: Array
    values: ComplexArray
    unit: Unit

    def upright(self, source: str, inverted: bool, unit: float | None) -> ComplexArray:
        """Response over force (n,) in SI; in the `unit` [SI] that a study states for a file, where it does.

        Raises
        ------
        BadInput : which is over which is not what the study says with `inverted`; units that contradict each other.
        """
        what = f"the function of node {self.response.node}"
        if self.unit.inverted and not inverted:
            remedy = "Write inverted = true, or export response over force"
            raise BadInput(source, "functions", f"{what} is force over {self.unit.quantity}", remedy)
        if inverted and self.unit.inverted is False:
            raise BadInput(source, "inverted", f"{what} is response over force already", "Take inverted = true out")
        size = self.unit.size(source, what, unit)
        return self.values / size if inverted else size * self.values


@dataclass(frozen=True, eq=False, kw_only=True)
class Mode:
    """One dataset 55 or 2414.

    Attributes
    ----------
    frequency : [Hz]
    damping_ratio : [1], 0 where it is not stated
    nodes : (p,) numbers
    shape : (p, 3) real or complex, along x, y, z
    """

    frequency: float
    damping_ratio: float
    nodes: tuple[int, ...]
    shape: Samples


@dataclass(frozen=True, eq=False, kw_only=True)
class ModalFile:
    """All of a file.

    Attributes
    ----------
    source : the file
    nodes : (3,) [m] by number
    axes : (3, 3) by number of a node that has axes of its own: its x, y and z (or r, t, z) as rows
    functions, coherences, modes : in the order of the file
    warnings : what was passed over, in words
    """

    source: str
    nodes: dict[int, Array]
    axes: dict[int, Array]
    functions: tuple[Function, ...]
    coherences: tuple[Function, ...]
    modes: tuple[Mode, ...]
    warnings: tuple[str, ...] = ()

    def coherence(self, of: Function) -> Function | None:
        """That of the function between the same nodes, or of the response to all; None where there are several, or none."""
        for reference in (of.reference, NOWHERE):
            found = [one for one in self.coherences if (one.response, one.reference) == (of.response, reference)]
            if len(found) == 1:
                return found[0]
        return None


def read(path: Path) -> ModalFile:
    """What is in `path`; other datasets are passed over.

    Raises
    ------
    BadInput : no universal file, damaged, functions or modes of another kind.
    """
    files.require_file(path)
    source = str(path)
    found = uff.blocks(path.read_bytes(), source)
    units = uff.units(found, source)
    systems, warnings = dict[int, System](), list[str]()
    writer = next((one.lines[5].strip() for one in found if one.number == 151 and len(one.lines) > 5), "")
    # The same shapes that LMS Test.Lab 15A exported along axes of their nodes and along the global ones have them as columns
    columns = re.search(r"test\.?lab", writer, re.IGNORECASE) is not None
    for block, unit in zip(found, units, strict=True):
        if block.number in (18, 2420):
            systems |= _systems(block, systems, source, 1.0 if unit is None else unit.length, columns)
    if columns and any(one.number == 2420 for one in found):
        warnings.append(f"{source}: the axes of dataset 2420 are read as columns, as {writer} writes them")
    nodes, axes = dict[int, Array](), dict[int, Array]()
    functions, modes, over = list[Function](), list[Mode](), Counter[str]()
    for block, unit in zip(found, units, strict=True):
        if block.number in (15, 781, 2411):
            for number, place, turned in _nodes(block, systems, source, 1.0 if unit is None else unit.length):
                nodes[number] = place
                axes.pop(number, None)  # a node that comes again is as the last one says
                axes |= {} if turned is None else {number: turned}
        elif block.number == 58:
            one = _function(block, source, None if unit is None else unit.length / unit.force)
            if isinstance(one, str):
                over[one] += 1
            else:
                functions.append(one)
        elif block.number in (55, 2414) and (mode := _mode(block, source)) is not None:
            modes.append(mode)
    responses = tuple(one for one in functions if one.kind == RESPONSE_FUNCTION)
    if over and not (responses or modes):
        problem = f"it holds no response function (function type {RESPONSE_FUNCTION}), only {', '.join(over)}"
        raise BadInput(source, "functions", problem, "Export response functions, or state `records` if it holds time histories")
    warnings += [f"{source}: {count} functions are passed over: {what}" for what, count in over.items()]
    return ModalFile(
        source=source,
        nodes=nodes,
        axes=axes,
        functions=responses,
        coherences=tuple(one for one in functions if one.kind != RESPONSE_FUNCTION),
        modes=tuple(modes),
        warnings=tuple(warnings),
    )


def places_of(table: Mapping[str, Any], source: str) -> dict[str, Any]:
    """Names by number of the node, ``12 = "tip"``, or as a model has them, ``tip = 12``."""
    stated = toml_file.require_table(table.get("places", {}), source=source, where="places")
    return {str(b) if isinstance(b, int) else a: a if isinstance(b, int) else b for a, b in stated.items()}


def point(at: NodeAxis, file: ModalFile, places: Mapping[str, Any], direction: str) -> Point:
    """A node as a point of the structure: by its name among `places`, which have it by number, else ``node 12``.

    Raises
    ------
    BadInput : it has no direction, and none is given.
    """
    axis = at.axis or direction
    if not axis:
        remedy = 'Write direction = "z" in the test, or export with directions'
        raise BadInput(file.source, f"node {at.node}", "has no direction", remedy)
    place, position = str(places.get(str(at.node), f"node {at.node}")), file.nodes.get(at.node)
    where: dict[str, Any] = {} if position is None else {"position": position.tolist()}
    if at.axis and at.node in file.axes:
        along = file.axes[at.node][AXES.index(axis[-1])] * (-1 if axis[0] == "-" else 1)
        where |= {"name": f"{place}:{axis[-1]}"}
        return sensors.point({"place": place, "direction": along.tolist(), **where}, source=file.source, field="places")
    return sensors.point({"place": place, "direction": axis, **where}, source=file.source, field="places")


# Nodes, and the axes along which they move. A file that speaks of a system that it does not have means its global one.

System = tuple[int, Array, Array]
"""Type, origin (3,) [m] and axes (3, 3) as rows of a system of coordinates."""

CARTESIAN_SYSTEMS = "Export nodes and functions in Cartesian or cylindrical systems"


def _numbers(text: str, count: int, what: str, source: str) -> Array:
    """`count` numbers, which may touch where one is negative."""
    words = re.sub(r"(?<=[\d.])-", " -", re.sub(r"[Dd]", "E", text)).split()
    try:
        found = np.array([float(word) for word in words])
    except ValueError:
        found = np.zeros(0)
    if found.shape != (count,) or not np.all(np.abs(found) < files.LARGEST):
        raise BadInput(source, what, f"must have {count} coordinates, found {text.strip()[:60]!r}", DAMAGED)
    return found


def _whole(line: str, start: int, what: str, source: str, width: int = 10) -> int:
    """A whole number; blanks are 0, as Fortran reads them: of systems the global one."""
    return int(column(line, start, width, int, what, source)) if line[start : start + width].strip() else 0


def _systems(block: Dataset, known: Mapping[int, System], source: str, length: float, columns: bool) -> dict[int, System]:
    """Of dataset 18 (in one of `known`: origin, a point on x, one in the plane xz) or 2420 (axes as rows or `columns`)."""
    what, each = f"dataset {block.number}", 4 if block.number == 18 else 6
    lines = list(block.lines[0 if block.number == 18 else 2 :])
    while lines and not lines[-1].strip():
        lines.pop()
    if len(lines) % each:
        raise BadInput(source, what, "is cut short", DAMAGED)
    found: dict[int, System] = {}
    numbered = {*known, *(_whole(line, 0, what, source) for line in lines[::each])}
    for k in range(0, len(lines), each):
        number, kind = (int(column(lines[k], start, 10, int, what, source)) for start in (0, 10))
        numbers = _numbers(" ".join(lines[k + 2 : k + each]), 9 if block.number == 18 else 12, what, source).reshape(-1, 3)
        if block.number == 18:
            origin, x, plane = numbers[0], numbers[1] - numbers[0], numbers[2] - numbers[0]
            y = np.cross(plane, x)
            rows = np.array([x, y, np.cross(x, y)])
            rows = rows / np.maximum(np.linalg.norm(rows, axis=1, keepdims=True), np.finfo(np.float64).tiny)
        else:
            rows, origin = numbers[:3].T if columns else numbers[:3], numbers[3]
        if not np.allclose(rows @ rows.T, np.eye(3), atol=1e-4):
            raise BadInput(source, what, f"the axes of system {number} are no right angles", CARTESIAN_SYSTEMS)
        origin, rows = origin * length, rows / np.linalg.norm(rows, axis=1, keepdims=True)
        reference = _whole(lines[k], 20, what, source) if block.number == 18 else 0
        if reference != number and reference in numbered:
            of, start, turn = {**known, **found}.get(reference, (None, origin, rows))
            if of != CARTESIAN:
                problem = f"system {number} is stated in system {reference}, which is not Cartesian or comes behind it"
                raise BadInput(source, what, problem, CARTESIAN_SYSTEMS)
            origin, rows = start + origin @ turn, rows @ turn
        found[number] = kind, origin, rows
    return found


def _nodes(
    block: Dataset, systems: Mapping[int, System], source: str, length: float
) -> Iterator[tuple[int, Array, Array | None]]:
    """Number, place [m] and axes of every node; None where these are the global ones."""
    what = f"dataset {block.number}"
    lines = [line for line in block.lines if line.strip()]
    if block.number != 15 and len(lines) % 2:
        raise BadInput(source, what, "is cut short", DAMAGED)
    one_line = [(line[:40], line[40:]) for line in lines]
    pairs = one_line if block.number == 15 else list(zip(lines[::2], lines[1::2], strict=True))
    for head, text in pairs:
        at = _numbers(text, 3, what, source)
        number = int(column(head, 0, 10, int, what, source))
        defined, moved = (_whole(head, start, what, source) for start in (10, 20))
        for used in (moved, defined if block.number == 15 else moved):
            if used in systems and systems[used][0] not in (CARTESIAN, CYLINDRICAL):
                raise BadInput(source, what, f"node {number} is in system {used}, of type {systems[used][0]}", CARTESIAN_SYSTEMS)
        place = at * length
        if block.number == 15 and defined in systems:  # those of 781 and 2411 are global
            kind, origin, rows = systems[defined]
            angle = np.radians(at[1])
            around = length * np.array([at[0] * np.cos(angle), at[0] * np.sin(angle), at[2]])
            place = origin + (around if kind == CYLINDRICAL else place) @ rows
        if moved not in systems:
            yield number, place, None
            continue
        kind, origin, rows = systems[moved]
        if kind == CYLINDRICAL:
            out = (place - origin) - ((place - origin) @ rows[2]) * rows[2]
            size = float(np.linalg.norm(out))
            r = out / size if size > 0 else rows[0]
            rows = np.array([r, np.cross(rows[2], r), rows[2]])
        yield number, place, None if np.allclose(rows, np.eye(3), atol=1e-6) else rows


def _function(block: Dataset, source: str, stated: float | None) -> Function | str:
    """A function, or in words what it is where it is none that is used; `stated` is [m/N] of dataset 164."""
    name = uff.title(block.lines[0], block.index)

    def refused(problem: str, remedy: str) -> BadInput:
        return BadInput(source, name, problem, remedy)

    head = block.lines[5]
    kind = int(column(head, 0, 5, int, name, source))
    if kind not in (RESPONSE_FUNCTION, COHERENCE, MULTIPLE_COHERENCE):
        return f"of function type {kind}"
    above, below, along = (int(column(block.lines[line], 0, 10, int, name, source)) for line in (8, 9, 7))
    inverted = (above in FORCES and below in QUANTITIES) or (None if above in UNSAID and below in UNSAID else False)
    upright = above in (*QUANTITIES, *UNSAID) and below in (*FORCES, *UNSAID)
    if kind == RESPONSE_FUNCTION and not (inverted or upright):
        return f"of data type {above} over {below}, no response over force"
    response, reference = (_at(head, at, at + 10, name, source) for at in (41, 66))
    if "rotation" in (response.axis, reference.axis):
        return "about an axis of rotation"
    frequency, values = uff.curve(block, name, source, files.FREQUENCIES)
    if kind == RESPONSE_FUNCTION and not np.iscomplexobj(values):
        raise refused("is real, and a complex response function is needed", "Export real and imaginary part")
    if re.search(r"\bdb\b", block.lines[8][25:68].lower()):
        raise refused("is labelled in dB, whose phase is no imaginary part", "Export real and imaginary part")
    axis = uff.label(block.lines[7]).lower()
    if along not in (*UNSAID, uff.FREQUENCY) or "rpm" in axis or ("rad" in axis and axis not in files.FREQUENCIES):
        raise refused(f"runs along data type {along}, {axis!r}, where frequency is read", "Export functions of frequency")
    files.require_lines(frequency, source, name)
    if not np.all(np.isfinite(values)):
        raise refused("holds NaN or infinity", "Leave these lines out")
    printed, quantity = [uff.label(block.lines[line]) for line in (8, 9)], QUANTITIES.get(below if inverted else above, "")
    unit = unit_of(printed, quantity, stated, inverted)
    return Function(
        kind=kind,
        response=response,
        reference=reference,
        frequency=frequency,
        values=values.astype(np.complex128),
        unit=unit if kind == RESPONSE_FUNCTION else replace(unit, doubt=""),
    )


SAME_UNIT = 1e-3
"""Relative difference up to which two ways to say a unit say the same: factors of dataset 164 have more digits."""


def unit_of(printed: Sequence[str], quantity: str, stated: float | None, inverted: bool | None) -> Unit:
    """By the labels `printed` at numerator and denominator, the `quantity` of a data type and what dataset 164 has `stated` [SI].

    A unit that only one of the labels has is over SI, or SI over it.
    """
    over, under = map(text_table.plain, printed)
    for way in ((False, True) if inverted is None else (inverted,)) if any(printed) else ():
        response, force = (under, over) if way else (over, under)
        parts = f"({response or PER_NEWTON.get(quantity, '').removesuffix('/N')})/({force or 'N'})"
        for text in (f"1/({over})" if way else over, parts):
            try:
                labelled, says = toml_file.unit_among(text, PER_NEWTON, source="", field="")
            except BadInput:
                continue
            doubt = ""
            if stated is not None and abs(says / stated - 1) > SAME_UNIT:
                doubt = f"labels its numbers as {says:g} {PER_NEWTON[labelled]}, and dataset 164 says {stated:g}"
            elif quantity and labelled != quantity:
                doubt = f"is of {quantity} by its data type, and of {labelled} by its label"
            return Unit(quantity=quantity if doubt else labelled, inverted=way, factor=says, doubt=doubt)
    doubt = f"labels its numbers {printed[0]!r} over {printed[1]!r}, which is no unit known here"
    return Unit(quantity=quantity, inverted=inverted, factor=stated, doubt=doubt if any(printed) and stated is None else "")


def _at(head: str, node: int, direction: int, name: str, source: str) -> NodeAxis:
    number, along = _whole(head, node, name, source), _whole(head, direction, name, source, 4)
    if abs(along) > 6:
        raise BadInput(source, name, f"is along the direction {along}, where 1 to 3 (x, y, z) are read", DAMAGED)
    if abs(along) > 3:
        return NodeAxis(node=number, axis="rotation")
    return NodeAxis(node=number, axis=("-" if along < 0 else "") + AXES[abs(along) - 1] if along else "")


def _mode(block: Dataset, source: str) -> Mode | None:
    """A mode; None for what else such a dataset holds."""
    name = f"dataset {block.index + 1}"

    def refused(problem: str, remedy: str = DAMAGED) -> BadInput:
        return BadInput(source, name, problem, remedy)

    lines, newer = block.lines, block.number == 2414
    kinds, real, body = (8, 11, 13) if newer else (5, 7, 8)  # lines of the kinds, of the first real numbers, of the shape
    if len(lines) < body + 2:
        raise refused("is cut short")
    analysis, result, data, each = (int(column(lines[kinds], at, 10, int, name, source)) for at in (10, 30, 40, 50))
    elsewhere = newer and (column(lines[2], 0, 10, int, name, source) != 1 or analysis not in MODES)
    if elsewhere or result not in (QUANTITIES if newer else (*QUANTITIES, *UNSAID)):  # such as modes of strain
        return None
    numbers = [column(lines[real], at, 13, float, name, source) for at in range(0, 78, 13) if lines[real][at : at + 13].strip()]
    if newer and analysis != NORMAL_MODE:
        numbers = [column(lines[real + 1], at, 13, float, name, source) for at in (0, 13)]
    elif newer:  # time, frequency, eigenvalue, modal mass, then both kinds of damping
        numbers = [one for k, one in enumerate(numbers) if k not in (0, 2)]
    if not numbers:
        raise refused("states no frequency")
    if analysis == NORMAL_MODE:
        frequency, viscous, structural = numbers[0], *[*numbers[2:4], 0.0, 0.0][:2]
        damping = viscous or structural / 2
    elif analysis in MODES and len(numbers) > 1:
        size = float(np.hypot(numbers[0], numbers[1]))
        frequency, damping = size / (2 * np.pi), -numbers[0] / size if size else 0.0
    else:
        raise refused(f"has the analysis type {analysis}, where 2, 3 or 7 (modes) are read", "Export the modes")
    if not abs(damping) < 1:
        remedy = "Export it as a share, 0.01 for 1 %; both parts of the eigenvalue of a complex mode, in rad/s"
        raise refused(f"has the damping ratio {damping:g}, where a share below 1 is read", remedy)
    parts = 2 if data in uff.COMPLEX else 1
    if each not in (3, 6) or not 0 < frequency < files.LARGEST:
        problem = f"has {each} numbers a node and {frequency:g} Hz, where 3 or 6 and a positive frequency are read"
        raise refused(problem, "Export motions of elastic modes, without those of the rigid body")
    nodes, rows, place = [], [], body
    per_node = -(-each * parts // 6)  # lines of six numbers
    while place < len(lines) and lines[place].strip():
        nodes.append(int(column(lines[place].split()[0], 0, 10, int, name, source)))
        text = "".join(line.ljust(78)[:78] for line in lines[place + 1 : place + 1 + per_node])
        rows.append([column(text, 13 * k, 13, float, name, source) for k in range(each * parts)])
        place += 1 + per_node
    values = np.array(rows).reshape(len(rows), each * parts)
    if not len(nodes) or not np.all(np.isfinite(values)):
        raise refused("has no shape, or NaN in it")
    shape = files.as_complex(values[:, ::2], values[:, 1::2]) if parts == 2 else values
    return Mode(frequency=float(frequency), damping_ratio=float(damping), nodes=tuple(nodes), shape=shape[:, :3])
