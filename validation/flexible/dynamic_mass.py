"""The dynamic mass that `massline dynamic-mass` shows, over a band and about a point; and how far two of them are apart."""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.articles import NAMES, built_in
from geometry.dynamic_mass import ComplexArray, DynamicMass
from geometry.errors import BadInput
from geometry.frames import Array, Pose
from validation.flexible.model import Flexible, FlexibleOptions


@dataclass(frozen=True, eq=False, kw_only=True)
class Curves:
    """The answer: a dynamic mass for each model, all on the same lines about the same point.

    Attributes
    ----------
    about : name of the reference point
    rigid : (6, 6) rigid mass matrix about it, of the first model
    apart : how far each further model is from the first
    """

    article: str
    about: str
    models: tuple[Flexible, ...]
    masses: tuple[DynamicMass, ...]
    rigid: Array
    apart: tuple[tuple[Apart, ...], ...]
    warnings: tuple[str, ...]


BAND = (4.0, 32.0)
STEP = 0.05
"""Band and distance of lines [Hz] of the paper's tests: 561 lines."""

MOST_LINES = 50_000

Mask = npt.NDArray[np.bool_]

FORCE, COUPLING, MOMENT = (slice(0, 3), slice(0, 3)), (slice(0, 3), slice(3, 6)), (slice(3, 6), slice(3, 6))
BLOCKS = {"forces from translations [kg]": FORCE, "coupling [kg m]": COUPLING, "moments from rotations [kg m²]": MOMENT}
"""Parts of H that have one unit each."""

NEAR = 0.03
"""A line closer to an eigenfrequency than this share of it is at resonance: there two models with eigenfrequencies 1 % apart
differ by as much as the peak is high."""


@dataclass(frozen=True, kw_only=True)
class Apart:
    """How far one block of two dynamic masses is apart, relative to its largest entry at the same line.

    Attributes
    ----------
    block : its name and unit
    off_resonance, off_frequency : greatest difference [1] away from any resonance of either, and where [Hz]; None without a line
    at_resonance, at_frequency : the same near one
    """

    block: str
    off_resonance: float | None
    off_frequency: float | None
    at_resonance: float | None
    at_frequency: float | None


def lines(band: tuple[float, float], step: float) -> Array:
    """Frequencies (n,) [Hz] from one end of the band to the other, `step` [Hz] apart.

    Raises
    ------
    BadInput : the band is reversed, negative or no number, the step not positive, or there would be more than `MOST_LINES`.
    """
    low, high = band
    if not (np.isfinite(low) and np.isfinite(high) and 0 <= low < high):
        problem = f"a band goes from 0 Hz or more up to a higher frequency, found {low:g} to {high:g} Hz"
        raise BadInput(source="--band", problem=problem, remedy="Give the lower end first: --band 4 32")
    if not (np.isfinite(step) and 0 < step <= high - low):
        problem = f"must be positive and fit into the band, found {step:g} Hz"
        raise BadInput(source="--step", problem=problem, remedy="Write for example --step 0.05")
    count = round((high - low) / step) + 1
    if count > MOST_LINES:
        raise BadInput(source="--step", problem=f"would make {count} lines", remedy=f"At most {MOST_LINES} are computed")
    return np.linspace(low, high, count)


def reference_point(about: str, article: str) -> tuple[str, Array]:
    """Name and place (3,) [m], in the article's frame, of the point that `about` means: ``article``, ``F`` or ``"0 0 45 mm"``.

    F is the centre of the FMD's force-measuring plane: the origin of a stack that stands on one, and as far below every other
    article as the built-in FMD holds it above.

    Raises
    ------
    BadInput : none of these.
    """
    if about == "article":
        return about, np.zeros(3)
    if about == "F":
        seat = built_in("fmd").seat or Pose()
        on_fmd = article.split("+")[0] == "fmd" and set(article.split("+")) <= set(NAMES)
        return about, np.zeros(3) if on_fmd else seat.inverse.position
    from validation.reference.statement import position

    try:
        return "point", position(about, "--about", "")
    except BadInput as error:
        remedy = 'Give F, article, or a point such as "0 0 45 mm"'
        raise BadInput(source="--about", problem=error.problem, remedy=remedy) from None


def dynamic_mass(model: Flexible, frequency: Array, about: Array) -> DynamicMass:
    """H of `model` at `frequency` (n,) [Hz] about the point `about` (3,) [m]."""
    from fem.dynamic_mass import modal

    return modal(model.modes, frequency).about(about)


def beyond_the_modes(model: Flexible, high: float, asked: FlexibleOptions) -> str:
    """A sentence when the band reaches beyond the last mode that was kept; empty when it does not."""
    kept = model.modes.frequency
    if len(kept) < asked.count or not len(kept) or high <= kept[-1]:
        return ""
    return (
        f"the band reaches to {high:g} Hz, but the last of {len(kept)} modes kept lies at {kept[-1]:.4g} Hz: "
        f"beyond it resonances are missing; keep more with --modes"
    )


def apart(first: DynamicMass, second: DynamicMass, resonances: Array, rigid_mass: Array) -> tuple[Apart, ...]:
    """How far `first` and `second` are apart, on the same lines about the same point; `resonances` (k,) [Hz] are of both.

    `rigid_mass` (6, 6), about that point too, is what a difference is measured with where the dynamic mass itself is smaller: at
    an antiresonance next to nothing is left to divide by.
    """
    f = first.frequency
    near = np.any(np.abs(f[:, None] - resonances) < NEAR * resonances, axis=1) if len(resonances) else np.zeros(len(f), bool)
    return tuple(
        _apart(name, f, near, _relative(first.matrix, second.matrix, rigid_mass, block)) for name, block in BLOCKS.items()
    )


def _relative(first: ComplexArray, second: ComplexArray, rigid: Array, block: tuple[slice, slice]) -> Array:
    """Largest difference (n,) in `block`, line by line, over its largest entry there or in the rigid mass, the larger of both."""
    a, b = (H[:, block[0], block[1]].reshape(len(H), -1) for H in (first, second))
    scale = np.maximum(np.abs(a).max(axis=1), max(np.abs(rigid[block]).max(), np.finfo(np.float64).tiny))
    return np.asarray(np.abs(a - b).max(axis=1) / scale)


def _apart(name: str, f: Array, near: Mask, difference: Array) -> Apart:
    def worst(mask: Mask) -> tuple[float | None, float | None]:
        where = np.flatnonzero(mask)
        if not len(where):
            return None, None
        k = where[np.argmax(difference[where])]
        return float(difference[k]), float(f[k])

    off, at = worst(~near), worst(near)
    return Apart(block=name, off_resonance=off[0], off_frequency=off[1], at_resonance=at[0], at_frequency=at[1])
