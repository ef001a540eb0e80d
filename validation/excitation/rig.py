"""From a name and options to a `Rig`: the FMD split off the stack, what stands on it reduced about its own origin.

A stack that begins with the FMD stands on its cover plate, which is rigid and moves about F; anything else stands on the table
itself. The model of what is reduced is any that `validation.flexible` makes, so that cells and joints may carry a solid too.
"""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace

import numpy as np

from fem.base_excitation.rig import Body, Cell, Rig
from fem.damping import DEFAULT_RATIO
from geometry.arrays import Array
from geometry.articles import built_in, changes_of
from geometry.errors import BadInput
from geometry.inertia import Inertia
from validation.article_reference import is_stack
from validation.excitation.attached import Attached, require_places
from validation.flexible.model import Asked, Flexible, flexible, require_model, require_used

FMD = "fmd"


@dataclass(frozen=True, eq=False, kw_only=True)
class Mounted:
    """An article made ready for the table.

    Attributes
    ----------
    article : the whole stack, as it was asked for
    rig : what stands on the table
    model : of what stands on the FMD, or of the whole; None for an FMD with nothing on it
    """

    article: str
    rig: Rig
    model: Flexible | None


def require_mountable(article: str, model: str, asked: Asked, attached: Attached) -> None:
    """Refuse what could not become a rig, before anything is computed.

    Raises
    ------
    BadInput : an unknown article, a model that it has not, cells without an FMD, a place that it has not, a dimension of a part
        that it has not.
    """
    found = require_model(article, model)
    require_used(article, [found], replace(asked, cells=False))
    on_fmd = is_stack(article) and article.split("+")[0] == FMD
    if attached.cells and not on_fmd:
        remedy = f"Leave it out, or name a stack that begins with {FMD}, such as {FMD}+clumod-1"
        raise BadInput(source="--cells", problem=f"only the FMD has load cells, found {article}", remedy=remedy)
    if attached.flange is not None and article == FMD:
        problem = "the FMD alone has nothing above its cover plate that a flange could join"
        raise BadInput(source="--flange", problem=problem, remedy="Leave it out, or name a stack such as fmd+clumod-1")
    known = places(article, found, asked)
    why = "Leave it out" if known or found != "exudyn" else "Use --model beam or solid, whose shapes say how a place moves"
    require_places(attached.struts, known, article, why)


def places(article: str, model: str, asked: Asked) -> Mapping[str, Array]:
    """Named places (3,) [m] of what stands on the FMD, in its own frame; none of a file, and none where no shape is known."""
    if not is_stack(article) or model == "exudyn" or article == FMD:
        return {}
    from geometry.articles.locations import locations

    own = _above(article)
    return locations(own, changes_of(own, asked.changes))


def mounted(article: str, model: str, asked: Asked, attached: Attached, highest: float = np.inf) -> Mounted:
    """The rig of `article`; `require_mountable` has looked at it.

    Parameters
    ----------
    highest : [Hz] modes above it are not kept but answer statically

    Raises
    ------
    BadInput, CheckFailed : as `validation.flexible.model.flexible`.
    """
    if article == FMD:
        return Mounted(article=article, rig=_bare(asked, attached), model=None)
    above = _above(article)
    own = replace(asked, cells=False, changes=changes_of(above, asked.changes) if is_stack(article) else asked.changes)
    made = _followed(flexible(above, model, own), above, model, own, highest)
    return assembled(article, made, asked, attached, highest)


def assembled(article: str, made: Flexible, asked: Asked, attached: Attached, highest: float = np.inf) -> Mounted:
    """The rig of `article` from a model `made` of what stands on its FMD, or of the whole where it has none.

    Raises
    ------
    BadInput : modes that do not fit their structure.
    """
    body = _body(made, places(article, made.model, asked), highest)
    common = {"flange": attached.flange, "struts": attached.struts, "frictions": attached.frictions}
    if _above(article) == article:
        return Mounted(article=article, rig=Rig(article=body, **common), model=made)  # type: ignore[arg-type]
    seat, cover = _fmd(asked)
    mass = cover.mass + float(made.modes.rigid_mass[0, 0])
    rig = Rig(article=body, cover=cover, seat=seat, cells=_cells(asked, attached, mass), **common)  # type: ignore[arg-type]
    return Mounted(article=article, rig=rig, model=made)


