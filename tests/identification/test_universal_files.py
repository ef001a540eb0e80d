"""Universal files as other programs write them: each feature here is one of a file of another maker, written again in small."""

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from identification import test_file
from identification.files import uff_tests
from identification.modal_table import ModalTable
from identification.response_functions import ResponseFunctions

F = np.arange(0.0, 24.0, 2.0)
H = np.exp(0.3j * F) * (1 + F)
"""A function of frequency without resonances: what it is does not matter here."""


def dataset(number: int, *lines: str) -> str:
    return "".join(f"{line}\n" for line in ("    -1", f"{number:6d}", *lines, "    -1"))


def units(length: float = 1.0, force: float = 1.0) -> str:
    code = 1 if length == force == 1 else 9
    return dataset(164, f"{code:10d}{'SI':<20}{2:10d}", f"{length:25.16E}{force:25.16E}{1.0:25.16E}", f"{273.15:25.16E}")


def function(
    values: np.ndarray = H,
    *,
    kind: int = 4,
    response: tuple[int, int] = (1, 3),
    reference: tuple[int, int] = (2, 3),
    over: tuple[int, str] = (12, "NONE"),
    under: tuple[int, str] = (13, "NONE"),
    axis: str = "Hz",
    rows: Sequence[str] | None = None,
) -> str:
    """One dataset 58, complex of double precision unless `rows` say it all in single."""
    numbers = np.column_stack([values.real, values.imag]).ravel() if kind not in (6, 26) else values.real
    data = 5 if rows is not None else 6 if kind not in (6, 26) else 4
    text = ["".join(f"{one:20.11E}" for one in numbers[k : k + 4]) for k in range(0, len(numbers), 4)]
    ends = [f"{'NONE':<10}{node:10d}{along:4d}" for node, along in (response, reference)]
    characteristics = "{:10d}    0    0    0 {:<20} {:<20}".format
    return dataset(
        58,
        *["NONE"] * 5,
        f"{kind:5d}{0:10d}{0:5d}{0:10d} {ends[0]} {ends[1]}",
        f"{data:10d}{len(values):10d}{1:10d}{0.0:13.5E}{F[1]:13.5E}{0.0:13.5E}",
        characteristics(18, "Frequency", axis),
        characteristics(over[0], "NONE", over[1]),
        characteristics(under[0], "NONE", under[1]),
        characteristics(0, "NONE", "NONE"),
        *(text if rows is None else rows),
    )


def read(folder: Path, *parts: str, name: str = "test.unv", **stated: Any) -> ResponseFunctions:
    (folder / name).write_bytes("".join(parts).encode("latin-1"))
    found = test_file.read(folder / "t.toml", {"kind": "response-functions", "article": "a", "file": name, **stated})
    assert isinstance(found, ResponseFunctions)
    return found


def test_directions_are_those_of_the_systems_in_which_nodes_move(tmp_path: Path) -> None:
    """As Test.Lab writes them: a system (dataset 18) of every node. SYS1 has x along -x and z along -z, SYS2 is cylindrical about
    the global z through the origin; node 3 moves along the global axes."""
    systems = dataset(
        18,
        f"{1:10d}{0:10d}{0:10d}{8:10d}{1:10d}",
        "SYS1",
        " -2.40000e+00 -9.50000e-01  0.00000e+00 -3.40000e+00 -9.50000e-01 -8.74228e-08",
        " -3.40000e+00 -9.50000e-01 -1.00000e+00",
        f"{2:10d}{1:10d}{0:10d}{8:10d}{1:10d}",
        "SYS2",
        "  0.00000e+00  0.00000e+00  0.00000e+00  1.00000e+00  0.00000e+00  0.00000e+00",
        "  1.00000e+00  0.00000e+00  1.00000e+00",
    )
    nodes = dataset(
        15,
        "         1         0         1         8-2.40000e+00-9.50000e-01 0.00000e+00",
        "         2         2         2         8 2.00000e+00 9.00000e+01 5.00000e-01",
        "         3         0         0         8 1.00000e+00 0.00000e+00 0.00000e+00",
    )
    ends = [(1, 1), (1, 2), (1, -3), (2, 1), (2, 2), (3, 1)]
    found = read(tmp_path, systems, nodes, units(), *(function(response=one, reference=(3, 3)) for one in ends))
    wanted = [[-1, 0, 0], [0, 1, 0], [0, 0, 1], [0, 1, 0], [-1, 0, 0], [1, 0, 0]]
    assert_allclose([one.direction for one in found.responses], wanted, atol=1e-6)  # type: ignore[arg-type]
    positions = [one.position for one in found.responses]
    assert_allclose(positions[0], [-2.4, -0.95, 0])  # type: ignore[arg-type]
    assert_allclose(positions[3], [0, 2, 0.5], atol=1e-12)  # type: ignore[arg-type]
    assert len({one.name for one in found.responses}) == len(ends)


