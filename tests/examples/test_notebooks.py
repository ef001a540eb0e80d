"""Every notebook runs, and shows what it is kept with."""

import re
from pathlib import Path
from typing import Any

import pytest

from tools.notebooks import ran, read

FOLDER = Path(__file__).parents[2] / "examples" / "notebooks"
LONG = ("hidden-effect", "own-structure", "hammer-test")
"""Notebooks that compute for ten seconds and more: left to `make proof`."""


def words(notebook: dict[str, Any]) -> list[str]:
    """What the cells show without numbers and pictures, which other machines round and draw otherwise."""
    shown = [one for cell in notebook["cells"] for one in cell.get("outputs", ())]
    texts = ("".join(one.get("data", {}).get("text/plain", one.get("text", ()))) for one in shown)
    return [word for text in texts for word in re.findall(r"[A-Za-z][\w:@-]{2,}", text)]


@pytest.mark.parametrize(
    "path",
    [pytest.param(one, marks=[pytest.mark.proof] * (one.stem in LONG), id=one.stem) for one in sorted(FOLDER.glob("*.ipynb"))],
)
def test_a_notebook_runs_and_shows_what_it_is_kept_with(path: Path, tmp_path: Path) -> None:
    kept, found = read(path), ran(path, tmp_path)
    assert words(kept) == words(found)
    assert len(words(kept)) > 20
    assert [len(cell.get("outputs", ())) for cell in kept["cells"]] == [len(cell.get("outputs", ())) for cell in found["cells"]]


def test_what_a_cell_shows_is_its_last_expression_and_what_it_prints(tmp_path: Path) -> None:
    folder = tmp_path / "examples" / "notebooks"
    folder.mkdir(parents=True)
    source = ["import massline\n", "print(2 + 2)\n", "massline.built_in('cuboid').name"]
    cells = [{"cell_type": "markdown", "source": ["# One"]}, {"cell_type": "code", "source": source}]
    (folder / "one.ipynb").write_text(str({"cells": cells}).replace("'", '"').replace('"cuboid"', "'cuboid'"), encoding="utf-8")
    _, cell = ran(folder / "one.ipynb", tmp_path / "run")["cells"]
    assert cell["outputs"][0]["text"] == ["4\n"]
    assert cell["outputs"][1]["data"] == {"text/plain": ["cuboid"]}
