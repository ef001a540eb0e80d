"""The two-level test: do runs of one axis at two levels answer alike? It comes before any linear fit, and needs no model.

What a weaker run holds beyond the stronger ones is compared with noise, channel by channel and
over all lines. An axis is named where some channel stands out both of noise and of what it reads, by more than what only leaks
into this axis by the cross motion of a table that drives another one.
"""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from itertools import product

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, rigid_transformation_6
from identification.quality import NORMAL_90
from identification.self_calibration.solve import eliminated, level_of_groups, smoothed_level
from validation.diagnose.diagnosis import Cause, EffectEstimate, LevelDifference
from validation.effects.catalogue import FAMILIES, Named, acts
from validation.effects.effect import AMPLITUDE, BODY_STAGE, INDISTINGUISHABLE_NATS
from validation.effects.stages import ChannelResponse, MountedDynamicMass
from validation.model.model import vocabulary
from validation.prediction import dynamic_mass, effects
from validation.prediction.series import SeriesPrediction
from validation.study import Study

# `RunsByLevel`: the runs of one campaign by how strongly they were driven, and what the weaker ones hold beyond the stronger
# ones.
#
# What is linear reads y = A u in every run, whatever A is: the readings of six independent runs span all that a seventh can
# read. So no model is asked: the stronger runs B of all axes explain a weaker run, line by line, up to noise,
#
#     r = (1 - Q Q^H) W y ,   W B = Q R ,   1 / W² = noise² + |c|² noise_B² + floor² ,   y ~ B c
#
# and what is left over is not linear. Where the stronger runs do not span the six motions, the rows of the model stand in for
# those that are missing; its errors then count with the little that the runs differ by.


WEAKER = 0.9
"""[share] of the strongest level of an axis below which a run was driven at another level. Exercised by test_nonlinear.py."""

SAME_SHAPE = 0.99
"""[1] Cosine from which two runs drive the same axes. Exercised by test_nonlinear.py."""

FLOOR = 5e-4
"""[share] of a channel's level that no recorder repeats from one run to the next, beside its noise. Held by test_nonlinear.py."""

SPANNED = 20.0
"""[factor] by which the weakest of six motions must stand above noise in the stronger runs for these to span them. Exercised by
test_nonlinear.py."""

MODEL_ERROR = 0.1
"""[share] by which a model's rows that stand in for runs may be off. Held by test_nonlinear.py."""

Indices = npt.NDArray[np.int64]


@dataclass(frozen=True, eq=False, kw_only=True)
class RunsByLevel:
    """The runs of one campaign.

    Attributes
    ----------
    name : of the data set
    runs, axes : (r,) names, and what each drove in words
    share : (r,) of the level of the strongest run that drove the same
    partner : (r,) that strongest run; the run itself where it is the strongest
    channels : (c,) names
    judged : (c,) bool, forces
    frequency : (n,) [Hz]
    values, noise : (r, n, c) as `validation.estimation.problem.Measured`
    level : (r, n, c) smoothed level, never silent
    rows : (n, c, 6) of the model, which stand in where the runs do not span
    """

    name: str
    runs: tuple[str, ...]
    axes: tuple[str, ...]
    share: Array
    partner: Indices
    channels: tuple[str, ...]
    judged: npt.NDArray[np.bool_]
    frequency: Array
    values: ComplexArray
    noise: Array
    level: Array
    rows: ComplexArray

    @property
    def weaker(self) -> tuple[int, ...]:
        """Indices of the runs that have a stronger partner."""
        return tuple(int(k) for k in np.flatnonzero(self.share < WEAKER))

    @property
    def stronger(self) -> tuple[int, ...]:
        """Indices of the strongest runs of their axes."""
        return tuple(int(k) for k in np.flatnonzero(self.share >= WEAKER))

    def at(self, lines: Indices) -> "RunsByLevel":
        """The lines with these indices alone."""
        of_runs = {name: getattr(self, name)[:, lines] for name in ("values", "noise", "level")}
        return replace(self, frequency=self.frequency[lines], rows=self.rows[lines], **of_runs)


