"""From what table, cover plate and load cells do to what 22 sensors read: true places, directions, gains and summation.

Every channel is a weighted sum of 28 signals: six accelerations of the table, six of the cover plate, three forces of each of
four cells, and two tilts of the table and of the cover plate, which only count where one half of gravity is switched off.

With both halves on, the motion of a virtual test is the *apparent* acceleration, which the structure feels and the accelerometers
sense alike. With alpha and beta the tilt, apparent and kinematic acceleration differ by

    a_x (kinematic) = a_x (apparent) + g beta,    a_y (kinematic) = a_y (apparent) - g alpha.
"""

from collections.abc import Mapping
from dataclasses import dataclass, field, replace
from functools import lru_cache
from types import MappingProxyType
from typing import TYPE_CHECKING

import numpy as np

from fem.base_excitation.first_order_hold import Channels, cell_forces
from fem.base_excitation.rig import Rig, RigStructure
from geometry.articles import NAMES, built_in, changes_of, locations
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array, freeze, rigid_transformation, rigid_transformation_6, rotation_by
from geometry.inertia import Inertia
from geometry.sensors import Channel
from geometry.toml_file import nearest
from validation.virtual_test.layout import CELLS, ChainTruth, Layout, letter
from validation.virtual_test.plan import RIGID, Part, Plan

if TYPE_CHECKING:
    from fem.modes import Modes
    from fem.structure import Structure
    from validation.excite.rig import ArticleOnTable
    from validation.flexible.model import Flexible


AXES = "xyz"
TABLE, COVER, FORCES = slice(0, 6), slice(6, 12), slice(12, 12 + 3 * CELLS)
TABLE_TILT, COVER_TILT = slice(24, 26), slice(26, 28)
WIDTH = 28

MOTION_OF: Mapping[str, tuple[slice, slice]] = {
    "table": (TABLE, TABLE_TILT),
    "cover": (COVER, COVER_TILT),
    "article": (COVER, COVER_TILT),
}


@dataclass(frozen=True, eq=False, kw_only=True)
class Sensors:
    """Rows (c, 28) of all channels on the signals of the head of this file, and `delay` (c,) [s]; `upon` has by channel the place
    on the article that moves it, and along what (3,), its gain in it."""

    rows: Array
    delay: Array
    upon: Mapping[int, tuple[str, Array]] = field(default_factory=lambda: MappingProxyType({}))

    def __post_init__(self) -> None:
        freeze(self, "delay", rows=(len(self.delay), WIDTH))

    @classmethod
    def of(cls, layout: Layout, chain: ChainTruth, gravity: float) -> "Sensors":
        """The sensors of `layout` as `chain` says they are; `gravity` in m/s²."""
        channels = layout.table.channels
        rows = np.array([_row(channel, layout, chain, gravity) for channel in channels])
        gains = np.array([1 + chain.gain.get(channel.name, 0.0) for channel in channels])
        delay = np.array([chain.delay.get(channel.name, 0.0) for channel in channels])
        upon = {
            k: (channel.name[:-2], gains[k] * _direction(channel, chain))
            for k, channel in enumerate(channels)
            if channel.group == "article"
        }
        return cls(rows=gains[:, None] * rows, delay=delay, upon=upon)

    def channels(self, structure: RigStructure) -> Channels:
        """What all channels read, undelayed, as sums of the motions of a rig."""
        table, forces = np.eye(6, structure.mass.shape[0]), cell_forces(structure)
        rows = self.rows
        acceleration = rows[:, TABLE] @ table + rows[:, COVER] @ structure.cover
        for k, (place, direction) in self.upon.items():
            acceleration[k] += direction @ structure.places[place]
        return Channels(
            names=tuple(f"channel {number}" for number in range(1, len(rows) + 1)),
            acceleration=acceleration,
            velocity=rows[:, FORCES] @ forces.velocity,
            displacement=rows[:, FORCES] @ forces.displacement
            + rows[:, COVER_TILT] @ structure.cover[3:5]
            + rows[:, TABLE_TILT] @ table[3:5],
        )


