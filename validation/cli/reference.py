"""Commands about articles and classical measurements: reference, validate, weigh, cog, pendulum."""

from dataclasses import replace
from functools import partial
from pathlib import Path
from typing import TYPE_CHECKING

import click
from click import argument, command, option

from geometry import toml_file
from geometry.errors import BadInput, CheckFailed
from validation.cli import options

if TYPE_CHECKING:
    from validation.reference.reference import ReferenceTable
    from validation.reference.robot import RobotFindings

TABLES = {"text": ".txt", "markdown": ".md", "csv": ".csv", "latex": ".tex"}
"""Forms of a table, and the endings of their files; what inertia is written for is `geometry.inertia_files.FORMATS`."""


@command("reference")
@argument("articles", nargs=-1, metavar="[ARTICLE ...]")
@options.JSON
@option(
    "--format",
    "form",
    metavar="FORM",
    help="A table: text (default), markdown, csv, latex. A body or the links of a robot for another program: urdf, mjcf, "
    "sdf, nastran, opensees, adams, toml.",
)
@option(
    "--out",
    type=click.Path(path_type=Path),
    metavar="FILE",
    help="Write there instead of on the screen, whole or not at all; without --format its ending says in which.",
)
@option("--column", metavar="COLUMN", help="Which column goes to another program.  [default: identified, else first route]")
@option("--link", metavar="LINK", help="Of a robot's links this one alone, as a table.")
@option("--view", is_flag=True, help="Also write a picture of every article under out/.")
@option("--identified", metavar="RESULT", help="Result file for the identified column (see massline validate).")
@options.FRAME
@options.asked
def reference_command(
    articles: tuple[str, ...],
    as_json: bool,
    form: str | None,
    out: Path | None,
    column: str | None,
    link: str | None,
    view: bool,
    identified: str | None,
    frame: str | None,
    chord: str | None,
    unit: str | None,
    material: str | None,
    repair: bool,
    settings: tuple[str, ...],
) -> None:
    """Mass, CoG and inertia of articles by three routes, beside published, measured and identified values.

    ARTICLE is a built-in part (cuboid, disc, fmd, clumod-1, clumod-4), a stack of them from bottom to top (fmd+disc+cuboid), or a
    STEP, STL, PLY, OBJ or article.toml file or folder of your own, or a robot description, URDF, MuJoCo's .xml or
    Gazebo's .sdf, whose links are held against their meshes. Without any, all five built-in parts.

    Exit code 1 when the routes of an article disagree by more than their stated errors, or a robot's link is wrong.
    """
    from geometry import inertia_files, robot
    from geometry.atomic import write_text
    from validation.output import counted, json_text, to_json, wrote
    from validation.reference.reference import DEFAULT_ARTICLES, IDENTIFIED, read_result, reference_table, require_use
    from validation.reference.robot import findings as robot_findings
    from validation.reference.statement import read_frame
    from validation.report.reference import draw, exported, robot_document, tables_text

    if form is None:
        ending = "" if out is None else out.suffix
        known = {ending: form for form, ending in TABLES.items()}
        by_ending = (form for form, one in inertia_files.FORMATS.items() if ending.lower() in one.endings)
        form = next(by_ending, known.get(ending.lower(), "text"))
    toml_file.one_of(form, (*TABLES, *inertia_files.FORMATS), source="--format", where="")
    if column is not None and form in TABLES:
        raise BadInput("--column", "", f"a {form} table has every column", "Add --format urdf, nastran ...")
    names = list(dict.fromkeys(articles)) or list(DEFAULT_ARTICLES)
    asked = options.reading(chord, unit, material, settings, repair)
    options.require_articles(names)
    require_use(names, asked)
    pose = None if frame is None else read_frame(frame)
    if identified is not None and len(names) > 1:
        remedy = "Name the one that was identified: massline reference ARTICLE --identified RESULT"
        raise BadInput("--identified", "", f"a result is about one article, found {len(names)}", remedy)
    result = None if identified is None else read_result(identified, article=names[0], frame=pose)
    robots = [name for name in names if Path(name).suffix.lower() in robot.ENDINGS]
    for other, value in (("--frame", frame), ("--identified", identified), ("--unit", unit), ("--material", material)):
        if robots and value is not None:
            problem = f"{robots[0]} is a robot, whose links have a frame, a mass and a unit of their own"
            raise BadInput(other, "", problem, "Leave it out")
    if link is not None and not robots:
        raise BadInput("--link", "", "no robot is among the articles", "Name a .urdf, .xml or .sdf file")
    tables: list[ReferenceTable] = []
    found: list[RobotFindings] = []
    for name in counted(names, "three routes", quiet=as_json):
        if name in robots:
            found.append(robot_findings(Path(name), link))
            tables += found[-1].tables
            continue
        table = reference_table(name, asked)
        if pose is not None:
            note = f"Origin and axes: --frame {frame}, in the article's frame."
            table = replace(table.seen_from(pose), footnotes=(*table.footnotes, note))
        tables.append(table if result is None else replace(table, columns={**table.columns, IDENTIFIED: result.statement}))
    warnings = () if result is None else result.warnings
    for warning in warnings:
        click.echo(f"massline: {warning}.", err=True)
    if form != "text" or out is not None or as_json:  # the tables' footnotes say them already
        for article, warning in ((table.article, said) for table in tables for said in table.warnings):
            click.echo(f"massline: {warning if warning.startswith(article) else f'{article}: {warning}'}.", err=True)
    if as_json:
        said = {"articles": {table.article: to_json(table) for table in tables}, "warnings": list(warnings)}
        text = json_text(said | ({"robots": [to_json(one) for one in found]} if found else {})) + "\n"
    elif form in inertia_files.FORMATS:
        text = exported(form, tables, found, column)
    elif form == "text" and found and link is None:
        shown = [one for one in tables if not any(one in of.tables for of in found)]
        text = "\n".join([*(robot_document(one).text() for one in found), *([tables_text(shown, form)] if shown else [])])
    else:
        text = tables_text(tables, form, to_file=out is not None)
    if out is None:
        click.echo(text, nl=False)
    else:
        write_text(out, text)
        wrote(out)
    for name in counted([name for name in names if name not in robots], "picture", quiet=as_json) if view else ():
        wrote(draw(name, asked))
    apart = [f"{table.article}: {table.agreement}" for table in tables if not table.agree]
    for one in found:
        if wrong := [link.name for link in one.links if link.wrong]:
            apart.append(f"{one.source}: the inertia of {len(wrong)} of {len(one.links)} links is wrong: {', '.join(wrong)}")
    if apart:
        raise CheckFailed("; ".join(apart))


