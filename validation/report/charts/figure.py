"""`Figure`: traces and a layout as plotly.js reads them.

A report has a hundred figures and the workbench draws one at every move of a slider. plotly's own figures check each value when
it is set, copied or written, which costs more than all that a comparison computes; these are plain values. `Figure.checked` hands
them to plotly, which refuses what plotly.js would not understand: every kind of figure goes through it in tests.
"""

import json
from base64 import b64encode
from collections.abc import Mapping, Sequence
from itertools import accumulate
from typing import TYPE_CHECKING, Any

import numpy as np

if TYPE_CHECKING:
    from plotly import graph_objects as go

Values = dict[str, Any]

FOR_A_PAGE = {"<": "\\u003c", ">": "\\u003e", "/": "\\u002f"}
"""What could end the element of a page in which JSON stands."""


class Figure:
    """One or several panels.

    Attributes
    ----------
    data : traces, each a dict with its "type"; arrays stay arrays until they are written
    layout : by plotly's keys
    """

    def __init__(
        self,
        *traces: Values,
        rows: int = 1,
        columns: int = 1,
        heights: Sequence[float] | None = None,
        widths: Sequence[float] | None = None,
        vertical: float = 0.0,
        horizontal: float = 0.0,
        titles: Sequence[str] = (),
        shared: bool = False,
    ) -> None:
        """Panels in `rows` and `columns`, from the upper left; `traces` are for the first.

        Parameters
        ----------
        heights, widths : of rows and columns in any unit, alike by default
        vertical, horizontal : between them [share of the figure]
        titles : above the panels of the first row
        shared : whether the panels of a column show the same frequencies, which the lowest names
        """

        def places(sizes: Sequence[float], gap: float) -> list[tuple[float, float]]:
            """Where each of several begins and ends along an edge of length 1 with a `gap` between them."""
            lengths = [(1 - gap * (len(sizes) - 1)) * size / sum(sizes) for size in sizes]
            begins = [end + gap * k for k, end in enumerate([0.0, *accumulate(lengths[:-1])])]
            return [(begin, begin + length) for begin, length in zip(begins, lengths, strict=True)]

        self.data: list[Values] = list(traces)
        self.layout: Values = {}
        self._columns = columns
        below, beside = places(heights or [1.0] * rows, vertical), places(widths or [1.0] * columns, horizontal)
        if rows == columns == 1:
            self.layout |= {"xaxis": {}, "yaxis": {}}
            return
        for k in range(rows * columns):
            row, column = divmod(k, columns)
            across: Values = {"anchor": f"y{_number(k)}", "domain": list(beside[column])}
            if shared and row < rows - 1:
                across |= {"matches": f"x{_number((rows - 1) * columns + column)}", "showticklabels": False}
            top, bottom = (1 - end for end in below[row])
            up = {"anchor": f"x{_number(k)}", "domain": [max(bottom, 0.0), top]}
            self.layout |= {f"xaxis{_number(k)}": across, f"yaxis{_number(k)}": up}
        for (low, high), title in zip(beside, titles, strict=False):
            self.note(text=title, x=(low + high) / 2, y=1.0, xref="paper", yref="paper", xanchor="center", yanchor="bottom")

    def add(self, *traces: Values, row: int = 1, column: int = 1) -> None:
        """Add `traces` to the panel at `row` and `column`, counted from 1."""
        at = _number((row - 1) * self._columns + column - 1)
        several = len(self._axes("x")) > 1
        self.data += [{"xaxis": f"x{at}", "yaxis": f"y{at}", **one} if several else one for one in traces]

    def update(self, **layout: Any) -> None:
        """Merge `layout` into what there is; None changes nothing."""
        _merge(self.layout, layout)

    def across(self, *, row: int = 0, column: int = 0, **axis: Any) -> None:
        """Merge `axis` into the horizontal axis of a panel, of all panels by default."""
        for name in self._axes("x", row, column):
            _merge(self.layout[name], axis)

    def up(self, *, row: int = 0, column: int = 0, **axis: Any) -> None:
        """Likewise into the vertical axis."""
        for name in self._axes("y", row, column):
            _merge(self.layout[name], axis)

    def rule(self, *, row: int = 0, column: int = 0, x: float | None = None, y: float | None = None, **line: Any) -> None:
        """A line through a panel, or all panels, upright at `x` or level at `y`."""
        for name in self._axes("x", row, column):
            k = name.removeprefix("xaxis")
            if x is not None:
                ends = {"x0": x, "x1": x, "xref": f"x{k}", "y0": 0, "y1": 1, "yref": f"y{k} domain"}
            else:
                ends = {"x0": 0, "x1": 1, "xref": f"x{k} domain", "y0": y, "y1": y, "yref": f"y{k}"}
            self.layout.setdefault("shapes", []).append({"line": line, "type": "line", **ends})

    def note(self, **annotation: Any) -> None:
        """Words without an arrow."""
        self.layout.setdefault("annotations", []).append({"showarrow": False, **annotation})

    def json(self, *, template: bool = False) -> str:
        """As JSON that may stand in a page; with the `template` only where it is asked for, since a page has it once for all."""
        layout = self.layout if template else {key: value for key, value in self.layout.items() if key != "template"}
        said = as_json({"data": self.data, "layout": layout})
        for sign, escaped in FOR_A_PAGE.items():  # quicker than one pass of `str.translate`, by far
            said = said.replace(sign, escaped)
        return said

    def checked(self) -> "go.Figure":
        """As a figure of plotly's own.

        Raises
        ------
        ValueError : a key or a value that plotly.js does not have.
        """
        from plotly import graph_objects as go

        return go.Figure(data=self.data, layout=self.layout)

    def _axes(self, which: str, row: int = 0, column: int = 0) -> list[str]:
        """Keys of the axes of panels; axes that lie over another's belong to none."""
        if row and column:
            return [f"{which}axis{_number((row - 1) * self._columns + column - 1)}"]
        return [key for key, axis in self.layout.items() if key.startswith(f"{which}axis") and "overlaying" not in axis]


def as_json(value: Any) -> str:
    """`value` as JSON; arrays are packed as plotly.js reads them, and what is no number is null."""
    return json.dumps(_plain(value), separators=(",", ":"), allow_nan=False)


def _plain(value: Any) -> Any:
    if isinstance(value, Mapping):
        return {key: _plain(one) for key, one in value.items()}
    if isinstance(value, np.ndarray):
        if value.dtype.kind != "f":
            return _plain(value.tolist())
        packed: Values = {"dtype": f"f{value.itemsize}", "bdata": b64encode(value.tobytes()).decode("ascii")}
        return packed | ({"shape": ", ".join(map(str, value.shape))} if value.ndim > 1 else {})
    if isinstance(value, list | tuple):
        return [_plain(one) for one in value]
    if isinstance(value, float | np.floating):
        return float(value) if np.isfinite(value) else None
    return int(value) if isinstance(value, np.integer) else value


def _merge(into: Values, more: Mapping[str, Any]) -> None:
    for key, value in more.items():
        if isinstance(value, Mapping):
            into[key] = dict(into.get(key) or {})
            _merge(into[key], value)
        elif value is not None:
            into[key] = value


def _number(k: int) -> str:
    """Behind the letter of the axes of panel `k`: none of the first."""
    return str(k + 1) if k else ""
