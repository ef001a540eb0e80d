"""What is known of an article by itself: its drawing by three routes, print, weighing and pendulum; picture and mode shapes."""

from __future__ import annotations

from collections.abc import Callable, Sequence
from dataclasses import replace
from pathlib import Path
from tempfile import TemporaryDirectory
from typing import TypeVar

from fem.users_model.reading import is_model
from geometry.errors import BadInput, CheckFailed
from validation.article_reference import Asked, draw, is_stack, reference_table
from validation.comparing.comparison import Comparison
from validation.flexible.model import Asked as Flexible
from validation.flexible.model import flexible
from validation.flexible.shapes import ON_THE_SHEET, draw_sheet
from validation.identifying.known import above_fmd
from validation.models.model import RIGID, Model
from validation.reduction import Reduction
from validation.reference_table import ReferenceTable
from validation.report.nouns import ArticlePart, Picture
from validation.statement import Stated, Statement

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
    asked = Asked(changes=model.changes if is_stack(source) else {})
    table = _tried(lambda: _table(source, asked, name, classical), missing)
    picture = _tried(lambda: drawn(lambda folder: draw(source, asked, folder), _said(name)), missing)
    shapes = _tried(lambda: _shapes(source, model), missing) if _bends(name, model, comparison) else None
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


def _said(name: str) -> str:
    return f"{name}, with centre of gravity, principal axes and equivalent inertia ellipsoid, in the article's own frame"


def _table(source: str, asked: Asked, name: str, classical: Sequence[Reduction]) -> ReferenceTable:
    """The reference table with a column for each measurement that is about the article `name`."""
    table = reference_table(source, asked)
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
