"""What a window does with clicks that come at a bad moment, without a browser."""

import asyncio
import threading
import time
from collections.abc import Awaitable, Callable
from pathlib import Path
from types import SimpleNamespace
from typing import Any

import numpy as np
import pytest

from validation.app import curves, panels, state, transfer, whatif, workers
from validation.app.opening import Handed
from validation.app.options import StartOptions
from validation.app.state import WindowState
from validation.app.workers import CANCELLED, FAILED, RUNNING, Job


class State(SimpleNamespace):
    """As trame's, as far as it is used."""

    def flush(self) -> None:
        pass

    def update(self, said: dict[str, Any]) -> None:
        vars(self).update(said)

    def __getitem__(self, name: str) -> Any:
        return getattr(self, name)


def bench(folder: Path, **state: Any) -> WindowState:
    from validation.app.window import first_state

    return WindowState(state=State(**first_state() | state), folder=folder, opened=StartOptions())


def run(work: Callable[[], Awaitable[None]]) -> None:
    async def whole() -> None:
        await work()

    asyncio.run(whole())


def tried(written: str = "force-gain:fmd-z2=0.1", *, followed: bool) -> Any:
    matrix = np.arange(36.0).reshape(1, 6, 6) * np.ones((3, 1, 1)) + 0j
    trace = SimpleNamespace(campaign="a", matrix=matrix, after=matrix[:, 2, 2], reached=True, frequency=np.arange(3.0))
    return SimpleNamespace(written=written, traces=(trace,), before_percent=2.0, plain_percent=1.0, facts={}, followed=followed)


SLIDER = SimpleNamespace(key="", whole=False, logarithmic=False, low=0.0, high=1.0, per_si=1.0, label="", shown_unit="", start=0)


def test_the_answer_says_whether_anything_was_fitted_and_another_entry_has_its_own_curve(tmp_path):
    assert "nothing fitted" in curves._said(tried(followed=False), "the plain fit")
    said = curves._said(tried(followed=True), "the plain fit")
    assert "nothing" not in said
    assert "fitted anew beside it" in said
    of = bench(tmp_path, campaign="a", load=2, motion=2)
    of.tried = tried(followed=True)
    of.state.load, of.state.motion = 1, 4
    (matrix,) = curves.with_effect(of).values()
    assert np.array_equal(matrix[:, 1, 4], np.full(3, 10.0))


def test_a_slider_that_is_put_aside_while_it_moves_ends_quietly(tmp_path, monkeypatch):
    effect = SimpleNamespace(id="x", sliders=(SLIDER,), written=lambda sizes: f"x={sizes}")

    def slow(*_, **__):
        time.sleep(0.1)
        return tried(followed=True)

    monkeypatch.setattr(whatif, "what_if", slow)

    async def story():
        of = bench(tmp_path, campaign="a", effect={"id": "x"})
        of.effects, of.table, of.sizes = {"x": effect}, object(), {"": 0.0}  # type: ignore[assignment, dict-item]
        await curves.drag(of, "", 300)
        await asyncio.sleep(0.02)
        await curves.chosen(of, None)
        assert of.dragging is not None
        await asyncio.wait_for(of.dragging, 5)
        assert of.state.failure == ""
        assert of.tried is None

    run(story)


def test_a_slider_that_moves_on_does_not_wait_for_what_is_computed_where_it_rested(tmp_path, monkeypatch):
    effect = SimpleNamespace(id="x", sliders=(SLIDER,), written=lambda sizes: f"x={sizes['']}")
    resting, go_on, asked = threading.Event(), threading.Event(), []

    def what_if(_, written, *__, exact=True):
        asked.append((written, exact))
        if exact:
            resting.set()
            assert go_on.wait(10)
        return tried(written, followed=True)

    async def nothing(_):
        pass

    monkeypatch.setattr(whatif, "what_if", what_if)
    monkeypatch.setattr(curves, "drawn", nothing)
    monkeypatch.setattr(curves, "keep", lambda _: None)
    monkeypatch.setattr(curves, "RESTS", 0.05)

    async def story():
        of = bench(tmp_path, campaign="a", load=2, motion=2, effect={"id": "x"})
        of.effects, of.table, of.sizes = {"x": effect}, SimpleNamespace(at="the plain fit"), {"": 0.0}  # type: ignore[assignment, dict-item]
        await curves.drag(of, "", 300)
        await asyncio.to_thread(resting.wait, 10)
        await curves.drag(of, "", 400)
        while ("x=0.4", False) not in asked:  # for ever, did it wait
            await asyncio.sleep(0.01)
        assert ("x=0.4", True) not in asked
        go_on.set()
        await asyncio.gather(*of.tasks)
        while of.tasks:
            await asyncio.gather(*of.tasks)
        assert of.tried.written == "x=0.4"
        assert asked[-1] == ("x=0.4", True)

    run(story)


class Worker:
    """One that dies slowly, and tells every look at it meanwhile as a failure."""

    def __init__(self, said: str) -> None:
        self.said, self.ending = said, False

    def job(self) -> Job:
        return Job(kind="add", asked={}, state=FAILED if self.ending else RUNNING)

    def wait(self, seconds: float) -> Job:
        return self.job()

    def cancel(self) -> Job:
        self.ending = True
        time.sleep(4 * state.PACE)
        return Job(kind="add", asked={}, state=CANCELLED, said=self.said)


