"""The page of `massline identify`: both results side by side, what each parameter rests on, elastic terms, what was left out."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from geometry.dynamic_mass import MOTIONS
from geometry.inertia import PARAMETERS
from identification import classical
from identification.closed_checks import Finding
from identification.cross_motion import CrossMotion
from identification.elastic.terms import ElasticTerms
from identification.losing_a_sensor import Loss
from validation.identifying.findings import Findings, Lines
from validation.identifying.known import takes_fmd_off
from validation.identifying.reported import Reported
from validation.rows import NONE, rounded
from validation.statement import QUANTITIES
from validation.tables.grid import Grid, aligned

ORIGINS = {"article": "the article's own origin", "F": "F, the centre of the force-measuring plane"}

WORTH = 0.1
"""Share of the variance from which a second input is named."""


def title(found: Findings) -> str:
    """Article, number of runs, band."""
    low, high = found.result.identified.band
    count = len(found.request.campaign.runs)
    return f"{found.article}: identified from {count} runs, {low:g} to {high:g} Hz"


def grids(found: Findings) -> list[Grid]:
    """All tables, in the order in which they are read."""
    elastic = found.result.identified.elastic
    return [
        *([doubts(found.doubts)] if found.doubts else []),
        values(found),
        verdicts(found),
        *([modes(elastic)] if elastic is not None and len(elastic.frequency) else []),
        *([single_axis(found.crossed)] if found.crossed is not None else []),
    ]


def doubts(said: tuple[str, ...]) -> Grid:
    """What stands above every figure: why none of them is to be trusted."""
    lines = tuple((str(k), text) for k, text in enumerate(said, start=1))
    return Grid(header=("", "the data contradict themselves: do not trust these figures"), lines=lines, words=True)


def values(found: Findings) -> Grid:
    """Mass, CoG, moments and products of both ways with their 95 % intervals, and how far the second lies from the first."""
    ways = [one.identified.way for one in found.results]
    columns = [aligned(tuple(_value(one, k) for k in range(10))) for one in found.results]
    if len(found.results) > 1:
        ways += ["moved by", "half-widths"]
        moved = [_moved(found.results[0], found.results[-1], k) for k in range(10)]
        columns += [aligned(cells) for cells in zip(*moved, strict=True)]
    return Grid(header=("± 95 %", *ways), lines=tuple(zip(_labels(), *columns, strict=True)))


def _moved(plain: Reported, better: Reported, k: int) -> tuple[str, str]:
    """By how much quantity `k` lies elsewhere in the better result: in its unit or in per cent, and in plain half-widths."""
    moved, width, scale = float(better.values[k] - plain.values[k]), float(plain.half_width[k]), QUANTITIES[k].per_si
    finest = min(width, float(better.half_width[k])) * scale
    relative = plain.values[k] != 0 and QUANTITIES[k].key.partition("_")[0] in ("mass", "moi")
    own = f"{100 * moved / abs(plain.values[k]):+.2f} %" if relative else f"{rounded(moved * scale, finest)} "
    return own.rstrip() if relative else f"{own}{QUANTITIES[k].unit}", f"{moved / width:+.2f}" if width else NONE


def verdicts(found: Findings) -> Grid:
    """What is to be thought of every value, and what its uncertainty comes from."""
    lines = []
    for k, (quantity, name) in enumerate(zip(QUANTITIES, classical.QUANTITIES, strict=True)):
        said = found.verdict.get(name, NONE)
        second = _next(found.result.dominating(k)) if "of the variance" in said else ""
        lines.append((quantity.label, said + second))
    return Grid(header=("", f"verdict on the {found.result.identified.way} result"), lines=tuple(lines), words=True)


def _next(inputs: tuple[tuple[str, float], ...]) -> str:
    """The input behind the one that dominates, where it matters."""
    return f"; then {inputs[1][0]} {100 * inputs[1][1]:.0f} %" if len(inputs) > 1 and inputs[1][1] > WORTH else ""


def single_axis(crossed: CrossMotion) -> Grid:
    """What the quotient of the driven axis alone would have cost."""
    lines = [
        (axis, *(f"{100 * share:.2g} %" for share in shares))
        for axis, *shares in zip(MOTIONS, crossed.cross_motion, crossed.diagonal, crossed.column, strict=True)
    ]
    return Grid(header=("Eq. 8a alone", "other axes move", "off on the diagonal", "off beside it, up to"), lines=tuple(lines))


def modes(terms: ElasticTerms) -> Grid:
    """Elastic terms: frequency, damping, and the axis that each shows on most, with its effective mass."""
    lines = []
    for r in np.argsort(terms.frequency):
        f, zeta, L = terms.frequency[r], terms.damping_ratio[r], terms.participation[r]
        most = sorted(range(6), key=lambda k: -_weight(L, k))[:2]
        shown = ", ".join(f"{MOTIONS[k]} {L[k] ** 2:.3g} {'kg' if k < 3 else 'kg m²'}" for k in most)
        lines.append((f"{f:.3f}", f"{100 * zeta:.3f}", shown))
    columns = list(zip(*lines, strict=True))
    return Grid(
        header=("elastic terms [Hz]", "damping [%]", "effective mass about F"),
        lines=tuple(zip(*map(aligned, columns[:2]), columns[2], strict=True)),
        words=True,
    )


def _weight(participation: np.ndarray, k: int) -> float:
    """Effective mass along axis `k`, rotations weighed as at a lever of half a metre."""
    return float(participation[k] ** 2) * (1.0 if k < 3 else 4.0)


def notes(found: Findings) -> Iterator[str]:
    """What must be known to read the tables, then what was left out, checked and warned of."""
    where = ORIGINS[found.origin] if found.frame is None else f"your own frame, seen from {ORIGINS[found.origin]}"
    yield f"CoG from {where}. Moments and products about the CoG; products are matrix entries, Θxy = -∫xy dm."
    yield _method(found)
    for one in found.results:
        yield _fit(one)
    yield from _bootstrap(found.result)
    if found.lines is not None:
        yield from _left_out(found.lines)
    yield from _checked(found.checks)
    yield from _lost(found.losses)
    yield from _gained(found.result)
    yield from (f"warning: {words}." for words in found.warnings)


def _method(found: Findings) -> str:
    tares = ", ".join(tare.campaign.article for tare in found.request.tares)
    facts = dict.fromkeys(fact.source for fact in found.request.facts)
    told = f"tare {tares}" if tares else "the FMD as stated" if found.request.fmd is not None else "no tare"
    taken = told if takes_fmd_off(found.request) else f"{told}, so the FMD's moving part is in the result"
    method = found.request.method if found.spectra is None else found.spectra.method
    made = "as the files hold them" if method == "spectra" else method
    if tares and not takes_fmd_off(found.request):
        taken = f"tare {tares} on other hardware, which takes no FMD off: its moving part is in the result"
    return f"Spectra: {made}; {taken}{'; data of ' + ', '.join(facts) if facts else ''}."


def _fit(one: Reported) -> str:
    found = one.identified
    terms = 0 if found.elastic is None else len(found.elastic.frequency)
    misfit = "" if np.isnan(found.misfit) else f", chi² per degree of freedom {found.misfit:.3g}"
    surprise = f", sum z² of {found.tolerances} tolerances {found.surprise:.3g}" if found.surprise else ""
    stopped = "" if found.converged else "; it did not converge"
    by_spectra = "" if found.raw is None else f"; from raw spectra instead of H the mass is {found.raw[0]:.5g} kg"
    return f"{found.way[0].upper()}{found.way[1:]}: {terms} elastic terms{misfit}{surprise}{stopped}{by_spectra}."


def _bootstrap(one: Reported) -> Iterator[str]:
    """Whether the interval would be another one were lines not taken for independent."""
    if one.quality.bootstrap:
        ratios = [one.quality.bootstrap[name] for name in classical.QUANTITIES]
        low, high = min(ratios), max(ratios)
        yield f"Block bootstrap of the lines: standard deviations {low:.2f} to {high:.2f} times those of the intervals."


def _left_out(lines: Lines) -> Iterator[str]:
    worst = int(np.argmax(lines.condition))
    yield (
        f"Lines: {int(np.sum(lines.kept))} of {len(lines.frequency)} used; condition number at most "
        f"{lines.condition[worst]:.3g}, at {lines.frequency[worst]:g} Hz; the limit is {lines.limit:g}."
    )
    yield from (f"left out: {reason}." for reason in lines.reasons)


def _checked(checks: tuple[Finding, ...]) -> Iterator[str]:
    """What does not hold, each in a sentence; what holds, together in one."""
    yield from (f"check: {one.text}." for one in checks if not one.holds)
    if sound := [one.name for one in checks if one.holds]:
        yield f"Closed checks that hold: {', '.join(sound)}."


def _lost(losses: tuple[Loss, ...]) -> Iterator[str]:
    """The accelerometers that nothing stands in for, or else the one whose absence moves the base motion most."""
    alone = [one for one in losses if one.lost]
    if alone:
        yield from (f"Losing a sensor: {one.text}." for one in alone)
    elif losses:
        yield f"Losing a sensor: {max(losses, key=lambda one: one.moved.max()).text}."


def _gained(one: Reported) -> Iterator[str]:
    """What every classical result was good for: the parameter whose interval it narrows most."""
    for name, times in one.identified.gained.items():
        k = int(np.argmax(times))
        yield f"Without {name} the interval of {PARAMETERS[k]} would be {times[k]:.3g} times as wide."


def _labels() -> tuple[str, ...]:
    return tuple(f"{q.label} [{q.unit}]" for q in QUANTITIES)


def _value(one: Reported, k: int) -> str:
    scale = QUANTITIES[k].per_si
    value, half = float(one.values[k]) * scale, float(one.half_width[k]) * scale
    return f"{rounded(value, half)} ± {rounded(half, half)}" if half else rounded(value, None)
