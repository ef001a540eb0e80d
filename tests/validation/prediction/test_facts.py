"""Weighing and pendulum beside the spectra, and effects that leave no body."""

import warnings
from collections.abc import Callable
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from geometry.sensors import ChannelTable
from identification.campaign import Campaign
from identification.quality import NORMAL_95
from validation.classical.pendulum import plane_amplitude_factor
from validation.cli import main
from validation.effects.catalogue import parse
from validation.effects.effect import Vocabulary
from validation.model.model import Added, Model
from validation.prediction.classical_facts import ArticleFact, facts, require_bodies
from validation.prediction.mounting import drawn_inertia
from validation.virtual_test.layout import mavis
from validation.virtual_test.plan import Plan
from validation.virtual_test.shaker import middles_of_cells

SHIPPED = ("clumod-4-weighing", "clumod-4-cog", "clumod-4-pendulum")

COMPOUND = """format = 1
kind = "pendulum"
gravity = "9.81 m/s^2"
[article]
name = "cuboid"
mass = "12.1 +/- 0.01 kg"
[[swing]]
about = "x"
suspension = "compound"
arm = "0.3 m"
period = "{period} +/- 0.001 s"
"""

FMD_WEIGHED = """format = 1
kind = "weighing"
[article]
name = "fmd"
[balance]
resolution = "0.1 kg"
relative_error = "0.1 %"
[[reading]]
gross = "30 kg"
"""


@pytest.fixture
def compound(tmp_path) -> Callable[[float], str]:
    """``compound(period)``: a file of the Cuboid on a pivot."""

    def made(period: float) -> str:
        path = tmp_path / "pivot.toml"
        path.write_text(COMPOUND.format(period=period), encoding="utf-8")
        return str(path)

    return made


def test_published_values_are_met_by_the_reconstruction_and_a_point_mass_weighs_and_shifts(model, added):
    """To what `massline reference` shows: tolerances of the mass, of the crane and of the pendulum."""
    found = {one.name: one.residual({})[0] for one in facts(model(), SHIPPED)}
    assert len(found) == 5
    assert max(abs(z) for z in found.values()) < 2 * NORMAL_95, found
    plain, loaded = (facts(model(effects=effects), SHIPPED[:2]) for effects in ((), added("point-mass:mast-top=0.5")))
    name = "point-mass:mast-top"
    (m0, z0), (m1, z1) = ([(one.residual({name: 0.5})[0] * one.deviation + one.value) for one in of] for of in (plain, loaded))
    assert_allclose(m1 - m0, 0.5, rtol=1e-12)
    from geometry.articles import locations

    top = locations("clumod-4")["mast-top"][2]
    assert_allclose(z1, (m0 * z0 + 0.5 * top) / (m0 + 0.5), rtol=1e-12)


def test_what_swings_on_the_shaker_is_not_on_the_balance_and_ropes_do_nothing_to_a_pivot(model, added, compound):
    (one,) = facts(model(effects=added("appendage:z=m:0.5,f:20,zeta:0.01", "force-gain:fmd-z1=0.1")), SHIPPED[:1])
    assert one.parameters == ()
    (fact,) = facts(model(effects=added("rope-mass=0.3", "pendulum-damping=0.02")), [compound(1.25)])
    assert [one.name for one in fact.parameters] == ["pendulum-damping"]


EFFECTS = (
    *("rigid-inertia:Ixx=0.2", "rigid-inertia:mz=0.1", "point-mass:mast-top=0.3"),
    *("pendulum-amplitude=0.2", "pendulum-damping=0.05", "rope-mass=0.3", "rope-elasticity=2e-6", "air-inertia=0.01"),
)


def test_derivatives_are_those_of_finite_differences(model, added):
    for fact in facts(model(effects=added(*EFFECTS, "off-centre-suspension=0.02")), SHIPPED):
        start = {one.name: one.start for one in fact.parameters}
        _, changes = fact.residual(start)
        assert set(changes) == set(start)
        for one in fact.parameters:
            h = 1e-3 * one.tolerance
            above, below = (fact.residual({**start, one.name: one.start + side * h})[0] for side in (1, -1))
            assert_allclose(changes[one.name], (above - below) / (2 * h), rtol=1e-4, atol=1e-6)


def _inertia(fact: ArticleFact, offsets: dict[str, float]) -> float:
    """What the measurement comes down to."""
    predicted = fact.weights @ _quantities(fact)
    return float(predicted - fact.residual(offsets)[0] * fact.deviation)


def _quantities(fact: ArticleFact) -> np.ndarray:
    from identification.request import quantities

    return quantities(fact.of.at({})[0])


