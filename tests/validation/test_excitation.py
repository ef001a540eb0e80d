"""What `massline excite` rests on: rigs from names, resonances passed, amplitudes, pictures and the animation."""

from collections.abc import Iterator
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.patterns import Sweep
from fem.base_excitation.response import Response
from fem.base_excitation.rig import LoadCell
from fem.beam.articles import load_cells
from geometry.article import material
from geometry.articles import built_in, locations
from geometry.frames import rigid_transformation
from geometry.routes import inertia
from validation.cli import main
from validation.excite.question import Attached, attached
from validation.excite.results import Amplitudes, AxisResponse, CellLoad, amplitude, cross_share
from validation.excite.rig import RigModes, Run, mounted, rig_modes
from validation.flexible.model import Flexible, FlexibleOptions
from validation.flexible.modes import node_displacement
from validation.report.charts.excitation import _few_decades
from validation.report.charts.static import new_figure
from validation.report.flexible import Moved
from validation.report.scenes import turntable
from validation.report.scenes.scene import DrawnBody

RATE = 512.0
MASS = 12.0


def swept(rate: float = 20.0) -> Run:
    sweep = Sweep(axis="x", start=4.0, stop=32.0, rate=rate)
    return Run(name="x", axes=(0,), pattern=sweep, sweep=sweep, levels=np.array([2.5, 0, 0, 0, 0, 0]))


def modes(*frequency: float, share: float = 0.5) -> RigModes:
    L = np.zeros((6, len(frequency)))
    L[0] = np.sqrt(share * MASS)
    zeta = np.full(len(frequency), 0.01)
    return RigModes(
        frequency=np.array(frequency),
        damping_ratio=zeta,
        participation=L,
        rigid_mass=MASS * np.eye(6),
        resonance=(True,) * len(frequency),
    )


def swelling(run: Run, at: float, times: float) -> Response:
    """A rigid body of `MASS` whose load is `times` as large where the sweep passes `at` [Hz]."""
    motion = run.motion(RATE, 2.0, None)
    f = run.sweep.frequency_at(motion.time)
    swell = 1 + (times - 1) * np.exp(-(((f - at) / 0.3) ** 2))
    load = MASS * motion.acceleration * swell[:, None]
    return Response(
        sampling_rate=RATE, table=motion.acceleration, cover=motion.acceleration, load=load, cells=np.zeros((len(load), 0, 3))
    )


@pytest.mark.parametrize("cells", [False, True], ids=["rigid", "cells"])
@pytest.mark.parametrize("article", ["fmd", "fmd+clumod-1", "fmd+disc+cuboid", "clumod-4"])
def test_whatever_stands_on_the_table_weighs_what_its_drawing_says_about_f(article, cells):
    made = mounted(article, "beam", FlexibleOptions(count=4), Attached(cells=cells and article.startswith("fmd")))
    expected = inertia(built_in(article)).mass_matrix
    assert_allclose(rig_modes(made.rig).rigid_mass, expected, atol=1e-9 * np.abs(expected).max())  # rounding


def test_on_stiff_cells_the_article_keeps_its_own_resonances_and_none_rises():
    """The cells give, so that every resonance is lower than on the rigid cover plate (Rayleigh), if by little."""
    on_cells, alone = (
        rig_modes(mounted("fmd+clumod-1", "beam", FlexibleOptions(count=6), Attached(cells=cells)).rig).frequency[:4]
        for cells in (True, False)
    )
    assert np.all(on_cells <= alone * (1 + 1e-12))
    assert_allclose(on_cells, alone, rtol=0.02)


def test_the_fmd_swings_on_its_cells_as_a_mass_on_four_springs_that_lose_what_their_material_does():
    """Along z through its CoG: 2 pi f = sqrt(4 k / m), zeta = eta / 2, both of the steel of the cells (assumed)."""
    found = rig_modes(mounted("fmd", "beam", FlexibleOptions(), Attached(cells=True)).rig)
    mass, k = inertia(built_in("fmd")).mass, load_cells()[0, 2]
    r = int(np.argmax(np.abs(found.participation[2])))
    eta = material("steel").loss_factor
    assert eta is not None
    assert found.frequency[r] == pytest.approx(np.sqrt(4 * k / mass) / (2 * np.pi), rel=1e-9)
    assert found.damping_ratio[r] == pytest.approx(eta / 2, rel=1e-9)
    assert found.participation[2, r] ** 2 == pytest.approx(mass, rel=1e-9)


