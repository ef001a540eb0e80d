"""Articles and their known values: picture, reference table, and what weighings and pendulums say beside what is published."""

import csv
import io
import math
import re
import unicodedata
from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from itertools import product
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import shorten
from typing import TYPE_CHECKING, TypeVar

from geometry import cache, inertia_files
from geometry.articles import built_in, changes_of
from geometry.errors import BadInput, CheckFailed, lacking
from geometry.inertia import Inertia
from geometry.routes import ROUTES
from geometry.user_article import ESTIMATE
from validation.classical import files
from validation.classical.files import KEYS, Item, Reduction
from validation.model.setups import above_fmd, is_file, is_stack
from validation.output import NONE, SIGNIFICANT, fixed, plain_unit, print_json, print_pages, rounded, to_json
from validation.reference import reference, statement
from validation.reference.reference import (
    IDENTIFIED,
    MEASURED,
    PUBLISHED,
    STATED,
    ArticleOptions,
    ReferenceTable,
    farthest,
    verdict,
)
from validation.reference.robot import LinkFindings, RobotFindings
from validation.reference.statement import MIN_WORDS, QUANTITIES, Stated, Statement, headline, rows_table
from validation.report import document
from validation.report.document import NOTHING, Cell, Column, Figures, Number, Safe, number, tag, toleranced
from validation.report.parts import ArticlePart, Picture, Report, notes, picture, section

if TYPE_CHECKING:
    from rich.console import RenderableType
    from rich.table import Table

    from validation.compare.compare import Comparison
    from validation.flexible.model import FlexibleOptions
    from validation.model.model import Model
    from validation.report.scenes.scene import DrawnBody


def draw(name: str, asked: ArticleOptions, folder: Path = Path("out"), *, sheet: bool = True) -> Path:
    """Write the picture of the article `name` into `folder`, in the article's own frame, and say where it is.

    Of a `sheet` it has title, figures and note as well; a page has them in its tables.

    Raises
    ------
    BadInput : no such article.
    CheckFailed : nothing can be rendered on this machine.
    """
    from validation.report.scenes.scene import picture

    title, bodies, inertia, note = drawing(name, asked)
    path = folder / f"{reference.file_name(title)}.png"
    picture(title, bodies, inertia, path, note, sheet=sheet)
    return path


def drawing(name: str, asked: ArticleOptions) -> "tuple[str, tuple[DrawnBody, ...], Inertia, str]":
    """Title, bodies, inertia and note of a picture of the article `name`, in the article's own frame.

    Raises
    ------
    BadInput : no such article.
    """
    from geometry import cad, user_article
    from validation.report.scenes.scene import DrawnBody, drawn_bodies

    if not is_file(name):
        article = built_in(name, changes_of(name, asked.changes))
        note = f"{reference.changes_note(name, asked)} {article.note}".strip()
        return name, drawn_bodies(article), cad.inertia(article), note
    own = user_article.load(name, unit=asked.unit, material=asked.material, chord=asked.chord)
    bodies = tuple(
        DrawnBody(name=part.name, material=part.material.name, vertices=part.mesh.vertices, faces=part.mesh.faces)
        for part in own.parts
    )
    return own.name, bodies, next(iter(user_article.inertias(own).values())), own.note


# How `massline reference` answers: all articles in one of the formats of its tables.


def exported(form: str, tables: Sequence[ReferenceTable], robots: Sequence[RobotFindings], column: str | None) -> str:
    """The inertia of every article and link as a file of another program; `column` says whose, by default what is identified.

    Raises
    ------
    BadInput : no such column, or one that does not state all ten values.
    """
    of_links = [table for one in robots for table in one.tables]
    bodies: dict[str, Inertia] = {}
    for table in (one for one in tables if one not in of_links):
        own = table.columns.get(reference.IDENTIFIED)
        default = reference.IDENTIFIED if own is not None and own.complete else next(iter(table.columns))
        chosen = table.columns.get(column or default)
        if chosen is None or not chosen.complete:
            complete = [name for name, said in table.columns.items() if said.complete]
            problem = f"{table.article}: column {column or default!r} " + (
                "is not there" if chosen is None else "does not state all ten values, and no other program takes fewer"
            )
            raise BadInput("--column", "", problem, f"Choose one of {', '.join(complete)}")
        bodies[table.article] = chosen.inertia
    for one in robots:
        of_one = one.bodies(column or STATED)
        if not of_one:
            problem = f"{one.source}: no link has {column!r}"
            raise BadInput("--column", "", problem, f"Choose one of {', '.join((STATED, *ROUTES))}")
        bodies |= of_one
    name = robots[0].robot.name if robots else next(iter(bodies))
    return inertia_files.written(form, name, bodies)


