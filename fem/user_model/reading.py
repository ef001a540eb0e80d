"""From a path to `Structure` or `Modes`: the data, the text that describes them, and the checks of both."""

import hashlib
import io
import struct
import warnings
from collections.abc import Callable
from dataclasses import dataclass
from pathlib import Path
from typing import Any

import numpy as np

from fem.damping import Damping
from fem.mesh import description as mesh_description
from fem.mesh import model as mesh_model
from fem.modes import Modes
from fem.structure import Sparse, Structure
from fem.user_model import frame, matrices
from fem.user_model.description import LARGEST_BYTES, TABLE, TOO_LARGE, Contents, Description, parse, read_description
from fem.user_model.parts import require_name
from fem.user_model.units import SI, UnitSystem
from geometry import atomic, npz, toml_file
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.toml_file import nearest

# Nastran's matrices through pyyeti: OUTPUT4 files and punched DMIG, with grid points from bulk data.
#
# An OUTPUT4 matrix does not say what its rows are. With an ``.asm`` beside it (EXTSEOUT) the order is that of the SECONCT
# card, grid points of the boundary and modal points; with other bulk data it is the a-set of all grid points with six components
# each, ascending. Punched DMIG name their rows. Displacement coordinate systems are honoured: the rigid motions are pyyeti's.
#
# INCLUDE statements are not followed. An OUTPUT4 file is read column by column as sparse, so that no declared size takes memory.


PUNCH_ENDINGS = (".pch", ".dmig")
NASTRAN_ENDINGS = (".op4", *PUNCH_ENDINGS)

NAMES = {
    "stiffness": ("kaa", "kxx", "kgg", "k2gg", "k2pp"),
    "mass": ("maa", "mxx", "mgg", "m2gg", "m2pp"),
    "viscous": ("baa", "bxx", "bgg", "b2gg", "b2pp"),
    "structural": ("k4aa", "k4xx", "k4gg"),
}
"""Names that are looked for where the description gives none."""

_OPTIONAL = ("viscous", "structural")


def read_nastran(path: Path, description: Description) -> Contents:
    """The matrices in `path` with their degrees of freedom, in the user's units.

    Raises
    ------
    BadInput : not readable, cut short, a matrix or the grid points missing, rows that no grid point explains.
    """
    punched = path.suffix.lower() in PUNCH_ENDINGS
    found = _guarded(path, lambda: _punched(path) if punched else _output4(path))
    # Where the parts of a matrix are named, it is their sum and may be missing itself
    named, matrices = description.matrices, {}
    dispensable = {*_OPTIONAL, *(key.partition("/")[0] for key in named if "/" in key)}
    for ours in dict.fromkeys((*NAMES, *named)):
        given = named.get(ours)
        choices = (given,) if given else NAMES[ours]
        name = next((choice for choice in choices if choice in found), None)
        if name is None and (given or ours not in dispensable):
            remedy = f"{nearest(choices[0], found)}There are {', '.join(found) or 'none'}; name it by fe_model.matrices.{ours}"
            raise BadInput(str(path), choices[0].upper(), f"is missing, the {ours}", remedy)
        if name is None:
            continue
        # EXTSEOUT writes a single zero for a matrix that the model does not have
        matrix = found[name]
        empty = hasattr(matrix, "nnz") and matrix.shape == (1, 1) and not matrix.count_nonzero()
        if given or not empty or ours not in _OPTIONAL:
            matrices[ours] = matrix
    matrices, dof = _on_common_rows(matrices, path) if punched else (matrices, None)
    # The grid points are where the description says, or in an ``.asm`` or ``.bdf`` of the same name
    beside = (path.with_suffix(ending) for ending in (".asm", ".bdf", ".dat", ".blk"))
    grids = description.grids or next((file for file in beside if file.is_file()), None)
    if grids is None:
        problem = "is missing, and there is no .asm, .bdf, .dat or .blk of the same name: the matrices have no coordinates"
        raise BadInput(description.source, "fe_model.grids", problem, 'Add grids = "model.bdf"')
    nodes = _guarded(grids, lambda: _nodes(grids, dof))
    return Contents(source=str(path), arrays=matrices | nodes)


