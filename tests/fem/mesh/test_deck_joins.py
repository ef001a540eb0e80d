"""What decks join: rigid bars, means, equations, couplings and ties, against constraints by hand and against CalculiX."""

import os
import shutil
import subprocess
from collections.abc import Mapping, Sequence
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import block_diag, eigh, null_space
from scipy.sparse import csr_array

from fem.mesh import constraints, deck
from fem.structure import Structure
from fem.user_model import reading
from geometry.errors import BadInput
from geometry.frames import Array

Constraint = Mapping[tuple[int, int], float]
"""Coefficients by node and freedom, from 1; their sum is zero."""

STEEL = "MAT1,1,210000.,,.3,7.85-9\nPBARL,1,1,,BAR\n,8.,6.\n"

NODES = {
    1: (0, 0, 0),
    2: (60, 0, 0),
    3: (120, 0, 0),
    11: (120, 0, 20),
    12: (150, 40, 20),
    13: (180, 80, 20),
    21: (100, 50, -10),
    22: (60, 0, 0),
}
"""[mm] of an arm on the wall, of a second one beside its end, and of a point beside both."""

ARMS = {1: ((1, 2), (2, 3)), 2: ((11, 12), (12, 13))}


def grids(*nodes: int) -> str:
    return "".join(f"GRID,{n},,{','.join(f'{float(one)}' for one in NODES[n])}\n" for n in nodes)


def bars(arm: int) -> str:
    return "".join(f"CBAR,{10 * arm + k},1,{a},{b},0.,0.,1.\n" for k, (a, b) in enumerate(ARMS[arm]))


def held(folder: Path, text: str, name: str = "deck.bdf") -> tuple[Structure, str]:
    """The structure of a deck of which nothing is lost, and its description."""
    (folder / name).write_text(text)
    said, lost = deck.described(folder / name, "mm-t-N-s")
    assert lost == ()
    own = folder / Path(name).with_suffix(".toml")
    own.write_text(said)
    return reading.read(own), said


SHIFT = (2 * np.pi * 20.0) ** 2
"""[rad²/s²] below the first elastic mode: mechanisms have modes at 0 Hz, and massless motions none."""


def frequencies(K: Array, M: Array, count: int = 6) -> Array:
    """[Hz], from the lowest, of what has a stiffness or a mass."""
    some = np.abs(K).sum(axis=1) + np.abs(M).sum(axis=1) > 0
    K, M = (one[np.ix_(some, some)] for one in (K, M))
    inverse = eigh(M, K + SHIFT * M, eigvals_only=True)[::-1][:count]
    return np.sqrt(np.maximum(1 / inverse - SHIFT, 0.0)) / (2 * np.pi)


def of(structure: Structure, count: int = 6) -> Array:
    return frequencies(structure.stiffness.toarray(), structure.mass.toarray(), count)


def by_hand(
    folder: Path,
    constraints: Sequence[Constraint],
    masses: Mapping[int, float] | None = None,
    points: Sequence[int] = (),
    springs: Sequence[tuple[Constraint, float]] = (),
) -> Array:
    """Frequencies [Hz] of both arms where `constraints` hold, made of each arm's own matrices, of `masses` at `points`, and of
    `springs` that resist a sum with a stiffness [N/m, N m/rad]."""
    whole, where, size = list[tuple[Array, Array]](), dict[tuple[int, int], int](), 0
    for arm, hold in ((1, "SPC1,1,123456,1\n"), (2, "")):
        nodes = sorted({n for pair in ARMS[arm] for n in pair})
        one, _ = held(folder, f"{STEEL}{grids(*nodes)}{bars(arm)}{hold}ENDDATA\n", f"arm{arm}.bdf")
        for n in nodes:
            k = np.flatnonzero(np.linalg.norm(one.points * 1e3 - np.array(NODES[n]), axis=1) < 1e-6)
            for way in range(6) if len(k) else ():
                where[n, way + 1] = size + int((one.translations if way < 3 else one.rotations)[k[0], way % 3])
        size += len(one.rigid)
        whole.append((one.stiffness.toarray(), one.mass.toarray()))
    for n in points:
        where |= {(n, way): size + way - 1 for way in range(1, 7)}
        whole.append((np.zeros((6, 6)), np.diag([(masses or {}).get(n, 0.0)] * 3 + [0.0] * 3)))
        size += 6
    B = np.zeros((len(springs), size))
    for row, (one, _) in zip(B, springs, strict=True):
        for motion, factor in one.items():
            row[where[motion]] += factor
    C = np.zeros((len(constraints), size))
    for row, one in zip(C, constraints, strict=True):
        for motion, factor in one.items():
            row[where[motion]] += factor
    T = null_space(C)
    K, M = (block_diag(*each) for each in zip(*whole, strict=True))
    K += B.T @ np.diag([stiffness for _, stiffness in springs]) @ B
    return frequencies(T.T @ K @ T, T.T @ M @ T)


def rides(node: int, way: int, on: int) -> Constraint:
    """A motion of `node` as that of a rigid body with `on`; lengths in metres."""
    if way > 3:
        return {(node, way): 1.0, (on, way): -1.0}
    r = (np.array(NODES[node]) - np.array(NODES[on])) / 1e3
    j, k = way % 3, (way + 1) % 3  # u_i = v_i + w_j r_k - w_k r_j
    return {(node, way): 1.0, (on, way): -1.0, (on, 4 + j): -r[k], (on, 4 + k): r[j]}


BOTH = f"{STEEL}{grids(*range(1, 4), *range(11, 14))}{bars(1)}{bars(2)}SPC1,1,123456,1\n"


@pytest.mark.parametrize(
    ("card", "leading", "following", "ways"),
    [
        ("RBAR,5,3,11,123456,,,123456", 3, 11, "123456"),
        ("RBAR,5,3,11,123456", 3, 11, "123456"),
        ("RBAR,5,3,11,123456,,,12346", 3, 11, "12346"),  # a hinge about y
        ("RBAR,5,3,11,,123456,12345", 11, 3, "12345"),
        ("RBAR1,5,3,11,123", 3, 11, "123"),
        ("RBE1,5,3,123456,,,,,\n,UM,11,12345", 3, 11, "12345"),
        ("RBE2,5,3,1236,11", 3, 11, "1236"),
        ("RBAR,5,3,11,123,456,456,123", 0, 0, ""),  # the same rigid body, by other motions
    ],
)
def test_a_rigid_bar_joins_in_the_freedoms_that_follow(
    card: str, leading: int, following: int, ways: str, tmp_path: Path
) -> None:
    whole = [rides(11, way, 3) for way in range(1, 7)]
    wanted = by_hand(tmp_path, [rides(following, int(way), leading) for way in ways] or whole)
    found = of(held(tmp_path, f"{BOTH}{card}\nENDDATA\n")[0])
    np.testing.assert_allclose(found, wanted, rtol=1e-6, atol=0.1)  # what swings on a hinge has 0 Hz but for rounding


