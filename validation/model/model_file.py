"""From a model file to a `Model`: every key known, every size with its unit, every effect one of the catalogue.

``docs/model-file.md`` shows the file.
"""

import os
import re
from collections.abc import Callable, Iterable, Mapping, Sequence
from contextlib import suppress
from dataclasses import fields, replace
from functools import lru_cache, partial
from math import inf, isfinite, nextafter
from operator import add
from pathlib import Path
from typing import Any

import numpy as np
import tomlkit
from tomlkit.exceptions import TOMLKitError
from tomlkit.items import AoT

from geometry import routes, toml_file
from geometry.articles import NAMES, built_in, changes_of, dimension_files
from geometry.articles.parts import load
from geometry.errors import BadInput
from geometry.inertia import Inertia, judge, parallel_axis, six_from_tensor, tensor_from_six
from geometry.sensors import Tolerances
from geometry.toml_file import nearest, string
from geometry.user_article import DESCRIPTION
from identification import test_file
from identification.load_cells import assumed_stiffness
from identification.response_functions import GAIN
from validation.classical.files import Fields
from validation.effects.catalogue import FAMILIES, Named, parse
from validation.effects.effect import Vocabulary, built_in_places
from validation.model.learnt import Learnt
from validation.model.model import BEAM, KINDS, LIMITED, USER, Added, Model, Requirement
from validation.model.setups import FMD as KNOWN_FMD
from validation.model.setups import above_fmd, is_file, is_stack
from validation.model.tolerance_classes import CALIBRATED, METROLOGY, OF_LABORATORY, StructureTolerances, ToleranceClass
from validation.model.tolerance_classes import NAMES as CLASSES

# TOML as a person would write it: numbers in the fewest digits that say the same, comments below each other.


Line = tuple[str, str, str]
"""Key, value, comment."""


def block(head: str, lines: Sequence[Line]) -> str:
    """A table with its comments below each other."""
    width = max((len(f"{key} = {value}") for key, value, note in lines if note), default=0)
    pairs = ((f"{key} = {value}", note) for key, value, note in lines)
    return "\n".join([head, *(f"{pair:{width}}  # {note}" if note else pair for pair, note in pairs)])


def number(value: float) -> str:
    """The fewest digits that give `value` back exactly."""
    plain, short = repr(float(value) + 0.0), f"{value:g}"
    return short if "e" in short and len(short) < len(plain) and float(short) == value else plain


def numbers(values: Iterable[float]) -> str:
    return "[" + ", ".join(map(number, values)) + "]"


def shortest(target: float, read: Callable[[float], float], near: float) -> float:
    """The number of fewest digits about `near` that is read as `target`; the nearest where none is, by the last bit."""
    for digits in range(1, 18):
        if read(rounded := float(f"{near:.{digits}g}")) == target:
            return rounded
    beside = [nextafter(near, -inf), near, nextafter(near, inf)]
    return min(beside, key=lambda one: abs(read(one) - target))


# Numbers of a model file, each within what is physics.


LARGEST = 1e15


def as_number(table: Fields, key: str, *, low: float = -LARGEST, high: float = LARGEST, above: bool = False) -> float:
    """The number under `key` of `table`, from `low` to `high`; `above` leaves `low` itself out.

    Raises
    ------
    BadInput : it is missing, no number, or outside.
    """
    if key not in table.table:
        raise table.refused(key, "is missing", "Add it, or leave its whole table out")
    return checked(table, key, table.table[key], low=low, high=high, above=above)


def three(table: Fields, key: str, *, low: float, high: float) -> list[float]:
    """Three numbers under `key`, each as `number` has it.

    Raises
    ------
    BadInput : they are missing, not three, no numbers, or outside.
    """
    value = table.table.get(key)
    if not isinstance(value, list) or len(value) != 3:
        problem = "is missing" if value is None else f"three numbers are expected, found {value!r}"
        raise table.refused(key, problem, "Write [x, y, z]")
    return [checked(table, key, one, low=low, high=high) for one in value]


