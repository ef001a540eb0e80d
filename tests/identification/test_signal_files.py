"""Signal files: what is written is read as it was, what others write is read, and what is wrong or damaged is refused."""

import time
from collections.abc import Callable
from contextlib import suppress
from dataclasses import dataclass, replace
from pathlib import Path

import h5py
import numpy as np
import pytest
from hypothesis import HealthCheck, given, settings
from hypothesis import strategies as st
from hypothesis.extra.numpy import arrays
from numpy.testing import assert_allclose, assert_array_equal
from scipy.sparse import csc_array

from benchmarks import fuzz_readers
from benchmarks.fuzz_readers import TARGETS, Target, write_mat_v73
from geometry.errors import BadInput
from identification.campaign import recording
from identification.files import csv, files, hdf5, mat, uff
from identification.files.files import Signals, StatedUnits, variable


@dataclass(frozen=True, kw_only=True)
class Format:
    """A way to write, its ending, and how far numbers come back: 0 is to the last bit."""

    name: str
    ending: str
    write: Callable[[Path, Signals], None]
    digits: float = 0.0


FORMATS = (
    Format(name="csv", ending=".csv", write=csv.write),
    Format(name="hdf5", ending=".h5", write=hdf5.write),
    Format(name="mat 5", ending=".mat", write=mat.write),
    Format(name="mat 7.3", ending=".mat", write=write_mat_v73),
    Format(name="uff 58", ending=".uff", write=uff.write, digits=5.1e-13),  # E20.12: half a unit of the 13th digit
    Format(name="uff 58b", ending=".unv", write=lambda path, signals: uff.write(path, signals, binary=True)),
)
every_format = pytest.mark.parametrize("form", FORMATS, ids=lambda form: form.name)

values = st.floats(-1e12, 1e12).filter(
    lambda x: x == 0 or abs(x) > 1e-90
)  # E20.12 has room for two digits of exponent and a sign
rates = st.sampled_from([1.0, 100.0, 256.0, 564.0, 1000.0, 2048.0, 8192.0, 51200.0]) | st.floats(0.5, 1e6)
NAMES = ("cover-1x", "fmd-x12", "lower_1")


def signals(samples: dict[str, np.ndarray], **axis: object) -> Signals:
    return Signals(source="made", samples=samples, **axis)  # type: ignore[arg-type]


def sample(seed: int = 1, count: int = 30, **axis: object) -> Signals:
    generator = np.random.default_rng(seed)
    found = {name: generator.standard_normal(count) for name in NAMES}
    if "frequency" in axis:
        found = {name: one + 1j * generator.standard_normal(count) for name, one in found.items()}
    return signals(found, **(axis or {"sampling_rate": 564.0}))


def compared(found: Signals, wanted: Signals, form: Format) -> None:
    called = {(variable(name) if form.ending == ".mat" else name): one for name, one in wanted.samples.items()}
    assert list(found.samples) == list(called) or form.ending in (".h5", ".mat")  # those sort names
    assert set(found.samples) == set(called)
    for name, one in called.items():
        assert found.samples[name].dtype == one.dtype
        for part, whole in ((found.samples[name].real, one.real), (found.samples[name].imag, one.imag)):
            assert_allclose(part, whole, rtol=form.digits, atol=0)


@every_format
@settings(max_examples=10, suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture])
@given(block=arrays(np.float64, st.tuples(st.integers(2, 30), st.just(3)), elements=values), rate=rates)
def test_time_histories_come_back(tmp_path: Path, form: Format, block: np.ndarray, rate: float) -> None:
    path, made = tmp_path / f"run{form.ending}", signals(dict(zip(NAMES, block.T, strict=True)), sampling_rate=rate)
    form.write(path, made)
    found = files.read(path)
    compared(found, made, form)
    assert found.frequency is None
    assert found.sampling_rate is not None
    # CSV holds time stamps only, each of them rounded once
    assert_allclose(found.sampling_rate, rate, rtol=1e-15 if form.ending != ".csv" else 1e-14)


