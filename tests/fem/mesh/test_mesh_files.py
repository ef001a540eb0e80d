"""Mesh files of every format are one structure; what is wrong with one is said in words, and none that is damaged is believed."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from benchmarks.read_meshes import STEEL, abaqus, bricks, plate
from fem.mesh import files
from fem.modes import fixed_base
from fem.structure import Structure
from fem.user_model import reading
from geometry.errors import BadInput

Meshed = Callable[..., Structure]

NAMES = {"msh": ("foot", "wall"), "med": ("foot", "wall"), "inp": ("foot", "wall"), "unv": ("foot", "wall"), "bdf": ("1", "2")}
PART = f"[fe_model.parts.p]\n{STEEL}\n"
JOINT = f'[fe_model.joints.j]\nbetween = ["p", "q"]\nat = 1\nstiffness = {["1 N/m"] * 3 + ["1 N m"] * 3}'


@pytest.fixture
def bracket(bracket_mesh: Callable[..., Path], tmp_path: Path) -> Callable[..., Structure]:
    def made(ending: str, order: int = 2, **options: float) -> Structure:
        (tmp_path / f"bracket.{ending}").write_bytes(bracket_mesh(ending, order, **options).read_bytes())
        foot, wall = NAMES[ending]
        named = (
            '["underside"]'
            if ending != "bdf"
            else '["under"]\ngroups.under.box = [["0 mm", "0 mm", "0 mm"], ["1 m", "1 m", "0 mm"]]'
        )
        text = f'format = 1\n[fe_model]\nkind = "mesh"\nunits = "mm-t-N-s"\nfile = "bracket.{ending}"\ninterface = {named}\n'
        text += 'places.mid = ["5 mm", "30 mm", "55 mm"]\n'
        text += f'[fe_model.parts.{foot}]\nmaterial = "steel"\n[fe_model.parts.{wall}]\nmaterial = "aluminium"\n'
        (tmp_path / "bracket.toml").write_text(text)
        found = reading.read(tmp_path / "bracket.toml")
        assert isinstance(found, Structure)
        return found

    return made


@pytest.mark.parametrize("order", [pytest.param(1, marks=pytest.mark.proof), 2])
def test_every_format_is_the_same_structure(bracket: Callable[..., Structure], order: int) -> None:
    """Bulk data carry eight characters a number, the others all digits."""
    reference = bracket("msh", order)
    frequency = fixed_base(reference, 4).frequency
    assert "tip" in reference.places
    for ending in ("med", "inp", "unv", "bdf"):
        found = bracket(ending, order)
        foot, wall = NAMES[ending]
        assert_allclose(fixed_base(found, 4).frequency, frequency, rtol=1e-4 if ending == "bdf" else 1e-9, err_msg=ending)
        masses = [found.part_mass[part].sum() / 3 for part in (foot, wall)]
        assert_allclose(masses, [reference.part_mass[part].sum() / 3 for part in ("foot", "wall")], rtol=1e-6)
        assert len(found.held) == len(reference.held)


def test_the_older_msh_and_the_binary_one_are_the_same(bracket: Callable[..., Structure]) -> None:
    frequency = fixed_base(bracket("msh"), 2).frequency
    for options in ({"Mesh.MshFileVersion": 2.2}, {"Mesh.Binary": 1}):
        assert_allclose(fixed_base(bracket("msh", 2, **options), 2).frequency, frequency, rtol=1e-9)


def test_hexahedra_and_wedges_have_their_nodes_in_place_in_every_text(tmp_path: Path) -> None:
    """Each program numbers the middles of edges in its own way; a node out of place would turn a cell inside out."""
    points, elements = bricks((1, 1, 1), (1.0, 2.0, 3.0), "C3D20")
    a = elements[0]
    grid = "".join(f"GRID,{n},,{x},{y},{z}\n" for n, (x, y, z) in enumerate(points, start=1))
    own = [*a[:12], *a[16:20], *a[12:16]]
    words = [["CHEXA", 1, 7, *own[:6]], ["", *own[6:14]], ["", *own[14:]]]
    (tmp_path / "one.bdf").write_text(grid + "".join(",".join(map(str, row)) + "\n" for row in words))
    (tmp_path / "one.inp").write_text(abaqus(points, {"p": ("C3D20R", elements)}))
    nodes = "".join(
        f"{n:10d}{1:10d}{1:10d}{1:10d}\n{x:25.16e}{y:25.16e}{z:25.16e}\n" for n, (x, y, z) in enumerate(points, start=1)
    )
    ring = (
        [k for pair in zip(a[:4], a[8:12], strict=True) for k in pair],
        [k for pair in zip(a[4:8], a[12:16], strict=True) for k in pair],
    )
    round_about = [*ring[0], *a[16:20], *ring[1]]
    element = "".join(f"{n:10d}" for n in (1, 116, 1, 1, 7, 20)) + "\n"
    for k in (0, 8, 16):
        element += "".join(f"{n:10d}" for n in round_about[k : k + 8]) + "\n"
    (tmp_path / "one.unv").write_text(f"    -1\n  2411\n{nodes}    -1\n    -1\n  2412\n{element}    -1\n")
    for ending in ("bdf", "inp", "unv"):
        mesh = files.read(tmp_path / f"one.{ending}")
        assert_allclose(mesh.points[mesh.cells["hex20"].nodes[0]], points[np.array(a) - 1], atol=1e-12, err_msg=ending)


def cube(kind: str = "C3D8") -> tuple[np.ndarray, list[list[int]]]:
    return bricks((2, 1, 1), (0.2, 0.1, 0.1), kind)


def refused(meshed: Meshed, words: str, mesh: str, parts: str = PART, **more: str) -> None:
    with pytest.raises(BadInput, match=words):
        meshed(mesh, parts, **more)


def test_a_group_without_material_is_named(meshed: Meshed) -> None:
    points, elements = cube()
    mesh = abaqus(points, {"p": ("C3D8", elements[:1]), "rail": ("C3D8", elements[1:])})
    refused(meshed, "1 hex8 elements have no material: group rail", mesh)
    refused(meshed, r"the mesh has no group 'rial'. Did you mean rail\?", mesh, f"{PART}[fe_model.parts.rial]\n{STEEL}")
    refused(meshed, "parts.p.material`: is missing", mesh, "[fe_model.parts.p]\n")
    refused(meshed, "youngs_modulus.*is missing", mesh, '[fe_model.parts.p]\nmaterial = "7850 kg/m^3"')
    bare = abaqus(points, {"p": ("C3D8", elements[:1])}) + "*ELEMENT, TYPE=C3D8\n2, " + ", ".join(map(str, elements[1])) + "\n"
    refused(meshed, "1 hex8 elements have no material: they belong to no group", bare)


def test_overlapping_groups_say_how_many_elements_and_which(meshed: Meshed) -> None:
    points, elements = cube()
    mesh = abaqus(points, {"p": ("C3D8", elements)}) + "*ELSET, ELSET=q\n2\n"
    refused(
        meshed, "parts.q`: 1 hex8 elements belong to p as well, such as element 2", mesh, f"{PART}[fe_model.parts.q]\n{STEEL}"
    )


def test_an_element_that_is_there_twice_is_named(meshed: Meshed) -> None:
    points, elements = cube()
    mesh = abaqus(points, {"p": ("C3D8", [*elements, elements[0]])})
    refused(meshed, "parts.p`: 2 hex8 elements have the same nodes as another: 1, 3", mesh)
    other = abaqus(points, {"p": ("C3D8", elements), "all": ("C3D8", elements)})
    assert_allclose(meshed(other, PART).rigid_mass[0, 0], 7850 * 0.2 * 0.1 * 0.1, rtol=1e-12)


def test_groups_that_do_not_touch_are_refused_and_unmerged_nodes_named(meshed: Meshed) -> None:
    points, elements = cube()
    apart = np.vstack([points, points + np.array([0.2, 0, 0])])
    more = (np.array(elements) + len(points)).tolist()
    mesh = abaqus(apart, {"p": ("C3D8", elements), "q": ("C3D8", more)})
    parts = f"{PART}[fe_model.parts.q]\n{STEEL}\n"
    refused(meshed, "1 body is not connected to the rest: 12 nodes of q, 4 of its nodes coincide", mesh, parts)
    far = abaqus(np.vstack([points, points + np.array([0.25, 0, 0])]), {"p": ("C3D8", elements), "q": ("C3D8", more)})
    refused(meshed, "not connected to the rest: 12 nodes of q, 50 mm from the nearest other", far, parts)
    joint = ["1e6 N/m"] * 3 + ["1e6 N m/rad"] * 3
    text = f'[fe_model.joints.j]\nbetween = ["p", "q"]\nat = ["0.2 m", "50 mm", "50 mm"]\nstiffness = {joint}'
    assert meshed(mesh, parts, more=text).joints == ("j",)
    refused(meshed, r"joints.j`: lies 50 mm outside part q; the nearest point is \(250, 50, 50\) mm", far, parts, more=text)


@pytest.mark.parametrize("kind", ["C3D8", "C3D20", "C3D4", "C3D10", "C3D6", "C3D15"])
def test_inverted_and_degenerate_solids_are_counted_and_numbered(meshed: Meshed, kind: str) -> None:
    points, elements = bricks((2, 1, 1), (0.2, 0.1, 0.1), kind)
    mirrored = points * [1, 1, -1]
    mesh = abaqus(mirrored, {"p": (kind, elements)})
    refused(meshed, f"{len(elements)} .* elements of p are inside out: 1, 2", mesh)
    flat = abaqus(points * [1, 1, 0], {"p": (kind, elements)})
    refused(meshed, f"{len(elements)} .* elements of p are degenerate .no extent.: 1, 2", flat)


def test_a_folded_quadrilateral_and_a_beam_without_length_are_named(meshed: Meshed) -> None:
    points, elements = plate(2, 1, (1.0, 0.5))
    a, b, c, d = elements[1]
    mesh = abaqus(points, {"p": ("S4", [elements[0], [a, b, d, c]])})
    refused(meshed, "1 quad4 elements of p are inside out: 2", mesh, f'{PART}thickness = "3 mm"')
    line = abaqus(np.array([[0, 0, 0], [1, 0, 0], [1, 0, 0]]), {"p": ("B31", [[1, 2], [2, 3]])})
    beam = f'{PART}section = {{ width = "20 mm", height = "10 mm" }}'
    refused(meshed, "1 line2 elements of p are degenerate .no extent.: 2", line, beam)
    upright = abaqus(np.array([[0, 0, 0], [0, 0, 1]]), {"p": ("B31", [[1, 2]])})
    axis = f'{PART}section = {{ width = "20 mm", height = "10 mm", z_axis = [0, 0, 1] }}'
    refused(meshed, "the z axis of its section lies along element 1", upright, axis)


def test_sizes_that_no_structure_has_are_doubted_with_the_unit_that_fits(meshed: Meshed) -> None:
    points, elements = cube()
    refused(meshed, r"units`: with it the structure is 2e\+04 m long.*In mm or", abaqus(1e5 * points, {"p": ("C3D8", elements)}))
    refused(
        meshed,
        r"is 0.0002 m long, which none is .1 mm to 5 km.*In cm or m",
        abaqus(points, {"p": ("C3D8", elements)}),
        units="mm",
    )


@pytest.mark.parametrize(
    ("words", "keys"),
    [
        ("thickness`: belongs to shells or beams", {"parts": f'{PART}thickness = "3 mm"'}),
        ("unknown key 'materail'. Did you mean material", {"parts": "[fe_model.parts.p]\nmaterail = 1"}),
        ("interface`: is missing|interface.*the groups that the base carries", {"support": ""}),
        ("Write the number of a node|must be a place", {"more": "[fe_model.places]\na = true"}),
        ("places.a`: the mesh has no group 'b'", {"more": '[fe_model.places]\na = "b"'}),
        ("no element of the parts has a node 999", {"more": "[fe_model.places]\na = 999"}),
        ("needs its unit", {"more": "[fe_model.places]\na = [1, 2, 3]"}),
        ("left out of a free structure", {"support": 'support = "free"\ninterface = ["p"]'}),
        ("Name the groups that the ground holds", {"support": 'support = "ground"'}),
        ("the mesh has no group 'foot'", {"support": 'interface = ["foot"]'}),
        (
            "the box holds no node; the nearest is at",
            {"more": '[fe_model.groups.g]\nbox = [["1 m", "0 m", "0 m"], ["2 m", "0 m", "0 m"]]'},
        ),
        ("box`: must be two corners", {"more": "[fe_model.groups.g]\nbox = [1]"}),
        ("the names of two parts", {"more": JOINT.replace('"q"', '"p"')}),
        ("two places, without `at`", {"more": '[fe_model.springs.s]\nbetween = ["a"]\n'}),
        ("there is no part 'q'", {"more": "" + JOINT}),
        (
            "stiffness`: must be six stiffnesses",
            {"more": '[fe_model.joints.j]\nbetween = ["p", "q"]\nat = 1\nstiffness = ["1 N/m"]'},
        ),
        ("units", {"units": "furlong"}),
        ("the mesh weighs 15.7 kg where 7.85 kg are stated, 2 times as much", {"more": '[stated]\nmass = "7.85 kg"'}),
    ],
)
def test_what_a_description_gets_wrong_is_said(meshed: Meshed, words: str, keys: dict[str, str]) -> None:
    points, elements = cube()
    parts = keys.pop("parts", PART)
    refused(meshed, words, abaqus(points, {"p": ("C3D8", elements)}), parts, **keys)


def test_a_kind_that_is_misspelt_is_the_nearest_one(tmp_path: Path) -> None:
    (tmp_path / "x.toml").write_text('format = 1\n[fe_model]\nkind = "mehs"\nfile = "x.inp"\nparts = {}\n')
    with pytest.raises(BadInput, match=r"must be one of mesh, assembly, found 'mehs'. Did you mean mesh\?"):
        reading.read(tmp_path / "x.toml")


def test_a_shell_needs_its_thickness_and_a_beam_its_section(meshed: Meshed) -> None:
    points, elements = plate(2, 1, (1.0, 0.5))
    refused(meshed, "parts.p.thickness`: is missing, and the group has 2 shell elements", abaqus(points, {"p": ("S4", elements)}))
    refused(meshed, "parts.p.section`: is missing, and the group has 1 beam elements", abaqus(points, {"p": ("B31", [[1, 2]])}))


@pytest.mark.parametrize(
    ("ending", "text", "words"),
    [
        ("msh", "Merge 'x';\n", "does not begin as a .msh file does"),
        ("med", "no", "does not begin as a .med file does"),
        ("msh", "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n", "holds no elements"),
        ("inp", "", "holds no elements"),
        ("inp", "*NODE\n1, 0, 0, 0\n*ELEMENT, TYPE=B31\n1, 1, 2\n", "have nodes that the file does not hold, the first is 1"),
        ("inp", "*NODE\n1, 0, 0, 0\n1, 0, 0, 0\n", "the number 1 is given twice"),
        ("inp", "*ELEMENT, TYPE=C3D99\n", "elements of type 'C3D99' are not known"),
        ("inp", "*INCLUDE, INPUT=other.inp\n", "which is not there"),
        ("inp", "*NODE\n1, nan, 0, 0\n2, 1, 0, 0\n*ELEMENT, TYPE=B31\n1, 1, 2\n", "are nowhere"),
        ("inp", "*NODE\n1, x, 0, 0\n", "a record of it cannot be read"),
        ("bdf", "GRID,1,3,0.,0.,0.\n", "the coordinate system 3 is not there"),
        ("bdf", "GRID,1,,0.,0.,0.\nCTETRA,1,1,1,1,1\n", "has 3 nodes"),
        ("unv", "    -1\n  2411\n", "does not end"),
        ("stl", "", "is none of"),
    ],
)
def test_files_that_are_none_are_refused_in_words(tmp_path: Path, ending: str, text: str, words: str) -> None:
    (tmp_path / f"x.{ending}").write_text(text)
    with pytest.raises(BadInput, match=words):
        files.read(tmp_path / f"x.{ending}")


@pytest.mark.parametrize("ending", ["inp", "bdf", "unv"])
def test_a_damaged_text_is_refused_or_read_but_never_breaks_the_reader(
    bracket_mesh: Callable[..., Path], tmp_path: Path, ending: str
) -> None:
    whole, rng = bracket_mesh(ending, 1).read_bytes(), np.random.default_rng(6)
    path, refusals = tmp_path / f"damaged.{ending}", 0
    for _ in range(40):
        data = bytearray(whole[: int(rng.integers(len(whole)))] if rng.random() < 0.3 else whole)
        for at in rng.integers(len(data) or 1, size=int(rng.integers(1, 30))):
            if len(data):
                data[at] = int(rng.integers(256))
        path.write_bytes(bytes(data))
        try:
            mesh = files.read(path)
            assert all(np.isfinite(mesh.points[cells.nodes]).all() for cells in mesh.cells.values())
        except BadInput:
            refusals += 1
    assert refusals > 10


def test_a_bulk_data_deck_that_lost_lines_or_its_end_is_refused(tmp_path: Path) -> None:
    """A quadratic tetrahedron without its second line would be a linear one, and one that goes on in another's line a third."""
    corners = [(0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)]
    middles = [(i, j) for i in range(4) for j in range(i)]
    places = [*map(np.array, corners), *((np.array(corners[i]) + corners[j]) / 2 for i, j in middles)]
    at = {frozenset(pair): 5 + k for k, pair in enumerate(middles)}
    order = [1, 2, 3, 4, *(at[frozenset(pair)] for pair in ((0, 1), (1, 2), (0, 2), (0, 3), (1, 3), (2, 3)))]
    grid = [f"GRID,{k},,{x[0]},{x[1]},{x[2]}" for k, x in enumerate(places, start=1)]
    first = f"{'CTETRA':<8}{1:<8}{1:<8}" + "".join(f"{n:<8}" for n in order[:6]) + "+E1"
    second = f"{'+E1':<8}" + "".join(f"{n:<8}" for n in order[6:])
    path = tmp_path / "one.bdf"
    path.write_text("\n".join([*grid, first, second]) + "\n")  # without ENDDATA, as a file that is included has it
    assert list(files.read(path).cells) == ["tet10"]
    for lines in ([*grid, first], [*grid, first, second.replace("+E1", "+E2")], [*grid, first, "ENDDATA"]):
        path.write_text("\n".join(lines) + "\n")
        with pytest.raises(BadInput, match=r"continued by|within a card"):
            files.read(path)
    path.write_text("\n".join([*grid, first, second])[:-9])
    with pytest.raises(BadInput, match="has 9 nodes"):
        files.read(path)
    for last in ("GRID,11,,1.,", "CTETR"):
        path.write_text("\n".join([*grid, first, second, last]))
        with pytest.raises(BadInput, match="within a card"):
            files.read(path)