def followed(
    node: int, ways: str, independent: Sequence[tuple[int, str, float]], instead: Sequence[tuple[int, str]] = ()
) -> Array:
    """Rows of pyyeti's RBE3 over the motions of the others, in mm."""
    from pyyeti.nastran import n2p

    nodes = [node, *sorted({one for one, *_ in independent} | {one for one, _ in instead})]
    uset = n2p.addgrid(None, nodes, "b", 0, [list(map(float, NODES[n])) for n in nodes], 0)
    listed = [part for one, freedoms, weight in independent for part in ([int(freedoms), weight], one)]
    um = [part for one, freedoms in instead for part in (one, int(freedoms))] or None
    return np.asarray(n2p.formrbe3(uset, node, int(ways), listed, um))


@pytest.mark.parametrize(("freedoms", "ways"), [("123", "123456"), ("123456", "123"), ("12356", "123456")])
def test_a_node_of_the_structure_follows_the_mean_of_others(freedoms: str, ways: str, tmp_path: Path) -> None:
    """Which had been lost, as had freedoms other than 123 and 123456."""
    of_them = [(2, freedoms, 1.0), (3, freedoms, 2.0), (13, freedoms, 1.0)]
    words = [f"{weight},{letters},{n}" for n, letters, weight in of_them]
    text = f"RBE3,5,,11,{ways},{words[0]},{words[1].split(',')[0]}\n,{','.join(words[1].split(',')[1:])},{words[2]}\n"
    T, rows = followed(11, ways, of_them), list[Constraint]()
    for way, row in zip(ways, T, strict=True):
        one = {(11, int(way)): 1.0}
        for (n, letter), share in zip([(n, int(letter)) for n, letters, _ in of_them for letter in letters], row, strict=True):
            one[n, letter] = -share * 1e3 ** (int(way) > 3) / 1e3 ** (letter > 3)
        rows.append(one)
    np.testing.assert_allclose(of(held(tmp_path, f"{BOTH}{text}ENDDATA\n")[0]), by_hand(tmp_path, rows), rtol=1e-6, atol=0.1)


def test_others_follow_in_place_of_the_node_of_a_mean(tmp_path: Path) -> None:
    """UM: the same six equations, and what is condensed of them changes nothing."""
    alike = "RBE3,5,,21,123456,1.,123,2,3\n,11,13"
    free = BOTH + f"{grids(21)}CONM2,9,21,,1.-3\nRBE2,6,21,123456,12\n"
    one = of(held(tmp_path, f"{free}{alike}\n,UM,11,123,13,13,3,1\nENDDATA\n")[0])
    rows = []
    of_them = [(n, "123", 1.0) for n in (2, 3, 11, 13)]
    for way, row in enumerate(followed(21, "123456", of_them), start=1):
        terms = {(21, way): 1.0}
        for (n, letter), share in zip([(n, letter) for n in (2, 3, 11, 13) for letter in (1, 2, 3)], row, strict=True):
            terms[n, letter] = -share * 1e3 ** (way > 3)
        rows.append(terms)
    rows += [rides(12, way, 21) for way in range(1, 7)]
    np.testing.assert_allclose(one, by_hand(tmp_path, rows, {21: 1.0}, [21]), rtol=1e-6, atol=0.1)


def test_the_node_of_a_mean_may_be_held(tmp_path: Path) -> None:
    """As the reference node of a soft support is; it had been held by nothing, without a word."""
    of_them = [(n, "123", 1.0) for n in (3, 11, 12)]
    text = f"{BOTH}{LINK}{grids(21)}RBE3,5,,21,123456,1.,123,3,11\n,12\nSPC1,1,123,21\nENDDATA\n"
    rows = [rides(2, way, 12) for way in range(1, 7)]
    for row in followed(21, "123", of_them):
        motions = [(n, way) for n, *_ in of_them for way in (1, 2, 3)]
        rows.append(dict(zip(motions, row.tolist(), strict=True)))
    np.testing.assert_allclose(of(held(tmp_path, text)[0]), by_hand(tmp_path, rows), rtol=1e-6)


def test_equations_hold_as_they_are_written(tmp_path: Path) -> None:
    """MPC, chained, in two sets that another adds up, and beside one that the case control does not call."""
    cards = "MPC,7,11,1,1.,3,1,-1.\nMPC,7,11,2,2.,3,2,-1.,,\n,,2,2,-1.\nMPC,8,3,3,1.,12,3,-.5,,\n,,11,3,-.25\nMPCADD,9,7,8\n"
    case, more = "SOL 103\nCEND\nSPC = 1\nMPC = 9\nBEGIN BULK\n", "MPC,1,2,3,1.,12,3,1.\nMPC,8,11,4,1.,3,5,2.,,\n,,2,3,.01\n"
    rows: list[Constraint] = [
        {(11, 1): 1.0, (3, 1): -1.0},
        {(11, 2): 2.0, (3, 2): -1.0, (2, 2): -1.0},
        {(3, 3): 1.0, (12, 3): -0.5, (11, 3): -0.25},
        {(11, 4): 1.0, (3, 5): 2.0, (2, 3): 0.01 * 1e3},
    ]
    found = of(held(tmp_path, f"{case}{BOTH}{cards}{more}ENDDATA\n")[0])
    np.testing.assert_allclose(found, by_hand(tmp_path, rows), rtol=1e-6, atol=0.1)


@pytest.mark.parametrize("first", ["RBE2,6,21,123456,3", "RBE2,6,3,123456,21", "RBAR,6,3,21,123456,,,123456"])
@pytest.mark.parametrize("second", ["RBE2,7,21,123456,11", "RBAR,7,21,11,123456,,,123456"])
def test_rigid_links_may_hang_on_each_other(first: str, second: str, tmp_path: Path) -> None:
    """Two of one node, and one whose node rides on another; the two had been as many nodes, which nothing joined."""
    text = f"{BOTH}{grids(21)}CONM2,9,21,,1.-3\n{first}\n{second}\nENDDATA\n"
    rows = [rides(n, way, 21) for n in (3, 11) for way in range(1, 7)]
    np.testing.assert_allclose(of(held(tmp_path, text)[0]), by_hand(tmp_path, rows, {21: 1.0}, [21]), rtol=1e-6)


