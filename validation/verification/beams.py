"""Rows about beam elements: a bar that lies askew in space, bent, stretched and twisted, against closed forms.

None of the closed forms knows of an element. Bending is governed by w' = psi + Q / (k G A), psi' = M / (E I),
M' = -Q - rho I omega² psi, Q' = -rho A omega² w with w the deflection, psi the rotation of the section, M the bending moment and
Q the shear force (Timoshenko 1921; Huang 1961). What these four become over a whole beam is the exponential of their matrix, so a
frequency equation is one 2 x 2 determinant of it, and the answer to a moving clamp is one linear system. Letting k G A go to
infinity and rho I to zero leaves Euler and Bernoulli's beam, whose roots come here from the textbook equation instead.

The bar lies along no axis of the frame, so every row passes through the rotation of the elements as well.
"""

from dataclasses import dataclass, replace

import numpy as np
import numpy.typing as npt

from fem.beam.elements import Sandwich, Section, rectangle, sandwich, tube
from fem.beam.frame import Member, Plan, assemble
from fem.exudyn.linear import modes_of_plan
from fem.modes import Modes
from fem.structure import Structure
from geometry.article import Material
from geometry.frames import Array, rigid_transformation_6
from validation.verification.check import Found, Mesh, Rows, once, order

ComplexMatrix = npt.NDArray[np.complex128]

STEPS = 2000
"""Steps of the frequency axis in which a determinant is looked at for a change of sign."""


@dataclass(frozen=True, kw_only=True)
class Beam:
    """A straight uniform beam that bends in one plane.

    Attributes
    ----------
    length : [m]
    bending : E I [N m²]; complex with a loss factor
    shear : k G A [N]; infinite for none
    mass : rho A [kg/m]
    rotary : rho I [kg m]
    """

    length: float
    bending: complex
    shear: complex = np.inf
    mass: float
    rotary: float = 0.0

    def euler_bernoulli(self, count: int, *, clamped: bool) -> Array:
        """Elastic frequencies (count,) [Hz], clamped at one end or free, from ``1 ± cos x cosh x = 0`` (Blevins, Table 8-1)."""
        from scipy.optimize import brentq

        sign, half = (1, -0.5) if clamped else (-1, 0.5)
        near = [(k + half) * np.pi for k in range(1, count + 1)]
        roots = np.array([brentq(lambda x: np.cos(x) + sign / np.cosh(x), x - 0.5, x + 0.5, xtol=1e-14) for x in near])
        return np.asarray((roots / self.length) ** 2 / (2 * np.pi) * np.sqrt(abs(self.bending) / self.mass))

    def timoshenko(self, count: int, *, clamped: bool) -> Array:
        """Elastic frequencies (count,) [Hz] with neither moment nor shear at the tip; the start is clamped, or free likewise."""
        from scipy.optimize import brentq

        start = slice(2, 4) if clamped else slice(0, 2)

        def determinant(frequency: Array) -> Array:
            return np.asarray(np.linalg.det(self._over(2 * np.pi * frequency)[:, 2:, start]).real)

        highest = 1.01 * self.euler_bernoulli(count, clamped=clamped)[-1]  # shear and rotary inertia only lower them
        grid = np.linspace(1e-3 * highest, highest, STEPS)
        values = determinant(grid)
        signs = np.flatnonzero(np.sign(values[:-1]) != np.sign(values[1:]))[:count]
        exact = 1e-13 * highest
        return np.array([brentq(lambda f: determinant(np.array([f]))[0], grid[k], grid[k + 1], xtol=exact) for k in signs])

    def base_driven(self, frequency: npt.ArrayLike) -> ComplexMatrix:
        """Blocked dynamic mass (n, 2, 2) of a cantilever at its clamp: deflection and rotation driven, shear and moment answered.

        The beam lies along x from the clamp and deflects along y, so that the rotation is about z and the moment that the clamp
        exerts as well. The frequency must not be zero.
        """
        omega = 2 * np.pi * np.atleast_1d(np.asarray(frequency, dtype=np.float64))
        T = self._over(omega)
        # At the tip M = Q = 0 = T[2:, :2] @ (w, psi) + T[2:, 2:] @ (M, Q); the clamp exerts -Q along y and -M about z.
        answer = np.linalg.solve(T[:, 2:, 2:], T[:, 2:, :2])[:, ::-1]
        return np.asarray(answer / -(omega[:, None, None] ** 2), dtype=np.complex128)

    def _over(self, omega: Array) -> ComplexMatrix:
        """What the beam makes of w, psi, M, Q at its start (n, 4, 4): the exponential of its state matrix, by its eigenvectors.

        Deflection and rotation are measured in the beam's length and in radians, moment and force in E I / L and E I / L², or
        the exponential would lose digits to the units.
        """
        L, EI, s = self.length, abs(self.bending), omega**2
        A = np.zeros((len(omega), 4, 4), dtype=np.complex128)
        A[:, 0, 1], A[:, 0, 3] = 1.0, EI / L**2 / self.shear
        A[:, 1, 2] = EI / self.bending
        A[:, 2, 1], A[:, 2, 3] = -self.rotary * s * L**2 / EI, -1.0
        A[:, 3, 0] = -self.mass * s * L**4 / EI
        values, vectors = np.linalg.eig(A)
        T = (vectors * np.exp(values)[:, None, :]) @ np.linalg.inv(vectors)
        scale = np.array([L, 1.0, EI / L, EI / L**2])
        return np.asarray(scale[:, None] * T / scale[None, :], dtype=np.complex128)


