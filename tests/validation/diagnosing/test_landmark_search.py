"""The search from afar: frames in closed form whose resonances lie 10 to 50 % off, and what must not be named."""

import json
from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from scipy.sparse.linalg import spsolve

from fem.structure import Structure
from fem.user_model import reading
from validation.diagnose import landmark_search
from validation.diagnose.candidates import candidates
from validation.diagnose.diagnose import parting
from validation.diagnose.diagnosis import Candidate
from validation.estimation.fit import nearby
from validation.estimation.problem import FITTED
from validation.prediction.landmarks import Landmark
from validation.study import Study

E, WIDTH, THICKNESS, HEIGHT, MASS, LOSS, LEGS = 70e9, 0.025, 0.003, 0.15, 5.0, 0.01, 4
F = np.arange(2.0, 90.0, 0.1)
SOFTER = 1 / 12


@pytest.fixture
def accelerances(three_floors: Callable[..., str], tmp_path: Path) -> Callable[..., Path]:
    """``accelerances(clamp=, masses=)``: of floors that do not turn on legs that run through them, held there by springs
    `clamp` [N m/rad], with `masses` [kg] on them; and its model file, which is what comes back.

    No code of ours knows it: Hermite beams, turns condensed.
    """

    def write(*, clamp: float = np.inf, masses: tuple[float, float, float] = (0.0, 0.0, 0.0)) -> Path:
        EI = LEGS * E * WIDTH * THICKNESS**3 / 12
        K = np.zeros((8, 8))  # shift and turn of the foot and of each floor
        a, b, c, d = 12 / HEIGHT**2, 6 / HEIGHT, 4.0, 2.0
        beam = EI / HEIGHT * np.array([[a, b, -a, b], [b, c, -b, d], [-a, -b, a, -b], [b, d, -b, c]])
        for k in (0, 2, 4):
            K[k : k + 4, k : k + 4] += beam
        turns, own = [1, 3, 5, 7], [2, 4, 6]
        K[turns, turns] += min(clamp, 1e9)
        K = K[np.ix_(own, own)] - K[np.ix_(own, turns)] @ np.linalg.solve(K[np.ix_(turns, turns)], K[np.ix_(turns, own)])
        M = np.diag(MASS + np.array(masses))
        w = 2 * np.pi * F[:, None, None]
        H = np.linalg.solve(K * (1 + 1j * LOSS) - w**2 * M, -(w**2) * np.eye(3)[:, :1])[..., 0]
        rng = np.random.default_rng(6)
        H = H * (1 + 0.01 * (rng.standard_normal(H.shape) + 1j * rng.standard_normal(H.shape)))
        columns = np.column_stack([F, np.ascontiguousarray(H).view(float)])
        np.savetxt(tmp_path / "data.csv", columns, delimiter=",", header="f,r1,i1,r2,i2,r3,i3", comments="", fmt="%.9g")
        (tmp_path / "model.toml").write_text(three_floors(LOSS, struck=True))
        return tmp_path / "model.toml"

    return write


def from_afar(model: Path) -> landmark_search.FromAfar | None:
    study = Study.open(model, ())
    return landmark_search.FromAfar.search(study, candidates(study), lambda what, share: None)


def test_a_model_that_is_near_is_not_looked_at_from_afar(accelerances):
    assert from_afar(accelerances(masses=(0.0, 0.1, 0.0))) is None  # 1 % of the mass of the frame


def test_what_mechanics_states_has_no_free_size(accelerances):
    study = Study.open(accelerances(), ())
    (gravity,) = landmark_search.stated(candidates(study))
    assert (str(gravity.named), gravity.fixed) == ("gravity-stiffness=1", True)


@pytest.mark.proof
def test_clamps_of_every_node_and_two_weights_are_named_with_their_sizes_from_resonances_far_off(accelerances):
    found = from_afar(accelerances(clamp=1500.0, masses=(1.5, 2.5, 0.0)))
    assert found is not None
    assert found.best.ids - {"gravity-stiffness"} == {
        "connection-compliance:all@every:beta",
        "point-mass:floor-1",
        "point-mass:floor-2",
    }
    wanted = {"connection-compliance:all@every:beta": 1 / 1500, "point-mass:floor-1": 1.5, "point-mass:floor-2": 2.5}
    for id, value in wanted.items():
        (size,) = found.estimates()[id]
        assert size.low < value < size.high
        assert size.high - size.low < 1.5 * value  # and says something


@pytest.mark.proof
def test_one_weight_far_beyond_what_is_plausible_is_one_weight_and_no_clamp(accelerances, tmp_path, answer, monkeypatch):
    monkeypatch.chdir(tmp_path)
    model = accelerances(masses=(0.0, 0.0, 6.0))
    found = json.loads(json.dumps(answer("diagnose", str(model))))
    named = {one["id"] for one in found["accepted"]} - {"gravity-stiffness"}
    assert named <= {"point-mass:floor-3"}  # as the ordinary search or as that from afar has it
    assert named or "point-mass:floor-3" in found["equivalence_class"]


