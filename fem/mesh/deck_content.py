"""What a deck of Nastran, Abaqus or CalculiX says beside nodes and elements, by its own names and in its own units."""

import re
from collections import Counter
from collections.abc import Callable, Collection, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from pathlib import Path

import numpy as np

from fem.beam.elements import SIZES, plated
from fem.mesh import constraints, files
from fem.mesh.constraints import Motion, Sum, Term
from fem.mesh.deck_text import BASIC, Coordinates, Points, deck_lines, real
from fem.mesh.files import MeshFile, cards, numbers_of, own_property
from geometry.frames import Array, axes_along
from geometry.inertia import Inertia

ALIKE = 1e-6
"""Sine of the angle of two directions, and relative difference of two sections, that are the same to a deck's digits."""

ISOTROPIC = 0.05
"""Relative difference of a shear modulus from what E and NU make of it, above which bars twist otherwise; handbooks round."""

TRANSLATIONS, TURNS, ALL = frozenset("123"), frozenset("456"), frozenset("123456")

OF_FOUR: Mapping[str, tuple[str, Callable[..., list[float]]]] = {
    "I1": ("I", lambda a, b, c, d: [d, a + b, a + b, b, (d - c) / 2, (d - c) / 2]),
    "CHAN1": ("CHAN", lambda a, b, c, d: [a + b, d, b, (d - c) / 2]),
    "T2": ("T", lambda a, b, c, d: [a, b, c, d]),
}
"""Sections of Nastran that are others by other sizes, or upside down."""

Row = Sequence[str]
"""Fields of a card, or some of them."""


@dataclass(frozen=True, kw_only=True)
class Elastic:
    """A material as the deck has it: modulus, Poisson's ratio and density in its own units, and its loss factor; where it has
    fibres the modulus is along them, `across` is that across, and `shear` is of 12, and of 13 and 23 where that gives. None is
    `equivalent` that a card states."""

    modulus: float
    poisson_ratio: float
    density: float
    loss_factor: float = 0.0
    across: float = 0.0
    shear: tuple[float, ...] = ()
    equivalent: bool = False

    @property
    def shears(self) -> tuple[float, ...]:
        """Shear moduli 12, 13 and 23, the last two where they are known."""
        return self.shear or 3 * (self.modulus / (2 + 2 * self.poisson_ratio),)

    def resembles(self, other: "Elastic") -> bool:
        """Whether they differ by one factor in their plane."""
        moduli = np.array([(one.modulus, one.across, one.shears[0], one.poisson_ratio * one.modulus) for one in (self, other)])
        return bool(np.linalg.matrix_rank(moduli, tol=ALIKE * moduli.max()) < 2)


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
class DeckSpring:
    """Six stiffnesses between the nodes `ends`, or from one to the ground, along its `axes` (3, 3), `about` a point (3,) that
    both reach by rigid arms, where it has those; `loss_factor` its own."""

    ends: tuple[int, ...]
    stiffness: Array
    axes: Array | None = None
    about: Array | None = None
    loss_factor: float = 0.0

    @property
    def acting(self) -> Array:
        """How stiff (6,) it may be along the axes of the model; rotations, too, where arms reach it."""
        found = np.abs(np.kron(np.eye(2), np.eye(3) if self.axes is None else self.axes).T) @ self.stiffness
        return found if self.about is None else np.ones(6)


@dataclass(frozen=True, eq=False, kw_only=True)
class Mean:
    """A node that follows in `ways` the mean of the `motions` of others, by their weights."""

    follower: int
    ways: str
    motions: Mapping[Motion, float]

    @property
    def shares(self) -> dict[int, float]:
        """Weight of each node by its number, the first one's in all its motions."""
        found: dict[int, float] = {}
        for (node, _), weight in self.motions.items():
            found.setdefault(node, weight)
        return found

    @property
    def rotations(self) -> bool:
        return any(way > 2 for _, way in self.motions)

    @property
    def plain(self) -> bool:
        """Whether whole translations, or whole motions, of others move it, each by one positive weight."""
        shares, count = self.shares, 6 if self.rotations else 3
        whole = self.motions == {(node, way): weight for node, weight in shares.items() for way in range(count)}
        return whole and min(shares.values(), default=0.0) > 0 and set(self.ways) >= TRANSLATIONS


