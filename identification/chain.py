"""Sensors and FMD as a linear chain: what every channel reads for a motion of the cover plate, with every tolerance a parameter.

    y = (A0 + A1 H) u

u (6,) is the motion of the reference point F on the cover plate - the *apparent* acceleration that the structure feels, tilt
included - and H the dynamic mass of all that stands above the force plane.

Identification calibrates with the chain, validation predicts with it: there is no other. Source: the paper's Eqs. 2, 3, 6 and 7
with their errors written out; "The likelihood" of the catalogue of effects.
"""

from collections.abc import Collection, Iterator, Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from types import MappingProxyType
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, frozen, left_jacobian, rotation_by
from geometry.sensors import Channel, ChannelTable, Summation, Tolerances, summation
from identification.base_motion import STANDARD_GRAVITY, TILT
from identification.load_cells import ASSUMED, COMPLIANCE, ELEMENT, LOSS, STATED, Offsets, Springs, cell_springs
from identification.parameter import Parameter, opened

# What happens to a signal on its way from the sensor to the record: gain, delay of channel and board, high-pass.
#
#     factor = (1 + g) e^{-i omega (tau + tau_board)} / (1 - i f_c / f)
#
# with a late channel's delay positive, and f_c the corner of the charge amplifier's high-pass of first order.


def channel_parameters(
    names: tuple[str, ...], first: int, kind: str, board: str, gain: float, known: Tolerances
) -> Iterator[Parameter]:
    """Gain and delay of the channels `names`, columns `first` and on, of `kind` ("force", "accelerometer") on `board`."""
    columns = range(first, first + len(names))
    for k, name in zip(columns, names, strict=True):
        yield Parameter(name=f"{kind}-gain:{name}", unit="1", tolerance=gain, channels=(k,))
    for k, name in zip(columns, names, strict=True):
        yield Parameter(name=f"{kind}-delay:{name}", unit="s", tolerance=known.delay, channels=(k,))
    for k, name in zip(columns, names, strict=True):
        yield Parameter(name=f"{kind}-highpass:{name}", unit="Hz", tolerance=0.0, channels=(k,))
    if names:
        yield Parameter(name=f"board-delay:{board}", unit="s", tolerance=0.0, channels=tuple(columns))


def factors(names: tuple[str, ...], kind: str, board: str, x: Offsets, frequency: Array) -> ComplexArray:
    """(n, c) at `frequency` (n,) [Hz]."""
    gain, late, corner = (
        np.array([x.get(f"{family}:{name}", 0.0) for name in names])
        for family in (f"{kind}-gain", f"{kind}-delay", f"{kind}-highpass")
    )
    turns = np.outer(frequency, late + x.get(f"board-delay:{board}", 0.0))
    passed = 1 - 1j * corner / frequency[:, None] if np.any(corner) else 1.0
    return np.asarray((1 + gain) * np.exp(-2j * np.pi * turns) / passed, dtype=np.complex128)


def channel_changes(
    names: tuple[str, ...], kind: str, board: str, x: Offsets, frequency: Array, wanted: Collection[str]
) -> Iterator[tuple[str, list[int], ComplexArray]]:
    """By parameter of those `wanted`: which of `names` it touches, and d ln(factor) / d parameter of these, (n, k)."""
    late = np.asarray(-2j * np.pi * frequency[:, None], dtype=np.complex128)
    for k, name in enumerate(names):
        if (key := f"{kind}-gain:{name}") in wanted:
            yield key, [k], np.full((len(frequency), 1), 1 / (1 + x[key]), dtype=np.complex128)
        if (key := f"{kind}-delay:{name}") in wanted:
            yield key, [k], late
        if (key := f"{kind}-highpass:{name}") in wanted:
            yield key, [k], np.asarray(1j / (frequency - 1j * x[key]))[:, None]
    if (key := f"board-delay:{board}") in wanted:
        yield key, list(range(len(names))), np.repeat(late, len(names), axis=1)


# `Placed`: neighbouring channels of a chain, and where they stand in it.


@dataclass(frozen=True, eq=False, kw_only=True)
class Placed:
    """Channels of one kind.

    Attributes
    ----------
    channels : in their order
    first : column of the first of them in the chain
    """

    channels: tuple[Channel, ...]
    first: int

    @property
    def names(self) -> tuple[str, ...]:
        """Of the channels."""
        return tuple(channel.name for channel in self.channels)

    @property
    def columns(self) -> tuple[int, ...]:
        """Of the channels in the chain."""
        return tuple(range(self.first, self.first + len(self.channels)))