def test_links_and_holds_along_axes_of_nodes_are_equations(tmp_path: Path) -> None:
    """Freedoms 13 of a node whose axes are turned by 30 degrees about z; before, both were lost."""
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    axes = f"CORD2R,5,,0.,0.,0.,0.,0.,1.\n,{c},{s},0.\n"
    text = BOTH.replace("GRID,11,,120.0,0.0,20.0", "GRID,11,,120.,0.,20.,5").replace(
        "GRID,13,,180.0,80.0,20.0", "GRID,13,,180.,80.,20.,5"
    )
    assert text.count(",5\n") == 2
    found, said = held(tmp_path, f"{text}{axes}RBE2,5,3,1346,11\nSPC1,1,1,13\nENDDATA\n")
    assert "held along axes of nodes" in said

    def turned(way: int) -> Constraint:
        """The first axis, or the fourth, along x and y."""
        one = {key: c * value for key, value in rides(11, way, 3).items()}
        for key, value in rides(11, way + 1, 3).items():
            one[key] = one.get(key, 0.0) + s * value
        return one

    rows: list[Constraint] = [turned(1), rides(11, 3, 3), turned(4), rides(11, 6, 3), {(13, 1): c, (13, 2): s}]
    np.testing.assert_allclose(of(found), by_hand(tmp_path, rows), rtol=1e-6, atol=0.1)


def test_a_mass_on_springs_alone_moves_by_itself(tmp_path: Path) -> None:
    """A box on an isolator at the tip, which nothing else is at, had been lost."""
    text = f"{BOTH}RBE2,6,3,123456,11\n{grids(22)}CONM2,9,22,,1.-3\nPBUSH,8,K,1.,1.,2.\nCBUSH,7,8,22,2,,,,0\nENDDATA\n"
    found = of(held(tmp_path, text)[0])
    stiff = np.array([1e3, 1e3, 2e3])  # N/m, of 1 kg: nearly alone, since the arm is two hundred times as stiff
    np.testing.assert_allclose(found[:3], np.sqrt(np.sort(stiff)) / (2 * np.pi), rtol=0.02)


def test_springs_may_hang_on_each_other(tmp_path: Path) -> None:
    """The node between two, which nothing else is at, had been lost with both."""
    text = f"{BOTH}RBE2,6,3,123456,11,1.2-5\n{grids(22)}GRID,23,,60.,0.,0.\nCONM2,9,22,,1.-3\nPBUSH,8,K,2.,2.,2.,9.,9.,9.\n"
    found = of(held(tmp_path, f"{text}CBUSH,7,8,22,23,,,,0\nCBUSH,17,8,23,2,,,,0\nENDDATA\n")[0])
    np.testing.assert_allclose(found[:3], 3 * [np.sqrt(1e3) / (2 * np.pi)], rtol=0.02)


def test_equations_that_the_case_control_does_not_call_are_said_to_be_left_out(tmp_path: Path) -> None:
    (tmp_path / "deck.bdf").write_text(f"SOL 103\nCEND\nSPC = 1\nBEGIN BULK\n{BOTH}{LINK}MPC,3,11,1,1.,3,1,-1.\nENDDATA\n")
    lost = deck.described(tmp_path / "deck.bdf", "mm-t-N-s")[1]
    assert lost == ("MPC sets 3: the case control calls none, and Nastran leaves them out",)


def across(axis: Array, at: Array, turning: bool) -> Constraint:
    """How far node 11 moves along an `axis` beside node 3 where both reach a point [mm] by rigid arms, or turns about it."""
    found = dict[tuple[int, int], float]()
    for node, sign in ((11, 1.0), (3, -1.0)):
        arm = (at - np.array(NODES[node])) / 1e3
        for k in range(3):
            found[node, 4 + k] = sign * (axis[k] if turning else float(np.cross(arm, axis)[k]))
            if not turning:
                found[node, 1 + k] = sign * axis[k]
    return found


LINK = "RBE2,6,12,123456,2\n"
"""Both arms hang together, whatever the spring between them is."""

STIFF = np.array([1.0, 2.0, 5.0, 700.0, 900.0, 1100.0])
"""[N/mm, N mm/rad]"""


@pytest.mark.parametrize(
    ("orientation", "axes", "share"),
    [
        (",,,,0", np.eye(3), 0.5),
        (",0.,1.,0.", np.array([[0, 0, 1], [0, 1, 0], [-1, 0, 0]]), 0.5),
        (",21", np.array([[0, 0, 1], [-20, 50, 0] / np.sqrt(2900), [-50, -20, 0] / np.sqrt(2900)]), 0.5),
        (",,,,5\n,.25", np.array([[0, 1, 0], [-1, 0, 0], [0, 0, 1]]), 0.25),
    ],
)
def test_a_bush_is_turned_and_stands_between_its_nodes(orientation: str, axes: Array, share: float, tmp_path: Path) -> None:
    """Its axes had been lost, and in those of the model it had reached no point, so that it resisted being turned."""
    bush = f"PBUSH,8,K,{','.join(map(str, STIFF))}\nCBUSH,7,8,3,11{orientation}\nCORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n"
    found = of(held(tmp_path, f"{BOTH}{LINK}{bush}{grids(21)}ENDDATA\n")[0])
    at = (1 - share) * np.array(NODES[3]) + share * np.array(NODES[11])
    units = [1e3] * 3 + [1e-3] * 3
    rows = [(across(axes[k % 3], at, k > 2), STIFF[k] * units[k]) for k in range(6)]
    wanted = by_hand(tmp_path, [rides(2, way, 12) for way in range(1, 7)], springs=rows)
    np.testing.assert_allclose(found, wanted, rtol=1e-6)


