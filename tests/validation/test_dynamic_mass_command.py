"""`massline dynamic-mass`: what is printed, what a program reads, what is drawn and written, and how it ends."""

import csv
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.articles import built_in
from geometry.dynamic_mass import DynamicMass
from geometry.frames import rigid_transformation_6
from validation.cli import main
from validation.flexible.dynamic_mass import apart, lines, peaks, reference_point
from validation.report.charts.style import DynamicMassCurve


def matrices(said: dict[str, Any]) -> np.ndarray:
    return np.array(said["re"]) + 1j * np.array(said["im"])


def test_at_zero_frequency_it_is_the_rigid_body_about_any_point_and_f_is_the_origin_of_the_fmd(answer):
    said = {
        about: answer("dynamic-mass", "clumod-4", "--band", "0", "1", "--step", "1", "--about", about)
        for about in ("article", "F", "10 -20 300 mm")
    }
    assert [one["about"] for one in said.values()] == ["article", "F", "point"]
    rigid = matrices(said["article"])[0]
    assert_allclose(rigid.imag, 0, atol=1e-12)
    for one in said.values():
        point = 1e-3 * np.array(one["reference_point_mm"])
        T = rigid_transformation_6(-point)
        assert_allclose(matrices(one)[0], T.T @ rigid @ T, atol=1e-9 * np.abs(rigid).max())  # rounding
    assert said["article"]["reference_point_mm"] == [0, 0, 0]
    seat = built_in("fmd").seat
    assert reference_point("F", "fmd+clumod-1")[1].tolist() == [0, 0, 0]
    assert_allclose(reference_point("F", "clumod-1")[1], -seat.position)


def test_the_cuboid_is_flat_clumod_is_not_and_beside_exudyn_the_curves_agree_off_resonance(answer):
    """Paper, Figs. 7 to 9: straight lines for the Cuboid, resonances for Clumod."""
    flat, one = (answer("dynamic-mass", name) for name in ("disc+cuboid", "clumod-1"))
    diagonal = {key: np.abs(matrices(said)[:, range(6), range(6)]) for key, said in (("flat", flat), ("one", one))}
    # the first mode of the block lies a decade above the band, so its amplification is about (32 / 350)², 1 %
    assert (np.ptp(diagonal["flat"], axis=0) / diagonal["flat"][0]).max() < 0.02
    assert (diagonal["one"].max(axis=0) / diagonal["one"][0])[:5].min() > 5
    assert flat["peaks"] == []
    assert len(one["peaks"]) >= 5
    assert (one["frequency_hz"][0], one["frequency_hz"][-1], len(one["frequency_hz"])) == (4.0, 32.0, 561)
    said = answer("dynamic-mass", "clumod-1", "--against", "exudyn")
    assert said["against"] == "exudyn"
    # a frequency known to 1e-4 shows as that times 2 f / (f - f_r), some 70 at the edge of a resonance
    assert all(block["off_resonance_percent"] < 0.5 for block in said["apart"])


def test_what_is_written_is_what_was_computed(run, answer, tmp_path):
    said = answer("dynamic-mass", "clumod-1", "--step", "1", "--out", "H.npz")
    assert run("dynamic-mass", "clumod-1", "--step", "1", "--out", "deep/H.csv")[0] == main.DONE
    with np.load(tmp_path / "H.npz", allow_pickle=False) as stored:
        assert_allclose(stored["matrix"], matrices(said), rtol=0, atol=0)
        assert stored["frequency_hz"].tolist() == said["frequency_hz"]
    text = (tmp_path / "deep" / "H.csv").read_text(encoding="utf-8").splitlines()
    header, *rows = csv.reader(line for line in text if not line.startswith("#"))
    assert header[:3] == ["frequency_hz", "re_x_x", "im_x_x"]
    values = np.array(rows, dtype=float)
    assert_allclose(values[:, 1::2] + 1j * values[:, 2::2], matrices(said).reshape(-1, 36), rtol=0, atol=0)


def test_plots_show_curves_and_say_where_they_are(run, tmp_path):
    from PIL import Image

    code, _, err = run("dynamic-mass", "clumod-1", "--plot", "--step", "0.5")
    assert code == main.DONE
    for name in ("dynamic-mass-clumod-1-beam.png", "dynamic-mass-clumod-1-beam-6x6.png"):
        assert f"wrote out/{name}" in err
        with Image.open(tmp_path / "out" / name) as picture:
            pixels = np.asarray(picture.convert("RGB")).astype(int)
        blue = (np.abs(pixels - [0x24, 0x56, 0xC4]).sum(axis=2) < 40).sum()
        assert blue > 2000
        assert pixels[:6].min() > 240  # nothing is cut off at the edge


def marks(modes: Any) -> dict[str, Any]:
    return {"marked": modes.frequency, "effective_mass": modes.effective_mass}


