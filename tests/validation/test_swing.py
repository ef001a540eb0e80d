"""The whole chain: exudyn swings, a recorder samples, and the reduction of measured pendulums reads what it wrote."""

import json
import re
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.exudyn import rope_pendulum
from fem.exudyn.rope_pendulum import Watch
from geometry.errors import BadInput
from geometry.inertia import Inertia
from tools.pages import said_about
from validation.classical import pendulum as classical_pendulum
from validation.classical.files import read
from validation.classical.pendulum import from_signal
from validation.classical.swing import (
    DIED_AWAY,
    MOST_DAMPING,
    SMALL,
    Setup,
    Words,
    recorded,
    require_recordable,
    setup,
    simulated,
    suspended,
    write,
)
from validation.reference.reference import ArticleOptions
from validation.report.scenes import scene, setups

# the article of physics.md: three ropes of 2 m at s = 0.3 m
BODY = Inertia.from_cog(47.23, np.zeros(3), np.diag([5.0, 6.0, 2.289]))
METHOD = 8e-6
"""Of the period: what the method leaves at a thousand steps, with the rounding of nine digits in the record."""


def pendulum(radii: tuple[float, ...] = (0.3,), off: tuple[float, float] = (0.0, 0.0), **more: Any) -> Setup:
    recorder = {name: more.pop(name) for name in ("cycles", "rate", "noise", "seed") if name in more}
    suspension = suspended(radii, 0.1, off, **({"length": 2.0, "amplitude": SMALL} | more))
    given = {"article": "physics.md", "axis": "z", "along": "x", "inertia": BODY, "gravity": 9.81, "height": 0.1}
    return Setup(**given, radii=radii, off_centre=off, suspension=suspension, **({"cycles": 8.0} | recorder))


def test_ropes_of_300_g_lengthen_the_period_by_0_06_in_two_links_and_by_0_04_per_cent_in_many():
    shift = {links: 100 * recorded(pendulum(rope_mass=0.3, links=links)).shift for links in (2, 4, 8)}
    assert_allclose(shift[2], 0.062, atol=1e-3)
    uniform = (64 * shift[8] - 16 * shift[4]) / 48  # the error of lumps falls with the square of their number
    assert_allclose(uniform, 0.038, atol=1e-3)
    assert_allclose((shift[2] - shift[4]) / (shift[4] - shift[8]), 4, rtol=0.05)


def test_eq_5_is_exact_for_two_ropes_and_noise_comes_from_its_seed():
    for radii in ((0.3, 0.3), (0.3, 0.9)):
        assert_allclose(recorded(pendulum(radii)).shift, 0, atol=METHOD)
    one, same, other = (recorded(pendulum(amplitude=0.1, noise=1e-3, seed=seed, cycles=3)).signal for seed in (1, 1, 2))
    assert np.array_equal(one, same)
    assert not np.array_equal(one, other)


def test_a_dying_twist_is_corrected_by_the_root_mean_square_of_its_peaks():
    found = recorded(pendulum(amplitude=0.2, damping_ratio=0.005))
    plain, corrected = (found.plain / found.setup.reference - 1, found.corrected / found.setup.reference - 1)
    assert plain > 4e-3
    assert abs(corrected) < 0.01 * plain  # the fit weighs the early, large swings a little more than their mean square


def test_every_effect_alone_adds_up_to_all_of_them_as_far_as_they_are_small():
    setup = pendulum(amplitude=0.05, rope_mass=0.3, links=4, stiffness=1e6, off=(0.005, 0.0))
    found = simulated(setup)
    assert [s.name for s in found.shifts] == ["amplitude", "rope-mass", "rope-stretch", "off-centre"]
    assert_allclose(sum(s.period for s in found.shifts), found.record.shift, rtol=0.05, atol=4 * METHOD)


