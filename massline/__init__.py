"""massline in Python: the names of the toolkit in one place, and the verbs of a study.

    study = massline.Study.open("model.toml", ["campaign-1", "campaign-2"])
    found = massline.diagnose(study)
    study = massline.add(study, found.accepted[0])

Nothing is computed here, and nothing of the four rooms imports it. ``docs/python.md`` describes every name.
"""

from __future__ import annotations

from collections.abc import Callable, Iterable, Sequence
from pathlib import Path
from typing import Any

from geometry import user_article
from geometry.article import Article
from geometry.articles import built_in
from geometry.dynamic_mass import DynamicMass
from geometry.errors import BadInput, CheckFailed
from geometry.inertia import Inertia
from geometry.routes import by_routes
from identification.campaign import Campaign
from massline.results import Comparison, Diagnosis, History, Identification, Routes, Study, printing
from validation.compare.compare import compared
from validation.diagnose.diagnose import diagnosed
from validation.diagnose.diagnosis import Cause
from validation.diagnose.diagnosis import Diagnosis as Found
from validation.diagnose.fleet import diagnosed_each
from validation.history.add import AddedEffectOptions, added
from validation.history.history import undone
from validation.identify.identify import identified
from validation.identify.request import IdentifyOptions
from validation.model import model_file
from validation.model.model import Model
from validation.study import Options
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import VirtualTest, simulate

Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""

__all__ = [
    "Article",
    "BadInput",
    "Campaign",
    "CheckFailed",
    "Comparison",
    "Diagnosis",
    "DynamicMass",
    "History",
    "Identification",
    "Inertia",
    "Model",
    "Options",
    "Plan",
    "Routes",
    "Study",
    "VirtualTest",
    "add",
    "built_in",
    "compare",
    "diagnose",
    "diagnose_many",
    "identify",
    "reference",
    "simulate",
    "undo",
]


def compare(study: Study, *, progress: Progress | None = None) -> Comparison:
    """Where the model of `study` fails, as `massline compare` says it.

    Raises
    ------
    CheckFailed : a fit that does not converge.
    """
    return printing(Comparison, compared(study, progress))


def diagnose(
    study: Study, *, only: Sequence[str] = (), leave_out: Sequence[str] = (), progress: Progress | None = None
) -> Diagnosis:
    """Which effect the model of `study` is missing, as `massline diagnose` says it.

    Parameters
    ----------
    only, leave_out : ids or families of effects that alone are looked for, or that are not

    Raises
    ------
    BadInput : one of `only` cannot act on these data.
    CheckFailed : the model with all its tolerances does not converge.
    """
    return printing(Diagnosis, diagnosed(study, only=only, leave_out=leave_out, progress=progress))


def diagnose_many(
    studies: Iterable[Study | Options], *, processes: int = 0, scheduler: str = "", progress: Progress | None = None
) -> tuple[Diagnosis | BadInput | CheckFailed, ...]:
    """What each of `studies` is missing, or why that cannot be said, in their order; bit for bit what `diagnose` says of each.

    What is finished is kept on disk by whoever did it, so that the same call goes on where it was interrupted.

    Parameters
    ----------
    studies : opened, or `Options` of one, which is then opened where it is diagnosed
    processes : of this machine; 0 for one a core
    scheduler : address of a Dask scheduler whose workers do it instead, and see the same files

    Raises
    ------
    BadInput : no scheduler answers there, or its workers have other code.
    """
    listed, found = list(studies), {}
    for number, answer in diagnosed_each(listed, processes=processes, scheduler=scheduler):
        found[number] = printing(Diagnosis, answer) if isinstance(answer, Found) else answer
        if progress is not None:
            progress("diagnosing each", len(found) / len(listed))
    return tuple(found[number] for number in range(len(listed)))


def add(study: Study, effect: str | Cause, *, fixed: bool = False, progress: Progress | None = None) -> Study:
    """The study of the model with `effect`: it is fitted, written to the model file, and a new version of its history.

    Parameters
    ----------
    effect : a cause that a diagnosis found, or ``ID[=VALUE]`` as `massline add` takes it
    fixed : keep it at its size instead of fitting it

    Raises
    ------
    BadInput : an effect that does not act on these data, or that they cannot tell from what the model has.
    CheckFailed : a fit that does not converge.
    """
    text = effect if isinstance(effect, str) else str(effect.named)
    found = added(study, AddedEffectOptions(effect=text, fixed=fixed), progress)
    return study.by(found.study.model)


def undo(study: Study) -> Study:
    """The study of the model without the effect that was added last; its history keeps that version.

    Raises
    ------
    BadInput : there is nothing to undo.
    """
    undone(study.history)
    return study.by(model_file.read(study.asked.path))


def identify(campaign: str | Path, **options: Any) -> Identification:
    """Mass, centre of gravity and inertia from the folder of a `campaign`, with intervals.

    `options` are those of `validation.identify.request.IdentifyOptions`: ``tares``, ``known``, ``band``, ...

    Raises
    ------
    BadInput : a folder or an option that cannot be used.
    CheckFailed : data from which nothing can be identified.
    """
    return printing(Identification, identified(IdentifyOptions(campaign=str(campaign), **options)))


def reference(article: Article | str | Path, **given: Any) -> Routes:
    """Inertia of `article`, an `Article` or the path of a file, about its origin by every route that it has.

    Files are STEP, STL, PLY, OBJ and article.toml; `given` are those of `geometry.user_article.load`: ``unit``, ``material``,
    ``chord`` [m], ``repair``. An `Article` takes ``chord``.

    Raises
    ------
    BadInput : a file, a unit, a material or a mesh that cannot be used.
    """
    if isinstance(article, Article):
        return Routes(by_routes(article, **given))
    return Routes(user_article.inertias(user_article.load(article, **given)))