def robot_document(found: RobotFindings) -> document.Document:
    """What a person reads of a robot: what is wrong, and a line for every link."""

    def said(one: LinkFindings, label: str) -> tuple[str, ...]:
        return one.wrong if label == "WRONG" else one.doubts

    def ratios(one: LinkFindings) -> str:
        return NONE if one.moments_ratio is None else " ".join(f"{ratio:#.3g}" for ratio in one.moments_ratio)

    columns = (
        Column("link", lambda one: one.name, words=True),
        Column("mass [kg]", lambda one: one.link.mass or None, ".4g"),
        Column("a body", lambda one: {None: NONE, True: "yes", False: "NO"}[one.physical], words=True),
        Column("shape", lambda one: one.shape or NONE, words=True),
        Column("kg/m³", lambda one: one.density, ".0f"),
        Column("CoG apart [mm]", lambda one: one.cog_apart, ".1f"),
        Column("moments / shape's", ratios, words=True),
        Column("of its shape", lambda one: shorten("".join(one.notes[:1]).partition(";")[0], 90, placeholder=" …"), words=True),
    )
    opening = [
        f"{label}  {one.name}: {words}." for label in ("WRONG", "doubt") for one in found.links for words in said(one, label)
    ]
    notes = (
        f"{len(found.links)} links, {found.mass:.5g} kg, {sum(bool(one.both) for one in found.links)} held against a shape: "
        f"meshes by {', '.join(ROUTES)}; boxes, cylinders and the like in closed form.",
        "Shape: visual where it is the skin of a body, else collision; uniform, at the stated mass, in the frame of the link. "
        "Real links are not uniform: a difference alone is no mistake.",
        "moments / shape's: principal moments about the centre of mass, ascending. --link NAME shows a link's ten values.",
    )
    return document.Document(
        title=f"{found.robot.name} ({found.robot.form})",
        opening=["\n".join(opening) or "No link states an inertia that is wrong or doubtful."],
        blocks=[document.Table(columns=columns, rows=found.links)],
        notes=notes,
    )


def tables_text(tables: Sequence[ReferenceTable], form: str, *, to_file: bool = False) -> str:
    """`tables` as text, markdown, csv or latex; a file does not depend on the terminal that it was written from."""
    if form == "csv":
        return render(tables)
    if form == "latex":
        return latex_document([latex_render(table) for table in tables])
    if form == "markdown":
        return "\n".join(markdown_render(table) for table in tables)
    return "\n".join(text_render(table, document.WIDTH if to_file else None) for table in tables)


# How `weigh`, `cog` and `pendulum` answer: a table with its budgets, or the JSON object of the output contract.


def show(reduction: Reduction, against: str | None, as_json: bool) -> None:
    """Print `reduction` beside what is published about the article `against` (None: beside nothing).

    Raises
    ------
    BadInput : nothing is published about `against`.
    CheckFailed : no body has these moments; raised when everything is printed.
    """
    found = replace(reduction, reference=files.reference(against)) if against else reduction
    if as_json:
        print_json(to_json(found))
    else:
        print_pages(reduction_pages(found))
    if found.impossible:
        raise CheckFailed(found.impossible)


def reduction_pages(found: Reduction) -> "Iterator[RenderableType]":
    """What a person reads: the rows, the budgets, the corrections, the notes."""
    assumed = "; tolerances ASSUMED" if found.assumed else ""
    yield rows_table(found.rows, f"{found.title}\n{found.origin}{assumed}")
    for key, value in found.results.items():
        words, unit, factor = files.QUANTITIES[key]
        if (items := files.itemised(value)) and not found.assumed:
            yield budget_table(items, f"Tolerance of {words}", unit, factor)
    for name, parts in found.corrections_percent.items():
        shown = ", ".join(f"{correction} {percent:+.3f} %" for correction, percent in parts.items())
        yield f"Corrections in {name}: {shown or 'none'}"
    yield "Tolerances: one level for all inputs, independent, combined in quadrature to first order."
    yield from found.all_notes