# Force and moment channels: from the load on the structure to what they read.
#
#     y = factor · S · (1 + C) · diag(1 - lost) · R · X · H u
#
# C lets the force on a cell along one axis show in its elements along others, X lets a resultant show in others (cross-talk of
# the measuring plane, moments that the cells miss), R shares the load between the sensing elements, part of what each carries may
# pass it by (shunt), and S, the summation box, adds elements up. A moment channel beside elements that carry everything reads the
# resultant moment.

AXES = "xyz"
CROSSTALK = tuple(f"{i}{j}" for i in AXES for j in AXES if i != j)
"""``zx``: the x resultant shows in the z channels."""

INSIDE = "cell-crosstalk"
"""``1zx``: the force on cell 1 along x shows in its z element; ``1zz`` is its own sensitivity."""

SHUNTS = {f"load-path-shunt:{axis}": k for k, axis in enumerate(AXES)}
"""By name of the parameter: the axis along which a load goes past the cells."""

OFFSETS = {"x": (4, 0, -1.0), "y": (3, 1, 1.0)}
"""By axis of the force at height h: row and column of X and sign: M_y -= h F_x, M_x += h F_y."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Loads(Placed):
    """The force side of a chain.

    Attributes
    ----------
    sums : their elements and sums about the reference point
    springs : the load cells
    """

    sums: Summation
    springs: Springs

    def parameters(self, known: Tolerances) -> Iterator[Parameter]:
        """All that they could do wrong, with the tolerance of an ordinary laboratory; 0 for what none expects."""
        all_of_them = self.columns
        yield from channel_parameters(self.names, self.first, "force", "force", known.gain, known)
        for pair in CROSSTALK if self.channels else ():
            yield Parameter(name=f"force-crosstalk:{pair}", unit="1", tolerance=known.crosstalk, channels=all_of_them)
        for key, to, _ in self._inside():
            yield Parameter(name=key, unit="1", tolerance=0.0, channels=tuple(self.first + k for k in self._adding_up(to)))
        for axis in AXES if self.channels else ():
            yield Parameter(name=f"load-path-shunt:{axis}", unit="1", tolerance=0.0, channels=all_of_them)
        for axis in OFFSETS if self.channels else ():
            yield Parameter(name=f"force-plane-offset:{axis}", unit="m", tolerance=0.0, channels=all_of_them)

    def rows(self, x: Offsets, frequency: Array) -> ComplexArray:
        """A1 of the force channels, (n, c, 6): what they read for a unit load at `frequency` (n,) [Hz]."""
        f = factors(self.names, "force", "force", x, frequency)
        return np.asarray(f[:, :, None] * self._mixed(x))

    def changes(
        self, x: Offsets, frequency: Array, H: ComplexArray, wanted: Collection[str]
    ) -> Iterator[tuple[str, list[int], ComplexArray]]:
        """By open parameter of those `wanted`: the channels it touches and d (A1 H) / d offset of these, (n, k, 6)."""
        f = factors(self.names, "force", "force", x, frequency)
        reading, X, even = self._reading(x), _moved(x), self._even()
        rows = f[:, :, None] * (self._mixed(x) @ H)
        for key, touched, slope in channel_changes(self.names, "force", "force", x, frequency, wanted):
            yield key, touched, slope[:, :, None] * rows[:, touched]
        heard, carried = even @ _heard(x), _carried(x)
        mixed = {key: change @ X + heard @ _lost(key) for key, change in self._reading_changes(x) if key in wanted}
        mixed |= {key: even @ change @ carried for key, change in _crosstalk(x) if key in wanted}
        mixed |= {key: reading @ change for key, change in _offsets(x) if key in wanted}
        moved = self._loads(x) @ X
        for key, to, of in self._inside():
            if key in wanted:
                touched = self._adding_up(to)
                yield key, touched, f[:, touched, None] * (np.outer(self.sums.adds[touched, to], moved[of]) @ H)
        if mixed:  # all of them by one product
            every, count = list(range(len(self.channels))), len(self.channels)
            made = (np.concatenate(list(mixed.values())) @ H).reshape(len(f), len(mixed), count, 6)
            yield from ((key, every, f[:, :, None] * made[:, k]) for k, key in enumerate(mixed))

    def _mixed(self, x: Offsets) -> Array:
        """(c, 6) reading for a unit load: cells share it as they are stiff, cross-talk shows in all of them alike."""
        return np.asarray(self._reading(x) @ _moved(x) + self._even() @ _heard(x) @ _carried(x))

    def _even(self) -> Array:
        """(c, 6) reading for a unit resultant load of cells that are all alike."""
        return np.asarray(self.sums.adds @ self._sharing({}))

    def _reading(self, x: Offsets) -> Array:
        """(c, 6) reading for a unit resultant load, before the signal's way to the record."""
        return np.asarray(self._adding(x) @ self._loads(x))

    def _loads(self, x: Offsets) -> Array:
        """(e, 6) what every element carries of a unit resultant load."""
        return np.asarray(self._passing(x)[:, None] * self._sharing(x))

    def _adding(self, x: Offsets) -> Array:
        """(c, e) what the channels read of what the elements carry: their sums, and what shows of other elements of the cell."""
        adds = self.sums.adds
        heard = [(to, of, x[key]) for key, to, of in self._inside() if x.get(key, 0.0)]
        if not heard:
            return adds
        adds = adds.copy()
        for to, of, share in heard:
            adds[:, of] += share * self.sums.adds[:, to]
        return adds

    def _inside(self) -> Iterator[tuple[str, int, int]]:
        """By cross-talk inside a cell: its name, the element in which the load of another or its own shows, and that one."""
        if not self.springs.of_cells:
            return
        at = list(zip(self.springs.names, self._of_force, strict=True))
        for to, k in at:
            yield from ((f"{INSIDE}:{to}{of[-1]}", k, j) for of, j in at if of[:-1] == to[:-1])

    def _adding_up(self, element: int) -> list[int]:
        """Which channels read `element`."""
        return [int(k) for k in np.flatnonzero(self.sums.adds[:, element])]

    def _sharing(self, x: Offsets) -> Array:
        """(e, 6) reading of every element for a unit resultant load."""
        if not self.springs.of_cells:
            return np.asarray(np.linalg.pinv(self.sums.gives))
        R = self.sums.gives.T.copy()  # of a moment: its row, that of the resultant moment itself
        R[self._of_force] = self.springs.sharing(x)
        return np.asarray(R)

    def _passing(self, x: Offsets) -> Array:
        """(e,) share of each element's load that a shunt leaves to it."""
        lost = np.array([x.get(f"load-path-shunt:{axis}", 0.0) for axis in AXES])
        return np.asarray(1 - lost @ self._along)

    @property
    def _along(self) -> Array:
        """(3, e) how far a force element measures along each axis, adding up to 1; 0 for moments."""
        return np.asarray(self.sums.gives[:3] ** 2)

    @property
    def _of_force(self) -> list[int]:
        return [e for e, (quantity, _) in enumerate(self.sums.elements) if quantity == "force"]

    def _reading_changes(self, x: Offsets) -> Iterator[tuple[str, Array]]:
        """d `_reading` / d offset, (c, 6), of stiffnesses and shunts."""
        passing, adds = self._passing(x), self._adding(x)
        if self.springs.of_cells:
            force = self._of_force
            for key, change in self.springs.sharing_changes(x):
                yield key, adds[:, force] @ (passing[force, None] * change)
        for axis, along in zip(AXES, self._along, strict=True):
            if (key := f"load-path-shunt:{axis}") in x:
                yield key, -adds @ (along[:, None] * self._sharing(x))