def test_a_wide_swing_is_predicted_to_take_longer(model, added, compound):
    """A pivot swinging at 0.3 rad measures as one of small swings whose period is shorter by 2 K / pi."""
    factor = plane_amplitude_factor(0.3)
    (small,) = facts(model(), [compound(1.25)])
    expected = _inertia(small, {})
    (wide,) = facts(model(effects=added("pendulum-amplitude=0.3")), [compound(round(1.25 * factor, 12))])
    assert_allclose(_inertia(wide, {"pendulum-amplitude": 0.3}), expected, rtol=1e-9)
    assert abs(_inertia(wide, {}) - expected) > 1e-3 * expected


def test_the_fmd_is_not_weighed_by_a_model(model, tmp_path):
    path = tmp_path / "fmd.toml"
    path.write_text(FMD_WEIGHED, encoding="utf-8")
    with pytest.raises(BadInput, match="FMD's inertia only by its tare"):
        facts(model(), [str(path)])


ANY = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)

MakeCampaign = Callable[[str], Campaign]


@pytest.fixture(scope="module")
def table() -> ChannelTable:
    return mavis(middles_of_cells(Plan(article="fmd+cuboid")), {}).table


@pytest.fixture
def campaign(table) -> MakeCampaign:
    return lambda article: Campaign(article=article, title="", table=table, runs=(), source="one", gravity=9.81)


def model(*effects: str, fixed: bool = False, **changes: Any) -> Model:
    added = tuple(Added(named=parse(text, ANY), fixed=fixed) for text in effects)
    return Model(**{"source": "lab.toml", "title": "", "article": "fmd+cuboid", "effects": added, **changes})


@pytest.mark.parametrize("fixed", [False, True])
@pytest.mark.parametrize("kind", ["rigid", "beam"])
@pytest.mark.parametrize(
    ("effects", "words"),
    [
        (("rigid-inertia:m=-100",), "the mass must be positive, found -"),
        (("rigid-inertia:Ixx=-50",), "break the triangle inequality"),
        (("rigid-inertia:Ixy=5",), "break the triangle inequality"),
        (("point-mass:top=-90",), "the mass must be positive"),
    ],
)
def test_what_leaves_no_body_is_refused_by_name_with_what_results(effects, words, kind, fixed, campaign):
    with pytest.raises(BadInput) as caught:
        require_bodies(model(*effects, kind=kind, fixed=fixed), [campaign("fmd"), campaign("fmd+cuboid")])
    assert caught.value.field == f"effect {effects[0].partition('=')[0]}"
    assert "no body is left of fmd+cuboid" in caught.value.problem
    assert words in caught.value.problem


def test_effects_are_judged_together(campaign):
    longer = ("rigid-inertia:Ixx=2", "rigid-inertia:Iyy=2")
    require_bodies(model(*longer, kind="rigid"), [campaign("fmd+cuboid")])
    for one in longer:
        with pytest.raises(BadInput, match="triangle inequality"):
            require_bodies(model(one, kind="rigid"), [campaign("fmd+cuboid")])


@pytest.mark.parametrize(
    "effects",
    [
        ("force-gain:fmd-z2=0.08",),
        ("rigid-inertia:m=-0.1",),
        ("point-mass:mast-top=-0.2",),  # nothing of the Cuboid is there
    ],
)
def test_what_leaves_a_body_passes(effects, campaign):
    require_bodies(model(*effects, kind="rigid"), [campaign("fmd"), campaign("fmd+cuboid")])


def test_the_limit_is_the_mass_of_the_article(campaign):
    of = drawn_inertia(model(kind="rigid"), "cuboid")
    # what is taken away at the centre of gravity leaves the moments about it
    require_bodies(model(f"rigid-inertia:m={-0.999 * of.mass!r}", kind="rigid"), [campaign("fmd+cuboid")])
    with pytest.raises(BadInput):
        require_bodies(model(f"rigid-inertia:m={np.nextafter(-of.mass, -1e9)!r}", kind="rigid"), [campaign("fmd+cuboid")])


def test_warnings_of_the_arithmetic_never_reach_the_terminal(monkeypatch, capsys):
    def overflows(arguments=None):
        warnings.warn("overflow encountered in exp", RuntimeWarning, stacklevel=1)
        return main.DONE

    monkeypatch.setattr(main, "run", overflows)
    monkeypatch.setattr("sys.warnoptions", [])
    with pytest.raises(SystemExit) as left:
        main.main([])
    assert left.value.code == main.DONE
    assert capsys.readouterr().err == ""