def budget_table(items: Sequence[Item], title: str, unit: str, factor: float) -> "Table":
    """`items` as a table to print; contributions in `unit`, which is SI times `factor`."""
    from rich import box
    from rich.table import Table
    from rich.text import Text

    table = Table(title=headline(title), title_justify="left", box=box.SIMPLE_HEAD, padding=(0, 1, 0, 0), pad_edge=False)
    table.add_column("input", min_width=MIN_WORDS)
    for heading in ("value (SI)", "tolerance (SI)", f"contributes\n[{unit}]", "share of variance"):
        table.add_column(Text(heading), justify="right")
    for item in items:
        shown = (rounded(item.value, item.tolerance), f"{item.tolerance:.3g}", f"{factor * item.contribution:.2g}")
        table.add_row(Text(item.name), *shown, f"{100 * item.share:.1f} %")
    return table


# What is known of an article by itself: its drawing by three routes, print, weighing and pendulum; picture and mode shapes.


Made = TypeVar("Made")

SOFT = 4.0
"""Times the top of the band up to which a mode makes shapes worth a picture."""


def article_part(name: str, model: "Model", comparison: "Comparison", classical: Sequence[Reduction]) -> ArticlePart:
    """What is known of the article `name`, which stands on the FMD."""
    from validation.flexible.model import FlexibleOptions
    from validation.model.model import RIGID
    from validation.report.flexible import ON_THE_SHEET

    missing: list[str] = []
    source = drawing_of(name, model)
    if not source:
        words = f"{name} is known by an FE model of your own, which has no drawing: no picture and no routes"
        return ArticlePart(name=name, missing=(words,))
    changes = model.changes if is_stack(source) else {}
    asked = ArticleOptions(changes=changes)
    table = tried(lambda: _table(source, asked, name, classical), missing)
    said = f"{name}, with centre of gravity, principal axes and equivalent inertia ellipsoid, in the article's own frame"

    def plain() -> Picture:
        return drawn(lambda folder: draw(source, asked, folder, sheet=False), said)

    picture = tried(lambda: kept(plain, f"plain: {said}", source, asked), missing)
    shapes = None
    # Shapes are worth a picture where a mode is near the band
    pairs = zip(comparison.maps, comparison.modes, strict=True)
    own = [(of, modes) for of, modes in pairs if above_fmd(of.configuration) == name]
    near = any(one.frequency <= SOFT * of.frequency[-1] for of, modes in own for one in modes)
    if model.kind != RIGID and near:
        kind = "beam" if is_stack(source) else "solid"
        shapes = tried(lambda: _shapes(source, kind, FlexibleOptions(count=ON_THE_SHEET, changes=changes)), missing)
    return ArticlePart(name=name, table=table, picture=picture, shapes=shapes, missing=tuple(missing))


def drawing_of(name: str, model: "Model") -> str:
    """By what name or path the article `name` is drawn; empty where it is known by a model alone."""
    from fem.user_model.reading import is_model

    if is_stack(name):
        return name
    path = next((path for article, path in model.own.items() if name in (article, above_fmd(article))), name)
    return "" if is_model(path) or not Path(path).exists() else path


def drawn(draw_into: Callable[[Path], Path], said: str) -> Picture:
    """The picture that `draw_into` writes into a folder."""
    with TemporaryDirectory() as folder:
        return Picture(png=draw_into(Path(folder)).read_bytes(), said=said)


def _table(source: str, asked: ArticleOptions, name: str, classical: Sequence[Reduction]) -> ReferenceTable:
    """The reference table with a column for each measurement that is about the article `name`."""
    table = kept(lambda: reference.reference_table(source, asked), "reference", source, asked)
    own = [one for one in classical if one.article == name and any(key in KEYS for key in one.results)]
    # What somebody else weighed and identified says nothing of the article that was tested
    columns = {name: said for name, said in table.columns.items() if name not in (reference.MEASURED, reference.IDENTIFIED)}
    for k, one in enumerate(own, start=1):
        values = [one.results.get(key) for key in KEYS]
        stated = tuple(
            None if value is None else Stated(value=float(value.nominal_value), tolerance=float(value.std_dev) or None)
            for value in values
        )
        note = "assumed" if one.assumed else "as its readings state them"
        columns[f"classical {k}"] = Statement(name=one.title, values=stated, source=one.origin, tolerance_note=note)
    notes = tuple(f"Tolerances of {one.title} are ASSUMED." for one in own if one.assumed)
    return replace(table, article=name, columns=columns, footnotes=notes)


