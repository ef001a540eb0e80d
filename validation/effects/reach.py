"""Where an effect acts: a structural one wherever its part or its place exists, and nowhere else.

Virtual tests and predictions ask the same rule, so that what a model leaves out is what nobody planted.
"""

from __future__ import annotations

from dataclasses import dataclass

from validation.effects.catalogue import FAMILIES
from validation.effects.family import STRUCTURE
from validation.effects.identifiers import Named
from validation.effects.targets import ACCELEROMETER, CHANNEL, FORCE, PLACE

OF_PARTS = ("part", "part with a layer")


@dataclass(frozen=True, kw_only=True)
class There:
    """What one set-up has.

    Attributes
    ----------
    article : what stands on the cover plate; empty for an FMD alone
    parts : of its structure; none of a rigid one
    places : by name, on it
    channels : that were recorded; None where all that an effect can name are
    """

    article: str = ""
    parts: tuple[str, ...] = ()
    places: tuple[str, ...] = ()
    channels: tuple[str, ...] | None = None


def acts(named: Named, there: There) -> bool:
    """Whether the effect `named` has something to act on; one whose place may be left out, and is, acts on all."""
    if is_local(named):
        return named.target in known(named, there) if named.targets else bool(known(named, there))
    return _is_recorded(named, there) and (not on_article(named) or bool(there.article))


def known(named: Named, there: There) -> tuple[str, ...]:
    """What `named` could act on, of a family that acts on a part or a place."""
    return there.parts if of_parts(named) else there.places


def is_local(named: Named) -> bool:
    """Whether it acts on a part or a place."""
    return of_parts(named) or FAMILIES[named.family].targets[:1] == (PLACE,)


def of_parts(named: Named) -> bool:
    """Whether it acts on a part of the structure."""
    return FAMILIES[named.family].targets[:1] in {(kind,) for kind in OF_PARTS}


def on_article(named: Named) -> bool:
    """Whether it needs something that stands on the cover plate."""
    return (FAMILIES[named.family].side == STRUCTURE and named.family != "gravity") or named.family == "friction"


def _is_recorded(named: Named, there: There) -> bool:
    pairs = zip(FAMILIES[named.family].targets, named.targets, strict=False)
    asked = [target for kind, target in pairs if kind in (CHANNEL, FORCE, ACCELEROMETER)]
    return there.channels is None or all(target in there.channels for target in asked)
