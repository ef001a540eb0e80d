"""The joint problem: campaigns that share blocks of one vector, and the classical facts."""

from __future__ import annotations

from collections.abc import Sequence
from dataclasses import dataclass

import numpy as np
import numpy.typing as npt

from geometry.arrays import Array
from identification.measurement_chain import Chain
from identification.self_calibration import likelihood
from identification.self_calibration.elimination import Normal
from identification.self_calibration.layout import Layout
from identification.self_calibration.likelihood import Observed, Rows
from identification.self_calibration.structure import Structure


@dataclass(frozen=True, eq=False, kw_only=True)
class Part:
    """One campaign.

    Attributes
    ----------
    name : for messages
    observed : at the lines that are used
    chain : of its channels
    offsets : (p,) where the offsets of its chain stand in the joint vector; campaigns of the same hardware share them
    structure : what stood on the load cells
    """

    name: str
    observed: Observed
    chain: Chain
    offsets: npt.NDArray[np.int64]
    structure: Structure

    def rows(self, layout: Layout, x: Array, *, changes: bool = True) -> Rows:
        """The linear model at `x`, with its derivatives where `changes`."""
        theta, f = x[self.offsets], self.observed.frequency
        H = self.structure.dynamic_mass(layout, x, f)
        a0, a1 = self.chain.rows(theta, f)
        if not changes:
            return Rows(a0=a0, a1=a1, dynamic_mass=H)
        structure = self.structure.derivatives(layout, x, f).transpose(1, 2, 3, 0)
        return Rows(a0=a0, a1=a1, dynamic_mass=H, chain=self.chain.derivatives(theta, f, H), structure=structure)

    def selection(self, layout: Layout) -> Array:
        """(own, len(layout)): chain offsets, the ten and the elastic parameters from the joint vector."""
        chain = np.zeros((len(self.offsets), len(layout)))
        chain[np.arange(len(self.offsets)), self.offsets] = 1.0
        return np.vstack([chain, self.structure.selection(layout)])


def normals(parts: Sequence[Part], layout: Layout, x: Array) -> list[Normal]:
    """The normal equations of every campaign in the joint vector."""
    return [_joint(likelihood.normal(part.observed, part.rows(layout, x)), part.selection(layout)) for part in parts]


def total(found: Sequence[Normal]) -> Normal:
    """Several normal equations as one."""
    return Normal(
        cost=sum(one.cost for one in found),
        gradient=np.sum([one.gradient for one in found], axis=0),
        matrix=np.sum([one.matrix for one in found], axis=0),
    )


def _joint(own: Normal, selection: Array) -> Normal:
    return Normal(cost=own.cost, gradient=selection.T @ own.gradient, matrix=selection.T @ own.matrix @ selection)
