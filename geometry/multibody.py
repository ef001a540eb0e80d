"""The door to Pinocchio: inertia by spatial algebra, from closed-form primitives, voids as bodies of negative mass.

Nothing here comes from OCC or from a mesh: Pinocchio knows the box and the cylinder in closed form, acts on them with its own
SE(3) and adds them with its own parallel-axis rule. Its parameter vector orders the tensor Ixx, Ixy, Iyy, Ixz, Iyz, Izz about the
frame's origin, matrix entries as ours, so the conversion is an index and no sign.
"""

from __future__ import annotations

from functools import reduce
from typing import Any

import numpy as np

from geometry.arrays import Array
from geometry.article import Article, Part
from geometry.consistency import Kind, judge, require_physical
from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.inertia import Inertia
from geometry.shapes import Box, Placed

FROM_PINOCCHIO = [0, 1, 2, 3, 4, 6, 9, 5, 7, 8]
"""Where the ten parameters of Eq. 4 stand in Pinocchio's dynamic parameters."""

PinocchioInertia = Any
"""A `pinocchio.Inertia`; the library has no types of its own."""


def inertia(article: Article) -> Inertia:
    """Inertia of the article's counted parts from their drawings, about the article's origin, in its frame."""
    return from_pinocchio(_sum([_part(part) for part in article.counted_parts]))


def to_pinocchio(inertia: Inertia, source: str = "inertia") -> PinocchioInertia:
    """`inertia` as a `pinocchio.Inertia` about the body frame's origin.

    Raises
    ------
    BadInput : no body has these parameters. Pinocchio itself would take them silently.
    """
    import pinocchio

    body = require_physical(inertia, source)
    return pinocchio.Inertia(body.mass, body.cog.copy(), body.tensor_cog)


def from_pinocchio(body: PinocchioInertia) -> Inertia:
    """A `pinocchio.Inertia` as `Inertia` about the frame's origin."""
    return Inertia(parameters=np.asarray(body.toDynamicParameters())[FROM_PINOCCHIO])


def log_cholesky(inertia: Inertia, source: str = "inertia") -> Array:
    """Ten coordinates without constraint, alpha, d1, d2, d3, s12, s23, s13, t1, t2, t3, about the frame's origin.

    The pseudo-inertia is U U^T with the upper triangle U = exp(alpha) [[exp(d1), s12, s13, t1], [0, exp(d2), s23, t2],
    [0, 0, exp(d3), t3], [0, 0, 0, 1]] (Rucker and Wensing, Smooth Parameterization of Rigid-Body Inertia, IEEE RA-L 2022).
    Pinocchio itself only goes back.

    Raises
    ------
    BadInput : the inertia is not that of a body with volume; ideal bodies have no finite coordinates.
    """
    verdict = judge(inertia)
    if verdict.kind is not Kind.BODY:
        raise BadInput(
            source=source,
            field="inertia",
            problem=f"log-Cholesky coordinates need a body with volume: {verdict.text}",
            remedy="Give the ideal body a finite size",
        )
    J = inertia.about(np.zeros(3)).pseudo_inertia
    U = np.linalg.cholesky(J[::-1, ::-1])[::-1, ::-1]
    V = U / U[3, 3]
    d = np.log(np.diag(V)[:3])
    return np.array([np.log(U[3, 3]), *d, V[0, 1], V[1, 2], V[0, 2], *V[:3, 3]])


def from_log_cholesky(coordinates: Array) -> Inertia:
    """The body with these log-Cholesky coordinates (10,), about the frame's origin; physical whatever they are."""
    import pinocchio

    return from_pinocchio(pinocchio.Inertia.FromLogCholeskyParameters(pinocchio.LogCholeskyParameters(coordinates)))


def _part(part: Part) -> PinocchioInertia:
    """One part in the article's frame: material first, so that the running mass never passes through zero."""
    density = part.material.density
    bodies = [_body(solid, density) for solid in part.shape.solids] + [_body(void, -density) for void in part.shape.voids]
    return _se3(part.pose).act(_sum(bodies))


def _body(placed: Placed, density: float) -> PinocchioInertia:
    """A primitive of `density` [kg/m³], negative for a void, in the part's frame."""
    import pinocchio

    primitive, mass = placed.primitive, density * placed.primitive.volume
    if isinstance(primitive, Box):
        body = pinocchio.Inertia.FromBox(mass, *primitive.size.tolist())
    else:
        body = pinocchio.Inertia.FromCylinder(mass, primitive.diameter / 2, primitive.height)
    return _se3(placed.pose).act(body)


def _sum(bodies: list[PinocchioInertia]) -> PinocchioInertia:
    return reduce(lambda a, b: a + b, bodies)


def _se3(pose: Pose) -> Any:
    import pinocchio

    return pinocchio.SE3(pose.rotation, pose.position)
