"""Noise of every channel at every line, from the parts of the records in which nothing moved.

A broadband floor would not see mains or drift. So the spectral density of the quiet parts is taken (Hann segments of up to two
seconds, Welch 1967, averaged over all runs), smoothed where it is smooth and left as it is where a tone stands out of it. A run
that is noisier than the others, since its range was set anew for it, or of another rate has the noise of its own quiet parts.

Stationary noise of the two-sided density S(f) [unit²/Hz] gives

    E|X|² = T S                                  a line of the full-record transform over T seconds [unit²/Hz²]
    E|X|² = 4 rate S sum w² / (sum w)²           a line of a block of window w, scaled to the amplitude of a sine [unit²]

A tone is not stationary noise: a full record cut between two mains periods leaks a/(2 pi |f - 50 Hz|) into a line, 0.9 % of its
amplitude at 32 Hz - below the noise of 100 s unless the tone is some hundred times larger than the noise's density.
"""

from contextlib import suppress
from dataclasses import dataclass, replace
from itertools import combinations
from math import comb

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import ChannelTable
from identification.base_motion import base_motion, resultants
from identification.campaign import NOMINAL, Campaign, block_length, quiet_blocks
from identification.spectra.line_spectra import Spectra, hann, without_straight_line

SEGMENT = 4
"""Blocks of `campaign.BLOCK` seconds that make a segment of the spectral density, where so many in a row are quiet."""

STILL = 2.0
"""How far above that of the quietest segment the power of a segment may lie: beyond, something still rings."""

SMOOTH, AROUND = 1.0, 3.0
"""[Hz] half widths: of the mean that smooths a density, and of the median out of which a tone stands."""

SAME_NOISE = 1.94
"""Lines of a Hann segment tell as much as so many times fewer that know nothing of their neighbours: 1 + 2 (2/3)² + 2 (1/6)²."""

