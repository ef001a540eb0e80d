"""Structures on the ground, free and on a base, with parts, places, supports and joints: what comes in is what was described."""

from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from fem.modes import fixed_base
from fem.user_model import reading

BRIDGE = """
format = 1

[fe_model]
name = "footbridge"
kind = "matrices"
units = "consistent"
support = "ground"
supports = ["y1", "y2", "z1", "z2"]
file = "$MASSLINE_DATA/footbridge/model.npz"

[fe_model.parts.Frame]
tolerance = { modulus = 0.05 }
"""


@pytest.fixture
def bridge(data: Path, tmp_path: Path, monkeypatch: pytest.MonkeyPatch) -> reading.UsersModel:
    """The footbridge of 17 parts whose data others have measured."""
    monkeypatch.setenv("MASSLINE_DATA", str(data))
    (tmp_path / "bridge.toml").write_text(BRIDGE, encoding="utf-8")
    return reading.load(tmp_path / "bridge.toml")


def test_the_footbridge_stands_on_its_springs(bridge: reading.UsersModel) -> None:
    """Its nominal frequencies are those of the README of the data, which other code computed."""
    structure = bridge.model
    published = sorted([4.875, 4.660, 6.654, 9.901, 11.381])
    assert_allclose(fixed_base(structure, 5).frequency, published, atol=6e-4)
    assert len(structure.part_stiffness) == 17
    assert structure.supports == ("y1", "y2", "z1", "z2")
    assert structure.part_tolerances == {"Frame": {"modulus": 0.05}}
    assert len(structure.places) == 58
    assert structure.places["dof-301"].indices.tolist() == [301]
    assert "not known" in bridge.notes[0]
