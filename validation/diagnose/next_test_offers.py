"""Tests that a laboratory could do next: what such a test would read as a prediction, and the menu of them in words.

No time is simulated. The table would move as it did, so the base motions of a campaign that is there, as its own fit tells them,
drive the test; a line says as much as one of these data says, its noise and the model's own error included. Lines that nothing
drove yet are driven like the nearest that was: constant acceleration, so that the spectrum of a sweep falls with 1 / sqrt(f).
"""

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import pi
from types import MappingProxyType

import numpy as np

from geometry.articles import locations
from geometry.articles.parts import load
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, Pose, rotation_about
from geometry.inertia import Inertia
from geometry.sensors import Channel
from identification import request
from identification.campaign import Campaign
from identification.quality import NORMAL_95
from identification.self_calibration.solve import eliminated
from validation.classical.files import KEYS
from validation.diagnose.diagnosis import Candidate
from validation.effects.catalogue import FAMILIES, acts
from validation.effects.effect import AMPLITUDE
from validation.effects.families.point_mass import change as heavier
from validation.estimation import likelihood
from validation.estimation.fit import FLOOR
from validation.estimation.likelihood import root
from validation.estimation.problem import AT_MOST, EFFECT, Fact, Lines, Measured, Parameter, chosen
from validation.model.model import Added
from validation.model.setups import FMD, above_fmd, mounted
from validation.prediction import effects as prediction_effects
from validation.prediction.classical_facts import ArticleFact, article_of, weights_of
from validation.prediction.dynamic_mass import SupportedDynamicMass
from validation.prediction.mounting import mounted_article
from validation.prediction.series import SeriesPrediction, TestedCampaign, laboratory, supported_dynamic_mass

# What the present data say of the parameters by one explanation, carried over to a test that is not done yet.
#
# A test shares tolerances with the data that are there: sensors, the FMD, parts. What the fit has learnt of them holds; what is
# new, such as the modes of an article that never stood there, is known as beforehand. A test may also move a parameter - two
# pick-ups exchanged take their gains along - or draw it anew.


@dataclass(frozen=True, kw_only=True)
class Origin:
    """Where a parameter of a test comes from.

    Attributes
    ----------
    name : of the parameter of the present data whose offset it takes; empty for one that is drawn anew
    factor : by which the offset is multiplied
    """

    name: str = ""
    factor: float = 1.0


SURE = 100.0
"""[nats] beyond which one of two is right. Exercised by test_next_test.py."""

