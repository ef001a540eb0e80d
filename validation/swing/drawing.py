"""The pictures of `massline swing`: the article on its ropes with the recorded twist below, still and moving."""

from __future__ import annotations

from dataclasses import replace
from pathlib import Path

import numpy as np

from fem.flexible_body.rope_pendulum import Swing
from fem.flexible_body.rope_pendulum.suspension import turned
from geometry.arrays import Array
from validation.article_reference import Asked, drawing, file_name
from validation.pictures.bodies import DrawnBody
from validation.pictures.pendulum_scene import Instant
from validation.pictures.pendulum_sheet import DrawnSwing, pendulum_animation, pendulum_picture
from validation.swing.record import Record
from validation.swing.setup import Setup
from validation.swing.shifts import Simulated

FRAMES_A_SECOND = 12
CYCLES = 1.0
"""Of the animation, which runs in its own time and begins anew."""


def draw(found: Simulated, asked: Asked, folder: Path, *, animate: bool, about: str = "") -> list[Path]:
    """Write the picture of `found` into `folder`, and the animation when asked for; say where they are.

    Raises
    ------
    CheckFailed : nothing can be rendered on this machine.
    """
    swing = drawn(found, asked)
    stem = file_name(f"swing-{found.record.setup.article}-{found.record.setup.axis}")
    picture = folder / f"{stem}.png"
    pendulum_picture(swing, picture, about)
    if not animate:
        return [picture]
    moving = folder / f"{stem}.gif"
    pendulum_animation(swing, moving)
    return [picture, moving]


def drawn(found: Simulated, asked: Asked) -> DrawnSwing:
    """What a picture of `found` shows.

    Raises
    ------
    BadInput : the article has no surface that can be drawn.
    """
    record, setup = found.record, found.record.setup
    _, bodies, inertia, _ = drawing(setup.article, asked)
    hanging = turned(setup.axis, setup.along)
    frames = _frames(record)
    return DrawnSwing(
        title=f"{setup.article} on {setup.suspension.ropes} ropes",
        text=f"T = {record.period:.4f} s ({100 * record.shift:+.3f} % from Eq. 5); inertia by Eq. 5 {100 * found.plain:+.3f} %, "
        f"corrected {100 * found.corrected:+.3f} %",
        bodies=tuple(_hung(body, hanging, inertia.cog) for body in bodies),
        rest=_at_rest(record.swing),
        instants=tuple(_instant(record.swing, k) for k in frames),
        moments=record.swing.time[frames],
        time=record.swing.time,
        signal=record.signal,
        fit=record.decay.fitted,
    )


def in_the_way(setup: Setup, asked: Asked) -> str:
    """A sentence where the article reaches out beyond the nearest rope above the ropes' feet; empty where nothing is in the way.

    Raises
    ------
    BadInput : the article has no surface that can be drawn.
    """
    _, bodies, inertia, _ = drawing(setup.article, asked)
    hanging = turned(setup.axis, setup.along)
    points = np.concatenate([_hung(body, hanging, inertia.cog).vertices for body in bodies])
    near = float(np.linalg.norm(setup.suspension.feet[:, :2], axis=1).min())
    beyond = points[np.linalg.norm(points[:, :2], axis=1) > near, 2]
    top = float(beyond.max(initial=-np.inf))
    if top <= setup.height:
        return ""
    return (
        f"{setup.article} reaches beyond the ropes up to {1000 * top:.0f} mm above its CoG, their feet are "
        f"{1000 * setup.height:.0f} mm above it: ropes may pass through it, which the simulation does not know. "
        f'With --height "{10 * np.ceil(100 * top):.0f} mm" they do not.'
    )


def _hung(body: DrawnBody, hanging: Array, cog: Array) -> DrawnBody:
    return replace(body, vertices=(body.vertices - cog) @ hanging.T)


def _frames(record: Record) -> list[int]:
    """Samples of the frames: whole cycles from the start, in equal steps."""
    time = record.swing.time
    end = min(CYCLES * record.period, float(time[-1]))
    moments = np.arange(0.0, end, 1 / FRAMES_A_SECOND)
    return sorted(set(np.searchsorted(time, moments).tolist()))


def _instant(swing: Swing, k: int) -> Instant:
    return Instant(place=swing.place[k], rotation=swing.rotation[k], chains=swing.chains[k])


def _at_rest(swing: Swing) -> Instant:
    """The sample nearest to no twist."""
    return _instant(swing, int(np.argmin(np.abs(swing.yaw))))
