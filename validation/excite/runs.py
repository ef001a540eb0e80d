"""Which route answers a question, and every run of it: driven, simulated, brought down to the output's rate, put into figures."""

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
from validation.excite import results
from validation.excite.question import BAND, EXUDYN, HIGHEST_RATE, LARGE, LINEAR, LONGEST, ExciteOptions
from validation.excite.rig import ArticleOnTable, RigModes, Run, cross_motion, mounted, require_mountable, rig_modes, runs
from validation.output import share_done, shown

if TYPE_CHECKING:
    from fem.base_excitation.patterns import CrossMotion
    from fem.base_excitation.rig import Rig


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


def of_rig(error: BadInput) -> BadInput:
    """`error` of a rig that cannot be built; others pass unchanged."""
    option = next((option for field, option in OF_RIG.items() if error.source == "rig" and error.field.startswith(field)), "")
    return BadInput(option, "", error.problem, error.remedy) if option else error


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
class Done:
    """One run that was made.

    Attributes
    ----------
    run : what was driven
    motion : of the table, as it was simulated
    response : at the output's rate
    outcome : its figures
    """

    run: Run
    motion: BaseMotion
    response: Response
    outcome: results.Outcome


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

    @property
    def about_article(self) -> bool:
        """Whether loads are about the article's own origin, which stands on the table itself; else about F."""
        return self.mounted.rig.cover is None and self.mounted.model is not None

    @property
    def as_one_body(self) -> bool:
        """Whether the large route takes the article as one rigid body: its first mode lies so far above all that is driven."""
        kept = self.mounted.rig.article.kept
        return not len(kept) or float(kept[0]) >= STIFF * max(run.pattern.highest for run in self.runs)

    def done(self, *, keep_coordinates: bool = False, quiet: bool = False) -> Iterator[Done]:
        """The runs, one after the other, each gone from memory when the next is made unless the caller keeps it.

        Raises
        ------
        BadInput, CheckFailed : what the route refuses, or fails at.
        """
        cross = cross_motion(self.question.drive)
        for number, run in enumerate(self.runs, start=1):
            words = f"{run.name}, {self.route.name} ({number} of {len(self.runs)})"
            with share_done(words, quiet=quiet) as progress:
                try:
                    one = self._driven(run, cross, progress, keep_coordinates)
                except BadInput as error:
                    raise self._refused(error) from None
            yield one  # outside: the caller may show what it is doing with it

    def _driven(self, run: Run, cross: "CrossMotion | None", progress: Progress, keep: bool) -> Done:
        from fem.base_excitation import response as ring_down
        from fem.base_excitation.response import decimated, simulation_rate

        rate, rig = self.question.rate, self.mounted.rig
        at_rest = run.motion(rate, ring_down=0.0, cross=cross)
        length = ring_down.needed(rig, at_rest)
        motion = run.motion(simulation_rate(rate), ring_down=self._rest(length - at_rest.driven), cross=cross)
        simulated = self._response(motion, progress, keep)
        response = decimated(simulated, rate)
        amplitudes = results.Amplitudes.of(response, run, self.modes.rigid_mass)
        needed, small = max(length - motion.driven, 0.0), ring_down.judge(motion)
        # What the route warned of, that the record is cut, and where the table turns too far, in the words of the command line
        warnings = [warning for warning in response.warnings if not warning.startswith(CUT)]
        if cut := ring_down.judged(length, motion):
            write = f'. Write --ring-down "{np.ceil(10 * (length - motion.driven)) / 10:g} s", or leave it out'
            warnings.append(cut + (write if length - motion.driven <= LONGEST else ""))
        if not small.within and self.route.name != LARGE:
            warnings.append(f"{small.text[:-1]}. Lower --level, or take --route large, which turns the table really")
        size = np.abs(response.load)
        duration = (len(size) - 1) / response.sampling_rate
        step = response.settings.get("step_s")
        outcome = results.Outcome(
            name=run.name,
            label=run.pattern.label,
            duration=duration,
            driven=motion.driven,
            levels=tuple(results.AxisResponse.of(axis, run, response, motion.driven) for axis in run.axes),
            cross=results.cross_share(run, response),
            small=small,
            peak_load=size.max(axis=0),
            peak_time=response.time[size.argmax(axis=0)],
            passed=() if amplitudes is None else amplitudes.passed(run, self.modes),
            ring_down=results.RingDown(kept=max(duration - motion.driven, 0.0), needed=needed),
            cells=tuple(results.CellLoad.of(k + 1, simulated.cells[:, k], cell) for k, cell in enumerate(rig.cells)),
            loose=tuple(
                results.LoosePart(axis=part.axis, mass=part.mass, slip_force=part.slip_force, share_slipping=share)
                for part, share in zip(rig.frictions, simulated.slipping, strict=True)
            ),
            step=step if isinstance(step, float) else 1 / motion.sampling_rate,
            settings=response.settings,
            warnings=tuple(warnings),
        )
        return Done(run=run, motion=motion, response=response, outcome=outcome)

    def _rest(self, needed: float) -> float:
        """[s] of record after the drive; refuses one as long as a ringing that has no end, or none that could be recorded."""
        asked = self.question.drive.ring_down
        if asked is not None:
            return asked
        if needed <= LONGEST:
            return max(needed, 0.0)
        endless = "a driven mode has no damping and never stops ringing"
        takes = f"the ringing takes {needed:.4g} s" if np.isfinite(needed) else endless
        raise BadInput("--ring-down", "", takes, 'Give a time, such as --ring-down "20 s", or more damping')

    def _response(self, motion: BaseMotion, progress: Progress, keep: bool) -> Response:
        """What the rig does, by the route that answers."""
        if self.route.name == LINEAR:
            from fem.base_excitation import response

            return response.respond(self.mounted.rig, motion, keep_coordinates=keep, progress=progress)
        if self.route.name == EXUDYN:
            from fem.exudyn import driven_run

            return driven_run.respond(self.mounted.rig, motion, keep_coordinates=keep, progress=progress)
        from fem.exudyn import large_motion
        from geometry.articles import changes_of, locations

        question = self.question
        changes = changes_of(question.article, question.asked.changes)
        elements = None if self.as_one_body else large_motion.ELEMENTS
        places = locations(question.article, changes)
        return large_motion.respond(
            question.article, motion, changes=changes, places=places, progress=progress, elements=elements
        )

    def _refused(self, error: BadInput) -> BadInput:
        """`error` of a route, said of the option that asked for it."""
        if error.source.startswith("--"):
            return error
        match error.field:
            case "sampling_rate":
                return self._too_many_modes()
            case "subdivision":
                return self._too_stiff(error)
            case "displacement":
                return BadInput("--level", "", error.problem, error.remedy)
            case "":
                remedy = "Record at a lower --rate, or make the run shorter"
                return BadInput("--rate", "", error.problem, remedy)
        return of_rig(error)

    def _too_stiff(self, error: BadInput) -> BadInput:
        """Something too stiff for exudyn's step: the attachment without which the highest frequency falls most."""
        from fem.exudyn.driven_run import highest

        rig = self.mounted.rig
        to_table = tuple(strut for strut in rig.struts if strut.to != "ground")
        without: dict[str, Rig] = {}
        if len(to_table) < len(rig.struts):
            without["--cable"] = replace(rig, struts=to_table)
        if rig.flange:
            without["--flange"] = replace(rig, flange=None)
        if rig.frictions:
            without["--friction"] = replace(rig, frictions=())
        found = {option: highest(other) for option, other in without.items()}
        option = min(found, key=lambda name: found[name], default="")
        if not option or found[option] > SOFTER * highest(rig):
            if self.question.every_mode and rig.article.kept.max(initial=0.0) > _followed(self.question):
                return self._too_many_modes()
            option, remedy = "--modes", "Keep fewer"
        else:
            remedy = "Make the part lighter" if option == "--friction" else "Make it softer, leave it out"
        other = ", or take --route linear" if rig.linear else ""
        return BadInput(option, "", f"it makes exudyn's steps too short: {error.problem}", f"{remedy}{other}")

    def _too_many_modes(self) -> BadInput:
        """More modes than the step follows."""
        from fem.base_excitation.response import COARSEST

        kept, followed = self.mounted.rig.article.kept, _followed(self.question)
        count, last = int(np.sum(kept <= followed)), float(kept.max())
        problem = f"the step follows modes up to {followed:.4g} Hz, {count} of those, found {len(kept)} up to {last:.4g} Hz"
        fewer = f"Write --modes {count}, or leave it out" if count else "Leave it out"
        faster = COARSEST * last
        can = faster <= HIGHEST_RATE and self.question.route != EXUDYN
        more = f", or record at --rate {np.ceil(faster):.0f}" if can else ""
        return BadInput("--modes", "", problem, f"{fewer}: the others then answer statically{more}")


