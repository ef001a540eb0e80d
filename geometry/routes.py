"""Three routes from a drawing to inertia, and whether they agree.

=========== ======================================================= ============================
route       what it integrates                                      error
=========== ======================================================= ============================
occ         the exact B-rep that OCC made of the drawing            rounding
trimesh     a closed triangle mesh of that B-rep                    chord error of curved faces
pinocchio   closed-form primitives, voids as negative bodies        rounding
=========== ======================================================= ============================

OCC cuts the voids; Pinocchio subtracts them. They differ when a void leaves the material or meets another one, when OCC's boolean
operation fails, and when either is fed a wrong place: a disagreement is a failed check, not a matter of taste.
"""

from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass
from functools import reduce
from itertools import combinations
from typing import Any

import numpy as np

from geometry.article import Article, Box, Cylinder, Placed
from geometry.errors import BadInput
from geometry.frames import Array, Pose, frozen
from geometry.inertia import PARAMETERS, UNITS, Inertia, Kind, judge, parallel_axis, six_from_tensor
from geometry.mesh import DEFAULT_CHORD, TriangleMesh

# Do inertias that were found by different routes agree, and what were they allowed to differ by?

ROUNDING = 1e-9
"""What exact routes may differ by, relative to the size of the body."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Agreement:
    """Whether the routes agree.

    Attributes
    ----------
    agree : every difference lies within its tolerance
    text : the verdict in a sentence
    difference : (10,) between the two routes that differ most, order and units of `PARAMETERS`, about the article's origin
    tolerance : (10,) what was allowed between these two
    excess : largest ratio of a difference to its tolerance; at most 1 when they agree
    """

    agree: bool
    text: str
    difference: Array
    tolerance: Array
    excess: float


def held_together(inertias: Mapping[str, Inertia], allowed: Mapping[str, Array]) -> Agreement:
    """The verdict on two or more routes: that of the pair which differs most, relative to what it may.

    Parameters
    ----------
    inertias : by route, all about the same origin
    allowed : by route, (10,) what it may be off by; a pair may differ by the larger of the two
    """
    verdicts = []
    for a, b in combinations(inertias, 2):
        difference, tolerance = np.abs(inertias[a].parameters - inertias[b].parameters), np.maximum(allowed[a], allowed[b])
        ratio = difference / tolerance
        k = int(np.argmax(ratio))
        agree = bool(ratio[k] <= 1)
        off = f"{PARAMETERS[k]} about the origin differs by {difference[k]:.2e} {UNITS[k]}, {tolerance[k]:.2e} {UNITS[k]} allowed"
        verdicts.append(
            Agreement(
                agree=agree,
                text=f"{a} and {b} {'agree' if agree else 'disagree'}: {off}",
                difference=frozen(difference, (10,), "difference"),
                tolerance=frozen(tolerance, (10,), "tolerance"),
                excess=float(ratio[k]),
            )
        )
    return max(verdicts, key=lambda verdict: verdict.excess)


def rounding(inertia: Inertia) -> Array:
    """What exact routes may differ by: `ROUNDING` of each of the ten parameters about the origin (10,).

    The size of a parameter is that for a body of this mass and this radius of gyration about the origin.
    """
    radius = np.sqrt(np.trace(inertia.about(np.zeros(3)).tensor) / (2 * inertia.mass))
    return np.asarray(ROUNDING * inertia.mass * radius ** np.array([0, 1, 1, 1, 2, 2, 2, 2, 2, 2]))


def missing_mass(mass: float, reach: Array) -> Array:
    """What `mass` [kg], missing anywhere up to `reach` (3,) [m] from the origin takes off each parameter at most; (10,)."""
    x, y, z = reach
    return mass * np.array([1, x, y, z, y * y + z * z, x * x + z * z, x * x + y * y, x * y, x * z, y * z])


ROUTES = ("occ", "trimesh", "pinocchio")


def by_routes(article: Article, chord: float = DEFAULT_CHORD) -> Mapping[str, Inertia]:
    """Inertia of `article` by every route, about the article's origin, in its frame; `chord` [m] is the mesh's chord error."""
    from geometry import cad

    return {"occ": cad.inertia(article), "trimesh": by_mesh(article, chord), "pinocchio": by_pinocchio(article)}


def by_mesh(article: Article, chord: float = DEFAULT_CHORD) -> Inertia:
    """Inertia of `article` from closed meshes of its parts with chord error `chord` [m], about the article's origin."""
    from geometry import mesh
    from geometry.cad import tessellate

    total = Inertia(parameters=np.zeros(10))
    for part in article.counted_parts:
        total = total + mesh.inertia(tessellate(part, chord), part.material.density, f"mesh of {part.name}")
    return total


