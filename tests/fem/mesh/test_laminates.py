"""Layers of a deck: closed forms of plates and strips, CalculiX's composite shells, and where fibres and faces are."""

import os
import re
import shutil
import subprocess
from pathlib import Path

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.mesh import deck, model, shells
from fem.modes import lowest
from fem.structure import Structure
from geometry.errors import BadInput
from geometry.frames import Array

E1, E2, NU, G12, G13, G23, RHO = 130e3, 9e3, 0.3, 5e3, 4e3, 3e3, 1.6e-9
CARBON = f"MAT8,2,{E1},{E2},{NU},{G12},{G13},{G23},{RHO}"
"""A layer of carbon fibres, in N, mm and t."""


def described(lines: list[str], folder: Path) -> Structure:
    (folder / "one.bdf").write_text("\n".join(["BEGIN BULK", *lines, "ENDDATA", ""]))
    written, lost = deck.described(folder / "one.bdf", "mm-t-N-s")
    assert lost == ()
    (folder / "one.toml").write_text(written)
    return model.load(folder / "one.toml")[1]


def hertz(made: Structure, count: int = 4) -> Array:
    return np.asarray(np.sqrt(lowest(made.stiffness, made.mass, count).values) / (2 * np.pi))


def rectangle(a: float, b: float, n: int, m: int, more: str = "", turn: int = 0) -> list[str]:
    """Grid points and quadrilaterals of a x b mm, whose first node is the `turn`-th corner."""
    lines = [f"GRID,{1 + i + (n + 1) * j},,{a * i / n},{b * j / m},0." for j in range(m + 1) for i in range(n + 1)]
    for i in range(n):
        for j in range(m):
            ring = [1 + i + p + (n + 1) * (j + q) for p, q in ((0, 0), (1, 0), (1, 1), (0, 1))]
            ring = ring[turn:] + ring[:turn]
            lines.append(f"CQUAD4,{1 + i + n * j},1,{','.join(map(str, ring))}{more}")
    return lines


def edge(n: int, m: int, side: int) -> list[int]:
    """Numbers of nodes at x = 0, x = a, y = 0, y = b."""
    number = np.arange(1, (n + 1) * (m + 1) + 1).reshape(m + 1, n + 1)
    return [number[:, 0], number[:, -1], number[0], number[-1]][side].tolist()


def clamped(n: int, m: int, sides: tuple[int, ...] = (0,), letters: tuple[str, ...] = ("123456",)) -> list[str]:
    return [f"SPC1,1,{held},{node}" for side, held in zip(sides, letters, strict=True) for node in edge(n, m, side)]


def comp(*layers: tuple[float, float], material: int = 2, head: str = "") -> str:
    """PCOMP of (thickness, angle)."""
    words = [f"{material},{t},{angle},YES" for t, angle in layers]
    return "\n".join([f"PCOMP,1{head}", *("," + ",".join(words[k : k + 2]) for k in range(0, len(words), 2))])


def navier(D: Array, S: Array, masses: Array, size: tuple[float, float], waves: tuple[int, int]) -> float:
    """[Hz] of a rectangle on simple supports that shears (Reddy, Mechanics of Laminated Composite Plates, 2004, section 6.5)."""
    x, y = (np.pi * k / length for k, length in zip(waves, size, strict=True))
    K = np.array(
        [
            [S[0, 0] * x**2 + S[1, 1] * y**2, S[0, 0] * x, S[1, 1] * y],
            [S[0, 0] * x, D[0, 0] * x**2 + D[2, 2] * y**2 + S[0, 0], (D[0, 1] + D[2, 2]) * x * y],
            [S[1, 1] * y, (D[0, 1] + D[2, 2]) * x * y, D[2, 2] * x**2 + D[1, 1] * y**2 + S[1, 1]],
        ]
    )
    return float(np.sqrt(eigh(K, np.diag([masses[0], masses[2], masses[2]]), eigvals_only=True)[0]) / (2 * np.pi))


def layer(angle: float, thickness: float, across: tuple[float, float] = (G13, G23)) -> shells.Layer:
    minor = 1 - NU**2 * E2 / E1
    plane = 1e6 * np.array([[E1 / minor, NU * E2 / minor, 0], [NU * E2 / minor, E2 / minor, 0], [0, 0, G12]])
    moduli = 1e6 * np.array(across)
    return shells.Layer(plane=plane, across=moduli, angle=np.radians(angle), thickness=thickness / 1e3, density=RHO * 1e12)


