"""Keywords of Abaqus and CalculiX, with their rows of data, of the model and of its first step."""

import re
from collections import Counter
from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np

from fem.beam.elements import plated
from fem.mesh import files
from fem.mesh.constraints import FACES, Sum, areas, following, tied
from fem.mesh.deck_content import TRANSLATIONS, Deck, DeckSpring, Elastic, Mean, Property, Row
from fem.mesh.deck_text import NotThere, System, deck_lines, keyword_of, real
from fem.mesh.files import MeshFile, called, numbers_of
from geometry.frames import Integers, axes_along

FIBRES = {"LAMINA": range(6), "ENGINEERING CONSTANTS": (0, 1, 3, 6, 7, 8)}
"""Where moduli along and across fibres, Poisson's ratio and shear moduli 12, 13 and 23 stand, by the type of elasticity."""

HELD_AS = {"ENCASTRE": "123456", "PINNED": "123", "XSYMM": "156", "YSYMM": "246", "ZSYMM": "345"}
"""What Abaqus calls freedoms that are held together."""

LATE = {"ELSET": 1, **dict.fromkeys(("MASS", "ROTARY INERTIA", "SPRING"), 2)}
"""What is read behind all else, as elements and sets that it names may stand behind it."""


def _blocks(path: Path) -> list[tuple[str, dict[str, str], list[list[str]]]]:
    """Keyword, options and rows of fields, to the end of the first step, or of that which asks for frequencies, as one is; nodes
    and elements come without their rows."""
    found, first, steps = list[tuple[str, dict[str, str], list[list[str]]]](), None, 0
    keyword, options, rows, asked = "", dict[str, str](), list[list[str]](), False
    for line in deck_lines(path):
        text = line.text.strip()
        if not text.startswith("*"):
            meshed = keyword == "ELEMENT" and options.get("TYPE", "").upper() not in files.LOOSE
            heavy = meshed or keyword in ("NODE", "NSET")
            rows += [] if heavy else [[one.strip() for one in text.split(",")]]
            continue
        found += [(keyword, options, rows)] if keyword else []
        (keyword, options), rows = keyword_of(text), []
        steps, asked = steps + (keyword == "STEP"), asked or keyword == "FREQUENCY"
        if steps > 1 and keyword == "STEP":
            if asked:
                return found
            first = first or len(found)
    found.append((keyword, options, rows))
    return found if asked else found[:first]


