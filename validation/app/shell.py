"""The HTML that a window begins with: trame's own client under our title, without a script inside the page.

trame's `index.html` forbids zooming and holds an inline script, which the policy of `headers` rightly stops.
"""

from __future__ import annotations

import re
from html import escape
from pathlib import Path

SERVED = "__massline"
"""Under which the files of `www` are served."""

WWW = Path(__file__).with_name("www")

SHELL = """<!doctype html>
<html lang="en" data-app-name="massline" data-launcher-retry="[]">
  <head>
    <meta charset="utf-8">
    <meta name="viewport" content="width=device-width, initial-scale=1">
    <meta name="color-scheme" content="light dark">
    <title>massline</title>
    <link rel="icon" href="{served}/icon.svg" type="image/svg+xml">
    <link rel="stylesheet" href="{style}">
    <link rel="stylesheet" href="{served}/start.css">
    <script src="vue.global.js"></script>
    <script src="{served}/start.js" data-module="{module}"></script>
  </head>
  <body>
    <noscript>The workbench needs JavaScript, which is switched off in this browser.</noscript>
    <div id="app"><p class="begins" role="status">The workbench begins ...</p></div>
  </body>
</html>
"""


def html(client: Path) -> str:
    """The first page, around the client in the folder `client` that trame brings.

    Raises
    ------
    LookupError : that client is laid out otherwise than the locked version.
    """
    text = (client / "index.html").read_text(encoding="utf-8")
    return SHELL.format(
        served=SERVED,
        module=_found(r'<script type="module"[^>]* src="([^"]+)"', text),
        style=_found(r'rel="stylesheet"[^>]* href="([^"]+)"', text),
    )


def _found(pattern: str, text: str) -> str:
    match = re.search(pattern, text)
    if match is None:
        raise LookupError(f"trame's index.html holds nothing like {pattern}")
    return escape(match[1])
