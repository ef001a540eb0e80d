"""What `massline swing` prints: the period beside Eq. 5's, the shifts by cause, the reduced inertia beside the true one."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path
from typing import Any

import numpy as np

from validation.swing.record import MEASUREMENT, RECORD
from validation.swing.shifts import Simulated
from validation.tables.grid import Grid, aligned
from validation.tables.text import page

WHY = {
    "amplitude": "taken off, its size stated",
    "damping": "taken off, its size from the record",
    "rope-mass": "taken off, its size stated; {links} links a rope stand for a uniform one",
    "rope-stretch": "not known to Eq. 5: it would be, were the length measured with the article on the ropes",
    "off-centre": "not known to Eq. 5: s1 and s2, or the radius, are not what they are thought to be",
    "unequal ropes": "not known to Eq. 5",
}
"""What the reduction does about each effect."""


def text(found: Simulated) -> str:
    """The page for a reader."""
    setup = found.record.setup
    title = f"{setup.article} on {setup.suspension.ropes} ropes, axis {setup.axis} upright: simulated by exudyn"
    return page(title, [_periods(found), _shifts(found), _inertias(found)], notes(found))


def as_json(found: Simulated, folder: Path | None) -> dict[str, Any]:
    """The same for a program."""
    record, setup = found.record, found.record.setup
    return {
        "article": setup.article,
        "axis": setup.axis,
        "ropes": setup.suspension.ropes,
        "mass_kg": setup.inertia.mass,
        "period_s": record.period,
        "period_eq5_s": setup.ideal_period,
        "period_small_s": record.swing.small_period,
        "damping_ratio": float(record.decay.damping_ratio.nominal_value),
        "amplitude_rms_rad": record.decay.amplitude,
        "cycles": record.decay.cycles,
        "period_shift_percent": {s.name: 100 * s.period for s in found.shifts} | {"all": 100 * record.shift},
        "moi_kgm2": {"reference": setup.reference, "eq5": record.plain, "corrected": record.corrected},
        "moi_error_percent": {"eq5": 100 * found.plain, "corrected": 100 * found.corrected},
        "corrections_percent": {name: 100 * part for name, part in record.effects.items()},
        "settings": dict(record.swing.settings),
        "files": [] if folder is None else [str(folder / RECORD), str(folder / MEASUREMENT)],
        "notes": [*notes(found)],
    }


def notes(found: Simulated) -> tuple[str, ...]:
    """What the figures do not say by themselves, sentences."""
    setup, swing = found.record.setup, found.record.swing
    s, tensor = setup.suspension, setup.inertia.tensor_cog
    tilt = float(np.abs(tensor[2, :2]).max() / tensor[2, 2])
    said = {
        f"The body is let go at rest from a twist of {s.amplitude:.4g} rad.": s.start == "twist",
        f"The body is pushed about the vertical out of its equilibrium, so that it swings to {s.amplitude:.4g} rad.": s.start
        == "push",
        f"Exudyn {swing.settings['version']}, {swing.settings['method']}, "
        f"{swing.settings['steps_per_period']:.0f} steps a period. "
        "The method's own share of the period is 3e-6 at 1000, and falls with the square.": True,
        f"The vertical is no principal axis (product {tilt:.1%} of the moment): the twist drags a tilt along.": tilt > PRODUCT,
        "On two ropes at s1 != s2 the amplitude's correction is an approximation.": len(set(setup.radii)) == 2,
    }
    return (*(sentence for sentence, true in said.items() if true), *found.record.decay.notes, *swing.warnings)


PRODUCT = 1e-3
"""Product of inertia, relative to the moment, that is worth a word."""


def _periods(found: Simulated) -> Grid:
    record, setup = found.record, found.record.setup
    small = record.swing.small_period
    lines = [
        ("by Eq. 5 from the inertia", f"{setup.ideal_period:.6f}", ""),
        ("small swings, by statics", f"{small:.6f}", _percent(small / setup.ideal_period - 1)),
        (f"recorded, {record.decay.cycles:.1f} cycles", f"{record.period:.6f}", _percent(record.shift)),
    ]
    return Grid(header=("period", "T [s]", "from Eq. 5 [%]"), lines=_columns(lines))


def _shifts(found: Simulated) -> Grid:
    links = found.record.setup.suspension.links
    lines = [
        (s.name, _percent(s.period), _percent(s.plain), _percent(s.corrected), WHY[s.name].format(links=links))
        for s in found.shifts
    ]
    lines.append(("all together", _percent(found.record.shift), _percent(found.plain), _percent(found.corrected), "the record"))
    header = ("effect alone", "period [%]", "inertia by Eq. 5 [%]", "corrected [%]", "what the reduction does")
    return Grid(header=header, lines=_columns(lines, words=True), words=True)


def _inertias(found: Simulated) -> Grid:
    record, setup = found.record, found.record.setup
    rows = (("simulated body", setup.reference), ("Eq. 5 alone", record.plain), ("with corrections", record.corrected))
    lines = [(name, f"{value:.6g}", _percent(value / setup.reference - 1)) for name, value in rows]
    return Grid(header=("moment of inertia", f"Θ{2 * setup.axis} [kg m²]", "error [%]"), lines=_columns(lines))


def _percent(share: float) -> str:
    return f"{100 * share:+.4f}"


def _columns(lines: Sequence[tuple[str, ...]], *, words: bool = False) -> tuple[tuple[str, ...], ...]:
    columns = list(zip(*lines, strict=True))
    last = len(columns) - 1 if words else len(columns)
    shown = [columns[0], *map(aligned, columns[1:last]), *columns[last:]]
    return tuple(zip(*shown, strict=True))