@pytest.mark.parametrize("end", ["", "\n", "\n$ the end", "\nENDDATA", "\nENDDATA\nCreated by Patran\nCONM2,9,1,,5.\n"])
def test_a_sound_deck_is_read_whatever_stands_around_its_bulk_data(end: str, tmp_path: Path) -> None:
    head = ["Created by Patran", "SOL 103", "CEND", "CMETHOD = 10", f"{'TITLE = plate':<72}+abc", "BEGIN BULK"]
    grid = [f"GRID,{k},,{k}.,{k * k}.,{k**3}.,{'-1' * (k == 1)}" for k in range(1, 5)]
    path = tmp_path / "one.bdf"
    path.write_text("\n".join([*head, *grid, "CTETRA,1,1,1,2,3,4"]) + end)
    assert [len(cells.tags) for cells in files.read(path).cells.values()] == [1]


@pytest.mark.parametrize(
    ("card", "words"),
    [
        ("CONM2,9,1,,5.", "what it weighs"),
        ("CBUSH,9,1,1,2", "holds or joins"),
        ("RBE2,8,1,123,2,3", "RBE2"),
        ("RBE3,8,,1,123,1.,123,2,3", "RBE3"),
        ("MPC,8,1,1,1.,2,1,-1.", "MPC"),
        ("CELAS2,9,1000.,1,1", "CELAS2"),
        ("CVISC,9,1,1,2", "CVISC"),
        ("GRID    9       0       61.250000.00E+0010.000010.00000", "freedoms"),
    ],
)
def test_a_deck_with_cards_that_would_be_lost_is_refused_by_card(card: str, words: str, tmp_path: Path) -> None:
    deck = ["SOL 103", "CEND", "BEGIN BULK", *(f"GRID,{k},,{k}.,{k * k}.,{k**3}." for k in range(1, 5)), "CTETRA,1,1,1,2,3,4"]
    path = tmp_path / "one.bdf"
    path.write_text("\n".join([*deck, "CORD2R,7,,0.,0.,0.,0.,0.,1.", ",1.,0.,0.", "SPC1,8,123,2,3", "ENDDATA", ""]))
    assert len(files.read(path).node_tags) == 4  # where it is held is the user's to state
    path.write_text("\n".join([*deck, card, "ENDDATA", ""]))
    with pytest.raises(BadInput, match=words):
        files.read(path)


