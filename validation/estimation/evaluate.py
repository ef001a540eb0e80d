"""The four errors of a model, on the data that it was fitted to and on data that it has not seen."""

from collections.abc import Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from functools import cached_property
from itertools import pairwise
from types import MappingProxyType

import numpy as np

from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array
from geometry.toml_file import nearest
from identification.self_calibration.solve import Normal, excess, total
from validation.estimation.fit import BREAKDOWNS, PLAIN_FLOOR, Progress, at_bounds, child, descent, fit, nearby
from validation.estimation.likelihood import Cost, cost_of, left_of_run, observed
from validation.estimation.problem import FITTED, PLAIN, Evaluation, Fit, Lines, Offsets, Predicted, Prediction, Problem, Share

# Errors in per cent of what the judged channels read, each predicted from all the others (`validation.estimation.likelihood`).
#
# Of one line of one run the error is |f - f_predicted| / |f| over the judged channels; of many it is the root of the mean
# square. That of one channel is its share, |f_c - f_c predicted| / |f|: squares of the channels add to the square of the whole.
# Noise that is known is no error of a model: what it makes of the squares on average is taken off, so that a run that is weakly
# driven counts no more than one that is not. Where noise alone explains all, the error is 0.

FLOOR = 0.005
"""[share] Relative error of a channel, beside its noise, in the weights by which latent inputs are estimated: tolerances of the
measurement, of some 0.3 % to 1.5 %, are not fitted here. Exercised by test_errors.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Squares:
    """Squares of the relative errors of one run.

    Attributes
    ----------
    data_set, run : whose they are
    channels : (j,) names of the judged ones
    values : (m, j) of every line, less what noise makes of them on average; below zero where it made less
    fold : what was held out when they were predicted; empty for data that were fitted
    """

    data_set: str
    run: str
    channels: tuple[str, ...]
    values: Array
    fold: str = ""


def squares(
    prediction: Prediction, offsets: Offsets, lines: Lines | None = None, *, fold: str = "", predicted: Predicted | None = None
) -> list[Squares]:
    """Of every run of `prediction` at `offsets` and `lines` (indices), all by default; none where no channel is judged.

    `predicted` is what it says there, where that is known already.

    Raises
    ------
    CheckFailed : without some channel the others do not tell the inputs; the model breaks down.
    """
    measured = prediction.measured
    if not np.any(measured.judged):
        return []
    chosen = np.arange(len(measured.frequency), dtype=np.int64) if lines is None else lines
    try:
        predicted = predicted or prediction.at(offsets, chosen, derivatives=False)
    except BREAKDOWNS as error:
        raise CheckFailed(f"the model of {measured.name} breaks down: {error}") from error
    seen, judged = observed(measured, chosen, plain=True), measured.judged
    weight, found = seen.weight(FLOOR, predicted.noise), []
    noise = np.square(seen.noise if predicted.noise is None else predicted.noise)
    for k, run in enumerate(measured.runs):
        rows = predicted.rows if predicted.rows.ndim == 3 else predicted.rows[k]
        left = left_of_run(seen, rows, weight[k], k, judged)
        level = np.sum(np.abs(seen.values[k][:, judged]) ** 2, axis=1, keepdims=True)
        # (m, j) mean square of what `variance` (m, c) leaves in every channel that is judged; what nobody recorded has no noise
        variance = np.where(np.any(seen.values[k], axis=0), noise[k], 0.0)
        of_noise = variance[:, judged]
        if left.gain is not None:
            of_noise = ((left.gain.real**2 + left.gain.imag**2) @ variance[..., None])[..., 0]
        values = (np.abs(left.values) ** 2 - of_noise) / np.maximum(level, np.finfo(np.float64).tiny)
        names = tuple(name for name, one in zip(measured.channels, judged, strict=True) if one)
        found.append(Squares(data_set=measured.name, run=run, channels=names, values=values, fold=fold))
    return found


def share(found: Sequence[Squares]) -> Share:
    """Squares of several runs as one error."""
    # Over the runs in which each channel is
    named = ((name, one.values[:, [k]]) for one in found for k, name in enumerate(one.channels))
    return Share(
        percent=_percent([one.values for one in found]),
        by_channel=_grouped(named),
        by_run=_grouped((f"{one.data_set}/{one.run}", one.values) for one in found),
        by_data_set=_grouped((one.data_set, one.values) for one in found),
        by_fold=_grouped((one.fold, one.values) for one in found if one.fold),
    )


def _percent(values: Sequence[Array]) -> float:
    """Of squares (m, j) of several runs: channels add, lines and runs are averaged."""
    if not values:
        return 0.0
    return 100 * float(np.sqrt(max(np.mean(np.concatenate([one.sum(axis=1) for one in values])), 0.0)))


def _grouped(named: Iterable[tuple[str, Array]]) -> dict[str, float]:
    groups: dict[str, list[Array]] = {}
    for name, values in named:
        groups.setdefault(name, []).append(values)
    return {name: _percent(values) for name, values in groups.items()}


# What is held out: each run of each data set in turn and, in a series, each configuration; or what is named.
#
# A fit that never saw a run, a configuration or a block of frequencies must predict it. Lines alone are never held out one by
# one: a model's error is strongly correlated from line to line, and their scores are useless ("What bit" of the catalogue).

Runs = Mapping[str, tuple[str, ...]]
"""Runs by data set."""

NOBODY: Runs = MappingProxyType({})

SHORTEST = 1.0
"""[Hz] that a block of frequencies is at least. Held by test_hold_out.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Fold:
    """What is held out together.

    Attributes
    ----------
    name : in words
    runs : by data set, those that are held out with all their lines
    blocks : by data set the indices of the lines that are held out of all runs
    facts : names of those that are held out
    configuration : whether it is all of one configuration of a series
    """

    name: str
    runs: Runs = field(default_factory=lambda: NOBODY)
    blocks: Mapping[str, Lines] = field(default_factory=lambda: MappingProxyType({}))
    facts: tuple[str, ...] = ()
    configuration: bool = False


