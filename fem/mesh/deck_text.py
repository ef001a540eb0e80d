"""The text of a deck of Nastran, Abaqus or CalculiX: its lines with those of files that it includes, its numbers, its systems."""

import re
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from pathlib import Path
from typing import NamedTuple

import numpy as np

from geometry.errors import BadInput
from geometry.frames import FLAT, Array, axes_along


class Line(NamedTuple):
    """A line of a deck, and the file and number that it has there."""

    text: str
    file: Path
    number: int


def real(text: str) -> float:
    """``1.5-3`` is 1.5e-3 in Nastran; nothing is zero."""
    text = text.strip()
    try:
        return float(text or 0.0)
    except ValueError:
        if not (found := re.fullmatch(r"([-+]?(?:\d+\.?\d*|\.\d+))(?:[ED]?([-+]\d+)|[ED](\d+))", text, re.IGNORECASE)):
            raise ValueError(f"{text} stands where a number should") from None
    return float(f"{found[1]}e{found[2] or found[3]}")


class NotThere(LookupError):
    """A deck names the number of a node, or a set of nodes, and has none."""

    def __init__(self, what: int | str) -> None:
        super().__init__(what)
        self.what = what


class Points(dict[int, Array]):
    """Where nodes are, by their numbers; `NotThere` of one that is not."""

    def __missing__(self, node: int) -> Array:
        raise NotThere(node)


LARGEST_FILE = 2 * 2**30
"""Bytes of a mesh file: a million degrees of freedom have a tenth of it."""

BEGIN = re.compile(r"\s*BEGIN\s+(BULK|SUPER)\b(.*)", re.IGNORECASE)
_ORDERED = re.compile(r"\s*(CEND|BEGIN\s+(BULK|SUPER))\b", re.IGNORECASE)
_INCLUDE = re.compile(r"\s*INCLUDE\s+(.*)", re.IGNORECASE)


def text_lines(path: Path) -> Iterator[str]:
    """Lines of a text, without their ends."""
    with path.open(encoding="utf-8", errors="replace") as file:
        yield from (line.rstrip("\r\n") for line in file)


def deck_lines(path: Path) -> Iterator[Line]:
    """Lines of a deck, those of files that it includes in their place, and of Abaqus without parts and instances.

    What a Nastran deck includes before CEND, and is not there, are orders to the program, and is left alone.

    Raises
    ------
    BadInput : an included file that is not there, or that includes itself; see `flat`.
    """
    return flat(_abaqus_lines(path, ())) if path.suffix.lower() == ".inp" else _nastran_lines(path, ())


def naming(path: Path, what: int | str, carries: Callable[[str], bool]) -> tuple[Line, str]:
    """The line of a deck that first names a node or a set in what `carries` by its card or keyword, which comes with it."""
    card, of_nastran = "", path.suffix.lower() != ".inp"
    for line in deck_lines(path):
        text = line.text.upper().partition("$")[0] if of_nastran else line.text.upper()
        if begins := of_nastran and text[:1].isalpha():
            card = re.split(r"[\s,*]", text[:8])[0]
        elif not of_nastran and text.startswith("*"):
            card, options = keyword_of(text)
            card = options.get("TYPE", card) if card == "ELEMENT" else card
        words = re.split(r"[\s,*+]+", text) if of_nastran else [word.strip() for word in re.split("[,=]", text)]
        words = words[2 * begins :]  # behind card and number
        words += [text[n : n + 8].strip() for n in range(8 + 8 * begins, 72, 8) if of_nastran]  # of eight figures each
        if carries(card) and str(what).upper() in words:
            return line, card
    return Line("", path, 0), "it"


def _abaqus_lines(path: Path, within: tuple[Path, ...]) -> Iterator[Line]:
    lines = (Line(text, path, number) for number, text in enumerate(text_lines(path), start=1))
    for line in lines:
        text = line.text.strip()
        if not text.startswith("*") or text.startswith("**"):
            yield line
            continue
        while text.endswith(",") and (more := next(lines, None)) is not None:
            text += more.text.strip()
        keyword, options = keyword_of(text)
        if keyword != "INCLUDE":
            yield line._replace(text=text)
        if keyword == "INCLUDE" or (keyword in COUNTED and "INPUT" in options):
            yield from _abaqus_lines(*_included(options.get("INPUT", ""), line, (*within, path)))


