"""`MountedArticle`: what stands on the cover plate in one campaign, as a model describes it, before any effect.

The campaign's `article` picks it: nothing for an FMD alone, a built-in stack of beams or rigid, or a user's own model. Where it
is mounted is what the campaign states, else the seat of the built-in FMD.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from pathlib import Path
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from fem.base_excitation import rig
from fem.damping import Damping, damping_per_mode, default_damping, is_assumed
from fem.modes import Modes, fixed_base
from fem.structure import BRING, ON_NODE, Structure, nearest_node
from fem.user_model.reading import UsersModel, is_model, load
from geometry import routes
from geometry.article import Article
from geometry.articles import NAMES, built_in, changes_of, locations
from geometry.errors import BadInput
from geometry.frames import Array, Pose, rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia
from identification.campaign import Campaign
from validation.effects.catalogue import There, there
from validation.effects.effect import at_position, position
from validation.effects.stages import Matrices
from validation.model.model import RIGID, Model
from validation.model.setups import FMD, above_fmd, mounted
from validation.prediction.structure import (
    BAND,
    BASE,
    HIGHEST,
    NOWHERE,
    Places,
    ReducedStructure,
    lacking,
    of_structure,
    on_base,
    with_positions,
)

# A user's own article behind its path: an FE model as its file has it, or a drawing, of which a solid model is made.


@lru_cache(maxsize=8)
def users_model(path: str, stamp: int) -> UsersModel:
    """The model in the file `path`, or a solid one of the article that is drawn there; `stamp` tells a file from a newer one.

    Raises
    ------
    BadInput : whatever is wrong with it; a drawing whose bodies state no material in an ``article.toml``.
    """
    if is_model(path):
        return load(path)
    from fem.solid import model
    from geometry import user_article

    drawn = user_article.load(path, unit=None, material=None)
    return UsersModel(name=drawn.name, model=model.structure(drawn))


def positions_on(model: Model, own: str) -> tuple[str, ...]:
    """The positions of `model` for its `own` model of an article: all but those that lie outside it and on that of another."""

    def has(path: str, place: str) -> bool:
        of = users_model(path, stamp(path)).model
        return isinstance(of, Structure) and lacking(of, place) is None

    others = {*model.own.values()} - {own} if model.kind != RIGID else set()
    return tuple(one for one in model.positions if not others or has(own, one) or not any(has(path, one) for path in others))


def inertia(path: str, stamp: int) -> Inertia:
    """Inertia about its own origin: of a drawing without meshing it for a solid model.

    Raises
    ------
    BadInput : see `users_model`.
    """
    if is_model(path):
        found = users_model(path, stamp).model
        return Inertia.from_mass_matrix(found.rigid_mass, found.reference_point).about(np.zeros(3))
    from geometry import user_article

    return next(iter(user_article.inertias(user_article.load(path, unit=None, material=None)).values())).about(np.zeros(3))


def stamp(path: str) -> int:
    """When the file `path`, or of a folder the newest file in it, was last written [ns]; 0 where there is none."""
    there = Path(path)
    files = [there] if there.is_file() else list(there.iterdir()) if path and there.is_dir() else []
    return max((one.stat().st_mtime_ns for one in files), default=0)


def of_inertia(inertia: Inertia, places: Places = NOWHERE) -> Matrices:
    """A rigid body on its moving base, about the article's origin."""
    about = inertia.about(np.zeros(3))
    nothing = np.zeros((BASE, BASE))
    return Matrices(
        base=BASE,
        mass=about.mass_matrix,
        stiffness=nothing,
        viscous=nothing,
        structural=nothing,
        places={name: rigid_transformation(at) for name, at in places.items()},
        cog=about.cog,
    )


def of_modes(modes: Modes, cog: npt.ArrayLike = (0.0, 0.0, 0.0)) -> Matrices:
    """A body of which modal data alone are known: no places and no parts; further modes carry its residual mass.

    Raises
    ------
    BadInput : modes that take more mass than there is, in some direction.
    """
    made = rig.of_modal_data("modal data", modes).reduced
    kept = slice(BASE, BASE + modes.frequency.size)
    stiffness, viscous, structural = (np.array(a) for a in (made.stiffness, made.viscous, made.structural))
    stiffness[kept, kept] = np.diag((2 * np.pi * modes.frequency) ** 2)
    viscous[kept, kept], structural[kept, kept] = modes.viscous, modes.structural
    return Matrices(
        base=BASE,
        mass=made.mass,
        stiffness=stiffness,
        viscous=viscous,
        structural=structural,
        cog=np.asarray(cog, dtype=np.float64),
    )


