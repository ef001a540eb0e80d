"""The answer of `massline model --examine`: what is wrong with a user's finite-element model, in words and with where."""

from collections.abc import Sequence
from dataclasses import replace
from pathlib import Path

import click

from fem.user_model import examine, reading
from geometry import toml_file
from geometry.errors import BadInput, CheckFailed
from validation.diagnose.reduction_errors import MULTIPLE, ReductionErrors, reduction_errors
from validation.output import print_json, shown, to_json
from validation.report.document import Column, Document, Table
from validation.study import Study


def answer(path: str, *, as_json: bool) -> None:
    """Print what is wrong with the model in `path`.

    Raises
    ------
    BadInput : it is no model, or cannot be read at all.
    CheckFailed : something is wrong with it.
    """
    if not Path(path).exists() or not reading.is_model(path):
        if Path(path).suffix.lower() == ".toml" and Path(path).is_file():
            toml_file.read(path)  # which says what is no TOML, such as a support that is named twice
        toml_file.require_no_other(Path(path))
        problem = "there is no such file" if not Path(path).exists() else "it is no finite-element model"
        remedy = f"Name one of {', '.join(reading.DATA_ENDINGS)}, or a description (.toml with [fe_model])"
        raise BadInput(source=path, problem=problem, remedy=remedy)
    with shown(f"examining {path}", quiet=as_json):
        found = examine.examine(path)
        reduced, why = ((), "") if found.findings else _reduced(path)
    if why:
        found = replace(found, unexamined=(*found.unexamined, why))
    if as_json:
        print_json({**to_json(found), "sound": not found.findings, "reduction": [to_json(one) for one in reduced]})
    else:
        click.echo(document(found, reduced).text(), nl=False)
    if found.findings:
        raise CheckFailed(verdict(found), findings=found.findings)


def _reduced(path: str) -> tuple[tuple[ReductionErrors, ...], str]:
    """How exact the reduction is for the tests that a model file names, and why it was not measured."""
    if Path(path).suffix.lower() != ".toml" or "test" not in toml_file.read(path):
        return (), ""
    try:
        return reduction_errors(Study.open(path, ())), ""
    except (BadInput, CheckFailed) as error:
        return (), f"How exact its reduction is was not measured: {error}"


def document(found: examine.Examination, reduced: Sequence[ReductionErrors] = ()) -> Document:
    """What was found, each with where, how much and what to do; causes first. Then how exact its reduction is."""
    columns = (
        Column("", lambda row: row[0], words=True),
        Column("finding", lambda row: row[1], words=True),
        Column("", lambda row: row[2], words=True),
    )
    rows = []
    for k, one in enumerate(found.findings, start=1):
        rows.append((str(k), one.check, f"{one.what}."))
        told = (("where", one.where), ("how much", one.amount), ("to do", one.remedy))
        rows += [("", head, f"{words}.") for head, words in told if words]
    of_effects = (
        Column("effect", lambda one: one.id, words=True),
        Column("size", lambda one: f"{one.size:.3g}"),
        Column("moves omega² by", lambda one: f"{100 * one.change:.2g} %"),
        Column("off by", lambda one: f"{100 * one.error:.2g} % of that"),
    )
    caption = f"How exact the reduction is, effects at {MULTIPLE:g} times what the tests would name; the worst"
    tables = [Table(caption=caption, columns=of_effects, rows=one.effects[:5]) for one in reduced if one.effects]
    return Document(
        title=f"{found.name}: {found.kind} in {found.source}",
        opening=[*([f"{'; '.join(found.facts)}."] if found.facts else []), *(f"{one.article}: {one.text}." for one in reduced)],
        blocks=(Table(caption="What is wrong", columns=columns, rows=rows), *tables),
        notes=[*(f"{words}." for words in found.unexamined), *([] if found.findings else [verdict(found)])],
    )


def verdict(found: examine.Examination) -> str:
    """One sentence."""
    many = len(found.findings)
    if not many:
        return f"{found.source}: nothing is wrong with it."
    return f"{found.source}: {many} finding{'s' if many > 1 else ''}, the first is {found.findings[0].check}."