def _row(channel: Channel, layout: Layout, chain: ChainTruth, gravity: float) -> Array:
    row = np.zeros(WIDTH)
    if channel.quantity == "force":
        # A summation of cells; cross-talk of the resultants in equal parts; cell moments that nobody measures
        axis = AXES.index(letter(channel.name))
        alike = sum(letter(other.name) == AXES[axis] for other in layout.table.channels if other.quantity == "force")
        cells = np.zeros((CELLS, 3))
        cells[list(layout.cells_of(channel)), axis] = 1.0
        cells += chain.crosstalk[axis] / alike
        if axis == AXES.index("z"):
            # What a lateral force does that acts `plane_offset` h off the plane:
            # M_y = -sum x f_z loses h_x F_x and M_x = sum y f_z gains h_y F_y
            place = layout.cells[layout.cells_of(channel)[0], :2]
            cells[:, :2] += chain.plane_offset * place / np.sum(layout.cells[:, :2] ** 2, axis=0)
        row[FORCES] = cells.ravel()
        return row
    direction, beside = _direction(channel, chain), chain.position.get(channel.name, np.zeros(3))
    motion, tilt = MOTION_OF[channel.group]
    if channel.group == "article":  # its place moves it; beside that it turns with the cover plate
        row[motion] = direction @ (rigid_transformation(beside) - rigid_transformation(np.zeros(3)))
    else:
        row[motion] = direction @ rigid_transformation(channel.places[0].position + beside - layout.table.origin)
    row[tilt] = (chain.gravity - chain.accelerometer_tilt) * gravity * np.array([-direction[1], direction[0]])
    return row


def _direction(channel: Channel, chain: ChainTruth) -> Array:
    """(3,) along which an accelerometer really measures."""
    return np.asarray(rotation_by(chain.angle.get(channel.name, np.zeros(3))) @ channel.places[0].direction)


CELLS_LOSE = 0.01
"""Loss factor of load cells where all that they carry swings on them along an axis."""


def on_table(
    plan: Plan,
    sensors: Sensors,
    chain: ChainTruth,
    fmd: tuple[Inertia | None, Array | None],
    seat: Array,
    frequency: Array,
    moved: ComplexArray,
    carried: ComplexArray,
) -> ComplexArray:
    """(n, c, 6) what all channels, first those on an article, read of a unit of each motion of the table.

    On an FMD with cells of stiffness k_i at rows G_i, K = sum of G_i^T k_i G_i and the dynamic mass H of all above, a unit of
    the table moves the plate by (K - omega² H)^-1 K, and cell i bears k_i G_i K^-1 H of that.

    Parameters
    ----------
    fmd : its moving part about F as nominal, None without one, and (3,) [N/m] of a cell, None for those of the drawing
    seat : (3,) [m] from F, where the article's base is
    moved, carried : (n, a, 6), (n, 6, 6) what pick-ups on the article read, and its dynamic mass, both of its base's motions
    """
    from fem.beam.articles import load_cells

    omega, X = 2 * np.pi * frequency[:, None, None], rigid_transformation_6(seat)
    signals = np.zeros((len(frequency), WIDTH, 6), dtype=np.complex128)
    signals[:, TABLE] = plate = np.broadcast_to(np.eye(6), (len(frequency), 6, 6))
    if fmd[0] is not None:
        H = X.T @ carried @ X + plan.drawn_moving_part(fmd[0].about(np.zeros(3))).mass_matrix
        k = load_cells({}) if fmd[1] is None else np.tile(fmd[1], (CELLS, 1))
        k = (k * (1 + chain.cell_stiffness) / chain.compliance[[0, 0, 1]]).reshape(-1, 1)
        k = k + 1j * omega * CELLS_LOSE * np.sqrt(k * H[0, 0, 0].real / CELLS)
        G = np.vstack([rigid_transformation(one) for one in middles_of_cells(plan)])
        K = G.T @ (k * G)
        plate = np.linalg.solve(K - omega**2 * H, K)
        signals[:, FORCES] = k * G @ np.linalg.solve(K, H @ plate)
    signals[:, COVER] = plate
    read = sensors.rows @ signals
    read[:, : moved.shape[1]] += moved @ X @ plate
    return np.asarray(read * np.exp(-1j * omega * sensors.delay[:, None]))


