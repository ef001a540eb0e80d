"""The Timoshenko beam element: exact in statics, with consistent mass and rotary inertia.

Deflection v and rotation theta of the section are interpolated by the static solution of the loaded beam (Friedman and Kosmatka,
An improved two-node Timoshenko beam finite element, Computers & Structures 47, 1993). With Phi = 12 E I / (k G A L²), the ratio
of bending to shear stiffness, they are a cubic and a quadratic; as Phi goes to zero they become the Hermite cubic and its slope,
and the element that of Rayleigh. They hold every rigid motion, so the mass matrix carries the rigid-body inertia exactly. Shear
is constant in an element: a frequency's error falls with the fourth power of the element's length in bending, with the second
in what shear adds, which matters on stubby beams only.
"""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass

import numpy as np

from geometry.article import Material
from geometry.errors import BadInput
from geometry.frames import Array

# Elastic moduli of a material, checked: a library entry or a user's material may lack them or hold nonsense.

_REMEDY = (
    "Name one that has both, such as steel (207e9 Pa and 0.3) or aluminium (70e9 Pa and 0.33), or state your own in an "
    'article.toml ([material."..."] with density, youngs_modulus and poisson_ratio)'
)


def moduli(material: Material, part: str = "") -> tuple[float, float]:
    """Young's modulus and shear modulus E / (2 (1 + nu)) of `material` [Pa], of which `part` is made.

    Raises
    ------
    BadInput : one of them is missing, not positive and finite, or Poisson's ratio lies outside -1 ... 0.5.
    """
    E, nu = material.youngs_modulus, material.poisson_ratio
    if E is None:
        raise _refused(material, part, "youngs_modulus", "is missing, found none, and without it the part has no stiffness")
    if nu is None:
        raise _refused(material, part, "poisson_ratio", "is missing, found none, and without it there is no shear modulus")
    if not 0 < E < float("inf"):
        raise _refused(material, part, "youngs_modulus", f"must be positive and finite, found {E:g} Pa")
    if not -1 < nu < 0.5:
        raise _refused(material, part, "poisson_ratio", f"must lie between -1 and 0.5, found {nu:g}")
    return E, E / (2 * (1 + nu))


def _refused(material: Material, part: str, field: str, problem: str) -> BadInput:
    return BadInput(f"material {material.name}" + (f" of {part}" if part else ""), field, problem, _REMEDY)


# Sections of beams: stiffness and inertia per unit length, from a rectangle or a tube of a material.
#
# Shear coefficients are Cowper's (The Shear Coefficient in Timoshenko's Beam Theory, J. Appl. Mech. 33, 1966), those of a
# section whose end load is distributed as in Saint-Venant's solution. Hutchinson's (J. Appl. Mech. 68, 2001), which fit the
# dispersion of long waves, differ from them by a few per cent and depend on the rectangle's aspect; on slender members the two
# cannot be told apart.


@dataclass(frozen=True, eq=False, kw_only=True)
class Section:
    """Stiffness and inertia of a beam per unit length, in the section's own axes y, z.

    Attributes
    ----------
    axial : E A [N]
    torsion : G J [N m²]
    bending_y, bending_z : E I about the section's y and z axes [N m²]
    shear_y, shear_z : k G A along the section's y and z axes [N]; infinite for a beam without shear deformation
    mass : [kg/m]
    rotary_y, rotary_z : rho I about the section's y and z axes [kg m]; their sum is the polar inertia
    """

    axial: float
    torsion: float
    bending_y: float
    bending_z: float
    mass: float
    rotary_y: float
    rotary_z: float
    shear_y: float = float("inf")
    shear_z: float = float("inf")


def rectangle(width: float, thickness: float, material: Material) -> Section:
    """Solid rectangle, `width` [m] along y and `thickness` [m] along z.

    Raises
    ------
    BadInput : a size that is not positive, or a material without moduli.
    """
    require_positive(width=width, thickness=thickness)
    E, G = moduli(material)
    area, Iy, Iz = width * thickness, width * thickness**3 / 12, thickness * width**3 / 12
    shear = cowper_rectangle(E / (2 * G) - 1) * G * area
    return Section(
        axial=E * area,
        torsion=G * rectangle_torsion(width, thickness),
        bending_y=E * Iy,
        bending_z=E * Iz,
        shear_y=shear,
        shear_z=shear,
        mass=material.density * area,
        rotary_y=material.density * Iy,
        rotary_z=material.density * Iz,
    )


