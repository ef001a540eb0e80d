"""A deck of Abaqus with parts and instances, as Abaqus/CAE writes it, as one without: every instance where the assembly has it.

Of a single instance numbers and names of sets stay as they are. Of several, and where the assembly has nodes of its own, numbers
go on by a power of ten from one to the next, and sets are called as the assembly calls them, ``INSTANCE.SET``.
"""

from collections.abc import Callable, Iterable, Iterator, Mapping
from dataclasses import dataclass, field
from pathlib import Path
from typing import NamedTuple

import numpy as np

from geometry.errors import BadInput
from geometry.frames import Array


class Line(NamedTuple):
    """A line of a deck, and the file and number that it has there."""

    text: str
    file: Path
    number: int


def keyword_of(line: str) -> tuple[str, dict[str, str]]:
    """Keyword of a line of Abaqus that begins with one asterisk, and its options, all but their values in capitals."""
    keyword, *words = (word.strip() for word in line.strip()[1:].split(","))
    options = {key.strip().upper(): value.strip().strip('"') for key, _, value in (word.partition("=") for word in words)}
    return " ".join(keyword.upper().split()), options


SETS = ("ELSET", "NSET", "REF NODE", "TIE NSET", "PIN NSET")
"""Options that name a set, or a node."""


@dataclass(kw_only=True)
class _Block:
    """A keyword with its rows."""

    keyword: str
    options: dict[str, str]
    head: Line
    rows: list[Line] = field(default_factory=list)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Place:
    """What becomes of numbers, names and coordinates of an instance."""

    name: str
    offset: int
    alone: bool
    turn: Array = field(default_factory=lambda: np.eye(3))
    shift: Array = field(default_factory=lambda: np.zeros(3))

    def number(self, text: str) -> str:
        return str(int(text) + self.offset) if text.lstrip("-").isdigit() else text

    def named(self, text: str) -> str:
        """A set, or a node by its number."""
        return self.number(text) if text.isdigit() or self.alone or not text else f"{self.name}.{text}"

    def rows(self, block: _Block) -> Iterator[Line]:
        """Rows of `block` of the part with their numbers and coordinates in the assembly."""
        for line in block.rows:
            words = [word.strip() for word in line.text.split(",")]
            if block.keyword == "NODE":
                at = np.array([float((word or "0").upper().replace("D", "E")) for word in [*words, "", "", ""][1:4]])
                if not np.isfinite(at).all():
                    raise _refused(line, "it has a node that is nowhere")
                moved = at if self.alone and self.still else self.turn @ at + self.shift
                words = [self.number(words[0]), *(repr(value) for value in moved.tolist())]
            elif block.keyword == "ELEMENT":
                words = [self.number(word) for word in words]
            elif block.keyword in ("NSET", "ELSET"):
                last = 2 if "GENERATE" in block.options else len(words)
                words = [self.named(word) for word in words[:last]] + words[last:]
            yield line._replace(text=", ".join(words))

    @property
    def still(self) -> bool:
        return bool(np.array_equal(self.turn, np.eye(3)) and not np.any(self.shift))


def flat(lines: Iterable[Line]) -> Iterator[Line]:
    """`lines` without parts and instances.

    Raises
    ------
    BadInput : an instance of a part that is not there, of another deck, or placed by something other than numbers.
    """
    parts: dict[str, list[_Block]] = {}
    within = ""  # of PART and ASSEMBLY the one that is open
    assembly: list[_Block] = []
    places: dict[str, _Place] = {}
    pending: list[_Block] = []
    for line in lines:
        text = line.text.strip()
        if not text or text.startswith("**"):
            continue
        if not text.startswith("*"):
            if pending:
                pending[-1].rows.append(line)
            else:
                yield line if not places else line._replace(text=_referring(text, places))
            continue
        keyword, options = keyword_of(text)
        if keyword == "PART":
            within, pending = keyword, []
            parts[options.get("NAME", "").upper()] = pending
        elif keyword == "ASSEMBLY":
            within, pending = keyword, assembly
        elif keyword in ("END PART", "END ASSEMBLY"):
            if keyword == "END ASSEMBLY":
                places = _places(assembly, parts)
                yield from _assembled(assembly, parts, places)
            within, pending = "", []
        elif within:
            pending.append(_Block(keyword=keyword, options=options, head=line))
        else:
            renamed = {key: _referring(value, places) if key in SETS else value for key, value in options.items()}
            yield line if renamed == options else _headed(line, keyword, renamed)


def _headed(line: Line, keyword: str, options: Mapping[str, str]) -> Line:
    said = [f"{key}={value}" if value else key for key, value in options.items()]
    return line._replace(text=", ".join([f"*{keyword}", *said]))


def _referring(text: str, places: Mapping[str, _Place]) -> str:
    """Fields with ``INSTANCE.SET`` and ``INSTANCE.12`` as what these became."""
    return ", ".join(_meant(word.strip(), places, lambda other: other) for word in text.split(","))