def test_springs_act_along_the_axes_of_their_nodes_or_from_one_to_the_other(tmp_path: Path) -> None:
    """CELAS2 along the freedoms of a node with axes of its own; a SPRINGA that lies askew. Both had been lost."""
    c, s = np.cos(np.pi / 6), np.sin(np.pi / 6)
    text = BOTH.replace("GRID,13,,180.0,80.0,20.0", "GRID,13,,180.,80.,20.,5")
    found = of(held(tmp_path, f"{text}{LINK}CELAS2,7,3.,13,2\nCORD2R,5,,0.,0.,0.,0.,0.,1.\n,{c},{s},0.\nENDDATA\n")[0])
    joint = [rides(2, way, 12) for way in range(1, 7)]
    wanted = by_hand(tmp_path, joint, springs=[({(13, 1): -s, (13, 2): c}, 3e3)])
    np.testing.assert_allclose(found, wanted, rtol=1e-6)
    spring = "*ELEMENT, TYPE=SPRINGA, ELSET=S\n9, 3, 13\n*SPRING, ELSET=S\n\n3.\n"
    found = of(held(tmp_path, arms(f"*MPC\nBEAM, 2, 12\n{spring}"), "deck.inp")[0])
    line = np.subtract(NODES[13], NODES[3]) / np.linalg.norm(np.subtract(NODES[13], NODES[3]))
    along = {(n, k + 1): sign * line[k] for n, sign in ((13, 1.0), (3, -1.0)) for k in range(3)}
    np.testing.assert_allclose(found, by_hand(tmp_path, joint, springs=[(along, 3e3)]), rtol=1e-6)


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ("CBUSH,7,8,3,11", "CBUSH 7: which way it is turned is neither stated nor told by its nodes"),
        ("CBUSH,7,8,3,11,,,,0,.5,3", "CBUSH 7: it lies beside the line between its nodes (OCID)"),
        ("CBUSH,7,9,3,11", "CBUSH 7: no PBUSH with K"),
    ],
)
def test_a_bush_that_is_turned_nobody_knows_how_is_lost(cards: str, words: str, tmp_path: Path) -> None:
    cards = cards.replace(",.5,3", "\n,.5,3")
    (tmp_path / "deck.bdf").write_text(f"{BOTH}{LINK}PBUSH,8,K,1.,2.,3.\n{cards}\nENDDATA\n")
    assert deck.described(tmp_path / "deck.bdf", "mm-t-N-s")[1] == (words,)


# Abaqus and CalculiX: two blocks of solids on a foot, the second beside the end of the first.

STEP = "*STEP\n*FREQUENCY\n4\n*END STEP\n"

SOLID = "*MATERIAL, NAME=STEEL\n*ELASTIC\n210000., 0.3\n*DENSITY\n7.85E-9\n*SOLID SECTION, ELSET=ALL, MATERIAL=STEEL\n"

