"""What a campaign as a whole must satisfy: six motions and six resultants that can be told, runs that fit each other."""

from __future__ import annotations

from collections.abc import Mapping

from geometry.errors import BadInput
from geometry.observability import Observability, of_motions, of_resultants
from geometry.sensors import ChannelTable
from identification.campaign import Campaign
from identification.recording import Recording

RIGID_GROUPS = ("table", "cover")
"""Groups whose accelerometers may tell the base motion: they move with the table as long as the FMD is stiff."""

WEAK = 100.0
"""Condition number from which a transformation multiplies errors of the sensors so much that it is said aloud."""


def observed(table: ChannelTable) -> dict[str, Observability]:
    """Every verdict on `table`: the base motion by cover plate, by table and by both, and the resultants."""
    return {
        "base motion by cover": of_motions(table, ("cover",)),
        "base motion by table": of_motions(table, ("table",)),
        "base motion by table and cover": of_motions(table, RIGID_GROUPS),
        "resultants by fmd": of_resultants(table),
    }


def problems_of_table(table: ChannelTable, source: str) -> list[BadInput]:
    """What cannot be told from the channels at all: a base motion by table and cover plate together, or a resultant."""
    verdicts = observed(table)
    found = []
    for key, what, remedy in (
        ("base motion by table and cover", "base motion", "Add an accelerometer that moves with it to [[channel]]"),
        ("resultants by fmd", "resultant", "Add a load cell that senses it to [[channel]], or give the cells of a sum singly"),
    ):
        verdict = verdicts[key]
        if not verdict.complete:
            what = what if len(verdict.missing) == 1 else f"{what}s"
            problem = f"the {what} {', '.join(verdict.missing)} cannot be told from its channels: {verdict.text}"
            found.append(BadInput(source=source, field="channel", problem=problem, remedy=remedy))
    return found


def warnings_of_recordings(campaign: Campaign, recordings: Mapping[str, Recording]) -> tuple[str, ...]:
    """What is odd but leaves the data usable: weak geometry, runs of different rates, records shorter than their sweep."""
    return (
        *_of_table(campaign.table, campaign.source),
        *(text for recorded in recordings.values() for text in recorded.warnings),
        *_of_rates(recordings, campaign.source),
        *(text for run in campaign.runs if run.name in recordings for text in _of_run(campaign, run.name, recordings[run.name])),
    )


def _of_table(table: ChannelTable, source: str) -> list[str]:
    verdicts = observed(table)
    cover = verdicts["base motion by cover"]
    found = []
    if not cover.complete and verdicts["base motion by table and cover"].complete:
        found.append(
            f"{source}: the cover plate alone does not tell the base motion ({', '.join(cover.missing)}); the table must help"
        )
    for key, verdict in verdicts.items():
        if verdict.complete and verdict.condition > WEAK:
            found.append(f"{source}: {key} has the condition number {verdict.condition:.3g}; move the pick-ups farther apart")
    return found


def _of_rates(recordings: Mapping[str, Recording], source: str) -> list[str]:
    axes = {"spectra" if one.is_spectrum else f"{one.sampling_rate:g} Hz" for one in recordings.values()}
    if len(axes) < 2:
        return []
    return [
        f"{source}: its runs are not recorded alike, found {', '.join(sorted(axes))}; one run may have been exported otherwise"
    ]


def _of_run(campaign: Campaign, name: str, recorded: Recording) -> list[str]:
    excitation = campaign.run(name).excitation
    if excitation is None or recorded.sampling_rate is None:
        return []
    found = []
    stop, needed = excitation.figure("stop_hz"), excitation.sweep_duration
    if stop is not None and stop > recorded.sampling_rate / 2:
        rate = recorded.sampling_rate
        found.append(
            f"{recorded.source}: drives up to {stop:g} Hz, sampled at {rate:g} Hz it ends at {rate / 2:g} Hz; check the rate"
        )
    if needed is not None and recorded.duration < needed * (1 - 1e-3):
        lasts = f"lasts {recorded.duration:.1f} s where its sweep takes {needed:.1f} s and must ring down"
        found.append(f"{recorded.source}: {lasts}; is it cut short?")
    return found
