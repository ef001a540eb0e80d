"""What the limit of small motion costs: exudyn turns the table for real, and the linear equations are held against it.

    python examples/large_motion.py [ARTICLE ...]

Every article is driven by a sine at 4 Hz, where the angles of the paper's tests are largest, at 1, 3, 10 and 30 times the
nominal levels: about one axis, along and about an axis at once, about all three. The table shows what share of the load the
linear equations leave out, and with which power of the level it grows. An article called NAME:rigid is taken as one rigid body.
"""

from __future__ import annotations

import sys
from collections.abc import Sequence

from rich.console import Console
from rich.table import Table

from fem.base_excitation.response import LIMIT
from fem.exudyn import large_motion
from fem.exudyn.large_motion import Cost, plan_of
from validation.output import counted

ARTICLES = ("cuboid:rigid", "clumod-1:rigid", "clumod-1")
DRIVEN = (("alpha",), ("beta",), ("gamma",), ("x", "gamma"), ("alpha", "beta", "gamma"))
COARSE = 1
"""Elements in a half-blade; the share that is left out does not ask for more."""
NOTHING = 1e-9
"""Share that is rounding: about an axis through the CoG a balanced body pulls at nothing."""


def studied(name: str, driven: Sequence[str]) -> tuple[Cost, ...]:
    """The costs of one article driven along and about the axes `driven`."""
    article, _, rigid = name.partition(":")
    return large_motion.of_a_sine(plan_of(article, elements=None if rigid else COARSE), driven)


def table(names: Sequence[str], driven: Sequence[Sequence[str]]) -> Table:
    shown = Table(title="Share of the load that the linear equations leave out, sine at 4 Hz")
    for column in ("article", "driven", "level", "angle [mrad]", "rate [rad/s]", "peak", "rms", "at 4 Hz"):
        shown.add_column(column, justify="left" if column in ("article", "driven") else "right", no_wrap=True)
    for name in names:
        listed = {" + ".join(axes): axes for axes in driven}
        for words in counted(listed, f"Driving {name} along and about"):
            _add(shown, name, words, studied(name, listed[words]))
    return shown


def sweeps(name: str) -> str:
    """What the spectrum of a whole sweep leaves out, at nominal level."""
    article = plan_of(name.partition(":")[0])
    worst = {}
    for axis in ("alpha", "beta", "gamma"):
        found = large_motion.of_a_sweep(article, axis)
        line, share = found[found[:, 1].argmax()]
        worst[axis] = f"{axis} {share:.2%} at {line:.1f} Hz"
    return f"In the spectrum of a whole sweep of {name} at nominal level, at most: {', '.join(worst.values())}."


def _add(shown: Table, name: str, driven: str, costs: Sequence[Cost]) -> None:
    for each in costs:
        shares = [_share(x) for x in (each.peak, each.rms, each.at_line)]
        shown.add_row(name, driven, f"{each.factor:g}", f"{1e3 * each.angle:.1f}", f"{each.rate:.3g}", *shares)
    grown = large_motion.exponents(costs)
    powers = ["" if getattr(costs[0], x) < NOTHING else f"^{grown[x]:.1f}" for x in ("peak", "rms", "at_line")]
    shown.add_row("", "grows with level", "", "", "", *powers, end_section=True)


def _share(value: float) -> str:
    return "none" if value < NOTHING else f"{value:.2e}"


def main(console: Console, names: Sequence[str] = ARTICLES, driven: Sequence[Sequence[str]] = DRIVEN) -> None:
    console.print(table(names, driven))
    console.print(sweeps(names[0]))
    console.print(f"The limit of small motion, omega² / omega' and the angle below {LIMIT:g}, bounds the peak.")


if __name__ == "__main__":
    main(Console(), sys.argv[1:] or ARTICLES)
