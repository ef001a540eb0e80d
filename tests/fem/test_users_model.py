"""Users' models: every format and unit system gives the same structure; none that is damaged is believed."""

import shutil
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from numpy.testing import assert_allclose
from scipy.linalg import eigh
from scipy.sparse import csc_array, csr_array

from benchmarks.fuzz_readers import mutants
from fem.dynamic_mass import direct, modal
from fem.modes import Modes, fixed_base
from fem.structure import Structure
from fem.user_model import examine, reading
from fem.user_model.units import UnitSystem, unit_system
from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput

Arrays = dict[str, np.ndarray]
Saved = Callable[..., Path]
Own = dict[str, Any]

LINES = np.linspace(4.0, 200.0, 50)
SAME = {"rtol": 1e-9}


def dynamic_mass(model: Structure | Modes) -> DynamicMass:
    return modal(model if isinstance(model, Modes) else fixed_base(model, 12), LINES)


def assert_same(one: DynamicMass, other: DynamicMass, rtol: float = 1e-9) -> None:
    """Relative to the largest entry of its own kind: masses, first moments, moments."""
    for rows in (slice(0, 3), slice(3, 6)):
        for columns in (slice(0, 3), slice(3, 6)):
            a, b = one.matrix[:, rows, columns], other.matrix[:, rows, columns]
            assert_allclose(a, b, rtol=0, atol=rtol * np.abs(b).max())


@pytest.mark.parametrize(
    ("file", "rtol"), [("bracket.npz", 1e-9), ("bracket-op4.toml", 1e-9), ("bracket-modes.h5", 1e-9), ("bracket-pch.toml", 1e-7)]
)
def test_every_format_is_the_same_structure(bracket_files: Path, file: str, rtol: float) -> None:
    """DMIG is punched with ten digits, hence the last tolerance."""
    reference = reading.read(bracket_files / "bracket.h5")
    assert isinstance(reference, Structure)
    model = reading.read(bracket_files / file)
    found = model if isinstance(model, Modes) else fixed_base(model, 12)
    assert_allclose(found.frequency, fixed_base(reference, 12).frequency, rtol=rtol)
    assert_same(dynamic_mass(model), dynamic_mass(reference), rtol)


NAMED = {f"{what}/{part}": f"{what[0]}{part}" for what in ("stiffness", "mass") for part in ("column", "arm")}
"""Names in bracket-parts.op4 of the matrices of its parts."""


@pytest.fixture
def described_parts(bracket_files: Path, tmp_path: Path) -> Callable[..., Path]:
    """``described_parts(matrices)``: a description of the bracket by the parts in an OUTPUT4 file, which names these matrices."""

    def written(matrices: dict[str, str]) -> Path:
        for name in ("bracket-parts.op4", "bracket.bdf"):
            shutil.copy(bracket_files / name, tmp_path)
        names = ", ".join(f'"{ours}" = "{theirs}"' for ours, theirs in matrices.items())
        text = (bracket_files / "bracket-op4.toml").read_text(encoding="utf-8")
        more = f'file = "bracket-parts.op4"\ngrids = "bracket.bdf"\nmatrices = {{ {names} }}'
        path = tmp_path / "parts.toml"
        path.write_text(text.replace('file = "bracket.op4"', more), encoding="utf-8")
        return path

    return written


def test_parts_of_nastran_are_those_of_the_same_arrays(bracket_files: Path, described_parts: Callable[..., Path]) -> None:
    whole, found = reading.read(bracket_files / "bracket.h5"), reading.read(described_parts(NAMED))
    assert isinstance(found, Structure)
    assert list(found.part_stiffness) == list(found.part_mass) == ["column", "arm"]
    assert_same(dynamic_mass(found), dynamic_mass(whole))
    softer = found.stiffness - 0.5 * found.part_stiffness["column"]
    assert fixed_base(replace(found, stiffness=softer), 3).frequency[0] < 0.8 * fixed_base(found, 3).frequency[0]