def test_a_left_handed_system_of_dataset_2420_keeps_its_axes(tmp_path: Path) -> None:
    rows = [f"{a:25.16E}{b:25.16E}{c:25.16E}" for a, b, c in [(0, 1, 0), (1, 0, 0), (0, 0, 1), (5, 0, 0)]]
    systems = dataset(2420, f"{1:10d}", "part", f"{7:10d}{0:10d}{8:10d}", "CS7", *rows)
    nodes = dataset(2411, f"{1:10d}{7:10d}{7:10d}{8:10d}", f"{1.5:25.16E}{0.0:25.16E}{0.0:25.16E}".replace("E", "D"))
    found = read(tmp_path, units(1000.0), systems, nodes, function(response=(1, -1)))
    assert_allclose(np.asarray(found.responses[0].direction), [0, -1, 0], atol=1e-12)
    assert_allclose(np.asarray(found.responses[0].position), [1.5e-3, 0, 0])  # those of 2411 are global ones


def test_a_system_that_is_none_is_refused(tmp_path: Path) -> None:
    rows = [f"{a:25.16E}{b:25.16E}{c:25.16E}" for a, b, c in [(0, 1, 0), (1, 0.3, 0), (0, 0, 1), (0, 0, 0)]]
    with pytest.raises(BadInput, match="right angles"):
        read(tmp_path, dataset(2420, f"{1:10d}", "part", f"{7:10d}{0:10d}{8:10d}", "CS7", *rows), function())


def test_a_sensor_that_was_turned_round_between_two_references_keeps_one_sign(tmp_path: Path) -> None:
    found = read(tmp_path, function(), function(-H, response=(1, -3), reference=(4, 3)))
    assert_allclose(found.values[0], found.values[1])
    assert len(found.responses) == 1


def test_what_is_in_a_file_besides_response_functions_is_passed_over_and_said(tmp_path: Path) -> None:
    """Auto spectra, ratios of accelerations and rotations stand beside response functions in what analysers export."""
    others = (function(kind=2), function(over=(12, "NONE"), under=(12, "NONE"), response=(9, 3)), function(response=(1, 5)))
    found = read(tmp_path, *others, function())
    assert len(found.drives) == len(found.responses) == 1
    assert sum("passed over" in one for one in found.warnings) == 3
    with pytest.raises(BadInput, match="holds no response function"):
        read(tmp_path, *others)


@pytest.mark.parametrize("kind", [6, 26])
def test_coherence_in_a_dataset_of_its_own_belongs_to_its_function(tmp_path: Path, kind: int) -> None:
    gamma = np.linspace(0.5, 1.0, len(F))
    found = read(tmp_path, function(), function(gamma, kind=kind, reference=(2, 3) if kind == 6 else (0, 0)))
    assert found.coherence is not None
    assert_allclose(found.coherence[0, :, 0], gamma)


def test_units_are_those_of_the_label_where_no_dataset_164_says_them(tmp_path: Path) -> None:
    assert_allclose(read(tmp_path, function(over=(12, "g"), under=(13, "N"))).values[0, :, 0], 9.80665 * H)
    found = read(tmp_path, function(over=(1, "(1/N)*(m/s\xb2)"), under=(0, "NONE")))  # latin-1, general data type
    assert found.quantity == "acceleration"
    assert_allclose(found.values[0, :, 0], H)
    found = read(tmp_path, function(over=(0, "mm/s/N"), under=(0, "NONE")))
    assert found.quantity == "velocity"
    assert_allclose(found.values[0, :, 0], 1e-3 * H)


def test_a_label_that_contradicts_dataset_164_is_refused_until_the_test_says_the_unit(tmp_path: Path) -> None:
    parts = units(), function(over=(12, "g"), under=(13, "N"))
    with pytest.raises(BadInput, match=r"unit = \"g/N\""):
        read(tmp_path, *parts)
    assert_allclose(read(tmp_path, *parts, unit="g/N").values[0, :, 0], 9.80665 * H)
    assert_allclose(read(tmp_path, *parts, unit="m/s^2/N").values[0, :, 0], H)
    with pytest.raises(BadInput, match="acceleration"):
        read(tmp_path, *parts, unit="mm/s/N")