Moved = Mapping[str, Origin]
"""By name of a parameter in the test; one that is not in it stays what it was."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Knowledge:
    """A candidate as a distribution of its parameters.

    Attributes
    ----------
    effects : all of its model, as its problem has them
    offsets : where its fit ended, of all parameters
    names : (p,) of the free parameters
    root : (p, p), covariance of their offsets = root @ root.T
    log_evidence : [nats] of the present data
    """

    effects: tuple[Added, ...]
    offsets: Mapping[str, float]
    names: tuple[str, ...]
    root: Array
    log_evidence: float

    def odds(self, other: "Knowledge") -> float:
        """Probability of this one, if it or `other` is right."""
        return float(1 / (1 + np.exp(np.clip(other.log_evidence - self.log_evidence, -SURE, SURE))))

    def at(self, moved: Moved) -> dict[str, float]:
        """Offsets of the test."""
        taken = {new: origin.factor * self.offsets.get(origin.name, 0.0) for new, origin in moved.items()}
        return {**self.offsets, **taken}

    def spread(self, parameters: Sequence[Parameter], moved: Moved) -> Array:
        """(q, s): covariance of the offsets of `parameters` in the test = spread @ spread.T.

        Effects that this candidate has not are known not to be there.
        """
        row = {name: k for k, name in enumerate(self.names)}
        known = np.zeros((len(parameters), len(self.names)))
        new = np.zeros(len(parameters))
        for k, one in enumerate(parameters):
            origin = moved.get(one.name, Origin(name=one.name))
            if origin.name in row:
                known[k] = origin.factor * self.root[row[origin.name]]
            elif origin.name not in self.offsets and one.kind != EFFECT and np.isfinite(one.tolerance):
                new[k] = one.tolerance
        return np.hstack([known, np.diag(new)[:, new > 0]])


def knowledge(of: Candidate) -> Knowledge:
    """What the fit of a candidate knows."""
    return Knowledge(
        effects=effects_of(of),
        offsets={**of.problem.start, **of.fit.by_name},
        names=tuple(one.name for one in of.fit.parameters),
        root=root(of.fit.covariance),
        log_evidence=of.fit.log_evidence,
    )


def effects_of(of: Candidate) -> tuple[Added, ...]:
    """The effects from which the offsets of its fit count: those of its model and its own."""
    own = [getattr(one, "effects", ()) for one in of.problem.predictions]
    return max(own, key=len, default=()) or of.effects


SPACING = 0.2
"""[Hz] between the lines at which a test is predicted: levels are smoothed over it. Exercised by test_next_test.py."""

LINES = 20
"""[count] of lines at which it is compared; they stand for those that a fit would use. Exercised by test_next_test.py."""

RUNS = 6
"""[count] of runs that a test is taken to have at most. Exercised by test_next_test.py."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Template:
    """A campaign that is there, as far as a test is like it.

    Attributes
    ----------
    prediction : of some of its runs
    frequency : (n,) [Hz], `SPACING` apart
    inputs : (r, n, 6) base motions
    noise : by channel (r, n)
    spacing : [Hz] between the lines that were measured
    """

    prediction: SeriesPrediction
    frequency: Array
    inputs: ComplexArray
    noise: Mapping[str, Array]
    spacing: float

    @classmethod
    def of(cls, campaign: SeriesPrediction, by: Knowledge) -> "Template":
        """Of a `campaign` that was measured, its base motions as the candidate `by` tells them."""
        some = campaign.on(campaign.measured.runs[:RUNS]).with_effects(by.effects)
        frequency = some.measured.frequency
        spacing = float(np.median(np.diff(frequency))) if len(frequency) > 1 else SPACING
        lines = np.arange(0, len(frequency), max(1, round(SPACING / spacing)), dtype=np.int64)
        predicted, seen = some.at(by.offsets, lines, derivatives=False), likelihood.observed(some.measured, lines)
        weight = seen.weight(FLOOR, predicted.noise)
        rows = np.broadcast_to(predicted.rows, (len(seen.runs), *predicted.rows.shape[-3:]))
        inputs = [eliminated(A, y, w)[2] for A, y, w in zip(rows, seen.values, weight, strict=True)]
        noise = {name: seen.noise[..., k] for k, name in enumerate(some.measured.channels)}
        return cls(prediction=some, frequency=frequency[lines], inputs=np.stack(inputs), noise=noise, spacing=spacing)

    @property
    def tested(self) -> TestedCampaign:
        """The campaign."""
        return self.prediction.tested


@dataclass(frozen=True, eq=False, kw_only=True)
class PlannedTest:
    """A test.

    Attributes
    ----------
    prediction : of its campaign, which has no readings yet
    inputs : (r, n, 6) base motions
    lines : that a fit of it would use
    """

    prediction: SeriesPrediction
    inputs: ComplexArray
    lines: int

    @property
    def measured(self) -> Measured:
        """Its lines, runs and channels."""
        return self.prediction.measured


