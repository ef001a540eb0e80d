"""What is wrong with parts, places, supports and joints is said with its field, what was found and what to do; and a fuzz."""

import shutil
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.structure import Structure
from fem.user_model import reading
from geometry.errors import BadInput

Arrays = dict[str, np.ndarray]
Saved = Callable[..., Path]

HEAD = 'format = 1\n[fe_model]\nkind = "matrices"\nunits = "mm-t-N-s"\n'
BASE = HEAD + 'reference_point = ["0 mm", "0 mm", "0 mm"]\ninterface = [101]\n'
GROUND = HEAD + 'support = "ground"\n'
FREE = HEAD + 'support = "free"\n'

JOINT = (
    '[fe_model.places]\nfoot = 101\ntop = 110\nflat = { dof = [0, 1, 2] }\n[fe_model.joints.bolt]\nbetween = ["foot", "top"]\n'
)
SIX = 'stiffness = ["1e6 N/m", 0, 0, 0, 0, 0]\n'
SOIL = JOINT.replace('"top"]', '"ground"]')


@pytest.fixture
def halves(arrays: Arrays) -> Arrays:
    """The bracket as two parts of the same shape."""
    parts = {f"{kind}/{name}": 0.5 * arrays[kind] for kind in ("stiffness", "mass") for name in ("left", "right")}
    return {name: arrays[name] for name in ("dof", "nodes", "coordinates")} | parts


def refused(path: Path, field: str, *words: str) -> None:
    """Reading `path` is refused at `field` with all the `words`, in one sentence that says what to do."""
    with pytest.raises(BadInput) as caught:
        reading.read(path)
    error, text = caught.value, str(caught.value)
    assert str(path.parent) in error.source
    assert error.field == field, text
    assert error.remedy
    for word in words:
        assert word in text, text


