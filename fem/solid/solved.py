"""Fixed-base modes of a large structure, remembered: what `fem.modes.fixed_base` takes minutes for is there at once next time.

Only what the matrices alone decide is kept. Damping is worked out afresh, so that another loss factor finds the same modes.
"""

from __future__ import annotations

from dataclasses import replace

import numpy as np

from fem import damping as damped
from fem import modes
from fem.damping import Damping
from fem.eigen import Progress
from fem.modes import Modes
from fem.solid import cache
from fem.structure import Sparse, Structure

_KEPT = ("frequency", "damping_ratio", "participation", "rigid_mass", "residual", "reference_point", "shapes", "viscous")


def fixed_base(
    structure: Structure,
    count: int = 30,
    *,
    damping: Damping | None = None,
    factoriser: str | None = None,
    progress: Progress | None = None,
) -> Modes:
    """`fem.modes.fixed_base` of `structure`, or the same from disk; arguments and errors are the same.

    Raises
    ------
    BadInput, CheckFailed : as `fem.modes.fixed_base`.
    """
    name = cache.key("modes", {"structure": cache.digest(_content(structure)), "count": count})
    kept = cache.load(name)
    if kept is None:
        solved = modes.fixed_base(structure, count, damping=Damping(ratio=0.0), factoriser=factoriser, progress=progress)
        cache.store(name, {field: getattr(solved, field) for field in _KEPT})
    else:
        solved = Modes(**kept)
    return _damped(solved, structure, damping or damped.default(structure))


def _damped(solved: Modes, structure: Structure, damping: Damping) -> Modes:
    omega = 2 * np.pi * solved.frequency
    C, S = damped.modal_matrices(damping, structure, omega, solved.shapes)
    return replace(solved, viscous=C, structural=S, damping_ratio=damped.equivalent_ratio(C, S, omega))


def _content(structure: Structure) -> dict[str, np.ndarray]:
    """All that the undamped modes depend on."""
    return {
        **{f"stiffness-{name}": array for name, array in _arrays(structure.stiffness).items()},
        **{f"mass-{name}": array for name, array in _arrays(structure.mass).items()},
        "rigid": structure.rigid,
        "held": structure.held,
        "reference_point": structure.reference_point,
    }


def _arrays(matrix: Sparse) -> dict[str, np.ndarray]:
    return {"data": matrix.data, "indices": matrix.indices, "starts": matrix.indptr}
