"""What a deck of Nastran, Abaqus or CalculiX says beside nodes and elements, by its own names and in its own units."""

import re
from collections.abc import Iterable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path

import numpy as np

from fem.mesh import files
from fem.mesh.deck_text import BASIC, Coordinates, System, deck_lines, keyword_of, real
from fem.mesh.description import SEAM
from fem.mesh.files import MeshFile, cards, own_property
from geometry.errors import BadInput
from geometry.frames import Array

ALIKE = 1e-6
"""Sine of the angle of two directions, and relative difference of two sections, that are the same to a deck's digits."""

ISOTROPIC = 0.05
"""Relative difference of a shear modulus from what E and NU make of it, above which bars twist otherwise; handbooks round."""

TRANSLATIONS, ALL = frozenset("123"), frozenset("123456")


@dataclass(frozen=True, kw_only=True)
class Elastic:
    """A material as the deck has it: modulus, Poisson's ratio and density in its own units, and its loss factor; where it has
    fibres the modulus is along them, `across` is that across, and `shear` is of 12, and of 13 and 23 where that gives."""

    modulus: float
    poisson_ratio: float
    density: float
    loss_factor: float = 0.0
    across: float = 0.0
    shear: tuple[float, ...] = ()


@dataclass(frozen=True, kw_only=True)
class Property:
    """What elements of a group are made of, in the deck's own units.

    Attributes
    ----------
    material : its name or number
    thickness : of shells, else 0
    section : keys of a beam's or rod's section with their values, none of others
    z_axis : direction of the section's height; none where the elements state it, or nothing does
    layers : material, thickness and angle [degrees] from the `x_axis` of each, from the lower face up; `offset` of their middle
    neutral_axis, shear : as in `fem.mesh.description.Profile`
    added : mass of no stiffness per area of shells or length of beams
    loss_factor : in place of that of the material, where it is not 0
    """

    material: str
    thickness: float = 0.0
    section: Mapping[str, float] = field(default_factory=dict)
    z_axis: tuple[float, ...] = ()
    neutral_axis: tuple[float, ...] = ()
    shear: tuple[float, ...] = ()
    layers: tuple[tuple[str, float, float], ...] = ()
    x_axis: tuple[float, ...] = ()
    offset: float = 0.0
    added: float = 0.0
    loss_factor: float = 0.0

    @property
    def across(self) -> float:
        """Thickness, or area of the section; 0 of solids."""
        s = self.section
        if "width" in s:
            return s["width"] * s["height"]
        if "outer_diameter" in s:
            return float(np.pi / 4 * (s["outer_diameter"] ** 2 - s["inner_diameter"] ** 2))
        return s.get("area", self.thickness)


@dataclass(frozen=True, eq=False, kw_only=True)
class Rider:
    """A mass at a node, in the deck's own units: its centre of gravity (3,) from there, and its inertia (3, 3) about that."""

    mass: float
    cog: Array = field(default_factory=lambda: np.zeros(3))
    moments: Array = field(default_factory=lambda: np.zeros((3, 3)))