NOTHING = 1e-9
"""Noise below this share of the largest line of its channel is rounding: nothing is known of it."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Density:
    """Two-sided spectral density of the noise.

    Attributes
    ----------
    rate : [Hz] of the records
    frequency : (k,) [Hz]
    values : (k, c) [unit² / Hz]
    segments : how many were averaged for each channel (c,)
    """

    rate: float
    frequency: Array
    values: Array
    segments: npt.NDArray[np.int_]

    @classmethod
    def of(cls, powers: Array, length: int, rate: float) -> "Density":
        """The mean of periodograms (s, k, c) of segments of so many samples that are still, smoothed where it is smooth."""

        def around(values: Array, width: int) -> Array:
            """(k, c, width) an odd number of lines of (k, c) about each; the first and the last go on beyond the ends."""
            padded = np.pad(values, ((width // 2, width // 2), (0, 0)), mode="edge")
            return np.lib.stride_tricks.sliding_window_view(padded, width, axis=0)

        kept = (total := powers.sum(axis=1)) <= STILL * total.min(axis=0)
        segments = kept.sum(axis=0)
        mean = np.sum(powers * kept[:, None, :], axis=0) / segments
        # A running mean, but the density itself where it stands out of the running median
        frequency = np.asarray(np.fft.rfftfreq(length, 1 / rate), dtype=np.float64)
        step = float(frequency[1])
        median = np.median(around(mean, 2 * max(round(AROUND / step), 1) + 1), axis=-1)
        top = median * (1 + 6 / np.sqrt(segments))  # six standard deviations of a mean of so many periodograms
        even = np.mean(around(np.minimum(mean, top), _width(step)), axis=-1)
        return cls(rate=rate, frequency=frequency, values=np.where(mean > top, mean, even), segments=segments)

    @property
    def floors(self) -> Array:
        """(c,) broadband rms."""
        return np.asarray(np.sqrt(self.rate * self.values.mean(axis=0)))

    def tone(self, channel: int) -> tuple[float, float]:
        """[Hz] where a channel is loudest, and the share of its power that lies within `SMOOTH` of it."""
        of = self.values[:, channel]
        loudest = self.frequency[np.argmax(of)]
        return float(loudest), float(of[np.abs(self.frequency - loudest) <= SMOOTH].sum() / max(of.sum(), LEAST))

    def at(self, lines: Array) -> Array:
        """(n, c) at `lines` (n,) [Hz]."""
        return np.stack([np.interp(lines, self.frequency, column) for column in self.values.T], axis=1)


def densities(campaign: Campaign) -> tuple[Density | None, dict[str, Density]]:
    """The spectral density of the quiet parts of all runs of one rate, None where no run has one; and by run that of its own."""
    own, of = dict[str, Density](), dict[tuple[float, int], list[Array]]()
    for name, one in campaign.recordings.items():
        quiet = quiet_blocks(one, campaign.table)
        if quiet is None or one.sampling_rate is None:
            continue
        rate, block = one.sampling_rate, block_length(one.sampling_rate)
        edges = block * np.flatnonzero(np.diff(np.concatenate([[False], quiet, [False]]).astype(np.int8)))
        parts = [one.values[start:end] for start, end in zip(edges[::2], edges[1::2], strict=True)]
        length = min(max(len(part) for part in parts), SEGMENT * block)
        # (s, k, c) two-sided densities of segments, overlapping by half, about their straight lines
        window, hop = hann(length), max(length // 2, 1)
        cut = [part[start : start + length] for part in parts for start in range(0, len(part) - length + 1, hop)]
        lines = [np.fft.rfft(without_straight_line(piece) * window[:, None], axis=0) for piece in cut]
        powers = np.abs(np.stack(lines)) ** 2 / (rate * np.sum(window**2))
        own[name] = Density.of(powers, length, rate)
        of.setdefault((rate, length), []).append(powers)
    if not own:
        return None, own
    rate, length = max(key for key in of if key[0] == next(iter(own.values())).rate)  # another would need a grid of its own
    return Density.of(np.concatenate(of[rate, length]), length, rate), own


@dataclass(frozen=True, eq=False, kw_only=True)
class OfLines:
    """Noise at the lines of a campaign.

    Attributes
    ----------
    density : (r, n, c) two-sided [unit²/Hz]
    floors : (r, c) broadband rms, of what is measured and of what is stated alike; 0 where nothing is known
    scatter : relative standard deviation of that at one line, of channels on average: short silences tell little
    spread : the same of the power of all channels and lines together
    unknown : sentences
    """

    density: Array
    floors: Array
    scatter: float = 0.0
    spread: float = 0.0
    unknown: tuple[str, ...] = ()


def of_lines(campaign: Campaign, frequency: Array) -> OfLines:
    """The noise at the lines `frequency` (n,) [Hz] of every run, and how well it is known.

    Where no record has a quiet part, or a channel reads nothing in it, its `noise_rms` is spread evenly up to half the sampling
    rate; where that is not stated either, the density is 0.
    """
    (found, every), runs, channels = densities(campaign), campaign.runs, campaign.table.channels
    whole, floors = np.zeros((len(runs), len(frequency), len(channels))), np.zeros((len(runs), len(channels)))
    if found is not None:
        whole += found.at(frequency)
        floors += found.floors
        for k, own in ((k, every[run.name]) for k, run in enumerate(runs) if run.name in every):
            # By most of its lines: what rings is louder at a few
            louder = (np.median(own.values - STILL * found.at(own.frequency), axis=0) > 0) | (own.rate != found.rate)
            whole[k, :, louder] = own.at(frequency)[:, louder].T
            floors[k, louder] = own.floors[louder]
    stated = np.array([channel.noise_rms or 0.0 for channel in channels])
    rates = np.array([campaign.recordings[run.name].sampling_rate or 0.0 for run in runs])
    even = stated**2 / np.where(rates > 0, rates, np.inf)[:, None]  # (r, c)
    silent = np.all(whole == 0, axis=1)
    whole, floors = np.where(silent[:, None, :], even[:, None, :], whole), np.where(silent, stated, floors)
    unknown = [channel.name for k, channel in enumerate(channels) if not whole[:, :, k].any()]
    which = "all channels" if len(unknown) == len(channels) else ", ".join(unknown)
    said = f"the noise of {which} is not known (no quiet part that reads anything, no noise_rms); it counts as 0"
    known = OfLines(density=whole, floors=floors, unknown=(said,) if unknown else ())
    if found is None:
        return known
    silent, step = silent.all(axis=0), float(found.frequency[1])
    at_a_line = _variance(found, silent, _width(step))
    of_all = _variance(found, silent, float(np.ptp(frequency)) / step)
    # Standard deviation of the mean of what has such variances (c,) and knows nothing of each other
    return replace(known, scatter=float(np.sqrt(at_a_line.mean())), spread=float(np.sqrt(np.sum(of_all)) / len(of_all)))


def _variance(found: Density, silent: npt.NDArray[np.bool_], lines: float) -> Array:
    """(c,) relative, of a mean over so many lines of the density; none of the `silent`, which count by what is stated."""
    return np.asarray(np.where(silent, 0.0, min(SAME_NOISE / max(lines, 1.0), 1.0) / found.segments))


def of_full_record(densities: Array, duration: Array) -> Array:
    """Standard deviation (r, n, c) of a line of the full-record transform of `duration` (r,) [s]."""
    return np.sqrt(densities * np.asarray(duration)[:, None, None])


def of_block(densities: Array, rate: Array, window: Array) -> Array:
    """Standard deviation (r, n, c) of a line of one block behind `window`, scaled to amplitudes; `rate` (r,) [Hz]."""
    return np.sqrt(densities * np.asarray(rate)[:, None, None] * 4 * np.sum(window**2) / np.sum(window) ** 2)


def _width(step: float) -> int:
    """Lines of a density, so many [Hz] apart, that a mean smooths."""
    return 2 * round(SMOOTH / step) + 1


# Noise of spectra that come without a quiet part: what redundant channels contradict each other by, from line to line.
#
# Eight accelerometers tell six motions, eight force channels six resultants. What is left over is noise, and gains, positions
# and angles that are off. The latter are transfer functions: as shares of the driven motion they go smoothly over the lines,
# while noise does not. The fourth difference of neighbouring lines leaves noise alone.

ORDER, MIDDLE = 4, slice(2, -2)
"""Of the difference, and the lines in whose middle it stands: what changes over five lines like a cubic is no noise."""

FEWEST = 20
"""Lines that an estimate takes."""

ROUNDING = 1e-12
"""Share of the level of a channel below which a difference is rounding, and its noise counts as 0."""


def _rough(shares: npt.NDArray[np.complex128]) -> Array:
    """(..., n - ORDER, c) what does not go smoothly over the lines of (..., n, c); of noise the median is its deviation."""
    return np.asarray(np.abs(np.diff(shares, n=ORDER, axis=-2)) / np.sqrt(comb(2 * ORDER, ORDER) * np.log(2)))


def of_redundancy(spectra: Spectra, gravity: float) -> Array:
    """(r, n, c) standard deviation, E|noise|² = sd²: one for the accelerometers and one for the force channels of every run.

    0 for channels of a quantity that is not redundant, and where there are too few lines.
    """
    noise = np.zeros(spectra.values.shape)
    if len(spectra.frequency) < FEWEST:
        return noise
    even = replace(spectra, noise=np.ones(spectra.values.shape))
    motion = load = None
    with suppress(BadInput):  # channels that do not tell six of each: whoever needs them says which
        motion = base_motion(even, gravity=gravity)
        load = resultants(even) if spectra.table.select(group="fmd") else None
    if motion is None:
        return noise
    # (r, n) the motion of every run that is largest by its nominal level
    largest = np.argmax(np.mean(np.abs(motion.values / NOMINAL), axis=1), axis=1)
    driven = motion.values[np.arange(len(largest)), :, largest]
    of_forces = () if load is None else (("force", load.parity, load.expected),)
    for quantity, left, expected in (("acceleration", motion.residual, motion.expected), *of_forces):
        chosen = list(spectra.table.select(quantity=quantity))
        if left.shape[2] and chosen and np.any(expected > 0):
            size = np.maximum(np.abs(driven), np.finfo(np.float64).tiny)[:, :, None]
            share = left * (driven.conj() / np.abs(size[..., 0]) ** 2)[:, :, None]
            noisy = _rough(share) * size[:, MIDDLE]
            seen = np.maximum(np.median(expected, axis=1), np.finfo(np.float64).tiny)
            sd = np.asarray(np.median(np.median(noisy, axis=1) / seen, axis=1))
            noise[:, :, chosen] = sd[:, None, None]
    level = np.sqrt(np.mean(np.square(np.abs(spectra.values)), axis=(0, 1)))
    return np.where(noise > ROUNDING * level, noise, 0.0)


def over_a_reference(spectra: Spectra, untold: npt.NDArray[np.bool_]) -> Array:
    """(r, n, c) as `of_redundancy`, of the channels that are `untold` (c,) by it; 0 for others, and where lines are too few.

    What is read over the loudest accelerometer below the article goes smoothly over the lines but for resonances, fewer than half
    of them. Noise is the larger of a constant and a share; half the square of the least share is laid on the reference itself.
    """
    noise, below = np.zeros(spectra.values.shape), _below(spectra.table)
    if not below or not untold.any() or len(spectra.frequency) < FEWEST:
        return noise
    for k, values in enumerate(spectra.values):
        pilot = values[:, _loudest(values, below), None]
        functions = _over(values, pilot)
        rough = _rough(functions) * np.abs(pilot[MIDDLE])
        shares = np.median(rough / np.maximum(np.abs(values[MIDDLE]), np.finfo(np.float64).tiny), axis=0)
        own = np.square(min(shares[shares > ROUNDING], default=0.0)) / 2
        shares = np.sqrt(np.where(shares > ROUNDING, np.maximum(np.square(shares) - own, np.square(shares) / 2), own))
        noise[k, :, untold] = np.maximum(np.median(rough, axis=0), shares * np.abs(values)).T[untold]
    return np.where(np.isfinite(noise) & (noise > ROUNDING * np.abs(spectra.values)), noise, 0.0)


def _below(table: ChannelTable) -> list[int]:
    """The accelerometers below the article."""
    return list(table.select(group="table", quantity="acceleration") or table.select(group="cover", quantity="acceleration"))


def _loudest(values: npt.NDArray[np.complex128], channels: list[int]) -> int:
    return channels[int(np.argmax(np.linalg.norm(values[:, channels], axis=0)))]


def _over(values: npt.NDArray[np.complex128], pilot: npt.NDArray[np.complex128]) -> npt.NDArray[np.complex128]:
    """(n, c) `values` over `pilot` (n, 1); 0 where that reads nothing."""
    return np.asarray(values * pilot.conj() / np.maximum(np.square(np.abs(pilot)), np.finfo(np.float64).tiny))


def with_reading(spectra: Spectra, sd: Array) -> Array:
    """`sd` (r, n, c) of `of_redundancy`, as sqrt(a² + s² |y|²) where noise goes with what is read: at a resonance it is tens of
    times what redundant channels tell of the ordinary line.

    What is read over the loudest accelerometer below is that of one mode over a few lines, see `share_with_reading`; what that
    leaves holds the noise of both. One share s of all runs, a of each run's accelerometers; of the forces that of `sd`.
    """
    below, chosen = _below(spectra.table), list(spectra.table.select(quantity="acceleration"))
    if not below or not sd[:, :, chosen].all() or len(spectra.frequency) <= 2 * ONE_MODE:
        return sd
    at, parts = slice(ONE_MODE, len(spectra.frequency) - ONE_MODE), []
    for values in spectra.values:
        pilot = _loudest(values, below)
        others = [c for c in chosen if c != pilot]
        near = np.lib.stride_tricks.sliding_window_view(_over(values[:, others], values[:, [pilot]]), 2 * ONE_MODE + 1, axis=0)
        power, base = np.square(np.abs(values[at][:, others])), np.square(np.abs(values[at][:, [pilot]])) + LEAST
        left, told = _beside_one_mode(near)
        loud = told & (power > LOUD * np.median(power, axis=0))
        parts.append((np.square(left) * base / np.log(2), power, power / base, loud, told & ~loud))
    if not all(loud.any() and ordinary.any() for *_, loud, ordinary in parts):
        return sd
    share, level = 0.0, np.zeros(len(parts))
    for k in range(ROUNDS):
        level = np.array([max(np.median(((left - 2 * share * y) / (1 + f))[few]), 0.0) for left, y, f, _, few in parts])
        each = list[float]()
        for a, (left, y, f, loud, _) in zip(level, parts, strict=True):
            clear = loud & (y > CLEAR**2 * a * (1 + f))
            each += ((left - a * (1 + f))[clear] / (2 * y[clear])).tolist()
        if not k and (len(each) < FEWEST or np.mean(np.array(each) > 0) < SAY_SO):
            return sd
        share = max(float(np.median(each)), 0.0)
    variance = np.square(sd)
    variance[:, :, chosen] = level[:, None, None]
    return np.where(sd > 0, np.sqrt(variance + share * np.square(np.abs(spectra.values))), sd)


# Noise of lines that brought no records along, from the lines themselves.
#
# First, what is left when each line is compared with the mean of its neighbours. A response function is smooth over three lines
# but for its resonances, noise is not: of y_k - (y_k-1 + y_k+1) / 2 noise of variance sd² makes 3/2 sd². The median over a
# stretch of lines does not notice a resonance that is narrow beside it; the bent skirts of a high one make the noise look larger
# there, not smaller. A complex normal number has the median modulus sd sqrt(ln 2) (Hampel, J. Am. Stat. Assoc. 69, 1974, for
# such medians).
#
# Second, how much of it goes with what is read: noise of the force, or of a range, is largest at a peak, and a median knows the
# ordinary line. Over a few lines a function is that of one mode on something even, a ratio of polynomials of second degree
# (McKelvey and Guerin, 16th IFAC Symposium on System Identification, 2012, 49), and what a fit of that (Levy, IRE Trans.
# Automatic Control 4, 1959, 37) leaves is noise at a peak too: at u times the ordinary power its square has the median
# sd² (1 + t (u - 1)) ln 2.
#
# Third, how far readings repeat: a linear structure answers at i to a force at j as it answers at j to one at i (Rayleigh, The
# Theory of Sound, 1877, chapter 5), so that two runs measured the same number. What they differ by grows with what is read.

NEIGHBOURHOOD = 1.0
"""[Hz] to either side of a line over which the median is taken; a resonance is far narrower."""

FEWEST_NEIGHBOURS = 7
"""Lines that such a stretch must hold."""

ONE_MODE = 6
"""[lines] to either side of one over which a single mode, on what is even, is all that answers: its five numbers are told by
thirteen. Held by test_noise_between_lines.py."""

LOUD = 2.0
"""[1] Power beside that of the ordinary line of a stretch from which a line tells whether noise goes with the reading. Held by
test_noise_between_lines.py."""

CLEAR = 5.0
"""[standard deviations of its noise] that such a line reads: of one that reads little else, noise makes loud what it makes rough.
Held by test_noise_between_lines.py."""

AT_MOST = 20_000
"""[lines] of all functions that are asked for it, evenly spread: more tell no more. Held by test_noise_between_lines.py."""

SAY_SO = 0.6
"""[share] of the loud readings that must be rougher than noise of one level makes half of them, for noise to go with the reading.
Held by test_of_campaign.py."""

ROUNDS = 12
"""[count] of times that either part of the noise is told beside the other. Exercised by test_of_campaign.py."""

FREE = 0.1
"""[share] of its noise that the fit of a mode leaves of a line at least for it to tell. Exercised by
test_noise_between_lines.py."""

LEAST = float(np.finfo(np.float64).tiny)

_OF_MEDIAN = 1 / np.sqrt(1.5 * np.log(2))

CROSSED = 0.1
"""[share] of what two forces move along themselves, over all lines, below which a reading is one across them: slants of a few
degrees, and places, make another number of it. Held by test_response_functions.py."""


def repeatability(accelerances: npt.ArrayLike, noise: npt.ArrayLike = 0.0) -> float:
    """Standard deviation of a reading as a share of it, from `accelerances` (r, n, r) of `noise` (r, n, r), run j driven where
    channel j reads; 0 where they do not tell it.

    What one reading is times the other at all lines is a gain and no scatter. With p = |a|² + |b|² and q of noise the median of
    |a - b|² / (s² p + q) is ln 2.

    Raises
    ------
    ValueError : another shape, or one run alone.
    """
    A = np.asarray(accelerances, dtype=np.complex128)
    r = len(A)
    if A.ndim != 3 or A.shape[2] != r or r < 2:
        raise ValueError(f"`accelerances` must be (r, n, r) with two runs or more, found {A.shape}")
    variance, found = np.square(np.broadcast_to(noise, A.shape)), [np.zeros(0)]
    for i, j in combinations(range(r), 2):
        a, b, along = A[i, :, j], A[j, :, i], np.sqrt(np.abs(A[i, :, i] * A[j, :, j]))
        if np.linalg.norm(np.minimum(np.abs(a), np.abs(b))) < CROSSED * np.linalg.norm(along):
            continue
        gain = float(np.vdot(b, a).real / np.maximum(np.vdot(b, b).real, LEAST))
        p, q = np.abs(a) ** 2 + np.abs(gain * b) ** 2 + LEAST, variance[i, :, j] + gain**2 * variance[j, :, i]
        found.append(((np.abs(a - gain * b) ** 2 / np.log(2) - q) / p)[q < p])
    return float(np.sqrt(max(np.median(every), 0.0))) if len(every := np.concatenate(found)) >= FEWEST_NEIGHBOURS else 0.0


def between_neighbours(frequency: npt.ArrayLike, values: npt.ArrayLike, around: float = NEIGHBOURHOOD) -> Array:
    """Standard deviation (r, n, c) of the complex noise of `values` (r, n, c) at `frequency` (n,) [Hz], E|noise|² = sd².

    Lines at either end take that of the nearest line around which a whole window lies: a window cut short there would have half
    of its lines or, were they repeated, a single one. Where noise goes with the reading, lines that read more have more of it;
    those that read less keep what the window tells: a zero between two modes is not free of noise.

    Raises
    ------
    ValueError : fewer than `FEWEST_NEIGHBOURS` lines lie within `around` of some line.
    """
    f, y = np.asarray(frequency, dtype=np.float64), np.asarray(values, dtype=np.complex128)
    width = 2 * round(around / float(np.median(np.diff(f)))) + 1 if len(f) > 1 else 1
    if width < FEWEST_NEIGHBOURS or len(f) < width:
        said = f"`frequency` must hold {FEWEST_NEIGHBOURS} lines within {around:g} Hz of each line, found a spacing for {width}"
        raise ValueError(said)
    left = np.abs(y[:, 1:-1] - (y[:, :-2] + y[:, 2:]) / 2)
    level = _OF_MEDIAN * np.pad(_median(left, width), ((0, 0), (1, 1), (0, 0)), mode="edge")
    ordinary = _median(power := np.square(np.abs(y)), width)
    reads = ordinary > NOTHING**2 * power.max(axis=1, keepdims=True)
    louder = np.divide(power, ordinary, out=np.ones_like(power), where=reads)
    return np.asarray(level * np.sqrt(np.maximum(1 + share_with_reading(y, level, louder) * (louder - 1), 1.0)))


def share_with_reading(values: npt.NDArray[np.complex128], level: Array, louder: Array) -> float:
    """How much of the power of the noise of ordinary lines goes with the power that is read: from 0, none of it, to 1, all.

    0 unless more than half of the loud lines say so, by three standard deviations of such a count.

    Parameters
    ----------
    values : (r, n, c)
    level : (r, n, c) standard deviation of the noise were it the same at all lines of a stretch
    louder : (r, n, c) power of each line beside that of the ordinary one of its stretch
    """
    if values.shape[1] <= 2 * ONE_MODE:
        return 0.0
    at = slice(ONE_MODE, values.shape[1] - ONE_MODE, max(values.size // AT_MOST, 1))
    left, told = _beside_one_mode(np.lib.stride_tricks.sliding_window_view(values, 2 * ONE_MODE + 1, axis=1)[:, :: at.step])
    y, sd, u = (one[:, at] for one in (np.abs(values), level, louder))
    told &= sd > NOTHING * y.max(axis=1, keepdims=True)
    ratio, ordinary = np.square(np.divide(left, sd, out=np.zeros_like(sd), where=told)), told & (u <= LOUD)
    loud = told & (u > LOUD) & (y > CLEAR * sd)
    if not loud.any() or not (of_ordinary := float(np.median(ratio[ordinary])) if ordinary.any() else 0.0):
        return 0.0
    t = np.sort((ratio[loud] / of_ordinary - 1) / (u[loud] - 1))
    least = int(len(t) / 2 - 1.5 * np.sqrt(len(t)))
    return float(min(np.median(t), 1.0)) if least > 0 and t[least] > 0 else 0.0


def _beside_one_mode(near: npt.NDArray[np.complex128]) -> tuple[Array, npt.NDArray[np.bool_]]:
    """Modulus (...) of what one mode, fitted to stretches of lines (..., 2 ONE_MODE + 1), leaves of the middle one, as large as
    the noise there; and whether enough is left to tell."""
    x, even = np.arange(-ONE_MODE, ONE_MODE + 1) / ONE_MODE, np.ones_like(near)
    size = np.maximum(np.abs(near).max(axis=-1, keepdims=True), LEAST)
    q, _ = np.linalg.qr(np.stack([x * near / size, x**2 * near / size, even, x * even, x**2 * even], axis=-1))
    middle = q[..., ONE_MODE, :]
    left = near[..., ONE_MODE] - np.sum(middle * np.sum(q.conj() * near[..., None], axis=-2), axis=-1)
    free = 1 - np.sum(np.square(np.abs(middle)), axis=-1)
    return np.asarray(np.abs(left) / np.sqrt(np.maximum(free, FREE))), free > FREE


def _median(values: Array, width: int) -> Array:
    """(r, n, c) running over so many lines; the ends take that of the nearest whole window."""
    from scipy.ndimage import median_filter

    half = min(width // 2, (values.shape[1] - 1) // 2)
    whole = median_filter(values, size=(1, width, 1), mode="nearest")[:, half : values.shape[1] - half]
    return np.pad(whole, ((0, 0), (half, half), (0, 0)), mode="edge")
