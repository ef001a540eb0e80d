"""A model compared with data: the four errors, the maps, the worst spots, and classical measurements beside it."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np

from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.frames import Array
from geometry.inertia import LOADS
from validation.compare.correlation import FunctionCorrelation, ModalCorrelation, NamedMode, correlations, modes_of
from validation.compare.maps import LENGTHS, Map, Rig, doubt, in_percent, mapped
from validation.estimation import verdicts
from validation.estimation.problem import MODE, Evaluation, Fit, Problem, Share
from validation.estimation.verdicts import ExplainedError, StatedError, Tolerance
from validation.output import derived, entry, plain_unit, to_json, two_digits, unwritten
from validation.prediction.series import SeriesPrediction
from validation.prediction.structure_tests import StructurePrediction
from validation.study import Study

WRITTEN_PAIRS = 10
"""Worst pairs of axes that JSON has."""

FEW = 10
"""Lines of a data set below which what is said of it is next to nothing."""

UNITS = ("kg", "m", "m", "m", *("kg m²",) * 6)
"""SI, of the quantities of `identification.request`."""

Progress = Callable[[str, float], None]
"""Hears what is done now, and the share of it."""


def compared(study: Study, progress: Progress | None = None) -> "Comparison":
    """The model of a `study` beside its data.

    Raises
    ------
    CheckFailed : without some channel the others do not tell latent inputs.
    """
    tell = progress or (lambda what, share: None)
    evaluation = study.evaluation(lambda share: tell("fitting", share))
    return of_evaluation(study, study.known().thinned(), evaluation, lambda share: tell("maps", share))


def of_evaluation(study: Study, fitted: Problem, evaluation: Evaluation, progress: Callable[[float], None]) -> "Comparison":
    """What an `evaluation` of a `study` says of its model; `fitted` is what its fits saw."""
    model, made, problem = study.model, study.predictions, study.whole()
    plain = {**problem.start, **evaluation.plain_fit.by_name}
    maps = mapped_all(made, problem, fitted, evaluation.plain_fit, progress)
    modes = tuple(modes_of(one, plain) for one in made)
    spots = worst(maps, modes)
    # What the plain error comes to by tolerances alone; known noise is no part of either
    explained = ExplainedError(
        measurement=_percent([of.explained for of in maps]), with_modes=_percent([of.explained_with_modes for of in maps])
    )
    due = verdicts.due_misfit(evaluation.fitted, fitted)
    facts = []
    for fact in (one.with_effects(model.effects) for one in study.said):
        sigma = fact.residual(plain)[0]
        facts.append(
            FactComparison(
                name=fact.name,
                unit=UNITS[int(np.argmax(np.abs(fact.weights)))],
                predicted=fact.value + sigma * fact.deviation,
                measured=fact.value,
                tolerance=fact.deviation,
                sigma=sigma,
                nominal_sigma=fact.residual(problem.start)[0],
            )
        )
    return Comparison(
        title=model.title or model.article,
        source=model.source,
        evaluation=evaluation,
        explained=explained,
        errors=verdicts.told(evaluation, explained, max((spot.sigma for spot in spots), default=0.0), due),
        due_misfit=due,
        absurd=verdicts.tolerances(evaluation.fitted)[: verdicts.TOLERANCES_NAMED],
        maps=maps,
        modes=modes,
        worst=spots,
        facts=tuple(facts),
        correlation=(alike := correlations(made)),
        effects=tuple(one.named.id for one in model.effects),
        remarks=tuple(
            dict.fromkeys(
                text.rstrip(".")
                for said in (_remarks(made, maps, evaluation), *(one.remarks for one in alike), study.on_several(model.effects))
                for text in said
            )
        ),
    )


def mapped_all(
    made: Sequence[StructurePrediction], problem: Problem, known: Problem, plain: Fit, progress: Callable[[float], None]
) -> tuple[Map, ...]:
    """The maps of all data sets at the plain fit; `known` is what was fitted."""
    unknown, at = doubt(known, plain), {**problem.start, **plain.by_name}
    found: list[Map] = []
    for one in made:
        rig = None
        if isinstance(one, SeriesPrediction):
            rig = Rig(table=one.tested.campaign.table, gravity=one.tested.campaign.gravity)
        found.append(mapped(one, at, unknown, rig, lambda share: progress((len(found) + share) / len(made))))
    return tuple(found)


def _percent(shares: Sequence[Array]) -> float:
    """Of all runs and lines, as `validation.estimation.evaluate` counts them."""
    return float(100 * np.sqrt(np.mean(np.concatenate([one.ravel() ** 2 for one in shares]))))


def _remarks(made: Sequence[StructurePrediction], maps: Sequence[Map], evaluation: Evaluation) -> Iterator[str]:
    """What was assumed by campaigns, predictions and maps, and what makes their verdicts weak."""
    for one in made:
        yield from one.remarks
    for of in maps:
        yield from of.remarks
    for one in made:
        lines = len(one.measured.frequency)
        if lines < FEW and isinstance(one, SeriesPrediction):
            have = "1 line lies" if lines == 1 else f"{lines} lines lie"
            few = f"only {have} in the band of {one.measured.name}"
            yield f"{few}: no verdict of this page rests on less than {FEW}; widen --band"
    for name, fit in (("plain fit", evaluation.plain_fit), ("fit of every tolerance", evaluation.fitted)):
        if not fit.converged:
            moved = f"its {len(fit.parameters)} parameters still moved, and its figures are no minimum"
            yield f"the {name} did not converge: {moved}"


@dataclass(frozen=True, kw_only=True)
class FactComparison:
    """One number of a classical measurement beside what the model says.

    Attributes
    ----------
    name : where it comes from and what it is
    unit : SI
    predicted, measured, tolerance : at the plain fit, in `unit`; the last is one standard deviation
    sigma : (predicted - measured) / standard deviation, after the plain fit
    nominal_sigma : the same of the model as it stands
    """

    name: str
    sigma: float
    nominal_sigma: float
    unit: str = entry(write=plain_unit)
    predicted: float
    measured: float
    tolerance: float


@dataclass(frozen=True, kw_only=True)
class WorstPair:
    """A pair of axes of one campaign, where it is worst.

    Attributes
    ----------
    data_set : the campaign
    load, motion : indices in the order of `MOTIONS`
    frequency : [Hz] of the peak
    sigma, percent : there
    """

    data_set: str = entry("campaign")
    load: int = entry(write=LOADS.__getitem__)
    motion: int = entry(write=MOTIONS.__getitem__)
    frequency: float = entry("frequency_hz", unit="Hz")
    sigma: float
    percent: float


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """A model and data, compared.

    Attributes
    ----------
    title : of the model
    source : its file
    evaluation : the four errors and the fits behind them
    explained : what tolerances let expect of the plain error
    due_misfit : chi² per degree of freedom that noise makes of tables of modes by itself; None without one
    errors : the four errors in words
    absurd : the tolerances that the fit moved farthest, most absurd first
    maps : one a data set
    modes : of each data set's configuration
    worst : the worst spots, worst first
    facts : classical measurements
    correlation : of tests of structures what analysts deliver, by the model as it is
    effects : ids of the effects that are in the model
    remarks : sentences: what was assumed, what is missing
    """

    source: str = entry("model")
    title: str
    effects: tuple[str, ...] = ()
    evaluation: Evaluation = unwritten()
    explained: ExplainedError = unwritten()
    due_misfit: float | None = unwritten(default=None)
    errors: tuple[StatedError, ...]
    absurd: tuple[Tolerance, ...] = entry("absurd_tolerances")
    maps: tuple[Map, ...] = unwritten()
    modes: tuple[tuple[NamedMode, ...], ...] = unwritten()
    worst: "tuple[Spot, ...]" = unwritten()
    facts: tuple[FactComparison, ...] = entry("classical", default=())
    correlation: tuple[ModalCorrelation | FunctionCorrelation, ...] = unwritten(default=())
    remarks: tuple[str, ...] = entry("warnings", default=())

    @property
    def data_sets(self) -> tuple[str, ...]:
        """Names, in order."""
        return tuple(one.data_set for one in self.maps)

    @property
    @derived("", before="errors")
    def figures(self) -> dict[str, Any]:
        """The figures of the four errors by their keys in JSON."""
        of = self.evaluation
        others = ("held_out", "held_out_nominal", "held_out_configurations", "held_out_configurations_nominal")
        shares: dict[str, Share | None] = {name: getattr(of, name) for name in others}
        return {
            "plain_error_percent": of.plain.percent,
            "fitted_chi2_per_dof": verdicts.misfit(of.fitted),
            **({} if self.due_misfit is None else {"fitted_chi2_per_dof_of_noise": self.due_misfit}),
            "tolerance_z2": of.fitted.tolerance_z2,
            "worst": [to_json(one) | {"text": text(one, len(self.maps))} for one in self.worst],
            "nominal_error_percent": of.nominal.percent,
            **{f"{name}_error_percent": None if one is None else one.percent for name, one in shares.items()},
            "held_out": of.held_out_names,
            "explained_error_percent": self.explained.measurement,
            "explained_error_with_modes_percent": self.explained.with_modes,
            "tolerances": of.fitted.tolerances,
            "tolerance_z2_expected": verdicts.expected_z2(of.fitted),
            "evidence_nats": of.fitted.log_evidence,
            "converged": of.plain_fit.converged and of.fitted.converged,
        }

    @property
    @derived("error_percent", before="absurd_tolerances")
    def shares(self) -> dict[str, Share | None]:
        """Where three of the errors come from."""
        return {"nominal": self.evaluation.nominal, "plain": self.evaluation.plain, "held_out": self.evaluation.held_out}

    @property
    @derived("", before="classical")
    def details(self) -> dict[str, Any]:
        """Parameters, worst pairs and maps by their keys in JSON; of a map without its lines, which the pictures show."""
        of = self.evaluation
        return {
            "parameters": {"plain": of.plain_fit.by_parameter, "fitted": of.fitted.by_parameter},
            **({"correlation": self.correlation} if self.correlation else {}),
            "worst_pairs": worst_pairs(self.maps, WRITTEN_PAIRS),
            "maps": [
                {
                    "campaign": one.data_set,
                    "article": one.configuration,
                    "runs": one.runs,
                    "channels": one.rows,
                    "frequency_band_hz": one.frequency[[0, -1]],
                    "peak_sigma": one.sigma.max(axis=1),
                    "peak_frequency_hz": one.frequency[one.sigma.argmax(axis=1)],
                    "rms_sigma": np.sqrt(np.mean(one.sigma**2, axis=1)),
                    "chi2_per_dof_by_run": one.misfit.mean(axis=1),
                    "pairs_peak_sigma": None if one.pairs is None else one.pairs.sigma.max(axis=0),
                    "pairs_peak_percent": None if one.pairs is None else one.pairs.percent.max(axis=0),
                    "modes": modes,
                }
                for one, modes in zip(self.maps, self.modes, strict=True)
            ],
        }


def worst_pairs(maps: Sequence[Map], count: int) -> tuple[WorstPair, ...]:
    """The `count` pairs of axes with the greatest peak in sigmas, of all campaigns together, worst first."""
    found = []
    for of in (one.pairs for one in maps if one.pairs is not None):
        sigma, percent = of.sigma, of.percent
        for i, j in np.ndindex(6, 6):
            line = int(np.argmax(sigma[:, i, j]))
            found.append(
                WorstPair(
                    data_set=of.campaign,
                    load=i,
                    motion=j,
                    frequency=float(of.frequency[line]),
                    sigma=float(sigma[line, i, j]),
                    percent=float(percent[line, i, j]),
                )
            )
    return tuple(sorted(found, key=lambda pair: -pair.sigma)[:count])


# How a deviation depends on frequency, where that is plain: a share that is constant, grows, falls, or a resonance.
#
# Each candidate is fitted by weighted least squares with one real number, a resonance with two complex ones, and is named only
# when it explains nearly all of the deviation. What follows nothing plain gets no name.


EXPLAINED = 0.9
"""Share of the deviation, in squares of standard deviations, that a name must explain."""

AROUND = 0.3
"""Share of a mode's frequency to either side in which a deviation may follow it."""