def planned(of: Template, campaign: Campaign, *, frequency: Array | None = None, level: float = 1.0) -> PlannedTest:
    """The test `campaign`, which is driven as `of` was.

    Parameters
    ----------
    frequency : (n,) [Hz] of its lines; those of `of` by default
    level : factor on all drives

    Raises
    ------
    BadInput : as `validation.prediction.mounting.mounted_article`.
    """
    was, lines = of.tested, of.frequency if frequency is None else frequency
    near = np.argmin(np.abs(lines[:, None] - of.frequency), axis=1)
    drives = tuple(replace(one, amplitude=level * one.amplitude) for one in was.drives)
    chain = laboratory(was.model, campaign, ())
    # (r, n) Noise of a new channel is the median of its kind
    kinds = {one.name: (one.group, one.quantity) for one in campaign.table.channels}
    by_channel = []
    for name in chain.names:
        alike = [of.noise[name]] if name in of.noise else [of.noise[two] for two in of.noise if kinds[two] == kinds[name]]
        by_channel.append(np.median(alike, axis=0)[:, near])
    noise = np.stack(by_channel, axis=-1)
    unread = Measured(
        name="test",
        configuration=campaign.article,
        hardware=campaign.hardware,
        runs=was.measured.runs,
        axes=was.measured.axes,
        channels=chain.names,
        judged=np.isin(np.arange(len(chain.names)), chain.forces.columns),
        frequency=lines,
        values=np.zeros(noise.shape, dtype=np.complex128),
        noise=noise,
    )
    tested = replace(
        was,
        campaign=replace(campaign, recordings={}),
        measured=unread,
        carried=supported_dynamic_mass(was.model, campaign, mounted_article(was.model, campaign, lines[-1]), unread.name),
        drives=drives,
    )
    inputs = level * of.inputs[:, near] * np.sqrt(of.frequency[near] / lines)[:, None]
    measured = 1 + round(float(lines[-1] - lines[0]) / of.spacing)
    return PlannedTest(prediction=SeriesPrediction(tested=tested), inputs=inputs, lines=min(AT_MOST, measured))


def reading(test: PlannedTest, by: Knowledge, offsets: Mapping[str, float]) -> Measured:
    """What the test would read by a candidate, with `offsets` of its parameters."""
    rows = test.prediction.with_effects(by.effects).at(offsets, derivatives=False).rows
    if rows.ndim == 3:
        return replace(test.measured, values=np.einsum("...nck,rnk->rnc", rows, test.inputs))
    return replace(test.measured, values=(rows @ test.inputs[..., None])[..., 0])


def lines_of(test: PlannedTest, measured: Measured) -> tuple[Lines, float]:
    """Indices of the lines at which `test` is compared by what was `measured` in it, and for how many of a fit each stands."""
    lines = chosen(measured, at_most=LINES)
    return lines, test.lines / len(lines)


# The menu: tests in words, how long each takes, and what it would read.


NOTHING: Mapping[str, Origin] = MappingProxyType({})


@dataclass(frozen=True, eq=False, kw_only=True)
class OfferedTest:
    """A test of the menu: a campaign, or numbers of another measurement.

    Attributes
    ----------
    kind : of several of one kind only the best is named
    words : what to do
    hours : of work, roughly; assumed, to compare tests by
    test : the campaign; None for other measurements
    numbers : of another measurement, by a model without effects
    moved : parameters that the test moves or draws anew
    gone : families or ids of effects that the test takes away
    """

    kind: str
    words: str
    hours: float
    test: PlannedTest | None = None
    numbers: tuple[ArticleFact, ...] = ()
    moved: Moved = field(default_factory=lambda: NOTHING)
    gone: tuple[str, ...] = ()

    def facts(self, effects: Sequence[Added]) -> tuple[Fact, ...]:
        """The numbers of another measurement by a model with `effects`."""
        return tuple(one.with_effects(effects) for one in self.numbers)

    def by(self, known: Knowledge) -> Knowledge:
        """What is `known`, as it is in the test."""
        left = tuple(one for one in known.effects if not {one.named.family, one.named.id} & set(self.gone))
        return replace(known, effects=left, offsets=known.at(self.moved))


# Tests of the menu in which something else stands on the FMD, or the same otherwise.


CUBOID, TARE = "cuboid", "disc+cuboid"

FAMILY = ("clumod-1", "clumod-4")
"""Configurations of one article: whoever has tested one can test the other."""

IN_WORDS = {
    "": "the FMD alone",
    CUBOID: "the Cuboid",
    TARE: "the Cuboid on the disc",
    "clumod-1": "Clumod with one blade",
    "clumod-4": "Clumod with four blades",
}


@dataclass(frozen=True, kw_only=True)
class Other:
    """What may be mounted instead.

    Attributes
    ----------
    article : on the FMD
    hours : of work
    """

    article: str
    hours: float