def _guarded(path: Path, work: Callable[[], Any]) -> Any:
    """What `work` returns; whatever pyyeti stumbles over in the bytes of `path` is said in words."""
    try:
        with warnings.catch_warnings():
            warnings.simplefilter("ignore")  # of names that are none: a damaged file is refused below for what it lacks
            return work()
    except BadInput:
        raise
    except Exception as error:  # pyyeti trusts its input: struct, index, value, type and key errors all mean a damaged file
        problem = f"pyyeti cannot read it: {type(error).__name__}, {error}"
        raise BadInput(str(path), "", problem, "Write it again; it may be cut short or damaged") from None


# --- OUTPUT4 ----------------------------------------------------------------------------------------------------------------


def _output4(path: Path) -> dict[str, Sparse]:
    from pyyeti.nastran import op4

    # A binary file is a chain of Fortran records, each between two equal lengths; a broken chain could be read for ever
    with path.open("rb") as file:
        head, size = file.read(4), path.stat().st_size
        if len(head) < 4:
            raise BadInput(str(path), "", "it is empty or nearly so", "Write it again")
        order, place = "<I" if int.from_bytes(head, "little") <= 48 else ">I", 0
        while min(head) == 0 and place < size:  # else it is formatted
            file.seek(place)
            length = _length(file.read(4), order)
            file.seek(place + 4 + length)
            if place + 8 + length > size or _length(file.read(4), order) != length:
                problem = f"the record that begins at byte {place} is not whole"
                raise BadInput(str(path), "", problem, "Write it again; it is cut short or damaged")
            place += 8 + length
    names, matrices, _, types = op4.OP4().listload(str(path), sparse=True)
    found: dict[str, Sparse] = {}
    for name, matrix, kind in zip(names, matrices, types, strict=True):
        if name in found:
            raise BadInput(str(path), name, "is there twice", "Write every matrix once")
        if kind not in (1, 2, 3, 4):
            raise BadInput(str(path), name, f"has the type {kind}, no real or complex number of Nastran", "Write the file again")
        found[name] = matrix
    return found


def _length(raw: bytes, order: str) -> int:
    return int(struct.unpack(order, raw)[0]) if len(raw) == 4 else -1


# --- punched DMIG -----------------------------------------------------------------------------------------------------------


def _punched(path: Path) -> dict[str, tuple[Array, Integers, Integers, bool]]:
    """By name: values, row labels (k, 2), column labels (k, 2), and whether only one triangle was punched."""
    from pyyeti.nastran import bulk

    cards = bulk.rdcards(_text(path), "dmig", return_var="list", blank=0, no_data_return=[])
    groups: dict[str, tuple[list[Any], list[list[Any]]]] = {}  # header card and column cards of every matrix
    for card in cards:
        name = str(card[0]).strip().lower()
        if card[1] == 0:
            if name in groups:
                raise BadInput(str(path), name, "is there twice", "Punch every matrix once")
            groups[name] = (card, [])
        elif name not in groups:
            problem = f"a column of {name.upper()} stands before its header card"
            raise BadInput(str(path), name, problem, "Keep the order in which it was punched")
        else:
            groups[name][1].append(card)
    found: dict[str, tuple[Array, Integers, Integers, bool]] = {}
    for name, (header, columns) in groups.items():
        form, kind = header[2], header[3]
        if form not in (1, 6):
            problem = f"has the form {form!r} (IFO), where a square (1) or symmetric (6) matrix is needed"
            raise BadInput(str(path), name, problem, "Punch K and M as square or symmetric DMIG")
        if kind not in (1, 2):
            problem = "is complex" if kind in (3, 4) else f"has the type {kind!r} (TIN)"
            raise BadInput(str(path), name, problem, "Punch it real: type 1 or 2")
        entries = [(card[1], card[2], *card[k : k + 3]) for card in columns for k in range(4, len(card), 4)]
        whole = all(
            len(entry) == 5 and all(isinstance(v, int) for v in entry[:4]) and isinstance(entry[4], int | float)
            for entry in entries
        )
        if not whole or not entries:
            problem = "holds no columns" if not entries else "a column holds something else than node, component, value"
            raise BadInput(str(path), name, problem, "Punch it again; it may be cut short or damaged")
        values = np.array([entry[4] for entry in entries], dtype=np.float64)
        labels = np.array([entry[:4] for entry in entries], dtype=np.intp)
        found[name] = values, labels[:, 2:], labels[:, :2], form == 6
    return found


