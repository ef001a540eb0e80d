"""What decks of other people have, in files of our own: axes of nodes, tabs, sets in other letters, weights for masses."""

from pathlib import Path

import numpy as np
import pytest

from fem.mesh import deck
from fem.modes import fixed_base
from fem.structure import Structure
from fem.user_model import reading
from fem.user_model.examine import examine
from geometry.errors import BadInput
from geometry.frames import Array, skew

MATERIAL = "*MATERIAL, NAME=STEEL\n*ELASTIC\n2.1E11, 0.3\n*DENSITY\n7850.\n"

STEP = "*STEP\n*FREQUENCY\n4\n*END STEP\n"

PLATE = (
    "MAT1,1,2.1+11,,0.3,7850.\nPSHELL,1,1,.002,1,,1\n{axes}GRID,1,,0.,0.,0.,{cd}\nGRID,2,,.1,0.,0.\nGRID,3,,.1,.05,0.\n"
    "GRID,4,,0.,.05,0.,{cd}\nCQUAD4,1,1,1,2,3,4\n{held}ENDDATA\n"
)


def told(folder: Path, text: str, name: str = "deck.inp") -> tuple[Structure | None, str, tuple[str, ...]]:
    """The structure of a deck where nothing of it is lost, its description, and what is lost."""
    (folder / name).write_text(text)
    said, lost = deck.described(folder / name, "m-kg-N-s")
    own = folder / Path(name).with_suffix(".toml")
    own.write_text(said)
    return (None if lost else reading.read(own)), said, lost


def test_the_middle_of_a_beam_of_three_nodes_is_the_second(tmp_path: Path) -> None:
    """Of Abaqus and CalculiX; it had been taken for an end, and a cantilever weighed half as much again."""
    side, long = 0.01, 0.1
    nodes = "".join(f"{k + 1}, 0., 0., {k * long / 8}\n" for k in range(9))
    beams = "".join(f"{k + 1}, {2 * k + 1}, {2 * k + 2}, {2 * k + 3}\n" for k in range(4))
    section = f"*BEAM SECTION, ELSET=E, MATERIAL=STEEL, SECTION=RECT\n{side}, {side}\n1., 0., 0.\n"
    text = f"*NODE\n{nodes}*ELEMENT, TYPE=B32, ELSET=E\n{beams}{MATERIAL}{section}*BOUNDARY\n1, 1, 6\n{STEP}"
    structure, *_ = told(tmp_path, text)
    assert structure is not None
    euler = 1.8751**2 / (2 * np.pi * long**2) * np.sqrt(2.1e11 * side**2 / 12 / 7850.0)
    np.testing.assert_allclose(fixed_base(structure, 1).frequency[0], euler, rtol=0.01)  # Timoshenko's is 0.8 % lower


@pytest.mark.parametrize(("held", "ways"), [("13456", "y, z"), ("23456", "x, z"), ("123456", "")])
def test_what_is_held_along_the_freedoms_of_a_node_is_held_there(held: str, ways: str, tmp_path: Path) -> None:
    """The first axis of the nodes is y, and the second is -x; before, the letters were those of the model's axes."""
    axes = "CORD2R,5,0,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n"
    text = PLATE.format(axes=axes, cd=5, held=f"SPC1,1,{held},1,4\n")
    _, said, lost = told(tmp_path, text, "deck.bdf")
    assert not lost
    assert ("holds" not in said and "clamp" in said) if not ways else f'nodes = [1, 4]\ndirections = ["{ways[0]}", "z", ' in said


def pinned(first: str, transform: str) -> str:
    nodes = "*NODE\n1, .1, 0., 0.\n2, .1, 0., .05\n3, .1, 0., .1\n"
    section = "*BEAM SECTION, ELSET=e, MATERIAL=STEEL, SECTION=RECT\n.01, .02\n1., 0., 0.\n"
    sets = "*NSET, NSET=Root\n1\n*NSET, NSET=Foot\nROOT\n"
    head = f"{nodes}*ELEMENT, TYPE=B31, ELSET=E\n1, 1, 2\n2, 2, 3\n{sets}{MATERIAL}{section}"
    return f"{head}*BOUNDARY\nfoot, {first}\n{transform}{STEP}"


@pytest.mark.parametrize("transform", ["TYPE=R\n0., 1., 0., -1., 0., 0.\n", "TYPE=C\n.1, -1., 0., .1, -1., 1.\n"])
def test_a_transform_turns_what_its_nodes_are_held_in(transform: str, tmp_path: Path) -> None:
    """Their first axis is y, their second -x; the set is called by a set in other letters, which had left the beam free."""
    _, said, lost = told(tmp_path, pinned("2, 6", f"*TRANSFORM, NSET=ROOT, {transform}"))
    assert not lost
    assert 'directions = ["x", "z", "alpha", "beta", "gamma"]' in said


def test_spherical_axes_are_lost_in_words_and_are_no_damage(tmp_path: Path) -> None:
    lost = told(tmp_path, pinned("2, 6", "*TRANSFORM, NSET=ROOT, TYPE=S\n0., 0., 0., 0., 0., 1.\n"))[2]
    assert lost == ("*TRANSFORM ROOT: its axes are spherical",)