@dataclass(kw_only=True)
class Deck:
    """What is found in a deck, by its own names and numbers and in its own units.

    Attributes
    ----------
    mesh : its nodes, elements and groups
    materials, properties : by name or number, properties by group of elements
    masses : node and what it carries, by name
    links : (independent node, groups and numbers of nodes that ride on it) by name, and the directions in which they do by
        `riding`, all where it has none
    means : (node that follows, numbers of the nodes whose mean motion it has) by name; by `weights` with its (shares, none
        where all are alike, and whether their rotations count)
    springs : ((node,) or (node, other), six stiffnesses) by name
    held : letters of "123456" that each node is held in, along its `axes` where it has some of its own (3, 3), as rows
    carried : cards that are carried over
    lost : sentences on what is not
    weight : what masses and densities are multiplied with (PARAM, WTMASS)
    loss_factor : of the whole structure beside those of its materials (PARAM, G)
    """

    mesh: MeshFile
    materials: dict[str, Elastic] = field(default_factory=dict)
    properties: dict[str, Property] = field(default_factory=dict)
    masses: dict[str, tuple[int, Rider]] = field(default_factory=dict)
    links: dict[str, tuple[int, list[int | str]]] = field(default_factory=dict)
    riding: dict[str, str] = field(default_factory=dict)
    means: dict[str, tuple[int, list[int]]] = field(default_factory=dict)
    weights: dict[str, tuple[list[float], bool]] = field(default_factory=dict)
    springs: dict[str, tuple[tuple[int, ...], Array]] = field(default_factory=dict)
    held: dict[int, set[str]] = field(default_factory=dict)
    axes: dict[int, Array] = field(default_factory=dict)
    carried: dict[str, None] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)
    weight: float = 1.0
    loss_factor: float = 0.0

    @property
    def carriers(self) -> dict[int, str]:
        """Rigid links by the nodes that carry them."""
        return {node: name for name, (node, _) in self.links.items()}

    def numbers(self, *dimensions: int) -> set[int]:
        """Of the nodes of elements of such `dimensions`."""
        own = [cells.nodes.ravel() for kind, cells in self.mesh.cells.items() if files.DIMENSION[kind] in dimensions]
        return set(self.mesh.node_tags[np.unique(np.concatenate(own))].tolist()) if own else set()

    def lose(self, what: str, why: str) -> None:
        """Note that `what` is not carried over."""
        self.lost.append(f"{what}: {why}")

    def settle(self) -> None:
        """What stands at a node that is not there is lost; what rides in all directions in which it moves rides whole."""
        there = set(self.mesh.node_tags.tolist())
        self._hold_along_the_axes_of_the_model()
        self._lose_what_is_made_of_nothing()
        nodes = {name: [node] for name, (node, *_) in (*self.masses.items(), *self.links.items())}
        nodes |= {name: [node, *others] for name, (node, others) in self.means.items()}
        nodes |= {name: list(ends) for name, (ends, _) in self.springs.items()}
        for name, own in nodes.items():
            if not own or not set(own) <= there:
                for table in (self.masses, self.links, self.means, self.springs):
                    table.pop(name, None)
                self.lose(name, "it stands at a node that is not there")
        bare = there - self.numbers(1, 2, 3) - set(self.carriers) - {n for n, _ in self.means.values()}
        bare -= {node for _, riders in self.links.values() for node in numbers_of(self.mesh, riders)}
        for name, (ends, stiffness) in list(self.springs.items()):
            acts = {str(k + 1) for k in np.flatnonzero(stiffness)}
            kept = tuple(end for end in ends if not (end in bare and acts <= self.held.get(end, set())))
            if set(kept) & bare:
                del self.springs[name]
                self.lose(name, "it ends at a node that nothing else is at, and that is not held")
            elif kept != ends:  # the other end is the ground's
                self.springs[name] = kept, stiffness
        turning = self.turning  # what does not turn need not be carried in rotation
        for name, (_, riders) in self.links.items():
            if set(self.riding[name]) >= (ALL if turning & set(numbers_of(self.mesh, riders)) else TRANSLATIONS):
                del self.riding[name]
        structural = self.numbers(1, 2, 3)
        for name, directions in list(self.riding.items()):
            if self.links[name][0] in structural:
                del self.links[name], self.riding[name]
                self.lose(name, f"it carries its nodes in {directions} alone, from a node of the structure itself")
        for name, (node, _) in list(self.means.items()):
            if node in structural or node in self.carriers:
                del self.means[name]
                self.lose(name, f"node {node} follows others, and is part of the structure itself")

    def _hold_along_the_axes_of_the_model(self) -> None:
        """Nodes that are held along axes of their own are so along those of the model that span the same, or are lost."""
        askew: list[int] = []
        for node in self.axes.keys() & self.held.keys():
            for three in ("123", "456"):
                rows = self.axes[node][[k for k, letter in enumerate(three) if letter in self.held[node]]]
                span = rows.T @ rows
                along = {three[k] for k in np.flatnonzero(np.diag(span) > 0.5)}
                if np.abs(span - np.diag(np.round(np.diag(span)))).max() > ALIKE:
                    askew, along = [*askew, node], set()
                self.held[node] = self.held[node] - set(three) | along
        if askew:
            nodes = files.joined(sorted(set(askew)))
            self.lose(f"where nodes {nodes} are held", "along axes of their own (CD, *TRANSFORM) that are not those of the model")

    def _lose_what_is_made_of_nothing(self) -> None:
        """Elements of the highest dimension without a property."""
        for kind, cells in self.mesh.cells.items():
            own = [self.mesh.groups.get(name, {}).get(kind, np.zeros(0, dtype=np.intp)) for name in self.properties]
            bare = np.delete(cells.tags, np.concatenate([np.zeros(0, dtype=np.intp), *own])).tolist()
            if bare and files.DIMENSION[kind] == max(files.DIMENSION[other] for other in self.mesh.cells):
                self.lose(f"elements {files.joined(bare, 3)}", "they have no section or property that is known here")

    def ride(self, card: str, name: str, carrier: int, components: str, riders: Sequence[int | str]) -> None:
        self.links[name], self.riding[name] = (carrier, list(riders)), components
        self.carried[card] = None

    def spread(self, name: str, fields: Sequence[str]) -> None:
        """A node that follows the mean motion of others, by their weights; by their rotations as well, or not at all."""
        f = [*fields, *6 * [""]]
        words = [text.upper() for text in f[4:] if text]
        words = words[: words.index("ALPHA")] if "ALPHA" in words else words
        words = [] if "UM" in words else words  # other freedoms than its own depend
        weights, freedoms, several = list[float](), set[str](), list[int]()
        while words:
            weight, components = real(words.pop(0)), words.pop(0) if words else ""
            count = next((k for k, word in enumerate(words) if not (word.isdigit() or word == "THRU")), len(words))
            nodes, words = _listed(words[:count], name, self), words[count:]
            several, weights = [*several, *nodes], [*weights, *len(nodes) * [weight]]
            freedoms.add("".join(sorted(components)))
        known = freedoms in ({"123"}, {"123456"}) and set(f[3]) >= TRANSLATIONS
        if not known or min(weights, default=0.0) <= 0:
            self.lose(name, "freedoms other than 123 or 123456, UM, or a weight that is not positive")
            return
        self.means[name] = int(f[2]), several
        self.weights[name] = [one / max(weights) for one in weights] if len(set(weights)) > 1 else [], freedoms == {"123456"}
        self.carried["RBE3"] = None

    def hold(self, text: str, fixed: Mapping[str, Sequence[Sequence[str]]]) -> None:
        """The set of constraints that the case control calls; the only one where it calls none."""
        called = re.findall(r"^\s*SPC\s*=\s*(\w+)", text.upper().partition("BEGIN BULK")[0], re.MULTILINE)
        chosen = [one for one in dict.fromkeys(called) if one in fixed] or list(fixed)
        if len(chosen) > 1:
            self.lose(f"SPC sets {', '.join(chosen)}", "more than one, and none that is called alone")
            return
        for components, *nodes in (row for one in chosen for row in fixed[one]):
            for node in nodes:
                self.held.setdefault(int(node), set()).update(components)

    def rod_property(self, card: str, f: Sequence[str]) -> None:
        """Of rods with an area and a stiffness in torsion, or of tubes with a diameter and a wall."""
        group, name = (own_property(f), own_property(f)) if card == "CONROD" else (f[0], f"{card} {f[0]}")
        material, size, other, fourth, fifth = f[3:8] if card == "CONROD" else f[1:6]
        area, added = real(size), real(fifth)
        if card == "PTUBE":
            wall, added = real(other) or area / 2, real(fourth)
            if real(fifth) not in (0.0, area):
                self.lose(name, "a taper")
            area = float(np.pi * wall * (area - wall))
        elif real(other):
            self.lose(name, "its stiffness in torsion")
        self.properties[group] = Property(material=material, section={"area": area}, added=added)

    def layered(self, card: str, f: Sequence[str]) -> None:
        """A laminate, of PCOMP with four fields a layer, of PCOMPG with eight; what they leave out is that of the one before."""
        name, layers = f"{card} {f[0]}", list[tuple[str, float, float]]()
        skip, step = (0, 4) if card == "PCOMP" else (1, 8)
        rows = [f[k + skip : k + skip + 4] for k in range(8, len(f) - 3, step)]
        for material, thickness, angle, *output in rows:
            if material or thickness or angle or output[0]:
                before = layers[-1] if layers else ("", 0.0, 0.0)
                layers.append((material or before[0], real(thickness) if thickness else before[1], real(angle)))
        if (word := f[7].upper()) == "SYM":
            layers += layers[::-1]
        elif word:
            self.lose(name, f"its layers are to be taken as {word}")
        whole = sum(thickness for _, thickness, _ in layers)
        offset = real(f[1]) + whole / 2 if f[1] else 0.0  # Z0 is where the lower face is
        of, nsm, loss, plies = layers[0][0] if layers else "", real(f[2]), real(f[6]), tuple(layers)
        self.properties[f[0]] = Property(material=of, thickness=whole, layers=plies, offset=offset, added=nsm, loss_factor=loss)

    def beam_property(self, card: str, f: Sequence[str]) -> None:
        name, section = f"{card} {f[0]}", dict[str, float]()
        added, neutral_axis, shear = 0.0, tuple[float, ...](), tuple[float, ...]()
        if card in ("PBAR", "PBEAM"):
            if card == "PBAR":
                (A, I1, I2, J, added), I12, (K1, K2) = map(real, f[2:7]), real(f[18]), map(real, f[16:18])
            else:
                (A, I1, I2, I12, J, added), rest = self._stations(name, f)
                K1, K2 = (real(text or "1.") for text in rest[:2])
                n = [real(text) for text in (*rest[12:14], rest[14] or rest[12], rest[15] or rest[13])]
                # The section's z is Nastran's y, and its y is -z there
                neutral_axis = -(n[1] + n[3]) / 2, (n[0] + n[2]) / 2
                if any(map(real, (*rest[2:4], *rest[8:12]))):
                    self.lose(name, "its shear relief, or a mass beside its axis")
            shear = K2, K1
            section = {"area": A, "Iy": I1, "Iz": I2, "J": J} | ({"Iyz": -I12} if I12 else {}) if I1 or I2 or J else {"area": A}
        else:
            d = [real(text) for text in f[8:12]]
            kind = f[3].upper()
            if kind == "BAR":
                section = {"width": d[0], "height": d[1]}
            elif kind == "ROD":
                section = {"outer_diameter": 2 * d[0], "inner_diameter": 0.0}
            elif kind in ("TUBE", "TUBE2"):
                section = {"outer_diameter": 2 * d[0], "inner_diameter": 2 * (d[1] if kind == "TUBE" else d[0] - d[1])}
            elif kind in ("BOX", "I", "T", "L", "CHAN", "HAT"):
                section, (up, right) = plated(kind, [real(text) for text in f[8 : 8 + _SIZES[kind]]])
                neutral_axis = (-right, up) if card == "PBEAML" else ()
                if card == "PBEAML" and kind == "HAT":
                    self.lose(name, "where a hat has its shear centre, about which it twists")
            else:
                self.lose(name, f"a section of kind {kind}")
            added = real(f[8 + _SIZES.get(kind, 0)]) if section else 0.0
            if card == "PBEAML" and f[9 + _SIZES.get(kind, 0)]:
                self.lose(name, "a taper; it is as at its first end")
        shear = tuple(one or np.inf for one in shear) if any(shear) and len(section) > 1 else ()
        off = neutral_axis if any(neutral_axis) else ()
        self.properties[f[0]] = Property(material=f[1], section=section, added=added, neutral_axis=off, shear=shear)

    def _stations(self, name: str, f: Sequence[str]) -> tuple[list[float], Sequence[str]]:
        """Of a PBEAM the means along it of area, I1, I2, I12, J and mass, and its fields behind its stations."""
        at = 8 if f[8].upper() in ("YES", "YESA", "NO") else 16
        stations = {0.0: [real(text) for text in f[2:8]]}
        while (word := f[at].upper()) in ("YES", "YESA", "NO"):
            own = [real(text) if text else first for text, first in zip(f[at + 2 : at + 8], stations[0.0], strict=True)]
            stations[real(f[at + 1])] = own
            at += 16 if word == "YES" else 8
        x = np.array(sorted(stations))
        values = np.array([stations[one] for one in x])
        if np.any(np.ptp(values, axis=0) > ALIKE * np.abs(values).max(axis=0)):
            self.lose(name, "a taper; it has the means along it")
        means = np.trapezoid(values, x, axis=0) + values[-1] * (1 - x[-1])
        return means.tolist(), f[at:]

    def beam_section(self, name: str, group: str, o: Mapping[str, str], rows: Sequence[Sequence[str]]) -> None:
        """Along its first direction, which the second row says, a rectangle has the first of its two sizes."""
        sizes = [real(text) for text in rows[0] if text]
        z_axis = tuple(real(text) for text in rows[1][:3]) if rows[1:] else (0.0, 0.0, -1.0)
        section: dict[str, float] = {}
        if any(real(o.get(way, "")) for way in ("OFFSET1", "OFFSET2")):
            self.lose(name, "how far it is off its nodes (OFFSET1, OFFSET2)")
        if o.get("SECTION", "")[:4] == "RECT":
            section = {"width": sizes[-1], "height": sizes[0]}
        elif o.get("SECTION") == "CIRC" and (len(sizes) == 1 or sizes[0] == sizes[1]):  # a radius, or CalculiX's two diameters
            section = {"outer_diameter": sizes[0] * (2 if len(sizes) == 1 else 1), "inner_diameter": 0.0}
        elif o.get("SECTION") == "PIPE":
            section = {"outer_diameter": 2 * sizes[0], "inner_diameter": 2 * (sizes[0] - sizes[1])}
        elif o.get("SECTION") == "BOX" and len(sizes) == 6 and sizes[2] == sizes[4] and sizes[3] == sizes[5]:
            section = plated("BOX", (sizes[1], sizes[0], *sizes[2:4]))[0]
        else:
            self.lose(name, f"a section of kind {o.get('SECTION', 'none')}")
        self.properties[group] = Property(material=o["MATERIAL"], section=section, z_axis=z_axis)

    def boundary(self, rows: Sequence[Sequence[str]]) -> None:
        for who, *what in rows:
            word, last, size, *_ = (*what, "", "", "")
            first = word if word.isdigit() else ""
            letters = _HELD_AS.get(word.upper(), "".join(map(str, range(int(first or 1), min(int(last or first or 0), 6) + 1))))
            if real(size):
                self.lose(f"*BOUNDARY {who}", "held away from where it stands")
            for node in numbers_of(self.mesh, [int(who) if who.isdigit() else who]):
                self.held.setdefault(node, set()).update(letters)

    @property
    def turning(self) -> set[int]:
        """Numbers of the nodes that turn: of shells, and of beams but not of rods."""
        found = self.numbers(2)
        for kind in files.BEAMS:
            if kind in self.mesh.cells:
                bends = np.ones(len(self.mesh.cells[kind].tags), dtype=bool)
                for name, one in self.properties.items():
                    if set(one.section) == {"area"}:
                        bends[self.mesh.groups.get(name, {}).get(kind, [])] = False
                found |= set(self.mesh.node_tags[np.unique(self.mesh.cells[kind].nodes[bends])].tolist())
        return found

    def supports(self) -> dict[str, list[int | str]]:
        """What is held, by the directions, such as "13", in which it is; under "" what is held in all in which it could move."""
        carriers, found = set(self.carriers), dict[str, set[int]]()
        turning = self.turning | carriers
        for node in (self.numbers(1, 2, 3) | carriers) & set(self.held):
            able = ALL if node in turning else TRANSLATIONS
            if held := self.held[node] & able:
                found.setdefault("" if held == able else "".join(sorted(held)), set()).add(node)
        return {directions: self._named(nodes) for directions, nodes in found.items()}

    def clamps(self, held: Sequence[int | str]) -> dict[str, list[int | str]]:
        """Nodes of each foot that is `held` altogether, by the name of a link that holds it, so that it may give.

        A foot are nodes that elements join. None where one is a pin, which does not turn, or where they are more than a seam has.
        """
        from scipy.sparse import coo_array
        from scipy.sparse.csgraph import connected_components

        loose = numbers_of(self.mesh, [one for one in held if one not in self.links])
        nodes = np.flatnonzero(np.isin(self.mesh.node_tags, loose))
        pairs, count = [np.zeros((0, 2), dtype=np.intp)], len(self.mesh.node_tags)
        for cells in self.mesh.cells.values() if len(nodes) else ():
            element, which = np.nonzero(np.isin(cells.nodes, nodes))
            pairs.append(np.column_stack([cells.nodes[element, which], count + element]))
            count += len(cells.nodes)
        every = np.vstack(pairs)
        foot = connected_components(coo_array((np.ones(len(every)), every.T), shape=(count, count)), directed=False)[1]
        feet = [self.mesh.node_tags[nodes[foot[nodes] == k]].tolist() for k in np.unique(foot[nodes])]
        turning = self.turning
        pins = [own for own in feet if len(own) == 1 and own[0] not in turning]
        if pins or not 0 < len(feet) <= SEAM:
            return {}
        return {f"clamp-{k}" if len(feet) > 1 else "clamp": self._named(set(own)) for k, own in enumerate(feet, start=1)}

    def _named(self, nodes: set[int]) -> list[int | str]:
        """`nodes` by the links that they carry and the groups that they are, else by their numbers."""
        names: list[int | str] = [name for node, name in self.carriers.items() if node in nodes]
        left = nodes - set(self.carriers)
        for name in sorted(self.mesh.node_groups, key=lambda name: -len(self.mesh.node_groups[name])):
            own = set(self.mesh.node_tags[self.mesh.node_groups[name]].tolist())
            if own and own <= nodes and own & left:
                names.append(name)
                left -= own
        return [*names, *sorted(left)]


