"""Two models side by side: frequencies, MAC, effective masses, and in words where they part."""

from __future__ import annotations

from typing import Any

import numpy as np

from validation.flexible.bodies import another_body
from validation.flexible.mode_comparison import ALIKE, APART, Comparison
from validation.flexible.modes_table import AXES, DECIMALS, NOTHING, UNITS, words
from validation.rows import NONE
from validation.tables.grid import Grid, aligned, number

SHOWN = 12
"""Modes of a printed MAC matrix; all of it is in the JSON."""


def grids(found: Comparison) -> tuple[Grid, ...]:
    """Frequencies with MAC, the MAC matrix, and the effective masses."""
    return _frequencies(found), *([_matrix(found)] if found.mac.size else []), _masses(found)


def notes(found: Comparison) -> tuple[str, ...]:
    """Whether the bodies are the same, where the models part, and what must be known to read the tables."""
    if not found.mac.size:
        return *_said(found), "Matched in ascending order: a model without shapes on this article's points has no MAC."
    return (
        *_said(found),
        "MAC: share of a mode's kinetic energy that moves as the other model says. In a cluster of close frequencies shapes mix "
        "at will; there `space` is the same for the direction that the two clusters have least in common.",
    )


def _said(found: Comparison) -> tuple[str, ...]:
    return tuple(filter(None, (another_body(found.first, found.second), where_they_part(found))))


def where_they_part(found: Comparison) -> str:
    """One sentence."""
    names = f"{found.second.model} and {found.first.model}"
    parted = found.parted
    if not len(parted):
        worst = int(np.nanargmax(np.abs(found.difference)))
        return (
            f"{names} agree in all {len(found.partner)} modes: frequencies within {100 * APART:g} % "
            f"(mode {worst + 1} differs most, by {_percent(found.difference[worst])})"
            + (f", shapes alike (MAC at least {ALIKE:g})." if found.mac.size else ".")
        )
    said = words(found.first)
    listed = "; ".join(f"mode {k + 1}{_how(found, int(k))}" + (f" ({said[k].text})" if said[k].text else "") for k in parted[:5])
    more = f"; and {len(parted) - 5} more" if len(parted) > 5 else ""
    return f"{names} part in {len(parted)} of {len(found.partner)} modes: {listed}{more}."


def _how(found: Comparison, k: int) -> str:
    if found.partner[k] < 0:
        return " has no partner"
    how = [f" by {_percent(found.difference[k])}"] if abs(found.difference[k]) > APART else []
    how += [f" in shape, MAC {found.space[k]:.2f}"] if found.space[k] < ALIKE else []
    return " and".join(how)


def _percent(share: float) -> str:
    return f"{100 * share:+.3g} %".replace("-", "−")


def _frequencies(found: Comparison) -> Grid:
    f, g = found.first.modes.frequency, found.second.modes.frequency
    lines = []
    for k, other in enumerate(found.partner):
        alone = np.sum(found.cluster == found.cluster[k]) == 1
        mac = f"{found.mac[k, other]:.3f}" if found.mac.size else NONE
        theirs = (str(other + 1), f"{g[other]:.3f}", _percent(found.difference[k]), mac)
        told = theirs if other >= 0 else 4 * (NONE,)
        lines.append(
            (str(k + 1), f"{f[k]:.3f}", *told, NONE if alone or other < 0 or not found.mac.size else f"{found.space[k]:.3f}")
        )
    columns = list(zip(*lines, strict=True))
    first, second = found.first.model, found.second.model
    header = (f"{first} mode", "f [Hz]", f"{second} mode", "f [Hz]", "difference", "MAC", "space")
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def _matrix(found: Comparison) -> Grid:
    rows, columns = (min(SHOWN, size) for size in found.mac.shape)
    cells = [[f"{value:.2f}" if value >= 0.005 else "·" for value in row[:columns]] for row in found.mac[:rows]]
    lines = tuple((f"{found.first.model} {i + 1}", *row) for i, row in enumerate(cells))
    return Grid(header=(f"MAC with {found.second.model}", *(str(j + 1) for j in range(columns))), lines=lines)


def _masses(found: Comparison) -> Grid:
    """Effective masses of both, one below the other."""
    rigid = np.diag(found.first.modes.rigid_mass)
    a, b = found.first.modes.effective_mass, found.second.modes.effective_mass
    lines = []
    for k, other in enumerate(found.partner):
        for name, index, mass in ((found.first.model, k, a[k]), (found.second.model, other, b[other])):
            if index >= 0:
                shown = (number(m, DECIMALS) if m > NOTHING * whole else "0" for m, whole in zip(mass, rigid, strict=True))
                lines.append((f"{name} {index + 1}", *shown))
    columns = list(zip(*lines, strict=True))
    header = ("effective mass", *(f"{axis} [{unit}]" for axis, unit in zip(AXES, UNITS, strict=True)))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def as_json(found: Comparison) -> dict[str, Any]:
    """What `massline modes --against --json` says beyond the first model."""
    return {
        "model": found.second.model,
        "frequency_hz": found.second.modes.frequency.tolist(),
        "effective_mass": found.second.modes.effective_mass.tolist(),
        "partner": [None if k < 0 else int(k) for k in found.partner],
        "difference_percent": [None if np.isnan(d) else 100 * float(d) for d in found.difference],
        "mac": found.mac.tolist(),
        "cluster": found.cluster.tolist(),
        "mac_of_space": found.space.tolist() if found.mac.size else None,
        "text": " ".join(_said(found)),
    }
