"""`Suspension`: how a body hangs - ropes, where they hold it, what they weigh, how far they stretch - and how it is set swinging.

Axes as the body hangs: z upwards, the origin in its CoG. Every rope goes straight up from its foot to the ceiling before the
body is let down on it, so that ropes of one length hold a centred body level. What ropes stretch and what an off-centre CoG tilts
comes out of the statics.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field, replace
from typing import Any, Literal

import numpy as np
import numpy.typing as npt

from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, freeze, frozen, skew
from geometry.inertia import Inertia, require_physical

HEIGHT = 0.1
"""Feet of the ropes above the CoG [m] where nothing else is said; Eq. 5 does not know it."""

MOST_LINKS = 20
"""Links of a rope at most: their error is then below 1 % of the rope's own effect, and the cost grows with their cube."""

LONGEST = 1000.0
"""Longest rope [m]."""

MOST_STRAIN = 0.1
"""Strain of a rope at rest above which no spring stands for it: steel breaks at 2 %, and what stretches further is not linear."""

Start = Literal["twist", "push"]
"""Let go at rest from a held twist, or pushed out of rest so that it would swing as far."""

SOURCE = "rope pendulum"
AXES = ("x", "y", "z")


@dataclass(frozen=True, eq=False, kw_only=True)
class Suspension:
    """Two or three ropes and a start.

    Attributes
    ----------
    feet : (n, 3) [m] where the ropes hold the body, from its CoG, axes as it hangs; n is 2 or 3
    length : [m] of the ropes, unloaded
    amplitude : [rad] peak twist at the start
    extra : (n,) [m] by which each rope is longer than `length`
    stiffness : [N] EA of each rope; None for ropes that do not stretch
    rope_mass : [kg] of all ropes together
    links : of which each rope is made, with its mass in the joints between them (half a link's at both ends); 1 for a
        straight rope, whose lower half then rides on the body
    stretch_damping : damping ratio of the heave on ropes that stretch, by dampers along them
    damping_ratio : of the small twist, viscous about the vertical
    start : "twist" or "push"
    """

    feet: Array
    length: float
    amplitude: float
    extra: Array = field(default_factory=lambda: np.zeros(0))
    stiffness: float | None = None
    rope_mass: float = 0.0
    links: int = 1
    stretch_damping: float = 0.0
    damping_ratio: float = 0.0
    start: Start = "twist"

    def __post_init__(self) -> None:
        n = len(self.feet)
        extra = self.extra if np.size(self.extra) else np.zeros(n)
        freeze(self, feet=(n, 3))
        object.__setattr__(self, "extra", frozen(extra, (n,), "extra"))
        if n not in (2, 3):
            raise refused("ropes", f"two or three are simulated, found {n}", "More would share the weight in unknown parts")
        require_positive("length", self.length, "m")
        if self.length > LONGEST:
            raise refused("length", f"ropes of {self.length:.6g} m are longer than {LONGEST:g} m", f"Give {LONGEST:g} m or less")
        # Refuse a rope longer or shorter than the others by as much as their feet are apart: the body would stand on end
        across = np.linalg.norm(self.feet[:, None] - self.feet[None], axis=2)
        apart = min(self.length, float(across[across > 0].min(initial=np.inf)))
        worst = float(np.ptp(self.extra))
        if not (worst < apart and self.lengths.min() > 0):
            problem = f"ropes of {self.length:.4g} m whose feet are {apart:.3g} m apart cannot be {worst:.4g} m unequal"
            raise refused("extra", problem, f"The body would stand on end: give well below {apart / 2:.2g} m")
        require_positive("amplitude", self.amplitude, "rad")
        if self.stiffness is not None:
            require_positive("stiffness", self.stiffness, "N")
        if not (np.isfinite(self.rope_mass) and self.rope_mass >= 0):
            remedy = "Give the mass of all ropes together"
            raise refused("rope_mass", f"it cannot be negative, found {self.rope_mass:.6g} kg", remedy)
        if self.links > MOST_LINKS:
            raise refused("links", f"at most {MOST_LINKS} a rope are simulated, found {self.links}", f"Use {MOST_LINKS} or fewer")
        if self.links < 1 or (self.links > 1 and self.rope_mass == 0):
            remedy = "Give 1, or a mass to put between them"
            raise refused("links", f"ropes of {self.rope_mass:.6g} kg cannot have {self.links} links", remedy)
        for name in ("damping_ratio", "stretch_damping"):
            if not 0 <= getattr(self, name) < 1:
                remedy = "A ratio of 1 no longer swings"
                raise refused(name, f"it must be from 0 to below 1, found {getattr(self, name):.6g}", remedy)
        if self.start not in ("twist", "push"):
            raise refused("start", f"found {self.start!r}", "Start from a held twist or with a push")

    @property
    def ropes(self) -> int:
        """How many."""
        return len(self.feet)

    @property
    def lengths(self) -> Array:
        """(n,) [m], unloaded."""
        return self.length + self.extra