def test_what_was_read_per_newton_is_said_to_be_assumed_where_the_file_does_not_say_it(tmp_path: Path) -> None:
    assert "acceleration is taken" in " ".join(read(tmp_path, function(over=(1, "NONE"), under=(1, "NONE"))).warnings)
    assert "acceleration is taken" not in " ".join(read(tmp_path, function()).warnings)


def test_an_axis_in_radians_per_second_is_one_in_hertz(tmp_path: Path) -> None:
    assert_allclose(read(tmp_path, function(axis="rad/s")).frequency, F / (2 * np.pi))
    with pytest.raises(BadInput, match="where frequency is read"):
        read(tmp_path, function(axis="rpm"))


def test_two_files_in_one_have_each_their_units(tmp_path: Path) -> None:
    found = read(tmp_path, units(), function(), units(1000.0), function(1e3 * H, response=(5, 3)))
    assert_allclose(found.values[0, :, 0], found.values[0, :, 1])


def test_force_over_response_acts_where_the_file_says_that_the_force_is(tmp_path: Path) -> None:
    found = read(tmp_path, function(1 / H, over=(13, "NONE"), under=(12, "NONE")), inverted=True)
    assert_allclose(found.values[0, :, 0], H)
    assert [one.place for one in (*found.drives, *found.responses)] == ["node 1", "node 2"]


def test_fields_that_end_in_a_blank_and_lines_that_are_padded_are_read(tmp_path: Path) -> None:
    """As an HBM export writes single precision, and catman its last line."""
    numbers = np.column_stack([H[:3].real, H[:3].imag]).ravel()
    behind = "".join(f" {one:.5e} " if one >= 0 else f"{one:.5e} " for one in numbers)
    assert_allclose(read(tmp_path, function(H[:3], rows=[behind])).values[0, :, 0], H[:3], rtol=1e-5)
    padded = "".join(f"{one:13.5E}" for one in numbers).ljust(80)
    assert_allclose(read(tmp_path, function(H[:3], rows=[padded])).values[0, :, 0], H[:3], rtol=1e-5)
    three = ["".join(f"{one:13.5E}" for one in numbers[k : k + 2]).replace("E", "D") for k in (0, 2, 4)]
    assert_allclose(read(tmp_path, function(H[:3], rows=three)).values[0, :, 0], H[:3], rtol=1e-5)


def test_a_file_without_nodes_takes_them_from_the_test_and_one_of_another_ending_is_known_by_its_first_line(
    tmp_path: Path,
) -> None:
    nowhere = {"response": (0, 0), "reference": (0, 0)}
    parts = function(**nowhere), function(2 * H, **nowhere)  # type: ignore[arg-type]
    found = read(tmp_path, *parts, name="test.unv.txt", drive="a:z", responses=["b:z", "c:-x"])
    assert [one.place for one in found.responses] == ["b", "c"]
    assert_allclose(found.values[0, :, 1], 2 * H)
    with pytest.raises(BadInput, match="has 2 functions"):
        read(tmp_path, *parts, drive="a:z", responses=["b:z"])
    with pytest.raises(BadInput, match="reference"):
        read(tmp_path, *parts)


def test_records_in_a_universal_file_are_records(tmp_path: Path) -> None:
    from identification.files import files
    from identification.files.files import Signals, StatedUnits

    generator = np.random.default_rng(2)
    force = generator.standard_normal(4096)
    millimetres = dict.fromkeys(["force", "a-z"], StatedUnits(length=1e-3, force=1.0, words="mm"))
    samples = {"force": force, "a-z": 1000 * force}
    files.write(tmp_path / "x.unv", Signals(source="x", samples=samples, sampling_rate=512.0, units=millimetres))
    stated = {"drive": "a:z", "responses": ["a:z"], "records": {"kind": "shaker", "block": 1.0}, "columns": {"a:z": "a-z"}}
    table = {"kind": "response-functions", "article": "a", "file": "x.unv", **stated}
    found = test_file.read(tmp_path / "t.toml", table)
    assert isinstance(found, ResponseFunctions)
    assert_allclose(found.values[0, 5:-5, 0], 1.0, rtol=1e-6)


