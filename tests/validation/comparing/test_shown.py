"""The page, the JSON and the pictures of a comparison, and what is said of the four errors."""

import re
from dataclasses import dataclass, replace

import numpy as np
import pytest

from validation.compare.compare import Comparison, Spot, text
from validation.estimation.problem import Parameter, Share
from validation.estimation.verdicts import DOUBTFUL, FAILED, GOOD, ExplainedError, Tolerance, absurd, expected_z2, told
from validation.output import entry, to_json
from validation.report import compare
from validation.report.compare import draw
from validation.report.document import Figures, page

EXPECTED = ExplainedError(measurement=1.0, with_modes=1.0)

ERRORS = """\
the four errors
═══════════════

                            error   what it means, and what is to be thought of it
 ────────────────────────────────────────────────────────────────────────────────────────────────────────────
 nominal error             12.3 %   the model as it stands, nothing fitted
 plain error               1.23 %   sensors as calibrated; the FMD identified, modes within what the model
                                    declares. FAILED: a sound laboratory would miss by up to 0.9 %, but
                                    nowhere by 18 sigma as here
 fitted error     χ² 0.88, z² 576   every tolerance fitted: χ² per degree of freedom, and its prior penalty,
                                    the sum of z² of 3 tolerances, about 3 in a sound laboratory. FAILED: χ²
                                    is good only because the fit moved tolerances too far: force-gain:fmd-z2
                                    by +24.0 standard deviations
 held-out error             1.5 %   plain error on data used only for checking, predicted and not fitted.
                                    Hardly larger than on what was fitted: it is the model that fails, there
                                    as here

"""


def test_the_errors_are_printed_each_with_its_meaning_and_verdict(found):
    assert page("the four errors", [compare.errors(found).grid()], (), 110) == ERRORS


def test_every_picture_is_there_and_its_names_stay_in_the_folder(found, tmp_path):
    evil = "../../../etc/$x^{2}$ <b>\n"
    nasty = replace(found.maps[0], data_set=evil, pairs=replace(found.maps[0].pairs, campaign=evil))
    out = tmp_path / "pictures"
    out.mkdir()
    made = draw(replace(found, title=evil, maps=(nasty,)), out)
    assert len(made) == 5
    assert all(path.parent == out and path.is_file() for path in made)
    assert {path.name for path in tmp_path.iterdir()} == {"pictures"}


def test_a_map_on_which_all_is_white_is_a_sentence(found):
    """Half a page of a bridge's report."""
    quiet = replace(found.maps[0], expected=1e6 * np.max(np.abs(found.maps[0].deviation)) + 0 * found.maps[0].expected)
    said = compare.document(replace(found, maps=(quiet,))).html(Figures())
    assert any(f"No map of {quiet.data_set}: nothing in it reaches 1 sigma." in str(part) for part in said)


def test_absurd_tolerances_fail_a_model_whose_chi2_is_good(evaluation):
    sound, bought = (told(evaluation(z), EXPECTED, 2.0)[2] for z in (1.0, 24.0))
    assert sound.verdict == GOOD
    assert bought.verdict == FAILED
    assert "force-gain:fmd-z2 by +24.0 standard" in bought.text


def test_a_price_in_the_thousands_is_written_out(evaluation):
    assert told(evaluation(z=47.26), EXPECTED, 2.0)[2].figure == "χ² 0.88, z² 2234"


@pytest.mark.parametrize(("fmd", "verdict"), [(0.9 * 5.0, FAILED), (0.9 * 3.8, GOOD)])
def test_an_fmd_that_nobody_would_build_fails_a_model_without_a_price(evaluation, fmd, verdict):
    of = evaluation(fmd=fmd)
    assert of.fitted.tolerance_z2 == evaluation().fitted.tolerance_z2
    said = told(of, EXPECTED, 2.0)[2]
    assert said.verdict == verdict
    assert ("fmd:m by +5.0 standard" in said.text) == (verdict == FAILED)


def test_an_fmd_within_reason_is_not_named_where_the_price_is_too_high(evaluation):
    of = evaluation(z=3.0, fmd=0.9 * 3.8)
    dear = replace(of.fitted, tolerance_z2=60.0)
    said = told(replace(of, fitted=dear), EXPECTED, 2.0)[2]
    assert said.verdict == FAILED
    assert "fmd:m" not in said.text
    assert "force-gain:fmd-z2 by +3.0 standard deviations" in said.text


def test_what_modes_and_tolerances_let_expect_is_told_where_it_counts(evaluation):
    of = evaluation()
    said = told(of, ExplainedError(measurement=0.97, with_modes=6.1), 2.0)[1].text
    assert said.startswith("a sound laboratory would miss by up to 0.97 %, with the tolerances of its modes by up to 6.1 %")
    assert "modes" not in told(of, EXPECTED, 2.0)[1].text
    assert "beside noise, and nothing stands out" in told(of, ExplainedError(measurement=0.97, with_modes=0.97), 2.0)[1].text
    fit = evaluation().fitted
    shares = 1 - np.array([1e-5, 1e-6, 1e-6]) / np.array([0.025, 0.003, 0.003]) ** 2
    assert expected_z2(fit) == pytest.approx(shares.sum(), rel=1e-12)
    assert not absurd(fit)


