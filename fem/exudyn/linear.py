"""What exudyn says about small motions of an article: linearised matrices on a free base, eigen-solution on a held one."""

from collections.abc import Mapping, Sequence
from dataclasses import dataclass
from typing import Any

import numpy as np
import numpy.typing as npt

from fem.beam import articles
from fem.beam.articles import Joint
from fem.beam.frame import Plan
from fem.damping import DEFAULT_RATIO, symmetric
from fem.exudyn.frame import build, lossy, refined
from fem.exudyn.run import failed, finite, running
from fem.modes import Condensed, Modes
from fem.structure import rigid_motion
from geometry.errors import BadInput
from geometry.frames import Array, Integers, freeze

BASE = 6
"""The first coordinates are those of the base."""

MainSystem = Any
"""An exudyn `MainSystem`; the library has no types of its own."""

SINGULAR = 1e-6
"""How far the linearised stiffness may answer to a rigid motion, relative to its largest entry."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Linearised:
    """Exudyn's linearised system of an article on a base that is free to move; the base has the first six coordinates.

    Attributes
    ----------
    mass, stiffness : (n, n) SI
    constraints : (n, c) columns of exudyn's constraint Jacobian: what rides on what
    rigid : (n, 6) what every coordinate does in the six unit motions of the base
    frequency : (m,) [Hz] by exudyn with the base held, ascending
    shapes : (n, m) mass-normalised, zero at the base
    nodes : exudyn's nodes for every node of the plan; empty where there is none
    """

    mass: Array
    stiffness: Array
    constraints: Array
    rigid: Array
    frequency: Array
    shapes: Array
    nodes: tuple[tuple[int, ...], ...] = ()

    def __post_init__(self) -> None:
        n, m = np.shape(self.shapes)
        freeze(self, mass=(n, n), stiffness=(n, n), constraints=(n, np.shape(self.constraints)[1]))
        freeze(self, rigid=(n, 6), frequency=(m,), shapes=(n, m))

    @property
    def participation(self) -> Array:
        """L (6, m) of the modes about the origin [kg^0.5, kg^0.5 m]."""
        return np.asarray(self.rigid.T @ self.mass @ self.shapes)

    @property
    def rigid_mass(self) -> Array:
        """(6, 6) of the whole about the origin."""
        return np.asarray(self.rigid.T @ self.mass @ self.rigid)

    def compliance(self) -> Array:
        """Static answer (6, 6) [kg s² ...] to an accelerated base.

        It is P^T K^-1 P with P = M T: the sum of L L^T / omega² over all modes.
        """
        return np.asarray(self.answer(self.mass @ self.rigid, np.zeros((1, 1))), dtype=np.float64)

    def answer(self, loads: Array, lossy: Array) -> Any:
        """F^T (K + i S)^-1 F (m, m) for loads F (n, m) with the base held and the joints closed; real without `lossy` S."""
        n, c = self.constraints.shape
        K = self.stiffness + 1j * lossy if lossy.any() else self.stiffness
        saddle = np.block([[K, self.constraints], [self.constraints.T, np.zeros((c, c))]])
        X = np.linalg.solve(saddle[BASE:, BASE:], np.vstack([loads[BASE:], np.zeros((c, loads.shape[1]))]))
        return loads[BASE:].T @ X[: n - BASE]


def linearise(plan: Plan, count: int) -> Linearised:
    """Let exudyn linearise `plan` and find its lowest `count` modes.

    Raises
    ------
    CheckFailed : exudyn failed, a result is not finite, or a rigid motion meets stiffness.
    """
    task = "linearise the frame"
    with running(task) as exudyn:
        free = build(exudyn, plan, held=False)
        mass, stiffness, _damping, *rest = free.system.ComputeLinearizedSystem(returnConstraintJacobian=True)
    n = 6 * len(free.points)
    constraints = rest[0] if rest else np.zeros((n, 0))
    frequency, shapes = np.zeros(0), np.zeros((n, 0))
    if plan.members or plan.ports:  # a body without has nothing that swings, and exudyn would be left without an equation
        task = "solve for the eigenfrequencies"
        with running(task) as exudyn:  # the base held by a joint
            held = build(exudyn, plan, held=True)
            squares, found = held.system.ComputeODE2Eigenvalues(numberOfEigenvalues=count, useAbsoluteValues=False)
        frequency, shapes = frequencies(squares, task), finite(found, task)
        task = "linearise the frame"
    result = Linearised(
        mass=finite(mass, task),
        stiffness=finite(stiffness, task),
        constraints=finite(constraints, task),
        rigid=rigid_motion(free.points),
        nodes=free.nodes,
        frequency=frequency,
        shapes=shapes,
    )
    for matrix, what in ((result.stiffness, "meets stiffness"), (result.constraints.T, "breaks a joint")):
        answer = np.abs(matrix @ result.rigid).max(initial=0.0) / np.abs(matrix).max(initial=1.0)
        if answer > SINGULAR:
            raise failed(task, f"a rigid motion of the base {what}, {answer:.1e} of the largest entry")
    return result


def stiffness_of(plan: Plan) -> Array:
    """The (n, n) stiffness of `plan` by exudyn.

    Raises
    ------
    CheckFailed : exudyn failed, or the result is not finite.
    """
    task = "linearise the lossy frame"
    with running(task) as exudyn:
        return finite(build(exudyn, plan, held=False).system.ComputeLinearizedSystem()[1], task)


def frequencies(squares: npt.ArrayLike, task: str) -> Array:
    """Frequencies [Hz] from exudyn's eigenvalues [(rad/s)²].

    Raises
    ------
    CheckFailed : one is NaN, zero or negative.
    """
    found = finite(squares, task)
    if found.size and found.min() <= 0:
        raise failed(task, f"the lowest squared frequency is {found.min():g} (rad/s)²; a part is not held or is unstable")
    return np.sqrt(found) / (2 * np.pi)


# `Modes` from exudyn's linearised systems: of one mesh, and of two that say where they go.
#
# Exudyn's beam bends too stiffly by the square of the element length h. With half of h the error is a quarter, so that ``fine +
# (fine - coarse) / 3`` is free of it and wrong with the fourth power (Richardson). Modal stiffness, participation and the static
# answer to an accelerated base are extrapolated; the rigid mass needs none, because linear shapes hold it exactly. Neighbours in
# frequency may pass one another or mix from mesh to mesh, so the coarse modes are first turned among themselves to look like the
# fine ones (Procrustes), within a window of frequency; short waves that the coarse mesh cannot tell keep what the fine one says.

ALIKE = 0.8
"""Least share of a mode of the fine mesh that coarse modes near its frequency must hold for it to be extrapolated."""

WINDOW = 0.3
"""How far in frequency, relative, coarse modes may lie to be taken for a fine one."""


def extrapolated(coarse: Linearised | None, fine: Linearised, lossy: Array, reference_point: Array, count: int) -> Modes:
    """The lowest `count` modes that `coarse` and `fine` lead to; `lossy` (n, n) is the sum of eta_p K_p in those of `fine`.

    The nodes of the plan of `coarse` come first in that of `fine`. Without a `coarse` they are those of `fine` itself.

    Raises
    ------
    CheckFailed : the two meshes are too far apart to be extrapolated.
    """
    own, L = np.diag(_squares(fine)[:count]), fine.participation[:, :count].copy()
    A, static = own.copy(), fine.compliance()
    if coarse is not None:
        known, turn = _turn(coarse, fine, count)
        A[np.ix_(known, known)] = _richardson(turn.T @ (_squares(coarse)[:, None] * turn), own[np.ix_(known, known)])
        L[:, known] = _richardson(coarse.participation @ turn, L[:, known])
        static = _richardson(coarse.compliance(), static)
    squares, V = np.linalg.eigh(symmetric(A))
    if squares.size and squares[0] <= 0:
        raise failed("solve on two meshes", "both lead to a negative squared frequency; the coarser one needs more elements")
    # Where extrapolation puts the modes: L (6, n), shapes (N, n), and their modal stiffness on the mesh of `fine` itself
    omega, shapes, L, own = np.sqrt(squares), fine.shapes[:, :count] @ V, L @ V, V.T @ own @ V
    moved = omega / np.sqrt(np.diag(own))
    S = np.outer(moved, moved) * (shapes.T @ lossy @ shapes)  # damping from the strain energy of the shapes
    residual = symmetric(static - (L / squares) @ L.T)
    together = None
    if squares.size and lossy.any():
        # What the loss makes of stiffness, participation and residual, as `fem.modes` has it. The mesh's own couplings by loss
        # are kept; its modal stiffness is scaled by `moved` on both sides, its participation and residual are shifted, to where
        # extrapolation has put the undamped ones.
        n, P = squares.size, fine.mass @ fine.rigid
        own_L = P.T @ shapes
        F = fine.answer(np.hstack([fine.mass @ shapes, P]), lossy)
        inverse = np.linalg.inv(F[:n, :n])
        X = inverse @ F[:n, n:]
        R = F[n:, n:] - F[n:, :n] @ X + residual - (fine.compliance() - own_L @ np.linalg.solve(own, own_L.T))
        turned = np.asarray(np.outer(moved, moved) * inverse, dtype=np.complex128)
        together = Condensed(stiffness=(turned + turned.T) / 2, participation=X.T + (L - own_L), residual=(R + R.T) / 2)
    return Modes(
        frequency=omega / (2 * np.pi),
        damping_ratio=np.diag(S) / (2 * squares),
        participation=L,
        rigid_mass=symmetric(fine.rigid_mass),
        residual=residual,
        reference_point=reference_point,
        shapes=np.zeros((0, len(squares))),
        viscous=np.zeros((len(squares), len(squares))),
        structural=symmetric(S),
        condensed=together,
    )


def _squares(system: Linearised) -> Array:
    return np.asarray((2 * np.pi * system.frequency) ** 2)


def _turn(coarse: Linearised, fine: Linearised, count: int) -> tuple[Integers, Array]:
    """Which of the lowest `count` modes of `fine` the coarse mesh can tell, (k,), and what turns its own (m,) into them.

    The second, (m, k), is orthogonal.
    """
    if not count:
        return np.zeros(0, dtype=np.intp), np.zeros((coarse.frequency.size, 0))
    # (n, 2) coordinates in `coarse` and in `fine` of every place that both have
    places = zip(coarse.nodes, fine.nodes, strict=False)
    pairs = np.array([pair for a, b in places for pair in zip(a, b, strict=True)])
    common = np.asarray((6 * pairs[:, None, :] + np.arange(6)[None, :, None]).reshape(-1, 2))
    here, there = common.T
    M, a, b = coarse.mass[np.ix_(here, here)], coarse.shapes[here], fine.shapes[there, :count]
    cross = a.T @ M @ b / np.sqrt(np.outer(_norms(a, M), _norms(b, M)))
    cross[np.abs(coarse.frequency[:, None] / fine.frequency[:count] - 1) > WINDOW] = 0.0
    known = np.flatnonzero(np.sum(cross**2, axis=0) >= ALIKE)
    U, _, Vt = np.linalg.svd(cross[:, known], full_matrices=False)
    return known, np.asarray(U @ Vt)


def _norms(shapes: Array, M: Array) -> Array:
    return np.asarray(np.einsum("ir,ir->r", shapes, M @ shapes))


def _richardson(coarse: Array, fine: Array) -> Array:
    return np.asarray(fine + (fine - coarse) / 3)


# Eigenfrequencies by exudyn, from native beams for the built-in articles.
#
# The beams, ``--model exudyn``, take from `fem.beam.articles` where things are and what their sections are, and nothing of its
# elements or eigen-solution.

ELEMENTS = 8
"""In a half-blade of the coarser of both meshes: the first 11 modes of Clumod are then known to 3e-5."""

EXTRA = 10
"""Modes that are solved for beyond those asked for, so that each finds its like on the other mesh."""


def modes(
    article_name: str,
    count: int = 30,
    changes: Mapping[str, float] = articles.NO_CHANGES,
    *,
    elements: int = ELEMENTS,
    cells: npt.ArrayLike | None = None,
    joints: Sequence[Joint] = (),
) -> Modes:
    """The lowest `count` fixed-base modes of a built-in article or stack about its origin, by exudyn's native beams.

    Parameters
    ----------
    article_name, changes : as `geometry.articles.built_in` takes them
    count : modes; all there are when the mesh has fewer
    elements : in a half-blade of Clumod, its mast has twice as many; a mesh twice as fine is solved too and both extrapolated
    cells, joints : as `fem.beam.articles.structure` takes them

    Raises
    ------
    BadInput : an article or a dimension that cannot be used, no mode asked for.
    CheckFailed : exudyn failed.
    """
    return modes_of_plan(articles.article_plan(article_name, changes, elements=elements, cells=cells, joints=joints), count)


def modes_of_plan(plan: Plan, count: int = 30) -> Modes:
    """The lowest `count` fixed-base modes of the frame `plan` about its origin, extrapolated from its mesh and one twice as fine.

    Raises
    ------
    BadInput : no mode asked for.
    CheckFailed : exudyn failed.
    """
    if count < 1:
        raise BadInput("modes", "count", f"at least one mode is needed, found {count}", "Ask for 30")
    finer = refined(plan, 2)
    coarse, fine = (linearise(mesh, count + EXTRA) for mesh in (plan, finer))
    found = min(count, coarse.frequency.size)
    # A structure without loss factors has one ratio for every mode
    losses = stiffness_of(lossy(finer)) if finer.loss_factors else 2 * DEFAULT_RATIO * fine.stiffness
    return extrapolated(coarse, fine, losses, np.zeros(3), found)
