"""Mode shapes drawn: the CAD surface rides on the model, sheet and GIF show something, the glTF moves as the mode."""

import json
import struct
from collections.abc import Iterator
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from matplotlib.font_manager import FontProperties
from matplotlib.textpath import TextPath
from numpy.testing import assert_allclose

from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.frames import rigid_transformation
from validation.cli import main
from validation.diagnose.diagnosis import FoundNode
from validation.diagnose.everywhere import NodeScores
from validation.effects.catalogue import Named
from validation.flexible.model import FlexibleOptions, flexible, nearest_part
from validation.flexible.modes import displacement, has_rotations
from validation.report.scenes import motion
from validation.report.scenes.motion import CYCLE, REACH, DrawnMode, MovingBody, bendable, glb, mode_sheet, sharp_edges
from validation.report.scenes.scene import DrawnBody

FRAMES = 4


@pytest.fixture(scope="module")
def drawn(renderer, tmp_path_factory) -> Iterator[Path]:
    """The folder that ``massline modes cuboid --shapes --mode 1`` wrote into."""
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("shapes")
        patch.chdir(folder)
        patch.setattr("validation.report.scenes.motion.FRAMES", FRAMES)
        assert main.run(["modes", "cuboid", "--count", "2", "--shapes", "--mode", "1"]) == main.DONE
        yield folder / "out"


def cube(edge: float = 1.0) -> DrawnBody:
    """A cube of `edge` [m] standing on the origin."""
    corners = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float) * edge
    faces = [[0, 1, 3], [0, 3, 2], [4, 6, 7], [4, 7, 5], [0, 4, 5], [0, 5, 1], [2, 3, 7], [2, 7, 6], [0, 2, 6], [0, 6, 4]]
    faces += [[1, 5, 7], [1, 7, 3]]
    return DrawnBody(name="cube", material="steel", vertices=corners, faces=np.array(faces))


def swaying() -> DrawnMode:
    """A cube that sways along x, its foot at rest."""
    body = bendable(cube(), 0.3)
    sway = np.outer(body.vertices[:, 2] ** 2, [3.0, 0.0, 0.0])
    moving = MovingBody(name="cube", vertices=body.vertices, faces=body.faces, edges=sharp_edges(body), displacement=sway)
    return DrawnMode(number=3, frequency=12.5, text="sways", bodies=(moving,))


def test_letters_of_a_full_sheet_have_7_points_on_paper_where_it_is_182_mm_wide(renderer, tmp_path, monkeypatch):
    sizes, write = list[float](), motion.scene.write
    monkeypatch.setattr(motion.scene, "write", lambda *words, **how: (sizes.append(words[4]), write(*words, **how)))
    mode_sheet("cube", [swaying()] * motion.COLUMNS, tmp_path / "sheet.png", "A note.")
    assert min(sizes) * 182 / (motion.COLUMNS * motion.TILE[0]) * 72 / 25.4 >= 7


def test_the_map_of_nodes_says_whole_what_is_of_the_table(renderer, tmp_path, monkeypatch):
    """On the narrowest sheet."""
    lines, write = list[str](), motion.scene.write
    monkeypatch.setattr(motion.scene, "write", lambda *words, **how: (lines.append(words[3]), write(*words, **how)))
    mode_sheet("nodes", [swaying()], tmp_path / "sheet.png", motion.NOTE, swing=0.0)
    said = " ".join(lines)
    assert "best node and number as in the table" in said
    assert "…" not in said


def test_the_map_of_nodes_and_its_table_have_one_best_node_and_one_number(tmp_path, monkeypatch):
    """To first order the first node explains most, and the table has the third at a finite size; the map had had the first, with
    a number of its own."""
    points = np.array([[0.0, 0, 0], [1, 0, 0], [2, 0, 0]])
    evidence = {kind: np.array([90.0, 30.0, 40.0]) for kind in ("point-mass", "cable:x")}
    scores = NodeScores(
        article="beam", structure=None, points=points, evidence=evidence, size=dict(evidence), tuned=np.zeros((3, 2))
    )
    table = (("@2,0,0", 12.0), ("@1,0,0", 8.0))
    told = [
        FoundNode(
            named=Named(family="point-mass", targets=(place,), values={"": 0.1}),
            article="beam",
            evidence=value,
            looked=2.0,
            position=tuple(map(float, place[1:].split(","))),
        )
        for place, value in table
    ]
    tiles, drawn = list[DrawnMode](), list[np.ndarray]()

    class Shown:
        @staticmethod
        def of(structure, points):
            return Shown

        @staticmethod
        def moving(name, shown):
            drawn.append(shown[:, 0])

    monkeypatch.setattr(motion, "Outline", Shown)
    monkeypatch.setattr(motion, "mode_sheet", lambda title, made, *words, **how: tiles.extend(made))
    motion.draw_nodes([scores.corrected("point-mass", {0: 9.0, 2: 14.0})], told, tmp_path / "nodes.png")
    assert [tile.text for tile in tiles] == ["12.0 nats at (2000, 0, 0) mm"]  # and no spring, of which the table has none
    np.testing.assert_allclose(drawn[0], [9.0, 10.0, 14.0])


