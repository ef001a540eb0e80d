"""What every factoriser gives back, and how it says that there are no factors."""

from __future__ import annotations

from typing import Any, Protocol

import numpy as np
import numpy.typing as npt

Values = npt.NDArray[np.floating[Any] | np.complexfloating[Any, Any]]


class Factor(Protocol):
    """A factorised square matrix A."""

    name: str

    def solve(self, B: Values) -> Values:
        """Solution of ``A X = B`` for B (n,) or (n, k)."""


class Singular(ArithmeticError):
    """A matrix that has no factors of the kind asked for: singular, or not positive definite where that was promised."""