def _shapes(source: str, kind: str, asked: "FlexibleOptions") -> Picture:
    from validation.flexible.model import flexible
    from validation.report.flexible import draw_sheet

    def sheet() -> Picture:
        found = flexible(source, kind, asked)
        said = f"Mode shapes of {found.article} as drawn, base held, by the {kind} model; effects of the model are not in it"
        return drawn(lambda folder: draw_sheet(found, folder), said)

    return kept(sheet, f"shapes {kind}", source, asked)


def kept(make: Callable[[], Made], what: str, source: str, asked: object) -> Made:
    """What is known of a drawing of this house is made once; a user's own file may change while its name stays."""
    return cache.answer(make, what, source, asked) if is_stack(source) else make()


def tried(make: Callable[[], Made], missing: list[str], said: str = "") -> Made | None:
    """What `make` gives; None, and the reason after `said` among `missing`, where it cannot be made."""
    try:
        return make()
    except (BadInput, CheckFailed) as error:
        missing.append(f"{said}{error}")
    except ModuleNotFoundError as error:
        if (extra := lacking(error)) is None:
            raise
        missing.append(f"{said}{extra}")
    return None


# The articles, rendered, and their reference tables: three routes beside print, weighing and pendulum.


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where no article is known by itself."""
    parts = []
    for one in report.articles:
        of = one.table
        tables = () if of is None else (_values(of), _deviations(of), notes(remarks(of)))
        parts.append(tag("div", tag("h3", one.name), picture(one.picture), *tables, notes(one.missing), class_="part"))
    return section("articles", "Articles and their reference", *parts) if parts else Safe("")


def _values(of: ReferenceTable) -> Safe:
    """What every column says, each with its tolerance in a column of its own where it states one."""
    printed = values(of)
    columns = [Column(head="quantity", words=True), Column(head="unit", words=True)]
    rows: list[list[Cell]] = [[quantity.label, quantity.unit] for quantity in QUANTITIES]
    for place, name in enumerate(of.columns, start=1):
        stated = [_stated(of, name, k, line[place].strip()) for k, line in enumerate(printed.lines)]
        wide = 1 + any(tolerance is not NOTHING for _, tolerance in stated)
        head = _head(of, name)
        columns += [Column(head=head), Column(head=f"± {head}")][:wide]
        for row, cells in zip(rows, stated, strict=True):
            row += cells[:wide]
    return document.table(f"{of.article}: mass, CoG and inertia", columns, rows)


def _head(of: ReferenceTable, column: str) -> str:
    """Of a column; what somebody printed as identified is not what was identified here."""
    name = of.columns[column].name
    return f"{name}, in print" if column == reference.IDENTIFIED else name


def _stated(of: ReferenceTable, name: str, k: int, text: str) -> tuple[Cell, Cell]:
    """Value and tolerance, with the digits of the printed table; of a measurement with those that its tolerance leaves it."""
    stated, per_si = of.stated(name, k), QUANTITIES[k].per_si
    if stated is None:
        return NOTHING, NOTHING
    value, tolerance = stated.value * per_si, (stated.tolerance or 0.0) * per_si
    if name in ROUTES:
        return Number(value=value, text=text), NOTHING
    if stated.decimals is None:
        return toleranced(value, tolerance), toleranced(tolerance, tolerance) if tolerance else NOTHING
    own, apart, spread = text.partition(" ± ")
    return Number(value=value, text=own), Number(value=tolerance, text=spread) if apart else NOTHING


def _deviations(of: ReferenceTable) -> Safe:
    """How far the columns lie from the reference: per cent, of the CoG and where the reference is zero in its own unit."""
    groups = {"routes": [name for name in of.columns if name in ROUTES]}
    groups |= {_head(of, name): [name] for name in of.columns if name not in ROUTES}
    compared = {name: [reference.farthest(of, own, k) for k in range(len(QUANTITIES))] for name, own in groups.items()}
    compared = {name: found for name, found in compared.items() if any(found)}
    if not compared:
        return Safe("")
    columns = [Column(head="deviation", words=True), Column(head="unit", words=True)]
    columns += [column for name in compared for column in (Column(head=name), Column(head="in tol."))]
    rows = []
    for k, quantity in enumerate(QUANTITIES):
        against = of.reference_columns[k]
        known = None if against is None else of.stated(against, k)
        own_unit = 1 <= k <= 3 or known is None or known.value == 0
        cells: list[Cell] = []
        for found in compared.values():
            one = found[k]
            if one is None:
                cells += [NOTHING, NOTHING]
                continue
            own = one.unit == "mm" or one.deviation_percent is None
            size = number(one.deviation if own else one.deviation_percent, "+.3g")
            cells += [size, number(one.deviation_in_tolerances, "+.2f")]
        rows.append([quantity.label, quantity.unit if own_unit else "%", *cells, reference.verdict(of, k)])
    head = f"{of.article}: deviation from the reference and verdict"
    return document.table(head, [*columns, Column(head="verdict", words=True)], rows)


# A reference table in words: what every column says, and how far it lies off.


def values(table: ReferenceTable) -> document.Grid:
    """What every column says, with its tolerance where it has one that is more than rounding."""
    names = tuple(table.columns)
    body = [tuple(_value(table, column, k) for k in range(len(QUANTITIES))) for column in names]
    lines = tuple(zip(*((_labels(), *(document.aligned(column) for column in body))), strict=True))
    return document.Grid(header=("", *(table.columns[column].name for column in names)), lines=lines)


def grids(table: ReferenceTable) -> tuple[document.Grid, ...]:
    """The values and, where anything can be compared, their deviations."""
    return (values(table), deviations(table)) if _compared(table) else (values(table),)


def _compared(table: ReferenceTable) -> bool:
    """Whether any column has another to be held against."""
    return any(reference.row(table, column, k) for column in table.columns for k in range(len(QUANTITIES)))


def deviations(table: ReferenceTable) -> document.Grid:
    """How far the columns lie from the reference, in per cent (CoG also in mm) and in combined tolerances, and the verdict.

    The routes share one column, which shows the one that lies farthest off.
    """
    all_k = range(len(QUANTITIES))
    routes = {"routes": [c for c in table.columns if c in ROUTES]}
    groups = routes | {said.name: [c] for c, said in table.columns.items() if c not in ROUTES}
    most = {name: [farthest(table, columns, k) for k in all_k] for name, columns in groups.items()}
    compared = {name: rows for name, rows in most.items() if any(rows)}
    body = [
        cells
        for rows in compared.values()
        for cells in zip(*(_deviation(table, one, k) for k, one in enumerate(rows)), strict=True)
    ]
    verdicts = tuple(verdict(table, k) for k in all_k)
    header = [text for name in compared for text in (name, "tol.")]
    lines = tuple(zip(*((_labels(), *(document.aligned(cells) for cells in body), verdicts)), strict=True))
    return document.Grid(header=("deviation", *header, "verdict"), lines=lines, words=True)


def remarks(table: ReferenceTable) -> tuple[str, ...]:
    """What must be known to read the table."""
    against = {PUBLISHED: "the published value", MEASURED: "the measured value"}
    kinds = dict.fromkeys(against.get(c, f"route {c}") for c in table.reference_columns if c is not None)
    deviation = (
        f"Deviations are from {' or, where none is printed, '.join(kinds)}; of the routes, the farthest is shown. "
        "tol.: in combined tolerances, beyond 1 is outside."
    )
    tolerances = tuple(
        f"Tolerance of {said.name}: {said.tolerance_note}."
        for column, said in table.columns.items()
        if column in (PUBLISHED, MEASURED, IDENTIFIED, ESTIMATE) and said.tolerance_note
    )
    return (
        *((table.note,) if table.note else ()),
        *((f"Routes: {table.agreement}.",) if table.agreement else ()),
        *((deviation,) if _compared(table) else ()),
        *tolerances,
        *table.footnotes,
    )


def _labels() -> tuple[str, ...]:
    return tuple(f"{q.label} [{q.unit}]" for q in QUANTITIES)


def _value(table: ReferenceTable, column: str, k: int) -> str:
    stated = table.stated(column, k)
    if stated is None:
        return NONE
    per_si = QUANTITIES[k].per_si
    if column == ESTIMATE:
        return document.plus_minus(stated.value * per_si, (stated.tolerance or 0.0) * per_si)
    printed = stated.decimals is not None
    decimals = stated.decimals if stated.decimals is not None else _decimals(table, k)
    text, size = fixed(stated.value * per_si, decimals), (stated.tolerance or 0.0) * per_si
    # Half a unit of the last printed digit is said by the digits already
    rounding = stated.tolerance is None or math.isclose(size, 0.5 * 10.0**-decimals, rel_tol=1e-6)
    if not printed or rounding:
        return text
    # Two significant digits at the least, rounded up never away
    return f"{text} ± {fixed(size, max(decimals, 1 - math.floor(math.log10(size)) if size else 0))}"


def _decimals(table: ReferenceTable, k: int) -> int:
    """Decimals of a value that nobody printed."""
    kind = next(span for span in (slice(statement.MASS, 1), statement.COG, statement.TENSOR) if span.start <= k < span.stop)
    largest = max(
        (abs(stated.value) * q.per_si for c in table.columns for stated, q in _kind(table, c, kind) if stated is not None),
        default=0,
    )
    significant = SIGNIFICANT - 1 - math.floor(math.log10(largest)) if largest else SIGNIFICANT - 1
    published = [stated.decimals for stated, _ in _kind(table, PUBLISHED, kind) if stated and stated.decimals is not None]
    return max(significant, *(d + 1 for d in published), 0)


def _kind(table: ReferenceTable, column: str, kind: slice) -> list[tuple[Stated | None, statement.Quantity]]:
    return [(table.stated(column, k), QUANTITIES[k]) for k in range(kind.start, kind.stop)]


def _deviation(table: ReferenceTable, one: statement.Row | None, k: int) -> tuple[str, str]:
    if one is None or one.deviation is None:
        return NONE, NONE
    percent, many = one.deviation_percent, one.deviation_in_tolerances
    is_length = statement.COG.start <= k < statement.COG.stop
    own = f"{fixed(one.deviation, 2 if is_length else _decimals(table, k))} {one.unit}"
    relative = None if percent is None else f"{fixed(percent, 2)} %"
    size = relative if relative and not is_length else f"{own} ({relative})" if relative else own
    # A deviation in tolerances; beyond a thousand the figure says nothing more
    return size, NONE if many is None else fixed(many, 1) if abs(many) < 1000 else f"{'-' if many < 0 else ''}>999"


# Reference tables as CSV: one line for each quantity and column, full precision, units in a column of their own.
#
# Units are written in ASCII (kg m^2): a spreadsheet that is not told that a file is UTF-8 shows another sign for the raised 2.


HEADER = (
    *("article", "quantity", "unit", "column", "value", "tolerance", "reference_column", "reference"),
    *("deviation", "deviation_percent", "deviation_in_tolerances", "within"),
)


def render(tables: Sequence[ReferenceTable]) -> str:
    """All `tables` as one CSV text with a header; what is not stated is empty."""
    text = io.StringIO()
    writer = csv.writer(text, lineterminator="\n")
    writer.writerow(HEADER)
    for table, (k, quantity) in product(tables, enumerate(QUANTITIES)):
        for column in table.columns:
            stated = table.stated(column, k)
            if stated is None:
                continue
            form = ".12g" if stated.decimals is None else f".{stated.decimals}f"
            tolerance = "" if stated.tolerance is None else f"{stated.tolerance * quantity.per_si:.6g}"
            held: tuple[object, ...] = ("",) * 6
            if one := reference.row(table, column, k):
                sizes = (one.reference, one.deviation, one.deviation_percent, one.deviation_in_tolerances)
                shown = ("" if size is None else f"{size:.9g}" for size in sizes)
                held = (table.reference_columns[k], *shown, "yes" if one.within else "no")
            named = (table.article, quantity.key, plain_unit(quantity.unit), column)
            writer.writerow((*named, format(stated.value * quantity.per_si, form), tolerance, *held))
    return text.getvalue()


# A reference table in LaTeX: plain `tabular` with `\hline`, no package needed.
#
# A column of figures is two of LaTeX's that meet at the decimal point, so that the points stand below each other in any font.


MATHEMATICS = r"\Theta ^2 ^3 \pm \times \int \cdot ^\circ \mu \le \ge \to"

_SPECIAL = {
    "\\": r"\textbackslash{}",
    **{c: rf"\{c}" for c in "&%$#_{}"},
    "~": r"\textasciitilde{}",
    "^": r"\textasciicircum{}",
    "–": "--",
    **{c: f"${math}$" for c, math in zip("Θ²³±×∫·°µ≤≥→", MATHEMATICS.split(), strict=True)},
    **{c: f"${c}$" for c in "<>|"},  # the first fonts of TeX have other signs in their places
    "−": "$-$",
    "…": r"\dots{}",
    **dict.fromkeys("’‘", "'"),
}

_WESTERN = frozenset(map(chr, range(0xC0, 0x100))) - frozenset("ÐðÞþ÷")
"""Letters with accents that TeX's first fonts can set."""