def test_what_is_looked_for_everywhere_fits_above_its_tile():
    """One heading ran into the next, and the last off the sheet."""
    bold = FontProperties(family="DejaVu Sans", weight="bold")
    wide = {
        words: TextPath((0, 0), words, size=motion.LETTERS + 2, prop=bold).get_extents().width for words in motion.WORDS.values()
    }
    assert max(wide.values()) <= motion.TILE[0] - 24, wide


@pytest.mark.parametrize("name", ["clumod-4", "disc+cuboid"])
def test_a_rigid_motion_of_a_beam_model_carries_every_point_rigidly(name):
    model = flexible(name, "beam", FlexibleOptions(count=1))
    assert model.structure is not None
    article = built_in(name)
    points = np.random.default_rng(1).uniform([-0.6, -0.6, 0], [0.6, 0.6, 1.6], (200, 3))
    moved = displacement(model.structure, np.asarray(model.structure.rigid), article, points, nearest_part(article, points))
    assert_allclose(moved, [rigid_transformation(point) for point in points], atol=1e-9)  # rounding of metres


def test_points_on_the_axis_of_a_blade_move_as_its_nodes_do():
    model = flexible("clumod-4", "beam", FlexibleOptions(count=6))
    assert has_rotations(model.structure)
    article = built_in("clumod-4")
    owner = nearest_part(article, model.structure.points)
    names = [part.name for part in article.counted_parts]
    own = owner == names.index("upper-long")
    moved = displacement(model.structure, model.modes.shapes, article, model.structure.points[own], owner[own])
    expected = model.modes.shapes[model.structure.translations[own]]
    assert_allclose(moved, expected, atol=1e-9 * np.abs(expected).max())  # rounding


def test_the_layers_of_a_sandwich_move_together_and_the_mast_ends_where_it_is_held():
    model = flexible("clumod-4", "beam", FlexibleOptions(count=1))
    assert model.structure is not None
    article = built_in("clumod-4")
    names = [part.name for part in article.counted_parts]
    foot, tip = np.array([[0.0, 0.029, 0.034]]), np.array([[0.0, 0.4, 1.586]])
    mast = displacement(model.structure, model.modes.shapes, article, foot, np.array([names.index("mast")]))
    layers = [
        displacement(model.structure, model.modes.shapes, article, tip, np.array([names.index(f"upper-short-{layer}")]))
        for layer in ("bottom", "silicone", "top")
    ]
    assert np.abs(mast).max() < 1e-3 * np.abs(layers[0]).max()
    assert_allclose(layers[1], layers[0], rtol=1e-6)
    assert_allclose(layers[2], layers[0], rtol=1e-6)


def test_what_is_halved_keeps_its_surface_and_its_edges():
    import pyvista

    fine = bendable(cube(), 0.2)
    mesh = pyvista.PolyData(np.array(fine.vertices), np.column_stack([np.full(len(fine.faces), 3), fine.faces]).ravel())
    assert_allclose([mesh.volume, mesh.area], [1.0, 6.0], rtol=1e-6)  # VTK keeps points in single precision
    ends = fine.vertices[sharp_edges(fine)]
    lengths = np.linalg.norm(np.diff(ends, axis=1)[:, 0], axis=1)
    assert_allclose(lengths.sum(), 12.0, rtol=1e-6)
    assert lengths.max() <= 0.2 * (1 + 1e-6)


def test_all_files_are_there_and_the_sheet_shows_bodies_in_the_colours_of_their_motion(drawn):
    assert sorted(path.name for path in drawn.iterdir()) == [
        "modes-cuboid-beam-1.gif",
        "modes-cuboid-beam-1.glb",
        "modes-cuboid-beam.png",
    ]
    from PIL import Image

    with Image.open(drawn / "modes-cuboid-beam.png") as sheet:
        pixels = np.asarray(sheet.convert("RGB")).astype(int)
    red = (pixels[..., 0] > 150) & (pixels[..., 1] < 80) & (pixels[..., 2] < 80)
    blue = (pixels[..., 2] > 150) & (pixels[..., 0] < 90)
    assert red[100:600].sum() > 500  # what moves most
    assert blue[100:600].sum() > 500  # what moves little
    border = np.concatenate([pixels[:4].reshape(-1, 3), pixels[:, -4:].reshape(-1, 3)])
    assert border.min() > 250  # nothing is clipped at the edge of the sheet


def test_the_gif_moves_endlessly(drawn):
    from PIL import Image

    with Image.open(drawn / "modes-cuboid-beam-1.gif") as gif:
        assert gif.n_frames == FRAMES
        assert gif.info["loop"] == 0
        frames = []
        for k in range(FRAMES):
            gif.seek(k)
            frames.append(np.asarray(gif.convert("RGB")).astype(int))
    assert np.abs(frames[1] - frames[3]).max() > 100  # one end of the swing and the other
    assert np.abs(frames[0] - frames[1]).max() > 100


