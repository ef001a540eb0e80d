"""The pages hang together: every link and picture leads somewhere, every page is found from the index, every picture is shown."""

import importlib
import re
from contextlib import suppress
from pathlib import Path

import pytest

from tools.pages import FIRST, WORDS, Link, anchors, first_words, links, pages, title

ROOT = Path(__file__).parents[2]
PAGES = pages(ROOT)
INDEX = ROOT / "docs" / FIRST
PICTURES = ROOT / "docs" / "pictures"

by_name = pytest.mark.parametrize("page", PAGES, ids=lambda page: page.name)


def led_to(page: Path, link: Link) -> Path:
    """The file that a link of `page` leads to."""
    return (page.parent / link.target.partition("#")[0]).resolve() if not link.target.startswith("#") else page


def inside(page: Path) -> list[Link]:
    return [link for link in links(page) if not link.outside]


@by_name
def test_every_link_leads_to_a_file_and_every_anchor_to_a_heading(page: Path) -> None:
    for link in inside(page):
        path, _, name = link.target.partition("#")
        assert led_to(page, link).exists(), f"{page.name}: there is no {link.target}"
        assert not path.startswith("/"), f"{page.name}: {link.target} works in no other folder"
        if name:
            assert name in anchors(led_to(page, link)), f"{page.name}: {link.target} has no such heading"


@by_name
def test_a_link_to_code_names_what_is_defined_there(page: Path) -> None:
    for link in inside(page):
        if link.target.endswith(".py") and re.fullmatch(r"`[a-z_]+(\.\w+)+`", link.text):
            name = link.text.strip("`")
            assert led_to(page, link) == defined_in(name), f"{page.name}: {name} is not defined in {link.target}"


def defined_in(name: str) -> Path | None:
    """The file of the repository in which the module, function, class, method or constant called `name` stands."""
    parts = name.split(".")
    for count in range(len(parts), 0, -1):
        with suppress(ModuleNotFoundError):
            found = module = importlib.import_module(".".join(parts[:count]))
            for step in parts[count:]:
                found = getattr(found, step, None)
            return None if found is None else file_of(getattr(found, "__module__", module.__name__))
    return None


def file_of(module: str) -> Path:
    """Under the repository, wherever the packages under test were imported from."""
    path = ROOT / module.replace(".", "/")
    return path / "__init__.py" if path.is_dir() else path.with_suffix(".py")


def test_the_index_names_every_page_once_with_a_line() -> None:
    lines = [line for line in INDEX.read_text(encoding="utf-8").splitlines() if line.startswith("- [")]
    named = [re.match(r"- \[[^\]]+\]\(([^)#]+)\): \S", line) for line in lines]
    assert all(named), "write `- [Name](page.md): what it is for`"
    others = sorted(page.name for page in PAGES if page.parent == INDEX.parent and page != INDEX)
    found = [one[1] for one in named if one is not None]
    assert sorted(name for name in found if not name.startswith("../")) == others


@pytest.mark.parametrize("start", [INDEX, PAGES[0]], ids=lambda page: page.name)
def test_every_page_is_found_by_following_links(start: Path) -> None:
    found, open_ = {start}, [start]
    while open_:
        page = open_.pop()
        new = {led_to(page, link) for link in inside(page)} & set(PAGES) - found
        found |= new
        open_ += new
    assert found == set(PAGES)


@by_name
def test_a_page_begins_with_its_title(page: Path) -> None:
    assert page.read_text(encoding="utf-8").startswith(f"# {title(page)}\n")


def shown() -> dict[Path, set[str]]:
    """By picture the pages that show it."""
    found: dict[Path, set[str]] = {}
    for page in PAGES:
        for link in links(page):
            if link.picture and not link.outside:
                found.setdefault(led_to(page, link), set()).add(page.name)
    return found


def test_every_picture_is_shown_in_the_gallery_and_has_words_for_who_cannot_see_it() -> None:
    in_gallery = {path.name for path, where in shown().items() if "gallery.md" in where}
    assert in_gallery == {path.name for path in PICTURES.iterdir()}
    for page in PAGES:
        assert all(len(link.text.split()) > 2 for link in links(page) if link.picture), page.name


def test_pictures_are_small() -> None:
    sizes = {path.name: path.stat().st_size for path in PICTURES.iterdir()}
    assert [name for name, size in sizes.items() if size > 400_000] == []
    assert sum(sizes.values()) < 6_000_000


GLOSSARY = "glossary.md"
LISTED = (GLOSSARY, FIRST, "effects.md")
"""Pages that link no word: what they link to; the list of pages; what the code writes of its catalogue."""


@pytest.mark.parametrize("page", [one for one in PAGES if one.name not in LISTED], ids=lambda page: page.name)
def test_a_private_word_is_linked_to_the_glossary_where_it_first_stands(page: Path) -> None:
    assert unexplained(page) == []


def unexplained(page: Path) -> list[str]:
    """Words of the glossary that stand on `page` before they are linked, or that it never links."""
    text = page.read_text(encoding="utf-8")
    linked = {anchor: text.find(f"{GLOSSARY}#{anchor})") for anchor in WORDS}
    return [anchor for anchor, (at, _) in first_words(page).items() if not 0 <= linked[anchor] < at]


def test_every_private_word_stands_in_the_glossary() -> None:
    assert set(WORDS) <= anchors(INDEX.with_name(GLOSSARY))


def test_a_word_that_is_not_linked_is_found(tmp_path: Path) -> None:
    page = tmp_path / "page.md"
    page.write_text("# FMD\n\n`nats` of a [mass line](x.md), a dynamic\nmass, then\n[dynamic mass](glossary.md#dynamic-mass).\n")
    assert unexplained(page) == ["dynamic-mass"]