LONGEST = 3.0
"""[Hz] to either side that count at most."""

SHIFTED = 0.12
"""Share of its frequency by which a mode may lie elsewhere."""

WIDTHS = 6
"""Damping ratios to either side of a peak within which the mode is sought that makes it."""

OF_READING: Mapping[str, tuple[complex, int]] = {
    "the same share at all frequencies": (1, 0),
    "a share that grows with frequency, as of a delay": (1j, 1),
    "a share that falls with frequency, as of a high-pass": (1j, -1),
    "a share that grows with the square of frequency": (1, 2),
    "a share that falls with the square of frequency": (1, -2),
}
"""Of what a channel reads: factor and power of the frequency."""

OF_MOTION: Mapping[str, tuple[complex, int]] = {
    "constant over frequency, as of a mass": (1, 0),
    "grows with the square of frequency, as of a compliance": (1, 2),
    "falls with the square of frequency, as of a spring to ground or of gravity": (1, -2),
    "falls with frequency, as of a damper to ground": (1j, -1),
}
"""Of the motion that a run drives."""


@dataclass(frozen=True, eq=False, kw_only=True)
class FrequencyTrend:
    """A deviation over frequency.

    Attributes
    ----------
    frequency : (n,) [Hz]
    deviation : (n,) complex
    expected : (n,) standard deviation
    reading : (n,) complex, what was expected to be read
    motion : (n,) complex, what the run drives
    of_load : whether it is a load's, not a channel's
    """

    frequency: Array
    deviation: ComplexArray
    expected: Array
    reading: ComplexArray
    motion: ComplexArray
    of_load: bool

    def follows(self, modes: Sequence[NamedMode], band: tuple[float, float], peak: float) -> str:
        """What the deviation follows, in words; empty where nothing plain. It stands out in `band` [Hz], most at `peak`."""
        weight = 1 / np.maximum(self.expected, np.finfo(np.float64).tiny)
        f, y, motion = self.frequency, weight * self.deviation, weight * self.motion
        if not np.any(np.abs(y) > 0):
            return ""
        functions, driver = (OF_MOTION, self.motion) if self.of_load else (OF_READING, self.reading)
        basis = np.array([factor * weight * driver * f**power for factor, power in functions.values()])
        shares = dict(zip(functions, _explained(y, basis[:, None]).tolist(), strict=True))
        best = max(shares, key=lambda name: shares[name])
        if shares[best] >= EXPLAINED:
            return best
        # The mode near `band` whose resonance it follows: as predicted, and as that would be with another frequency and damping
        found = {}
        for mode in modes:
            if not band[0] / (1 + SHIFTED) <= mode.frequency <= band[1] * (1 + SHIFTED):
                continue
            near, zeta = np.abs(f - mode.frequency) <= min(AROUND * mode.frequency, LONGEST), mode.damping_ratio
            own = _resonance(f[near] / mode.frequency, zeta)
            times, width = np.meshgrid((0.25, 0.5, 1.0, 2.0), np.linspace(-WIDTHS, WIDTHS, 4 * WIDTHS + 1))
            elsewhere = _resonance(f[near] / (peak * (1 + width * times * zeta))[..., None], (times * zeta)[..., None])
            others = np.concatenate([own[None] ** 2, elsewhere.reshape(width.size, len(own))])  # its derivative first
            pairs = motion[near] * np.stack([np.broadcast_to(own, others.shape), others], axis=1)
            found[mode.name] = float(_explained(y[near], np.concatenate([pairs, 1j * pairs], axis=1)).max())
        best = max(found, key=lambda name: found[name], default="")
        return f"follows the {best}" if best and found[best] >= EXPLAINED else ""


