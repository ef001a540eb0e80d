"""`Offer`: a test that a laboratory can do: in words, how long it takes, and what it would read."""

from __future__ import annotations

from collections.abc import Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, field, replace
from math import pi
from types import MappingProxyType

import numpy as np

from geometry.articles.dimensions import load
from geometry.articles.locations import locations
from geometry.errors import BadInput
from geometry.frames import Array, Pose, rotation_about
from geometry.inertia import Inertia
from geometry.sensors import Channel
from identification import request
from identification.campaign import Campaign
from identification.quality import NORMAL_95
from validation.diagnose.planned_test import SPACING, Knowledge, Moved, Origin, PlannedTest, Template, planned
from validation.effects.catalogue import FAMILIES, acts
from validation.effects.effect import AMPLITUDE
from validation.effects.families.point_mass import change as heavier
from validation.estimation.problem import Fact
from validation.model.model import Added
from validation.model.setups import FMD, above_fmd, mounted
from validation.prediction import effects as prediction_effects
from validation.prediction.classical_facts import KEYS, ArticleFact, article_of, weights_of
from validation.prediction.dynamic_mass import SupportedDynamicMass
from validation.prediction.series import supported_dynamic_mass

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
"""[deg], [h] Turns about z, and the work of each. Exercised by tests/validation/diagnosing/test_next_test.py."""


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
"""[Hz] that a shaker of the kind can be driven down to. Exercised by tests/validation/diagnosing/test_next_test.py."""

HIGHEST = 50.0
"""[Hz] that it can be driven up to; above it a model's modes count as computed. Exercised by
tests/validation/diagnosing/test_next_test.py."""

FINER = 0.05
"""[Hz] between lines at the low end. Exercised by tests/validation/diagnosing/test_next_test.py."""

HALF_LEVEL = 0.5
"""[share] of the level of a run at which a second one is offered. Exercised by tests/validation/diagnosing/test_next_test.py."""


# Tests of the menu in which a known mass is added to what was tested.


CORNER = "cover-1"

ON_PLATE = 5.0
"""[kg] that is put on the corner of the cover plate. Exercised by tests/validation/diagnosing/test_next_test.py."""

ON_ARTICLE = 0.5
"""[kg] that is put on a place of the article. Exercised by tests/validation/diagnosing/test_next_test.py."""

HOURS = 1.0
"""[h] that putting a mass on takes. Exercised by tests/validation/diagnosing/test_next_test.py."""

PLACES_OF_A_MASS = 2
"""[count] of places of an article at which a mass is offered at most. Exercised by
tests/validation/diagnosing/test_next_test.py."""


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
            places = sorted(one.tested.carried.standing.there.places, key=lambda place: points[place][2])  # the lowest first
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
        made = supported_dynamic_mass(tested.model, tested.campaign, replace(stands, matrices=heavy))
        yield OfferedTest(kind="load on the article", words=words, hours=HOURS, test=_carrying(test, made))


def _carrying(test: PlannedTest, what: SupportedDynamicMass) -> PlannedTest:
    return replace(test, prediction=replace(test.prediction, tested=replace(test.prediction.tested, carried=what)))


# Tests of the menu in which pick-ups are exchanged, moved, added, or feel no tilt.


ITS_OWN = ("accelerometer-gain", "accelerometer-delay")
"""What an accelerometer takes along when it is exchanged; place and slant stay with the place."""

WHERE = ("accelerometer-position", "accelerometer-misalignment")
"""What it gets anew when it is moved."""

INWARDS = 0.6
"""[share] of its distance from the middle of its group to which an accelerometer is moved. Exercised by
tests/validation/diagnosing/test_next_test.py."""

PARALLEL = 0.99
"""[1] Cosine between two directions that are the same to a hand. Exercised by tests/validation/diagnosing/test_next_test.py."""

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
"""[share] of an effect that is taken to be left when bolts were torqued again. Exercised by
tests/validation/diagnosing/test_next_test.py."""


# The menu: every test that could be offered after the present data. What is in them already is not offered.


def menu(templates: Sequence[Template], effects: Sequence[Added], facts: Sequence[Fact]) -> Iterator[OfferedTest]:
    """Of a laboratory that has done the campaigns of `templates` and knows `facts`, and wonders about `effects`."""
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
    for of in (one for one in templates if one.tested.carried.standing.modes):
        swept.append((of, "higher", "sweep", np.arange(of.frequency[-1] + SPACING, HIGHEST + SPACING / 2, SPACING)))
    for of, kind, sweep, lines in swept:
        if len(lines):
            low, high = (LOWEST, of.frequency[0]) if kind == "lower" else (of.frequency[-1], HIGHEST)
            words = f"Run {named(of)} in a {sweep} from {low:g} to {high:g} Hz"
            yield OfferedTest(kind=kind, words=words, hours=1.0, test=planned(of, of.tested.campaign, frequency=lines))
    for of in templates if any(FAMILIES[one].side == AMPLITUDE for one in families) else ():
        words = f"Run {named(of)} at half the level"
        yield OfferedTest(kind="level", words=words, hours=1.0, test=planned(of, of.tested.campaign, level=HALF_LEVEL))