def read_keywords(path: Path, mesh: MeshFile) -> Deck:
    deck, material, open_step, renewed = Deck(mesh=mesh), "", False, False
    elastic, dense, losses = dict[str, list[str]](), dict[str, float](), dict[str, float]()
    # Of no mesh: kind and nodes of elements by their numbers, and those by their sets
    loose, sets = dict[int, tuple[str, list[int]]](), dict[str, list[int]]()
    fibres, oriented = dict[str, list[float]](), dict[str, str]()
    coupling, surfaces = dict[str, str](), dict[str, Surface]()
    joining = list[tuple[str, dict[str, str], list[list[str]]]]()
    # Carriers of rigid bodies by the nodes whose displacements are their rotations; and orientations
    turning, ways = dict[int, int](), dict[str, tuple[tuple[float, ...], float]]()
    for keyword, options, rows in sorted(_blocks(path), key=lambda block: LATE.get(block[0], 0)):
        o, first = {key: value.upper() for key, value in options.items()}, (rows or [[""]])[0]
        group = called(mesh, options.get("ELSET", ""))
        name = f"*{keyword} {options.get('ELSET', options.get('NAME', options.get('NSET', '')))}".strip()
        if keyword == "MATERIAL":
            material = o["NAME"]
        elif keyword == "ELASTIC":
            several, kind = [text for row in rows for text in [*row, *8 * [""]][:8]], o.get("TYPE", "ISO")
            if kind in FIBRES:
                fibres[material] = [real(several[k]) for k in FIBRES[kind]]
            elif kind not in ("ISO", "ISOTROPIC"):
                deck.lose(f"*MATERIAL {material}", "it is not isotropic; state the part by hand")
            elastic[material] = first
            if len(rows) > 1 and kind not in FIBRES:
                deck.lose(f"*ELASTIC of {material}", "it changes with temperature; the first row is taken")
        elif keyword == "DENSITY":
            dense[material] = real(first[0])
        elif keyword == "DAMPING":
            losses[material] = real(o.get("STRUCTURAL", ""))
            if o.keys() - {"STRUCTURAL"}:
                deck.lose(f"*DAMPING of {material}", "what is not STRUCTURAL; state a loss_factor")
        elif keyword.endswith("SECTION") and group in deck.properties:
            deck.lose(name, "a second section of the same elements")
        elif keyword == "SOLID SECTION":
            lines = any(kind in files.BEAMS for kind in mesh.groups.get(group, {}))  # a truss, and its area
            deck.properties[group] = Property(material=o["MATERIAL"], section={"area": real(first[0]) or 1.0} if lines else {})
        elif keyword == "SHELL SECTION":
            share = o.get("OFFSET", "0.")  # of the thickness, from the middle up to the nodes
            off = {"SPOS": 0.5, "SNEG": -0.5}[share] if share in ("SPOS", "SNEG") else real(share)
            layers: list[tuple[str, float, float]] = []
            if "COMPOSITE" in o:
                for thickness, _, of, *angle in ([*row, "", ""] for row in rows):
                    named = angle[0] and not re.fullmatch(r"[-+.\dEeDd]+", angle[0])
                    if named:
                        deck.lose(name, f"the orientation {angle[0]} of a layer")
                    layers.append((of.upper(), real(thickness), 0.0 if named else real(angle[0])))
                layers += layers[::-1] if "SYMMETRIC" in o else []
            elif off or o.get("MATERIAL") in fibres:
                layers = [(o["MATERIAL"], real(first[0]), 0.0)]
            if "NODAL THICKNESS" in o:
                deck.lose(name, "thicknesses at its nodes")
            whole = sum(one for _, one, _ in layers)
            of, oriented[group] = layers[0][0] if layers else o["MATERIAL"], o.get("ORIENTATION", "")
            deck.properties[group] = Property(
                material=of, thickness=whole or real(first[0]), layers=tuple(layers), offset=-off * whole
            )
        elif keyword == "ORIENTATION":
            turns = real(rows[1][1]) if len(rows) > 1 and len(rows[1]) > 1 else 0.0
            points = np.array([real(text) for text in [*first, *9 * [""]][:9]]).reshape(3, 3)  # on its axes, and where they begin
            ways[o["NAME"]] = tuple((points[0] - points[2]).tolist()), turns
            plain = (o.get("SYSTEM", "RECTANGULAR"), o.get("DEFINITION", "COORDINATES")) == ("RECTANGULAR", "COORDINATES")
            if not plain or (rows[1:] and rows[1][0] != "3"):
                deck.lose(name, "axes that are not of one rectangular system, turned about its third")
        elif keyword == "BEAM SECTION":
            _beam_section(deck, name, group, o, rows)
        elif keyword == "BEAM GENERAL SECTION":
            if "MATERIAL" not in o:  # it states its own
                E, G = (real(text) for text in [*rows[2], ""][:2])
                nu, rho = E / (2 * G) - 1 if G else 0.0, real(o.get("DENSITY", ""))
                deck.materials[f"of {group}"] = Elastic(modulus=E, poisson_ratio=nu, density=rho)
            _beam_section(deck, name, group, {"MATERIAL": f"of {group}", "SECTION": "GENERAL", **o}, rows)
        elif keyword == "ELEMENT" and o.get("TYPE") in files.LOOSE:
            loose |= {int(tag): (o["TYPE"], [int(text) for text in ends if text]) for tag, *ends in rows}
            sets.setdefault(o.get("ELSET", ""), []).extend(int(tag) for tag, *_ in rows)
        elif keyword == "ELSET":
            spans = [[*map(int, filter(None, row)), 1][:3] for row in rows if "GENERATE" in o]
            words = [word.upper() for row in rows if "GENERATE" not in o for word in row if word]
            own = {tag for word in words for tag in ([int(word)] if word.isdigit() else sets.get(word, []))}
            some = [tag for tag in loose if tag in own or any(tag in range(a, b + 1, step or 1) for a, b, step in spans)]
            sets.setdefault(o["ELSET"], []).extend(some)
        elif keyword in ("MASS", "ROTARY INERTIA", "SPRING"):
            tags = dict.fromkeys(sets.get(o["ELSET"], ()))
            bare = [(tag, *loose[tag]) for tag in tags if files.LOOSE[loose[tag][0]] == keyword]
            if not bare and o["ELSET"] not in sets:
                raise NotThere(options["ELSET"])
            if not bare:
                deck.lose(name, "its set has no element of that kind")
            elif keyword == "SPRING":
                _abaqus_spring(deck, name, bare, rows, "ORIENTATION" in o)
            elif keyword == "MASS":
                if len({real(text) for text in first if text}) > 1:
                    deck.lose(name, "it is not alike in all directions; the first is taken")
                for tag, _, (node,) in bare:
                    deck.weigh(keyword, f"MASS {options['ELSET']} {tag}", node, real(first[0]) * np.diag([1, 1, 1, 0, 0, 0]))
            elif any(map(real, first[3:])) or "ORIENTATION" in o:
                deck.lose(name, "it has products, or axes of its own")
            else:
                for *_, (node,) in bare:
                    deck.weigh(keyword, name, node, np.diag([0.0, 0.0, 0.0, *map(real, [*first, "", ""][:3])]))
        elif keyword == "RIGID BODY":
            riders = called(mesh, options.get("NSET", options.get("ELSET", options.get("TIE NSET", ""))))
            carrier = o.get("REF NODE", o.get("REFNODE", ""))
            there = numbers_of(mesh, [int(carrier) if carrier.isdigit() else carrier]) if carrier else []
            if riders and len(there) == 1:
                turning |= {int(one): there[0] for key, one in o.items() if key in ("ROT NODE", "ROTNODE")}
                deck.ride(keyword, f"{keyword} {riders}", there[0], "123456", [riders])
            else:
                deck.lose(name, "it has no reference node, or no NSET, ELSET or TIE NSET")
        elif keyword == "BOUNDARY":
            if o.get("OP") == "NEW" and not renewed:
                deck.held, renewed = {}, True
            _boundary(deck, rows)
        elif keyword == "TRANSFORM" and (kind := o.get("TYPE", "R")) == "S":
            deck.lose(name, "its axes are spherical")
        elif keyword == "TRANSFORM":  # by points of its first axis and of the plane of the first two, or of a cylinder's axis
            a, b = np.array([real(text) for text in [*first, *6 * [""]][:6]]).reshape(2, 3)
            turned = System.spanned(kind, a, b - a, None) if kind == "C" else System.spanned(kind, a, np.cross(a, b), a)
            own = deck.points.keys() & numbers_of(mesh, [options["NSET"]])
            deck.axes |= {node: turned.directions(deck.points[node]) for node in own}
        elif keyword == "SURFACE":
            surfaces[o["NAME"]] = Surface(deck=deck, rows=rows, nodes=o.get("TYPE", "ELEMENT") == "NODE")
        elif keyword == "COUPLING":
            coupling = options
        elif keyword in ("KINEMATIC", "DISTRIBUTING", "EQUATION", "MPC", "TIE"):
            joining.append((keyword, coupling | options if keyword in ("KINEMATIC", "DISTRIBUTING") else options, rows))
        elif keyword in ("STEP", "END STEP"):
            open_step, renewed = keyword == "STEP", False
        elif keyword.endswith("SECTION") or files.carries(keyword):
            deck.lose(name, "a keyword that is not known here")
    for keyword, options, rows in joining:
        _join(deck, keyword, options, rows, surfaces)
    for node, ref in turning.items():
        deck.held.setdefault(ref, set()).update("456"[int(letter) - 1] for letter in deck.held.pop(node, set()) & TRANSLATIONS)
    for name in [name for name, one in deck.springs.items() if one.axes is None]:
        deck.turn_spring(name)
    for group, name in oriented.items():
        one, (along, turns) = deck.properties[group], ways.get(name, ((1.0, 0.0, 0.0), 0.0))
        if name and name not in ways and one.layers:
            deck.lose(f"*SHELL SECTION of {group}", f"no orientation {name} is there")
        layers = [(of, thickness, angle + turns) for of, thickness, angle in one.layers]
        deck.properties[group] = replace(one, layers=tuple(layers), x_axis=along if layers else ())
    if open_step:
        deck.lose("the end", "a *STEP has no *END STEP, and the deck may be cut short")
    for of, row in elastic.items():
        nu = real(row[1]) if row[1:] and row[1] else 0.0
        rho, lost = dense.get(of, 0.0), losses.get(of, 0.0)
        E, across, nu, *shear = fibres.get(of, [real(row[0]), 0.0, nu])
        deck.materials[of] = Elastic(modulus=E, across=across, poisson_ratio=nu, shear=(*shear,), density=rho, loss_factor=lost)
    return deck