@pytest.mark.parametrize(("thickness", "cost"), [(0.5, 0.02), (8.0, 0.25)])
def test_a_cross_ply_plate_has_naviers_frequencies(thickness: float, cost: float, tmp_path: Path) -> None:
    """[0/90]s on simple supports, 300 x 200 mm, 2 and 32 mm thick: errors fall with the square of the elements' size."""
    angles = (0.0, 90.0, 90.0, 0.0)
    laminate = shells.Laminate.of([layer(angle, thickness) for angle in angles])
    waves = [(i, j) for i in range(1, 5) for j in range(1, 4)]
    every = sorted(navier(laminate.bending, laminate.shear, laminate.masses, (0.3, 0.2), one) for one in waves)
    wanted, off = np.array(every[:4]), []
    for n, m in ((12, 8), (24, 16)):
        held = [f"SPC1,1,126,1,THRU,{(n + 1) * (m + 1)}"]
        held += clamped(n, m, (0, 1, 2, 3), ("34", "34", "35", "35"))
        lines = [CARBON, comp(*((thickness, angle) for angle in angles)), *rectangle(300.0, 200.0, n, m), *held]
        off.append(hertz(described(lines, tmp_path)) / wanted - 1)
    assert np.abs(off[1]).max() < 0.01
    assert np.linalg.norm(off[1]) < 0.32 * np.linalg.norm(off[0])
    stiff = shells.Laminate.of([layer(angle, thickness, (np.inf, np.inf)) for angle in angles])
    assert not stiff.shear.any()
    thin = navier(laminate.bending, 1e6 * laminate.shear, laminate.masses, (0.3, 0.2), (1, 1))
    assert 0 < 1 - wanted[0] / thin < cost  # what shear takes off


def test_shear_is_that_of_one_layer_and_of_a_sandwich() -> None:
    one = shells.Laminate.of([layer(0.0, 3.0)])
    np.testing.assert_allclose(np.diag(one.shear), 5 / 6 * 3e-3 * 1e6 * np.array([G13, G23]), rtol=1e-12)
    four = shells.Laminate.of(4 * [layer(0.0, 0.75)])
    np.testing.assert_allclose(four.shear, one.shear, rtol=1e-12)
    np.testing.assert_allclose(four.bending, one.bending, rtol=1e-12)
    core = shells.Layer(plane=np.zeros((3, 3)), across=np.array([2e8, 1e8]), angle=0.0, thickness=20e-3, density=50.0)
    skin = layer(0.0, 0.5, (np.inf, np.inf))
    apart = 20.5e-3  # of the middles of thin faces: G d² / h, but for their own bending
    wanted = np.array([2e8, 1e8]) * apart**2 / 20e-3
    np.testing.assert_allclose(np.diag(shells.Laminate.of([skin, core, skin]).shear), wanted, rtol=1e-3)


def strip(prop: str, *more: str, length: float = 400.0, width: float = 20.0, count: int = 20, quad: str = "") -> list[str]:
    return [*rectangle(length, width, count, 2, quad), prop, *clamped(count, 2), *more]


def test_two_metals_bend_about_their_own_neutral_axis(tmp_path: Path) -> None:
    """Steel on aluminium, 2 and 3 mm, none of which narrows as it is pulled: Euler's cantilever, wherever its nodes are."""
    metals = ["MAT1,1,210000.,,0.,7.85-9", "MAT1,2,70000.,,0.,2.7-9"]
    stack = [(3.0, 70e3, 2.7e-9), (2.0, 210e3, 7.85e-9)]
    ends = np.cumsum([0.0, *(t for t, _, _ in stack)])
    middles = (ends[1:] + ends[:-1]) / 2
    EA, m = (np.array([t * value[k] for t, *value in stack]) for k in (0, 1))
    axis = EA @ middles / EA.sum()
    bending = sum(EA[k] * ((middles[k] - axis) ** 2 + stack[k][0] ** 2 / 12) for k in range(2))
    wanted = 1.8751041**2 * np.sqrt(bending / (m.sum() * 400.0**4)) / (2 * np.pi)
    for head, quad in (("", ""), (",0.", ""), ("", ",,3.5")):
        prop = f"PCOMP,1{head}\n,2,3.,0.,YES,1,2.,0.,YES"
        assert hertz(described(strip(prop, *metals, quad=quad), tmp_path), 1)[0] == pytest.approx(wanted, rel=2e-3)


