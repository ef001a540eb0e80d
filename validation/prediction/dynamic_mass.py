"""From reduced matrices to what is measured: the dynamic mass of a moving base, the accelerances of a held structure.

With D = M - (K + i (omega C + S)) / omega², the dynamic stiffness over -omega², b the base and q the rest, the answer to unit
accelerations of the base is T = [1; -D_qq^-1 D_qb] and

    H = T^T D T = D_bb - D_bq D_qq^-1 D_qb,                  dH = T^T dD T,

because H is stationary in the answer (Fox & Kapoor, AIAA Journal 6, 1968, for eigenvalues): a derivative costs two thin products,
and none of the solution itself. Likewise an accelerance A = phi_r^T D^-1 phi_d, with dA = -(D^-1 phi_r)^T dD (D^-1 phi_d).
"""

from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import cached_property
from typing import Any

import numpy as np
import numpy.typing as npt

from geometry.dynamic_mass import MOTIONS, ComplexArray
from geometry.frames import Array, Integers, Pose, freeze, left_jacobian, rigid_transformation_6, rotation_by, skew
from geometry.inertia import PARAMETERS, UNITS, Inertia
from identification.campaign import Campaign, Excitation, Processing
from identification.rigid_body import BASIS
from validation.effects.stages import Matrices, MountedDynamicMass
from validation.estimation.problem import IDENTIFIED, Offsets, Parameter, Wanted, is_wanted
from validation.model.model import Added
from validation.model.tolerance_classes import MountingTolerances
from validation.prediction import effects as prediction_effects
from validation.prediction import tangents as of_matrices
from validation.prediction.effects import Nuisances
from validation.prediction.mounting import MountedArticle
from validation.prediction.tangents import FIELDS, LOSS_COUPLING, CondensedTransfer, Tangent, full, transfer_tangents, turning

ENTRIES = 1 << 17
"""[count] of entries of the matrices of as many lines as are solved at once: 2 MB, which stay in a cache."""


@dataclass(frozen=True, eq=False, kw_only=True)
class AttachedResponse:
    """What a mass at places, which moves with them along one axis alone, changes of what is read, to first order.

    Attributes
    ----------
    readings : (r, m, c, q, 3) by run, line, channel, place and axis, per kilogram
    spring : (r, m) factor that makes of it what a spring to the ground does along the axis, per N/m: -1 / omega²
    """

    readings: ComplexArray
    spring: ComplexArray


Finite = Callable[[Array], Callable[[Array, Array], ComplexArray]]
"""``at(row)(mass, spring)``: what is read (r, m, c, 1) with a mass [kg] and a spring to the ground [N/m] along each axis, (3,)
both, at a place that coordinates move by `row` (3, k)."""