def test_no_mode_is_nothing_to_draw(tmp_path):
    with pytest.raises(BadInput, match="no mode to draw"):
        mode_sheet("stone", [], tmp_path / "sheet.png")


def tree_of(content: bytes) -> tuple[dict[str, Any], bytes]:
    """The JSON and the binary chunk of a ``.glb``, lengths and magic numbers checked."""
    magic, version, length = struct.unpack_from("<III", content)
    assert (magic, version, length) == (0x46546C67, 2, len(content))
    size, kind = struct.unpack_from("<II", content, 12)
    assert (kind, size % 4) == (0x4E4F534A, 0)
    second, binary = struct.unpack_from("<II", content, 20 + size)
    assert (binary, second % 4) == (0x004E4942, 0)
    assert 28 + size + second == len(content)
    return json.loads(content[20 : 20 + size]), content[28 + size :]


def test_every_slice_of_the_file_lies_within_it_and_says_its_bounds():
    tree, binary = tree_of(glb("cube", swaying()))
    widths = {"SCALAR": 1, "VEC3": 3, "VEC4": 4}
    sizes = {5126: 4, 5125: 4, 5121: 1}
    for accessor in tree["accessors"]:
        view = tree["bufferViews"][accessor["bufferView"]]
        assert view["byteOffset"] % 4 == 0
        assert view["byteLength"] == accessor["count"] * widths[accessor["type"]] * sizes[accessor["componentType"]]
        assert view["byteOffset"] + view["byteLength"] <= len(binary)
        if "min" in accessor:
            values = np.frombuffer(binary, "<f4", view["byteLength"] // 4, view["byteOffset"]).reshape(accessor["count"], -1)
            assert values.min(axis=0).tolist() == accessor["min"]
            assert values.max(axis=0).tolist() == accessor["max"]
    assert tree["asset"]["extras"]["frequency_hz"] == 12.5


def test_another_program_reads_the_body_at_rest_with_its_colours(tmp_path):
    import trimesh

    (tmp_path / "cube.glb").write_bytes(glb("cube", swaying()))
    scene = trimesh.load(tmp_path / "cube.glb", process=False)
    body = scene.geometry["cube"]
    assert_allclose(body.volume, 1.0, rtol=1e-6)  # single precision
    assert len(np.unique(body.visual.vertex_attributes["color"], axis=0)) > 3
    # z up becomes y up: the cube stands on y = 0 and reaches back along -z
    assert_allclose(scene.bounds, [[0, 0, -1], [1, 1, 0]], atol=1e-6)


def test_vtk_plays_the_animation_as_the_mode_swings(tmp_path):
    """An oracle that knows nothing of our writer: VTK applies the weights of the animation to the morph targets."""
    import pyvista
    from vtkmodules.vtkIOGeometry import vtkGLTFReader

    mode = swaying()
    (tmp_path / "cube.glb").write_bytes(glb("cube", mode))
    reader = vtkGLTFReader()
    reader.SetFileName(str(tmp_path / "cube.glb"))
    reader.ApplyDeformationsToGeometryOn()
    reader.UpdateInformation()
    assert reader.GetNumberOfAnimations() == 1
    assert reader.GetAnimationDuration(0) == pytest.approx(CYCLE)
    reader.EnableAnimation(0)
    reader.SetFrameRate(120)
    reader.UpdateInformation()

    def points(time):
        reader.UpdateTimeStep(time)
        return np.vstack([leaf.points for leaf in leaves(pyvista.wrap(reader.GetOutput()))])

    n = len(mode.bodies[0].vertices)
    swing = points(CYCLE / 4)[:n] - points(0.0)[:n]
    # the largest displacement is drawn as a share of the cube's diagonal; x stays x when z becomes y
    assert_allclose(np.abs(swing).max(), REACH * np.sqrt(3), rtol=1e-3)  # key frames are 1/32 of a cycle apart
    assert_allclose(swing[:, 0], REACH * np.sqrt(3) * mode.bodies[0].vertices[:, 2] ** 2, atol=1e-3)
    assert_allclose(points(3 * CYCLE / 4)[:n] - points(0.0)[:n], -swing, atol=1e-3)


def leaves(block: Any) -> Iterator[Any]:
    import pyvista

    for entry in block:
        if isinstance(entry, pyvista.MultiBlock):
            yield from leaves(entry)
        elif entry is not None:
            yield entry


def test_a_mode_that_does_not_move_is_written_at_rest():
    mode = swaying()
    still = MovingBody(
        name="cube",
        vertices=mode.bodies[0].vertices,
        faces=mode.bodies[0].faces,
        edges=mode.bodies[0].edges,
        displacement=np.zeros_like(mode.bodies[0].vertices),
    )
    tree, _ = tree_of(glb("cube", DrawnMode(number=1, frequency=1.0, text="", bodies=(still,))))
    assert tree["accessors"][1]["max"] == [0, 0, 0]
