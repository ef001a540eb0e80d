"""The animation of `massline excite --animate`: the article as the sweep passes its largest resonance.

Frames are stroboscopic: from one to the next the drive goes on by a whole number of cycles and a tenth, so that the swing is
seen slowly while the load swells and falls as it does.
"""

from __future__ import annotations

from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.response import Response
from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.frames import rigid_transformation_6
from validation.article_reference import file_name
from validation.excitation.asked import LARGE, LINEAR
from validation.excitation.passage import Passed, amplitude, rigid_load
from validation.excitation.runs import Done, Ready
from validation.excitation.signals import LOAD_UNITS, LOADS
from validation.flexible.drawing import moved_bodies
from validation.pictures.moving import MovingBody
from validation.pictures.passing import Frame, Passing
from validation.pictures.passing import animate as draw

if TYPE_CHECKING:
    from fem.base_excitation.patterns import Sweep

FRAMES = 42
STROBE = 10
"""Frames in which one swing is seen."""

BEFORE, AFTER = 3.0, 4.0
"""How long is shown before and after the resonance, in 1 / sqrt(d(omega)/dt): a sweep needs that to swell and to leave."""

BASE = 6


def require_animable(made: Ready) -> None:
    """Refuse an animation of what has no shape, no resonance in the band or no one frequency, before it is driven.

    Raises
    ------
    BadInput : one of these.
    """
    model = made.mounted.model
    if made.route.name == LARGE:
        raise _refused("the large route keeps no coordinates", "Take --route linear or exudyn, or leave it out")
    if any(run.sweep is None for run in made.runs):
        raise _refused(f"{made.question.drive.pattern} passes no resonance", "Take --pattern sweep, or leave it out")
    if model is None or model.structure is None or model.drawn is None or not len(made.mounted.rig.article.kept):
        what = "a rigid article" if model is None else f"the {model.model} model of {model.article}"
        raise _refused(f"{what} has no shape that could be drawn", "Draw a beam or solid model, or leave it out")


def animate(made: Ready, one: Done, folder: Path) -> Path | None:
    """Write the passage of the largest resonance of `one` run into `folder`, and say where it is; None without a resonance.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    if one.run.sweep is None or not one.outcome.passed:
        return None
    path = folder / f"{file_name(f'excite-{made.question.article}-{made.route.name}-{one.run.name}')}.gif"
    draw(passing(made, one, one.run.sweep, max(one.outcome.passed, key=lambda p: p.amplification)), path)
    return path


def passing(made: Ready, one: Done, sweep: Sweep, mode: Passed) -> Passing:
    """What the animation of the passage of `mode` shows."""
    response = one.response
    swells = 1 / np.sqrt(2 * np.pi * mode.frequency * sweep.rate * np.log(2) / 60)
    begin = max(mode.time - BEFORE * swells, 0.0)
    end = min(max(mode.time + AFTER * swells, mode.peak_time + swells), response.time[-1])
    times = strobe(sweep, begin, end, mode.peak_time)
    shown = (response.time >= begin) & (response.time <= end)
    rigid = amplitude(rigid_load(response, made.modes.rigid_mass)[:, mode.axis])
    return Passing(
        title=f"{made.question.article} passes {mode.frequency:.2f} Hz",
        text=f"{one.run.pattern.label}",
        frames=_frames(made, one, times, sweep.frequency_at(times)),
        time=response.time[shown],
        load=response.load[shown, mode.axis],
        rigid=rigid[shown],
        label=f"{LOADS[mode.axis]} [{LOAD_UNITS[mode.axis]}]",
        resonance=mode.time,
    )


def strobe(sweep: Sweep, begin: float, end: float, peak: float) -> Array:
    """(`FRAMES`,) times [s] from `begin` to `end`, each a whole number of cycles and 1 / `STROBE` after the one before.

    Where there are fewer cycles than that, the frames are evenly spaced in the phase of the drive.
    """
    fine = np.linspace(begin, end, 20_000)
    frequency = sweep.frequency_at(fine)
    phase = np.concatenate([[0.0], np.cumsum((frequency[1:] + frequency[:-1]) / 2 * np.diff(fine))])
    step = phase[-1] / FRAMES
    if step > 1:
        step = np.floor(step - 1 / STROBE) + 1 / STROBE
    first = float(np.interp(peak, fine, phase)) % step
    return np.asarray(np.interp(first + step * np.arange(FRAMES), phase, fine))


def _frames(made: Ready, one: Done, times: Array, frequency: Array) -> tuple[Frame, ...]:
    from scipy.interpolate import CubicSpline

    model, body = made.mounted.model, made.mounted.rig.article
    if model is None:
        return ()
    coordinates = CubicSpline(one.response.time, _relative(made, one.motion, one.response), axis=0)(times)
    surfaces = moved_bodies(model, body.reduced.basis)
    return tuple(
        Frame(
            time=float(at),
            frequency=float(f),
            bodies=tuple(
                MovingBody(name=drawn.name, vertices=drawn.vertices, faces=drawn.faces, edges=edges, displacement=u @ x)
                for drawn, edges, u in surfaces
            ),
        )
        for at, f, x in zip(times, frequency, coordinates, strict=True)
    )


def _relative(made: Ready, motion: BaseMotion, response: Response) -> Array:
    """(n, 6 + m) coordinates of the article's reduced body, its base relative to the table."""
    from fem.base_excitation.decimation import decimated
    from fem.base_excitation.rig_structure import matrices

    rig = made.mounted.rig
    if made.route.name == LINEAR:
        return np.asarray(response.coordinates @ matrices(rig).article[:, BASE:].T)
    coordinates = np.array(response.coordinates)
    table = decimated(motion, response.sampling_rate).displacement
    coordinates[:, :BASE] -= table @ rigid_transformation_6(rig.seat).T
    return coordinates


def _refused(problem: str, remedy: str) -> BadInput:
    return BadInput(source="--animate", problem=problem, remedy=remedy)
