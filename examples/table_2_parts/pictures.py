"""The two pictures of the page."""

from __future__ import annotations

import json
from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from pathlib import Path

import numpy as np

from geometry.frames import Array
from table_2_parts.published import DEVIATIONS, NAMES, UNITS, deviation_of_reading
from table_2_parts.story import Story, title
from validation.report.charts import spec
from validation.report.charts.static import finish, grid_lines, new_figure, require_format

FAMILIES = 9
"""That are drawn."""

NOTE = "A reconstruction of Clumod, FMD and sensors, not the real ones. Reference ± 1 % and ± 1 mm, and the rounding of the print"


def explained(story: Story) -> dict[str, Array]:
    """The explanations that are drawn: their faults alone, in a laboratory without tolerances."""
    chosen = {title(one.of): one.alone for one in (story.turn, story.pairs[0], story.triples[0], story.unturned[0])}
    return {"elasticity, 4-5 Hz": story.elastic[5.0][0], **chosen}


def figures(story: Story) -> Mapping[str, object]:
    """What the pictures show, for a test to see that they are those of the present code."""
    return {
        "explained": {name: [round(float(value), 3) for value in values] for name, values in explained(story).items()},
        "families": dict(list(story.found.of_families().items())[:FAMILIES]),
        "menu": dict(story.menu),
    }


def draw(story: Story, folder: Path) -> tuple[Path, Path]:
    """Both pictures, into `folder`."""
    folder.mkdir(parents=True, exist_ok=True)
    about = json.dumps(figures(story))
    numbers, shares = folder / "table-2.png", folder / "table-2-decide.png"
    drawn = DrawnNumbers(
        labels=tuple(f"{name} [{unit}]" for name, unit in zip(NAMES, UNITS, strict=True)),
        found=DEVIATIONS,
        deviation=deviation_of_reading(),
        explained=explained(story),
    )
    draw_numbers("Table 2 and what would make it", drawn, numbers, NOTE, about)
    families = dict(list(story.found.of_families().items())[:FAMILIES])
    menu = dict(sorted(story.menu.items(), key=lambda pair: -pair[1]))
    panels = (
        ShareBars(title="posterior that such a fault was there", unit="probability", shares=families),
        ShareBars(
            title="what would have decided", unit="information [nats]", shares=menu, limit=(story.doubt, "all doubt gone ")
        ),
    )
    draw_shares("How surely, and what would have decided", panels, shares, NOTE, about)
    return numbers, shares


# Explanations beside what they are to explain: grouped bars of a few numbers, and shares as lying bars.


SHOWN = 0.05
"""Below which a figure of one decimal is nothing."""

WIDTH = 0.82
"""Of a group of bars, where the distance of groups is 1."""


@dataclass(frozen=True, eq=False, kw_only=True)
class DrawnNumbers:
    """A few numbers and what explanations make of them.

    Attributes
    ----------
    labels : (k,) with their units
    found : (k,) to be explained
    deviation : (k,) standard deviation of each
    explained : by explanation (k,); at most six
    """

    labels: tuple[str, ...]
    found: Array
    deviation: Array
    explained: Mapping[str, Array]


@dataclass(frozen=True, eq=False, kw_only=True)
class ShareBars:
    """A panel of lying bars.

    Attributes
    ----------
    title, unit : of the panel
    shares : by name, from top to bottom
    limit : where a dashed line stands, and what it is; None for none
    """

    title: str
    unit: str
    shares: Mapping[str, float]
    limit: tuple[float, str] | None = None


def draw_numbers(title: str, drawn: DrawnNumbers, path: Path, note: str = "", about: str = "") -> None:
    """Write a picture of `drawn`; a PNG carries the words `about`.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(14.0, 7.0)
    axes = figure.add_axes((0.06, 0.13, 0.92, 0.75))
    places, width = np.arange(len(drawn.labels)), WIDTH / (1 + len(drawn.explained))
    every = {"found": drawn.found, **drawn.explained}
    for k, ((name, values), colour) in enumerate(zip(every.items(), (spec.INK, spec.FAINT, *spec.CURVES), strict=False)):
        at = places + (k - len(drawn.explained) / 2) * width
        axes.bar(at, values, 0.92 * width, color=colour, label="Table 2, ± 1 sd" if not k else name)
        reach = drawn.deviation if not k else np.zeros(len(values))
        for x, value, beyond in zip(at, values, np.copysign(reach, values), strict=True):
            low = value < -SHOWN
            axes.text(
                x,
                value + beyond,
                f"{value + 0.0 if abs(value) > SHOWN else 0.0:.1f}",
                ha="center",
                va="top" if low else "bottom",
                fontsize=6.8,
                color=spec.INK,
            )
        if not k:
            axes.errorbar(at, values, drawn.deviation, fmt="none", ecolor="#f28a1c", elinewidth=1.6, capsize=3)
    axes.axhline(0.0, color=spec.INK, linewidth=0.8)
    axes.set_xticks(places, drawn.labels, fontsize=10)
    axes.set_ylabel("deviation from the reference", fontsize=9.5)
    axes.legend(fontsize=9, loc="upper left", framealpha=0.9)
    grid_lines(axes)
    axes.tick_params(axis="x", labelsize=10)
    finish(figure, title, note, path, about)


def draw_shares(title: str, panels: Sequence[ShareBars], path: Path, note: str = "", about: str = "") -> None:
    """Write a picture of `panels` side by side; a PNG carries the words `about`.

    Raises
    ------
    BadInput : the ending of `path` is unknown.
    """
    require_format(path)
    figure = new_figure(15.0, 6.0)
    for k, (panel, left) in enumerate(zip(panels, np.linspace(0.0, 1.0, len(panels) + 1), strict=False)):
        whole = 1.0 / len(panels)
        axes = figure.add_axes((left + 0.5 * whole, 0.14, 0.44 * whole, 0.7))
        colour = spec.CURVES[k % len(spec.CURVES)]
        places, values = np.arange(len(panel.shares)), np.array(list(panel.shares.values()))
        axes.barh(places, values, 0.7, color=colour)
        for place, value in zip(places, values, strict=True):
            axes.text(value, place, f" {value:.2g}", va="center", fontsize=8.5, color=spec.INK)
        most = float(values.max(initial=0.0))
        if panel.limit is not None:
            at, words = panel.limit
            most = max(most, at)
            axes.axvline(at, color=spec.INK, linewidth=1.2, linestyle=(0, (5, 3)))
            axes.text(at, -0.75, words, ha="right", va="center", fontsize=8.5, color=spec.INK)
        axes.set_xlim(0.0, 1.18 * most)
        axes.set_ylim(len(values) - 0.4, -1.1 if panel.limit else -0.6)
        axes.set_yticks(places, list(panel.shares), fontsize=9)
        axes.set_title(panel.title, fontsize=11, loc="right", color=spec.INK)
        axes.set_xlabel(panel.unit, fontsize=9.5)
        grid_lines(axes)
        axes.grid(visible=False, axis="y")
    finish(figure, title, note, path, about)
