"""What elements and properties of a deck say of sections: offsets, hinges, directions, products of inertia, layers."""

from pathlib import Path

import numpy as np
import pytest

from fem.mesh import deck, model
from fem.modes import lowest
from fem.structure import Structure
from geometry.errors import BadInput

E, RHO, LENGTH, COUNT = 210e3, 7.85e-9, 1200.0, 16
"""[MPa, t/mm³, mm, count] of a cantilever along x."""

WEB, FLANGE, APART = (10.0, 40.0), (60.0, 8.0), 24.0
"""[mm] width and height of two bars on the same nodes, and how far above them the second is."""


def loaded(lines: list[str], folder: Path, *lost: str) -> Structure:
    """The structure that `massline model` makes of cards."""
    (folder / "one.bdf").write_text("\n".join(["BEGIN BULK", f"MAT1,1,{E},,.3,{RHO}", *lines, "ENDDATA", ""]))
    written, said = deck.described(folder / "one.bdf", "mm-t-N-s")
    assert said == lost
    (folder / "one.toml").write_text(written)
    return model.load(folder / "one.toml")[1]


def frequencies(made: Structure, count: int = 4) -> np.ndarray:
    return np.sqrt(lowest(made.stiffness, made.mass, count).values) / (2 * np.pi)  # [Hz]


def cantilever(*bars: str, held: str = "123456") -> list[str]:
    """Each of `bars` a card with {n}, {a} and {b} for its number and nodes."""
    lines = [f"GRID,{k + 1},,{k * LENGTH / COUNT},0.,0." for k in range(COUNT + 1)] + [f"SPC1,1,{held},1"]
    for j, bar in enumerate(bars):
        lines += [bar.format(n=100 * j + k + 1, a=k + 1, b=k + 2) for k in range(COUNT)]
    return lines


def section(number: int, size: tuple[float, float]) -> str:
    width, height = size
    Iy, Iz = width * height**3 / 12, height * width**3 / 12
    return f"PBAR,{number},1,{width * height},{Iy},{Iz},{3 * min(Iy, Iz)}"


OFF = "CBAR,{{n}},2,{{a}},{{b}},0.,0.,1.,{offt}\n,,,{x},0.,{z},{x},0.,{z}"


@pytest.mark.parametrize(
    "second",
    [
        [OFF.format(offt="", x=0.0, z=APART), section(2, FLANGE)],
        [OFF.format(offt="BGG", x=0.0, z=APART), section(2, FLANGE)],
        # along the beam, along the section's height
        [OFF.replace("{x},0.,{z}", "0.,{z},{x}").format(offt="GOO", x=0.0, z=APART), section(2, FLANGE)],
        ["CBEAM,{n},2,{a},{b},0.,0.,1.", f"PBEAM,2,1,480.,2560.,144000.,,1.+4\n,\n,YESA,1.\n,0.,0.\n,,,,,{APART},0."],
    ],
)
def test_a_bar_beside_its_nodes_stiffens_as_a_flange_does(second: list[str], tmp_path: Path) -> None:
    """Euler's cantilever of two bonded bars: E I of both about the middle of both, by Steiner."""
    one, other = (width * height for width, height in (WEB, FLANGE))
    made = loaded([*cantilever("CBAR,{n},1,{a},{b},0.,0.,1.", second[0]), section(1, WEB), second[1]], tmp_path)
    own = sum(width * height**3 / 12 for width, height in (WEB, FLANGE))
    bending = E * (own + one * other / (one + other) * APART**2)
    wanted = 1.8751041**2 * np.sqrt(bending / (RHO * (one + other) * LENGTH**4)) / (2 * np.pi)
    upright = [f for f in frequencies(made, 8) if abs(f / wanted - 1) < 0.05]
    np.testing.assert_allclose(upright, wanted, rtol=3e-3)  # rotary inertia
    cog = 1e3 * made.rigid_mass[0, 4] / made.rigid_mass[0, 0]
    assert cog == pytest.approx(APART * other / (one + other), rel=0.05)  # of all but what the clamp holds


@pytest.mark.parametrize(("freedoms", "weak", "strong"), [("", 0, 0), ("5", 1, 0), ("6", 0, 1), ("56", 1, 1)])
def test_a_beam_with_a_hinge_at_its_end_is_propped(freedoms: str, weak: int, strong: int, tmp_path: Path) -> None:
    """Between two clamps, and hinged at the second about the height of its section (5), across (6): Euler's roots."""
    bars = cantilever("CBAR,{n},1,{a},{b},0.,1.,0.")
    bars[-1] += f"\n,,{freedoms}"
    made = loaded([*bars, section(1, WEB), f"SPC1,1,123456,{COUNT + 1}"], tmp_path)
    found, roots = frequencies(made, 8), (4.7300407, 3.9266023)
    for depth, hinged in zip(WEB, (weak, strong), strict=True):
        wanted = roots[hinged] ** 2 * np.sqrt(E * depth**2 / 12 / (RHO * LENGTH**4)) / (2 * np.pi)
        assert min(abs(found / wanted - 1)) < 5e-3  # rotary inertia


