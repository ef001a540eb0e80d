"""Weighing: mass with its tolerance from readings of a balance.

    kind = "weighing"
    [article]
    name = "clumod-4"
    [balance]                    # see validation.classical.weigh
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

from collections.abc import Sequence
from dataclasses import dataclass
from typing import TYPE_CHECKING

import numpy as np
from uncertainties import umath

from geometry.toml_file import STANDARD_GRAVITY, exact, tagged
from validation.classical.files import HEAD, Fields, Reduction

if TYPE_CHECKING:
    from uncertainties import UFloat


# A balance and its readings: what resolution, relative error and digit error leave of a figure on a display (paper 3.3).
#
#     [balance]
#     resolution = "10 g"         # the last digit of the display; rounding leaves half of it
#     relative_error = "0.05 %"   # of the reading: calibration, the same for every reading
#     digit_error = 1             # by how many last digits a reading may jump, for each reading anew
#
# A reading r is ``(r + rounding + digits) (1 + relative)``. The relative error is shared by all readings, so it does not average
# out and a tare does not remove it from the net mass.


@dataclass(frozen=True, eq=False, kw_only=True)
class Balance:
    """A balance.

    Attributes
    ----------
    resolution : value of the last digit [kg]
    digit_error : tolerance of a reading, in last digits
    gain : ``1 + relative error``, one quantity for all readings
    """

    resolution: float
    digit_error: int
    gain: "UFloat"

    def reading(self, shown: "UFloat") -> "UFloat":
        """A figure on the display [kg] with its own rounding and digit error, before the gain."""
        rounding = tagged(0.0, self.resolution / 2, "balance resolution")
        digits = tagged(0.0, self.digit_error * self.resolution, "balance digit error")
        return shown + rounding + digits

    def mean(self, readings: "Sequence[UFloat]") -> "UFloat":
        """Mean [kg] of `readings`, with the scatter of the mean where there are several, and the gain."""
        average = sum(readings) / len(readings)
        if len(readings) < 2:
            scatter_of = exact(0.0)
        else:
            shown = np.array([reading.nominal_value for reading in readings])
            scatter_of = tagged(0.0, float(shown.std(ddof=1) / np.sqrt(len(shown))), "scatter of the readings")
        return (average + scatter_of) * self.gain


def balance(fields: Fields) -> Balance:
    """The balance described by the table ``[balance]``.

    Raises
    ------
    BadInput : a key missing, unknown, or out of range.
    """
    fields.only(("name", "resolution", "relative_error", "digit_error"))
    relative = fields.quantity("relative_error", "ratio")
    if relative.nominal_value < 0 or relative.std_dev:
        raise fields.refused("relative_error", "it is a tolerance, not negative and without one", 'Write it like "0.05 %"')
    return Balance(
        resolution=fields.positive("resolution", "mass").nominal_value,
        digit_error=fields.integer("digit_error", 0, 0),
        gain=tagged(1.0, relative.nominal_value, "balance relative error"),
    )


def reduce(file: Fields) -> Reduction:
    """The mass [kg] that the weighing `file` comes down to.

    Raises
    ------
    BadInput : something in the file cannot be used.
    """
    file.only((*HEAD, "balance", "reading", "buoyancy"))
    article = file.inner("article").only(("name",))
    scale = balance(file.inner("balance"))
    net = []
    for entry in file.each("reading"):
        entry.only(("gross", "tare"))
        gross = scale.reading(entry.positive("gross", "mass", "gross reading"))
        tared = "tare" in entry.table
        net.append(gross - scale.reading(entry.quantity("tare", "mass", "tare reading")) if tared else gross)
    weighed = scale.mean(net)
    if weighed.nominal_value <= 0:
        remedy = "Check gross and tare"
        raise file.refused("reading", f"the net mass must be positive, found {weighed.nominal_value:.6g} kg", remedy)
    # Mass over weighing; None where the densities are not stated and not wanted
    fields = file.inner("buoyancy").only(("apply", "air_density", "weights_density", "article_density"))
    applied = fields.switch("apply", False)
    factor: UFloat | None = None
    if applied or len(fields.table.keys() - {"apply"}) == 3:
        air, weights, own = (fields.positive(f"{what}_density", "density") for what in ("air", "weights", "article"))
        if air.nominal_value >= min(own.nominal_value, weights.nominal_value):
            raise fields.refused("air_density", "the article and the weights must be denser than air", "Densities in kg/m^3")
        factor = (1 - air / weights) / (1 - air / own)
    size = f"; it would change the mass by {100 * (factor.nominal_value - 1):+.4f} %" if factor is not None else ""
    return Reduction(
        title=file.text("title", "Weighing"),
        origin=file.text("origin", "origin not stated"),
        article=article.text("name"),
        results={"mass": weighed * factor if applied and factor is not None else weighed},
        notes=() if applied else (f"Buoyancy is not corrected{size}.",),
        terms={"mass": {"buoyancy": factor.nominal_value - 1}} if applied and factor is not None else {},
    )


# CoG height by crane and balance (paper 3.3): one end hangs on the crane's rope, the other stands on the balance.
#
#     rope, force S                                       horizontal distances along the article's z axis,
#       |                                                 which lies flat or at a small inclination i:
#       |
#       o z_rope (top end)                                balance  CoG          rope
#       |                                                    R↑     ↓m g         ↑S
#       =========+===============o========================   |------|------------|
#              CoG z_c           ^ z_support              z_support z_c        z_rope
#
# Both forces are vertical (the rope hangs free, the balance takes no side force), so moments about the rope's attachment leave
# one unknown. With the balance reading R in kg, the lever equation is
#
#     R (x_support - x_rope) = m (x_c - x_rope),     x = z cos i - h sin i
#
# for a point at z along the axis and h above it (square to the axis, upwards when the article lies flat). Divided by cos i:
#
#     z_c = z_rope - h_rope tan i + (R/m) (z_support - z_rope - (h_support - h_rope) tan i),     h from the height of the CoG
#
# With attachment, support and CoG on one line through the axis (all h zero, the default) the inclination cancels. The article
# counts as rigid. The rope carries ``S = (m - R) g``.
#
#     kind = "crane-cog"
#     gravity = "9.81 m/s^2"
#     [article]
#     name = "clumod-4"
#     mass = "47.40 +/- 0.05 kg"
#     [balance]                       # see validation.classical.weigh
#     [[reading]]
#     shown = "29.70 kg"
#     [distances]                     # from the article's origin (its bottom), along z
#     rope = "1600 +/- 0.5 mm"
#     support = "31.0 +/- 0.5 mm"
#     inclination = "0 +/- 0.5 deg"   # optional, with the heights above the CoG's axis that make it matter
#     rope_offset = "0 +/- 2 mm"
#     support_offset = "-30 +/- 2 mm"


def cog_height(
    *,
    mass: "UFloat",
    reading: "UFloat",
    rope: "UFloat",
    support: "UFloat",
    inclination: "UFloat | float" = 0.0,
    rope_offset: "UFloat | float" = 0.0,
    support_offset: "UFloat | float" = 0.0,
) -> "UFloat":
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


def reduce_cog(file: Fields) -> Reduction:
    """The CoG height [m] and the rope's force [N] that the crane-cog `file` comes down to.

    Raises
    ------
    BadInput : something in the file cannot be used, or the balance carries more than the article weighs.
    """
    file.only((*HEAD, "gravity", "balance", "reading", "distances"))
    article = file.inner("article").only(("name", "mass"))
    mass = article.positive("mass", "mass")
    scale = balance(file.inner("balance"))
    reading = scale.mean(
        [scale.reading(entry.only(("shown",)).positive("shown", "mass", "balance reading")) for entry in file.each("reading")]
    )
    if reading.nominal_value >= mass.nominal_value:
        carried = f"the balance carries {reading.nominal_value:.6g} kg of {mass.nominal_value:.6g} kg"
        remedy = "Check the mass, the tare of the supports and the reading; the CoG lies between rope and support"
        raise file.refused("reading", f"{carried}: the rope would have to push", remedy)
    # Only the rope's force depends on it
    gravity = file.positive("gravity", "acceleration") if "gravity" in file.table else exact(STANDARD_GRAVITY)
    fields = file.inner("distances").only(("rope", "support", "inclination", "rope_offset", "support_offset"))
    rope, support = (fields.quantity(key, "length", f"{key} position") for key in ("rope", "support"))
    if rope.nominal_value == support.nominal_value:
        raise fields.refused("support", "rope and support are at one place: no lever", "Measure both from the article's bottom")
    lean = fields.quantity_or_zero("inclination", "angle")
    if abs(lean.nominal_value) > 0.8:
        remedy = "Lay the article down"
        raise fields.refused("inclination", f"above 45 deg it is no lever, found {lean.nominal_value:.3g} rad", remedy)
    offsets = {key: fields.quantity_or_zero(key, "length") for key in ("rope_offset", "support_offset")}
    height = cog_height(mass=mass, reading=reading, rope=rope, support=support, inclination=lean, **offsets)
    return Reduction(
        title=file.text("title", "CoG by crane and balance"),
        origin=file.text("origin", "origin not stated"),
        article=article.text("name"),
        results={"cog_z": height, "rope_force": (mass - reading) * gravity},
        notes=("Assumed: rope vertical, no side force on the balance, rigid article.",),
    )
