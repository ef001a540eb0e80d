"""A desk on tests of a structure by itself: response functions and a table of modes, held against a mesh of the user's own."""

import re
import shutil
from collections.abc import Callable
from dataclasses import dataclass, replace
from pathlib import Path

import numpy as np
import pytest
from numpy.testing import assert_allclose
from scipy.linalg import eigh

from fem.damping import Damping
from fem.user_model import reading
from geometry.errors import BadInput
from validation.app import curves, options, panels, scene3d, session, whatif
from validation.app.kept import Compared
from validation.app.opening import faults, sorted_out
from validation.app.session import Session, begun, opened
from validation.prediction import dynamic_mass
from validation.prediction.structure import by_itself
from validation.report.charts import maps
from validation.report.charts.functions import COHERENCE, FORMS, LOWER, NYQUIST, RATIO, SYSTEMS, DrawnCurves, ShownPair, Switches
from validation.report.scenes.scene import fitted
from validation.report.scenes.turntable import MARGIN, Turn, round_length, turned

LINES, COUNT, SOFTER = 60, 6, 0.9

TESTED = """
[[test]]
kind = "response-functions"
title = "struck"
gain = 0.02
share = 0.005
responses = ["a:x", "b:z", "c:z"]
files = [{ path = "0.csv", drive = "a:x" }, { path = "1.csv", drive = "c:z" }]
"""
SENSORS = ("a:x", "b:x", "a:y", "b:y", "c:z", "c:y")


@dataclass(frozen=True, eq=False, kw_only=True)
class Made:
    """Files of a portal of beams, its functions in the model file and its table of modes beside it, and a desk on both."""

    model: Path
    table: Path
    desk: Session
    compared: Compared


@pytest.fixture(scope="module")
def made(portal: Callable[..., Path], tmp_path_factory: pytest.TempPathFactory) -> Made:
    folder = tmp_path_factory.mktemp("portal")
    model = portal(folder, COUNT, loss=0.02, mesh="parts/portal.inp")
    model.write_text(model.read_text() + TESTED)
    # The structure itself answers, 10 % softer than it is drawn
    structure = reading.read(model)
    true = by_itself(structure, 320.0, damping=Damping(loss_factors=structure.loss_factors))
    softer = true.matrices.stiffness * SOFTER
    matrices = replace(true.matrices, stiffness=softer, structural=0.02 * softer)
    frequency = np.linspace(30.0, 300.0, LINES)

    def row(sensor: str) -> np.ndarray:
        place, axis = sensor.split(":")
        return matrices.places[place]["xyz".index(axis)]

    seen, driven = np.array([row(one) for one in ("a:x", "b:z", "c:z")]), np.array([row(one) for one in ("a:x", "c:z")])
    A = dynamic_mass.accelerance(matrices, frequency, seen, driven).matrix
    A = A * (1 + 0.003 * (np.random.default_rng(3).standard_normal((*A.shape, 2)) @ [1, 1j]))
    for k in range(2):
        numbers = np.column_stack([frequency, np.ascontiguousarray(A[:, :, k]).view(np.float64)])
        np.savetxt(folder / f"{k}.csv", numbers, delimiter=",", comments="", header="f,a re,a im,b re,b im,c re,c im")
    squares, shapes = eigh(softer, matrices.mass)
    table = [
        "format = 1",
        'kind = "modal-table"',
        'title = "table"',
        'article = "portal"',
        "gain = 0.02",
        f"sensors = {[*SENSORS]}",
    ]
    hertz = np.sqrt(squares[:3]) / (2 * np.pi)
    table.append(f"frequencies = {[f'{f:.4f} +/- {f / 500:.4f} Hz' for f in hertz]}")
    read = np.array([[float(row(one) @ shapes[:, k]) for one in SENSORS] for k in range(3)])
    (folder / "modes.toml").write_text("\n".join([*table, f"shapes = {read.round(6).tolist()}"]) + "\n")
    desk = begun(folder / "desks" / "w1" / "desk-0", model, [folder / "modes.toml"])
    return Made(model=model, table=folder / "modes.toml", desk=desk, compared=desk.compare())


