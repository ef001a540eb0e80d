"""What leaves a desk: model, ladder, report and figures, whole or not at all, to where the user says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from validation.desk.desk import Desk

Progress = Callable[[str, float], None]


def model_text(of: Desk) -> str:
    """The model file as it stands, for a download."""
    raise NotImplementedError


def ladder_text(of: Desk) -> str:
    """Its ladder, one JSON object, for a download; data by their paths from the desk.

    Raises
    ------
    BadInput : there is none yet.
    """
    raise NotImplementedError


def save(of: Desk, to: str | Path, *, replace: bool = False) -> tuple[Path, ...]:
    """Write the model to the file `to` (.toml), and its ladder beside it, with data and own models named from there.

    Raises
    ------
    BadInput : something is there already and is not to be replaced, or it cannot be written there.
    """
    raise NotImplementedError


def figures(of: Desk, folder: str | Path, progress: Progress | None = None) -> tuple[Path, ...]:
    """Write the pictures of comparison and ladder into `folder`, as the commands draw them.

    Raises
    ------
    BadInput : nothing was compared yet.
    CheckFailed : nothing can be rendered on this machine.
    """
    raise NotImplementedError


def reported(of: Desk, to: str | Path, progress: Progress | None = None) -> Path:
    """Write the report of the model as it stands to the file `to` (.html).

    Raises
    ------
    BadInput : nothing was compared yet.
    """
    raise NotImplementedError
