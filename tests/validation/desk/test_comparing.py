"""What a window is shown of a comparison is what `massline compare` finds, and it is there again at once."""

from dataclasses import fields, replace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.app import scene3d, session
from validation.app.scene3d import MapCell
from validation.compare.compare import compared
from validation.output import to_json
from validation.study import Study


@pytest.fixture(scope="module")
def found(worked) -> Any:
    """What `massline compare` finds of the same."""
    return compared(Study.open(worked.desk.model, worked.desk.asked.data))


def test_the_figures_are_those_of_the_command(worked, found):
    """The fits are those of the ladder's rung, taken up where they ended: rounding is all that lies between."""
    expected, shown = to_json(found), worked.compared.summary
    for key in ("plain_error_percent", "nominal_error_percent", "held_out_error_percent", "fitted_chi2_per_dof", "tolerance_z2"):
        assert_allclose(shown[key], expected[key], rtol=1e-6)
    assert [one["verdict"] for one in shown["errors"]] == [one["verdict"] for one in expected["errors"]]
    assert [one["text"] for one in shown["worst"]] == [one["text"] for one in expected["worst"]]
    assert [one["name"] for one in shown["absurd_tolerances"]] == [one["name"] for one in expected["absurd_tolerances"]]
    assert shown["warnings"] == expected["warnings"]


def test_a_fit_that_did_not_converge_is_said(worked):
    """In the words of the command, of the fit that did not; of both where an older ladder does not say which."""
    ready = worked.desk.study()
    at = worked.desk.rung(ready, lambda what, share: None)
    assert at.errors is not None
    for unfinished, fits in (
        ((), ["the plain fit", "the fit of every tolerance"]),
        (("fitted",), ["the fit of every tolerance"]),
    ):
        lost = replace(at, errors=replace(at.errors, converged=False, unfinished=unfinished))
        said = session.comparison_on(ready, lost, lambda what, share: None).remarks
        assert [text.partition(" did not converge")[0] for text in said if "did not converge" in text] == fits


def test_a_model_whose_fit_does_not_converge_is_compared_as_the_command_does(bare, monkeypatch):
    """The workbench had refused it."""
    whole = Study.evaluation

    def unended(self, progress=None, **how):
        found = whole(self, progress, **how)
        return replace(found, fitted=replace(found.fitted, converged=False))

    monkeypatch.setattr(Study, "evaluation", unended)
    found = bare.compare()
    (said,) = [text for text in found.summary["warnings"] if "did not converge" in text]
    assert said.startswith("the fit of every tolerance")


def test_a_comparison_is_there_after_a_reload_but_not_for_another_model_and_not_damaged(fresh):
    desk = fresh("reloaded")
    assert desk.comparison() is not None
    desk.model.write_text(desk.model.read_text() + "\n# by hand\n")
    assert desk.comparison() is None
    desk = fresh("damaged")
    (desk.found / "maps.npz").write_bytes((desk.found / "maps.npz").read_bytes()[:5000])
    assert desk.comparison() is None


def test_a_comparison_makes_the_first_rung_and_a_second_one_fits_nothing(worked):
    heard: list[str] = []
    again = worked.desk.compare(lambda what, share: heard.append(what))
    assert "fitting" not in heard
    assert again.summary["plain_error_percent"] == worked.compared.summary["plain_error_percent"]


@pytest.mark.parametrize(
    ("run", "row", "loads", "motion"),
    [("z", "fmd-z2", {2, 3, 4}, 2), ("x", "fmd-x12", {0, 5}, 0), ("beta", "t_y", {4}, 4), ("y", "cover-z1", set(range(6)), 1)],
)
def test_a_click_leads_to_an_entry_that_shows_the_cell(worked, run, row, loads, motion):
    found = scene3d.entry_of(worked.compared, MapCell(campaign="fmd+cuboid", run=run, row=row, frequency=11.02))
    assert found.load in loads
    assert found.motion == motion
    assert found.frequency == pytest.approx(11.0)
    assert found.campaign == "fmd+cuboid"
    pairs = worked.compared.maps[0].pairs
    sigma = pairs.sigma[np.argmin(np.abs(pairs.frequency - 11.02)), :, motion]
    assert sigma[found.load] == max(sigma[load] for load in loads)


def test_a_cell_that_is_none_leads_nowhere(worked):
    for cell in (
        MapCell(campaign="no", run="x", row="fmd-x12", frequency=9),
        MapCell(campaign="fmd+cuboid", run="x", row="no", frequency=9),
    ):
        with pytest.raises(KeyError):
            scene3d.entry_of(worked.compared, cell)


def test_spectra_that_were_kept_are_those_that_were_made_whatever_they_hold(bare):
    model = bare.read_model()
    (fresh,) = bare.predictions(model)
    assert bare.spectra.exists()
    (kept,) = bare.predictions(model)
    for of, other in ((fresh.measured, kept.measured), *zip(fresh.tested.drives, kept.tested.drives, strict=True)):
        for one in fields(of):
            assert np.array_equal(getattr(of, one.name), getattr(other, one.name)), one.name
    for one in fields(fresh.tested):
        if one.name in ("per_rms", "method", "remarks"):
            assert np.array_equal(getattr(fresh.tested, one.name), getattr(kept.tested, one.name))
    assert np.array_equal(fresh.at({}, derivatives=False).rows, kept.at({}, derivatives=False).rows)


def test_spectra_of_data_that_changed_are_made_again(bare):
    model = bare.read_model()
    bare.predictions(model)
    bare.spectra.write_bytes(bare.spectra.read_bytes()[:1000])
    heard: list[str] = []
    bare.predictions(model, lambda what, share: heard.append(what))
    assert "spectra" in heard
