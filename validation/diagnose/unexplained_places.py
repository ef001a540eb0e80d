"""Where an unexplained residual may sit, and what places of one kind (`PlaceFamily`) do to the readings of a data set."""

from collections.abc import Iterator, Mapping, Sequence
from dataclasses import dataclass, replace
from functools import cached_property
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import LEVELS, MOTIONS, ComplexArray
from geometry.frames import Array, rigid_transformation_6
from geometry.inertia import LOADS
from geometry.sensors import Channel
from validation.diagnose import unexplained_fit as fit
from validation.estimation.problem import Offsets, Prediction
from validation.estimation.screening import Products
from validation.prediction import dynamic_mass
from validation.prediction.series import SeriesPrediction, is_read

CHANNEL, GROUP, PAIR, LOCATION, JOINT, PART, CROSSTALK, SPAN, AXIS = KINDS = (
    *("channel", "group", "pair", "location", "joint", "part", "crosstalk", "span", "axis"),
)
"""A channel; a group of channels; a pair of axes; a place of the article; the joint under it; a part or a mode; a channel and
what it hears; several pairs of axes at once; the load or the motion of one axis as channels tell it. The plainest first."""


@dataclass(frozen=True, kw_only=True)
class SuspectedPlace:
    """Where.

    Attributes
    ----------
    kind : of `KINDS`
    load, motion : of a pair, of the leading one of several, of what is heard; one of them of an axis
    sign : +1 of a pair that is symmetric, -1 of one that is antisymmetric, 0 of one entry alone
    others : further pairs that take part, by load and motion
    channels : that show it; the first one hears the second
    part : name of a parameter, of a group, or of a place of the article
    along : direction at a place of the article
    to : what a place of the article is tied to
    unit : of a reading per unit of what is heard; empty where it is not stated
    """

    kind: str
    load: str = ""
    motion: str = ""
    sign: int = 0
    others: tuple[tuple[str, str], ...] = ()
    channels: tuple[str, ...] = ()
    part: str = ""
    along: str = ""
    to: str = ""
    unit: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class PlaceFamily:
    """Places of one kind in one data set, and the courses that they may take.

    Attributes
    ----------
    places : (q,)
    courses : (k,)
    products : of the places, line by line
    root, slope : as `Swallowing` has them
    """

    places: tuple[SuspectedPlace, ...]
    courses: tuple[fit.FrequencyLaw, ...]
    products: Products
    root: Array
    slope: Array

    def answers(self) -> fit.Answers:
        """(k, q) of all courses."""
        omega = 2 * np.pi * self.products.frequency
        return fit.following(self.products, np.stack([course.of(omega) for course in self.courses]), self.root)


# Leftovers in axes: an entry of the dynamic mass, two that mirror each other, an axis whose load or motion is told wrongly.