def _heard(x: Offsets) -> Array:
    """(6, 6) what shows in channels of other axes of what the cells carry."""
    return np.zeros((6, 6)) + sum(x[key] * change for key, change in _crosstalk(x))


def _carried(x: Offsets) -> Array:
    """(6, 6) what shunts leave to the cells of a resultant load."""
    return np.eye(6) + sum(x.get(key, 0.0) * _lost(key) for key in SHUNTS)


def _lost(key: str) -> Array:
    """(6, 6) d `_carried` / d offset of the parameter `key`; zero of one that is no shunt."""
    axis = SHUNTS.get(key)
    return np.zeros((6, 6)) if axis is None else -_unit(axis, axis)


def _moved(x: Offsets) -> Array:
    """(6, 6) the resultant load about the true plane of the cells from that about the stated one."""
    return np.eye(6) + sum(x[key] * change for key, change in _offsets(x))


def _crosstalk(x: Offsets) -> Iterator[tuple[str, Array]]:
    for pair in CROSSTALK:
        if (key := f"force-crosstalk:{pair}") in x:
            yield key, _unit(AXES.index(pair[0]), AXES.index(pair[1]))


def _offsets(x: Offsets) -> Iterator[tuple[str, Array]]:
    for axis, (cell, motion, sign) in OFFSETS.items():
        if (key := f"force-plane-offset:{axis}") in x:
            yield key, sign * _unit(cell, motion)


def _unit(row: int, column: int) -> Array:
    E = np.zeros((6, 6))
    E[row, column] = 1.0
    return E


