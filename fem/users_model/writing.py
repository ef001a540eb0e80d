"""A `Structure` or `Modes` into a file of its own, which `read` takes back to the last digit."""

from __future__ import annotations

import io
from pathlib import Path
from typing import Any

import numpy as np

from fem.modes import Modes
from fem.structure import Structure
from fem.users_model import hdf5
from geometry import atomic
from geometry.arrays import Array
from geometry.errors import BadInput

ENDINGS = (*hdf5.ENDINGS, ".npz")


def write(model: Structure | Modes, path: str | Path, name: str = "") -> None:
    """Write `model`, in SI, to `path` (.h5, .hdf5 or .npz by its ending) with its description inside; whole or not at all.

    Structural damping goes along, as the matrix that the loss factors make; the shapes of modes do not.

    Raises
    ------
    BadInput : another ending.
    """
    path = Path(path)
    if path.suffix.lower() not in ENDINGS:
        problem = f"its ending {path.suffix!r} is none of {', '.join(ENDINGS)}"
        raise BadInput(source=str(path), problem=problem, remedy="Choose one of them")
    arrays = _of_modes(model) if isinstance(model, Modes) else _of_structure(model)
    text = _description(name or path.stem, "modal" if isinstance(model, Modes) else "matrices", model.reference_point)
    save = _save_npz if path.suffix.lower() == ".npz" else _save_hdf5
    atomic.write_with(path, lambda temporary: save(temporary, arrays, text))


def _of_modes(modes: Modes) -> dict[str, Any]:
    names = ("frequency", "damping_ratio", "participation", "rigid_mass", "residual", "viscous", "structural")
    return {name: getattr(modes, name) for name in names}


def _of_structure(structure: Structure) -> dict[str, Any]:
    arrays = {"rigid": structure.rigid, "held": structure.held}
    if len(structure.points):
        arrays |= {"points": structure.points, "translations": structure.translations}
    matrices = {"stiffness": structure.stiffness, "mass": structure.mass}
    damped = [factor * structure.part_stiffness[part] for part, factor in structure.loss_factors.items() if factor]
    if damped:
        matrices["structural"] = sum(damped[1:], damped[0])
    return arrays | {key: array for name, matrix in matrices.items() for key, array in _compressed(name, matrix).items()}


def _compressed(name: str, matrix: Any) -> dict[str, Any]:
    from scipy.sparse import csr_array

    A = csr_array(matrix)
    A.sum_duplicates()
    parts = {"data": A.data, "indices": A.indices, "indptr": A.indptr, "shape": np.array(A.shape)}
    return {f"{name}/{part}": array for part, array in parts.items()}


def _description(name: str, kind: str, point: Array) -> str:
    metres = ", ".join(f'"{value!r} m"' for value in point.tolist())
    title = "".join(letter for letter in name if letter.isprintable() and letter not in '"\\')
    return f'format = 1\n\n[fe_model]\nname = "{title}"\nkind = "{kind}"\nunits = "m-kg-N-s"\nreference_point = [{metres}]\n'


def _save_npz(path: Path, arrays: dict[str, Any], text: str) -> None:
    packed = io.BytesIO()  # numpy adds its ending to the name of a path that lacks it
    np.savez_compressed(packed, allow_pickle=False, **arrays, description=np.array(text))
    path.write_bytes(packed.getvalue())


def _save_hdf5(path: Path, arrays: dict[str, Any], text: str) -> None:
    import h5py

    with h5py.File(path, "w") as file:
        file.attrs["description"] = text
        for name, array in arrays.items():  # checksums: a damaged file is refused, not believed
            file.create_dataset(name, data=array, **({"fletcher32": True} if np.size(array) else {}))