@dataclass(frozen=True, eq=False, kw_only=True)
class Loaded:
    """A base-excitation test, as far as changes of its dynamic mass go.

    Attributes
    ----------
    of : the data set
    by_load : (m, c, 6) what the channels read for a unit of every load
    H : (m, 6, 6) dynamic mass about F
    prediction : of the test
    """

    of: fit.Swallowing
    by_load: ComplexArray
    H: ComplexArray
    prediction: SeriesPrediction

    @classmethod
    def by_model(cls, of: fit.Swallowing, offsets: Offsets) -> "Loaded | None":
        """At the fit of a data set; None of one that is no base-excitation test."""
        one, lines = of.of.prediction, of.of.lines
        if not isinstance(one, SeriesPrediction):
            return None
        return cls(of=of, by_load=one.by_load(offsets, lines), H=one.dynamic_mass(offsets, lines), prediction=one)

    @property
    def u(self) -> ComplexArray:
        """(r, m, 6) motions."""
        return self.of.of.inputs

    @cached_property
    def channels(self) -> npt.NDArray[np.int64]:
        """(c',) those that read any load."""
        return np.asarray(np.flatnonzero(np.any(self.by_load != 0, axis=(0, 2))), dtype=np.int64)

    def readings(self, left: ComplexArray, right: ComplexArray) -> ComplexArray:
        """(r, m, c', q) of the changes ``left_q right_q^T`` of the dynamic mass, (m, 6, q) both."""
        answered = np.asarray(np.swapaxes(right, 1, 2) @ self.u[..., None])[..., 0]
        return np.asarray((self.by_load[:, self.channels] @ left) * answered[:, :, None, :])

    def family(
        self, places: tuple[SuspectedPlace, ...], courses: tuple[fit.FrequencyLaw, ...], readings: ComplexArray
    ) -> PlaceFamily:
        """Of `readings` (r, m, c', q)."""
        return PlaceFamily(
            places=places,
            courses=courses,
            products=fit.products(self.of, readings, self.channels),
            root=self.of.root,
            slope=self.of.slope,
        )

    @cached_property
    def entries(self) -> tuple[Products, ComplexArray]:
        """Products of the 36 entries of the dynamic mass, and (m, 36, 36) those of what inputs leave of them with each other."""
        u, A1, at = self.u, self.by_load[:, self.channels], self.of.of
        readings: ComplexArray = np.einsum("mci,rmj->rmcij", A1, u, optimize=True).reshape(*u.shape[:2], A1.shape[1], 36)
        kept = at.kept(readings * at.weight[:, :, self.channels, None], self.channels)
        flat = kept.transpose(1, 0, 2, 3).reshape(len(at.frequency), -1, 36)
        return fit.products(self.of, readings, self.channels), np.asarray(flat.conj().swapaxes(1, 2) @ flat)

    def sums(self, mixed: Array) -> tuple[Products, ComplexArray]:
        """The same of sums of entries, the columns of `mixed` (36, q): all of it follows from that of the entries."""
        of, gram = self.entries
        both = np.asarray(mixed.T @ gram @ mixed)
        products = Products(
            frequency=of.frequency,
            names=tuple(map(str, range(mixed.shape[1]))),
            residual=of.residual @ mixed,
            others=np.asarray(mixed.T @ of.others.view(np.float64)).view(np.complex128),
            square=np.diagonal(both, axis1=1, axis2=2).real,
        )
        return products, both

    def pairs(self, courses: tuple[fit.FrequencyLaw, ...]) -> PlaceFamily:
        """Entries of the dynamic mass one by one, and two of them alike or opposite."""
        places, columns = [], []  # and (36, q) of which entries each is the sum
        for i, load in enumerate(LOADS):
            for j, motion in enumerate(MOTIONS):
                places.append(SuspectedPlace(kind=PAIR, load=load, motion=motion))
                columns.append(entry(i, j))
                for sign in (1, -1) if j > i else ():
                    places.append(SuspectedPlace(kind=PAIR, load=load, motion=motion, sign=sign))
                    columns.append(entry(i, j) + sign * entry(j, i))
        products, _ = self.sums(np.stack(columns, axis=1))
        return PlaceFamily(places=tuple(places), courses=courses, products=products, root=self.of.root, slope=self.of.slope)

    def axes(self) -> PlaceFamily:
        """Axes whose load, or whose motion, is told wrongly."""
        load = (self.H @ self.u[..., None])[..., 0]
        by_load = self.by_load[:, self.channels] * load[:, :, None, :]
        by_motion = -(self.by_load[:, self.channels] @ self.H) * self.u[:, :, None, :]
        places = (
            *(SuspectedPlace(kind=AXIS, load=one) for one in LOADS),
            *(SuspectedPlace(kind=AXIS, motion=one) for one in MOTIONS),
        )
        return self.family(places, fit.OF_SHARES, np.concatenate([by_load, by_motion], axis=-1))

    def locations(self, offsets: Offsets, shakes: Sequence[fit.FrequencyLaw]) -> Iterator[PlaceFamily]:
        """What is attached to a place of the article: ``dH = a c(omega) sum_d p_d p_d^T``, p its accelerations for those of F."""
        moved = self.prediction.moved(offsets, self.of.of.lines)
        mixed = np.array(list(DIRECTIONS.values()), dtype=np.float64).T
        giving = {name: both for name, both in moved.items() if np.abs(both[1]).max() > GIVES * np.abs(both[0]).max()}
        for to, k, there, courses in ((GROUND, 0, moved, (*fit.OF_PLACES, *shakes)), (TABLE, 1, giving, fit.OF_PLACES[1:])):
            if not there:
                continue
            places = tuple(SuspectedPlace(kind=LOCATION, part=name, along=along, to=to) for name in there for along in DIRECTIONS)
            rows = [np.swapaxes(both[k], 1, 2) for both in there.values()]
            yield self.family(places, courses, np.concatenate([self.readings(one, one) @ mixed for one in rows], axis=-1))

    def joint(self, offsets: Offsets) -> Iterator[PlaceFamily]:
        """What gives below the article: ``dH = a c(omega) sum_d H e_d e_d^T H``, H of the article about its origin."""
        carried = self.prediction.tested.carried
        if carried.nuisances is None:
            return
        back = np.linalg.inv(rigid_transformation_6(carried.standing.pose.position))
        H = self.H - dynamic_mass.at(carried.moving, offsets).mass_matrix
        loads: ComplexArray = H @ back
        readings = self.readings(loads, np.swapaxes(back.T @ H, 1, 2))
        places, mixed = [], np.zeros((len(MOTIONS), len(JOINTS)))
        for k, axes in enumerate(JOINTS):
            (first, *others) = ((LOADS[axis], MOTIONS[axis]) for axis in axes)
            places.append(SuspectedPlace(kind=JOINT, load=first[0], motion=first[1], others=tuple(others)))
            mixed[list(axes), k] = 1.0
        yield self.family(tuple(places), fit.OF_JOINTS, readings @ mixed)

    @property
    def spanned(self) -> "Spanned":
        """The entries of a symmetric matrix."""
        mixed = np.stack([entry(i, j) + (entry(j, i) if j > i else 0) for i, j in PLACES], axis=1)
        products, gram = self.sums(mixed)
        return Spanned(data_set=self.of.of.name, products=products, gram=gram, root=self.of.root)