OTHERS = (
    Other(article="", hours=1.0),
    Other(article=TARE, hours=2.0),
    Other(article="clumod-1", hours=8.0),
    Other(article="clumod-4", hours=8.0),
)

TURNS = ((90.0, 2.0), (180.0, 2.0))
"""[deg], [h] Turns about z, and the work of each. Exercised by test_next_test.py."""


def named(of: Template | str) -> str:
    """What stands on the FMD, in words; of a campaign that is there, or by the name of the article."""
    article = of if isinstance(of, str) else above_fmd(of.tested.campaign.article)
    return IN_WORDS.get(article, article)


def others(templates: Sequence[Template]) -> Iterator[OfferedTest]:
    """Articles that were not tested yet; what was tested, and the Cuboid, turned about z; the Cuboid on its broad side, which is
    the same mass at another height."""
    first, there = templates[0], {above_fmd(one.tested.campaign.article) for one in templates}
    for other in OTHERS:
        if other.article in there or (other.article in FAMILY and not there & set(FAMILY)):
            continue
        yield from _run(other.article, f"Run {named(other.article)}", other.hours, first, _with(first, other.article))
    angles = [(one, one.tested.campaign, *turn) for one in templates for turn in TURNS if above_fmd(one.tested.campaign.article)]
    if not any(CUBOID in one.tested.campaign.article for one in templates):
        angles.append((first, _with(first, TARE), *TURNS[0]))
    for of, campaign, angle, hours in angles:
        words = f"Run {named(above_fmd(campaign.article))} turned by {angle:g} degrees about z"
        pose, _ = mounted(campaign)
        yield from _run(
            "turned", words, hours, of, campaign, pose.position, rotation_about("z", angle * pi / 180) @ pose.rotation
        )
    campaign = _with(first, CUBOID)
    _, depth, height = load(CUBOID)["size"]
    down = Pose(position=np.array([0.0, height / 2, depth / 2]), rotation=rotation_about("x", pi / 2))
    lying = mounted(campaign)[0] @ down
    words = "Run the Cuboid lying on its broad side"
    yield from _run("lying", words, 2.0, first, campaign, lying.position, lying.rotation)


def _run(
    kind: str,
    words: str,
    hours: float,
    of: Template,
    campaign: Campaign,
    position: Array | None = None,
    rotation: Array | None = None,
) -> Iterator[OfferedTest]:
    """The offer, at another pose where one is given; none where the model cannot describe what would stand there."""
    if position is not None and rotation is not None:
        campaign = replace(campaign, mounting=Pose(position=position + campaign.table.origin, rotation=rotation))
    with suppress(BadInput):
        yield OfferedTest(kind=kind, words=words, hours=hours, test=planned(of, campaign))


def _with(of: Template, article: str) -> Campaign:
    """The campaign with another article, mounted where articles are."""
    campaign = of.tested.campaign
    pose, _ = mounted(campaign)
    upright = Pose(position=pose.position + campaign.table.origin)
    return replace(campaign, article="+".join(part for part in (FMD, article) if part), mounting=upright if article else None)


# Tests of the menu that need no shaker: a balance, a crane, a pendulum, each about an article that was tested.


@dataclass(frozen=True, eq=False, kw_only=True)
class Method:
    """A classical measurement.

    Attributes
    ----------
    words : what to do; ``{}`` stands for the article
    hours : of work
    tolerances : half-widths of 95 % intervals by key of `KEYS`, SI; of a mass and of moments of inertia as a share
    """

    words: str
    hours: float
    tolerances: Mapping[str, float]


SHARES = ("mass", "Ixx", "Iyy", "Izz")

METHODS = (
    Method(words="Weigh {}", hours=0.5, tolerances={"mass": 1e-3}),
    Method(words="Find the centre of gravity of {} on the crane", hours=2.0, tolerances=dict.fromkeys(KEYS[1:4], 1e-3)),
    Method(words="Swing {} on a pendulum about its three axes", hours=8.0, tolerances=dict.fromkeys(KEYS[4:7], 0.01)),
)
"""With the tolerances of the examples that are shipped."""


