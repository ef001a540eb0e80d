"""Every explanation that can be put in words, with what it would explain of an unexplained residual, the best first."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from types import MappingProxyType

import numpy as np

from geometry.dynamic_mass import MOTIONS
from geometry.inertia import LOADS
from geometry.sensors import GROUPS
from validation.diagnose import unexplained_fit as fit
from validation.diagnose import unexplained_places as sites
from validation.diagnose.diagnosis import Candidate, Leftover
from validation.estimation.screening import Products
from validation.prediction.series import SeriesPrediction

NEAR = 0.04
"""[share] of its frequency to either side in which a resonance is looked for again. Exercised by test_unexplained.py."""

STEPS = 17
"""[count] of frequencies there. Exercised by test_unexplained.py."""

TIMES = (0.35, 0.6, 1.0, 1.7, 3.0)
"""[factor] on its damping ratio, at each frequency. Held by test_unexplained.py."""

BEST = 4
"""[count] of explanations of one kind of place and one scope that are kept. Exercised by test_unexplained.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Explanation:
    """One place that goes with frequency in one way.

    Attributes
    ----------
    place, course : where, and how it goes with frequency
    data_set : where it acts alone; empty where it acts in all
    gain : [nats]
    size : coefficient of the course
    sources : families that it is of, and where it stands in each
    """

    place: sites.SuspectedPlace
    course: fit.FrequencyLaw
    data_set: str
    gain: float
    size: float
    sources: tuple[tuple[sites.PlaceFamily, int], ...] = field(default=(), repr=False)


@dataclass(frozen=True, eq=False, kw_only=True)
class PlaceScores:
    """What one data set answers to places of one kind.

    Attributes
    ----------
    key : of the same places and courses in other data sets
    data_set : its name
    courses, places : (k,) and (q,)
    answers : (k, q)
    family : that answers; None where there is none for every course
    """

    key: str
    data_set: str
    courses: tuple[fit.FrequencyLaw, ...]
    places: tuple[sites.SuspectedPlace, ...]
    answers: fit.Answers
    family: sites.PlaceFamily | None = None

    def answers_at(self, places: tuple[sites.SuspectedPlace, ...]) -> fit.Answers:
        """To all of `places`, none to those that are not there."""
        if self.places == places:
            return self.answers
        at, of = [places.index(place) for place in self.places], self.answers
        score, own = (np.zeros((len(of.score), len(places))) for _ in range(2))
        swallowed = np.zeros((*score.shape, of.swallowed.shape[-1]))
        score[:, at], own[:, at], swallowed[:, at] = of.score, of.own, of.swallowed
        return fit.Answers(score=score, own=own, swallowed=swallowed)


def ranked(candidate: Candidate, data: Sequence[fit.Swallowing]) -> list[Explanation]:
    """All explanations of what `candidate` leaves in its `data`, the best first; of one kind of place the best in each data set
    alone and in all together."""
    offsets, slope = {**candidate.problem.start, **candidate.fit.by_name}, data[0].slope
    told: dict[str, list[PlaceScores]] = {}
    matrices: list[sites.Spanned] = []
    for of in (one for one in data if len(one.of.frequency) > 1):  # a table of modes goes with no frequency
        loads = sites.Loaded.by_model(of, offsets)
        matrices += [] if loads is None else [loads.spanned]
        scores = [
            PlaceScores(
                key=f"{family.places[0].kind} {family.places[0].to}",
                data_set=of.of.name,
                courses=family.courses,
                places=family.places,
                answers=family.answers(),
                family=family,
            )
            for family in sites.families(of, offsets, loads)
        ]
        for k, (places, course, answers) in enumerate(sites.crosstalk(of, offsets)):
            scores.append(
                PlaceScores(key=f"{sites.CROSSTALK} {k}", data_set=of.of.name, courses=(course,), places=places, answers=answers)
            )
        for each in scores:
            told.setdefault(each.key, []).append(each)
    found: list[Explanation] = []
    for alike in told.values():
        for one in alike:
            found += _best([one], one.places, fit.gains([one.answers], slope), one.data_set if len(alike) > 1 else "")
        if len(alike) > 1:
            every = tuple(dict.fromkeys(place for one in alike for place in one.places))
            found += _best(alike, every, fit.gains([one.answers_at(every) for one in alike], slope), "")
    for some in (matrices, *([one] for one in matrices if len(matrices) > 1)) if matrices else ():
        for span in sites.spans(some, slope):
            alone = some[0].data_set if len(some) < len(matrices) else ""
            found.append(Explanation(place=span.place, course=span.course, data_set=alone, gain=span.gain, size=span.size))
    return sorted(found, key=lambda one: -one.gain)


