"""What several tests ask for: the command line in this process, and a browser."""

import json
import re
import runpy
from collections.abc import Callable, Collection, Iterator
from dataclasses import replace
from pathlib import Path
from typing import Any

import numpy as np
import pytest

from geometry.dynamic_mass import MOTIONS
from identification.campaign import Campaign, Recording
from identification.campaign import Run as CampaignRun
from validation.cli import main
from validation.report import page
from validation.report.charts import history, static
from validation.report.scenes import scene
from validation.virtual_test.layout import mavis

Run = Callable[..., tuple[int, str, str]]


@pytest.fixture(scope="session", autouse=True)
def _coarse() -> Iterator[None]:
    """Scenes are drawn as fine as they are shown, a quarter of the work without OpenGL's hardware: pages draw them finer."""
    with pytest.MonkeyPatch.context() as patch:
        patch.setattr(scene, "SUPERSAMPLING", 1)
        yield


@pytest.fixture
def run(capsys, tmp_path, monkeypatch) -> Run:
    """``run(*arguments)`` in an empty folder: exit code, standard output, standard error."""
    monkeypatch.chdir(tmp_path)

    def call(*arguments: str) -> tuple[int, str, str]:
        code = main.run(list(arguments))
        printed = capsys.readouterr()
        return code, printed.out, printed.err

    return call


@pytest.fixture
def refused(run) -> Callable[..., str]:
    """``refused(*arguments)``: the words of a refusal, which answers nothing, shows no traceback and ends with 2."""

    def call(*arguments: str) -> str:
        code, out, err = run(*arguments)
        assert (code, out) == (main.BAD_INPUT, ""), err
        assert "Traceback" not in err
        return err

    return call


@pytest.fixture
def answer(run) -> Callable[..., Any]:
    """``answer(*arguments)``: the JSON object that is printed, and is all that is printed."""

    def call(*arguments: str) -> Any:
        code, out, err = run(*arguments, "--json")
        assert code == main.DONE, err
        return json.loads(out)

    return call


@pytest.fixture
def drawn(monkeypatch) -> list[Any]:
    """The figures that were finished."""
    figures: list[Any] = []
    finish = static.finish

    def finished(figure: Any, *arguments: Any) -> None:
        finish(figure, *arguments)
        figure.canvas.draw()
        figures.append(figure)

    for module in (static, history):
        monkeypatch.setattr(module, "finish", finished)
    return figures


@pytest.fixture(scope="session")
def own_campaign(root) -> dict[str, Any]:
    """What the example of a campaign of one's own defines: ``campaign()`` and its ``BLOCK``."""
    return runpy.run_path(str(root / "examples" / "own_campaign.py"))


CELLS = np.array([[0.12, 0.12, 0.0], [-0.12, 0.12, 0.0], [-0.12, -0.12, 0.0], [0.12, -0.12, 0.0]])
LINES = np.linspace(4.0, 16.0, 25)


@pytest.fixture(scope="session")
def meaningless() -> Callable[..., Campaign]:
    """``meaningless(runs, **changes)``: spectra that mean nothing, of the virtual shaker's 22 channels."""

    def made(runs: Collection[str] = MOTIONS, **changes: Any) -> Campaign:
        table, rng = mavis(CELLS, {}).table, np.random.default_rng(0)
        drawn = rng.standard_normal((2, len(runs), len(LINES), len(table)))
        values = zip(runs, drawn[0] + 1j * drawn[1], strict=True)
        campaign = Campaign(
            title="test",
            article="fmd+disc+cuboid",
            hardware="lab/1",
            table=table,
            runs=tuple(CampaignRun(name=name, file="", axis=name) for name in runs),
            recordings={name: Recording(names=table.names, values=own, frequency=LINES, source=name) for name, own in values},
        )
        return replace(campaign, **changes)

    return made


@pytest.fixture(scope="session")
def chromium(browser_path) -> Iterator[Any]:
    """A browser without a window, one for all tests of a process: playwright stands but one."""
    from playwright.sync_api import sync_playwright

    with sync_playwright() as playwright:
        opened = playwright.chromium.launch(executable_path=browser_path, args=list(page.flags()))
        yield opened
        opened.close()