_SIZES = {"BAR": 2, "ROD": 1, "TUBE": 2, "TUBE2": 2, **dict.fromkeys(("BOX", "T", "L", "CHAN", "HAT"), 4), "I": 6}
"""How many sizes a section of each kind has, behind which stands a mass per length."""


def plated(kind: str, sizes: Sequence[float]) -> tuple[dict[str, float], tuple[float, float]]:
    """Section of Nastran's `kind` of plates, and where along its y and z its middle is from the shear centre (0 of a hat).

    Torsion of thin strips (Saint-Venant), of a box after Bredt; shear centres of thin walls (S. P. Timoshenko, Strength of
    Materials, part II).

    Raises
    ------
    ValueError : plates that are no such section.
    """
    a, b, s, t, *others = sizes
    y, z = 0.0, 0.0  # of the shear centre; of every plate its middle along y and z, its height and its width
    plates = [(b / 2, t / 2, b - 2 * s, t), (b / 2, a - t / 2, b - 2 * s, t), (s / 2, a / 2, s, a), (b - s / 2, a / 2, s, a)]
    if kind == "BOX":
        y, z = b / 2, a / 2
    elif kind == "I":
        below, top = others
        y = below / 2 + (a - (below + top) / 2) * top * s**3 / (top * s**3 + below * b**3)
        plates = [(below / 2, 0, below, b), (a - top / 2, 0, top, s), ((a + below - top) / 2, 0, a - below - top, t)]
    elif kind == "T":
        y, plates = b - s / 2, [(b - s / 2, 0, s, a), ((b - s) / 2, 0, b - s, t)]
    elif kind == "L":
        y, z, plates = s / 2, t / 2, [(s / 2, a / 2, s, a), ((b + s) / 2, t / 2, b - s, t)]
    elif kind == "CHAN":
        y, z = b / 2, s / 2 - 3 * t * (a - s / 2) ** 2 / (6 * t * (a - s / 2) + s * (b - t))
        plates = [(t / 2, a / 2, t, a), (b - t / 2, a / 2, t, a), (b / 2, s / 2, b - 2 * t, s)]
    else:
        wall, brim = (s - b) / 2, (s + t) / 2
        plates = [(a - b / 2, 0, b, s), *(((a - b) / 2, at, a - b, b) for at in (-wall, wall))]
        plates += [(b / 2, at, b, t) for at in (-brim, brim)]
    up, right, height, width = np.array(plates).T
    if not np.all((height > 0) & (width > 0)) or (kind == "BOX" and 2 * t >= a):
        raise ValueError(f"{', '.join(f'{one:g}' for one in sizes)} make no {kind}")
    area = height * width
    high, far = float(np.average(up, weights=area)), float(np.average(right, weights=area))
    Iy, Iz = area @ ((up - high) ** 2 + height**2 / 12), area @ ((right - far) ** 2 + width**2 / 12)
    J = np.maximum(height, width) @ np.minimum(height, width) ** 3 / 3
    if kind == "BOX":
        J = 2 * ((a - t) * (b - s)) ** 2 / ((a - t) / s + (b - s) / t)
    product = area @ ((up - high) * (right - far))  # its z is Nastran's y, and its y is -z there
    sums = {"area": area.sum(), "Iy": Iy, "Iz": Iz, "J": J} | ({"Iyz": -product} if abs(product) > ALIKE * Iy else {})
    y, z = (0.0 if kind == "HAT" or abs(one) <= ALIKE * max(a, b) else one for one in (high - y, far - z))
    return {name: float(one) for name, one in sums.items()}, (y, z)