def _beam_section(deck: Deck, name: str, group: str, o: Mapping[str, str], rows: Sequence[Sequence[str]]) -> None:
    """Along its first direction, which the second row says, a rectangle has the first of its two sizes."""
    sizes = [real(text) for text in rows[0] if text]
    beams = [(deck.mesh.cells[kind], some) for kind, some in deck.mesh.groups.get(group, {}).items()]
    told = [one.axes is not None and not np.isnan(one.axes[k]).any() for one, some in beams for k in some]  # by its elements
    if any(told) and not all(told):
        deck.lose(name, "which way those of its beams are turned that have a node which says it, as others have none")
    z_axis = () if told and all(told) else tuple(real(text) for text in rows[1][:3]) if rows[1:] else (0.0, 0.0, -1.0)
    section: dict[str, float] = {}
    if any(real(o.get(way, "")) for way in ("OFFSET1", "OFFSET2")):
        deck.lose(name, "how far it is off its nodes (OFFSET1, OFFSET2)")
    if o.get("SECTION", "")[:4] == "RECT":
        section = {"width": sizes[-1], "height": sizes[0]}
    elif o.get("SECTION") == "CIRC" and (len(sizes) == 1 or sizes[0] == sizes[1]):  # a radius, or CalculiX's two diameters
        section = {"outer_diameter": sizes[0] * (2 if len(sizes) == 1 else 1), "inner_diameter": 0.0}
    elif o.get("SECTION") == "PIPE":
        section = {"outer_diameter": 2 * sizes[0], "inner_diameter": 2 * (sizes[0] - sizes[1])}
    elif o.get("SECTION") == "BOX" and len(sizes) == 6 and sizes[2] == sizes[4] and sizes[3] == sizes[5]:
        section = plated("BOX", (sizes[1], sizes[0], *sizes[2:4]))[0]
    elif o.get("SECTION") == "GENERAL":
        A, I1, I12, I2, J = map(real, [*rows[0], *5 * [""]][:5])
        section = {"area": A, "Iy": I2, "Iz": I1, "J": J} | ({"Iyz": -I12} if I12 else {})
    elif o.get("SECTION") == "I" and 2 * sizes[0] == sizes[1] and sizes[2] == sizes[3] and sizes[4] == sizes[5]:
        own = plated("I", (*sizes[1:4], sizes[6], *sizes[4:6]))[0]  # which is as high as its second axis goes
        section = own | {"Iy": own["Iz"], "Iz": own["Iy"]}
    else:
        deck.lose(name, f"a section of kind {o.get('SECTION', 'none')}")
    deck.properties[group] = Property(material=o["MATERIAL"], section=section, z_axis=z_axis)


