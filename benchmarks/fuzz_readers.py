"""Every reader of campaigns, tests and structures on damaged files: ``python -m benchmarks.fuzz_readers [COUNT] [NAME]``.

A damaged file is refused in words, or read as it was. A sample may come out changed only where damage hit its own digits: at most
one a byte that was replaced, at most one where the file was cut, and none where the file carries checksums. Any other exception
than a refusal is a failure, and so is a reader that does not come back. Of tests of structures only these two are.
"""

from __future__ import annotations

import json
import signal
import subprocess
import sys
import tempfile
from collections import Counter
from collections.abc import Callable, Iterator, Mapping
from contextlib import contextmanager
from dataclasses import dataclass
from functools import partial
from pathlib import Path
from types import FrameType
from typing import Any, TypeVar

import numpy as np

from fem.mesh import deck
from fem.structure import Structure
from fem.user_model import reading
from geometry import toml_file
from geometry.errors import BadInput
from geometry.sensors import Channel, ChannelTable, Place
from geometry.toml_file import inline
from identification import test_file
from identification.campaign import Campaign, Excitation, Processing, Recording, Run, recording
from identification.campaign_file import Problems, parse, text
from identification.files import csv, files, hdf5, mat, uff
from identification.files.files import Signals
from identification.modal_table import ModalTable
from identification.response_functions import ResponseFunctions
from tools.pages import blocks

PATIENCE = 20
"""Seconds after which a reader counts as hanging."""

Read = TypeVar("Read")

COUNT = 10_000

RARE = 1e-3
"""Share of damaged files without any checksum in which other numbers may be read unseen."""

SAMPLES = 40
RATE = 564.0