def test_modes_of_dataset_2414_are_a_table_and_what_else_it_holds_is_passed_over(tmp_path: Path) -> None:
    def results(mode: int, *, complex_one: bool = False, result: int = 8) -> str:
        pole = 2 * np.pi * 10 * mode * (-0.01 + 1j)
        rows = [[1.0, 0.0, 0.5, 0, 0, 0], [0.0, 0.0, -1.0, 0, 0, 0]]
        width, data = (3, 5) if complex_one else (6, 2)
        kinds = f"{1:10d}{3 if complex_one else 2:10d}{3:10d}{result:10d}{data:10d}{width:10d}"
        real = [0.0, 0.0 if complex_one else 10.0 * mode, 0.0, 1.0, 0.0, 0.0 if complex_one else 0.02]
        poles = [pole.real, pole.imag, 0.0, 0.0, 0.0, 0.0]
        numbers = ["".join(f"{one:13.5E}" for one in row) for row in (real, poles)]
        shape = [line for k, row in enumerate(rows) for line in (f"{k + 1:10d}", "".join(f"{one:13.5E}" for one in row))]
        ids = f"{1:10d}" * 8
        return dataset(2414, f"{mode:10d}", "B.C. 1", f"{1:10d}", *["NONE"] * 5, kinds, ids, f"{1:10d}" * 2, *numbers, *shape)

    for complex_one in (False, True):
        parts = [results(k, complex_one=complex_one) for k in (1, 2)] + [results(3, result=2)]
        (tmp_path / "m.unv").write_text("".join(parts))
        found = test_file.read(tmp_path / "t.toml", {"kind": "modal-table", "article": "a", "file": "m.unv"})
        assert isinstance(found, ModalTable)
        assert_allclose(found.frequency, [10, 20], rtol=1e-4)
        assert found.damping_ratio is not None
        assert_allclose(found.damping_ratio, 0.01, rtol=1e-3)  # half of the structural one where no viscous one is stated
        assert len(found.sensors) == 3


def test_decibels_and_phase_are_no_real_and_imaginary_part(tmp_path: Path) -> None:
    """Pairs of 20 log10 and degrees had been read as complex numbers, and compared: 88.5 % off, 645 sigma."""
    with pytest.raises(BadInput, match=r"`dataset 1`: is labelled in dB.* Export real and imaginary part"):
        read(tmp_path, function(over=(12, "dB")))


def test_a_function_that_is_twice_in_one_file_is_not_in_that_file_as_well(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match="is there twice"):
        read(tmp_path, function(), function())


def test_a_node_without_coordinates_of_its_own_type_is_refused(tmp_path: Path) -> None:
    (tmp_path / "n.unv").write_text(dataset(15, "         1         0         0         8  1.0  2.0"))
    with pytest.raises(BadInput, match="coordinates"):
        uff_tests.read(tmp_path / "n.unv")


def test_lines_in_which_all_functions_are_zero_are_no_measurement(tmp_path: Path) -> None:
    padded = np.where((F > 4) & (F < 20), H, 0)
    found = read(tmp_path, function(padded), function(padded, response=(3, 3)))
    assert_allclose(found.frequency[[0, -1]], [6, 18])
    assert found.band == (6, 18)
    assert "where all functions are 0" in " ".join(found.warnings)
    assert len(read(tmp_path, function(np.where(F > 0, H, 0))).frequency) == len(F)  # at 0 Hz an accelerance is 0


NOWHERE: dict[str, Any] = {"response": (0, 0), "reference": (0, 0)}


def test_coherences_without_nodes_are_those_of_functions_in_their_order(tmp_path: Path) -> None:
    first, second = np.linspace(0.5, 1.0, len(F)), np.linspace(0.9, 0.2, len(F))
    parts = [function(**NOWHERE), function(first, kind=6, **NOWHERE), function(2 * H, **NOWHERE)]
    found = read(tmp_path, *parts, function(second, kind=6, **NOWHERE), drive="a:z", responses=["b:z", "c:z"])
    assert found.coherence is not None
    assert_allclose(found.coherence[0].T, [first, second])
    with pytest.raises(BadInput, match="1 coherences and 2 functions"):
        read(tmp_path, *parts, drive="a:z", responses=["b:z", "c:z"])
    twice = read(tmp_path, function(), function(first, kind=6), function(second, kind=6))
    assert twice.coherence is None
    assert "several coherences" in " ".join(twice.warnings)


@pytest.mark.parametrize("other", [F[:-2], 2 * F])
def test_coherence_at_other_lines_than_its_function_is_refused(tmp_path: Path, other: np.ndarray) -> None:
    gamma = function(np.full(len(other), 0.9), kind=6).replace(f"{F[1]:13.5E}", f"{other[1]:13.5E}")
    with pytest.raises(BadInput, match="other lines than its function"):
        read(tmp_path, function(), gamma)


