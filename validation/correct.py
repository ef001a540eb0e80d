"""A campaign with one fault of its measurement taken out: of its signals, or of what its channel table says.

The value is the fault, with the sign of the catalogue: `force-gain:fmd-z2=0.08` says that the channel reads 8 % too much, and the
corrected copy holds 1/1.08 of it. What is corrected is exactly what `validation.virtual_test` plants, and nothing is corrected
that a record alone does not tell how to.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, replace
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, rotation_by
from geometry.sensors import Channel, Place
from identification.campaign import Campaign, Processing, Recording, factor
from validation.effects.catalogue import FAMILIES, MISTAKEN_UNIT, Named, parse
from validation.effects.effect import AMPLITUDE, AXES, CHANNEL_STAGE, PENDULUM, STRUCTURE, Vocabulary
from validation.effects.stages import ChannelResponse
from validation.output import entry

# Signals with a delay or a high-pass taken out: time histories by their Fourier transform, spectra line by line.
#
# A record is no period of anything. Before the transform it is continued beyond both ends by its own mirror image through the
# end point, so that value and slope go on, and faded to a constant there: what the transform wraps round meets nothing. What a
# shift brings in from beyond an end was never recorded, and is of that continuation.


Samples = npt.NDArray[Any]
Response = Callable[[Array], ComplexArray]
"""By frequency (n,) [Hz], from 0 on, what a line is multiplied with: (n,), or (n, k, k) where k channels mix."""

MARGIN = 4096
"""Samples of the continuation at each end, or as many as the record has."""


def filtered(recording: Recording, columns: Sequence[int], response: Response) -> Recording:
    """`recording` with `columns` through a filter of this frequency response."""
    values = np.array(recording.values)
    if recording.frequency is not None:
        values[:, columns] = _times(response(recording.frequency), values[:, columns])
    elif recording.sampling_rate is not None:
        values[:, columns] = through(values[:, columns], recording.sampling_rate, response)
    return replace(recording, values=values)


def through(values: Samples, rate: float, response: Response) -> Array:
    """Time histories `values` (n, k) at `rate` [Hz] through the filter."""
    from scipy.fft import irfft, next_fast_len, rfft, rfftfreq

    n = len(values)
    margin = min(n - 1, MARGIN)
    length = next_fast_len(n + 2 * margin, real=True)
    # `values` (n, k) with `margin` and `after` samples beyond its ends
    after = length - n - margin
    mean = values.mean(axis=0)
    head = 2 * values[0] - values[margin:0:-1]
    short = min(after, len(values) - 1)
    tail = np.full((after, values.shape[1]), mean)
    tail[:short] = (2 * values[-1] - values[-2 : -2 - short : -1] - mean) * _fading(short)[:, None] + mean
    continued = np.concatenate([(head - mean) * _fading(margin)[::-1, None] + mean, values, tail])
    spectra = _times(response(rfftfreq(length, 1 / rate)), rfft(continued, axis=0))
    return np.asarray(irfft(spectra, n=length, axis=0)[margin : margin + n])


def advanced(seconds: float) -> Response:
    """What comes so many seconds earlier: ``e^{i omega tau}``."""
    return lambda frequency: np.asarray(np.exp(2j * np.pi * seconds * frequency), dtype=np.complex128)


def _times(factors: ComplexArray, spectra: ComplexArray) -> ComplexArray:
    if factors.ndim == 1:
        return np.asarray(factors[:, None] * spectra)
    return np.asarray((factors @ spectra[:, :, None])[:, :, 0])


def _fading(count: int) -> Array:
    """(count,) from nearly 1 to nearly 0, even at both ends."""
    return np.asarray(0.5 * (1 + np.cos(np.pi * (np.arange(count) + 1) / (count + 1))))


# The inverse of an effect that has an equation of the channels: what a user's own families are corrected with.
#
# Such an equation is linear in the rows that it gets, so what it makes of the unit matrix is what it makes of any channels,
#
#     y' = R(f) y,
#
# and a record is rid of it by the inverse of R, line by line.


WORST = 1e4
"""Condition number beyond which noise would be blown up out of all proportion."""


def inverse(named: Named, channels: tuple[str, ...], chosen: Sequence[int], held: float) -> Response:
    """R^-1 of the `chosen` of `channels`, (n, k, k); below `held` [Hz] that of this frequency."""

    def response(frequency: Array) -> ComplexArray:
        lines = np.maximum(frequency, held)
        matrix = _matrix(named, channels, lines)[:, chosen][:, :, chosen]
        singular = np.linalg.svd(matrix, compute_uv=False)
        lost = np.flatnonzero(~(singular[:, -1] * WORST > singular[:, 0]))
        if len(lost):
            problem = f"cannot be taken out of a record: at {lines[lost[0]]:.4g} Hz its equation leaves nothing of the signal"
            raise BadInput(named.id, "", problem, ADD.format(named=named))
        return np.asarray(np.linalg.inv(matrix))

    return response


def _matrix(named: Named, channels: tuple[str, ...], frequency: Array) -> ComplexArray:
    """(n, c, c) R."""
    change = FAMILIES[named.family].change
    if change is None:
        raise ValueError(f"`named` must have an equation, found {named.family}")
    rows = np.broadcast_to(np.eye(len(channels), dtype=np.complex128), (len(frequency), len(channels), len(channels)))
    return np.asarray(
        change(ChannelResponse(frequency=frequency, channels=channels, rows=rows), named.targets, named.values).rows
    )


# Why an effect cannot be taken out of a record, and what to do instead.


ADD = "Add it to the model instead: massline add MODEL {named}"

OF_SIDE = {
    STRUCTURE: ("it changes the structure, and what the structure does is what was measured", ADD),
    AMPLITUDE: ("it depends on how far the structure moved, and a record is not linear in it", ADD),
    PENDULUM: (
        "it is an error of a pendulum's period, and a campaign has none",
        "Correct the pendulum's file: massline pendulum",
    ),
}

SHARING = "which of the cells carried what must be known to take it apart, and only a fit of the whole chain tells"

OF_A_TEST = "it is a fault of a test of a structure, and a campaign of base motion has none"
TEST_REMEDY = "Correct the test's own file, or massline add MODEL {named} DATA"

OF_FAMILY = {
    **dict.fromkeys(("force-misalignment", "force-position", "exponential-window", "leakage"), (OF_A_TEST, TEST_REMEDY)),
    **dict.fromkeys(("transducer-mass", "wrong-direction", "wrong-place", "wrong-reference"), (OF_A_TEST, TEST_REMEDY)),
    "force-crosstalk": (SHARING, ADD),
    "force-plane-offset": (SHARING, ADD),
    "cell-stiffness": (SHARING, ADD),
    "fmd-compliance": ("how far the cells gave depends on the load on them, which only a model tells", ADD),
    "cover-plate-flexibility": ("how far the plate gave depends on the load on it, which only a model tells", ADD),
    "accelerometer-tilt": (
        "what a tilt adds depends on the motion of the whole plate",
        "Say senses_gravity = true or false of the channel in campaign.toml",
    ),
    "saturation": ("what was lost depends on the peak of a signal that was never recorded", "Repeat the run at half the level"),
    "noise": ("it is random, and nothing tells what it was", "Repeat the run, or say noise_rms of the channel in campaign.toml"),
    "mains": ("its phase differs from run to run", "Leave the line and its harmonics out of the band: massline identify --band"),
    "sweep-bias": (
        "it arises where spectra are made of a record, which holds nothing of it",
        'Evaluate with [processing] method = "full-record"',
    ),
}


BOARDS = {"force": ("fmd",), "cover": ("cover",), "table": ("table",)}
"""Groups of the channels that a board holds."""

PARALLEL = 1e-9
"""What is less of a direction is rounding."""

HELD = 0.01
"""Of the lowest line, below which the inverse of a high-pass is held back: at that line it is short by 1e-4 of itself."""

LOWEST = 0.1
"""[Hz] of the lowest line, where a campaign says 0."""


Correct = Callable[[Campaign, Named], "Corrected"]

CORRECTIONS: dict[str, Correct] = {}
"""What can be taken out of a record, by family."""


def _takes_out(*families: str) -> Callable[[Correct], Correct]:
    """The function below is the correction of `families`."""

    def put(correct: Correct) -> Correct:
        CORRECTIONS.update(dict.fromkeys(families, correct))
        return correct

    return put


@dataclass(frozen=True, eq=False, kw_only=True)
class Corrected:
    """A corrected campaign.

    Attributes
    ----------
    campaign : whole, its notes saying what was corrected
    channels : names of those that changed, in signal or table
    did : what was done to them, in words
    """

    campaign: Campaign
    channels: tuple[str, ...]
    did: str


def corrected(campaign: Campaign, named: Named) -> Corrected:
    """`campaign`, recordings and all, without the fault `named`.

    Raises
    ------
    BadInput : a fault that cannot be taken out of a record, and why; one that nothing of this campaign could have.
    """
    # A family of the user's own: an equation of the channels that does not ask how the run was driven
    family = FAMILIES[named.family]
    own = family.stage == CHANNEL_STAGE and family.change is not None and family.side != AMPLITUDE
    correction = CORRECTIONS.get(named.family, _by_equation if own else None)
    if correction is None:
        why, remedy = OF_FAMILY.get(named.family) or OF_SIDE.get(family.side) or ("no inverse of its equation is known", ADD)
        raise BadInput(named.id, "", f"cannot be taken out of a record: {why}", remedy.format(named=named))
    if named.values and all(named.values[size.key] == size.null for size in named.sizes):
        raise _idle(named, "this is the size of no effect")
    found = correction(campaign, named)
    notes = "; ".join(part for part in (campaign.notes, f"corrected: {named} taken out ({found.did})") if part)
    return replace(found, campaign=replace(found.campaign, notes=notes))


@_takes_out("force-gain", "accelerometer-gain")
def _gain(campaign: Campaign, named: Named) -> Corrected:
    return _scaled(campaign, {named.target: 1 / (1 + named.value)}, noise=True)


@_takes_out("unit")
def _unit(campaign: Campaign, named: Named) -> Corrected:
    return _scaled(campaign, {named.target: 1 / named.value})


@_takes_out("polarity")
def _polarity(campaign: Campaign, named: Named) -> Corrected:
    return replace(_scaled(campaign, {named.target: -1.0}), did="its sign is turned")


@_takes_out("load-path-shunt")
def _shunt(campaign: Campaign, named: Named) -> Corrected:
    axis, shares = np.eye(3)[AXES.index(named.target)], {}
    for k in campaign.table.select(group="fmd"):
        # How much of what it reads is force along the axis: the same for all of its cells, or nobody can take it apart
        channel = campaign.table.channels[k]
        along = [float(place.direction @ axis) ** 2 for place in channel.places]
        problem = ""
        if channel.quantity == "moment":
            problem = f"{channel.name} is a moment, and how much of it passed the cells by is not known"
        elif np.ptp(along) > PARALLEL:
            problem = f"{channel.name} adds up cells of several directions, which lost different shares"
        if problem:
            raise BadInput(named.id, "", problem, "Give the cells' own channels, or add the effect to the model")
        shares[channel.name] = along[0]
    factors = {name: 1 / (1 - named.value * share) for name, share in shares.items() if share > PARALLEL}
    if not factors:
        raise _idle(named, f"no load cell measures along {named.target}")
    return _scaled(campaign, factors, noise=True)


def _scaled(campaign: Campaign, factors: Mapping[str, float], *, noise: bool = False) -> Corrected:
    """Channels times `factors`; `noise` takes the stated noise floor, which was that of the record, along."""
    by = np.array([factors.get(name, 1.0) for name in campaign.table.names])
    made = _recorded(campaign, lambda recording: replace(recording, values=recording.values * by))
    if noise:
        made = _tabled(
            made, factors, lambda c: replace(c, noise_rms=None if c.noise_rms is None else c.noise_rms * factors[c.name])
        )
    one = {f"{factor:.6g}" for factor in factors.values()}
    return Corrected(campaign=made, channels=tuple(factors), did=f"multiplied by {', '.join(sorted(one))}")


@_takes_out("channel-swap")
def _swap(campaign: Campaign, named: Named) -> Corrected:
    order = list(range(len(campaign.table)))
    one, other = (campaign.table.names.index(name) for name in named.targets)
    order[one], order[other] = other, one
    made = _recorded(campaign, lambda recording: replace(recording, values=recording.values[:, order]))
    return Corrected(campaign=made, channels=named.targets, did="what each of them measured stands under its own name")


@_takes_out("force-delay", "accelerometer-delay")
def _delay(campaign: Campaign, named: Named) -> Corrected:
    return _filtered(campaign, [named.target], advanced(named.value), f"shifted by {-1e6 * named.value:.6g} us")


@_takes_out("board-delay")
def _board(campaign: Campaign, named: Named) -> Corrected:
    names = [campaign.table.names[k] for k in campaign.table.select(group=BOARDS[named.target])]
    if not names:
        raise _idle(named, f"it has no channel of the group {BOARDS[named.target][0]}")
    return _filtered(campaign, names, advanced(named.value), f"shifted by {-1e6 * named.value:.6g} us")


@_takes_out("force-highpass")
def _highpass(campaign: Campaign, named: Named) -> Corrected:
    held, column = _held(campaign), campaign.table.names.index(named.target)

    # 1 - i f_c / f, 1 at 0 Hz, of which nothing is left; it grows without end towards 0 Hz, where a record has drift and offset,
    # and is held back there, 1 - i f_c f / (f² + held²)
    def raised(recording: Recording) -> Recording:
        def response(frequency: Array) -> ComplexArray:
            square = frequency**2 + (0.0 if recording.is_spectrum else held) ** 2
            share = np.divide(frequency, square, out=np.zeros_like(square), where=square > 0)
            return np.asarray(1 - 1j * named.value * share, dtype=np.complex128)

        return filtered(recording, [column], response)

    did = f"the corner of {named.value:g} Hz taken out, of time histories from {10 * held:.3g} Hz up"
    return Corrected(campaign=_recorded(campaign, raised), channels=(named.target,), did=did)


def _by_equation(campaign: Campaign, named: Named) -> Corrected:
    """A family of the user's own."""
    names, held = campaign.table.names, _held(campaign)
    lines = np.array([100 * held, 1000 * held])
    # Which channels it changes, and which it needs to: these and those that leak in
    change = np.abs(_matrix(named, names, lines) - np.eye(len(names))).max(axis=0) > 0
    changed = np.flatnonzero(change.any(axis=1))
    chosen = [int(k) for k in np.flatnonzero(change.any(axis=1) | change.any(axis=0))]
    if not len(changed):
        raise _idle(named, "its equation changes no channel")
    made = _recorded(campaign, lambda one: filtered(one, chosen, inverse(named, names, chosen, held)))
    return Corrected(campaign=made, channels=tuple(names[k] for k in changed), did="the inverse of its equation")