def folds(problem: Problem) -> tuple[Fold, ...]:
    """Each run of each data set of several, and each configuration of several, in turn."""
    found = []
    for one in problem.predictions:
        if len(one.measured.runs) > 1:
            for run, words in zip(one.measured.runs, one.measured.called, strict=True):
                found.append(Fold(name=f"{words} of {one.measured.name}", runs={one.measured.name: (run,)}))
    configurations = dict.fromkeys(one.measured.configuration for one in problem.predictions)
    if len(configurations) > 1:
        for configuration in configurations:
            whole = {of.name: of.runs for one in problem.predictions if (of := one.measured).configuration == configuration}
            found.append(Fold(name=f"configuration {configuration}", runs=whole, configuration=True))
    return tuple(found)


def every_block(problem: Problem, count: int) -> tuple[Fold, ...]:
    """`count` blocks of frequency, of equal width on a logarithmic axis, each held out of all data sets in turn.

    Raises
    ------
    BadInput : fewer than two, or blocks narrower than `SHORTEST`.
    """
    low = min(float(one.measured.frequency[0]) for one in problem.predictions)
    high = max(float(one.measured.frequency[-1]) for one in problem.predictions)
    edges = np.geomspace(max(low, 1e-3 * high), high * (1 + 1e-12), max(count, 1) + 1)
    if count < 2 or edges[1] - edges[0] < SHORTEST:
        problem_ = f"cannot be cut into {count} blocks of at least {SHORTEST:g} Hz, found {low:g} to {high:g} Hz"
        raise BadInput("hold-out", "blocks", problem_, "Ask for 2 or a few more")
    made = []
    for lo, hi in pairwise(edges):
        blocks: dict[str, Lines] = {}
        for one in problem.predictions:
            inside = np.flatnonzero((one.measured.frequency >= lo) & (one.measured.frequency < hi))
            blocks |= {one.measured.name: inside} if len(inside) else {}
        made += [Fold(name=f"{lo:.3g} to {hi:.3g} Hz", blocks=blocks)] if blocks else []
    return tuple(made)