def test_calculix_minds_no_blanks_in_keywords(tmp_path: Path) -> None:
    text = pinned("1, 6", "")
    glued = text.replace("*BEAM SECTION", "*BEAMSECTION").replace("*END STEP", "*ENDSTEP")
    assert told(tmp_path, glued)[1:] == told(tmp_path, text)[1:]


def test_tabs_stand_for_blanks_up_to_the_next_field(tmp_path: Path) -> None:
    text = PLATE.format(axes="", cd="", held="SPC1,1,123456,1,4\n")
    assert told(tmp_path, text.replace(",", "\t"), "deck.bdf")[1:] == told(tmp_path, text, "deck.bdf")[1:]


@pytest.mark.parametrize(
    ("was", "now", "words"),
    [
        ("SECTION=RECT", "SECTION=RECT, OFFSET1=0.5", "*BEAM SECTION e: how far it is off its nodes (OFFSET1, OFFSET2)"),
        ("*DENSITY", "*DAMPING, ALPHA=3.\n*DENSITY", "*DAMPING of STEEL: what is not STRUCTURAL; state a loss_factor"),
        ("*BOUNDARY", "*RELEASE\n1, S2, M1-M2\n*BOUNDARY", "*RELEASE: a keyword that is not known here"),
        (
            "*BEAM SEC",
            "*BEAM SECTION, ELSET=E, MATERIAL=STEEL, SECTION=CIRC\n.01\n*BEAM SEC",
            "a second section of the same elements",
        ),
    ],
)
def test_what_a_section_says_besides_is_lost_with_words(was: str, now: str, words: str, tmp_path: Path) -> None:
    (lost,) = told(tmp_path, pinned("1, 6", "").replace(was, now))[2]
    assert words in lost


def test_a_shear_modulus_that_is_not_that_of_modulus_and_ratio_is_said(tmp_path: Path) -> None:
    text = PLATE.format(axes="", cd="", held="SPC1,1,123456,1,4\n")
    assert told(tmp_path, text.replace("2.1+11,,", "2.1+11,8.+10,"), "deck.bdf")[2] == ()
    lost = told(tmp_path, text.replace("2.1+11,,", "2.1+11,1.+9,"), "deck.bdf")[2]
    assert lost == ("MAT1 1: its G of 1e+09, which E and NU make 8.077e+10; that is taken",)


def test_the_second_spring_law_of_a_card_counts(tmp_path: Path) -> None:
    more = "PELAS,1,1.+5,,,2,2.+5\nCELAS1,7,2,2,3\n"
    _, said, lost = told(tmp_path, PLATE.format(axes=more, cd="", held="SPC1,1,123456,1,4\n"), "deck.bdf")
    assert not lost
    assert '"200000 N/m"' in said


INCHES = "MAT1,1,10.+6,,.33,{rho}\nPSHELL,1,1,.1,1,,1\n{more}" + PLATE.partition("{axes}")[2].format(
    cd="", held="SPC1,1,123456,1,4\n"
)


@pytest.mark.parametrize("units", [None, "in-lbf-s"])
def test_weights_for_masses_are_told_with_what_makes_masses_of_them(units: str | None, tmp_path: Path) -> None:
    """Aluminium of 0.1 lbf/in³ had weighed 1.07e6 kg/m³ without a word where the units were named."""
    (tmp_path / "deck.bdf").write_text(INCHES.format(rho=".1", more=""))
    words = "its densities are weights, not masses, in in-lbf-s.*PARAM,WTMASS,0.00259"
    with pytest.raises(BadInput, match=words):
        deck.described(tmp_path / "deck.bdf", units)
    (tmp_path / "deck.bdf").write_text(INCHES.format(rho=".05", more="PARAM,WTMASS,2.\n"))
    with pytest.raises(BadInput, match=words.replace(",0.00259", ",0.00518")):
        deck.described(tmp_path / "deck.bdf", units)
    for case, bulk in (("", "PARAM,WTMASS,.00259\n"), ("SOL 103\nCEND\nSPC=1\nparam,wtmass,.00259\nBEGIN BULK\n", "")):
        (tmp_path / "deck.bdf").write_text(case + INCHES.format(rho=".1", more=bulk))
        assert 'density = "2767' in deck.described(tmp_path / "deck.bdf", units)[0]


def test_a_structure_without_any_mass_is_refused_with_units_named_too(tmp_path: Path) -> None:
    (tmp_path / "deck.bdf").write_text(INCHES.format(rho="", more=""))
    with pytest.raises(BadInput, match="no material states a density"):
        deck.described(tmp_path / "deck.bdf", "in-lbf-s")
    (tmp_path / "deck.bdf").write_text(INCHES.format(rho="", more="CONM2,9,3,,1.\n"))
    assert "CONM2 9" in deck.described(tmp_path / "deck.bdf", "in-lbf-s")[0]


