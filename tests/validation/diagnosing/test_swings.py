"""Classical measurements diagnosed by themselves: what was planted comes back where it can be told, and its aliases where not."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from geometry.errors import BadInput
from validation.classical.pendulum import rope_pendulum
from validation.diagnose.classical import answering, candidates, judged, observed, pendulum_candidates
from validation.diagnose.diagnosis import AMBIGUOUS, MISSING, NOTHING, SEVERAL, UNKNOWN, SwingAnswer
from validation.diagnose.pendulum import only_classical
from validation.effects.catalogue import FAMILIES, parse_all
from validation.effects.stages import PendulumSwing as Stage
from validation.model.model import Added, Model
from validation.prediction.classical_facts import facts

G = 9.81
HEAD = """format = 1
kind = "pendulum"
gravity = "{gravity} +/- 0.0002 m/s^2"
[article]
name = "clumod-4"
mass = "{mass!r} +/- 0.001 kg"
[corrections]
amplitude = {corrected}
"""
SWING = """[[swing]]
about = "z"
suspension = "ropes"
rope_length = "{length!r} +/- 0.0001 m"
radius = "{radius!r} +/- 0.00002 m"
period = "{period!r} +/- 0.00005 s"
"""

LENGTHS, RADII, AMPLITUDES = (2.0, 1.0, 2.0, 2.0), (0.3, 0.3, 0.18, 0.3), (0.05, 0.05, 0.05, 0.3)
"""Four swings: as they are, on shorter ropes, on ropes nearer to the axis, and wide."""


@pytest.fixture(scope="module")
def clumod() -> Model:
    return Model(source="model.toml", title="Clumod", article="fmd+clumod-4")


@pytest.fixture(scope="module")
def body() -> tuple[float, float]:
    """Mass [kg] and moment of inertia about z [kg m²] of Clumod as drawn."""
    from geometry import routes
    from geometry.articles import built_in

    inertia = routes.inertia(built_in("clumod-4"))
    return float(inertia.mass), float(inertia.tensor_cog[2, 2])


Write = Callable[..., str]


@pytest.fixture
def write(tmp_path: Path, body: tuple[float, float]) -> Write:
    """``write(effects, which swings, amplitudes stated, corrected for)``: a file of swings in which the effects are there."""

    def made(effects: dict[str, float], swings: tuple[int, ...] = (0,), *, stated: bool = False, corrected: bool = False) -> str:
        mass, moment = body
        text = HEAD.format(gravity=G, mass=mass, corrected=str(corrected).lower())
        for k in swings:
            length, radius, amplitude = LENGTHS[k], RADII[k], AMPLITUDES[k]
            period = float(np.sqrt(moment / rope_pendulum(mass=mass, gravity=G, s1=radius, s2=radius, length=length, period=1.0)))
            at = Stage(period=period, mass=mass, inertia=moment, ropes=3, length=length, radii=np.full(3, radius), gravity=G)
            for name, size in effects.items():
                share = {"rope-mass": length / 2, "rope-elasticity": length / 2, "pendulum-amplitude": amplitude / 0.3}
                at = FAMILIES[name].change(at, (), {"": size * share.get(name, 1.0)})
            text += SWING.format(length=length, radius=radius, period=at.period)
            text += f'amplitude = "{amplitude!r} +/- 0.002 rad"\n' if stated else ""
        path = tmp_path / "swings.toml"
        path.write_text(text, encoding="utf-8")
        return str(path)

    return made


def by_id(found: SwingAnswer) -> dict[str, Any]:
    return {one.id: one for one in found.needed}


SIZES = {
    "pendulum-amplitude": 0.3,
    "pendulum-damping": 0.06,
    "rope-mass": 0.6,
    "rope-elasticity": 1.2e-5,
    "air-inertia": 0.01,
    "off-centre-suspension": 0.03,
}
"""All six of the catalogue, at sizes that one precise period shows."""


@pytest.mark.parametrize("name", ["pendulum-amplitude", "rope-mass", "air-inertia"])
def test_one_period_needs_the_planted_size_of_the_planted_effect_and_calls_all_others_aliases(
    clumod: Model, write: Write, name: str
) -> None:
    found = only_classical(clumod, [write({name: SIZES[name]}, (3,) if name == "pendulum-amplitude" else (0,))])
    needed = by_id(found)
    assert_allclose(needed[name].value, SIZES[name], rtol=1e-3)  # polynomials of tenth degree; periods to all digits
    assert set(SIZES) <= set(needed)
    possible = [one for one in found.needed if one.possible]
    assert len(possible) > 2
    assert all(one.fits for one in possible)
    assert found.verdict == AMBIGUOUS
    assert "One period is one number" in found.text
    assert found.next_measurement


def test_a_period_as_the_model_has_it_misses_nothing_and_says_what_it_could_not_have_seen(clumod: Model, write: Write) -> None:
    found = only_classical(clumod, [write({})])
    assert found.verdict == NOTHING
    assert found.equivalence_class == ()
    assert "One period is one number" in found.text
    smallest = {one.id: one.size for one in found.detectable}
    # planted at what would have been named, it is: a period's tolerance alone decides
    again = only_classical(clumod, [write({"off-centre-suspension": 1.02 * smallest["off-centre-suspension"]})])
    assert again.verdict != NOTHING


def test_a_period_too_short_is_no_effect_of_ropes_or_air(clumod: Model, write: Write, body: tuple[float, float]) -> None:
    path = Path(write({}))
    text = path.read_text(encoding="utf-8")
    period = float(text.split('period = "')[1].split(" ")[0])
    path.write_text(text.replace(repr(period), repr(0.99 * period)), encoding="utf-8")
    needed = by_id(only_classical(clumod, [str(path)]))
    for name in SIZES:
        assert not needed[name].possible, name
        assert "other way" in needed[name].text
    assert needed["rigid-inertia:Izz"].possible


@pytest.mark.parametrize(
    ("name", "swings", "stated"),
    [("pendulum-amplitude", (0, 3), True), ("off-centre-suspension", (0, 1, 2), False), ("rope-mass", (0, 1, 2), False)],
)
def test_swings_that_differ_name_what_is_missing_and_its_size(
    clumod: Model, write: Write, name: str, swings: tuple[int, ...], stated: bool
) -> None:
    found = only_classical(clumod, [write({name: SIZES[name]}, swings, stated=stated)])
    assert (found.verdict, found.equivalence_class) == (MISSING, (name,))
    (cause,) = found.accepted
    (size,) = cause.sizes
    assert size.low < SIZES[name] < size.high
    assert cause.null
    assert any("amplitude = true takes it off" in text for text in found.remarks) == stated


def test_stretch_and_a_heavier_body_stay_aliases_on_any_ropes(clumod: Model, write: Write) -> None:
    """Both lengthen every period by the same share."""
    found = only_classical(clumod, [write({"rope-elasticity": SIZES["rope-elasticity"]}, (0, 1, 2))])
    assert found.verdict == AMBIGUOUS
    assert {"rope-elasticity", "rigid-inertia:Izz"} <= set(found.equivalence_class)
    assert "off-centre-suspension" not in found.equivalence_class
    best = found.advice[0]
    assert "load" in best.test or "mass" in best.test


def test_a_stated_amplitude_that_is_corrected_for_is_no_effect_any_more(clumod: Model, write: Write) -> None:
    found = only_classical(clumod, [write({"pendulum-amplitude": 0.3}, (0, 3), stated=True, corrected=True)])
    assert found.verdict == NOTHING
    assert "pendulum-amplitude" not in by_id(found)


def test_two_effects_at_once_are_both_named(clumod: Model, write: Write) -> None:
    both = {"pendulum-amplitude": 0.3, "off-centre-suspension": 0.03}
    found = only_classical(clumod, [write(both, (0, 1, 2, 3), stated=True)])
    assert found.verdict == SEVERAL
    assert {one.id for one in found.accepted} == set(both)
    for one in found.accepted:
        assert one.sizes[0].low < both[one.id] < one.sizes[0].high


def test_swings_that_contradict_each_other_are_unknown_and_named(clumod: Model, write: Write) -> None:
    path = Path(write({}, (0, 0)))
    head, one, other = path.read_text(encoding="utf-8").split("[[swing]]")
    period = float(one.split('period = "')[1].split(" ")[0])
    swings = [part.replace(repr(period), repr(factor * period)) for part, factor in ((one, 1.01), (other, 0.99))]
    path.write_text("[[swing]]".join([head, *swings]), encoding="utf-8")
    found = only_classical(clumod, [str(path)])
    assert found.verdict == UNKNOWN
    assert "swing 1" in found.leftover.text
    assert "says of nothing in which they differ" in found.leftover.text
    assert found.next_measurement


def test_swings_on_the_same_ropes_share_the_tolerance_of_their_length(clumod: Model, write: Write) -> None:
    one, other = facts(clumod, [write({}, (0, 3), stated=True)])
    of = observed((one, other), ())
    apart = of.covariance[0, 0] + of.covariance[1, 1] - 2 * of.covariance[0, 1]
    # what is left of two periods is that of the periods, 5e-5 s of 2 s: a part in 2e4 of the inertia, at 95 %
    period = float(one.swing.pendulum.period.nominal_value)
    expected = (2 * 5e-5 / 1.96 / period * one.value) ** 2 * 2
    assert_allclose(apart, expected, rtol=2e-2)  # the amplitude makes the second period a little longer
    assert apart < 0.2 * of.covariance[0, 0]


def test_nothing_is_named_where_tolerances_are_all_that_is_wrong(clumod: Model, write: Write) -> None:
    found = facts(clumod, [write({}, (0, 1, 2))])
    of = observed(found, ())
    answers = answering(of, candidates(found))
    half = np.linalg.cholesky(of.covariance)
    rng = np.random.default_rng(5)
    verdicts = [judged(answers, half @ rng.normal(size=3), of.precision).verdict for _ in range(60)]
    assert verdicts.count(NOTHING) == 60


def test_a_weight_alone_says_how_much_and_not_where(clumod: Model, tmp_path: Path, body: tuple[float, float]) -> None:
    path = tmp_path / "weighed.toml"
    path.write_text(
        f'format = 1\nkind = "weighing"\n[article]\nname = "clumod-4"\n[balance]\nresolution = "1 g"\nrelative_error = "0.01 %"\n'
        f'[[reading]]\ngross = "{body[0] + 0.25:.6f} kg"\n',
        encoding="utf-8",
    )
    found = only_classical(clumod, [str(path)])
    assert found.verdict == AMBIGUOUS
    assert found.equivalence_class[0] == "rigid-inertia:m" or "rigid-inertia:m" in found.equivalence_class
    assert_allclose(by_id(found)["rigid-inertia:m"].value, 0.25, atol=1e-3)
    assert "250 g more than the model's" in found.text
    (wrong,) = [one for one in found.readings if one.name == "balance relative error"]
    assert wrong.tolerances < -50


def test_candidates_of_a_pendulum_are_those_that_were_not_taken_off(clumod: Model, write: Write) -> None:
    plain = pendulum_candidates(facts(clumod, [write({})]))
    assert {one.named.family for one in plain} == set(SIZES)
    taken = pendulum_candidates(facts(clumod, [write({}, stated=True, corrected=True)]))
    assert {one.named.family for one in taken} == set(SIZES) - {"pendulum-amplitude"}


def test_what_the_model_has_already_is_not_missing(clumod: Model, write: Write) -> None:
    known = tuple(Added(named=one) for one in parse_all(["off-centre-suspension=0.03"]))
    found = only_classical(replace(clumod, effects=known), [write({"off-centre-suspension": 0.03}, (0, 1, 2))])
    assert found.verdict == NOTHING
    assert "off-centre-suspension" not in by_id(found)


def test_a_result_without_tolerance_is_refused(clumod: Model, write: Write) -> None:
    path = Path(write({}))
    path.write_text(re.sub(r" \+/- [\d.]+", "", path.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(BadInput, match="without a tolerance"):
        only_classical(clumod, [str(path)])