def test_a_layered_shell_beside_its_nodes_lets_rigid_motions_pass(tmp_path: Path) -> None:
    """An unbalanced laminate of elements of every side first, off their nodes: no force, and the mass of what is there."""
    lines = [CARBON, comp((1.0, 0.0), (0.5, 45.0), (0.7, -20.0), head=",.4,1.-9"), *rectangle(90.0, 60.0, 3, 2, ",30.,2.5", 1)]
    made = described(lines, tmp_path)
    rigid = made.rigid
    assert np.abs(made.stiffness @ rigid).max() < 1e-9 * abs(made.stiffness).max()
    M, area = made.rigid_mass, 90.0 * 60.0
    assert M[0, 0] == pytest.approx(1e3 * area * (2.2 * RHO + 1e-9), rel=1e-8)
    assert 1e3 * M[0, 4] / M[0, 0] == pytest.approx(0.4 + 1.1 + 2.5, rel=1e-8)  # digits of the description


def test_fibres_lie_where_the_layer_the_element_or_a_system_says(tmp_path: Path) -> None:
    """Along y: by the angle of the layer, of the element, of one whose first side is across, and by the axis of a system."""
    system = "CORD2R,5,,0.,0.,0.,0.,0.,1.\n,0.,1.,0."
    found = []
    for angle, quad, turn in (
        (90.0, "", 0),
        (0.0, ",90.", 0),
        (0.0, "", 1),
        (0.0, ",5", 0),
        (60.0, ",30.", 0),
        (45.0, ",-45.", 1),
    ):
        lines = [CARBON, system, comp((1.0, angle), (1.0, angle)), *clamped(6, 4), *rectangle(120.0, 80.0, 6, 4, quad, turn)]
        found.append(hertz(described(lines, tmp_path)))
    np.testing.assert_allclose(found, np.tile(found[0], (6, 1)), rtol=1e-5)
    text = (tmp_path / "one.toml").read_text()
    (tmp_path / "one.toml").write_text(
        text.replace("layers =", "x_axis = [0, 1, 0]\nlayers =").replace("angle = 45", "angle = 0")
    )
    np.testing.assert_allclose(hertz(model.load(tmp_path / "one.toml")[1]), found[0], rtol=1e-5)
    (tmp_path / "one.toml").write_text(text.replace("angle = 45", "angle = -45"))
    assert hertz(model.load(tmp_path / "one.toml")[1])[0] > 3 * found[0][0]  # along x


def test_layers_grow_with_their_thickness_and_all_with_the_modulus(tmp_path: Path) -> None:
    """Shares that grow with the thickness and its cube are what layers 0.1 % thicker say; whole laminates scale with moduli."""
    made = []
    for factor in (1.0, 1.001, 0.999):
        layers = [(factor * t, angle) for t, angle in ((3.0, 0.0), (1.5, 45.0), (2.0, 90.0))]
        made.append(described([CARBON, comp(*layers), *rectangle(90.0, 60.0, 3, 2, ",,4.")], tmp_path))
    linear, cubic = made[0].sections["1"]
    K = made[0].stiffness
    assert abs(linear + cubic - K).max() < 1e-12 * abs(K).max()
    slope = (made[1].stiffness - made[2].stiffness) / 0.002
    assert abs(linear + 3 * cubic - slope).max() < 1e-5 * abs(slope).max()
    stiffer = CARBON.replace(",".join(map(str, (E1, E2))), f"{2 * E1},{2 * E2}").replace(
        ",".join(map(str, (G12, G13, G23))), f"{2 * G12},{2 * G13},{2 * G23}"
    )
    double = described([stiffer, comp((3.0, 0.0), (1.5, 45.0), (2.0, 90.0)), *rectangle(90.0, 60.0, 3, 2, ",,4.")], tmp_path)
    assert abs(double.stiffness - 2 * K).max() < 1e-12 * abs(K).max()


