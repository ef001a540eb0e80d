"""A test of any structure as its TOML describes it, by its `kind`; the same table is a ``[[test]]`` of a model file."""

from collections.abc import Mapping
from pathlib import Path
from typing import Any

from geometry import toml_file
from identification import modal_table, response_functions
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
    if table is None:
        table = toml_file.read(path)
        toml_file.require_format(table, source)
    toml_file.require_present(table, ("kind",), source=source)
    kind = toml_file.one_of(table["kind"], KINDS, source=source, where="kind")
    if kind == RESPONSE_FUNCTIONS:
        return response_functions.of_table({"gain": gain, "force_gain": gain, **table}, source, folder)
    return modal_table.of_table({"gain": gain, **table}, source, folder)
