"""Pictures: the ellipsoid in closed form, the camera against what is rendered, and files that are whole or absent."""

import errno
import os
import runpy
import subprocess
import sys
from collections.abc import Iterator
from ctypes.util import find_library

import numpy as np
import numpy.typing as npt
import pytest
from hypothesis import example, given
from hypothesis import strategies as st
from matplotlib.colors import to_rgb
from matplotlib.image import imread
from numpy.testing import assert_allclose

from geometry.errors import BadInput, CheckFailed
from geometry.frames import Pose
from geometry.inertia import Inertia
from tools.pages import said_about
from validation.report.charts.style import AXES, MATERIALS, OTHERS, Label, arranged, colours
from validation.report.scenes import scene

seeds = st.integers(0, 2**32 - 1)
CORNERS = np.array([[x, y, z] for x in (0, 1) for y in (0, 1) for z in (0, 1)], dtype=float)
SQUARES = [[0, 1, 3, 2], [4, 6, 7, 5], [0, 4, 5, 1], [2, 3, 7, 6], [0, 2, 6, 4], [1, 5, 7, 3]]
FACES = np.array([triangle for a, b, c, d in SQUARES for triangle in ([a, b, c], [a, c, d])])


def brick(size: tuple[float, float, float], foot: tuple[float, float, float] = (0, 0, 0), **how: object) -> scene.DrawnBody:
    """A box of `size` [m] whose lowest corner is at `foot` [m]."""
    return scene.DrawnBody(
        name=str(how.get("name", "brick")),
        material=str(how.get("material", "steel")),
        vertices=CORNERS * size + foot,
        faces=FACES,
        counted=bool(how.get("counted", True)),
    )


def of_brick(size: tuple[float, float, float], foot: tuple[float, float, float] = (0, 0, 0), density: float = 2700.0) -> Inertia:
    x, y, z = size
    mass = density * x * y * z
    moments = mass / 12 * np.array([y * y + z * z, x * x + z * z, x * x + y * y])
    return Inertia.from_cog(mass, np.array(foot) + np.array(size) / 2, np.diag(moments))


def pose(seed: int) -> Pose:
    rng = np.random.default_rng(seed)
    Q, _ = np.linalg.qr(rng.normal(size=(3, 3)))
    return Pose(position=rng.uniform(-3, 3, 3), rotation=Q * np.linalg.det(Q))


def nearest(image: npt.NDArray[np.uint8], colour: str, within: float) -> npt.NDArray[np.bool_]:
    """Where the hue of `image` is that of `colour`: the direction from grey, at most `within` [rad] apart."""
    wanted = np.array(to_rgb(colour)) - np.mean(to_rgb(colour))
    found = image / 255.0
    chroma = found - found.mean(axis=-1, keepdims=True)
    length = np.linalg.norm(chroma, axis=-1)
    cosine = chroma @ wanted / np.maximum(length * np.linalg.norm(wanted), 1e-9)
    return np.asarray((cosine > np.cos(within)) & (length > 0.02))


@given(seeds, st.tuples(*[st.floats(0.05, 2)] * 3), st.floats(0.1, 100))
def test_a_homogeneous_ellipsoid_is_its_own_equivalent_ellipsoid(seed, semi_axes, mass):
    """I1 = m/5 (b² + c²): the textbook's moments of an ellipsoid, in any attitude and place."""
    a, b, c = semi_axes
    tensor = mass / 5 * np.diag([b * b + c * c, a * a + c * c, a * a + b * b])
    where = pose(seed)
    ellipsoid = scene.equivalent_ellipsoid(Inertia.from_cog(mass, np.zeros(3), tensor).placed(where))
    assert_allclose(np.sort(ellipsoid.semi_axes), np.sort(semi_axes), rtol=1e-6)
    assert_allclose(ellipsoid.centre, where.position, rtol=0, atol=1e-9)


