"""A test of any structure as its TOML describes it, by its `kind`; the same table is a ``[[test]]`` of a model file."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from geometry import toml_file
from geometry.errors import BadInput
from identification import modal_table, response_functions
from identification.files import uff, uff_tests
from identification.modal_table import ModalTable
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
        raise BadInput(source=str(path), problem="it is neither a test's description nor a universal file", remedy=remedy)
    found = uff_tests.read(path)
    kinds = [kind for kind, there in ((RESPONSE_FUNCTIONS, found.functions), (MODAL_TABLE, found.modes)) if there]
    if not kinds:
        problem = "it holds neither response functions (dataset 58) nor modes (55, 2414)"
        raise BadInput(source=str(path), problem=problem, remedy="Export one of them; nodes and elements alone are no test")
    return tuple({"kind": kind, "article": article, "file": path.name} for kind in kinds)


def all_in(path: str | Path, article: str, *, gain: float = GAIN) -> tuple[ResponseFunctions | ModalTable, ...]:
    """The tests in the file `path`, each as `read` reads it; of `article` where they are a universal file's."""
    return tuple(read(path, table, gain=gain) for table in tables(path, article))


def table_of(test: ResponseFunctions | ModalTable, file: str) -> Mapping[str, Any]:
    """The table by which a model reads `test` from the universal `file` beside it."""
    kind = RESPONSE_FUNCTIONS if isinstance(test, ResponseFunctions) else MODAL_TABLE
    return {"kind": kind, "article": test.article, "file": file}
