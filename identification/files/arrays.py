"""Named arrays of any program's results: NumPy's .npz, MATLAB, HDF5 and JSON. Nothing is unpickled or run."""

import json
from collections.abc import Collection
from pathlib import Path
from typing import Any

import numpy as np

from geometry import npz
from geometry.errors import BadInput
from identification.files import files, hdf5, mat, text_table
from identification.files.files import DAMAGED, LARGEST_BYTES, Samples

ENDINGS = (".npz", *mat.ENDINGS, *hdf5.ENDINGS, ".json")

SAVE = "Save the arrays alone, as with numpy.savez(file, Fn=result.Fn, Xi=result.Xi, Phi=result.Phi)"


def read(path: Path, wanted: Collection[str]) -> dict[str, Samples]:
    """Those of the arrays `wanted` that `path` holds, by name, real or complex, of as many dimensions as they have there.

    An array that is stored as Python's None, which programs write for what they do not know, is not there.

    Raises
    ------
    BadInput : an ending that is not known, a pickle, damage, or an array of something else than numbers.
    """
    files.require_file(path)
    source, ending = str(path), path.suffix.lower()
    if ending not in ENDINGS:
        pickled = ending in (".pkl", ".pickle", ".joblib")
        problem = "a pickle can run programs, and is not read" if pickled else f"ends in none of {', '.join(ENDINGS)}"
        raise BadInput(source, "file", problem, SAVE)
    found: dict[str, Any]
    if ending == ".npz":
        found = npz.read(path, LARGEST_BYTES, wanted)
    elif ending == ".json":
        found = _of_json(path, wanted)
    elif ending in mat.ENDINGS:
        found = {name: values for name, values in mat.variables(path).items() if name in wanted}
    else:
        with hdf5.opened(path) as file:
            found = {name: hdf5.values(hdf5.dataset(file, name, source), name, source) for name in wanted if name in file}
    whole = {}
    for name, values in found.items():
        numbers = np.asarray(values)
        if numbers.dtype.kind not in "fciu":
            raise BadInput(source, name, f"must be an array of numbers, found the type {numbers.dtype}", SAVE)
        whole[name] = numbers.astype(np.complex128 if numbers.dtype.kind == "c" else np.float64)
    return whole


def _of_json(path: Path, wanted: Collection[str]) -> dict[str, Any]:
    """Lists of numbers, of texts such as "0.5+0.1j", or ``{ "real": ..., "imag": ... }`` of lists."""
    source = str(path)
    try:
        table = json.loads(path.read_text(encoding="utf-8"))
    except (ValueError, RecursionError) as error:
        raise BadInput(source, "", f"it cannot be read as JSON: {error}", DAMAGED) from None
    if not isinstance(table, dict):
        raise BadInput(source, "", "it must be an object with an array a name", SAVE)

    def made(stated: Any, name: str) -> Samples:
        if isinstance(stated, dict) and set(stated) == {"real", "imag"}:
            real, imaginary = (made(stated[part], name) for part in ("real", "imag"))
            if real.shape == imaginary.shape:
                return files.as_complex(real, imaginary)
        try:
            numbers = np.array(stated)
            if numbers.dtype.kind == "U" and numbers.size:
                numbers = np.array([text_table.as_number(str(one)) for one in numbers.ravel()]).reshape(numbers.shape)
            if numbers.dtype.kind in "fciu":
                return numbers
        except (ValueError, OverflowError):  # rows of unequal length, a number beyond all bounds
            pass
        raise BadInput(source, name, f"must be lists of numbers of one length, found {json.dumps(stated):.60}", SAVE)

    return {name: made(table[name], name) for name in wanted if table.get(name) is not None}
