"""Where the body hangs at rest: statics of a rigid body on chains of links, some of which stretch.

The unknowns are the body's place x and rotation R, the joints p of the chains, and the tension T of every link. The stationary
point of

    Pi = sum of weights times heights + sum_k [T_k (|d_k| - L_k) - c_k T_k² / 2],     d_k from one end of link k to the other,

is equilibrium in x, R, p and, in T, the law of the link: ``|d| = L + c T``, with compliance c = L/EA or zero. Newton's method on

    [ H   G^T ] [dq]     [ G^T T + weight ]
    [ G   -c  ] [dT] = - [ |d| - L - c T  ]

with H = sum_k T_k d²|d_k|, the geometric stiffness, converges from the level body. Rotations are moved by small rotation vectors
in the fixed frame. With `twist` held, the rotation about the vertical is no unknown.
"""

from __future__ import annotations

from dataclasses import dataclass, replace

import numpy as np

from fem.flexible_body.rope_pendulum.bearing import require_light, require_pull, require_stiff, shares
from fem.flexible_body.rope_pendulum.suspension import Suspension, refused, require_positive
from geometry.arrays import Array
from geometry.consistency import require_physical
from geometry.errors import CheckFailed
from geometry.frames import skew
from geometry.inertia import Inertia

VERTICAL = 5
"""Number of the rotation about the vertical among the coordinates of the body: x, y, z, alpha, beta, gamma."""

ITERATIONS = 60
LARGEST_TURN = 0.2
"""Radians that Newton's method may turn the body in one go."""

SMALL = 1e-12
"""Of the weight, and of the rope's length: what may be left over."""

TWIST_STEP = 0.25
"""Radians between two equilibria on the way to a large twist."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Ropework:
    """A body on its ropes, before any pose.

    Attributes
    ----------
    body : with the half links at the feet of the ropes, about its CoG and seen from there, axes as it hangs
    article : (3,) [m] CoG of the article alone, from that of `body`
    feet : (n, 3) [m] from the CoG of `body`
    anchors : (n, 3) [m] on the ceiling, in the fixed frame; its origin is where the article's CoG would be on rigid ropes
    link_lengths : (n,) [m] unloaded length of one link of each rope
    links : of each rope
    compliance : (n,) [m/N] of one link of each rope
    point_mass : [kg] in every joint between two links
    gravity : [m/s²]
    """

    body: Inertia
    article: Array
    feet: Array
    anchors: Array
    link_lengths: Array
    links: int
    compliance: Array
    point_mass: float
    gravity: float

    @property
    def ropes(self) -> int:
        """How many."""
        return len(self.feet)

    @property
    def joints(self) -> int:
        """Between two links, of each rope."""
        return self.links - 1

    @property
    def size(self) -> int:
        """Number of coordinates: six of the body, three of every joint."""
        return 6 + 3 * self.ropes * self.joints


@dataclass(frozen=True, eq=False, kw_only=True)
class Pose:
    """One pose of a `Ropework`, at rest or not.

    Attributes
    ----------
    place : (3,) [m] CoG of the body, in the fixed frame
    rotation : (3, 3) of the body
    joints : (n, links - 1, 3) [m], from the ceiling down
    tension : (n, links) [N]
    """

    place: Array
    rotation: Array
    joints: Array
    tension: Array


def ropework(inertia: Inertia, suspension: Suspension, gravity: float) -> Ropework:
    """The body `inertia` (about its CoG at the origin, axes as it hangs) on its ropes.

    Raises
    ------
    BadInput : no body has this inertia, gravity is not positive, a rope would have to push or stretch beyond `MOST_STRAIN`, ropes
        are heavier than the body, or the body would tip over.
    """
    require_positive("mass", inertia.mass, "kg")
    require_positive("gravity", gravity, "m/s²")
    article = require_physical(inertia, "inertia")
    require_pull(suspension, article.mass * gravity)
    require_light(suspension, article.mass)
    require_stiff(suspension, article.mass * gravity, suspension.rope_mass * gravity)
    lump = suspension.rope_mass / suspension.ropes / suspension.links
    body = article
    for foot in suspension.feet:
        body += Inertia.from_cog(lump / 2, foot, np.zeros((3, 3)))
    links = suspension.lengths / suspension.links
    return Ropework(
        body=Inertia.from_cog(body.mass, np.zeros(3), body.tensor_cog),
        article=-body.cog,
        feet=suspension.feet - body.cog,
        anchors=suspension.feet + np.array([0.0, 0.0, suspension.length]),
        link_lengths=links,
        links=suspension.links,
        compliance=links / suspension.stiffness if suspension.stiffness else np.zeros(suspension.ropes),
        point_mass=lump,
        gravity=gravity,
    )


def at_rest(work: Ropework, twist: float | None = None) -> Pose:
    """Where the body hangs, left to itself or with `twist` [rad] about the vertical held.

    Raises
    ------
    CheckFailed : no equilibrium was found: with ropes that slack, or at a twist where they would cross or lie flat.
    """
    pose = _relaxed(work, _level(work), held=False)
    if twist is None:
        return pose
    steps = int(np.ceil(abs(twist) / TWIST_STEP))
    for _ in range(steps):
        pose = _relaxed(work, _turned_on(work, pose, twist / steps), held=True)
    return pose


def moved(work: Ropework, pose: Pose, step: Array) -> Pose:
    """`pose` after a `step` (k,) of its coordinates, the body's six first, its rotation by a vector in the fixed frame."""
    from scipy.spatial.transform import Rotation

    return replace(
        pose,
        place=pose.place + step[:3],
        rotation=Rotation.from_rotvec(step[3:6]).as_matrix() @ pose.rotation,
        joints=pose.joints + step[6:].reshape(pose.joints.shape),
    )