BUTTONS = ["Download plot as a PNG", "Zoom", "Pan", "Zoom in", "Zoom out", "Reset axes"]
"""Above every figure, of report and workbench: no other."""

ELSEWHERE = re.compile(r"(?:https?|wss?|ftp):(?:\\?/){2}(?!www\.w3\.org/)[\w$\[{][^\s\"'`]*|[\"'`]//[\w-]+(?:\.[\w-]+)+")
"""A foreign address within a script. Those of w3.org are names of XML: nothing goes there."""


@pytest.fixture(scope="session")
def elsewhere() -> Callable[[str], list[str]]:
    """The foreign addresses that a script holds."""
    return ELSEWHERE.findall


@pytest.fixture(scope="session")
def leaves_by_no_click(script) -> Callable[..., None]:
    """``leaves_by_no_click(page, schemes, own)``: above every figure are the named buttons and its `own` alone; whichever is
    pressed, no window opens, nothing but `schemes` is asked for, and no link, form or frame leads away."""

    def holds(page: Any, schemes: Collection[str], own: Collection[str] = ()) -> None:
        opened: list[str] = []
        asked: list[str] = []
        page.context.on("page", lambda one: opened.append(one.url))
        page.on("request", lambda one: asked.append(one.url))
        figures = page.locator(".js-plotly-plot")
        assert figures.count()
        for number in range(figures.count()):
            buttons = figures.nth(number).locator(".modebar-btn")
            titles = buttons.evaluate_all("all => all.map(one => one.getAttribute('data-title'))")
            assert sorted(titles) == sorted([*BUTTONS, *own])
            for k, title in enumerate(titles):
                if number and title == BUTTONS[0]:  # a picture takes its time: of the first figure
                    continue
                buttons.nth(k).evaluate("one => one.dispatchEvent(new MouseEvent('click', { bubbles: true }))")
        page.wait_for_timeout(500)
        assert page.evaluate(script("leads_away")) == []
        assert opened == []
        assert {url.partition(":")[0] for url in asked} <= set(schemes)

    return holds


@pytest.fixture(scope="session")
def script() -> Callable[[str], str]:
    """A script of the folder js, to be evaluated in a page."""
    return lambda name: (Path(__file__).with_name("js") / f"{name}.js").read_text(encoding="utf-8")


@pytest.fixture(scope="session")
def two_floors() -> str:
    """The file of a frame of two floors on four legs, moving along x."""
    return """format = 1
[fe_model]
kind = "frame"
nodes = { foot = "0 mm", floor-1 = "150 mm", floor-2 = "300 mm" }
fixed = ["foot"]
moves = ["x"]
members = { legs-1 = ["foot", "floor-1"], legs-2 = ["floor-1", "floor-2"] }
section = { width = "25 mm", thickness = "3 mm", across = "x", count = 4 }
material = { youngs_modulus = "70 GPa", poisson_ratio = 0.3 }
masses = { floor-1 = "5 kg", floor-2 = "5 kg" }
"""


BRACKET = """format = 1
model = { title = "Column and arm", article = "bracket" }
[fe_model]
kind = "matrices"
units = "mm-t-N-s"
support = "ground"
file = "bracket-parts.npz"
places = { foot = 101, low = 103, mid = 105, elbow = 107, arm = 109, tip = 110 }
[fe_model.joints.soil]
between = ["foot", "ground"]
stiffness = ["1e6 N/mm", "1e6 N/mm", "1e6 N/mm", "1e9 N mm/rad", "1e9 N mm/rad", "1e9 N mm/rad"]
"""


