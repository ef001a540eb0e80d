"""What is to be thought of an effect that was added: is it worth a parameter, does it hold elsewhere, is it a fault at all."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from math import isfinite

import numpy as np

from geometry.frames import Array
from identification.quality import NORMAL_95
from validation.effects.catalogue import Named
from validation.effects.effect import evidence_threshold as worth_of
from validation.estimation.cost import cost_of
from validation.estimation.fit import floor_of
from validation.estimation.problem import EFFECT, IDENTIFIED, PLAIN, Parameter, Prediction, Problem
from validation.estimation.verdicts import ABSURD, costly
from validation.history.history import Errors, Version, VersionSize
from validation.prediction.series import SeriesPrediction

FALLS = 0.02
"""Share of an error by which it must change for us to say so."""


def is_worth_adding(rung: Version) -> bool:
    """Whether the evidence speaks for the effect of `rung`."""
    return rung.gain is not None and rung.gain > _asked(rung)


def _asked(rung: Version) -> float:
    """[nats] that the effect of `rung` must bring."""
    return worth_of(rung.effect.partition(":")[0])


def verdict(before: Version, after: Version, tolerances: Mapping[str, float], nulls: Mapping[str, float]) -> tuple[str, ...]:
    """Sentences about the effect that leads from `before` to `after`.

    Parameters
    ----------
    tolerances : by key of its sizes, what a careful laboratory or the model admits of it, one standard deviation; 0 for nothing
    nulls : by key, the size at which there is no effect
    """
    return tuple(_sentences(before, after, tolerances, nulls))


def _sentences(before: Version, after: Version, tolerances: Mapping[str, float], nulls: Mapping[str, float]) -> Iterator[str]:
    old, new = before.errors, after.errors
    if old is None or new is None:
        return
    if not (old.converged and new.converged):
        yield "A fit did not converge: none of these figures is the last word."
    if not all(body.converged for body in after.bodies):
        yield "The fit of the identified inertia did not converge: its figures are not the last word."
    gain = after.gain
    asked = _asked(after)
    if gain is None or not isfinite(gain):
        evidence: str = "Evidence cannot be compared: the rung before stands on other data."
    else:
        if gain > asked:
            evidence = f"It is worth a parameter: the evidence rises by {gain:.1f} nats, where {asked:g} are asked for."
        else:
            told = (
                f"the evidence {'falls' if gain < 0 else 'rises'} by {abs(gain):.1f} nats, where a rise of {asked:g} is asked for"
            )
            evidence = f"It is not worth a parameter: {told}."
    yield evidence
    yield f"The plain error {_change(old.plain, new.plain)} on the data it was fitted to."
    # The channel that gained most, where others hide it in the whole
    known = [name for name in new.by_channel if name in old.by_channel]
    gained = {name: old.by_channel[name] ** 2 - new.by_channel[name] ** 2 for name in known}
    best = max(gained, key=lambda name: gained[name], default="")
    if best and new.by_channel[best] < (1 - FALLS) * old.by_channel[best]:
        was, now = percent(old.by_channel[best]), percent(new.by_channel[best])
        yield f"Of its channels {best} gains most: {was} before and {now} after."
    yield from _held_out(old, new)
    for size in after.effects.get(after.effect, ()):
        yield from _size(size, tolerances.get(size.key, 0.0), nulls.get(size.key, 0.0))
    # Judged as `massline compare` judges it
    if new.tolerances and costly(new.tolerance_z2, new.due_z2, new.largest_z or 0.0):
        many = f"sum z² {new.tolerance_z2:.3g}, where about {new.due_z2:.0f} is due"
        most = "" if new.largest_z is None or new.largest_z < ABSURD else f", one of them at {new.largest_z:.1f} z"
        yield f"The tolerances still pay for it, {many}{most}: something else is wrong, however good chi² is."


def _held_out(old: Errors, new: Errors) -> Iterator[str]:
    if old.held_out is None or new.held_out is None:
        yield "Nothing was held out, so that nothing says whether it holds elsewhere."
        return
    yield f"It {_change(old.held_out, new.held_out)} on data that were held out."
    # What was held out and fell, and what rose, where it is not all of it
    known = [name for name in new.by_fold if name in old.by_fold]
    fell = [name for name in known if new.by_fold[name] < (1 - FALLS) * old.by_fold[name]]
    rose = [name for name in known if new.by_fold[name] > (1 + FALLS) * old.by_fold[name]]
    if rose and len(known) > 1:
        worst = max(rose, key=lambda name: new.by_fold[name] / old.by_fold[name])
        was, now = percent(old.by_fold[worst]), percent(new.by_fold[worst])
        told = f"{len(fell)} fell and {len(rose)} rose, most of all {worst}: {was} before and {now} after"
        yield f"Of {len(known)} that were held out in turn {told}."
    if new.plain < (1 - FALLS) * old.plain and new.held_out > (1 + FALLS) * old.held_out:
        yield "What it explains here it does not explain there: it fits the data, not the structure."


def _change(old: float, new: float) -> str:
    if new < (1 - FALLS) * old:
        return f"falls from {percent(old)} to {percent(new)}"
    if new > (1 + FALLS) * old:
        return f"rises from {percent(old)} to {percent(new)}"
    return f"does not fall ({percent(old)} before and {percent(new)} after)"


def _size(size: VersionSize, tolerance: float, null: float) -> Iterator[str]:
    name = f"Its {size.key}" if size.key else "Its size"
    if size.deviation is None:
        yield f"{name} was given, not fitted: {size.value:.4g}{unit(size.unit)}."
        return
    off, half = abs(size.value - null), NORMAL_95 * size.deviation
    told = f"{size.value:.4g} ± {half:.2g}{unit(size.unit)} (95 %)"
    admitted = f"within its tolerance of {tolerance:.2g}{unit(size.unit)}, one standard deviation"
    if size.deviation == 0:
        yield f"{name} ends at the bound of what its family allows, {size.value:.4g}{unit(size.unit)}: the data want it beyond."
    elif tolerance > 0 and off <= NORMAL_95 * tolerance:
        yield f"{name}, {told}, lies {admitted}: it is no fault."
    elif tolerance > 0 and off - half <= NORMAL_95 * tolerance:
        yield f"{name}, {told}, may yet lie {admitted}."
    elif off <= half:
        yield f"{name}, {told}, cannot be told from no effect."
    else:
        yield f"{name} is {told}."


def unit(of: str) -> str:
    """Behind a figure; a ratio has none."""
    return "" if of == "1" else f" {of}"


def percent(value: float | None) -> str:
    """An error with three digits."""
    return "–" if value is None else f"{value:.3g} %"


def sentence(text: str) -> str:
    """`text` with a capital and one full stop."""
    return f"{text[:1].upper()}{text[1:].rstrip('.')}."


# Whether the data can tell an effect from those that the model has already: the direction of the Fisher matrix says.
#
# Whitened derivatives of what the channels read, and of classical results, are the columns of J; N = J^T J is the Fisher matrix
# of these data. What is left of an effect's column when the columns of the others are projected out,
#
#     S_cc = N_cc - N_co N_oo^+ N_oc ,        share = S_cc / N_cc ,
#
# is what only it can explain. Where nothing is left, it and a mixture of the others, N_oo^+ N_oc of each, do the same to every
# channel at every line: no fit can share out a fault between them, knowledge beforehand does. Of an effect with several sizes it
# is the largest share over all their mixtures.


SAME_RESPONSE = 1e-6
"""Share of the square of what an effect does that others must leave to it: a thousandth of what it does to the channels."""

NOTICED = 1e-3
"""Standard deviations that a plausible fault must move all data together for the effect to act on them at all."""

TAKES_PART = 0.02
"""Share of what the effect does from which a member of the mixture is named."""

RANK = 1e-13
"""Relative singular value below which a direction of the others is itself none."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Alias:
    """An effect that others imitate.

    Attributes
    ----------
    id : of the effect
    share : of the square of what it does that only it can explain
    size : of the effect, in the unit of its first parameter, to which the mixture belongs
    unit : its unit
    mixture : by the names of the others, which size of each does the same, in `units`
    units : by name
    effects : those of the mixture that are effects of the model
    """

    id: str
    share: float
    size: float
    unit: str
    mixture: Mapping[str, float]
    units: Mapping[str, str]
    effects: tuple[str, ...]

    @property
    def text(self) -> str:
        """The direction in words."""
        same = ", ".join(f"{name} {_told(size, self.units[name])}" for name, size in self.mixture.items())
        return f"{self.id} {_told(self.size, self.unit)} does to these data what {same} does"


