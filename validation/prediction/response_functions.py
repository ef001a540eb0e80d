"""A response-function test: a structure shaken or struck at one point after the other, its answers per newton.

    reduced matrices of the structure       tolerances           effects of the structure
    -> accelerances, a run a drive point    dynamic_mass         effects of the channels
    -> velocity or displacement             1 / (i omega), -1 / omega²
    -> gains of sensors and force           gains

The input of every run is the force, which is known: 1 N at each line of data that are divided by it. No base moves, so nothing
of a dynamic mass is here, and an effect on one has no meaning. A structure may be free, held, or stand on springs: all of its
coordinates move.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from math import inf, isfinite

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import Point
from identification.response_functions import GAIN, ResponseFunctions
from validation.effects.catalogue import There
from validation.effects.stages import ChannelResponse
from validation.estimation.problem import IDENTIFIED, Change, Lines, Measured, Offsets, Parameter, Predicted, Wanted
from validation.model.model import Added
from validation.prediction import dynamic_mass, series
from validation.prediction import effects as prediction_effects
from validation.prediction.dynamic_mass import AttachedResponse, Finite, structure
from validation.prediction.effects import Nuisances, Tangent

FORCE = "force-gain:force"
"""One force cell serves all runs."""

SCALE = "scale"
"""Family of the parameter that stands for the one factor that readings without calibration share."""


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
    decay_rate : [1/s] of an exponential window of force and responses, or (n,) of each line
    scale : where the one factor that all readings share is not known: where a fit of it begins; None where it is known
    """

    measured: Measured
    structure: Nuisances
    responses: tuple[Point, ...]
    drives: tuple[Point, ...]
    effects: tuple[Added, ...] = ()
    quantity: str = "acceleration"
    gain: float = GAIN
    force_gain: float = GAIN
    decay_rate: float | Array = 0.0
    scale: float | None = None
    remarks: tuple[str, ...] = ()

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move: of the structure, the gains, and the effects."""
        return self._opened[0]

    @property
    def there(self) -> There:
        """What effects can act on."""
        return prediction_effects.there_of(
            self.measured.configuration, self.structure, (*self.measured.channels, FORCE.partition(":")[2])
        )

    def on(self, runs: Sequence[str]) -> "ResponseFunctionTest":
        """The same model of the runs named alone."""
        kept = tuple(point for run, point in zip(self.measured.runs, self.drives, strict=True) if run in runs)
        return replace(self, measured=self.measured.on(runs), drives=kept)

    def with_effects(self, effects: Sequence[Added]) -> "ResponseFunctionTest":
        """The same test by a model with these `effects` instead of its own.

        Those that reach nothing here do nothing, nor does a fault of a gain of which nothing is known: it is open already.
        """
        opened = [one for one in effects if one.named.id not in self._factors or isfinite(self._factors[one.named.id].tolerance)]
        return replace(self, effects=prediction_effects.reaching(opened, self.there))

    def by(self, structure: Nuisances) -> "ResponseFunctionTest":
        """The same data by another model of the structure."""
        return replace(self, structure=structure)

    def attached(self, offsets: Offsets, lines: Lines, rows: Array) -> AttachedResponse:
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
        answered, factor, _ = self._answered(known, f, effects, derivatives=False)
        own = rows.reshape(3 * q, -1)
        left, right = (np.tensordot(own, side[: own.shape[1]], axes=1) for side in (answered.left, answered.right))
        changed = answered.sign * factor[..., None] * np.einsum("qnc,qnr->ncrq", left, right, optimize=True)
        gains = np.array([self._factors[name].value(known.get(name, 0.0)) for name in self._gains])
        read = [
            self._read(f, factor * answered.matrix[:, :, run, None], {"": changed[:, :, run]}, gains, effects, False)[1][""]
            for run in range(changed.shape[2])
        ]
        whole = np.stack(read)
        spring = np.broadcast_to(-1 / answered.omega**2, whole.shape[:2])
        return AttachedResponse(readings=whole.reshape(*whole.shape[:3], q, 3), spring=np.asarray(spring, dtype=np.complex128))

    def finite(self, offsets: Offsets, lines: Lines) -> Finite:
        """What is read with a mass or a spring of any size at a place, of which D^-1 serves all (Sherman and Morrison, Annals of
        Mathematical Statistics 21 (1950), 124)."""
        known = {**offsets, **self._opened[1]}
        f = self.measured.frequency[lines]
        effects = tuple(replace(one, fixed=True) for one in prediction_effects.at(self.effects, known))
        matrices, _ = structure(self.structure, known, effects, derivatives=False)
        answered, factor, _ = self._answered(known, f, effects, derivatives=False)
        whole = np.linalg.inv(dynamic_mass.dynamic_matrix(matrices, dynamic_mass.turning(f, self.decay_rate)))
        gains = np.array([self._factors[name].value(known.get(name, 0.0)) for name in self._gains])

        def read(row: Array, mass: Array, spring: Array) -> ComplexArray:
            axes = np.flatnonzero((mass != 0) | (spring != 0))
            added = mass[axes] - spring[axes] / answered.omega[:, None] ** 2
            own = row[axes]
            left, right = (
                np.tensordot(own, side[: own.shape[1]], axes=1).transpose(1, 0, 2) for side in (answered.left, answered.right)
            )
            there = own @ whole[:, : own.shape[1], : own.shape[1]] @ own.T + np.eye(len(axes)) / added[:, None, :]
            A = answered.matrix - left.transpose(0, 2, 1) @ np.linalg.solve(there, right)
            made = [self._read(f, factor * A[:, :, run, None], {}, gains, effects, False)[0] for run in range(A.shape[2])]
            return np.stack(made)

        return read

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        """The prediction at `offsets` and the lines with these indices; all lines by default.

        Raises
        ------
        numpy.linalg.LinAlgError, ValueError, FloatingPointError : the model breaks down there.
        """
        known = {**offsets, **self._opened[1]}
        f = self.measured.frequency if lines is None else self.measured.frequency[lines]
        effects = prediction_effects.at(self.effects, known)
        if not derivatives:
            effects = tuple(replace(one, fixed=True) for one in effects)
        moving = bool(derivatives)
        A, dA = self._accelerances(known, f, effects, derivatives=moving)
        gains = np.array([self._factors[name].value(known.get(name, 0.0)) for name in self._gains])
        made = [self._read(f, A[run], {k: d[run] for k, d in dA.items()}, gains, effects, moving) for run in range(len(A))]
        changes = {name: np.stack([tangents[name] for _, tangents in made]) for name in made[0][1]}
        every = tuple(range(len(self.measured.channels)))
        found = {name: Change(channels=every, rows=rows) for name, rows in changes.items() if name not in self._opened[1]}
        return Predicted(rows=np.stack([rows for rows, _ in made]), changes=found)

    def _accelerances(
        self, offsets: Offsets, f: Array, effects: Sequence[Added], *, derivatives: bool
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """(r, n, c, 1) of the quantity that is read per newton, and its derivatives by parameter."""
        answered, factor, tangents = self._answered(offsets, f, effects, derivatives=derivatives)
        moved = dynamic_mass.transfer_tangents(answered, tangents)
        return _by_run(factor * answered.matrix), {name: _by_run(factor * change) for name, change in moved.items()}

    def _answered(
        self, offsets: Offsets, f: Array, effects: Sequence[Added], *, derivatives: bool
    ) -> tuple[dynamic_mass.CondensedTransfer, ComplexArray, Mapping[str, Tangent]]:
        """Accelerances, the factor (n, 1, 1) to the quantity that is read, and how the matrices change."""
        matrices, tangents = structure(self.structure, offsets, effects, derivatives=derivatives)
        rows, forces = (
            np.array([dynamic_mass.along(matrices, point.place, point.direction) for point in points])
            for points in (self.responses, self.drives)
        )
        answered = dynamic_mass.accelerance(matrices, f, rows, forces, decay_rate=self.decay_rate)
        omega = 1j * answered.omega[:, None, None]
        factor = {"acceleration": np.ones_like(omega), "velocity": 1 / omega, "displacement": omega**-2}[self.quantity]
        return answered, factor, tangents

    def _read(
        self, f: Array, A: ComplexArray, dA: Mapping[str, ComplexArray], gains: Array, effects: Sequence[Added], derivatives: bool
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """What the channels of one run read (n, c, 1), and its derivatives: gains, then effects of the channels."""
        c = len(self.measured.channels)
        common = gains[c + 1] if self.scale is not None else 1.0
        factor = common * (gains[:c] / gains[c])[:, None]
        tangents = {name: factor * change for name, change in dA.items()}
        if derivatives:
            # Of scale * gain_c / gain_force * A by each gain, or by its logarithm
            slopes = [1.0 if self._factors[name].logarithmic else 1 / gain for name, gain in zip(self._gains, gains, strict=True)]
            for k, name in enumerate(self._gains[:c]):
                tangents[name] = np.zeros_like(A)
                tangents[name][:, k] = slopes[k] * factor[k] * A[:, k]
            tangents[FORCE] = -slopes[c] * factor * A
            if self.scale is not None:
                tangents[self._gains[c + 1]] = factor * A
        none = np.zeros((len(f), c))
        reading = ChannelResponse(frequency=f, channels=self.measured.channels, rows=factor * A, amplitude=none)
        reading, tangents = prediction_effects.channels(reading, tangents, effects)
        return reading.rows, tangents

    @cached_property
    def _gains(self) -> tuple[str, ...]:
        """Names of the gains: of the channels in their order, then of the force, then of all functions where it is open."""
        common = () if self.scale is None else (f"{SCALE}:{self.measured.name}",)
        return (*(f"accelerometer-gain:{channel}" for channel in self.measured.channels), FORCE, *common)

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
    def _opened(self) -> tuple[tuple[Parameter, ...], Offsets]:
        """The parameters, and the offsets of those that stand at a given size."""
        # The offset of a gain that is known to a tolerance is what it is beyond 1, as the effect of its name has it
        gains = [replace(one, nominal=one.nominal - (not one.logarithmic)) for one in self._factors.values() if one.tolerance > 0]
        left, given = prediction_effects.opened([*self.structure.parameters, *gains], self.effects)
        return (*left, *prediction_effects.parameters(self.effects, self.structure)), given


def of(structure: Nuisances, data: ResponseFunctions) -> tuple[ResponseFunctionTest, ...]:
    """The prediction of `data` by a model of what was tested.

    Where the scale of the functions is not known, a fit of it begins at the one that brings the levels together; its sign is that
    of a structure that takes power where it is driven and read, Im A > 0, where there is such a pair.

    Raises
    ------
    BadInput : a place that the structure has not, a band without lines.
    """
    for point in (*data.drives, *data.responses):
        if point.place not in structure.nominal.places:
            known = ", ".join(list(structure.nominal.places)[:20]) or "none"
            problem = f"{structure.configuration} has no such place"
            raise BadInput(
                source=data.source, field=point.place, problem=problem, remedy=f"Its places are {known}; name it there"
            )
    low, high = data.band
    kept = data.frequency > 0
    if not np.any(kept & (data.frequency >= low) & (data.frequency <= high)):
        problem = f"no line lies within {low:g} to {high:g} Hz"
        raise BadInput(source=data.source, field="band", problem=problem, remedy="Correct it")
    f, values, noise = data.frequency[kept], data.values[:, kept], None
    if data.coherence is not None and data.averages > 1:
        # |H| sqrt((1 - g²) / (g² averages)), both parts together: J. S. Bendat and A. G. Piersol, Random Data, 2010, section 9.2
        g = np.clip(np.asarray(data.coherence)[:, kept], 1e-6, 1.0)
        noise = np.asarray(np.abs(values) * np.sqrt((1 - g) / (g * data.averages)))
    share = data.share
    if share is None:  # as far as readings of one number differ: linear, it answers at i to a force at j as at j to one at i
        there = (data.frequency >= low) & (data.frequency <= high)
        at = [next((c for c, point in enumerate(data.responses) if _same(drive, point)), -1) for drive in data.drives]
        both = [k for k, c in enumerate(at) if c >= 0]
        alike = data.values[both][:, there][:, :, [at[k] for k in both]]
        share = series.repeatability(alike) if len(both) > 1 else 0.0
    test = ResponseFunctionTest(
        measured=measured(
            data.title,
            data.article,
            f,
            {drive.name: one for drive, one in zip(data.drives, values, strict=True)},
            [one.name for one in data.responses],
            band=data.band,
            share=share,
            noise=noise,
        ),
        structure=structure,
        responses=data.responses,
        drives=data.drives,
        quantity=data.quantity,
        gain=data.gain,
        force_gain=data.force_gain,
        decay_rate=data.decay_rate,
    )
    if data.scaled:
        return (test,)
    # The level of the model brought to that of the data, with the sign of power that goes in
    found, read = test.at({}, derivatives=False).rows[..., 0], test.measured.values
    factor = float(np.median(np.abs(read)) / np.median(np.abs(found)))
    pairs = [(r, c) for r, drive in enumerate(test.drives) for c, at in enumerate(test.responses) if _same(drive, at)]
    turned = {"acceleration": 1.0, "velocity": 1j, "displacement": -1.0}[test.quantity]
    power = sum(float(np.sum((turned * read[r, :, c]).imag)) for r, c in pairs)
    return (replace(test, scale=-factor if power < 0 else factor),)


def _same(one: Point, other: Point) -> bool:
    return one.place == other.place and float(np.dot(np.asarray(one.direction), np.asarray(other.direction))) > 0.99


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
    """The data set of a test; noise that is not known is that of the scatter of the lines (`validation.prediction.series`).

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
        noise = series.noise(f, values, max(series.AROUND, step * series.FEWEST / 2))
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
