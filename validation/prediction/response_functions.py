"""A response-function test: a structure shaken or struck at one point after the other, its answers per newton.

    reduced matrices of the structure       tolerances           effects of the structure
    -> accelerances, a run a drive point    dynamic_mass         points that are others than stated, window, leakage
    -> velocity or displacement             1 / (i omega), -1 / omega²
    -> signals of sensors and force         gains                delays, effects of the channels

The input of every run is the force, which is known: 1 N at each line of data that are divided by it. No base moves, so nothing
of a dynamic mass is here, and an effect on one has no meaning. A structure may be free, held, or stand on springs: all of its
coordinates move.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import ceil, inf, isfinite, sqrt

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import Point, Tolerances
from identification.response_functions import GAIN, ResponseFunctions
from identification.spectra import noise as noise_of_lines
from validation.effects.catalogue import There
from validation.effects.stages import ChannelResponse, Matrices
from validation.estimation.problem import IDENTIFIED, Change, Lines, Measured, Offsets, Parameter, Predicted, Wanted, is_wanted
from validation.model.model import Added
from validation.prediction import dynamic_mass, points
from validation.prediction import effects as prediction_effects
from validation.prediction.dynamic_mass import AttachedResponse, Finite, structure
from validation.prediction.effects import Nuisances
from validation.prediction.tangents import CondensedTransfer, Tangent, of_arrays, transfer_tangents, turning

FORCE_CHANNEL = "force"
FORCE = f"force-gain:{FORCE_CHANNEL}"
"""One force cell serves all runs."""

WINDOW, LEAKAGE, TRANSDUCER = "exponential-window", "leakage", "transducer-mass"
"""Faults of the method, each a parameter where an effect opens it."""

POWERS = {"acceleration": 0, "velocity": 1, "displacement": 2}
"""Of 1 / (i omega) by quantity."""

AXIS = 2.5
"""[1 / block] by which the axis is moved for a leakage: what lies a block beyond has e^-5 of its size. Held by test_points.py."""

RESOLVED = 4.0
"""[count] of lines from which the width of a peak at half power is resolved; as many as a Hann window is wide."""

HALF_LINES = 8
"""[count] of half lines to either side that a Hann window smears. Held by test_points.py."""

ENOUGH = 12
"""[count] of averages from which the coherence of a line tells its noise; below, its neighbours help. Held by test_points.py."""

SCALE = "scale"
"""Family of the parameter that stands for the one factor that readings without calibration share."""

LOCAL = "local-compliance"
"""Family of the parameters of what solids give right where a force acts on them, by drive."""

POINT = 5.0
"""[compliance that the jumps of strains tell] A force on one node of a solid gives way as its elements are small, without end; a
hammer's tip or a stud has an area. Held by test_response_functions.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class ResponseFunctionTest:
    """A model of one test: a `validation.estimation.problem.Prediction`.

    Attributes
    ----------
    measured : functions (r, n, c) [SI per N], one run a drive point, with inputs of 1
    structure : the matrices, all coordinates of which move, and what is uncertain of them
    responses : (c,) of the channels
    drives : (r,) of the runs
    effects : in the order in which they act
    quantity : of `identification.response_functions.QUANTITIES`
    gain, force_gain : tolerances of the gains, 0 for exact ones, infinite for unknown ones
    tolerances : of where the points are, and of how they are turned
    decay_rate : [1/s] of an exponential window of force and responses, or (n,) of each line
    smeared : share of what a Hann window smears over lines that is in the functions
    scale : where the one factor that all readings share is not known: where a fit of it begins; None where it is known
    coherence : (r, n, c) of the functions; None where it is not known
    """

    measured: Measured
    structure: Nuisances
    responses: tuple[Point, ...]
    drives: tuple[Point, ...]
    effects: tuple[Added, ...] = ()
    quantity: str = "acceleration"
    gain: float = GAIN
    force_gain: float = GAIN
    tolerances: Tolerances = points.EXACT
    decay_rate: float | Array = 0.0
    smeared: float = 0.0
    scale: float | None = None
    coherence: Array | None = None
    remarks: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move: of the structure, the gains, and the effects."""
        return self._opened[0]

    @property
    def there(self) -> There:
        """What effects can act on."""
        of = prediction_effects.there_of(self.measured.configuration, self.structure, (*self.measured.channels, FORCE_CHANNEL))
        return replace(of, drives=tuple(one.name for one in self.drives))

    def on(self, runs: Sequence[str]) -> "ResponseFunctionTest":
        """The same model of the runs named alone."""
        kept = [k for k, run in enumerate(self.measured.runs) if run in runs]
        coherence = None if self.coherence is None else self.coherence[kept]
        return replace(self, measured=self.measured.on(runs), drives=tuple(self.drives[k] for k in kept), coherence=coherence)

    def with_effects(self, effects: Sequence[Added]) -> "ResponseFunctionTest":
        """The same test by a model with these `effects` instead of its own.

        Those that reach nothing here do nothing, nor does a fault of a gain of which nothing is known: it is open already.
        """
        opened = [one for one in effects if one.named.id not in self._factors or isfinite(self._factors[one.named.id].tolerance)]
        return replace(self, effects=prediction_effects.reaching(opened, self.there))

    def by(self, structure: Nuisances) -> "ResponseFunctionTest":
        """The same data by another model of the structure."""
        return replace(self, structure=structure)

    def attached(self, offsets: Offsets, lines: Lines, rows: Array, inputs: ComplexArray) -> AttachedResponse:
        """What a mass at places would change, to first order.

        With D = M - (K + ...) / omega² a mass on phi changes phi_r^T D^-1 phi_d by -(phi D^-1 phi_r)(phi D^-1 phi_d): two
        solutions a line, one for the sensors and one for the drives, serve every place.

        Parameters
        ----------
        rows : (q, 3, k) what each coordinate of the structure moves the places along x, y, z
        """
        known = {**offsets, **self._opened[1]}
        f, q = self.measured.frequency[lines], len(rows)
        effects = tuple(replace(one, fixed=True) for one in prediction_effects.at(self.effects, known))
        _, answered, factor = self._answered(known, f, effects)
        own = rows.reshape(3 * q, -1)
        left, right = (np.tensordot(own, side[: own.shape[1]], axes=1) for side in (answered.left, answered.right))
        changed = answered.sign * factor[..., None] * np.einsum("qnc,qnr->ncrq", left, right, optimize=True)
        gains, delays = self._chain(known)
        A = factor * answered.matrix
        runs = ((A[:, :, run, None], {"": changed[:, :, run]}) for run in range(changed.shape[2]))
        whole = np.stack([self._read(f, *one, gains, delays, effects, False)[1][""] for one in runs])
        spring = np.broadcast_to(-1 / answered.omega**2, whole.shape[:2])
        return AttachedResponse(readings=whole.reshape(*whole.shape[:3], q, 3), spring=np.asarray(spring, dtype=np.complex128))

    def finite(self, offsets: Offsets, lines: Lines) -> Finite:
        """What is read with a mass or a spring of any size at a place (Sherman and Morrison, Annals of Mathematical Statistics 21
        (1950), 124)."""
        known = {**offsets, **self._opened[1]}
        f = self.measured.frequency[lines]
        effects = tuple(replace(one, fixed=True) for one in prediction_effects.at(self.effects, known))
        matrices, answered, factor = self._answered(known, f, effects)
        gives = dynamic_mass.answering(matrices, answered.omega)
        gains, delays = self._chain(known)

        def at(row: Array) -> Callable[[Array, Array], ComplexArray]:
            own = row @ gives(row)[:, : row.shape[1]]
            left, right = (
                np.tensordot(row, side[: row.shape[1]], 1).transpose(1, 0, 2) for side in (answered.left, answered.right)
            )

            def read(mass: Array, spring: Array) -> ComplexArray:
                axes = np.flatnonzero((mass != 0) | (spring != 0))
                added = mass[axes] - spring[axes] / answered.omega[:, None] ** 2
                there = own[:, axes[:, None], axes] + np.eye(len(axes)) / added[:, None, :]
                A = answered.matrix - left[:, axes].transpose(0, 2, 1) @ np.linalg.solve(there, right[:, axes])
                runs = (factor * A[:, :, run, None] for run in range(A.shape[2]))
                return np.stack([self._read(f, one, {}, gains, delays, effects, False)[0] for one in runs])

            return read

        return at

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        """As of any prediction."""
        known = {**offsets, **self._opened[1]}
        f = self.measured.frequency if lines is None else self.measured.frequency[lines]
        effects = prediction_effects.at(self.effects, known)
        if not derivatives:
            effects = tuple(replace(one, fixed=True) for one in effects)
        A, dA = self._accelerances(known, f, effects, derivatives=derivatives)
        gains, delays = self._chain(known)
        made = [
            self._read(f, A[run], {k: d[run] for k, d in dA.items()}, gains, delays, effects, derivatives)
            for run in range(len(A))
        ]
        changes = {name: np.stack([tangents[name] for _, tangents in made]) for name in made[0][1]}
        every = tuple(range(len(self.measured.channels)))
        found = {name: Change(channels=every, rows=rows) for name, rows in changes.items() if name not in self._opened[1]}
        return Predicted(rows=np.stack([rows for rows, _ in made]), changes=found)

    def _accelerances(
        self, offsets: Offsets, f: Array, effects: Sequence[Added], *, derivatives: Wanted
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """(r, n, c, 1) of the quantity that is read per newton, and its derivatives by the parameters that are wanted."""
        matrices, tangents = structure(self.structure, offsets, effects, derivatives=derivatives)
        decay, smeared = self.decay_rate + offsets.get(WINDOW, 0.0), self.smeared + offsets.get(LEAKAGE, 0.0)
        plain, changes = self._on_axis(matrices, tangents, offsets, f, decay, derivatives=derivatives)
        if LEAKAGE not in self._asked and not (self.smeared and self._is_coarse):
            return plain, changes
        # The transform of h(t) r(t), r what a Hann window correlates with itself: A over the transform of r, on an axis
        # s + sigma on which A is smooth over the distance of lines however light its damping
        passed = derivatives if smeared else False
        whole, moved = np.zeros_like(plain), {name: np.zeros_like(plain) for name in changes}
        for away, weight in self._kernel:
            shifted = f + away
            answer, own = self._on_axis(matrices, tangents, offsets, np.abs(shifted), decay + self._shift, derivatives=passed)
            turned = (shifted < 0)[:, None, None]
            whole += weight * np.where(turned, answer.conj(), answer)
            for name, change in own.items():
                moved[name] += weight * np.where(turned, change.conj(), change)
        found = {name: (1 - smeared) * change + smeared * moved[name] for name, change in changes.items()}
        if is_wanted(LEAKAGE, derivatives):
            found[LEAKAGE] = whole - plain
        return (1 - smeared) * plain + smeared * whole, found

    def _chain(self, known: Offsets) -> tuple[Array, Array]:
        """Gains [1] and delays [s] of all channels, and of the force behind them."""
        gains = np.array([self._factors[name].value(known.get(name, 0.0)) for name in self._gains])
        return gains, np.array([known.get(name, 0.0) for name in self._delays])

    def _answered(self, offsets: Offsets, f: Array, effects: Sequence[Added]) -> tuple[Matrices, CondensedTransfer, ComplexArray]:
        """The matrices, accelerances before any leakage and any pick-up's mass, and the factor (n, 1, 1) to what is read."""
        matrices, _ = structure(self.structure, offsets, effects, derivatives=False)
        rows, forces = (one.values for one in self._rows(matrices, offsets))
        decay = self.decay_rate + offsets.get(WINDOW, 0.0)
        answered = dynamic_mass.accelerance(matrices, f, rows, forces, decay_rate=decay)
        answered = replace(answered, matrix=answered.matrix + self._softer(answered.omega, offsets))
        return matrices, answered, (1j * answered.omega[:, None, None]) ** -POWERS[self.quantity]

    def _rows(self, matrices: Matrices, offsets: Offsets) -> tuple[points.PointRows, points.PointRows]:
        """Of the responses and of the drives, with what is wrong with them."""
        here, there = self._moved
        of_responses = points.rows(matrices, self.responses, (), here, offsets)
        return of_responses, points.rows(matrices, self.drives, self.responses, there, offsets)

    @cached_property
    def _moved(self) -> tuple[list[str], list[str]]:
        """Names of what may move the rows of the responses, and of the drives: tolerances, and what effects ask for."""
        here = points.uncertain(self.responses, points.RESPONSES, self.effects, self.tolerances)
        there = points.uncertain(self.drives, points.DRIVES, self.effects, self.tolerances)
        return here, there

    def _on_axis(
        self,
        matrices: Matrices,
        tangents: Mapping[str, Tangent],
        offsets: Offsets,
        f: Array,
        decay: float | Array,
        *,
        derivatives: Wanted,
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """As `_accelerances`, on the axis s = i omega + decay, before any leakage."""
        of_responses, of_drives = self._rows(matrices, offsets)
        c, r = len(self.responses), len(self.drives)
        carried = offsets.get(TRANSDUCER, 0.0)
        roves = TRANSDUCER in self._asked and (is_wanted(TRANSDUCER, derivatives) or carried != 0)
        ways = [points.along(matrices, one.place, axis) for one in self.responses if roves for axis in np.eye(3)]
        rows, forces = (np.vstack([one, *ways]) if ways else one for one in (of_responses.values, of_drives.values))
        condensed = dynamic_mass.Condensed.of(matrices, turning(f, decay), np.vstack([rows, forces]).T)
        if condensed is not None:
            matrices = condensed.matrices
            rows, forces = condensed.of_rows(rows), condensed.of_rows(forces)
        answered = dynamic_mass.accelerance(matrices, f, rows, forces, decay_rate=decay)
        whole = answered.matrix
        if not carried:  # what pick-ups that weigh nothing move along is asked of the structure as it stands alone
            left, right = (np.ascontiguousarray(side[:, :, :n]) for side, n in ((answered.left, c), (answered.right, r)))
            answered = replace(answered, matrix=whole[:, :c, :r], left=left, right=right)
        T = answered.matrix
        of_tangents = transfer_tangents if condensed is None else condensed.tangents
        dT = of_tangents(answered, tangents) if derivatives else {}
        left, right = answered.left.transpose(1, 2, 0), answered.right.transpose(1, 2, 0)  # (n, c, k), (n, r, k)
        for of, side, place in ((of_responses, right, 1), (of_drives, left, 2)):
            for name in _wanted(of.changes, derivatives):
                at, row = of.changes[name]
                dT[name] = np.zeros_like(T)
                dT[name].swapaxes(1, place)[:, at] = side @ (row if condensed is None else condensed.of_rows(row))
        omega, power = answered.omega[:, None, None], POWERS[self.quantity]
        softer = self._softer(answered.omega, offsets)
        T[:, :c, :r] += softer
        gives = {f"{LOCAL}:{drive.name}": k for k, drive in enumerate(self.drives) if np.any(self._local)}
        for name in _wanted(gives, derivatives):
            dT[name] = np.zeros_like(T)
            dT[name][:, :c, gives[name]] = -(omega[:, 0] ** 2) * self._local[:, gives[name]]
        if WINDOW in self._asked and is_wanted(WINDOW, derivatives):
            # d D / d decay = -i (2 (K + i S) / omega³ + i C / omega²)
            held = of_arrays(len(matrices.mass), stiffness=matrices.stiffness, structural=matrices.structural)
            lost = of_arrays(len(matrices.mass), viscous=matrices.viscous)
            moved = transfer_tangents(answered, {"held": held, "lost": lost})
            dT[WINDOW] = 1j / omega * (2 * moved["held"] + moved["lost"]) - power / (1j * omega) * T
            dT[WINDOW][:, :c, :r] += 2 / (1j * omega) * softer
        A, dA = _roved(whole, dT, carried, c, r) if roves else (T, dT)
        if not derivatives:
            dA = {}
        factor = (1j * omega) ** -power
        return _by_run(factor * A), {name: _by_run(factor * change) for name, change in dA.items()}

    def _read(
        self,
        f: Array,
        A: ComplexArray,
        dA: Mapping[str, ComplexArray],
        gains: Array,
        delays: Array,
        effects: Sequence[Added],
        derivatives: Wanted,
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """What the channels of one run read (n, c, 1) per what the force reads, and its derivatives: gains, delays, effects."""
        c = len(self.measured.channels)
        common, omega = gains[c + 1] if self.scale is not None else 1.0, 2 * np.pi * f[:, None, None]
        factor = (gains[: c + 1] * np.where(np.arange(c + 1) < c, common, 1.0))[:, None] * np.exp(-1j * omega * delays[:, None])
        A, ones = np.asarray(A), np.ones((len(f), 1, 1), dtype=np.complex128)
        signals = np.concatenate([A, ones], axis=1)
        tangents = {name: factor * np.concatenate([change, 0 * change[:, :1]], axis=1) for name, change in dA.items()}
        if derivatives:
            slopes = [1.0 if self._factors[name].logarithmic else 1 / gain for name, gain in zip(self._gains, gains, strict=True)]
            for k, name in enumerate(self._gains[: c + 1]):
                if is_wanted(name, derivatives):
                    tangents[name] = np.zeros_like(signals)
                    tangents[name][:, k] = slopes[k] * factor[:, k] * signals[:, k]
            if self.scale is not None and is_wanted(self._gains[c + 1], derivatives):
                tangents[self._gains[c + 1]] = np.concatenate([factor[:, :c] * A, 0 * ones], axis=1)
            for k, name in enumerate(self._delays):
                if name in self._asked and is_wanted(name, derivatives):
                    tangents[name] = np.zeros_like(signals)
                    tangents[name][:, k] = -1j * omega[:, 0] * factor[:, k] * signals[:, k]
        channels = (*self.measured.channels, FORCE_CHANNEL)
        reading = ChannelResponse(frequency=f, channels=channels, rows=factor * signals, amplitude=np.zeros((len(f), c + 1)))
        reading, tangents = prediction_effects.channels(reading, tangents, effects)
        above, below = reading.rows[:, :c], reading.rows[:, c:]
        read = above / below
        return read, {name: (change[:, :c] - read * change[:, c:]) / below for name, change in tangents.items()}

    @cached_property
    def _gains(self) -> tuple[str, ...]:
        """Names of the gains: of the channels in their order, then of the force, then of all functions where it is open."""
        common = () if self.scale is None else (f"{SCALE}:{self.measured.name}",)
        return (*(f"accelerometer-gain:{channel}" for channel in self.measured.channels), FORCE, *common)

    @cached_property
    def _delays(self) -> tuple[str, ...]:
        """Names of the delays, of the channels in their order and of the force."""
        return (*(f"accelerometer-delay:{channel}" for channel in self.measured.channels), f"force-delay:{FORCE_CHANNEL}")

    @cached_property
    def _asked(self) -> tuple[str, ...]:
        """Ids of the effects that want a parameter which the test has not by itself."""
        families = (*points.RESPONSES, *points.DRIVES, "accelerometer-delay", "force-delay", WINDOW, LEAKAGE, TRANSDUCER)
        found = points.asked(self.effects, families)
        return tuple(one for one in found if one != LEAKAGE or (self._is_coarse and not self.smeared))

    @cached_property
    def _is_coarse(self) -> bool:
        """Whether the lines lie too far apart for some mode of the model: nothing else can leak."""
        m, lines = self.structure.nominal, self.measured.frequency
        f = self.structure.frequency[(self.structure.frequency >= lines[0]) & (self.structure.frequency <= lines[-1])]
        at = m.base + np.flatnonzero(np.isin(self.structure.frequency, f))
        width = (np.diag(m.viscous)[at] + np.diag(m.structural)[at] / (2 * np.pi * f)) / (2 * np.pi)  # [Hz] at half power
        return bool(len(lines) > 1 and np.any(width < RESOLVED * float(np.median(np.diff(lines)))))

    @cached_property
    def _shift(self) -> float:
        """[1/s] by which the axis is moved for a leakage."""
        return AXIS * float(np.median(np.diff(self.measured.frequency))) if len(self.measured.frequency) > 1 else 0.0

    @cached_property
    def _kernel(self) -> list[tuple[float, complex]]:
        """Distances [Hz] of the lines that a Hann window of the resolution smears over each other, and their weights."""
        T = AXIS / self._shift if self._shift else 0.0
        if not T:
            return []
        u = np.linspace(-1.0, 1.0, 4001)
        r = (1 - np.abs(u)) * (2 + np.cos(2 * np.pi * u)) / 3 + np.sin(2 * np.pi * np.abs(u)) / (2 * np.pi)
        steps = np.arange(-HALF_LINES, HALF_LINES + 1)
        turning = np.exp(AXIS * u + 1j * np.pi * steps[:, None] * u)
        weights = np.sum(r * turning, axis=1) * (u[1] - u[0]) / 2
        return [(k / (2 * T), complex(w)) for k, w in zip(steps.tolist(), weights, strict=True)]

    @cached_property
    def _factors(self) -> dict[str, Parameter]:
        """What every gain is as a factor, by its name: 1 + g, or, where nothing is known of it, positive and without bound."""
        found = {}
        for name in self._gains:
            tolerance = self.force_gain if name == FORCE else self.gain
            if name.startswith(f"{SCALE}:"):
                scale = self.scale or 1.0
                made = Parameter(name=name, unit="1", tolerance=inf, kind=IDENTIFIED, nominal=scale, logarithmic=True)
            elif isfinite(tolerance):
                made = Parameter(name=name, unit="1", tolerance=tolerance, nominal=1.0)
            else:
                made = Parameter(name=name, unit="1", tolerance=inf, kind=IDENTIFIED, nominal=1.0, logarithmic=True)
            found[name] = made
        return found

    @cached_property
    def _local(self) -> Array:
        """(c, r) [m/N] by how much more a response would give to a force that acts on a point of an endless mesh, as far as the
        jumps of strains around the two tell, and beyond what modes do."""
        m = self.structure.nominal
        own = np.arange(len(m.mass)) >= m.base + len(self.structure.frequency)
        answers = np.linalg.pinv(np.where(np.outer(own, own), m.stiffness, 0.0), hermitian=True)
        left, right = (points.stated(m, some) @ answers for some in (self.responses, self.drives))
        return np.asarray(left @ sum(m.unresolved.values(), np.zeros_like(m.mass)) @ right.T)

    def _softer(self, omega: ComplexArray, offsets: Offsets) -> ComplexArray:
        """(n, c, r) accelerances by what solids give beside the drives at `offsets`."""
        sizes = np.array([offsets.get(f"{LOCAL}:{one.name}", 0.0) for one in self.drives])
        return np.asarray(-(omega[:, None, None] ** 2) * self._local * sizes)

    @cached_property
    def _opened(self) -> tuple[tuple[Parameter, ...], Offsets]:
        """The parameters, and the offsets of those that stand at a given size."""
        # The offset of a gain that is known to a tolerance is what it is beyond 1, as the effect of its name has it
        gains = [replace(one, nominal=one.nominal - (not one.logarithmic)) for one in self._factors.values() if one.tolerance > 0]
        here, there = self._moved
        moved = points.possible(self.structure, self.responses, (), here, self.tolerances)
        moved += points.possible(self.structure, self.drives, self.responses, there, self.tolerances)
        moved += [
            Parameter(name=f"{LOCAL}:{one.name}", unit="1", tolerance=POINT)
            for one, compliance in zip(self.drives, self._local.T, strict=True)
            if np.any(compliance)
        ]
        late = [Parameter(name=name, unit="s", tolerance=1.0) for name in self._delays if name in self._asked]
        method = [
            Parameter(name=name, unit=unit, tolerance=1.0)
            for name, unit in ((WINDOW, "1/s"), (LEAKAGE, "1"), (TRANSDUCER, "kg"))
            if name in self._asked and (name != TRANSDUCER or self.structure.scaled)
        ]
        left, given = prediction_effects.opened([*self.structure.parameters, *gains, *moved, *late, *method], self.effects)
        return (*left, *prediction_effects.parameters(self.effects, self.structure)), given


def _wanted(names: Iterable[str], derivatives: Wanted) -> list[str]:
    """Those of the parameters called `names` by which derivatives are wanted."""
    return [name for name in names if is_wanted(name, derivatives)]


def _roved(
    T: ComplexArray, dT: Mapping[str, ComplexArray], m: float, c: int, r: int
) -> tuple[ComplexArray, dict[str, ComplexArray]]:
    """The functions (n, c, r) of a structure with `m` [kg] more at each response in turn, and their derivatives.

    `T` (n, c + 3 c, r + 3 c), and `dT` where there is an `m`, have the three axes of every response behind the responses and
    behind the drives:
    A' = A - m a Z, Z = (1 + m X)^-1 Y, a the response to forces at its own point, X that point's answers to them, Y to drives.
    """
    A = np.array(T[:, :c, :r])
    found = {name: np.array(change[:, :c, :r]) for name, change in dT.items()}
    found[TRANSDUCER] = np.zeros_like(A)
    for k in range(c):
        here, there = slice(c + 3 * k, c + 3 * k + 3), slice(r + 3 * k, r + 3 * k + 3)
        a, X, Y = T[:, k : k + 1, there], T[:, here, there], T[:, here, :r]
        inverse = np.linalg.inv(np.eye(3) + m * X)
        Z = inverse @ Y
        A[:, k] -= m * (a @ Z)[:, 0]
        found[TRANSDUCER][:, k] = -(a @ Z)[:, 0] + m * (a @ (inverse @ (X @ Z)))[:, 0]
        for name, change in dT.items() if m else ():
            da, dX, dY = change[:, k : k + 1, there], change[:, here, there], change[:, here, :r]
            found[name][:, k] -= m * (da @ Z + a @ (inverse @ (dY - m * dX @ Z)))[:, 0]
    return A, found


def of(structure: Nuisances, data: ResponseFunctions, tolerances: Tolerances = points.EXACT) -> tuple[ResponseFunctionTest, ...]:
    """The prediction of `data` by a model of what was tested, whose points are known within `tolerances`.

    Where the scale of the functions is not known, a fit of it begins at the one that brings the levels together; its sign is that
    of a structure that takes power where it is driven and read, Im A > 0, where there is such a pair.

    Raises
    ------
    BadInput : a place that the structure has not, a band without lines, force over response.
    """
    points.require_places((*data.drives, *data.responses), structure.nominal.places, structure.configuration, data.source)
    from scipy.ndimage import uniform_filter1d
    from scipy.special import digamma, polygamma

    low, high = data.band
    kept = data.frequency > 0
    if not np.any(kept & (data.frequency >= low) & (data.frequency <= high)):
        raise BadInput(data.source, "band", f"no line lies within {low:g} to {high:g} Hz", "Correct it")
    f, values, noise, scatter = data.frequency[kept], data.values[:, kept], None, 0.0
    if data.coherence is not None and data.averages > 1:
        # |H| sqrt((1 - g²) / (g² averages)), both parts together: J. S. Bendat and A. G. Piersol, Random Data, 2010, section 9.2
        g = np.clip(np.asarray(data.coherence)[:, kept], 1e-6, 1.0)
        noise = np.asarray(np.abs(values) * np.sqrt((1 - g) / (g * data.averages)))
        if np.all(noise > 0):
            # Of few averages a variance is too low, and at single lines far too low: the mean of its logarithm, without its bias
            around, low_by = ceil(ENOUGH / data.averages) - 1, digamma(data.averages - 1) - np.log(data.averages)
            lines = uniform_filter1d(2 * np.log(noise), 2 * around + 1, axis=1, mode="nearest")
            noise = np.exp((lines - low_by) / 2)
            scatter = sqrt(polygamma(1, data.averages - 1) / (2 * around + 1) / 2)  # by which its inverse is on average too large
    functions = measured(
        data.title,
        data.article,
        f,
        {drive.name: one for drive, one in zip(data.drives, values, strict=True)},
        [one.name for one in data.responses],
        band=data.band,
        share=data.share or 0.0,
        noise=noise,
    )
    functions = replace(functions, noise_scatter=scatter)
    at = [next((c for c, point in enumerate(data.responses) if _same(drive, point)), -1) for drive in data.drives]
    both = [k for k, c in enumerate(at) if c >= 0]
    if data.share is None and len(both) > 1:
        # As far as readings of one number differ beside their noise, which without coherence holds in the middle alone
        alike, own = (one[both][:, :, [at[k] for k in both]] for one in (functions.values, functions.noise))
        middle = np.median(own / np.maximum(np.abs(alike), np.finfo(np.float64).tiny)) * np.abs(alike)
        share = noise_of_lines.repeatability(alike, middle if noise is None else own)
        functions = replace(functions, noise=np.hypot(functions.noise, share * np.abs(functions.values)))
    test = ResponseFunctionTest(
        measured=functions,
        structure=structure,
        responses=data.responses,
        drives=data.drives,
        quantity=data.quantity,
        gain=data.gain,
        force_gain=data.force_gain,
        tolerances=tolerances,
        decay_rate=data.decay_rate,
        smeared=data.smeared,
        remarks=(*data.warnings, prediction_effects.ASSUMED) if structure.assumed else data.warnings,
        coherence=None
        if data.coherence is None
        else data.coherence[:, (data.frequency >= low) & (data.frequency <= high) & kept],
    )
    sizes = (np.abs(test.measured.values), np.abs(test.at({}, derivatives=False).rows[..., 0]))
    y, p = (np.log(np.maximum(one, np.finfo(np.float64).tiny)) for one in sizes)
    a, b = (one - one.mean(axis=1, keepdims=True) for one in (y, p))
    if np.sum(a * b) < UPSIDE_DOWN * np.sqrt(np.sum(a * a) * np.sum(b * b)) and np.abs(p + y).mean() < np.abs(p - y).mean():
        problem = "its functions are force over response: small at resonances, and large where little should be read"
        raise BadInput(data.source, "inverted", problem, "Write inverted = true in the test")
    if data.scaled:
        return (test,)
    # The level of the model brought to that of the data, with the sign of power that goes in
    found, read = test.at({}, derivatives=False).rows[..., 0], test.measured.values
    factor = float(np.median(np.abs(read)) / np.median(np.abs(found)))
    pairs = [(r, c) for r, drive in enumerate(test.drives) for c, at in enumerate(test.responses) if _same(drive, at)]
    turned = {"acceleration": 1.0, "velocity": 1j, "displacement": -1.0}[test.quantity]
    power = sum(float(np.sum((turned * read[r, :, c]).imag)) for r, c in pairs)
    return (replace(test, scale=-factor if power < 0 else factor),)


UPSIDE_DOWN = -0.5
"""[1] Correlation of the logarithms of what is read and predicted, about their means over the lines, below which one is the
inverse of the other. Held by test_odd_studies.py."""


def _same(one: Point, other: Point) -> bool:
    return one.place == other.place and float(np.dot(np.asarray(one.direction), np.asarray(other.direction))) > 0.99


SCATTERS = 0.8
"""[lines] A noise that few lines tell scatters, and chi² with its inverse: too large by this over their number, as a share. Held
by test_response_functions.py."""


def measured(
    name: str,
    configuration: str,
    frequency: npt.ArrayLike,
    functions: Mapping[str, npt.ArrayLike],
    channels: Sequence[str],
    *,
    band: tuple[float, float] | None = None,
    share: float = 0.0,
    noise: Array | None = None,
) -> Measured:
    """The data set of a test; noise that is not known is that of the scatter of the lines (`identification.spectra.noise`).

    Parameters
    ----------
    frequency : (n,) [Hz], evenly spaced
    functions : by run (n, c) complex: what `channels` read divided by the force, SI
    band : (low, high) [Hz] of the lines that are kept; noise is estimated from all
    share : standard deviation of a reading as a share of it, beside the noise: how far the test repeats
    noise : (r, n, c) standard deviation of the complex noise at all lines
    """
    f = np.asarray(frequency, dtype=np.float64)
    values = np.stack([np.asarray(one, dtype=np.complex128) for one in functions.values()])
    low, high = band or (f[0], f[-1])
    kept = (f >= low) & (f <= high)
    if noise is None:
        step = float(np.median(np.diff(f)))
        around = max(noise_of_lines.NEIGHBOURHOOD, step * noise_of_lines.FEWEST_NEIGHBOURS / 2)
        noise = noise_of_lines.between_neighbours(f, values, around) * np.sqrt(1 + SCATTERS * step / (2 * around))
    return Measured(
        name=name,
        configuration=configuration,
        runs=tuple(functions),
        channels=tuple(channels),
        judged=np.ones(len(channels), dtype=bool),
        frequency=f[kept],
        values=values[:, kept],
        noise=np.hypot(noise, share * np.abs(values))[:, kept],
        inputs=np.ones((len(values), int(kept.sum()), 1), dtype=np.complex128),
    )


def _by_run(matrix: ComplexArray) -> ComplexArray:
    """(n, c, r) as (r, n, c, 1)."""
    return np.asarray(matrix.transpose(2, 0, 1)[..., None])
