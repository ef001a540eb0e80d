"""From a path to `Structure` or `Modes`: the data, the text that describes them, and the checks of both."""

import hashlib
import io
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.damping import Damping
from fem.mesh import description as mesh_description
from fem.mesh import model as mesh_model
from fem.modes import Modes
from fem.structure import Structure
from fem.user_model import frame, matrices, nastran
from fem.user_model.description import LARGEST_BYTES, TABLE, TOO_LARGE, Contents, Description, parse, read_description
from fem.user_model.parts import require_name
from fem.user_model.units import SI, UnitSystem
from geometry import atomic, npz, toml_file
from geometry.errors import BadInput

# Arrays from HDF5. Only what lies in the file itself: no links to other files, and nothing that is declared but not there.

FRAME = "frame"
"""Kind of a model that is all in its description."""

HDF5_ENDINGS = (".h5", ".hdf5", ".hdf")

DEEPEST = 2
"""Groups within each other: a matrix, and in it a part that is sparse."""

_WRITE_AGAIN = "Write it again; it may be cut short or damaged"
_OWN_DATA = "Copy what it points to into this file"


def read_hdf5(path: Path) -> Contents:
    """The datasets in `path`, those of groups as ``group/name``.

    Raises
    ------
    BadInput : no HDF5, cut short or damaged, a link or storage outside the file, a dataset that is declared but was never
        written, or more than `LARGEST_BYTES`.
    """
    import h5py

    source = str(path)
    try:
        with h5py.File(path, "r") as file:
            found = _datasets(file, "", source)
            total = sum(int(dataset.size or 0) * dataset.dtype.itemsize for dataset in found.values())
            if total > LARGEST_BYTES:
                problem = f"its datasets would take {total / 2**30:.3g} GiB, more than {LARGEST_BYTES / 2**30:.3g}"
                raise BadInput(source=source, problem=problem, remedy=TOO_LARGE)
            arrays = {name: np.asarray(dataset[()]) for name, dataset in found.items()}
            text = None
            if "description" in file.attrs:  # told by its type first: the library fails on a damaged one in ways nobody can catch
                if h5py.check_string_dtype(file.attrs.get_id("description").dtype) is None:
                    raise BadInput(source=source, field="description", problem="is no text", remedy=_WRITE_AGAIN)
                text = file.attrs["description"]
    except BadInput:
        raise
    except Exception as error:  # h5py raises OSError, KeyError, RuntimeError, ValueError and more on damaged bytes
        problem = f"it cannot be read as HDF5: {str(error).splitlines()[0] if str(error) else type(error).__name__}"
        raise BadInput(source=source, problem=problem, remedy=_WRITE_AGAIN) from None
    if isinstance(text, bytes):
        text = text.decode("utf-8", errors="replace")
    return Contents(source=source, arrays=arrays, description=text if isinstance(text, str) else None)


def _datasets(group: Any, prefix: str, source: str) -> dict[str, Any]:
    """All datasets below `group`, by path. Groups within groups are not ours; links are looked at before they are followed."""
    import h5py

    found: dict[str, Any] = {}
    for key in group:
        name, link = f"{prefix}{key}", group.get(key, getlink=True)
        if not isinstance(link, h5py.HardLink):
            target = getattr(link, "filename", None) or getattr(link, "path", "")
            raise BadInput(source=source, field=name, problem=f"is a link to {target!r}, which is not followed", remedy=_OWN_DATA)
        entry = group[key]
        if isinstance(entry, h5py.Dataset):
            # `entry`, when all of it lies in the file
            if entry.external or entry.is_virtual:
                raise BadInput(source=source, field=name, problem="has its numbers in another file", remedy=_OWN_DATA)
            if entry.dtype.kind not in "fiuc":
                problem = f"must hold numbers, found the type {entry.dtype}"
                raise BadInput(source=source, field=name, problem=problem, remedy="Write it as 64-bit floating point")
            if entry.size and entry.id.get_storage_size() == 0:
                shape = " x ".join(map(str, entry.shape)) or "1"
                problem = f"declares {shape} values, but none was ever written"
                raise BadInput(source=source, field=name, problem=problem, remedy=_WRITE_AGAIN)
            found[name] = entry
        elif name.count("/") >= DEEPEST:
            problem = "is a group deeper than any of a model: stiffness/PART/data is as deep as they go"
            raise BadInput(source=source, field=name, problem=problem, remedy="Put the datasets at the root of the file")
        elif isinstance(entry, h5py.Group):
            found |= _datasets(entry, f"{name}/", source)
    return found