@dataclass(kw_only=True)
class Deck:
    """What is found in a deck, by its own names and numbers and in its own units.

    Attributes
    ----------
    mesh : its nodes, elements and groups
    materials, properties : by name or number, properties by group of elements
    weighed : matrices (6, 6) of what weighs at a node, along the axes of the model, by names of cards
    masses : node and the body at it, from there, by name; once all is settled
    links : (independent node, groups and numbers of nodes that ride on it) by name, and the directions in which they do by
        `riding`, all where it has none
    means : nodes that follow the mean motion of others, by name
    equations : sums of motions that are zero, along the axes of their nodes until they are settled, by the name of what has them
    springs : by name
    held : letters of "123456" that each node is held in, along its `axes` where it has some of its own (3, 3), as rows
    carried : cards that are carried over
    lost : sentences on what is not
    weight : what masses and densities are multiplied with (PARAM, WTMASS)
    loss_factor : of the whole structure beside those of its materials (PARAM, G)
    loose : numbers of nodes at no element that move by themselves: they are tied to others, or hang on springs
    """

    mesh: MeshFile
    materials: dict[str, Elastic] = field(default_factory=dict)
    properties: dict[str, Property] = field(default_factory=dict)
    weighed: dict[int, dict[str, Array]] = field(default_factory=dict)
    masses: dict[str, tuple[int, Inertia]] = field(default_factory=dict)
    links: dict[str, tuple[int, list[int | str]]] = field(default_factory=dict)
    riding: dict[str, str] = field(default_factory=dict)
    means: dict[str, Mean] = field(default_factory=dict)
    equations: dict[str, list[Sum]] = field(default_factory=dict)
    springs: dict[str, DeckSpring] = field(default_factory=dict)
    held: dict[int, set[str]] = field(default_factory=dict)
    axes: dict[int, Array] = field(default_factory=dict)
    carried: dict[str, None] = field(default_factory=dict)
    lost: list[str] = field(default_factory=list)
    weight: float = 1.0
    loss_factor: float = 0.0
    loose: set[int] = field(default_factory=set)

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

    @cached_property
    def points(self) -> Points:
        """Where each node is, by its number."""
        return Points(zip(self.mesh.node_tags.tolist(), self.mesh.points, strict=True))

    def settle(self) -> None:
        """What rides in all directions in which it moves rides whole; what carries over is settled with it.

        Raises
        ------
        NotThere : something stands at, joins or holds a node that is not there.
        """
        there = set(self.mesh.node_tags.tolist())
        self._hold_along_the_axes_of_the_model()
        # Elements of the highest dimension without a property
        for kind, cells in self.mesh.cells.items():
            made = [self.mesh.groups.get(name, {}).get(kind, np.zeros(0, dtype=np.intp)) for name in self.properties]
            none = np.delete(cells.tags, np.concatenate([np.zeros(0, dtype=np.intp), *made])).tolist()
            if none and files.DIMENSION[kind] == max(files.DIMENSION[other] for other in self.mesh.cells):
                self.lose(f"elements {files.joined(none, 3)}", "they have no section or property that is known here")
        self._settle_masses()
        named = [*self.weighed]
        named += [node for carrier, own in self.links.values() for node in (carrier, *numbers_of(self.mesh, own))]
        named += [node for one in self.means.values() for node in (one.follower, *one.shares)]
        named += [node for one in self.springs.values() for node in one.ends]
        named += [node for sums in self.equations.values() for one in sums for _, node, _ in one]
        named += [node for node, letters in self.held.items() if letters & ALL]  # a scalar point has none of those
        for node in named:
            _ = self.points[node]
        ways = (*self.held.values(), *self.riding.values(), *(one.ways for one in self.means.values()))
        if wrong := set().union(*ways) - ALL - {"0"}:
            raise ValueError(f"{''.join(sorted(wrong))} stands where freedoms should")
        ridden = {name: numbers_of(self.mesh, own) for name, (_, own) in self.links.items()}
        for name, own in {**ridden, **{name: list(one.motions) for name, one in self.means.items()}}.items():
            if not own:
                self.links.pop(name, None)
                self.means.pop(name, None)
                self.lose(name, "it joins no node")
        turning = self.turning  # what does not turn need not be carried in rotation
        letters = {name: self.riding[name] for name in self.links}
        for name, (_, riders) in self.links.items():
            if set(self.riding[name]) >= (ALL if turning & set(numbers_of(self.mesh, riders)) else TRANSLATIONS):
                del self.riding[name]
        means = set(self.means)
        self._settle_links()
        turns = {
            (node, int(letter) - 1): carrier
            for name, (carrier, riders) in self.links.items()
            for node in numbers_of(self.mesh, riders)
            for letter in TURNS.intersection(letters[name])
        }
        self._settle_equations(means, turns)
        structural, carried = self.numbers(1, 2, 3), {one.follower for one in self.means.values()} | self.carriers.keys()
        tied = {node for sums in self.equations.values() for one in sums for _, node, _ in one}
        tied |= {node for _, riders in self.links.values() for node in numbers_of(self.mesh, riders)}
        bare, heavy = there - structural - carried - tied, {node for node, _ in self.masses.values()}
        ends = Counter(end for one in self.springs.values() for end in one.ends)
        heavy |= {end for end, count in ends.items() if count > 1}  # from one spring to the next
        for name, one in list(self.springs.items()):
            acts = {str(k + 1) for k in np.flatnonzero(one.acting)}
            kept = tuple(end for end in one.ends if not (end in bare - heavy and acts <= self.held.get(end, set())))
            if set(kept) & bare - heavy:
                del self.springs[name]
                self.lose(name, "it ends at a node that nothing else is at, and that is not held")
            elif kept != one.ends:  # the other end is the ground's
                self.springs[name] = replace(one, ends=kept)
        self.loose = (bare & {end for one in self.springs.values() for end in one.ends}) | (tied - structural - carried)
        for name, (node, _) in list(self.masses.items()):
            if node in bare - self.loose:
                del self.masses[name]
                self.lose(name, "it stands at a node that nothing else is at")

    def _settle_links(self) -> None:
        """What rides on a node that follows others, beside another link, on axes of its own or a line: by equations."""
        structural, points, turning = self.numbers(1, 2, 3), self.points, self.turning
        riders = {name: numbers_of(self.mesh, own) for name, (_, own) in self.links.items()}
        led = {node for own in riders.values() for node in own} | {one.follower for one in self.means.values()}
        ridden, carrying = set[int](), set[int]()
        for name, (carrier, _) in list(self.links.items()):
            ways, own = self.riding.get(name), set(riders[name])
            askew = ways is not None and (carrier in structural or own & self.axes.keys())
            beside = own & ridden or carrier in carrying or (carrier in led - own and carrier not in structural)
            still = carrier in structural and turning.isdisjoint({carrier, *own})
            line = np.array([points[node] - points[carrier] for node in own]) if still else np.eye(3)
            spins = np.linalg.matrix_rank(line, tol=ALIKE * np.abs(line).max()) < 2
            if askew or beside or spins or (carrier in structural and carrier in ridden):
                following = [(node, int(way) - 1) for node in riders[name] for way in ways or "123456" if node != carrier]
                six = {(carrier, way): 1.0 for way in range(6)}
                self.equations[name] = constraints.following(points, following, six, self.axes)
                del self.links[name]
                self.riding.pop(name, None)
            else:
                ridden |= own | ({carrier} & structural)
                carrying.add(carrier)
        stated = {node for sums in self.equations.values() for one in sums for _, node, _ in one} | ridden | carrying | structural
        stated |= self.held.keys()
        several = [one.follower for one in self.means.values()]
        stated |= {node for one in self.means.values() for node in one.shares} | {n for n in several if several.count(n) > 1}
        for name, one in list(self.means.items()):
            if one.plain and one.follower not in stated:
                continue
            arm = float(np.mean([np.linalg.norm(points[node] - points[one.follower]) for node in one.shares]))
            follower = [(one.follower, int(way) - 1) for way in one.ways]
            del self.means[name]
            try:
                self.equations[name] = constraints.following(points, follower, one.motions, self.axes, arm)
            except ValueError as error:
                self.lose(name, str(error))

    def _settle_equations(self, means: Collection[str], riding: Mapping[Motion, int]) -> None:
        """Along the axes of the model. Rotations of solids follow what moves, or what they are `riding` on; none in `means`."""
        still = self.numbers(1, 2, 3) - self.turning - self.carriers.keys()
        leaning, told = set[int](), list[tuple[str, Sum]]()

        def idle(motion: Motion) -> bool:
            return motion[1] > 2 and motion[0] in still

        for name, sums in self.equations.items():
            for first, *others in sums:
                terms = sorted(self._along(*first), key=lambda term: -abs(term[0]))
                terms += [one for term in others for one in self._along(*term)]
                terms = [(factor, riding.get((node, way), node), way) for factor, node, way in terms]
                none = {of[1] for of in terms if idle(of[1:])} if name in means else set[int]()
                if name in means and idle(first[1:]):
                    continue
                leaning |= none
                held = (str(way + 1) in self.held.get(node, ()) or node in none for _, node, way in terms)
                told.append((name, tuple(of for of, fixed in zip(terms, held, strict=True) if not (fixed and idle(of[1:])))))
        left = constraints.without((one for _, one in told), idle)
        self.equations = {}
        for (name, _), one in zip(told, left, strict=True):
            self.equations.setdefault(name, []).extend([one] if one else [])
        self.equations = {name: sums for name, sums in self.equations.items() if sums}
        if leaning:
            nodes = files.joined(sorted(leaning))
            self.lose(f"rotations of nodes {nodes}", f"{len(leaning)} that are of solids, do not turn, and are to move others")

    def _along(self, factor: float, node: int, way: int) -> list[Term]:
        """A motion along the axes of its node as motions along those of the model."""
        if node not in self.axes:
            return [(factor, node, way)]
        shares = enumerate(self.axes[node][way % 3].tolist(), start=way - way % 3)
        return [(factor * share, node, k) for k, share in shares if abs(share) > ALIKE]

    def _hold_along_the_axes_of_the_model(self) -> None:
        """Nodes that are held along axes of their own are so along those of the model that span the same, else by equations."""
        for node in self.axes.keys() & self.held.keys():
            for three in ("123", "456"):
                ways = [int(letter) - 1 for letter in sorted(self.held[node] & set(three))]
                rows = self.axes[node][[way % 3 for way in ways]]
                along = np.diag(rows.T @ rows)
                if np.abs(rows.T @ rows - np.diag(np.round(along))).max() > ALIKE:
                    self.equations.setdefault("held along axes of nodes", []).extend(((1.0, node, way),) for way in ways)
                    along = np.zeros(3)
                self.held[node] = self.held[node] - set(three) | {three[k] for k in np.flatnonzero(along > 0.5)}

    def weigh(self, card: str, name: str, node: int, M: Array) -> None:
        """Note a matrix (6, 6) of mass at a node, of a card of that name."""
        if M.any():
            self.weighed.setdefault(node, {})[name] = M
        self.carried[card] = None

    def _settle_masses(self) -> None:
        """Each that is a body by itself stands alone, the others together where they are one, or turn with one."""
        for node, own in self.weighed.items():
            bodies = {name: body for name, M in own.items() if (body := _body(M)) and body.mass > 0}
            rest = [name for name in own if name not in bodies]
            left = _body(sum((own[name] for name in rest), np.zeros((6, 6))))
            if left and rest and (left.mass > 0 or (bodies and not left.mass)):
                first = next(iter(bodies), rest[0]) if not left.mass else rest[0]
                bodies[first] = bodies[first] + left if first in bodies else left
                rest = []
            why = "its mass is not above zero" if left and left.mass else "no mass is at its node"
            for name in rest:
                self.lose(name, why if left else "its mass is not alike in all directions, as that of a body is")
            self.masses |= {name: (node, body) for name, body in bodies.items()}

    def ride(self, card: str, name: str, carrier: int, components: str, riders: Sequence[int | str]) -> None:
        self.links[name], self.riding[name] = (carrier, list(riders)), components
        self.carried[card] = None

    def spread(self, name: str, fields: Sequence[str]) -> None:
        """RBE3: a node that follows the mean motion of others, by their weights; what is condensed (UM) is all one."""
        f, motions = [*fields, *6 * [""]], dict[Motion, float]()
        words = [text.upper() for text in f[4:] if text]
        words = words[: next((k for k, word in enumerate(words) if word in ("UM", "ALPHA")), len(words))]
        while words:
            weight, components = real(words.pop(0)), words.pop(0) if words else ""
            count = next((k for k, word in enumerate(words) if not (word.isdigit() or word == "THRU")), len(words))
            nodes, words = _listed(words[:count], name, self), words[count:]
            for motion in ((node, int(way) - 1) for node in nodes for way in sorted(components)):
                motions[motion] = motions.get(motion, 0.0) + weight
        self.means[name] = Mean(follower=int(f[2]), ways=f[3], motions=motions)
        self.carried["RBE3"] = None

    def bar(self, card: str, f: Sequence[str], turning: set[int]) -> None:
        """RBAR, RBAR1, RBE1 and RJOINT: a rigid body of which six motions lead and others follow, all where none are said."""
        name = f"{card} {f[0]}"
        if card == "RBE1":
            words = [text.upper() for text in f[1:] if text]
            words = words[: words.index("ALPHA")] if "ALPHA" in words else words
            ends = words[: words.index("UM")], words[words.index("UM") + 1 :]
        elif card == "RBAR":
            ends = [f[1], f[3], f[2], f[4]], [f[1], f[5], f[2], f[6]]
        else:
            ends = [f[1], "123456"], [f[2], f[3] or "123456"]
        leading, following = (_motions(one[::2], one[1::2]) for one in ends)
        following = following or [one for one in _motions(ends[0][::2], 2 * ["123456"]) if one not in leading]
        whole = {way for _, way in following} == set(range(6)) or not turning & {node for node, _ in following}
        carriers = {node for node, _ in leading}
        if len(carriers) == 1 and len(leading) == 6 and whole and carriers.isdisjoint(node for node, _ in following):
            self.ride(card, name, carriers.pop(), "123456", list(dict.fromkeys(node for node, _ in following)))
            return
        try:
            self.equate(card, name, constraints.following(self.points, following, dict.fromkeys(leading, 1.0), self.axes))
        except ValueError as error:
            self.lose(name, str(error))

    def equate(self, card: str, name: str, sums: Iterable[Sum]) -> None:
        """Note `sums` that are zero; those of terms that all are zero say nothing."""
        told = (tuple(term for term in one if term[0]) for one in sums)
        self.equations.setdefault(name, []).extend(one for one in told if one)
        self.carried[card] = None

    def chosen(self, word: str, head: str, sets: Mapping[str, list[Row]], added: Collection[str]) -> list[Row]:
        """Rows of the set of constraints, SPC or MPC by `word`, that the case control in `head` calls; the only one that no
        other has `added` where there is none."""
        called = dict.fromkeys(re.findall(rf"^\s*{word}\s*[=\s]\s*(\w+)\s*(?:\$.*)?$", head, re.MULTILINE))
        chosen = [one for one in (called or sets) if one in sets and (called or one not in added)]
        if gone := called.keys() - sets:
            self.lose(f"{word} set {', '.join(sorted(gone))}", "the case control calls it, and it is not there")
        if sets and not called and re.search(r"^\s*CEND", head, re.MULTILINE):
            self.lose(f"{word} sets {', '.join(sets)}", "the case control calls none, and Nastran leaves them out")
            return []
        if len(chosen) > 1:
            self.lose(f"{word} sets {', '.join(chosen)}", "more than one, and none that is called alone")
            return []
        return [row for one in chosen for row in sets[one]]

    def turn_spring(self, name: str) -> None:
        """A spring acts along the axes of its nodes; it is lost where these differ."""
        one = self.springs[name]
        first, *others = [self.axes.get(node, np.eye(3)) for node in one.ends]
        if any(np.abs(first - other).max() > ALIKE for other in others):
            del self.springs[name]
            self.lose(name, "its nodes have different axes of their own (CD, *TRANSFORM)")
        elif one.ends[0] in self.axes:
            self.springs[name] = replace(one, axes=first)

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

    def shell(self, f: Sequence[str]) -> None:
        """PSHELL: one layer that stretches as MID1 over T does, bends as MID2 by 12 I / T³, and shears as MID3 by TS / T."""
        name, t, key = f"PSHELL {f[0]}", real(f[2]), f[1] or f[3]
        of, bent, core = (self.materials.get(one) for one in (key, f[3], f[5]))
        ratio, shears = real(f[4]) or 1.0, [G * real(f[6] or ".833333") * 1.2 for G in (core.shears[1:] if core else ())]
        if of and bent and bent.resembles(of):
            ratio *= bent.modulus / of.modulus if of.modulus else 1.0
        elif of:
            why = "bends by a material that is unlike MID1 or not known here" if f[3] not in ("", "-1") else "does not bend"
            self.lose(name, f"it {why} (MID2), and bends as its thickness says here")
        if not f[1]:
            self.lose(name, "it has no stiffness in its plane (MID1), and has that of its bending (MID2) here")
        if f[10]:
            self.lose(name, "its bending is coupled with its stretching (MID4)")
        if of and f[5] and not core:
            self.lose(name, f"no material {f[5]} of its core is known here")
        share, layers = float(1 / np.sqrt(ratio)), tuple[tuple[str, float, float], ...]()
        own = of.shears[0] if of else 0.0
        if of and (of.shear or abs(share - 1) > ALIKE or any(abs(G - own) > ISOTROPIC * own for G in shears)):
            E1, E2, rho = (value * share for value in (of.modulus, of.across or of.modulus, of.density))
            G, key = tuple(one * share for one in (own, *(shears if all(shears) else ()))), f"{key} in {name}"
            self.materials[key] = replace(of, modulus=E1, across=E2, density=rho, shear=G, equivalent=True)
            layers = ((key, t / share, 0.0),)
        self.properties[f[0]] = Property(material=key, thickness=t / share, layers=layers, added=real(f[7]))

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
            kind = f[3].upper()
            size = SIZES.get(kind, 4)
            d = [real(text) for text in f[8 : 8 + size]]
            if kind in OF_FOUR:
                kind, d = OF_FOUR[kind][0], OF_FOUR[kind][1](*d)
            if kind == "BAR":
                section = {"width": d[0], "height": d[1]}
            elif kind == "ROD":
                section = {"outer_diameter": 2 * d[0], "inner_diameter": 0.0}
            elif kind in ("TUBE", "TUBE2"):
                section = {"outer_diameter": 2 * d[0], "inner_diameter": 2 * (d[1] if kind == "TUBE" else d[0] - d[1])}
            elif kind in ("BOX", "I", "T", "L", "CHAN", "HAT"):
                section, (up, right) = plated(kind, d)
                neutral_axis = (-right, -up if f[3].upper() == "T2" else up) if card == "PBEAML" else ()
                if card == "PBEAML" and kind == "HAT":
                    self.lose(name, "where a hat has its shear centre, about which it twists")
            else:
                self.lose(name, f"a section of kind {kind}")
            added = real(f[8 + size]) if section else 0.0
            rest = f[9 + size :]  # of stations whether there is output, where they are, sizes and a mass
            while card == "PBEAML" and any(rest[: 3 + size]):
                first = [*map(real, f[8 : 8 + size]), added]
                if any(real(text) != one for text, one in zip(rest[2:], first, strict=False) if text):
                    self.lose(name, "a taper; it is as at its first end")
                rest = rest[3 + size :]
        if len(section) > 1 and section.get("J") == 0:
            self.lose(name, "it has no stiffness in torsion (J), and twists freely")
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