def read(path: Path) -> Deck:
    """The deck in `path`.

    Raises
    ------
    BadInput : it cannot be read, or it has no elements.
    """
    mesh = files.read(path, lambda card: True)
    try:
        deck = _abaqus(path, mesh) if mesh.coordinates is None else _nastran(path, mesh, mesh.coordinates)
    except (ValueError, IndexError, KeyError, ArithmeticError) as error:
        problem = f"a record of it cannot be read: {type(error).__name__}, {error}"
        raise BadInput(source=str(path), problem=problem, remedy="Check the deck; it may be cut short or damaged") from None
    deck.settle()
    return deck


# Nastran: bulk data. Cards of one property have its number; fields behind the card's name are numbered from 0.

_IDLE = re.compile(
    r"PARAM|EIG\w*|LOAD\w*|FORCE\d?|MOMENT\d?|GRAV|RFORCE|PLOAD\w*|TEMP\w*|[DRT]LOAD\d?|DAREA|DPHASE|DELAY|FREQ\d?|TSTEP\w*|TABLE\w*"
    r"|TABDMP\d|TABRND\w*|SUPORT\d?|[ABCQ]SET\d?|OMIT\d?|SPOINT|CORD[12][CRS]|BAROR|BEAMOR|MATT\d|SET\d|SE[ABCQU]?SET\d?|SEELT|NLPARM|ECHOO\w+|PLOTEL\d?|USET\d?"
    r"|DESVAR|DRESP\d|DV\w+|DCONSTR|DOPTPRM|MKAERO\d|RANDPS|DTI|DMI|SEQGP|CSUPER|ACCEL\d?|DEFORM|SPCD|GRDSET"
)
"""Cards that neither weigh nor hold nor join in a linear structure, or are read with the mesh."""


