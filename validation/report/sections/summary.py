"""Five sentences: what was held against what, how well it fits, where it fails, what is missing, and what the article weighs."""

from __future__ import annotations

from validation.comparing.verdicts import DOUBTFUL, FAILED, GOOD, STANDS_OUT, percent
from validation.comparing.words import text
from validation.diagnosing import words
from validation.identifying.known import FMD
from validation.ladders.nouns import Body
from validation.report.figures import Figures
from validation.report.markup import Safe, joined, tag, worded
from validation.report.nouns import CampaignPart, Report
from validation.report.sections.parts import section, verdict
from validation.rows import rounded
from validation.statement import QUANTITIES

RAW = "From the raw records alone, which know no effect: "
"""Before what was identified without the model."""


def html(report: Report, figures: Figures) -> Safe:
    """The section."""
    said = (_data(report), _errors(report), _worst(report), _missing(report), _inertia(report))
    return section("summary", "Summary", tag("ol", *(tag("li", one) for one in said), class_="summary"))


def _data(report: Report) -> Safe:
    maps, classical = report.comparison.maps, len(report.classical)
    runs, lines = sum(len(one.runs) for one in maps), sum(len(one.runs) * len(one.frequency) for one in maps)
    low, high = min(one.frequency[0] for one in maps), max(one.frequency[-1] for one in maps)
    files = f" and {classical} classical measurement{'s' if classical != 1 else ''}" if classical else ""
    many = f"{len(maps)} campaign{'s' if len(maps) != 1 else ''}"
    where = f"{lines} lines between {low:.4g} and {high:.4g} Hz"
    return joined(f"{report.comparison.title} was held against {many} of {runs} runs{files}: {where}.")


def _errors(report: Report) -> Safe:
    _, plain, _, held = report.comparison.errors
    of = report.comparison.evaluation
    told = f"With the sensors as calibrated it misses the measured forces by {percent(of.plain.percent)} "
    if of.held_out is None:
        return joined(told, verdict(plain.verdict), ".")
    seen = f", those of data that no fit has seen by {percent(of.held_out.percent)} "
    return joined(told, verdict(plain.verdict), seen, verdict(plain.verdict if held.verdict == GOOD else held.verdict), ".")


def _worst(report: Report) -> Safe:
    spots = report.comparison.worst
    if not spots or spots[0].sigma < STANDS_OUT:
        peak = f", the worst spot being at {spots[0].sigma:.1f} sigma" if spots else ""
        return joined(f"Nowhere does it fail by more than chance{peak} ", verdict(GOOD), ".")
    return joined("It fails most at ", tag("em", text(spots[0], len(report.comparison.maps))), " ", verdict(FAILED), ".")


def _missing(report: Report) -> Safe:
    found = report.diagnosis
    if found is None:
        return joined(f"What is missing was not looked for: {report.not_diagnosed or 'nobody asked'}.")
    then = f" Next measurement: {found.next_measurement.rstrip('.')}." if found.next_measurement else ""
    return joined(words.headline(found), then)


def _inertia(report: Report) -> Safe:
    known = [(part, part.findings.article) for part in report.campaigns if part.findings is not None]
    alone = [part for part, article in known if article.split("+")[0] != FMD]
    told = [_identified(part) for part in alone or [part for part, _ in known]]
    raw = joined(RAW, *_between(told), ".") if told else joined("No inertia was identified from the raw records.")
    if report.identified:
        lead = "with the effects of the model" if report.comparison.effects else "with the model, which has no effects"
        return joined(
            f"Identified {lead}: ", *_between([_corrected(one) for one in report.identified]), ". ", raw, _uncorrected(report)
        )
    why = f" With the effects of the model no inertia was identified: {report.not_identified}" if report.not_identified else ""
    return joined(raw, why, _uncorrected(report))


def _uncorrected(report: Report) -> Safe:
    """That what was diagnosed is not in the model yet."""
    there = set(report.comparison.effects)
    found = [one.id for one in report.diagnosis.accepted if one.id not in there] if report.diagnosis is not None else []
    told = f" Nothing of this knows {words.listed(found)} yet, which the model lacks: `massline add` adds it." if found else ""
    return worded(told)


def _corrected(body: Body) -> Safe:
    """Mass, CoG and moments with their intervals beside the model's, and how many of the ten values lie outside."""
    mass = _beside(body, slice(0, 1))
    within = verdict("within", GOOD) if abs(body.distance[0]) <= body.half_width[0] else verdict("outside", DOUBTFUL)
    beyond = int((abs(body.distance) > body.half_width).sum())
    of_ten = f"{beyond} of the ten values outside" if beyond else "all ten values inside"
    rest = f"; CoG {_beside(body, slice(1, 4))}; moments about it {_beside(body, slice(4, 7))}; {of_ten} their intervals"
    return joined(f"{body.article} weighs {mass}, ", within, rest)


def _beside(body: Body, which: slice) -> str:
    """Some of the ten with half their 95 % intervals, and the model's."""
    values, half, model = (one[which] * QUANTITIES[which][0].per_si for one in (body.values, body.half_width, body.reference))
    told = ", ".join(f"{rounded(x, h)} ± {rounded(h, h)}" for x, h in zip(values, half, strict=True))
    own = ", ".join(rounded(x, h) for x, h in zip(model, half, strict=True))
    return f"{told} {QUANTITIES[which][0].unit} (95 %), the model {own}"


def _between(parts: list[Safe]) -> list[str]:
    return [piece for k, one in enumerate(parts) for piece in ([one] if k == 0 else ["; ", one])]


def _identified(part: CampaignPart) -> Safe:
    found = part.findings
    if found is None:
        return Safe("")
    best, mass = found.result, QUANTITIES[0]
    value, half = float(best.values[0]) * mass.per_si, float(best.half_width[0]) * mass.per_si
    carried = ", the FMD's moving part included," if found.article.split("+")[0] == FMD else ""
    told = f"{found.article}{carried} weighs {rounded(value, half)} ± {rounded(half, half)} kg ({best.identified.way}, 95 %)"
    doubted = joined(", ", verdict(DOUBTFUL), f" since {found.doubts[0]}") if found.doubts else None
    known = None if part.reference is None else part.reference.values[0]
    if known is None:
        return joined(told, doubted)
    within = abs(value - known.value * mass.per_si) <= half + (known.tolerance or 0.0) * mass.per_si
    drawn = f", drawn {known.value * mass.per_si:.4g} kg, "
    return joined(told, drawn, verdict("within", GOOD) if within else verdict("outside", DOUBTFUL), doubted)
