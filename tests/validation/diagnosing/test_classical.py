"""Weights, centres of gravity and periods: alone, and beside a campaign."""

import re
from collections.abc import Callable
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.integrate import quad
from scipy.special import log_ndtr
from scipy.stats import norm

from geometry.errors import BadInput
from validation.classical.pendulum import rope_amplitude_factor, rope_pendulum
from validation.classical.swing import Words, recorded, setup
from validation.classical.swing import write as write_swing
from validation.diagnose.candidate_fits import fit_with
from validation.diagnose.candidates import candidates as menu_of
from validation.diagnose.candidates import screen
from validation.diagnose.classical import (
    InterpolatedCurve,
    answering,
    both,
    candidates,
    curve,
    judged,
    observed,
    pendulum_candidates,
    weighed,
)
from validation.diagnose.diagnosis import AMBIGUOUS, MISSING, NOTHING, SEVERAL, UNKNOWN, Candidate, Screened, SwingAnswer
from validation.diagnose.pendulum import advised, against, contradictions, only_classical
from validation.effects.catalogue import FAMILIES, parse, parse_all
from validation.effects.stages import PendulumSwing as Stage
from validation.estimation.problem import Fit
from validation.model.model import Added, Model
from validation.prediction.classical_facts import facts
from validation.reference.reference import ArticleOptions
from validation.report.diagnose import classical_document
from validation.study import Data, Study
from validation.virtual_test.plan import Plan
from validation.virtual_test.simulate import simulate

PLAUSIBLE = 0.5
LEFT = np.array([0.3, -0.2, 0.5])
SLOPE = np.array([1.0, 0.4, -2.0])
"""What one unit of the effect adds to three predictions."""


@pytest.fixture(scope="module")
def precision() -> np.ndarray:
    spread = np.array([[0.1, 0.0, 0.0], [0.05, 0.12, 0.0], [-0.02, 0.03, 0.2]])
    return np.linalg.inv(spread @ spread.T)


def linear(low: float = -6 * PLAUSIBLE, slope: np.ndarray = SLOPE) -> InterpolatedCurve:
    return curve(lambda sizes: sizes[:, None] * slope, low, 6 * PLAUSIBLE)


def squared() -> InterpolatedCurve:
    return curve(lambda sizes: sizes[:, None] ** 2 * SLOPE, 0.0, 6 * PLAUSIBLE)


def _gaussian(precision: np.ndarray) -> tuple[float, float, float]:
    """Evidence, mean and standard deviation of the size, both signs allowed."""
    information, pull = SLOPE @ precision @ SLOPE, -SLOPE @ precision @ LEFT
    width = 1 / (information + PLAUSIBLE**-2)
    return 0.5 * pull**2 * width - 0.5 * np.log(1 + PLAUSIBLE**2 * information), pull * width, np.sqrt(width)


def test_an_effect_in_proportion_weighs_what_two_gaussians_do_and_of_one_sign_what_the_other_would_have_wasted(precision):
    evidence, mean, sd = _gaussian(precision)
    found = weighed(linear(), PLAUSIBLE, LEFT, precision)
    # beyond six standard deviations lies a part in 1e9 of the prior; the trapezoidal rule is as good, interpolated quantiles less
    assert_allclose(found.evidence, evidence, rtol=1e-6)
    assert_allclose(found.value, mean, atol=1e-4 * sd)
    assert_allclose([found.low, found.high], norm.ppf([0.05, 0.95], mean, sd), rtol=1e-3)
    found = weighed(linear(low=0.0), PLAUSIBLE, LEFT, precision)
    assert_allclose(found.evidence, evidence + np.log(2) + log_ndtr(mean / sd), rtol=1e-5)


@pytest.mark.parametrize("sign", [-1, 1])
def test_an_effect_that_goes_with_the_square_of_its_size_is_integrated_as_it_is(precision, sign):
    left = sign * LEFT

    def density(size):
        r = left + size**2 * SLOPE
        return 2 * norm.pdf(size, 0, PLAUSIBLE) * np.exp(-0.5 * (r @ precision @ r - left @ precision @ left))

    expected = np.log(quad(density, 0, 6 * PLAUSIBLE, epsabs=0, epsrel=1e-10, limit=200)[0])
    assert_allclose(weighed(squared(), PLAUSIBLE, left, precision).evidence, expected, rtol=1e-5)