def rod_fixed_free(wave_speed: float, length: float, count: int) -> Array:
    """Frequencies (count,) [Hz] of a rod in tension or torsion, clamped at one end: ``(2 k - 1) c / (4 L)``."""
    return np.asarray((2 * np.arange(1, count + 1) - 1) * wave_speed / (4 * length), dtype=np.float64)


def rod_dynamic_mass(inertia: float, wave_speed: complex, length: float, frequency: npt.ArrayLike) -> ComplexMatrix:
    """Base load for a unit base acceleration (n,) of a rod of `inertia` [kg or kg m²]: ``m tan(k L) / (k L)``, k = omega / c."""
    x = 2 * np.pi * np.asarray(frequency) * length / wave_speed
    return np.asarray(inertia * np.tan(x) / x, dtype=np.complex128)


STEEL = Material(name="steel", density=7850.0, youngs_modulus=207e9, poisson_ratio=0.3)
RECTANGLE = rectangle(0.02, 0.01, STEEL)
EULER = replace(RECTANGLE, shear_y=np.inf, shear_z=np.inf, rotary_y=0.0, rotary_z=0.0)
ROD = tube(0.02, 0.0, STEEL)
SLENDER, STOCKY = 1.0, 0.06
"""Lengths [m]: a hundred times the rectangle's height, and six times."""

ALONG = np.array([2.0, 3.0, 6.0]) / 7
SIDE = np.array([6.0, 2.0, -3.0]) / 7
"""Unit vectors along the bar and along the section's z axis, in which it bends."""

PART = "bar"
BENDING, TENSION, TORSION = "bending", "tension", "torsion"

ELEMENTS = {Mesh.FAST: 40, Mesh.FINE: 80}
LEVELS = (4, 8, 16)
"""Elements of a study of convergence."""

MODES = 3

Case = tuple[Section, float, str, bool]
"""Section, length [m], motion, clamped at the start."""

UNIT_MOTIONS = {
    BENDING: np.transpose([np.append(SIDE, np.zeros(3)), np.append(np.zeros(3), np.cross(ALONG, SIDE))]),
    TENSION: np.append(ALONG, np.zeros(3))[:, None],
    TORSION: np.append(np.zeros(3), ALONG)[:, None],
}
"""What one node may do (6, k): bend in the plane of `SIDE`, move along the bar, or turn about it."""


def plan(section: Section | Sandwich, length: float, elements: int, along: Array = ALONG, side: Array = SIDE) -> Plan:
    """A bar that begins at the origin."""
    numbers = tuple(range(elements + 1))
    member = Member(nodes=numbers, section=section, z_axis=side, part=PART)
    return Plan(nodes=np.linspace(0, length, elements + 1)[:, None] * along, carriers=numbers, members=(member,))


def structure(section: Section, length: float, elements: int, *, loss_factor: float) -> Structure:
    """The bar on a base that holds its first node, about that node."""
    from scipy.sparse import csr_array

    frame = assemble(plan(section, length, elements))
    K = csr_array(frame.stiffness[PART])
    return Structure(
        stiffness=K,
        mass=csr_array(frame.mass),
        rigid=frame.rigid,
        held=np.arange(6),
        part_stiffness={PART: K},
        loss_factors={PART: loss_factor},
    )


