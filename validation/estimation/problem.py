"""`Problem`: parameters, measured lines and what is predicted of them, all that a fit sees of a model."""

from collections.abc import Collection, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property, lru_cache
from math import sqrt
from operator import attrgetter
from types import MappingProxyType
from typing import Any, Protocol, Self

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import CheckFailed
from geometry.frames import Array, freeze
from identification.parameter import Parameter as Parameter
from identification.self_calibration.solve import smoothed_level
from validation.output import entry

IDENTIFIED, DECLARED, STRUCTURAL, SENSOR, EFFECT = KINDS = ("identified", "declared", "structural", "sensor", "effect")
"""What a laboratory legitimately has to identify (the FMD's inertia), what the model declares to know within a tolerance
(frequencies, damping, moduli), what else it leaves open of its modes (participation, coupling), tolerances of the measurement,
and effects that were added."""

NOMINAL: tuple[str, ...] = ()
PLAIN = (IDENTIFIED, DECLARED, EFFECT)
FITTED = KINDS
"""Which kinds of parameters are free in the three fits behind the nominal, the plain and the fitted error."""

IDENTIFYING = (*PLAIN, STRUCTURAL)
"""Those that are free where an article's inertia is identified: whatever its modes do, its mass does not follow from them."""

TOLERANCES = (DECLARED, STRUCTURAL, SENSOR)
"""Those whose offsets have a price."""

WITHIN = 2.5
"""[tolerance] by which a plain fit may move what is declared. Exercised by engine/test_fit.py."""

MODE = "mode"
"""In the place of what a run drove, where it is a mode of a table: nothing was."""


# `Measured`: complex lines of one data set, as the engine sees them: runs, lines, channels, and nothing of what they are.


@dataclass(frozen=True, eq=False, kw_only=True)
class Measured:
    """What one data set read, and how far it can be trusted.

    Attributes
    ----------
    name : of the data set, unique in a problem
    configuration : what was tested; effects on parts of it act wherever it has them
    hardware : id of the measuring equipment; data sets with the same id share its errors
    runs : (r,) names
    axes : (r,) what each run drove, as it is called in words; may be empty. `MODE` of a run that is a mode of a table
    channels : (c,) names
    judged : (c,) bool, the channels in which the plain error is told: forces, or the responses of an accelerance test
    frequency : (n,) [Hz], ascending
    values : (r, n, c) complex, SI or SI per Hz
    noise : (r, n, c) standard deviation of the complex noise, E|noise|² = sd²
    noise_scatter, noise_spread : relative standard deviation of the noise's power, at one line and of all channels and lines
    inputs : (r, n, k) complex, known inputs such as a drive force of 1 N; None for inputs that nobody knows (base motions),
        which are eliminated line by line
    discrepancy : share of the variance of the model-error floor that a test without any fault uses; 0 where the floor is a bound
        that none does
    read : (r, n, c) the part of `noise` that a sound model would read, where `noise` allows it to be off by more; None for all
    late : (c,) [s] standard deviation of the delay of each channel, which no plain fit moves
    pilots : names of the channels that tell the motion along the one axis that is driven: pick-ups across it hear it by their
        slant, and their model-error floor is a share of it, too; empty where all axes are measured
    unmeasured : names of the channels that stand for inputs which nobody measured: they read nothing, and their noise is how
        large such an input may be
    is_real : whether values are real numbers, such as frequencies, and `noise` is their standard deviation: the imaginary parts
        are zero and say nothing
    """

    name: str
    configuration: str
    hardware: str = ""
    runs: tuple[str, ...]
    axes: tuple[str, ...] = ()
    channels: tuple[str, ...]
    judged: npt.NDArray[np.bool_]
    frequency: Array
    values: ComplexArray
    noise: Array
    noise_scatter: float = 0.0
    noise_spread: float = 0.0
    inputs: ComplexArray | None = None
    discrepancy: float = 0.0
    read: Array | None = None
    late: Array = field(default_factory=lambda: np.zeros(1))
    pilots: tuple[str, ...] = ()
    unmeasured: tuple[str, ...] = ()
    is_real: bool = False

    def __post_init__(self) -> None:
        r, n, c = shape = (len(self.runs), len(self.frequency), len(self.channels))
        object.__setattr__(self, "axes", self.axes or ("",) * r)
        freeze(self, frequency=(n,), noise=shape)
        object.__setattr__(self, "judged", np.array(self.judged, dtype=bool).reshape(c))

    @property
    def called(self) -> tuple[str, ...]:
        """Each of `runs` in words."""
        return tuple(run if axis == MODE else f"run {run}" for run, axis in zip(self.runs, self.axes, strict=True))

    def on(self, runs: Sequence[str]) -> "Measured":
        """The runs named alone, in the order in which they stand here."""
        kept = [k for k, run in enumerate(self.runs) if run in runs]
        if len(kept) == len(self.runs):
            return self  # the very same, so that its level, which is kept by what it is of, need not be worked out again
        return replace(
            self,
            runs=tuple(self.runs[k] for k in kept),
            axes=tuple(self.axes[k] for k in kept),
            values=self.values[kept],
            noise=self.noise[kept],
            read=None if self.read is None else self.read[kept],
            inputs=None if self.inputs is None else self.inputs[kept],
        )