def test_a_study_needs_no_data_beside_it_and_its_files_go_with_the_working_copy(made, tmp_path):
    asked = options.opened(None, str(made.model), ()).asked
    assert asked is not None
    assert asked.data == ()
    (tmp_path / "bare.toml").write_text('format = 1\n[model]\narticle = "fmd"\n')
    with pytest.raises(BadInput, match=r"names no \[\[test\]\]"):
        options.opened(None, str(tmp_path / "bare.toml"), ())
    assert [one for one in faults(str(made.model), (str(made.table),)) if one.grave] == []
    assert sorted_out(made.model.parent).data == (str(made.table),)
    beside = {one.relative_to(made.desk.model.parent).as_posix() for one in made.desk.model.parent.rglob("*") if one.is_file()}
    assert {"portal.toml", "parts/portal.inp", "0.csv", "1.csv"} <= beside
    assert made.desk.model_text() == made.model.read_text()


def test_what_is_compared_has_functions_and_modes_and_is_found_again(made):
    again = opened(made.desk.folder).comparison()
    for of in (made.compared, again):
        assert of.campaigns == ("struck", "table frequencies", "table shapes")
        functions = of.map("struck").functions
        assert functions.measured.shape == functions.predicted.shape == functions.expected.shape == (2, LINES, 3)
        table = of.table("table shapes")
        assert table is of.table("table frequencies")
        assert np.diag(table.mac).min() > 0.99
        assert table.measured_shapes.shape == (3, len(SENSORS))
        assert table.model_shapes.shape[1] == len(SENSORS)
    # The plain fit leaves the modulus where it is declared: 10 % softer is a frequency that is 5 % lower
    assert [round(one.percent) for one in made.compared.table("table shapes").pairs] == [5, 5, 5]


def test_a_second_window_on_the_same_data_computes_nothing_again(made, monkeypatch):
    def never(*_, **__):
        raise AssertionError("computed again")

    second = begun(made.desk.folder.parent.parent / "w2" / "desk-0", made.model, [made.table])
    monkeypatch.setattr(session, "comparison_on", never)
    assert second.comparison() is None
    assert second.take_over([second.folder, made.desk.folder])
    assert second.comparison().summary == made.compared.summary
    assert second.ladder().rung.errors is not None
    assert second.ladder().rung.stands_on(made.desk.ladder().rung.conditions)
    changed = made.model.parent / "changed"
    shutil.copytree(made.model.parent / "parts", changed / "parts")
    for name in ("portal.toml", "0.csv", "1.csv"):
        shutil.copy(made.model.parent / name, changed)
    (changed / "1.csv").write_text((changed / "1.csv").read_text().replace("30,", "30.0,", 1))
    third = begun(made.desk.folder.parent.parent / "w3" / "desk-0", changed / "portal.toml", [made.table])
    assert not third.take_over([made.desk.folder])  # another file, and other data in it


def test_an_effect_moves_the_functions_as_the_prediction_of_the_model_with_it(made):
    ready = whatif.table(made.desk)
    assert {one.id for one in whatif.reaching(ready)} >= {"point-mass:c", "modulus:posts", "accelerometer-gain:a-x"}
    found = whatif.what_if(ready, "point-mass:c=0.05", follow=False)
    (trace,) = [one for one in found.traces if one.campaign == "struck"]
    assert trace.matrix.shape == (LINES, 2, 3)
    named = whatif.parse("point-mass:c=0.05", ready.words, source="test")
    (one,) = [each for each in ready.predictions(named, fixed=True)[0] if each.measured.name == "struck"]
    assert_allclose(trace.matrix.swapaxes(0, 1), one.at(ready.offsets, derivatives=False).rows[..., 0], rtol=1e-12)
    assert found.plain_percent != found.before_percent
    dragged = whatif.what_if(ready, "point-mass:c=0.05", exact=False, follow=False)
    # Fewer lines are condensed by themselves; lines between those that were asked are off by far more
    asked = np.isclose(dragged.traces[0].matrix, trace.matrix, rtol=0, atol=1e-8 * np.abs(trace.matrix).max()).all(axis=(1, 2))
    assert asked.sum() >= 0.6 * LINES  # the others go with them


