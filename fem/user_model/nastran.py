"""Nastran's matrices through pyyeti: OUTPUT4 files and punched DMIG, with grid points from bulk data.

An OUTPUT4 matrix does not say what its rows are. With an ``.asm`` beside it (EXTSEOUT) the order is that of the SECONCT
card, grid points of the boundary and modal points; with other bulk data it is the a-set of all grid points with six components
each, ascending. Punched DMIG name their rows. Displacement coordinate systems are honoured: the rigid motions are pyyeti's.

INCLUDE statements are not followed. An OUTPUT4 file is read column by column as sparse, so that no declared size takes memory.
"""

import io
import struct
import warnings
from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np

from fem.structure import Sparse
from fem.user_model.description import Contents, Description
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.toml_file import nearest

PUNCH_ENDINGS = (".pch", ".dmig")
ENDINGS = (".op4", *PUNCH_ENDINGS)

NAMES = {
    "stiffness": ("kaa", "kxx", "kgg", "k2gg", "k2pp"),
    "mass": ("maa", "mxx", "mgg", "m2gg", "m2pp"),
    "viscous": ("baa", "bxx", "bgg", "b2gg", "b2pp"),
    "structural": ("k4aa", "k4xx", "k4gg"),
}
"""Names that are looked for where the description gives none."""

_OPTIONAL = ("viscous", "structural")


def read(path: Path, description: Description) -> Contents:
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
            raise BadInput(source=str(path), field=choices[0].upper(), problem=f"is missing, the {ours}", remedy=remedy)
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
        remedy = 'Add grids = "model.bdf"'
        raise BadInput(source=description.source, field="fe_model.grids", problem=problem, remedy=remedy)
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
        raise BadInput(source=str(path), problem=problem, remedy="Write it again; it may be cut short or damaged") from None


# --- OUTPUT4 ----------------------------------------------------------------------------------------------------------------


def _output4(path: Path) -> dict[str, Sparse]:
    from pyyeti.nastran import op4

    # A binary file is a chain of Fortran records, each between two equal lengths; a broken chain could be read for ever
    with path.open("rb") as file:
        head, size = file.read(4), path.stat().st_size
        if len(head) < 4:
            raise BadInput(source=str(path), problem="it is empty or nearly so", remedy="Write it again")
        order, place = "<I" if int.from_bytes(head, "little") <= 48 else ">I", 0
        while min(head) == 0 and place < size:  # else it is formatted
            file.seek(place)
            length = _length(file.read(4), order)
            file.seek(place + 4 + length)
            if place + 8 + length > size or _length(file.read(4), order) != length:
                problem = f"the record that begins at byte {place} is not whole"
                raise BadInput(source=str(path), problem=problem, remedy="Write it again; it is cut short or damaged")
            place += 8 + length
    names, matrices, _, types = op4.OP4().listload(str(path), sparse=True)
    found: dict[str, Sparse] = {}
    for name, matrix, kind in zip(names, matrices, types, strict=True):
        if name in found:
            problem = "is there twice"
            raise BadInput(source=str(path), field=name, problem=problem, remedy="Write every matrix once")
        if kind not in (1, 2, 3, 4):
            problem = f"has the type {kind}, no real or complex number of Nastran"
            raise BadInput(source=str(path), field=name, problem=problem, remedy="Write the file again")
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
                raise BadInput(source=str(path), field=name, problem="is there twice", remedy="Punch every matrix once")
            groups[name] = (card, [])
        elif name not in groups:
            problem = f"a column of {name.upper()} stands before its header card"
            raise BadInput(source=str(path), field=name, problem=problem, remedy="Keep the order in which it was punched")
        else:
            groups[name][1].append(card)
    found: dict[str, tuple[Array, Integers, Integers, bool]] = {}
    for name, (header, columns) in groups.items():
        form, kind = header[2], header[3]
        if form not in (1, 6):
            problem = f"has the form {form!r} (IFO), where a square (1) or symmetric (6) matrix is needed"
            raise BadInput(source=str(path), field=name, problem=problem, remedy="Punch K and M as square or symmetric DMIG")
        if kind not in (1, 2):
            problem = "is complex" if kind in (3, 4) else f"has the type {kind!r} (TIN)"
            raise BadInput(source=str(path), field=name, problem=problem, remedy="Punch it real: type 1 or 2")
        entries = [(card[1], card[2], *card[k : k + 3]) for card in columns for k in range(4, len(card), 4)]
        whole = all(
            len(entry) == 5 and all(isinstance(v, int) for v in entry[:4]) and isinstance(entry[4], int | float)
            for entry in entries
        )
        if not whole or not entries:
            problem = "holds no columns" if not entries else "a column holds something else than node, component, value"
            raise BadInput(source=str(path), field=name, problem=problem, remedy="Punch it again; it may be cut short or damaged")
        values = np.array([entry[4] for entry in entries], dtype=np.float64)
        labels = np.array([entry[:4] for entry in entries], dtype=np.intp)
        found[name] = values, labels[:, 2:], labels[:, :2], form == 6
    return found


def _on_common_rows(found: dict[str, tuple[Array, Integers, Integers, bool]], path: Path) -> tuple[dict[str, Sparse], Integers]:
    """The matrices on the degrees of freedom that any of them names, ascending, and those (n, 2)."""
    from scipy.sparse import coo_array, csr_array

    dof = np.unique(np.concatenate([labels for _, rows, columns, _ in found.values() for labels in (rows, columns)]), axis=0)
    index = {(int(node), int(component)): k for k, (node, component) in enumerate(dof)}
    made = {}
    for name, (values, rows, columns, symmetric) in found.items():
        i, j = (np.array([index[int(node), int(c)] for node, c in labels]) for labels in (rows, columns))
        if symmetric:
            i, j = np.minimum(i, j), np.maximum(i, j)
        if len(np.unique(i * len(dof) + j)) < len(values):
            problem = "holds an entry more than once" + (", or both triangles of a symmetric one" if symmetric else "")
            raise BadInput(source=str(path), field=name, problem=problem, remedy="Punch every entry once")
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
        raise BadInput(source=str(grids), problem=problem, remedy="Name the file that holds the grid points themselves")
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