def _resonance(ratio: Array, zeta: float | Array) -> ComplexArray:
    return np.asarray(1 / (1 - ratio**2 + 2j * zeta * ratio))


def _explained(y: ComplexArray, bases: ComplexArray) -> Array:
    """(b,) share of the square of y (n,) that real multiples of each of the `bases` (b, k, n) explain; 0 of fewer lines than show
    anything."""
    columns, flat = (np.concatenate([of.real, of.imag], axis=-1) for of in (bases, y))
    if len(flat) < 4 * columns.shape[1] or not np.any(flat):
        return np.zeros(len(columns))
    columns = columns / np.maximum(np.linalg.norm(columns, axis=2, keepdims=True), np.finfo(np.float64).tiny)
    _, sizes, directions = np.linalg.svd(columns, full_matrices=False)  # of all bases at once
    known = sizes > np.finfo(np.float64).eps * len(flat) * sizes[:, :1]
    return np.asarray(np.sum(np.square(np.where(known, directions @ flat, 0.0)), axis=1) / (flat @ flat))


# The worst spots: connected regions of the maps, merged over neighbouring lines and over all rows that say the same.
#
# One fault shows in many cells of a map. A spot therefore takes the worst row of a run, the stretch of lines around its peak on
# which it stays above half of that, and whatever else in this run and stretch is less bad than it. What is left is looked at
# again: something worse in the same stretch is a spot of its own. The same row in other runs, and the same channel in other
# data sets, is one spot with the worst of them.