# Nastran: bulk data. Cards of one property have its number; fields behind the card's name are numbered from 0.

_IDLE = re.compile(
    r"PARAM|EIG\w*|LOAD\w*|FORCE\d?|MOMENT\d?|GRAV|RFORCE|PLOAD\w*|TEMP\w*|[DRT]LOAD\d?|DAREA|DPHASE|DELAY|FREQ\d?|TSTEP\w*|TABLE\w*"
    r"|TABDMP\d|TABRND\w*|SUPORT\d?|[ABCQ]SET\d?|OMIT\d?|CORD[12][CRS]|BAROR|BEAMOR|MATT\d|SET\d|SE[ABCQU]?SET\d?|SEELT|NLPARM|ECHOO\w+|PLOTEL\d?|USET\d?"
    r"|DESVAR|DRESP\d|DV\w+|DCONSTR|DOPTPRM|MKAERO\d|RANDPS|DTI|DMI|SEQGP|CSUPER|ACCEL\d?|DEFORM|SPCD|GRDSET"
    r"|MAT[45]|MATS1|AE\w+|[CP]AERO\d|SPLINE\d|MONPNT\d|TRIM|FL\w+|GUST|BSURFS?|BCPROPS?|NLPCI|MDLPRM|TICD?|DCONADD|SLOAD|LSEQ"
)
"""Cards that neither weigh nor hold nor join in a linear structure, or are read with the mesh."""


