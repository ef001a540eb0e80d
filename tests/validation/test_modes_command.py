"""`massline modes`: frequencies, effective masses, what moves; and two models side by side, their modes told by shape."""

import json
import runpy
from dataclasses import replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.sparse import csr_array

from fem.modes import fixed_base
from fem.solid.model import structure
from fem.structure import Structure
from geometry import routes
from geometry.articles import built_in
from geometry.frames import Array
from validation.cli import main
from validation.flexible.model import Flexible, FlexibleOptions, another_body, flexible
from validation.flexible.modes import clusters, compared, described, movable
from validation.reference.published import claims
from validation.report.flexible import ModesBeside


@pytest.fixture(scope="module")
def clumod() -> Flexible:
    return flexible("clumod-1", "beam", FlexibleOptions(count=12))


def test_what_moves_between_the_nodes_of_a_craig_bampton_model_is_not_said_to_twist():
    """Every mode of its own coordinates had been one that twists."""
    rows = np.arange(6)
    point = {"points": np.zeros((1, 3)), "translations": rows[None, :3], "rotations": rows[None, 3:]}
    K, M = np.diag([*np.zeros(6), 1e4, 9e4]), np.eye(8)
    M[:3, 6] = M[6, :3] = M[1, 7] = M[7, 1] = 0.3
    model = Structure(
        stiffness=csr_array(K), mass=csr_array(M), rigid=np.vstack([np.eye(6), np.zeros((2, 6))]), held=rows, **point
    )
    assert [one.text for one in described(model, fixed_base(model, 2), None)] == ["", ""]


def test_no_axis_carries_more_than_the_rigid_body_and_what_modes_can_carry_is_the_sum_of_all(answer):
    said = answer("modes", "clumod-4", "--count", "60")
    carried = np.sum(said["effective_mass"], axis=0)
    assert np.all(carried <= np.array(said["effective_mass_of_all_modes"]) * (1 + 1e-9))  # rounding
    assert np.all(np.array(said["effective_mass_of_all_modes"]) <= np.array(said["rigid_mass"]) * (1 + 1e-9))
    rigid = routes.inertia(built_in("clumod-4"))
    assert_allclose(said["rigid_mass"], np.diag(rigid.mass_matrix), rtol=1e-3)  # the bar of the beam model's inertia
    whole = flexible("cuboid", "beam", FlexibleOptions(count=500))
    assert len(whole.modes.frequency) == len(whole.structure.free)
    assert_allclose(movable(whole.structure), whole.modes.effective_mass.sum(axis=0), rtol=1e-7)  # conjugate gradients
    assert clusters(np.array([5.0, 6.0, 6.05, 6.1, 8.0])).tolist() == [0, 1, 1, 1, 2]
    assert clusters(np.zeros(0)).tolist() == []


def test_a_dimension_moves_the_frequencies_and_damping_that_is_given_is_that_of_every_mode(answer):
    def bending(*more):
        said = answer("modes", "clumod-1", *more)
        pairs = zip(said["frequency_hz"], said["what_moves"], strict=True)
        return next(f for f, what in pairs if "lower-1 z, ends together" in what["text"])

    # the blade of 1.1 m becomes one of 0.7 m: its frequency goes with 1 / length², the hub's reach taken off
    assert bending("--set", "clumod.blade.lower-1.length_mm=700") > 2 * bending()
    said = answer("modes", "clumod-4", "--damping", "0.02")
    assert_allclose(said["damping_ratio"], 0.02, rtol=1e-12)  # rounding