def brick(held: str) -> str:
    """A hexahedron whose face at x = 0 rides on node 9, and is turned as node 10 moves."""
    nodes = (
        "*NODE\n" + "".join(f"{k + 1}, {x}, {y}, {z}\n" for k, (x, y, z) in enumerate(CUBE)) + "9, 0., .5, .5\n10, 0., .5, .5\n"
    )
    cell = "*ELEMENT, TYPE=C3D8, ELSET=E\n1, 1, 2, 3, 4, 5, 6, 7, 8\n*NSET, NSET=FOOT\n1, 4, 5, 8\n"
    body = "*SOLID SECTION, ELSET=E, MATERIAL=STEEL\n*RIGID BODY, NSET=FOOT, REF NODE=9, ROT NODE=10\n"
    return f"{nodes}{cell}{MATERIAL}{body}*BOUNDARY\n9, 1, 3\n{held}{STEP}"


CUBE = [(0, 0, 0), (1, 0, 0), (1, 1, 0), (0, 1, 0), (0, 0, 1), (1, 0, 1), (1, 1, 1), (0, 1, 1)]


def test_a_rigid_body_is_held_in_rotation_by_its_own_node(tmp_path: Path) -> None:
    """CalculiX has rotations of a rigid body as displacements of another node; held there, it had been free to turn."""
    assert 'interface = ["RIGID BODY FOOT"]' in told(tmp_path, brick("10, 1, 3\n"))[1]
    assert 'directions = ["x", "y", "z", "alpha", "gamma"]' in told(tmp_path, brick("10, 1\n10, 3\n"))[1]
    assert 'directions = ["x", "y", "z"]' in told(tmp_path, brick(""))[1]


def test_a_mesh_that_is_not_held_is_told_by_who_examines_it(tmp_path: Path) -> None:
    """«Nothing is wrong with it» was said of a bar without torsion and of a plate that slides, neither of which has modes."""
    bar = "MAT1,1,2.1+11,,.3,7850.\nPBAR,1,1,1.-4,1.-9,1.-9,{J}\nGRID,1,,0.,0.,0.\nGRID,2,,1.,0.,0.\nCBAR,1,1,1,2,0.,1.,0.\n"
    for name, text, sound in [
        ("bar", f"{bar}SPC1,1,123456,1\nENDDATA\n".format(J=""), False),
        ("rod", f"{bar}SPC1,1,123456,1\nENDDATA\n".format(J="2.-9"), True),
        ("plate", PLATE.format(axes="", cd="", held="SPC1,1,13456,1,4\n"), False),
    ]:
        told(tmp_path, text, f"{name}.bdf")
        found = examine(tmp_path / f"{name}.toml").findings
        assert any(one.check == "support" for one in found) != sound, name


@pytest.mark.parametrize(
    "lines",
    [
        "GRID*   3                               .1              .05             *3      \n*3      0.\n",
        "GRID*   3                               .1              .05             *\n*       0.\n",
        "GRID*,3,,.1,.05\n*,0.\n",
        "GRID*,3,,.1,.05,*A\n*A,0.\n",
        "GRID*,3,,.1,.05,+A\n+A,0.,\n",
    ],
)
def test_large_fields_go_on_in_large_fields(lines: str, tmp_path: Path) -> None:
    """With a mark behind the asterisk the second line was cut as small fields are, and free ones had eight to a line."""
    text = PLATE.format(axes="", cd="", held="SPC1,1,123456,1,4\n")
    wanted = told(tmp_path, text.replace("GRID,3,,.1,.05,0.", "GRID,3,,.1,.05,.02"), "deck.bdf")[0]
    found = told(tmp_path, text.replace("GRID,3,,.1,.05,0.\n", lines.replace("0.", ".02")), "deck.bdf")[0]
    assert wanted is not None
    assert found is not None
    np.testing.assert_array_equal(found.points, wanted.points)


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ("CONM2,9,3,,1.,0.,0.,0.,,+A,1.,,1.", "line 9 has more fields than the 8 of a line"),
        ("CONM2,9,3,,1.,0.,0.,0.,,1.", "line 9 has more fields than the 8 of a line"),
        ("GRID*,7,,0.,0.,1.", "line 9 has more fields than the 4 of a line"),
        ("CONM2,9,3,,1.\nCONM2,9,2,,1.", "two CONM2 have the number 9"),
        ("SPC1,1,1*3,2", r"\* stands where freedoms should"),
        ("PBUSH,9,K,RIGID\nCBUSH,9,9,3,,,,,0", "RIGID stands where a number should"),
    ],
)
def test_what_would_be_passed_over_in_a_card_is_refused(cards: str, words: str, tmp_path: Path) -> None:
    """What stood behind the tenth field was dropped, and of two masses of one number the first."""
    with pytest.raises(BadInput, match=words):
        told(tmp_path, PLATE.format(axes="", cd="", held=f"SPC1,1,123456,1,4\n{cards}\n"), "deck.bdf")