# `Prediction` and `Fact`: the two protocols through which the engine sees a model.
#
# At one line of one run the channels read ``y = A u + noise``: A (c, k) is predicted, the inputs u (k,) are known or latent. A
# fact is a single number that another measurement says: a weight, a centre of gravity, a period.

Lines = npt.NDArray[np.int64]

Wanted = bool | Collection[str]
"""Whether derivatives are wanted, or of which parameters; others may be left out."""


def is_wanted(name: str, of: Wanted) -> bool:
    """Whether the derivative by the parameter `name` is among them."""
    return of if isinstance(of, bool) else name in of


Offsets = Mapping[str, float]
"""Offsets of parameters by name; one that is not in it stands at 0."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Change:
    """How a prediction answers to one parameter.

    Attributes
    ----------
    channels : indices of the channels that change; no other does
    rows : (n, len(channels), k) complex, or (r, n, len(channels), k) where runs differ: d rows / d offset
    """

    channels: tuple[int, ...]
    rows: ComplexArray


@dataclass(frozen=True, eq=False, kw_only=True)
class Conveyed:
    """The same of a parameter that all channels see through the same few quantities, such as the loads of what is carried.

    Attributes
    ----------
    channels : indices of the channels that change; no other does
    through : (n, len(channels), j) what the channels read of these quantities; the same array of all parameters that go this way
    quantities : (n, j, k) d quantities / d offset
    """

    channels: tuple[int, ...]
    through: ComplexArray
    quantities: ComplexArray

    @property
    def rows(self) -> ComplexArray:
        """(n, len(channels), k) d rows / d offset."""
        return np.asarray(self.through @ self.quantities)


@dataclass(frozen=True, eq=False, kw_only=True)
class Predicted:
    """What the channels read for a unit of every input, and how that changes.

    Attributes
    ----------
    rows : (n, c, k) complex, or (r, n, c, k) where runs differ
    changes : by name of the parameters that act here; empty where derivatives were not asked for
    noise : (r, n, c) in place of that of the data where an effect on noise acts; None for the data's own
    """

    rows: ComplexArray
    changes: Mapping[str, Change | Conveyed] = field(default_factory=lambda: MappingProxyType({}))
    noise: Array | None = None


class Prediction(Protocol):
    """A model of one data set."""

    @property
    def measured(self) -> Measured:
        """The data."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move here. Predictions of a series share parameters by name, and then agree about them."""

    def on(self, runs: Sequence[str]) -> Self:
        """The same model of the runs named alone."""

    def at(self, offsets: Offsets, lines: Lines | None = None, *, derivatives: Wanted = True) -> Predicted:
        """The prediction at `offsets` and the lines with these indices; all lines by default.

        Raises
        ------
        numpy.linalg.LinAlgError, ValueError, FloatingPointError : the model breaks down there; a fit then steps back.
        """


