"""The mode nearest a frequency, as a shape that can be drawn and moved."""

from __future__ import annotations

from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from geometry.arrays import Array
from geometry.articles import NAMES, changes_of
from geometry.errors import BadInput
from validation.desk.comparing import Compared
from validation.desk.desk import Desk
from validation.desk.recorded import made, model_of
from validation.flexible.drawing import Moved, moved_bodies
from validation.flexible.model import Asked, flexible
from validation.models.model import BEAM, Model
from validation.pictures.mode_scene import scale_of
from validation.pictures.moving import MovingBody
from validation.prediction import applied
from validation.prediction.series import SeriesPrediction


@dataclass(frozen=True, eq=False, kw_only=True)
class Shape:
    """A mode with its base held, seen from F.

    Attributes
    ----------
    number : from 0, ascending in frequency
    name : "first mast mode"
    frequency, damping_ratio : [Hz], [1], as the plain fit has them
    bodies : vertices at rest, faces, edges, and the displacement of every vertex in any one scale
    scale : factor by which displacements are drawn; times cos(2 pi f t) it moves
    """

    number: int
    name: str
    frequency: float
    damping_ratio: float
    bodies: tuple[MovingBody, ...]
    scale: float


def nearest(of: Compared, campaign: str, frequency: float) -> int | None:
    """Number of the mode of `campaign` whose frequency is nearest, told in octaves; None where there is none.

    Raises
    ------
    KeyError : there is no such campaign.
    """
    modes = of.modes_of(campaign)
    apart = [abs(np.log(one.frequency / frequency)) if one.frequency > 0 else np.inf for one in modes]
    return int(np.argmin(apart)) if apart else None


def shape(of: Desk, found: Compared, campaign: str, number: int) -> Shape:
    """The mode with `number`; a second or two the first time, then quick.

    It is what the model as it stands makes of the modes that it was drawn with: effects and the plain fit mix these. What a
    resonator of an effect moves by itself is no body and is not drawn.

    Raises
    ------
    BadInput : the article is rigid, of the user's own, or has no such mode.
    KeyError : there is no such campaign.
    """
    modes, model = found.modes_of(campaign), model_of(of)
    one = next(each for each in made(of, model) if each.measured.name == campaign)
    standing = one.tested.carried.standing
    if not 0 <= number < len(modes):
        problem = (
            f"it has modes 0 to {len(modes) - 1}, found {number}" if modes else "it has no modes: what stands there is rigid"
        )
        raise BadInput(source=campaign, field="mode", problem=problem, remedy="Choose one of them")
    bodies = _drawn(standing.article, model)
    share = _shares(one, {**found.offsets}, number)[: bodies[0][2].shape[2]]
    turn = standing.pose.rotation
    moving = tuple(
        MovingBody(
            name=body.name,
            vertices=standing.pose.apply(body.vertices),
            faces=body.faces,
            edges=edges,
            displacement=(moved @ share) @ turn.T,
        )
        for body, edges, moved in bodies
    )
    mode = modes[number]
    return Shape(
        number=number,
        name=mode.name,
        frequency=mode.frequency,
        damping_ratio=mode.damping_ratio,
        bodies=moving,
        scale=scale_of(moving),
    )


def _shares(one: SeriesPrediction, offsets: dict[str, float], number: int) -> Array:
    """(k,) how much of each of the drawn modes is in the mode `number` of the structure as it stands, its base held."""
    from scipy.linalg import eigh

    nuisances = one.tested.carried.nuisances
    if nuisances is None:
        raise ValueError("`one` must have a structure")
    matrices = applied.structure(nuisances.at(offsets, derivatives=False)[0], {}, applied.at(one.effects, offsets))[0]
    own = slice(matrices.base, None)
    shapes = eigh(matrices.stiffness[own, own], matrices.mass[own, own])[1]
    return np.asarray(shapes[: one.tested.carried.standing.modes, number])


def _drawn(article: str, model: Model) -> tuple[Moved, ...]:
    if model.kind != BEAM or article in model.own or not set(article.split("+")) <= set(NAMES):
        problem = "its bodies are not known: it is rigid, or a model of your own"
        raise BadInput(source=article, field="mode", problem=problem, remedy="Look at the curves; its frequency stands there")
    return _of_beams(article, tuple(sorted(changes_of(article, model.changes).items())), model.modes)


@lru_cache(maxsize=4)
def _of_beams(article: str, changes: tuple[tuple[str, float], ...], count: int) -> tuple[Moved, ...]:
    """Bodies fine enough to bend, with what they move in each of the modes as drawn."""
    made_of = flexible(article, BEAM, Asked(count=count, changes=dict(changes)))
    return moved_bodies(made_of, made_of.modes.shapes)
