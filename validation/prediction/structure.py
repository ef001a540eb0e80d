"""`Standing`: what stands on the cover plate in one campaign, as a model describes it, before any effect.

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

from fem import damping as fem_damping
from fem.base_excitation import rig
from fem.damping import Damping, damping_per_mode, default_damping
from fem.factorisers import factorise
from fem.modes import Modes, fixed_base
from fem.reduction import static_shapes
from fem.structure import HeldBase, Sparse, Structure, hold, restricted
from fem.user_model.reading import UsersModel, is_model, load
from geometry import routes
from geometry.article import Article
from geometry.articles import NAMES, built_in, changes_of, locations
from geometry.errors import BadInput
from geometry.frames import Array, Pose, rigid_transformation, rigid_transformation_6
from geometry.inertia import Inertia
from identification.campaign import Campaign
from validation.effects.catalogue import There
from validation.effects.stages import Matrices
from validation.flexible.model import nearest_part
from validation.flexible.modes import displacement
from validation.model.model import RIGID, Model
from validation.model.setups import FMD, above_fmd, mounted

# `Matrices` of what stands on its base, or is held: the nominal modal basis, changed by effects and never re-diagonalised.
#
#     x = (base, modes, static answers),  K = Phi^T K Phi,  M = | M_rigid  L |,  L = P^T Phi,
#                                                               |   L^T    1 |
#
# Beside the kept modes Phi holds static answers of the structure, orthonormal to them in the mass: to accelerations of the base,
# so that the residual mass of the truncated modes needs no term of its own (`fem.reduction`), and to the elastic forces of
# every part in the modes of the band, so that a part that is softer, stiffer or lossier than drawn bends the modes as it bends
# those of the structure itself (Kirsch, AIAA Journal 29, 1991: the first terms of the series in K^-1 dK are the basis of a
# reanalysis). Structural damping stays what it is, S = sum of eta_p K_p beside K; places and parts see all coordinates.

BASE = 6

Places = Mapping[str, npt.ArrayLike]
"""(3,) [m] by name, in the article's frame."""

Rows = Mapping[str, Array]
"""(3, f) by place."""

NOWHERE: Places = MappingProxyType({})

BAND = 40.0
"""[Hz] Modes up to here are bent by what parts become; of those above only their own share counts."""

NOTICED = 3e-3
"""Size of an answer beside a mode's own at the top of the band, below which it is no coordinate."""

HEAVY = 0.01
"""Share of the whole mass that a place is made ready to bear."""

ONE_SHEET = ("-bottom", "-top")
"""Endings of parts that are one sheet of material, and one part by the words of the effects; the layer between is another."""


def of_structure(
    structure: Structure,
    modes: Modes,
    places: Places = NOWHERE,
    cog: npt.ArrayLike = (0.0, 0.0, 0.0),
    *,
    damping: Damping | None = None,
    article: Article | None = None,
) -> Matrices:
    """`structure` on its moving base, about the article's origin.

    Parameters
    ----------
    modes : of `structure`, shapes included
    places : (3,) [m] by name, in the article's frame
    cog : (3,) [m] of the article as drawn, from its origin
    damping : that of `modes`; by default the loss factors that the structure brings, as `fem.modes.fixed_base` takes it
    article : what is drawn; its beams' sections then carry the places, else the nodes nearest to them do

    Raises
    ------
    ValueError : modes without shapes, or of other damping.
    """
    free = hold(structure)
    rows = _displacement(structure, free, places, article)
    shapes = _basis(structure, free, modes, free.load, rows)
    own = _matrices_of_user(structure, free, modes, shapes, damping or fem_damping.default_damping(structure), rows)
    L = free.load.T @ shapes
    T = np.eye(BASE + len(own.mass))
    T[:BASE, :BASE] = rigid_transformation_6(modes.reference_point)
    mass = np.block([[structure.rigid_mass, L], [L.T, own.mass]])
    return Matrices(
        base=BASE,
        mass=_symmetric(T.T @ mass @ T),
        stiffness=_on_base(own.stiffness),
        viscous=_on_base(own.viscous),
        structural=_on_base(own.structural),
        places={name: np.hstack([rigid_transformation(at), own.places[name]]) for name, at in places.items()},
        parts={name: _on_base(share) for name, share in own.parts.items()},
        cog=np.asarray(cog, dtype=np.float64),
    )


