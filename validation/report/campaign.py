"""The answers of `massline check` and `massline correct`: what a campaign holds, what is wrong with it, a corrected copy; and of
`massline model --examine`, which asks the same of a user's own model.
"""

from collections.abc import Iterable, Iterator, Sequence
from pathlib import Path
from typing import TYPE_CHECKING

import numpy as np

from geometry.articles import NAMES
from geometry.atomic import write_folder
from geometry.dynamic_mass import MOTIONS, SIGNS
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.sensors import AXES as DIRECTIONS
from geometry.sensors import SI, Point
from geometry.toml_file import holds, nearest
from identification import campaign_file
from identification.campaign import Campaign
from identification.files import files
from identification.spectra.of_campaign import spectra
from validation.identify.check import Summary
from validation.output import NONE, print_answer, require_folder, share_done, shown, to_json, wrote
from validation.report.document import Column, Document, Grid, Table

if TYPE_CHECKING:
    from identification.modal_table import ModalTable
    from identification.response_functions import ResponseFunctions
    from validation.correct import AppliedCorrection


LEVEL_UNITS = 3 * ("m/s²",) + 3 * ("rad/s²",)


def title(summary: Summary) -> str:
    """Title and article of the campaign, or its folder."""
    return summary.folder if summary.campaign is None else f"{summary.campaign.title}: {summary.campaign.article}"


def grids(summary: Summary) -> list[Grid]:
    """All tables, in the order in which they are read."""
    campaign = summary.campaign
    if campaign is None:
        return []
    told = ("what is determined", "channels", "rank", "condition", "scaled by", "missing")
    verdicts = tuple(
        (
            what,
            str(len(one.channels)),
            f"{one.rank} of 6",
            f"{one.condition:.3g}" if one.complete else NONE,
            f"{1e3 * one.lever:.0f} mm" if one.channels else NONE,
            ", ".join(one.missing) or "nothing",
        )
        for what, one in summary.verdicts.items()
    )
    header = ("channel", "group", "in files", "at, from F [mm]", "along", "noise stated", "noise found", "remarks")
    found = [None] * len(campaign.table) if summary.noise is None else summary.noise.tolist()
    lines = []
    for channel, floor in zip(campaign.table.channels, found, strict=True):
        places = (_point(1e3 * (place.position - campaign.table.origin), ".5g") for place in channel.places)
        # ``+x`` along an axis, else the components
        direction = channel.places[0].direction
        k = int(np.argmax(np.abs(direction)))
        straight = abs(direction[k]) > 1 - 1e-9
        along = f"{'+' if direction[k] > 0 else '-'}{'xyz'[k]}" if straight else _point(direction, ".4g")
        noise = (NONE if one is None else f"{one:.3g} {SI[channel.quantity]}" for one in (channel.noise_rms, floor))
        remarks = {
            "moment": channel.quantity == "moment",
            f"sum of {len(channel.places)}": channel.is_sum,
            "reference": channel.reference,
            "kinematic": channel.quantity == "acceleration" and not channel.senses_gravity,
        }
        remarked = ", ".join(words for words, true in remarks.items() if true) or NONE
        lines.append((channel.name, channel.group, channel.unit, " + ".join(places), along, *noise, remarked))
    return [
        Grid(header=header, lines=tuple(lines), words=True),
        *_runs(campaign, summary),
        Grid(header=told, lines=verdicts, words=True),
    ]


def _point(values: Array, form: str) -> str:
    return "(" + ", ".join(f"{value + 0.0:{form}}" for value in values) + ")"


def _runs(campaign: Campaign, summary: Summary) -> Iterator[Grid]:
    """What was recorded and driven, and what the table did where it drove."""
    runs, levels = [], []
    for run in campaign.runs:
        recorded, level, asked = campaign.recordings.get(run.name), summary.levels.get(run.name), run.excitation
        axis = ("not read", NONE)
        if recorded is not None and recorded.frequency is not None:
            axis = f"{recorded.frequency[0]:g}-{recorded.frequency[-1]:g} Hz", f"{len(recorded)} lines"
        elif recorded is not None:
            axis = f"{recorded.sampling_rate:g} Hz", f"{recorded.duration:.1f} s"
        excitation, factor = NONE, None
        if asked is not None:
            start, stop, rate, factor = (asked.figure(key) for key in ("start_hz", "stop_hz", "octaves_per_minute", "level"))
            band = f" {start:g}-{stop:g} Hz" if start is not None and stop is not None else ""
            swept = "" if rate is None else f", {rate:g} oct/min"
            excitation = f"{asked.kind}{band}{swept}{'' if factor is None else f', level {factor:g}'}"
        driven = NONE if level is None else f"{level.driven:.1f} s"
        runs.append((run.name, run.file, run.axis or "several", *axis, driven, excitation))
        if level is not None:
            figures = (f"{value:.3f} ({100 * share:.1f} %)" for value, share in zip(level.amplitude, level.share, strict=True))
            levels.append((run.name, NONE if factor is None else f"{factor:g}", *figures))
    header = ("run", "file", "axis", "rate or lines", "length", "driven for", "excitation")
    yield Grid(header=header, lines=tuple(runs), words=True)
    if summary.levels:
        units = (f"{axis} [{unit}]" for axis, unit in zip(SIGNS, LEVEL_UNITS, strict=True))
        yield Grid(header=("level realised", "asked", *units), lines=tuple(levels))