def latex_render(table: ReferenceTable) -> str:
    """`table` as a LaTeX `table` environment, to be put into any document class."""
    shown = "\n\\par\\medskip\n".join(_grid(grid) for grid in grids(table))
    listed = "\n".join(rf"\item {escaped(note)}" for note in remarks(table))
    return (
        "\\begin{table}[htb]\n\\centering\\footnotesize\\renewcommand{\\arraystretch}{1.15}\n"
        f"\\caption{{Inertia parameters of {escaped(table.article)}}}\n\\smallskip\n"
        f"{shown}\n\\begin{{itemize}}\n{listed}\n\\end{{itemize}}\n\\end{{table}}\n"
    )


def latex_document(tables: list[str]) -> str:
    """A document that holds the rendered `tables` and compiles as it is."""
    head = "\\documentclass{article}\n\\usepackage[utf8]{inputenc}\n\\usepackage[landscape,margin=15mm]{geometry}\n"
    return head + "\\begin{document}\n" + "\n".join(tables) + "\\end{document}\n"


def escaped(text: str) -> str:
    """`text` with every character that LaTeX reads as a command, or may not know, spelled out; signs as mathematics."""

    def known(character: str) -> str:
        """Where every LaTeX has it, else its nearest letter or, of other scripts, its number."""
        if character.isascii() or character in _WESTERN:
            return character
        plain = unicodedata.normalize("NFKD", character).encode("ascii", "ignore").decode()
        return plain or f"U+{ord(character):04X}"

    spelled = "".join(_SPECIAL.get(character) or known(character) for character in text)
    indexed = re.sub(r"\$\\Theta\$([xyz]{2})\b", r"$\\Theta_{\1}$", spelled)
    return re.sub(r"(?<![\w.])-(?=\.?\d|\$>)", "$-$", indexed)