def _followed(question: ExciteOptions) -> float:
    """[Hz] of the modes that the step can follow, at a step a sample."""
    from fem.base_excitation.response import COARSEST, simulation_rate

    return simulation_rate(question.rate) / COARSEST


def ready(question: ExciteOptions, *, quiet: bool = False) -> PreparedRuns:
    """Everything that can be refused is, and the article is reduced.

    Raises
    ------
    BadInput : something in `question` cannot be.
    """
    from fem.base_excitation.response import PASS, require_recorded
    from validation.flexible.model import chosen

    model = chosen(question.article, question.model)[0]
    # The route asked for, or the one that fits
    nonlinear = [option for option in question.attached.options if option in ("--preload", "--friction")]
    because = f"{' and '.join(nonlinear)} {'are' if len(nonlinear) > 1 else 'is'} not linear"
    if question.route is not None:
        if question.route == LINEAR and nonlinear:
            problem = f"the exact recursion answers linear rigs only, and {because}"
            raise BadInput("--route", "", problem, "Leave --route out, or take --route exudyn")
        if question.route == LARGE:
            _require_plain(question)
        route = Route(name=question.route, why="as asked")
    elif nonlinear:
        route = Route(name=EXUDYN, why=f"chosen because {because}")
    else:
        route = Route(name=LINEAR, why="chosen because everything in the rig is linear")
    require_mountable(question.article, model, question.asked, question.attached)
    try:
        to_make = runs(question.drive)
    except BadInput as error:
        option, remedy = OF_PATTERN.get(error.field.partition(".")[0], ("--pattern", ""))
        raise BadInput(option, "", error.problem, remedy or error.remedy) from None
    for run in to_make:
        try:
            require_recorded(run.pattern.highest, question.rate, "--rate")
        except BadInput as error:
            needed = float(np.ceil(2 * run.pattern.highest / PASS))
            option = "--rate" if question.drive.band == BAND else "--band"
            faster = f"Record at --rate {needed:.0f} or more, or stop" if needed <= HIGHEST_RATE else "Stop"
            raise BadInput(option, "", error.problem, f"{faster} lower with --band") from None
    highest = np.inf if question.every_mode else _followed(question)
    with shown(f"model of {question.article}", quiet=quiet):
        made = mounted(question.article, model, question.asked, question.attached, highest)
        try:
            modes = rig_modes(made.rig)
        except BadInput as error:
            raise of_rig(error) from None
        return PreparedRuns(question=question, mounted=made, modes=modes, route=route, runs=to_make)


