"""Mesh files as nodes, elements and named groups: MSH and MED through gmsh in a process of its own, Abaqus, Nastran and UNV text.

gmsh 4.15 does not read ``.inp``, ends its process on ``.unv`` files that it wrote itself, and loses the coordinate systems of
``.bdf``; those three are read here. It also runs what it takes for a script, so that a file is looked at before it is handed on.
"""

import os
import re
import subprocess
import sys
import tempfile
from collections.abc import Callable, Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.mesh import deck_text, solids
from fem.mesh.deck_text import BEGIN, CARD, LARGEST_FILE, Coordinates, Line, deck_lines, keyword_of, properties, real, text_lines
from fem.solid.assembly import require_gmsh, session
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.toml_file import DECKS

BEAMS, SHELLS, POINT = ("line2", "line3"), ("tri3", "tri6", "quad4", "quad8"), "point"
DIMENSION = {POINT: 0, **dict.fromkeys(BEAMS, 1), **dict.fromkeys(SHELLS, 2), **dict.fromkeys(solids.KINDS, 3)}
"""Dimension of each kind of element; a kind ends with the number of its nodes."""

TIME_LIMIT = 600.0
"""Seconds after which gmsh is taken to hang on a file."""

_AGAIN = "Write it again from the program that made it; it may be cut short or damaged"


@dataclass(frozen=True, eq=False, kw_only=True)
class Cells:
    """Elements of one kind.

    Attributes
    ----------
    kind : a key of `DIMENSION`
    tags : (c,) numbers of the elements in the file
    nodes : (c, k) indices of their nodes, corners first, then the middles of edges in the order of Abaqus
    axes : (c, 3) along the height of a beam's section, or the fibres of angle 0 of a shell's layers; NaN where none is stated
    offsets : (c, k, 3) from the nodes to where the element is
    loose : (c, 12) motions of a beam's ends, in its axes, that do not follow their nodes
    """

    kind: str
    tags: Integers
    nodes: Integers
    axes: Array | None = None
    offsets: Array | None = None
    loose: npt.NDArray[np.bool_] | None = None


@dataclass(frozen=True, eq=False, kw_only=True)
class MeshFile:
    """What a mesh file holds, in its own unit of length.

    Attributes
    ----------
    source : the file
    node_tags : (p,) numbers of the nodes, ascending
    points : (p, 3) where they are
    cells : elements by kind
    groups : indices of elements by name and kind
    node_groups : indices of nodes by name, of sets of nodes; groups of elements have their nodes beside
    coordinates : systems and grid points as a deck of Nastran writes them; None of others
    called : names that comments of such a deck give its properties, by their numbers
    unit : [m] of its coordinates, where it states that and it is no metre, which many write who do not know; else 0
    empty : names, in capitals, of sets that are stated and have no node that is there
    """

    source: str
    node_tags: Integers
    points: Array
    cells: Mapping[str, Cells]
    groups: Mapping[str, Mapping[str, Integers]]
    node_groups: Mapping[str, Integers] = field(default_factory=dict)
    coordinates: Coordinates | None = None
    called: Mapping[str, str] = field(default_factory=dict)
    unit: float = 0.0
    empty: frozenset[str] = frozenset()

    @property
    def names(self) -> list[str]:
        """All groups."""
        return list(dict.fromkeys((*self.groups, *self.node_groups)))

    def nodes_of(self, name: str) -> Integers:
        """Indices of the nodes of the group `name`, ascending."""
        found = [self.cells[kind].nodes[index].ravel() for kind, index in self.groups.get(name, {}).items()]
        return np.unique(np.concatenate([self.node_groups.get(name, np.zeros(0, dtype=np.intp)), *found])).astype(np.intp)


LeftOut = Callable[[str], bool]
"""Of a card or keyword without its asterisk, whether it may be passed over: it is stated elsewhere, or means nothing."""


def read(path: Path, left_out: LeftOut = lambda card: False) -> MeshFile:
    """The mesh in `path`, by its ending; cards that weigh, hold or join are refused unless they are `left_out`.

    Raises
    ------
    BadInput : another ending, no such file, not of its format, damaged, nodes that are missing or not finite, no elements.
    """
    source, reader = str(path), READERS.get(path.suffix.lower())
    if reader is None:
        problem = f"its ending {path.suffix!r} is none of {', '.join(ENDINGS)}"
        raise BadInput(source, "", problem, "Convert it, or correct its ending")
    if not path.is_file():
        raise BadInput(source, "", "there is no such file", "Check the path")
    if path.stat().st_size > LARGEST_FILE:
        problem = f"it has {path.stat().st_size / 2**30:.3g} GiB, more than {LARGEST_FILE / 2**30:.3g}"
        raise BadInput(source, "", problem, "Write a coarser mesh")
    try:
        mesh = (reader(path, left_out) if path.suffix.lower() in DECKS else reader(path)).numbered(source)
    except BadInput:
        raise
    except (ValueError, IndexError, KeyError, OverflowError) as error:  # a field that is no number, a record that is cut off
        raise BadInput(source, "", f"a record of it cannot be read: {type(error).__name__}, {error}", _AGAIN) from None
    if not mesh.cells or not len(mesh.points):
        raise BadInput(source, "", "it holds no elements that are known here", _AGAIN)
    used = np.unique(np.concatenate([cells.nodes.ravel() for cells in mesh.cells.values()]))
    wrong = used[~(np.abs(mesh.points[used]) < 1e30).all(axis=1)]  # NaN is not below either
    if len(wrong):
        problem = f"{len(wrong)} node(s) are nowhere (not finite), the first is {mesh.node_tags[wrong[0]]}"
        raise BadInput(source, "nodes", problem, _AGAIN)
    return mesh


