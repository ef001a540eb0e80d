"""An effect that tolerances have paid for is found from where they are declared."""

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.cli import main
from validation.diagnose.candidates import candidates
from validation.diagnose.diagnosis import Candidate
from validation.diagnose.search import (
    can_restart,
    fit_with,
    restarted_from_priors,
    sizes,
    stepwise_search,
)
from validation.effects.catalogue import parse
from validation.estimation.problem import EFFECT, Parameter
from validation.model import model_file
from validation.model.model import Added
from validation.study import Study, read_data

TORSION, SIZE = "joint-compliance:torsion", 1.8e-5
"""[rad/(N m)] Of the flange; it moves the torsion of mast and blade by fifty times what is declared of a frequency."""

DRIVEN = ("--octaves-per-minute", "60", "--band", "4", "32", "--seed", "5")


@pytest.fixture(scope="module")
def soft(tmp_path_factory: pytest.TempPathFactory) -> Study:
    """Clumod with one blade on a flange that gives, and a model that does not know."""
    folder = tmp_path_factory.mktemp("afresh")
    model, campaign = folder / "model.toml", folder / "blade"
    assert main.run(["model", "fmd+clumod-1", "--out", str(model)]) == main.DONE
    assert main.run(["simulate", "fmd+clumod-1", "--out", str(campaign), *DRIVEN, "--effect", f"{TORSION}={SIZE}"]) == main.DONE
    known = model_file.read(str(model))
    return Study.of(known, read_data([str(campaign)], known))


@pytest.fixture(scope="module")
def paid(soft: Study) -> Candidate:
    """The model as it is, fitted to that: tolerances pay."""
    return Candidate(effects=(), fit=soft.all_free(), problem=soft.problem())


@pytest.fixture(scope="module")
def torsion(soft: Study) -> Added:
    return next(one for one in candidates(soft, only=["joint-compliance"]) if one.named.id == TORSION)


@pytest.fixture(scope="module")
def stuck(soft: Study, paid: Candidate, torsion: Added) -> Candidate:
    """The effect added where the tolerances stand."""
    return fit_with(soft, paid, torsion)


@pytest.fixture(scope="module")
def found(soft: Study, paid: Candidate, torsion: Added) -> Candidate:
    """The effect added from where they are declared."""
    return restarted_from_priors(soft, paid, torsion)


@pytest.mark.proof
def test_from_where_tolerances_have_paid_no_step_leads_there_and_from_home_one_does(
    paid: Candidate, stuck: Candidate, found: Candidate
) -> None:
    assert stuck.effects[-1].named.values[""] < 0.5 * SIZE
    assert found.effects[-1].named.values[""] == pytest.approx(SIZE, rel=0.03)
    assert found.fit.cost < min(stuck.fit.cost, paid.fit.cost) - 1000


def test_the_search_goes_that_way_where_no_fit_keeps_the_promise(soft: Study, paid: Candidate) -> None:
    said: list[str] = []
    explained, rounds = stepwise_search(soft, paid, candidates(soft, only=[TORSION]), lambda what, share: said.append(what))
    assert f"trying {TORSION} afresh" in said
    assert [one.named.id for one in explained.effects] == [TORSION]
    assert explained.effects[0].named.values[""] == pytest.approx(SIZE, rel=0.03)
    assert rounds[0].goodness.prior_penalty > 50 > 2 > rounds[0].tried[0].goodness.prior_penalty


@pytest.mark.proof
def test_beside_an_accepted_effect_that_keeps_its_size_and_of_a_modulus(soft: Study, found: Candidate) -> None:
    mast = next(one for one in candidates(soft, only=["modulus"]) if one.named.id == "modulus:mast")
    both = restarted_from_priors(soft, found, mast)
    assert [one.named.id for one in both.effects] == [TORSION, "modulus:mast"]
    assert both.effects[0].named.values[""] == pytest.approx(SIZE, rel=0.03)
    assert abs(both.effects[1].named.values[""]) < 0.05
    assert both.fit.cost <= found.fit.cost


@pytest.mark.proof
def test_tolerances_that_come_home_never_cost_more_and_keep_what_was_found(
    soft: Study, paid: Candidate, found: Candidate
) -> None:
    again = restarted_from_priors(soft, found)
    assert again.fit.cost <= found.fit.cost + 1e-6
    assert again.effects[-1].named.values[""] == pytest.approx(SIZE, rel=0.03)
    assert restarted_from_priors(soft, paid).fit.cost <= paid.fit.cost + 1e-6


@pytest.mark.proof
def test_from_home_a_size_that_had_not_come_through_does(soft: Study, stuck: Candidate) -> None:
    assert restarted_from_priors(soft, stuck).fit.cost < stuck.fit.cost - 1000


def test_one_sided_sizes_are_looked_at_on_that_side() -> None:
    one = Parameter(name="x", unit="m/N", tolerance=1e-6, kind=EFFECT, low=0.0, high=4e-6)
    found = sizes(one)
    assert found.min() > 0
    assert found.max() < 4e-6


def test_sizes_grow_by_half_octaves_about_what_is_plausible_within_bounds() -> None:
    one = Parameter(name="x", unit="kg", tolerance=2.0, kind=EFFECT, low=-0.5, high=100.0)
    found = sizes(one)
    assert np.all((found > -0.5) & (found < 100.0))
    assert np.all(found != 0)
    positive = found[found > 0]
    assert_allclose(positive[1:] / positive[:-1], np.sqrt(2))
    assert positive[0] == 2.0 / 64
    assert found[found < 0].min() > -0.5


@pytest.mark.parametrize(
    ("text", "fixed", "there"),
    [
        ("point-mass:mast-top=0.1", False, True),
        ("gravity=0", True, False),
        ("slosh:mast-top=m:0.1,f:5,zeta:0.01", False, False),
        ("pendulum-damping=0.1", False, False),
    ],
)
def test_effects_of_one_size_that_is_fitted_have_such_a_way(text: str, fixed: bool, there: bool) -> None:
    assert can_restart(Added(named=parse(text), fixed=fixed)) is there