class Fact(Protocol):
    """One number of another measurement."""

    @property
    def name(self) -> str:
        """Where it comes from and what it is, for messages and tables."""

    @property
    def parameters(self) -> tuple[Parameter, ...]:
        """All that may move it."""

    def residual(self, offsets: Offsets) -> tuple[float, Mapping[str, float]]:
        """(predicted - measured) / standard deviation, and its derivatives by offset of the parameters that act."""


# `Problem`: predictions of several data sets that share parameters by name, and facts of other measurements.

ALL_LINES: Mapping[str, Lines] = MappingProxyType({})

FEWEST = 20
"""[count] of lines of a data set below which none is left out. Held by test_errors.py."""

AGREED = ("unit", "kind", "logarithmic", "tolerance", "nominal", "start", "within", "low", "high")
"""What two predictions must say alike of a parameter that they share."""

said_alike = attrgetter(*AGREED)


@dataclass(frozen=True, eq=False)
class Problem:
    """What is compared: ``Problem(predictions, facts)``.

    Attributes
    ----------
    predictions : one a data set
    facts : single numbers of other measurements
    lines : by data set the indices of the lines that fits use; all where nothing is said
    """

    predictions: tuple[Prediction, ...]
    facts: tuple[Fact, ...] = ()
    lines: Mapping[str, Lines] = field(default_factory=lambda: ALL_LINES, kw_only=True)

    def __post_init__(self) -> None:
        object.__setattr__(self, "predictions", tuple(self.predictions))
        object.__setattr__(self, "facts", tuple(self.facts))
        names = [one.measured.name for one in self.predictions]
        for name in names:
            if names.count(name) > 1:
                raise ValueError(f"`predictions` must be of different data sets, found {name!r} twice: name them apart")
        _ = self.parameters

    @cached_property
    def parameters(self) -> tuple[Parameter, ...]:
        """The union of all, by name; of a sensor or an effect that is stated twice the smaller tolerance and the narrower range.

        Raises
        ------
        ValueError : two data sets or facts say different things of the same parameter; names both.
        """
        found: dict[str, tuple[Parameter, str]] = {}
        sources = [(one.measured.name, one.parameters) for one in self.predictions]
        for source, parameters in (*sources, *((one.name, one.parameters) for one in self.facts)):
            for parameter in parameters:
                first, said_by = found.setdefault(parameter.name, (parameter, source))
                if first is parameter or said_alike(first) == said_alike(parameter):
                    continue
                # One sensor, stated twice; an effect that one data set shows more of, or one structure can lose less of; an
                # FMD that one identifies: both are true
                low, high = max(first.low, parameter.low), min(first.high, parameter.high)
                least = min(first.tolerance, parameter.tolerance)
                both, other = (replace(one, tolerance=least, low=low, high=high) for one in (first, parameter))
                if first.kind in (SENSOR, EFFECT) and said_alike(both) == said_alike(other):
                    found[parameter.name] = (both, said_by)
                    continue
                if {first.kind, parameter.kind} == {IDENTIFIED, DECLARED}:
                    if parameter.tolerance < first.tolerance or parameter.kind == IDENTIFIED:
                        found[parameter.name] = (parameter, source)
                    continue
                what = next(what for what in AGREED if getattr(first, what) != getattr(parameter, what))
                raise ValueError(
                    f"parameter {first.name!r} must be the same in all data sets: its {what} is {getattr(first, what)!r} in "
                    f"{said_by} and {getattr(parameter, what)!r} in {source}; give them one value or two names"
                )
        return tuple(parameter for parameter, _ in found.values())

    @cached_property
    def by_name(self) -> dict[str, Parameter]:
        """The parameters by name."""
        return {one.name: one for one in self.parameters}

    @cached_property
    def start(self) -> dict[str, float]:
        """Offsets at which the model stands as it was given."""
        return {one.name: one.start for one in self.parameters}

    def free(self, kinds: Sequence[str]) -> tuple[Parameter, ...]:
        """The parameters of `kinds` that may move at all."""
        return tuple(one for one in self.parameters if one.kind in kinds and one.tolerance > 0)

    def lines_of(self, prediction: Prediction) -> Lines:
        """(m,) indices of the lines of a data set that fits use."""
        chosen = self.lines.get(prediction.measured.name)
        return np.arange(len(prediction.measured.frequency), dtype=np.int64) if chosen is None else chosen

    def thinned(self) -> "Problem":
        """The same with fewer lines for its fits where there are many, see `chosen`."""
        return replace(self, lines={one.measured.name: chosen(one.measured) for one in self.predictions})

    def sparser(self, step: int) -> "Problem":
        """The same with every so many lines of its fits, where that leaves `FEWEST`."""
        lines = {one.measured.name: self.lines_of(one) for one in self.predictions}
        return replace(self, lines={name: of[::step] if len(of) >= step * FEWEST else of for name, of in lines.items()})