@given(seeds)
def test_what_is_stretched_onto_it_lies_on_its_surface(seed):
    ellipsoid = scene.equivalent_ellipsoid(of_brick((0.2, 0.3, 0.5)).placed(pose(seed)))
    unit = np.random.default_rng(seed).normal(size=(20, 3))
    unit /= np.linalg.norm(unit, axis=1)[:, None]
    along = (ellipsoid.stretched(unit) - ellipsoid.centre) @ ellipsoid.axes
    assert_allclose(((along / ellipsoid.semi_axes) ** 2).sum(axis=1), 1, rtol=1e-9)


@given(seeds, st.sampled_from([(0.2, 0.3, 0.5), (0.3, 0.3, 0.5), (0.5, 0.5, 0.3), (0.4, 0.4, 0.4)]))
def test_drawn_axes_are_principal_and_right_handed_also_where_moments_are_equal(seed, size):
    inertia = of_brick(size).placed(pose(seed))
    ellipsoid = scene.equivalent_ellipsoid(inertia)
    assert_allclose(ellipsoid.axes.T @ inertia.tensor_cog @ ellipsoid.axes, np.diag(ellipsoid.moments), rtol=0, atol=1e-9)
    assert_allclose(np.linalg.det(ellipsoid.axes), 1, rtol=1e-12)
    assert len(ellipsoid.equal) == 3 - len(set(size))


def test_axes_that_are_free_to_turn_lie_along_the_frame_and_the_ellipsoid_of_a_rod_is_a_line():
    assert_allclose(scene.equivalent_ellipsoid(of_brick((0.3, 0.3, 0.1))).axes, np.eye(3), rtol=0, atol=1e-12)
    assert_allclose(scene.equivalent_ellipsoid(of_brick((0.3, 0.3, 0.3))).axes, np.eye(3), rtol=0)
    rod = scene.equivalent_ellipsoid(Inertia.from_cog(1.0, np.zeros(3), np.diag([0.0, 1 / 12, 1 / 12])))
    assert_allclose(rod.semi_axes, [np.sqrt(5 / 12), 0, 0], rtol=1e-12, atol=1e-9)


@given(seeds)
def test_everything_fits_into_the_picture_and_touches_its_margin(seed):
    points = np.random.default_rng(seed).normal(size=(30, 3)) * [1.0, 2.0, 0.3]
    view = scene.fitted(points, (400, 300), margin=20)
    pixels = view.pixel(points)
    gap = np.minimum(pixels, np.array(view.size) - pixels).min(axis=0)
    assert np.all(gap > 20 - 1e-6)
    assert_allclose(gap.min(), 20, rtol=0, atol=1e-6)


def test_up_is_up_x_runs_to_the_right_and_a_length_across_the_line_of_sight_is_true_to_scale():
    view = scene.fitted(CORNERS, (400, 300), margin=20)
    origin, x, z = view.pixel(np.zeros(3)), view.pixel([1, 0, 0]), view.pixel([0, 0, 1])
    assert x[0] > origin[0]
    assert_allclose(z[0], origin[0], rtol=0, atol=1e-9)
    assert z[1] < origin[1]
    assert_allclose(np.cross(view.right, view.up), view.towards, rtol=0, atol=1e-12)
    for place in CORNERS:
        ends = view.pixel(np.array([place, place + 0.1 * view.right]))
        assert_allclose(np.linalg.norm(np.diff(ends, axis=0)), 0.1 / view.scale, rtol=1e-9)