def _nastran(path: Path, mesh: MeshFile, where: Coordinates) -> Deck:
    deck, fixed = Deck(mesh=mesh), dict[str, list[list[str]]]()
    whole = "\n".join(line.text for line in deck_lines(path))
    point = dict(zip(mesh.node_tags.tolist(), mesh.points, strict=True))
    springs, laws = list[list[str]](), dict[str, list[str]]()
    shells, together, thick = dict[str, list[str]](), dict[str, list[str]](), dict[str, None]()
    for card, *own in cards(path):
        f = [*own, *(40 * [""])]
        name = f"{card} {f[0]}"
        if card == "MAT1":
            E, G, nu = (real(f[k]) for k in (1, 2, 3))
            nu = nu if f[3] or not G else E / (2 * G) - 1
            modulus = E or 2 * G * (1 + nu)
            if E and G and abs(2 * G * (1 + nu) / E - 1) > ISOTROPIC:
                deck.lose(name, f"its G of {G:g}, which E and NU make {E / (2 + 2 * nu):.4g}; that is taken")
            deck.materials[f[0]] = Elastic(modulus=modulus, poisson_ratio=nu, density=real(f[4]), loss_factor=real(f[7]))
        elif card == "PARAM" and f[0].upper() == "WTMASS":
            deck.weight = real(f[1])
        elif card == "PARAM" and f[0].upper() == "G":
            deck.loss_factor = real(f[1])
        elif card == "PSOLID":
            deck.properties[f[0]] = Property(material=f[1])
        elif card == "PSHELL":
            shells[f[0]] = f
        elif card in ("PBAR", "PBEAM", "PBARL", "PBEAML"):
            deck.beam_property(card, f)
        elif card in ("PROD", "PTUBE", "CONROD"):
            deck.rod_property(card, f)
        elif card == "MAT8":
            shear = tuple(map(real, f[4:7] if real(f[5]) and real(f[6]) else f[4:5]))
            E1, E2, nu, rho, loss = (real(f[k]) for k in (1, 2, 3, 7, 16))
            deck.materials[f[0]] = Elastic(modulus=E1, across=E2, poisson_ratio=nu, shear=shear, density=rho, loss_factor=loss)
        elif card in ("PCOMP", "PCOMPG"):
            deck.layered(card, own)
        elif card in ("PBCOMP", "PLSOLID", "MAT2", "MAT9", "MAT10", "PBMSECT"):
            deck.lose(name, "no material or property that is known here; state the part by hand")
        elif card in ("CQUAD4", "CTRIA3") and any(f[10:14]):
            thick[f[1]] = None
        elif card == "CONM2":
            node, number = int(f[1]), f[2] or BASIC
            xx, yx, yy, zx, zy, zz = (real(f[k]) for k in range(8, 14))
            inertia, aside = np.array([[xx, -yx, -zx], [-yx, yy, -zy], [-zx, -zy, zz]]), np.array([real(text) for text in f[4:7]])
            if number == "-1":  # where its centre of gravity is, in basic coordinates
                aside = aside - point.get(node, aside)
            elif node in point:
                turned = where.system(number).directions(point[node])
                inertia, aside = turned.T @ inertia @ turned, aside @ turned
            deck.masses[name] = node, Rider(mass=real(f[3]), cog=aside, moments=inertia)
            deck.carried[card] = None
        elif card == "RBE2":
            riders = _listed(f[3:], name, deck)
            if {*f[2]} != ALL and any(where.freedoms(node) is not None for node in riders if node in point):
                deck.lose(name, f"in {f[2]} along the freedoms of nodes that have axes of their own (CD)")
            else:
                deck.ride(card, name, int(f[1]), f[2], riders)
        elif card == "RBE3":
            deck.spread(name, own)
        elif card in ("CELAS1", "CELAS2", "CBUSH"):
            stated = card == "CBUSH" and bool(f[7])  # in a system of its own; else along the freedoms of its nodes
            ends = [int(text) for text in (f[2:4] if card == "CBUSH" else f[2:6:2]) if text.isdigit()]
            if not stated and any(where.freedoms(end) is not None for end in ends if end in point):
                deck.lose(name, "along the freedoms of a node that has axes of its own (CD)")
            else:
                springs.append([card, *f])
        elif card in ("PELAS", "PBUSH"):
            laws[f"{card} {f[0]}"] = f
            laws |= {f"{card} {f[4]}": f[4:]} if card == "PELAS" and f[4] else {}
        elif card == "SPC1":
            fixed.setdefault(f[0], []).append([f[1], *map(str, _listed(f[2:], name, deck))])
        elif card == "SPC":
            fixed.setdefault(f[0], []).extend([f[k + 1], f[k]] for k in (1, 4) if f[k])
            if any(real(f[k]) for k in (3, 6)):
                deck.lose(name, "held away from where it stands")
        elif card == "SPCADD":
            together[f[0]] = [text for text in f[1:] if text]
        elif card == "GRID":
            if letters := where.grid(int(f[0]))[6].strip("0"):
                deck.held.setdefault(int(f[0]), set()).update(letters)
        elif not (card in files.NASTRAN or _IDLE.fullmatch(card)):
            deck.lose(name, "a card that is not known here")
    for number in thick:
        deck.lose(f"property {number}", "some of its shells have thicknesses of their own")
    for number, f in shells.items():
        bending, ratio, t, of, soft = f[3], real(f[4]) or 1.0, real(f[2]), deck.materials.get(f[1]), deck.materials.get(f[5])
        layers: tuple[tuple[str, float, float], ...] = ((f[1], t, 0.0),) if of and of.shear else ()
        # Faces apart, as 12 I / t³ says, on a core that shears
        if bending == f[1] and ratio > 1 + ALIKE and t > 0 and not layers:
            apart = t / 2 * float(np.sqrt((4 * ratio - 1) / 3))
            alike = soft.modulus / (2 + 2 * soft.poisson_ratio) if soft and not soft.shear else 0.0
            across = soft.shear[1:] if soft and soft.shear else (alike, alike)
            stiff = tuple(G * real(f[6] or ".833333") * t * (apart - t / 2) / apart**2 for G in across)
            core, stiff = f"core of PSHELL {number}", (0.0, *(stiff if all(stiff) else ()))
            if f[5] and not soft:
                deck.lose(f"PSHELL {number}", f"no material {f[5]} of its core is known here")
            deck.materials[core] = Elastic(modulus=0.0, poisson_ratio=0.0, density=0.0, shear=stiff)
            layers = ((f[1], t / 2, 0.0), (core, apart - t / 2, 0.0), (f[1], t / 2, 0.0))
        elif bending != f[1] or abs(ratio - 1) > ALIKE:
            deck.lose(f"PSHELL {number}", "it bends otherwise than its thickness says, or not at all")
        t = sum(thickness for _, thickness, _ in layers) or t
        deck.properties[number] = Property(material=f[1], thickness=t, layers=layers, added=real(f[7]))
    for card, *f in springs:
        _spring(deck, card, f, laws, point)
    if not re.search(r"^\s*ENDDATA", whole, re.IGNORECASE | re.MULTILINE):
        deck.lose("the end", "there is no ENDDATA, and the deck may be cut short")
    deck.hold(whole, fixed | {sid: [row for one in several for row in fixed.get(one, [])] for sid, several in together.items()})
    deck.axes = {node: axes for node in deck.held if node in point and (axes := where.freedoms(node)) is not None}
    return deck


