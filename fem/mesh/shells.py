"""Flat shell triangles: Felippa's membrane with drilling rotations and the discrete Kirchhoff bending of Batoz, in space.

A quadrilateral is the mean of its two divisions into two triangles, which a warped one can be divided into as well. Shells of one
material are thin: transverse shear is left out, which raises the first frequency of a plate of thickness t and width b by about
(3 t / b)². Layered ones have it: along each edge they bend and shear as a beam of Timoshenko does, and where shear is stiff the
triangle is the thin one.
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.frames import Array, Integers

TRIANGLES = {
    "tri3": (((0, 1, 2), 1.0),),
    "tri6": (((0, 3, 5), 1.0), ((3, 1, 4), 1.0), ((5, 4, 2), 1.0), ((3, 4, 5), 1.0)),
    "quad4": (((0, 1, 2), 0.5), ((0, 2, 3), 0.5), ((0, 1, 3), 0.5), ((1, 2, 3), 0.5)),
    "quad8": (
        *(((0, 4, 7), 1.0), ((1, 5, 4), 1.0), ((2, 6, 5), 1.0), ((3, 7, 6), 1.0)),
        *(((4, 5, 6), 0.5), ((4, 6, 7), 0.5), ((4, 5, 7), 0.5), ((5, 6, 7), 0.5)),
    ),
}
"""Triangles of each kind of shell element: corners, and the share with which they count."""

_MIDDLES = np.array([[0.5, 0.5, 0.0], [0.0, 0.5, 0.5], [0.5, 0.0, 0.5]])
"""Area coordinates of a rule that integrates squares on a triangle exactly; each point has a third of the area."""

_OUTER, _INNER = 0.445948490915965, 0.091576213509771
_SIX = np.array([np.roll([1 - 2 * a, a, a], turn) for a in (_OUTER, _INNER) for turn in range(3)])
_SIX_WEIGHTS = np.repeat([0.223381589678011, 0.109951743655322], 3)
"""Dunavant's rule of degree four (Int. J. Num. Meth. Eng. 21, 1985)."""


def areas(corners: Array) -> Array:
    """Area (c,) of triangles (c, 3, 3)."""
    return np.asarray(np.linalg.norm(np.cross(corners[:, 1] - corners[:, 0], corners[:, 2] - corners[:, 0]), axis=1) / 2)


def plane_stress(E: float, nu: float) -> Array:
    """Elasticity (3, 3) [Pa] between strains xx, yy, gamma xy and stresses of a thin sheet."""
    return E / (1 - nu**2) * np.array([[1, nu, 0], [nu, 1, 0], [0, 0, (1 - nu) / 2]])


@dataclass(frozen=True, eq=False, kw_only=True)
class Layer:
    """A layer of a laminate: elasticity `plane` (3, 3) of a thin sheet and shear moduli `across` (2,) of xz and yz [Pa], infinite
    where stiff, along its fibres, at an `angle` [rad] from the laminate's first axis towards its second; [m] and [kg/m³]."""

    plane: Array
    across: Array
    angle: float
    thickness: float
    density: float

    @property
    def turned(self) -> Array:
        """`plane` in the laminate's axes."""
        c, s = np.cos(self.angle), np.sin(self.angle)
        turn = np.array([[c * c, s * s, s * c], [s * s, c * c, -s * c], [-2 * s * c, 2 * s * c, c * c - s * s]])
        return np.asarray(turn.T @ self.plane @ turn)


