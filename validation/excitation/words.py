"""A rig and a route in words: what stands on what, what is attached, and how it was computed."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fem.base_excitation.rig import Cell, Flange, Friction, Rig, Strut
from geometry.arrays import Array
from validation.excitation.attached import COMPLIANT
from validation.excitation.rig import FMD, Mounted
from validation.excitation.rig_modes import RigModes


def rig(mounted: Mounted, modes: RigModes) -> tuple[str, ...]:
    """Sentences, from the table up."""
    made = mounted.rig
    return (
        f"{_stands(mounted)}; the table carries {modes.rigid_mass[0, 0]:.4g} kg. Loads about {_point(made)}.",
        *filter(None, (_cells(made.cells), _flange(made.flange))),
        *map(_strut, made.struts),
        *map(_friction, made.frictions),
        *_kept(mounted, modes),
    )


def _stands(mounted: Mounted) -> str:
    made = mounted.rig
    under = "on its four load cells, springs of assumed stiffness" if made.cells else "which is rigid on the table"
    if mounted.article == FMD:
        return f"The FMD's cover plate ({2 * float(made.article.reduced.mass[0, 0]):.4g} kg) alone, {under}"
    if made.cover is None:
        return f"{made.article.name} on the table itself"
    height = 1e3 * made.seat[2]
    return f"{made.article.name} on the FMD's cover plate ({made.cover.mass:.4g} kg, top {height:g} mm above F), {under}"


def _point(made: Rig) -> str:
    return "the article's origin" if made.cover is None else "F, the centre of the force-measuring plane"


def _cells(cells: tuple[Cell, ...]) -> str:
    if not cells:
        return ""
    stiffness = ", ".join(f"{k:.3g}" for k in cells[0].stiffness)
    loads = [cell.preload for cell in cells]
    off = [f"cell {k} at {load:g} N" for k, load in enumerate(loads, start=1) if load is not None]
    same = len(off) == len(cells) and len(set(loads)) == 1
    lifts = f"each lifts off at {loads[0]:g} N" if same else f"{', '.join(off)} lifts off" if off else "none lifts off"
    return f"Load cells: {stiffness} N/m along x, y, z each; {lifts}."


def _flange(flange: Flange | None) -> str:
    if flange is None:
        return ""
    given = [
        f"{name} {flange.compliance[axes[0]]:.3g} {'m/N' if axes[0] < 3 else 'rad/(N m)'}"
        for name, axes in COMPLIANT.items()
        if flange.compliance[axes[0]]
    ]
    return f"The flange gives: {', '.join(given)}."


def _strut(strut: Strut) -> str:
    if strut.to == "ground":
        return f"A cable from {strut.place} to the ground: {_along(strut.stiffness)} N/m along x, y, z."
    return f"A damper from {strut.place} to the table: {_along(strut.damping)} N s/m along x, y, z."


def _along(values: Array) -> str:
    return ", ".join(f"{value:g}" for value in values)


def _friction(friction: Friction) -> str:
    part = f"A loose part of {friction.mass:g} kg on the flange"
    return f"{part}, held along {friction.axis} by {friction.slip_force:g} N of friction."


def _kept(mounted: Mounted, modes: RigModes) -> Iterator[str]:
    if mounted.model is None:
        return
    kept = mounted.rig.article.kept
    if not len(kept):
        first = mounted.model.modes.frequency[:1]
        why = f": its first mode lies at {first[0]:.4g} Hz, beyond what the step follows" if len(first) else ""
        yield f"{mounted.model.model} model, taken as rigid{why}."
        return
    lowest = float(np.min(modes.frequency))
    yield (
        f"{mounted.model.model} model with {len(kept)} modes, {kept[0]:.4g} to {kept[-1]:.4g} Hz, and what the others answer "
        f"statically; on the table the lowest resonance is {lowest:.4g} Hz."
    )
    yield from mounted.model.notes