@pytest.mark.parametrize(("article", "joints"), [("clumod-1", 0), ("fmd+clumod-1", 6)])
def test_what_carries_static_answers_is_no_resonance(article, joints):
    """The article's own modes and the six of the cover plate on its cells are; up to six carriers are told from them."""
    made = mounted(article, "beam", FlexibleOptions(count=5), Attached(cells=joints > 0)).rig
    found = rig_modes(made)
    assert sum(found.resonance) == 5 + joints < len(found.frequency)
    assert found.resonance[:5] == (True,) * 5


@pytest.mark.parametrize("axis", [0, 1])
def test_the_lateral_load_of_a_cell_is_the_larger_of_x_and_y(axis):
    forces = np.zeros((3, 1, 3))
    forces[1, 0, axis], forces[2, 0, 1 - axis], forces[:, 0, 2] = -7.0, 3.0, (1.0, 50.0, -9.0)
    found = CellLoad.of(1, forces[:, 0], LoadCell(position=np.zeros(3), stiffness=np.ones(3)))
    assert (found.lateral, found.lowest, found.highest) == (7.0, -9.0, 50.0)


@pytest.mark.parametrize("rate", [20.0, 120.0])
def test_the_level_of_a_sweep_is_that_of_its_band_and_not_of_its_soft_start(rate):
    """In the band the acceleration is A (1 + (k / omega)² / 2), k the growth of the frequency (`Sweep`)."""
    run = swept(rate)
    motion = run.motion(8192.0, 0.0, None)
    table = motion.acceleration.copy()
    table[motion.time > float(run.sweep.time_at(32.0)), 0] *= 2
    still = np.zeros((len(table), 6))
    response = Response(sampling_rate=8192.0, table=table, cover=still, load=still, cells=np.zeros((len(table), 0, 3)))
    found = AxisResponse.of(0, run, response, motion.driven)
    assert found.realised == pytest.approx(2.5 * (1 + (rate * np.log(2) / 60 / (2 * np.pi * 4)) ** 2 / 2), rel=1e-3)
    assert found.peak > 1.2 * found.realised


def test_cross_motion_is_the_largest_share_of_any_other_axis_and_places_ride_on_the_article():
    run = swept()
    table = np.zeros((3, 6))
    table[0, 0], table[1, 2], table[2, 5] = 2.5, -0.05, 0.3  # of nominal levels 2.5, 2.5 and 6
    still = np.zeros((3, 6))
    response = Response(sampling_rate=RATE, table=table, cover=still, load=still, cells=np.zeros((3, 0, 3)))
    assert cross_share(run, response) == pytest.approx(0.05, rel=1e-12)
    made = mounted("fmd+clumod-1", "beam", FlexibleOptions(count=4), Attached())
    known = locations("clumod-1")
    assert set(made.rig.article.places) == set(known)
    for name, point in known.items():
        assert_allclose(made.rig.article.places[name][:, :6], rigid_transformation(point), atol=1e-9)  # rounding of metres
    assert_allclose(made.rig.seat, built_in("fmd").seat.position)  # type: ignore[union-attr]


def test_a_loose_part_weighs_on_the_flange_while_it_is_held():
    options = dict.fromkeys(("preload", "flange", "cable", "damper"), ())
    loose = attached(cells=False, friction=["x=5,mass:3", "y=4"], **options)
    made, bare = (
        rig_modes(mounted("fmd+cuboid", "beam", FlexibleOptions(count=2), one).rig).rigid_mass for one in (loose, Attached())
    )
    seat = rigid_transformation(built_in("fmd").seat.position)  # type: ignore[union-attr]
    assert_allclose(made - bare, 5.0 * seat.T @ seat, atol=1e-12)


