"""Which articles of a series an effect reaches; the rule is that of `validation.effects.reach`."""

from __future__ import annotations

from collections.abc import Sequence

from geometry.articles import changes_of
from geometry.articles.locations import locations
from geometry.errors import BadInput
from geometry.keys import nearest
from validation.effects import reach
from validation.effects.identifiers import Named
from validation.effects.reach import There
from validation.virtual_test.plan import RIGID, Plan
from validation.virtual_test.set_up import parts_of


def reaching(effects: Sequence[Named], plan: Plan) -> tuple[Named, ...]:
    """Those of `effects` that act in `plan`."""
    there = _there(plan)
    return tuple(named for named in effects if reach.acts(named, there))


def require_reaching(effects: Sequence[Named], plans: Sequence[Plan]) -> None:
    """Refuse an effect that acts in none of `plans`.

    Raises
    ------
    BadInput : such an effect, with what it could act on.
    """
    for named in effects:
        if not any(reach.acts(named, _there(plan)) for plan in plans):
            raise _nowhere(named, plans)
        if reach.of_parts(named) and any(plan.damping is not None for plan in plans) and "damping" in named.family:
            problem = "--damping states the damping of every mode, whatever the parts do"
            raise BadInput(source="--effect", field=named.id, problem=problem, remedy="Leave one of them out")


def _there(plan: Plan) -> There:
    places = tuple(locations(plan.on_fmd, changes_of(plan.on_fmd, plan.dimensions))) if plan.on_fmd else ()
    return There(article=plan.on_fmd, parts=parts_of(plan), places=places)


def _nowhere(named: Named, plans: Sequence[Plan]) -> BadInput:
    what = ", ".join(plan.article for plan in plans)
    local, parts = reach.is_local(named), reach.of_parts(named)
    known = tuple(dict.fromkeys(name for plan in plans for name in reach.known(named, _there(plan)))) if local else ()
    kind = "part" if parts else "place"
    problem = f"{what} has no {kind} {named.target!r}" if local else f"nothing stands on the cover plate of {what}"
    if parts and any(plan.model == RIGID for plan in plans):
        problem = "the parts of a rigid article do not give"
    remedy = f"{nearest(named.target, known)}Known are {', '.join(known)}" if known else "Leave it out, or name another article"
    return BadInput(source="--effect", field=named.id, problem=problem, remedy=remedy)