@command("cog")
@options.measurement
def cog_command(file: str, against: str | None, as_json: bool) -> None:
    """Reduce the crane-and-balance test in FILE: CoG height with its tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-cog.
    """
    from validation.classical import weigh
    from validation.classical.files import readings_or_results
    from validation.report.reference import show

    show(readings_or_results(file, "crane-cog", weigh.reduce_cog, ("cog_x", "cog_y", "cog_z")), against, as_json)


@command("pendulum")
@options.measurement
@option("--without", "off", multiple=True, metavar="TERM", help="Leave out a correction: amplitude, damping or rope-mass.")
def pendulum_command(file: str, against: str | None, off: tuple[str, ...], as_json: bool) -> None:
    """Reduce the pendulum periods in FILE: moments of inertia with tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-pendulum.

    Exit code 1 when no body can have the moments that come out.
    """
    from validation.classical import pendulum
    from validation.classical.files import readings_or_results
    from validation.report.reference import show

    for name in off:
        if name not in pendulum.TERMS:
            raise BadInput("--without", "", f"no correction is called {name!r}", f"Known are {', '.join(pendulum.TERMS)}")
    reduce = partial(pendulum.reduce, off=off)
    show(readings_or_results(file, "pendulum", reduce, ("Ixx", "Iyy", "Izz")), against, as_json)


REFERENCES = ("occ", "trimesh", "pinocchio", "published", "measured")


@command("validate")
@argument("result", metavar="RESULT")
@option("--against", "article", metavar="ARTICLE", required=True, help="The article that RESULT is about.")
@option(
    "--reference",
    "choice",
    type=click.Choice(REFERENCES),
    metavar="COLUMN",
    help="What RESULT is held against: a route (occ, the default; trimesh, the default for a mesh; or pinocchio), or what is "
    "published or measured. A route counts as no more certain than the published values.",
)
@options.JSON
@options.FRAME
@options.asked
def validate_command(
    result: str,
    article: str,
    choice: str | None,
    as_json: bool,
    frame: str | None,
    chord: str | None,
    unit: str | None,
    material: str | None,
    repair: bool,
    settings: tuple[str, ...],
) -> None:
    """Anyone's identified ten parameters against the reference of ARTICLE.

    RESULT is a TOML or JSON file as in docs/reference-tables.md, any INERTIA that --json prints, or clumod-1-table2, the paper's
    own. It states its reference point, sign of products and frame. Rows are printed in --frame, which is also the frame of a
    RESULT that states none.

    Exit code 0 when every stated value lies within the combined tolerance of result and reference; 1 when one does not, or when
    no body can have these parameters.
    """
    from geometry.frames import Pose
    from validation.output import print_json, shown, to_json
    from validation.reference import reference
    from validation.reference.statement import read_frame
    from validation.report.reference import text_render

    options.require_articles([article])
    pose = None if frame is None else read_frame(frame)
    said = reference.read_result(result, article=article, frame=pose)
    asked = options.reading(chord, unit, material, settings, repair)
    reference.require_use([article], asked)
    with shown(f"reference of {article}", quiet=as_json):
        chosen, known = reference.reference(article, choice, asked, pose or Pose())
    check = reference.cross_check(said.statement, known, f"{article} ({chosen})")
    note = reference.changes_note(article, asked)
    if as_json:
        more = {
            "article": article,
            "reference": chosen,
            "tolerance_note": {"result": said.statement.tolerance_note, "reference": known.tolerance_note},
            "warnings": said.warnings,
            "changes": asked.changes,
        }
        print_json(to_json(check) | to_json(more))
    else:
        odd = [f"Not stated by the result: {', '.join(check.not_stated)}."] if check.not_stated else []
        odd += [f"Nothing to hold against: {', '.join(check.not_known)}."] if check.not_known else []
        odd += [f"{check.physics[0].upper()}{check.physics[1:]}.", *([note] if note else [])]
        odd += [f"{words}." for words in said.warnings]
        columns = {chosen: known, reference.IDENTIFIED: said.statement}
        title = f"{said.statement.source} against {article} ({chosen})"
        click.echo(text_render(reference.ReferenceTable(article=title, columns=columns, footnotes=tuple(odd))))
    if not check.passed:
        raise CheckFailed(check.text)
    if not as_json:
        click.echo(f"{check.text}.")


@command("weigh")
@options.measurement
def weigh_command(file: str, against: str | None, as_json: bool) -> None:
    """Reduce the weighing in FILE: mass with its tolerance, itemised.

    FILE is a path or the name of a file that ships with massline, for example clumod-4-weighing.
    """
    from validation.classical import weigh
    from validation.classical.files import readings_or_results
    from validation.report.reference import show

    show(readings_or_results(file, "weighing", weigh.reduce, ("mass",)), against, as_json)