def test_supports_that_the_case_control_does_not_call_are_said_to_be_left_out(tmp_path: Path) -> None:
    text = PLATE.format(axes="", cd="", held="SPC1,1,123456,1,4\n")
    assert told(tmp_path, f"SOL 103\nCEND\nSPC = 1\nBEGIN BULK\n{text}", "deck.bdf")[2] == ()
    _, said, lost = told(tmp_path, f"SOL 103\nCEND\nBEGIN BULK\n{text}", "deck.bdf")
    assert lost == ("SPC sets 1: the case control calls none, and Nastran leaves them out",)
    assert 'support = "free"' in said


LUMP = "*ELEMENT, TYPE=MASS{of}\n90, 3\n91, 2\n*ELEMENT, TYPE=ROTARYI, ELSET=R\n92, 3\n{sets}*MASS, ELSET=M\n.5\n{turned}"


def test_masses_are_those_of_their_set_and_turn_as_their_inertia_says(tmp_path: Path) -> None:
    """Those of a set that was made of their numbers weighed nothing, without a word."""
    inertia = "*ROTARY INERTIA, ELSET=R\n.1, .2, .3\n"
    free = pinned("1, 6", "").replace("*BOUNDARY\nfoot, 1, 6\n", "{}")
    bare, whole, single = (
        told(tmp_path, free.format(text))[0]
        for text in (
            "",
            LUMP.format(of=", ELSET=M", sets="", turned=inertia),
            LUMP.format(of="", sets="*ELSET, ELSET=N, GENERATE\n90, 92, 2\n*ELSET, ELSET=M\nN\n", turned=inertia),
        )
    )
    assert bare is not None
    assert whole is not None
    assert single is not None
    arm = [np.array([0.1, 0.0, z]) for z in (0.1, 0.05)]
    moments = [0.5 * (one @ one * np.eye(3) - np.outer(one, one)) for one in arm]
    wanted = np.diag([0.1, 0.2, 0.3]) + moments[0]
    assert single.rigid_mass[0, 0] - bare.rigid_mass[0, 0] == pytest.approx(0.5)
    np.testing.assert_allclose((single.rigid_mass - bare.rigid_mass)[3:, 3:], wanted, rtol=1e-9, atol=1e-12)
    np.testing.assert_allclose((whole.rigid_mass - bare.rigid_mass)[3:, 3:], wanted + moments[1], rtol=1e-9, atol=1e-12)
    lone = "*ELEMENT, TYPE=ROTARYI, ELSET=R\n92, 3\n"
    assert told(tmp_path, free.format(lone + inertia))[2] == ("*ROTARY INERTIA R: no mass is at its node",)
    three = "*ELEMENT, TYPE=MASS, ELSET=M\n90, 3\n*MASS, ELSET=M\n1., 2., 3.\n"
    assert told(tmp_path, free.format(three))[2] == ("*MASS M: it is not alike in all directions; the first is taken",)
    with pytest.raises(BadInput, match="MASS names the set NONE, which is not there"):
        told(tmp_path, free.format("*MASS, ELSET=NONE\n1.\n"))


def test_a_general_section_has_its_moments_about_its_first_two_axes(tmp_path: Path) -> None:
    """Of Abaqus, with a material of its own; before, its elements had none."""
    text = pinned("1, 6", "").replace(".01, .02\n", "2.E-4, {}\n").replace("SECTION=RECT", "SECTION=GENERAL")
    text = text.replace("*BEAM SECTION", "*BEAM GENERAL SECTION")
    along, across = 0.02 * 0.01**3 / 12, 0.01 * 0.02**3 / 12  # of the first size, 10 mm, along the first axis
    own = text.replace("MATERIAL=STEEL", "DENSITY=7850.").replace("1., 0., 0.\n*B", "1., 0., 0.\n2.1E11, 8.0769E10\n*B")
    rectangle = told(tmp_path, pinned("1, 6", ""))[0]
    assert rectangle is not None
    for one in (text, own):
        found = told(tmp_path, one.format(f"{across}, , {along}, 1.E-9"))[0]
        assert found is not None
        first, wanted = (fixed_base(each, 1).frequency for each in (found, rectangle))
        np.testing.assert_allclose(first, wanted, rtol=0.01)  # but for the shear


def test_a_set_of_the_assembly_may_name_one_of_its_instance(tmp_path: Path) -> None:
    """It held nothing."""
    part, _, rest = pinned("1, 6", "").partition("*MATERIAL")
    section = "*BEAM SECTION, ELSET=e, MATERIAL=STEEL, SECTION=RECT\n.01, .02\n1., 0., 0.\n"
    instances = "".join(f"*INSTANCE, NAME=I{k}, PART=P\n0., {k}., 0.\n*END INSTANCE\n" for k in (1, 2))
    sets = "".join(f"*NSET, NSET=HELD, INSTANCE=I{k}\nFoot,\n" for k in (1, 2))
    text = f"*PART, NAME=P\n{part}{section}*END PART\n*ASSEMBLY, NAME=A\n{instances}{sets}*END ASSEMBLY\n*MATERIAL"
    _, said, lost = told(tmp_path, text + rest.replace(section, "").replace("foot,", "held,"))
    assert not lost
    assert "clamp-2" in said