LATE = ("CELAS1", "CELAS2", "CMASS1", "CMASS2", "CBUSH", "RBAR", "RBAR1", "RBE1", "RJOINT", "PSHELL")
"""Cards that others, wherever they stand, say more of."""

ONE_OF_A_NUMBER = re.compile(r"MAT\d+|P(SOLID|SHELL|BARL?|BEAML?|ROD|TUBE|COMPG?|BUSH|ELAS)|CONM2|RBE\d|RBAR1?|CELAS\d|CBUSH")
"""Cards of which a solver takes one of each number."""


def read_cards(path: Path, mesh: MeshFile, where: Coordinates) -> Deck:
    deck, fixed = Deck(mesh=mesh), dict[str, list[Row]]()
    whole = "\n".join(line.text.upper() for line in deck_lines(path))
    stated = dict(re.findall(r"^\s*PARAM\*?[\s,]+(WTMASS|G)[\s,]+([^\s,$]+)", whole, re.MULTILINE))  # also before bulk data
    deck.weight, deck.loss_factor = real(stated.get("WTMASS", "1.")), real(stated.get("G", ""))
    deck.axes = {node: axes for node in deck.points if (axes := where.freedoms(node)) is not None}
    late, laws, together = list[tuple[str, list[str]]](), dict[str, list[str]](), dict[str, list[str]]()
    several, seen = dict[str, list[Row]](), set[str]()
    scalar, still = {0}, {0}  # points, which are not in the mesh; 0 is the ground
    for card, *own in cards(path):
        f = [*own, *(40 * [""])]
        name = f"{card} {f[0]}"
        if ONE_OF_A_NUMBER.fullmatch(card):
            if name in seen:
                raise ValueError(f"two {card} have the number {f[0]}")
            seen.add(name)
        if card == "MAT1":
            E, G, nu = (real(f[k]) for k in (1, 2, 3))
            nu = nu if f[3] or not G else E / (2 * G) - 1
            modulus = E or 2 * G * (1 + nu)
            if E and G and abs(2 * G * (1 + nu) / E - 1) > ISOTROPIC:
                deck.lose(name, f"its G of {G:g}, which E and NU make {E / (2 + 2 * nu):.4g}; that is taken")
            deck.materials[f[0]] = Elastic(modulus=modulus, poisson_ratio=nu, density=real(f[4]), loss_factor=real(f[7]))
        elif card == "PSOLID":
            deck.properties[f[0]] = Property(material=f[1])
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
        elif card[:5] in ("CQUAD", "CTRIA") and any(f[10:14]):
            why = f"property {f[1]}: some of its shells have thicknesses of their own"
            deck.lost += [why] if why not in deck.lost else []
        elif card == "CONM2":
            node, number = int(f[1]), f[2] or BASIC
            xx, yx, yy, zx, zy, zz = (real(f[k]) for k in range(8, 14))
            inertia, aside = np.array([[xx, -yx, -zx], [-yx, yy, -zy], [-zx, -zy, zz]]), np.array([real(text) for text in f[4:7]])
            if number == "-1":  # where its centre of gravity is, in basic coordinates
                aside = aside - deck.points[node]
            else:
                turned = where.system(number).directions(deck.points[node])
                inertia, aside = turned.T @ inertia @ turned, aside @ turned
            deck.weigh(card, name, node, Inertia.from_cog(real(f[3]), aside, inertia).mass_matrix)
        elif card == "CONM1":
            R, M = np.kron(np.eye(2), where.system(f[2] or BASIC).directions(deck.points[int(f[1])])), np.zeros((6, 6))
            M[np.tril_indices(6)] = [real(text) for text in f[3:24]]
            deck.weigh(card, name, int(f[1]), R.T @ (M + np.tril(M, -1).T) @ R)
        elif card == "SPOINT":
            scalar |= {int(text) for text in f if text.isdigit()}
            scalar |= {*range(int(f[0]), int(f[2]))} if f[1].upper() == "THRU" else set()
        elif card == "RBE2":
            deck.ride(card, name, int(f[1]), f[2], _listed([text for text in f[3:] if "." not in text], name, deck))  # no ALPHA
        elif card == "RBE3":
            deck.spread(name, own)
        elif card in LATE:
            late.append((card, f))
        elif card in ("PELAS", "PMASS", "PBUSH"):
            step = {"PELAS": 4, "PMASS": 2, "PBUSH": 8}[card]
            laws |= {f"{card} {f[k]}": f[k:] for k in range(0, 8, step) if f[k]}
        elif card == "SPC1":
            fixed.setdefault(f[0], []).append([f[1], *map(str, _listed(f[2:], name, deck))])
        elif card == "SPC":
            fixed.setdefault(f[0], []).extend([f[k + 1], f[k]] for k in (1, 4) if f[k])
            if any(real(f[k]) for k in (3, 6)):
                deck.lose(name, "held away from where it stands")
        elif card == "MPC":
            several.setdefault(f[0], []).append([text for k in range(0, len(own), 8) for text in f[k + 1 : k + 7]])
        elif card in ("SPCADD", "MPCADD"):
            together[f"{card} {f[0]}"] = [text for text in f[1:] if text]
        elif card == "GRID":
            if letters := where.grid(int(f[0]))[6].strip("0"):
                deck.held.setdefault(int(f[0]), set()).update(letters)
        elif not (card in files.NASTRAN or _IDLE.fullmatch(card)):
            deck.lose(name, "a card that is not known here")
    if not re.search(r"^\s*ENDDATA", whole, re.MULTILINE):
        deck.lose("the end", "there is no ENDDATA, and the deck may be cut short")
    head, chosen = re.split(r"^\s*BEGIN\s+BULK", whole, maxsplit=1, flags=re.MULTILINE)[0], dict[str, list[Row]]()
    for word, sets in (("SPC", fixed), ("MPC", several)):
        added = {key.split()[1]: numbers for key, numbers in together.items() if key.startswith(word)}
        sets |= {sid: [row for one in numbers for row in sets.get(one, [])] for sid, numbers in added.items()}
        chosen[word] = deck.chosen(word, head, sets, set().union(*added.values()))
    scalar |= {int(f[k]) for card, f in late for k in (2, 4) if card in LATE[:4] and f[k].isdigit() and f[k + 1] in ("", "0")}
    for components, *nodes in chosen["SPC"]:
        for node in map(int, nodes):
            still |= {node} & scalar
            deck.held.setdefault(node, set()).update(components if node not in scalar else ())
    turning, moving = deck.turning, scalar - still
    for card, f in late:
        if card == "PSHELL":
            deck.shell(f)
        elif card in LATE[:5]:
            _spring(deck, card, f, laws, where, moving, still)
        else:
            deck.bar(card, f, turning)
    for k, row in enumerate(chosen["MPC"], start=1):
        rows = [row[n : n + 3] for n in range(0, len(row), 3) if row[n]]
        if any(not 1 <= int(way or 0) <= 6 for _, way, _ in rows):
            deck.lose(f"MPC {k}", "a scalar point is in it")
        else:
            deck.equate("MPC", "MPC", [tuple((real(factor), int(node), int(way) - 1) for node, way, factor in rows)])
    return deck


