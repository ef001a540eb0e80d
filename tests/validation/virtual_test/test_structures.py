"""Virtual tests of structures: the same whenever they are made."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest

from fem.user_model import reading
from validation.virtual_test import structure_tests


def test_a_table_of_a_large_structure_is_the_same_in_every_run(
    portal: Callable[..., Path], tmp_path: Path, monkeypatch: pytest.MonkeyPatch
):
    """Sparse eigensolvers begin at random and end with any sign; noise upon a shape would then be another one every time."""
    monkeypatch.setattr(structure_tests, "WHOLE", 10)
    structure = reading.load(portal(tmp_path, 8)).model
    rows = [row for name in ("a", "b", "c") for row in structure.places[name].toarray()]
    tables = [
        structure_tests.TestedStructure(highest=500.0, structure=structure, losses={"posts": 0.01}, ratio=0.0).table(
            rows, 1.0, 3000.0
        )
        for _ in range(3)
    ]
    assert len(tables[0][0]) > 5
    for found in tables[1:]:
        for one, other in zip(found, tables[0], strict=True):
            np.testing.assert_array_equal(one, other)
    shapes = tables[0][2]
    assert np.all(shapes[np.arange(len(shapes)), np.abs(shapes).argmax(axis=1)] > 0)