def entry(i: int, j: int) -> Array:
    """(36,) a unit of the entry (i, j)."""
    found = np.zeros(36)
    found[6 * i + j] = 1.0
    return found


# Leftovers in the structure: at a place of the article, in the joint under it, in a part of which the fit has a parameter.


DIRECTIONS = {"x": (1, 0, 0), "y": (0, 1, 0), "z": (0, 0, 1), "x and y": (1, 1, 0), "x, y and z": (1, 1, 1)}

GROUND, TABLE = "the ground", "the table"

JOINTS = ((0,), (1,), (2,), (3,), (4,), (5,), (0, 1), (3, 4))
"""[index] Axes of a joint that give alike. Exercised by test_unexplained.py."""

GIVES = 0.02
"""[share] of its motion that a place moves beyond a rigid article where anything pulls at it. Held by test_unexplained.py."""

PARTS = ("modulus", "loss", "damping-law", "cell-stiffness", "fmd-compliance", "frequency", "damping")
"""Families of parameters that stand for a part or a mode."""


# Leftovers in channels: one, or all of a group, that tells a wrong share of what it reads; one that hears what it should not.


DIMENSIONS: Mapping[str, tuple[int, int]] = MappingProxyType({"acceleration": (0, 1), "force": (1, 1), "moment": (1, 2)})
"""kg and m of a quantity, all of them per second squared."""


def channels(of: fit.Swallowing, courses: tuple[fit.FrequencyLaw, ...]) -> Iterator[PlaceFamily]:
    """All accelerometers, and those of a group, that read gravity where they tilt: along x by beta, along y by minus alpha.
    Channels by themselves and by groups, in shares of what they read."""
    names, table, u = of.of.prediction.measured.channels, _table(of.of.prediction), of.of.inputs
    real = list(map(is_read, names))
    sensing = [one.quantity == "acceleration" and is_read(one.name) for one in table]
    known = dict.fromkeys(one.group for one in table if is_read(one.name))
    groups = {group: [one.group == group and is_read(one.name) for one in table] for group in known}
    if any(sensing) and u.shape[-1] == len(MOTIONS):
        along = np.array([one.places[0].direction for one in table])
        tilted = u[..., 4, None] * along[:, 0] - u[..., 3, None] * along[:, 1]
        sense = dict.fromkeys(one.group for one, senses in zip(table, sensing, strict=True) if senses)
        chosen = {"": sensing} | {group: groups[group] for group in sense}
        yield _mixed(of, [_group(one, names, chosen[one]) for one in chosen], list(chosen.values()), (fit.TILTING,), tilted)
    places = [SuspectedPlace(kind=CHANNEL, channels=(name,)) for name in filter(is_read, names)]
    places += [_group(one, names, groups[one]) for one in groups]
    yield _mixed(of, places, [*np.eye(len(names))[real], *groups.values()], courses, predicted(of))


def _group(group: str, names: Sequence[str], members: Sequence[bool]) -> SuspectedPlace:
    there = tuple(name for name, is_in in zip(names, members, strict=True) if is_in)
    return SuspectedPlace(kind=GROUP, part=group, channels=there)


def _mixed(
    of: fit.Swallowing,
    places: Sequence[SuspectedPlace],
    members: Sequence[Array | Sequence[bool]],
    courses: tuple[fit.FrequencyLaw, ...],
    read: ComplexArray,
) -> PlaceFamily:
    """Of `read` (r, m, c) in the channels of which each place has those that are its `members` (q, c)."""
    mixed = np.array([np.asarray(one, dtype=np.float64) for one in members]).T
    made = fit.products(of, read[..., None] * mixed, np.arange(len(mixed)))
    return PlaceFamily(places=tuple(places), courses=courses, products=made, root=of.root, slope=of.slope)


