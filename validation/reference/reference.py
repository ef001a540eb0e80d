"""From a name on the command line to its reference: the table with every column, or one column to hold a result against."""

import difflib
import math
import re
from collections.abc import Callable, Collection, Iterator, Mapping, Sequence
from dataclasses import dataclass, field, replace
from functools import partial
from math import hypot
from pathlib import Path
from typing import Any

import numpy as np

from geometry import toml_file
from geometry.article import Article
from geometry.articles import NAMES, built_in, changes_of, dimension_files
from geometry.errors import BadInput, CheckFailed
from geometry.frames import Array, Pose
from geometry.inertia import Inertia, judge
from geometry.mesh import DEFAULT_CHORD
from geometry.routes import ROUTES, agreement, by_mesh, by_routes, rounding, tessellation_error
from geometry.user_article import ESTIMATE
from validation.model.setups import is_file, is_stack
from validation.output import derived, entry, to_json, unwritten
from validation.reference import statement
from validation.reference.published import RESULTS, published, result_table
from validation.reference.statement import QUANTITIES, Quantity, Row, Stated, Statement, about_cog, jacobian, pose_of, seen_from

# The user's own dimensions of built-in articles, ``--set KEY=VALUE``: read, and said wherever a figure rests on them.


OPTION = "--set"

LARGEST = 1e6
"""In the dimension files' own units (mm, degrees, counts): a kilometre."""


def read(settings: Sequence[str]) -> dict[str, float]:
    """The changes that ``KEY=VALUE`` texts ask for, by key, in the unit of the dimension file; keys are not checked here.

    Raises
    ------
    BadInput : no "=", a value that is no finite number of a thinkable size, a key that is set twice.
    """
    changes: dict[str, float] = {}
    for text in settings:
        key, equals, value = (part.strip() for part in text.partition("="))
        if not equals or not key:
            raise _refused("", f"KEY=VALUE is expected, found {text!r}", "Write for example fmd.load_cell.moving_fraction=0.6")
        if key in changes:
            raise _refused(key, f"it is set twice, to {changes[key]:g} and {value}", "Keep one of them")
        try:
            number_value = float(value)
        except ValueError:
            remedy = "Write it alone, in the unit that the key names"
            raise _refused(key, f"a number is expected, found {value!r}", remedy) from None
        if not math.isfinite(number_value) or abs(number_value) > LARGEST:
            raise _refused(key, f"no dimension has this size, found {value}", "Check the number and the unit that the key names")
        changes[key] = number_value
    return changes


def require_used(names: Collection[str], changes: Mapping[str, float]) -> None:
    """Refuse a change that speaks of a part that none of the built-in articles `names` has.

    Raises
    ------
    BadInput : such a change, or an article that does not exist.
    """
    known = sorted({file for name in names for file in dimension_files(name)})
    for key in changes:
        file = key.split(".")[0]
        if file not in known:
            remedy = f"{toml_file.nearest(file, known)}Keys begin with {', '.join(known)}" if known else "Name a built-in article"
            raise _refused(key, f"no article here has a part {file!r}", remedy)


def _refused(key: str, problem: str, remedy: str) -> BadInput:
    return BadInput(OPTION, key, problem, remedy)


# `ReferenceTable`: what the routes, print, balance, pendulum and identification say about one article, side by side.
#
# Ten quantities by columns. Every column but one is held against the *reference* of its quantity: the published value (for
# Clumod that of the FE model) where one is printed, as in the paper's Tables 1 and 2; the exact route where none is. A deviation
# is given in per cent of the reference, in its own unit where the reference is zero, and in units of the combined tolerance
# (both in quadrature). A quantity's verdict names the columns that lie outside.


PUBLISHED, MEASURED, IDENTIFIED, STATED = "published", "measured", "identified", "stated"