def tube(outer_diameter: float, inner_diameter: float, material: Material) -> Section:
    """Circular tube [m]; a solid rod with `inner_diameter` 0.

    Raises
    ------
    BadInput : the tube has no wall, or its material no moduli.
    """
    require_positive(outer_diameter=outer_diameter)
    if not 0 <= inner_diameter < outer_diameter:
        problem = f"must lie between 0 and the outer diameter {outer_diameter:g} m, found {inner_diameter:g} m"
        raise BadInput("section of a tube", "inner_diameter", problem, "Check both diameters")
    E, G = moduli(material)
    area = np.pi / 4 * (outer_diameter**2 - inner_diameter**2)
    second = np.pi / 64 * (outer_diameter**4 - inner_diameter**4)
    shear = cowper_tube(E / (2 * G) - 1, inner_diameter / outer_diameter) * G * area
    return Section(
        axial=E * area,
        torsion=2 * G * second,
        bending_y=E * second,
        bending_z=E * second,
        shear_y=shear,
        shear_z=shear,
        mass=material.density * area,
        rotary_y=material.density * second,
        rotary_z=material.density * second,
    )


SLIGHT = 1e-6
"""Share of a size or of a moment below which plates have no offset or product: rounding. By definition."""

SIZES = {"BAR": 2, "ROD": 1, "TUBE": 2, "TUBE2": 2, **dict.fromkeys(("BOX", "T", "L", "CHAN", "HAT"), 4), "I": 6}
"""How many sizes a section of each kind has, behind which stands a mass per length."""


def plated(kind: str, sizes: Sequence[float]) -> tuple[dict[str, float], tuple[float, float]]:
    """Section of Nastran's `kind` of plates, and where along its y and z its middle is from the shear centre (0 of a hat).

    Torsion of thin strips (Saint-Venant), of a box after Bredt; shear centres of thin walls (S. P. Timoshenko, Strength of
    Materials, part II).

    Raises
    ------
    ValueError : plates that are no such section.
    """
    a, b, s, t, *others = sizes
    y, z = 0.0, 0.0  # of the shear centre; of every plate its middle along y and z, its height and its width
    plates = [(b / 2, t / 2, b - 2 * s, t), (b / 2, a - t / 2, b - 2 * s, t), (s / 2, a / 2, s, a), (b - s / 2, a / 2, s, a)]
    if kind == "BOX":
        y, z = b / 2, a / 2
    elif kind == "I":
        below, top = others
        y = below / 2 + (a - (below + top) / 2) * top * s**3 / (top * s**3 + below * b**3)
        plates = [(below / 2, 0, below, b), (a - top / 2, 0, top, s), ((a + below - top) / 2, 0, a - below - top, t)]
    elif kind == "T":
        y, plates = b - s / 2, [(b - s / 2, 0, s, a), ((b - s) / 2, 0, b - s, t)]
    elif kind == "L":
        y, z, plates = s / 2, t / 2, [(s / 2, a / 2, s, a), ((b + s) / 2, t / 2, b - s, t)]
    elif kind == "CHAN":
        y, z = b / 2, s / 2 - 3 * t * (a - s / 2) ** 2 / (6 * t * (a - s / 2) + s * (b - t))
        plates = [(t / 2, a / 2, t, a), (b - t / 2, a / 2, t, a), (b / 2, s / 2, b - 2 * t, s)]
    else:
        wall, brim = (s - b) / 2, (s + t) / 2
        plates = [(a - b / 2, 0, b, s), *(((a - b) / 2, at, a - b, b) for at in (-wall, wall))]
        plates += [(b / 2, at, b, t) for at in (-brim, brim)]
    up, right, height, width = np.array(plates).T
    if not np.all((height > 0) & (width > 0)) or (kind == "BOX" and 2 * t >= a):
        raise ValueError(f"{', '.join(f'{one:g}' for one in sizes)} make no {kind}")
    area = height * width
    high, far = float(np.average(up, weights=area)), float(np.average(right, weights=area))
    Iy, Iz = area @ ((up - high) ** 2 + height**2 / 12), area @ ((right - far) ** 2 + width**2 / 12)
    J = np.maximum(height, width) @ np.minimum(height, width) ** 3 / 3
    if kind == "BOX":
        J = 2 * ((a - t) * (b - s)) ** 2 / ((a - t) / s + (b - s) / t)
    product = area @ ((up - high) * (right - far))  # its z is Nastran's y, and its y is -z there
    sums = {"area": area.sum(), "Iy": Iy, "Iz": Iz, "J": J} | ({"Iyz": -product} if abs(product) > SLIGHT * Iy else {})
    y, z = (0.0 if kind == "HAT" or abs(one) <= SLIGHT * max(a, b) else one for one in (high - y, far - z))
    return {name: float(one) for name, one in sums.items()}, (y, z)