def _grid(grid: document.Grid) -> str:
    """Words as they are; a figure as two cells, before and from its decimal point."""
    form = "".join("l" if k in grid.left else "r@{}l" for k in range(len(grid.header)))
    header = " & ".join(
        escaped(cell) if k in grid.left else rf"\multicolumn{{2}}{{c}}{{{escaped(cell)}}}" for k, cell in enumerate(grid.header)
    )
    body = ""
    for line in grid.lines:
        cells = [(cell.strip(),) if k in grid.left else document.at_point(cell.strip()) for k, cell in enumerate(line)]
        body += " & ".join(escaped(part) for cell in cells for part in cell) + " \\\\\n"
    return f"\\begin{{tabular}}{{{form}}}\n\\hline\n{header} \\\\\n\\hline\n{body}\\hline\n\\end{{tabular}}"


# A reference table in Markdown.


def markdown_render(table: ReferenceTable) -> str:
    """`table` as a section of a Markdown page."""
    shown = "\n\n".join(document.pipes(grid) for grid in grids(table))
    listed = "\n".join(f"- {document.markdown_escaped(note)}" for note in remarks(table))
    return f"### {document.markdown_escaped(table.article)}\n\n{shown}\n\n{listed}\n"


def text_render(table: ReferenceTable, width: int | None = None) -> str:
    """`table` as plain text of `width` columns; None is `page_width`.

    No figure is cut or broken: words wrap, and a table that is still too wide is continued below itself.
    """
    return document.page(table.article, grids(table), remarks(table), width)
