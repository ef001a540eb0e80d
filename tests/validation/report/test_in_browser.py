"""The page in a browser: opened from the disk it draws every figure, complains of nothing, asks nobody, and prints light."""

import re
from base64 import b64decode
from gzip import decompress

import numpy as np
import pytest

from validation.report.charts import interactive, spec
from validation.report.document import Figures, Safe, joined
from validation.report.page import framed

TURNED = "getComputedStyle(document.querySelector('.picture img')).filter"
SURFACE = "document.querySelector('.plot')._fullLayout.paper_bgcolor"


@pytest.fixture(scope="module")
def light(opened, page):
    """The page in one tab for those who leave it as it was: to draw every figure takes seconds."""
    with opened(page) as found:
        yield found
        assert found.complaints == []


@pytest.fixture(scope="module")
def dark(opened, page):
    """The same for a reader whose system is dark."""
    with opened(page, color_scheme="dark") as found:
        yield found
        assert found.complaints == []


def test_from_the_disk_it_draws_everything_asks_nobody_and_fits_its_window(light, page):
    assert light.tab.evaluate("document.documentElement.dataset.drawn") == "all"
    drawn = light.tab.evaluate("[...document.querySelectorAll('.plot')].map(plot => plot.querySelectorAll('.main-svg').length)")
    assert drawn
    assert all(drawn)
    assert light.complaints == []
    assert {url.partition(":")[0] for url in light.requests} <= {"file", "data", "blob"}
    assert [url for url in light.requests if url.startswith("file")] == [page.as_uri()]
    for width in (1920, 500, 1366):
        light.tab.set_viewport_size({"width": width, "height": 900})
        light.becomes(f"document.documentElement.scrollWidth <= {width}", True)
        light.becomes("[...document.querySelectorAll('.plot')].every(one => one._fullLayout.width <= one.clientWidth + 1)", True)


@pytest.mark.parametrize("scheme", ["light", "dark"])
def test_light_and_dark_follow_the_reader_and_the_switch_and_every_text_stands_out(request, scheme, script):
    surfaces = {"light": "#ffffff", "dark": "#171b22"}
    other = {"light": "dark", "dark": "light"}[scheme]
    found = request.getfixturevalue(scheme)
    assert found.tab.evaluate(SURFACE) == surfaces[scheme]
    assert (found.tab.evaluate(TURNED) != "none") == (scheme == "dark")  # pictures are drawn on white
    assert found.tab.evaluate(script("contrast")) == []
    assert found.tab.evaluate(script("unlabelled")) == []
    found.tab.focus("#theme")
    found.tab.keyboard.press("Enter")
    found.becomes(SURFACE, surfaces[other])
    assert found.tab.evaluate("document.documentElement.dataset.theme") == other
    assert (found.tab.evaluate(TURNED) != "none") == (other == "dark")
    assert found.tab.evaluate(script("contrast")) == []
    found.tab.keyboard.press("Enter")
    found.becomes(SURFACE, surfaces[scheme])
    found.tab.evaluate("delete document.documentElement.dataset.theme")  # as it was opened
    assert found.complaints == []


def test_any_entry_is_chosen_by_keyboard_and_a_table_copies_with_all_digits(light, read):
    for part, below in (("load", 3), ("motion", 4)):
        light.tab.focus(f"select[data-choice='entry-0'][data-part='{part}']")
        for key in ("Home", *below * ("ArrowDown",)):
            light.tab.keyboard.press(key)
    light.becomes("document.querySelector('.plot[data-group=entry-0]').layout.title.text.slice(0, 4)", "H αβ")
    light.tab.select_option("select[data-choice='map-0']", "2")
    light.becomes("document.querySelector('.plot[data-group=map-0]').layout.title.text.includes('the z-sweep')", True)
    light.tab.evaluate("navigator.clipboard.writeText = async (text) => { window.copied = text; }")
    light.tab.locator("#where .table", has_text="The four errors").first.locator("button.copy").click()
    light.becomes("window.copied !== undefined", True)
    lines = [line.split("\t") for line in light.tab.evaluate("window.copied").split("\n")]
    assert light.tab.inner_text("#told") == "The table is copied: paste it into a spreadsheet."
    errors = read.table("The four errors")
    assert [line[0] for line in lines] == [row[0] for row in errors.rows]
    assert float(lines[2][1]) == errors.row("plain error")[1]
    assert {len(line) for line in lines} == {5}


