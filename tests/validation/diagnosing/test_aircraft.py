"""The aircraft of GARTEUR SM-AG19, a deck of beams and rigid links as an analyst would write it, beside ten measured frequencies.

Dimensions and frequencies as published: A. Gravelle, Ground Vibration Test Techniques, GARTEUR TP-115, 1999; E. Balmès and J. R.
Wright, DETC97, Sacramento 1997 (participant C of twelve laboratories). The tape on the wings and the plate that joins them to the
fuselage are left out: both are known to matter, and ten frequencies without shapes do not tell either.
"""

import tomllib
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


PICKED_UP = ("drum-1:z", "drum-2:z", "drum-3:z", "drum-4:z", "drum-1:x", "drum-3:x", "tail:y", "tail:z", "nose:y", "nose:z")
PLACES = {f"drum-{k}": (x, y, 0.091) for k, (x, y) in enumerate(((0.2, 0.95), (-0.2, 0.95), (0.2, -0.95), (-0.2, -0.95)), 1)}
PLACES |= {"tail": (-0.8, 0.0, 0.38), "nose": (0.6, 0.0, 0.0)}


@pytest.mark.xfail(reason="a mass of 0.8 kg on the tail stands beside it at 8.3 nats, in two of four laboratories", strict=True)
@pytest.mark.proof
def test_wings_that_give_in_yaw_where_they_are_bolted_on_are_named_from_nine_modes(study, run, answer):
    told = Path("aircraft.toml").read_text()
    told += "[fe_model.places]\n" + "".join(f"{name} = {[f'{x} m' for x in at]}\n" for name, at in PLACES.items())
    links = tomllib.loads(told)["fe_model"]["links"]
    ((link, (hub, *root)),) = [(name, one["nodes"]) for name, one in links.items() if one["nodes"][2:]]
    old = told[told.index(f'[fe_model.links."{link}"]') :].partition("\n\n")[0]
    units = [*3 * ['"1e10 N/m"'], '"1e8 N m/rad"', '"1e8 N m/rad"', '"2e5 N m/rad"']
    bolted = f'[fe_model.links.root]\nat = ["0 m", "0 m", "0.0805 m"]\nnodes = {root}\n[fe_model.springs.plate]\n'
    bolted += f'between = [{hub}, "root"]\nstiffness = [{", ".join(units)}]'
    Path("aircraft.toml").write_text(told)
    Path("truth.toml").write_text(told.replace(old, bolted))
    Path("made.toml").write_text(
        'format = 1\nmodel = { title = "truth", article = "aircraft" }\nstructure = { own = { aircraft = "truth.toml" } }\n'
    )
    read = [word for place in PICKED_UP for word in ("--response", place)]
    code, _, err = run("simulate", "made.toml", "--test", "modes", *read, "--band", "4", "70", "--seed", "3", "--out", "made")
    assert code == 0, err
    code, _, err = run("model", "aircraft.toml", "--test", "made/test.toml", "--out", "compared.toml")
    assert code == 0, err
    found = answer("diagnose", "compared.toml")
    named = {one["id"] for one in found["accepted"]}
    assert f"connection-compliance:{link}@2:gamma" in {*named, *found["equivalence_class"]}
    assert named <= {*found["equivalence_class"], f"connection-compliance:{link}@2:gamma"}