def test_what_is_typed_becomes_springs_along_the_axes_it_names():
    made = attached(
        cells=True,
        preload=["2 kN"],
        flange=["rotation=1e-6", "vertical=1e-9"],
        friction=[],
        cable=["mast-top=1000", "lower-1-:lateral=5"],
        damper=["lower-1+:vertical=7"],
    )
    assert made.preload == dict.fromkeys("1234", 2000.0)
    assert made.flange.compliance.tolist() == [0, 0, 1e-9, 1e-6, 1e-6, 0]
    assert [(s.place, s.to, s.stiffness.tolist(), s.damping.tolist()) for s in made.struts] == [
        ("mast-top", "ground", [1000, 1000, 1000], [0, 0, 0]),
        ("lower-1-", "ground", [5, 5, 0], [0, 0, 0]),
        ("lower-1+", "table", [0, 0, 0], [0, 0, 7]),
    ]
    assert made.options == ("--cells", "--preload", "--flange", "--cable", "--damper")


def test_the_amplitude_of_a_swept_sine_is_its_own():
    run = swept()
    motion = run.motion(RATE, 0.0, None)
    inside = (motion.time > run.sweep.time_at(4.5)) & (motion.time < run.sweep.time_at(30.0))
    assert_allclose(amplitude(motion.acceleration[:, 0])[inside], 2.5, rtol=2e-3)  # the window's own edges reach that far


@pytest.mark.parametrize("times", [3.0, 20.0])
def test_a_load_that_swells_at_a_resonance_is_found_there_with_its_size(times):
    run = swept()
    (found,) = Amplitudes.of(swelling(run, 10.0, times), run, MASS * np.eye(6)).passed(run, modes(10.0))
    assert (found.mode, found.frequency, found.axis) == (1, 10.0, 0)
    assert found.time == pytest.approx(float(run.sweep.time_at(10.0)))
    # a swell of 0.3 Hz passed at 2.3 Hz/s lasts a tenth of a second, about a cycle: so far its envelope is known
    assert found.amplification == pytest.approx(times, rel=0.05)
    assert found.peak_frequency == pytest.approx(10.0, abs=0.1)


def test_two_resonances_far_apart_are_told_apart_and_what_lies_outside_or_does_not_show_is_not_listed():
    run = swept()
    response = swelling(run, 10.0, 2.0)
    found = Amplitudes.of(response, run, MASS * np.eye(6))
    assert [p.frequency for p in found.passed(run, modes(2.0, 10.0, 40.0))] == [10.0]
    assert found.passed(run, modes(10.0, share=1e-5)) == ()
    found = Amplitudes.of(swelling(run, 20.0, 9.0), run, MASS * np.eye(6))
    first, second = found.passed(run, modes(8.0, 20.0))
    assert first.amplification == pytest.approx(1.0, abs=0.05)
    assert second.amplification == pytest.approx(9.0, rel=0.05)


@pytest.mark.parametrize("rate", [2.0, 20.0, 200.0])
def test_from_frame_to_frame_the_drive_goes_on_by_whole_cycles_and_a_tenth(rate):
    sweep = Sweep(axis="x", start=8.0, stop=16.0, rate=rate)
    begin, end = (float(sweep.time_at(f)) for f in (9.0, 15.0))
    times = turntable.strobe(sweep, begin, end, peak=(begin + end) / 2)
    growth = rate * np.log(2) / 60
    steps = np.diff(sweep.frequency_at(times)) / growth  # cycles: the integral of a frequency that grows as exp(growth t)
    assert begin <= times[0] < times[-1] <= end
    assert len(times) == turntable.FRAMES
    assert_allclose(steps, steps[0], rtol=1e-4)  # of 20 000 points of the phase
    if steps[0] > 1:
        assert_allclose(steps % 1, 1 / turntable.STROBE, atol=1e-3)


def needle(model: Flexible, shapes: np.ndarray) -> tuple[Moved, ...]:
    """Instead of the CAD's surface, which takes seconds to be meshed: a band along the points of the beam model."""
    u, at = node_displacement(model.structure, shapes), model.structure.points
    side = np.array([0.05, 0.0, 0.0])
    body = DrawnBody(
        name="needle",
        material="steel",
        vertices=np.concatenate([at - side, at + side]),
        faces=np.array([[k, k + 1, k + len(at)] for k in range(len(at) - 1)]),
    )
    return ((body, np.zeros((0, 2), dtype=np.int64), np.concatenate([u, u])),)