def on_two_ropes(
    s1: float, s2: float, *, height: float = HEIGHT, off_centre: Sequence[float] = (0.0, 0.0), **more: Any
) -> Suspension:
    """Two ropes `s1` and `s2` [m] to either side of where the CoG is thought to be, along x, feet `height` [m] above it.

    `off_centre` (2,) [m] is how far along x and y the CoG really is from there; `more` are fields of `Suspension`.

    Raises
    ------
    BadInput : a length that is not positive.
    """
    for name, value in (("s1", s1), ("s2", s2)):
        require_positive(name, value, "m")
    return _moved(np.array([[-s1, 0.0, height], [s2, 0.0, height]]), off_centre, more)


def on_three_ropes(radius: float, *, height: float = HEIGHT, off_centre: Sequence[float] = (0.0, 0.0), **more: Any) -> Suspension:
    """Three ropes evenly on a circle of `radius` [m], the first on the x axis; see `on_two_ropes`.

    Raises
    ------
    BadInput : a length that is not positive.
    """
    require_positive("radius", radius, "m")
    turn = 2 * np.pi * np.arange(3) / 3
    return _moved(np.column_stack([radius * np.cos(turn), radius * np.sin(turn), np.full(3, height)]), off_centre, more)


def hung(inertia: Inertia, axis: str = "z", along: str | None = None) -> Inertia:
    """`inertia` about its CoG, in the axes in which it hangs: the article's `axis` up, `along` on x (where two ropes are).

    `along` is z where that lies, x where z is upright. The origin of the result is the CoG.

    Raises
    ------
    BadInput : no such axis, or both the same.
    """
    ahead = along or lying(axis)
    for name, value in (("axis", axis), ("along", ahead)):
        if value not in AXES:
            raise refused(name, f"x, y or z is expected, found {value!r}", "Name an axis of the article's own frame")
    if ahead == axis:
        raise refused("along", f"{ahead} is upright, no ropes can be set along it", "Name one of the two axes that lie")
    return Inertia.from_cog(inertia.mass, np.zeros(3), inertia.tensor_cog).rotated(turned(axis, ahead))


def lying(axis: str) -> str:
    """The article's axis that is on x where nothing else is said: z where that lies, x where z is upright."""
    return "x" if axis == "z" else "z"


def turned(axis: str, along: str) -> Array:
    """Rotation (3, 3) that takes the article's `axis` up and its `along` to x."""
    up, ahead = np.eye(3)[AXES.index(axis)], np.eye(3)[AXES.index(along)]
    return np.array([ahead, np.cross(up, ahead), up])


def refused(name: str, problem: str, remedy: str) -> BadInput:
    """The complaint about the field `name`, ready to be raised."""
    return BadInput(SOURCE, name, problem, remedy)


def require_positive(name: str, value: float, unit: str) -> None:
    """Pass a `value` above zero and below infinity.

    Raises
    ------
    BadInput : it is not.
    """
    if not (np.isfinite(value) and value > 0):
        raise refused(name, f"it must be positive, found {value:.6g} {unit}".rstrip(), "Check the sign and the number")


