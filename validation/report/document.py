"""Tables as pages have them: one number a cell, its unit in the head, and every digit of it for a spreadsheet.

A cell shows the digits that mean something. Copied, a table gives all digits, tab-separated, which a spreadsheet takes.
"""

import json
import re
from base64 import b64encode
from collections.abc import Callable, Iterable, Mapping, Sequence
from dataclasses import dataclass
from gzip import compress
from html import escape, unescape
from math import isfinite
from typing import TYPE_CHECKING, Any

from geometry import cache
from validation.output import NONE, PIPED_WIDTH, page_width, rounded

if TYPE_CHECKING:
    from validation.report.charts.figure import Figure


# HTML that cannot be broken into: whatever is not `Safe` is escaped on its way in.
#
# Titles, names and words come from files of other people; a title with a tag in it is shown with its brackets.


EMPTY = frozenset({"br", "img", "hr", "meta", "col", "input", "wbr"})
"""Elements that have no end."""


class Safe(str):
    """HTML that is ready."""

    __slots__ = ()


def tag(name: str, /, *inside: str | None, **attributes: str | bool | None) -> Safe:
    """The element `name` with `inside`, escaped where it is not `Safe`; None leaves out.

    Attributes: `class_` and `for_` lose their underscore, others become dashes; True stands alone, None and False are left out.
    """
    given = {
        key.rstrip("_").replace("_", "-"): value for key, value in attributes.items() if value is not None and value is not False
    }
    written = (f" {key}" if value is True else f' {key}="{escape(value, quote=True)}"' for key, value in given.items())
    opened = f"<{name}{''.join(written)}>"
    return Safe(opened if name in EMPTY else f"{opened}{joined(*inside)}</{name}>")


def joined(*parts: str | None) -> Safe:
    """`parts` one behind the other, escaped where they are not `Safe`; None leaves out."""
    return Safe("".join(part if isinstance(part, Safe) else escape(part) for part in parts if part is not None))


def worded(text: str) -> Safe:
    """`text` with what stands in back-quotes as code."""
    if isinstance(text, Safe):
        return text
    pieces = text.split("`")
    if len(pieces) % 2 == 0:
        return joined(text)
    return joined(*(tag("code", piece) if k % 2 else piece for k, piece in enumerate(pieces)))


# A reference table laid out as strings: two grids, the values and their deviations, and the notes below them.
#
# No digit that was printed is lost, none is invented: a published value keeps its own decimals, a route is shown with one more
# than the published value, or with six significant digits of the largest entry of its kind. The decimal points of a column line
# up.


@dataclass(frozen=True, eq=False, kw_only=True)
class Grid:
    """Header and lines of strings; the first column reads from the left, the last too when `words`, all else from the right.

    On a page it has its `caption`; without one it is for the terminal alone, as one `on` it.
    """

    header: tuple[str, ...]
    lines: tuple[tuple[str, ...], ...]
    words: bool = False
    caption: str = ""
    on: str = ""

    @property
    def left(self) -> frozenset[int]:
        """The columns that read from the left."""
        return frozenset({0, len(self.header) - 1} if self.words else {0})

    def html(self, note: str = "") -> Safe:
        """For a page."""
        columns = [Column(head=head, words=k in self.left) for k, head in enumerate(self.header)]
        rows = [[cell.strip() for cell in line] for line in self.lines]
        headed = [[tag("strong", row[0]), *row[1:]] if row[0] and not any(row[1:]) else row for row in rows]
        return table(self.caption, columns, headed, note=note)


def holds(cell: "Cell") -> bool:
    """Whether something stands in `cell`: a column of others is left out."""
    return (cell.text if isinstance(cell, Number) else str(cell)).strip() not in ("", NONE)


def aligned(cells: tuple[str, ...]) -> tuple[str, ...]:
    """`cells` padded so that their decimal points stand below each other."""
    parts = [at_point(cell) for cell in cells]
    left, right = (max((len(part[side]) for part in parts), default=0) for side in (0, 1))
    return tuple(f"{a:>{left}}{b:<{right}}" for a, b in parts)