@dataclass(frozen=True, eq=False, kw_only=True)
class Laminate:
    """Layers from the lower face up, by what strains and curvatures (A, B, D) and transverse shear cost, about their middle.

    Attributes
    ----------
    membrane, coupling, bending : (3, 3) [N/m, N, N m], in the laminate's axes
    shear : (2, 2) [N/m]; of infinite layers zero, and no shear is let be
    masses : (3,) zeroth, first and second moment of density about the middle [kg/m², kg/m, kg]
    height : of the middle above the nodes [m]
    """

    membrane: Array
    coupling: Array
    bending: Array
    shear: Array
    masses: Array
    height: float = 0.0

    @classmethod
    def of(cls, layers: Sequence[Layer], height: float = 0.0) -> "Laminate":
        """Of `layers`; along either axis transverse shear is spread as the equilibrium of a strip asks for that bends about its
        neutral plane, 5/6 of G t of one layer (Whitney, J. Appl. Mech. 40, 1973)."""
        ends = np.cumsum([0.0, *(one.thickness for one in layers)])
        ends -= ends[-1] / 2
        moments, masses, planes, softness = np.zeros((3, 3, 3)), np.zeros(3), [], []
        for one, low, high in zip(layers, ends, ends[1:], strict=False):
            c, s = np.cos(one.angle), np.sin(one.angle)
            planes.append(one.turned)
            softness.append(np.array([[c, -s], [s, c]]) / one.across @ np.array([[c, s], [-s, c]]))
            for k in range(3):
                power = (high ** (k + 1) - low ** (k + 1)) / (k + 1)
                moments[k] += power * planes[-1]
                masses[k] += power * one.density
        stretched, first, second = (np.diag(one)[:2] for one in moments)
        neutral, passed, soft = first / stretched, np.zeros(2), np.zeros((2, 2))
        X, W = np.polynomial.legendre.leggauss(3)
        for Q, each, low, high in zip(planes, softness, ends, ends[1:], strict=False):
            stretch, heights = np.diag(Q)[:2], [*((low + high + X * (high - low)) / 2), high]
            flow = [passed - stretch * ((z - neutral) ** 2 - (low - neutral) ** 2) / 2 for z in heights]
            soft += sum(w * (high - low) / 2 * each * np.outer(one, one) for w, one in zip(W, flow, strict=False))
            passed = flow[-1]
        stiff = np.outer(bending := second - neutral * first, bending)
        shear = np.linalg.inv(soft) * stiff if soft.any() else soft
        return cls(membrane=moments[0], coupling=moments[1], bending=moments[2], shear=shear, masses=masses, height=height)


_STRETCHED = np.array([[6 * node + dof for dof in (0, 1, 5)] for node in range(3)]).ravel()
_BENT = np.array([[6 * node + dof for dof in (2, 3, 4)] for node in range(3)]).ravel()


def _laid(corners: Array, along: Array | None = None) -> tuple[Array, Array]:
    """Axes (c, 3, 3) of triangles (c, 3, 3), in rows, the third upright on them, and their corners (c, 3, 2) along two.

    The first is `along` (c, 3), as far as it is in the plane, or the first side where it is not at all.
    """
    first = corners[:, 1] - corners[:, 0]
    normal = np.cross(first, corners[:, 2] - corners[:, 0])
    if along is not None:
        level = along - np.sum(along * normal, axis=1, keepdims=True) * normal / np.sum(normal**2, axis=1, keepdims=True)
        first = np.where(np.abs(level).max(axis=1, keepdims=True) > 1e-9 * np.abs(along).max(), level, first)
    x, z = (vector / np.linalg.norm(vector, axis=1, keepdims=True) for vector in (first, normal))
    R = np.stack([x, np.cross(z, x), z], axis=1)
    return R, np.einsum("cij,ckj->cki", R[:, :2], corners - corners[:, :1])


def strains(corners: Array, moved: Array, thickness: float) -> Array:
    """Strain (c, 3, 24, m) at the corners (c, 3, 3) of triangles which are `moved` (c, 18, m).

    Of the middle surface, as a tensor in the frame like those of solids, times the root of the `thickness`; and curvatures times
    the root of its cube over twelve and by the normal, which way round it ever is: the square of the length is that of both.
    """
    R, flat = _laid(corners)
    own = np.einsum("ab,cij->caibj", np.eye(6), R).reshape(-1, 18, 18) @ moved
    (_, mean, spread), (_, bent) = _stretches(flat), _curvatures(flat, np.eye(3))
    flats = np.stack([(mean + one) @ own[:, _STRETCHED] for one in spread], axis=1) * np.sqrt(thickness)
    curved = np.stack([one @ own[:, _BENT] for one in bent], axis=1) * np.sqrt(thickness**3 / 12)
    a, b = R[:, 0], R[:, 1]
    pairs = [np.einsum("ci,cj->cij", u, v) for u, v in ((a, a), (b, b), (a, b))]
    tensors = np.stack([*pairs[:2], (pairs[2] + pairs[2].swapaxes(1, 2)) / 2], axis=1)
    six = np.stack(
        [*(tensors[..., i, i] for i in range(3)), *(np.sqrt(2) * tensors[..., i, j] for i, j in ((1, 2), (0, 2), (0, 1)))], axis=2
    )
    into = [np.einsum("ces,ckem->cksm", six, one, optimize=True) for one in (flats, curved)]
    upright = np.einsum("ci,cksm->ckism", R[:, 2], into[1]).reshape(*into[1].shape[:2], 18, -1)
    return np.concatenate([into[0], upright], axis=2)


