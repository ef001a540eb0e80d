"""Commands that hold a model against measurements: compare, diagnose, add, undo, ladder, correct, report, app and their kin."""

import os
import shlex
import sys
from pathlib import Path
from typing import Any

import click
from click import argument, command, option

from geometry.errors import BadInput
from validation.app.options import LINGER
from validation.cli import options


@command("compare")
@argument("model", metavar="MODEL")
@argument("data", nargs=-1, metavar="[DATA ...]")
@options.study
@options.effects_from
@options.JSON
@option("--out", type=click.Path(path_type=Path), metavar="DIR", help="Write compare.json and the pictures into DIR.")
def compare_command(as_json: bool, out: Path | None, **given: Any) -> None:
    """Where MODEL fails: four errors with their verdicts, the ten worst spots in words, maps over frequency.

    DATA are the campaign folders of one series, files of tests, and weigh, cog and pendulum files with them; none where MODEL
    names its tests. Spots are told in standard
    deviations of what noise and tolerances let expect, and in per cent of the dynamic mass; docs/compare.md says how to read
    them.

    Exit code 0 whatever it finds; 1 when a fit does not converge; 2 when the input cannot be used.
    """
    from validation.output import require_folder
    from validation.report.compare import answer
    from validation.study import Options

    if out is not None:
        require_folder(out, "--out")
    answer(Options(**given), as_json=as_json, folder=out)


@command("add")
@argument("model", type=click.Path(path_type=Path), metavar="MODEL")
@argument("effect", metavar="EFFECT[=VALUE]")
@argument("data", nargs=-1, metavar="[DATA ...]")
@option(
    "--hold-out",
    multiple=True,
    metavar="NAME",
    help="A run, campaign or file used only for checking, never fitted. May be repeated.  [default: each run in turn]",
)
@options.BAND
@option("--method", type=click.Choice(options.METHODS), help=f"How spectra are made.  [default: {options.METHODS[0]}]")
@options.EFFECTS_FROM
@option("--fixed", is_flag=True, help="Keep the effect at VALUE instead of fitting it.")
@option("--alias-ok", is_flag=True, help="Add it though these data cannot tell it from what the model has; the rung says so.")
@options.JSON
def add_command(model: Path, effect: str, fixed: bool, alias_ok: bool, as_json: bool, **given: Any) -> None:
    """Add EFFECT to MODEL: fit it, print the errors before and after, and keep both as rungs of the model's ladder.

    EFFECT is an id of the catalogue, such as force-gain:fmd-z2; with =VALUE its fit begins there. DATA are the campaign folders
    of one series, files of tests, and weigh, cog and pendulum files with them; they may be left out once the ladder knows them,
    or where MODEL names its tests. MODEL is
    rewritten with the effect, its size and standard deviation; the ladder beside it, MODEL.ladder.json, keeps every version. A
    wrong effect is added all the same: the ladder shows that nothing fell. docs/ladder.md says how to read it.

    Exit code 0 whatever comes out; 1 when the model as it was cannot be fitted; 2 when the input cannot be used.
    """
    from validation.history.add import AddedEffectOptions
    from validation.report.history import add

    if Path(effect).exists():
        problem = f"{effect} is a file or folder, and the effect stands before DATA"
        raise BadInput("EFFECT", "", problem, "massline add MODEL EFFECT DATA; massline effects lists them")
    from validation.study import Options

    add(Options(model=str(model), **given), AddedEffectOptions(effect=effect, fixed=fixed, alias_ok=alias_ok), as_json=as_json)


