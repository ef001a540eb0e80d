"""`Family`: one physical effect as data, with its equation as a change of the prediction.

Each is one small file of ``families/``, or, where it opens a parameter, a table of ``families/opened.toml``.

A prediction is made in stages, and an effect changes one of them (`validation.effects.stages`):

    STRUCTURE_STAGE   reduced matrices of what stands on its base: masses, springs, losses, resonators
    BODY_STAGE        dynamic mass of the article: where it stands, on what joint, what hangs beside it
    CHANNEL_STAGE     what every channel reads for a unit of each input
    NOISE_STAGE       how much noise is expected on a channel
    PERIOD_STAGE      the period of a pendulum
    OPENED            no equation of its own: a parameter of the laboratory or of the structure that bears the effect's id leaves
                      its tolerance (`identification.chain`, moduli of the parts)

The equation gets the stage, the targets and the values in SI by key, and returns the changed stage; at the `null` sizes it
changes nothing. Equations of structure add, those of channels are linear in what they get, so that derivatives pass through.
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field
from functools import cache
from math import isfinite
from typing import Any

from geometry.dynamic_mass import MOTIONS
from geometry.inertia import PARAMETERS
from validation.output import entry, unwritten

STRUCTURE, FORCES, ACCELERATIONS, MISTAKE, AMPLITUDE, PROCESSING, PENDULUM = SIDES = (
    "structure",
    "force side",
    "acceleration side",
    "discrete mistake",
    "amplitude-dependent",
    "processing",
    "pendulum",
)

STRUCTURE_STAGE, BODY_STAGE, CHANNEL_STAGE, NOISE_STAGE, PERIOD_STAGE, OPENED = STAGES = (
    "structure",
    "dynamic mass",
    "channels",
    "noise",
    "period",
    "opened",
)

Values = Mapping[str, float]
"""Sizes in SI by key, the empty key for the one that stands alone."""

Change = Callable[[Any, tuple[str, ...], Values], Any]
"""``change(stage, targets, values) -> stage``."""


EVERY = "every"
"""Name of all joints together: what was made alike is often wrong alike."""

TOGETHER = "all@"
"""With which the name of a joint begins that is between a node and all that meets there (`fem.user_model.frame`)."""


def joints_named(target: str, joints: Iterable[str]) -> tuple[str, ...]:
    """Those of `joints` that `target` names: one, those of every end (`EVERY`), or those of every node (`TOGETHER` `EVERY`).

    Where a single member ends, its joint is that of the node.
    """
    nodes = {one.removeprefix(TOGETHER) for one in joints if one.startswith(TOGETHER)}
    if target == EVERY:
        return tuple(one for one in joints if not one.startswith(TOGETHER))
    if target == TOGETHER + EVERY:
        return tuple(one for one in joints if one.startswith(TOGETHER) or one.partition("@")[2] not in nodes)
    return (target,)


@dataclass(frozen=True, kw_only=True)
class SizeSpec:
    """One number that says how large an effect is.

    Attributes
    ----------
    key : by which it is written, ``key:number``; empty for the one that stands alone
    unit : SI; "1" for a ratio
    low, high : beyond is no physics of a test, or a unit was mistaken
    default : what holds where it is not written; None for one that must be
    whole : whether it is a whole number, as a switch is
    null : the size at which there is no effect
    plausible : standard deviation of a fault before anything was measured, of the logarithm where `logarithmic`; 0 for a size
        that is not fitted
    logarithmic : whether it is fitted by its logarithm: positive, and known to a factor
    stated : the size that mechanics says it has wherever the effect is; None where nothing says so
    """

    key: str = ""
    unit: str
    low: float
    high: float
    default: float | None = None
    whole: bool = False
    null: float = 0.0
    plausible: float = entry(null=0.0, default=0.0)
    logarithmic: bool = False
    stated: float | None = unwritten(default=None)


@dataclass(frozen=True, eq=False, kw_only=True)
class Family:
    """A family of effects.

    Attributes
    ----------
    name : the part of the identifier before the first colon
    side : of `SIDES`, the heading under which the catalogue lists it
    what : in a few words
    targets : kind of each target, in the order of the identifier
    optional : whether the last of them may be left out
    sizes : what its value holds; nothing for a mistake that is there or not
    varying : the sizes that depend on a target, by that
    example : one that can be typed
    stage : of `STAGES`, what it changes
    change : its equation; None where a parameter of its name is opened
    limits : least and greatest size on a structure, at a point (3,) [m] of it where that is known, along a direction (3,)
    straight : of what it changes a size over a small part of which the equation is a straight line; None where any is
    tolerance : what a careful laboratory admits of it, one standard deviation in its unit; 0 for nothing
    equation : in one line, as in a paper
    mistaken_for : ids or families that look like it
    confirmed_by : what would confirm it in the laboratory
    reference : where the equation comes from
    sentence : what it means, for somebody who never heard of it; ``{target}`` stands for the first of its targets, ``{targets}``
        for all of them
    plant : makes it happen in a virtual test, ``plant(named) -> validation.virtual_test.plan.PlantedEffect``; None for one that
        no virtual test knows
    """

    name: str
    side: str
    what: str
    targets: tuple[str, ...] = ()
    optional: bool = False
    sizes: tuple[SizeSpec, ...] = ()
    varying: Mapping[str, tuple[SizeSpec, ...]] = field(default_factory=dict)
    example: str
    stage: str = OPENED
    change: Change | None = None
    limits: Callable[[Any, Any, Any], tuple[float, float]] | None = None
    straight: Callable[[Any, tuple[str, ...], Values], float] | None = None
    tolerance: float = 0.0
    equation: str = ""
    mistaken_for: tuple[str, ...] = ()
    confirmed_by: str = ""
    reference: str = ""
    sentence: str = ""
    plant: Callable[[Any], Any] | None = None

    def sizes_at(self, targets: tuple[str, ...]) -> tuple[SizeSpec, ...]:
        """What the value holds of an effect on `targets`."""
        return next((self.varying[one] for one in reversed(targets) if one in self.varying), self.sizes)


# Sizes that several families have in common.


def relative(low: float, high: float, plausible: float = 0.0) -> tuple[SizeSpec, ...]:
    """One ratio between `low` and `high`."""
    return (SizeSpec(unit="1", low=low, high=high, plausible=plausible),)


def resonator(mass: float) -> tuple[SizeSpec, ...]:
    """Mass, frequency and damping ratio of a resonator of at most `mass` [kg]."""
    return (
        SizeSpec(key="m", unit="kg", low=1e-6, high=mass, plausible=2.0, logarithmic=True),
        SizeSpec(key="f", unit="Hz", low=0.01, high=1e5, plausible=1.0, logarithmic=True),
        SizeSpec(key="zeta", unit="1", low=1e-5, high=0.99, plausible=1.0, logarithmic=True),
    )


GAIN = relative(-0.9, 9.0, 0.1)
DELAY = (SizeSpec(unit="s", low=-0.1, high=0.1, plausible=500e-6),)
LENGTH = (SizeSpec(unit="m", low=-0.5, high=0.5, plausible=0.01),)
ANGLE = (SizeSpec(unit="rad", low=-0.5, high=0.5, plausible=0.05),)
SWITCH = (SizeSpec(unit="1", low=0.0, high=1.0, default=1.0, whole=True, null=1.0, plausible=1.0),)
THERE = (SizeSpec(unit="1", low=0.0, high=1.0, default=1.0, whole=True),)
TURNING = (SizeSpec(unit="rad/(N m)", low=1e-12, high=1e-2, plausible=2e-6),)
SHIFTING = (SizeSpec(unit="m/N", low=1e-13, high=1e-3, plausible=1e-8),)
MASS = (SizeSpec(unit="kg", low=-1e3, high=1e3, plausible=2.0),)
FIRST = (SizeSpec(unit="kg m", low=-1e3, high=1e3, plausible=1.0),)
SECOND = (SizeSpec(unit="kg m^2", low=-1e3, high=1e3, plausible=0.5),)
RATIO = relative(-1.0, 1.0, 0.05)


# Where an effect may act: channels, cells, axes, places and parts, by the words of its identifier.


AXES = ("x", "y", "z")
LATERAL = ("x", "y")
CELLS = ("1", "2", "3", "4")
JOINT = ("rotation", "lateral", "vertical", "torsion")
PARTS = ("mast", "lower-1", "lower-2", "upper-long", "upper-short")

TABLE = ("table-z1", "table-z2", "table-z3", "table-x1", "table-y1", "table-y2")
COVER = ("cover-z1", "cover-z2", "cover-z3", "cover-z4", "cover-x1", "cover-x2", "cover-y1", "cover-y2")
FMD = ("fmd-x12", "fmd-x34", "fmd-y14", "fmd-y23", "fmd-z1", "fmd-z2", "fmd-z3", "fmd-z4")
"""The paper's 22 signals."""

