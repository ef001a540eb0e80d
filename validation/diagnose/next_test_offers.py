"""`Offer`: a test that a laboratory can do: in words, how long it takes, and what it would read."""

from __future__ import annotations

from collections.abc import Callable, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import pi
from types import MappingProxyType

import numpy as np

from geometry.articles.locations import locations
from geometry.articles.parts import load
from geometry.errors import BadInput
from geometry.frames import Pose, rotation_about
from geometry.inertia import Inertia
from geometry.sensors import Channel, ChannelTable, Place
from identification import request
from identification.campaign import Campaign
from identification.quality import NORMAL_95
from validation.diagnose.planned_test import SPACING, Knowledge, Moved, Origin, PlannedTest, Template, planned
from validation.effects.catalogue import FAMILIES, acts
from validation.effects.effect import AMPLITUDE
from validation.effects.families.point_mass import change as heavier
from validation.estimation.problem import Fact
from validation.model.model import Added, Model
from validation.model.setups import FMD, above_fmd, mounted
from validation.prediction import effects as prediction_effects
from validation.prediction.classical_facts import KEYS, ArticleFact, article_of, weights_of
from validation.prediction.dynamic_mass import SupportedDynamicMass
from validation.prediction.series import supported_dynamic_mass

NOTHING: Mapping[str, Origin] = MappingProxyType({})


def no_facts(effects: Sequence[Added]) -> tuple[Fact, ...]:
    """Of a test that is a campaign."""
    return ()


@dataclass(frozen=True, eq=False, kw_only=True)
class OfferedTest:
    """A test of the menu: a campaign, or numbers of another measurement.

    Attributes
    ----------
    kind : of several of one kind only the best is named
    words : what to do
    hours : of work, roughly; assumed, to compare tests by
    test : the campaign; None for other measurements
    facts : by effects, the numbers of another measurement
    moved : parameters that the test moves or draws anew
    gone : families or ids of effects that the test takes away
    """

    kind: str
    words: str
    hours: float
    test: PlannedTest | None = None
    facts: Callable[[Sequence[Added]], tuple[Fact, ...]] = no_facts
    moved: Moved = field(default_factory=lambda: NOTHING)
    gone: tuple[str, ...] = ()

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
"""[deg], [h] Turns about z, and the work of each. Exercised by tests/validation/diagnosing/advisor/test_advised.py."""


def named(article: str) -> str:
    """What stands on the FMD, in words."""
    return IN_WORDS.get(article, article)


def others(templates: Sequence[Template]) -> Iterator[OfferedTest]:
    """Articles that were not tested yet."""
    there = {above_fmd(one.tested.campaign.article) for one in templates}
    for other in OTHERS:
        if other.article in there or (other.article in FAMILY and not there & set(FAMILY)):
            continue
        yield from _run(
            other.article, f"Run {named(other.article)}", other.hours, templates[0], _with(templates[0], other.article)
        )


def turned(templates: Sequence[Template]) -> Iterator[OfferedTest]:
    """What was tested, and the Cuboid, turned about z."""
    for one in templates:
        campaign = one.tested.campaign
        if above_fmd(campaign.article):
            for angle, hours in TURNS:
                words = f"Run {named(above_fmd(campaign.article))} turned by {angle:g} degrees about z"
                yield from _run("turned", words, hours, one, _posed(campaign, _about_z(campaign, angle)))
    if not any(CUBOID in one.tested.campaign.article for one in templates):
        campaign = _with(templates[0], TARE)
        words = f"Run {named(TARE)} turned by 90 degrees about z"
        yield from _run("turned", words, TURNS[0][1], templates[0], _posed(campaign, _about_z(campaign, TURNS[0][0])))


def lying(templates: Sequence[Template]) -> Iterator[OfferedTest]:
    """The Cuboid on its broad side: the same mass at another height."""
    campaign = _with(templates[0], CUBOID)
    pose, _ = mounted(campaign)
    _, depth, height = load(CUBOID)["size"]
    down = Pose(position=np.array([0.0, height / 2, depth / 2]), rotation=rotation_about("x", pi / 2))
    yield from _run("lying", "Run the Cuboid lying on its broad side", 2.0, templates[0], _posed(campaign, pose @ down))


def _run(kind: str, words: str, hours: float, of: Template, campaign: Campaign) -> Iterator[OfferedTest]:
    """The offer; none where the model cannot describe what would stand there."""
    try:
        yield OfferedTest(kind=kind, words=words, hours=hours, test=planned(of, campaign))
    except BadInput:
        return


def _with(of: Template, article: str) -> Campaign:
    """The campaign with another article, mounted where articles are."""
    campaign = of.tested.campaign
    pose, _ = mounted(campaign)
    upright = Pose(position=pose.position + campaign.table.origin)
    return replace(campaign, article="+".join(part for part in (FMD, article) if part), mounting=upright if article else None)