def dynamic_mass(matrices: Matrices, frequency: npt.ArrayLike, rows: Array | None = None) -> CondensedTransfer:
    """Blocked dynamic mass (n, 6, 6) about the article's origin at `frequency` (n,) [Hz], above zero.

    With `rows` (p, k) of what each coordinate moves places, derivatives are those of their accelerations, too, behind its own.

    Raises
    ------
    numpy.linalg.LinAlgError : a line lies on an undamped mode.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    b, k, omega = matrices.base, len(matrices.mass), 2 * np.pi * lines
    loads = np.zeros((k, 0)) if rows is None else rows.T
    far, follow, beside = far_coordinates(matrices, omega, loads)
    near = np.delete(np.arange(k), far)
    D = dynamic_matrix(matrices, omega, near)
    if len(far):
        D = D[:, :, near] + D[:, :, far] @ follow
    pulled = np.broadcast_to(loads[near], (len(lines), *loads[near].shape)) + follow.swapaxes(1, 2) @ loads[far]
    moved = np.zeros((len(lines), len(near), b + loads.shape[1]), dtype=np.complex128)
    moved[:, :b, :b] = np.eye(b)
    moved[:, b:] = np.linalg.solve(D[:, b:, b:], np.concatenate([-D[:, b:, :b], pulled[:, b:]], axis=2))
    T = np.empty((k, len(lines), moved.shape[2]), dtype=np.complex128)
    T[near], T[far] = moved.transpose(1, 0, 2), (follow @ moved).transpose(1, 0, 2)
    T[far, :, b:] += beside.transpose(1, 0, 2)
    right = np.ascontiguousarray(T[:, :, :b])
    left = right if rows is None else np.concatenate([right, -T[:, :, b:]], axis=2)
    return CondensedTransfer(frequency=lines, matrix=D[:, :b] @ moved[:, :, :b], left=left, right=right, sign=1.0)


FAR = 2.0
"""[1] times the highest line above which a coordinate has no resonance near the band. Held by test_matrices.py."""

NODES = 16
"""[count] of frequencies at which far coordinates are solved: a resonance at `FAR` times the end of a band from zero leaves
5.8^-16, 6e-13, of an answer. By that bound, and held by test_matrices.py."""

AGREES = 1e-11
"""[share] of the largest answer to which the polynomials agree at the end of the band that is nearest to the poles; where they do
not, all coordinates are solved at every line. Held by test_matrices.py."""


def far_coordinates(
    matrices: Matrices, at: npt.NDArray[Any], loads: Array | None = None
) -> tuple[Integers, ComplexArray, ComplexArray]:
    """(f,) coordinates that follow the others without a resonance near the band, (n, f, k - f) how at s / i (n,) [rad/s], and
    (n, f, p) how they answer to `loads` (k, p) where the others are held.

    Held by all others they are analytic in omega, -D_ff^-1 D_fr, but for their resonances far above: polynomials through
    Chebyshev's points converge as fast as those lie beyond the band (L. N. Trefethen, Approximation Theory and Approximation
    Practice, 2013, theorem 8.2). None where few lines are asked, of different axes, or where the polynomials do not agree.
    """
    b, k, last = matrices.base, len(matrices.mass), int(np.argmax(at.real))
    loads = np.zeros((k, 0)) if loads is None else loads
    far = b + np.flatnonzero(np.diag(matrices.stiffness)[b:] > (FAR * at[last].real) ** 2 * np.diag(matrices.mass)[b:])
    none = far[:0], np.zeros((len(at), 0, k), dtype=np.complex128), np.zeros((len(at), 0, loads.shape[1]), dtype=np.complex128)
    if len(at) < 3 * NODES or not len(far) or not np.ptp(at.real) or np.ptp(at.imag):
        return none
    nodes, share = _chebyshev(at)
    D, r = dynamic_matrix(matrices, np.append(nodes, at[last]), far), k - len(far)
    pulled = np.broadcast_to(loads[far], (len(D), len(far), loads.shape[1]))
    solved = np.linalg.solve(D[:, :, far], np.concatenate([-D[:, :, np.delete(np.arange(k), far)], pulled], axis=2))
    found = (share @ solved[:-1].reshape(NODES, -1).view(np.float64)).view(np.complex128).reshape(len(at), *solved.shape[1:])
    if np.abs(found[last] - solved[-1]).max(initial=0.0) > AGREES * np.abs(solved).max(initial=0.0):
        return none
    return far, found[:, :, :r], found[:, :, r:]


def _chebyshev(at: npt.NDArray[Any]) -> tuple[npt.NDArray[Any], Array]:
    """Chebyshev's points (`NODES`,) of the band of `at` (n,), and (n, `NODES`) what a polynomial makes of values there."""
    low, width, order = at.real.min(), np.ptp(at.real) or 1.0, np.arange(NODES)
    angle = np.pi * (order + 0.5) / NODES
    chebyshev = np.polynomial.chebyshev.chebvander(2 * (at.real - low) / width - 1, NODES - 1)
    share = chebyshev @ (np.where(order > 0, 2.0, 1.0)[:, None] * np.cos(np.outer(order, angle)) / NODES)
    return low + width / 2 * (1 + np.cos(angle)) + (1j * at[0].imag if at[0].imag else 0.0), share


def answering(matrices: Matrices, at: npt.NDArray[Any]) -> Callable[[Array], ComplexArray]:
    """``of(row)``: what all coordinates beside a base held still answer (n, k - b, a) at s / i (n,) [rad/s] to a force along each
    of `row` (a, j), which is nothing behind j. What belongs to `far_coordinates` alone is solved at few frequencies."""
    b, k = matrices.base, len(matrices.mass)
    far, follow, _ = far_coordinates(matrices, at)
    near, follow = np.delete(np.arange(b, k), far - b), follow[:, :, b:]
    D, (nodes, share) = dynamic_matrix(matrices, at, near), _chebyshev(at)
    inner = np.linalg.inv(D[:, :, near] + D[:, :, far] @ follow)
    beside = np.linalg.inv(dynamic_matrix(matrices, nodes, far)[:, :, far])

    def of(row: Array) -> ComplexArray:
        row = np.pad(row, ((0, 0), (0, k - b - row.shape[1])))
        answer = np.empty((len(at), k - b, len(row)), dtype=np.complex128)
        answer[:, near - b] = inner @ (row[:, near - b] + row[:, far - b] @ follow).swapaxes(1, 2)
        answer[:, far - b] = follow @ answer[:, near - b] + np.tensordot(share, beside @ row[:, far - b].T, axes=1)
        return answer

    return of