def _meant(word: str, places: Mapping[str, _Place], otherwise: Callable[[str], str]) -> str:
    instance, dot, name = word.partition(".")
    there = places.get(instance.upper()) if dot else None
    return otherwise(word) if there is None else there.named(name)


def _refused(line: Line, problem: str) -> BadInput:
    remedy = "Write a flat deck: in Abaqus/CAE, Model > Edit Attributes > Do not use parts and assemblies in input files"
    return BadInput(source=str(line.file), field=f"line {line.number}", problem=problem, remedy=remedy)


def _places(assembly: Iterable[_Block], parts: Mapping[str, list[_Block]]) -> dict[str, _Place]:
    instances = [block for block in assembly if block.keyword == "INSTANCE"]
    own = any(block.keyword == "NODE" for block in _own(assembly))
    highest = 1
    for part in parts.values():
        for block in part:
            if block.keyword in ("NODE", "ELEMENT"):
                heads = (row.text.split(",")[0].strip() for row in block.rows)
                highest = max(highest, *(int(head) for head in heads if head.isdigit()), 1)
    stride = 10 ** len(str(highest))
    alone = len(instances) == 1 and not own
    found: dict[str, _Place] = {}
    for k, block in enumerate(instances):
        if block.options.get("PART", "").upper() not in parts:
            problem = f"an instance is of the part {block.options.get('PART', '')!r}, which is not here"
            raise _refused(block.head, problem)
        try:
            rows = [[float(word or 0) for word in row.text.split(",")] for row in block.rows]
            if not np.isfinite([number for row in rows for number in row]).all():
                raise ValueError
        except ValueError:
            raise _refused(block.head, "it places an instance by something other than numbers") from None
        name, place = block.options.get("NAME", str(k)), dict[str, Array]()
        shift = np.array([*(rows[0] if rows else []), 0.0, 0.0, 0.0][:3])
        turn = np.eye(3)
        if len(rows) > 1:
            turn, about = _turn(block, rows[1])
            shift = turn @ (shift - about) + about  # it is shifted first, then turned
        place = {"turn": turn, "shift": shift}
        found[name.upper()] = _Place(name=name, offset=0 if alone else k * stride, alone=alone, **place)
    if own:
        found[""] = _Place(name="", offset=len(instances) * stride, alone=True)
    return found


def _turn(block: _Block, row: list[float]) -> tuple[Array, Array]:
    """Rotation (3, 3) by the seventh number [degrees] about the line through its first and second three, and a point of it."""
    from scipy.spatial.transform import Rotation

    if len(row) != 7 or row[:3] == row[3:6]:
        raise _refused(block.head, "it turns an instance about no line")
    about, to = np.array(row[:3]), np.array(row[3:6])
    along = (to - about) / np.linalg.norm(to - about)
    return Rotation.from_rotvec(np.radians(row[6]) * along).as_matrix(), about


def _own(assembly: Iterable[_Block]) -> Iterator[_Block]:
    """Blocks of the assembly itself, not of its instances."""
    inside = False
    for block in assembly:
        inside = block.keyword == "INSTANCE" or (inside and block.keyword != "END INSTANCE")
        if not inside and block.keyword != "END INSTANCE":
            yield block


def _assembled(assembly: list[_Block], parts: Mapping[str, list[_Block]], places: Mapping[str, _Place]) -> Iterator[Line]:
    open_instance: _Place | None = None

    def placed(block: _Block, place: _Place) -> Iterator[Line]:
        options = {key: place.named(value) if key in SETS else value for key, value in block.options.items()}
        yield _headed(block.head, block.keyword, options)
        yield from place.rows(block)

    for block in assembly:
        if block.keyword == "INSTANCE":
            open_instance = places[block.options.get("NAME", "").upper()]
            for one in parts[block.options["PART"].upper()]:
                yield from placed(one, open_instance)
        elif block.keyword == "END INSTANCE":
            open_instance = None
        elif open_instance is not None:
            yield from placed(block, open_instance)
        else:
            of = places.get(block.options.get("INSTANCE", "").upper(), _Place(name="", offset=0, alone=True))
            options = {key: value for key, value in block.options.items() if key != "INSTANCE"}
            options |= {key: _referring(value, places) for key, value in options.items() if key in SETS}
            yield _headed(block.head, block.keyword, options)
            for row in block.rows:  # a set of the assembly keeps its name; numbers are those of the instance, or of the assembly
                words = [word.strip() for word in row.text.split(",")]
                counted = {"NODE": 1, "ELEMENT": len(words), "NSET": len(words), "ELSET": len(words)}.get(block.keyword, 0)
                counted = min(counted, 2) if "GENERATE" in options else counted
                meant = [_meant(word, places, of.number) for word in words[:counted]]
                rest = words[counted:] if block.keyword == "NODE" else [_referring(word, places) for word in words[counted:]]
                yield row._replace(text=", ".join([*meant, *rest]))