STATED: dict[str, tuple[str, str, tuple[str, ...]]] = {
    "support": (HEAD + 'support = "grund"\n', "fe_model.support", ("'grund'", "ground")),
    "no reference point": (HEAD + "interface = [101]\n", "fe_model.reference_point", ("missing", 'support = "ground"')),
    "interface on the ground": (GROUND + "interface = [101]\n", "fe_model.interface", ("base carries", "ground")),
    "supports of a base": (BASE + 'supports = ["left"]\n', "fe_model.supports", ("ties it to the ground", "base")),
    "soil of a free one": (FREE + SOIL + SIX, "fe_model.joints.bolt", ("ties it to the ground", "free")),
    "support twice": (GROUND + 'supports = ["left", "left"]\n', "fe_model.supports", ("'left' 2 times",)),
    "support nowhere": (GROUND + 'supports = ["lift"]\n', "fe_model.supports", ("'lift'", "Did you mean left?")),
    "support and joint": (GROUND + 'supports = ["left"]\njoints.left = {}\n', "fe_model.supports", ("a joint has that name",)),
    "joint nowhere": (BASE + "joints.lefft = {}\n", "fe_model.joints.lefft", ("neither", "Did you mean left?")),
    "joint without names": (BASE + "[fe_model.joints.bolt]\n" + SIX, "fe_model.joints.bolt.between", ("missing",)),
    "supports in words": (GROUND + 'supports = "left"\n', "fe_model.supports", ("list of names",)),
    "floats": (GROUND, "stiffness", ("on the ground", "cost no energy", "free")),
    "part nowhere": (BASE + "[fe_model.parts.lefft]\nloss_factor = 0.1\n", "fe_model.parts.lefft", ("no part", "left")),
    "part with material": (BASE + '[fe_model.parts.left]\nmaterial = "steel"\n', "fe_model.parts.left.material", ("already",)),
    "material unknown": (BASE + '[fe_model.parts.left]\nmaterial = "stel"\n', "material", ("'stel'", "steel")),
    "modulus in words": (
        BASE + '[fe_model.parts.left]\nmaterial = { density = "1 kg" }\n',
        "fe_model.parts.left.material.density",
        ("mass", "density"),
    ),
    "thickness negative": (BASE + '[fe_model.parts.left]\nthickness = "-1 mm"\n', "fe_model.parts.left.thickness", ("positive",)),
    "half a section": (
        BASE + '[fe_model.parts.left]\nsection = { width = "1 mm" }\n',
        "fe_model.parts.left.section.height",
        ("missing",),
    ),
    "two sections": (
        BASE + '[fe_model.parts.left]\nsection = { width = "1 mm", height = "1 mm", area = "1 mm^2" }\n',
        "fe_model.parts.left.section.area",
        ("unknown",),
    ),
    "tolerance of what": (
        BASE + "[fe_model.parts.left]\ntolerance = { modulos = 0.1 }\n",
        "fe_model.parts.left.tolerance.modulos",
        ("Did you mean modulus?",),
    ),
    "tolerance in per cent": (
        BASE + "[fe_model.parts.left]\ntolerance = { modulus = 5 }\n",
        "fe_model.parts.left.tolerance.modulus",
        ("5 % is 0.05",),
    ),
    "tolerance of a thickness": (
        BASE + "[fe_model.parts.left]\ntolerance = { thickness = 0.1 }\n",
        "fe_model.parts.left.tolerance.thickness",
        ("membrane/left",),
    ),
    "loss factor": (BASE + "[fe_model.parts.left]\nloss_factor = 3\n", "fe_model.parts.left.loss_factor", ("below 2",)),
    "storey of nothing": (
        BASE + '[fe_model.storeys.lefft]\nabove = "top"\nheight = "1 m"\n',
        "fe_model.storeys.lefft",
        ("no part", "left, right"),
    ),
    "storey on nothing": (
        BASE + '[fe_model.storeys.left]\nbelow = "cellar"\nabove = "ground"\nheight = "1 m"\n',
        "fe_model.storeys.left",
        ("no place is called 'cellar'",),
    ),
    "storey without height": (BASE + '[fe_model.storeys.left]\nabove = "ground"\n', "fe_model.storeys.left.height", ("missing",)),
    "storey of no height": (
        BASE + '[fe_model.storeys.left]\nabove = "ground"\nheight = "0 m"\n',
        "fe_model.storeys.left",
        ("not 0", "negative where it hangs"),
    ),
    "storey with a mass for its weight": (
        BASE + '[fe_model.storeys.left]\nabove = "ground"\nheight = "1 m"\nweight = "3 kg"\n',
        "fe_model.storeys.left.weight",
        ("mass", "force"),
    ),
    "storey that is hinged by name": (
        BASE + '[fe_model.storeys.left]\nabove = "ground"\nheight = "1 m"\nhinged = "yes"\n',
        "fe_model.storeys.left",
        ("true or false",),
    ),
    "down nowhere": (BASE + 'down = "w"\n', "fe_model.down", ("x", "z")),
    "name of the ground": (BASE + "[fe_model.parts.ground]\n", "fe_model.parts", ("something else",)),
    "name with a colon": (BASE + '[fe_model.places]\n"a:b" = 101\n', "fe_model.places", ("'a:b'", "letters")),
    "node nowhere": (BASE + "[fe_model.places]\nfoot = 7\n", "fe_model.places.foot", ("node 7", "101, 102")),
    "row nowhere": (BASE + "[fe_model.places]\nfoot = { dof = [60, -1, -1] }\n", "fe_model.places.foot.dof", ("60 of 60",)),
    "row twice": (BASE + "[fe_model.places]\nfoot = { dof = [1, 1, -1] }\n", "fe_model.places.foot.dof", ("once each",)),
    "no row": (BASE + "[fe_model.places]\nfoot = { dof = [-1, -1, -1] }\n", "fe_model.places.foot.dof", ("three rows",)),
    "two rows": (BASE + "[fe_model.places]\nfoot = { dof = [1, 2] }\n", "fe_model.places.foot.dof", ("six",)),
    "point without unit": (BASE + "[fe_model.places]\nfoot = [0, 0, 1]\n", "fe_model.places.foot", ("needs its unit",)),
    "point outside": (
        BASE + '[fe_model.places]\nfoot = ["1 m", "0 m", "0 m"]\n',
        "fe_model.places.foot",
        ("outside", "nearest node is at (0.1, 0, 0.3) m"),
    ),
    "place in words": (BASE + '[fe_model.places]\nfoot = "101"\n', "fe_model.places.foot", ("a node",)),
    "joint of one": (BASE + JOINT.replace(', "top"', "") + SIX, "fe_model.joints.bolt.between", ("two different",)),
    "joint with itself": (BASE + JOINT.replace('"top"]', '"foot"]') + SIX, "fe_model.joints.bolt.between", ("two different",)),
    "ground first": (
        GROUND + JOINT.replace('["foot", "top"]', '["ground", "top"]') + SIX,
        "fe_model.joints.bolt.between",
        ("ground last",),
    ),
    "joint of places nowhere": (
        BASE + JOINT.replace('"top"]', '"tip"]') + SIX,
        "fe_model.joints.bolt",
        ("'tip'", "Did you mean top?"),
    ),
    "joint about nowhere": (BASE + JOINT + 'at = "tip"\n' + SIX, "fe_model.joints.bolt", ("'tip'",)),
    "five stiffnesses": (BASE + JOINT + SIX.replace("0, 0]", "0]"), "fe_model.joints.bolt.stiffness", ("six",)),
    "stiffness without unit": (
        BASE + JOINT + SIX.replace('"1e6 N/m"', "1e6"),
        "fe_model.joints.bolt.stiffness",
        ("needs its unit",),
    ),
    "stiffness of a rotation": (BASE + JOINT + SIX.replace("N/m", "N m/rad"), "fe_model.joints.bolt.stiffness", ("stiffness",)),
    "stiffness negative": (BASE + JOINT + SIX.replace("1e6", "-1e6"), "fe_model.joints.bolt.stiffness", ("along x",)),
    "no stiffness": (BASE + JOINT + SIX.replace('"1e6 N/m"', "0"), "fe_model.joints.bolt.stiffness", ("all zero",)),
    "joint of a place that does not turn": (
        GROUND + SOIL.replace('["foot"', '["flat"') + SIX.replace("0]\n", '"1 N m"]\n'),
        "fe_model.joints.bolt",
        ("gamma", "'flat'"),
    ),
    "joint of a place apart that does not turn": (
        BASE + JOINT.replace('["foot", "top"]', '["flat", "top"]') + SIX,
        "fe_model.joints.bolt",
        ("resists the rigid motion", "apart"),
    ),
    "joint called like a part": (
        BASE + JOINT.replace("joints.bolt", "joints.left") + SIX,
        "fe_model.joints.left",
        ("part of this name",),
    ),
    "mesh's key": (BASE.replace('"matrices"', '"modal"') + "places = { a = 1 }\n", "fe_model.places", ("modal data",)),
    "unknown units on a base": (BASE.replace("mm-t-N-s", "consistent"), "fe_model.units", ("kilogram",)),
    "unit of an unknown system": (
        GROUND.replace("mm-t-N-s", "consistent") + '[fe_model.places]\na = ["1 m", "0 m", "0 m"]\n',
        "fe_model.places.a",
        ("bare number",),
    ),
    "unknown units and kilograms": (
        GROUND.replace("mm-t-N-s", "consistent") + '[stated]\nmass = "2 kg"\n',
        "stated",
        ("units are not known",),
    ),
    "stated mass of the clamped": (GROUND + '[stated]\nmass = "2.5 t"\n', "stated.mass", ("0.001",)),
    "stated cog of the clamped": (GROUND + '[stated]\ncog = ["0 m", "0 m", "0 m"]\n', "stated.cog", ("what the ground holds",)),
}