def rod_constants(section: Section, motion: str) -> tuple[float, float]:
    """Stiffness [N or N m²] and inertia [kg/m or kg m] of the section in tension or torsion."""
    if motion == TENSION:
        return section.axial, section.mass
    return section.torsion, section.rotary_y + section.rotary_z


def closed_form(section: Section, length: float, motion: str, clamped: bool, count: int) -> Array:
    """The lowest `count` elastic frequencies [Hz] of the bar without elements."""
    if motion == BENDING:
        beam = Beam(length=length, bending=section.bending_y, shear=section.shear_z, mass=section.mass, rotary=section.rotary_y)
        frequencies = beam.timoshenko if np.isfinite(section.shear_z) else beam.euler_bernoulli
        return frequencies(count, clamped=clamped)
    stiffness, inertia = rod_constants(section, motion)
    return rod_fixed_free(np.sqrt(stiffness / inertia), length, count)


@once
def _references(case: Case) -> Array:
    return closed_form(*case, MODES)


@once
def _values(case: Case, elements: int) -> Array:
    """The same frequencies by elements."""
    from scipy.linalg import eigh

    section, length, motion, clamped = case
    frame = assemble(plan(section, length, elements))
    held = (2 if motion == BENDING else 1) if clamped else 0
    B = np.kron(np.eye(elements + 1), UNIT_MOTIONS[motion])[:, held:]
    K, M = B.T @ frame.stiffness[PART] @ B, B.T @ frame.mass @ B
    rigid = 0 if clamped else 2
    squares = eigh(K, M, eigvals_only=True, subset_by_index=[rigid, rigid + MODES - 1])
    return np.asarray(np.sqrt(squares) / (2 * np.pi))


BARS = Rows("Beam elements")


def _mode(case: Case, number: int, mesh: Mesh) -> Found:
    return Found(float(_references(case)[number - 1]), float(_values(case, ELEMENTS[mesh])[number - 1]))


def _order(case: Case, expected: float, number: int, mesh: Mesh) -> Found:
    """Order with which the frequency of mode `number` approaches the closed form as elements get shorter."""
    reference = _references(case)[number - 1]
    errors = [_values(case, n)[number - 1] / reference - 1 for n in LEVELS]
    return Found(expected, order([1 / n for n in LEVELS], errors))


HERMITE = (4, 2, "cubic deflection: eigenvalues of order 4 (Strang and Fix, chapter 6)")
EVEN_SHEAR = (2, 2, "shear strain even over an element: order 2 for what shear contributes")
LINEAR = (2, 1, "linear displacement: eigenvalues of order 2 (Strang and Fix, chapter 6)")
"""Order of convergence, the mode that shows it, and why."""

BLEVINS_CLAMPED, BLEVINS_FREE = "1 + cos x cosh x = 0 (Blevins, Table 8-1)", "1 - cos x cosh x = 0 (Blevins, Table 8-1)"
TRANSCENDENTAL = "Timoshenko's frequency equation, solved by bisection"

_CASES: tuple[tuple[str, str, float, Case, str, tuple[float, int, str] | None], ...] = (
    ("Euler-Bernoulli cantilever", BLEVINS_CLAMPED, 1e-5, (EULER, SLENDER, BENDING, True), "", HERMITE),
    ("Euler-Bernoulli bar, both ends free", BLEVINS_FREE, 1e-5, (EULER, SLENDER, BENDING, False), "", None),
    ("Timoshenko cantilever", TRANSCENDENTAL, 2e-3, (RECTANGLE, STOCKY, BENDING, True), ", 6 heights long", EVEN_SHEAR),
    ("Timoshenko bar, 6 heights long, both ends free", TRANSCENDENTAL, 2e-3, (RECTANGLE, STOCKY, BENDING, False), "", None),
    ("Rod in tension", "(2 k - 1) c / (4 L), c² = E / rho", 2e-3, (ROD, SLENDER, TENSION, True), ", one end clamped", LINEAR),
    (
        "Round rod in torsion",
        "(2 k - 1) c / (4 L), c² = G / rho",
        2e-3,
        (ROD, SLENDER, TORSION, True),
        ", one end clamped",
        LINEAR,
    ),
)
"""Words, source, bar, case, what the words of the modes add, and the rate of convergence where it is checked."""