def checked(table: Fields, key: str, value: object, *, low: float, high: float, above: bool = False) -> float:
    """`value`, which stands under `key`, if it is such a number.

    Raises
    ------
    BadInput : it is not.
    """
    if not toml_file.is_number(value):
        raise table.refused(key, f"a number is expected, found {value!r}", "Write it without unit and quotes; the key names it")
    if not isfinite(value) or not low <= value <= high or (above and value == low):
        least = f"above {low:g}" if above else f"from {low:g}"
        raise table.refused(key, f"must be {least} to {high:g}, found {value!r}", "Check the number and the unit of the key")
    return float(value)


# The tables [[effect]] of a model file: an id of the catalogue, its value, what a fit left of its uncertainty.
#
# [[effect]]
# id = "appendage:z"
# value = { m = 0.05, f = 21.0, zeta = 0.01 }     # or one number, or text as on the command line
# sd = { m = 0.004 }                              # in the unit of the value
# fixed = false


EFFECT = ("id", "value", "sd", "fixed")


def effects_of(whole: Fields, *, anywhere: bool) -> tuple[Added, ...]:
    """The effects of the file, in its order; `anywhere` allows places and parts that no built-in article has.

    Channels are those of a campaign, of which the file knows nothing: any name will do here.

    Raises
    ------
    BadInput : an unknown key or id, with the nearest; a size that is no physics; an id that stands there twice.
    """
    if "effect" not in whole.table or whole.table["effect"] == []:
        return ()
    # What an effect of a model file may act on
    if anywhere:
        words = Vocabulary(accelerometers=None, forces=None, places=None, parts=None)
    else:
        words = Vocabulary(accelerometers=None, forces=None, places=built_in_places())
    found: dict[str, Added] = {}
    for entry in whole.each("effect"):
        entry.only(EFFECT)
        name = entry.text("id")
        if not name or "=" in name:
            effect_problem = "is missing" if not name else f"an id without its value is expected, found {name!r}"
            raise entry.refused("id", effect_problem, 'Write for example id = "force-gain:fmd-z2" and value = 0.08')
        value = _written(entry, "value")
        try:
            named = parse(f"{name}={value}" if value else name, words, source=entry.source)
        except BadInput as error:
            at = f"{entry.path('value' if name == error.field and value else 'id')}, {name}"
            raise BadInput(entry.source, at, error.problem, error.remedy) from None
        added = Added(named=named, deviation=_deviation(entry, named), fixed=entry.switch("fixed", False))
        if added.named.id in found:
            problem = f"{added.named.id} stands there twice"
            raise entry.refused("id", problem, "Keep one of them, with the whole size")
        found[added.named.id] = added
    return tuple(found.values())


def effect_text(added: Added) -> str:
    """The table [[effect]] of `added`, the family in words above it."""
    what = f"# {FAMILIES[added.named.family].what}"
    return "\n".join([what, "[[effect]]", *(f"{key} = {value}" for key, value in entries(added).items())])


def entries(added: Added) -> dict[str, str]:
    """By key, what [[effect]] says of `added`."""
    found = {"id": string(added.named.id)}
    for key, values in (("value", added.named.values), ("sd", added.deviation)):
        if values:
            if tuple(values) == ("",):
                found[key] = number(values[""])
            elif "" in values:  # a number of its own and others with a name: as on the command line
                found[key] = string(",".join(f"{key}:{number(one)}" if key else number(one) for key, one in values.items()))
            else:
                found[key] = "{ " + ", ".join(f"{key} = {number(one)}" for key, one in values.items()) + " }"
    return found | ({"fixed": "true"} if added.fixed else {})


def _written(entry: Fields, key: str) -> str:
    """The value under `key` as it is typed on the command line; empty where there is none."""
    value = entry.table.get(key, "")
    if isinstance(value, str):
        return value
    typed = partial(checked, entry, key, low=-LARGEST, high=LARGEST)
    if isinstance(value, dict):
        return ",".join(f"{inner}:{typed(one)!r}" for inner, one in value.items())
    return repr(typed(value))


