"""How exact reduced matrices are, said by `massline model --examine` of a study."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from scipy.linalg import eigh

from fem.modes import lowest
from fem.structure import hold
from fem.user_model import reading
from validation.diagnose import reduction_errors
from validation.effects.catalogue import FAMILIES, parse
from validation.model.model import Added
from validation.prediction import structure as reduction
from validation.study import Study


@pytest.fixture
def study(portal: Callable[..., Path], tmp_path: Path) -> Path:
    """A portal and a table of its lowest four frequencies to a per mille, as its own matrices have them."""
    path = portal(tmp_path, 6)
    free = hold(reading.load(path).model)
    f = np.sqrt(lowest(free.stiffness, free.mass, 4).values) / (2 * np.pi)
    said = ", ".join(f'"{one:.6f} +/- {1e-3 * one:.6f} Hz"' for one in f)
    table = f'[[test]]\nkind = "modal-table"\narticle = "portal"\nfrequencies = [{said}]\n'
    path.write_text(path.read_text().replace("[fe_model.parts.posts]", f"{table}[fe_model.parts.posts]", 1))
    return path


def test_effects_on_reduced_matrices_are_those_on_the_whole_within_a_thousandth(study: Path, answer: Callable[..., Any], run):
    (found,) = answer("model", "--examine", str(study))["reduction"]
    assert (found["modes"], found["article"]) == (4, "portal")
    assert {one["id"].partition(":")[0] for one in found["effects"]} >= {"modulus", "thickness", "mass", "point-mass", "cable"}
    errors = [one["error"] for one in found["effects"]]
    assert errors == sorted(errors, reverse=True)
    assert 0 < errors[0] < reduction_errors.BAR
    code, out, _ = run("model", "--examine", str(study))
    assert (code, "below the bar" in out, found["effects"][0]["id"] in out) == (0, True, True)


def test_modes_alone_are_not_that_exact(study: Path, monkeypatch: pytest.MonkeyPatch):
    monkeypatch.setattr(reduction, "bent_far", lambda structure, free, shapes, *rest: shapes)
    (found,) = reduction_errors.reduction_errors(Study.open(study, ()))
    assert found.effects[0].error > 10 * reduction_errors.BAR
    assert "ABOVE" in found.text


def test_a_joint_of_every_node_that_gives_is_put_into_the_whole_structure(two_floors: str, tmp_path: Path):
    """The real frame of three storeys, whose clamps all give alike, had ended in a KeyError."""
    path = tmp_path / "frame.toml"
    path.write_text(two_floors)
    reduced = reduction.by_itself(reading.load(path).model, 60.0)
    swinging = reduction_errors.swinging_with(reduced, [Added(named=parse("connection-compliance:all@every:beta=1e-4"))])
    softer = FAMILIES["connection-compliance"].change(swinging.matrices, ("all@every", "beta"), {"": 1e-4})
    slowest = [eigh(one.mass, one.stiffness, eigvals_only=True)[-1] for one in (swinging.matrices, softer)]  # [s²], 1 / omega²
    assert slowest[1] > 1.05 * slowest[0]