@every_format
@settings(max_examples=10, suppress_health_check=[HealthCheck.too_slow, HealthCheck.function_scoped_fixture])
@given(
    block=arrays(np.float64, st.tuples(st.integers(2, 30), st.just(6)), elements=values),
    start=st.integers(0, 400),
    step=st.integers(1, 100),
)
def test_spectra_come_back(tmp_path: Path, form: Format, block: np.ndarray, start: int, step: int) -> None:
    lines = (start + step * np.arange(len(block))) / 100
    path = tmp_path / f"run{form.ending}"
    made = signals(dict(zip(NAMES, block[:, :3].T + 1j * block[:, 3:].T, strict=True)), frequency=lines)
    form.write(path, made)
    found = files.read(path)
    compared(found, made, form)
    assert found.sampling_rate is None
    assert found.frequency is not None
    # universal files say start and increment; what a multiplication rounds is left
    assert_allclose(found.frequency, lines, rtol=1e-14, atol=1e-15)


@every_format
def test_lines_that_are_not_evenly_spaced_come_back(tmp_path: Path, form: Format) -> None:
    lines = np.array([4.0, 4.05, 4.2, 7.5, 31.25])
    path = tmp_path / f"run{form.ending}"
    form.write(path, made := sample(count=5, frequency=lines))
    found = files.read(path)
    compared(found, made, form)
    assert_allclose(found.frequency, lines, rtol=1e-15)


def test_ascii_refuses_lines_that_its_six_digits_cannot_say(tmp_path: Path) -> None:
    lines = np.array([4.0, 4.1234567, 5.0])
    with pytest.raises(BadInput, match="58b"):
        uff.write(tmp_path / "run.uff", sample(count=3, frequency=lines))
    uff.write(tmp_path / "run.uff", sample(count=3, frequency=lines), binary=True)
    assert_array_equal(files.read(tmp_path / "run.uff").frequency, lines)


@every_format
def test_a_file_that_is_cut_short_is_refused_or_said(tmp_path: Path, form: Format) -> None:
    path = tmp_path / f"run{form.ending}"
    form.write(path, made := sample())
    content = path.read_bytes()
    for share in (0.0, 0.1, 0.5, 0.9, 0.99):
        path.write_bytes(content[: int(share * len(content))])
        if form.ending != ".csv" or share == 0:
            with pytest.raises(BadInput, match=path.name):
                files.read(path)
            continue
        with suppress(BadInput):  # rows are all that a CSV says of its length
            found = files.read(path)
            assert found.warnings or len(found.samples[NAMES[0]]) < len(made.samples[NAMES[0]])


def test_an_ending_that_nobody_knows_is_refused(tmp_path: Path) -> None:
    (tmp_path / "run.txt").write_text("x", encoding="utf-8")
    with pytest.raises(BadInput, match=r"none of \.uff"):
        files.read(tmp_path / "run.txt")