@pytest.mark.parametrize(
    ("slip", "E", "rho"),
    [("MPa with kg/mm³", 210e3, 7.85e-6), ("kgf/cm² with kgf s²/cm⁴", 2.1e6, 8e-6), ("kgf/mm² with kgf/mm³", 21e3, 7.85e-6)],
)
def test_steel_that_would_be_soft_is_none(slip: str, E: float, rho: float, tmp_path: Path) -> None:
    """It was believed to be of 210 MPa, 2.1 GPa or 21 MPa in mm-kg-mN-s, and the frequencies came out 5 to 100 times too low."""
    text = PLATE.format(axes="", cd="", held="SPC1,1,123456,1,4\n").replace("2.1+11,,0.3,7850.", f"{E},,.3,{rho}")
    (tmp_path / "deck.bdf").write_text(text)
    with pytest.raises(BadInput, match=r"its units cannot be told|its densities are weights"):
        deck.described(tmp_path / "deck.bdf")


def in_mm(folder: Path, E: float, rho: str, more: str = "") -> Path:
    text = (
        PLATE.format(axes="", cd="", held=f"SPC1,1,123456,1,4\n{more}")
        .replace(".002", "2.")
        .replace("2.1+11,,0.3,7850.", f"{E},,.3,{rho}")
    )
    (folder / "deck.bdf").write_text(text)
    return folder / "deck.bdf"


@pytest.mark.parametrize(("E", "rho", "now"), [(21e3, "8.-10", 7845.32), (7.2e3, "2.75-10", 2696.82875)])
def test_metals_in_kgf_and_millimetres_are_metals(E: float, rho: str, now: float, tmp_path: Path) -> None:
    """Steel was taken for wood of 800 kg/m³ in mm-t-N-s, and all masses came out 9.8 times too low."""
    said, lost = deck.described(in_mm(tmp_path, E, rho, "CONM2,9,2,,1.-4\n"))
    assert lost == ()
    assert 'units = "mm-kgf-s"' in said
    assert f'density = "{now} kg/m^3"' in said
    assert 'mass = "0.980665 kg"' in said


@pytest.mark.parametrize(
    ("E", "rho", "words"),
    [
        (11e3, "4.5-10", "its units cannot be told: mm-t-N-s and mm-kgf-s make known materials"),  # spruce, or titanium in kgf
        (21e3, "7.85-9", "its units cannot be told: none of"),  # kgf/mm² beside t/mm³
        (21e3, "7.85-6", "its densities are weights, not masses, in mm-kgf-s. Divide them by 9806.65"),
    ],
)
def test_what_may_be_wood_or_metal_in_kgf_is_asked_for(E: float, rho: str, words: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=words):
        deck.described(in_mm(tmp_path, E, rho))
    (tmp_path / "deck.bdf").write_text(in_mm(tmp_path, 11e3, "4.5-10").read_text())
    assert 'density = "450 kg/m^3"' in deck.described(tmp_path / "deck.bdf", "mm-t-N-s")[0]


@pytest.mark.parametrize(("E", "rho"), [(16e9, 11340.0), (1.4e10, 11340.0), (45e9, 1740.0), (3e9, 1200.0), (3.9e11, 19300.0)])
def test_lead_and_what_is_stiffer_or_lighter_is_a_material(E: float, rho: float, tmp_path: Path) -> None:
    text = PLATE.format(axes="", cd="", held="SPC1,1,123456,1,4\n").replace("2.1+11,,0.3,7850.", f"{E},,.3,{rho}")
    (tmp_path / "deck.bdf").write_text(text)
    assert 'units = "m-kg-N-s"' in deck.described(tmp_path / "deck.bdf")[0]


def test_a_third_node_of_a_beam_tells_the_first_axis_of_its_section(tmp_path: Path) -> None:
    """It was refused as a line of three nodes."""
    row = told(tmp_path, pinned("1, 6", ""))[0]
    text = (
        pinned("1, 6", "")
        .replace("*ELEMENT", "9, .5, 0., .02\n*ELEMENT")
        .replace("1, 1, 2\n2, 2, 3\n", "1, 1, 2, 9\n2, 2, 3, 9\n")
    )
    node = told(tmp_path, text.replace("1., 0., 0.\n*B", "0., 1., 0.\n*B"))[0]
    assert row is not None
    assert node is not None
    np.testing.assert_allclose(fixed_base(node, 3).frequency, fixed_base(row, 3).frequency, rtol=1e-9)


def test_some_beams_with_a_third_node_and_some_without_are_said(tmp_path: Path) -> None:
    """The row of their section turned all of them, without a word."""
    text = pinned("1, 6", "").replace("*ELEMENT", "9, .5, 0., .02\n*ELEMENT").replace("2, 2, 3\n", "2, 2, 3, 9\n")
    (lost,) = told(tmp_path, text)[2]
    assert "BEAM SECTION e: which way those of its beams are turned that have a node which says it" in lost
    with pytest.raises(BadInput, match="element 2 is on, or turned by, a node that is not there"):
        told(tmp_path, text.replace("9, .5, 0., .02\n", ""))


