"""Two bootstraps of the joint fit, linearised at its minimum, so that a thousand draws cost next to nothing.

Near the minimum a change of the data moves the estimate by -C s, s the change of the gradient. The *parametric* bootstrap draws
noise as the likelihood takes it: independent from line to line. The *block* bootstrap draws from the residuals that are there:
runs are cut into blocks of neighbouring lines, blocks are drawn with replacement (Kuensch, Ann. Statist. 17 (1989) 1217), and
what each contributes to the gradient comes along with whatever correlation it has. Priors are drawn anew in both.
"""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from geometry.arrays import Array
from identification.self_calibration import likelihood
from identification.self_calibration.layout import Layout
from identification.self_calibration.problem import Part

BLOCK = 1.0
"""[Hz] of a block: wider than a resonance."""

DRAWS = 2000


def scores(parts: Sequence[Part], layout: Layout, x: Array, *, block: float = BLOCK) -> list[Array]:
    """By campaign (b, k): what every block of lines of every run contributes to the gradient at `x`."""
    return [_of_campaign(part, layout, x, block) for part in parts]


def parametric(C: Array, normal: Array, rows: Array, rng: np.random.Generator, draws: int = DRAWS) -> Array:
    """(draws, k) changes of the estimate with noise and knowledge drawn as they are assumed.

    C (k, k) is the posterior covariance, `normal` J^T J of the data and `rows` (p, k) the whitened knowledge.
    """
    values, vectors = np.linalg.eigh(normal)
    root = vectors * np.sqrt(np.maximum(values, 0.0))
    noise = rng.standard_normal((draws, len(C))) @ root.T
    return np.asarray((noise + rng.standard_normal((draws, len(rows))) @ rows) @ C)


def blocks(C: Array, found: Sequence[Array], rows: Array, rng: np.random.Generator, draws: int = DRAWS) -> Array:
    """(draws, k) changes of the estimate with blocks of residuals drawn with replacement, campaign by campaign."""
    change = rng.standard_normal((draws, len(rows))) @ rows
    for one in found:
        times = rng.multinomial(len(one), np.full(len(one), 1 / len(one)), size=draws) - 1.0
        change = change + times @ one
    return np.asarray(change @ C)


def _of_campaign(part: Part, layout: Layout, x: Array, block: float) -> Array:
    by_line = likelihood.gradients(part.observed, part.rows(layout, x)) @ part.selection(layout)  # (r, n, k)
    f = part.observed.frequency
    at = np.floor((f - f[0]) / block).astype(np.int64)
    return np.concatenate([_summed(run, at) for run in by_line])


def _summed(by_line: Array, at: Array) -> Array:
    return np.stack([by_line[at == one].sum(axis=0) for one in np.unique(at)])
