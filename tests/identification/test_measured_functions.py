"""Dynamic mass and response functions go out with their intervals and come back, by our readers and by those of others."""

from pathlib import Path

import h5py
import numpy as np
import pytest
import pyuff
import scipy.io
from numpy.testing import assert_allclose

from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.frames import Array
from geometry.sensors import Point
from identification import test_file
from identification.files import files
from identification.files.files import Samples
from identification.response_functions import ResponseFunctions

LINES = np.linspace(4.0, 32.0, 57)
RANDOM = np.random.default_rng(5)
H = DynamicMass(frequency=LINES, matrix=RANDOM.normal(size=(57, 6, 6)) + 1j * RANDOM.normal(size=(57, 6, 6)))
SPREAD = RANDOM.uniform(0.1, 0.2, (57, 6, 6))


def read(path: Path) -> tuple[Array, dict[str, Samples]]:
    """Frequencies and functions by name; universal files by pyuff, since signals are all that a campaign takes from them."""
    if path.suffix not in (".unv", ".uff"):
        found = files.read(path)
        assert found.frequency is not None
        return found.frequency, dict(found.samples)
    sets = [one for one in pyuff.UFF(str(path)).read_sets() if one["type"] == 58]
    return sets[0]["x"], {one["id1"].strip(): one["data"] for one in sets}


@pytest.mark.parametrize("ending", [".csv", ".unv", ".uff", ".h5", ".mat"])
def test_a_dynamic_mass_comes_back_with_its_intervals_from_every_format(ending: str, tmp_path: Path) -> None:
    path = tmp_path / f"H{ending}"
    test_file.write(path, test_file.of_dynamic_mass(H, "test", SPREAD))
    frequency, samples = read(path)
    assert_allclose(frequency, LINES, rtol=1e-9)
    for name, row, column in (("H_x_x", 0, 0), ("H_gamma_y", 5, 1)):
        # an ASCII universal file has twelve digits
        assert_allclose(samples[name], H.matrix[:, row, column], rtol=1e-11)
        # a circular complex error of E|e|² = sd² has sd/√2 in each part
        half = np.real(samples[name + test_file.HALF])
        assert_allclose(half, 1.959964 / np.sqrt(2) * SPREAD[:, row, column], rtol=1e-6)


def test_lines_that_ascii_cannot_say_go_out_in_binary(tmp_path: Path) -> None:
    odd = DynamicMass(frequency=LINES + 1e-7 * np.sin(LINES), matrix=H.matrix)
    path = tmp_path / "H.unv"
    test_file.write(path, test_file.of_dynamic_mass(odd, "test"))
    assert_allclose(read(path)[0], odd.frequency, rtol=1e-12)


def frame() -> ResponseFunctions:
    drive, askew = Point(place="floor 1", direction=(0, -1, 0)), Point(place="roof", direction=(0.6, 0.8, 0))
    values = RANDOM.normal(size=(1, 57, 2)) + 1j * RANDOM.normal(size=(1, 57, 2))
    return ResponseFunctions(
        source="hammer.toml",
        title="hammer",
        article="frame",
        frequency=LINES,
        values=values,
        drives=(drive,),
        responses=(Point(place="floor 2", direction=(0, 0, 1), name="top-z"), askew),
        coherence=np.full((1, 57, 2), 0.8),
        averages=10,
        band=(4.0, 32.0),
    )


def test_other_programs_read_response_functions_as_what_they_are(tmp_path: Path) -> None:
    test = frame()
    for ending in (".unv", ".h5", ".mat"):
        test_file.write(tmp_path / f"r{ending}", test_file.of_responses(test))
    sets = pyuff.UFF(str(tmp_path / "r.unv")).read_sets()
    one = next(each for each in sets if each["type"] == 58 and each["id1"].strip() == "top-z_per_floor-1")
    assert (one["func_type"], one["rsp_dir"], one["ref_dir"]) == (4, 3, -2)
    assert one["rsp_node"] != one["ref_node"]
    assert_allclose(one["data"], test.values[0, :, 0], rtol=1e-11)
    with h5py.File(tmp_path / "r.h5") as file:
        names: list[str] = []
        file.visit(names.append)
        assert any("top-z_per_floor-1" in name for name in names)
    assert_allclose(scipy.io.loadmat(tmp_path / "r.mat")["roof_per_floor_1"].ravel(), test.values[0, :, 1], rtol=1e-15)


def test_the_interval_from_coherence_holds_the_truth_as_often_as_it_says(tmp_path: Path) -> None:
    """H1 of ten averages of noise through a known gain: 95 % of real parts within, to three deviations of the count."""
    truth, averages, lines = 2.0 - 1.0j, 40, 4000
    noise = RANDOM.normal(size=(2, averages, lines)) + 1j * RANDOM.normal(size=(2, averages, lines))
    force, answer = noise[0], truth * noise[0] + 1.2 * noise[1]
    cross, power = (answer * force.conj()).sum(axis=0), (np.abs(force) ** 2).sum(axis=0)
    coherence = np.abs(cross) ** 2 / power / (np.abs(answer) ** 2).sum(axis=0)
    test = ResponseFunctions(
        source="t",
        title="t",
        article="t",
        frequency=np.arange(1.0, lines + 1),
        values=(cross / power)[None, :, None],
        drives=(Point(place="a"),),
        responses=(Point(place="b"),),
        coherence=coherence[None, :, None],
        averages=averages,
        band=(1.0, 10.0),
    )
    samples = test_file.of_responses(test).samples
    for part in (np.real, np.imag):
        inside = np.mean(np.abs(part(samples["b_per_a"] - truth)) <= samples["b_per_a" + test_file.HALF])
        assert abs(inside - 0.95) < 3 * np.sqrt(0.05 * 0.95 / lines) + 0.006  # the width is of first order in 1/averages


def test_motions_name_the_36_functions() -> None:
    names = test_file.of_dynamic_mass(H, "t").samples
    assert list(names) == [f"H_{row}_{column}" for row in MOTIONS for column in MOTIONS]
