"""Base motion from accelerometers: the paper's Eqs. 2, 3, 6 and 7 on spectra, and how far accelerometers contradict each other.

What accelerometers on a rigid cover plate read is y = G u, with a row d^T [G] each (Eq. 3). Six motions u of the reference
point F follow from more than six readings by weighted least squares (Eq. 2; Eq. 7 with equal weights)

    u = (G^T W G)^-1 G^T W y

with W the inverse noise variance. What is left, y - G u, is the only thing that the data say about themselves: eight readings
of six motions leave two combinations that must be zero.

Pick-ups of the table and of the cover plate are never used together unless asked for: load cells give way between them.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.observability import of_motions
from geometry.sensors import ChannelTable, motion_rows
from identification.gravity import tilt
from identification.spectra.line_spectra import Spectra

STANDARD_GRAVITY = 9.81
"""[m/s²] where a campaign does not state its own: that of the campaign format."""


@dataclass(frozen=True, eq=False, kw_only=True)
class BaseMotion:
    """Six base motions of the reference point, run by run and line by line: the *apparent* ones (`identification.gravity`).

    Attributes
    ----------
    channels : (c,) names of the accelerometers used
    values : (r, n, 6) complex, order of `MOTIONS`, in the unit of the spectra
    covariance : (r, n, 6, 6) of the noise in them, E[e e^H]; 0 where the noise is not known
    residual : (r, n, c) complex, what each accelerometer reads beyond the motion
    expected : (r, n, c) standard deviation that noise alone gives this residual; 0 where the noise is not known
    sigmas : (r, c) rms of residual / expected over the lines; nan where the noise is not known or nothing is redundant
    percent : (r, c) rms of the residual, in per cent of the rms reading of all these accelerometers in the run
    redundancy : how many readings there are beyond six
    warnings : sentences
    """

    channels: tuple[str, ...]
    values: ComplexArray
    covariance: Array
    residual: ComplexArray
    expected: Array
    sigmas: Array
    percent: Array
    redundancy: int
    warnings: tuple[str, ...] = ()


def base_motion(
    spectra: Spectra,
    *,
    groups: Sequence[str] | None = None,
    weights: npt.ArrayLike | None = None,
    gravity: float = STANDARD_GRAVITY,
) -> BaseMotion:
    """The base motion of every run (Eqs. 2, 3, 6, 7).

    Parameters
    ----------
    spectra : of a campaign
    groups : of `geometry.sensors.GROUPS`; by default the cover plate where it tells all six motions, else the table
    weights : a number for each channel of `groups` in the order of the table, inverse variances up to a factor; by default the
        inverse variance of the noise, or equal weights in runs where the noise of a channel is not known
    gravity : [m/s²], by which the readings of channels that do not feel it differ

    Raises
    ------
    BadInput : the accelerometers do not tell six motions, which are missing; weights that are none.
    """
    used = groups_used(spectra.table) if groups is None else tuple(groups)
    chosen = _complete(spectra.table, used)
    G = rows(spectra, chosen, gravity)
    noise = _shared(spectra.noise[:, :, chosen])
    T = _solver(G, _roots(noise, weights))
    y = spectra.values[:, :, chosen]
    u = (T @ y[..., None])[..., 0]
    residual = y - (G @ u[..., None])[..., 0]
    expected = np.broadcast_to(_expected(G, T, noise), y.shape)
    covariance = (T * noise[:, :, None, :] ** 2) @ T.swapaxes(2, 3)
    return BaseMotion(
        channels=tuple(spectra.table.names[k] for k in chosen),
        values=u,
        covariance=np.broadcast_to(covariance, (*u.shape, 6)),
        residual=residual,
        expected=expected,
        sigmas=in_sigmas(residual, expected),
        percent=in_percent(residual, y),
        redundancy=len(chosen) - 6,
        warnings=_warnings(spectra.table, used),
    )


def groups_used(table: ChannelTable) -> tuple[str, ...]:
    """The cover plate where its accelerometers tell all six motions, else the table; never both, since load cells give way.

    Raises
    ------
    BadInput : neither does.
    """
    for group in ("cover", "table"):
        if of_motions(table, (group,)).complete:
            return (group,)
    cover, below = of_motions(table, ("cover",)), of_motions(table, ("table",))
    both = of_motions(table, ("table", "cover")).complete
    together = "Together they do: ask for both groups, and mind that the load cells between them give way" if both else ""
    raise BadInput(
        source="base motion",
        field="channel",
        problem=f"neither the cover plate ({cover.text}) nor the table ({below.text}) tells the six base motions",
        remedy=together or f"Add an accelerometer to the cover plate that sees {', '.join(cover.missing)}",
    )


def rows(spectra: Spectra, chosen: Sequence[int], gravity: float) -> Array:
    """(n, c, 6): what the channels `chosen` read for unit *apparent* motions of the reference point, line by line."""
    channels = [spectra.table.channels[k] for k in chosen]
    G = np.broadcast_to(motion_rows(channels, spectra.table.origin), (len(spectra.frequency), len(channels), 6)).copy()
    kinematic = [k for k, channel in enumerate(channels) if not channel.senses_gravity]
    if kinematic:
        G[:, kinematic] = G[:, kinematic] @ np.linalg.inv(tilt(spectra.frequency, gravity))
    return G


def in_sigmas(residual: ComplexArray, expected: Array) -> Array:
    """(r, k): rms over the lines of (r, n, k) residuals, each divided by the standard deviation expected of it."""
    known = expected > 0
    ratio = np.abs(residual) / np.where(known, expected, 1.0)
    found = np.sqrt(np.mean(ratio**2, axis=1))
    return np.asarray(np.where(known.all(axis=1), found, np.nan))


def in_percent(residual: ComplexArray, readings: ComplexArray) -> Array:
    """(r, k): rms over the lines of (r, n, k) residuals in per cent of the rms reading of all channels of the run."""
    level = np.sqrt(np.mean(np.abs(readings) ** 2, axis=(1, 2)))[:, None]
    return np.asarray(100 * np.sqrt(np.mean(np.abs(residual) ** 2, axis=1)) / np.where(level > 0, level, 1.0))


def _complete(table: ChannelTable, groups: Sequence[str]) -> tuple[int, ...]:
    verdict = of_motions(table, groups)
    if not verdict.complete:
        raise BadInput(
            source="base motion",
            field="channel",
            problem=f"the accelerometers of {' and '.join(groups)} do not tell the six base motions: {verdict.text}",
            remedy=f"Add one that sees {', '.join(verdict.missing)}, or use another group",
        )
    return table.select(group=groups, quantity="acceleration")


def _roots(noise: Array, weights: npt.ArrayLike | None) -> Array:
    """(r, n, c) square roots of the weights, about 1."""
    if weights is not None:
        given = np.asarray(weights, dtype=np.float64)
        if given.shape != noise.shape[2:] or not np.all(np.isfinite(given) & (given > 0)):
            problem = f"a positive weight for each of {noise.shape[2]} channels is needed, found {given.tolist()}"
            raise BadInput(source="base motion", field="weights", problem=problem, remedy="Leave them out for those of the noise")
        return np.broadcast_to(np.sqrt(given / given.mean()), noise.shape)
    known = np.all(noise > 0, axis=(1, 2))[:, None, None]
    least = np.where(known, noise.min(axis=2, keepdims=True), 1.0)
    return np.where(known, least / np.where(known, noise, 1.0), 1.0)


def _shared(noise: Array) -> Array:
    """(r, n, c) as (1, n, c) where all runs have the same: what follows from it is computed once."""
    return noise[:1] if np.all(noise == noise[:1]) else noise


def _solver(G: Array, roots: Array) -> Array:
    """(r, n, 6, c): the matrix [T] of Eq. 6, weighted."""
    return np.asarray(np.linalg.pinv(roots[..., None] * G) * roots[:, :, None, :])


def _expected(G: Array, T: Array, noise: Array) -> Array:
    """(r, n, c) standard deviation of the residual (I - G T) n; 0 where rounding is all that is left."""
    left = np.eye(G.shape[1]) - G @ T
    sd = np.sqrt((left**2 @ noise[..., None] ** 2)[..., 0])
    return np.where(sd > 1e-6 * noise, sd, 0.0)


def _warnings(table: ChannelTable, groups: Sequence[str]) -> tuple[str, ...]:
    if {"table", "cover"} <= set(groups):
        return ("base motion from table and cover plate together: they are taken for one rigid body, load cells for rigid",)
    if "cover" not in groups:
        lacking = of_motions(table, ("cover",)).text
        return (f"base motion from {' and '.join(groups)}: cells are taken for rigid (the cover plate: {lacking})",)
    return ()