def classical(templates: Sequence[Template], there: Sequence[Fact]) -> Iterator[OfferedTest]:
    """Of every article that stood on the FMD, unless its numbers are among the facts that are `there`.

    Numbers are counted from 0; there are none of an article of which the model knows no inertia.
    """
    model = templates[0].tested.model
    known = [one for one in there if isinstance(one, ArticleFact)]
    for what in dict.fromkeys(above_fmd(one.tested.campaign.article) for one in templates):
        for method in METHODS if what else ():
            try:
                of = article_of(model, method.words, what)
            except BadInput:
                continue
            ten, numbers = request.quantities(of.at({})[0]), []
            for key, tolerance in method.tolerances.items():
                weights = weights_of(key)
                sd = (abs(float(weights @ ten)) if key in SHARES else 1.0) * tolerance / NORMAL_95
                numbers.append(ArticleFact(name=key, of=of, weights=weights, value=0.0, deviation=sd))
            if all(
                any(other.of.article == one.of.article and np.array_equal(other.weights, one.weights) for other in known)
                for one in numbers
            ):
                continue
            words = method.words.format(named(what))
            yield OfferedTest(kind=method.words, words=words, hours=method.hours, numbers=tuple(numbers))


# Tests of the menu that drive the same otherwise: deeper, higher, or at another level.


LOWEST = 2.0
"""[Hz] that a shaker of the kind can be driven down to. Exercised by test_next_test.py."""

HIGHEST = 50.0
"""[Hz] that it can be driven up to; above it a model's modes count as computed. Exercised by test_next_test.py."""

FINER = 0.05
"""[Hz] between lines at the low end. Exercised by test_next_test.py."""

HALF_LEVEL = 0.5
"""[share] of the level of a run at which a second one is offered. Exercised by test_next_test.py."""


# Tests of the menu in which a known mass is added to what was tested.


CORNER = "cover-1"

ON_PLATE = 5.0
"""[kg] that is put on the corner of the cover plate. Exercised by test_next_test.py."""

ON_ARTICLE = 0.5
"""[kg] that is put on a place of the article. Exercised by test_next_test.py."""

HOURS = 1.0
"""[h] that putting a mass on takes. Exercised by test_next_test.py."""

PLACES_OF_A_MASS = 2
"""[count] of places of an article at which a mass is offered at most. Exercised by test_next_test.py."""


def loaded(templates: Sequence[Template], asked: Sequence[str]) -> Iterator[OfferedTest]:
    """On a corner of the cover plate, beside what stands there: it loads one cell more than the others. And on places of the
    article that has most of them: those that are `asked` about, and the highest."""
    of = templates[0]
    test = planned(of, of.tested.campaign)
    bare = test.prediction.tested.carried
    made = replace(bare, moving=bare.moving + Inertia.from_cog(ON_PLATE, locations("fmd")[CORNER], np.zeros((3, 3))))  # about F
    words = f"Run {named(of)} with {ON_PLATE:g} kg on the corner {CORNER} of the cover plate"
    yield OfferedTest(kind="load on the plate", words=words, hours=HOURS, test=_carrying(test, made))
    by_template = []
    for one in templates:
        article, places = above_fmd(one.tested.campaign.article), list[str]()
        with suppress(BadInput):
            points = locations(article, one.tested.model.changes) if article else {}
            known = [place for place in one.tested.carried.standing.there.places if place in points]  # not a user's own
            places = sorted(known, key=lambda place: points[place][2])  # the lowest first
        by_template.append((one, places))
    of, there = max(by_template, key=lambda each: len(each[1]))
    chosen = dict.fromkeys((*(place for place in asked if place in there), *there[::-1]))
    asked_about = sum(place in there for place in asked)
    for place in list(chosen)[: min(max(asked_about, 1), PLACES_OF_A_MASS)]:
        words = f"Run {named(of)} with {ON_ARTICLE:g} kg more at {place}"
        test = planned(of, of.tested.campaign)
        tested = test.prediction.tested
        stands = tested.carried.standing
        heavy = None if stands.matrices is None else heavier(stands.matrices, (place,), {"": ON_ARTICLE})
        made = supported_dynamic_mass(tested.model, tested.campaign, replace(stands, matrices=heavy), tested.measured.name)
        yield OfferedTest(kind="load on the article", words=words, hours=HOURS, test=_carrying(test, made))


