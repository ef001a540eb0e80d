"""A test of any structure as its TOML or a ``[[test]]`` of a model describes it, by its `kind`; functions for other programs."""

import os
import re
from collections.abc import Callable, Mapping
from itertools import count
from pathlib import Path
from typing import Any, TypeVar

import numpy as np

from geometry import toml_file
from geometry.dynamic_mass import MOTIONS, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import Point
from identification import modal_table, response_functions
from identification.files import files, uff, uff_tests
from identification.files.files import Samples, Signals
from identification.modal_table import ModalTable
from identification.quality import NORMAL_95
from identification.response_functions import GAIN, ResponseFunctions

RESPONSE_FUNCTIONS, MODAL_TABLE = KINDS = ("response-functions", "modal-table")
"""What a test may be."""


def read(path: str | Path, table: Mapping[str, Any] | None = None, *, gain: float = GAIN) -> ResponseFunctions | ModalTable:
    """The test in the file `path`; or that of a `table` that stands in it, whose files lie beside it.

    Parameters
    ----------
    gain : relative standard deviation of the gains of sensors and force cell of which the test says nothing

    Raises
    ------
    BadInput : whatever is wrong with it or with a file that it names.
    OSError : a file cannot be read.
    """
    source, folder = str(path), Path(path).parent
    table = _described(path) if table is None else table
    toml_file.require_present(table, ("kind",), source=source)
    kind = toml_file.one_of(table["kind"], KINDS, source=source, where="kind")
    if kind == RESPONSE_FUNCTIONS:
        return response_functions.of_table({"gain": gain, "force_gain": gain, **table}, source, folder)
    return modal_table.of_table({"gain": gain, **table}, source, folder)


def _described(path: str | Path) -> Mapping[str, Any]:
    table = toml_file.read(path)
    toml_file.require_format(table, str(path))
    return table


def tables(path: str | Path, article: str) -> tuple[Mapping[str, Any], ...]:
    """By which tables the tests in the file `path` are read: its own, or those of a universal file, which stands for itself.

    Parameters
    ----------
    article : of which a test is that does not say so

    Raises
    ------
    BadInput : neither; no test in it; no universal file that can be read.
    OSError : it cannot be read.
    """
    path = Path(path)
    if path.suffix.lower() in (".toml", ".json"):
        return ({"article": article, **_described(path)},)
    if not uff.is_universal(path):
        toml_file.require_no_other(path)
        remedy = 'Describe the test: kind = "response-functions" or "modal-table", article, file and places; docs/model-file.md'
        raise BadInput(str(path), "", "it is neither a test's description nor a universal file", remedy)
    found = uff_tests.read(path)
    kinds = [kind for kind, there in ((RESPONSE_FUNCTIONS, found.functions), (MODAL_TABLE, found.modes)) if there]
    if not kinds:
        problem = "it holds neither response functions (dataset 58) nor modes (55, 2414)"
        raise BadInput(str(path), "", problem, "Export one of them; nodes and elements alone are no test")
    return tuple({"kind": kind, "article": article, "file": path.name} for kind in kinds)


def all_in(path: str | Path, article: str, *, gain: float = GAIN) -> tuple[ResponseFunctions | ModalTable, ...]:
    """The tests in the file `path`, each as `read` reads it; of `article` where they are a universal file's."""
    return tuple(read(path, table, gain=gain) for table in tables(path, article))


def table_of(test: ResponseFunctions | ModalTable, file: str) -> Mapping[str, Any]:
    """The table by which a model reads `test` from the universal `file` beside it."""
    kind = RESPONSE_FUNCTIONS if isinstance(test, ResponseFunctions) else MODAL_TABLE
    return {"kind": kind, "article": test.article, "file": file}


def seen(file: str | Path, out: Path, where: str) -> str:
    """What a file at `out` calls `file`, which `where` names and which must lie in the folder of `out` or below."""
    found = os.path.relpath(file, out.resolve().parent)
    if Path(found).parts[:1] == ("..",):
        problem = f"{file} does not lie in {out.resolve().parent} or below"
        raise BadInput(where, "", problem, "Write what names it beside its data")
    return found.replace(os.sep, "/")


def moved(table: Mapping[str, Any], source: str, out: Path) -> dict[str, Any]:
    """The `table` of a test in the file `source` as it stands in the model file `out`.

    Raises
    ------
    BadInput : a file of it does not lie in the folder of `out` or below.
    """

    def renamed(value: Any) -> Any:
        if isinstance(value, str):
            return value if value.startswith("$") else seen(Path(source).resolve().parent / value, out, source)
        if isinstance(value, list):
            return [renamed({"path": one} if isinstance(one, str) else one) for one in value]
        return {key: renamed(one) if key in ("file", "path") else one for key, one in value.items()}

    tabled = {key for key in ("shapes", "frequencies") if isinstance(table.get(key), dict)}
    return {key: renamed(one) if key in tabled | {"file", "files", "before"} else one for key, one in table.items()}