Nodes = dict[int, tuple[float, float, float]]
Elements = dict[str, dict[int, list[int]]]


@dataclass(frozen=True, eq=False, kw_only=True)
class _Raw:
    """What a reader found: nodes and elements by number, groups of their numbers by name; and by the number of an element what
    it states, as in `Cells`: its axis, its offsets, the motions that are loose."""

    nodes: Mapping[int, Sequence[float] | Array]
    elements: Elements
    groups: dict[str, list[int]]
    node_groups: dict[str, list[int]]
    axes: Mapping[int, Array] = field(default_factory=dict)
    offsets: Mapping[int, Array] = field(default_factory=dict)
    loose: Mapping[int, npt.NDArray[np.bool_]] = field(default_factory=dict)
    coordinates: Coordinates | None = None
    called: Mapping[str, str] = field(default_factory=dict)
    unit: float = 0.0

    def numbered(self, source: str) -> MeshFile:
        tags = np.array(sorted(self.nodes), dtype=np.intp)
        cells, where = {}, {}
        for kind, elements in self.elements.items():
            wanted = _count(kind)
            short = [tag for tag, nodes in elements.items() if len(nodes) != wanted]
            if short:
                problem = f"element {short[0]} has {len(elements[short[0]])} nodes where a {kind} has {wanted}"
                raise BadInput(source, "elements", problem, _AGAIN)
            nodes = np.array(list(elements.values()), dtype=np.int64).reshape(-1, wanted)
            at = np.minimum(np.searchsorted(tags, nodes), max(len(tags) - 1, 0))
            lost = np.flatnonzero((tags[at] != nodes).any(axis=1)) if len(tags) else np.arange(len(nodes))
            if len(lost):
                problem = f"{len(lost)} element(s) have nodes that the file does not hold, the first is {list(elements)[lost[0]]}"
                raise BadInput(source, "elements", problem, _AGAIN)
            cells[kind] = Cells(
                kind=kind,
                tags=np.array(list(elements), dtype=np.int64),
                nodes=at.astype(np.intp),
                axes=_stated(elements, self.axes, np.nan),
                offsets=_stated(elements, self.offsets, 0.0),
                loose=_stated(elements, self.loose, False),
            )
            for index, tag in enumerate(elements):
                if tag in where:
                    raise BadInput(source, "elements", f"two elements have the number {tag}", "Give each a number of its own")
                where[tag] = (kind, index)
        groups: dict[str, dict[str, Integers]] = {}
        for name, members in self.groups.items():
            by_kind: dict[str, list[int]] = {}
            for kind, index in filter(None, map(where.get, dict.fromkeys(members))):
                by_kind.setdefault(kind, []).append(index)
            if by_kind:
                groups[name] = {kind: np.array(index, dtype=np.intp) for kind, index in by_kind.items()}
        sets = {name: at for name, own in self.node_groups.items() if len(at := np.flatnonzero(np.isin(tags, own)))}
        points = np.array([self.nodes[tag] for tag in tags.tolist()], dtype=np.float64).reshape(-1, 3)
        return MeshFile(
            source=source,
            node_tags=tags,
            points=points,
            cells=cells,
            groups=groups,
            node_groups=sets,
            coordinates=self.coordinates,
            called=self.called,
            unit=self.unit,
            empty=frozenset(map(str.upper, {*self.groups, *self.node_groups} - {*groups, *sets})),
        )


def _count(kind: str) -> int:
    """Of the nodes of an element."""
    return int(kind.lstrip("abcdefghijklmnopqrstuvwxyz") or 1)


def _stated(elements: Mapping[int, Any], table: Mapping[int, npt.NDArray[Any]], fill: float) -> npt.NDArray[Any] | None:
    """What `table` says of each of the elements, (c, ...) with `fill` where it says nothing; None where it does so of all."""
    own = {index: table[tag] for index, tag in enumerate(elements) if tag in table} if table else {}
    if not own:
        return None
    found = np.full((len(elements), *next(iter(own.values())).shape), fill)
    found[list(own)] = list(own.values())
    return found


# Abaqus and CalculiX: *NODE, *ELEMENT, *NSET and *ELSET, in free format.