AROUND = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
HEXAHEDRON = np.array([*AROUND, *((np.add(AROUND[a], AROUND[b]) // 2).tolist() for a, b in EDGES)])
"""Twenty nodes in half edges, in the order of Abaqus."""


def block(name: str, number: tuple[int, int, int], size: Array, corner: Array, first: int) -> tuple[dict[int, Array], str]:
    """Nodes [mm] by number, and the text of their elements, along x, y and z from `corner`."""
    lattice = [p for p in product(*(range(2 * n + 1) for n in number)) if sum(k % 2 for k in p) <= 1]
    tags = {p: first + k for k, p in enumerate(lattice)}
    text = f"*ELEMENT, TYPE=C3D20, ELSET={name}\n"
    for k, cell in enumerate(product(*map(range, number)), start=first):
        own = [tags[tuple(p)] for p in (HEXAHEDRON + 2 * np.array(cell)).tolist()]
        text += f"{k}, {', '.join(map(str, own[:10]))},\n{', '.join(map(str, own[10:]))}\n"
    return {n: corner + size * np.array(p) / 2 for p, n in tags.items()}, text


def arms(joins: str) -> str:
    """The arms of beams for CalculiX, 8 mm by 6 as in bulk data, with what joins them."""
    nodes = "".join(f"{n}, {', '.join(map(str, NODES[n]))}\n" for n in (1, 2, 3, 11, 12, 13))
    elements = "*ELEMENT, TYPE=B31, ELSET=ALL\n1, 1, 2\n2, 2, 3\n3, 11, 12\n4, 12, 13\n"
    section = SOLID.replace("SOLID SECTION, ELSET=ALL", "BEAM SECTION, ELSET=ALL, SECTION=RECT") + "6., 8.\n0., 0., 1.\n"
    return f"*NODE\n{nodes}{elements}{section}{joins}*BOUNDARY\n1, 1, 6\n{STEP}"


def blocks(joins: str, other: tuple[int, int, int] = (3, 2, 2), wide: float = 16.0, corner: float = 1.5) -> str:
    """A deck of 60 mm by 20 by 20, its end at x = 60, and of a second block behind it, by surfaces END, BEGIN and TIP."""
    one, first = block("A", (3, 2, 2), np.array([20.0, 10.0, 10.0]), np.zeros(3), 1)
    size = np.array([20.0, wide / other[1], wide / other[2]])
    two, second = block("B", other, size, np.array([60.0, 1.3 * corner, corner]), 1001)
    nodes = "".join(f"{n}, {', '.join(map(repr, p.tolist()))}\n" for n, p in {**one, **two}.items())
    text = f"*NODE\n{nodes}9000, 150., 10., 30.\n9001, 150., 10., 30.\n{first}{second}*ELSET, ELSET=ALL\nA, B\n"
    for name, of, at in (("FOOT", one, 0.0), ("END", one, 60.0), ("BEGIN", two, 60.0), ("TIP", two, 120.0)):
        text += f"*NSET, NSET={name}\n" + "".join(f"{n},\n" for n, p in of.items() if p[0] == at)
    cells = np.arange(1001, 1001 + int(np.prod(other))).reshape(other)
    for name, some in (("LAST", range(9, 13)), ("NEXT", cells[0].ravel()), ("TOP", cells[-1].ravel())):
        text += f"*ELSET, ELSET={name}\n" + "".join(f"{k},\n" for k in some)
    text += "*SURFACE, NAME=END\nLAST, S4\n*SURFACE, NAME=BEGIN\nNEXT, S6\n*SURFACE, NAME=TIP\nTOP, S4\n"
    mass = "*ELEMENT, TYPE=MASS, ELSET=HEAVY\n9000, 9000\n*MASS, ELSET=HEAVY\n1.E-4\n" if "9000" in joins else ""
    return f"{text}{SOLID}{mass}{joins}*BOUNDARY\nFOOT, 1, 3\n*STEP\n*FREQUENCY\n6\n*END STEP\n"


TIED = "*TIE, NAME=GLUE, POSITION TOLERANCE=1.\nBEGIN, END\n"

HUB = f"{TIED}*COUPLING, REF NODE=9000, SURFACE=TIP, CONSTRAINT NAME=HUB\n"

LINE = (80.0, -2.05, -2.5)
"""[mm] from node 30 of the first block to node 1060 of the second."""

APART = "*EQUATION\n6\n" + ",\n".join(
    f"{node}, {way}, {sign * LINE[way - 1]}" for node, sign in ((1060, 1), (30, -1)) for way in (1, 2, 3)
)

JOINS = {
    "tie": (TIED, (3, 2, 2)),
    "tie of other meshes": (TIED, (3, 3, 4)),
    "kinematic": (f"{HUB}*KINEMATIC\n1, 3\n", (3, 2, 2)),
    "rigid body in two": (
        "*RIGID BODY, NSET=BEGIN, REF NODE=9000, ROT NODE=9001\n*RIGID BODY, NSET=END, REF NODE=9000, ROT NODE=9001\n",
        (3, 2, 2),
    ),
    "as far apart": (f"{TIED}{APART}\n", (3, 2, 2)),
    "equations": (
        f"{TIED}*EQUATION\n3\n1060, 3, 1., 1090, 3, -.5, 40, 2, .25\n*EQUATION\n2\n1090, 2, 1., 30, 1, 1.\n",
        (3, 2, 2),
    ),
}


@pytest.mark.parametrize("name", JOINS)
def test_calculix_has_the_same_frequencies(name: str, tmp_path: Path) -> None:
    if shutil.which("ccx") is None:
        pytest.skip("CalculiX is not installed: apt-get install calculix-ccx")
    text = blocks(*JOINS[name])
    found = of(held(tmp_path, text, "deck.inp")[0])
    quiet = {**os.environ, "OMP_NUM_THREADS": "1"}
    subprocess.run(["ccx", "deck"], cwd=tmp_path, env=quiet, capture_output=True, timeout=300, check=False)
    rows = (line.split() for line in (tmp_path / "deck.dat").read_text().splitlines())
    theirs = np.array([float(row[3]) for row in rows if len(row) == 5 and row[0].isdigit()])[: len(found)]
    np.testing.assert_allclose(found, theirs, rtol=3e-5)


def test_a_rigid_body_of_two_nodes_of_solids_keeps_their_distance(tmp_path: Path) -> None:
    """An equation along their line says the same, with which CalculiX has the same frequencies."""
    wanted = of(held(tmp_path, blocks(*JOINS["as far apart"]), "deck.inp")[0])
    found = of(held(tmp_path, blocks(f"{TIED}*MPC\nBEAM, 1060, 30\n"), "deck.inp")[0])
    np.testing.assert_allclose(found, wanted, rtol=1e-8)


def test_a_tie_of_equal_meshes_is_their_nodes_one_by_one(tmp_path: Path) -> None:
    tied = of(held(tmp_path, blocks(TIED, wide=20.0, corner=0.0), "deck.inp")[0])
    one, two = (block("A", (3, 2, 2), np.array([20.0, 10.0, 10.0]), np.array([60.0 * k, 0, 0]), 1 + 1000 * k)[0] for k in (0, 1))
    pairs = [(n, m) for n, p in one.items() for m, q in two.items() if np.array_equal(p, q)]
    equations = "".join(f"*EQUATION\n2\n{m}, {way}, 1., {n}, {way}, -1.\n" for n, m in pairs for way in (1, 2, 3))
    np.testing.assert_allclose(of(held(tmp_path, blocks(equations, wide=20.0, corner=0.0), "own.inp")[0]), tied, rtol=1e-9)


def test_an_assembly_of_abaqus_cae_is_joined_as_the_flat_deck_is(tmp_path: Path) -> None:
    """Surfaces of parts and of the assembly, a node of the assembly's own, and numbers that several instances share."""
    one, first = block("SetA", (3, 2, 2), np.array([20.0, 10.0, 10.0]), np.zeros(3), 1)
    two, second = block("SetB", (3, 2, 2), np.array([20.0, 8.0, 8.0]), np.array([60.0, 1.95, 1.5]), 1)

    def listed(numbers: Sequence[int] | range) -> str:
        return "".join(f"{n},\n" for n in numbers)

    text = "*Heading\n"
    for name, nodes, elements, some, face in (("A", one, first, range(9, 13), "S4"), ("B", two, second, range(1, 5), "S6")):
        text += f"*Part, name=Part{name}\n*Node\n" + "".join(
            f"{n}, {', '.join(map(repr, p.tolist()))}\n" for n, p in nodes.items()
        )
        text += f"{elements}*Elset, elset=_Face, internal\n{listed(some)}*Surface, type=ELEMENT, name=Face\n_Face, {face}\n"
        text += f"*Solid Section, elset=Set{name}, material=Steel\n,\n*End Part\n"
    text += "*Assembly, name=Assembly\n" + "".join(f"*Instance, name=Part{n}-1, part=Part{n}\n*End Instance\n" for n in "AB")
    text += "*Node\n1, 150., 10., 30.\n*Nset, nset=Ref\n1,\n*Nset, nset=Foot, instance=PartA-1\n"
    text += listed([n for n, p in one.items() if p[0] == 0])
    text += f"*Elset, elset=_Tip, internal, instance=PartB-1\n{listed(range(9, 13))}*Surface, type=ELEMENT, name=Tip\n_Tip, S4\n"
    text += "*Tie, name=Glue, adjust=no, position tolerance=1.\nPartB-1.Face, PartA-1.Face\n"
    text += "*Coupling, constraint name=Hub, ref node=Ref, surface=Tip\n*Kinematic\n"
    text += "*Element, type=MASS, elset=Heavy\n1, 1\n*Mass, elset=Heavy\n1e-4,\n*End Assembly\n"
    text += "*Material, name=Steel\n*Density\n7.85e-09,\n*Elastic\n210000., 0.3\n*Boundary\nFoot, ENCASTRE\n"
    found = of(held(tmp_path, f"{text}*Step\n*Frequency\n6\n*End Step\n", "deck.inp")[0])
    flat = of(held(tmp_path, blocks(*JOINS["kinematic"]), "flat.inp")[0])
    np.testing.assert_allclose(found, flat, rtol=1e-9)


@pytest.mark.parametrize("gap", [0.0, 0.4])
def test_what_is_tied_moves_rigidly_with_its_face(gap: float) -> None:
    """And of a motion that its functions have, as those do; on a curved face, which the first does not see."""
    faces = {
        "tri3": np.array([(0.0, 0, 0), (9, 1, 0), (2, 7, 1)]),
        "quad4": np.array([(0.0, 0, 0), (9, 1, 0), (8, 7, 0), (1, 8, 0)]),
    }
    for corners in (*faces.values(), *(np.vstack([own, (own + np.roll(own, -1, axis=0)) / 2]) for own in faces.values())):
        points = dict(enumerate(corners))
        normal = np.cross(corners[1] - corners[0], corners[2] - corners[0])
        point = corners.mean(axis=0) + gap * normal / np.linalg.norm(normal)
        (sums, away, _) = constraints.tied({99: point}, [tuple(points)], points, lambda node: False, 1.0)
        assert (len(sums), away) == (3, 0)
        turn, shift = np.array([0.3, -0.2, 0.5]), np.array([1.0, 2.0, -3.0])
        moved = {n: shift + np.cross(turn, p) for n, p in {**points, 99: point}.items()}
        np.testing.assert_allclose([sum(f * moved[n][way] for f, n, way in one) for one in sums], 0.0, atol=1e-9)


def test_a_distributing_coupling_is_the_mean_by_areas(tmp_path: Path) -> None:
    """CalculiX carries no mass of its reference node over; the same is held against an RBE3 by hand."""
    found, _ = held(tmp_path, blocks(f"{HUB}*DISTRIBUTING\n", (3, 1, 1)), "deck.inp")
    text = blocks(TIED, (3, 1, 1)).replace(
        "*BOUNDARY", "*ELEMENT, TYPE=MASS, ELSET=HEAVY\n9000, 9000\n*MASS, ELSET=HEAVY\n1.E-4\n*BOUNDARY"
    )
    two = block("B", (3, 1, 1), np.array([20.0, 16.0, 16.0]), np.array([60.0, 1.95, 1.5]), 1001)[0]
    tip = {n: p for n, p in two.items() if p[0] == 120.0}
    middle = np.mean(list(tip.values()), axis=0)
    share = {n: -1.0 if np.linalg.norm(p - middle) > 10 else 4.0 for n, p in tip.items()}  # what functions of a quad8 cover
    at = np.array([150.0, 10.0, 30.0])
    A, W = np.zeros((0, 6)), np.repeat(list(share.values()), 3)
    for p in tip.values():
        x, y, z = p - at
        A = np.vstack([A, [[1, 0, 0, 0, z, -y], [0, 1, 0, -z, 0, x], [0, 0, 1, y, -x, 0]]])
    T = np.linalg.solve(A.T * W @ A, A.T * W)[:3]
    for way, row in enumerate(T, start=1):
        terms = [f"9000, {way}, 1."] + [
            f"{n}, {k + 1}, {-row[3 * i + k]!r}" for i, n in enumerate(tip) for k in range(3) if row[3 * i + k]
        ]
        listed = ",\n".join(", ".join(terms[k : k + 4]) for k in range(0, len(terms), 4))
        text = text.replace("*BOUNDARY", f"*EQUATION\n{len(terms)}\n{listed}\n*BOUNDARY")
    np.testing.assert_allclose(of(held(tmp_path, text, "own.inp")[0]), of(found), rtol=1e-6)


@pytest.mark.parametrize(("kind", "ways"), [("BEAM", "123456"), ("TIE", ""), ("PIN", "123")])
def test_points_are_joined_as_abaqus_joins_them(kind: str, ways: str, tmp_path: Path) -> None:
    """Of two arms of beams: rigidly, in all freedoms alike, and as by a pin that reaches from one to the other."""
    found = of(held(tmp_path, arms(f"*MPC\n{kind}, 11, 3\n"), "deck.inp")[0])
    rows = [rides(11, int(way), 3) for way in ways] if kind == "BEAM" else []
    rows = rows or [{(11, way): 1.0, (3, way): -1.0} for way in range(1, 4 if kind == "PIN" else 7)]
    np.testing.assert_allclose(found, by_hand(tmp_path, rows), rtol=1e-6, atol=0.1)


@pytest.mark.parametrize(
    ("joins", "words"),
    [
        (
            "*TIE, NAME=GLUE\nTIP, END\n",
            "*TIE GLUE: none of its 21 nodes lies within 0.707 of the other surface, and 1 row of it",
        ),
        ("*RIGID BODY, PIN NSET=TIP, REF NODE=9000\n", "*RIGID BODY: it has no reference node, or no NSET, ELSET or TIE NSET"),
        ("*TIE, NAME=GLUE\nBEGIN, NOWHERE\n", "*TIE GLUE: 'NOWHERE' of it is not here, and 1 row of it with that"),
        ("*MPC\nSLIDER, 1060, 30, 31\n", "*MPC 1: MPC of type SLIDER are not known here, and 1 row of it with that"),
        ("*EQUATION\n2\n1060, 11, 1., 30, 1, -1.\n", "*EQUATION 1: a freedom that is none of motion, and 2 rows of it"),
        (f"{HUB}*KINEMATIC\n1, 3\n".replace("REF NODE=9000, ", ""), "*COUPLING HUB: it has no reference node"),
        ("*EQUATION\n3\n1060, 1, 1., 30, 1, -1.\n", "*EQUATION 1: an equation ends before its last term, and 2 rows of it"),
        ("*EQUATION\n2.5\n1060, 1, 1., 30, 1, -1.\n", "*EQUATION 1: a row of it cannot be read, and 2 rows of it with that"),
        ("*TIE, NAME=GLUE, CYCLIC SYMMETRY\nBEGIN, END\n", "*TIE GLUE: CYCLIC SYMMETRY is not known here, and 1 row"),
        (
            f"{HUB}*DISTRIBUTING, WEIGHTING METHOD=QUADRATIC\n1, 6\n",
            "*COUPLING HUB: WEIGHTING METHOD=QUADRATIC is not known here, and 1 row of it with that",
        ),
        (
            f"{HUB}*DISTRIBUTING\n1, 6\n".replace("REF NODE=9000, ", "REF NODE=9000, INFLUENCE RADIUS=1., "),
            "*COUPLING HUB: INFLUENCE RADIUS=1. is not known here",
        ),
        (
            f"{HUB}*KINEMATIC\n1, 6\n*SURFACE, NAME=BOTH, COMBINE=UNION\nBEGIN, END\n".replace("SURFACE=TIP", "SURFACE=BOTH"),
            "*COUPLING HUB: 'BEGIN' of it is not here, and 1 row of it with that",
        ),
        ("*TIE, NAME=GLUE, POSITION TOLERANCE=.1\nBEGIN, NEAR\n*SURFACE, NAME=NEAR\n9, S4\n", "surfaces of TIE GLUE: 1"),
    ],
)
def test_what_cannot_be_joined_is_said_with_its_count(joins: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "deck.inp").write_text(blocks(joins))
    lost = deck.described(tmp_path / "deck.inp", "mm-t-N-s")[1]
    assert any(one.startswith(words) for one in lost), lost


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ("RBE2,6,21,123456,3\nRBE2,7,21,123456,11,9999", "`line 17`: RBE2 names node 9999, which is not there"),
        ("RBE2,6,3,123456,11\nMPC,1,13,1,1.,777,1,-1.", "`line 17`: MPC names node 777"),
        ("RBAR    7       3       777", "`line 16`: RBAR names node 777"),
        ("$ CONM2,7,777\nCONM2,777,3,,1.\nCONM2,8,777,,1.", "`line 18`: CONM2 names node 777"),
        ("SPC1,1,123,3,777", "`line 16`: SPC1 names node 777"),
        ("RBE3,7,,21,123456,1.,123,3,11\n,777", "`line 17`: RBE3 names node 777"),
        ("PBUSH,8,K,1.,2.,3.\nCBUSH,7,8,3,777", "`line 17`: CBUSH names node 777"),
    ],
)
def test_a_deck_that_joins_or_holds_nodes_that_are_not_there_is_refused_with_its_line(
    cards: str, words: str, tmp_path: Path
) -> None:
    """All equations had been lost with one, and what held a node that is not there was passed over."""
    (tmp_path / "deck.bdf").write_text(f"{BOTH}{grids(21)}{cards}\nENDDATA\n")
    with pytest.raises(BadInput, match=words):
        deck.described(tmp_path / "deck.bdf", "mm-t-N-s")


def test_a_range_may_name_nodes_that_are_not_there(tmp_path: Path) -> None:
    more = "SPC1,1,456,777,THRU,9999\nSPC1,1,13,4,THRU,12\n"
    found = of(held(tmp_path, f"{BOTH}{LINK}{more}ENDDATA\n")[0])
    single = of(held(tmp_path, f"{BOTH}{LINK}SPC1,1,13,11\n".replace("RBE2", "SPC1,1,13,12\nRBE2") + "ENDDATA\n")[0])
    np.testing.assert_array_equal(found, single)


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ("*RIGID BODY, NSET=NOBODY, REF NODE=9000\n", "`line 400`: RIGID BODY names the set NOBODY, which is not there"),
        ("*BOUNDARY\nNOBODY, 1, 3\n", "`line 401`: BOUNDARY names the set NOBODY"),
        ("*BOUNDARY\n** a note\n7777, 1, 3\n", "`line 402`: BOUNDARY names node 7777"),
        ("*EQUATION\n2\n7777, 1, 1., 30, 1, -1.\n", "`line 402`: EQUATION names node 7777"),
        ("*ELEMENT, TYPE=MASS, ELSET=M\n9, 7777\n*MASS, ELSET=M\n1.\n", "`line 401`: MASS names node 7777"),
        ("*MPC\nBEAM, 30, 7777\n", "`line 401`: MPC names node 7777"),
    ],
)
def test_keywords_that_name_nodes_that_are_not_there_are_refused_with_their_line(cards: str, words: str, tmp_path: Path) -> None:
    """A foot that no set has held nothing, and nobody said so."""
    (tmp_path / "deck.inp").write_text(blocks(f"{TIED}** 9000\n{cards}"))
    with pytest.raises(BadInput, match=words):
        deck.described(tmp_path / "deck.inp")


