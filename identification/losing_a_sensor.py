"""What the base motion would be without each of its accelerometers: how far it moves, how much noise grows, what is lost.

An accelerometer whose absence moves a motion by much contradicts the others; one whose absence leaves a motion untold is the only
one that sees it, and its errors go into the result unseen.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, replace

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.observability import of_motions
from identification.base_motion import STANDARD_GRAVITY, BaseMotion, base_motion, groups_used
from identification.spectra.line_spectra import Spectra

NOMINAL = np.array([LEVELS[axis] for axis in MOTIONS])


@dataclass(frozen=True, eq=False, kw_only=True)
class Loss:
    """The effect of losing one accelerometer.

    Attributes
    ----------
    channel : its name
    lost : of `MOTIONS`, what the others cannot tell; none where they tell all six
    text : the same in words
    moved : (r, 6) rms over the lines of the change of each motion, as a share of the largest motion of the run, every axis
        divided by its nominal level; 0 where motions are lost
    amplification : (6,) standard deviation of the noise of each motion without the channel over that with it (median of runs and
        lines; of equal noise where it is not known); infinite where a motion is lost
    """

    channel: str
    lost: tuple[str, ...]
    text: str
    moved: Array
    amplification: Array


def without_each(spectra: Spectra, *, groups: Sequence[str] | None = None, gravity: float = STANDARD_GRAVITY) -> tuple[Loss, ...]:
    """The effect of losing each accelerometer that `base_motion` uses, in the order of the table.

    Raises
    ------
    BadInput : as of `base_motion`.
    """
    used = groups_used(spectra.table) if groups is None else tuple(groups)
    known = _with_noise(_only(spectra, spectra.table.select(group=used, quantity="acceleration")))
    whole = base_motion(known, groups=used, gravity=gravity)
    return tuple(_lost(known, k, whole, used, gravity) for k in range(len(known.table)))


def _lost(spectra: Spectra, gone: int, whole: BaseMotion, groups: Sequence[str], gravity: float) -> Loss:
    left = _only(spectra, [k for k in range(len(spectra.table)) if k != gone])
    verdict, name = of_motions(left.table, groups), spectra.table.names[gone]
    if not verdict.complete:
        text = f"without {name} {verdict.text}"
        untold = np.zeros((len(spectra.runs), 6))
        return Loss(channel=name, lost=verdict.missing, text=text, moved=untold, amplification=np.full(6, np.inf))
    rest = base_motion(left, groups=groups, gravity=gravity)
    amplification = np.sqrt(np.median(_variance(rest) / _variance(whole), axis=(0, 1)))
    moved = _moved(rest, whole)
    k = int(np.argmax(moved.max(axis=0)))
    most = f"moves {MOTIONS[k]} most, by {100 * moved[:, k].max():.2g} % of the driven motion"
    text = f"without {name} {most}; noise grows up to {amplification.max():.2g} times"
    return Loss(channel=name, lost=(), text=text, moved=moved, amplification=amplification)


def _moved(rest: BaseMotion, whole: BaseMotion) -> Array:
    size = np.sqrt(np.mean(np.abs(whole.values / NOMINAL) ** 2, axis=1)).max(axis=1)
    change = np.sqrt(np.mean(np.abs((rest.values - whole.values) / NOMINAL) ** 2, axis=1))
    return np.asarray(change / np.where(size > 0, size, 1.0)[:, None])


def _variance(motion: BaseMotion) -> Array:
    return np.asarray(np.diagonal(motion.covariance, axis1=2, axis2=3))


def _only(spectra: Spectra, chosen: Sequence[int]) -> Spectra:
    taken = list(chosen)
    values, noise = spectra.values[:, :, taken], spectra.noise[:, :, taken]
    return replace(spectra, table=spectra.table.subset(taken), values=values, noise=noise)


def _with_noise(spectra: Spectra) -> Spectra:
    """Equal noise where that of a channel is not known: what matters here is how it spreads."""
    return spectra if np.all(spectra.noise > 0) else replace(spectra, noise=np.ones_like(spectra.noise))
