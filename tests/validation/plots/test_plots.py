"""Figures show the numbers that went in, in their units, light and dark by the template alone, and take no title for markup."""

from collections.abc import Callable
from dataclasses import replace
from math import log10
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest
from numpy.testing import assert_allclose

from validation.compare.correlation import NamedMode
from validation.compare.maps import Map, Pairs
from validation.diagnose.diagnosis import Cause, EffectEstimate
from validation.effects.catalogue import Named
from validation.history.history import Body, Errors, HistoryPosition, Ladder, Version
from validation.identify.identify import UsedLines
from validation.report.charts import crosscheck, history, identification, interactive, maps, spec, style

F = np.linspace(4.0, 32.0, 57)
MODE = NamedMode(name="first <mast> mode", frequency=12.0, damping_ratio=0.01)


def pairs() -> Pairs:
    """One resonance, of another size on every entry; xz is next to nothing in the model."""
    H = np.arange(1.0, 37.0).reshape(6, 6) * (40 / (1 - (F / 12.2) ** 2 + 0.02j))[:, None, None]
    predicted = H.copy()
    predicted[:, 0, 2] = 1e-13
    some = np.full(H.shape, 0.1)
    return Pairs(campaign="<b>one</b>", frequency=F, measured=1.1 * H, predicted=predicted, expected=some, level=np.abs(H))


def channel_map() -> Map:
    deviation = np.zeros((2, len(F), 3), dtype=complex)
    deviation[1, 20, 1] = 7.5
    expected = np.ones((2, len(F), 3))
    expected[:, :, 2] = np.inf
    nothing = np.zeros((2, len(F)))
    return Map(
        data_set="one",
        configuration="one",
        runs=("x", "y"),
        axes=("x", "y"),
        frequency=F,
        rows=("fmd-z1", "fmd-z2", "f_x"),
        channels=2,
        deviation=deviation,
        expected=expected,
        reading=deviation,
        level=expected,
        inputs=deviation,
        misfit=nothing,
        explained=nothing,
        explained_with_modes=nothing,
    )


def rung(number: int, parent: int | None, plain: float) -> Version:
    errors = Errors(
        nominal=5.0,
        plain=plain,
        held_out=2 * plain,
        chi2=900.0,
        degrees_of_freedom=1000,
        tolerance_z2=100.0,
        tolerances=90,
        log_evidence=0.0,
        expected_z2=50.0,
    )
    return Version(number=number, parent=parent, cause="added", effect=f"<i>{number}</i>", model="", errors=errors, gain=10.0)


def standing() -> HistoryPosition:
    rungs = (rung(0, None, 4.0), rung(1, 0, 3.0), rung(2, 0, 0.5))
    return HistoryPosition(path=None, text="", ladder=Ladder(rungs=rungs, current=2), rung=rungs[2])  # type: ignore[arg-type]


def diagnosed() -> Any:
    def cause(id: str, evidence: float, *, null: bool = True) -> Cause:
        family, _, target = id.partition(":")
        size = EffectEstimate(key="", value=0.08, unit="1", low=0.07, high=0.09)
        return Cause(
            named=Named(family=family, targets=(target,), values={"": 0.08}), sizes=(size,), evidence=evidence, null=null
        )

    right, alike = cause("force-gain:fmd-z2", 174.0), cause("cell-stiffness:2z", 170.0)
    wrong, idle = cause("force-gain:fmd-z1", 3.0, null=False), cause("force-gain:fmd-z3", 0.04)
    ranking = (right, wrong, alike, idle, cause("force-gain:fmd-z4", -3.0))
    return SimpleNamespace(accepted=(right,), ranking=ranking, equivalence_class=(right.id, alike.id), settings={})


def body() -> Body:
    reference = np.array([47.4, 0.0, 0.0, 0.31, 2.3, 2.2, 0.4, 0.0, 0.0, 0.0])
    return Body(article="clumod-1", values=1.01 * reference, deviation=np.full(10, 0.01), reference=reference)


FIGURES: dict[str, Callable[[bool], Any]] = {
    "overlay": lambda dark: maps.overlay(pairs(), 0, 4, modes=[MODE], marked=11.0, dark=dark),
    "diagonal": lambda dark: maps.diagonal(pairs(), modes=[MODE], dark=dark),
    "channel map": lambda dark: maps.channel_map(channel_map(), modes=[MODE], dark=dark),
    "pair map": lambda dark: maps.pair_map(pairs(), modes=[MODE], dark=dark),
    "evidence": lambda dark: crosscheck.evidence(diagnosed(), dark=dark),
    "ladder": lambda dark: history.falling_errors(standing(), dark=dark),
    "inertia": lambda dark: history.identified_inertia({"plain": body(), "<u>": body()}, dark=dark),
    "condition": lambda dark: identification.condition(LINES, "<s>", dark=dark),
}
LINES = UsedLines(frequency=F, condition=1 + F / 10, limit=3.0, kept=(F < 20).astype(float))


