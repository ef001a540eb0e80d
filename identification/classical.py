"""Weighing, CoG and pendulum as data: what they say about the ten parameters of the article, linearised where the iteration is.

A fact is a value of mass, CoG (from F) or inertia about the CoG, with its standard deviation. All but the mass are nonlinear in
the parameters of Eq. 4; residual and derivative are evaluated at every step.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.inertia import Inertia, six_from_tensor
from geometry.keys import nearest
from identification.request import Fact

QUANTITIES = (
    "mass_kg",
    *("cog_x_mm", "cog_y_mm", "cog_z_mm"),
    *("moi_xx_cog_kgm2", "moi_yy_cog_kgm2", "moi_zz_cog_kgm2"),
    *("poi_xy_cog_kgm2", "poi_xz_cog_kgm2", "poi_yz_cog_kgm2"),
)
"""What a fact can be about, in the order of `quantities`. Values are SI throughout: the names are those of the files."""


def quantities(parameters: Array) -> Array:
    """(10,) mass [kg], CoG from the reference point [m], moments and products about the CoG [kg m²] of ten `parameters`."""
    body = Inertia(parameters=parameters)
    return np.concatenate([[body.mass], body.cog, six_from_tensor(body.tensor_cog)])


def jacobian(parameters: Array) -> Array:
    """(10, 10) derivative of `quantities`, in closed form: I_cog = I_F - (|h|² 1 - h h^T) / m with the first moment h."""
    m, h = float(parameters[0]), np.asarray(parameters[1:4])
    J = np.zeros((10, 10))
    J[0, 0] = 1.0
    J[1:4, 0], J[1:4, 1:4] = -h / m**2, np.eye(3) / m
    J[4:, 4:] = np.eye(6)
    J[4:, 0] = six_from_tensor(h @ h * np.eye(3) - np.outer(h, h)) / m**2
    for k, e in enumerate(np.eye(3)):
        change = 2 * h[k] * np.eye(3) - np.outer(e, h) - np.outer(h, e)
        J[4:, 1 + k] = -six_from_tensor(change) / m
    return J


def require_known(facts: Sequence[Fact]) -> None:
    """Refuse facts about something else.

    Raises
    ------
    BadInput : a quantity that is none of `QUANTITIES`, or a standard deviation that is not above zero.
    """
    for fact in facts:
        if fact.quantity not in QUANTITIES:
            remedy = f"{nearest(fact.quantity, QUANTITIES)}Known are {', '.join(QUANTITIES)}"
            raise BadInput(source=fact.source or "facts", field=fact.quantity, problem="no such quantity", remedy=remedy)
        if not 0 < fact.sd < np.inf:
            problem = f"its standard deviation must be positive and finite, found {fact.sd}"
            raise BadInput(source=fact.source or "facts", field=fact.quantity, problem=problem, remedy="State its tolerance")


def equations(facts: Sequence[Fact], parameters: Array) -> tuple[Array, Array]:
    """Whitened residuals (p,) of `facts` at ten `parameters`, and their derivatives (p, 10)."""
    at = [QUANTITIES.index(fact.quantity) for fact in facts]
    sd = np.array([fact.sd for fact in facts])
    left = quantities(parameters)[at] - np.array([fact.value for fact in facts])
    return left / sd, jacobian(parameters)[at] / sd[:, None]


def name(fact: Fact) -> str:
    """What a fact is called among the inputs."""
    return f"{fact.quantity} of {fact.source}" if fact.source else fact.quantity
