"""`Suspension`: how a body hangs - ropes, where they hold it, what they weigh, how far they stretch - and how it is set swinging.

Axes as the body hangs: z upwards, the origin in its CoG. Every rope goes straight up from its foot to the ceiling before the
body is let down on it, so that ropes of one length hold a centred body level. What ropes stretch and what an off-centre CoG tilts
comes out of the statics.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array, frozen
from geometry.errors import BadInput
from geometry.inertia import Inertia

HEIGHT = 0.1
"""Feet of the ropes above the CoG [m] where nothing else is said; Eq. 5 does not know it."""

LINKS = 8
"""Links of a rope that has mass, where nothing else is said: its error is then 4 % of the rope's own effect (measured)."""

MOST_LINKS = 20
"""Links of a rope at most: their error is then below 1 % of the rope's own effect, and the cost grows with their cube."""

LONGEST = 1000.0
"""Longest rope [m]."""

MOST_STRAIN = 0.1
"""Strain of a rope at rest above which no spring stands for it: steel breaks at 2 %, and what stretches further is not linear."""

Start = Literal["twist", "push"]
"""Let go at rest from a held twist, or pushed out of rest so that it would swing as far."""

SOURCE = "rope pendulum"
AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False, kw_only=True)
class Suspension:
    """Two or three ropes and a start.

    Attributes
    ----------
    feet : (n, 3) [m] where the ropes hold the body, from its CoG, axes as it hangs; n is 2 or 3
    length : [m] of the ropes, unloaded
    amplitude : [rad] peak twist at the start
    extra : (n,) [m] by which each rope is longer than `length`
    stiffness : [N] EA of each rope; None for ropes that do not stretch
    rope_mass : [kg] of all ropes together
    links : of which each rope is made, with its mass in the joints between them (half a link's at both ends); 1 for a
        straight rope, whose lower half then rides on the body
    stretch_damping : damping ratio of the heave on ropes that stretch, by dampers along them
    damping_ratio : of the small twist, viscous about the vertical
    start : "twist" or "push"
    """

    feet: Array
    length: float
    amplitude: float
    extra: Array = field(default_factory=lambda: np.zeros(0))
    stiffness: float | None = None
    rope_mass: float = 0.0
    links: int = 1
    stretch_damping: float = 0.0
    damping_ratio: float = 0.0
    start: Start = "twist"

    def __post_init__(self) -> None:
        n = len(self.feet)
        extra = self.extra if np.size(self.extra) else np.zeros(n)
        object.__setattr__(self, "feet", frozen(self.feet, (n, 3), "feet"))
        object.__setattr__(self, "extra", frozen(extra, (n,), "extra"))
        if n not in (2, 3):
            raise refused("ropes", f"two or three are simulated, found {n}", "More would share the weight in unknown parts")
        _require_sizes(self)

    @property
    def ropes(self) -> int:
        """How many."""
        return len(self.feet)

    @property
    def lengths(self) -> Array:
        """(n,) [m], unloaded."""
        return self.length + self.extra


def on_two_ropes(
    s1: float, s2: float, *, height: float = HEIGHT, off_centre: Sequence[float] = (0.0, 0.0), **more: Any
) -> Suspension:
    """Two ropes `s1` and `s2` [m] to either side of where the CoG is thought to be, along x, feet `height` [m] above it.

    `off_centre` (2,) [m] is how far along x and y the CoG really is from there; `more` are fields of `Suspension`.

    Raises
    ------
    BadInput : a length that is not positive.
    """
    for name, value in (("s1", s1), ("s2", s2)):
        require_positive(name, value, "m")
    return _moved(np.array([[-s1, 0.0, height], [s2, 0.0, height]]), off_centre, more)


def on_three_ropes(radius: float, *, height: float = HEIGHT, off_centre: Sequence[float] = (0.0, 0.0), **more: Any) -> Suspension:
    """Three ropes evenly on a circle of `radius` [m], the first on the x axis; see `on_two_ropes`.

    Raises
    ------
    BadInput : a length that is not positive.
    """
    require_positive("radius", radius, "m")
    turn = 2 * np.pi * np.arange(3) / 3
    return _moved(np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(3, height)]), off_centre, more)