def _carrying(test: PlannedTest, what: SupportedDynamicMass) -> PlannedTest:
    return replace(test, prediction=replace(test.prediction, tested=replace(test.prediction.tested, carried=what)))


# Tests of the menu in which pick-ups are exchanged, moved, added, or feel no tilt.


ITS_OWN = ("accelerometer-gain", "accelerometer-delay")
"""What an accelerometer takes along when it is exchanged; place and slant stay with the place."""

WHERE = ("accelerometer-position", "accelerometer-misalignment")
"""What it gets anew when it is moved."""

INWARDS = 0.6
"""[share] of its distance from the middle of its group to which an accelerometer is moved. Exercised by test_next_test.py."""

PARALLEL = 0.99
"""[1] Cosine between two directions that are the same to a hand. Exercised by test_next_test.py."""

TILTED = ("gravity", "accelerometer-tilt", "cable")
"""Families that look like a tilt."""

COVER = "cover"

MOUNTED = (COVER, "table")
"""Groups that a chain predicts."""


def rearranged(templates: Sequence[Template], asked: Sequence[str], families: Sequence[str]) -> Iterator[OfferedTest]:
    """An accelerometer that is `asked` about changes places with one of the same direction, or sits elsewhere and its new place
    is measured with care; every second one of the cover plate has another beside it, nearer to the middle; and where one of
    `families` is about a tilt, the motion of the cover plate is measured by what feels none."""
    of = templates[0]
    campaign, table = of.tested.campaign, of.tested.campaign.table
    moving = [one for one in table.channels if one.quantity == "acceleration"]
    suspects = [one for one in moving if one.name in asked and one.group in MOUNTED]
    for one in suspects:
        # Others of its group along the same direction
        along = one.places[0].direction
        alike = [two for two in moving if two.group == one.group and two.name != one.name]
        for other in [two for two in alike if two.places[0].direction @ along > PARALLEL][:1]:
            pairs = ((one.name, other.name), (other.name, one.name))
            moved = {f"{family}:{a}": Origin(name=f"{family}:{b}") for family in ITS_OWN for a, b in pairs}
            words = f"Run {named(of)} with the accelerometers {one.name} and {other.name} exchanged"
            yield OfferedTest(kind="exchanged", words=words, hours=1.0, test=planned(of, campaign), moved=moved)
    for one in suspects:
        anew = tuple(f"{family}:{one.name}:{axis}" for family in WHERE for axis in "xyz")
        words = f"Run {named(of)} with the accelerometer {one.name} moved inwards, and its place measured again"
        test = _with_channels(of, [_inwards(one, moving)])
        yield OfferedTest(kind="moved", words=words, hours=1.0, test=test, moved=dict.fromkeys(anew, Origin()), gone=anew)
    on_cover = [one for one in moving if one.group == COVER]
    if beside := [replace(_inwards(one, moving), name=f"{one.name}-b") for one in on_cover[::2]]:
        words = f"Run {named(of)} with {len(beside)} more accelerometers on the cover plate"
        yield OfferedTest(kind="more", words=words, hours=2.0, test=_with_channels(of, beside))
    for each in templates if set(TILTED) & set(families) else ():
        sensing = [one for one in each.tested.campaign.table.channels if one.quantity == "acceleration" and one.senses_gravity]
        if kinematic := [replace(one, senses_gravity=False) for one in sensing if one.group == COVER]:
            words = f"Run {named(each)} with the motion of the cover plate measured by vibrometers, which feel no tilt"
            yield OfferedTest(kind="tilt", words=words, hours=8.0, test=_with_channels(each, kinematic))