@pytest.mark.parametrize("name", FIGURES)
def test_dark_differs_by_the_template_alone_panels_say_their_units_and_names_from_files_are_no_markup(name):
    light, dark = FIGURES[name](False), FIGURES[name](True)
    assert light.json() == dark.json()
    light, dark = light.checked(), dark.checked()  # plotly has every key and value of them
    assert light.layout.template.layout.paper_bgcolor != dark.layout.template.layout.paper_bgcolor
    assert '"template"' not in FIGURES[name](False).json()
    layout = light.layout
    said = [layout[key].title.text for key in layout if key.startswith(("xaxis", "yaxis")) and layout[key].title.text]
    said += [note.text for note in layout.annotations]
    assert any("[" in text and "]" in text for text in said)
    text = FIGURES[name](False).json().encode().decode("unicode_escape")
    assert not [one for one in ("<b>", "<mast>", "<i>", "<u>", "<s>") if one in text]


def test_an_overlay_shows_magnitude_and_phase_of_its_entry_which_stays_where_it_is_in_a_little_noise():
    figure = maps.overlay(pairs(), 3, 5, further={"with it": 2 * pairs().predicted}).checked()
    by_name = {trace.name: trace for trace in figure.data if trace.showlegend and trace.yaxis == "y"}
    H = pairs().predicted[:, 3, 5]
    assert_allclose(by_name["predicted"].y, np.abs(H), rtol=1e-6)
    assert_allclose(by_name["measured, Eqs. 9 to 11"].y, 1.1 * np.abs(H), rtol=1e-6)
    assert_allclose(by_name["with it"].y, 2 * np.abs(H), rtol=1e-6)
    phase = next(trace for trace in figure.data if trace.name == "predicted" and trace.yaxis == "y2")
    assert_allclose(np.exp(1j * np.radians(phase.y)), H / np.abs(H), atol=1e-4)
    assert (by_name["predicted"].x0, by_name["predicted"].dx) == (4.0, 0.5)
    assert "kg m²" in figure.layout.yaxis.title.text
    noise = np.random.default_rng(0).normal(scale=0.02, size=100)
    shown = interactive.phase(-1.0 + 1j * noise)
    assert np.ptp(shown) < 10
    assert_allclose(shown, 180, atol=8)


@pytest.mark.parametrize(("entry", "unit"), [((0, 0), "kg"), ((0, 4), "kg m"), ((5, 1), "kg m"), ((3, 5), "kg m²")])
def test_units_of_the_entries(entry, unit):
    assert style.unit(*entry) == unit


def test_an_entry_that_symmetry_makes_nothing_shows_no_phase_and_a_map_keeps_its_worst_cell():
    figure = maps.overlay(pairs(), 0, 2).checked()
    low, _ = figure.layout.yaxis.range
    assert low > log10(1e-3)
    phase = next(trace for trace in figure.data if trace.name == "predicted" and trace.yaxis == "y2")
    assert np.isnan(phase.y).all()
    heat = maps.channel_map(channel_map()).checked().data[0]
    assert tuple(heat.y) == maps.labels(channel_map()) == ("fmd-z1", "fmd-z2", "force along x")
    assert tuple(heat.customdata[1, 20]) == (7.5, F[20])
    assert heat.z[1, 20] == 5  # the step from 6 to 10 sigma
    assert np.isnan(heat.z[2]).all()
    quiet = maps.channel_map(channel_map(), 0).checked().data[0]
    assert np.nanmax(quiet.customdata[:, :, 0]) == 0


def test_the_band_is_two_standard_deviations_wide_and_a_map_of_pairs_names_load_first():
    heat = maps.pair_map(pairs()).checked().data[0]
    row = list(heat.y).index("zβ")
    assert_allclose(heat.customdata[row, :, 0], pairs().sigma[:, 2, 4], rtol=1e-6)
    assert not np.allclose(heat.customdata[row, :, 0], pairs().sigma[:, 4, 2])
    figure = maps.overlay(pairs(), 1, 1).checked()
    low, high = (trace.y for trace in figure.data[:2])
    assert_allclose(high - low, 4 * 0.1, rtol=1e-2)  # single precision at a resonance
    assert figure.data[1].name == "expected, ± 2 σ"  # of a complex difference: of magnitudes no per cent is due in it


def test_levels_follow_the_bounds_of_the_scale_and_the_axis_of_evidence_is_linear_then_logarithmic():
    found = interactive.levels(np.array([0.0, 0.99, 1.0, 3.9, 4.0, 99.0, 100.0, 1e6, np.nan]))
    assert_allclose(found, [0, 0, 1, 3, 4, 8, 9, 9, np.nan])
    nats = np.array([-1000.0, -10.0, -3.0, 0.0, 5.0, 10.0, 100.0, 1000.0])
    assert_allclose(spec.signed_log(nats), [-30, -10, -3, 0, 5, 10, 20, 30])