FEET = """[fe_model.springs.left]
at = 1
stiffness = ["2e6 N/m", "2e6 N/m", "2e7 N/m", "3e3 N m/rad", "3e3 N m/rad", "3e3 N m/rad"]
[fe_model.springs.right]
at = {last}
stiffness = ["2e6 N/m", "2e6 N/m", "2e7 N/m", "3e3 N m/rad", "3e3 N m/rad", "3e3 N m/rad"]
"""


def on_feet(portal: Callable[..., Path], folder: Path, count: int) -> Path:
    """The portal on two springs to the ground, its model file."""
    model = portal(folder, count)
    model.write_text(model.read_text().replace('interface = ["HELD"]\n', "") + FEET.format(last=3 * count + 1))
    return model


@pytest.mark.proof  # a finer mesh line by line; sizes are scanned for soft feet below
def test_a_foot_of_a_twelfth_of_its_stiffness_is_found_between_sizes_that_explain_nothing(portal, tmp_path):
    """A factor of seven or of fifty leaves all resonances where they are not. The truth is a finer mesh, solved line by line."""
    model, fine = on_feet(portal, tmp_path, 8), reading.read(on_feet(portal, tmp_path / "fine", 24))
    assert isinstance(fine, Structure)
    K = fine.stiffness - (1 - SOFTER) * fine.part_stiffness["left"]
    lossy = 0.01 * (fine.part_stiffness["posts"] + fine.part_stiffness["lintel"])
    seen = np.vstack([fine.places[place].toarray()[k] for place, k in (("a", 0), ("b", 2), ("c", 2), ("c", 1))])
    f = np.linspace(15.0, 800.0, 250)
    H = np.array(
        [-(w**2) * seen @ spsolve((K + 1j * lossy - w**2 * fine.mass).tocsc(), seen.T[:, [0, 2, 3]]) for w in 2 * np.pi * f]
    )
    noise = np.random.default_rng(4).standard_normal((*H.shape, 2)) @ [1, 1j]
    H = H * (1 + 0.003 * noise)
    for k in range(3):
        table = np.column_stack([f, np.ascontiguousarray(H[:, :, k]).view(float)])
        np.savetxt(tmp_path / f"{k}.csv", table, delimiter=",", header="f,r1,i1,r2,i2,r3,i3,r4,i4", comments="")
    drives = ", ".join(f'{{ path = "{k}.csv", drive = "{drive}" }}' for k, drive in enumerate(("a:x", "c:z", "c:y")))
    head = 'format = 1\nkind = "response-functions"\narticle = "portal"\nshare = 0.004\n'
    (tmp_path / "test.toml").write_text(f'{head}responses = ["a:x", "b:z", "c:z", "c:y"]\nfiles = [{drives}]\n')
    study = Study.open(model, [tmp_path / "test.toml"])
    view = landmark_search.DistantView(marks=Landmark.of_tests(study.predictions))
    menu = candidates(study, only=["support-stiffness"])
    foot = next(one for one in menu if one.named.target == "left")
    _, scanned = view.scanned(view.explained(()), foot)
    assert abs(np.log2(scanned.named.value / SOFTER)) < 0.5
    first, _ = view.nearest(menu, 2)
    assert first.ids == {"support-stiffness:left"}
    assert abs(first.effects[0].named.value / SOFTER - 1) < 0.1


def table_of_middle(portal, run, *axes: str) -> Study:
    """The portal on feet of which the left one is soft, and a table of its modes at the middle of the lintel."""
    on_feet(portal, Path(), 8)
    asked = "simulate portal.toml --test modes --tolerances off --seed 2 --band 5 700 --effect support-stiffness:left=0.08"
    assert run(*asked.split(), *(part for axis in axes for part in ("--response", f"c:{axis}")), "--out", "made")[0] == 0
    return Study.open("portal.toml", ["made/test.toml"])


def test_shapes_that_tolerances_move_by_very_much_can_be_looked_at_from_afar(portal, tmp_path, run):
    """ "19-th leading minor of the array is not positive definite": ratios to what hardly moves had left no 1 beside them."""
    view = landmark_search.DistantView(marks=Landmark.of_tests(table_of_middle(portal, run, "x", "y", "z").predictions))
    assert np.isfinite(view.explained(()).chi2)
    assert np.all(np.diag(view.root) >= 1 - 1e-9)


@pytest.mark.parametrize(
    "only",
    [
        ["support-stiffness", "accelerometer-gain"],
        pytest.param([], id="all families", marks=pytest.mark.proof),
    ],
)
def test_what_is_alike_from_afar_is_told_apart_by_a_pick_up_that_is_proposed(portal, tmp_path, run, only):
    """Which of two feet of a portal is soft its middle does not tell; the class had no more than what would confirm one of it."""
    study = table_of_middle(portal, run, "x", "y")
    menu = candidates(study, only=only)
    found = landmark_search.FromAfar.search(study, menu, lambda what, share: None)
    assert found is not None
    (alike,) = found.alike.values()
    assert set(alike) == {"support-stiffness:left", "support-stiffness:right"}
    problem = study.problem(found.best.effects)
    first = Candidate(effects=found.best.effects, fit=nearby(problem, FITTED, problem.start), problem=problem)
    (advice, *_) = parting(study, first, found, menu, lambda what, share: None)
    assert advice.test.startswith("Add a pick-up at @")
    assert set(advice.separates) == set(alike)
    assert advice.gain > 5