for _words, _source, _bar, _case, _more, _rate in _CASES:
    for _k in range(1, MODES + 1):
        BARS.relative(f"{_words}{_more}, mode {_k}", _source, "Hz", _bar, _case, _k)(_mode)
    if _rate is not None:
        _expected, _k, _why = _rate
        BARS.absolute(f"{_words}, mode {_k}: order of convergence", _why, 0.2, _case, _expected, _k)(_order)


@BARS.absolute("Rigid motions: force per stiffness and motion", "a rigid body is not strained", 1e-12)
def _rigid_motion(mesh: Mesh) -> Found:
    """Zero, and the largest force of the six rigid motions as a share of the largest stiffness times that motion."""
    frame = assemble(plan(RECTANGLE, STOCKY, 3))
    K, T = frame.stiffness[PART], frame.rigid
    return Found(0.0, float(np.max(np.abs(K @ T) / np.max(np.abs(K) @ np.abs(T), axis=0))))


@BARS.absolute("Rigid mass matrix of two elements", "rod with the section's rotary inertia, closed form", 1e-12)
def _rigid_inertia(mesh: Mesh) -> Found:
    """Zero, and the largest deviation of the bar's rigid mass matrix from that of a rod with thick ends [share of its scale]."""
    frame, expected = assemble(plan(RECTANGLE, STOCKY, 2)), rod_inertia(RECTANGLE, STOCKY)
    difference = frame.rigid.T @ frame.mass @ frame.rigid - expected
    scale = np.sqrt(np.diag(expected))
    return Found(0.0, float(np.max(np.abs(difference) / np.outer(scale, scale))))


def rod_inertia(section: Section, length: float) -> Array:
    """6x6 mass matrix about its start of a straight rod along `ALONG` with rotary inertia of its section."""
    axes = np.array([ALONG, np.cross(SIDE, ALONG), SIDE])
    mass, polar = section.mass * length, section.rotary_y + section.rotary_z
    own = length * np.array([polar, section.rotary_y, section.rotary_z]) + mass * length**2 / 12 * np.array([0, 1, 1])
    centre = rigid_transformation_6(ALONG * length / 2)
    matrix = np.block([[mass * np.eye(3), np.zeros((3, 3))], [np.zeros((3, 3)), axes.T @ np.diag(own) @ axes]])
    return np.asarray(centre.T @ matrix @ centre)


# Rows about exudyn as the independent route: its own beams and its own eigen-solution, no element of ours.
#
# Exudyn's beam is geometrically exact with linear shapes; `fem.exudyn` solves a mesh and one twice as fine and extrapolates.


EXUDYN_BEAMS = Rows("Exudyn")

EXUDYN_BEAMS_ELEMENTS = {Mesh.FAST: 10, Mesh.FINE: 20}
EXUDYN_BEAMS_MODES = 8
MOVES = 0.01
"""Effective mass or inertia along an axis, as a share of the whole, from which a mode counts as moving along it."""

AXIS = {BENDING: 2, TENSION: 0, TORSION: 3}
"""Of the base: along z, along the bar, about the bar."""

ALONG_X, UP = np.eye(3)[[0, 2]]


@once
def _exudyn_beams_modes(section: Section, mesh: Mesh) -> Modes:
    """Modes of a bar along x, `STOCKY` long, clamped at its start."""
    return modes_of_plan(plan(section, STOCKY, EXUDYN_BEAMS_ELEMENTS[mesh], ALONG_X, UP), EXUDYN_BEAMS_MODES)


def _exudyn_beams_mode(section: Section, motion: str, number: int, mesh: Mesh) -> Found:
    modes, axis = _exudyn_beams_modes(section, mesh), AXIS[motion]
    moving = modes.effective_mass[:, axis] > MOVES * modes.rigid_mass[axis, axis]
    reference = closed_form(section, STOCKY, motion, True, number)[number - 1]
    return Found(float(reference), float(modes.frequency[moving][number - 1]))


for _what, _source, _section, _motion, _k in (
    *((f"cantilever, 6 heights long, mode {k}", TRANSCENDENTAL, RECTANGLE, BENDING, k) for k in (1, 2, 3)),
    ("rod in tension, mode 1", "c / (4 L), c² = E / rho", ROD, TENSION, 1),
    ("round rod in torsion, mode 1", "c / (4 L), c² = G / rho", ROD, TORSION, 1),
):
    EXUDYN_BEAMS.relative(f"Exudyn's beams: {_what}", _source, "Hz", 1e-3, _section, _motion, _k)(_exudyn_beams_mode)