@pytest.mark.parametrize(
    ("arguments", "words"),
    [
        (["clumod-9"], "Did you mean clumod-4?"),
        (["clumod-1", "--model", "bem"], "Did you mean beam?"),
        (["clumod-1", "--against", "sold"], "Did you mean solid?"),
        (["clumod-1", "--count", "0"], "--count: must lie between 1 and 500, found 0. Ask for 20."),
        (["clumod-1", "--count", "100000"], "found 100000. What the modes beyond"),
        (["clumod-1", "--damping", "1"], "below 1"),
        (["clumod-1", "--damping", "-0.1"], "found -0.1"),
        (["clumod-1", "--damping", "nan"], "found nan"),
        (["clumod-1", "--mode", "40"], "modes 1 to 20 are computed, found 40"),
        (["clumod-1", "--mode", "0"], "found 0"),
        (["clumod-1", "--model", "solid", "--size", "-3 mm"], "must be positive"),
        (["clumod-1", "--model", "solid", "--size", "3"], "--size"),
        (["clumod-1", "--set", "clumod.mast.lenght=3"], "there is no 'lenght'"),
        (["mine.step"], "mine.step: there is no such file"),
        (["mine.step", "--model", "exudyn"], "mine.step: there is no such file"),
        (["mine.toml"], "mine.toml: there is no such file"),
        (["/dev/null"], "it is a device"),
        (["."], "the folder holds neither"),
        (["mine.step", "--model", "solid"], "no such file"),
        (["mine.h5", "--model", "solid"], "model of your own already"),
        (["mine.h5", "--model", "beam"], "model of your own already"),
        (["clumod-1", "--against", "beam"], "the beam model would stand beside itself"),
        (["clumod-1", "--model", "solid", "--against", "solid"], "Name another model: beam, exudyn"),
        (["clumod-1", "--model", "mine.h5", "--against", "./mine.h5"], "the ./mine.h5 model would stand beside itself"),
        (["mine.h5"], "no such file"),
        (["mine.h5", "--against", "beam"], "behind --against"),
        (["mine.h5", "--set", "clumod.mast.top_mm=1500"], "states its own"),
        (["clumod-1", "--size", "20 mm"], "add --model solid"),
        (["clumod-1", "--material", "steel"], "a built-in article states its own"),
    ],
    ids=lambda value: " ".join(value) if isinstance(value, list) else "",
)
def test_bad_input_is_refused_in_words(arguments, words, refused):
    assert words in refused("modes", *arguments)


def test_of_a_file_it_is_said_first_whether_it_can_be_read_and_then_which_model_fits(run, refused, tmp_path):
    (tmp_path / "mine.step").touch()
    (tmp_path / "notes.txt").touch()
    for model, words in (("beam", "a beam model is made of"), ("exudyn", "an exudyn model is made of")):
        err = refused("modes", "mine.step", "--model", model)
        assert words in err
        assert "Use --model solid" in err
        assert "ends in .txt cannot be read" in run("modes", "notes.txt", "--model", model)[2]


def test_a_claim_in_print_fails_when_a_mode_is_elsewhere_and_beside_exudyn_the_frequencies_are_its_own(answer):
    as_printed = np.array([5.70, 6.3, 6.4, 7.0, 12.2, 12.3, 12.3, 12.4, 12.7, 12.8, 15.5, 38.5])
    assert [claim.holds for claim in claims("clumod-4", as_printed)] == [True] * 4
    assert [claim.holds for claim in claims("clumod-4", as_printed * 1.02)] == [False, False, False, True]
    assert [claim.holds for claim in claims("clumod-4", as_printed[:8])] == [True, None, None, None]
    assert claims("cuboid", as_printed) == ()
    said = answer("modes", "clumod-1", "--against", "exudyn", "--count", "5")
    assert said["against"]["model"] == "exudyn"
    # exudyn extrapolates from two of its own meshes, the beam has one: 1e-3 is ten times what is seen, and far below a bar of 1 %
    assert_allclose(said["against"]["frequency_hz"], said["frequency_hz"], rtol=1e-3)
    assert "agree in all 5 modes" in said["against"]["text"]


def test_a_model_without_shapes_says_so_and_one_whose_modes_do_not_swing_is_refused(refused, bracket, tmp_path):
    assert "no shape that could be drawn" in refused("modes", "clumod-1", "--model", "exudyn", "--count", "3", "--shapes")
    err = refused("modes", with_matrix(bracket, tmp_path, "viscous", 1e-2))
    assert "damped.npz: `viscous`" in err
    assert "damping ratio" in err


@pytest.fixture(scope="module")
def bracket(tmp_path_factory) -> Path:
    """The example of a user's model, in npz."""
    folder = tmp_path_factory.mktemp("own")
    runpy.run_path(str(Path(__file__).parents[2] / "examples" / "own_model.py"))["write"](folder)
    return folder / "bracket.npz"


