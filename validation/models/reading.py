"""From a model file to a `Model`: every key known, every size with its unit, every effect one of the catalogue.

``docs/model-file.md`` shows the file, `validation.models.writing` writes it.
"""

from __future__ import annotations

import os.path
from collections.abc import Callable, Mapping
from dataclasses import fields
from functools import lru_cache, partial
from pathlib import Path
from typing import Any

from geometry import toml_file
from geometry.articles import NAMES, built_in, changes_of, dimension_files
from geometry.articles.dimensions import load
from geometry.errors import BadInput
from geometry.keys import nearest
from validation.identifying.known import above_fmd
from validation.measurement_file import Fields
from validation.models import laboratory
from validation.models.effects import effects_of
from validation.models.model import BEAM, KINDS, USER, Model, StructureTolerances
from validation.models.numbers import number

TABLES = ("format", "model", "laboratory", "tolerances", "structure", "effect")
MODEL = ("title", "article")
STRUCTURE = ("kind", "modes", "damping_ratio", "dimensions", "own", "tolerances")

MOST_MODES = 500
LARGEST_SHARE = 10.0
"""A tolerance of more than ten times the value was meant in per cent."""


def read(path: str | Path) -> Model:
    """The model in the file at `path`.

    Raises
    ------
    BadInput : no such file, not TOML, an unknown or missing key, a wrong type, unit or size, an effect that is not in the
        catalogue or stands there twice; with the file, the field, what was found and what to do.
    OSError : the file cannot be read.
    """
    return of_table(toml_file.read(path, remedy="Write one with `massline model ARTICLE --out FILE`"), str(path))


def of_text(text: str, source: str) -> Model:
    """The model that `text` says; `source` is the file that it comes from or will go to.

    Raises
    ------
    BadInput : see `read`.
    """
    return of_table(toml_file.parse(text, source), source)


def of_table(table: dict[str, Any], source: str) -> Model:
    """The model in the `table` of the file `source`.

    Raises
    ------
    BadInput : see `read`.
    """
    _require_model(table, source)
    toml_file.require_format(table, source)
    whole = Fields(source=source, place="", table=table).only(TABLES)
    about, structure = whole.inner("model").only(MODEL), whole.inner("structure").only(STRUCTURE)
    own = _own(structure.inner("own"))
    kind = structure.choice("kind", KINDS) if "kind" in structure.table else BEAM
    known = laboratory.read(whole.inner("laboratory"))
    return Model(
        source=source,
        title=about.text("title"),
        article=_article(about, own, kind),
        hardware=known.hardware,
        gravity=known.gravity,
        fmd=known.fmd,
        fmd_tolerance=known.fmd_tolerance,
        cell_stiffness=known.cell_stiffness,
        tolerances=laboratory.tolerances(whole.inner("tolerances"), known.fmd_tolerance),
        kind=kind,
        modes=_modes(structure),
        changes=_changes(structure.inner("dimensions")),
        damping_ratio=number(structure, "damping_ratio", low=0.0, high=0.99) if "damping_ratio" in structure.table else None,
        own=own,
        structure=_tolerances(structure.inner("tolerances")),
        effects=effects_of(whole, anywhere=bool(own)),
    )


def _require_model(table: Mapping[str, Any], source: str) -> None:
    if "model" in table:
        return
    kinds = {"campaign": "a campaign.toml", "fe_model": "an FE model", "kind": "a measurement file", "inertia": "a result file"}
    what = next((f"this is {what}" for key, what in kinds.items() if key in table), "the table [model] is missing")
    near = nearest("model", list(table))
    problem = f"{what}, where a model file is needed"
    raise BadInput(source=source, field="model", problem=problem, remedy=f"{near}`massline model ARTICLE --out FILE` writes one")


def _article(about: Fields, own: Mapping[str, str], kind: str) -> str:
    name = about.text("article")
    if not name:
        raise about.refused("article", "the set-up is missing", 'Write for example article = "fmd+clumod-1"')
    if name in own or above_fmd(name) in own:
        return name
    if kind == USER:
        problem = f"{name!r} has no model of its own, and `structure.kind` is {USER!r}"
        raise about.refused("article", problem, "Name its file in [structure.own], or choose another kind")
    try:
        _require_built(name, ())
    except BadInput as error:
        remedy = f"{error.remedy}; what is your own has its file in [structure.own]"
        raise about.refused("article", error.problem, remedy) from None
    return name


def _modes(structure: Fields) -> int:
    count = structure.integer("modes", Model.modes, 1)
    if count > MOST_MODES:
        problem = f"must lie between 1 and {MOST_MODES}, found {count}"
        raise structure.refused("modes", problem, "What the modes beyond the last one kept contribute is in the residual mass")
    return count


def _tolerances(table: Fields) -> StructureTolerances:
    keys = tuple(one.name for one in fields(StructureTolerances))
    table.only(keys)
    return StructureTolerances(**{key: number(table, key, low=0.0, high=LARGEST_SHARE) for key in keys if key in table.table})


def _changes(table: Fields) -> dict[str, float]:
    """A user's own dimensions by dotted key, however the dots were written; checked against the dimension files."""
    found = _flat(table)
    known = tuple(dict.fromkeys(file for name in NAMES for file in dimension_files(name)))
    for key, value in found.items():
        file = key.split(".")[0]
        if file not in known:
            raise table.refused(key, f"no part is called {file!r}", f"{nearest(file, known)}Keys begin with {', '.join(known)}")
        _checked(table, key, partial(load, file, {key: value}))
    for name in NAMES if found else ():
        if own := changes_of(name, found):
            _checked(table, next(iter(own)), partial(_require_built, name, tuple(own.items())))
    return found


@lru_cache(maxsize=64)
def _require_built(name: str, changes: tuple[tuple[str, float], ...]) -> None:
    """Build an article once; what can be built is not built again, since texts are read over and over while they are edited."""
    built_in(name, dict(changes))


def _flat(table: Fields) -> dict[str, float]:
    found: dict[str, float] = {}
    for key, value in table.table.items():
        if isinstance(value, dict):
            inner = _flat(Fields(source=table.source, place=table.path(key), table=value))
            found |= {f"{key}.{rest}": size for rest, size in inner.items()}
        else:
            found[key] = number(table, key)
    return found


def _checked(table: Fields, key: str, attempt: Callable[[], object]) -> None:
    try:
        attempt()
    except BadInput as error:
        raise table.refused(key, error.problem, error.remedy) from None


def _own(table: Fields) -> dict[str, str]:
    """By article, the path of the file with its model, relative paths from the folder of the model file."""
    found = {}
    for article in table.table:
        name = table.text(article)
        if not name:
            raise table.refused(article, "a path is missing", 'Write "my-model.h5", from the folder of this file')
        path = os.path.normpath(Path(table.source).parent / name)
        _require_usable(table, article, path)
        found[article] = path
    return found


def _require_usable(table: Fields, article: str, path: str) -> None:
    from fem.users_model.reading import is_model
    from geometry.user_article import require_file

    if not Path(path).exists():
        raise table.refused(article, f"there is no file {path}", "Check the path; it is seen from the folder of this file")
    if not is_model(path):
        _checked(table, article, partial(require_file, path))
