"""Response functions made of records of force and response: of a shaker by averaged blocks, of a hammer blow by blow.

With X, F the spectra of blocks and S_xf = <X F*>, S_ff = <F F*>, S_xx = <X X*> their averages,

    H1 = S_xf / S_ff ,    H2 = S_xx / S_fx ,    Hv = sqrt(H1 H2) ,    g² = |S_xf|² / (S_xx S_ff) = H1 / H2 ,

H1 where the response is noisy, H2 where the force is, Hv between them (J. S. Bendat and A. G. Piersol, Random Data, 2010,
chapters 6 and 9). Averages of overlapping blocks count less than their number (P. D. Welch, IEEE Trans. Audio 15, 1967).

Of several forces at a time S_ff is a matrix, and g² of a function the partial coherence: that of response and force without what
the other forces make of both (the same, chapter 7). All of a response that forces explain, its multiple coherence, is no less.

A blow that rings longer than its block is windowed by exp(-t / decay), force and response alike. That moves the axis on which
the transfer function H(s) is read from s = i omega to i omega + 1 / decay and changes nothing else: a prediction that is made
there has the window too, and no damping needs to be taken off (W. G. Halvorsen and D. L. Brown, Sound and Vibration 11, 1977).
"""

from collections.abc import Sequence
from dataclasses import dataclass, replace
from math import inf

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array

H1, H2, HV = ESTIMATORS = ("H1", "H2", "Hv")

BLOCKS = 5
"""Blocks of which a record of a shaker is as long where nothing is said."""

HIT = 0.2
"""Share of the hardest blow from which a peak of the force is one."""

AGAIN = 0.1
"""Share of the peak of a blow that a second one has, once the force has fallen to `OVER` of it."""

OVER = 0.05
"""Share of its peak below which a blow is over."""

BEFORE = 0.02
"""Share of a block that lies before its blow."""

REACH = 0.1
"""Share of its largest spectrum down to which a blow drives a line."""

OUT_OF_LINE = 3.0
"""How many times the usual distance from the others a blow may have."""

RINGS = 0.05
"""Share of its largest value that an impulse response may have at the end of its block."""

LOUD = 5.0
"""[standard deviations] by which it is above noise there. By definition: of some hundred samples."""

CLIPPED = 5
"""[samples] in a row at the end of its range that no channel has."""

FLAT = 2
"""[samples] in a row at the tops of different blows, all at one force, that a hammer has which is overloaded."""

RETURNS = 3
"""[count] of times that no signal without limits has one largest value."""