def _on_common_rows(found: dict[str, tuple[Array, Integers, Integers, bool]], path: Path) -> tuple[dict[str, Sparse], Integers]:
    """The matrices on the degrees of freedom that any of them names, ascending, and those (n, 2)."""
    from scipy.sparse import coo_array, csr_array

    dof = np.unique(np.concatenate([labels for _, rows, columns, _ in found.values() for labels in (rows, columns)]), axis=0)
    index, made = {(int(node), int(component)): k for k, (node, component) in enumerate(dof)}, {}
    for name, (values, rows, columns, symmetric) in found.items():
        i, j = (np.array([index[int(node), int(c)] for node, c in labels]) for labels in (rows, columns))
        if symmetric:
            i, j = np.minimum(i, j), np.maximum(i, j)
        if len(np.unique(i * len(dof) + j)) < len(values):
            problem = "holds an entry more than once" + (", or both triangles of a symmetric one" if symmetric else "")
            raise BadInput(str(path), name, problem, "Punch every entry once")
        A = csr_array(coo_array((values, (i, j)), shape=(len(dof), len(dof))))
        made[name] = csr_array(A + A.T - coo_array((A.diagonal(), (range(len(dof)), range(len(dof)))))) if symmetric else A
    return made, dof


# --- grid points ------------------------------------------------------------------------------------------------------------


def _nodes(grids: Path, dof: Integers | None) -> dict[str, Any]:
    """dof, nodes, coordinates, rigid, basic, and the interface of an ``.asm``; rows as `dof` names them, else all, in order."""
    from pyyeti import nastran
    from pyyeti.nastran import bulk

    if grids.suffix.lower() == ".asm":
        uset, _, boundary, kept = bulk.asm2uset(str(grids), try_rdextrn="pv_only", follow_includes=False)
    else:
        uset, _ = bulk.bulk2uset(_text(grids))
        boundary, kept = np.zeros(0, dtype=bool), np.ones(len(uset), dtype=bool)
    if not len(uset):
        problem = "holds no GRID card; INCLUDE statements are not followed"
        raise BadInput(str(grids), "", problem, "Name the file that holds the grid points themselves")
    labels, table = uset.index.to_frame().to_numpy(dtype=np.intp), uset.to_numpy(dtype=np.float64)
    rigid = np.asarray(nastran.rbgeom_uset(uset, np.zeros(3)), dtype=np.float64)
    first = np.flatnonzero(labels[:, 1] == 1)  # of the six rows of a grid point: place, system, its origin and its three axes
    axes = np.stack([table[first + row, 1:4] for row in (3, 4, 5)], axis=1)
    if dof is not None:
        # Row in `labels` of every degree of freedom in `dof`, -1 where it is none of a grid point
        index = {(int(node), int(component)): row for row, (node, component) in enumerate(labels)}
        rows = np.array([index.get((int(node), int(component)), -1) for node, component in dof], dtype=np.intp)
    else:
        rows = np.flatnonzero(kept)
    found = {
        "dof": labels[kept] if dof is None else dof,
        "nodes": labels[first, 0],
        "coordinates": table[first, 1:4],
        "rigid": np.where((rows >= 0)[:, None], rigid[rows], 0.0),
        "basic": np.all(axes == np.eye(3), axis=(1, 2)).astype(np.intp),
    }
    if len(boundary):
        found["interface"] = np.unique(labels[np.asarray(boundary, dtype=bool) & (labels[:, 1] > 0), 0])
    return found


