"""Which route answers a question, and every run of it: driven, simulated, brought down to the output's rate, put into figures."""

from __future__ import annotations

from collections.abc import Callable, Iterator
from dataclasses import dataclass, replace
from pathlib import Path
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.response import Response
from geometry.atomic import write_with
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array
from identification.files import files
from identification.files.files import Signals
from validation import output
from validation.excite.question import BAND, EXUDYN, HIGHEST_RATE, LARGE, LINEAR, LONGEST, ExciteOptions
from validation.excite.results import Amplitudes, Outcome, amplitudes, cell_loads, loose_parts, outcome, passed
from validation.excite.rig import ArticleOnTable, RigModes, Run, cross_motion, mounted, require_mountable, rig_modes, runs
from validation.output import percent, shown

if TYPE_CHECKING:
    from fem.base_excitation.patterns import CrossMotion, Pattern


# What a pattern or a route refuses, said of the option that asked for it, with advice that can be typed.


OF_PATTERN = {
    "start": ("--band", ""),
    "stop": ("--band", ""),
    "rate": ("--octaves-per-minute", "Sweep slower, or start higher with --band"),
    "duration": ("--duration", "Drive longer, or start higher with --band"),
    "level": ("--level", ""),
    "rms": ("--level", ""),
    "seed": ("--seed", ""),
}
"""Option and advice by the field of a pattern; no advice where the pattern's own can be followed."""

OF_RIG = {"flange": "--flange", "struts.stiffness": "--cable", "struts.damping": "--damper", "frictions": "--friction"}
"""Option by how the field of a rig begins."""

SOFTER = 0.9
"""Share of the rig's highest frequency below which it falls without the attachment that is to blame for it."""


def of_pattern(error: BadInput) -> BadInput:
    """`error` of a pattern that could not be made."""
    option, remedy = OF_PATTERN.get(error.field.partition(".")[0], ("--pattern", ""))
    return BadInput(source=option, problem=error.problem, remedy=remedy or error.remedy)


def of_rig(error: BadInput) -> BadInput:
    """`error` of a rig that cannot be built; others pass unchanged."""
    option = next((option for field, option in OF_RIG.items() if error.source == "rig" and error.field.startswith(field)), "")
    return BadInput(source=option, problem=error.problem, remedy=error.remedy) if option else error


def of_record(error: BadInput, pattern: Pattern, question: ExciteOptions) -> BadInput:
    """`error` of a record whose rate is too low for `pattern`."""
    from fem.base_excitation.response import PASS

    needed = float(np.ceil(2 * pattern.highest / PASS))
    option = "--rate" if question.drive.band == BAND else "--band"
    faster = f"Record at --rate {needed:.0f} or more, or stop" if needed <= HIGHEST_RATE else "Stop"
    return BadInput(source=option, problem=error.problem, remedy=f"{faster} lower with --band")


def of_route(error: BadInput, question: ExciteOptions, mounted: ArticleOnTable, followed: float) -> BadInput:
    """`error` of a route.

    Parameters
    ----------
    followed : [Hz] of a mode that the step follows at a step a sample
    """
    if error.source.startswith("--"):
        return error
    match error.field:
        case "sampling_rate":
            return _modes(question, mounted, followed)
        case "subdivision":
            from fem.exudyn.driven_run import highest

            # Something too stiff for exudyn's step: the attachment without which the highest frequency falls most
            rig = mounted.rig
            # `rig` without what an option adds to its stiffness, by that option
            left = {
                "--cable": replace(rig, struts=tuple(strut for strut in rig.struts if strut.to != "ground")),
                "--flange": replace(rig, flange=None),
                "--friction": replace(rig, frictions=()),
            }
            there = {
                "--cable": len(left["--cable"].struts) < len(rig.struts),
                "--flange": rig.flange,
                "--friction": rig.frictions,
            }
            without = {option: left[option] for option, given in there.items() if given}
            found = {option: highest(other) for option, other in without.items()}
            option = min(found, key=lambda name: found[name], default="")
            if not option or found[option] > SOFTER * highest(rig):
                if question.every_mode and rig.article.kept.max(initial=0.0) > followed:
                    return _modes(question, mounted, followed)
                option, stiff_remedy = "--modes", "Keep fewer"
            else:
                stiff_remedy = "Make the part lighter" if option == "--friction" else "Make it softer, leave it out"
            other = ", or take --route linear" if rig.linear else ""
            return BadInput(
                source=option, problem=f"it makes exudyn's steps too short: {error.problem}", remedy=f"{stiff_remedy}{other}"
            )
        case "displacement":
            return BadInput(source="--level", problem=error.problem, remedy=error.remedy)
        case "":
            remedy = "Record at a lower --rate, or make the run shorter"
            return BadInput(source="--rate", problem=error.problem, remedy=remedy)
    return of_rig(error)