def cowper_rectangle(nu: float) -> float:
    """Shear coefficient of a rectangle of any aspect: 10 (1 + nu) / (12 + 11 nu)."""
    return 10 * (1 + nu) / (12 + 11 * nu)


def cowper_tube(nu: float, ratio: float) -> float:
    """Shear coefficient of a circular tube with inner over outer diameter `ratio`; 0 is the solid rod, near 1 the thin tube."""
    square = (1 + ratio**2) ** 2
    return 6 * (1 + nu) * square / ((7 + 6 * nu) * square + (20 + 12 * nu) * ratio**2)


def rectangle_torsion(a: float, b: float) -> float:
    """Saint-Venant's torsion constant J [m⁴] of a rectangle `a` x `b`: his series, of which 1e-8 is left out.

    Source: Timoshenko and Goodier, Theory of Elasticity, article 109.
    """
    long, short = max(a, b), min(a, b)
    n = np.arange(1, 60, 2)
    series = np.sum(np.tanh(n * np.pi * long / (2 * short)) / n**5)
    return float(long * short**3 / 3 * (1 - 192 / np.pi**5 * short / long * series))


def require_positive(**sizes: float) -> None:
    """Refuse a section with a size [m] that is not positive and finite."""
    for name, size in sizes.items():
        if not 0 < size < float("inf"):
            problem = f"must be positive and finite, found {size:g} m"
            raise BadInput("section of a beam", name, problem, "Check the dimensions and their unit")


@dataclass(frozen=True, eq=False, kw_only=True)
class Element:
    """Matrices of one element in its own axes.

    Degrees of freedom: u v w rx ry rz at the start, the same at the end, then `nodal` more at the start, as many at the end, and
    `inner` ones that the element keeps to itself.

    Attributes
    ----------
    stiffness : by part, (n, n) each
    mass : (n, n)
    nodal, inner : how many degrees of freedom there are beyond the twelve; n = 12 + 2 nodal + inner
    """

    stiffness: Mapping[str, Array]
    mass: Array
    nodal: int = 0
    inner: int = 0


AXIAL, TORSION = [0, 6], [3, 9]
IN_XY = [1, 5, 7, 11]  # v and rz: bending about z
IN_XZ = [2, 4, 8, 10]  # w and ry: bending about y, where a positive slope is a negative rotation
SIGN_XZ = np.array([1.0, -1.0, 1.0, -1.0])

GAUSS_POINTS, GAUSS_WEIGHTS = ((x + 1) / 2 if n == 0 else x / 2 for n, x in enumerate(np.polynomial.legendre.leggauss(4)))
"""On 0 ... 1; exact up to the seventh power, and no product of two shape functions has more than the sixth."""