def _inwards(one: Channel, moving: Sequence[Channel]) -> Channel:
    """Nearer to the middle of its group."""
    middle = np.mean([two.places[0].position for two in moving if two.group == one.group], axis=0)
    places = tuple(replace(place, position=middle + INWARDS * (place.position - middle)) for place in one.places)
    return replace(one, places=places)


def _with_channels(of: Template, channels: Sequence[Channel]) -> PlannedTest:
    """The campaign with `channels` instead of those of their names, and new ones behind."""
    table = of.tested.campaign.table
    by_name = {one.name: one for one in channels}
    kept = [by_name.pop(one.name, one) for one in table.channels]
    return planned(of, replace(of.tested.campaign, table=replace(table, channels=(*kept, *by_name.values()))))


# Tests of the menu that take away what is suspected, or change it by hand.


GONE: Mapping[str, str] = MappingProxyType(
    {
        "cable": "with the cables taken off",
        "load-path-shunt": "with cables and seals beside the load path taken off",
        "slosh": "with the tank drained",
        "absorber": "with whatever may swing on it held still by wax or tape",
        "appendage": "with covers and loose leads taken off the cover plate",
    }
)
"""By family, how it is taken away."""

CHANGED: Mapping[str, str] = MappingProxyType(
    {
        "joint-compliance": "with the bolts of its joint torqued again",
        "cell-stiffness": "with the bolt of that load cell torqued again",
        "gap": "with the bolt of that load cell torqued again",
    }
)
"""By family, how it is changed."""

LEFT_AFTER_TORQUING = 0.5
"""[share] of an effect that is taken to be left when bolts were torqued again. Exercised by test_next_test.py."""


# The menu: every test that could be offered after the present data. What is in them already is not offered.


def menu(templates: Sequence[Template], effects: Sequence[Added], facts: Sequence[Fact]) -> Iterator[OfferedTest]:
    """Of a laboratory that has done the campaigns of `templates` and knows `facts`, and wonders about `effects`."""
    if not templates:  # the menu is that of a shaker with a force measurement device
        return
    asked = tuple(target for one in effects for target in one.named.targets)
    families = [one.named.family for one in effects]
    yield from classical(templates, facts)
    yield from others(templates)
    yield from loaded(templates, asked)
    yield from rearranged(templates, asked, families)
    # What a hand can take away or change, on the campaign in which it acts first
    for added in effects:
        family, names = added.named.family, [each for each in added.named.sizes if not each.logarithmic]
        of = next((one for one in templates if acts(added.named, one.tested.carried.standing.there)), None)
        if of is None or family not in {*GONE, *CHANGED}:
            continue
        left = [prediction_effects.name(added.named, size.key) for size in names if family not in GONE]
        yield OfferedTest(
            kind=family,
            words=f"Run {named(of)} {GONE.get(family) or CHANGED[family]}",
            hours=HOURS,
            test=planned(of, of.tested.campaign),
            moved={name: Origin(name=name, factor=LEFT_AFTER_TORQUING) for name in left},
            gone=(family,) if family in GONE else (),
        )
    # A slow sweep below what was driven, one above of what has modes, and half the level where an explanation asks for it
    swept = [(of, "lower", "slow sweep", np.arange(LOWEST, of.frequency[0] - FINER / 2, FINER)) for of in templates]
    more = (one for one in templates if one.tested.carried.standing.modes)
    swept += [(of, "higher", "sweep", np.arange(of.frequency[-1] + SPACING, HIGHEST + SPACING / 2, SPACING)) for of in more]
    for of, kind, sweep, lines in swept:
        if len(lines):
            low, high = (LOWEST, of.frequency[0]) if kind == "lower" else (of.frequency[-1], HIGHEST)
            words = f"Run {named(of)} in a {sweep} from {low:g} to {high:g} Hz"
            yield OfferedTest(kind=kind, words=words, hours=1.0, test=planned(of, of.tested.campaign, frequency=lines))
    for of in templates if any(FAMILIES[one].side == AMPLITUDE for one in families) else ():
        words = f"Run {named(of)} at half the level"
        yield OfferedTest(kind="level", words=words, hours=1.0, test=planned(of, of.tested.campaign, level=HALF_LEVEL))
