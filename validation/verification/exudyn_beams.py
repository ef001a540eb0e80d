"""Rows about exudyn as the independent route: its own beams and its own eigen-solution, no element of ours.

Exudyn's beam is geometrically exact with linear shapes; `fem.flexible_body` solves a mesh and one twice as fine and extrapolates.
"""

from __future__ import annotations

from functools import partial

import numpy as np

from fem.flexible_body.articles import modes_of_plan
from fem.frame import Member, Plan
from fem.modes import Modes
from fem.section import Section
from validation.verification.beams import BENDING, RECTANGLE, ROD, STOCKY, TENSION, TORSION, TRANSCENDENTAL, closed_form
from validation.verification.check import Check, Found, Mesh, once

FAMILY = "Exudyn"

ELEMENTS = {Mesh.FAST: 10, Mesh.FINE: 20}
MODES = 8
MOVES = 0.01
"""Effective mass or inertia along an axis, as a share of the whole, from which a mode counts as moving along it."""

AXIS = {BENDING: 2, TENSION: 0, TORSION: 3}
"""Of the base: along z, along the bar, about the bar."""


@once
def _modes(section: Section, mesh: Mesh) -> Modes:
    """Modes of a bar along x, `STOCKY` long, clamped at its start."""
    numbers = tuple(range(ELEMENTS[mesh] + 1))
    member = Member(nodes=numbers, section=section, z_axis=np.array([0.0, 0.0, 1.0]))
    nodes = np.linspace([0, 0, 0], [STOCKY, 0, 0], len(numbers))
    return modes_of_plan(Plan(nodes=nodes, carriers=numbers, members=(member,)), MODES)


def _mode(section: Section, motion: str, number: int, mesh: Mesh) -> Found:
    modes, axis = _modes(section, mesh), AXIS[motion]
    moving = modes.effective_mass[:, axis] > MOVES * modes.rigid_mass[axis, axis]
    reference = closed_form(section, STOCKY, motion, True, number)[number - 1]
    return Found(float(reference), float(modes.frequency[moving][number - 1]))


def _row(what: str, source: str, section: Section, motion: str, number: int) -> Check:
    find = partial(_mode, section, motion, number)
    return Check(family=FAMILY, what=f"Exudyn's beams: {what}", source=source, unit="Hz", bar=1e-3, find=find)


CHECKS: tuple[Check, ...] = (
    *(_row(f"cantilever, 6 heights long, mode {k}", TRANSCENDENTAL, RECTANGLE, BENDING, k) for k in (1, 2, 3)),
    _row("rod in tension, mode 1", "c / (4 L), c² = E / rho", ROD, TENSION, 1),
    _row("round rod in torsion, mode 1", "c / (4 L), c² = G / rho", ROD, TORSION, 1),
)