@pytest.mark.parametrize("parts", [(units(), function()), (function(over=(12, "m/s^2"), under=(13, "N")),)])
def test_a_unit_that_contradicts_what_the_file_says_is_refused(tmp_path: Path, parts: tuple[str, ...]) -> None:
    assert_allclose(read(tmp_path, *parts, unit="m/s^2/N").values[0, :, 0], H)
    with pytest.raises(BadInput, match=r"0\.001 in SI, and the file says 1"):
        read(tmp_path, *parts, unit="mm/s^2/N")
    assert_allclose(read(tmp_path, function(), unit="mm/s^2/N").values[0, :, 0], 1e-3 * H)  # where it says nothing


def turned_system(number: int, kind: int, reference: int, name: str = "CS") -> str:
    """A system 1 m along x of its reference, its x along the y of that, as lines of dataset 18."""
    points = [f"{1.0:13.5E}{0.0:13.5E}{0.0:13.5E}{1.0:13.5E}{1.0:13.5E}{0.0:13.5E}", f"{1.0:13.5E}{0.0:13.5E}{1.0:13.5E}"]
    return "\n".join([f"{number:10d}{kind:10d}{reference:10d}{8:10d}{1:10d}", name, *points])


def in_system(number: int, at: str = "1.0  0.0  0.0") -> str:
    return dataset(15, f"{1:10d}{number:10d}{number:10d}{8:10d} {at}")


def test_a_system_that_is_stated_in_another_is_read_in_it(tmp_path: Path) -> None:
    chained = dataset(18, turned_system(1, 0, 0, ""), turned_system(2, 0, 1, ""), "", "")  # names may be blank
    found = read(tmp_path, units(), chained, in_system(2), function(response=(1, 1)))
    assert_allclose(np.asarray(found.responses[0].direction), [-1, 0, 0], atol=1e-6)
    assert_allclose(np.asarray(found.responses[0].position), [0, 1, 0], atol=1e-6)
    for refused in ((turned_system(2, 0, 1), turned_system(1, 0, 0)), (turned_system(1, 1, 0), turned_system(2, 0, 1))):
        with pytest.raises(BadInput, match="stated in system 1"):
            read(tmp_path, dataset(18, *refused), function())


def test_a_spherical_system_is_refused_where_a_node_uses_it_only(tmp_path: Path) -> None:
    spherical = dataset(18, turned_system(1, 2, 0))
    assert_allclose(np.asarray(read(tmp_path, spherical, in_system(0), function()).responses[0].direction), [0, 0, 1])
    with pytest.raises(BadInput, match="node 1 is in system 1, of type 2"):
        read(tmp_path, spherical, in_system(1), function())


def test_blank_systems_are_the_global_one_and_blank_lines_behind_systems_are_none(tmp_path: Path) -> None:
    rows = [f"{a:25.16E}{b:25.16E}{c:25.16E}" for a, b, c in [(0, 1, 0), (1, 0, 0), (0, 0, 1), (0, 0, 0)]]
    systems = dataset(2420, f"{1:10d}", "part", f"{7:10d}{0:10d}{8:10d}", "", *rows, "", "")
    nodes = dataset(15, f"{1:10d}{'':30} 1.0  2.0  3.0")
    found = read(tmp_path, units(), systems, nodes, function(response=(1, 1)))
    assert_allclose(np.asarray(found.responses[0].position), [1, 2, 3])
    assert_allclose(np.asarray(found.responses[0].direction), [1, 0, 0])


def test_a_node_that_comes_again_has_the_axes_it_then_has(tmp_path: Path) -> None:
    own = dataset(2411, f"{1:10d}{0:10d}{1:10d}{8:10d}", f"{1.0:25.16E}{0.0:25.16E}{0.0:25.16E}")
    for parts, wanted in (((own,), [0, 1, 0]), ((own, in_system(0)), [1, 0, 0])):
        found = read(tmp_path, dataset(18, turned_system(1, 0, 0)), *parts, function(response=(1, 1)))
        assert_allclose(np.asarray(found.responses[0].direction), wanted, atol=1e-6)


INVERTED: dict[str, Any] = {"over": (13, "NONE"), "under": (12, "NONE")}


@pytest.mark.filterwarnings("error")
def test_force_over_response_that_is_zero_is_left_out_at_the_ends_and_refused_between(tmp_path: Path) -> None:
    padded = np.where((F > 4) & (F < 20), 1 / H, 0)
    found = read(tmp_path, function(padded, **INVERTED), function(1 / H, response=(3, 3), **INVERTED), inverted=True)
    assert_allclose(found.frequency, F[3:10])
    assert_allclose(found.values[:, :, 0], [H[3:10]] * 2)
    assert "force over response is 0" in " ".join(found.warnings)
    for zeros in (F == 8, F >= 0):
        with pytest.raises(BadInput, match="Hz, where one over it is needed"):
            read(tmp_path, function(np.where(zeros, 0, 1 / H), **INVERTED), inverted=True)


