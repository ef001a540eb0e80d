"""The pictures of `massline diagnose`: what each of them shows, from the diagnosis."""

from collections.abc import Callable, Iterator, Mapping, Sequence
from contextlib import suppress
from dataclasses import dataclass, replace
from math import isfinite
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import Any

import click

from geometry.atomic import probe
from geometry.errors import BadInput, CheckFailed
from validation.compare.compare import mapped_all
from validation.compare.correlation import modes_of
from validation.diagnose import diagnose
from validation.diagnose import diagnosis as results
from validation.diagnose.classical_tests import SURE
from validation.diagnose.diagnose import ready
from validation.diagnose.diagnosis import Needed, SwingAnswer
from validation.diagnose.nonlinear import require_levels
from validation.diagnose.pendulum import NOTHING_MISSING, only_classical
from validation.effects.catalogue import FAMILIES
from validation.effects.effect import evidence_threshold
from validation.effects.practical_units import said, written_as
from validation.estimation.evaluate import named, without
from validation.estimation.fit import COARSE
from validation.history.history import Version, reminded
from validation.history.verdict import at_offsets, kept_offsets
from validation.model import model_file
from validation.model.model import Added
from validation.output import (
    NONE,
    nats,
    odds,
    print_answer,
    share_done,
    significant,
    stages,
    to_json,
    two_digits,
    with_unit,
    wrote,
)
from validation.reference.reference import file_name
from validation.report import document as doc
from validation.report import history, parts
from validation.report.charts import crosscheck, static
from validation.report.charts.crosscheck import standing_of, tried
from validation.report.compare import ComparisonPage, correlation_tables, draw_channels
from validation.report.document import NOTHING as EMPTY
from validation.report.history import climb, of_ladder
from validation.report.scenes.motion import NOTE, draw_nodes
from validation.study import Options, Progress, Study, only_files

EVIDENCE, ERRORS, EVERYWHERE = "diagnose-evidence.png", "diagnose-errors.png", "diagnose-everywhere.png"
EVIDENCE_NOTE = (
    "How much more probable the data are with the effect than without it, each beside the model before the last was found."
)

THRESHOLD = "worth_nats"
"""Key of the settings by which a diagnosis says what it asked for, of each family that has its own and of all others, by ""."""


def draw(found: results.Diagnosis, folder: Path) -> tuple[Path, ...]:
    """Write every picture that `found` has the evidence for into `folder`, and say where they are."""
    named = results.listed([one.id for one in found.accepted])
    told = {
        results.NOTHING: "nothing is missing",
        results.UNKNOWN: f"{named}, and something is left" if named else "unknown",
        results.AMBIGUOUS: f"one of {results.listed(found.equivalence_class, 'or')}",
    }
    title = f"Diagnosis: {told.get(found.verdict) or named or found.verdict}"
    made = []
    if tried(found):
        causes = crosscheck.causes_of(found, title, EVIDENCE_NOTE, asked(found))
        height = 2.5 + 0.46 * len(causes.panels[0].rows)
        room = {"left": 0.235, "right": 0.685, "top": 1 - 1.17 / height, "bottom": 0.98 / height}
        static.draw_bars(causes, folder / EVIDENCE, size=(13.5, height), room=room, thickness=0.64)
        made.append(folder / EVIDENCE)
    after = None if found.after is found.before else found.after
    held = f"Used only for checking (held out): {results.listed(found.hold_out)}." if found.hold_out else ""
    errors = crosscheck.changes_of(found.before, after, title, held)
    height = 2.9 + 0.62 * sum(len(one.rows) for one in errors.panels)
    room = {"left": 0.19, "right": 0.95, "top": 1 - 1.15 / height, "bottom": 0.95 / height, "hspace": 0.5}
    static.draw_bars(errors, folder / ERRORS, size=(12.0, height), room=room, thickness=0.36 if errors.legend else 0.5)
    nodes = draw_nodes(found.nodes, found.everywhere, folder / EVERYWHERE)
    return (*made, folder / ERRORS, *(() if nodes is None else (nodes,)))


def asked(found: results.Diagnosis) -> float | None:
    """[nats] that a diagnosis asks of most families; None where it does not say."""
    said = found.settings.get(THRESHOLD)
    return float(said[""]) if isinstance(said, Mapping) and "" in said else None


# The smallest sizes that would have been named, for people: by side of the catalogue and family, in units of a laboratory.


