"""Which articles of a series an effect reaches; the rule is that of `validation.effects.reach`."""

from __future__ import annotations

from collections.abc import Sequence

from geometry.articles import changes_of
from geometry.articles.locations import locations
from geometry.errors import BadInput
from geometry.keys import nearest
from validation.effects import reach
from validation.effects.catalogue import FAMILIES
from validation.effects.identifiers import Named
from validation.effects.reach import There
from validation.virtual_test.hooks import Effect
from validation.virtual_test.plan import RIGID, SOURCE, Plan
from validation.virtual_test.set_up import parts_of


def reaching(effects: Sequence[Named], plan: Plan) -> tuple[Named, ...]:
    """Those of `effects` that act in `plan`."""
    there = _there(plan)
    return tuple(named for named in effects if reach.acts(named, there))


def require_reaching(effects: Sequence[Named], plans: Sequence[Plan], *, source: str = "--effect") -> None:
    """Refuse an effect that acts in none of `plans`.

    Parameters
    ----------
    source : where the effects stand, for messages

    Raises
    ------
    BadInput : such an effect, with what it could act on; damping of a part where that of every mode is stated.
    """
    for named in effects:
        if not any(reach.acts(named, _there(plan)) for plan in plans):
            raise _nowhere(named, plans, source)
        if reach.of_parts(named) and any(plan.damping is not None for plan in plans) and "damping" in named.family:
            problem = "--damping (`Plan.damping`) states the damping of every mode, whatever the parts do"
            raise BadInput(source=source, field=named.id, problem=problem, remedy="Leave one of them out")


def require_planted(plan: Plan) -> None:
    """Refuse a plan with an effect of the catalogue that cannot act in it; effects of other names are their maker's own affair.

    Raises
    ------
    BadInput : see `require_reaching`.
    """
    require_reaching([one for effect in plan.effects for one in _named(effect)], [plan], source=SOURCE)


def _named(effect: Effect) -> tuple[Named, ...]:
    family, *targets = effect.id.split(":")
    return (Named(family=family, targets=tuple(targets), values=effect.value),) if family in FAMILIES else ()


def _there(plan: Plan) -> There:
    places = tuple(locations(plan.on_fmd, changes_of(plan.on_fmd, plan.dimensions))) if plan.on_fmd else ()
    return There(article=plan.on_fmd, parts=parts_of(plan), places=places)


def _nowhere(named: Named, plans: Sequence[Plan], source: str) -> BadInput:
    what = ", ".join(plan.article for plan in plans)
    local, parts = reach.is_local(named), reach.of_parts(named)
    known = tuple(dict.fromkeys(name for plan in plans for name in reach.known(named, _there(plan)))) if local else ()
    kind = "part" if parts else "place"
    problem = f"{what} has no {kind} {named.target!r}" if local else f"nothing stands on the cover plate of {what}"
    if parts and any(plan.model == RIGID for plan in plans):
        problem = "the parts of a rigid article do not give"
    remedy = f"{nearest(named.target, known)}Known are {', '.join(known)}" if known else "Leave it out, or name another article"
    return BadInput(source=source, field=named.id, problem=problem, remedy=remedy)
