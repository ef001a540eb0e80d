"""The dynamic mass of one campaign as a function of the joint vector: FMD, what stands on it, and elastic terms.

H = sum of M_F(bodies) + omega² L^T (Omega² - omega² + i omega C)^-1 L + omega² R                  (paper Eq. 8b)
"""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass, field
from functools import lru_cache

import numpy as np

from geometry.arrays import Array, frozen
from geometry.dynamic_mass import ComplexArray
from geometry.inertia import Inertia
from identification.elastic import model
from identification.elastic.terms import ElasticTerms
from identification.self_calibration.layout import Layout


@dataclass(frozen=True, eq=False, kw_only=True)
class Body:
    """Ten parameters ``mean + root @ z`` with z the block `block` of the joint vector; no block where it is known exactly.

    Attributes
    ----------
    block : name in the layout
    mean : (10,) about F, order of Eq. 4
    root : (10, k)
    """

    block: str = ""
    mean: Array = field(default_factory=lambda: np.zeros(10))
    root: Array = field(default_factory=lambda: np.eye(10))

    def __post_init__(self) -> None:
        object.__setattr__(self, "mean", frozen(self.mean, (10,), "mean"))

    def ten(self, layout: Layout, x: Array) -> Array:
        """(10,) at the joint vector `x`."""
        return np.asarray(self.mean + (self.root @ x[layout.at(self.block)] if self.block else 0.0))


@dataclass(frozen=True, eq=False, kw_only=True)
class Structure:
    """What stands on the load cells in one campaign.

    Attributes
    ----------
    bodies : whose ten parameters add up
    elastic : layout of the elastic terms; None for a rigid structure
    elastic_block : its name in the joint layout
    """

    bodies: tuple[Body, ...]
    elastic: model.Layout | None = None
    elastic_block: str = ""

    def ten(self, layout: Layout, x: Array) -> Array:
        """(10,) of all bodies together."""
        return np.asarray(np.sum([body.ten(layout, x) for body in self.bodies], axis=0))

    def terms(self, layout: Layout, x: Array) -> ElasticTerms:
        """The elastic terms at `x`; none for a rigid structure."""
        if self.elastic is None:
            return ElasticTerms()
        return model.unpack(np.concatenate([np.zeros(10), x[layout.at(self.elastic_block)]]), self.elastic)[1]

    def dynamic_mass(self, layout: Layout, x: Array, frequency: Array) -> ComplexArray:
        """H (n, 6, 6)."""
        mass = Inertia(parameters=self.ten(layout, x)).mass_matrix
        return model.dynamic_mass(mass, self.terms(layout, x), frequency)

    def derivatives(self, layout: Layout, x: Array, frequency: Array) -> ComplexArray:
        """dH (k, n, 6, 6): by the ten in SI, then by the elastic terms."""
        ten = np.broadcast_to(ten_matrices()[:, None], (10, len(frequency), 6, 6)).astype(np.complex128)
        if self.elastic is None:
            return ten
        return np.concatenate([ten, model.derivatives(self.terms(layout, x), frequency, self.elastic)[10:]])

    def selection(self, layout: Layout) -> Array:
        """(k, len(layout)): how the ten and the elastic parameters follow from the joint vector."""
        own = 0 if self.elastic is None else self.elastic.size - 10
        chosen = np.zeros((10 + own, len(layout)))
        for body in self.bodies:
            if body.block:
                chosen[:10, layout.at(body.block)] += body.root
        if own:
            chosen[10:, layout.at(self.elastic_block)] = np.eye(own)
        return chosen


@lru_cache(maxsize=1)
def ten_matrices() -> Array:
    """(10, 6, 6): the mass matrix of Eq. 1 is linear in the ten parameters of Eq. 4."""
    return np.stack([Inertia(parameters=row).mass_matrix for row in np.eye(10)])


def rooted(block: str, mean: Array, covariance: Array) -> Body:
    """A body known to be `mean` (10,) with `covariance` (10, 10): z is of unit variance, as long as the covariance has rank."""
    scale = np.sqrt(np.diag(covariance))
    safe = np.where(scale > 0, scale, 1.0)
    values, vectors = np.linalg.eigh(covariance / np.outer(safe, safe))
    kept = values > 1e-12 * max(float(values[-1]), 1e-300) if np.any(scale > 0) else np.zeros(10, dtype=bool)
    root = safe[:, None] * vectors[:, kept] * np.sqrt(values[kept])
    return Body(block=block if np.any(kept) else "", mean=mean, root=root)


def several(bodies: Sequence[Body]) -> tuple[Body, ...]:
    """`bodies` without those that are nothing at all."""
    return tuple(body for body in bodies if body.block or np.any(body.mean))