@pytest.mark.parametrize("pins", ["7", "459", "4,A"])
def test_a_hinge_that_is_no_freedom_is_refused(pins: str, tmp_path: Path) -> None:
    """It was passed over, and the end stayed clamped."""
    bars = cantilever("CBEAM,{n},1,{a},{b},0.,1.,0.\n,0,0")
    beam = "PBEAM,1,1,400.,3333.,53333.,,9999."
    loaded([*bars, beam], tmp_path)
    with pytest.raises(BadInput, match=f"`CBEAM`: PA and PB of CBEAM {COUNT} are .*Write freedoms from 1 to 6"):
        loaded([*bars[:-1], bars[-1].replace("0,0", pins), beam], tmp_path)


def test_a_frame_with_pinned_braces_has_rods_for_them(tmp_path: Path) -> None:
    """A bar whose ends both turn freely pulls as a rod of its area does, at either end a hinge in all three."""
    posts = ["GRID,1,,0.,0.,0.", "GRID,2,,0.,0.,900.", "GRID,3,,900.,0.,0.", "GRID,4,,900.,0.,900.", "SPC1,1,123456,1,3"]
    posts += ["CBAR,1,1,1,2,0.,1.,0.", "CBAR,2,1,3,4,0.,1.,0.", "CBAR,3,1,2,4,0.,1.,0.", section(1, WEB), "CONM2,9,4,,.01"]
    rod = loaded([*posts, "CROD,5,2,1,4", "PROD,2,1,50."], tmp_path)
    bar = loaded([*posts, "CBAR,5,2,1,4,0.,1.,0.\n,456,56", "PBAR,2,1,50.,4000.,3000.,1000."], tmp_path)
    np.testing.assert_allclose(frequencies(bar), frequencies(rod), rtol=2e-3)  # its own mass goes with its shape


def test_a_product_of_inertia_turns_the_axes_of_a_section(tmp_path: Path) -> None:
    """By 25 degrees from the stated direction towards the section's other axis, as its own principal axes are."""
    angle = np.radians(25.0)
    c, s = np.cos(angle), np.sin(angle)
    one, other = (size[0] * size[1] ** 3 / 12 for size in (WEB, WEB[::-1]))
    area, turned = WEB[0] * WEB[1], (one * c**2 + other * s**2, one * s**2 + other * c**2, (one - other) * s * c)
    # About x the direction z turns towards -y, which is Nastran's z of the section
    principal = loaded([*cantilever(f"CBAR,{{n}},1,{{a}},{{b}},0.,{-s},{c}"), section(1, WEB)], tmp_path)
    for card in (
        f"PBAR,1,1,{area},{turned[0]},{turned[1]},{3 * other}\n,\n,,,{turned[2]}",
        f"PBEAM,1,1,{area},{turned[0]},{turned[1]},{turned[2]},{3 * other}\n,\n,YESA,1.\n,1.+9,1.+9",
    ):
        made = loaded([*cantilever(f"C{card[1:5].rstrip(',')},{{n}},1,{{a}},{{b}},0.,0.,1."), card], tmp_path)
        for A, B in ((made.stiffness, principal.stiffness), (made.mass, principal.mass)):
            np.testing.assert_allclose(A.toarray(), B.toarray(), rtol=0, atol=1e-6 * abs(B).max())


def test_a_point_of_a_beam_beside_its_nodes_moves_with_both(tmp_path: Path) -> None:
    """A rigid turn of the nodes moves what is above them; a hinge lets the beam turn where its node does not."""
    made = loaded([*cantilever(OFF.format(offt="", x=0.0, z=APART)), section(2, FLANGE)], tmp_path)
    rigid = made.rigid
    row = made.elements.rows([[LENGTH / 2e3, 0.0, APART / 1e3]])[0] @ rigid
    np.testing.assert_allclose(row[:, 4], [APART / 1e3, 0.0, -LENGTH / 2e3], atol=1e-9)


def test_a_bar_of_no_direction_is_refused_unless_its_part_has_one(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="or the deck states none"):
        loaded([*cantilever("CBAR,{n},1,{a},{b}"), section(1, WEB)], tmp_path)
    text = (tmp_path / "one.toml").read_text()
    (tmp_path / "one.toml").write_text(text.replace("section = { ", "section = { z_axis = [0, 0, 1], "))
    made = model.load(tmp_path / "one.toml")[1]
    full = loaded([*cantilever("CBAR,{n},1,{a},{b},0.,0.,1."), section(1, WEB)], tmp_path)
    np.testing.assert_allclose(frequencies(made), frequencies(full), rtol=1e-9)


