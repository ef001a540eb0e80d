"""A model file has an effect of the user's own, and nobody said where it is: its ladder remembers the folder."""

from __future__ import annotations

from collections.abc import Iterator
from contextlib import contextmanager
from pathlib import Path

from geometry.errors import BadInput
from validation.ladders import file

OPTION = "--effects-from"


@contextmanager
def reminded(path: Path) -> Iterator[None]:
    """Refusals of unknown effects in the model file `path` name the folders from which its ladder had effects.

    Raises
    ------
    BadInput : as within, its remedy changed where the ladder knows one.
    """
    try:
        yield
    except BadInput as error:
        if OPTION not in error.remedy or not (folders := _folders(path)):
            raise
        remedy = f"Say {' '.join(f'{OPTION} {folder}' for folder in folders)}, as when it was added"
        raise BadInput(source=error.source, field=error.field, problem=error.problem, remedy=remedy) from None


def _folders(path: Path) -> tuple[str, ...]:
    """Folders of own effects in any rung beside the model file `path`; none where the ladder cannot be read."""
    try:
        rungs = file.read(file.beside(path)).rungs
    except (BadInput, OSError):
        return ()
    stated = [one.settings.get("effects_from") for one in rungs]
    return tuple(dict.fromkeys(str(folder) for some in stated if isinstance(some, list) for folder in some))
