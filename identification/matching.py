"""From the contents of a signal file to a `Recording`: the channels of the table, each once, in SI."""

from __future__ import annotations

from collections.abc import Mapping

import numpy as np

from geometry.errors import BadInput
from geometry.keys import nearest
from geometry.sensors import SI, Channel, ChannelTable
from identification import soundness
from identification.files.contents import Samples, Signals
from identification.files.mat_names import variable
from identification.recording import Recording
from identification.units import SAME, is_same, is_unit, named
from identification.units import factor as factor_of


def recording(signals: Signals, table: ChannelTable, toml: str) -> tuple[Recording | None, list[BadInput]]:
    """The recording in `signals` and what is wrong with it; None where a channel cannot be used.

    `toml` is what the channel table is called in messages.
    """
    samples, problems = _matched(signals, table)
    for channel in table.channels:
        if channel.name in samples:
            problems += _problems(samples[channel.name], channel, signals, toml)
    if problems:
        return None, problems
    columns = [samples[channel.name] * _factor(channel) for channel in table.channels]
    warnings = (*signals.warnings, *_clipped(samples, table, signals.source))
    made = Recording(
        names=table.names,
        values=np.column_stack(columns),
        sampling_rate=signals.sampling_rate,
        frequency=signals.frequency,
        source=signals.source,
        warnings=warnings if signals.frequency is None else signals.warnings,
    )
    return made, []


def _factor(channel: Channel) -> float:
    return factor_of(channel.unit, channel.quantity, source="channel", field=channel.name)


def _matched(signals: Signals, table: ChannelTable) -> tuple[dict[str, Samples], list[BadInput]]:
    """Samples by the name of the channel table, and the channels that are missing or too many."""
    is_mat = signals.source.lower().endswith(".mat")
    called: dict[str, str] = {}
    problems = []
    for name in table.names:
        key = variable(name) if is_mat else name
        if key in called:
            problem = f"stands for {called[key]!r} and {name!r}: a MAT file cannot tell them apart"
            problems.append(BadInput(source=signals.source, field=key, problem=problem, remedy="Rename one, or export .h5"))
        called[key] = name
    for name in called:
        if name not in signals.samples:
            problem = f"the channel {called[name]!r} is missing"
            like = nearest(name, [other for other in signals.samples if other not in called])
            remedy = f"{like}Export it, or take it out of campaign.toml"
            problems.append(BadInput(source=signals.source, field=name, problem=problem, remedy=remedy))
    for name in signals.samples:
        if name not in called:
            remedy = "Add it to campaign.toml as a [[channel]], or leave it out of the file"
            problem = "this channel is not in campaign.toml"
            problems.append(BadInput(source=signals.source, field=name, problem=problem, remedy=remedy))
    return {called[name]: values for name, values in signals.samples.items() if name in called}, problems


def _problems(values: Samples, channel: Channel, signals: Signals, toml: str) -> list[BadInput]:
    found = []
    if np.iscomplexobj(values) != (signals.frequency is not None):
        what = "complex" if np.iscomplexobj(values) else "real"
        problem = f"is {what}, where {'time histories are real' if signals.frequency is None else 'spectra are complex'}"
        found.append(BadInput(source=signals.source, field=channel.name, problem=problem, remedy="Export it again"))
    for check in (soundness.require_finite, soundness.require_alive):
        try:
            check(values, channel.name, signals.source)
        except BadInput as error:
            found.append(error)
            break
    return found + _contradictions(channel, signals, toml)


def _contradictions(channel: Channel, signals: Signals, toml: str) -> list[BadInput]:
    """What the signal file says about a unit beside what ``campaign.toml`` says: dataset 164, and the label of the ordinate."""
    ours, said = _factor(channel), []
    units, label = signals.units.get(channel.name), signals.labels.get(channel.name, "")
    if units is not None and abs(units.size(channel.quantity) - ours) > SAME * ours:
        theirs = units.size(channel.quantity)
        size = f"1 {channel.unit} is {ours:.7g} {SI[channel.quantity]}, the file's unit {theirs:.7g}"
        said.append(
            f"dataset 164 ({units.words}) gives it in {named(theirs, channel.quantity)}, {toml} in {channel.unit}: {size}"
        )
    if is_unit(label) and not is_same(label, channel.unit, channel.quantity):
        said.append(f"its axis is labelled {label}, {toml} gives it in {channel.unit}")
    remedy = "Correct the one that is wrong"
    return [BadInput(source=signals.source, field=channel.name, problem=problem, remedy=remedy) for problem in said]


def _clipped(samples: Mapping[str, Samples], table: ChannelTable, source: str) -> list[str]:
    cut = {name: soundness.clipped(samples[name].real) for name in table.names}
    return [
        f"{source}: {name} is clipped: {count} samples lie on a flat top; raise its range and repeat the run, or leave it out"
        for name, count in cut.items()
        if count
    ]
