"""What a `Rig` must be before anybody makes equations of it."""

from __future__ import annotations

import sys
from math import pi

import numpy as np

from fem.base_excitation.rig import Cell, Flange, Rig, Strut
from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import rigid_transformation
from geometry.keys import nearest

AXES = MOTIONS[:3]

HELD = 1e-12
"""Least stiffness of the cells together against any motion of the cover plate, as a share of the greatest."""

SLOWEST, FASTEST = 0.01, 1e5
"""[Hz] between which the article must swing on one joint, strut or cell alone. A softer joint holds nothing, a stiffer one is
rigid to all that is sampled; further apart, rounding in the stiffest would hide what the softest does."""

SOFTEST, STIFFEST = (2 * pi * SLOWEST) ** 2, (2 * pi * FASTEST) ** 2
"""Stiffness over mass [1/s²] of these."""

MOST_VISCOUS = 1e7
"""Damping over mass [1/s]: beyond it, what is damped is as good as held, and rounding may feed energy in."""

HEAVIEST = 10.0
"""Times the mass of the article that a loose part may have."""


def require_usable(rig: Rig) -> Rig:
    """`rig` itself, when it can be built.

    Raises
    ------
    BadInput : a stiffness, damping, compliance, preload, slip force or mass out of its bounds, one with which what it holds would
        swing outside `SLOWEST` to `FASTEST`, cells that do not hold the cover plate, a strut at a place that the article has not;
        the message names it.
    """
    _require(
        not np.any(rig.article.reduced.structural),
        "article.reduced",
        "its damping must be viscous, found structural damping, which a response in time does not know",
        "Make the body by fem.base_excitation.body",
    )
    carried = _mass(rig) + (0.0 if rig.cover is None else rig.cover.mass)
    for number, cell in enumerate(rig.cells, start=1):
        _require_cell(cell, f"cells.{number}", carried)
    if rig.cells:
        _require_held(rig.cells)
    if rig.flange is not None:
        _require_flange(rig.flange, np.diag(rig.article.reduced.mass)[:6])
    for strut in rig.struts:
        _require_strut(strut, rig)
    for friction in rig.frictions:
        _require(friction.axis in AXES[:2], "frictions.axis", f"it must be x or y, found {friction.axis!r}", "Name one of both")
        _require_positive("frictions.slip_force", friction.slip_force, "N")
        _require_positive("frictions.mass", friction.mass, "kg")
        _require(
            friction.mass <= HEAVIEST * _mass(rig),
            "frictions.mass",
            f"it may be up to {HEAVIEST * _mass(rig):.4g} kg, {HEAVIEST:g} times the article, found {friction.mass:g} kg",
            "Check its unit, or count it to the article",
        )
    return rig


def _mass(rig: Rig) -> float:
    return float(rig.article.reduced.mass[0, 0])


def _require_cell(cell: Cell, name: str, carried: float) -> None:
    for axis, k, c in zip(AXES, cell.stiffness, cell.damping, strict=True):
        _require_positive(f"{name}.stiffness", k, f"N/m along {axis}")
        _require_not_negative(f"{name}.damping", c, f"N s/m along {axis}")
        _require_within(f"{name}.stiffness", k, (SOFTEST * carried, STIFFEST * carried), f"N/m along {axis}")
        _require_within(f"{name}.damping", c, (0.0, MOST_VISCOUS * carried), f"N s/m along {axis}")
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


def _require_flange(flange: Flange, carried: Array) -> None:
    """`carried` (6,): what the article weighs along, and its moments of inertia about, the axes of the joint."""
    _require_not_negative("flange.damping_time", flange.damping_time, "s")
    for axis, value, m in zip(MOTIONS, flange.compliance.tolist(), carried.tolist(), strict=True):
        _require_not_negative("flange.compliance", value, "m/N or rad/(N m)")
        if value > 0:
            size = max(m, sys.float_info.min)
            unit = f"{'m/N' if axis in AXES else 'rad/(N m)'} for {axis}"
            _require_within("flange.compliance", value, (1 / (STIFFEST * size), 1 / (SOFTEST * size)), unit)
            _require_within("flange.damping_time", flange.damping_time, (0.0, MOST_VISCOUS * size * value), f"s for {axis}")


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
        _require_within("struts.stiffness", k, (0.0, STIFFEST * _mass(rig)), f"N/m along {axis}")
        _require_within("struts.damping", c, (0.0, MOST_VISCOUS * _mass(rig)), f"N s/m along {axis}")


def _require_positive(field: str, value: float, unit: str) -> None:
    _require(value > 0, field, f"it must be above zero, found {value:g} {unit}", "Check its sign and unit")


def _require_not_negative(field: str, value: float, unit: str) -> None:
    _require(value >= 0, field, f"it must not be negative, found {value:g} {unit}", "Check its sign and unit")


def _require_within(field: str, value: float, bounds: tuple[float, float], unit: str) -> None:
    low, high = bounds
    _require(
        low <= value <= high,
        field,
        f"for what it holds it must lie between {low:.3g} and {high:.3g} {unit}, found {value:g}",
        "Check its unit; leave out what is as good as rigid, and what holds nothing",
    )


def _require(good: bool, field: str, problem: str, remedy: str) -> None:
    if not good:
        raise _bad(field, problem, remedy)


def _bad(field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source="rig", field=field, problem=problem, remedy=remedy)