SPREAD = 1.05
"""Factor between the least and the greatest of a family within which one figure says it."""


def grid(of: Sequence[results.Detectable]) -> doc.Grid:
    """`of` by family, each side of the catalogue under its heading; of sizes in several units a row for each."""

    def target(one: results.Detectable) -> str:
        return ", ".join(part for part in (one.id.partition(":")[2], one.at and f"at {one.at}") if part)

    lines, side = list[tuple[str, str, str]](), ""
    for name, family in FAMILIES.items():
        every = [one for one in of if one.id.partition(":")[0] == name]
        for unit in dict.fromkeys(one.unit for one in every):
            # Mirror images differ by rounding: of these the order of names decides
            own = sorted((one for one in every if one.unit == unit), key=lambda one: (float(f"{one.size:.6g}"), one.id))
            specs = {one.id: family.sizes_at(tuple(one.id.split(":")[1:])) for one in own}
            seen = [one for one in own if all(abs(one.size) <= of.high for of in specs[one.id] if of.unit == unit)]
            least, greatest = (seen or own)[0], (seen or own)[-1]
            low, high = said(least.size, unit), said(greatest.size, unit)
            together = not seen or greatest.size <= SPREAD * least.size or low == high
            alike = "both alike" if len(own) == 2 else f"all {len(own)} alike"
            at = alike if together else f"{target(least)} to {target(greatest)}, {len(own)} in all"
            at += f", at no size at {len(own) - len(seen)}" if 0 < len(seen) < len(own) else ""
            size = "at no size" if not seen else low if together else f"{low} to {high}"
            lines += [(family.side, "", "")] if family.side != side else []
            lines.append((f"  {name}", size, target(least) if len(own) == 1 else at))
            side = family.side
    first, sizes, where = zip(*lines, strict=True)
    return doc.Grid(
        header=("would have been named", "from", "at"),
        lines=tuple(zip(first, doc.aligned(sizes), where, strict=True)),
        words=True,
        caption="The smallest sizes that would have been named",
    )


# The page of a diagnosis without a campaign: the verdict, the measurements, what each effect would need, what to do next.


FAR = 10.0
"""Tolerances by which an input is not wrong any more, but something else."""

MOST = 8
"""Tests that are shown."""

PLACES = "point-mass"

HEADLINES = {
    results.NOTHING: "NOTHING IS MISSING at the resolution of these measurements",
    results.MISSING: "MISSING",
    results.AMBIGUOUS: "MISSING IS one of several that these measurements cannot tell apart",
    results.SEVERAL: "SEVERAL ARE MISSING",
    results.UNKNOWN: "UNKNOWN: something is missing, and no effect that massline knows explains it",
}
"""By verdict."""


MEASURE = "measure this"


def title(model: str, data: Sequence[str]) -> str:
    """Model and data."""
    return f"What {model} is missing beside {', '.join(data)}"


