"""Results that print themselves: on a terminal as the commands do, in a notebook as HTML with their figures."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterable
from dataclasses import fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, TypeVar

from geometry.inertia import Inertia
from validation import study as opened
from validation.compare import compare as comparing
from validation.diagnose import diagnosis as diagnosing
from validation.history import history as versions
from validation.identify import identify as identifying

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

    from validation.report.document import Document, Grid

Printing = TypeVar("Printing")


class Study(opened.Study):
    """A model and its tests, opened once: `Study.open(model, [campaign, ...])`. Everything else is a function of it."""

    @property
    def history(self) -> History:
        """The versions of the model file, as they stand now."""
        return printing(History, versions.history_position(self.asked.path))

    def __str__(self) -> str:
        return self._document().text()

    def _repr_html_(self) -> str:
        return _html(self._document())

    def _document(self) -> Document:
        """What the model is, and which data stand beside it."""
        from validation.report.document import Column, Document, Table

        rows = [(of.measured.name, len(of.measured.channels), of.measured.frequency) for of in (*self.made, *self.tests)]
        table = Table(
            rows=rows,
            columns=(
                Column("data", lambda row: row[0], words=True),
                Column("channels", lambda row: float(row[1]), "g"),
                Column("lines", lambda row: float(len(row[2])), "g"),
                Column("from", lambda row: row[2][0], unit="Hz"),
                Column("to", lambda row: row[2][-1], unit="Hz"),
            ),
        )
        effects = ", ".join(one.named.id for one in self.model.effects) or "none"
        checked = ", ".join(self.hold_out) or "each run in turn"
        notes = (f"Model: {self.model.source}, effects in it: {effects}.", f"Used only for checking: {checked}.")
        return Document(title=self.model.title, blocks=(table,), notes=notes)


class History(versions.HistoryPosition):
    """The versions of a model: printed, it is the page of `massline ladder`."""

    def plot(self, *, dark: bool = False) -> Figure:
        """How the errors fell from version to version: a plotly figure, which a notebook shows by itself."""
        from validation.report.charts.history import falling_errors

        return falling_errors(self, dark=dark).checked()

    def __str__(self) -> str:
        from validation.report.history import text

        return text(self)

    def _repr_html_(self) -> str:
        from validation.report.charts.history import draw
        from validation.report.history import ladder_document

        return _html(ladder_document(self), lambda folder: draw(self, folder))


class Comparison(comparing.Comparison):
    """Where a model fails: printed, it is the page of `massline compare`."""

    def __str__(self) -> str:
        from validation.report.compare import document

        return document(self).text()

    def _repr_html_(self) -> str:
        from validation.report.compare import document, draw

        return _html(document(self), lambda folder: draw(self, folder))


class Diagnosis(diagnosing.Diagnosis):
    """What a model is missing: printed, it is the page of `massline diagnose` without its first line."""

    def __str__(self) -> str:
        from validation.report.diagnose import document

        return document(self).text()

    def _repr_html_(self) -> str:
        from validation.report.diagnose import document, draw

        return _html(document(self), lambda folder: draw(self, folder))


class Identification(identifying.IdentificationFindings):
    """Mass, centre of gravity and inertia from a campaign: printed, it is the page of `massline identify`."""

    def __str__(self) -> str:
        from validation.report.identify import IdentificationPage

        return IdentificationPage(found=self).document().text()

    def _repr_html_(self) -> str:
        from validation.report.identify import IdentificationPage, IdentificationPictures

        return _html(IdentificationPage(found=self).document(), IdentificationPictures(found=self).draw)


class Routes(dict[str, Inertia]):
    """Inertia of one article by the name of the route that computed it: printed, ten values side by side."""

    def __str__(self) -> str:
        return self._document().text()

    def _repr_html_(self) -> str:
        return _html(self._document())

    def _document(self) -> Document:
        """CoG from the article's own origin, moments and products about the CoG."""
        from validation.reference.statement import QUANTITIES, about_cog
        from validation.report.document import Column, Document, Table

        rows = list(zip(QUANTITIES, *(about_cog(one) for one in self.values()), strict=True))

        def printed(k: int) -> Callable[[Any], float]:
            return lambda row: float(row[k]) * row[0].per_si

        columns = [Column(route, printed(k), ".6g") for k, route in enumerate(self, start=1)]
        named = Column("", lambda row: f"{row[0].label} [{row[0].unit}]", words=True)
        about = "CoG from the article's own origin; moments and products about the CoG, products as entries of the tensor."
        return Document(title="Inertia by route", blocks=(Table(rows=rows, columns=(named, *columns)),), notes=(about,))


def printing(kind: type[Printing], found: Any) -> Printing:
    """`found` as one of its `kind` that prints itself."""
    return kind(**{one.name: getattr(found, one.name) for one in fields(found) if one.init})


def _html(document: Document, draw: Callable[[Path], Iterable[Path]] = lambda folder: ()) -> str:
    """A `document` for a notebook: its sentences, its tables, and the pictures that `draw` writes, which travel inside."""
    from html import escape

    from validation.report.document import FIRST

    def table(grid: Grid) -> str:
        def row(cells: Iterable[str], kind: str) -> str:
            side = ("left" if k in grid.left else "right" for k in range(len(grid.header)))
            made = (f'<{kind} style="text-align: {at}">{escape(cell)}</{kind}>' for cell, at in zip(cells, side, strict=True))
            return f"<tr>{''.join(made)}</tr>"

        lines = "\n".join(row(line, "td") for line in grid.lines)
        return f"<table>\n<thead>{row(grid.header, 'th')}</thead>\n<tbody>\n{lines}\n</tbody>\n</table>"

    wrong = [note for note in document.notes if note.startswith(FIRST)]
    below = [f"<li>{escape(note)}</li>" for note in document.notes if note not in wrong]
    with TemporaryDirectory() as folder:
        pictures = [b64encode(path.read_bytes()).decode() for path in draw(Path(folder)) if path.suffix == ".png"]
    shown = [f'<img alt="" style="max-width: 100%" src="data:image/png;base64,{one}">' for one in pictures]
    head = [f"<p><b>{escape(document.title)}</b></p>"] if document.title else []
    said = [f"<p>{escape(words)}</p>" for words in (*document.opening, *wrong)]
    return "\n".join([*head, *said, *map(table, document.grids()), f"<ul>{''.join(below)}</ul>", *shown])