def feet_of(work: Ropework, pose: Pose) -> Array:
    """(n, 3) [m] the feet of the ropes in the fixed frame."""
    return np.asarray(pose.place + work.feet @ pose.rotation.T)


def energy(work: Ropework, pose: Pose) -> float:
    """Energy [J] of weight and stretch."""
    weight = work.body.mass * pose.place[2] + work.point_mass * pose.joints[..., 2].sum()
    return float(work.gravity * weight + np.sum(work.compliance[:, None] * pose.tension**2) / 2)


def stiffness(work: Ropework, pose: Pose) -> tuple[Array, Array]:
    """Geometric stiffness (k, k) and the links' gradients (n links, k) at `pose`; the body's coordinates come first."""
    H, G = np.zeros((work.size, work.size)), np.zeros((work.ropes * work.links, work.size))
    arms = work.feet @ pose.rotation.T
    for row, (i, k, d) in enumerate(_links(work, pose)):
        u, length = d / np.linalg.norm(d), float(np.linalg.norm(d))
        T = pose.tension[i, k]
        B = np.zeros((3, work.size))  # how the link's vector moves with the coordinates
        if k > 0:
            B[:, _joint(work, i, k - 1)] -= np.eye(3)
        if k < work.joints:
            B[:, _joint(work, i, k)] += np.eye(3)
        else:
            B[:, :3] += np.eye(3)
            B[:, 3:6] -= skew(arms[i])
            H[3:6, 3:6] += T * ((np.outer(u, arms[i]) + np.outer(arms[i], u)) / 2 - (u @ arms[i]) * np.eye(3))
        G[row] = u @ B
        H += T / length * B.T @ (np.eye(3) - np.outer(u, u)) @ B
    return H, G


def mass(work: Ropework, pose: Pose) -> Array:
    """Mass matrix (k, k) at `pose`, coordinates as those of `stiffness`."""
    M = work.point_mass * np.eye(work.size)
    M[:3, :3] = work.body.mass * np.eye(3)
    M[3:6, 3:6] = pose.rotation @ work.body.tensor @ pose.rotation.T
    return M


