"""`simulate`: a `Plan` becomes a `Campaign`, and the truth behind it.

    drawn chain and FMD -> rig -> driven in time -> sensors -> delays and anti-alias filter -> noise, mains -> campaign

The chain is linear from the table to the recorder but for what an effect makes of it. A sweep is simulated with `RING_DOWN` of
rest after it; where the article still rings then, it is simulated again with as much as it needs.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace

import numpy as np

from fem.base_excitation import linear
from fem.base_excitation.base_motion import BaseMotion
from fem.base_excitation.decimation import require_recorded, simulation_rate
from fem.base_excitation.response import Response
from fem.base_excitation.rig import Rig
from geometry.arrays import Array
from geometry.frames import Pose
from identification.campaign import Campaign, Run
from identification.recording import Recording
from validation.virtual_test import drawn
from validation.virtual_test.chain_truth import ChainTruth
from validation.virtual_test.hooks import Sensed, changed_chain, changed_record, changed_rig, changed_signals
from validation.virtual_test.layout import Layout, mavis
from validation.virtual_test.plan import SOURCE, Plan
from validation.virtual_test.recorder import disturbed, recorded
from validation.virtual_test.runs import DrivenRun, cross_motion, runs
from validation.virtual_test.sensors import Sensors, needs_tilt, read, sensors
from validation.virtual_test.set_up import SetUp, middles_of_cells, set_up
from validation.virtual_test.streams import stream, token
from validation.virtual_test.truth import truth

Progress = Callable[[float], None]
"""Called with the share done, 0 to 1; it may raise to end the work."""

RING_DOWN = 8.0
"""[s] of rest after the drive that is tried first."""


@dataclass(frozen=True, eq=False, kw_only=True)
class VirtualTest:
    """A campaign and what nobody would know of a real one; `truth` holds JSON values only."""

    campaign: Campaign
    truth: Mapping[str, object]


@dataclass(frozen=True, eq=False, kw_only=True)
class Laboratory:
    """What is on the shaker: the drawn chain and the rig, effects in both, and the nominal layout."""

    layout: Layout
    chain: ChainTruth
    made: SetUp
    rig: Rig
    sensors: Sensors


def simulate(plan: Plan, progress: Progress | None = None) -> VirtualTest:
    """The virtual test of `plan`.

    Raises
    ------
    BadInput : an article that does not stand on the FMD or cannot be built, a band, rate or cross motion that cannot be.
    CheckFailed : something on the table swings freely.
    """
    driven = runs(plan)
    require_recorded(max(run.pattern.highest for run in driven), plan.rate, SOURCE)
    lab = laboratory(plan)
    recordings = {}
    for k, run in enumerate(driven):
        recordings[run.name] = record(plan, lab, run)
        if progress is not None:
            progress((k + 1) / len(driven))
    campaign = _campaign(plan, lab, driven, recordings)
    return VirtualTest(campaign=campaign, truth=truth(plan, lab.chain, lab.made, lab.rig))


def laboratory(plan: Plan) -> Laboratory:
    """What `plan` has on the shaker.

    Raises
    ------
    BadInput : an article that does not stand on the FMD or cannot be built.
    """
    layout = mavis(middles_of_cells(plan), plan.noise_rms)
    chain = changed_chain(drawn.chain(plan, layout), plan.effects)
    made = set_up(plan, chain)
    rig = changed_rig(made.rig, plan.effects)
    return Laboratory(layout=layout, chain=chain, made=made, rig=rig, sensors=sensors(layout, chain, plan.gravity))


def record(plan: Plan, lab: Laboratory, run: DrivenRun) -> Recording:
    """What the recorder of `lab` holds after `run`."""
    response, tilt = _driven(plan, lab, run)
    names, generator = lab.layout.table.names, stream(plan.seed, "effects", plan.article, run.name)
    sensed = Sensed(
        values=read(lab.sensors, response, tilt),
        table=lab.layout.table,
        sampling_rate=response.sampling_rate,
        run=run.name,
        level=run.level,
        response=response,
        generator=generator,
    )
    sensed = changed_signals(sensed, plan.effects)
    samples = recorded(sensed.values, response.sampling_rate, plan, lab.sensors.delay)
    samples = disturbed(samples, names, lab.chain, plan, run.name)
    sensed = changed_record(replace(sensed, values=samples, sampling_rate=plan.rate), plan.effects)
    return Recording(names=names, values=sensed.values, sampling_rate=plan.rate, source=run.name)


def _driven(plan: Plan, lab: Laboratory, run: DrivenRun) -> tuple[Response, Array | None]:
    """What the rig did in `run`, its ringing included, and the tilt of table and cover plate (n, 4) [rad] where it counts."""
    tilts, rest = needs_tilt(lab.chain), RING_DOWN
    while True:
        motion = _motion(plan, run, rest + plan.quiet)
        response = linear.respond(lab.rig, motion, keep_coordinates=tilts)
        if not response.warnings:
            break
        rest *= 2
    return response, _tilt(motion, response) if tilts else None


def _motion(plan: Plan, run: DrivenRun, rest: float) -> BaseMotion:
    rate = simulation_rate(plan.rate, plan.simulation_rate)
    found: BaseMotion = run.pattern.motion(rate, ring_down=rest, cross=cross_motion(plan, run.name))  # type: ignore[attr-defined]
    return found


def _tilt(motion: BaseMotion, response: Response) -> Array:
    table = motion.displacement[:, 3:5]
    return np.hstack([table, table + response.coordinates[:, 3:5]])


def _campaign(plan: Plan, lab: Laboratory, driven: tuple[DrivenRun, ...], recordings: Mapping[str, Recording]) -> Campaign:
    return Campaign(
        title=f"Virtual test of {plan.article}",
        article=plan.article,
        hardware=f"fmd-{token(plan.seed, 'fmd')}/sensors-{token(plan.seed, 'sensors')}",
        notes=f"virtual test, {len(driven)} runs",
        table=lab.layout.table,
        runs=tuple(Run(name=run.name, file=f"{run.name}.h5", axis=run.axis, excitation=run.excitation) for run in driven),
        recordings=recordings,
        mounting=Pose(position=lab.rig.seat) if plan.on_fmd else None,
        gravity=plan.gravity,
        source=SOURCE,
    )