@dataclass(frozen=True, eq=False, kw_only=True)
class ReferenceTable:
    """One article's table.

    Attributes
    ----------
    article : its name
    note : what its geometry rests on
    columns : statements by column, the routes first; all in one frame
    agree : whether the routes agree
    agreement : that verdict in a sentence
    chord : largest chord error of the mesh route [m]; 0 where a mesh is taken as it is
    changes : the user's own dimensions that the routes rest on, by key, in the unit of the dimension file
    footnotes : what must be known to read it
    warnings : what was noticed on the way, in words; each is among the footnotes too
    """

    article: str = unwritten()
    columns: Mapping[str, Statement] = unwritten()
    agree: bool = True
    agreement: str = ""
    chord: float = entry("chord_m", unit="m", default=0.0)
    changes: Mapping[str, float] = field(default_factory=dict)
    note: str = ""
    warnings: tuple[str, ...] = ()
    footnotes: tuple[str, ...] = ()

    @property
    @derived("", before="agree")
    def statements(self) -> dict[str, Any]:
        """Routes, and the columns that others state, None where nothing is stated."""
        routes = {route: self.columns[route] for route in ROUTES if route in self.columns}
        others = {column: self.columns.get(column) for column in (PUBLISHED, MEASURED, IDENTIFIED)}
        return {"routes": routes} | others | {name: self.columns[name] for name in (STATED, ESTIMATE) if name in self.columns}

    @property
    @derived("rows", before="note")
    def every_row(self) -> list[dict[str, Any]]:
        """Every column that is held against another, quantity by quantity."""
        return [
            to_json(one) | {"column": column, "reference_column": against}
            for k, against in enumerate(self.reference_columns)
            for column, one in rows(self, k)
        ]

    @property
    @derived("verdict", before="note")
    def verdicts(self) -> dict[str, str]:
        """By quantity."""
        return {quantity.key: verdict(self, k) for k, quantity in enumerate(QUANTITIES)}

    @property
    def reference_columns(self) -> tuple[str | None, ...]:
        """For each of the ten quantities the column that it is held against; None where nobody states it."""
        order = (PUBLISHED, *self.columns)
        return tuple(next((c for c in order if self.stated(c, k) is not None), None) for k in range(len(QUANTITIES)))

    def stated(self, column: str, k: int) -> Stated | None:
        """What `column` says about quantity `k`."""
        return self.columns[column].values[k] if column in self.columns else None

    def seen_from(self, frame: Pose) -> "ReferenceTable":
        """The same from the user's own `frame`, whose pose is given in the article's frame."""
        return replace(self, columns={column: seen_from(said, frame) for column, said in self.columns.items()})


def row(table: ReferenceTable, column: str, k: int) -> Row | None:
    """Quantity `k` of `column` beside its reference, in printed units; None where either is not stated or both are the same."""
    against = table.reference_columns[k]
    said = table.stated(column, k)
    if said is None or against is None or against == column:
        return None
    known = table.stated(against, k)
    return None if known is None else held_against(QUANTITIES[k], said, known, (table.columns[column].name, against))


def held_against(quantity: Quantity, said: Stated, known: Stated | None, names: tuple[str, str]) -> Row:
    """One stated value beside a known one, in printed units; `names` of the two say which tolerance dominates."""
    one, other = (None if of is None or of.tolerance is None else of.tolerance * quantity.per_si for of in (said, known))
    return Row(
        quantity=quantity.label,
        value=said.value * quantity.per_si,
        tolerance=one,
        unit=quantity.unit,
        reference=None if known is None else known.value * quantity.per_si,
        reference_tolerance=other,
        dominated_by=names[0] if (one or 0.0) >= (other or 0.0) else names[1],
    )


def rows(table: ReferenceTable, k: int) -> Iterator[tuple[str, Row]]:
    """Every column that is held against the reference of quantity `k`."""
    for column in table.columns:
        if (one := row(table, column, k)) is not None:
            yield column, one