def _held(campaign: Campaign) -> float:
    """[Hz], below which an inverse that grows is held back."""
    return HELD * max((campaign.processing or Processing()).start, LOWEST)


def _filtered(campaign: Campaign, names: Sequence[str], response: Response, did: str) -> Corrected:
    columns = [campaign.table.names.index(name) for name in names]
    made = _recorded(campaign, lambda recording: filtered(recording, columns, response))
    return Corrected(campaign=made, channels=tuple(names), did=did)


@_takes_out("accelerometer-position")
def _position(campaign: Campaign, named: Named) -> Corrected:
    shift = named.value * np.eye(3)[AXES.index(named.targets[1])]
    return _placed(campaign, named, lambda place: replace(place, position=place.position + shift), "its place")


@_takes_out("accelerometer-misalignment")
def _misalignment(campaign: Campaign, named: Named) -> Corrected:
    turn = rotation_by(named.value * np.eye(3)[AXES.index(named.targets[1])])
    made = _placed(campaign, named, lambda place: replace(place, direction=turn @ place.direction), "its direction")
    pairs = zip(_channel(campaign, named).places, _channel(made.campaign, named).places, strict=True)
    if named.value and all(np.abs(a.direction - b.direction).max() < PARALLEL * abs(named.value) for a, b in pairs):
        raise _idle(named, f"a turn about {named.targets[1]}, along which it measures, changes nothing of what it reads")
    return made


