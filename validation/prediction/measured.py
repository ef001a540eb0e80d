"""From a campaign to `Measured`: the complex lines of the channels that the chain predicts; forces are judged."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from identification.campaign import Campaign, Processing
from identification.measurement_chain import Chain
from identification.spectra import noise
from identification.spectra.line_spectra import Spectra
from identification.spectra.of_campaign import spectra
from identification.spectra.peak_hold import hann
from validation.effects.floors import leak
from validation.engine.measured import Measured
from validation.prediction import driven

Progress = Callable[[float], None]


@dataclass(frozen=True, eq=False, kw_only=True)
class Made:
    """Spectra as the engine wants them.

    Attributes
    ----------
    measured : the data set
    method : by which they were made
    remarks : which lines were left out, and why
    """

    measured: Measured
    method: str
    remarks: tuple[str, ...] = ()


def measured(
    campaign: Campaign,
    of: Chain,
    name: str,
    *,
    band: tuple[float, float] | None = None,
    method: str = "full-record",
    lines: npt.ArrayLike | None = None,
    progress: Progress | None = None,
) -> Made:
    """The data set `name` of `campaign`; where neither `band` nor `lines` are given, at the lines that every run drives.

    Raises
    ------
    BadInput : as `identification.spectra.of_campaign.spectra`; runs that drive no line in common.
    """
    if band is not None or lines is not None:
        found = spectra(campaign, method=method, band=band, frequency=lines, progress=progress)
        return Made(measured=_measured(campaign, found, of, name), method=found.method, remarks=found.warnings)
    stated = driven.stated(campaign)
    found = spectra(campaign, method=method, band=stated, progress=progress)
    kept, left = driven.by_level(campaign, found, _groups(of))
    return Made(
        measured=_measured(campaign, found.at(kept), of, name),
        method=found.method,
        remarks=(*found.warnings, *driven.outside(campaign, stated), *left),
    )


def names(campaigns: Sequence[Campaign]) -> tuple[str, ...]:
    """What the data sets are called: after their folders, or after what was tested where there is none; each its own."""
    called: list[str] = []
    for one in campaigns:
        stem = Path(one.source).name if Path(one.source).is_dir() else one.article
        same = [f"{stem}-{k}" for k in range(2, len(campaigns) + 2)]
        called.append(next(name for name in (stem, *same) if name not in called))
    return tuple(called)


def per_rms(campaign: Campaign, method: str) -> Array:
    """(r,) standard deviation of a line for broadband noise of 1 SI unit rms in the record; zeros of stored spectra."""
    recorded = [campaign.recordings[run.name] for run in campaign.runs]
    rates = np.array([one.sampling_rate or 0.0 for one in recorded])
    if not np.all(rates > 0):
        return np.zeros(len(recorded))
    density = (1 / rates)[:, None, None]
    if method == "full-record":
        return noise.of_full_record(density, np.array([one.duration for one in recorded])).ravel()
    return noise.of_block(density, rates, hann((campaign.processing or Processing()).block_size)).ravel()


def hum(frequency: Array, quantities: Sequence[str], method: str) -> Array:
    """(n, c) what the mains' ordinary hum leaves at the lines of a full record; empty of other spectra, where it is not known."""
    from validation.virtual_test.plan import MAINS

    if method != "full-record":
        return np.zeros((0, 0))
    ordinary = np.array([MAINS.get(quantity, 0.0) for quantity in quantities])
    return np.outer(leak(frequency), ordinary)


def _groups(of: Chain) -> tuple[list[int], list[int]]:
    """Columns of what is judged, and of what the inputs are estimated from."""
    forces = [of.columns[k] for k in of.forces.columns]
    return forces, [column for column in of.columns if column not in forces]


def _measured(campaign: Campaign, found: Spectra, of: Chain, name: str) -> Measured:
    columns = list(of.columns)
    return Measured(
        name=name,
        configuration=campaign.article,
        hardware=campaign.hardware,
        runs=found.runs,
        axes=found.axes,
        channels=of.names,
        judged=np.isin(np.arange(len(columns)), of.forces.columns),
        frequency=found.frequency,
        values=found.values[:, :, columns],
        noise=found.noise[:, :, columns],
        noise_scatter=found.noise_scatter,
        noise_spread=found.noise_spread,
    )