COUNT = 10

REGION = 0.5
"""Share of its peak down to which a spot reaches."""

GAP = 0.5
"""[Hz] of calmer lines that do not end a spot."""

LOAD, RESONANT = 0.65, 0.05
"""What a sigma of a load counts beside one of a channel, but for lines within that share of a mode's frequency. A channel that is
off shows in its loads nearly as much, all over the band; a resonance that is wrong is the structure's, and every cell sees it."""

PART = 0.05
"""Share of the greatest effective mass of several modes that one of them must have to be driven."""

A_RUN = 6
"""Spots of one run that are looked at."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Spot:
    """A region of a map.

    Attributes
    ----------
    data_set, configuration, run, axis : where
    row : the channel, or the load, that is worst
    of_load : whether it is a load
    frequency : [Hz] of the peak; NaN in a table of modes, which has no lines
    band : (low, high) [Hz]; NaN there
    sigma : at the peak, in standard deviations
    counts : the same as it counts beside other rows
    percent : there, of what the channel reads, of the dynamic mass for a load
    course : what it follows over frequency, in words; empty where nothing plain
    others : rows of the same run that say the same, worst first
    elsewhere : (data set, run, sigma) where the same row stands out too, worst first
    """

    data_set: str = entry("campaign")
    configuration: str = unwritten()
    run: str
    axis: str = unwritten()
    row: str = entry("channel")
    of_load: bool = unwritten()
    frequency: float = entry("frequency_hz", unit="Hz")
    sigma: float
    band: tuple[float, float] = entry("band_hz", unit="Hz")
    percent: float
    counts: float = unwritten(default=0.0)
    course: str = entry("follows", null="", default="")
    others: tuple[str, ...] = entry("also_in_channels", default=())
    elsewhere: tuple[tuple[str, str, float], ...] = entry(
        "also_in", write=lambda of: [dict(zip(("campaign", "run", "sigma"), one, strict=True)) for one in of], default=()
    )

    @property
    @derived("text", before="band_hz")
    def text(self) -> str:
        """In words, of one configuration among several."""
        return text(self)

    def is_same(self, other: "Spot") -> bool:
        """Whether both are of one row - a channel is the same in all data sets, a load in its own alone - and of one cause.

        Their bands touch, or both follow the same over frequency: at a resonance a channel is calm, and its fault is the same
        beyond.
        """
        touching = self.band[0] <= other.band[1] + GAP and other.band[0] <= self.band[1] + GAP
        of_modes = np.isnan(self.frequency) and np.isnan(other.frequency)
        alike = touching or of_modes or bool(self.course and self.course == other.course)
        return self.row == other.row and alike and (not self.of_load or self.data_set == other.data_set)


def worst(maps: Sequence[Map], modes: Sequence[Sequence[NamedMode]], count: int = COUNT) -> tuple[Spot, ...]:
    """The worst `count` spots of all `maps`, worst first; `modes` are those of each map's configuration."""
    of_maps = zip(maps, modes, strict=True)
    found = [spot for of, own in of_maps for run in range(len(of.runs)) for spot in _of_run(of, run, own)]
    kept: list[Spot] = []
    for spot in sorted(found, key=lambda spot: -spot.counts):
        same = next((k for k, one in enumerate(kept) if one.is_same(spot)), None)
        if same is None:
            kept.append(spot)
            continue
        # Told by the worse one: in its band where both are of one run and alike bad, else as a further place
        one, here = kept[same], (spot.data_set, spot.run)
        if here != (one.data_set, one.run):
            if here not in ((data_set, run) for data_set, run, _ in one.elsewhere):
                kept[same] = replace(one, elsewhere=(*one.elsewhere, (*here, spot.sigma)))
        elif spot.sigma >= REGION * one.sigma:
            kept[same] = replace(one, band=(min(one.band[0], spot.band[0]), max(one.band[1], spot.band[1])))
    return tuple(kept)[:count]