@dataclass(frozen=True, eq=False, kw_only=True)
class NonlinearResidual:
    """What a weaker run holds beyond the stronger ones.

    Attributes
    ----------
    run : its index
    whitened : (n, c) complex, of unit variance for each that is free
    free : (n, c) share of each channel's noise that is left over, diagonal of 1 - Q Q^H
    explained : (n, c, k) orthonormal, Q
    deviation : (n, c) standard deviation by which it was whitened
    weights : (n, h) c, what it takes of each of the stronger runs
    """

    run: int
    whitened: ComplexArray
    free: Array
    explained: ComplexArray
    deviation: Array
    weights: ComplexArray

    def projected(self, values: ComplexArray) -> ComplexArray:
        """(n, c) what of readings (n, c) the stronger runs do not explain, whitened."""
        white = (values / self.deviation)[..., None]
        return np.asarray((white - self.explained @ (self.explained.conj().transpose(0, 2, 1) @ white))[..., 0])

    @property
    def chi2(self) -> float:
        """Sum of squares; one for every complex number that is free."""
        return float(np.sum(np.abs(self.whitened) ** 2))

    @property
    def count(self) -> float:
        """Complex numbers that are free."""
        return float(np.sum(self.free))

    @property
    def by_channel(self) -> Array:
        """(n, c) by how much the sum of squares would fall without a channel; 1 on average where nothing is wrong."""
        return np.asarray(np.abs(self.whitened) ** 2 / np.maximum(self.free, FREE))

    @property
    def channel_z(self) -> Array:
        """(c,) by how many standard deviations the sum over lines of each channel is too large."""
        n = len(self.whitened)
        return np.asarray((np.sum(self.by_channel, axis=0) - n) / np.sqrt(n))

    def differing(self, level: Array) -> tuple[int, ...]:
        """Indices of the channels, of smoothed `level` (n, c), that answer differently, the worst first."""
        alone = (self.by_channel - 1) / np.maximum(self.free, FREE) * self.deviation**2  # beyond noise, the others believed
        share = np.sqrt(np.maximum(alone.mean(axis=0), 0.0) / np.mean(level**2, axis=0))
        z = self.channel_z
        apart = np.flatnonzero((z > SURE) & (share > VISIBLE))
        return tuple(int(k) for k in apart[np.argsort(-z[apart])])


FREE = 1e-3
"""[share] of a channel's noise below which the others do not say what it reads. Exercised by test_nonlinear.py."""


def runs_by_level(one: SeriesPrediction) -> RunsByLevel:
    """The runs of `one`; what its model knows of an amplitude is taken off their readings."""
    measured = one.measured
    drive = np.stack([of.amplitude for of in one.tested.drives])
    size = np.linalg.norm(drive, axis=1)
    if not np.all(size > 0):
        # Where runs state no amplitude, by the axis, in what their accelerometers read
        size = np.sqrt(np.mean(np.abs(measured.values[..., ~measured.judged]) ** 2, axis=(1, 2)))
        known = sorted(set(measured.axes))
        drive = np.zeros((len(size), len(known)))
        drive[np.arange(len(size)), [known.index(axis) for axis in measured.axes]] = size
    along = drive / np.maximum(size, np.finfo(np.float64).tiny)[:, None]
    same = along @ along.T > SAME_SHAPE
    strongest = np.where(same, size[None], 0.0).max(axis=1)
    share = size / strongest
    partner = np.arange(len(size))
    for k in np.flatnonzero(share < WEAKER):
        rivals = np.flatnonzero(same[k] & (share >= WEAKER))
        a, others = measured.values[k].ravel(), [measured.values[other].ravel() for other in rivals]
        sizes = [max(float(np.linalg.norm(a) * np.linalg.norm(b)), np.finfo(np.float64).tiny) for b in others]
        coherence = [float(np.abs(np.vdot(a, b)) / norm) for b, norm in zip(others, sizes, strict=True)]
        partner[k] = rivals[np.argmax(coherence)]
    linear = one.with_effects([effect for effect in one.effects if FAMILIES[effect.named.family].side != AMPLITUDE])
    start = {parameter.name: parameter.start for parameter in one.parameters}
    rows, values = linear.at(start, derivatives=False).rows, measured.values
    if len(linear.effects) < len(one.effects):
        # Readings less what the amplitude-dependent effects of the model make of them
        own, values = one.at(start, derivatives=False).rows, np.array(values)
        for run, y in enumerate(measured.values):
            A = own[run] if own.ndim == 4 else own
            w = 1 / np.hypot(measured.noise[run], MODEL_ERROR * np.abs(y).max(axis=0))
            values[run] += ((rows - A) @ eliminated(A, y, w)[2][..., None])[..., 0]
    silent = level_of_groups(values, measured.judged)
    return RunsByLevel(
        name=measured.name,
        runs=measured.runs,
        axes=tuple(axis or "several axes" for axis in measured.axes),
        share=share,
        partner=partner,
        channels=measured.channels,
        judged=measured.judged,
        frequency=measured.frequency,
        values=values,
        noise=measured.noise,
        level=np.hypot(smoothed_level(measured.frequency, values), SILENT * silent),
        rows=rows if rows.ndim == 3 else rows[0],
    )


