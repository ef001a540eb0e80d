"""`simulate`: a `Plan` becomes a `Campaign`, and the truth behind it.

    drawn chain and FMD -> rig -> driven in time -> sensors -> delays and anti-alias filter -> noise, mains -> campaign

The chain is linear from the table to the recorder but for what an effect makes of it.
"""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass

from fem.base_excitation.decimation import require_recorded
from geometry.frames import Pose
from identification.campaign import Campaign, Run
from identification.recording import Recording
from validation.virtual_test.driven import record, sensed
from validation.virtual_test.hooks import changed_record
from validation.virtual_test.laboratory import Laboratory, laboratory
from validation.virtual_test.plan import SOURCE, Plan
from validation.virtual_test.recorder import disturbed
from validation.virtual_test.runs import DrivenRun, runs
from validation.virtual_test.streams import token
from validation.virtual_test.truth import truth

Progress = Callable[[float], None]
"""Called with the share done, 0 to 1; it may raise to end the work."""


@dataclass(frozen=True, eq=False, kw_only=True)
class VirtualTest:
    """A campaign and what nobody would know of a real one; `truth` holds JSON values only."""

    campaign: Campaign
    truth: Mapping[str, object]


def simulate(plan: Plan, progress: Progress | None = None) -> VirtualTest:
    """The virtual test of `plan`.

    Raises
    ------
    BadInput : an article that does not stand on the FMD or cannot be built, a band, rate or cross motion that cannot be, an
        effect of the catalogue that cannot act here.
    CheckFailed : something on the table swings freely.
    """
    driven = runs(plan)
    require_recorded(max(run.pattern.highest for run in driven), plan.rate, SOURCE)
    lab = laboratory(plan)
    recordings = {}
    for k, run in enumerate(driven):
        recordings[run.name] = recording(plan, lab, run)
        if progress is not None:
            progress((k + 1) / len(driven))
    campaign = _campaign(plan, lab, driven, recordings)
    return VirtualTest(campaign=campaign, truth=truth(plan, lab.chain, lab.made, lab.rig))


def recording(plan: Plan, lab: Laboratory, run: DrivenRun) -> Recording:
    """What the recorder of `lab` holds after `run`, noise and hum in it."""
    names = lab.layout.table.names
    samples = disturbed(record(plan, lab, run), names, lab.chain, plan, run.name)
    got = changed_record(sensed(plan, lab, run, samples, plan.rate), plan.effects)
    return Recording(names=names, values=got.values, sampling_rate=plan.rate, source=run.name)


def _campaign(plan: Plan, lab: Laboratory, driven: tuple[DrivenRun, ...], recordings: Mapping[str, Recording]) -> Campaign:
    return Campaign(
        title=f"Virtual test of {plan.article}",
        article=plan.article,
        hardware=f"fmd-{token(plan.seed, 'fmd')}/sensors-{token(plan.seed, 'sensors')}",
        notes=f"virtual test, {len(driven)} runs",
        table=lab.layout.table,
        runs=tuple(Run(name=run.name, file=f"{run.name}.h5", axis=run.axis, excitation=run.excitation) for run in driven),
        recordings=recordings,
        mounting=Pose(position=lab.made.rig.seat) if plan.on_fmd else None,
        gravity=plan.gravity,
        source=SOURCE,
    )