def _best(
    alike: Sequence[PlaceScores], places: Sequence[sites.SuspectedPlace], found: fit.Gains, data_set: str
) -> Iterator[Explanation]:
    courses = alike[0].courses
    for at in np.argsort(-found.gain, axis=None)[:BEST]:
        k, q = (int(one) for one in np.unravel_index(int(at), found.gain.shape))
        yield Explanation(
            place=places[q],
            course=courses[k],
            data_set=data_set,
            gain=float(found.gain[k, q]),
            size=float(found.size[k, q]),
            sources=tuple((one.family, one.places.index(places[q])) for one in alike if one.family and places[q] in one.places),
        )


# What an unexplained residual looks like, in words: for somebody who knows axes and channels and nothing of this program.


UNITS: Mapping[str, tuple[str, str, str]] = MappingProxyType(
    {
        "kg": ("kg", "kg m", "kg m^2"),
        "N/m": ("N/m", "N", "N m"),
        "N s/m": ("N s/m", "N s", "N s m"),
        "m/N": ("m/N", "1/N", "1/(N m)"),
    }
)
"""Of an entry of the dynamic mass between two translations, one and a rotation, two rotations."""

OF_PARTS: Mapping[str, tuple[str, str]] = MappingProxyType(
    {
        "modulus": (fit.STIFFNESS, "the stiffness of {}"),
        "loss": (fit.DAMPING, "the loss of {}"),
        "damping-law": (fit.DAMPING, "how far losses follow the velocity"),
        "cell-stiffness": (fit.STIFFNESS, "the stiffness of load cell {}"),
        "fmd-compliance": (fit.STIFFNESS, "how far the FMD gives, {}"),
        "frequency": (fit.RESONANCE, "the resonance at {}"),
        "damping": (fit.DAMPING, "the damping of the resonance at {}"),
    }
)
"""By family of parameter: what it looks like, and what it is."""


def sentence(found: Explanation, mode: float | None = None) -> str:
    """Where, and what it looks like, without a full stop; `mode` [Hz] that it names."""
    place, course, kind = found.place, found.course, found.place.kind
    axis = f"load {place.load}" if place.load else f"motion {place.motion}"
    of_size, how = _of_size(found), f"as {course.text}{_of_size(found)}"
    if kind in (sites.PAIR, sites.SPAN) and course.looks_like != fit.RESONANCE:
        how = f"like a {course.looks_like}{of_size}: it {course.text}"
    if kind == sites.CHANNEL:
        where = f"{place.channels[0]} alone"
    elif kind == sites.GROUP:
        where = f"all channels of the {GROUPS[place.part].partition(',')[0]}" if place.part else "all accelerometers"
    elif kind == sites.LOCATION:
        where = f"{place.part}, along {place.along}"
        if course.looks_like != fit.RESONANCE:
            how = f"like {course.text}{'' if course.looks_like == fit.MASS else f' to {place.to}'}{of_size}"
    elif kind == sites.JOINT:
        where = f"between cover plate and article, along {' and '.join((place.motion, *(one for _, one in place.others)))}"
    elif kind == sites.CROSSTALK:
        where = f"{place.channels[0]} hears {place.channels[1] if len(place.channels) > 1 else axis}"
        how = f"{course.text}{of_size}"
    elif kind == sites.AXIS:
        where = f"{axis} as the channels tell it"
    elif kind == sites.SPAN:
        others = ", ".join(f"{MOTIONS[LOADS.index(load)]} and {motion}" for load, motion in place.others)
        with_others = f", with {others}" if others else ""
        where = f"between {MOTIONS[LOADS.index(place.load)]} and {place.motion}{with_others}"
    elif kind == sites.PAIR:
        opposite = " with opposite signs" if place.sign < 0 else ""
        where = f"load {place.load} for motion {place.motion}"
        if place.sign:
            where = f"between {MOTIONS[LOADS.index(place.load)]} and {place.motion}, both ways{opposite}"
    else:
        family, _, part = place.part.partition(":")
        where = OF_PARTS[family][1].format(f"{mode:.3g} Hz" if mode else part)
        how = f"different {course.text}"
    return f"{where}{f' ({found.data_set} alone)' if found.data_set else ''}, {how}"


def _of_size(found: Explanation) -> str:
    size, unit = _size(found)
    if size is None:
        return ""
    if unit == "1":
        return f" of {100 * size:.3g} %"
    return f" of {1e3 * size:.3g} ms" if unit == "s" else f" of {size:.3g} {unit}"