SILENT = 0.01
"""[share] of what channels of its kind read at which a channel counts as silent. Exercised by test_nonlinear.py."""


def nonlinear_residuals(of: RunsByLevel, runs: Sequence[int] | None = None) -> tuple[NonlinearResidual, ...]:
    """What each of the weaker `runs` (all by default) holds beyond the stronger ones; none where channels are too few."""
    strong = list(of.stronger)
    basis = of.values[strong].transpose(1, 2, 0)
    n, _, h = basis.shape
    missing = h < len(MOTIONS)
    if not missing:  # whether the stronger runs move in all six ways, well above their noise, at most lines
        noise = np.sqrt(np.mean(of.noise[strong] ** 2, axis=0))
        noise = np.maximum(noise, FLOOR * of.level[strong].max(axis=0))
        sizes = np.linalg.svd(basis / noise[..., None], compute_uv=False)
        missing = not np.median(sizes[:, len(MOTIONS) - 1]) > SPANNED
    if h + (len(MOTIONS) if missing else 0) >= len(of.channels):
        return ()
    found = []
    for k in of.weaker if runs is None else runs:
        own = np.hypot(of.noise[k], FLOOR * of.level[k])
        # What the stronger runs move, in at most six ways (n, c, m), and of which runs each is made (n, h, m)
        if h <= len(MOTIONS):
            motions, made_of = basis, np.broadcast_to(np.eye(h, dtype=np.complex128), (n, h, h))
        else:
            U, S, Vh = np.linalg.svd(basis / own[..., None], full_matrices=False)
            kept = slice(len(MOTIONS))
            made_of = Vh[:, kept].conj().transpose(0, 2, 1) / S[:, None, kept]
            motions = U[..., kept] * own[..., None]
        columns = np.concatenate([motions, of.rows], axis=2) if missing else motions
        u = eliminated(columns, of.values[k], 1 / own)[2]
        weights = (made_of @ u[:, : motions.shape[2], None])[..., 0]
        variance = own**2 + np.einsum("nh,hnc->nc", np.abs(weights) ** 2, of.noise[strong] ** 2)
        if missing:
            moved = (of.rows @ u[:, motions.shape[2] :, None])[..., 0]
            variance = variance + (MODEL_ERROR * np.abs(moved)) ** 2
        deviation = np.sqrt(variance)
        whitened, Q, _ = eliminated(columns, of.values[k], 1 / deviation)
        free = 1 - np.sum(np.abs(Q) ** 2, axis=2)
        found.append(NonlinearResidual(run=k, whitened=whitened, free=free, explained=Q, deviation=deviation, weights=weights))
    return tuple(found)