def _level(work: Ropework) -> Pose:
    """The level body under straight ropes as long as their load makes them, with the tension that statics gives them."""
    share = shares(work.feet) * work.body.mass
    below = np.arange(work.links)[::-1]  # joints below each link
    tension = work.gravity * (share[:, None] + work.point_mass * below)
    reach = np.cumsum(work.link_lengths[:, None] + work.compliance[:, None] * tension, axis=1)
    joints = np.repeat(work.anchors[:, None, :], work.joints, axis=1)
    joints[..., 2] -= reach[:, :-1]
    place = np.array([*(work.anchors - work.feet)[0, :2], np.mean(work.anchors[:, 2] - reach[:, -1] - work.feet[:, 2])])
    return Pose(place=place, rotation=np.eye(3), joints=joints, tension=tension)


def _turned_on(work: Ropework, pose: Pose, angle: float) -> Pose:
    """`pose` turned on about the vertical by `angle`, every joint taken along in proportion to its depth."""
    c, s = np.cos(angle), np.sin(angle)
    R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
    turned = replace(pose, rotation=R @ pose.rotation)
    way = feet_of(work, turned) - feet_of(work, pose)
    depth = np.arange(1, work.links) / work.links
    return replace(turned, joints=pose.joints + depth[None, :, None] * way[:, None, :])


def _relaxed(work: Ropework, pose: Pose, *, held: bool) -> Pose:
    """Newton's method from `pose`, with the rotation about the vertical held or not."""
    free = np.array([k for k in range(work.size) if not (held and k == VERTICAL)])
    weight = _weight(work)
    for _ in range(ITERATIONS):
        H, G = stiffness(work, pose)
        H, G = H[np.ix_(free, free)], G[:, free]
        T = pose.tension.ravel()
        left_over = np.concatenate([G.T @ T + weight[free], _stretched_too_far(work, pose)])
        size = np.concatenate([np.full(len(free), work.body.mass * work.gravity), np.repeat(work.link_lengths, work.links)])
        if np.abs(left_over / size).max() < SMALL:
            return _require_taut(work, pose)
        try:
            step = np.linalg.solve(np.block([[H, G.T], [G, -np.diag(np.repeat(work.compliance, work.links))]]), -left_over)
        except np.linalg.LinAlgError:
            break
        step *= min(1.0, LARGEST_TURN / max(np.abs(step[3 : 6 - held]).max(), SMALL))
        full = np.zeros(work.size)
        full[free] = step[: len(free)]
        pose = replace(moved(work, pose, full), tension=pose.tension + step[len(free) :].reshape(pose.tension.shape))
    raise CheckFailed("the rope pendulum has no equilibrium there: statics did not converge", place=pose.place.tolist())


def _require_taut(work: Ropework, pose: Pose) -> Pose:
    if pose.tension.min() <= 0:
        i = int(pose.tension.min(axis=1).argmin())
        problem = f"rope {i + 1} would have to push with {-pose.tension[i].min():.4g} N at rest"
        name = "extra" if np.ptp(work.link_lengths) else "off_centre"
        raise refused(name, problem, "Make the ropes more equal, softer, or set them further from each other")
    return pose


def _weight(work: Ropework) -> Array:
    """Gradient (k,) of the energy of weight."""
    g = np.zeros(work.size)
    g[2], g[8::3] = work.body.mass * work.gravity, work.point_mass * work.gravity
    return g


def _stretched_too_far(work: Ropework, pose: Pose) -> Array:
    lengths = np.array([np.linalg.norm(d) for _, _, d in _links(work, pose)])
    law = work.link_lengths[:, None] + work.compliance[:, None] * pose.tension
    return lengths - law.ravel()


def _links(work: Ropework, pose: Pose) -> list[tuple[int, int, Array]]:
    """Number of the rope, of the link from the ceiling, and its vector downwards, for all links."""
    feet = feet_of(work, pose)
    chains = [np.vstack([work.anchors[i], pose.joints[i], feet[i]]) for i in range(work.ropes)]
    return [(i, k, chain[k + 1] - chain[k]) for i, chain in enumerate(chains) for k in range(work.links)]


def _joint(work: Ropework, rope: int, joint: int) -> slice:
    start = 6 + 3 * (rope * work.joints + joint)
    return slice(start, start + 3)
