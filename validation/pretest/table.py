"""The page of `massline pretest`: expected intervals, what dominates them, the price of every channel, rigid places."""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from geometry.arrays import Array
from validation.identifying.reported import Reported
from validation.pretest.findings import Findings
from validation.rows import NONE, rounded
from validation.statement import QUANTITIES
from validation.tables.grid import Grid, aligned

SHOWN_INPUTS = 2

ALL = slice(0, 7)
"""Mass, CoG, moments: products are left to the JSON."""

NOTHING = 1e-5
"""Elastic shares below it are not worth their digits."""

HUGE = 10.0
"""Elastic shares above it are a resonance; how high it is hangs on damping."""


def title(found: Findings) -> str:
    """Article, number of runs, band."""
    plan = found.question.plan
    low, high = plan.band
    return f"Pretest of {plan.article}: {len(found.spectra.runs)} runs ({plan.pattern}), {low:g} to {high:g} Hz"


def grids(found: Findings) -> list[Grid]:
    """All tables, in the order in which they are read."""
    further = [*([losses(found)] if found.without else []), *([places(found)] if found.places else [])]
    return [intervals(found), rests(found), *further]


def intervals(found: Findings) -> Grid:
    """Half-widths of the expected 95 % intervals: plain, self-calibrated, and that without a tare."""
    columns = [("plain", found.plain.half_width), ("self-calibrated", found.best.half_width)]
    columns += [] if found.untared is None else [("and without tare", found.untared)]
    labels = tuple(f"{q.label} [{q.unit}]" for q in QUANTITIES)
    values = aligned(tuple(_value(found, k) for k in range(10)))
    cells = [aligned(tuple(_half(found, half, k) for k in range(10))) for _, half in columns]
    header = ("expected ± 95 %", "value", *(name for name, _ in columns))
    return Grid(header=header, lines=tuple(zip(labels, values, *cells, strict=True)))


def _value(found: Findings, k: int) -> str:
    per_si = QUANTITIES[k].per_si
    value = found.best.values[k] * per_si
    return rounded(value if abs(value) > 1e-6 * per_si * _size(found, k) else 0.0, found.best.half_width[k] * per_si)


def _size(found: Findings, k: int) -> float:
    """Largest value of the kind of quantity `k`."""
    kind = slice(0, 1) if k == 0 else slice(1, 4) if k < 4 else slice(4, 10)
    return float(np.abs(found.best.values[kind]).max())


def _half(found: Findings, half: Array, k: int) -> str:
    """In the unit of the quantity, and in per cent where that says more."""
    per_si, value = QUANTITIES[k].per_si, abs(found.best.values[k])
    own = f"{half[k] * per_si:.2g}"
    relative = QUANTITIES[k].key.partition("_")[0] in ("mass", "moi") and value > 0
    return f"{own} ({100 * half[k] / value:.2g} %)" if relative else own


def rests(found: Findings) -> Grid:
    """What dominates the uncertainty of every value, by both ways."""
    lines = []
    for k, quantity in enumerate(QUANTITIES):
        said = [", ".join(_inputs(one, k)) or NONE for one in (found.plain, found.best)]
        lines.append((quantity.label, *said))
    width = max(len(line[1]) for line in lines)
    header = ("dominated by", f"{'plain':<{width}}", "self-calibrated")
    return Grid(header=header, lines=tuple((n, f"{a:<{width}}", b) for n, a, b in lines), words=True)


def _inputs(one: Reported, k: int) -> list[str]:
    return [f"{what} {100 * share:.0f} %" for what, share in one.dominating(k)[:SHOWN_INPUTS]]


def losses(found: Findings) -> Grid:
    """By how much intervals grow when a channel is lost, and what the plain way loses."""
    lines = []
    for name, half in found.without.items():
        growth = half / np.where(found.best.half_width > 0, found.best.half_width, 1.0)
        worst = {what: float(growth[kind].max()) for what, kind in _KINDS.items()}
        lines.append((name, *(f"{value:.2f}" for value in worst.values()), found.lost[name] or NONE))
    header = ("without", *(f"{what} ×" for what in _KINDS), "the plain way has then")
    return Grid(header=header, lines=tuple(lines), words=True)


_KINDS = {"mass": slice(0, 1), "CoG": slice(1, 4), "MoI": slice(4, 7)}


def places(found: Findings) -> Grid:
    """Rigid and elastic places."""
    limit = f"{100 * found.question.rigid:g} %"
    lines = []
    for one in found.places:
        up_to = "the whole band" if one.within == 1 else "nowhere" if one.up_to is None else f"{one.up_to:.2f} Hz"
        worst = NONE if one.largest == 0 else f"{one.axis} at {one.frequency:.2f} Hz"
        lines.append((one.name, f"{one.position[2]:.3f}", _share(one.at_start), _share(one.largest), up_to, worst))
    columns = list(zip(*lines, strict=True))
    return Grid(
        header=("pick-up at", "m above F", f"at {start_of(found):g} Hz", "at most", f"below {limit} up to", "largest in"),
        lines=tuple(zip(columns[0], *map(aligned, columns[1:4]), *columns[4:], strict=True)),
        words=True,
    )


def start_of(found: Findings) -> float:
    """[Hz] of the lowest line."""
    return float(found.spectra.frequency[0])


def _share(value: float) -> str:
    if 0 < value < NOTHING:
        return f"< {100 * NOTHING:g} %"
    return "resonance" if value > HUGE else f"{100 * value:.2g} %"


def notes(found: Findings) -> Iterator[str]:
    """What must be known to read the tables."""
    question, worst = found.question, int(np.argmax(found.condition))
    yield (
        f"Condition number of the base motions: median {np.median(found.condition):.3g}, at most {found.condition[worst]:.3g} at "
        f"{found.spectra.frequency[worst]:g} Hz; {int(np.sum(found.left_out))} of {len(found.condition)} lines above the limit "
        f"of {question.condition_limit:g}."
    )
    fmd = "" if question.above else " The FMD alone: its moving part is what is asked for."
    tared = f"tare {question.tare.article}" if question.tare else "no tare, the FMD known within its tolerance"
    yield f"Expected from the model and the planned chain, {tared}; CoG from the article's own origin.{fmd}"
    yield "Linearised at the drawn article with exact channels: what the model does not hold is in no interval."
    if found.places:
        yield (
            "Elastic motion: of a place relative to the base, over what a rigid article would do there; the largest of six axes. "
            f"{_height(found)} The cover plate counts as rigid."
        )
    yield from (f"warning: {words}." for words in found.warnings)


def _height(found: Findings) -> str:
    limit = f"below {100 * found.question.rigid:g} %"
    if found.rigid_height is None:
        return f"All of the article's axis stays {limit}."
    return f"Its axis stays {limit} up to {found.rigid_height:.3f} m above F."