SURE = 12.0
"""[sd] of the sum over all lines from which a channel answers differently. Of 22 channels in 384 weaker runs of 32 series with
nothing planted the worst reached 7.0: noise is an estimate that scatters, too. Held by test_nonlinear.py."""

VISIBLE = 2e-3
"""[share] of what a channel reads that must differ. Exercised by test_nonlinear.py."""

LEAKING = 3.0
"""[factor] by which more must differ than leaks from axes that are driven across. Held by test_nonlinear.py."""


SMOOTHED = 9
"""[count] of lines over which the worst frequency is looked for. No test of its own."""


def differing_levels(data: Study) -> tuple[LevelDifference, ...]:
    """Axes that answer differently at two levels, the most surprising first; none where all were driven at one, or answer alike.

    What amplitude-dependent effects of the data's model explain is taken off first. Of several levels of an axis in one campaign
    it is the one that shows most.
    """
    known: dict[tuple[int, str], LevelDifference] = {}
    for number, one in enumerate(data.made):
        of = runs_by_level(one.with_effects(data.model.effects))
        left = nonlinear_residuals(of)
        for residual in left:
            run, partner = residual.run, int(of.partner[residual.run])
            apart = residual.differing(of.level[run])
            # What other axes' differences bring along by cross motion
            brought = 0.0
            for other in left:
                if other.run == run or of.partner[other.run] == partner:
                    continue
                column = of.stronger.index(int(of.partner[other.run]))
                taken = np.abs(residual.weights[:, column]) / of.share[other.run]
                brought += float(np.sum(taken[:, None] ** 2 * np.abs(other.whitened * other.deviation) ** 2))
            own = float(np.sqrt(np.sum(np.abs(residual.whitened * residual.deviation) ** 2)))
            if not apart or own < LEAKING * np.sqrt(brought):
                continue
            by_line = np.sum(residual.by_channel[:, list(apart)], axis=1)
            width = min(SMOOTHED, len(by_line))
            worst = int(np.argmax(np.convolve(by_line, np.ones(width) / width, mode="same")))
            level = LevelDifference(
                data_set=of.name,
                runs=(of.runs[run], of.runs[partner]),
                axis=of.axes[run],
                channels=tuple(of.channels[k] for k in apart),
                frequency=float(of.frequency[worst]),
                sigma=float(residual.channel_z.max()),
            )
            if (number, level.axis) not in known or known[number, level.axis].sigma < level.sigma:
                known[number, level.axis] = level
    return tuple(sorted(known.values(), key=lambda level: -level.sigma))


def require_levels(data: Study, what: str) -> None:
    """Refuse data that were driven at one level where the candidate `what` is seen by two.

    Raises
    ------
    BadInput : no axis of any campaign was driven at two levels.
    """
    if FAMILIES[what.partition(":")[0].strip()].side != AMPLITUDE or any(runs_by_level(one).weaker for one in data.made):
        return
    raise BadInput(
        ", ".join(one.source for one in data.campaigns),
        "run.excitation.level",
        f"every axis was driven at one level, and one level cannot see {what}: it looks like mass and damping there",
        "Drive the same axes once more at half the level (`massline simulate --levels 1,0.5`), and name those runs, too",
    )


# `DistortedRuns`: what an amplitude-dependent effect makes of the readings of runs at several levels, by the catalogue's
# equations.
#
# The equations say what a channel reads of a sine of given amplitude, or what a body weighs that is shaken so hard. They are
# applied to the readings themselves, whose amplitude in time follows from the level that a run states and from what its
# accelerometers read,
#
#     a_c(f) = |y_c(f)| level / |u(f)|
#
# and undone by iteration: readings z that the effect would turn into those found. So no resonance need be where the model has it.


ROUNDS = 12
"""[count] of iterations by which an equation is undone; each leaves at most half of what was left. Held by test_nonlinear.py."""

TINY = float(np.finfo(np.float64).tiny)


