"""Files that were damaged on their way: whatever is in them, a user reads a sentence and never a traceback."""

from pathlib import Path

import numpy as np
import pytest
import trimesh

from geometry.errors import BadInput
from geometry.user_article import inertias, load

DESCRIPTION = """format = 1
[article]
name = "block"
[material.lead]
density = "11.34 g/cm^3"
[[part]]
name = "block"
file = "block.stl"
unit = "mm"
material = "lead"
position_mm = [1, 2, 3]
"""


def damaged(content: bytes, generator: np.random.Generator) -> bytes:
    """`content` cut short, with bytes changed, with a stretch missing, or with a stretch twice."""
    data = bytearray(content)
    a, b = sorted(generator.integers(0, len(data), 2).tolist())
    match generator.integers(0, 4):
        case 0:
            return bytes(data[:b])
        case 1:
            for place in generator.integers(0, len(data), 5):
                data[place] = int(generator.integers(0, 256))
            return bytes(data)
        case 2:
            return bytes(data[:a] + data[min(b, a + 40) :])
        case _:
            return bytes(data[:a] + data[a : a + 40] + data[a:])


@pytest.mark.parametrize(("ending", "count"), [(".stl", 70), (".ply", 70), (".obj", 70), (".toml", 60), (".step", 60)])
def test_a_damaged_file_is_read_or_refused_in_words(
    tmp_path: Path, ending: str, count: int, capfd: pytest.CaptureFixture[str]
) -> None:
    solid = trimesh.creation.box((16.0, 7.0, 40.0))
    (tmp_path / "block.stl").write_bytes(solid.export(file_type="stl"))
    if ending == ".step":
        import cadquery

        cadquery.exporters.export(cadquery.Workplane().box(16, 7, 40), str(tmp_path / "whole.step"))
        content = (tmp_path / "whole.step").read_bytes()
    else:
        content = DESCRIPTION.encode() if ending == ".toml" else solid.export(file_type=ending[1:])
    content = content.encode() if isinstance(content, str) else content
    generator = np.random.default_rng([2026, len(content)])
    path = tmp_path / f"damaged{ending}"
    options = {} if ending == ".toml" else {"material": "steel"} if ending == ".step" else {"material": "steel", "unit": "mm"}
    capfd.readouterr()  # what writing says is not what is looked at here
    refusals = 0
    for _ in range(count):
        path.write_bytes(damaged(content, generator))
        try:
            inertias(load(path, **options))
        except BadInput:
            refusals += 1
    assert refusals > count / 4  # the damage is real
    assert capfd.readouterr() == ("", "")