@pytest.mark.usefixtures("renderer")
@pytest.mark.parametrize("place", ["cog", "left lower corner", "right upper corner"])
def test_a_mark_is_set_where_vtk_draws_what_it_marks(place):
    """A small red ball at the CoG of a brick and at its corners: the middle of its pixels against our own projection."""
    size, foot = (0.2, 0.3, 0.5), (0.1, -0.2, 0.05)
    ellipsoid = scene.equivalent_ellipsoid(of_brick(size, foot))
    view = scene.fitted(brick(size, foot).vertices, (480, 360), margin=30)
    corners = {"left lower corner": brick(size, foot).vertices[0], "right upper corner": brick(size, foot).vertices[-1]}
    point, half = corners.get(place, ellipsoid.centre), 0.01 * view.towards
    image = scene.rendered(
        view, [brick(size, foot)], ellipsoid, [scene.Arrow(start=point - half, end=point + half, radius=0.01, colour="#ff0000")]
    )
    rows, columns = np.nonzero(nearest(image, "#ff0000", 0.15))
    assert len(rows) > 50
    assert_allclose([columns.mean() + 0.5, rows.mean() + 0.5], view.pixel(point), rtol=0, atol=1.0)


@pytest.mark.usefixtures("renderer")
def test_each_material_and_each_axis_is_seen_in_its_own_colour():
    bodies = [brick((0.1, 0.1, 0.1), (0.15 * i, 0, 0), material=name) for i, name in enumerate(("steel", "silicone", "brass"))]
    image, view = small_scene(bodies)
    for body in bodies:
        x, y = np.round(view.pixel(body.vertices.mean(axis=0))).astype(int)
        seen = nearest(image[y - 4 : y + 5, x - 4 : x + 5], MATERIALS[body.material], 0.35)
        assert seen.mean() > 0.9
    for colour in AXES:
        assert nearest(image, colour, 0.2).sum() > 30


@pytest.mark.usefixtures("renderer")
def test_what_is_not_counted_is_fainter_than_what_is_and_one_can_look_into_a_body():
    counted, _ = small_scene([brick((0.1, 0.1, 0.1)), brick((0.1, 0.1, 0.1), (0.2, 0, 0))])
    ghost, view = small_scene([brick((0.1, 0.1, 0.1)), brick((0.1, 0.1, 0.1), (0.2, 0, 0), counted=False)])
    x, y = np.round(view.pixel([0.25, 0.05, 0.05])).astype(int)
    near = np.s_[y - 3 : y + 4, x - 3 : x + 4]
    assert ghost[near].mean() > counted[near].mean() + 40
    assert ghost[near].mean() < 254
    # A block of silicone inside a block of steel: its hue is sensed from outside.
    shell, core = brick((0.3, 0.3, 0.3)), brick((0.2, 0.2, 0.2), (0.05, 0.05, 0.05), material="silicone")
    image, view = small_scene([shell, core])
    x, y = np.round(view.pixel([0.15, 0.15, 0.15])).astype(int)
    assert nearest(image[y - 2 : y + 3, x - 2 : x + 3], MATERIALS["silicone"], 0.6).mean() > 0.9


def small_scene(bodies: list[scene.DrawnBody]) -> tuple[npt.NDArray[np.uint8], scene.Projection]:
    """Bodies with three axes far from them and an ellipsoid too small to be seen; 320 x 240 pixels."""
    points = np.concatenate([body.vertices for body in bodies])
    view = scene.fitted(points, (320, 240), margin=60)
    corner = view.centre + view.scale * (-150 * view.right - 110 * view.up)
    arrows = [
        scene.Arrow(start=corner, end=corner + 60 * view.scale * axis, radius=2 * view.scale, colour=colour)
        for axis, colour in zip(np.eye(3), AXES, strict=True)
    ]
    ball = scene.Ellipsoid(centre=corner, axes=np.eye(3), moments=np.ones(3), semi_axes=np.full(3, 1e-6))
    return scene.rendered(view, bodies, ball, arrows), view