def _boundary(deck: Deck, rows: Sequence[Sequence[str]]) -> None:
    for who, *what in rows:
        word, last, size, *_ = (*what, "", "", "")
        first = word if word.isdigit() else ""
        letters = HELD_AS.get(word.upper(), "".join(map(str, range(int(first or 1), min(int(last or first or 0), 6) + 1))))
        nodes = numbers_of(deck.mesh, [int(who) if who.isdigit() else who])
        if letters and (real(size) or not nodes):
            deck.lose(f"*BOUNDARY {who}", "held away from where it stands" if nodes else "the set has no nodes")
        for node in nodes:
            deck.held.setdefault(node, set()).update(letters)


def _abaqus_spring(
    deck: Deck, name: str, springs: Sequence[tuple[int, str, list[int]]], rows: Sequence[Row], turned: bool
) -> None:
    """Grounded in one freedom, between two nodes in the same one, or from one to the other."""
    for tag, kind, ends in springs:
        own, axes = f"{name.lstrip('*')} {tag}", None
        if kind == "SPRINGA":
            line = deck.points[ends[1]] - deck.points[ends[0]]
            along, law = [1] if np.any(line) else [], [row for row in rows if any(row)]
            if along:
                axes = axes_along(line)
        else:
            along, law = sorted({int(text) for text in rows[0] if text}), [*rows[1:]]
        if len(along) != 1 or len(law) != 1 or turned:
            deck.lose(f"*{own}", "not linear, along an orientation of its own, or between two different motions")
            continue
        six = np.zeros(6)
        six[along[0] - 1] = real(law[0][0])
        deck.springs[own] = DeckSpring(ends=tuple(ends), stiffness=six, axes=axes)
        deck.carried["SPRING"] = None


