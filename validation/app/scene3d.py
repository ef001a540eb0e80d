"""What stands on the shaker, to be drawn in 3-D: bodies and sensors of one campaign, seen from F."""

from collections.abc import Sequence
from dataclasses import dataclass
from functools import lru_cache

import numpy as np

from geometry.articles import NAMES, changes_of
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.toml_file import nearest as keys_nearest
from identification import campaign_file
from identification.campaign import Campaign
from validation.app.session import Compared, Session
from validation.flexible.model import FlexibleOptions, flexible
from validation.model.model import BEAM
from validation.prediction import effects
from validation.report.flexible import Moved, moved_bodies
from validation.report.scenes.motion import MovingBody, scale_of
from validation.report.scenes.scene import DrawnBody
from validation.report.scenes.setups import DrawnSensor, bodies_of, sensors_of


@dataclass(frozen=True, eq=False, kw_only=True)
class Scene:
    """Plain arrays, in metres, in the axes of F.

    Attributes
    ----------
    campaign, title : its name, and what it calls itself (text of a stranger, never HTML)
    bodies : with vertices (n, 3) and faces (k, 3); none of an article that is not built in
    sensors : one for every place of a channel, with its direction of positive output and its group
    note : what is to be known about both
    """

    campaign: str
    title: str
    bodies: tuple[DrawnBody, ...]
    sensors: tuple[DrawnSensor, ...]
    note: str


def scene(of: Session, campaign: str) -> Scene:
    """The set-up of `campaign`; bodies take about a second the first time.

    Raises
    ------
    BadInput : no such campaign, or its description cannot be read.
    """
    described = the_campaign(of, campaign)
    bodies, note = bodies_of(described, of.read_model().changes)
    return Scene(campaign=campaign, title=described.title, bodies=bodies, sensors=sensors_of(described), note=note)


def the_campaign(of: Session, name: str) -> Campaign:
    """The description of the campaign of that name.

    Raises
    ------
    BadInput : there is none, with the nearest.
    """
    known = of.campaigns()
    if name not in known:
        remedy = f"{keys_nearest(name, known)}Known are {', '.join(known)}"
        raise BadInput(source="campaign", field=name, problem="no campaign is called so", remedy=remedy)
    return campaign_file.read_description(known[name])


# Where a click on the residual map leads on the 6 x 6 dynamic mass.


@dataclass(frozen=True, kw_only=True)
class MapEntry:
    """One entry, and a line of it.

    Attributes
    ----------
    campaign : data set
    load, motion : 0 to 5 in the orders of `geometry.inertia.LOADS` and `geometry.dynamic_mass.MOTIONS`
    frequency : [Hz] to show
    """

    campaign: str
    load: int
    motion: int
    frequency: float


@dataclass(frozen=True, kw_only=True)
class MapCell:
    """A cell of the residual map.

    Attributes
    ----------
    campaign, run, row : data set, its run, and the channel or load
    frequency : [Hz]
    """

    campaign: str
    run: str
    row: str
    frequency: float


def entry_of(of: Compared, cell: MapCell) -> MapEntry:
    """The entry that shows what a cell of the residual map shows.

    The motion is that which the run drives; the load is the cell's own, or of those that its channel tells the one that deviates
    most there. An acceleration is in every load.

    Raises
    ------
    KeyError : no such campaign, run or row.
    """
    found = of.map(cell.campaign)
    run, row = _place(found.runs, cell.run), _place(found.rows, cell.row)
    line = _line(found.frequency, cell.frequency)
    # The motion that a run drives: that of its axis, else the one that is largest there beside its nominal level
    if found.axes[run] in MOTIONS:
        motion = MOTIONS.index(found.axes[run])
    else:
        levels = np.array([LEVELS[axis] for axis in MOTIONS])
        motion = int(np.argmax(np.abs(found.inputs[run, line, :6]) / levels[: found.inputs.shape[2]]))
    loads = [row - found.channels] if row >= found.channels else list(of.loads_of(cell.campaign, cell.row))
    sigma = np.zeros((6, 6)) if found.pairs is None else found.pairs.sigma[_line(found.pairs.frequency, cell.frequency)]
    most = max(loads, key=lambda load: float(sigma[load, motion]))
    return MapEntry(campaign=cell.campaign, load=most, motion=motion, frequency=float(found.frequency[line]))


def _line(frequency: Array, wanted: float) -> int:
    return int(np.argmin(np.abs(frequency - wanted)))


def _place(names: Sequence[str], name: str) -> int:
    if name not in names:
        raise KeyError(name)
    return names.index(name)


# The mode nearest a frequency, as a shape that can be drawn and moved.


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


def shape(of: Session, found: Compared, campaign: str, number: int) -> Shape:
    """The mode with `number`; a second or two the first time, then quick.

    It is what the model as it stands makes of the modes that it was drawn with: effects and the plain fit mix these. What a
    resonator of an effect moves by itself is no body and is not drawn.

    Raises
    ------
    BadInput : the article is rigid, of the user's own, or has no such mode.
    KeyError : there is no such campaign.
    """
    modes, model = found.modes_of(campaign), of.read_model()
    one = next(each for each in of.predictions(model) if each.measured.name == campaign)
    standing = one.tested.carried.standing
    if not 0 <= number < len(modes):
        problem = (
            f"it has modes 0 to {len(modes) - 1}, found {number}" if modes else "it has no modes: what stands there is rigid"
        )
        raise BadInput(source=campaign, field="mode", problem=problem, remedy="Choose one of them")
    if model.kind != BEAM or standing.article in model.own or not set(standing.article.split("+")) <= set(NAMES):
        problem = "its bodies are not known: it is rigid, or a model of your own"
        raise BadInput(
            source=standing.article, field="mode", problem=problem, remedy="Look at the curves; its frequency stands there"
        )
    bodies = _of_beams(standing.article, tuple(sorted(changes_of(standing.article, model.changes).items())), model.modes)
    from scipy.linalg import eigh

    # (k,) how much of each of the drawn modes is in the mode `number` of the structure as it stands, its base held
    offsets = {**found.offsets}
    nuisances = one.tested.carried.nuisances
    if nuisances is None:
        raise ValueError("`one` must have a structure")
    matrices = effects.structure(nuisances.at(offsets, derivatives=False)[0], {}, effects.at(one.effects, offsets))[0]
    own = slice(matrices.base, None)
    shapes = eigh(matrices.stiffness[own, own], matrices.mass[own, own])[1]
    shares = np.asarray(shapes[: one.tested.carried.standing.modes, number])
    share = shares[: bodies[0][2].shape[2]]
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


@lru_cache(maxsize=4)
def _of_beams(article: str, changes: tuple[tuple[str, float], ...], count: int) -> tuple[Moved, ...]:
    """Bodies fine enough to bend, with what they move in each of the modes as drawn."""
    made_of = flexible(article, BEAM, FlexibleOptions(count=count, changes=dict(changes)))
    return moved_bodies(made_of, made_of.modes.shapes)
