"""Elastic terms as a block of the joint vector: where they begin, and the little that is known of them before.

What no measurement of ours says: participation cannot exceed the mass that there is, a residual is at most of the size of the
mass matrix at 20 Hz, coupled damping is a share below 1. Frequencies and damping are free within far more than any fit leaves.
"""

from __future__ import annotations

import numpy as np

from geometry.arrays import Array
from geometry.inertia import Inertia
from identification.elastic import model
from identification.elastic.terms import ElasticTerms
from identification.self_calibration.layout import Block, block

FAMILY = "elasticity"

FREQUENCY = 0.3
"""Standard deviation of ln f about the start."""

DAMPING = 1.0
"""Standard deviation of ln zeta about the start."""

COUPLED = 0.5
"""Standard deviation of the damping of a pair, as a share of what its two modes have; a layer that both shear gives nearly 1."""

FELT = 1e-3
"""How much of another mode's participation a resonance must be able to take over, through damping, for the pair to count."""

STIFF = (20.0 / 150.0) ** 2
"""Standard deviation of the residual of a nearly rigid body, as a share of its mass matrix at 20 Hz: a first mode at 150 Hz."""


def of_article(
    name: str, ten: Array, terms: ElasticTerms, *, pairs: tuple[tuple[int, int], ...] | None = None
) -> tuple[model.Layout, Block]:
    """The block of an elastic article beginning at `terms`, with the set-up's ten parameters (10,) for its size.

    Damping is coupled in `pairs`, by default wherever it could show.
    """
    layout = model.Layout(modes=len(terms.frequency), pairs=felt(terms) if pairs is None else pairs)
    start = model.pack(np.zeros(10), terms, layout)[10:]
    size = _size(ten)
    deviation, mean = np.full(len(start) + 10, np.inf), np.zeros(len(start) + 10)
    mean[10:] = start
    places = layout.blocks
    deviation[places["frequency"]], deviation[places["damping"]] = FREQUENCY, DAMPING
    deviation[places["pairs"]], mean[places["pairs"]] = COUPLED, 0.0
    deviation[places["participation"]], mean[places["participation"]] = np.tile(size, layout.modes), 0.0
    deviation[places["residual"]], mean[places["residual"]] = np.outer(size, size)[model.UPPER], 0.0
    made = block(name, layout.names[10:], start, deviation=deviation[10:], mean=mean[10:], families=FAMILY)
    return layout, made


def of_rigid(name: str, ten: Array) -> tuple[model.Layout, Block]:
    """The block of a body that is nearly rigid: a residual about zero."""
    layout = model.Layout(modes=0)
    size = _size(ten)
    deviation = STIFF * np.outer(size, size)[model.UPPER]
    return layout, block(name, layout.names[10:], np.zeros(21), deviation=deviation, families=FAMILY)


def felt(terms: ElasticTerms) -> tuple[tuple[int, int], ...]:
    """Pairs (r, s), r < s, in which coupled damping can show: at resonance r, omega_r C_rs / (omega_s² - omega_r²) of mode s."""
    w2, C = (2 * np.pi * terms.frequency) ** 2, np.diag(terms.damping)
    most = np.sqrt(np.outer(C, C)) * np.sqrt(np.maximum(w2[:, None], w2))
    apart = np.maximum(np.abs(w2[:, None] - w2), most)
    felt = np.triu(most > FELT * np.maximum(apart, np.finfo(np.float64).tiny), 1)
    return tuple((int(r), int(s)) for r, s in zip(*np.nonzero(felt), strict=True))


def _size(ten: Array) -> Array:
    """(6,) [kg^0.5]: square roots of the diagonal of the mass matrix in the units of `identification.elastic.model`."""
    diagonal = np.abs(np.diag(Inertia(parameters=ten).mass_matrix)) / np.square(model.SCALE)
    return np.asarray(np.sqrt(np.maximum(diagonal, 1e-6 * diagonal.max())))
