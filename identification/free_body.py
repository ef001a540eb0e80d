"""Mass, centre of gravity and inertia of a free or softly hung body from response functions: the mass line, and a joint fit.

Between its suspension and its first elastic mode a body answers a force at p_r along n_r, at p_c along d_c, with

    A_cr = g_c^T M^-1 g_r ,        g = [G(p)]^T d     (Eqs. 1 and 3),

the mass line. Read off as a mean over lines it holds a share of every elastic mode and of the suspension. So every function is
taken apart first, with the poles lambda_k that all have in common,

    A_cr(omega) = A_cr + S_cr / omega² + omega² R_cr + omega⁴ T_cr + sum_k -omega² Q_cr,k / (lambda_k (1 + i eta_k) - omega²) ,

linear in all but the poles (variable projection: G. H. Golub and V. Pereyra, SIAM J. Numer. Anal. 10, 1973). Then M, the gains,
the places and the directions are fitted to all A_cr together, what is known of each beforehand being data. The mass-line method
beside it is that of the literature: the six rigid accelerations by least squares, then M linear in ten numbers (R. A. B.
Almeida, A. P. V. Urgueira and N. M. M. Maia, J. Sound and Vibration 299 (2007), 884).
"""

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, rigid_transformation
from geometry.inertia import Inertia
from geometry.sensors import Point
from identification.response_functions import ResponseFunctions
from identification.rigid_body import BASIS

REFERENCES = 6
"""[count] of drives at least: each says six of the equations for ten unknowns, and all six motions must be driven."""

CONDITION = 1e3
"""[1] of six rows, rotations in units of the size of the body, beyond which they do not tell all motions."""

POLES = 6
"""[count] of elastic modes that are told apart at most; the others are in R and T."""

HEIGHT = 0.7
"""[log] Height over its surroundings from which a peak of the mean level is a mode."""

ENDS = (1.0, 0.8, 0.65, 0.5, 0.35)
"""[share] of the band that is tried, the widest first."""

SOUND = 1.7
"""[1] rms of the joint fit in units of what is expected, up to which a band is taken."""

FEWEST = 20
"""[count] of lines at least."""

POSITION, ANGLE = 0.5e-3, np.radians(0.3)
"""[m], [rad] standard deviations of points and directions that are known beforehand; those of `geometry.sensors.Tolerances`."""

ROUNDS = 12


@dataclass(frozen=True, eq=False, kw_only=True)
class FreeBody:
    """What response functions say of the inertia of a body.

    Attributes
    ----------
    inertia : by the joint fit, about the origin of the coordinates
    covariance : (10, 10) of its parameters
    mass_line : by the mass line alone, in the band in which it is nearly straight
    straight : (low, high) [Hz] of that band
    band : (low, high) [Hz] of the joint fit
    poles : (k,) [Hz] elastic modes that were told apart
    misfit : rms of the joint fit, in units of what is expected
    gains : by channel, and ``force``, what the fit made of them
    """

    inertia: Inertia
    covariance: Array
    mass_line: Inertia
    straight: tuple[float, float]
    band: tuple[float, float]
    poles: Array
    misfit: float
    gains: dict[str, float]

    def figures(self, of: Inertia | None = None) -> Array:
        """(10,) mass [kg], CoG [m], moments and products about it [kg m²]."""
        body = of or self.inertia
        return np.concatenate([[body.mass], body.cog, body.moments_cog, body.products_cog])

    @property
    def deviations(self) -> Array:
        """(10,) standard deviations of `figures`."""
        p, J = self.inertia.parameters, np.zeros((10, 10))
        for k, size in enumerate(np.sqrt(np.diag(self.covariance))):
            ends = [self.figures(Inertia(parameters=p + side * 0.01 * size * np.eye(10)[k])) for side in (1, -1)]
            J[:, k] = (ends[0] - ends[1]) / (0.02 * size)
        return np.asarray(np.sqrt(np.diag(J @ self.covariance @ J.T)))