@dataclass(frozen=True, eq=False, kw_only=True)
class MountedArticle:
    """What stands on the cover plate.

    Attributes
    ----------
    article : its name; empty for an FMD alone
    matrices : about its own origin and in its own axes; None where there is nothing
    reduced : of which they are, where its mesh or its matrices are a user's own
    frequency : (m,) [Hz] of the coordinates behind the base that are modes; the others answer statically
    losses : loss factor by part of the structure; none where damping is given by mode
    assumed : whether nobody stated what it loses
    highest : [Hz] up to which its modes are uncertain
    part_tolerances : as in `fem.structure.Structure`
    pose : where its frame sits, seen from F
    sensors : by name of an accelerometer on it, the place of `matrices` that it reads
    unread : names of those of which nobody knows what moves there
    remarks : what was assumed, sentences
    """

    article: str
    matrices: Matrices | None
    reduced: ReducedStructure | None = None
    frequency: Array = field(default_factory=lambda: np.zeros(0))
    losses: Mapping[str, float] = field(default_factory=lambda: MappingProxyType({}))
    assumed: bool = False
    highest: float = HIGHEST
    part_tolerances: Mapping[str, Mapping[str, float]] = field(default_factory=lambda: MappingProxyType({}))
    pose: Pose
    sensors: Mapping[str, str] = field(default_factory=lambda: MappingProxyType({}))
    unread: tuple[str, ...] = ()
    remarks: tuple[str, ...] = ()

    @property
    def modes(self) -> int:
        """How many of its coordinates are modes."""
        return len(self.frequency)

    @property
    def rigid(self) -> Array:
        """(6, 6) mass about F, as drawn."""
        T = np.kron(np.eye(2), self.pose.rotation.T) @ rigid_transformation_6(self.pose.position)
        return np.zeros((6, 6)) if self.matrices is None else np.asarray(T.T @ self.matrices.mass[:6, :6] @ T)

    @property
    def there(self) -> There:
        """What effects can act on."""
        if self.matrices is None:
            return There()
        return there(self.article, self.matrices)


OF_SENSORS = "accelerometers on the article read its motion where they are said to sit; that what bends tilts them is left out"
"""What is assumed of them."""


def mounted_article(model: Model, campaign: Campaign, highest: float = 0.0) -> MountedArticle:
    """What stands on the cover plate of `campaign`, whose lines reach to `highest` [Hz] where that is known.

    Raises
    ------
    BadInput : an article that `model` cannot describe, or a model of the user's own that cannot be used.
    CheckFailed : as `fem.modes.fixed_base`.
    """
    article = above_fmd(campaign.article)
    if not article:
        return MountedArticle(article="", matrices=None, pose=Pose())
    pose, said = mounted(campaign)
    own = _own(model, article, campaign.article)
    if not own and not set(article.split("+")) <= set(NAMES):
        remedy = f"State the path of one, or name a stack of {', '.join(NAMES)} in the campaign"
        raise BadInput(model.source, "own", f"it has no model of {article}, which stands on the FMD in {campaign.source}", remedy)
    reach = [run.excitation.band[1] for run in campaign.runs if run.excitation is not None and run.excitation.band is not None]
    reach += [float(one.frequency[-1]) for one in campaign.recordings.values() if one.frequency is not None and not reach]
    there, unread = accelerometers(model, campaign)
    recipe = _Recipe(
        article=article,
        kind=model.kind,
        own=own,
        stamp=stamp(own),
        modes=model.modes,
        damping_ratio=model.damping_ratio,
        changes=() if own else _changes(model, article),
        band=max(reach, default=highest or BAND) if own else BAND,
        positions=positions_on(model, own) if own else (),
    )
    found = _made(replace(recipe, sensors=tuple(dict.fromkeys(there.values()))))
    why = [_unread(recipe, campaign.source, unread)] if unread else []
    said = (*said, *why, *_riding(recipe, campaign.source, there), *((OF_SENSORS,) if there else ()))
    return replace(found, pose=pose, sensors=there, unread=tuple(unread), remarks=said)