def sheets(corners: Array, nodes: Integers) -> Integers:
    """(c,) which smooth sheet each of the triangles with `nodes` (c, 3) at `corners` (c, 3, 3) belongs to: folds part them."""
    from scipy.sparse import coo_array, csr_array
    from scipy.sparse.csgraph import connected_components

    normals = _laid(corners)[0][:, 2]
    edges = np.sort(np.stack([nodes[:, [0, 1]], nodes[:, [1, 2]], nodes[:, [2, 0]]], axis=1), axis=2).reshape(-1, 2)
    edge = np.unique(edges, axis=0, return_inverse=True)[1].ravel()
    at = csr_array((np.ones(len(edge)), (np.repeat(np.arange(len(nodes)), 3), edge)))
    beside = coo_array(at @ at.T)
    smooth = np.abs(np.sum(normals[beside.row] * normals[beside.col], axis=1)) > SMOOTH
    graph = csr_array((np.ones(np.sum(smooth)), (beside.row[smooth], beside.col[smooth])), shape=beside.shape)
    return np.asarray(connected_components(graph, directed=False)[1], dtype=np.intp)


SMOOTH = 0.85
"""[1] Cosine of the angle between two triangles above which they are one sheet and no fold: 30 degrees, by which twelve flat
sides of a round body turn. By definition."""


def matrices(corners: Array, thickness: float, E: float, nu: float, density: float) -> tuple[Array, Array, Array]:
    """Membrane and bending stiffness and mass (c, 18, 18) of triangles (c, 3, 3) [m] of one `thickness` [m].

    Degrees of freedom are x, y, z and the rotations about them of the first node, of the second ...; membrane stiffness grows
    with the thickness, bending stiffness with its cube.
    """
    D = plane_stress(E, nu)
    R, flat = _laid(corners)
    turned = np.einsum("ab,cij->caibj", np.eye(6), R).reshape(-1, 18, 18)
    membrane, bending = turned[:, _STRETCHED], turned[:, _BENT]
    K_membrane = _seen(thickness * _membrane(flat, D, nu), membrane)
    K_bending = _seen(thickness**3 / 12 * _bending(flat, D), bending)
    return K_membrane, K_bending, masses(corners, R[:, 2], density * thickness, density * thickness**3 / 12)


def masses(corners: Array, normal: Array, area_density: float, rotary: float) -> Array:
    """Consistent mass (c, 18, 18) of triangles, and the rotary inertia of a fibre through the thickness, none about itself."""
    area, N = areas(corners), displacement(corners, _SIX)
    M = np.einsum("c,q,cqia,cqib->cab", area_density * area, _SIX_WEIGHTS, N, N, optimize=True)
    about = np.eye(3) - np.einsum("ci,cj->cij", normal, normal)
    spread = np.einsum("c,ab,cij->caibj", rotary * area / 12, np.ones((3, 3)) + np.eye(3), about)
    whole = M.reshape(-1, 3, 6, 3, 6)
    whole[:, :, 3:, :, 3:] += spread
    return np.asarray(M)


