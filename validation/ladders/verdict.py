"""What is to be thought of an effect that was added: is it worth a parameter, does it hold elsewhere, is it a fault at all."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from math import isfinite

from identification.quality import NORMAL_95
from validation.comparing.verdicts import ABSURD, costly
from validation.effects.worth import worth as worth_of
from validation.ladders.nouns import Errors, Rung, Size

FALLS = 0.02
"""Share of an error by which it must change for us to say so."""


def worth(rung: Rung) -> bool:
    """Whether the evidence speaks for the effect of `rung`."""
    return rung.gain is not None and rung.gain > _asked(rung)


def _asked(rung: Rung) -> float:
    """[nats] that the effect of `rung` must bring."""
    return worth_of(rung.effect.partition(":")[0])


def verdict(before: Rung, after: Rung, tolerances: Mapping[str, float], nulls: Mapping[str, float]) -> tuple[str, ...]:
    """Sentences about the effect that leads from `before` to `after`.

    Parameters
    ----------
    tolerances : by key of its sizes, what a careful laboratory or the model admits of it, one standard deviation; 0 for nothing
    nulls : by key, the size at which there is no effect
    """
    return tuple(_sentences(before, after, tolerances, nulls))


def _sentences(before: Rung, after: Rung, tolerances: Mapping[str, float], nulls: Mapping[str, float]) -> Iterator[str]:
    old, new = before.errors, after.errors
    if old is None or new is None:
        return
    if not (old.converged and new.converged):
        yield "A fit did not converge: none of these figures is the last word."
    if not all(body.converged for body in after.bodies):
        yield "The fit of the identified inertia did not converge: its figures are not the last word."
    yield _evidence(after.gain, _asked(after))
    yield _fall(old, new)
    yield from _most(old, new)
    yield from _held_out(old, new)
    for size in after.effects.get(after.effect, ()):
        yield from _size(size, tolerances.get(size.key, 0.0), nulls.get(size.key, 0.0))
    yield from _price(new)


def _evidence(gain: float | None, asked: float) -> str:
    if gain is None or not isfinite(gain):
        return "Evidence cannot be compared: the rung before stands on other data."
    if gain > asked:
        return f"It is worth a parameter: the evidence rises by {gain:.1f} nats, where {asked:g} are asked for."
    told = f"the evidence {'falls' if gain < 0 else 'rises'} by {abs(gain):.1f} nats, where a rise of {asked:g} is asked for"
    return f"It is not worth a parameter: {told}."


def _fall(old: Errors, new: Errors) -> str:
    return f"The plain error {_change(old.plain, new.plain)} on the data it was fitted to."


def _most(old: Errors, new: Errors) -> Iterator[str]:
    """The channel that gained most, where others hide it in the whole."""
    known = [name for name in new.by_channel if name in old.by_channel]
    gained = {name: old.by_channel[name] ** 2 - new.by_channel[name] ** 2 for name in known}
    best = max(gained, key=lambda name: gained[name], default="")
    if best and new.by_channel[best] < (1 - FALLS) * old.by_channel[best]:
        was, now = percent(old.by_channel[best]), percent(new.by_channel[best])
        yield f"Of its channels {best} gains most: {was} before and {now} after."


def _held_out(old: Errors, new: Errors) -> Iterator[str]:
    if old.held_out is None or new.held_out is None:
        yield "Nothing was held out, so that nothing says whether it holds elsewhere."
        return
    yield f"It {_change(old.held_out, new.held_out)} on data that were held out."
    yield from _by_fold(old, new)
    if new.plain < (1 - FALLS) * old.plain and new.held_out > (1 + FALLS) * old.held_out:
        yield "What it explains here it does not explain there: it fits the data, not the structure."


def _by_fold(old: Errors, new: Errors) -> Iterator[str]:
    """What was held out and fell, and what rose, where it is not all of it."""
    known = [name for name in new.by_fold if name in old.by_fold]
    fell = [name for name in known if new.by_fold[name] < (1 - FALLS) * old.by_fold[name]]
    rose = [name for name in known if new.by_fold[name] > (1 + FALLS) * old.by_fold[name]]
    if rose and len(known) > 1:
        worst = max(rose, key=lambda name: new.by_fold[name] / old.by_fold[name])
        was, now = percent(old.by_fold[worst]), percent(new.by_fold[worst])
        told = f"{len(fell)} fell and {len(rose)} rose, most of all {worst}: {was} before and {now} after"
        yield f"Of {len(known)} that were held out in turn {told}."


def _change(old: float, new: float) -> str:
    if new < (1 - FALLS) * old:
        return f"falls from {percent(old)} to {percent(new)}"
    if new > (1 + FALLS) * old:
        return f"rises from {percent(old)} to {percent(new)}"
    return f"does not fall ({percent(old)} before and {percent(new)} after)"


def _size(size: Size, tolerance: float, null: float) -> Iterator[str]:
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


def _price(new: Errors) -> Iterator[str]:
    """Judged as `massline compare` judges it."""
    if new.tolerances and costly(new.tolerance_z2, new.due_z2, new.largest_z or 0.0):
        many = f"sum z² {new.tolerance_z2:.3g}, where about {new.due_z2:.0f} is due"
        most = "" if new.largest_z is None or new.largest_z < ABSURD else f", one of them at {new.largest_z:.1f} z"
        yield f"The tolerances still pay for it, {many}{most}: something else is wrong, however good chi² is."


def unit(of: str) -> str:
    """Behind a figure; a ratio has none."""
    return "" if of == "1" else f" {of}"


def percent(value: float | None) -> str:
    """An error with three digits."""
    return "–" if value is None else f"{value:.3g} %"


def sentence(text: str) -> str:
    """`text` with a capital and one full stop."""
    return f"{text[:1].upper()}{text[1:].rstrip('.')}."