def test_punched_superelements_are_parts_on_the_rows_that_each_names(
    bracket_files: Path, described_parts: Callable[..., Path]
) -> None:
    """Each part is punched with the rows alone that it has, files one behind the other; ten digits, hence the tolerance."""
    import pandas as pd
    from pyyeti import nastran

    path, arrays = described_parts(NAMED), np.load(bracket_files / "bracket-parts.npz")
    punched = []
    for ours, theirs in NAMED.items():
        own = np.flatnonzero(np.any(arrays[ours], axis=1))
        index = pd.MultiIndex.from_arrays(arrays["dof"][own].T)
        file = path.with_name(f"{theirs}.pch")
        nastran.wtdmig(str(file), {theirs: pd.DataFrame(arrays[ours][np.ix_(own, own)], index=index, columns=index)})
        punched.append(file.read_text(encoding="utf-8"))
    path.with_name("together.pch").write_text("".join(punched), encoding="utf-8")
    path.write_text(path.read_text(encoding="utf-8").replace("bracket-parts.op4", "together.pch"), encoding="utf-8")
    found = reading.read(path)
    assert isinstance(found, Structure)
    assert found.part_stiffness["arm"].nnz < found.part_stiffness["column"].nnz
    assert_same(dynamic_mass(found), dynamic_mass(reading.read(bracket_files / "bracket.h5")), 1e-7)


@pytest.mark.parametrize(
    ("matrices", "said"),
    [
        (NAMED | {"stiffness/arm": "karm"}, "`KARM`: is missing, the stiffness/arm"),
        (NAMED | {"stifness/arm": "sarm"}, "did you mean stiffness?"),
        ({"mass/arm": "marm"}, "`KAA`: is missing, the stiffness"),
        (NAMED | {"stiffness/arm": "scolumn", "stiffness": "sarm"}, "is not what its 2 parts add up to"),
    ],
)
def test_wrong_names_of_parts_are_refused(described_parts: Callable[..., Path], matrices: dict[str, str], said: str) -> None:
    with pytest.raises(BadInput) as refusal:
        reading.read(described_parts(matrices))
    assert said.lower() in str(refusal.value).lower()


@pytest.mark.parametrize("ending", [".h5", ".npz"])
def test_a_structure_written_is_read_back_to_the_last_digit(bracket_files: Path, tmp_path: Path, ending: str) -> None:
    before = reading.read(bracket_files / "bracket.h5")
    reading.write(before, tmp_path / f"again{ending}")
    after = reading.read(tmp_path / f"again{ending}")
    assert isinstance(before, Structure)
    assert isinstance(after, Structure)
    for name in ("stiffness", "mass"):
        assert_allclose(getattr(after, name).toarray(), getattr(before, name).toarray(), rtol=0, atol=0)
    for name in ("rigid", "held", "points", "translations", "reference_point"):
        assert_allclose(getattr(after, name), getattr(before, name), rtol=0, atol=0)


@pytest.mark.parametrize("ending", [".h5", ".npz"])
def test_modes_written_are_read_back_with_their_damping_and_residual(bracket_files: Path, tmp_path: Path, ending: str) -> None:
    structure = reading.read(bracket_files / "bracket.h5")
    before = fixed_base(structure, 5)
    reading.write(before, tmp_path / f"modes{ending}")
    after = reading.read(tmp_path / f"modes{ending}")
    for name in ("frequency", "damping_ratio", "participation", "rigid_mass", "residual", "viscous", "structural"):
        assert_allclose(getattr(after, name), getattr(before, name), rtol=1e-12, atol=0, err_msg=name)
    assert_same(dynamic_mass(after), modal(before, LINES), 1e-12)


def in_units(arrays: Arrays, old: UnitSystem, new: UnitSystem) -> Arrays:
    """The same structure in another system: what a program prints when it is fed with other units."""
    scale = np.where(arrays["dof"][:, 1] <= 3, old.length / new.length, 1.0)
    energy = old.mass * old.length**2 / old.time**2 / (new.mass * new.length**2 / new.time**2)
    inverse = 1 / np.outer(scale, scale)
    return arrays | {
        "stiffness": arrays["stiffness"] * inverse * energy,
        "mass": arrays["mass"] * inverse * energy * (old.time / new.time) ** 2,
        "coordinates": arrays["coordinates"] * old.length / new.length,
    }


@pytest.mark.parametrize("name", ["m-kg-N-s", "mm-kg-mN-s", "mm-kg-kN-ms", "in-lbf-s", "ft-slug-lbf-s", "cm-g-dyn-s"])
def test_units_make_no_difference(name: str, arrays: Arrays, saved: Saved, own_model: Own) -> None:
    millimetres = unit_system("mm-t-N-s", "test")
    reference = reading.read(saved(arrays))
    text = own_model["DESCRIPTION"].replace("mm-t-N-s", name)
    found = reading.read(saved(in_units(arrays, millimetres, unit_system(name, "test")), text))
    assert_allclose(found.mass.toarray(), reference.mass.toarray(), rtol=1e-9, atol=1e-15)
    assert_allclose(fixed_base(found, 12).frequency, fixed_base(reference, 12).frequency, **SAME)
    assert_same(dynamic_mass(found), dynamic_mass(reference))