def _modes(question: ExciteOptions, mounted: ArticleOnTable, followed: float) -> BadInput:
    """More modes than the step follows."""
    from fem.base_excitation.response import COARSEST

    kept = mounted.rig.article.kept
    count, last = int(np.sum(kept <= followed)), float(kept.max())
    problem = f"the step follows modes up to {followed:.4g} Hz, {count} of those, found {len(kept)} up to {last:.4g} Hz"
    fewer = f"Write --modes {count}, or leave it out" if count else "Leave it out"
    faster = COARSEST * last
    more = f", or record at --rate {np.ceil(faster):.0f}" if faster <= HIGHEST_RATE and question.route != EXUDYN else ""
    return BadInput(source="--modes", problem=problem, remedy=f"{fewer}: the others then answer statically{more}")


STIFF = 10.0
"""Times the highest driven frequency at which a first mode swells no load by more than 1 %."""

CUT = "The record ends at"
"""How a warning of `fem.base_excitation.response` begins."""

Progress = Callable[[float], None]


@dataclass(frozen=True, kw_only=True)
class Route:
    """How runs are computed, and why so."""

    name: str
    why: str


@dataclass(frozen=True, eq=False, kw_only=True)
class PreparedRuns:
    """A question with all that it needs before a run is made.

    Attributes
    ----------
    question : as it was asked
    mounted : the article on the table
    modes : resonances of the rig
    route : which one answers
    runs : to be made
    """

    question: ExciteOptions
    mounted: ArticleOnTable
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


def ready(question: ExciteOptions, *, quiet: bool = False) -> PreparedRuns:
    """Everything that can be refused is, and the article is reduced.

    Raises
    ------
    BadInput : something in `question` cannot be.
    """
    from validation.flexible.model import chosen

    model = chosen(question.article, question.model)[0]
    # The route asked for, or the one that fits
    nonlinear = [option for option in question.attached.options if option in ("--preload", "--friction")]
    because = f"{' and '.join(nonlinear)} {'are' if len(nonlinear) > 1 else 'is'} not linear"
    if question.route is None:
        if nonlinear:
            route = Route(name=EXUDYN, why=f"chosen because {because}")
        else:
            route = Route(name=LINEAR, why="chosen because everything in the rig is linear")
    else:
        if question.route == LINEAR and nonlinear:
            remedy = "Leave --route out, or take --route exudyn"
            raise BadInput(
                source="--route", problem=f"the exact recursion answers linear rigs only, and {because}", remedy=remedy
            )
        if question.route == LARGE:
            _require_plain(question)
        route = Route(name=question.route, why="as asked")
    require_mountable(question.article, model, question.asked, question.attached)
    to_make = _to_make(question)
    highest = np.inf if question.every_mode else _followed(question)
    with shown(f"model of {question.article}", quiet=quiet):
        made = mounted(question.article, model, question.asked, question.attached, highest)
        try:
            modes = rig_modes(made.rig)
        except BadInput as error:
            raise of_rig(error) from None
        return PreparedRuns(question=question, mounted=made, modes=modes, route=route, runs=to_make)


def done(made: PreparedRuns, *, keep_coordinates: bool = False, quiet: bool = False) -> Iterator[Done]:
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


def _to_make(question: ExciteOptions) -> tuple[Run, ...]:
    """The runs, which a record at the output's rate can hold."""
    from fem.base_excitation.response import require_recorded

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


def _followed(question: ExciteOptions) -> float:
    """[Hz] of the modes that the step can follow."""
    from fem.base_excitation.response import COARSEST, simulation_rate

    return simulation_rate(question.rate) / COARSEST


def _done(made: PreparedRuns, run: Run, cross: CrossMotion | None, progress: Progress, keep: bool) -> Done:
    from fem.base_excitation import response as ring_down
    from fem.base_excitation.response import decimated, judge, simulation_rate

    rate, rig = made.question.rate, made.mounted.rig
    at_rest = run.motion(rate, ring_down=0.0, cross=cross)
    length = ring_down.needed(rig, at_rest)
    motion = run.motion(simulation_rate(rate), ring_down=_rest(made, length - at_rest.driven), cross=cross)
    simulated = _ROUTES[made.route.name](made, motion, progress, keep)
    response = decimated(simulated, rate)
    found = amplitudes(response, run, made.modes.rigid_mass)
    # What the route warned of, and that the record is `cut`, in the words of the command line
    cut = _cut(ring_down.judged(length, motion), length - motion.driven)
    others = (warning for warning in response.warnings if not warning.startswith(CUT))
    warnings = (*others, *([cut] if cut else []))
    # What to do where the table turns beyond the limit of small motion; nothing where all is exact or it does not
    small = judge(motion)
    if small.within or made.route.name == "large":
        turned: tuple[str, ...] = ()
    else:
        turned = (f"{small.text[:-1]}. Lower --level, or take --route large, which turns the table really",)
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
                *warnings,
                *turned,
            ),
        ),
    )


def _cut(said: str, needed: float) -> str:
    """The sentence `said` of a record that is cut, and what to type where `needed` [s] after the drive can be recorded."""
    if not said or not needed <= LONGEST:
        return said
    return f'{said}. Write --ring-down "{np.ceil(10 * needed) / 10:g} s", or leave it out'


