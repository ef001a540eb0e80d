"""The modes of two models of one article, told apart by their shapes.

The modal assurance criterion is weighted with the mass of the model that has nodes all through the material, so that it is the
share of one mode's kinetic energy that moves as the other says:

    MAC_ij = (phi_i^T M psi_j)² / ((phi_i^T M phi_i) (psi_j^T M psi_j))

(Allemang 2003, with mass). Modes are matched by it, not by their order. In a cluster of close frequencies any mixture of the
shapes is a shape too; there the spaces that the shapes span are compared, by the smallest of their squared principal cosines.
"""

from __future__ import annotations

from dataclasses import dataclass

import numpy as np

from fem.structure import Sparse, Structure
from geometry.arrays import Array, Integers
from validation.flexible.model import Flexible
from validation.flexible.motion import displacement, has_rotations
from validation.flexible.places import nearest_part

CLUSTER = 0.015
"""Neighbouring frequencies closer than this share of them belong to one cluster."""

APART = 0.01
"""Relative difference of two frequencies beyond which the models are said to part: the bar of beam against solid."""

ALIKE = 0.9
"""MAC, or that of the spaces of a cluster, below which two shapes are not the same."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Comparison:
    """Modes of the first model, each with its partner.

    Attributes
    ----------
    first, second : the models
    mac : (n, m) of every mode of the first with every mode of the second; (0, 0) when a model has no shapes
    partner : (n,) number of the partner, from 0; -1 for a mode that has none because the second model has fewer
    cluster : (n,) number of the cluster of each mode of the first, ascending
    space : (n,) smallest squared principal cosine between the mode's cluster and its partners, the MAC where it is alone; NaN
        without shapes
    """

    first: Flexible
    second: Flexible
    mac: Array
    partner: Integers
    cluster: Integers
    space: Array

    @property
    def difference(self) -> Array:
        """Relative difference (n,) of the frequency of the second from that of the first; NaN without a partner."""
        f, g = self.first.modes.frequency, self.second.modes.frequency
        return np.where(self.partner >= 0, g[self.partner] / f - 1, np.nan)

    @property
    def parted(self) -> Integers:
        """The modes, from 0, of which the models say different things."""
        alike = (np.abs(self.difference) <= APART) & ((self.space >= ALIKE) | np.isnan(self.space))
        return np.flatnonzero(~alike)


def compared(first: Flexible, second: Flexible) -> Comparison:
    """Match the modes of `first` with those of `second`: by their shapes, or in ascending order where a model has none."""
    a, b = first.structure, second.structure
    if a is None or b is None or not (len(first.modes.shapes) and len(second.modes.shapes)):
        return _in_order(first, second)
    phi, psi, M = _on_common_points(first, a, second, b)
    phi, psi = _normalised(phi, M), _normalised(psi, M)
    cross = phi.T @ (M @ psi)
    mac = cross**2
    cluster = clusters(first.modes.frequency)
    partner = _matched(mac)
    space = _spaces(phi, psi, M, partner, cluster)
    partner = _in_order_where_mixed(partner, mac, cluster, space)
    return Comparison(first=first, second=second, mac=mac, partner=partner, cluster=cluster, space=space)


def _in_order(first: Flexible, second: Flexible) -> Comparison:
    n, m = len(first.modes.frequency), len(second.modes.frequency)
    order = np.arange(n)
    return Comparison(
        first=first,
        second=second,
        mac=np.zeros((0, 0)),
        partner=np.where(order < m, order, -1),
        cluster=clusters(first.modes.frequency),
        space=np.full(n, np.nan),
    )


def clusters(frequency: Array) -> Integers:
    """Number (n,) of the cluster of each of `frequency` (n,) [Hz], which ascend."""
    gaps = np.diff(frequency) > CLUSTER * frequency[:-1]
    return np.concatenate([[0], np.cumsum(gaps)]).astype(np.intp) if len(frequency) else np.zeros(0, dtype=np.intp)


def _matched(mac: Array) -> Integers:
    """The partner (n,) of each row such that the sum of their MAC is largest; -1 where there are too few columns."""
    from scipy.optimize import linear_sum_assignment

    partner = np.full(len(mac), -1, dtype=np.intp)
    rows, columns = linear_sum_assignment(-mac)
    partner[rows] = columns
    return partner


def _in_order_where_mixed(partner: Integers, mac: Array, cluster: Integers, space: Array) -> Integers:
    """Partners in ascending order in clusters whose shapes are mixed but span the same: no mode has its like, the whole has."""
    ordered = partner.copy()
    for number in np.unique(cluster):
        own = np.flatnonzero((cluster == number) & (partner >= 0))
        if len(own) and space[own].min() >= ALIKE > mac[own, partner[own]].min():
            ordered[own] = np.sort(partner[own])
    return ordered


def _spaces(phi: Array, psi: Array, M: Sparse, partner: Integers, cluster: Integers) -> Array:
    space = np.zeros(len(partner))
    for number in np.unique(cluster):
        own = np.flatnonzero((cluster == number) & (partner >= 0))
        if len(own):
            a, b = _orthonormal(phi[:, own], M), _orthonormal(psi[:, partner[own]], M)
            space[own] = np.linalg.svd(a.T @ (M @ b), compute_uv=False).min() ** 2
    return space


def _normalised(shapes: Array, M: Sparse) -> Array:
    return np.asarray(shapes / np.sqrt(np.einsum("nm,nm->m", shapes, M @ shapes)))


def _orthonormal(shapes: Array, M: Sparse) -> Array:
    """Columns that span the same space and are orthonormal in `M`, by Cholesky of their Gram matrix."""
    return np.asarray(np.linalg.solve(np.linalg.cholesky(shapes.T @ (M @ shapes)), shapes.T).T)


def _on_common_points(first: Flexible, a: Structure, second: Flexible, b: Structure) -> tuple[Array, Array, Sparse]:
    """Shapes of both on the degrees of freedom of the one that has nodes all through the material, and its mass."""
    if a.mass.shape == b.mass.shape and np.array_equal(a.translations, b.translations) and np.allclose(a.points, b.points):
        return first.modes.shapes, second.modes.shapes, a.mass
    if has_rotations(a) or not has_rotations(b):
        return _seen_on(first, a, b), second.modes.shapes, b.mass
    return first.modes.shapes, _seen_on(second, b, a), a.mass


def _seen_on(model: Flexible, own: Structure, other: Structure) -> Array:
    """The shapes of `model` on the degrees of freedom of `other`, which are translations of its points."""
    article = model.article_of_primitives
    parts = np.zeros(len(other.points), dtype=np.intp) if article is None else nearest_part(article, other.points)
    moved = displacement(own, model.modes.shapes, article, other.points, parts)
    shapes = np.zeros((other.mass.shape[0], moved.shape[2]))
    shapes[other.translations] = moved
    return shapes
