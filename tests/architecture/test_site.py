"""The site: every page, every link within it, every equation; search and nothing that needs a network."""

import html
import re
from html.parser import HTMLParser
from pathlib import Path
from typing import Any
from urllib.parse import unquote

import pytest

from tools import notebooks
from tools.pages import blocks, headings, links, pages
from tools.site import NOTEBOOKS, build

pytest.importorskip("sphinx", reason="Sphinx is absent; the extra `docs` brings it")


class Read(HTMLParser):
    """Names that a link may lead to, what links and pictures of a page lead to, and what it fetches by itself."""

    def __init__(self, path: Path) -> None:
        super().__init__()
        self.ids: set[str] = set()
        self.targets: list[str] = []
        self.fetched: list[str] = []
        self.feed(path.read_text(encoding="utf-8"))

    def handle_starttag(self, tag: str, attrs: list[tuple[str, str | None]]) -> None:
        found: dict[str, Any] = {name: value or "" for name, value in attrs}
        self.ids |= {found["id"]} if "id" in found else set()
        target = found.get("href") or found.get("src")
        if target is not None:
            self.targets.append(target)
            if tag != "a":
                self.fetched.append(target)


@pytest.fixture(scope="module")
def site(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    """Without the reference, which takes a minute; `make docs` has it, and so does the proof below."""
    folder = tmp_path_factory.mktemp("site")
    build(folder, root, reference=False)
    return folder


@pytest.fixture(scope="module")
def read(site: Path) -> dict[str, Read]:
    return {path.name: Read(path) for path in site.glob("*.html")}


def test_every_notebook_is_a_page_with_what_its_cells_show(site: Path, root: Path) -> None:
    for path in sorted((root / NOTEBOOKS).glob("*.ipynb")):
        page = (site / f"notebook-{path.stem}.html").read_text(encoding="utf-8")
        shown = [one for cell in notebooks.read(path)["cells"] for one in cell.get("outputs", ())]
        tables = sum("".join(one.get("data", {}).get("text/html", "")).count("<table>") for one in shown)
        assert shown, path.name
        assert page.count("<table>") == tables, path.name


def name(page: Path) -> str:
    return "overview.html" if page.name == "README.md" else f"{page.stem}.html"


def test_every_page_is_on_it_with_every_heading_and_every_picture(site: Path, root: Path, read: dict[str, Read]) -> None:
    for page in pages(root):
        text = (site / name(page)).read_text(encoding="utf-8")
        main = text[text.index("<article") : text.index("</article>")]
        assert len(re.findall(r"<h[1-6]>", main)) == len(headings(page)), page.name
        assert main.count("<img") == sum(link.picture for link in links(page)), page.name


def led_nowhere(site: Path, read: dict[str, Read]) -> list[str]:
    """Links and pictures of the site that lead to no file or to no place in it."""
    missing = []
    for page, one in read.items():
        for target in one.targets:
            path, _, anchor = target.partition("#")
            if re.match(r"https?:|data:|mailto:", target):
                continue
            file = (site / unquote(path.partition("?")[0])) if path else site / page
            there = file.is_file() and (not anchor or file.name not in read or unquote(anchor) in read[file.name].ids)
            missing += [] if there else [f"{page}: {target}"]
    return missing


def test_every_link_leads_somewhere_on_it_or_to_the_network(site: Path, read: dict[str, Read]) -> None:
    assert led_nowhere(site, read) == []
    read["broken.html"] = broken = Read(site / "index.html")
    broken.targets[:] = ["nowhere.html", "index.html#nowhere"]
    assert led_nowhere(site, read) == ["broken.html: nowhere.html", "broken.html: index.html#nowhere"]
    del read["broken.html"]


def test_it_fetches_nothing(read: dict[str, Read]) -> None:
    assert [(page, target) for page, one in read.items() for target in one.fetched if re.match(r"(https?:)?//", target)] == []


def test_it_is_searched_without_a_server(site: Path) -> None:
    index = (site / "searchindex.js").read_text(encoding="utf-8")
    assert index.startswith("Search.setIndex(")
    assert '"prior' in index or "prior:" in index
    assert 'src="searchindex.js"' in (site / "search.html").read_text(encoding="utf-8")


def test_every_equation_is_set(site: Path, root: Path) -> None:
    for page in pages(root):
        equations = [block for block in blocks(page) if block.language == "math"]
        text = html.unescape((site / name(page)).read_text(encoding="utf-8"))
        assert text.count("<math ") == len(equations), page.name
        for found in re.findall(r"<math .*?</math>", text, re.DOTALL):
            assert "\\" not in re.sub(r"<[^>]*>", "", found), f"{page.name}: a command that was not set: {found}"


def test_a_file_of_a_page_has_its_name_above_it(site: Path) -> None:
    assert "examples/effects/force_lowpass.py" in (site / "own-effect.html").read_text(encoding="utf-8")


def test_a_link_that_leads_nowhere_ends_the_building(root: Path, tmp_path: Path) -> None:
    pictures = tmp_path / "house" / "docs" / "pictures"
    pictures.mkdir(parents=True)
    (tmp_path / "house" / "docs" / "conf.py").write_text((root / "docs" / "conf.py").read_text("utf-8"), "utf-8")
    (tmp_path / "house" / "README.md").write_text("# Read me\n\n[there](#nowhere)\n", encoding="utf-8")
    (tmp_path / "house" / "docs" / "index.md").write_text("# All\n\n## One\n\n- [Overview](../README.md): it\n", encoding="utf-8")
    with pytest.raises(SystemExit, match="the site is not built"):
        build(tmp_path / "out", tmp_path / "house", reference=False)


@pytest.mark.proof
def test_the_reference_has_every_name_of_the_public_face(root: Path, tmp_path: Path) -> None:
    import massline

    build(tmp_path, root)
    page = Read(tmp_path / "reference" / "massline.html")
    functions = {
        one for one in massline.__all__ if callable(getattr(massline, one)) and not isinstance(getattr(massline, one), type)
    }
    assert {f"massline.{one}" for one in functions} <= page.ids
    assert "validation.diagnose.diagnose.diagnosed" in Read(tmp_path / "reference" / "validation.diagnose.diagnose.html").ids
