"""Accelerometers on the cover plate or the table: from the motion of the reference point to what they read.

    y = factor · d^T [G(p)] u          on the cover plate, u apparent (`identification.chain.tilt`)
    y = factor · d^T [G(p)] u_t        on the table, u_t = u - omega² K^-1 H u: below the load cells

Position p and direction d are those of the table of channels, shifted and turned by their tolerances. Should the cover plate bend
under a vertical force, its vertical pick-ups read -omega² c f_z on top.
"""

from __future__ import annotations

from collections.abc import Collection, Iterator
from dataclasses import dataclass

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.frames import rigid_transformation, skew
from geometry.sensors import Channel
from geometry.tolerances import Tolerances
from identification.chain import factor, tilt
from identification.chain.cells import Springs
from identification.chain.parameter import Offsets, Parameter
from identification.chain.placed import Placed

AXES = "xyz"
BENDING = "cover-plate-flexibility"
PARALLEL = 1e-6
"""Sine of the angle below which a direction lies along an axis: a shift along it, or a turn about it, changes nothing."""

Rows = tuple[ComplexArray, ComplexArray]
"""A0 and A1, (n, c, 6) each."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PickUps(Placed):
    """The accelerometers of one group.

    Attributes
    ----------
    group : "cover" or "table"
    point : (3,) [m] reference point, in the frame of the places
    springs : what the cover plate stands on
    gravity : [m/s²]
    """

    group: str
    point: Array
    springs: Springs
    gravity: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Sight:
    """What rows do at the lines: everything between the geometry of a pick-up and the record, at one theta.

    Attributes
    ----------
    factors : (n, c)
    square : (n,) omega² [rad²/s²]
    sensor, structure : (c,) g times the tilt that each senses, and g times that which the structure feels [m/s²]
    compliance : (6, 6) K^-1 of a table, zeros for a cover plate
    bending : [m/N] of a cover plate
    """

    factors: ComplexArray
    square: Array
    sensor: Array
    structure: float
    compliance: Array
    bending: float


def parameters(part: PickUps, known: Tolerances) -> Iterator[Parameter]:
    """All that `part` could do wrong, with the tolerance of an ordinary laboratory; 0 for what none expects."""
    gain = known.table_gain if part.group == "table" else known.gain
    yield from factor.parameters(part.names, part.first, "accelerometer", part.group, gain, known)
    for family, unit, size in (("position", "m", known.position), ("misalignment", "rad", known.angle)):
        for k, channel in zip(part.columns, part.channels, strict=True):
            for axis in _axes(channel, family):
                yield Parameter(name=f"accelerometer-{family}:{channel.name}:{axis}", unit=unit, tolerance=size, channels=(k,))
    if part.group == "cover" and part.channels:
        yield Parameter(name=BENDING, unit="m/N", tolerance=0.0, channels=part.columns)


def rows(part: PickUps, x: Offsets, frequency: Array) -> Rows:
    """A0 and A1 of the accelerometers, (n, c, 6) each, at `frequency` (n,) [Hz]."""
    geometry, upward = _geometry(part, x)
    return _seen(_sight(part, x, frequency), geometry, upward, list(range(len(part.channels))))


def changes(part: PickUps, x: Offsets, frequency: Array, wanted: Collection[str]) -> Iterator[tuple[str, list[int], Rows]]:
    """By parameter of those `wanted`: the channels of `part` it touches, and d A0, d A1 / d offset of these, (n, k, 6) each."""
    sight = _sight(part, x, frequency)
    geometry, upward = _geometry(part, x)
    every = list(range(len(part.channels)))
    A0, A1 = _seen(sight, geometry, upward, every)
    for key, touched, slope in factor.changes(part.names, "accelerometer", part.group, x, frequency, wanted):
        yield key, touched, (slope[:, :, None] * A0[:, touched], slope[:, :, None] * A1[:, touched])
    for key, k, change, rise in _geometry_changes(part, x, wanted):
        yield key, [k], _seen(sight, change[None], rise[None], [k])
    common = _common_changes(part, x, sight, geometry, upward)
    yield from ((key, every, change) for key, change in common if key in wanted)


def _axes(channel: Channel, family: str) -> str:
    """Axes along which a shift, or the two about which a turn, changes what `channel` reads."""
    across = np.array([np.min(np.abs([np.linalg.norm(np.cross(e, p.direction)) for p in channel.places])) for e in np.eye(3)])
    if family == "position":
        return "".join(axis for axis, size in zip(AXES, across, strict=True) if size > PARALLEL)
    kept = sorted(np.argsort(-across, kind="stable")[:2])
    return "".join(AXES[k] for k in kept)


def _vector(x: Offsets, stem: str) -> Array:
    return np.array([x.get(f"{stem}:{axis}", 0.0) for axis in AXES])


def _geometry(part: PickUps, x: Offsets) -> tuple[Array, Array]:
    """d^T [G(p)] (c, 6), and the vertical component of d (c,), as they are."""
    made = [_placed(part, channel, x) for channel in part.channels]
    return np.array([row for row, _ in made]).reshape(-1, 6), np.array([up for _, up in made])


def _placed(part: PickUps, channel: Channel, x: Offsets) -> tuple[Array, float]:
    shift, turn = (_vector(x, f"accelerometer-{family}:{channel.name}") for family in ("position", "misalignment"))
    Q = _rotation(turn)
    directions = [Q @ place.direction for place in channel.places]
    arms = [place.position + shift - part.point for place in channel.places]
    row = np.mean([d @ rigid_transformation(arm) for d, arm in zip(directions, arms, strict=True)], axis=0)
    return np.asarray(row), float(np.mean([d[2] for d in directions]))


def _geometry_changes(part: PickUps, x: Offsets, wanted: Collection[str]) -> Iterator[tuple[str, int, Array, Array]]:
    """By `wanted` parameter of position and angle: the channel, the change (6,) of its row and () of its vertical component."""
    for k, channel in enumerate(part.channels):
        shift, turn = (_vector(x, f"accelerometer-{family}:{channel.name}") for family in ("position", "misalignment"))
        Q, J = _rotation(turn), _left_jacobian(turn)
        for axis, e in zip(AXES, np.eye(3), strict=True):
            if (key := f"accelerometer-position:{channel.name}:{axis}") in wanted:
                d = np.mean([Q @ place.direction for place in channel.places], axis=0)
                yield key, k, np.concatenate([np.zeros(3), -d @ skew(e)]), np.zeros(())
            if (key := f"accelerometer-misalignment:{channel.name}:{axis}") in wanted:
                turned = [(np.cross(J @ e, Q @ place.direction), place.position + shift - part.point) for place in channel.places]
                change = np.mean([d @ rigid_transformation(arm) for d, arm in turned], axis=0)
                yield key, k, np.asarray(change), np.asarray(np.mean([d[2] for d, _ in turned]))


def _sight(part: PickUps, x: Offsets, frequency: Array) -> Sight:
    table = part.group == "table"
    senses = np.array([channel.senses_gravity for channel in part.channels], dtype=np.float64)
    return Sight(
        factors=factor.factors(part.names, "accelerometer", part.group, x, frequency),
        square=np.square(2 * np.pi * frequency),
        sensor=part.gravity * (1 + x.get(tilt.SENSOR, 0.0)) * senses,
        structure=part.gravity * (1 + x.get(tilt.STRUCTURE, 0.0)),
        compliance=part.springs.compliance(x) if table else np.zeros((6, 6)),
        bending=0.0 if table else x.get(BENDING, 0.0),
    )


def _seen(sight: Sight, geometry: Array, upward: Array, chosen: list[int]) -> Rows:
    """A0, A1 (n, k, 6) of the `chosen` channels with rows `geometry` (k, 6) and vertical components `upward` (k,)."""
    f, square = sight.factors[:, chosen, None], sight.square[:, None, None]
    more, sensed = tilt.turned(geometry), sight.sensor[chosen, None]
    A0 = f * (geometry + (sensed - sight.structure) * more / square)
    A1 = -f * ((square * geometry + sensed * more) @ sight.compliance)
    A1[..., 2] -= f[..., 0] * square[..., 0] * sight.bending * upward
    return np.asarray(A0), np.asarray(A1)


def _common_changes(part: PickUps, x: Offsets, sight: Sight, geometry: Array, upward: Array) -> Iterator[tuple[str, Rows]]:
    """Of what all channels of the group share: tilt, springs, a cover plate that bends."""
    f, square, more = sight.factors[:, :, None], sight.square[:, None, None], tilt.turned(geometry)
    none = np.zeros((*sight.factors.shape, 6), dtype=np.complex128)
    senses = np.array([channel.senses_gravity for channel in part.channels], dtype=np.float64)[:, None]
    if tilt.STRUCTURE in x:
        yield tilt.STRUCTURE, (-f * part.gravity * more / square, none)
    if tilt.SENSOR in x:
        weight = f * part.gravity * senses
        yield tilt.SENSOR, (np.asarray(weight * more / square), np.asarray(-weight * (more @ sight.compliance)))
    if part.group == "table":
        for key, change in part.springs.compliance_changes(x):
            yield key, (none, np.asarray(-f * ((square * geometry + sight.sensor[:, None] * more) @ change)))
    elif BENDING in x:
        bent = none.copy()
        bent[..., 2] = -sight.factors * sight.square[:, None] * upward
        yield BENDING, (none, bent)


def _rotation(turn: Array) -> Array:
    """(3, 3) rotation about the vector `turn` (3,) by its length [rad] (Rodrigues)."""
    angle, S = float(np.linalg.norm(turn)), skew(turn)
    return np.asarray(np.eye(3) + np.sinc(angle / np.pi) * S + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * S @ S)


def _left_jacobian(turn: Array) -> Array:
    """(3, 3) J: a small change t of `turn` rotates what is already turned about J t."""
    angle, S = float(np.linalg.norm(turn)), skew(turn)
    third = 1 / 6 if angle < 1e-3 else (angle - np.sin(angle)) / angle**3
    return np.asarray(np.eye(3) + 0.5 * np.sinc(angle / (2 * np.pi)) ** 2 * S + third * S @ S)