def test_an_effect_that_can_only_move_the_other_way_is_best_not_there(precision):
    found = weighed(linear(low=0.0, slope=precision @ LEFT), PLAUSIBLE, LEFT, precision)
    assert found.best == 0
    assert_allclose(found.chi2, LEFT @ precision @ LEFT, rtol=1e-12)
    assert found.evidence < 0


def test_two_effects_that_do_not_touch_weigh_what_they_weigh_alone():
    left, precision = np.array([0.4, -0.7]), np.diag([100.0, 25.0])
    curves = (linear(slope=np.array([1.0, 0.0])), linear(slope=np.array([0.0, 1.0])))
    alone = [weighed(one, PLAUSIBLE, left, precision) for one in curves]
    one, other = both(curves, (PLAUSIBLE, PLAUSIBLE), left, precision)
    assert_allclose(one.evidence, sum(each.evidence for each in alone), rtol=1e-4)  # grids of 121 points
    assert_allclose([one.value, other.value], [each.value for each in alone], rtol=1e-2)
    assert_allclose(one.chi2, 0.0, atol=1e-2)


def test_intervals_hold_the_truth_as_often_as_they_say():
    rng = np.random.default_rng(3)
    precision = np.diag([400.0, 400.0])
    answer = curve(lambda sizes: sizes[:, None] ** 2 * np.array([1.0, 0.3]), 0.0, 6 * PLAUSIBLE)
    inside = 0
    count = 300
    for truth in np.abs(rng.normal(0, PLAUSIBLE, count)):
        left = -answer.at(np.array([truth]))[0] + rng.normal(0, 0.05, 2)
        found = weighed(answer, PLAUSIBLE, left, precision)
        inside += found.low <= truth <= found.high
    # truths drawn from what is plausible: exactly 90 % are due; three standard deviations of 300 draws are 5 %
    assert_allclose(inside / count, 0.9, atol=0.05)


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
def write(tmp_path, body) -> Write:
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


@pytest.mark.parametrize(
    "name", ["pendulum-amplitude", *(pytest.param(one, marks=pytest.mark.proof) for one in ("rope-mass", "air-inertia"))]
)
def test_one_period_needs_the_planted_size_of_the_planted_effect_and_calls_all_others_aliases(clumod, write, name):
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


def test_a_period_as_the_model_has_it_misses_nothing_and_says_what_it_could_not_have_seen(clumod, write):
    found = only_classical(clumod, [write({})])
    assert found.verdict == NOTHING
    assert found.equivalence_class == ()
    assert "One period is one number" in found.text
    smallest = {one.id: one.size for one in found.detectable}
    # planted at what would have been named, it is: a period's tolerance alone decides
    again = only_classical(clumod, [write({"off-centre-suspension": 1.02 * smallest["off-centre-suspension"]})])
    assert again.verdict != NOTHING


@pytest.mark.proof  # a diagnosis for a sign
def test_a_period_too_short_is_no_effect_of_ropes_or_air(clumod, write, body):
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
def test_swings_that_differ_name_what_is_missing_and_its_size(clumod, write, name, swings, stated):
    found = only_classical(clumod, [write({name: SIZES[name]}, swings, stated=stated)])
    assert (found.verdict, found.equivalence_class) == (MISSING, (name,))
    (cause,) = found.accepted
    (size,) = cause.sizes
    assert size.low < SIZES[name] < size.high
    assert cause.null
    assert any("amplitude = true takes it off" in text for text in found.remarks) == stated


def test_stretch_and_a_heavier_body_stay_aliases_on_any_ropes(clumod, write):
    """Both lengthen every period by the same share."""
    found = only_classical(clumod, [write({"rope-elasticity": SIZES["rope-elasticity"]}, (0, 1, 2))])
    assert found.verdict == AMBIGUOUS
    assert {"rope-elasticity", "rigid-inertia:Izz"} <= set(found.equivalence_class)
    assert "off-centre-suspension" not in found.equivalence_class
    best = found.advice[0]
    assert "load" in best.test or "mass" in best.test


