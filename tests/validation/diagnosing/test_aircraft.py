"""The aircraft of GARTEUR SM-AG19, a deck of beams and rigid links as an analyst would write it, beside ten measured frequencies.

Dimensions and frequencies as published: A. Gravelle, Ground Vibration Test Techniques, GARTEUR TP-115, 1999; E. Balmès and J. R.
Wright, DETC97, Sacramento 1997 (participant C of twelve laboratories). The tape on the wings and the plate that joins them to the
fuselage are left out: both are known to matter, and ten frequencies without shapes do not tell either.
"""

from itertools import pairwise
from pathlib import Path

import numpy as np
import pytest

from fem.mesh import model
from fem.modes import floating_shift, lowest

MEASURED = (6.38, 16.10, 33.13, 33.53, 35.65, 48.38, 49.43, 55.08, 63.04, 66.50)
FUSELAGE, WING, DRUM, FIN, TAILPLANE = 1, 2, 3, 4, 5


def aircraft() -> str:
    """The deck, in SI: 1.5 m long, 2 m wide, of aluminium; tips carry drums and a mass each, the tail a plate."""
    nodes: dict[tuple[float, ...], int] = {}
    cards: list[str] = []

    def node(*at: float) -> int:
        return nodes.setdefault(tuple(round(x, 6) for x in at), len(nodes) + 1)

    def beam(part: int, up: str, *points: tuple[float, float, float]) -> None:
        cards.extend(f"CBAR,{len(cards) + 1},{part},{node(*a)},{node(*b)},{up}" for a, b in pairwise(points))

    def link(*at: int) -> None:
        cards.append(f"RBE2,{len(cards) + 1},{at[0]},123456,{','.join(map(str, at[1:]))}")

    z, tip = 0.0805, 0.091
    beam(FUSELAGE, "0.,0.,1.", *((x, 0.0, 0.0) for x in (-0.9, -0.8, -0.6, -0.4, -0.2, 0.0, 0.2, 0.4, 0.6)))
    for side in (1, -1):
        span = (0.0, 0.025, *np.linspace(0.1, 0.85, 11), 0.95, 1.0)
        beam(WING, "0.,0.,1.", *((0.0, side * y, z) for y in span))
        beam(DRUM, "0.,0.,1.", *((x, side * 0.95, tip) for x in (-0.2, -0.18, 0.0, 0.18, 0.2)))
        beam(TAILPLANE, "0.,0.,1.", *((-0.8, side * y, 0.38) for y in np.linspace(0, 0.2, 5)))
        link(node(0, side * 0.95, z), node(0, side * 0.95, tip))
        cards.append(f"CONM2,{len(cards) + 1},{node(0.18, side * 0.95, tip)},0,0.2")
    beam(FIN, "0.,1.,0.", *((-0.8, 0.0, height) for height in np.linspace(0.075, 0.375, 7)))
    link(node(-0.8, 0, 0), node(-0.8, 0, 0.075))
    link(node(-0.8, 0, 0.375), node(-0.8, 0, 0.38))
    link(node(0, 0, 0), node(0, 0, z), node(0, 0.025, z), node(0, -0.025, z))
    cards.append(f"CONM2,{len(cards) + 1},{node(-0.8, 0, 0.38)},0,0.432")
    sizes = {FUSELAGE: (0.15, 0.05)} | dict.fromkeys((WING, DRUM, FIN, TAILPLANE), (0.01, 0.1))
    for part, (h, b) in sizes.items():
        t, w = min(h, b), max(h, b)
        twist = w * t**3 * (1 / 3 - 0.21 * t / w * (1 - (t / w) ** 4 / 12))
        cards.append(f"PBAR,{part},1,{h * b:.6g},{b * h**3 / 12:.6e},{h * b**3 / 12:.6e},{twist:.6e}")
    grid = [f"GRID,{number},,{','.join(f'{x:.5f}' for x in at)}" for at, number in nodes.items()]
    return "\n".join(["BEGIN BULK", *grid, *cards, "MAT1,1,7.e10,,.31,2700.", "ENDDATA", ""])


@pytest.fixture
def study(tmp_path: Path, monkeypatch: pytest.MonkeyPatch, run) -> str:
    """The study, written by `massline model` from the deck and the table."""
    monkeypatch.chdir(tmp_path)
    Path("aircraft.bdf").write_text(aircraft())
    read = ", ".join(f'"{f} Hz"' for f in MEASURED)
    Path("modes.toml").write_text(f'format = 1\nkind = "modal-table"\nfrequencies = [{read}]\nfrequency_deviation = 0.005\n')
    code, _, err = run("model", "aircraft.bdf", "--test", "modes.toml", "--out", "study.toml")
    assert code == 0, err
    return "study.toml"


def test_the_links_of_the_deck_are_joints_as_stiff_as_welded(study, run):
    made = model.load(Path("aircraft.toml"))[1]
    assert sorted(one.partition("@")[2] for one in made.joints) == ["2", "3", "3", "4", "5"]
    assert made.rigid_mass[0, 0] == pytest.approx(40.66, rel=1e-3)
    values = lowest(made.stiffness, made.mass, 10, shift=floating_shift(made.stiffness, made.mass)).values[6:]
    found = np.sqrt(values) / (2 * np.pi)
    assert found == pytest.approx([5.733, 15.47, 32.14, 32.21], rel=1e-3)  # as of the same beams joined node to node
    code, out, err = run("compare", study)
    assert code == 0, err
    assert "FAILED" in out


@pytest.mark.proof
def test_ten_frequencies_that_are_off_by_a_tenth_name_nothing(study, answer):
    found = answer("diagnose", study)
    assert found["verdict"] == "unknown"
    assert found["accepted"] == []