# What joins: surfaces, ties, couplings and equations. They are read when all sets and surfaces are there.


@dataclass(frozen=True, eq=False, kw_only=True)
class Surface:
    """A surface of a deck by the `rows` that state it: sets of elements or elements with a face, or of `nodes`."""

    deck: Deck
    rows: Sequence[Row]
    nodes: bool

    def faces(self) -> list[tuple[int, ...]]:
        """Numbers of the nodes of each face, corners first; of edges of shells alike. ValueError: a face that no element has."""
        found = dict[frozenset[int], tuple[int, ...]]()
        for who, label, *_ in ([*row, "", ""] for row in self.rows if not self.nodes):
            for kind, index in self._elements(who).items():
                cells, faces = self.deck.mesh.cells[kind].nodes[index], FACES.get(kind, ())
                if kind in files.SHELLS:
                    faces = self._of_shell(faces[0], label.upper())
                elif label:
                    faces = (faces[int(label.upper().removeprefix("S")) - 1],)
                every = [self.deck.mesh.node_tags[cells[:, list(face)]] for face in faces]
                if not label and kind not in files.SHELLS:  # those that no other element has
                    keys = [frozenset(row) for each in every for row in each.tolist()]
                    alone = {key for key, count in Counter(keys).items() if count == 1}
                    every = [np.array([row for row in each.tolist() if frozenset(row) in alone]) for each in every]
                found |= {frozenset(row): tuple(row) for each in every for row in each.tolist()}
        return list(found.values())

    def _of_shell(self, face: tuple[int, ...], label: str) -> tuple[tuple[int, ...], ...]:
        """The face itself, or the edge that a label (E1, or S3 of CalculiX) names."""
        if label in ("", "SPOS", "SNEG", "S1", "S2"):
            return (face,)
        edge, corners = int(label[1:]) - (1 if label[0] == "E" else 3), 3 if len(face) in (3, 6) else 4
        return ((face[edge], face[(edge + 1) % corners], *face[corners + edge : corners + edge + 1]),)

    def _elements(self, who: str) -> dict[str, Integers]:
        if not who.isdigit():
            return dict(self.deck.mesh.groups[called(self.deck.mesh, who)])
        every = {kind: np.flatnonzero(cells.tags == int(who)) for kind, cells in self.deck.mesh.cells.items()}
        return {kind: index for kind, index in every.items() if len(index)}

    def weights(self) -> dict[int, float]:
        """Of each node, by its number, the area that it carries; of a surface of nodes what is stated, or 1."""
        found = dict[int, float]()
        if self.nodes:
            for who, weight, *_ in ([*row, "", ""] for row in self.rows):
                found |= dict.fromkeys(_several(self.deck, who), real(weight) or 1.0)
            return found
        for face in self.faces():
            for node, area in zip(face, areas(np.array([self.deck.points[node] for node in face])).tolist(), strict=True):
                found[node] = found.get(node, 0.0) + area
        return found