def _deviation(entry: Fields, named: Named) -> Mapping[str, float]:
    text = _written(entry, "sd")
    found: dict[str, float] = {}
    for part in text.split(",") if text else ():
        key, _, size = (piece.strip() for piece in part.rpartition(":"))
        if key not in named.values or key in found:
            known = ", ".join(one or "a number" for one in named.values) or "none"
            raise entry.refused("sd", f"it goes with the value, which has {known}, found {part.strip()!r}", "Correct it")
        try:
            found[key] = checked(entry, "sd", float(size), low=0.0, high=LARGEST)
        except ValueError as error:
            if isinstance(error, BadInput):
                raise
            raise entry.refused("sd", f"a number is expected, found {size!r}", "Write it in the unit of the value") from None
    return found


# The tables [laboratory] and [tolerances] of a model file: gravity, the FMD, its cells, and what is not known of the chain.


CLASS = "class"
LABORATORY = ("hardware", "gravity_m_s2", "fmd", "cell_stiffness_N_m", "learnt")
INERTIA = ("mass_kg", "cog_mm", "moi_cog_kgm2", "poi_cog_kgm2")
DRAWING = "drawing"
FMD = ("inertia", "tolerance", *INERTIA)


def _inertia(table: Fields) -> Inertia | None:
    stated = [key for key in INERTIA if key in table.table]
    if "inertia" in table.table:
        table.choice("inertia", (DRAWING,))
        if stated:
            problem = f"the drawing is asked for, and {stated[0]} is stated"
            raise table.refused("inertia", problem, "Keep one of them")
    if not stated:
        return None
    # The inertia about F of the four figures in the file
    found = Inertia.from_cog(
        as_number(table, "mass_kg", low=0.0, high=1e6, above=True),
        [one / 1e3 for one in three(table, "cog_mm", low=-1e5, high=1e5)],
        tensor_from_six(
            [
                *three(table, "moi_cog_kgm2", low=0.0, high=1e9),
                *(three(table, "poi_cog_kgm2", low=-1e9, high=1e9) if "poi_cog_kgm2" in table.table else [0.0, 0.0, 0.0]),
            ]
        ),
    )
    verdict = judge(found)
    if not verdict.physical:
        remedy = "Give moments and products about the CoG"
        raise table.refused("moi_cog_kgm2", f"no body has this inertia: {verdict.text}", remedy)
    return found


STRUCTURE_FILE = ("fe_model", "stated")
"""Tables of a user's own structure, which may stand in the model file itself."""

