"""Tests of a user's own structure: places by number, what is plausible by the modes, joints that give alike, and refusals."""

from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from scipy.sparse.linalg import spsolve

from benchmarks.read_meshes import STEEL, abaqus, bricks
from fem.user_model import reading
from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.sensors import Channel, ChannelTable, Place
from identification import test_file
from validation.effects.catalogue import FAMILIES, Named, acts, parse
from validation.model import model_file
from validation.model.model import Added, Model, StructureTolerances
from validation.prediction import effects, mounting, series, structure_tests
from validation.prediction.mounting import mounted_article
from validation.study import Study

STUDY = """format = 1
model = { title = "Wall", article = "wall" }
[fe_model]
kind = "frame"
nodes = { foot = "0 m", floor = "0.2 m", roof = "0.4 m" }
fixed = ["foot"]
moves = ["x"]
members = { low = ["foot", "floor"], high = ["floor", "roof"] }
section = { width = "80 mm", thickness = "1 mm", across = "x" }
material = { youngs_modulus = "210 GPa", poisson_ratio = 0.3 }
masses = { floor = "1.83 kg", roof = "1.83 kg" }
loss_factor = 0.01
[[test]]
kind = "modal-table"
frequencies = ["1.48 +/- 0.01 Hz", "3.88 +/- 0.02 Hz"]
sensors = ["floor:x", "dof 0"]
shapes = [[0.62, 0.62], [-1.0, -1.0]]
"""


@pytest.fixture
def opened(tmp_path):
    """The model file, its tests, and what it predicts of them."""
    path = tmp_path / "wall.toml"
    path.write_text(STUDY)
    model = model_file.read(path)
    tests = [test_file.read(path, {"article": model.article, **one}) for one in model.tests]
    return model, tests, structure_tests.predictions(model, tests)


def lowest(matrices):
    """[1/s²] omega² of the two floors."""
    return 1 / eigh(matrices.mass, matrices.stiffness, eigvals_only=True)[::-1][:2]


def test_a_sensor_may_be_a_row_of_the_matrices(opened):
    of, shapes = opened[0], opened[2][1]
    rows = shapes.at({}, derivatives=False).rows[:, 0, :, 0].real
    assert_allclose(rows[:, 1], rows[:, 0], rtol=1e-9)  # the first row of this frame is what moves its floor
    assert of.own == {"wall": of.source}


@pytest.mark.parametrize("text", ["point-mass:roof=0", "cable:roof:lateral=1", "connection-compliance:low@foot:beta=1e-9"])
def test_a_plausible_fault_moves_one_mode_by_a_fifth_of_its_omega_squared_and_no_other_by_more(opened, text):
    known = opened[2][0].structure
    named = parse(text, replace(effects_words(opened)))
    (size,) = named.sizes
    deviation = effects.plausible(known, named, size)
    little = 1e-4 * deviation
    before = FAMILIES[named.family].change(known.nominal, named.targets, {"": 0.0})
    after = FAMILIES[named.family].change(known.nominal, named.targets, {"": little})
    moved = np.abs(lowest(after) / lowest(before) - 1) / 1e-4
    assert_allclose(moved.max(), effects.UNSEEN, rtol=0.02)


def test_a_plausible_loss_of_a_part_is_a_tenth_of_the_critical_damping_of_the_mode_that_it_damps_most(opened):
    known = opened[2][0].structure
    named = parse("structural-damping:low=0.1", effects_words(opened))
    lost = FAMILIES[named.family].change(known.nominal, named.targets, {"": 1.0}).structural - known.nominal.structural
    share = np.max(np.diag(lost)[: len(known.frequency)] / (2 * np.pi * known.frequency) ** 2)
    assert_allclose(effects.plausible(known, named, named.sizes[0]), effects.UNSEEN / share, rtol=1e-6)


def effects_words(opened):
    """What effects can be about here."""
    from validation.effects.catalogue import words_of
    from validation.model.model import vocabulary

    none = replace(vocabulary(opened[0], ()), places=None, parts=None, supports=None, joints=None)
    return words_of([one.there for one in opened[2]], none)


def test_every_joint_alike_is_all_of_them_one_after_the_other(opened):
    stage = opened[2][0].structure.nominal
    change = FAMILIES["connection-compliance"].change
    ends = ("low@foot", "low@floor", "high@floor", "high@roof")
    for alike, names in (("every", ends), ("all@every", ("low@foot", "all@floor", "high@roof"))):
        together = change(stage, (alike, "beta"), {"": 1e-6})
        apart = stage
        for name in names:
            apart = change(apart, (name, "beta"), {"": 1e-6})
        assert_allclose(together.stiffness, apart.stiffness)
    assert not np.allclose(together.stiffness, stage.stiffness, rtol=1e-9)
    assert acts(Named(family="connection-compliance", targets=("every", "x"), values={"": 0.0}), opened[2][0].there)


