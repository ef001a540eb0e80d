"""What is wrong with a user's model is said with its file, its field, what was found and what to do; every check can fail."""

import pickle
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from fem.user_model import reading
from geometry.errors import BadInput

Arrays = dict[str, np.ndarray]


def refused(path: Path, field: str, *words: str) -> None:
    """Reading `path` is refused at `field` with all the `words`, in one sentence that says what to do."""
    with pytest.raises(BadInput) as caught:
        reading.read(path)
    error, text = caught.value, str(caught.value)
    assert str(path.parent) in error.source
    assert error.field == field, text
    assert error.remedy
    for word in words:
        assert word in text


def bump(matrix: str, i: int, j: int, factor: float) -> Callable[[Arrays], None]:
    def spoil(arrays: Arrays) -> None:
        arrays[matrix][i, j] += factor * np.abs(arrays[matrix][i]).max()

    return spoil


def put(name: str, make: Callable[[np.ndarray], Any]) -> Callable[[Arrays], None]:
    def spoil(arrays: Arrays) -> None:
        arrays[name] = make(arrays[name])

    return spoil


def entry(name: str, index: tuple[int, ...], value: float) -> Callable[[Arrays], None]:
    def spoil(arrays: Arrays) -> None:
        arrays[name][index] = value

    return spoil


def loose(arrays: Arrays) -> None:
    """The last node is cut off: a part that hangs in the air."""
    arrays["stiffness"][54:] = arrays["stiffness"][:, 54:] = 0
    arrays["stiffness"][np.arange(54, 60), np.arange(54, 60)] = 1e-9


def hinge(arrays: Arrays) -> None:
    """Nodes 109 and 110 may turn about x together for nothing: the stiffness of that motion is taken out, and no other."""
    v = np.zeros(60)
    v[[51, 57]] = 1.0
    Kv = arrays["stiffness"] @ v
    arrays["stiffness"] -= np.outer(Kv, Kv) / (v @ Kv)


def without(name: str, instead: str | None = None) -> Callable[[Arrays], None]:
    def spoil(arrays: Arrays) -> None:
        array = arrays.pop(name)
        if instead:
            arrays[instead] = array

    return spoil


def more_mass_at_the_base(arrays: Arrays) -> None:
    arrays["mass"][:3, :3] -= 2 * np.diag(np.full(3, arrays["mass"][6, 6]))


