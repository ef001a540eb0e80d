"""Which route answers a question, and every run of it: driven, simulated, brought down to the output's rate, put into figures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.response import Response
from geometry.errors import BadInput
from validation.excitation.asked import EXUDYN, LARGE, LINEAR, LONGEST, Question
from validation.excitation.drives import Run, cross_motion, runs
from validation.excitation.figures import Outcome, cell_loads, loose_parts, outcome
from validation.excitation.passage import Amplitudes, amplitudes, passed
from validation.excitation.refusals import of_pattern, of_record, of_rig, of_route
from validation.excitation.rig import Mounted, mounted, require_mountable
from validation.excitation.rig_modes import RigModes, rig_modes
from validation.progress import percent, shown

if TYPE_CHECKING:
    from fem.base_excitation.patterns import CrossMotion
    from fem.base_excitation.small_motion import SmallMotion

STIFF = 10.0
"""Times the highest driven frequency at which a first mode swells no load by more than 1 %."""

CUT = "The record ends at"
"""How a warning of `fem.base_excitation.ring_down` begins."""

Progress = Callable[[float], None]


@dataclass(frozen=True, kw_only=True)
class Route:
    """How runs are computed, and why so."""

    name: str
    why: str


@dataclass(frozen=True, eq=False, kw_only=True)
class Ready:
    """A question with all that it needs before a run is made.

    Attributes
    ----------
    question : as it was asked
    mounted : the article on the table
    modes : resonances of the rig
    route : which one answers
    runs : to be made
    """

    question: Question
    mounted: Mounted
    modes: RigModes
    route: Route
    runs: tuple[Run, ...]


@dataclass(frozen=True, eq=False, kw_only=True)
class Done:
    """One run that was made.

    Attributes
    ----------
    run : what was driven
    motion : of the table, as it was simulated
    response : at the output's rate
    amplitudes : of a sweep; None where many frequencies are driven at once
    outcome : its figures
    """

    run: Run
    motion: BaseMotion
    response: Response
    amplitudes: Amplitudes | None
    outcome: Outcome


def ready(question: Question, *, quiet: bool = False) -> Ready:
    """Everything that can be refused is, and the article is reduced.

    Raises
    ------
    BadInput : something in `question` cannot be.
    """
    model = _model(question)
    route = _route(question)
    require_mountable(question.article, model, question.asked, question.attached)
    to_make = _to_make(question)
    highest = np.inf if question.every_mode else _followed(question)
    with shown(f"model of {question.article}", quiet=quiet):
        made = mounted(question.article, model, question.asked, question.attached, highest)
        try:
            modes = rig_modes(made.rig)
        except BadInput as error:
            raise of_rig(error) from None
        return Ready(question=question, mounted=made, modes=modes, route=route, runs=to_make)


def done(made: Ready, *, keep_coordinates: bool = False, quiet: bool = False) -> Iterator[Done]:
    """The runs of `made`, one after the other, each gone from memory when the next is made unless the caller keeps it.

    Raises
    ------
    BadInput, CheckFailed : what the route refuses, or fails at.
    """
    cross = cross_motion(made.question.drive)
    for number, run in enumerate(made.runs, start=1):
        words = f"{run.name}, {made.route.name} ({number} of {len(made.runs)})"
        with percent(words, quiet=quiet) as progress:
            try:
                one = _done(made, run, cross, progress, keep_coordinates)
            except BadInput as error:
                raise of_route(error, made.question, made.mounted, _followed(made.question)) from None
        yield one  # outside: the caller may show what it is doing with it


def _to_make(question: Question) -> tuple[Run, ...]:
    """The runs, which a record at the output's rate can hold."""
    from fem.base_excitation.decimation import require_recorded

    try:
        found = runs(question.drive)
    except BadInput as error:
        raise of_pattern(error) from None
    for run in found:
        try:
            require_recorded(run.pattern.highest, question.rate, "--rate")
        except BadInput as error:
            raise of_record(error, run.pattern, question) from None
    return found


def _followed(question: Question) -> float:
    """[Hz] of the modes that the step can follow."""
    from fem.base_excitation.decimation import simulation_rate
    from fem.base_excitation.linear import COARSEST

    return simulation_rate(question.rate) / COARSEST


def _done(made: Ready, run: Run, cross: CrossMotion | None, progress: Progress, keep: bool) -> Done:
    from fem.base_excitation import ring_down
    from fem.base_excitation.decimation import decimated, simulation_rate
    from fem.base_excitation.small_motion import judge

    rate, rig = made.question.rate, made.mounted.rig
    at_rest = run.motion(rate, ring_down=0.0, cross=cross)
    length = ring_down.needed(rig, at_rest)
    motion = run.motion(simulation_rate(rate), ring_down=_rest(made, length - at_rest.driven), cross=cross)
    simulated = _ROUTES[made.route.name](made, motion, progress, keep)
    response = decimated(simulated, rate)
    found = amplitudes(response, run, made.modes.rigid_mass)
    return Done(
        run=run,
        motion=motion,
        response=response,
        amplitudes=found,
        outcome=outcome(
            run,
            response,
            driven=motion.driven,
            small=judge(motion),
            passed=passed(found, run, made.modes),
            needed=max(length - motion.driven, 0.0),
            step=1 / motion.sampling_rate,
            cells=cell_loads(simulated, rig.cells),
            loose=loose_parts(simulated, rig.frictions),
            warnings=(
                *_warnings(response, _cut(ring_down.judged(length, motion), length - motion.driven)),
                *_turned(judge(motion), made.route.name),
            ),
        ),
    )


