"""From a campaign to its `Spectra`: every run on one grid of lines, with noise and quality.

*Time histories* become spectra of the full record (default: it is right at light damping, too) or the paper's
peak-reference-hold. A straight line, offset and drift, is taken off every channel first: an offset D leaks up to D/(pi f) into a
line, 0.08 s D at 4 Hz, where a sweep of 2.5 m/s² reads about 4 m/s² s. The line is fitted to the whole record, the same for all
channels, so the sweep itself loses no more than a few parts in 1e5 of a line.

*Spectra in the files* stay as they are: their lines may be chosen, but nothing is interpolated, since between two lines of a
lightly damped resonance lies more than a straight line.
"""

from collections.abc import Callable, Sequence
from contextlib import suppress
from dataclasses import replace

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import ChannelTable, motion_rows
from identification.base_motion import base_motion, resultants
from identification.campaign import METHODS, Campaign, Processing, Recording, Run
from identification.spectra import noise, peak_hold
from identification.spectra.line_spectra import Spectra, full_record, hann, without_straight_line
from identification.spectra.noise import of_redundancy
from identification.spectra.peak_hold import peak_reference_hold

# How much of what the channels read one rigid base motion and one load explain: a coherence of a single run.
#
# A coherence function takes averages over many records; a sweep is driven once. What takes its place is redundancy: eight
# accelerometers read six motions, eight load-cell channels six resultants. The quality of a line is
#
#     min( 1 - |y_a - G u|² / |y_a|²,   1 - |V y_f|² / |y_f|² )
#
# the smaller of the share of the accelerations that a rigid motion explains and the share of the forces that cells of equal
# stiffness explain (V: the orthonormal combinations that must balance). It is 1 where nothing is redundant: then nothing is
# tested. Cells whose stiffnesses differ by 5 % cost about 0.001, noise of 1 % of the signal 0.0001 or less, an inverted channel
# a tenth and more.


def of_lines(spectra: Spectra, *, gravity: float) -> Array:
    """The quality (r, n) [0 to 1] of every run and line; 1 where the channels hold nothing redundant."""
    found = np.ones(spectra.values.shape[:2])
    with suppress(BadInput):
        motion = base_motion(spectra, gravity=gravity)
        found = np.minimum(found, _explained(motion.residual, _readings(spectra, motion.channels)))
    with suppress(BadInput):
        loads = resultants(spectra)
        orthonormal, readings = np.linalg.svd(loads.combinations, full_matrices=False)[2], _readings(spectra, loads.channels)
        found = np.minimum(found, _explained(readings @ orthonormal.T, readings))
    return np.asarray(found)


def _readings(spectra: Spectra, names: tuple[str, ...]) -> ComplexArray:
    return spectra.values[:, :, [spectra.table.names.index(name) for name in names]]


def _explained(residual: ComplexArray, readings: ComplexArray) -> Array:
    whole = np.sum(np.abs(readings) ** 2, axis=2)
    left = np.sum(np.abs(residual) ** 2, axis=2)
    return np.asarray(np.clip(1 - left / np.where(whole > 0, whole, 1.0), 0.0, 1.0))


Progress = Callable[[float], None]

SAME_LINE = 1e-6
"""How far two frequencies may lie apart, relative to the distance of lines, and still be the same line."""


def spectra(
    campaign: Campaign,
    *,
    method: str = "full-record",
    band: tuple[float, float] | None = None,
    frequency: npt.ArrayLike | None = None,
    reference: str | None = None,
    progress: Progress | None = None,
) -> Spectra:
    """The spectra of all runs.

    Parameters
    ----------
    campaign : with its recordings
    method : of `METHODS`, for time histories
    band : (low, high) [Hz] of the lines, both included
    frequency : (n,) lines [Hz], ascending; by default those of the campaign's processing, 4 to 32 Hz by 0.05 Hz, or of its files
    reference : channel that chooses the block of peak-reference-hold; by default the pilot that sees most of the driven axis
    progress : called with the share done

    Raises
    ------
    BadInput : no recordings, runs that do not fit each other, lines that the data do not have, an unknown method or channel.
    """
    if method not in METHODS:
        raise _refused(campaign, "method", f"{method!r} is not known", f"Choose one of {', '.join(METHODS)}")
    missing = [run.name for run in campaign.runs if run.name not in campaign.recordings]
    if missing or not campaign.runs:
        which = f"the runs {', '.join(missing)} have" if missing else "the campaign has"
        raise _refused(campaign, "run", f"{which} no recording", "Read the whole campaign, not its description alone")
    recorded = [campaign.recordings[run.name] for run in campaign.runs]
    kinds = {one.is_spectrum for one in recorded}
    if len(kinds) > 1:
        which = ", ".join(one.source for one in recorded if one.is_spectrum)
        raise _refused(campaign, "run", f"{which} hold spectra, the others time histories", "Give all runs in one form")
    if recorded[0].is_spectrum:
        made = _as_recorded(campaign, recorded, band, frequency)
    else:
        lines = _restricted(grid(campaign, frequency), band, campaign.source)
        made = _transformed(campaign, recorded, method, lines, reference, progress or (lambda _: None))
    return replace(made, quality=of_lines(made, gravity=campaign.gravity))