def _motions(nodes: Iterable[str], ways: Iterable[str]) -> list[Motion]:
    """Of each node those that its letters name."""
    return [(int(node), int(way) - 1) for node, letters in zip(nodes, ways, strict=True) if node for way in sorted(letters)]


def _listed(fields: Sequence[str], name: str, deck: Deck) -> list[int]:
    """Numbers, THRU among them, up to the first field that is none."""
    found: list[int] = []
    through = False
    for text in fields:
        if text.upper() == "THRU":
            through = True
        elif text.isdigit():
            tags = deck.mesh.node_tags  # a range names those that are there, its ends among them
            found += tags[(tags >= found.pop()) & (tags <= int(text))].tolist() if through and found else [int(text)]
            through = False
        elif text and real(text):
            deck.lose(name, f"{text} behind its nodes")
    return found


def _spring(
    deck: Deck, card: str, f: Row, laws: Mapping[str, Row], where: Coordinates, moving: Collection[int], still: Collection[int]
) -> None:
    """CBUSH, CELAS and CMASS between nodes, or one and points that are `still`; scalar points that are `moving` are lost."""
    name, points = f"{card} {f[0]}", deck.points
    if card == "CBUSH":
        law, ends = laws.get(f"PBUSH {f[1] or f[0]}", []), [int(text) for text in f[2:4] if text.isdigit() and int(text)]
        at = next((k for k in range(1, len(law), 8) if law[k].upper() == "K"), 0)
        if not at or f[9] not in ("", "-1"):
            deck.lose(name, "it lies beside the line between its nodes (OCID)" if at else "no PBUSH with K")
            return
        if any(law[k].upper() == "M" for k in range(1, len(law), 8)):
            deck.lose(f"PBUSH {f[1] or f[0]}", "its mass (M)")
        six, line = np.array([real(text) for text in law[at + 1 : at + 7]]), points[ends[-1]] - points[ends[0]]
        to = points[int(f[4])] - points[ends[0]] if f[4].isdigit() and not f[5] else None
        if to is None and any(f[4:7]):
            to = np.array([real(text) for text in f[4:7]]) @ deck.axes.get(ends[0], np.eye(3))
        axes = None
        if f[7]:
            axes = where.system(f[7]).directions(points[ends[0]])
        elif line.any():
            axes = axes_along(line, to)
        unclear = to is None and line.any() and not f[7] and (six[1] != six[2] or six[4] != six[5])
        if unclear or (not f[7] and not line.any() and (to is not None or deck.axes.keys() & set(ends))):
            deck.lose(name, "which way it is turned is neither stated nor told by its nodes")
            return
        about = points[ends[0]] + (real(f[8]) if f[8] else 0.5) * line if line.any() else None
        lost = max(
            (real(one) for k in range(1, len(law), 8) if law[k].upper() == "GE" for one in law[k + 1 : k + 7]), default=0.0
        )
        deck.springs[name] = DeckSpring(ends=tuple(ends), stiffness=six, axes=axes, about=about, loss_factor=lost)
    else:
        law = [f[0], f[1], f[6]] if card[-1] == "2" else laws.get(f"P{card[1:5]} {f[1] or f[0]}", ("", "", ""))
        size, lost = real(law[1]), real(law[2]) if "ELAS" in card else 0.0
        pairs = [(int(f[k]), f[k + 1]) for k in (2, 4) if f[k].isdigit() and int(f[k]) not in still]
        ends, along = [node for node, _ in pairs], {component for _, component in pairs}
        if {*ends} & {*moving}:
            deck.lose(name, "it ends at a scalar point that moves")
            return
        if not size or len(along) != 1 or not along <= set("123456") or (len(ends) > 1 and "MASS" in card):
            joins = "motions, or its mass" if "MASS" in card else "different motions, or its stiffness"
            deck.lose(name, f"it joins two {joins} is not here")
            return
        six = np.zeros(6)
        six[int(along.pop()) - 1] = size
        if "MASS" in card:
            R = np.kron(np.eye(2), deck.axes.get(ends[0], np.eye(3)))
            deck.weigh(card, name, ends[0], R.T @ np.diag(six) @ R)
        else:
            deck.springs[name] = DeckSpring(ends=tuple(ends), stiffness=six, loss_factor=lost)
            deck.turn_spring(name)
    deck.carried[card] = None


def _body(M: Array) -> Inertia | None:
    """The body that a matrix (6, 6) of mass is of, if it is; lengths count in radii of gyration."""
    reach = float(np.sqrt(abs(np.trace(M[3:, 3:])) / (abs(np.trace(M[:3, :3])) or np.inf))) or 1.0
    by = np.repeat([1.0, reach], 3)
    try:
        found = Inertia.from_mass_matrix(M / np.outer(by, by))
    except ValueError:
        return None
    return Inertia(parameters=found.parameters * reach ** np.repeat([0, 1, 2], [1, 3, 6]))
