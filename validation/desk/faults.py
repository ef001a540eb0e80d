"""What is wrong with a model and data, all of it at once: each fault beside the file and the field that has it.

The readers say it, `massline check` and `massline compare` ask the same ones; here none hides the next.
"""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass

from geometry.errors import BadInput

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
        place = f"{self.file}: `{self.field}`" if self.field else self.file
        return f"{place}: {self.problem}" + (f". {self.remedy}" if self.remedy else "")


def of_error(error: BadInput) -> Fault:
    """A refusal as a fault."""
    return Fault(file=error.source, field=error.field, problem=error.problem, remedy=error.remedy)


def faults(
    model: str, data: Sequence[str], *, effects_from: Sequence[str] = (), progress: Progress | None = None
) -> tuple[Fault, ...]:
    """Everything that is wrong with the model file `model`, the `data`, and with both together; grave faults first.

    No file is changed. A model that is empty text means that none was named yet.

    Raises
    ------
    OSError : a file cannot be read.
    """
    raise NotImplementedError
