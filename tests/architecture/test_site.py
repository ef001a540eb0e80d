"""The pages as a site: every page, every link within it, every picture; nothing that needs a network."""

import re
import subprocess
import sys
from pathlib import Path

import pytest

from tools.pages import headings, pages
from tools.site import build, html_name


@pytest.fixture(scope="module")
def site(root: Path, tmp_path_factory: pytest.TempPathFactory) -> Path:
    folder = tmp_path_factory.mktemp("site")
    build(folder, root)
    return folder


def test_every_page_is_on_it_with_every_heading(site: Path, root: Path) -> None:
    for page in pages(root):
        html = (site / html_name(page, root)).read_text(encoding="utf-8")
        assert len(re.findall(r"<h[1-6] id=", html)) == len(headings(page)), page.name


def test_every_link_leads_somewhere_on_it_or_to_the_network(site: Path) -> None:
    for page in site.glob("*.html"):
        for target in re.findall(r'(?:href|src)="([^"]*)"', page.read_text(encoding="utf-8")):
            path, _, name = target.partition("#")
            if re.match(r"https?:", target):
                continue
            assert target, page.name
            led_to = site / path if path else page
            assert led_to.is_file(), f"{page.name}: {target}"
            if name:
                assert f'id="{name}"' in led_to.read_text(encoding="utf-8"), f"{page.name}: {target}"


def test_it_fetches_nothing_and_runs_nothing(site: Path) -> None:
    for page in site.glob("*.html"):
        html = page.read_text(encoding="utf-8")
        assert "<script" not in html
        assert not re.search(r'(?:src|<link[^>]*href)="https?:', html), page.name


def test_it_is_built_by_one_command(root: Path, tmp_path: Path) -> None:
    run = subprocess.run(
        [sys.executable, "-m", "tools.site", str(tmp_path)], cwd=root, capture_output=True, text=True, check=True
    )
    assert f"begin at {tmp_path / 'index.html'}" in run.stderr
    assert (tmp_path / "index.html").is_file()


def test_a_file_of_a_page_has_its_name_above_it(site: Path) -> None:
    assert 'data-file="examples/effects/force_lowpass.py"' in (site / "own-effect.html").read_text(encoding="utf-8")
