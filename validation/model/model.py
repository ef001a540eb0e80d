"""`Model`: what a model file says. One model serves a whole series: a campaign's `article` picks the set-up."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, field, replace
from pathlib import Path
from types import MappingProxyType
from typing import Any

import numpy as np

from geometry.articles import NAMES
from geometry.errors import BadInput
from geometry.frames import Array, frozen
from geometry.inertia import Inertia
from geometry.sensors import Channel, Tolerances
from geometry.toml_file import nearest
from identification.campaign import Campaign
from identification.campaign_file import NAME
from identification.response_functions import GAIN
from validation.effects.catalogue import FAMILIES, Named, of_parts, on_article
from validation.effects.effect import ABREAST, ACCELEROMETER, AT, AXES, CHANNEL, FORCE, PART, PLACE, Vocabulary
from validation.model.learnt import ANEW, Learnt
from validation.model.setups import above_fmd
from validation.model.tolerance_classes import METROLOGY, MountingTolerances
from validation.model.tolerance_classes import StructureTolerances as StructureTolerances

BEAM, RIGID, USER = KINDS = ("beam", "rigid", "own")


@dataclass(frozen=True, eq=False, kw_only=True)
class Added:
    """An effect of the model.

    Attributes
    ----------
    named : what it is, where it acts, and its size
    deviation : standard deviation by key of its values, as its fit left it; empty for one that was never fitted
    fixed : whether its size is given and not to be fitted
    """

    named: Named
    deviation: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    fixed: bool = False


LIMITED = {
    "mass": "mass",
    **{f"cog_{axis}": "length" for axis in "xyz"},
    **{f"{kind}_{axes}": "moment of inertia" for kind, of in (("moi", "xx yy zz"), ("poi", "xy xz yz")) for axes in of.split()},
}
"""What a requirement may limit, in the order of a statement, and its dimension."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Requirement:
    """Within what the model's article must lie, CoG from its own origin, moments and products about the CoG.

    Attributes
    ----------
    quantity : of `LIMITED`
    low, high : [SI]; None where that side is open
    clause : where it is demanded, as a report cites it
    """

    quantity: str
    low: float | None = None
    high: float | None = None
    clause: str = ""