def read_npz(path: Path) -> Contents:
    """The arrays in `path`.

    Raises
    ------
    BadInput : as `geometry.npz.read`.
    """
    arrays = npz.read(path, LARGEST_BYTES)
    text = arrays.pop("description", None)
    return Contents(source=str(path), arrays=arrays, description=None if text is None else str(text))


DATA_ENDINGS = (*HDF5_ENDINGS, ".npz", *nastran.ENDINGS)


def is_model(path: str | Path) -> bool:
    """Whether `path` can be meant as a model of a user: a data file by its ending, or a TOML file with a table [fe_model]."""
    path = Path(path)
    if path.suffix.lower() in DATA_ENDINGS:
        return True
    return path.suffix.lower() == ".toml" and path.is_file() and toml_file.holds(path, TABLE)


@dataclass(frozen=True, eq=False, kw_only=True)
class UsersModel:
    """All that a user's model says.

    Attributes
    ----------
    name : as described, else that of the file
    model : K and M as `Structure`, or modal data as `Modes`
    damping : of a structure whose file says it (loss factors, viscous matrix); None when it does not, and for modal data
    units : of the file; where they are not known, so are those of the structure
    notes : what must be known of it, sentences
    """

    name: str
    model: Structure | Modes
    damping: Damping | None = None
    units: UnitSystem = SI
    notes: tuple[str, ...] = ()


def read(path: str | Path) -> Structure | Modes:
    """The model in `path`: a description (TOML), or the data themselves with a description inside or beside them.

    K and M become a `Structure` whose base is the interface, modal data become `Modes`, both in SI about the reference point.

    Raises
    ------
    BadInput : whatever is wrong with it: the file, the field, what was found and what to do.
    """
    return load(path).model


def load(path: str | Path) -> UsersModel:
    """As `read`, with the name and the damping that the user gave."""
    path = Path(path)
    if kind := described_whole(path):
        if kind == FRAME:
            told = toml_file.read(path)[TABLE]
            name, made = str(told.get("name", path.stem)), frame.structure(told, str(path))
        else:
            name, made = mesh_model.load(path)
        factors = made.loss_factors
        return UsersModel(name=name, model=made, damping=Damping(loss_factors=factors) if factors else None)
    contents, description = opened(path)
    if description.kind == "modal":
        return UsersModel(name=description.name, model=matrices.modes(contents, description), units=description.units)
    structure, viscous, said = matrices.structure(contents, description)
    damped = viscous is not None or bool(structure.loss_factors)
    damping = Damping(loss_factors=structure.loss_factors, viscous=viscous) if damped else None
    return UsersModel(name=description.name, model=structure, damping=damping, units=description.units, notes=tuple(said))


def described_whole(path: str | Path) -> str:
    """The kind of a model whose matrices are made here, of what the TOML file at `path` says; empty for others."""
    path = Path(path)
    if path.suffix.lower() != ".toml":
        return ""
    told = toml_file.require_table(toml_file.read(path).get(TABLE, {}), source=str(path), where=TABLE)
    kind = str(told.get("kind", ""))
    return kind if kind == FRAME or mesh_description.described(path) else ""


