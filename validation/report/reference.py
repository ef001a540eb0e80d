"""Articles and their known values: picture, reference table, and what weighings and pendulums say beside what is published."""

from collections.abc import Callable, Iterator, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from textwrap import shorten
from typing import TYPE_CHECKING, TypeVar

from geometry import cache, inertia_files
from geometry.articles import built_in, changes_of
from geometry.errors import BadInput, CheckFailed, lacking
from geometry.inertia import Inertia
from geometry.routes import ROUTES
from validation.classical import files
from validation.classical.files import Item, Reduction
from validation.model.setups import above_fmd, is_file, is_stack
from validation.output import NONE, print_json, print_pages, rounded, to_json
from validation.reference import reference
from validation.reference.reference import STATED, ArticleOptions, ReferenceTable
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
            raise BadInput(source="--column", problem=problem, remedy=f"Choose one of {', '.join(complete)}")
        bodies[table.article] = chosen.inertia
    for one in robots:
        of_one = one.bodies(column or STATED)
        if not of_one:
            raise BadInput(
                source="--column",
                problem=f"{one.source}: no link has {column!r}",
                remedy=f"Choose one of {', '.join((STATED, *ROUTES))}",
            )
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
        return document.render(tables)
    if form == "latex":
        return document.document([document.latex_render(table) for table in tables])
    if form == "markdown":
        return "\n".join(document.markdown_render(table) for table in tables)
    return "\n".join(document.text_render(table, document.WIDTH if to_file else None) for table in tables)


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

KEYS = ("mass", "cog_x", "cog_y", "cog_z", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
"""Results of a reduction in the order of a statement."""

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
        tables = () if of is None else (_values(of), _deviations(of), notes(document.notes(of)))
        parts.append(tag("div", tag("h3", one.name), picture(one.picture), *tables, notes(one.missing), class_="part"))
    return section("articles", "Articles and their reference", *parts) if parts else Safe("")


def _values(of: ReferenceTable) -> Safe:
    """What every column says, each with its tolerance in a column of its own where it states one."""
    printed = document.values(of)
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