def farthest(table: ReferenceTable, columns: Sequence[str], k: int) -> Row | None:
    """Of the rows of `columns` the one that deviates most; None where none is compared."""
    compared = [one for column in columns if (one := row(table, column, k)) is not None]
    return max(compared, key=lambda one: abs(one.deviation or 0.0), default=None)


def verdict(table: ReferenceTable, k: int) -> str:
    """Quantity `k` in words."""
    held = list(rows(table, k))
    if not held:
        return "nothing to compare"
    many = {column: in_tolerances(one.deviation_in_tolerances) for column, one in held if not one.within}
    return "; ".join(f"{column} outside{f' ({words})' if words else ''}" for column, words in many.items()) or "all within"


def route_statement(name: str, inertia: Inertia, error: Array | None = None) -> Statement:
    """A route's `inertia` with what it may be off by: rounding, and `error` (10,) of its parameters about the origin, Eq. 4.

    A CoG coordinate or product that does not rise above rounding is zero: it is the symmetry of the body that it fails to show.
    """
    least = _spread(inertia, rounding(inertia))
    tolerance = least if error is None else np.hypot(least, _spread(inertia, error))
    values = about_cog(inertia)
    return Statement(
        name=name,
        values=tuple(
            Stated(value=0.0 if abs(v) <= zero else float(v), tolerance=float(t))
            for v, zero, t in zip(values, least, tolerance, strict=True)
        ),
        source=f"route {name}",
        tolerance_note="rounding" if error is None else "95 % interval" if name == ESTIMATE else "rounding and tessellation",
    )


def _spread(inertia: Inertia, error: Array) -> Array:
    """What `error` (10,) of the parameters about the origin, Eq. 4, makes of the values about the CoG, (10,)."""
    J = jacobian(lambda parameters: about_cog(Inertia(parameters=parameters)), inertia.about(np.zeros(3)).parameters)
    return np.asarray(np.sqrt(J**2 @ error**2))


def in_tolerances(many: float | None, before: str = "") -> str:
    """A deviation in tolerances as words after `before`; empty without any."""
    if many is None:
        return ""
    return f"{before}{abs(many):.1f} tolerances" if abs(many) < 1000 else f"{before}over 999 tolerances"


DEFAULT_ARTICLES = ("cuboid", "disc", "fmd", "clumod-1", "clumod-4")
"""The four articles of the paper, Clumod in both configurations."""


@dataclass(frozen=True, kw_only=True)
class ArticleOptions:
    """How the articles of a command are to be read.

    Attributes
    ----------
    chord : chord error of the mesh route [m]; None for `DEFAULT_CHORD`, and for a share of each solid's size in a user's file
    unit, material : of user's files
    repair : whether a user's mesh is mended where that is safe, and estimated where it is no skin all the same
    changes : the user's own dimensions of built-in articles, see `validation.reference.reference`
    """

    chord: float | None = None
    unit: str | None = None
    material: str | None = None
    repair: bool = False
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


def require_use(names: Sequence[str], asked: ArticleOptions) -> None:
    """Refuse a unit, a material or a change of dimensions that no article of `names` could use.

    Raises
    ------
    BadInput : unit or material are given, and every article is built in; a change, and no article has that part.
    """
    values = (("--unit", asked.unit), ("--material", asked.material), ("--repair", asked.repair or None))
    given = [option for option, value in values if value is not None]
    if given and all(map(is_stack, names)):
        raise BadInput(given[0], "", "a built-in article states its own", "Leave it out, or name a file")
    if asked.changes:
        require_used([name for name in names if not is_file(name)], asked.changes)


