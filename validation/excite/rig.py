"""From a name and options to a `Rig`: the FMD split off the stack, what stands on it reduced about its own origin.

A stack that begins with the FMD stands on its cover plate, which is rigid and moves about F; anything else stands on the table
itself. The model of what is reduced is any that `validation.flexible` makes, so that cells and joints may carry a solid too.
"""

from collections.abc import Mapping
from dataclasses import dataclass, replace
from typing import TYPE_CHECKING, Any

import numpy as np

from fem.base_excitation.patterns import BaseMotion
from fem.base_excitation.rig import LoadCell, Rig
from fem.damping import DEFAULT_RATIO
from geometry.articles import built_in, changes_of
from geometry.dynamic_mass import LEVELS, MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, freeze, rigid_transformation
from geometry.inertia import Inertia
from geometry.toml_file import nearest
from validation.excite.question import BURST, MULTI, RANDOM, Attached, TableDrive
from validation.flexible.model import Flexible, FlexibleOptions, flexible, require_base, require_model, require_used
from validation.model.setups import is_stack

if TYPE_CHECKING:
    from fem.base_excitation.patterns import CrossMotion, Pattern, Sweep


FMD = "fmd"


@dataclass(frozen=True, eq=False, kw_only=True)
class ArticleOnTable:
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


def require_mountable(article: str, model: str, asked: FlexibleOptions, attached: Attached) -> None:
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
        raise BadInput("--cells", "", f"only the FMD has load cells, found {article}", remedy)
    if attached.flange is not None and article == FMD:
        problem = "the FMD alone has nothing above its cover plate that a flange could join"
        raise BadInput("--flange", "", problem, "Leave it out, or name a stack such as fmd+clumod-1")
    known = places(article, found, asked)
    why = "Leave it out" if known or found != "exudyn" else "Use --model beam or solid, whose shapes say how a place moves"
    for strut in (strut for strut in attached.struts if strut.place not in known):
        option = "--cable" if strut.to == "ground" else "--damper"
        remedy = f"{nearest(strut.place, known)}Its places are {', '.join(known)}" if known else why
        raise BadInput(option, "", f"{article} has no place {strut.place!r}", remedy)


def places(article: str, model: str, asked: FlexibleOptions) -> Mapping[str, Array]:
    """Named places (3,) [m] of what stands on the FMD, in its own frame; none of a file, and none where no shape is known."""
    if not is_stack(article) or model == "exudyn" or article == FMD:
        return {}
    from geometry.articles import locations

    own = _above(article)
    return locations(own, changes_of(own, asked.changes))


def mounted(article: str, model: str, asked: FlexibleOptions, attached: Attached, highest: float = np.inf) -> ArticleOnTable:
    """The rig of `article`; `require_mountable` has looked at it.

    Parameters
    ----------
    highest : [Hz] modes above it are not kept but answer statically

    Raises
    ------
    BadInput, CheckFailed : as `validation.flexible.model.flexible`.
    """
    if article == FMD:
        from fem.base_excitation import rig

        # The FMD with nothing on it, as its tare is taken: cover plate and article are one half of its moving part each
        _, cover = _fmd(asked)
        half = cover.scaled(0.5)
        bare = Rig(
            article=rig.rigid(FMD, half, {}), cover=half, cells=_cells(asked, attached, cover.mass), frictions=attached.frictions
        )
        return ArticleOnTable(article=article, rig=bare, model=None)
    above = _above(article)
    own = replace(asked, cells=False, changes=changes_of(above, asked.changes) if is_stack(article) else asked.changes)
    # `followed_made`, the `model` of `above`, without its modes above `highest` [Hz], but for the first
    followed_made = flexible(above, model, own)
    require_base(followed_made)
    count = int(np.sum(followed_made.modes.frequency <= highest))
    if count == len(followed_made.modes.frequency) or followed_made.structure is None:
        made = followed_made
    else:
        made = flexible(above, model, replace(own, count=max(count, 1)))
    return assembled(article, made, asked, attached, highest)


