"""Stiffness that weight gives or takes: storeys that stand, or hang, under gravity."""

from collections.abc import Mapping
from dataclasses import dataclass

import numpy as np

from fem.structure import Sparse, Structure
from geometry.errors import BadInput
from geometry.toml_file import STANDARD_GRAVITY

# A column of height h that carries the weight W and leans by u pushes sideways with W u / h, and a clamped column, which bends as
# it leans, with 6/5 of that (J. S. Przemieniecki, Theory of Matrix Structural Analysis, 1968, chapter 15):
#
#     K_G = -beta W/h sum over the two lateral axes of (r_above - r_below)^T (r_above - r_below),   beta = 6/5 clamped, 1 hinged.
#
# Other codes write geometric stiffness of any element; what they wrote goes into `Structure.geometric` as it is.

CLAMPED = 6 / 5
"""Of a column whose ends do not turn: its deflection is the cubic of a beam."""

GROUND = "ground"
"""Where the lowest storey stands."""

FLOATING = 1e-9
"""Share of a part's own stiffness below which what is left ties nothing to the ground."""


@dataclass(frozen=True, kw_only=True)
class Storey:
    """Columns between two places, one straight above the other.

    Attributes
    ----------
    below, above : names of places; `GROUND` for what does not move
    height : [m]; negative where `above` hangs from `below`
    weight : [N] that the columns carry; None for that of all that stands on them
    hinged : whether the ends of the columns turn freely
    """

    below: str
    above: str
    height: float
    weight: float | None = None
    hinged: bool = False


def geometric(structure: Structure, storeys: Mapping[str, Storey], vertical: int = 2, source: str = "") -> dict[str, Sparse]:
    """Geometric stiffness (n, n) of `storeys`, by the part of the structure that each is, under standard gravity.

    Parameters
    ----------
    vertical : 0, 1 or 2, the axis along which gravity acts
    source : the file whose `fe_model.storeys` they are, for messages

    Raises
    ------
    BadInput : a part or place that the structure has not, a height of 0, a weight that must be stated.
    """
    from scipy.sparse import csr_array

    made, lateral = {}, [axis for axis in range(3) if axis != vertical]
    for part, storey in storeys.items():
        field = f"fe_model.storeys.{part}"
        if part not in structure.part_stiffness:
            known = ", ".join(structure.part_stiffness) or "none: write stiffness/NAME"
            raise BadInput(source, field, "there is no part of this name", f"Parts are {known}")
        for place in (storey.below, storey.above):
            if place not in (GROUND, *structure.places):
                remedy = f"Places are {', '.join((GROUND, *structure.places))}"
                raise BadInput(source, field, f"no place is called {place!r}", remedy)
        if not np.isfinite(storey.height) or storey.height == 0:
            problem = f"a height that is not 0 is needed, found {storey.height:g} m"
            raise BadInput(source, field, problem, "State it, negative where it hangs")
        weight = storey.weight
        if weight is None and not (weight := carried(structure, part, lateral[0])):
            problem = "what it carries is carried by other parts, too, or nothing is said of how it moves"
            raise BadInput(source, field, problem, 'State it: weight = "20 N"')
        leans = sum(
            sign * csr_array(structure.places[place])[lateral]
            for place, sign in ((storey.above, 1.0), (storey.below, -1.0))
            if place != GROUND
        )
        share = (1.0 if storey.hinged else CLAMPED) * weight / storey.height
        made[part] = csr_array(-share * (leans.T @ leans))
    return made


def carried(structure: Structure, part: str, axis: int = 0) -> float:
    """Weight [N] of all that nothing but `part` keeps from drifting along `axis`; 0 where something else does, too, or the model
    does not say what moves along that axis."""
    from scipy.sparse import csr_array
    from scipy.sparse.csgraph import connected_components

    free, drift = structure.free, np.zeros(structure.mass.shape[0])
    drift[free] = structure.rigid[free, axis]
    left = csr_array(structure.stiffness - structure.part_stiffness[part])
    left.data[np.abs(left.data) <= FLOATING * np.abs(structure.stiffness).max()] = 0.0
    left.eliminate_zeros()
    count, label = connected_components(left, directed=False)
    mass = 0.0
    for k in range(count):
        moved = np.where(label == k, drift, 0.0)
        work = np.abs(moved) @ (abs(left) @ np.abs(moved))
        if np.any(moved) and abs(moved @ (left @ moved)) <= FLOATING * max(work, 0.0):
            mass += float(moved @ (structure.mass @ moved))
    return STANDARD_GRAVITY * max(mass, 0.0)