def _listed(fields: Sequence[str], name: str, deck: Deck) -> list[int]:
    """Numbers, THRU among them, up to the first field that is none."""
    found: list[int] = []
    through = False
    for text in fields:
        if text.upper() == "THRU":
            through = True
        elif text.isdigit():
            tags = deck.mesh.node_tags  # a range names those that are there
            found += tags[(tags > found[-1]) & (tags <= int(text))].tolist() if through and found else [int(text)]
            through = False
        elif text and real(text):
            deck.lose(name, f"{text} behind its nodes")
    return found


def _spring(deck: Deck, card: str, f: Sequence[str], laws: Mapping[str, Sequence[str]], point: Mapping[int, Array]) -> None:
    name = f"{card} {f[0]}"
    if card == "CBUSH":
        law, ends = laws.get(f"PBUSH {f[1] or f[0]}"), [int(text) for text in f[2:4] if text.isdigit() and int(text)]
        apart = len(ends) == 2 and bool(np.any(point[ends[0]] != point[ends[1]]))
        six = np.array([real(text) for text in law[2:8]] if law else [])
        turned = f[7] != "0" and (f[7] or apart or any(f[4:7])) and max(len(set(six[:3])), len(set(six[3:]))) > 1
        if law is None or law[1].upper() != "K" or turned:
            deck.lose(name, "no PBUSH with K, or in axes of its own")
            return
    else:
        stiffness = real(f[1] if card == "CELAS2" else laws.get(f"PELAS {f[1] or f[0]}", ("", ""))[1])
        pairs = [(int(f[k]), f[k + 1]) for k in (2, 4) if f[k].isdigit() and int(f[k])]
        ends, along = [node for node, _ in pairs], {component for _, component in pairs}
        if not stiffness or len(along) != 1 or not along <= set("123456"):
            deck.lose(name, "it joins two different motions, or its stiffness is not here")
            return
        six = np.zeros(6)
        six[int(along.pop()) - 1] = stiffness
    deck.springs[name] = tuple(ends), six
    deck.carried[card] = None