def at_point(cell: str) -> tuple[str, str]:
    """`cell` before and from its first decimal point, or before its first space."""
    first = cell.split(" ")[0]
    whole = first.partition(".")[0]
    return whole, cell[len(whole) :]


PAGE, TERMINAL, PANEL = "page", "terminal", "panel"
"""Printers that alone show what the others leave out."""


@dataclass(frozen=True, eq=False)
class Column:
    """One column of a table, whoever prints it.

    Attributes
    ----------
    head : its name
    of : what stands in it, of a row: a text, a number or a cell
    form : of a number, or what makes a text of it
    unit : of its numbers; empty where they have none
    words : whether it is read from the left, as words are
    said : its name on a terminal, where that is another; with the form of its numbers, or what makes a text of them
    panel : under which name the browser's panel has it; empty where it has not
    aligned : whether decimal points stand below each other on a terminal
    on : the printer that alone shows it; empty for all
    """

    head: str
    of: Callable[[Any], Any] = str
    form: str | Callable[[float], str] = ".4g"
    unit: str = ""
    words: bool = False
    said: str | tuple[str, str | Callable[[Any], str]] = ""
    panel: str = ""
    aligned: bool = True
    on: str = ""

    def cell(self, row: Any) -> "Cell":
        """On a page."""
        value = self.of(row)
        return value if isinstance(value, str | Number) else number(value, self.form)

    def text(self, row: Any) -> str:
        """On a terminal."""
        value = self.of(row)
        form = self.said[1] if isinstance(self.said, tuple) else self.form
        if isinstance(self.said, tuple) and not isinstance(value, str) and callable(form):
            return form(value)
        shown = value if isinstance(value, str) else value.text if isinstance(value, Number) else number(value, form).text
        return shown if self.words else shown.replace("−", "-")

    @property
    def short(self) -> str:
        """Its name on a terminal."""
        told = self.said[0] if isinstance(self.said, tuple) else self.said
        return told or (f"{self.head} [{self.unit}]" if self.unit else self.head)


@dataclass(frozen=True, eq=False, kw_only=True)
class Table:
    """Rows of a result, a column a figure: every printer takes it.

    Attributes
    ----------
    caption : on a page
    columns, rows : what stands in it
    shown : the rows that a terminal shows; None for all
    note : below it on a page
    on : the printer that alone shows it; empty for all
    """

    caption: str = ""
    columns: Sequence[Column]
    rows: Sequence[Any]
    shown: Sequence[Any] | None = None
    note: str = ""
    on: str = ""

    def grid(self) -> Grid:
        """For a terminal."""
        rows = self.rows if self.shown is None else self.shown
        drawn = [(one, tuple(one.text(row) for row in rows)) for one in self.columns if one.on not in (PAGE, PANEL)]
        kept = [(one, of) for k, (one, of) in enumerate(drawn) if k == 0 or not rows or any(map(holds, of))]
        lines = [aligned(of) if k and one.aligned and not one.words else of for k, (one, of) in enumerate(kept)]
        words = len(kept) > 1 and kept[-1][0].words
        return Grid(header=tuple(one.short for one, _ in kept), lines=tuple(zip(*lines, strict=True)), words=words)

    def html(self) -> Safe:
        """For a page; nothing where it has no rows."""
        columns = [one for one in self.columns if one.on not in (TERMINAL, PANEL)]
        cells = [[one.cell(row) for row in self.rows] for one in columns]
        kept = [k for k, of in enumerate(cells) if k == 0 or any(map(holds, of))]
        return table(self.caption, [columns[k] for k in kept], list(zip(*(cells[k] for k in kept), strict=True)), note=self.note)

    def panel(self) -> list[dict[str, Any]]:
        """For the browser: a mapping a row."""
        rows = self.rows if self.shown is None else self.shown
        return [{one.panel: one.of(row) for one in self.columns if one.panel} for row in rows]


@dataclass(frozen=True, eq=False)
class Drawn:
    """A figure of a page, drawn when it is printed; `caption` stands below it."""

    figure: "Callable[[], Figure]"
    caption: str = ""


Block = Grid | Table | Drawn | Safe | Callable[["Figures"], Safe | None] | None
"""A part of a document. What makes HTML by itself is for the page alone."""


