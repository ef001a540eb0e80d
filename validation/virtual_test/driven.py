"""One run: the rig driven, read by the sensors, delayed, filtered and brought down to the rate of the record.

All of it goes block by block, so that the memory of a run is that of its record. Only an effect on the signals of the simulation
needs them whole: then table, cover plate and cells are kept as well, for the effect to look at.
"""

from __future__ import annotations

from collections.abc import Iterator

import numpy as np

from fem.base_excitation.decimation import decimated_channels, joined, simulation_rate
from fem.base_excitation.driven_states import Channels, accelerations, cell_forces, load, stacked
from fem.base_excitation.response import Response
from fem.base_excitation.rig_structure import RigStructure
from fem.base_excitation.streamed import Piece, streamed
from geometry.arrays import Array
from validation.virtual_test import nonlinear
from validation.virtual_test.chain_truth import CELLS
from validation.virtual_test.hooks import Sensed, changed_signals, same
from validation.virtual_test.laboratory import Laboratory
from validation.virtual_test.plan import Plan
from validation.virtual_test.runs import DrivenRun, cross_motion
from validation.virtual_test.sensors import channels, tilted
from validation.virtual_test.streams import stream

WIDTHS = (6, 6, 3 * CELLS)
"""Signals of load, cover plate and cells."""


def record(plan: Plan, lab: Laboratory, run: DrivenRun) -> Array:
    """What the recorder gets of `run`, (m, c) at the rate of the record, without noise.

    Raises
    ------
    BadInput, CheckFailed : as `fem.base_excitation.streamed.streamed`.
    """
    if not lab.rig.linear or any(effect.signals is not same for effect in plan.effects):
        sensed = changed_signals(whole(plan, lab, run), plan.effects)
        return decimated_channels(sensed.values, sensed.sampling_rate, plan.rate, lab.sensors.delay)
    rate = _rate(plan)
    blocks = (_read(lab, piece) for piece in _pieces(plan, lab, run, rate, with_response=False))
    return joined(blocks, round(rate / plan.rate), lab.sensors.delay * rate)


def whole(plan: Plan, lab: Laboratory, run: DrivenRun) -> Sensed:
    """What all sensors read in `run` at the rate of the simulation, and what there was to read."""
    rate, pieces = _rate(plan), []
    if not lab.rig.linear:
        response, values = nonlinear.respond(plan, lab, run, rate)
        return sensed(plan, lab, run, values, rate, response)
    for piece in _pieces(plan, lab, run, rate, with_response=True):
        pieces.append((_read(lab, piece), piece.motion[2], piece.values[len(lab.sensors.rows) :]))
    values, table, rest = (np.hstack(one).T for one in zip(*pieces, strict=True))
    loads, cover, cells = np.split(rest, np.cumsum(WIDTHS)[:-1], axis=1)
    response = Response(sampling_rate=rate, table=table, cover=cover, load=loads, cells=cells.reshape(len(cells), CELLS, 3))
    return sensed(plan, lab, run, values, rate, response)


def sensed(plan: Plan, lab: Laboratory, run: DrivenRun, values: Array, rate: float, response: Response | None = None) -> Sensed:
    """`values` (n, c) of `run` as effects get them."""
    what = "record" if response is None else "signals"
    return Sensed(
        values=values,
        table=lab.layout.table,
        sampling_rate=rate,
        run=run.name,
        level=run.level,
        response=response,
        generator=stream(plan.seed, "effects", plan.article, run.name, what),
    )


def _rate(plan: Plan) -> float:
    return simulation_rate(plan.rate, plan.simulation_rate)


def _pieces(plan: Plan, lab: Laboratory, run: DrivenRun, rate: float, *, with_response: bool) -> Iterator[Piece]:
    def wanted(structure: RigStructure) -> Channels:
        read = channels(lab.sensors, structure)
        cover = accelerations(structure.cover, "the cover plate")
        return stacked([read, load(structure), cover, cell_forces(structure)]) if with_response else read

    return streamed(lab.rig, run.pattern, rate, wanted, cross=cross_motion(plan, run.name), quiet=plan.quiet, share=plan.ringing)


def _read(lab: Laboratory, piece: Piece) -> Array:
    """(c, k) what the channels read in `piece`."""
    return np.asarray(piece.values[: len(lab.sensors.rows)] + tilted(lab.sensors, piece.motion))