def test_a_beam_of_three_nodes_has_a_fourth_that_tells_its_first_axis(tmp_path: Path) -> None:
    """It was refused: «element 1 has 4 nodes where a line3 has 3»."""
    beam = pinned("1, 6", "").replace("1, 1, 2\n2, 2, 3\n", "1, 1, 2, 3{}\n").replace("TYPE=B31", "TYPE=B32")
    row = told(tmp_path, beam.format(""))[0]
    node = beam.replace("*ELEMENT", "9, .5, 0., .02\n*ELEMENT").replace("1., 0., 0.\n*B", "0., 1., 0.\n*B")
    found = told(tmp_path, node.format(", 9"))[0]
    assert row is not None
    assert found is not None
    np.testing.assert_allclose(fixed_base(found, 3).frequency, fixed_base(row, 3).frequency, rtol=1e-9)


@pytest.mark.parametrize(
    ("cards", "lost"),
    [
        ("*NSET, NSET=NONE\n*BOUNDARY\nnone, 1, 3\n", "*BOUNDARY none: the set has no nodes"),
        ("*NSET, NSET=FAR\n77, 78\n*BOUNDARY\nFAR, 1, 3\n", "*BOUNDARY FAR: the set has no nodes"),
        ("*ELSET, ELSET=M\n*MASS, ELSET=M\n.5\n", "*MASS M: its set has no element of that kind"),
        ("*NSET, NSET=NONE\n*RIGID BODY, NSET=NONE, REF NODE=3\n", "RIGID BODY NONE: it joins no node"),
        ("*NSET, NSET=FAR\n77, 78\n", ""),
        ("*BOUNDARY\nFOOT, 11, 11, 20.\n", ""),
        ("*ELEMENT, TYPE=MASS, ELSET=M\n90, 3\n*ELSET, ELSET=Q, GENERATE\n1, 2, 0\n*MASS, ELSET=M\n.5\n", ""),
    ],
)
def test_a_set_without_nodes_is_said_as_solvers_run_on(cards: str, lost: str, tmp_path: Path) -> None:
    """Such a deck was refused as if the set were not there; a temperature was said to be a displacement."""
    assert told(tmp_path, pinned("1, 6", "").replace("*STEP", f"{cards}*STEP"))[2] == ((lost,) if lost else ())


def test_masses_may_stand_before_their_elements_and_sets(tmp_path: Path) -> None:
    """They weighed nothing, and then were refused; CalculiX weighs them."""
    lump, sets = "*ELEMENT, TYPE=MASS, ELSET=L\n90, 3\n", "*ELSET, ELSET=M\nL\n"
    said = []
    for cards in (f"{lump}{sets}*MASS, ELSET=M\n.5\n", f"*MASS, ELSET=M\n.5\n{lump}{sets}", f"*MASS, ELSET=M\n.5\n{sets}{lump}"):
        said.append(told(tmp_path, pinned("1, 6", "").replace("*STEP", f"{cards}*STEP")))
    assert all(one[1:] == said[0][1:] for one in said)
    assert 'mass = "0.5 kg"' in said[0][1]


@pytest.mark.parametrize(
    ("cards", "words"),
    [
        ("*TRANSFORM, NSET=GONE\n0., 1., 0., -1., 0., 0.\n", "`line 20`: TRANSFORM names the set GONE, which is not there"),
        (
            "*SURFACE, NAME=S, TYPE=NODE\nGONE, 1.\n*COUPLING, CONSTRAINT NAME=C, REF NODE=3, SURFACE=S\n*KINEMATIC\n",
            "`line 21`: SURFACE names the set GONE, which is not there",
        ),
    ],
)
def test_whatever_names_a_set_that_is_not_there_is_found(cards: str, words: str, tmp_path: Path) -> None:
    """«line 0: it names the set GONE»."""
    with pytest.raises(BadInput, match=words):
        told(tmp_path, pinned("1, 6", "").replace("*BOUNDARY", f"{cards}*BOUNDARY"))


def test_a_node_of_eight_figures_that_is_not_there_is_found_among_its_neighbours(tmp_path: Path) -> None:
    big = 10_000_000
    text = PLATE.format(axes="", cd="", held="SPC1,1,123456,1,4\n") + f"GRID,{big},,1.,1.,1.\n"
    text = text.replace("ENDDATA\n", "") + f"RBE2    {1:8d}{big:8d}{123456:8d}{3:8d}{big + 9:8d}\nENDDATA\n"
    with pytest.raises(BadInput, match=f"line 10`: RBE2 names node {big + 9}, which is not there"):
        told(tmp_path, text, "deck.bdf")


def test_a_taper_whose_output_is_not_asked_for_is_said(tmp_path: Path) -> None:
    beam = "PBEAML,3,1,,BAR\n,.01,.02,,{},,.005,.01\nCBEAM,9,3,2,3,0.,0.,1.\n"
    for word in ("YES", ""):
        (lost,) = told(tmp_path, PLATE.format(axes="", cd="", held=f"SPC1,1,123456,1,4\n{beam.format(word)}"), "deck.bdf")[2]
        assert lost == "PBEAML 3: a taper; it is as at its first end"