def reference_table(name: str, asked: ArticleOptions) -> ReferenceTable:
    """The table of the article `name`, in its own frame.

    Raises
    ------
    BadInput : no such article, or a file of which no body can be made.
    """
    routes = _of_file(name, asked) if is_file(name) else _of_built_in(name, asked)
    print_ = published(name)
    notes = [note] if (note := changes_note(name, asked)) else []
    length = f"{routes.chord * 1e3:.3g} mm" if routes.chord >= 1e-3 else f"{routes.chord * 1e6:.3g} µm"
    chord = f"; chord error of the mesh {length}" if routes.chord else ""
    return ReferenceTable(
        article=name,
        columns={**routes.statements(), **print_.statements},
        note=routes.note,
        agree=routes.agree,
        agreement=f"{routes.text}{chord}",
        chord=routes.chord,
        changes={} if is_file(name) else changes_of(name, asked.changes),
        footnotes=(*notes, *print_.footnotes, *(f"{warning}." for warning in routes.warnings)),
        warnings=routes.warnings,
    )


def changes_note(name: str, asked: ArticleOptions) -> str:
    """What the user's own dimensions mean for the figures of the article `name`, a sentence; empty without any."""
    if is_file(name):
        return ""
    own = changes_of(name, asked.changes)
    if not own:
        return ""
    from geometry import routes

    changed, idle = routes.inertia(built_in(name, own)).parameters, []
    for key in own:
        without = routes.inertia(built_in(name, {other: value for other, value in own.items() if other != key}))
        if not np.any(np.abs(changed - without.parameters) > rounding(without)):
            idle.append(key)
    words = [f"Dimensions changed: {', '.join(f'{key} = {value:g}' for key, value in own.items())}"]
    words += [f"without effect on its inertia: {', '.join(idle)}"] if idle else []
    words += ["published and measured values are those of the unchanged article"] if published(name).statements else []
    return f"{'; '.join(words)}."