@pytest.fixture(scope="module")
def drawn(renderer, tmp_path_factory) -> Iterator[Path]:
    """The folder that a plot and an animation were written into."""
    fast = ("--band", "10", "20", "--octaves-per-minute", "60", "--ring-down", "1 s", "--modes", "8", "--rate", "256")
    with pytest.MonkeyPatch.context() as patch:
        folder = tmp_path_factory.mktemp("drawn")
        patch.chdir(folder)
        patch.setattr(turntable, "FRAMES", 3)
        patch.setattr(turntable, "moved_bodies", needle)
        assert main.run(["excite", "fmd+clumod-1", "--cells", "--axis", "beta", *fast, "--plot", "--animate"]) == main.DONE
        burst = ("--pattern", "burst", "--duration", "2 s", "--ring-down", "1 s", "--rate", "256")
        assert main.run(["excite", "clumod-1", *burst, "--plot"]) == main.DONE
        yield folder / "out"


@pytest.mark.parametrize(("low", "high"), [(30.0, 500.0), (80.0, 900.0), (110.0, 130.0), (2.0, 190.0), (1.1, 700.0)])
def test_an_axis_of_few_decades_has_at_least_three_figures(low, high):
    figure = new_figure(4.0, 3.0)
    axes = figure.add_subplot()
    axes.plot([0.0, 1.0], [low, high])
    _few_decades(axes, np.array([low, high]))
    figure.canvas.draw()
    bottom, top = axes.get_ylim()
    ticks = axes.yaxis.get_major_ticks() + axes.yaxis.get_minor_ticks()
    shown = [tick.label1.get_text() for tick in ticks if bottom <= tick.get_loc() <= top and tick.label1.get_text()]
    assert len(shown) >= 3


@pytest.mark.parametrize("name", ["excite-fmd+clumod-1-linear-beta.png", "excite-clumod-1-linear-x.png"])
def test_the_picture_shows_curves_on_white_and_nothing_is_cut_off(name, drawn):
    from PIL import Image

    with Image.open(drawn / name) as picture:
        pixels = np.asarray(picture.convert("RGB")).astype(int)
    assert (np.abs(pixels - [0x24, 0x56, 0xC4]).sum(axis=2) < 60).sum() > 5000
    for edge in (pixels[:6], pixels[-6:], pixels[:, :6], pixels[:, -6:]):
        assert edge.min() > 240


def test_the_animation_moves_and_names_the_frequency(drawn):
    from PIL import Image

    with Image.open(drawn / "excite-fmd+clumod-1-linear-beta.gif") as picture:
        frames = []
        for k in range(picture.n_frames):
            picture.seek(k)
            frames.append(np.asarray(picture.convert("RGB")).astype(int))
    assert len(frames) == 3
    article = slice(84, 724)
    assert (np.abs(frames[1] - frames[0])[article].sum(axis=2) > 60).sum() > 500
    assert (np.abs(frames[1] - frames[0])[724:].sum(axis=2) > 60).sum() > 200


def test_the_article_is_drawn_as_exudyn_moves_it_relative_to_the_table_too():
    """Both routes keep coordinates of their own; drawn, the article bends by the same amount."""
    from validation.excite.question import ExciteOptions, drive
    from validation.excite.runs import ready

    found = []
    for route in ("linear", "exudyn"):
        driven = drive(
            axes=["beta"],
            every=False,
            pattern="sweep",
            band=(12.0, 20.0),
            octaves_per_minute=120.0,
            level=1.0,
            cross=0.03,
            seed=0,
            duration=None,
            ring_down="0.2 s",
        )
        options = dict.fromkeys(("preload", "friction", "cable", "damper"), ())
        fastened = attached(cells=True, flange=["rotation=1e-6"], **options)
        question = ExciteOptions(
            article="fmd+clumod-1",
            model=None,
            asked=FlexibleOptions(count=6),
            attached=fastened,
            drive=driven,
            route=route,
            rate=512.0,
        )
        made = ready(question, quiet=True)
        (one,) = made.done(keep_coordinates=True, quiet=True)
        found.append(turntable.relative_coordinates(made, one.motion, one.response))
    for part in (slice(0, 6), slice(6, None)):
        assert_allclose(found[1][:, part], found[0][:, part], atol=1e-2 * np.abs(found[0][:, part]).max())