# Which lines a fit uses: few where nothing happens, more where the level of the channels turns quickly with frequency.
#
# Beside resonances the model's own error is strongly correlated from line to line, so that neighbours add time and false
# certainty (identification/self_calibration/likelihood.py). Lines are therefore spread evenly over a measure of what happens:
# half of it is the frequency itself, half the turning of the levels, each line counted no more than `STEEPEST`. Phases turn
# with the sweep.

AT_MOST = 100
"""[count] of lines of one data set that a fit uses. Held by test_errors.py."""

STEEPEST = 0.3
"""[share] Relative change from one line to the next beyond which steeper is no steeper: a resonance between two lines. Exercised
by test_errors.py."""


@lru_cache(maxsize=8)
def chosen(measured: Measured, *, at_most: int = AT_MOST) -> Lines:
    """(m,) indices of at most `at_most` lines that fits use, the same whatever the model: parent and child stay comparable."""
    count = len(measured.frequency)
    if count <= at_most:
        return np.arange(count, dtype=np.int64)
    # (n - 1,) relative change of `level` (n, r, c) from line to line, rms over runs and channels
    level = smoothed_level(measured.frequency, measured.values).transpose(1, 0, 2)
    flat = level.reshape(len(level), -1)
    highest = np.maximum(np.maximum(flat[1:], flat[:-1]), np.finfo(np.float64).tiny)
    relative = np.abs(np.diff(flat, axis=0)) / highest
    turned = np.asarray(np.minimum(np.sqrt(np.mean(relative**2, axis=1)), STEEPEST))
    even = np.diff(measured.frequency) / (measured.frequency[-1] - measured.frequency[0])
    share = 0.5 * even + 0.5 * (turned / turned.sum() if turned.sum() > 0 else even)
    along = np.concatenate([[0.0], np.cumsum(share)])
    wanted = np.linspace(0.0, along[-1], at_most)
    found = np.unique(np.round(np.interp(wanted, along, np.arange(count))).astype(np.int64))
    found.setflags(write=False)  # every problem of the same data asks, and gets the same array
    return found


# `Evaluation`: the four errors of a model on data, fitted and held out, and the fits behind them.

NO_ERRORS: Mapping[str, float] = MappingProxyType({})


@dataclass(frozen=True, eq=False, kw_only=True)
class Share:
    """An error in per cent of what the judged channels read, and where it comes from.

    Attributes
    ----------
    percent : over all data sets, runs and lines
    by_channel, by_run, by_data_set : the same by name; runs as ``data set/run``
    by_fold : of held-out data, by what was held out together
    """

    percent: float
    by_channel: Mapping[str, float] = field(default_factory=lambda: NO_ERRORS)
    by_run: Mapping[str, float] = field(default_factory=lambda: NO_ERRORS)
    by_data_set: Mapping[str, float] = entry("by_campaign", default_factory=lambda: NO_ERRORS)
    by_fold: Mapping[str, float] = entry("by_what_was_held_out", default_factory=lambda: NO_ERRORS)


BY_CHANCE = 3.0
"""[sd] by which a sum of squares may exceed its mean by chance. Held by engine/test_fit.py."""