def test_the_core_of_a_sandwich_shears_by_either_of_its_moduli(tmp_path: Path) -> None:
    """A MAT8 in place of a MAT1 alike, and none that is not there."""
    E, G, plate = 210e3, 80.0, [*clamped(6, 4), *rectangle(120.0, 80.0, 6, 4)]
    faces, shell = f"MAT1,1,{E},,.3,7.85-9", "PSHELL,1,1,1.,1,30.,3,5."
    wanted = hertz(described([faces, f"MAT1,3,{2.6 * G},,.3,1.-12", shell, *plate], tmp_path))
    stiff = hertz(described([faces, "PSHELL,1,1,1.,1,30.", *plate], tmp_path))
    assert stiff[0] > 1.1 * wanted[0]
    found = hertz(described([faces, f"MAT8,3,1.,1.,.3,1.,{G},{G},1.-12", shell, *plate], tmp_path))
    np.testing.assert_allclose(found, wanted, rtol=1e-6)
    (tmp_path / "one.bdf").write_text("\n".join([faces, shell, *plate, "ENDDATA", ""]))
    assert deck.described(tmp_path / "one.bdf", "mm-t-N-s")[1] == ("PSHELL 1: no material 3 of its core is known here",)


def test_a_shell_that_bends_otherwise_than_its_thickness_says_is_a_sandwich(tmp_path: Path) -> None:
    """12 I / t³ and ts / t of faces of 0.6 mm on a core of 12 mm, as spacecraft panels are written; the same as layers.

    What is beside its own mass has the radius of gyration of its faces, which the fourth mode feels.
    """
    t, h, G = 0.6, 12.0, 150.0
    ratio = 12 * (t**3 / 6 + t * (h + t) ** 2 / 2) / (2 * t) ** 3
    metals = ["MAT1,1,70000.,,.3,2.7-9", f"MAT1,3,,{G},.3", f"MAT8,4,1.,1.,0.,1.,{G},{G}"]
    shear = (h + t) ** 2 / h / (2 * t)
    for nsm, rtol in ((0.0, 5e-4), (1e-9, 6e-3)):
        one = described(strip(f"PSHELL,1,1,{2 * t},1,{ratio},3,{shear},{nsm}", *metals, width=80.0), tmp_path)
        ply = f"1,{t},0.,YES"
        layers = described(strip(f"PCOMP,1,,{nsm}\n,{ply},4,{h},0.,YES\n,{ply}", *metals, width=80.0), tmp_path)
        np.testing.assert_allclose(hertz(one), hertz(layers), rtol=rtol)
    assert hertz(one)[0] > 10 * hertz(described(strip(f"PSHELL,1,1,{2 * t},1,,1,,1.-9", *metals, width=80.0), tmp_path))[0]


SOFTER = "MAT1,1,70000.,,.3,2.7-9\nMAT1,2,28000.,,.3,1.-9\nMAT1,4,70000.,,.3,9.-9\nMAT1,5,,{G},.3"


def bends(prop: str, folder: Path, G: float = 27e3) -> Array:
    return hertz(described(strip(prop, *SOFTER.format(G=G).splitlines(), width=80.0), folder), 12)


@pytest.mark.parametrize(("fields", "ratio"), [("1,,4", 1.0), ("1,.4,1", 0.4), ("2,,1", 0.4), ("2,2.,1", 0.8), ("4,,4", 1.0)])
def test_a_shell_bends_by_its_second_material_and_ratio(fields: str, ratio: float, tmp_path: Path) -> None:
    """Bent by D, stretched by A: frequencies of bending go as the root of the ratio, those of stretching stay.

    Less than its thickness, or by a material of another number, had been lost.
    """
    plain, found = bends("PSHELL,1,1,6.,1,,1", tmp_path), bends(f"PSHELL,1,1,6.,{fields}", tmp_path)
    np.testing.assert_allclose(found[:2] / plain[:2], np.sqrt(ratio), rtol=2e-3)  # one that is not as thick shears
    across = plain[np.argmin(np.abs(plain / plain[0] / (80.0 / 6.0) - 1))]  # a strip is bent upright where its plane is stretched
    assert np.abs(found / across - 1).min() < 1e-5