def _placed(campaign: Campaign, named: Named, change: Callable[[Place], Place], what: str) -> Corrected:
    made = _tabled(campaign, [named.target], lambda c: replace(c, places=tuple(map(change, c.places))))
    return Corrected(campaign=made, channels=(named.target,), did=f"{what} in the channel table is the true one")


def _channel(campaign: Campaign, named: Named) -> Channel:
    return campaign.table.channels[campaign.table.names.index(named.target)]


def _recorded(campaign: Campaign, change: Callable[[Recording], Recording]) -> Campaign:
    return replace(campaign, recordings={name: change(one) for name, one in campaign.recordings.items()})


def _tabled(campaign: Campaign, names: Sequence[str] | Mapping[str, float], change: Callable[[Channel], Channel]) -> Campaign:
    channels = tuple(change(channel) if channel.name in names else channel for channel in campaign.table.channels)
    return replace(campaign, table=replace(campaign.table, channels=channels))


def _idle(named: Named, why: str) -> BadInput:
    return BadInput(named.id, "", f"there is nothing to correct: {why}", "Check the target")


# Faults as they are typed, taken out one upon the other, and what that changed.


EFFECT = "EFFECT"


@dataclass(frozen=True, kw_only=True)
class ChannelLevel:
    """Root mean square of a channel over all runs, SI, before the first and after the last correction."""

    name: str
    rms_before: float
    rms_after: float