TABLES = ("format", "model", "requirement", "laboratory", "tolerances", "structure", *STRUCTURE_FILE, "test", "effect")
MODEL = ("title", "article", "revision")
REQUIREMENT = ("quantity", "min", "max", "clause")
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
    if "model" not in table:
        kind = toml_file.kind_of(table)
        what = f"this is {kind}" if kind else "the table [model] is missing"
        alike = [key for key, one in table.items() if isinstance(one, dict) and {*one} & {*MODEL}]
        remedy = f"{nearest('model', alike)}`massline model ARTICLE --out FILE` writes one"
        remedy = f"MODEL comes first and DATA behind it. {remedy}" if kind == toml_file.KINDS["kind"] else remedy
        if STRUCTURE_FILE[0] in table:
            remedy = f"`massline model {source} --test TEST --out STUDY` writes one for both; without --test, one to simulate"
        raise BadInput(source, "model", f"{what}, where a model file is needed", remedy)
    toml_file.require_format(table, source)
    whole = Fields(source=source, place="", table=table).only(TABLES)
    about, structure = whole.inner("model").only(MODEL), whole.inner("structure").only(STRUCTURE)
    own = _own(structure.inner("own"))
    if STRUCTURE_FILE[0] in table:
        own |= {about.text("article"): source}
    kind = structure.choice("kind", KINDS) if "kind" in structure.table else BEAM
    laboratory = whole.inner("laboratory").only(LABORATORY)
    fmd = laboratory.inner("fmd").only(FMD)
    stiff = "cell_stiffness_N_m" in laboratory.table
    fmd_tolerance = as_number(fmd, "tolerance", low=0.0, high=1.0) if "tolerance" in fmd.table else 0.05
    stated = whole.inner("tolerances").only([CLASS, *(row.key for row in OF_LABORATORY)])
    known = ToleranceClass.named(stated.choice(CLASS, CLASSES) if CLASS in stated.table else METROLOGY)
    if STRUCTURE_FILE[0] in table and CLASS not in stated.table:  # its damping by mode is as builds scatter, whoever tests it
        builds = ToleranceClass.named(CALIBRATED).structure.mode_damping
        known = replace(known, structure=replace(known.structure, mode_damping=builds))
    told = laboratory.text("learnt")
    learnt = Learnt.read(Path(source).parent / told, laboratory.text("hardware")) if told else None
    for row in OF_LABORATORY:
        if learnt is not None and row.key in learnt.spreads:
            known = known.setting(row, learnt.spreads[row.key].deviation)
        if row.key in stated.table:
            known = known.setting(row, row.si(as_number(stated, row.key, low=0.0, high=row.largest)))
    count = structure.integer("modes", Model.modes, 1)
    if count > MOST_MODES:
        problem = f"must lie between 1 and {MOST_MODES}, found {count}"
        raise structure.refused("modes", problem, "What the modes beyond the last one kept contribute is in the residual mass")
    names = [one.name for one in fields(StructureTolerances)]
    spread = structure.inner("tolerances").only(names)
    return Model(
        source=source,
        title=about.text("title"),
        article=_article(about, own, kind),
        hardware=laboratory.text("hardware"),
        gravity=as_number(laboratory, "gravity_m_s2", low=0.0, high=30.0) if "gravity_m_s2" in laboratory.table else 9.81,
        fmd=_inertia(fmd),
        fmd_tolerance=fmd_tolerance,
        cell_stiffness=np.array(three(laboratory, "cell_stiffness_N_m", low=1.0, high=1e15)) if stiff else None,
        tolerance_class=known.name,
        tolerances=replace(known.chain, fmd_inertia=fmd_tolerance),
        sensor_gain=known.chain.gain if CLASS in stated.table else GAIN,
        opened=known.opened,
        mounting=known.mounting,
        learnt=learnt,
        kind=kind,
        modes=count,
        changes=_changes(structure.inner("dimensions")),
        damping_ratio=as_number(structure, "damping_ratio", low=0.0, high=0.99) if "damping_ratio" in structure.table else None,
        own=own,
        structure=replace(
            known.structure, **{key: as_number(spread, key, low=0.0, high=LARGEST_SHARE) for key in names if key in spread.table}
        ),
        tests=tuple(one.table for one in whole.each("test")) if "test" in whole.table else (),
        effects=effects_of(whole, anywhere=bool(own)),
        revision=about.text("revision"),
        requirements=tuple(map(_requirement, whole.each("requirement"))) if "requirement" in table else (),
    )


def _requirement(entry: Fields) -> Requirement:
    entry.only(REQUIREMENT)
    name = entry.choice("quantity", tuple(LIMITED))
    low, high = (one and one.nominal_value for one in (entry.optional(key, LIMITED[name]) for key in ("min", "max")))
    if low is None and high is None:
        raise entry.refused("min", "neither min nor max is stated", 'Write for example max = "33 kg"')
    if low is not None and high is not None and low > high:
        problem = f"must not be above max = {entry.table['max']!r}, found {entry.table['min']!r}"
        raise entry.refused("min", problem, "Exchange them, or correct one")
    return Requirement(quantity=name, low=low, high=high, clause=entry.text("clause"))


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
            found[key] = as_number(table, key)
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
        from fem.user_model.reading import is_model
        from geometry.user_article import require_file

        if not Path(path).exists():
            raise table.refused(article, f"there is no file {path}", "Check the path; it is seen from the folder of this file")
        if not is_model(path):
            _checked(table, article, partial(require_file, path))
        found[article] = path
    return found