def test_a_shell_shears_by_its_third_material(tmp_path: Path) -> None:
    """G of 3 MPa over 12 mm: a strip of 400 mm bends as a beam of Timoshenko, which had been left out without a word."""
    E, t, G, long, rho = 70e3, 12.0, 3.0, 400.0, 2.7e-9
    prop = f"PSHELL,1,1,{t},1,,{{}}"
    stiff, soft = (hertz(described(strip(prop.format(of), *SOFTER.format(G=G).splitlines()), tmp_path))[0] for of in (1, 5))
    bend, shear = 1.8751**2 / long**2 * np.sqrt(E * t**2 / 12 / rho), np.pi / 2 / long * np.sqrt(5 / 6 * G / rho)
    dunkerley = 1 / np.sqrt(1 / bend**2 + 1 / shear**2) / (2 * np.pi)
    np.testing.assert_allclose(stiff, bend / (2 * np.pi), rtol=0.02)
    np.testing.assert_allclose(soft, dunkerley, rtol=0.04)  # which is a lower bound


@pytest.mark.parametrize(
    ("prop", "words"),
    [
        ("PSHELL,1,1,1.", "it does not bend (MID2), and bends as its thickness says here"),
        ("PSHELL,1,1,1.,-1", "it does not bend (MID2), and bends as its thickness says here"),
        ("PSHELL,1,,1.,1", "it has no stiffness in its plane (MID1), and has that of its bending (MID2) here"),
        (
            "PSHELL,1,1,1.,7",
            "it bends by a material that is unlike MID1 or not known here (MID2), and bends as its thickness says here",
        ),
        ("PSHELL,1,1,1.,1,,1\n,,,5", "its bending is coupled with its stretching (MID4)"),
    ],
)
def test_what_one_layer_cannot_say_of_a_shell_is_lost(prop: str, words: str, tmp_path: Path) -> None:
    (tmp_path / "one.bdf").write_text("\n".join([*strip(prop, SOFTER.format(G=1.0)), "ENDDATA", ""]))
    assert deck.described(tmp_path / "one.bdf", "mm-t-N-s")[1] == (f"PSHELL 1: {words}",)


@pytest.mark.parametrize(
    ("change", "words"),
    [
        (('thickness = "0.001 m", angle = 0 }', 'thickness = "0.001 m", angle = "up" }'), "a number of degrees"),
        (("layers =", 'thickness = "1 mm"\nlayers ='), "left out beside `layers`"),
        (("poisson_ratio = 0.3", "poisson_ratio = 9"), "Poisson's ratio of strain across"),
        (("layers =", "x_axis = [0, 0]\nlayers ="), "three numbers that are a direction"),
        (("angle = 0", "turned = 0"), "unknown"),
        (("angle = 0", "angle = nan"), "a number of degrees"),
        (("poisson_ratio = 0.3", "poisson_ratio = nan"), "Poisson's ratio of strain across"),
    ],
)
def test_layers_that_are_none_are_refused(change: tuple[str, str], words: str, tmp_path: Path) -> None:
    described([CARBON, comp((1.0, 0.0), (1.0, 90.0)), *rectangle(90.0, 60.0, 3, 2)], tmp_path)
    text = (tmp_path / "one.toml").read_text()
    assert change[0] in text
    (tmp_path / "one.toml").write_text(text.replace(*change, 1))
    with pytest.raises(BadInput, match=words):
        model.load(tmp_path / "one.toml")


def test_layers_that_do_not_resist_shear_in_their_plane_are_refused_and_crossed_ones_without_stiffness_across_are_not(
    tmp_path: Path,
) -> None:
    """G12 of a MAT8 is zero where the card leaves it out; fibres alone, along and across, are a net."""
    plate = [*clamped(6, 4), *rectangle(120.0, 80.0, 6, 4)]
    with pytest.raises(BadInput, match="stiff in their plane along it, across it and in shear"):
        described([f"MAT8,2,{E1},{E2},{NU},,,,{RHO}", comp((1.0, 0.0), (1.0, 90.0)), *plate], tmp_path)
    net = described([f"MAT8,2,{E1},0.,0.,{G12},,,{RHO}", comp((1.0, 0.0), (1.0, 90.0), (1.0, 0.0)), *plate], tmp_path)
    assert hertz(net)[0] > 0