def predicted(of: fit.Swallowing) -> ComplexArray:
    """(r, m, c) what the channels should read."""
    at = of.of
    return np.asarray((at.predicted.rows @ at.inputs[..., None])[..., 0])


@dataclass(frozen=True, eq=False, kw_only=True)
class Readings:
    """What a channel may hear, with one course.

    Attributes
    ----------
    course : over frequency
    places : (q,) what is heard, without the channel that hears it
    dimensions : (q,) kg and m of it, seconds left out
    values : (r, m, q) complex
    """

    course: fit.FrequencyLaw
    places: tuple[SuspectedPlace, ...]
    dimensions: tuple[tuple[int, int], ...]
    values: ComplexArray

    def unit(self, own: tuple[int, int], k: int) -> str:
        """Of a reading of dimensions `own` per unit of what is heard in place k."""
        kg, m = own[0] - self.dimensions[k][0], own[1] - self.dimensions[k][1]
        powers = (("kg", kg), ("m", m), ("s", -2 if self.course is fit.CROSSTALK_FALLING else 0))
        above = " ".join(f"{name}^{power}" if power > 1 else name for name, power in powers if power > 0) or "1"
        below = " ".join(f"{name}^{-power}" if power < -1 else name for name, power in powers if power < 0)
        return above if not below else f"{above}/({below})" if " " in below else f"{above}/{below}"


def crosstalk(of: fit.Swallowing, offsets: Offsets) -> Iterator[tuple[tuple[SuspectedPlace, ...], fit.FrequencyLaw, fit.Answers]]:
    """Every channel that hears a motion, a load, or another channel."""
    at, prediction, names = of.of, of.of.prediction, of.of.prediction.measured.channels
    own = tuple(DIMENSIONS[one.quantity] for one in _table(prediction)) or ((0, 0),) * at.values.shape[-1]
    read = [k for k, name in enumerate(names) if is_read(name)]
    others = tuple(SuspectedPlace(kind=CROSSTALK, channels=(names[k],)) for k in read)
    heard = tuple(own[k] for k in read)
    between = Readings(course=fit.CROSSTALK_CONSTANT, places=others, dimensions=heard, values=predicted(of)[..., read])
    sources = [between] if len(read) > 1 else []  # one alone hears no other
    if isinstance(prediction, SeriesPrediction):
        u, H = at.inputs, prediction.dynamic_mass(offsets, np.searchsorted(prediction.measured.frequency, at.frequency))
        motions = tuple(SuspectedPlace(kind=CROSSTALK, motion=one) for one in MOTIONS)
        axes = (*motions, *(SuspectedPlace(kind=CROSSTALK, load=one) for one in LOADS))
        moved, loaded = ((0, 1),) * 3 + ((0, 0),) * 3, ((1, 1),) * 3 + ((1, 2),) * 3
        both = np.concatenate([u, (H @ u[..., None])[..., 0]], axis=-1)
        sources.append(Readings(course=fit.CROSSTALK_CONSTANT, places=axes, dimensions=(*moved, *loaded), values=both))
        falling = u * fit.CROSSTALK_FALLING.of(2 * np.pi * at.frequency)[:, None]
        sources.append(Readings(course=fit.CROSSTALK_FALLING, places=motions, dimensions=moved, values=falling))
    for one in sources:
        for c, name in ((c, names[c]) for c in read):
            kept = [k for k, place in enumerate(one.places) if name not in place.channels]
            white = one.values[..., kept] * at.weight[:, :, c, None]
            places = tuple(
                replace(one.places[k], channels=(name, *one.places[k].channels), unit=one.unit(own[c], k)) for k in kept
            )
            b = white.swapaxes(0, 1).reshape(-1, white.shape[-1]).conj().T  # (q, m r)
            V = of.moved[:, :, c].reshape(b.shape[1], -1)
            free = 0.5 * at.free[:, :, c, None]
            answers = fit.Answers(
                score=(b @ at.values[:, :, c].T.ravel()).real[None],
                own=np.sum(free * np.abs(white) ** 2, axis=(0, 1))[None],
                swallowed=((b @ V).real @ of.root)[None],
            )
            yield places, one.course, answers


def _table(prediction: Prediction) -> tuple[Channel, ...]:
    """(c,) what the channels are; nothing is known of those of an accelerance test."""
    if not isinstance(prediction, SeriesPrediction):
        return ()
    by_name = {one.name: one for one in prediction.tested.campaign.table.channels}
    return tuple(by_name[name] for name in prediction.measured.channels)