def classical_document(found: SwingAnswer, named: str) -> doc.Document:
    """All of a diagnosis without a campaign, in the order in which it is read."""
    swung = any(one.period for one in found.facts)
    several = len({one.name.removesuffix(one.quantity) for one in found.facts}) > 1
    facts = doc.Table(
        rows=found.facts,
        columns=(
            doc.Column("measurement", lambda one: f"{one.name if several else one.quantity} [{one.unit.replace('^2', '²')}]"),
            doc.Column("measured", lambda one: doc.toleranced(one.measured, one.deviation)),
            doc.Column("sd", lambda one: doc.toleranced(one.deviation, one.deviation)),
            doc.Column("model", lambda one: doc.toleranced(one.predicted, one.deviation)),
            *([doc.Column("period", lambda one: f"{100 * one.period_shift:+.3f} %" if one.period else NONE)] if swung else []),
            doc.Column("sigma", lambda one: round(-one.sigma, 1) + 0.0, "+.1f"),
        ),
    )
    # What every effect would have to be, places of one kind in one line
    places: dict[str, list[Needed]] = {}
    for needed in found.needed:
        family, _, _ = needed.id.partition(":")
        places.setdefault(family if family == PLACES else needed.id, []).append(needed)

    def size(of: Sequence[Needed]) -> str:
        if len(of) == 1:
            return of[0].text
        low, high = (end(of, key=lambda one: one.value) for end in (min, max))
        least = min(of, key=lambda one: abs(one.value))
        anywhere = f"at any of {len(of)} places {said(low.value, low.unit)} to {said(high.value, high.unit)}"
        return f"{anywhere}; at {least.id.partition(':')[2]} {least.text}"

    effects = doc.Table(
        rows=list(places.items()),
        columns=(
            doc.Column("effect", lambda row: row[0]),
            doc.Column("evidence [nats]", lambda row: max(one.evidence for one in row[1]), nats),
            doc.Column("odds", lambda row: odds(max(one.evidence for one in row[1])), words=True),
            doc.Column("size that would explain it by itself", lambda row: size(row[1]), words=True),
        ),
    )
    whose = {one.name: one.quantity for one in found.facts}
    inputs = doc.Table(  # that would explain it, were they wrong; a figure that was stated is called by its quantity
        rows=[one for one in found.readings if abs(one.tolerances) <= FAR and abs(one.change) < abs(one.value)],
        columns=(
            doc.Column("or a wrong input [SI]", lambda one: whose[one.of[0]] if one.name.endswith(" tolerance") else one.name),
            doc.Column("as stated", lambda one: one.value, ".6g"),
            doc.Column("it would be off by", lambda one: one.change, "+.2g"),
            doc.Column("in its tolerances", lambda one: round(one.tolerances, 1) + 0.0, "+.1f"),
        ),
    )

    def expected(gain: float) -> str:
        """Of a test; where it decides anyway, no more than that."""
        return NONE if gain == 0 else f"> {SURE:.0f}" if gain > SURE else significant(gain, 2)

    advice = doc.Table(
        rows=list(enumerate(found.advice[:MOST], start=1)),
        columns=(
            doc.Column("next", lambda row: f"{row[0]}"),
            doc.Column("expected nats", lambda row: expected(row[1].gain), aligned=False),
            doc.Column(MEASURE, lambda row: f"{row[1].test[:1].upper()}{row[1].test[1:]}", words=True),
        ),
    )
    least = grid(found.detectable) if found.detectable else None
    notes = [
        "Sigma: measured less the model's, over the standard deviation; what is stated as a tolerance is a 95 % limit.",
        IN_NATS,
        *([f"--json has {len(found.advice) - MOST} more tests."] if len(found.advice) > MOST else []),
        *(f"warning: {text}." for text in found.remarks),
    ]
    opening = (f"{HEADLINES[found.verdict]}.", found.text.removeprefix(NOTHING_MISSING).lstrip())
    return doc.Document(title=named, opening=opening, blocks=(facts, effects, inputs, advice, least), notes=notes)


# `massline diagnose` where no campaign is among the data, from options to output.


RESULT = "diagnose.json"
"""The file of a diagnosis in its folder."""


def answer(asked: Options, files: Sequence[str], *, auto: bool, as_json: bool, folder: Path | None) -> None:
    """Diagnose by the measurement `files` alone, print it, and write JSON into `folder` (None: nowhere).

    Raises
    ------
    BadInput : a model or a file that cannot be used, or an option that asks for a campaign.
    """
    given = {"--auto": auto, "--hold-out": bool(asked.hold_out), "--band": asked.band is not None}
    for option in (option for option, there in given.items() if there):
        problem = "there is no campaign among DATA: weights and periods alone are neither held out nor climbed on"
        raise BadInput(option, "", problem, "Leave it out, or name a campaign folder, too")
    with reminded(asked.path):
        model = model_file.read(asked.model)
    with stages("diagnosing", quiet=as_json) as told:
        found = only_classical(model, files, lambda share: told("effects", share), only=asked.candidates)
    whole = {"model": asked.model, "data": list(files), **to_json(found)}
    page, file = classical_document(found, title(asked.path.name, files)), None if folder is None else folder / RESULT
    print_answer(lambda: whole, page.text, as_json=as_json, file=file)


# Where an unknown effect shows: the map of what is left once everything that was accepted acts.


def draw_left(found: results.Diagnosis, bench: Study, folder: Path, progress: Callable[[float], None]) -> tuple[Path, ...]:
    """Write a map of each campaign into `folder`: channels and loads in sigmas, at the plain fit with what was accepted."""
    whole = bench.whole([Added(named=one.named) for one in found.accepted])
    known = without(whole, named(whole, bench.hold_out)) if bench.hold_out else whole
    plain = at_offsets(kept_offsets(found.after.plain_fit), whole)
    acting = (*bench.model.effects, *(Added(named=each.named) for each in found.accepted))
    made = [one.with_effects(acting) for one in (*bench.made, *bench.tests)]
    paths = []
    for of, one in zip(mapped_all(made, whole, known.thinned(), plain, progress), made, strict=True):
        paths.append(folder / f"{file_name(f'diagnose-left-{of.data_set}')}.png")
        draw_channels(of, modes_of(one, {**whole.start, **plain.by_name}), paths[-1])
    return tuple(paths)