def _told(size: float, unit: str) -> str:
    return f"{size:+.3g}" if unit == "1" else f"{size:+.3g} {unit}"


def noticed(problem: Problem, names: Sequence[str]) -> float:
    """How many standard deviations a plausible fault in the parameters `names` moves all data together; 0 where none acts."""
    free = [one for one in problem.parameters if one.name in names]
    if not free:
        return 0.0
    N = _fisher(problem, free)
    scale = np.array([one.tolerance for one in free])
    return float(np.sqrt(np.linalg.eigvalsh(scale[:, None] * N * scale)[-1]))


def alias(problem: Problem, id: str, names: Sequence[str]) -> Alias | None:
    """The mixture of effects, and of what a laboratory must identify, that does what the parameters `names` of `id` do, if any.

    Derivatives are those where the model stands.
    """
    others = [one for one in problem.parameters if one.kind in (EFFECT, IDENTIFIED) and one.name not in names]
    own = [one for one in problem.parameters if one.name in names]
    if not own or not others:
        return None
    free = [*own, *others]
    matrix = _fisher(problem, free)
    scale = np.sqrt(np.maximum(np.diag(matrix), np.finfo(np.float64).tiny))
    N, c = matrix / np.outer(scale, scale), len(own)
    mixed = np.linalg.pinv(N[c:, c:], rcond=RANK, hermitian=True) @ N[c:, :c]
    # The largest share of `N[:c, :c]` (c, c) that is `N[:c, :c] - N[:c, c:] @ mixed`, and its direction (c,)
    values, vectors = np.linalg.eigh(N[:c, :c])
    kept = values > 1e-12 * values[-1]
    root = vectors[:, kept] / np.sqrt(values[kept])
    shares, directions = np.linalg.eigh(root.T @ (N[:c, :c] - N[:c, c:] @ mixed) @ root)
    share, direction = float(max(shares[-1], 0.0)), np.asarray(root @ directions[:, -1])
    if share > SAME_RESPONSE:
        return None
    return _told_apart(id, share, free, c, direction / scale[:c], (mixed @ direction) / scale[c:], mixed @ direction)


