"""What a `Rig` must be before anybody makes equations of it."""

from __future__ import annotations

import numpy as np

from fem.base_excitation.rig import Cell, Flange, Rig, Strut
from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.frames import rigid_transformation
from geometry.keys import nearest

AXES = ("x", "y", "z")

HELD = 1e-12
"""Least stiffness of the cells together against any motion of the cover plate, as a share of the greatest."""


def require_usable(rig: Rig) -> Rig:
    """`rig` itself, when it can be built.

    Raises
    ------
    BadInput : a stiffness, damping, compliance, preload, slip force or mass out of its bounds, cells that do not hold the cover
        plate, a strut at a place that the article has not; the message names it.
    """
    _require(
        not np.any(rig.article.reduced.structural),
        "article.reduced",
        "its damping must be viscous, found structural damping, which a response in time does not know",
        "Make the body by fem.base_excitation.body",
    )
    for number, cell in enumerate(rig.cells, start=1):
        _require_cell(cell, f"cells.{number}")
    if rig.cells:
        _require_held(rig.cells)
    if rig.flange is not None:
        _require_flange(rig.flange)
    for strut in rig.struts:
        _require_strut(strut, rig)
    for friction in rig.frictions:
        _require(friction.axis in AXES[:2], "frictions.axis", f"it must be x or y, found {friction.axis!r}", "Name one of both")
        _require_positive("frictions.slip_force", friction.slip_force, "N")
        _require_positive("frictions.mass", friction.mass, "kg")
    return rig


def _require_cell(cell: Cell, name: str) -> None:
    for axis, k, c in zip(AXES, cell.stiffness, cell.damping, strict=True):
        _require_positive(f"{name}.stiffness", k, f"N/m along {axis}")
        _require_not_negative(f"{name}.damping", c, f"N s/m along {axis}")
    if cell.preload is not None:
        _require_positive(f"{name}.preload", cell.preload, "N")


def _require_held(cells: tuple[Cell, ...]) -> None:
    size = max(float(np.linalg.norm(cell.position)) for cell in cells)
    if size > 0:
        K = sum((_spring(cell, size) for cell in cells), np.zeros((6, 6)))
        if np.linalg.eigvalsh(K)[0] > HELD * np.linalg.eigvalsh(K)[-1]:
            return
    raise _bad(
        "cells",
        f"they must hold the cover plate against every motion, found {len(cells)} that leave it one",
        "Put at least three cells where they are not in one line",
    )


def _spring(cell: Cell, size: float) -> Array:
    G = rigid_transformation(cell.position / size)
    return np.asarray(G.T @ np.diag(cell.stiffness) @ G)


def _require_flange(flange: Flange) -> None:
    for value in flange.compliance:
        _require_not_negative("flange.compliance", value, "m/N or rad/(N m)")
    _require_not_negative("flange.damping_time", flange.damping_time, "s")


def _require_strut(strut: Strut, rig: Rig) -> None:
    known = rig.article.places
    if strut.place not in known:
        names = ", ".join(sorted(known)) or "none"
        problem = f"{rig.article.name} has no place {strut.place!r}"
        raise _bad("struts.place", problem, f"{nearest(strut.place, known)}Its places are {names}")
    _require(strut.to in ("ground", "table"), "struts.to", f"it must be ground or table, found {strut.to!r}", "Name one of both")
    for axis, k, c in zip(AXES, strut.stiffness, strut.damping, strict=True):
        _require_not_negative("struts.stiffness", k, f"N/m along {axis}")
        _require_not_negative("struts.damping", c, f"N s/m along {axis}")


def _require_positive(field: str, value: float, unit: str) -> None:
    _require(value > 0, field, f"it must be above zero, found {value:g} {unit}", "Check its sign and unit")


def _require_not_negative(field: str, value: float, unit: str) -> None:
    _require(value >= 0, field, f"it must not be negative, found {value:g} {unit}", "Check its sign and unit")


def _require(good: bool, field: str, problem: str, remedy: str) -> None:
    if not good:
        raise _bad(field, problem, remedy)


def _bad(field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source="rig", field=field, problem=problem, remedy=remedy)