def accelerometers(plan: Plan) -> dict[str, Array]:
    """(3,) [m] from F, where the accelerometers of `plan` on its article sit, by name.

    Raises
    ------
    BadInput : a point that the article has not.
    """
    there, found = locations(plan.article, changes_of(plan.article, plan.dimensions)), {}
    for point in plan.on_article:
        place, _, axis = point.partition(":")
        if place not in there or axis not in tuple(AXES) or f"{place}-{axis}" in found:
            problem = f"must be a place of {plan.article} and x, y or z, each once, found {point!r}"
            raise BadInput("--response", "", problem, f"{nearest(place, there)}Write for example mast-top:x")
        found[f"{place}-{axis}"] = np.asarray(there[place])
    return found


# What stands on the table in a virtual test: the stack of the plan with the FMD, the cells and the parts that its seed draws.


FMD = "fmd"

MODES = 40
"""Asked for at most; those above `Plan.highest` answer statically."""

ONE_SHEET = ("-bottom", "-top")
"""Endings of parts that are one sheet of material: they are drawn as one."""


@dataclass(frozen=True, eq=False, kw_only=True)
class SetUp:
    """What stands on the table.

    Attributes
    ----------
    rig : as it is driven, effects of the plan not yet in it
    modes : of the article above the FMD, its base held; None for the FMD alone or a rigid article
    parts : what was drawn for each part of the structure
    """

    rig: Rig
    modes: "Modes | None"
    parts: Mapping[str, Part]


def set_up(plan: Plan, chain: ChainTruth) -> SetUp:
    """The rig of `plan`, with the cells that `chain` says.

    Raises
    ------
    BadInput : no stack on the FMD, or one that cannot be built.
    """
    require_stack(plan.article)
    mounted, parts = _mounted(plan)
    cover = plan.drawn_moving_part(nominal_fmd(plan))
    lateral, vertical = chain.compliance
    factors = (1 + chain.cell_stiffness) / np.array([lateral, lateral, vertical])
    cells = tuple(  # each with its own stiffness, and its damping in proportion
        replace(cell, stiffness=cell.stiffness * factor, damping=cell.damping * factor)
        for cell, factor in zip(mounted.rig.cells, factors, strict=True)
    )
    if not plan.on_fmd:
        from fem.base_excitation import rig as body

        # The FMD alone: cover plate and article are one half of it each
        half = cover.scaled(0.5)
        bare = replace(mounted.rig, article=body.rigid(FMD, half), cover=half, cells=cells)
        return SetUp(rig=bare, modes=None, parts=parts)
    modes = None if plan.model == RIGID or mounted.model is None else mounted.model.modes
    return SetUp(rig=replace(mounted.rig, cover=cover, cells=cells), modes=modes, parts=parts)


def require_stack(article: str) -> None:
    """Refuse what does not stand on the FMD.

    Raises
    ------
    BadInput : an unknown part, or a stack that does not begin with the FMD.
    """
    first = article.split("+")[0]
    if first in NAMES and first != FMD:
        problem = f"the virtual shaker measures by the FMD, which must be the lowest of the stack, found {article}"
        raise BadInput(f"article {article}", "", problem, f"Name {FMD}+{article}")
    built_in(article)


def parts_of(plan: Plan) -> tuple[str, ...]:
    """Parts of the structure that stands on the FMD; none of a rigid one, and none of the FMD alone."""
    if not plan.on_fmd or plan.model == RIGID:
        return ()
    structure = _nominal(plan.on_fmd, tuple(sorted(changes_of(plan.on_fmd, plan.dimensions).items()))).structure
    return () if structure is None else tuple(dict.fromkeys(_sheet(name) for name in structure.part_stiffness))