def test_a_stated_amplitude_that_is_corrected_for_is_no_effect_any_more_and_two_effects_are_both_named(clumod, write):
    found = only_classical(clumod, [write({"pendulum-amplitude": 0.3}, (0, 3), stated=True, corrected=True)])
    assert found.verdict == NOTHING
    assert "pendulum-amplitude" not in by_id(found)
    both = {"pendulum-amplitude": 0.3, "off-centre-suspension": 0.03}
    found = only_classical(clumod, [write(both, (0, 1, 2, 3), stated=True)])
    assert found.verdict == SEVERAL
    assert {one.id for one in found.accepted} == set(both)
    for one in found.accepted:
        assert one.sizes[0].low < both[one.id] < one.sizes[0].high


def test_swings_that_contradict_each_other_are_unknown_and_named(clumod, write):
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


def test_swings_on_the_same_ropes_share_the_tolerance_of_their_length(clumod, write):
    one, other = facts(clumod, [write({}, (0, 3), stated=True)])
    of = observed((one, other), ())
    apart = of.covariance[0, 0] + of.covariance[1, 1] - 2 * of.covariance[0, 1]
    # what is left of two periods is that of the periods, 5e-5 s of 2 s: a part in 2e4 of the inertia, at 95 %
    period = float(one.swing.pendulum.period.nominal_value)
    expected = (2 * 5e-5 / 1.96 / period * one.value) ** 2 * 2
    assert_allclose(apart, expected, rtol=2e-2)  # the amplitude makes the second period a little longer
    assert apart < 0.2 * of.covariance[0, 0]


@pytest.mark.proof  # a diagnosis; a period as the model has it misses nothing either
def test_nothing_is_named_where_tolerances_are_all_that_is_wrong(clumod, write):
    found = facts(clumod, [write({}, (0, 1, 2))])
    of = observed(found, ())
    answers = answering(of, candidates(found))
    half = np.linalg.cholesky(of.covariance)
    rng = np.random.default_rng(5)
    verdicts = [judged(answers, half @ rng.normal(size=3), of.precision).verdict for _ in range(60)]
    assert verdicts.count(NOTHING) == 60


def test_a_weight_alone_says_how_much_and_not_where(clumod, tmp_path, body):
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


def test_candidates_of_a_pendulum_are_those_not_taken_off_and_not_in_the_model_already(clumod, write):
    plain = pendulum_candidates(facts(clumod, [write({})]))
    assert {one.named.family for one in plain} == set(SIZES)
    taken = pendulum_candidates(facts(clumod, [write({}, stated=True, corrected=True)]))
    assert {one.named.family for one in taken} == set(SIZES) - {"pendulum-amplitude"}
    known = tuple(Added(named=one) for one in parse_all(["off-centre-suspension=0.03"]))
    found = only_classical(replace(clumod, effects=known), [write({"off-centre-suspension": 0.03}, (0, 1, 2))])
    assert found.verdict == NOTHING
    assert "off-centre-suspension" not in by_id(found)


def test_a_result_without_tolerance_is_refused(clumod, write):
    path = Path(write({}))
    path.write_text(re.sub(r" \+/- [\d.]+", "", path.read_text(encoding="utf-8")), encoding="utf-8")
    with pytest.raises(BadInput, match="without a tolerance"):
        only_classical(clumod, [str(path)])


# Pendulums swung by exudyn, which knows none of the equations of the catalogue: what was hidden in them is found.


MODEL = Model(source="model.toml", title="", article="fmd+clumod-4")

TOLERANCES = {"rope_length": "0.2 mm", "radius": "0.05 mm", "mass": "1 g"}
"""95 % limits of what the laboratory read."""

Swing = Callable[..., str]


@pytest.fixture
def swing(tmp_path) -> Swing:
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
        path = write_swing(folder, found.setup, found.swing, found.signal, found.decay)
        text = path.read_text(encoding="utf-8")
        for key, tolerance in TOLERANCES.items():
            text = re.sub(rf'^({key} = "[^"]*)"', rf'\1 +/- {tolerance}"', text, flags=re.MULTILINE)
        path.write_text(text, encoding="utf-8")
        return str(path)

    return made


