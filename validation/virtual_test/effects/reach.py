"""Which articles of a series an effect reaches: a structural one acts wherever its part or its place exists, and nowhere else."""

from __future__ import annotations

from collections.abc import Sequence

from geometry.articles import changes_of
from geometry.articles.locations import locations
from geometry.errors import BadInput
from geometry.keys import nearest
from validation.effects.catalogue import FAMILIES
from validation.effects.family import STRUCTURE
from validation.effects.identifiers import Named
from validation.effects.targets import PLACE
from validation.virtual_test.plan import RIGID, Plan
from validation.virtual_test.set_up import parts_of

OF_PARTS = ("part", "part with a layer")


def reaching(effects: Sequence[Named], plan: Plan) -> tuple[Named, ...]:
    """Those of `effects` that act in `plan`."""
    return tuple(named for named in effects if _reaches(named, plan))


def require_reaching(effects: Sequence[Named], plans: Sequence[Plan]) -> None:
    """Refuse an effect that acts in none of `plans`.

    Raises
    ------
    BadInput : such an effect, with what it could act on.
    """
    for named in effects:
        if not any(_reaches(named, plan) for plan in plans):
            raise _nowhere(named, plans)
        if _of_parts(named) and any(plan.damping is not None for plan in plans) and "damping" in named.family:
            problem = "--damping states the damping of every mode, whatever the parts do"
            raise BadInput(source="--effect", field=named.id, problem=problem, remedy="Leave one of them out")


def _reaches(named: Named, plan: Plan) -> bool:
    return named.target in _known(named, plan) if _is_local(named) else not _on_article(named) or bool(plan.on_fmd)


def _is_local(named: Named) -> bool:
    return _of_parts(named) or FAMILIES[named.family].targets[:1] == (PLACE,)


def _of_parts(named: Named) -> bool:
    return FAMILIES[named.family].targets[:1] in {(kind,) for kind in OF_PARTS}


def _on_article(named: Named) -> bool:
    return (FAMILIES[named.family].side == STRUCTURE and named.family != "gravity") or named.family == "friction"


def _known(named: Named, plan: Plan) -> tuple[str, ...]:
    if _of_parts(named):
        return parts_of(plan)
    return tuple(locations(plan.on_fmd, changes_of(plan.on_fmd, plan.dimensions))) if plan.on_fmd else ()


def _nowhere(named: Named, plans: Sequence[Plan]) -> BadInput:
    what = ", ".join(plan.article for plan in plans)
    known = tuple(dict.fromkeys(name for plan in plans for name in _known(named, plan))) if _is_local(named) else ()
    kind = "part" if _of_parts(named) else "place"
    problem = f"{what} has no {kind} {named.target!r}" if _is_local(named) else f"nothing stands on the cover plate of {what}"
    if _of_parts(named) and any(plan.model == RIGID for plan in plans):
        problem = "the parts of a rigid article do not give"
    remedy = f"{nearest(named.target, known)}Known are {', '.join(known)}" if known else "Leave it out, or name another article"
    return BadInput(source="--effect", field=named.id, problem=problem, remedy=remedy)