def test_an_equation_that_cannot_be_read_takes_no_other_with_it(tmp_path: Path) -> None:
    equation = "2\n1060, {}, 1., {}, {}, -1.\n"
    texts = (f"{TIED}*EQUATION\n{more}{equation.format(1, 30, 1)}" for more in ("", equation.format(11, 30, 1)))
    said, lost = zip(*(described(tmp_path, blocks(text)) for text in texts), strict=True)
    assert lost == ((), ("*EQUATION 1: a freedom that is none of motion, and 2 rows of it with that",))
    sums = [text[text.index("[fe_model.equations.") :] for text in said]
    assert sums[0] == sums[1]


def described(folder: Path, text: str) -> tuple[str, tuple[str, ...]]:
    (folder / "deck.inp").write_text(text)
    return deck.described(folder / "deck.inp", "mm-t-N-s")


BODIES = {
    "two nodes": [(100, "123456", (60,))],
    "two by two, in translations": [(100, "123456", (60,)), (91, "123", (111,))],
    "three on a line": [(93, "123456", (98, 103))],
    "one carries two": [(100, "123456", (91, 111)), (100, "123456", (60, 70))],
    "what rides carries more": [(100, "123456", (91, 111, 105)), (91, "123456", (60, 70))],
    "more than two in a row": [(91, "123456", (60,)), (60, "123456", (30,)), (30, "123456", (77,))],
    "in some directions": [(100, "12", (60, 70, 80))],
}
"""Of a block of solids: the node that carries, the freedoms, the nodes that ride on it."""