@dataclass(frozen=True, eq=False, kw_only=True)
class Document:
    """What is said of a result, once for all who print it.

    Attributes
    ----------
    title : on a terminal; a page has its headings from the table of contents
    opening : paragraphs before everything else
    blocks : in the order in which they are read
    notes : sentences below
    """

    title: str = ""
    opening: Sequence[str] = ()
    blocks: Sequence[Block] = ()
    notes: Sequence[str] = ()

    def text(self, width: int | None = None) -> str:
        """For a terminal, of `width` columns; None is `page_width`."""
        return page(self.title, self.grids(), self.notes, width, self.opening)

    def grids(self) -> list[Grid]:
        """The tables of a terminal; none that has no lines."""
        shown = [one for one in self.blocks if isinstance(one, Grid | Table) and one.on != PAGE]
        return [grid for one in shown if (grid := one.grid() if isinstance(one, Table) else one).lines]

    def html(self, figures: "Figures") -> list[Safe]:
        """For a page: its blocks, one behind the other; figures find their places among `figures`."""
        found: list[Safe | None] = []
        for one in self.blocks:
            if one is None or isinstance(one, Safe):
                found.append(one)
            elif isinstance(one, Drawn):
                found.append(figures.placed(one.figure(), one.caption))
            elif isinstance(one, Table):
                found.append(one.html() if one.on != TERMINAL else None)
            elif isinstance(one, Grid):
                found.append(one.html() if one.caption and one.on != TERMINAL else None)
            else:
                found.append(one(figures))
        return [one for one in found if one]


@dataclass(frozen=True, kw_only=True)
class Number:
    """One number of a cell.

    Attributes
    ----------
    value : with all its digits; None where there is none
    text : as it is shown
    """

    value: float | None
    text: str


Cell = Number | str
"""What stands in a cell; a text may be `Safe`."""

WHOLE, SENTENCE = 11, 60
"""Lines up to which a table stays on one sheet of paper, and letters of the longest cell of a row that fill another."""

SHORT, TINY = 24, 10
"""Letters of a text that is not broken on a screen, and of one that is not broken on paper either."""

JOINTS = re.compile(r"[^:@]*[:@]|[^:@]+")
"""Parts of the id of an effect, behind each of which a line may end."""

NOTHING = Number(value=None, text=NONE)


def number(value: float | None, form: str | Callable[[float], str] = ".4g") -> Number:
    """`value` shown in the form `form`."""
    if value is None or not isfinite(value):
        return NOTHING
    return Number(value=value, text=(form(value) if callable(form) else format(value, form)).replace("-", "−"))


def toleranced(value: float | None, tolerance: float | None) -> Number:
    """`value` shown with the digits that `tolerance` leaves it."""
    if value is None or not isfinite(value):
        return NOTHING
    return Number(value=value, text=rounded(value, tolerance).replace("-", "−"))


def plus_minus(value: float, half: float) -> str:
    """`value` with half the width of its interval, both with the digits that it leaves them; alone where that is none."""
    return f"{rounded(value, half)} ± {rounded(half, half)}" if half else rounded(value, None)