@pytest.mark.parametrize(("said", "told"), [("", "nothing has changed."), ("rung 1 stays on the ladder",) * 2])
def test_a_cancelled_add_is_told_as_the_desk_left_it(tmp_path, monkeypatch, said, told):
    stood: list[WindowState] = []

    async def stands(of):
        stood.append(of)

    monkeypatch.setattr(panels, "stands", stands)
    monkeypatch.setattr(workers, "start", lambda *_, **__: Worker(said))

    async def story():
        of = bench(tmp_path, effect={"id": "x"})
        of.session, of.effects = object(), {"x": SimpleNamespace(written=lambda _: "x=1")}  # type: ignore[assignment, dict-item]
        await panels.add(of)
        await state.cancel(of)
        await asyncio.gather(*of.tasks)
        assert of.state.failure == ""
        assert told in of.state.ready["text"]
        assert stood == [of]

    run(story)


def test_a_mended_file_is_dropped_again_under_its_name(tmp_path, monkeypatch):
    opened: list[str] = []

    async def taken(of, _):
        opened.append(Path(of.state.model_path).read_text(encoding="utf-8"))

    monkeypatch.setattr(transfer, "_opened", taken)

    async def story():
        of = bench(tmp_path, data_paths="/somewhere")
        for text in (b"model = 1", b"model = 2"):
            await transfer.arrived(of, [Handed(name="s/model.toml", content=text)])
        assert opened == ["model = 1", "model = 2"]
        of.state.opening = True
        await transfer.arrived(of, [Handed(name="s/model.toml", content=b"model = 3")])
        assert len(opened) == 2
        assert "when that is done" in of.state.failure

    run(story)


def test_clicks_do_not_wait_behind_figures(tmp_path):
    (tmp_path / "a.png").write_bytes(b"png")

    async def story():
        of = bench(tmp_path)
        of.session = SimpleNamespace(folder=tmp_path, draw=lambda *_: time.sleep(0.5) or (tmp_path / "a.png",))  # type: ignore[assignment]
        drawing_them = asyncio.ensure_future(transfer.figures(of))
        await asyncio.sleep(0.05)
        assert of.state.job["cancellable"] is False  # no button that does nothing
        await asyncio.wait_for(of.away(lambda: None), 0.2)
        await drawing_them
        assert of.state.ready["links"][0]["name"] == "figures.zip"

    run(story)


def test_a_click_on_the_map_goes_to_the_worst_line_of_its_column(tmp_path, monkeypatch):
    async def drawn(_):
        pass

    monkeypatch.setattr(curves, "drawn", drawn)
    monkeypatch.setattr(panels, "nearest", drawn)

    async def story():
        of = bench(tmp_path, campaign="a", map_kind="pairs")
        of.compared = SimpleNamespace(map=lambda _: SimpleNamespace(data_set="a"))  # type: ignore[assignment]
        await panels.cell(of, {"x": 10.0, "y": "zβ", "custom": [7.1, 10.4]})
        assert (of.state.load, of.state.motion, of.state.marked) == (2, 4, 10.4)
        await panels.cell(of, {"x": 12.0, "y": 1.0, "custom": []})  # the triangle of a mode
        assert of.state.marked == 10.4

    run(story)


def test_modes_far_from_what_was_clicked_say_so():
    assert panels.apart(8.0, 8.4) == ""
    assert "8 Hz" in panels.apart(8.0, 351.0)


def test_what_nobody_saved_is_kept_where_the_terminal_says(tmp_path, monkeypatch, series):
    from validation.app.session import begun

    desk = begun(tmp_path / "home" / "abc" / "desk-0", series[0], [series[1]])
    monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path / "cache"))
    said: list[str] = []
    rungs = {"of": 1}
    monkeypatch.setattr(state, "_rungs", lambda _: rungs["of"])
    state.saved(desk)
    state.leaving_kept(tmp_path / "home", said.append)
    assert said == []
    rungs["of"] = 2
    assert state.unsaved(desk.folder)
    state.leaving_kept(tmp_path / "home", said.append)
    kept = Path(said[0].splitlines()[-1].strip())
    assert kept.read_bytes() == desk.model.read_bytes()
    assert kept.is_relative_to(tmp_path / "cache")
    state.saved(desk)
    assert not state.unsaved(desk.folder)


def test_how_far_work_is_is_told_in_per_cent_with_the_time_that_is_left():
    told = state.line("Comparing: fitting", 0.25, seconds=30.0, step_began=20.0, cancellable=True)
    assert (told["percent"], told["words"]) == (25, "25 %, about 30 s left, 30 s so far")
    assert state.line("x", 0.1, 100.0, 0.0, cancellable=True)["words"] == "10 %, about 15.0 min left, 100 s so far"
    assert state.line("x", 0.0, 3.0, 0.0, cancellable=True)["words"] == "0 %, 3 s so far"


def test_how_curves_are_shown_is_remembered_by_windows_to_come(tmp_path, monkeypatch):
    from validation.app.window import first_state

    monkeypatch.setenv("MASSLINE_CACHE", str(tmp_path))
    of = bench(tmp_path)

    async def story():
        for name, wanted in (("units", "in-lbf"), ("logarithmic", "False"), ("form", "nonsense"), ("none", "True")):
            await panels.switch(of, name, wanted)

    run(story)
    assert (of.state.units, of.state.logarithmic, of.state.form) == ("in-lbf", False, "magnitude")
    later = first_state()
    assert (later["units"], later["logarithmic"], later["lower"]) == ("in-lbf", False, "phase")
    kept = tmp_path / state.PLACE / state.SWITCHED
    for damaged in ("[", "[1]", '{"units": [1], "form": "x"}'):
        kept.write_text(damaged, encoding="utf-8")
        assert first_state()["units"] == "SI"