def layered(corners: Array, laminate: Laminate, along: Array, offsets: Array) -> tuple[Array, Array, Array]:
    """Two shares of the stiffness and the mass of triangles (c, 3, 3) [m] of a laminate whose first axis is `along` (c, 3).

    They are off their nodes by `offsets` (c, 3, 3) [m]. The shares grow with the thickness of all layers and with its cube, and
    are such that their sum has its value and its derivative. Tilts in the middle of edges are those of a beam along each (Katili,
    Int. J. Num. Meth. Eng. 36, 1993, DKMT).
    """
    R, flat = _laid(corners, along)
    turned = np.einsum("ab,cij->caibj", np.eye(6), R).reshape(-1, 18, 18)[:, [*_STRETCHED, *_BENT]]
    A, B, D = laminate.membrane, laminate.coupling, laminate.bending
    area, mean, _ = _stretches(flat)
    (linear, cubic), mixed = np.zeros((2, len(flat), 21, 21)), np.zeros((len(flat), 9, 12))
    linear[:, :9, :9] = _membrane(flat, A, A[0, 1] / float(np.sqrt(A[0, 0] * A[1, 1])))
    for bent in _curvatures(flat, _MIDDLES, free=True)[1]:
        cubic[:, 9:, 9:] += area[:, None, None] / 3 * (bent.swapaxes(1, 2) @ D @ bent)
        mixed += area[:, None, None] / 3 * (mean.swapaxes(1, 2) @ B @ bent)
    for half in (linear, cubic):
        half[:, :9, 9:] += mixed / 2
        half[:, 9:, :9] += mixed.swapaxes(1, 2) / 2
    edges, (_, slopes), sides = np.zeros((len(flat), 3, 12)), _slopes(flat), ((0, 1), (1, 2), (2, 0))
    free, soft = D - B @ np.linalg.solve(A, B), np.linalg.inv(laminate.shear) if laminate.shear.any() else laminate.shear
    phi = np.zeros((len(flat), 3))
    for edge, (i, j) in enumerate(sides):  # shear along an edge times its length, where the tilt in its middle is 2/3 of its mean
        side = flat[:, j] - flat[:, i]
        length = np.linalg.norm(side, axis=1)
        for node, sign in ((i, -1.0), (j, 1.0)):
            edges[:, edge, 3 * node] = sign
            edges[:, edge, 3 * node + 1], edges[:, edge, 3 * node + 2] = -side[:, 1] / 2, side[:, 0] / 2
        edges[:, edge, 9 + edge] = 2 / 3 * length
        a, b = (side / length[:, None]).T
        bend = np.stack([a * a, b * b, 2 * a * b], axis=1)
        phi[:, edge] = 12 * np.sum(bend @ free * bend, axis=1) * np.sum((side @ soft) * side, axis=1) / length**4
    for L in _MIDDLES if laminate.shear.any() else ():
        sheared = np.stack([L[i] * slopes[:, j] - L[j] * slopes[:, i] for i, j in sides], axis=2) @ edges
        linear[:, 9:, 9:] += area[:, None, None] / 3 * (sheared.swapaxes(1, 2) @ laminate.shear @ sheared)
    tilts = -edges[:, :, :9] / (edges[:, range(3), range(9, 12)] * (1 + phi))[:, :, None]
    T = np.concatenate([np.tile(np.eye(18), (len(flat), 1, 1)), np.pad(tilts, ((0, 0), (0, 0), (9, 0)))], axis=1)
    faded = np.concatenate([np.zeros((len(flat), 18, 18)), T[:, 18:] * (-2 * phi / (1 + phi))[:, :, None]], axis=1)
    K, slope = T.swapaxes(1, 2) @ (linear + cubic) @ T, T.swapaxes(1, 2) @ (linear + cubic) @ faded
    slope = T.swapaxes(1, 2) @ (linear + 3 * cubic) @ T + slope + slope.swapaxes(1, 2)  # by the logarithm of the thickness
    # Mass is where its middle is, and turns about that
    m, first, second = laminate.masses
    lifted = [carried(offsets + R[:, None, 2] * (laminate.height + off)) for off in (0.0, first / m if m else 0.0)]
    T, M = turned @ lifted[0], masses(corners, R[:, 2], m, second - first**2 / m if m else 0.0)
    return _seen((3 * K - slope) / 2, T), _seen((slope - K) / 2, T), _seen(M, lifted[1])


def carried(offsets: Array) -> Array:
    """What triangles (c, 18, 18) do of what their nodes do, which they are off by `offsets` (c, 3, 3)."""
    T = np.tile(np.eye(18), (len(offsets), 1, 1))
    for node in range(3):
        for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # rotation about j moves along i by the offset along k
            T[:, 6 * node + i, 6 * node + 3 + j], T[:, 6 * node + i, 6 * node + 3 + k] = offsets[:, node, k], -offsets[:, node, j]
    return T