def _called(mesh: MeshFile, name: str) -> str:
    """The group that a deck means, to whom capitals are no different from small letters."""
    return next((own for own in mesh.names if own.upper() == name.upper()), name)


def numbers_of(mesh: MeshFile, named: Iterable[int | str]) -> list[int]:
    """Numbers of the nodes of groups, and numbers as they are."""
    return [
        node
        for one in named
        for node in ([one] if isinstance(one, int) else mesh.node_tags[mesh.nodes_of(_called(mesh, one))].tolist())
    ]


# Abaqus and CalculiX: keywords with rows of data, of the model and of its first step.

FIBRES = {"LAMINA": range(6), "ENGINEERING CONSTANTS": (0, 1, 3, 6, 7, 8)}
"""Where moduli along and across fibres, Poisson's ratio and shear moduli 12, 13 and 23 stand, by the type of elasticity."""

_HELD_AS = {"ENCASTRE": "123456", "PINNED": "123", "XSYMM": "156", "YSYMM": "246", "ZSYMM": "345"}


def _blocks(path: Path) -> Iterator[tuple[str, dict[str, str], list[list[str]]]]:
    """Keyword, options and rows of fields, to the end of the first step; nodes and elements come without their rows."""
    keyword, options, rows, steps = "", dict[str, str](), list[list[str]](), 0
    for line in deck_lines(path):
        text = line.text.strip()
        if not text.startswith("*"):
            meshed = keyword == "ELEMENT" and options.get("TYPE", "").upper() not in files.LOOSE
            heavy = meshed or keyword in ("NODE", "NSET", "ELSET")
            rows += [] if heavy else [[one.strip() for one in text.split(",")]]
            continue
        if keyword:
            yield keyword, options, rows
        (keyword, options), rows = keyword_of(text), []
        steps += keyword == "STEP"
        if steps > 1:
            return
    yield keyword, options, rows