def named(problem: Problem, names: Sequence[str]) -> Fold:
    """All that `names` name, together: runs as ``data set/run`` or by a name that only one has, data sets, configurations, facts.

    Raises
    ------
    BadInput : an unknown name, with the nearest; a run that several data sets have; nothing is left to fit.
    """
    runs: dict[str, tuple[str, ...]] = {}
    facts: list[str] = []
    for name in names:
        # Runs by data set, and facts, that `name` names
        measured = [one.measured for one in problem.predictions]
        whole = [(one.name, one.runs) for one in measured if name in (one.name, one.configuration)]
        if whole:
            pieces, fact = whole, []
        else:
            meant_facts = [fact.name for fact in problem.facts if fact.name == name]
            if meant_facts:
                pieces, fact = [], meant_facts
            else:
                meant_runs = [(one.name, (run,)) for one in measured for run in one.runs if name in (run, f"{one.name}/{run}")]
                if len(meant_runs) == 1:
                    pieces, fact = [(meant_runs[0][0], meant_runs[0][1])], []
                else:
                    raise _unknown(problem, name, [f"{data_set}/{run[0]}" for data_set, run in meant_runs])
        for data_set, some in pieces:
            runs[data_set] = tuple(dict.fromkeys((*runs.get(data_set, ()), *some)))
        facts += fact
    fold = Fold(name=", ".join(names), runs=runs, facts=tuple(facts))
    if not without(problem, fold).predictions:
        raise BadInput("--hold-out", fold.name, "nothing is left to fit", "Hold out less")
    return fold


def without(problem: Problem, fold: Fold) -> Problem:
    """What is left to fit."""
    lines, left = {}, []
    for one in problem.predictions:
        name, runs = one.measured.name, one.measured.runs
        kept = [run for run in runs if run not in fold.runs.get(name, ())]
        lines[name] = np.setdiff1d(problem.lines_of(one), fold.blocks.get(name, np.zeros(0, dtype=np.int64)))
        if kept and len(lines[name]):
            left.append(one if len(kept) == len(runs) else one.on(kept))
    facts = tuple(fact for fact in problem.facts if fact.name not in fold.facts)
    return replace(problem, predictions=tuple(left), facts=facts, lines=lines)


def held(problem: Problem, fold: Fold) -> list[tuple[Prediction, Lines | None]]:
    """What is predicted: predictions of the runs that are held out, and lines of them, None for all."""
    found: list[tuple[Prediction, Lines | None]] = []
    for one in problem.predictions:
        name = one.measured.name
        if fold.runs.get(name):
            found.append((one.on(fold.runs[name]), None))
        elif name in fold.blocks:
            found.append((one, fold.blocks[name]))
    return found


def _unknown(problem: Problem, name: str, several: Sequence[str]) -> BadInput:
    if several:
        told = f"is a run of {len(several)} data sets"
        return BadInput("--hold-out", name, told, f"Write one of {', '.join(several)}")
    measured = [one.measured for one in problem.predictions]
    known = [
        *(one.name for one in measured),
        *dict.fromkeys(one.configuration for one in measured if one.configuration != one.name),
        *(f"{one.name}/{run}" for one in measured for run in one.runs),
        *(fact.name for fact in problem.facts),
    ]
    short = [run for one in measured for run in one.runs]
    near = nearest(name, [*known, *short])
    problem_ = f"no run, data set, configuration or fact is called {name!r}"
    return BadInput("--hold-out", name, problem_, f"{near}Known are {', '.join(known)}")


# The plain fit without what a fold holds out: a short way from the solution with all data.
#
# Normal equations of runs add, so that those without a run are known at once, and their quadratic model has its minimum in
# closed form. Where that lies too far away for a quadratic model, the fit goes on from there with the data that are left.
# Where it does not, the error of what is held out is told within some thousandths of itself.

NEAR = 6.0
"""[sd] as far as the data fit, to which the quadratic model is taken at its word. Exercised by test_hold_out.py."""

FEW = 8
"""[count] of evaluations that a fold may take beyond that. Exercised by test_hold_out.py."""