def displacement(corners: Array, weights: Array) -> Array:
    """What the eighteen degrees of freedom of triangles (c, 3, 3) move at area coordinates `weights` (q, 3); (c, q, 3, 18).

    A node's motion is carried half way by its own rotation, which makes the field quadratic and continuous across edges (Allman,
    Computers & Structures 19, 1984, in the plane; the same for bending).
    """
    points = np.einsum("qa,cai->cqi", weights, corners)
    offsets, N = points[:, :, None] - corners[:, None], np.zeros((len(corners), len(weights), 3, 3, 6))
    for i in range(3):
        N[..., i, :, i] = weights
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):  # rotation about j moves along i by the offset along k
        N[..., i, :, 3 + j] = weights * offsets[..., k] / 2
        N[..., i, :, 3 + k] = -weights * offsets[..., j] / 2
    return N.reshape(len(corners), len(weights), 3, 18)


def _bending(flat: Array, D: Array) -> Array:
    """Discrete Kirchhoff triangle (c, 9, 9) for a thickness of which t³ / 12 is one: w, rotation about x and y of each node.

    Rotations of the normal are quadratic; at nodes and, along the edges, at their middles they follow the slope of a cubic
    deflection (Batoz, Bathe and Ho, Int. J. Num. Meth. Eng. 15, 1980).
    """
    K = np.zeros((len(flat), 9, 9))
    area, B = _curvatures(flat, _MIDDLES)
    for each in B:
        K += np.einsum("c,cia,ij,cjb->cab", area / 3, each, D, each, optimize=True)
    return K


def _curvatures(flat: Array, weights: Array, free: bool = False) -> tuple[Array, list[Array]]:
    """Area (c,) and, at each of the area coordinates `weights` (q, 3), curvatures xx, yy, 2 xy (c, 3, 9) by the nine motions.

    Or (c, 3, 12): what the normal tilts along each edge in its middle beside the mean of its ends is `free`.
    """
    c = len(flat)
    G = np.zeros((c, 6, 2, 12 if free else 9))  # tilt of the normal (beta_x, beta_y) at corners and middles of edges
    for node in range(3):
        G[:, node, 0, 3 * node + 2] = 1.0  # a rotation about y tilts the normal towards x
        G[:, node, 1, 3 * node + 1] = -1.0
    for edge, (i, j) in enumerate(((0, 1), (1, 2), (2, 0))):
        along = flat[:, j] - flat[:, i]
        length = np.linalg.norm(along, axis=1)
        s = along / length[:, None]
        tangent = np.einsum("ci,cj->cij", s, s)
        # Across the edge the mean of the ends; along it -3 (w_j - w_i) / (2 l) - (their sum) / 4
        blend = np.eye(2) / 2 - (0.0 if free else 0.75) * tangent
        G[:, 3 + edge] = np.einsum("cij,cja->cia", blend, G[:, i] + G[:, j])
        if free:
            G[:, 3 + edge, :, 9 + edge] = s
            continue
        G[:, 3 + edge, :, 3 * j] -= 1.5 * s / length[:, None]
        G[:, 3 + edge, :, 3 * i] += 1.5 * s / length[:, None]
    (area, slopes), found = _slopes(flat), []
    for L in weights:
        corner = np.array([4 * L[a] - 1 for a in range(3)])[None, :, None] * slopes
        middle = np.stack([4 * (L[i] * slopes[:, j] + L[j] * slopes[:, i]) for i, j in ((0, 1), (1, 2), (2, 0))], axis=1)
        d = np.concatenate([corner, middle], axis=1)  # (c, 6, 2) derivatives of the quadratic functions
        xx, yy = (np.einsum("ca,cak->ck", d[..., i], G[:, :, i]) for i in (0, 1))
        xy = np.einsum("ca,cak->ck", d[..., 1], G[:, :, 0]) + np.einsum("ca,cak->ck", d[..., 0], G[:, :, 1])
        found.append(np.stack([xx, yy, xy], axis=1))
    return area, found


def _slopes(flat: Array) -> tuple[Array, Array]:
    """Area (c,) and gradients (c, 3, 2) of the area coordinates."""
    x, y = flat[..., 0], flat[..., 1]
    twice = (x[:, 1] - x[:, 0]) * (y[:, 2] - y[:, 0]) - (x[:, 2] - x[:, 0]) * (y[:, 1] - y[:, 0])
    gradients = [np.stack([y[:, j] - y[:, k], x[:, k] - x[:, j]], axis=1) / twice[:, None] for j, k in ((1, 2), (2, 0), (0, 1))]
    return np.asarray(twice / 2), np.stack(gradients, axis=1)


