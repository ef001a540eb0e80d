"""The two pictures of the page."""

from __future__ import annotations

import json
from collections.abc import Mapping
from pathlib import Path

from geometry.frames import Array
from table_2_parts.published import DEVIATIONS, NAMES, UNITS, deviation_of_reading
from table_2_parts.story import Story, title
from validation.report.charts.crosscheck import DrawnNumbers, ShareBars, draw_numbers, draw_shares

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
