"""`Reduction`: what a measurement file comes down to, as rows, as budgets, on paper and as JSON."""

from __future__ import annotations

from collections.abc import Iterator, Mapping
from dataclasses import dataclass, field
from typing import TYPE_CHECKING, Any

from geometry.quantities import doubtful_at_first_order
from validation.budget import budget_json, budget_table, dominating, itemised
from validation.rows import Row, rows_json, rows_table

if TYPE_CHECKING:
    from rich.console import RenderableType
    from uncertainties import UFloat

QUANTITIES = {
    "mass": ("mass", "kg", 1.0),
    "cog_x": ("CoG x", "mm", 1e3),
    "cog_y": ("CoG y", "mm", 1e3),
    "cog_z": ("CoG z", "mm", 1e3),
    "Ixx": ("MoI xx about the CoG", "kg m²", 1.0),
    "Iyy": ("MoI yy about the CoG", "kg m²", 1.0),
    "Izz": ("MoI zz about the CoG", "kg m²", 1.0),
    "Ixy": ("PoI xy about the CoG", "kg m²", 1.0),
    "Ixz": ("PoI xz about the CoG", "kg m²", 1.0),
    "Iyz": ("PoI yz about the CoG", "kg m²", 1.0),
    "rope_force": ("force of the crane's rope", "N", 1.0),
}
"""Key of a result -> its words, the unit it is printed in, and how many of that unit make one SI unit."""

SMALL_SHARE = 0.01
"""Share of the variance below which an input cannot spoil a result, however wide its own tolerance."""

LEVEL = "Tolerances: one level for all inputs, independent, combined in quadrature to first order."


@dataclass(frozen=True, eq=False, kw_only=True)
class Reduction:
    """The results of one measurement.

    Attributes
    ----------
    title : a sentence on what was measured
    origin : where the numbers come from; it stands with every result
    article : name of the article, empty where the file names none
    results : key of `QUANTITIES` -> value with tolerance, SI
    notes : what the user should know, sentences
    terms : key -> {correction: relative change that it makes to the result}
    assumed : whether the tolerances are assumed rather than stated by whoever measured
    """

    title: str
    origin: str
    article: str
    results: Mapping[str, UFloat]
    notes: tuple[str, ...] = ()
    terms: Mapping[str, Mapping[str, float]] = field(default_factory=dict)
    assumed: bool = False

    def rows(self, reference: Mapping[str, UFloat] | None = None) -> list[Row]:
        """One row a result, beside `reference` (same keys, SI) where it has one."""
        return [_row(key, value, (reference or {}).get(key)) for key, value in self.results.items()]

    def json(self, reference: Mapping[str, UFloat] | None = None) -> dict[str, Any]:
        """The object of the output contract, with the budgets and notes beside the rows."""
        budgets = {QUANTITIES[key][0]: budget_json(itemised(value)) for key, value in self.results.items()}
        terms = {QUANTITIES[key][0]: {name: 100 * part for name, part in parts.items()} for key, parts in self.terms.items()}
        return {
            "rows": rows_json(self.rows(reference)),
            "article": self.article,
            "origin": self.origin,
            "tolerances": "assumed" if self.assumed else "stated",
            "budget": budgets,
            "corrections_percent": terms,
            "notes": list(self.all_notes),
        }

    @property
    def all_notes(self) -> tuple[str, ...]:
        """The notes, one for every input that matters and whose tolerance is too large for first order, and `impossible`."""
        items = [item for value in self.results.values() for item in itemised(value) if item.share > SMALL_SHARE]
        wide = dict.fromkeys(item.name for item in items if doubtful_at_first_order(item.value, item.tolerance))
        said = [f"The tolerance of {name} exceeds 10 % of it: first order is doubtful." for name in wide]
        return (*self.notes, *said, *([self.impossible] if self.impossible else []))

    @property
    def impossible(self) -> str:
        """Why no body has these moments of inertia, even within their tolerance, a sentence; empty when one may have them."""
        if not {"Ixx", "Iyy", "Izz"} <= self.results.keys():
            return ""
        moments = [self.results[key] for key in ("Ixx", "Iyy", "Izz")]
        excess = 2 * max(moments, key=lambda m: m.nominal_value) - sum(moments)
        if excess.nominal_value <= excess.std_dev:
            return ""
        return f"No body has these moments: the largest exceeds the sum of the others by {excess.nominal_value:.3g} kg m²."

    def pages(self, reference: Mapping[str, UFloat] | None = None) -> Iterator[RenderableType]:
        """What a person reads: the rows, the budgets, the corrections, the notes."""
        assumed = "; tolerances ASSUMED" if self.assumed else ""
        yield rows_table(self.rows(reference), f"{self.title}\n{self.origin}{assumed}")
        for key, value in self.results.items():
            words, unit, factor = QUANTITIES[key]
            if itemised(value) and not self.assumed:
                yield budget_table(itemised(value), f"Tolerance of {words}", unit, factor)
        for key, parts in self.terms.items():
            shown = ", ".join(f"{name} {100 * part:+.3f} %" for name, part in parts.items())
            yield f"Corrections in {QUANTITIES[key][0]}: {shown or 'none'}"
        yield from (LEVEL, *self.all_notes)


def _row(key: str, value: UFloat, reference: UFloat | None) -> Row:
    words, unit, factor = QUANTITIES[key]
    return Row(
        quantity=words,
        value=factor * value.nominal_value,
        tolerance=factor * value.std_dev,
        unit=unit,
        reference=None if reference is None else factor * reference.nominal_value,
        reference_tolerance=None if reference is None else factor * reference.std_dev or None,
        dominated_by=dominating(value),
    )