class TestCsv:
    """What others write, and what is refused."""

    def read(self, tmp_path: Path, text: str | bytes) -> Signals:
        path = tmp_path / "run.csv"
        path.write_bytes(text if isinstance(text, bytes) else text.encode())
        return csv.read(path)

    def test_windows_line_ends_a_byte_order_mark_and_quoted_names_are_read(self, tmp_path: Path) -> None:
        found = self.read(tmp_path, b'\xef\xbb\xbftime,"a, b"\r\n0.0,1\r\n0.1,2.5\r\n0.2,3e1\r\n')
        assert_array_equal(found.samples["a, b"], [1, 2.5, 30])
        assert found.sampling_rate == 10.0

    @pytest.mark.parametrize(("digits", "rate"), [(4, 564.0), (5, 8192.0), (3, 100.0)])
    def test_time_stamps_of_a_few_digits_tell_the_rate_that_was_set(self, tmp_path: Path, digits: int, rate: float) -> None:
        rows = "".join(f"{k / rate:.{digits}f},{k}\n" for k in range(2000))
        assert self.read(tmp_path, "time,a\n" + rows).sampling_rate == rate

    @pytest.mark.parametrize(("digits", "rate"), [(6, 512.0), (7, 1024.0), (8, 2048.0)])
    def test_so_do_stamps_of_a_number_of_digits_in_all(self, tmp_path: Path, digits: int, rate: float) -> None:
        rows = "".join(f"{k / rate:.{digits}g},{k}\n" for k in range(40000))
        assert self.read(tmp_path, "time,a\n" + rows).sampling_rate == rate

    @pytest.mark.parametrize(
        ("text", "words"),
        [
            ("a,b\n1,2\n", "first column"),
            ("time;a\n0;1\n", "commas"),
            ("time,a,a\n0,1,2\n1,2,3\n", "two columns"),
            ("time,a\n", "no samples"),
            ("time,a\n0,1\n1\n2,3\n", "cannot be read"),
            ("time,a\n0,1,2\n1,2,3\n", "3 columns where the header names 2"),
            ("time,a\n0,1\n1,x\n", "row 2"),
            ("time,a\n0,0x10\n1,2\n", "row 1"),
            ("time,a\n0,1_0\n1,2\n", "row 1"),
            ("time,a\n0,1\n1,2\n3,3\n4,4\n5,1\n6,0\n7,1\n", "row 3 comes 2 s after"),
            ("time,a\n0,1\n1,2\n1,3\n2,4\n3,5\n4,6\n", "unequally"),
            ("time,a\n2,1\n1,2\n0,3\n", "ascend"),
            ("time,a\n0,1\nnan,2\n2,3\n", "a time in row 2"),
            ("time\n0\n1\n", "no channel"),
            ("frequency,a\n1,2\n2,3\n", "a.re and a.im"),
            ("frequency,a.re\n1,2\n2,3\n", "a.im is missing"),
            ("frequency,a.re,a.im\n1,2,3\n1,3,3\n", "ascend"),
            ("frequency,a.re,a.im\n-1,2,3\n1,3,3\n", "not negative"),
        ],
    )
    def test_what_is_wrong_is_said(self, tmp_path: Path, text: str, words: str) -> None:
        with pytest.raises(BadInput, match=words):
            self.read(tmp_path, text)

    def test_a_last_row_without_end_is_read_with_a_word(self, tmp_path: Path) -> None:
        assert "cut short" in self.read(tmp_path, "time,a\n0,1\n1,2").warnings[0]

    def test_infinite_parts_of_a_spectrum_stay_infinite(self, tmp_path: Path) -> None:
        found = self.read(tmp_path, "frequency,a.re,a.im\n1,2,inf\n2,3,4\n").samples["a"]
        assert (found[0].real, found[0].imag) == (2.0, np.inf)

    def test_a_name_that_needs_quotes_comes_back(self, tmp_path: Path) -> None:
        made = signals({'a "b", c': np.array([1.0, 2.0])}, sampling_rate=10.0)
        csv.write(tmp_path / "run.csv", made)
        assert list(csv.read(tmp_path / "run.csv").samples) == ['a "b", c']