def _require_plain(question: ExciteOptions) -> None:
    """Refuse what exudyn's own beams on a turning base have not."""
    from validation.model.setups import is_stack

    without = [*question.attached.options]
    if question.asked.damping is not None or question.asked.joints:
        without.append("--joints" if question.asked.joints else "--damping")
    if without:
        problem = f"large drives exudyn's own beams, without {without[0]}"
        raise BadInput("--route", "", problem, "Leave it out, or take --route exudyn")
    if question.model not in (None, EXUDYN):
        problem = f"large drives exudyn's own beams, not the {question.model} model"
        raise BadInput("--route", "", problem, "Leave --model out, or take --route exudyn")
    if not is_stack(question.article):
        problem = f"large drives beams made of the dimensions of built-in articles, and {question.article} has none"
        raise BadInput("--route", "", problem, "Take --route linear or exudyn")


# Runs as signal files: every channel of a `Response` by name, as the campaign format has them, whole or not at all.
#
# Universal files, HDF5, CSV and MATLAB are written by `identification.files.files`, which a campaign is read by; ``.npz``
# holds one array a channel and ``sampling_rate``. Values are SI; but for the thirteen digits of an ASCII universal file they are
# bit for bit those that were computed.


NPZ = ".npz"
ENDINGS = (*files.FORMATS, NPZ)

MOTION_UNITS = ("m/s^2",) * 3 + ("rad/s^2",) * 3


@dataclass(frozen=True, eq=False, kw_only=True)
class Channel:
    """One signal (n,) in its SI `unit`."""

    name: str
    unit: str
    values: Array


def channels(response: Response) -> tuple[Channel, ...]:
    """All signals of `response`: table, cover plate, loads, cells, places."""
    groups = [
        ([f"table-{name}" for name in MOTIONS], MOTION_UNITS, response.table),
        ([f"cover-{name}" for name in MOTIONS], MOTION_UNITS, response.cover),
        ([f"load-{name}" for name in results.LOADS], results.LOAD_UNITS, response.load),
        *(([f"cell-{k + 1}{axis}" for axis in "xyz"], ("N",) * 3, response.cells[:, k]) for k in range(response.cells.shape[1])),
        *(([f"{place}-{axis}" for axis in "xyz"], ("m/s^2",) * 3, values) for place, values in response.places.items()),
    ]
    return tuple(
        Channel(name=name, unit=unit, values=signal)
        for names, units, values in groups
        for name, unit, signal in zip(names, units, values.T, strict=True)
    )


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
    found = channels(response)
    if path.suffix.lower() == NPZ:
        arrays: dict[str, Any] = {channel.name: channel.values for channel in found}
        arrays |= {"sampling_rate": np.array(response.sampling_rate), "label": np.array(label)}
        write_with(path, lambda temporary: np.savez_compressed(temporary, **arrays))
        return
    signals = Signals(
        source=str(path),
        samples={channel.name: channel.values for channel in found},
        sampling_rate=response.sampling_rate,
        labels={channel.name: channel.unit for channel in found},
    )
    files.write(path, signals)