_ABAQUS = {
    "tri3": ("CPS3", "CPE3", "S3", "S3R", "STRI3", "STRI65_3", "M3D3", "DS3"),
    "tri6": ("CPS6", "CPE6", "S6", "STRI65", "M3D6"),
    "quad4": ("CPS4", "CPS4R", "CPE4", "CPE4R", "S4", "S4R", "S4RS", "S4R5", "M3D4", "M3D4R"),
    "quad8": ("CPS8", "CPS8R", "CPE8", "CPE8R", "S8", "S8R", "S8R5", "M3D8", "M3D8R"),
    "tet4": ("C3D4", "C3D4H"),
    "tet10": ("C3D10", "C3D10M", "C3D10T", "C3D10H", "C3D10HS"),
    "wedge6": ("C3D6", "C3D6H"),
    "wedge15": ("C3D15", "C3D15H"),
    "hex8": ("C3D8", "C3D8R", "C3D8I", "C3D8H", "C3D8IH", "C3D8RH"),
    "hex20": ("C3D20", "C3D20R", "C3D20RI", "C3D20H", "C3D20RH"),
    "line2": ("B31", "B31R", "B33", "T3D2", "B21", "B23", "B31OS"),
    "line3": ("B32", "B32R", "T3D3", "B22"),
}
_ABAQUS_CARRIES = (
    *("MASS", "ROTARY INERTIA", "NONSTRUCTURAL MASS", "SPRING", "DASHPOT", "NODAL THICKNESS"),
    *("TIE", "MPC", "EQUATION", "RIGID BODY", "KINEMATIC COUPLING", "DISTRIBUTING COUPLING", "COUPLING"),
    *("CONTACT PAIR", "FASTENER", "SHELL TO SOLID COUPLING", "EMBEDDED ELEMENT", "CYCLIC SYMMETRY MODEL"),
    *("PRE-TENSION SECTION", "DISTRIBUTING", "RELEASE", "FOUNDATION", "BEAM ADDED INERTIA", "MODEL CHANGE", "IMPERFECTION"),
    *("CONTACT", "CONTACT INCLUSIONS", "CONNECTOR SECTION", "GAP", "JOINT", "MATRIX ASSEMBLE", "REBAR"),
)
"""Keywords that weigh, hold or join, and are not read."""
LOOSE = {
    "MASS": "MASS",
    "ROTARYI": "ROTARY INERTIA",
    **dict.fromkeys(("SPRING1", "SPRING2", "SPRINGA"), "SPRING"),
    **dict.fromkeys(("DASHPOT1", "DASHPOT2", "DASHPOTA"), "DASHPOT"),
}
"""Elements that no mesh needs, with the keyword that says how heavy or how stiff they are."""

_STATE = (
    "State it in the description, which `massline model` writes from a deck, and write left_out = [{0!r}] under [fe_model]; "
    "or take it out of the mesh"
)
_ABAQUS_MAKES = ("NGEN", "NFILL", "NCOPY", "ELGEN", "ELCOPY")
"""Keywords with nodes and elements that do not stand in the file."""

_ABAQUS_KINDS = {word: kind for kind, words in _ABAQUS.items() for word in words}


def _abaqus(path: Path, left_out: LeftOut) -> _Raw:
    nodes: Nodes = {}
    elements: Elements = {}
    groups: dict[str, list[int]] = {}
    node_groups: dict[str, list[int]] = {}
    spelt: dict[tuple[str, str], str] = {}  # a set is called as it is first, whatever capitals it has afterwards
    keyword, options, kind, pending, towards = "", dict[str, str](), "", list[int](), dict[int, tuple[int, int]]()
    members = list[int]()
    for line in deck_lines(path):
        text = line.text.strip()
        if text.startswith("*"):
            keyword, options = keyword_of(text)
            options |= {k: spelt.setdefault((k, options[k].upper()), options[k]) for k in {"NSET", "ELSET"} & {*options}}
            pending = []
            if keyword in _ABAQUS_MAKES:
                problem = f"it has *{text[1:]}, which is not followed"
                raise BadInput(str(path), "", problem, "Write a flat file with all nodes and elements in it")
            if keyword in ("NSET", "ELSET"):  # which may stay empty
                members = (node_groups if keyword == "NSET" else groups).setdefault(options.get(keyword, ""), [])
            word, system = options.get("TYPE", "").upper(), options.get("SYSTEM", "R").upper()
            keyword = LOOSE.get(word, keyword) if keyword == "ELEMENT" else keyword  # whether or not it says how heavy
            if keyword == "SYSTEM" or (keyword == "NODE" and system != "R"):
                problem = f"it has *{text[1:]}, and nodes in a system of their own are not read"
                raise BadInput(str(path), f"*{keyword}", problem, "Write nodes in global axes")
            if keyword in _ABAQUS_CARRIES and not left_out(keyword):
                problem = f"it has *{text[1:]}, which is not read, and what it weighs, holds or joins would be lost"
                raise BadInput(str(path), f"*{keyword}", problem, _STATE.format(keyword))
            if keyword == "ELEMENT":
                if word not in _ABAQUS_KINDS:
                    known = ", ".join(sorted(words[0] for words in _ABAQUS.values()))
                    problem = f"elements of type {word!r} are not known"
                    raise BadInput(str(path), "*ELEMENT", problem, f"Known are {known} and their kin")
                kind = _ABAQUS_KINDS[word]
            continue
        fields = [field.strip() for field in text.split(",")]
        if keyword == "NODE":
            x, y, z = map(real, [*fields, "", "", ""][1:4])
            _once(nodes, int(fields[0]), (x, y, z), str(path))
            if "NSET" in options:
                node_groups.setdefault(options["NSET"], []).append(int(fields[0]))
        elif keyword == "ELEMENT":
            pending += [int(field) for field in fields if field]
            if text.endswith(","):
                continue
            tag, *own = pending
            if kind in BEAMS and len(own) == _count(kind) + 1:  # the last tells the first axis of its section
                towards[tag] = own[0], own.pop()
            _once(elements.setdefault(kind, {}), tag, own[::2] + own[1::2] if kind == "line3" else own, str(path))
            pending = []
            if "ELSET" in options:
                groups.setdefault(options["ELSET"], []).append(tag)
        elif keyword in ("NSET", "ELSET"):
            table = node_groups if keyword == "NSET" else groups
            if "GENERATE" in options:
                start, stop, step = map(int, [*filter(None, fields), "1"][:3])
                members += range(start, min(stop, start + 5_000_000) + 1, max(step, 1))
                continue
            for field in fields:
                if field.lstrip("-").isdigit():
                    members.append(int(field))
                elif field:
                    members += table.get(spelt.get((keyword, field.upper()), field), [])
    if gone := [tag for tag, ends in towards.items() if not nodes.keys() >= {*ends}]:
        raise BadInput(str(path), "*ELEMENT", f"element {gone[0]} is on, or turned by, a node that is not there", "Correct it")
    axes = {tag: np.subtract(nodes[to], nodes[one]) for tag, (one, to) in towards.items()}
    return _Raw(nodes=nodes, elements=elements, groups=groups, node_groups=node_groups, axes=axes)


