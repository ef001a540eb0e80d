"""`Inertia`: the ten parameters of the paper's Eq. 4 about a reference point, and everything that may be done to them.

The parameters are the mass, the first moment and the tensor about the reference point A,

    m, m x, m y, m z, Ixx, Iyy, Izz, Ixy, Ixz, Iyz,

with products as *matrix entries*, Ixy = -integral(x y dm), so that the tensor is read straight from the vector. They are
additive: bodies that share a reference point add and subtract component by component, which is all that composition, tare and
"holes as negative bodies" need. A difference may therefore be unphysical on purpose, and construction does not forbid it;
`geometry.inertia` judges, and every door to the outside asks it.
"""

from collections.abc import Sequence
from dataclasses import dataclass, field
from enum import Enum

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import MOTIONS
from geometry.errors import BadInput
from geometry.frames import Array, Pose, freeze, frozen, proper_rotation, skew
from geometry.sensors import Channel, ChannelTable, motion_rows, resultants, summation

PARAMETERS = ("m", "mx", "my", "mz", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
"""Names of the ten parameters in the order of Eq. 4."""

UNITS = ("kg", *3 * ("kg m",), *6 * ("kg m²",))
"""Their units."""


def tensor_from_six(six: npt.ArrayLike) -> Array:
    """Symmetric (3, 3) tensor from the entries xx, yy, zz, xy, xz, yz."""
    xx, yy, zz, xy, xz, yz = np.asarray(six, dtype=np.float64)
    return np.array([[xx, xy, xz], [xy, yy, yz], [xz, yz, zz]])


def six_from_tensor(tensor: npt.ArrayLike) -> Array:
    """Entries xx, yy, zz, xy, xz, yz of a symmetric (3, 3) tensor, its two triangles averaged."""
    t = np.asarray(tensor, dtype=np.float64)
    t = (t + t.T) / 2
    return np.array([t[0, 0], t[1, 1], t[2, 2], t[0, 1], t[0, 2], t[1, 2]])


def parallel_axis(mass: float, offset: npt.ArrayLike) -> Array:
    """Tensor (3, 3) [kg m²] of a point mass at `offset` (3,) [m]: ``m (|r|² 1 - r r^T)``, Huygens-Steiner."""
    S = skew(offset)
    return mass * (S.T @ S)


@dataclass(frozen=True, eq=False, kw_only=True)
class Inertia:
    """Mass, first moment and tensor of a body about `reference_point`.

    Attributes
    ----------
    parameters : (10,), order and units of `PARAMETERS`, about the reference point, in the axes of the body's frame
    reference_point : (3,) [m], the point A in the body's frame; the frame's origin by default

    Source: paper Eqs. 1 and 4.
    """

    parameters: Array
    reference_point: Array = field(default_factory=lambda: np.zeros(3))

    def __post_init__(self) -> None:
        freeze(self, parameters=(10,), reference_point=(3,))

    # --- ways in -----------------------------------------------------------------------------------------------------

    @staticmethod
    def from_cog(
        mass: float, cog: npt.ArrayLike, tensor: npt.ArrayLike, reference_point: npt.ArrayLike = (0.0, 0.0, 0.0)
    ) -> "Inertia":
        """From mass [kg], CoG (3,) [m] in the body's frame and tensor (3, 3) [kg m²] *about the CoG*."""
        offset = np.asarray(cog, dtype=np.float64) - np.asarray(reference_point, dtype=np.float64)
        about_reference = np.asarray(tensor, dtype=np.float64) + parallel_axis(mass, offset)
        parameters = np.concatenate([[mass], mass * offset, six_from_tensor(about_reference)])
        return Inertia(parameters=parameters, reference_point=np.asarray(reference_point, dtype=np.float64))

    @staticmethod
    def from_mass_matrix(matrix: npt.ArrayLike, reference_point: npt.ArrayLike = (0.0, 0.0, 0.0)) -> "Inertia":
        """From the 6x6 mass matrix of Eq. 1 about `reference_point`.

        Raises
        ------
        ValueError : the matrix is not that of a rigid body (unequal masses, coupling not skew, unsymmetric), by more than
            the digits of a printed table, relative to its own largest entries.
        """
        M = frozen(matrix, (6, 6), "matrix")
        S = M[3:, :3]
        first_moment = np.array([S[2, 1], S[0, 2], S[1, 0]])
        parameters = np.concatenate([[M[0, 0]], first_moment, six_from_tensor(M[3:, 3:])])
        inertia = Inertia(parameters=parameters, reference_point=np.asarray(reference_point, dtype=np.float64))
        misfit = np.abs(inertia.mass_matrix - M).max()
        if misfit > 1e-5 * np.abs(M).max():
            raise ValueError(f"`matrix` must be the mass matrix of a rigid body, found an entry off by {misfit:.3g}")
        return inertia

    # --- what it is --------------------------------------------------------------------------------------------------

    @property
    def mass(self) -> float:
        """Mass [kg]."""
        return float(self.parameters[0])

    @property
    def first_moment(self) -> Array:
        """Mass times CoG (3,) [kg m], about the reference point."""
        return self.parameters[1:4]

    @property
    def tensor(self) -> Array:
        """Inertia tensor (3, 3) [kg m²] about the reference point, products as matrix entries."""
        return tensor_from_six(self.parameters[4:])

    @property
    def cog(self) -> Array:
        """Centre of gravity (3,) [m] in the body's frame (not from the reference point).

        Raises
        ------
        ValueError : the mass is zero, so that there is no CoG.
        """
        if self.mass == 0.0:
            raise ValueError("`mass` must not be zero to have a centre of gravity, found 0 kg")
        return self.reference_point + self.first_moment / self.mass

    @property
    def tensor_cog(self) -> Array:
        """Inertia tensor (3, 3) [kg m²] about the CoG, in the axes of the body's frame."""
        return self.tensor - parallel_axis(self.mass, self.cog - self.reference_point)

    @property
    def moments_cog(self) -> Array:
        """Moments of inertia xx, yy, zz (3,) [kg m²] about the CoG."""
        return six_from_tensor(self.tensor_cog)[:3]

    @property
    def products_cog(self) -> Array:
        """Products of inertia xy, xz, yz (3,) [kg m²] about the CoG, as matrix entries."""
        return six_from_tensor(self.tensor_cog)[3:]

    @property
    def mass_matrix(self) -> Array:
        """6x6 mass matrix of the paper's Eq. 1 about the reference point; order x, y, z, alpha, beta, gamma."""
        S = skew(self.first_moment)
        return np.block([[self.mass * np.eye(3), -S], [S, self.tensor]])

    @property
    def pseudo_inertia(self) -> Array:
        """4x4 pseudo-inertia ``[[Sigma, m c], [m c^T, m]]`` about the reference point, Sigma = tr(I)/2 1 - I.

        It is positive definite exactly when a positive density exists that has these ten parameters (Wensing, Kim and
        Slotine, arXiv:1701.04395).
        """
        I = self.tensor
        sigma = 0.5 * np.trace(I) * np.eye(3) - I
        h = self.first_moment[:, None]
        return np.block([[sigma, h], [h.T, np.array([[self.mass]])]])

    def principal(self) -> tuple[Array, Array]:
        """Principal moments (3,) [kg m²] about the CoG, ascending, and principal axes as columns (3, 3), right-handed."""
        moments, axes = np.linalg.eigh(self.tensor_cog)
        if np.linalg.det(axes) < 0:
            axes[:, 0] = -axes[:, 0]
        return moments, axes

    # --- what may be done to it --------------------------------------------------------------------------------------

    def about(self, point: npt.ArrayLike) -> "Inertia":
        """The same body about another reference point (3,) [m], in the same frame. Any mass, zero and negative included."""
        new = np.asarray(point, dtype=np.float64)
        d = self.reference_point - new
        h = self.first_moment
        first_moment = h + self.mass * d
        # Huygens-Steiner from A to A' without passing through the CoG, so that a massless difference moves too.
        coupling = 2 * np.dot(h, d) * np.eye(3) - np.outer(h, d) - np.outer(d, h)
        tensor = self.tensor + coupling + parallel_axis(self.mass, d)
        return Inertia(parameters=np.concatenate([[self.mass], first_moment, six_from_tensor(tensor)]), reference_point=new)

    def moved(self, displacement: npt.ArrayLike) -> "Inertia":
        """The body carried by `displacement` (3,) [m]; reported about the same point of the frame as before."""
        carried = Inertia(
            parameters=self.parameters, reference_point=self.reference_point + np.asarray(displacement, dtype=np.float64)
        )
        return carried.about(self.reference_point)

    def rotated(self, rotation: npt.ArrayLike) -> "Inertia":
        """The body turned by `rotation` (3, 3) about the frame's origin; the reference point stays where it was."""
        R = proper_rotation(rotation)
        parameters = np.concatenate([[self.mass], R @ self.first_moment, six_from_tensor(R @ self.tensor @ R.T)])
        return Inertia(parameters=parameters, reference_point=R @ self.reference_point).about(self.reference_point)

    def placed(self, pose: Pose) -> "Inertia":
        """The body, given in its own frame, seen in the outer frame of `pose`; about the outer frame's origin."""
        return self.about(np.zeros(3)).rotated(pose.rotation).moved(pose.position)

    def __add__(self, other: "Inertia") -> "Inertia":
        """Both bodies as one, about the reference point of the first."""
        other = other.about(self.reference_point)
        return Inertia(parameters=self.parameters + other.parameters, reference_point=self.reference_point)

    def __sub__(self, other: "Inertia") -> "Inertia":
        """What is left when `other` is taken off (tare), about the reference point of the first."""
        return self + -other

    def __neg__(self) -> "Inertia":
        """The body with its sign changed: a hole."""
        return Inertia(parameters=-self.parameters, reference_point=self.reference_point)

    def scaled(self, density_ratio: float) -> "Inertia":
        """The same shape with its density multiplied by `density_ratio`."""
        return Inertia(parameters=self.parameters * density_ratio, reference_point=self.reference_point)


# Can these ten numbers belong to a body? The judge that stands at every door.
#
# A positive density with the ten parameters exists exactly when the mass is positive and the pseudo-inertia is positive
# definite; seen from the CoG that is the triangle inequality on the *principal* moments (on the diagonal of a tensor with
# products it proves nothing). The boundary belongs to ideal bodies: a point mass (no moments), a rod (one moment zero), a lamina
# (largest moment the sum of the others) have no volume, yet engineers rightly use them as lumped masses. So they are accepted,
# named `IDEAL`, and refused only where a strictly positive definite matrix is needed (log-Cholesky coordinates).
#
# Rounding: moments about the CoG are what is left after the parallel-axis terms cancel, so the tolerance is relative to the
# largest tensor that the numbers have been through: about the reference point, and about the frame's origin, through which
# bodies are placed (another reference point does not bring the lost digits back). The moments themselves are no measure of it.

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
    shown = ", ".join(f"{moment if abs(moment) > zero else 0.0:.6g}" for moment in moments)
    if margin[0] < -zero:
        sentence = (
            f"principal moments {shown} kg m² break the triangle inequality by {-margin[0]:.3g} kg m² "
            "(the largest exceeds the sum of the others)"
        )
    elif margin[0] <= zero:
        sentence = f"principal moments {shown} kg m² lie on the boundary: a point mass, rod or lamina"
    else:
        sentence = f"principal moments {shown} kg m² satisfy the triangle inequality"
    return Consistency(kind=_kind(margin, zero), text=sentence, margin=margin, rounding=zero)


def require_physical(inertia: Inertia, source: str, rounding: float = ROUNDING) -> Inertia:
    """Pass `inertia` through unchanged.

    Raises
    ------
    BadInput : no body can have these parameters; `source` says where they came from.
    """
    verdict = judge(inertia, rounding)
    if not verdict.physical:
        remedy = "Check signs, units and the reference point (products are matrix entries, Ixy = -∫xy dm)"
        raise BadInput(source, "inertia", f"no body has these parameters: {verdict.text}", remedy)
    return inertia


def _kind(margin: Array, zero: float) -> Kind:
    if margin[0] < -zero:
        return Kind.UNPHYSICAL
    return Kind.BODY if margin[0] > zero else Kind.IDEAL


# Can the six base motions and the six resultants be told from the channels, how well, and what is missing by name?

LOADS = ("f_x", "f_y", "f_z", "t_x", "t_y", "t_z")
"""The six resultants, in the order of `MOTIONS`."""

LOST = 1e-6
"""Relative singular value below which nothing is observed: a lever arm of a micrometre, whatever was typed."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Observability:
    """The verdict on one set of channels.

    Attributes
    ----------
    channels : names of those that take part
    rank : how many of the six are told apart
    condition : largest over smallest singular value of the transformation [1], rotations or moments scaled by `lever`; infinite
        where the rank is below six
    lever : [m] root mean square distance of the places from the reference point, 1 where they all lie on it
    missing : names of what cannot be told, none when all six can
    text : the verdict in words
    """

    channels: tuple[str, ...]
    rank: int
    condition: float
    lever: float
    missing: tuple[str, ...]
    text: str

    @property
    def complete(self) -> bool:
        """Whether all six are observed."""
        return self.rank == 6


def of_motions(table: ChannelTable, groups: Sequence[str]) -> Observability:
    """The six motions of the reference point from the accelerometers of `groups`, taken for one rigid body (Eq. 7)."""
    channels = _chosen(table, groups, ("acceleration",))
    return _judged(channels, motion_rows(channels, table.origin), MOTIONS, _lever(table, channels), lost=())


def of_resultants(table: ChannelTable) -> Observability:
    """The six resultants about the reference point from the force and moment channels of the FMD.

    What a summation box adds up off one line of action is lost, too, and is named.
    """
    channels = _chosen(table, ("fmd",), ("force", "moment"))
    lever = _lever(table, channels)
    # Resultants that depend on how the cells of one channel share its reading
    if not channels:
        lost_in_sums: tuple[str, ...] = ()
    else:
        of = summation(channels, table.origin)
        scale = np.array([1, 1, 1, lever, lever, lever])
        left = np.abs(of.gives - resultants(channels, table.origin) @ of.adds).max(axis=1) / scale
        lost_in_sums = tuple(name for name, size in zip(LOADS, left, strict=True) if size > LOST)
    return _judged(channels, resultants(channels, table.origin).T, LOADS, lever, lost_in_sums)


def _chosen(table: ChannelTable, groups: Sequence[str], quantities: Sequence[str]) -> list[Channel]:
    return [table.channels[k] for k in table.select(group=tuple(groups), quantity=tuple(quantities))]


def _lever(table: ChannelTable, channels: Sequence[Channel]) -> float:
    places = [place.position - table.origin for channel in channels for place in channel.places]
    length = float(np.sqrt(np.mean(np.sum(np.square(places), axis=1)))) if places else 0.0
    return length or 1.0


def _judged(channels: Sequence[Channel], rows: Array, names: Sequence[str], lever: float, lost: tuple[str, ...]) -> Observability:
    scale = np.array([1, 1, 1, lever, lever, lever])
    _, singular, Vt = np.linalg.svd(np.vstack([rows / scale, np.zeros((6, 6))]), full_matrices=False)
    rank = int(np.sum(singular > LOST * max(float(singular[0]), np.finfo(np.float64).tiny)))
    null = Vt[rank:]
    share = np.linalg.norm(null, axis=0)
    missing = dict.fromkeys([*lost, *(name for name, part in zip(names, share, strict=True) if part > 1e-3)])
    rank -= len([name for name in lost if share[list(names).index(name)] <= 1e-3])
    condition = float(singular[0] / singular[-1]) if rank == 6 else float("inf")
    in_order = tuple(name for name in names if name in missing)
    directions = null / scale
    if rank == 6:
        words = f"all six are told apart, condition {condition:.3g}"
    else:
        summed = f"; a sum of cells that do not lie on one line of action hides {', '.join(lost)}" if lost else ""
        mixed = len(directions) < len([name for name in in_order if name not in lost])
        combined = f" ({combination(directions[0], names)} is seen by no channel)" if mixed and len(directions) == 1 else ""
        words = f"only {rank} of six are told apart: {', '.join(in_order)} cannot be told{combined}{summed}"
    return Observability(
        channels=tuple(channel.name for channel in channels),
        rank=rank,
        condition=condition,
        lever=lever,
        missing=in_order,
        text=words,
    )


def combination(vector: Array, names: Sequence[str]) -> str:
    """The sum that `vector` makes of `names` in words, the largest share 1 in size and the first one positive."""
    largest = float(np.abs(vector).max())
    parts = [(value / largest, name) for value, name in zip(vector, names, strict=True) if abs(value) > 1e-3 * largest]
    sign = -1 if parts[0][0] < 0 else 1
    return " + ".join(f"{sign * value:.2g} {name}" for value, name in parts).replace("+ -", "- ")