def identify(data: ResponseFunctions) -> FreeBody:
    """The inertia of what was tested, about the origin of the coordinates of its points.

    Raises
    ------
    BadInput : points without coordinates, fewer than six references, responses or references that leave a motion open.
    CheckFailed : no body comes out, or the fit does not converge.
    """
    at = [*data.drives, *data.responses]
    missing = [one.name for one in at if one.position is None]
    if missing:
        problem = f"nobody says where {', '.join(missing[:4])} {'is' if len(missing) == 1 else 'are'}"
        remedy = "Write coordinates = { tip = [0.1, 0.0, 0.2] } in metres, or export dataset 15 or 2411"
        raise BadInput(data.source, "coordinates", problem, remedy)
    if data.quantity != "acceleration":
        turned = (2j * np.pi * np.maximum(data.frequency, 1e-9)) ** {"velocity": 1, "displacement": 2}[data.quantity]
        values = data.values * turned[:, None]
    else:
        values = data.values
    if len(data.drives) < REFERENCES:
        problem = f"there are {len(data.drives)} references, and the mass line of six at least tells the ten parameters"
        raise BadInput(data.source, "drives", problem, "Strike more points, along all three axes")
    centre = np.mean([np.asarray(one.position) for one in at], axis=0)
    size = float(np.max(np.linalg.norm([np.asarray(one.position) - centre for one in at], axis=1)))
    for what, points in (("responses", data.responses), ("drives", data.drives)):
        G = _rows(points, centre) / np.array([1, 1, 1, size, size, size])
        values_of = np.linalg.svd(G, compute_uv=False)
        if len(points) < 6 or values_of[5] < values_of[0] / CONDITION:
            problem = f"they leave a rigid motion open: their condition number is {values_of[0] / max(values_of[-1], 1e-30):.3g}"
            raise BadInput(data.source, what, problem, "Add points off the lines of the others")
    low, high = data.band
    f = data.frequency
    shape = (len(data.drives), len(data.responses))
    for share in ENDS:  # a mode beyond the end of the band is in R and T as far as these reach
        inside = (f >= low) & (f <= low + share * (high - low))
        lines = f[inside]
        if len(lines) < FEWEST:
            break
        y = np.moveaxis(values[:, inside], 2, 1).reshape(-1, len(lines))  # (r c, n)
        A0, variance, poles = _taken_apart(lines, y)
        straight = lines <= max((float(poles[0]) if len(poles) else float(lines[-1])) / 3, lines[0] * 1.5)
        plain = _mass_line(np.mean(y[:, straight].real, axis=1).reshape(shape), data, centre)
        A = A0.reshape(shape)
        found, covariance, misfit, gains = _joint(A, variance.reshape(shape), data, centre, _mass_line(A, data, centre))
        if misfit < SOUND:
            break
    if len(f[(f >= low) & (f <= high)]) < FEWEST:
        problem = f"fewer than {FEWEST} lines lie within {low:g} to {high:g} Hz"
        raise BadInput(data.source, "band", problem, "Widen it, or measure with a finer resolution")
    # Parameters about the origin of those about the centre
    T = np.array([Inertia(parameters=row).about(-centre).parameters for row in np.eye(10)]).T
    inertia = Inertia(parameters=T @ found)
    if inertia.mass <= 0 or np.linalg.eigvalsh(inertia.tensor_cog)[0] <= 0:
        raise CheckFailed(f"No body has what comes out of {data.source}: mass {inertia.mass:.4g} kg; look at signs and units")
    return FreeBody(
        inertia=inertia,
        covariance=T @ covariance @ T.T,
        mass_line=Inertia(parameters=T @ plain),
        straight=(float(lines[0]), float(lines[straight][-1])),
        band=(float(lines[0]), float(lines[-1])),
        poles=poles,
        misfit=misfit,
        gains=gains,
    )


def _rows(points: Sequence[Point], centre: Array) -> Array:
    """(p, 6) what six motions about `centre` move the points along their directions."""
    arms = (rigid_transformation(np.asarray(one.position) - centre) for one in points)
    return np.array([np.asarray(one.direction) @ arm for one, arm in zip(points, arms, strict=True)])


def _taken_apart(f: Array, y: ComplexArray) -> tuple[Array, Array, Array]:
    """The mass lines (m,) of functions `y` (m, n), their variances, and the poles [Hz] as they were refined."""
    from scipy.optimize import least_squares
    from scipy.signal import find_peaks

    level = np.mean(np.log(np.maximum(np.abs(y), 1e-300)), axis=0)
    peaks = f[find_peaks(level, prominence=HEIGHT)[0]][:POLES]
    weight = 1 / np.sqrt(np.mean(np.abs(y) ** 2, axis=0))
    scale = 1 / np.sqrt(np.mean(np.abs(y * weight) ** 2, axis=1, keepdims=True))
    target = scale * weight * y
    stacked = np.hstack([target.real, target.imag]).T  # (2 n, m)
    u = (f / f[-1]) ** 2

    def terms(x: Array) -> Array:
        columns = [np.ones_like(f), u[0] / u, u, u**2]
        for hertz, eta in zip(np.exp(x[::2]), np.exp(x[1::2]), strict=True):
            whole = -u / ((hertz / f[-1]) ** 2 * (1 + 1j * eta) - u)
            columns += [whole, 1j * whole]
        made = np.array(columns) * weight
        return np.hstack([made.real, made.imag]).T

    def left(x: Array) -> Array:
        X = terms(x)
        return np.asarray(stacked - X @ np.linalg.lstsq(X, stacked, rcond=None)[0])

    start = np.ravel([[np.log(one), np.log(0.005)] for one in peaks])
    if len(start):
        lowest, highest = ([[np.log(one) + off, end] for one in peaks] for off, end in ((-0.05, np.log(1e-5)), (0.05, 0.0)))
        bounds = np.ravel(lowest), np.ravel(highest)
        probe = np.linalg.svd(stacked, full_matrices=False)  # of all functions what is different between them
        kept = probe[2][: min(8, len(probe[1]))]
        reduced = stacked @ kept.T

        def misfit(x: Array) -> Array:
            X = terms(x)
            return np.asarray(reduced - X @ np.linalg.lstsq(X, reduced, rcond=None)[0]).ravel()

        start = least_squares(misfit, start, bounds=bounds, x_scale=0.01, max_nfev=40).x
    X = terms(start)
    solved = np.linalg.lstsq(X, stacked, rcond=None)[0]
    residual = left(start)
    sizes = np.sum(residual**2, axis=0) / max(1, len(X) - X.shape[1])
    inverse = np.linalg.pinv(X.T @ X)[0, 0]
    return solved[0] / scale[:, 0], sizes * inverse / scale[:, 0] ** 2, np.exp(start[::2])