# Gravity in the chain: what a tilt adds to the acceleration that a structure feels and that an accelerometer reads.
#
# A body that has turned by phi carries its axes with it: in them the free fall that it lacks, a - g, has gained -g (phi x e_z)
# along x and y. With phi = -alpha'' / omega² and so on, one matrix holds the whole effect for every place of the body:
#
#     apparent u = (I + g/omega² E) u,      E[x, beta] = 1,  E[y, alpha] = -1,  E² = 0.
#
# The latent u of the chain is the apparent acceleration that drives the *structure*. A sensor that tilts reads the same, and
# gravity cancels; a kinematic one reads (I - g/omega² E) u.

STRUCTURE = "gravity"
SENSOR = "accelerometer-tilt"


def turned(rows: Array) -> Array:
    """``rows @ E`` of rows (..., 6)."""
    return np.asarray(rows @ TILT)


# Accelerometers on the cover plate or the table: from the motion of the reference point to what they read.
#
#     y = factor · d^T [G(p)] u          on the cover plate, u apparent (`identification.chain`)
#     y = factor · d^T [G(p)] u_t        on the table, u_t = u - omega² K^-1 H u: below the load cells
#
# Position p and direction d are those of the table of channels, shifted and turned by their tolerances. Should the cover plate
# bend under a vertical force, its vertical pick-ups read -omega² c f_z on top.

BENDING = "cover-plate-flexibility"
PARALLEL = 1e-6
"""Sine of the angle below which a direction lies along an axis: a shift along it, or a turn about it, changes nothing."""

Rows = tuple[ComplexArray, ComplexArray]
"""A0 and A1, (n, c, 6) each."""

Vector = tuple[float, float, float]

KEPT = 4096
"""[count] of pick-ups where they were last asked for, whose rows are kept: most stay where they are from one evaluation to the
next, and only those that a fit moves are placed anew."""