def _posed(campaign: Campaign, pose: Pose) -> Campaign:
    return replace(campaign, mounting=Pose(position=pose.position + campaign.table.origin, rotation=pose.rotation))


def _about_z(campaign: Campaign, degrees: float) -> Pose:
    pose, _ = mounted(campaign)
    return Pose(position=pose.position, rotation=rotation_about("z", degrees * pi / 180) @ pose.rotation)


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
    """Of every article that stood on the FMD, unless its numbers are among the facts that are `there`."""
    model = templates[0].tested.model
    known = [one for one in there if isinstance(one, ArticleFact)]
    for what in dict.fromkeys(above_fmd(one.tested.campaign.article) for one in templates):
        for method in METHODS if what else ():
            facts = _facts(model, what, method)
            if any(
                not any(other.of.article == one.of.article and np.array_equal(other.weights, one.weights) for other in known)
                for one in facts
            ):
                yield OfferedTest(
                    kind=method.words,
                    words=method.words.format(named(what)),
                    hours=method.hours,
                    facts=partial(_with_measurement, facts),
                )


def _facts(model: Model, what: str, method: Method) -> tuple[ArticleFact, ...]:
    """The numbers of the method, each counted from 0; none of an article of which the model knows no inertia."""
    try:
        of = article_of(model, method.words, what)
    except BadInput:
        return ()
    ten = request.quantities(of.at({})[0])
    found = []
    for key, tolerance in method.tolerances.items():
        weights = weights_of(key)
        size = abs(float(weights @ ten)) if key in SHARES else 1.0
        found.append(ArticleFact(name=key, of=of, weights=weights, value=0.0, deviation=size * tolerance / NORMAL_95))
    return tuple(found)


def _with_measurement(facts: Sequence[ArticleFact], effects: Sequence[Added]) -> tuple[Fact, ...]:
    return tuple(one.with_effects(effects) for one in facts)


# Tests of the menu that drive the same otherwise: deeper, higher, or at another level.


LOWEST = 2.0
"""[Hz] that a shaker of the kind can be driven down to. Exercised by tests/validation/diagnosing/advisor/test_advised.py."""

HIGHEST = 50.0
"""[Hz] that it can be driven up to; above it a model's modes count as computed. Exercised by
tests/validation/diagnosing/advisor/test_advised.py."""

FINER = 0.05
"""[Hz] between lines at the low end. Exercised by tests/validation/diagnosing/advisor/test_advised.py."""

HALF_LEVEL = 0.5
"""[share] of the level of a run at which a second one is offered. Exercised by
tests/validation/diagnosing/advisor/test_advised.py."""


def lower(templates: Sequence[Template]) -> Iterator[OfferedTest]:
    """A slow sweep below what was driven."""
    for of in templates:
        lines = np.arange(LOWEST, of.frequency[0] - FINER / 2, FINER)
        if len(lines):
            words = f"Run {_what(of)} in a slow sweep from {LOWEST:g} to {of.frequency[0]:g} Hz"
            yield OfferedTest(kind="lower", words=words, hours=1.0, test=planned(of, of.tested.campaign, frequency=lines))


def higher(templates: Sequence[Template]) -> Iterator[OfferedTest]:
    """A sweep above what was driven, of what has modes."""
    for of in (one for one in templates if one.tested.carried.standing.modes):
        lines = np.arange(of.frequency[-1] + SPACING, HIGHEST + SPACING / 2, SPACING)
        if len(lines):
            words = f"Run {_what(of)} in a sweep from {of.frequency[-1]:g} to {HIGHEST:g} Hz"
            yield OfferedTest(kind="higher", words=words, hours=1.0, test=planned(of, of.tested.campaign, frequency=lines))


def levels(templates: Sequence[Template], families: Sequence[str]) -> Iterator[OfferedTest]:
    """The same at half the level, where one of the explanations asks for it."""
    if any(FAMILIES[one].side == AMPLITUDE for one in families):
        for of in templates:
            words = f"Run {_what(of)} at half the level"
            yield OfferedTest(kind="level", words=words, hours=1.0, test=planned(of, of.tested.campaign, level=HALF_LEVEL))


def _what(of: Template) -> str:
    return named(above_fmd(of.tested.campaign.article))


# Tests of the menu in which a known mass is added to what was tested.


CORNER = "cover-1"

ON_PLATE = 5.0
"""[kg] that is put on the corner of the cover plate. Exercised by tests/validation/diagnosing/advisor/test_advised.py."""

ON_ARTICLE = 0.5
"""[kg] that is put on a place of the article. Exercised by tests/validation/diagnosing/advisor/test_advised.py."""

