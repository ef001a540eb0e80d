"""The page on paper: a browser prints all of it; without one the command says what to install before it computes anything."""

import re
import subprocess
import zlib
from typing import Any

import pytest

from geometry.errors import BadInput, CheckFailed
from validation.report import page as report_page


@pytest.fixture(scope="module")
def printed(browser_path, page, tmp_path_factory) -> bytes:
    path = tmp_path_factory.mktemp("paper") / "report.pdf"
    report_page.print_to(page, path, browser_path)
    return path.read_bytes()


def unpacked(document: bytes) -> bytes:
    """`document` with its streams unpacked."""
    found = [document]
    for stream in re.findall(rb"stream\r?\n(.*?)endstream", document, re.DOTALL):
        try:
            found.append(zlib.decompressobj().decompress(stream))
        except zlib.error:
            continue
    return b"\n".join(found)


def test_it_has_pages_its_headings_are_bookmarks_and_figures_are_drawings(printed):
    assert printed.startswith(b"%PDF")
    pages = len(re.findall(rb"/Type\s*/Page\b(?!s)", unpacked(printed)))
    assert 5 <= pages <= 40
    said = unpacked(printed)
    for heading in ("Summary", "Identified inertia", "Where it fails", "What is missing", "Provenance"):
        assert heading.encode() in said or heading.encode("utf-16-be") in said, heading
    assert unpacked(printed).count(b" c\n") > 2000  # curves: texts and tables alone have about two hundred


def test_whoever_prints_before_the_figures_are_drawn_gets_them_all_the_same(printed, browser_path, page, tmp_path):
    """As with Ctrl-P: no address that says paper, and no time of the page's own."""
    words = [browser_path, "--headless", *report_page.flags(), f"--user-data-dir={tmp_path}/profile", "--no-pdf-header-footer"]
    path = tmp_path / "at-once.pdf"
    subprocess.run([*words, f"--print-to-pdf={path}", page.as_uri()], check=True, capture_output=True, timeout=120)
    at_once = unpacked(path.read_bytes())
    assert at_once.count(b" l\n") > 0.9 * unpacked(printed).count(b" l\n")  # straight lines of curves: of tables alone a handful


def test_a_browser_that_says_nothing_is_told_of_and_one_that_hangs_is_ended(page, tmp_path, monkeypatch):
    with pytest.raises(CheckFailed, match="did not print"):
        report_page.print_to(page, tmp_path / "report.pdf", "/bin/true")
    assert list(tmp_path.iterdir()) == []
    script = tmp_path / "browser"
    script.write_text("#!/bin/sh\nexec sleep 60\n")
    script.chmod(0o755)
    monkeypatch.setattr(report_page, "PDF_PATIENCE", 0.2)
    with pytest.raises(CheckFailed, match=r"within 0\.2 s"):
        report_page.print_to(page, tmp_path / "report.pdf", str(script))


@pytest.mark.parametrize(("user", "sandboxed"), [(0, False), (1000, True)])
def test_nobody_but_root_prints_without_the_browsers_sandbox(tmp_path, monkeypatch, user, *, sandboxed):
    """Titles on the page are a stranger's."""
    script, page = tmp_path / "browser", tmp_path / "page.html"
    script.write_text(f'#!/bin/sh\necho "$@" > {tmp_path}/words\n')
    script.chmod(0o755)
    page.write_text("")
    monkeypatch.setattr("os.geteuid", lambda: user)
    with pytest.raises(CheckFailed, match="did not print"):
        report_page.print_to(page, tmp_path / "report.pdf", str(script))
    assert ("--no-sandbox" not in (tmp_path / "words").read_text()) == sandboxed


def test_without_a_browser_it_says_what_to_install(monkeypatch, tmp_path):
    monkeypatch.delenv(report_page.BROWSER, raising=False)
    monkeypatch.setenv("PATH", str(tmp_path))
    with pytest.raises(BadInput, match="apt-get install chromium"):
        report_page.browser_path()


def test_a_named_browser_that_is_none_is_refused_before_anything_is_read(refused, monkeypatch):
    monkeypatch.setenv(report_page.BROWSER, "no-such-browser")
    said = refused("report", "none.toml", "nowhere", "--pdf")
    assert "MASSLINE_BROWSER" in said
    assert "no-such-browser" in said


def test_a_named_browser_is_taken(monkeypatch, tmp_path):
    own = tmp_path / "mine"
    own.write_text("#!/bin/sh\n")
    own.chmod(0o755)
    monkeypatch.setenv(report_page.BROWSER, str(own))
    found: Any = report_page.browser_path()
    assert found == str(own)