def reference_channel(table: ChannelTable, run: Run, recorded: Recording) -> str:
    """The pilot for peak-reference-hold: among the channels marked `reference` the one that sees most of the driven axis.

    Of several that see it alike, the one that sees least of the other axes. Without marked channels those of the table serve,
    then those of the cover plate; a pattern of several axes takes the one that reads most.

    Raises
    ------
    BadInput : no accelerometer on table or cover plate.
    """
    pilots = [k for k, channel in enumerate(table.channels) if channel.reference and channel.quantity == "acceleration"]
    below, above = (table.select(group=group, quantity="acceleration") for group in ("table", "cover"))
    chosen = pilots or below or above
    if not chosen:
        remedy = "Mark one with reference = true, or use full-record spectra"
        raise BadInput("channel", "reference", "no channel can serve as reference", remedy)
    if not run.axis:
        return table.names[chosen[int(np.argmax(np.std(recorded.values[:, chosen].real, axis=0)))]]
    seen = np.abs(motion_rows([table.channels[k] for k in chosen], table.origin))
    axis = MOTIONS.index(run.axis)
    others = np.delete(seen, axis, axis=1).sum(axis=1)
    return table.names[chosen[int(np.lexsort((others, -np.round(seen[:, axis], 6)))[0])]]


def grid(campaign: Campaign, frequency: npt.ArrayLike | None = None) -> Array:
    """(n,) lines [Hz] that are made of time histories: `frequency`, or those of the campaign's processing.

    Raises
    ------
    BadInput : lines that do not ascend above 0 Hz.
    """
    if frequency is None:
        of = campaign.processing or Processing()
        return np.asarray(of.start + of.step * np.arange(round((of.stop - of.start) / of.step) + 1), dtype=np.float64)
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    if lines.ndim != 1 or not len(lines) or not np.all(np.isfinite(lines)) or lines[0] <= 0 or np.any(np.diff(lines) <= 0):
        raise _refused(campaign, "frequency", "lines must ascend above 0 Hz", "Give them so")
    return lines


def _restricted(lines: Array, band: tuple[float, float] | None, source: str) -> Array:
    if band is None:
        return lines
    low, high = band
    slack = SAME_LINE * max(high - low, 0.0)
    chosen = lines[(lines >= low - slack) & (lines <= high + slack)]
    if not low < high or not len(chosen):
        problem = f"{low:g} to {high:g} Hz holds none of the lines from {lines[0]:g} to {lines[-1]:g} Hz"
        raise BadInput(source, "band", problem, "Choose a band within, lowest frequency first")
    return chosen


