"""Structural effects hold their equations of the catalogue: on the rig that is driven, seen as the dynamic mass about F."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from numpy.testing import assert_allclose

from fem.base_excitation.rig import Rig, dynamic_mass
from fem.damping import Damping
from geometry.articles import locations
from geometry.dynamic_mass import ComplexArray
from geometry.errors import BadInput
from geometry.frames import rigid_transformation, rigid_transformation_6, rotation_about
from geometry.inertia import PARAMETERS, Inertia
from validation.effects.catalogue import parse_all
from validation.virtual_test.plan import RIGID, Part, Plan, PlantedEffect, exact
from validation.virtual_test.planted import planted, reaching, require_reaching
from validation.virtual_test.simulate import ShakerLaboratory, laboratory, simulate

LINES = np.array([4.0, 9.0, 20.0, 32.0])
OMEGA = (2 * np.pi * LINES)[:, None, None]

Lab = Callable[..., ShakerLaboratory]


@pytest.fixture(scope="session")
def lab() -> Lab:
    """``lab(article, *effects)``: a laboratory without errors."""

    @cache
    def make(article: str, *effects: str, model: str = "beam") -> ShakerLaboratory:
        return laboratory(replace(exact(Plan(article=article, model=model)), effects=planted(parse_all(effects))))

    return make


def article_mass(rig: Rig) -> ComplexArray:
    """(4, 6, 6) of what stands on the cover plate, about F."""
    return dynamic_mass(replace(rig, cells=()), LINES).matrix - rig.cover.about(np.zeros(3)).mass_matrix


def changed(lab: Lab, article: str, *effects: str, model: str = "beam") -> tuple[ComplexArray, ComplexArray, Rig]:
    """H without and with `effects`, and the rig without."""
    before, after = lab(article, model=model), lab(article, *effects, model=model)
    return article_mass(before.rig), article_mass(after.rig), before.rig


def close(found: npt.ArrayLike, expected: npt.ArrayLike, share: float = 1e-9) -> None:
    """Equal to `share` of the largest expected value."""
    assert_allclose(found, expected, rtol=0, atol=share * np.max(np.abs(expected)))


def gamma(rig: Rig, article: str, place: str) -> np.ndarray:
    """(3, 6) what F does to `place` of a rigid article."""
    return rigid_transformation(rig.seat + locations(article)[place])


def resonator(m: float, f: float, zeta: float) -> ComplexArray:
    """m (omega_a² + 2 i zeta omega_a omega) / (omega_a² - omega² + 2 i zeta omega_a omega) at `LINES`."""
    a = 2 * np.pi * f
    holds = a**2 + 2j * zeta * a * OMEGA
    return np.asarray(m * holds / (holds - OMEGA**2))


def test_a_point_mass_is_m_gamma_gamma(lab: Lab) -> None:
    before, after, rig = changed(lab, "fmd+disc+cuboid", "point-mass:top-1=0.7", model=RIGID)
    G = gamma(rig, "disc+cuboid", "top-1")
    close(after - before, np.broadcast_to(0.7 * G.T @ G, before.shape))


def test_a_point_mass_lowers_a_mode_by_half_m_phi_squared(lab: Lab) -> None:
    """Rayleigh: delta f / f = - m phi² / 2 for a small mass, phi the mass-normalised shape there."""
    from scipy.linalg import eigh

    found = []
    for rig in (lab("fmd+clumod-1").rig, lab("fmd+clumod-1", "point-mass:mast-top=0.001").rig):
        held = slice(6, None)
        squares, shapes = eigh(rig.article.reduced.stiffness[held, held], rig.article.reduced.mass[held, held])
        phi = rig.article.places["mast-top"][:, held] @ shapes
        found.append((np.sqrt(squares[:4]), np.sum(phi[:, :4] ** 2, axis=0)))
    (before, phi_squared), (after, _) = found
    assert_allclose(after / before - 1, -0.5 * 0.001 * phi_squared, rtol=5e-3, atol=1e-9)  # the square of the change


def test_mass_can_be_taken_away_but_not_more_than_there_is(lab: Lab) -> None:
    lab("fmd+disc+cuboid", "point-mass:top=-1", model=RIGID)
    with pytest.raises(BadInput, match="would have a negative mass in some direction"):
        lab("fmd+disc+cuboid", "point-mass:top=-100", model=RIGID)


@pytest.mark.parametrize("parameter", PARAMETERS)
def test_a_parameter_is_added_about_the_articles_centre_of_gravity(lab: Lab, parameter: str) -> None:
    before, after, rig = changed(lab, "fmd+clumod-1", f"rigid-inertia:{parameter}=0.02")
    cog = Inertia.from_mass_matrix(rig.article.reduced.mass[:6, :6]).cog + rig.seat
    delta = np.array([0.02 * (name == parameter) for name in PARAMETERS])
    G = rigid_transformation_6(cog)
    M = Inertia(parameters=delta, reference_point=np.zeros(3)).mass_matrix
    close(after - before, np.broadcast_to(G.T @ M @ G, before.shape), 1e-7)  # a small difference of large figures


@pytest.mark.parametrize(
    ("direction", "motions"), [("rotation", (3, 4)), ("lateral", (0, 1)), ("vertical", (2,)), ("torsion", (5,))]
)
def test_a_joint_gives_by_c_times_its_load(lab: Lab, direction: str, motions: tuple[int, ...]) -> None:
    """H' = (1 - omega² H C)^-1 H about the joint, which is where the article stands."""
    value = 1e-6 if direction in ("rotation", "torsion") else 1e-7
    before, after, rig = changed(lab, "fmd+clumod-1", f"joint-compliance:{direction}={value}")
    G = np.linalg.inv(rigid_transformation_6(rig.seat))
    about_joint, compliance = G.T @ before @ G, np.zeros((6, 6))
    compliance[motions, motions] = value
    close(G.T @ after @ G, np.linalg.solve(np.eye(6) - OMEGA**2 * about_joint @ compliance, about_joint), 1e-8)
    assert np.max(np.abs(after - before)) > 1e-4 * np.max(np.abs(before))