def _warnings(response: Response, cut: str) -> tuple[str, ...]:
    """What the route warned of, and that the record is `cut`, in the words of the command line."""
    others = (warning for warning in response.warnings if not warning.startswith(CUT))
    return (*others, *([cut] if cut else []))


def _turned(small: SmallMotion, route: str) -> tuple[str, ...]:
    """What to do where the table turns beyond the limit of small motion; nothing where all is exact or it does not."""
    if small.within or route == "large":
        return ()
    return (f"{small.text[:-1]}. Lower --level, or take --route large, which turns the table really",)


def _cut(said: str, needed: float) -> str:
    """The sentence `said` of a record that is cut, and what to type where `needed` [s] after the drive can be recorded."""
    if not said or not needed <= LONGEST:
        return said
    return f'{said}. Write --ring-down "{np.ceil(10 * needed) / 10:g} s", or leave it out'


def _rest(made: Ready, needed: float) -> float:
    """[s] of record after the drive.

    Raises
    ------
    BadInput : it is to be as long as the ringing takes, which has no end or none that could be recorded.
    """
    asked = made.question.drive.ring_down
    if asked is not None:
        return asked
    if needed <= LONGEST:
        return max(needed, 0.0)
    takes = f"the ringing takes {needed:.4g} s" if np.isfinite(needed) else "a driven mode has no damping and never stops ringing"
    raise BadInput(source="--ring-down", problem=takes, remedy='Give a time, such as --ring-down "20 s", or more damping')


def _linear(made: Ready, motion: BaseMotion, progress: Progress, keep: bool) -> Response:
    from fem.base_excitation import linear

    return linear.respond(made.mounted.rig, motion, keep_coordinates=keep, progress=progress)


def _exudyn(made: Ready, motion: BaseMotion, progress: Progress, keep: bool) -> Response:
    from fem.flexible_body import driven_base

    return driven_base.respond(made.mounted.rig, motion, keep_coordinates=keep, progress=progress)


def _large(made: Ready, motion: BaseMotion, progress: Progress, keep: bool) -> Response:
    from fem.flexible_body import large_motion
    from fem.flexible_body.large_motion.response import ELEMENTS
    from geometry.articles import changes_of
    from geometry.articles.locations import locations

    question = made.question
    changes = changes_of(question.article, question.asked.changes)
    elements = None if as_one_body(made) else ELEMENTS
    places = locations(question.article, changes)
    return large_motion.respond(question.article, motion, changes=changes, places=places, progress=progress, elements=elements)


def as_one_body(made: Ready) -> bool:
    """Whether the large route takes the article as one rigid body: its first mode lies so far above all that is driven."""
    kept = made.mounted.rig.article.kept
    return not len(kept) or float(kept[0]) >= STIFF * max(run.pattern.highest for run in made.runs)


_ROUTES: dict[str, Callable[[Ready, BaseMotion, Progress, bool], Response]] = {
    LINEAR: _linear,
    EXUDYN: _exudyn,
    LARGE: _large,
}


def _route(question: Question) -> Route:
    """The route asked for, or the one that fits."""
    nonlinear = [option for option in question.attached.options if option in ("--preload", "--friction")]
    because = f"{' and '.join(nonlinear)} {'are' if len(nonlinear) > 1 else 'is'} not linear"
    if question.route is None:
        if nonlinear:
            return Route(name=EXUDYN, why=f"chosen because {because}")
        return Route(name=LINEAR, why="chosen because everything in the rig is linear")
    if question.route == LINEAR and nonlinear:
        remedy = "Leave --route out, or take --route exudyn"
        raise BadInput(source="--route", problem=f"the exact recursion answers linear rigs only, and {because}", remedy=remedy)
    if question.route == LARGE:
        _require_plain(question)
    return Route(name=question.route, why="as asked")


def _require_plain(question: Question) -> None:
    """Refuse what exudyn's own beams on a turning base have not."""
    from validation.article_reference import is_stack

    remedy = "Leave it out, or take --route exudyn"
    for option in question.attached.options:
        raise BadInput(source="--route", problem=f"large drives exudyn's own beams, without {option}", remedy=remedy)
    if question.asked.damping is not None or question.asked.joints:
        option = "--joints" if question.asked.joints else "--damping"
        raise BadInput(source="--route", problem=f"large drives exudyn's own beams, without {option}", remedy=remedy)
    if question.model not in (None, EXUDYN):
        problem = f"large drives exudyn's own beams, not the {question.model} model"
        raise BadInput(source="--route", problem=problem, remedy="Leave --model out, or take --route exudyn")
    if not is_stack(question.article):
        problem = f"large drives beams made of the dimensions of built-in articles, and {question.article} has none"
        raise BadInput(source="--route", problem=problem, remedy="Take --route linear or exudyn")


def _model(question: Question) -> str:
    from validation.flexible.chosen import chosen

    return chosen(question.article, question.model)[0]
