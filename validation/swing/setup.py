"""`Setup`: an article, its ropes and its recorder as somebody asks for them, before anything is simulated."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from fem.flexible_body.rope_pendulum import STANDARD_GRAVITY, Suspension, on_three_ropes, on_two_ropes
from fem.flexible_body.rope_pendulum.suspension import require_positive
from geometry.errors import BadInput
from geometry.inertia import Inertia
from validation.pendulum import rope_pendulum
from validation.pendulum_corrections import rope_amplitude_factor
from validation.period import LEAST_CYCLES, LEAST_SAMPLES

SMALL = 1e-3
"""Radians of a twist whose own effect on the period, 7e-8 of it, is nothing."""

MOST_CYCLES = 1000
"""Cycles of a record."""

MOST_SAMPLES = 200_000
"""Samples of a record: a thousand cycles at forty times the least."""

MOST_DAMPING, DIED_AWAY = 0.1, 0.12
"""Damping ratio ζ, and ζ² times the cycles, up to which the first look at a record, its spectrum, still finds the period.
Clean decays are lost from 0.26 at 3 cycles, 0.17 at 8, 0.10 at 20, 0.04 at 100 on (measured)."""

EFFECTS = ("amplitude", "damping", "rope-mass", "rope-stretch", "off-centre", "unequal ropes")
"""What Eq. 5 leaves out, in the order in which it is shown."""

SOURCE = "swing"


@dataclass(frozen=True, eq=False, kw_only=True)
class Setup:
    """One pendulum test.

    Attributes
    ----------
    article : name
    axis, along : of the article: upright, and on x, where two ropes are
    inertia : of the body as it hangs, about its CoG at the origin
    radii : s1 and s2 [m] as they are thought to be, for two ropes; the one radius for three
    height : [m] of the feet above the CoG
    off_centre : (2,) [m] how far the CoG really is from where it is thought to be, along the ropes' x and across
    suspension : as it really is
    gravity : [m/s²]
    cycles : recorded
    rate : [Hz] of the recorder
    noise : [rad] standard deviation of the recorder's noise
    seed : of the noise
    step : [s] of the integration; None chooses
    """

    article: str
    axis: str
    along: str
    inertia: Inertia
    radii: tuple[float, ...]
    height: float
    off_centre: tuple[float, float]
    suspension: Suspension
    gravity: float = STANDARD_GRAVITY
    cycles: float = 20.0
    rate: float = 50.0
    noise: float = 0.0
    seed: int = 0
    step: float | None = None

    @property
    def s1_s2(self) -> tuple[float, float]:
        """s1 and s2 [m] of Eq. 5."""
        return self.radii[0], self.radii[-1]

    @property
    def reference(self) -> float:
        """Moment of inertia [kg m²] about the vertical through the CoG that the simulation was made with."""
        return float(self.inertia.tensor_cog[2, 2])

    @property
    def ideal_period(self) -> float:
        """[s] that Eq. 5 gives this inertia with the lengths as they are thought to be."""
        s1, s2 = self.s1_s2
        lengths = {"mass": self.inertia.mass, "gravity": self.gravity, "s1": s1, "s2": s2, "length": self.suspension.length}
        return float(np.sqrt(self.reference / rope_pendulum(**lengths, period=1.0)))

    @property
    def effects(self) -> tuple[str, ...]:
        """Those of `EFFECTS` that are in."""
        s = self.suspension
        there = (True, s.damping_ratio > 0, s.rope_mass > 0, s.stiffness is not None, any(self.off_centre), bool(s.extra.any()))
        return tuple(name for name, here in zip(EFFECTS, there, strict=True) if here)

    def alone(self, effect: str | None) -> Setup:
        """The same with `effect` alone, on ropes that are ideal otherwise; None leaves nothing but the ideal."""
        s = self.suspension
        fields: dict[str, dict[str, Any]] = {
            "amplitude": {"amplitude": s.amplitude},
            "damping": {"damping_ratio": s.damping_ratio},
            "rope-mass": {"rope_mass": s.rope_mass, "links": s.links},
            "rope-stretch": {"stiffness": s.stiffness},
            "unequal ropes": {"extra": s.extra},
        }
        off_centre = self.off_centre if effect == "off-centre" else (0.0, 0.0)
        ideal = {"length": s.length, "amplitude": SMALL, "start": s.start, **fields.get(effect or "", {})}
        return replace(
            self,
            off_centre=off_centre,
            suspension=suspended(self.radii, self.height, off_centre, **ideal),
            noise=0.0,
            step=None,
        )


def suspended(radii: Sequence[float], height: float, off_centre: Sequence[float], **fields: Any) -> Suspension:
    """Two ropes where `radii` (2,) [m] are s1 and s2, three where it is the one radius.

    Raises
    ------
    BadInput : a size that cannot be.
    """
    make = on_two_ropes if len(radii) == 2 else on_three_ropes
    return make(*radii, height=height, off_centre=off_centre, **fields)


def require_recordable(setup: Setup) -> None:
    """Refuse what no pendulum or no recorder can do, before anything is simulated.

    Raises
    ------
    BadInput : no mass or gravity, ropes that would cross or lie flat, too few cycles or too many, too slow a recorder or too
        fast, a twist that dies away too soon, negative noise or seed.
    """
    require_positive("mass", setup.inertia.mass, "kg")
    require_positive("gravity", setup.gravity, "m/s²")
    s1, s2 = setup.s1_s2
    kappa = setup.inertia.mass * s1 * s2 / setup.reference
    rope_amplitude_factor(setup.suspension.amplitude, (max(s1, s2) / setup.suspension.length) ** 2, kappa)
    _require_cycles(setup)
    if not setup.rate > 0 or setup.rate * setup.ideal_period < LEAST_SAMPLES:
        problem = f"{setup.rate:g} Hz is {setup.rate * setup.ideal_period:.2g} samples a cycle, {LEAST_SAMPLES} are needed"
        raise _refused("rate", problem, f"Record at {np.ceil(LEAST_SAMPLES / setup.ideal_period):g} Hz or more")
    samples = setup.cycles * setup.rate * setup.ideal_period
    if not samples <= MOST_SAMPLES:
        lasting = f"{setup.cycles:g} cycles of {setup.ideal_period:.3g} s"
        problem = f"{setup.rate:g} Hz over {lasting} are {samples:.3g} samples, more than the {MOST_SAMPLES} that are kept"
        raise _refused("rate", problem, f"Record at {0.9 * MOST_SAMPLES / setup.cycles / setup.ideal_period:.2g} Hz or less")
    if not 0 <= setup.noise < np.inf:
        raise _refused("noise", f"it must be finite and not negative, found {setup.noise:g} rad", "Give a standard deviation")
    if setup.seed < 0:
        raise _refused("seed", f"it must not be negative, found {setup.seed}", "Give a whole number from 0 on")


def _require_cycles(setup: Setup) -> None:
    if not LEAST_CYCLES <= setup.cycles <= MOST_CYCLES:
        least, remedy = (f"at least {LEAST_CYCLES} are needed for a period", "Record longer")
        if setup.cycles > MOST_CYCLES:
            least, remedy = (f"at most {MOST_CYCLES} are recorded", f"Record {MOST_CYCLES} or fewer")
        raise _refused("cycles", f"{least}, found {setup.cycles:g}", remedy)
    most, ratio = min(MOST_DAMPING, np.sqrt(DIED_AWAY / setup.cycles)), setup.suspension.damping_ratio
    if ratio > most:
        left = np.exp(-2 * np.pi * ratio * LEAST_CYCLES / np.sqrt(1 - ratio**2))
        problem = f"a twist damped by {ratio:g} has {100 * left:.2g} % left after {LEAST_CYCLES} of {setup.cycles:g} cycles"
        raise _refused(
            "damping_ratio",
            problem,
            f"Use {np.floor(1000 * most) / 1000:g} or less; fewer cycles bear more, up to {MOST_DAMPING:g}",
        )


def _refused(field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source=SOURCE, field=field, problem=problem, remedy=remedy)