Write = Callable[[Path, Signals], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Target:
    """A reader and a file for it.

    Attributes
    ----------
    name : what is damaged
    ending : of the file
    write : writes the whole file
    spectra : whether it holds spectra
    checked : whether the file carries checksums, so that no damage may change a sample
    unguarded : whether its structure carries none, so that an address may point at other numbers unseen: rare, and counted apart
    """

    name: str
    ending: str
    write: Write
    spectra: bool = False
    checked: bool = False
    unguarded: bool = False


@dataclass(frozen=True, eq=False, kw_only=True)
class Mutant:
    """A damaged file: its bytes, how many were replaced (0 where it was cut or shifted), and whether it was."""

    content: bytes
    replaced: int


def table() -> ChannelTable:
    """Four channels, two of them of names that formats have to think about."""
    named = (
        ("cover-1x", "acceleration", "cover"),
        ("fmd z,1", "force", "fmd"),
        ("fmd-x12", "force", "fmd"),
        ("m", "moment", "fmd"),
    )
    place = Place(position=np.array([0.1, 0.2, 0.0]), direction=np.array([0.0, 0.0, 1.0]))
    return ChannelTable(channels=tuple(Channel(name=n, quantity=q, group=g, places=(place,)) for n, q, g in named))


def plain_names() -> ChannelTable:
    """The same with names that MATLAB has, too."""
    whole = table()
    renamed = tuple(
        Channel(name=c.name.replace(" ", "-").replace(",", ""), quantity=c.quantity, group=c.group, places=c.places)
        for c in whole.channels
    )
    return ChannelTable(channels=renamed)


def signals(names: tuple[str, ...], *, spectra: bool, seed: int = 5) -> Signals:
    """Samples of ordinary size under `names`."""
    generator = np.random.default_rng(seed)
    found = {name: generator.standard_normal(SAMPLES) * 10.0**k for k, name in enumerate(names)}
    if not spectra:
        return Signals(source="made", samples=found, sampling_rate=RATE)
    complex_ones = {name: one + 1j * generator.standard_normal(SAMPLES) for name, one in found.items()}
    return Signals(source="made", samples=complex_ones, frequency=np.asarray(4.0 + 0.05 * np.arange(SAMPLES)))


def _foreign_hdf5(path: Path, of: Signals) -> None:
    """As a plain h5py script writes it: no checksums."""
    import h5py

    with h5py.File(path, "w") as file:
        file.attrs["sampling_rate"] = of.sampling_rate
        for name, samples in of.samples.items():
            file.create_dataset(f"channels/{name}", data=samples)


def _packed_hdf5(path: Path, of: Signals) -> None:
    """The same in single precision, packed: zlib's own checksum guards the samples."""
    import h5py

    with h5py.File(path, "w") as file:
        file.attrs["sampling_rate"] = of.sampling_rate
        for name, samples in of.samples.items():
            file.create_dataset(f"channels/{name}", data=samples.astype("f4"), compression="gzip", chunks=(16,))


def write_mat_v73(path: Path, of: Signals) -> None:
    """Write `of` in version 7.3 of MATLAB, with checksums."""
    import h5py

    with h5py.File(path, "w", userblock_size=mat.V73, libver=("v110", "v110")) as file:
        for name, numbers in mat.variables_of(of, str(path)).items():
            rows = np.atleast_2d(np.asarray(numbers))  # MATLAB's n x 1 stands as 1 x n: the last index runs first here
            if np.iscomplexobj(rows):
                pairs = np.empty(rows.shape, dtype=[("real", "<f8"), ("imag", "<f8")])
                pairs["real"], pairs["imag"] = rows.real, rows.imag
                rows = pairs
            entry = file.create_dataset(name, data=rows, compression="gzip", fletcher32=True)
            entry.attrs["MATLAB_class"] = np.bytes_("double")
    text = b"MATLAB 7.3 MAT-file, written by massline".ljust(116) + b"\0" * 8 + b"\x00\x02IM"
    with path.open("r+b") as raw:
        raw.write(text)


def _plain_mat(path: Path, of: Signals) -> None:
    from scipy.io import savemat

    named = {name.replace("-", "_"): samples for name, samples in of.samples.items()}
    savemat(path, {"fs": of.sampling_rate, **named}, do_compression=False, appendmat=False)


def _binary(path: Path, of: Signals) -> None:
    uff.write(path, of, binary=True)


TARGETS = (
    Target(name="csv", ending=".csv", write=csv.write),
    Target(name="csv, spectra", ending=".csv", write=csv.write, spectra=True),
    Target(name="uff 58", ending=".uff", write=uff.write),
    Target(name="uff 58, spectra", ending=".uff", write=uff.write, spectra=True),
    Target(name="uff 58b", ending=".unv", write=_binary),
    Target(name="uff 58b, spectra", ending=".unv", write=_binary, spectra=True),
    Target(name="hdf5", ending=".h5", write=hdf5.write, checked=True),
    Target(name="hdf5, spectra", ending=".h5", write=hdf5.write, spectra=True, checked=True),
    Target(name="hdf5 by h5py", ending=".h5", write=_foreign_hdf5, unguarded=True),
    Target(name="hdf5 by h5py, packed", ending=".h5", write=_packed_hdf5),
    Target(name="mat v5", ending=".mat", write=mat.write, checked=True),
    Target(name="mat v5, spectra", ending=".mat", write=mat.write, spectra=True, checked=True),
    Target(name="mat v5, not packed", ending=".mat", write=_plain_mat),
    Target(name="mat v7.3", ending=".mat", write=write_mat_v73, checked=True),
)


def mutants(content: bytes, count: int, seed: int) -> Iterator[Mutant]:
    """`content` with one byte or five replaced, cut short, with a stretch missing, or with a stretch twice; from `seed`."""
    generator = np.random.default_rng([2026, seed])
    for _ in range(count):
        data = bytearray(content)
        a, b = sorted(generator.integers(0, len(data), 2).tolist())
        kind = int(generator.integers(0, 6))
        if kind < 3:
            places = generator.integers(0, len(data), 5 if kind == 2 else 1)
            for place in places:
                data[place] = int(generator.integers(0, 256)) if kind else int(generator.choice(list(b"0123456789.,-+eE \n")))
            yield Mutant(content=bytes(data), replaced=len(places))
        elif kind == 3:
            yield Mutant(content=bytes(data[:b]), replaced=0)
        else:
            length = int(generator.integers(1, 60))
            tail = data[min(a + length, len(data)) :] if kind == 4 else data[a : a + length] + data[a:]
            yield Mutant(content=bytes(data[:a] + tail), replaced=0)


def attempted(read: Callable[[], Read], refusals: tuple[type[Exception], ...] = (BadInput,)) -> tuple[Read | None, str]:
    """What `read` gives and an empty word; or None and what became of it: "refused" by one of `refusals`, else what failed."""
    try:
        with patience(PATIENCE):
            return read(), ""
    except refusals:
        return None, "refused"
    except TimeoutError:
        return None, "FAILED: hangs"
    except Exception as error:  # that is what is looked for
        return None, f"FAILED: {type(error).__name__}: {error}"


def judged(target: Target, whole: Recording, channels: ChannelTable, path: Path, mutant: Mutant) -> str:
    """What became of `mutant`: "refused", "read", "digits" or "warned" where damage was to digits, else what went wrong."""
    path.write_bytes(mutant.content)
    answer, failed = attempted(lambda: recording(files.read(path), channels, "campaign.toml"))
    if answer is None:
        return failed
    found, problems = answer
    if found is None:
        return "refused" if problems else "FAILED: neither read nor refused"
    changed = _changes(whole, found)
    allowed = 0 if target.checked else max(mutant.replaced, 1)
    if changed > allowed and found.warnings:
        return "warned"
    if changed > allowed:
        return "other numbers" if target.unguarded else f"FAILED: {changed} values changed without a word"
    return "digits" if changed else "read"


def judged_toml(whole: Campaign, mutant: Mutant) -> str:
    """The same for ``campaign.toml``: lines that say something else, of those that were not touched."""
    problems = Problems()

    def read() -> tuple[Campaign | None]:
        return (parse(toml_file.parse(mutant.content.decode("utf-8"), "campaign.toml"), "campaign.toml", problems),)

    answer, failed = attempted(read, (BadInput, UnicodeDecodeError))  # bytes that are no UTF-8 are refused by `toml_file.read`
    if answer is None:
        return failed
    (campaign,) = answer
    if campaign is None:
        return "refused" if problems.found else "FAILED: neither read nor refused"
    lines = Counter(text(whole).splitlines())
    changed = sum((Counter(text(campaign).splitlines()) - lines).values())
    if mutant.replaced and changed > mutant.replaced:
        return f"FAILED: {changed} lines changed without a word"
    return "digits" if changed else "read"


def campaign() -> Campaign:
    """A description with everything in it that can be."""
    return Campaign(
        title='a "title"',
        article="fmd+clumod-1",
        hardware="fmd-A/sensors-2002",
        notes="two\nlines",
        table=table(),
        runs=(
            Run(
                name="x", file="x.h5", axis="x", excitation=Excitation(kind="sine-sweep", figures={"start_hz": 4.0, "level": 2.5})
            ),
            Run(name="all", file="all.uff"),
        ),
        processing=Processing(method="peak-reference-hold"),
    )


def run(target: Target, count: int, folder: Path, seed: int = 1) -> Counter[str]:
    """What became of `count` mutants of the file of `target`."""
    channels = plain_names() if target.ending == ".mat" else table()
    path = folder / f"whole{target.ending}"
    target.write(path, signals(channels.names, spectra=target.spectra))
    whole, problems = recording(files.read(path), channels, "campaign.toml")
    if whole is None:
        raise problems[0]
    damaged = folder / f"damaged{target.ending}"
    return Counter(judged(target, whole, channels, damaged, one) for one in mutants(path.read_bytes(), count, seed))


# Structures: matrices and meshes in every format, of two parts each.

BLOCKS = """
import gmsh, sys
gmsh.initialize(interruptible=False)
gmsh.option.setNumber("General.Terminal", 0)
occ = gmsh.model.occ
foot, wall = occ.addBox(0, 0, 0, 100, 60, 40), occ.addBox(0, 0, 40, 40, 60, 60)
occ.fragment([(3, foot)], [(3, wall)])
occ.synchronize()
for tag, name in ((foot, "foot"), (wall, "wall")):
    gmsh.model.addPhysicalGroup(3, [tag], name=name)
for key, value in {"Mesh.MeshSizeMin": 80, "Mesh.MeshSizeMax": 100, "Mesh.SaveGroupsOfElements": 1}.items():
    gmsh.option.setNumber(key, value)
gmsh.model.mesh.generate(3)
gmsh.model.mesh.setOrder(2)
for path in sys.argv[1:]:
    gmsh.write(path)
"""

STEEL = 'material = "steel"'

MATRICES = {"npz": "bracket.npz", "h5": "bracket.h5", "op4": "bracket.op4", "pch": "bracket.pch"}
MESHES = ("inp", "bdf", "unv", "msh", "med")


def structures(folder: Path) -> dict[str, tuple[Path, Path]]:
    """By name of the format the file that is damaged, and what is read."""
    subprocess.run([sys.executable, "-P", "examples/own_model.py", str(folder)], check=True, capture_output=True)
    made = {}
    for name, file in MATRICES.items():
        described = folder / f"bracket-{name}.toml"
        made[name] = folder / file, described if described.exists() else folder / file
    made["description of matrices"] = folder / "bracket-op4.toml", folder / "bracket-op4.toml"
    subprocess.run([sys.executable, "-c", BLOCKS, *(str(folder / f"blocks.{one}") for one in MESHES)], check=True)
    for ending in MESHES:
        described = folder / f"{ending}-blocks.toml"
        foot, wall = ("1", "2") if ending == "bdf" else ("foot", "wall")
        described.write_text(
            f'format = 1\n[fe_model]\nkind = "mesh"\nunits = "mm"\nfile = "blocks.{ending}"\nsupport = "free"\n'
            f'places = {{ tip = ["40 mm", "60 mm", "100 mm"] }}\n'
            f"[fe_model.parts.{foot}]\n{STEEL}\n[fe_model.parts.{wall}]\n{STEEL}\n",
            encoding="utf-8",
        )
        made[ending] = folder / f"blocks.{ending}", described
    made["description of a mesh"] = folder / "inp-blocks.toml", folder / "inp-blocks.toml"
    shelf = folder / "shelf.bdf"
    made["deck"] = shelf, shelf
    (block,) = (one for one in blocks(Path("docs/own-model.md")) if one.language.endswith(".bdf"))
    shelf.write_text(block.text, encoding="utf-8")
    return made


def run_structure(damaged: Path, described: Path, count: int, seed: int = 1) -> Counter[str]:
    """What became of `count` mutants of the file `damaged`, which `described` reads."""
    content = damaged.read_bytes()
    whole = _numbers(described)
    found = Counter(_judged_structure(damaged, described, whole, one) for one in mutants(content, count, seed))
    damaged.write_bytes(content)
    return found


def _judged_structure(damaged: Path, described: Path, whole: tuple[float, ...], mutant: Mutant) -> str:
    damaged.write_bytes(mutant.content)
    found, failed = attempted(lambda: _numbers(described))
    if found is None:
        return failed
    if not np.all(np.isfinite(found)):
        return "FAILED: numbers that are none"
    if len(found) == len(whole) and np.allclose(found, whole, rtol=1e-9, atol=0):
        return "read"
    return "digits" if mutant.replaced else "other numbers"


def _numbers(described: Path) -> tuple[float, ...]:
    """Size, sums and traces of what is read, by which two structures are told apart; of a deck, what its description says."""
    if described.suffix in toml_file.DECKS:
        written, lost = deck.described(described)
        if lost:
            raise BadInput(str(described), "", lost[0], "")
        described = described.with_suffix(".toml")
        described.write_text(written, encoding="utf-8")
    found = reading.load(described).model
    if not isinstance(found, Structure):
        return (*found.frequency.tolist(),)
    shares = [*found.part_stiffness.values(), *found.part_mass.values(), *found.places.values()]
    matrices = [found.stiffness, found.mass, *shares]
    return (
        float(found.mass.shape[0]),
        float(len(shares)),
        *(float(np.abs(one.data).sum()) for one in matrices),
        float(np.abs(found.rigid_mass).sum()),
    )


def run_toml(count: int, seed: int = 1) -> Counter[str]:
    """What became of `count` mutants of a ``campaign.toml``."""
    whole = campaign()
    return Counter(judged_toml(whole, one) for one in mutants(text(whole).encode(), count, seed))


@contextmanager
def patience(seconds: int) -> Iterator[None]:
    """TimeoutError when the block takes longer."""

    def too_long(number: int, frame: FrameType | None) -> None:
        raise TimeoutError

    before = signal.signal(signal.SIGALRM, too_long)
    signal.alarm(seconds)
    try:
        yield
    finally:
        signal.alarm(0)
        signal.signal(signal.SIGALRM, before)


# Tests of structures: functions, records and tables of modes, in every format.

POINTS = ["a:z", "b:z"]
LINES = np.arange(4.0, 24.0, 0.5)
"""[Hz] of the functions."""


def _answers() -> np.ndarray:
    """(n, 2) accelerances of two modes for a force at the first point."""
    omega, shape, poles = 2 * np.pi * LINES, np.array([[1.0, 0.6], [0.7, -1.0]]), 2 * np.pi * np.array([8.0, 17.0])
    terms = (
        -(omega[:, None] ** 2) * m[0] * m / (w**2 - omega[:, None] ** 2 + 0.02j * w * w)
        for m, w in zip(shape, poles, strict=True)
    )
    return np.asarray(sum(terms))


def _functions_by_uff(path: Path) -> None:
    import pyuff

    sets = [
        pyuff.prepare_164(units_code=1, units_description="SI", temp_mode=1, length=1.0, force=1.0, temp=1.0, temp_offset=1.0),
        pyuff.prepare_15([1, 2], [1, 1], [1, 1], [1, 1], [0.0, 0.2], [0.0, 0.0], [0.1, 0.1]),
    ]
    about: dict[str, Any] = {"binary": 0, "func_type": 4, "rsp_dir": 3, "ref_node": 1, "ref_dir": 3, "rsp_ent_name": "NONE"}
    about |= {"ref_ent_name": "NONE", "abscissa_spacing": 1, "abscissa_min": LINES[0], "abscissa_inc": 0.5, "ord_data_type": 6}
    about |= {"ordinate_spec_data_type": 12, "orddenom_spec_data_type": 13, "abscissa_spec_data_type": 18, "num_pts": len(LINES)}
    for k, H in enumerate(_answers().T):
        sets.append(pyuff.prepare_58(**about, rsp_node=k + 1, data=H, x=LINES, id1=f"{k}"))
    pyuff.UFF(str(path)).write_sets(sets, mode="overwrite")


def _modes_by_uff(path: Path) -> None:
    import pyuff

    nothing, sets = np.zeros(2), [pyuff.prepare_2411([1, 2], [1, 1], [1, 1], [1, 1], [0.0, 0.2], [0.0, 0.0], [0.1, 0.1])]
    for k, row in enumerate(np.array([[1.0, 0.6], [0.7, -1.0]])):
        of = {"analysis_type": 2, "freq": 8.0 + k, "modal_damp_vis": 0.01, "data_ch": 2, "spec_data_type": 8, "load_case": 1}
        sets.append(pyuff.prepare_55(**of, mode_n=k + 1, node_nums=[1, 2], r1=nothing, r2=nothing, r3=row))
    pyuff.UFF(str(path)).write_sets(sets, mode="overwrite")


def _functions(path: Path) -> None:
    files.write(path, Signals(source="made", frequency=LINES, samples=dict(zip("ab", _answers().T, strict=True))))


def _functions_as_text(path: Path) -> None:
    rows = [f"{f};" + ";".join(str(one).strip("()") for one in row) for f, row in zip(LINES, _answers().tolist(), strict=True)]
    path.write_text("\n".join(["f;a;b", *rows]) + "\n")


def _records(path: Path) -> None:
    """Three blows, and what a spring of little damping answers."""
    generator, time = np.random.default_rng(3), np.arange(1536) / 512
    force = 50 * np.sin(np.pi * np.clip((time % 1.0 - 0.1) / 0.01, 0, 1))
    ring = np.exp(-9 * (time % 1.0)) * np.sin(300 * (time % 1.0)) + 0.01 * generator.standard_normal(len(time))
    files.write(path, Signals(source="made", sampling_rate=512.0, samples={"force": force, "a-z": ring, "b-z": 0.5 * ring}))


def _poles(path: Path) -> None:
    found = {"Fn": np.array([8.0, 17.0]), "Xi": np.array([0.01, 0.02]), "Phi": np.array([[1.0, 0.7], [0.6, -1 + 0.1j]])}
    if path.suffix == ".npz":
        np.savez(path, Fn=found["Fn"], Xi=found["Xi"], Phi=found["Phi"])
    elif path.suffix == ".mat":
        from scipy.io import savemat

        savemat(path, found)
    elif path.suffix == ".h5":
        import h5py

        with h5py.File(path, "w") as file:
            file.update(found)
    else:
        parts = {"Phi": {"real": found["Phi"].real.tolist(), "imag": found["Phi"].imag.tolist()}}
        path.write_text(json.dumps({name: one.real.tolist() for name, one in found.items()} | parts))


def _modes_as_text(path: Path) -> None:
    path.write_text("mode,f,sd,z\n1,8.0,0.02,0.01\n2,17.0,0.05,0.02\n")


STRUCK = {"kind": "response-functions", "article": "beam", "drive": "a:z", "responses": POINTS}
HIT = {**STRUCK, "records": {"kind": "hammer", "block": 1.0}}
MODES = {"kind": "modal-table", "article": "beam"}
TEXT = {"frequencies": {"file": "test.csv", "frequency": "f", "deviation": "sd", "damping": "z"}}
TESTS: Mapping[str, tuple[str, Callable[[Path], None], Mapping[str, Any]]] = {
    "functions, text": (".csv", _functions_as_text, STRUCK),
    "functions, hdf5": (".h5", _functions, STRUCK),
    "functions, mat": (".mat", _functions, STRUCK),
    "functions, uff 58": (".uff", _functions_by_uff, {"kind": "response-functions", "article": "beam"}),
    "records, hdf5": (".h5", _records, HIT),
    "records, csv": (".csv", _records, HIT),
    "modes, uff 55": (".uff", _modes_by_uff, MODES),
    "modes, text": (".csv", _modes_as_text, {**MODES, **TEXT}),
    **{f"poles, {ending}": (ending, _poles, {**MODES, "sensors": POINTS}) for ending in (".npz", ".mat", ".h5", ".json")},
}
"""By name the ending of the file that is damaged, what writes it, and the test that it is the data of."""


def run_test(name: str, count: int, folder: Path, seed: int = 1) -> Counter[str]:
    """What became of `count` mutants of the data of a test, or of its own description where `name` is that."""
    ending, write, stated = TESTS["functions, text" if name == "test.toml" else name]
    path, table = folder / f"test{ending}", dict(stated)
    write(path)
    if "frequencies" not in table:
        table["file"] = path.name
    described = folder / "test.toml"
    lines = (f"{key} = {inline(value)}" for key, value in {"format": 1, **table}.items())
    described.write_text("\n".join(lines) + "\n", encoding="utf-8")
    whole = _measured(test_file.read(described))
    target = described if name == "test.toml" else path

    def judged(mutant: Mutant) -> str:
        target.write_bytes(mutant.content)
        found, failed = attempted(lambda: _measured(test_file.read(described)))
        if found is None:
            return failed
        same = len(found) == len(whole) and all(
            a.shape == b.shape and np.array_equal(a, b) for a, b in zip(found, whole, strict=True)
        )
        return "read" if same else "other digits"

    return Counter(judged(one) for one in mutants(target.read_bytes(), count, seed))


def _measured(test: ResponseFunctions | ModalTable) -> list[np.ndarray]:
    """All that was measured."""
    if isinstance(test, ResponseFunctions):
        return [test.frequency, np.asarray(test.values)]
    return [np.asarray(one) for one in (test.frequency, test.damping_ratio, test.shapes) if one is not None]


def _changes(whole: Recording, found: Recording) -> int:
    """How many numbers differ, as far as the record goes; a record that is longer, or another axis, is a change, too."""
    n = min(len(whole), len(found))
    parts = [np.stack([one.values[:n].real, one.values[:n].imag]) for one in (whole, found)]
    axis = (
        0.0 if whole.frequency is None or found.frequency is None else float(np.sum(whole.frequency[:n] != found.frequency[:n]))
    )
    rate = whole.sampling_rate != found.sampling_rate
    return int(np.sum(parts[0] != parts[1])) + int(axis) + int(rate) + max(len(found) - len(whole), 0)


def main(count: int, only: str = "") -> int:
    """Run every target, or those called `only`, and say what became of the mutants; 1 when one of them failed."""
    failed = 0
    with tempfile.TemporaryDirectory() as name:
        folder = Path(name)
        runs: dict[str, Callable[[], Counter[str]]] = {one.name: partial(run, one, count, folder) for one in TARGETS}
        runs["campaign.toml"] = partial(run_toml, count)
        runs |= {one: partial(run_test, one, count, folder) for one in (*TESTS, "test.toml")}
        for name, (damaged, described) in structures(folder).items():
            runs[f"structure, {name}"] = partial(run_structure, damaged, described, count)
        for name, made in runs.items():
            if not name.startswith(only):
                continue
            counts = made()
            sys.stdout.write(f"{name:36}" + ", ".join(f"{what} {number}" for what, number in counts.most_common()) + "\n")
            sys.stdout.flush()
            failed += sum(number for what, number in counts.items() if what.startswith("FAILED"))
            failed += counts["other numbers"] > RARE * count
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(int(sys.argv[1]) if len(sys.argv) > 1 else COUNT, " ".join(sys.argv[2:])))