@command("app")
@argument("model", required=False, metavar="[MODEL]")
@argument("data", nargs=-1, metavar="[DATA ...]")
@option("--example", metavar="NAME", help="Begin with a built-in example; the page lists them, too.")
@option("--port", type=click.IntRange(0, 65535), default=0, metavar="N", help="Port to serve on.  [default: one that is free]")
@option("--host", default="127.0.0.1", show_default=True, metavar="ADDRESS", help="Address to serve on: others reach it.")
@option("--no-browser", is_flag=True, help="Print the address, open nothing.")
@option(
    "--linger",
    type=click.FloatRange(0, 86400),
    default=LINGER,
    show_default=True,
    metavar="SECONDS",
    help="How long to wait, when the last page is closed, for it to be opened again.",
)
@option("--stay", is_flag=True, help="Keep serving when the last page is closed.")
@options.study
@options.EFFECTS_FROM
def app_command(
    model: str | None,
    data: tuple[str, ...],
    example: str | None,
    port: int,
    host: str,
    no_browser: bool,
    linger: float,
    stay: bool,
    **given: Any,
) -> None:
    """The workbench in the browser: compare, diagnose, add, undo, what if.

    Without arguments the page begins empty: drag a folder onto it, or pick an example. MODEL and DATA are those of `massline
    compare`. Your files are read, and written only where you save.

    The address that is printed is good once, in one browser, on this machine. Every window has a process of its own; closing the
    last page ends all of them, and Ctrl-C does.

    Exit code 0 at the end; 2 when the input cannot be used.
    """
    from validation.app import server
    from validation.app.options import WorkbenchOptions, opened

    begun = opened(example, model, data, **given)
    server.run(
        WorkbenchOptions(opened=begun, port=port, host=host, browser=not no_browser, linger=None if stay else linger), click.echo
    )


@command("correct")
@argument("campaign", metavar="CAMPAIGN")
@argument("effects", nargs=-1, required=True, metavar="EFFECT[=VALUE] ...")
@option("--out", type=click.Path(path_type=Path), required=True, metavar="DIR", help="The new campaign folder.")
@option("--force", is_flag=True, help="Replace the campaign in DIR if there is one.")
@options.effects_from
@options.JSON
def correct_command(campaign: str, effects: tuple[str, ...], out: Path, force: bool, as_json: bool) -> None:
    """Write a copy of CAMPAIGN from which EFFECT is taken out; CAMPAIGN itself is only read.

    The value is the fault, with the sign of the catalogue: force-gain:fmd-z2=0.08 says that fmd-z2 reads 8 % too much. Gains,
    units, polarities, swapped channels, delays, a high-pass, places and directions of accelerometers and a shunt can be taken
    out of a record; for everything else the command says why not.
    """
    from validation.report.campaign import correct

    correct(campaign, effects, out, force=force, as_json=as_json)


@command("diagnose")
@argument("model", type=click.Path(path_type=Path), metavar="MODEL")
@argument("data", nargs=-1, metavar="[DATA ...]")
@options.study
@option(
    "--candidate",
    "candidates",
    multiple=True,
    metavar="FAMILY[:TARGET]",
    help="Look for this effect, or this family, only. May be repeated.  [default: all that could act on DATA]",
)
@options.EFFECTS_FROM
@option("--auto", is_flag=True, help="Add what is found to MODEL, rung by rung, until the rules say stop.")
@option("--each", type=click.Path(path_type=Path), metavar="DIR", help="Diagnose every campaign and test below DIR by itself.")
@option("--jobs", type=click.IntRange(min=1), metavar="N", help="With --each: processes.  [default: as this machine has cores]")
@option("--scheduler", metavar="ADDRESS", help="With --each: of Dask, whose workers do it instead, such as tcp://HOST:8786.")
@options.JSON
@option("--out", type=click.Path(path_type=Path), metavar="DIR", help="Write JSON and the pictures, or the page, into DIR.")
def diagnose_command(
    model: Path,
    auto: bool,
    each: Path | None,
    jobs: int | None,
    scheduler: str | None,
    as_json: bool,
    out: Path | None,
    **given: Any,
) -> None:
    """Which physical effect MODEL is missing, how surely, and what would confirm it; that nothing is; or that it is unknown.

    DATA are the campaign folders of one series, files of tests, and weigh, cog and pendulum files with them; none where MODEL
    names its tests. With --auto every effect that is
    found becomes a rung of MODEL's ladder, as `massline add` would make it; each is kept at once, and the same command goes on
    where an interruption fell. docs/diagnose.md says how to read the page.

    With --each MODEL is that of many nominally equal articles, DIR holds a campaign or test of each and DATA belong to all; the
    page says which of them differs, by what, and how they scatter. docs/fleet.md has an example.

    Exit code 0 whatever it finds; 1 when the model with all its tolerances does not converge; 2 when the input cannot be used.
    """
    from validation.effects import catalogue
    from validation.output import require_folder
    from validation.report.diagnose import diagnosis_answer
    from validation.study import Options

    if out is not None:
        require_folder(out, "--out")
    for folder in given["effects_from"]:
        catalogue.load(folder)
    asked = Options(model=str(model), **given)
    if jobs and scheduler:
        problem = "the workers of --scheduler do the work, and how many they are is their own"
        raise BadInput("--jobs", "", problem, "Leave out one of the two")
    if each is None:
        if jobs or scheduler:
            raise BadInput("--jobs or --scheduler", "", "there is one diagnosis", "Name many with --each DIR")
        diagnosis_answer(asked, auto=auto, as_json=as_json, folder=out)
        return
    if auto:
        raise BadInput("--auto", "", "one model stands for all with --each", "Leave it out")
    from validation.report import fleet

    fleet.answer(asked, each, processes=jobs or 0, scheduler=scheduler or "", as_json=as_json, folder=out)