FIXED = {
    "axis": AXES,
    "lateral axis": LATERAL,
    "turning axis": ("z",),
    "cell": CELLS,
    "cell and axis": tuple(cell + axis for cell in CELLS for axis in AXES),
    "pair of axes": tuple(i + j for i in AXES for j in AXES if i != j),
    "direction of the joint": JOINT,
    "direction of the FMD": ("lateral", "vertical"),
    "direction at a joint": MOTIONS,
    "joint": ("flange",),
    "board": ("force", "cover", "table"),
    "parameter": PARAMETERS,
    "part with a layer": ("upper-short",),
}
"""Targets that are the same whatever was tested, by kind."""

CHANNEL, FORCE, ACCELEROMETER, PLACE, PART = "channel", "force channel", "accelerometer", "place", "part"
SUPPORT, BETWEEN, CABLE = "support", "joint between parts", "direction of a cable"
DRIVE = "drive point"
"""Kinds of target that depend on what was tested, and with what."""

AT = "@"
"""Begins a place that is no name but coordinates in the article's frame, ``@0.1,0,0.25`` [m]."""


def position(place: str) -> tuple[float, float, float] | None:
    """(x, y, z) [m] of a `place` that is written as coordinates; None of a name, and of what is no three numbers."""
    texts = place.removeprefix(AT).split(",")
    if not place.startswith(AT) or len(texts) != 3:
        return None
    try:
        x, y, z = (float(text) for text in texts)
    except ValueError:
        return None
    return (x, y, z) if isfinite(x + y + z) else None