@pytest.mark.parametrize("name", BODIES)
def test_nodes_of_solids_turn_with_the_rigid_body_that_they_carry(name: str, tmp_path: Path) -> None:
    """Two nodes spun about their line, and rotations of those that carry were held where another link was."""
    points, elements = block("A", (3, 2, 2), np.array([20.0, 10.0, 10.0]), np.zeros(3), 1)
    text = "MAT1,1,210000.,,.3,7.85-9\nPSOLID,1,1\n"
    text += "".join(f"GRID,{n},,{','.join(map(repr, p.tolist()))}\n" for n, p in points.items())
    for row in elements.partition("\n")[2].replace(",\n", ",").splitlines():
        tag, *own = row.replace(" ", "").split(",")
        own = [*own[:12], *own[16:], *own[12:16]]
        text += f"CHEXA,{tag},1,{','.join(own[:6])}\n,{','.join(own[6:14])}\n,{','.join(own[14:])}\n"
    text += f"SPC1,1,123,{chr(10).join(f'{n}' for n, p in points.items() if not p[0])}".replace("\n", "\nSPC1,1,123,") + "\n"
    rides = "".join(f"RBE2,{k},{a},{ways},{','.join(map(str, own))}\n" for k, (a, ways, own) in enumerate(BODIES[name], 9001))
    made = held(tmp_path, f"{text}{rides}ENDDATA\n")[0]
    assert (abs(made.stiffness).max(axis=1).toarray() > 0).all()
    bare = held(tmp_path, f"{text}ENDDATA\n", "bare.bdf")[0]
    dof = {n: bare.translations[np.argmin(np.linalg.norm(bare.points - p / 1e3, axis=1))] for n, p in points.items()}
    size, nodes = len(bare.mass.toarray()), sorted({n for a, _, own in BODIES[name] for n in (a, *own)})
    where = {n: [*dof[n], *(size + 3 * k + np.arange(3))] for k, n in enumerate(nodes)}  # their rotations behind all
    rows = []
    for carrier, ways, own in BODIES[name]:
        for node in own:
            arm = (points[node] - points[carrier]) / 1e3
            T = np.block([[np.eye(3), np.cross(np.eye(3), arm)], [np.zeros((3, 3)), np.eye(3)]])
            for way in (int(letter) - 1 for letter in ways):
                rows.append(np.zeros(size + 3 * len(nodes)))
                rows[-1][where[carrier]] = -T[way]
                rows[-1][where[node][way]] += 1.0
    C = np.array(rows) * np.repeat([1.0, 30.0], [size, 3 * len(nodes)])
    Z = null_space(null_space(C[:, size:].T, rcond=1e-9).T @ C[:, :size], rcond=1e-9)
    wanted = frequencies(*(Z.T @ one.toarray() @ Z for one in (bare.stiffness, bare.mass)))
    np.testing.assert_allclose(of(made), wanted, rtol=1e-6)