# A study to start from: a structure of the user's own beside its tests, in a few lines.


def study_text(path: str, tests: Sequence[str], out: Path) -> str:
    """The model file that names the structure in `path` and the `tests`, whose files it finds from the folder of `out`.

    Raises
    ------
    BadInput : no structure, no test, tests of two articles, a file that does not lie below the folder of `out`.
    """
    from fem.structure import Structure
    from fem.user_model import reading

    if not Path(path).is_file() or not reading.is_model(path):
        raise BadInput(path, "", "it is no FE model of your own", "Name its description or data; --test goes with these")
    structure = reading.load(path)
    if not isinstance(structure.model, Structure):
        raise BadInput(path, "", "is known by modal data alone, which have no places", "Bring its matrices, its mesh or a frame")

    tables, articles = list[dict[str, Any]](), dict[str, str]()
    own = re.sub(r"[^A-Za-z0-9_-]+", "-", Path(path).stem)
    for name in map(toml_file.described_in, tests):
        for table in test_file.tables(name, own):
            articles.setdefault(test_file.read(name, table).article, name)
            moved = test_file.moved(table, name, out)
            tables.append({key: one for key, one in moved.items() if key not in ("format", "article")})
    if len(articles) > 1:
        raise BadInput("--test", "", f"they are of {' and of '.join(articles)}", "Write a study for each")
    article = next(iter(articles), own)
    stated = toml_file.read(path).get("model", {}) if Path(path).suffix == ".toml" else {}
    title = string(str(stated.get("title", structure.name)))
    lines = ["format = 1", f"model = {{ title = {title}, article = {string(article)} }}"]
    lines.append(f"structure = {{ own = {{ {string(article)} = {string(test_file.seen(path, out, 'ARTICLE'))} }} }}")
    return "\n".join([*lines, *("\n" + test_file.text(table) for table in tables)]) + "\n"


# A model file to start from: an article as it is drawn, in an ordinary laboratory, with nothing added.


def draft(article: str, out: Path | None = None) -> Model:
    """The model to start from for `article`, which is to be written to the file `out`, else here, or beside a file elsewhere.

    `article` is a built-in stack on the FMD; a file with a model or a drawing of the user's own, which is put on the FMD; or a
    model file, which is written anew.

    Raises
    ------
    BadInput : no such article, one that does not stand on the FMD, a file that is neither.
    OSError : a file cannot be read.
    """
    path = Path(article)
    if path.suffix.lower() in (".toml", ".json") and path.is_file():
        try:
            is_model_file = "model" in toml_file.read(path)
        except BadInput:
            is_model_file = path.name != DESCRIPTION  # `read` says what is wrong with it
        if is_model_file:
            found, at = read(article), out or Path("model.toml")
            if out is None and not path.resolve().is_relative_to(Path.cwd()):
                at = path.with_name(at.name)  # what it names is seen from there alone
            if at.resolve() in {Path(one).resolve() for one in found.own.values()}:
                problem = "the structure that it describes would not be in it any more"
                raise BadInput(str(out), "--out", problem, "Name another file")
            return replace(found, source=str(at), tests=tuple(test_file.moved(one, article, at) for one in found.tests))
    from fem.user_model.reading import is_model
    from geometry.user_article import require_file

    if is_stack(article) or not (is_file(article) or is_model(article)):
        built_in(article)
        if article.split("+")[0] != KNOWN_FMD:
            problem = "a model file describes what stands on the FMD, which must be the lowest of the stack"
            raise BadInput(f"article {article}", "", problem, f"Name {KNOWN_FMD}+{article}")
        title, own = "the FMD alone" if article == KNOWN_FMD else f"{above_fmd(article)} on the FMD", dict[str, str]()
    else:
        if not is_model(article):
            path = require_file(article)
        elif not path.is_file():
            raise BadInput(article, "", "there is no such file", "Check the path")
        name = path.parent.resolve().name if path.name == DESCRIPTION else path.stem
        said = path.with_suffix(".toml")  # by itself, or beside its data
        stated = toml_file.read(said).get(STRUCTURE_FILE[0]) if said.is_file() else None
        usual = "ground" if isinstance(stated, dict) and stated.get("kind") == "frame" else "base"
        by_itself = isinstance(stated, dict) and stated.get("support", usual) != "base"
        article, title = (name, name) if by_itself else (f"{KNOWN_FMD}+{name}", f"{name} on the FMD")
        own = {article: str(path)}
    return Model(source=str(out or "model.toml"), title=title, article=article, fmd_tolerance=Tolerances().fmd_inertia, own=own)