@pytest.mark.parametrize("case", STATED)
def test_wrong_names_are_refused(case: str, halves: Arrays, saved: Saved) -> None:
    text, field, words = STATED[case]
    if "clamped" in case:  # else it floats, which is found before
        kept = {name: halves[name][6:, 6:] for name in halves if "/" in name}
        halves = halves | kept | {"dof": halves["dof"][6:]}
    refused(saved(halves, text), field, *words)


def off(kind: str, i: int, j: int, share: float) -> Callable[[Arrays], None]:
    """The whole beside its parts, one entry of it off by a share."""

    def spoil(arrays: Arrays) -> None:
        whole = arrays[f"{kind}/left"] + arrays[f"{kind}/right"]
        whole[i, j] *= 1 + share
        whole[j, i] = whole[i, j]
        arrays[kind] = whole

    return spoil


def twice(arrays: Arrays) -> None:
    arrays["stiffness"] = arrays["stiffness/left"] + arrays["stiffness/right"]
    arrays["stiffness/again"] = arrays["stiffness/left"]


SPOILT: dict[str, tuple[Callable[[Arrays], Any], str, tuple[str, ...]]] = {
    "stiffness off": (off("stiffness", 13, 13, 1e-3), "stiffness", ("2 parts", "row 14, column 14", "node 103, y", "0.001")),
    "mass off": (off("mass", 30, 30, -1e-3), "mass", ("row 31", "node 106, x")),
    "missing part": (lambda a: a.update(stiffness=4 / 3 * 2 * a.pop("stiffness/left")), "stiffness", ("1 parts",)),
    "part twice": (twice, "stiffness", ("3 parts", "twice")),
    "part too small": (lambda a: a.update({"stiffness/left": np.eye(54)}), "stiffness/right", ("60 x 60", "54 x 54")),
    "part not square": (lambda a: a.update({"mass/left": np.ones((60, 54))}), "mass/left", ("square",)),
    "part of nothing": (lambda a: a.update({"stiffness/left": np.full((60, 60), np.nan)}), "stiffness/left", ("not finite",)),
    "part unsymmetric": (lambda a: a.update({"stiffness/left": np.triu(a["stiffness/left"])}), "stiffness", ("not symmetric",)),
    "part of letters": (lambda a: a.update({"stiffness/a b": a["stiffness/left"]}), "stiffness", ("'a b'",)),
    "weight on nothing": (lambda a: a.update({"geometric/top": a["stiffness/left"]}), "geometric/top", ("not there",)),
    "section of nothing": (lambda a: a.update({"bending/top": a["stiffness/left"]}), "bending/top", ("not there",)),
    "half a section": (lambda a: a.update({"bending/left": a["stiffness/left"]}), "membrane/left", ("missing",)),
    "section off": (
        lambda a: a.update({"bending/left": a["stiffness/left"], "membrane/left": a["stiffness/right"]}),
        "stiffness/left",
        ("2 parts",),
    ),
    "structural beside parts": (lambda a: a.update(structural=0.1 * a["stiffness/left"]), "structural", ("loss_factor",)),
    "measured nowhere": (lambda a: a.update(measured_dof=np.array([60])), "measured_dof", ("60 of 60",)),
    "place of another size": (lambda a: a.update({"places/tip": np.ones((3, 54))}), "places/tip", ("3 x 60", "3 x 54")),
}