UNREAD = ("INFLUENCE RADIUS", "WEIGHTING METHOD", "CYCLIC SYMMETRY")
"""Options by which other nodes, or others by other weights, are joined, but for weights that are uniform."""


def _join(deck: Deck, keyword: str, o: Mapping[str, str], rows: Sequence[Row], surfaces: Mapping[str, Surface]) -> None:
    """Carry over, or lose in words, what one keyword joins."""
    own = o.get("CONSTRAINT NAME", o.get("NAME", o.get("SURFACE", "")))
    word = "COUPLING" if keyword in ("KINEMATIC", "DISTRIBUTING") else keyword
    name = f"{word} {own or 1 + sum(each.startswith(word) for each in (*deck.equations, *deck.links, *deck.means))}"
    single = [[row] for row in rows if any(row)]  # one that cannot be read loses no other
    for some in _apart(rows) if keyword == "EQUATION" else single if keyword in ("MPC", "TIE") else [rows]:
        lost = len(deck.lost)
        try:
            if asked := [f"{key}={o[key]}".rstrip("=") for key in UNREAD if o.get(key, "UNIFORM") != "UNIFORM"]:
                raise ValueError(f"{', '.join(asked)} is not known here")
            if keyword == "EQUATION":
                deck.equate(keyword, keyword, list(_equations(deck, some)))
            elif keyword == "MPC":
                _multi_point(deck, name, some[0][0].upper(), [_several(deck, end) for end in some[0][1:] if end])
            elif keyword == "TIE":
                _tie(deck, name, o, *(surfaces[one.upper()] for one in some[0][:2]))
            else:
                _couple(deck, keyword, name, o, some, surfaces)
        except (KeyError, IndexError, ValueError) as error:
            del deck.lost[lost:]
            problem = f"{error} of it is not here" if isinstance(error, KeyError) else str(error)
            problem = "a row of it cannot be read" if isinstance(error, IndexError) or "literal" in problem else problem
            deck.lose(f"*{name}", f"{problem}, and {len(some)} row{'s' * (len(some) > 1)} of it with that")


def _apart(rows: Sequence[Row]) -> Iterator[Sequence[Row]]:
    """Rows of one equation after the other, each of which begins with how many terms it has; all that are left if it does not."""
    start = 0
    while start < len(rows):
        count, stop, words = rows[start][0], start + 1, 0
        while stop < len(rows) and (not count.isdigit() or words < 3 * int(count)):
            words, stop = words + sum(map(bool, rows[stop])), stop + 1
        yield rows[start:stop]
        start = stop


def _several(deck: Deck, who: str) -> list[int]:
    return numbers_of(deck.mesh, [int(who) if who.isdigit() else who])