@dataclass(frozen=True, eq=False, kw_only=True)
class Model:
    """A model.

    Attributes
    ----------
    source : the file, for messages
    title : in a few words
    article : the set-up it was written for, and whose parts it may describe
    hardware : id of FMD and sensors for which it holds; empty for any
    gravity : [m/s²]
    fmd : inertia of the FMD's moving part about F; None for that of the drawing
    fmd_tolerance : standard deviation of its parameters, as a share
    cell_stiffness : (3,) [N/m] of one load cell along x, y, z; None where it is not known
    tolerance_class : of `validation.model.tolerance_classes.NAMES`, whose tolerances hold where the file states none
    tolerances : of the measurement chain
    sensor_gain : standard deviation of gains in tests that state none: of the class that the file states, else the usual one
    opened : by family of its parameters that are closed otherwise, their standard deviation in SI
    mounting : of where and as what articles stand
    learnt : what the laboratory has learnt of its hardware; None where it states nothing
    kind : of `KINDS`, how the articles are modelled
    modes : how many are kept
    changes : a user's own dimensions of built-in articles, as `geometry.articles.parts` names them
    damping_ratio : of every mode; None for the loss factors of the parts
    own : by article, the path of a user's own model (`fem.user_model`)
    structure : tolerances of the structure
    tests : tables [[test]] of response functions and modal tables, read when a study is opened
    effects : in the order in which they act
    revision : of this file, as a report cites it
    requirements : that its article has to meet
    looked_at : places by coordinates, as `validation.effects.effect.position` reads them, that the structure is made ready for
        beside those of the effects
    """

    source: str
    title: str
    article: str
    hardware: str = ""
    gravity: float = 9.81
    fmd: Inertia | None = None
    fmd_tolerance: float = 0.05
    cell_stiffness: Array | None = None
    tolerance_class: str = METROLOGY
    tolerances: Tolerances = field(default_factory=Tolerances)
    sensor_gain: float = GAIN
    opened: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    mounting: MountingTolerances = field(default_factory=MountingTolerances)
    learnt: Learnt | None = None
    kind: str = BEAM
    modes: int = 30
    changes: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    damping_ratio: float | None = None
    own: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    structure: StructureTolerances = field(default_factory=StructureTolerances)
    tests: tuple[Mapping[str, Any], ...] = ()
    effects: tuple[Added, ...] = ()
    revision: str = ""
    requirements: tuple[Requirement, ...] = ()
    looked_at: tuple[str, ...] = ()

    @property
    def positions(self) -> tuple[str, ...]:
        """Places by coordinates at which its effects act, or may."""
        targets = (target for one in self.effects for target in one.named.targets if target.startswith(AT))
        return tuple(dict.fromkeys((*targets, *self.looked_at)))

    def __post_init__(self) -> None:
        if self.cell_stiffness is not None:
            object.__setattr__(self, "cell_stiffness", frozen(self.cell_stiffness, (3,), "cell_stiffness"))
            if np.any(self.cell_stiffness <= 0):
                raise ValueError("`cell_stiffness` must be positive")

    def knowing(self, learnt: Learnt) -> "Model":
        """The same of a laboratory that has `learnt` this of itself."""
        spread = {row.name: learnt.spreads[row.key].deviation for row in ANEW if row.key in learnt.spreads}
        return replace(self, learnt=learnt, mounting=replace(self.mounting, **spread))


# Do two channel tables say the same of one hardware? Positions count as seen from F: a frame is everyone's own.


SAME = 1e-6
"""[m], and of unit vectors: what two files may differ by that mean the same place."""

MOUNTED = "article"
"""The group that goes with what is tested, and not with the hardware."""

SAYS = {"quantity": "measures", "group": "belongs to the group", "senses_gravity": "senses gravity:"}


def difference(one: Campaign, other: Campaign) -> str:
    """The first thing in which the channel tables of two campaigns differ, in words; empty where there is none."""
    mine, its = _channels(one), _channels(other)
    each_axis = bool(one.cross_motion and other.cross_motion)  # of single-axis shakers, whose pilot stands where it is driven
    for known, told, of, to in ((mine, its, one, other), (its, mine, other, one)):
        fixed = (name for name, channel in known.items() if not (each_axis and channel.quantity == "acceleration"))
        if missing := next((name for name in fixed if name not in told), ""):
            return f"{missing} is a channel of {of.source} and not of {to.source}"
    mine = {name: channel for name, channel in mine.items() if name in its}
    for name, a in mine.items():
        b = its[name]
        for key, says in SAYS.items():
            if getattr(a, key) != getattr(b, key):
                return f"{name} {says} {getattr(a, key)} in {one.source} and {getattr(b, key)} in {other.source}"
        if len(a.places) != len(b.places):
            return f"{name} adds up {len(a.places)} places in {one.source} and {len(b.places)} in {other.source}"
        for first, second in zip(a.places, b.places, strict=True):
            if _apart(first.direction, second.direction):
                ways = _vector(first.direction), _vector(second.direction)
                return f"{name} points along {ways[0]} in {one.source} and along {ways[1]} in {other.source}"
    places = [
        (name, x.position - one.table.origin, y.position - other.table.origin)
        for name, channel in mine.items()
        for x, y in zip(channel.places, its[name].places, strict=True)
    ]
    moved = [place for place in places if _apart(*place[1:])]
    if not moved:
        return ""
    name, here, there = moved[0]
    if len(moved) == len(places) and not any(_apart(y - x, there - here) for _, x, y in moved):
        shift = _vector(there - here)
        return f"every channel lies {shift} m farther from F than in {one.source}: one `frame.origin` is not that of F"
    return f"{name} lies at {_vector(here)} m from F in {one.source} and at {_vector(there)} m in {other.source}"