def assembled(
    article: str, made: Flexible, asked: FlexibleOptions, attached: Attached, highest: float = np.inf
) -> ArticleOnTable:
    """The rig of `article` from a model `made` of what stands on its FMD, or of the whole where it has none.

    It is rigid when even its first mode lies above `highest` [Hz].

    Raises
    ------
    BadInput : modes that do not fit their structure.
    """
    from fem.base_excitation import rig as reduced
    from validation.flexible.model import nearest_part
    from validation.flexible.modes import displacement

    named, first = places(article, made.model, asked), made.modes.frequency[:1]
    if not len(first) or first[0] > highest:
        whole = Inertia.from_mass_matrix(made.modes.rigid_mass, made.modes.reference_point)
        body = reduced.rigid(made.article, whole, named)
    elif made.structure is None or not len(made.modes.shapes):
        body = reduced.of_modal_data(made.article, made.modes)
    else:
        body = reduced.flexible(made.article, made.structure, made.modes)
        drawn = made.article_of_primitives
        if named and drawn is not None:
            # What each coordinate does to a place, (3, 6 + n): on beams a place rides on the section that it belongs to
            points = np.array(list(named.values()))
            rows = displacement(made.structure, body.reduced.basis, drawn, points, nearest_part(drawn, points))
            body = replace(body, places=dict(zip(named, rows, strict=True)))
    common = {"flange": attached.flange, "struts": attached.struts, "frictions": attached.frictions}
    if _above(article) == article:
        return ArticleOnTable(article=article, rig=Rig(article=body, **common), model=made)  # type: ignore[arg-type]
    seat, cover = _fmd(asked)
    mass = cover.mass + float(made.modes.rigid_mass[0, 0])
    rig = Rig(article=body, cover=cover, seat=seat, cells=_cells(asked, attached, mass), **common)  # type: ignore[arg-type]
    return ArticleOnTable(article=article, rig=rig, model=made)


def _above(article: str) -> str:
    """What stands on the FMD of a stack, and the whole of everything else."""
    first, plus, rest = article.partition("+")
    return rest if plus and first == FMD and is_stack(article) else article


def _fmd(asked: FlexibleOptions) -> tuple[Array, Inertia]:
    """Where an article's origin sits above F (3,) [m], and the inertia of the moving part about F."""
    from geometry.routes import inertia

    fmd = built_in(FMD, changes_of(FMD, asked.changes))
    return np.zeros(3) if fmd.seat is None else fmd.seat.position, inertia(fmd)


def _cells(asked: FlexibleOptions, attached: Attached, mass: float) -> tuple[LoadCell, ...]:
    """The FMD's load cells when they are springs; `mass` [kg] is all that they carry.

    Their damping is that of their material where the whole mass swings on them along one axis: c = eta sqrt(k m) for each of four
    cells of stiffness k under m / 4.
    """
    if not attached.cells:
        return ()
    from fem.beam.articles import load_cells
    from geometry.article import material, rectangle
    from geometry.articles.parts import load

    d = load(FMD, changes_of(FMD, asked.changes))["load_cell"]
    loss = material(d["material"]).loss_factor
    eta = 2 * DEFAULT_RATIO if loss is None else loss
    corners = rectangle(d["square"], d["square"])
    stiffness = load_cells(changes_of(FMD, asked.changes))
    return tuple(
        LoadCell(
            position=np.array([x, y, 0.0]),
            stiffness=k,
            damping=eta * np.sqrt(k * mass / len(corners)),
            preload=attached.preload.get(str(number)),
        )
        for number, ((x, y), k) in enumerate(zip(corners, stiffness, strict=True), start=1)
    )


# From a drive to runs: what the table does in each, by the patterns of `fem.base_excitation`.


@dataclass(frozen=True, eq=False, kw_only=True)
class Run:
    """One run, before it is driven.

    Attributes
    ----------
    name : of its axis, or of its number where several are driven
    axes : indices of the axes driven on purpose
    pattern : what is driven
    sweep : the sweep whose frequency is that of the moment; None where there are many at once
    levels : (6,) acceleration asked for [m/s², rad/s²]: amplitude of a sine, root mean square of noise; 0 where nothing is driven
    """

    name: str
    axes: tuple[int, ...]
    pattern: "Pattern"
    sweep: "Sweep | None"
    levels: Array

    def motion(self, rate: float, ring_down: float, cross: "CrossMotion | None") -> BaseMotion:
        """The run sampled at `rate` [Hz], with `ring_down` [s] of rest after it."""
        found: BaseMotion = self.pattern.motion(rate, ring_down=ring_down, cross=cross)  # type: ignore[attr-defined]
        return found