def timoshenko(section: Section, length: float, part: str) -> Element:
    """Element of `length` [m] of a uniform beam that belongs to `part`."""
    k, m = np.zeros((2, 12, 12))
    k[np.ix_(AXIAL, AXIAL)] = section.axial / length * _BAR_STIFFNESS
    k[np.ix_(TORSION, TORSION)] = section.torsion / length * _BAR_STIFFNESS
    m[np.ix_(AXIAL, AXIAL)] = section.mass * length / 6 * _BAR_MASS
    m[np.ix_(TORSION, TORSION)] = (section.rotary_y + section.rotary_z) * length / 6 * _BAR_MASS
    for dofs, sign, bending, shear, rotary in (
        (IN_XY, np.ones(4), section.bending_z, section.shear_y, section.rotary_z),
        (IN_XZ, SIGN_XZ, section.bending_y, section.shear_z, section.rotary_y),
    ):
        phi = 12 * bending / (shear * length**2)
        k[np.ix_(dofs, dofs)] = np.outer(sign, sign) * bending_stiffness(bending, phi, length)
        # Mass that moves with v, rotary inertia that turns with theta
        v, theta = shape_functions(GAUSS_POINTS, phi, length)
        w = GAUSS_WEIGHTS * length
        m[np.ix_(dofs, dofs)] = np.outer(sign, sign) * (section.mass * (v * w) @ v.T + rotary * (theta * w) @ theta.T)
    return Element(stiffness={part: k}, mass=m)


def beam_axes(corners: Array, z_axis: Array | None) -> Array:
    """Rows (3, 3): a beam's axes from its first end to its second, across, and along its section's z.

    Without a stated `z_axis` that is upright, along the z of the frame, or along x where the beam itself is upright.
    """
    along = (corners[1] - corners[0]) / np.linalg.norm(corners[1] - corners[0])
    wanted = z_axis
    if wanted is None:
        wanted = np.array([0.0, 0.0, 1.0]) if abs(along[2]) < 0.99 else np.array([1.0, 0.0, 0.0])
    z = wanted - along * (along @ wanted)
    length = np.linalg.norm(z)
    if not length > 1e-6 * np.linalg.norm(wanted):  # along it, or nowhere
        raise ValueError("`z_axis` must not lie along the beam")
    z = z / length
    return np.array([along, np.cross(z, along), z])


def rods(corners: Array, section: Section) -> tuple[Array, Array]:
    """Stiffness along rods between two `corners` (c, 2, 3) each, and their consistent mass; (c, 6, 6) each."""
    line = corners[:, 1] - corners[:, 0]
    length = np.linalg.norm(line, axis=1)[:, None, None]
    pulled = np.concatenate([-line, line], axis=1)[:, None, :] / length
    alike = np.kron([[2.0, 1.0], [1.0, 2.0]], np.eye(3)) / 6
    return section.axial / length * np.swapaxes(pulled, 1, 2) * pulled, section.mass * length * alike


def bending_stiffness(bending: float, phi: float, L: float) -> Array:
    """Stiffness (4, 4) of v, theta at the start and at the end: bending E I [N m²], Phi [1], length L [m]."""
    a, b, c = 6 * L, (4 + phi) * L * L, (2 - phi) * L * L
    k = np.array([[12, a, -12, a], [a, b, -a, c], [-12, -a, 12, -a], [a, c, -a, b]])
    return np.asarray(bending / (L**3 * (1 + phi)) * k)


def shape_functions(xi: Array, phi: float, L: float) -> tuple[Array, Array]:
    """Deflection and rotation (4, len(xi)) at `xi` = x / L for unit v, theta at the start and at the end."""
    e = 1 + phi
    v = [
        2 * xi**3 - 3 * xi**2 - phi * xi + e,
        L * (xi**3 - (2 + phi / 2) * xi**2 + (1 + phi / 2) * xi),
        -2 * xi**3 + 3 * xi**2 + phi * xi,
        L * (xi**3 - (1 - phi / 2) * xi**2 - phi / 2 * xi),
    ]
    theta = [6 / L * (xi**2 - xi), 3 * xi**2 - (4 + phi) * xi + e, -6 / L * (xi**2 - xi), 3 * xi**2 - (2 - phi) * xi]
    return np.array(v) / e, np.array(theta) / e


_BAR_STIFFNESS = np.array([[1.0, -1.0], [-1.0, 1.0]])
_BAR_MASS = np.array([[2.0, 1.0], [1.0, 2.0]])