@pytest.mark.usefixtures("renderer")
def test_a_picture_of_an_article_is_written_whole_quietly_and_repeatably(tmp_path, capfd):
    from geometry import routes
    from geometry.articles import built_in

    article = built_in("disc")
    bodies, inertia = scene.drawn_bodies(article, chord=2e-3), routes.inertia(article)
    for name in ("once.png", "again.png"):
        scene.picture("disc", bodies, inertia, tmp_path / "new" / name, note=article.note)
    assert capfd.readouterr() == ("", "")
    assert sorted(entry.name for entry in (tmp_path / "new").iterdir()) == ["again.png", "once.png"]
    assert (tmp_path / "new" / "once.png").read_bytes() == (tmp_path / "new" / "again.png").read_bytes()
    image = np.round(255 * imread(tmp_path / "new" / "once.png")[..., :3]).astype(np.uint8)
    assert image.shape == (1200, 1600, 3)
    assert np.all(image[[0, 0, -1, -1], [0, -1, 0, -1]] == 255)
    assert 0.02 < (image < 250).any(axis=-1).mean() < 0.9
    for colour in (MATERIALS["aluminium"], *AXES):
        assert nearest(image, colour, 0.25).sum() > 100


@pytest.mark.parametrize(("height", "shown"), [(0.0, True), (0.1, True), (50.0, False)])
def test_the_frames_origin_is_in_the_picture_unless_it_would_make_the_article_small(height, shown):
    size, foot = (0.2, 0.1, 0.4), (0.0, 0.0, height)
    view = scene.view_of([brick(size, foot)], scene.equivalent_ellipsoid(of_brick(size, foot)))
    origin = view.pixel(np.zeros(3))
    assert np.all((origin >= 0) & (origin <= view.size)) == shown
    assert 0.4 / view.scale > 0.5 * view.size[1]


def test_an_impossible_inertia_and_a_picture_without_counted_bodies_are_not_drawn(tmp_path):
    impossible = Inertia.from_cog(1.0, np.zeros(3), np.diag([1.0, 1.0, 3.0]))
    with pytest.raises(BadInput, match="picture of brick: `inertia`: no body has these parameters"):
        scene.picture("brick", [brick((1, 1, 1))], impossible, tmp_path / "brick.png")
    assert not list(tmp_path.iterdir())
    with pytest.raises(BadInput, match="no body counts"):
        scene.picture("ghost", [brick((1, 1, 1), counted=False)], of_brick((1, 1, 1)), tmp_path / "ghost.png")


@pytest.mark.usefixtures("renderer")
def test_a_failed_writing_leaves_the_old_picture(tmp_path, monkeypatch):
    old = tmp_path / "brick.png"
    old.write_text("old")

    def full(*_, **__):
        raise OSError(errno.ENOSPC, "No space left on device")

    monkeypatch.setattr("matplotlib.figure.Figure.savefig", full)
    with pytest.raises(OSError, match="No space left"):
        scene.picture("brick", [brick((1, 1, 1))], of_brick((1, 1, 1)), old)
    assert [entry.read_text() for entry in tmp_path.iterdir()] == ["old"]


@pytest.mark.parametrize("name", ["brick", "brick.gif", "brick.png.txt"])
def test_a_format_that_cannot_be_written_is_refused_before_anything_is_drawn(tmp_path, name):
    with pytest.raises(BadInput, match=r"a picture ends in \.png, \.jpg, \.jpeg, found"):
        scene.picture("brick", [brick((1, 1, 1))], of_brick((1, 1, 1)), tmp_path / name)


@pytest.mark.usefixtures("renderer")
def test_names_that_a_user_chose_are_written_as_they_are(tmp_path):
    """A file called ``a$b$`` is not mathematics, and a long path or forty materials do not break the page."""
    bodies = [brick((0.1, 0.1, 0.1), (0.11 * i, 0, 0), material=f"$alloy_{{{i} unfinished") for i in range(40)]
    scene.picture(
        "/a/very/long/path" * 10 + "$x$.step", bodies, of_brick((4.4, 0.1, 0.1)), tmp_path / "x.jpg", note="$ {long} " * 300
    )
    assert imread(tmp_path / "x.jpg").shape == (1200, 1600, 3)


