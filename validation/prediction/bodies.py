"""Is what stands on the cover plate still a body once the effects of a model act? Asked before anything is fitted.

Masses that are added or taken away change the ten parameters of the whole article, which no body may have if its mass is not
positive or a principal moment exceeds the sum of the others. That is said of the sizes as the model states them: a fit may not
begin there, and an effect that is fixed stays there. What is taken away at one place alone is not held against what moves there:
a reduced model lumps mass at no place, and a forgotten clamp is as well taken off a beam as put on it.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace

from geometry.consistency import judge
from geometry.errors import BadInput
from geometry.inertia import Inertia
from identification.campaign import Campaign
from validation.effects.reach import acts
from validation.effects.stages import Matrices
from validation.models.model import Added, Model
from validation.prediction import applied
from validation.prediction.inertia import WEIGHED
from validation.prediction.set_up import Standing, standing

ROUNDING = 1e-9
"""Of the largest entry of a tensor: what a reduced model of a rod or a point mass loses."""

BASE = 6


def require_bodies(model: Model, campaigns: Sequence[Campaign]) -> None:
    """Refuse masses and inertias by which what stands on the FMD in one of `campaigns` is no body.

    Raises
    ------
    BadInput : such effects, with the inertia that results; whatever `validation.prediction.set_up.standing` refuses.
    """
    if not any(one.named.family in WEIGHED for one in model.effects):
        return
    for article, campaign in {one.article: one for one in campaigns}.items():
        _require_body(model, article, standing(model, campaign))


def _require_body(model: Model, article: str, of: Standing) -> None:
    effects = tuple(_stated(one) for one in model.effects if one.named.family in WEIGHED and acts(one.named, of.there))
    if of.matrices is None or not effects:
        return
    problem = _problem(of.matrices, effects)
    if problem and not _problem(of.matrices, ()):  # what was no body before is not the fault of effects
        raise BadInput(
            source=model.source,
            field=f"effect {', '.join(one.named.id for one in effects)}",
            problem=f"with {', '.join(str(one.named) for one in effects)} no body is left of {article}: {problem}",
            remedy="Check sign and unit of the size; a mass is added to the drawing, and a negative one taken away from it",
        )


def _stated(added: Added) -> Added:
    """`added` at its size as it stands, which nothing moves."""
    return replace(added, fixed=True)


def _problem(drawn: Matrices, effects: Sequence[Added]) -> str:
    """Why there is no such body; empty where there is one."""
    mass = applied.structure(drawn, {}, effects, derivatives=False)[0].mass
    verdict = judge(Inertia.from_mass_matrix(mass[:BASE, :BASE]), ROUNDING)
    return "" if verdict.physical else verdict.text
