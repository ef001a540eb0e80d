"""Do a model and campaigns belong together? Article, hardware, gravity, channels and the effects' targets, each by its name."""

from __future__ import annotations

from collections.abc import Sequence
from pathlib import Path

from geometry.articles import NAMES
from geometry.errors import BadInput
from geometry.keys import nearest
from identification.campaign import Campaign
from identification.campaign_file import NAME
from validation.effects.catalogue import FAMILIES
from validation.effects.identifiers import Named
from validation.effects.reach import of_parts, on_article
from validation.effects.targets import ACCELEROMETER, CHANNEL, FORCE, PART, PLACE, Vocabulary
from validation.identifying.known import above_fmd
from validation.models import same_channels
from validation.models.model import RIGID, Model

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
        problem = "there is no campaign to hold it against"
        raise BadInput(source=model.source, problem=problem, remedy="Name at least one campaign folder")
    for campaign in campaigns:
        _require_known(model, campaign)
        _require_same_hardware(model, campaign, campaigns[0])
        _require_same_gravity(model, campaign)
    _require_common_part(model, campaigns)
    for one, other in _of_one_hardware(campaigns):
        _require_same_channels(one, other)
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
        raise BadInput(source=source, field=f"effect {named.id}", problem=problem, remedy="Name the campaign of an article")
    words = vocabulary(model, campaigns)
    for kind, target in zip(FAMILIES[named.family].targets, named.targets, strict=False):
        legal = words.parts if of_parts(named) else words.legal(kind) if kind in (*OF_CHANNELS, PLACE) else None
        if legal is not None and target not in legal:
            raise _nowhere(model, campaigns, named, kind, legal, source)


def vocabulary(model: Model, campaigns: Sequence[Campaign]) -> Vocabulary:
    """The channels of `campaigns`, and the places and parts of their articles as `model` describes them."""
    own = any(_own(model, campaign) for campaign in campaigns)
    return Vocabulary(
        accelerometers=_channels(campaigns, ("acceleration",)),
        forces=_channels(campaigns, ("force", "moment")),
        places=None if own else _places(model, campaigns),
        parts=None if own and model.kind != RIGID else _parts(model, campaigns),
    )


def _channels(campaigns: Sequence[Campaign], quantities: tuple[str, ...]) -> tuple[str, ...]:
    tables = [campaign.table for campaign in campaigns]
    return tuple(dict.fromkeys(table.names[k] for table in tables for k in table.select(quantity=quantities)))


def _places(model: Model, campaigns: Sequence[Campaign]) -> tuple[str, ...]:
    from geometry.articles import changes_of
    from geometry.articles.locations import locations

    stacks = [above for campaign in campaigns if (above := above_fmd(campaign.article))]
    return tuple(dict.fromkeys(place for stack in stacks for place in locations(stack, changes_of(stack, model.changes))))


def _parts(model: Model, campaigns: Sequence[Campaign]) -> tuple[str, ...]:
    from geometry.articles.clumod import FOUR_BLADES, ONE_BLADE

    if model.kind == RIGID:
        return ()
    known = {"clumod-1": ("mast", *ONE_BLADE), "clumod-4": ("mast", *FOUR_BLADES)}
    return tuple(dict.fromkeys(part for c in campaigns for name in c.article.split("+") for part in known.get(name, ())))


def _nowhere(
    model: Model, campaigns: Sequence[Campaign], named: Named, kind: str, legal: tuple[str, ...], source: str
) -> BadInput:
    """The refusal of `named`, which acts on a `kind` of which only the `legal` ones are there."""
    target = next(one for one in named.targets if one not in legal)
    near = f"{nearest(target, legal)}Known are {', '.join(legal)}" if legal else "Leave the effect out"
    if of_parts(named) and model.kind == RIGID:
        problem, near = "acts on a part, and the parts of a rigid model do not give", 'Choose kind = "beam" in [structure]'
    elif kind in OF_CHANNELS:
        other = ", where one of another kind is" if any(target in campaign.table.names for campaign in campaigns) else ""
        problem = f"no campaign has the {kind} {target!r}{other}: {', '.join(campaign.source for campaign in campaigns)}"
    else:
        problem = f"no article here has the {PART if of_parts(named) else kind} {target!r}: {_articles(campaigns)}"
        near = f"{near}, or add the campaign of the article that has it"
    return BadInput(source=source, field=f"effect {named.id}", problem=problem, remedy=near)


