"""Models that were damaged on their way: read as they were, or refused in words; never a traceback, never another structure."""

import shutil
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from fem.structure import Structure
from fem.user_model import reading
from geometry.errors import BadInput

COUNT = 100


def damaged(content: bytes, generator: np.random.Generator) -> bytes:
    """`content` cut short, with one byte or a few changed, with a stretch missing, or with a stretch twice."""
    data = bytearray(content)
    a, b = sorted(generator.integers(0, len(data), 2).tolist())
    kind = int(generator.integers(0, 5))
    if kind == 0:
        return bytes(data[:b])
    if kind in (1, 2):
        for place in generator.integers(0, len(data), 5 if kind == 1 else 1):
            data[place] = int(generator.integers(0, 256))
        return bytes(data)
    return bytes(data[:a] + (data[min(b, a + 40) :] if kind == 3 else data[a : a + 40] + data[a:]))


@pytest.fixture(scope="session")
def own_files(bracket_files: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """The bracket's files, and the bracket as `write` leaves it."""
    folder = tmp_path_factory.mktemp("damaged") / "files"
    shutil.copytree(bracket_files, folder)
    for ending in (".h5", ".npz"):
        reading.write(reading.read(folder / "bracket.h5"), folder / f"written{ending}")
    return folder


@pytest.mark.parametrize(
    ("spoilt", "model"),
    [
        ("written.h5", "written.h5"),
        ("written.npz", "written.npz"),
        ("bracket.h5", "bracket.h5"),
        ("bracket-modes.h5", "bracket-modes.h5"),
        ("bracket.op4", "bracket-op4.toml"),
        ("bracket.pch", "bracket-pch.toml"),
        ("bracket.bdf", "bracket-pch.toml"),
        ("bracket-op4.toml", "bracket-op4.toml"),
    ],
)
def test_a_damaged_model_is_read_or_refused_in_words(
    own_files: Path, tmp_path: Path, spoilt: str, model: str, capfd: pytest.CaptureFixture[str]
) -> None:
    """Files of `write` and every npz have checksums: nothing wrong in them is believed at all.

    In the others one moment of inertia in M may change unseen; what is sure is the stated mass, or a checksum in the description.
    """
    shutil.copytree(own_files, tmp_path, dirs_exist_ok=True)
    whole, content = reading.read(own_files / model), (own_files / spoilt).read_bytes()
    generator = np.random.default_rng([2026, len(spoilt)])
    capfd.readouterr()
    refusals = 0
    for _ in range(COUNT):
        (tmp_path / spoilt).write_bytes(damaged(content, generator))
        try:
            found = reading.read(tmp_path / model)
        except BadInput:
            refusals += 1
            continue
        assert_allclose(found.rigid_mass[0, 0], whole.rigid_mass[0, 0], rtol=0.03)
        if spoilt.startswith("written") and isinstance(found, Structure):
            assert_allclose(found.stiffness.toarray(), whole.stiffness.toarray(), rtol=0, atol=0)
            assert_allclose(found.mass.toarray(), whole.mass.toarray(), rtol=0, atol=0)
    assert refusals > COUNT / 4  # the damage is real
    assert capfd.readouterr() == ("", "")
