"""From a name on the command line to its reference: the table with every column, or one column to hold a result against."""

from __future__ import annotations

import re
from collections.abc import Callable, Mapping, Sequence
from dataclasses import dataclass, field, replace
from math import hypot
from pathlib import Path
from typing import TYPE_CHECKING

from geometry.arrays import Array
from geometry.article import Article
from geometry.articles import NAMES, built_in, changes_of
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Pose
from geometry.inertia import Inertia
from geometry.routes import DEFAULT_CHORD, ROUTES, agreement, by_mesh, by_routes, tessellation_error
from validation import changed
from validation.published import published
from validation.reference_table import MEASURED, PUBLISHED, ReferenceTable, route_statement
from validation.statement import Stated, Statement, seen_from

if TYPE_CHECKING:
    from validation.pictures import DrawnBody

DEFAULT_ARTICLES = ("cuboid", "disc", "fmd", "clumod-1", "clumod-4")
"""The four articles of the paper, Clumod in both configurations."""

REFERENCES = (PUBLISHED, MEASURED, *ROUTES)


@dataclass(frozen=True, kw_only=True)
class Asked:
    """How the articles of a command are to be read.

    Attributes
    ----------
    chord : chord error of the mesh route [m]; None for `DEFAULT_CHORD`, and for a share of each solid's size in a user's file
    unit, material : of user's files
    changes : the user's own dimensions of built-in articles, see `validation.changed`
    """

    chord: float | None = None
    unit: str | None = None
    material: str | None = None
    changes: Mapping[str, float] = field(default_factory=dict)


@dataclass(frozen=True, eq=False, kw_only=True)
class _Routes:
    """Inertia by every route asked for, what each may be off by (10,) about the origin, and what was said on the way.

    `chord` [m] is the largest chord error of the meshes, 0 where a mesh is taken as it is.
    """

    inertias: Mapping[str, Inertia]
    errors: Mapping[str, Array]
    agree: bool = True
    text: str = ""
    note: str = ""
    chord: float = 0.0
    warnings: tuple[str, ...] = ()

    def statements(self) -> dict[str, Statement]:
        return {route: route_statement(route, inertia, self.errors.get(route)) for route, inertia in self.inertias.items()}


def is_stack(name: str) -> bool:
    """Whether `name` is made of built-in parts only."""
    return set(name.split("+")) <= set(NAMES)


def is_file(name: str) -> bool:
    """Whether `name` is a user's own file or folder; the name of a built-in stack always means that."""
    if not name.strip() or is_stack(name):
        return False
    return Path(name).exists() or name.lower().endswith((".step", ".stp", ".stl", ".ply", ".obj", ".toml")) or "/" in name


def require_use(names: Sequence[str], asked: Asked) -> None:
    """Refuse a unit, a material or a change of dimensions that no article of `names` could use.

    Raises
    ------
    BadInput : unit or material are given, and every article is built in; a change, and no article has that part.
    """
    given = [option for option, value in (("--unit", asked.unit), ("--material", asked.material)) if value is not None]
    if given and all(map(is_stack, names)):
        raise BadInput(source=given[0], problem="a built-in article states its own", remedy="Leave it out, or name a file")
    if asked.changes:
        changed.require_used([name for name in names if not is_file(name)], asked.changes)


def reference_table(name: str, asked: Asked) -> ReferenceTable:
    """The table of the article `name`, in its own frame.

    Raises
    ------
    BadInput : no such article, or a file of which no body can be made.
    """
    routes = _of_file(name, asked) if is_file(name) else _of_built_in(name, asked)
    print_ = published(name)
    notes = [note] if (note := changes_note(name, asked)) else []
    return ReferenceTable(
        article=name,
        columns={**routes.statements(), **print_.statements},
        note=routes.note,
        agree=routes.agree,
        agreement=f"{routes.text}; chord error of the mesh {_length(routes.chord)}" if routes.chord else routes.text,
        chord=routes.chord,
        changes=_own_changes(name, asked),
        footnotes=(*notes, *print_.footnotes, *(f"{warning}." for warning in routes.warnings)),
        warnings=routes.warnings,
    )


def changes_note(name: str, asked: Asked) -> str:
    """What the user's own dimensions mean for the figures of the article `name`, a sentence; empty without any."""
    return "" if is_file(name) else changed.footnote(name, asked.changes, in_print=bool(published(name).statements))


def _own_changes(name: str, asked: Asked) -> Mapping[str, float]:
    return {} if is_file(name) else changes_of(name, asked.changes)


def reference(name: str, choice: str | None, asked: Asked, frame: Pose) -> tuple[str, Statement]:
    """What a result about the article `name` is held against, seen from `frame`: `choice` of `REFERENCES`, and its name.

    Without a choice it is the exact route, or the mesh where there is no other. A route's values carry the tolerance of the
    published values where there are any: the geometry was solved from these, and is not known better.

    Raises
    ------
    BadInput : no such article, or nothing of that choice is known of it.
    CheckFailed : the routes disagree about a file or about changed dimensions.
    """
    printed = {} if is_file(name) else published(name).statements
    if choice is not None and choice in printed:
        if asked.changes:
            raise BadInput(
                source=changed.OPTION, problem=f"{choice} values are those of the unchanged article", remedy="Leave it out"
            )
        return choice, seen_from(printed[choice], frame)
    only = None if asked.changes else choice or ROUTES[0]
    routes = _of_file(name, asked) if is_file(name) else _of_built_in(name, asked, only=only)
    if not routes.agree:
        raise CheckFailed(f"{name}: {routes.text}")
    chosen = choice or next(iter(routes.inertias))
    if chosen not in routes.inertias:
        raise BadInput(
            source=f"article {name}",
            field="--reference",
            problem=f"nothing {chosen} is known of it",
            remedy=f"Choose one of {', '.join((*(c for c in (PUBLISHED, MEASURED) if c in printed), *_possible(name, routes)))}",
        )
    return chosen, seen_from(_as_well_as(routes.statements()[chosen], printed), frame)