def accelerometers(model: Model, campaign: Campaign) -> tuple[dict[str, str], dict[str, str]]:
    """By name the places of those on the article, in its frame: where `model` knows what moves there, and where it does not.

    Raises
    ------
    BadInput : a model of the user's own that cannot be used.
    """
    table, back, article = campaign.table, mounted(campaign)[0].inverse, above_fmd(campaign.article)
    upon = [table.channels[k] for k in table.select(group="article", quantity="acceleration") if article]
    at = {one.name: at_position(back.apply(one.places[0].position - table.origin).tolist()) for one in upon if not one.is_sum}
    own = _own(model, article, campaign.article) if at else ""
    known = _known(own, stamp(own), tuple(at.values())) if own and model.kind != RIGID else {*at.values()}
    return {name: one for name, one in at.items() if one in known}, {name: one for name, one in at.items() if one not in known}


@lru_cache(maxsize=16)
def _known(own: str, stamp: int, places: tuple[str, ...]) -> frozenset[str]:
    """Of `places` those that a user's own model has."""
    model = users_model(own, stamp).model
    return frozenset(one for one in places if isinstance(model, Structure) and lacking(model, one) is None)


def _riding(recipe: "_Recipe", source: str, there: Mapping[str, str]) -> list[str]:
    """What is to be said of the accelerometers that are `there`, beside a node and at no named place, without elements."""
    model = users_model(recipe.own, recipe.stamp).model if recipe.own and recipe.kind != RIGID else None
    if not isinstance(model, Structure) or model.elements is not None:
        return []
    rows, named = with_positions(model, tuple(there.values())).places, [*model.places.values()]
    beside = {name: place for name, place in there.items() if all(rows[place] is not one for one in named)}
    near = {name: nearest_node(model, np.array(position(place))) for name, place in beside.items()}
    away = {name: distance for name, (_, distance, gap) in near.items() if distance > ON_NODE * (gap or model.gyration)}
    off = ", ".join(f"{name} {1e3 * distance:.3g} mm away" for name, distance in away.items())
    said = f"accelerometers in {source} ride on the nearest nodes of {recipe.article}, which has no elements: {off}"
    return [said] if off else []


def _unread(recipe: "_Recipe", source: str, unread: Mapping[str, str]) -> str:
    """Why the accelerometers `unread` of the campaign in `source` are not used: nobody knows what moves at their places."""
    model, (name, *others), place = users_model(recipe.own, recipe.stamp).model, unread, next(iter(unread.values()))
    error = lacking(model, place) if isinstance(model, Structure) else None
    problem = error.problem if error is not None else "has no known motion: the model has no coordinates"
    remedy = "correct its position, or where the article is mounted"
    remedy = "bring its dof, nodes and coordinates" if problem.endswith("has no coordinates") else remedy
    remedy = BRING if error is not None and BRING in error.remedy else remedy
    at = ", ".join(f"{1e3 * value:.5g}" for value in position(place) or ())
    return (
        f"accelerometer {name} in {source} is not used: at ({at}) mm from the origin of {recipe.article}, along its axes, it "
        f"{problem}; {remedy}{'; nor are ' * bool(others)}{', '.join(others)}"
    )


def moving_part(model: Model) -> Inertia:
    """The FMD's moving part about F as `model` knows it beforehand: as it states, else as drawn.

    Raises
    ------
    BadInput : dimensions that make no FMD.
    """
    if model.fmd is not None:
        return model.fmd.about(np.zeros(3))
    return routes.inertia(built_in(FMD, changes_of(FMD, model.changes)))


def drawn_inertia(model: Model, article: str) -> Inertia:
    """The `article` above the FMD about its own origin, as drawn or as a user's own model has it.

    Raises
    ------
    BadInput : as `mounted_article`.
    """
    own = _own(model, article, f"{FMD}+{article}")
    return _inertia(_Recipe(article=article, kind=model.kind, own=own, stamp=stamp(own), changes=_changes(model, article)))


