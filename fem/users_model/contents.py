"""What a user's file holds, as arrays by name, and the judge of every one: there, numbers, finite, real, of the right shape."""

from __future__ import annotations

from collections.abc import Collection, Mapping
from dataclasses import dataclass, field
from typing import Any

import numpy as np

from fem.structure import Sparse
from geometry.arrays import Array, Integers
from geometry.errors import BadInput
from geometry.keys import require_known, require_present

LARGEST_BYTES = 4 * 2**30
"""What the arrays of one file may take in memory; it is compared with what the file declares before anything is read."""

LARGEST_SIDE = 300_000
"""Rows of a matrix: K and M are factorised to be judged, and a solid of this size fills gigabytes. Larger models come reduced."""

LARGEST = 1e60
"""Products of three numbers of this size are still far from overflow."""

TOO_LARGE = "Reduce the model (Craig-Bampton), or write K and M as sparse matrices"
"""What to do about more."""

SPARSE = ("data", "indices", "indptr", "shape")
"""A sparse matrix `name` is four arrays name/data, name/indices ...: SciPy's CSR or, the same for a symmetric one, CSC."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Contents:
    """The arrays of one file.

    Attributes
    ----------
    source : the file, for messages
    arrays : by name, in the user's units; matrices may be SciPy's sparse ones
    description : TOML text that the file carries itself, if it does
    """

    source: str
    arrays: Mapping[str, Any] = field(default_factory=dict)
    description: str | None = None

    def __contains__(self, name: str) -> bool:
        return name in self.arrays or f"{name}/data" in self.arrays

    def require(self, needed: Collection[str], optional: Collection[str]) -> None:
        """Refuse a file that lacks an array of `needed`, with the nearest name, or holds one that nobody reads."""
        there = {name.partition("/")[0]: None for name in self.arrays}
        require_present(there, needed, source=self.source)
        require_known(there, (*needed, *optional), source=self.source)

    def numbers(self, name: str, shape: tuple[int, ...]) -> Array:
        """The array `name`, real and finite, of `shape`; -1 there stands for any length.

        Raises
        ------
        BadInput : no numbers, complex, NaN or infinite (how many, the first), or of another shape.
        """
        require_present(self.arrays, (name,), source=self.source)
        array = np.asarray(self.arrays[name])
        self._require_real(name, array)
        if len(array.shape) != len(shape) or any(want not in (-1, found) for want, found in zip(shape, array.shape, strict=True)):
            wanted = " x ".join("n" if want == -1 else str(want) for want in shape)
            found = " x ".join(map(str, array.shape)) or "one number"
            raise self.refused(name, f"must be {wanted}, found {found}", "Check which way round it was written, and every size")
        self._require_finite(name, array)
        return array.astype(np.float64)

    def whole(self, name: str, shape: tuple[int, ...]) -> Integers:
        """The array `name` of whole numbers, of `shape`."""
        array = self.numbers(name, shape)
        if np.any(array != np.round(array)) or np.any(np.abs(array) > 2**52):
            raise self.refused(name, "must hold whole numbers", "Write it as integers")
        return array.astype(np.intp)

    def matrix(self, name: str) -> Sparse:
        """The square matrix `name`, dense or sparse in the file, as a sparse one.

        Raises
        ------
        BadInput : missing, not square, no numbers, complex, not finite, indices that do not fit.
        """
        from scipy.sparse import csr_array, issparse

        if name not in self.arrays and f"{name}/data" in self.arrays:
            found = self._compressed(name)
        else:
            require_present(self.arrays, (name,), source=self.source)
            raw = self.arrays[name]
            self._require_square(name, np.shape(raw))
            if issparse(raw):
                self._require_real(name, raw.data)
                self._require_finite(name, raw.data)
                found = csr_array(raw)
            else:
                found = csr_array(self.numbers(name, (-1, -1)))
        return found

    def refused(self, name: str, problem: str, remedy: str) -> BadInput:
        """The refusal of the array `name`."""
        return BadInput(source=self.source, field=name, problem=problem, remedy=remedy)

    def _compressed(self, name: str) -> Sparse:
        from scipy.sparse import csr_array

        data = self.numbers(f"{name}/data", (-1,))
        indices, indptr = (self.whole(f"{name}/{part}", (-1,)) for part in ("indices", "indptr"))
        shape = tuple(int(side) for side in self.whole(f"{name}/shape", (2,)))
        self._require_square(f"{name}/shape", shape)
        try:
            found = csr_array((data, indices, indptr), shape=shape)
            found.check_format(full_check=True)
        except ValueError as error:
            problem = f"its indices do not fit together: {error}"
            raise self.refused(name, problem, "Write data, indices, indptr and shape of one CSR matrix") from None
        found.sum_duplicates()
        return found

    def _require_square(self, name: str, shape: tuple[int, ...]) -> None:
        if len(shape) != 2 or shape[0] != shape[1] or not 0 < shape[0] <= LARGEST_SIDE:
            found = " x ".join(map(str, shape)) or "one number"
            remedy = "Write the whole matrix, both triangles; reduce a larger model to Craig-Bampton coordinates"
            raise self.refused(name, f"must be square with 1 to {LARGEST_SIDE} rows, found {found}", remedy)

    def _require_real(self, name: str, array: Any) -> None:
        if np.iscomplexobj(array):
            worst = float(np.abs(np.imag(array)).max(initial=0.0))
            problem = f"is complex, its imaginary part reaches {worst:.6g}"
            remedy = "Give K, M and the damping as real matrices: what multiplies i in K is `structural`, C is `viscous`"
            raise self.refused(name, problem, remedy)
        if array.dtype.kind not in "fiu":
            raise self.refused(name, f"must hold numbers, found the type {array.dtype}", "Write it as 64-bit floating point")

    def _require_finite(self, name: str, array: Any) -> None:
        bad = np.argwhere(~np.isfinite(array))
        if len(bad):
            place = ", ".join(map(str, bad[0]))
            problem = f"holds {len(bad)} value(s) that are not finite, the first at [{place}]"
            raise self.refused(name, problem, "Look for what went wrong where it was made; 0 is the first index")
        largest = float(np.abs(array).max(initial=0))
        if largest > LARGEST:
            problem = f"holds {largest:.3g}, which no structure has in any unit"
            raise self.refused(name, problem, "Write it again; the file may be damaged")