def test_the_structure_stands_swings_and_stands_beside_its_test(made):
    desk, compared = made.desk, made.compared
    still = scene3d.of_test(desk, compared, "struck", None, None)
    assert not still.table.moves
    assert "σ" in "".join(one.name for one in still.table._sensors) or not scene3d.failing(compared, "struck")
    swinging = scene3d.of_test(desk, compared, "struck", 0, None)
    assert swinging.table.moves
    table = compared.table("table shapes")
    pair = ShownPair.chosen(table, None)
    assert pair.at == (0, table.modes.index(table.pairs[0].model))
    assert "alike" in pair.words
    far = replace(table, pairs=(replace(table.pairs[0], percent=105.8), *table.pairs[1:]))
    assert "(+106 %)" in replace(pair, of=far).words
    assert_allclose(np.abs(pair.scaled), np.abs(table.model_shapes[pair.at[1]]), atol=0.02 * np.abs(table.model_shapes).max())
    both = scene3d.of_test(desk, compared, "table shapes", None, pair)
    moving = {one.name: one for one in both.table._bodies}
    largest = max(one.size.max() for one in moving.values())
    assert moving["test"].size.max() > 0.5 * largest
    assert moving["at rest"].size.max() == 0
    pictures = {share: both.table.jpeg(Turn(share=share)) for share in (-1.0, 1.0)}
    assert pictures[-1.0] != pictures[1.0]
    for one in (still, swinging, both):
        one.table.close()


def test_a_click_means_the_node_in_front_and_nothing_far_from_any(made):
    still = scene3d.of_test(made.desk, made.compared, "struck", None, None)
    turn = Turn(size=(500, 400))
    view = turned(fitted(still.table._points, turn.size, MARGIN), turn, still.table._points, still.table._near)
    for node in still.table._nodes[[0, 5, 12]]:
        x, y = view.pixel(node) + 2.0
        assert_allclose(still.table.picked(turn, (x, y)), node)
    assert still.table.picked(turn, (3.0, 3.0)) is None
    assert scene3d.of_test(made.desk, made.compared, "struck", 0, None).table.picked(turn, (x, y)) is None  # it swings


def test_what_is_tried_at_a_node_is_what_is_tried_at_a_place_there(made):
    here = "@0.15,0,0.24"
    ready = whatif.table(made.desk, (here,))
    assert {f"point-mass:{here}", f"cable:{here}:x", f"absorber:{here}"} <= {one.id for one in whatif.reaching(ready)}
    both = [whatif.what_if(ready, f"point-mass:{one}=0.05", follow=False).traces[0].matrix for one in ("c", here)]
    assert_allclose(both[0], both[1], rtol=1e-9)
    assert not np.allclose(both[0], whatif.what_if(ready, "point-mass:c=0.01", follow=False).traces[0].matrix)


def test_nodes_bear_the_colours_of_what_the_diagnosis_says_of_them(made, tmp_path):
    desk = opened(shutil.copytree(made.desk.folder, tmp_path / "desk"))
    assert desk.evidence("portal") == {}
    points = scene3d.of_test(made.desk, made.compared, "struck", None, None).table._nodes
    evidence = np.arange(len(points)) - 3.0
    np.savez(desk.found / session.NODES, **{"0.article": "portal", "0.points": points, "0.evidence.cable:x": evidence})
    assert desk.evidence("another") == {}
    assert_allclose(desk.evidence("portal")["cable:x"][1], evidence)
    shown = scene3d.of_test(desk, made.compared, "struck", None, None, kind="cable:x")
    assert "spring" in shown.note
    assert f"{evidence.max():.3g} nats" in shown.note
    (body,) = shown.table._bodies
    assert_allclose(body.size.max(), evidence.max())
    assert body.size.min() == 0
    assert not shown.table.moves


