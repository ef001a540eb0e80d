"""Weighing: mass with its tolerance from readings of a balance.

    kind = "weighing"
    [article]
    name = "clumod-4"
    [balance]                    # see validation.balance
    [[reading]]                  # one or more
    gross = "48.62 kg"
    tare = "1.22 kg"             # optional, zero by default
    [buoyancy]                   # optional
    apply = false                # off by default: it is 0.01 % for steel
    air_density = "1.20 +/- 0.02 kg/m^3"
    weights_density = "8000 kg/m^3"
    article_density = "7850 +/- 50 kg/m^3"

Buoyancy: the balance was adjusted in air with weights of density ρw, so ``m = W (1 - ρa/ρw) / (1 - ρa/ρ)``.
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from validation.balance import Balance, balance
from validation.measurement_file import HEAD, Fields
from validation.reduction import Reduction

if TYPE_CHECKING:
    from uncertainties import UFloat


def reduce(file: Fields) -> Reduction:
    """The mass [kg] that the weighing `file` comes down to.

    Raises
    ------
    BadInput : something in the file cannot be used.
    """
    file.only((*HEAD, "balance", "reading", "buoyancy"))
    article = file.inner("article").only(("name",))
    scale = balance(file.inner("balance"))
    weighed = scale.mean([_net(entry, scale) for entry in file.each("reading")])
    if weighed.nominal_value <= 0:
        raise file.refused(
            "reading", f"the net mass must be positive, found {weighed.nominal_value:.6g} kg", "Check gross and tare"
        )
    factor = _buoyancy(file.inner("buoyancy"))
    applied = file.inner("buoyancy").switch("apply", False)
    return Reduction(
        title=file.text("title", "Weighing"),
        origin=file.text("origin", "origin not stated"),
        article=article.text("name"),
        results={"mass": weighed * factor if applied and factor is not None else weighed},
        notes=_notes(applied, factor),
        terms={"mass": {"buoyancy": factor.nominal_value - 1}} if applied and factor is not None else {},
    )


def _net(entry: Fields, scale: Balance) -> UFloat:
    entry.only(("gross", "tare"))
    gross = scale.reading(entry.positive("gross", "mass", "gross reading"))
    if "tare" not in entry.table:
        return gross
    return gross - scale.reading(entry.quantity("tare", "mass", "tare reading"))


def _buoyancy(fields: Fields) -> UFloat | None:
    """Mass over weighing; None where the densities are not stated and not wanted."""
    fields.only(("apply", "air_density", "weights_density", "article_density"))
    if not fields.switch("apply", False) and len(fields.table.keys() - {"apply"}) < 3:
        return None
    air, weights, own = (fields.positive(f"{what}_density", "density") for what in ("air", "weights", "article"))
    if air.nominal_value >= min(own.nominal_value, weights.nominal_value):
        raise fields.refused("air_density", "the article and the weights must be denser than air", "Densities in kg/m^3")
    return (1 - air / weights) / (1 - air / own)


def _notes(applied: bool, factor: UFloat | None) -> tuple[str, ...]:
    if applied:
        return ()
    size = f"; it would change the mass by {100 * (factor.nominal_value - 1):+.4f} %" if factor is not None else ""
    return (f"Buoyancy is not corrected{size}.",)