def test_what_is_written_is_read_and_reduced_to_what_was_told(tmp_path):
    found = recorded(pendulum((0.3, 0.5), amplitude=0.1, rope_mass=0.2, links=2, noise=1e-3, seed=3))
    path = write(tmp_path, found.setup, found.swing, found.signal, found.decay)
    again = classical_pendulum.reduce(read(str(path), ("pendulum",)))
    assert again.results["Izz"].nominal_value == found.corrected
    assert set(again.terms["Izz"]) == {"amplitude", "damping", "rope-mass"}
    # the tolerance of the fit holds the truth: 1 mrad of noise
    assert abs(found.period - recorded(pendulum((0.3, 0.5), amplitude=0.1, rope_mass=0.2, links=2)).period) < (
        4 * found.decay.period.std_dev
    )


def test_three_cycles_asked_for_are_three_cycles_recorded_however_the_body_pitches():
    steep = Inertia.from_cog(47.23, np.zeros(3), np.diag([20.1, 20.4, 2.289]))
    test = replace(pendulum((0.3, 0.9), amplitude=0.5, cycles=3.0), inertia=steep)
    found = recorded(test)
    assert found.decay.cycles > 3
    assert found.shift > 0.05  # no formula foresees the period: it would have been 2.9 cycles


@pytest.mark.parametrize("cycles", [3.0, 8.0, 20.0, 100.0])
def test_the_heaviest_damping_that_is_let_in_is_found_again_in_a_clean_record(cycles):
    zeta = min(MOST_DAMPING, np.sqrt(DIED_AWAY / cycles))
    require_recordable(pendulum(cycles=cycles, damping_ratio=0.999 * zeta))
    with pytest.raises(BadInput, match=r"damping_ratio.*Use"):
        require_recordable(pendulum(cycles=cycles, damping_ratio=1.01 * zeta))
    t = np.linspace(0, cycles + 0.15, int(50 * cycles)) * 2 * np.pi / np.sqrt(1 - zeta**2)
    y = np.exp(-zeta * t) * np.cos(np.sqrt(1 - zeta**2) * t)
    assert_allclose(from_signal(t, y, "clean").damping_ratio.nominal_value, zeta, rtol=1e-6)


SHORT = ("--cycles", "4", "--rate", "25")


def test_json_holds_what_the_page_does_in_units_that_keys_name(answer):
    found = answer("swing", "clumod-4", "--axis", "x", "--s1", "0.55 m", "--s2", "0.9 m", *SHORT)
    assert found["ropes"] == 2
    assert set(found["period_shift_percent"]) == {"amplitude", "all"}
    reference = found["moi_kgm2"]["reference"]
    assert_allclose(reference, 20.144, rtol=1e-3)  # about x; Table 1
    assert_allclose(100 * (found["moi_kgm2"]["eq5"] / reference - 1), found["moi_error_percent"]["eq5"], rtol=1e-9)
    assert abs(found["moi_error_percent"]["corrected"]) < 0.02
    assert found["settings"]["solver"] == "exudyn"
    assert found["files"] == []


def test_what_it_writes_goes_through_massline_pendulum(run, answer, monkeypatch):
    monkeypatch.setattr(setups, "draw_swing", lambda *_, **__: [])
    code, out, err = run("swing", "cuboid", "--radius", "0.1 m", "--out", "there", "--json", "--noise", "1 mrad", *SHORT)
    assert code == 0
    assert "massline pendulum there/pendulum.toml" in err
    told = json.loads(out)
    assert told["files"] == ["there/record.csv", "there/pendulum.toml"]
    reduced = answer("pendulum", "there/pendulum.toml")
    assert_allclose(reduced["rows"][0]["value"], told["moi_kgm2"]["corrected"], rtol=1e-12)
    assert "simulated by exudyn" in reduced["origin"]