SPOILT: dict[str, tuple[Callable[[Arrays], None], str, tuple[str, ...]]] = {
    "unsymmetric K": (bump("stiffness", 13, 7, 0.01), "stiffness", ("not symmetric", "row 8, column 14", "node 103, y")),
    "unsymmetric M": (bump("mass", 30, 24, 0.01), "mass", ("not symmetric", "row 25, column 31")),
    "negative K": (put("stiffness", lambda A: -1.0 * A), "stiffness", ("not positive definite", "negative")),
    "indefinite K": (put("stiffness", lambda K: K - 3e3 * np.diag(np.abs(K).max(axis=1)) / 3e3), "stiffness", ("definite",)),
    "indefinite M": (entry("mass", (30, 30), -1e-6), "mass", ("not positive definite", "node 106, x")),
    "M without mass": (entry("mass", (30, 30), 0.0), "mass", ("no mass of its own", "node 106, x")),
    "mass of base": (more_mass_at_the_base, "mass", ("indefinite", "interface itself carries")),
    "loose part": (loose, "stiffness", ()),
    "mechanism": (hinge, "stiffness", ("cost no energy", "alpha")),
    "grounded": (bump("stiffness", 59, 59, 0.5), "stiffness", ("K @ rigid must be 0", "Hz")),
    "coordinates in metres": (put("coordinates", lambda A: 1e-3 * A), "stiffness", ("K @ rigid", "unit")),
    "coordinates in another order": (put("coordinates", lambda x: x[::-1]), "stiffness", ("K @ rigid", "coordinates")),
    "x and y exchanged": (put("coordinates", lambda x: x[:, [1, 0, 2]]), "stiffness", ("K @ rigid",)),
    "M too small": (put("mass", lambda M: M[:54, :54]), "mass", ("54 x 54", "60 x 60")),
    "M not square": (put("mass", lambda M: M[:54]), "mass", ("square", "54 x 60")),
    "short map": (put("dof", lambda d: d[:54]), "dof", ("54", "60")),
    "doubled dof": (entry("dof", (7, 1), 1), "dof", ("node 102, component 1 2 times",)),
    "component 7": (entry("dof", (7, 1), 7), "dof", ("row 8", "component 7")),
    "unknown node": (entry("dof", (59, 0), 999), "dof", ("999", "no coordinates")),
    "broken node": (put("dof", lambda d: d + 0.5), "dof", ("whole numbers",)),
    "doubled node": (entry("nodes", (9,), 101), "nodes", ("101 2 times",)),
    "few coordinates": (put("coordinates", lambda x: x[:-1]), "coordinates", ("9 points for 10 nodes",)),
    "NaN": (entry("stiffness", (3, 4), np.nan), "stiffness", ("1 value(s)", "[3, 4]")),
    "infinity": (entry("mass", (3, 4), np.inf), "mass", ("not finite",)),
    "complex": (put("stiffness", lambda K: K * (1 + 0.02j)), "stiffness", ("complex", "structural")),
    "huge": (entry("stiffness", (3, 3), 1e200), "stiffness", ("1e+200",)),
    "texts": (put("mass", lambda M: M.astype(str)), "mass", ("numbers",)),
    "no mass": (without("mass"), "mass", ("is missing",)),
    "another name": (without("stiffness", "stifness"), "stiffness", ("is missing", "'stifness'")),
    "nobody reads it": (lambda a: a.update(massess=np.eye(2)), "massess", ("unknown",)),
    "not rigid": (bump("mass", 31, 31, 0.5), "mass", ("not the mass matrix of a rigid body",)),
    "too much structural damping": (lambda a: a.update(structural=9 * a["stiffness"]), "structural", ("loss factor",)),
    "dampers to ground": (lambda a: a.update(viscous=1e-6 * np.diag(np.diag(a["stiffness"]))), "viscous", ("@ rigid",)),
    "lossy ground": (lambda a: a.update(structural=0.01 * np.diag(np.diag(a["stiffness"]))), "structural", ("@ rigid",)),
    "viscous too small": (lambda a: a.update(viscous=np.eye(4)), "viscous", ("4 x 4", "60 x 60")),
}


@pytest.mark.parametrize("ending", [".h5", ".npz"])
@pytest.mark.parametrize("case", SPOILT)
def test_spoilt_matrices_are_refused(case: str, ending: str, arrays: Arrays, saved: Callable[..., Path]) -> None:
    spoil, field, words = SPOILT[case]
    spoil(arrays)
    if case == "texts":
        ending = ".npz"
    refused(saved(arrays, ending=ending), field, *words)


WRITTEN: dict[str, tuple[str, str, str, tuple[str, ...]]] = {
    "unknown key": ("name =", "nam =", "fe_model.nam", ("unknown", "name")),
    "no units": ('units = "mm-t-N-s"\n', "", "fe_model.units", ("missing",)),
    "unknown unit": ("mm-t-N-s", "mm-t-Nn-s", "fe_model.units", ("'Nn'",)),
    "inconsistent units": ("mm-t-N-s", "mm-kg-N-s", "fe_model.units", ("1000 times", "mm-t-N-s")),
    "two units": ("mm-t-N-s", "mm-s", "fe_model.units", ("length-mass-force-time",)),
    "tiny unit": ("mm-t-N-s", "m-ykg-N-s", "fe_model.units", ()),
    "point without unit": ('["0 mm", "0 mm", "0 mm"]', "[0, 0, 0]", "fe_model.reference_point", ("needs its unit",)),
    "point in kilograms": ('"0 mm", "0 mm"]', '"0 mm", "0 kg"]', "fe_model.reference_point", ("'kg' is a mass",)),
    "two coordinates": ('"0 mm", "0 mm"]', '"0 mm"]', "fe_model.reference_point", ("three lengths",)),
    "kind": ("matrices", "matrixes", "fe_model.kind", ("matrices",)),
    "no interface": ("[101]", "[]", "fe_model.interface", ("missing",)),
    "interface twice": ("[101]", "[101, 101]", "fe_model.interface", ("101 2 times",)),
    "interface nowhere": ("[101]", "[7]", "fe_model.interface", ("node 7", "101, 102")),
    "interface in words": ("[101]", '["101"]', "fe_model.interface", ("node numbers",)),
    "everything held": ("[101]", str(list(range(101, 111))), "fe_model.interface", ("all 60",)),
    "loss factor": ("interface", "loss_factor = 2\ninterface", "fe_model.loss_factor", ("below 2",)),
    "Nastran's key": ("interface", 'matrices = { mass = "m" }\ninterface', "fe_model.matrices", ("Nastran",)),
    "mass without unit": ('"2.51 +/- 0.02 kg"', "2.51", "stated.mass", ("needs its unit",)),
    "no mass": ('"2.51 +/- 0.02 kg"', '"-2 kg"', "stated.mass", ("positive",)),
    "another mass": ('"2.51 +/- 0.02 kg"', '"3.1 kg"', "stated.mass", ("where 3.1 kg are stated",)),
    "format": ("format = 1", "format = 2", "format", ("must be 1",)),
    "no TOML": ("format = 1", "format = ", "", ("not TOML",)),
}


