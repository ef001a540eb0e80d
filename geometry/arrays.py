"""Arrays that cannot change under anybody's feet."""

import numpy as np
import numpy.typing as npt

Array = npt.NDArray[np.float64]

Integers = npt.NDArray[np.intp]


def frozen(value: npt.ArrayLike, shape: tuple[int, ...], name: str) -> Array:
    """Copy `value` into a read-only float64 array of `shape`.

    Raises
    ------
    ValueError : `value` has another shape or holds NaN or infinity; the message names it and the first such entry.
    """
    array = np.array(value, dtype=np.float64)
    if array.shape != shape:
        raise ValueError(f"`{name}` must have shape {shape}, found {array.shape}")
    if not np.all(np.isfinite(array)):
        first = tuple(int(i) for i in np.argwhere(~np.isfinite(array))[0])
        raise ValueError(f"`{name}` must be finite, found {array[first]:g}" + (f" at {list(first)}" if first else ""))
    array.setflags(write=False)
    return array
