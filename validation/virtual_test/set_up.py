"""What stands on the table in a virtual test: the stack of the plan with the FMD, the cells and the parts that its seed draws."""

from __future__ import annotations

from collections.abc import Mapping
from dataclasses import dataclass, replace
from functools import lru_cache
from typing import TYPE_CHECKING

import numpy as np

from fem.base_excitation.rig import Cell, Rig
from geometry.arrays import Array
from geometry.articles import NAMES, built_in, changes_of
from geometry.errors import BadInput
from geometry.inertia import Inertia
from validation.virtual_test import drawn
from validation.virtual_test.chain_truth import ChainTruth
from validation.virtual_test.hooks import changed_parts
from validation.virtual_test.plan import RIGID, Plan

if TYPE_CHECKING:
    from fem.damping import Damping
    from fem.modes import Modes
    from fem.structure import Structure
    from validation.excitation.rig import Mounted
    from validation.flexible.model import Flexible

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
    modes: Modes | None
    parts: Mapping[str, drawn.Part]


def set_up(plan: Plan, chain: ChainTruth) -> SetUp:
    """The rig of `plan`, with the cells that `chain` says.

    Raises
    ------
    BadInput : no stack on the FMD, or one that cannot be built.
    """
    require_stack(plan.article)
    mounted, parts = _mounted(plan)
    cover = drawn.moving_part(plan, nominal_fmd(plan))
    cells = tuple(_cell(cell, chain, number) for number, cell in enumerate(mounted.rig.cells))
    if not plan.on_fmd:
        return SetUp(rig=_bare(mounted.rig, cover, cells), modes=None, parts=parts)
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
        raise BadInput(source=f"article {article}", problem=problem, remedy=f"Name {FMD}+{article}")
    built_in(article)


def parts_of(plan: Plan) -> tuple[str, ...]:
    """Parts of the structure that stands on the FMD; none of a rigid one, and none of the FMD alone."""
    if not plan.on_fmd or plan.model == RIGID:
        return ()
    structure = _nominal(plan.on_fmd, tuple(sorted(changes_of(plan.on_fmd, plan.dimensions).items()))).structure
    return () if structure is None else tuple(dict.fromkeys(_sheet(name) for name in structure.part_stiffness))


def middles_of_cells(plan: Plan) -> Array:
    """(4, 3) [m] middles of the FMD's load cells."""
    from geometry.articles.dimensions import load
    from geometry.shapes import rectangle

    side = load(FMD, changes_of(FMD, plan.dimensions))["load_cell"]["square"]
    return np.array([[x, y, 0.0] for x, y in rectangle(side, side)])


def nominal_fmd(plan: Plan) -> Inertia:
    """Inertia of the FMD's moving part as drawn, about F."""
    from geometry.multibody import inertia

    return inertia(built_in(FMD, changes_of(FMD, plan.dimensions)))


def _mounted(plan: Plan) -> tuple[Mounted, dict[str, drawn.Part]]:
    """The nominal rig but for the parts of the structure, and what was drawn for these."""
    from validation.excitation.attached import Attached
    from validation.excitation.rig import assembled, mounted
    from validation.flexible.model import Asked

    asked, attached = Asked(count=MODES, damping=plan.damping, changes=plan.dimensions), Attached(cells=True)
    if not plan.on_fmd:
        return mounted(plan.article, "beam", asked, attached), {}
    nominal = _nominal(plan.on_fmd, tuple(sorted(changes_of(plan.on_fmd, plan.dimensions).items())))
    if plan.model == RIGID:
        return assembled(plan.article, nominal, asked, attached, highest=0.0), {}
    made, parts = _scattered(plan, nominal)
    return assembled(plan.article, made, asked, attached, highest=_highest(plan, made.modes)), parts


@lru_cache(maxsize=8)
def _nominal(above: str, dimensions: tuple[tuple[str, float], ...]) -> Flexible:
    """The model as drawn, the same for every seed."""
    from validation.flexible.model import Asked, flexible

    return flexible(above, "beam", Asked(count=MODES, changes=dict(dimensions)))


def _scattered(plan: Plan, nominal: Flexible) -> tuple[Flexible, dict[str, drawn.Part]]:
    """The model with the moduli and the damping of `plan.seed`."""
    from fem.modes import fixed_base

    if nominal.structure is None:
        return nominal, {}
    parts = changed_parts({name: drawn.part(plan, _sheet(name)) for name in nominal.structure.part_stiffness}, plan.effects)
    structure = _stiffened(nominal.structure, parts)
    kept = int(np.sum(nominal.modes.frequency <= _highest(plan, nominal.modes)))
    modes = fixed_base(structure, kept, damping=_damping(plan, kept))
    return replace(nominal, structure=structure, modes=modes), {_sheet(name): part for name, part in parts.items()}


def _stiffened(structure: Structure, parts: Mapping[str, drawn.Part]) -> Structure:
    """`structure` with every part's stiffness and loss factor changed; itself where nothing was drawn."""
    if not any(part.modulus or part.loss or part.added_loss for part in parts.values()):
        return structure
    stiffness = {name: (1 + parts[name].modulus) * matrix for name, matrix in structure.part_stiffness.items()}
    first, *others = stiffness.values()
    losses = {name: (1 + parts[name].loss) * eta + parts[name].added_loss for name, eta in structure.loss_factors.items()}
    return replace(structure, stiffness=sum(others, start=first), part_stiffness=stiffness, loss_factors=losses)


def _damping(plan: Plan, count: int) -> Damping | None:
    """The damping that the plan states, scattered where it is given by mode."""
    if plan.damping is None or plan.damping.ratio is None:
        return plan.damping
    ratio = np.broadcast_to(np.asarray(plan.damping.ratio, dtype=np.float64), (count,))
    return replace(plan.damping, ratio=ratio * drawn.damping_factors(plan, count))


def _highest(plan: Plan, modes: Modes) -> float:
    """[Hz] up to which modes are kept: the first one always is, or a stiff article would be a rigid one."""
    return max(plan.highest, 1.25 * float(modes.frequency[0]))


def _sheet(part: str) -> str:
    for ending in ONE_SHEET:
        part = part.removesuffix(ending)
    return part


def _bare(rig: Rig, moving: Inertia, cells: tuple[Cell, ...]) -> Rig:
    """The FMD alone: cover plate and article are one half of it each."""
    from fem.base_excitation import body

    half = moving.scaled(0.5)
    return replace(rig, article=body.rigid(FMD, half), cover=half, cells=cells)


def _cell(cell: Cell, chain: ChainTruth, number: int) -> Cell:
    """`cell` with its own stiffness, and its damping in proportion."""
    lateral, vertical = chain.compliance
    factor = (1 + chain.cell_stiffness[number]) / np.array([lateral, lateral, vertical])
    return replace(cell, stiffness=cell.stiffness * factor, damping=cell.damping * factor)