ROUNDED = 4.0
"""[steps of its converter] from which a signal jumps to its largest value."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Estimate:
    """Response functions of the forces of a record.

    Attributes
    ----------
    frequency : (n,) [Hz], above zero
    values : (r, n, c) response over force
    coherence : (r, n, c) [0 to 1]; ones of a single blow, which tells none
    averages : independent averages, rounded down
    reach : [Hz] up to which the force drives
    rings : share of its largest value that an impulse response has at the end of its block; 0 where it is none to speak of
    smeared : share of what a Hann window smears over its lines that is in them: 1 of random forces
    warnings : in words
    """

    frequency: Array
    values: ComplexArray
    coherence: Array
    averages: int
    reach: float
    rings: float = 0.0
    smeared: float = 0.0
    warnings: tuple[str, ...] = ()


def shaken(
    force: npt.ArrayLike,
    responses: npt.ArrayLike,
    rate: float,
    *,
    block: float = 0.0,
    overlap: float = 0.5,
    window: str = "hann",
    estimator: str = H1,
    source: str = "record",
    end: float = inf,
    names: Sequence[str] = (),
) -> Estimate:
    """Of a structure that is shaken all the time.

    Parameters
    ----------
    force, responses : (n, r), (n, c) equally sampled; r forces at a time, which must be independent
    rate : [Hz]
    block : [s] length of a block, the resolution is its inverse; 0 for a fifth of the record
    overlap : share of a block that the next one has in common with it
    window : as `scipy.signal.get_window` knows it, such as hann or boxcar
    end : [Hz] up to which a peak is of interest
    names : of the responses, where they have some

    Raises
    ------
    BadInput : a silent or clipped channel, a block that does not fit, an unknown window; several forces that are one.
    """
    from scipy.signal import get_window

    f, x = np.asarray(force, dtype=np.float64), np.asarray(responses, dtype=np.float64)
    _require_alive(f, x, source)
    several = f.shape[1]
    forces = [f"force {k + 1}" if several > 1 else "force" for k in range(several)]
    read = names or [f"response {k + 1}" for k in range(x.shape[1])]
    for name, channel in zip([*forces, *read], np.hstack([f, x]).T, strict=True):
        if clipped(channel):
            problem = "is clipped: it stays at the end of its range, or ends there again and again"
            raise BadInput(source, name, problem, "Record it again in a wider range")
    size = round((block or len(f) / rate / BLOCKS) * rate)
    step = max(1, round(size * (1 - overlap)))
    count = (len(f) - size) // step + 1
    if size < 8 or count < 1 or not 0 <= overlap < 1:
        problem = f"{block:g} s with an overlap of {overlap:g} does not fit into a record of {len(f) / rate:g} s"
        raise BadInput(source, "records.block", problem, "Give a shorter one")
    try:
        w = np.asarray(get_window(window, size), dtype=np.float64)
    except (ValueError, TypeError):
        raise BadInput(source, "records.window", f"no window is called {window!r}", "Write hann, flattop or boxcar") from None
    starts = step * np.arange(count)
    both = np.column_stack([f, x])
    pieces = np.stack([both[k : k + size] for k in starts])
    spectra = np.fft.rfft((pieces - pieces.mean(axis=1, keepdims=True)) * w[:, None], axis=1)[:, 1:]
    # Blocks that overlap say the same in part: the squares of their correlations
    lags = [(k, k * step) for k in range(1, count) if k * step < size]
    alike = sum(2 * (1 - k / count) * (w[:-lag] @ w[lag:] / (w @ w)) ** 2 for k, lag in lags)
    averages = count / (1 + alike)
    lines = np.asarray(np.fft.rfftfreq(size, 1 / rate)[1:], dtype=np.float64)
    if several > 1 and (estimator != H1 or averages < several + 1):
        problem = f"{estimator} of {averages:.0f} averages does not tell {several} forces at a time apart"
        raise BadInput(source, "records", problem, f"Take H1, of {several + 1} blocks or more, or a file for each force")
    values, coherence = _averaged(spectra[:, :, :several], spectra[:, :, several:], estimator, source)
    averages -= several - 1
    said = [f"{one}; take a longer block" for one in _unresolved(lines, np.hstack(list(values)), window, end)]
    reach = float(lines[-1])
    if averages < 2:
        coherence = np.ones_like(coherence)
        if said:  # neither a shorter nor a longer block mends both
            said = [said[0].replace("take a longer block", "a single average tells no coherence, either: record for longer")]
        else:
            said = ["a single average tells no coherence; take a shorter block"]
    return Estimate(
        frequency=lines,
        values=values,
        coherence=coherence,
        averages=int(averages + 1e-9),
        reach=reach,
        smeared=float(window == "hann" and np.vdot(f[:-size], f[size:]) < PERIODIC * np.vdot(f[:-size], f[:-size])),
        warnings=tuple(f"{source}: {one}" for one in said),
    )


PERIODIC = 0.5
"""[1] Correlation of a force with itself a block later, from which it is the same in every block: nothing leaks then. By
definition."""

APART = 0.02
"""[share] What no other force explains of one, in the mean over lines, below which they are one. Held by test_test_files.py."""


def _averaged(F: ComplexArray, X: ComplexArray, estimator: str, source: str) -> tuple[ComplexArray, Array]:
    """Functions and coherence (r, n, c) of spectra (b, n, r) of forces and (b, n, c) of responses."""
    tiny, count = np.finfo(np.float64).tiny, len(F)
    S_ff = np.einsum("bnr,bns->nrs", F, F.conj()) / count
    S_xf, S_xx = np.einsum("bnc,bnr->nrc", X, F.conj()) / count, np.mean(np.abs(X) ** 2, axis=0)
    own = np.einsum("nrr->nr", S_ff).real
    if np.any(own <= tiny):
        raise BadInput(source, "force", "drives nothing at some lines", "Look at the record")
    scale = np.sqrt(own)
    alone = np.linalg.inv(S_ff / scale[:, :, None] / scale[:, None, :] + 1e-9 * np.eye(F.shape[2]))  # of copies there is none
    apart = 1 / np.maximum(np.einsum("nrr->nr", alone).real, 1.0)
    if (least := float(apart.mean(axis=0).min())) < APART:
        problem = f"{F.shape[2]} forces are as one: others explain {100 * (1 - least):.1f} % of one of them"
        raise BadInput(source, "drive", problem, "Drive them by independent signals, or one by one")
    values = np.einsum("nrs,nsc->nrc", (alone / scale[:, :, None] / scale[:, None, :]).transpose(0, 2, 1), S_xf)
    left = np.maximum(S_xx - np.einsum("nrc,nrc->nc", values, S_xf.conj()).real, 0.0)[:, None]
    power = np.abs(values) ** 2 * (own * apart)[:, :, None]
    coherence = power / np.maximum(power + left, tiny)
    if estimator == H2:
        values = S_xx[:, None] / np.where(np.abs(S_xf) > tiny, S_xf.conj(), tiny)
    elif estimator == HV:
        values = np.sqrt(S_xx[:, None] / own[:, :, None]) * np.exp(1j * np.angle(S_xf))
    return values.transpose(1, 0, 2), coherence.transpose(1, 0, 2)


def _require_alive(force: Array, responses: Array, source: str) -> None:
    for name, channel in (("force", force), ("response", responses)):
        if not np.all(np.isfinite(channel)):
            raise BadInput(source, name, "holds NaN or infinity", "Export the record again")
        if np.any(np.ptp(channel, axis=0) == 0):
            raise BadInput(source, name, "is silent: it never changes", "Look at its cable")


def clipped(channel: Array) -> bool:
    """Whether a channel (n,) stays at its largest or least value for `CLIPPED` samples in a row, or comes there, and no further,
    from `RETURNS` different values, none of them within rounding of it."""
    resolution = float(np.diff(np.unique(channel)).min(initial=np.inf))
    for end in (channel.max(), channel.min()):
        at = np.abs(channel - end) <= 1e-9 * np.ptp(channel)
        before = channel[:-1][at[1:] & ~at[:-1]]
        far = before[np.abs(before - end) > max(ROUNDED * resolution, 1e-6 * np.ptp(channel))]
        if _stays(channel, end) or len(np.unique(np.round(far / (1e-6 * np.ptp(channel))))) >= RETURNS:
            return True
    return False


def _stays(channel: Array, end: float, count: int = CLIPPED) -> bool:
    at = np.concatenate([[False], np.abs(channel - end) <= 1e-9 * np.ptp(channel), [False]])
    edges = np.flatnonzero(np.diff(at.astype(np.int8)))
    return bool(np.any(edges[1::2] - edges[::2] >= count))


def _unresolved(f: Array, values: ComplexArray, window: str, end: float) -> list[str]:
    """What is to be said of the highest peak of every function, where it lies below `end` [Hz], if too few lines make it."""
    said = []
    width = 4 if window == "hann" else 3
    for c in range(values.shape[1]):
        level = np.abs(values[:, c])
        k = int(np.argmax(level))
        low, high = k, k
        while low > 0 and level[low - 1] > level[k] / np.sqrt(2):
            low -= 1
        while high < len(level) - 1 and level[high + 1] > level[k] / np.sqrt(2):
            high += 1
        if high - low + 1 < width and 0 < k < len(level) - 1 and f[k] <= end:
            said.append(
                f"the peak at {f[k]:.4g} Hz is {high - low + 1} of {width} lines wide: {f[1] - f[0]:.3g} Hz are too coarse for "
                "its damping, which will seem larger"
            )
    return said[:1]


# A hammer: blows are found, judged, windowed and averaged.


@dataclass(frozen=True, eq=False, kw_only=True)
class Blow:
    """One blow.

    Attributes
    ----------
    at : [s] of its peak in the record
    force, responses : (n,), (n, c) of its block
    fault : what is wrong with it, in words; empty for nothing
    """

    at: float
    force: Array
    responses: Array
    fault: str


def blows(
    force: npt.ArrayLike,
    responses: npt.ArrayLike,
    rate: float,
    *,
    block: float = 0.0,
    source: str = "record",
    names: Sequence[str] = (),
) -> list[Blow]:
    """The blows of a record, each with its faults: double hits, overload.

    Parameters
    ----------
    block : [s] from a little before a blow; 0 for the time to the next one
    names : of the responses, where they have some

    Raises
    ------
    BadInput : no blow, a block that does not fit behind any.
    """
    f, x = np.asarray(force, dtype=np.float64), np.asarray(responses, dtype=np.float64)
    _require_alive(f[:, None], x, source)
    f = f - np.median(f)
    sign = 1.0 if f.max() >= -f.min() else -1.0
    quiet = 1.4826 * np.median(np.abs(f)) * 8
    hardest = float(np.max(sign * f))
    if hardest <= max(quiet, 0.0):
        problem = f"no blow stands out of its noise: its largest value is {hardest:.3g}"
        raise BadInput(source, "force", problem, "Check trigger, cable and channel")
    over = np.flatnonzero(sign * f > HIT * hardest)
    # Peaks that lie closer than what a block takes belong to one blow
    least = round(block * rate * (1 - BEFORE)) if block else len(f) // 50
    first = [int(over[0])]
    for k in over[1:]:
        if k - first[-1] > least:
            first.append(int(k))
    gaps = np.diff([*first, len(f)])
    size = round(block * rate) if block else int(gaps.min() if len(first) > 1 else gaps[0])
    found = []
    for k in first:
        start = k - round(BEFORE * size)
        if start < 0 or start + size > len(f):
            start = max(0, min(start, len(f) - size))
        own, answer = f[start : start + size], x[start : start + size] - x[start : max(start + 1, (start + k) // 2)].mean(axis=0)
        if len(own) < size or size < 16:
            continue
        found.append(Blow(at=k / rate, force=own, responses=answer, fault=_fault(sign * own, answer, quiet, names)))
    if not found:
        problem = f"a block of {block:g} s does not fit behind any blow of a record of {len(f) / rate:g} s"
        raise BadInput(source, "records.block", problem, "Give a shorter one")
    return found


OVERLOADED = "the force is overloaded"


def _fault(force: Array, responses: Array, quiet: float, names: Sequence[str]) -> str:
    k = int(np.argmax(force))
    peak = force[k]
    if _stays(force, peak):
        return OVERLOADED
    if over := [c for c in range(responses.shape[1]) if clipped(responses[:, c])]:
        return f"{', '.join(names[c] for c in over) if names else 'a response'} is overloaded"
    below = np.flatnonzero(force[k:] < OVER * peak)
    early = np.flatnonzero(force[:k] > max(AGAIN * peak, quiet))
    after = force[k + below[0] :] if len(below) else np.zeros(0)
    if len(after) and after.max() > max(AGAIN * peak, quiet):
        return f"it is a double hit: {100 * after.max() / peak:.0f} % of it follow"
    if len(early) and np.any(force[early[0] : k] < OVER * peak):
        return "it is a double hit: a softer one comes before"
    return ""


def struck(found: Sequence[Blow], rate: float, *, decay: float = 0.0, estimator: str = H1, source: str = "record") -> Estimate:
    """Of the blows that have no fault; what is wrong with the others is said.

    Parameters
    ----------
    decay : [s] time constant of the exponential window that force and responses get; 0 for none

    Raises
    ------
    BadInput : every blow has a fault.
    """
    tops = [float(np.abs(one.force).max()) for one in found]
    flat = [k for k, one in enumerate(found) if _stays(np.abs(one.force), tops[k], FLAT)]
    for k in flat:  # a pulse is over before it stays for long, but no two different ones end at one force
        same = (found[j].force for j in flat if abs(tops[j] - tops[k]) <= 1e-9 * tops[k])
        if any(not np.allclose(np.sort(np.abs(one))[-8:], np.sort(np.abs(found[k].force))[-8:], rtol=1e-6) for one in same):
            found = [replace(one, fault=one.fault or OVERLOADED) if j == k else one for j, one in enumerate(found)]
    good = [one for one in found if not one.fault]
    warnings = [f"{source}: the blow at {one.at:.4g} s is left out, {one.fault}" for one in found if one.fault]
    if not good:
        said = "; ".join(f"at {one.at:.4g} s {one.fault}" for one in found)
        raise BadInput(source, "force", f"none of {len(found)} blows can be used: {said}", "Strike again")
    size = min(len(one.force) for one in good)
    time = np.arange(size) / rate
    window = np.exp(-time / decay) if decay > 0 else np.ones(size)
    spectra = []
    for one in good:
        # The force with nothing but its blow: zero before it and once it is over, where a load cell only has noise
        own = one.force[:size]
        k = int(np.argmax(np.abs(own)))
        peak = np.abs(own[k])
        small = np.abs(own) < OVER * peak
        after = np.flatnonzero(small[k:])
        before = np.flatnonzero(small[: k + 1])
        half = max(4, (after[0] if len(after) else 4), (k - before[-1]) if len(before) else 4)
        low, high = max(0, k - 3 * half), min(len(own), k + 3 * half + 1)
        kept = np.zeros_like(own)
        kept[low:high] = own[low:high]
        both = np.column_stack([kept, one.responses[:size]])
        spectra.append(np.fft.rfft(both * window[:, None], axis=0))
    blocks = np.array(spectra)
    lines = np.asarray(np.fft.rfftfreq(size, 1 / rate), dtype=np.float64)
    level = np.sqrt(np.mean(np.abs(blocks[:, :, 0]) ** 2, axis=0))
    driven = np.flatnonzero(level > REACH * level.max())
    reach = float(lines[driven[-1]])
    values, coherence = _averaged(blocks[:, :, :1], blocks[:, :, 1:], estimator, source)
    if len(good) == 1:
        coherence = np.ones_like(coherence)
    if len(good) > 2:
        # Blows whose functions lie far from those of all others
        H = blocks[:, driven, 1:] / blocks[:, driven, :1]
        apart = []
        for k in range(len(H)):
            others = np.median(np.abs(np.delete(H, k, axis=0) - H[k]), axis=0)
            apart.append(float(np.sqrt(np.mean(others**2) / np.mean(np.abs(H[k]) ** 2))))
        usual = float(np.median(apart))
        warnings += [
            f"{source}: the blow at {one.at:.4g} s has poor coherence: {100 * far:.0f} % from the others, which lie "
            f"{100 * usual:.0f} % from each other; was it beside its point or crooked, or did all move from the one before?"
            for one, far in zip(good, apart, strict=True)
            if far > OUT_OF_LINE * usual and far > 0.03
        ]
    # Faded out to where a blow drives nothing, for an edge would ring in itself. The last `BEFORE` are what came before the blow
    faded = np.square(np.cos(np.pi / 2 * np.clip(2 * lines / reach - 1, 0.0, 1.0)))
    smooth, near, g2 = values[0] * faded[:, None], max(2, round(BEFORE * size)), np.maximum(coherence[0], 1e-6)
    impulse = np.abs(np.fft.irfft(smooth, size, axis=0))
    noise = np.sqrt(2 * np.sum(np.abs(smooth) ** 2 * (1 - g2) / (g2 * len(good)), axis=0)) / size
    last = impulse[-size // 20 - near : -round(1.1 * near)].max(axis=0)
    left = np.where(last > LOUD * noise, last / impulse[near : size // 2].max(axis=0), 0.0)
    return Estimate(
        frequency=lines[1:],
        values=values[:, 1:],
        coherence=coherence[:, 1:],
        averages=len(good),
        reach=reach,
        rings=float(left.max()) if np.any(left > RINGS) else 0.0,
        warnings=tuple(warnings),
    )
