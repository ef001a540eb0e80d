"""The tolerance of a result, itemised: what each input contributes, and which one dominates."""

from __future__ import annotations

import math
from collections import defaultdict
from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING, Any

from validation.rows import MIN_WORDS, headline, rounded

if TYPE_CHECKING:
    from rich.table import Table
    from uncertainties import UFloat


@dataclass(frozen=True, eq=False, kw_only=True)
class Item:
    """One input's part in the tolerance of a result.

    Attributes
    ----------
    name : the input's name
    value, tolerance : of the input, SI; of the first one where several share the name (readings of one kind)
    contribution : |d result / d input| times the tolerance, in the unit of the result
    share : of the result's variance, 0 to 1
    """

    name: str
    value: float
    tolerance: float
    contribution: float
    share: float


def itemised(result: UFloat) -> tuple[Item, ...]:
    """The inputs that make the tolerance of `result`, the largest first; inputs of one name are taken together."""
    parts: dict[str, list[tuple[Any, float]]] = defaultdict(list)
    for variable, part in result.error_components().items():
        parts[variable.tag or "unnamed"].append((variable, part))
    variance = sum(part**2 for named in parts.values() for _, part in named)
    items = [_item(name, named, variance) for name, named in parts.items()]
    return tuple(sorted((item for item in items if item.contribution > 0), key=lambda item: -item.contribution))


def dominating(result: UFloat) -> str:
    """Name of the input with the largest share; empty when `result` is exact."""
    items = itemised(result)
    return items[0].name if items else ""


def budget_json(items: Sequence[Item]) -> list[dict[str, Any]]:
    """`items` for machine reading; contributions in the unit of the result, in SI."""
    return [
        {"input": i.name, "value_si": i.value, "tolerance_si": i.tolerance, "contribution_si": i.contribution, "share": i.share}
        for i in items
    ]


def budget_table(items: Sequence[Item], title: str, unit: str, factor: float) -> Table:
    """`items` as a table to print; contributions in `unit`, which is SI times `factor`."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(title=headline(title), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    table.add_column("input", min_width=MIN_WORDS)
    for heading in ("value (SI)", "tolerance (SI)", f"contributes\n[{unit}]", "share of variance"):
        table.add_column(Text(heading), justify="right")
    for item in items:
        shown = (rounded(item.value, item.tolerance), f"{item.tolerance:.3g}", f"{factor * item.contribution:.2g}")
        table.add_row(Text(item.name), *shown, f"{100 * item.share:.1f} %")
    return table


def _item(name: str, named: list[tuple[Any, float]], variance: float) -> Item:
    contribution = math.sqrt(sum(part**2 for _, part in named))
    first = named[0][0]
    share = contribution**2 / variance if variance else 0.0
    return Item(name=name, value=first.nominal_value, tolerance=first.std_dev, contribution=contribution, share=share)