def held(
    structure: Structure,
    modes: Modes,
    places: Places = NOWHERE,
    *,
    damping: Damping | None = None,
    article: Article | None = None,
) -> Matrices:
    """`structure` with its base held still; static answers to forces at all `places` are among the coordinates.

    Raises
    ------
    ValueError : modes without shapes, or of other damping.
    """
    free = hold(structure)
    rows = _displacement(structure, free, places, article)
    shapes = _basis(structure, free, modes, np.vstack([np.zeros((0, len(free.free))), *rows.values()]).T, rows)
    return _matrices_of_user(structure, free, modes, shapes, damping or fem_damping.default_damping(structure), rows)


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


def _basis(structure: Structure, free: HeldBase, modes: Modes, loads: Array, rows: Rows) -> Array:
    """Kept modes and static answers beside them (f, n): to `loads` (f, k), then to what effects at parts and places will pull."""
    if len(modes.shapes) != structure.mass.shape[0]:
        raise ValueError(
            f"`modes` must bring shapes on all {structure.mass.shape[0]} degrees of freedom, found {len(modes.shapes)}"
        )
    shapes = modes.shapes[free.free]
    shapes = np.hstack([shapes, static_shapes(free.stiffness, free.mass, loads, shapes)])
    swinging = modes.shapes[free.free][:, modes.frequency <= BAND]
    pulls = [restricted(K, free.free) @ swinging for K in _parts(structure).values()]
    heavy = HEAVY * np.trace(structure.rigid_mass[:3, :3]) / 3 * (2 * np.pi * BAND) ** 2
    pulls += [heavy * row.T @ (row @ swinging) for row in rows.values()]
    # Those combinations (f, m) of `forces` whose static answers `shapes` do not nearly hold already
    forces = np.hstack([np.zeros((len(free.free), 0)), *pulls])
    if not forces.size:
        bending = forces
    else:
        static = factorise(free.stiffness, definite=True).solve(forces)
        left = static - shapes @ (shapes.T @ (free.mass @ static))
        square, directions = np.linalg.eigh(left.T @ (free.stiffness @ left))
        bending = np.asarray(forces @ directions[:, square > (NOTICED * 2 * np.pi * BAND) ** 2])
    return np.hstack([shapes, static_shapes(free.stiffness, free.mass, bending, shapes)]) if bending.size else shapes


def _matrices_of_user(
    structure: Structure, free: HeldBase, modes: Modes, shapes: Array, damping: Damping, rows: Rows
) -> Matrices:
    """Matrices on `shapes` (f, n) alone, the base held still."""
    n = modes.frequency.size
    S, C_u = fem_damping.structural_matrix(damping, structure), fem_damping.viscous_matrix(damping, structure)
    viscous = np.zeros((shapes.shape[1], shapes.shape[1])) if C_u is None else _congruent(restricted(C_u, free.free), shapes)
    viscous[:n, :n] += fem_damping.damping_per_mode(damping, 2 * np.pi * modes.frequency)
    structural = np.zeros_like(viscous) if S is None else _congruent(restricted(S, free.free), shapes)
    _require_same(viscous[:n, :n], modes.viscous)
    _require_same(structural[:n, :n], modes.structural)
    return Matrices(
        base=0,
        mass=_congruent(free.mass, shapes),
        stiffness=_congruent(free.stiffness, shapes),
        viscous=viscous,
        structural=structural,
        places={name: row @ shapes for name, row in rows.items()},
        parts={name: _congruent(restricted(K, free.free), shapes) for name, K in _parts(structure).items()},
    )


def _parts(structure: Structure) -> dict[str, Sparse]:
    """Stiffness of every part by the words of the effects."""
    parts: dict[str, Sparse] = {}
    for name, K in structure.part_stiffness.items():
        one = sheet(name)
        parts[one] = parts[one] + K if one in parts else K
    return parts


def sheet(part: str) -> str:
    """The part of the structure that `part` is one sheet of; itself where it is none."""
    for ending in ONE_SHEET:
        part = part.removesuffix(ending)
    return part


def _displacement(structure: Structure, free: HeldBase, places: Places, article: Article | None) -> dict[str, Array]:
    """(3, f) by place: what the free degrees of freedom move there."""
    if not places:
        return {}
    points = np.array([np.asarray(at, dtype=np.float64) for at in places.values()])
    parts = np.zeros(len(points), dtype=np.intp) if article is None else nearest_part(article, points)
    whole = displacement(structure, np.eye(free.size)[:, free.free], article, points, parts)
    return dict(zip(places, whole, strict=True))