def _moved(feet: npt.NDArray[np.float64], off_centre: Sequence[float], more: dict[str, Any]) -> Suspension:
    shift = np.array([*off_centre, 0.0])
    return Suspension(feet=feet - shift, **more)


IN_LINE = 1e-12
"""Twice the area [m²] between three feet below which they are in one line."""


def shares(feet: Array) -> Array:
    """Share of the weight on every rope (n,) of a level body whose CoG is the origin; negative where it would have to push."""
    lever = np.vstack([np.ones(len(feet)), feet[:, :2].T])
    return np.asarray(np.linalg.lstsq(lever, np.array([1.0, 0.0, 0.0]), rcond=None)[0])


# Where the body hangs at rest: statics of a rigid body on chains of links, some of which stretch.
#
# The unknowns are the body's place x and rotation R, the joints p of the chains, and the tension T of every link. The stationary
# point of
#
#     Pi = sum of weights times heights + sum_k [T_k (|d_k| - L_k) - c_k T_k² / 2],     d_k from one end of link k to the other,
#
# is equilibrium in x, R, p and, in T, the law of the link: ``|d| = L + c T``, with compliance c = L/EA or zero. Newton's method
# on
#
#     [ H   G^T ] [dq]     [ G^T T + weight ]
#     [ G   -c  ] [dT] = - [ |d| - L - c T  ]
#
# with H = sum_k T_k d²|d_k|, the geometric stiffness, converges from the level body. Rotations are moved by small rotation
# vectors in the fixed frame. With `twist` held, the rotation about the vertical is no unknown.

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
    # Ropes must all pull, not lie in one line, not let the body tip over, be no heavier than it and not stretch too far
    feet, share, weight = suspension.feet, shares(suspension.feet), article.mass * gravity
    if share.min() <= 0:
        worst = int(share.argmin())
        problem = f"the CoG is not between the ropes: rope {worst + 1} would have to push with {-share[worst] * weight:.4g} N"
        raise refused("off_centre", problem, "Hang the body so that its CoG lies between them")
    lever = feet[:, :2] - feet[0, :2]
    if len(feet) == 3 and abs(np.linalg.det(lever[1:])) < IN_LINE:
        raise refused("feet", "three ropes in one line hold nothing more than two", "Set them on a circle")
    if len(feet) == 2 and feet[:, 2].min() <= 0:
        problem = f"on two ropes whose feet are {feet[:, 2].min():.4g} m above the CoG the body tips over"
        raise refused("height", problem, "Tie them above the CoG")
    ropes, body = suspension.rope_mass, article
    if ropes > article.mass:
        problem = f"ropes of {ropes:.4g} kg are heavier than the body of {article.mass:.4g} kg: they swing it, not it them"
        raise refused("rope_mass", problem, f"Give {np.floor(1000 * article.mass) / 1000:g} kg or less for all ropes together")
    if suspension.stiffness is not None:
        load = float(share.max()) * weight + ropes * gravity / suspension.ropes
        strain = load / suspension.stiffness
        if strain > MOST_STRAIN:
            problem = f"a rope would stretch by {100 * strain:.3g} % under {load:.4g} N, more than {100 * MOST_STRAIN:g} %"
            raise refused("stiffness", problem, f"Use an EA of {1.01 * load / MOST_STRAIN:.3g} N or more")
    lump = ropes / suspension.ropes / suspension.links
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
    # The level body under straight ropes as long as their load makes them, with the tension that statics gives them
    share = shares(work.feet) * work.body.mass
    below = np.arange(work.links)[::-1]  # joints below each link
    tension = work.gravity * (share[:, None] + work.point_mass * below)
    reach = np.cumsum(work.link_lengths[:, None] + work.compliance[:, None] * tension, axis=1)
    joints = np.repeat(work.anchors[:, None, :], work.joints, axis=1)
    joints[..., 2] -= reach[:, :-1]
    place = np.array([*(work.anchors - work.feet)[0, :2], np.mean(work.anchors[:, 2] - reach[:, -1] - work.feet[:, 2])])
    level = Pose(place=place, rotation=np.eye(3), joints=joints, tension=tension)
    pose = _relaxed(work, level, held=False)
    if twist is None:
        return pose
    steps = int(np.ceil(abs(twist) / TWIST_STEP))
    for _ in range(steps):
        # `pose` turned on about the vertical by `angle`, every joint taken along in proportion to its depth
        angle = twist / steps
        c, s = np.cos(angle), np.sin(angle)
        R = np.array([[c, -s, 0.0], [s, c, 0.0], [0.0, 0.0, 1.0]])
        turned = replace(pose, rotation=R @ pose.rotation)
        way = feet_of(work, turned) - feet_of(work, pose)
        depth = np.arange(1, work.links) / work.links
        turned_on = replace(turned, joints=pose.joints + depth[None, :, None] * way[:, None, :])
        pose = _relaxed(work, turned_on, held=True)
    return pose


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