def opened(path: str | Path) -> tuple[Contents, Description]:
    """The arrays of the model in `path` and what describes them, before anything is made of them.

    Raises
    ------
    BadInput : no such file, not readable, without a description, or one that is not understood.
    """
    path = Path(path)
    if path.suffix.lower() == ".toml":
        description = read_description(path)
        if description.file is None:
            problem = f"is missing: the data are {', '.join(DATA_ENDINGS)}"
            raise BadInput(source=str(path), field="fe_model.file", problem=problem, remedy='Add file = "..."')
        return _contents(description.file, description), description
    _require_file(path)
    if path.suffix.lower() in nastran.ENDINGS:
        description = _beside(path)
        return _contents(path, description), description
    contents = read_npz(path) if path.suffix.lower() == ".npz" else read_hdf5(path)
    if contents.description is None:
        description = _beside(path)
        _require_digest(path, description)
    else:
        source = f"{path}, description"
        description = parse(toml_file.parse(contents.description, source), source, path)
    _require_not_nastrans(path, description)
    return contents, description


def _beside(path: Path) -> Description:
    """The description of the same name beside the data file `path`."""
    sidecar = path.with_suffix(".toml")
    if not sidecar.is_file():
        problem = "says nothing of its units, reference point and interface"
        remedy = f"Write them into {sidecar.name} beside it; docs/own-model.md shows how"
        raise BadInput(source=str(path), problem=problem, remedy=remedy)
    description = read_description(sidecar)
    if description.file is not None and description.file.resolve() != path.resolve():
        problem = f"is {description.file.name}, not {path.name}"
        raise BadInput(source=str(sidecar), field="fe_model.file", problem=problem, remedy=f"Read {sidecar.name} or correct it")
    return description


def _contents(path: Path, description: Description) -> Contents:
    _require_file(path)
    _require_digest(path, description)
    if path.suffix.lower() in nastran.ENDINGS:
        return nastran.read(path, description)
    _require_not_nastrans(path, description)
    return read_npz(path) if path.suffix.lower() == ".npz" else read_hdf5(path)


def _require_not_nastrans(path: Path, description: Description) -> None:
    if description.grids is not None or description.matrices:
        field = "fe_model.grids" if description.grids is not None else "fe_model.matrices"
        problem = f"is for Nastran files, and {path.name} is none"
        raise BadInput(source=description.source, field=field, problem=problem, remedy="Leave it out")


def _require_digest(path: Path, description: Description) -> None:
    """What mechanics cannot tell, such as one wrong rotary inertia, a checksum can."""
    if not description.sha256:
        return
    with path.open("rb") as file:
        found = hashlib.file_digest(file, "sha256").hexdigest()
    if found != description.sha256:
        problem = f"is not that of {path.name}, which has {found}"
        remedy = "Copy the file again; if it was changed on purpose, write its new sum here"
        raise BadInput(source=description.source, field="fe_model.sha256", problem=problem, remedy=remedy)


def _require_file(path: Path) -> None:
    ending = path.suffix.lower()
    if ending not in DATA_ENDINGS:
        problem = f"its ending {ending!r} is none of {', '.join(DATA_ENDINGS)}, .toml"
        raise BadInput(source=str(path), problem=problem, remedy="Convert it, or correct its ending")
    if not path.is_file():
        problem = "it is a folder" if path.is_dir() else "there is no such file"
        raise BadInput(source=str(path), problem=problem, remedy="Check the path")
    size = path.stat().st_size
    if size > LARGEST_BYTES:
        problem = f"it has {size / 2**30:.3g} GiB, more than {LARGEST_BYTES / 2**30:.3g}"
        raise BadInput(source=str(path), problem=problem, remedy="Reduce the model first (Craig-Bampton)")


# A `Structure` or `Modes` into a file of its own, which `read` takes back to the last digit.

WRITTEN_ENDINGS = (*HDF5_ENDINGS, ".npz")