@pytest.mark.parametrize(("target", "axes"), [("top", (0, 1, 2)), ("top:lateral", (0, 1)), ("top:vertical", (2,))])
def test_a_cable_holds_by_k_over_omega_squared(lab: Lab, target: str, axes: tuple[int, ...]) -> None:
    before, after, rig = changed(lab, "fmd+disc+cuboid", f"cable:{target}=2000", model=RIGID)
    G = gamma(rig, "disc+cuboid", "top")[list(axes)]
    close(after - before, -2000 * G.T @ G / OMEGA**2, 1e-8)


def test_a_turned_article_is_r_h_r(lab: Lab) -> None:
    before, after, _ = changed(lab, "fmd+clumod-1", "orientation:z=0.3")
    R = np.kron(np.eye(2), rotation_about("z", 0.3))
    close(after, R @ before @ R.T)
    assert np.max(np.abs(after - before)) > 1e-2 * np.max(np.abs(before))


def test_a_turned_articles_places_turn_with_it(lab: Lab) -> None:
    before, after = lab("fmd+clumod-1").rig, lab("fmd+clumod-1", "orientation:z=0.3").rig
    R = rotation_about("z", 0.3)
    turned = R @ locations("clumod-1")["lower-1+"]
    close(after.article.places["lower-1+"][:, :6], rigid_transformation(turned), 1e-6)
    close(after.article.places["lower-1+"][:, 6:], R @ before.article.places["lower-1+"][:, 6:])