def _articles(campaigns: Sequence[Campaign]) -> str:
    return ", ".join(dict.fromkeys(campaign.article for campaign in campaigns))


def _own(model: Model, campaign: Campaign) -> bool:
    """Whether `model` names a file for what stands in `campaign`, by the whole stack or by what is on the FMD, or that is one."""
    from fem.users_model.reading import is_model

    above = above_fmd(campaign.article)
    return campaign.article in model.own or above in model.own or (bool(above) and is_model(above))


def _require_known(model: Model, campaign: Campaign) -> None:
    if _own(model, campaign) or set(campaign.article.split("+")) <= set(NAMES):
        return
    near = nearest(campaign.article, (*model.own, model.article))
    raise BadInput(
        source=str(Path(campaign.source) / NAME),
        field="campaign.article",
        problem=f"is {campaign.article}, which is not built in, and {model.source} has no model of it",
        remedy=f"{near}Name its file in [structure.own] of {model.source}, or correct the article",
    )


def _require_common_part(model: Model, campaigns: Sequence[Campaign]) -> None:
    wanted = _families(model.article)
    if not wanted or any(_families(campaign.article) & wanted for campaign in campaigns):
        return
    articles = ", ".join(f"{campaign.article} ({campaign.source})" for campaign in campaigns)
    raise BadInput(
        source=model.source,
        field="model.article",
        problem=f"is {model.article}, of which no campaign has a part: {articles}",
        remedy="Name the campaign of this article, or the model of these",
    )


def _families(article: str) -> set[str]:
    """The parts above the FMD; Clumod with any blades is one."""
    return {part.split("-")[0] if part in NAMES else part for part in above_fmd(article).split("+") if part}


def _require_same_hardware(model: Model, campaign: Campaign, first: Campaign) -> None:
    source = str(Path(campaign.source) / NAME)
    if model.hardware and campaign.hardware and campaign.hardware != model.hardware:
        problem = f"is {campaign.hardware}, and {model.source} describes {model.hardware}: another FMD, other sensors"
        remedy = "Use the model of this hardware, or correct `laboratory.hardware`"
        raise BadInput(source=source, field="campaign.hardware", problem=problem, remedy=remedy)
    if campaign.hardware and first.hardware and campaign.hardware != first.hardware:
        problem = f"is {campaign.hardware}, and that of {first.source} is {first.hardware}: one model describes one hardware"
        raise BadInput(source=source, field="campaign.hardware", problem=problem, remedy="Compare them one after the other")


def _require_same_gravity(model: Model, campaign: Campaign) -> None:
    if abs(campaign.gravity - model.gravity) <= GRAVITY:
        return
    raise BadInput(
        source=str(Path(campaign.source) / NAME),
        field="environment.gravity",
        problem=f"is {campaign.gravity:g} m/s^2, and `laboratory.gravity_m_s2` of {model.source} is {model.gravity:g}",
        remedy="Correct the one that is wrong; 0 is a test without gravity",
    )


def _of_one_hardware(campaigns: Sequence[Campaign]) -> list[tuple[Campaign, Campaign]]:
    """Each campaign with the first that has its hardware."""
    first: dict[str, Campaign] = {}
    return [(first.setdefault(campaign.hardware, campaign), campaign) for campaign in campaigns]


def _require_same_channels(one: Campaign, other: Campaign) -> None:
    """Refuse two campaigns of one hardware whose channel tables, seen from F, say different things of it."""
    problem = same_channels.difference(one, other)
    if not problem:
        return
    what = f"hardware {other.hardware}" if other.hardware else "hardware, as none is stated"
    raise BadInput(
        source=str(Path(other.source) / NAME),
        field="channel",
        problem=f"{problem}; both have the same {what}",
        remedy="Correct the table that is wrong, or give what was changed between the tests a `campaign.hardware` of its own",
    )
