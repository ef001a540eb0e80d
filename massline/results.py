"""Results that print themselves: on a terminal as the commands do, in a notebook as HTML with their figures."""

from __future__ import annotations

from base64 import b64encode
from collections.abc import Callable, Iterable
from dataclasses import fields
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any

from validation import study as opened
from validation.compare import compare as comparing
from validation.diagnose import diagnosis as diagnosing
from validation.history import history as versions

if TYPE_CHECKING:
    from plotly.graph_objects import Figure

    from validation.report.document import Document


class Study(opened.Study):
    """A model and its tests, opened once: `Study.open(model, [campaign, ...])`. Everything else is a function of it."""

    @property
    def history(self) -> History:
        """The versions of the model file, as they stand now."""
        return History(**_fields(versions.history_position(self.asked.path)))


class History(versions.HistoryPosition):
    """The versions of a model: printed, it is the page of `massline ladder`."""

    def plot(self, *, dark: bool = False) -> Figure:
        """How the errors fell from version to version: a plotly figure, which a notebook shows by itself."""
        from validation.report.charts.history import falling_errors

        return falling_errors(self, dark=dark).checked()

    def __str__(self) -> str:
        from validation.report.history import text

        return text(self)


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


def comparison(found: comparing.Comparison) -> Comparison:
    """`found` as one that prints itself."""
    return Comparison(**_fields(found))


def diagnosis(found: diagnosing.Diagnosis) -> Diagnosis:
    """`found` as one that prints itself."""
    return Diagnosis(**_fields(found))


def _fields(of: Any) -> dict[str, Any]:
    return {one.name: getattr(of, one.name) for one in fields(of) if one.init}


def _html(document: Document, draw: Callable[[Path], Iterable[Path]]) -> str:
    """The words of a `document` and its pictures, which travel inside."""
    from html import escape

    with TemporaryDirectory() as folder:
        pictures = [b64encode(path.read_bytes()).decode() for path in draw(Path(folder)) if path.suffix == ".png"]
    shown = [f'<img style="max-width: 100%" src="data:image/png;base64,{one}">' for one in pictures]
    return "\n".join([f"<pre>{escape(document.text(width=130))}</pre>", *shown])