def table(caption: str, columns: Sequence[Column], rows: Sequence[Sequence[Cell]], *, note: str = "") -> Safe:
    """A table under its `caption`, with a button that copies it; nothing where it has no rows."""
    if not rows:
        return Safe("")
    heads = []
    for column in columns:
        unit = tag("span", f" [{column.unit}]", class_="unit") if column.unit else None
        heads.append(tag("th", column.head, unit, scope="col", class_="words" if column.words else None))
    lines = []
    for line in rows:
        cells = []
        for k, (column, cell) in enumerate(zip(columns, line, strict=True)):
            name, scope = ("td", None) if k else ("th", "row")
            if isinstance(cell, Number):
                value = "" if cell.value is None else repr(float(cell.value))
                words = "words" if column.words else None
                cells.append(tag(name, cell.text, class_=words, data_value=value, scope=scope))
                continue
            length = "" if isinstance(cell, Safe) or len(cell) > SHORT else " short" if len(cell) > TINY else " short tiny"
            said = cell
            is_id = ":" in cell and "-" in cell and " " not in cell and not isinstance(cell, Safe)
            if is_id:  # which may break between its parts
                said = joined(*(joined(tag("span", part, class_="kept"), tag("wbr")) for part in JOINTS.findall(cell)))
            cells.append(tag(name, worded(said), class_=f"words{length}" if column.words else None, scope=scope))
        lines.append(tag("tr", *cells))
    button = tag(
        "button",
        "copy",
        type="button",
        class_="copy",
        title="Copy the table for a spreadsheet",
        aria_label=f"Copy the table: {caption}",
    )
    named = tag("caption", tag("span", caption), button)
    inner = tag("table", named, tag("thead", tag("tr", *heads)), tag("tbody", *lines))
    below = tag("p", worded(note), class_="note") if note else None
    lengths = [
        max((len(cell) for cell in row if isinstance(cell, str) and not isinstance(cell, Safe)), default=0) for row in rows
    ]
    kind = "table whole" if sum(1 + length // SENTENCE for length in lengths) <= WHOLE else "table"
    return tag("div", tag("div", inner, class_="scroll", tabindex="0", role="region", aria_label=caption), below, class_=kind)


# Figures of a page: each has its place in the text, and all of them travel in one packed block at its end.


class Figures:
    """What is drawn on a page, in the order in which it is met."""

    def __init__(self) -> None:
        self._json: dict[str, str] = {}

    def placed(self, figure: "Figure", caption: str = "", *, screen_only: bool = False, group: str = "", shown: str = "") -> Safe:
        """The place of `figure`; what it shows is said by its title.

        Parameters
        ----------
        group : of the figures of `choices` that may stand here instead
        shown : which of these it is
        """
        name = f"figure-{len(self._json) + 1}"
        self._keep(name, figure)
        height = int(figure.layout.get("height", 400))
        plot = tag(
            "div",
            class_="plot",
            id=name,
            role="img",
            aria_label=unescape(figure.layout["title"]["text"]),
            style=f"min-height:{height}px",
            data_group=group or None,
            data_shown=shown or None,
        )
        said = tag("figcaption", caption) if caption else None
        return tag("figure", plot, said, class_="interactive screen-only" if screen_only else "interactive")

    def choices(self, group: str, figures: "Mapping[str, Figure]") -> None:
        """Figures that may stand in the place of `group`, by what chooses them."""
        for key, figure in figures.items():
            self._keep(f"{group}/{key}", figure)

    def packed(self) -> Safe:
        """The library and all figures, each packed once."""
        from importlib.metadata import version

        from validation.report.charts import interactive

        templates = f'{{"light":{interactive.template_json(False)},"dark":{interactive.template_json(True)}}}'
        figures = ",".join(f"{json.dumps(name)}:{text}" for name, text in self._json.items())
        whole = f'{{"templates":{templates},"figures":{{{figures}}}}}'
        library = cache.answer(lambda: _packed(interactive.library(), 9), "library", version("plotly"))
        return Safe(_script("packed-library", library) + _script("packed-figures", _packed(whole)))

    def __len__(self) -> int:
        return len(self._json)

    def _keep(self, name: str, figure: "Figure") -> None:
        self._json[name] = figure.json()


def _script(name: str, packed: str) -> str:
    """What is `packed` in an element that no browser runs."""
    return f'<script type="text/plain" id="{name}">{packed}</script>\n'


def _packed(text: str, effort: int = 3) -> str:
    """`text`, compressed with an `effort` of 1 to 9, in letters that any page may hold."""
    return b64encode(compress(text.encode("utf-8"), effort, mtime=0)).decode("ascii")


# Tables in Markdown (pipe tables), padded so that their source reads as tables too.


def markdown_escaped(text: str) -> str:
    """`text` with what Markdown would read as a link, emphasis, HTML or the border of a cell spelled out."""
    return re.sub(r"([\\`*<|\[\]]|(?<!\w)_|_(?!\w))", r"\\\1", text)


def pipes(grid: Grid) -> str:
    """`grid` as one pipe table."""
    header = tuple(map(markdown_escaped, grid.header))
    columns = list(zip(header, *grid.lines, strict=True))
    widths = [max(3, *(len(cell) for cell in column)) for column in columns]
    rule = tuple(":" + "-" * (w - 1) if k in grid.left else "-" * (w - 1) + ":" for k, w in enumerate(widths))
    lines = []
    for cells in (header, rule, *grid.lines):
        listed = zip(cells, widths, strict=True)
        padded = (f"{cell:<{w}}" if k in grid.left else f"{cell:>{w}}" for k, (cell, w) in enumerate(listed))
        lines.append(f"| {' | '.join(padded)} |")
    return "\n".join(lines)


# Tables for a terminal, by rich.


WIDTH = PIPED_WIDTH
"""Columns of a table in a file."""

FIRST = ("warning: ", "problem ")
"""How notes begin that stand before all tables: nobody shall read figures of bad data first."""

VERDICT = 24
"""Columns below which words are not squeezed."""

GAP = 3
"""Columns between two columns of a table."""


def page(
    title: str, grids: Iterable[Grid], notes: Iterable[str] = (), width: int | None = None, opening: Iterable[str] = ()
) -> str:
    """A title, the paragraphs of its `opening`, tables and the notes below them as plain text of `width` columns.

    None is `page_width`.
    """
    from rich import box
    from rich.console import Console
    from rich.padding import Padding
    from rich.table import Table as RichTable
    from rich.text import Text

    console = Console(width=width or page_width(), color_system=None, force_terminal=False)
    with console.capture() as capture:
        console.print(Text(title), Text("═" * min(len(title), console.width)), sep="\n")
        said = list(notes)
        wrong = [note for note in said if note.startswith(FIRST)]
        for paragraph in opening:
            console.print(Text(), Text(paragraph), sep="\n")
        if wrong:
            console.print(Text(), *(Padding(Text(note), (0, 0, 0, 2)) for note in wrong), sep="\n")
        for part in (part for grid in grids for part in parts(grid, console.width)):
            table, columns = RichTable(box=box.SIMPLE_HEAD, pad_edge=False), []
            for k, column in enumerate(zip(part.header, *part.lines, strict=True)):
                # Padded here: rich strips what it justifies to the right, and with it the spaces that line the decimal points up.
                least = 0 if k in part.left else max(map(across, column))
                columns.append(["\n".join(f"{line:>{least}}" for line in cell.split("\n")) for cell in column])
                table.add_column(Text(columns[k][0]), no_wrap=k == 0 or k not in part.left)
            for line in list(zip(*columns, strict=True))[1:]:
                table.add_row(*(Text(cell) for cell in line))
            console.print(table)
        for note in said:
            if note not in wrong:
                console.print(Padding(Text(note), (0, 0, 0, 2)))
    return "\n".join(line.rstrip() for line in capture.get().splitlines()) + "\n"


def across(cell: str) -> int:
    """Columns of the terminal that `cell` takes, which may have several lines."""
    return max(map(len, cell.split("\n")))


def parts(grid: Grid, width: int) -> list[Grid]:
    """`grid` side by side in pieces of at most `width` columns, each with the first column of `grid`.

    A piece holds at least one column more, however narrow the terminal. Columns of a pair stay together: a deviation and the same
    in tolerances.
    """

    def needed(columns: list[tuple[str, ...]], words: bool) -> int:
        """Columns of the terminal, with the verdict at its narrowest."""
        widths = [max(map(across, column)) for column in columns]
        if words:
            widths[-1] = min(widths[-1], VERDICT)
        return sum(widths) + GAP * (len(widths) - 1) + 2

    label, *rest = zip(grid.header, *grid.lines, strict=True)
    step = 2 if grid.words else 1
    groups = [rest[i : i + step] for i in range(0, len(rest), step)]
    pieces = [[label, *groups[0]]]
    for group in groups[1:]:
        wider = [*pieces[-1], *group]
        if needed(wider, grid.words and group is groups[-1]) <= width:
            pieces[-1] = wider
        else:
            pieces.append([label, *group])
    found = []
    for piece in pieces:
        header, *lines = zip(*piece, strict=True)
        found.append(Grid(header=header, lines=tuple(lines), words=grid.words and piece is pieces[-1]))
    return found