def _mass_line(A: Array, data: ResponseFunctions, centre: Array) -> Array:
    """(10,) about `centre` of mass lines (r, c): six accelerations a reference, then M linear in its parameters."""
    G, F = _rows(data.responses, centre), _rows(data.drives, centre)
    motions = A @ np.linalg.pinv(G).T  # (r, 6)
    rows = np.concatenate([np.einsum("kij,j->ik", BASIS, motion) for motion in motions])
    size = np.tile(1 / np.maximum(np.abs(F).max(axis=0), 1e-12), len(F))[:, None]
    return np.asarray(np.linalg.lstsq(size * rows, size[:, 0] * F.ravel(), rcond=None)[0])


def _joint(
    A: Array, variance: Array, data: ResponseFunctions, centre: Array, start: Array
) -> tuple[Array, Array, float, dict[str, float]]:
    """Parameters (10,) about `centre`, their covariance, the rms misfit and the gains, of all mass lines (r, c) together."""
    c, r = len(data.responses), len(data.drives)
    points = [*data.responses, *data.drives]
    # A pick-up that reads along three axes is at one place; a blow is at its own
    groups = [("response", one.place) for one in data.responses] + [("drive", one.name) for one in data.drives]
    keys = list(dict.fromkeys(groups))
    place = np.array([keys.index(one) for one in groups])
    gain = data.gain if np.isfinite(data.gain) else 1.0
    force = data.force_gain if np.isfinite(data.force_gain) else 1.0
    spread = np.concatenate([np.full(c, gain), [force], np.full(3 * len(keys), POSITION), np.full(3 * (c + r), ANGLE)])
    spread = np.maximum(spread, 1e-9)
    weight = 1 / np.sqrt(np.maximum(variance, (1e-4 * np.abs(A).max()) ** 2))
    units = np.abs(start) + 1e-3 * np.abs(start).max()

    def predicted(x: Array) -> Array:
        p, z = start + units * x[:10], x[10:] * spread
        gains, shift, turn = z[:c], z[c + 1 : c + 1 + 3 * len(keys)].reshape(-1, 3), z[c + 1 + 3 * len(keys) :].reshape(-1, 3)
        at = np.array([np.asarray(one.position) - centre for one in points]) + shift[place]
        d = np.array([np.asarray(one.direction) for one in points])
        d = d + np.cross(turn, d)
        G = np.hstack([d, np.cross(at, d)])
        M = np.tensordot(p, BASIS, axes=1)
        rigid = G[c:] @ np.linalg.solve(M, G[:c].T)
        return np.asarray(rigid * (1 + gains) / (1 + z[c]))

    def residual(x: Array) -> Array:
        return np.concatenate([((A - predicted(x)) * weight).ravel(), x[10:]])

    x = np.zeros(10 + len(spread))
    cost = float(np.sum(residual(x) ** 2))
    J = np.zeros((A.size + len(spread), len(x)))
    for _ in range(ROUNDS):
        e = residual(x)
        for k in range(len(x)):
            step = np.zeros_like(x)
            step[k] = 1e-5 if k < 10 else 1e-3
            J[:, k] = (residual(x + step) - residual(x - step)) / (2 * step[k])
        change = -np.linalg.lstsq(J, e, rcond=1e-14)[0]
        factor = 1.0
        while factor > 1e-3 and float(np.sum(residual(x + factor * change) ** 2)) > cost:
            factor /= 2
        x = x + factor * change
        now = float(np.sum(residual(x) ** 2))
        done, cost = abs(cost - now) < 1e-6 * (1 + cost), now
        if done:
            break
    else:
        raise CheckFailed(f"The fit of mass lines of {data.source} did not converge; look at signs, units and places")
    misfit = float(np.sqrt(cost / A.size))
    inverse = np.linalg.pinv(J.T @ J)[:10, :10]
    covariance = np.asarray(inverse * np.outer(units, units) * max(1.0, misfit**2), dtype=np.float64)
    names = (*(one.name for one in data.responses), "force")
    gains = dict(zip(names, (1 + x[10 : 10 + c + 1] * spread[: c + 1]).tolist(), strict=True))
    return start + units * x[:10], covariance, misfit, gains