def _once(table: dict[int, Any], tag: int, value: Any, source: str) -> None:
    if tag in table:
        raise BadInput(source, "", f"the number {tag} is given twice", "Give each node and element its own")
    table[tag] = value


# Nastran bulk data: grid points and elements, a group for each property (its number, or the name that a comment gives it).

NASTRAN = {
    "CTETRA": ("tet4", "tet10"),
    "CHEXA": ("hex8", "hex20"),
    "CPENTA": ("wedge6", "wedge15"),
    **dict.fromkeys(("CTRIA3", "CTRIAR"), ("tri3",)),
    **dict.fromkeys(("CQUAD4", "CQUADR"), ("quad4",)),
    "CTRIA6": ("tri6",),
    "CQUAD8": ("quad8",),
    **dict.fromkeys(("CBAR", "CBEAM", "CROD", "CTUBE", "CONROD"), ("line2",)),
}
_CARRIES = re.compile(
    r"RBE[1-3]|RBAR1?|RROD|RJOINT|RSPLINE|RTRPLT1?|MPC|NSM1?|NSML1?"
    r"|CONM[12]|CMASS\d|CELAS\d|CDAMP\d|CBUSH\w*|CVISC|CGAP|CBEND|CBEAM3|CWELD|CFAST|CSEAM|CSHEAR|CPYRAM?|GENEL"
    r"|CQUAD|CQUADX\d?|CTRIAX\d?|CTRAX\d|CPLST[NS]\d|CRAC[23]D|CDUM\d|CHBDY[EGP]|CFLUID\d|CAXIF\d|CSLOT\d|CHACAB|CHACBR|CAABSF"
)
"""Cards of bulk data that weigh, hold or join, and are not read."""

_MIDDLES_LAST = {"hex20": [*range(12), *range(16, 20), *range(12, 16)], "wedge15": [*range(9), *range(12, 15), *range(9, 12)]}
"""Nastran gives the middles of the upright edges before those of the top."""


