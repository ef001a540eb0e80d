"""Facts about the article: against the drawing, against closed forms, against finite differences."""

from collections.abc import Callable
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from identification.quality import NORMAL_95
from validation.classical.pendulum import plane_amplitude_factor
from validation.prediction.classical_facts import ArticleFact, facts

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
def compound(tmp_path: Path) -> Callable[[float], str]:
    """``compound(period)``: a file of the Cuboid on a pivot."""

    def made(period: float) -> str:
        path = tmp_path / "pivot.toml"
        path.write_text(COMPOUND.format(period=period), encoding="utf-8")
        return str(path)

    return made


def test_published_values_are_met_by_the_reconstruction(model: Any) -> None:
    """To what `massline reference` shows: tolerances of the mass, of the crane and of the pendulum."""
    found = {one.name: one.residual({})[0] for one in facts(model(), SHIPPED)}
    assert len(found) == 5
    assert max(abs(z) for z in found.values()) < 2 * NORMAL_95, found


def test_a_point_mass_weighs_and_shifts(model: Any, added: Any) -> None:
    plain, loaded = (facts(model(effects=effects), SHIPPED[:2]) for effects in ((), added("point-mass:mast-top=0.5")))
    name = "point-mass:mast-top"
    (m0, z0), (m1, z1) = ([(one.residual({name: 0.5})[0] * one.deviation + one.value) for one in of] for of in (plain, loaded))
    assert_allclose(m1 - m0, 0.5, rtol=1e-12)
    from geometry.articles.locations import locations

    top = locations("clumod-4")["mast-top"][2]
    assert_allclose(z1, (m0 * z0 + 0.5 * top) / (m0 + 0.5), rtol=1e-12)


def test_what_swings_on_the_shaker_is_not_there_on_the_balance(model: Any, added: Any) -> None:
    (one,) = facts(model(effects=added("appendage:z=m:0.5,f:20,zeta:0.01", "force-gain:fmd-z1=0.1")), SHIPPED[:1])
    assert one.parameters == ()


EFFECTS = (
    *("rigid-inertia:Ixx=0.2", "rigid-inertia:mz=0.1", "point-mass:mast-top=0.3"),
    *("pendulum-amplitude=0.2", "pendulum-damping=0.05", "rope-mass=0.3", "rope-elasticity=2e-6", "air-inertia=0.01"),
)


def test_derivatives_are_those_of_finite_differences(model: Any, added: Any) -> None:
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


def test_a_wide_swing_is_predicted_to_take_longer(model: Any, added: Any, compound: Any) -> None:
    """A pivot swinging at 0.3 rad measures as one of small swings whose period is shorter by 2 K / pi."""
    factor = plane_amplitude_factor(0.3)
    (small,) = facts(model(), [compound(1.25)])
    expected = _inertia(small, {})
    (wide,) = facts(model(effects=added("pendulum-amplitude=0.3")), [compound(round(1.25 * factor, 12))])
    assert_allclose(_inertia(wide, {"pendulum-amplitude": 0.3}), expected, rtol=1e-9)
    assert abs(_inertia(wide, {}) - expected) > 1e-3 * expected


def test_effects_of_ropes_do_nothing_to_a_pivot(model: Any, added: Any, compound: Any) -> None:
    (fact,) = facts(model(effects=added("rope-mass=0.3", "pendulum-damping=0.02")), [compound(1.25)])
    assert [one.name for one in fact.parameters] == ["pendulum-damping"]


def test_the_fmd_is_not_weighed_by_a_model(model: Any, tmp_path: Path) -> None:
    path = tmp_path / "fmd.toml"
    path.write_text(FMD_WEIGHED, encoding="utf-8")
    with pytest.raises(BadInput, match="FMD's inertia only by its tare"):
        facts(model(), [str(path)])