# The page of `massline diagnose`: the verdict, the causes, what would decide, the errors before and after, how it was found.


RANKED = 8
"""Causes that the page shows; JSON has all."""

IN_NATS = (
    "Evidence: how much more probable the data are with it than without it, as the natural logarithm of the odds (nats): 3 is "
    "20 to 1, 8 is 3000 to 1."
)
"""What must be known to read it."""

CALIBRATIONS = 12
"""What is known better now that the page shows; JSON has all."""

CLOSE = 3.0
"""[nats] from which what was not worth a name is worth a word: 20 to 1."""

SAID_ALL = (results.NOTHING, results.MISSING, results.AMBIGUOUS, results.SEVERAL)
"""Verdicts of which the one sentence says all that a text would."""

NOT_FITTED = (results.MISTAKE, results.NONLINEAR)
"""Verdicts of which the model as it was is held against the data without a fit, so that there is no evidence to compare."""


def explained(one: results.Cause) -> doc.Grid:
    """One cause for somebody who never heard of it."""
    lines = (
        ("means", one.text),
        *((("these data say", one.note),) if one.note else ()),
        ("mistaken for", ", ".join(one.mistaken_for) or NONE),
        ("confirm it by", one.confirmed_by or NONE),
    )
    return doc.Grid(header=(one.id, one.named.what), lines=lines, words=True, caption="What it means, and what confirms it")