@dataclass(frozen=True, eq=False, kw_only=True)
class DistortedRuns:
    """Runs of a campaign, ready to be held against effects.

    Attributes
    ----------
    one : the prediction that knows how they were driven and what they drove
    of : the runs at some lines
    lines : indices of these lines
    peak : (r, c) largest reading in time of every channel in the run at the strongest level of the same axis
    tested : indices of the weaker runs that are looked at
    """

    one: SeriesPrediction
    of: RunsByLevel
    lines: Indices
    peak: Array
    tested: tuple[int, ...]

    @cached_property
    def left(self) -> tuple[NonlinearResidual, ...]:
        """What the weaker runs hold beyond the stronger ones, as they are."""
        return nonlinear_residuals(self.of, self.tested)

    def chi2(self, named: Named, *, first_order: bool) -> float:
        """Sum of squares without `named`; to first order the stronger runs explain what they do as they are."""
        of = self.of
        by_run = {run: self.added(named, run) for run in (*self.tested, *of.stronger)}
        if not first_order:
            values = np.array(of.values)
            for run, added in by_run.items():
                values[run] -= added
            return sum(one.chi2 for one in nonlinear_residuals(replace(of, values=values), self.tested))
        found = 0.0
        for one in self.left:
            taken = sum(one.weights[:, [h]] * by_run[run] for h, run in enumerate(of.stronger))
            found += float(np.sum(np.abs(one.whitened - one.projected(by_run[one.run] - taken)) ** 2))
        return found

    def added(self, named: Named, run: int) -> ComplexArray:
        """(n, c) what `named` has added to the readings of the run with index `run`."""
        change, of = FAMILIES[named.family].change, self.of
        if change is None:
            return np.zeros_like(of.values[run])
        if FAMILIES[named.family].stage == BODY_STAGE:
            # The article on its place, as the equations of a body want it
            carried, drive = self.one.tested.carried, self.one.tested.drives[run]
            pose, matrices = carried.standing.pose, carried.standing.matrices
            stage = MountedDynamicMass(
                frequency=of.frequency,
                matrix=self._article,
                seat=pose.position,
                cog=np.zeros(3) if matrices is None else pose.rotation @ matrices.cog,
                amplitude=drive.amplitude,
                sweep_rate=drive.sweep_rate,
                block=drive.block,
            )
            T = rigid_transformation_6(stage.seat)
            more = T.T @ (change(stage, named.targets, named.values).matrix - stage.matrix) @ T
            return np.asarray((self._felt @ more @ self._motion[run][..., None])[..., 0])
        partner = int(of.partner[run])
        straight = self._straight(named, partner, self.peak[partner], rising=True)[1]
        return np.asarray(of.values[run] - self._straight(named, run, straight, rising=False)[0])

    def _straight(self, named: Named, run: int, peak: Array, *, rising: bool) -> tuple[ComplexArray, Array]:
        """Readings (n, c) of a run that `named` would turn into those found, and the peak (c,) that goes with them.

        Where the peak is that of this run (`rising`), it was distorted as well: what a cubic takes of a peak is 4/3 of what it
        takes of the fundamental.
        """
        change, y = FAMILIES[named.family].change, self.of.values[run]
        loudest = np.argmax(np.abs(y), axis=0), np.arange(y.shape[1])
        z, found = y, peak
        for _ in range(ROUNDS):
            amplitude = self._per_unit[run][:, None] * np.abs(z)
            reading = ChannelResponse(
                frequency=self.of.frequency, channels=self.of.channels, rows=z[..., None], amplitude=amplitude, peak=found
            )
            z = z + y - change(reading, named.targets, named.values).rows[..., 0]  # type: ignore[misc]
            if rising:
                found = peak * (np.abs(z[loudest]) / np.maximum(np.abs(y[loudest]), TINY)) ** (4 / 3)
        return np.asarray(z), np.asarray(found)

    @cached_property
    def _motion(self) -> ComplexArray:
        """(r, n, 6) of the base."""
        return _motion(self.of)

    @cached_property
    def _per_unit(self) -> Array:
        """(r, n) amplitude in time for a unit of a line."""
        return _per_unit(self.one, self._motion)

    @cached_property
    def _felt(self) -> ComplexArray:
        """(n, c, 6) what the channels read of loads about F that the cells carry."""
        one, frequency = self.one, self.of.frequency
        chain = one.tested.opened(one.effects)[0]
        start = {parameter.name: parameter.start for parameter in one.parameters}
        rows = chain.rows(np.array([start.get(parameter.name, 0.0) for parameter in chain.parameters]), frequency)[1][:, :, :6]
        linear = [effect for effect in one.effects if FAMILIES[effect.named.family].side != AMPLITUDE]
        reading = ChannelResponse(frequency=frequency, channels=self.of.channels, rows=np.asarray(rows, dtype=np.complex128))
        return effects.channels(reading, {}, linear, derivatives=False)[0].rows

    @cached_property
    def _article(self) -> ComplexArray:
        """(n, 6, 6) dynamic mass of the article about its origin."""
        start = {parameter.name: parameter.start for parameter in self.one.parameters}
        own = dynamic_mass.at(self.one.tested.carried.moving, start).mass_matrix
        G = np.linalg.inv(rigid_transformation_6(self.one.tested.carried.standing.pose.position))
        return np.asarray(G.T @ (self.one.dynamic_mass(start, self.lines) - own) @ G)