def test_modal_data_come_in_units_too(bracket_files: Path, saved: Saved, own_model: Own) -> None:
    reference = reading.read(bracket_files / "bracket-modes.h5")
    lever, tonne = np.array([1, 1, 1, 1e3, 1e3, 1e3]), 1e-3
    arrays = {
        "frequency": reference.frequency,
        "damping_ratio": reference.damping_ratio,
        "participation": reference.participation * lever[:, None] * np.sqrt(tonne),
        "rigid_mass": reference.rigid_mass * np.outer(lever, lever) * tonne,
        "residual": reference.residual * np.outer(lever, lever) * tonne,
    }
    text = own_model["DESCRIPTION"].replace("matrices", "modal").replace("interface = [101]", "")
    assert_same(dynamic_mass(reading.read(saved(arrays, text))), dynamic_mass(reference), 1e-12)


@settings(max_examples=15, suppress_health_check=[HealthCheck.function_scoped_fixture])
@given(point=st.tuples(*3 * [st.floats(-2.0, 2.0)]))
def test_another_reference_point_is_the_same_dynamic_mass_seen_from_there(
    point: tuple[float, float, float], arrays: Arrays, saved: Saved, own_model: Own
) -> None:
    reference = dynamic_mass(reading.read(saved(arrays)))
    shifted = own_model["DESCRIPTION"].replace('["0 mm", "0 mm", "0 mm"]', str([f"{x!r} m" for x in point]))
    assert_same(dynamic_mass(reading.read(saved(arrays, shifted))), reference.about(point))


@pytest.mark.parametrize("made", [csr_array, csc_array])
@pytest.mark.parametrize("ending", [".h5", ".npz"])
def test_sparse_matrices_are_those_of_scipy(made: Any, ending: str, arrays: Arrays, saved: Saved) -> None:
    reference = reading.read(saved(arrays))
    sparse = {name: made(arrays.pop(name)) for name in ("stiffness", "mass")}
    parts = {f"{name}/{part}": getattr(A, part) for name, A in sparse.items() for part in ("data", "indices", "indptr", "shape")}
    found = reading.read(saved(arrays | parts, ending=ending))
    assert_allclose(found.stiffness.toarray(), reference.stiffness.toarray(), rtol=0, atol=0)


def test_a_reduced_model_with_six_interface_coordinates_is_the_full_one(arrays: Arrays, saved: Saved) -> None:
    """Craig-Bampton with every fixed-interface mode kept loses nothing; the interface is off the reference point."""
    full = dynamic_mass(reading.read(saved(arrays)))
    K, M, base = arrays["stiffness"], arrays["mass"], slice(0, 6)
    shift = -np.linalg.solve(K[6:, 6:], K[6:, base])
    _, modes = eigh(K[6:, 6:], M[6:, 6:])
    T = np.block([[np.eye(6), np.zeros((6, modes.shape[1]))], [shift, modes]])
    labels = np.vstack([arrays["dof"][base], [(900 + r, 0) for r in range(modes.shape[1])]])
    reduced = {
        "stiffness": T.T @ K @ T,
        "mass": T.T @ M @ T,
        "dof": labels,
        "nodes": np.array([101]),
        "coordinates": np.zeros((1, 3)),
    }
    assert_same(dynamic_mass(reading.read(saved(reduced))), full, 1e-8)


def test_several_interface_nodes_ride_on_the_reference_point(arrays: Arrays, saved: Saved, own_model: Own) -> None:
    """Three nodes held rigid: the six lowest nodes of the column would bend otherwise. Against a hand-made elimination."""
    text = own_model["DESCRIPTION"].replace("[101]", "[101, 102, 110]")
    found = reading.read(saved(arrays, text))
    held = [*range(12), *range(54, 60)]
    free = np.setdiff1d(np.arange(60), held)
    squares = eigh(arrays["stiffness"][np.ix_(free, free)], arrays["mass"][np.ix_(free, free)], eigvals_only=True)
    assert_allclose(found.held, held)
    assert_allclose(fixed_base(found, 12).frequency, np.sqrt(squares[:12]) / (2 * np.pi), **SAME)