def _relaxed(work: Ropework, pose: Pose, *, held: bool) -> Pose:
    """Newton's method from `pose`, with the rotation about the vertical held or not."""
    from scipy.spatial.transform import Rotation

    free = np.array([k for k in range(work.size) if not (held and k == VERTICAL)])
    # Gradient (k,) of the energy of weight
    weight = np.zeros(work.size)
    weight[2], weight[8::3] = work.body.mass * work.gravity, work.point_mass * work.gravity
    for _ in range(ITERATIONS):
        H, G = stiffness(work, pose)
        H, G = H[np.ix_(free, free)], G[:, free]
        T = pose.tension.ravel()
        lengths = np.array([np.linalg.norm(d) for _, _, d in _links(work, pose)])
        law = work.link_lengths[:, None] + work.compliance[:, None] * pose.tension
        left_over = np.concatenate([G.T @ T + weight[free], lengths - law.ravel()])
        size = np.concatenate([np.full(len(free), work.body.mass * work.gravity), np.repeat(work.link_lengths, work.links)])
        if np.abs(left_over / size).max() < SMALL:
            if pose.tension.min() <= 0:
                i = int(pose.tension.min(axis=1).argmin())
                problem = f"rope {i + 1} would have to push with {-pose.tension[i].min():.4g} N at rest"
                name = "extra" if np.ptp(work.link_lengths) else "off_centre"
                raise refused(name, problem, "Make the ropes more equal, softer, or set them further from each other")
            return pose
        try:
            step = np.linalg.solve(np.block([[H, G.T], [G, -np.diag(np.repeat(work.compliance, work.links))]]), -left_over)
        except np.linalg.LinAlgError:
            break
        step *= min(1.0, LARGEST_TURN / max(np.abs(step[3 : 6 - held]).max(), SMALL))
        full = np.zeros(work.size)
        full[free] = step[: len(free)]
        # The body's six coordinates come first, its rotation moved by a vector in the fixed frame
        pose = replace(
            pose,
            place=pose.place + full[:3],
            rotation=Rotation.from_rotvec(full[3:6]).as_matrix() @ pose.rotation,
            joints=pose.joints + full[6:].reshape(pose.joints.shape),
            tension=pose.tension + step[len(free) :].reshape(pose.tension.shape),
        )
    raise CheckFailed("the rope pendulum has no equilibrium there: statics did not converge", place=pose.place.tolist())


def _links(work: Ropework, pose: Pose) -> list[tuple[int, int, Array]]:
    """Number of the rope, of the link from the ceiling, and its vector downwards, for all links."""
    feet = feet_of(work, pose)
    chains = [np.vstack([work.anchors[i], pose.joints[i], feet[i]]) for i in range(work.ropes)]
    return [(i, k, chain[k + 1] - chain[k]) for i, chain in enumerate(chains) for k in range(work.links)]


def _joint(work: Ropework, rope: int, joint: int) -> slice:
    start = 6 + 3 * (rope * work.joints + joint)
    return slice(start, start + 3)