def test_a_link_that_only_turns_what_does_not_turn_is_refused(tmp_path: Path) -> None:
    """It was a traceback."""
    with pytest.raises(BadInput, match=r"links.COUPLING HUB.directions`: none of its nodes moves in these directions"):
        held(tmp_path, blocks(f"{HUB}*KINEMATIC\n4, 6\n"), "deck.inp")


def test_any_number_of_nodes_may_follow_each_other(tmp_path: Path) -> None:
    """More than a thousand, one by one, were said to go in a circle: masses on a line that all move as its last one does."""
    last = 1200
    points = "".join(f"GRID,{1000 + k},,120.,0.,0.\n" for k in range(1, last + 1))
    chain = "".join(f"MPC,1,{1000 + k},{way},1.,{1001 + k},{way},-1.\n" for k in range(1, last) for way in (1, 2, 3))
    end = "".join(f"MPC,1,{1000 + last},{way},1.,3,{way},-1.\n" for way in (1, 2, 3))
    one = f"{STEEL}{grids(1, 2, 3)}{bars(1)}SPC1,1,123456,1\n"
    found = of(held(tmp_path, f"{one}{points}{chain}{end}CONM2,9,1001,,1.-3\nENDDATA\n")[0])
    alone = of(held(tmp_path, f"{one}CONM2,9,3,,1.-3\nENDDATA\n", "alone.bdf")[0])
    np.testing.assert_allclose(found, alone, rtol=1e-9)


def test_followers_of_followers_are_followed_once_each() -> None:
    """Each was followed by every way to it, of which there are as many as Fibonacci's numbers: this one never ended."""
    count = 120  # on a straight line: each moves as the next two say, and the first and the last are held together
    sums = [[(1.0, k), (-2.0, k + 1), (1.0, k + 2)] for k in range(count - 2)] + [[(1.0, 0), (-1.0, count - 1)]]
    none, bare = np.zeros(count, dtype=bool), csr_array((count, count))
    found = constraints.eliminated(sums, bare, none, none)
    (free,) = set(range(count)) - found.keys()  # all move as it does
    moved = np.linalg.inv(np.eye(count) - constraints.matrix(found, count).toarray())[:, free]
    np.testing.assert_allclose(moved, 1.0, rtol=1e-9)


def test_equations_that_hold_a_free_structure_are_refused(tmp_path: Path) -> None:
    text = BOTH.replace("SPC1,1,123456,1\n", "") + "RBE2,5,3,123456,11\nMPC,1,13,1,1.,2,1,-2.\nENDDATA\n"
    with pytest.raises(BadInput, match="they resist a rigid motion") as refused:
        held(tmp_path, text)
    assert "(x) by what they say of node 13" in str(refused.value)


@pytest.mark.parametrize(
    ("sums", "words"),
    [
        ("[[[1, 11]], [[1, 3, 'x'], [-1, 2]]]", "must be sums of"),
        ("[]", "must be sums of"),
        ("[[[0, 11, 'x']]]", "must be sums of"),
        ("[[[1, 11, 'u']]]", "must be sums of"),
        ("[[[1, 77, 'x']]]", "no element of the parts has a node 77"),
        ("[[[1, '1', 'x']]]", "are 6 nodes"),
    ],
)
def test_sums_of_a_description_are_refused_in_words(sums: str, words: str, tmp_path: Path) -> None:
    _, said = held(tmp_path, f"{BOTH}RBE2,5,3,123456,11\nMPC,1,13,1,1.,2,1,-2.\nENDDATA\n")
    start = said.index("sums = ")
    (tmp_path / "deck.toml").write_text(said[:start] + f"sums = {sums}" + said[said.index("\n]", start) + 2 :])
    with pytest.raises(BadInput, match=words):
        reading.read(tmp_path / "deck.toml")


def test_a_sum_without_motions_is_of_three(tmp_path: Path) -> None:
    found, said = held(tmp_path, f"{BOTH}MPC,1,11,1,1.,3,1,-1.\nMPC,1,11,2,1.,3,2,-1.\nMPC,1,11,3,1.,3,3,-1.\nENDDATA\n")
    start = said.index("sums = ")
    (tmp_path / "deck.toml").write_text(said[:start] + "sums = [[[1, 11], [-1, 3]]]" + said[said.index("\n]", start) + 2 :])
    np.testing.assert_array_equal(reading.read(tmp_path / "deck.toml").stiffness.toarray(), found.stiffness.toarray())