@pytest.mark.parametrize("offt", ["GG", "XYZ"])
def test_axes_of_offsets_that_are_none_are_refused(offt: str, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=f"OFFT of beam 1 is {offt}"):
        loaded([*cantilever(OFF.format(offt=offt, x=0.0, z=APART)), section(2, FLANGE)], tmp_path)


def test_what_is_of_a_section_with_moments_is_refused_of_others(tmp_path: Path) -> None:
    loaded([*cantilever("CBAR,{n},1,{a},{b},0.,0.,1."), "PBARL,1,1,,BAR\n,10.,40."], tmp_path)
    text = (tmp_path / "one.toml").read_text()
    assert "section = { width" in text
    (tmp_path / "one.toml").write_text(text.replace("section = { ", "section = { shear = [0.5, 0.5], "))
    with pytest.raises(BadInput, match="section"):
        model.load(tmp_path / "one.toml")


def test_baror_says_what_bars_leave_out(tmp_path: Path) -> None:
    full = loaded([*cantilever("CBAR,{n},1,{a},{b},0.,0.,1."), section(1, WEB)], tmp_path)
    lines = ["BAROR,,1,,,0.,0.,1.", *cantilever("CBAR,{n},,{a},{b}"), section(1, WEB)]
    np.testing.assert_allclose(frequencies(loaded(lines, tmp_path)), frequencies(full), rtol=1e-9)


def strip(*quads: str, width: float = 60.0, count: int = COUNT, length: float = LENGTH) -> list[str]:
    """A cantilever of plates along x, two elements wide, each of `quads` a card with {n} and {corners}."""
    number = {(i, j): 1 + i + (count + 1) * j for j in range(3) for i in range(count + 1)}
    lines = [f"GRID,{n},,{i * length / count},{width * (j - 1) / 2},0." for (i, j), n in number.items()]
    lines += [f"SPC1,1,123456,{number[0, 0]},{number[0, 1]},{number[0, 2]}"]
    for i in range(count):
        for j in range(2):
            ring = ",".join(str(number[i + a, j + b]) for a, b in ((0, 0), (1, 0), (1, 1), (0, 1)))
            lines += [one.format(n=1000 * k + 2 * i + j + 1, corners=ring) for k, one in enumerate(quads)]
    return lines


def test_a_skin_beside_its_nodes_stiffens_a_bar_and_a_bar_a_skin(tmp_path: Path) -> None:
    """A plate above the nodes and a bar on them are a plate on them and a bar below, and both an Euler T-beam."""
    bars = [f"CBAR,{9000 + k},2,{k},{k + 1},0.,0.,1." for k in range(COUNT + 2, 2 * COUNT + 2)]
    below = [f"{one}\n,,,0.,0.,{-APART},0.,0.,{-APART}" for one in bars]
    plate, wall = f"PSHELL,1,1,{FLANGE[1]},1,,1", section(2, WEB)
    found = [
        frequencies(loaded([*strip("CQUAD4,{n},1,{corners},," + off), *own, plate, wall], tmp_path), 8)
        for off, own in ((f"{APART}", bars), ("0.", below))
    ]
    one, other = (width * height for width, height in (WEB, FLANGE))
    own = sum(width * height**3 / 12 for width, height in (WEB, FLANGE))
    bending = E * (own + one * other / (one + other) * APART**2)
    wanted = 1.8751041**2 * np.sqrt(bending / (RHO * (one + other) * LENGTH**4)) / (2 * np.pi)
    for each in found:
        assert min(abs(each / wanted - 1)) < 5e-3  # rotary inertia, and the plate narrows as it is pulled
    upright = [each[np.argmin(abs(each / wanted - 1))] for each in found]
    assert upright[0] == pytest.approx(upright[1], rel=1e-3)


def test_springs_may_end_on_a_fixture_that_is_nothing_but_a_rigid_link(tmp_path: Path) -> None:
    """Nodes of an RBE2 at which no element is: the deck came over without a word, and its mesh was refused."""
    on_bush = [
        *cantilever("CBAR,{n},1,{a},{b},0.,0.,1."),
        section(1, WEB),
        "GRID,201,,0.,0.,0.",
        "PBUSH,9,K,5.+3,5.+3,5.+3,2.+6,2.+6,2.+6",
    ]
    on_bush = [one for one in on_bush if not one.startswith("SPC1")] + ["CBUSH,9,9,1,201,,,,0"]
    fixture = ["GRID,200,,-90.,50.,0.", "RBE2,8,200,123456,201", "SPC1,1,123456,200"]
    alone, carried = (loaded([*on_bush, *one], tmp_path) for one in (["SPC1,1,123456,201"], fixture))
    np.testing.assert_allclose(frequencies(carried), frequencies(alone), rtol=1e-9)
    assert carried.joints == ("CBUSH 9",)
