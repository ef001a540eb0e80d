"""What a modal test leaves in a universal file: nodes (15, 2411), units (164), response functions (58) and modes (55)."""

from collections.abc import Mapping
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from geometry import sensors
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import Point
from identification.files import files, uff
from identification.files.files import DAMAGED, Samples
from identification.files.uff import Dataset, column

RESPONSE_FUNCTION, COHERENCE = 4, 6
"""Function types of dataset 58."""

QUANTITIES = {8: "displacement", 11: "velocity", 12: "acceleration"}
FORCES = (9, 13)
"""Specific data types of an ordinate."""

NORMAL_MODE, COMPLEX_MODE, VELOCITY_MODE = 2, 3, 7
"""Analysis types of dataset 55."""

AXES = "xyz"


@dataclass(frozen=True, eq=False, kw_only=True)
class NodeAxis:
    """A node and the axis along which it was read or driven: ``x``, ``-z``; empty for a scalar."""

    node: int
    axis: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Function:
    """One dataset 58.

    Attributes
    ----------
    kind : `RESPONSE_FUNCTION` or `COHERENCE`
    response, reference : where it was read, and where the force acts
    quantity : of `QUANTITIES`; empty where the file does not say
    inverted : whether the file says that it is force over response
    frequency : (n,) [Hz]
    values : (n,) complex, in SI by the units of the file
    """

    kind: int
    response: NodeAxis
    reference: NodeAxis
    quantity: str
    inverted: bool
    frequency: Array
    values: ComplexArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Mode:
    """One dataset 55.

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
    functions, modes : in the order of the file
    """

    source: str
    nodes: dict[int, Array]
    functions: tuple[Function, ...]
    modes: tuple[Mode, ...]


def read(path: Path) -> ModalFile:
    """What is in `path`; other datasets are passed over.

    Raises
    ------
    BadInput : no universal file, damaged, functions or modes of another kind.
    """
    files.require_file(path)
    source = str(path)
    found = uff.blocks(path.read_bytes(), source)
    length = force = 1.0  # what one unit is [m, N], as far as the file says it
    stated = [block for block in found if block.number == 164]
    if stated:
        if len(stated[0].lines) < 2:
            raise BadInput(source=source, field="dataset 164", problem="is cut short", remedy=DAMAGED)
        row = stated[0].lines[1].replace("D", "E").replace("d", "e")
        factors = [column(row, start, 25, float, "dataset 164", source) for start in (0, 25)]
        if not all(0 < factor < np.inf for factor in factors):
            problem = f"has the factors {factors[0]:g} and {factors[1]:g}"
            raise BadInput(source=source, field="dataset 164", problem=problem, remedy="Correct it")
        length, force = (1 / factor for factor in factors)
    nodes: dict[int, Array] = {}
    functions, modes = [], []
    for block in found:
        if block.number in (15, 2411):
            what = f"dataset {block.number}"
            lines = [line.replace("D", "E").replace("d", "e") for line in block.lines if line.strip()]
            pairs = [(line[:40], line[40:]) for line in lines]
            if block.number == 2411:
                if len(lines) % 2:
                    raise BadInput(source=source, field=what, problem="is cut short", remedy=DAMAGED)
                pairs = list(zip(lines[::2], lines[1::2], strict=True))
            for head, place in pairs:
                words = place.split()
                try:
                    at = np.array([float(word) for word in words]) * length
                except ValueError:
                    at = np.zeros(0)
                if at.shape != (3,) or not np.all(np.abs(at) < files.LARGEST):
                    problem = f"a node must have three coordinates, found {place.strip()[:60]!r}"
                    raise BadInput(source=source, field=what, problem=problem, remedy=DAMAGED)
                nodes[int(column(head, 0, 10, int, what, source))] = at
        elif block.number == 58:
            functions.append(_function(block, source, length, force))
        elif block.number == 55:
            modes.append(_mode(block, source))
    return ModalFile(source=source, nodes=nodes, functions=tuple(functions), modes=tuple(modes))


def point(at: NodeAxis, nodes: Mapping[int, Array], places: Mapping[str, Any], direction: str, source: str) -> Point:
    """A node as a point of the structure: by its name among `places`, which have it by number, else ``node 12``.

    Raises
    ------
    BadInput : it has no direction, and none is given.
    """
    if not (at.axis or direction):
        remedy = 'Write direction = "z" in the test, or export with directions'
        raise BadInput(source=source, field=f"node {at.node}", problem="has no direction", remedy=remedy)
    place, position = str(places.get(str(at.node), f"node {at.node}")), nodes.get(at.node)
    where = {} if position is None else {"position": position.tolist()}
    return sensors.point({"place": place, "direction": at.axis or direction, **where}, source=source, field="places")