# The text of a model file with an effect more or less: every other line, and every comment, stays as its author wrote it.
#
# An effect is its ``[[effect]]`` line, the comment right above it, and all down to its last key. What an edit came to is read
# again and held against what was meant, so that a layout that is not foreseen here is refused and never damaged.


EDITED = ("value", "sd", "fixed")
SOURCE = "model file"


def with_effect(text: str, added: Added, source: str = SOURCE) -> str:
    """`text` of the file `source` with `added`: in the place of the effect of the same id, else as the last one.

    Raises
    ------
    BadInput : `text` is no model file, or its effects do not stand as [[effect]].
    """
    before = _read(text, source)
    ids = [one.named.id for one in before.effects]
    if added.named.id not in ids:
        return _verified(text, [f"{text.rstrip()}\n\n{effect_text(added)}\n"], [*before.effects, added], source)
    place = ids.index(added.named.id)
    above, header, keys, behind = _parted(text, place, source)
    # Value, sd and fixed replaced, their comments kept; what is new comes last
    table = tomlkit.parse(keys)
    says = ({"fixed": "false"} if "fixed" in table else {}) | entries(added)
    for key in EDITED:
        if key in says:
            table[key] = tomlkit.value(says[key])
    for key in {*EDITED} & table.keys() - says.keys():
        del table[key]
    anew = "".join(f"{line}\n" for line in effect_text(added).splitlines()[2:])
    edits = [f"{above}{header}{body}{behind}" for body in (tomlkit.dumps(table), anew)]
    return _verified(text, edits, [*before.effects[:place], added, *before.effects[place + 1 :]], source)


def _read(text: str, source: str) -> Model:
    if source.lower().endswith(".json"):
        problem = "it is JSON, which is read but not edited: it has no comments to keep"
        raise BadInput(source, "", problem, f"massline model {source} --out FILE.toml writes it as TOML")
    return of_text(text, source)


def _parted(text: str, place: int, source: str) -> tuple[str, str, str, str]:
    """`text` in four: what stands above the effect at `place`, its header, its keys, and what follows the last of them."""
    try:
        effects = tomlkit.parse(text).get("effect")
    except TOMLKitError:  # what it does not understand and Python does, cannot be changed by it either
        effects = None
    body = effects[place].as_string() if isinstance(effects, AoT) else ""
    if not body or body not in text:
        raise _laid_out_otherwise(source)
    head, _, behind = text.partition(body)
    keys = body.splitlines(keepends=True)
    while not keys[-1].strip() or keys[-1].lstrip().startswith("#"):
        behind = keys.pop() + behind
    header = head.splitlines(keepends=True)[-1]
    return head.removesuffix(header), header, "".join(keys), behind


