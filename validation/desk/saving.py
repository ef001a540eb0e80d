"""What leaves a desk: model, ladder, report and figures, whole or not at all, to where the user says."""

from __future__ import annotations

from collections.abc import Callable
from pathlib import Path

from geometry.errors import BadInput
from validation.comparing.comparison import Comparison
from validation.desk import diagnosing, moving
from validation.desk.desk import Desk
from validation.desk.held_against import Ground, comparison, ground, rung
from validation.desk.recorded import data_of
from validation.ladders import file
from validation.ladders.climbing import read_text, standing
from validation.output import require_ending, require_file, require_folder

Progress = Callable[[str, float], None]


def model_text(of: Desk) -> str:
    """The model file as it stands, as it would be saved beside the user's own, for a download.

    Raises
    ------
    BadInput : the working copy is gone.
    """
    return moving.moved(read_text(of.model), of.model, Path(of.asked.model))


def ladder_text(of: Desk) -> str:
    """Its ladder as it would be saved beside the user's own model, one JSON object, for a download.

    Raises
    ------
    BadInput : there is none yet.
    """
    beside = file.beside(of.model)
    if not beside.exists():
        problem = "there is none yet: a comparison makes its first rung"
        raise BadInput(source="ladder", problem=problem, remedy="Compare the model with its data")
    to = Path(of.asked.model)
    return file.text(moving.moved_ladder(file.read(beside), of.model, to), to.name)


def figures(of: Desk, folder: str | Path, progress: Progress | None = None) -> tuple[Path, ...]:
    """Write the pictures of comparison, diagnosis and ladder into `folder`, as the commands draw them; some ten seconds.

    Raises
    ------
    BadInput : nothing can be written there; model or data that cannot be used.
    CheckFailed : nothing can be rendered on this machine; a fit that does not converge.
    OSError : a file cannot be written.
    """
    from validation.comparing.drawn import draw as of_comparison
    from validation.diagnosing.drawn import draw as of_diagnosis
    from validation.ladders.drawn import draw as of_ladder

    tell, where = progress or (lambda what, share: None), Path(folder)
    require_folder(where, "figures")
    _, compared = _compared(of, tell)
    tell("drawing the comparison", 0.0)
    made = [*of_comparison(compared, where)]
    found = diagnosing.noun(of)
    if found is not None:
        tell("drawing the diagnosis", 0.5)
        made += of_diagnosis(found, where)
    tell("drawing the ladder", 0.7)
    return (*made, *of_ladder(standing(of.model), where))


def reported(of: Desk, to: str | Path, progress: Progress | None = None) -> Path:
    """Write the report of the model as it stands to the file `to` (.html); what was found already is not found again.

    Takes a minute: `validation.desk.jobs.start(desk, "report", to=...)` does it in a worker.

    Raises
    ------
    BadInput : nothing can be written there; model or data that cannot be used.
    CheckFailed : a fit that does not converge.
    OSError : a file cannot be written.
    """
    from validation.desk.signing import as_given, signed
    from validation.report.assembling import How, assembled
    from validation.report.page import write

    tell, path, asked = progress or (lambda what, share: None), Path(to), of.asked
    require_ending(path, (".html", ".htm"), "a report", "report.html")
    require_file(path, "report")
    ready, compared = _compared(of, tell)
    found, at = diagnosing.noun(of), standing(of.model)
    report = assembled(
        ready.model,
        data_of(of, ready.model, tell),
        compared,
        provenance=signed(of, ready.model, diagnosed=found is not None),
        how=How(band=asked.band, method=asked.method),
        identified=() if at.rung is None else at.rung.bodies,
        diagnosis=found,
        not_diagnosed="" if found else "nobody asked for it",
        standing=at,
        progress=tell,
    )
    write(as_given(of, report), path, tell)
    return path


def _compared(of: Desk, tell: Progress) -> tuple[Ground, Comparison]:
    """The comparison as a noun, from the fits of its rung."""
    ready = ground(of, tell)
    return ready, comparison(ready, rung(of, ready, tell), tell)
