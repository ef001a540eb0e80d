"""The answer of `massline correct`: a corrected copy of a campaign, and what was changed in it."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import replace
from functools import reduce
from pathlib import Path
from typing import Any

import click
import numpy as np

from geometry.atomic import write_folder
from geometry.errors import BadInput
from geometry.frames import Array
from identification import campaign_file
from identification.campaign import Campaign, factor
from validation.correct import Corrected, corrected
from validation.effects.catalogue import MISTAKEN_UNIT, Named, parse
from validation.effects.effect import Vocabulary
from validation.output import percent, require_folder, shown
from validation.report.document import Grid, aligned
from validation.virtual_test import simulate

EFFECT = "EFFECT"


def correct(folder: str, effects: Sequence[str], out: Path, *, force: bool, as_json: bool) -> None:
    """Write the campaign in `folder` to the new folder `out`, without what `effects` say is wrong with it.

    Raises
    ------
    BadInput : a campaign that cannot be read, an effect that it cannot have or that no record can be rid of, an `out` that would
        destroy something.
    OSError : a file cannot be read or written.
    """
    from validation.output import print_json
    from validation.report.document import page

    _require_free(out, Path(folder), force=force)
    described = campaign_file.read_description(folder)
    faults = [asked(text, described) for text in effects]
    with percent(f"reading {folder}", quiet=as_json) as progress:
        campaign = campaign_file.read(folder, progress=progress)
    with shown(f"correcting {folder}", quiet=as_json):
        steps = _steps(campaign, faults)
    made = steps[-1].campaign
    with shown(f"writing {out}", quiet=as_json):
        write_folder(out, lambda new: campaign_file.write(new, made, ending=None))
    if as_json:
        print_json({"campaign": folder, "out": str(out), "article": made.article, "corrected": _rows(campaign, steps, faults)})
        return
    click.echo(page(f"{made.title}: {made.article}", [_grid(campaign, made, steps)], _notes(campaign, faults)), nl=False)
    click.echo(f"massline: wrote {out}.", err=True)


def asked(text: str, campaign: Campaign) -> Named:
    """The fault that `text` names, on a channel that the described `campaign` has.

    Raises
    ------
    BadInput : see `validation.effects.catalogue.parse`; a fault that no record can be rid of.
    """
    named = parse(text, _words(campaign), source=EFFECT)
    if named.family == MISTAKEN_UNIT and _is_word(text.partition("=")[2]):
        channel = campaign.table.channels[campaign.table.names.index(named.target)]
        stated = factor(channel.unit, channel.quantity, source=EFFECT, field=named.id)
        named = replace(named, values={"": named.value * stated})
    corrected(campaign, named)  # without recordings as yet: what cannot be done is said before they are read
    return named


def _words(campaign: Campaign) -> Vocabulary:
    names = campaign.table.names
    chosen = (campaign.table.select(quantity=quantity) for quantity in ("acceleration", ("force", "moment")))
    accelerometers, forces = (tuple(names[k] for k in each) for each in chosen)
    return Vocabulary(accelerometers=accelerometers, forces=forces, places=None, parts=None)


def _is_word(text: str) -> bool:
    try:
        float(text)
    except ValueError:
        return True
    return False


def _steps(campaign: Campaign, faults: Sequence[Named]) -> list[Corrected]:
    """After each of `faults`, one upon the other."""
    nothing = Corrected(campaign=campaign, channels=(), did="")
    return reduce(lambda done, named: [*done, corrected(done[-1].campaign, named)], faults, [nothing])[1:]


def _require_free(out: Path, source: Path, *, force: bool) -> None:
    simulate.require_folder(out)
    there, read = out.resolve(), source.resolve()
    if there == read or there.is_relative_to(read) or read.is_relative_to(there):
        problem = f"it would change {source}, which is only read"
        raise BadInput(source=str(out), field="--out", problem=problem, remedy="Name a folder beside it")
    if out.exists() and any(out.iterdir()):
        if not force:
            problem, remedy = "it is there already and not empty", "Name a new folder, or replace this one with --force"
            raise BadInput(source=str(out), field="--out", problem=problem, remedy=remedy)
        if not (out / campaign_file.NAME).is_file():
            problem = f"it holds no {campaign_file.NAME}, so it is no campaign to be replaced"
            raise BadInput(source=str(out), field="--out", problem=problem, remedy="Name a new folder")
    require_folder(out, "--out")


def _level(campaign: Campaign, channel: str) -> float:
    """Root mean square of `channel` over all runs, SI."""
    squares = [np.mean(np.abs(one.channel(channel)) ** 2) for one in campaign.recordings.values()]
    return float(np.sqrt(np.mean(squares)))


def _rows(campaign: Campaign, steps: Sequence[Corrected], faults: Sequence[Named]) -> list[dict[str, Any]]:
    after = steps[-1].campaign
    return [
        {
            "id": named.id,
            "value": named.value if set(named.values) <= {""} else dict(named.values),
            "unit": named.unit,
            "did": step.did,
            "channels": [
                {"name": name, "rms_before": _level(campaign, name), "rms_after": _level(after, name)} for name in step.channels
            ],
        }
        for named, step in zip(faults, steps, strict=True)
    ]


def _grid(campaign: Campaign, made: Campaign, steps: Sequence[Corrected]) -> Grid:
    changed = tuple(dict.fromkeys(name for step in steps for name in step.channels))
    levels = [tuple(f"{_level(one, name):.5g}" for name in changed) for one in (campaign, made)]
    places = [_place(made, name) for name in changed]
    columns = (changed, aligned(levels[0]), aligned(levels[1]), places, [_all(steps, name) for name in changed])
    header = ("channel", "rms before [SI]", "after", "place [mm] and direction", "what was done")
    return Grid(header=header, lines=tuple(zip(*columns, strict=True)), words=True)


def _all(steps: Sequence[Corrected], channel: str) -> str:
    return "; ".join(step.did for step in steps if channel in step.channels)


def _place(campaign: Campaign, name: str) -> str:
    place = campaign.table.channels[campaign.table.names.index(name)].places[0]
    return f"{_vector(1e3 * place.position)} {_vector(place.direction)}"


def _vector(values: Array) -> str:
    return "(" + " ".join(f"{value:.4g}" for value in values + 0.0) + ")"


def _notes(campaign: Campaign, faults: Sequence[Named]) -> list[str]:
    taken = ", ".join(map(str, faults))
    others = f"Other campaigns of {campaign.hardware} " if campaign.hardware else "Other campaigns of this hardware "
    return [
        f"{campaign.source} is as it was; the copy is without {taken}, and its notes say so.",
        f"{others}may have the same fault: correct them too before they are taken together.",
    ]