def of_mesh(mesh: TriangleMesh, density: float) -> Mapping[str, Inertia]:
    """Inertia about the mesh's origin of the body of `density` [kg/m³] within a closed `mesh`, by three pieces of code.

    OCC sums tetrahedra over a triangulated face, trimesh integrates polynomials over triangles (Mirtich 1996), coal, which comes
    with Pinocchio, transforms a unit tetrahedron. All are exact for the polyhedron.
    """
    import coal

    from geometry import cad
    from geometry import mesh as meshes

    middle, body = mesh.bounds.mean(axis=0), coal.BVHModelOBBRSS()
    body.beginModel(len(mesh.faces), len(mesh.vertices))
    body.addVertices(mesh.vertices - middle)
    body.addTriangles(mesh.faces.astype(np.uint32))
    about_middle = density * np.asarray(body.computeMomentofInertia())
    volume, centre = float(body.computeVolume()), np.asarray(body.computeCOM())
    tensor = about_middle - parallel_axis(density * volume, centre)
    try:
        by_occ = {"occ": cad.of_triangles(mesh, density)}
    except ModuleNotFoundError:  # the extra `cad` is not installed: two routes are left
        by_occ = {}
    return by_occ | {
        "trimesh": meshes.inertia_unchecked(mesh, density),
        "pinocchio": Inertia.from_cog(density * volume, centre + middle, 0.5 * (tensor + tensor.T)),
    }


def agreement(article: Article, inertias: Mapping[str, Inertia], chord: float = DEFAULT_CHORD) -> Agreement:
    """Hold the routes against each other: to `ROUNDING` among the exact ones, to the tessellation error against the mesh."""
    exact = rounding(inertias["occ"])
    allowed = {"occ": exact, "pinocchio": exact, "trimesh": exact + tessellation_error(article, chord)}
    return held_together(inertias, allowed)


def tessellation_error(article: Article, chord: float) -> Array:
    """What the mesh of `article` may be off by: bound on each of the ten parameters (10,), about the article's origin.

    A polygon inscribed in a circle with sagittas of at most c misses no more than two thirds of the shell of thickness c, so a
    cylinder's mesh misses mass of at most dm = rho 2/3 pi d h c, somewhere on its curved face; the farthest that face reaches
    along x, y and z bounds what dm adds to the moments. Material loses and voids gain: for the mass and the moments of
    inertia, which have positive weights, the two do not add up. Planar faces are exact.
    """
    material, voids = _missing(article, chord, "solids"), _missing(article, chord, "voids")
    return np.where(_POSITIVE, np.maximum(material, voids), material + voids)


def _missing(article: Article, chord: float, kind: str) -> Array:
    """Bound on what the inscribed polygons of all solids, or of all voids, miss; (10,)."""
    missing = np.zeros(10)
    for part in article.counted_parts:
        for placed in getattr(part.shape, kind):
            if isinstance(cylinder := placed.primitive, Cylinder):
                pose = part.pose @ placed.pose
                mass = part.material.density * 2 / 3 * np.pi * cylinder.diameter * cylinder.height * chord
                axis = np.abs(pose.rotation[:, 2])
                half = axis * cylinder.height / 2 + np.sqrt(1 - np.minimum(axis, 1) ** 2) * cylinder.diameter / 2
                missing = missing + missing_mass(mass, np.abs(pose.position) + half)
    return missing


_POSITIVE = np.array([True, False, False, False, True, True, True, False, False, False])


# The door to Pinocchio: inertia by spatial algebra, from closed-form primitives, voids as bodies of negative mass.
#
# Nothing here comes from OCC or from a mesh: Pinocchio knows the box and the cylinder in closed form, acts on them with its own
# SE(3) and adds them with its own parallel-axis rule. Its parameter vector orders the tensor Ixx, Ixy, Iyy, Ixz, Iyz, Izz about
# the frame's origin, matrix entries as ours, so the conversion is an index and no sign.

FROM_PINOCCHIO = [0, 1, 2, 3, 4, 6, 9, 5, 7, 8]
"""Where the ten parameters of Eq. 4 stand in Pinocchio's dynamic parameters."""

PinocchioInertia = Any
"""A `pinocchio.Inertia`; the library has no types of its own."""