@pytest.mark.parametrize("case", WRITTEN)
def test_wrong_descriptions_are_refused(case: str, arrays: Arrays, saved: Callable[..., Path], own_model: dict[str, Any]) -> None:
    old, new, field, words = WRITTEN[case]
    assert old in own_model["DESCRIPTION"]
    refused(saved(arrays, own_model["DESCRIPTION"].replace(old, new)), field, *words)


@pytest.mark.parametrize(
    ("units", "factor", "words"),
    [
        ("m-kg-N-s", "0.001", "tonnes"),
        ("mm-kg-mN-s", "0.001", "tonnes"),
        ("in-lbf-s", "0.1751", "lbf"),
        ("mm-Gg-kN-s", "1000", "tonnes"),
    ],
)
def test_a_slip_of_units_is_found_by_the_stated_mass_and_named(
    units: str, factor: str, words: str, arrays: Arrays, saved: Callable[..., Path], own_model: dict[str, Any]
) -> None:
    refused(saved(arrays, own_model["DESCRIPTION"].replace("mm-t-N-s", units)), "stated.mass", f"{factor}", words, units)


def test_a_mass_in_pounds_force_taken_for_kilograms_is_named(
    arrays: Arrays, saved: Callable[..., Path], own_model: dict[str, Any]
) -> None:
    """The matrices weigh 2.512 units; stated are the kilograms that 2.512 lbf s²/in are."""
    text = own_model["DESCRIPTION"].replace("mm-t-N-s", "m-kg-N-s").replace("2.51 +/- 0.02 kg", "439.9 g")
    refused(saved(arrays | {"mass": arrays["mass"] * 1e3}, text.replace("439.9 g", "439.92 kg")), "stated.mass", "pounds-force")


def test_a_centre_of_gravity_elsewhere_is_found(arrays: Arrays, saved: Callable[..., Path], own_model: dict[str, Any]) -> None:
    text = own_model["DESCRIPTION"]
    good = 'cog = ["12.5 mm", "0 mm", "187.5 mm"]\n'
    reading.read(saved(arrays, text + good))
    refused(saved(arrays, text + good.replace("187.5 mm", "187.5 cm")), "stated.cog", "0.1875", "1.875")


def test_an_interface_on_one_line_without_rotations_does_not_hold(
    arrays: Arrays, saved: Callable[..., Path], own_model: dict[str, Any]
) -> None:
    """Solid elements have no rotations: two nodes are a hinge, three on a line too."""
    translations = np.flatnonzero(arrays["dof"][:, 1] <= 3)
    reduced = arrays | {
        "stiffness": arrays["stiffness"][np.ix_(translations, translations)],
        "mass": arrays["mass"][np.ix_(translations, translations)],
        "dof": arrays["dof"][translations],
    }
    text = own_model["DESCRIPTION"].replace("[101]", "[101, 102, 103]")
    refused(saved(reduced, text), "fe_model.interface", "does not hold", "gamma")


MODAL = 'format = 1\n[fe_model]\nkind = "modal"\nunits = "m-kg-N-s"\nreference_point = ["0 m", "0 m", "0 m"]\n'

