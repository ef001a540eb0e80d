"""Weights and periods beside a campaign: they decide what spectra leave open, contradict by name, and have their own effects."""

from collections.abc import Callable
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.classical.pendulum import rope_amplitude_factor, rope_pendulum
from validation.diagnose.candidates import candidates, screen
from validation.diagnose.diagnosis import Candidate, Screened
from validation.diagnose.pendulum import advised, against, contradictions
from validation.diagnose.search import fit_with
from validation.effects.catalogue import parse
from validation.estimation.result import Fit
from validation.model.model import Added, Model
from validation.study import Data, Study
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import VirtualTest, simulate

BALANCE = 0.05
"""Per cent."""

MODEL = Model(source="model.toml", title="", article="fmd+cuboid", cell_stiffness=np.array((4e8, 4e8, 2e9)))

Made = Callable[..., Study]


@pytest.fixture(scope="module")
def test_of_cuboid() -> VirtualTest:
    """A Cuboid on the shaker, ordinary tolerances, nothing planted, in fast sweeps."""
    return simulate(Plan(article="fmd+cuboid", seed=3, octaves_per_minute=60.0, quiet=0.3))


@pytest.fixture(scope="module")
def body() -> tuple[float, float]:
    """Mass [kg] and moment of inertia about z [kg m²] of the Cuboid as drawn."""
    from geometry import routes
    from geometry.articles import built_in

    inertia = routes.inertia(built_in("cuboid"))
    return float(inertia.mass), float(inertia.tensor_cog[2, 2])


@pytest.fixture
def made(test_of_cuboid: VirtualTest, tmp_path: Path) -> Made:
    """``made(text of a file, ...)``: the campaign and these files on a bench."""

    def of(*texts: str) -> Study:
        paths = [tmp_path / f"file-{k}.toml" for k in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            path.write_text(text, encoding="utf-8")
        return Study.of(MODEL, Data(campaigns=(test_of_cuboid.campaign,), classical=tuple(map(str, paths))))

    return of


def weighed(mass: float) -> str:
    head = 'format = 1\nkind = "weighing"\n[article]\nname = "cuboid"\n'
    return f'{head}[balance]\nresolution = "1 g"\nrelative_error = "{BALANCE} %"\n[[reading]]\ngross = "{mass:.6f} kg"\n'


def swung(mass: float, moment: float, amplitude: float) -> str:
    """On three ropes, so wide, which the file does not say."""
    radius, length, gravity = 0.1, 2.0, 9.81
    small = np.sqrt(moment / rope_pendulum(mass=mass, gravity=gravity, s1=radius, s2=radius, length=length, period=1.0))
    period = small * rope_amplitude_factor(amplitude, (radius / length) ** 2, mass * radius**2 / moment)
    return (
        f'format = 1\nkind = "pendulum"\ngravity = "{gravity} m/s^2"\n'
        f'[article]\nname = "cuboid"\nmass = "{mass:.9f} +/- 0.002 kg"\n'
        f'[[swing]]\nabout = "z"\nsuspension = "ropes"\nrope_length = "{length} +/- 0.0005 m"\nradius = "{radius} +/- 0.0001 m"\n'
        f'period = "{period:.9f} +/- 0.0002 s"\n'
    )


def by_id(found: tuple[Screened, ...]) -> dict[str, Screened]:
    return {one.id: one for one in found}


@pytest.fixture(scope="module")
def fitted(test_of_cuboid: VirtualTest) -> Fit:
    """Of the campaign. Facts do not move it: no free parameter of the model as it is weighs anything on a balance."""
    return Study.of(MODEL, Data(campaigns=(test_of_cuboid.campaign,))).all_free()


def standing(of: Study, fitted: Fit) -> Candidate:
    return Candidate(effects=(), fit=fitted, problem=of.problem())


def of_mass(of: Study, fitted: Fit) -> Screened:
    return by_id(screen(of, standing(of, fitted), candidates(of, only=("rigid-inertia:m",))))["rigid-inertia:m"]


def test_a_balance_says_what_a_campaign_alone_cannot(made: Made, fitted: Fit, body: tuple[float, float]) -> None:
    """The FMD below is known to 5 %, force channels to a few parts in a thousand: together they hide what a balance shows."""
    alone, together = of_mass(made(), fitted), of_mass(made(weighed(body[0])), fitted)
    sd = BALANCE / 100 / 1.96 * body[0]
    assert together.told.deviation < 1.1 * np.hypot(sd, 5e-4)  # half a digit of the display beside it
    assert alone.told.deviation > 10 * together.told.deviation
    # two independent measurements of one number: their information adds
    added = 1 / (together.told.information - alone.told.information)
    assert_allclose(np.sqrt(added), np.hypot(sd, 0.5e-3 / 1.96), rtol=1e-3)


def test_what_is_weighed_is_named(made: Made, fitted: Fit, body: tuple[float, float]) -> None:
    found = of_mass(made(weighed(body[0] + 0.1)), fitted)
    assert found.evidence > 20
    assert_allclose(found.added.named.value, 0.1, atol=0.02)


def test_a_weight_that_contradicts_the_campaign_is_named_with_both_figures(
    made: Made, fitted: Fit, body: tuple[float, float]
) -> None:
    of = made(weighed(body[0] + 1.0))
    base = standing(of, fitted)
    (text,) = contradictions(of, base, base)
    (one,) = against(of, base)
    assert abs(one.sigma) > 4
    assert "the campaigns disagree by" in text
    assert f"{abs(one.sigma):.0f} sigma" in text
    assert_allclose(one.measured, body[0] + 1.0, atol=1e-6)
    # the truth is the drawing within a part in a thousand of scatter: the campaign says so within its own tolerance
    assert abs(one.said - body[0]) < 4 * one.said_sd


def test_a_fault_of_the_measurement_that_settles_it_is_said(made: Made, fitted: Fit, body: tuple[float, float]) -> None:
    of = made(weighed(body[0] + 1.0))
    base = standing(of, fitted)
    named = parse("gravity=1")
    (text,) = contradictions(of, base, Candidate(effects=(Added(named=named),), fit=base.fit, problem=base.problem))
    assert text.endswith("; with gravity they still disagree")


def test_a_weight_that_agrees_says_nothing(made: Made, fitted: Fit, body: tuple[float, float]) -> None:
    of = made(weighed(body[0]))
    base = standing(of, fitted)
    assert contradictions(of, base, base) == ()


def test_effects_of_a_pendulum_are_tried_where_a_swing_is_among_the_files(made: Made, body: tuple[float, float]) -> None:
    of = made(swung(*body, 0.4))
    base = standing(of, of.all_free())
    menu = candidates(of, only=("pendulum-amplitude", "pendulum-damping", "force-gain"))
    found = by_id(screen(of, base, menu))
    wide = found["pendulum-amplitude"]
    assert wide.evidence > 100
    assert_allclose(wide.added.named.value, 0.4, rtol=0.03)
    child = fit_with(of, base, wide.added)
    assert_allclose(child.effects[0].named.value, 0.4, rtol=0.03)
    # the integral over the size and Laplace's approximation of it differ by the normalisation of a half prior
    assert_allclose(child.fit.log_evidence - base.fit.log_evidence, wide.evidence, atol=1.0)
    assert not any(one.named.family.startswith("pendulum") for one in candidates(made()))
    best = advised(of, base, ("pendulum-amplitude", "rope-mass"))[0]
    assert set(best.separates) <= {"pendulum-amplitude", "rope-mass"}
    assert best.gain > 5