@pytest.mark.parametrize("case", SPOILT)
def test_parts_that_do_not_fit_are_refused(case: str, halves: Arrays, saved: Saved) -> None:
    spoil, field, words = SPOILT[case]
    spoil(halves)
    refused(saved(halves, BASE), field, *words)


def test_a_group_too_deep_is_refused(halves: Arrays, saved: Saved) -> None:
    halves["stiffness/deep/data/more"] = np.eye(3)
    refused(saved(halves, BASE, ".h5"), "stiffness/deep/data", "deeper")


def test_supports_left_in_a_free_structure_are_named(arrays: Arrays, saved: Saved) -> None:
    arrays["stiffness"][54, 54] *= 2
    refused(saved(arrays, FREE), "stiffness", "K @ rigid must be 0", 'support = "ground"')


def test_a_mechanism_in_a_free_structure_is_found(arrays: Arrays, saved: Saved) -> None:
    """Nodes 109 and 110 may turn about x together for nothing, beside the rigid motions."""
    v = np.zeros(60)
    v[[51, 57]] = 1.0
    Kv = arrays["stiffness"] @ v
    arrays["stiffness"] -= np.outer(Kv, Kv) / (v @ Kv)
    refused(saved(arrays, FREE), "stiffness", "beside its rigid motions", "cost no energy")


def test_a_free_structure_without_coordinates_is_refused(arrays: Arrays, saved: Saved) -> None:
    bare = {name: arrays[name] for name in ("stiffness", "mass")}
    bare |= {"rigid": np.zeros((60, 6))}
    refused(saved(bare, FREE.replace("mm-t-N-s", "consistent")), "dof", "without coordinates")


def test_rows_without_names_are_in_si_or_in_unknown_units(arrays: Arrays, saved: Saved) -> None:
    bare = {name: arrays[name][6:, 6:] for name in ("stiffness", "mass")}
    refused(saved(bare, GROUND), "dof", "mm-t-N-s", "consistent")


def test_a_name_that_no_description_could_call_is_not_written(arrays: Arrays, saved: Saved, tmp_path: Path) -> None:
    from dataclasses import replace

    found = reading.read(saved(arrays, BASE))
    with pytest.raises(BadInput, match="'a b'"):
        reading.write(replace(found, part_stiffness={"a b": found.stiffness}), tmp_path / "no.npz")