BARS = (
    "MAT1,1,2.1+11,,0.3,7850.\nPBAR,1,1,1.-4,1.-9,1.-9,2.-9\nGRID,1,,0.,0.,0.\nGRID,2,,.1,0.,0.\nGRID,3,,.2,0.,0.\n"
    "CBAR,1,1,1,2,0.,0.,1.\nCBAR,2,1,2,3,0.,0.,1.\nSPC1,1,123456,1\n"
)


def hertz(folder: Path, more: str) -> Array:
    structure, _, lost = told(folder, f"{BARS}{more}ENDDATA\n", "deck.bdf")
    assert lost == ()
    assert structure is not None
    return np.asarray(fixed_base(structure, 6).frequency)


@pytest.mark.parametrize(
    ("ends", "holds"),
    [
        ("50,0", "SPC1,1,0,50"),
        ("50", "SPC1,1,,50"),
        ("50,0", "SPC,1,50,1,0."),
        ("50,0", "SPC,1,50,,0.\nSPOINT,48,THRU,51"),
        ("50", "SPC1,1,1,50\nSPOINT,50"),
    ],
)
def test_a_scalar_point_that_is_held_is_the_ground(ends: str, holds: str, tmp_path: Path) -> None:
    """The spring was lost, or its scalar point said not to be there."""
    wanted = hertz(tmp_path, "CELAS2,9,1.+5,3,2\n")
    assert wanted[1] > 1.1 * hertz(tmp_path, "")[1]  # the first is across it
    np.testing.assert_allclose(hertz(tmp_path, f"CELAS2,9,1.+5,3,2,{ends}\n{holds}\n"), wanted, rtol=1e-9)


def test_masses_of_single_freedoms_make_one_where_they_are_a_bodys(tmp_path: Path) -> None:
    """CMASS1, CMASS2 and CONM1, along axes of their own; all were lost."""
    turned = "CORD2R,3,,0.,0.,0.,0.,0.,1.\n,0.,1.,0.\n"
    wanted = hertz(tmp_path, "CONM2,9,3,,2.5,.03,0.,.01\n,2.-2,0.,3.-2,1.-3,0.,4.-2\n")
    assert wanted[0] < 0.9 * hertz(tmp_path, "")[0]
    # The same about the node; x is -y of system 3, and y its x
    m, S = 2.5, skew(np.array([0.03, 0.0, 0.01]))
    J = np.array([[0.02, 0, -1e-3], [0, 0.03, 0], [-1e-3, 0, 0.04]]) - m * S @ S
    M = np.block([[m * np.eye(3), -m * S], [m * S, J]])
    R = np.kron(np.eye(2), [[0.0, 1.0, 0.0], [-1.0, 0.0, 0.0], [0.0, 0.0, 1.0]])
    for cid, own in (("", M), ("3", R @ M @ R.T)):
        words = [f"{one:.9g}" for one in own[np.tril_indices(6)]]
        rows = [f"CONM1,9,3,{cid},{','.join(words[:5])}", *("," + ",".join(words[k : k + 8]) for k in (5, 13))]
        np.testing.assert_allclose(hertz(tmp_path, "\n".join([turned, *rows, ""])), wanted, rtol=1e-6)
    alike = "".join(f"CMASS2,{k},2.5,3,{k}\n" for k in (1, 2, 3)) + "PMASS,7,.02,8,.03\n"
    alike += "CMASS1,4,7,3,4\nCMASS1,5,8,3,5\nCMASS1,6,8,0,,3,6\n"
    wanted = hertz(tmp_path, "CONM2,9,3,,2.5\n,2.-2,0.,3.-2,0.,0.,3.-2\n")
    np.testing.assert_allclose(hertz(tmp_path, alike), wanted, rtol=1e-9)
    beside = alike.partition("PMASS")[2].join(["PMASS", "CONM2,9,3,,2.5\n"])
    np.testing.assert_allclose(hertz(tmp_path, beside), wanted, rtol=1e-9)


@pytest.mark.parametrize(
    ("more", "words"),
    [
        ("CMASS2,9,2.5,3,1\n", "CMASS2 9: its mass is not alike in all directions, as that of a body is"),
        ("CMASS2,9,2.5,3,4\n", "CMASS2 9: no mass is at its node"),
        ("CMASS2,9,2.5,3,1,2,1\n", "CMASS2 9: it joins two motions, or its mass is not here"),
        ("CELAS2,9,1.+5,3,2,50\n", "CELAS2 9: it ends at a scalar point that moves"),
    ],
)
def test_masses_of_no_body_and_scalar_points_that_move_are_lost(more: str, words: str, tmp_path: Path) -> None:
    assert told(tmp_path, f"{BARS}{more}ENDDATA\n", "deck.bdf")[2] == (words,)


CALLS = "SOL 103\nCEND\n{}\nBEGIN BULK\n" + BARS + "SPC1,2,123456,3\n{}ENDDATA\n"