def _nastran_lines(path: Path, within: tuple[Path, ...]) -> Iterator[Line]:
    every = [Line(text, path, number) for number, text in enumerate(text_lines(path), start=1)]
    orders, lines = not within and any(_ORDERED.match(line.text) for line in every), iter(every)
    for line in lines:
        orders = orders and _ORDERED.match(line.text) is None
        if (found := _INCLUDE.match(line.text)) is None:
            yield line
            continue
        name, mark = found[1].strip(), found[1].strip()[:1]
        if mark in ("'", '"'):  # a name between quotes may go on over several lines
            while name.count(mark) < 2 and (more := next(lines, None)) is not None:
                name += more.text.strip()
            name = name[1:].partition(mark)[0]
        try:
            yield from _nastran_lines(*_included(name.partition("$")[0].strip(), line, (*within, path)))
        except BadInput:
            if not orders:
                raise


def _included(name: str, line: Line, within: tuple[Path, ...]) -> tuple[Path, tuple[Path, ...]]:
    """The file `name` and `within` which it stands: beside the one that includes it, or beside the deck; there, too, whatever
    folder it names."""
    name = name.replace("\\", "/")
    field, remedy = f"line {line.number}", "Copy it beside the deck, or take the line out"
    beside = dict.fromkeys(file.parent / part for part in (name, Path(name).name) for file in (line.file, *within))
    file = next((one for one in beside if one.is_file()), None)
    if file is None:
        raise BadInput(str(line.file), field, f"it includes {name!r}, which is not there", remedy)
    if file.resolve() in [one.resolve() for one in within]:
        raise BadInput(str(line.file), field, f"it includes {name!r}, and so itself", remedy)
    if file.stat().st_size > LARGEST_FILE:
        problem = f"it includes {name!r}, which has {file.stat().st_size / 2**30:.3g} GiB"
        raise BadInput(str(line.file), field, problem, "Write a coarser mesh")
    return file, within


# Abaqus: keywords, and parts with instances, as Abaqus/CAE writes them.
#
# Every instance stands where the assembly has it. Of a single instance numbers and names of sets stay as they are. Of several,
# and where the assembly has nodes of its own, numbers go on by a power of ten from one to the next, and sets are called as the
# assembly calls them, ``INSTANCE.SET``.


def keyword_of(line: str) -> tuple[str, dict[str, str]]:
    """Keyword of a line of Abaqus that begins with one asterisk, and its options, all but their values in capitals."""
    keyword, *words = (word.strip() for word in line.strip()[1:].split(","))
    options = {key.strip().upper(): value.strip().strip('"') for key, _, value in (word.partition("=") for word in words)}
    keyword = " ".join(keyword.upper().split())
    return SPACED.get(keyword, keyword), options


_SPACED = ("SOLID SECTION", "SHELL SECTION", "BEAM SECTION", "RIGID BODY", "END STEP", "KINEMATIC COUPLING", "CONTACT PAIR")
SPACED = {one.replace(" ", ""): one for one in _SPACED}
"""Keywords as CalculiX takes them, which minds no blanks, and how they are written."""


SETS = ("ELSET", "NSET", "REF NODE", "TIE NSET", "PIN NSET", "SURFACE")
"""Options that name a set, a node or a surface."""

COUNTED = ("NODE", "ELEMENT", "NSET", "ELSET")
"""Keywords whose rows have numbers of nodes and elements."""

NAMING = {"SURFACE": slice(0, 1), "TIE": slice(0, 2), "MPC": slice(1, None), "EQUATION": slice(0, None, 3)}
"""Keywords whose rows name nodes, elements, sets or surfaces, and where in a row; a row of one word says how many come."""

