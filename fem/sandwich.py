"""A sandwich: two equal faces with one deflection and a soft layer between them that only shears.

The theory is that of Mead and Markus (J. Sound Vib. 10, 1969) and DiTaranto, sixth order in x. The faces bend as beams and
stretch against one another; with d between their middles and w' their common slope, the layer's two surfaces slip by
delta = u_top - u_bottom + d w'. Per unit length, with the faces' E I_f and E A_f, the layer's shear modulus G_c, its thickness s
and the width b, the energy is half of

    2 E I_f w''²  +  E A_f / 2 (delta' - d w'')²  +  G_c b / s delta².

Short waves slip (2 E I_f is left), long ones do not (2 E I_f + E A_f d² / 2): the bending stiffness belongs to a wavelength. The
slip is one more degree of freedom at each node and one inside each element, a parabola, so that free slip is met exactly.

Torsion at rate tau: the faces warp in their planes by +/- psi(y) and the layer slips by chi = 2 psi + d y tau. The
energy over the width, G t_f (psi' - d tau / 2)² + G_c / (2 s) chi², is least when chi'' = lambda² chi with
lambda² = 2 G_c / (s G t_f), the edges being free, and then

    G J = 2 G b t_f³ / 3  +  2 G t_f d² b (1 - tanh(x) / x),   x = lambda b / 2,

from the faces alone to the bonded plate. The faces' own share has the edges of a rectangle; the layer's has not, which matters
only when it is nearly bonded (2 % of the torsion of a plate 30 times as wide as thick). Across its width the sandwich bends
with its faces. Every share is split into what the faces and what the layer hold, so that each keeps its own loss factor.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.element import GAUSS_POINTS, GAUSS_WEIGHTS, IN_XZ, SIGN_XZ, Element, shape_functions, timoshenko
from fem.moduli import moduli
from fem.section import Section, rectangle, require_positive
from geometry.arrays import Array
from geometry.errors import BadInput
from geometry.materials import Material


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
        raise BadInput(
            source="section of a sandwich",
            field="layer.thickness",
            problem=f"must be less than the thickness of the blade {1e3 * thickness:g} mm, found {1e3 * layer_thickness:g} mm",
            remedy="Make the layer thinner or the blade thicker",
        )
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
    none, slip, slip_rate = np.zeros((3, 4)), *_parabola(xi, L)
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


def _parabola(xi: Array, L: float) -> tuple[Array, Array]:
    """Quadratic shapes (3, len(xi)) with nodes at start, end and middle, and their slopes [1/m]."""
    shape = np.array([(1 - xi) * (1 - 2 * xi), xi * (2 * xi - 1), 4 * xi * (1 - xi)])
    return shape, np.array([4 * xi - 3, 4 * xi - 1, 4 - 8 * xi]) / L


def _add_torsion(k: Array, torsion: float, length: float) -> None:
    k[np.ix_([3, 9], [3, 9])] += torsion / length * np.array([[1.0, -1.0], [-1.0, 1.0]])