def test_a_shifted_article_is_t_h_t_and_the_campaign_does_not_know(lab: Lab) -> None:
    before, after, rig = changed(lab, "fmd+clumod-1", "mounting-offset:x=0.004")
    T = np.linalg.inv(rigid_transformation_6(rig.seat)) @ rigid_transformation_6(rig.seat + np.array([0.004, 0.0, 0.0]))
    close(after, T.T @ before @ T, 1e-8)
    other = lab("fmd+clumod-1", "mounting-offset:x=0.004")
    assert_allclose(other.made.rig.seat, rig.seat, rtol=0, atol=0)


@pytest.mark.parametrize("axis", ["x", "y", "z"])
def test_an_appendage_swings_at_the_plate(lab: Lab, axis: str) -> None:
    before, after, _ = changed(lab, "fmd+clumod-1", f"appendage:{axis}=m:0.05,f:21,zeta:0.01")
    expected, k = np.zeros_like(before), "xyz".index(axis)
    expected[:, k, k] = resonator(0.05, 21.0, 0.01)[:, 0, 0]
    close(after - before, expected, 1e-6)  # a small difference of large figures


@pytest.mark.parametrize(("family", "axes"), [("absorber", (0, 1, 2)), ("slosh", (0, 1))])
def test_a_resonator_at_a_place_swings_there(lab: Lab, family: str, axes: tuple[int, ...]) -> None:
    before, after, rig = changed(lab, "fmd+disc+cuboid", f"{family}:top-2=m:0.4,f:12,zeta:0.02", model=RIGID)
    G = gamma(rig, "disc+cuboid", "top-2")[list(axes)]
    close(after - before, resonator(0.4, 12.0, 0.02) * (G.T @ G), 1e-8)


def test_moduli_of_all_parts_together_shift_every_frequency_alike(lab: Lab) -> None:
    frequency = [
        made.made.modes.frequency
        for made in (
            lab("fmd+clumod-1"),
            lab("fmd+clumod-1", "modulus:mast=0.1"),
            lab("fmd+clumod-1", "modulus:mast=0.1", "modulus:lower-1=0.1"),
        )
        if made.made.modes is not None
    ]
    assert_allclose(frequency[2][:5], np.sqrt(1.1) * frequency[0][:5], rtol=1e-7)
    assert np.all((frequency[1] > frequency[0] * (1 - 1e-9))[:5])
    assert np.max(frequency[1][:5] / frequency[0][:5]) > 1.02


def test_loss_of_all_parts_together_adds_half_to_every_damping_ratio(lab: Lab) -> None:
    ratio = [
        made.made.modes.damping_ratio
        for made in (
            lab("fmd+clumod-1"),
            lab("fmd+clumod-1", "structural-damping:mast=0.01"),
            lab("fmd+clumod-1", "structural-damping:mast=0.01", "structural-damping:lower-1=0.01"),
        )
        if made.made.modes is not None
    ]
    assert_allclose(ratio[2] - ratio[0], 0.005, rtol=1e-3)  # zeta = eta / 2 where the damping is light
    assert np.all((ratio[1] - ratio[0] > -1e-9) & (ratio[1] - ratio[0] < 0.005))


def test_the_layer_damps_its_own_blade(lab: Lab) -> None:
    plain, damped, stiffer = (
        lab("fmd+clumod-4", *e).made.modes for e in ((), ("layer-damping:upper-short=0.1",), ("modulus:upper-short=0.1",))
    )
    gained = damped.damping_ratio - plain.damping_ratio
    moved = stiffer.frequency[: len(gained)] / plain.frequency - 1
    assert np.all(gained > -1e-9)
    assert np.max(gained[:11]) > 20 * np.median(gained[:11])
    assert np.max(moved[:11]) > 0.02