DIRECTED = {"ORIENTATION": 0, "TRANSFORM": 0, "BEAM SECTION": 1, "BEAM GENERAL SECTION": 1}
"""Keywords of which a row has directions, which turn with an instance, and which row."""


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

    def rows(self, block: _Block, word: Callable[[str], str]) -> Iterator[Line]:
        """Rows of `block` with their coordinates in the assembly, and each number or name of a set as its `word` there."""
        turned = block.rows[DIRECTED.get(block.keyword, len(block.rows)) :][:1]  # what has directions
        for line in block.rows:
            words = [text.strip() for text in line.text.split(",")]
            if block.keyword == "NODE":
                at = np.array([real(text) for text in [*words, "", "", ""][1:4]])
                if not np.isfinite(at).all():
                    raise _refused(line, "it has a node that is nowhere")
                words = [self.number(words[0]), *(repr(value) for value in (self.turn @ at + self.shift).tolist())]
            elif line in turned and block.options.get("DEFINITION", "COORDINATES").upper() == "COORDINATES":
                points = np.array([real(text) for text in words[: len(words) // 3 * 3]]).reshape(-1, 3)
                shift = self.shift if block.options.get("TYPE", "").upper() == "C" else 0.0  # of a *TRANSFORM about an axis
                words = [repr(value) for value in (points @ self.turn.T + shift).ravel().tolist()]
            elif block.keyword in COUNTED:
                last = 2 if "GENERATE" in block.options else len(words)
                words = [*map(word, words[:last]), *words[last:]]
            elif block.keyword in NAMING and (block.keyword != "EQUATION" or len(words) > 1):
                words[NAMING[block.keyword]] = map(word, words[NAMING[block.keyword]])
            yield line._replace(text=", ".join(words))


def flat(lines: Iterable[Line]) -> Iterator[Line]:
    """`lines` without parts and instances, comments and what is blank.

    Raises
    ------
    BadInput : an instance of a part that is not there, of another deck, or placed by something other than numbers.
    """
    parts: dict[str, list[_Block]] = {}
    assembly: list[_Block] = []
    places: dict[str, _Place] = {}
    pending: list[_Block] | None = None  # of the part, or of the assembly, that is open
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
            pending = parts[options.get("NAME", "").upper()] = []
        elif keyword == "ASSEMBLY":
            pending = assembly
        elif keyword in ("END PART", "END ASSEMBLY"):
            if keyword == "END ASSEMBLY":
                places = _places(assembly, parts)
                yield from _assembled(assembly, parts, places)
            pending = None
        elif pending is not None:
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
    return BadInput(str(line.file), f"line {line.number}", problem, remedy)


def _places(assembly: Iterable[_Block], parts: Mapping[str, list[_Block]]) -> dict[str, _Place]:
    instances = [block for block in assembly if block.keyword == "INSTANCE"]
    own = any(block.keyword == "NODE" for block in _own(assembly))
    blocks = (block for part in parts.values() for block in part if block.keyword in ("NODE", "ELEMENT"))
    heads = (row.text.split(",")[0].strip() for block in blocks for row in block.rows)
    highest = max((int(head) for head in heads if head.isdigit()), default=1)
    stride, alone = 10 ** len(str(highest)), len(instances) == 1 and not own
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
        name, turn = block.options.get("NAME", str(k)), np.eye(3)
        shift = np.array([*(rows[0] if rows else []), 0.0, 0.0, 0.0][:3])
        if len(rows) > 1:
            turn, about = _turn(block, rows[1])
            shift = turn @ (shift - about) + about  # it is shifted first, then turned
        found[name.upper()] = _Place(name=name, offset=0 if alone else k * stride, alone=alone, turn=turn, shift=shift)
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
    instance: _Place | None = None

    def placed(blocks: Iterable[_Block], of: _Place, named: Callable[[str], str], word: Callable[[str], str]) -> Iterator[Line]:
        for block in blocks:
            own = (*SETS, "ORIENTATION", *(["NAME"] if block.keyword in ("ORIENTATION", "SURFACE") else []))
            options = {key: named(value) if key in own else value for key, value in block.options.items() if key != "INSTANCE"}
            yield _headed(block.head, block.keyword, options)
            yield from of.rows(block, word)

    for block in assembly:
        if block.keyword == "INSTANCE":
            instance = places[block.options.get("NAME", "").upper()]
            yield from placed(parts[block.options["PART"].upper()], instance, instance.named, instance.named)
        elif block.keyword == "END INSTANCE":
            instance = None
        elif instance is not None:
            yield from placed([block], instance, instance.named, instance.named)
        else:  # a set of the assembly keeps its name; numbers are those of the instance that it names, or of the assembly
            of = places.get(block.options.get("INSTANCE", "").upper(), _Place(name="", offset=0, alone=True))
            inner = of.named if "INSTANCE" in block.options else of.number  # whose sets it names
            of = replace(of, alone=True, turn=np.eye(3), shift=np.zeros(3))
            rows = [row._replace(text=_referring(row.text, places)) for row in block.rows]
            other = block if block.keyword in (*COUNTED, *NAMING) else replace(block, rows=rows)
            yield from placed([other], of, partial(_referring, places=places), partial(_meant, places=places, otherwise=inner))


# What comments of Nastran's call its properties.

_NAMED = re.compile(
    r"\$HMNAME PROP\s+(\d+)\s*\"([^\"]+)\"|\$ Femap (?:with .*)?Property (\d+) : (.+)|\$ANSA_NAME(?:_COMMENT)?;(\d+);P\w+;([^;]+)"
)
"""Comments in which HyperMesh, Femap and ANSA name a property."""

_NAMED_NEXT = re.compile(r"\$ (?:Elements and )?Element Properties for region : (.+)|\$\*\s+Property: (.+)")
"""Comments of Patran and Simcenter, which name the property that comes next."""


def properties(path: Path) -> dict[str, str]:
    """Names of the properties of a deck of Nastran by their numbers, of those that its comments name like no other."""
    found, following = dict[str, str](), ""
    for line in deck_lines(path):
        text = line.text.strip()
        if match := _NAMED.match(text):
            number, name = (one.strip() for one in match.groups() if one is not None)
            found[number] = name
        elif match := _NAMED_NEXT.match(text):
            following = next(one for one in match.groups() if one is not None).strip()
        elif following and re.match(r"P(?!ARAM)[A-Z]", text):
            found[re.split(r"[,\s]+", text.replace("*", " "))[1]], following = following, ""
    found = {number: re.sub(r"[:=,@]+", "-", name) for number, name in found.items()}  # which stand between parts of an effect
    every = list(found.values())
    named = {number: name for number, name in found.items() if name and every.count(name) == 1}
    return {number: name for number, name in named.items() if not re.fullmatch(r"(\w+ )?\d+", name)}


# Coordinate systems of Nastran: where grid points stand, and which way their freedoms point.
#
# A rectangular, cylindrical or spherical system is told by three points of another system (CORD2R, CORD2C, CORD2S) or by three
# grid points (CORD1R, CORD1C, CORD1S). Number 0 is the basic one. Angles are in degrees.

BASIC = "0"

CARD = re.compile(r"CORD([12])([RCS])")


@dataclass(frozen=True, eq=False, kw_only=True)
class System:
    """A system of coordinates.

    Attributes
    ----------
    kind : R, C (radius, angle about z, z) or S (radius, angle from z, angle about z)
    origin : (3,) basic coordinates
    axes : (3, 3) its x, y and z as rows, in basic coordinates
    """

    kind: str
    origin: Array
    axes: Array

    @classmethod
    def spanned(cls, kind: str, origin: Array, z: Array, to: Array | None) -> "System":
        """With its third axis along `z` (3,), and `to` (3,) in the plane of that and the first, as in `axes_along`.

        Raises
        ------
        ValueError : both are along one line, or it is of another kind.
        """
        if kind not in ("R", "C", "S"):
            raise ValueError(f"a system {kind}")
        return cls(kind=kind, origin=origin, axes=axes_along(z, to)[[1, 2, 0]])

    def point(self, at: Array) -> Array:
        """Basic coordinates (3,) of what stands `at` (3,) in it."""
        first, second, third = at.tolist()
        if self.kind == "R":
            own = at
        elif self.kind == "C":
            turn = np.radians(second)
            own = np.array([first * np.cos(turn), first * np.sin(turn), third])
        else:
            tilt, turn = np.radians([second, third])
            own = first * np.array([np.sin(tilt) * np.cos(turn), np.sin(tilt) * np.sin(turn), np.cos(tilt)])
        return np.asarray(self.origin + own @ self.axes)

    def directions(self, point: Array) -> Array:
        """Its three directions (3, 3) as rows, in basic coordinates, at the basic `point` (3,)."""
        if self.kind == "R":
            return self.axes
        x, y, z = (self.axes @ (point - self.origin)).tolist()
        turn, tilt = np.arctan2(y, x), np.arctan2(np.hypot(x, y), z)
        outward = np.array([np.cos(turn), np.sin(turn), 0.0])
        around, up = np.array([-np.sin(turn), np.cos(turn), 0.0]), np.array([0.0, 0.0, 1.0])
        if self.kind == "S":
            own = np.array([np.sin(tilt) * outward + np.cos(tilt) * up, np.cos(tilt) * outward - np.sin(tilt) * up, around])
        else:
            own = np.array([outward, around, up])
        return np.asarray(own @ self.axes)


@dataclass(eq=False, kw_only=True)
class Coordinates:
    """Systems and grid points of a deck as it writes them.

    Attributes
    ----------
    source : the deck
    systems : kind, system or none, and three points or grid points of each, by number
    grids : fields of each grid point, by number
    usual : fields that a grid point has where it leaves its own empty
    found : systems that are worked out
    """

    source: str
    systems: dict[str, tuple[str, str, tuple[Array, ...] | tuple[int, ...]]] = field(default_factory=dict)
    grids: dict[int, Sequence[str]] = field(default_factory=dict)
    usual: Sequence[str] = ()
    found: dict[str, System] = field(default_factory=dict)

    def add(self, card: str, fields: Sequence[str]) -> None:
        """Note the `card` of a system."""
        which, kind = CARD.fullmatch(card).groups()  # type: ignore[union-attr]
        f = [*fields, *(12 * [""])]
        if which == "2":
            points = tuple(np.array([real(text) for text in f[k : k + 3]]) for k in (2, 5, 8))
            self.systems[f[0]] = kind, f[1] or BASIC, points
            return
        for k in (0, 4):
            if f[k]:
                self.systems[f[k]] = kind, "", tuple(int(text) for text in f[k + 1 : k + 4])

    def grid(self, node: int) -> list[str]:
        """Fields (8,) of a grid point, the usual ones where it has none.

        Raises
        ------
        BadInput : systems or freedoms that are no numbers.
        """
        f = [one or other for one, other in zip([*self.grids[node], *8 * [""]], [*self.usual, *8 * [""]], strict=False)][:8]
        numbers = (f[1], *f[5:8])
        if any(text not in ("", "-1") and not text.isdigit() for text in numbers):  # -1: a point of a fluid
            problem = f"node {node} has {', '.join(numbers)!r} where its systems and freedoms are numbers"
            raise BadInput(self.source, "GRID", problem, "Write it again; it may be damaged")
        return f

    def place(self, node: int, within: tuple[str, ...] = ()) -> Array:
        """Basic coordinates (3,) of a grid point.

        Raises
        ------
        BadInput : its system is not there, has no extent, or stands on itself; see `grid`.
        """
        _, system, *three = self.grid(node)[:5]
        at = np.array([real(text) for text in three])
        return at if (system or BASIC) == BASIC else self.system(system, within).point(at)

    def freedoms(self, node: int) -> Array | None:
        """Directions (3, 3) of the freedoms of a grid point as rows; None for the basic ones."""
        system = self.grid(node)[5] or BASIC
        if system in (BASIC, "-1"):
            return None
        own = self.system(system).directions(self.place(node))
        return None if np.allclose(own, np.eye(3), rtol=0, atol=FLAT) else own

    def system(self, number: str, within: tuple[str, ...] = ()) -> System:
        """The system of that number.

        Raises
        ------
        BadInput : see `place`.
        """
        if number == BASIC:
            return System(kind="R", origin=np.zeros(3), axes=np.eye(3))
        if number in self.found:
            return self.found[number]
        if number not in self.systems:
            raise self._refused(number, "is not there", "Include the file that has it")
        if number in within:
            raise self._refused(number, "stands on itself", "Correct the numbers")
        kind, below, points = self.systems[number]
        if below:
            base = self.system(below, (*within, number))
            a, b, c = (base.point(np.asarray(at)) for at in points)
        else:
            lost = [node for node in points if node not in self.grids]
            if lost:
                raise self._refused(number, f"stands on grid point {lost[0]}, which is not there", "Correct it")
            a, b, c = (self.place(int(node), (*within, number)) for node in points)
        try:
            self.found[number] = System.spanned(kind, a, b - a, c - a)
        except ValueError:
            raise self._refused(number, "has three points on one line", "Correct them") from None
        return self.found[number]

    def _refused(self, number: str, problem: str, remedy: str) -> BadInput:
        return BadInput(self.source, "CORD", f"the coordinate system {number} {problem}", remedy)
