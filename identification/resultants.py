"""From load-cell channels to the six resultants about F, and the combinations of channels that must balance.

Eight channels y of the paper's box give six resultants f = R y (`geometry.sensors.resultants`). Two combinations are left that no
resultant shows: how cells of equal stiffness share a load says that they are zero, for example

    x12 - x34 + y14 - y23      and      z1 - z2 + z3 - z4

A combination that does not balance is a wrong gain, a swapped or dead channel - or cells that are not equally stiff: an error of
one per cent in one channel or one cell shows as a quarter of a per cent of what that channel reads.
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np

from geometry import sensors
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import Array
from geometry.inertia import of_resultants
from geometry.sensors import ChannelTable
from identification.base_motion import in_percent, in_sigmas
from identification.spectra.line_spectra import Spectra

NOTHING = 1e-9
"""Relative size below which a channel takes no part in a combination: rounding."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Resultants:
    """Six resultants about the reference point, run by run and line by line.

    Attributes
    ----------
    channels : (c,) names of the force and moment channels used
    values : (r, n, 6) complex forces and moments of the table on the structure, in the unit of the spectra
    covariance : (r, n, 6, 6) of the noise in them, E[e e^H]; 0 where the noise is not known
    combinations : (k, c) parity rows, unit vectors
    names : (k,) of the combinations, in words
    parity : (r, n, k) complex, what the combinations read; 0 for exact channels on equal cells
    expected : (r, n, k) standard deviation that noise alone gives them; 0 where the noise is not known
    sigmas : (r, k) rms of parity / expected over the lines; nan where the noise is not known
    percent : (r, k) rms of the parity, in per cent of the rms reading of all these channels in the run
    """

    channels: tuple[str, ...]
    values: ComplexArray
    covariance: Array
    combinations: Array
    names: tuple[str, ...]
    parity: ComplexArray
    expected: Array
    sigmas: Array
    percent: Array


def resultants(spectra: Spectra) -> Resultants:
    """The six resultants about the table's reference point, with covariance and parity.

    Raises
    ------
    BadInput : the load cells do not tell six resultants, which are missing.
    """
    verdict = of_resultants(spectra.table)
    if not verdict.complete:
        raise BadInput(
            source="resultants",
            field="channel",
            problem=f"the load cells do not tell the six resultants: {verdict.text}",
            remedy=f"Add a load cell that sees {', '.join(verdict.missing)}",
        )
    chosen = spectra.table.select(group=("fmd",), quantity=("force", "moment"))
    channels = [spectra.table.channels[k] for k in chosen]
    names = tuple(channel.name for channel in channels)
    R = sensors.resultants(channels, spectra.table.origin)
    V = combinations(spectra.table, chosen)
    words = []
    for row in V / np.abs(V).max(axis=1, keepdims=True, initial=0.0):
        parts = [(abs(v), "-" if v < 0 else "+", name) for v, name in zip(row, names, strict=True) if v]
        terms = [f"{sign} {'' if abs(size - 1) < 1e-6 else f'{size:.3g} '}{name}" for size, sign, name in parts]
        words.append(" ".join(terms).removeprefix("+ "))
    y, noise = spectra.values[:, :, chosen], spectra.noise[:, :, chosen]
    parity = y @ V.T
    known = np.all(noise > 0, axis=2, keepdims=True)
    expected = np.where(known, np.sqrt(noise**2 @ (V**2).T), 0.0)
    return Resultants(
        channels=names,
        values=y @ R.T,
        covariance=np.einsum("kc,rnc,lc->rnkl", R, noise**2, R),
        combinations=V,
        names=tuple(words),
        parity=parity,
        expected=expected,
        sigmas=in_sigmas(parity, expected),
        percent=in_percent(parity, y),
    )


def combinations(table: ChannelTable, chosen: Sequence[int]) -> Array:
    """(k, c) unit rows of the combinations of the force and moment channels `chosen` that equal cells balance.

    With equal stiffness the cells share a load f as B (B^T B)^-1 f, and a combination v of the sums S balances when v S B = 0.
    The rows are as sparse as elimination makes them: a lateral one and a vertical one are not mixed.
    """
    from scipy.linalg import qr

    of = sensors.summation([table.channels[k] for k in chosen], table.origin)
    shown = of.adds @ of.gives.T  # (c, 6): what a channel reads of each load, up to (B^T B)^-1
    scale = np.linalg.norm(shown, axis=0)
    U, singular, _ = np.linalg.svd(shown / np.where(scale > 0, scale, 1.0))
    rank = int(np.sum(singular > 1e-6 * singular[0]))
    null = U[:, rank:]
    count = null.shape[1]
    if not count:
        return np.zeros((0, len(null)))
    _, _, pivots = qr(null.T, pivoting=True)
    rows = np.linalg.solve(null[pivots[:count]].T, null.T)
    rows[np.abs(rows) < NOTHING * np.abs(rows).max()] = 0.0
    rows = rows[np.argsort([int(np.flatnonzero(row)[0]) for row in rows], kind="stable")]
    first = np.array([np.sign(row[np.flatnonzero(row)[0]]) for row in rows])
    return np.asarray(rows * first[:, None] / np.linalg.norm(rows, axis=1, keepdims=True))