def test_thinning_keeps_every_peak():
    frequency = np.linspace(0, 1, 1000)
    values = np.zeros((1000, 2))
    values[613, 1] = 9.0
    thin = interactive.worst(frequency, values, most=100)
    assert len(thin.middle) == len(thin.values) == len(thin.at) == 100
    assert thin.values[:, 1].max() == 9.0
    column = thin.values[:, 1].argmax()
    assert abs(thin.middle[column] - frequency[613]) < 0.01
    assert thin.at[column, 1] == frequency[613] != thin.middle[column]


@pytest.mark.parametrize("most", [100, 1000])
def test_a_line_that_nothing_checks_hides_no_other(most):
    values = np.ones((1000, 2))
    values[501, 0], values[[500, 502], 0], values[:, 1] = 80.0, np.nan, np.nan
    thin = interactive.worst(np.arange(1000.0), values, most=most)
    assert np.nanmax(thin.values[:, 0]) == 80.0
    assert thin.at[np.nanargmax(thin.values[:, 0]), 0] == 501.0
    assert np.isnan(thin.values[:, 1]).all()


def test_evidence_is_ranked_coloured_by_standing_and_told_with_its_size():
    figure = crosscheck.evidence(diagnosed()).checked()
    assert list(figure.layout.yaxis.categoryarray) == ["force-gain:fmd-z2", "cell-stiffness:2z", "force-gain:fmd-z1"]
    bars = {bar.y[0]: bar for bar in figure.data if bar.type == "bar"}
    assert {name: bar.name for name, bar in bars.items()} == {
        "force-gain:fmd-z2": "accepted",
        "cell-stiffness:2z": "cannot be told from it",
        "force-gain:fmd-z1": "leaves too much",
    }
    told = next(trace for trace in figure.data if trace.type == "scatter" and trace.mode == "text")
    assert "+174 nats" in told.text[0]
    assert "+8.0 % (+7.0 to +9.0)" in told.text[0]
    axis = figure.layout.xaxis
    apart = np.diff(axis.tickvals) / np.diff(axis.range)  # on paper no tick stands on its neighbour, none beyond the bars
    widest = max(len(text) for text in axis.ticktext) * interactive.LETTER / interactive.NARROW
    assert apart.min() > widest
    assert axis.tickvals[-1] <= max(max(bar.x) for bar in bars.values())
    behind = max(len(line) for text in told.text for line in text.split("<br>")) * interactive.LETTER / interactive.NARROW
    assert (axis.range[1] - max(told.x)) / np.diff(axis.range) > behind - 0.05


def test_the_ladder_follows_the_way_and_puts_branches_aside():
    figure = history.falling_errors(standing()).checked()
    strong = next(trace for trace in figure.data if trace.name == "plain, fitted data" and trace.showlegend)
    aside = next(trace for trace in figure.data if trace.name == "plain, fitted data" and not trace.showlegend)
    assert (list(strong.customdata), list(strong.y)) == ([0, 2], [4.0, 0.5])
    assert (list(aside.customdata), list(aside.x)) == ([1], [1])


def test_figures_beside_the_lower_axis_of_a_ladder_do_not_stand_upon_each_other():
    """In the panel of a workbench of 650 pixels it is 53 pixels high: "20", "10", "5", "2" and "1" were one blot."""
    at = standing()
    rungs = tuple(
        replace(one, errors=replace(one.errors, tolerance_z2=z2, expected_z2=30.0))
        for one, z2 in zip(at.ladder.rungs, (420.0, 420.0, 9.0), strict=True)
    )
    axis = history.falling_errors(replace(at, ladder=replace(at.ladder, rungs=rungs))).checked().layout.yaxis2
    assert np.diff(np.log10(axis.tickvals)).min() / np.diff(axis.range)[0] > 0.2


def test_inertia_is_shown_in_per_cent_and_millimetres_and_lines_that_were_left_out_are_marked():
    figure = history.identified_inertia({"plain": body()}).checked()
    of_mass, of_cog, _ = figure.data
    assert_allclose(of_mass.y[0], 1.0)
    assert_allclose(of_cog.y, [0.0, 0.0, 3.1], atol=1e-9)  # [mm]
    assert_allclose(of_mass.error_y.array[0], 100 * 1.959964 * 0.01 / 47.4, rtol=1e-6)
    left = next(trace for trace in identification.condition(LINES).checked().data if trace.name == "left out")
    assert_allclose(left.x, F[F >= 20])


@pytest.mark.parametrize(("low", "high"), [(0.0, 0.05), (1.5, 1.9), (-3.0, -0.5), (0.0, 5.0), (-0.001, 0.001)])
def test_a_logarithmic_axis_has_round_ticks_within_itself(low, high):
    ticks = interactive.decades(low, high)["tickvals"]
    assert 2 <= len(ticks) <= 12
    assert all(low - 1e-9 <= log10(tick) <= high + 1e-9 for tick in ticks)


def test_templates_are_json_and_differ():
    assert interactive.template_json(False) != interactive.template_json(True)
    assert "heatmap" in interactive.template_json(False)
