"""Pictures that can be turned: everything stands where its label says."""

import io

import numpy as np
import numpy.typing as npt
import pytest
from PIL import Image

from validation.report.scenes.motion import MovingBody
from validation.report.scenes.scene import DrawnBody, fitted
from validation.report.scenes.setups import ARROW, DrawnSensor
from validation.report.scenes.turntable import MARGIN, Turn, Turntable, turned

CORNERS = np.array([[0.0, 0.0, 0.0], [1.0, 0.0, 0.0], [0.0, 1.0, 0.0], [0.0, 0.0, 1.0]])
FACES = np.array([[0, 2, 1], [0, 1, 3], [0, 3, 2], [1, 2, 3]])

Pixels = npt.NDArray[np.int64]


@pytest.fixture(scope="module")
def table() -> Turntable:
    """A corner of a cube with a red arrow along x at its end, and a blue one on top."""
    body = DrawnBody(name="corner", material="steel", vertices=CORNERS, faces=FACES)
    sensors = [
        DrawnSensor(name="p", group="fmd", position=CORNERS[1], direction=np.array([1.0, 0.0, 0.0])),
        DrawnSensor(name="q", group="table", position=CORNERS[3], direction=np.array([0.0, 0.0, 1.0])),
    ]
    return Turntable([body], sensors)


def pixels(made: bytes) -> Pixels:
    return np.asarray(Image.open(io.BytesIO(made))).astype(np.int64)


@pytest.mark.parametrize(
    "turn",
    [
        Turn(size=(420, 320)),
        Turn(size=(320, 300)),
        Turn(size=(320, 300), azimuth=-20, elevation=10),
        Turn(size=(500, 310), zoom=0.8),
    ],
)
def test_an_arrow_ends_where_the_view_says_whatever_was_shown_before(table, turn):
    image = pixels(table.jpeg(turn))
    assert image.shape[:2] == turn.size[::-1]
    points = np.vstack([CORNERS, CORNERS[[1, 3]], [1 + ARROW, 0, 0], [0, 0, 1 + ARROW]])
    view = turned(fitted(points, turn.size, MARGIN), turn, points)
    start, tip = view.pixel(CORNERS[1]), view.pixel(np.array([1 + ARROW, 0.0, 0.0]))
    along = (tip - start) / np.linalg.norm(tip - start)
    assert (np.argwhere(image[..., 0] - np.maximum(image[..., 1], image[..., 2]) > 30)[:, ::-1] @ along).max() == pytest.approx(
        tip @ along, abs=5
    )


def test_a_dark_page_gets_a_dark_picture_and_a_size_that_no_screen_has_is_cut(table):
    assert pixels(table.jpeg(Turn(dark=True)))[0, 0].max() < 40
    assert pixels(table.jpeg(Turn()))[0, 0].min() > 240
    assert pixels(table.jpeg(Turn(size=(100_000, 1)))).shape[:2] == (40, 2400)


def test_a_mode_swings_between_its_ends():
    moved = np.array([[0.0, 0.0, 0.0]] * 3 + [[1.0, 0.0, 0.0]])
    body = MovingBody(name="mast", vertices=CORNERS, faces=FACES, edges=np.array([[0, 3]]), displacement=moved)
    table = Turntable([body], scale=0.2)
    ends = [pixels(table.jpeg(Turn(share=share))) for share in (-1.0, 0.0, 1.0)]
    assert np.abs(ends[0] - ends[2]).mean() > np.abs(ends[0] - ends[1]).mean() > 0.5