HOURS = 1.0
"""[h] that putting a mass on takes. Exercised by tests/validation/diagnosing/advisor/test_advised.py."""

PLACES_OF_A_MASS = 2
"""[count] of places of an article at which a mass is offered at most. Exercised by
tests/validation/diagnosing/advisor/test_advised.py."""


def on_article(templates: Sequence[Template], asked: Sequence[str]) -> Iterator[OfferedTest]:
    """On places of the article that has most of them: those that are `asked` about, and the highest."""
    of = max(templates, key=lambda one: len(_places(one)))
    there = _places(of)
    chosen = dict.fromkeys((*(place for place in asked if place in there), *there[::-1]))
    asked_about = sum(place in there for place in asked)
    for place in list(chosen)[: min(max(asked_about, 1), PLACES_OF_A_MASS)]:
        words = f"Run {named(above_fmd(of.tested.campaign.article))} with {ON_ARTICLE:g} kg more at {place}"
        test = planned(of, of.tested.campaign)
        tested = test.prediction.tested
        stands = tested.carried.standing
        heavy = None if stands.matrices is None else heavier(stands.matrices, (place,), {"": ON_ARTICLE})
        with_mass = _carrying(test, supported_dynamic_mass(tested.model, tested.campaign, replace(stands, matrices=heavy)))
        yield OfferedTest(kind="load on the article", words=words, hours=HOURS, test=with_mass)


def _carrying(test: PlannedTest, what: SupportedDynamicMass) -> PlannedTest:
    return replace(test, prediction=replace(test.prediction, tested=replace(test.prediction.tested, carried=what)))


def _places(of: Template) -> tuple[str, ...]:
    """Of the article on the FMD, the lowest first."""
    article = above_fmd(of.tested.campaign.article)
    try:
        points = locations(article, of.tested.model.changes) if article else {}
    except BadInput:
        return ()
    return tuple(sorted((place for place in of.tested.carried.standing.there.places), key=lambda place: points[place][2]))


# Tests of the menu in which pick-ups are exchanged, moved, added, or feel no tilt.


ITS_OWN = ("accelerometer-gain", "accelerometer-delay")
"""What an accelerometer takes along when it is exchanged; place and slant stay with the place."""

WHERE = ("accelerometer-position", "accelerometer-misalignment")
"""What it gets anew when it is moved."""

INWARDS = 0.6
"""[share] of its distance from the middle of its group to which an accelerometer is moved. Exercised by
tests/validation/diagnosing/advisor/test_expected.py."""

PARALLEL = 0.99
"""[1] Cosine between two directions that are the same to a hand. Exercised by
tests/validation/diagnosing/advisor/test_expected.py."""

TILTED = ("gravity", "accelerometer-tilt", "cable")
"""Families that look like a tilt."""

COVER = "cover"

MOUNTED = (COVER, "table")
"""Groups that a chain predicts."""

AXES = "xyz"


def exchanged(templates: Sequence[Template], asked: Sequence[str]) -> Iterator[OfferedTest]:
    """An accelerometer that is `asked` about and one of the same direction change places."""
    of = templates[0]
    for one in _accelerometers(of, asked):
        # Others of its group along the same direction
        along = one.places[0].direction
        alike = [two for two in _on(of, one.group) if two.name != one.name and two.places[0].direction @ along > PARALLEL]
        for other in alike[:1]:
            pairs = ((one.name, other.name), (other.name, one.name))
            moved = {f"{family}:{a}": Origin(name=f"{family}:{b}") for family in ITS_OWN for a, b in pairs}
            words = f"Run {_beneath(of)} with the accelerometers {one.name} and {other.name} exchanged"
            yield OfferedTest(kind="exchanged", words=words, hours=1.0, test=planned(of, of.tested.campaign), moved=moved)


def moved(templates: Sequence[Template], asked: Sequence[str]) -> Iterator[OfferedTest]:
    """An accelerometer that is `asked` about sits elsewhere, and its new place is measured with care."""
    of = templates[0]
    for one in _accelerometers(of, asked):
        anew = tuple(f"{family}:{one.name}:{axis}" for family in WHERE for axis in AXES)
        campaign = replace(of.tested.campaign, table=_changed(of, [replace(one, places=_inwards(of, one))]))
        words = f"Run {_beneath(of)} with the accelerometer {one.name} moved inwards, and its place measured again"
        yield OfferedTest(
            kind="moved", words=words, hours=1.0, test=planned(of, campaign), moved=dict.fromkeys(anew, Origin()), gone=anew
        )