def test_a_second_compliance_of_a_joint_is_in_series_with_the_first(opened):
    stage = opened[2][0].structure.nominal
    change = FAMILIES["connection-compliance"].change
    twice = change(change(stage, ("every", "beta"), {"": 1e-3}), ("low@foot", "beta"), {"": 2e-3})
    once = stage
    for name in (one for one in stage.joints if not one.startswith("all@")):
        once = change(once, (name, "beta"), {"": 3e-3 if name == "low@foot" else 1e-3})
    assert_allclose(twice.stiffness, once.stiffness, rtol=1e-9, atol=1e-9 * np.abs(once.stiffness).max())
    assert np.linalg.eigvalsh(twice.stiffness)[0] > 0


E_I, L = 210e9 * 0.08 * 0.001**3 / 12, 0.2  # [N m²], [m] of the wall


def two_floors_on_a_wall_that_runs_through(clamp):
    """[Hz] of two floors that do not turn, on a wall held in foot, floor and roof by clamps of stiffness `clamp` [N m/rad]."""
    K = np.zeros((6, 6))  # shift and turn of foot, floor, roof
    for k in (0, 2):
        a, b, c, d = 12 / L**2, 6 / L, 4.0, 2.0
        beam = np.array([[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]])
        K[k : k + 4, k : k + 4] += E_I / L * beam
    K[[1, 3, 5], [1, 3, 5]] += clamp
    own, turns = [2, 4], [1, 3, 5]
    left = K[np.ix_(own, own)] - K[np.ix_(own, turns)] @ np.linalg.solve(K[np.ix_(turns, turns)], K[np.ix_(turns, own)])
    return np.sqrt(eigh(left, 1.83 * np.eye(2), eigvals_only=True)) / (2 * np.pi)


@pytest.mark.parametrize("compliance", [1e-4, 1e-2, 0.1])
def test_where_a_node_lets_go_of_all_its_members_they_run_through_it_as_one(opened, compliance):
    stage = opened[2][0].structure.nominal
    change = FAMILIES["connection-compliance"].change
    found = change(stage, ("all@every", "beta"), {"": compliance})
    assert_allclose(np.sqrt(lowest(found)) / (2 * np.pi), two_floors_on_a_wall_that_runs_through(1 / compliance), rtol=2e-3)


def test_what_reaches_nothing_of_a_test_does_nothing_there(opened):
    words = replace(effects_words(opened), accelerometers=None, forces=None, parts=None)
    added = [
        Added(named=parse(text, words)) for text in ("modulus:low=0.1", "modulus:elsewhere=0.1", "joint-compliance:rotation=1e-6")
    ]
    kept = opened[2][0].with_effects(added).effects
    assert [one.named.id for one in kept] == ["modulus:low"]


@pytest.mark.parametrize(
    ("old", "new", "words"),
    [
        ('"dof 0"', '"dof 99"', "there is no such row"),
        ('"floor:x"', '"cellar:x"', "no such place"),
        ('kind = "modal-table"', 'kind = "modal-table"\narticle = "tower"', "has no model of it"),
    ],
)
def test_a_test_that_is_not_of_this_structure_is_refused(tmp_path, old, new, words):
    path = tmp_path / "wall.toml"
    path.write_text(STUDY.replace(old, new))
    model = model_file.read(path)
    with pytest.raises(BadInput, match=words):
        structure_tests.predictions(model, [test_file.read(path, {"article": "wall", **one}) for one in model.tests])


def test_what_stands_on_the_ground_stands_on_no_fmd(opened, ordinary):
    model = replace(opened[0], own={"fmd+wall": opened[0].source})
    with pytest.raises(BadInput, match="no base that an FMD could carry"):
        mounted_article(model, replace(ordinary("fmd+clumod-1", "rigid").campaign, article="fmd+wall"))