def _equations(deck: Deck, rows: Sequence[Row]) -> Iterator[Sum]:
    """As many as its sets have nodes."""
    words, count = [word for row in rows[1:] for word in row if word], int(rows[0][0])
    if len(words) < 3 * count:
        raise ValueError("an equation ends before its last term")
    nodes = [_several(deck, words[k]) for k in range(0, 3 * count, 3)]
    ways, factors = ([int(word) - 1 for word in words[1::3]], [real(word) for word in words[2::3]])
    if not all(0 <= way < 6 for way in ways):
        raise ValueError("a freedom that is none of motion")
    for k in range(max(map(len, nodes))):
        yield tuple((f, own[k if len(own) > 1 else 0], way) for f, own, way in zip(factors, nodes, ways, strict=True))


def _multi_point(deck: Deck, name: str, kind: str, ends: Sequence[list[int]]) -> None:
    """The first node, or each of a set, follows the second."""
    if kind not in ("BEAM", "TIE", "PIN", "LINK") or len(ends) != 2:
        raise ValueError(f"MPC of type {kind} are not known here")
    for k, one in enumerate(ends[0]):
        other = ends[1][k if len(ends[1]) > 1 else 0]
        if kind == "BEAM":
            six = {(other, way): 1.0 for way in range(6)}
            deck.equate("MPC", name, following(deck.points, [(one, way) for way in range(6)], six, {}))
        elif kind == "LINK":
            line = (deck.points[one] - deck.points[other]).tolist()
            terms = [(sign * share, node, way) for sign, node in ((1, one), (-1, other)) for way, share in enumerate(line)]
            deck.equate("MPC", name, [tuple(sorted(terms, key=lambda term: (term[1] != one, -abs(term[0]))))])
        else:
            deck.equate("MPC", name, [((1.0, one, way), (-1.0, other, way)) for way in range(6 if kind == "TIE" else 3)])


def _couple(
    deck: Deck, keyword: str, name: str, o: Mapping[str, str], rows: Sequence[Row], surfaces: Mapping[str, Surface]
) -> None:
    """Nodes of a surface ride on a node, or that follows their mean motion by the areas that they carry."""
    carrier = _several(deck, ref) if (ref := o.get("REF NODE", o.get("REFNODE", ""))) else []
    if len(carrier) != 1:
        raise ValueError("it has no reference node")
    told, weights = [[word for word in row if word] for row in rows], surfaces[o["SURFACE"].upper()].weights()
    letters = {way for row in told if row for way in range(int(row[0]), int(row[-1]) + 1)} or set(range(1, 7))
    ways = "".join(map(str, sorted(letters)))
    if o.get("ORIENTATION") and not letters >= {1, 2, 3}:
        raise ValueError("its freedoms are along an orientation of its own")
    weights.pop(carrier[0], None)
    if keyword == "DISTRIBUTING":
        motions = {(node, way): weight for node, weight in weights.items() if weight for way in range(3)}
        deck.means[name] = Mean(follower=carrier[0], ways=ways, motions=motions)
        deck.carried |= dict.fromkeys(("COUPLING", keyword))
    else:
        deck.ride("COUPLING", name, carrier[0], ways, sorted(weights))


def _tie(deck: Deck, name: str, o: Mapping[str, str], slave: Surface, master: Surface) -> None:
    """Nodes of the first surface move with the faces of the second that they lie on."""
    points, faces, turning = deck.points, master.faces(), deck.turning
    if not faces or min(map(len, faces)) < 3:
        raise ValueError("its second surface is one of nodes or edges")
    held = float(real(o["POSITION TOLERANCE"])) if "POSITION TOLERANCE" in o else None
    turns = set[int]() if "NO ROTATION" in o else turning
    own = {node: points[node] for node in slave.weights()}
    sums, away, reach = tied(own, faces, points, turns.__contains__, held)
    if not sums:
        raise ValueError(f"none of its {len(own)} nodes lies within {reach:.3g} of the other surface")
    deck.equate("TIE", name, sums)
    if away:
        why = f"{away} of {len(own)} nodes lie further than {reach:.3g} from the other surface, and are not tied"
        deck.lose(f"surfaces of {name}", why)