def test_rotations_without_mass_are_no_mistake(arrays: Arrays, saved: Saved) -> None:
    """Lumped masses: the frequencies are those after static condensation of the rotations, which is exact for them."""
    rotations, moving = np.flatnonzero(arrays["dof"][:, 1] > 3), np.flatnonzero(arrays["dof"][:, 1] <= 3)
    lumped = np.repeat(np.array([0.2, *8 * [0.3], 0.2]) * 1e-3, 3)
    arrays["mass"] = np.zeros((60, 60))
    arrays["mass"][moving, moving] = lumped
    found = reading.read(saved(arrays, _without_stated()))
    m, r = moving[3:], rotations[3:]
    K = arrays["stiffness"]
    condensed = K[np.ix_(m, m)] - K[np.ix_(m, r)] @ np.linalg.solve(K[np.ix_(r, r)], K[np.ix_(r, m)])
    squares = eigh(condensed, np.diag(lumped[3:]), eigvals_only=True)
    assert_allclose(fixed_base(found, 6).frequency, np.sqrt(squares[:6]) / (2 * np.pi), rtol=1e-8)


def _without_stated() -> str:
    point = '["0 mm", "0 mm", "0 mm"]'
    model = f'kind = "matrices"\nunits = "mm-t-N-s"\nreference_point = {point}\ninterface = [101]\n'
    return f"format = 1\n[fe_model]\n{model}"


def test_a_loss_factor_a_structural_matrix_and_a_complex_stiffness_are_one_thing(
    arrays: Arrays, saved: Saved, own_model: Own
) -> None:
    text = own_model["DESCRIPTION"].replace("interface", "loss_factor = 0.02\ninterface")
    by_factor = reading.load(saved(arrays, text))
    by_matrix = reading.load(saved(arrays | {"structural": 0.02 * arrays["stiffness"]}))
    one, other = (direct(found.model, LINES, found.damping) for found in (by_factor, by_matrix))
    assert_same(one, other)
    K, M, R = by_factor.model.stiffness.toarray(), by_factor.model.mass.toarray(), by_factor.model.rigid
    omega = 2 * np.pi * LINES[7]
    P = (M @ R)[6:]
    expected = R.T @ M @ R + omega**2 * P.T @ np.linalg.solve((1 + 0.02j) * K[6:, 6:] - omega**2 * M[6:, 6:], P)
    assert_allclose(one.matrix[7], expected, rtol=1e-8, atol=1e-8)


def test_a_viscous_matrix_damps_the_structure(arrays: Arrays, saved: Saved) -> None:
    """Proportional to the stiffness, C = beta K, it gives every mode zeta = beta omega / 2."""
    found = reading.load(saved(arrays | {"viscous": 1e-6 * arrays["stiffness"]}))
    modes = fixed_base(found.model, 8, damping=found.damping)
    assert_allclose(modes.damping_ratio, 1e-6 * np.pi * modes.frequency, rtol=1e-8)


def test_a_matrix_in_single_precision_is_read(arrays: Arrays, saved: Saved) -> None:
    """And without a warning of numpy: the greatest number that is believed does not fit into it."""
    found = reading.load(saved(arrays | {"mass": arrays["mass"].astype(np.float32)}, ending=".npz"))
    assert_allclose(found.model.rigid_mass[0, 0], 2.51, atol=0.02)


def test_a_file_that_says_nothing_of_damping_leaves_it_open(bracket_files: Path) -> None:
    found = reading.load(bracket_files / "bracket.h5")
    assert found.damping is None
    assert found.name == "bracket"


@pytest.fixture(scope="session")
def superelement(tmp_path_factory: pytest.TempPathFactory) -> Path:
    """An external superelement that Nastran itself wrote (EXTSEOUT), as pyyeti ships it among its tests."""
    import pyyeti

    there = Path(pyyeti.__file__).parent / "tests" / "nas2cam_extseout"
    if not there.is_dir():
        pytest.skip("this pyyeti comes without its tests' data")
    folder = tmp_path_factory.mktemp("nastran")
    for ending in ("asm", "pch", "op4", "out"):
        shutil.copy(there / f"inboard.{ending}", folder)
    text = 'format = 1\n[fe_model]\nkind = "matrices"\nunits = "mm-t-N-s"\nreference_point = ["0 m", "0 m", "0 m"]\n'
    (folder / "inboard.toml").write_text(text, encoding="utf-8")
    return folder