@pytest.mark.parametrize("beside", ['offset = "5 mm"', "x_axis = [1, 0, 0]"])
def test_what_is_of_layers_is_refused_where_there_are_none(beside: str, tmp_path: Path) -> None:
    plate = [f"MAT1,1,{E1},,.3,{RHO}", "PSHELL,1,1,2.,1,,1", *clamped(6, 4), *rectangle(120.0, 80.0, 6, 4)]
    described(plate, tmp_path)
    text = (tmp_path / "one.toml").read_text()
    assert "thickness =" in text
    (tmp_path / "one.toml").write_text(text.replace("thickness =", f"{beside}\nthickness =", 1))
    with pytest.raises(BadInput, match="left out where there are no `layers`"):
        model.load(tmp_path / "one.toml")


def abaqus(section: str, elastic: str, density: float, more: str = "") -> str:
    """The clamped plate of 120 x 80 mm of `rectangle` in words of Abaqus."""
    lines = ["*NODE", *(line.removeprefix("GRID,").replace(",,", ",") for line in rectangle(120.0, 80.0, 6, 4) if "GRID" in line)]
    lines += ["*ELEMENT, TYPE=S4, ELSET=P"]
    rings = [line.split(",") for line in rectangle(120.0, 80.0, 6, 4) if "CQUAD4" in line]
    lines += [",".join([row[1], *row[3:]]) for row in rings]
    lines += ["*MATERIAL, NAME=M", f"*ELASTIC{elastic}", "*DENSITY", f"{density}", more, section, "*BOUNDARY"]
    return "\n".join([*(one for one in lines if one), *(f"{node}, 1, 6" for node in edge(6, 4, 0)), ""])


ORIENTED = "*ORIENTATION, NAME=O\n0., 1., 0., -1., 0., 0.\n3, 15."


@pytest.mark.parametrize(
    ("section", "prop", "quad"),
    [
        ("*SHELL SECTION, ELSET=P, COMPOSITE\n1., 3, M, 30.\n.5, 3, M, -45.", comp((1.0, 30.0), (0.5, -45.0)), ""),
        (
            f"{ORIENTED}\n*SHELL SECTION, ELSET=P, COMPOSITE, ORIENTATION=O, OFFSET=SPOS\n1., , M\n2., , M, 40.",
            comp((1.0, 105.0), (2.0, 145.0), head=",-3."),
            "",
        ),
        ("*SHELL SECTION, ELSET=P, MATERIAL=M, OFFSET=-0.25\n2.", comp((2.0, 0.0)), ",,.5"),
    ],
)
@pytest.mark.parametrize("kind", ["LAMINA", "ENGINEERING CONSTANTS", ""])
def test_layers_of_abaqus_are_those_of_nastran(section: str, prop: str, quad: str, kind: str, tmp_path: Path) -> None:
    moduli = {
        "LAMINA": f"{E1}, {E2}, {NU}, {G12}, {G13}, {G23}",
        "ENGINEERING CONSTANTS": f"{E1}, {E2}, {E2}, {NU}, {NU}, 0.3, {G12}, {G13}\n{G23}",
        "": f"{E2}, {NU}",
    }[kind]
    word = f", TYPE={kind}" if kind else ""
    (tmp_path / "two.inp").write_text(abaqus(section, f"{word}\n{moduli}", RHO))
    written, lost = deck.described(tmp_path / "two.inp", "mm-t-N-s")
    assert lost == ()
    (tmp_path / "two.toml").write_text(written)
    card = CARBON if kind else f"MAT1,2,{E2},,{NU},{RHO}"
    wanted = hertz(described([card, prop, *clamped(6, 4), *rectangle(120.0, 80.0, 6, 4, quad)], tmp_path))
    np.testing.assert_allclose(hertz(model.load(tmp_path / "two.toml")[1]), wanted, rtol=1e-6)


CROSS = f", TYPE=LAMINA\n{E1}, {E2}, {NU}, {G12}, {G13}, {G23}"
ONE = "*SHELL SECTION, ELSET=P, COMPOSITE\n1., 3, M, 0."


def of_abaqus(text: str, folder: Path, *lost: str) -> np.ndarray:
    (folder / "two.inp").write_text(text)
    written, said = deck.described(folder / "two.inp", "mm-t-N-s")
    assert said == lost
    (folder / "two.toml").write_text(written)
    return hertz(model.load(folder / "two.toml")[1])