def write(model: Structure | Modes, path: str | Path, name: str = "", units: UnitSystem = SI) -> None:
    """Write `model` to `path` (.h5, .hdf5 or .npz by its ending) with its description inside; whole or not at all.

    Parts with their loss factors and tolerances, places, supports and joints go along; the shapes of modes do not.

    Parameters
    ----------
    units : SI, or those of a structure that was read in units that are not known

    Raises
    ------
    BadInput : another ending, other units, a name that a description could not call.
    """
    from scipy.sparse import csr_array

    path = Path(path)
    if path.suffix.lower() not in WRITTEN_ENDINGS:
        problem = f"its ending {path.suffix!r} is none of {', '.join(WRITTEN_ENDINGS)}"
        raise BadInput(source=str(path), problem=problem, remedy="Choose one of them")
    if units.known and units.name != SI.name:
        problem = f"the arrays of a structure are in SI, found {units.name}"
        raise BadInput(source=str(path), field="units", problem=problem, remedy=f"Leave it out, or give {SI.name}")
    if isinstance(model, Modes):
        fields = ("frequency", "damping_ratio", "participation", "rigid_mass", "residual", "viscous", "structural")
        arrays: dict[str, Any] = {field: getattr(model, field) for field in fields}
    else:
        arrays = {"rigid": model.rigid, "held": model.held}
        if (moving := (model.translations >= 0).all(axis=1)).any():
            arrays |= {"points": model.points[moving], "translations": model.translations[moving]}
            arrays |= {"rotations": model.rotations[moving]} if len(model.rotations) else {}
        matrices: dict[str, Any] = {} if model.part_stiffness else {"stiffness": model.stiffness}
        matrices |= {} if model.part_mass else {"mass": model.mass}
        shares = {"stiffness": model.part_stiffness, "mass": model.part_mass, "places": model.places}
        shares |= {"membrane": {name: one for name, (one, _) in model.sections.items()}}
        shares |= {"bending": {name: one for name, (_, one) in model.sections.items()}}
        for kind, named in shares.items():
            for part, matrix in named.items():
                require_name(part, str(path), kind)
                matrices[f"{kind}/{part}"] = matrix
        for matrix_name, matrix in matrices.items():
            A = csr_array(matrix)
            A.sum_duplicates()
            pieces = {"data": A.data, "indices": A.indices, "indptr": A.indptr, "shape": np.array(A.shape)}
            arrays |= {f"{matrix_name}/{piece}": array for piece, array in pieces.items()}
    metres = ", ".join(f'"{value!r} m"' for value in model.reference_point.tolist())
    title = "".join(letter for letter in name or path.stem if letter.isprintable() and letter not in '"\\')
    kind = "modal" if isinstance(model, Modes) else "matrices"
    text = f'format = 1\n\n[fe_model]\nname = "{title}"\nkind = "{kind}"\nunits = "{units.name}"\n'
    text += f"reference_point = [{metres}]\n" if units.known else ""
    if isinstance(model, Structure):  # how it is held, what its joints are, and what is known of its parts
        support = "base" if len(model.held) else "ground" if model.grounded else "free"
        text += f'support = "{support}"\n'
        supports = ", ".join(f'"{name}"' for name in model.supports)
        text += f"supports = [{supports}]\n" if supports else ""
        text += "".join(f'joints."{name}" = {{}}\n' for name in model.joints)
        for part in dict.fromkeys((*model.part_stiffness, *model.part_mass)):
            loss, tolerance = model.loss_factors.get(part), model.part_tolerances.get(part, {})
            if loss is None and not tolerance:
                continue
            text += f'\n[fe_model.parts."{part}"]\n' + ("" if loss is None else f"loss_factor = {float(loss)!r}\n")
            listed = ", ".join(f"{key} = {float(value)!r}" for key, value in tolerance.items())
            text += f"tolerance = {{ {listed} }}\n" if tolerance else ""
    if path.suffix.lower() != ".npz":
        atomic.write_with(path, lambda temporary: _save_hdf5(temporary, arrays, text))
        return
    packed = io.BytesIO()  # numpy adds its ending to the name of a path that lacks it
    np.savez_compressed(packed, allow_pickle=False, **arrays, description=np.array(text))
    atomic.write_with(path, lambda temporary: temporary.write_bytes(packed.getvalue()))


def _save_hdf5(path: Path, arrays: dict[str, Any], text: str) -> None:
    import h5py

    with h5py.File(path, "w", libver=("v110", "v110")) as file:
        file.attrs["description"] = np.bytes_(text.encode())
        for name, array in arrays.items():  # checksums: a damaged file is refused, not believed
            file.create_dataset(name, data=array, **({"fletcher32": True} if np.size(array) else {}))