@dataclass(frozen=True, eq=False, kw_only=True)
class AppliedCorrection:
    """A fault that was taken out, what was done, and to which channels."""

    named: Named = entry("id", write=lambda named: named.id)
    value: float | Mapping[str, float]
    unit: str
    did: str
    channels: tuple[ChannelLevel, ...]


def asked(text: str, campaign: Campaign) -> Named:
    """The fault that `text` names, on a channel that the described `campaign` has.

    Raises
    ------
    BadInput : see `validation.effects.catalogue.parse`; a fault that no record can be rid of.
    """
    names = campaign.table.names
    accelerometers, forces = (
        tuple(names[k] for k in campaign.table.select(quantity=quantity)) for quantity in ("acceleration", ("force", "moment"))
    )
    words = Vocabulary(accelerometers=accelerometers, forces=forces, places=None, parts=None)
    named = parse(text, words, source=EFFECT)
    if named.family == MISTAKEN_UNIT:
        try:
            float(text.partition("=")[2])
        except ValueError:  # a word: what the record is in, where the table states another
            channel = _channel(campaign, named)
            stated = factor(channel.unit, channel.quantity, source=EFFECT, field=named.id)
            named = replace(named, values={"": named.value * stated})
    corrected(campaign, named)  # without recordings as yet: what cannot be done is said before they are read
    return named


def in_turn(campaign: Campaign, faults: Sequence[Named]) -> tuple[Campaign, tuple[AppliedCorrection, ...]]:
    """`campaign` without all of `faults`, one taken out after the other, and what each of them was."""
    steps, made = [], campaign
    for named in faults:
        steps.append(corrected(made, named))
        made = steps[-1].campaign
    levels = {
        name: ChannelLevel(name=name, rms_before=_level(campaign, name), rms_after=_level(made, name))
        for name in dict.fromkeys(name for step in steps for name in step.channels)
    }
    return made, tuple(
        AppliedCorrection(
            named=named,
            value=named.value if set(named.values) <= {""} else dict(named.values),
            unit=named.unit,
            did=step.did,
            channels=tuple(levels[name] for name in step.channels),
        )
        for named, step in zip(faults, steps, strict=True)
    )


def _level(campaign: Campaign, channel: str) -> float:
    squares = [np.mean(np.abs(one.channel(channel)) ** 2) for one in campaign.recordings.values()]
    return float(np.sqrt(np.mean(squares)))