_Q = np.array([[1.0, 2.0, 1.0], [0.0, 1.0, -1.0], [-1.0, -1.0, -2.0]])
"""Free numbers beta 1 to 9 of the membrane's higher-order strains; with `ALPHA` and `_stiffer` the optimal ones."""

ALPHA = 1.5


def _membrane(flat: Array, D: Array, nu: float) -> Array:
    """Felippa's optimal membrane triangle (c, 9, 9) of unit thickness: u, v and rotation about the normal of each node.

    The basic stiffness meets constant strain, the higher-order one makes bending in the plane exact for rectangles of two
    triangles (Felippa, Comput. Methods Appl. Mech. Engrg. 192, 2003, OPT).
    """
    area, mean, spread = _stretches(flat)
    K = np.einsum("c,cia,ij,cjb->cab", area, mean, D, mean, optimize=True)
    stiffer = 0.75 * max((1 - 4 * nu**2) / 2, 0.01)
    for a, b in ((0, 1), (1, 2), (2, 0)):
        middle = (spread[a] + spread[b]) / 2
        K += np.einsum("c,cia,ij,cjb->cab", stiffer * area, middle, D, middle, optimize=True)
    return np.asarray(K)


def _stretches(flat: Array) -> tuple[Array, Array, list[Array]]:
    """Area (c,), mean strains xx, yy, 2 xy (c, 3, 9) by the nine motions in the plane, and what corners have beside the mean."""
    x, y, c = flat[..., 0], flat[..., 1], len(flat)
    area, _ = _slopes(flat)

    def dx(i: int, j: int) -> Array:
        return np.asarray(x[:, i] - x[:, j])

    def dy(i: int, j: int) -> Array:
        return np.asarray(y[:, i] - y[:, j])

    L = np.zeros((c, 9, 3))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        L[:, 3 * i, 0] = L[:, 3 * i + 1, 2] = dy(j, k)
        L[:, 3 * i + 1, 1] = L[:, 3 * i, 2] = dx(k, j)
        L[:, 3 * i + 2, 0] = ALPHA / 6 * dy(j, k) * (dy(i, k) - dy(j, i))
        L[:, 3 * i + 2, 1] = ALPHA / 6 * dx(k, j) * (dx(k, i) - dx(i, j))
        L[:, 3 * i + 2, 2] = ALPHA / 3 * (dx(k, i) * dy(i, k) - dx(i, j) * dy(j, i))
    # Rotations of the corners less that of the whole
    T = np.zeros((c, 3, 9))
    for i, j, k in ((0, 1, 2), (1, 2, 0), (2, 0, 1)):
        T[:, :, 3 * i] = (dx(k, j) / (4 * area))[:, None]
        T[:, :, 3 * i + 1] = (dy(k, j) / (4 * area))[:, None]
        T[:, i, 3 * i + 2] = 1.0
    # Natural strains along the edges 21, 32, 13, and Cartesian strains from them
    edges = ((1, 0), (2, 1), (0, 2))
    square = np.stack([dx(a, b) ** 2 + dy(a, b) ** 2 for a, b in edges], axis=1)
    natural = np.stack(
        [
            np.stack([dx(a, b) ** 2, dy(a, b) ** 2, dx(a, b) * dy(a, b)], axis=1) / square[:, [n]]
            for n, (a, b) in enumerate(edges)
        ],
        axis=1,
    )
    from_natural = np.linalg.inv(natural)
    # Strains at the corners by beta, each row over the square of its edge
    turns = [np.array([[_Q.flat[n - 1] for n in row] for row in rows]) for rows in _ROWS]
    Q = [2 / 3 * (area[:, None, None] / square[:, :, None]) * turn for turn in turns]
    return area, np.swapaxes(L, 1, 2) / (2 * area[:, None, None]), [from_natural @ one @ T for one in Q]


_ROWS = (((1, 2, 3), (4, 5, 6), (7, 8, 9)), ((9, 7, 8), (3, 1, 2), (6, 4, 5)), ((5, 6, 4), (8, 9, 7), (2, 3, 1)))
"""Which beta stands where in the strains at the three corners."""


def _seen(local: Array, T: Array) -> Array:
    seen = T.transpose(0, 2, 1) @ local @ T
    return np.asarray((seen + seen.transpose(0, 2, 1)) / 2)