@pytest.mark.proof  # a diagnosis; test_swings_that_differ names what is off centre
def test_ropes_at_two_radii_find_the_centre_of_gravity_beside_their_middle(swing):
    files = [swing("wide", "0.3 m", off_centre="20 mm"), swing("narrow", "0.2 m", off_centre="20 mm")]
    found = only_classical(MODEL, files)
    assert (found.verdict, found.equivalence_class) == (MISSING, ("off-centre-suspension",))
    assert_allclose(found.accepted[0].sizes[0].value, 0.02, rtol=0.03)  # the integration's own 8e-5 of the period is 1.6 % of e


@pytest.mark.proof  # a diagnosis; aliases of one period are told above
def test_on_one_set_of_ropes_it_is_one_of_many(swing):
    found = only_classical(MODEL, [swing("wide", "0.3 m", off_centre="20 mm")])
    assert found.verdict == AMBIGUOUS
    assert {"off-centre-suspension", "rigid-inertia:Izz"} <= set(found.equivalence_class)
    (needed,) = [one for one in found.needed if one.id == "off-centre-suspension"]
    assert_allclose(needed.value, 0.02, rtol=0.03)
    assert "the ropes half as far" in " ".join(one.test for one in found.advice)


@pytest.mark.proof  # test_stretch_and_a_heavier_body_stay_aliases holds the same in short
def test_ropes_that_stretch_are_among_those_that_no_radius_tells_apart(swing):
    stiff = {"rope_stiffness": "1.5e5 N"}
    found = only_classical(MODEL, [swing("wide", "0.3 m", **stiff), swing("narrow", "0.2 m", **stiff)])
    assert "rope-elasticity" in found.equivalence_class
    assert {"air-inertia", "rigid-inertia:Izz"} <= set(found.equivalence_class)
    (needed,) = [one for one in found.needed if one.id == "rope-elasticity"]
    assert_allclose(needed.value, 2.0 / 1.5e5, rtol=0.25)  # 0.05 % of the period: 8e-5 of the integration is a sixth of it


BALANCE = 0.05
"""Per cent."""

ON_SHAKER = Model(source="model.toml", title="", article="fmd+cuboid", cell_stiffness=np.array((4e8, 4e8, 2e9)))

Made = Callable[..., Study]


@pytest.fixture(scope="module")
def test_of_cuboid():
    """A Cuboid on the shaker, ordinary tolerances, nothing planted, in fast sweeps."""
    return simulate(Plan(article="fmd+cuboid", seed=3, octaves_per_minute=60.0, quiet=0.3))


@pytest.fixture(scope="module")
def cuboid() -> tuple[float, float]:
    """Mass [kg] and moment of inertia about z [kg m²] of the Cuboid as drawn."""
    from geometry import routes
    from geometry.articles import built_in

    inertia = routes.inertia(built_in("cuboid"))
    return float(inertia.mass), float(inertia.tensor_cog[2, 2])


@pytest.fixture
def made(test_of_cuboid, tmp_path) -> Made:
    """``made(text of a file, ...)``: the campaign and these files on a bench."""

    def of(*texts: str) -> Study:
        paths = [tmp_path / f"file-{k}.toml" for k in range(len(texts))]
        for path, text in zip(paths, texts, strict=True):
            path.write_text(text, encoding="utf-8")
        return Study.of(ON_SHAKER, Data(campaigns=(test_of_cuboid.campaign,), classical=tuple(map(str, paths))))

    return of


def weighing(mass: float) -> str:
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


def screened_by_id(found: tuple[Screened, ...]) -> dict[str, Screened]:
    return {one.id: one for one in found}


@pytest.fixture(scope="module")
def fitted(test_of_cuboid) -> Fit:
    """Of the campaign. Facts do not move it: no free parameter of the model as it is weighs anything on a balance."""
    return Study.of(ON_SHAKER, Data(campaigns=(test_of_cuboid.campaign,))).all_free()


def standing(of: Study, fitted: Fit) -> Candidate:
    return Candidate(effects=(), fit=fitted, problem=of.problem())


def of_mass(of: Study, fitted: Fit) -> Screened:
    return screened_by_id(screen(of, standing(of, fitted), menu_of(of, only=("rigid-inertia:m",))))["rigid-inertia:m"]