SPOILT_MODES: dict[str, tuple[Callable[[Arrays], None], str, tuple[str, ...]]] = {
    "damping of one": (entry("damping_ratio", (2,), 1.0), "damping_ratio", ("below 1", "mode 3")),
    "damping in percent": (put("damping_ratio", lambda z: z * 0 + 1.5), "damping_ratio", ("0.01 for 1 %",)),
    "negative damping": (entry("damping_ratio", (0,), -0.01), "damping_ratio", ("-0.01", "mode 1")),
    "negative frequency": (entry("frequency", (0,), -3.0), "frequency", ("positive", "-3")),
    "rigid-body mode": (entry("frequency", (0,), 0.0), "frequency", ("positive", "held")),
    "not ascending": (put("frequency", lambda f: f[::-1]), "frequency", ("ascend", "mode 2")),
    "no modes": (put("frequency", lambda f: f[:0]), "frequency", ("no mode",)),
    "transposed": (put("participation", lambda L: L.T), "participation", ("6 x 5", "5 x 6")),
    "too few columns": (put("participation", lambda L: L[:, :4]), "participation", ("6 x 5", "6 x 4")),
    "too much effective mass": (put("participation", lambda A: 2.0 * A), "participation", ("exceed", "times the rigid mass")),
    "signs": (entry("participation", (4, 0), 0.0), "participation", ("combination of axes",)),
    "not a rigid body": (entry("rigid_mass", (0, 0), 9.0), "rigid_mass", ("not the mass matrix of a rigid body", "9")),
    "unsymmetric rigid mass": (entry("rigid_mass", (4, 0), 0.1), "rigid_mass", ("not the mass matrix",)),
    "no body": (entry("rigid_mass", (5, 5), 9.0), "rigid_mass", ("triangle inequality",)),
    "no inertia": (put("rigid_mass", lambda A: 0.0 * A), "rigid_mass", ("no inertia along x",)),
    "unsymmetric residual": (entry("residual", (0, 4), 1.0), "residual", ("not symmetric", "row 1, column 5")),
    "negative residual": (put("residual", lambda A: -1.0 * A), "residual", ("not positive",)),
    "no residual of this size": (put("residual", lambda R: R[:3, :3]), "residual", ("6 x 6", "3 x 3")),
    "NaN": (entry("participation", (1, 1), np.nan), "participation", ("[1, 1]",)),
    "missing": (without("participation", "participations"), "participation", ("missing", "'participations'")),
    "damping matrix": (lambda a: a.update(viscous=np.diag([1.0, 1, 1, 1, -9])), "viscous", ("feeds energy in",)),
    "unsymmetric damping": (lambda a: a.update(viscous=np.triu(np.ones((5, 5)))), "viscous", ("not symmetric",)),
    "two truths": (lambda a: a.update(viscous=np.eye(5)), "damping_ratio", ("damping matrices make it",)),
}


@pytest.fixture
def modal_arrays(bracket_files: Path) -> Arrays:
    modes = reading.read(bracket_files / "bracket-modes.h5")
    names = ("frequency", "damping_ratio", "rigid_mass", "residual")
    return {name: getattr(modes, name).copy()[: 5 if name in names[:2] else 6] for name in names} | {
        "participation": modes.participation[:, :5].copy()
    }


@pytest.mark.parametrize("case", SPOILT_MODES)
def test_spoilt_modal_data_are_refused(case: str, modal_arrays: Arrays, saved: Callable[..., Path]) -> None:
    reading.read(saved(modal_arrays, MODAL))
    spoil, field, words = SPOILT_MODES[case]
    spoil(modal_arrays)
    refused(saved(modal_arrays, MODAL), field, *words)


def test_an_interface_of_modal_data_is_refused(modal_arrays: Arrays, saved: Callable[..., Path]) -> None:
    refused(saved(modal_arrays, MODAL + "interface = [1]\n"), "fe_model.interface", "matrices")


def test_pickled_arrays_are_not_opened(tmp_path: Path, arrays: Arrays, own_model: dict[str, Any]) -> None:
    class Trap:
        def __reduce__(self) -> tuple[Any, ...]:
            return (Path.touch, (tmp_path / "sprung",))

    np.savez(tmp_path / "model.npz", **arrays, extra=np.array([Trap()], dtype=object))
    refused(tmp_path / "model.npz", "extra", "pickle")
    (tmp_path / "plain.npz").write_bytes(pickle.dumps(Trap()))
    refused(tmp_path / "plain.npz", "", "cannot be read as .npz")
    assert not (tmp_path / "sprung").exists()


def test_a_link_out_of_an_hdf5_file_is_not_followed(tmp_path: Path, arrays: Arrays, saved: Callable[..., Path]) -> None:
    import h5py

    other = saved(arrays, ending=".h5").rename(tmp_path / "other.h5")
    for number, link in enumerate((h5py.ExternalLink(other.name, "mass"), h5py.SoftLink("/stiffness"))):
        path = tmp_path / f"linked-{number}.h5"
        with h5py.File(path, "w") as file:
            file["mass"] = link
        refused(path, "mass", "link", "not followed")


