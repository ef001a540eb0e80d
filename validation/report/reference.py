"""A reference table as JSON: the output contract of `massline reference`."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TYPE_CHECKING, Any, TypeVar

from fem.user_model.reading import is_model
from geometry import cache
from geometry.errors import BadInput, CheckFailed
from geometry.inertia import Inertia
from geometry.routes import DEFAULT_CHORD, ROUTES
from validation.classical.files import Reduction, reference
from validation.compare.compare import Comparison
from validation.flexible.model import FlexibleOptions as Flexible
from validation.flexible.model import flexible
from validation.model.model import RIGID, Model
from validation.model.setups import above_fmd, is_file, is_stack
from validation.output import print_json, print_pages
from validation.reference.reference import (
    IDENTIFIED,
    MEASURED,
    PUBLISHED,
    ArticleOptions,
    ReferenceTable,
    _occ,
    changes_note,
    farthest,
    file_name,
    reference_table,
    rows,
    verdict,
)
from validation.reference.reference import _article as article_reference__article
from validation.reference.statement import QUANTITIES, Row, Stated, Statement, rows_json
from validation.report.document import NOTHING, Cell, Column, Figures, Number, Safe, number, table, tag, toleranced, values
from validation.report.document import notes as table_notes
from validation.report.flexible import ON_THE_SHEET, draw_sheet
from validation.report.parts import ArticlePart, Picture, Report, notes, picture, section


def draw(name: str, asked: ArticleOptions, folder: Path = Path("out")) -> Path:
    """Write the picture of the article `name` into `folder`, in the article's own frame, and say where it is.

    Raises
    ------
    BadInput : no such article.
    CheckFailed : nothing can be rendered on this machine.
    """
    from validation.report.scenes.scene import picture

    title, bodies, inertia, note = drawing(name, asked)
    path = folder / f"{file_name(title)}.png"
    picture(title, bodies, inertia, path, note)
    return path


if TYPE_CHECKING:
    from validation.report.scenes.scene import DrawnBody

_Drawing = tuple[str, "tuple[DrawnBody, ...]", Inertia, str]
"""Title, bodies, inertia and note of a picture."""


def drawing(name: str, asked: ArticleOptions) -> _Drawing:
    """Title, bodies, inertia and note of a picture of the article `name`, in the article's own frame.

    Raises
    ------
    BadInput : no such article.
    """
    return _users_drawing(name, asked) if is_file(name) else _drawing(name, asked)


def _drawing(name: str, asked: ArticleOptions) -> _Drawing:
    from validation.report.scenes.scene import drawn_bodies

    article = article_reference__article(name, asked)
    note = f"{changes_note(name, asked)} {article.note}".strip()
    return name, drawn_bodies(article), _occ(article, DEFAULT_CHORD), note


def _users_drawing(name: str, asked: ArticleOptions) -> _Drawing:
    from geometry import user_article
    from validation.report.scenes.scene import DrawnBody

    article = user_article.load(name, unit=asked.unit, material=asked.material, chord=asked.chord)
    bodies = tuple(
        DrawnBody(name=part.name, material=part.material.name, vertices=part.mesh.vertices, faces=part.mesh.faces)
        for part in article.parts
    )
    return article.name, bodies, next(iter(user_article.inertias(article).values())), article.note


def render(table: ReferenceTable) -> dict[str, Any]:
    """One article of the contract; published, measured and identified are null where nothing is stated."""
    return {
        "routes": {route: statement_json(table.columns[route]) for route in ROUTES if route in table.columns},
        **{c: statement_json(table.columns[c]) if c in table.columns else None for c in (PUBLISHED, MEASURED, IDENTIFIED)},
        "agree": table.agree,
        "agreement": table.agreement,
        "chord_m": table.chord,
        "changes": dict(table.changes),
        "rows": [
            {**line, "column": column, "reference_column": table.reference_columns[k]}
            for k in range(len(QUANTITIES))
            for column, one in rows(table, k)
            for line in rows_json([one])
        ],
        "verdict": {q.key: verdict(table, k) for k, q in enumerate(QUANTITIES)},
        "note": table.note,
        "warnings": list(table.warnings),
        "footnotes": list(table.footnotes),
    }


def statement_json(said: Statement) -> dict[str, Any]:
    """INERTIA of the contract with null for what is not stated, and the tolerances in the same shape."""
    return {
        **_shaped([_value(s) for s in said.values]),
        "about": "cog",
        "name": said.name,
        "source": said.source,
        "tolerance": {**_shaped([_tolerance(s) for s in said.values]), "note": said.tolerance_note},
    }


def _value(stated: Stated | None) -> float | None:
    return None if stated is None else stated.value


def _tolerance(stated: Stated | None) -> float | None:
    return None if stated is None else stated.tolerance


def _shaped(ten: list[float | None]) -> dict[str, Any]:
    shown = [None if v is None else _unrounded(v * q.per_si) for v, q in zip(ten, QUANTITIES, strict=True)]
    return {"mass_kg": shown[0], "cog_mm": shown[1:4], "moi_cog_kgm2": shown[4:7], "poi_cog_kgm2": shown[7:]}


def _unrounded(value: float) -> float:
    """Fifteen digits: what a printed 603.3 mm is, after its way through metres."""
    return float(f"{value:.15g}")


# How `weigh`, `cog` and `pendulum` answer: a table with its budgets, or the JSON object of the output contract.


def show(reduction: Reduction, against: str | None, as_json: bool) -> None:
    """Print `reduction` beside what is published about the article `against` (None: beside nothing).

    Raises
    ------
    BadInput : nothing is published about `against`.
    CheckFailed : no body has these moments; raised when everything is printed.
    """
    published = reference(against) if against else None
    if as_json:
        print_json(reduction.json(published))
    else:
        print_pages(reduction.pages(published))
    if reduction.impossible:
        raise CheckFailed(reduction.impossible)


# What is known of an article by itself: its drawing by three routes, print, weighing and pendulum; picture and mode shapes.


Made = TypeVar("Made")

KEYS = ("mass", "cog_x", "cog_y", "cog_z", "Ixx", "Iyy", "Izz", "Ixy", "Ixz", "Iyz")
"""Results of a reduction in the order of a statement."""

SOFT = 4.0
"""Times the top of the band up to which a mode makes shapes worth a picture."""


def article_part(name: str, model: Model, comparison: Comparison, classical: Sequence[Reduction]) -> ArticlePart:
    """What is known of the article `name`, which stands on the FMD."""
    missing: list[str] = []
    source = drawing_of(name, model)
    if not source:
        words = f"{name} is known by an FE model of your own, which has no drawing: no picture and no routes"
        return ArticlePart(name=name, missing=(words,))
    asked = ArticleOptions(changes=model.changes if is_stack(source) else {})
    table = _tried(
        lambda: _table(_kept(lambda: reference_table(source, asked), source, asked, "table"), name, classical), missing
    )
    said = f"{name}, with centre of gravity, principal axes and equivalent inertia ellipsoid, in the article's own frame"
    picture = _tried(lambda: _kept(lambda: drawn(lambda folder: draw(source, asked, folder), said), source, asked, said), missing)
    bends = _bends(name, model, comparison)
    shapes = _tried(lambda: _kept(lambda: _shapes(source, model), source, asked, "shapes"), missing) if bends else None
    return ArticlePart(name=name, table=table, picture=picture, shapes=shapes, missing=tuple(missing))


def drawing_of(name: str, model: Model) -> str:
    """By what name or path the article `name` is drawn; empty where it is known by a model alone."""
    if is_stack(name):
        return name
    path = next((path for article, path in model.own.items() if name in (article, above_fmd(article))), name)
    return "" if is_model(path) or not Path(path).exists() else path


def drawn(draw_into: Callable[[Path], Path], said: str) -> Picture:
    """The picture that `draw_into` writes into a folder."""
    with TemporaryDirectory() as folder:
        return Picture(png=draw_into(Path(folder)).read_bytes(), said=said)


def _kept(make: Callable[[], Made], source: str, asked: ArticleOptions, what: str) -> Made:
    """What `make` makes of the drawing `source`, of a built-in article once for all reports; a file may lean on others."""
    return cache.answer(make, what, source, asked) if is_stack(source) else make()


def _table(table: ReferenceTable, name: str, classical: Sequence[Reduction]) -> ReferenceTable:
    """The reference `table` with a column for each measurement that is about the article `name`."""
    own = [one for one in classical if one.article == name and any(key in KEYS for key in one.results)]
    columns = {f"classical {k}": _statement(one) for k, one in enumerate(own, start=1)}
    notes = tuple(f"Tolerances of {one.title} are ASSUMED." for one in own if one.assumed)
    return replace(table, article=name, columns={**table.columns, **columns}, footnotes=(*table.footnotes, *notes))


def _statement(one: Reduction) -> Statement:
    values = [one.results.get(key) for key in KEYS]
    stated = tuple(
        None if value is None else Stated(value=float(value.nominal_value), tolerance=float(value.std_dev) or None)
        for value in values
    )
    note = "assumed" if one.assumed else "as its readings state them"
    return Statement(name=one.title, values=stated, source=one.origin, tolerance_note=note)


def _bends(name: str, model: Model, comparison: Comparison) -> bool:
    """Whether it has a mode near the band, so that shapes are worth a picture."""
    if model.kind == RIGID:
        return False
    own = [
        (of, modes) for of, modes in zip(comparison.maps, comparison.modes, strict=True) if above_fmd(of.configuration) == name
    ]
    return any(one.frequency <= SOFT * of.frequency[-1] for of, modes in own for one in modes)


def _shapes(source: str, model: Model) -> Picture:
    asked = Flexible(count=ON_THE_SHEET, changes=model.changes if is_stack(source) else {})
    kind = "beam" if is_stack(source) else "solid"
    found = flexible(source, kind, asked)
    said = f"Mode shapes of {found.article} as drawn, base held, by the {kind} model; effects of the model are not in it"
    return drawn(lambda folder: draw_sheet(found, folder), said)


def _tried(make: Callable[[], Made], missing: list[str]) -> Made | None:
    """What `make` gives; None, and the reason among `missing`, where it cannot be made."""
    try:
        return make()
    except (BadInput, CheckFailed) as error:
        missing.append(str(error))
        return None


# The articles, rendered, and their reference tables: three routes beside print, weighing and pendulum.


def html(report: Report, figures: Figures) -> Safe:
    """The section; empty where no article is known by itself."""
    if not report.articles:
        return Safe("")
    return section("articles", "Articles and their reference", *(_article(one) for one in report.articles))


def _article(one: ArticlePart) -> Safe:
    tables = (_values(one.table), _deviations(one.table), notes(table_notes(one.table))) if one.table is not None else ()
    return tag("div", tag("h3", one.name), picture(one.picture), *tables, notes(one.missing), class_="part")


def _values(of: ReferenceTable) -> Safe:
    """What every column says, each with its tolerance in a column of its own where it states one."""
    printed = values(of)
    texts = {name: [line[k].strip() for line in printed.lines] for k, name in enumerate(of.columns, start=1)}
    stated = {name: [_stated(of, name, k, texts[name][k]) for k in range(len(QUANTITIES))] for name in of.columns}
    wide = {name for name, cells in stated.items() if any(tolerance is not NOTHING for _, tolerance in cells)}
    columns = [Column(head="quantity", words=True), Column(head="unit", words=True)]
    for name, said in of.columns.items():
        columns += [Column(head=_head(name, said)), *([Column(head=f"± {_head(name, said)}")] if name in wide else [])]
    rows = [
        [quantity.label, quantity.unit, *(cell for name in of.columns for cell in stated[name][k][: 1 + (name in wide)])]
        for k, quantity in enumerate(QUANTITIES)
    ]
    return table(f"{of.article}: mass, CoG and inertia", columns, rows)


def _head(column: str, said: Statement) -> str:
    """Of a column; what somebody printed as identified is not what was identified here."""
    return f"{said.name}, in print" if column == IDENTIFIED else said.name


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
    every = range(len(QUANTITIES))
    groups = {"routes": [name for name in of.columns if name in ROUTES]}
    groups |= {_head(name, said): [name] for name, said in of.columns.items() if name not in ROUTES}
    compared = {name: [farthest(of, own, k) for k in every] for name, own in groups.items()}
    compared = {name: found for name, found in compared.items() if any(found)}
    columns = [Column(head="deviation", words=True), Column(head="unit", words=True)]
    columns += [column for name in compared for column in (Column(head=name), Column(head="in tol."))]
    rows = [
        [
            QUANTITIES[k].label,
            _unit(of, k),
            *(cell for found in compared.values() for cell in _deviation(found[k])),
            verdict(of, k),
        ]
        for k in every
    ]
    head = f"{of.article}: deviation from the reference and verdict"
    return table(head, [*columns, Column(head="verdict", words=True)], rows) if compared else Safe("")


def _in_own_unit(of: ReferenceTable, k: int) -> bool:
    against = of.reference_columns[k]
    known = None if against is None else of.stated(against, k)
    return 1 <= k <= 3 or known is None or known.value == 0


def _unit(of: ReferenceTable, k: int) -> str:
    return QUANTITIES[k].unit if _in_own_unit(of, k) else "%"


def _deviation(one: Row | None) -> tuple[Cell, Cell]:
    if one is None:
        return NOTHING, NOTHING
    own = one.unit == "mm" or one.deviation_percent is None
    shown = number(one.deviation if own else one.deviation_percent, "+.3g")
    return shown, number(one.deviation_in_tolerances, "+.2f")
