"""A series that another program wrote, ordinary tolerances and nothing planted, beside the nominal model of its laboratory."""

import json
from pathlib import Path

import numpy as np
import pytest

from geometry.inertia import Inertia
from identification import campaign_file
from validation.estimation import evaluate
from validation.estimation.fit import fit
from validation.estimation.problem import FITTED, PLAIN, Offsets, Problem
from validation.model.model import Model
from validation.prediction.series import predictions

ARTICLES = ("fmd+disc+cuboid", "fmd+clumod-1")


@pytest.fixture(scope="module")
def problem(data: Path) -> Problem:
    known = json.loads((data / "example_series" / "nominal.json").read_text(encoding="utf-8"))
    model = Model(
        source="nominal.json",
        title="what the laboratory knows",
        article=ARTICLES[1],
        fmd=Inertia.from_mass_matrix(np.array(known["fmd"]["mass_matrix_about_F"])),
        fmd_tolerance=0.03,
        cell_stiffness=np.array([known["cell_stiffness_N_per_m"][axis] for axis in "xyz"]),
        damping_ratio=known["damping_ratio_expected"],
    )
    campaigns = [campaign_file.read(data / "example_series" / name) for name in ARTICLES]
    return Problem(predictions(model, campaigns)).thinned()


def test_a_model_of_the_drawings_is_within_a_per_cent_once_the_fmd_and_its_modes_are_found(problem: Problem) -> None:
    plain = fit(problem, PLAIN)
    assert plain.converged
    assert _percent(problem, plain.by_name) < 1.0 < 3.0 < _percent(problem, {})


def test_every_tolerance_fitted_nothing_is_left_and_none_is_odd(problem: Problem) -> None:
    """The floor of 0.15 % makes chi² per degree of freedom of a model that is right a little less than 1."""
    found = fit(problem, FITTED, start=fit(problem, PLAIN).by_name)
    assert 0.7 < found.chi2 / found.degrees_of_freedom < 1.1
    assert found.tolerance_z2 < 1.3 * found.tolerances


def _percent(problem: Problem, offsets: Offsets) -> float:
    return evaluate.share(
        [one for each in problem.predictions for one in evaluate.squares(each, {**problem.start, **offsets})]
    ).percent