def _nastran(path: Path, left_out: LeftOut) -> _Raw:
    elements: Elements = {}
    groups: dict[str, list[int]] = {}
    where, usual, stating = Coordinates(source=str(path)), dict[str, list[str]](), list[tuple[str, str, list[str]]]()
    for card, *fields in cards(path):
        if card in ("BAROR", "BEAMOR"):
            usual[card[: card.index("OR")]] = fields
        elif card == "GRID":
            _once(where.grids, int(fields[0]), fields, str(path))
        elif card == "GRDSET":
            where.usual = fields
        elif CARD.fullmatch(card):
            where.add(card, fields)
        elif card in NASTRAN:
            fields = filled(fields, usual[card[1:]]) if card[1:] in usual else fields
            tag, group, kinds, begin = int(fields[0]), fields[1] or fields[0], NASTRAN[card], 2
            if card == "CONROD":  # material and area stand in it instead of a property
                group, begin = own_property(fields), 1
            most = max(map(_count, kinds))
            own = [int(field) for field in fields[begin : begin + most] if field]
            kind = next((kind for kind in kinds if _count(kind) == len(own)), "")
            if not kind:
                raise BadInput(str(path), card, f"the {card} {tag} has {len(own)} nodes", f"It is read as {' or '.join(kinds)}")
            _once(elements.setdefault(kind, {}), tag, [own[n] for n in _MIDDLES_LAST.get(kind, range(len(own)))], str(path))
            groups.setdefault(group, []).append(tag)
            if card in ("CBAR", "CBEAM") or (kind in SHELLS and any(fields[begin + most :])):
                stating.append((card, kind, fields))
        elif _CARRIES.fullmatch(card) and not left_out(card):
            problem = f"{card} {fields[0]} is not read, and what it weighs, holds or joins would be lost"
            raise BadInput(str(path), card, problem, _STATE.format(card))
    # What a program without properties writes has one number for a volume, its skin and its edges
    dimension = {tag: DIMENSION[kind] for kind, own in elements.items() for tag in own}
    apart: dict[str, list[int]] = {}
    for name, members in groups.items():
        top = max(dimension[tag] for tag in members)
        for tag in members:
            apart.setdefault(name if dimension[tag] == top else f"{name} {_WORDS[dimension[tag]]}", []).append(tag)
    called = properties(path)
    apart |= {name: list(apart[number]) for number, name in called.items() if number in apart and name not in apart}
    nodes = {number: where.place(number) for number in where.grids}
    raw = _Raw(nodes=nodes, elements=elements, groups=apart, node_groups={}, coordinates=where, called=called)
    axes, offsets, loose = dict[int, Array](), dict[int, Array](), dict[int, npt.NDArray[np.bool_]]()
    for card, kind, fields in stating:
        tag, f = int(fields[0]), [*filled(fields, usual.get(card[1:], [])), *16 * [""]]
        own = [node for node in elements[kind][tag] if node in nodes]
        at, off = np.array([nodes[node] for node in own]), np.zeros(3)
        if len(own) != len(elements[kind][tag]):
            continue  # which is refused
        side = at[1] - at[0]
        if kind in BEAMS:
            to, off = _beam_states(f, own, at, nodes, where)
            axes[tag] = to if to.any() else np.full(3, np.nan)
            if pins := "".join(f[8:10]).strip("0"):
                if not re.fullmatch("[1-6]+", pins):
                    problem = f"PA and PB of {card} {tag} are {f[8] or 'empty'} and {f[9] or 'empty'}"
                    raise BadInput(str(path), card, problem, "Write freedoms from 1 to 6, as 456")
                loose[tag] = np.array([LOOSE_AS[k] in f[8 + end] for end in (0, 1) for k in range(6)])
        else:
            first = 14 if kind == "quad8" else 2 + len(own)
            turn, normal = f[first], np.cross(side, at[2] - at[0])
            normal, side = (one / max(float(np.linalg.norm(one)), 1e-300) for one in (normal, side))
            if turn.isdigit():
                axes[tag] = where.system(turn).directions(at.mean(axis=0))[0]
            elif angle := np.radians(real(turn)):
                axes[tag] = np.cos(angle) * side + np.sin(angle) * np.cross(normal, side)
            off = np.tile(real(f[first + 1]) * normal, (len(own), 1))
        if off.any():
            offsets[tag] = off
    return replace(raw, axes=axes, offsets=offsets, loose=loose)


LOOSE_AS = "132465"
"""Motions of a beam's end in the axes of its section as freedoms of Nastran, whose y is z here, and whose z is -y."""


def filled(fields: Sequence[str], usual: Sequence[str]) -> list[str]:
    """Fields of a beam with what BAROR or BEAMOR say of those that it leaves empty: property and orientation."""
    found = [*fields, *8 * [""]][: max(len(fields), 8)]
    at = [k for k in (1, 4, 5, 6, 7) if k in (1, 7) or not any(found[4:7])]
    return [[*usual, *8 * [""]][k] if k in at and not text else text for k, text in enumerate(found)]


def _beam_states(
    f: Sequence[str], own: Sequence[int], at: Array, nodes: Mapping[int, Array], where: Coordinates
) -> tuple[Array, Array]:
    """Orientation (3,) of a CBAR or CBEAM between two nodes `at` (2, 3), and the offsets (2, 3) of its ends from them."""
    ways = [np.eye(3) if (axes := where.freedoms(node)) is None else axes for node in own]
    offt = (f[7].upper() if f[7].isalpha() else "") or "GGG"
    if not re.fullmatch("[GB][GO][GO]", offt):
        raise BadInput(where.source, "OFFT", f"OFFT of beam {f[0]} is {offt}", "Write GGG, or another of G, B and O")
    if f[4].isdigit() and not f[5]:
        if int(f[4]) not in nodes:
            problem = f"G0 of beam {f[0]}, which tells how it is turned, is node {f[4]}, which is not there"
            raise BadInput(where.source, "CBAR, CBEAM", problem, "Correct it, or write a vector (X1, X2, X3)")
        to = nodes[int(f[4])] - at[0]
    else:
        to = np.array([real(text) for text in f[4:7]]) @ (np.eye(3) if offt[0] == "B" else ways[0])
    offsets = np.array([[real(text) for text in f[k : k + 3]] for k in (10, 13)])
    x = (at[1] - at[0]) / max(float(np.linalg.norm(at[1] - at[0])), 1e-300)
    z = np.cross(x, to)
    z = z / max(float(np.linalg.norm(z)), 1e-300)
    frame = np.array([x, np.cross(z, x), z])
    return to, np.array([off @ (frame if way == "O" else own) for off, way, own in zip(offsets, offt[1:], ways, strict=False)])


