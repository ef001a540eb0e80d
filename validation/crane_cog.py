"""CoG height by crane and balance (paper 3.3): one end hangs on the crane's rope, the other stands on the balance.

    rope, force S                                       horizontal distances along the article's z axis,
      |                                                 which lies flat or at a small inclination i:
      |
      o z_rope (top end)                                balance  CoG          rope
      |                                                    R↑     ↓m g         ↑S
      =========+===============o========================   |------|------------|
             CoG z_c           ^ z_support              z_support z_c        z_rope

Both forces are vertical (the rope hangs free, the balance takes no side force), so moments about the rope's attachment leave one
unknown. With the balance reading R in kg, the lever equation is

    R (x_support - x_rope) = m (x_c - x_rope),     x = z cos i - h sin i

for a point at z along the axis and h above it (square to the axis, upwards when the article lies flat). Divided by cos i:

    z_c = z_rope - h_rope tan i + (R/m) (z_support - z_rope - (h_support - h_rope) tan i),     h from the height of the CoG

With attachment, support and CoG on one line through the axis (all h zero, the default) the inclination cancels. The article
counts as rigid. The rope carries ``S = (m - R) g``.

    kind = "crane-cog"
    gravity = "9.81 m/s^2"
    [article]
    name = "clumod-4"
    mass = "47.40 +/- 0.05 kg"
    [balance]                       # see validation.balance
    [[reading]]
    shown = "29.70 kg"
    [distances]                     # from the article's origin (its bottom), along z
    rope = "1600 +/- 0.5 mm"
    support = "31.0 +/- 0.5 mm"
    inclination = "0 +/- 0.5 deg"   # optional, with the heights above the CoG's axis that make it matter
    rope_offset = "0 +/- 2 mm"
    support_offset = "-30 +/- 2 mm"
"""

from __future__ import annotations

from typing import TYPE_CHECKING

from uncertainties import umath

from geometry.errors import BadInput
from geometry.quantities import exact
from validation.balance import balance
from validation.measurement_file import HEAD, Fields
from validation.reduction import Reduction

if TYPE_CHECKING:
    from uncertainties import UFloat

STANDARD_GRAVITY = 9.80665
"""[m/s²], where a file states none; only the rope's force depends on it."""


def cog_height(
    *,
    mass: UFloat,
    reading: UFloat,
    rope: UFloat,
    support: UFloat,
    inclination: UFloat | float = 0.0,
    rope_offset: UFloat | float = 0.0,
    support_offset: UFloat | float = 0.0,
) -> UFloat:
    """CoG z [m] by the lever equation of the module's head.

    Parameters
    ----------
    mass, reading : of the article, and on the balance [kg]
    rope, support : z of the rope's attachment and of the support [m], from the article's origin
    inclination : of the axis, top end up [rad]
    rope_offset, support_offset : heights above the line through the CoG along the axis [m]
    """
    tilt = umath.tan(inclination)
    lever = support - rope - (support_offset - rope_offset) * tilt
    return rope - rope_offset * tilt + reading / mass * lever


def reduce(file: Fields) -> Reduction:
    """The CoG height [m] and the rope's force [N] that the crane-cog `file` comes down to.

    Raises
    ------
    BadInput : something in the file cannot be used, or the balance carries more than the article weighs.
    """
    file.only((*HEAD, "gravity", "balance", "reading", "distances"))
    article = file.inner("article").only(("name", "mass"))
    mass = article.positive("mass", "mass")
    scale = balance(file.inner("balance"))
    reading = scale.mean([scale.reading(_shown(entry)) for entry in file.each("reading")])
    _require_rope_in_tension(reading, mass, file)
    gravity = file.positive("gravity", "acceleration") if "gravity" in file.table else exact(STANDARD_GRAVITY)
    return Reduction(
        title=file.text("title", "CoG by crane and balance"),
        origin=file.text("origin", "origin not stated"),
        article=article.text("name"),
        results={"cog_z": _height(file.inner("distances"), mass, reading), "rope_force": (mass - reading) * gravity},
        notes=("Assumed: rope vertical, no side force on the balance, rigid article.",),
    )


def _shown(entry: Fields) -> UFloat:
    return entry.only(("shown",)).positive("shown", "mass", "balance reading")


def _height(fields: Fields, mass: UFloat, reading: UFloat) -> UFloat:
    fields.only(("rope", "support", "inclination", "rope_offset", "support_offset"))
    rope, support = (fields.quantity(key, "length", f"{key} position") for key in ("rope", "support"))
    if rope.nominal_value == support.nominal_value:
        raise fields.refused("support", "rope and support are at one place: no lever", "Measure both from the article's bottom")
    lean = fields.quantity_or_zero("inclination", "angle")
    if abs(lean.nominal_value) > 0.8:
        raise fields.refused(
            "inclination", f"above 45 deg it is no lever, found {lean.nominal_value:.3g} rad", "Lay the article down"
        )
    offsets = {key: fields.quantity_or_zero(key, "length") for key in ("rope_offset", "support_offset")}
    return cog_height(mass=mass, reading=reading, rope=rope, support=support, inclination=lean, **offsets)


def _require_rope_in_tension(reading: UFloat, mass: UFloat, file: Fields) -> None:
    if reading.nominal_value < mass.nominal_value:
        return
    raise BadInput(
        source=file.source,
        field="reading",
        problem=f"the balance carries {reading.nominal_value:.6g} kg of {mass.nominal_value:.6g} kg: the rope would have to push",
        remedy="Check the mass, the tare of the supports and the reading; the CoG lies between rope and support",
    )