@dataclass(frozen=True, kw_only=True)
class _Recipe:
    """Everything that decides the matrices of an article; `stamp` tells a user's file from the same one rewritten.

    `band` [Hz] is where tests of an own model end, `positions` are places of it by coordinates, `sensors` what pick-ups may read.
    """

    article: str
    kind: str
    own: str = ""
    stamp: int = 0
    modes: int = 30
    damping_ratio: float | None = None
    changes: tuple[tuple[str, float], ...] = ()
    band: float = BAND
    positions: tuple[str, ...] = ()
    sensors: tuple[str, ...] = ()


def _own(model: Model, article: str, whole: str) -> str:
    """Path of the user's own model of `article`; empty where a built-in one is meant."""
    stated = model.own.get(article, model.own.get(whole, ""))
    return stated or (article if is_model(article) else "")


def _changes(model: Model, article: str) -> tuple[tuple[str, float], ...]:
    return tuple(sorted(changes_of(article, model.changes).items())) if set(article.split("+")) <= set(NAMES) else ()


@lru_cache(maxsize=16)
def _made(recipe: _Recipe) -> MountedArticle:
    """An article, not yet mounted."""
    places = dict.fromkeys((*recipe.positions, *recipe.sensors))
    if recipe.own:
        # A user's own model: matrices with their modes, a solid model of a drawing, or modal data alone
        if recipe.kind == RIGID:
            rides = {name: np.array(position(name)) for name in places}
            return MountedArticle(article=recipe.article, matrices=of_inertia(_inertia(recipe), rides), pose=Pose())
        found = users_model(recipe.own, recipe.stamp)
        damping = _damping(recipe) or found.damping
        if isinstance(found.model, Structure):
            if not len(found.model.held):
                support = "ground" if found.model.grounded else "free"
                remedy = 'State support = "base" with its interface; response functions and modal tables need none'
                raise BadInput(recipe.own, "fe_model.support", f'is "{support}": it has no base that an FMD could carry', remedy)
            return _of_structure(recipe, with_positions(found.model, list(places)), damping, {}, None)
        frequency = found.model.frequency
        modal = found.model if damping is None else replace(found.model, viscous=damping_per_mode(damping, 2 * np.pi * frequency))
        matrices = of_modes(modal, _inertia(recipe).cog)
        return MountedArticle(article=recipe.article, matrices=matrices, frequency=frequency, pose=Pose())
    changes = dict(recipe.changes)
    at = {**locations(recipe.article, changes), **{name: np.array(position(name)) for name in places}}
    if recipe.kind == RIGID:
        return MountedArticle(article=recipe.article, matrices=of_inertia(_inertia(recipe), at), pose=Pose())
    from fem.beam import articles

    drawn = built_in(recipe.article, changes)
    return _of_structure(recipe, articles.structure(recipe.article, changes), _damping(recipe), at, drawn)


def _of_structure(
    recipe: _Recipe, structure: Structure, damping: Damping | None, places: Places, drawn: Article | None
) -> MountedArticle:
    used = damping or default_damping(structure)
    modes, cog = fixed_base(structure, recipe.modes, damping=used), _inertia(recipe).cog
    reduced = on_base(structure, modes, recipe.band, cog, damping=damping) if recipe.own else None
    return MountedArticle(
        article=recipe.article,
        matrices=of_structure(structure, modes, places, cog, damping=used, article=drawn, band=recipe.band)
        if reduced is None
        else reduced.matrices,
        reduced=reduced,
        frequency=modes.frequency,
        losses=used.loss_factors,
        assumed=is_assumed(structure, damping),
        highest=HIGHEST * recipe.band / BAND,
        part_tolerances=structure.part_tolerances,
        pose=Pose(),
    )


def _inertia(recipe: _Recipe) -> Inertia:
    if not recipe.own:
        return routes.inertia(built_in(recipe.article, dict(recipe.changes)))
    return inertia(recipe.own, recipe.stamp)


def _damping(recipe: _Recipe) -> Damping | None:
    return None if recipe.damping_ratio is None else Damping(ratio=recipe.damping_ratio)