@dataclass(frozen=True, eq=False, kw_only=True)
class PickUps(Placed):
    """The accelerometers of one group.

    Attributes
    ----------
    group : "cover", "table" or "article"
    point : (3,) [m] reference point, in the frame of the places
    springs : what the cover plate stands on
    gravity : [m/s²]

    On an article a pick-up moves with it: to the motion of a rigid one comes what it bends there, which stands behind the loads.
    """

    group: str
    point: Array
    springs: Springs
    gravity: float

    def parameters(self, known: Tolerances) -> Iterator[Parameter]:
        """All that they could do wrong, with the tolerance of an ordinary laboratory; 0 for what none expects."""
        gain = known.table_gain if self.group == "table" else known.gain
        yield from channel_parameters(self.names, self.first, "accelerometer", self.group, gain, known)
        for family, unit, size in (("position", "m", known.position), ("misalignment", "rad", known.angle)):
            for k, channel in zip(self.columns, self.channels, strict=True):
                axes = self._across(channel)[family]
                for axis in axes:
                    yield Parameter(
                        name=f"accelerometer-{family}:{channel.name}:{axis}", unit=unit, tolerance=size, channels=(k,)
                    )
        if self.group == "cover" and self.channels:
            yield Parameter(name=BENDING, unit="m/N", tolerance=0.0, channels=self.columns)

    def rows(self, x: Offsets, frequency: Array) -> Rows:
        """A0 and A1 of the accelerometers, (n, c, 6) each, at `frequency` (n,) [Hz]."""
        geometry, upward = self._geometry(x)
        return self._sight(x, frequency).seen(geometry, upward, list(range(len(self.channels))))

    def changes(
        self, x: Offsets, frequency: Array, H: ComplexArray, wanted: Collection[str]
    ) -> Iterator[tuple[str, list[int], ComplexArray]]:
        """By parameter of those `wanted`: the channels it touches, and d (A0 + A1 H) / d offset of these, (n, k, 6)."""
        sight = self._sight(x, frequency)
        geometry, upward = self._geometry(x)
        every = list(range(len(self.channels)))
        A0, A1 = sight.seen(geometry, upward, every)
        rows = A0 + A1 @ H
        for key, touched, slope in channel_changes(self.names, "accelerometer", self.group, x, frequency, wanted):
            yield key, touched, slope[:, :, None] * rows[:, touched]
        if moved := list(self._geometry_changes(x, wanted)):  # all of them by one product
            keys, at, changes, rises = zip(*moved, strict=True)
            A0, A1 = sight.seen(np.array(changes), np.array(rises), list(at))
            rows = A0 + A1 @ H
            yield from ((key, [k], rows[:, [place]]) for place, (key, k) in enumerate(zip(keys, at, strict=True)))
        common = self._common_changes(x, sight, geometry, upward)
        yield from ((key, every, A0 + A1 @ H[:, :6]) for key, (A0, A1) in common if key in wanted)

    @staticmethod
    @lru_cache(maxsize=KEPT)
    def _across(channel: Channel) -> dict[str, str]:
        """Axes along which a shift, and the two about which a turn, changes what `channel` reads."""
        sizes = np.array([np.min(np.abs([np.linalg.norm(np.cross(e, p.direction)) for p in channel.places])) for e in np.eye(3)])
        return {
            "position": "".join(axis for axis, size in zip(AXES, sizes, strict=True) if size > PARALLEL),
            "misalignment": "".join(AXES[k] for k in sorted(np.argsort(-sizes, kind="stable")[:2])),
        }

    def directions(self, x: Offsets) -> dict[str, Array]:
        """By channel the unit vector (3,) along which it reads."""
        return {one.name: row[:3] / np.linalg.norm(row[:3]) for one, row in zip(self.channels, self._geometry(x)[0], strict=True)}

    def _geometry(self, x: Offsets) -> tuple[Array, Array]:
        """d^T [G(p)] (c, 6), and the vertical component of d (c,), as they are."""
        made = [placed(channel, *self._away(channel, x)) for channel in self.channels]
        return np.array([row for row, _ in made]).reshape(-1, 6), np.array([up for _, up in made])

    def _away(self, channel: Channel, x: Offsets) -> tuple[Vector, Vector, Vector]:
        """The reference point, and by how much `channel` is shifted and turned."""

        def vector(family: str) -> Vector:
            stem = f"accelerometer-{family}:{channel.name}"
            return x.get(f"{stem}:x", 0.0), x.get(f"{stem}:y", 0.0), x.get(f"{stem}:z", 0.0)

        along, across, up = self.point.tolist()
        return (along, across, up), vector("position"), vector("misalignment")

    def _geometry_changes(self, x: Offsets, wanted: Collection[str]) -> Iterator[tuple[str, int, Array, float]]:
        """By `wanted` parameter of position and angle: the channel, the changes (6,) of its row and of its rise."""
        for k, channel in enumerate(self.channels):
            names = {family: f"accelerometer-{family}:{channel.name}" for family in ("position", "misalignment")}
            if not any(f"{name}:{axis}" in wanted for name in names.values() for axis in AXES):
                continue
            for (family, axis), (change, rise) in placed_changes(channel, *self._away(channel, x)).items():
                if (key := f"{names[family]}:{axis}") in wanted:
                    yield key, k, change, rise

    def _sight(self, x: Offsets, frequency: Array) -> "Sight":
        table = self.group == "table"
        senses = np.array([channel.senses_gravity for channel in self.channels], dtype=np.float64)
        return Sight(
            factors=factors(self.names, "accelerometer", self.group, x, frequency),
            square=np.square(2 * np.pi * frequency),
            sensor=self.gravity * (1 + x.get(SENSOR, 0.0)) * senses,
            structure=self.gravity * (1 + x.get(STRUCTURE, 0.0)),
            compliance=self.springs.compliance(x) if table else np.zeros((6, 6)),
            bending=x.get(BENDING, 0.0) if self.group == "cover" else 0.0,
            bends=self.group == "article",
        )

    def _common_changes(self, x: Offsets, sight: "Sight", geometry: Array, upward: Array) -> Iterator[tuple[str, Rows]]:
        """Of what all channels of the group share: tilt, springs, a cover plate that bends."""
        f, square, more = sight.factors[:, :, None], sight.square[:, None, None], turned(geometry)
        none = np.zeros((*sight.factors.shape, 6), dtype=np.complex128)
        senses = np.array([channel.senses_gravity for channel in self.channels], dtype=np.float64)[:, None]
        if STRUCTURE in x:
            yield STRUCTURE, (-f * self.gravity * more / square, none)
        if SENSOR in x:
            weight = f * self.gravity * senses
            yield SENSOR, (np.asarray(weight * more / square), np.asarray(-weight * (more @ sight.compliance)))
        if self.group == "table":
            for key, change in self.springs.compliance_changes(x):
                yield key, (none, np.asarray(-f * ((square * geometry + sight.sensor[:, None] * more) @ change)))
        elif BENDING in x and self.group == "cover":
            bent = none.copy()
            bent[..., 2] = -sight.factors * sight.square[:, None] * upward
            yield BENDING, (none, bent)