@pytest.mark.parametrize(
    "lines",
    [
        "*MASS, ELSET=m\n2.",
        "*SPRING, ELSET=s\n1\n100.",
        "*DASHPOT, ELSET=s\n1\n100.",
        "*ELEMENT, TYPE=SPRINGA, ELSET=s\n9, 1, 2",
        "*TIE, NAME=t\na, b",
        "*Rigid body, nset=n, ref node=9",
        "*EQUATION\n2\n1,1,1.,2,1,-1.",
        "*SYSTEM\n1,0,0,2,0,0",
        "*NODE, SYSTEM=C\n9,1.,90.,0.",
        "*ELEMENT, TYPE=MASS, ELSET=m\n9, 1",
        "*NGEN\n1, 4, 1",
        "*NFILL\na, b, 2",
        "*NCOPY, CHANGE NUMBER=10, OLD SET=a",
        "*ELGEN\n1, 2, 1",
        "*ELCOPY, OLD SET=p",
    ],
)
def test_keywords_of_abaqus_that_would_be_lost_are_refused(lines: str, tmp_path: Path) -> None:
    path = tmp_path / "one.inp"
    deck = "*NODE, SYSTEM=R\n1,0,0,0\n2,1,0,0\n3,0,1,0\n4,0,0,1\n*ELEMENT, TYPE=C3D4, ELSET=p\n1,1,2,3,4\n"
    path.write_text(deck)
    assert len(files.read(path).node_tags) == 4
    path.write_text(deck + lines + "\n")
    with pytest.raises(BadInput, match=r"would be lost|is not followed|are not read"):
        files.read(path)