def test_a_fit_that_does_not_hold_on_unseen_runs_is_doubted_but_not_where_tolerances_explain_it(evaluation):
    of = evaluation()
    bad = replace(of, held_out=replace(of.held_out, percent=5.0))
    assert "does not hold" in told(bad, EXPECTED, 2.0)[3].text
    assert told(of, EXPECTED, 2.0)[3].verdict == GOOD
    # What the plain fit frees swallows some of a tolerance on the data it is fitted to, and none on others.
    null = replace(of, plain=replace(of.plain, percent=0.26), held_out=replace(of.held_out, percent=0.5))
    expected = ExplainedError(measurement=0.4, with_modes=0.4)
    assert told(null, expected, 2.0)[3].verdict == GOOD
    assert told(null, replace(expected, measurement=0.3), 2.0)[3].verdict == DOUBTFUL
    # Nothing is good about a model that fails as much on what no fit has seen
    failed = told(of, EXPECTED, 18.0)
    assert (failed[1].verdict, failed[3].verdict) == (FAILED, "")


def test_a_configuration_never_seen_is_told_beside_the_verdict_and_a_spot_as_an_engineer_would(evaluation):
    of = evaluation()
    series = replace(of, held_out_configurations=Share(percent=79.0), held_out_configurations_nominal=Share(percent=18.0))
    here, there = told(of, EXPECTED, 2.0)[3], told(series, EXPECTED, 2.0)[3]
    assert (there.figure, there.verdict) == (here.figure, here.verdict)
    assert there.text.endswith("its modes and what acts there alone unfitted: 79 %, nominal 18 %")
    alone = told(replace(series, held_out=None), EXPECTED, 2.0)[3]
    assert (alone.figure, alone.verdict) == ("–", "")
    assert "79 %" in alone.text
    assert text(MOMENT) == (
        "moment about y in the y-sweep of fmd+clumod-1, 11-13 Hz, 9.2 sigma, 4.1 % of the dynamic mass, "
        "follows the first mast mode; also in the beta sweep, fmd+clumod-4"
    )
    runs = tuple(("fmd+clumod-1", name, 5.0) for name in ("x", "z", "alpha", "gamma"))
    assert text(replace(MOMENT, elsewhere=runs)).endswith("; also in the x-sweep, the z-sweep, the alpha sweep and 1 more")


MOMENT = Spot(
    data_set="fmd+clumod-1",
    configuration="fmd+clumod-1",
    run="y",
    axis="y",
    row="t_y",
    of_load=True,
    frequency=11.9,
    band=(11.05, 13.2),
    sigma=9.2,
    percent=4.1,
    course="follows the first mast mode",
    elsewhere=(("fmd+clumod-1", "beta", 5.0), ("fmd+clumod-4", "y", 4.5)),
)


SHARES = ((990.0, "990 % of the dynamic mass"), (1432.0, "14 times the dynamic mass"), (1e6, "sigma, follows"))


@pytest.mark.parametrize(("percent", "said"), SHARES)
def test_what_is_many_times_what_is_read_is_told_as_so_many_times_and_of_nothing_there_is_no_share(percent, said):
    assert said in text(replace(MOMENT, percent=percent))


@pytest.mark.parametrize(("band", "said"), [((12.1, 12.4), "12.1-12.4 Hz"), ((7.0, 7.0), "7.0 Hz")])
def test_a_band_is_told_with_the_digits_that_tell_its_ends_apart(band, said):
    assert f", {said}, 9.2 sigma" in text(replace(MOMENT, band=band))


@dataclass(frozen=True, eq=False, kw_only=True)
class Widened(Comparison):
    """A comparison with one figure more."""

    resonant: float = entry("error_at_resonances_percent", unit="%", default=12.5)


def test_a_new_figure_is_one_field_and_one_row(found, monkeypatch):
    """Of the result and of its document: terminal, page, JSON and the browser's panel have it then."""
    wider = Widened(**vars(found))
    rows = [*compare.error_rows(wider), ("error at resonances", wider.resonant, "%", None)]
    monkeypatch.setattr(compare, "error_rows", lambda of: rows)
    table = compare.errors(wider)
    assert re.search(r"error at resonances +12\.5 %", compare.document(wider).text())
    assert re.search(r"error at resonances.*data-value=\"12\.5\"", table.html())
    assert {"name": "error at resonances", "figure": "12.5 %"}.items() <= table.panel()[-1].items()
    assert list(to_json(wider))[-1] == "error_at_resonances_percent"


def test_a_share_that_a_fit_moved_is_told_in_per_cent_and_of_a_factor_what_it_became():
    plain = Tolerance(parameter=Parameter(name="mass:deck", unit="1", tolerance=0.01), offset=0.0633)
    factor = Tolerance(parameter=Parameter(name="modulus:leg", unit="1", tolerance=0.025, logarithmic=True), offset=-0.1)
    late = Tolerance(parameter=Parameter(name="board-delay:force", unit="s", tolerance=1e-5), offset=4e-5)
    assert [compare.moved(one) for one in (plain, factor, late)] == [("+6.33", "%"), ("−9.52", "%"), ("+40.0", "µs")]