_WORDS = ("points", "lines", "faces", "volumes")


def own_property(fields: Sequence[str]) -> str:
    """The group of a CONROD with those `fields`, by its material and what else it states of itself."""
    return " ".join(("CONROD", *(text for text in fields[3:8] if text)))


def cards(path: Path) -> Iterator[list[str]]:
    """Cards from BEGIN BULK, if it is there, to ENDDATA as a name and fields: small, large and free, continued ones put together.

    Fields are those of the card before where they read ``=``, two more than there as ``*2``, and ``==`` stands for all others as
    well; so may the name of a card. ``=6`` does so six times again.

    Raises
    ------
    BadInput : a line that is marked as continued, and is not by the next; a file that ends within a card; what repeats nothing.
    """
    last, pattern = list[str](), list[str]()
    for card in _cards(path):
        if not card[0].startswith("="):
            last, pattern = _repeated(last, card) if last[:1] == card[:1] and "==" in card else card, []
            yield last
            continue
        times = card[0].strip("=()")
        pattern = card if not times else pattern
        if not last or not pattern or not (times.isdigit() or not times) or int(times or 1) > MOST_REPEATED:
            raise BadInput(str(path), "=", f"{','.join(card)!r} repeats no card", "Write every card")
        for _ in range(int(times or 1)):
            last = _repeated(last, pattern)
            yield last


MOST_REPEATED = 1_000_000
"""Times that a card may be repeated: more than a mesh has nodes."""


def _repeated(last: list[str], pattern: list[str]) -> list[str]:
    found = last[:1]
    for before, text in zip([*last, *8 * [""]][1:], pattern[1:], strict=False):
        if text == "==":
            break
        more = text[1:].strip("()") if text.startswith("*") else ""
        if more:
            found.append(str(int(before) + int(more)) if before.isdigit() else repr(real(before) + real(more)))
        else:
            found.append(before if text == "=" else text)
    return found + (last[len(found) :] if "==" in pattern else [])


def _cards(path: Path) -> Iterator[list[str]]:
    """`cards` as they are written."""

    def refused(problem: str) -> BadInput:
        return BadInput(str(line.file), "", problem, "Write it again; it may be cut short or damaged")

    card: list[str] = []
    lines = tuple(deck_lines(path))
    begun = not any(BEGIN.match(line.text) for line in lines)
    text = mark = ""  # mark: of the line that continues the last one, where its tenth field says one
    ended, line = path.read_bytes()[-1:] == b"\n", Line("", path, 0)
    for line in lines:
        text = line.text.split("$")[0].expandtabs(8).rstrip()
        if begin := BEGIN.match(text):
            if begun or begin[1].upper() == "SUPER" or re.search(r"SUPER|AUXM", begin[2], re.IGNORECASE):
                problem = f"line {line.number} begins a further model ({text.strip()}), and superelements are not read"
                raise BadInput(str(line.file), "", problem, "Write one model with all grid points and elements")
            begun = True
            continue
        if not text or not begun:
            continue
        first = text.split(",")[0][:8].strip()
        large = "*" in first[:1] + first[-1:]
        if "," in text:
            fields, width = [field.strip() for field in text.split(",")], 5 if large else 9
            if any(fields[width + 1 :]) or re.match(r"[-.\d]", fields[width] if fields[width:] else ""):
                raise refused(f"line {line.number} has more fields than the {width - 1} of a line")
            fields = [*fields, *8 * [""]][:width]
        else:
            width = 16 if large else 8
            fields = [first, *(text[n : n + width].strip() for n in range(8, 72, width))]
        follows = fields[0][:1] in ("", "+") or (fields[0].startswith("*") and bool(card))
        if mark and not (follows and fields[0][1:] in ("", mark)):
            raise refused(f"line {line.number} is {first!r}, where the one before is continued by +{mark}")
        behind = "" if "," in text else text[72:80].strip()
        mark = behind[1:] if behind[:1] in ("+", "*") and behind else ""
        if first.upper() == "ENDDATA":
            ended = True
            break
        if follows:
            card += fields[1:]
            continue
        if card:
            yield card
        card = [fields[0].rstrip("*").upper(), *fields[1:]]
    cut = card if text and not ended else []  # the last line is no comment and may lack its end
    halved = any(word.startswith(cut[0]) and word != cut[0] for word in ("GRID", *NASTRAN)) if cut else False
    if mark or halved or (cut[:1] == ["GRID"] and not any(cut[5:6])):
        raise refused("it ends within a card")
    if card:
        yield card


# Universal files: datasets 164 (units), 2420 (axes), 2411 (nodes), 2412 (elements) and 2467, 2477, 2452, 2435 (groups).