def test_a_long_name_loses_its_middle_and_a_principal_axis_is_named_when_it_is_one_of_the_frame():
    assert scene.shortened("abcdefghij", 10) == "abcdefghij"
    assert scene.shortened("abcdefghijk", 9) == "abcd…hijk"
    assert scene.direction(np.array([0.0, 0.0, 1.0])) == "along $z$"
    assert scene.direction(np.array([-1.0, 0.0, 0.0])) == "along −$x$"
    assert scene.direction(np.array([0.6, -0.8, 0.0])) == "(0.600, −0.800, 0.000)"


def test_a_drawn_body_is_a_copy_that_cannot_be_changed_and_refuses_what_is_no_mesh():
    vertices = CORNERS.copy()
    body = scene.DrawnBody(name="brick", material="steel", vertices=vertices, faces=FACES)
    vertices[0] = 9.0
    assert body.vertices[0, 0] == 0.0
    for array in (body.vertices, body.faces):
        with pytest.raises(ValueError, match="read-only"):
            array[0] = 1
    with pytest.raises(ValueError, match="`faces` must be"):
        scene.DrawnBody(name="brick", material="steel", vertices=CORNERS, faces=FACES + 1)
    with pytest.raises(ValueError, match="`vertices` must"):
        scene.DrawnBody(name="brick", material="steel", vertices=CORNERS * np.nan, faces=FACES)


@pytest.fixture
def forgetful() -> Iterator[None]:
    """The machine is tried anew, before the test and after it."""
    scene._require_renderer.cache_clear()
    yield
    scene._require_renderer.cache_clear()


def refused() -> None:
    packages = "On Debian install the packages libegl1, libgl1 and libgl1-mesa-dri"
    with pytest.raises(CheckFailed, match=packages), scene.off_screen():
        pass


@pytest.mark.usefixtures("forgetful")
@pytest.mark.skipif(find_library("OSMesa") is not None, reason="VTK falls back on OSMesa, which is installed here")
def test_a_machine_without_opengl_is_told_what_to_install(monkeypatch):
    """EGL is told that no vendor's library exists; VTK left alone ends with a segmentation fault."""
    monkeypatch.setenv("__EGL_VENDOR_LIBRARY_FILENAMES", "/nowhere.json")
    refused()


@pytest.mark.usefixtures("forgetful")
@pytest.mark.parametrize(("code", "patience"), [("import os; os.abort()", 60), ("import time; time.sleep(60)", 0.1)])
def test_a_driver_that_crashes_or_hangs_does_not_take_us_with_it(monkeypatch, code, patience):
    monkeypatch.setattr(scene, "TRIAL", code)
    monkeypatch.setattr(scene, "PATIENCE", patience)
    refused()


@pytest.mark.usefixtures("renderer")
def test_the_environment_is_left_as_it_was(monkeypatch):
    monkeypatch.setenv("EGL_LOG_LEVEL", "warning")
    before = dict(os.environ)
    with scene.off_screen():
        assert os.environ["EGL_LOG_LEVEL"] == "fatal"
    assert dict(os.environ) == before


@pytest.mark.usefixtures("renderer")
def test_nothing_is_said_without_a_screen():
    """A process of its own without DISPLAY: neither VTK nor Mesa writes to standard error."""
    code = (
        "from validation.report.scenes.scene import shot\n"
        "from validation.report.scenes.scene import off_screen\n"
        "from validation.report.scenes.scene import fitted\n"
        "import numpy as np\n"
        "with off_screen():\n"
        "    assert shot(fitted(np.eye(3), (32, 24), 2), lambda plotter: None).min() == 255\n"
    )
    quiet = {name: value for name, value in os.environ.items() if name != "DISPLAY"}
    ended = subprocess.run([sys.executable, "-P", "-c", code], env=quiet, capture_output=True, text=True, check=False)
    assert (ended.returncode, ended.stdout, ended.stderr) == (0, "", "")


@pytest.fixture(scope="module")
def contact_sheet(root):
    return runpy.run_path(str(root / "examples" / "pictures.py"))["contact_sheet"]