def test_inverted_decides_only_where_the_file_says_nothing(tmp_path: Path) -> None:
    found = read(tmp_path, units(1000.0), function(1 / H, over=(0, "NONE"), under=(0, "NONE")), inverted=True)
    assert_allclose(found.values[0, :, 0], 1e-3 * H)
    assert [one.place for one in (*found.drives, *found.responses)] == ["node 1", "node 2"]
    for parts in (function(), function(over=(0, "m/s^2/N"), under=(0, "NONE"))):
        with pytest.raises(BadInput, match="Take inverted = true out"):
            read(tmp_path, parts, inverted=True)
    with pytest.raises(BadInput, match="Write inverted = true"):
        read(tmp_path, function(over=(0, "N"), under=(0, "m/s^2")))


def test_the_axes_that_test_lab_writes_are_columns(tmp_path: Path) -> None:
    """The same shapes exported along systems of the nodes and along the global one say so; read as rows they were mirrored."""
    c, s = np.cos(0.4), np.sin(0.4)
    rows = [f"{a:25.16e}{b:25.16e}{z:25.16e}" for a, b, z in [(c, 0, s), (0, 1, 0), (-s, 0, c), (0, 0, 0)]]
    systems = dataset(2420, f"{1:10d}", "None", f"{1:10d}{0:10d}{8:10d}", "CS1", *rows)
    nodes = dataset(
        2411, f"{1:10d}{0:10d}{1:10d}{8:10d}", "   1.500000000000000e+000   2.000000000000000e-002   0.000000000000000e+000"
    )
    for writer, along in (("LMS Test.Lab Rev 15A", s), ("Simcenter Testlab Rev 21B", s), ("another program", -s)):
        header = dataset(151, "job", "NONE", writer, "01-Nov-19 16:49:57", "01-Nov-19 16:49:57", writer, "18-Nov-19 10:30:11 ")
        found = read(tmp_path, header, units(), systems, nodes, function(response=(1, 3)))
        assert_allclose(np.asarray(found.responses[0].direction), [along, 0, c], atol=1e-12)
        assert ("read as columns" in " ".join(found.warnings)) == (along > 0)


@pytest.mark.parametrize(
    ("over", "under", "size"),
    [
        *[("G", "lbf", 9.80665 / 4.4482216), ("[m/s2]", "[N]", 1), ("m/sec2", "kN", 1e-3), ("gn", "N", 9.80665)],
        *[("\xb5m/s^2", "N", 1e-6), ("g", "", 9.80665), ("NONE", "lbf", 1 / 4.4482216)],
    ],
)
def test_labels_as_analysers_print_them_are_units(tmp_path: Path, over: str, under: str, size: float) -> None:
    """They had been passed over, and the numbers taken for SI: 9.81 and 4.45 times off, and a micrometre a million times."""
    assert_allclose(read(tmp_path, function(over=(12, over), under=(13, under))).values[0, :, 0], size * H, rtol=1e-7)
    upside = function(1 / H, over=(13, under), under=(12, over))
    assert_allclose(read(tmp_path, upside, inverted=True).values[0, :, 0], size * H, rtol=1e-7)


def test_a_label_that_is_no_unit_is_refused_until_the_test_says_the_unit(tmp_path: Path) -> None:
    parts = function(over=(12, "EU"), under=(13, "V"))
    with pytest.raises(BadInput, match=r"labels its numbers 'EU' over 'V'.* unit = \"g/N\""):
        read(tmp_path, parts)
    assert_allclose(read(tmp_path, parts, unit="g/N").values[0, :, 0], 9.80665 * H)
    assert_allclose(read(tmp_path, units(), parts).values[0, :, 0], H)  # dataset 164 says it


def test_a_dataset_164_that_says_si_and_the_factors_of_feet_is_refused(tmp_path: Path) -> None:
    """As scripts copy them from an example; everything had been taken for feet."""
    with pytest.raises(BadInput, match=r"`dataset 164`: says code 1, which is SI, and has the factors 3\.28084 and 0\.224809"):
        read(tmp_path, units(3.28083989501312334, 0.224808943).replace(f"{9:10d}", f"{1:10d}"), function())