def text(table: Mapping[str, Any], of_float: Callable[[float], str] = "{:.9g}".format) -> str:
    """A test as it stands in a model file, numbers as `of_float` writes them."""
    return "\n".join(["[[test]]", *(f"{key} = {toml_file.inline(value, of_float)}" for key, value in table.items())])


# What was measured as signals for other programs: dynamic mass and response functions, each with its 95 % interval.
#
# A function ``NAME`` is complex; ``NAME_half95`` beside it is the half-width of the 95 % intervals of its real and its imaginary
# part, where noise or coherence is known. In universal files they are functions of type 4 with the degrees of freedom of response
# and reference, so that a modal program takes them as they are.

HALF = "_half95"
"""Behind the name of a function: the half-width of its interval."""

_UNITS = {"acceleration": "(m/s2)/N", "velocity": "(m/s)/N", "displacement": "m/N", "strain": "1/N"}


def of_dynamic_mass(H: DynamicMass, source: str, deviation: Array | None = None) -> Signals:
    """`H` as 36 functions, ``H_x_beta`` the load x for the motion beta; `deviation` (n, 6, 6), E|error|² is its square."""
    samples: dict[str, Samples] = {}
    labels: dict[str, str] = {}
    places: dict[str, tuple[int, int, int, int]] = {}
    for row, load in enumerate(MOTIONS):
        for column, motion in enumerate(MOTIONS):
            name = f"H_{load}_{motion}"
            labels[name] = ("kg", "kg m", "kg m2")[(row > 2) + (column > 2)]
            places[name] = (1, row + 1, 1, column + 1)
            samples[name] = H.matrix[:, row, column]
            if deviation is not None:
                samples[name + HALF] = NORMAL_95 / np.sqrt(2) * deviation[:, row, column]
    return Signals(
        source=source, samples=samples, frequency=H.frequency, labels=_with_halves(labels), places=_with_halves(places)
    )


def of_responses(test: ResponseFunctions) -> Signals:
    """Every function of `test`, ``RESPONSE_per_DRIVE``; its interval where coherence and number of averages are known.

    The relative standard deviation of a modulus is sqrt((1 - g²) / (2 n g²)) with coherence g² and n averages, and that of the
    real and imaginary part is the same share of the modulus (Bendat and Piersol, Random Data, 4th edition, table 9.6).
    """
    samples: dict[str, Samples] = {}
    places: dict[str, tuple[int, int, int, int]] = {}
    every = dict.fromkeys(one.place for one in (*test.responses, *test.drives))
    numbers = {place: int(place[5:]) for place in every if re.fullmatch("node [1-9][0-9]{0,8}", place)}
    free = (k for k in count(1) if k not in numbers.values())
    numbers |= {place: next(free) for place in every if place not in numbers}
    for r, drive in enumerate(test.drives):
        for c, response in enumerate(test.responses):
            name = f"{response.name}_per_{drive.name}"
            samples[name] = test.values[r, :, c]
            places[name] = (numbers[response.place], _code(response), numbers[drive.place], _code(drive))
            if test.coherence is not None and test.averages > 1:
                coherence = np.clip(test.coherence[r, :, c], 1e-6, 1.0)
                share = np.sqrt((1 - coherence) / (2 * test.averages * coherence))
                samples[name + HALF] = NORMAL_95 * share * np.abs(samples[name])
    labels = dict.fromkeys(places, _UNITS[test.quantity] if test.scaled else "uncalibrated")
    return Signals(
        source=test.source, samples=samples, frequency=test.frequency, labels=_with_halves(labels), places=_with_halves(places)
    )


def write(path: Path, signals: Signals) -> None:
    """Write `signals` to `path` by its ending, .csv, .unv or .uff, .h5, .mat; frequencies that ASCII cannot say go out as 58b.

    Raises
    ------
    BadInput : names that the format cannot hold.
    """
    try:
        files.write(path, signals)
    except BadInput as error:
        if path.suffix.lower() not in uff.ENDINGS or error.field != "frequency":
            raise
        uff.write(path, signals, binary=True)


_Said = TypeVar("_Said")


def _with_halves(of: Mapping[str, _Said]) -> dict[str, _Said]:
    return {name + behind: one for name, one in of.items() for behind in ("", HALF)}


def _code(point: Point) -> int:
    """Direction of dataset 58: 1, 2, 3 along x, y, z, negative against them; 0 where it is askew."""
    along = np.asarray(point.direction)
    k = int(np.argmax(np.abs(along)))
    return int(np.sign(along[k])) * (k + 1) if abs(along[k]) > 1 - 1e-9 else 0