def _channels(campaign: Campaign) -> dict[str, Channel]:
    return {channel.name: channel for channel in campaign.table.channels if channel.group != MOUNTED}


def _apart(a: Array, b: Array) -> bool:
    return bool(np.abs(a - b).max() > SAME)


def _vector(values: Array) -> str:
    return "(" + ", ".join(f"{value:.6g}" for value in np.round(values, 9) + 0.0) + ")"


# Do a model and campaigns belong together? Article, hardware, gravity, channels and the effects' targets, each by its name.


GRAVITY = 0.05
"""[m/s²]: from the equator to the poles it varies by this much."""

OF_CHANNELS = (CHANNEL, FORCE, ACCELEROMETER)


def require_pair(model: Model, campaigns: Sequence[Campaign]) -> None:
    """Refuse a `model` and `campaigns` that do not belong together.

    Raises
    ------
    BadInput : an article of which the model knows nothing; none of which the model speaks; other hardware, gravity or channels;
        an effect that acts on a channel, a place or a part that none of the campaigns has.
    """
    if not campaigns:
        raise BadInput(model.source, "", "there is no campaign to hold it against", "Name at least one campaign folder")
    for campaign in campaigns:
        file = str(Path(campaign.source) / NAME)
        if not (_own(model, campaign) or set(campaign.article.split("+")) <= set(NAMES)):
            near = nearest(campaign.article, (*model.own, model.article))
            problem = f"is {campaign.article}, which is not built in, and {model.source} has no model of it"
            remedy = f"{near}Name its file in [structure.own] of {model.source}, or correct the article"
            raise BadInput(file, "campaign.article", problem, remedy)
        hardware, first = campaign.hardware, campaigns[0]
        if model.hardware and hardware and hardware != model.hardware:
            problem = f"is {hardware}, and {model.source} describes {model.hardware}: another FMD, other sensors"
            raise BadInput(file, "campaign.hardware", problem, "Use the model of this hardware, or correct `laboratory.hardware`")
        if hardware and first.hardware and hardware != first.hardware:
            problem = f"is {hardware}, and that of {first.source} is {first.hardware}: one model describes one hardware"
            raise BadInput(file, "campaign.hardware", problem, "Compare them one after the other")
        if abs(campaign.gravity - model.gravity) > GRAVITY:
            problem = f"is {campaign.gravity:g} m/s^2, and `laboratory.gravity_m_s2` of {model.source} is {model.gravity:g}"
            raise BadInput(file, "environment.gravity", problem, "Correct the one that is wrong; 0 is a test without gravity")
    wanted = _families(model.article)
    if wanted and not any(_families(campaign.article) & wanted for campaign in campaigns):
        articles = ", ".join(f"{campaign.article} ({campaign.source})" for campaign in campaigns)
        problem = f"is {model.article}, of which no campaign has a part: {articles}"
        raise BadInput(model.source, "model.article", problem, "Name the campaign of this article, or the model of these")
    # Each campaign with the first that has its hardware
    of_hardware: dict[str, Campaign] = {}
    for campaign in campaigns:
        problem = difference(of_hardware.setdefault(campaign.hardware, campaign), campaign)
        if problem:
            what = f"hardware {campaign.hardware}" if campaign.hardware else "hardware, as none is stated"
            problem = f"{problem}; both have the same {what}"
            remedy = (
                "Correct the table that is wrong, or give what was changed between the tests a `campaign.hardware` of its own"
            )
            raise BadInput(str(Path(campaign.source) / NAME), "channel", problem, remedy)
    for added in model.effects:
        require_target(model, campaigns, added.named, model.source)