def _text(path: Path) -> io.StringIO:
    """The file as text that pyyeti cannot follow INCLUDE statements from."""
    return io.StringIO(path.read_text(encoding="utf-8"))


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
                raise BadInput(source, "", problem, TOO_LARGE)
            arrays, text = {name: np.asarray(dataset[()]) for name, dataset in found.items()}, None
            if "description" in file.attrs:  # told by its type first: the library fails on a damaged one in ways nobody can catch
                if h5py.check_string_dtype(file.attrs.get_id("description").dtype) is None:
                    raise BadInput(source, "description", "is no text", _WRITE_AGAIN)
                text = file.attrs["description"]
    except BadInput:
        raise
    except Exception as error:  # h5py raises OSError, KeyError, RuntimeError, ValueError and more on damaged bytes
        problem = f"it cannot be read as HDF5: {str(error).splitlines()[0] if str(error) else type(error).__name__}"
        raise BadInput(source, "", problem, _WRITE_AGAIN) from None
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
            raise BadInput(source, name, f"is a link to {target!r}, which is not followed", _OWN_DATA)
        entry = group[key]
        if isinstance(entry, h5py.Dataset):
            # `entry`, when all of it lies in the file
            if entry.external or entry.is_virtual:
                raise BadInput(source, name, "has its numbers in another file", _OWN_DATA)
            if entry.dtype.kind not in "fiuc":
                problem = f"must hold numbers, found the type {entry.dtype}"
                raise BadInput(source, name, problem, "Write it as 64-bit floating point")
            if entry.size and entry.id.get_storage_size() == 0:
                shape = " x ".join(map(str, entry.shape)) or "1"
                raise BadInput(source, name, f"declares {shape} values, but none was ever written", _WRITE_AGAIN)
            found[name] = entry
        elif name.count("/") >= DEEPEST:
            problem = "is a group deeper than any of a model: stiffness/PART/data is as deep as they go"
            raise BadInput(source, name, problem, "Put the datasets at the root of the file")
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


DATA_ENDINGS = (*HDF5_ENDINGS, ".npz", *NASTRAN_ENDINGS)


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
            raise BadInput(str(path), "fe_model.file", f"is missing: the data are {', '.join(DATA_ENDINGS)}", 'Add file = "..."')
        return _contents(description.file, description), description
    _require_file(path)
    if path.suffix.lower() in NASTRAN_ENDINGS:
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
        raise BadInput(str(path), "", problem, f"Write them into {sidecar.name} beside it; docs/own-model.md shows how")
    description = read_description(sidecar)
    if description.file is not None and description.file.resolve() != path.resolve():
        problem = f"is {description.file.name}, not {path.name}"
        raise BadInput(str(sidecar), "fe_model.file", problem, f"Read {sidecar.name} or correct it")
    return description


def _contents(path: Path, description: Description) -> Contents:
    _require_file(path)
    _require_digest(path, description)
    if path.suffix.lower() in NASTRAN_ENDINGS:
        return read_nastran(path, description)
    _require_not_nastrans(path, description)
    return read_npz(path) if path.suffix.lower() == ".npz" else read_hdf5(path)


def _require_not_nastrans(path: Path, description: Description) -> None:
    if description.grids is not None or description.matrices:
        field = "fe_model.grids" if description.grids is not None else "fe_model.matrices"
        raise BadInput(description.source, field, f"is for Nastran files, and {path.name} is none", "Leave it out")


def _require_digest(path: Path, description: Description) -> None:
    """What mechanics cannot tell, such as one wrong rotary inertia, a checksum can."""
    if not description.sha256:
        return
    with path.open("rb") as file:
        found = hashlib.file_digest(file, "sha256").hexdigest()
    if found != description.sha256:
        remedy = "Copy the file again; if it was changed on purpose, write its new sum here"
        raise BadInput(description.source, "fe_model.sha256", f"is not that of {path.name}, which has {found}", remedy)


def _require_file(path: Path) -> None:
    ending = path.suffix.lower()
    if ending not in DATA_ENDINGS:
        problem = f"its ending {ending!r} is none of {', '.join(DATA_ENDINGS)}, .toml"
        raise BadInput(str(path), "", problem, "Convert it, or correct its ending")
    if not path.is_file():
        raise BadInput(str(path), "", "it is a folder" if path.is_dir() else "there is no such file", "Check the path")
    size = path.stat().st_size
    if size > LARGEST_BYTES:
        problem = f"it has {size / 2**30:.3g} GiB, more than {LARGEST_BYTES / 2**30:.3g}"
        raise BadInput(str(path), "", problem, "Reduce the model first (Craig-Bampton)")


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
        raise BadInput(str(path), "", f"its ending {path.suffix!r} is none of {', '.join(WRITTEN_ENDINGS)}", "Choose one of them")
    if units.known and units.name != SI.name:
        problem = f"the arrays of a structure are in SI, found {units.name}"
        raise BadInput(str(path), "units", problem, f"Leave it out, or give {SI.name}")
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
        shares = {"stiffness": model.part_stiffness, "mass": model.part_mass, "geometric": model.geometric}
        shares |= {"places": model.places}
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