def _of_run(of: Map, run: int, modes: Sequence[NamedMode]) -> Iterator[Spot]:
    """The spots of one run, which take its sigmas (n, m) one after the other."""
    # What a sigma counts when the worst row is sought
    near = [np.abs(of.frequency - mode.frequency) <= RESONANT * mode.frequency for mode in modes]
    counts = np.ones((len(of.frequency), len(of.rows)))
    counts[:, of.channels :] = (np.where(np.any(near, axis=0), 1.0, LOAD) if near else np.full(len(of.frequency), LOAD))[:, None]
    sigma = np.abs(of.deviation[run]) / of.expected[run]
    whole = sigma * counts
    left = np.array(whole)
    for _ in range(A_RUN):
        line, row = map(int, np.unravel_index(int(np.argmax(left)), left.shape))
        peak = float(left[line, row])
        if peak <= 0:
            return
        # First and last line around the peak between which no gap of calmer lines is longer than `GAP`
        above = np.flatnonzero(whole[:, row] >= REGION * peak)
        at, calmer = int(np.searchsorted(above, line)), np.diff(above) > 1
        apart = np.flatnonzero(calmer & (np.diff(of.frequency[above]) > GAP))
        first = int(above[max((k + 1 for k in apart if k < at), default=0)])
        last = int(above[min((k for k in apart if k >= at), default=len(above) - 1)])
        yield replace(_spot(of, run, sigma, line, row, (first, last), modes), counts=peak)
        # Take away what the worst row explains: its own region, and all rows where they are less bad within half a gap
        reach = np.abs(of.frequency[:, None] - of.frequency[None, first : last + 1]) <= GAP / 2
        around = np.where(reach, whole[:, row][None, first : last + 1], 0.0).max(axis=1)
        left[left <= around[:, None]] = 0.0
        left[reach.any(axis=1), row] = 0.0