_UNIVERSAL = {"line2": (11, 21, 22), "line3": (24,), "tri3": (41, 51, 61, 74, 91), "tri6": (42, 52, 62, 72, 92)}
_UNIVERSAL |= {"quad4": (44, 54, 64, 71, 94), "quad8": (45, 55, 65, 75, 95), "tet4": (111,), "tet10": (118,)}
_UNIVERSAL |= {"wedge6": (112,), "wedge15": (113,), "hex8": (115,), "hex20": (116,), POINT: (161,)}
_UNIVERSAL_KINDS = {number: kind for kind, numbers in _UNIVERSAL.items() for number in numbers}
_ROUND = {
    "tri6": [0, 2, 4, 1, 3, 5],
    "quad8": [0, 2, 4, 6, 1, 3, 5, 7],
    "tet10": [0, 2, 4, 9, 1, 3, 5, 6, 7, 8],
    "hex20": [0, 2, 4, 6, 12, 14, 16, 18, 1, 3, 5, 7, 13, 15, 17, 19, 8, 9, 10, 11],
    "wedge15": [0, 2, 4, 9, 11, 13, 1, 3, 5, 10, 12, 14, 6, 7, 8],
    "line3": [0, 2, 1],
}
"""Corners and middles go round together there: where each of ours stands."""


def _universal(path: Path) -> _Raw:
    nodes: Nodes = {}
    elements: Elements = {}
    groups: dict[str, list[int]] = {}
    node_groups: dict[str, list[int]] = {}
    unit, askew, within = 0.0, set[str](), dict[str, str]()  # systems, by which node is in it first
    for number, lines in _datasets(path):
        if number == 164:
            per_metre = real(lines[1].split()[0])
            unit = 1 / per_metre if per_metre not in (0.0, 1.0) else 0.0
        elif number == 2420:  # of each its number and kind, its name, three axes and where they begin
            for head, *rows in zip(*(lines[k::6] for k in (2, 4, 5, 6, 7)), strict=False):
                axes = np.array([[real(word) for word in row.split()] for row in rows])
                askew |= {head.split()[0]} if head.split()[1] != "0" or np.any(axes != np.eye(4, 3)) else set()
        elif number == 2411:
            for head, place in zip(lines[::2], lines[1::2], strict=False):
                node, system, *_ = head.split()
                within.setdefault(system, node)
                x, y, z = map(real, place.split())
                _once(nodes, int(node), (x, y, z), str(path))
        elif number == 2412:
            rest = iter(lines)
            for head in rest:
                tag, code, *_, count = (int(word) for word in head.split())
                if code in (11, 21, 22, 24):
                    next(rest, "")
                own: list[int] = []
                while len(own) < count and (line := next(rest, None)) is not None:
                    own += [int(word) for word in line.split()]
                if code not in _UNIVERSAL_KINDS:
                    problem = f"elements of type {code} are not known"
                    raise BadInput(str(path), "2412", problem, f"Known are {', '.join(map(str, sorted(_UNIVERSAL_KINDS)))}")
                kind = _UNIVERSAL_KINDS[code]
                _once(elements.setdefault(kind, {}), tag, [own[n] for n in _ROUND.get(kind, range(count))], str(path))
        elif number in (2435, 2452, 2467, 2477):
            rest = iter(lines)
            for head in rest:
                count, name, words = int(head.split()[-1]), next(rest, "").strip(), list[int]()
                while len(words) < 4 * count and (line := next(rest, None)) is not None:
                    words += [int(word) for word in line.split()]
                for code, tag in zip(words[::4], words[1::4], strict=False):
                    table = node_groups if code == 7 else groups
                    table.setdefault(name, []).append(tag)
    for system in within.keys() & askew:
        problem = f"node {within[system]} is in the system {system}, which dataset 2420 turns, moves or makes round"
        raise BadInput(str(path), "2411", problem, "Write nodes in global axes")
    return _Raw(nodes=nodes, elements=elements, groups=groups, node_groups=node_groups, unit=unit)


def _datasets(path: Path) -> Iterator[tuple[int, list[str]]]:
    inside: list[str] | None = None
    for line in text_lines(path):
        if line.strip() == "-1":
            if inside:
                yield int(inside[0]), inside[1:]
            inside = [] if inside is None else None
        elif inside is not None:
            inside.append(line)
    if inside:
        raise BadInput(str(path), "", f"the dataset {inside[0].strip()} does not end", _AGAIN)


# MSH and MED through gmsh: ``python -m fem.mesh.files FILE ANSWER``.

_GMSH = {1: "line2", 2: "tri3", 3: "quad4", 4: "tet4", 5: "hex8", 6: "wedge6", 8: "line3", 9: "tri6", 10: "quad8", 11: "tet10"}
_GMSH |= {12: "hex20", 15: POINT, 16: "quad8", 17: "hex20", 18: "wedge15"}
_FROM_GMSH = {
    "tet10": [0, 1, 2, 3, 4, 5, 6, 7, 9, 8],
    "hex20": [*range(8), 8, 11, 13, 9, 16, 18, 19, 17, 10, 12, 14, 15],
    "wedge15": [*range(6), 6, 9, 7, 12, 14, 13, 8, 10, 11],
    "quad8": list(range(8)),
}
"""Where each of our nodes stands in gmsh; what is in the middle of faces and of the cell is left out."""

_BEGINNINGS = {".msh": (b"$MeshFormat", b"$Comments"), ".med": (b"\x89HDF\r\n\x1a\n",)}


