"""The tables of the story."""

from __future__ import annotations

from collections.abc import Iterator, Sequence

import numpy as np

from table_2_parts.exact import Refined
from table_2_parts.inference import Explanation
from table_2_parts.published import DEVIATIONS, NAMES, UNITS, deviation_of_reading
from table_2_parts.story import Story, title
from validation.report.document import Grid, page

WIDEST = 150
"""Columns."""


def told(story: Story) -> Iterator[str]:
    """All sections, one after the other."""
    yield page("1  What elasticity does that is not taken off", [elastic(story)], [], WIDEST)
    yield page("2  Tolerances alone", [alone(story)], [_scatter(story)], WIDEST)
    yield page("3  One effect with elasticity, the axes right", [effects(story, story.singles)], [_mistake(story)], WIDEST)
    yield page("4  Explanations", [numbers(story.leading), effects(story, story.leading)], [_counts(story)], WIDEST)
    yield page("5  How surely", [families(story), settings(story)], [_bands(story)], WIDEST)
    yield page("6  What would have decided", [menu(story)], [_doubt(story)], WIDEST)
    if story.records:
        yield page("7  The same from records, simulated in time", [records(story)], [], WIDEST)


def elastic(story: Story) -> Grid:
    """By band, and by how Clumod stood."""
    lines = [("Table 2", "", *_seven(DEVIATIONS)), ("± 1 sd", "", *_seven(deviation_of_reading()))]
    for stop, found in story.elastic.items():
        band = f"4-{stop:g} Hz" if stop else "taken off"
        lines += [
            (band, stood, *_seven(one)) for stood, one in zip(("as the reference", "x and y exchanged"), found, strict=True)
        ]
    return Grid(header=("band", "Clumod", *_names()), lines=tuple(lines))


def alone(story: Story) -> Grid:
    """chi² of tolerances alone."""
    lines = [
        (f"x {scale:g}", "exchanged" if turned else "right", one.way.name, f"{one.chi2:.1f}", f"{one.probability:.1e}")
        for (scale, turned), one in story.alone.items()
    ]
    return Grid(header=("tolerances", "axes", "read by", "chi² of 7", "chance"), lines=tuple(lines))


def numbers(refined: Sequence[Refined]) -> Grid:
    """The seven numbers by each explanation: faults alone, and what is left with tolerances where they are most probable."""
    lines = [("Table 2", *_seven(DEVIATIONS))]
    for one in refined:
        lines.append((title(one.of), *_seven(one.alone)))
        lines.append(("  left, in sd", *_seven(one.left)))
    return Grid(header=("explanation", *_names()), lines=tuple(lines))


def effects(story: Story, refined: Sequence[Refined]) -> Grid:
    """Sizes, their price and what they gain."""
    lines = []
    for one in refined:
        lines.append(
            (
                title(one.of),
                one.of.way.name,
                "; ".join(sizes(one)) or "-",
                f"{one.chi2:.1f}",
                f"{gain(story, one.of):+.1f}",
                f"{100 * posterior(story, one.of):.2g} %",
            )
        )
    return Grid(header=("explanation", "read by", "size (in plausible sizes)", "chi²", "nats", "posterior"), lines=tuple(lines))


def families(story: Story) -> Grid:
    """Posterior of the families."""
    shares = list(story.found.of_families().items())[:9]
    return Grid(header=("family", "posterior"), lines=tuple((name, f"{share:.3f}") for name, share in shares))


def settings(story: Story) -> Grid:
    """How sure the exchanged axes are, by what is assumed."""
    lines = [(f"x {scale:g}", f"{reference:g} %, mm", f"{share:.4f}") for (scale, reference), share in story.turned.items()]
    return Grid(header=("tolerances", "reference", "axes exchanged"), lines=tuple(lines))


def menu(story: Story) -> Grid:
    """What each measurement holds."""
    best = sorted(story.menu, key=lambda name: -story.menu[name])
    return Grid(header=("measurement", "information [nats]"), lines=tuple((name, f"{story.menu[name]:.2f}") for name in best))


def records(story: Story) -> Grid:
    """Two paths to one reading."""
    by_name = {title(one.of): one.alone for one in story.leading}
    lines = []
    for name, found in story.records.items():
        lines.append((name, "frequency", *_seven(by_name[name])))
        lines.append(("", "records", *_seven(found)))
        lines.append(("", "apart", *(f"{value:.3f}" for value in found - by_name[name])))
    return Grid(header=("explanation", "path", *_names()), lines=tuple(lines))


def sizes(of: Refined) -> list[str]:
    """Of the faults, in their units and in plausible sizes."""
    pairs = zip(of.of.faults, of.sizes, strict=True)
    return ["off" if one.switch else f"{_size(size, one.unit)} ({abs(size) / one.plausible:.1f})" for one, size in pairs]


def _size(size: float, unit: str) -> str:
    return f"{100 * size:.3g} %" if unit == "1" else f"{size:.3g} {unit}"


def gain(story: Story, of: Explanation) -> float:
    """[nats] of evidence over tolerances alone, each by its best way."""
    nothing = max(one.log_evidence[0] for one in story.found.tried if one.chosen.shape[1] == 0 and not one.of.way.turned)
    return of.log_evidence - float(nothing)


def posterior(story: Story, of: Explanation) -> float:
    """Probability of this set by this way."""
    return float(np.exp(of.log_posterior - story.found.total))


def _scatter(story: Story) -> str:
    one = story.alone[1.0, False]
    said = ", ".join(f"{name} {value:.2f} {unit}" for name, value, unit in zip(NAMES, one.scatter, UNITS, strict=True))
    return f"They scatter the seven by {said} (1 sd, {one.way.name})."


def _mistake(story: Story) -> str:
    name, chi2, tried = story.mistake
    return f"Of {tried} mistakes of polarity or of swapped channels the nearest is {name}, chi² {chi2:.0f}."


def _counts(story: Story) -> str:
    shares = story.found.of_counts()
    return "Faults: " + ", ".join(f"{count} {shares[count]:.2g}" for count in sorted(shares)) + " (probability)."


def _bands(story: Story) -> str:
    shares = story.found.of_ways(lambda way: f"4-{way.stop:g} Hz" if way.stop else "elasticity taken off")
    return "Read by: " + ", ".join(f"{name} {share:.3f}" for name, share in shares.items()) + " (probability)."


def _doubt(story: Story) -> str:
    return f"Doubt among the explanations asked about: {story.doubt:.2f} nats; they have {story.share:.2f} of the posterior."


def _seven(values: Sequence[float] | np.ndarray) -> tuple[str, ...]:
    return tuple(f"{value:.2f}" for value in values)


def _names() -> tuple[str, ...]:
    return tuple(f"{name} {unit}" for name, unit in zip(NAMES, UNITS, strict=True))