def distorted_runs(data: Study, levels: Sequence[LevelDifference]) -> Iterator[DistortedRuns]:
    """Of each campaign with axes among `levels` the runs that differ most, where all runs state their level.

    Peaks are those of recordings, or of the spectra where these are not in time.
    """
    for made in data.made:
        worst = sorted((level for level in levels if level.data_set == made.measured.name), key=lambda level: -level.sigma)
        one = made.with_effects(data.model.effects)
        if not worst or not all(np.any(drive.amplitude) for drive in one.tested.drives):
            continue
        of = runs_by_level(one)
        recordings = next((raw.recordings for raw, each in zip(data.campaigns, data.made, strict=False) if each is made), {})
        peak = (_per_unit(one, _motion(of))[..., None] * np.abs(of.values)).max(axis=1)
        for k, run in enumerate(of.runs):
            recorded = recordings.get(run)
            if recorded is not None and not recorded.is_spectrum and len(recorded):
                values = recorded.values[:, [recorded.names.index(name) for name in of.channels]]
                peak[k] = np.abs(values - values.mean(axis=0)).max(axis=0)
        lines = np.unique(np.linspace(0, len(of.frequency) - 1, LINES).round().astype(np.int64))
        tested = tuple(of.runs.index(level.runs[0]) for level in worst[:WORST])
        yield DistortedRuns(one=one, of=of.at(lines), lines=lines, peak=peak[of.partner], tested=tested)


def _motion(of: RunsByLevel) -> ComplexArray:
    """(r, n, 6) of the base, by the accelerometers: at a resonance these need no structure."""
    moved = ~of.judged
    return np.asarray((np.linalg.pinv(of.rows[:, moved]) @ of.values[..., moved, None])[..., 0])


def _per_unit(one: SeriesPrediction, motion: ComplexArray) -> Array:
    """(r, n) amplitude in time for a unit of a line."""
    found = np.zeros(motion.shape[:2])
    for k, drive in enumerate(one.tested.drives):
        driven = drive.amplitude > 0
        share = np.abs(motion[k][:, driven]) / drive.amplitude[driven]
        found[k] = np.sqrt(driven.sum()) / np.maximum(np.linalg.norm(share, axis=1), TINY)
    return found


# Which kind of nonlinearity lets two levels differ: friction, a gap, saturation, or what else the catalogue has.
#
# Every candidate is taken off the readings of all runs (`DistortedRuns`), at sizes from a grid and then at the
# best; the right one leaves weaker runs that the stronger ones explain (`nonlinear_residuals`). First to first order,
# in what the stronger runs cannot explain as they are; the best then as they would be without it. No model of the structure is
# fitted, so none can swallow what does not belong to it.
#
# Evidence is the fall of the sum of squares at the lines that are looked at, divided by what is left per degree of freedom by
# the best of all: equations for the fundamental alone are good to some per cent and not to noise.