def _verified(text: str, edits: Iterable[str], meant: Sequence[Added], source: str) -> str:
    """The first of the `edits` of `text` that has the effects that were `meant` and says nothing else otherwise."""
    was, refused = toml_file.parse(text, source) | {"effect": ()}, _laid_out_otherwise(source)
    for edited in edits:
        with suppress(BadInput):
            table = toml_file.parse(edited, source)
            if table | {"effect": ()} != was:
                continue
            try:
                found = of_table(table, source).effects
            except BadInput as error:  # what is meant cannot stand in this model, wherever it is written
                refused = error
            else:
                if _facts(found) == _facts(meant):
                    return edited
    raise refused


def _facts(effects: Iterable[Added]) -> list[tuple[object, ...]]:
    return [(one.named.id, dict(one.named.values), dict(one.deviation), one.fixed) for one in effects]


def _laid_out_otherwise(source: str) -> BadInput:
    problem = "its effects are not laid out so that one can be changed alone"
    return BadInput(source, "effect", problem, "Write each as a table of its own, [[effect]]")


# A `Model` as the text of its file, with comments; and a file's own text with an effect more or less, its comments kept.
#
# What is read back from `text` is the same model, bit for bit where it came from a file.


STRUCTURE_NOTES = {
    "modulus": "of every part's moduli",
    "mesh": "of how much too stiff a part's solid elements are, in what the jumps of their strains tell",
    "frequency": "of every mode's frequency, beside the moduli",
    "damping": "of every part's loss factor; of the logarithm of every mode's damping where damping_ratio gives it",
    "mode_damping": "of the logarithm of every mode's damping, beside the loss factors of the parts",
    "damping_law": "share of what parts lose that follows the velocity instead of the displacement",
    "loss_coupling": "share of what they couple modes by that is not there",
    "participation": "of every mode's participation, as a share of its largest",
    "mode_coupling": "of the damping between two modes, as a share of the geometric mean of theirs",
}


def text(model: Model) -> str:
    """The text of the model file of `model`."""
    about = [
        ("title", string(model.title), ""),
        ("article", string(model.article), "the set-up, bottom to top; one model serves a whole series"),
        *([("revision", string(model.revision), "of this file, as a report cites it")] if model.revision else []),
    ]
    stiffness = numbers(assumed_stiffness() if model.cell_stiffness is None else model.cell_stiffness)
    unknown = "# " if model.cell_stiffness is None else ""
    laboratory = [
        ("hardware", string(model.hardware), "FMD and sensors, as `campaign.hardware` calls them; empty: any"),
        ("gravity_m_s2", number(model.gravity), ""),
        (f"{unknown}cell_stiffness_N_m", stiffness, "one load cell along x, y, z; leave it out where it is not known"),
    ]
    if model.learnt is not None:
        path = os.path.relpath(model.learnt.source, Path(model.source).parent)
        laboratory.append(("learnt", string(path), "what it has learnt of its hardware: `massline laboratory` writes it"))
    stated = ToleranceClass(name=model.tolerance_class, chain=model.tolerances, opened=model.opened, mounting=model.mounting)
    unsaid = stated.name == METROLOGY and model.sensor_gain == GAIN
    tolerances = [] if unsaid else [(CLASS, string(stated.name), "whose figures hold where none is stated")]
    for row in OF_LABORATORY:
        size = stated.of(row)
        if row.of == "chain" or size != ToleranceClass().of(row) or stated.name != METROLOGY:
            tolerances.append((row.key, number(shortest(size, row.si, size / row.si(1.0))), row.what))
    if model.fmd is None:
        # The drawing asked for, and its figures as a comment to write one's own over
        drawn = routes.inertia(built_in(KNOWN_FMD, changes_of(KNOWN_FMD, model.changes)))
        rounded = Inertia.from_cog(float(f"{drawn.mass:.4g}"), np.round(drawn.cog, 5), np.diag(np.round(drawn.moments_cog, 4)))
        known = [("inertia", string(DRAWING), ""), *((f"# {key}", value, note) for key, value, note in _inertia_lines(rounded))]
    else:
        known = _inertia_lines(model.fmd)
    required = []
    for one in model.requirements:
        unit = toml_file.SI_UNITS[LIMITED[one.quantity]]
        limits = [(key, f"{number(size)} {unit}") for key, size in (("min", one.low), ("max", one.high)) if size is not None]
        said = (("quantity", one.quantity), *limits, ("clause", one.clause))
        required.append(block("[[requirement]]", [(key, string(words), "") for key, words in said if words]))
    blocks = [
        block(f"{_HEAD}format = {toml_file.FORMAT}\n\n[model]", about),
        *required,
        block("[laboratory]", laboratory),
        block(_FMD, [*known, ("tolerance", number(model.fmd_tolerance), "")]),
        block("# What is not known of the measurement chain, one standard deviation each; 0 is exact.\n[tolerances]", tolerances),
        *_structure(model),
        *(test_file.text(one, number) for one in model.tests),
        "# Effects that were added, in the order in which they act; `massline add` writes them, `massline undo` takes them out.",
        *(effect_text(one) for one in model.effects),
    ]
    return "\n\n".join(blocks) + "\n"