def _length(metres: float) -> str:
    return f"{metres * 1e3:.3g} mm" if metres >= 1e-3 else f"{metres * 1e6:.3g} µm"


def _possible(name: str, routes: _Routes) -> tuple[str, ...]:
    return tuple(routes.inertias) if is_file(name) else ROUTES


def _of_built_in(name: str, asked: Asked, only: str | None = None) -> _Routes:
    """By all routes, held against each other, or by `only` one of them (none when it is no route)."""
    article, chord = _article(name, asked), asked.chord or DEFAULT_CHORD
    errors = {"trimesh": tessellation_error(article, chord)}
    if only is not None:
        found = {only: _BY_ROUTE[only](article, chord)} if only in _BY_ROUTE else {}
        return _Routes(inertias=found, errors=errors, note=article.note, chord=chord)
    inertias = _by_routes(article, chord, changed_by_user=bool(asked.changes))
    verdict = agreement(article, inertias, chord)
    shared = _overlaps(article) if asked.changes or "+" in name else ""
    text = f"{shared}; {verdict.text}" if shared else verdict.text
    return _Routes(
        inertias=inertias, errors=errors, agree=verdict.agree and not shared, text=text, note=article.note, chord=chord
    )


def _overlaps(article: Article) -> str:
    """What no route can see, since each adds bodies up: two that share volume. Empty where none do."""
    from geometry.cad import brep

    pairs = [f"{a} and {b} share {1e9 * volume:.4g} mm³" for (a, b), volume in brep.overlaps(article).items()]
    more = f" and {len(pairs) - 3} pairs more" if len(pairs) > 3 else ""
    return f"bodies overlap: {', '.join(pairs[:3])}{more}" if pairs else ""


def _by_routes(article: Article, chord: float, *, changed_by_user: bool) -> Mapping[str, Inertia]:
    try:
        return by_routes(article, chord)
    except BadInput:
        raise
    except Exception as error:  # OCC and the mesh routines raise errors of every kind on bodies that cannot be
        if not changed_by_user:
            raise
        problem = f"no body of {article.name} can be made with these dimensions ({type(error).__name__})"
        raise BadInput(source=changed.OPTION, problem=problem, remedy="Check the sizes and their unit") from error


def _article(name: str, asked: Asked) -> Article:
    return built_in(name, changes_of(name, asked.changes))


def _of_file(name: str, asked: Asked) -> _Routes:
    from geometry import user_article

    article = user_article.load(name, unit=asked.unit, material=asked.material, chord=asked.chord)
    inertias = user_article.inertias(article)
    verdict = user_article.agreement(article, inertias)
    return _Routes(
        inertias=inertias,
        errors={"trimesh": verdict.tolerance} if "occ" in inertias else {},
        agree=verdict.agree,
        text=verdict.text,
        note=article.note,
        chord=max(part.chord for part in article.parts),
        warnings=article.warnings,
    )


def draw(name: str, asked: Asked, folder: Path = Path("out")) -> Path:
    """Write the picture of the article `name` into `folder`, in the article's own frame, and say where it is.

    Raises
    ------
    BadInput : no such article.
    CheckFailed : nothing can be rendered on this machine.
    """
    from validation.pictures import picture

    title, bodies, inertia, note = drawing(name, asked)
    path = folder / f"{file_name(title)}.png"
    picture(title, bodies, inertia, path, note)
    return path


def file_name(title: str) -> str:
    """`title` as the name of a file that stays in its folder: letters, digits and ``+ - _ .``, everything else a dash."""
    return re.sub(r"[^\w.+-]+", "-", title).strip(".-") or "article"


_Drawing = tuple[str, "tuple[DrawnBody, ...]", Inertia, str]


def drawing(name: str, asked: Asked) -> _Drawing:
    """Title, bodies, inertia and note of a picture of the article `name`, in the article's own frame.

    Raises
    ------
    BadInput : no such article.
    """
    return _users_drawing(name, asked) if is_file(name) else _drawing(name, asked)


def _drawing(name: str, asked: Asked) -> _Drawing:
    from validation.pictures import drawn_bodies

    article = _article(name, asked)
    note = f"{changes_note(name, asked)} {article.note}".strip()
    return name, drawn_bodies(article), _occ(article, DEFAULT_CHORD), note


def _users_drawing(name: str, asked: Asked) -> _Drawing:
    from geometry import user_article
    from validation.pictures import DrawnBody

    article = user_article.load(name, unit=asked.unit, material=asked.material, chord=asked.chord)
    bodies = tuple(
        DrawnBody(name=part.name, material=part.material.name, vertices=part.mesh.vertices, faces=part.mesh.faces)
        for part in article.parts
    )
    return article.name, bodies, next(iter(user_article.inertias(article).values())), article.note


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