LINES = 60
"""[count] of lines of a campaign that are looked at. Exercised by test_nonlinear.py."""

WORST = 3
"""[count] of weaker runs of a campaign that are looked at, those that differ most. Exercised by test_nonlinear.py."""

SUSPECTED = 4
"""[count] of channels that are suspected of saturation, those that differ most. Exercised by test_nonlinear.py."""

PER_DECADE = 3
"""[count] of sizes in a decade of the first grid. Exercised by test_nonlinear.py."""

SIZED_AGAIN = 4
"""[count] of candidates, the best by first order, whose size is found once more. Exercised by test_nonlinear.py."""

RESIZED_LOG = 0.7
"""[log] about the size by first order within which a size that is fitted by its logarithm is found once more. Held by
test_nonlinear.py."""

RESIZED_SHARE = 0.3
"""[share] of the size by first order within which another size is found once more. Exercised by test_nonlinear.py."""

RESIZED_RANGE = 0.02
"""[share] of all that the family allows, which is added to that. Exercised by test_nonlinear.py."""

SIZE_TOLERANCE = 1e-3
"""[share] of that interval to which the size is found. Exercised by test_nonlinear.py."""

CURVATURE_STEP = 0.02
"""[share] of that interval: step of the second difference that gives the size its own. Exercised by test_nonlinear.py."""

EXPLAINED = 0.8
"""[share] of the surplus that a kind must explain to be the right one. Exercised by test_diagnosed.py."""

EQUATIONS = 0.04
"""[share] of the size by which the equations themselves are off, one sd. Exercised by test_nonlinear.py."""

BY_CHANCE = 4.0
"""[sd] of a sum of squares within which what is unexplained is noise. Exercised by test_nonlinear.py."""


def nonlinear(
    data: Study, levels: Sequence[LevelDifference], progress: Callable[[float], None] | None = None
) -> tuple[Cause, ...]:
    """What could let the axes of `levels` differ, the likeliest first; none where runs do not state their level.

    Evidence is in nats of what the best leaves. `misfit` of a cause is what it leaves per degree of freedom, and `null` says
    whether it explains the difference.
    """
    seen, tell = tuple(distorted_runs(data, levels)), progress or (lambda share: None)
    if not seen:
        return ()
    worst = sorted(levels, key=lambda level: -level.sigma)
    every = dict.fromkeys(level.channels[k] for k in range(SUSPECTED) for level in worst if k < len(level.channels))
    suspected, words = tuple(every)[:SUSPECTED], vocabulary(data.model, data.campaigns)
    # What depends on the amplitude and acts on some campaign, at the bounds of what is fitted; on one channel those suspected
    moved, felt = (
        tuple(name for name in suspected if known is None or name in known) for known in (words.accelerometers, words.forces)
    )
    narrowed = replace(words, accelerometers=moved, forces=felt)
    there = [replace(one.one.tested.carried.standing.there, channels=one.of.channels) for one in seen]
    menu: list[Named] = []
    for family in FAMILIES.values():
        if family.side != AMPLITUDE or family.change is None:
            continue
        for targets in product(*(narrowed.legal(kind) or () for kind in family.targets)):
            values = {size.key: size.high if size.default is None else size.default for size in family.sizes_at(targets)}
            named = Named(family=family.name, targets=targets, values=values)
            menu += [named] if any(acts(named, one) for one in there) else []
    rough: list[_Found] = []
    for k, named in enumerate(menu):
        rough += _sized(named, seen, first_order=True)
        tell((k + 1) / (len(menu) + 1))
    rough.sort(key=lambda one: one.chi2)
    found = [better for one in rough[:SIZED_AGAIN] for better in _sized(one.named, seen, first_order=False)]
    found.sort(key=lambda one: one.chi2)
    tell(1.0)
    before = sum(left.chi2 for one in seen for left in one.left)
    count = sum(left.count for one in seen for left in one.left)
    scale = max(1.0, found[0].chi2 / count) if found else 1.0
    causes = []
    for one in found:
        evidence = (before - one.chi2) / scale
        if evidence <= 0:
            continue
        share = min((before - one.chi2) / max(before - count, TINY), 1.0)
        enough = bool(share > EXPLAINED or one.chi2 < count + BY_CHANCE * np.sqrt(count))
        note = f"it explains {100 * share:.0f} % of what differs between the levels beyond noise"
        note += "" if enough else ", so another kind, or more than one, is at work"
        near = [each for each in found if each is not one and abs(each.chi2 - one.chi2) / scale < INDISTINGUISHABLE_NATS]
        if near and (before - found[0].chi2) / scale - evidence < INDISTINGUISHABLE_NATS:
            note += f"; these levels cannot tell it from {' and '.join(each.named.id for each in near)}"
        sizes, left = (one.estimate(scale),), one.chi2 / count
        causes.append(Cause(named=one.named, sizes=sizes, evidence=evidence, misfit=left, null=enough, note=note))
    return tuple(causes)