@dataclass(frozen=True, eq=False, kw_only=True)
class DiagnosisPage:
    """What a page says of the diagnosis that was `found`, part by part."""

    found: results.Diagnosis

    def document(self) -> doc.Document:
        """All of it, in the order in which it is read."""
        from validation.report.charts.crosscheck import before_and_after, evidence

        found = self.found
        after = None if found.after is found.before else found.after
        return doc.Document(
            opening=tuple(self.opening()),
            blocks=(
                self.causes(),
                doc.Drawn(lambda: evidence(found)) if tried(found) else None,
                self.tried(),
                *map(explained, found.accepted),
                self.alike() if len(found.equivalence_class) > 1 else None,
                self.advice(),
                self.leftover(),
                self.everywhere(),
                self.pictured,
                self.levels(),
                None if after is None else doc.Drawn(lambda: before_and_after(found.before, after)),
                self.errors(),
                self.errors_of_page(),
                *correlation_tables(found.correlation),
                self.ranking(),
                self.known_better() if found.known_better else None,
                self.steps(),
                grid(found.detectable) if found.detectable and found.verdict == results.NOTHING else None,
            ),
            notes=tuple(self.notes()),
        )

    def opening(self) -> Iterator[str]:
        """The verdict in one sentence, and what there is to say of it."""
        first = results.headline(self.found)
        yield first
        if self.found.text and self.found.verdict not in SAID_ALL:
            yield self.found.text
        if self.found.verdict == results.NOTHING and self.found.ranking and self.found.ranking[0].evidence >= CLOSE:
            one = self.found.ranking[0]
            cause = results.cause(one)
            likely = f"{one.evidence:.1f} nats, {odds(one.evidence)}"
            yield f"The closest is {cause}: {likely}, less than is asked for. Other data decide."

    def causes(self) -> doc.Grid | None:
        """What is missing, a line a size; one of a mistake that has none."""
        lines: list[tuple[str, ...]] = []
        for one in self.found.accepted:
            evidence, likely = nats(one.evidence), odds(one.evidence)
            for size in one.sizes:
                value, low, high, unit = results.interval(one, size)
                interval = NONE if size.low == size.high else f"{low} to {high}"
                if end := results.open_end(one, size):
                    value, interval = f"{end} {low if end == results.AT_LEAST else high}", NONE
                lines.append((f"{one.id} {size.key}".rstrip(), value, interval, unit or NONE, evidence, likely))
                evidence = likely = ""
            if not one.sizes:
                lines.append((one.id, NONE, NONE, NONE, evidence, likely))
        if not lines:
            return None
        first, *rest = zip(*lines, strict=True)
        header = ("missing", "size", "90 % interval", "unit", "evidence [nats]", "odds")
        return doc.Grid(header=header, lines=tuple(zip(first, *[doc.aligned(column) for column in rest], strict=True)))

    def alike(self) -> doc.Grid:
        """What these data cannot tell apart."""
        before = [one for step in self.found.steps for one in step.ranking]
        known = {one.id: one for one in (*before, *self.found.ranking, *self.found.accepted)}

        def what(id: str) -> str:
            one = known.get(id)
            if one is None:
                return f"does the same to these data, and was not fitted: {FAMILIES[id.partition(':')[0]].what}"
            sizes = "; ".join(results.sized(one, size) for size in one.sizes)
            return f"{sizes}, {nats(one.evidence)} nats: {one.named.what}"

        lines = tuple((id, what(id)) for id in self.found.equivalence_class)
        header = ("one of these", "size (90 %), evidence, and what it is")
        return doc.Grid(header=header, lines=lines, words=True, caption="What these data cannot tell apart")

    def advice(self) -> doc.Table:
        """What to measure next, the best first."""

        def in_words(row: Any) -> str:
            test, separates = row[1].test, row[1].separates
            names = ["no effect at all" if one == results.NOTHING else one for one in separates]
            apart = f" It tells {results.listed(names)} apart." if len(names) > 1 else ""
            return f"{test[:1].upper()}{test[1:].rstrip('.')}.{apart}"

        return doc.Table(
            caption="The next measurement, the best first",
            rows=list(enumerate(self.found.advice, start=1)),
            columns=(
                doc.Column("next", lambda row: f"{row[0]}", words=True),
                doc.Column(
                    "expected evidence", lambda row: row[1].gain if row[1].gain > 0 else None, ".3g", unit="nats", on=doc.PAGE
                ),
                doc.Column(
                    "expected nats", lambda row: two_digits(g) if (g := row[1].gain) > 0 else NONE, aligned=False, on=doc.TERMINAL
                ),
                doc.Column("work", lambda row: row[1].hours or None, "g", unit="h", on=doc.PAGE),
                doc.Column(MEASURE, lambda row: row[1].test, words=True, on=doc.PAGE),
                doc.Column("tells apart", lambda row: results.listed(row[1].separates), words=True, on=doc.PAGE),
                doc.Column(MEASURE, in_words, words=True, on=doc.TERMINAL),
            ),
        )

    def leftover(self) -> doc.Grid | None:
        """What no effect explains."""
        of = self.found.leftover
        if of is None:
            return None
        where = f"{of.load} by {of.motion}" if of.load else ", ".join(of.channels[:4])
        lines = (
            ("what is left", "" if of.text in self.found.text else of.text),
            ("looks like", of.looks_like),
            ("where", where),
            ("size", "" if of.size is None else with_unit(f"{of.size:.3g}", of.unit)),
            ("resonance at", "" if of.frequency is None else f"{of.frequency:.2f} Hz"),
            ("share of it that this covers", f"{100 * of.share:.0f} %" if of.share > 0 else ""),
        )
        kept = tuple(line for line in lines if line[1] not in ("", NONE))
        return doc.Grid(header=("leftover", "in words"), lines=kept, words=True, caption="What no effect explains")

    def everywhere(self) -> doc.Grid | None:
        """Where on the mesh something of each kind would explain most."""
        lines = []
        for one in self.found.everywhere:
            at = ", ".join(f"{round(1e3 * value, 2) + 0.0:.4g}" for value in one.position)
            away = NONE if one.distance is None else f"{one.nearest}, {1e3 * one.distance:.3g} mm away"
            sizes = ", ".join(said(one.named.values[size.key], size.unit, 3) for size in one.named.sizes)
            lines.append((one.named.id, sizes, nats(one.evidence), at, away))
        if not lines:
            return None
        header = ("everywhere on the mesh", "size", "evidence [nats]", "x, y, z [mm]", "nearest place with a name")
        return doc.Grid(header=header, lines=tuple(lines), words=True, caption="Everywhere on the mesh")

    def pictured(self, figures: doc.Figures) -> doc.Safe | None:
        """The same on the user's own mesh; nothing where nothing can be drawn."""
        with TemporaryDirectory() as folder, suppress(CheckFailed, ModuleNotFoundError):
            if made := draw_nodes(self.found.nodes, self.found.everywhere, Path(folder) / EVERYWHERE):
                return parts.picture(parts.Picture(png=made.read_bytes(), said=f"Everywhere on the mesh. {NOTE}"))
        return None

    def levels(self) -> doc.Grid:
        """Axes that answer otherwise at another level."""
        lines = tuple(
            (
                f"{one.data_set}: {one.runs[0]} against {one.runs[1]}",
                two_digits(one.sigma),
                f"{one.axis}, most at {one.frequency:.1f} Hz, in {results.listed(one.channels)}",
            )
            for one in self.found.levels
        )
        header = ("two levels", "sigma", "axis, and where")
        return doc.Grid(header=header, lines=lines, words=True, caption="Two levels that do not give the same")

    def errors(self) -> doc.Grid:
        """The four errors without and with what was accepted."""
        before, after = self.found.before, self.found.after
        both = (before,) if before is after else (before, after)
        kept = [(name, cells) for name, cells in parts.error_lines(*both) if set(cells) != {NONE}]
        gain = after.fitted.log_evidence - before.fitted.log_evidence
        if len(both) > 1 and self.found.verdict not in NOT_FITTED:
            kept.append(("evidence gained [nats]", [NONE, nats(gain)]))
        columns = [doc.aligned(tuple(column)) for column in zip(*(cells for _, cells in kept), strict=True)]
        header = ("the four errors", "before", "after") if len(both) > 1 else ("the four errors", "now")
        return doc.Grid(header=header, lines=tuple(zip((name for name, _ in kept), *columns, strict=True)))

    def errors_of_page(self) -> doc.Table:
        """The same for a page, an error a row with its unit; none where nothing was found."""
        before, after = parts.error_figures(self.found.before), parts.error_figures(self.found.after)
        changed = self.found.after is not self.found.before
        return doc.Table(
            caption="The errors before and after what was found is added",
            note=(
                "Made at fewer lines than those of a comparison; where resonances of model and data do not overlap, over a "
                f"model error of {COARSE[0]:.0%}.".replace("%", " %")
            ),
            rows=[row for row in parts.ERRORS if before[row[2]] is not None and changed],
            columns=(
                doc.Column("error", lambda row: row[0], words=True),
                doc.Column("unit", lambda row: row[1], words=True),
                doc.Column("before", lambda row: before[row[2]]),
                doc.Column("after", lambda row: after.get(row[2])),
            ),
            on=doc.PAGE,
        )

    def known_better(self) -> doc.Table:
        """What of the laboratory is known better now, the surest first."""
        shown = self.found.known_better[:CALIBRATIONS]

        def figures(one: results.KnownBetter) -> tuple[tuple[str, ...], str]:
            return written_as(one.unit, (one.value, one.low, one.high))

        def admitted(one: results.KnownBetter) -> str:
            (text,), unit = written_as(one.unit, (one.before,), signed=False)
            return with_unit(text, unit)

        return doc.Table(
            caption="Known better now: what is within the class of the laboratory, and not missing",
            rows=shown,
            columns=(
                doc.Column("known better now", lambda one: one.id, words=True),
                doc.Column("value", lambda one: figures(one)[0][0]),
                doc.Column("90 % interval", lambda one: "{1} to {2}".format(*figures(one)[0])),
                doc.Column("unit", lambda one: figures(one)[1] or NONE, words=True),
                doc.Column("admitted (sd)", admitted, words=True),
            ),
        )

    def tried(self) -> doc.Table:
        """Every cause that was tried, a line for each of its numbers: name, value, both ends of its interval, unit."""
        rows: list[tuple[results.Cause, tuple[doc.Cell, ...]]] = []
        for one in tried(self.found):
            for size in one.sizes:
                *figures, unit = results.interval(one, size)
                value, low, high = (doc.Number(value=float(text), text=text.replace("-", "−")) for text in figures)
                fitted = size.low != size.high
                rows.append((one, (size.key, value, *((low, high) if fitted else (EMPTY, EMPTY)), unit)))
            if not one.sizes:
                rows.append((one, (NONE, EMPTY, EMPTY, EMPTY, "")))
        several = any(figures[0] not in ("", NONE) for _, figures in rows)  # of one size the cause says what it is
        return doc.Table(
            caption="Causes that were tried, the best first",
            rows=rows,
            columns=(
                doc.Column("cause", lambda row: row[0].id, words=True),
                doc.Column("evidence", lambda row: row[0].evidence, nats, unit="nats"),
                doc.Column("asked for", lambda row: evidence_threshold(row[0].named.family), "g", unit="nats"),
                *([doc.Column("number", lambda row: row[1][0], words=True)] if several else []),
                doc.Column("size", lambda row: row[1][1]),
                doc.Column("from", lambda row: row[1][2]),
                doc.Column("to", lambda row: row[1][3]),
                doc.Column("unit", lambda row: row[1][4], words=True),
                doc.Column("χ² per dof", lambda row: row[0].misfit, ".3g"),
                doc.Column("prior penalty", lambda row: row[0].price, ".3g"),
                doc.Column("so", lambda row: standing_of(self.found, row[0]), words=True),
            ),
            note=(
                "From and to: 90 % interval. Prior penalty: sum of z² of the tolerances with it, over what is due in a "
                "sound laboratory. What adds too little brings less than is asked for, beside what was accepted."
            ),
            on=doc.PAGE,
        )

    def ranking(self) -> doc.Table:
        """What was tried, the best first, with its first size and why it stands where it stands."""

        def size(one: results.Cause) -> str:
            if not one.sizes:
                return NONE
            value, _, _, unit = results.interval(one, one.sizes[0])
            return with_unit(value, unit)

        return doc.Table(
            rows=self._telling,
            columns=(
                doc.Column("tried", lambda one: one.id, words=True),
                doc.Column("size", size),
                doc.Column("evidence [nats]", lambda one: nats(one.evidence)),
                doc.Column("chi²", lambda one: f"{one.misfit:.3g}"),
                doc.Column("prior penalty", lambda one: f"{one.price:.3g}" if isfinite(one.price) else NONE),
                doc.Column("so", lambda one: standing_of(self.found, one), words=True),
            ),
            on=doc.TERMINAL,
        )

    @property
    def _telling(self) -> list[results.Cause]:
        """Of what was ranked last what data speak for."""
        ranked = {one.id for one in self.found.ranking}
        return [one for one in tried(self.found) if one.id in ranked][:RANKED]

    def steps(self) -> doc.Grid:
        """How it was found."""
        told = [one.text if one.text.startswith(one.added) else f"{one.added}: {one.text}" for one in self.found.steps]
        both = enumerate(zip(self.found.steps, told, strict=True), start=1)
        lines = tuple((f"{k}", f"{one.misfit:.3g}", f"{one.price:.3g}", text) for k, (one, text) in both)
        return doc.Grid(
            header=("round", "chi²", "prior penalty", "how it was found"), lines=lines, words=True, caption="How it was found"
        )

    def notes(self) -> Iterator[str]:
        """What must be known to read the tables, then what was assumed."""
        yield IN_NATS
        yield (
            "Prior penalty: sum of z² of all tolerances over what is due in a sound laboratory. Chi² alone says little: "
            "tolerances that a fit moves far enough swallow nearly any fault."
        )
        if (more := sum(one.evidence >= crosscheck.LEAST for one in self.found.ranking) - len(self._telling)) > 0:
            yield f"{more} more effects were tried; --json has all of them."
        if self.found.known_better:
            more = len(self.found.known_better) - CALIBRATIONS
            correct = "`massline correct` takes gains, delays and places of these out of a record"
            yield f"Known better now: within what the class of the laboratory admits, and so not missing; {correct}."
            if more > 0:
                yield f"--json has {more} more of them."
        if self.found.detectable and self.found.verdict != results.NOTHING:
            yield f"--json has the smallest size at which each of {len(self.found.detectable)} effects would have been named."
        if self.found.verdict == results.NONLINEAR:
            yield "A linear fit of such data names nonsense: the errors are those of the model as it is."
        if self.found.hold_out:
            yield f"Used only for checking (held out): {results.listed(self.found.hold_out)}."
        yield from (f"warning: {text.rstrip('.')}." for text in self.found.remarks)


