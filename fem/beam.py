"""Beam models of the built-in articles and their stacks, in milliseconds: the model that fitting uses."""

from __future__ import annotations

from collections.abc import Sequence

import numpy as np

from fem import beam_clumod
from fem.beam_clumod import ELEMENTS, Joint
from fem.frame import Frame, assemble
from geometry.arrays import Array
from geometry.articles.dimensions import Dimensions


def build(blades: tuple[str, ...], dimensions: Dimensions, *, joints: Sequence[Joint] = (), elements: int = ELEMENTS) -> Frame:
    """Frame of Clumod with the `blades` named, from `dimensions` as `clumod.toml` has them; the first six DOFs are its base."""
    return assemble(beam_clumod.plan(blades, dimensions, joints=joints, elements=elements))


def frequencies(frame: Frame, count: int) -> Array:
    """The lowest `count` eigenfrequencies (count,) [Hz] with the base held, ascending."""
    from scipy.linalg import eigh

    K = sum(frame.stiffness.values(), np.zeros_like(frame.mass))
    squares = eigh(K[6:, 6:], frame.mass[6:, 6:], eigvals_only=True, subset_by_index=[0, count - 1])
    return np.asarray(np.sqrt(squares) / (2 * np.pi))
