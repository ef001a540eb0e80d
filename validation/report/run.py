"""`massline report` from options to output: read, compare, diagnose, assemble, write, print."""

from __future__ import annotations

import shlex
from collections.abc import Callable, Sequence
from dataclasses import dataclass
from datetime import datetime
from importlib.metadata import version
from pathlib import Path
from platform import platform, python_version

import click

from geometry.errors import BadInput, CheckFailed
from identification.campaign import METHODS
from validation.article_reference import file_name
from validation.comparing.asked import Asked as Compared
from validation.comparing.asked import ready
from validation.comparing.compared import compared
from validation.comparing.gathered import Data
from validation.diagnosing import diagnosed
from validation.diagnosing.asked import require_runs
from validation.diagnosing.diagnosis import Diagnosis
from validation.effects.catalogue import SOURCES
from validation.ladders.climbing import standing
from validation.ladders.nouns import Source
from validation.ladders.sources import digest
from validation.models.model import Model
from validation.output import require_ending, require_file
from validation.progress import stages
from validation.report import browser, corrected, pdf
from validation.report.assembling import How, assembled
from validation.report.nouns import Provenance, Report
from validation.report.page import write

PROGRAMS = (
    *("massline", "numpy", "scipy", "plotly", "pyvista", "vtk", "matplotlib", "exudyn", "pin", "cadquery", "cadquery-ocp"),
    *("trimesh", "gmsh", "scikit-fem", "h5py", "libigl", "networkx", "pillow", "pint", "pyuff", "pyyeti", "tomlkit"),
    "uncertainties",
)
"""Whose versions stand in the report, beside Python's: every library that reads, computes or draws what is on it."""

NOT_ASKED = "--no-diagnosis"


@dataclass(frozen=True, kw_only=True)
class Asked:
    """The options as typed.

    Attributes
    ----------
    compared : model, data, and what `massline compare` is asked
    diagnosis : whether to look for what is missing
    out : where the page goes; None for a name after the model's, under out/
    pdf : whether to print it as well
    by : who makes it
    command : the command line
    """

    compared: Compared
    diagnosis: bool = True
    out: Path | None = None
    pdf: bool = False
    by: str = ""
    command: str = ""


def answer(asked: Asked) -> None:
    """Write what is `asked`, and say where it is.

    Raises
    ------
    BadInput : something that was asked cannot be used; no browser where one is to print.
    CheckFailed : a fit that does not converge; a browser that does not print.
    OSError : a file cannot be written.
    """
    path = place(asked)
    program = browser.path() if asked.pdf else ""
    report = reported(asked)
    with stages("writing", quiet=False) as told:
        write(report, path, told)
    click.echo(f"massline: wrote {path}.", err=True)
    if program:
        printed = path.with_suffix(".pdf")
        with stages("printing", quiet=False):
            pdf.print_to(path, printed, program)
        click.echo(f"massline: wrote {printed}.", err=True)


def place(asked: Asked) -> Path:
    """Where the page goes.

    Raises
    ------
    BadInput : a place where nothing can be written, or an ending that is not .html.
    """
    if asked.out is None:
        path = Path("out") / f"{file_name(Path(asked.compared.model).stem)}-report.html"
        path.parent.mkdir(exist_ok=True)
        return path
    require_ending(asked.out, (".html", ".htm"), "a report", "out/report.html")
    require_file(asked.out, "--out")
    return asked.out


def reported(asked: Asked, *, quiet: bool = False) -> Report:
    """The report that `asked` leads to.

    Raises
    ------
    BadInput, CheckFailed : see `answer`.
    """
    question = asked.compared
    with stages("reading", quiet=quiet) as told:
        model, data = ready(question, told)
        at = standing(Path(question.model)) if Path(question.model).is_file() else None
    with stages("comparing", quiet=quiet) as told:
        comparison = compared(model, data, question.hold_out, told, band=question.band, method=question.method)
    with stages("diagnosing", quiet=quiet) as told:
        found, why = _diagnosis(asked, model, data, told) if asked.diagnosis else (None, NOT_ASKED)
    with stages("identifying and drawing", quiet=quiet) as told:
        bodies, missing = corrected.identified(question, model, data, comparison, at, told)
        return assembled(
            model,
            data,
            comparison,
            provenance=provenance(asked),
            how=How(band=question.band, method=question.method),
            identified=bodies,
            not_identified=missing,
            diagnosis=found,
            not_diagnosed=why,
            standing=at,
            progress=told,
        )


def _diagnosis(asked: Asked, model: Model, data: Data, told: Callable[[str, float], None]) -> tuple[Diagnosis | None, str]:
    """What is missing; or None, and why nothing can be said."""
    question = asked.compared
    try:
        require_runs(data.campaigns)
        bench = diagnosed.bench(
            model, data, hold_out=question.hold_out, band=question.band, method=question.method, progress=told
        )
        return diagnosed.diagnosed(bench, progress=told), ""
    except (BadInput, CheckFailed) as error:
        return None, str(error)


def provenance(asked: Asked) -> Provenance:
    """Where a report of what is `asked` comes from, at this moment.

    Raises
    ------
    OSError : a file cannot be read.
    """
    question = asked.compared
    return Provenance(
        when=datetime.now().astimezone().isoformat(sep=" ", timespec="minutes"),
        by=asked.by,
        command=asked.command or command_line(question, diagnosis=asked.diagnosis),
        versions=_versions(asked),
        inputs=inputs((question.model, *question.data, *_own_effects())),
        settings={
            "method": question.method,
            "band_hz": question.band or "what all runs drive",
            "held out": question.hold_out or "each run in turn",
            "effects of the user's own": [f"{name} ({source})" for name, source in SOURCES.items()],
        },
        model_text=Path(question.model).read_text(encoding="utf-8") if Path(question.model).is_file() else "",
    )


def command_line(of: Compared, *, effects_from: Sequence[str] = (), diagnosis: bool = True) -> str:
    """What is typed for a report of `of`."""
    words = ["massline", "report", of.model, *of.data]
    words += [word for name in of.hold_out for word in ("--hold-out", name)]
    words += [] if of.band is None else ["--band", *(f"{end:g}" for end in of.band)]
    words += [] if of.method == METHODS[0] else ["--method", of.method]
    words += [word for folder in effects_from for word in ("--effects-from", folder)]
    return shlex.join([*words, *([] if diagnosis else [NOT_ASKED])])


def _versions(asked: Asked) -> dict[str, str]:
    found = {**{name: version(name) for name in PROGRAMS}, "Python": python_version(), "system": platform()}
    return {**found, "browser that prints": browser.version(browser.path())} if asked.pdf else found


def _own_effects() -> tuple[str, ...]:
    """Files of code that take part in every figure."""
    return tuple(source for source in SOURCES.values() if Path(source).is_file())


def inputs(paths: Sequence[str]) -> tuple[Source, ...]:
    """Files and campaign folders with their digests; those of effects are files of code."""
    return tuple(Source(path=path, digest=digest(path)) for path in paths)