_HEAD = """\
# A model file of massline: a laboratory, a structure, and the effects that were added so far.
# Units are in the names; what has none is a share, or SI.
"""

_FMD = """\
# The FMD's moving part: its inertia as a tare or a drawing says, never assumed to be exact. `tolerance` is one standard deviation
# of every parameter, as a share. inertia = "drawing" takes that of the built-in reconstruction; or state your own figures.
[laboratory.fmd]"""


def _inertia_lines(inertia: Inertia) -> list[Line]:
    """Mass, CoG, moments and products, in digits that give the same ten parameters about F when they are read."""
    about_f = inertia.about((0.0, 0.0, 0.0))
    mass = about_f.mass
    cog = [shortest(first, lambda mm: mass * (mm / 1e3), 1e3 * first / mass) for first in map(float, about_f.first_moment)]
    steiner = six_from_tensor(parallel_axis(mass, [one / 1e3 for one in cog]))
    six = [
        shortest(target, partial(add, more), target - more)
        for target, more in zip(about_f.parameters[4:].tolist(), steiner.tolist(), strict=True)
    ]
    return [
        ("mass_kg", number(mass), ""),
        ("cog_mm", numbers(cog), "from F, the centre of the force-measuring plane"),
        ("moi_cog_kgm2", numbers(six[:3]), "xx, yy, zz about the CoG"),
        ("poi_cog_kgm2", numbers(six[3:]), "xy, xz, yz: entries of the tensor, -∫xy dm"),
    ]


def _structure(model: Model) -> list[str]:
    ratio = model.damping_ratio
    lines = [
        ("kind", string(model.kind), "beam, rigid (does not give), or own: every article has its own model below"),
        ("modes", str(model.modes), "kept; what the others contribute is in the residual mass"),
        (
            "# damping_ratio" if ratio is None else "damping_ratio",
            number(0.003 if ratio is None else ratio),
            "of every mode; left out, the loss factors of the parts hold",
        ),
    ]
    blocks = [block("[structure]", lines)]
    if model.changes:
        head = "# Your own dimensions of built-in parts, as in their file in geometry/articles.\n[structure.dimensions]"
        blocks.append(block(head, [(string(key), number(value), "") for key, value in model.changes.items()]))
    if model.own:
        head = "# Your own model by article: K and M, modal data or CAD, from the folder of this file.\n[structure.own]"
        folder = Path(model.source).parent
        own = [(string(article), string(os.path.relpath(path, folder)), "") for article, path in model.own.items()]
        blocks.append(block(head, own))
    head = "# How well it is known beforehand, one standard deviation as a share.\n[structure.tolerances]"
    names = [one.name for one in fields(StructureTolerances)]
    return [*blocks, block(head, [(name, number(getattr(model.structure, name)), STRUCTURE_NOTES[name]) for name in names])]