def test_fibres_of_a_wall_across_x_are_along_z(tmp_path: Path) -> None:
    """Of Abaqus without an orientation: along x, and along z where x is upright on the shell; its length is along y here."""
    text = re.sub(r"^(\d+),([\d.]+),([\d.]+),0\.$", r"\1, 0., \2, \3", abaqus(ONE, CROSS, RHO), flags=re.MULTILINE)
    assert "\n1, 0., 0.0, 0.0\n" in text
    wanted = hertz(described([CARBON, comp((1.0, 90.0)), *clamped(6, 4), *rectangle(120.0, 80.0, 6, 4)], tmp_path))
    np.testing.assert_allclose(of_abaqus(text, tmp_path), wanted, rtol=1e-6)


def test_layers_of_abaqus_that_are_symmetric_are_there_twice(tmp_path: Path) -> None:
    half = "*SHELL SECTION, ELSET=P, COMPOSITE, SYMMETRIC\n1., 3, M, 0.\n.5, 3, M, 90."
    whole = comp((1.0, 0.0), (0.5, 90.0), (0.5, 90.0), (1.0, 0.0))
    wanted = hertz(described([CARBON, whole, *clamped(6, 4), *rectangle(120.0, 80.0, 6, 4)], tmp_path))
    np.testing.assert_allclose(of_abaqus(abaqus(half, CROSS, RHO), tmp_path), wanted, rtol=1e-6)


def test_fibres_turn_with_the_instance_that_they_are_of(tmp_path: Path) -> None:
    """Two plates with fibres of one name each, turned by a quarter and by 30 degrees: each frequency is there twice."""
    flat = abaqus("", "", 1.0).split("*MATERIAL")[0]
    foot = f"*NSET, NSET=FOOT\n{', '.join(map(str, edge(6, 4, 0)))}\n"
    ways = ("*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n3, 0.", "*ORIENTATION, NAME=O\n0., 1., 5., 1., 0., 5., 0., 0., 5.")
    section = "\n*SHELL SECTION, ELSET=P, COMPOSITE, ORIENTATION=O\n1., 3, M, {}.\n"
    text = "".join(
        f"*PART, NAME=P{k}\n{flat}{foot}{way}{section.format(angle)}*END PART\n"
        for k, (way, angle) in enumerate(zip(ways, (0, -90), strict=True))
    )
    text += "*ASSEMBLY, NAME=A\n*INSTANCE, NAME=I, PART=P0\n900., 0., 0.\n0., 0., 0., 0., 0., 1., 90.\n*END INSTANCE\n"
    text += "*INSTANCE, NAME=J, PART=P1\n0., 0., 0.\n0., 0., 0., 0., 0., 1., 30.\n*END INSTANCE\n*END ASSEMBLY\n"
    text += f"*MATERIAL, NAME=M\n*ELASTIC{CROSS}\n*DENSITY\n{RHO}\n"
    found = of_abaqus(f"{text}*BOUNDARY\nI.FOOT, 1, 6\nJ.FOOT, 1, 6\n", tmp_path)
    wanted = hertz(described([CARBON, comp((1.0, 0.0)), *clamped(6, 4), *rectangle(120.0, 80.0, 6, 4)], tmp_path))
    np.testing.assert_allclose(found, np.repeat(wanted, 2)[: len(found)], rtol=1e-6)


@pytest.mark.parametrize(
    ("head", "lost"),
    [
        ("*ORIENTATION, NAME=O, DEFINITION=NODES\n1, 2, 8", "*ORIENTATION O: axes that are not of one rectangular system"),
        ("*ORIENTATION, NAME=O\n1., 0., 0., 0., 1., 0.\n1, 0.", "*ORIENTATION O: axes that are not of one rectangular system"),
        ("", "*SHELL SECTION of P: no orientation O is there"),
    ],
)
def test_an_orientation_that_is_not_read_is_said(head: str, lost: str, tmp_path: Path) -> None:
    section = "*SHELL SECTION, ELSET=P, COMPOSITE, ORIENTATION=O\n1., 3, M, 0."
    (tmp_path / "two.inp").write_text(abaqus(section, CROSS, RHO, head))
    (said,) = deck.described(tmp_path / "two.inp", "mm-t-N-s")[1]
    assert said.startswith(lost)