def _size(found: Explanation) -> tuple[float | None, str]:
    place, course = found.place, found.course
    if not course.stated:
        return None, ""
    if place.kind in (sites.PAIR, sites.SPAN, sites.JOINT):
        return found.size, UNITS[course.unit][(LOADS.index(place.load) >= 3) + (MOTIONS.index(place.motion) >= 3)]
    if place.kind == sites.LOCATION:
        return found.size, course.unit
    if place.kind == sites.PART:
        return None, ""
    if place.kind == sites.CROSSTALK:
        return (found.size, place.unit) if place.unit else (None, "")
    return found.size, "1" if course.unit == "kg" else course.unit


# An unexplained residual that goes with frequency in no plain way: the channel that holds it, or where it is worst.


HELD = 0.5
"""[share] of what is unexplained that a channel must hold to be named. Exercised by test_unexplained.py."""

SMOOTH = 0.4
"""[1] Correlation of neighbouring lines above which what is unexplained is no noise. Exercised by test_unexplained.py."""

ALONE = 1e-6
"""[share] of a channel that inputs must leave for anything to be known of it. Exercised by test_unexplained.py."""


# What no effect explains, described: where it is and what it looks like.
#
# Every place - a pair of axes, an axis, a channel, a channel that hears something, a part - is tried with every course over
# frequency; the one that explains most is named where it covers half of the unexplained residual. Else a channel or a pair that
# holds half of it, whatever it does there, is named as irregular or as noise; else only where it is worst.


NULL = 0.89
"""[cost/dof] Twice the cost of a fit, priors counted, per degree of freedom where nothing is missing; the model-error floor is a
bound. Exercised by test_unexplained.py."""

SURE = 0.4
"""[share] of what is unexplained that an explanation must cover to be what it looks like. Exercised by test_unexplained.py."""

NEARLY = 0.95
"""[share] of the best gain at which a plainer explanation is as good. Held by test_unexplained.py."""

MATRIX_WEIGHT = 0.95
"""[factor] on the gain of a whole matrix, which has many numbers. Held by test_unexplained.py."""

AXIS_WEIGHT = 0.75
"""[factor] on the gain of a whole axis, which can be many things. Exercised by test_unexplained.py."""

ONE_DATA_SET_WEIGHT = 0.8
"""[factor] on the gain of what acts in one of several data sets alone, where shared tolerances give back what they took
elsewhere. Exercised by test_unexplained.py."""

WEIGHED: Mapping[str, float] = MappingProxyType({sites.SPAN: MATRIX_WEIGHT, sites.AXIS: AXIS_WEIGHT})

HARDLY = 0.02
"""[share] of the degrees of freedom below which models that miss nothing differ by as much. Held by test_unexplained.py."""


