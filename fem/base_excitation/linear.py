"""A linear rig on a driven base in time, by the exact recursion in its own modes: seconds for a sweep of a minute and a half.

Table, cover plate, load cells, places and the load on the table are sums of the states and of the motion of the table:

    y'' = -M_yy^-1 (K_yy y + C_yy y' + M_yt u'' + C_yt u' + K_yt u),    load = M_t x'' + C_t x' + K_t x.

The load is all that the table feels: through the load cells, and through what is tied to the table beside them.
"""

from __future__ import annotations

import numpy as np

from fem.base_excitation import ring_down
from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.driven_states import Channels, accelerations, cell_forces, driven, load, relative, run, stacked
from fem.base_excitation.recursion import Progress, States
from fem.base_excitation.response import Response
from fem.base_excitation.rig import Body, Rig
from fem.base_excitation.rig_structure import TABLE, RigStructure, matrices
from geometry.errors import BadInput

COARSEST = 8
"""Samples a period of the highest kept mode that straight lines between samples need; driven there, its answer lacks 5 %."""


def respond(rig: Rig, motion: BaseMotion, *, keep_coordinates: bool = False, progress: Progress | None = None) -> Response:
    """What `rig` does on a table that makes `motion`, at the sampling rate of the motion.

    Parameters
    ----------
    keep_coordinates : with those of `fem.base_excitation.rig_structure`, the table's left out
    progress : called with the share done

    Raises
    ------
    BadInput : a rig that is not linear or cannot be built, a sampling rate too coarse for a kept mode.
    CheckFailed : something on the table swings freely, or the answer grows beyond all numbers; with channel and time.
    """
    require_fine(rig.article, motion.sampling_rate)
    structure = matrices(rig)
    system = driven(structure)
    done = run(structure, system, _channels(structure, keep_coordinates), motion, progress)
    n, cells, names = len(done.samples), len(structure.cells), list(structure.places)
    widths = [TABLE, TABLE, 3 * cells, 3 * len(names)]
    loads, cover, forces, places, coordinates = np.split(done.samples, np.cumsum(widths), axis=1)
    warning = ring_down.judged(motion.driven + ring_down.lasting(structure, system, done), motion)
    return Response(
        sampling_rate=motion.sampling_rate,
        table=motion.acceleration,
        cover=cover,
        load=loads,
        cells=forces.reshape(n, cells, 3),
        places={name: places[:, 3 * k : 3 * k + 3] for k, name in enumerate(names)},
        coordinates=coordinates,
        reference_point=motion.reference_point,
        settings=_settings(rig.article, system, motion),
        warnings=(warning,) if warning else (),
    )


def require_fine(article: Body, sampling_rate: float) -> None:
    """Refuse a sampling rate too coarse for a kept mode.

    Raises
    ------
    BadInput : the rate that is needed is named.
    """
    highest = float(article.kept.max(initial=0.0))
    if sampling_rate < COARSEST * highest:
        where = "beyond half the sampling rate" if 2 * highest > sampling_rate else "sampled too coarsely"
        raise BadInput(
            source=f"simulation of {article.name}",
            field="sampling_rate",
            problem=f"the highest kept mode, {highest:.4g} Hz, is {where}, found {sampling_rate:g} Hz",
            remedy=f"Simulate at {np.ceil(COARSEST * highest):.0f} Hz or more, or keep fewer modes",
        )


def _channels(structure: RigStructure, keep_coordinates: bool) -> Channels:
    """Load, cover plate, cells, places and coordinates in this order."""
    places = [accelerations(rows, name) for name, rows in structure.places.items()]
    parts = [load(structure), accelerations(structure.cover, "the cover plate"), cell_forces(structure), *places]
    return stacked([*parts, relative(structure)] if keep_coordinates else parts)


def _settings(article: Body, system: States, motion: BaseMotion) -> dict[str, object]:
    import scipy

    return {
        "route": "recursion",
        "hold": "first order",
        "sampling_rate_hz": motion.sampling_rate,
        "modes": article.kept.size,
        "highest_mode_hz": float(article.kept.max(initial=0.0)),
        "coordinates": len(system.A) // 2,
        "numpy": np.__version__,
        "scipy": scipy.__version__,
    }