def _abaqus(path: Path, mesh: MeshFile) -> Deck:
    deck, material, open_step = Deck(mesh=mesh), "", False
    elastic, dense, losses = dict[str, list[str]](), dict[str, float](), dict[str, float]()
    point = dict(zip(mesh.node_tags.tolist(), mesh.points, strict=True))
    loose, fibres, oriented = dict[str, list[tuple[str, list[int]]]](), dict[str, list[float]](), dict[str, str]()
    # Carriers of rigid bodies by the nodes whose displacements are their rotations; and orientations
    turning, ways = dict[int, int](), dict[str, tuple[tuple[float, ...], float]]()
    for keyword, options, rows in _blocks(path):
        o, first = {key: value.upper() for key, value in options.items()}, (rows or [[""]])[0]
        group = _called(mesh, options.get("ELSET", ""))
        name = f"*{keyword} {options.get('ELSET', options.get('NAME', options.get('NSET', '')))}".strip()
        if keyword == "MATERIAL":
            material = o["NAME"]
        elif keyword == "ELASTIC":
            several = [text for row in rows for text in [*row, *8 * [""]][:8]]
            kind = o.get("TYPE", "ISO")
            if kind in FIBRES:
                fibres[material] = [real(several[k]) for k in FIBRES[kind]]
            elif kind not in ("ISO", "ISOTROPIC"):
                deck.lose(f"*MATERIAL {material}", "it is not isotropic; state the part by hand")
            elastic[material] = first
            if len(rows) > 1 and kind not in FIBRES:
                deck.lose(f"*ELASTIC of {material}", "it changes with temperature; the first row is taken")
        elif keyword == "DENSITY":
            dense[material] = real(first[0])
        elif keyword == "DAMPING" and "STRUCTURAL" in o:
            losses[material] = real(o["STRUCTURAL"])
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
            deck.beam_section(name, group, o, rows)
        elif keyword == "ELEMENT" and o.get("TYPE") in files.LOOSE:
            loose.setdefault(o.get("ELSET", ""), []).extend((o["TYPE"], [int(text) for text in row if text]) for row in rows)
        elif keyword == "MASS":
            for _, (tag, node) in loose.get(o["ELSET"], []):
                deck.masses[f"{keyword} {options['ELSET']} {tag}"] = node, Rider(mass=real(first[0]))
            deck.carried[keyword] = None
        elif keyword == "SPRING":
            _abaqus_spring(deck, name, loose.get(o["ELSET"], []), rows, point)
        elif keyword == "RIGID BODY":
            riders = _called(mesh, options.get("NSET", options.get("ELSET", options.get("TIE NSET", ""))))
            carrier = o.get("REF NODE", o.get("REFNODE", ""))
            there = numbers_of(mesh, [int(carrier) if carrier.isdigit() else carrier]) if carrier else []
            if len(there) == 1:
                turning |= {int(one): there[0] for key, one in o.items() if key in ("ROT NODE", "ROTNODE")}
                deck.ride(keyword, f"{keyword} {riders}", there[0], "123456", [riders])
            else:
                deck.lose(name, "it has no reference node")
        elif keyword == "BOUNDARY":
            deck.boundary(rows)
        elif keyword == "TRANSFORM" and (kind := o.get("TYPE", "R")) == "S":
            deck.lose(name, "its axes are spherical")
        elif keyword == "TRANSFORM":  # by points of its first axis and of the plane of the first two, or of a cylinder's axis
            a, b = np.array([real(text) for text in [*first, *6 * [""]][:6]]).reshape(2, 3)
            z, to = (b - a, np.eye(3)[np.argmin(np.abs(b - a))]) if kind == "C" else (np.cross(a, b), a)
            turned = System.spanned(kind, a, z, to)
            deck.axes |= {node: turned.directions(point[node]) for node in numbers_of(mesh, [options["NSET"]]) if node in point}
        elif keyword in ("STEP", "END STEP"):
            open_step = keyword == "STEP"
        elif files.carries(keyword):
            deck.lose(name, "a keyword that is not known here")
    for node, ref in turning.items():
        deck.held.setdefault(ref, set()).update("456"[int(letter) - 1] for letter in deck.held.pop(node, set()) & TRANSLATIONS)
    for name in [name for name, (ends, _) in deck.springs.items() if set(ends) & set(deck.axes)]:
        del deck.springs[name]
        deck.lose(f"*{name}", "it acts along axes of its nodes (*TRANSFORM)")
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


def _abaqus_spring(
    deck: Deck, name: str, elements: Sequence[tuple[str, list[int]]], rows: Sequence[Sequence[str]], point: Mapping[int, Array]
) -> None:
    """Grounded in one freedom, between two nodes in the same one, or along an axis from one to the other."""
    for kind, (tag, *ends) in elements:
        if kind == "SPRINGA":
            line = point[ends[1]] - point[ends[0]]
            axis = np.flatnonzero(np.abs(line) > ALIKE * np.linalg.norm(line))
            along, law = [int(axis[0]) + 1] if len(axis) == 1 else [], rows
        else:
            along, law = sorted({int(text) for text in rows[0] if text}), rows[1:]
        if len(along) != 1 or len(law) != 1:
            deck.lose(f"{name} {tag}", "not along an axis, not linear, or between two different motions")
            continue
        six = np.zeros(6)
        six[along[0] - 1] = real(law[0][0])
        deck.springs[f"{name.lstrip('*')} {tag}"] = tuple(ends), six
        deck.carried["SPRING"] = None