# A sandwich: two equal faces with one deflection and a soft layer between them that only shears.
#
# The theory is that of Mead and Markus (J. Sound Vib. 10, 1969) and DiTaranto, sixth order in x. The faces bend as beams and
# stretch against one another; with d between their middles and w' their common slope, the layer's two surfaces slip by delta =
# u_top - u_bottom + d w'. Per unit length, with the faces' E I_f and E A_f, the layer's shear modulus G_c, its thickness s and
# the width b, the energy is half of
#
#     2 E I_f w''²  +  E A_f / 2 (delta' - d w'')²  +  G_c b / s delta².
#
# Short waves slip (2 E I_f is left), long ones do not (2 E I_f + E A_f d² / 2): the bending stiffness belongs to a wavelength.
# The slip is one more degree of freedom at each node and one inside each element, a parabola, so that free slip is met exactly.
#
# Torsion at rate tau: the faces warp in their planes by +/- psi(y) and the layer slips by chi = 2 psi + d y tau. The
# energy over the width, G t_f (psi' - d tau / 2)² + G_c / (2 s) chi², is least when chi'' = lambda² chi with
# lambda² = 2 G_c / (s G t_f), the edges being free, and then
#
#     G J = 2 G b t_f³ / 3  +  2 G t_f d² b (1 - tanh(x) / x),   x = lambda b / 2,
#
# from the faces alone to the bonded plate. The faces' own share has the edges of a rectangle; the layer's has not, which matters
# only when it is nearly bonded (2 % of the torsion of a plate 30 times as wide as thick). Across its width the sandwich bends
# with its faces. Every share is split into what the faces and what the layer hold, so that each keeps its own loss factor.


@dataclass(frozen=True, eq=False, kw_only=True)
class Sandwich:
    """Two faces and a layer, per unit length; thin along the section's z.

    Attributes
    ----------
    faces : both faces together without the layer's help, slipping freely; its mass and rotary inertia are those of the whole
    stretching : E A of one face [N]
    distance : between the middles of the faces [m]
    slip : G_c b / s [N/m²], force per length and slip
    layer_torsion : G J that the layer's coupling adds [N m²]
    torsion_in_layer : share of `layer_torsion` that is stored in the layer itself [1]
    face_rotary : rho I of both faces about their own middles [kg m]
    face_mass : of one face [kg/m]
    layer_rotary : rho I of the layer about its middle [kg m]
    layer_thickness : [m]
    parts : names of bottom face, layer and top face
    """

    faces: Section
    stretching: float
    distance: float
    slip: float
    layer_torsion: float
    torsion_in_layer: float
    face_rotary: float
    face_mass: float
    layer_rotary: float
    layer_thickness: float
    parts: tuple[str, str, str]

    @property
    def mass(self) -> float:
        """[kg/m]."""
        return self.faces.mass

    @property
    def rotary_y(self) -> float:
        """Rho I about the width [kg m]."""
        return self.faces.rotary_y

    @property
    def rotary_z(self) -> float:
        """Rho I about the thickness [kg m]."""
        return self.faces.rotary_z


def sandwich(
    width: float, thickness: float, layer_thickness: float, steel: Material, layer: Material, parts: tuple[str, str, str]
) -> Sandwich:
    """Sandwich of `width` and `thickness` in all [m], a layer of `layer_thickness` [m] in the neutral axis.

    Raises
    ------
    BadInput : a size that is not positive, a layer that leaves no faces, a material without moduli.
    """
    require_positive(width=width, thickness=thickness, layer_thickness=layer_thickness)
    if layer_thickness >= thickness:
        problem = f"must be less than the thickness of the blade {1e3 * thickness:g} mm, found {1e3 * layer_thickness:g} mm"
        raise BadInput("section of a sandwich", "layer.thickness", problem, "Make the layer thinner or the blade thicker")
    s, t = layer_thickness, (thickness - layer_thickness) / 2
    d = t + s
    (E, G), (_, G_layer) = moduli(steel), moduli(layer)
    face, mass, layer_mass = rectangle(width, t, steel), steel.density * width * t, layer.density * width * s
    coupled, in_layer = layer_torsion(width, t, s, G, G_layer)
    whole = 2 * mass + layer_mass
    layer_rotary = layer_mass * s**2 / 12
    return Sandwich(
        faces=Section(
            axial=2 * face.axial,
            torsion=2 * face.torsion,
            bending_y=2 * face.bending_y,
            bending_z=2 * face.bending_z,
            shear_y=2 * face.shear_y,
            mass=whole,
            rotary_y=2 * face.rotary_y + mass * d**2 / 2 + layer_rotary,
            rotary_z=whole * width**2 / 12,
        ),
        stretching=E * width * t,
        distance=d,
        slip=G_layer * width / s,
        layer_torsion=coupled,
        torsion_in_layer=in_layer,
        face_rotary=2 * face.rotary_y,
        face_mass=mass,
        layer_rotary=layer_rotary,
        layer_thickness=s,
        parts=parts,
    )