def test_numbers_in_fields_of_one_width_are_read_whatever_the_width(tmp_path: Path) -> None:
    """Loggers write the abscissa of double precision as wide as the ordinate."""
    rows = ["".join(f"{one:20.12E}" for one in row) for row in np.column_stack([F, H.real, H.imag])]
    uneven = function(rows=rows).replace(f"{5:10d}{len(F):10d}{1:10d}", f"{6:10d}{len(F):10d}{0:10d}")
    assert_allclose(read(tmp_path, uneven).values[0, :, 0], H)
    numbers = np.column_stack([H.real, H.imag]).ravel()
    rows = ["".join(f"{one:16.8E}" for one in numbers[k : k + 4]) for k in range(0, len(numbers), 4)]
    assert_allclose(read(tmp_path, function(rows=rows)).values[0, :, 0], H, rtol=1e-7)
    for k in (0, 2):
        cut = [*rows[:k], rows[k].replace("E", "", 1), *rows[k + 1 :]]
        with pytest.raises(BadInput, match="characters where fields end"):
            read(tmp_path, function(rows=cut))


def test_an_axis_with_exponents_of_fortran_and_a_reference_left_blank(tmp_path: Path) -> None:
    step = f"{F[1]:13.5E}"
    assert_allclose(read(tmp_path, function().replace(step, step.replace("E", "D"))).frequency, F)
    with pytest.raises(BadInput, match="names no reference node"):
        read(tmp_path, function().replace(f" {'NONE':<10}{2:10d}{3:4d}", ""))


KINDS = {"complex": (3, 8, 5, 3), "normal": (2, 8, 2, 3), "strain": (2, 3, 2, 3), "real pole": (3, 8, 2, 3)}


def mode(kind: str, frequency: float, damping: float = 0.01) -> str:
    analysis, result, data, width = KINDS[kind]
    pole = 2 * np.pi * frequency * (-damping + 1j)
    numbers = {"complex": [pole.real, pole.imag, 0, 1, 0, 0], "real pole": [frequency, 0, 0, 0]}.get(
        kind, [frequency, 1, damping, 0]
    )
    shape = [[0, 0, 0, 0, 0, 1.5], [0, 0, 0, 0, 0, -frequency]] if data == 5 else [[0, 0, 1.5], [0, 0, -frequency]]
    lines = [line for k, row in enumerate(shape) for line in (f"{k + 1:10d}", "".join(f"{one:13.5e}" for one in row))]
    kinds = f"{1:10d}{analysis:10d}{2:10d}{result:10d}{data:10d}{width:10d}"
    return dataset(55, *["NONE"] * 5, kinds, f"{2:10d}{4:10d}{1:10d}{1:10d}", "".join(f"{one:13.5e}" for one in numbers), *lines)


def modes(folder: Path, *parts: str) -> ModalTable:
    (folder / "m.unv").write_text("".join(parts))
    found = test_file.read(folder / "t.toml", {"kind": "modal-table", "article": "a", "file": "m.unv"})
    assert isinstance(found, ModalTable)
    return found


def test_modes_beside_indicator_functions_and_modes_of_strain_are_read(tmp_path: Path) -> None:
    """A file with modes and functions of which none is a response function was refused; modes of strain were shapes of motion."""
    found = modes(tmp_path, function(kind=18), mode("strain", 5), mode("complex", 10), mode("complex", 20))
    assert_allclose(found.frequency, [10, 20], rtol=1e-4)
    assert "of function type 18" in " ".join(found.warnings)
    with pytest.raises(BadInput, match="no response function"):
        read(tmp_path, function(kind=18), mode("normal", 10))
    with pytest.raises(BadInput, match="no dataset 55 or 2414 of motions"):
        modes(tmp_path, mode("strain", 5))


def test_a_complex_mode_without_an_imaginary_part_and_one_at_0_hz_are_refused_by_what_they_are(tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"damping ratio -1, .*; both parts of the eigenvalue of a complex mode"):
        modes(tmp_path, mode("real pole", 97.0))
    with pytest.raises(BadInput, match=r"0 Hz.* without those of the rigid body"):
        modes(tmp_path, mode("normal", 0.0))


def test_damping_of_all_modes_is_left_out_with_a_word_where_one_has_none(tmp_path: Path) -> None:
    found = modes(tmp_path, mode("normal", 10.0), mode("normal", 20.0, 0.0))
    assert found.damping_ratio is None
    assert "mode 2 has no damping above zero" in " ".join(found.warnings)


NOISE = np.random.default_rng(3).standard_normal(2048)


