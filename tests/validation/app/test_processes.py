"""Every window has a process of its own, and none is left when it is closed."""

import signal
from typing import Any

import pytest


def number(page: Any) -> Any:
    """A field that is the window's own."""
    return page.locator("#band")


@pytest.mark.proof  # four windows; test_windows.py holds who keeps a process, test_page.py and test_door.py have such windows
def test_two_windows_do_not_disturb_each_other_a_reload_keeps_the_state_and_a_duplicated_tab_gets_its_own(start_app, visit):
    bench = start_app("--stay")
    first = visit(bench)
    number(first).fill("12")
    second = first.context.new_page()
    second.goto(f"http://{bench.host}/")
    assert number(second).input_value() == ""
    number(second).fill("34")
    assert number(first).input_value() == "12"
    assert first.url != second.url
    assert len(bench.windows()) == 2
    duplicated = second.context.new_page()
    duplicated.goto(first.url)
    number(duplicated).wait_for()
    assert duplicated.url not in (first.url, second.url)
    assert number(duplicated).input_value() == ""
    place, held = first.url, iter([True] * 7)
    told = lambda route: route.fulfill(json={"open": next(held, False)})  # noqa: E731 - the old page lets go slowly
    first.route("**/open", told)
    first.reload()
    assert number(first).input_value() == "12"
    assert first.url == place


def at_work(start_app: Any, visit: Any, until: Any, series: tuple[str, str]) -> tuple[Any, Any, list[int]]:
    """A workbench whose window has a worker that computes, its page, and all of its processes."""
    bench = start_app("--linger", "1", *series)
    page = visit(bench)
    page.locator("#cancel").wait_for()  # a comparison begins by itself
    assert until(lambda: len(bench.descendants()) > len(bench.windows()))
    return bench, page, bench.descendants()


@pytest.mark.parametrize(
    "ending", [*(pytest.param(one, marks=pytest.mark.proof) for one in ("the page is closed", "ctrl-c")), "the door is killed"]
)
def test_however_it_ends_every_window_and_its_work_are_gone(ending, start_app, visit, until, alive, series):
    bench, page, every = at_work(start_app, visit, until, series)
    if ending == "the page is closed":
        page.close()
        assert bench.process.wait(timeout=20) == 0
    else:
        page.context.close()
    if ending == "ctrl-c":
        assert bench.interrupted() == 0
    if ending == "the door is killed":
        bench.process.send_signal(signal.SIGKILL)
        bench.process.wait()
        assert until(lambda: not any(alive(one) for one in every), 5)
    assert not any(alive(one) for one in every)


@pytest.mark.parametrize(
    ("arguments", "said"),
    [
        (["nowhere.toml", "nowhere"], "no such file"),
        (["nowhere.toml"], "no such file"),
        (["alone.toml"], "nothing stands behind the model"),
        (["--example", "block", "a.toml", "b"], "an example brings its own"),
        (["--example", "blok"], "Known are block"),
    ],
)
def test_what_cannot_be_opened_is_said_before_anything_is_served(refused, arguments, said, tmp_path):
    (tmp_path / "alone.toml").write_text('format = 1\n[model]\narticle = "cuboid"\n', encoding="utf-8")
    arguments = [str(tmp_path / one) if one == "alone.toml" else one for one in arguments]
    assert said in refused("app", "--no-browser", *arguments)
