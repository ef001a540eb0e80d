"""A deck of Nastran or Abaqus as a description: the same structure by both, CalculiX's frequencies, units, and what is lost."""

import os
import re
import shutil
import subprocess
from collections.abc import Callable
from itertools import product
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.mesh import deck, description, files, model
from fem.modes import lowest
from fem.user_model.units import KNOWN, unit_system
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from validation.cli import main

LONG, SIDE = 6, 20.0
"""Elements of the cantilever along x, and the edge [mm] of each."""

CORNERS = [(0, 0, 0), (2, 0, 0), (2, 2, 0), (0, 2, 0), (0, 0, 2), (2, 0, 2), (2, 2, 2), (0, 2, 2)]
EDGES = [(0, 1), (1, 2), (2, 3), (3, 0), (4, 5), (5, 6), (6, 7), (7, 4), (0, 4), (1, 5), (2, 6), (3, 7)]
AROUND = np.array([*CORNERS, *((np.add(CORNERS[a], CORNERS[b]) // 2).tolist() for a, b in EDGES)])
"""A hexahedron of twenty nodes in half edges, in the order of Abaqus."""

HUB, TIP = 9000, 9001
"""Number of the node that the free end rides on, which carries a mass, and of a node at the corner that a spring holds."""


def cantilever() -> tuple[dict[int, tuple[float, ...]], list[list[int]]]:
    """Nodes [mm] by number, and the nodes of each element."""
    lattice = [p for p in product(range(2 * LONG + 1), range(3), range(3)) if sum(k % 2 for k in p) <= 1]
    number = {p: n for n, p in enumerate(lattice, start=1)}
    nodes = {n: tuple(SIDE / 2 * k for k in p) for p, n in number.items()}
    cells = [[number[tuple(p)] for p in np.add(AROUND, (2 * k, 0, 0)).tolist()] for k in range(LONG)]
    return {**nodes, HUB: (SIDE * LONG + 30.0, SIDE / 2, SIDE / 2)}, cells


NODES, CELLS = cantilever()
FOOT = [n for n, p in NODES.items() if p[0] == 0]
END = [n for n, p in NODES.items() if p[0] == SIDE * LONG]
MIDDLE = next(n for n, p in NODES.items() if p == (SIDE * 3, 0.0, 0.0))


def listed(numbers: list[int]) -> str:
    return "".join(f"{n},\n" for n in numbers)


def abaqus(step: str = "") -> str:
    """In capitals and small letters as Abaqus minds neither; CalculiX writes exponents with a d."""
    lines = ["*NODE, NSET=ALL", *(f"{n}, {x}, {y}, {z}" for n, (x, y, z) in NODES.items())]
    for name, some in (("ROOT", range(2)), ("ARM", range(2, LONG))):
        lines += [f"*ELEMENT, TYPE=C3D20, ELSET={name}"]
        lines += [f"{k + 1}, {', '.join(map(str, CELLS[k][:10]))},\n{', '.join(map(str, CELLS[k][10:]))}" for k in some]
    lines += [f"*ELEMENT, TYPE=MASS, ELSET=HEAVY\n101, {HUB}\n*ELEMENT, TYPE=SPRING1, ELSET=STAY\n102, {MIDDLE}"]
    lines += [f"*NSET, NSET=Foot\n{listed(FOOT)}*NSET, NSET=END\n{listed(END)}*MASS, ELSET=HEAVY\n1.5d-4"]
    lines += ["*SPRING, ELSET=STAY\n3\n200.", f"*RIGID BODY, NSET=END, REF NODE={HUB}", "*BOUNDARY\nFOOT, 1\nfoot, 2, 3"]
    lines += ["*MATERIAL, NAME=Steel\n*ELASTIC\n210000., 0.3\n*DENSITY\n7.85e-9"]
    lines += ["*MATERIAL, NAME=ALU\n*ELASTIC\n7.d4, 0.33\n*DENSITY\n2.7e-9"]
    lines += ["*SOLID SECTION, ELSET=root, MATERIAL=STEEL\n*SOLID SECTION, ELSET=ARM, MATERIAL=alu"]
    return "\n".join(lines) + "\n" + step


def card(*fields: object) -> str:
    """In free fields, continued after every eighth."""
    words = [str(field) for field in fields]
    first, rest = words[:9], [words[k : k + 8] for k in range(9, len(words), 8)]
    return "\n".join([",".join(first), *("," + ",".join(more) for more in rest)])


def nastran(*more: str, spc: str = "123") -> str:
    lines = [
        "SOL 103",
        "CEND",
        "SPC = 7",
        "BEGIN BULK",
        "PARAM,WTMASS,1.-3",
        "MAT1,1,210000.,,.3,7.85-6",
        "MAT1,2,7.+4,,.33,2.7-6",
    ]
    lines += [card("GRID", n, "", *p) for n, p in NODES.items()] + ["PSOLID,1,1", "PSOLID,2,2"]
    lines += [card("CHEXA", k + 1, 1 if k < 2 else 2, *own[:12], *own[16:], *own[12:16]) for k, own in enumerate(CELLS)]
    lines += [card("SPC1", 7, spc, *FOOT), card("SPC1", 8, "123456", MIDDLE), card("RBE2", 99, HUB, "123456", *END)]
    lines += [card("CONM2", 101, HUB, "", 0.15), card("CELAS2", 102, 200.0, MIDDLE, 3), *more, "ENDDATA", ""]
    return "\n".join(lines)


def frequencies(text: str, folder: Path, ending: str) -> Array:
    """(6,) [Hz] of the description that `massline model` makes of a deck."""
    path = folder / f"beam.{ending}"
    path.write_text(text, encoding="utf-8")
    written, lost = deck.described(path)
    assert lost == ()
    (folder / f"{ending}.toml").write_text(written, encoding="utf-8")
    structure = model.load(folder / f"{ending}.toml")[1]
    values = eigh(structure.stiffness.toarray(), structure.mass.toarray(), eigvals_only=True, subset_by_index=(0, 5))
    return np.sqrt(values) / (2 * np.pi)


def test_nastran_and_abaqus_tell_the_same_structure(tmp_path: Path) -> None:
    one, other = frequencies(abaqus(), tmp_path, "inp"), frequencies(nastran(), tmp_path, "bdf")
    np.testing.assert_allclose(one, other, rtol=1e-6)
    found = description.read(tmp_path / "bdf.toml")
    assert (found.support, found.left_out, list(found.parts)) == ("ground", ("RBE2", "CONM2", "CELAS2"), ["1", "2"])
    assert description.read(tmp_path / "inp.toml").interface == ("clamp",)
    assert description.read(tmp_path / "inp.toml").links["clamp"].nodes == ("Foot",)
    assert found.masses["CONM2 101"].inertia.mass == pytest.approx(0.15)


def test_a_deck_in_pieces_and_in_axes_of_its_own_is_the_same_structure(tmp_path: Path) -> None:
    """Nodes about a turned cylinder, along whose axes they move, and a sphere that stands on it."""
    plain = frequencies(nastran(), tmp_path, "bdf")
    angle = np.radians(30.0)
    axes = np.array([[np.cos(angle), 0, np.sin(angle)], [0, 1, 0], [-np.sin(angle), 0, np.cos(angle)]])
    origin, out = np.array([7.0, -200.0, 3.0]), np.array([5.0, 60.0, 40.0])

    def around(n: int, p: tuple[float, ...]) -> str:
        x, y, z = axes @ (np.array(p) - origin)
        if n % 2 and n != MIDDLE:
            return card("GRID", n, 4, np.hypot(x, y), np.degrees(np.arctan2(y, x)), z, 4)
        # The sphere has the cylinder's axes, from a point that stands in it at radius 5, 60 degrees and 40
        x, y, z = x - out[0] * np.cos(np.radians(out[1])), y - out[0] * np.sin(np.radians(out[1])), z - out[2]
        r = np.sqrt(x**2 + y**2 + z**2)
        return card("GRID", n, 5, r, np.degrees(np.arccos(z / r)), np.degrees(np.arctan2(y, x)))

    a, c = origin + axes[2], origin + axes[0]
    aside = np.array([np.hypot(3.5, 5 * np.sqrt(0.75)), np.degrees(np.arctan2(5 * np.sqrt(0.75), 3.5)), out[2]])  # 1 along x
    up, along = (*out[:2], out[2] + 1), aside
    systems = [card("CORD2C", 4, "", *origin, *a, *c), card("CORD2S", 5, 4, *out, *up, *along)]
    text = nastran()
    for n, p in NODES.items():
        text = text.replace(card("GRID", n, "", *p) + "\n", around(n, p) + "\n")
    head, begin, bulk = text.partition("BEGIN BULK\n")
    (tmp_path / "parts").mkdir()
    (tmp_path / "parts" / "systems.blk").write_text("\n".join(systems) + "\n")
    (tmp_path / "parts" / "bulk.blk").write_text(bulk.replace("ENDDATA", "INCLUDE 'systems.blk'"))
    own = f"INCLUDE 'alter.v9'\n{head}{begin}include 'parts/\n  bulk.blk' $ the rest\nENDDATA\n"
    np.testing.assert_allclose(frequencies(own, tmp_path, "nas"), plain, rtol=1e-6)  # the clamp is stiff, not rigid


def test_a_mass_stands_beside_its_node(tmp_path: Path) -> None:
    """30 mm off the hub along the axes of a turned system, with an inertia in these; as the same mass where it is."""
    far = card("GRID", HUB, "", *NODES[HUB]), card("GRID", HUB, "", *np.add(NODES[HUB], (0, 30, 0)))
    mass, moments = card("CONM2", 101, HUB, "", 0.15), (40.0, 0, 50.0, 0, 0, 60.0)
    turned = card("CORD2R", 3, "", 0, 0, 0, 0, 0, 1, 0, 1, 0)  # its x along y, its y along -x
    there = nastran().replace(*far).replace(mass, card("CONM2", 101, HUB, "", 0.15, 0, 0, 0, "", *moments))
    aside = nastran(turned).replace(mass, card("CONM2", 101, HUB, 3, 0.15, 30.0, 0, 0, "", 50.0, 0, 40.0, 0, 0, 60.0))
    at = nastran().replace(mass, card("CONM2", 101, HUB, -1, 0.15, *np.add(NODES[HUB], (0, 30, 0)), "", *moments))
    wanted = frequencies(there, tmp_path, "bdf")
    assert abs(frequencies(nastran(), tmp_path, "bdf")[0] / wanted[0] - 1) > 1e-3
    for one in (aside, at):
        np.testing.assert_allclose(frequencies(one, tmp_path, "nas"), wanted, rtol=1e-6)


def test_a_node_follows_the_mean_of_others_as_in_nastran(tmp_path: Path) -> None:
    """RBE3, held against pyyeti's, which is held against Nastran's own; the structure stays as soft as it was."""
    from pyyeti.nastran import n2p

    spread = nastran().replace(card("RBE2", 99, HUB, "123456", *END), card("RBE3", 99, "", HUB, "123456", 1.0, "123", *END), 1)
    soft, stiff = frequencies(spread, tmp_path, "bdf"), frequencies(nastran(), tmp_path, "nas")
    assert np.all(soft[1:] < stiff[1:])
    structure = model.load(tmp_path / "bdf.toml")[1]
    assert structure.elements is not None
    uset = n2p.addgrid(None, [HUB, *END], "b", 0, [NODES[HUB], *(NODES[n] for n in END)], 0)
    theirs = n2p.formrbe3(uset, HUB, 123456, [123, END])
    index = np.flatnonzero(np.isin(structure.elements.node_tags, END))
    ours = structure.elements.mean(index, np.array(NODES[HUB]) / 1e3, turning=False).toarray()
    dofs = structure.elements.own[structure.elements.first[index][:, None] + np.arange(3)].ravel()
    theirs[3:] *= 1e3  # per mm
    np.testing.assert_allclose(ours[:, dofs], theirs, rtol=1e-6, atol=1e-9 * np.abs(theirs).max())


@pytest.mark.parametrize(("freedoms", "weights"), [("123", (1.0, 3.0)), ("123456", (1.0, 1.0)), ("123456", (2.0, 0.5))])
def test_a_node_follows_by_weights_and_by_rotations_as_in_nastran(
    freedoms: str, weights: tuple[float, float], tmp_path: Path
) -> None:
    """Two nodes of a plate by one weight and two by another; a mass there weighs what it does, wherever it hangs."""
    from pyyeti.nastran import n2p

    hub = (70.0, 10.0, 55.0)
    groups = [(weights[0], (1, 2)), (weights[1], (3, 4))]
    rbe3 = card("RBE3", 9, "", 7, "123456", *(word for weight, nodes in groups for word in (weight, freedoms, *nodes)))
    lines = [*PLATE[:-1], card("GRID", 7, "", *hub), rbe3, "CONM2,8,7,,1.-4", "ENDDATA", ""]
    lines = [line for line in lines if not line.startswith("SPC1")]
    (tmp_path / "one.bdf").write_text("\n".join(lines))
    written, lost = deck.described(tmp_path / "one.bdf")
    assert lost == ()
    (tmp_path / "one.toml").write_text(written)
    made = model.load(tmp_path / "one.toml")[1]
    points = {int(line.split(",")[1]): [float(x) for x in line.split(",")[3:6]] for line in PLATE if line.startswith("GRID")}
    uset = n2p.addgrid(None, [1, 2, 3, 4, 7], "b", 0, [*(points[k] for k in range(1, 5)), list(hub)], 0)
    theirs = n2p.formrbe3(uset, 7, 123456, [part for weight, nodes in groups for part in ([int(freedoms), weight], list(nodes))])
    theirs = theirs.reshape(6, 4, -1)
    theirs[3:, :, :3] *= 1e3  # per mm
    theirs[:3, :, 3:] /= 1e3
    link = description.read(tmp_path / "one.toml").links["RBE3 9"]
    shares = np.array(link.weights or 4 * [1.0])
    ours = made.elements.mean(np.arange(4), np.array(link.at), link.rotations, shares).toarray().reshape(6, 4, 6)
    np.testing.assert_allclose(ours[:, :, : theirs.shape[2]], theirs, rtol=1e-6, atol=1e-9)
    np.testing.assert_allclose(ours[:, :, theirs.shape[2] :], 0.0, atol=1e-12)
    carried = made.rigid.T @ made.part_mass["CONM2 8"] @ made.rigid
    np.testing.assert_allclose(carried[:3, :3], 0.1 * np.eye(3), atol=1e-9)
    np.testing.assert_allclose([carried[0, 4], carried[1, 3]], [0.1 * hub[2] / 1e3, -0.1 * hub[2] / 1e3], rtol=1e-6)


def test_what_a_deck_gives_no_mass_has_hardly_any(tmp_path: Path) -> None:
    """A film that is stretched over a frame, as on the wing of a model aircraft, and a bar that only ties."""
    more = ["MAT1,2,70000.,,.3", "PSHELL,2,2,.02,2,,2", "CTRIA3,2,2,3,4,5", "PBAR,3,2,5.", "CBAR,3,3,2,5,0.,1.,0."]
    found = []
    for own in ([], more):
        (tmp_path / "one.bdf").write_text("\n".join([*PLATE, *own, "ENDDATA", ""]))
        written, lost = deck.described(tmp_path / "one.bdf")
        assert lost == ()
        (tmp_path / "one.toml").write_text(written)
        made = model.load(tmp_path / "one.toml")[1]
        found.append(made.mass.diagonal().sum())
        assert lowest(made.stiffness, made.mass, 3).values[0] > 0
    assert found[1] == pytest.approx(found[0], rel=1e-6)


def test_cards_that_repeat_the_one_before(tmp_path: Path) -> None:
    """Twelve beams in a row by six cards, as the same written out."""
    (tmp_path / "one.bdf").write_text(
        "MAT1,1,2.,,.3\nMAT1,2,==\nGRID,1,,0.,0.,5.\n=,*1,=,*10.,==\n=(11)\nCBAR,21,7,1,2,0.,1.,0.\n=,*2,=,*(1),*1,==\n=2\nENDDATA\n"
    )
    _, other, *found = files.cards(tmp_path / "one.bdf")
    assert other[:5] == ["MAT1", "2", "2.", "", ".3"]
    assert [(card[1], float(card[3]), card[5]) for card in found[:13]] == [(str(n + 1), 10.0 * n, "5.") for n in range(13)]
    assert [card[1:5] for card in found[13:]] == [[str(21 + 2 * n), "7", str(n + 1), str(n + 2)] for n in range(4)]
    for wrong in ("=,*1,==\n", "GRID,1,,0.,0.,5.\n=3\n", "GRID,1,,0.,0.,5.\n=,*1,==\n=99999999\n"):
        (tmp_path / "one.bdf").write_text(wrong)
        with pytest.raises(BadInput, match="repeats no card"):
            list(files.cards(tmp_path / "one.bdf"))


@pytest.mark.parametrize(
    ("text", "ending", "said"),
    [
        ("BEGIN BULK\nINCLUDE 'lost.blk'\nENDDATA\n", "bdf", "line 2`: it includes 'lost.blk', which is not there"),
        ("BEGIN BULK\nINCLUDE 'deck.bdf'\nENDDATA\n", "bdf", "it includes 'deck.bdf', and so itself"),
        ("*INCLUDE, INPUT=lost.inp\n", "inp", "it includes 'lost.inp', which is not there"),
        ("BEGIN BULK\nGRID,1,7,0.,0.,0.\nENDDATA\n", "bdf", "the coordinate system 7 is not there"),
        ("BEGIN BULK\nCORD2R,7,7,0.,0.,0.,0.,0.,1.\n,1.,0.,0.\nGRID,1,7,0.,0.,0.\nENDDATA\n", "bdf", "stands on itself"),
        ("BEGIN BULK\nCORD2R,7,,0.,0.,0.,0.,0.,1.\n,0.,0.,2.\nGRID,1,7,0.,0.,0.\nENDDATA\n", "bdf", "three points on one line"),
        ("BEGIN BULK\nCORD1R,7,1,2,9\nGRID,1,7,0.,0.,0.\nENDDATA\n", "bdf", "stands on grid point 2, which is not there"),
        ("BEGIN BULK\nGRID,1,,0.,0.,0.\nBEGIN SUPER=1\nENDDATA\n", "bdf", "superelements are not read"),
    ],
)
def test_pieces_and_axes_that_are_not_there_are_named(text: str, ending: str, said: str, tmp_path: Path) -> None:
    path = tmp_path / f"deck.{ending}"
    path.write_text(text)
    with pytest.raises(BadInput) as caught:
        deck.described(path)
    assert said in str(caught.value)


def test_grid_points_are_held_as_they_usually_are(tmp_path: Path) -> None:
    """By GRDSET, which stands behind them, but where a point says otherwise."""
    path = tmp_path / "one.bdf"
    grids = [f"GRID,{n},,{x},{y},0." + (",,0" if n == 4 else "") for n, x, y in ((1, 0, 0), (2, 9, 0), (3, 9, 9), (4, 0, 9))]
    rest = ["MAT1,1,210000.,,.3,7.85-9", "PSHELL,1,1,2.,1,,1", "CQUAD4,1,1,1,2,3,4", "GRDSET,,,,,,,123456", "ENDDATA", ""]
    path.write_text("\n".join(["BEGIN BULK", *(f"{one}" for one in grids), *rest]))
    text, lost = deck.described(path)
    assert lost == ()
    assert "nodes = [1, 2, 3]" in text


def test_losses_of_materials_and_of_the_whole(tmp_path: Path) -> None:
    for text, ending, wanted in (
        (nastran("PARAM,G,0.01").replace("MAT1,1,210000.,,.3,7.85-6", "MAT1,1,210000.,,.3,7.85-6,,,.02"), "bdf", [0.03, 0.01]),
        (abaqus().replace("*DENSITY\n2.7e-9", "*DENSITY\n2.7e-9\n*DAMPING, STRUCTURAL=0.04"), "inp", [None, 0.04]),
    ):
        (tmp_path / f"one.{ending}").write_text(text)
        (tmp_path / "one.toml").write_text(deck.described(tmp_path / f"one.{ending}")[0])
        assert [part.loss_factor for part in description.read(tmp_path / "one.toml").parts.values()] == wanted


def cae(place: str) -> str:
    """The cantilever as Abaqus/CAE writes it: a part, its instance, the reference point and sets in the assembly."""
    whole = abaqus()
    head, _, rest = whole.partition("*ELEMENT, TYPE=MASS")
    sections = rest[rest.index("*SOLID SECTION") :]
    materials = rest[rest.index("*MATERIAL") : rest.index("*SOLID SECTION")]
    nodes = "\n".join(line for line in head.splitlines() if not line.startswith(f"{HUB},"))
    x, y, z = NODES[HUB]
    sets = f"*NSET, NSET=Foot, INSTANCE=Beam-1\n{listed(FOOT)}*NSET, NSET=END, INSTANCE=Beam-1\n{listed(END)}"
    mass = "*ELEMENT, TYPE=MASS, ELSET=HEAVY\n1, 1\n*MASS, ELSET=HEAVY\n1.5d-4\n"
    stay = f"*ELEMENT, TYPE=SPRING1, ELSET=STAY\n2, Beam-1.{MIDDLE}\n*SPRING, ELSET=STAY\n3\n200.\n"
    return (
        f"*Heading\n** made\n*PART, NAME=Beam\n{nodes}\n{sections}\n*END PART\n*ASSEMBLY, NAME=Assembly\n"
        f"*INSTANCE, NAME=Beam-1, PART=Beam\n{place}*END INSTANCE\n*NODE\n1, {x}, {y}, {z}\n"
        f"*NSET, NSET=ref\n1,\n{sets}{mass}{stay}"
        f"*RIGID BODY, REF NODE=ref, TIE NSET=END\n*END ASSEMBLY\n{materials}*BOUNDARY\nFoot, 1\nFoot, 2, 3\n"
    )


def test_a_deck_of_abaqus_cae_is_the_same_structure(tmp_path: Path) -> None:
    one, other = frequencies(abaqus(), tmp_path, "inp"), frequencies(cae(""), tmp_path, "inp")
    np.testing.assert_allclose(one, other, rtol=1e-12)


def test_instances_stand_where_the_assembly_has_them(tmp_path: Path) -> None:
    """Twice the same bar, shifted, and shifted and turned by a quarter about a line along z; sets by their instances."""
    part = "*PART, NAME=bar\n*NODE\n1,0,0,0\n2,10,0,0\n*ELEMENT, TYPE=B31, ELSET=all\n1, 1, 2\n*NSET, NSET=tip\n2\n"
    part += "*BEAM SECTION, SECTION=RECT, ELSET=all, MATERIAL=m\n2., 2.\n*END PART\n*ASSEMBLY, NAME=a\n"
    one = "*INSTANCE, NAME=left, PART=bar\n5., 0., 0.\n*END INSTANCE\n"
    two = "*INSTANCE, NAME=right, PART=bar\n0., 1., 0.\n0., 1., 0., 0., 1., 1., 90.\n*END INSTANCE\n"
    rest = "*NSET, NSET=both\nleft.1, right.tip\n*END ASSEMBLY\n*MATERIAL, NAME=m\n*ELASTIC\n210000.,.3\n*DENSITY\n7.85e-9\n"
    (tmp_path / "two.inp").write_text(f"{part}{one}{two}{rest}*BOUNDARY\nright.tip, ENCASTRE\nleft.1, 1, 3\n")
    mesh = files.read(tmp_path / "two.inp")
    assert mesh.node_tags.tolist() == [1, 2, 11, 12]
    np.testing.assert_allclose(mesh.points, [[5, 0, 0], [15, 0, 0], [0, 1, 0], [0, 11, 0]], atol=1e-12)
    assert set(mesh.groups) == {"left.all", "right.all"}
    assert mesh.node_tags[mesh.nodes_of("both")].tolist() == [1, 12]
    text, lost = deck.described(tmp_path / "two.inp")
    assert '[fe_model.parts."right.all"]' in text
    assert lost == ()
    assert 'nodes = ["right.tip"]' in text
    assert 'interface = ["clamp"]' in text
    assert '[fe_model.holds."x-y-z"]\nnodes = [1]\n' in text
    (tmp_path / "two.inp").write_text(f"{part}{one.replace('PART=bar', 'PART=rod')}{rest}")
    with pytest.raises(BadInput, match="of the part 'rod', which is not here"):
        files.read(tmp_path / "two.inp")


def test_an_abaqus_deck_in_pieces_is_the_same_structure(tmp_path: Path) -> None:
    whole = abaqus()
    nodes, rest = whole[: whole.index("*ELEMENT")], whole[whole.index("*ELEMENT") :]
    (tmp_path / "nodes.txt").write_text(nodes.partition("\n")[2])
    (tmp_path / "rest.inp").write_text(rest)
    pieces = "*NODE, NSET=ALL,\n INPUT=nodes.txt\n*INCLUDE, INPUT=C:\\models\\rest.inp\n"
    one, other = frequencies(whole, tmp_path, "inp"), frequencies(pieces, tmp_path, "INP".lower())
    np.testing.assert_allclose(one, other, rtol=1e-12)


@pytest.mark.calculix
def test_calculix_has_the_frequencies_of_its_deck(tmp_path: Path) -> None:
    """Mass, rigid end and spring among them; without the rigid end they are others by a tenth and more."""
    if shutil.which("ccx") is None:
        pytest.skip("CalculiX is not installed: apt-get install calculix-ccx")
    text = abaqus("*STEP\n*FREQUENCY\n6\n*END STEP\n")
    own = frequencies(text, tmp_path, "inp")
    quiet = {**os.environ, "OMP_NUM_THREADS": "1"}
    done = subprocess.run(["ccx", "beam"], cwd=tmp_path, env=quiet, capture_output=True, text=True, timeout=300, check=False)
    assert "*ERROR" not in done.stdout, done.stdout
    rows = [line.split() for line in (tmp_path / "beam.dat").read_text().splitlines() if re.match(r" +\d+ +0\.\d+E", line)]
    there = np.array([float(row[3]) for row in rows if len(row) == 5][:6])
    np.testing.assert_allclose(own, there, rtol=1e-4)


@pytest.mark.parametrize("name", KNOWN)
def test_units_are_told_by_the_materials(name: str, tmp_path: Path) -> None:
    units = unit_system(name, "here")
    E, rho = 210e9 * units.length * units.time**2 / units.mass, 7850 * units.length**3 / units.mass
    nodes = [f"GRID,{n},,{x},{y},{z}" for n, (x, y, z) in enumerate([(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)], start=1)]
    path = tmp_path / "one.bdf"
    path.write_text(
        "\n".join(["BEGIN BULK", *nodes, "CTETRA,1,1,1,2,3,4", "PSOLID,1,1", f"MAT1,1,{E:.6g},,.3,{rho:.6g}", "ENDDATA", ""])
    )
    text, _ = deck.described(path)
    assert f'units = "{name}"' in text
    assert float(re.findall(r'density = "([\d.]+) ', text)[0]) == pytest.approx(7850, rel=1e-5)
    assert 'support = "free"' in text


PLATE = [
    "BEGIN BULK",
    *(card("GRID", n, "", *p) for n, p in enumerate([(0, 0, 0), (100, 0, 0), (100, 50, 0), (0, 50, 0), (0, 0, 80)], start=1)),
    *("MAT1,1,210000.,,.3,7.85-9", "PSHELL,1,1,2.,1,,1,,1.57-8", "CQUAD4,1,1,1,2,3,4", "SPC1,1,123456,1,2"),
]


def test_shells_and_beams_have_their_sections(tmp_path: Path) -> None:
    beams = [
        card("PBARL", 2, 1, "", "BAR", *4 * [""], 10.0, 20.0),
        "CBAR,2,2,1,5,1.,0.,0.",
        "PBAR,3,1,100.,900.,400.,800.",
        "CBAR,3,3,4,5,1.,0.,0.",
    ]
    path = tmp_path / "one.bdf"
    path.write_text("\n".join([*PLATE, *beams, "ENDDATA", ""]))
    text, lost = deck.described(path)
    assert lost == ()
    (tmp_path / "one.toml").write_text(text)
    found = description.read(tmp_path / "one.toml")
    assert found.parts["1"].thickness == pytest.approx(2e-3)
    assert found.parts["1"].material.density == pytest.approx(2 * 7850)  # the mass per area doubles it
    assert found.parts["2"].section is not None
    assert found.parts["2"].section.sizes == (0.01, 0.02)
    assert found.parts["3"].section is not None
    np.testing.assert_allclose(found.parts["3"].section.sizes, [1e-4, 9e-10, 4e-10, 8e-10])
    made = model.load(tmp_path / "one.toml")[1]
    assert made.rigid_mass[0, 0] > 0
    assert [one.axes.tolist() for one in made.elements.blocks if one.part == "2"] == [[[1, 0, 0]]]


@pytest.mark.parametrize(
    ("deck_text", "ending", "walls"),
    [
        ("PBARL,2,1,,BOX,,,,,\n,60.,100.,8.,5.,7.85-6", "bdf", lambda y, z: (abs(y) > 25) | (abs(z) > 42)),
        ("PBARL,2,1,,I,,,,,\n,100.,60.,60.,5.,8.,8.,7.85-6", "bdf", lambda y, z: (abs(y) < 2.5) | (abs(z) > 42)),
        (
            "PBARL,2,1,,I,,,,,\n,100.,40.,60.,5.,8.,6.,7.85-6",
            "bdf",
            lambda y, z: (abs(y) < 2.5) | (z > 44) | ((z < -42) & (abs(y) < 20)),
        ),
        ("PBARL,2,1,,I1\n,55.,5.,84.,100.,7.85-6", "bdf", lambda y, z: (abs(y) < 2.5) | (abs(z) > 42)),
        ("PBARL,2,1,,T2\n,60.,100.,8.,5.,7.85-6", "bdf", lambda y, z: (z < -42) | (abs(y) < 2.5)),
        ("PBARL,2,1,,CHAN1\n,55.,5.,84.,100.,7.85-6", "bdf", lambda y, z: (abs(z) > 42) | (y > 25)),
        ("PBARL,2,1,,T,,,,,\n,60.,100.,8.,5.,7.85-6", "bdf", lambda y, z: (z > 42) | (abs(y) < 2.5)),
        ("PBARL,2,1,,L,,,,,\n,60.,100.,8.,5.,7.85-6", "bdf", lambda y, z: (z < -42) | (y > 25)),  # its y is -z of Nastran
        ("PBARL,2,1,,CHAN,,,,,\n,60.,100.,5.,8.,7.85-6", "bdf", lambda y, z: (abs(z) > 42) | (y > 25)),
        (
            "PBARL,2,1,,HAT,,,,,\n,100.,5.,40.,10.,7.85-6",
            "bdf",
            lambda y, z: np.where(abs(y) < 20, (z > 45) | (abs(y) > 15), z < -45),
        ),
        (
            "*BEAM SECTION, SECTION=I, ELSET=b, MATERIAL=m\n30., 60., 100., 100., 8., 8., 5.\n0., 1., 0.",
            "inp",
            lambda y, z: (abs(z) < 2.5) | (abs(y) > 22),
        ),
        (
            "*BEAM SECTION, SECTION=BOX, ELSET=b, MATERIAL=m\n100., 60., 8., 5., 8., 5.\n0., 0., 1.",
            "inp",
            lambda y, z: (abs(y) > 25) | (abs(z) > 42),
        ),
    ],
)
def test_hollow_and_open_sections(deck_text: str, ending: str, walls: Callable[[Array, Array], Array], tmp_path: Path) -> None:
    """60 wide and 100 high: area and second moments by a sum over squares of a quarter of a millimetre; torsion in its bounds."""
    bdf = "BEGIN BULK\nGRID,1,,0.,0.,0.\nGRID,2,,900.,0.,0.\nMAT1,1,210000.,,.3,7.85-9\nCBAR,1,2,1,2,0.,0.,1.\nENDDATA\n"
    inp = (
        "*NODE\n1,0,0,0\n2,900,0,0\n*ELEMENT,TYPE=B31,ELSET=b\n1,1,2\n*MATERIAL,NAME=m\n*ELASTIC\n210000.,.3\n*DENSITY\n7.85e-9\n"
    )
    path = tmp_path / f"one.{ending}"
    path.write_text(f"{inp}{deck_text}\n" if ending == "inp" else bdf.replace("ENDDATA", f"{deck_text}\nENDDATA"))
    text, lost = deck.described(path, "mm-t-N-s")
    (tmp_path / "one.toml").write_text(text)
    (part,) = description.read(tmp_path / "one.toml").parts.values()
    assert lost == ()
    assert part.section is not None
    y, z = np.meshgrid(np.arange(-29.875, 30, 0.25), np.arange(-49.875, 50, 0.25))
    there = walls(y, z)
    y, z = (one - np.sum(there * one) / np.sum(there) for one in (y, z))
    wanted = [float(np.sum(there * one)) / 16 for one in (np.ones_like(y), z**2, y**2)]
    np.testing.assert_allclose(np.array(part.section.sizes[:3]) * [1e6, 1e12, 1e12], wanted, rtol=1e-4)
    assert part.section.product * 1e12 == pytest.approx(float(np.sum(there * y * z)) / 16, abs=1e-4 * wanted[2])
    torsion, polar = part.section.sizes[3] * 1e12, wanted[1] + wanted[2]
    assert (0.5 if "BOX" in deck_text else 0.005) * polar < torsion < (1.0 if "BOX" in deck_text else 0.05) * polar
    assert part.material.density == pytest.approx(7850 + (7.85e-6 * 1e12 / wanted[0] if ending == "bdf" else 0))
    assert (part.z_axis is None) == (ending == "bdf")  # of Nastran the elements say it


@pytest.mark.parametrize(
    ("kind", "sizes", "beside"),
    [  # of mid-lines by hand: a channel's is 24.64 mm behind its web, and its middle 19.13 mm before it
        ("CHAN", (60.0, 100.0, 5.0, 8.0), (-43.77, 0.0)),
        ("T", (60.0, 100.0, 8.0, 5.0), (0.0, -24.47)),
        ("L", (60.0, 60.0, 6.0, 6.0), (-14.21, 14.21)),
        ("I", (100.0, 60.0, 60.0, 5.0, 8.0, 8.0), (0.0, 0.0)),
    ],
)
def test_a_beam_of_plates_twists_about_its_shear_centre(
    kind: str, sizes: tuple[float, ...], beside: tuple[float, float], tmp_path: Path
) -> None:
    bdf = ["BEGIN BULK", "GRID,1,,0.,0.,0.", "GRID,2,,900.,0.,0.", "MAT1,1,210000.,,.3,7.85-9", "CBEAM,1,2,1,2,0.,0.,1."]
    (tmp_path / "one.bdf").write_text("\n".join([*bdf, f"PBEAML,2,1,,{kind}\n,{','.join(map(str, sizes))}", "ENDDATA", ""]))
    text, lost = deck.described(tmp_path / "one.bdf", "mm-t-N-s")
    (tmp_path / "one.toml").write_text(text)
    (part,) = description.read(tmp_path / "one.toml").parts.values()
    assert lost == ()
    assert part.section is not None
    np.testing.assert_allclose(1e3 * np.array(part.section.neutral_axis), beside, atol=0.01)


def test_a_spring_to_a_node_that_is_held_and_carries_nothing_is_to_the_ground(tmp_path: Path) -> None:
    """It was between two places, one of which no element has, of a structure that was said to be free."""
    ground = ["GRID,77,,0.,0.,0.", "PBUSH,9,K,5.,5.,5.", "CBUSH,9,9,77,1,,,,0", "SPC1,1,123,77"]
    (tmp_path / "one.bdf").write_text("\n".join([*PLATE, *ground, "ENDDATA", ""]))
    text, lost = deck.described(tmp_path / "one.bdf", "mm-t-N-s")
    (tmp_path / "one.toml").write_text(text)
    found = description.read(tmp_path / "one.toml")
    assert lost == ()
    assert [one.at for one in found.springs.values()] == [(1,)]
    assert found.support == "ground"


def test_springs_that_a_deck_draws_direction_by_direction_are_one_support(tmp_path: Path) -> None:
    """Soil is softer every way: six supports of a node took more names than a diagnosis may give, and other names were given."""
    apart = [card("CELAS2", 20 + k, 50.0 * k, 4, k) for k in (1, 2, 3)]
    other = ["CELAS2,27,9.,4,3,,,.2", "CELAS2,28,7.,3,3", "CELAS2,29,5.,3,3"]
    (tmp_path / "one.bdf").write_text("\n".join([*PLATE, *apart, *other, "ENDDATA", ""]))
    text, lost = deck.described(tmp_path / "one.bdf", "mm-t-N-s")
    (tmp_path / "one.toml").write_text(text)
    found = description.read(tmp_path / "one.toml").springs
    assert lost == ()
    assert {name: [*one.stiffness[:3] / 1e3] for name, one in found.items()} == {
        "CELAS2 21": [50.0, 100.0, 150.0],
        "CELAS2 27": [0.0, 0.0, 9.0],  # loses otherwise
        "CELAS2 28": [0.0, 0.0, 7.0],
        "CELAS2 29": [0.0, 0.0, 5.0],  # beside another along the same axis
    }
    assert "# CELAS2 21, CELAS2 22, CELAS2 23 as one; write those apart that are not" in text


@pytest.mark.parametrize(
    "spring", ["CELAS2,9,5.,4,3,,,.04", "PELAS,7,5.,.04\nCELAS1,9,7,4,3", "PBUSH,7,K,,,5.,,,\n,,GE,.04\nCBUSH,9,7,4,,,,,0"]
)
def test_springs_lose_what_they_state_and_what_the_whole_does(spring: str, tmp_path: Path) -> None:
    (tmp_path / "one.bdf").write_text("\n".join([*PLATE, *spring.split("\n"), "PARAM,G,.01", "ENDDATA", ""]))
    text, lost = deck.described(tmp_path / "one.bdf", "mm-t-N-s")
    (tmp_path / "one.toml").write_text(text)
    assert lost == ()
    assert [one.loss_factor for one in description.read(tmp_path / "one.toml").springs.values()] == [0.05]


def test_the_node_of_a_rigid_link_is_a_place_by_its_number(tmp_path: Path) -> None:
    """A sensor at the node of an RBE2 was refused."""
    (tmp_path / "one.bdf").write_text(nastran())
    (tmp_path / "one.toml").write_text(deck.described(tmp_path / "one.bdf", "mm-t-N-s")[0])
    made = model.load(tmp_path / "one.toml")[1]
    assert made.elements is not None
    at = made.elements.numbered(HUB)
    assert at is not None
    assert abs(at - made.places["RBE2 99"]).max() == 0


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("RBE3,9,,5,123,1.,123,1,2,\n,,2.,12,3", "RBE3 9: what leads leaves open how a rigid body moves"),
        ("RBAR,9,1,5,123,45", "RBAR 9: what leads leaves open how a rigid body moves"),
        ("RBE2,9,1,123456,4,1.2-5\nMPC,9,1,1,1.,5,0,1.", "MPC 1: a scalar point is in it"),
        ("MPC,9,1,1,1.,5,1,1.\nMPC,8,1,1,1.,5,1,1.", "MPC sets 9, 8: more than one, and none that is called alone"),
        ("PROD,2,1,5.,7.\nCROD,2,2,1,5", "PROD 2: its stiffness in torsion"),
        ("PBUSH,9,K,5.,5.,5.\n,,M,2.\nCBUSH,9,9,1,,,,,0", "PBUSH 9: its mass (M)"),
        ("PTUBE,2,1,9.,1.,,7.\nCTUBE,2,2,1,5", "PTUBE 2: a taper"),
        ("CONM2,9,1,,-5.", "CONM2 9: its mass is not above zero"),
        ("PBAR,2,1,9.,9.,9.\nCBAR,2,2,1,5,1.,0.,0.", "PBAR 2: it has no stiffness in torsion (J), and twists freely"),
        ("PBEAML,2,1,,BAR\n,9.,5.,0.,YES,1.,9.,4.\nCBEAM,2,2,1,5,1.,0.,0.", "PBEAML 2: a taper"),
        ("RBE2,9,1,123456", "RBE2 9: it joins no node"),
        ("RBE3,9,,5,123,1.,123", "RBE3 9: it joins no node"),
        ("CONN2,9,1,,5.", "CONN2 9: a card that is not known here"),
        ("PCOMP,5,,,,,,,MEM\n,1,1.,0.", "PCOMP 5: its layers are to be taken as MEM"),
        ("PCOMP,5\n,7,1.,0.\nCTRIA3,7,5,1,2,5", "part 5: no material 7 that is known here"),
        ("CELAS2,9,5.,1,1,3,2", "CELAS2 9: it joins two different motions"),
        ("PBARL,2,1,,HEXA\n,1.,1.,1.\nCBAR,2,2,1,5,1.,0.,0.", "PBARL 2: a section of kind HEXA"),
        ("PBEAML,2,1,,HAT,,,,,\n,90.,5.,40.,9.\nCBEAM,2,2,1,5,1.,0.,0.", "PBEAML 2: where a hat has its shear centre"),
        ("GRID,77,,0.,0.,0.\nPBUSH,9,K,5.,5.,5.\nCBUSH,9,9,1,77,,,,0", "CBUSH 9: it ends at a node that nothing else is at"),
        ("PBEAM,2,1,100.,900.,400.,,800.\n\n,YESA,1.,50.\nCBEAM,2,2,1,5,1.,0.,0.", "PBEAM 2: a taper"),
        ("CTRIA3,7,1,1,2,5,,,,,\n,,,2.,3.,2.", "property 1: some of its shells have thicknesses of their own"),
        ("CQUADR,7,1,1,2,3,4,,,,\n,,,2.,3.,2.,2.", "property 1: some of its shells have thicknesses of their own"),
    ],
)
def test_what_is_not_carried_over_is_said_and_ends_with_one(
    more: str, words: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "one.bdf"
    path.write_text("\n".join([*PLATE, more, "ENDDATA", ""]))
    assert main.run(["model", str(path), "--out", str(tmp_path / "one.toml")]) == 1
    assert words in " ".join(capsys.readouterr().err.split())
    assert words in (tmp_path / "one.toml").read_text()


@pytest.mark.parametrize(
    ("text", "arguments", "words"),
    [
        ("BEGIN BULK\nGRID,1\n", (), "it holds no elements"),
        ("\n".join(PLATE).replace("7.85-9", ""), (), "no material states a density"),
        ("\n".join(PLATE).replace("7.85-9", "7.85+2"), (), "its units cannot be told: none of m-kg-N-s"),
        ("\n".join(PLATE), ("--units", "mm-kg-N-s"), "the force of mm-kg-N-s"),
        ("\n".join(PLATE), ("--test", "test.toml"), "Name the study"),
        ("\n".join(PLATE), ("--out", "../one.toml"), "a description lies beside the deck"),
        ("\n".join(PLATE).replace("2.,1,,1", "two,1,,1"), (), "a record of it cannot be read"),
    ],
)
def test_what_cannot_be_described_is_refused(
    text: str,
    arguments: tuple[str, ...],
    words: str,
    tmp_path: Path,
    monkeypatch: pytest.MonkeyPatch,
    capsys: pytest.CaptureFixture[str],
) -> None:
    (tmp_path / "in").mkdir()
    monkeypatch.chdir(tmp_path / "in")
    Path("one.bdf").write_text(text + "\nENDDATA\n")
    assert main.run(["model", "one.bdf", *arguments]) == 2
    assert words in " ".join(capsys.readouterr().err.split())
    assert not (tmp_path / "one.toml").exists()


def test_a_deck_and_its_test_become_description_and_study_in_one_step(
    tmp_path: Path, monkeypatch: pytest.MonkeyPatch, capsys: pytest.CaptureFixture[str]
) -> None:
    monkeypatch.chdir(tmp_path)
    Path("one.bdf").write_text("\n".join([*PLATE, "ENDDATA", ""]))
    Path("test.toml").write_text(
        'format = 1\nkind = "modal-table"\nfrequencies = ["300 Hz", "900 Hz"]\nfrequency_deviation = 0.01\n'
    )
    asked = ["model", "one.bdf", "--test", "test.toml", "--out", "study.toml"]
    assert main.run(asked) == 0
    assert capsys.readouterr().err.splitlines() == ["massline: wrote one.toml.", "massline: wrote study.toml."]
    assert main.run(["check", "study.toml"]) == 0
    edited = Path("one.toml").read_text() + "# mine\n"
    Path("one.toml").write_text(edited)
    assert main.run([*asked, "--force"]) == 0  # the study alone: what a description says may be one's own by now
    assert Path("one.toml").read_text() == edited
    assert main.run([*asked, "--force", "--units", "mm-t-N-s"]) == 2
    assert "states its units" in " ".join(capsys.readouterr().err.split())


def test_units_are_of_a_deck_alone(capsys: pytest.CaptureFixture[str]) -> None:
    assert main.run(["model", "fmd+cuboid", "--units", "mm-t-N-s"]) == 2
    assert "only a deck states none" in " ".join(capsys.readouterr().err.split())


def test_what_a_description_leaves_out_is_named_right(tmp_path: Path) -> None:
    path = tmp_path / "one.bdf"
    path.write_text("\n".join([*PLATE, "ENDDATA", ""]))
    text = deck.described(path)[0].replace("interface", "left_out = 3\ninterface")
    (tmp_path / "one.toml").write_text(text)
    with pytest.raises(BadInput, match="a list of cards or keywords"):
        description.read(tmp_path / "one.toml")


@pytest.mark.parametrize("command", ["reference", "modes", "compare", "diagnose", "model --examine"])
def test_every_command_says_how_a_deck_becomes_a_description(
    command: str, tmp_path: Path, capsys: pytest.CaptureFixture[str]
) -> None:
    path = tmp_path / "one.bdf"
    path.write_text("\n".join(PLATE))
    assert main.run([*command.split(), str(path)]) == 2
    assert "Describe its structure first: massline model" in " ".join(capsys.readouterr().err.split())


@pytest.mark.parametrize("end", ["ENDDATA\n", ""])
def test_a_deck_that_may_be_cut_short_is_said_to_be(end: str, tmp_path: Path) -> None:
    (tmp_path / "one.bdf").write_text("\n".join([*PLATE, end]))
    (tmp_path / "one.inp").write_text(abaqus("*STEP\n*STATIC\n" + end.replace("ENDDATA", "*END STEP")))
    for ending in ("bdf", "inp"):
        lost = deck.described(tmp_path / f"one.{ending}")[1]
        assert ("may be cut short" in "".join(lost)) == (not end)


@pytest.mark.parametrize("moved", ["123456", "123"])
def test_a_link_is_held_where_the_node_that_carries_it_is(moved: str, tmp_path: Path) -> None:
    """Clamped by its hub; held in translations alone the hub may turn."""
    hub = [card("GRID", 7, "", -30.0, 25.0, 10.0), card("RBE2", 8, 7, "123456", 1, 2), card("SPC1", 1, moved, 7)]
    lines = [line for line in PLATE if not line.startswith("SPC1")]
    (tmp_path / "one.bdf").write_text("\n".join([*lines, *hub, "ENDDATA", ""]))
    text, lost = deck.described(tmp_path / "one.bdf")
    (tmp_path / "one.toml").write_text(text)
    if moved == "123":
        (one,) = description.read(tmp_path / "one.toml").holds.values()
        assert (lost, one.nodes, one.directions) == ((), ("RBE2 8",), (0, 1, 2))
        swings = model.load(tmp_path / "one.toml")[1]
        with pytest.raises(CheckFailed, match="a joint of it swings"):
            lowest(swings.stiffness, swings.mass, 6)
        return
    assert (lost, description.read(tmp_path / "one.toml").interface) == ((), ("RBE2 8",))
    held = model.load(tmp_path / "one.toml")[1]
    (tmp_path / "one.bdf").write_text("\n".join([*PLATE, "ENDDATA", ""]))
    (tmp_path / "one.toml").write_text(deck.described(tmp_path / "one.bdf")[0])
    plain = model.load(tmp_path / "one.toml")[1]
    found, wanted = (lowest(one.stiffness, one.mass, 6).values for one in (held, plain))
    np.testing.assert_allclose(found, wanted, rtol=1e-4)  # a clamp that may give, and gives nothing yet
    assert [one.partition("@")[0] for one in held.joints] == ["RBE2 8"]


def test_a_kind_of_card_is_left_out_of_the_mesh_only_if_all_of_them_are_stated(tmp_path: Path) -> None:
    (tmp_path / "one.bdf").write_text("\n".join([*PLATE, "CELAS2,8,5.,1,1", "CELAS2,9,5.,1,1,3,2", "ENDDATA", ""]))
    text, lost = deck.described(tmp_path / "one.bdf")
    (tmp_path / "one.toml").write_text(text)
    assert lost == ("CELAS2 9: it joins two different motions, or its stiffness is not here",)
    with pytest.raises(BadInput, match="CELAS2 8 is not read"):
        model.load(tmp_path / "one.toml")


STEEL = "MAT1,1,210000.,,.3,7.85-9"
AREA, SPAN, RISE, TOP = 40.0, 300.0, 400.0, 0.05
"""[mm², mm, mm, t] of two rods that lean against each other, and what they carry."""


@pytest.mark.parametrize(
    ("bars", "ending"),
    [
        (f"CROD,1,1,1,3\nCROD,2,1,2,3\nPROD,1,1,{AREA}", "bdf"),
        (f"CONROD,1,1,3,1,{AREA}\nCONROD,2,2,3,1,{AREA}", "bdf"),
        (f"CTUBE,1,1,1,3\nCTUBE,2,1,2,3\nPTUBE,1,1,{(AREA + 4 * np.pi) / (2 * np.pi):.9f},2.", "bdf"),
        (f"*ELEMENT, TYPE=T3D2, ELSET=BARS\n1,1,3\n2,2,3\n*SOLID SECTION, ELSET=BARS, MATERIAL=M\n{AREA}", "inp"),
    ],
)
def test_rods_push_and_pull_and_are_held_where_they_are_pinned(bars: str, ending: str, tmp_path: Path) -> None:
    """Of the two rods that carry a mass: omega² = 2 E A cos² / L over the mass and a third of each rod, in closed form."""
    points = {1: (-SPAN, 0.0, 0.0), 2: (SPAN, 0.0, 0.0), 3: (0.0, 0.0, RISE)}
    grid = [f"{n},,{x},{y},{z}" for n, (x, y, z) in points.items()]
    if ending == "bdf":
        lines = ["BEGIN BULK", *(f"GRID,{one}" for one in grid), STEEL, bars, f"CONM2,9,3,,{TOP}"]
        lines += ["SPC1,1,123456,1,2", "SPC1,1,2,3", "ENDDATA"]
    else:
        lines = ["*NODE", *(one.replace(",,", ",") for one in grid), bars, "*ELEMENT, TYPE=MASS, ELSET=TOP\n9,3"]
        lines += [f"*MASS, ELSET=TOP\n{TOP}", "*MATERIAL, NAME=M\n*ELASTIC\n210000.,.3\n*DENSITY\n7.85e-9"]
        lines += ["*BOUNDARY\n1,1,6\n2,1,3\n3,2"]
    (tmp_path / f"one.{ending}").write_text("\n".join([*lines, ""]))
    written, lost = deck.described(tmp_path / f"one.{ending}")
    assert lost == ()
    (tmp_path / "one.toml").write_text(written)
    made = model.load(tmp_path / "one.toml")[1]
    assert made.mass.shape == (2, 2)  # the top along x and z; a rod turns nothing
    length = float(np.hypot(SPAN, RISE))
    moving = 1e3 * (TOP + 2 * 7.85e-9 * AREA * length / 3)  # kg
    wanted = [2 * 210e3 * AREA / length * 1e3 * (part / length) ** 2 / moving for part in (SPAN, RISE)]
    np.testing.assert_allclose(eigh(made.stiffness.toarray(), made.mass.toarray(), eigvals_only=True), wanted, rtol=1e-6)
    row = made.elements.rows([[-SPAN / 2e3, 0.0, RISE / 2e3]])[0].toarray()
    np.testing.assert_allclose(row, [[0.5, 0], [0, 0], [0, 0.5]], atol=1e-12)
    (tmp_path / "one.toml").write_text(re.sub(r"area = ", "length = ", written))
    with pytest.raises(BadInput, match="or area alone, found length"):
        description.read(tmp_path / "one.toml")


def test_a_beam_on_two_bearings_is_held_in_some_directions(tmp_path: Path) -> None:
    """Pinned at one end, on a roller at the other, out of plane nowhere: Euler's beam on two supports."""
    count, length, side = 24, 2400.0, 20.0
    grid = [f"GRID,{k + 1},,{k * length / count},0.,0." for k in range(count + 1)]
    bars = [f"CBAR,{k + 1},1,{k + 1},{k + 2},0.,0.,1." for k in range(count)]
    inertia = side**4 / 12
    cards = [f"PBAR,1,1,{side**2},{inertia},{inertia},{2 * inertia}", "SPC1,1,1234,1", f"SPC1,1,23,{count + 1}"]
    flat = f"SPC1,1,246,1,THRU,{count + 1}"
    (tmp_path / "one.bdf").write_text("\n".join(["BEGIN BULK", *grid, *bars, STEEL, *cards, flat, "ENDDATA", ""]))
    written, lost = deck.described(tmp_path / "one.bdf")
    assert lost == ()
    (tmp_path / "one.toml").write_text(written)
    found = description.read(tmp_path / "one.toml")
    assert {name: len(one.nodes) for name, one in found.holds.items()} == {
        "x-y-z-alpha-gamma": 1,
        "y-z-alpha-gamma": 1,
        "y-alpha-gamma": count - 1,
    }
    made = model.load(tmp_path / "one.toml")[1]
    values = lowest(made.stiffness, made.mass, 2).values
    euler = np.array([1, 4]) ** 2 * np.pi**4 * 210e9 * side**2 / 12 / (7850 * (length / 1e3) ** 4) * 1e-6
    np.testing.assert_allclose(values, euler, rtol=2e-3)
    assert made.translations.min() == -1
    assert len(made.points) == count  # all but the pinned end, which stands still


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ('holds = { a = { nodes = [3], directions = ["z"] } }\nsupport = "base"\n', "left out where a base carries"),
        ('holds = { a = { nodes = [3], directions = ["up"] } }\n', "a list of some of x, y, z, alpha"),
        ("holds = { a = { nodes = [3], directions = [] } }\n", "a list of some of x, y, z, alpha"),
        ('holds = { a = { nodes = [], directions = ["z"] } }\n', "Name the nodes that are meant"),
        ('holds = { a = { nodes = [77], directions = ["z"] } }\n', "no element of the parts has a node 77"),
        (
            'holds = { a = { nodes = [3], directions = ["z"] } }\nlinks.b = { at = ["0 m", "0 m", "1 m"], nodes = [3, 4] }\n',
            "rides on a link",
        ),
        ('links.b = { at = ["0 m", "0 m", "1 m"], mean_of = [3, 4], directions = ["x"] }\n', "left out beside `mean_of`"),
        ('links.b = { at = ["0 m", "0 m", "1 m"], mean_of = [3, 4], weights = [1, inf] }\n', "a list of positive numbers"),
        ('links.b = { at = ["0 m", "0 m", "1 m"], mean_of = [3, 4], rotations = 1 }\n', "true or false"),
    ],
)
def test_what_holds_in_some_directions_is_said_right(more: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "one.bdf").write_text("\n".join([*PLATE, "ENDDATA", ""]))
    written = deck.described(tmp_path / "one.bdf")[0]
    written = re.sub(r"support = .*\n", "", written) if "support" in more else written
    (tmp_path / "one.toml").write_text(written.replace("[fe_model]\n", f"[fe_model]\n{more}"))
    with pytest.raises(BadInput, match=words):
        model.load(tmp_path / "one.toml")


@pytest.mark.parametrize(
    "comment",
    [
        '$HMNAME PROP                   1"wall plate" 4',
        "$ Femap Property 1 : wall plate",
        "$ANSA_NAME_COMMENT;1;PSHELL;wall plate;;NO;NO;NO;NO;",
        "$ Elements and Element Properties for region : wall plate",
        "$*  Property: wall plate",
    ],
)
def test_a_part_is_called_what_the_deck_calls_its_property(comment: str, tmp_path: Path) -> None:
    """By its number as well, so that descriptions of before hold."""
    lines = [part for line in PLATE for part in ((comment, line) if line.startswith("PSHELL") else (line,))]
    (tmp_path / "one.bdf").write_text("\n".join([*lines, "ENDDATA", ""]))
    written, lost = deck.described(tmp_path / "one.bdf")
    assert ('[fe_model.parts."wall plate"]' in written, lost) == (True, ())
    for text in (written, written.replace('"wall plate"', '"1"')):
        (tmp_path / "one.toml").write_text(text)
        assert model.load(tmp_path / "one.toml")[1].mass.shape == (18, 18)  # and the clamp


def test_a_name_changes_nothing_but_the_name(tmp_path: Path) -> None:
    """Rods whose property has a name turn no node; what stands between the parts of an effect's name is no part of one."""
    lines = ["BEGIN BULK", "GRID,1,,0.,0.,0.", "GRID,2,,300.,0.,0.", "GRID,3,,0.,400.,300.", STEEL, "PROD,1,1,40."]
    lines += ["CROD,1,1,1,3", "CROD,2,1,2,3", "SPC1,1,123,1,2", "SPC1,1,3,3", "CONM2,9,3,,.1", "ENDDATA", ""]
    written = []
    for comment in ("", '$HMNAME PROP 1"web: left=1"', '$HMNAME PROP 1"CONM2 9"'):
        (tmp_path / "one.bdf").write_text("\n".join([*lines[:5], comment, *lines[5:]]))
        text, lost = deck.described(tmp_path / "one.bdf")
        assert lost == ()
        (tmp_path / "one.toml").write_text(text)
        assert model.load(tmp_path / "one.toml")[1].mass.shape == (2, 2)
        written.append(text)
    assert written[1].replace('"web- left-1"', '"1"') == written[0] == written[2]


def test_a_fin_on_solids_stays_welded_where_it_is_held_in_one_rotation(tmp_path: Path) -> None:
    """Held about one axis it is stiffer, not loose about the others."""
    number = {(i, j, k): 1 + i + 3 * j + 9 * k for k in range(2) for j in range(3) for i in range(3)}
    lines = ["BEGIN BULK", STEEL, "PSOLID,1,1", "PSHELL,2,1,5.,1,,1", "SPC1,1,123,1,THRU,9"]
    lines += [f"GRID,{n},,{100.0 * i},{100.0 * j},{100.0 * k}" for (i, j, k), n in number.items()]
    for i, j in product(range(2), range(2)):
        ring = [number[i + a, j + b, k] for k in (0, 1) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1))]
        lines.append(card("CHEXA", 10 + 2 * i + j, 1, *ring))
    fin = {(j, k): 100 + j + 3 * k for k in (1, 2) for j in range(3)} | {(j, 0): number[1, j, 1] for j in range(3)}
    lines += [f"GRID,{fin[j, k]},,100.,{100.0 * j},{100.0 + 100.0 * k}" for k in (1, 2) for j in range(3)]
    lines += [
        f"CQUAD4,{20 + 2 * k + j},2,{fin[j, k]},{fin[j + 1, k]},{fin[j + 1, k + 1]},{fin[j, k + 1]}"
        for k, j in product(range(2), range(2))
    ]
    found = []
    for letters in ("", "4", "46", "456"):
        held = [f"SPC1,1,{letters},{','.join(str(fin[j, 0]) for j in range(3))}"] if letters else []
        (tmp_path / "one.bdf").write_text("\n".join([*lines, *held, "ENDDATA", ""]))
        text, lost = deck.described(tmp_path / "one.bdf")
        assert lost == ()
        (tmp_path / "one.toml").write_text(text)
        made = model.load(tmp_path / "one.toml")[1]
        found.append(lowest(made.stiffness, made.mass, 1).values[0])
    assert (np.diff(found) > -1e-9 * found[0]).all()
    assert found[0] > (2 * np.pi * 90) ** 2


