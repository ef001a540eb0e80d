"""A deck and a universal file, nothing else: the study of both, and a further universal file among DATA."""

import json
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.linalg import splu

from fem.mesh import model
from geometry.sensors import Point
from identification import test_file
from identification.response_functions import ResponseFunctions
from validation.cli import main

LOSS = 0.01
READ = {"3-z": (3, 2), "2-z": (2, 2), "2-y": (2, 1)}
"""Node and axis of each pick-up; the force acts along z at node 2."""

NODES = {(i, j): 1 + 5 * i + j for i in range(13) for j in range(5)}


def deck() -> str:
    """A cantilevered strip of 12 by 4 quadrilaterals, in mm and t."""
    lines = ["BEGIN BULK", "MAT1,1,210000.,,0.3,7.85-9,,,0.01", "PSHELL,1,1,2.,1,,1"]
    lines += [f"GRID,{n},,{20.0 * (12 - i)},{15.0 * j},0." for (i, j), n in NODES.items()]
    corners = [(i, j) for i in range(12) for j in range(4)]
    lines += [
        f"CQUAD4,{k},1,{NODES[i, j]},{NODES[i, j + 1]},{NODES[i + 1, j + 1]},{NODES[i + 1, j]}"
        for k, (i, j) in enumerate(corners, start=1)
    ]
    return "\n".join([*lines, "SPC1,1,123456,61,THRU,65", "ENDDATA", ""])


def strike(description: Path, path: Path, drive: int = 2) -> None:
    """Write the response functions of the structure, solved line by line from its matrices."""
    structure = model.load(description)[1]
    assert structure.elements is not None
    elements, tags = structure.elements, structure.elements.node_tags.tolist()
    at = [int(elements.own[elements.first[tags.index(node)] + axis]) for node, axis in (*READ.values(), (drive, 2))]
    K, M = structure.stiffness.tocsc(), structure.mass.tocsc()
    lines = np.arange(5.0, 80.0, 0.25)
    unit = np.zeros(K.shape[0], dtype=complex)
    unit[at[-1]] = 1.0
    w = 2 * np.pi * lines
    answers = np.array([-(one**2) * splu((1 + 1j * LOSS) * K - one**2 * M).solve(unit)[at[:-1]] for one in w])
    named = {name: Point(place=f"node {node}", direction=np.eye(3)[axis], name=name) for name, (node, axis) in READ.items()}
    test = ResponseFunctions(
        source=path.name,
        title=path.stem,
        article="strip",
        frequency=lines,
        values=answers[None],
        drives=(Point(place=f"node {drive}", direction=(0, 0, 1), name="struck"),),
        responses=tuple(named.values()),
        band=(5.0, 80.0),
    )
    test_file.write(path, test_file.of_responses(test))


@pytest.fixture
def strip(tmp_path: Path, run) -> Path:
    (tmp_path / "strip.bdf").write_text(deck())
    assert run("model", "strip.bdf", "--out", "strip.toml")[0] == main.DONE
    strike(tmp_path / "strip.toml", tmp_path / "first.unv")
    return tmp_path


def test_a_deck_and_a_universal_file_are_a_study(strip: Path, run) -> None:
    """Nodes keep their numbers through the file, which has no coordinates and says so."""
    code, out, _ = run("model", "strip.toml", "--test", "first.unv", "--out", "study.toml")
    assert code == main.DONE
    strike(strip / "strip.toml", strip / "second.uff", drive=1)
    code, out, _ = run("compare", "study.toml", "second.uff", "--json")
    assert code in (main.DONE, main.FAILED_CHECK)
    found = json.loads(out)
    assert found["error_percent"]["nominal"]["by_campaign"] == pytest.approx({"study": 0.0, "second": 0.0}, abs=1e-9)
    assert all(one["sigma"] < 1 for one in found["worst"])
    assert "its nodes are those of the model by number" in out


def test_a_node_that_the_mesh_has_not_is_named(strip: Path, run) -> None:
    text = (strip / "first.unv").read_text()
    (strip / "first.unv").write_text(text.replace("         2   3", "       777   3"))
    assert run("model", "strip.toml", "--test", "first.unv", "--out", "study.toml")[0] == main.DONE
    code, _, err = run("compare", "study.toml")
    assert code == main.BAD_INPUT
    assert "`node 777`: strip has no such place" in " ".join(err.split())