@dataclass(frozen=True, eq=False, kw_only=True)
class Sight:
    """What rows do at the lines: everything between the geometry of a pick-up and the record, at one theta.

    Attributes
    ----------
    factors : (n, c)
    square : (n,) omega² [rad²/s²]
    sensor, structure : (c,) g times the tilt that each senses, and g times that which the structure feels [m/s²]
    compliance : (6, 6) K^-1 of a table, complex where the cells lose, zeros for a cover plate
    bending : [m/N] of a cover plate
    bends : whether each channel sees three accelerations of its own, behind the loads
    """

    factors: ComplexArray
    square: Array
    sensor: Array
    structure: float
    compliance: npt.NDArray[Any]
    bending: float
    bends: bool = False

    def seen(self, geometry: Array, upward: Array, chosen: list[int]) -> Rows:
        """A0 (n, k, 6), A1 (n, k, 6 or 6 + 3 c) of the `chosen` channels with rows `geometry` (k, 6) and vertical components
        `upward` (k,)."""
        f, square = self.factors[:, chosen, None], self.square[:, None, None]
        more, sensed = turned(geometry), self.sensor[chosen, None]
        A0 = f * (geometry + (sensed - self.structure) * more / square)
        A1 = -f * ((square * geometry + sensed * more) @ self.compliance)
        A1[..., 2] -= f[..., 0] * square[..., 0] * self.bending * upward
        if self.bends:
            own = np.zeros((*A1.shape[:2], self.factors.shape[1], 3), dtype=np.complex128)
            own[:, np.arange(len(chosen)), chosen] = f * geometry[:, :3]
            A1 = np.concatenate([A1, own.reshape(*A1.shape[:2], -1)], axis=2)
        return np.asarray(A0), np.asarray(A1)


@lru_cache(maxsize=KEPT)
def placed(channel: Channel, point: Vector, shift: Vector, turn: Vector) -> tuple[Array, float]:
    """d^T [G(p)] (6,) of a `channel` about `point` [m], shifted [m] and turned [rad], and the vertical component of d."""
    directions, arms = _aimed(channel, point, shift, turn)
    row = np.concatenate([directions, np.cross(arms, directions)], axis=1).mean(axis=0)
    return frozen(row, (6,), "row"), float(directions[:, 2].mean())


@lru_cache(maxsize=KEPT)
def placed_changes(channel: Channel, point: Vector, shift: Vector, turn: Vector) -> dict[tuple[str, str], tuple[Array, float]]:
    """By family and axis, how both answer to a further shift or turn."""
    directions, arms = _aimed(channel, point, shift, turn)
    shifted = np.cross(np.eye(3), directions.mean(axis=0))
    turned = np.cross(left_jacobian(np.array(turn)).T[:, None], directions)  # (3, places, 3)
    rows = np.concatenate([turned, np.cross(arms, turned)], axis=2).mean(axis=1)
    found: dict[tuple[str, str], tuple[Array, float]] = {}
    for k, axis in enumerate(AXES):
        found["position", axis] = np.concatenate([np.zeros(3), shifted[k]]), 0.0
        found["misalignment", axis] = rows[k], float(turned[k, :, 2].mean())
    return found


def _aimed(channel: Channel, point: Vector, shift: Vector, turn: Vector) -> tuple[Array, Array]:
    """Directions and arms [m] about `point` of the places of a `channel`, (k, 3) each."""
    directions = np.array([place.direction for place in channel.places]) @ rotation_by(np.array(turn)).T
    return directions, np.array([place.position for place in channel.places]) + np.array(shift) - np.array(point)