@pytest.mark.parametrize("calls", ["INCLUDE 'case.inc'", "$ BEGIN BULK is below\nSPC = 2 $ the tip", "SPC 2", "spc=2"])
def test_what_the_case_control_calls_is_held_wherever_it_stands(calls: str, tmp_path: Path) -> None:
    """Of a file that it includes it was said to call none, and a comment that names BEGIN BULK ended it."""
    (tmp_path / "case.inc").write_text("METHOD = 1\nSPC = 2\n")
    _, said, lost = told(tmp_path, CALLS.format(calls, ""), "deck.bdf")
    assert lost == ()
    assert "nodes = [3]" in said


def test_a_set_that_is_called_and_is_not_there_is_said(tmp_path: Path) -> None:
    """The only one that is there was taken in its place. One that is added up in another is no choice."""
    (lost,) = told(tmp_path, CALLS.format("SPC = 7", "").replace("SPC1,2,123456,3\n", ""), "deck.bdf")[2]
    assert lost == "SPC set 7: the case control calls it, and it is not there"
    both = told(tmp_path, BARS + "SPC1,2,123456,3\nSPCADD,5,1,2\nENDDATA\n", "deck.bdf")
    assert both[2] == ()
    assert both[1].count("[fe_model.links.") == 2


def test_an_included_file_of_the_case_control_that_is_not_there_is_refused(tmp_path: Path) -> None:
    """It may call what holds the structure; one of the orders before CEND is the program's own."""
    with pytest.raises(BadInput, match=r"line 3`: it includes 'case.inc', which is not there"):
        told(tmp_path, CALLS.format("INCLUDE 'case.inc'", ""), "deck.bdf")
    assert told(tmp_path, "INCLUDE 'alter.v9'\n" + CALLS.format("SPC=1", ""), "deck.bdf")[2] == ()


@pytest.mark.parametrize(
    ("was", "now", "words"),
    [
        ("CBAR,2,1,2,3,0.,0.,1.", "CBAR,2,1,2,3,77", "G0 of beam 2, which tells how it is turned, is node 77, which is not"),
        ("SPC1", "PBUSH,8,K,1.+5\nCBUSH,8,8,3,,,,,5\nSPC1", r"deck.bdf: `CORD`: the coordinate system 5 is not there. Include"),
    ],
)
def test_what_turns_something_and_is_not_there_is_named(was: str, now: str, words: str, tmp_path: Path) -> None:
    """A beam was said to lie along its own z axis, and a spring's system to be a record that cannot be read."""
    with pytest.raises(BadInput, match=words):
        told(tmp_path, BARS.replace(was, now) + "ENDDATA\n", "deck.bdf")


FREQUENCIES = "*STEP\n*FREQUENCY\n4\n{}*END STEP\n"
FOOT, TIP = "*BOUNDARY\nFOOT, 1, 6\n", "*BOUNDARY{0}\nTIP, 1, 3\n*BOUNDARY{0}\nTIP, 4, 6\n"


@pytest.mark.parametrize(
    ("steps", "held"),
    [
        (FOOT + FREQUENCIES.format(TIP.format(", OP=NEW")), "Tip"),
        ("*STEP\n*STATIC\n*END STEP\n" + FREQUENCIES.format(FOOT), "Root"),
        (FOOT + FREQUENCIES.format("") + FREQUENCIES.format(TIP.format("")), "Root"),
    ],
)
def test_what_is_held_is_that_of_the_step_of_frequencies(steps: str, held: str, tmp_path: Path) -> None:
    """`OP=NEW` lets go of all before it, as in CalculiX, which had been held as well; and of a second step nothing was held."""
    text = pinned("1, 6", "").replace("*NSET, NSET=Foot", "*NSET, NSET=Tip\n3\n*NSET, NSET=Foot")
    _, said, lost = told(tmp_path, text.partition("*BOUNDARY")[0] + steps)
    assert lost == ()
    assert f'nodes = ["{held}"]' in said
    assert said.count("[fe_model.links.") == 1
    assert "[fe_model.holds" not in said


@pytest.mark.parametrize("word", ["SHELL GENERAL", "MEMBRANE"])
def test_shells_of_a_section_that_is_not_known_are_lost_beside_solids(word: str, tmp_path: Path) -> None:
    """They weighed nothing and held nothing, without a word."""
    nodes = "".join(f"{1 + i + 2 * j + 4 * k}, {i}., {j}., {k}.\n" for k in range(2) for j in range(2) for i in range(2))
    cells = "*ELEMENT, TYPE=C3D8, ELSET=B\n1, 1, 2, 4, 3, 5, 6, 8, 7\n*ELEMENT, TYPE=S4, ELSET=T\n2, 5, 6, 8, 7\n"
    text = (
        f"*NODE\n{nodes}{cells}{MATERIAL}*SOLID SECTION, ELSET=B, MATERIAL=STEEL\n*{word} SECTION, ELSET=T, MATERIAL=STEEL\n.01\n"
    )
    assert told(tmp_path, text + STEP)[2] == (f"*{word} SECTION T: a keyword that is not known here",)
