"""An accelerance test: a structure that is held, shaken or struck at one point after the other, accelerations per unit of force.

    reduced matrices of the structure       tolerances           effects of the structure
    -> accelerances, a run a drive point    dynamic_mass         effects of the channels
    -> gains of accelerometers and force    gains

The input of every run is the force, which is known: 1 N at each line of data that are divided by it. No base moves, so nothing
of a dynamic mass is here, and an effect on one has no meaning.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from validation.effects.catalogue import FAMILIES, acts, there
from validation.effects.effect import CHANNEL_STAGE, OPENED, STRUCTURE_STAGE
from validation.effects.stages import ChannelResponse
from validation.estimation.problem import Change, Lines, Measured, Offsets, Parameter, Predicted, Wanted
from validation.model.model import Added
from validation.prediction import dynamic_mass, series
from validation.prediction import effects as prediction_effects
from validation.prediction.dynamic_mass import structure
from validation.prediction.effects import Nuisances

GAIN = 0.02
"""Standard deviation of the gains of accelerometers and force cell that a careful laboratory admits."""

FORCE = "force-gain:force"
"""One force cell serves all runs."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Point:
    """Where a response is taken, or a force acts.

    Attributes
    ----------
    place : of the structure
    direction : (3,) unit vector
    """

    place: str
    direction: npt.ArrayLike = (1.0, 0.0, 0.0)