def described(candidate: Candidate) -> Leftover:
    """What `candidate` does not explain, and what its tolerances swallowed of it."""
    data = fit.swallowing(candidate)
    # The plainest of those that are nearly as good as the best, as far as each is plausible
    every = ranked(candidate, data)
    if not every:
        # Tables of modes: in which mode, and where, most of it is
        powers: dict[tuple[str, str, str], float] = {}
        for one in data:
            measured = one.of.prediction.measured
            power = np.sum(np.abs(one.of.values) ** 2 / np.maximum(one.of.free / 2, ALONE), axis=1)
            for k, channel in np.ndindex(power.shape):
                powers[measured.name, measured.runs[k], measured.channels[channel]] = float(power[k, channel])
        table, mode, where = max(powers, key=lambda each: powers[each])
        share = powers[table, mode, where] / sum(powers.values())
        text = f"Spread over modes and sensors, worst in {where} of {mode} of {table} with {share:.0%}."
        return Leftover(text=text, looks_like=fit.IRREGULAR, channels=(where,), share=share)
    weights = [WEIGHED.get(one.place.kind, 1.0) * (ONE_DATA_SET_WEIGHT if one.data_set else 1.0) for one in every]
    plausible = [one.gain * weight for one, weight in zip(every, weights, strict=True)]
    near = [(one, gain) for one, gain in zip(every, plausible, strict=True) if gain >= NEARLY * max(plausible)]
    best, _ = min(
        near, key=lambda each: (each[0].course.looks_like == fit.RESONANCE, sites.KINDS.index(each[0].place.kind), -each[1])
    )
    # A resonance at its own frequency and damping, not at that of the grid; anything else as it is
    f, zeta = best.course.frequency, best.course.ratio
    if f is not None and zeta is not None and best.sources:
        tried = [fit.resonance(float(f * (1 + step)), zeta * of) for step in np.linspace(-NEAR, NEAR, STEPS) for of in TIMES]
        answers = []
        for family, q in best.sources:
            of, omega = family.products, 2 * np.pi * family.products.frequency
            alone = Products(
                frequency=of.frequency,
                names=of.names[q : q + 1],
                residual=of.residual[:, q : q + 1],
                others=of.others[:, q : q + 1],
                square=of.square[:, q : q + 1],
            )
            answers.append(fit.following(alone, np.stack([course.of(omega) for course in tried]), family.root))
        found = fit.gains(answers, best.sources[0][0].slope)
        k = int(np.argmax(found.gain[:, 0]))
        best = replace(best, course=tried[k], gain=float(found.gain[k, 0]), size=float(found.size[k, 0]))
    # Chi² and price of all parameters above those of a model that misses nothing; the way to the minimum is not counted
    slope, freedom = data[0].slope, candidate.fit.degrees_of_freedom
    excess = 2 * candidate.fit.cost - float(slope @ slope) - NULL * freedom
    share = 2 * best.gain / max(excess, 2 * best.gain, HARDLY * freedom)
    if share < SURE:
        return _irregular([one.of for one in data], excess, best, share)
    # [Hz] of the mode that a parameter is of
    family_name, _, rest = best.place.part.partition(":")
    configuration, _, mode = rest.rpartition(":")
    frequency = None
    for prediction in candidate.problem.predictions if family_name in ("frequency", "damping") else ():
        nuisances = prediction.tested.carried.nuisances if isinstance(prediction, SeriesPrediction) else None
        if frequency is None and nuisances is not None and nuisances.configuration == configuration:
            frequency = float(nuisances.frequency[int(mode) - 1])
    size, unit = _size(best)
    hears = best.place.kind == sites.CROSSTALK
    return Leftover(
        text=f"{sentence(best, frequency)}. That is {min(share, 1):.0%} of what is left.",
        looks_like=best.course.looks_like or OF_PARTS[family_name][0],
        load="" if hears else best.place.load,
        motion="" if hears else best.place.motion,
        channels=best.place.channels,
        frequency=best.course.frequency or frequency,
        share=share,
        size=size,
        unit=unit,
    )


def _irregular(data: Sequence[fit.Whitened], excess: float, best: Explanation, share: float) -> Leftover:
    """What is left, where `best` explains but `share` of it and goes with frequency in no plain way.

    The channel that holds it, or where it is worst: the sum of |r_c|² / (1 - h_c), whitened residuals of which inputs leave
    1 - h_c free, is by how much all would be better off without a channel.

    Parameters
    ----------
    excess : chi² and price above those of a model that misses nothing
    """
    found: dict[str, tuple[float, complex, float]] = {}
    for one in data:
        free = np.maximum(one.free / 2, ALONE)
        e = one.values / np.sqrt(free)
        beside = np.sum(e[:, 1:] * e[:, :-1].conj(), axis=(0, 1))
        for k, channel in enumerate(one.prediction.measured.channels):
            chi2, together, power = found.get(channel, (0.0, 0j, 0.0))
            own = float(np.sum(np.abs(e[..., k]) ** 2))
            found[channel] = (chi2 + own - 2 * e[..., k].size, together + beside[k], power + own)
    worst, (chi2, together, power) = max(found.items(), key=lambda each: each[1][0])
    nearest = f"What comes closest is {sentence(best)}, with {share:.0%} of it"
    part = max(chi2, 0.0) / max(excess, chi2, 1.0)
    looks_like = fit.NOISE if part >= HELD and float((together / power).real) <= SMOOTH else fit.IRREGULAR
    kind = "smooth over frequency but like nothing plain" if looks_like == fit.IRREGULAR else "jagged over frequency, as of noise"
    text = f"{worst} alone, {kind}: {part:.0%} of what is left. {nearest}."
    if part < HELD:
        text = f"Spread over channels and frequencies, worst in {worst} with {part:.0%}. {nearest}."
    return Leftover(text=text, looks_like=looks_like, channels=(worst,), share=part)


NO_LINES = Explanation(
    place=sites.SuspectedPlace(kind=sites.CHANNEL), course=fit.CROSSTALK_CONSTANT, data_set="", gain=0.0, size=0.0
)
"""Of data that are tables of modes alone."""


def unexplained(candidate: Candidate) -> Explanation:
    """The one thing, of all that can be put in words, that would explain most of what `candidate` leaves, and its gain [nats].

    Where nothing is missing, none of the thousands that are tried gains more than some ten or twenty.
    """
    found = ranked(candidate, fit.swallowing(candidate))
    return found[0] if found else NO_LINES