# Rows about the sandwich element: a simply supported beam of two faces and a soft layer, after Mead and Markus.
#
# With w = W sin(k x) the slip follows as a cosine, and the layer acts as a spring in series with the faces' stretching: per
# width, the bending stiffness at the wave number k is
#
#     B(k) = E t³ / 6 + E t d² / 2 * g / (1 + g),    g = 2 G_c / (E t s k²),    d = t + s,
#
# from two loose faces at short waves to the bonded section at long ones (Ross, Ungar and Kerwin 1959; Mead and Markus, J. Sound
# Vib. 10, 1969, 163-175). A loss factor of the layer makes G_c complex; to first order a mode has of it the share of its energy
# that the layer stores, d ln B / d ln G_c.


SANDWICH = Rows("Sandwich beam")
LAYER = Material(name="silicone", density=1100.0, youngs_modulus=3e6, poisson_ratio=0.49)
LAYER_SHEAR_MODULUS = 3e6 / (2 * (1 + 0.49))
"""[Pa]"""

LENGTH, WIDTH, THICKNESS, LAYER_THICKNESS = 1.0, 0.06, 4.5e-3, 0.5e-3
"""[m]"""

SANDWICH_ELEMENTS = {Mesh.FAST: 16, Mesh.FINE: 32}
Z, BETA = 2, 4


def stiffness(k: float, shear_modulus: complex) -> complex:
    """B(k) times the width [N m²]."""
    t, s = (THICKNESS - LAYER_THICKNESS) / 2, LAYER_THICKNESS
    g = 2 * shear_modulus / (207e9 * t * s * k**2)
    return WIDTH * (207e9 * t**3 / 6 + 207e9 * t * (t + s) ** 2 / 2 * g / (1 + g))


@once
def _sandwich_modes(mesh: Mesh) -> tuple[Array, Array]:
    """Frequencies [Hz] and the layer's share of the energy of each mode."""
    from scipy.linalg import eigh

    elements = SANDWICH_ELEMENTS[mesh]
    section = sandwich(WIDTH, THICKNESS, LAYER_THICKNESS, STEEL, LAYER, ("bottom", "layer", "top"))
    frame = assemble(plan(section, LENGTH, elements, ALONG_X, UP))
    # Deflection but for the ends, rotation in the plane, and every slip
    bending = [6 * node + dof for node in range(elements + 1) for dof in (Z, BETA) if dof == BETA or 0 < node < elements]
    kept = np.array([*bending, *range(6 * (elements + 1), len(frame.mass))])
    free = np.ix_(kept, kept)
    K, M = sum(frame.stiffness.values(), np.zeros_like(frame.mass))[free], frame.mass[free]
    squares, shapes = eigh(K, M, subset_by_index=[0, MODES - 1])
    stored = np.einsum("ir,ij,jr->r", shapes, frame.stiffness["layer"][free], shapes)
    return np.sqrt(squares) / (2 * np.pi), stored / squares


def _frequency(number: int, mesh: Mesh) -> Found:
    k = number * np.pi / LENGTH
    mass = WIDTH * (STEEL.density * (THICKNESS - LAYER_THICKNESS) + LAYER.density * LAYER_THICKNESS)
    expected = k**2 / (2 * np.pi) * np.sqrt(abs(stiffness(k, LAYER_SHEAR_MODULUS)) / mass)
    return Found(float(expected), float(_sandwich_modes(mesh)[0][number - 1]))


def _share(number: int, mesh: Mesh) -> Found:
    """Share of the strain energy of mode `number` that the layer stores [1]."""
    k, step = number * np.pi / LENGTH, 1e-30
    B = stiffness(k, LAYER_SHEAR_MODULUS * (1 + 1j * step))  # a complex step: the derivative without a difference
    return Found(float(B.imag / B.real / step), float(_sandwich_modes(mesh)[1][number - 1]))


for _k in range(1, MODES + 1):
    _words, _source = f"Simply supported sandwich, mode {_k}", "Mead and Markus (1969), simply supported"
    SANDWICH.relative(_words, f"{_source}; without rotary inertia", "Hz", 5e-4, _k)(_frequency)
    SANDWICH.relative(f"{_words}: energy in the layer", _source, "", 2e-3, _k)(_share)