SHORTER = 8
"""[count] of times that a step is halved at which the model breaks down. Exercised by test_hold_out.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Solved:
    """A plain fit with what its folds need.

    Attributes
    ----------
    cost : of all data in the parameters that stand at no bound
    x : (p,) of these
    by_run : normal equations by data set and run there
    """

    cost: Cost
    x: Array
    by_run: dict[tuple[str, str], Normal]


def solved(problem: Problem, plain: Fit, floor: float) -> Solved:
    """`plain`, the plain fit of `problem` at `floor`, ready for folds."""
    cost = at_bounds(cost_of(problem, plain.parameters, floor, plain=True), plain.by_name)
    x = cost.at(plain.by_name)
    return Solved(cost=cost, x=x, by_run=cost.by_run(x))


def refitted(at: Solved, fold: Fold, near: float = NEAR) -> dict[str, float]:
    """Offsets of all parameters that fit best without what `fold` holds out, declared ones within bounds; `near` as `NEAR`."""
    rest = replace(at.cost, problem=without(at.cost.problem, fold), observed=())
    if fold.blocks:
        left = rest.data(at.x)
    else:
        kept = [one for (data_set, run), one in at.by_run.items() if run not in fold.runs.get(data_set, ())]
        left = total(kept, len(at.x))
    away, rows = rest.knowledge(at.x)
    gradient, matrix = left.gradient + rows.T @ away, left.matrix + rows.T @ rows
    # (p,) to the minimum of the quadratic model; what would leave its bounds stops at them, and the others make up for it
    x = at.x
    low, high = rest.bounds
    step, moving = np.zeros(len(x)), np.ones(len(x), dtype=bool)
    for _ in range(len(x) + 1):
        force, N = gradient[moving] + matrix[np.ix_(moving, ~moving)] @ step[~moving], matrix[np.ix_(moving, moving)]
        scale = 1 / np.sqrt(np.maximum(np.diag(N), np.finfo(np.float64).tiny))
        step[moving] = -scale * np.linalg.solve(scale[:, None] * N * scale, scale * force)
        there = np.clip(x + step, low, high)
        beyond = moving & (there != x + step)
        if not beyond.any():
            break
        step[beyond] = there[beyond] - x[beyond]
        moving &= ~beyond
    # Its longest half from which the model does not break down: no body has every ten parameters. That is no matter of
    # frequency: one line of every data set tells it
    for _ in range(SHORTER):
        try:
            size = rest.size(x + step)
        except BREAKDOWNS:
            step = step / 2
        else:
            break
    else:
        step = np.zeros_like(step)
        size = rest.size(x)
    offsets = rest.offsets(x + step)
    if float(step @ matrix @ step) < (near * excess(left, size)) ** 2:
        return offsets
    cost = rest.holding({})
    try:  # with the data that are left; folds tell their number, not their share
        found = descent(cost, offsets, most=FEW)
    except CheckFailed:
        return offsets
    try:  # its last step is shorter than `CLOSE`, and nobody asks what that gains
        cost.size(found.x)
    except BREAKDOWNS:
        return cost.offsets(found.seen)
    return cost.offsets(found.x)


def evaluate(
    problem: Problem,
    *,
    hold_out: Sequence[str] = (),
    blocks: int = 0,
    parent: Evaluation | Fit | None = None,
    fitted: Fit | None = None,
    baseline: Fit | Evaluation | None = None,
    configurations: bool = True,
    near: float = NEAR,
    floor: float = PLAIN_FLOOR,
    progress: Progress | None = None,
) -> Evaluation:
    """The errors of a model.

    Without names each run of each data set is held out in turn, and of a series each configuration: all data are fitted, and
    every fold is predicted by a plain fit without it. What is named is held out of every fit.

    Parameters
    ----------
    hold_out : runs, data sets, configurations and facts that are predicted and never fitted
    blocks : so many blocks of frequency are held out in turn instead; 0 for none
    parent : evaluation of the model without its last effect, on the same data: no fit costs more than its own there. A `Fit` is
        that of all parameters
    fitted : the fit of all parameters, where it is known already; the plain one then begins there
    baseline : the same of a model without parent; there the plain one begins only if chance explains what is left. Or an
        `Evaluation` without configurations, which has both
    configurations : whether each configuration is held out in turn as well
    near : [sd] to which a fold takes the quadratic model at its word
    floor : model-error floor of the plain fit, coarser for a model of which it is known that more is missing
    progress : told the share of the work that is done, 0 to 1

    Raises
    ------
    BadInput : an unknown name in `hold_out`; too many `blocks`.
    CheckFailed : without some channel the others do not tell latent inputs.
    """
    tell = progress or (lambda share: None)
    apart = named(problem, hold_out) if hold_out else None
    thinned = problem.thinned()
    known = thinned if apart is None else without(thinned, apart)
    begun, before = (parent.fitted, parent.plain_fit) if isinstance(parent, Evaluation) else (parent, None)
    known_fit = baseline.fitted if isinstance(baseline, Evaluation) else baseline
    every = fitted or known_fit or fit(known, FITTED, start=begun, progress=lambda share: tell(0.5 * share))
    if isinstance(baseline, Evaluation):
        plain = baseline.plain_fit
    elif fitted is None and not (every.converged and every.sound):
        plain = fit(known, PLAIN, start=before, progress=lambda share: tell(0.5 + 0.25 * share))
    elif before is not None:
        plain = child(known, PLAIN, before, every.by_name)
    else:
        plain = nearby(known, PLAIN, every.by_name, floor=floor)
    offsets = {**problem.start, **plain.by_name}
    parts: list[tuple[Fold, Offsets]]
    if apart is not None:
        parts = [(apart, offsets)]
    else:
        turns = every_block(problem, blocks) if blocks else folds(problem)
        turns = tuple(one for one in turns if configurations or not one.configuration)
        whole_fit, parts = solved(thinned, plain, floor), []
        for done, fold in enumerate(turns):
            parts.append((fold, {**problem.start, **refitted(whole_fit, fold, near)}))
            tell(0.8 + 0.2 * (done + 1) / len(turns))
    runs = [part for part in parts if not part[0].configuration]
    whole = [part for part in parts if part[0].configuration]
    # As it was given, a model predicts the same whatever is held out
    given = AsGiven(problem=problem)
    return Evaluation(
        nominal=share([one for each in known.predictions for one in given.squares(each, None)]),
        plain=share([one for each in known.predictions for one in squares(each, offsets)]),
        held_out=_held_out(problem, runs),
        held_out_nominal=_held_out(problem, runs, given),
        plain_fit=plain,
        fitted=every,
        held_out_names=tuple(fold.name for fold, _ in parts),
        held_out_configurations=_held_out(problem, whole),
        held_out_configurations_nominal=_held_out(problem, whole, given),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class AsGiven:
    """A model as it was given, nothing fitted, which says the same whatever is held out.

    Attributes
    ----------
    problem : all data
    """

    problem: Problem
    _told: dict[tuple[str, tuple[str, ...]], list[Squares]] = field(default_factory=dict, init=False, repr=False)

    @cached_property
    def _said(self) -> dict[str, Predicted]:
        """By data set."""
        found = {}
        for one in self.problem.predictions:
            with suppress(*BREAKDOWNS):  # said where it is asked for
                found[one.measured.name] = one.at(self.problem.start, derivatives=False)
        return found

    def squares(self, prediction: Prediction, block: Lines | None, fold: str = "") -> list[Squares]:
        """Of every run of `prediction`, at the lines of a `block`, which nobody knows beforehand, or all that are told.

        Raises
        ------
        CheckFailed : as the function of that name.
        """
        of, predicted = prediction.measured, None
        if block is None and (of.name, of.runs) in self._told:
            return [replace(one, fold=fold) for one in self._told[of.name, of.runs]]
        if block is None and of.name in self._said:
            said = self._said[of.name]
            every = next(one.measured.runs for one in self.problem.predictions if one.measured.name == of.name)
            runs = [every.index(run) for run in of.runs]
            rows, noise = said.rows if said.rows.ndim == 3 else said.rows[runs], said.noise
            predicted = Predicted(rows=rows, noise=None if noise is None else noise[runs])
        found = squares(prediction, self.problem.start, block, fold=fold, predicted=predicted)
        if block is None:
            self._told[of.name, of.runs] = found
        return found


def _held_out(problem: Problem, parts: Sequence[tuple[Fold, Offsets]], given: AsGiven | None = None) -> Share | None:
    """The error on what every fold holds out, at its offsets, or of the model as it was `given`."""
    found = []
    for fold, offsets in parts:
        for prediction, block in held(problem, fold):
            if given is not None:
                found += given.squares(prediction, block, fold.name)
            else:
                found += squares(prediction, offsets, block, fold=fold.name)
    return share(found) if found else None
