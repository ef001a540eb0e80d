"""Arrays say what is wrong with them, and say it briefly."""

import numpy as np
import pytest

from geometry.frames import frozen


def test_of_a_long_array_that_is_not_finite_the_first_such_entry_is_named() -> None:
    long = np.zeros((100_000, 6))
    long[70_001, 2], long[70_002:] = np.inf, np.nan
    with pytest.raises(ValueError, match=r"`load` must be finite, found inf at \[70001, 2\]$"):
        frozen(long, long.shape, "load")


def test_a_single_number_has_no_place() -> None:
    with pytest.raises(ValueError, match=r"`mass` must be finite, found nan$"):
        frozen(np.nan, (), "mass")
