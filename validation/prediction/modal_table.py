"""A table of modes: frequencies, damping and shapes that a model of the structure should have, each with its derivatives.

    reduced matrices of the structure        tolerances, effects of the structure
    -> real modes K phi = omega² M phi       paired with the table by shape and frequency
    -> frequencies and damping ratios        one run a mode, input 1
    -> shapes at the sensors                 one run a mode, its factor unknown: gains and effects of the channels

With phi^T M phi = 1 and dB_i = dK - omega_i² dM the derivatives are those of full modal superposition (R. L. Fox and M. P.
Kapoor, AIAA Journal 6, 1968),

    d omega_i² = phi_i^T dB_i phi_i ,
    d phi_i = sum_j phi_j (phi_j^T dB_i phi_i) / (omega_i² - omega_j²) - phi_i (phi_i^T dM phi_i) / 2 ,      j other than i,

exact because all modes of the reduced matrices are there. The damping ratio of a real mode is that of the energy that it loses,
zeta_i = phi_i^T (omega_i C + S) phi_i / (2 omega_i²).
"""

from abc import ABC, abstractmethod
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, partial
from typing import Self

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.sensors import Point, Tolerances
from identification.modal_table import HEAVY, SOUND_SHAPE, ModalTable, alike, mac, paired
from validation.effects.catalogue import FAMILIES, There
from validation.effects.effect import CHANNEL_STAGE, STRUCTURE_STAGE
from validation.effects.stages import ChannelResponse, Matrices
from validation.estimation.problem import MODE, Change, Lines, Measured, Offsets, Parameter, Predicted, Wanted
from validation.model.model import Added
from validation.prediction import dynamic_mass, points
from validation.prediction import effects as prediction_effects
from validation.prediction.effects import Nuisances
from validation.prediction.tangents import LAWS, Tangent

FREQUENCY, DAMPING = "frequency", "damping"
"""Channels of the one data set of a table; those of the other are its sensors."""

WINDOW = "exponential-window"
"""A fault of the method, a parameter where an effect opens it."""

READ_ALONE = (*points.RESPONSES, "accelerometer-gain", WINDOW)
"""Families that change what is read of modes, not these."""

LOSSES = ("loss", "damping", "coupling", "structural-damping", *LAWS)
"""Families of parameters that change what a mode loses, and neither its frequency nor its shape."""

SLOWEST = 0.01
"""Share of the lowest frequency of a table below which a mode of the model is the motion of a free body."""

SHIFTED = 1e-9
"""Of the mean of omega² over all coordinates, what the energy in which modes are sought has of the mass beside the stiffness."""

MASSLESS = 1e-13
"""Share of the mass of the slowest coordinate below which one has none."""

WHOLE = 2.0
"""Of the highest frequency of a table, up to where modes are mixed as they are once something stands on the structure. Held by
test_modal_table.py."""

