"""Figures of a page: each has its place in the text, and all of them travel in one packed block at its end."""

from __future__ import annotations

import json
from base64 import b64encode
from collections.abc import Mapping
from gzip import compress
from html import unescape
from typing import TYPE_CHECKING, Any

from validation.report.markup import Safe, tag

if TYPE_CHECKING:
    from validation.plots.theme import Figure


class Figures:
    """What is drawn on a page, in the order in which it is met."""

    def __init__(self) -> None:
        self._json: dict[str, str] = {}

    def placed(self, figure: Figure, caption: str = "", *, screen_only: bool = False, group: str = "", shown: str = "") -> Safe:
        """The place of `figure`; what it shows is said by its title.

        Parameters
        ----------
        group : of the figures of `choices` that may stand here instead
        shown : which of these it is
        """
        name = f"figure-{len(self._json) + 1}"
        self._keep(name, figure)
        height = int(figure.layout.height or 400)
        plot = tag(
            "div",
            class_="plot",
            id=name,
            role="img",
            aria_label=unescape(str(figure.layout.title.text)),
            style=f"min-height:{height}px",
            data_group=group or None,
            data_shown=shown or None,
        )
        said = tag("figcaption", caption) if caption else None
        return tag("figure", plot, said, class_="interactive screen-only" if screen_only else "interactive")

    def choices(self, group: str, figures: Mapping[str, Figure]) -> None:
        """Figures that may stand in the place of `group`, by what chooses them."""
        for key, figure in figures.items():
            self._keep(f"{group}/{key}", figure)

    def packed(self) -> Safe:
        """The library and all figures, each packed once."""
        from validation.plots import embedded

        templates = f'{{"light":{embedded.template_json(False)},"dark":{embedded.template_json(True)}}}'
        figures = ",".join(f"{json.dumps(name)}:{text}" for name, text in self._json.items())
        whole = f'{{"templates":{templates},"figures":{{{figures}}}}}'
        return Safe(_script("packed-library", embedded.library()) + _script("packed-figures", whole))

    def __len__(self) -> int:
        return len(self._json)

    def _keep(self, name: str, figure: Figure) -> None:
        from validation.plots.embedded import figure_json

        self._json[name] = figure_json(figure)


def _script(name: str, text: str) -> str:
    """`text` packed into an element that no browser runs."""
    packed: Any = b64encode(compress(text.encode("utf-8"), 9, mtime=0)).decode("ascii")
    return f'<script type="text/plain" id="{name}">{packed}</script>\n'