def test_every_switch_draws_what_it_says_and_plotly_takes_it(made):
    of = made.compared.map("struck")
    panel = maps.function_of(of, 0, 0, {})
    size = np.abs(of.functions.measured[0, :, 0])
    for form in FORMS:
        for lower in LOWER:
            for units in SYSTEMS:
                switches = Switches(form=form, lower=lower, units=units, logarithmic=units != "g", unwrapped=units == "g")
                curves = DrawnCurves(panel=panel, units=("m/s²", "N"), switches=switches, marked=100.0, title="x")
                figure = curves.figure()
                figure.checked()
                first = next(one for one in figure.data if one.get("name") == "measured")
                factor = {"SI": 1.0, "g": 1 / 9.80665, "in-lbf": 4.4482216 / 9.80665}[units]
                shown = np.hypot(first["x"], first["y"]) if form == NYQUIST else first["y"]
                if form == "magnitude" or form == NYQUIST:
                    assert_allclose(shown, factor * size, rtol=1e-6)
                said = [one["text"] for one in figure.layout.get("annotations", ())]
                assert ("the test states no coherence" in said) == (form == "magnitude" and lower == COHERENCE)
    pair = ShownPair.chosen(made.compared.table("table shapes"), (0, 0))
    for figure in (pair.mac(made.compared.modes_of("table shapes")), pair.shapes(dark=True)):
        figure.checked()
    mac = pair.mac(made.compared.modes_of("table shapes"))  # a number above its frequency, upright: they had been turned and cut
    assert mac.layout["xaxis"]["tickangle"] == 0
    assert all(re.fullmatch(r"\d+<br>[\d.]+", one) for one in mac.data[0]["x"])


def test_a_prediction_of_nothing_is_said_where_a_logarithm_hides_it(made):
    panel = maps.function_of(made.compared.map("struck"), 0, 0, {})
    measured, predicted = panel.curves
    nothing = replace(panel, curves=(measured, replace(predicted, values=0.0 * predicted.values, expected=None)))
    below = np.array(predicted.values)
    below[:5] = 0.0
    some = replace(panel, curves=(measured, replace(predicted, values=below, expected=None)))

    def said(panel, **switches) -> str:
        curves = DrawnCurves(panel=panel, units=("m/s²", "N"), switches=Switches(**switches), title="x")
        notes = curves.figure().layout.get("annotations", ())
        # Between the panels, where no point can lie below them, and the two apart
        where = {"y domain": (0, "top", "right"), "y2 domain": (1, "bottom", "left")}
        assert all((one["y"], one["yanchor"], one["xanchor"]) == where[one["yref"]] for one in notes)
        return "; ".join(one["text"] for one in notes)

    assert said(nothing) == "predicted is zero here"
    assert said(nothing, logarithmic=False) == ""
    assert said(nothing, lower=RATIO) == "predicted is zero here; no ratio: predicted is zero here"
    assert said(some) == f"predicted is below this axis at 5 of {LINES} lines"
    assert said(panel) == ""


def test_units_are_those_of_their_definitions():
    assert Switches().unit("N m", "rad/s²") == (1.0, "kg m²")
    factor, name = Switches(units="in-lbf").unit("N m", "rad/s²")
    assert name == "in lbf/(rad/s²)"
    assert_allclose(factor, 1 / (4.4482216152605 * 0.0254))
    factor, name = Switches(units="g").unit("N", "m/s²")
    assert (factor, name) == (9.80665, "N/g")
    assert_allclose(Switches(unwrapped=True).curves(np.exp(1j * np.linspace(0, 9, 50)))[1][-1], np.degrees(9.0))


def test_a_bar_of_lengths_is_round():
    assert [round_length(x) for x in (0.09, 0.1, 0.49, 7.0)] == pytest.approx([0.05, 0.1, 0.2, 5.0])


def test_a_list_never_shows_the_number_that_stands_for_nothing():
    from validation.app.window import first_state

    state = first_state()
    assert panels.AT_REST in {one["value"] for one in state["modes"]}
    assert curves.WORST_OF_ALL in {one["value"] for one in state["runs"]}
