"""The pages as a site: ``python -m tools.site [FOLDER]`` writes one HTML file a page into ``out/site``, to be opened from disk.

The folder ``docs`` stands alone; this is the same text with a list of all pages beside it, by markdown-it-py, which rich brings.
No script, no network, light or dark as the system has it.
"""

from __future__ import annotations

import re
import shutil
import sys
from collections.abc import Iterable
from html import escape
from pathlib import Path
from typing import TYPE_CHECKING

from geometry.atomic import write_text
from tools.pages import FIRST, ROOT, anchors_of, headings, pages, title

if TYPE_CHECKING:
    from markdown_it.token import Token

OUT = Path("out/site")
CSS = Path(__file__).with_suffix(".css")
OVERVIEW = "overview.html"
"""What README.md becomes."""

PAGE = """\
<!doctype html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>{title} - massline</title>
<link rel="stylesheet" href="site.css">
</head>
<body>
<a class="skip" href="#main">Skip to the contents</a>
<nav aria-label="All pages">{nav}</nav>
<main id="main">
{body}
</main>
</body>
</html>
"""


def build(folder: Path, root: Path = ROOT) -> tuple[Path, ...]:
    """Write the site into `folder`; the pages that were written."""
    every = pages(root)
    listed = _listed(root / "docs" / FIRST)
    written = []
    for page in every:
        path = folder / html_name(page, root)
        nav = _nav(listed, html_name(page, root))
        write_text(path, PAGE.format(title=escape(title(page)), nav=nav, body=_body(page, root)))
        written.append(path)
    write_text(folder / "site.css", CSS.read_text(encoding="utf-8"))
    shutil.copytree(root / "docs" / "pictures", folder / "pictures", dirs_exist_ok=True)
    return tuple(written)


def html_name(page: Path, root: Path) -> str:
    """What the file of `page` is called on the site."""
    return OVERVIEW if page == root / "README.md" else f"{page.stem}.html"


def _body(page: Path, root: Path) -> str:
    from markdown_it import MarkdownIt

    reader = MarkdownIt("commonmark", {"html": True}).enable("table")
    tokens = reader.parse(page.read_text(encoding="utf-8"))
    _give_anchors(tokens, anchors_of(headings(page)))
    for token in tokens:
        if token.type == "fence" and " " in token.info:
            token.attrSet("data-file", token.info.partition(" ")[2].removeprefix("+"))
    for token in (inner for outer in tokens for inner in outer.children or ()):
        for key in ("href", "src"):
            if key in token.attrs:
                token.attrs[key] = _target(str(token.attrs[key]), page, root)
    html = str(reader.renderer.render(tokens, reader.options, {}))
    html = re.sub(r'<a href="">(.*?)</a>', r"\1", html, flags=re.DOTALL)  # what the site does not hold is named, not led to
    html = html.replace("<pre>", '<pre tabindex="0">')  # what scrolls can be reached by the keyboard
    return html.replace("<table>", '<div class="wide"><table>').replace("</table>", "</table></div>")


def _give_anchors(tokens: Iterable[Token], names: Iterable[str]) -> None:
    waiting = iter(names)
    for token in tokens:
        if token.type == "heading_open":
            token.attrSet("id", next(waiting))


def _target(written: str, page: Path, root: Path) -> str:
    """A link or picture of `page` as the site has it; empty for a file that is not on it."""
    path, mark, name = written.partition("#")
    if re.match(r"[a-z]+:", written) or not path:
        return written
    file = (page.parent / path).resolve()
    if file in pages(root):
        return html_name(file, root) + mark + name
    return f"pictures/{file.name}" if file.parent == (root / "docs" / "pictures").resolve() else ""


def _listed(index: Path) -> tuple[tuple[str, str], ...]:
    """Headings ("", name) and pages (file, name) of the index, in order."""
    found = []
    for line in index.read_text(encoding="utf-8").splitlines():
        heading, entry = re.match(r"## (.+)", line), re.match(r"- \[([^\]]+)\]\(([^)]+)\)", line)
        if heading:
            found.append(("", heading[1]))
        elif entry:
            found.append((OVERVIEW if entry[2].startswith("../") else f"{Path(entry[2]).stem}.html", entry[1]))
    return tuple(found)


def _nav(listed: Iterable[tuple[str, str]], here: str) -> str:
    lines = [f'<p><a href="{Path(FIRST).stem}.html"><b>massline</b></a></p>']
    for file, name in listed:
        current = ' aria-current="page"' if file == here else ""
        lines.append(f'<a href="{file}"{current}>{escape(name)}</a>' if file else f"<h2>{escape(name)}</h2>")
    return "\n".join(lines)


if __name__ == "__main__":
    folder = Path(sys.argv[1]) if len(sys.argv) > 1 else OUT
    sys.stderr.write(f"massline: wrote {len(build(folder))} pages; begin at {folder / Path(FIRST).stem}.html\n")
