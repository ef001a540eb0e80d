"""`Conditions`: under what an article is driven, and what motions and methods can be used for it."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field
from types import MappingProxyType

import numpy as np

from fem.base_excitation.base_motion import BaseMotion
from fem.flexible_body.driven_base.solver import Solver
from geometry.arrays import Array, frozen
from geometry.errors import BadInput

AXES = ("table", "laboratory")

LOSS_FREQUENCY = 12.0
"""[Hz] where most modes of Clumod lie."""

STEEP = 1.4
"""[rad] up to which beta may go: at a quarter turn exudyn's angles about x and z become one."""

SOLVER = Solver(method="generalised-alpha", subdivision=1)
"""Stable for the axial swinging of short beams, far above any step, and it damps that. A mode of damping ratio zeta is off by
(omega h)² / (12 zeta) at its resonance, 0.2 % for 12 Hz and 0.003 at 8 kHz."""

AT_REST = 1e-6
"""Share of its largest value with which a motion may begin: exudyn starts a table that stands still in its origin."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Conditions:
    """Under what an article is driven.

    Attributes
    ----------
    gravity : [m/s²] along -z of the laboratory
    loss_frequency : [Hz] at which viscous damping equals the parts' loss factors; None for no damping
    axes : in which loads and accelerations are told, the "table"'s own or those of the "laboratory"
    places : (3,) [m] in the article's frame, by name, whose acceleration is told

    Raises
    ------
    BadInput : a value out of its bounds.
    """

    gravity: float = 0.0
    loss_frequency: float | None = LOSS_FREQUENCY
    axes: str = "table"
    places: Mapping[str, Array] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        if not np.isfinite(self.gravity):
            raise _bad("gravity", f"it must be finite, found {self.gravity:g} m/s²", "Give 9.81, or 0 for none")
        if self.loss_frequency is not None and not 0 < self.loss_frequency < np.inf:
            problem = f"it must be positive, found {self.loss_frequency:g} Hz"
            raise _bad("loss_frequency", problem, "Give the frequency at which losses are known, or None for no damping")
        if self.axes not in AXES:
            raise _bad("axes", f"it must be table or laboratory, found {self.axes!r}", "Name one of them")
        places = {name: frozen(place, (3,), f"places.{name}") for name, place in self.places.items()}
        object.__setattr__(self, "places", MappingProxyType(places))


def require_followable(motion: BaseMotion) -> None:
    """
    Raises
    ------
    BadInput : a motion of one sample, one that does not begin at rest in the origin, or a beta near a quarter turn.
    """
    if len(motion.displacement) < 2:
        raise _refused(motion, "displacement", "at least two samples are needed, found one", "Give a longer motion")
    for name in ("displacement", "velocity"):
        values = np.abs(getattr(motion, name))
        if np.any(values[0] > AT_REST * values.max(axis=0)):
            problem = f"it must begin at rest in the origin, found {values[0].tolist()} in the first sample"
            raise _refused(motion, name, problem, "Start it softly")
    steepest = float(np.abs(motion.displacement[:, 4]).max())
    if steepest > STEEP:
        problem = f"beta must stay within {STEEP} rad, where the angles are unique, found {steepest:.3g} rad"
        raise _refused(motion, "displacement", problem, "Lower the level, or turn about x or z")


def require_unconditional(solver: Solver) -> None:
    """
    Raises
    ------
    BadInput : a method that is not stable for stiff beams, or lets their joints drift.
    """
    if solver.method != SOLVER.method:
        problem = f"beams that swing at a megahertz and joints that turn far need {SOLVER.method}, found {solver.method}"
        raise BadInput(source="solver", field="method", problem=problem, remedy=f"Take {SOLVER.method} and halve the step")


def _bad(name: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source="large motion", field=name, problem=problem, remedy=remedy)


def _refused(motion: BaseMotion, name: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source=motion.label, field=name, problem=problem, remedy=remedy)
