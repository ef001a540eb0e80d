"""Scripts of others without the addresses that they hold: what a library says of its makers must be no way out of the house.

A policy of content stops what a page loads, posts or connects to. It does not stop a window that a click opens, and plotly.js has
offered one that took the figure, with its data, to its makers. So no script is shipped with an address that could be gone to.
"""

from __future__ import annotations

import re

NAMESPACES = "www.w3.org/"
"""Of XML: names that look like addresses, by which a browser knows SVG from HTML; nothing goes there."""

ADDRESS = re.compile(rf"(?:https?|wss?|ftp)://(?!{re.escape(NAMESPACES)})(?=[\w$\[{{])")
"""Where an address begins, a host behind it, be it written out, put together (``${host}``) or a pattern (``{s}.tile``)."""

NOWHERE = "about:blank#"
"""A valid address, as scripts expect one, of an empty page."""


def without_addresses(script: str) -> str:
    """`script` with every foreign address leading to an empty page; what it said stays legible, as in a notice of copyright."""
    return ADDRESS.sub(NOWHERE, script)


def foreign(script: str) -> list[str]:
    """Every foreign address in `script`, with what follows."""
    return [script[one.start() : one.end() + 40] for one in ADDRESS.finditer(script)]