@pytest.mark.proof  # a diagnosis; docs/diagnose-pendulum.md shows one
def test_a_balance_says_what_a_campaign_alone_cannot(made, fitted, cuboid):
    """The FMD below is known to 5 %, force channels to a few parts in a thousand: together they hide what a balance shows."""
    alone, together = (
        of_mass(made(), fitted),
        of_mass(made(weighing(cuboid[0])), fitted),
    )
    sd = BALANCE / 100 / 1.96 * cuboid[0]
    assert together.told.deviation < 1.1 * np.hypot(sd, 5e-4)  # half a digit of the display beside it
    assert alone.told.deviation > 10 * together.told.deviation
    # two independent measurements of one number: their information adds
    added = 1 / (together.told.information - alone.told.information)
    assert_allclose(np.sqrt(added), np.hypot(sd, 0.5e-3 / 1.96), rtol=1e-3)


def test_what_is_weighed_is_named(made, fitted, cuboid):
    found = of_mass(made(weighing(cuboid[0] + 0.1)), fitted)
    assert found.evidence > 20
    assert_allclose(found.added.named.value, 0.1, atol=0.02)


def test_a_weight_that_contradicts_the_campaign_is_named_with_what_settles_it_and_one_that_agrees_is_not(made, fitted, cuboid):
    of = made(weighing(cuboid[0] + 1.0))
    base = standing(of, fitted)
    (text,) = contradictions(of, base, base)
    (one,) = against(of, base)
    assert abs(one.sigma) > 4
    assert "the campaigns disagree by" in text
    assert f"{abs(one.sigma):.0f} sigma" in text
    assert_allclose(one.measured, cuboid[0] + 1.0, atol=1e-6)
    # the truth is the drawing within a part in a thousand of scatter: the campaign says so within its own tolerance
    assert abs(one.said - cuboid[0]) < 4 * one.said_sd
    named = parse("gravity=1")
    (text,) = contradictions(of, base, Candidate(effects=(Added(named=named),), fit=base.fit, problem=base.problem))
    assert text.endswith("; with gravity they still disagree")
    of = made(weighing(cuboid[0]))
    base = standing(of, fitted)
    assert contradictions(of, base, base) == ()


def test_effects_of_a_pendulum_are_tried_where_a_swing_is_among_the_files(made, cuboid):
    of = made(swung(*cuboid, 0.4))
    base = standing(of, of.all_free())
    menu = menu_of(of, only=("pendulum-amplitude", "pendulum-damping", "force-gain"))
    found = screened_by_id(screen(of, base, menu))
    wide = found["pendulum-amplitude"]
    assert wide.evidence > 100
    assert_allclose(wide.added.named.value, 0.4, rtol=0.03)
    child = fit_with(of, base, wide.added)
    assert_allclose(child.effects[0].named.value, 0.4, rtol=0.03)
    # the integral over the size and Laplace's approximation of it differ by the normalisation of a half prior
    assert_allclose(child.fit.log_evidence - base.fit.log_evidence, wide.evidence, atol=1.0)
    assert not any(one.named.family.startswith("pendulum") for one in menu_of(made()))
    best = advised(of, base, ("pendulum-amplitude", "rope-mass"))[0]
    assert set(best.separates) <= {"pendulum-amplitude", "rope-mass"}
    assert best.gain > 5


def test_the_page_of_stated_results_calls_each_by_its_quantity_and_says_once_that_nothing_is_missing(cuboid, tmp_path):
    """Every input was an "assumed tolerance", and what agreed was off by "-0.0"."""
    mass, _ = cuboid
    file = tmp_path / "results.toml"
    head = 'format = 1\nkind = "results"\n[article]\nname = "cuboid"\n'
    file.write_text(f'{head}[mass]\nvalue = "{mass + 1e-6:.9f} +/- 0.01 kg"\n', encoding="utf-8")
    page = classical_document(only_classical(ON_SHAKER, [str(file)]), "title").text(110)
    assert page.lower().count("nothing is missing") == 1
    assert "stated tolerance" not in page
    assert "-0.0" not in page
    assert " period " not in page  # nothing swung