def record(
    name: str, number: int, unit: str, *, entity: str = "NONE", node: str = "0   0", axis: str = "s", kind: int = 1
) -> str:
    rows = ["".join(f"{one:13.5E}" for one in NOISE[k : k + 6]) for k in range(0, len(NOISE), 6)]
    characteristics = "{:10d}    0    0    0 {:<20} {:<20}".format
    step = 1 / 512 if axis == "s" else 1000 / 512
    return dataset(
        58,
        name,
        *["NONE"] * 4,
        f"{kind:5d}{0:10d}{0:5d}{0:10d} {entity:<10}{node:>14} {'NONE':<10}{0:10d}{0:4d}",
        f"{2:10d}{len(NOISE):10d}{1:10d}{0.0:13.5E}{step:13.5E}{0.0:13.5E}",
        *(
            characteristics(*of)
            for of in (
                (17, "time", axis),
                (number, "force" if number == 13 else "answer", unit),
                (0, "NONE", "NONE"),
                (0, "NONE", "NONE"),
            )
        ),
        *rows,
    )


def shaken(folder: Path, *parts: str, drive: str = "a:z", **stated: Any) -> ResponseFunctions:
    return read(folder, *parts, drive=drive, responses=[drive], records={"kind": "shaker", "block": 1.0}, **stated)


def test_records_are_in_the_units_of_their_labels(tmp_path: Path) -> None:
    """Labels were not read: a sensor in g was one in m/s^2, not said."""
    found = shaken(tmp_path, record("force", 13, "lbf"), record("a:z", 12, "g"))
    assert_allclose(found.values[0, 5:-5, 0], 9.80665 / 4.4482216, rtol=1e-6)
    found = shaken(tmp_path, record("force", 13, "N"), record("a:z", 11, "mm/s"))
    assert found.quantity == "velocity"
    assert_allclose(found.values[0, 5:-5, 0], 1e-3, rtol=1e-6)
    raw = record("force", 13, "V"), record("a:z", 12, "V")
    with pytest.raises(BadInput, match=r"the record of a:z labels its numbers 'V' over 'V', which is no unit known here"):
        shaken(tmp_path, *raw)
    assert_allclose(shaken(tmp_path, *raw, unit="g/N").values[0, 5:-5, 0], 9.80665, rtol=1e-6)
    with pytest.raises(BadInput, match=r"the record of a:z labels its numbers as 9\.80665 m/s\^2/N, and dataset 164 says 1"):
        shaken(tmp_path, units(), record("force", 13, "N"), record("a:z", 12, "g"))


def test_records_whose_first_id_lines_are_alike_are_told_by_entity_or_node(tmp_path: Path) -> None:
    columns = {"force": "Hammer", "a:z": "Acc"}
    named = record("Throughput", 13, "N", entity="Hammer"), record("Throughput", 12, "m/s^2", entity="Acc")
    assert_allclose(shaken(tmp_path, *named, columns=columns).values[0, 5:-5, 0], 1, rtol=1e-6)
    placed = record("NONE", 13, "N", node="3   3"), record("NONE", 12, "m/s^2", node="3   3")
    found = shaken(tmp_path, *placed, drive="node 3:z", columns={"force": "3 3 force", "node 3:z": "3 3 answer"})
    assert_allclose(found.values[0, 5:-5, 0], 1, rtol=1e-6)
    with pytest.raises(BadInput, match="neither entity nor node tells the functions apart"):
        shaken(tmp_path, record("NONE", 12, "g"), record("NONE", 12, "g"))


def test_records_in_milliseconds_and_those_of_a_general_type_are_records(tmp_path: Path) -> None:
    for about in ({"axis": "ms"}, {"kind": 0}):
        found = shaken(tmp_path, record("force", 13, "N", **about), record("a:z", 12, "m/s^2", **about))  # type: ignore[arg-type]
        assert_allclose(found.frequency[-1], 256)


def test_a_file_that_names_responses_alone_takes_the_drive_of_the_test(tmp_path: Path) -> None:
    """As vibrometers and hammers leave it; such a file was refused whatever the test said."""
    parts = function(reference=(0, 0)), function(2 * H, response=(5, 3), reference=(0, 0))
    found = read(tmp_path, *parts, drive="tip:-z")
    assert [one.name for one in (*found.drives, *found.responses)] == ["tip-z", "node-1-z", "node-5-z"]
    assert_allclose(found.values[0, :, 1], 2 * H)
    with pytest.raises(BadInput, match=r"names no reference node.* Write drive = \"tip:z\""):
        read(tmp_path, *parts)
    upside = function(1 / H, over=(13, "NONE"), under=(12, "NONE"), reference=(0, 0))
    with pytest.raises(BadInput, match="names no reference node"):  # there it is the response that has no place
        read(tmp_path, upside, drive="tip:z", inverted=True)