def _spot(of: Map, run: int, sigma: Array, line: int, row: int, stretch: tuple[int, int], modes: Sequence[NamedMode]) -> Spot:
    first, last = stretch
    band = (float(of.frequency[first]), float(of.frequency[last]))
    peaks = sigma[first : last + 1].max(axis=0)
    # Which of the inputs the run drives: that of its axis, else the greatest
    u = of.inputs[run]
    if of.axes[run] in MOTIONS and u.shape[1] == len(MOTIONS):
        driven = MOTIONS.index(of.axes[run])
    else:
        scaled = u * LENGTHS if u.shape[1] == len(MOTIONS) else u
        driven = int(np.argmax(np.sum(np.abs(scaled) ** 2, axis=0)))
    # Modes that a motion of the base along the driven axis drives; all where that is not known
    known = all(len(one.effective_mass) > driven for one in modes)
    most = max((one.effective_mass[driven] for one in modes), default=0.0) if known else 0.0
    driving = [one for one in modes if not known or one.effective_mass[driven] >= PART * most]
    trend = FrequencyTrend(
        frequency=of.frequency,
        deviation=of.deviation[run, :, row],
        expected=of.expected[run, :, row],
        reading=of.reading[run, :, row],
        motion=u[:, driven],
        of_load=row >= of.channels,
    )
    return Spot(
        data_set=of.data_set,
        configuration=of.configuration,
        run=of.runs[run],
        axis=of.axes[run],
        row=of.rows[row],
        of_load=row >= of.channels,
        frequency=float(of.frequency[line]) if of.has_lines else np.nan,
        band=band if of.has_lines else (np.nan, np.nan),
        sigma=float(sigma[line, row]),
        percent=float(in_percent(of.deviation[run, line, row], of.level[run, line, row])),
        course=trend.follows(driving, band, float(of.frequency[line])),
        others=tuple(of.rows[k] for k in np.argsort(-peaks) if k != row and peaks[k] >= REGION * sigma[line, row]),
    )