CLOSEST = 1e-9
"""Least distance of two squares of frequencies, relative: nearer modes have no shape of their own."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Moved:
    """How some modes answer to one parameter.

    Attributes
    ----------
    squares : (m,) d omega² [1/s²]
    shares : (k, m) of every mode in the change of their shapes
    damping_ratio : (m,) its change
    """

    squares: Array
    shares: Array
    damping_ratio: Array

    def on(self, runs: Sequence[int]) -> "Moved":
        """Of some of them."""
        return Moved(**{name: np.asarray(one)[..., list(runs)] for name, one in vars(self).items()})


@dataclass(frozen=True, eq=False, kw_only=True)
class RealModes:
    """Modes of reduced matrices.

    Attributes
    ----------
    matrices : whose they are; of `loaded` ones those of the structure without its loads
    squares : (m,) omega² [1/s²], ascending; of motions of a free body about zero, infinite of coordinates without mass
    shapes : (k, m) a column a mode, of mass 1; of a coordinate without mass of strain energy 1/2; m is k but for `loaded` ones
    """

    matrices: Matrices
    squares: Array
    shapes: Array
    _lost: dict[tuple[int, ...], tuple[Array, Array, Array, Array]] = field(default_factory=dict, init=False)

    @property
    def frequency(self) -> Array:
        """(k,) [Hz]."""
        return np.asarray(np.sqrt(np.maximum(self.squares, 0.0)) / (2 * np.pi))

    def damping_ratio(self, mode: int) -> float:
        """[1] of one mode, by the energy that it loses."""
        omega, phi = np.sqrt(self.squares[mode]), self.shapes[:, mode]
        return float(phi @ (omega * (self.matrices.viscous @ phi) + self.matrices.structural @ phi) / (2 * omega**2))

    def changed(self, of: Sequence[int], by: Tangent, *, damped: bool = True) -> "Moved":
        """How the modes `of` answer to one parameter; what they lose, where that is `damped`, else 0."""
        square, gaps, drag_of_itself, lost = self._of(tuple(of))
        every = self.shapes if len(by.at) == len(self.shapes) else self.shapes[by.at]
        own = every[:, list(of)]
        pulled, heavier = by.times("stiffness", own), 0.0
        if np.any(by.mass):
            weighed = by.times("mass", own)
            pulled, heavier = pulled - square * weighed, np.sum(own * weighed, axis=0) / 2
        force, which = every.T @ pulled, np.arange(len(square))
        shares = force / gaps
        shares[list(of), which] = -heavier
        d_square = force[list(of), which]
        if not damped:
            return Moved(squares=d_square, shares=shares, damping_ratio=np.zeros_like(d_square))
        # zeta = q / (2 omega²), q = phi^T (omega C + S) phi
        omega = np.sqrt(square)
        d_omega = d_square / (2 * omega)
        d_loss = d_omega * drag_of_itself + 2 * np.sum(shares * lost, axis=0)
        if np.any(by.viscous):
            d_loss = d_loss + omega * np.sum(own * by.times("viscous", own), axis=0)
        if np.any(by.structural):
            d_loss = d_loss + np.sum(own * by.times("structural", own), axis=0)
        ratio = (d_loss - lost[list(of), which] * d_square / square) / (2 * square)
        return Moved(squares=d_square, shares=shares, damping_ratio=ratio)

    def _of(self, of: tuple[int, ...]) -> tuple[Array, Array, Array, Array]:
        """Of modes (m,) squares, gaps (k, m), phi^T C phi, and what each mode meets of their losses (k, m)."""
        if of not in self._lost:
            phi, square = self.shapes[:, list(of)], self.squares[list(of)]
            drag = self.matrices.viscous @ phi
            gaps = np.stack([self._gaps(mode) for mode in of], axis=1) if of else np.zeros((len(self.squares), 0))
            lost = self.shapes.T @ (np.sqrt(square) * drag + self.matrices.structural @ phi)
            self._lost[of] = square, gaps, np.sum(phi * drag, axis=0), lost
        return self._lost[of]

    def attached(self, mode: int, moved: Array) -> tuple[Array, Array, Array]:
        """The same of a mass on each of `moved` (q, k), what modes move a place along an axis: (q,), (k, q) and (q,), per kg."""
        square, own = self.squares[mode], moved[:, mode]
        far = self._gaps(mode)
        shares = -square * (moved * own[:, None]).T / far[:, None]
        shares[mode] = -(own**2) / 2
        shapes, d_square = self.shapes @ shares, -square * own**2
        omega, C, S, phi = np.sqrt(square), self.matrices.viscous, self.matrices.structural, self.shapes[:, mode]
        lost = (omega * C + S) @ phi
        d_loss = d_square / (2 * omega) * (phi @ C @ phi) + 2 * lost @ shapes
        return d_square, shapes, (d_loss - phi @ lost * d_square / square) / (2 * square)

    def loaded(self, row: Array, count: int) -> Callable[[Array, Array], "RealModes"]:
        """Modes once masses [kg] and springs [N/m] (3,) stand where coordinates move `row` (3, j), those that follow it nothing.

        `count` of the modes are mixed as they are, and of all others what they give to forces along `row` and to the inertia of
        that: what a mode lacks goes with the fourth power of its frequency over theirs.
        """
        at, moving = row @ self.shapes[: row.shape[1]], np.isfinite(self.squares)
        stiff, heavy = np.where(moving, self.squares, 1.0), moving * 1.0
        gives = at[:, count:].T / np.sqrt(stiff[count:, None])
        gives, _ = np.linalg.qr(np.hstack([gives, gives * (heavy[count:] / stiff[count:])[:, None]]))
        others = gives / np.sqrt(stiff[count:, None])  # of strain energy 1/2
        mixed = np.hstack([self.shapes[:, :count], self.shapes[:, count:] @ others])
        at, near = np.hstack([at[:, :count], at[:, count:] @ others]), len(stiff[:count])
        more = np.ones(others.shape[1])
        stiffness, mass = np.diag(np.append(stiff[:count], more)), np.diag(np.append(heavy[:count], more))
        mass[near:, near:] = others.T @ (heavy[count:, None] * others)

        def modes(masses: Array, springs: Array) -> RealModes:
            squares, shapes = real_pairs(stiffness + (at.T * springs) @ at, mass + (at.T * masses) @ at)
            return replace(self, squares=squares, shapes=mixed @ shapes)

        return modes

    def _gaps(self, mode: int) -> Array:
        """(k,) square of the frequency of `mode` less that of every other [1/s²], by which shapes mix."""
        square, moving = self.squares[mode], np.isfinite(self.squares)
        gap = np.where(moving, square - self.squares, -1.0)
        return np.maximum(np.abs(gap), np.where(moving, CLOSEST * square, 0.0)) * np.where(gap < 0, -1.0, 1.0)


def real_modes(matrices: Matrices) -> RealModes:
    """Modes of `matrices`, all of whose coordinates move, without their losses; as `real_pairs`."""
    squares, shapes = real_pairs(matrices.stiffness, matrices.mass)
    return RealModes(matrices=matrices, squares=squares, shapes=shapes)


def real_pairs(K: Array, M: Array) -> tuple[Array, Array]:
    """omega² (k,), ascending, and shapes (k, k) of stiffness `K` and mass `M` (k, k).

    They are those of the mass in the energy A = K + s M, of which a floating body has some, too: what has no mass is a mode of
    infinite frequency there.

    Raises
    ------
    numpy.linalg.LinAlgError : something has neither mass nor stiffness.
    """
    from scipy.linalg import eigh

    shift = SHIFTED * np.trace(K) / np.trace(M)
    shares, shapes = eigh(M, K + shift * M)
    shares, shapes = shares[::-1], shapes[:, ::-1]
    moving = shares > MASSLESS * shares[0]
    root = np.sqrt(np.where(moving, shares, 1.0))
    return np.where(moving, 1 / root**2 - shift, np.inf), shapes / root


def seen(matrices: Matrices, table: ModalTable) -> Array:
    """(s, k) what each coordinate moves the sensors of `table`."""
    return points.stated(matrices, table.sensors)


def partners(modes: RealModes, table: ModalTable, effects: Sequence[Added] = ()) -> tuple[int, ...]:
    """(m,) which of `modes` is the partner of every mode of `table`, by the rule of `identification.modal_table.paired`.

    Shapes of the model are read as the sensors do with the mistakes that are among `effects`: one with a wrong sign would pair
    modes whose shapes differ by it.

    Raises
    ------
    ValueError : the model has fewer modes than the table.
    """
    f = modes.frequency
    moving = np.flatnonzero(f > SLOWEST * table.frequency.min())
    moving = moving[np.isfinite(f[moving])]
    if len(moving) < len(table.frequency):
        raise ValueError(f"the model has {len(moving)} modes, and the table {len(table.frequency)}")
    shapes = None if table.shapes is None else read_by(modes, moving, table, effects)
    known = table.frequency if table.since is None or table.before is None else table.since * table.before[:, 0]  # as it was
    return tuple(int(moving[k]) for k in paired(known, f[moving], table.shapes, shapes))


def read_by(modes: RealModes, of: Integers, table: ModalTable, effects: Sequence[Added]) -> ComplexArray:
    """(q, s) what the sensors of `table` read of the modes `of` (q,), with those of `effects` that are known mistakes."""
    mistaken = [one for one in effects if one.fixed]
    sizes = {one.named.id: one.named.value for one in mistaken if one.named.family in points.RESPONSES}
    where = points.rows(modes.matrices, table.sensors, (), points.asked(mistaken, points.RESPONSES), sizes)
    read = (where.values @ modes.shapes[:, of]).T[:, :, None].astype(np.complex128)
    stage = ChannelResponse(frequency=modes.frequency[of], channels=tuple(one.name for one in table.sensors), rows=read)
    return prediction_effects.channels(stage, {}, mistaken, derivatives=False)[0].rows[..., 0]


STRANGE = 0.5
"""[1] MAC below which two modes are no pair. By definition: most of the motion of one is not in the other."""

ALIKE = 0.8
"""[1] MAC from which all other modes of a table must have partners for one to be a stranger among them. By definition, between
the 0.9 of shapes that are called one and what a fault leaves of those that it changes."""


def since_before(modes: RealModes, table: ModalTable) -> ModalTable:
    """`table` as it would be of an article that had the frequencies of the model before, mode by mode: only what has changed
    since is left.

    Raises
    ------
    ValueError : the model has fewer modes than the table.
    """
    if table.before is None:
        return table
    before, known = table.before.T
    since = modes.frequency[list(partners(modes, replace(table, frequency=before)))] / before
    told = np.sqrt(np.mean((since - 1) ** 2)) * (table.frequency - before)  # a model that is off tells changes no better
    both = np.hypot(table.frequency_deviation, table.frequency / before * known)
    deviation = np.hypot(both, told)
    remark = "what is asked is how the frequencies have changed: the model is taken to be right before, mode by mode"
    changed = {"frequency": since * table.frequency, "frequency_deviation": since * deviation, "since": since}
    return replace(table, **changed, warnings=(*table.warnings, remark))


@dataclass(frozen=True, eq=False, kw_only=True)
class _TablePart(ABC):
    """What the two predictions of one table have in common.

    Attributes
    ----------
    measured : the data
    structure : the matrices, all coordinates of which move, and what is uncertain of them
    table : all of it, whatever runs are looked at: modes are paired together
    effects : in the order in which they act
    """

    measured: Measured
    structure: Nuisances
    table: ModalTable
    effects: tuple[Added, ...] = ()

    @property
    def modes(self) -> tuple[int, ...]:
        """(r,) which mode of the table each run is."""
        return tuple(self.table.names.index(run) for run in self.measured.runs)

    def found(
        self, offsets: Offsets, *, derivatives: Wanted
    ) -> tuple[RealModes, tuple[int, ...], Mapping[str, Moved], tuple[Added, ...]]:
        """Modes at `offsets`, the partner of every run, how these answer, and the effects as they stand.

        Frequencies and shapes of a table are asked one after the other of the same matrices: these are made once.
        """
        effects = prediction_effects.at(self.effects, offsets)
        if not derivatives:
            effects = tuple(replace(one, fixed=True) for one in effects)
        acting = tuple(one for one in effects if FAMILIES[one.named.family].stage == STRUCTURE_STAGE)
        stand = tuple((one.named.id, *one.named.values.items(), one.fixed) for one in acting)
        wanted = derivatives if isinstance(derivatives, bool) else frozenset(derivatives)
        damped = self.table.damping_deviation is not None
        if not damped and not isinstance(wanted, bool):  # real modes do not know what they lose
            wanted = frozenset(name for name in wanted if name.partition(":")[0] not in LOSSES)
        moving = frozenset((name, x) for name, x in offsets.items() if x and name.partition(":")[0] not in READ_ALONE)
        fixed = tuple((one.named.id, *one.named.values.items()) for one in self.effects if one.fixed)
        lately, told = self.structure.lately, (moving, stand, wanted)
        made = partial(dynamic_mass.structure, self.structure, offsets, acting, derivatives=wanted)
        matrices, tangents = lately("structure", told, made)
        modes: RealModes = lately("modes", matrices, lambda: real_modes(matrices))
        every = lately("partners", (modes, self.table, fixed), lambda: partners(modes, self.table, self.effects))
        each = partial(modes.changed, every, damped=damped)
        moved = lately("moved", (told, modes, every, damped), lambda: {name: each(one) for name, one in tangents.items()})
        if self.modes != tuple(range(len(every))):
            every, moved = tuple(every[k] for k in self.modes), {name: one.on(self.modes) for name, one in moved.items()}
        return modes, every, moved, effects

    @property
    def responses(self) -> tuple[Point, ...]:
        """Where it is read."""
        return self.table.sensors

    @property
    def there(self) -> There:
        """What effects can act on."""
        return prediction_effects.there_of(
            self.measured.configuration, self.structure, tuple(one.name for one in self.table.sensors)
        )

    @property
    def remarks(self) -> tuple[str, ...]:
        """What was assumed, sentences."""
        return self.table.warnings

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move: of the structure, of the sensors where they are read, and the effects."""
        return self._opened[0]

    @property
    @abstractmethod
    def _opened(self) -> tuple[tuple[Parameter, ...], Offsets]:
        """The parameters, and the offsets of those that stand at a given size."""

    def on(self, runs: Sequence[str]) -> Self:
        """The same model of the runs named alone."""
        return replace(self, measured=self.measured.on(runs))

    def by(self, structure: Nuisances) -> Self:
        """The same data by another model of the structure."""
        return replace(self, structure=structure)

    @property
    def together(self) -> tuple[list[int], ...]:
        """Runs whose modes in the model lie closer together than test and model know frequencies, before any fit."""
        modes, of, *_ = self.found({}, derivatives=False)
        f, known = modes.frequency[list(of)], self.table.frequency_deviation / self.table.frequency
        return alike(f, f * np.hypot(known[list(self.modes)], self.structure.tolerances.frequency))

    @property
    def strangers(self) -> tuple[str, ...]:
        """Names of the modes that stand in the way of all others, which are like modes of the model without them, before any fit:
        of a machine, the mains, or a part that the model has not. None where shapes do not say so, or half or more would be.
        """
        if self.table.shapes is None:
            return ()
        modes, kept = self.found({}, derivatives=False)[0], list(range(len(self.table.frequency)))
        finite = np.flatnonzero(np.isfinite(modes.frequency))
        like = np.zeros((len(kept), len(modes.frequency)))
        like[:, finite] = mac(self.table.shapes, read_by(modes, finite, self.table, self.effects))

        def pairs(of: Sequence[int]) -> Array:
            try:
                return like[of, list(partners(modes, self.table.of_modes(of), self.effects))]
            except ValueError:
                return np.zeros(len(of))

        if pairs(kept).min() >= STRANGE:
            return ()
        while 2 * (len(kept) - 1) > len(self.table.frequency):
            kept = max(([k for k in kept if k != one] for one in kept), key=lambda of: pairs(of).sum())
            if pairs(kept).min() >= ALIKE:
                return tuple(name for k, name in enumerate(self.table.names) if k not in kept)
        return ()

    def chance(self, mode: str) -> float:
        """[nats] by which it is less probable that the mode named was read anywhere than where a model has it: the logarithm of
        all that a table may hold, frequencies up to its highest and shapes of either sign, over the deviations.
        """
        k = self.measured.runs.index(mode)
        sd = self.measured.noise[k, 0] * np.sqrt(2 * np.pi)
        if not self.measured.judged.any():
            return float(np.sum(np.log(2 / sd)) - np.log(2 / sd.min()))  # its factor is free
        return float(np.sum(np.log(np.array([self.table.frequency.max(), HEAVY])[: len(sd)] / sd)))

    def without(self, modes: Sequence[str]) -> Self:
        """The same model of a table that has not the `modes` named."""
        kept = [k for k, name in enumerate(self.table.names) if name not in modes]
        left = [run for run in self.measured.runs if run not in modes]
        return replace(self, table=self.table.of_modes(kept), measured=self.measured.on(left))

    def attached(self, offsets: Offsets, lines: Lines, rows: Array, inputs: ComplexArray) -> dynamic_mass.AttachedResponse:
        """What a mass at places would change, to first order: all modes serve every place.

        Parameters
        ----------
        lines : the one of a table
        rows : (q, 3, k) what each coordinate of the structure moves the places along x, y, z
        """
        known = {**offsets, **self._opened[1]}
        modes, of, _, effects = self.found(known, derivatives=False)
        q = len(rows)
        moved = rows.reshape(3 * q, -1) @ modes.shapes[: rows.shape[2]]
        changed = np.stack([self._attached(modes, k, moved) for k in of])
        read = self._seen(changed, modes, of, known, effects)[:, None].reshape(len(of), 1, -1, q, 3)
        spring = -1 / modes.squares[list(of)]
        return dynamic_mass.AttachedResponse(readings=read, spring=spring[:, None].astype(np.complex128))

    def finite(self, offsets: Offsets, lines: Lines) -> dynamic_mass.Finite:
        """What is read with a mass or a spring of any size at a place."""
        known = {**offsets, **self._opened[1]}
        modes, _, _, effects = self.found(known, derivatives=False)
        f = self.table.frequency
        slow, below = np.searchsorted(modes.frequency, (SLOWEST * f.min(), WHOLE * f.max()))
        enough = max(int(below), int(slow) + 2 * len(f))

        def at(row: Array) -> Callable[[Array, Array], ComplexArray]:
            # Frequencies and shapes ask one after the other
            place, lately = row.tobytes(), self.structure.lately
            with_them = lately("place", (modes, self.table, place), lambda: modes.loaded(row, enough))

            def read(mass: Array, spring: Array) -> ComplexArray:
                key = (modes, self.table, place, mass.tobytes(), spring.tobytes())
                there = lately("attached", key, lambda: with_them(mass, spring))
                every = lately("beside", (there, self.table), lambda: partners(there, self.table, self.effects))
                return self._modes_read(there, [every[k] for k in self.modes], known, effects)

            return read

        return at

    @abstractmethod
    def _modes_read(self, modes: RealModes, of: Sequence[int], offsets: Offsets, effects: Sequence[Added]) -> ComplexArray:
        """(r, 1, c, 1) what is read of the modes `of`."""

    @abstractmethod
    def _attached(self, modes: RealModes, mode: int, moved: Array) -> Array:
        """(c, q) of one of `modes`, for masses on each of `moved` (q, k), before what is read of it."""

    @abstractmethod
    def _seen(
        self, changed: Array, modes: RealModes, of: Sequence[int], offsets: Offsets, effects: Sequence[Added]
    ) -> ComplexArray:
        """(r, c, q) what is read of changes (r, c, q) of the modes `of`."""

    def with_effects(self, effects: Sequence[Added]) -> Self:
        """The same table by a model with these `effects` instead of its own; those that reach nothing here do nothing."""
        return replace(self, effects=prediction_effects.reaching(effects, self.there))