BLOCK = """format = 1
model = {{ title = "Block", article = "block" }}
structure = {{ tolerances = {{ mesh = {mesh} }} }}
[fe_model]
kind = "mesh"
units = "m"
file = "block.inp"
support = "ground"
interface = ["root"]
places = {{ corner = ["0.2 m", "0 m", "0.03 m"], edge = ["0.2 m", "0.02 m", "0.03 m"], side = ["0.1 m", "0 m", "0.015 m"] }}
[fe_model.groups.root]
box = [["0 m", "0 m", "0 m"], ["0 m", "1 m", "1 m"]]
[fe_model.parts.p]
{steel}
loss_factor = 0.02
[[test]]
kind = "response-functions"
article = "block"
file = "block.csv"
drive = "corner:z"
responses = ["corner:z", "edge:z", "side:y", "corner:y"]
"""


def block(folder: Path, cells: tuple[int, int, int], kind: str, mesh: float) -> Path:
    """The study of a cantilever of such elements."""
    points, elements = bricks(cells, (0.2, 0.02, 0.03), kind)
    (folder / "block.inp").write_text(abaqus(points, {"p": (kind, elements)}), encoding="utf-8")
    (folder / "block.toml").write_text(BLOCK.format(mesh=mesh, steel=STEEL), encoding="utf-8")
    return folder / "block.toml"


def test_modes_of_a_coarse_mesh_are_unsure_above_the_band_and_turn_into_each_other_far_beyond_their_neighbours(tmp_path):
    """Of a sound ribbed plate two modes 1:3 apart turned by 0.2 %, at a node of one of them a tenth of what was read, and what
    lay above 1.5 times the band was taken for right: a misalignment of 11 standard deviations, and a mass, had a name."""
    table = '[[test]]\nkind = "modal-table"\nfrequencies = ["650 Hz", "1850 Hz", "2250 Hz"]\n'
    for mesh, named in ((StructureTolerances().mesh, True), (0.0, False)):
        path = block(tmp_path, (8, 2, 2), "C3D10", mesh)
        path.write_text(path.read_text(encoding="utf-8").partition("[[test]]")[0] + table, encoding="utf-8")
        (test,) = Study.open(str(path), []).tests
        of, names = test.structure, {one.name for one in test.parameters}
        assert 1.5 * 2250 < of.frequency[-1] < 2 * 2250
        assert f"frequency:block:{len(of.frequency)}" in names
        r, s = max(of.mixed, key=lambda pair: of.frequency[pair[1]] / of.frequency[pair[0]])
        assert (of.frequency[s] > 1.4 * of.frequency[r]) == named
        assert {f"mixing:block:{r + 1}:{s + 1}", f"coupling:block:{r + 1}:{s + 1}"} <= names
        turned = of.at({f"mixing:block:{r + 1}:{s + 1}": 0.01})[0].stiffness[r, s]
        assert turned == pytest.approx(0.01 * (2 * np.pi) ** 2 * of.frequency[r] * of.frequency[s])


@pytest.mark.parametrize(("mesh", "may"), [(StructureTolerances().mesh, True), (0.0, False)])
def test_on_a_base_modes_of_a_coarse_mesh_turn_into_each_other_as_well(tmp_path, meaningless, mesh, may):
    """Of a sound ribbed panel on a shaker, its mesh half as fine as it was tested, a tolerance had to be moved by 5 of its
    deviations; a foreign mass of 30 g at its very node had that as its reason to be called unknown."""
    path = block(tmp_path, (4, 1, 1), "C3D8", mesh)
    path.write_text(path.read_text(encoding="utf-8").partition("[[test]]")[0].replace('"ground"', '"base"'), encoding="utf-8")
    bare = meaningless(article="fmd+block")
    wide = {
        name: replace(one, frequency=60 * one.frequency) for name, one in bare.recordings.items() if one.frequency is not None
    }
    campaign = replace(bare, source="shaken", mounting=Pose(), recordings={**bare.recordings, **wide})
    known = StructureTolerances(mesh=mesh)
    lab = Model(source="lab", title="", article="fmd+block", own={"block": str(path)}, structure=known)
    (of,) = series.predictions(lab, [campaign])
    names = [one.name for one in of.parameters if one.name.startswith("mixing:")]
    assert bool(names) == may
    for one in names[:2]:
        changes, step = of.at({}).changes, 1e-4
        slope = (of.at({one: step}, derivatives=False).rows - of.at({one: -step}, derivatives=False).rows) / (2 * step)
        np.testing.assert_allclose(changes[one].rows, slope[:, list(changes[one].channels)], atol=1e-5 * np.abs(slope).max())


