"""`Standing`: what stands on the cover plate in one campaign, as a model describes it, before any effect.

The campaign's `article` picks it: nothing for an FMD alone, a built-in stack of beams or rigid, or a user's own model. Where it
is mounted is what the campaign states, else the seat of the built-in FMD.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import MappingProxyType

import numpy as np

from fem.damping import Damping, default, per_mode
from fem.modes import fixed_base
from fem.structure import Structure
from fem.users_model.reading import is_model
from geometry import multibody
from geometry.arrays import Array
from geometry.article import Article
from geometry.articles import NAMES, built_in, changes_of
from geometry.articles.locations import locations
from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.inertia import Inertia
from identification.campaign import Campaign
from validation.effects.reach import There
from validation.effects.stages import Matrices
from validation.identifying.known import FMD, above_fmd, mounted
from validation.models.model import RIGID, Model
from validation.prediction import matrices as of
from validation.prediction import own_article


@dataclass(frozen=True, eq=False, kw_only=True)
class Standing:
    """What stands on the cover plate.

    Attributes
    ----------
    article : its name; empty for an FMD alone
    matrices : about its own origin and in its own axes; None where there is nothing
    frequency : (m,) [Hz] of the coordinates behind the base that are modes; the others answer statically
    losses : loss factor by part of the structure; none where damping is given by mode
    pose : where its frame sits, seen from F
    remarks : what was assumed, sentences
    """

    article: str
    matrices: Matrices | None
    frequency: Array = field(default_factory=lambda: np.zeros(0))
    losses: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    pose: Pose
    remarks: tuple[str, ...] = ()

    @property
    def modes(self) -> int:
        """How many of its coordinates are modes."""
        return len(self.frequency)

    @property
    def there(self) -> There:
        """What effects can act on."""
        if self.matrices is None:
            return There()
        return There(article=self.article, parts=tuple(self.matrices.parts), places=tuple(self.matrices.places))


def standing(model: Model, campaign: Campaign) -> Standing:
    """What stands on the cover plate of `campaign`.

    Raises
    ------
    BadInput : an article that `model` cannot describe, or a model of the user's own that cannot be used.
    CheckFailed : as `fem.modes.fixed_base`.
    """
    article = above_fmd(campaign.article)
    if not article:
        return Standing(article="", matrices=None, pose=Pose())
    pose, said = mounted(campaign)
    return replace(_made(_recipe(model, campaign, article)), pose=pose, remarks=said)


def moving_part(model: Model) -> Inertia:
    """The FMD's moving part about F as `model` knows it beforehand: as it states, else as drawn.

    Raises
    ------
    BadInput : dimensions that make no FMD.
    """
    if model.fmd is not None:
        return model.fmd.about(np.zeros(3))
    return multibody.inertia(built_in(FMD, changes_of(FMD, model.changes)))


def drawn_inertia(model: Model, article: str) -> Inertia:
    """The `article` above the FMD about its own origin, as drawn or as a user's own model has it.

    Raises
    ------
    BadInput : as `standing`.
    """
    own = _own(model, article, f"{FMD}+{article}")
    return _inertia(
        _Recipe(article=article, kind=model.kind, own=own, stamp=own_article.stamp(own), changes=_changes(model, article))
    )


@dataclass(frozen=True, kw_only=True)
class _Recipe:
    """Everything that decides the matrices of an article; `stamp` tells a user's file from the same one rewritten."""

    article: str
    kind: str
    own: str = ""
    stamp: int = 0
    modes: int = 30
    damping_ratio: float | None = None
    changes: tuple[tuple[str, float], ...] = ()


def _recipe(model: Model, campaign: Campaign, article: str) -> _Recipe:
    own = _own(model, article, campaign.article)
    if not own and not set(article.split("+")) <= set(NAMES):
        raise BadInput(
            source=model.source,
            field="own",
            problem=f"it has no model of {article}, which stands on the FMD in {campaign.source}",
            remedy=f"State the path of one, or name a stack of {', '.join(NAMES)} in the campaign",
        )
    return _Recipe(
        article=article,
        kind=model.kind,
        own=own,
        stamp=own_article.stamp(own),
        modes=model.modes,
        damping_ratio=model.damping_ratio,
        changes=() if own else _changes(model, article),
    )


def _own(model: Model, article: str, whole: str) -> str:
    """Path of the user's own model of `article`; empty where a built-in one is meant."""
    stated = model.own.get(article, model.own.get(whole, ""))
    return stated or (article if is_model(article) else "")


def _changes(model: Model, article: str) -> tuple[tuple[str, float], ...]:
    return tuple(sorted(changes_of(article, model.changes).items())) if set(article.split("+")) <= set(NAMES) else ()


@lru_cache(maxsize=16)
def _made(recipe: _Recipe) -> Standing:
    """An article, not yet mounted."""
    if recipe.own:
        return _of_user(recipe)
    changes = dict(recipe.changes)
    places = locations(recipe.article, changes)
    if recipe.kind == RIGID:
        return Standing(article=recipe.article, matrices=of.of_inertia(_inertia(recipe), places), pose=Pose())
    from fem import beam

    drawn = built_in(recipe.article, changes)
    return _of_structure(recipe, beam.structure(recipe.article, changes), _damping(recipe), places, drawn)


def _of_user(recipe: _Recipe) -> Standing:
    """A user's own model: matrices with their modes, a solid model of a drawing, or modal data alone."""
    if recipe.kind == RIGID:
        return Standing(article=recipe.article, matrices=of.of_inertia(_inertia(recipe), {}), pose=Pose())
    found = own_article.users_model(recipe.own, recipe.stamp)
    damping = _damping(recipe) or found.damping
    if isinstance(found.model, Structure):
        return _of_structure(recipe, found.model, damping, {}, None)
    frequency = found.model.frequency
    modal = found.model if damping is None else replace(found.model, viscous=per_mode(damping, 2 * np.pi * frequency))
    matrices = of.of_modes(modal, _inertia(recipe).cog)
    return Standing(article=recipe.article, matrices=matrices, frequency=frequency, pose=Pose())


def _of_structure(
    recipe: _Recipe, structure: Structure, damping: Damping | None, places: of.Places, drawn: Article | None
) -> Standing:
    used = damping or default(structure)
    modes = fixed_base(structure, recipe.modes, damping=used)
    return Standing(
        article=recipe.article,
        matrices=of.of_structure(structure, modes, places, _inertia(recipe).cog, damping=used, article=drawn),
        frequency=modes.frequency,
        losses=used.loss_factors,
        pose=Pose(),
    )


def _inertia(recipe: _Recipe) -> Inertia:
    if not recipe.own:
        return multibody.inertia(built_in(recipe.article, dict(recipe.changes)))
    return own_article.inertia(recipe.own, recipe.stamp)


def _damping(recipe: _Recipe) -> Damping | None:
    return None if recipe.damping_ratio is None else Damping(ratio=recipe.damping_ratio)