@dataclass(frozen=True, eq=False, kw_only=True)
class Derivative:
    """How the chain answers to one parameter.

    Attributes
    ----------
    channels : columns of the chain that change, all others do not
    rows : (n, k, 6) complex, d(A0 + A1 H) / d offset of these
    """

    channels: tuple[int, ...]
    rows: ComplexArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Chain:
    """A measurement chain. A vector theta (p,) holds offsets of `parameters` from nominal; zeros are the chain as drawn.

    Attributes
    ----------
    columns : indices in the channel table of the chain's channels, in the order of its rows
    names : (c,) of these
    parameters : that may move
    possible : names of every parameter that it could have, open or not
    left_out : names of channels of the table that the chain does not predict
    cover, table, article, forces : its parts
    springs : the load cells

    With a pick-ups on the article, "loads" below are 6 + 3 a: behind those on the cells stand the accelerations of the article
    at each of them along x, y, z, beyond those of a rigid one.
    """

    columns: tuple[int, ...]
    names: tuple[str, ...]
    parameters: tuple[Parameter, ...]
    possible: tuple[str, ...]
    left_out: tuple[str, ...]
    cover: PickUps
    table: PickUps
    article: PickUps
    forces: Loads
    springs: Springs

    def __len__(self) -> int:
        return len(self.columns)

    @property
    def tolerances(self) -> Array:
        """(p,) standard deviation of every offset before anything was measured."""
        return np.array([one.tolerance for one in self.parameters])

    def theta(self, values: Mapping[str, float]) -> Array:
        """(p,) offsets at which the parameters named in `values` have these values and all others their nominal one.

        Raises
        ------
        BadInput : a name of no open parameter, or a value that turns a stiffness negative.
        """
        by_name = {one.name: k for k, one in enumerate(self.parameters)}
        theta = np.zeros(len(self.parameters))
        for name, value in values.items():
            if name not in by_name:
                raise BadInput("measurement chain", name, "the chain has no such open parameter", "Give it a tolerance above 0")
            theta[by_name[name]] = self.parameters[by_name[name]].offset(value)
        return theta

    def values(self, theta: npt.ArrayLike) -> dict[str, float]:
        """By parameter, its value in its unit at `theta` (p,)."""
        return {one.name: one.value(float(t)) for one, t in zip(self.parameters, self._checked(theta), strict=True)}

    def rows(self, theta: npt.ArrayLike, frequency: npt.ArrayLike) -> tuple[ComplexArray, ComplexArray]:
        """A0 and A1, (n, c, 6) each, at `theta` (p,) and `frequency` (n,) [Hz], above zero: channels = (A0 + A1 H) u.

        Columns are the motions, and for A1 the loads, about the reference point in the order of `MOTIONS`.
        """
        x, lines = self._offsets(theta), _lines(frequency)
        whole = [*(part.rows(x, lines) for part in (self.cover, self.table)), (None, self.forces.rows(x, lines))]
        if self.article.channels:
            whole.insert(2, self.article.rows(x, lines))
        width = 6 + 3 * len(self.article.channels)
        A0 = [np.zeros_like(A1) if of is None else of for of, A1 in whole]
        A1 = [np.pad(A1, ((0, 0), (0, 0), (0, width - A1.shape[2]))) if A1.shape[2] < width else A1 for _, A1 in whole]
        return np.concatenate(A0, axis=1), np.concatenate(A1, axis=1)

    def derivatives(
        self, theta: npt.ArrayLike, frequency: npt.ArrayLike, H: npt.ArrayLike, wanted: Collection[str] | None = None
    ) -> tuple[Derivative, ...]:
        """By parameter, in order, d(A0 + A1 H) / d offset at `theta` (p,), `frequency` (n,) [Hz] and `H` (n, 6, 6).

        Of parameters whose names are not `wanted` there are none; by default all are.
        """
        names = [one.name for one in self.parameters if wanted is None or one.name in wanted]
        x, lines = self._offsets(theta), _lines(frequency)
        width = 6 + 3 * len(self.article.channels)
        matrix = np.broadcast_to(np.asarray(H, dtype=np.complex128), (len(lines), width, 6))
        found: dict[str, list[tuple[list[int], ComplexArray]]] = {name: [] for name in names}
        for part in (self.cover, self.table, self.article):
            of = matrix if part is self.article else matrix[:, :6]
            for key, touched, rows in part.changes(x, lines, of, found) if part.channels else ():
                found[key].append(([part.first + k for k in touched], rows))
        for key, touched, rows in self.forces.changes(x, lines, matrix[:, :6], found):
            found[key].append(([self.forces.first + k for k in touched], rows))
        return tuple(
            Derivative(
                channels=tuple(k for touched, _ in found[name] for k in touched),
                rows=found[name][0][1] if len(found[name]) == 1 else np.concatenate([rows for _, rows in found[name]], axis=1),
            )
            for name in names
        )

    def _checked(self, theta: npt.ArrayLike) -> Array:
        return frozen(theta, (len(self.parameters),), "theta")

    def _offsets(self, theta: npt.ArrayLike) -> dict[str, float]:
        return {one.name: float(t) for one, t in zip(self.parameters, self._checked(theta), strict=True)}