def _function(block: Dataset, source: str, length: float, force: float) -> Function:
    name = block.lines[0].strip() or f"dataset {block.index + 1}"

    def refused(problem: str, remedy: str) -> BadInput:
        return BadInput(source=source, field=name, problem=problem, remedy=remedy)

    head = block.lines[5]
    kind = int(column(head, 0, 5, int, name, source))
    if kind not in (RESPONSE_FUNCTION, COHERENCE):
        problem = (
            f"has the function type {kind}, where {RESPONSE_FUNCTION} (response function) or {COHERENCE} (coherence) is read"
        )
        raise refused(problem, "Export response functions, or name the file under `records` if it holds time histories")
    data, count, even = (int(column(block.lines[6], start, 10, int, name, source)) for start in (0, 10, 20))
    if kind == RESPONSE_FUNCTION and data not in uff.COMPLEX:
        raise refused("is real, and a complex response function is needed", "Export real and imaginary part")
    rows = block.numbers.reshape(count, -1)
    if even:
        start, step = (column(block.lines[6], at, 13, float, name, source) for at in (30, 43))
        if not (abs(start) < files.LARGEST and 0 < step < files.LARGEST):
            raise refused(f"has the abscissa {start:g} + {step:g} k", DAMAGED)
        frequency = np.asarray(start + step * np.arange(count), dtype=np.float64)
    else:
        frequency, rows = rows[:, 0], rows[:, 1:]
    files.require_lines(frequency, source, name)
    values = files.as_complex(rows[:, 0], rows[:, 1]) if data in uff.COMPLEX else rows[:, 0].astype(np.complex128)
    if not np.all(np.isfinite(values)):
        raise refused("holds NaN or infinity", "Leave these lines out")
    above, below = (int(column(block.lines[line], 0, 10, int, name, source)) for line in (8, 9))
    inverted = above in FORCES and below in QUANTITIES
    factor = (length / force) ** (-1 if inverted else 1) if kind == RESPONSE_FUNCTION else 1.0
    return Function(
        kind=kind,
        response=_at(head, 41, 51, name, source),
        reference=_at(head, 66, 76, name, source),
        quantity=QUANTITIES.get(below if inverted else above, ""),
        inverted=inverted,
        frequency=frequency,
        values=factor * values,
    )


def _at(head: str, node: int, direction: int, name: str, source: str) -> NodeAxis:
    number = int(column(head, node, 10, int, name, source))
    along = int(column(head, direction, 4, int, name, source))
    if abs(along) > 3:
        problem = f"is along the direction {along}, a rotation, where 1 to 3 (x, y, z) are read"
        raise BadInput(source=source, field=name, problem=problem, remedy="Leave rotations out of the export")
    return NodeAxis(node=number, axis=("-" if along < 0 else "") + AXES[abs(along) - 1] if along else "")


def _mode(block: Dataset, source: str) -> Mode:
    name = f"dataset {block.index + 1}"

    def refused(problem: str, remedy: str = DAMAGED) -> BadInput:
        return BadInput(source=source, field=name, problem=problem, remedy=remedy)

    lines = block.lines
    if len(lines) < 10:
        raise refused("is cut short")
    analysis, data, each = (int(column(lines[5], at, 10, int, name, source)) for at in (10, 40, 50))
    numbers = [column(lines[7], at, 13, float, name, source) for at in (0, 13, 26, 39) if lines[7][at : at + 13].strip()]
    if not numbers:
        raise refused("states no frequency")
    if analysis == NORMAL_MODE:
        frequency, damping = numbers[0], numbers[2] if len(numbers) > 2 else 0.0
    elif analysis in (COMPLEX_MODE, VELOCITY_MODE) and len(numbers) > 1:
        size = float(np.hypot(numbers[0], numbers[1]))
        frequency, damping = size / (2 * np.pi), -numbers[0] / size if size else 0.0
    else:
        raise refused(f"has the analysis type {analysis}, where 2, 3 or 7 (modes) are read", "Export the modes")
    if not abs(damping) < 1:
        raise refused(f"has the damping ratio {damping:g}")
    parts = 2 if data in uff.COMPLEX else 1
    if each not in (3, 6) or not 0 < frequency < files.LARGEST:
        raise refused(f"has {each} numbers a node and {frequency:g} Hz, where 3 or 6 and a positive frequency are read")
    nodes, rows, place = [], [], 8
    per_node = -(-each * parts // 6)  # lines of six numbers
    while place < len(lines) and lines[place].strip():
        nodes.append(int(column(lines[place], 0, 10, int, name, source)))
        text = "".join(line.ljust(78)[:78] for line in lines[place + 1 : place + 1 + per_node])
        rows.append([column(text, 13 * k, 13, float, name, source) for k in range(each * parts)])
        place += 1 + per_node
    values = np.array(rows).reshape(len(rows), each * parts)
    if not len(nodes) or not np.all(np.isfinite(values)):
        raise refused("has no shape, or NaN in it")
    shape = files.as_complex(values[:, ::2], values[:, 1::2]) if parts == 2 else values
    return Mode(frequency=float(frequency), damping_ratio=float(damping), nodes=tuple(nodes), shape=shape[:, :3])