def test_articles_stand_side_by_side(root, tmp_path):
    import runpy

    from PIL import Image

    from validation.flexible.model import FlexibleOptions, flexible

    model = flexible("clumod-1", "beam", FlexibleOptions(count=5))
    f = np.linspace(4, 32, 29)
    H = DynamicMass(frequency=f, matrix=np.tile(model.modes.rigid_mass.astype(complex), (29, 1, 1)))
    curve = DynamicMassCurve(name="one", mass=H, rigid=model.modes.rigid_mass, **marks(model.modes))
    side_by_side = runpy.run_path(str(root / "examples" / "pictures.py"))["side_by_side"]
    side_by_side("Two", [curve, curve], tmp_path / "two.png")
    with Image.open(tmp_path / "two.png") as picture:
        assert np.asarray(picture.convert("L")).std() > 10


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["clumod-1", "--band", "32", "4"], "found 32 to 4 Hz"),
        (["clumod-1", "--band", "-4", "32"], "found -4 to 32 Hz"),
        (["clumod-1", "--band", "4", "inf"], "found 4 to inf Hz"),
        (["clumod-1", "--band", "nan", "32"], "found nan"),
        (["clumod-1", "--step", "0"], "must be positive"),
        (["clumod-1", "--step", "1e-9"], "lines"),
        (["clumod-1", "--about", "G"], "Give F, article, or a point"),
        (["clumod-1", "--about", "0 0 45"], "--about"),
        (["clumod-1", "--out", "H.xls"], ".csv, .npz"),
        (["clumod-1", "--out", ""], "--out: no file is named"),
        (["clumod-1", "--out", "."], "--out: no file is named"),
        (["clumod-1", "--model", "bem"], "Did you mean beam?"),
        (["clumod-1", "--against", "bem"], "`--against`"),
        (["clumod-1", "--against", "beam"], "the beam model would stand beside itself"),
        (["clumod-7"], "no built-in article is called 'clumod-7'"),
        (["clumod-1", "--modes", "0"], "--modes: must lie between 1 and 500, found 0"),
        (["clumod-1", "--modes", "1000"], "found 1000"),
        (["clumod-1", "--damping", "1.5"], "below 1"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_input_is_refused_in_words_before_anything_is_written(arguments, words, refused, tmp_path):
    assert words in refused("dynamic-mass", *arguments)
    assert list(tmp_path.iterdir()) == []


def test_a_band_beyond_the_modes_kept_is_warned_of(run):
    code, _, err = run("dynamic-mass", "clumod-1", "--modes", "3", "--step", "4")
    assert code == main.DONE
    assert "the last of 3 modes kept" in err
    assert "--modes" in err
    assert run("dynamic-mass", "clumod-1", "--step", "4")[2] == ""


def test_the_difference_is_told_apart_off_and_at_resonance():
    f = lines((4.0, 20.0), 0.5)
    first = np.tile(np.eye(6, dtype=complex), (len(f), 1, 1))
    second = first.copy()
    second[f == 10.0, 0, 0] = 3.0
    second[f == 15.0, 4, 4] = 1.02
    pair = [DynamicMass(frequency=f, matrix=matrix) for matrix in (first, second)]
    force, coupling, moment = apart(*pair, np.array([10.1]), np.eye(6))
    assert (force.at_resonance, force.at_frequency, force.off_resonance) == (2.0, 10.0, 0.0)
    assert moment.off_resonance == pytest.approx(0.02)
    assert (moment.off_frequency, moment.at_resonance) == (15.0, 0.0)
    assert coupling.off_resonance == 0.0
    heavy = apart(*pair, np.array([10.1]), 4 * np.eye(6))  # an antiresonance of a body four times as heavy
    assert heavy[2].off_resonance == pytest.approx(0.005)


def test_a_peak_is_where_the_mode_is():
    f = lines((4.0, 32.0), 0.05)
    H = np.zeros((len(f), 6, 6), dtype=complex)
    H[:, range(6), range(6)] = 1.0
    H[:, 2, 2] += f**2 / (12.0**2 - f**2 + 2j * 0.01 * 12.0 * f)
    (peak,) = peaks(DynamicMass(frequency=f, matrix=H), np.ones(6))
    assert peak.axis == 2
    assert peak.frequency == pytest.approx(12.0, abs=0.05)
    assert peak.magnitude == pytest.approx(50.0, rel=0.02)  # 1 / (2 zeta)


def test_figures_of_resonances_stand_clear_of_a_panels_title(monkeypatch, tmp_path):
    """Clumod's first mode is so near the left end of the band that its figure lies below the title."""
    from matplotlib.figure import Figure

    from fem.beam import articles
    from fem.dynamic_mass import modal
    from fem.modes import fixed_base
    from validation.report.charts import static, style

    pages: list[Figure] = []
    modes = fixed_base(articles.structure("clumod-4"), 20)
    mass = modal(modes, np.linspace(4, 32, 57))
    monkeypatch.setattr(static, "finish", lambda figure, *rest: pages.append(figure))
    style.diagonal("x", [DynamicMassCurve(name="beam", mass=mass, rigid=modes.rigid_mass, **marks(modes))], tmp_path / "x.png")
    (figure,) = pages
    figure.canvas.draw()
    figures = [(axes, text) for axes in figure.axes for text in axes.texts]
    assert figures
    for axes, text in figures:
        title: Any = getattr(axes, "_left_title")  # noqa: B009 - matplotlib has no public way to it
        assert not title.get_window_extent().overlaps(text.get_window_extent())