def test_in_a_series_an_effect_acts_wherever_its_part_exists() -> None:
    plans = [Plan(article=name) for name in ("fmd+disc+cuboid", "fmd+clumod-1", "fmd+clumod-4", "fmd")]
    effects = parse_all(
        ["point-mass:lower-2+=0.1", "modulus:mast=0.1", "mounting-offset:x=0.001", "force-gain:fmd-z1=0.1", "gravity=0"]
    )
    ids = [[named.family for named in reaching(effects, plan)] for plan in plans]
    assert ids == [
        ["mounting-offset", "force-gain", "gravity"],
        ["modulus", "mounting-offset", "force-gain", "gravity"],
        ["point-mass", "modulus", "mounting-offset", "force-gain", "gravity"],
        ["force-gain", "gravity"],
    ]


@pytest.mark.parametrize(
    ("effect", "plan", "says"),
    [
        ("point-mass:mast-top=1", {"article": "fmd+cuboid"}, "fmd+cuboid has no place 'mast-top'. Known are top, top-1"),
        ("modulus:lower-2=0.1", {"article": "fmd+clumod-1"}, "fmd+clumod-1 has no part 'lower-2'. Did you mean lower-1?"),
        ("modulus:mast=0.1", {"article": "fmd+clumod-1", "model": RIGID}, "the parts of a rigid article do not give"),
        ("mounting-offset:x=0.01", {"article": "fmd"}, "nothing stands on the cover plate of fmd"),
    ],
)
def test_an_effect_that_acts_nowhere_is_refused(effect: str, plan: dict[str, str], says: str) -> None:
    with pytest.raises(BadInput, match="--effect: ") as refused:
        require_reaching(parse_all([effect]), [Plan(**plan)])  # type: ignore[arg-type]
    assert says in str(refused.value)


def test_damping_of_parts_beside_damping_of_modes_is_refused() -> None:
    plan = Plan(article="fmd+clumod-1", damping=Damping(ratio=0.01))
    with pytest.raises(BadInput, match="states the damping of every mode"):
        require_reaching(parse_all(["structural-damping:mast=0.01"]), [plan])


@pytest.mark.parametrize(
    ("effect", "says"),
    [
        ("structural-damping:mast=0.01", "states the damping of every mode"),
        ("layer-damping:upper-short=0.01", "fmd+clumod-1 has no part 'upper-short'"),
        ("point-mass:lower-2+=0.1", "fmd+clumod-1 has no place 'lower-2+'"),
        ("modulus:lower-2=0.1", "fmd+clumod-1 has no part 'lower-2'. Did you mean lower-1?"),
    ],
)
def test_what_cannot_act_is_refused_by_the_simulation_itself(effect: str, says: str) -> None:
    """Without the command line before it: once nothing happened, or a bare KeyError."""
    plan = Plan(article="fmd+clumod-1", damping=Damping(ratio=0.01), effects=planted(parse_all([effect])))
    with pytest.raises(BadInput, match="virtual test: ") as refused:
        simulate(plan)
    assert says in str(refused.value)


def test_an_effect_of_no_family_is_its_makers_own_affair() -> None:
    plan = Plan(article="fmd+clumod-1", effects=(PlantedEffect(id="mine:nowhere"),))
    assert laboratory(plan).made.modes is not None


def test_an_effect_on_a_part_is_one_on_all_of_its_sheets_and_not_on_its_layer() -> None:
    names = ("mast", "upper-short-bottom", "upper-short-silicone", "upper-short-top")
    parts = {name: Part(modulus=0.02, loss=0.1) for name in names}
    touched = {}
    for text in ("modulus:upper-short=0.1", "structural-damping:upper-short=0.1", "layer-damping:upper-short=0.1"):
        (effect,) = planted(parse_all([text]))
        after = effect.parts(parts)
        touched[text.partition(":")[0]] = [name for name in names if after[name] != parts[name]]
    sheets = ["upper-short-bottom", "upper-short-top"]
    assert touched == {"modulus": sheets, "structural-damping": sheets, "layer-damping": ["upper-short-silicone"]}
    (effect,) = planted(parse_all(["modulus:mast=0.1"]))
    assert effect.parts(parts)["mast"].modulus == pytest.approx(1.02 * 1.1 - 1, rel=1e-12)