@dataclass(frozen=True, kw_only=True)
class _Found:
    """A candidate at its best size, what it leaves, and the second derivative of that by the size (its logarithm)."""

    named: Named
    chi2: float
    curvature: float

    def estimate(self, scale: float) -> EffectEstimate:
        """With the 90 % interval of the curvature: -log L is the sum of squares over `scale`."""
        of = self.named.fitted_sizes[0]
        value = self.named.values[of.key]
        of_equations = EQUATIONS if of.logarithmic else EQUATIONS * abs(value)
        half = NORMAL_90 * float(np.hypot(np.sqrt(scale / self.curvature), of_equations)) if self.curvature > 0 else np.inf
        ends = (value * np.exp(-half), value * np.exp(half)) if of.logarithmic else (value - half, value + half)
        low, high = max(float(ends[0]), of.low), min(float(ends[1]), of.high)
        return EffectEstimate(key=of.key, value=value, unit=of.unit, low=low, high=high)


def _sized(named: Named, seen: Sequence[DistortedRuns], *, first_order: bool) -> list[_Found]:
    """`named` at its best size; none where the data have not what it acts on, or no size helps."""
    from scipy.optimize import minimize_scalar

    size = named.fitted_sizes[0]
    begin = named.values[size.key]

    def at(x: float) -> Named:
        return replace(named, values={**named.values, size.key: float(np.exp(x)) if size.logarithmic else x})

    def chi2(x: float) -> float:
        return sum(one.chi2(at(x), first_order=first_order) for one in seen)

    try:
        if first_order and size.logarithmic:  # the neighbours of the best of a grid
            ends = np.log(size.low), np.log(size.high)
            grid = np.linspace(*ends, round(PER_DECADE * (ends[1] - ends[0]) / np.log(10)) + 1)
            best = int(np.argmin([chi2(float(x)) for x in grid]))
            low, high = float(grid[max(best - 1, 0)]), float(grid[min(best + 1, len(grid) - 1)])
        elif first_order:
            low, high = size.low, size.high
        elif size.logarithmic:
            low, high = float(np.log(begin)) - RESIZED_LOG, float(np.log(begin)) + RESIZED_LOG
        else:
            half = RESIZED_SHARE * abs(begin) + RESIZED_RANGE * (size.high - size.low)
            low, high = max(size.low, begin - half), min(size.high, begin + half)
    except BadInput:
        return []
    found = minimize_scalar(chi2, bounds=(low, high), method="bounded", options={"xatol": SIZE_TOLERANCE * (high - low)})
    step = CURVATURE_STEP * (high - low)
    curvature = (chi2(found.x - step) - 2 * found.fun + chi2(found.x + step)) / step**2
    return [_Found(named=at(float(found.x)), chi2=float(found.fun), curvature=float(curvature))]