def _rest(made: PreparedRuns, needed: float) -> float:
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


def _linear(made: PreparedRuns, motion: BaseMotion, progress: Progress, keep: bool) -> Response:
    from fem.base_excitation import response

    return response.respond(made.mounted.rig, motion, keep_coordinates=keep, progress=progress)


def _exudyn(made: PreparedRuns, motion: BaseMotion, progress: Progress, keep: bool) -> Response:
    from fem.exudyn import driven_run

    return driven_run.respond(made.mounted.rig, motion, keep_coordinates=keep, progress=progress)


def _large(made: PreparedRuns, motion: BaseMotion, progress: Progress, keep: bool) -> Response:
    from fem.exudyn import large_motion
    from fem.exudyn.large_motion import ELEMENTS
    from geometry.articles import changes_of
    from geometry.articles.locations import locations

    question = made.question
    changes = changes_of(question.article, question.asked.changes)
    elements = None if as_one_body(made) else ELEMENTS
    places = locations(question.article, changes)
    return large_motion.respond(question.article, motion, changes=changes, places=places, progress=progress, elements=elements)


def as_one_body(made: PreparedRuns) -> bool:
    """Whether the large route takes the article as one rigid body: its first mode lies so far above all that is driven."""
    kept = made.mounted.rig.article.kept
    return not len(kept) or float(kept[0]) >= STIFF * max(run.pattern.highest for run in made.runs)


_ROUTES: dict[str, Callable[[PreparedRuns, BaseMotion, Progress, bool], Response]] = {
    LINEAR: _linear,
    EXUDYN: _exudyn,
    LARGE: _large,
}


def _require_plain(question: ExciteOptions) -> None:
    """Refuse what exudyn's own beams on a turning base have not."""
    from validation.model.setups import is_stack

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


# Runs as signal files: every channel of a `Response` by name, as the campaign format has them, whole or not at all.
#
# Universal files, HDF5, CSV and MATLAB are written by `identification.files.files`, which a campaign is read by; ``.npz`` holds
# one
# array a channel and ``sampling_rate``. Values are SI; but for the thirteen digits of an ASCII universal file they are bit for
# bit those that were computed.


LOADS = ("fx", "fy", "fz", "mx", "my", "mz")
"""Forces and moments of the table on what stands on it, about the reference point."""

NPZ = ".npz"
ENDINGS = (*files.FORMATS, NPZ)

MOTION_UNITS = ("m/s^2",) * 3 + ("rad/s^2",) * 3
LOAD_UNITS = ("N",) * 3 + ("N m",) * 3


@dataclass(frozen=True, eq=False, kw_only=True)
class Channel:
    """One signal (n,) in its SI `unit`."""

    name: str
    unit: str
    values: Array


def channels(response: Response) -> tuple[Channel, ...]:
    """All signals of `response`: table, cover plate, loads, cells, places."""
    found = [
        *_six("table", MOTIONS, MOTION_UNITS, response.table),
        *_six("cover", MOTIONS, MOTION_UNITS, response.cover),
        *_six("load", LOADS, LOAD_UNITS, response.load),
    ]
    for number in range(response.cells.shape[1]):
        found += _along(f"cell-{number + 1}", "", "N", response.cells[:, number])
    for place, acceleration in response.places.items():
        found += _along(place, "-", "m/s^2", acceleration)
    return tuple(found)


def require_ending(path: Path) -> None:
    """Refuse a `path` that names no format, as `validation.output.require_ending`."""
    output.require_ending(path, ENDINGS, "a run", "out/x.h5")


def write(path: Path, response: Response, label: str) -> None:
    """Write all channels of `response`, a run called `label`, in the format that the ending of `path` names.

    Raises
    ------
    BadInput : see `require_ending`.
    """
    require_ending(path)
    if path.suffix.lower() == NPZ:
        write_with(path, lambda temporary: _npz(temporary, response, label))
    else:
        files.write(path, _signals(path, response))


def _signals(path: Path, response: Response) -> Signals:
    found = channels(response)
    return Signals(
        source=str(path),
        samples={channel.name: channel.values for channel in found},
        sampling_rate=response.sampling_rate,
        labels={channel.name: channel.unit for channel in found},
    )


def _six(group: str, names: tuple[str, ...], units: tuple[str, ...], values: Array) -> list[Channel]:
    listed = zip(names, units, values.T, strict=True)
    return [Channel(name=f"{group}-{name}", unit=unit, values=signal) for name, unit, signal in listed]


def _along(name: str, dash: str, unit: str, values: Array) -> list[Channel]:
    return [Channel(name=f"{name}{dash}{axis}", unit=unit, values=values[:, k]) for k, axis in enumerate("xyz")]


def _npz(path: Path, response: Response, label: str) -> None:
    arrays: dict[str, Any] = {channel.name: channel.values for channel in channels(response)}
    np.savez_compressed(path, sampling_rate=np.array(response.sampling_rate), label=np.array(label), **arrays)