def document(found: results.Diagnosis) -> doc.Document:
    """All of a diagnosis, in the order in which it is read."""
    return DiagnosisPage(found=found).document()


# `massline diagnose` from options to output: read, diagnose, show; with `--auto`, climb.


def diagnosis_answer(asked: Options, *, auto: bool, as_json: bool, folder: Path | None) -> None:
    """Diagnose what is `asked`, print it, and write JSON and pictures into `folder` (None: nowhere); where `auto`, climb.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    CheckFailed : a model that breaks down.
    OSError : with `auto`, the model file cannot be written.
    """
    if files := only_files(asked.data):
        answer(asked, files, auto=auto, as_json=as_json, folder=folder)
        return
    if auto and asked.path.is_file():
        probe(asked.path)  # what cannot be written at the end is said before minutes are spent
    bench = prepared(asked, quiet=as_json)
    if auto:
        found, more = _climbed(asked, bench, as_json=as_json)
    else:
        with stages("diagnosing", quiet=as_json) as told:
            found, more = diagnosis(asked, bench, told), {}
    whole = {**of_asked(asked, bench), **to_json(found), **more}
    file = None if folder is None else folder / RESULT
    print_answer(lambda: whole, lambda: "" if auto else text(asked, bench, found), as_json=as_json, file=file)
    if folder is None:
        return
    with share_done("pictures", quiet=as_json) as share:
        paths = draw(found, folder)
        if found.leftover is not None:
            paths += draw_left(found, bench, folder, share)
    wrote(*paths)


