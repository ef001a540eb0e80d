"""Can these ten numbers belong to a body? The judge that stands at every door.

A positive density with the ten parameters exists exactly when the mass is positive and the pseudo-inertia is positive definite;
seen from the CoG that is the triangle inequality on the *principal* moments (on the diagonal of a tensor with products it proves
nothing). The boundary belongs to ideal bodies: a point mass (no moments), a rod (one moment zero), a lamina (largest moment the
sum of the others) have no volume, yet engineers rightly use them as lumped masses. So they are accepted, named `IDEAL`, and
refused only where a strictly positive definite matrix is needed (log-Cholesky coordinates).

Rounding: moments about the CoG are what is left after the parallel-axis terms cancel, so the tolerance is relative to the largest
tensor that the numbers have been through: about the reference point, and about the frame's origin, through which bodies are
placed (another reference point does not bring the lost digits back). The moments themselves are no measure of it.
"""

from __future__ import annotations

from dataclasses import dataclass
from enum import Enum

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.inertia import Inertia

ROUNDING = 1e-12


class Kind(Enum):
    """Verdict on ten parameters."""

    BODY = "a body"
    IDEAL = "an ideal body (point mass, rod or lamina)"
    UNPHYSICAL = "no body"


@dataclass(frozen=True, eq=False, kw_only=True)
class Consistency:
    """The verdict with its evidence.

    Attributes
    ----------
    kind : the verdict
    text : the verdict in a sentence
    margin : (3,) [kg m²], sum of two principal moments minus the third, ascending; NaN without positive mass
    rounding : [kg m²], what counts as zero for `margin`
    """

    kind: Kind
    text: str
    margin: Array
    rounding: float

    @property
    def physical(self) -> bool:
        return self.kind is not Kind.UNPHYSICAL


def judge(inertia: Inertia, rounding: float = ROUNDING) -> Consistency:
    """Judge `inertia`; `rounding` is relative to the largest entry of its tensors about reference point and frame's origin."""
    zero = rounding * max(float(np.abs(tensor).max()) for tensor in (inertia.tensor, inertia.about(np.zeros(3)).tensor))
    if inertia.mass <= 0:
        text = f"the mass must be positive, found {inertia.mass:.6g} kg"
        return Consistency(kind=Kind.UNPHYSICAL, text=text, margin=np.full(3, np.nan), rounding=zero)
    moments, _ = inertia.principal()
    margin = np.sort(moments.sum() - 2 * moments)
    return Consistency(kind=_kind(margin, zero), text=_sentence(moments, margin, zero), margin=margin, rounding=zero)


def require_physical(inertia: Inertia, source: str, rounding: float = ROUNDING) -> Inertia:
    """Pass `inertia` through unchanged.

    Raises
    ------
    BadInput : no body can have these parameters; `source` says where they came from.
    """
    verdict = judge(inertia, rounding)
    if not verdict.physical:
        raise BadInput(
            source=source,
            field="inertia",
            problem=f"no body has these parameters: {verdict.text}",
            remedy="Check signs, units and the reference point (products are matrix entries, Ixy = -∫xy dm)",
        )
    return inertia


def _kind(margin: Array, zero: float) -> Kind:
    if margin[0] < -zero:
        return Kind.UNPHYSICAL
    return Kind.BODY if margin[0] > zero else Kind.IDEAL


def _sentence(moments: Array, margin: Array, zero: float) -> str:
    shown = ", ".join(f"{moment:.6g}" for moment in moments)
    if margin[0] < -zero:
        return (
            f"principal moments {shown} kg m² break the triangle inequality by {-margin[0]:.3g} kg m² "
            "(the largest exceeds the sum of the others)"
        )
    if margin[0] <= zero:
        return f"principal moments {shown} kg m² lie on the boundary: a point mass, rod or lamina"
    return f"principal moments {shown} kg m² satisfy the triangle inequality"