def _fisher(problem: Problem, free: Sequence[Parameter]) -> Array:
    """(p, p) of data and facts where the model stands, knowledge beforehand left out."""
    cost = cost_of(problem, free, floor_of(PLAIN))
    x = cost.at({})
    _, rows = cost.knowledge(x)
    facts = rows[len(rows) - len(problem.facts) :]
    return np.asarray(cost.data(x).matrix + facts.T @ facts)


def _told_apart(id: str, share: float, free: Sequence[Parameter], c: int, own: Array, mixed: Array, weight: Array) -> Alias:
    """The direction in the units of the parameters, at a tenth of a plausible fault of the effect."""
    first = int(np.argmax(np.abs(own) / [one.tolerance for one in free[:c]]))
    scale = 0.1 * free[first].tolerance / own[first]
    slope = [one.slope(one.start) for one in free]
    part = np.abs(weight) > TAKES_PART * np.abs(weight).max()
    named = {one.name: float(scale * mixed[k] * slope[c + k]) for k, one in enumerate(free[c:]) if part[k]}
    return Alias(
        id=id,
        share=share,
        size=float(scale * own[first] * slope[first]),
        unit=free[first].unit,
        mixture=named,
        units={one.name: one.unit for one in free},
        effects=tuple(one.name for one in free[c:] if one.kind == EFFECT and one.name in named),
    )


def freed(problem: Problem) -> Problem:
    """`problem` with every effect of its models free, those too whose size was given."""
    made: list[Prediction] = []
    for one in problem.predictions:
        made.append(
            one.with_effects(tuple(replace(each, fixed=False) for each in one.effects))
            if isinstance(one, SeriesPrediction)
            else one
        )
    return replace(problem, predictions=tuple(made))


def names_of(problem: Problem, named: Named) -> tuple[str, ...]:
    """The parameters of `problem` that are sizes of the effect `named`."""
    known = {named.id, *(f"{named.id}[{size.key}]" for size in named.sizes)}
    return tuple(one.name for one in problem.parameters if one.name in known and one.kind == EFFECT)