def require_target(model: Model, campaigns: Sequence[Campaign], named: Named, source: str) -> None:
    """Refuse an effect that acts on nothing that the `campaigns` have; `source` is where it was named.

    Raises
    ------
    BadInput : its channel, place or part is in none of them, with the nearest.
    """
    if on_article(named) and not any(above_fmd(campaign.article) for campaign in campaigns):
        problem = f"nothing stands on the cover plate: {_articles(campaigns)}"
        raise BadInput(source, f"effect {named.id}", problem, "Name the campaign of an article")
    words = vocabulary(model, campaigns)
    for kind, target in zip(FAMILIES[named.family].targets, named.targets, strict=False):
        legal = words.parts if of_parts(named) else words.legal(kind) if kind in (*OF_CHANNELS, PLACE) else None
        if legal is None or target in legal:
            continue
        near = f"{nearest(target, legal)}Known are {', '.join(legal)}" if legal else "Leave the effect out"
        if of_parts(named) and model.kind == RIGID:
            problem, near = "acts on a part, and the parts of a rigid model do not give", 'Choose kind = "beam" in [structure]'
        elif kind in OF_CHANNELS:
            other = ", where one of another kind is" if any(target in campaign.table.names for campaign in campaigns) else ""
            problem = f"no campaign has the {kind} {target!r}{other}: {', '.join(campaign.source for campaign in campaigns)}"
        else:
            problem = f"no article here has the {PART if of_parts(named) else kind} {target!r}: {_articles(campaigns)}"
            near = f"{near}, or add the campaign of the article that has it"
        raise BadInput(source, f"effect {named.id}", problem, near)


def vocabulary(model: Model, campaigns: Sequence[Campaign]) -> Vocabulary:
    """The channels of `campaigns`, and the places and parts of their articles as `model` describes them."""
    from geometry.articles import changes_of, locations
    from geometry.articles.parts import FOUR_BLADES, ONE_BLADE

    own = any(_own(model, campaign) for campaign in campaigns)
    places: tuple[str, ...] | None = None
    if not own:
        stacks = [above for campaign in campaigns if (above := above_fmd(campaign.article))]
        every = (place for stack in stacks for place in locations(stack, changes_of(stack, model.changes)))
        places = tuple(dict.fromkeys(every))
    parts: tuple[str, ...] | None = None
    if model.kind == RIGID:
        parts = ()
    elif not own:
        known = {"clumod-1": ("mast", *ONE_BLADE), "clumod-4": ("mast", *FOUR_BLADES)}
        names = (name for campaign in campaigns for name in campaign.article.split("+"))
        parts = tuple(dict.fromkeys(part for name in names for part in known.get(name, ())))
    return Vocabulary(
        accelerometers=_channels_of_both(campaigns, ("acceleration",)),
        forces=_channels_of_both(campaigns, ("force", "moment")),
        places=places,
        parts=parts,
        ways=AXES if own else ABREAST,
    )


def _channels_of_both(campaigns: Sequence[Campaign], quantities: tuple[str, ...]) -> tuple[str, ...]:
    tables = [campaign.table for campaign in campaigns]
    return tuple(dict.fromkeys(table.names[k] for table in tables for k in table.select(quantity=quantities)))


def _articles(campaigns: Sequence[Campaign]) -> str:
    return ", ".join(dict.fromkeys(campaign.article for campaign in campaigns))


def _own(model: Model, campaign: Campaign) -> bool:
    """Whether `model` names a file for what stands in `campaign`, by the whole stack or by what is on the FMD, or that is one."""
    from fem.user_model.reading import is_model

    above = above_fmd(campaign.article)
    return campaign.article in model.own or above in model.own or (bool(above) and is_model(above))


def _families(article: str) -> set[str]:
    """The parts above the FMD; Clumod with any blades is one."""
    return {part.split("-")[0] if part in NAMES else part for part in above_fmd(article).split("+") if part}