# Spots in words: what is wrong, where, by how much, and what it follows.
#
# moment about y in the y-sweep of fmd+clumod-1, 11-13 Hz, 9 sigma, 4 % of the dynamic mass, follows the first mast mode


SENSED = dict(
    zip(
        LOADS,
        ("force along x", "force along y", "force along z", "moment about x", "moment about y", "moment about z"),
        strict=True,
    )
)
"""A load in words."""

AXES = dict(zip(MOTIONS, ("x", "y", "z", "rotation about x", "rotation about y", "rotation about z"), strict=True))

NOTHING_READ = 1e6
"""[%] of what a channel reads, from which it reads nothing, and no share of it is told. Exercised by test_single_axis.py."""

TIMES = 1e3
"""[%] from which a share is told as so many times. By definition."""

NAMED = 3
"""Runs that are listed by name; of more, their number is."""


def text(spot: Spot, configurations: int = 2) -> str:
    """One spot; the configuration is left out where there is only one."""
    where = f" of {spot.data_set}" if configurations > 1 else ""
    whole, times = "the dynamic mass" if spot.of_load else "what it reads", spot.percent / 100
    share = f"{two_digits(spot.percent)} % of {whole}" if spot.percent < TIMES else f"{two_digits(times)} times {whole}"
    # As many digits of the band as tell its ends apart
    low, high = (f"{one:.0f}" for one in spot.band)
    if low == high:
        low, high = (f"{one:.1f}" for one in spot.band)
    parts = [
        f"{SENSED.get(spot.row, spot.row)} in {run(spot.run, spot.axis)}{where}",
        *([] if np.isnan(spot.frequency) else [f"{low} Hz" if low == high else f"{low}-{high} Hz"]),
        f"{two_digits(spot.sigma)} sigma",
        *([share] if spot.percent < NOTHING_READ else []),
        *([spot.course] if spot.course else []),
    ]
    # The same row in other runs and data sets
    own = [run(name, MODE if spot.axis == MODE else name) for data_set, name, _ in spot.elsewhere if data_set == spot.data_set]
    if len(own) > NAMED:
        own = [f"{', '.join(own[:NAMED])} and {len(own) - NAMED} more"]
    said = [*own, *dict.fromkeys(data_set for data_set, _, _ in spot.elsewhere if data_set != spot.data_set)]
    return ", ".join(parts) + (f"; also in {', '.join(said)}" if said else "")


def run(name: str, axis: str) -> str:
    """ "the y-sweep", with the name of the run where that says more; a mode of a table is called by its name."""
    if axis not in AXES:
        return name if axis == MODE else f"run {name}"
    swept = f"the {axis}-sweep" if axis in MOTIONS[:3] else f"the {axis} sweep"
    return swept if name == axis else f"{swept} ({name})"
