"""Pendulums swung by exudyn, which knows none of the equations of the catalogue: what was hidden in them is found."""

import re
from collections.abc import Callable
from pathlib import Path

import pytest
from numpy.testing import assert_allclose

from validation.classical.swing import Words, recorded, setup, write
from validation.diagnose.diagnosis import AMBIGUOUS, MISSING
from validation.diagnose.pendulum import only_classical
from validation.model.model import Model
from validation.reference.reference import ArticleOptions

MODEL = Model(source="model.toml", title="", article="fmd+clumod-4")

TOLERANCES = {"rope_length": "0.2 mm", "radius": "0.05 mm", "mass": "1 g"}
"""95 % limits of what the laboratory read."""

Swing = Callable[..., str]


@pytest.fixture
def swing(tmp_path: Path) -> Swing:
    """``swing(name, radius, hidden)``: an upright Clumod on three ropes; the measurement file with tolerances, and no more."""

    def made(name: str, radius: str, **hidden: str) -> str:
        # steps of 10 ms lengthen a period of 2 s by 8e-5 of it, a tenth of what is hidden
        texts = {"length": "2 m", "amplitude": "20 mrad", "radius": radius, "noise": "0.02 mrad", "step": "10 ms"}
        off_centre = hidden.pop("off_centre", None)
        upright = {"ropes": None, "axis": "z", "along": None, "links": None, "start": "twist"}
        words = Words(texts={**texts, **hidden}, off_centre=off_centre, cycles=3, rate=15.0, seed=1, **upright)
        found = recorded(setup("clumod-4", words, ArticleOptions()))
        folder = tmp_path / name
        folder.mkdir()
        path = write(folder, found.setup, found.swing, found.signal, found.decay)
        text = path.read_text(encoding="utf-8")
        for key, tolerance in TOLERANCES.items():
            text = re.sub(rf'^({key} = "[^"]*)"', rf'\1 +/- {tolerance}"', text, flags=re.MULTILINE)
        path.write_text(text, encoding="utf-8")
        return str(path)

    return made


def test_ropes_at_two_radii_find_the_centre_of_gravity_beside_their_middle(swing: Swing) -> None:
    files = [swing("wide", "0.3 m", off_centre="20 mm"), swing("narrow", "0.2 m", off_centre="20 mm")]
    found = only_classical(MODEL, files)
    assert (found.verdict, found.equivalence_class) == (MISSING, ("off-centre-suspension",))
    assert_allclose(found.accepted[0].sizes[0].value, 0.02, rtol=0.03)  # the integration's own 8e-5 of the period is 1.6 % of e


def test_on_one_set_of_ropes_it_is_one_of_many(swing: Swing) -> None:
    found = only_classical(MODEL, [swing("wide", "0.3 m", off_centre="20 mm")])
    assert found.verdict == AMBIGUOUS
    assert {"off-centre-suspension", "rigid-inertia:Izz"} <= set(found.equivalence_class)
    (needed,) = [one for one in found.needed if one.id == "off-centre-suspension"]
    assert_allclose(needed.value, 0.02, rtol=0.03)
    assert "the ropes half as far" in " ".join(one.test for one in found.advice)


def test_ropes_that_stretch_are_among_those_that_no_radius_tells_apart(swing: Swing) -> None:
    stiff = {"rope_stiffness": "1.5e5 N"}
    found = only_classical(MODEL, [swing("wide", "0.3 m", **stiff), swing("narrow", "0.2 m", **stiff)])
    assert "rope-elasticity" in found.equivalence_class
    assert {"air-inertia", "rigid-inertia:Izz"} <= set(found.equivalence_class)
    (needed,) = [one for one in found.needed if one.id == "rope-elasticity"]
    assert_allclose(needed.value, 2.0 / 1.5e5, rtol=0.25)  # 0.05 % of the period: 8e-5 of the integration is a sixth of it