def hung(inertia: Inertia, axis: str = "z", along: str | None = None) -> Inertia:
    """`inertia` about its CoG, in the axes in which it hangs: the article's `axis` up, `along` on x (where two ropes are).

    `along` is z where that lies, x where z is upright. The origin of the result is the CoG.

    Raises
    ------
    BadInput : no such axis, or both the same.
    """
    ahead = along or lying(axis)
    for name, value in (("axis", axis), ("along", ahead)):
        if value not in AXES:
            raise refused(name, f"x, y or z is expected, found {value!r}", "Name an axis of the article's own frame")
    if ahead == axis:
        raise refused("along", f"{ahead} is upright, no ropes can be set along it", "Name one of the two axes that lie")
    return Inertia.from_cog(inertia.mass, np.zeros(3), inertia.tensor_cog).rotated(turned(axis, ahead))


def lying(axis: str) -> str:
    """The article's axis that is on x where nothing else is said: z where that lies, x where z is upright."""
    return "x" if axis == "z" else "z"


def turned(axis: str, along: str) -> Array:
    """Rotation (3, 3) that takes the article's `axis` up and its `along` to x."""
    up, ahead = np.eye(3)[AXES.index(axis)], np.eye(3)[AXES.index(along)]
    return np.array([ahead, np.cross(up, ahead), up])


def refused(name: str, problem: str, remedy: str) -> BadInput:
    """The complaint about the field `name`, ready to be raised."""
    return BadInput(source=SOURCE, field=name, problem=problem, remedy=remedy)


def require_positive(name: str, value: float, unit: str) -> None:
    """Pass a `value` above zero and below infinity.

    Raises
    ------
    BadInput : it is not.
    """
    if not (np.isfinite(value) and value > 0):
        raise refused(name, f"it must be positive, found {value:.6g} {unit}".rstrip(), "Check the sign and the number")


def _moved(feet: npt.NDArray[np.float64], off_centre: Sequence[float], more: dict[str, Any]) -> Suspension:
    shift = np.array([*off_centre, 0.0])
    return Suspension(feet=feet - shift, **more)


def _require_equal(s: Suspension) -> None:
    """Refuse a rope longer or shorter than the others by as much as their feet are apart: the body would stand on end."""
    across = np.linalg.norm(s.feet[:, None] - s.feet[None], axis=2)
    apart = min(s.length, float(across[across > 0].min(initial=np.inf)))
    worst = float(np.ptp(s.extra))
    if not (worst < apart and s.lengths.min() > 0):
        problem = f"ropes of {s.length:.4g} m whose feet are {apart:.3g} m apart cannot be {worst:.4g} m unequal"
        raise refused("extra", problem, f"The body would stand on end: give well below {apart / 2:.2g} m")


def _require_sizes(s: Suspension) -> None:
    require_positive("length", s.length, "m")
    if s.length > LONGEST:
        raise refused("length", f"ropes of {s.length:.6g} m are longer than {LONGEST:g} m", f"Give {LONGEST:g} m or less")
    _require_equal(s)
    require_positive("amplitude", s.amplitude, "rad")
    if s.stiffness is not None:
        require_positive("stiffness", s.stiffness, "N")
    if not (np.isfinite(s.rope_mass) and s.rope_mass >= 0):
        raise refused("rope_mass", f"it cannot be negative, found {s.rope_mass:.6g} kg", "Give the mass of all ropes together")
    if s.links > MOST_LINKS:
        raise refused("links", f"at most {MOST_LINKS} a rope are simulated, found {s.links}", f"Use {MOST_LINKS} or fewer")
    if s.links < 1 or (s.links > 1 and s.rope_mass == 0):
        remedy = "Give 1, or a mass to put between them"
        raise refused("links", f"ropes of {s.rope_mass:.6g} kg cannot have {s.links} links", remedy)
    for name in ("damping_ratio", "stretch_damping"):
        if not 0 <= getattr(s, name) < 1:
            raise refused(name, f"it must be from 0 to below 1, found {getattr(s, name):.6g}", "A ratio of 1 no longer swings")
    if s.start not in ("twist", "push"):
        raise refused("start", f"found {s.start!r}", "Start from a held twist or with a push")