@command("effects")
@argument("names", nargs=-1, metavar="[ID ...]")
@options.JSON
@options.effects_from
def effects_command(names: tuple[str, ...], as_json: bool) -> None:
    """List the effects that massline can simulate, compare, add and look for; with ID say all about these.

    ID is a family such as force-gain, or an effect such as force-gain:fmd-z2. Tolerance is what a careful laboratory admits,
    plausible what a fault may be, one standard deviation each.
    """
    from validation.output import print_json
    from validation.report import effects

    found = effects.chosen(names)
    if as_json:
        print_json({"effects": [effects.as_json(family) for family, _ in found]})
    elif names:
        click.echo("\n".join(effects.whole(family, target) for family, target in found), nl=False)
    else:
        click.echo(effects.table(), nl=False)


@command("ladder")
@argument("model", type=click.Path(path_type=Path), metavar="MODEL")
@option("--go", type=int, metavar="RUNG", help="Go to this rung first: MODEL is rewritten as it was there.")
@option("--plot/--no-plot", default=True, show_default=True, help="Draw the falling errors and the inertia.")
@option(
    "--out", type=click.Path(path_type=Path), default=Path("out"), show_default=True, metavar="DIR", help="Where the pictures go."
)
@options.JSON
def ladder_command(model: Path, go: int | None, plot: bool, out: Path, as_json: bool) -> None:
    """The rungs of MODEL as a tree, with their errors on data that were fitted and held out, and the way of its inertia.

    The rung on which MODEL stands is marked. docs/ladder.md says how to read it.
    """
    from validation.output import require_folder
    from validation.report.history import ladder

    if plot:
        require_folder(out, "--out")
    ladder(model, go=go, as_json=as_json, folder=out if plot else None)


@command("league")
@argument("names", nargs=-1, metavar="[NAME ...]")
@option(
    "--data",
    envvar="MASSLINE_DATA",
    type=click.Path(path_type=Path),
    default=Path("..") / "shared" / "data",
    show_default=True,
    metavar="DIR",
    help="Folder of the data; MASSLINE_DATA may name it.",
)
@option(
    "--studies",
    type=click.Path(path_type=Path),
    default=Path("examples") / "league",
    show_default=True,
    metavar="DIR",
    help="Folder of league.toml and the study files that it names.",
)
@options.JSON
def league_command(names: tuple[str, ...], data: Path, studies: Path, as_json: bool) -> None:
    """Real tests that others made, each diagnosed from its study file: what was expected, what was said, errors before and after.

    Each NAME is a set; all of them by default. docs/league.md says where the data come from, and on which of them something of
    massline was tuned.

    Exit code 0 whatever is said; 2 when a study cannot be used.
    """
    from validation.report.fleet import league_answer

    os.environ["MASSLINE_DATA"] = str(data)  # study files name their data by it
    league_answer(studies, data, names, as_json=as_json)


