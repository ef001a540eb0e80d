"""What is wrong with a model and data, all of it at once: each fault beside the file and the field that has it.

The readers say it, and `massline check` and `massline compare` ask the same ones; here none hides the next.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from functools import partial
from pathlib import Path

from geometry.errors import BadInput
from validation import measurement_file
from validation.campaigns.summary import summary
from validation.comparing.gathered import gathered, only_files
from validation.effects import catalogue
from validation.identifying.classical import REDUCED
from validation.models import reading
from validation.models.model import Model
from validation.reduction import Reduction

Progress = Callable[[str, float], None]


@dataclass(frozen=True, kw_only=True)
class Fault:
    """One thing that is wrong.

    Attributes
    ----------
    file : that has it, or what else was named
    field : key or channel within it; empty where the whole file is meant
    problem : the condition that is broken and what was found
    remedy : what to do
    grave : whether the data cannot be used as they are; else a warning
    """

    file: str
    field: str
    problem: str
    remedy: str = ""
    grave: bool = True

    @property
    def text(self) -> str:
        """All of it in one sentence or two."""
        place = f"{self.file}: `{self.field}`: " if self.field else f"{self.file}: " if self.file else ""
        return place + self.problem + (f". {self.remedy}" if self.remedy else "")


def of_error(error: BadInput) -> Fault:
    """A refusal as a fault."""
    return Fault(file=error.source, field=error.field, problem=error.problem, remedy=error.remedy)


def faults(
    model: str, data: Sequence[str], *, effects_from: Sequence[str] = (), progress: Progress | None = None
) -> tuple[Fault, ...]:
    """Everything that is wrong with the model file `model`, the `data`, and with both together; grave faults first.

    No file is changed. A model that is empty text means that none was named yet.
    """
    tell = progress or (lambda what, share: None)
    found: list[Fault] = []
    for folder in effects_from:
        _tried(found, partial(catalogue.load, folder))
    read = _tried(found, lambda: reading.read(model)) if model else None
    known = read if isinstance(read, Model) else None
    for path in data:
        found += _of_campaign(path, tell) if Path(path).is_dir() else _of_file(path)
    if not any(one.grave for one in found) and known is not None:
        found += _together(known, data)
    unique = tuple(dict.fromkeys(found))
    return (*(one for one in unique if one.grave), *(one for one in unique if not one.grave))


def _of_campaign(path: str, progress: Progress) -> list[Fault]:
    """By what `massline check` finds."""
    try:
        seen = summary(path, progress=lambda share: progress(f"reading {Path(path).name}", share))
    except OSError as error:
        return [_of_system(error, path)]
    said = [Fault(file=path, field="", problem=text, grave=False) for text in seen.warnings]
    return [*map(of_error, seen.problems), *said]


def _of_file(path: str) -> list[Fault]:
    """By its reader, and by its reduction, which alone looks at every field."""
    found: list[Fault] = []
    _tried(found, lambda: _reduced(path))
    return found


def _reduced(path: str) -> Reduction:
    """A measurement file as `massline weigh`, `cog` and `pendulum` take it.

    Raises
    ------
    BadInput : there is none, or it is none.
    """
    if not only_files((path,)):
        remedy = "Name campaign folders, and weigh, cog and pendulum files"
        raise BadInput(source=path, problem="there is no such file or folder", remedy=remedy)
    file = measurement_file.read(path, tuple(REDUCED))
    return REDUCED[file.text("kind")](file)


def _together(model: Model, data: Sequence[str]) -> list[Fault]:
    """What contradicts what, of files that are sound by themselves; descriptions are enough to see it."""
    found: list[Fault] = []
    if any(Path(path).is_dir() for path in data):
        _tried(found, lambda: gathered(data, model))
    elif data:
        problem = "there is no campaign among them, and weights and periods alone tell nothing of frequencies"
        found.append(Fault(file="DATA", field="", problem=problem, remedy="Name a campaign folder, too"))
    return found


def _tried(found: list[Fault], attempt: Callable[[], object]) -> object:
    """What `attempt` gives; or None, and its refusal among those that were `found`."""
    try:
        return attempt()
    except BadInput as error:
        found.append(of_error(error))
    except OSError as error:
        found.append(_of_system(error, ""))
    return None


def _of_system(error: OSError, path: str) -> Fault:
    problem = f"it cannot be read: {error.strerror or error}"
    return Fault(file=str(error.filename or path), field="", problem=problem, remedy="Check its name and permissions")