def prepared(asked: Options, *, quiet: bool = True) -> Study:
    """The bench that `asked` leads to.

    Raises
    ------
    BadInput : something that was asked cannot be used.
    """
    with stages("reading", quiet=quiet) as told:
        model, data = ready(asked, told)
        made = Study.of(model, data, asked, told)
    for text in asked.candidates:
        require_levels(made, text)
    return made


def diagnosis(asked: Options, bench: Study, progress: Progress | None = None) -> results.Diagnosis:
    """What is missing on `bench`.

    Raises
    ------
    CheckFailed : a model that breaks down.
    """
    return diagnose.diagnosed_once(bench, only=asked.candidates, leave_out=asked.leave_out, progress=progress)


def _climbed(asked: Options, bench: Study, *, as_json: bool) -> tuple[results.Diagnosis, dict[str, Any]]:
    """The first diagnosis of a climb, and what JSON has of the others and of the ladder; the rest is printed as it comes."""

    def diagnosed(at: Study) -> results.Diagnosis:
        found = diagnosis(asked, at, told)
        if at is bench and not as_json:
            click.echo(text(asked, bench, found))
        return found

    def added(rung: Version) -> None:
        if not as_json:
            click.echo(doc.page(f"Rung {rung.number}: {rung.effect} added", (), rung.verdict))

    with stages("climbing", quiet=as_json) as told:
        found = climb(asked, bench, diagnosed, added, told)
    if not as_json:
        click.echo(f"The climb ends: {found.ended}.\n")
        click.echo(history.text(found.at) if found.at.ladder.rungs else "", nl=False)
    rounds = [
        {"verdict": one.verdict, "headline": results.headline(one), "accepted": to_json(one.accepted)} for one in found.rounds
    ]
    numbers = [rung.number for rung in found.rungs]
    more = {"ended": found.ended, "rungs": numbers, "rounds": rounds, "ladder": of_ladder(found.at)}
    return found.rounds[0], {"auto": more}