def notes(summary: Summary) -> list[str]:
    """The verdict, what is wrong, what is odd; then what must be known to read the tables."""
    if summary.usable:
        words = "can be used; read the warnings first." if summary.warnings else "can be used: nothing is wrong with it."
    else:
        many = "1 problem" if len(summary.problems) == 1 else f"{len(summary.problems)} problems"
        words = f"cannot be used as it is: {many}."
    return [
        f"{summary.folder} {words}",
        *(f"problem {k}: {problem}" for k, problem in enumerate(summary.problems, start=1)),
        *(f"warning: {text}." for text in summary.warnings),
        *(() if summary.campaign is None else _about(summary.campaign, summary)),
    ]


def _about(campaign: Campaign, summary: Summary) -> Iterable[str]:
    if not set(campaign.article.split("+")) <= set(NAMES):
        near = nearest(campaign.article, NAMES)
        yield f"Article {campaign.article} is not built in: a model file has it in [fe_model] or [structure.own]. {near}".rstrip()
    yield f"Hardware: {campaign.hardware or 'not stated, so no other campaign can be combined with this one unseen'}."
    if campaign.mounting is None:
        mounting = "No mounting pose is stated: a CoG can be given from F only."
    else:
        mounting = f"The top article's origin sits at {_point(1e3 * campaign.mounting.position, '.5g')} mm."
    yield f"Gravity {campaign.gravity:g} m/s². {mounting}"
    if campaign.processing is not None:
        of = campaign.processing
        blocks = f", blocks of {of.block_size}, overlap {of.overlap:g}" if of.method == "peak-reference-hold" else ""
        yield f"Processing asked for: {of.method}{blocks}, {of.start:g} to {of.stop:g} Hz in steps of {of.step:g} Hz."
    if summary.levels:
        named = ", ".join(MOTIONS)
        yield (
            f"Levels: sqrt(2) times the rms of the base motion ({named} about F, by Eqs. 6 and 7) while it was driven; in "
            "brackets the share of the run's largest, each axis divided by its nominal level."
        )
    if summary.noise is not None:
        yield "Noise found: broadband rms in the parts of the runs in which table and cover plate stand still."
    yield "Condition: rotations and moments divided by the mean distance of the places from F, which stands beside it."


# `massline correct`: a corrected copy of a campaign, and what was changed in it.


def correct(folder: str, effects: Sequence[str], out: Path, *, force: bool, as_json: bool) -> None:
    """Write the campaign in `folder` to the new folder `out`, without what `effects` say is wrong with it.

    Raises
    ------
    BadInput : a campaign that cannot be read, an effect that it cannot have or that no record can be rid of, an `out` that would
        destroy something.
    OSError : a file cannot be read or written.
    """
    from validation.correct import asked, in_turn  # the catalogue of effects and the simulator are nothing to `check`
    from validation.virtual_test import simulate

    source = Path(folder)
    test = source / "test.toml" if source.is_dir() else source
    if test.is_file() and test.name != campaign_file.NAME and not holds(test, "model"):
        remedy = f"`massline add MODEL EFFECT {test}` lets a model know what is wrong with a test of another kind"
        raise BadInput(folder, "", "it is no campaign, of whose records alone a corrected copy is written", remedy)
    simulate.require_folder(out)
    require_folder(out, "--out")
    there, read = out.resolve(), source.resolve()
    if there == read or there.is_relative_to(read) or read.is_relative_to(there):
        raise BadInput(str(out), "--out", f"it would change {source}, which is only read", "Name a folder beside it")
    if out.exists() and any(out.iterdir()):
        if not force:
            problem, remedy = "it is there already and not empty", "Name a new folder, or replace this one with --force"
            raise BadInput(str(out), "--out", problem, remedy)
        if not (out / campaign_file.NAME).is_file():
            problem = f"it holds no {campaign_file.NAME}, so it is no campaign to be replaced"
            raise BadInput(str(out), "--out", problem, "Name a new folder")
    described = campaign_file.read_description(folder)
    faults = [asked(text, described) for text in effects]
    with share_done(f"reading {folder}", quiet=as_json) as progress:
        campaign = campaign_file.read(folder, progress=progress)
    with shown(f"correcting {folder}", quiet=as_json):
        made, steps = in_turn(campaign, faults)
    with shown(f"writing {out}", quiet=as_json):
        write_folder(out, lambda new: campaign_file.write(new, made, ending=None))
    whole = {"campaign": folder, "out": str(out), "article": made.article, "corrected": to_json(steps)}
    print_answer(lambda: whole, lambda: _corrected(campaign, made, steps).text(), as_json=as_json)
    if not as_json:
        wrote(out)