def test_numbers_outside_of_an_hdf5_file_are_not_read(tmp_path: Path) -> None:
    import h5py

    (tmp_path / "raw").write_bytes(bytes(800))
    with h5py.File(tmp_path / "outside.h5", "w") as file:
        file.create_dataset("mass", (10, 10), "f8", external=[("raw", 0, 800)])
    refused(tmp_path / "outside.h5", "mass", "another file")
    with h5py.File(tmp_path / "virtual.h5", "w") as file:
        layout = h5py.VirtualLayout((10, 10), "f8")
        layout[:] = h5py.VirtualSource("raw.h5", "mass", (10, 10))
        file.create_virtual_dataset("mass", layout)
    refused(tmp_path / "virtual.h5", "mass", "another file")


def test_declared_sizes_take_no_memory(tmp_path: Path) -> None:
    import h5py

    with h5py.File(tmp_path / "empty.h5", "w") as file:
        file.create_dataset("mass", (10**6, 10**6), "f8", chunks=(10, 10))
    refused(tmp_path / "empty.h5", "mass", "none was ever written")
    with h5py.File(tmp_path / "huge.h5", "w") as file:
        file.create_dataset("mass", (10**6, 10**6), "f8", chunks=(10, 10))[0, 0] = 1.0
    refused(tmp_path / "huge.h5", "", "GiB")


def test_an_npz_that_declares_more_than_it_holds_is_refused(tmp_path: Path) -> None:
    import io
    import zipfile

    header = io.BytesIO()
    np.lib.format.write_array_header_1_0(header, {"descr": "<f8", "fortran_order": False, "shape": (10**6, 10**6)})
    with zipfile.ZipFile(tmp_path / "model.npz", "w") as archive:
        archive.writestr("mass.npy", header.getvalue() + bytes(8))
    refused(tmp_path / "model.npz", "mass", "8000000000000 bytes where 8 follow")