def _above(article: str) -> str:
    """What stands on the FMD of a stack, and the whole of everything else."""
    first, plus, rest = article.partition("+")
    return rest if plus and first == FMD and is_stack(article) else article


def _followed(made: Flexible, article: str, model: str, asked: Asked, highest: float) -> Flexible:
    """`made`, the `model` of `article`, without its modes above `highest` [Hz], but for the first."""
    count = int(np.sum(made.modes.frequency <= highest))
    if count == len(made.modes.frequency) or made.structure is None:
        return made
    return flexible(article, model, replace(asked, count=max(count, 1)))


def _body(model: Flexible, places: Mapping[str, Array], highest: float) -> Body:
    """`model` reduced; rigid when even its first mode lies above `highest` [Hz]."""
    from fem.base_excitation import body

    if not len(model.modes.frequency) or model.modes.frequency[0] > highest:
        return body.rigid(model.article, Inertia.from_mass_matrix(model.modes.rigid_mass, model.modes.reference_point), places)
    if model.structure is None or not len(model.modes.shapes):
        return body.of_modal_data(model.article, model.modes)
    made = body.flexible(model.article, model.structure, model.modes)
    return replace(made, places=_moving(model, made, places)) if places else made


def _moving(model: Flexible, body: Body, places: Mapping[str, Array]) -> dict[str, Array]:
    """What each coordinate of `body` does to `places`, (3, 6 + n): on beams a place rides on the section that it belongs to."""
    from validation.flexible.motion import displacement
    from validation.flexible.places import nearest_part

    article, structure = model.article_of_primitives, model.structure
    if article is None or structure is None:
        return {}
    points = np.array(list(places.values()))
    rows = displacement(structure, body.reduced.basis, article, points, nearest_part(article, points))
    return dict(zip(places, rows, strict=True))


def _bare(asked: Asked, attached: Attached) -> Rig:
    """The FMD with nothing on it, as its tare is taken: cover plate and article are one half of its moving part each."""
    from fem.base_excitation import body

    _, cover = _fmd(asked)
    half = cover.scaled(0.5)
    return Rig(
        article=body.rigid(FMD, half, {}),
        cover=half,
        cells=_cells(asked, attached, cover.mass),
        frictions=attached.frictions,
    )


def _fmd(asked: Asked) -> tuple[Array, Inertia]:
    """Where an article's origin sits above F (3,) [m], and the inertia of the moving part about F."""
    from geometry.multibody import inertia

    fmd = built_in(FMD, changes_of(FMD, asked.changes))
    return np.zeros(3) if fmd.seat is None else fmd.seat.position, inertia(fmd)


def _cells(asked: Asked, attached: Attached, mass: float) -> tuple[Cell, ...]:
    """The FMD's load cells when they are springs; `mass` [kg] is all that they carry.

    Their damping is that of their material where the whole mass swings on them along one axis: c = eta sqrt(k m) for each of four
    cells of stiffness k under m / 4.
    """
    if not attached.cells:
        return ()
    from fem.beam import load_cells
    from geometry.articles.dimensions import load
    from geometry.materials import material
    from geometry.shapes import rectangle

    d = load(FMD, changes_of(FMD, asked.changes))["load_cell"]
    loss = material(d["material"]).loss_factor
    eta = 2 * DEFAULT_RATIO if loss is None else loss
    corners = rectangle(d["square"], d["square"])
    stiffness = load_cells(changes_of(FMD, asked.changes))
    return tuple(
        Cell(
            position=np.array([x, y, 0.0]),
            stiffness=k,
            damping=eta * np.sqrt(k * mass / len(corners)),
            preload=attached.preload.get(str(number)),
        )
        for number, ((x, y), k) in enumerate(zip(corners, stiffness, strict=True), start=1)
    )