def middles_of_cells(plan: Plan) -> Array:
    """(4, 3) [m] middles of the FMD's load cells."""
    from geometry.article import rectangle
    from geometry.articles.parts import load

    side = load(FMD, changes_of(FMD, plan.dimensions))["load_cell"]["square"]
    return np.array([[x, y, 0.0] for x, y in rectangle(side, side)])


def nominal_fmd(plan: Plan) -> Inertia:
    """Inertia of the FMD's moving part as drawn, about F."""
    from geometry.routes import inertia

    return inertia(built_in(FMD, changes_of(FMD, plan.dimensions)))


def _mounted(plan: Plan) -> "tuple[ArticleOnTable, dict[str, Part]]":
    """The nominal rig but for the parts of the structure, and what was drawn for these."""
    from validation.excite.question import Attached
    from validation.excite.rig import assembled, mounted
    from validation.flexible.model import FlexibleOptions

    asked, attached = FlexibleOptions(count=MODES, damping=plan.damping, changes=plan.dimensions), Attached(cells=True)
    if not plan.on_fmd:
        return mounted(plan.article, "beam", asked, attached), {}
    nominal = _nominal(plan.on_fmd, tuple(sorted(changes_of(plan.on_fmd, plan.dimensions).items())))
    if plan.model == RIGID:
        return assembled(plan.article, nominal, asked, attached, highest=0.0), {}
    from fem.modes import fixed_base

    # The model with the moduli and the damping of `plan.seed`
    if nominal.structure is None:
        made, parts = nominal, {}
    else:
        scattered: Mapping[str, Part] = {name: plan.drawn_part(_sheet(name)) for name in nominal.structure.part_stiffness}
        for effect in plan.effects:
            scattered = effect.parts(scattered)
        structure = _stiffened(nominal.structure, scattered)
        kept = int(np.sum(nominal.modes.frequency <= _highest(plan, nominal.modes)))
        # The damping that the plan states, scattered where it is given by mode
        if plan.damping is None or plan.damping.ratio is None:
            damping = plan.damping
        else:
            ratio = np.broadcast_to(np.asarray(plan.damping.ratio, dtype=np.float64), (kept,))
            damping = replace(plan.damping, ratio=ratio * plan.drawn_damping(kept))
        modes = fixed_base(structure, kept, damping=damping)
        made = replace(nominal, structure=structure, modes=modes)
        parts = {_sheet(name): part for name, part in scattered.items()}
    return assembled(plan.article, made, asked, attached, highest=_highest(plan, made.modes)), parts


@lru_cache(maxsize=8)
def _nominal(above: str, dimensions: tuple[tuple[str, float], ...]) -> "Flexible":
    """The model as drawn, the same for every seed."""
    from validation.flexible.model import FlexibleOptions, flexible

    return flexible(above, "beam", FlexibleOptions(count=MODES, changes=dict(dimensions)))


def _stiffened(structure: "Structure", parts: Mapping[str, Part]) -> "Structure":
    """`structure` with every part's stiffness and loss factor changed; itself where nothing was drawn."""
    if not any(part.modulus or part.loss or part.added_loss for part in parts.values()):
        return structure
    stiffness = {name: (1 + parts[name].modulus) * matrix for name, matrix in structure.part_stiffness.items()}
    first, *others = stiffness.values()
    losses = {name: (1 + parts[name].loss) * eta + parts[name].added_loss for name, eta in structure.loss_factors.items()}
    return replace(structure, stiffness=sum(others, start=first), part_stiffness=stiffness, loss_factors=losses)


def _highest(plan: Plan, modes: "Modes") -> float:
    """[Hz] up to which modes are kept: the first one always is, or a stiff article would be a rigid one."""
    return max(plan.highest, 1.25 * float(modes.frequency[0]))


def _sheet(part: str) -> str:
    for ending in ONE_SHEET:
        part = part.removesuffix(ending)
    return part