def at_position(point: Sequence[float]) -> str:
    """How the place at `point` (3,) [m] is written, to the micrometre."""
    return AT + ",".join(f"{round(value, 6) + 0.0:.9g}" for value in point)


ABREAST, EVERY_WAY = ("lateral", "vertical"), ("lateral", "vertical", *AXES)
"""Directions of a cable: those by which a mast that stands upright is told about, and all that there are."""


@dataclass(frozen=True, kw_only=True)
class Vocabulary:
    """The targets of one test that no other need have.

    Attributes
    ----------
    accelerometers, forces : names of the channels; None where they are not known and any name will do
    places : named places of what was tested; None likewise
    parts : of what was tested, supports and joints among them; None likewise
    supports, joints : those parts that are springs to the ground, and between two others; None likewise
    ways : directions that a cable may have
    drives : points at which a structure was struck or shaken; None likewise
    """

    accelerometers: tuple[str, ...] | None = (*TABLE, *COVER)
    forces: tuple[str, ...] | None = FMD
    places: tuple[str, ...] | None = None
    parts: tuple[str, ...] | None = PARTS
    supports: tuple[str, ...] | None = None
    joints: tuple[str, ...] | None = None
    ways: tuple[str, ...] = EVERY_WAY
    drives: tuple[str, ...] | None = None

    def legal(self, kind: str) -> tuple[str, ...] | None:
        """All targets of a `kind`; None where any name will do."""
        own = {
            CHANNEL: None if self.accelerometers is None or self.forces is None else (*self.accelerometers, *self.forces),
            FORCE: self.forces,
            ACCELEROMETER: self.accelerometers,
            PLACE: self.places,
            PART: self.parts,
            SUPPORT: self.supports,
            BETWEEN: self.joints,
            CABLE: self.ways,
            DRIVE: self.drives,
        }
        return own[kind] if kind in own else FIXED[kind]


@cache
def built_in_places() -> tuple[str, ...]:
    """Every named place of any built-in article that can stand on the FMD."""
    from geometry.articles import locations

    return tuple(dict.fromkeys(place for article in ("clumod-4", "cuboid", "disc") for place in locations(article)))


# How much evidence an effect must bring to be worth its parameters: limits that were set from tests in which nothing is wrong.
#
# The figures behind them are those of ``make blind``; docs/diagnosis-proven-blind.md tells them.


EVIDENCE_THRESHOLD = 8.0
"""[nats] of evidence that an effect must bring to be named."""

INDISTINGUISHABLE_NATS = 5.0
"""[nats] within which two explanations are as good as each other."""

WORTH_OF = {"modulus": 6.0, "cell-stiffness": 12.0, "structural-damping": 20.0, "layer-damping": 12.0}
"""The same by family. Moduli are few, and known to scatter as they are said to. Of cell stiffnesses there are many that say
nearly the same, and one null of twelve came to 7. Loss factors scatter by their logarithm, and what is known of them has a longer
tail than the normal deviate that a fit takes it for; of a layer, of which there is one, a sound test reaches 12 where its loss
factor is 3.3 standard deviations too large, once in two thousand."""


def evidence_threshold(family: str) -> float:
    """[nats] that an effect of `family` must bring to be named."""
    return WORTH_OF.get(family, EVIDENCE_THRESHOLD)