def accelerance(
    matrices: Matrices,
    frequency: npt.ArrayLike,
    responses: npt.ArrayLike,
    drive: npt.ArrayLike,
    *,
    decay_rate: float | Array = 0.0,
) -> CondensedTransfer:
    """Accelerations (n, r, d) [m/s² per N] of a held structure along `responses` for forces along `drive`.

    Parameters
    ----------
    frequency : (n,) [Hz], above zero
    responses, drive : (r, k), (d, k) what each coordinate moves along them, see `along`
    decay_rate : [1/s] of force and response that are windowed by exp(-decay_rate t), or (n,) of each line

    Raises
    ------
    numpy.linalg.LinAlgError : a line lies on an undamped mode.
    """
    lines = np.atleast_1d(np.asarray(frequency, dtype=np.float64))
    rows, forces = np.atleast_2d(np.asarray(responses, dtype=np.float64)), np.atleast_2d(np.asarray(drive, dtype=np.float64))
    loads = np.vstack([rows, forces]).T.astype(np.complex128)
    at, few = turning(lines, decay_rate), max(ENTRIES // max(loads.shape[0], 1) ** 2, 1)
    both = np.empty((len(lines), *loads.shape), dtype=np.complex128)
    for first in range(0, len(lines), few):
        some = slice(first, first + few)
        both[some] = np.linalg.solve(dynamic_matrix(matrices, at[some]), np.broadcast_to(loads, both[some].shape))
    left, right = (np.ascontiguousarray(side.transpose(1, 0, 2)) for side in np.split(both, [len(rows)], axis=2))
    return CondensedTransfer(
        frequency=lines,
        matrix=np.asarray(rows @ both[:, :, len(rows) :], dtype=np.complex128),
        left=left,
        right=right,
        sign=-1.0,
        decay_rate=decay_rate,
    )


SAMPLED = 9
"""[count] of lines over the band at which all coordinates are solved, at half to check the others. Held by test_matrices.py."""

SPANNED = 1e-4
"""[share] of the largest answer to a load at a line to which those between agree; what is read is stationary in them and agrees
to its square. Held by test_matrices.py."""

LEAST = (1e-4, 1e-5, 1e-6, 1e-7, 1e-8)
"""[share] of the largest direction below which one is left out: the first of these at which they agree. A decade is a half more
directions; the last is rounding."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Condensed:
    """A structure on fewer coordinates, by which it answers some loads over a band as it does on all of them.

    Its modes in and near the band as it stands are kept. What the loads, and what the losses of these modes, make of it beside
    them is smooth over the band, whatever resounds in it: at a few lines it shows all directions in which it ever moves (E. J.
    Grimme, Krylov projection methods for model reduction, 1997), and lines between are held against the whole structure.

    Attributes
    ----------
    matrices : of which the fields are condensed, and nothing else
    directions : (k, w) what each of the fewer coordinates moves
    """

    matrices: Matrices
    directions: Array

    @classmethod
    def of(cls, matrices: Matrices, at: npt.NDArray[Any], loads: Array) -> "Condensed | None":
        """Of `loads` (k, p) at s / i (n,) [rad/s]; None where they do not agree with `matrices`, or where nothing is saved.

        Raises
        ------
        numpy.linalg.LinAlgError : a line lies on an undamped mode.
        """
        k, p = loads.shape
        if len(at) < 2 * SAMPLED or (near := _modes_near(matrices, np.abs(at))) is None:
            return None
        shapes, back = near
        # Lines that crowd at the ends, as those between which polynomials agree best
        some = np.unique(np.round((len(at) - 1) * (1 - np.cos(np.pi * np.arange(SAMPLED) / (SAMPLED - 1))) / 2).astype(np.int64))
        D, turn = dynamic_matrix(matrices, at[some]), np.abs(at[some, None, None])
        M, K, C, S = (getattr(matrices, name) @ shapes for name in FIELDS)
        answers = np.linalg.solve(D, np.concatenate([np.broadcast_to(loads, (len(some), k, p)), C / turn + S / turn**2], axis=2))
        # Each load as large as any other: where one drives what is soft, what is stiff answers next to nothing beside it
        loads = loads / (alike := np.where(loads.any(axis=0), np.abs(answers[:, :, :p]).max(axis=(0, 1)), 1.0))
        # What the losses of modes that resound make of the others is as large as they resound for these loads
        M, K, C, S = (np.einsum("kr,kr->r", shapes, one) for one in (M, K, C, S))
        own = np.abs(M - (K + 1j * (at[:, None] * C + S)) / at[:, None] ** 2).min(axis=0)
        size = np.divide(np.abs(loads.T @ shapes).max(axis=0, initial=0.0), own, out=np.zeros(len(own)), where=own > 0)
        answers *= np.append(1 / alike, size)
        seen = answers[::2].view(np.float64)  # real and imaginary parts beside each other
        beside = np.hstack(list(seen - shapes @ (back @ seen)))
        squares, axes = np.linalg.eigh(beside @ beside.T)
        large, m, due = np.sqrt(np.maximum(squares[::-1], 0.0)), shapes.shape[1], answers[1::2, :, :p]
        every = np.hstack([shapes, axes[:, ::-1][:, large > LEAST[-1] * large[0]]])
        M, K, C, S = (every.T @ getattr(matrices, name) @ every for name in FIELDS)
        own = dynamic_matrix(Matrices(base=0, mass=M, stiffness=K, viscous=C, structural=S), at[some[1::2]])
        for least in LEAST:
            w = m + np.count_nonzero(large > least * large[0])
            if w > k * of_matrices.WORTH_CONDENSING:
                return None
            told = every[:, :w] @ np.linalg.solve(own[:, :w, :w], every[:, :w].T @ loads)
            if np.all(np.abs(told - due).max(axis=1) <= SPANNED * np.abs(due).max(axis=1)):
                fields = dict(zip(FIELDS, (one[:w, :w] for one in (M, K, C, S)), strict=True))
                return cls(matrices=Matrices(base=0, **fields), directions=every[:, :w])
        return None

    def of_rows(self, rows: Array) -> Array:
        """`rows` (..., k) of what each coordinate moves."""
        return rows @ self.directions

    def tangents(self, answered: CondensedTransfer, changes: Mapping[str, Tangent]) -> dict[str, ComplexArray]:
        """By parameter d matrix / d offset, (n, r, d), of what was `answered` on the fewer coordinates; these are held: answers,
        which lie in them, say no more."""
        W, sides = self.directions, (answered.left, answered.right)
        left, right = (np.tensordot(W, np.ascontiguousarray(one).view(np.float64), axes=1).view(np.complex128) for one in sides)
        return transfer_tangents(replace(answered, left=left, right=right), changes, [(W, one) for one in sides])


def _modes_near(matrices: Matrices, omega: Array) -> tuple[Array, Array] | None:
    """(k, m) shapes of the undamped modes below `FAR` times the highest `omega` [rad/s], and (m, k) how much of each is in a
    motion; None where the stiffness is not that of anything that stands or floats."""
    from scipy.linalg import eigh

    high = float(omega.max()) ** 2
    both = matrices.stiffness + high * matrices.mass
    try:  # 1 / (omega_r² + high), of a structure of which some coordinates may have no mass
        _, shapes = eigh(matrices.mass, both, subset_by_value=(1 / ((1 + FAR**2) * high), np.inf), check_finite=False)
    except np.linalg.LinAlgError:
        return None
    return shapes, shapes.T @ both


def dynamic_matrix(matrices: Matrices, at: npt.NDArray[Any], rows: slice | Integers = slice(None)) -> ComplexArray:
    """D (n, k, k) at s / i (n,) [rad/s], or these `rows` of it."""
    share = np.stack([np.ones_like(at), -1 / at**2, -1j / at, -1j / at**2], axis=1)
    fields = np.stack([getattr(matrices, name)[rows] for name in FIELDS])
    return np.asarray(share @ fields.reshape(4, -1), dtype=np.complex128).reshape(len(at), *fields.shape[1:])


# How strongly a run was driven, for what depends on it: friction, gaps, saturation, and how fast a sweep passed.


@dataclass(frozen=True, eq=False, kw_only=True)
class BaseDrive:
    """What one run did to the base.

    Attributes
    ----------
    amplitude : (6,) [m/s², rad/s²] of its motion, zeros where it is not stated
    nominal : (6,) the same of the strongest run along the same axes, the one driven at nominal level
    sweep_rate : [octaves/s], 0 where it is not stated
    block : [s] of the blocks of peak-reference-hold, 0 for other spectra
    """

    amplitude: Array = field(default_factory=lambda: np.zeros(6))
    nominal: Array = field(default_factory=lambda: np.zeros(6))
    sweep_rate: float = 0.0
    block: float = 0.0

    def __post_init__(self) -> None:
        freeze(self, amplitude=(6,), nominal=(6,))


def drives(campaign: Campaign, method: str) -> dict[str, BaseDrive]:
    """By name of the run; `method` by which its spectra were made."""
    amplitudes = {
        run.name: np.zeros(6) if run.excitation is None else _amplitude(run.excitation, run.axis) for run in campaign.runs
    }
    found = {}
    for run in campaign.runs:
        own, recorded = amplitudes[run.name], campaign.recordings.get(run.name)
        alike = [other for other in amplitudes.values() if np.array_equal(other > 0, own > 0)]
        rate = recorded.sampling_rate if recorded is not None and method == "peak-reference-hold" else None
        found[run.name] = BaseDrive(
            amplitude=own,
            nominal=max(alike, key=lambda other: float(np.linalg.norm(other))),
            sweep_rate=(run.excitation.figure("octaves_per_minute") or 0.0) / 60 if run.excitation else 0.0,
            block=(campaign.processing or Processing()).block_size / rate if rate else 0.0,
        )
    return found


def _amplitude(excitation: Excitation, axis: str) -> Array:
    """Of a sine; the level of a noise is no amplitude."""
    levels, level = excitation.figures.get("levels"), excitation.figure("level")
    if isinstance(levels, tuple):
        return np.array(levels, dtype=np.float64)
    if excitation.kind != "sine-sweep" or level is None or axis not in MOTIONS:
        return np.zeros(6)
    return np.asarray(level * np.eye(6)[MOTIONS.index(axis)])


# The FMD's moving part as parameters: ten of them about F, known beforehand to a share.
#
# A share of an inertia means the same for all ten when it is that of the pseudo-inertia P (4x4), whose diagonal holds the mass
# and the three second moments: the standard deviation of an entry P_ij is the share times sqrt(P_ii P_jj), so that a mass known
# to 5 % goes with a centre of gravity known to 5 % of the radius of gyration.
#
# The moving part is nearly a plate: its second moment across the plane is a small difference of moments that are known to 5 % of
# their own. So a fit may pass through what no density has (P not definite); only a mass matrix that does not resist is refused.
# No fit goes `FARTHEST` beyond what is known beforehand: an FMD that swallows a grave fault would end as no body at all.

FMD = "fmd"

NAMES = tuple(f"{FMD}:{one}" for one in PARAMETERS)
"""Of the ten parameters."""

FARTHEST = 5.0
"""Standard deviations."""


def parameters(nominal: Inertia, tolerance: float) -> tuple[Parameter, ...]:
    """The ten, of a moving part that is `nominal` about F within `tolerance`."""
    ten = zip(NAMES, UNITS, nominal.parameters.tolist(), (tolerance * scales(nominal)).tolist(), strict=True)
    return tuple(
        Parameter(name=name, unit=unit, tolerance=sd, kind=IDENTIFIED, nominal=value, low=-FARTHEST * sd, high=FARTHEST * sd)
        for name, unit, value, sd in ten
    )


def scales(nominal: Inertia) -> Array:
    """(10,) of each parameter: what a share of it is a share of."""
    m, xx, yy, zz = (nominal.pseudo_inertia[k, k] for k in (3, 0, 1, 2))
    first = np.sqrt(m * np.array([xx, yy, zz]))
    moments = np.hypot.reduce(np.array([[yy, zz, 0.0], [xx, zz, 0.0], [xx, yy, 0.0]]), axis=1)
    return np.concatenate([[m], first, moments, np.sqrt([xx * yy, xx * zz, yy * zz])])


def at(nominal: Inertia, offsets: Offsets) -> Inertia:
    """The moving part at `offsets`, about F.

    Raises
    ------
    numpy.linalg.LinAlgError : its mass matrix is not positive definite; a fit then steps back.
    """
    ten = nominal.parameters + np.array([offsets.get(name, 0.0) for name in NAMES])
    made = Inertia(parameters=ten)
    np.linalg.cholesky(made.mass_matrix)
    return made


# How, and as what, an article stands on the cover plate: mounted anew in every campaign, the same body in all of them.
#
# With d and phi by which it stands beside its place and turned, seen along the axes of F, and dp what its ten parameters about
# its centre of gravity are beside those of the drawing (density, bolts and holes that are not drawn),
#
#     H_F = X^T (H + sum of dp_k E_k) X,        X = diag(Q^T, Q^T) T(seat + d),        Q = exp(phi x)
#
# (paper Eq. 3; J. Wittenburg, Dynamics of Multibody Systems, 2008, section 3.1). H is symmetric: dH = dX^T H X + its transpose.

MOUNTING, ARTICLE = "mounting", "article"
"""Families: ``mounting:campaign:x`` [m], ``mounting:campaign:gamma`` [rad], and ``article:disc+cuboid:m`` [kg] and so on."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Seated:
    """Where an article stands, and what it has beside the drawing.

    Attributes
    ----------
    transformation : (6, 6) X
    more : (6, 6) mass matrix about its origin, in the axes of F
    """

    transformation: Array
    more: Array

    @staticmethod
    def parameters(campaign: str, stands: MountedArticle, known: MountingTolerances) -> tuple[Parameter, ...]:
        """Of what stands in `campaign`; a tolerance of 0 closes a parameter, and an FMD alone has none."""
        if stands.matrices is None:
            return ()
        sizes = (known.place, known.place, known.height, known.tilt, known.tilt, known.turn)
        units = ("m",) * 3 + ("rad",) * 3
        made = [
            Parameter(name=f"{MOUNTING}:{campaign}:{axis}", unit=unit, tolerance=size, low=-FARTHEST * size, high=FARTHEST * size)
            for axis, unit, size in zip(MOTIONS, units, sizes, strict=True)
        ]
        about_origin, *_ = np.linalg.lstsq(BASIS.reshape(10, 36).T, stands.matrices.mass[:6, :6].ravel(), rcond=None)
        drawn = Inertia(parameters=about_origin).about(stands.matrices.cog)
        ten = zip(PARAMETERS, UNITS, (known.inertia * scales(drawn)).tolist(), strict=True)
        made += [Parameter(name=f"{ARTICLE}:{stands.article}:{name}", unit=unit, tolerance=sd) for name, unit, sd in ten]
        return tuple(one for one in made if one.tolerance > 0)


# The dynamic mass of all that the load cells carry, about F: the article with its effects, mounted, and the FMD beside it.

Tangents = dict[str, ComplexArray]
"""By parameter, d dynamic mass / d offset (n, 6, 6)."""

Aimed = Mapping[str, Array]
"""By accelerometer on the article the unit vector (3,) along which it reads, in the axes of F."""

NONE: Aimed = of_matrices.NONE


@dataclass(frozen=True, eq=False, kw_only=True)
class SupportedDynamicMass:
    """What the cells carry, before anything is measured.

    Attributes
    ----------
    standing : on the cover plate
    moving : the FMD's moving part beforehand, about F
    exact : whether it is known exactly
    nuisances : what is not known of the structure; None where nothing stands there
    mounted : what is not known of how and as what the article stands there
    """

    standing: MountedArticle
    moving: Inertia
    exact: bool
    nuisances: Nuisances | None
    mounted: tuple[Parameter, ...] = ()

    def solved(
        self, offsets: Offsets, effects: Sequence[Added], frequency: Array, *, derivatives: Wanted, sensors: Aimed = NONE
    ) -> "SolvedStructure | None":
        """What stands there at `frequency` (n,) [Hz], effects on it applied, and what `sensors` read; None where nothing does.

        Raises
        ------
        numpy.linalg.LinAlgError, ValueError : no such body, or a line on an undamped mode.
        """
        if self.nuisances is None:
            return None
        matrices, tangents = structure(self.nuisances, offsets, effects, derivatives=derivatives)
        rows = _along(sensors, self._bending(matrices, sensors, offsets, False)[0]) if sensors and tangents else None
        return SolvedStructure(matrices=matrices, tangents=tangents, answered=dynamic_mass(matrices, frequency, rows))

    def at(
        self,
        offsets: Offsets,
        effects: Sequence[Added],
        frequency: Array,
        drive: BaseDrive,
        *,
        derivatives: Wanted,
        solved: "SolvedStructure | None" = None,
        sensors: Aimed = NONE,
    ) -> tuple[ComplexArray, Tangents]:
        """Dynamic mass about F, behind it the accelerations at `sensors` along the axes of F beyond those of a rigid article,
        (n, 6 + 3 a, 6); how it and what they read, (n, 6 + a, 6), answer to the parameters of which `derivatives` are wanted.
        `solved` is what `SupportedDynamicMass.solved` says of the same, where it was asked already; raises what that raises.
        """
        n, found = len(frequency), Tangents()
        H = np.zeros((n, 6 + 3 * len(sensors), 6), dtype=np.complex128)
        H[:, :6] = at(self.moving, offsets).mass_matrix

        def change(loads: npt.NDArray[Any], read: npt.NDArray[Any] | float = 0.0) -> ComplexArray:
            whole = np.zeros((n, 6 + len(sensors), 6), dtype=np.complex128)
            whole[:, :6], whole[:, 6:] = loads, read
            return whole

        if derivatives and not self.exact:
            found = {name: change(E) for name, E in zip(NAMES, BASIS, strict=True) if is_wanted(name, derivatives)}
        solved = solved or self.solved(offsets, effects, frequency, derivatives=derivatives, sensors=sensors)
        if solved is None:
            return H, found
        mounted, changes = self._mounted(solved, effects, drive, derivatives=derivatives)
        seated, told = self._seated(mounted, offsets)
        T, article, moved = seated.transformation, mounted.matrix + seated.more, solved.answered.right.transpose(1, 0, 2)
        bent, beside = self._bending(solved.matrices, sensors, offsets, derivatives)
        turn, read = _turned(self.standing.pose).T, bent @ moved
        for name, one in changes.items():
            of = solved.changes.get(name)
            found[name] = change(T.T @ one @ T, 0.0 if of is None else of[:, 6:] @ turn @ T)
        for name, (turned, more) in told.items():
            if is_wanted(name, derivatives):
                half = turned.T @ article @ T
                found[name] = change(half + half.swapaxes(1, 2) + T.T @ more @ T, _along(sensors, read @ turn @ turned))
        for name, (k, rows) in beside.items():
            found[name] = change(np.zeros((6, 6)))
            found[name][:, 6 + k] = [*sensors.values()][k] @ rows @ moved @ turn @ T
        H[:, :6] += T.T @ article @ T
        H[:, 6:] = read @ turn @ T
        return H, found

    def attached(
        self,
        solved: "SolvedStructure",
        offsets: Offsets,
        effects: Sequence[Added],
        drive: BaseDrive,
        sensors: Sequence[str],
        rows: Array,
        through: ComplexArray,
        inputs: ComplexArray,
    ) -> ComplexArray:
        """(r, n, c, p) what channels read more, to first order, of each kilogram that moves as `rows` (p, k) of the coordinates.

        Parameters
        ----------
        solved, offsets, effects, drive, sensors : as `at` and `sensed` have them
        through : (n, c, 6 + 3 a) what channels read of the loads about F, and of the bending at the accelerometers
        inputs : (r, n, 6) motions of F
        """
        drawn, right = self._mounted(replace(solved, tangents={}), (), drive, derivatives=False)[0], solved.answered.right
        X = self._seated(drawn, offsets)[0].transformation
        moved = np.tensordot(rows, right[: rows.shape[1]], axes=1) @ _turned(self.standing.pose).T  # (p, n, 6)
        loads, bent = through[:, :, :6] @ X.T, through[:, :, 6:]
        # Whatever effects between base and article make of each entry of its dynamic mass, as large as that is at the line
        size = np.abs(drawn.matrix).max(axis=(1, 2))
        units = np.eye(36).reshape(36, 1, 6, 6) * size[:, None, None].astype(np.complex128)
        passed = prediction_effects.body(drawn, {str(k): one for k, one in enumerate(units)}, effects, derivatives=False)[1]
        if any(passed[str(k)] is not one for k, one in enumerate(units)):
            both = np.einsum("pni,pnj->nijp", moved, moved).reshape(len(through), 36, -1) / size[:, None, None]
            read = np.einsum("nci,knij,rnj->rnck", loads, np.stack([*passed.values()]), inputs @ X.T, optimize=True)
            found = read @ both
        else:
            found = (loads @ moved.transpose(1, 2, 0)) * np.einsum("pnj,rnj->rnp", moved, inputs @ X.T, optimize=True)[:, :, None]
        if sensors:
            own = rows[:, solved.matrices.base :]
            bending = self._bending(solved.matrices, sensors, offsets, False)[0][:, solved.matrices.base :]
            back = answering(solved.matrices, solved.answered.omega)(bending)[:, : own.shape[1]]
            driven = np.einsum("pnj,rnj->rnp", moved, inputs @ X.T, optimize=True)
            found = found - (bent @ (own @ back).swapaxes(1, 2)) * driven[:, :, None]
        return np.asarray(found, dtype=np.complex128)

    def loaded(self, solved: "SolvedStructure") -> Callable[[Array], Callable[[Array, Array], "SolvedStructure"]]:
        """``at(row)(mass, spring)``: what is `solved` with a mass [kg] and a spring to the ground [N/m] along each axis, (3,)
        both, at a place that coordinates move by `row` (3, k)."""
        answered, b = solved.answered, solved.matrices.base
        of_rows = answering(solved.matrices, answered.omega)

        def at(row: Array) -> Callable[[Array, Array], SolvedStructure]:
            own = row[:, b:]
            gives = of_rows(own)
            there = own @ gives[:, : own.shape[1]]
            moved = np.tensordot(row, answered.right[: row.shape[1]], axes=1).swapaxes(0, 1)

            def read(mass: Array, spring: Array) -> SolvedStructure:
                axes = np.flatnonzero((mass != 0) | (spring != 0))
                added = mass[axes] - spring[axes] / answered.omega[:, None] ** 2
                pull = np.linalg.solve(there[:, axes[:, None], axes] + np.eye(len(axes)) / added[:, None, :], moved[:, axes])
                right = np.array(answered.right)
                right[b:] -= (gives[:, :, axes] @ pull).swapaxes(0, 1)
                matrix = answered.matrix + moved[:, axes].swapaxes(1, 2) @ pull
                return replace(solved, tangents={}, answered=replace(answered, matrix=matrix, left=right, right=right))

            return read

        return at

    def moved(self, offsets: Offsets, effects: Sequence[Added], frequency: Array) -> dict[str, tuple[ComplexArray, ComplexArray]]:
        """By place of the article (n, 3, 6) its accelerations along the axes of F for a unit of every motion of F; and the same
        beyond those of a rigid article. Raises what `solved` raises."""
        if (solved := self.solved(offsets, effects, frequency, derivatives=False)) is None:
            return {}
        answer, turn, b = solved.answered.right.transpose(1, 0, 2), self.standing.pose.rotation, solved.matrices.base
        back = _turned(self.standing.pose).T @ rigid_transformation_6(self.standing.pose.position)
        return {
            name: (turn @ rows @ answer @ back, turn @ rows[:, b:] @ answer[:, b:] @ back)
            for name, rows in solved.matrices.places.items()
        }

    def _bending(
        self, of: Matrices, sensors: Iterable[str], offsets: Offsets, derivatives: Wanted
    ) -> tuple[Array, dict[str, tuple[int, Array]]]:
        """(3 a, k) what each coordinate but those of the base moves the accelerometers along the axes of F, where they sit at
        `offsets`; and by wanted parameter of their position which of them it moves by what (3, k), where the model knows it."""
        R, its_own, bent = self.standing.pose.rotation, np.arange(len(of.mass)) >= of.base, []
        beside: dict[str, tuple[int, Array]] = {}
        for k, (name, place) in enumerate((one, self.standing.sensors[one]) for one in sensors):
            rows, which = of.places[place], [f"accelerometer-position:{name}:{axis}" for axis in "xyz"]
            by, told = R.T @ [offsets.get(one, 0.0) for one in which], [is_wanted(one, derivatives) for one in which]
            if place in of.gradients and (any(told) or by.any()):
                moved, slopes = np.array([of.gradients[place].shifted(*one) for one in enumerate(by)]).swapaxes(0, 1)
                rows = rows + moved.sum(axis=0)
                beside |= {which[i]: (k, R @ np.tensordot(R[i], slopes, axes=1) * its_own) for i in np.flatnonzero(told)}
            bent.append(R @ rows * its_own)
        return np.vstack([np.zeros((0, len(of.mass))), *bent]), beside

    def _seated(self, of: MountedDynamicMass, offsets: Offsets) -> tuple[Seated, dict[str, tuple[Array, Array]]]:
        """How the article of `of` stands at `offsets`, and by parameter d X and d (sum of dp_k E_k), (6, 6) each."""
        if not self.mounted:
            return Seated(transformation=rigid_transformation_6(of.seat), more=np.zeros((6, 6))), {}
        beside, turn, more = np.zeros(3), np.zeros(3), np.zeros((6, 6))
        to_cog, still, told = rigid_transformation_6(of.cog), np.zeros((6, 6)), {}
        for one in self.mounted:
            family, last, x = one.family, one.name.rpartition(":")[2], offsets.get(one.name, 0.0)
            if family == ARTICLE:
                E = to_cog.T @ BASIS[PARAMETERS.index(last)] @ to_cog
                more += x * E
                told[one.name] = (still, E)
            else:
                (beside if MOTIONS.index(last) < 3 else turn)[MOTIONS.index(last) % 3] = x
        Q = rotation_by(turn)
        back, T = np.kron(np.eye(2), Q.T), rigid_transformation_6(of.seat + beside)
        for one in self.mounted:
            if one.family == MOUNTING:
                axis = MOTIONS.index(one.name.rpartition(":")[2])
                e = np.eye(3)[axis % 3]
                if axis < 3:
                    dX = back @ (rigid_transformation_6(of.seat + beside + e) - T)
                else:  # a small turn more rotates what is turned already about J e
                    about = left_jacobian(turn) @ e
                    dX = np.kron(np.eye(2), -Q.T @ skew(about)) @ T
                told[one.name] = (dX, still)
        return Seated(transformation=back @ T, more=more), told

    def _mounted(
        self, solved: "SolvedStructure", effects: Sequence[Added], drive: BaseDrive, *, derivatives: Wanted
    ) -> tuple[MountedDynamicMass, Tangents]:
        R, answered = _turned(self.standing.pose), solved.answered
        mounted = MountedDynamicMass(
            frequency=answered.frequency,
            matrix=R @ answered.matrix @ R.T,
            seat=self.standing.pose.position,
            cog=self.standing.pose.rotation @ solved.matrices.cog,
            amplitude=drive.amplitude,
            sweep_rate=drive.sweep_rate,
            block=drive.block,
        )
        changes = {name: R @ change[:, :6] @ R.T for name, change in solved.changes.items()}
        return prediction_effects.body(mounted, changes, effects, derivatives=bool(derivatives))


@dataclass(frozen=True, eq=False, kw_only=True)
class SolvedStructure:
    """Matrices of a structure with their `tangents` by parameter, and what they answer at every line."""

    matrices: Matrices
    tangents: dict[str, Tangent]
    answered: CondensedTransfer

    @cached_property
    def changes(self) -> Tangents:
        """Behind the rows of the dynamic mass those of accelerometers, (n, 6 + a, 6)."""
        left, right = self.answered.left, self.answered.right
        worth = 6 * len(self.tangents) > left.shape[2] + 6  # by counting columns
        return transfer_tangents(self.answered, self.tangents, of_matrices.along_few(left, right) if worth else ())


def structure(
    of: Nuisances, offsets: Offsets, effects: Sequence[Added], *, derivatives: Wanted
) -> tuple[Matrices, dict[str, Tangent]]:
    """The matrices of the structure at `offsets`, effects on it applied, and how they change."""
    every, (structural, viscous) = bool(derivatives), of.coupling(offsets)
    drawn, changes = of.at(offsets, derivatives=derivatives)
    matrices, tangents = prediction_effects.structure(drawn, changes, effects, derivatives=derivatives)
    if laws := of.laws:
        matrices, tangents = of_matrices.with_damping_law(
            matrices, tangents, of.nominal, offsets, derivatives=every, laws=laws, coupling=structural
        )
    # What a user's own matrix has beside its diagonal is told, too, and stays
    share, told = offsets.get(LOSS_COUPLING, 0.0), np.diag(np.diag(drawn.viscous - viscous))
    if LOSS_COUPLING in laws and (share or every) and told.any():
        own = {name: one for name, one in changes.items() if share and one.viscous.any() and not name.startswith("coupling:")}
        moved = {name: np.diag(np.diag(full(one, "viscous", len(told)))) for name, one in own.items()}
        matrices, tangents = of_matrices.with_losses_by_mode(matrices, tangents, told, moved, share, derivatives=every)
    return matrices, {name: change for name, change in tangents.items() if is_wanted(name, derivatives)}


def _along(sensors: Aimed, each: npt.NDArray[Any]) -> npt.NDArray[Any]:
    """(..., a, m) what `sensors` read of `each` (..., 3 a, m) along the axes of F."""
    along, apart = np.array([*sensors.values()]).reshape(-1, 3), each.reshape(*each.shape[:-2], len(sensors), 3, each.shape[-1])
    return np.asarray(np.einsum("ai,...aim->...am", along, apart))


def _turned(pose: Pose) -> Array:
    """(6, 6) motions and loads in the axes of F from those in the article's own."""
    return np.asarray(np.kron(np.eye(2), pose.rotation), dtype=np.float64)