@dataclass(frozen=True, eq=False, kw_only=True)
class TableFrequencies(_TablePart):
    """A model of the frequencies and damping ratios of a table: a `validation.estimation.problem.Prediction`, one run a mode."""

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        """As of any prediction; a table has one line."""
        known = {**offsets, **self._opened[1]}
        modes, of, moved, _ = self.found(known, derivatives=derivatives)
        wanted, lines_count = len(self.measured.channels), 1 if lines is None else len(lines)
        decay = known.get(WINDOW, 0.0)
        rows, changes = self._rows(modes, of, decay), {}
        if derivatives and WINDOW in (one.name for one in self.parameters):
            own = np.array([[0.0, 1 / np.sqrt(modes.squares[k])] for k in of], dtype=np.complex128)
            changes[WINDOW] = _change(own[:, :wanted], lines_count)
        squares, f = modes.squares[list(of)], modes.frequency[list(of)]
        for name, one in moved.items():
            if name in self._opened[1]:
                continue
            both = [one.squares / (8 * np.pi**2 * f), one.damping_ratio - decay * one.squares / (2 * squares**1.5)]
            changes[name] = _change(np.array(both[:wanted], dtype=np.complex128).T, lines_count)
        return Predicted(rows=_by_line(rows, lines_count), changes=changes)

    def _modes_read(self, modes: RealModes, of: Sequence[int], offsets: Offsets, effects: Sequence[Added]) -> ComplexArray:
        return _by_line(self._rows(modes, of), 1)

    def _rows(self, modes: RealModes, of: Sequence[int], decay: float = 0.0) -> ComplexArray:
        """(r, c) frequencies and, where they are measured, damping ratios of the modes `of` behind a window that decays."""
        rows = [modes.frequency[list(of)]]
        if len(self.measured.channels) > 1:
            rows.append(np.array([modes.damping_ratio(k) + decay / np.sqrt(modes.squares[k]) for k in of]))
        return np.array(rows, dtype=np.complex128).T

    def _attached(self, modes: RealModes, mode: int, moved: Array) -> Array:
        square, _, ratio = modes.attached(mode, moved)
        both = np.stack([square / (8 * np.pi**2 * modes.frequency[mode]), ratio])
        return np.asarray(both[: len(self.measured.channels)])

    def _seen(
        self, changed: Array, modes: RealModes, of: Sequence[int], offsets: Offsets, effects: Sequence[Added]
    ) -> ComplexArray:
        return changed.astype(np.complex128)

    @cached_property
    def _opened(self) -> tuple[tuple[Parameter, ...], Offsets]:
        ours = tuple(one for one in self.effects if FAMILIES[one.named.family].stage != CHANNEL_STAGE)
        damped = DAMPING in self.measured.channels
        window = [Parameter(name=WINDOW, unit="1/s", tolerance=1.0)] if damped and points.asked(ours, (WINDOW,)) else []
        left, given = prediction_effects.opened([*self.structure.parameters, *window], ours)
        return (*left, *prediction_effects.parameters(ours, self.structure)), given