# --- where data lie -----------------------------------------------------------------------------------------------------------


def test_data_of_others_stay_in_their_folder(
    halves: Arrays, saved: Saved, tmp_path: Path, monkeypatch: pytest.MonkeyPatch
) -> None:
    data, beside = tmp_path / "data", tmp_path / "beside"
    data.mkdir()
    beside.mkdir()
    saved(halves, BASE).rename(data / "model.npz")
    (tmp_path / "secret.npz").write_bytes((data / "model.npz").read_bytes())
    path = beside / "model.toml"
    monkeypatch.setenv("MASSLINE_DATA", str(data))
    path.write_text(BASE + 'file = "$MASSLINE_DATA/model.npz"\n', encoding="utf-8")
    assert isinstance(reading.read(path), Structure)
    path.write_text(BASE + 'file = "$MASSLINE_DATA/../secret.npz"\n', encoding="utf-8")
    refused(path, "fe_model.file", "out of MASSLINE_DATA")
    path.write_text(BASE + f'file = "{data}/model.npz"\n', encoding="utf-8")
    refused(path, "fe_model.file", "out of the folder of the description")
    monkeypatch.setenv("MASSLINE_DATA", str(tmp_path / "nowhere"))
    path.write_text(BASE + 'file = "$MASSLINE_DATA/model.npz"\n', encoding="utf-8")
    refused(path, "fe_model.file", "no file", "MASSLINE_DATA names the folder")


# --- damaged files --------------------------------------------------------------------------------------------------------------

COUNT = 60

WHOLE = """
joints.right = {}
places = { tip = 110, mid = ["1 mm", "0 mm", "140 mm"], side = { dof = [54, 55, 56] } }
[fe_model.joints.rail]
between = ["tip", "side"]
stiffness = ["1e6 N/m", "1e6 N/m", 0, 0, 0, 0]
tolerance = 0.2
[fe_model.parts.left]
loss_factor = 0.02
tolerance = { modulus = 0.05, density = 0.01 }
"""


def damaged(content: bytes, generator: np.random.Generator) -> bytes:
    """`content` cut short, with a byte or a few changed, with a stretch missing, or with a stretch twice."""
    data = bytearray(content)
    a, b = sorted(generator.integers(0, len(data), 2).tolist())
    kind = int(generator.integers(0, 5))
    if kind == 0:
        return bytes(data[:b])
    if kind in (1, 2):
        for place in generator.integers(0, len(data), 5 if kind == 1 else 1):
            data[place] = int(generator.integers(0, 256))
        return bytes(data)
    return bytes(data[:a] + (data[min(b, a + 40) :] if kind == 3 else data[a : a + 40] + data[a:]))


@pytest.mark.parametrize("spoilt", ["written.h5", "written.npz", "model.toml", "model.npz"])
def test_a_damaged_structure_is_read_or_refused_in_words(
    spoilt: str, halves: Arrays, saved: Saved, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    """All of its names in it; what `write` left has checksums, and nothing wrong in it is believed at all."""
    folder, source = tmp_path / "files", saved(halves, "")
    folder.mkdir()
    shutil.copy(source, folder / "model.npz")
    with np.load(source) as file:
        np.savez(folder / "model.npz", **{name: file[name] for name in file.files if name != "description"})
    (folder / "model.toml").write_text(BASE.replace("interface", 'file = "model.npz"\ninterface') + WHOLE, encoding="utf-8")
    whole = reading.read(folder / "model.toml")
    for ending in (".h5", ".npz"):
        reading.write(whole, folder / f"written{ending}")
    content = (folder / spoilt).read_bytes()
    read_from = folder / (spoilt if spoilt.startswith("written") else "model.toml")
    generator, refusals = np.random.default_rng([2027, len(spoilt)]), 0
    capfd.readouterr()
    for _ in range(COUNT):
        (folder / spoilt).write_bytes(damaged(content, generator))
        try:
            found = reading.read(read_from)
        except BadInput:
            refusals += 1
            continue
        assert_allclose(found.rigid_mass[0, 0], whole.rigid_mass[0, 0], rtol=0.03)
        if spoilt.startswith("written"):
            for name, share in whole.part_stiffness.items():
                assert_allclose(found.part_stiffness[name].toarray(), share.toarray(), rtol=0, atol=0)
    assert refusals > COUNT / 4  # the damage is real
    assert capfd.readouterr() == ("", "")