def runs(drive: TableDrive) -> tuple[Run, ...]:
    """The runs of `drive`, in the order in which they were asked for.

    The pattern ``multi`` is six runs of all six axes whose phases differ, or one run of the axes that were named.

    Raises
    ------
    BadInput : a band, a rate or a duration that the pattern cannot have.
    """
    from fem.base_excitation.patterns import Burst, MultiAxis, Random, Sweep, phased_sweeps

    band = {"start": drive.band[0], "stop": drive.band[1]}
    swept = {**band, "rate": drive.octaves_per_minute}
    lasting: dict[str, Any] = {**band, "seed": drive.seed, **({} if drive.duration is None else {"duration": drive.duration})}

    if drive.pattern == MULTI and drive.every:
        phased = phased_sweeps(drive.level, **swept)
        return tuple(_run(drive, f"multi-{k}", MOTIONS, one, one.patterns[0]) for k, one in enumerate(phased, start=1))
    if drive.pattern == MULTI:
        phases = 2 * np.pi * np.arange(len(drive.axes)) / len(drive.axes)
        listed = zip(drive.axes, phases, strict=True)
        each = tuple(Sweep(axis=axis, level=drive.level, phase=float(phase), **swept) for axis, phase in listed)
        return (_run(drive, "multi", drive.axes, MultiAxis(patterns=each), each[0]),)
    strength = {axis: {axis: drive.level * LEVELS[axis]} for axis in drive.axes}
    if drive.pattern == RANDOM:
        return tuple(_run(drive, axis, (axis,), Random(rms=rms, **lasting), None) for axis, rms in strength.items())
    if drive.pattern == BURST:
        return tuple(_run(drive, axis, (axis,), Burst(level=level, **lasting), None) for axis, level in strength.items())
    sweeps = [Sweep(axis=axis, level=drive.level, **swept) for axis in drive.axes]
    return tuple(_run(drive, one.axis, (one.axis,), one, one) for one in sweeps)


def _run(drive: TableDrive, name: str, axes: tuple[str, ...], pattern: "Pattern", sweep: Any) -> Run:
    levels = np.array([drive.level * LEVELS[axis] if axis in axes else 0.0 for axis in MOTIONS])
    return Run(name=name, axes=tuple(map(MOTIONS.index, axes)), pattern=pattern, sweep=sweep, levels=levels)


def cross_motion(drive: TableDrive) -> "CrossMotion | None":
    """What the table does besides, the same in every run; None for a table that does nothing else."""
    from fem.base_excitation.patterns import drawn

    return drawn(np.random.default_rng(drive.seed), drive.cross) if drive.cross else None


# Resonances of a whole rig: article on its joint on its cells, cables included, the table held.
#
# What is not linear is taken as it is while little moves: cells pressed together, loose parts held by their friction.


TABLE = 6


@dataclass(frozen=True, eq=False, kw_only=True)
class RigModes:
    """Modes of a rig with its table held, ascending, and what it weighs.

    Attributes
    ----------
    frequency : (k,) [Hz]
    damping_ratio : (k,) [1]
    participation : (6, k) about F, of mass-normalised modes
    rigid_mass : (6, 6) of all that the table carries, about F
    resonance : (k,) whether it is one; the others carry what the modes left out answer statically
    """

    frequency: Array
    damping_ratio: Array
    participation: Array
    rigid_mass: Array
    resonance: tuple[bool, ...]

    def __post_init__(self) -> None:
        k = np.size(self.frequency)
        freeze(self, frequency=(k,), damping_ratio=(k,), participation=(6, k), rigid_mass=(6, 6))


def rig_modes(rig: Rig) -> RigModes:
    """The modes of `rig`.

    Raises
    ------
    BadInput : a rig that cannot be built.
    """
    from scipy.linalg import eigh

    from fem.base_excitation.rig import matrices

    linear = replace(rig, frictions=(), cells=tuple(replace(cell, preload=None) for cell in rig.cells))
    made = matrices(linear)
    table, rest = slice(None, TABLE), slice(TABLE, None)
    squares, Phi = (
        eigh(made.stiffness[rest, rest], made.mass[rest, rest]) if len(made.mass) > TABLE else (np.zeros(0), np.zeros((0, 0)))
    )
    omega = np.sqrt(np.maximum(squares, np.finfo(np.float64).tiny))
    viscous = np.einsum("ir,ij,jr->r", Phi, made.viscous[rest, rest], Phi)
    # (k,) twice the strain energy of mass-normalised `Phi` (n, k) in the coordinates beside the article's kept modes
    stiffness = made.stiffness[rest, rest]
    beside = len(rig.article.reduced.mass) - TABLE - len(rig.article.kept)
    own = slice(len(stiffness) - beside, None)
    carried = np.asarray(np.einsum("ir,ij,jr->r", Phi[own], stiffness[own, own], Phi[own]))
    # (6, 6) what the loose parts add while they are held: point masses at the article's origin
    G = rigid_transformation(rig.seat)
    loose = np.asarray(sum(friction.mass for friction in rig.frictions) * (G.T @ G))
    return RigModes(
        frequency=omega / (2 * np.pi),
        damping_ratio=viscous / (2 * omega),
        participation=made.mass[table, rest] @ Phi,
        rigid_mass=made.mass[table, table] + loose,
        resonance=tuple((carried < omega**2 / 2).tolist()),
    )