def inertia(article: Article) -> Inertia:
    """Inertia of the article's counted parts from their drawings, about the article's origin, in its frame, without Pinocchio:
    boxes and cylinders in closed form, of which importing it would cost more than all else."""
    total = np.zeros(10)
    for part in article.counted_parts:
        for one, sign in (*((one, 1) for one in part.shape.solids), *((one, -1) for one in part.shape.voids)):
            of = one.primitive
            if isinstance(of, Box):
                squares = of.size**2 / 12
            else:
                squares = np.array([of.diameter**2 / 16, of.diameter**2 / 16, of.height**2 / 12])
            mass, tensor = sign * part.material.density * of.volume, np.sum(squares) * np.eye(3) - np.diag(squares)
            turned, place = part.pose.rotation @ one.pose.rotation, part.pose.rotation @ one.pose.position + part.pose.position
            about_origin = mass * turned @ tensor @ turned.T + parallel_axis(mass, place)
            total += np.concatenate([[mass], mass * place, six_from_tensor(about_origin)])
    return Inertia(parameters=total)


def by_pinocchio(article: Article) -> Inertia:
    """The same by Pinocchio."""
    parts = []
    for part in article.counted_parts:  # material first, so that the running mass never passes through zero
        density = part.material.density
        bodies = [_body(solid, density) for solid in part.shape.solids] + [_body(void, -density) for void in part.shape.voids]
        parts.append(_se3(part.pose).act(_sum(bodies)))
    return from_pinocchio(_sum(parts))


def from_pinocchio(body: PinocchioInertia) -> Inertia:
    """A `pinocchio.Inertia` as `Inertia` about the frame's origin."""
    return Inertia(parameters=np.asarray(body.toDynamicParameters())[FROM_PINOCCHIO])


def log_cholesky(inertia: Inertia) -> Array:
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
        problem = f"log-Cholesky coordinates need a body with volume: {verdict.text}"
        raise BadInput("inertia", "inertia", problem, "Give the ideal body a finite size")
    J = inertia.about(np.zeros(3)).pseudo_inertia
    U = np.linalg.cholesky(J[::-1, ::-1])[::-1, ::-1]
    V = U / U[3, 3]
    d = np.log(np.diag(V)[:3])
    return np.array([np.log(U[3, 3]), *d, V[0, 1], V[1, 2], V[0, 2], *V[:3, 3]])


def from_log_cholesky(coordinates: Array) -> Inertia:
    """The body with these log-Cholesky coordinates (10,), about the frame's origin; physical whatever they are."""
    import pinocchio

    return from_pinocchio(pinocchio.Inertia.FromLogCholeskyParameters(pinocchio.LogCholeskyParameters(coordinates)))


def _body(placed: Placed, density: float) -> PinocchioInertia:
    """A primitive of `density` [kg/m³], negative for a void, in the part's frame."""
    import pinocchio

    primitive, mass = placed.primitive, density * placed.primitive.volume
    if isinstance(primitive, Box):
        body = pinocchio.Inertia.FromBox(mass, *primitive.size.tolist())
    else:
        body = pinocchio.Inertia.FromCylinder(mass, primitive.diameter / 2, primitive.height)
    return _se3(placed.pose).act(body)


def closed_form(kind: str, size: Sequence[float]) -> Inertia:
    """Inertia at unit density of a box, cylinder, sphere, capsule or ellipsoid about its own centre, axis along z.

    `size` [m]: edges of a box; radius and length of the straight part of a cylinder or capsule; radius of a sphere; half-axes of
    an ellipsoid.
    """
    import pinocchio

    volumes: Mapping[str, Callable[..., float]] = {
        "box": lambda a, b, c: a * b * c,
        "cylinder": lambda r, h: np.pi * r**2 * h,
        "sphere": lambda r: 4 / 3 * np.pi * r**3,
        "capsule": lambda r, h: np.pi * r**2 * h + 4 / 3 * np.pi * r**3,
        "ellipsoid": lambda a, b, c: 4 / 3 * np.pi * a * b * c,
    }
    return from_pinocchio(getattr(pinocchio.Inertia, f"From{kind.capitalize()}")(volumes[kind](*size), *size))


def _sum(bodies: list[PinocchioInertia]) -> PinocchioInertia:
    return reduce(lambda a, b: a + b, bodies)


def _se3(pose: Pose) -> Any:
    import pinocchio

    return pinocchio.SE3(pose.rotation, pose.position)