def test_files_cut_short_are_refused(bracket_files: Path, tmp_path: Path) -> None:
    for name in ("bracket.h5", "bracket.npz"):
        content = (bracket_files / name).read_bytes()
        (tmp_path / name).write_bytes(content[: len(content) // 2])
        refused(tmp_path / name, "", "cut short")


def test_a_file_elsewhere_is_refused(bracket_files: Path, tmp_path: Path) -> None:
    inside = tmp_path / "inside"
    inside.mkdir()
    text = (bracket_files / "bracket-op4.toml").read_text(encoding="utf-8")
    (tmp_path / "bracket.op4").write_bytes((bracket_files / "bracket.op4").read_bytes())
    (inside / "up.toml").write_text(text.replace("bracket.op4", "../bracket.op4"), encoding="utf-8")
    refused(inside / "up.toml", "fe_model.file", "out of the folder")
    (inside / "bracket.op4").symlink_to(tmp_path / "bracket.op4")
    (inside / "link.toml").write_text(text, encoding="utf-8")
    refused(inside / "link.toml", "fe_model.file", "out of the folder")
    (inside / "none.toml").write_text(text.replace("bracket.op4", "absent.op4"), encoding="utf-8")
    refused(inside / "none.toml", "fe_model.file", "no file 'absent.op4'")


def test_a_checksum_finds_a_file_that_was_changed(bracket_files: Path, tmp_path: Path) -> None:
    import hashlib

    for name in ("bracket.op4", "bracket.bdf"):
        (tmp_path / name).write_bytes((bracket_files / name).read_bytes())
    digest = hashlib.sha256((tmp_path / "bracket.op4").read_bytes()).hexdigest()
    text = (bracket_files / "bracket-op4.toml").read_text(encoding="utf-8").replace("file", f'sha256 = "{digest}"\nfile')
    (tmp_path / "model.toml").write_text(text, encoding="utf-8")
    reading.read(tmp_path / "model.toml")
    with (tmp_path / "bracket.op4").open("ab") as file:
        file.write(b"\0")
    refused(tmp_path / "model.toml", "fe_model.sha256", "is not that of bracket.op4")


@pytest.mark.parametrize(
    ("name", "words"), [("a.h5", "no such file"), ("a.mat", "ending"), ("a.op4", "no such file"), ("a.toml", "no such file")]
)
def test_what_is_not_there_is_said(tmp_path: Path, name: str, words: str) -> None:
    refused(tmp_path / name, "", words)


def test_data_without_a_description_are_refused(bracket_files: Path, tmp_path: Path) -> None:
    (tmp_path / "bracket.op4").write_bytes((bracket_files / "bracket.op4").read_bytes())
    refused(tmp_path / "bracket.op4", "", "bracket.toml", "units")


def test_another_ending_is_not_written(bracket_files: Path, tmp_path: Path) -> None:
    with pytest.raises(BadInput, match=r"\.mat"):
        reading.write(reading.read(bracket_files / "bracket.h5"), tmp_path / "model.mat")


@pytest.fixture
def nastran_files(bracket_files: Path, tmp_path: Path) -> Path:
    for name in ("bracket.op4", "bracket.bdf", "bracket.pch", "bracket-op4.toml", "bracket-pch.toml"):
        (tmp_path / name).write_bytes((bracket_files / name).read_bytes())
    return tmp_path


K_HEADER, M_HEADER = (f"DMIG    {name}              0       6       2" for name in "KM")

NASTRAN: dict[str, tuple[str, str, str, str, str, tuple[str, ...]]] = {
    "no grids": ("bracket-op4.toml", "bracket.bdf", "GRID", "GRIX", "", ("no GRID",)),
    "missing": ("bracket-pch.toml", "bracket-pch.toml", '"k"', '"kk"', "KK", ("missing", "k, m", "stiffness")),
    "rectangular": ("bracket-pch.toml", "bracket.pch", K_HEADER, K_HEADER.replace("6", "9"), "k", ("form 9",)),
    "doubled": ("bracket-pch.toml", "bracket.pch", M_HEADER, K_HEADER, "k", ("is there twice",)),
    "complex": ("bracket-pch.toml", "bracket.pch", M_HEADER, M_HEADER[:-1] + "4", "m", ("complex",)),
}


@pytest.mark.parametrize("case", NASTRAN)
def test_spoilt_nastran_files_are_refused(case: str, nastran_files: Path) -> None:
    model, spoilt, old, new, field, words = NASTRAN[case]
    reading.read(nastran_files / model)
    text = (nastran_files / spoilt).read_text(encoding="utf-8")
    assert old in text
    (nastran_files / spoilt).write_text(text.replace(old, new), encoding="utf-8")
    refused(nastran_files / model, field, *words)


def test_an_entry_punched_twice_is_refused(nastran_files: Path) -> None:
    """pyyeti's own reader takes the last of the two."""
    path = nastran_files / "bracket.pch"
    lines = path.read_text(encoding="utf-8").splitlines()
    column = next(k for k, line in enumerate(lines) if line.startswith("DMIG*   M"))
    path.write_text("\n".join([*lines[: column + 2], *lines[column:]]) + "\n", encoding="utf-8")
    refused(nastran_files / "bracket-pch.toml", "mass", "more than once")


def test_an_output4_with_a_broken_record_is_refused(nastran_files: Path) -> None:
    path = nastran_files / "bracket.op4"
    content = path.read_bytes()
    path.write_bytes(content[:1000] + content[1008:])
    refused(nastran_files / "bracket-op4.toml", "", "not whole", "cut short")


def test_includes_are_not_followed(nastran_files: Path) -> None:
    grids = nastran_files / "bracket.bdf"
    grids.rename(nastran_files / "inner.bdf")
    grids.write_text("INCLUDE 'inner.bdf'\n", encoding="utf-8")
    refused(nastran_files / "bracket-op4.toml", "", "bracket.bdf", "INCLUDE")


def test_a_description_whose_type_is_damaged_is_refused_before_the_library_reads_it(tmp_path: Path) -> None:
    """Found by damaging files: the library ended the whole process there."""
    import h5py

    with h5py.File(tmp_path / "text.h5", "w") as file:
        file.attrs["description"] = "format = 1"
        file["mass"] = np.eye(10)
    content = bytearray((tmp_path / "text.h5").read_bytes())
    at = content.index(b"description") + 16 + 1  # behind the name, padded to eight: class of the type, then what it is a list of
    assert content[at - 1] & 0xF == 9
    content[at] = 0x62
    (tmp_path / "text.h5").write_bytes(bytes(content))
    refused(tmp_path / "text.h5", "description", "no text")