def test_paper_is_light_and_without_controls(dark):
    dark.tab.emulate_media(media="print", color_scheme="dark")
    dark.tab.evaluate("dispatchEvent(new Event('beforeprint'))")
    assert dark.tab.evaluate(SURFACE) == "#ffffff"
    assert dark.tab.evaluate("getComputedStyle(document.querySelector('section')).backgroundColor") == "rgb(255, 255, 255)"
    assert dark.tab.evaluate(TURNED) == "none"
    assert not dark.tab.locator("button.copy").first.is_visible()
    assert not dark.tab.locator("nav.screen-only").is_visible()
    assert dark.tab.locator("nav.paper-only").is_visible()
    dark.tab.evaluate("dispatchEvent(new Event('afterprint'))")
    assert dark.tab.evaluate(SURFACE) == "#171b22"
    dark.tab.emulate_media(media="screen", color_scheme="dark")


STANDING = ("accepted", "cannot be told from it", "adds too little", "leaves too much")


def test_on_paper_rows_of_a_long_map_bear_as_many_names_as_fit_and_a_legend_of_many_lines_leaves_the_title(opened, tmp_path):
    rows = tuple(f"dof-{k}" for k in range(58))
    long = spec.HeatMap(title="shapes", frequency=np.arange(1.0, 6.0), rows=rows, values=np.ones((5, 58)), along="mode")
    causes = tuple(f"connection-compliance:legs-{k}@floor-{k}:beta" for k in range(4))
    bars = [
        spec.Bars(
            name=name, rows=(cause,), values=(30.0,), words=("+30 nats   846 µrad/(N m) (826 to 857)",), roles=name, about=("",)
        )
        for name, cause in zip(STANDING, causes, strict=True)
    ]
    panel = spec.BarPanel(label="evidence [nats]", rows=causes, bars=tuple(bars), scale=spec.EVIDENCE, asked=4 * (8.0,))
    told = spec.BarChart(title="Evidence", note="", panels=(panel,), legend={name: name for name in STANDING})
    figures = Figures()
    placed = joined(figures.placed(interactive.heat_map(long, False)), figures.placed(interactive.evidence(told, False)))
    page = tmp_path / "page.html"
    page.write_text(framed("figures", Safe(""), [("figures", "Figures", placed)], figures, "0"), encoding="utf-8")
    with opened(page) as found:
        found.tab.emulate_media(media="print")
        found.tab.evaluate("dispatchEvent(new Event('beforeprint'))")
        found.becomes("document.querySelector('.plot')._fullLayout.width", 799)
        names = "[...document.querySelector('.yaxislayer-above').querySelectorAll('text')]"
        boxes = found.tab.evaluate(f"{names}.map(one => one.getBoundingClientRect().y)")
        assert 20 < len(boxes) < 58
        assert np.diff(sorted(boxes)).min() > 10  # [px] as high as letters
        title, legend = (
            found.tab.evaluate(f"document.querySelectorAll('.plot')[1].querySelector('{one}').getBoundingClientRect().toJSON()")
            for one in (".gtitle", ".legend")
        )
        assert title["bottom"] <= legend["top"]


def test_no_click_leads_out_of_the_house(light, leaves_by_no_click):
    leaves_by_no_click(light.tab, {"file", "data", "blob"})
    assert light.complaints == []


def test_what_would_share_a_figure_has_nowhere_to_go(light):
    """The function that plotly.js offers for it is still in its script: nothing calls it, and it has no address."""
    context = light.tab.evaluate(
        "[...document.querySelectorAll('.plot')].map(({ _context: one }) =>"
        " [one.plotlyServerURL, one.showSendToCloud, one.displaylogo])"
    )
    assert context
    assert {tuple(one) for one in context} == {("", False, False)}


def test_no_script_of_the_page_holds_a_foreign_address_and_one_is_seen_elsewhere(page, elsewhere):
    text = page.read_text("utf-8")
    scripts = re.findall(r"<script[^>]*>(.*?)</script>", text, flags=re.DOTALL)
    packed = re.findall(r'<script type="text/plain"[^>]*>(.*?)</script>', text, flags=re.DOTALL)
    unpacked = [decompress(b64decode(one)).decode() for one in packed]
    assert len(unpacked) == 2
    assert "plotly.js v" in unpacked[0]
    assert [elsewhere(one) for one in (*scripts, *unpacked)] == [[]] * (len(scripts) + 2)
    for address in ("https://cloud.plotly.com/newchart", "http://x.y", r"https:\/\/x.y/z", "wss://${host}/", "//cdn.x.y/a.js"):
        assert elsewhere(f'const u = "{address}";') != [], address
    assert elsewhere('document.createElementNS("http://www.w3.org/2000/svg", "g"); // drawn') == []