def more(templates: Sequence[Template]) -> Iterator[OfferedTest]:
    """Every second accelerometer of the cover plate has another one beside it, nearer to the middle."""
    of = templates[0]
    beside = [replace(one, name=f"{one.name}-b", places=_inwards(of, one)) for one in _on(of, COVER)[::2]]
    if beside:
        campaign = replace(of.tested.campaign, table=_changed(of, beside))
        words = f"Run {_beneath(of)} with {len(beside)} more accelerometers on the cover plate"
        yield OfferedTest(kind="more", words=words, hours=2.0, test=planned(of, campaign))


def without_tilt(templates: Sequence[Template], families: Sequence[str]) -> Iterator[OfferedTest]:
    """The motion of the cover plate is measured by what feels no tilt, where one of `families` is about that."""
    for of in templates if set(TILTED) & set(families) else ():
        kinematic = [replace(one, senses_gravity=False) for one in _on(of, COVER) if one.senses_gravity]
        if kinematic:
            campaign = replace(of.tested.campaign, table=_changed(of, kinematic))
            words = f"Run {_beneath(of)} with the motion of the cover plate measured by vibrometers, which feel no tilt"
            yield OfferedTest(kind="tilt", words=words, hours=8.0, test=planned(of, campaign))


def _beneath(of: Template) -> str:
    return named(above_fmd(of.tested.campaign.article))


def _on(of: Template, group: str) -> list[Channel]:
    return [one for one in of.tested.campaign.table.channels if one.group == group and one.quantity == "acceleration"]


def _accelerometers(of: Template, asked: Sequence[str]) -> list[Channel]:
    there = of.tested.campaign.table.channels
    return [one for one in there if one.name in asked and one.quantity == "acceleration" and one.group in MOUNTED]


def _inwards(of: Template, one: Channel) -> tuple[Place, ...]:
    middle = np.mean([two.places[0].position for two in _on(of, one.group)], axis=0)
    return tuple(replace(place, position=middle + INWARDS * (place.position - middle)) for place in one.places)


def _changed(of: Template, channels: Sequence[Channel]) -> ChannelTable:
    """The table with `channels` instead of those of their names, and new ones behind."""
    table = of.tested.campaign.table
    by_name = {one.name: one for one in channels}
    kept = [by_name.pop(one.name, one) for one in table.channels]
    return replace(table, channels=(*kept, *by_name.values()))


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
tests/validation/diagnosing/advisor/test_expected.py."""


def undone(templates: Sequence[Template], effects: Sequence[Added]) -> Iterator[OfferedTest]:
    """Of every one of `effects` that a hand can reach, on the campaign in which it acts first."""
    for added in effects:
        of = next((one for one in templates if acts(added.named, one.tested.carried.standing.there)), None)
        family = added.named.family
        if of is None or family not in {*GONE, *CHANGED}:
            continue
        what, how = named(above_fmd(of.tested.campaign.article)), GONE.get(family) or CHANGED[family]
        test = planned(of, of.tested.campaign)
        gone = (family,) if family in GONE else ()
        names = (
            () if gone else (prediction_effects.name(added.named, size.key) for size in added.named.sizes if not size.logarithmic)
        )
        moved = {name: Origin(name=name, factor=LEFT_AFTER_TORQUING) for name in names}
        yield OfferedTest(kind=added.named.family, words=f"Run {what} {how}", hours=HOURS, test=test, moved=moved, gone=gone)


# The menu: every test that could be offered after the present data. What is in them already is not offered.


def menu(templates: Sequence[Template], effects: Sequence[Added], facts: Sequence[Fact]) -> Iterator[OfferedTest]:
    """Of a laboratory that has done the campaigns of `templates` and knows `facts`, and wonders about `effects`."""
    asked = tuple(target for one in effects for target in one.named.targets)
    families = [one.named.family for one in effects]
    yield from classical(templates, facts)
    yield from others(templates)
    yield from turned(templates)
    yield from lying(templates)
    # On a corner of the cover plate, beside what stands there: it loads one cell more than the others
    of = templates[0]
    place = locations("fmd")[CORNER]
    test = planned(of, of.tested.campaign)
    bare = test.prediction.tested.carried
    # About F
    made = _carrying(test, replace(bare, moving=bare.moving + Inertia.from_cog(ON_PLATE, place, np.zeros((3, 3)))))
    beside = named(above_fmd(of.tested.campaign.article))
    words = f"Run {beside} with {ON_PLATE:g} kg on the corner {CORNER} of the cover plate"
    yield OfferedTest(kind="load on the plate", words=words, hours=HOURS, test=made)
    yield from on_article(templates, asked)
    yield from exchanged(templates, asked)
    yield from moved(templates, asked)
    yield from more(templates)
    yield from without_tilt(templates, families)
    yield from undone(templates, effects)
    yield from lower(templates)
    yield from higher(templates)
    yield from levels(templates, families)
