"""The tables of `massline dynamic-mass`: diagonal magnitudes at a few lines, the peaks, two models side by side; and the JSON."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.dynamic_mass import DynamicMass
from validation.flexible.dynamic_mass import Apart
from validation.flexible.model import Flexible
from validation.flexible.modes_table import AXES, UNITS
from validation.rows import NONE
from validation.tables.grid import Grid, aligned, number

SHOWN_LINES = 8
DECIMALS = 3

PROMINENCE = 0.05
"""Decades by which a peak must stand out on both sides to be listed."""


@dataclass(frozen=True, kw_only=True)
class Peak:
    """A maximum of one diagonal entry.

    Attributes
    ----------
    axis : index of the entry
    frequency : of the line [Hz]
    magnitude : |H| there [kg, kg m²]
    amplification : over the rigid body's [1]
    """

    axis: int
    frequency: float
    magnitude: float
    amplification: float


def peaks(H: DynamicMass, rigid: Array) -> tuple[Peak, ...]:
    """The maxima of the diagonal of `H` by axis and frequency; `rigid` (6,) is the diagonal of the rigid body."""
    from scipy.signal import find_peaks

    found = []
    for axis in range(6):
        size = np.abs(H.matrix[:, axis, axis])
        for k in find_peaks(np.log10(np.maximum(size, 1e-300)), prominence=PROMINENCE)[0]:
            found.append(
                Peak(
                    axis=axis,
                    frequency=float(H.frequency[k]),
                    magnitude=float(size[k]),
                    amplification=float(size[k] / rigid[axis]) if rigid[axis] > 0 else float("nan"),
                )
            )
    return tuple(found)


def lines_grid(H: DynamicMass, rigid: Array) -> Grid:
    """Magnitude of the diagonal at a few lines, and of the rigid body."""
    shown = np.unique(np.round(np.linspace(0, len(H.frequency) - 1, SHOWN_LINES)).astype(int))
    lines = [("rigid", *(number(m, DECIMALS) for m in rigid))]
    lines += [(f"{H.frequency[k]:.2f} Hz", *(number(abs(H.matrix[k, i, i]), DECIMALS) for i in range(6))) for k in shown.tolist()]
    columns = list(zip(*lines, strict=True))
    header = ("|H|", *(f"{axis} [{unit}]" for axis, unit in zip(AXES, UNITS, strict=True)))
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def peaks_grid(found: Sequence[Peak]) -> Grid | None:
    """The peaks of the diagonal; None without any."""
    if not found:
        return None
    lines = [
        (AXES[p.axis], f"{p.frequency:.2f}", f"{number(p.magnitude, DECIMALS)} {UNITS[p.axis]}", f"{p.amplification:.2f}")
        for p in found
    ]
    columns = list(zip(*lines, strict=True))
    header = ("peak of", "at [Hz]", "|H|", "times rigid")
    return Grid(header=header, lines=tuple(zip(columns[0], *map(aligned, columns[1:]), strict=True)))


def apart_grid(found: Sequence[Apart], first: str, second: str) -> Grid:
    """How far two models are apart, block by block."""
    lines = tuple(
        (one.block, _percent(one.off_resonance, one.off_frequency), _percent(one.at_resonance, one.at_frequency)) for one in found
    )
    return Grid(header=(f"{second} from {first}, largest", "off resonance", "at resonance"), lines=lines)


def apart_text(found: Sequence[Apart], first: str, second: str) -> str:
    """The same in one sentence."""
    off = max((one for one in found if one.off_resonance is not None), key=lambda one: one.off_resonance or 0.0, default=None)
    if off is None:
        return f"{second} and {first}: every line lies at a resonance."
    return (
        f"Off resonance {second} and {first} differ by at most {_percent(off.off_resonance, off.off_frequency)} of the largest "
        f"entry of a block there or in the rigid body, in {off.block}."
    )


def _percent(share: float | None, frequency: float | None) -> str:
    return NONE if share is None else f"{100 * share:.3g} % at {frequency:.2f} Hz"


def as_json(
    model: Flexible, H: DynamicMass, rigid: Array, about: str, against: tuple[str, Sequence[Apart]] | None
) -> dict[str, Any]:
    """The object of the output contract; `rigid` (6,) is the diagonal of the rigid body about the same point."""
    compared: dict[str, Any] = {}
    if against is not None:
        compared = {"against": against[0], "apart": [_apart_json(one) for one in against[1]]}
    return {
        "article": model.article,
        "model": model.model,
        "frequency_hz": H.frequency.tolist(),
        "re": H.matrix.real.tolist(),
        "im": H.matrix.imag.tolist(),
        "about": about,
        "reference_point_mm": (1e3 * H.reference_point).tolist(),
        "order": ["x", "y", "z", "alpha", "beta", "gamma"],
        "peaks": [
            {
                "axis": ("x", "y", "z", "alpha", "beta", "gamma")[p.axis],
                "frequency_hz": p.frequency,
                "magnitude": p.magnitude,
                "magnitude_unit": UNITS[p.axis],
            }
            for p in peaks(H, rigid)
        ],
        **compared,
    }


def _apart_json(one: Apart) -> dict[str, Any]:
    return {
        "block": one.block,
        "off_resonance_percent": _times_100(one.off_resonance),
        "off_resonance_hz": one.off_frequency,
        "at_resonance_percent": _times_100(one.at_resonance),
        "at_resonance_hz": one.at_frequency,
    }


def _times_100(share: float | None) -> float | None:
    return None if share is None else 100 * share
