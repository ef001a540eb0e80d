"""Structural effects hold their equations of the catalogue: on the rig that is driven, seen as the dynamic mass about F."""

from collections.abc import Callable
from dataclasses import replace
from functools import cache

import numpy as np
import numpy.typing as npt
import pytest
from numpy.testing import assert_allclose

from fem.damping import Damping
from geometry.articles import locations
from geometry.errors import BadInput
from geometry.frames import rigid_transformation, rotation_about
from validation.effects.catalogue import parse_all
from validation.virtual_test.plan import RIGID, Part, Plan, PlantedEffect, exact
from validation.virtual_test.planted import planted, reaching, require_reaching
from validation.virtual_test.simulate import ShakerLaboratory, laboratory, simulate

Lab = Callable[..., ShakerLaboratory]


@pytest.fixture(scope="session")
def lab() -> Lab:
    """``lab(article, *effects)``: a laboratory without errors."""

    @cache
    def make(article: str, *effects: str, model: str = "beam") -> ShakerLaboratory:
        return laboratory(replace(exact(Plan(article=article, model=model)), effects=planted(parse_all(effects))))

    return make


def close(found: npt.ArrayLike, expected: npt.ArrayLike, share: float = 1e-9) -> None:
    """Equal to `share` of the largest expected value."""
    assert_allclose(found, expected, rtol=0, atol=share * np.max(np.abs(expected)))


def test_a_point_mass_lowers_a_mode_by_half_m_phi_squared(lab):
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


def test_no_more_mass_can_be_taken_away_than_there_is_and_of_a_shift_the_campaign_does_not_know(lab):
    lab("fmd+disc+cuboid", "point-mass:top=-1", model=RIGID)
    with pytest.raises(BadInput, match="would have a negative mass in some direction"):
        lab("fmd+disc+cuboid", "point-mass:top=-100", model=RIGID)
    assert_allclose(lab("fmd+clumod-1", "mounting-offset:x=0.004").made.rig.seat, lab("fmd+clumod-1").rig.seat, rtol=0, atol=0)


def test_a_turned_articles_places_turn_with_it(lab):
    before, after = lab("fmd+clumod-1").rig, lab("fmd+clumod-1", "orientation:z=0.3").rig
    R = rotation_about("z", 0.3)
    turned = R @ locations("clumod-1")["lower-1+"]
    close(after.article.places["lower-1+"][:, :6], rigid_transformation(turned), 1e-6)
    close(after.article.places["lower-1+"][:, 6:], R @ before.article.places["lower-1+"][:, 6:])


def test_moduli_of_all_parts_together_shift_every_frequency_alike(lab):
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


def test_loss_of_all_parts_together_adds_half_to_every_damping_ratio(lab):
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


def test_the_layer_damps_its_own_blade(lab):
    plain, damped, stiffer = (
        lab("fmd+clumod-4", *e).made.modes for e in ((), ("layer-damping:upper-short=0.1",), ("modulus:upper-short=0.1",))
    )
    gained = damped.damping_ratio - plain.damping_ratio
    moved = stiffer.frequency[: len(gained)] / plain.frequency - 1
    assert np.all(gained > -1e-9)
    assert np.max(gained[:11]) > 20 * np.median(gained[:11])
    assert np.max(moved[:11]) > 0.02


def test_in_a_series_an_effect_acts_wherever_its_part_exists():
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
def test_an_effect_that_acts_nowhere_is_refused(effect, plan, says):
    with pytest.raises(BadInput, match="--effect: ") as refused:
        require_reaching(parse_all([effect]), [Plan(**plan)])  # type: ignore[arg-type]
    assert says in str(refused.value)


def test_damping_of_parts_beside_damping_of_modes_is_refused():
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
def test_what_cannot_act_is_refused_by_the_simulation_itself(effect, says):
    """Without the command line before it: once nothing happened, or a bare KeyError."""
    plan = Plan(article="fmd+clumod-1", damping=Damping(ratio=0.01), effects=planted(parse_all([effect])))
    with pytest.raises(BadInput, match="virtual test: ") as refused:
        simulate(plan)
    assert says in str(refused.value)


def test_an_effect_of_no_family_is_its_makers_own_affair():
    plan = Plan(article="fmd+clumod-1", effects=(PlantedEffect(id="mine:nowhere"),))
    assert laboratory(plan).made.modes is not None


def test_an_effect_on_a_part_is_one_on_all_of_its_sheets_and_not_on_its_layer():
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