@pytest.mark.parametrize(
    ("words", "said"),
    [
        (("--length", "1e9 m"), "--length: ropes of 1e+09 m are longer"),
        (("--links", "1000", "--rope-mass", "0.3 kg"), "--links: at most 20"),
        (("--cycles", "1e6"), "--cycles: at most 1000"),
        (("--cycles", "nan"), "--cycles: at least 3"),
        (("--rate", "1e9"), "--rate: 1e+09 Hz over 20 cycles"),
        (("--step", "1e-9 s"), "--step: "),
        (("--rope-mass", "1e-9 kg"), "--links: "),
        (("--damping", "50 %"), "--damping: a twist damped by 0.5 has"),
        (("--rope-mass", "1000 kg"), "--rope-mass: ropes of 1000 kg are heavier than the body"),
        (("--unequal", "-3 m"), "--unequal: ropes of 2 m whose feet are 0.52 m apart cannot be 3 m unequal"),
        (("--unequal", "1.5 m"), "--unequal: ropes of 2 m"),
        (("--unequal", "0.4 m"), "--unequal: rope 1 would have to push"),
        (("--noise", "-1 mrad"), "--noise: it must be finite and not negative"),
        (("--s1", "0.3 m", "--s2", "1.2 m", "--amplitude", "2 rad"), "cross or lie flat"),
        (("--seed", "-1"), "--seed: it must not be negative"),
        (("--rope-stiffness", "100 N"), "--rope-stiffness: a rope would stretch by"),
        (("--length", "-2 m"), "--length: it must be positive"),
        (("--length", "2 kg"), "--length: 'kg' is"),
        (("--off-centre", "-0.2 m"), "--off-centre: the CoG is not between the ropes"),
        (("--off-centre", "1 mm, 2 mm, 3 mm"), "--off-centre: one length or two"),
        (("--amplitude", "200 deg"), "--amplitude: ropes cannot swing"),
        (("--damping", "1.5"), "--damping: it must be from 0"),
        (("--rope-stiffness", "0 N"), "--rope-stiffness: it must be positive"),
        (("--rope-mass", "-1 kg"), "--rope-mass: it cannot be negative"),
        (("--links", "4"), "--links: ropes of 0 kg"),
        (("--cycles", "2"), "--cycles: at least 3"),
        (("--rate", "1"), "--rate: 1 Hz is"),
        (("--step", "1 s"), "--step: 1 s is too coarse"),
        (("--axis", "w"), "--axis: x, y or z"),
        (("--along", "z"), "--along: z is upright"),
        (("--ropes", "4"), "--ropes: 4 ropes do not go with no sizes"),
        (("--ropes", "3", "--s1", "0.3 m", "--s2", "0.3 m"), "--ropes: 3 ropes do not go with --s1 and --s2"),
        (("--s1", "0.3 m"), "--ropes: 2 ropes do not go with --s1"),
        (("--ropes", "2", "--radius", "0.3 m", "--height", "-10 mm"), "--height: on two ropes"),
        (("--gravity", "0 m/s^2"), "--gravity: it must be positive"),
        (("--material", "steel"), "--material"),
        (("--out", "/dev/null"), "--out: /dev/null cannot be written: Not a directory"),
        (("--out", "../nowhere/deep"), "--out: ../nowhere/deep cannot be written"),
    ],
)
def test_what_cannot_be_is_refused_by_the_option_that_asked_for_it(refused, words, said):
    assert said in refused("swing", "cuboid", *words)


@pytest.mark.parametrize("option", ["--plot", "--animate"])
def test_pictures_that_could_not_be_written_are_refused_before_anything_swings(refused, option):
    Path("out").write_text("not a folder")
    assert f"{option}: out is a file, and several are written into a folder" in refused("swing", "cuboid", option)


def test_a_record_in_which_noise_drowns_the_swing_is_refused_as_any_record_would_be(refused):
    err = refused("swing", "cuboid", "--radius", "0.1 m", "--amplitude", "1 mrad", "--noise", "1 mrad", *SHORT)
    assert "--noise: its record cannot be reduced: no decaying sinusoid" in err


