"""What `massline excite` prints: runs, peak loads, resonances, load cells, and below them what must be known to read them."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

from fem.flexible_body.running import exudyn_version
from validation.excitation import words
from validation.excitation.asked import BURST, LARGE, LINEAR, MULTI, RANDOM, SWEEP
from validation.excitation.figures import Outcome, RingDown
from validation.excitation.runs import Ready, as_one_body
from validation.excitation.signals import LOAD_UNITS, LOADS
from validation.rows import NONE
from validation.tables.grid import Grid, aligned

UNITS = ("m/s²",) * 3 + ("rad/s²",) * 3

LEVEL = {
    SWEEP: "largest amplitude within the band",
    MULTI: "largest amplitude within the band, with what the other axes add",
    RANDOM: "root mean square over the whole drive, of the one asked for at full strength, between soft start and stop",
    BURST: "root mean square over the whole swell, of the one asked for in its middle",
}
"""What is compared with what was asked for, by pattern."""


def page_of(made: Ready, outcomes: Sequence[Outcome]) -> str:
    """All of it as text."""
    from validation.tables.text import page

    return page(f"{made.question.article}: driven in time, {made.route.name} route", grids(outcomes), notes(made, outcomes))


def grids(outcomes: Sequence[Outcome]) -> tuple[Grid, ...]:
    """The tables, from runs to cells; one without a line is left out."""
    return tuple(
        grid for grid in (runs(outcomes), loads(outcomes), resonances(outcomes), cells(outcomes), loose(outcomes)) if grid.lines
    )


def runs(outcomes: Sequence[Outcome]) -> Grid:
    """Duration, level and motion of every run."""
    lines = [
        (
            one.name,
            f"{one.duration:.1f}",
            "\n".join(f"{level.realised:.4g} of {level.asked:.4g} {UNITS[level.axis]}" for level in one.levels[:1]),
            f"{1e3 * one.small.angle:.3f}",
            f"{1e3 * one.small.rate:.2f}",
            f"{100 * one.small.left_out:.3f} of {100 * one.small.limit:g}",
            _ring_down(one.ring_down),
        )
        for one in outcomes
    ]
    header = ("run", "lasts [s]", "level", "turns [mrad]", "at [mrad/s]", "left out [%]", "ring-down")
    return Grid(header=header, lines=tuple(lines), words=True)


def loads(outcomes: Sequence[Outcome]) -> Grid:
    """The largest load of each kind."""
    header = ("peak load", *(f"{name} [{unit}]" for name, unit in zip(LOADS, LOAD_UNITS, strict=True)))
    lines = [(one.name, *(_significant(value) for value in one.peak_load)) for one in outcomes]
    columns = list(zip(*lines, strict=True))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def resonances(outcomes: Sequence[Outcome]) -> Grid:
    """Every resonance that was passed."""
    lines = [
        (
            one.name,
            str(p.mode),
            f"{p.frequency:.3f}",
            f"{100 * p.damping_ratio:.2f}",
            f"{p.time:.2f}",
            f"{p.amplification:.2f}",
            LOADS[p.axis],
            f"{p.peak_frequency:.3f}",
        )
        for one in outcomes
        for p in one.passed
    ]
    header = ("run", "mode", "f [Hz]", "ζ [%]", "passed at [s]", "times rigid", "seen in", "largest at [Hz]")
    return Grid(header=header, lines=tuple(lines))


def cells(outcomes: Sequence[Outcome]) -> Grid:
    """The extremes of every load cell."""
    lines = [
        (
            one.name,
            str(number),
            f"{cell.lowest:.1f}",
            f"{cell.highest:.1f}",
            f"{cell.lateral:.1f}",
            NONE if cell.preload is None else f"{cell.preload:g}",
            NONE if cell.preload is None else _share(cell.share_lifted),
        )
        for one in outcomes
        for number, cell in enumerate(one.cells, start=1)
    ]
    header = ("run", "cell", "z from [N]", "to [N]", "lateral up to [N]", "preload [N]", "lifts off")
    return Grid(header=header, lines=tuple(lines))


def loose(outcomes: Sequence[Outcome]) -> Grid:
    """How long every loose part slips."""
    lines = [
        (one.name, part.axis, f"{part.mass:g}", f"{part.slip_force:g}", _share(part.share_slipping))
        for one in outcomes
        for part in one.loose
    ]
    return Grid(header=("run", "loose along", "mass [kg]", "friction [N]", "slips"), lines=tuple(lines))


def notes(made: Ready, outcomes: Sequence[Outcome]) -> tuple[str, ...]:
    """What must be known to read the tables."""
    labels = [f"{one.name}: {one.label}." for one in outcomes]
    return (
        *labels,
        *words.rig(made.mounted, made.modes),
        *_how(made, outcomes),
        *_explained(made.question.drive.pattern, outcomes),
    )


def _how(made: Ready, outcomes: Sequence[Outcome]) -> Iterator[str]:
    question = made.question
    what = "exact recursion of its modes" if made.route.name == LINEAR else f"integration by exudyn {exudyn_version()}"
    if made.route.name == LARGE:
        own = "one rigid body" if as_one_body(made) else "exudyn's own bodies and beams"
        what = f"{what} of {own} on a base that turns, instead of the model above"
    step = outcomes[0].step
    yield (
        f"Route {made.route.name}, {made.route.why}: {what}, step {1e6 * step:.4g} µs; recorded at {question.rate:g} Hz "
        "behind one anti-alias filter."
    )
    if question.drive.cross:
        drawn = f"Cross motion of the table: {100 * question.drive.cross:g} % on average, seed {question.drive.seed}"
        largest = ", ".join(f"{100 * one.cross:.2g} % in {one.name}" for one in outcomes if one.cross)
        yield f"{drawn}; the largest on another axis, of the level driven: {largest}." if largest else f"{drawn}."


def _explained(pattern: str, outcomes: Sequence[Outcome]) -> Iterator[str]:
    yield (
        f"Level: {LEVEL[pattern]}. Turns: largest rotation of the table and its rate; left out is what linear equations neglect "
        "of the load for that, and their limit."
    )
    if any(one.cells for one in outcomes):
        yield "Cells: change of force, as simulated; behind the anti-alias filter what is too fast for the record is rounded off."
    if any(cell.preload is not None for one in outcomes for cell in one.cells):
        yield (
            "Preload: the whole force that presses a cell together, weight of the article included, which is not added to it. "
            "While open a cell pulls on with it, and keeps its shear."
        )
    if any(one.loose for one in outcomes):
        yield "Slips: share of the record, ring-down included, in which the friction of a loose part is at its limit."
    if any(one.passed for one in outcomes):
        yield (
            "Times rigid: the largest load near a resonance over M a at that moment; a fast sweep reaches it after passing, and "
            "less of it."
        )


def _ring_down(found: RingDown) -> str:
    if found.sufficient:
        return f"{found.kept:.1f} s, sufficient"
    return f"CUT: {found.kept:.1f} s of {found.needed:.1f} s needed"


def _share(share: float) -> str:
    return f"{100 * share:.2g} % of the time" if share else "never"


def _significant(value: float) -> str:
    return f"{value:.1f}" if value >= 100 else f"{value:.3f}"