def _through_gmsh(path: Path) -> _Raw:
    require_gmsh()
    source, ending = str(path), path.suffix.lower()
    with path.open("rb") as file:
        beginning = file.read(16)
    if not beginning.startswith(_BEGINNINGS[ending]):
        problem = f"it does not begin as a {ending} file does, but with {beginning[:12]!r}"
        raise BadInput(source, "", problem, "Save it as MSH 4.1 or 2.2, or as MED 4")
    with tempfile.TemporaryDirectory() as folder:
        answer = Path(folder, "mesh.npz")
        command = [sys.executable, "-P", "-m", "fem.mesh.files", str(path.resolve()), str(answer)]
        environment = {**os.environ, "PYTHONPATH": os.pathsep.join(entry or os.getcwd() for entry in sys.path)}
        try:
            run = subprocess.run(
                command, cwd=folder, env=environment, capture_output=True, text=True, timeout=TIME_LIMIT, check=False
            )
        except subprocess.TimeoutExpired:
            raise BadInput(source, "", f"gmsh has not finished with it after {TIME_LIMIT / 60:g} minutes", _AGAIN) from None
        if not answer.is_file():
            *_, words = (f"its process ended with {run.returncode}", *filter(str.strip, run.stderr.splitlines()))
            raise BadInput(source, "", f"gmsh cannot read it ({words.strip()[:200]})", _AGAIN)
        with np.load(answer, allow_pickle=False) as arrays:
            return _unpacked(arrays, source)


def _work(path: str, answer: str) -> None:
    arrays: dict[str, np.ndarray] = {}
    with session() as gmsh:
        gmsh.merge(path)
        mesh = gmsh.model.mesh
        tags, coordinates, _ = mesh.getNodes()
        arrays |= {"tags": tags.astype(np.int64), "points": np.reshape(coordinates, (-1, 3))}
        blocks: list[str] = []
        for entity in gmsh.model.getEntities():
            groups = [int(group) for group in gmsh.model.getPhysicalGroupsForEntity(*entity)]
            named = [gmsh.model.getPhysicalName(entity[0], group).strip("\0 ") or str(group) for group in groups]
            for code, elements, nodes in zip(*mesh.getElements(*entity), strict=True):
                key = str(len(blocks))
                arrays[f"elements/{key}"] = elements.astype(np.int64)
                arrays[f"nodes/{key}"] = np.reshape(nodes, (len(elements), -1)).astype(np.int64)
                blocks.append("\n".join([str(code), *dict.fromkeys(named)]))
        arrays["blocks"] = np.array(blocks, dtype=np.str_)
    np.savez(answer, allow_pickle=False, **arrays)


def _unpacked(arrays: Mapping[str, np.ndarray], source: str) -> _Raw:
    elements, groups = Elements(), dict[str, list[int]]()
    for key, said in enumerate(arrays["blocks"]):
        code, *names = str(said).split("\n")
        kind, tags, nodes = _GMSH.get(int(code), ""), arrays[f"elements/{key}"].tolist(), arrays[f"nodes/{key}"]
        if not kind:
            problem = f"{len(tags)} elements of gmsh's type {code} are not known"
            remedy = "Write lines, triangles, quadrilaterals, tetrahedra, hexahedra or wedges of first or second order"
            raise BadInput(source, "elements", problem, remedy)
        own = nodes[:, _FROM_GMSH.get(kind, range(nodes.shape[1]))].tolist()
        elements.setdefault(kind, {}).update(zip(tags, own, strict=True))
        for name in names:
            groups.setdefault(name, []).extend(tags)
    points = dict(zip(arrays["tags"].tolist(), arrays["points"].tolist(), strict=True))
    return _Raw(nodes=points, elements=elements, groups=groups, node_groups={})


READERS: Mapping[str, Callable[..., _Raw]] = {
    **dict.fromkeys((".msh", ".med"), _through_gmsh),
    **dict.fromkeys(DECKS, _nastran),
    ".inp": _abaqus,
    ".unv": _universal,
}
ENDINGS = tuple(READERS)


def carries(card: str) -> bool:
    """Whether a card, or a keyword without its asterisk, weighs, holds or joins, and is not read with the mesh."""
    return card in _ABAQUS_CARRIES or _CARRIES.fullmatch(card) is not None


def called(mesh: MeshFile, name: str) -> str:
    """The group that a deck means, to whom capitals are no different from small letters."""
    return next((own for own in mesh.names if own.upper() == name.upper()), name)


def numbers_of(mesh: MeshFile, named: Iterable[int | str]) -> list[int]:
    """Numbers of the nodes of groups, and numbers as they are; NotThere: a group that the mesh does not state."""
    found = list[int]()
    for one in named:
        own = [one] if isinstance(one, int) else mesh.node_tags[mesh.nodes_of(called(mesh, one))].tolist()
        if not own and str(one).upper() not in mesh.empty:
            raise deck_text.NotThere(one)
        found += own
    return found


def joined(names: Iterable[object], most: int = 5) -> str:
    """The first of `names`, and how many more there are."""
    words = [str(name) for name in names]
    return ", ".join(words[:most]) + (f" and {len(words) - most} more" if len(words) > most else "")


if __name__ == "__main__":
    _work(sys.argv[1], sys.argv[2])