@command("model")
@argument("article", metavar="ARTICLE")
@option("--out", type=click.Path(path_type=Path), metavar="FILE", help="Write it there instead of to standard output.")
@option("--force", is_flag=True, help="Replace FILE if it is there.")
@option("--examine", is_flag=True, help="Write nothing; say all that is wrong with the FE model in the file ARTICLE.")
@option("--json", "as_json", is_flag=True, help="With --examine: print one JSON object instead.")
@option(
    "--as",
    "program",
    type=click.Choice(["nastran", "calculix", "opensees"]),
    help="Write the effects of the model file ARTICLE as a snippet for this program's deck; Abaqus reads that of calculix.",
)
@option(
    "--test",
    "tests",
    multiple=True,
    metavar="TEST",
    help="A test of your own FE model, its TOML or a universal file: write the study of both. Repeatable.",
)
@option("--units", metavar="UNITS", help="Of a deck, such as mm-t-N-s; by default what its materials say.")
@options.effects_from
def model_command(
    article: str,
    out: Path | None,
    force: bool,
    examine: bool,
    as_json: bool,
    program: str | None,
    tests: tuple[str, ...],
    units: str | None,
) -> None:
    """Write a commented model file for ARTICLE: laboratory, structure, tolerances, and place for effects.

    ARTICLE is a built-in stack on the force measurement device, such as fmd+clumod-1; a file of your own - FE model, STEP or
    mesh - which is put on it; or a model file, which is checked and written anew. docs/model-file.md explains every key.

    ARTICLE may be a deck of Nastran, Abaqus or CalculiX (.bdf, .inp): what is written is the description of its structure, with
    materials, sections, masses, rigid links, springs and supports, to lie beside it. Exit code 1 where something of the deck is
    not carried over; the file names it.

    With --test ARTICLE is an FE model of your own that was struck, shaken or measured by modes by itself; what is written is its
    study, a model file that names both, to lie beside the data. Of a deck the description is written, too, unless it is there.

    With --examine ARTICLE is an FE model of your own, of which each finding says what is wrong, where, how much, and what to do;
    docs/own-model.md has an example. Exit code 0 when nothing is wrong, 1 with findings, 2 when the file cannot be read at all.

    With --as ARTICLE is a model file of your own mesh or matrices, to which `massline add` added what was found; what is written
    is that in units and node numbers of your mesh (docs/your-own-structure.md). Exit code 1 when nothing can be written.
    """
    if program is not None and (examine or tests):
        raise BadInput("--as", "", "it writes what was found, and nothing else", "Leave out --examine and --test")
    if examine:
        from validation.report.flexible import examine_answer

        if out is not None or force or tests:
            remedy = "Leave out --out, --force and --test; --json prints what was found as one object"
            raise BadInput("--examine", "", "it writes no file", remedy)
        examine_answer(article, as_json=as_json)
        return
    if as_json:
        raise BadInput("--json", "", "a model file is TOML", "Use it with --examine")
    from validation.report.history import model

    model(article, out, force=force, tests=tests, program=program, units=units)


@command("report")
@argument("model", metavar="MODEL")
@argument("data", nargs=-1, metavar="[DATA ...]")
@options.study
@options.effects_from
@option("--no-diagnosis", is_flag=True, help="Do not look for what is missing, which takes longest.")
@option("--pdf", is_flag=True, help="Print it to a PDF beside it as well, by Chromium or what MASSLINE_BROWSER names.")
@option("--by", default="", metavar="NAME", help="Who made it: stands above the first signature line.")
@option(
    "--out", type=click.Path(path_type=Path), metavar="FILE.html", help="Where the page goes.  [default: out/, named after MODEL]"
)
def report_command(no_diagnosis: bool, pdf: bool, by: str, out: Path | None, **given: Any) -> None:
    """A report of MODEL and DATA as one HTML file that needs no network: figures to look into, tables that copy, room to sign.

    DATA are the campaign folders of one series, files of tests, and weigh, cog and pendulum files with them; none where MODEL
    names its tests. The report compares, identifies and
    diagnoses as the commands of these names do, shows the model's ladder, and says where every figure comes from. docs/report.md
    shows a page.

    Exit code 0 whatever it finds; 1 when a fit does not converge or nothing is printed; 2 when the input cannot be used.
    """
    from validation.report.page import ReportOptions, answer
    from validation.study import Options

    line = shlex.join(["massline", *sys.argv[1:]])
    answer(ReportOptions(compared=Options(**given), diagnosis=not no_diagnosis, out=out, pdf=pdf, by=by, command=line))


@command("undo")
@argument("model", type=click.Path(path_type=Path), metavar="MODEL")
@options.JSON
def undo_command(model: Path, as_json: bool) -> None:
    """Put MODEL back as it was on the rung below, byte by byte; the rung that it leaves is kept.

    `massline ladder MODEL --go RUNG` goes to any other. Adding an effect after that branches.
    """
    from validation.report.history import undo

    undo(model, as_json=as_json)