def with_matrix(bracket: Path, folder: Path, name: str, share: float) -> str:
    """The bracket with a damping matrix that is a share of its stiffness."""
    with np.load(bracket, allow_pickle=False) as stored:
        arrays = dict(stored)
    np.savez(folder / "damped.npz", **arrays, **{name: share * arrays["stiffness"]})
    return str(folder / "damped.npz")


def test_a_comparison_of_different_bodies_begins_with_saying_so(bracket, run, answer):
    code, out, _ = run("modes", "cuboid", "--count", "3", "--against", str(bracket))
    assert code == main.DONE
    after = out.split("own beside beam")[1]
    assert 0 < after.index("different bodies") < after.index("own and beam part")
    said = answer("modes", "cuboid", "--count", "3", "--against", str(bracket))
    assert said["against"]["text"].startswith("These are different bodies: ")
    assert "2.512 kg (own model of bracket)" in said["against"]["text"]
    printed = run("dynamic-mass", "cuboid", "--step", "7", "--against", str(bracket))[1]
    assert printed.index("different bodies") < printed.index("Blocked")


def test_models_of_one_body_are_compared_without_that_word(clumod):
    lighter = replace(clumod, modes=replace(clumod.modes, rigid_mass=0.991 * clumod.modes.rigid_mass))
    assert another_body(clumod, lighter) == ""
    lighter = replace(clumod, modes=replace(clumod.modes, rigid_mass=0.989 * clumod.modes.rigid_mass))
    assert "different bodies" in another_body(clumod, lighter)


def test_names_that_only_the_reader_of_a_users_model_gave_are_not_printed(bracket, run, tmp_path):
    """A structural matrix, as a share of K, comes in as two: what is damped, and the rest."""
    code, out, _ = run("modes", with_matrix(bracket, tmp_path, "structural", 1e-2), "--count", "4")
    assert code == main.DONE
    assert "0.50" in out  # a loss factor of 1 %
    assert "damped" not in out
    assert "rest" not in out
    assert "what moves" in out


@pytest.fixture(scope="module")
def model() -> Flexible:
    return flexible("clumod-4", "beam", FlexibleOptions(count=12))


def altered(model: Flexible, shapes: Array, frequency: Array | None = None) -> Flexible:
    """`model` with other shapes, called solid."""
    f = model.modes.frequency if frequency is None else frequency
    return replace(model, model="solid", modes=replace(model.modes, shapes=shapes, frequency=f))


def test_a_model_beside_itself_is_the_same_whatever_its_signs_and_modes_are_matched_by_shape(model):
    found = compared(model, model)
    assert_allclose(found.mac, np.eye(12), atol=1e-9)  # orthogonality of the eigen-solution
    assert found.partner.tolist() == list(range(12))
    assert not len(found.parted)
    assert "agree in all 12 modes" in ModesBeside(found=found).where_they_part()
    found = compared(model, altered(model, model.modes.shapes * np.linspace(-3, -1, 12)))
    assert_allclose(found.mac, np.eye(12), atol=1e-9)
    order = [1, 0, *range(2, 12)]
    found = compared(model, altered(model, model.modes.shapes[:, order]))
    assert found.partner.tolist() == order
    assert_allclose(found.mac[range(12), order], 1.0, atol=1e-9)


def test_shapes_that_mix_in_a_cluster_span_the_same_space(model):
    found = compared(model, model)
    members = np.flatnonzero(found.cluster == np.argmax(np.bincount(found.cluster)))
    assert len(members) >= 3
    turn = np.linalg.qr(np.random.default_rng(3).normal(size=(len(members), len(members))))[0]
    shapes = np.array(model.modes.shapes)
    shapes[:, members] = shapes[:, members] @ turn
    mixed = compared(model, altered(model, shapes))
    assert mixed.mac[members, mixed.partner[members]].min() < 0.9
    assert_allclose(mixed.space[members], 1.0, atol=1e-9)
    assert not len(mixed.parted)