@pytest.mark.parametrize(
    ("words", "unit"),
    [
        (("--damping", "50 %"), ""),
        (("--rope-mass", "1000 kg"), "kg"),
        (("--unequal", "-3 m"), "m"),
        (("--rope-stiffness", "100 N"), "N"),
        (("--length", "1e9 m"), "m"),
        (("--rate", "1e9"), ""),
        (("--step", "1e-9 s"), "s"),
        (("--cycles", "1e6"), ""),
        (("--links", "1000", "--rope-mass", "0.3 kg"), ""),
    ],
    ids=lambda given: given[0] if isinstance(given, tuple) else "",
)
def test_what_a_refusal_advises_passes_the_door(run, monkeypatch, words, unit):
    def passed(*_):
        raise KeyboardInterrupt

    monkeypatch.setattr(rope_pendulum._RopeBuilder, "build", passed)
    _, _, err = run("swing", "clumod-4", *words)
    advice = re.search(r"(?:[Uu]se an EA of|[Uu]se|[Rr]ecord(?: at)?|[Gg]ive(?: well below)?) (\d[\d.e+-]*)", err)
    assert advice is not None, err
    code, _, err = run("swing", "clumod-4", words[0], f"{float(advice[1]):g} {unit}".strip(), *words[2:])
    assert code == 130, err


def test_ctrl_c_leaves_no_file(run, monkeypatch):
    def interrupted(self, system, time):
        self.stopped = KeyboardInterrupt()
        return False

    monkeypatch.setattr(Watch, "__call__", interrupted)
    code, _, err = run("swing", "cuboid", "--out", "there")
    assert code == 130
    assert "interrupted" in err
    assert not Path("there").exists()


def test_the_picture_and_the_animation_show_the_pendulum_moving(run, renderer, monkeypatch):
    import numpy as np
    from PIL import Image

    monkeypatch.setattr(setups, "FRAMES_A_SECOND", 3)
    monkeypatch.setattr(scene, "SUPERSAMPLING", 1)  # a quarter of the pixels
    code, _, err = run("swing", "cuboid", "--radius", "0.1 m", "--amplitude", "30 deg", "--animate", "--out", "there", *SHORT)
    assert code == 0
    assert "wrote there/swing-cuboid-z.gif" in err
    with Image.open("there/swing-cuboid-z.gif") as moving:
        frames = []
        for k in range(moving.n_frames):
            moving.seek(k)
            frames.append(np.asarray(moving.convert("L"), dtype=float))
    assert len(frames) >= 4
    shown = [frame[84:644] for frame in frames]
    changed = [np.mean(np.abs(frame - shown[0]) > 20) for frame in shown[1:]]
    assert max(changed) > 2e-3  # the edges of the block move
    assert all(np.mean(frame < 200) > 0.01 for frame in shown)
    with Image.open("there/swing-cuboid-z.png") as still:
        assert still.size == (620, 854)
    assert said_about(Path("there/swing-cuboid-z.png")) == ""


def test_a_clean_record_raises_no_alarm_and_a_large_dying_swing_says_what_is_left(run):
    _, clean, _ = run("swing", "cuboid", "--radius", "0.1 m", *SHORT)
    assert "leaves over" not in clean
    _, dying, _ = run("swing", "cuboid", "--radius", "0.1 m", "--amplitude", "1 rad", "--damping", "3 %", *SHORT)
    assert "% of the swing" in dying
    assert "changes with the amplitude" in " ".join(dying.split())


def test_ropes_through_the_article_are_said_with_the_height_that_clears_it():
    def said(*, height):
        texts = {"length": "2 m", "amplitude": "0.1 rad", "height": height}
        recorder = {"off_centre": None, "links": None, "start": "twist", "cycles": 3.0, "rate": 25.0, "seed": 0}
        test = setup("clumod-1", Words(texts=texts, ropes=3, axis="z", along=None, **recorder), ArticleOptions())
        return setups.in_the_way(test, ArticleOptions())

    sentence = said(height="100 mm")
    assert "ropes may pass through it" in sentence
    clears = re.search(r'--height "(\d+ mm)"', sentence)
    assert said(height=clears[1]) == ""
    assert said(height=f"{int(clears[1][:-3]) - 20} mm") != ""