def _corrected(campaign: Campaign, made: Campaign, steps: Sequence["AppliedCorrection"]) -> Document:
    """What was done to which channel of `campaign`."""

    changed = {one.name: one for step in steps for one in step.channels}
    did = {name: "; ".join(step.did for step in steps if name in [one.name for one in step.channels]) for name in changed}
    at = {name: made.table.channels[made.table.names.index(name)].places[0] for name in changed}
    columns = (
        Column("channel", lambda one: one.name, words=True),
        Column("rms before [SI]", lambda one: one.rms_before, ".5g"),
        Column("after", lambda one: one.rms_after, ".5g"),
        Column(
            "place [mm] and direction",
            lambda one: f"{_vector(1e3 * at[one.name].position)} {_vector(at[one.name].direction)}",
            aligned=False,
        ),
        Column("what was done", lambda one: did[one.name], words=True),
    )
    taken = ", ".join(str(one.named) for one in steps)
    others = f"Other campaigns of {campaign.hardware} " if campaign.hardware else "Other campaigns of this hardware "
    return Document(
        title=f"{made.title}: {made.article}",
        blocks=(Table(columns=columns, rows=list(changed.values())),),
        notes=(
            f"{campaign.source} is as it was; the copy is without {taken}, and its notes say so.",
            f"{others}may have the same fault: correct them too before they are taken together.",
        ),
    )


def _vector(values: Array) -> str:
    return "(" + " ".join(f"{value:.4g}" for value in values + 0.0) + ")"


# What was measured, written for other programs.

FUNCTIONS = tuple(files.FORMATS)
"""Endings of files that hold functions of frequency."""


def write_dynamic_mass(path: Path, campaign: Campaign) -> None:
    """Write the dynamic mass of everything that the load cells of `campaign` carry, about F, with its interval.

    Raises
    ------
    BadInput : runs that do not tell six motions apart.
    """
    from identification import test_file
    from identification.plain import setup
    from identification.request import Settings

    found = setup(spectra(campaign), Settings(gravity=campaign.gravity, modes=0))
    test_file.write(path, test_file.of_dynamic_mass(found.estimate.dynamic_mass, campaign.source, found.noise))


MOST_PLACES = 6
"""Places of a test that one line names. Held by test_check_command.py."""


def _where(test: "ResponseFunctions | ModalTable") -> str:
    """Where a test was driven and read, in words."""
    from identification.response_functions import ResponseFunctions

    def named(points: Sequence[Point]) -> str:
        words = []
        for one in points[:MOST_PLACES]:
            along = next((key for key, axis in DIRECTIONS.items() if np.allclose(axis, one.direction)), "")
            words.append(f"{one.place} along {along or np.asarray(one.direction).round(3).tolist()}")
        more = len(points) - len(words)
        return ", ".join(words) + (f" and {more} more" if more else "")

    if isinstance(test, ResponseFunctions):
        return f"driven at {named(test.drives)}; read at {named(test.responses)}"
    return f"shapes read at {named(test.sensors)}" if test.shapes is not None else ""


def show_tests(name: str, tests: "Sequence[ResponseFunctions | ModalTable]", *, as_json: bool, out: Path | None) -> None:
    """Print what the `tests` of the file `name` hold; write the response functions of the one that has them to `out`.

    Raises
    ------
    BadInput : `out` is asked for, and not exactly one of them has response functions.
    """
    from identification import test_file
    from identification.response_functions import ResponseFunctions

    with_functions = [one for one in tests if isinstance(one, ResponseFunctions)]
    if out is not None:
        if len(with_functions) != 1:
            problem = f"{name} has {len(with_functions)} tests with response functions, and a file holds one"
            raise BadInput("--out", "", problem, "Name the file of one test")
        test_file.write(out, test_file.of_responses(with_functions[0]))
    rows = []
    for one in tests:
        lines = one.frequency
        row = {
            "article": one.article,
            "what": "modes",
            "count": len(lines),
            "from_hz": lines.min(),
            "to_hz": lines.max(),
            "coherence": None,
        }
        if isinstance(one, ResponseFunctions):
            count = ((len(one.responses), "response"), (len(one.drives), "drive"))
            row |= {"what": ", ".join([*(f"{n} {word}{'s' * (n > 1)}" for n, word in count), one.quantity])}
            row |= {"coherence": None if one.coherence is None else float(np.median(one.coherence))}
        rows.append(row)
    warnings = [f"{word}." for one in tests for word in one.warnings]
    columns = (
        Column("article", lambda row: row["article"], words=True),
        Column("measured", lambda row: row["what"], words=True),
        Column("lines or modes", lambda row: row["count"], "d"),
        Column("from [Hz]", lambda row: row["from_hz"]),
        Column("to [Hz]", lambda row: row["to_hz"]),
        Column("coherence, median", lambda row: row["coherence"], ".3f"),
    )
    where = [f"{one.article}: {said}." for one in tests if (said := _where(one))]
    page = Document(title=name, blocks=[Table(columns=columns, rows=rows)], notes=[*where, *warnings])
    whole = {"source": name, "tests": to_json(rows), "warnings": warnings}
    print_answer(lambda: whole, page.text, as_json=as_json)
    if out is not None:
        wrote(out)