def test_where_a_frequency_or_a_shape_differs_the_words_name_the_mode(model):
    frequency = np.array(model.modes.frequency)
    frequency[11] *= 1.03
    shapes = np.array(model.modes.shapes)
    alone = 3  # no other mode is near enough to make a cluster with it
    shapes[:, alone] = np.roll(shapes[:, alone], 6 * 5)
    found = compared(model, altered(model, shapes, frequency))
    assert found.parted.tolist() == [alone, 11]
    text = ModesBeside(found=found).where_they_part()
    assert "part in 2 of 12 modes" in text
    assert "mode 4 in shape, MAC 0." in text
    assert "mode 12 by +3 %" in text


def test_missing_modes_have_no_partner(model):
    few = flexible("clumod-4", "beam", FlexibleOptions(count=10))
    found = compared(model, few)
    assert sorted(found.partner.tolist()) == [-1, -1, *range(10)]
    assert "has no partner" in ModesBeside(found=found).where_they_part()
    assert ModesBeside(found=found).json()["partner"].count(None) == 2
    assert ModesBeside(found=found).document().text(132).count("–") >= 10


def test_beam_and_solid_of_the_cuboid_move_alike():
    """Two models that share neither elements nor points: only a right interpolation of both gives a MAC of one."""
    cuboid = built_in("cuboid")
    (block,) = cuboid.parts
    article = replace(cuboid, parts=(replace(block, shape=replace(block.shape, voids=())),))  # holes want many small elements
    coarse = structure(article, size=0.06, cached=False)
    solid = Flexible(article="cuboid", model="solid", modes=fixed_base(coarse, 3), structure=coarse, drawn=article)
    beam = flexible("cuboid", "beam", FlexibleOptions(count=3))
    found = compared(solid, beam)
    assert np.diag(found.mac).min() > 0.99
    assert np.abs(found.difference[:2]).max() < 0.03  # the block is as thick as a fifth of its length, and its foot cannot warp
    assert compared(beam, solid).partner.tolist() == [0, 1, 2]


def standing(bracket: Path, folder: Path, support: str) -> str:
    """The bracket as a column and an arm of half its stiffness each, clamped to the ground or free."""
    with np.load(bracket, allow_pickle=False) as stored:
        arrays = dict(stored)
    kept = slice(6 if support == "ground" else 0, None)
    K = arrays.pop("stiffness")[kept, kept]
    arrays |= {"stiffness/column": 0.75 * K, "stiffness/arm": 0.25 * K}
    arrays |= {"mass": arrays["mass"][kept, kept], "dof": arrays["dof"][kept]}
    arrays["description"] = np.array(str(arrays["description"]).replace("interface = [101]", f'support = "{support}"'))
    np.savez(folder / f"{support}.npz", **arrays)
    return str(folder / f"{support}.npz")


def test_a_structure_on_the_ground_has_the_modes_of_the_clamped_one(bracket: Path, run, tmp_path: Path) -> None:
    code, out, _ = run("modes", standing(bracket, tmp_path, "ground"), "--count", "3")
    assert code == 0
    assert "On the ground." in out
    assert "all that moves" in out
    assert "carried by the base" not in out
    assert "column" in out  # its parts have names, and are said
    held, ground = (
        json.loads(run("modes", path, "--count", "3", "--json")[1])
        for path in (str(bracket), standing(bracket, tmp_path, "ground"))
    )
    np.testing.assert_allclose(ground["frequency_hz"], held["frequency_hz"], rtol=1e-9)
    assert ground["support"] == "ground"


def test_a_free_structure_has_its_rigid_motions_first(bracket: Path, run, tmp_path: Path) -> None:
    code, out, _ = run("modes", standing(bracket, tmp_path, "free"), "--count", "8")
    assert code == 0
    assert out.count("rigid motion") == 7  # of six modes, and of the note below
    assert "Free: the modes at 0 Hz" in out


@pytest.mark.parametrize("support", ["ground", "free"])
def test_without_a_base_there_is_no_dynamic_mass(support: str, bracket: Path, run, tmp_path: Path) -> None:
    code, out, err = run("dynamic-mass", standing(bracket, tmp_path, support))
    assert code == 2
    assert not out
    assert f'is "{support}": it has no base' in err