def _require_same(found: Array, stated: Array) -> None:
    if not np.allclose(found, stated, rtol=1e-6, atol=1e-6 * np.abs(stated).max(initial=0.0)):
        raise ValueError("`damping` must be that of `modes`, found another modal matrix")


def _on_base(own: Array) -> Array:
    return np.pad(own, (BASE, 0))


def _congruent(matrix: Sparse, shapes: Array) -> Array:
    return _symmetric(shapes.T @ (matrix @ shapes))


def _symmetric(matrix: Array) -> Array:
    return np.asarray((matrix + matrix.T) / 2)


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


@dataclass(frozen=True, eq=False, kw_only=True)
class MountedArticle:
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


def mounted_article(model: Model, campaign: Campaign) -> MountedArticle:
    """What stands on the cover plate of `campaign`.

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
        raise BadInput(
            source=model.source,
            field="own",
            problem=f"it has no model of {article}, which stands on the FMD in {campaign.source}",
            remedy=f"State the path of one, or name a stack of {', '.join(NAMES)} in the campaign",
        )
    recipe = _Recipe(
        article=article,
        kind=model.kind,
        own=own,
        stamp=stamp(own),
        modes=model.modes,
        damping_ratio=model.damping_ratio,
        changes=() if own else _changes(model, article),
    )
    return replace(_made(recipe), pose=pose, remarks=said)


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
    BadInput : as `standing`.
    """
    own = _own(model, article, f"{FMD}+{article}")
    return _inertia(_Recipe(article=article, kind=model.kind, own=own, stamp=stamp(own), changes=_changes(model, article)))


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


def _own(model: Model, article: str, whole: str) -> str:
    """Path of the user's own model of `article`; empty where a built-in one is meant."""
    stated = model.own.get(article, model.own.get(whole, ""))
    return stated or (article if is_model(article) else "")


def _changes(model: Model, article: str) -> tuple[tuple[str, float], ...]:
    return tuple(sorted(changes_of(article, model.changes).items())) if set(article.split("+")) <= set(NAMES) else ()


@lru_cache(maxsize=16)
def _made(recipe: _Recipe) -> MountedArticle:
    """An article, not yet mounted."""
    if recipe.own:
        # A user's own model: matrices with their modes, a solid model of a drawing, or modal data alone
        if recipe.kind == RIGID:
            return MountedArticle(article=recipe.article, matrices=of_inertia(_inertia(recipe), {}), pose=Pose())
        found = users_model(recipe.own, recipe.stamp)
        damping = _damping(recipe) or found.damping
        if isinstance(found.model, Structure):
            return _of_structure(recipe, found.model, damping, {}, None)
        frequency = found.model.frequency
        modal = found.model if damping is None else replace(found.model, viscous=damping_per_mode(damping, 2 * np.pi * frequency))
        matrices = of_modes(modal, _inertia(recipe).cog)
        return MountedArticle(article=recipe.article, matrices=matrices, frequency=frequency, pose=Pose())
    changes = dict(recipe.changes)
    places = locations(recipe.article, changes)
    if recipe.kind == RIGID:
        return MountedArticle(article=recipe.article, matrices=of_inertia(_inertia(recipe), places), pose=Pose())
    from fem.beam import articles

    drawn = built_in(recipe.article, changes)
    return _of_structure(recipe, articles.structure(recipe.article, changes), _damping(recipe), places, drawn)


def _of_structure(
    recipe: _Recipe, structure: Structure, damping: Damping | None, places: Places, drawn: Article | None
) -> MountedArticle:
    used = damping or default_damping(structure)
    modes = fixed_base(structure, recipe.modes, damping=used)
    return MountedArticle(
        article=recipe.article,
        matrices=of_structure(structure, modes, places, _inertia(recipe).cog, damping=used, article=drawn),
        frequency=modes.frequency,
        losses=used.loss_factors,
        pose=Pose(),
    )


def _inertia(recipe: _Recipe) -> Inertia:
    if not recipe.own:
        return routes.inertia(built_in(recipe.article, dict(recipe.changes)))
    return inertia(recipe.own, recipe.stamp)


def _damping(recipe: _Recipe) -> Damping | None:
    return None if recipe.damping_ratio is None else Damping(ratio=recipe.damping_ratio)