@dataclass(frozen=True, eq=False, kw_only=True)
class TableShapes(_TablePart):
    """A model of the shapes of a table at its sensors: a `validation.estimation.problem.Prediction`, one run a mode."""

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        """As of any prediction; a table has one line."""
        known = {**offsets, **self._opened[1]}
        modes, of, changed, effects = self.found(known, derivatives=derivatives)
        count = 1 if lines is None else len(lines)
        where, sign, shapes, gains = self._shapes(modes, of, known)
        rows = where.values @ modes.shapes if changed else where.values
        moved = {name: sign * (rows @ one.shares).T for name, one in changed.items() if name not in self._opened[1]}
        for name, (k, row) in where.changes.items() if derivatives else ():
            moved[name] = np.zeros_like(shapes)
            moved[name][:, k] = sign[:, 0] * (row @ modes.shapes[:, of])
        made, changes = self._read(shapes, moved, gains, effects, derivatives=bool(derivatives))
        found = {name: _change(change, count) for name, change in changes.items() if name not in self._opened[1]}
        return Predicted(rows=_by_line(made, count), changes=found)

    def _shapes(self, modes: RealModes, of: Sequence[int], offsets: Offsets) -> tuple[points.PointRows, Array, Array, Array]:
        """What coordinates move the sensors, signs (r, 1), shapes (r, s) of the modes `of` with them, and gains (s,).

        The sign is that of the table, so that it does not hop.
        """
        asked = points.asked(self.effects, points.RESPONSES)
        where = points.rows(modes.matrices, self.table.sensors, (), asked, offsets)
        shapes = (where.values @ modes.shapes[:, list(of)]).T
        along = np.sum(shapes * self.measured.values[:, 0].real, axis=1, keepdims=True)
        sign = np.where(along < 0, -1.0, 1.0)
        return where, sign, sign * shapes, np.array([1 + offsets.get(name, 0.0) for name in self._gains])

    def _modes_read(self, modes: RealModes, of: Sequence[int], offsets: Offsets, effects: Sequence[Added]) -> ComplexArray:
        _, _, shapes, gains = self._shapes(modes, of, offsets)
        return _by_line(self._read(shapes, {}, gains, effects, derivatives=False)[0], 1)

    def _attached(self, modes: RealModes, mode: int, moved: Array) -> Array:
        return np.asarray(seen(modes.matrices, self.table) @ modes.attached(mode, moved)[1])

    def _seen(
        self, changed: Array, modes: RealModes, of: Sequence[int], offsets: Offsets, effects: Sequence[Added]
    ) -> ComplexArray:
        _, sign, shapes, gains = self._shapes(modes, of, offsets)
        places = {str(k): sign * changed[:, :, k] for k in range(changed.shape[2])}
        read = self._read(shapes, places, gains, effects, derivatives=False)[1]
        return np.stack(list(read.values()), axis=-1)

    def _read(
        self, shapes: Array, moved: Mapping[str, Array], gains: Array, effects: Sequence[Added], *, derivatives: bool
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """What the sensors read (r, s) of `shapes` (r, s), and its derivatives: gains, then effects of the channels."""
        tangents = {name: (gains * change).astype(np.complex128)[:, :, None] for name, change in moved.items()}
        for k, name in enumerate(self._gains) if derivatives else ():
            tangents[name] = np.zeros((*shapes.shape, 1), dtype=np.complex128)
            tangents[name][:, k, 0] = shapes[:, k]
        # Modes stand where lines do: an effect of the channels that turns with frequency sees that of each mode
        reading = ChannelResponse(
            frequency=self.table.frequency[list(self.modes)],
            channels=self.measured.channels,
            rows=(gains * shapes).astype(np.complex128)[:, :, None],
            amplitude=np.zeros(shapes.shape),
        )
        reading, tangents = prediction_effects.channels(reading, tangents, effects)
        return reading.rows[..., 0], {name: change[..., 0] for name, change in tangents.items()}

    @property
    def _gains(self) -> tuple[str, ...]:
        return tuple(f"accelerometer-gain:{channel}" for channel in self.measured.channels)

    @cached_property
    def _opened(self) -> tuple[tuple[Parameter, ...], Offsets]:
        gains = [Parameter(name=name, unit="1", tolerance=self.table.gain) for name in self._gains if self.table.gain > 0]
        asked = points.asked(self.effects, points.RESPONSES)
        moved = points.possible(self.structure, self.table.sensors, (), asked, points.EXACT)
        left, given = prediction_effects.opened([*self.structure.parameters, *gains, *moved], self.effects)
        return (*left, *prediction_effects.parameters(self.effects, self.structure)), given


def of(
    structure: Nuisances, table: ModalTable, tolerances: Tolerances = points.EXACT
) -> tuple[TableFrequencies | TableShapes, ...]:
    """The predictions of `table` by a model of what was tested: frequencies with damping, and shapes where there are any.

    Deviations of a shape are stated beside what its sensors see. Of a mode that moves them across, by far more than along, they
    see what they are turned by, within `tolerances`: where that is more than the deviation, it is one, too.

    Raises
    ------
    BadInput : a sensor at a place that the structure has not; fewer modes in the model than in the table.
    """
    points.require_places(table.sensors, structure.nominal.places, structure.configuration, table.source)
    modes = real_modes(structure.nominal)
    _require_hertz(table, modes.frequency)
    try:
        table = since_before(modes, table)
        every = partners(modes, table)
    except ValueError as error:
        remedy = "Keep more modes of the model, or leave modes out of the table"
        raise BadInput(table.source, "frequencies", str(error), remedy) from None
    damped = table.damping_ratio is not None and table.damping_deviation is not None
    values, deviation = [table.frequency], [table.frequency_deviation]
    if table.damping_ratio is not None and table.damping_deviation is not None:
        values, deviation = [*values, table.damping_ratio], [*deviation, table.damping_deviation]
    frequencies = TableFrequencies(
        measured=Measured(
            name=f"{table.title} frequencies",
            configuration=table.article,
            runs=table.names,
            axes=(MODE,) * len(table.names),
            channels=(FREQUENCY, DAMPING) if damped else (FREQUENCY,),
            judged=np.array([True, False][: len(values)]),
            frequency=np.array([table.frequency.mean()]),
            values=np.array(values, dtype=np.complex128).T[:, None],
            noise=np.array(deviation).T[:, None],
            inputs=np.ones((len(table.frequency), 1, 1), dtype=np.complex128),
            is_real=True,
        ),
        structure=structure,
        table=table,
    )
    if table.shapes is None or table.shapes_deviation is None:
        return (frequencies,)
    is_real = not np.iscomplexobj(table.shapes)
    largest = np.abs(table.shapes).max(axis=1, keepdims=True)  # a factor says nothing, and modes count alike
    moved = np.stack([structure.nominal.places[one.place] @ modes.shapes[:, list(every)] for one in table.sensors])
    along = seen(structure.nominal, table) @ modes.shapes[:, list(every)]
    square = np.maximum(np.sum(moved**2, axis=1) - along**2, 0.0).T * tolerances.angle**2
    whole = np.sum(along.T**2 + square, axis=1, keepdims=True)  # of a mode that no sensor sees nothing is known
    square *= np.sum(np.abs(table.shapes / largest) ** 2, axis=1, keepdims=True) / np.where(whole > 0, whole, 1.0)
    noise = np.hypot(table.shapes_deviation / largest, SOUND_SHAPE)
    noise = np.sqrt(noise**2 + np.where(square > noise**2, square, 0.0))
    shapes = TableShapes(
        measured=Measured(
            name=f"{table.title} shapes",
            configuration=table.article,
            runs=table.names,
            axes=(MODE,) * len(table.names),
            channels=tuple(point.name for point in table.sensors),
            judged=np.zeros(len(table.sensors), dtype=bool),  # the error in per cent is that of the frequencies
            frequency=np.array([table.frequency.mean()]),
            values=(table.shapes / largest).astype(np.complex128)[:, None],
            noise=noise[:, None],
            read=(table.shapes_deviation / largest)[:, None],
            is_real=is_real,
        ),
        structure=structure,
        table=table,
    )
    return frequencies, shapes


TAKEN_FOR_HERTZ = {"rad/s": 2 * np.pi, "cycles per minute": 60.0, "kHz": 1e-3}
"""What one hertz is in units that are taken for it."""

ONE_UNIT = 0.1
"""[log] Scatter of frequencies in those of a model, and of its mean, to be in a unit. Held by test_modal_table.py."""


def _require_hertz(table: ModalTable, f: Array) -> None:
    """Refuse frequencies that are those of the model, one after the other, but for the factor of another unit.

    Raises
    ------
    BadInput : rad/s, cycles per minute or kilohertz where hertz are asked for.
    """
    for unit, size in TAKEN_FOR_HERTZ.items() if len(table.frequency) > 2 else ():
        own = np.sort(f[np.isfinite(f) & (size * f > SLOWEST * table.frequency.min())])[: len(table.frequency)]
        if len(own) == len(table.frequency):
            off = np.log(np.sort(table.frequency) / own / size)
            if np.std(off) < ONE_UNIT and abs(np.mean(off)) < ONE_UNIT:
                problem = f"are {size * np.exp(np.mean(off)):.3g} times those of the model, all {len(own)} within "
                problem += f"{100 * np.ptp(off):.2g} % of each other: they look like {unit}"
                raise BadInput(table.source, "frequencies", problem, "Write them in hertz")


def _by_line(rows: ComplexArray, count: int) -> ComplexArray:
    """(r, n, c, 1) of (r, c), the same at every line."""
    return np.repeat(rows[:, None, :, None], count, axis=1)


def _change(rows: ComplexArray, count: int) -> Change:
    """A change of the rows (r, c) of all channels as one of those that do change."""
    channels = tuple(np.flatnonzero(rows.any(axis=0)).tolist())
    return Change(channels=channels, rows=_by_line(rows[:, list(channels)], count))