class TestHdf5:
    """As plain h5py writes it, and what hides in such files."""

    def made(self, tmp_path: Path, fill: Callable[[h5py.File], object]) -> Path:
        with h5py.File(tmp_path / "run.h5", "w") as file:
            file.attrs["sampling_rate"] = 100
            fill(file)
        return tmp_path / "run.h5"

    @pytest.mark.parametrize("options", [{}, {"compression": "gzip"}, {"chunks": (7,)}, {"chunks": (7,), "shuffle": True}])
    @pytest.mark.parametrize("kind", ["<f4", ">f8"])
    def test_every_ordinary_storage_is_read(self, tmp_path: Path, options: dict[str, object], kind: str) -> None:
        wanted = np.random.default_rng(3).standard_normal(30).astype(kind)
        path = self.made(tmp_path, lambda file: file.create_dataset("channels/a", data=wanted, **options))
        assert_array_equal(hdf5.read(path).samples["a"], wanted.astype(np.float64))
        assert hdf5.read(path).sampling_rate == 100.0

    @pytest.mark.parametrize(
        ("fill", "words"),
        [
            (lambda f: None, "found none"),
            (lambda f: f.create_group("channels"), "no channel"),
            (lambda f: f.create_dataset("channels", data=[1.0]), "something else"),
            (lambda f: f.create_dataset("channels/a", data=[1, 2, 3]), "floating-point"),
            (lambda f: f.create_dataset("channels/a", data=["x", "y"]), "floating-point"),
            (lambda f: f.create_dataset("channels/a", data=np.zeros((2, 3))), "2 x 3"),
            (lambda f: f.create_dataset("channels/a", data=1.5), "single number"),
            (lambda f: f.create_dataset("channels/a/b", data=[1.0, 2.0]), "no dataset"),
            (lambda f: [f.create_dataset(f"channels/{n}", data=np.ones(k)) for n, k in (("a", 3), ("b", 4))], "4 samples"),
            (lambda f: f.create_dataset("channels/a", (5,), "f8"), "never written"),
            (lambda f: f.create_dataset("channels/a", (10,), "f8", chunks=(5,)), "in 2 pieces, found 0"),
            (lambda f: f.create_dataset("channels/a", (2**40,), "f8", chunks=(2**20,)), "GiB"),
            (lambda f: f.require_group("channels").__setitem__("a", h5py.SoftLink("/b")), "link"),
            (lambda f: f.require_group("channels").__setitem__("a", h5py.ExternalLink("other.h5", "/b")), "link"),
            (lambda f: f.__setitem__("channels", h5py.ExternalLink("other.h5", "/b")), "something else"),
            (lambda f: f.create_dataset("channels/a", (3,), "f8", external=[("raw.bin", 0, 24)]), "another file"),
        ],
    )
    def test_what_cannot_be_believed_is_refused(self, tmp_path: Path, fill: Callable[[h5py.File], object], words: str) -> None:
        with pytest.raises(BadInput, match=words):
            hdf5.read(self.made(tmp_path, fill))

    @pytest.mark.parametrize("rate", [0.0, -1.0, np.nan, np.inf, "fast", [1.0, 2.0]])
    def test_a_rate_that_is_none_is_refused(self, tmp_path: Path, rate: object) -> None:
        path = self.made(tmp_path, lambda file: file.create_dataset("channels/a", data=[1.0, 2.0]))
        with h5py.File(path, "a") as file:
            file.attrs["sampling_rate"] = rate
        with pytest.raises(BadInput, match="sampling_rate"):
            hdf5.read(path)

    def test_both_axes_at_once_are_refused(self, tmp_path: Path) -> None:
        path = self.made(tmp_path, lambda f: [f.create_dataset(n, data=[1.0, 2.0]) for n in ("channels/a", "frequency")])
        with pytest.raises(BadInput, match="found both"):
            hdf5.read(path)

    def test_bytes_that_fell_out_are_noticed_without_checksums(self, tmp_path: Path) -> None:
        path = self.made(tmp_path, lambda file: file.create_dataset("channels/a", data=np.arange(4000.0)))
        content = path.read_bytes()
        path.write_bytes(content[:-4000] + content[-3992:])
        with pytest.raises(BadInput, match="bytes long"):
            hdf5.read(path)


