"""Where on an article a pick-up moves with the base alone: how large its elastic motion is, place by place.

Relative to a base that accelerates along axis k, a point moves in the fixed-base modes by

    a_el(omega) = sum_r phi_r L_rk omega² / (omega_r² - omega² + 2 i zeta_r omega_r omega)            (Eq. 8b's factor)

The *elastic share* is |a_el| over what a rigid article would do there: the base's acceleration, of rotations times the distance
from F. A pick-up is meant for places where it stays below a per cent or so over the band. The cover plate is rigid in all models
here, and so is every place of an article without modes.
"""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass

import numpy as np

from fem.modes import Modes
from geometry.arrays import Array
from geometry.dynamic_mass import MOTIONS
from geometry.frames import rigid_transformation_6
from validation.flexible.model import Flexible
from validation.flexible.motion import displacement
from validation.flexible.places import nearest_part

NEAREST = 0.05
"""[m] Distance from F below which a rotation is not taken to move less."""

STEPS = 400
"""Points on the axis of an article."""

COARSE = 0.2
"""[Hz] between the lines at which whole surfaces are judged; eigenfrequencies are added."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Rigidity:
    """How rigid one place is.

    Attributes
    ----------
    name : of the place
    position : (3,) [m] from F
    at_start : the largest elastic share of the six axes at the lowest line [1]
    largest : the same over the band
    axis, frequency : where it is reached: of `MOTIONS`, [Hz]
    up_to : [Hz] below which the share stays under the limit on every axis; None where it is above from the start
    within : share of the lines at which it stays under the limit on every axis
    """

    name: str
    position: Array
    at_start: float
    largest: float
    axis: str
    frequency: float
    up_to: float | None
    within: float


def judged(model: Flexible, places: Mapping[str, Array], seat: Array, frequency: Array, limit: float) -> tuple[Rigidity, ...]:
    """Every one of `places` (3,) [m] in the article's own frame, the most rigid first; `seat` (3,) [m] of that frame from F."""
    if not places:
        return ()
    points = np.array(list(places.values()))
    moved = _displacement(model, points)
    share = elastic_share(moved, points + seat, model.modes, seat, frequency)
    found = [_one(name, point + seat, own, frequency, limit) for name, point, own in zip(places, points, share, strict=True)]
    return tuple(sorted(found, key=lambda one: (one.largest, one.position[2])))


def elastic_share(moved: Array, points: Array, modes: Modes, seat: Array, frequency: Array) -> Array:
    """(p, n, 6) elastic shares of `points` (p, 3) [m] from F whose displacement in the modes is `moved` (p, 3, m)."""
    return np.stack(list(_by_line(moved, points, modes, seat, frequency)), axis=1)


def largest_share(moved: Array, points: Array, modes: Modes, seat: Array, frequency: Array) -> tuple[Array, Array]:
    """(p,) and (p,): the largest of the six elastic shares at the first line, and over all lines; in the memory of one line."""
    lines = (share.max(axis=1) for share in _by_line(moved, points, modes, seat, frequency))
    first = next(lines)
    most = first.copy()
    for share in lines:
        np.maximum(most, share, out=most)
    return first, most


def _by_line(moved: Array, points: Array, modes: Modes, seat: Array, frequency: Array) -> Iterator[Array]:
    """Line by line the elastic shares (p, 6)."""
    L = modes.participation.T @ rigid_transformation_6(seat)  # (m, 6) about F
    omega, omega_r = 2 * np.pi * frequency[:, None], 2 * np.pi * modes.frequency
    factor = omega**2 / (omega_r**2 - omega**2 + 2j * modes.damping_ratio * omega_r * omega)  # (n, m)
    arm = np.maximum(np.linalg.norm(points, axis=1), NEAREST)[:, None]
    flat = moved.reshape(-1, moved.shape[2])
    for row in factor:
        answer = row[:, None] * L
        parts = (flat @ np.hstack([answer.real, answer.imag])).reshape(len(points), 3, 2, 6)
        share = np.sqrt(np.sum(parts**2, axis=(1, 2)))
        share[:, 3:] /= arm
        yield share


def rigid_height(model: Flexible, top: float, seat: Array, frequency: Array, limit: float) -> float | None:
    """[m] above F up to which the article's axis, x = y = 0 of its frame from 0 to `top` [m], stays within `limit` over the band.

    None where all of it does.
    """
    points = np.zeros((STEPS + 1, 3))
    points[:, 2] = np.linspace(0.0, top, STEPS + 1)
    lines = coarse_lines(frequency, model.modes)
    _, most = largest_share(_displacement(model, points), points + seat, model.modes, seat, lines)
    soft = np.flatnonzero(most > limit)
    return float(seat[2] + points[max(soft[0] - 1, 0), 2]) if len(soft) else None


def coarse_lines(frequency: Array, modes: Modes) -> Array:
    """Fewer lines over the same band, with every eigenfrequency in it."""
    low, high = float(frequency[0]), float(frequency[-1])
    own = modes.frequency[(modes.frequency > low) & (modes.frequency < high)]
    even = np.linspace(low, high, max(round((high - low) / COARSE), 1) + 1)
    return np.unique(np.concatenate([even, own]))


def _displacement(model: Flexible, points: Array) -> Array:
    """(p, 3, m): nothing moves in the modes of a model that is not there."""
    if model.structure is None:
        return np.zeros((len(points), 3, len(model.modes.frequency)))
    article = model.article_of_primitives
    parts = np.zeros(len(points), dtype=np.intp) if article is None else nearest_part(article, points)
    return displacement(model.structure, model.modes.shapes, article, points, parts)


def _one(name: str, position: Array, share: Array, frequency: Array, limit: float) -> Rigidity:
    line, axis = np.unravel_index(int(np.argmax(share)), share.shape)
    under = np.all(share <= limit, axis=1)
    first = int(np.argmin(under)) if not under.all() else len(under)
    return Rigidity(
        name=name,
        position=position,
        at_start=float(share[0].max()),
        largest=float(share[line, axis]),
        axis=MOTIONS[int(axis)],
        frequency=float(frequency[line]),
        up_to=float(frequency[first - 1]) if first else None,
        within=float(under.mean()),
    )