def by_chance(squares: float, count: int) -> bool:
    """Whether `count` numbers of deviation 1 explain that their squares sum to this."""
    return squares <= count + BY_CHANCE * sqrt(2 * max(count, 0))


@dataclass(frozen=True, eq=False, kw_only=True)
class Fit:
    """Where a fit ended.

    Attributes
    ----------
    parameters : (p,) that were free
    offsets : (p,)
    covariance : (p, p) of the offsets
    cost : half the sum of squares of whitened residuals, knowledge beforehand included
    chi2 : of the data alone, without the channels that stand for what nobody measured
    degrees_of_freedom : real numbers left when inputs and free parameters without knowledge beforehand are taken out, see
        `validation.estimation.likelihood.freedom`
    tolerance_z2 : sum of squares of offset / tolerance over the `TOLERANCES`
    tolerances : how many these are
    log_evidence : Laplace approximation [nats], up to a constant of the data
    converged : whether the iteration ended by itself
    ahead : where it did not, the next step of those three parameters that it moves farthest [standard deviations]
    """

    parameters: tuple[Parameter, ...]
    offsets: Array
    covariance: Array
    cost: float
    chi2: float
    degrees_of_freedom: int
    tolerance_z2: float
    tolerances: int
    log_evidence: float
    converged: bool
    ahead: Mapping[str, float] = field(default_factory=dict)

    def required(self) -> Self:
        """Itself, where it converged.

        Raises
        ------
        CheckFailed : it did not; says in which parameters.
        """
        if not self.converged:
            raise CheckFailed(f"{self.unfinished}; start from a nearer model, or declare more of it as unknown")
        return self

    @property
    def unfinished(self) -> str:
        """Where a fit that did not converge would still go, in words."""
        named = ", ".join(f"{name} ({step:+.1f})" for name, step in self.ahead.items())
        return (
            f"the fit of {len(self.parameters)} parameters did not converge: its next step is still many standard "
            f"deviations in {named}"
        )

    @property
    def sound(self) -> bool:
        """Whether chance explains all that is left of data and tolerances."""
        return by_chance(self.chi2, self.degrees_of_freedom) and by_chance(self.tolerance_z2, self.tolerances)

    @property
    def by_name(self) -> dict[str, float]:
        """Offsets by name."""
        return {one.name: float(x) for one, x in zip(self.parameters, self.offsets, strict=True)}

    @property
    def by_parameter(self) -> dict[str, Any]:
        """Every parameter by its name, as JSON has it."""
        sd = np.sqrt(np.maximum(np.diag(self.covariance), 0.0))
        return {
            one.name: {"value_si": one.value(float(x)), "offset": float(x), "sd": float(s), "kind": one.kind}
            for one, x, s in zip(self.parameters, self.offsets, sd, strict=True)
        }


@dataclass(frozen=True, eq=False, kw_only=True)
class Evaluation:
    """The errors of one model.

    Attributes
    ----------
    nominal : the model as it stands, nothing fitted
    plain : tolerances of the measurement not fitted
    held_out : plain error on runs, blocks of lines and whatever was named that were not fitted; None where nothing was held out
    held_out_nominal : nominal error on the same
    plain_fit, fitted : the fits; surprise is `fitted.tolerance_z2` beside `fitted.tolerances`
    held_out_names : what was held out, in words
    held_out_configurations, held_out_configurations_nominal : the same on each configuration of a series in turn, of which not
        even the modes were fitted; None where nothing but one was tested, or something was named
    """

    nominal: Share
    plain: Share
    held_out: Share | None
    held_out_nominal: Share | None
    plain_fit: Fit
    fitted: Fit
    held_out_names: tuple[str, ...] = field(default=())
    held_out_configurations: Share | None = None
    held_out_configurations_nominal: Share | None = None

    @property
    def of_runs(self) -> Self:
        """Without what was told of configurations."""
        if (of := self.held_out_configurations) is None:
            return self
        names = tuple(name for name in self.held_out_names if name not in of.by_fold)
        return replace(self, held_out_names=names, held_out_configurations=None, held_out_configurations_nominal=None)