class TestMat:
    """What MATLAB may put into such a file, and what is never made of it."""

    def saved(self, tmp_path: Path, **variables: object) -> Path:
        from scipy.io import savemat

        savemat(tmp_path / "run.mat", variables, do_compression=bool(variables.pop("packed", False)))
        return tmp_path / "run.mat"

    @pytest.mark.parametrize("packed", [False, True])
    def test_rows_columns_and_whole_numbers_stored_small_are_vectors(self, tmp_path: Path, packed: bool) -> None:
        column, row, single = np.arange(4.0)[:, None], np.arange(4.0)[None, :] + 1j, np.arange(4, dtype="f4")[None, :]
        found = mat.read(self.saved(tmp_path, packed=packed, fs=100.0, a=column, b=row, c=single))
        assert_array_equal(found.samples["a"], np.arange(4.0))
        assert_array_equal(found.samples["b"], np.arange(4.0) + 1j)
        assert_array_equal(found.samples["c"], np.arange(4.0))
        assert found.sampling_rate == 100.0

    @pytest.mark.parametrize("packed", [False, True])
    @pytest.mark.parametrize(
        ("value", "words"),
        [
            ({"x": 1.0}, "a structure"),
            (np.array([1.0, "a"], dtype=object), "a cell array"),
            ("text", "text"),
            (np.arange(4), "whole numbers"),
            (np.ones((2, 3)), "2 x 3"),
            (csc_array(np.eye(3)), "sparse"),
        ],
    )
    def test_what_is_no_vector_of_numbers_is_refused(self, tmp_path: Path, packed: bool, value: object, words: str) -> None:
        with pytest.raises(BadInput, match=words):
            mat.read(self.saved(tmp_path, packed=packed, fs=1.0, a=value))

    def test_an_array_that_declares_more_than_follows_is_refused(self, tmp_path: Path) -> None:
        path = self.saved(tmp_path, a=np.arange(40.0)[:, None])
        content = path.read_bytes()
        dimensions = np.array([5, 8, 40, 1], dtype="<i4").tobytes()
        assert content.count(dimensions) == 1
        path.write_bytes(content.replace(dimensions, np.array([5, 8, 41, 1], dtype="<i4").tobytes()))
        with pytest.raises(BadInput, match="declares 41 numbers"):
            mat.read(path)

    @pytest.mark.parametrize(("axes", "found"), [({}, "neither"), ({"fs": 1.0, "frequency": [1.0, 2.0]}, "both")])
    def test_one_axis_is_needed(self, tmp_path: Path, axes: dict[str, object], found: str) -> None:
        with pytest.raises(BadInput, match=found):
            mat.read(self.saved(tmp_path, a=[1.0, 2.0], **axes))

    @pytest.mark.parametrize("rate", [0.0, -3.0, np.nan, [1.0, 2.0]])
    def test_a_rate_that_is_none_is_refused(self, tmp_path: Path, rate: object) -> None:
        with pytest.raises(BadInput, match="fs"):
            mat.read(self.saved(tmp_path, a=[1.0, 2.0], fs=rate))

    def test_a_bomb_is_not_unpacked(self, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> None:
        from identification.files import mat

        path = self.saved(tmp_path, packed=True, fs=1.0, a=np.zeros(100_000))
        monkeypatch.setattr(mat, "LARGEST_BYTES", 10_000)
        with pytest.raises(BadInput, match="GiB"):
            mat.read(path)

    @pytest.mark.parametrize(
        ("names", "words"), [(("a-b", "a_b"), "another one"), (("lower.1",), "variable"), (("fs",), "variable")]
    )
    def test_names_that_matlab_has_not_are_refused_on_writing(self, tmp_path: Path, names: tuple[str, ...], words: str) -> None:
        with pytest.raises(BadInput, match=words):
            mat.write(tmp_path / "run.mat", signals({name: np.ones(3) for name in names}, sampling_rate=1.0))

    def test_scipy_reads_what_is_written(self, tmp_path: Path) -> None:
        from scipy.io import loadmat

        mat.write(tmp_path / "run.mat", sample())
        found = loadmat(tmp_path / "run.mat")
        assert_array_equal(found["cover_1x"].ravel(), sample().samples["cover-1x"])
        assert found["fs"].item() == 564.0

    def test_an_object_of_version_73_is_refused_by_its_class(self, tmp_path: Path) -> None:
        write_mat_v73(tmp_path / "run.mat", sample())
        with h5py.File(tmp_path / "run.mat", "a") as file:
            file["cover_1x"].attrs["MATLAB_class"] = np.bytes_("cell")
        with pytest.raises(BadInput, match="cell"):
            mat.read(tmp_path / "run.mat")


class TestUff:
    """Beside pyuff, in both directions, and what is refused."""

    def by_pyuff(self, path: Path, names: tuple[str, ...] = NAMES, **how: object) -> dict[str, np.ndarray]:
        """A file as pyuff writes it: the samples by name."""
        import pyuff

        t = np.arange(40) / 564.0
        made = {name: np.random.default_rng(k).standard_normal(40) for k, name in enumerate(names)}
        file = pyuff.UFF(str(path))
        file.write_sets({"type": 151, "model_name": "m", "description": "d", "db_app": "a", "program": "p"}, mode="overwrite")
        for name, one in made.items():
            header = {"type": 58, "id1": name, "orddenom_spec_data_type": 0}
            header |= dict.fromkeys(("func_type", "rsp_node", "rsp_dir", "ref_node", "ref_dir"), 1)
            file.write_sets({**header, "x": t, "data": one, "abscissa_spacing": 1, **how}, mode="add")
        return made

    @pytest.mark.filterwarnings("ignore::pytest.PytestUnraisableExceptionWarning")  # pyuff leaves binary files open
    @pytest.mark.parametrize("binary", [0, 1])
    def test_what_pyuff_writes_is_read(self, tmp_path: Path, binary: int) -> None:
        made = self.by_pyuff(tmp_path / "run.uff", binary=binary)
        found = uff.read(tmp_path / "run.uff")
        assert found.sampling_rate == 564.0  # from an increment of six digits
        for name, one in made.items():
            # pyuff writes twelve digits
            assert_allclose(found.samples[name], one, rtol=0 if binary else 5.1e-12)

    @pytest.mark.parametrize("spectra", [False, True])
    @pytest.mark.parametrize("binary", [False, True])
    def test_pyuff_reads_what_is_written(self, tmp_path: Path, spectra: bool, binary: bool) -> None:
        import pyuff

        made = sample(frequency=4 + 0.05 * np.arange(30)) if spectra else sample()
        uff.write(tmp_path / "run.uff", made, binary=binary)
        sets = pyuff.UFF(str(tmp_path / "run.uff")).read_sets()
        assert [one["type"] for one in sets[:2]] == [151, 164]
        for one, (name, samples) in zip(sets[2:], made.samples.items(), strict=True):
            assert (one["id1"], one["func_type"]) == (name, 12 if spectra else 1)
            # the same digits of the same file
            assert_array_equal(one["data"], uff.read(tmp_path / "run.uff").samples[name])
            assert_allclose(one["data"], samples, rtol=0 if binary else 5.1e-13)

    def test_complex_numbers_whose_bytes_pyuff_counts_by_half_are_read_with_a_word(self, tmp_path: Path) -> None:
        uff.write(tmp_path / "run.uff", made := sample(frequency=4 + 0.05 * np.arange(30)), binary=True)
        content = (tmp_path / "run.uff").read_bytes()
        (tmp_path / "run.uff").write_bytes(content.replace(f"{16 * 30:12d}".encode(), f"{8 * 30:12d}".encode()))
        found = uff.read(tmp_path / "run.uff")
        assert "pyuff" in found.warnings[0]
        assert_array_equal(found.samples["fmd-x12"], made.samples["fmd-x12"])

    @pytest.mark.parametrize(
        ("old", "new", "words"),
        [
            (b"    1         0    0         0 NONE", b"    4         0    0         0 NONE", "function type 4"),
            (b"    1         0    0         0 NONE", b"   12         0    0         0 NONE", "spectrum beside"),
            (b"cover-1x", b"fmd-x12 ", "2 datasets have this name"),
            (b"cover-1x", b"NONE    ", "no name"),
            (b"sampling rate 564.0 Hz", b"sampling rate 565.0 Hz", "565.0"),
            (b" 1.77305E-03", b" 1.77405E-03", "564.0 Hz"),
            (b"        30         1", b"        31         1", "promises 31"),
            (b"         4        30", b"         9        30", "ordinate data type 9"),
            (b"    -1\n    58", b"    -2\n    58", "outside of any dataset"),
        ],
    )
    def test_a_header_that_contradicts_is_refused(self, tmp_path: Path, old: bytes, new: bytes, words: str) -> None:
        uff.write(tmp_path / "run.uff", sample())
        content = (tmp_path / "run.uff").read_bytes()
        assert old in content
        (tmp_path / "run.uff").write_bytes(content.replace(old, new, -1 if b"E-03" in old else 1))
        with pytest.raises(BadInput, match=words):
            uff.read(tmp_path / "run.uff")

    def test_axes_that_differ_are_refused(self, tmp_path: Path) -> None:
        parts = []
        for rate in (564.0, 565.0):
            uff.write(tmp_path / "part.uff", signals({f"at {rate:g}": np.ones(5)}, sampling_rate=rate))
            parts.append((tmp_path / "part.uff").read_bytes())
        (tmp_path / "run.uff").write_bytes(b"".join(parts))
        with pytest.raises(BadInput, match="another axis than at 564"):
            uff.read(tmp_path / "run.uff")

    def test_uneven_sampling_is_refused(self, tmp_path: Path) -> None:
        t = np.arange(40) / 564.0
        t[20:] += 0.001
        self.by_pyuff(tmp_path / "run.uff", x=t, abscissa_spacing=0)
        with pytest.raises(BadInput, match="sampled unequally"):
            uff.read(tmp_path / "run.uff")

    @pytest.mark.parametrize("spacing", [0, 1])
    @pytest.mark.parametrize("kind", [2, 4])
    def test_every_number_form_of_the_format_is_read(self, tmp_path: Path, spacing: int, kind: int) -> None:
        """Single and double, even and uneven: what pyuff reads from the same file is the oracle."""
        import pyuff

        self.by_pyuff(tmp_path / "run.uff", abscissa_spacing=spacing, ord_data_type=kind)
        for one in pyuff.UFF(str(tmp_path / "run.uff")).read_sets([1, 2, 3]):
            assert_array_equal(uff.read(tmp_path / "run.uff").samples[one["id1"]], one["data"])

    def test_units_of_dataset_164_go_to_the_functions_behind_it(self, tmp_path: Path) -> None:
        units = {
            "cover-1x": StatedUnits(length=9.80665, force=1.0, words="g"),
            "fmd-x12": StatedUnits(length=1.0, force=1e3, words="kN"),
        }
        made = sample()
        uff.write(tmp_path / "run.uff", Signals(source="made", samples=made.samples, sampling_rate=564.0, units=units))
        found = uff.read(tmp_path / "run.uff").units
        sizes = {"cover-1x": ("acceleration", 9.80665), "fmd-x12": ("force", 1e3), "lower_1": ("moment", 1.0)}
        for name, (quantity, size) in sizes.items():
            # factors are written with 17 digits, inverted twice
            assert_allclose(found[name].size(quantity), size, rtol=1e-15)

    def test_numbers_are_not_read_from_something_else(self, tmp_path: Path) -> None:
        uff.write(tmp_path / "run.uff", sample())
        lines = (tmp_path / "run.uff").read_text(encoding="utf-8").splitlines()
        row = next(k for k, line in enumerate(lines) if len(line) == 80 and line.count("E") == 4)
        for spoilt, words in (
            (lines[row] + " 1", "characters"),
            (lines[row].replace("E", "_", 1), "no number"),
            (lines[row][:-3], "characters"),
        ):
            (tmp_path / "bad.uff").write_text("\n".join([*lines[:row], spoilt, *lines[row + 1 :]]) + "\n", encoding="utf-8")
            with pytest.raises(BadInput, match=words):
                uff.read(tmp_path / "bad.uff")


COUNT = 200


@pytest.mark.parametrize("target", TARGETS, ids=lambda target: target.name)
def test_a_damaged_signal_file_is_refused_or_read_as_it_was(
    target: Target, tmp_path: Path, capfd: pytest.CaptureFixture[str]
) -> None:
    counts = fuzz_readers.run(target, COUNT, tmp_path)
    assert sum(counts.values()) == COUNT
    assert [what for what in counts if what.startswith("FAILED")] == []
    assert counts["refused"] > COUNT / 4  # the damage is real
    assert capfd.readouterr() == ("", "")


def test_a_damaged_description_is_refused_or_read_as_it_was(capfd: pytest.CaptureFixture[str]) -> None:
    counts = fuzz_readers.run_toml(COUNT)
    assert [what for what in counts if what.startswith("FAILED")] == []
    assert counts["refused"] > COUNT / 2
    assert capfd.readouterr() == ("", "")


@pytest.mark.parametrize(
    ("read", "verdict"),
    [
        (lambda signals: signals, "read"),
        (lambda signals: changed(signals, 1), "digits"),
        (lambda signals: changed(signals, 2), "FAILED: 2 values changed"),
        (lambda signals: 1 / 0, "FAILED: ZeroDivisionError"),
        (lambda signals: time.sleep(3), "FAILED: hangs"),
    ],
)
def test_the_judge_sees_a_reader_that_believes_too_much(
    read: Callable[[Signals], Signals], verdict: str, monkeypatch: pytest.MonkeyPatch, tmp_path: Path
) -> None:
    channels, target = fuzz_readers.table(), TARGETS[0]
    signals = fuzz_readers.signals(channels.names, spectra=False)
    whole, _ = recording(signals, channels, "campaign.toml")
    assert whole is not None
    monkeypatch.setattr(fuzz_readers, "PATIENCE", 1)
    monkeypatch.setattr(fuzz_readers.files, "read", lambda path: read(signals))
    one = fuzz_readers.Mutant(content=b"", replaced=1)
    assert fuzz_readers.judged(target, whole, channels, tmp_path / "x.csv", one).startswith(verdict)


def changed(signals: Signals, count: int) -> Signals:
    """`signals` with so many of its numbers changed."""
    samples = dict(signals.samples)
    name = next(iter(samples))
    samples[name] = samples[name] + (np.arange(len(samples[name])) < count)
    return replace(signals, samples=samples)