# Every place in which an unexplained residual of one data set may sit, with the courses that it may take there.


def families(of: fit.Swallowing, offsets: Offsets, loads: Loaded | None) -> Iterator[PlaceFamily]:
    """All of one data set whose course is sought."""
    band = np.geomspace(of.of.frequency[0], of.of.frequency[-1], fit.FREQUENCIES)
    shakes = tuple(fit.resonance(float(f), ratio) for f in band for ratio in fit.RATIOS)
    of_channels = list(channels(of, (*fit.OF_SHARES, *shakes)))
    if loads is not None:
        yield loads.pairs((*fit.OF_PAIRS, *shakes))
        yield loads.axes()
        yield from of_channels[:-1]
        yield from loads.locations(offsets, shakes)
        yield from loads.joint(offsets)
    yield of_channels[-1]
    at = [k for k, name in enumerate(of.names) if name.partition(":")[0] in PARTS]
    if at:
        left, V = of.on(np.arange(of.moved.shape[2]))
        e = V[:, :, at].conj().swapaxes(1, 2)
        yield PlaceFamily(
            places=tuple(SuspectedPlace(kind=PART, part=of.names[k]) for k in at),
            courses=fit.OF_PARTS,
            products=Products(
                frequency=of.of.frequency,
                names=tuple(of.names[k] for k in at),
                residual=(e @ left)[..., 0],
                others=np.asarray(e @ V),
                square=np.sum(np.abs(V[:, :, at]) ** 2, axis=1),
            ),
            root=of.root,
            slope=of.slope,
        )


# An unexplained residual in several pairs of axes at once, such as a spring off the reference point: a symmetric matrix of one
# course.


PLACES = tuple((i, j) for i in range(6) for j in range(i, 6))
"""Entries of a symmetric matrix."""

PHYSICAL = tuple(course for course in fit.OF_PAIRS if course.stated)
"""What symmetric matrices are of: mass, stiffness, damping."""

NAMED = 0.25
"""[share] of the leading pair, at the nominal level of the motions, from which another pair is named with it. Held by
test_unexplained.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Spanned:
    """All entries of a symmetric matrix in one data set.

    Attributes
    ----------
    data_set : its name
    products : (q,) of the entries, line by line
    gram : (m, q, q) complex, of the entries with each other, inputs eliminated
    root : of the covariance of the fit
    """

    data_set: str
    products: Products
    gram: ComplexArray
    root: Array


@dataclass(frozen=True, eq=False, kw_only=True)
class Span:
    """What a symmetric matrix of one course explains.

    Attributes
    ----------
    place : the leading pair, and those that take part
    course : of all entries
    gain : [nats]
    size : of the leading pair
    """

    place: SuspectedPlace
    course: fit.FrequencyLaw
    gain: float
    size: float


def spans(alike: Sequence[Spanned], slope: Array) -> Iterator[Span]:
    """Of the courses of matrices, with one matrix for the data sets `alike`; `slope` as `Swallowing` has it."""
    for course in PHYSICAL:
        score, own = np.zeros(len(PLACES)), np.zeros((len(PLACES), len(PLACES)))
        swallowed = np.zeros(())
        for one in alike:
            c = course.of(2 * np.pi * one.products.frequency)
            answers = fit.following(one.products, c[None], one.root)
            score += answers.score[0]
            own += np.tensordot(np.abs(c) ** 2, one.gram.real, axes=1)
            swallowed = swallowed + answers.swallowed[0]
        score = score + swallowed @ slope
        scale = 1 / np.sqrt(np.maximum(np.diag(own), np.finfo(np.float64).tiny))
        told = scale[:, None] * (own - swallowed @ swallowed.T) * scale
        size = scale * (np.linalg.pinv(told, rcond=fit.LEAST, hermitian=True) @ (scale * score))
        # The entries that take part, the greatest first, at the nominal level of the motions
        weight = np.abs(size) * np.array([LEVELS[MOTIONS[i]] * LEVELS[MOTIONS[j]] for i, j in PLACES])
        leading, *others = (int(k) for k in np.argsort(-weight) if weight[k] >= NAMED * weight.max())
        (load, motion), *rest = ((LOADS[PLACES[k][0]], MOTIONS[PLACES[k][1]]) for k in (leading, *others))
        place = SuspectedPlace(kind=SPAN, load=load, motion=motion, others=tuple(rest))
        yield Span(place=place, course=course, gain=0.5 * float(size @ score), size=float(size[leading]))