def universal(*datasets: str, behind: bool = False) -> str:
    nodes = "".join(
        f"{k} 1 1 11\n{x}. {y}. {z}.\n" for k, (x, y, z) in enumerate([(0, 0, 0), (9, 0, 0), (0, 9, 0), (0, 0, 9)], 1)
    )
    element = "1 111 1 1 7 4\n1 2 3 4\n"
    group = "1 0 0 0 0 0 0 1\nBODY\n8 1 0 0\n"
    own = (f"2411\n{nodes}", f"2412\n{element}", f"2467\n{group}")
    every = (*own, *datasets) if behind else (*datasets, *own)
    return "".join(f"    -1\n{one}    -1\n" for one in every)


@pytest.mark.parametrize(
    ("per_metre", "units", "refused"),
    [("1.D+03", "mm", False), ("1000.", "m", True), ("39.37", "in", False), ("39.37", "mm", True), ("1.0", "mm", False)],
)
def test_a_unit_that_a_universal_file_states_is_that_of_its_description(
    per_metre: str, units: str, refused: bool, meshed: Callable[..., Structure]
) -> None:
    """A structure a thousand times as large was made of it. That all is in metres is written by many who do not know."""
    text = universal(f"164\n         5 a system           2\n{per_metre} 1. 1.\n273.15\n")
    parts = '[fe_model.parts.BODY]\nmaterial = "steel"'
    if not refused:
        assert meshed(text, parts, units=units, ending="unv").rigid_mass[0, 0] > 0
        return
    with pytest.raises(BadInput, match=r"`fe_model.units`: is .* m, and mesh.unv itself says .* m \(dataset 164\)"):
        meshed(text, parts, units=units, ending="unv")


@pytest.mark.parametrize(("kind", "row", "refused"), [(0, "1. 0. 0.", False), (0, "0. 1. 0.", True), (1, "1. 0. 0.", True)])
@pytest.mark.parametrize("behind", [False, True])
def test_nodes_of_a_universal_file_are_in_global_axes(
    behind: bool, kind: int, row: str, refused: bool, meshed: Callable[..., Structure]
) -> None:
    """They were taken for global whatever dataset 2420 says of their system, or says of it behind them."""
    text = universal(f"2420\n1\nPART\n1 {kind} 8\nOWN\n{row}\n0. 1. 0.\n0. 0. 1.\n0. 0. 0.\n", behind=behind)
    parts = '[fe_model.parts.BODY]\nmaterial = "steel"'
    if not refused:
        assert meshed(text, parts, units="mm", ending="unv").rigid_mass[0, 0] > 0
        return
    with pytest.raises(BadInput, match="node 1 is in the system 1, which dataset 2420 turns, moves or makes round"):
        meshed(text, parts, units="mm", ending="unv")
