"""From a name on the command line to its reference: the table with every column, or one column to hold a result against."""

from __future__ import annotations

from collections.abc import Callable, Mapping
from dataclasses import dataclass, replace
from math import hypot
from pathlib import Path

from geometry.article import Article
from geometry.articles import built_in
from geometry.errors import BadInput
from geometry.frames import Pose
from geometry.inertia import Inertia
from geometry.routes import DEFAULT_CHORD, ROUTES, agreement, by_mesh, by_routes, tessellation_error
from validation.published import published
from validation.reference_table import MEASURED, PUBLISHED, ReferenceTable, route_statement
from validation.statement import Stated, Statement, seen_from

DEFAULT_ARTICLES = ("cuboid", "disc", "fmd", "clumod-1", "clumod-4")
"""The four articles of the paper, Clumod in both configurations."""

REFERENCES = (PUBLISHED, MEASURED, *ROUTES)


@dataclass(frozen=True, kw_only=True)
class Asked:
    """How the articles of a command are to be read: chord error of the mesh route [m], and unit and material of user's files."""

    chord: float = DEFAULT_CHORD
    unit: str | None = None
    material: str | None = None


def reference_table(name: str, asked: Asked) -> ReferenceTable:
    """The table of the article `name`, in its own frame.

    Raises
    ------
    BadInput : no such article.
    """
    article = built_in(name)
    inertias = by_routes(article, asked.chord)
    routes = {route: _route(article, route, inertia, asked.chord) for route, inertia in inertias.items()}
    verdict = agreement(article, inertias, asked.chord)
    print_ = published(name)
    return ReferenceTable(
        article=name,
        columns={**routes, **print_.statements},
        note=article.note,
        agree=verdict.agree,
        agreement=verdict.text,
        footnotes=print_.footnotes,
    )


def reference(name: str, choice: str, asked: Asked, frame: Pose) -> Statement:
    """What a result about the article `name` is held against: `choice` of `REFERENCES`, seen from `frame`.

    A route's values carry the tolerance of the published values where there are any: the geometry was solved from these, and
    is not known better.

    Raises
    ------
    BadInput : no such article, or nothing of that choice is in print about it.
    """
    article, statements = built_in(name), published(name).statements
    if choice in ROUTES:
        exact = _route(article, choice, _BY_ROUTE[choice](article, asked.chord), asked.chord)
        return seen_from(_as_well_as(exact, statements), frame)
    if choice not in statements:
        raise BadInput(
            source=f"article {name}",
            field="--reference",
            problem=f"nothing {choice} is in print about it",
            remedy=f"Choose one of {', '.join((*(c for c in (PUBLISHED, MEASURED) if c in statements), *ROUTES))}",
        )
    return seen_from(statements[choice], frame)


def draw(name: str, folder: Path = Path("out")) -> Path:
    """Write the picture of the article `name` into `folder`, in the article's own frame, and say where it is.

    Raises
    ------
    BadInput : no such article.
    CheckFailed : nothing can be rendered on this machine.
    """
    from validation.pictures import drawn_bodies, picture

    article, path = built_in(name), folder / f"{name}.png"
    picture(name, drawn_bodies(article), _occ(article, DEFAULT_CHORD), path, article.note)
    return path


def _route(article: Article, route: str, inertia: Inertia, chord: float) -> Statement:
    return route_statement(route, inertia, tessellation_error(article, chord) if route == "trimesh" else None)


def _as_well_as(exact: Statement, statements: Mapping[str, Statement]) -> Statement:
    if PUBLISHED not in statements:
        return exact
    pairs = zip(exact.values, statements[PUBLISHED].values, strict=True)
    note = "that of the published values, where there are any, and rounding"
    return replace(exact, values=tuple(mine and _widened(mine, theirs) for mine, theirs in pairs), tolerance_note=note)


def _widened(mine: Stated, theirs: Stated | None) -> Stated:
    return mine if theirs is None else replace(mine, tolerance=hypot(mine.tolerance or 0.0, theirs.tolerance or 0.0))


def _occ(article: Article, chord: float) -> Inertia:
    from geometry.cad import brep

    return brep.inertia(article)


def _pinocchio(article: Article, chord: float) -> Inertia:
    from geometry import multibody

    return multibody.inertia(article)


_BY_ROUTE: Mapping[str, Callable[[Article, float], Inertia]] = {"occ": _occ, "trimesh": by_mesh, "pinocchio": _pinocchio}
