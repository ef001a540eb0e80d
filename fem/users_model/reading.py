"""From a path to `Structure` or `Modes`: the data, the text that describes them, and the checks of both."""

from __future__ import annotations

import hashlib
import tomllib
from dataclasses import dataclass
from pathlib import Path

from fem.damping import Damping
from fem.modes import Modes
from fem.structure import Structure
from fem.users_model import description as descriptions
from fem.users_model import hdf5, matrices, modal, nastran, npz
from fem.users_model.contents import LARGEST_BYTES, Contents
from fem.users_model.description import Description
from geometry.errors import BadInput

DATA_ENDINGS = (*hdf5.ENDINGS, ".npz", *nastran.ENDINGS)


def is_model(path: str | Path) -> bool:
    """Whether `path` can be meant as a model of a user: a data file by its ending, or a TOML file with a table [fe_model]."""
    path = Path(path)
    if path.suffix.lower() in DATA_ENDINGS:
        return True
    if path.suffix.lower() != ".toml" or not path.is_file():
        return False
    try:
        return descriptions.TABLE in tomllib.loads(path.read_text(encoding="utf-8"))
    except (OSError, ValueError, RecursionError):
        return False


@dataclass(frozen=True, eq=False, kw_only=True)
class UsersModel:
    """All that a user's model says.

    Attributes
    ----------
    name : as described, else that of the file
    model : K and M as `Structure`, or modal data as `Modes`
    damping : of a structure whose file says it (loss factors, viscous matrix); None when it does not, and for modal data
    """

    name: str
    model: Structure | Modes
    damping: Damping | None = None


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
    contents, description = _opened(Path(path))
    if description.kind == "modal":
        return UsersModel(name=description.name, model=modal.modes(contents, description))
    structure, viscous = matrices.structure(contents, description)
    damped = viscous is not None or bool(structure.loss_factors)
    damping = Damping(loss_factors=structure.loss_factors, viscous=viscous) if damped else None
    return UsersModel(name=description.name, model=structure, damping=damping)


def _opened(path: Path) -> tuple[Contents, Description]:
    if path.suffix.lower() == ".toml":
        description = descriptions.read(path)
        if description.file is None:
            problem = f"is missing: the data are {', '.join(DATA_ENDINGS)}"
            raise BadInput(source=str(path), field="fe_model.file", problem=problem, remedy='Add file = "..."')
        return _contents(description.file, description), description
    _require_file(path)
    if path.suffix.lower() in nastran.ENDINGS:
        description = _beside(path)
        return _contents(path, description), description
    contents = _data(path)
    if contents.description is None:
        description = _beside(path)
        _require_digest(path, description)
    else:
        description = descriptions.embedded(contents.description, path)
    _require_not_nastrans(path, description)
    return contents, description


def _beside(path: Path) -> Description:
    """The description of the same name beside the data file `path`."""
    sidecar = path.with_suffix(".toml")
    if not sidecar.is_file():
        problem = "says nothing of its units, reference point and interface"
        remedy = f"Write them into {sidecar.name} beside it; docs/own-model.md shows how"
        raise BadInput(source=str(path), problem=problem, remedy=remedy)
    description = descriptions.read(sidecar)
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
    return _data(path)


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


def _data(path: Path) -> Contents:
    return npz.read(path) if path.suffix.lower() == ".npz" else hdf5.read(path)


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