def test_an_axis_that_is_upright_on_a_shell_says_nothing_of_it(tmp_path: Path) -> None:
    upright = "*ORIENTATION, NAME=O\n0., 0., 1., 1., 0., 0."
    (tmp_path / "two.inp").write_text(
        abaqus(
            f"{upright}\n*SHELL SECTION, ELSET=P, COMPOSITE, ORIENTATION=O\n1., 3, M, 0.",
            f", TYPE=LAMINA\n{E1}, {E2}, {NU}, {G12}, {G13}, {G23}",
            RHO,
        )
    )
    (tmp_path / "two.toml").write_text(deck.described(tmp_path / "two.inp", "mm-t-N-s")[0])
    wanted = hertz(described([CARBON, comp((1.0, 0.0)), *clamped(6, 4), *rectangle(120.0, 80.0, 6, 4)], tmp_path))
    np.testing.assert_allclose(hertz(model.load(tmp_path / "two.toml")[1]), wanted, rtol=1e-6)


CALCULIX = shutil.which(os.environ.get("CALCULIX", "ccx"))


@pytest.mark.skipif(CALCULIX is None, reason="CalculiX is not installed")
@pytest.mark.parametrize("angles", [(0.0, 90.0, 90.0, 0.0), (0.0, 30.0, 90.0, -60.0)])
def test_calculix_has_the_frequencies_of_a_laminate(angles: tuple[float, ...], tmp_path: Path) -> None:
    """A cantilever of 160 x 80 mm, four layers of 1 mm, symmetric and not; its S8R are solids of a layer each, and clamp so."""
    n, m, step = 8, 4, 10.0
    number = {(i, j): 1 + i + 100 * j for j in range(2 * m + 1) for i in range(2 * n + 1) if not i % 2 or not j % 2}
    lines = [
        "*NODE, NSET=ALL",
        *(f"{k}, {step * i}, {step * j}, 0." for (i, j), k in number.items()),
        "*ELEMENT, TYPE=S8R, ELSET=P",
    ]
    around = ((0, 0), (2, 0), (2, 2), (0, 2), (1, 0), (2, 1), (1, 2), (0, 1))
    for i in range(n):
        for j in range(m):
            ring = ", ".join(str(number[2 * i + a, 2 * j + b]) for a, b in around)
            lines.append(f"{1 + i + n * j}, {ring}")
    lines += ["*NSET, NSET=FOOT", *(f"{k}," for (i, _), k in number.items() if i == 0)]
    lines += ["*MATERIAL, NAME=CARBON", "*ELASTIC, TYPE=ENGINEERING CONSTANTS"]
    lines += [f"{E1}, {E2}, {E2}, {NU}, {NU}, 0.3, {G12}, {G13}", f"{G23}, 0.", "*DENSITY", f"{RHO}"]
    for k, angle in enumerate(angles):
        c, s = np.cos(np.radians(angle)), np.sin(np.radians(angle))
        lines += [f"*ORIENTATION, NAME=O{k}, SYSTEM=RECTANGULAR", f"{c:.9f}, {s:.9f}, 0., {-s:.9f}, {c:.9f}, 0."]
    lines += ["*SHELL SECTION, ELSET=P, COMPOSITE", *(f"1., , CARBON, O{k}" for k in range(len(angles)))]
    lines += ["*BOUNDARY", "FOOT, 1, 6", "*STEP", "*FREQUENCY", "5", "*END STEP", ""]
    (tmp_path / "plate.inp").write_text("\n".join(lines))
    subprocess.run([str(CALCULIX), "plate"], cwd=tmp_path, check=True, capture_output=True, timeout=300)
    rows = re.findall(r"^\s+\d+\s+\S+\s+\S+\s+(\S+)\s+\S+\s*$", (tmp_path / "plate.dat").read_text(), re.MULTILINE)
    wanted = np.array([float(row) for row in rows[:5]])
    prop = comp(*((1.0, angle) for angle in angles))
    found = hertz(described([CARBON, prop, *clamped(32, 16), *rectangle(160.0, 80.0, 32, 16)], tmp_path), 5)
    np.testing.assert_allclose(found, wanted, rtol=0.015)