def layer_torsion(width: float, t: float, s: float, G: float, G_layer: float) -> tuple[float, float]:
    """G J [N m²] that the layer's coupling adds to two faces of thickness `t`, and the share of it stored in the layer.

    The energy is linear in G_c for a given slip, so the layer's share follows from d(G J) / d(ln G_c).
    """
    x = width / 2 * np.sqrt(2 * G_layer / (s * G * t))
    # tanh(x)/x and sech² lose everything to rounding at small x, where their series are x²/3 and x²/3 (1 - 4 x²/5).
    coupled = x**2 / 3 - 2 * x**4 / 15 if x < 1e-3 else 1 - np.tanh(x) / x
    stored = x**2 / 3 - 4 * x**4 / 15 if x < 1e-3 else (np.tanh(x) / x - 1 / np.cosh(min(x, 300.0)) ** 2) / 2
    return float(2 * G * t * (t + s) ** 2 * width * coupled), float(stored / coupled)


def sandwich_element(section: Sandwich, length: float) -> Element:
    """Element of `length` [m]: the slip at start and end is its nodal degree of freedom, that in the middle its inner one."""
    n = 15
    faces, layer, mass = np.zeros((3, n, n))
    base = timoshenko(section.faces, length, "faces")
    faces[:12, :12], mass[:12, :12] = base.stiffness["faces"], base.mass
    _add_torsion(faces, section.layer_torsion * (1 - section.torsion_in_layer), length)
    _add_torsion(layer, section.layer_torsion * section.torsion_in_layer, length)
    dofs = np.ix_([*IN_XZ, 12, 13, 14], [*IN_XZ, 12, 13, 14])
    faces[dofs], layer[dofs], mass[dofs] = _bending(section, length)
    bottom, middle, top = section.parts
    return Element(stiffness={bottom: faces / 2, middle: layer, top: faces / 2}, mass=mass, nodal=1, inner=1)


def _bending(section: Sandwich, L: float) -> tuple[Array, Array, Array]:
    """Stiffness of the faces and of the layer and the mass, (7, 7): w, ry at start and end; slip at start, end, middle."""
    xi, weights = GAUSS_POINTS, GAUSS_WEIGHTS * L
    sign = np.array([*SIGN_XZ, 1.0, 1.0, 1.0])[:, None]
    deflection, slope = shape_functions(xi, 0.0, L)
    curvature = np.array([(12 * xi - 6) / L**2, (6 * xi - 4) / L, (6 - 12 * xi) / L**2, (6 * xi - 2) / L])
    slip = np.array([(1 - xi) * (1 - 2 * xi), xi * (2 * xi - 1), 4 * xi * (1 - xi)])  # a parabola: start, end, middle
    slip_rate, none = np.array([4 * xi - 3, 4 * xi - 1, 4 - 8 * xi]) / L, np.zeros((3, 4))
    w, w1, w2 = (sign * np.vstack([shape, none]) for shape in (deflection, slope, curvature))
    delta, delta1 = (np.vstack([np.zeros((4, 4)), shape]) for shape in (slip, slip_rate))

    def integral(density: float, shape: Array) -> Array:
        return np.asarray(density * (shape * weights) @ shape.T)

    d, s = section.distance, section.layer_thickness
    faces = integral(section.faces.bending_y, w2) + integral(section.stretching / 2, delta1 - d * w2)
    layer = integral(section.slip, delta)
    mass = integral(section.mass, w) + integral(section.face_rotary, w1)
    mass += integral(section.face_mass / 2, delta - d * w1) + integral(section.layer_rotary, delta / s - w1)
    return faces, layer, mass


def _add_torsion(k: Array, torsion: float, length: float) -> None:
    k[np.ix_([3, 9], [3, 9])] += torsion / length * np.array([[1.0, -1.0], [-1.0, 1.0]])