def test_an_accelerometer_outside_the_mesh_is_named_in_words_and_the_others_take_part(tmp_path, meaningless, monkeypatch):
    """All of the article were left out for one of them, and nothing said so."""
    path, bare = block(tmp_path, (4, 1, 1), "C3D8", 0.0), meaningless(article="fmd+block")
    path.write_text(path.read_text(encoding="utf-8").partition("[[test]]")[0].replace('"ground"', '"base"'), encoding="utf-8")
    sits = {"far-y": (0.2, 0.01, 0.03), "beside-y": (0.1, 0.05, 0.015), "near-z": (0.2, 0.02, 0.03)}
    upon = [
        Channel(name=name, quantity="acceleration", group="article", places=(Place(position=at, direction=np.eye(3)[1]),))
        for name, at in sits.items()
    ]
    table = ChannelTable(channels=(*bare.table.channels, *upon))
    read = {
        name: replace(one, names=table.names, values=np.hstack([one.values, one.values[:, :3]]))
        for name, one in bare.recordings.items()
    }
    campaign = replace(bare, source="shaken", table=table, recordings=read, mounting=Pose())
    model = Model(source="lab", title="", article="fmd+block", own={"block": str(path)})
    (of,) = series.predictions(model, [campaign])
    assert [name for name in of.measured.channels if name in sits] == ["far-y", "near-z"]
    assert {"edge", "@0.2,0.02,0.03"} <= {*(of.there.places or ())}  # something may be tried there, though one has a name
    (said,) = [text for text in of.remarks if "beside-y" in text]
    (bare,) = series.predictions(model, [replace(campaign, article="fmd")])
    assert any(text.startswith("not used: far-y, beside-y, near-z, which read no motion of") for text in bare.remarks)
    pair = replace(upon[0], name="side-y", places=2 * upon[0].places)  # a sum, whose name stands in another's
    beside = replace(table, channels=(*table.channels, pair))
    seen = {
        name: replace(one, names=beside.names, values=np.hstack([one.values, one.values[:, :1]])) for name, one in read.items()
    }
    (more,) = series.predictions(model, [replace(campaign, table=beside, recordings=seen)])
    assert any(text.startswith("not used: side-y, which read") for text in more.remarks)
    assert said.startswith("accelerometer beside-y in shaken is not used: at (100, 50, 15) mm from the origin of block")
    assert "30 mm outside the mesh; the nearest point is (100, 20, 15) mm" in said
    # Matrices have no elements, nor has a drawing: what moves there is said of the nearest node
    own = mounting.users_model
    without = {str(path): replace(own(str(path), 0), model=replace(own(str(path), 0).model, elements=None))}
    monkeypatch.setattr(mounting, "users_model", lambda path, stamp: without[path])
    mounting._made.cache_clear()
    mounting._known.cache_clear()
    (loose,) = series.predictions(model, [campaign])
    mounting._made.cache_clear()
    mounting._known.cache_clear()
    (said,) = [text for text in loose.remarks if "ride on" in text]
    assert said.startswith("accelerometers in shaken ride on the nearest nodes of block, which has no elements: ")
    assert said.endswith("far-y 10 mm away, beside-y 33.5 mm away")
    assert "beside-y" in loose.measured.channels


@pytest.mark.proof  # two meshes and two fits; what a mesh leaves unsure is held element by element in fem/mesh
@pytest.mark.parametrize("mesh", [StructureTolerances().mesh, 0.0])
def test_a_sound_block_that_others_meshed_finer_is_within_what_its_mesh_leaves_unsure(tmp_path, mesh):
    path, rng = block(tmp_path, (12, 3, 3), "C3D20", mesh), np.random.default_rng(4)
    true, hertz = reading.read(path), np.linspace(300.0, 3000.0, 60)
    sensors = [("corner", 2), ("edge", 2), ("side", 1), ("corner", 1)]
    rows = np.array([true.places[name].toarray()[axis] for name, axis in sensors])
    lines = ["frequency," + ",".join(f"{name}{axis} {part}" for name, axis in sensors for part in ("re", "im"))]
    for f in hertz:
        omega = 2 * np.pi * f
        H = -(omega**2) * rows @ spsolve((true.stiffness * (1 + 0.02j) - omega**2 * true.mass).tocsc(), rows[0].astype(complex))
        H = H * (1 + 0.01 * rng.standard_normal((4, 2)) @ [1, 1j])
        lines.append(",".join(f"{x:.8g}" for x in [f, *H.view(np.float64)]))
    (tmp_path / "block.csv").write_text("\n".join(lines) + "\n", encoding="utf-8")
    block(tmp_path, (8, 2, 2), "C3D10", mesh)
    found = Study.open(str(path), []).all_free()
    assert (found.tolerance_z2 < found.tolerances) == bool(mesh)
