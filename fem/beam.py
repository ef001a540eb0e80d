"""Beam models of the built-in articles and their stacks, in milliseconds: the model that fitting uses.

Clumod is a frame, Cuboid and disc are stiff columns, the FMD's moving part is rigid. What stands on something stands on its top
node, rigidly. The base holds the lowest body: Clumod's flange, the foot of a column, the FMD's cover plate or, when its load
cells are springs, what is below them.
"""

from __future__ import annotations

from collections.abc import Mapping, Sequence
from functools import reduce
from types import MappingProxyType

import numpy as np
import numpy.typing as npt

from fem import beam_bodies, beam_clumod
from fem.beam_clumod import ELEMENTS, Joint
from fem.frame import Frame, Plan, assemble, on_top, placed
from fem.structure import Structure
from geometry.arrays import Array
from geometry.article import Article, prefixes
from geometry.articles import built_in, changes_of, clumod, dimension_files
from geometry.articles.dimensions import Dimensions, load
from geometry.errors import BadInput
from geometry.frames import Pose

NO_CHANGES: Mapping[str, float] = MappingProxyType({})
BASE = 6
"""The first degrees of freedom are those of the base."""

BLADES = {"clumod-1": clumod.ONE_BLADE, "clumod-4": clumod.FOUR_BLADES}


def structure(
    article_name: str,
    changes: Mapping[str, float] = NO_CHANGES,
    *,
    elements: int = ELEMENTS,
    cells: npt.ArrayLike | None = None,
    joints: Sequence[Joint] = (),
) -> Structure:
    """Beam model of the built-in article or stack called `article_name`, about its origin.

    Parameters
    ----------
    article_name, changes : as `geometry.articles.built_in` takes them
    elements : in a half-blade of Clumod; its mast has twice, a column three times as many
    cells : (4, 3) [N/m] stiffness of the FMD's load cells along x, y, z (`load_cells` gives assumed values); rigid when None
    joints : what a local model of Clumod's crossings adds

    Raises
    ------
    BadInput : an article, a dimension, a port or a material that cannot be used; the message says why.
    """
    return _structure(assemble(plan(article_name, changes, elements=elements, cells=cells, joints=joints)))


def plan(
    article_name: str,
    changes: Mapping[str, float] = NO_CHANGES,
    *,
    elements: int = ELEMENTS,
    cells: npt.ArrayLike | None = None,
    joints: Sequence[Joint] = (),
) -> Plan:
    """What the frame of `structure` is made of, from the same arguments; other programs make their own elements of it.

    Raises
    ------
    BadInput : as `structure`.
    """
    built_in(article_name, changes)  # checks names, order and changes of the whole stack
    names = article_name.split("+")
    _require_usable(article_name, names, elements, cells, joints)
    plans = [_plan(name, changes, elements, cells, joints) for name in names]
    return reduce(on_top, _in_place(names, plans, changes))


def load_cells(changes: Mapping[str, float] = NO_CHANGES) -> Array:
    """Assumed stiffness (4, 3) along x, y, z [N/m] of the FMD's load cells, from `fmd.toml`."""
    return beam_bodies.cell_stiffness(load("fmd", changes))


def build(blades: tuple[str, ...], dimensions: Dimensions, *, joints: Sequence[Joint] = (), elements: int = ELEMENTS) -> Frame:
    """Frame of Clumod with the `blades` named, from `dimensions` as `clumod.toml` has them; its base is the flange."""
    return assemble(beam_clumod.plan(blades, dimensions, joints=joints, elements=elements))


def frequencies(frame: Frame, count: int) -> Array:
    """The lowest `count` eigenfrequencies (count,) [Hz] with the base held, ascending."""
    from scipy.linalg import eigh

    K = sum(frame.stiffness.values(), np.zeros_like(frame.mass))
    n = len(K) - BASE
    # The largest of M x = mu K x: what an eigen-solver loses to rounding is a share of the largest value, and here that is ours.
    inverse = eigh(frame.mass[BASE:, BASE:], K[BASE:, BASE:], eigvals_only=True, subset_by_index=[n - count, n - 1])
    return np.asarray(1 / np.sqrt(inverse[::-1]) / (2 * np.pi))


def _plan(name: str, changes: Mapping[str, float], elements: int, cells: npt.ArrayLike | None, joints: Sequence[Joint]) -> Plan:
    """One article in its own frame."""
    (file,) = dimension_files(name)
    article, dimensions = _article(name, changes), load(file, changes)
    if name in BLADES:
        return beam_clumod.plan(BLADES[name], dimensions, joints=joints, elements=elements)
    if name == "fmd":
        return beam_bodies.fmd(article, dimensions, None if cells is None else beam_bodies.require_cells(cells))
    return {"cuboid": beam_bodies.cuboid, "disc": beam_bodies.disc}[name](article, dimensions, elements)


def _article(name: str, changes: Mapping[str, float]) -> Article:
    return built_in(name, changes_of(name, changes))


def _in_place(names: list[str], plans: list[Plan], changes: Mapping[str, float]) -> list[Plan]:
    """`plans` where the seats below them put them; seats have parallel axes. Names of parts as the stacked article has them."""
    if len(plans) == 1:
        return plans
    pose, in_place = Pose(), []
    for name, prefix, plan in zip(names, prefixes(names), plans, strict=True):
        in_place.append(placed(plan, pose.position, f"{prefix}/"))
        seat = _article(name, changes).seat
        pose = pose @ seat if seat else pose
    return in_place


def _structure(frame: Frame) -> Structure:
    from scipy.sparse import csr_array

    parts = {part: csr_array(k) for part, k in frame.stiffness.items()}
    moving = list(frame.moving)
    return Structure(
        stiffness=csr_array(sum(frame.stiffness.values(), np.zeros_like(frame.mass))),
        mass=csr_array(frame.mass),
        rigid=frame.rigid,
        held=np.arange(BASE),
        points=frame.plan.nodes[moving],
        translations=6 * np.arange(len(moving))[:, None] + np.arange(3),
        part_stiffness=MappingProxyType(parts),
        loss_factors=MappingProxyType(dict(frame.plan.loss_factors)),
    )


def _require_usable(whole: str, names: list[str], elements: int, cells: npt.ArrayLike | None, joints: Sequence[Joint]) -> None:
    if elements < 1:
        raise _refused(whole, "elements", f"at least one element is needed, found {elements}", "Give a whole number from 1 on")
    if cells is not None and "fmd" not in names:
        raise _refused(whole, "cells", "there is no FMD whose load cells could be springs", "Name a stack that begins with fmd")
    if joints and not BLADES.keys() & set(names):
        raise _refused(whole, "joints", "there is no Clumod whose crossings could have joints", "Leave the joints away")


def _refused(whole: str, field: str, problem: str, remedy: str) -> BadInput:
    return BadInput(source=f"article {whole}", field=field, problem=problem, remedy=remedy)