def test_a_base_carries_no_node_that_rides_on_a_link_in_any_direction(tmp_path: Path) -> None:
    (tmp_path / "one.bdf").write_text("\n".join([*PLATE, "ENDDATA", ""]))
    written = re.sub("(?m)^(support|interface) = .*\n", "", deck.described(tmp_path / "one.bdf")[0])
    more = '[fe_model]\ninterface = [1, 2, 3]\nlinks.b = { at = ["0 m", "0 m", "1 m"], nodes = [3, 4], directions = ["z"] }\n'
    (tmp_path / "one.toml").write_text(written.replace("[fe_model]\n", more).partition('[fe_model.links."clamp"]')[0])
    with pytest.raises(BadInput, match="node 3 rides on a link"):
        model.load(tmp_path / "one.toml")


@pytest.mark.parametrize("more", ["weights = [1]", "weights = [1, -1]", 'weights = "all"', "nodes", "rotations"])
def test_weights_are_one_for_each_node_that_is_followed(more: str, tmp_path: Path) -> None:
    (tmp_path / "one.bdf").write_text("\n".join([*PLATE, "ENDDATA", ""]))
    own = {"nodes": "nodes = [3, 4], weights = [1, 2]", "rotations": "nodes = [3, 4], rotations = true"}
    link = own.get(more, f"mean_of = [3, 4], {more}")
    text = deck.described(tmp_path / "one.bdf")[0].replace(
        "[fe_model]\n", f'[fe_model]\nlinks.b = {{ at = ["0 m", "0 m", "1 m"], {link} }}\n'
    )
    (tmp_path / "one.toml").write_text(text)
    said = {
        "weights = [1]": "2 numbers, one for each entry",
        "nodes": "left out but beside",
        "rotations": "rotations`: must be left out but beside",
    }
    with pytest.raises(BadInput, match=said.get(more, "a list of positive numbers")):
        model.load(tmp_path / "one.toml")


def test_a_mesh_of_groups_alone_is_told_how_it_becomes_a_structure(tmp_path: Path) -> None:
    (tmp_path / "groups.inp").write_text(
        "*NODE\n1, 0, 0, 0\n2, 1, 0, 0\n3, 0, 1, 0\n*ELEMENT, TYPE=S3, ELSET=sheet\n1, 1, 2, 3\n"
    )
    with pytest.raises(
        BadInput, match=r'or describe it: \[fe_model\] with kind = "mesh", file = "groups.inp" and materials of its'
    ):
        deck.described(tmp_path / "groups.inp")