def chain(
    table: ChannelTable,
    tolerances: Tolerances | None = None,
    *,
    stiffness: npt.ArrayLike | None = None,
    gravity: float = STANDARD_GRAVITY,
    overrides: Mapping[str, float] = MappingProxyType({}),
    on_article: Collection[str] = (),
) -> Chain:
    """The chain of `table`: accelerometers on cover plate, table and article, then forces and moments of the FMD.

    Parameters
    ----------
    table : channels and reference point
    tolerances : priors; those of an ordinary laboratory by default
    stiffness : (3,) [N/m] of one load cell along x, y, z; infinity for an FMD that does not give. None when nobody knows: that of
        the reconstructed FMD then, with a prior as wide as the ignorance
    gravity : [m/s²]
    overrides : standard deviations by name of a parameter or of its family, in place of `tolerances`. 0 closes a
        parameter; what is closed by default (delays of boards, shunts, high-passes, ...) opens by a positive one
    on_article : names of accelerometers of the group "article" whose motion somebody predicts; the others are left out

    Raises
    ------
    BadInput : a stiffness or an override that cannot be used.
    """
    known = tolerances or Tolerances()
    cover, below, force = (
        table.select(group=group, quantity=quantity)
        for group, quantity in (("cover", "acceleration"), ("table", "acceleration"), ("fmd", ("force", "moment")))
    )
    upon = tuple(k for k in table.select(group="article", quantity="acceleration") if table.channels[k].name in on_article)
    columns = (*cover, *below, *upon, *force)
    sums = summation([table.channels[k] for k in force], table.origin)
    elements = [place for quantity, place in sums.elements if quantity == "force"]
    springs = cell_springs(elements, table.origin, stiffness)
    parts = [
        PickUps(
            group=group,
            channels=tuple(table.channels[k] for k in chosen),
            first=first,
            point=table.origin,
            springs=springs,
            gravity=gravity,
        )
        for group, chosen, first in (
            ("cover", cover, 0),
            ("table", below, len(cover)),
            ("article", upon, len(cover) + len(below)),
        )
    ]
    first = len(cover) + len(below) + len(upon)
    forces = Loads(channels=tuple(table.channels[k] for k in force), first=first, sums=sums, springs=springs)
    candidates = _candidates(parts[0], parts[1], parts[2], forces, known, ASSUMED if stiffness is None else STATED)
    return Chain(
        columns=columns,
        names=tuple(table.names[k] for k in columns),
        parameters=opened(candidates, overrides),
        possible=tuple(one.name for one in candidates),
        left_out=tuple(channel.name for k, channel in enumerate(table.channels) if k not in columns),
        cover=parts[0],
        table=parts[1],
        article=parts[2],
        forces=forces,
        springs=springs,
    )


def _candidates(
    cover: PickUps, table: PickUps, article: PickUps, forces: Loads, known: Tolerances, softness: float
) -> tuple[Parameter, ...]:
    """Every parameter that the chain could have, family by family; tolerance 0 where none is expected to move."""
    springs, below = forces.springs, table.columns if not forces.springs.rigid else ()
    cell = Parameter(
        name=ELEMENT,
        unit="1",
        tolerance=known.cell_stiffness,
        channels=(*below, *forces.columns),
        nominal=1.0,
        logarithmic=True,
        above=-1.0,
    )
    common = Parameter(name=COMPLIANCE, unit="1", tolerance=softness, channels=below, nominal=1.0, logarithmic=True)
    lost = Parameter(name=LOSS, unit="1", tolerance=0.0, channels=below, low=0.0)
    gravity = Parameter(
        name=STRUCTURE, unit="1", tolerance=0.0, channels=(*cover.columns, *table.columns, *article.columns), nominal=1.0
    )
    found = [
        *forces.parameters(known),
        *cover.parameters(known),
        *table.parameters(known),
        *(article.parameters(known) if article.channels else ()),
        *(replace(cell, name=f"{ELEMENT}:{name}") for name in (springs.names if springs.of_cells else ())),
        *(replace(one, name=f"{one.name}:{name}") for one in (common, lost) for name in springs.shares if below),
        *(replace(gravity, name=name) for name in (STRUCTURE, SENSOR) if gravity.channels),
    ]
    return tuple(sorted(found, key=lambda one: _FAMILIES.index(one.family)))


_FAMILIES = (
    *("force-gain", "accelerometer-gain", "force-delay", "accelerometer-delay", "board-delay", "force-highpass"),
    *("accelerometer-highpass", "accelerometer-position", "accelerometer-misalignment", ELEMENT, COMPLIANCE, LOSS),
    *("force-crosstalk", INSIDE, "load-path-shunt", "force-plane-offset", "cover-plate-flexibility", STRUCTURE, SENSOR),
)


def _lines(frequency: npt.ArrayLike) -> Array:
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if np.any(lines <= 0):
        raise ValueError(f"`frequency` must be above zero, found {lines.min():g}: at rest a tilt is no acceleration")
    return frozen(lines, lines.shape, "frequency")