def test_nastrans_superelement_weighs_what_nastran_printed(superelement: Path) -> None:
    """Four boundary grid points, one of them with displacements along axes of its own; the printed table has seven digits."""
    found = reading.read(superelement / "inboard.op4")
    printed = (superelement / "inboard.out").read_text(encoding="utf-8", errors="replace").splitlines()
    start = next(k for k, line in enumerate(printed) if "MASS AXIS SYSTEM (S)" in line)
    rows = [[float(word) for word in printed[start + k].split()[1:]] for k in (1, 2, 3)]
    mass, cog = rows[0][0] * 1e3, np.array([rows[1][1], rows[0][2], rows[0][3]]) * 1e-3
    assert found.rigid_mass[0, 0] == pytest.approx(mass, rel=1e-6)
    S = found.rigid_mass[3:, :3] / mass
    assert_allclose([S[2, 1], S[0, 2], S[1, 0]], cog, rtol=1e-6)
    assert len(found.held) == 24


def test_the_doctor_finds_nothing_in_nastrans_superelement(superelement: Path) -> None:
    assert examine.examine(superelement / "inboard.op4").findings == ()


def test_nastrans_superelement_oscillates_as_its_modal_coordinates_say(superelement: Path) -> None:
    """With the boundary held the eight modal coordinates are the modes: K_qq = omega² of modes normalised to unit mass."""
    from pyyeti.nastran import op4

    found = fixed_base(reading.read(superelement / "inboard.op4"), 8)
    K = op4.read(str(superelement / "inboard.op4"), justmatrix=True)["kxx"]
    assert_allclose(found.frequency, np.sqrt(np.diag(K)[24:]) / (2 * np.pi), rtol=1e-9)


def test_models_are_told_from_articles(bracket_files: Path, root: Path, tmp_path: Path) -> None:
    (tmp_path / "article.toml").write_text('format = 1\n[article]\nname = "hammer"\n', encoding="utf-8")
    (tmp_path / "broken.toml").write_text("[fe_model", encoding="utf-8")
    for name in ("bracket.h5", "bracket.npz", "bracket.op4", "bracket.pch", "bracket-op4.toml"):
        assert reading.is_model(bracket_files / name)
    for path in ("clumod-4", "hammer.step", tmp_path / "article.toml", tmp_path / "broken.toml", tmp_path, "absent.toml"):
        assert not reading.is_model(path)


COUNT = 40


@pytest.fixture(scope="session")
def own_files(bracket_files: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bracket's files, and the bracket as `write` leaves it."""
    folder = tmp_path_factory.mktemp("damaged") / "files"
    shutil.copytree(bracket_files, folder)
    for ending in (".h5", ".npz"):
        reading.write(reading.read(folder / "bracket.h5"), folder / f"written{ending}")
    return folder


@pytest.mark.parametrize(
    ("spoilt", "model"),
    [
        ("written.h5", "written.h5"),
        ("written.npz", "written.npz"),
        ("bracket.h5", "bracket.h5"),
        ("bracket-modes.h5", "bracket-modes.h5"),
        ("bracket.op4", "bracket-op4.toml"),
        ("bracket.pch", "bracket-pch.toml"),
        ("bracket.bdf", "bracket-pch.toml"),
        ("bracket-op4.toml", "bracket-op4.toml"),
    ],
)
def test_a_damaged_model_is_read_or_refused_in_words(
    own_files: Path, tmp_path: Path, spoilt: str, model: str, capfd: pytest.CaptureFixture[str]
) -> None:
    """Files of `write` and every npz have checksums: nothing wrong in them is believed at all.

    In the others one moment of inertia in M may change unseen; what is sure is the stated mass, or a checksum in the description.
    """
    shutil.copytree(own_files, tmp_path, dirs_exist_ok=True)
    whole, content = reading.read(own_files / model), (own_files / spoilt).read_bytes()
    capfd.readouterr()
    refusals = 0
    for one in mutants(content, COUNT, seed=len(spoilt)):
        (tmp_path / spoilt).write_bytes(one.content)
        try:
            found = reading.read(tmp_path / model)
        except BadInput:
            refusals += 1
            continue
        assert_allclose(found.rigid_mass[0, 0], whole.rigid_mass[0, 0], rtol=0.03)
        if spoilt.startswith("written") and isinstance(found, Structure):
            assert_allclose(found.stiffness.toarray(), whole.stiffness.toarray(), rtol=0, atol=0)
            assert_allclose(found.mass.toarray(), whole.mass.toarray(), rtol=0, atol=0)
    assert refusals > COUNT / 4  # the damage is real
    assert capfd.readouterr() == ("", "")
