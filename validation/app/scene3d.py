"""What stands on the shaker, to be drawn in 3-D: bodies and sensors of one campaign, seen from F."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass, replace
from functools import lru_cache

import numpy as np

from fem.structure import at_freedoms, position_of
from geometry.articles import NAMES, changes_of
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Integers
from geometry.sensors import Point
from geometry.toml_file import nearest as keys_nearest
from identification import campaign_file
from identification.campaign import Campaign
from validation.app.kept import Compared
from validation.app.session import Session, digest, opened
from validation.flexible.model import FlexibleOptions, flexible
from validation.history.history import read_text
from validation.model.model import BEAM
from validation.prediction import effects
from validation.prediction.modal_table import TableFrequencies, TableShapes, real_modes
from validation.prediction.response_functions import ResponseFunctionTest
from validation.prediction.structure import ReducedStructure
from validation.prediction.structure_tests import StructurePrediction
from validation.report.charts.functions import ShownPair
from validation.report.flexible import Moved, moved_bodies
from validation.report.scenes.motion import WORDS, MovingBody, Outline, marks, scale_of
from validation.report.scenes.scene import DrawnBody, fitted
from validation.report.scenes.setups import DrawnSensor, bodies_of, sensors_of
from validation.report.scenes.turntable import DRIVE, FAILS, Turntable


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
        raise BadInput("campaign", name, "no campaign is called so", f"{keys_nearest(name, known)}Known are {', '.join(known)}")
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
    told = of.loads[of.campaigns.index(cell.campaign)].get(cell.row) or range(6)  # by an acceleration all six
    loads = [row - found.channels] if row >= found.channels else list(told)
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
        raise BadInput(campaign, "mode", problem, "Choose one of them")
    if model.kind != BEAM or standing.article in model.own or not set(standing.article.split("+")) <= set(NAMES):
        problem = "its bodies are not known: it is rigid, or a model of your own"
        raise BadInput(standing.article, "mode", problem, "Look at the curves; its frequency stands there")
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


# A structure that was tested by itself: its mesh with drives and sensors, its modes, and those of a test beside them.


@lru_cache(maxsize=2)
def _tests(folder: str, digest: str) -> tuple[StructurePrediction, ...]:
    """The tests of the session in `folder` by its model as it stands, whose text has the `digest`."""
    study = opened(folder).study()
    return study.predictions[len(study.made) :]


@dataclass(frozen=True, eq=False, kw_only=True)
class ShownStructure:
    """One data set of a structure that was tested by itself.

    Attributes
    ----------
    prediction : by the model as it stands
    whole : its structure
    nodes, moved : (p, 3) [m] those that move, and by which rows of the basis
    points : where forces act and answers are read, those of which the place is known
    places : (s, 3) [m] of these
    """

    prediction: StructurePrediction
    whole: ReducedStructure
    nodes: Array
    moved: Integers
    points: tuple[Point, ...]
    places: Array

    @classmethod
    def of(cls, session: Session, name: str) -> "ShownStructure":
        """The data set `name` of a session.

        Raises
        ------
        BadInput : of the structure no coordinates are known.
        """
        tests = _tests(str(session.folder), digest(read_text(session.model)))
        one = next(each for each in tests if each.measured.name == name)
        whole = None if one.structure is None else one.structure.reduced
        nodes, moved = (np.zeros((0, 3)), np.zeros((0, 3), dtype=np.intp)) if whole is None else whole.nodes()
        if whole is None or not len(nodes):
            problem = "its structure is no mesh, so there is nothing to be drawn"
            raise BadInput(name, "", problem, "Look at the curves and the MAC")
        every = one.table.sensors if isinstance(one, TableFrequencies | TableShapes) else ()
        if isinstance(one, ResponseFunctionTest):
            every = (*one.responses, *(each for each in one.drives if each.name not in {at.name for at in one.responses}))
        found = {point: position_of(whole.structure, point.place) for point in every}
        known = {point: place for point, place in found.items() if place is not None}
        places = np.array(list(known.values())).reshape(-1, 3)
        return cls(prediction=one, whole=whole, nodes=nodes, moved=moved, points=tuple(known), places=places)

    def sensors(self, fails: Mapping[str, float]) -> tuple[DrawnSensor, ...]:
        """Forces and sensors, with the sigmas of those that deviate."""
        drives = {one.name for one in self.prediction.drives} if isinstance(self.prediction, ResponseFunctionTest) else set()
        found = []
        for one, place in zip(self.points, self.places, strict=True):
            words = f"{one.name}, {fails[one.name]:.0f} σ" if one.name in fails else one.name
            group = FAILS if one.name in fails else DRIVE if one.name in drives else "article"
            found.append(DrawnSensor(name=words, group=group, position=place, direction=np.asarray(one.direction)))
        return tuple(found)

    def mode(self, offsets: Mapping[str, float], number: int) -> tuple[Array, Array]:
        """What the mode with `number` of the structure at `offsets` moves: nodes (p, 3), and the points (s, 3).

        Raises
        ------
        numpy.linalg.LinAlgError : the model breaks down there.
        """
        structure = self.prediction.structure
        if structure is None:
            raise ValueError("`prediction` must have a structure")
        acting = effects.at(self.prediction.effects, offsets)
        modes = real_modes(effects.structure(structure.at(offsets, derivatives=False)[0], {}, acting, derivatives=False)[0])
        basis = self.whole.basis
        swing = basis @ modes.shapes[: basis.shape[1], number]
        at = [self.whole.structure.places[one.place] @ swing for one in self.points]
        return at_freedoms(swing, self.moved), np.array(at).reshape(-1, 3)


@dataclass(frozen=True, eq=False, kw_only=True)
class Turned:
    """What can be turned on the page.

    Attributes
    ----------
    table : pictures of it
    label, note : what it is, and what is to be known about it
    """

    table: Turntable
    label: str
    note: str


SHINING = 4.0
"""[sigma] from which a force or a sensor is marked: chance does not reach it."""

MARK = 0.035
"""Of its size, what a mark of a sensor that moves is."""

APART = 1.5
"""Of its width, by which the structure of the test stands beside that of the model."""


def failing(of: Compared, name: str) -> dict[str, float]:
    """By name of a sensor its worst deviation [sigma], of those that no chance explains; none where half of them deviate."""
    found = of.map(name)
    sigma = np.where(np.isfinite(found.expected), found.sigma, 0.0)[..., : found.channels]
    peak = dict(zip(found.rows, sigma.max(axis=(0, 1)).tolist(), strict=False))
    least = max(SHINING, 2 * float(np.median(list(peak.values()))))
    return {channel: most for channel, most in peak.items() if most >= least}


def of_test(
    session: Session,
    found: Compared | None,
    name: str,
    mode: int | None,
    pair: ShownPair | None,
    here: Array | None = None,
    kind: str = "",
) -> Turned:
    """The data set `name` of a structure as it stands: at rest, in a mode, or a pair of shapes of test and model side by side.

    Parameters
    ----------
    mode : number of `Compared.modes_of`
    pair : of its MAC
    here : (3,) [m] a node that is marked
    kind : of what may sit anywhere, by the evidence for which nodes are coloured; none where it is empty

    Raises
    ------
    BadInput : of the structure no coordinates are known.
    """
    one = ShownStructure.of(session, name)
    outline = Outline.of(one.whole.structure, one.nodes)
    sensors = one.sensors({} if found is None else failing(found, name))
    article = one.prediction.measured.configuration
    if found is None or (mode is None and pair is None):
        body: DrawnBody | MovingBody = DrawnBody(
            name=article, material="structure", vertices=outline.vertices, faces=outline.faces
        )
        note = (
            "Arrows: where forces act and answers are read; red is what deviates by more than chance explains, with its sigmas."
        )
        if here is not None:
            sensors = (*sensors, DrawnSensor(name="here", group=FAILS, position=here, direction=np.array([0.0, 0.0, 1.0])))
        nodes = one.nodes if one.prediction.structure is not None and one.prediction.structure.scaled else None
        points, evidence = session.evidence(article).get(kind, (np.zeros((0, 3)), np.zeros(0)))
        if len(points):
            shown = np.maximum(evidence, 0.0)[:, None] * np.array([1.0, 0.0, 0.0])
            body = Outline.of(one.whole.structure, points).moving(article, shown)
            x, y, z = 1e3 * points[np.argmax(evidence)]
            most = f"{WORDS[kind]}: at most {evidence.max():.3g} nats, at ({x:.4g}, {y:.4g}, {z:.4g}) mm; grey explains nothing."
            alone = "Each node alone, to first order: the table has the best at finite sizes, less what looking everywhere costs."
            note = f"{most} {alone}"
        table = Turntable((body,), sensors, nodes=nodes)
        note += " A click on a node asks what something there would do." if nodes is not None else ""
        return Turned(table=table, label=f"{name}: structure and sensors", note=note)
    if pair is None:
        known = found.modes_of(name)[mode or 0]
        swing, carried = one.mode({**found.offsets}, mode or 0)
        moving = (outline.moving(article, swing),)
        note = f"{known.name}, {known.frequency:.2f} Hz, damping ratio {known.damping_ratio:.3g}; size of the swing as drawn."
        label = f"{name}: {known.name} at {known.frequency:.2f} Hz"
        return Turned(table=Turntable(moving, sensors, scale_of(moving), carried), label=label, note=note)
    start = {each.name: each.start for each in one.prediction.parameters}
    swing, carried = one.mode(start, pair.of.modes[pair.at[1]] - 1)
    # What the test says of every place: along each of the directions that were read there
    read = dict(zip(pair.of.comac, pair.scaled.real, strict=True))
    by_place: dict[str, Array] = {}
    for point in one.points:
        if point.name in read:
            moved = read[point.name] * np.asarray(point.direction)
            by_place[point.place] = by_place.get(point.place, np.zeros(3)) + moved
    at = {point.place: place for point, place in zip(one.points, one.places, strict=True) if point.place in by_place}
    size = float(np.ptp(outline.vertices, axis=0).max())
    view = fitted(outline.vertices, (600, 400), 34.0)
    across = outline.vertices @ view.right
    beside = -APART * float(np.ptp(across) or size) * view.right
    vertices, faces = marks(np.array(list(at.values())) + beside, MARK * size)
    shown = np.repeat(np.array([by_place[place] for place in at]), 6, axis=0)
    edges = np.zeros((0, 2), dtype=np.int64)
    test = MovingBody(name="test", vertices=vertices, faces=faces, edges=edges, displacement=shown)
    still = replace(outline, vertices=outline.vertices + beside).moving("at rest", np.zeros_like(swing))
    bodies = (outline.moving(article, swing), still, test)
    there = tuple(replace(each, position=each.position + beside) for each in sensors)
    note = "On the left the test at its sensors, whose names it bears; on the right the model. Both in the scale of the model."
    moved = np.array([by_place.get(point.place, np.zeros(3)) for point in one.points])
    label = f"{name}: {pair.words}"
    return Turned(table=Turntable(bodies, there, scale_of(bodies), moved), label=label, note=note)