def _transformed(
    campaign: Campaign, recorded: list[Recording], method: str, lines: Array, reference: str | None, progress: Progress
) -> Spectra:
    values, pilots, of = [], [], campaign.processing or Processing()
    rates = [one.sampling_rate or 0.0 for one in recorded]
    for k, (run, one, rate) in enumerate(zip(campaign.runs, recorded, rates, strict=True)):
        progress(k / len(recorded))
        samples = without_straight_line(one.values)
        if method == "full-record":
            values.append(full_record(samples, rate, lines, one.source))
            continue
        pilots.append(reference or reference_channel(campaign.table, run, one))
        one.channel(pilots[-1])  # refuses a name that is none
        at = samples[:, one.names.index(pilots[-1])]
        kept = peak_reference_hold(samples, rate, at, lines, block_size=of.block_size, overlap=of.overlap, source=one.source)
        values.append(kept)
    progress(1.0)
    stacked, known = np.stack(values), noise.of_lines(campaign, lines)
    if method == "full-record":
        sd = noise.of_full_record(known.density, np.array([one.duration for one in recorded]))
    else:
        sd = noise.of_block(known.density, np.array(rates), hann(of.block_size))
    sd = np.where(sd > noise.NOTHING * np.abs(stacked).max(axis=(0, 1)), sd, 0.0)
    held = ", ".join(f"{run.name} by {pilot}" for run, pilot in zip(campaign.runs, pilots, strict=False))
    biased = (f"peak-reference-hold is biased near lightly damped resonances; reference of each run: {held}",) if pilots else ()
    ends = peak_hold.warnings(campaign, known.floors) if method == "full-record" else ()
    made = _spectra(campaign, lines, stacked, sd, method, (*_beyond_drive(campaign, lines), *ends, *biased, *known.unknown))
    return replace(made, noise_scatter=known.scatter, noise_spread=known.spread)


def _as_recorded(
    campaign: Campaign, recorded: list[Recording], band: tuple[float, float] | None, frequency: npt.ArrayLike | None
) -> Spectra:
    """Spectra of the files at those of their lines that are asked for."""
    given = recorded[0].frequency
    for one in recorded:
        if given is None or one.frequency is None or len(one.frequency) != len(given) or not _same(one.frequency, given):
            problem = f"{one.source} has other lines than {recorded[0].source}"
            raise _refused(campaign, "frequency", problem, "Export all runs on one grid of lines")
    if given is None:
        raise _refused(campaign, "frequency", "the files hold no spectra", "Give spectra or time histories")
    wanted = _restricted(given[given > 0] if frequency is None else grid(campaign, frequency), band, campaign.source)
    at = np.clip(np.searchsorted(given, wanted - np.diff(given, append=2 * given[-1]).min() / 2), 0, len(given) - 1)
    if not _same(given[at], wanted, given):
        problem = f"the files do not hold the lines asked for, theirs lie from {given[0]:g} to {given[-1]:g} Hz"
        raise _refused(campaign, "frequency", problem, "Spectra are not interpolated: ask for lines of the files, or for a band")
    values = np.stack([one.values[at] for one in recorded])
    made = _spectra(campaign, given[at], values, np.zeros(values.shape), "spectra", ())
    sd = of_redundancy(made, campaign.gravity)
    found = [q for q in ("acceleration", "force") if np.any(sd[:, :, list(campaign.table.select(quantity=q))] > 0)]
    how = [f"that of {' and '.join(found)} is told from redundant channels"] if found else []
    others = noise.over_a_reference(made, ~np.any(sd > 0, axis=(0, 1)))
    which = f"that of {'other' if found else 'all'} channels"
    how += [f"{which} is told from neighbouring lines, over an accelerometer of the base"] if np.any(others > 0) else []
    said = f"the files hold spectra, which have no quiet part to take the noise from: {', '.join(how) or 'it counts as 0'}"
    return replace(made, noise=noise.with_reading(made, sd) + others, warnings=(*made.warnings, said))


def _same(some: Array, others: Array, grid: Array | None = None) -> bool:
    whole = some if grid is None else grid
    step = float(np.diff(whole).min()) if len(whole) > 1 else 1.0
    return bool(np.all(np.abs(some - others) <= SAME_LINE * step))


def _spectra(
    campaign: Campaign, lines: Array, values: ComplexArray, sd: Array, method: str, warnings: tuple[str, ...]
) -> Spectra:
    return Spectra(
        table=campaign.table,
        frequency=lines,
        values=values,
        noise=sd,
        quality=np.ones(values.shape[:2]),
        runs=tuple(run.name for run in campaign.runs),
        axes=tuple(run.axis for run in campaign.runs),
        method=method,
        warnings=warnings,
    )