@pytest.fixture(scope="session")
def bracket(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """A column and an arm of ten nodes with coordinates, on stiff ground; ``free.toml`` beside it floats."""
    folder = tmp_path_factory.mktemp("bracket")
    own = runpy.run_path(str(root / "examples" / "own_model.py"))
    nodes, coordinates, _, _ = own["bracket"]()
    dof = np.array([(node, component) for node in nodes for component in range(1, 7)])
    np.savez(folder / "bracket-parts.npz", dof=dof, nodes=nodes, coordinates=coordinates, **own["parts"]())
    (folder / "bracket.toml").write_text(BRACKET)
    (folder / "free.toml").write_text(BRACKET.replace('"ground"', '"free"', 1).partition("[fe_model.joints")[0])
    return folder / "bracket.toml"


THREE_FLOORS = """\
format = 1
model = {{ title = "Three floors", article = "frame" }}
[fe_model]
kind = "frame"
nodes = {{ foot = "0 mm", floor-1 = "150 mm", floor-2 = "300 mm", floor-3 = "450 mm" }}
fixed = ["foot"]
moves = ["x"]
members = {{ legs-1 = ["foot", "floor-1"], legs-2 = ["floor-1", "floor-2"], legs-3 = ["floor-2", "floor-3"] }}
section = {{ width = "25 mm", thickness = "3 mm", across = "x", count = 4 }}
material = {{ youngs_modulus = "70 GPa", poisson_ratio = 0.3 }}
masses = {{ floor-1 = "5 kg", floor-2 = "5 kg", floor-3 = "5 kg" }}
loss_factor = {loss}
"""
STRUCK = """\
[[test]]
kind = "response-functions"
article = "frame"
file = "data.csv"
drive = "floor-1:x"
responses = ["floor-1:x", "floor-2:x", "floor-3:x"]
"""


@pytest.fixture(scope="session")
def three_floors() -> Callable[..., str]:
    """``three_floors(loss=0.02, struck=False)``: the model file of a frame; `struck` has its test in ``data.csv``, too."""

    def text(loss: float = 0.02, *, struck: bool = False) -> str:
        return THREE_FLOORS.format(loss=loss) + (STRUCK if struck else "")

    return text


WIDE, HIGH = 300.0, 240.0
"""[mm] of a portal."""

PORTAL = """
format = 1
model = {{ title = "A frame", article = "portal" }}
[fe_model]
kind = "mesh"
units = "mm"
file = "{mesh}"
support = "ground"
interface = ["HELD"]
places.a = ["0 mm", "0 mm", "240 mm"]
places.b = ["300 mm", "0 mm", "240 mm"]
places.c = ["150 mm", "0 mm", "240 mm"]
[fe_model.parts.posts]
material = "steel"
section = {{ width = "12 mm", height = "8 mm" }}
loss_factor = {loss}
[fe_model.parts.lintel]
material = "steel"
section = {{ width = "12 mm", height = "8 mm" }}
loss_factor = {loss}
"""


@pytest.fixture(scope="session")
def portal() -> Callable[..., Path]:
    """``portal(folder, count, loss=0.01, mesh="portal.inp")``: two posts and a lintel of `count` beams each; its model file."""

    def written(folder: Path, count: int, *, loss: float = 0.01, mesh: str = "portal.inp") -> Path:
        left = [(0.0, HIGH * k / count) for k in range(count + 1)]
        top = [(WIDE * k / count, HIGH) for k in range(1, count + 1)]
        right = [(WIDE, HIGH * (1 - k / count)) for k in range(1, count + 1)]
        nodes = [*left, *top, *right]
        lines = ["*NODE", *(f"{k + 1}, {x:g}, 0, {z:g}" for k, (x, z) in enumerate(nodes))]
        for part, some in (("posts", [*range(count), *range(2 * count, 3 * count)]), ("lintel", range(count, 2 * count))):
            lines += [f"*ELEMENT, TYPE=B31, ELSET={part}", *(f"{k + 1}, {k + 1}, {k + 2}" for k in some)]
        (folder / mesh).parent.mkdir(parents=True, exist_ok=True)
        (folder / mesh).write_text("\n".join([*lines, "*NSET, NSET=HELD", "1,", f"{len(nodes)},"]) + "\n")
        (folder / "portal.toml").write_text(PORTAL.format(mesh=mesh, loss=loss))
        return folder / "portal.toml"

    return written