def reference(name: str, choice: str | None, asked: ArticleOptions, frame: Pose) -> tuple[str, Statement]:
    """What a result about the article `name` is held against, seen from `frame`, and its name.

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
            raise BadInput(OPTION, "", f"{choice} values are those of the unchanged article", "Leave it out")
        return choice, seen_from(printed[choice], frame)
    only = None if asked.changes else choice or ROUTES[0]
    routes = _of_file(name, asked) if is_file(name) else _of_built_in(name, asked, only=only)
    if not routes.agree and not asked.repair:
        raise CheckFailed(f"{name}: {routes.text}")
    chosen = choice or next(iter(routes.inertias))
    if chosen not in routes.inertias:
        possible = (*(c for c in (PUBLISHED, MEASURED) if c in printed), *(routes.inertias if is_file(name) else ROUTES))
        remedy = f"Choose one of {', '.join(possible)}"
        raise BadInput(f"article {name}", "--reference", f"nothing {chosen} is known of it", remedy)
    exact = routes.statements()[chosen]
    if PUBLISHED in printed:
        widened = tuple(
            mine
            if mine is None or theirs is None
            else replace(mine, tolerance=hypot(mine.tolerance or 0.0, theirs.tolerance or 0.0))
            for mine, theirs in zip(exact.values, printed[PUBLISHED].values, strict=True)
        )
        note = "that of the published values, where there are any, and rounding"
        exact = replace(exact, values=widened, tolerance_note=note)
    return chosen, seen_from(exact, frame)


def _of_built_in(name: str, asked: ArticleOptions, only: str | None = None) -> _Routes:
    """By all routes, held against each other, or by `only` one of them (none when it is no route)."""
    from geometry import cad, routes

    article, chord = built_in(name, changes_of(name, asked.changes)), asked.chord or DEFAULT_CHORD
    errors = {"trimesh": tessellation_error(article, chord)}
    if only is not None:
        by: dict[str, Callable[[Article], Inertia]] = {
            "occ": cad.inertia,
            "trimesh": partial(by_mesh, chord=chord),
            "pinocchio": routes.by_pinocchio,
        }
        found = {only: by[only](article)} if only in by else {}
        return _Routes(inertias=found, errors=errors, note=article.note, chord=chord)
    try:
        inertias = by_routes(article, chord)
    except BadInput:
        raise
    except Exception as error:  # OCC and the mesh routines raise errors of every kind on bodies that cannot be
        if not asked.changes:
            raise
        problem = f"no body of {article.name} can be made with these dimensions ({type(error).__name__})"
        raise BadInput(OPTION, "", problem, "Check the sizes and their unit") from error
    verdict = agreement(article, inertias, chord)
    agree, text = verdict.agree, verdict.text
    if asked.changes or "+" in name:
        # What no route can see, since each adds bodies up: two that share volume
        pairs = [f"{a} and {b} share {1e9 * volume:.4g} mm³" for (a, b), volume in cad.overlaps(article).items()]
        if pairs:
            more = f" and {len(pairs) - 3} pairs more" if len(pairs) > 3 else ""
            agree, text = False, f"bodies overlap: {', '.join(pairs[:3])}{more}; {text}"
    return _Routes(inertias=inertias, errors=errors, agree=agree, text=text, note=article.note, chord=chord)


def _of_file(name: str, asked: ArticleOptions) -> _Routes:
    from geometry import user_article

    article = user_article.load(name, unit=asked.unit, material=asked.material, chord=asked.chord, repair=asked.repair)
    inertias = user_article.inertias(article)
    verdict = user_article.agreement(article, inertias)
    estimates = [one.estimate.error * one.material.density for one in article.parts if one.estimate is not None]
    errors = {user_article.ESTIMATE: np.sum(estimates, axis=0) if estimates else np.zeros(10), "trimesh": verdict.tolerance}
    return _Routes(
        inertias=inertias,
        errors={route: error for route, error in errors.items() if error.any()},
        agree=verdict.agree,
        text=verdict.text,
        note=article.note,
        chord=max(part.chord for part in article.parts),
        warnings=article.warnings,
    )


def file_name(title: str) -> str:
    """`title` as the name of a file that stays in its folder: letters, digits and ``+ - _ .``, everything else a dash."""
    return re.sub(r"[^\w.+-]+", "-", title).strip(".-") or "article"


# A result against its reference, row by row, and what to say about the whole.
#
# *Within* means that a value differs from its reference by no more than the tolerance of the result and that of the reference,
# in quadrature. A value that the result does not state, or that has no reference, is not judged but named.


@dataclass(frozen=True, eq=False, kw_only=True)
class CrossCheck:
    """What came of it.

    Attributes
    ----------
    rows : one for each value that both state
    not_stated : labels of the values that the result does not state
    not_known : labels of the values that it states and the reference does not
    physical : whether a body can have the stated parameters; None when too few are stated to tell
    physics : that verdict in words
    """

    rows: tuple[Row, ...] = entry(write=lambda rows: [to_json(row) | {"deviation": row.deviation} for row in rows])
    physical: bool | None
    physics: str
    not_stated: tuple[str, ...]
    not_known: tuple[str, ...]
    against: str = unwritten(default="the reference")

    @property
    def outside(self) -> tuple[Row, ...]:
        """The rows that lie outside."""
        return tuple(row for row in self.rows if not row.within)

    @property
    @derived("passed", before="physical")
    def passed(self) -> bool:
        """Every row within, at least one of them, and no law of physics broken."""
        return bool(self.rows) and not self.outside and self.physical is not False

    @property
    @derived("text", before="physical")
    def text(self) -> str:
        """The verdict in a sentence."""
        if not self.rows:
            return f"nothing could be compared with {self.against}"
        if not self.outside:
            held = f"all {len(self.rows)} stated values agree with {self.against} within the combined tolerance"
        else:
            named = []
            for row in self.outside:
                percent = row.deviation_percent
                size = f"{row.deviation:+.3g} {row.unit}" if percent is None else f"{percent:+.2f} %"
                named.append(f"{row.quantity} ({size}{in_tolerances(row.deviation_in_tolerances, ', ')})")
            held = f"outside the combined tolerance of {self.against}: {', '.join(named)}"
        return held if self.physical is not False else f"{held}; and {self.physics}"


def cross_check(result: Statement, reference: Statement, against: str = "the reference") -> CrossCheck:
    """Hold `result` against `reference`, both in one frame; `against` are words for the latter."""
    triples = list(zip(QUANTITIES, result.values, reference.values, strict=True))
    # The judgement on all ten values; on fewer only what no products could mend, for they leave the diagonal as it is
    physical: bool | None = None
    if None in result.values[:7] or result.values[0] is None or result.values[0].value == 0:
        physics = "too few values are stated to judge whether a body can have them"
    else:
        verdict = judge(result.inertia, rounding=1e-9)
        if not verdict.physical:
            physical, physics = False, f"no body has these parameters: {verdict.text}"
        elif not result.complete:
            physics = "nothing speaks against a body with these parameters; without the products it cannot be proven"
        else:
            physical, physics = True, f"a body can have these parameters: {verdict.text}"
    return CrossCheck(
        rows=tuple(
            held_against(q, said, known, ("result", f"reference ({reference.name})"))
            for q, said, known in triples
            if said is not None and known is not None
        ),
        not_stated=tuple(q.label for q, said, _ in triples if said is None),
        not_known=tuple(q.label for q, said, known in triples if said is not None and known is None),
        physical=physical,
        physics=physics,
        against=against,
    )


# Somebody's identified ten parameters, from a file: our own format, what `massline identify --json` prints, or a bare INERTIA.
#
# `validation.reference.statement` documents the tables that hold the values. Around them stand
#
# - ``format = 1``;
# - `article`, optional: what was identified; a result about another article than the one at hand is refused;
# - `frame`, optional: where the file's own frame sits in the article's (see `validation.reference.statement`); left out, the
# file is taken   to be in the frame in which it is to be shown, by default the article's.
#
# The same may be written in JSON. Missing values are allowed and come out as not stated.


_PRINTED = {"mass_kg": (1.0, 1), "cog_mm": (1e-3, 3), "moi_cog_kgm2": (1.0, 3), "poi_cog_kgm2": (1.0, 3)}
"""Keys of INERTIA: factor to SI and length."""

_IDENTIFY = ("inertia", "origin", "interval95")


@dataclass(frozen=True, eq=False, kw_only=True)
class StatedResult:
    """A result as read.

    Attributes
    ----------
    statement : in the frame in which it is to be shown
    warnings : what is odd about the file, in words
    """

    statement: Statement
    warnings: tuple[str, ...] = ()


def read_result(name: str, *, article: str, frame: Pose | None = None, way: str = "") -> StatedResult:
    """The result in the file `name`, or in print under that name, about `article`, seen from `frame` (its pose in the article's).

    `way` picks one of the results of an identification, "plain" or "self-calibrated"; by default it is the one that counts.

    Raises
    ------
    BadInput : not TOML or JSON, about another article, none of the forms, unknown keys, missing units, a frame that is not known.
    OSError : the file cannot be read.
    """
    if name in RESULTS and not Path(name).exists():
        table = result_table(name)
    else:
        shipped = RESULTS
        remedy = f"{toml_file.nearest(name, shipped)}Give a result file, or one that ships: {', '.join(shipped)}"
        table = toml_file.read(name, remedy=remedy)
    # Refuse a result about another article; between a user's own names, which may mean the same, it is only said
    about = table.get("article", article)
    path = Path(article)
    if isinstance(about, str) and _plain(about) in map(_plain, (article, path.name, path.stem)):
        warnings: tuple[str, ...] = ()
    else:
        problem = f"it says that it is about {about if isinstance(about, str) else repr(about)}, held against {article}"
        if isinstance(about, str) and not _is_built_in(about) and not _is_built_in(article):
            warnings = (f"{name}: {problem}",)
        else:
            raise BadInput(name, "article", problem, "Name the same article, or correct the file")
    # An identification's `table` with the result of `way` in the place of the one that counts
    if not way:
        of_way: dict[str, Any] = table
    else:
        key = way.replace("-", "_")
        if not isinstance(table.get(key), dict):
            raise BadInput(name, key, f"there is no {way} result", "Give the JSON of `massline identify`")
        of_way = {**table, **{part: table[key].get(part) for part in ("inertia", "interval95")}}
    return StatedResult(statement=_statement(of_way, name, article, frame), warnings=warnings)


def _plain(article: str) -> str:
    return "".join(article.split()).lower()


def _is_built_in(article: str) -> bool:
    return set(article.split("+")) <= set(NAMES)


def _statement(table: dict[str, Any], name: str, article: str, frame: Pose | None) -> Statement:
    if "format" in table:
        shown = frame or Pose()
        toml_file.require_format(table, name)
        toml_file.require_known(table, ("format", "article", "frame", *statement.TABLES), source=name)
        own = shown.inverse @ pose_of(table["frame"], name) if "frame" in table else Pose()
        return statement.read(table, name, own)
    if "mass_kg" in table:
        return _from_inertia(table, name)
    if any(key in table for key in _IDENTIFY[1:]) and "inertia" in table:
        if table.get("origin") == "F" and frame is None and not article.startswith("fmd"):
            problem = f"the CoG is stated from F, and {article} does not say where F is"
            raise BadInput(name, "origin", problem, 'Say where F is in the article\'s frame, for example --frame "0 0 -45 mm"')
        inertia = toml_file.require_table(table["inertia"], source=name, where="inertia")
        intervals = toml_file.require_table(table.get("interval95") or {}, source=name, where="interval95")
        said = _from_inertia(inertia, name, intervals)
        if not table.get("frame"):
            return said
        return seen_from(said, pose_of(table["frame"], name).inverse @ (frame or Pose()))
    problem = f"is none of the forms that can be read, found the keys {', '.join(table) or '(none)'}"
    remedy = (
        "Did you mean format? " if difflib.get_close_matches("format", list(table)) else ""
    ) + "Write format = 1 and an [inertia] table, or give the JSON of `massline identify`"
    raise BadInput(name, "format", problem, remedy)


def _from_inertia(inertia: dict[str, Any], name: str, intervals: dict[str, Any] | None = None) -> Statement:
    toml_file.require_present(inertia, _PRINTED, source=name)
    if inertia.get("about", "cog") != "cog":
        problem = f'INERTIA is about "cog", found {inertia["about"]!r}'
        raise BadInput(name, "about", problem, "State another point in a file of format = 1")
    values: list[Stated | None] = []
    for key, (factor, length) in _PRINTED.items():
        place = f"interval95.{key}"
        ends = _list((intervals or {}).get(key), length, name, place)
        for value, pair in zip(_list(inertia[key], length, name, key), ends, strict=True):
            if value is None:
                values.append(None)
                continue
            one = Stated(value=_finite(value, name, key) * factor)
            if pair is not None:
                low, high = (_finite(end, name, place) * factor for end in _list(pair, 2, name, place))
                one = statement.with_interval(one, low, high, name, place)
            values.append(one)
    note = "95 % intervals" if intervals else "none stated"
    return Statement(name="identified", values=tuple(values), source=name, tolerance_note=note)


def _list(value: Any, length: int, name: str, field: str) -> list[Any]:
    if value is None:
        return [None] * length
    listed = [value] if length == 1 else value
    if not isinstance(listed, list) or len(listed) != length:
        raise BadInput(name, field, f"must be a list of {length}, found {value!r}", "See INERTIA")
    return listed


def _finite(value: Any, name: str, field: str) -> float:
    if not toml_file.is_number(value) or not abs(value) < float("inf"):
        raise BadInput(name, field, f"must be a finite number, found {value!r}", "Correct it")
    return float(value)