def test_a_contact_sheet_puts_pictures_two_abreast(contact_sheet, tmp_path):
    from matplotlib.image import imsave

    shades = [(255, 0, 0), (0, 255, 0), (0, 0, 255)]
    paths = [tmp_path / f"{i}.png" for i in range(3)]
    for path, shade in zip(paths, shades, strict=True):
        imsave(path, np.full((120, 160, 3), shade, dtype=np.uint8))
    contact_sheet(paths, tmp_path / "sheet.png", about="three shades")
    assert said_about(tmp_path / "sheet.png") == "three shades"
    sheet = np.round(255 * imread(tmp_path / "sheet.png")[..., :3])
    assert sheet.shape == (1200, 1600, 3)
    for (row, column), shade in zip([(300, 400), (300, 1200), (900, 400), (900, 1200)], [*shades, (255, 255, 255)], strict=True):
        assert_allclose(sheet[row, column], shade, rtol=0)


def test_a_contact_sheet_says_which_picture_it_cannot_read(contact_sheet, tmp_path):
    (tmp_path / "text.png").write_text("no picture")
    for path in (tmp_path / "text.png", tmp_path / "absent.png"):
        with pytest.raises(BadInput, match=f"{path.name}: this is no picture that can be read"):
            contact_sheet([path], tmp_path / "sheet.png")
    with pytest.raises(BadInput, match="no picture was given"):
        contact_sheet([], tmp_path / "sheet.png")
    assert not (tmp_path / "sheet.png").exists()


@pytest.mark.parametrize(
    ("value", "text"),
    [(47.23, "47.230"), (0.0307129, "0.030713"), (-20.144, "−20.144"), (0.0, "0"), (1.5e-7, "1.5000e−07"), (123456.7, "123457")],
)
def test_figures_keep_five_significant_digits(value, text):
    assert scene.significant(value, 5) == text


def test_a_material_keeps_its_colour_and_strangers_get_different_ones():
    assert colours(["steel", "oak"]) == {"steel": MATERIALS["steel"], "oak": MATERIALS["oak"]}
    assert colours(["unobtainium", "steel", "adamant"]) == {
        "adamant": OTHERS[0],
        "steel": MATERIALS["steel"],
        "unobtainium": OTHERS[1],
    }


@given(seeds, st.sampled_from([6, 40]))
@example(85, 6)
def test_labels_do_not_cover_one_another_however_many_there_are(seed, many):
    places = arranged(crowd(seed, many))
    assert not covered(places, np.array([26.0, 30.0]))


@given(seeds)
def test_labels_stay_in_the_room_while_there_is_a_place_in_it(seed):
    """Anchors at the room's left edge; half of the labels would like to stand outside of it."""
    room = (np.array([200.0, 150.0]), (240.0, 300.0))
    places = np.array(arranged(crowd(seed, 6), room=room))
    assert not covered(list(places), np.array([26.0, 30.0]))
    assert np.all(np.abs(places - room[0]) <= (np.array(room[1]) - [26, 30]) / 2 + 1e-9)


def test_labels_without_a_place_in_the_room_stand_outside_of_it_rather_than_on_one_another():
    places = arranged(crowd(0, 3), room=(np.array([100.0, 100.0]), (30.0, 34.0)))
    assert not covered(places, np.array([26.0, 30.0]))


def crowd(seed: int, many: int) -> list[Label]:
    """Labels of 26 x 30 pixels on anchors within 40 x 40."""
    rng = np.random.default_rng(seed)
    anchors, wishes = rng.uniform(80, 120, (many, 2)), rng.normal(size=(many, 2))
    return [
        Label(text="x", anchor=anchor, wish=wish, extent=(26, 30), gap=8, colour="k")
        for anchor, wish in zip(anchors, wishes, strict=True)
    ]


def covered(places: list[npt.NDArray[np.float64]], extent: npt.NDArray[np.float64]) -> bool:
    """Whether any two labels of `extent` overlap."""
    pairs = ((a, b) for i, a in enumerate(places) for b in places[:i])
    return any(np.all(np.abs(a - b) < extent - 1e-9) for a, b in pairs)