def text(asked: Options, bench: Study, found: results.Diagnosis) -> str:
    """The page of a diagnosis."""
    return replace(document(found), title=title(asked.path.name, [one.measured.name for one in bench.predictions])).text()


def of_asked(asked: Options, bench: Study) -> dict[str, Any]:
    """What was asked, as JSON."""
    return {
        "model": asked.model,
        "data": list(asked.data),
        "campaigns": [one.measured.name for one in bench.predictions],
        "hold_out": list(asked.hold_out),
        "band_hz": None if asked.band is None else list(asked.band),
        "method": asked.method,
        "candidates": list(asked.candidates),
    }


# What is missing: ranked causes with evidence and sizes, what each means and how to confirm it, the next measurement.


def html(report: parts.Report, figures: doc.Figures) -> doc.Safe:
    """The section."""
    found = report.diagnosis
    if found is None:
        told = parts.paragraphs([f"It was not looked for: {report.not_diagnosed or 'nobody asked'}."])
        return parts.section("missing", "What is missing", told)
    above = [*ComparisonPage(found=report.comparison).notes()]  # which the page has
    said = document(replace(found, correlation=()))
    first, *others = said.opening
    return parts.section(
        "missing",
        "What is missing",
        doc.tag("p", first, class_="headline"),
        parts.paragraphs(others),
        *said.html(figures),
        parts.notes([one for one in said.notes if one not in above and "--json" not in one]),
    )