def _beyond_drive(campaign: Campaign, lines: Array) -> tuple[str, ...]:
    """Sweeps that do not reach all lines."""
    found = []
    for run in campaign.runs:
        ends = [run.excitation.figure(key) if run.excitation else None for key in ("start_hz", "stop_hz")]
        low, high = min((end for end in ends if end), default=0.0), max((end for end in ends if end), default=np.inf)
        if lines[0] < low * (1 - SAME_LINE) or lines[-1] > high * (1 + SAME_LINE):
            found.append(f"{run.name} ({low:g} to {high:g} Hz)")
    reach = f"lines lie from {lines[0]:g} to {lines[-1]:g} Hz"
    return (f"{reach}, beyond what was driven in {', '.join(found)}: noise is larger there",) if found else ()


def _refused(campaign: Campaign, field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(campaign.source, field, problem, remedy)


# Which lines of a campaign its runs drive: a line that a run does not drive holds noise, and no model is judged by noise.
#
# A run says what it drives, or its level does. Only lines that every run drives are kept, since all runs share one grid.

WELL_ABOVE = 10.0
"""Level over known noise of the channel that sees most, from which a line is driven. Of 22 channels of pure noise the largest
reaches about 3 at the worst of a thousand lines."""

Chosen = npt.NDArray[np.bool_]

OTHERWISE = "--band decides otherwise"


def stated_drives(campaign: Campaign) -> tuple[float, float] | None:
    """(low, high) [Hz] that all runs that state what they drive have in common; None where none does.

    Raises
    ------
    BadInput : they have no line in common.
    """
    ends = {run.name: found for run in campaign.runs if (found := _ends(run)) is not None}
    if not ends:
        return None
    low, high = max(of[0] for of in ends.values()), min(of[1] for of in ends.values())
    lines = lines_of(campaign)
    if not low < high or not np.any(between(lines, low, high)):
        said = ", ".join(f"{name} drives {of[0]:g} to {of[1]:g} Hz" for name, of in ends.items())
        problem = f"all runs together drive none of the lines from {lines[0]:g} to {lines[-1]:g} Hz: {said}"
        remedy = "Correct start_hz and stop_hz, or choose the lines with --band LOW HIGH"
        raise BadInput(campaign.source, "run.excitation", problem, remedy)
    return low, high


def by_level(campaign: Campaign, found: Spectra, groups: Sequence[Sequence[int]]) -> tuple[Chosen, tuple[str, ...]]:
    """(n,) lines of `found` that stand well above the noise in every run that states nothing, and what is to be said.

    Parameters
    ----------
    groups : columns of channels, in each of which the line must show: forces, accelerations
    """
    silent = [k for k, run in enumerate(campaign.runs) if _ends(run) is None]
    every = np.ones(len(found.frequency), dtype=bool)
    if not silent:
        return every, ()
    # Whether the best channel of each group stands well above its noise; noise that is not known counts as none
    above = np.abs(found.values[silent]) > WELL_ABOVE * found.noise[silent]
    loud = np.all([np.any(above[:, :, list(columns)], axis=2) for columns in groups if len(columns)], axis=(0, 1))
    some_names = [campaign.runs[k].name for k in silent]
    names = ", ".join(some_names[:6]) + (f" and {len(some_names) - 6} more" if len(some_names) > 6 else "")
    if not np.any(loud):
        said = f"no line stands {WELL_ABOVE:g} times above the noise in every run, and {names} state nothing of what they drive"
        return every, (f"of {campaign.source} all lines are kept: {said}",)
    if np.all(loud):
        return every, ()
    kept = found.frequency[loud]
    which = f"{int(np.sum(~loud))} of {len(loud)} lines of {campaign.source}"
    left = f"{which} are left out, {kept[0]:g} to {kept[-1]:g} Hz remain"
    why = f"there the level is below {WELL_ABOVE:g} times the noise in {names}, which state nothing of what they drive"
    return loud, (f"{left}: {why}; {OTHERWISE}",)


def lines_of(campaign: Campaign) -> Array:
    """(n,) [Hz] of the files, or those of the campaign's processing."""
    recorded = next(iter(campaign.recordings.values()), None)
    there = None if recorded is None else recorded.frequency
    return grid(campaign) if there is None else there[there > 0]


def _ends(run: Run) -> tuple[float, float] | None:
    """(low, high) [Hz] of what a run states to drive."""
    return None if run.excitation is None else run.excitation.band


def between(lines: Array, low: float, high: float) -> Chosen:
    """(n,) which of `lines` lie from `low` to `high` [Hz]."""
    slack = SAME_LINE * (high - low)
    return np.asarray((lines >= low - slack) & (lines <= high + slack))