@dataclass(frozen=True, eq=False, kw_only=True)
class AcceleranceTest:
    """A model of one accelerance test: a `validation.estimation.problem.Prediction`.

    Attributes
    ----------
    measured : accelerances (r, n, c) [1/kg], one run a drive point, with inputs of 1
    structure : the matrices, base 0, and what is uncertain of them
    responses : (c,) of the channels
    drives : (r,) of the runs
    effects : in the order in which they act
    gain : tolerance of the gains, 0 for exact sensors
    """

    measured: Measured
    structure: Nuisances
    responses: tuple[Point, ...]
    drives: tuple[Point, ...]
    effects: tuple[Added, ...] = ()
    gain: float = GAIN

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move: of the structure, the gains, and the effects."""
        return self._opened[0]

    def on(self, runs: Sequence[str]) -> "AcceleranceTest":
        """The same model of the runs named alone."""
        kept = tuple(point for run, point in zip(self.measured.runs, self.drives, strict=True) if run in runs)
        return replace(self, measured=self.measured.on(runs), drives=kept)

    def with_effects(self, effects: Sequence[Added]) -> "AcceleranceTest":
        """The same test by a model with these `effects` instead of its own.

        Raises
        ------
        BadInput : one of them does not act on a held structure or its channels.
        """
        matrices, channels = self.structure.nominal, (*self.measured.channels, FORCE.partition(":")[2])
        parts, places = tuple(matrices.parts), tuple(matrices.places)
        here = there(self.measured.configuration, matrices, channels)
        own = {one.name for one in replace(self, effects=()).parameters}
        for named in (one.named for one in effects):
            stage = FAMILIES[named.family].stage
            if stage not in (STRUCTURE_STAGE, CHANNEL_STAGE, OPENED):
                problem, remedy = f"changes the {stage}, and an accelerance test has none", "Take an effect of the structure"
            elif stage == OPENED and named.id not in own:
                problem, remedy = "is no tolerance of this test", f"Tolerances are {', '.join(sorted(own))}"
            elif not acts(named, here):
                problem = f"acts on nothing of {self.measured.configuration}"
                remedy = f"Parts are {', '.join(parts)}; places {', '.join(places)}; channels {', '.join(channels)}"
            else:
                continue
            raise BadInput(source=self.measured.name, field=named.id, problem=problem, remedy=remedy)
        return replace(self, effects=tuple(effects))

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
        gains = np.array([1 + known.get(name, 0.0) for name in self._gains])
        made = [self._read(f, A[run], {k: d[run] for k, d in dA.items()}, gains, effects, moving) for run in range(len(A))]
        changes = {name: np.stack([tangents[name] for _, tangents in made]) for name in made[0][1]}
        every = tuple(range(len(self.measured.channels)))
        found = {name: Change(channels=every, rows=rows) for name, rows in changes.items() if name not in self._opened[1]}
        return Predicted(rows=np.stack([rows for rows, _ in made]), changes=found)

    def _accelerances(
        self, offsets: Offsets, f: Array, effects: Sequence[Added], *, derivatives: bool
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """(r, n, c, 1) and its derivatives by parameter."""
        matrices, tangents = structure(self.structure, offsets, effects, derivatives=derivatives)
        rows, forces = (
            np.array([dynamic_mass.along(matrices, point.place, point.direction) for point in points])
            for points in (self.responses, self.drives)
        )
        answered = dynamic_mass.accelerance(matrices, f, rows, forces)
        moved = dynamic_mass.transfer_tangents(answered, tangents)
        return _by_run(answered.matrix), {name: _by_run(change) for name, change in moved.items()}

    def _read(
        self, f: Array, A: ComplexArray, dA: Mapping[str, ComplexArray], gains: Array, effects: Sequence[Added], derivatives: bool
    ) -> tuple[ComplexArray, dict[str, ComplexArray]]:
        """What the channels of one run read (n, c, 1), and its derivatives: gains, then effects of the channels."""
        scale = (gains[:-1] / gains[-1])[:, None]
        tangents = {name: scale * change for name, change in dA.items()}
        if derivatives:
            # Derivatives (n, c, 1) of gain_c / gain_force * A by each gain
            found = {}
            for k, name in enumerate(self._gains[:-1]):
                found[name] = np.zeros_like(A)
                found[name][:, k] = A[:, k] / gains[-1]
            found[self._gains[-1]] = -(gains[:-1] / gains[-1] ** 2)[:, None] * A
            tangents |= found
        none = np.zeros((len(f), len(self.measured.channels)))
        reading = ChannelResponse(frequency=f, channels=self.measured.channels, rows=scale * A, amplitude=none)
        reading, tangents = prediction_effects.channels(reading, tangents, effects)
        return reading.rows, tangents

    @property
    def _gains(self) -> tuple[str, ...]:
        """Names of the gains: of the channels in their order, last that of the force."""
        return (*(f"accelerometer-gain:{channel}" for channel in self.measured.channels), FORCE)

    @cached_property
    def _opened(self) -> tuple[tuple[Parameter, ...], Offsets]:
        """The parameters, and the offsets of those that stand at a given size."""
        gains = [Parameter(name=name, unit="1", tolerance=self.gain) for name in self._gains if self.gain > 0]
        left, given = prediction_effects.opened([*self.structure.parameters, *gains], self.effects)
        return (*left, *prediction_effects.parameters(self.effects)), given


def measured(
    name: str,
    configuration: str,
    frequency: npt.ArrayLike,
    accelerance: Mapping[str, npt.ArrayLike],
    channels: Sequence[str],
    *,
    band: tuple[float, float] | None = None,
    share: float = 0.0,
) -> Measured:
    """The data set of a test; its noise is estimated from the scatter of the lines (`validation.prediction.series`).

    Parameters
    ----------
    frequency : (n,) [Hz], evenly spaced
    accelerance : by run (n, c) complex [1/kg]: accelerations of `channels` divided by the force
    band : (low, high) [Hz] of the lines that are kept; noise is estimated from all
    share : standard deviation of a reading as a share of it, beside the noise: how far the test repeats
    """
    f = np.asarray(frequency, dtype=np.float64)
    values = np.stack([np.asarray(one, dtype=np.complex128) for one in accelerance.values()])
    low, high = band or (f[0], f[-1])
    kept = (f >= low) & (f <= high)
    return Measured(
        name=name,
        configuration=configuration,
        runs=tuple(accelerance),
        channels=tuple(channels),
        judged=np.ones(len(channels), dtype=bool),
        frequency=f[kept],
        values=values[:, kept],
        noise=np.hypot(series.noise(f, values), share * np.abs(values))[:, kept],
        inputs=np.ones((len(values), int(kept.sum()), 1), dtype=np.complex128),
    )


def _by_run(matrix: ComplexArray) -> ComplexArray:
    """(n, c, r) as (r, n, c, 1)."""
    return np.asarray(matrix.transpose(2, 0, 1)[..., None])
